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
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from drillstring.statics.crossings import lost_at_turns, lost_at_zero
from drillstring.statics.helix import LOCKED_STRAIN, helix_force
from drillstring.statics.motion import MOTIONS, Motion
from drillstring.string.buckling import limit_at
from drillstring.string.factors import Factors, same
from drillstring.string.lumps import Tube
from drillstring.well.wellbore import Wellbore

STEP = 5.0
"""Longest step of the integration, m. It is of fourth order, but for the step in which the string passes from one side
of the hole to the other and |q| has a kink: that leaves an error of a millionth of the hook load. A step in which it
becomes a helix, or one no longer, is split there."""
WITHIN = 0.5 - sqrt(3.0) / 6.0
"""Part of a step by which the places lie within it whose limits make a straight line over it: Gauss's two. The ends
themselves tell nothing of the step: at a joint the hole has two curvatures, and where a curved hole becomes vertical
the least root of the limit is near zero all the way there, and has leapt to that of the curvature alone there."""
SHARE = 1.0e-9
"""Share of a step that its split is off."""
KEPT = 4
"""Solutions, and courses of other shoes, that a string in a hole keeps: three motions, and that without friction."""


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


class _Course(NamedTuple):
    """A string along its hole in n steps, as no friction and no motion changes it.

    ``depth`` (n + 1,) m. Of the steps (n,): length m, section, k^2 1/m^2, weight and twice the weight N/m, the pipe's
    radius m and the tension N at which it has locked up. Of their lower ends, middles and upper ends (3, n): ``turn``
    t'_z 1/m, ``along`` w t_z N/m and ``across`` w^2 (1 - t_z^2) N^2/m^2.
    """

    depth: np.ndarray
    length: np.ndarray
    section: np.ndarray
    square: np.ndarray
    weight: np.ndarray
    double: np.ndarray
    radius: np.ndarray
    locking: np.ndarray
    turn: np.ndarray
    along: np.ndarray
    across: np.ndarray

    @property
    def middle(self) -> np.ndarray:
        """Middles of the steps (n,), m."""
        return 0.5 * (self.depth[1:] + self.depth[:-1])


class _Helices(NamedTuple):
    """Of each step: tensions N up to which the pipe is a helix, at its lower end, middle and upper end (3, n), and that
    helix's N/m over F^2, 1/N/m (n,)."""

    tension: np.ndarray
    force: np.ndarray


class _Slide(NamedTuple):
    """Of each step: friction factor times the direction of friction along and around, and the root by which N falls."""

    along: np.ndarray
    around: np.ndarray
    lifted: np.ndarray


class StringInHole:
    """A string in its hole, to be integrated for frictions, motions and forces at the bit.

    What none of these changes is computed once. So are the last solutions, and that without friction, which is the same
    for all motions: their arrays are shared, and cannot be written to.

    Parameters
    ----------
    well : Wellbore
    tubes : sequence of Tube
        From the rotary table down; the bit is at the end of the last.
    weight : sequence of float
        Buoyed weight of each per length, N/m.
    hole : float, optional
        Diameter of the hole, m; without it the string does not buckle.
    step : float
        Longest step of the integration, m.
    """

    def __init__(
        self,
        well: Wellbore,
        tubes: Sequence[Tube],
        weight: Sequence[float] | np.ndarray,
        hole: float | None = None,
        step: float = STEP,
    ) -> None:
        self.well, self.tubes, self.hole, self.step = well, tuple(tubes), hole, step
        self.weight = np.array(weight, float)
        self._courses: dict[float, tuple[_Course, np.ndarray]] = {}
        self._solved: dict[tuple[Factors, Motion | None, float, bool], SoftString] = {}

    def solved(
        self, friction: float | Factors, motion: str | Motion, bit_force: float = 0.0, crosses: bool = False
    ) -> SoftString:
        """Integrate tension and torque, or find them among the last solutions; for parameters see `soft_string`."""
        factors = same(friction)
        moved = MOTIONS[motion] if isinstance(motion, str) else motion
        # Without friction no motion tells.
        key = factors, None if factors.largest == 0.0 else moved, bit_force, crosses
        found = self._solved.pop(key, None) or self._integrated(factors, moved, bit_force, crosses)
        _keep(self._solved, key, found)
        return found

    def _integrated(self, factors: Factors, moved: Motion, bit_force: float, crosses: bool) -> SoftString:
        if factors.shoe not in self._courses:
            made = _course(self.well, self.tubes, self.weight, factors.shoe, self.step)
            _keep(self._courses, factors.shoe, (made, np.full((2, made.length.size), np.nan)))
        course, helical = self._courses[factors.shoe]
        down, around = moved.friction(course.radius)
        mu = factors.over(course.depth[:-1], course.depth[1:])
        slide = _Slide(down * mu, around * mu, np.sqrt(1.0 + (around * mu) ** 2))
        found = _integrate(course, slide, None, bit_force)
        if self.hole is None:
            return found
        helices, pushed = None, np.maximum(0.0, -np.minimum(found.tension[1:], found.tension[:-1]))
        # The limits take time, and most strings are nowhere near them.
        near = pushed > 0.0
        self._limit(course, helical, near)
        if not (pushed[near] < helical[:, near]).all():
            helices = self._helices(course, helical)
            found = _integrate(course, slide, helices, bit_force)
        if crosses and found.locked is None:
            lost = _lost(self.well, course, found, self._clearance(course.section)) / slide.lifted
            found = _integrate(course, slide, helices, bit_force, lost)
        return found

    def _clearance(self, section: np.ndarray) -> np.ndarray:
        """Radial clearance of steps of sections (n,), m; below zero where the pipe does not fit."""
        assert self.hole is not None
        return np.array([0.5 * (self.hole - tube.contact_od) for tube in self.tubes])[section]

    def _rigidity(self, section: np.ndarray) -> np.ndarray:
        return np.array([tube.youngs_modulus * tube.second_moment for tube in self.tubes])[section]

    def _limit(self, course: _Course, helical: np.ndarray, some: np.ndarray) -> None:
        """Find the compression, N, from which some of the steps are helices, at lower and upper ends (2, n), where it
        is not known yet."""
        steps = np.flatnonzero(some & np.isnan(helical[0]))
        if steps.size == 0:
            return
        section, way = course.section[steps], WITHIN * course.length[steps]
        places = np.concatenate([course.depth[steps + 1] - way, course.depth[steps] + way])
        columns = self._rigidity(section), course.weight[steps], self._clearance(section)
        found = limit_at("helical", self.well, places, *(np.tile(column, 2) for column in columns))
        helical[:, steps] = _to_the_ends(*found.reshape(2, -1))

    def _helices(self, course: _Course, helical: np.ndarray) -> _Helices:
        self._limit(course, helical, np.ones(course.length.size, bool))
        lower, upper = -helical
        force = helix_force(1.0, self._clearance(course.section), self._rigidity(course.section))
        return _Helices(np.array([lower, 0.5 * (lower + upper), upper]), force)


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
    return StringInHole(well, tubes, weight, hole, step).solved(friction, motion, bit_force, crosses)


def _to_the_ends(lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Limits at the ends of steps (2, n), N, on the straight line through those `WITHIN` them (n,) each."""
    # Where the pipe fills the hole they are infinite.
    rise = np.subtract(upper, lower, out=np.zeros_like(lower), where=np.isfinite(lower))
    beyond = WITHIN / (1.0 - 2.0 * WITHIN) * rise
    return np.maximum(0.0, [lower - beyond, upper + beyond])


def _keep(kept: dict[Any, Any], key: Any, found: Any) -> None:
    """Keep it, and let go of what has not been asked for the longest."""
    kept[key] = found
    if len(kept) > KEPT:
        del kept[next(iter(kept))]


def _lost(well: Wellbore, course: _Course, found: SoftString, clearance: np.ndarray) -> np.ndarray:
    """Wall force that each step lacks where the string crosses the hole (n,), N."""
    tension, (k1, k2), (m1, m2, t) = found.tension, well.curvature(course.middle), well.frame(course.depth)
    across = np.array([0.0, 0.0, 1.0]) - t[:, 2:] * t
    # Of each step, as its curvature and weight are, at its upper and at its lower end.
    upper, lower = (
        tension[at, None] * (k1[:, None] * m1[at] + k2[:, None] * m2[at]) + course.weight[:, None] * across[at]
        for at in (slice(None, -1), slice(1, None))
    )
    clearance = np.maximum(0.0, clearance)
    above, below = lost_at_turns(tension[1:-1], 0.5 * (clearance[1:] + clearance[:-1]), lower[:-1], upper[1:])
    lost = np.append(above, 0.0) + np.append(0.0, below)
    zero = (upper * lower).sum(axis=1) < 0.0
    growth = np.linalg.norm(lower - upper, axis=1)[zero] / course.length[zero]
    lost[zero] += 2.0 * lost_at_zero(0.5 * (tension[1:] + tension[:-1])[zero], clearance[zero], growth)
    return lost


def _integrate(
    course: _Course, slide: _Slide, helices: _Helices | None, bit_force: float, lost: np.ndarray | None = None
) -> SoftString:
    """From the bit up, by Runge and Kutta's steps of fourth order; without wall force that each step lacks, (n,) N."""
    lacking = np.zeros(course.length.size) if lost is None else lost
    slides = bool(slide.along.any())
    tension = _slid(course, slide, helices, bit_force, lacking) if slides else _turned(course, bit_force)
    locked = np.flatnonzero(np.isnan(tension))
    force, lower, upper = _wall_forces(tension, course, helices, slide)
    torque = _summed(0.0, -course.radius * slide.around * (force - lacking))
    side = np.append(upper, np.nan if np.isnan(tension[-2]) else lower[-1])
    for values in (tension, torque, side):
        values.flags.writeable = False
    return SoftString(course.depth, tension, torque, side, float(course.depth[locked[-1]]) if locked.size else None)


def _turned(course: _Course, bit_force: float) -> np.ndarray:
    """Tension (n + 1,), N, of a string without friction along the hole; NaN from where it has locked up."""
    along = course.along
    tension = _summed(bit_force, course.length / 6.0 * (along[0] + 2.0 * along[1] + 2.0 * along[1] + along[2]))
    locked = np.flatnonzero(tension[:-1] < course.locking)
    if locked.size:
        tension[: locked[-1] + 1] = np.nan
    return tension


def _slid(
    course: _Course, slide: _Slide, helices: _Helices | None, bit_force: float, lacking: np.ndarray
) -> np.ndarray:
    """Tension (n + 1,), N, of a string with friction along the hole; NaN from where it has locked up.

    Each step needs the one below, so this is a loop. It runs over plain numbers, with the load on the wall written out
    at each stage: NumPy would take ten times as long, and calls as long as what they do. A step that begins as a helix
    is one throughout, but where it ends as none, or the other way: `_switched`.
    """
    none = np.zeros(course.length.size)
    (up_to, _, up_to_end), helix = ((none - np.inf,) * 3, none) if helices is None else helices
    columns = (
        course.length, 0.5 * course.length, course.length / 6.0, course.square, course.double, course.locking,
        slide.along, slide.lifted, slide.along * lacking, up_to, up_to_end, helix,
        *(values[place] for place in range(3) for values in (course.along, course.turn, course.across)),
    )  # fmt: skip
    low, found = float(bit_force), [float(bit_force)]
    for (
        length, half, sixth, k, w, locking, mu, up, lost, begin, end, force, down0, turn0, flat0, down1, turn1, flat1,
        down2, turn2, flat2,
    ) in zip(*(values[::-1].tolist() for values in columns), strict=True):  # fmt: skip
        coiled = low <= begin
        square = low * low * k + low * w * turn0 + flat0
        load = sqrt(square) / up if square > 0.0 else 0.0
        a = down0 + mu * (max(load, force * low * low) if coiled else load)
        x = low + half * a
        square = x * x * k + x * w * turn1 + flat1
        load = sqrt(square) / up if square > 0.0 else 0.0
        b = down1 + mu * (max(load, force * x * x) if coiled else load)
        x = low + half * b
        square = x * x * k + x * w * turn1 + flat1
        load = sqrt(square) / up if square > 0.0 else 0.0
        c = down1 + mu * (max(load, force * x * x) if coiled else load)
        x = low + length * c
        square = x * x * k + x * w * turn2 + flat2
        load = sqrt(square) / up if square > 0.0 else 0.0
        d = down2 + mu * (max(load, force * x * x) if coiled else load)
        high = low + sixth * (a + 2.0 * b + 2.0 * c + d)
        if (high <= end) != coiled and high >= locking:
            places = (down0, down1, down2), (turn0, turn1, turn2), (flat0, flat1, flat2)
            high = _switched(low, _Step(length, k, w, mu, up, force, begin, end, *places), coiled)
        low = high - lost
        if low < locking:
            break
        found.append(low)
    tension = np.full(course.depth.size, np.nan)
    tension[tension.size - len(found) :] = found[::-1]
    return tension


class _Step(NamedTuple):
    """One step of the loop: length, k^2, twice the weight, friction along, the root by which N falls, the helix's N/m
    over F^2, its tensions at the lower and upper end; w t_z, t'_z and w^2 (1 - t_z^2) at lower end, middle and upper
    end."""

    length: float
    square: float
    double: float
    along: float
    lifted: float
    force: float
    begin: float
    end: float
    down: tuple[float, float, float]
    turn: tuple[float, float, float]
    flat: tuple[float, float, float]


def _switched(low: float, step: _Step, coiled: bool) -> float:
    """Tension at the upper end of a step, N, in which the string becomes a helix, or one no longer.

    The wall force jumps there, and an error of the first order would be left: the step is taken in two parts.
    """

    # Few strings switch, and it takes long to load.
    from scipy.optimize import brentq

    def beyond(share: float) -> float:
        return _part(low, step, 0.0, share, coiled) - (step.begin + share * (step.end - step.begin))

    # Where the limit jumps at the lower end of the step it is past it from there on.
    share = brentq(beyond, 0.0, 1.0, xtol=SHARE) if beyond(0.0) * beyond(1.0) < 0.0 else 0.0
    return _part(_part(low, step, 0.0, share, coiled), step, share, 1.0, not coiled)


def _part(low: float, step: _Step, begin: float, end: float, coiled: bool) -> float:
    """Tension, N, at the end of a part of a step, from a share of its length to another, from that at its beginning."""

    def growth(x: float, at: float) -> float:
        down, turn, flat = (_parabola(*values, at) for values in (step.down, step.turn, step.flat))
        load = sqrt(max(0.0, x * x * step.square + x * step.double * turn + flat)) / step.lifted
        return down + step.along * (max(load, step.force * x * x) if coiled else load)

    length, middle = (end - begin) * step.length, 0.5 * (begin + end)
    a = growth(low, begin)
    b = growth(low + 0.5 * length * a, middle)
    c = growth(low + 0.5 * length * b, middle)
    d = growth(low + length * c, end)
    return low + length / 6.0 * (a + 2.0 * b + 2.0 * c + d)


def _parabola(lower: float, middle: float, upper: float, at: float) -> float:
    """Of a quantity at lower end, middle and upper end of a step, what it is at a share of its length."""
    return lower + at * (4.0 * middle - 3.0 * lower - upper) + 2.0 * at * at * (lower - 2.0 * middle + upper)


def _up_to(loads: tuple[np.ndarray, ...], share: np.ndarray) -> np.ndarray:
    """Integral of loads at lower ends, middles and upper ends (n,), N/m, up to a share of each step (n,), over its
    length; Simpson's rule up to all of it."""
    lower, middle, upper = loads
    rise, bend = 4.0 * middle - 3.0 * lower - upper, lower - 2.0 * middle + upper
    return share * (lower + share * (0.5 * rise + share * (2.0 / 3.0) * bend))


def _wall_forces(
    tension: np.ndarray, course: _Course, helices: _Helices | None, slide: _Slide
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each step from its tension at both ends (n + 1,), N: force on the wall (n,), N, and that per length at its
    lower and at its upper end (n,), N/m."""
    low, high, half = tension[1:], tension[:-1], 0.5 * course.length
    coiled = np.zeros(low.size, bool) if helices is None else low <= helices.tension[0]
    first = _load(low, course, helices, 0, slide.lifted, coiled)
    second = _load(low + half * (course.along[0] + slide.along * first), course, helices, 1, slide.lifted, coiled)
    middle = low + half * (course.along[1] + slide.along * second)
    stages = low, middle, high

    def loads(helix: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(_load(x, course, helices, place, slide.lifted, helix) for place, x in enumerate(stages))

    whole, before = np.ones(low.size), loads(coiled)
    if helices is None:
        return course.length * _up_to(before, whole), before[0], before[2]
    after = loads(high <= helices.tension[2])
    lower, inner, upper = (x - limit for x, limit in zip(stages, helices.tension, strict=True))
    share = _share_before(lower, inner, (lower > 0.0) != (upper > 0.0))
    force = _up_to(before, share) + _up_to(after, whole) - _up_to(after, share)
    return course.length * force, before[0], after[2]


def _share_before(lower: np.ndarray, middle: np.ndarray, switches: np.ndarray) -> np.ndarray:
    """Share of each step (n,) up to which it is what it is at its lower end; all of it where it does not switch.

    Tensions over the helix's limit are those of what it is there, also in the middle, for at the switch they have a
    kink.
    """
    ones = np.ones_like(lower)
    # Where the pipe fills the hole they are infinite.
    way = np.divide(lower, np.subtract(lower, middle, out=ones.copy(), where=switches), out=ones.copy(), where=switches)
    return np.where(switches, np.clip(0.5 * way, 0.0, 1.0), 1.0)


def _load(
    tension: np.ndarray, course: _Course, helices: _Helices | None, place: int, lifted: np.ndarray, coiled: np.ndarray
) -> np.ndarray:
    """Force on the wall per length (n,), N/m: |q|, less where friction carries a part of it, or that of a helix."""
    square = tension * tension * course.square + tension * course.double * course.turn[place] + course.across[place]
    lying: np.ndarray = np.sqrt(np.maximum(0.0, square)) / lifted
    if helices is None:
        return lying
    return np.where(coiled, np.maximum(lying, helices.force * tension * tension), lying)


def _summed(bit: float, growth: np.ndarray) -> np.ndarray:
    """From the bit up (n + 1,), of what each step adds (n,)."""
    return np.cumsum(np.append(growth, bit)[::-1])[::-1]


def _course(well: Wellbore, tubes: Sequence[Tube], weights: np.ndarray, shoe: float, step: float) -> _Course:
    """With every joint of arcs and of sections, and the shoe, among its depths."""
    ends = np.cumsum([tube.length for tube in tubes])
    joints = np.concatenate([[0.0], ends, well.md[well.md < ends[-1]], [min(shoe, ends[-1])]])
    joints = np.unique(joints)
    joints = joints[np.append(True, np.diff(joints) > 1e-9)]
    parts = np.ceil(np.diff(joints) / step).astype(int)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    s = np.append(number * np.repeat(np.diff(joints) / parts, parts) + np.repeat(joints[:-1], parts), joints[-1])
    s.flags.writeable = False
    middle = 0.5 * (s[:-1] + s[1:])
    section = np.minimum(np.searchsorted(ends, middle), len(tubes) - 1)
    k1, k2 = well.curvature(middle)
    w, frame, between = weights[section], well.frame(s), well.frame(middle)
    m1, m2, t = (np.array([end[1:, 2], inner[:, 2], end[:-1, 2]]) for end, inner in zip(frame, between, strict=True))
    radius = np.array([0.5 * tube.contact_od for tube in tubes])
    locking = np.array([-LOCKED_STRAIN * tube.youngs_modulus * tube.area for tube in tubes])
    return _Course(
        s, s[1:] - s[:-1], section, k1**2 + k2**2, w, 2.0 * w, radius[section], locking[section],
        k1 * m1 + k2 * m2, w * t, w * w * (1.0 - t * t),
    )  # fmt: skip
