"""Which hook that others wrote gives what is no finite number: asked once, where a run has stopped for such a number.

The sum over all groups does not say whose number it was. So each group of others is asked by itself, at a state whose
positions and velocities are finite numbers: a copy of it, for what is asked may leave its mark in a group.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.state import State, stand_at
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels import groups as over
from tautline.kernels.groups import KINDS, known_of, link
from tautline.kernels.jit import entry
from tautline.kernels.machine.sources import comes_with_us
from tautline.kernels.matrix import new_matrix
from tautline.system.system import System

OF_FORCES = ("residual", "force", "smooth_tangent", "switching_tangent")
OF_ENERGIES = ("energy", "supply", "dissipation")
LARGEST = 1.0e75
"""Position or velocity, m or m/s, whose fourth power is still a number: beyond it the motion itself has overflowed."""
DOUBTFUL = Status.NOT_FINITE, Status.NOT_CONVERGED, Status.SINGULAR, Status.NO_EQUILIBRIUM, Status.UNSTABLE
"""Ends of a run behind which a force that is no number may stand."""


Ask = Callable[[Any, System, Any], dict[str, Any]]
"""What asks linked groups at an instant, and returns the arrays that they have filled, by hook."""


class Instant(NamedTuple):
    """Time, s, with full positions and velocities (n_full,)."""

    time: float
    q: np.ndarray
    v: np.ndarray


@entry
def _stand(dofs, functions, state, t):
    stand_at(dofs, functions, state, t)


@entry
def _ask_forces(groups, dofs, t, q, v, a, r, f, matrix):
    over.residual(groups, t, q, v, a, r)
    over.force(groups, t, q, v, a, f)
    over.smooth_tangent(groups, t, q, v, a, 1.0, 1.0, 1.0, matrix, dofs)
    over.switching_tangent(groups, t, q, v, a, 1.0, 1.0, 1.0, matrix, dofs)


@entry
def _ask_energies(groups, t, q, v, e, s, p):
    over.energy(groups, t, q, v, e)
    over.supply(groups, t, q, v, s)
    over.dissipation(groups, t, q, v, p)


def blamed_for(stop: StoppedEarly, system: System, state: State, sums: tuple[str, ...], step: float) -> StoppedEarly:
    """What stopped a run; or NO_FORCE with the kind and its hook, where one of others gives what is no number.

    Parameters
    ----------
    stop : StoppedEarly
    system : System
    state : State
        As it was accepted last.
    sums : tuple of str
        Sums that the run asks of its groups: a hook that it never asked for is not to blame.
    step : float
        Length of a step, s. Both ends of one are looked at: an end that was never reached may be the one.
    """
    if stop.status not in DOUBTFUL:
        return stop
    asked = tuple(name for name in OF_FORCES if name in sums)
    for group in _groups_of_others(system):
        for now in _ends_of_step(system, state, stop.time, step):
            hook = _without_number(group, asked, _forces, system, now)
            if hook:
                part = f"kind {type(group).__name__}"
                return StoppedEarly(Status.NO_FORCE, stop.time, part, _words(type(group), hook, now.time))
    return stop


def hook_of_energy(system: System, instants: list[Instant]) -> str:
    """The hook of others that gives an energy or a power which is no finite number, in words; empty if none does."""
    for group in _groups_of_others(system):
        for now in filter(_is_finite, instants):
            hook = _without_number(group, OF_ENERGIES, _energies, system, now)
            if hook:
                return _words(type(group), hook, now.time)
    return ""


def _words(kind: type, hook: str, time: float) -> str:
    """What a hook does, and when."""
    hooks = KINDS[kind].hooks
    function = getattr(hooks[hook], "py_func", hooks[hook])
    named = f"hook {hook!r} of kind {kind.__name__} ({function.__module__}.{function.__qualname__})"
    return f"{named} gives what is no finite number at {time:.6g} s"


def _groups_of_others(system: System) -> Iterator[Any]:
    """Groups of which others wrote a hook."""
    for group in system.groups:
        hooks = known_of(group).hooks.values()
        if not all(comes_with_us(getattr(hook, "py_func", hook)) for hook in hooks):
            yield group


def _ends_of_step(system: System, state: State, time: float, step: float) -> Iterator[Instant]:
    """The state as it is, and as its velocities would carry it on to the end of a step; only what is finite."""
    for h in (0.0, step):
        there = copy.deepcopy(state)
        there.q[:] += h * there.v
        _stand(system.dofs, system.functions, there, time + h)
        now = Instant(time + h, there.full_q, there.full_v)
        if _is_finite(now):
            yield now
    system.functions.frames.time[0] = np.nan  # where frames stand is found anew by whoever asks next


def _is_finite(now: Instant) -> bool:
    return bool((np.abs(now.q) < LARGEST).all() and (np.abs(now.v) < LARGEST).all())


def _forces(linked: Any, system: System, now: Instant) -> dict[str, Any]:
    """What the hooks of linked groups write into forces and tangents at an instant, by hook."""
    n = now.q.size
    a, r, f = np.zeros((3, n))
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    _ask_forces(linked, system.dofs, now.time, now.q.copy(), now.v.copy(), a, r, f, matrix)
    return {"residual": (r,), "force": (f,), "tangent": matrix[:-1]}


def _energies(linked: Any, system: System, now: Instant) -> dict[str, Any]:
    """What they write into energies and powers."""
    e, s, p = np.zeros(3), np.zeros(2), np.zeros(2)
    _ask_energies(linked, now.time, now.q.copy(), now.v.copy(), e, s, p)
    return {"energy": (e,), "supply": (s,), "dissipation": (p,)}


def _without_number(group: Any, sums: tuple[str, ...], ask: Ask, system: System, now: Instant) -> str:
    """The hook of a group by which one of some sums is no finite number at an instant; empty if all are."""
    own = copy.deepcopy(group)
    found = ask(link((own,), *sums), system, now)
    offered = (hook for hook in found if hook in KINDS[type(group)].hooks)
    return next((hook for hook in offered if not all(np.isfinite(array).all() for array in found[hook])), "")
