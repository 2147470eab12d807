"""Places that groups of others hold, or their hooks ask for: compiled code does not look whether an array has them.

Before a run each hook is gone through once in Python, with a copy of its group, at the start. There a place beyond an
array is told; in the compiled loop it would read or write memory of something else, and end the process. A group's own
``begin`` goes first, as in a run: it may be what finds the places. What took long is not gone through again while the
places stay: a sweep makes the same system many times.
"""

from __future__ import annotations

import ast
import copy
import inspect
import linecache
import time
import traceback
from collections import deque
from collections.abc import Iterator
from hashlib import blake2b
from types import FrameType
from typing import Any

import numpy as np

from tautline.kernels.compiling.errors import KernelError
from tautline.kernels.dofs import Dofs
from tautline.kernels.groups import HOOKS, KINDS, UNKNOWN, known_of
from tautline.kernels.jit import in_python
from tautline.kernels.machine.sources import comes_with_us

READING = ("residual", "force", "tangent", "mass", "energy", "dissipation", "supply", "alarm", "violation")
"""Hooks that change nothing but what they are given to write into, and scratch."""
BEGINNINGS = ((0.0, -1.0, -1.0), (1.0e-6, 0.0, 0.0))
"""Step h, s, beta and gamma that ``begin`` is called with at an equilibrium, and at an explicit step."""
LONG = 0.02
"""Time, s, from which on it is remembered that the places of a group are there."""
_there: deque[tuple[Any, ...]] = deque(maxlen=64)
"""Groups whose places are there, by all that tells places: see `_key`."""
CURE = "give the group places that are there, counted from 0 (docs/extending.md)"


class Bounded(np.ndarray):
    """An array that refuses a place below 0 that was found: an element before the first one is probably meant.

    A constant one, such as ``e[-1]``, counts from the end, in compiled code as in Python.
    """

    def __getitem__(self, at: Any) -> Any:
        return super().__getitem__(self._within(at))

    def __setitem__(self, at: Any, value: Any) -> None:
        super().__setitem__(self._within(at), value)

    def _within(self, at: Any) -> Any:
        if isinstance(at, (int, np.integer)) and not 0 <= at < self.shape[0]:
            if not (-self.shape[0] <= at < 0 and _is_constant()):
                raise IndexError(
                    f"place {at} of an array of {self.shape[0]}, whose places are 0 to {self.shape[0] - 1}"
                )
        return at


def _is_constant() -> bool:
    """Whether the place that an array is asked for is written in the source, and not found in a variable."""
    frame = inspect.currentframe()
    for _ in range(3):  # past this, `Bounded._within` and what numpy calls
        frame = frame.f_back if frame is not None else None
    if frame is None:
        return False
    code = frame.f_code
    line, last, begin, end = list(code.co_positions())[frame.f_lasti // 2]
    if line is None or line != last:
        return False
    # Columns are counted in bytes.
    text = linecache.getline(code.co_filename, line).encode()[begin:end].decode()
    try:
        asked = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        return False
    if not isinstance(asked, ast.Subscript):
        return False
    # What is no variable of the function is a constant in compiled code.
    return all(part.id not in code.co_varnames for part in ast.walk(asked.slice) if isinstance(part, ast.Name))


def _bounded(x: np.ndarray) -> np.ndarray:
    return np.array(x).view(Bounded)


def check_places(groups: tuple[Any, ...], dofs: Dofs, q: np.ndarray, v: np.ndarray, filled: bool = False) -> None:
    """Refuse groups whose hooks ask for a place that an array has not, as far as others wrote the hooks.

    Parameters
    ----------
    groups : tuple
    dofs : Dofs
    q, v : (n_full,) arrays
        Position and velocity at t = 0.
    filled : bool
        Whether others have filled the groups: then hooks of ours are gone through as well.

    Raises
    ------
    KernelError
        Naming the line, the hook, the kind, the element and the place.
    """
    for group in groups:
        key = _key(group, q.size, dofs.free.size, filled)
        if key in _there:
            continue
        since = time.perf_counter()
        _check(group, dofs, q, v, filled)
        if time.perf_counter() - since > LONG:
            _there.append(key)


def _check(group: Any, dofs: Dofs, q: np.ndarray, v: np.ndarray, filled: bool) -> None:
    """Refuse a group of which a hook asks for a place that is not there, whichever way the group has begun."""
    hooks = dict(_gone_through(type(group), filled))
    begin = hooks.pop("begin", None)
    if begin is None:
        copies: list[Any] = [group]
    else:
        copies = [copy.deepcopy(group) for _ in BEGINNINGS]
        for one, (h, beta, gamma) in zip(copies, BEGINNINGS, strict=True):
            given = _arguments("begin", dofs, q, v, h=np.float64(h), beta=beta, gamma=gamma)
            if not _runs(one, "begin", begin, given):
                return  # what it finds is not known
    for name, function in hooks.items():
        refused: KernelError | None = None
        for one in copies:
            try:
                _runs(copy.deepcopy(one), name, function, _arguments(name, dofs, q, v))
                break
            except KernelError as error:
                refused = refused or error
        else:
            if refused is not None:
                raise refused


def _runs(group: Any, name: str, function: Any, given: list[Any]) -> bool:
    """Whether Python can run a hook; raises KernelError for a place that is not there."""
    try:
        with in_python(), np.errstate(all="ignore"):
            function(group, *given)
    except IndexError as error:
        raise _error(type(group), name, function, error) from error
    except Exception:
        # What Python cannot run tells nothing of places; the compiler says what is wrong with a hook.
        return False
    return True


def _key(group: Any, *sizes: int) -> tuple[Any, ...]:
    """What tells a group's places: its kind, the hooks, all whole numbers in it, and how large its arrays are."""
    digest = blake2b(digest_size=16)

    def take(part: Any) -> None:
        if isinstance(part, tuple):
            for one in part:
                take(one)
        elif isinstance(part, np.ndarray):
            digest.update(f"{part.dtype} {part.shape}".encode())
            if part.dtype.kind in "iub":
                digest.update(np.ascontiguousarray(part).tobytes())
        elif not isinstance(part, float):
            digest.update(repr(part).encode())

    take(group)
    return type(group), *sizes, digest.digest(), *known_of(group).hooks.values()


def _gone_through(kind: type, filled: bool) -> Iterator[tuple[str, Any]]:
    for name, hook in KINDS.get(kind, UNKNOWN).hooks.items():
        function = getattr(hook, "py_func", hook)
        if name in ("begin", *READING) and (filled or not comes_with_us(function)):
            yield name, function


def _arguments(name: str, dofs: Dofs, q: np.ndarray, v: np.ndarray, **more: float) -> list[Any]:
    """What a hook is called with, of its own for each call; a matrix is its diagonal."""
    known: dict[str, Any] = {
        "q": q, "v": v, "a": np.zeros(q.size), "r": np.zeros(q.size), "e": np.zeros(3), "p": np.zeros(2),
        "matrix": np.zeros(dofs.free.size), "alarm": np.zeros(2, np.int64),
    }  # fmt: skip
    known = {key: _bounded(x) for key, x in known.items()}
    known["dofs"] = dofs._replace(start=_bounded(dofs.start)[: q.size + 1], number=_bounded(dofs.number))
    known |= {"t": 0.0, "cm": 1.0, "cc": 1.0, "ck": 1.0, "order": 0} | more
    return [known[key] for key in HOOKS[name]]


def _error(kind: type, name: str, function: Any, error: IndexError) -> KernelError:
    frames = [frame for frame, _ in traceback.walk_tb(error.__traceback__)]
    lines = [line for _, line in traceback.walk_tb(error.__traceback__)]
    own = [k for k, frame in enumerate(frames) if not _is_of_program(frame)] or [len(frames) - 1]
    hook = next((frame for frame in frames if frame.f_code is function.__code__), None)
    element = _element(hook)
    named = f"{function.__module__}.{function.__qualname__}"
    cause = f"hook {name!r} of kind {kind.__name__} ({named}) asks{element} for a place that is not there: {error}"
    return KernelError(f"{frames[own[-1]].f_code.co_filename}:{lines[own[-1]]}", cause, CURE)


def _is_of_program(frame: FrameType) -> bool:
    """Whether a frame runs code of the program itself, or of numpy."""
    module = str(frame.f_globals.get("__name__", ""))
    return module.split(".")[0] in ("tautline", "numpy")


def _element(hook: FrameType | None) -> str:
    """The loop's count in a hook, which is the element."""
    if hook is None:
        return ""
    code = hook.f_code
    for key in code.co_varnames[code.co_argcount :]:
        value = hook.f_locals.get(key)
        if isinstance(value, (int, np.integer)):
            return f", with {key} = {value},"
    return ""
