"""How large errors are beside references, and what a run says of its own."""
