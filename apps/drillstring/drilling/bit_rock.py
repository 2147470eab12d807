"""How a bit bites into the rock: weight on bit, the torques that it takes, and how fast the hole deepens.

Two kinds. `RockBit` stands on a spring on the bottom of the hole, which deepens with the weight and the speed that
there are (bit_numbers.py has the laws); the depth of the hole at the end of a step is solved for with the weight, by
the trapezoidal rule. `BladeBit` cuts with blades, each what the one before it has left: the bottom that the last blade
left at every angle is kept in a ring, and the hole deepens by the mean over a turn of what they cut. Both write
``value``: weight on bit N, kinetic and static torque N m, rate of penetration m/s; and ``slope`` (3, 4), the
derivatives of the first three by depth, speed along the hole, angle and rotary speed of the bit. Both torques are those
for the way in which the bit turns, or is pushed to turn where it stands: backward where ``way`` is negative. A drag bit
cuts no chips then, and all its weight rubs. Depths of bit and bottom are counted from the bit's ``datum``.
"""

from __future__ import annotations

from math import exp, pi
from typing import NamedTuple

import numpy as np

from drillstring.groups.friction import SLIP
from tautline.kernels.dispatch import by_type
from tautline.kernels.jit import kernel

WEIGHT, KINETIC, STATIC, RATE = 0, 1, 2, 3
DEPTH, SPEED, ANGLE, SPIN = 0, 1, 2, 3
REACH = 1.25
"""Angles between two blades that the ring reaches back by at least."""
YIELDED = 1.0e-5
"""Share of the weight that flats can take within which they count as pushed on: a depth of kilometres is rounded."""
ENOUGH, BISECTIONS = 1.0e-14, 200
"""Relative change of the weight on bit at which it counts as found, and bound of the search."""


class RockBit(NamedTuple):
    """A bit on a spring of rock: ``places`` (k,), ``direction`` (k,) and ``datum`` m tell its measured depth, ``turn``
    is the degree of freedom of its rotation; ``row`` (1,) of ``BIT``; ``value`` (4,) and ``slope`` (3, 4) are scratch.
    """

    places: np.ndarray
    direction: np.ndarray
    datum: float
    turn: int
    row: np.recarray
    value: np.ndarray
    slope: np.ndarray


class BladeBit(NamedTuple):
    """A bit with blades: beside what a `RockBit` has, ``ring`` (m, 2): angle rad and depth m of the bottom that a blade
    left there, the newest at ``head`` (1,); the ring reaches back by more than the angle between two blades.
    """

    places: np.ndarray
    direction: np.ndarray
    datum: float
    turn: int
    row: np.recarray
    value: np.ndarray
    slope: np.ndarray
    ring: np.ndarray
    head: np.ndarray


@kernel
def depth_of(g, q):
    """Measured depth of the bit below ``datum``, m: hard rock wants the digits that kilometres would take."""
    depth = 0.0
    for k in range(g.places.size):
        depth += g.direction[k] * q[g.places[k]]
    return depth


@kernel
def speed_of(g, v):
    """Speed of the bit along the hole, m/s."""
    speed = 0.0
    for k in range(g.places.size):
        speed += g.direction[k] * v[g.places[k]]
    return speed


# -- on a spring -----------------------------------------------------------------------------------------------------


@kernel
def _turning(b, spin):
    """How the rate of penetration depends on the rotary speed, and its derivative."""
    if spin <= 0.0:
        return 0.0, 0.0
    power = b.speed_exponent - 1.0
    if power == 0.0:
        return spin, 1.0
    square = spin * spin + b.slow * b.slow
    factor = square ** (0.5 * power)
    return spin * factor, factor * (1.0 + power * spin * spin / square)


@kernel
def _drilled(b, weight):
    """How the rate of penetration depends on the weight on bit, and its derivative."""
    over = weight - b.threshold
    if over <= 0.0:
        return 0.0, 0.0
    if b.weight_exponent == 1.0:
        return over, 1.0
    value = over**b.weight_exponent
    return value, b.weight_exponent * value / over


@kernel
def _weight(b, free, lever):
    """Weight W with W + lever drilled(W) = free: the more is drilled, the less the rock is pressed. A safe Newton."""
    if free <= b.threshold or lever == 0.0:
        return free
    if b.weight_exponent == 1.0:
        return (free + lever * b.threshold) / (1.0 + lever)
    low, high = b.threshold, free
    weight = free
    for _ in range(BISECTIONS):
        drilled, slope = _drilled(b, weight)
        wrong = weight + lever * drilled - free
        if wrong > 0.0:
            high = weight
        else:
            low = weight
        new = weight - wrong / (1.0 + lever * slope)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - weight) <= ENOUGH * free:
            return new
        weight = new
    return weight


@kernel
def _measure_rock(g, t, q, v, way):
    b = g.row[0]
    value, slope = g.value, g.slope
    value.fill(0.0)
    slope.fill(0.0)
    spin = v[g.turn]
    half = 0.5 * max(0.0, t - b.time)
    free = b.stiffness * (depth_of(g, q) - b.hole - half * b.drilled) + b.damping * speed_of(g, v)
    if free <= 0.0:
        return
    turning, turning_slope = _turning(b, spin)
    press = half * b.stiffness + b.damping
    lever = press * b.cut * turning
    weight = _weight(b, free, lever)
    drilled, drilled_slope = _drilled(b, weight)
    yields = 1.0 / (1.0 + lever * drilled_slope)
    value[WEIGHT] = weight
    value[RATE] = b.cut * turning * drilled
    slope[WEIGHT, DEPTH] = yields * b.stiffness
    slope[WEIGHT, SPEED] = yields * b.damping
    slope[WEIGHT, SPIN] = -yields * press * b.cut * turning_slope * drilled
    flat = min(weight, b.limit)
    excess = max(0.0, weight - b.limit)
    held, per_weight = b.back * weight, b.back
    if way >= 0.0:
        held = b.below * flat + b.above * excess
        per_weight = b.below if weight < b.limit else b.above
    fade, fade_slope = 0.0, 0.0
    if b.decay > 0.0:
        fast = max(0.0, abs(spin) - b.slip_speed)
        fade = exp(-fast / b.decay)
        fade_slope = -np.copysign(fade, spin) / b.decay if fast > 0.0 else 0.0
    value[KINETIC] = held + b.excess * weight * fade
    value[STATIC] = held + b.excess * weight
    for k in range(4):
        slope[KINETIC, k] = (per_weight + b.excess * fade) * slope[WEIGHT, k]
        slope[STATIC, k] = (per_weight + b.excess) * slope[WEIGHT, k]
    slope[KINETIC, SPIN] += b.excess * weight * fade_slope


@kernel
def _place_rock(g, t, q, v):
    """Put the bottom of the hole where it carries the weight that the bit starts with."""
    b = g.row[0]
    b.hole = depth_of(g, q) - b.weight / b.stiffness
    b.time = t
    _measure_rock(g, t, q, v, v[g.turn])
    b.drilled = g.value[RATE]


@kernel
def _advance_rock(g, t, q, v):
    b = g.row[0]
    _measure_rock(g, t, q, v, v[g.turn])
    b.hole += 0.5 * (t - b.time) * (b.drilled + g.value[RATE])
    b.drilled = g.value[RATE]
    b.time = t


@kernel
def _strain_rock(g, q):
    b = g.row[0]
    return 0.5 * b.stiffness * max(0.0, depth_of(g, q) - b.hole) ** 2


@kernel
def _stores_rock(g, q, v):
    b = g.row[0]
    return b.stiffness * max(0.0, depth_of(g, q) - b.hole) * (speed_of(g, v) - g.value[RATE])


# -- with blades -----------------------------------------------------------------------------------------------------


@kernel
def _behind(g, angle):
    """Depth of the bottom at an angle that was passed, m, and its slope, m/rad; held beyond what is remembered."""
    size = g.ring.shape[0]
    oldest = (g.head[0] + 1) % size
    low, high = 0, size - 1
    while high - low > 1:
        middle = (low + high) // 2
        if g.ring[(oldest + middle) % size, 0] <= angle:
            low = middle
        else:
            high = middle
    one, two = (oldest + low) % size, (oldest + high) % size
    span = g.ring[two, 0] - g.ring[one, 0]
    if span <= 0.0 or angle < g.ring[one, 0]:
        return g.ring[one, 1], 0.0
    slope = (g.ring[two, 1] - g.ring[one, 1]) / span
    return g.ring[one, 1] + slope * (angle - g.ring[one, 0]), slope


@kernel
def _pushed_on(b, flat, speed):
    """Whether flats that bear ``flat`` N, and go down at a speed, are pressed into the rock with all they can take."""
    return flat >= b.limit or (flat >= b.limit * (1.0 - YIELDED) and speed > 0.0)


@kernel
def _measure_blades(g, t, q, v, way):
    b = g.row[0]
    value, slope = g.value, g.slope
    value.fill(0.0)
    slope.fill(0.0)
    depth, newest = depth_of(g, q), g.ring[g.head[0], 0]
    # A bit that turns back meets the bottom as its blades last left it.
    angle = max(q[g.turn], newest)
    left, falls = _behind(g, angle - 2.0 * pi / b.blades)
    cut = b.blades * max(0.0, depth - left)
    flat = min(b.limit, b.stiffness * max(0.0, depth - b.seat))
    value[WEIGHT] = b.cut_weight * cut + flat
    value[KINETIC] = b.cut_torque * cut + b.below * flat if way >= 0.0 else b.back * value[WEIGHT]
    value[STATIC] = value[KINETIC]
    # Blades that were turned back pass over what they have cut already.
    value[RATE] = cut * max(0.0, v[g.turn]) / (2.0 * pi) if q[g.turn] >= newest else 0.0
    presses = b.stiffness if flat > 0.0 and not _pushed_on(b, flat, speed_of(g, v)) else 0.0
    blades = b.blades if cut > 0.0 else 0.0
    slope[WEIGHT, DEPTH] = b.cut_weight * blades + presses
    slope[KINETIC, DEPTH] = b.cut_torque * blades + b.below * presses
    # One that stands at the end of what it has cut is on its way beyond that while it turns forward.
    turns = b.settled == SLIP and v[g.turn] > 0.0
    if q[g.turn] > newest or (q[g.turn] == newest and turns):
        slope[WEIGHT, ANGLE] = -b.cut_weight * blades * falls
        slope[KINETIC, ANGLE] = -b.cut_torque * blades * falls
    for k in range(4):
        if way < 0.0:
            slope[KINETIC, k] = b.back * slope[WEIGHT, k]
        slope[STATIC, k] = slope[KINETIC, k]


@kernel
def _place_blades(g, t, q, v):
    """As if the bit had drilled steadily so far, with the weight that it starts with."""
    b = g.row[0]
    depth, size = depth_of(g, q), g.ring.shape[0]
    flat = min(b.weight, b.limit)
    cut = (b.weight - flat) / b.cut_weight
    pitch = 2.0 * pi / b.blades
    for k in range(size):
        back = REACH * pitch * (size - 1 - k) / (size - 1)
        g.ring[k, 0] = q[g.turn] - back
        g.ring[k, 1] = depth - cut * back / (2.0 * pi)
    g.head[0] = size - 1
    b.seat = depth - flat / b.stiffness
    b.hole = depth
    b.time = t
    _measure_blades(g, t, q, v, v[g.turn])
    b.drilled = g.value[RATE]


@kernel
def _rename(g, angle, pitch):
    """Call the blades of a bit that was turned back by their neighbours' names: they are alike, and so is the bottom.

    Blades that had to make up for all turns back would stand on one place of the bottom until then, and not cut it.
    """
    turned_back = np.floor((g.ring[g.head[0], 0] - angle) / pitch)
    if turned_back > 0.0:
        for k in range(g.ring.shape[0]):
            g.ring[k, 0] -= turned_back * pitch


@kernel
def _advance_blades(g, t, q, v):
    """Remember the bottom that the blades leave, where they have come further than before."""
    b = g.row[0]
    _measure_blades(g, t, q, v, v[g.turn])
    depth, size = depth_of(g, q), g.ring.shape[0]
    pitch = 2.0 * pi / b.blades
    _rename(g, q[g.turn], pitch)
    newest = g.ring[g.head[0], 0]
    ahead = q[g.turn] - newest
    bottom = max(depth, _behind(g, max(q[g.turn], newest) - pitch)[0])
    # Flats that bear nothing lie on the bottom, which no bit lifts: seat and bottom part where the bit hangs free.
    b.seat = max(min(b.seat, bottom), depth - b.limit / b.stiffness)
    before = (g.head[0] + size - 1) % size
    if ahead > 0.0:
        # While the last two are too near the newest is moved on: a bit that creeps must not use up the ring.
        if g.ring[g.head[0], 0] - g.ring[before, 0] > REACH * pitch / (size - 1):
            g.head[0] = (g.head[0] + 1) % size
        g.ring[g.head[0], 0] = q[g.turn]
        g.ring[g.head[0], 1] = bottom
    else:
        g.ring[g.head[0], 1] = max(bottom, g.ring[g.head[0], 1])
    # A weight presses bits into the bottom that do not turn: only what blades cut away deepens the hole.
    b.hole += 0.5 * (t - b.time) * (b.drilled + g.value[RATE])
    b.drilled = g.value[RATE]
    b.time = t


@kernel
def _strain_blades(g, q):
    b = g.row[0]
    flat = min(b.limit, b.stiffness * max(0.0, depth_of(g, q) - b.seat))
    return 0.5 * flat * flat / b.stiffness


@kernel
def _stores_blades(g, q, v):
    b = g.row[0]
    flat = b.stiffness * (depth_of(g, q) - b.seat)
    speed = speed_of(g, v)
    if flat <= 0.0 or (_pushed_on(b, flat, speed) and speed > 0.0):
        return 0.0
    return min(b.limit, flat) * speed


measure = by_type({RockBit: _measure_rock, BladeBit: _measure_blades})
place = by_type({RockBit: _place_rock, BladeBit: _place_blades})
advance = by_type({RockBit: _advance_rock, BladeBit: _advance_blades})
strain = by_type({RockBit: _strain_rock, BladeBit: _strain_blades})
stores = by_type({RockBit: _stores_rock, BladeBit: _stores_blades})
