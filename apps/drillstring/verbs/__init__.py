"""Commands that only drill strings have. What they print with ``--json`` is a contract."""
