"""Plain loops over vectors. NumPy's slice assignment would do, but compiles fifty times as much code."""

from __future__ import annotations

from tautline.kernels.jit import kernel


@kernel
def copy(source, target):
    """Write the vector ``source`` over ``target``."""
    for i in range(source.size):
        target[i] = source[i]
