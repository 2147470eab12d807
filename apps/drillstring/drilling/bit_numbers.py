"""From a scene's bit to the numbers of its group: weight, torque and rate of penetration as one family of laws.

Torque is ``below min(W, limit) + above max(0, W - limit) + excess W exp(-|Omega| / decay)`` of the weight on bit W; the
rate is ``cut max(0, W - threshold)^a S(Omega)``. A drag bit after Detournay and Defourny (Int. J. Rock Mech. Min. Sci.
29, 1992) is one of them: with the depth of cut per turn d = 2 pi rate / Omega,

    W = a zeta eps d + W_f,   T = a^2 eps d / 2 + mu gamma a W_f / 2,   W_f = min(W, a l sigma),

so that d = (W - W_f) / (a zeta eps). That is one that turns forward. A drag bit that turns backward cuts no chips,
d = 0: nothing before its cutters carries any of the weight, and all of it presses bit and rock together. It rubs with
``back W``, T = mu gamma a W / 2, also beyond a l sigma. Roller bits, whose torque is given, are alike both ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, exp, pi, ulp

import numpy as np

from drillstring.groups.friction import SLIP, STICK
from drillstring.scene.bit import Bit
from drillstring.string.lumps import Tube

FLOATS = (
    # the scene's
    "weight", "torque", "stiffness", "damping",
    "threshold", "cut", "weight_exponent", "speed_exponent", "slow",
    "limit", "below", "above", "back", "excess", "decay", "slip_speed",
    "cut_weight", "cut_torque", "blades",
    "inertia", "spring",
    # of the last accepted step, and of the step under way
    "time", "hole", "drilled", "c", "force", "way", "slip", "seat",
    "last_weight", "last_force", "stored", "mean_weight", "mean_force", "storing",
)  # fmt: skip
WHOLE = ("placed", "settled", "status", "level", "dropped", "reversed")
BIT = np.dtype([(name, np.float64) for name in FLOATS] + [(name, np.int64) for name in WHOLE])
"""A bit on bottom. Weight N and torque N m that it starts with; rock N/m, N s/m; rate: threshold N, factor, exponents,
speed rad/s below which a power of it is linear; torque: weight N on the flats at most, m, m, m of a bit that turns
backward, m, decay rad/s (0: none), speed rad/s at which it is in full (0: exact); blades: N/m and N of a depth of cut,
and their number; inertia kg m^2 and spring N m/rad against which a bit that sticks is held. Then time s, depth of the
hole below its datum m, and its rate m/s; stiffness of sticking N m s/rad, torque on the bit N m, the way it slips, its
speed rad/s; depth at which the flats would lie loosely m. Weight N, torque N m and energy J in the rock of the last
step; the means of both over the step, and the power that went into the rock W. Whether the hole's bottom was placed,
and the status of sticking (see bit_torque.py)."""

SLOW = 0.01
"""Share of the speed at which a rate of penetration is given, below which a power of the speed becomes linear."""


def bit_row(bit: Bit, hole_diameter: float, tubes: Sequence[Tube], spin: float, explicit: bool) -> np.recarray:
    """The bit's row (1,) of `BIT`.

    Parameters
    ----------
    bit : Bit
        On bottom.
    hole_diameter : float
        m.
    tubes : sequence of Tube
        Of the string; the last one carries the bit.
    spin : float
        Rotary speed at t = 0, rad/s.
    explicit : bool
        Whether the method cannot solve for sticking.
    """
    row = np.zeros(1, BIT).view(np.recarray)
    b = row[0]
    b.weight, b.stiffness, b.damping = bit.weight, bit.rock.stiffness, bit.rock.damping
    if bit.torque is not None:
        at = bit.torque.weight or bit.weight
        b.above = b.back = bit.torque.kinetic / at
        b.excess = (bit.torque.static - bit.torque.kinetic) / at
        b.decay = bit.torque.decay or 0.0
    if bit.cutting is not None:
        _cut(b, bit, hole_diameter)
    elif bit.penetration is not None:
        law = bit.penetration
        b.threshold, b.weight_exponent, b.speed_exponent = law.threshold, law.weight_exponent, law.speed_exponent
        b.slow = SLOW * law.speed
        b.cut = law.rate / (((law.weight or bit.weight) - law.threshold) ** law.weight_exponent)
        b.cut /= speed_factor(b, law.speed)
    else:
        b.weight_exponent = b.speed_exponent = 1.0
    if explicit:
        b.slip_speed = bit.slip_speed
        # Static torque that is there at rest alone a function of the speed would not know.
        b.decay = b.decay or bit.slip_speed
    last = tubes[-1]
    b.inertia = last.rotary_inertia * last.length
    b.spring = last.torsional_stiffness / last.length
    b.settled = STICK if spin == 0.0 else SLIP
    b.c = 1.0
    return row


def _cut(b: np.record, bit: Bit, hole_diameter: float) -> None:
    """Numbers of a drag bit."""
    law = bit.cutting
    assert law is not None
    radius = law.radius or 0.5 * hole_diameter
    b.limit = radius * law.wear_flat * law.contact_strength
    b.cut_weight = radius * law.inclination * law.specific_energy
    b.cut_torque = 0.5 * radius**2 * law.specific_energy
    b.below = 0.5 * law.friction * law.bit_constant * radius
    b.above = b.cut_torque / b.cut_weight
    b.back = b.below
    b.threshold, b.cut = b.limit, 1.0 / (2.0 * pi * b.cut_weight)
    b.weight_exponent = b.speed_exponent = 1.0
    b.blades = float(law.blades or 0)


def speed_factor(b: np.record, spin: float) -> float:
    """How the rate of penetration depends on the rotary speed, rad/s."""
    if spin <= 0.0:
        return 0.0
    return float(spin * np.hypot(spin, b.slow) ** (b.speed_exponent - 1.0))


def torque_at(b: np.record, weight: float, spin: float) -> float:
    """Torque that resists a bit that turns steadily, N m, by weight on bit N and rotary speed rad/s; forward at 0."""
    held = b.below * min(weight, b.limit) + b.above * max(0.0, weight - b.limit) if spin >= 0.0 else b.back * weight
    return float(held + (b.excess * weight * exp(-abs(spin) / b.decay) if b.decay > 0.0 else 0.0))


def torque_at_rest(b: np.record, weight: float, way: float = 1.0) -> float:
    """Torque up to which a bit at rest is held, N m, at a weight on bit N; against turning back where ``way`` < 0."""
    held = torque_at(b, weight, copysign(ulp(0.0), way))
    return held if b.decay > 0.0 else held + float(b.excess * weight)


def rate_at(b: np.record, weight: float, spin: float) -> float:
    """Steady rate of penetration, m/s, at a weight on bit N and a rotary speed rad/s."""
    return rate_by(b, weight, speed_factor(b, spin))


def rate_by(b: np.record, weight: float, factor: float) -> float:
    """Rate of penetration, m/s, at a weight on bit N, by the factor of a speed or the mean one of many."""
    return float(b.cut * max(0.0, weight - b.threshold) ** b.weight_exponent * factor)


def weight_by(b: np.record, rate: float, factor: float) -> float:
    """Weight on bit, N, with which a bit drills at a rate above 0, m/s, by such a factor; inf where none does."""
    cut = b.cut * factor
    return float(b.threshold + (rate / cut) ** (1.0 / b.weight_exponent)) if cut > 0.0 else np.inf


def stiffness_of(b: np.record) -> float:
    """Stiffness, N/m, with which the rock holds a bit that moves along the hole while the hole does not deepen.

    It is that of the rock, or of the chips that blades cut and of flats that are not pushed on; 0 of a bit without
    weight.
    """
    if b.weight <= 0.0:
        return 0.0
    if b.blades == 0.0:
        return float(b.stiffness)
    cuts = b.blades * b.cut_weight if b.weight > b.limit else 0.0
    return float(cuts + (b.stiffness if b.weight < b.limit else 0.0))
