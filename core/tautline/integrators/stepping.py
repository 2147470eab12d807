"""What steps, for each method: its scratch, its compiled step, and what a step does to an oscillation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from tautline.kernels.dispatch import by_type
from tautline.scene.methods import Method, method_of
from tautline.system.model import SolverSettings
from tautline.system.system import System


@dataclass(frozen=True)
class Stepping:
    """The compiled side of a method's record.

    Attributes
    ----------
    scratch : type
        ``NamedTuple`` class of what a step works with. It chooses the step in compiled code.
    make : callable
        ``make(system, settings)`` -> the scratch.
    step : kernel
        ``step(method, groups, dofs, functions, state, t, h)`` -> status: advances the state from t by h s, or leaves it
        as it was.
    explicit : bool
        Which time loop it is for: one without Newton iterations, or one that divides a step which is not solved.
    sums : callable
        ``sums(scratch)`` -> names of the groups' hooks that it uses beside those of every method.
    amplification : callable
        ``amplification(scratch, turn)`` -> complex: what a step multiplies exp(i omega t) by, turn = omega h in rad.
    set_aside : callable
        ``set_aside(scratch, h, moving)`` -> energy, J, that the method keeps for accelerations, of which ``moving`` is
        the sum m a^2.
    disturb : callable
        ``disturb(scratch)``: forces are others from now on, such as after a parameter has been set. A method that keeps
        accelerations from step to step finds them anew before its next step.
    """

    scratch: type
    make: Callable[[System, SolverSettings], Any]
    step: Any
    explicit: bool
    sums: Callable[[Any], tuple[str, ...]]
    amplification: Callable[[Any, float], complex]
    set_aside: Callable[[Any, float, float], float] = lambda scratch, h, moving: 0.0
    disturb: Callable[[Any], None] = lambda scratch: None


_of_scratch: dict[type, Stepping] = {}
_steps: dict[type, Any] = {}
take_step = by_type(_steps)
"""The step of a method, in compiled code: chosen by the type of its scratch."""


def add(stepping: Stepping) -> Stepping:
    """Let compiled loops find a method's step by the type of its scratch; returns it."""
    _of_scratch[stepping.scratch] = stepping
    _steps[stepping.scratch] = stepping.step
    return stepping


def stepping_of(method: str | Method) -> Stepping:
    """What steps for a method, loaded now if it was not; KeyError for a name that nobody has registered."""
    found = (method_of(method) if isinstance(method, str) else method).stepping
    if isinstance(found, str):
        module, _, name = found.partition(":")
        found = getattr(import_module(module), name)
    return add(found)


def stepping_with(scratch: Any) -> Stepping:
    """What steps with a scratch."""
    return _of_scratch[type(scratch)]


def turned_by(polynomial: Sequence[float]) -> Callable[[Any, float], complex]:
    """Amplification of an explicit method, by what one step multiplies y by for y. = lambda y."""
    return lambda scratch, turn: complex(np.polynomial.polynomial.polyval(1j * turn, polynomial))
