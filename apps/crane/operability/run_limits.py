"""Limits that every run is judged by, such as the breaking load: in which storms they failed, and what is told of it.

The judgement is that of a run (`crane.results.limits`), which a sweep collects storm by storm. They are no limits that
were asked for: an allowable height does not count them, and that is said wherever it reaches into such a sea.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from crane.operability.allowable import Table, of_all
from crane.operability.conditions import Condition
from crane.operability.criteria import Criterion
from tautline.results.assessment.limits import AT_LEAST, AT_MOST
from tautline.scene.values.printed import shown
from tautline.sweeps.verbs import OF_RUN_LIMIT

MOST_SHOWN, EXACT = 5, 12
"""Sea states that a warning names, and digits of a limit that is to be typed: rounded it might be a laxer one."""
BREAKING = "breaking_load"
FIGURES = {BREAKING: "max_tension", "sidelead": "max_sidelead"}
"""What to write as a limit where the limit of a run is to count: of limits that are one number for all places."""
SNAP, SAFETY = "max_snap", "safety_factor"


class RunLimit(NamedTuple):
    """A limit that every run is judged by."""

    name: str
    text: str
    unit: str
    sense: str

    @property
    def columns(self) -> tuple[str, str, str]:
        """Names of what a sweep collects of it: whether it failed, the worst value, and what was left to the limit."""
        failed, value, margin = (f"{OF_RUN_LIMIT}{self.name}.{word}" for word in ("failed", "value", "margin"))
        return failed, value, margin


class Failed(NamedTuple):
    """What a limit of a run came to in the storms of all sea states.

    Attributes
    ----------
    limit : RunLimit
    storms : (headings, periods, heights) array of int
        In how many storms of each sea state it failed.
    worst, bound : float
        The value of the storm that is furthest beyond it, and what it should have been at most, or at least.
    """

    limit: RunLimit
    storms: np.ndarray
    worst: float
    bound: float


def of_run(records: Iterable[Mapping[str, Any]]) -> list[RunLimit]:
    """The limits of a run, by its records: neither those of the scene, nor what is the same at all times.

    What does not change with time, such as the diameter of a sheave, does not hang on the sea. The scene's warnings
    tell it.
    """
    return [
        RunLimit(one["name"], one["text"], one["unit"], one["sense"])
        for one in records
        if "output" not in one and one["time"] is not None
    ]


def failures(
    outcome: Any, table: Table, conditions: Sequence[Condition], limits: Sequence[RunLimit]
) -> list[Failed]:  # fmt: skip
    """The limits that failed in any storm that came to its end, of the outcome of a sweep."""
    data, found = outcome.data, []
    for limit in limits:
        broken = outcome.unsatisfied.marked(limit.name, len(outcome.cases))
        if not broken.any():
            continue
        _, value, margin = (np.asarray(data[name].values, float) for name in limit.columns)
        worst = int(np.flatnonzero(broken)[np.argmin(margin[broken])])
        way = 1.0 if limit.sense == AT_MOST else -1.0
        bound = float(value[worst] + way * margin[worst])
        found.append(Failed(limit, _by_state(broken, table, conditions), float(value[worst]), bound))
    return found


def _by_state(broken: np.ndarray, table: Table, conditions: Sequence[Condition]) -> np.ndarray:
    """How many of the storms of each sea state are marked."""
    counts = np.zeros(table.status.shape, int)
    size = len(table.seeds)
    for k, one in enumerate(one for one in conditions if one.physical):
        at = (
            table.headings.index(one.heading), int(np.searchsorted(table.periods, one.period)),
            int(np.searchsorted(table.heights, one.height)),
        )  # fmt: skip
        counts[at] = broken[k * size : (k + 1) * size].sum()
    return counts


def failed_from(failed: Sequence[Failed], table: Table) -> np.ndarray:
    """Lowest height, m, (headings, periods), of which a storm fails a limit of a run; NaN where none does."""
    if not failed:
        return np.full((len(table.headings), len(table.periods)), math.nan)
    storms = sum(one.storms for one in failed)
    lowest = np.where(np.asarray(storms) > 0, table.heights, np.inf).min(axis=-1)
    return np.where(np.isfinite(lowest), lowest, math.nan)


def within(height: float, lowest: float) -> bool:
    """Whether an allowable height reaches the lowest one of which a storm fails a limit of a run."""
    return bool(height > 0.0 and lowest <= height * (1.0 + 1e-9))


def words_of(failed: Sequence[Failed], at: tuple[int, ...]) -> str:
    """The limits that failed in a sea state, each with its number of storms: ``breaking_load (3), strain (1)``."""
    return ", ".join(f"{one.limit.name} ({one.storms[at]})" for one in failed if one.storms[at])


def state_said(table: Table, at: tuple[int, ...], system: str = "si") -> str:
    """A sea state in words."""
    heading = table.headings[at[0]]
    of = "" if heading is None else f", heading {math.degrees(heading):.6g} deg"
    return f"Hs {shown(float(table.heights[at[2]]), 'm', system)}, Tp {table.periods[at[1]]:g} s{of}"


def counted(failed: Sequence[Failed], share: np.ndarray) -> bool:
    """Whether fatigue counts storms that fail a limit of a run, by the share of time of each sea state."""
    return any(bool((share[one.storms > 0] > 0.0).any()) for one in failed)


def warnings_of(failed: Sequence[Failed], table: Table, share: np.ndarray | None, system: str) -> list[str]:
    """A warning for each limit of a run that storms failed: by how much, in which sea states, and what it means.

    ``share`` (headings, periods, heights) is that of time by which fatigue counts; None where it is not asked for.
    """
    reached = _allowed(table)
    return [_warned(one, table, reached, share, system) for one in failed]


def _warned(one: Failed, table: Table, reached: np.ndarray, share: np.ndarray | None, system: str) -> str:
    limit, size = one.limit, len(table.seeds)
    places = [at for at in np.ndindex(*one.storms.shape) if one.storms[at]]
    # Those that are allowed are the dangerous ones: first they.
    places.sort(key=lambda at: not reached[at])
    named = "; ".join(f"{state_said(table, at, system)} ({one.storms[at]} of {size})" for at in places[:MOST_SHOWN])
    more = len(places) - MOST_SHOWN
    also = f"; and {more} more, see operability.csv" if more > 0 else ""
    worst, bound = (shown(value, limit.unit, system) for value in (one.worst, one.bound))
    text = (
        f"storms fail a limit that every run is judged by ({limit.text}): {worst}, must be {limit.sense} {bound}. "
        f"{_so_many(len(places), 'sea state has', 'sea states have')} such storms: {named}{also}. "
    )
    if table.allowable.size:
        allowed = sum(bool(reached[at]) for at in places)
        text += _allowed_said(allowed, len(places))
        text += _cure(limit, shown(one.bound, limit.unit, system, EXACT)) if allowed else ""
    if share is not None:
        text += _fatigue_said(sum(bool(share[at] > 0.0) for at in places), len(places))
    return text.strip()


def _so_many(count: int, one: str, more: str) -> str:
    return f"{count} {one if count == 1 else more}"


def _allowed_said(allowed: int, of: int) -> str:
    """Whether the limits that were given allow sea states whose storms fail one of a run."""
    if not allowed:
        none = "This sea state is not" if of == 1 else "None of these sea states is"
        return f"{none} allowed by the limits that are given. "
    some = "it" if of == 1 else f"{allowed} of these"
    return f"The limits that are given allow {some}: allowable heights do not count this one. "


def _fatigue_said(occur: int, of: int) -> str:
    """That fatigue counts storms in which the rope may part, of the sea states that occur in the scatter diagram."""
    if not occur:
        return ""
    those = "these storms" if occur == of else f"these storms in the {_so_many(occur, 'sea state', 'sea states')}"
    which = "" if occur == of else f" that {'occurs' if occur == 1 else 'occur'} in the scatter diagram"
    return f"Fatigue counts the cycles of {those}{which} as if the rope bore them. "


def _cure(limit: RunLimit, bound: str) -> str:
    name, sign = FIGURES.get(limit.name), "<=" if limit.sense == AT_MOST else ">="
    return f"Give also --limit '{name} {sign} {bound}'. " if name else ""


def _allowed(table: Table) -> np.ndarray:
    """Which sea states (headings, periods, heights) all limits allow that were given; none where none was."""
    found = np.zeros(table.status.shape, bool)
    if not table.allowable.size:
        return found
    for (i, j), one in np.ndenumerate(of_all(table)):
        found[i, j] = [within(one.height, float(height)) for height in table.heights]
    return found


def above_strength(criteria: Sequence[Criterion], scene: Any) -> list[str]:
    """Limits on a tension that a rope does not bear, by its breaking load: they allow seas in which it parts."""
    load = scene.rope.breaking_load
    if load is None:
        return []
    found, system = [], scene.units
    for one in criteria:
        tension = one.unit == "N" and ("tension" in one.name or one.name == SNAP)
        if tension and one.sense == AT_MOST and one.limit > load * (1.0 + 1e-9):
            above = f"is above the breaking load of the rope, {shown(load, 'N', system)}"
        elif one.name == SAFETY and one.sense == AT_LEAST and one.limit < 1.0 - 1e-9:
            above = "is a safety factor below 1: a tension above the breaking load of the rope"
        else:
            continue
        found.append(f"limit '{one.text}' {above}. It allows seas in which the rope parts")
    return found
