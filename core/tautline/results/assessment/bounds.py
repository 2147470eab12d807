"""A run judged by the limits of its scene: what each bound came to, when and where, and how long it was passed.

The records stand beside those of `tautline.results.assessment.limits`, with the same keys and more: ``output``;
``variable``, that of the result which a figure draws the bound with; ``margin``, what was left to the bound, negative
where it was passed;
``for`` s; ``since`` s, ``longest`` s and ``exceeded`` s, when the longest stretch beyond the bound began, how long it
was, and how long all of them were, at that place; ``until`` s, the last frame that was looked at; ``note``, why
something could not be judged, and of a figure what it is, with its place and time. ``passed`` is None of what could not
be judged: what is not known is neither kept nor broken.

Between two frames a value is taken as linear, for durations alone. What happens between two frames is not seen here;
`tautline.study.trials.between_frames` looks there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tautline.results.assessment.limits import AT_MOST

ROUNDED = 1.0e-9
"""Share of a bound by which rounding may pass it."""
HALVINGS = 60
"""Of the interval in which the value is looked for that was held for so long."""

NOT_IN_STATISTICS = ". Some figures are not part of statistics: keep frames (`output: {keep: frames}`)"
NO_FRAME_COUNTS = "no frame counts: the run ended before output.begin"
NOT_FOR_HOW_LONG = "Statistics do not tell for how long: keep frames (`output: {keep: frames}`)"

Frames = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Bound:
    """A limit of a scene, in SI.

    Attributes
    ----------
    name : str
    output : str
        As the scene names it: an output, one of its numbers, or a figure of the whole run.
    sense : str
        `AT_MOST` or `AT_LEAST`.
    limit : float
    unit : str
    lasting : float
        How long it has to be passed without a break to count, s.
    series : callable or None
        Variables of m frames -> (m, n) values at its n places; None of a figure.
    places : tuple of str
        Names of its places; empty texts where it is one number.
    source : str
        Variable of which it is the largest or smallest, and whose places `places` then are; empty else.
    variable : str
        Variable of the result whose values it bounds, for figures; empty where there is none.
    absent : float or None
        Of a figure: what a run without it has, such as no slack; None where nothing is known then.
    """

    name: str
    output: str
    sense: str
    limit: float
    unit: str
    lasting: float = 0.0
    series: Callable[[Frames], np.ndarray] | None = None
    places: tuple[str, ...] = ("",)
    source: str = ""
    variable: str = ""
    absent: float | None = None

    @property
    def of_frames(self) -> bool:
        """Whether it is looked at in every frame, and no figure of the whole run."""
        return self.series is not None

    @property
    def text(self) -> str:
        """What it is, in words."""
        return self.output if self.name.startswith(f"{self.output} ") else f"{self.name} ({self.output})"


def judge(bounds: Sequence[Bound], result: Any, headline: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Records of all bounds.

    Parameters
    ----------
    bounds : sequence of Bound
    result : Result
        Finished or not: it is judged by the frames that it has.
    headline : mapping
        Its figures, name -> {value, unit, text}.
    """
    if not bounds:
        return []
    frames = _Read(result)
    time = np.asarray(result.time, float)
    return [
        _of_frames(bound, frames, time) if bound.of_frames else _of_figure(bound, headline.get(bound.output), time)
        for bound in bounds
    ]


class _Read(Mapping[str, np.ndarray]):
    """Variables of a result; each is read once."""

    def __init__(self, result: Any) -> None:
        self._result = result
        self._known: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._known:
            self._known[name] = np.asarray(self._result[name])
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._result.variables)

    def __len__(self) -> int:
        return len(self._result.variables)


def _record(bound: Bound, times: np.ndarray, /, **found: Any) -> dict[str, Any]:
    nothing: dict[str, Any] = {
        "value": None, "passed": None, "time": None, "place": "", "margin": None, "since": None, "longest": None,
        "exceeded": None, "note": "",
    }  # fmt: skip
    about = {
        "name": bound.name, "text": bound.text, "unit": bound.unit, "sense": bound.sense, "limit": bound.limit,
        "output": bound.output, "variable": bound.variable, "for": bound.lasting,
        "until": float(times[-1]) if times.size else None,
    }  # fmt: skip
    return about | nothing | found


def _of_figure(bound: Bound, figure: Mapping[str, Any] | None, time: np.ndarray, why: str = "") -> dict[str, Any]:
    """The record of a figure of the whole run; `why` there may be none."""
    value = figure.get("value") if figure is not None else bound.absent
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
        return _record(bound, time, note=f"this run has no {bound.output}{why}")
    way = 1.0 if bound.sense == AT_MOST else -1.0
    margin = way * (bound.limit - float(value))
    return _record(
        bound, time, value=float(value), margin=margin, note=str((figure or {}).get("text") or ""),
        passed=bool(margin >= -ROUNDED * max(abs(bound.limit), abs(value))),
    )  # fmt: skip


def _of_frames(bound: Bound, frames: Frames, time: np.ndarray) -> dict[str, Any]:
    """The record of an output, at the place and the time that is worst."""
    if not time.size:
        return _record(bound, time, note="no frame was stored")
    values = _values(bound, frames, time)
    if isinstance(values, str):
        return _record(bound, time, note=values)
    way = 1.0 if bound.sense == AT_MOST else -1.0
    known = np.isfinite(values)
    if not known.any():
        return _record(bound, time, note=f"{bound.output} is not a number in any frame")
    # Upwards is towards the bound and beyond it, whichever side that is.
    up, limit = np.where(known, way * values, -np.inf), way * bound.limit
    edge = limit + ROUNDED * max(abs(bound.limit), float(np.abs(values[known]).max()))
    place, value, at = worst(time, up, bound.lasting)
    begin, longest, exceeded = stretches(time, up[:, place], edge)
    span, missing = float(time[-1] - time[0]), int((~known.all(axis=1)).sum())
    passed: bool | None = bool(value <= edge)
    note = ""
    if bound.lasting > span and float(up.max()) > edge:
        passed, note = None, f"it is passed, and {span:.4g} s are too short to tell whether for {bound.lasting:g} s"
    elif passed and missing:
        passed, note = None, _missing(bound, missing, time.size)
    return _record(
        bound, time, value=way * value, margin=limit - value, passed=passed, note=note, time=float(time[at]),
        place=_place(bound, frames, place, at, way * float(up[at, place])), since=begin, longest=longest,
        exceeded=exceeded,
    )  # fmt: skip


def _values(bound: Bound, frames: Frames, time: np.ndarray) -> np.ndarray | str:
    """Values of an output, (m, n) at its n places in m frames, or why there are none."""
    assert bound.series is not None
    try:
        values = np.asarray(bound.series(frames), float).reshape(time.size, -1)
    except IndexError:
        # How many places there are, an application need not say before it runs.
        return f"there is no {bound.output}"
    return values if values.shape[1] else f"{bound.output} has no places in this scene"


def _missing(bound: Bound, missing: int, frames: int) -> str:
    return f"{bound.output} is not a number in {missing} of {frames} frames"


def _place(bound: Bound, frames: Frames, place: int, at: int, value: float) -> str:
    """Name of the place of a value: of an extreme that where the variable has it."""
    if bound.source:
        place = int(np.argmin(np.abs(np.ravel(frames[bound.source][at]) - value)))
    return bound.places[place] if place < len(bound.places) else f"number {place}"


class Tally:
    """What one bound comes to over frames that are given up when they were looked at.

    It is that of all frames, in memory that does not grow with them. How long a value was beyond the bound is not
    known: a bound that has to be passed for some time is not judged where it was passed at all.

    Parameters
    ----------
    bound : Bound
    """

    def __init__(self, bound: Bound) -> None:
        self.bound = bound
        self._frames = self._missing = 0
        self._until: np.ndarray = np.empty(0)
        self._worst, self._size, self._at, self._where, self._none = -np.inf, 0.0, 0.0, "", ""

    def add(self, frames: Frames, time: np.ndarray) -> None:
        """Look at m frames, variables by name, and their times (m,) s."""
        if not time.size:
            return
        self._frames += time.size
        self._until = time[-1:].copy()
        if not self.bound.of_frames:
            return
        values = _values(self.bound, frames, time)
        if isinstance(values, str):
            self._none = values
            return
        known = np.isfinite(values)
        self._missing += int((~known.all(axis=1)).sum())
        if not known.any():
            return
        way = 1.0 if self.bound.sense == AT_MOST else -1.0
        up = np.where(known, way * values, -np.inf)
        self._size = max(self._size, float(np.abs(values[known]).max()))
        at, place = divmod(int(up.argmax()), up.shape[1])
        if up[at, place] > self._worst:
            self._worst, self._at = float(up[at, place]), float(time[at])
            self._where = _place(self.bound, frames, place, at, way * self._worst)

    def record(self, headline: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
        """The record, as `judge` gives it; figures, name -> {value, unit, text}, are those of all frames."""
        bound, until = self.bound, self._until
        if not bound.of_frames:
            return _of_figure(bound, headline.get(bound.output), until, NOT_IN_STATISTICS)
        if not self._frames:
            return _record(bound, until, note=NO_FRAME_COUNTS)
        if self._none:
            return _record(bound, until, note=self._none)
        if not np.isfinite(self._worst):
            return _record(bound, until, note=f"{bound.output} is not a number in any frame")
        way = 1.0 if bound.sense == AT_MOST else -1.0
        limit = way * bound.limit
        edge = limit + ROUNDED * max(abs(bound.limit), self._size)
        passed: bool | None = bool(self._worst <= edge)
        margin: float | None = limit - self._worst
        note = ""
        if not passed and bound.lasting > 0.0:
            passed, margin, note = None, None, f"it is passed. {NOT_FOR_HOW_LONG}"
        elif passed and self._missing:
            passed, note = None, _missing(bound, self._missing, self._frames)
        return _record(
            bound, until, value=way * self._worst, margin=margin, passed=passed, note=note, time=self._at,
            place=self._where,
        )  # fmt: skip


def worst(time: np.ndarray, up: np.ndarray, lasting: float) -> tuple[int, float, int]:
    """The place whose values go up most, the value there, and the frame.

    Parameters
    ----------
    time : (m,) array
        s, increasing.
    up : (m, n) array
        Values at n places; -inf where there is none.
    lasting : float
        The value that counts is that which was held, or exceeded, for so long without a break, s; zero: in one frame.
        The frame is the one at which that began.
    """
    most = up.max(axis=0)
    if lasting <= 0.0:
        place = int(most.argmax())
        return place, float(most[place]), int(up[:, place].argmax())
    found, where = -np.inf, int(most.argmax())
    for place in np.argsort(-most):
        if most[place] <= found:
            break
        value = held(time, up[:, place], lasting)
        if value > found:
            found, where = value, int(place)
    if not np.isfinite(found):
        # No stretch is as long: the least of the run tells how it stands.
        found = float(up[np.isfinite(up[:, where]), where].min())
    begin, _, _ = stretches(time, up[:, where], np.nextafter(found, -np.inf))
    at = 0 if begin is None else int(np.searchsorted(time, begin))
    return where, found, min(at, time.size - 1)


def held(time: np.ndarray, up: np.ndarray, lasting: float) -> float:
    """The largest value (m,) that was held or exceeded for so long, s; -inf where the frames are of less time."""
    finite = up[np.isfinite(up)]
    if not finite.size:
        return -np.inf
    low, high = float(finite.min()), float(finite.max())

    def lasts(level: float) -> bool:
        return stretches(time, up, level)[1] >= lasting * (1.0 - ROUNDED)

    if not lasts(np.nextafter(low, -np.inf)):
        return -np.inf
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if lasts(middle) else (low, middle)
    return high if lasts(np.nextafter(high, -np.inf)) else low


def stretches(time: np.ndarray, up: np.ndarray, level: float) -> tuple[float | None, float, float]:
    """Begin and length of the longest time without a break in which values (m,) are above a level, and all times, s.

    Between two frames a value is linear. The begin is None where none is above.
    """
    above = up > level
    if not above.any():
        return None, 0.0, 0.0
    edges = np.flatnonzero(np.diff(np.concatenate(([False], above, [False])).astype(np.int8)))
    first, last = edges[::2], edges[1::2] - 1
    begin = _crossings(time, up, level, first, np.maximum(first - 1, 0))
    end = _crossings(time, up, level, last, np.minimum(last + 1, time.size - 1))
    k = int((end - begin).argmax())
    return float(begin[k]), float(end[k] - begin[k]), float((end - begin).sum())


def _crossings(time: np.ndarray, up: np.ndarray, level: float, above: np.ndarray, below: np.ndarray) -> np.ndarray:
    """When values cross a level between frames above it and frames beside them; at the former where that is unknown."""
    fall = up[above] - up[below]
    known = np.isfinite(fall) & (fall > 0.0)
    share = np.where(known, (up[above] - level) / np.where(known, fall, 1.0), 0.0)
    return time[above] + share * (time[below] - time[above])
