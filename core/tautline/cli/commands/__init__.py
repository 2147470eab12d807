"""One file for each verb: what it asks for, what it prints, and what it returns with ``--json``."""
