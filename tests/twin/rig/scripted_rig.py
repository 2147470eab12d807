"""A rig that is played from a script, apart from the program: what its sensors show, and which state it truly is in.

A script is a list of phases with durations. The block, the rotary and the pumps follow it with limited acceleration,
the weight goes over to the slips in 2 to 5 s while the block gives way. Then sensors lag, are disturbed and sampled.

The true state at a time follows from the true quantities, by definitions of its own: the string is in the slips from
when these carry half of its weight; it turns above 0.3 rad/s (3 rpm); pumps run above 5 l/s; it moves above 1 cm/s; it
is a connection from when the block has left the place where it let the string go by 2 cm; the bit is on bottom while
there is weight on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign

import numpy as np

TICK = 0.1
"""Time between two states of the rig, s: the fastest sensor shows ten a second."""


@dataclass(frozen=True)
class Phase:
    """What the driller does for some time, s; ``speed`` m/s of the block; ``travel`` m of the block in a connection."""

    what: str
    duration: float
    speed: float = 0.0
    travel: float = 0.0


def drill(duration, rate=20.0 / 3600.0):
    return Phase("drill", duration, rate)


def slide(duration, rate=8.0 / 3600.0):
    return Phase("slide", duration, rate)


def ream(duration, speed):
    return Phase("ream", duration, speed)


def trip(duration, speed):
    return Phase("trip", duration, speed)


def connect(duration, travel):
    return Phase("connect", duration, 0.5, travel)


def rotate(duration):
    return Phase("rotate", duration)


def circulate(duration):
    return Phase("circulate", duration)


def rest(duration):
    return Phase("rest", duration)


def slips(duration):
    return Phase("slips", duration)


@dataclass(frozen=True)
class Rig:
    """Weights N, drag along the hole N, torques N m, normal speed rad/s, flow m^3/s, lag of sensors s."""

    block_weight: float = 350e3
    string_weight: float = 900e3
    drag: float = 90e3
    weight_on_bit: float = 120e3
    torque: float = 6e3
    bit_torque: float = 5e3
    speed: float = 12.6
    flow: float = 0.035
    depth: float = 2800.0
    above: float = 2.0
    lags: tuple[tuple[str, float], ...] = (("hook_load", 0.4), ("rotary_speed", 0.3), ("torque", 0.3), ("flow", 0.8))


def play(rig: Rig, script: list[Phase], rate: float, seed: int, noise: float = 0.01, depth_noise: float = 0.01):
    """Columns by name, with noise of 1 % of the reading and of 1 % of the full scale's tenth; and the true states.

    Depths and the block have noise of 1 cm, for they are counted and not weighed.
    """
    random = np.random.default_rng(seed)
    true, states = _true(rig, script, random)
    columns = {"time": np.arange(len(states)) * TICK}
    for name, lag in rig.lags:
        true[name] = _lagged(true[name], lag)
    pick = np.arange(0, len(states), round(1.0 / (rate * TICK)))
    for name in ("hook_load", "rotary_speed", "torque", "flow"):
        x = true[name][pick]
        scale = np.abs(x) + 0.1 * np.abs(true[name]).max()
        columns[name] = x + noise * scale * random.standard_normal(x.size)
    for name in ("block", "bit_depth"):
        columns[name] = true[name][pick] + depth_noise * random.standard_normal(pick.size)
    columns["hole_depth"] = true["hole_depth"][pick]
    columns["time"] = columns["time"][pick]
    return columns, [states[k] for k in pick]


def _true(rig: Rig, script: list[Phase], random):
    count = round(sum(phase.duration for phase in script) / TICK)
    names = ("block", "hook_load", "rotary_speed", "torque", "flow", "bit_depth", "hole_depth")
    kept = {name: np.zeros(count) for name in names}
    states = []
    block, velocity, spin, flow, held, weight = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    bit, hole = rig.depth - rig.above, rig.depth
    in_slips = script[0].what in ("slips", "connect")
    held = 1.0 if in_slips else 0.0
    left = block
    k = 0
    for phase in script:
        transfer = random.uniform(2.0, 5.0)
        goes, start = phase.what in ("slips", "connect"), None
        for _ in range(round(phase.duration / TICK)):
            before = held
            held = min(1.0, held + TICK / transfer) if goes else max(0.0, held - TICK / transfer)
            free = held == 1.0
            turning = phase.what in ("drill", "ream", "rotate")
            spin += _within((rig.speed if turning and held == 0.0 else 0.0) - spin, 4.0 * TICK)
            pumped = rig.flow if phase.what in ("drill", "slide", "ream", "rotate", "circulate") else 0.0
            flow += _within(pumped - flow, 0.012 * TICK) if held == 0.0 else _within(-flow, 0.012 * TICK)
            drills = phase.what in ("drill", "slide")
            on_bottom = bit >= hole - 1e-9 and held == 0.0 and (drills or (weight > 0.0 and phase.what != "ream"))
            if on_bottom and drills:
                weight += _within(rig.weight_on_bit - weight, 0.3 * rig.weight_on_bit * TICK)
            elif on_bottom and velocity >= 0.0 and phase.speed >= 0.0:
                # A block that stands leaves the weight to a bit that drills off.
                weight *= 1.0 - TICK / 60.0
            else:
                on_bottom, weight = False, max(0.0, weight - 0.3 * rig.weight_on_bit * TICK)
            wanted = _wanted(phase, held, on_bottom and drills, hole - bit, block, start)
            if free and phase.what == "connect" and start is None:
                start = block
            velocity += _within(wanted - velocity, 0.3 * TICK)
            if on_bottom and drills:
                velocity = phase.speed
            moved = velocity * TICK
            if held == 0.0:
                moved = moved if drills and on_bottom else min(moved, hole - bit)
                bit += moved
                hole = max(hole, bit)
                block += moved
            elif free:
                block += moved
            else:
                # The string stretches and is let off while the slips take it, and the other way.
                velocity = 0.0
                block += 0.25 * (held - before)
            if before < 1.0 <= held:
                left = block
            drag = rig.drag * np.tanh(velocity / 0.01) * (0.1 if spin > 1.0 else 1.0) * (1.0 - held)
            string = rig.string_weight + (bit - rig.depth) * 250.0
            kept["hook_load"][k] = rig.block_weight + (1.0 - held) * (string - drag - weight)
            kept["torque"][k] = (rig.torque if spin > 0.1 else 0.0) + rig.bit_torque * weight / rig.weight_on_bit * (
                spin > 0.1
            )
            kept["block"][k], kept["rotary_speed"][k], kept["flow"][k] = block, spin, flow
            kept["bit_depth"][k], kept["hole_depth"][k] = bit, hole
            states.append(
                _state(held, abs(block - left) > 0.02 and free, states, spin > 0.3, flow > 0.005, velocity, on_bottom)
            )
            k += 1
    return kept, states


def _wanted(phase, held, on_bottom, gap, block, start):
    """Speed at which the block should go, m/s."""
    if phase.what == "connect" and held == 1.0 and start is not None:
        rest_of = start + phase.travel - block
        return copysign(min(phase.speed, np.sqrt(0.3 * abs(rest_of))), rest_of) if abs(rest_of) > 0.01 else 0.0
    if held > 0.0:
        return 0.0
    if phase.what in ("drill", "slide"):
        return phase.speed if on_bottom else min(0.04, 0.02 + gap)
    if phase.what in ("ream", "trip"):
        # The driller stops some way above the bottom.
        return min(phase.speed, np.sqrt(0.3 * max(gap - 0.5, 0.0))) if phase.speed > 0.0 else phase.speed
    return 0.0


def _state(held, travelled, states, turns, pumps, velocity, on_bottom):
    if held > 0.5:
        was = bool(states) and states[-1] == "connection"
        return "connection" if travelled or was else "in slips"
    if on_bottom and turns:
        return "drilling"
    if on_bottom and pumps:
        return "sliding"
    moves = abs(velocity) > 0.01
    if moves and turns and pumps:
        return "reaming down" if velocity > 0.0 else "reaming up"
    if moves:
        return "tripping in" if velocity > 0.0 else "tripping out"
    if turns:
        return "rotating off bottom"
    return "circulating" if pumps else "at rest"


def _within(change, most):
    return max(-most, min(most, change))


def _lagged(x, lag):
    y, out = x[0], np.empty_like(x)
    part = 1.0 - np.exp(-TICK / lag)
    for k, value in enumerate(x):
        y += part * (value - y)
        out[k] = y
    return out
