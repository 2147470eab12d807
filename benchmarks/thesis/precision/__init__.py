"""Section 2.8 of the thesis: errors against run time."""
