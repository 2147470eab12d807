"""The next seconds: a copy of the simulation runs ahead, with inputs that go on as they are going.

It runs in pieces, so that a sample that arrives meanwhile is answered first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.twin.map.plan import Alarm

if TYPE_CHECKING:
    from tautline.live.memory import State
    from tautline.live.simulation import Simulation

PIECES = 20
"""Pieces that the time ahead is looked at in, at least."""
LONGEST = 0.25
"""Longest of them, s."""
TRIES = 7
"""Runs that a largest speed, or a largest heave, is looked for with."""
LARGEST = 4.0
"""Times the present speed, or heave, beyond which it is not looked for."""
START_UP = 1.0
"""Time in which another speed is taken up, s."""
EARLY = 1e-6
"""By how much a time may be later than what the scene knows, s: rounding of stamps."""
SCENE_ENDS = "SCENE_ENDS"
"""What stops a run ahead where the scene moves something by itself, and no further is known."""


@dataclass
class Found:
    """What a run ahead came to.

    Attributes
    ----------
    begun : float
        Time of the data that it began at, s.
    first : dict
        Name of an alarm -> how long ahead its bound is passed, s, and the value there.
    stopped : (float, str) or None
        How long ahead the simulation cannot go on, s, and why.
    beyond : dict
        Name of an alarm -> of every time at which its bound is passed how long ahead it is, s, and the value there.
    parameters : mapping
        Parameters that it was begun with.
    known : bool
        Whether the estimate that these are of was known then.
    """

    begun: float
    first: dict[str, tuple[float, float]] = field(default_factory=dict)
    stopped: tuple[float, str] | None = None
    beyond: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    known: bool = True

    @property
    def good(self) -> bool:
        """Whether no bound is passed."""
        return not self.first and self.stopped is None

    def coming(self, name: str, after: float) -> list[tuple[float, float]]:
        """Times, s, later than one at which the bound of an alarm is passed, and the values there, in order."""
        told = ((self.begun + ahead, value) for ahead, value in self.beyond.get(name, ()))
        return [one for one in told if one[0] > after]


class Forecast:
    """Runs a simulation ahead.

    Parameters
    ----------
    sim : Simulation
        A copy that is nobody else's.
    bounds : sequence of Alarm
        Bounds on outputs, with how far ahead each is looked for.
    ahead : float
        s.
    """

    def __init__(self, sim: Simulation, bounds: Sequence[Alarm], ahead: float) -> None:
        self.sim, self.bounds = sim, list(bounds)
        self.ahead = ahead
        n = max(PIECES, int(np.ceil(ahead / LONGEST)))
        self.times = ahead * np.arange(1, n + 1) / n

    def run(
        self, begun: float, state: State, parameters: Mapping[str, float], paths: Mapping[str, np.ndarray],
        bounds: Sequence[Alarm] | None = None, times: np.ndarray | None = None, judged_after: float = 0.0,
    ) -> Iterator[None]:  # fmt: skip
        """Run ahead; after every piece it can be left. The last is kept in `found`.

        Parameters
        ----------
        paths : mapping
            Input -> value, rate and second rate (n, 3) at `times`.
        times : (n,), optional
            Other times than `times`, at which bounds count however far ahead they are looked for.
        judged_after : float
            Time ahead from which on bounds count, s.
        """
        plain = bounds is None
        bounds = self.bounds if bounds is None else bounds
        self.found = Found(begun, parameters=dict(parameters))
        sim = self.sim
        sim.restore(state)
        for name, value in parameters.items():
            sim.parameters[name] = value
        begin = sim.time
        for i, after in enumerate(self.times if times is None else times):
            if begin + after > sim.known_until[0] + EARLY:
                if plain:  # other runs look for how far one can go: the end of the scene is no danger to them
                    self.found.stopped = (float(after), SCENE_ENDS)
                return
            for name, path in paths.items():
                sim.inputs[name] = sim.inputs.within(name, path[i])
            try:
                sim.advance_heard(begin + after, None)
            except StoppedEarly as error:
                self.found.stopped = (float(after), error.status.name)
                return
            for one in bounds:
                too_far = times is None and after > one.ahead + 1e-9
                if too_far or after < judged_after:
                    continue
                value = extreme(sim[one.target], one)
                if value > one.above or value < one.below:
                    self.found.first.setdefault(one.name, (float(after), value))
                    self.found.beyond.setdefault(one.name, []).append((float(after), value))
            yield

    def largest(
        self, begun: float, state: State, parameters: Mapping[str, float], paths: Any, bounds: Sequence[Alarm],
        times: np.ndarray | None = None, judged_after: float = 0.0,
    ) -> Iterator[None]:  # fmt: skip
        """Look for the largest factor of a motion with which no bound is passed; it is kept in `factor`.

        Parameters
        ----------
        paths : callable
            Factor -> paths of all inputs, as of `run`.
        """
        self.factor, self.limited_by = np.nan, ""
        low, high = 0.0, LARGEST
        for attempt in range(TRIES):
            factor = (0.0, LARGEST)[attempt] if attempt < 2 else 0.5 * (low + high)
            for _ in self.run(begun, state, parameters, paths(factor), bounds, times, judged_after):
                yield
                if self.found.first:
                    break
            if self.found.good:
                low = factor
                if attempt == 1:
                    break
            else:
                high = factor
                self.limited_by = next(iter(self.found.first), "") or (self.found.stopped or (0.0, ""))[1]
                if attempt == 0:
                    self.factor = 0.0
                    return
        self.factor = low


def extreme(value: Any, bound: Alarm) -> float:
    """Of an output the number that a bound is about: the largest of an array, or the smallest."""
    return float(np.max(value) if np.isfinite(bound.above) else np.min(value))


def other_speed(state: np.ndarray, times: np.ndarray, speed: float) -> np.ndarray:
    """Path (n, 3) of an input that takes up another speed smoothly, within `START_UP`."""
    share = np.clip(times / START_UP, 0.0, 1.0)
    v0, dv = state[1], speed - state[1]
    s, ds = share**2 * (3.0 - 2.0 * share), 6.0 * share * (1.0 - share) / START_UP
    travelled = START_UP * (share**3 - 0.5 * share**4) + np.maximum(times - START_UP, 0.0)
    return np.stack([state[0] + v0 * times + dv * travelled, v0 + dv * s, dv * ds], axis=-1)
