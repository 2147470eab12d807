"""Brakes that were closed in a run and let their drums turn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crane.assembly.friction import closure_of
from crane.assembly.held_loads import CLOSED
from crane.scene.scene import CraneScene, Drum
from tautline.kernels.time_function import sample
from tautline.live.simulation import INPUTS_DRIVEN
from tautline.system.time_functions import FunctionRequest, compile_functions

SLIPS = 0.01
"""Share of the radius by which rope passes a drum that slips. What holds a drum gives way by a thousandth of that."""


def remarks(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on brakes that slipped while they were closed; none of brakes that were driven from outside.

    Parameters
    ----------
    result : Result
        With ``paid_out``; of one that holds statistics alone nothing is told.
    scene : CraneScene
    """
    if "paid_out" not in result or result.attributes.get(INPUTS_DRIVEN):
        return []
    time, paid_out = np.asarray(result.time, float), np.asarray(result["paid_out"], float)
    found = []
    for k, drum in enumerate(scene.drums):
        if drum.prescribed or drum.brake is None or drum.brake.torque == 0.0:
            continue
        told = slip_of(time, paid_out[:, k], _closed(drum, time), SLIPS * drum.radius)
        if told is not None:
            begin, passed = told
            way = "ran out" if passed > 0.0 else "was taken in"
            found.append(
                f"the brake of {drum.name} slipped while it was closed, from t = {begin:.3g} s: {abs(passed):.3g} m of "
                f"rope {way} while it stayed closed. Its heat and wear are not computed. If it is to hold, give "
                "brake.torque more than the load and the motor pull with"
            )
    return found


def _closed(drum: Drum, time: np.ndarray) -> np.ndarray:
    return sample(compile_functions([FunctionRequest(closure_of(drum))]), 0, time)[:, 0] >= CLOSED


def slip_of(time: np.ndarray, paid_out: np.ndarray, closed: np.ndarray, least: float) -> tuple[float, float] | None:
    """When a drum first turned in one closure of its brake, and how far in the longest slip of one.

    Parameters
    ----------
    time, paid_out : (m,) array
        s; m of rope since the start.
    closed : (m,) array of bool
    least : float
        Rope, m, that counts as slip.

    Returns
    -------
    tuple or None
        Time of the last frame before the first slip, s, and the rope that passed, m, positive out; None where the drum
        was held.
    """
    begin, most, start = math.nan, 0.0, -1
    for i in range(time.size):
        if not closed[i]:
            start = -1
            continue
        start = i if start < 0 else start
        passed = float(paid_out[i] - paid_out[start])
        if abs(passed) > least:
            begin = float(time[max(start, i - 1)]) if math.isnan(begin) else begin
            most = passed if abs(passed) > abs(most) else most
    return None if math.isnan(begin) else (begin, most)
