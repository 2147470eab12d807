"""The static start: which length of rope makes a drawing true."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from crane.assembly.attitudes import hang_below, refuse_turned, turn_back
from crane.assembly.friction import slips
from crane.assembly.layout import AXES, Layout, stands
from crane.geometry.quaternion import QUATERNION, quaternion_of
from crane.groups.arcs import Arcs
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
STEADY = 1.0e-7
"""Moment, over that of a rope's pull, against which a body turns by a radian in an iteration of the search, and not at
rest. What rounding leaves of a moment turns nothing. An iteration is off by as much over the pull that there is: beside
springs that carry most of a load a rope pulls with next to nothing."""
SHORTEST_WAY = 0.3
"""Share of the shortest piece of rope by which its length may change in one iteration."""
CAREFUL = 0.1
"""Share of that by which it may where rest was found with slack rope alone. A slight rope on few elements is folded by
a longer way, and pulls an empty hook up to its sheave, though it rests taut close to where it is drawn."""


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
        held = _Held(layout, system, state)
        _rest_where_held(held, limit)
        if system.turns.size and count_negative(system, state).negative > 0 and not held.by_sheaves(state):
            _leave_unstable(held, limit)
        turn_back(layout, system, state, held.turns, held.lying)
    refuse_turned(layout, system, state)
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


class _Held:
    """What friction and the ground hold while rest is sought.

    The ground holds how a body is turned that it carries, and by friction where it is: from the start if it is drawn
    there, else once a search has set it down. They are among what stays at rest, until the rope has lifted the body, or
    pulls more than friction holds. The ground gives the model no moment, but a crate that stands on it does not turn.

    A locked sheave holds its rope by friction where a rest would be unstable without.
    """

    def __init__(self, layout: Layout, system: System, state: State) -> None:
        self.layout, self.system, self.state = layout, system, state
        scene, self.begin = layout.scene, state.q.copy()
        carries = scene.ground is not None and scene.rope.length is not None
        bodies = scene.bodies if carries else []
        self.of_turns = {body.name: self._rows(layout.turn[body.name], QUATERNION) for body in bodies if body.inertia}
        self.of_places = {body.name: self._rows(layout.body[body.name], ACROSS) for body in bodies}
        self.of_sheaves = [
            row
            for i, item in enumerate(layout.scene.path)
            if isinstance(item, Sheave) and item.locked and slips(item)
            for row in self._rows(layout.material(i), 1)
        ]
        # A run before may have found that it holds something else.
        own = {row for rows in (*self.of_turns.values(), *self.of_places.values(), self.of_sheaves) for row in rows}
        self.driven = [row for row in system.at_rest.tolist() if row not in own]
        self.lying = [body.name for body in bodies if stands(scene, body)]
        self.turns = {name: rows for name, rows in self.of_turns.items() if name in self.lying}
        self.places = {name: rows for name, rows in self.of_places.items() if name in self.lying}
        self.sheaves: list[int] = []
        self._hold()

    def _rows(self, place: int, count: int) -> list[int]:
        """Unknowns among ``count`` degrees of freedom from a place on."""
        return np.flatnonzero((self.system.free >= place) & (self.system.free < place + count)).tolist()

    def _hold(self, more: Sequence[int] = ()) -> None:
        held = [row for rows in (*self.turns.values(), *self.places.values(), self.sheaves, more) for row in rows]
        self.system.at_rest = np.array([*self.driven, *dict.fromkeys(held)], dtype=np.int64)

    def by_sheaves(self, state: State) -> bool:
        """Hold the rope on locked sheaves if it then is a stable rest; whether it is.

        The rest was found without friction: both sides pull alike there, and any friction holds that.
        """
        if not self.of_sheaves:
            return False
        self.sheaves = self.of_sheaves
        self._hold()
        if count_negative(self.system, state).negative == 0:
            return True
        self.sheaves = []
        self._hold()
        return False

    def only_turns(self, state: State) -> bool:
        """Whether all motions that lower the energy turn a body: without its turning, none does."""
        self._hold(self.system.turns.tolist())
        try:
            return count_negative(self.system, state).negative <= 0
        finally:
            self._hold()

    def sets_down(self, state: State) -> bool:
        """Hold bodies that the ground has come to carry, and begin again from the drawing; whether there are any."""
        layout, scene = self.layout, self.layout.scene
        new = [name for name in self.of_places if name not in self.lying and self._push(name, state) > 0.0]
        if not new:
            return False
        state.q[:] = self.begin
        self.lying += new
        for name in new:
            self.places[name] = self.of_places[name]
            if name in self.of_turns:
                rows, drawn = self.of_turns[name], quaternion_of(scene.body(name).orientation)
                self.turns[name] = rows
                state.q[rows] = drawn[self.system.free[rows] - layout.turn[name]]
        self._hold()
        return True

    def _push(self, name: str, state: State) -> float:
        """How hard the ground pushes a body up, N; negative above it."""
        ground = self.layout.scene.ground
        if ground is None:
            return 0.0
        height = float(state.full_q[self.layout.body[name] + 2])
        return ground.stiffness * (ground.level + self.layout.scene.body(name).bottom - height)

    def lets_go(self, state: State) -> bool:
        """Let go what the ground does not hold at the rest that was found; whether that is anything."""
        system, before = self.system, self.system.at_rest.size
        ground = self.layout.scene.ground
        if ground is None or before == len(self.driven):
            return False
        force = np.zeros(system.size)
        evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, system.spare_factors().matrix, force)
        for name in {**self.turns, **self.places}:
            push = self._push(name, state)
            pull = float(np.linalg.norm(force[self.places.get(name, [])]))
            if push <= 0.0:
                self.turns.pop(name, None)
            if push <= 0.0 or pull > ground.friction * push:
                self.places.pop(name, None)
        self._hold()
        return system.at_rest.size < before


def _rest_where_held(held: _Held, limit: float) -> None:
    """Find rest, and what friction and the ground hold there. Each body is set down and let go once."""
    _rest_as_drawn(held.layout, held.system, held.state, limit)
    while held.lets_go(held.state) or held.sets_down(held.state):
        _rest_as_drawn(held.layout, held.system, held.state, limit)


def _leave_unstable(held: _Held, limit: float) -> None:
    """Leave a rest that is unstable because a body would overturn; any other is left to who drew it."""
    layout, system, state = held.layout, held.system, held.state
    if not held.only_turns(state):
        return
    if hang_below(layout, system, state, held.turns):
        _rest_where_held(held, limit)
        if count_negative(system, state).negative <= 0:
            return
    find_stable_equilibrium(system, state, limit)
    _rest_where_held(held, limit)


def _rest_as_drawn(layout: Layout, system: System, state: State, limit: float) -> None:
    """Find rest with the length of rope that there is, or with that which lets the load hang as high as drawn."""
    _rest(system, state, limit)
    if finds_rope(layout):
        _lengthen(layout, system, state, _hanging(layout), limit)


def finds_rope(layout: Layout) -> bool:
    """Whether the static start finds how much rope there is, so that the load hangs as high as drawn."""
    return layout.scene.rope.length is None and bool(_hanging(layout))


def _hold(layout: Layout, system: System, state: State) -> None:
    """Let brakes begin with the force that holds their drums at rest, as far as they can.

    They would else give way until their springs are wound up, and the load with them.
    """
    contacts = next((group for group in system.groups if isinstance(group, Slips)), None)
    if contacts is None:
        return
    for place in (layout.material(i) for i, item in enumerate(layout.scene.path) if isinstance(item, Drum)):
        lacking = -float(state.residual[place])
        for k, row in enumerate(contacts.rows):
            if row.kind == TORQUE and row.p == place:
                limit = row.coefficient * min(1.0, max(0.0, value_at(contacts.functions, row.function, 0.0)[0]))
                limit *= max(1.0, contacts.found[row.before, STRETCH]) / row.by_p
                contacts.force[k] = min(max(lacking / row.by_p, -limit), limit)
                lacking -= row.by_p * contacts.force[k]


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
        if _rests_taut(system, state, spans, limit):
            return
        pushing = state.q.copy()
        state.q[:] = begin
        if _rests_taut(system, state, spans, CAREFUL * limit):
            return
        state.q[:] = pushing
    finally:
        spans.rows["slack"] = slack
    try:
        find_equilibrium(system, state, limit)
    except StoppedEarly:
        state.q[:] = begin
        find_equilibrium(system, state, limit)


def _rests_taut(system: System, state: State, spans: Spans, limit: float) -> bool:
    """Whether a search finds rest with all of the rope taut; where it finds none the state is what it was."""
    begin = state.q.copy()
    try:
        find_equilibrium(system, state, limit)
    except StoppedEarly:
        state.q[:] = begin
        return False
    return bool((spans.found[:, FORCE] > 0.0).all())


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
        elif isinstance(group, Arcs):
            group.rows["begin"][(group.rows["stored"] == 1) & (group.rows["side"] == (0 if i == 0 else 1))] += way
