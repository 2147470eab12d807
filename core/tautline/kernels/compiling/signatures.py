"""What `inspect` says of a function's arguments, as numba asks for each kernel twice."""

from __future__ import annotations

import functools
import inspect
from typing import Any

NAMELESS = inspect.CO_VARARGS | inspect.CO_VARKEYWORDS
"""Marks of functions that take any number of arguments."""


def signature_of(function: Any) -> inspect.Signature:
    """The same signature as `inspect` finds, which is most of making a kernel."""
    code = function.__code__
    plain = not (code.co_posonlyargcount or code.co_kwonlyargcount or code.co_flags & NAMELESS)
    if plain and not (function.__defaults__ or function.__annotations__):
        return inspect.Signature([_argument(name) for name in code.co_varnames[: code.co_argcount]])
    return inspect.signature(function)


@functools.cache
def _argument(name: str) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD)
