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

from drillstring.drilling.bit_numbers import bit_row, rate_at, speed_factor, stiffness_of, weight_at
from drillstring.drilling.end_groups import BLOCK, ROTATION, from_outside, requests
from drillstring.string.lumps import Tube
from tautline.kernels.time_function import TimeFunctions, sample
from tautline.scene.reading.files import stamps
from tautline.system.time_functions import compile_functions

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

STEPS, OF_A_WAVE, MOST_STEPS = 2000, 20, 100_000
"""Steps over a run at least, over a period of its fastest wave, and at most."""
LAST, STEADY = 0.1, 1.0e-3
"""Last part of a run in which block and rotary keep their speeds where they are taken to keep them afterwards, and the
share of the fastest speed up to which they do."""
FOUND, PASSES = 1.0e-9, 200
"""Relative change at which a weight counts as found, and bound of the search."""


class WeightOfRun(NamedTuple):
    """Weight on bit over a run: ``time`` (m,) s and ``weight`` (m,) N.

    ``rate`` m/s is that at which the bit drills with the weight of the start, ``feed`` m/s that at which the block
    comes down, ``spin`` rad/s the rotary's, all at the end. ``still`` tells that the block never moves. ``to_come`` N
    is where the weight goes if block and rotary go on as they do at the end: inf where it grows for ever, None where
    they do not go on steadily.
    """

    time: np.ndarray
    weight: np.ndarray
    rate: float
    feed: float
    spin: float
    still: bool
    to_come: float | None


def is_of_the_scene(scene: DrillstringScene) -> bool:
    """Whether the weight follows from the scene: inputs from outside move neither the block nor a bit that drills."""
    drills = scene.bit.penetration is not None or scene.bit.cutting is not None
    return not from_outside(scene, BLOCK) and not (drills and from_outside(scene, ROTATION))


def weight_of_run(scene: DrillstringScene, tubes: Sequence[Tube]) -> WeightOfRun:
    """Weight on bit over the run of a scene whose bit is on bottom, found once; ``tubes`` are its string's."""
    parts = scene.bit, scene.top, scene.solver.end, scene.well.diameter, tuple(tubes), stamps(scene.top, scene.folder)
    return scene.once("weight of run", parts, lambda: _followed(scene, tubes))


def _followed(scene: DrillstringScene, tubes: Sequence[Tube]) -> WeightOfRun:
    """The weight as it is found."""
    functions, end = compile_functions(requests(scene)), scene.solver.end
    time = _instants(functions, end)
    block, rotary = (sample(functions, one, time) for one in (BLOCK, ROTATION))
    feed, spin = float(block[-1, 1]), float(rotary[-1, 1])
    b = bit_row(scene.bit, scene.well.diameter, tubes, spin, False)[0]
    spring = 1.0 / (1.0 / (stiffness_of(b) or scene.bit.rock.stiffness) + _give(tubes))
    speeds, where = np.unique(rotary[:, 1], return_inverse=True)
    factor = np.array([speed_factor(b, speed) for speed in speeds.tolist()])[where]
    # W_0 of the scene, and not of the row, which has none of a bit that starts without weight.
    free = (scene.bit.weight or 0.0) + spring * (block[:, 0] - block[0, 0])
    lever = spring * float(b.cut) * factor * np.diff(time, prepend=0.0)
    weight = _pressed(free, lever, float(b.threshold), float(b.weight_exponent))
    steady = _goes_on(time, block[:, 1]) and _goes_on(time, rotary[:, 1])
    to_come = settled(b, feed, spin, float(weight[-1])) if steady else None
    rate = rate_at(b, scene.bit.weight or 0.0, spin)
    return WeightOfRun(time, weight, rate, feed, spin, not np.any(block[:, 1]), to_come)


def settled(b: np.record, feed: float, spin: float, weight: float) -> float:
    """Weight, N, to which a weight on bit goes for good under a block that comes down at ``feed`` m/s; inf if it grows.

    A block that is held leaves what the bit does not drill off, one that is raised nothing.
    """
    if feed < 0.0:
        return 0.0
    if feed > 0.0:
        return weight_at(b, feed, spin)
    return min(weight, float(b.threshold)) if b.cut * speed_factor(b, spin) > 0.0 else weight


def _give(tubes: Sequence[Tube]) -> float:
    """How much longer a string gets by a newton, m/N."""
    return sum(tube.length / (tube.youngs_modulus * tube.area) for tube in tubes)


def _instants(functions: TimeFunctions, end: float) -> np.ndarray:
    """Times at which the weight is computed, (m,) s: with every change of the formulas, and often in every wave."""
    waves = [functions.waves[functions.wave_from[one] : functions.wave_to[one]] for one in (BLOCK, ROTATION)]
    _, w, c, _, _ = np.concatenate(waves).T
    fastest = float(np.maximum(np.abs(w), np.abs(w + 2.0 * c * end)).max(initial=0.0))
    steps = int(np.clip(OF_A_WAVE * end * fastest / (2.0 * np.pi), STEPS, MOST_STEPS))
    tracks = functions.break_from[[functions.track_from[BLOCK], functions.track_to[ROTATION]]]
    changes = functions.breaks[tracks[0] : tracks[1]]
    edges = np.unique(np.concatenate([[0.0, end], changes[(changes > 0.0) & (changes < end)]]))
    # A ramp that is short beside the run wants steps of its own.
    share = np.arange(-(-STEPS // edges.size)) * (edges.size / STEPS)
    within = (edges[:-1, None] + np.diff(edges)[:, None] * share[share < 1.0]).ravel()
    return np.unique(np.concatenate([np.linspace(0.0, end, steps + 1), within]))


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
