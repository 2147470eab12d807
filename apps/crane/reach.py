"""The static start: which length of rope makes a drawing true."""

from __future__ import annotations

import math

import numpy as np

from crane.layout import Layout
from crane.masses import Drums, Supplies
from crane.scene import Drum, End, Sheave
from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.state import State, new_state
from tautline.integrators.status import StoppedEarly
from tautline.system.system import System

ITERATIONS = 40
CLOSE = 1.0e-9
"""Height, as a share of the longest piece of rope, within which the drawing is true."""
SHORTEST_WAY = 0.3
"""Share of the shortest piece of rope by which its length may change in one iteration."""


def stretch_of(tension: float, stiffness: float) -> float:
    """Stretch lambda at which N = EA (lambda^2 - 1) lambda / 2 is a tension."""
    stretch = 1.0 + tension / stiffness
    for _ in range(50):
        force = 0.5 * stiffness * (stretch * stretch - 1.0) * stretch - tension
        change = force / (0.5 * stiffness * (3.0 * stretch * stretch - 1.0))
        stretch -= change
        if abs(change) < 1.0e-15 * stretch:
            break
    return stretch


def draw_true(layout: Layout, system: System) -> list[str]:
    """Bring a scene to rest, with as much rope as makes its load hang as high as drawn.

    Rope is added at an end that is no drum, where there is one. What is found is left in the system; where there is no
    equilibrium nothing is: the run says so.

    Returns
    -------
    list of str
        Notes for the user.
    """
    state = new_state(system)
    limit = SHORTEST_WAY * float(layout.path.chords.min())
    masses = _hanging(layout)
    given = layout.scene.rope.length is not None
    try:
        find_equilibrium(system, state, limit)
        if masses and not given:
            _lengthen(layout, system, state, masses, limit)
    except StoppedEarly:
        return []
    moved = _farthest(layout, system, state)
    system.q[:] = state.full_q
    if moved is None:
        return []
    return [f"at rest {moved[0]} hangs {moved[1]:.3g} m from where it is drawn"]


def _hanging(layout: Layout) -> dict[int, float]:
    """Mass of every body that hangs on the rope and is free to rise, by the place of its height."""
    scene = layout.scene
    names = {item.body for item in scene.path if isinstance(item, (End, Sheave)) and item.body is not None}
    bodies = [scene.body(name) for name in sorted(names)]
    return {layout.body[b.name] + 2: b.mass for b in bodies if "z" not in b.guide and b.mass > 0.0}


def _height(state: State, masses: dict[int, float]) -> float:
    return sum(mass * float(state.full_q[place]) for place, mass in masses.items()) / sum(masses.values())


def _lengthen(layout: Layout, system: System, state: State, masses: dict[int, float], limit: float) -> None:
    """Secant iteration on the rope's length."""
    drawn = sum(m * float(layout.degrees.value[place]) for place, m in masses.items()) / sum(masses.values())
    close = CLOSE * float(layout.path.chords.max())
    last, slope = None, -1.0 / max(1, _falls(layout))
    for _ in range(ITERATIONS):
        off = _height(state, masses) - drawn
        if abs(off) <= close:
            return
        if last is not None and abs(off - last[1]) > 0.0:
            fitted = (off - last[1]) / last[0]
            slope = fitted if fitted < 0.0 else slope
        step = -off / slope
        step = math.copysign(min(abs(step), limit), step)
        last = step, off
        _add_rope(layout, system, state, step)
        find_equilibrium(system, state, limit)


def _falls(layout: Layout) -> int:
    return sum(
        (2 if isinstance(item, Sheave) else 1)
        for item in layout.scene.path
        if isinstance(item, (End, Sheave)) and item.body is not None
    )


def _add_rope(layout: Layout, system: System, state: State, length: float) -> None:
    """Move the material at an end of the rope; that of all spans goes along in the next equilibrium."""
    path = layout.scene.path
    i = len(path) - 1 if not isinstance(path[-1], Drum) or isinstance(path[0], Drum) else 0
    way = length if i else -length
    place = layout.supply[i][0] if i in layout.supply else layout.material(i)
    system.q[place] += way
    state.full_q[place] += way
    for k in np.flatnonzero(system.dofs.held == place):
        system.dofs.offset[k] += way
    state.q[system.free == place] += way
    if isinstance(path[i], Drum):
        _move_supply(layout, system, i, way)


def _move_supply(layout: Layout, system: System, i: int, way: float) -> None:
    """What is on a drum is counted from where its rope begins now."""
    place = layout.material(i)
    for group in system.groups:
        if isinstance(group, Supplies):
            group.least[group.p == place] += way
        elif isinstance(group, Drums):
            group.rows["begin"][group.rows["p"] == place] += way


def _farthest(layout: Layout, system: System, state: State) -> tuple[str, float] | None:
    """Body that hangs farthest from where it is drawn, and how far, m, if that is plain to see."""
    away = {
        body.name: float(
            np.linalg.norm(state.full_q[layout.body[body.name] :][:3] - layout.degrees.value[layout.body[body.name] :][:3])
        )
        for body in layout.scene.bodies
    }
    if not away:
        return None
    name = max(away, key=lambda body: away[body])
    return (name, away[name]) if away[name] > 0.01 else None
