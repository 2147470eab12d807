"""The soft string: hook load and torque by integration along the hole, without bending and without clearance.

What clearance takes off where the string crosses the hole can be counted too (crossings.py).

With the effective tension T, the unit tangent t(s) down the hole, and w the buoyed weight per length, the string's
load on the wall per length is

    q = T t' + w (e_z - (e_z.t) t),    |q|^2 = T^2 k^2 + 2 T w t'_z + w^2 (1 - t_z^2),

and the tension grows on the way up by ``dT = (w t_z + a mu N) ds`` with the normal force N. Friction acts in the
direction (a, b) along the hole and around it, positive down and clockwise (motion.py): (1, 0) picked up, (-1, 0)
slacked off, (0, -1) turning. This is the differential form of C. A. Johancsik, D. B. Friesen and R. Dawson, "Torque and
drag in directional wells: prediction and measurement", JPT 36(6), 1984, with the exact direction of the hole instead of
mean angles. A string that turns climbs the wall until friction carries its part of q, so that
N = |q|/sqrt(1 + (b mu)^2), and the torque grows by |b| mu N times the pipe's radius. Stretch is not counted.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import ceil, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.statics.crossings import lost_at_turns, lost_at_zero
from drillstring.statics.helix import LOCKED_STRAIN, helix_force, limit_at
from drillstring.statics.motion import MOTIONS, Motion
from drillstring.string.factors import Factors, same
from drillstring.string.lumps import Tube
from drillstring.well.wellbore import Wellbore

STEP = 5.0
"""Longest step of the integration, m. It is of fourth order, but for the step in which the string passes from one side
of the hole to the other and |q| has a kink: that leaves an error of a millionth of the hook load."""


class SoftString(NamedTuple):
    """Along the hole from the rotary table to the bit, at the ends of the steps.

    Measured depth (n,) m; effective tension (n,) N; torque (n,) N m; side force per length (n,) N/m; where it has
    locked up, m, above which all are NaN, or None.
    """

    measured_depth: np.ndarray
    tension: np.ndarray
    torque: np.ndarray
    side_force: np.ndarray
    locked: float | None = None

    @property
    def hook_load(self) -> float:
        """Effective tension at the top, N."""
        return float(self.tension[0])

    @property
    def surface_torque(self) -> float:
        """Torque at the top, N m."""
        return float(self.torque[0])


class _Hole(NamedTuple):
    """A step's hole, at its lower end, middle and upper end (3,): t_z, t'_z; and k^2 of its arc."""

    down: np.ndarray
    turn: np.ndarray
    square: float


class _Pipe(NamedTuple):
    """A step's pipe: weight N/m; compression N from which it is a helix, and that helix's N/m over F^2, 1/N/m."""

    weight: float
    helical: float
    helix: float


class _Slide(NamedTuple):
    """Of each step: friction factor times the direction of friction along and around, and the root by which N falls."""

    along: np.ndarray
    around: np.ndarray
    lifted: np.ndarray


def soft_string(
    well: Wellbore,
    tubes: Sequence[Tube],
    weight: Sequence[float] | np.ndarray,
    friction: float | Factors,
    motion: str | Motion,
    bit_force: float = 0.0,
    hole: float | None = None,
    step: float = STEP,
    crosses: bool = False,
) -> SoftString:
    """Integrate tension and torque from the bit up, with the wall force of a helix where the string is one (helix.py).

    Parameters
    ----------
    well : Wellbore
    tubes : sequence of Tube
        From the rotary table down; the bit is at the end of the last.
    weight : sequence of float
        Buoyed weight of each per length, N/m.
    friction : float or Factors
        Friction factor, or those of the cased and of the open hole.
    motion : str or Motion
        ``pick_up``, ``slack_off`` or ``rotating``, or speeds along the hole and about its axis.
    bit_force : float
        Tension at the bit, N.
    hole : float, optional
        Diameter of the hole, m; without it the string does not buckle.
    step : float
        Longest step of the integration, m.
    crosses : bool
        Whether the wall force is less where the string crosses the hole of that diameter from side to side.

    Returns
    -------
    SoftString
    """
    factors = same(friction)
    s, tube = _mesh(well, tubes, factors.shoe, step)
    each = [tubes[k] for k in tube]
    moved = MOTIONS[motion] if isinstance(motion, str) else motion
    down, around = moved.friction(np.array([0.5 * one.contact_od for one in each]))
    mu = factors.over(s[:-1], s[1:])
    slide = _Slide(down * mu, around * mu, np.sqrt(1.0 + (around * mu) ** 2))
    holes, weights = _holes(well, s), np.asarray(weight, float)[tube]
    lying = [_Pipe(float(w), np.inf, 0.0) for w in weights]
    found = _integrate(s, each, holes, slide, lying, bit_force)
    if hole is None:
        return found
    pushed = np.maximum(0.0, -np.minimum(found.tension[1:], found.tension[:-1]))
    # The limits take time, and most strings are nowhere near them.
    near, middle = pushed > 0.0, 0.5 * (s[1:] + s[:-1])
    buckles = near.any() and not (pushed[near] < _helical(well, each, weights, middle, hole, near)).all()
    if buckles:
        lying = _buckling(well, each, weights, middle, hole)
        found = _integrate(s, each, holes, slide, lying, bit_force)
    if crosses and found.locked is None:
        lost = _lost(well, found, each, weights, hole) / slide.lifted
        found = _integrate(s, each, holes, slide, lying, bit_force, lost)
    return found


def _lost(well: Wellbore, found: SoftString, each: list[Tube], weights: np.ndarray, hole: float) -> np.ndarray:
    """Wall force that each step lacks where the string crosses the hole (n,), N."""
    s, tension = found.measured_depth, found.tension
    k1, k2 = well.curvature(0.5 * (s[1:] + s[:-1]))
    m1, m2, t = well.frame(s)
    across = np.array([0.0, 0.0, 1.0]) - t[:, 2:] * t
    # Of each step, as its curvature and weight are, at its upper and at its lower end.
    upper, lower = (
        tension[at, None] * (k1[:, None] * m1[at] + k2[:, None] * m2[at]) + weights[:, None] * across[at]
        for at in (slice(None, -1), slice(1, None))
    )
    clearance = np.array([max(0.0, 0.5 * (hole - tube.contact_od)) for tube in each])
    above, below = lost_at_turns(tension[1:-1], 0.5 * (clearance[1:] + clearance[:-1]), lower[:-1], upper[1:])
    lost = np.append(above, 0.0) + np.append(0.0, below)
    zero = (upper * lower).sum(axis=1) < 0.0
    growth = np.linalg.norm(lower - upper, axis=1)[zero] / np.diff(s)[zero]
    lost[zero] += 2.0 * lost_at_zero(0.5 * (tension[1:] + tension[:-1])[zero], clearance[zero], growth)
    return lost


def _integrate(
    s: np.ndarray,
    each: list[Tube],
    holes: list[_Hole],
    slide: _Slide,
    pipes: list[_Pipe],
    bit_force: float,
    lost: np.ndarray | None = None,
) -> SoftString:
    """From the bit up, by Runge and Kutta's steps of fourth order; without wall force that each step lacks, (n,) N."""
    lacking = np.zeros(s.size - 1) if lost is None else lost
    tension, torque, side = (np.full(s.size, np.nan) for _ in range(3))
    tension[-1], torque[-1] = bit_force, 0.0
    for i in range(s.size - 2, -1, -1):
        arc, pipe, h, up = holes[i], pipes[i], float(s[i + 1] - s[i]), float(slide.lifted[i])
        along, low = float(slide.along[i]), float(tension[i + 1])
        a = _growth(low, pipe, arc, 0, along, up)
        b = _growth(low + 0.5 * h * a, pipe, arc, 1, along, up)
        middle = low + 0.5 * h * b
        c = _growth(middle, pipe, arc, 1, along, up)
        high = low + h / 6.0 * (a + 2.0 * b + 2.0 * c + _growth(low + h * c, pipe, arc, 2, along, up))
        high -= along * float(lacking[i])
        if high < -LOCKED_STRAIN * each[i].youngs_modulus * each[i].area:
            return SoftString(s, tension, torque, side, float(s[i]))
        tension[i] = high
        loads = [_load(x, pipe, arc, j, up) for j, x in enumerate((low, middle, high))]
        arm = -0.5 * each[i].contact_od * slide.around[i]
        torque[i] = torque[i + 1] + arm * (h / 6.0 * (loads[0] + 4.0 * loads[1] + loads[2]) - float(lacking[i]))
        side[i] = loads[2]
        if i == s.size - 2:
            side[-1] = loads[0]
    return SoftString(s, tension, torque, side)


def _helical(
    well: Wellbore, each: list[Tube], weights: np.ndarray, middle: np.ndarray, hole: float, some: np.ndarray
) -> np.ndarray:
    """Compression of some of the steps (m,) from which the string is a helix there, N."""
    places = np.flatnonzero(some)
    tubes = [each[k] for k in places]
    clearance = np.array([0.5 * (hole - tube.contact_od) for tube in tubes])
    rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in tubes])
    return limit_at("helical", well, middle[places], rigidity, weights[places], clearance)


def _buckling(well: Wellbore, each: list[Tube], weights: np.ndarray, middle: np.ndarray, hole: float) -> list[_Pipe]:
    """The pipe of each step with its limit and its helix."""
    helical = _helical(well, each, weights, middle, hole, np.ones(middle.size, bool))
    clearance = np.array([0.5 * (hole - tube.contact_od) for tube in each])
    rigidity = np.array([tube.youngs_modulus * tube.second_moment for tube in each])
    rows = zip(weights.tolist(), helical.tolist(), helix_force(1.0, clearance, rigidity).tolist(), strict=True)
    return [_Pipe(*row) for row in rows]


def _load(tension: float, pipe: _Pipe, arc: _Hole, place: int, lifted: float) -> float:
    """Force on the wall per length, N/m: |q|, less where friction carries a part of it, or that of a helix."""
    w, down, turn = pipe.weight, arc.down[place], arc.turn[place]
    square = tension * tension * arc.square + 2.0 * tension * w * turn + w * w * (1.0 - down * down)
    lying = sqrt(max(0.0, square)) / lifted
    return max(lying, pipe.helix * tension * tension) if -tension >= pipe.helical else lying


def _growth(tension: float, pipe: _Pipe, arc: _Hole, place: int, along: float, lifted: float) -> float:
    """Growth of the tension per metre up the hole, N/m."""
    return float(pipe.weight * arc.down[place]) + along * _load(tension, pipe, arc, place, lifted)


def _mesh(well: Wellbore, tubes: Sequence[Tube], shoe: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths with every joint of arcs and of sections among them (n + 1,), and the section of each step (n,)."""
    ends = np.cumsum([tube.length for tube in tubes])
    joints = np.concatenate([[0.0], ends, well.md[well.md < ends[-1]], [min(shoe, ends[-1])]])
    joints = np.unique(joints)
    joints = joints[np.append(True, np.diff(joints) > 1e-9)]
    parts = [np.linspace(a, b, ceil((b - a) / step) + 1)[:-1] for a, b in pairwise(joints)]
    s = np.append(np.concatenate(parts), joints[-1])
    return s, np.minimum(np.searchsorted(ends, 0.5 * (s[:-1] + s[1:])), len(tubes) - 1)


def _holes(well: Wellbore, s: np.ndarray) -> list[_Hole]:
    middle = 0.5 * (s[:-1] + s[1:])
    k1, k2 = well.curvature(middle)
    down, turn = [], []
    for at in (s[1:], middle, s[:-1]):
        m1, m2, t = well.frame(at)
        down.append(t[:, 2])
        turn.append(k1 * m1[:, 2] + k2 * m2[:, 2])
    rows = zip(np.transpose(down), np.transpose(turn), k1**2 + k2**2, strict=True)
    return [_Hole(a, b, float(c)) for a, b, c in rows]
