"""The static start: which length of rope makes a drawing true."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from crane.assembly.layout import AXES, Layout, stands
from crane.geometry.quaternion import QUATERNION
from crane.groups.capstan_friction import TORQUE, Slips
from crane.groups.rigid import Rigids
from crane.groups.sockets import Sockets
from crane.groups.span import FORCE, MATERIAL, STRETCH, Spans
from crane.groups.winch import Drums, Supplies, WoundRope
from crane.scene.bodies import XYZ
from crane.scene.scene import Drum, End, Sheave
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.stability import count_negative, find_stable_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.time_function import value_at
from tautline.system.system import System

ITERATIONS = 40
CLOSE = 1.0e-9
"""Height, as a share of the longest piece of rope, within which the drawing is true."""
TRUE = 1.0e-6
"""The same, beyond which it is not: a search that ends there has failed."""
ACROSS = 2
"""Axes along the ground."""
TURNED = 90.0
"""Angle, deg, between a body as its scene gives it and at rest beyond which another side of it is up."""
STEADY = 1.0e-4
"""Moment, over that of a rope's pull, against which a body turns by a radian in an iteration of the search, and not at
rest. An iteration is off by as much; what rounding leaves of a moment turns nothing."""
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
    with _kept_as_drawn(system):
        on_ground = _Standing(layout, system)
        _rest_as_drawn(layout, system, state, limit)
        while on_ground.lets_go(state):
            _rest_as_drawn(layout, system, state, limit)
        if system.turns.size and count_negative(system, state).negative > 0:
            find_stable_equilibrium(system, state, limit)
            _rest_as_drawn(layout, system, state, limit)
    _refuse_turned(layout, system, state)
    spans = next(group for group in system.groups if isinstance(group, Spans))
    spans.laid[:] = state.full_q[np.array(layout.station) + MATERIAL]
    _hold(layout, system, state)


@contextmanager
def _kept_as_drawn(system: System) -> Iterator[None]:
    """Within it rest is sought: a body that nothing turns stays as it is drawn."""
    rigids = next((group for group in system.groups if isinstance(group, Rigids)), None)
    sockets = next((group for group in system.groups if isinstance(group, Sockets)), None)
    if rigids is None:
        yield
        return
    for n, turn in enumerate(rigids.rows["turn"]):
        # A pull turns a body by its moment about the centre. Without a lever nothing does, whatever resists it.
        arms = [] if sockets is None else [row.offset for row in sockets.rows if row.turn == turn]
        arm = max((float(np.linalg.norm(one)) for one in arms), default=1.0)
        rigids.steady[n] = STEADY * float(system.scale.max()) * arm
    try:
        yield
    finally:
        rigids.steady[:] = 0.0


class _Standing:
    """What the ground holds of bodies that are drawn on it while rest is sought: how they are turned, and by friction
    where they are.

    They are among what stays at rest, until the rope has lifted the body, or pulls more than friction holds. The ground
    gives the model no moment, but a crate that stands on it does not turn.
    """

    def __init__(self, layout: Layout, system: System) -> None:
        self.layout, self.system = layout, system
        scene = layout.scene
        bodies = [body for body in scene.bodies if stands(scene, body)]
        self.turns = {body.name: self._rows(layout.turn[body.name], QUATERNION) for body in bodies if body.inertia}
        self.places = {body.name: self._rows(layout.body[body.name], ACROSS) for body in bodies}
        # A run before may have found that it holds something else.
        own = [row for held in (*self.turns.values(), *self.places.values()) for row in held]
        self.driven = [row for row in system.at_rest.tolist() if row not in own]
        self._hold()

    def _rows(self, place: int, count: int) -> list[int]:
        """Unknowns among ``count`` degrees of freedom from a place on."""
        return np.flatnonzero((self.system.free >= place) & (self.system.free < place + count)).tolist()

    def _hold(self) -> None:
        held = [row for rows in (*self.turns.values(), *self.places.values()) for row in rows]
        self.system.at_rest = np.array([*self.driven, *held], dtype=np.int64)

    def lets_go(self, state: State) -> bool:
        """Let go what the ground does not hold at the rest that was found; whether that is anything."""
        scene, system, before = self.layout.scene, self.system, self.system.at_rest.size
        ground = scene.ground
        if ground is None or before == len(self.driven):
            return False
        force = np.zeros(system.size)
        evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, system.spare_factors().matrix, force)
        for name in {**self.turns, **self.places}:
            height = float(state.full_q[self.layout.body[name] + 2])
            push = ground.stiffness * (ground.level + scene.body(name).bottom - height)
            pull = float(np.linalg.norm(force[self.places.get(name, [])]))
            if push <= 0.0:
                self.turns.pop(name, None)
            if push <= 0.0 or pull > ground.friction * push:
                self.places.pop(name, None)
        self._hold()
        return system.at_rest.size < before


def _rest_as_drawn(layout: Layout, system: System, state: State, limit: float) -> None:
    """Find rest with the length of rope that there is, or with that which lets the load hang as high as drawn."""
    _rest(system, state, limit)
    if finds_rope(layout):
        _lengthen(layout, system, state, _hanging(layout), limit)


def _refuse_turned(layout: Layout, system: System, state: State) -> None:
    """Refuse a rest at which a body is turned to another side than its scene gives: it is not what was meant."""
    for name, turn in layout.turn.items():
        drawn, found = system.q[turn : turn + QUATERNION], state.full_q[turn : turn + QUATERNION]
        cosine = abs(float(drawn @ found)) / float(np.linalg.norm(drawn) * np.linalg.norm(found))
        angle = 2.0 * math.degrees(math.acos(min(1.0, cosine)))
        if angle > TURNED:
            detail = (
                f"near its initial orientation it is not at rest, or stands on its head: it would turn by {angle:.3g} "
                "deg. Let the rope hold it above its centre of mass, or give an `orientation:` close to that at rest"
            )
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, name, detail)


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
