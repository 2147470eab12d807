"""The few figures that sum up the run of a hose."""

from __future__ import annotations

from typing import Any

import numpy as np

from gardenhose.motion.limit_cycle import limit_cycle
from tautline.cable.model.observe import extremes
from tautline.results.variable import at_start
from tautline.study.trials.errors import first_mode

FIGURES = {
    "tip_amplitude": "m", "frequency": "Hz", "cycles": "", "tip_speed_max": "m/s", "axial_force_max": "N",
    "axial_force_min": "N", "flow_speed": "m/s", "node": "", "node_amplitude": "m", "node_frequency": "Hz",
}  # fmt: skip
"""Figures of a run that are one number, and their units: a scene may set limits of these."""
OTHERS = ("motion", "tip_mean")
"""Figures that are a text, or several numbers."""
JOINED = {"tip_speed_max|axial_force_max": "largest", "axial_force_min": "smallest", "flow_speed": "last"}
"""How figures of pieces of a run make those of the whole; the others are of the motion at its end."""
MOVES = 1.0e-6
"""Share of the length that the nodes of a hose whose tip rests must move for it to be told."""


def _between_ends(result: Any, length: float) -> dict[str, tuple[Any, str, str]]:
    """Figures of the node that moves most, where the tip is at rest: it may be held."""
    position = result["position"]
    moved = np.linalg.norm(position - at_start(result, "position"), axis=-1).max(axis=0)
    node = int(moved.argmax())
    if moved[node] <= MOVES * length:
        return {}
    offset = position[:, node] - position[:, node].mean(axis=0)
    along = offset @ np.linalg.svd(offset, full_matrices=False)[2][0]
    omega = first_mode(result["time"], along)
    return {
        "node": (node + 1, "", "tip at rest; node with the largest motion"),
        "node_amplitude": (0.5 * float(np.ptp(along)), "m", "its amplitude, half of peak to peak"),
        "node_frequency": (None if omega is None else omega / (2.0 * np.pi), "Hz", "its strongest frequency"),
    }


def headline(result: Any) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up; forces and the largest speed are of the whole run, the others of its end.

    Parameters
    ----------
    result : Result
        Of a hose. A frequency that there is not is None.
    """
    length = float(result["arc_length"][-1])
    cycle = limit_cycle(result["time"], result["tip"], result["tip_velocity"], length)
    (least, most), speed = extremes(result), np.linalg.norm(result["tip_velocity"], axis=1)
    note = f" ({cycle.note})" if cycle.note else ""
    flow = float(result["flow_speed"][-1]) if "flow_speed" in result else None
    figures: dict[str, tuple[Any, str, str]] = {
        "motion": (cycle.kind, "", f"type of motion of the tip at the end{note}"),
        "tip_amplitude": (cycle.amplitude, "m", "amplitude of the tip, half of peak to peak"),
        "frequency": (cycle.frequency if cycle.cycles else None, "Hz", "frequency"),
        "cycles": (cycle.cycles, "", "cycles evaluated"),
        "tip_speed_max": (float(speed.max()), "m/s", "largest speed of the tip"),
        "tip_mean": ([float(x) for x in cycle.mean], "m", "mean position of the tip, from the scene's origin"),
        "axial_force_max": (most, "N", "largest axial force"),
        "axial_force_min": (least, "N", "smallest axial force"),
        "flow_speed": (flow, "m/s", "flow speed at the end"),
    }
    figures |= _between_ends(result, length) if cycle.kind == "rest" else {}
    return {name: {"value": value, "unit": unit, "text": text} for name, (value, unit, text) in figures.items()}
