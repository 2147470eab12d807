"""Readings of a place that a sensor knocks away for one row or two, and that are back on their way behind it.

No machine goes so: what drives it would have to throw it there, and catch it again where it would have been. A machine
that sets off, stops or turns at once goes on from where it is. So a reading is one only if what comes behind it goes on
as what was before it, and if to be there took an acceleration that was never seen.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.twin.pace import ONE_STAMP

ROWS, BACK = 2, 1.6
"""Readings behind it among which one is back; and how much nearer that is to where it would have been: one that is set
elsewhere is as far off behind it, one that sets off twice as far, and one that slows down all the while by half."""
TIME = 0.5
"""From the reading before it to the one that is back at most, s: a crest of a wave, and a jog of a lever, may be
shorter than rows that come slowly."""
SUDDEN = 4.0
"""Acceleration that any machine may be thrown away with, m/s2 (of an angle rad/s2)."""


def is_knock(
    before: tuple[float, float], speed: float, at: float, reading: float, following: Sequence[tuple[float, float]],
    seen: float,
) -> bool | None:  # fmt: skip
    """Whether a reading is away from where a place was on its way to, and the place back; None where that is not known.

    Parameters
    ----------
    before : (float, float)
        Time, s, and place, SI, of the reading before it.
    speed : float
        At which it came to that one, SI.
    at, reading : float
        s, SI.
    following : sequence of (float, float)
        Times and places behind it, as far as they are known, without those that are missing.
    seen : float
        Largest change of the place from one interval to the next that is no knock, SI.
    """
    time, place = before

    def off(at: float, value: float) -> float:
        return abs(value - place - speed * (at - time))

    away = off(at, reading)
    if not away > max(SUDDEN * (at - time) ** 2, seen):
        return False
    near = [(t, x) for t, x in following[:ROWS] if t <= time + TIME + ONE_STAMP]
    if not near:
        return None if at <= time + TIME + ONE_STAMP and not following else False
    return any(off(t, x) < away / BACK for t, x in near)


def knocked(times: np.ndarray, values: np.ndarray, seen: float) -> tuple[np.ndarray, np.ndarray]:
    """Which of the readings (n,) of a place were knocked away, and which last ones may have been; NaN is none.

    The first two count as true.
    """
    sure, doubtful = np.zeros(len(values), bool), np.zeros(len(values), bool)
    finite = [int(i) for i in np.flatnonzero(np.isfinite(values))]
    kept = finite[:2]
    for place, i in enumerate(finite[2:], 2):
        one, other = kept[-2:]
        passed = times[other] - times[one]
        if not 0.0 < passed <= TIME + ONE_STAMP:
            kept.append(i)
            continue
        speed = float(values[other] - values[one]) / float(passed)
        near = finite[place + 1 : place + 1 + ROWS]  # a twin looks at a whole window for every row
        before, *behind = ((float(times[k]), float(values[k])) for k in (other, *near))
        found = is_knock(before, speed, float(times[i]), float(values[i]), behind, seen)
        sure[i], doubtful[i] = found is True, found is None
        if not found:
            kept.append(i)
    return sure, doubtful
