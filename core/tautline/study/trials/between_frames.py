"""What the stored frames of a run do not show, seen in a run of the same scene with finer ones.

The largest and smallest figures of a run, and its limits, are those of its stored frames: what happens between two of
them is in none. The first of the runs by which the error of the steps is estimated stores several frames for each of
the run's own. What it comes to over all of them is held against what it comes to over those at the run's times: both
are of one run, so that its steps do not count.

Whether frames meet a narrow peak is chance where friction decides when it comes: those of this run may, and those of
the run that is judged may not. Where both differ at the same times, what frames so far apart miss is taken as the
median over all ways to take every so many of the finer ones, and no more than these pass the judged run by.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from tautline.results.assessment.bounds import judge
from tautline.results.assessment.rounding import without_rounding
from tautline.results.result import Result
from tautline.scene.solver import divided
from tautline.scene.values.printed import in_percent, quantity, rounded
from tautline.system.model import Model

FINER, ENOUGH = 10, 5
"""Frames that the other run stores for each of the run's own, at most, and how many are enough."""
ROOM = 20_000_000
"""Numbers, about, that all frames of the other run may hold in memory."""
SECONDS = 1.0e-3
"""Processor time that a further frame may take, s: ten times what most scenes need."""
TOLD = 0.01
"""Share of a figure from which it is told that it is passed between frames."""
NOTHING = 1.0e-4
"""Share of the largest figure of its unit below which a difference is none: a rise of 1e-7 m beside a way of 20 m."""
ALIKE = 0.1
"""Share by which two shares may differ and be of one cause: a tension, and the force on a sheave that follows it."""
MOST = 3
"""Figures that a warning names."""
SAME_TIME = 1.0e-9
"""Share of a run within which two frames are of one time."""
LARGEST, SMALLEST = "largest", "smallest"
WAYS = {LARGEST: 1.0, SMALLEST: -1.0}
"""Extremes over all frames, and which way such a figure moves with more of them."""
INTERVAL = "output.interval"

Figures = Mapping[str, Mapping[str, Any]]


class Missed(NamedTuple):
    """A figure of a run that frames between its own change.

    Attributes
    ----------
    name, text, unit : str
    shown, finer : float
        Its value of the run that is judged, and over all frames of the other one, SI.
    way : float
        1 of a largest value and -1 of a smallest.
    share : float
        By how much frames as far apart as those of the run miss it, over what they show; infinite where that is 0.
    """

    name: str
    text: str
    unit: str
    shown: float
    finer: float
    way: float
    share: float

    @property
    def said(self) -> str:
        """The figure and what finer frames make of it: ``the largest tension is about 12 % larger``."""
        what = f"the {re.split(', | [(]', self.text)[0]}"
        if self.share > 1.0:
            # Of what is far off, or of another sign, no share tells anything.
            finer, shown = (quantity(float(f"{x:.3g}"), self.unit) for x in (self.finer, self.shown))
            return f"{what} is about {finer}, and {shown} in the run"
        return f"{what} is about {in_percent(self.share)} {'larger' if self.way > 0.0 else 'smaller'}"


@dataclass(frozen=True)
class BetweenFrames:
    """What the frames of a run do not show.

    Attributes
    ----------
    interval, finer : float
        Between two frames of the run and of the other one, s.
    figures : tuple of Missed
        Those that are passed by more than `TOLD`, the worst first.
    limits : tuple of str
        Those that are kept in frames as far apart as the run's, and passed in the finer ones.
    """

    interval: float
    finer: float
    figures: tuple[Missed, ...] = ()
    limits: tuple[str, ...] = ()

    def warned(self, key: str = INTERVAL) -> str | None:
        """What a reader should know; None where the frames show it all. ``key`` is what sets the frames in the file."""
        if not (self.figures or self.limits):
            return None
        named = self._named()
        said = [f"the limit '{limit}' is passed" for limit in self.limits] + [one.said for one in named]
        if more := len(self.figures) - len(named):
            said.append(f"{more} more figure{'s differ' if more > 1 else ' differs'} by as much or less")
        apart, finer = _in_one_unit(self.interval, self.finer)
        cure = (
            f"Give a shorter {INTERVAL} and compare, such as {finer}"
            if key == INTERVAL
            else f"Store more frames{f' ({key})' if key else ''}, such as one every {finer}, and compare"
        )
        return (
            f"the stored frames, {apart} apart, miss what happens between them. In frames every {finer}, "
            f"{'; '.join(said)}. {cure}"
        )

    def _named(self) -> list[Missed]:
        """The figures that differ most, one for each cause."""
        named: list[Missed] = []
        for one in self.figures:
            if not any(one.share == x.share or one.share > (1.0 - ALIKE) * x.share for x in named):
                named.append(one)
        return named[:MOST]

    def record(self) -> dict[str, Any]:
        """The attribute of a result: what this holds, SI; the share of a figure that reads 0 is None."""
        kept = ("name", "text", "unit", "shown", "finer")
        figures = [
            {key: getattr(one, key) for key in kept} | {"share": one.share if math.isfinite(one.share) else None}
            for one in self.figures
        ]
        return {"interval": self.interval, "finer": self.finer, "figures": figures, "limits": list(self.limits)}


def _in_one_unit(interval: float, finer: float) -> tuple[str, str]:
    """Two intervals, s, with three digits in the unit of the first; the second is rounded up: it may be given so."""
    factor, unit = (1.0, "s") if interval >= 1.0 else (1e3, "ms")
    up = rounded(finer * factor, 3, up=True, within=SAME_TIME)
    return quantity(float(f"{interval * factor:.3g}"), unit), quantity(float(f"{up:.4g}"), unit)


def frames_for_each(model: Model, own: float, step: float, frames: int) -> int:
    """How many frames a run with steps of ``step``, s, is to store for each of so many of a run with steps of ``own``.

    It is a divisor of the steps in the interval, so that these are as long as they are anyway, and no frame is shorter
    than the steps of the run itself, which could not have it. It is 1 where there is none, or no room.
    """
    interval = float(model.solver.interval)
    most = min(int(interval / own * (1.0 + SAME_TIME)), room_for(model, frames))
    return divisor(round(interval / divided(interval, step)), most)


def room_for(model: Model, frames: int) -> int:
    """How many frames there is room for, for each of so many."""
    return int(ROOM / ((model.system.q.size * 4 + model.own + 1) * max(frames, 1)))


def divisor(steps: int, most: int = FINER) -> int:
    """The largest divisor of a number of steps that is no more than ``most`` and `FINER`."""
    return max((count for count in range(1, min(most, FINER) + 1) if steps % count == 0), default=1)


def well_divided(steps: int) -> int:
    """The number of steps next to one that can be divided among enough frames: 12 of 13; few steps stay as they are."""
    if steps <= FINER:
        return steps
    near = (count for away in range(steps) for count in (steps - away, steps + away))
    return next(count for count in near if divisor(count) >= ENOUGH)


def at_times(result: Result, time: np.ndarray) -> Result:
    """A run with those of its frames that are at some times (m,), s."""
    return result.of_frames(_places(result, time))


def _places(result: Result, time: np.ndarray) -> np.ndarray:
    """Numbers of the frames that are at some times (m,), s."""
    near = SAME_TIME * float(time[-1])
    place = np.minimum(np.searchsorted(result.time, time - near), len(result.time) - 1)
    found = place[np.abs(result.time[place] - time) <= 2.0 * near]
    return found[np.diff(found, prepend=-1) > 0]


def between_frames(model: Model, judged: Result, fine: Result) -> BetweenFrames:
    """Tell what the frames of a run do not show by another run with finer ones.

    Parameters
    ----------
    model : Model
        Of the scene, with its limits.
    judged, fine : Result
        The run, and the other one, which has frames at the run's times and between them.
    """
    places = _places(fine, judged.time)
    # A run that was gone on with may have had other frames before: those of the scene are held against finer ones.
    # Not `np.median`, nor `np.unique` below, which load all of masked arrays to ask whether these are.
    usual = np.sort(np.diff(fine.time))[(fine.time.size - 1) // 2]
    interval, finer = float(model.solver.interval), float(f"{usual:.9g}")
    seen, shown = _figures(model, fine), _figures(model, judged)
    figures = _missed(model, fine, places, seen, shown)
    limits = _broken(model, judged, shown, fine, seen, places)
    return BetweenFrames(interval, finer, tuple(sorted(figures, key=lambda one: -one.share)), tuple(limits))


def _figures(model: Model, result: Result) -> Figures:
    step = float(result.attributes.get("step") or model.solver.step)
    return without_rounding(model.headline(result), result, step)


def way_of(model: Model, name: str) -> float:
    """Which way a figure moves with more frames: 1, -1, or 0 where it is no extreme."""
    if name == model.blow:
        return WAYS[LARGEST]
    rules = {**model.statistics.get("rules", {}), **model.extremes}
    return next((WAYS.get(rule, 0.0) for pattern, rule in rules.items() if re.fullmatch(pattern, name)), 0.0)


def _value(figures: Figures, name: str) -> float | None:
    value = figures.get(name, {}).get("value")
    return value if isinstance(value, float) and math.isfinite(value) else None


def _missed(model: Model, fine: Result, places: np.ndarray, seen: Figures, shown: Figures) -> list[Missed]:
    """Figures that frames so far apart miss, of the run with finer ones.

    ``places`` (m,) are its frames at the times of the run that is judged; ``seen`` and ``shown`` are the figures of all
    of its frames, and of that run.
    """
    others: list[Figures] = [_figures(model, fine.of_frames(places))]
    found: list[Missed] = []
    for name, figure in seen.items():
        way, whole = way_of(model, name), _value(seen, name)
        here, own = _value(others[0], name), _value(shown, name)
        if not way or whole is None or here is None or own is None:
            continue
        if max(_share(way, whole, here), _share(way, whole, own)) <= TOLD:
            continue
        chance = abs(here - own) > TOLD * abs(own)
        if chance and len(others) == 1:
            others += [_figures(model, fine.of_frames(frames)) for frames in _other_frames(fine, places)]
        values = [x for one in (others if chance else others[:1]) if (x := _value(one, name)) is not None]
        share = median(_share(way, whole, value) for value in values)
        if chance:
            share = min(share, _share(way, whole, own))
        if share > TOLD and abs(whole - here) + abs(whole - own) > NOTHING * _largest(seen, str(figure["unit"])):
            found.append(Missed(name, str(figure["text"]), str(figure["unit"]), own, whole, way, share))
    return found


def _share(way: float, whole: float, value: float) -> float:
    """By how much a figure passes its value in some frames, over that."""
    gain = max(way * (whole - value), 0.0)
    return gain / abs(value) if value else (math.inf if gain else 0.0)


def _largest(figures: Figures, unit: str) -> float:
    """Size of the largest figure of a unit."""
    sizes = (
        abs(x) for name, one in figures.items() if one["unit"] == unit and (x := _value(figures, name)) is not None
    )
    return max(sizes, default=0.0)


def _other_frames(fine: Result, places: np.ndarray) -> list[np.ndarray]:
    """All frames as far apart as some (m,) that lie between these, each time with the first and the last frame."""
    every, last = int(np.diff(places).max()), len(fine.time) - 1
    return [np.unique([0, *range(begin, last, every), last]) for begin in range(1, every)]


def _broken(model: Model, judged: Result, shown: Figures, fine: Result, seen: Figures, places: np.ndarray) -> list[str]:
    """Limits, in words, that the run keeps, and the other at the run's times, and that its finer frames pass."""
    broken = [record for record in _limits(model, fine, seen) if record["passed"] is False]
    if not broken:
        return []
    rough = fine.of_frames(places)
    kept = [
        {record["name"] for record in _limits(model, result, figures) if record["passed"]}
        for result, figures in ((judged, shown), (rough, _figures(model, rough)))
    ]
    return [str(one.get("text") or one["name"]) for one in broken if all(one["name"] in names for names in kept)]


def _limits(model: Model, result: Result, headline: Figures) -> list[dict[str, Any]]:
    of_application = [] if model.limits is None else model.limits(result)
    return [*of_application, *judge(model.bounds, result, headline)]
