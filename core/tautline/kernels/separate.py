"""Compiled code that stands in memory once, for all that call it.

A kernel is written out in each of its callers, which is right for what runs in every element. What is long and is asked
for a few times in a step would be optimised and translated again in each of them: functions of time were two thirds of
the machine code of a crane. Such a function is compiled on its own, and its callers hold its name and types only. Its
address is looked up by that name when a caller is compiled or loaded, as that of a routine of LAPACK is.
"""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable
from typing import Any

import llvmlite.binding

from tautline.kernels.jit import Kernel, addressed
from tautline.kernels.machine.code import FINDERS
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.machine.sources import is_ours
from tautline.kernels.memory import Form
from tautline.kernels.teaching import taught

Code = tuple[Kernel, tuple[Form, ...]]
"""A kernel and the forms of its arguments."""

BEGINNING = "tautline:"
"""How names of separate code begin, among the symbols that machine code refers to."""
_known: dict[str, Code] = {}
"""Separate code by its name."""
_found: set[str] = set()
"""Names whose addresses LLVM knows in this process."""
_for_others: list[bool] = []
"""Not empty where code is compiled into the cache alone and is never called."""


def find(name: str) -> None:
    """Have LLVM know the address of separate code, which is compiled or loaded now if it was not yet."""
    if name in _found:
        return
    if _for_others:
        # A call would end the process, with words.
        address = ctypes.cast(ctypes.pythonapi.Py_FatalError, ctypes.c_void_p).value
    else:
        if name not in _known:
            importlib.import_module(name.split(":")[1])
        kernel, forms = _known[name]
        address = kernel.at(forms).address
    llvmlite.binding.add_symbol(name, address)
    _found.add(name)


FINDERS[BEGINNING] = find


def separate(returned: Form, *arguments: Form) -> Callable[[Any], Any]:
    """Decorator of compiled code that compiled code calls, and that is compiled apart from it.

    Parameters
    ----------
    returned : form
        Of what it gives back (:mod:`tautline.kernels.memory`).
    *arguments : forms
        Of what it is given.

    Raises
    ------
    TypeError
        For a function that is not of the core or of an installed application: the name of another would not tell its
        contents.
    """

    def made(function: Any) -> Any:
        return function if UNCOMPILED else _stand_in(function, addressed(function), returned, arguments)

    return made


def apart(compiled: Any, returned: Form, *arguments: Form) -> Any:
    """An entry for compiled code that calls its one copy, and does not take it in.

    Parameters
    ----------
    compiled : kernel
        Made by :func:`tautline.kernels.jit.entry`, in the module that asks for this.
    returned, *arguments : forms
        As of :func:`separate`.

    Raises
    ------
    TypeError
        As :func:`separate`.
    """
    return compiled if UNCOMPILED else _stand_in(compiled.py_func, compiled, returned, arguments)


class StandIn:
    """What compiled code calls in place of a function that stands apart."""

    def __init__(self, function: Any, name: str) -> None:
        self.__name__, self.py_func, self.symbol = function.__name__, function, name


def _stand_in(function: Any, compiled: Kernel, returned: Form, arguments: tuple[Form, ...]) -> StandIn:
    if not is_ours(function):
        raise TypeError(f"{function.__qualname__} is of no installed application: @kernel compiles it as well")
    name = f"{BEGINNING}{function.__module__}:{function.__qualname__}"
    _known[name] = compiled, arguments
    made = StandIn(function, name)

    taught("calls", "called_by_name", made, returned, arguments)
    return made


def code_of(function: StandIn) -> Code:
    """A separate function as compiled, and the forms of its arguments, for `parallel_compile`."""
    return _known[function.symbol]


def compile_for_others() -> None:
    """Have this process compile into the cache alone: separate code that it calls need not be compiled first."""
    _for_others.append(True)
