"""Kernels that are called again: with all their arguments as they were, or with most of them.

A call of what is bound costs a microsecond, however many arrays there are.
"""

from __future__ import annotations

from collections import deque
from contextlib import suppress
from typing import Any

import numpy as np

from tautline.kernels.machine.packet import HEAD
from tautline.kernels.machine.settings import UNCOMPILED
from tautline.kernels.memory import ARRAYS, Known, laid_out, words_of


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


class _Kept:
    """A packet whose first arguments last: the others take the places of those of the call before."""

    def __init__(self, function: Any, lasting: tuple[Any, ...], more: tuple[Any, ...], known: Known) -> None:
        self.packet = function.packet((*lasting, *more), known)
        self._lasting = lasting  # what the words refer to
        self._before = [None if type(x) in ARRAYS else x for x in more]
        found = [laid_out(x, {}) for x in more]
        self._forms = [form for _, form in found]
        ends = len(self.packet.words) - np.cumsum([len(words) for words, _ in reversed(found)])
        self._places: list[int] = ends[::-1].tolist()

    def takes(self, more: tuple[Any, ...]) -> bool:
        """Write other arguments into the packet; False where one is of another form than that before it."""
        if len(more) != len(self._before):
            return False
        for i, x in enumerate(more):
            # An array may have got another shape, a tuple or a number is what it was.
            if x is self._before[i] and x is not None:
                continue
            words, form = laid_out(x, {})
            if form != self._forms[i]:
                return False
            place = self._places[i]
            if len(words) == 1:
                self.packet.words[place] = words[0]
            else:
                self.packet.words[place : place + len(words)] = words
            if type(x) not in ARRAYS:
                self._before[i] = x
        return True


class Lasting:
    """Arguments that are handed over in many calls: they are laid out once, as long as they are the same tuples."""

    KEPT = 8
    """Tuples, and packets with them, that are known."""

    def __init__(self) -> None:
        self._last: deque[tuple[Any, tuple[list[int], Any]]] = deque(maxlen=self.KEPT)
        self._packets: dict[tuple[Any, ...], _Kept] = {}

    def __reduce__(self) -> Any:
        """A copy, here or in another process, knows nothing: words tell where the arrays of the original are."""
        return Lasting, ()

    def call(self, function: Any, lasting: tuple[Any, ...], *more: Any) -> Any:
        """Call a kernel with arguments that last and with some for this call alone: what it gives back.

        Arrays that last, and those in tuples, are not to be resized or given another shape in place: where they lie
        and how long they are was found in the call before.
        """
        if UNCOMPILED:
            return function(*lasting, *more)
        key = function, function.forgotten, *map(id, lasting)
        # Taken out while it is in use: another thread lays out one of its own.
        kept = self._packets.pop(key, None)
        if kept is None or not kept.takes(more):
            known = {id(value): found for value, found in self._last}
            kept = _Kept(function, lasting, more, known)
            for value in lasting:
                if id(value) in known and all(value is not one for one, _ in self._last):
                    self._last.append((value, known[id(value)]))
        kept.packet.run()
        found = kept.packet.result()
        while len(self._packets) >= self.KEPT:
            with suppress(KeyError, RuntimeError, StopIteration):
                self._packets.pop(next(iter(self._packets)))
        self._packets[key] = kept
        return found
