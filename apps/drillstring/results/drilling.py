"""What a run says of its ends to a driller: weight and torque on bit, rate of penetration, the drive, stick-slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drillstring.drilling.bit_group import OWN
from drillstring.drilling.bit_rock import BladeBit, RockBit
from drillstring.drilling.top_drive import TopDrive
from drillstring.scene.scene import DrillstringScene
from tautline.results.variable import Variable, at_start, late_start
from tautline.scene.values.printed import printed_in, shown

LAST = 0.5
"""Part of a run, at its end, that tells of stick-slip and of means: what was before is how it came to that."""
STILL = 1.0e-4
"""Share of the mean rotary speed below which a bit counts as stuck: one that sticks exactly has a millionth of it."""
SLOWEST = 1.0e-3
"""Mean rotary speed, rad/s, below which a string does not count as turning."""
ROCKING = 0.05
"""Mean rotary speed over half the swing, both ways counted alike, below which a bit rocks and does not turn: of rocking
so much of a mean can be left by one cycle that is cut at the end of some ten."""

HALTED = 0.05
"""Mean speed of a drive over the one asked for, below which it stalls if its torque does not rise either: on its limit
it swings on the string to and fro."""
RISEN = 1.02
"""Mean torque of a drive in a run's last quarter over that in the one before, from which it rises."""
NOT_TURNING = 1.0e-3
"""Share of the rotary speed asked for below which a bit that never was faster has not turned."""


def variables_of_ends(groups: Sequence[Any]) -> list[Variable]:
    """What is stored of a bit on bottom and of a drive."""
    found = []
    if any(isinstance(g, RockBit | BladeBit) for g in groups):
        found += [
            Variable("weight_on_bit", ("time",), "N", "weight on bit"),
            Variable("torque_on_bit", ("time",), "N m", "torque that resists the bit"),
            Variable("rate_of_penetration", ("time",), "m/s", "rate of penetration"),
            Variable("hole_depth", ("time",), "m", "measured depth of the hole's bottom"),
        ]
    if any(isinstance(g, TopDrive) for g in groups):
        found += [
            Variable("drive_torque", ("time",), "N m", "torque of the top drive, also on its own inertia"),
            Variable("drive_speed", ("time",), "rad/s", "rotary speed of the top drive"),
        ]
    return found


def observed_at_ends(frames: Any, groups: Sequence[Any]) -> dict[str, np.ndarray]:
    """Those variables of a batch of frames; the groups at the ends record their numbers last."""
    found: dict[str, np.ndarray] = {}
    after = frames.own.shape[1]
    for g in reversed(groups):
        if isinstance(g, TopDrive):
            after -= 1
            found |= {"drive_torque": frames.own[:, after].copy(), "drive_speed": frames.v[:, g.place].copy()}
        elif isinstance(g, RockBit | BladeBit):
            after -= OWN
            names = ("weight_on_bit", "torque_on_bit", "rate_of_penetration", "hole_depth")
            found |= {name: frames.own[:, after + k].copy() for k, name in enumerate(names)}
    return found


def stall_of(result: Mapping[str, Any] | Any, speed: float) -> float:
    """Torque of a drive that neither turns nor gains torque any more in the last part of a run, N m; NaN of another,
    and of a run with one frame there.

    The rotary speed that is asked of it is ``speed``, rad/s; its way round counts as the positive one.
    """
    if "drive_torque" not in result or speed == 0.0:
        return np.nan
    last, way = last_part(result["time"]), np.sign(speed)
    if last.sum() < 2:
        return np.nan  # Whether it gains torque is between two frames.
    torque, turned = way * result["drive_torque"][last], result["drive_speed"][last]
    before, after = np.array_split(torque, 2)
    halts = abs(turned.mean()) < HALTED * abs(speed) and after.mean() < RISEN * before.mean()
    return float(torque.mean()) if halts else np.nan


def stalled_drive(result: Mapping[str, Any] | Any, speed: float, on_bottom: bool, system: str) -> list[str]:
    """A sentence where the bit does not turn in the last part of a run because its drive stalls.

    The mean rotary speed that is asked of the drive there is ``speed``, rad/s.
    """
    last = last_part(result["time"])
    if np.abs(result["rotation_rate"][last, -1]).max() > NOT_TURNING * abs(speed):
        return []
    torque = stall_of(result, speed)
    if np.isnan(torque):
        return []
    told = f"in the last half of the run the bit does not turn. {stalls_at(shown(torque, 'N m', system, digits=3))}"
    return [f"{told}. Give more torque{' or less weight' if on_bottom else ''}"]


def stalls_at(torque: str) -> str:
    """That a drive stalls at a torque, in words."""
    return f"The drive stalls at {torque}"


def _per_hour(rate: float, result: Any) -> str:
    """A rate of penetration as drillers write it, in the units of the result."""
    system = printed_in(getattr(result, "attributes", {}))
    return shown(3600.0 * rate, "m/h", system, digits=3)


def last_part(time: np.ndarray) -> np.ndarray:
    """Frames (m,) of the part of a run that tells of stick-slip."""
    return time >= time[-1] - LAST * (time[-1] - time[0])


def creep_of(scene: DrillstringScene) -> float:
    """Rotary speed, rad/s, up to which a bit at rest creeps in a run of a scene: none but in an explicit one."""
    return scene.bit.slip_speed if scene.solver.explicit else 0.0


def stick_slip(time: np.ndarray, spin: np.ndarray, creep: float = 0.0) -> dict[str, float]:
    """What `swing_of` tells of a bit's rotary speed (m,) rad/s in the last part of a run."""
    return swing_of(spin[last_part(time)], creep)


def swing_of(spin: np.ndarray, creep: float = 0.0) -> dict[str, float]:
    """Severity (max - min) / (2 |mean|) of a bit's rotary speed (m,) rad/s; share of its time stuck; mean, least and
    largest speed, and half of what lies between them. The severity of a bit that rocks has no meaning and is NaN.
    A bit at rest goes as fast as ``creep``, rad/s.
    """
    mean = float(spin.mean())
    swing = float(np.ptp(spin)) / 2.0
    rocks = swing > SLOWEST and abs(mean) < ROCKING * swing
    still = max(creep, STILL * abs(mean) if abs(mean) > SLOWEST else SLOWEST)
    return {
        "severity": np.nan if rocks else swing / abs(mean) if swing > SLOWEST else 0.0,
        "stuck": float((np.abs(spin) < still).mean()),
        "mean": mean,
        "least": float(spin.min()),
        "largest": float(spin.max()),
        "swing": swing,
    }


def drilling_figures(result: Mapping[str, Any] | Any, creep: float = 0.0) -> dict[str, tuple[float, str, str]]:
    """Headline figures of a bit on bottom: name -> (value, unit, text); ``creep`` as `creep_of` has it."""
    late, time, spin = late_start(result), result["time"], result["rotation_rate"][:, -1]
    last = last_part(time)
    figures = {
        "weight_on_bit_start": (at_start(result, "weight_on_bit"), "N", f"weight on bit at {late or 'the start'}"),
        "weight_on_bit_mean": (result["weight_on_bit"][last].mean(), "N", "mean weight on bit, last half"),
    }
    if np.any(result["torque_on_bit"] != 0.0):
        figures["torque_on_bit_mean"] = (result["torque_on_bit"][last].mean(), "N m", "mean torque on bit, last half")
    drilled = result["hole_depth"][-1] - at_start(result, "hole_depth")
    if drilled > 0.0:
        mean = np.ptp(result["hole_depth"][last]) / max(np.ptp(time[last]), 1e-300)
        figures["drilled"] = (drilled, "m", "depth drilled" + (f" since {late}" if late else ""))
        figures["rate_of_penetration_mean"] = (
            mean,
            "m/s",
            f"rate of penetration, last half ({_per_hour(mean, result)})",
        )
    found = stick_slip(time, spin, creep)
    if max(found["largest"], -found["least"]) > SLOWEST:
        severity, turning = found["severity"], "mean rotary speed of the bit, last half"
        if np.isnan(severity):
            turning += " (it rocks to and fro: stick-slip severity has no meaning)"
        figures["bit_rotation_mean"] = (found["mean"], "rad/s", turning)
        if not np.isnan(severity):
            figures["stick_slip_severity"] = (severity, "", "stick-slip severity of the bit, last half")
        figures["rotation_stuck"] = (found["stuck"], "", "share of time with the bit at rest, last half")
    return figures
