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
from typing import Any, NamedTuple

import llvmlite.binding
from numba import config
from numba.core import cgutils, types
from numba.core.typing import signature
from numba.extending import intrinsic

from tautline.kernels.compiling.sources import is_ours
from tautline.kernels.jit import address_of, addressed

Code = tuple[Any, tuple[types.Type, ...]]
"""A compiled function and the types of its arguments."""

_known: dict[str, Code] = {}
"""Separate code by its name."""
_found: set[str] = set()
"""Names whose addresses LLVM knows in this process."""
_for_others: list[bool] = []
"""Not empty where code is compiled into the cache alone and is never called."""


class Needed(NamedTuple):
    """Separate code that a caller needs, by name; numba calls it before it loads the caller from its cache."""

    name: str

    def __call__(self) -> None:
        """Have LLVM know the address of the code, which is compiled or loaded now if it was not yet."""
        if self.name in _found:
            return
        _found.add(self.name)
        if _for_others:
            # A call would end the process, with words.
            llvmlite.binding.add_symbol(self.name, ctypes.cast(ctypes.pythonapi.Py_FatalError, ctypes.c_void_p).value)
            return
        if self.name not in _known:
            importlib.import_module(self.name.split(":")[1])
        llvmlite.binding.add_symbol(self.name, address_of(*_known[self.name]))


def separate(returned: types.Type, *arguments: types.Type) -> Callable[[Any], Any]:
    """Decorator of compiled code that compiled code calls, and that is compiled apart from it.

    Parameters
    ----------
    returned : numba type
        What it gives back.
    *arguments : numba types
        What it is given.

    Raises
    ------
    TypeError
        For a function that is not of the core or of an installed application: the name of another would not tell its
        contents.
    """

    def made(function: Any) -> Any:
        return function if config.DISABLE_JIT else _stand_in(function, addressed(function), returned, arguments)

    return made


def apart(compiled: Any, returned: types.Type, *arguments: types.Type) -> Any:
    """An entry for compiled code that calls its one copy, and does not take it in.

    Parameters
    ----------
    compiled : kernel
        Made by :func:`tautline.kernels.jit.entry`, in the module that asks for this.
    returned, *arguments : numba types
        As of :func:`separate`.

    Raises
    ------
    TypeError
        As :func:`separate`.
    """
    return compiled if config.DISABLE_JIT else _stand_in(compiled.py_func, compiled, returned, arguments)


def _stand_in(function: Any, compiled: Any, returned: types.Type, arguments: tuple[types.Type, ...]) -> Any:
    """What compiled code calls in place of a function that stands apart."""
    if not is_ours(function):
        raise TypeError(f"{function.__qualname__} is of no installed application: @kernel compiles it as well")
    needed = Needed(f"tautline:{function.__module__}:{function.__qualname__}")
    _known[needed.name] = compiled, arguments

    def call(typing, *given):
        def code(context, builder, _, values):
            needed()
            context.active_code_library._reload_init.add(needed)
            kind = context.call_conv.get_function_type(returned, arguments)
            callee = cgutils.get_or_insert_function(builder.module, kind, needed.name)
            status, found = context.call_conv.call_function(builder, callee, returned, arguments, values)
            with cgutils.if_unlikely(builder, status.is_error):
                context.call_conv.return_status_propagate(builder, status)
            return found

        return signature(returned, *arguments), code

    # Numba asks for names of arguments, one by one.
    names = ", ".join(function.__code__.co_varnames[: function.__code__.co_argcount])
    space = {"call": call, "__name__": function.__module__}
    exec(f"def {function.__name__}(typing, {names}):\n    return call(typing, {names})", space)
    chosen = intrinsic(space[function.__name__])
    chosen.py_func = function
    return chosen


def code_of(function: Any) -> Code:
    """A separate function as compiled, and the types of its arguments, for `parallel_compile`."""
    plain = function.py_func
    return _known[f"tautline:{plain.__module__}:{plain.__qualname__}"]


def compile_for_others() -> None:
    """Have this process compile into the cache alone: separate code that it calls need not be compiled first."""
    _for_others.append(True)
