"""How kernels are compiled and kept: on our own functions alone, in numba's file format, and off with one variable."""
