"""The figures that sum a run up: the largest tensions, where and when, and what they did to the rope."""

from __future__ import annotations

from typing import Any

import numpy as np

from crane.events import amplification, largest, safety_factor, slack_events
from crane.scene import CraneScene

SLACK = 0.01
"""Share of the largest tension at rest below which a span counts as slack."""


def headline(result: Any, scene: CraneScene) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up."""
    time, tension = np.asarray(result.time), np.asarray(result["tension"]).max(axis=-1)
    names = [str(name) for name in result.data["span"].values]
    peak = largest(time, tension, names)
    figures: dict[str, tuple[Any, str, str]] = {
        "tension_max": (peak.value, "N", f"largest tension ({peak.where}, at {peak.time:.3f} s)"),
    }
    lowest = largest(time, -np.asarray(result["tension"]).min(axis=-1), names)
    figures["tension_min"] = (-lowest.value, "N", f"smallest tension ({lowest.where}, at {lowest.time:.3f} s)")
    amplified = amplification(time, tension, tension[0], names)
    if amplified is not None:
        figures["amplification"] = (amplified.value, "", "largest tension over that at the start")
    safety = safety_factor(scene.rope.breaking_load, tension)
    if safety is not None:
        figures["safety_factor"] = (safety, "", "breaking load over largest tension")
    slack = slack_events(time, tension, names, threshold=SLACK * float(tension[0].max()))
    if slack:
        snaps = [event.snap for event in slack if event.snap is not None]
        figures["slack_events"] = (len(slack), "", "times that a span went slack")
        if snaps:
            figures["snap_max"] = (max(snaps), "N", "largest tension after slack")
    if "winch_power" in result.data:
        power = np.asarray(result["winch_power"])
        figures["winch_power_max"] = (float(power.max()), "W", "largest power of a winch")
    for k, name in enumerate(str(n) for n in result.data["body"].values):
        height = np.asarray(result["body_position"])[:, k, 2]
        figures[f"rise_{k + 1}"] = (float(height[-1] - height[0]), "m", f"rise of {name}")
    return {
        name: {"value": float(value) if not isinstance(value, int) else value, "unit": unit, "text": text}
        for name, (value, unit, text) in figures.items()
    }
