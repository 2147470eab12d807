"""The static start: which length of rope makes a drawing true."""

from __future__ import annotations

import math

import numpy as np

from crane.assembly.layout import AXES, Layout
from crane.groups.capstan_friction import TORQUE, Slips
from crane.groups.span import FORCE, MATERIAL, STRETCH, Spans
from crane.groups.winch import Drums, Supplies, WoundRope
from crane.scene.bodies import XYZ
from crane.scene.scene import Drum, End, Sheave
from tautline.integrators.state import State
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.time_function import value_at
from tautline.system.system import System

ITERATIONS = 40
CLOSE = 1.0e-9
"""Height, as a share of the longest piece of rope, within which the drawing is true."""
TRUE = 1.0e-6
"""The same, beyond which it is not: a search that ends there has failed."""
SHORTEST_WAY = 0.3
"""Share of the shortest piece of rope by which its length may change in one iteration."""


def stretch_of(tension: float, stiffness: float, strain: str = "green") -> float:
    """Stretch lambda at which N = EA (lambda^2 - 1) lambda / 2, or EA (lambda - 1), is a tension."""
    stretch = 1.0 + tension / stiffness
    if strain == "engineering":
        return stretch
    for _ in range(50):
        force = 0.5 * stiffness * (stretch * stretch - 1.0) * stretch - tension
        change = force / (0.5 * stiffness * (3.0 * stretch * stretch - 1.0))
        stretch -= change
        if abs(change) < 1.0e-15 * stretch:
            break
    return stretch


def draw_true(layout: Layout, system: System, state: State) -> None:
    """Bring a scene to rest, with as much rope as makes its load hang as high as drawn.

    Rope is added at an end that is no drum, where there is one; where the scene gives the rope's length, none is.

    Parameters
    ----------
    layout : Layout
    system : System
        In which the material at the rope's end is changed.
    state : State
        Where the search starts, and where the equilibrium is left.

    Raises
    ------
    StoppedEarly
        NO_EQUILIBRIUM, naming the unknown that is worst, or a load that no length of rope brings to where it is drawn.
    """
    limit = SHORTEST_WAY * float(layout.path.chords.min())
    _rest(system, state, limit)
    if finds_rope(layout):
        _lengthen(layout, system, state, _hanging(layout), limit)
    spans = next(group for group in system.groups if isinstance(group, Spans))
    spans.laid[:] = state.full_q[np.array(layout.station) + MATERIAL]
    _hold(layout, system, state)


def finds_rope(layout: Layout) -> bool:
    """Whether the static start finds how much rope there is, so that the load hangs as high as drawn."""
    return layout.scene.rope.length is None and bool(_hanging(layout))


def _hold(layout: Layout, system: System, state: State) -> None:
    """Let brakes begin with the force that holds their drums at rest, as far as they can.

    They would else give way until their springs are wound up, and the load with them.
    """
    slips = next((group for group in system.groups if isinstance(group, Slips)), None)
    if slips is None:
        return
    for place in (layout.material(i) for i, item in enumerate(layout.scene.path) if isinstance(item, Drum)):
        lacking = -float(state.residual[place])
        for k, row in enumerate(slips.rows):
            if row.kind == TORQUE and row.p == place:
                limit = row.coefficient * min(1.0, max(0.0, value_at(slips.functions, row.function, 0.0)[0]))
                limit *= max(1.0, slips.found[row.before, STRETCH]) / row.by_p
                slips.force[k] = min(max(lacking / row.by_p, -limit), limit)
                lacking -= row.by_p * slips.force[k]


def _rest(system: System, state: State, limit: float) -> None:
    """Find the equilibrium first of a rope that could push, then of the one there is.

    A little too much rope would leave a span slack, which nothing straightens again; where the rope hangs taut in the
    end the two are the same.
    """
    spans = next(group for group in system.groups if isinstance(group, Spans))
    begin, slack = state.q.copy(), spans.rows["slack"].copy()
    if not slack.any():
        find_equilibrium(system, state, limit)
        return
    try:
        spans.rows["slack"] = 0
        find_equilibrium(system, state, limit)
        if (spans.found[:, FORCE] > 0.0).all():
            return
    except StoppedEarly:
        state.q[:] = begin
    finally:
        spans.rows["slack"] = slack
    try:
        find_equilibrium(system, state, limit)
    except StoppedEarly:
        state.q[:] = begin
        find_equilibrium(system, state, limit)


def _hanging(layout: Layout) -> dict[int, float]:
    """What makes the height of the load: the weight of every body on the rope along each axis that it is free to move
    along, N, by place."""
    scene = layout.scene
    names = {item.body for item in scene.path if isinstance(item, (End, Sheave)) and item.body is not None}
    bodies = [scene.body(name) for name in sorted(names)]
    # Where no body has a mass each counts alike: the rope's own weight hangs on them.
    massless = all(body.mass == 0.0 for body in bodies)
    weights = {
        layout.body[body.name] + c: (1.0 if massless else body.mass) * scene.gravity[c]
        for body in bodies
        for c in range(AXES)
        if XYZ[c] not in body.guide
    }
    return {place: weight for place, weight in weights.items() if weight != 0.0}


def _height(x: np.ndarray, weights: dict[int, float]) -> float:
    """How high the load is in a field of gravity, m."""
    return -sum(w * float(x[place]) for place, w in weights.items()) / sum(abs(w) for w in weights.values())


def _lengthen(layout: Layout, system: System, state: State, weights: dict[int, float], limit: float) -> None:
    """Secant iteration on the rope's length; raises StoppedEarly where it finds none."""
    drawn = _height(layout.degrees.value, weights)
    close = CLOSE * float(layout.path.chords.max())
    last, slope = None, -1.0 / max(1, _falls(layout))
    for _ in range(ITERATIONS):
        off = _height(state.full_q, weights) - drawn
        if abs(off) <= close:
            return
        if last is not None and abs(off - last[1]) > 0.0:
            fitted = (off - last[1]) / last[0]
            slope = fitted if fitted < 0.0 else slope
        step = -off / slope
        step = math.copysign(min(abs(step), limit), step)
        last = step, off
        _add_rope(layout, system, state, step)
        _rest(system, state, limit)
    off = _height(state.full_q, weights) - drawn
    if abs(off) > TRUE * float(layout.path.chords.max()):
        way = "higher" if off > 0.0 else "lower"
        detail = (
            "no length of rope was found with which the load rests where it is drawn: it comes to rest "
            f"{abs(off):.4g} m {way} than it is drawn; give rope.length"
        )
        raise StoppedEarly(
            Status.NO_EQUILIBRIUM, 0.0, system.places[max(weights, key=lambda place: abs(weights[place]))], detail
        )


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
    place = layout.supply.get(i, layout.material(i))
    system.q[place] += way
    state.full_q[place] += way
    state.q[system.free == place] += way
    if isinstance(path[i], Drum):
        _move_supply(layout, system, i, way)


def _move_supply(layout: Layout, system: System, i: int, way: float) -> None:
    """What is on a drum is counted from where its rope begins now."""
    place = layout.material(i)
    for group in system.groups:
        if isinstance(group, Supplies):
            group.least[group.p == place] += way
            group.most[group.p == place] += way
        elif isinstance(group, (Drums, WoundRope)):
            group.rows["begin"][group.rows["p"] == place] += way
