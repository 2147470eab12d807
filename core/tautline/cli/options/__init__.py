"""What is written in one word on the command line: lists, numbers with units, values of keys."""
