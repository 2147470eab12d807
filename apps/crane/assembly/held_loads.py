"""Whether the brake and the motor of a drum hold the load that hangs on it at t = 0."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crane.assembly.friction import closure_of
from crane.assembly.layout import carries_nothing
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, Efficiency, Sheave
from tautline.kernels.time_function import value_at
from tautline.scene.functions import Constant
from tautline.system.time_functions import FunctionRequest, bounds_of, compile_functions

SURE = 0.02
"""Share of the load's moment that may lack without a word: torques are written to two digits."""
CLOSED = 0.999
"""Share from which a brake counts as closed whose closure changes."""


class Lack(NamedTuple):
    """A drum that lets the load go: what pulls and what holds, N, m and N m.

    ``brake`` is None of a drum without one, or with one that is open at t = 0, and else its torque times ``closed``,
    the share of :func:`holding_share`. ``motor`` is positive where it hoists, and ``limited`` where `torque_limit` is
    what keeps it from more.
    ``tension`` is the least that may stand at the drum, with all friction of sheaves on its side where ``helped``.
    ``gain`` is the proportional one of a winch that holds a tension.
    """

    drum: Drum
    tension: float
    brake: float | None
    closed: float
    friction: float
    motor: float
    helped: bool
    limited: bool
    gain: float

    @property
    def load(self) -> float:
        """Moment of the rope about the drum, N m."""
        return self.tension * self.drum.radius

    @property
    def needed(self) -> float:
        """Torque of the brake, as far as it is closed, that would hold; of the motor where there is none, N m."""
        return self.load - self.friction - (self.motor if self.brake is not None else 0.0)

    @property
    def held(self) -> float:
        """Tension that would hold, N, of a winch without a brake: its controller adds to what it lacks."""
        return self.tension - self.friction / (self.drum.radius * (1.0 + self.gain))


def lacks(scene: CraneScene, path: Path, tension: np.ndarray | None) -> list[Lack]:
    """Drums from which a load pulls rope as soon as the run begins.

    Judged is what is meant to hold: a brake that is closed at t = 0, or stays partly closed, and without a brake a
    motor whose torque or tension does not change, or one that its `torque_limit` keeps from its tension.
    A brake that is open at t = 0, a motor whose torque or tension is a function of time, and a winch with a speed are
    left to their operator. So is a load that stands on the ground.

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
        if drum.prescribed or (drum.torque is None and carries_nothing(scene)):
            # A rope without a load comes to the tension that its winch holds: nothing falls.
            continue
        closed = 0.0 if drum.brake is None else holding_share(drum)
        brake = drum.brake.torque * closed if drum.brake is not None and closed > 0.0 else None
        pull = share * float(tension[(0, 0) if drum is scene.path[0] else (-1, 1)])
        held = brake is not None or drum.friction_torque > 0.0
        asked = _asked_of_motor(drum, pull, held, brake is not None, scene.solver.end)
        limit = math.inf if drum.torque_limit is None else drum.torque_limit
        meant = brake is not None or isinstance(getattr(drum, drum.drive), Constant) or asked > limit
        if not meant or (brake is None and drum.brake is not None):
            continue
        motor = min(max(asked, -limit), limit)
        one = Lack(drum, pull, brake, closed, drum.friction_torque, motor, share < 1.0, asked > limit, _gain(drum))
        if one.load - motor - drum.friction_torque - (brake or 0.0) > SURE * one.load:
            found.append(one)
    return found


def _asked_of_motor(drum: Drum, pull: float, stands: bool, braked: bool, end: float) -> float:
    """Torque that a motor is to have while the drum stands, N m, whatever limits it.

    A winch that holds a tension adds its `proportional` share of what lacks only where a brake or friction lets it
    lack: of a drum that turns freely the rope takes the tension that is held. Without a brake the most counts that it
    ever is to hold.
    """
    if drum.tension is None:
        return _at_start(drum.torque)
    held = _at_start(drum.tension) if braked else bounds_of(drum.tension, end)[1]
    return drum.radius * (held + (_gain(drum) * (held - pull) if stands else 0.0))


def _gain(drum: Drum) -> float:
    return 0.0 if drum.gains is None else drum.gains.proportional


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
