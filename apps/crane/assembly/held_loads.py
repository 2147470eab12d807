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
from crane.assembly.loads import load_of
from crane.assembly.tension_at_rest import balance, hung, lift, rope_weight
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
        if one is not None and other is not None and not other.lets_go:
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
        The drum at the other end, which holds what it can; None where it holds anything.
    """
    ratio, offset = _growth(scene, path, drum)
    if carries_nothing(scene):
        far = (-1, 1) if drum is scene.path[0] else (0, 0)
        return float((tension[far] - offset[far]) / ratio[far])
    least = _least_at_rest(scene, path, drum, math.inf if other is None else other.most / (1.0 - SURE))
    if least is None:
        # The loads move whatever the drum does.
        least = balance(scene, path, ratio, offset)
    return float(tension[_at(scene, drum)]) if least is None else least


def _least_at_rest(scene: CraneScene, path: Path, drum: Drum, far: float) -> float | None:
    """Least tension at a drum with which all loads rest and no sheave is beyond what it holds, N: a linear programme.

    Unknown is the tension T_k where span k begins, (spans,). At the middle of a sheave, with half of the weight of the
    rope on it to either side, no side has more than its ratio times the other; the lift of all T is each body's load;
    at the other end of the rope no more than ``far`` N is held. None where no tensions do all that.
    """
    # Only few scenes have a drum that is to hold: others need not wait for this import.
    from scipy.optimize import linprog

    g = np.array(scene.gravity, float)
    bodies, n = hung(scene, path), len(path.spans)
    size = float(np.linalg.norm(g))
    if size == 0.0 or not bodies:
        return None
    weight, up, unit = rope_weight(scene, path), -g / size, np.eye(n)
    rise = weight[:, 1] - weight[:, 0]
    share = np.array([[lift(scene, path, body, np.stack([one, one], axis=1), up) for one in unit] for body in bodies])
    hangs = np.stack([np.zeros(n), rise], axis=1)
    load = np.array([load_of(scene, body) - lift(scene, path, body, hangs, up) for body in bodies])
    rows, limits = [], []
    for i in range(1, n):
        q = _held(scene, path, i)
        rows += [unit[i] - q * unit[i - 1], unit[i - 1] - q * unit[i]]
        on_sheave = _grown(q, weight[i, 0] - weight[i - 1, 1])
        limits += [q * rise[i - 1] + on_sheave, -rise[i - 1] - on_sheave]
    first = drum is scene.path[0]
    near, beyond = (0, n - 1) if first else (n - 1, 0)
    if math.isfinite(far):
        rows.append(unit[beyond])
        limits.append(far - (rise[beyond] if first else 0.0))
    # In units of the load, or of a rope that is heavier, which is what the tolerances of the method are for.
    scale = float(max(np.abs(load).max(), np.abs(rise).max()))
    if scale == 0.0:
        return None
    found = linprog(
        unit[near], np.array(rows) if rows else None, np.array(limits) / scale if rows else None, share, load / scale,
        bounds=[(max(0.0, -one) / scale, None) for one in rise],
    )  # fmt: skip
    return scale * float(found.x[near]) + (0.0 if first else float(rise[near])) if found.status == 0 else None


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
        more.append(more[-1] * grows + _grown(grows, float(rise)))
    return np.array(share), np.array(more)


def _grown(ratio: float, weight: float) -> float:
    """What the weight of rope along a sheave adds to the tension that comes in times the ratio, N.

    Of weight that is spread evenly the ratio works, in the mean, on half. So the same holds from either end.
    """
    return 0.5 * (1.0 + ratio) * weight


def _held(scene: CraneScene, path: Path, i: int) -> float:
    item = scene.path[i]
    return min(held_ratio(item, path, i), MOST_RATIO) if isinstance(item, Sheave) else 1.0
