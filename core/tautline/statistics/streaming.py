"""What is accumulated of values over time as their frames come, in memory that does not grow with the frames.

Turning points alone are kept one by one, of what is watched: crossings of any level, rainflow cycles and peaks follow
from them exactly, and there are two in a period however many frames it has.
"""

from __future__ import annotations

import math

import numpy as np


class Moments:
    """Mean, standard deviation, smallest and largest with their times, of n values.

    Means are over time by the trapezoidal rule. Batches are merged after Chan, Golub and LeVeque (1983): no digits are
    lost where a mean is large beside its deviation.
    """

    def __init__(self) -> None:
        self.begin = math.nan
        self._weight = 0.0
        self._time: np.ndarray = np.empty(0)
        self._last: np.ndarray | None = None

    def add(self, time: np.ndarray, values: np.ndarray) -> None:
        """Take frames: times (m,) s, values (m, n)."""
        if self._last is None:
            self.begin = float(time[0])
            n = values.shape[1]
            self._mean, self._squares = values[0].astype(float), np.zeros(n)
            self.low, self.high = values[0].astype(float), values[0].astype(float)
            self.low_time, self.high_time = np.full(n, time[0]), np.full(n, time[0])
        else:
            time, values = np.concatenate((self._time, time)), np.concatenate((self._last, values))
        self._time, self._last = time[-1:].copy(), values[-1:].copy()
        columns = np.arange(values.shape[1])
        k, j = values.argmax(axis=0), values.argmin(axis=0)
        high, low = values[k, columns], values[j, columns]
        more, less = high > self.high, low < self.low
        self.high, self.high_time = np.where(more, high, self.high), np.where(more, time[k], self.high_time)
        self.low, self.low_time = np.where(less, low, self.low), np.where(less, time[j], self.low_time)
        if len(time) > 1:
            self._merge(time, values)

    def _merge(self, time: np.ndarray, values: np.ndarray) -> None:
        weights = np.zeros(len(time))
        steps = np.diff(time)
        weights[1:] += 0.5 * steps
        weights[:-1] += 0.5 * steps
        weight = float(weights.sum())
        if weight <= 0.0:
            return
        mean = weights @ values / weight
        squares = weights @ (values - mean) ** 2
        total = self._weight + weight
        away = mean - self._mean
        self._squares = self._squares + squares + away**2 * (self._weight * weight / total)
        self._mean = self._mean + away * (weight / total)
        self._weight = total

    @property
    def span(self) -> float:
        """Time from the first frame to the last, s."""
        return self._weight

    @property
    def mean(self) -> np.ndarray:
        """(n,)."""
        return self._mean

    @property
    def sd(self) -> np.ndarray:
        """(n,)."""
        return np.sqrt(self._squares / self._weight) if self._weight > 0.0 else np.zeros_like(self._squares)


class Turns:
    """Turning points of n values, the first and the last frame among them."""

    def __init__(self) -> None:
        self._parts: list[list[tuple[np.ndarray, np.ndarray]]] = []
        self._last: tuple[float, np.ndarray] | None = None

    def add(self, time: np.ndarray, values: np.ndarray) -> None:
        """Take frames: times (m,) s, values (m, n)."""
        n = values.shape[1]
        if self._last is None:
            self._parts = [[(time[:1].copy(), values[:1, k].astype(float))] for k in range(n)]
            self._way = np.zeros(n)
            self._at = np.full(n, time[0])
        else:
            time, values = np.concatenate(([self._last[0]], time)), np.concatenate((self._last[1][None], values))
        for k in range(n):
            self._turn(k, time, values[:, k])
        self._last = float(time[-1]), values[-1].astype(float)

    def _turn(self, k: int, time: np.ndarray, values: np.ndarray) -> None:
        """Keep where a value turns; of equal neighbours the last."""
        steps = np.diff(values)
        moves = np.flatnonzero(steps)
        if moves.size == 0:
            return
        ways = np.sign(steps[moves])
        before = np.concatenate(([self._way[k]], ways[:-1]))
        turned = moves[(before * ways) < 0.0]
        if turned.size:
            self._parts[k].append((time[turned].copy(), values[turned].astype(float)))
        self._way[k] = ways[-1]

    def of(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of one of them; as many as there were turns, and two."""
        assert self._last is not None
        time = np.concatenate([part for part, _ in self._parts[k]] + [[self._last[0]]])
        value = np.concatenate([part for _, part in self._parts[k]] + [[self._last[1][k]]])
        return time, value

    def cycles(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Rainflow cycles of one of them: ranges, and counts of 1 for a closed cycle and 0.5 for a half."""
        return rainflow_cycles(self.of(k)[1])

    def upcrossings(self, k: int, level: float) -> int:
        """Times that a value goes from below a level to it or above."""
        _, value = self.of(k)
        return int(((value[:-1] < level) & (value[1:] >= level)).sum())


def rainflow_cycles(turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rainflow cycles of turning points (n,): ranges, and counts of 1 for a closed cycle and 0.5 for a half.

    They are those of ASTM E1049-85, section 5.4.4. A range between two that are no smaller is a closed cycle, wherever
    it stands; it is counted and taken out, all that there are at a time, until none is left. What remains widens and
    then narrows, and its ranges are halves (Amzallag and others 1994).
    """
    x, found = turns[np.concatenate(([True], np.diff(turns) != 0.0))], [np.empty(0)]
    while x.size > 3:
        size = np.abs(np.diff(x))
        inner = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:]))
        if inner.size == 0:
            break
        # Of equal ranges next to one another, which share a point, every other one.
        begins = np.concatenate(([True], np.diff(inner) > 1))
        place = np.arange(inner.size)
        inner = inner[(place - np.maximum.accumulate(np.where(begins, place, 0))) % 2 == 0]
        found.append(size[inner + 1])
        x = np.delete(x, np.concatenate((inner + 1, inner + 2)))
        x = x[_turning(x)]
    closed, halves = np.concatenate(found), np.abs(np.diff(x))
    return np.concatenate((closed, halves)), np.concatenate((np.ones(closed.size), np.full(halves.size, 0.5)))


def _turning(x: np.ndarray) -> np.ndarray:
    """Which of some values are turning points, the first and the last among them."""
    ways = np.sign(np.diff(x))
    return np.concatenate(([True], ways[1:] != ways[:-1], [True])) if x.size > 2 else np.ones(x.size, bool)


class Blocks:
    """Largest and smallest of n values in blocks of equal length; of the last only when it is whole.

    Parameters
    ----------
    length : float
        s.
    """

    def __init__(self, length: float) -> None:
        self.length = length
        self._begin: float | None = None
        self._number = 0
        self._high: list[np.ndarray] = []
        self._low: list[np.ndarray] = []
        self._reached = 0.0

    def add(self, time: np.ndarray, values: np.ndarray) -> None:
        """Take frames: times (m,) s, values (m, n)."""
        if self._begin is None:
            self._begin = float(time[0])
        # A frame at the end of a block, but for rounding, is the first of the next.
        number = np.floor((time - self._begin) / self.length + 1e-9).astype(int)
        edges = np.flatnonzero(np.diff(number)) + 1
        for part in np.split(np.arange(len(time)), edges):
            at = int(number[part[0]])
            high, low = values[part].max(axis=0).astype(float), values[part].min(axis=0).astype(float)
            while len(self._high) < at:
                # A block between two frames is one, and has no largest.
                self._high.append(np.full_like(high, np.nan))
                self._low.append(np.full_like(low, np.nan))
            if at < len(self._high):
                high, low = np.maximum(self._high[at], high), np.minimum(self._low[at], low)
                self._high[at], self._low[at] = high, low
            else:
                self._high.append(high)
                self._low.append(low)
        self._reached = (float(time[-1]) - self._begin) / self.length

    @property
    def whole(self) -> int:
        """Number of blocks that are whole."""
        return min(len(self._high), int(self._reached + 1e-9))

    @property
    def begins(self) -> np.ndarray:
        """When the whole blocks begin, (b,) s."""
        return (self._begin or 0.0) + self.length * np.arange(self.whole)

    def extremes(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest of whole blocks, (b, n)."""
        low, high = self._low[: self.whole], self._high[: self.whole]
        return np.reshape(low, (len(low), n)), np.reshape(high, (len(high), n))


class Windows:
    """Whole frames around the largest and the smallest of what is watched.

    Parameters
    ----------
    length : float
        Of a window, s; the extreme stands in its middle, where the run goes on for so long.
    """

    def __init__(self, length: float) -> None:
        self.half = 0.5 * length
        self._recent: list[dict[str, np.ndarray]] = []
        self.kept: dict[tuple[str, str], Window] = {}

    def add(self, frames: dict[str, np.ndarray], watched: dict[str, np.ndarray], begin: float) -> None:
        """Take frames: all variables, and what is watched, name -> (m, n); extremes before `begin` do not count."""
        time = frames["time"]
        counts = time >= begin
        for name, values in watched.items():
            for which in ("largest", "smallest"):
                window = self.kept.get((name, which))
                found = self._extreme(values, counts, which)
                if found is not None and (window is None or window.beaten_by(found[0], which)):
                    value, row, place = found
                    at = float(time[row])
                    window = Window(value, at, place, at - self.half, at + self.half)
                    self.kept[name, which] = window
                    for part in self._recent:
                        window.take(part)
                if window is not None:
                    window.take(frames)
        self._recent.append({name: np.array(values) for name, values in frames.items()})
        while len(self._recent) > 1 and self._recent[1]["time"][0] < time[-1] - self.half:
            self._recent.pop(0)

    @staticmethod
    def _extreme(values: np.ndarray, counts: np.ndarray, which: str) -> tuple[float, int, int] | None:
        if not counts.any():
            return None
        skipped = int(np.argmax(counts))
        some = values[skipped:]
        k = int(some.argmax() if which == "largest" else some.argmin())
        row, place = divmod(k, some.shape[1])
        return float(some[row, place]), skipped + row, place

    def frames(self, more: list[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
        """The frames of all windows, and `more`, in the order of time, each once."""
        parts = [part for window in self.kept.values() for part in window.parts] + more
        joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        _, first = np.unique(joined["time"], return_index=True)
        return {name: values[first] for name, values in joined.items()}


class Window:
    """Frames around an extreme.

    Attributes
    ----------
    value, time : float
        Of the extreme.
    place : int
        Which of the values it is.
    begin, end : float
        s.
    parts : list
        Frames, in the order of time.
    """

    def __init__(self, value: float, time: float, place: int, begin: float, end: float) -> None:
        self.value, self.time, self.place, self.begin, self.end = value, time, place, begin, end
        self.parts: list[dict[str, np.ndarray]] = []

    def beaten_by(self, value: float, which: str) -> bool:
        """Whether a value is more extreme."""
        return value > self.value if which == "largest" else value < self.value

    def take(self, frames: dict[str, np.ndarray]) -> None:
        """Keep those of some frames that lie in the window."""
        time = frames["time"]
        if time[-1] < self.begin or time[0] > self.end:
            return
        inside = (time >= self.begin) & (time <= self.end)
        if inside.any():
            self.parts.append({name: np.array(values[inside]) for name, values in frames.items()})
