"""The base of all that this package raises on purpose."""

from __future__ import annotations

import copyreg
from collections.abc import Callable
from typing import Any


class TautlineError(Exception):
    """What a scene, a result or a run can be refused by; every exception of the public interface is one."""

    def translate(self, subject: Callable[[str], str], sentence: Callable[[str], str]) -> None:
        """Put other words in place of the options of a command: of what it is about, and in its sentences.

        The error stays the one that was raised, for it may carry more than words. Most name no option.
        """

    def __reduce__(self) -> tuple[Any, ...]:
        """How it is pickled, and so goes to another process: by what it holds, and not by making it anew.

        Python would call the class with the sentence alone, which is not what most are made of. A pool of processes
        ends, or waits for ever, where an error cannot be read.
        """
        return copyreg.__newobj__, (type(self), *self.args), dict(self.__dict__)  # type: ignore[attr-defined]


class ArgumentError(TautlineError, ValueError):
    """An argument of a function with a value that it cannot have."""


class ArgumentTypeError(TautlineError, TypeError):
    """An argument of a function that is of another type than the function takes."""


class TautlineWarning(UserWarning):
    """What a user should know of something that was done all the same; a command prints it as its other warnings."""
