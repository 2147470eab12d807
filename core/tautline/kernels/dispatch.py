"""A compiled call that is chosen by the type of its first argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tautline.kernels.jit import stands_for


def by_type(table: dict[type, Callable[..., Any]]) -> Callable[..., Any]:
    """Make a function that calls the kernel registered for the type of its first argument.

    Parameters
    ----------
    table : dict
        ``NamedTuple`` class -> kernel; looked up when the caller is compiled, so later entries count.

    Returns
    -------
    callable
        To be called from compiled code, or from Python where compilation is off.
    """

    def chosen(first, *args):
        return table[type(first)](first, *args)

    @stands_for(chosen)
    def resolve(first, *args):
        kernel = table[first.instance_class]
        return lambda first, *args: kernel(first, *args)

    return chosen
