"""The equations of Aarsnes and Shor integrated by themselves: a torsional line with friction along it, nothing else.

It knows nothing of the product's model. Rotary speeds stand at the middle of cells and torques between them, half a
time step later; friction of a cell takes its motion away, up to what it has. It tells what of a deviation comes from
the friction law and what from the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import NamedTuple

import numpy as np

from benchmarks.records import torsional_start_up as well

SWITCH = 1.5
"""Rotary speed of the published friction law, rad/s."""
GRAVITY = 9.81


class Curve(NamedTuple):
    """Times (n,) s, torques of the drive (n,) kN m and the largest twist between top and bit, rad."""

    time: np.ndarray
    torque: np.ndarray
    twist: float


def switched(speed: np.ndarray) -> np.ndarray:
    """The published friction factor: static below `SWITCH`, kinetic above."""
    return np.where(np.abs(speed) < SWITCH, well.FACTOR, well.FACTOR * well.RATIO)


def faded(speed: np.ndarray) -> np.ndarray:
    """A friction factor that falls with speed as exp(-speed / SWITCH)."""
    return well.FACTOR * (well.RATIO + (1.0 - well.RATIO) * np.exp(-np.abs(speed) / SWITCH))


def start_up(factor: Callable[[np.ndarray], np.ndarray], end: float = 13.3, cells: int = 1000) -> Curve:
    """The start-up with a friction factor as a function of rotary speed (n,) rad/s."""
    area, polar, radius = well.assembly()
    size = well.DEPTH / cells
    places = (np.arange(cells) + 0.5) * size
    pipe = places < well.DEPTH - well.BHA
    moment = np.where(pipe, pi / 32.0 * (well.OUTER**4 - well.INNER**4), polar)
    steel = np.where(pipe, pi / 4.0 * (well.OUTER**2 - well.INNER**2), area)
    arm = np.where(pipe, 0.5 * well.OUTER, radius)
    rigidity = moment * np.where(pipe, well.SHEAR_PIPE, well.SHEAR_BHA)
    pressing = well.DENSITY * steel * GRAVITY * np.sin([well.inclination(s) for s in places]) * arm * size
    inertia = well.DENSITY * moment * size
    stiffness = np.zeros(cells + 1)
    stiffness[0] = 2.0 * rigidity[0] / size
    stiffness[1:-1] = 2.0 / (size / rigidity[:-1] + size / rigidity[1:])
    step = 0.9 * size / (well.SHEAR_BHA / well.DENSITY) ** 0.5

    speed, torque = np.zeros(cells), np.zeros(cells + 1)
    drive = error = twist = largest = 0.0
    times = np.arange(0.0, end, step)
    motor = np.empty(times.size)
    for k, wanted in enumerate(well.SPEED * (1.0 - np.exp(-times / well.DELAY))):
        motor[k] = well.PROPORTIONAL * (wanted - drive) + well.INTEGRAL * error
        error += step * (wanted - drive)
        drive += step * (motor[k] - torque[0]) / well.INERTIA
        torque += step * stiffness * -np.diff(speed, prepend=drive, append=speed[-1])
        moved = inertia * speed * (1.0 - well.DAMPING * step) - step * np.diff(torque)
        most = step * factor(speed) * pressing
        speed = (moved - np.clip(moved, -most, most)) / inertia
        twist += step * (drive - speed[-1])
        largest = max(largest, twist)
    return Curve(times, motor / 1e3, largest)
