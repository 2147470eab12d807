"""What moves with a jump at the start of a crane's run, and how much tension all of it together causes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crane.assembly.drum_supply import supply_of
from crane.assembly.estimates import Estimate
from crane.assembly.layout import entries_of
from crane.assembly.loads import pull_on
from crane.scene.scene import Drum
from crane.sea.compensation import Compensation
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import sample
from tautline.system.time_functions import FunctionRequest, compile_functions

SUDDEN = 0.01
"""Share of the tension at rest that a jump in speed may add without a word."""
BOUNCES_SEEN = 4.0
"""Bounces of the load after the delay of a late actuator, over which its swing is looked for."""
PER_BOUNCE = 200
"""Times in one bounce at which the rate is taken."""


class Jumps(NamedTuple):
    """Motion at t = 0 of what the load hangs on, while the load rests.

    Attributes
    ----------
    fastest : float
        Largest speed of a point of the path in a moving frame, m/s, and `point`, its name.
    drums : tuple of (Drum, float)
        Drums that pay out by prescription, and the speed that their operators ask for, m/s, positive out.
    answer : float
        Speed at which heave compensation pays out at each of them, m/s.
    rate : float
        Speed at which all of it together lengthens the rope, m/s.
    front : float
        Largest of the fronts that run along the rope, N.
    swing : float
        Tension that the bounce of the load adds and takes, N.
    late : bool
        Whether the actuator rests at t = 0 and has to catch up: then the swing is that of its whole start.
    """

    fastest: float
    point: str
    drums: tuple[tuple[Drum, float], ...]
    answer: float
    rate: float
    front: float
    swing: float
    late: bool


def jumps_of(found: Estimate, actuator: Compensation | None) -> Jumps:
    """Add up with their signs all speeds that begin at t = 0: the load feels their sum only.

    Parameters
    ----------
    found : Estimate
    actuator : Compensation or None
        Of the heave compensation, where there is one: every drum that pays out by prescription pays it out too.
    """
    begin = np.zeros(1)
    fastest, point = _fastest(found)
    supplies = ((drum, supply_of(found.scene, drum)) for drum in found.scene.drums)
    drums = tuple((drum, float(supply.speed[0])) for drum, supply in supplies if supply is not None)
    answer = 0.0 if actuator is None or fastest == 0.0 else float(_answers(actuator, begin)[0])
    paid = sum(speed + answer for _, speed in drums)
    lengthening = float(_lengthening(found, begin)[0])
    rate = lengthening - paid
    front = found.impedance * max([fastest, *(abs(speed + answer) for _, speed in drums)])
    swing = found.bounce_of(rate)
    heaves = max(fastest * found.impedance, found.bounce_of(lengthening)) > SUDDEN * found.largest_tension
    # a limit that is met later has nothing to do with the start: it is told with its share of the run
    late = heaves and answer == 0.0 and actuator is not None and actuator.away > 0.0
    if actuator is not None and late:
        swing = _swing_of(found, actuator, sum(speed for _, speed in drums), len(drums))
    return Jumps(fastest, point, drums, answer, rate, front, swing, late)


def _hung(found: Estimate) -> list[tuple[int, int]]:
    """Numbers of the items of the path in moving frames, and of the first entry of their frames."""
    layout = found.layout
    if found.scene.start != "static" or not layout.frames:
        return []
    frames = [(i, int(layout.wheels.frame[i])) for i in range(len(found.scene.path))]
    rides = [getattr(item, "body", None) is not None for item in found.scene.path]
    return [(i, frame) for i, frame in frames if not rides[i] and frame != layout.frame[-1]]


def _velocities(found: Estimate, time: np.ndarray) -> dict[int, np.ndarray]:
    """Velocity (m, 3), m/s, at times (m,) of every item of the path in a moving frame, by its number."""
    hung, layout = _hung(found), found.layout
    velocities: dict[int, np.ndarray] = {}
    if not hung:
        return velocities
    functions = compile_functions(layout.requests.of)
    for i, frame in hung:
        item = found.scene.path[i]
        rates = entries_of(layout.degrees, functions, range(frame, frame + ENTRIES), time, order=1)
        drawn = np.array(getattr(item, "center", None) or getattr(item, "position", None))
        velocities[i] = rates[:, :3] + np.einsum("mji,j->mi", rates[:, 3:].reshape(-1, 3, 3), drawn)
    return velocities


def _fastest(found: Estimate) -> tuple[float, str]:
    """Largest speed at t = 0 of a point of the path in a moving frame, m/s, and its name."""
    fastest, name = 0.0, ""
    for i, velocity in _velocities(found, np.zeros(1)).items():
        speed = float(np.linalg.norm(velocity))
        if speed > fastest:
            fastest, name = speed, found.scene.path[i].name
    return fastest, name


def _lengthening(found: Estimate, time: np.ndarray) -> np.ndarray:
    """Rate (m,), m/s, at which moving frames lengthen the path of the rope as drawn."""
    total = np.zeros(time.size)
    for i, velocity in _velocities(found, time).items():
        total -= velocity @ pull_on(found.path, i)
    return total


def _answers(actuator: Compensation, time: np.ndarray) -> np.ndarray:
    """Speed (m,), m/s, at which the actuator pays out."""
    return sample(compile_functions([FunctionRequest(actuator.pay_out)]), 0, time)[:, 1]


def _swing_of(found: Estimate, actuator: Compensation, paid: float, count: int) -> float:
    """Largest tension, N, that a load on the rope as one spring adds or takes while the actuator catches up.

    The stretch of the spring is the integral of r(s) cos(w (t - s)) over s, where r is the rate at which the rope is
    lengthened and w the bounce of the load: the response to a sudden start of any shape.

    Parameters
    ----------
    found, actuator
        As for `jumps_of`.
    paid : float
        Speed at which all operators together pay out at t = 0, m/s.
    count : int
        Drums at which the actuator pays out.
    """
    asked = found.scene.heave_compensation
    if found.frequency is None or asked is None:
        return 0.0
    omega = 2.0 * math.pi * found.frequency
    end = min(float(found.scene.solver.end), asked.delay + BOUNCES_SEEN / found.frequency)
    time = np.linspace(0.0, end, max(2, math.ceil(end * found.frequency * PER_BOUNCE)))
    rate = _lengthening(found, time) - paid - count * _answers(actuator, time)
    turned = rate * np.exp(-1j * omega * time)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (turned[1:] + turned[:-1]) * np.diff(time))])
    stretch = (np.exp(1j * omega * time) * whole).real
    return found.bounce_of(omega * float(np.abs(stretch).max()))
