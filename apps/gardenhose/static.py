"""Form finding: the shape in which a hose is at rest while water flows through it (thesis, Fig. 2.28)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gardenhose.cables import arc_lengths, assembled, step_limit
from gardenhose.limits import stretches
from gardenhose.scene import HoseScene, tied, with_speed
from tautline.cable.model.build import Assembly
from tautline.integrators.state import State, new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.stability import count_negative, find_stable_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.hermite import SHAPE, table
from tautline.results.assessment.limits import STRETCH
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown
from tautline.system.system import System

POINTS_PER_ELEMENT = 8
"""Points of the curve that is drawn."""
SMALLEST_PART = 1.0 / 64.0
"""Part of the way from one speed to the next below which form finding gives up."""


class Form(NamedTuple):
    """A hose at rest at a flow speed, m/s: position and slope of its nodes (n, 3), its system and state."""

    speed: float
    position: np.ndarray
    slope: np.ndarray
    system: System
    state: State

    @property
    def tip(self) -> np.ndarray:
        """Position of the tip (3,), m."""
        return self.position[-1]

    @property
    def negative(self) -> int:
        """Negative pivots of the tangent: 0 for a stable shape, -1 where they prove nothing, as with a free tip."""
        return count_negative(self.system, self.state).negative

    @property
    def sag(self) -> tuple[float, int]:
        """How far the hose is from the straight line between its ends, m, and the number of the node where it is."""
        chord = self.position[-1] - self.position[0]
        along = chord / max(float(np.linalg.norm(chord)), 1e-300)
        offset = self.position - self.position[0]
        away = np.linalg.norm(offset - np.outer(offset @ along, along), axis=1)
        return float(away.max()), int(away.argmax())

    def curve(self, arc_length: np.ndarray) -> np.ndarray:
        """Points along the elements' own cubic (m, 3), m."""
        length = np.diff(arc_length)[:, None, None]
        h = table(np.linspace(0.0, 1.0, POINTS_PER_ELEMENT + 1), np.ones(POINTS_PER_ELEMENT + 1))[:, SHAPE : SHAPE + 4]
        x, d = self.position, self.slope
        points = h[:, 0, None] * x[:-1, None] + h[:, 1, None] * length * d[:-1, None]
        points = points + h[:, 2, None] * x[1:, None] + h[:, 3, None] * length * d[1:, None]
        return np.vstack([points[:, :-1].reshape(-1, 3), points[-1, -1:]])


def forms(scene: HoseScene, speeds: Sequence[float]) -> list[Form]:
    """Shapes at rest at several speeds of flow, each sought from the one before, with hose and water `tied`.

    Raises
    ------
    SceneError
        If the scene has no water, or cannot be built.
    StoppedEarly
        NO_EQUILIBRIUM, where none is found at a speed; its ``detail`` names it.
    """
    scene, found = tied(scene), list[Form]()
    for speed in speeds:
        found.append(_next(scene, float(speed), found[-1] if found else None))
    return found


def form(scene: HoseScene, speed: float, near: Form | None = None) -> Form:
    """The shape at rest at a speed, sought from another's."""
    return _next(scene, float(speed), near)


def stable_beside(scene: HoseScene, one: Form) -> Form | None:
    """A stable shape beside one of `forms` that is not, at the same speed; None where none is found."""
    made = assembled(with_speed(tied(scene), one.speed))
    state = new_state(made.system)
    state.q[:] = one.state.q
    try:
        found = find_stable_equilibrium(made.system, state, step_limit(scene))
    except StoppedEarly:
        return None
    return _form_of(made, scene, one.speed, state) if found.negative == 0 else None


def _next(scene: HoseScene, speed: float, near: Form | None) -> Form:
    """Go to a speed at once, or where that fails by parts."""
    try:
        return _find(scene, speed, near)
    except StoppedEarly as stop:
        if near is None:
            detail = f"at a flow of {speed:g} m/s: {stop.detail}"
            raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, stop.part, detail) from None
    here, part = near, 0.5
    while here.speed != speed:
        goal = here.speed + part * (speed - here.speed) if part < 1.0 else speed
        try:
            here = _find(scene, goal, here)
            part = min(1.0, 2.0 * part)
        except StoppedEarly as stop:
            part *= 0.5
            if part < SMALLEST_PART:
                detail = f"at a flow of {goal:g} m/s: {stop.detail}"
                raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, stop.part, detail) from None
    return here


def _find(scene: HoseScene, speed: float, near: Form | None) -> Form:
    made = assembled(with_speed(scene, speed))
    state = new_state(made.system)
    if near is not None:
        state.q[:] = near.state.q
    find_equilibrium(made.system, state, step_limit(scene))
    return _form_of(made, scene, speed, state)


def _form_of(made: Assembly, scene: HoseScene, speed: float, state: State) -> Form:
    starts = [made.layout.start[i + 1] for i in range(len(arc_lengths(scene)))]
    nodes = np.array(starts)[:, None] + np.arange(3)
    return Form(speed, state.full_q[nodes], state.full_q[nodes + 3], made.system, state)


def stretched_at_rest(s: np.ndarray, forms: Sequence[Form], system: str) -> list[SceneWarning]:
    """Warnings of shapes at rest that are squashed or stretched beyond what a run is judged by: the slowest of each."""
    found: list[SceneWarning] = []
    if not forms:
        return found
    stretch, places = stretches(s, np.array([one.position for one in forms]), np.array([one.slope for one in forms]))
    low, high = STRETCH
    for beyond, worst, words in (
        (stretch < low, stretch.argmin(axis=1), f"less than {low:g}"),
        (stretch > high, stretch.argmax(axis=1), f"more than {high:g}"),
    ):
        bad = np.flatnonzero(beyond.any(axis=1)).tolist()
        if bad:
            first = min(bad, key=lambda k: abs(forms[k].speed))
            at = int(worst[first])
            others = f". So it is in {len(bad) - 1} more of the shapes" if len(bad) > 1 else ""
            text = (
                f"the shape at {shown(forms[first].speed, 'm/s', system)} has {stretch[first, at]:.3g} of its "
                f"unstretched length at {places[at]}, {words}{others}. No hose has such a shape. Give more EA, "
                "a lower speed, or less of a nozzle"
            )
            found.append(SceneWarning("--speed", text))
    return found
