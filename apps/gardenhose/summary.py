"""The few figures that sum up the run of a hose."""

from __future__ import annotations

from typing import Any

import numpy as np

from gardenhose.limit_cycle import limit_cycle


def headline(result: Any) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up; forces and the largest speed are of the whole run, the others of its end.

    Parameters
    ----------
    result : Result
        Of a hose. A frequency that there is not is None.
    """
    cycle = limit_cycle(result["time"], result["tip"], result["tip_velocity"], float(result["arc_length"][-1]))
    force, speed = result["axial_force"], np.linalg.norm(result["tip_velocity"], axis=1)
    note = f" ({cycle.note})" if cycle.note else ""
    flow = float(result["flow_speed"][-1]) if "flow_speed" in result else None
    figures: dict[str, tuple[Any, str, str]] = {
        "motion": (cycle.kind, "", f"motion of the tip at the end{note}"),
        "tip_amplitude": (cycle.amplitude, "m", "amplitude of the tip, half of peak to peak"),
        "frequency": (cycle.frequency if cycle.cycles else None, "Hz", "frequency"),
        "cycles": (cycle.cycles, "", "whole cycles that these are taken from"),
        "tip_speed_max": (float(speed.max()), "m/s", "largest speed of the tip"),
        "tip_mean": ([float(x) for x in cycle.mean], "m", "mean position of the tip"),
        "axial_force_max": (float(force.max()), "N", "largest axial force"),
        "axial_force_min": (float(force.min()), "N", "smallest axial force"),
        "flow_speed": (flow, "m/s", "flow speed at the end"),
    }
    return {name: {"value": value, "unit": unit, "text": text} for name, (value, unit, text) in figures.items()}
