"""A span whose rope is used up by what turns about its wheels, where a step found no solution.

Either next to all rope of an element has come to lie on the wheel beside it; or so much has been taken off a drum that
none is left from its mark of the start on. There Lambda = l + rho1 psi1 - rho2 psi2 comes to 0 while the line is long.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from crane.assembly.layout import Layout
from crane.groups.span import MATERIAL, POINT, STRAIGHT, STRETCH, Spans
from tautline.integrators.status import Status
from tautline.system.system import System

STOPPED = (Status.NOT_CONVERGED, Status.INACCURATE, Status.NO_LENGTH)
"""Ends of a run that may come of it."""
FREE = 0.05
"""Share of an element's rope that does not lie on its wheels, or of its line that is rope, below which none is left."""


class _Turned(NamedTuple):
    """Elements (n,) in the last accepted step: ``size`` of their rope, ``laid`` of it on wheels, ``straight`` l, m; and
    ``since`` (n, 2), what has come to lie on either wheel since the start, m, negative where it came off."""

    size: np.ndarray
    laid: np.ndarray
    straight: np.ndarray
    since: np.ndarray


def wound_up(layout: Layout, system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of an end where turning has used up an element's rope; None of any other.

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
    found, rows = _turned(layout, spans, state.full_q), spans.rows
    # A span of one element that is wound up ends where the path does, and is another matter.
    inner = (rows.wheel1 == POINT) != (rows.wheel2 == POINT)
    left = (found.size - found.laid) / found.size
    covered = inner & (left < FREE)
    unwound = (found.since.sum(axis=1) < 0.0) & (found.straight + found.laid < FREE * found.straight)
    gone = np.flatnonzero(covered | unwound)
    if not gone.size:
        return None
    n = int(gone[np.argmin(left[gone])])
    k = next(k for k, (first, last) in enumerate(layout.spans) if first <= n < last)
    first, last = layout.spans[k]
    ends = np.array([found.since[first, 0], found.since[last - 1, 1]])
    detail = _unwound(layout, k, ends) if -ends.min() > ends.max() else _covered(layout, spans, n, found)
    return Status.NO_LENGTH, -1 - int(rows.a[n]), detail


def _turned(layout: Layout, spans: Spans, q: np.ndarray) -> _Turned:
    rows, radius, path = spans.rows, spans.wheels["radius"], layout.path
    # The attempt that failed was next to this state, and so was its stretch.
    stretch = np.where(np.isfinite(spans.found[:, STRETCH]), spans.found[:, STRETCH], 1.0)
    size = (q[rows.b + MATERIAL] - q[rows.a + MATERIAL]) * np.maximum(stretch, 1.0)
    rho = np.stack([np.where(w != POINT, radius[w], 0.0) for w in (rows.wheel1, rows.wheel2)], axis=1) * [1.0, -1.0]
    begin = np.zeros_like(spans.turned)
    for k, (first, last) in enumerate(layout.spans):
        begin[first, 0], begin[last - 1, 1] = path.after[k], path.before[k + 1]
    laid = (rho * spans.turned).sum(axis=1)
    return _Turned(size, laid, spans.found[:, STRAIGHT], rho * (spans.turned - begin))


def _covered(layout: Layout, spans: Spans, n: int, found: _Turned) -> str:
    """Of an element of which the rope lies on its wheel."""
    row = spans.rows[n]
    side = 0 if row.wheel1 != POINT else 1
    name = layout.scene.path[int(row.wheel1 if side == 0 else row.wheel2)].name
    return (
        f"the element beside {name} has {found.size[n]:.3g} m of rope, and next to all of it lies on that wheel: "
        f"{found.since[n, side]:.3g} m have come there since the start. Take fewer elements for that span "
        "(`mesh.elements_per_span`)"
    )


def _unwound(layout: Layout, k: int, ends: np.ndarray) -> str:
    """Of a span that was unwound from the wheel at one of its ends."""
    one, two = layout.scene.path[k], layout.scene.path[k + 1]
    wheel, other = (one, two) if ends[0] < ends[1] else (two, one)
    return (
        f"turning has taken {-ends.min():.3g} m of rope off {wheel.name} since the start. That is next to all rope "
        f"that lay between {wheel.name} and {other.name} then, and the equations do not draw on the drum for more. "
        "Fewer elements do not help. End earlier, turn less, or draw the scene as it is after a part of the turning"
    )
