"""The motion that a hose's tip ends in: rest, growth, decay, or a limit cycle with its frequency and amplitude.

Everything is read off the tip's position and velocity at the frames and between them
(`gardenhose.motion.curves.Trace`), so that a run need not store more than some ten frames a period, and not at even
intervals. What a cycle is stands in `gardenhose.motion.cycles`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gardenhose.motion.curves import Trace, directions
from gardenhose.motion.cycles import (
    FEWEST,
    STEADY,
    Cycles,
    Swings,
    cycles_used,
    find_cycles,
    grouped,
    scatter,
    steady,
    swings,
)

REST = 1.0e-9
"""Motion over the length of the hose below which the tip is at rest."""
TINY = float(np.finfo(float).tiny)
"""Takes the place of zero under a logarithm and in a ratio."""
POINTS = 128
"""Samples of each cycle that its place and direction are taken from."""
FINE = 512
"""Samples of each cycle that extents are taken from."""

TURNS = 1.0e-6
"""Speed back, over the largest, above which a motion does not go one way."""


@dataclass(frozen=True, eq=False)
class LimitCycle:
    """How the tip moves at the end of a run; all numbers are finite, whatever the run.

    Attributes
    ----------
    kind : str
        ``rest``: within `REST` of the length; ``periodic``: a limit cycle; ``growing``, ``decaying``: the motion gets
        steadily larger or smaller, or moves one way ever faster or slower;
        ``not determined``: it turns, but not for a whole cycle; ``irregular``: none of these.
    settled : bool
        Whether the amplitudes of at least `FEWEST` last cycles agree within `STEADY` and do not drift; true at rest.
    note : str
        What limits the answer, such as too few cycles; mostly empty.
    frequency : float
        Of whole cycles, Hz; 0 where there is none.
    amplitude : float
        Half of peak to peak in the direction of largest motion, m: mean over the cycles used; without a whole cycle,
        over the second half of the run.
    axis_amplitude : (3,) array
        Half of peak to peak along each axis, m.
    direction, normal : (3,) array
        Unit vectors of largest and of least motion.
    out_of_plane : float
        Root mean square of the motion along `normal` over that of all motion.
    mean : (3,) array
        Mean position over the cycles used, m.
    max_speed : float
        Largest speed in the cycles used, m/s.
    cycles : int
        Whole cycles used: all last ones whose amplitudes agree with their mean within `STEADY`, without the earlier
        half as long as that holds most of the scatter; if these are not `FEWEST`, the last `FEWEST`, or what there is.
    scatter : float
        Largest difference of a cycle's amplitude from their mean, relative, among the cycles used.
    growth_rate : float
        Of the amplitude at the end, 1/s: a straight line through its logarithm over the latest cycles.
    log_decrement : float
        Logarithm of one cycle's amplitude over the next one's; positive for decay.
    loops : int
        Swings up and down in one cycle.
    crossings : (cycles + 1,) array
        Times between which the cycles used stand, s.
    start, end : float
        Time span that the numbers stand for, s.
    cycle_time, cycle_amplitude : (n,) array
        Middle and amplitude of every cycle of the run, s and m.
    """

    kind: str
    settled: bool
    mean: np.ndarray
    start: float
    end: float
    note: str = ""
    frequency: float = 0.0
    amplitude: float = 0.0
    axis_amplitude: np.ndarray = field(default_factory=lambda: np.zeros(3))
    direction: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    normal: np.ndarray = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    out_of_plane: float = 0.0
    max_speed: float = 0.0
    cycles: int = 0
    scatter: float = 0.0
    growth_rate: float = 0.0
    log_decrement: float = 0.0
    loops: int = 1
    crossings: np.ndarray = field(default_factory=lambda: np.zeros(0))
    cycle_time: np.ndarray = field(default_factory=lambda: np.zeros(0))
    cycle_amplitude: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def period(self) -> float:
        """Duration of a cycle, s; 0 where there is none."""
        return 1.0 / self.frequency if self.frequency > 0.0 else 0.0


def limit_cycle(
    time: np.ndarray, position: np.ndarray, velocity: np.ndarray, length: float | None = None
) -> LimitCycle:
    """Tell how the tip moves at the end of a run.

    Parameters
    ----------
    time : (m,) array
        Times of the frames, s.
    position, velocity : (m, 3) array
        Of the tip, m and m/s. Frames that are not finite, or do not come after the one before, are left out.
    length : float, optional
        Length of the hose, m, of which `REST` is a share; by default the tip's largest distance from the origin or
        from where it started.
    """
    time, position, velocity = _frames(time, position, velocity)
    if len(time) == 0:
        return LimitCycle("rest", False, np.zeros(3), 0.0, 0.0, note="no frames")
    if not length:
        length = max(float(np.linalg.norm(position, axis=1).max()), float(_extent(position)), TINY)
    late = time >= 0.5 * (time[0] + time[-1])
    if _rests(time, position, velocity, REST * length):
        still = time >= time[-1] - 0.25 * (time[-1] - time[0])
        return LimitCycle(
            "rest", True, position[still].mean(axis=0), float(time[still][0]), float(time[-1]),
            max_speed=float(np.linalg.norm(velocity[still], axis=1).max()),
        )  # fmt: skip
    direction = directions(velocity[late])[0]
    if not velocity[late].any():
        direction = directions(position[late] - position[late].mean(axis=0))[0]
    origin = position[late].mean(axis=0)
    found = find_cycles(time, (position - origin) @ direction, velocity @ direction, REST * length)
    if len(found.crossings) < 2:
        return _without_cycles(time, position, velocity, late, direction)
    whole = Trace(time, position, velocity)
    # The direction of largest motion and the mean are those of the cycles used, which the first pass has found.
    for _ in range(2):
        cycles = grouped(found)[0]
        # Passages of a mean tell the period of a steady motion best; of one that grows or decays, those of the middle
        # between its extremes, which has the same share in every swing.
        centred = steady(cycles.amplitude) >= FEWEST
        place = _sampled(whole, cycles.crossings[-1 - cycles_used(cycles) :], POINTS)[0].reshape(-1, 3)
        origin = place.mean(axis=0)
        direction = directions(place - origin)[0]
        found = find_cycles(time, (position - origin) @ direction, velocity @ direction, REST * length, centred)
        if len(found.crossings) < 2:
            return _without_cycles(time, position, velocity, late, direction)
    return _described(found, whole, swings(time, (position - origin) @ direction, velocity @ direction))


def _frames(time: Any, position: Any, velocity: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frames that are finite and later than all before."""
    time = np.atleast_1d(np.asarray(time, float))
    position, velocity = (np.asarray(array, float).reshape(len(time), 3) for array in (position, velocity))
    # What has run away so far overflows when squared.
    good = np.isfinite(time) & np.all([(np.abs(array) < 1e100).all(axis=1) for array in (position, velocity)], axis=0)
    time, position, velocity = time[good], position[good], velocity[good]
    good = np.ones(len(time), bool)
    good[1:] = time[1:] > np.maximum.accumulate(time)[:-1]
    return time[good], position[good], velocity[good]


def _extent(position: np.ndarray) -> float:
    return float(np.linalg.norm(position - position[0], axis=1).max())


def _rests(time: np.ndarray, position: np.ndarray, velocity: np.ndarray, least: float) -> bool:
    """Whether the last quarter of a run shows no motion."""
    if len(time) == 1:
        return not velocity.any()
    from_here = max(0, min(int(np.searchsorted(time, time[-1] - 0.25 * (time[-1] - time[0]))), len(time) - 3))
    moved = np.ptp(position[from_here:], axis=0).max()
    # Frames a whole period apart stand still too, at a speed.
    travelled = np.linalg.norm(velocity[from_here:], axis=1).max() * np.median(np.diff(time))
    return bool(moved <= least and travelled <= 1e3 * least)


def _sampled(whole: Trace, crossings: np.ndarray, points: int = FINE) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity at equal phases of every cycle, (cycles, points, 3) each."""
    times = crossings[:-1, None] + np.diff(crossings)[:, None] * (np.arange(points) / points)
    place, speed = whole(times.ravel())
    return place.reshape(*times.shape, 3), speed.reshape(*times.shape, 3)


def _peak(values: np.ndarray) -> np.ndarray:
    """Maximum of every cycle, (cycles, points, ...) -> (cycles, ...), by a parabola through the largest samples."""
    at = np.expand_dims(values.argmax(axis=1), 1)
    middle, left, right = (
        np.take_along_axis(values, (at + shift) % values.shape[1], axis=1)[:, 0] for shift in (0, -1, 1)
    )
    bend, tilt = 2.0 * middle - left - right, right - left
    lift = np.where(bend > 0.0, tilt**2 / np.where(bend > 0.0, 8.0 * bend, 1.0), 0.0)
    # Where a cycle's ends do not meet, as in growth, the parabola may be nonsense: it cannot lift much.
    return middle + np.minimum(lift, 0.125 * np.maximum(bend, 0.0))


def _described(found: Cycles, whole: Trace, extremes: Swings) -> LimitCycle:
    """A limit cycle's numbers, from the cycles of the motion along its largest direction."""
    cycles, loops = grouped(found)
    used, count = cycles_used(cycles), len(cycles.top)
    crossings, amplitude = cycles.crossings[-1 - used :], cycles.amplitude
    place, speed = _sampled(whole, crossings)
    mean = place.reshape(-1, 3).mean(axis=0)
    motion = place.reshape(-1, 3) - mean
    direction, _, normal = directions(motion)
    size = math.sqrt(float((motion**2).sum(axis=1).mean()))
    # A straight line through all crossings: less sensitive to each than first and last alone.
    number = np.arange(used + 1) - 0.5 * used
    period = float(number @ crossings / (number @ number))
    kind, note, growth = _kind(amplitude, np.abs(np.diff(extremes.value)))
    last = amplitude[-used:]
    return LimitCycle(
        kind=kind,
        settled=kind == "periodic" and count >= FEWEST,
        mean=mean,
        start=float(crossings[0]),
        end=float(crossings[-1]),
        note=note,
        frequency=1.0 / period,
        amplitude=float(last.mean()),
        axis_amplitude=0.5 * (_peak(place) + _peak(-place)).mean(axis=0),
        direction=direction,
        normal=normal,
        out_of_plane=math.sqrt(float(((motion @ normal) ** 2).mean())) / size,
        max_speed=math.sqrt(float(_peak((speed**2).sum(axis=2)).max())),
        cycles=used,
        scatter=scatter(last),
        growth_rate=growth / period,
        log_decrement=-growth,
        loops=loops,
        crossings=crossings,
        cycle_time=0.5 * (cycles.crossings[1:] + cycles.crossings[:-1]),
        cycle_amplitude=amplitude,
    )


def _slope(values: np.ndarray) -> tuple[float, float, float]:
    """Slope of values against their number, its standard error, and the share of their variance that it explains."""
    number = np.arange(len(values)) - 0.5 * (len(values) - 1)
    slope = float(number @ values / (number @ number))
    left = float(((values - values.mean() - slope * number) ** 2).sum())
    total = float(((values - values.mean()) ** 2).sum())
    error = math.sqrt(left / max(len(values) - 2, 1) / float(number @ number))
    return slope, error, 1.0 - left / total if total > 0.0 else 0.0


def _kind(amplitude: np.ndarray, swing: np.ndarray) -> tuple[str, str, float]:
    """Kind of motion, a note, and the growth of the logarithm of the amplitude in a cycle."""
    count, agree = len(amplitude), steady(amplitude)
    if count < FEWEST:
        note = f"{count} whole cycle{'s' if count != 1 else ''}: too few to tell a limit cycle"
        logs = np.log(np.maximum(swing[-5:], TINY))
        # Two swings make a cycle.
        return _trend(logs), note, 2.0 * _slope(logs)[0] if len(logs) > 1 else 0.0
    if agree >= FEWEST:
        growth, error, _ = _slope(np.log(amplitude[-max(FEWEST, math.ceil(0.5 * agree)) :]))
        # A slow drift is told from a limit cycle by what it would make of as many cycles as there have been.
        if abs(growth) * count > STEADY and abs(growth) > 3.0 * error:
            return "growing" if growth > 0.0 else "decaying", "", growth
        return "periodic", "", growth
    late = np.log(amplitude[-max(5, count // 2) :])
    growth, _, explained = _slope(late)
    kind = _trend(late)
    if kind == "irregular" and explained > 0.9:
        kind = "growing" if growth > 0.0 else "decaying"
    return kind, "", growth


def _trend(logs: np.ndarray) -> str:
    """Kind of motion by a few logarithms of amplitudes, each compared with the next."""
    steps = np.diff(logs)
    if len(logs) < 2 or np.ptp(logs) <= STEADY:
        return "periodic" if len(logs) > 1 else "irregular"
    if np.all(steps > 0.0):
        return "growing"
    return "decaying" if np.all(steps < 0.0) else "irregular"


def _one_way(time: np.ndarray, value: np.ndarray, rate: np.ndarray) -> str:
    """Kind of a motion that goes one way, by the last third of the run against the third before; of others unknown.

    Swings that are not a whole cycle are too few to be compared: of a run that blew up they may be of any size.
    """
    least = TURNS * float(np.abs(rate).max())
    if rate.min() < -least and rate.max() > least:
        return "not determined"
    kind = "irregular"
    if len(time) > 3:
        edges = time[0] + (time[-1] - time[0]) * np.array([1.0, 2.0, 3.0]) / 3.0
        before, after = np.abs(np.diff(Trace(time, value, rate)(edges)[0]))
        if abs(after - before) > STEADY * max(after, before):
            kind = "growing" if after > before else "decaying"
    return kind


def _without_cycles(
    time: np.ndarray, position: np.ndarray, velocity: np.ndarray, late: np.ndarray, direction: np.ndarray
) -> LimitCycle:
    """What can be said of a motion that holds no whole cycle."""
    kind = _one_way(time, position @ direction, velocity @ direction)
    place, note = position[late], "no whole cycle: the run is too short, or this is no oscillation"
    motion = place - place.mean(axis=0)
    direction, _, normal = directions(motion)
    size = math.sqrt(float((motion**2).sum(axis=1).mean()))
    return LimitCycle(
        kind=kind,
        settled=False,
        mean=place.mean(axis=0),
        start=float(time[late][0]),
        end=float(time[-1]),
        note=note,
        amplitude=0.5 * float(np.ptp(motion @ direction)),
        axis_amplitude=0.5 * np.ptp(place, axis=0),
        direction=direction,
        normal=normal,
        out_of_plane=math.sqrt(float(((motion @ normal) ** 2).mean())) / size if size > 0.0 else 0.0,
        max_speed=float(np.linalg.norm(velocity[late], axis=1).max()),
    )
