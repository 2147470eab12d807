"""A compiled call that is chosen by the type of its first argument."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from tautline.kernels.machine.code import KERNELS_OF
from tautline.kernels.numba_registration import taught

TABLES: list[dict[type, Callable[..., Any]]] = []
"""All that kernels are chosen from."""


def by_type(table: dict[type, Callable[..., Any]]) -> Callable[..., Any]:
    """Make a function that calls the kernel registered for the type of its first argument.

    In compiled code the kernel itself is called: there is no function in between that would have to be compiled.

    Parameters
    ----------
    table : dict
        ``NamedTuple`` class -> kernel; looked up when the caller is compiled, so later entries count.

    Returns
    -------
    callable
        To be called from compiled code, or from Python where compilation is off.
    """

    TABLES.append(table)

    def chosen(first, *args):
        return table[type(first)](first, *args)

    taught("kernels", "chosen_by_type", chosen, table)
    return chosen


def _chosen_for(kind: type) -> Iterator[Any]:
    """The kernels that stand for a class."""
    return (table[kind] for table in TABLES if kind in table)


KERNELS_OF.append(_chosen_for)
