"""Choosing the method and the step of a run whose accuracy is asked for, and telling what was reached.

A scene is run with steps that grow shorter, from the interval of its frames on: with three times as many, and then with
as many as the estimated error needs, so that the third run should be the last. Two runs show no order: their difference
is taken as of a method of second order, or of first for a force and where dry friction may act, with a safety factor of
two (of RK4 1.25). Three runs show one (the grid convergence index of Roache, see `tautline.study.trials.step_error`),
of a force and with friction too where their differences have one shape (`tautline.study.accuracy.shape`).
The run is taken as soon as its error is no more than what was asked for. Where dry friction may act, the runs have to
agree in position far better than that, or the estimate before has to be near: steps may miss alike which contact slips
first. Where the implicit method would need far more steps than an explicit one needs to be stable, that is taken,
without friction.

The error is the largest of what can be seen: of the point and the force that `study` looks at, and of a string's twist.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tautline.finer_frames import FinerFrames
from tautline.integrators.schedule import frame_times
from tautline.integrators.status import Status, StoppedEarly
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.content import frequencies
from tautline.scene.errors import option_error
from tautline.scene.limits import without_limits
from tautline.scene.methods import explicit_like, implicit_like, method_of
from tautline.simulation import Afterwards, simulate
from tautline.study.accuracy.grid import critical_at_start
from tautline.study.accuracy.shape import order_of_one_shape
from tautline.study.trials.between_frames import FINER, INTERVAL, BetweenFrames, between_frames, room_for
from tautline.study.trials.errors import apart, ends_apart, motion, twist_apart
from tautline.study.trials.history import History, Watched, watch
from tautline.study.trials.history import forces as all_forces
from tautline.study.trials.step_error import (
    SAFETY,
    StepError,
    at_common_times,
    from_longer,
    of_twist,
)
from tautline.study.trials.trial import Setting, Subject
from tautline.system.model import Model

COARSEST = 1.0
"""Steps in an interval of the frames that the first run takes at least."""
STEPS_PER_PERIOD = 5.0
"""Steps that it takes at least in a period of the fastest function of time of the scene."""
FEWEST_STEPS = 20.0
"""Steps that it takes at least in all."""
LOWEST, LOWEST_WITH_FRICTION = 1.0, 0.5
"""Lowest orders that count."""
ORDER, ORDER_WITH_FRICTION, FORCE_ORDER = 2.0, 1.5, 1.0
"""Highest orders that count: of the implicit methods, where friction may act, and of a force, whose errors change sign
and then seem to fall too fast."""
FIRST = 3.0
"""How many times as many steps the second run takes: so many tell the first order from none, and cost little."""
EXPECTED, EXPECTED_WITH_FRICTION = 1.5, 1.2
"""Orders by which the next run is expected to be better, from the estimate of the last: without friction or where it
decides nothing, and where it may. They are low ones, for a run that just misses what was asked for costs another."""
LEAST, MOST, MOST_OF_FORCE = 2.0, 8.0, 4.0
"""How many times as many steps the next run takes at least, at most, and at most where the force alone needs them:
three runs near to each other show its order. Two whose steps are nearer than twice tell less of an error: with 1.5
times as many, some scenes took two more runs in place of one."""
SAFETY_OF_TWO = 2.0
"""Factor of safety of an estimate from two runs; Roache takes three, with the order of the method."""
UNLIKE, ALIKE = 0.5, 0.3
"""Differences of two runs, relative: from which they have nothing in common, and up to which they tell of an order. The
error is taken to be no less than a larger one: two runs of a chaotic motion differ by as much with any step."""
MOST_OF_TWO = 8.0
"""Ratio of steps that two runs may count on at most: their order is not known."""
AFTER_STOP = 4.0
"""How many times as many steps the next run takes after one that stopped early."""
ASKED_AFTER = 2
"""Runs after which the critical step of the explicit method is looked for."""
EXPLICIT_GAIN = 20.0
"""Steps of the implicit method, over those that the explicit one is stable with, from which the latter is tried: its
two runs take 2.5 times those steps, and one of them the time of eight implicit ones."""
EXPLICIT_SHARE, EXPLICIT_RATIO = 0.8, 1.5
"""Share of the critical step that the first explicit run takes, and steps of the second over those of the first."""
CALM = 0.3
"""Share of the error asked for below which errors of position and twist show that friction decides nothing here."""
NEAR = 3.0
"""Times the error asked for that the estimate before the last may be, where friction may have made the last small by
chance; where extremes of a force alone agree it is no more than was asked for."""
UNLIKELY = 3.0
"""Times the difference of its extremes that two histories of a force may be apart, root mean square, over its range."""
FAILURES, RUNS = 5, 14
"""Runs that may stop early, and runs in all."""
STALLED = 0.7
"""Share of the estimated error of the run before the last above which it does not fall any more."""
PATIENCE = 2
"""Runs in which it may do so."""
SECONDS, STEPS = 3600.0, 1.0e8
"""Processor time, s, that all runs may take, and steps of one."""
KINDS = ("position", "force", "twist")
NONE = np.zeros((0, 0))
"""The forces of a scene without any, and of runs that nothing is compared with any more."""
COMPARED = 3
"""Runs that are compared: the last ones."""
NEAR_TWO = 1.7
"""Order over times from which three runs with dry friction have no error of a slip in them."""
NOT_LOOKED = "what happens between the stored frames is not known: to look there was interrupted"
"""The warning of a run that Ctrl-C reached as it was compared with its frames in between."""
SURE = 0.9
"""Share of an order that is shown over times, by which the next run is expected to be better."""


class Seen(NamedTuple):
    """What of a run is compared.

    Attributes
    ----------
    history : History
        The path of the point, the force that varies most, and a string's twist.
    forces : ndarray, shape (m, n)
        All forces of the kind, N, at the times of the frames; empty where a scene has none.
    """

    history: History
    forces: np.ndarray = NONE


class Made(NamedTuple):
    """A run: its method, steps in an interval of the frames, step s, number of steps, and processor time s.

    ``seen`` is None and ``why`` says why where it stopped early.
    """

    method: str
    divisor: float
    step: float
    steps: int
    cpu: float
    seen: Seen | None
    why: str = ""


@dataclass
class Choice:
    """What is known while method and step are chosen.

    Attributes
    ----------
    asked : float
        The relative error asked for.
    interval, end : float
        Of the frames and of the run, s.
    friction : bool
        Whether dry friction may act.
    explicit : float
        Steps in an interval with which the explicit method is stable; infinite where it is not tried.
    made : list of Made
        The runs, and ``estimates`` the largest estimated error of each, infinite where there is none.
    watched : Watched or None
        What is looked at, known from the first run on: the point of the first run, and the force of the last, for
        long steps do not show which force varies most.
    why : str
        Why no more accurate run is made, where that is not because the accuracy is reached.
    between : BetweenFrames or None
        What the frames of the last run do not show; None where a frame holds one step, nothing moves, or frames between
        them would take too much room.
    not_looked : bool
        Whether Ctrl-C cut that short.
    """

    asked: float
    interval: float
    end: float
    friction: bool
    explicit: float = math.inf
    made: list[Made] = field(default_factory=list)
    estimates: list[float] = field(default_factory=list)
    watched: Watched | None = None
    why: str = ""
    between: BetweenFrames | None = None
    not_looked: bool = False

    def rehearsed(self, method: str, divisor: float) -> bool:
        """Whether a run with these steps only serves to find the next: it need not be stored."""
        still = self.watched is not None and not self.watched.moves
        return divisor < 1.0 or (not still and not self._like(method))

    def take(self, method: str, divisor: float, result: Result) -> None:
        """Take note of a run that came to its end."""
        seen = None
        try:
            latest = watch(result)
            known = self.watched or latest
            self.watched = known._replace(force=latest.force, force_said=latest.force_said)
            seen = look_at(result, self.watched)
        except ResultError as error:
            self.why = error.cause
        for i in [i for i, run in enumerate(self.made) if run.seen is not None][: 1 - COMPARED]:
            self.made[i] = _without_forces(self.made[i])
        step = self.interval / divisor
        cpu = float(result.attributes.get("cpu_time", 0.0))
        self.made.append(Made(method, divisor, step, round(self.end / step), cpu, seen))
        found = [*self.errors().values()]
        self.estimates.append(max(found) if found and all(map(math.isfinite, found)) else math.inf)

    def fail(self, method: str, divisor: float, why: str, cpu: float = 0.0) -> tuple[str, float] | None:
        """Take note of a run that stopped early after some processor time, s; returns what `following` does, None where
        too many have."""
        if self.made and self.made[-1].divisor == divisor and self.made[-1].method == method:
            self.forget()  # It came to its end, and its energy does not balance.
        self.made.append(Made(method, divisor, self.interval / divisor, 0, cpu, None, why))
        self.estimates.append(math.inf)
        if sum(run.seen is None for run in self.made) >= FAILURES:
            return None
        following = finer(AFTER_STOP * divisor)
        return None if self._reason_to_end(following) else (method, following)

    def forget(self) -> None:
        """Let go of the last run, which is made again."""
        self.made.pop()
        self.estimates.pop()
        self.why = ""

    def errors(self, careful: bool = True) -> dict[str, float]:
        """Estimated errors of the last run by kind, relative; empty where there is none to compare it with.

        ``careful`` ones are no less than a large difference of the last two runs; the next step follows from others.
        """
        found, orders = {}, self._orders_shown()
        for kind in KINDS:
            pairs = self._pairs(kind)
            shown = [self._changes(coarse, fine).get(kind) for coarse, fine in pairs]
            known = [change for change in shown if change is not None]
            if known and len(known) == len(pairs):
                # The first of three may have nothing in common with two others that agree.
                known = known[:1] if known[-1] > UNLIKE and known[0] <= ALIKE else known
                ratios = [fine.divisor / coarse.divisor for coarse, fine in pairs]
                error = self._error(known, ratios, kind, orders.get(kind))
                found[kind] = max(error, known[0]) if careful and known[0] > ALIKE else error
        return found

    @property
    def met(self) -> bool | None:
        """Whether the last run is known to be as accurate as was asked; None where there is nothing to judge."""
        if self.watched is None or not self.watched.moves:
            return None
        last = self.made[-1]
        runs = len(self._like(last.method))
        if last.seen is None or runs < 2 or not self.estimates[-1] <= self.asked:
            return False
        # Which contact slips first may be missed by some steps alike: one small estimate may be chance. So may extremes
        # of a force be alike in two runs that have little else in common, and the estimate before may be one of these.
        chance = self._by_chance
        certain = (not self.friction or self._calm) and not chance
        near = (1.0 if chance else NEAR) * self.asked
        return certain or (runs > 2 and self.estimates[-2] <= near)

    @property
    def _by_chance(self) -> bool:
        """Whether the last two runs agree in the extremes of the force alone, and not in how it goes between them."""
        pairs = self._pairs("force")
        found = [_between(coarse.seen, fine.seen) for coarse, fine in pairs if coarse.seen and fine.seen]
        between = [difference for difference in found if difference is not None]
        if not between or len(between) < len(pairs):
            return False
        # What the history of the last run is off by. Three show an order, which is that of positions: nothing changes
        # its sign. Two show none.
        ratios = [fine.divisor / coarse.divisor for coarse, fine in pairs]
        kind = "position" if len(pairs) > 1 else "force"
        error = self._error(between, ratios, kind, self._orders_shown().get("force"))
        return error > self.asked and between[0] > UNLIKELY * self._changes(*pairs[0]).get("force", math.inf)

    @property
    def _calm(self) -> bool:
        """Whether the last two runs agree so well in what moves that friction decides nothing there."""
        return all(error <= CALM * self.asked for kind, error in self.errors().items() if kind != "force")

    def following(self) -> tuple[str, float] | None:
        """Method, and steps in an interval, of the next run; None where the last one is to stand."""
        last = self.made[-1]
        if self.met is not False or self.why:
            return None
        if len(self._like(last.method)) > 1 and not math.isfinite(self.estimates[-1]) and last.seen is not None:
            self.why = "the runs with other steps have no frames at the same times"
            return None
        method, divisor = last.method, self._next_divisor()
        if not method_of(method).explicit and divisor > EXPLICIT_GAIN * self.explicit:
            method, divisor = explicit_like(method), math.ceil(self.explicit)
        self.why = self._reason_to_end(divisor)
        return None if self.why else (method, divisor)

    def record(self) -> dict[str, Any]:
        """What is stored with the result and printed by ``--json``."""
        last, errors = self.made[-1], self.errors()
        spent = sum(run.cpu for run in self.made)
        return {
            "asked": self.asked,
            "met": self.met,
            "reached": max(errors.values()) if errors else None,
            **{kind: errors.get(kind) for kind in KINDS},
            "method": last.method,
            "step": last.step,
            "why": self.why,
            "cost": spent / last.cpu if last.cpu > 0.0 else None,
            "between_frames": self.between is not None,
            "runs": [
                {
                    "method": run.method, "step": run.step, "steps": run.steps, "cpu_time": run.cpu,
                    "estimate": estimate if math.isfinite(estimate) else None, "stopped": run.why or None,
                }
                for run, estimate in zip(self.made, self.estimates, strict=True)
            ],
        }  # fmt: skip

    @property
    def warning(self) -> str | None:
        """What a reader should know where the accuracy is not reached."""
        if self.met:
            return None
        asked = f"{100.0 * self.asked:.3g} %"
        if self.met is None:
            why = self.why or "nothing moves"
            return f"an accuracy of {asked} was asked for, and there is nothing to judge it by: {why}"
        errors = self.errors()
        known = f"the estimate is {100.0 * max(errors.values()):.2g} %" if errors else "nothing is known of the error"
        if errors and max(errors.values()) <= self.asked:
            known += ", which may be chance,"
        return (
            f"an accuracy of {asked} was asked for and is not reached: {known} with {self.made[-1].method} and steps "
            f"of {self.made[-1].step:.3g} s. {self.why[:1].upper()}{self.why[1:]}"
        )

    def _like(self, method: str) -> list[Made]:
        return [run for run in self.made if run.method == method and run.seen is not None]

    def _pairs(self, kind: str) -> list[tuple[Made, Made]]:
        """The last run of those that came to their end with the one before, and that with the one before it.

        A run with steps longer than the interval of the frames has not all of them. It shows no extremes.
        """
        if not self.made or self.made[-1].seen is None:
            return []
        runs = self._like(self.made[-1].method)[-COMPARED:]
        pairs = list(itertools.pairwise(runs))[::-1]
        return [pair for pair in pairs if kind == "position" or pair[0].divisor >= 1.0]

    def _changes(self, coarse: Made, fine: Made) -> dict[str, float]:
        assert coarse.seen is not None and fine.seen is not None and self.watched is not None
        force = self.watched.force
        return changes(coarse.seen, fine.seen, self.watched.extent, force.column if force is not None else None)

    def _orders_shown(self) -> dict[str, float]:
        """The orders by which the last three runs converge over time, by kind, of those that show one.

        Where dry friction may act none counts unless all of motion and force are near two: what slips too late is an
        error of a lower order, and a slip that three runs miss alike is in none of their differences.
        """
        runs = self._like(self.made[-1].method)[-COMPARED:]
        if len(runs) < COMPARED or self.made[-1].seen is None:
            return {}
        first, second, third = (run.divisor for run in runs)
        found: dict[str, float] = {}
        for kind in KINDS:
            histories = [_over_time(run.seen, kind, self.watched) for run in runs if run.seen is not None]
            known = [history for history in histories if history is not None]
            order = order_of_one_shape(known, (third / second, second / first)) if len(known) == COMPARED else None
            if order is not None:
                found[kind] = order
            elif known and kind != "twist" and self.friction:
                return {}
        return {} if self.friction and min(found.values(), default=0.0) < NEAR_TWO else found

    def _error(self, shown: list[float], ratios: list[float], kind: str, order: float | None) -> float:
        if len(shown) > 1 and order is not None:
            return from_longer(shown, ratios, order, order)
        if len(shown) == 1:
            # Two runs show no order. That of the explicit method is higher than the one taken here.
            safety = SAFETY if method_of(self.made[-1].method).explicit else SAFETY_OF_TWO
            return safety * shown[0] / (min(ratios[0], MOST_OF_TWO) ** self._order_of_two(kind) - 1.0)
        return from_longer(shown, ratios, self._highest(kind), self._lowest(kind))

    def _order_of_two(self, kind: str) -> float:
        return 1.0 if self.friction or kind == "force" else ORDER

    def _lowest(self, kind: str) -> float:
        return LOWEST_WITH_FRICTION if self.friction and kind != "force" else LOWEST

    def _highest(self, kind: str) -> float:
        if kind == "force":
            return FORCE_ORDER
        return ORDER_WITH_FRICTION if self.friction else ORDER

    def _next_divisor(self) -> float:
        last = self.made[-1]
        if method_of(last.method).explicit:
            return math.ceil(EXPLICIT_RATIO * last.divisor)
        if not math.isfinite(self.estimates[-1]):
            return finer(FIRST * last.divisor)
        errors, orders = self.errors(careful=False), self._orders_shown()
        order = EXPECTED_WITH_FRICTION if self.friction and not self._calm else EXPECTED
        if all(kind in orders for kind in errors):
            order = SURE * min(orders.values())
        wanted = (max(errors.values()) / self.asked) ** (1.0 / order)
        most = MOST_OF_FORCE if self.friction and self._calm else MOST
        return finer(last.divisor * min(max(wanted, LEAST), most))

    def _stalls(self, method: str) -> bool:
        """Whether the last estimates of a method fall no more from run to run; large ones, below all before them."""
        known = [
            estimate
            for run, estimate in zip(self.made, self.estimates, strict=True)
            if run.method == method and math.isfinite(estimate)
        ]
        before, late = known[:-PATIENCE], known[-PATIENCE:]
        if not before:
            return False
        falls = [b <= STALLED * a for a, b in itertools.pairwise([before[-1], *late])]
        return not any(falls) or min(late) > max(ALIKE, STALLED * min(before))

    def _reason_to_end(self, divisor: float) -> str:
        """Why no run with so many steps in an interval is made; empty where one is."""
        last = self.made[-1]
        if len(self.made) > PATIENCE + 2 and last.seen is not None and self._stalls(last.method):
            return (
                "shorter steps lessen it no more: the motion is chaotic, or friction decides which contact slips "
                "first. Look at many runs, and not at one"
            )
        if sum(run.cpu for run in self.made) + last.cpu * divisor / last.divisor > SECONDS:
            return f"a run with more steps would take all runs beyond {SECONDS:g} s of processor time"
        if self.end / self.interval * divisor > STEPS:
            return f"a more accurate run takes more than {STEPS:.0e} steps"
        return f"it is not reached in {RUNS} runs" if len(self.made) >= RUNS else ""


def _without_forces(run: Made) -> Made:
    """A run that nothing is compared with any more: forces may be most of what a result holds."""
    return run if run.seen is None else run._replace(seen=run.seen._replace(forces=NONE))


def _over_time(seen: Seen, kind: str, watched: Watched | None) -> np.ndarray | None:
    """What is compared of a run, at the times of its frames; None where it has nothing of the kind."""
    if kind == "position":
        return seen.history.position
    if kind == "twist":
        return seen.history.twist if seen.history.twist.size else None
    column = None if watched is None or watched.force is None else watched.force.column
    return None if column is None or column >= seen.forces.shape[1] else seen.forces[:, column]


def _between(coarse: Seen, fine: Seen) -> float | None:
    """How far the forces of two runs are apart over time, root mean square, over the range; None without a force."""
    both = at_common_times(coarse.history, fine.history)
    if both is None or not both[1].force.size or not np.ptp(both[1].force) > 0.0:
        return None
    return float(np.sqrt(np.mean((both[0].force - both[1].force) ** 2)) / np.ptp(both[1].force))


def finer(number: float) -> float:
    """The next of 1/2, 1, 2, 3, 4, 6, 8, 12, ... that is no less."""
    power = max(COARSEST, 2.0 ** math.ceil(math.log2(number) - 1e-9))
    return 0.75 * power if power >= 4.0 and 0.75 * power >= number * (1.0 - 1e-9) else power


def differences(coarse: Seen, fine: Seen, extent: float) -> dict[str, float]:
    """How far two runs are apart at the times that both have, relative, by kind; empty where there are no such times.

    Parameters
    ----------
    extent : float
        Size of the scene, m, against which a point that rests is judged.
    """
    both = at_common_times(coarse.history, fine.history)
    if both is None:
        return {}
    _, position, force = apart(*both, extent)
    found = {"position": position} | ({"force": force} if force is not None else {})
    twist = twist_apart(*both)
    return found | ({"twist": twist} if twist is not None else {})


def changes(coarse: Seen, fine: Seen, extent: float, force: int | None) -> dict[str, float]:
    """What an estimate is made from: as `differences`, but of a force the highest and the lowest value for themselves.

    Errors of both may cancel in the amplitude, and two runs then agree in it by chance.

    Parameters
    ----------
    force : int or None
        Column of the force that is compared; None where a scene has none.
    """
    found = differences(coarse, fine, extent)
    if "force" in found and force is not None and min(coarse.forces.size, fine.forces.size):
        found["force"] = ends_apart(coarse.forces[:, force], fine.forces[:, force])
    return found


def look_at(result: Result, watched: Watched) -> Seen:
    """What of a run is compared."""
    return Seen(watched.of(result), NONE if watched.force is None else all_forces(result))


def run_to_accuracy(
    application: Any,
    scene: Any,
    asked: float,
    path: str | Path | None = None,
    progress: Callable[[float, float], None] | None = None,
    announce: Callable[[int], Any] | None = None,
    begin: Callable[[str, float, float], None] | None = None,
    interval_key: str = INTERVAL,
) -> Result:
    """Run a scene with the method and the step that reach an accuracy, and state what was reached.

    Parameters
    ----------
    application : Application
    scene : scene
        As it was read.
    asked : float
        The largest relative error of position, force and twist that is due to the steps.
    path, progress, announce
        As `tautline.simulation.simulate` takes them. Under ``path`` stand the runs that may be the last.
    begin : callable or None
        Called before each run with its method, step s, and end s.
    interval_key : str
        What sets the frames in the scene's file.

    Returns
    -------
    Result
        With the attributes ``accuracy`` (`Choice.record`), ``step_error`` and ``between_frames``; a warning says so
        where the accuracy is not reached.

    Raises
    ------
    SceneError, StoppedEarly, Interrupted
        As `tautline.simulation.simulate` does; StoppedEarly where runs with ever shorter steps stop early too.
    """
    model = application.build(scene)
    if model.keep is not None:
        cure = "leave it out, or run a shorter stretch of the scene with output.keep: frames"
        raise option_error("accuracy", f"{asked:g}", "needs every frame, and the scene keeps statistics", cure)
    choice = Choice(asked, float(model.solver.interval), float(model.solver.end), bool(model.system.has_friction))
    search = _Search(application, scene, choice, (implicit_like(model.solver.method), _coarsest(scene, choice)))
    search.interval_key = interval_key
    while search.following is not None:
        method, divisor = search.following
        step, rehearsed = choice.interval / divisor, choice.rehearsed(method, divisor) and not search.to_store
        arranged = search.arranged(method, step)
        if begin is not None:
            begin(method, step, choice.end)
        made = application.build(without_limits(arranged) if rehearsed else arranged)
        finer = None if rehearsed else _further_frames(made)
        judge = Afterwards(partial(search.judge, method, divisor, made, finer))
        stored = None if rehearsed else path
        try:
            result = simulate(made, stored, progress, announce=announce, afterwards=judge, finer=finer)
        except StoppedEarly as stop:
            if not search.goes_on_after(stop, method, divisor):
                raise
            continue
        if search.following is None and rehearsed:
            search.repeat_to_store(method, divisor)
    return result


@dataclass
class _Search:
    """The runs of a scene in their order.

    Attributes
    ----------
    following : (str, float) or None
        Method of the next run and its steps in an interval; None after the last.
    to_store : bool
        Whether the next run is the last one made again: what only served to find the next was not stored.
    interval_key : str
        What sets the frames in the scene's file.
    """

    application: Any
    scene: Any
    choice: Choice
    following: tuple[str, float] | None
    to_store: bool = False
    interval_key: str = INTERVAL

    def arranged(self, method: str, step: float) -> Any:
        """The scene with a method and a fixed step, s."""
        interval = max(step, self.choice.interval)
        return self.application.with_overrides(self.scene, method=method, step=step, control="fixed", interval=interval)

    def judge(
        self, method: str, divisor: float, model: Model, finer: FinerFrames | None, result: Result
    ) -> tuple[dict[str, Any], list[str]]:
        """Find what follows a run that came to its end; its attributes and warnings.

        ``finer`` are its frames between those that are stored; None of a run that has none.
        """
        choice = self.choice
        choice.take(method, divisor, result)
        if len(choice.made) == ASKED_AFTER and not choice.friction:
            choice.explicit = _stable(self.application, self.scene, choice.interval)
        self.following = choice.following()
        if self.following is None and finer is not None:
            self._look_between(model, finer, result)
        return _attributes_and_warnings(choice, self.interval_key)

    def _look_between(self, model: Model, finer: FinerFrames, result: Result) -> None:
        """Look between the frames of the last run, where anything moves."""
        choice = self.choice
        if choice.watched is None or not choice.watched.moves:
            return
        try:
            fine = finer.result(model, result.attributes)
            choice.between = None if fine is None else between_frames(model, result, fine)
        except KeyboardInterrupt:
            # Of the run itself nothing is missing.
            choice.not_looked = True

    def goes_on_after(self, stop: StoppedEarly, method: str, divisor: float) -> bool:
        """Whether another run follows one that stopped early."""
        if stop.status in (Status.IMBALANCE, Status.NO_BALANCE) and self.following is None:
            return False
        stored = stop.result.attributes if stop.result is not None else {}
        self.following = self.choice.fail(method, divisor, stop.sentence, float(stored.get("cpu_time", 0.0)))
        return self.following is not None

    def repeat_to_store(self, method: str, divisor: float) -> None:
        """Let the last run be made again, and stored: a more accurate one is not made."""
        self.following, self.to_store = (method, max(1.0, divisor)), True
        self.choice.forget()


def _coarsest(scene: Any, choice: Choice) -> float:
    """Steps in an interval of the first run: enough to see what is prescribed."""
    fastest = max((frequency for _, frequency in frequencies(scene, choice.end)), default=0.0)
    step = min(choice.end / FEWEST_STEPS, 1.0 / (STEPS_PER_PERIOD * fastest) if fastest > 0.0 else math.inf)
    return finer(max(COARSEST, choice.interval / step))


def _stable(application: Any, scene: Any, interval: float) -> float:
    """Steps in an interval with which the explicit method is stable, infinite where nothing is known of it."""
    critical = critical_at_start(Subject(application, scene), Setting(explicit_like(scene.solver.method)))
    return math.inf if critical is None else max(1.0, interval / (EXPLICIT_SHARE * critical))


def _further_frames(model: Model) -> FinerFrames | None:
    """What takes frames between those of a run; None where a frame holds one step, or where there is no room."""
    ends, steps = frame_times(model.solver.end, model.solver.interval, model.solver.step)
    count = min(FINER, room_for(model, ends.size), int(steps.max()))
    return FinerFrames(count) if count > 1 else None


def _attributes_and_warnings(choice: Choice, interval_key: str) -> tuple[dict[str, Any], list[str]]:
    """Attributes and warnings of a run."""
    attributes: dict[str, Any] = {"accuracy": choice.record()}
    errors, watched = choice.errors(), choice.watched
    if errors and watched is not None:
        history = choice.made[-1].seen.history  # type: ignore[union-attr]
        size = motion(history, watched.extent)
        others = tuple(run.step for run in choice.made[-2::-1] if run.seen is not None)
        attributes["step_error"] = StepError(
            min(others), watched.point_said, errors["position"] * size, errors["position"],
            watched.force_said, errors.get("force"), others,
        )._replace(**of_twist(errors.get("twist"), history))._asdict()  # fmt: skip
    between = choice.between
    if between is not None:
        attributes["between_frames"] = between.record()
    told = [choice.warning, None if between is None else between.warned(interval_key)]
    told += [NOT_LOOKED] if choice.not_looked else []
    return attributes, [text for text in told if text]
