"""What is doubtful of a record of a vessel's motion: rows that can be read, and that no vessel moves by.

A natural cubic spline goes through all rows, so that a stuck sensor, a jump, two rows that are too close or readings in
coarse steps shake the ropes. Its second derivative is straight between rows: the largest one is at a row. The curve of
a table is that spline where it does not overshoot; elsewhere its largest acceleration lies between rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crane.sea.frames import MOTIONS
from crane.sea.mru import ANGLES, Record
from tautline.scene.curves import hermite, slopes
from tautline.scene.functions import EVEN, MANY, MOSTLY, Table
from tautline.scene.reading.columns import Columns

SHIFTS = "m", 0.5 * 9.81, 10.0
"""Unit; acceleration and speed of a vessel beyond which readings are doubtful: half of gravity, a fall of 5 m."""
TURNS = "rad", 1.0, 1.0
"""The same of rotations, rad/s^2 and rad/s: a roll of 45 deg in 6 s has 0.86 of both."""
SPARSE = 1.0
"""Interval of rows, s, beyond which waves of some seconds are not known from them."""
CLOSE = 0.2
"""Share of the usual interval below which two rows are too close for the digits that they are written with."""
STILL = 10
"""Intervals from which on a reading that stays the same to the last digit may be stuck."""
STILL_FOR, DIGITS = 1.0, 100.0
"""How long that is at least, s, and of how many of its last digits: near a crest a reading stays the same for long."""
OUTSTANDING = 2.0
"""How much larger a jump is than what 98 of 100 steps from row to row stay within."""
NEAR = 3
"""Rows beside the largest acceleration in which its cause is sought."""
STEPPED = 0.125
"""Share of the bound that a single step of the last digit makes over one interval, of readings in coarse steps."""
COARSE, LEVELS = 2.5, 4
"""Last digits that steps of coarse readings stay below; values from which on such steps are no jumps to and fro."""
OFTEN = 0.2
"""Share of the rows beyond a bound from which on it is no single fault."""
RINGING = 10
"""Rows that a spline carries a single fault to."""
HELD, CHANGES = 0.5, 10
"""Share of the rows without a change, and changes, from which on a sensor is slower than what writes the rows."""
PLACES = 8
"""Parts of an interval at whose ends the speed of a table's curve is looked at."""
FINE = {"m": 0.002, "rad": math.radians(0.02)}
"""Noise that is left without a word where rows come so often that the curve makes a large acceleration of it."""
RIPPLE = 12.0
"""Second derivative of a natural spline through readings that go up and down by e, over e / h^2."""
TRAVEL = {"m": 0.5, "rad": math.radians(2.0)}
"""Mean of a motion below which a ramp may grow it without a word."""


class _Fault(NamedTuple):
    """Why a reading may have moved as it did, and what to do."""

    cause: str
    cure: str
    same: str = ""
    """What faults of several motions have in common that are one fault: its kind, and lines."""


UNCLEAR = _Fault(
    "No single row stands out. That is noise, or a wrong unit, or an extreme sea",
    "Check the unit of the time and of the column, and smooth a record with noise before the run",
)


class _Said(NamedTuple):
    """A sentence on a motion, and what those of other motions have in common with it."""

    text: str
    same: str


def doubts(record: Record, begin: float, end: float, ramp: float) -> Iterator[str]:
    """Sentences on rows that can be read, and that are probably no motion of a vessel.

    Parameters
    ----------
    record : Record
        Valid, as `crane.sea.mru.read_motions` takes it.
    begin, end, ramp : float
        Time in the file that is the run's t = 0, time to which the run goes, and time of growing, s.

    Yields
    ------
    str
        What is doubtful, by file, line and value; its likely cause; a cure.
    """
    usual = float(np.median(np.diff(record.time)))
    yield from _sparse(record, usual)
    inside = (record.time >= begin - usual) & (record.time <= begin + end + usual)
    alike: dict[str, list[tuple[str, str]]] = {}
    for name, motion in zip(MOTIONS, record.motions, strict=True):
        if np.any(motion):
            curve = _spline(record.time, motion)
            found = [*_too_fast(record, name, motion, inside, curve)] or [*_still(record, name, motion, inside)]
            for said in found:
                alike.setdefault(said.same, []).append((name, said.text))
    for (_, text), *others in alike.values():
        names = [name for name, _ in others]
        more = " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)
        yield f"{text}. The same is so of {more}" if names else text
    for name, motion in zip(MOTIONS, record.motions, strict=True):
        if np.any(motion):
            yield from _travel(record, name, motion, ramp)


def doubts_of_table(path: Path, table: Table, name: str, end: float) -> Iterator[str]:
    """Sentences on rows of a table of one motion that is read from a file.

    Few rows and straight lines between rows were thought out: nothing is said of them, nor of rests.

    Parameters
    ----------
    path : Path
        Of its file, which can be read.
    table : Table
        Its rows, m or rad.
    name : str
        One of `crane.sea.frames.MOTIONS`.
    end : float
        Time to which the run goes, s.

    Yields
    ------
    str
        As of `doubts`.
    """
    if len(table.time) < MANY or table.interpolation == "linear":
        return
    time, motion = np.array(table.time), np.array(table.value)
    record = Record(path, time, np.array([motion]), np.array(Columns(path).lines))
    usual = float(np.median(np.diff(time)))
    inside = (time >= -usual) & (time <= end + usual)
    yield from (said.text for said in _too_fast(record, name, motion, inside, _limited(time, motion)))


def _spline(time: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speed and acceleration at each row of what a run follows of a record of six motions."""
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(time, motion, bc_type="natural")
    return spline(time, 1), spline(time, 2)


def _limited(time: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest speed and acceleration near each row, with their signs, of what a run follows of a table.

    Its pieces are quintics: the acceleration is largest at an end of one or where the third derivative is zero, which
    is quadratic; the speed where the acceleration is zero, or as good as there, at one of some places.
    """
    h = np.diff(time)
    c = hermite(h, motion, *slopes(time, motion)).T
    a, b, d = 60.0 * c[5] * h**2, 24.0 * c[4] * h, 6.0 * c[3]
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(b * b - 4.0 * a * d)
        away = -0.5 * (b + np.where(b < 0.0, -root, root))
        extremes = np.nan_to_num(np.stack((away / a, d / away)), nan=0.0, posinf=0.0, neginf=0.0)
    even = np.repeat(np.linspace(0.0, 1.0, PLACES + 1)[:, None], h.size, axis=1)
    places = np.concatenate((np.clip(extremes, 0.0, 1.0), even))
    speed, acceleration = np.zeros(time.size), np.zeros(time.size)
    rows = np.arange(h.size)
    for x in places:
        t, near = x * h, rows + (x > 0.5)
        rate = c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])))
        second = 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * 20.0 * c[5]))
        for most, value in ((speed, rate), (acceleration, second)):
            for part in (near == rows, near != rows):
                at = near[part]
                most[at] = np.where(np.abs(value[part]) > np.abs(most[at]), value[part], most[at])
    return speed, acceleration


def _sparse(record: Record, usual: float) -> Iterator[str]:
    if usual > SPARSE * (1.0 + 1e-6):
        yield (
            f"the rows of {record.path.name} are {usual:.6g} s apart, and it lasts {np.ptp(record.time):.6g} s in all. "
            "Waves take some seconds: what the vessel does between two rows is not known from them. Is the time in ms? "
            "Then write `time [ms]` in the header. Else give a record with some rows a second"
        )


def _too_fast(
    record: Record, name: str, motion: np.ndarray, inside: np.ndarray, curve: tuple[np.ndarray, np.ndarray]
) -> Iterator[_Said]:
    """Too large an acceleration or speed of a curve, of which both (n,) are given at or near the rows, speed first."""
    if not inside.any():
        return
    unit, *bounds = TURNS if name in ANGLES else SHIFTS
    usual = float(np.median(np.diff(record.time)))
    for what, order, bound in (("an acceleration", 2, bounds[0]), ("a speed", 1, bounds[1])):
        found = np.where(inside, curve[order - 1], 0.0)
        row = int(np.abs(found).argmax())
        beyond = np.abs(found) > bound
        over = int(np.count_nonzero(beyond))
        if not over or (order == 2 and _fine(found[inside], usual, unit)):
            continue
        fault = _fault(record, motion, row, usual, bounds[0], unit, beyond, over / int(np.count_nonzero(inside)))
        if fault is UNCLEAR and order == 2:
            fault = _rounded(motion, found[inside], usual, unit) or fault
        most = _told(bound, unit, order)
        others = f", and more than {most} at {over - 1} more row{'s' * (over > 2)}" if over > 1 else ""
        yield _Said(
            f"{record.path.name} gives {name} {what} of {_told(abs(float(found[row])), unit, order)} at line "
            f"{record.lines[row]} ({record.time[row]:.6g} s, {_told(motion[row], unit)}){others}. Vessels seldom have "
            f"more than {most}. {fault.cause}. {fault.cure}",
            f"{what} {record.lines[row]} {fault.same or fault.cause}",
        )
        return


def _still(record: Record, name: str, motion: np.ndarray, inside: np.ndarray) -> Iterator[_Said]:
    """The first stretch in which a reading stands still."""
    for first, last in _stuck(record.time, motion, _stretches(motion)):
        if inside[first] and inside[last]:
            fault = _standing(record, motion, first, last, "rad" if name in ANGLES else "m")
            yield _Said(f"{name} of {record.path.name} may be wrong. {fault.cause}. {fault.cure}", fault.same)
            return


def _told(value: float, unit: str, order: int = 0) -> str:
    """A motion, or its rate of an order, in degrees where it is an angle."""
    value = math.degrees(value) if unit == "rad" else float(value)
    return f"{round(value, 9) + 0.0:.4g} {'deg' if unit == 'rad' else unit}{('', '/s', '/s^2')[order]}"


def _fine(acceleration: np.ndarray, usual: float, unit: str) -> bool:
    """Whether accelerations are of the last digit, or of as little noise, of rows that come so often: no rope feels it.

    Readings that go up and down by e around a motion give a natural spline a second derivative of 12 e / h^2.
    """
    return _ripples(acceleration) and float(np.abs(acceleration).max()) * usual**2 / RIPPLE <= FINE[unit]


def _ripples(acceleration: np.ndarray) -> bool:
    """Whether accelerations go up and down from row to row, unlike those of a motion."""
    signs = np.sign(acceleration[acceleration != 0.0])
    turns = np.mean(signs[1:] != signs[:-1]) if signs.size > 1 else 0.0
    return bool(turns > 0.5)


def _rounded(motion: np.ndarray, acceleration: np.ndarray, usual: float, unit: str) -> _Fault | None:
    """The cause of accelerations that rounding to the last digit alone can make; None where it cannot."""
    step = _digit(motion)
    most = RIPPLE * 0.5 * step / usual**2
    if not _ripples(acceleration) or float(np.abs(acceleration).max()) > most:
        return None
    return _Fault(
        f"Its readings have a last digit of {_told(step, unit)}. Rows {usual:.3g} s apart make accelerations of up to "
        f"{_told(most, unit, 2)} of that alone, and the ropes feel them",
        "Export it with more digits, or smooth it before the run",
    )


def _fault(
    record: Record,
    motion: np.ndarray,
    row: int,
    usual: float,
    most: float,
    unit: str,
    beyond: np.ndarray,
    share: float,
) -> _Fault:
    """The likely cause of too large an acceleration at a row, of those (n,) that are beyond the bound."""
    lines, intervals, steps = record.lines, np.diff(record.time), np.abs(np.diff(motion))
    first, last = max(row - NEAR, 0), min(row + NEAR, intervals.size)
    close = first + int(intervals[first:last].argmin())
    jump = first + int(steps[first:last].argmax())
    elsewhere = bool(beyond[: max(row - RINGING, 0)].any() or beyond[row + RINGING + 1 :].any())
    jitters = elsewhere and float(np.mean(np.abs(intervals - usual) > EVEN * usual)) > 1.0 - MOSTLY
    if intervals[close] < CLOSE * usual and not jitters:
        return _Fault(
            f"Lines {lines[close]} and {lines[close + 1]} are only {intervals[close]:.3g} s apart, "
            f"and rows are {usual:.6g} s apart else",
            "Delete one of the two rows",
        )
    step = _digit(motion)
    if step > STEPPED * most * usual**2 and steps[jump] < COARSE * step and _coarse(motion, steps, step):
        return _Fault(
            f"Its readings go in steps of {_told(step, unit)}",
            "Export it with more digits, or smooth it before the run",
        )
    if _slow(steps):
        return _Fault(
            f"It changes once in {steps.size / np.count_nonzero(steps):.3g} rows only: its sensor is slower",
            "Keep only the rows in which it changes, or smooth it before the run",
        )
    stretches = _stretches(motion)
    if share < OFTEN:
        for begin, stop in _stuck(record.time, motion, stretches):
            if begin - NEAR <= row <= stop + NEAR:
                return _standing(record, motion, begin, stop, unit)
    if share <= OFTEN and steps[jump] > 0.0 and steps[jump] >= OUTSTANDING * float(np.quantile(steps, 0.98)):
        return _Fault(
            f"It jumps from {_told(motion[jump], unit)} to {_told(motion[jump + 1], unit)} between lines {lines[jump]} "
            f"and {lines[jump + 1]}",
            "Correct the rows, delete one that is wrong, or run a part of the record without it",
            f"jump {lines[jump]}",
        )
    short = stretches[1:-1][np.diff(stretches[1:-1], axis=1)[:, 0] >= STILL // 2]
    for begin, stop in short.tolist():
        beside = max(float(steps[begin - 1]), float(steps[stop]))
        if share < OFTEN and begin - NEAR <= row <= stop + NEAR and beside > COARSE * step:
            return _standing(record, motion, begin, stop, unit)
    for begin, stop in (stretches[0].tolist(), stretches[-1].tolist()):
        if share < OFTEN and stop - begin >= STILL and begin - NEAR <= row <= stop + NEAR:
            return _Fault(
                f"It stands still at {_told(motion[begin], unit)} from line {lines[begin]} to line {lines[stop]}, and "
                "moves at once beside that",
                "Let it come to rest in some seconds, or run a part of the record without that stretch",
                f"rest {lines[begin]} {lines[stop]}",
            )
    if jitters:
        return _Fault(
            f"The times of its rows jitter: the rows are {intervals.min():.3g} s to {intervals.max():.3g} s apart, and "
            f"{usual:.3g} s as a rule",
            "Write the times evenly if the sensor measures evenly, or smooth the record before the run",
        )
    return UNCLEAR


def _coarse(motion: np.ndarray, steps: np.ndarray, step: float) -> bool:
    """Whether readings go in steps of a last digit, most of them one or two digits at once."""
    even = np.allclose(steps / step, np.round(steps / step), rtol=0.0, atol=0.01)
    return even and np.unique(motion).size >= LEVELS and float(np.median(steps[steps > 0.0])) < COARSE * step


def _slow(steps: np.ndarray) -> bool:
    """Whether a reading changes once in as many rows throughout, as of a sensor that is slower than the rows."""
    changes = np.diff(np.flatnonzero(steps))
    if changes.size < CHANGES or np.mean(steps == 0.0) <= HELD:
        return False
    usual = float(np.median(changes))
    return bool(usual >= 2.0 and np.mean(np.abs(changes - usual) <= 1.0 + EVEN * usual) >= MOSTLY)


def _standing(record: Record, motion: np.ndarray, first: int, last: int, unit: str) -> _Fault:
    """A reading that stays the same from a row to another."""
    time, lines = record.time, record.lines
    return _Fault(
        f"It stands still at {_told(motion[first], unit)} from line {lines[first]} to line {lines[last]}, for "
        f"{time[last] - time[first]:.6g} s. The sensor may have been stuck",
        "Fill that stretch in from another sensor, or run a part of the record without it",
        f"stuck {lines[first]} {lines[last]}",
    )


def _stretches(motion: np.ndarray) -> np.ndarray:
    """First and last row (n, 2) of each longest stretch of rows that are all the same; single rows among them."""
    edges = np.flatnonzero(np.diff(motion)) + 1
    return np.column_stack((np.append(0, edges), np.append(edges, motion.size) - 1))


def _stuck(time: np.ndarray, motion: np.ndarray, stretches: np.ndarray) -> Iterator[tuple[int, int]]:
    """First and last row of stretches in which a motion as it is else goes through very many of its last digits.

    A vessel that lies still before and behind a motion is none, wherever it lies.
    """
    first, last = stretches[:, 0], stretches[:, 1]
    lasts = time[last] - time[first]
    rate = float(np.abs(np.diff(motion)).sum() / np.ptp(time))
    long = (last - first >= STILL) & (lasts >= STILL_FOR) & (rate * lasts > DIGITS * _digit(motion))
    for begin, stop in stretches[long].tolist():
        if begin > 0 and stop < motion.size - 1:
            yield begin, stop


def _digit(motion: np.ndarray) -> float:
    """The least difference of two readings: of a long record its last digit, 0 of one that does not move."""
    between = np.diff(np.unique(motion))
    return float(between[between > 1e-9 * np.ptp(motion)].min(initial=np.inf)) if between.size else 0.0


def _travel(record: Record, name: str, motion: np.ndarray, ramp: float) -> Iterator[str]:
    """A mean that a ramp takes the vessel to as if it were motion."""
    unit = "rad" if name in ANGLES else "m"
    mean = float(motion.mean())
    if ramp > 0.0 and abs(mean) > max(TRAVEL[unit], float(np.abs(motion - mean).max())):
        yield (
            f"{name} of {record.path.name} has a mean of {_told(mean, unit)}, more than it goes to either side of it. "
            f"With `ramp` the vessel travels all of that within the first {ramp:.6g} s. Take the mean off the column "
            "in the file: motions are counted from where the vessel is drawn"
        )
