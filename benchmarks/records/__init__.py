"""Records that others made, beside the program."""
