"""What has come up to its wheel where a step found no solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from crane.groups.span import POINT, Spans
from tautline.integrators.status import Status
from tautline.system.system import System

STOPPED = (Status.NOT_CONVERGED, Status.NO_LENGTH)
"""Ends of a run that may come of it."""


def two_blocking(system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of an end where a hook or block is about to meet a wheel; None where none is.

    The place is one in the full vectors, counted from -1 downwards.

    Rope that is far stretched has a node on the wheel before what hangs on it has come within the share of the radius
    that ends a run by itself: from there on no step has a solution. So less straight rope than the radius is left, and
    it gets less.

    Parameters
    ----------
    system : System
    state : State
        Of the last accepted step.
    status : Status
        How the run ended.
    """
    spans = next((group for group in system.groups if isinstance(group, Spans)), None)
    if status not in STOPPED or spans is None:
        return None
    q, v, axes = state.full_q, state.full_v, np.arange(3)
    for item in spans.items:
        radii = [spans.wheels["radius"][wheel] if wheel != POINT else 0.0 for wheel in (item.wheel1, item.wheel2)]
        apart, rate = q[item.b + axes] - q[item.a + axes], v[item.b + axes] - v[item.a + axes]
        left = float(np.sqrt(max(0.0, apart @ apart - (radii[0] - radii[1]) ** 2)))
        if left < max(abs(radius) for radius in radii) and float(apart @ rate) < 0.0:
            detail = f"{left:.3g} m of straight rope were left, and the step from there had no solution"
            return Status.TWO_BLOCKED, -1 - int(item.a), detail
    return None
