"""What to tell of a crane's tensions: slack and the snap after it, amplification, safety, the largest and where.

Everything works on histories at the frames of a run. A name of a span goes with a column.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tautline.errors import ArgumentError

SNAP_WINDOW = 2.0
"""Time after slack in which the largest tension is the snap's, s."""


class Peak(NamedTuple):
    """The largest of many numbers: what, where, when; of equals the first."""

    value: float
    where: str
    time: float
    """s."""


class SlackEvent(NamedTuple):
    """One stay of a span at or below the threshold of slack."""

    span: str
    begin: float
    """s; between frames by straight interpolation."""
    end: float
    """s."""
    from_start: bool
    """Slack at the first frame: it may have been so for longer."""
    to_end: bool
    """Slack at the last frame: it may go on, and there is no snap."""
    snap: float | None
    """Largest tension in the span within `SNAP_WINDOW` after the end, or until it is slack again, N."""
    snap_time: float | None
    """s."""

    @property
    def duration(self) -> float:
        """Time from begin to end, s."""
        return self.end - self.begin


def checked(time: np.ndarray, **histories: np.ndarray) -> tuple[np.ndarray, ...]:
    """Histories as arrays of floats, time first, or what is wrong with them.

    Parameters
    ----------
    time : (m,) array
        s, m >= 1, in order; equal times are allowed.
    **histories : (m, ...) array
        By the names that a message gives them.

    Raises
    ------
    ArgumentError
        Where there is no frame, times fall, a length differs, or a number is not finite.
    """
    time = np.asarray(time, float)
    if time.ndim != 1 or time.size == 0:
        raise ArgumentError(f"time: shape {time.shape}; one time for each of at least one frame is wanted")
    arrays = {"time": time} | {name: np.asarray(values, float) for name, values in histories.items()}
    for name, values in arrays.items():
        if values.shape[:1] != time.shape:
            raise ArgumentError(f"{name}: shape {values.shape} for {time.size} frames")
        if not np.isfinite(values).all():
            frame = int(np.argmin(np.isfinite(values).reshape(time.size, -1).all(axis=1)))
            raise ArgumentError(f"{name}: frame {frame} (time {time[frame]:g} s) is not finite")
    if (time[1:] < time[:-1]).any():
        frame = int(np.argmax(np.diff(time) < 0.0)) + 1
        raise ArgumentError(f"time: {time[frame]:g} s at frame {frame} comes after {time[frame - 1]:g} s")
    return tuple(arrays.values())


class Columns(NamedTuple):
    """Histories that were checked: times (m,) s, values (m, n), and what each column is of."""

    time: np.ndarray
    values: np.ndarray
    names: Sequence[str]

    def at(self, place: int) -> Peak:
        """A value by its place in the flat array."""
        frame, column = divmod(place, len(self.names))
        return Peak(float(self.values[frame, column]), self.names[column], float(self.time[frame]))


def columns(time: np.ndarray, values: np.ndarray, names: Sequence[str]) -> Columns:
    """Check times and values, and make the latter (m, n).

    Raises
    ------
    ArgumentError
        As `checked`, and where there is not one name for each column.
    """
    time, values = checked(time, values=values)
    values = values.reshape(time.size, -1)
    if values.shape[1] != len(names) or not names or len(set(names)) != len(names):
        raise ArgumentError(f"names: {', '.join(names) or 'none'} for {values.shape[1]} columns; one each is wanted")
    return Columns(time, values, names)


def slack_events(
    time: np.ndarray,
    tension: np.ndarray,
    names: Sequence[str],
    threshold: float = 0.0,
    window: float = SNAP_WINDOW,
    most: np.ndarray | None = None,
) -> list[SlackEvent]:
    """Times in which spans are slack, and the snap after each; in order of time, then of spans.

    Parameters
    ----------
    time : (m,) array
        s.
    tension : (m,) or (m, n) array
        N, a column each span: the smallest in it, where a heavy rope has several.
    names : sequence of str
        Of the n spans.
    threshold : float
        Tension at or below which a rope is slack, N; one per cent of what it carries at rest serves well. With 0 only
        frames that are exactly slack count, and with elastic compression any pressure.
    window : float
        Time after slack in which the snap is sought, s.
    most : (m,) or (m, n) array or None
        The largest tension in each span, which a snap is read off, N; None where it is the same.
    """
    time, tension, names = columns(time, tension, names)
    if not (tension <= threshold).any():
        return []
    most = tension if most is None else columns(time, most, names).values
    found = [
        event for name, column in zip(names, tension.T, strict=True) for event in _slack(time, column, name, threshold)
    ]
    with_snaps = []
    for k, event in enumerate(found):
        following = found[k + 1] if k + 1 < len(found) and found[k + 1].span == event.span else None
        stop = min(event.end + window, following.begin if following else float(time[-1]), float(time[-1]))
        snap = None if event.to_end else _largest_within(time, most[:, names.index(event.span)], event.end, stop)
        with_snaps.append(event if snap is None else event._replace(snap=snap[0], snap_time=snap[1]))
    return sorted(with_snaps, key=lambda event: (event.begin, names.index(event.span)))


def largest(time: np.ndarray, values: np.ndarray, names: Sequence[str]) -> Peak:
    """Find the largest value, where and when it is; of the negative, the smallest.

    Parameters
    ----------
    time : (m,) array
        s.
    values : (m,) or (m, n) array
    names : sequence of str
        Of the n columns.
    """
    return columns(time, values, names).at(int(np.argmax(values)))


def amplification(time: np.ndarray, tension: np.ndarray, static: np.ndarray, names: Sequence[str]) -> Peak | None:
    """Dynamic amplification factor: the largest tension over what the same span carries at rest.

    Parameters
    ----------
    time : (m,) array
        s.
    tension : (m,) or (m, n) array
        N.
    static : float or (n,) array
        Tension at rest, N. Spans that carry nothing at rest have no factor.
    names : sequence of str
        Of the n spans.

    Returns
    -------
    Peak or None
        The largest factor of all spans; None where no span carries anything at rest.

    Raises
    ------
    ArgumentError
        As `checked`, or where a static tension is not finite.
    """
    return amplification_of(columns(time, tension, names), static)


def amplification_of(tension: Columns, static: np.ndarray) -> Peak | None:
    """The same of tensions that were checked; ``static`` may differ from time to time, (m, n) N.

    Raises
    ------
    ArgumentError
        Where a tension at rest is not finite.
    """
    time, values, names = tension
    static = np.asarray(static, float)
    static = np.broadcast_to(static, static.shape if static.ndim == 2 else (len(names),))
    finite = np.isfinite(np.atleast_2d(static)).all(axis=0)
    if not finite.all():
        raise ArgumentError(f"static: {names[int(np.argmin(finite))]} has no finite tension at rest")
    carrying = np.flatnonzero((np.atleast_2d(static) > 0.0).all(axis=0))
    if carrying.size == 0:
        return None
    if carrying.size < static.size:
        values, static, names = values[:, carrying], static[..., carrying], [names[k] for k in carrying.tolist()]
    factors = values / static
    return Columns(time, factors, names).at(int(np.argmax(factors)))


def safety_factor(breaking_load: float | None, tension: np.ndarray) -> float | None:
    """Breaking load over the largest tension.

    Parameters
    ----------
    breaking_load : float or None
        N.
    tension : array
        Of any shape, N.

    Returns
    -------
    float or None
        None where the breaking load is not known or the rope is never taut.

    Raises
    ------
    ArgumentError
        Where a tension is not finite.
    """
    most = float(np.max(tension, initial=0.0))
    if not np.isfinite(most):
        raise ArgumentError("tension: not finite")
    return None if breaking_load is None or most <= 0.0 else breaking_load / most


def _slack(time: np.ndarray, tension: np.ndarray, name: str, threshold: float) -> list[SlackEvent]:
    """Slack events of one span, without their snaps."""
    slack = tension <= threshold
    change = np.flatnonzero(slack[1:] != slack[:-1])
    # Where the tension crosses the threshold between two frames; one of them is above it, so it does change.
    share = (threshold - tension[change]) / (tension[change + 1] - tension[change])
    at = (time[change] + share * (time[change + 1] - time[change])).tolist()
    from_start, to_end = bool(slack[0]), bool(slack[-1])
    at = [float(time[0])] * from_start + at + [float(time[-1])] * to_end
    last = len(at) // 2 - 1
    return [
        SlackEvent(name, begin, end, from_start and k == 0, to_end and k == last, None, None)
        for k, (begin, end) in enumerate(zip(at[::2], at[1::2], strict=True))
    ]


def _largest_within(time: np.ndarray, tension: np.ndarray, begin: float, end: float) -> tuple[float, float]:
    """Largest tension and its time, between two times; (N, s)."""
    inside = (time > begin) & (time <= end)
    at = np.append(time[inside], end)
    values = np.append(tension[inside], np.interp(end, time, tension))
    k = int(np.argmax(values))
    return float(values[k]), float(at[k])
