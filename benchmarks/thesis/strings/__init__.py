"""Section 2.9 of the thesis: drill strings."""
