"""Error against run time, beside a reference that proves itself."""
