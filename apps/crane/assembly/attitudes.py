"""How bodies are turned at rest: as little as they have to be, and not over."""

from __future__ import annotations

import math
from collections.abc import Container

import numpy as np

from crane.assembly.friction import slips
from crane.assembly.layout import AXES, Layout
from crane.geometry.quaternion import QUATERNION, quaternion_of, rotation_of, turned_least
from crane.groups.span import FORCE, STRAIGHT, Spans
from crane.scene.scene import End, Sheave
from tautline.integrators.state import State
from tautline.integrators.status import Status, StoppedEarly
from tautline.system.system import System

TURNED = 95.0
"""Angle, deg, between the axis of a body that is up as it is laid out and at rest, beyond which another side is up. A
body that lies on its side may have been meant so, and rounding decides nothing."""
ASKEW = 5.0
"""The same beyond which a load in a sling that has slipped is no longer as it is drawn."""
SLIPPED = 5.0e-3
"""Share of a sling by which one leg has become longer than drawn, beyond which it has slipped."""


def hang_below(layout: Layout, system: System, state: State, held: Container[str]) -> bool:
    """Turn bodies that balance above the one end they are tied to, about it, until they hang in line with their rope.

    The rope pulls alike at both rests, for the force on a body does not depend on how it is turned. Whether there was
    such a body; a search finds the rest of it.
    """
    spans, turned = _spans_of(system), False
    for name, item, offset in _hung_by_one_end(layout):
        turn, place, arm = layout.turn[name], layout.body[name], layout.arm[item]
        lever, pull = state.full_q[arm : arm + AXES], _pull(layout, spans, name)
        if name in held or not float(pull @ lever) < 0.0:
            continue
        found = state.full_q[turn : turn + QUATERNION]
        at = state.full_q[place : place + AXES] + lever
        found[:] = turned_least(found, lever, pull)
        lever[:] = rotation_of(found) @ offset
        state.full_q[place : place + AXES] = at - lever
        turned = True
    if turned:
        state.q[:] = state.full_q[system.free]
    return turned


def turn_back(layout: Layout, system: System, state: State, held: Container[str], set_down: Container[str]) -> None:
    """Turn bodies that hang by one end about the line from it to their centre: each is then turned by the least angle.

    Nothing resists that turn: all attitudes about the line are rest, and the search ends with one that its way has led
    to. Bodies that are ``held`` stay; those that were ``set_down`` began as drawn, the others as they are laid out.
    """
    for name, _, offset in _hung_by_one_end(layout):
        turn = layout.turn[name]
        if name in held:
            continue
        found, begin = state.full_q[turn : turn + QUATERNION], layout.degrees.value[turn : turn + QUATERNION]
        if name in set_down:
            begin = quaternion_of(layout.scene.body(name).orientation)
        least = turned_least(begin, rotation_of(begin) @ offset, rotation_of(found) @ offset)
        found[:] = least * np.linalg.norm(found) / np.linalg.norm(least)
    state.q[:] = state.full_q[system.free]


def _hung_by_one_end(layout: Layout) -> list[tuple[str, int, np.ndarray]]:
    """Bodies that one end of the rope alone can turn: their names, the end's item, and where on the body it is, m."""
    ends: dict[str, list[tuple[str, int, np.ndarray]]] = {}
    for i, item in enumerate(layout.scene.path):
        if isinstance(item, End) and i in layout.arm:
            ends.setdefault(item.body, []).append((item.body, i, np.array(item.offset)))
    return [found[0] for found in ends.values() if len(found) == 1]


def _spans_of(system: System) -> Spans:
    return next(group for group in system.groups if isinstance(group, Spans))


def refuse_turned(layout: Layout, system: System, state: State) -> None:
    """Refuse a rest at which a body has another side up than in its drawing, or is askew because a sling slipped.

    A body that leans in the wind, in line with its rope, has no other side up, and is not askew: what counts as up is
    the line that its ropes pull along too.

    Raises
    ------
    StoppedEarly
        For such a body, with `Status.NO_EQUILIBRIUM`.
    """
    scene = layout.scene
    up = -np.array(scene.gravity, dtype=float)
    if not up.any():
        return
    up /= np.linalg.norm(up)
    spans = _spans_of(system)
    for name, turn in layout.turn.items():
        found = rotation_of(state.full_q[turn : turn + QUATERNION])
        # One that the ground has come to carry stands as it is drawn, not as it was laid out to hang.
        begins = layout.degrees.value[turn : turn + QUATERNION], quaternion_of(scene.body(name).orientation)
        sides = [found @ (rotation_of(begin).T @ up) for begin in begins]
        pull = _pull(layout, spans, name)
        line = pull / np.linalg.norm(pull) if pull.any() else up
        angle = min(_angle(one, side) for one in (up, line) for side in sides)
        if angle > TURNED:
            detail = (
                f"at rest it would lie on its side or upside down: its upper side would turn by {angle:.3g} deg. Let "
                "the rope hold it above its centre of mass, or give an `orientation:` close to that at rest"
            )
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, name, detail)
        askew = min(_angle(line, side) for side in sides)
        sheave = _slipped_over(layout, spans, name) if askew > ASKEW else None
        if sheave is not None:
            detail = (
                f"without friction its sling slips over the locked sheave {sheave}, and it would begin {askew:.3g} deg "
                "askew: the static start is found without the friction that may hold it. If friction is to hold it, "
                "draw it as it hangs and write `start: as drawn`. If the sling may slip, write `law: frictionless`"
            )
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, name, detail)


def _angle(one: np.ndarray, other: np.ndarray) -> float:
    """Angle between two unit vectors, deg."""
    return math.degrees(math.acos(min(1.0, max(-1.0, float(one @ other)))))


def _is_on(item: object, name: str) -> bool:
    return isinstance(item, (End, Sheave)) and item.body == name


def _pull(layout: Layout, spans: Spans, name: str) -> np.ndarray:
    """What ropes pull at a body with, all together, (3,) N."""
    pull, force = np.zeros(AXES), np.maximum(spans.found[:, FORCE], 0.0)
    for i, item in enumerate(layout.scene.path):
        if _is_on(item, name):
            station = layout.item[i]
            if station > 0:
                pull -= force[station - 1] * spans.start[station - 1]
            if station < len(force):
                pull += force[station] * spans.start[station]
    return pull


def _slipped_over(layout: Layout, spans: Spans, name: str) -> str | None:
    """A locked sheave with friction over which the search has let a body's sling slip, if there is one.

    It has where one leg has become longer from sheave to load. Rope that comes onto the sheave, or off it, as the load
    swings about it in the wind is no slip.
    """
    path = layout.scene.path
    tied = [i for i, item in enumerate(path) if _is_on(item, name)]
    drawn = np.array([span.length for span in layout.path.spans])
    found = np.array([spans.found[first:last, STRAIGHT].sum() for first, last in layout.spans])
    for i, item in enumerate(path):
        if not (tied and tied[0] < i < tied[-1] and isinstance(item, Sheave) and item.locked and slips(item)):
            continue
        shares = [legs[tied[0] : i].sum() / legs[tied[0] : tied[-1]].sum() for legs in (drawn, found)]
        if abs(shares[1] - shares[0]) > SLIPPED:
            return item.name
    return None
