"""What a quick look leaves out, in words: nobody should take it for the whole."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from tautline.kernels.groups import may_switch
from tautline.kernels.time_function import TimeFunctions
from tautline.study.trials.trial import Setting, Subject
from tautline.system.model import Model

MOST_SHOWN = 6
"""Times of events that are printed."""
MOST_EVENTS = 50
"""Breaks of one function that are events; a table or an integral of more is a curve."""


def of_study(subject: Subject, named_steps: bool) -> tuple[str, ...]:
    """What a quick study does not try: time, every other step of the usual grid, and repetitions."""
    steps = [] if named_steps else ["every other step of the usual grid is left out"]
    return (*of_time(subject), *steps, "each setting is run once: its time is no median")


def of_time(subject: Subject) -> list[str]:
    """Which part of a scene's time is looked at, and what comes later; empty where all is."""
    if subject.whole is None or subject.end is None or subject.end >= subject.whole:
        return []
    return [f"the first {subject.end:.4g} s of {subject.whole:.4g} s", *_later(subject.model(Setting()), subject.end)]


def unseen(subject: Subject) -> str:
    """Which part of a scene's time is not looked at, and what is known to happen there; empty where all is."""
    found = of_time(subject)
    return f"only {'; '.join(found)}" if found else ""


def _later(model: Model, end: float) -> list[str]:
    """What a scene prescribes or may do after the end of a look, s."""
    functions = model.system.functions
    found = []
    times = sorted({float(t) for t in _breaks(functions) if t >= end})
    if times:
        shown = ", ".join(f"{t:.4g}" for t in times[:MOST_SHOWN]) + (" ..." if len(times) > MOST_SHOWN else "")
        found.append(f"what is prescribed changes at {shown} s, which was not seen")
    slow = [2.0 * math.pi / abs(w) for _, w, *_ in functions.waves if w != 0.0 and abs(w) * end < 2.0 * math.pi]
    if slow:
        found.append(f"a prescribed oscillation with a period of {max(slow):.4g} s was seen at its beginning only")
    if any(c != 0.0 for _, _, c, *_ in functions.waves):
        found.append("a prescribed oscillation changes its frequency later, which was not seen")
    if may_switch(model.system.groups):
        found.append("contacts and friction that change after that were not seen")
    return found


def _breaks(functions: TimeFunctions) -> Iterator[float]:
    """Times at which functions go over from one piece to the next; pieces of a numerical integral are no events."""
    for first, last in itertools.pairwise(functions.break_from):
        if last - first <= MOST_EVENTS:
            yield from functions.breaks[first:last]
