"""Whether a step failed because it was to take all material out of an element: asked once, where a run has stopped.

The loop asks the groups' alarms of states that it has accepted. Next to no length left, an element's forces grow beyond
all numbers, and no step to zero or past it has a solution that could be accepted. So the alarm is asked again where the
last attempt at a step was to end, or little later. The whole step tells nothing: its halves, quarters, ... failed, too.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from tautline.integrators.state import WORST, State, stand_at
from tautline.integrators.status import Status
from tautline.integrators.stepping import stepping_with
from tautline.kernels import groups as over
from tautline.kernels.groups import EMPTY, known_of, link
from tautline.kernels.jit import entry
from tautline.system.system import System

FAILURES = Status.NOT_CONVERGED, Status.NOT_FINITE, Status.SINGULAR, Status.UNSTABLE, Status.INACCURATE
"""Ends of a run behind which an element without length may stand."""
NEXT_TO_EMPTY = 1e-3
"""Share of the time since the start within which what is next to empty is empty. Forces grow there, and a step may be
given up many of its finest parts before the end: drawn out evenly, an element has a thousandth of its material left."""


PARTS = 16.0
"""Of a step, no more than one of them: late in a run that share of the time would be all of it."""


@entry
def _ask(groups, dofs, functions, state, t, alarm):
    stand_at(dofs, functions, state, t)
    over.alarm(groups, t, state.full_q, alarm)


def status_of_failure(method: Any, system: System, state: State, status: Status, time: float, step: float) -> Status:
    """The status of a run that stopped; NO_LENGTH where its last attempt was to leave an element without material.

    The place of the element is then written where the loop writes the place of an alarm. What moves freely is looked at
    where it stands and where its velocity carries it: an element is only said to be empty where both say so. An element
    that a free node leaves as fast as a winch draws on it is not; nor is one next to a motion that has overflowed.

    Parameters
    ----------
    method : NamedTuple
        Scratch of the method.
    system : System
    state : State
        As it was accepted last.
    status : Status
        What the loop reports.
    time : float
        Of the state, s.
    step : float
        Length of a step before it is halved, s.
    """
    if status not in FAILURES:
        return status
    place = _emptied(system, state, time, _ahead(method, time, step))
    if place is None:
        return status
    state.counters[WORST] = -1 - place
    return Status.NO_LENGTH


def _ahead(method: Any, time: float, step: float) -> float:
    """How far beyond a time, s, a step that failed was to go, s: at least as far as its shortest part."""
    if stepping_with(method).explicit:
        return step
    return max(step / 2.0**method.max_halvings, min(step / PARTS, NEXT_TO_EMPTY * time))


def _emptied(system: System, state: State, time: float, step: float) -> int | None:
    """Full place of an element that is left without material at the end of a step, s, if there is one."""
    there = [copy.deepcopy(state) for _ in range(2)]
    there[1].q[:] += step * state.v
    try:
        for group in system.groups:
            if "alarm" in known_of(group).hooks:
                own = copy.deepcopy(group)  # what is linked is referred to, and has to live on
                linked = link((own,), "alarm")
                places = {_place_of_alarm(linked, system, one, time + step) for one in there}
                if len(places) == 1 and (place := places.pop()) is not None:
                    return place
    finally:
        system.functions.frames.time[0] = np.nan  # where frames stand is found anew by whoever asks next
    return None


def _place_of_alarm(linked: Any, system: System, state: State, time: float) -> int | None:
    """Full place of what has no material at a state, of a linked group."""
    alarm = np.zeros(2, np.int64)
    _ask(linked, system.dofs, system.functions, state, time, alarm)
    return int(alarm[1]) if alarm[0] == EMPTY else None
