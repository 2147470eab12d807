"""Types of numba's own, to compare those of kernels with."""

from numba.core import types

from tautline.kernels.compiling.types.records import Record


def in_numba(kind):
    """A type with numba's named tuples in place of our records."""
    if not isinstance(kind, types.BaseTuple):
        return kind
    assert isinstance(kind, Record) == hasattr(kind, "instance_class")
    return types.BaseTuple.from_types([in_numba(part) for part in kind], getattr(kind, "instance_class", None))
