"""Inputs: functions of time that are written while a simulation goes on.

What is given is reached at the end of the next advance. The way there is a polynomial with the value, the rate and the
second rate that the function has now, so that nothing jumps; but see `_carried`. The rates at its end are those given
beside the value. Else they are chosen by what was given before:

- Where values go on smoothly, rates are those of the cubic through the last four values. They go on smoothly where the
  last two second differences are nearly alike, or the last two third differences: near a turning point of the motion
  the former are, near an inflection the latter. Of commands in notches and of noise they are so by chance; the third
  difference is large then, beside the move and the second difference.
- Else the rate is the harmonic mean of the slopes of this advance and of the last, and zero where these differ in sign
  (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 1984), and the second rate is zero: a value that is given
  once is come to rest at, and a jump from rest is not overshot.
- A value that is held is come to rest at within the length of the last advance, however long this one is.

A value that is not given again counts as given again: the slope of an advance in which nothing moves is zero, and what
was before it is forgotten. A way of which an advance was left in the middle, on Ctrl-C, is gone on with; by an advance
that goes beyond its end what was given is come to rest at, at the end of that.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite, nan
from typing import Any

import numpy as np

from tautline.kernels.time_function import DEGREES, TimeFunctions, value_at
from tautline.live.errors import SimulationError, Unpickled, real, shown, unknown
from tautline.live.turn import Turn
from tautline.system.handles import Input

TARGET, RATE, SECOND, SLOPE, STATE, LENGTH, BEFORE, BEND, TWIST, CHOSEN = range(10)
COLUMNS = 10
"""Columns of the memory of an input: value, rate and second rate to be reached (NaN: to be chosen), slope of the last
advance (NaN: none was given yet), one of the following, lengths of the last advance and of that before it, s, and the
second and the third divided difference of the values that were given last (NaN: too few since it was at rest), and 1
where the second rate that it has was chosen, or `TAKEN_OVER`."""
PAST = slice(LENGTH, TWIST + 1)
AS_WRITTEN, AT_REST, MOVING, GIVEN = 0.0, 1.0, 2.0, 3.0
"""As the scene has it; at its value, at rest; at its value, moving; given anew, to be reached in the next advance."""
TAKEN_OVER = 2.0
"""What stands where an input of a place, whose second rate was chosen, left what a rate drives now."""
PIECES = 3
POWERS = np.arange(DEGREES)
SECOND_POWERS = POWERS[2:] * POWERS[1:-1]
"""Powers of a way's terms, and the factors of their second derivatives."""
ROUNDING = 1e-14
"""Share of a time within which an advance ends where a way does, of a value within which it is given again, and within
which its differences are rounding."""
NOT_SMOOTH = 0.0, 0.0, 0.0
"""Where a cubic through the last values has no share in the rates."""
HELD = 1e-6
"""A move that is this share of the last is rounding, of a host in single precision: a value is held but for that."""
ALIKE, UNLIKE = 2.0 / 3.0, 1.0 / 3.0
"""Ratios of two differences, the smaller to the greater: from the first on values go on smoothly, up to the second not.

Of a sine all values go on smoothly down to sixteen a period, some down to seven; of noise three in four differences
differ in sign from the last.
"""
GENTLE, ROUGH = 0.4, 0.7
"""Ratios of the third difference to the greatest of the last two moves and the second difference: up to the first
values go on smoothly, from the second on not.

Of a sine with sixteen values a period it is a tenth at most, of commands in three notches two thirds or more.
"""
MUCH_LONGER = 4.0
"""Times the last advance, beyond which less of a second rate that was chosen is carried on."""


class Inputs(Unpickled, Mapping[str, Any]):
    """The inputs of a simulation: ``sim.inputs["winch.pay_out"] = 0.12``, or ``= (value, rate)``.

    Parameters
    ----------
    inputs : dict of str to Input
    functions : TimeFunctions
        Of the scene; the tracks of inputs are written in place.
    clock : callable
        -> the simulation's time, s.
    turn : Turn
        Taken where one is read or given.
    """

    def __init__(self, inputs: dict[str, Input], functions: TimeFunctions, clock: Any, turn: Turn) -> None:
        self._inputs, self._functions, self._clock, self._turn = inputs, functions, clock, turn
        self._numbers = {name: k for k, name in enumerate(inputs)}
        self._list = list(inputs.values())
        self._rivals = _rivals_of(self._list)
        self.memory = np.zeros((len(inputs), COLUMNS))
        self.memory[:, SLOPE] = self.memory[:, PAST] = np.nan
        self._active: set[int] = set()

    def __iter__(self) -> Iterator[str]:
        return iter(self._inputs)

    def __len__(self) -> int:
        return len(self._inputs)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (name in self._inputs or bool(self._vector(name)))

    def _vector(self, name: object) -> list[str]:
        """Names of the components of a vector, in their order; none of any other name."""
        if not isinstance(name, str) or name in self._numbers:
            return []
        return [part for part in self._numbers if part.startswith(f"{name}[")]

    def _number(self, name: str) -> int:
        try:
            return self._numbers[name]
        except (KeyError, TypeError):  # a list is no name either
            cure = "what the scene holds still has to be named in Simulation(..., inputs=[...])"
            raise unknown("input", name, self._inputs, cure) from None

    def __getitem__(self, name: str) -> Any:
        """What the input is now, or is to be at the end of the next advance: a float; of a vector an array (n,)."""
        parts = [self._number(part) for part in self._vector(name)]
        k = -1 if parts else self._number(name)
        self._turn.read()
        try:
            return np.array([self._read(part) for part in parts]) if parts else self._read(k)
        finally:
            self._turn.lock.release()

    def _read(self, k: int) -> float:
        """What an input is now, or is to be."""
        if self.memory[k, STATE] == GIVEN:
            return float(self.memory[k, TARGET])
        steering, function = self._list[k].members[0]
        return self._now(function)[steering.order] / steering.factor

    def motion(self, name: str) -> tuple[float, float, float]:
        """What an input is, as reading it gives, and the rate and second rate that it has now."""
        k = self._number(name)
        steering, function = self._list[k].members[0]
        _, rate, second = (*self._now(function)[steering.order :], 0.0, 0.0)[:3]
        return self._read(k), rate / steering.factor, second / steering.factor

    def _now(self, function: int) -> tuple[float, float, float]:
        return value_at(self._functions, function, self._clock())

    def __setitem__(self, name: str, value: Any) -> None:
        """Give a value, or (value, rate) or (value, rate, second rate), to be reached at the end of the next advance.

        Raises
        ------
        UnknownName
            For a name that is none of the inputs.
        SimulationError
            For what is no finite number, or beyond what may be given; and beside another input that drives the same
            and was given since the last advance; and while another thread advances the simulation.
        """
        self._turn.give()
        try:
            self._give(name, value)
        finally:
            self._turn.lock.release()

    def _give(self, name: str, value: Any) -> None:
        if self._vector(name):
            self._set_vector(name, value)
            return
        k = self._number(name)
        given = self._checked(k, name, value)
        if self._rivals[k]:
            self._take_over(k, name)
        row = self.memory[k]
        row[TARGET] = given[0]
        row[RATE] = given[1] if len(given) > 1 else np.nan
        row[SECOND] = given[2] if len(given) > 2 else np.nan
        row[STATE] = GIVEN
        self._active.add(k)

    @property
    def driven(self) -> list[str]:
        """Names of inputs that a value was given to."""
        return [name for name, state in zip(self._inputs, self.memory[:, STATE], strict=True) if state != AS_WRITTEN]

    def rivals(self, name: str) -> list[str]:
        """Names of other inputs that drive the same, as a winch's speed and its place do; raises UnknownName."""
        names = list(self._inputs)
        return [names[other] for part in self.parts_of(name) for other in self._rivals[self._numbers[part]]]

    def _take_over(self, k: int, name: str) -> None:
        """Let an input drive what another has driven until now; refuse both in one advance, where one would be lost."""
        names = list(self._inputs)
        for other in self._rivals[k]:
            if self.memory[other, STATE] == GIVEN:
                place, _ = sorted((k, other), key=lambda one: self._list[one].steering.order)
                cause = f"{name} and {names[other]} drive the same, and both are given for one advance"
                cure = f"give one of them, or {names[place]} = (value, rate)"
                raise SimulationError(cause, cure if self._list[place].steering.order == 0 else "give one of them")
        for other in self._rivals[k]:
            if self.memory[other, CHOSEN] and self._list[other].steering.order == 0:
                # Of values close together the second rate may be noise: it fades in a longer advance here, too.
                self.memory[k, CHOSEN], self.memory[k, LENGTH] = TAKEN_OVER, self.memory[other, LENGTH]
            self.memory[other, CHOSEN] = 0.0
            # It would come to rest where it was to go. What it knows of its last advance is old when it is next given.
            self.memory[other, SLOPE] = self.memory[other, PAST] = np.nan
            if self.memory[other, STATE] != AS_WRITTEN:
                self.memory[other, STATE] = AT_REST
            self._active.discard(other)

    def checked(self, name: str, value: Any) -> None:
        """Refuse what cannot be given to an input, as giving it does; nothing is changed."""
        self._checked(self._number(name), name, value)

    def within(self, name: str, state: Sequence[float] | np.ndarray) -> tuple[float, ...]:
        """A value and its rates as an input may have them: what is measured lies beyond its bounds by its noise."""
        steering = self._list[self._number(name)].steering
        value, *rates = (float(x) for x in state)
        held = min(max(value, steering.least), steering.most)
        return (value, *rates) if held == value or not isfinite(value) else (held, *(0.0 for _ in rates))

    def _checked(self, k: int, name: str, value: Any) -> tuple[float, ...]:
        """What is given, as one to three numbers."""
        given: tuple[float, ...]
        try:
            if type(value) is float:
                given = (value,)
            else:
                given = tuple(real(x, "number", "") for x in (value if _is_row(value) else (value,)))
        except (SimulationError, ValueError):  # of lists of several lengths numpy knows no dimension
            given = ()
        if not 1 <= len(given) <= 3 or not isfinite(sum(given)):
            unit = self._list[k].steering.unit
            cause = f"{name} = {shown(value)} is neither a finite number nor two or three of them"
            raise SimulationError(cause, f"give a value in {unit or 'SI'}, or (value, rate) or (value, rate, second)")
        steering = self._list[k].steering
        if not steering.least <= given[0] <= steering.most:
            bounds = f"from {steering.least:g} to {steering.most:g}"
            bounds = f"{steering.least:g} or more" if steering.most == inf else bounds
            cause = f"{name} = {given[0]:g} is not {bounds}"
            raise SimulationError(cause, f"it is {steering.text}")
        return given

    def _set_vector(self, name: str, value: Any) -> None:
        """Give all components of a vector."""
        before = self.memory.copy(), set(self._active)
        try:
            for part, x in self._components(name, value):
                self._give(part, x)
        except SimulationError:
            self.memory[:], self._active = before
            raise

    def _components(self, name: str, value: Any) -> list[tuple[str, Any]]:
        """Names and values of the components of a vector; of a number its own."""
        parts = self.parts_of(name)
        if parts == [name]:
            return [(name, value)]
        if not _is_row(value) or len(value) != len(parts):
            raise SimulationError(f"{name} = {value!r} is no vector", f"give {len(parts)} numbers")
        return list(zip(parts, value, strict=True))

    def begin_all(self, values: Mapping[str, Any]) -> None:
        """Hold several inputs at values from now on, as `begin` does, whose errors it raises."""
        for name, value in values.items():
            self.begin(name, value)

    def begin(self, name: str, value: Any) -> None:
        """Hold an input at a value from now on, until another is given: at once, so before the start is found.

        Raises
        ------
        UnknownName
            For a name that is none of the inputs.
        SimulationError
            For what is no finite number, or beyond what may be given; and for a place other than 0 that is counted from
            the start.
        """
        for part, x in self._components(name, value):
            k = self._number(part)
            given = self._checked(k, part, x)
            if len(given) > 1:
                raise SimulationError(f"{part} = {x!r} is no single number", "give one number to be held")
            if self._list[k].steering.zero_at_start and given[0] != 0.0:
                cause = f"{part} = {given[0]:g} cannot be at the start: it is counted from there"
                raise SimulationError(cause, "give 0 for the start, and the place later; or give the speed")
            for steering, function in self._list[k].members:
                stands = steering.factor * given[0]
                now = self._now(function)[0] if steering.order else stands
                self.hold(function, self._clock(), np.array([now, stands if steering.order else 0.0, 0.0]))
            for other in self._rivals[k]:
                if self.memory[other, STATE] != AS_WRITTEN:
                    raise SimulationError(f"{part} and {list(self._inputs)[other]} drive the same", "give one of them")
            self.memory[k, SLOPE], self.memory[k, STATE] = 0.0, AT_REST

    def describe(self) -> dict[str, dict[str, Any]]:
        """Unit, shape and meaning of every input."""
        return {
            name: {"unit": one.steering.unit, "shape": (), "text": one.steering.text}
            for name, one in self._inputs.items()
        }

    def handle(self, name: str) -> Input:
        """What is known of an input; raises UnknownName."""
        return self._list[self._number(name)]

    def parts_of(self, name: str) -> list[str]:
        """Names of the components of a vector, ``load.force``, or the name of a number; raises UnknownName."""
        if parts := self._vector(name):
            return parts
        self._number(name)
        return [name]

    def steers(self, function: int) -> bool:
        """Whether a function goes by what was given for it, from the next advance on at the latest."""
        if self._functions.track_from[function] == self._functions.live[function]:
            return True
        return any(function == number for k in self._active for _, number in self._list[k].members)

    def hold(self, function: int, time: float, values: np.ndarray) -> None:
        """Give a function a value, a rate and a second rate at a time, s."""
        way = np.zeros(DEGREES)
        way[:3] = values[0], values[1], 0.5 * values[2]
        self._lay(function, time, time + 1.0, way)
        self._functions.frames.time[0] = np.nan

    def recalled(self) -> None:
        """Take notice that the memory was written from outside."""
        states, slopes = self.memory[:, STATE], self.memory[:, SLOPE]
        self._active = {
            k
            for k in range(len(self._list))
            if states[k] in (GIVEN, MOVING) or (states[k] == AT_REST and isfinite(slopes[k]) and slopes[k] != 0.0)
        }

    def write(self, begin: float, end: float) -> None:
        """Write the way of every input that has one from one time, s, to another."""
        if not self._active:
            return
        for k in tuple(self._active):
            row = self.memory[k]
            if row[STATE] != GIVEN:
                until = self._way_end(k)
                if begin < until and end <= until * (1.0 + ROUNDING):
                    continue  # the last advance was left in its middle: what it had for it goes on
                if row[STATE] == AT_REST:
                    self._rest(k, row, begin, end)
                    continue
                # It stays at what was given before, and comes to rest there.
                row[RATE], row[SECOND], row[STATE] = 0.0, 0.0, GIVEN
                self._write(k, row, begin, end, held=True)
                continue
            self._write(k, row, begin, end)
        self._functions.frames.time[0] = np.nan

    def _rest(self, k: int, row: np.ndarray, begin: float, end: float) -> None:
        """Keep the slope that an input at rest has in an advance without a new value: zero, but for the end of a way.

        The next value would else be taken for one that goes on from the way of before the rest.
        """
        row[PAST] = np.nan
        if begin >= self._way_end(k) * (1.0 - ROUNDING):
            row[SLOPE] = 0.0
            self._active.discard(k)
        else:
            steering, function = self._list[k].members[0]
            row[SLOPE] = (row[TARGET] - self._now(function)[steering.order] / steering.factor) / (end - begin)

    def _way_end(self, k: int) -> float:
        """When the way that was written last for an input ends, s."""
        f, function = self._functions, self._list[k].members[0][1]
        return float(f.breaks[f.break_from[f.live[function]] + 1])

    def _write(self, k: int, row: np.ndarray, begin: float, end: float, held: bool = False) -> None:
        """Write the ways of all functions that an input drives; one is held that was not given again."""
        h, members = end - begin, self._list[k].members
        steering, function = members[0]
        now = self._now(function)
        # Plain floats take a third of the time of an array's.
        target, rate, second, last, _, *past, was_chosen = row.tolist()
        if begin < self._way_end(k) * (1.0 - ROUNDING):
            past = [nan] * 4  # the last advance did not come to the value that was given for it
        moved = target - now[steering.order] / steering.factor
        slope = 0.0 if abs(moved) <= ROUNDING * abs(target) or abs(moved) <= HELD * abs(last) * h else moved / h
        # What the scene itself has moved goes on from its rate.
        before = last if isfinite(last) else now[steering.order + 1] / steering.factor
        carried = _carried(h, past[0]) if was_chosen else 1.0
        taken_over = was_chosen == TAKEN_OVER
        length = past[0]
        if taken_over:
            past = [nan] * 4
        row[CHOSEN] = not isfinite(second)
        smooth, past = _gone_on(h, slope, last, past, ROUNDING * abs(target))
        held |= not isfinite(rate)
        rate, second = _chosen(rate, second, _between(before, slope), smooth)
        at_end = target, rate, second
        stops = held and slope == rate == second == 0.0 and length < h
        if stops:
            # What is held stops as soon as it went: in all of a longer advance it would go far beyond.
            h, end, carried = length, begin + length, 1.0
        for i, (steering, function) in enumerate(members):
            f = self._now(function) if i else now
            g = [steering.factor * x for x in at_end]
            # A rate that is integrated has one order less to be smooth in.
            if steering.order == 0:
                way = _quintic(h, (f[0], f[1], carried * f[2]), g)
            else:
                way = _integrated_cubic(h, (f[0], f[1], carried * f[2] if taken_over else f[2]), g)
            # The rates of what has stopped are exact: those of a polynomial's end have a rounding, which would go on.
            rates = (g[1:] if steering.order == 0 else g[:2]) if stops else None
            self._lay(function, begin, end, way, rates)
        row[SLOPE], row[PAST] = slope, past
        moving = rate != 0.0 or second != 0.0
        row[STATE] = MOVING if moving else AT_REST
        if not moving and slope == 0.0:
            self._active.discard(k)

    def _lay(
        self, function: int, begin: float, end: float, way: np.ndarray, rates: Sequence[float] | None = None
    ) -> None:
        """Write a polynomial into the function's own track, and what it goes on with after its end: the rates there."""
        f = self._functions
        track = int(f.live[function])
        first = int(f.break_from[track])
        piece = first + track
        f.breaks[first], f.breaks[first + 1] = begin, end
        f.origins[piece : piece + PIECES] = begin, begin, end
        rows = f.coefficients[piece : piece + PIECES]
        rows[:] = 0.0
        rows[0, 0], rows[1] = way[0], way
        # The rate at the end goes on, so that what looks beyond it by rounding sees no jump.
        powers = (end - begin) ** POWERS
        rows[2, 0] = way @ powers
        of_way = way[1:] @ (POWERS[1:] * powers[:-1]), way[2:] @ (SECOND_POWERS * powers[:-2])
        rate, second = of_way if rates is None else rates
        rows[2, 1], rows[2, 2] = rate, 0.5 * second
        f.track_from[function], f.track_to[function] = track, track + 1
        f.wave_to[function] = f.wave_from[function]

    def arrays(self) -> list[np.ndarray]:
        """All that an input writes, to be saved with the simulation's state."""
        f = self._functions
        tracks = f.live[f.live >= 0]
        if not tracks.size:
            return [self.memory]
        # The tracks of inputs stand one after another behind all others.
        first, last = int(f.break_from[tracks[0]]), int(f.break_from[tracks[-1] + 1])
        piece = slice(first + int(tracks[0]), last + int(tracks[-1]) + 1)
        parts = [f.track_from, f.track_to, f.wave_to, f.breaks[first:last], f.origins[piece], f.coefficients[piece]]
        return [self.memory, *parts]


def _is_row(value: Any) -> bool:
    """Whether a value is several in a row."""
    return isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim > 0)


def _rivals_of(inputs: Sequence[Input]) -> list[list[int]]:
    """For each input the numbers of others that drive a function that it drives."""
    driven = [{function for _, function in one.members} for one in inputs]
    return [[j for j, b in enumerate(driven) if j != i and a & b] for i, a in enumerate(driven)]


def _between(before: float, after: float) -> float:
    """Slope at a value between two slopes: their harmonic mean, zero where they differ in sign."""
    return 2.0 * before * after / (before + after) if before * after > 0.0 else 0.0


def _chosen(rate: float, second: float, between: float, smooth: tuple[float, float, float]) -> tuple[float, float]:
    """Rates at the end of a way, of which those that are NaN were not given."""
    share, smooth_rate, smooth_second = smooth
    if not isfinite(second):
        second = share * smooth_second
    return rate if isfinite(rate) else between + share * (smooth_rate - between), second


def _carried(h: float, length: float) -> float:
    """Share of a chosen second rate that an advance of h seconds begins with, behind one of another length, s.

    Of values with noise it is noise over the square of the last length. An advance that is much longer would be carried
    away by it, with the square of its own length: no farther than one of `MUCH_LONGER` times the last. The acceleration
    jumps there.
    """
    return (MUCH_LONGER * length / h) ** 2 if h > MUCH_LONGER * length else 1.0


def _gone_on(
    h: float, slope: float, last: float, past: Sequence[float], rounding: float
) -> tuple[tuple[float, float, float], list[float]]:
    """How values go on, and the memory of them after an advance of h seconds.

    Parameters
    ----------
    h, slope : float
        Of this advance.
    last : float
        Slope of the last.
    past : (4,)
        What is remembered: `LENGTH`, `BEFORE`, `BEND`, `TWIST`.
    rounding : float
        Differences of values up to this say nothing.

    Returns
    -------
    smooth : (3,)
        Share, from 0 to 1, that a cubic through the last four values has in the rates at the end; and its rates there.
    past : (4,)
    """
    if slope == 0.0:
        return NOT_SMOOTH, [nan] * 4
    length, before, bend, twist = past
    two = h + length
    new_bend = (slope - last) / two
    new_twist = (new_bend - bend) / (two + before)
    now = [h, length, new_bend, new_twist]
    # Differences of values over the length of these advances.
    move, second, third = max(abs(slope), abs(last)) * h, abs(new_bend) * h * two, abs(new_twist) * h * two * two
    if not isfinite(twist) or max(second, third) <= rounding:
        return NOT_SMOOTH, now
    gentle = _falling(third / max(move, second), GENTLE, ROUGH)
    share = gentle * max(_alike(bend, new_bend), _alike(twist, new_twist))
    if share == 0.0:
        return NOT_SMOOTH, now
    # Newton's form with the knots 0, -h, -two at its end.
    rate = slope + h * (new_bend + two * new_twist)
    return (share, rate, 2.0 * (new_bend + (h + two) * new_twist)), now


def _alike(a: float, b: float) -> float:
    """How far two differences are alike, from 0 to 1."""
    if not a * b > 0.0:
        return 0.0
    a, b = abs(a), abs(b)
    return 1.0 - _falling(min(a, b) / max(a, b), UNLIKE, ALIKE)


def _falling(x: float, first: float, last: float) -> float:
    """One up to the first number, zero from the last on, and straight between."""
    return min(max((last - x) / (last - first), 0.0), 1.0)


def _quintic(h: float, f: Sequence[float], g: Sequence[float]) -> np.ndarray:
    """Coefficients (8,) of the quintic with value, rate and second rate ``f`` at 0 and ``g`` at h."""
    d = g[0] - f[0] - h * (f[1] + 0.5 * h * f[2])
    e = h * (g[1] - f[1] - h * f[2])
    s = 0.5 * h * h * (g[2] - f[2])
    way = np.zeros(DEGREES)
    way[:6] = (
        f[0], f[1], 0.5 * f[2], (10.0 * d - 4.0 * e + s) / h**3, (-15.0 * d + 7.0 * e - 2.0 * s) / h**4,
        (6.0 * d - 3.0 * e + s) / h**5,
    )  # fmt: skip
    return way


def _integrated_cubic(h: float, f: Sequence[float], g: Sequence[float]) -> np.ndarray:
    """The same of a function whose rate is given: its rate is the cubic from f[1], f[2] to g[0], g[1]."""
    change = g[0] - f[1]
    b = (3.0 * change / h - 2.0 * f[2] - g[1]) / h
    c = (f[2] + g[1] - 2.0 * change / h) / h**2
    way = np.zeros(DEGREES)
    way[:5] = f[0], f[1], 0.5 * f[2], b / 3.0, c / 4.0
    return way
