"""Which element of a cable has lost its length, and how much longer it has to begin."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.cable.model.layout import Layout
from tautline.integrators.state import WORST
from tautline.integrators.status import Status


def empty_element(layout: Layout, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of a run that an element without length has stopped; None of any other.

    Parameters
    ----------
    layout : Layout
    state : State
        Of the last accepted step, with the place of the alarm: p of the first node of the element, counted from -1
        downwards.
    status : Status
        How the run ended.
    """
    worst = int(state.counters[WORST])
    if status is not Status.NO_LENGTH or worst >= 0:
        return None
    first, second = layout.lasts[layout.ends.T]
    beginning = np.flatnonzero(first == -1 - worst)
    if not beginning.size:
        return None
    # Of several that begin at the node it is the one with least left.
    left = state.full_q[second[beginning]] - state.full_q[first[beginning]]
    i = int(beginning[np.argmin(left)])
    element, begun = layout.scene.elements[i], float(layout.initial[second[i]] - layout.initial[first[i]])
    nodes = " and ".join(map(str, element.nodes))
    detail = (
        f"element {element.id} of line {element.line}, between nodes {nodes}, began with {begun:.6g} m of cable, and "
        "all of it has been drawn out"
    )
    return status, worst, detail
