"""A compiled call that is chosen by the type of its first argument."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global

from tautline.kernels.compiling.caching import KERNELS_OF

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

    class Choice(AbstractTemplate):
        """What numba takes the call for: one of the kernel."""

        key = chosen

        def generic(self, args: tuple[types.Type, ...], kws: dict[str, types.Type]) -> Any:
            """Signature of the kernel for these arguments."""
            self._kernel = types.Dispatcher(table[args[0].instance_class])
            return self._kernel.get_call_type(self.context, args, kws)

        def get_impl_key(self, sig: Any) -> Any:
            """Where numba finds the kernel's code."""
            return self._kernel.get_impl_key(sig)

    infer_global(chosen, types.Function(Choice))
    return chosen


def _chosen_for(kind: type) -> Iterator[Any]:
    """The kernels that stand for a class."""
    return (table[kind] for table in TABLES if kind in table)


KERNELS_OF.append(_chosen_for)
