"""Compiled code that stands in memory once, for all that call it.

A kernel is written out in each of its callers, which is right for what runs in every element. What is long and is asked
for a few times in a step would be optimised and translated again in each of them: functions of time were two thirds of
the machine code of a crane. Such a function is compiled on its own, and its callers hold its name and types only. Its
address is looked up by that name when a caller is compiled or loaded, as that of a routine of LAPACK is.

Code that most scenes never come to may be *late*: its callers know a place in memory where its address stands. What
stands there first compiles or loads the code, has its address stand there from then on, and hands over the call. A
first run compiles only what it comes to.
"""

from __future__ import annotations

import ctypes
import importlib
from collections.abc import Callable
from typing import Any

import llvmlite.binding

from tautline.kernels.jit import Kernel, addressed
from tautline.kernels.machine.code import FINDERS
from tautline.kernels.machine.settings import PLAIN, UNCOMPILED
from tautline.kernels.machine.sources import is_ours
from tautline.kernels.memory import Form, parts_of
from tautline.kernels.numba_registration import taught

Code = tuple[Kernel, tuple[Form, ...]]
"""A kernel and the forms of its arguments."""

BEGINNING, LATE = "tautline:", "tautline.late:"
"""How names of separate code begin, among the symbols that machine code refers to, and those of places of late code."""
_known: dict[str, Code] = {}
"""Separate code by its name."""
_found: set[str] = set()
"""Names whose addresses LLVM knows in this process."""
_for_others: list[bool] = []
"""Not empty where code is compiled into the cache alone and is never called."""


def find(name: str) -> None:
    """Have LLVM know separate code by its name: its address, compiled or loaded now, or the place of late code."""
    if name in _found:
        return
    if name not in _known:
        importlib.import_module(name.split(":")[1])
    if name.startswith(LATE):
        address = _new_place(*_known[name])
    elif _for_others:
        # A call would end the process, with words.
        address = ctypes.cast(ctypes.pythonapi.Py_FatalError, ctypes.c_void_p).value or 0
    else:
        kernel, forms = _known[name]
        address = kernel.at(forms).address
    llvmlite.binding.add_symbol(name, address)
    _found.add(name)


FINDERS[BEGINNING] = FINDERS[LATE] = find


def _new_place(kernel: Kernel, forms: tuple[Form, ...]) -> int:
    """A place where the address of late code stands once it was called; where that is."""
    kind = ctypes.CFUNCTYPE(
        ctypes.c_int32, *[ctypes.c_void_p] * 2, *(each for form in forms for each in _carried(form))
    )

    def first(*given: Any) -> int:
        place.value = _address_of(kernel, forms)
        return kind(place.value)(*given)

    standing = kind(first)
    place = ctypes.c_void_p(ctypes.cast(standing, ctypes.c_void_p).value)
    _kept.append((standing, place))
    return ctypes.addressof(place)


_kept: list[Any] = []
"""What compiled code refers to, which has to stay in memory."""


def _address_of(kernel: Kernel, forms: tuple[Form, ...]) -> int:
    """Address of late code, which compiled code waits for: there is nobody to whom an error could be raised."""
    while True:
        try:
            return kernel.at(forms).address
        except KeyboardInterrupt:
            pass  # whoever listens has taken note of it (interruption.py), and is asked when the call is over
        except BaseException as error:
            ctypes.pythonapi.Py_FatalError(f"{kernel!r} cannot be compiled: {error}".encode())


def _carried(form: Form) -> list[Any]:
    """How an argument is handed over by numba's convention: a record by its address, an array word by word.

    Raises
    ------
    TypeError
        For what late code is never given.
    """
    if form is float:
        return [ctypes.c_double]
    if form is int:
        return [ctypes.c_int64]
    record = parts_of(form)
    if record is not None:
        return [each for part in record[1] for each in _carried(part)] if PLAIN else [ctypes.c_void_p]
    if isinstance(form, tuple) and len(form) == 5:
        return [ctypes.c_int64] * (5 + 2 * form[1])
    raise TypeError(f"late code takes records, arrays, floats and whole numbers, not {form!r}")


def separate(returned: Form | type[None], *arguments: Form, late: bool = False) -> Callable[[Any], Any]:
    """Decorator of compiled code that compiled code calls, and that is compiled apart from it.

    Parameters
    ----------
    returned : form
        Of what it gives back (:mod:`tautline.kernels.memory`).
    *arguments : forms
        Of what it is given.
    late : bool
        Whether it is compiled, or loaded, when it is first called, unless a run asks for it before (`code_of`): for
        what most scenes never come to.

    Raises
    ------
    TypeError
        For a function that is not of the core or of an installed application: the name of another would not tell its
        contents.
    """

    def made(function: Any) -> Any:
        return function if UNCOMPILED else _stand_in(function, addressed(function), returned, arguments, late)

    return made


def apart(compiled: Any, returned: Form | type[None], *arguments: Form) -> Any:
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

    def at(self, forms: tuple[Form, ...]) -> Any:
        """Compile it, or load it: a helper knows a function by the name under which its module has it."""
        return _known[self.symbol][0].at(forms)


def _stand_in(
    function: Any, compiled: Kernel, returned: Form | type[None], arguments: tuple[Form, ...], late: bool = False
) -> StandIn:
    if not is_ours(function):
        raise TypeError(f"{function.__qualname__} is of no installed application: @kernel compiles it as well")
    name = f"{LATE if late else BEGINNING}{function.__module__}:{function.__qualname__}"
    _known[name] = compiled, arguments
    made = StandIn(function, name)

    taught("calls", "called_by_name", made, returned, arguments, late=late)
    return made


def code_of(function: StandIn) -> Code:
    """A separate function as compiled, and the forms of its arguments, for `parallel_compile`."""
    return _known[function.symbol]


def late_code() -> list[Code]:
    """All late code of the modules that were imported: a wheel brings it, whether a scene has come to it or not."""
    return [code for name, code in _known.items() if name.startswith(LATE)]


def compile_for_others() -> None:
    """Have this process compile into the cache alone: separate code that it calls need not be compiled first."""
    _for_others.append(True)
