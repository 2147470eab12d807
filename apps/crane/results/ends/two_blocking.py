"""What has come up to its wheel where a step found no solution."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from crane.assembly.layout import AXES, Layout
from crane.geometry.quaternion import QUATERNION
from crane.groups.span import POINT, STATION, Spans
from tautline.integrators.state import WORST
from tautline.integrators.status import Status
from tautline.system.system import System

STOPPED = (Status.NOT_CONVERGED, Status.NO_LENGTH)
"""Ends of a run that may come of it."""
STEPS = 10.0
"""Within how many steps, or one frame, the rope that is left must be used up: what only vibrates takes far longer."""


def two_blocking(layout: Layout, system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of an end where a hook or block is about to meet a wheel; None where none is.

    The place is one in the full vectors, counted from -1 downwards.

    Rope that is far stretched has a node on the wheel before what hangs on it has come within the share of the radius
    that ends a run by itself: from there on no step has a solution. So less straight rope than the radius is left, it
    is about to be used up, and the step failed there and not elsewhere.

    Parameters
    ----------
    layout : Layout
    system : System
    state : State
        Of the last accepted step, with the unknown that was worst in the one that failed.
    status : Status
        How the run ended.
    """
    spans = next((group for group in system.groups if isinstance(group, Spans)), None)
    if status not in STOPPED or spans is None:
        return None
    worst = int(state.counters[WORST])
    failed = int(system.free[worst]) if worst >= 0 else -1 - worst
    q, v, axes = state.full_q, state.full_v, np.arange(AXES)
    between = {int(item.a): item for item in spans.items}
    for i in _approachable(layout):
        item = between.get(layout.station[layout.item[i]])
        if item is None or failed not in _places(layout, i):
            continue
        radii = [spans.wheels["radius"][wheel] if wheel != POINT else 0.0 for wheel in (item.wheel1, item.wheel2)]
        apart, rate = q[item.b + axes] - q[item.a + axes], v[item.b + axes] - v[item.a + axes]
        left = float(np.sqrt(max(0.0, apart @ apart - (radii[0] - radii[1]) ** 2)))
        # d(left)/dt = apart . rate / left
        if left < max(abs(radius) for radius in radii) and left * left <= -float(apart @ rate) * _horizon(layout):
            detail = f"{left:.3g} m of straight rope were left, and the step from there had no solution"
            return Status.TWO_BLOCKED, -1 - int(item.a), detail
    return None


def _approachable(layout: Layout) -> Iterator[int]:
    """Spans of the path whose ends may come together: one rides on a body that the other does not ride on."""
    rides = [getattr(item, "body", None) for item in layout.scene.path]
    return (i for i in range(len(rides) - 1) if rides[i] != rides[i + 1])


def _places(layout: Layout, i: int) -> set[int]:
    """Full degrees of freedom of a span: of its stations, of the bodies at its ends, and of their rims."""
    first, last = layout.spans[i]
    found = {place + k for place in layout.station[first : last + 1] for k in range(STATION)}
    for end in (i, i + 1):
        name = getattr(layout.scene.path[end], "body", None)
        if name is not None:
            found |= {layout.body[name] + k for k in range(AXES)}
            found |= {layout.turn[name] + k for k in range(QUATERNION)} if name in layout.turn else set()
        found |= {layout.rim[end]} if end in layout.rim else set()
    return found


def _horizon(layout: Layout) -> float:
    """Time that counts as about to be, s."""
    solver, interval = layout.scene.solver, float(layout.scene.output.interval)
    return interval if solver.step == "auto" else max(interval, STEPS * float(solver.step))
