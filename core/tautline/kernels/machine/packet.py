"""Packets: arguments of compiled code laid out in memory, and how Python calls it with them.

Numba's own way from Python unpacks the arrays of named tuples one by one, about a tenth of a microsecond each: for a
time loop and its scene that is as long as a step. Here they are laid out as compiled code holds them
(:mod:`tautline.kernels.memory`), once for many calls or for one, and what is called reads them from there.
"""

from __future__ import annotations

import ctypes
import pickle
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tautline.kernels.memory import Form, address_of

RESULTS = 16
"""Numbers that a kernel can give back, at most."""
HEAD = 1 + RESULTS
"""Words before the arguments: the address of the function, and room for what it gives back."""
LAUNCHER = ctypes.CFUNCTYPE(ctypes.c_int32, *[ctypes.c_void_p] * 3, ctypes.c_ssize_t)
"""How numba has what takes a packet called: room for nothing, room for an error, a type, and the packet."""
Launcher = Callable[..., int]
_ROOM = [0] * RESULTS
_nothing = ctypes.c_void_p()
_NOTHING = ctypes.addressof(_nothing)


class Machine(NamedTuple):
    """Machine code of a kernel in this process: where it is, and the form of what it gives back.

    The address follows numba's calling convention and stays what it is for the life of the process.
    """

    address: int
    returned: Form


class _Raised(ctypes.Structure):
    """How numba describes an error that compiled code raises: Python's objects, pickled."""

    _fields_ = (("data", ctypes.c_void_p), ("size", ctypes.c_int32))


class Packet:
    """A kernel's address and its arguments in memory, and what calls it with them.

    Parameters
    ----------
    machine : Machine
        Of the kernel.
    launcher : Launcher
        What takes arguments of their forms from a packet.
    words : list of int
        The arguments, as compiled code holds them; what they refer to must live on.
    """

    def __init__(self, machine: Machine, launcher: Launcher, words: list[int]) -> None:
        self._returned, self._launch = machine.returned, launcher
        self.words = np.array([machine.address, *_ROOM, *words], np.int64)
        self._error = ctypes.c_void_p()
        self._given = _NOTHING, ctypes.addressof(self._error), None, address_of(self.words)

    @property
    def floats(self) -> np.ndarray:
        """The words as numbers."""
        return self.words.view(np.float64)

    def run(self) -> None:
        """Call it; the interpreter's lock is released meanwhile.

        Raises
        ------
        Exception
            What the kernel raises: an IndexError, with ``NUMBA_BOUNDSCHECK=1``.
        """
        if self._launch(*self._given):
            raised = ctypes.cast(self._error, ctypes.POINTER(_Raised)).contents
            kind, arguments, *_ = pickle.loads(ctypes.string_at(raised.data, raised.size))
            raise kind(*(arguments or ()))

    def result(self) -> Any:
        """What the last call has given back."""
        return self._result(self._returned, 1)[0]

    def _result(self, form: Form, at: int) -> tuple[Any, int]:
        if isinstance(form, tuple):
            parts = []
            for part in form[1:]:
                found, at = self._result(part, at)
                parts.append(found)
            return tuple(parts), at
        if form is type(None):
            return None, at
        if form is float or getattr(form, "kind", "") == "f":
            return float(self.floats[at]), at + 1
        return (bool if form is bool else int)(self.words[at]), at + 1


def fits(form: Form) -> bool:
    """Whether a packet has room for what is given back: a number, or a tuple of at most `RESULTS`."""
    return form is not None and _count(form) <= RESULTS


def _count(form: Form) -> int:
    """Numbers in a form."""
    return sum(map(_count, form[1:])) if isinstance(form, tuple) else int(form is not type(None))
