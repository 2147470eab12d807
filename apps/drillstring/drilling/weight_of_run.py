"""Weight on bit over a run, as the way of the block and what the bit drills make it: one differential equation.

String and rock are two springs in series, 1/K = 1/k_rock + sum(L / EA). Block and bottom move their ends, so that

    W(t) = max(0, W_0 + K (x(t) - x(0) - h(t))),    dh/dt = rate(W, Omega(t)),

with the block's way x and the depth h that is drilled. A bit that is lifted leaves its bottom where it is, and has to
come back by the same way. Friction, waves along the string, and a speed of the bit that is not the rotary's are left
out. That a string which is held drills off its weight as an exponential is the best known case: A. Lubinski,
"Proposal for future tests", The Petroleum Engineer 29, 1958.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, rate_by, speed_factor, stiffness_of, weight_by
from drillstring.drilling.end_groups import BLOCK, ROTATION, from_outside, requests
from drillstring.string.lumps import Tube
from tautline.kernels.time_function import TimeFunctions, sample
from tautline.scene.reading.files import stamps
from tautline.system.time_functions import compile_functions

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

STEPS, OF_A_WAVE, MOST_STEPS, MOST_WAVES = 2000, 20, 40_000, 1_600_000
"""Steps over a run at least, over a period of its fastest wave, and at most; and waves at all of them at most, of which
a sea has hundreds at each."""
AT_ENDS = 0.25
"""Share of the most steps that follows every wave at either end of a run which has more waves than they can follow."""
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
"""Of all numbers that whose multiples fall into step with no period: waves are met in all their phases."""
LAST, STEADY, KEPT = 0.1, 1.0e-3, 0.02
"""Last part of a run by which it is told how it goes on, the share of its fastest speed up to which a block is steady
there, and the share up to which two means of what a rotary drills are the same."""
ROUNDED = 1.0e-6
"""Share of the block's whole way that is none."""
SMALLEST_WAY = 1.0e-9
"""Way over a whole run that is none, m: string and rock answer it with some thousandths of a newton."""
FOUND, PASSES = 1.0e-9, 200
"""Relative change at which a weight counts as found, and bound of the search."""


class WeightOfRun(NamedTuple):
    """Weight on bit over a run: ``time`` (m,) s and ``weight`` (m,) N.

    ``rate`` m/s is that at which the bit drills with the weight of the start, ``feed`` m/s that at which the block
    comes down, ``spin`` rad/s the rotary's, all at the end; a rotary that ripples counts with its mean, and ``keeps``
    tells that this stays. ``still`` tells that the block never moves. ``to_come`` N is where the weight goes if block
    and rotary go on as they do at the end: inf where it grows for ever, None where the block does not go on steadily.
    ``followed`` s is how long every wave is followed at either end of the run, the whole of it where all are.
    """

    time: np.ndarray
    weight: np.ndarray
    rate: float
    feed: float
    spin: float
    keeps: bool
    still: bool
    to_come: float | None
    followed: float


def drills(scene: DrillstringScene) -> bool:
    """Whether the bit has a law by which it drills."""
    return scene.bit.penetration is not None or scene.bit.cutting is not None


def is_of_the_scene(scene: DrillstringScene) -> bool:
    """Whether the weight follows from the scene: inputs from outside move neither the block nor a bit that drills."""
    return not from_outside(scene, BLOCK) and not (drills(scene) and from_outside(scene, ROTATION))


def weight_of_run(scene: DrillstringScene, tubes: Sequence[Tube]) -> WeightOfRun:
    """Weight on bit over the run of a scene whose bit is on bottom, found once; ``tubes`` are its string's."""
    parts = scene.bit, scene.top, scene.solver.end, scene.well.diameter, tuple(tubes), stamps(scene.top, scene.folder)
    return scene.once("weight of run", parts, lambda: _followed(scene, tubes))


def _followed(scene: DrillstringScene, tubes: Sequence[Tube]) -> WeightOfRun:
    """The weight as it is found."""
    functions, end = compile_functions(requests(scene)), scene.solver.end
    waves = [_waves(functions, one) for one in (BLOCK, ROTATION)[: 1 + drills(scene)]]
    time, followed = _instants(functions, waves, end)
    block, rotary = (sample(functions, one, time) for one in (BLOCK, ROTATION))
    b = bit_row(scene.bit, scene.well.diameter, tubes, float(rotary[-1, 1]), False)[0]
    spring = 1.0 / (1.0 / (stiffness_of(b) or scene.bit.rock.stiffness) + _give(tubes))
    speeds, where = np.unique(rotary[:, 1], return_inverse=True)
    factor = np.array([speed_factor(b, speed) for speed in speeds.tolist()])[where]
    # W_0 of the scene, and not of the row, which has none of a bit that starts without weight.
    start, speed = scene.bit.weight or 0.0, _speed(block, end)
    feed = float(speed[-1])
    lever = spring * float(b.cut) * factor * np.diff(time, prepend=0.0)
    weight = _pressed(start + spring * _way(block[:, 0]), lever, float(b.threshold), float(b.weight_exponent))
    part = _last_part(_waves(functions, ROTATION), end)
    cuts, keeps = _kept(time, factor, part)
    spin, _ = _kept(time, rotary[:, 1], part) if keeps else (float(rotary[-1, 1]), False)
    to_come = settled(b, feed, cuts, float(weight[-1])) if _goes_on(time, speed) else None
    rate = rate_by(b, start, cuts)
    return WeightOfRun(time, weight, rate, feed, spin, keeps, not np.any(speed), to_come, followed)


def settled(b: np.record, feed: float, cuts: float, weight: float) -> float:
    """Weight, N, to which a weight on bit goes for good under a block that comes down at ``feed`` m/s; inf if it grows.

    ``cuts`` is the mean factor of the rate of penetration by the rotary's speeds. A block that is held leaves what the
    bit does not drill off, one that is raised nothing.
    """
    if feed < 0.0:
        return 0.0
    if feed > 0.0:
        return weight_by(b, feed, cuts)
    return min(weight, float(b.threshold)) if b.cut * cuts > 0.0 else weight


def _way(position: np.ndarray) -> np.ndarray:
    """Way of the block (m,) m since the start, by its positions (m,) m: that which is their rounding is none."""
    way = position - position[0]
    # 1e-12 is thousands of roundings of a number.
    return np.where(np.abs(way) > ROUNDED * np.abs(way).max() + 1e-12 * np.abs(position).max(), way, 0.0)


def _speed(block: np.ndarray, end: float) -> np.ndarray:
    """Speeds of the block (m,) m/s, of its positions, speeds and second rates (m, 3): what is their rounding is none.

    Terms of a sum that end at rest leave some, and 0.1 + 0.2 - 0.3 is none of the speeds that were given: a speed that
    would move the block in the run by no more than positions are rounded is none either.
    """
    speed = block[:, 1]
    least = ROUNDED * np.abs(speed).max() + SMALLEST_WAY / end
    return np.where(np.abs(speed) > least, speed, 0.0)


def _give(tubes: Sequence[Tube]) -> float:
    """How much longer a string gets by a newton, m/N."""
    return sum(tube.length / (tube.youngs_modulus * tube.area) for tube in tubes)


def _waves(functions: TimeFunctions, one: int) -> np.ndarray:
    """Waves (n, 5) of a function, as `TimeFunctions.waves` has them."""
    return functions.waves[functions.wave_from[one] : functions.wave_to[one]]


def _wanted(waves: np.ndarray, end: float) -> tuple[float, int]:
    """How many steps waves (n, 5) want over a run, and how many they get at most."""
    _, w, c, _, _ = waves.T
    fastest = float(np.maximum(np.abs(w), np.abs(w + 2.0 * c * end)).max(initial=0.0))
    return OF_A_WAVE * end * fastest / (2.0 * np.pi), min(MOST_STEPS, max(STEPS, MOST_WAVES // max(len(waves), 1)))


def _instants(functions: TimeFunctions, waves: Sequence[np.ndarray], end: float) -> tuple[np.ndarray, float]:
    """Times at which the weight is computed, (m,) s, and how long they follow every wave at either end of the run, s.

    They hold every change of the formulas. Of a run with more waves than they can follow they are irregular between
    its ends: waves that keep time with the steps would be met in the same phase at each.
    """
    wanted, most = _wanted(np.concatenate(waves), end)
    if wanted <= most:
        regular, followed = np.linspace(0.0, end, int(max(wanted, STEPS)) + 1), end
    else:
        count = int(AT_ENDS * most)
        followed = count * end / wanted
        begin = np.linspace(0.0, followed, count + 1)
        k = np.arange(most - 2 * count)
        between = followed + (end - 2.0 * followed) * (k + k * GOLDEN % 1.0) / k.size
        regular = np.concatenate([begin, between, end - begin])
    return np.unique(np.concatenate([regular, _near_changes(functions, end)])), followed


def _near_changes(functions: TimeFunctions, end: float) -> np.ndarray:
    """Times (m,) s of all changes of the formulas, and some between them: a short ramp wants steps of its own."""
    tracks = functions.break_from[[functions.track_from[BLOCK], functions.track_to[ROTATION]]]
    changes = functions.breaks[tracks[0] : tracks[1]]
    edges = np.unique(np.concatenate([[0.0, end], changes[(changes > 0.0) & (changes < end)]]))
    share = np.arange(-(-STEPS // edges.size)) * (edges.size / STEPS)
    return (edges[:-1, None] + np.diff(edges)[:, None] * share[share < 1.0]).ravel()


def _last_part(waves: np.ndarray, end: float) -> float:
    """Length, s, of the last part of a run by which its rotary is judged: twice whole periods of its slowest wave."""
    slowest = np.abs(waves[waves[:, 1] != 0.0, 1]).min(initial=np.inf)
    half, period = 0.5 * LAST * end, 2.0 * np.pi / slowest
    if not 0.0 < period <= 0.5 * end:
        return 2.0 * half
    return min(2.0 * period * float(np.ceil(half / period)), end)


def _kept(time: np.ndarray, value: np.ndarray, part: float) -> tuple[float, bool]:
    """Mean of values (m,) over the last part of a run, s, and whether its halves have the same; the last one if not."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))])
    first, middle, last = np.interp(time[-1] - part * np.array([1.0, 0.5, 0.0]), time, area)
    mean = float((last - first) / part)
    keeps = abs(last - 2.0 * middle + first) <= KEPT * abs(last - first)
    return (mean, True) if keeps else (float(value[-1]), False)


def _goes_on(time: np.ndarray, speed: np.ndarray) -> bool:
    """Whether a speed (m,) stays what it is in the last part of a run."""
    last = speed[time >= (1.0 - LAST) * time[-1]]
    return float(np.ptp(last)) <= STEADY * float(np.abs(speed).max())


def _pressed(free: np.ndarray, lever: np.ndarray, threshold: float, exponent: float) -> np.ndarray:
    """Weight (m,) N by steps of Euler's implicit rule.

    ``free`` (m,) N is the weight if nothing were drilled, ``lever`` (m,) what (W - threshold)^exponent, drilled for a
    step, takes off it.
    """
    weight, gone = np.empty(free.size), 0.0
    for k, (whole, takes) in enumerate(zip(free.tolist(), lever.tolist(), strict=True)):
        pressed = whole - gone
        if pressed > threshold and takes > 0.0:
            left = threshold + _left(pressed - threshold, takes, exponent)
            gone += pressed - left
            pressed = left
        weight[k] = max(pressed, 0.0)
    return weight


def _left(over: float, lever: float, exponent: float) -> float:
    """y > 0 of y + lever y^exponent = over."""
    if exponent == 1.0:
        return over / (1.0 + lever)
    share = lever * over ** (exponent - 1.0)
    if exponent > 1.0:
        return over * _root(share, exponent, 1.0)
    # Of the power itself, so that it is the exponent above 1 that counts, and Newton's tangents stay on one side.
    return float(over * _root(1.0, 1.0 / exponent, share) ** (1.0 / exponent))


def _root(a: float, power: float, b: float) -> float:
    """z > 0 of a z^power + b z = 1, power > 1, by Newton's method from above."""
    z = min(1.0 / b, a ** (-1.0 / power)) if a > 0.0 and b > 0.0 else 1.0
    for _ in range(PASSES):
        steep = a * z ** (power - 1.0)
        step = (steep * z + b * z - 1.0) / (power * steep + b)
        z -= step
        if step <= FOUND * z:
            break
    return float(z)
