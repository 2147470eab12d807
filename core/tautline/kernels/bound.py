"""Kernels that are called again: with all their arguments as they were, or with most of them.

A call of what is bound costs a microsecond, however many arrays there are.
"""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

from tautline.kernels.machine.packet import HEAD
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.memory import words_of


class Bound:
    """A kernel with its arguments, to be called many times.

    Parameters
    ----------
    function : kernel
        Made by :func:`tautline.kernels.jit.entry`. It gives back two integers and a float.
    *arguments
        Arrays, integers, floats and named tuples of them. What an array holds may change; the array itself stays. A
        number is what `set_float` makes it.
    """

    def __init__(self, function: Any, *arguments: Any) -> None:
        self.function, self.arguments, self._found = function, list(arguments), (0, 0, 0.0)
        if UNCOMPILED:
            return
        self._packet = function.packet(arguments)
        self._places = np.cumsum([HEAD] + [len(words_of(x)) for x in arguments])

    def set_float(self, i: int, value: float) -> None:
        """Make a number of the i-th argument, a float."""
        self.arguments[i] = value
        if not UNCOMPILED:
            self._packet.floats[self._places[i]] = value

    def __call__(self) -> tuple[int, int, float]:
        """What the function gives back; the interpreter's lock is released meanwhile."""
        if UNCOMPILED:
            self._found = self.function(*self.arguments)
        else:
            self._packet.run()
        return self.found

    @property
    def found(self) -> tuple[int, int, float]:
        """What the last call has given back, also where Ctrl-C was heard as it ended."""
        if UNCOMPILED:
            return self._found
        words = self._packet.words
        return int(words[1]), int(words[2]), float(self._packet.floats[3])


class Lasting:
    """Arguments that are handed over in many calls: their words are found once, as long as they are the same tuples."""

    def __init__(self) -> None:
        self._last: deque[tuple[Any, tuple[list[int], Any]]] = deque(maxlen=8)

    def __reduce__(self) -> Any:
        """A copy, here or in another process, knows nothing: words tell where the arrays of the original are."""
        return Lasting, ()

    def call(self, function: Any, lasting: tuple[Any, ...], *more: Any) -> Any:
        """Call a kernel with arguments that last and with some for this call alone: what it gives back."""
        if UNCOMPILED:
            return function(*lasting, *more)
        known = {id(value): found for value, found in self._last}
        packet = function.packet((*lasting, *more), known)
        for value in lasting:
            if id(value) in known and all(value is not kept for kept, _ in self._last):
                self._last.append((value, known[id(value)]))
        packet.run()
        return packet.result()
