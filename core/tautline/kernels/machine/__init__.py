"""Machine code: what it is made of and kept under, and how a run takes it from a file without a compiler."""
