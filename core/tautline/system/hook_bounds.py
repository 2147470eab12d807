"""Places that hooks of others ask for: compiled code does not look whether an array has them.

Before a run each hook is gone through once in Python, with a copy of its group, at the start. There a place beyond an
array is told; in the compiled loop it would read or write memory of something else, and end the process.
"""

from __future__ import annotations

import copy
import traceback
from collections.abc import Iterator
from types import FrameType
from typing import Any

import numpy as np

from tautline.kernels.compiling.errors import KernelError
from tautline.kernels.dofs import Dofs
from tautline.kernels.groups import HOOKS, KINDS
from tautline.kernels.jit import in_python
from tautline.kernels.machine.sources import comes_with_us

READING = ("residual", "force", "tangent", "mass", "energy", "dissipation", "supply", "alarm", "violation")
"""Hooks that change nothing but what they are given to write into, and scratch."""
CURE = "give the group places that are there, counted from 0 (docs/extending.md)"


class Bounded(np.ndarray):
    """An array that refuses a place below 0, which Python would count from its end."""

    def __getitem__(self, at: Any) -> Any:
        return super().__getitem__(self._within(at))

    def __setitem__(self, at: Any, value: Any) -> None:
        super().__setitem__(self._within(at), value)

    def _within(self, at: Any) -> Any:
        if isinstance(at, (int, np.integer)) and not 0 <= at < self.shape[0]:
            raise IndexError(f"place {at} of an array of {self.shape[0]}, whose places are 0 to {self.shape[0] - 1}")
        return at


def _bounded(x: np.ndarray) -> np.ndarray:
    return np.array(x).view(Bounded)


def check_places(groups: tuple[Any, ...], dofs: Dofs, q: np.ndarray, v: np.ndarray) -> None:
    """Refuse groups of others whose hooks ask for a place that an array has not.

    Parameters
    ----------
    groups : tuple
    dofs : Dofs
    q, v : (n_full,) arrays
        Position and velocity at t = 0.

    Raises
    ------
    KernelError
        Naming the line, the hook, the kind, the element and the place.
    """
    for group in groups:
        for name, function in _of_others(type(group)):
            given = _arguments(name, dofs, q, v)
            try:
                with in_python(), np.errstate(all="ignore"):
                    function(copy.deepcopy(group), *given)
            except IndexError as error:
                raise _error(type(group), name, function, error) from error
            except Exception:
                # What Python cannot run tells nothing of places; the compiler says what is wrong with a hook.
                continue


def _of_others(kind: type) -> Iterator[tuple[str, Any]]:
    for name, hook in KINDS.get(kind, {}).items():
        function = getattr(hook, "py_func", hook)
        if name in READING and not comes_with_us(function):
            yield name, function


def _arguments(name: str, dofs: Dofs, q: np.ndarray, v: np.ndarray) -> list[Any]:
    """What a hook is called with, of its own for each call; a matrix is its diagonal."""
    known: dict[str, Any] = {
        "q": q, "v": v, "a": np.zeros(q.size), "r": np.zeros(q.size), "e": np.zeros(3), "p": np.zeros(2),
        "matrix": np.zeros(dofs.free.size), "alarm": np.zeros(2, np.int64),
    }  # fmt: skip
    known = {key: _bounded(x) for key, x in known.items()}
    known["dofs"] = dofs._replace(start=_bounded(dofs.start)[: q.size + 1], number=_bounded(dofs.number))
    known |= {"t": 0.0, "cm": 1.0, "cc": 1.0, "ck": 1.0, "order": 0}
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
