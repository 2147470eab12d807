"""How kernels are compiled: by numba, with steps of our own on our own functions alone, off with one variable."""
