"""The base of all that this package raises on purpose."""

from __future__ import annotations


class TautlineError(Exception):
    """What a scene, a result or a run can be refused by; every exception of the public interface is one."""


class ArgumentError(TautlineError, ValueError):
    """An argument of a function with a value that it cannot have."""


class ArgumentTypeError(TautlineError, TypeError):
    """An argument of a function that is of another type than the function takes."""


class TautlineWarning(UserWarning):
    """What a user should know of something that was done all the same; a command prints it as its other warnings."""
