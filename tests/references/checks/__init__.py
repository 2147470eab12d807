"""The references against closed forms and published numbers: none of them knows the program."""
