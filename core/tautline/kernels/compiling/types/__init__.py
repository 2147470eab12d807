"""Types of compiled code: lanes and records, which are ours with all that they do, and the type of each form."""
