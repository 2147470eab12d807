"""An element of which next to all rope has come to lie on the wheel beside it, where a step found no solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from crane.assembly.layout import Layout
from crane.groups.span import MATERIAL, POINT, STRETCH, Spans
from tautline.integrators.status import Status
from tautline.system.system import System

STOPPED = (Status.NOT_CONVERGED, Status.INACCURATE, Status.NO_LENGTH)
"""Ends of a run that may come of it."""
FREE = 0.05
"""Share of an element's rope that does not lie on its wheels, below which it has none left."""


def wound_up(layout: Layout, system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of an end where the node of an element was wound onto a wheel; None of any other.

    The elements of a span keep their shares of its rope, and what a wheel takes up comes from the one beside it alone.

    Parameters
    ----------
    layout : Layout
    system : System
    state : State
        Of the last accepted step.
    status : Status
        How the run ended.
    """
    spans = next((group for group in system.groups if isinstance(group, Spans)), None)
    if status not in STOPPED or spans is None:
        return None
    rows, radius, q = spans.rows, spans.wheels["radius"], state.full_q
    psi1, psi2 = spans.turned.T
    # The attempt that failed was next to this state, and so was its stretch.
    stretch = np.where(np.isfinite(spans.found[:, STRETCH]), spans.found[:, STRETCH], 1.0)
    size = (q[rows.b + MATERIAL] - q[rows.a + MATERIAL]) * np.maximum(stretch, 1.0)
    rho1, rho2 = (np.where(wheel != POINT, radius[wheel], 0.0) for wheel in (rows.wheel1, rows.wheel2))
    laid = rho1 * psi1 - rho2 * psi2
    # A span of one element ends where the path does, and is another matter.
    inner = (rows.wheel1 == POINT) != (rows.wheel2 == POINT)
    gone = np.flatnonzero(inner & (size - laid < FREE * size))
    if not gone.size:
        return None
    n = int(gone[np.argmin((size - laid)[gone])])
    side, other = (int(rows.wheel1[n]), rho1 * psi1) if rows.wheel1[n] != POINT else (int(rows.wheel2[n]), -rho2 * psi2)
    name = layout.scene.path[side].name
    detail = (
        f"the element beside {name} has {size[n]:.3g} m of rope, and {other[n]:.3g} m of it have come to lie on "
        "that wheel since the start. Take fewer elements for that span (`mesh.elements_per_span`)"
    )
    return Status.NO_LENGTH, -1 - int(rows.a[n]), detail
