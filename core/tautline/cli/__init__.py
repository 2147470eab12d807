"""The verbs that every application shares, as a command line."""
