"""Whether the brake and the motor of a drum hold the load that hangs on it at t = 0.

As a drum is about to pay out all friction of sheaves helps it: from the drum on the tension grows at every sheave by
the ratio up to which that holds its rope, and is in balance with the load. With eta at every sheave the drum of a
block of n falls has m g eta^n (1 - eta) / (1 - eta^n); an n-th of the load, times all eta, would be too little. What
lies beyond the last sheave of a block bears nothing. Where the rope ends in a second drum that one holds its end as an
anchor does, with no more than it can hold.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crane.assembly.friction import closure_of, held_ratio
from crane.assembly.layout import carries_nothing
from crane.assembly.tension_at_rest import balance, hung, rope_weight
from crane.geometry.reeving import Path
from crane.scene.scene import CraneScene, Drum, Sheave
from tautline.kernels.time_function import value_at
from tautline.scene.functions import Constant
from tautline.system.time_functions import FunctionRequest, bounds_of, compile_functions

SURE = 0.02
"""Share of the load's moment that may lack without a word: torques are written to two digits."""
LEAST_HELP = 1.0e-6
"""Share of the tension from which friction is said to help."""
MOST_RATIO = 1.0e6
"""Ratio of the tensions at a sheave that counts as any: what is held behind it pulls with nothing."""
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
    def lets_go(self) -> bool:
        """Whether all that acts holds less than the load."""
        return self.load - self.motor - self.friction - (self.brake or 0.0) > SURE * self.load

    @property
    def most(self) -> float:
        """Tension up to which the drum holds, N; at least that where the limit of its torque may end."""
        rest = self.friction + (self.brake or 0.0)
        yields = 0.0 if self.limited or rest == 0.0 else self.gain
        return self.tension + (self.motor + rest - self.load) / (self.drum.radius * (1.0 + yields))

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
    # A rope without a load comes to the tension that its winch holds: nothing falls.
    drums = [one for one in scene.drums if not (one.prescribed or (one.torque is None and carries_nothing(scene)))]
    alone = [_what_acts(scene, drum, _pull(scene, path, drum, tension), tension) for drum in drums]
    found = []
    for k, one in enumerate(alone):
        other = alone[1 - k] if len(alone) == 2 else None
        if one is not None and other is not None and not other.lets_go and len(hung(scene, path)) == 1:
            one = _what_acts(scene, one.drum, _pull(scene, path, one.drum, tension, other), tension)
        if one is not None and one.lets_go:
            found.append(one)
    return found


def _what_acts(scene: CraneScene, drum: Drum, pull: float, tension: np.ndarray) -> Lack | None:
    """What holds a drum that the rope pulls with a tension, N; None where nothing is meant to hold it."""
    closed = 0.0 if drum.brake is None else holding_share(drum)
    brake = drum.brake.torque * closed if drum.brake is not None and closed > 0.0 else None
    held = brake is not None or drum.friction_torque > 0.0
    asked = _asked_of_motor(drum, pull, held, brake is not None, scene.solver.end)
    limit = math.inf if drum.torque_limit is None else drum.torque_limit
    meant = brake is not None or isinstance(getattr(drum, drum.drive), Constant) or asked > limit
    if not meant or (brake is None and drum.brake is not None):
        return None
    motor = min(max(asked, -limit), limit)
    helped = pull < (1.0 - LEAST_HELP) * float(tension[_at(scene, drum)])
    return Lack(drum, pull, brake, closed, drum.friction_torque, motor, helped, asked > limit, _gain(drum))


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


def _at(scene: CraneScene, drum: Drum) -> tuple[int, int]:
    """Place of the rope's tension at a drum in an array by span and end."""
    return (0, 0) if drum is scene.path[0] else (-1, 1)


def _pull(scene: CraneScene, path: Path, drum: Drum, tension: np.ndarray, other: Lack | None = None) -> float:
    """Least tension at a drum that keeps the loads at rest with all friction of sheaves, N.

    Parameters
    ----------
    tension : (spans, 2) array
        At rest without friction, N.
    other : Lack or None
        The drum at the other end, which holds what it can; None where it holds anything. One body hangs on the rope.
    """
    ratio, offset = _growth(scene, path, drum)
    if carries_nothing(scene):
        far = (-1, 1) if drum is scene.path[0] else (0, 0)
        return float((tension[far] - offset[far]) / ratio[far])
    levels = [balance(scene, path, ratio, offset)]
    if other is not None:
        # The rope bears the lesser of what both drums let it: up to some sheave that is this one's. Anywhere else that
        # one changes over more is borne than there is, and less is left to this drum.
        own, more = _growth(scene, path, other.drum)
        limit = own * other.most * (1.0 + SURE) + more
        for i in range(1, len(path.spans)):
            near = np.arange(len(path.spans)) < i if drum is scene.path[0] else np.arange(len(path.spans)) >= i
            here = near[:, None]
            levels.append(balance(scene, path, np.where(here, ratio, 0.0), np.where(here, offset, limit)))
    return max((level for level in levels if level is not None), default=float(tension[_at(scene, drum)]))


def _growth(scene: CraneScene, path: Path, drum: Drum) -> tuple[np.ndarray, np.ndarray]:
    """Tension as a drum is about to pay out, where each span begins and ends: a share of that at the drum, and N more.

    Both are (spans, 2).
    """
    ratios = [_held(scene, path, i) for i in range(1, len(path.spans))]
    weight, way = rope_weight(scene, path).ravel(), 1 if drum is scene.path[0] else -1
    share, more = _along(weight[::way], ratios[::way])
    return share[::way].reshape(-1, 2), more[::way].reshape(-1, 2)


def _along(weight: np.ndarray, ratios: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Share and N of `_growth` at the ends of spans one after the other, (2 spans,), as the rope leaves the drum."""
    share, more = [1.0], [0.0]
    for j, rise in enumerate(np.diff(weight)):
        # Every second step leads over a sheave.
        grows = ratios[j // 2] if j % 2 else 1.0
        share.append(share[-1] * grows)
        more.append(more[-1] * grows + float(rise))
    return np.array(share), np.array(more)


def _held(scene: CraneScene, path: Path, i: int) -> float:
    item = scene.path[i]
    return min(held_ratio(item, path, i), MOST_RATIO) if isinstance(item, Sheave) else 1.0
