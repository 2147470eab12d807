"""Hooks that can raise an error: whoever calls a hook by its address does not look whether it did.

Numba has compiled code raise by what it gives back, and no hook of ours does. So what others write may not raise: a
``raise`` or ``assert`` is refused as it is compiled. What raises without the word is not seen here; where a hook fills
a vector, hooks.py has it become nan.
"""

from __future__ import annotations

import dis
from collections.abc import Iterator
from contextlib import suppress
from types import CodeType, FunctionType, ModuleType
from typing import Any

from tautline.kernels.compiling.errors import KernelError
from tautline.kernels.machine.sources import comes_with_us, globals_in, is_known, names_in

CURE = (
    "take the `raise` or `assert` out: refuse such values where the group is made, or write nan, which stops the run "
    "there (docs/extending.md)"
)


def refuse_raising(kind: type, hook: str, function: Any) -> None:
    """Refuse a hook of others in which, or in what it calls, an error is raised.

    Raises
    ------
    KernelError
        Naming the file and line of the first ``raise`` or ``assert``.
    """
    for each in _functions_of(function, set()):
        line = _line_that_raises(each.__code__)
        if line is not None:
            named = f"{function.__module__}.{function.__qualname__}"
            cause = f"hook {hook!r} of kind {kind.__name__} ({named}) can raise an error here, and a run would go on"
            raise KernelError(f"{each.__code__.co_filename}:{line}", cause, CURE)


def _line_that_raises(code: CodeType) -> int | None:
    """Line of the first ``raise`` or ``assert`` in a function, and in those inside of it."""
    for one in dis.get_instructions(code):
        if one.opname == "RAISE_VARARGS":
            return one.positions.lineno if one.positions else code.co_firstlineno
    inner = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return next((line for each in inner if (line := _line_that_raises(each)) is not None), None)


def _functions_of(thing: Any, seen: set[int]) -> Iterator[FunctionType]:
    """A function of others as it was written, and all of theirs that it may call; those of a tuple are among them."""
    if isinstance(thing, (tuple, list)):
        for one in thing:
            yield from _functions_of(one, seen)
        return
    function = getattr(thing, "py_func", thing)
    if not isinstance(function, FunctionType) or id(function) in seen:
        return
    if comes_with_us(function) or is_known(function):
        return
    seen.add(id(function))
    yield function
    for one in _used_by(function):
        yield from _functions_of(one, seen)


def _used_by(function: FunctionType) -> list[Any]:
    """What a function takes from outside: of its closure, by global names, and by all of its names behind a module."""
    used = []
    for cell in function.__closure__ or ():
        with suppress(ValueError):  # a name that has no value yet
            used.append(cell.cell_contents)
    names, at_hand = sorted(names_in(function.__code__)), function.__globals__
    used += [at_hand[name] for name in sorted(globals_in(function.__code__)) if name in at_hand]
    modules = set()
    for one in used:  # grows by what stands in modules
        if isinstance(one, ModuleType) and id(one) not in modules:
            modules.add(id(one))
            used += [vars(one)[name] for name in names if name in vars(one)]
    return used
