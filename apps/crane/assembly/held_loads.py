"""Whether the brake and the motor of a drum hold the load that hangs on it at t = 0."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crane.assembly.friction import closure_of
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, Efficiency, Sheave
from tautline.kernels.time_function import value_at
from tautline.scene.functions import Constant
from tautline.system.time_functions import FunctionRequest, compile_functions

SURE = 0.02
"""Share of the load's moment that may lack without a word: torques are written to two digits."""
CLOSED = 0.999
"""Share from which a brake counts as closed whose closure changes."""


class Lack(NamedTuple):
    """A drum that lets the load go: what pulls and what holds, N, m and N m.

    ``brake`` is None of a drum without one, or with one that is open at t = 0, and else its torque times ``closed``,
    the share of :func:`holding_share`. ``motor`` is positive where it hoists.
    ``tension`` is the least that may stand at the drum, with all friction of sheaves on its side where ``helped``.
    """

    drum: Drum
    tension: float
    brake: float | None
    closed: float
    friction: float
    motor: float
    helped: bool

    @property
    def load(self) -> float:
        """Moment of the rope about the drum, N m."""
        return self.tension * self.drum.radius

    @property
    def needed(self) -> float:
        """Torque of the brake, as far as it is closed, that would hold; of the motor where there is none, N m."""
        return self.load - self.friction - (self.motor if self.brake is not None else 0.0)


def lacks(scene: CraneScene, path: Path, tension: np.ndarray | None) -> list[Lack]:
    """Drums from which a load pulls rope as soon as the run begins.

    Judged is what is meant to hold: a brake that is closed at t = 0, or stays partly closed, and without a brake a
    motor whose torque does not change. A brake that is open at t = 0, a motor whose torque is a function of
    time, and a winch that holds a tension or a speed are left to their operator. So is a load that stands on the
    ground.

    Parameters
    ----------
    tension : (spans, 2) array or None
        At rest without friction, N; None where it is not known.
    """
    if tension is None or _grounded(scene):
        return []
    share = _left_by_sheaves(scene, path)
    found = []
    for drum in scene.drums:
        if drum.torque is None:
            continue
        closed = 0.0 if drum.brake is None else holding_share(drum)
        brake = drum.brake.torque * closed if drum.brake is not None and closed > 0.0 else None
        meant = brake is not None or (drum.brake is None and isinstance(drum.torque, Constant))
        if not meant:
            continue
        pull = share * float(tension[(0, 0) if drum is scene.path[0] else (-1, 1)])
        motor = _at_start(drum.torque)
        one = Lack(drum, pull, brake, closed, drum.friction_torque, motor, share < 1.0)
        if one.load - motor - drum.friction_torque - (brake or 0.0) > SURE * one.load:
            found.append(one)
    return found


def _at_start(function: object) -> float:
    return float(value_at(compile_functions([FunctionRequest(function)]), 0, 0.0)[0])


def holding_share(drum: Drum) -> float:
    """Share of its torque with which a brake holds at t = 0; 0 of one that is open, or is being closed or opened.

    A brake that stays partly closed holds with that share; one whose closure changes counts as closed or open.
    """
    closure = closure_of(drum)
    share = _at_start(closure)
    return share if isinstance(closure, Constant) or share >= CLOSED else 0.0


def _grounded(scene: CraneScene) -> bool:
    """Whether a body stands on the ground as drawn: what the rope bears is then not known before the run."""
    return scene.ground is not None and any(body.lowest <= scene.ground.level for body in scene.bodies)


def _left_by_sheaves(scene: CraneScene, path: Path) -> float:
    """Least share of the tension that the friction of all sheaves may leave at a drum which pays out."""
    share = 1.0
    for i, item in enumerate(scene.path):
        if not isinstance(item, Sheave):
            continue
        if isinstance(item.law, Efficiency):
            share *= item.law.efficiency
        if item.law == "capstan":
            share *= math.exp(-item.groove_friction * float(path.arcs[i]) / item.radius)
        if item.bearing is not None:
            # A bearing bears twice the tension at most.
            share *= max(0.0, 1.0 - 2.0 * item.bearing.friction * item.bearing.radius / item.radius)
    return share
