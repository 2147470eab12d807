"""The decorators of compiled code.

They act on the functions that they decorate alone: numba's compiler, its cache and its settings are what they were for
all other code of the process. A kernel that is called from Python or by its address is machine code in a file
(:mod:`tautline.kernels.machine`); a process loads it from there without numba, which it imports when there is something
to compile (:mod:`tautline.kernels.compiling`). ``TAUTLINE_PLAIN_NUMBA=1`` leaves each step of that to numba.
"""

from __future__ import annotations

import functools
import inspect
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from tautline.kernels.machine.code import ROUTINES, load, name_of, read, write
from tautline.kernels.machine.packet import LAUNCHER, RESULTS, Launcher, Machine, Packet, fits
from tautline.kernels.machine.settings import UNCOMPILED, UNFUSED
from tautline.kernels.memory import Form, Known, laid_out
from tautline.kernels.numba_registration import compiler, stands_for, taught

__all__ = ["Kernel", "addressed", "entry", "in_python", "kernel", "stands_for"]

OPTIONS = {
    "nopython": True,
    "boundscheck": None,
    "nogil": True,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
    "_nrt": False,
    "fastmath": False if UNFUSED else {"contract"},
}
"""``_nrt=False`` takes numba's reference counts away: they are half of the time of a small kernel, and without them
code that would allocate an array does not compile. The time loop allocates nothing, by construction. ``contract`` lets
a product and a sum be one instruction with one rounding; no sum is reordered, and what is no number stays so. There are
no wrappers that unpack Python's objects: what is called by Python takes its arguments from memory
(:mod:`tautline.kernels.machine.packet`)."""


ROUTINES.append(lambda: compiler().make_ready())


_in_python: ContextVar[bool] = ContextVar("in_python", default=False)


@contextmanager
def in_python() -> Iterator[None]:
    """Let kernels that only kernels call be called by Python, as they were written."""
    token = _in_python.set(True)
    try:
        yield
    finally:
        _in_python.reset(token)


class Kernel:
    """A function that is compiled for each form of arguments that it is called with.

    Attributes
    ----------
    py_func : function
        As it was written.
    """

    def __init__(self, function: Any, part: bool, called: bool, options: dict[str, Any]) -> None:
        functools.update_wrapper(self, function)
        self.py_func, self.part, self._called = function, part, called
        self.targetoptions = OPTIONS | options
        self._found: dict[tuple[Form, ...], Machine] = {}
        self._recent: deque[tuple[tuple[Form, ...], tuple[Machine, Launcher]]] = deque(maxlen=4)
        self.loads = self.compilations = self.forgotten = 0

    @functools.cached_property
    def compiled(self) -> Any:
        """Numba's own object for the function: what compiles it, and what other compiled code takes in."""
        return compiler().dispatcher_of(self)

    @property
    def _numba_type_(self) -> Any:
        """What numba takes the function for where compiled code calls it."""
        return self.compiled._numba_type_

    def at(self, forms: tuple[Form, ...]) -> Machine:
        """Machine code for the forms of the arguments, loaded or compiled now if it was not yet.

        There is no lock of our own around it: compiling takes numba's, and what is compiled may ask for this in turn.
        Two threads that do it at once get the same.
        """
        return self._found.get(forms) or self._loaded(forms) or self._made(forms)

    def is_ready(self, forms: tuple[Form, ...]) -> bool:
        """Whether there is machine code for the forms, in this process or in a file; it is loaded then."""
        return forms in self._found or self._loaded(forms) is not None

    def forget(self, which: Callable[[tuple[Form, ...]], bool]) -> None:
        """Forget the machine code for forms of arguments of which a function says yes."""
        self._recent.clear()
        self.forgotten += 1
        for forms in [forms for forms in self._found if which(forms)]:
            del self._found[forms]
            if "compiled" in vars(self):
                compiler().forget(self.compiled, forms)

    def _loaded(self, forms: tuple[Form, ...]) -> Machine | None:
        name = name_of(self.py_func, forms)
        for stored in read(self.py_func, name):
            address = load(stored)
            if address is not None:
                self.loads += 1
                return self._found.setdefault(forms, Machine(address, stored.returned))
        return None

    def _made(self, forms: tuple[Form, ...]) -> Machine:
        address, stored = compiler().compile_whole(self.compiled, forms)
        self.compilations += 1
        name = name_of(self.py_func, forms)
        if name == name_of(self.py_func, forms):  # else it takes in something without known contents: for this process
            write(self.py_func, name, stored)
        return self._found.setdefault(forms, Machine(address, stored.returned))

    def __call__(self, *arguments: Any) -> Any:
        """Run it; a kernel that only kernels call refuses, for it would be compiled for this call alone."""
        if not self._called:
            if _in_python.get():
                return self.py_func(*arguments)
            name = self.py_func.__qualname__
            raise TypeError(f"{name} can be called by compiled code only; its .py_func by Python")
        packet = self.packet(arguments)
        packet.run()
        return packet.result()

    def packet(self, arguments: Sequence[Any], known: Known | None = None) -> Packet:
        """The kernel with its arguments in memory; ``known`` are words and forms of some of them.

        Raises
        ------
        TypeError
            For arguments that compiled code cannot take, and for what gives back more than numbers.
        """
        words, given, found = [], [], {} if known is None else known
        for x in arguments:
            more, form = laid_out(x, found)
            words += more
            given.append(form)
        forms = tuple(given)
        recent = tuple(self._recent)
        machine, launcher = next((code for kept, code in recent if kept == forms), None) or self._launched(forms)
        return Packet(machine, launcher, words)

    def _launched(self, forms: tuple[Form, ...]) -> tuple[Machine, Launcher]:
        """Machine code for the forms, and what takes a packet for it."""
        machine = self.at(forms)
        if not fits(machine.returned):
            name = self.py_func.__qualname__
            raise TypeError(f"{name} gives back what Python cannot take: at most {RESULTS} numbers")
        given = ("type", (tuple, (tuple, *forms), machine.returned))
        code = machine, LAUNCHER(_run.at((given, int)).address)
        self._recent.appendleft((forms, code))
        return code

    def __repr__(self) -> str:
        return f"<kernel {self.py_func.__module__}.{self.py_func.__qualname__}>"


def _kernel_of(function: Any, part: bool, called: bool, options: dict[str, Any]) -> Any:
    """The function itself where nothing is compiled."""
    if UNCOMPILED:
        return function
    if not inspect.isfunction(function):
        raise TypeError(f"a kernel is made of a plain function, not of {function!r}")
    return Kernel(function, part, called, options)


def entry(function: Any = None, **options: Any) -> Any:
    """Decorator of compiled code that Python calls: kept across processes, releases the interpreter's lock."""
    if function is None:
        return functools.partial(entry, **options)
    return _kernel_of(function, False, True, options)


def addressed(function: Any = None, **options: Any) -> Any:
    """Decorator of compiled code that is called by its address."""
    if function is None:
        return functools.partial(addressed, **options)
    return _kernel_of(function, False, False, options)


def kernel(function: Any = None, **options: Any) -> Any:
    """Decorator of compiled code that only compiled code calls, as a part of it."""
    if function is None:
        return functools.partial(kernel, **options)
    return _kernel_of(function, True, False, options)


def run_at(kind, packet):
    """Call the function in a packet with the arguments there, and write down there what it gives back."""


@addressed
def _run(kind, packet):
    """What takes a packet, for each form of arguments: Python calls it by its address."""
    run_at(kind, packet)


taught("packets")
