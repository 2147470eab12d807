"""Soft torque: a drive whose torque is computed in Python, beside the one that is built in.

T = K_p (Omega - phi.) + K_i (int Omega dt - phi). With K_p near the impedance of the pipe, and the inertia of the drive
cancelled by K_i at the string's first torsional frequency, waves leave the string through the drive.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import tautline

SCENE = Path(__file__).parents[1] / "data" / "drilling.yaml"
EVERY = 0.004
"""Time between readings, s."""


def scene() -> Any:
    """The drilling scene with a soft-torque drive, whose integral gain is left to be found."""
    read = tautline.read(SCENE)
    controller = {
        "kind": "soft-torque", "speed": {"ramp": {"to": "120 rpm", "over": "5 s"}}, "proportional": 1200.0,
        "inertia": 2000.0, "torque_limit": "40 kN m",
    }  # fmt: skip
    return read.replace({"top.rotation": {"controller": controller}})


def speed(t: float) -> tuple[float, float]:
    """Speed asked for, rad/s, and its integral, rad: a quintic ramp of five seconds to 120 rpm."""
    most, x = 120.0 * 2.0 * np.pi / 60.0, min(t / 5.0, 1.0)
    grown = 5.0 * most * x**4 * (2.5 - 3.0 * x + x * x)
    return most * x**3 * (10.0 - 15.0 * x + 6.0 * x * x), grown + max(0.0, t - 5.0) * most


def run(end: float = 20.0) -> dict[str, np.ndarray]:
    """Times s, and rotary speeds at the drive and at the bit, rad/s, of both drives."""
    from drillstring.drilling.impedance import gains
    from drillstring.model.prepared import prepared

    written = scene()
    built_in = tautline.simulate(written, end=end)
    proportional, integral = gains(written.top.rotation, prepared(written).lumps.tubes)
    sim = tautline.Simulation(written, inputs=["top.torque"])
    while sim.time < end - 1e-9:
        wanted, angle = speed(sim.time)
        turned, at = sim["rotation_rate"][0], sim["rotation"][0]
        torque = proportional * (wanted - turned) + integral * (angle - at)
        sim.inputs["top.torque"] = float(np.clip(torque, -40.0e3, 40.0e3))
        sim.advance(EVERY)
    ours = sim.result
    return {
        "time": ours["time"], "drive": ours["rotation_rate"][:, 0], "bit": ours["rotation_rate"][:, -1],
        "built-in drive": built_in["rotation_rate"][:, 0], "built-in bit": built_in["rotation_rate"][:, -1],
    }  # fmt: skip


if __name__ == "__main__":
    found = run()
    for what in ("drive", "bit"):
        mine, other = found[what], found[f"built-in {what}"]
        difference = np.sqrt(np.mean((mine - other) ** 2)) / np.abs(other).max()
        print(f"{what}: the two differ by {difference:.2%} of the largest speed")
