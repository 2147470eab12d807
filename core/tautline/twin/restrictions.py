"""What is ahead: whether a bound will be passed as things go on, and with which speeds and waves none would be."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tautline.twin.forecast import Forecast, Found, other_speed
from tautline.twin.map.plan import Plan
from tautline.twin.pace import ONE_STAMP
from tautline.twin.signals.smoothing import joined
from tautline.twin.signals.waves import Waves

if TYPE_CHECKING:
    from tautline.live.memory import State

FRESH = 3.0
"""Forecasts that an answer of one holds good for."""
RESTRICT_EVERY = 2.0
"""How often the largest speed and heave are looked for, s."""
REPLAYED, PIECE, INTO = 18.0, 0.125, 6.0
"""How much of the ship's motion is gone through once more, larger or smaller, in what pieces, and how long it takes to
go over into it, s: so slowly that the load does not bounce by that."""

JOINED, NO_FASTER = 0.5, 2.0
"""Share of the time ahead in which an input that is caught up with comes to where its sensor says, at the soonest, and
the largest speed at which it does, SI."""

Estimated = Callable[[], "tuple[State, dict[str, float], bool]"]
"""The state and the parameters of the estimate, and whether it is known, when they are asked for."""


@dataclass
class Departure:
    """Where a run ahead begins.

    Attributes
    ----------
    time : float
        Of the data, s.
    inputs : mapping
        Input -> value, rate and second rate (3,).
    state, parameters, known
        Of the estimate, and whether it is known.
    paths : mapping
        Input -> value, rate and second rate (n, 3) ahead.
    restricts : bool
        Whether it has come to look for restrictions.
    """

    time: float
    inputs: Mapping[str, np.ndarray]
    state: State
    parameters: Mapping[str, float]
    known: bool
    paths: Mapping[str, np.ndarray]
    restricts: bool = False


class Outlook:
    """Runs ahead from time to time, piece by piece, while no row waits.

    Parameters
    ----------
    plan : Plan
        How far, how often, and whether restrictions are looked for.
    waves : mapping
        Input that moves with a ship -> its waves.
    estimated : callable
        Gives state and parameters of the estimate, and whether it is known.

    Attributes
    ----------
    forecast : Forecast or None
        Of the simulation as it is; None where nothing is to be foreseen.
    found : Found or None
        What the last run ahead came to.
    restricted : list of dict
        The largest hoisting speed and ship motion without a bound that is passed.
    """

    def __init__(self, plan: Plan, waves: Mapping[str, Waves], estimated: Estimated) -> None:
        self.plan, self.waves, self.estimated = plan, waves, estimated
        self.forecast: Forecast | None = None
        self.found: Found | None = None
        self.restricted: list[dict[str, Any]] = []
        self._job: Iterator[None] | None = None
        self._under_way: Departure | None = None
        self._due: tuple[float, Mapping[str, np.ndarray]] | None = None
        self._shown: Mapping[str, np.ndarray] = {}
        self._next_forecast = self._next_restrict = -np.inf
        self._waiting, self._begun = np.inf, False

    def foresee(
        self, time: float, inputs: Mapping[str, np.ndarray], shown: Mapping[str, np.ndarray] | None = None
    ) -> None:
        """Begin a run ahead from a row with its inputs (3,), where one is due.

        Parameters
        ----------
        shown : mapping, optional
            Inputs that the simulation is behind with -> the states (3,) that their sensors show.
        """
        if self.forecast is None or self._under_way is not None:
            return
        if self._due is None:
            if time < self._next_forecast - ONE_STAMP:
                return
            self._next_forecast = time + self.plan.forecast_every
        # Rows may come before there is time for it: then it begins from the last of them, where the simulation stands.
        self._due, self._shown = (time, inputs), shown or {}
        if np.isinf(self._waiting):
            self._waiting, self._begun = time, False

    def work(self, seconds: float | None = None) -> bool:
        """Look ahead for at most so many seconds, or to the end; whether something is left."""
        self._begun = True
        end = np.inf if seconds is None else clock.perf_counter() + seconds
        while (self._under_way is not None or self._due is not None) and clock.perf_counter() < end:
            if self._under_way is None and self._due is not None and self.forecast is not None:
                self._under_way, self._due = self._departure(self.forecast, *self._due, self._shown), None
            if self._job is None and self._under_way is not None and self.forecast is not None:
                self._job = self._run(self.forecast, self._under_way)
            try:
                next(self._job or iter(()))
            except StopIteration:
                self._job, self._under_way, self._waiting = None, None, np.inf
        return self._under_way is not None or self._due is not None

    def drop(self, found: Found | None = None) -> None:
        """Leave what is under way: the machine is not where it was. What is known of the time ahead is `found`."""
        self._job = self._under_way = self._due = None
        self.found, self._waiting = found, np.inf

    @property
    def _good_for(self) -> float:
        """For how long an answer holds good, s."""
        return FRESH * self.plan.forecast_every

    def is_overdue(self, time: float) -> bool:
        """Whether a run ahead was given time, and is not done for longer than its answer would hold good.

        Rows may be answered many at once, between which it is given none, and who never gives it any asks for nothing.
        """
        return self._begun and time - self._waiting > self._good_for

    def fresh(self, time: float) -> Found | None:
        """What was found, if that is not too long ago."""
        found = self.found
        return found if found is not None and time - found.begun <= self._good_for else None

    def __getstate__(self) -> dict[str, Any]:
        """What a copy has: a run ahead that is under way begins once more there, from where it began."""
        return vars(self) | {"_job": None}

    def _departure(
        self, forecast: Forecast, time: float, inputs: Mapping[str, np.ndarray], shown: Mapping[str, np.ndarray]
    ) -> Departure:
        """Where a run ahead begins now."""
        state, parameters, known = self.estimated()
        paths = self._paths(forecast, inputs)
        # Where the machine is, and how fast, is known before the simulation stands there.
        for name in shown.keys() - self.waves.keys():
            paths[name] = caught_up(inputs[name], shown[name], forecast.times)
        return Departure(time, inputs, state, parameters, known, paths)

    def _run(self, forecast: Forecast, begin: Departure) -> Iterator[None]:
        time, state, parameters = begin.time, begin.state, begin.parameters
        yield from forecast.run(time, state, parameters, begin.paths)
        self.found = replace(forecast.found, known=begin.known)
        if begin.restricts or (forecast.bounds and self.plan.restrict and time >= self._next_restrict - ONE_STAMP):
            begin.restricts = True  # also where it is begun once more
            self._next_restrict = time + RESTRICT_EVERY
            yield from self._restrictions(forecast, time, state, parameters, begin.inputs)

    def _paths(
        self, forecast: Forecast, inputs: Mapping[str, np.ndarray], winch: float | None = None
    ) -> dict[str, Any]:
        """Paths of all inputs ahead, with another speed of winches where one is given."""
        times = forecast.times
        paths = {}
        for name, state in inputs.items():
            if name in self.waves:
                paths[name] = self.waves[name].ahead(times)
            elif winch is not None and name.endswith(".pay_out"):
                paths[name] = other_speed(state, times, winch)
            else:
                paths[name] = other_speed(state, times, state[1])
        return paths

    def _replayed(self, inputs: Mapping[str, np.ndarray], times: np.ndarray, factor: float) -> dict[str, Any]:
        """The same with the ship's motion of the last seconds once more, so many times as large."""
        return {
            name: self.waves[name].replayed(times, REPLAYED, factor, INTO)
            if name in self.waves
            else other_speed(state, times, state[1])
            for name, state in inputs.items()
        }

    def _restrictions(
        self, forecast: Forecast, time: float, state: State, parameters: Mapping[str, float],
        inputs: Mapping[str, np.ndarray],
    ) -> Iterator[None]:  # fmt: skip
        """The largest hoisting speed and the largest heave with which no bound that is watched ahead is passed."""
        found = []
        winch = next((name for name in inputs if name.endswith(".pay_out")), None)
        if winch is not None:
            now = abs(float(inputs[winch][1]))
            unit_speed = max(now, 0.25)
            yield from forecast.largest(
                time, state, parameters, lambda f: self._paths(forecast, inputs, -f * unit_speed), forecast.bounds
            )
            found.append(_restriction(forecast, "hoisting speed", forecast.factor * unit_speed, now, "m/s"))
        moved = [self.waves[name] for name in inputs if name in self.waves]
        if moved and all(one.lasting(REPLAYED) for one in moved):
            times = np.arange(PIECE, REPLAYED + 1e-9, PIECE)
            yield from forecast.largest(
                time, state, parameters, lambda f: self._replayed(inputs, times, f), forecast.bounds, times, INTO
            )
            found.append(_restriction(forecast, "ship motion", forecast.factor, 1.0, ""))
        self.restricted = found


def caught_up(state: np.ndarray, shown: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Path (n, 3) of an input that goes on as its sensor shows (3,), and joins it from where it stands (3,)."""
    apart = state - shown
    over = max(JOINED * float(times[-1]), 1.875 * abs(float(apart[0])) / NO_FASTER)
    return other_speed(shown, times, shown[1]) + np.array([joined(apart, t / over, over) for t in times])


def _restriction(forecast: Forecast, name: str, most: float, now: float, unit: str) -> dict[str, Any]:
    """What stands in a line of the twin of the largest motion that was found."""
    free = not forecast.limited_by
    by = f", then {forecast.limited_by}" if not free else ""
    at_least = "at least " if free else ""
    most_said = f"{most:.3g} {unit}".strip() if unit else f"{most:.2g} times the present"
    return {
        "name": name,
        "largest": most,
        "now": now,
        "unit": unit,
        "restrict": most < now - 1e-9,
        "by": forecast.limited_by,
        "text": f"{name} at most {at_least}{most_said}{by}",
    }
