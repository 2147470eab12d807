"""What a twin of a crane keeps besides the estimate: the account of its rope."""
