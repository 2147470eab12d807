"""Active heave compensation: rope paid out as the tip rises, by an actuator of limited stroke, speed and acceleration.

The tip's heave is prescribed, and so is the actuator's answer: it is computed before the run and is a function of time
like any other. The actuator is a mass point with a command, ``gain`` times the heave of ``delay`` ago. It *is* at its
command until that asks for more than a limit allows; then it leaves it, early enough to brake before the end of its
stroke, does what it can, and joins it again with its speed and acceleration. Steps are short beside the waves. Away
from the command the acceleration is linear over a step, so that limits can be kept to between steps as well as at
them: a step is only taken to where full braking would still keep within all limits.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from crane.sea.content import Content, content_of, sampled
from crane.sea.frames import with_grace
from tautline.kernels.time_function import sample
from tautline.scene.functions import Constant
from tautline.system.time_functions import (
    FrameEntry,
    FrameLift,
    FunctionRequest,
    Samples,
    all_requests,
    compile_functions,
    reach_of,
)

PHASE = 0.02
"""Phase of the heave that a step spans, about, rad."""
LONGEST_STEP = 0.5
"""Of the actuator's motion, s."""
MOST_STEPS = 1_000_000
AHEAD = 2.0
"""Periods of the heave by which the command is looked at beyond the end: what comes then decides the braking before."""
AMPLE = 10.0
"""Acceleration of an actuator without a limit of it, in those of its command."""
BRAKING = 0.8
"""Share of the acceleration that is counted upon for braking before the end of the stroke."""
GENTLE = 0.05
"""Least share that is counted upon for joining the command. The rest is for the command's own acceleration: an actuator
that has too little of it, and chases its command with all it has, swings past it and is worse than none."""
SPARE = 0.5
"""Share counted upon of what is not needed to follow the command, up to what is."""
JOLT = 1.5
"""Most by which the acceleration may differ from the command's while it is joined, in those counted upon for that."""
SOFT = 5.0
"""Steps over which the approach to a command or to an end of the stroke dies away."""
EAGER = 3.0
"""Steps over which a speed is brought to what is wanted."""
PARTS = 8
"""Parts of a step at which the command is held against the limits."""
CLOSE = 1.0e-9
"""Departure from the command, as a share of its size, that counts as none; and what is kept free of a limit."""


class Limits(Protocol):
    """What an actuator can do: stroke either way from its middle m, speed m/s, acceleration m/s^2; None: anything."""

    @property
    def stroke(self) -> float | None:
        """Largest displacement, m."""

    @property
    def speed(self) -> float | None:
        """Largest speed, m/s."""

    @property
    def acceleration(self) -> float | None:
        """Largest acceleration, m/s^2."""


@dataclass(frozen=True, eq=False)
class Compensation:
    """What the actuator does in a run.

    Attributes
    ----------
    pay_out : Samples, Constant or FrameLift
        Unstretched rope that it has paid out since t = 0, m; it is added to the operator's.
    place : Samples, Constant or FrameLift
        Its displacement from the middle of its stroke, m: `pay_out` and where it was at t = 0.
    away : float
        Share of the run during which it is not where it is commanded to be.
    met : dict of str to float
        Share of the run during which each limit (``stroke``, ``speed``, ``acceleration``) holds it back; of two at
        once the narrower counts. The rest of `away` it spends returning to its command.
    error : float
        Farthest that it is from its command, m.
    sudden : bool
        Whether its command jumps in speed or acceleration: a heave that moves already at t = 0 is answered late.
    made_with : str
        What it was computed with, where it was computed ahead: another run goes on with it if that is the same.
    """

    pay_out: Samples | Constant | FrameLift
    place: Samples | Constant | FrameLift
    away: float
    met: dict[str, float]
    error: float
    sudden: bool = False
    made_with: str = ""


def compensate(
    heave: Samples | FrameLift | Constant,
    gain: float,
    delay: float,
    limits: Limits,
    end: float,
    step: float | None = None,
) -> Compensation:
    """Follow a tip's heave with an actuator.

    Parameters
    ----------
    heave : Samples, FrameLift or Constant
        Height of the tip, m, above where it is with the vessel at rest; before t = 0 it is what it is then.
    gain : float
        Rope paid out per metre that the tip rises.
    delay : float
        Age of the heave that is answered, s.
    limits : Limits
        Of the actuator.
    end : float
        Time to which the run goes, s.
    step : float, optional
        Of the actuator's motion, s; by default so that the heave turns by about 0.02 rad in one. It is a power of
        two of a second, found from the heave alone: runs that end at other times have the same motion.

    Returns
    -------
    Compensation
    """
    stroke, speed, most = (
        math.inf if limit is None else (1.0 - CLOSE) * float(limit)
        for limit in (limits.stroke, limits.speed, limits.acceleration)
    )
    requests = [FunctionRequest(heave, end=end)]
    functions, reach = compile_functions(requests), min(map(reach_of, all_requests(requests)))
    content = content_of(functions, reach, end)
    h = step or _step(content, end)
    if gain == 0.0 or h == 0.0 or min(stroke, speed, most) == 0.0:
        return _still(content, gain)
    n = max(2, math.ceil(end / h))
    ahead = min(end + AHEAD * content.period, reach)
    time = h * np.arange(max(n, math.floor(ahead / h)) + 1)
    command = _Command(gain * sampled(functions, time - delay).T, time, abs(gain) * content.size)
    first = gain * sampled(functions, np.zeros(1))[0]
    command.look_for_jump(first, delay)
    moved, cause = _Actuator(command, stroke, speed, most).run()
    time, moved, cause = time[: n + 1], moved[:, : n + 1], cause[:n]
    knots, derivatives = with_grace(time, moved)
    k = int(delay / h)
    if k < n and time[k] < delay < time[k + 1] and cause[k] == FREE:
        # The heave is first answered within a step: it begins there, and not before.
        knots, derivatives = np.insert(knots, k + 1, delay), np.insert(derivatives, k + 1, first, axis=1)
    heaves = ", ".join(f"{x:.6g}" for x in content.size)
    return Compensation(
        pay_out=Samples(knots, derivatives[0] - derivatives[0, 0], derivatives[1], derivatives[2], reach=end),
        place=Samples(knots, derivatives[0], derivatives[1], derivatives[2], reach=end),
        away=float(np.mean(cause >= 0)),
        met={name: float(np.mean(cause == i)) for i, name in enumerate(("stroke", "speed", "acceleration"))},
        error=float(np.abs(moved[0] - command.derivatives[0, : n + 1]).max()),
        sudden=bool(command.sudden[:n].any()),
        made_with=f"steps of {h:.9g} s; heave, its speed and acceleration up to {heaves}",
    )


def unlimited(
    requests: Sequence[FunctionRequest], frame: int, vessel: int, point: Sequence[float], asked: Any
) -> Compensation | None:
    """What an actuator does that has no limit: at its command always, a function of the frames' places.

    None where it has a limit, and where it would have to begin with a jump: the heave has a speed at t = 0 and is
    answered late. Nothing is computed ahead, however long the run is.

    Parameters
    ----------
    requests : sequence of FunctionRequest
        The functions of the frames.
    frame, vessel : int
        Numbers of the frame that the tip rides on, and of the vessel.
    point : sequence of 3 float
        Where the tip is drawn, m.
    asked : heave compensation of a scene
        With ``gain``, ``delay`` and ``limits``.
    """
    limits = asked.limits
    found = lift_of(requests, frame, vessel, point)
    if isinstance(found, Constant) or any(x is not None for x in (limits.stroke, limits.speed, limits.acceleration)):
        return None
    lift = replace(found, gain=asked.gain, delay=asked.delay)
    begins = sample(compile_functions([FunctionRequest(replace(lift, delay=0.0))]), 0, np.zeros(1))[0]
    if asked.delay > 0.0 and np.any(begins[1:] != 0.0):
        return None
    free = {"stroke": 0.0, "speed": 0.0, "acceleration": 0.0}
    return Compensation(replace(lift, offset=-float(begins[0])), lift, 0.0, free, 0.0)


def lift_of(
    requests: Sequence[FunctionRequest], frame: int, vessel: int, point: Sequence[float]
) -> FrameLift | Constant:
    """How far the vessel's motion lifts a point of a frame, m: a function of the frames' places at any time.

    Parameters
    ----------
    requests : sequence of FunctionRequest
        The functions of the frames.
    frame, vessel : int
        Numbers of the frame that the point rides on, and of the vessel.
    point : sequence of 3 float
        Where it is drawn, m.
    """
    sets = [r.model.frames for r in requests if isinstance(r.model, FrameEntry)]
    if not sets:
        return Constant(value=0.0)
    x, y, z = (float(c) for c in point)
    return FrameLift(sets[0], frame, vessel, (x, y, z), 1.0, 0.0)


def _still(content: Content, gain: float) -> Compensation:
    """What an actuator does that cannot move, or has nothing to do."""
    rest = Constant(value=0.0)
    error = abs(gain) * float(content.size[0]) if np.any(content.size[1:]) else 0.0
    moves = error > 0.0
    return Compensation(rest, rest, float(moves), {"stroke": 0.0, "speed": 0.0, "acceleration": 0.0}, error)


def _step(content: Content, end: float) -> float:
    """Step that resolves the heave, a power of two of a second; 0 where there is none."""
    _, fastest, sharpest = content.size
    if sharpest == 0.0:
        return 0.0 if fastest == 0.0 else LONGEST_STEP
    h = 2.0 ** round(math.log2(min(PHASE * fastest / sharpest, LONGEST_STEP)))
    return h * 2.0 ** max(0, math.ceil(math.log2(end / (h * MOST_STEPS))))


class _Command:
    """Where the actuator should be: `derivatives` (3, n + 1) at the ends of the steps, and how far it goes within each.

    `reach` (3, n) is the largest displacement, speed and acceleration within each step, `size` (3,) what they are by
    the heave as a whole; `sudden` (n,) says in which step the speed jumps: where a heave that begins with a speed is
    first answered.
    """

    def __init__(self, derivatives: np.ndarray, time: np.ndarray, size: np.ndarray) -> None:
        self.derivatives, self.time, self.h = derivatives, time, float(time[1] - time[0])
        self.size = np.maximum(size, 1e-300)
        functions = compile_functions([FunctionRequest(Samples(time, *derivatives))])
        inside = np.linspace(0.0, 1.0, PARTS + 1)
        inside[-1] = np.nextafter(1.0, 0.0)
        fine = np.abs(sample(functions, 0, (time[:-1, None] + self.h * inside).ravel()))
        fine = fine.reshape(time.size - 1, PARTS + 1, 3)
        # after the last of the times all is held, and the time of the last look may be rounded to it
        fine[-1, -1] = np.abs(derivatives[:, -1])
        # a crest between two samples rises above them by an eighth of the second difference there
        crest = np.abs(np.diff(fine, n=2, axis=1)).max(axis=1) / 4.0
        self.reach = (fine.max(axis=1) + crest).T
        self.sudden = np.zeros(time.size - 1, dtype=bool)

    def look_for_jump(self, first: np.ndarray, delay: float) -> None:
        """Find the step in which a command with `first` (3,) at its begin is first answered, `delay` s late."""
        near = CLOSE * self.h
        if delay > 0.0 and np.any(np.abs(first[1:]) > CLOSE * self.size[1:]):
            self.sudden = (self.time[:-1] <= delay + near) & (self.time[1:] >= delay - near)


class _State(NamedTuple):
    """Displacement, speed and acceleration."""

    y: float
    v: float
    a: float

    def mirrored(self) -> _State:
        return _State(-self.y, -self.v, -self.a)

    def after(self, a: float, h: float) -> _State:
        """State after a step over which the acceleration goes to `a` in a straight line."""
        y = self.y + h * self.v + h * h * (2.0 * self.a + a) / 6.0
        return _State(y, self.v + 0.5 * h * (self.a + a), a)


FREE, STROKE, SPEED, ACCELERATION, RETURNING = -1, 0, 1, 2, 3


class _Actuator:
    """An actuator on its way through a run; limits may be infinite."""

    def __init__(self, command: _Command, stroke: float, speed: float, most: float) -> None:
        self.command, self.h = command, command.h
        self.stroke, self.speed, self.most = stroke, speed, most
        # what it uses while away from its command: no more than a few steps can resolve
        used = min(most, AMPLE * float(command.size[2]), 0.2 * speed / self.h, 0.02 * stroke / self.h**2)
        self.used, self.braking = used, BRAKING * used
        needed = float(command.size[2])
        self.joining = max(GENTLE * used, min(SPARE * (used - needed), needed))
        over = (command.reach[0] > stroke) | (command.reach[1] > speed) | (command.reach[2] > most) | command.sudden
        self.over = np.flatnonzero(over)

    def run(self) -> tuple[np.ndarray, np.ndarray]:
        """Displacement, speed and acceleration (3, n + 1), and what holds it back in each step (n,)."""
        derivatives = self.command.derivatives
        n = derivatives.shape[1] - 1
        moved, cause = np.empty((3, n + 1)), np.full(n, FREE)
        state, k = self._start(), 0
        moved[:, 0] = state
        while k < n:
            if self._is_at(state, k):
                leave = self._leaves(k)
                if leave > k:
                    moved[:, k : leave + 1] = derivatives[:, k : leave + 1]
                    state, k = _State(*derivatives[:, leave]), leave
                    continue
            way = self._joining(state, k)
            if way is not None:
                moved[:, k + 1 : k + 1 + len(way)] = np.array(way).T
                cause[k : k + len(way)] = RETURNING
                # on it by construction; not by rounding, which would keep it from being recognised
                k += len(way)
                moved[:, k] = derivatives[:, k]
                state = _State(*derivatives[:, k])
                continue
            state, cause[k] = self._limited(state, k)
            k += 1
            moved[:, k] = state
        return moved, cause

    def _start(self) -> _State:
        """State at t = 0: on the command if it can be, else at rest, within the stroke."""
        state = _State(*self.command.derivatives[:, 0])
        if not self.over.size or (self.over[0] > 0 and (self._leaves(0) > 0 or self._brakes_in_time(state))):
            return state
        return _State(float(np.clip(state.y, -0.99 * self.stroke, 0.99 * self.stroke)), 0.0, 0.0)

    def _is_at(self, state: _State, k: int) -> bool:
        return bool(np.all(np.abs(np.array(state) - self.command.derivatives[:, k]) <= CLOSE * self.command.size))

    def _leaves(self, k: int) -> int:
        """Step at whose beginning the command is left: the last from which the limit ahead can be respected."""
        ahead = np.searchsorted(self.over, k)
        if ahead == self.over.size:
            return self.command.derivatives.shape[1] - 1
        leave = int(self.over[ahead])
        while leave > k and not self._brakes_in_time(_State(*self.command.derivatives[:, leave])):
            leave -= 1
        return leave

    def _brakes_in_time(self, state: _State) -> bool:
        """Whether what is counted upon for braking keeps it within its limits from here on, either way and smoothly."""
        return abs(state.a) <= self.most and all(
            s.v + EAGER * self.h * max(s.a, 0.0) <= self.speed
            and self._broken(s, s.after(-self.braking, self.h), self.braking) == FREE
            for s in (state, state.mirrored())
        )

    def _broken(self, before: _State, state: _State, braking: float) -> int:
        """Upper limit that is broken in the step from `before` to `state`, or by braking after it; `FREE` for none."""
        stop = state.after(-braking, self.h)
        most_y, most_v = -math.inf, -math.inf
        for left, right in ((before, state), (state, stop)):
            y, v = _crest(left, right, self.h)
            most_y, most_v = max(most_y, y), max(most_v, v)
        if stop.v > 0.0:
            most_y = max(most_y, stop.y + 0.5 * stop.v**2 / braking)
        if most_y > self.stroke:
            return STROKE
        return SPEED if most_v > self.speed else FREE

    def _joining(self, state: _State, k: int) -> list[_State] | None:
        """States of a way back on to the command that keeps to all limits, in 3, 6 or 12 steps; None if none does."""
        derivatives = self.command.derivatives
        for n in (1, 2, 4):
            goal = k + 3 * n
            if goal >= derivatives.shape[1] - 1:
                return None
            ahead = np.searchsorted(self.over, goal)
            if ahead < self.over.size and self.over[ahead] <= goal + 3:
                continue
            y, v, a = derivatives[:, goal]
            long = n * self.h
            p = (v - state.v) / long - 0.5 * (state.a + a)
            q = (y - state.y - 3.0 * long * state.v) / long**2 - 4.0 / 3.0 * state.a - a / 6.0
            bends = (q - p, 2.0 * p - q, float(a))
            jolt = max(abs(bend - a) for bend in (state.a, *bends))
            if (
                jolt <= JOLT * self.joining
                and max(map(abs, bends)) <= self.most
                and self._brakes_in_time(_State(y, v, a))
            ):
                way = self._way(state, bends, n)
                if way is not None:
                    return way
        return None

    def _way(self, state: _State, bends: tuple[float, ...], n: int) -> list[_State] | None:
        """States of a way along which the acceleration goes to each of `bends` in n steps; None if it breaks limits."""
        way = [state]
        for bend in bends:
            begin = way[-1].a
            way += [state := state.after(begin + (bend - begin) * (i + 1) / n, self.h) for i in range(n)]
        for left, right in itertools.pairwise(way):
            for before, after in ((left, right), (left.mirrored(), right.mirrored())):
                y, v = _crest(before, after, self.h)
                if y > self.stroke or v > self.speed:
                    return None
        return way[1:]

    def _limited(self, state: _State, k: int) -> tuple[_State, int]:
        """State after a step towards the command that a limit may cut short, and which limit does."""
        wanted, cause = self._wanted(state, k)
        a = min(max(wanted, -self.used), self.used)
        if a != wanted:
            cause = ACCELERATION
        a, above = self._cut(state, a)
        a, below = self._cut(state.mirrored(), -a)
        broken = max(above, below)
        return state.after(-a, self.h), broken if cause == RETURNING and broken != FREE else cause

    def _wanted(self, state: _State, k: int) -> tuple[float, int]:
        """Acceleration that brings it to its command, or smoothly to a limit in its way, and which limit that is."""
        y, v, a = self.command.derivatives[:, k]
        soon = EAGER * self.h
        closing, slope = self._closing(y - state.y, self.joining)
        wanted, cause = a + slope * (v - state.v) + (v + closing - state.v) / soon, RETURNING
        for sign in (1.0, -1.0):
            most = (self.speed - sign * state.v) / soon
            if sign * wanted > most:
                wanted, cause = sign * most, SPEED
            if math.isfinite(self.stroke):
                room, slope = self._closing(self.stroke - sign * state.y, self.braking)
                most = (room - sign * state.v) / soon - slope * sign * state.v
                if sign * wanted > most:
                    wanted, cause = sign * most, STROKE
        return wanted, cause

    def _closing(self, distance: float, braking: float) -> tuple[float, float]:
        """Speed at which a distance can be closed by braking, softly at the last, and its slope over the distance."""
        soft = SOFT * braking * self.h
        root = math.sqrt(soft * soft + 2.0 * braking * abs(distance))
        if root == 0.0:  # the command does not move: there is nothing to close, or to close it with
            return 0.0, 0.0
        return math.copysign(root - soft, distance), braking / root

    def _cut(self, state: _State, a: float) -> tuple[float, int]:
        """Acceleration at the end of the step, lowered until full braking keeps the upper limits, and which cut it."""
        broken = self._broken(state, state.after(a, self.h), self.used)
        if broken == FREE:
            return a, FREE
        low, high = -self.used, a
        for _ in range(30):
            middle = 0.5 * (low + high)
            if self._broken(state, state.after(middle, self.h), self.used) == FREE:
                low = middle
            else:
                high = middle
        return low, broken


def _crest(left: _State, right: _State, h: float) -> tuple[float, float]:
    """Largest displacement and speed over a step with an acceleration that is linear in it."""
    most_y, most_v = max(left.y, right.y), max(left.v, right.v)
    jerk = (right.a - left.a) / h
    if left.a > 0.0 > right.a:
        most_v = max(most_v, left.v - 0.5 * left.a**2 / jerk)
    for t in _roots(left.v, left.a, 0.5 * jerk):
        if 0.0 < t < h:
            most_y = max(most_y, left.y + t * (left.v + t * (0.5 * left.a + t * jerk / 6.0)))
    return most_y, most_v


def _roots(c: float, b: float, a: float) -> tuple[float, ...]:
    """Real roots of ``a t^2 + b t + c``, without loss of digits."""
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return ()
    q = -0.5 * (b + math.copysign(math.sqrt(square), b))
    return tuple(above / below for above, below in ((q, a), (c, q)) if below != 0.0)
