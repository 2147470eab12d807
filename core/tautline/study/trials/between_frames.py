"""What the stored frames of a run do not show, seen in a run of the same scene with finer ones.

The largest and smallest figures of a run, and its limits, are those of its stored frames: what happens between two of
them is in none. The first of the runs by which the error of the steps is estimated stores several frames for each of
the run's own. Its figures and limits are held against those of the run where its steps are shorter: a narrow peak that
frames of the same times show in one run and not in another is chance. Where its steps are longer they are held against
those of its own frames at the run's times, so that the longer steps do not count.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tautline.results.assessment.bounds import judge
from tautline.results.assessment.rounding import without_rounding
from tautline.results.result import Result
from tautline.scene.values.printed import in_percent, quantity
from tautline.system.model import Model

FINER = 16
"""Frames that the other run stores for each of the run's own, at most."""
ROOM = 20_000_000
"""Numbers, about, that all frames of the other run may hold in memory."""
SECONDS = 1.0e-3
"""Processor time that a further frame may take, s: ten times what most scenes need."""
TOLD = 0.01
"""Share of a figure from which it is told that it is passed between frames."""
MOST = 3
"""Figures that a warning names."""
SAME_TIME = 1.0e-9
"""Share of a run within which two frames are of one time."""
LARGEST, SMALLEST = "largest", "smallest"
WAYS = {LARGEST: 1.0, SMALLEST: -1.0}
"""Rules by which figures of pieces of a run are joined, and which way such a figure moves with more frames."""


class Missed(NamedTuple):
    """A figure of a run that frames between its own change.

    Attributes
    ----------
    name, text, unit : str
    in_frames, finer : float
        Its value over the run's frames, or those at their times, and over all of the finer ones, SI.
    """

    name: str
    text: str
    unit: str
    in_frames: float
    finer: float

    @property
    def share(self) -> float:
        """By how much the run's frames miss it, over what they show."""
        gain = abs(self.finer - self.in_frames)
        return gain / abs(self.in_frames) if self.in_frames else float("inf")

    @property
    def said(self) -> str:
        """The figure and what finer frames make of it: ``the largest tension is 12 % larger``."""
        what = f"the {self.text.partition(' (')[0]}"
        if not self.in_frames:
            return f"{what} is {quantity(float(f'{self.finer:.3g}'), self.unit)} in place of 0"
        return f"{what} is {in_percent(self.share)} {'larger' if self.finer > self.in_frames else 'smaller'}"


@dataclass(frozen=True)
class BetweenFrames:
    """What the frames of a run do not show.

    Attributes
    ----------
    interval, finer, step : float
        Between two frames of the run and of the other one, and the steps of that, s.
    figures : tuple of Missed
        Those that are passed by more than `TOLD`, the worst first.
    limits : tuple of str
        Those that are kept in the run's frames and passed in the finer ones.
    """

    interval: float
    finer: float
    step: float
    figures: tuple[Missed, ...] = ()
    limits: tuple[str, ...] = ()

    def warned(self, key: str = "output.interval") -> str | None:
        """What a reader should know; None where the frames show it all. ``key`` is that of the interval in the file."""
        if not (self.figures or self.limits):
            return None
        said = [f"the limit of {limit} is passed" for limit in self.limits]
        said += [one.said for one in self.figures[:MOST]]
        if more := len(self.figures) - MOST if len(self.figures) > MOST else 0:
            said.append(f"{more} more figure{'s differ' if more > 1 else ' differs'} by more than {in_percent(TOLD)}")
        apart, finer, step = (quantity(float(f"{x:.3g}"), "s") for x in (self.interval, self.finer, self.step))
        return (
            f"the stored frames, {apart} apart, may miss what happens between them. In a run with frames every {finer} "
            f"and steps of {step}: {'; '.join(said)}. Give a shorter {key or 'interval of the output'} and compare, "
            f"such as {_rounded_up(self.finer)}"
        )

    def record(self) -> dict[str, Any]:
        """The attribute of a result: what this holds, SI; figures with their shares, None for those that read 0."""
        figures = [{**one._asdict(), "share": one.share if np.isfinite(one.share) else None} for one in self.figures]
        return {
            "interval": self.interval, "finer": self.finer, "step": self.step, "figures": figures,
            "limits": list(self.limits),
        }  # fmt: skip


def _rounded_up(interval: float) -> str:
    """An interval, s, in ms with two digits, no shorter than it is: ``7.2 ms``."""
    size = 10.0 ** (math.floor(math.log10(interval)) - 1)
    return quantity(float(f"{1e3 * size * math.ceil(interval / size * (1.0 - SAME_TIME)):.3g}"), "ms")


def frames_for_each(model: Model, own: float, step: float, frames: int) -> int:
    """How many frames a run with steps of ``step``, s, is to store for each of so many of a run with steps of ``own``.

    It is a divisor of the steps in the interval, so that the steps are those that they are anyway, and no frame is
    shorter than the steps of the run itself, which could not have it. It is 1 where there is none, or no room.
    """
    interval = float(model.solver.interval)
    steps = round(interval / step)
    width = model.system.q.size * 4 + model.own + 1
    most = min(FINER, int(interval / own * (1.0 + SAME_TIME)), int(ROOM / (width * max(frames, 1))))
    return max((count for count in range(1, most + 1) if steps % count == 0), default=1)


def at_times(result: Result, time: np.ndarray) -> Result:
    """A run with those of its frames that are at some times (m,), s."""
    near = SAME_TIME * float(time[-1])
    place = np.minimum(np.searchsorted(result.time, time - near), len(result.time) - 1)
    return result.of_frames(np.unique(place[np.abs(result.time[place] - time) <= 2.0 * near]))


def between_frames(model: Model, fine: Result, rough: Result) -> BetweenFrames:
    """Hold figures and limits of a run with fine frames against those of rough ones.

    Parameters
    ----------
    model : Model
        Of the scene, with its limits.
    fine, rough : Result
    """
    interval, finer = (float(np.median(np.diff(result.time))) for result in (rough, fine))
    step = float(fine.attributes["step"])
    seen, shown = (_figures(model, result) for result in (fine, rough))
    figures = sorted(_missed(model, seen, shown), key=lambda one: -one.share)
    kept, judged = _limits(model, rough, shown), _limits(model, fine, seen)
    passed = {record["name"]: record["passed"] for record in kept}
    broken = [record for record in judged if record["passed"] is False and passed.get(record["name"])]
    said = tuple(str(record.get("text") or record["name"]) for record in broken)
    return BetweenFrames(interval, finer, step, tuple(figures), said)


Figures = Mapping[str, Mapping[str, Any]]


def _figures(model: Model, result: Result) -> Figures:
    step = float(result.attributes.get("step") or model.solver.step)
    return without_rounding(model.headline(result), result, step)


def _limits(model: Model, result: Result, headline: Figures) -> list[dict[str, Any]]:
    of_application = [] if model.limits is None else model.limits(result)
    return [*of_application, *judge(model.bounds, result, headline)]


def _way(model: Model, name: str) -> float:
    """Which way a figure moves with more frames: 1, -1, or 0 where it is no extreme."""
    if name == model.blow:
        return WAYS[LARGEST]
    rules = model.statistics.get("rules", {})
    return next((WAYS.get(rule, 0.0) for pattern, rule in rules.items() if re.fullmatch(pattern, name)), 0.0)


def _missed(model: Model, seen: Figures, shown: Figures) -> list[Missed]:
    """Figures that rough frames miss; those of single places only where that of all places is not among them."""
    found: list[Missed] = []
    for name, figure in seen.items():
        value, before = figure["value"], shown.get(name, {}).get("value")
        way = _way(model, name)
        if not way or not isinstance(value, float) or not isinstance(before, float):
            continue
        if way * (value - before) > TOLD * abs(before) and not any(name.startswith(f"{x.name}_") for x in found):
            found.append(Missed(name, str(figure["text"]), str(figure["unit"]), before, value))
    return found
