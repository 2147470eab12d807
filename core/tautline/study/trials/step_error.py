"""What the length of its steps does to a run: how far the result may be off, estimated from runs with other steps.

Shorter steps, for dry friction. Which contact lets go first may turn on the last digit. A step and its half may then
miss the same event and agree while both are wrong, so there are two other runs, with a half and a third of the step.
The largest difference is taken as that of a method of first order, which is what is left of any method across an
event: the error is u(h) - u(h/k) over 1 - 1/k. A smooth motion, of second order, is then said to be 1.5 times as wrong
as it is.

Longer steps, for all else: twice and four times, which take three quarters of the time of the run itself. The order is
observed in the two differences, no more than the method's and no less than a half, and the error that follows is
multiplied by 1.25. This is the grid convergence index of Roache (J. Fluids Eng. 116, 1994, 405-413), applied to time.

A longer step, for steps that are controlled by their errors where the application says that it tells (cranes do): about
one and a half times, with errors of each step that go with its third power. Much longer steps do not follow the rope's
vibration, and tell nothing of its force. First order is assumed and multiplied by 1.25: a smooth motion is then said to
be three times as wrong as it is. Of the force the highest and the lowest value count, each for itself.

A blow, such as the tension at which a slack rope comes taut, is an event by itself: a force that is right while it
swings says nothing of it. Where all runs have one, their largest blows are compared, too, as of first order, where the
other steps are shorter. Of one longer step the difference is chance: it told from 0.15 to 10 times the error.

A string that sticks and slips turns, and its bit hardly moves. So its twist is compared, too, in the way of a position.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.status import Interrupted
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.scene.methods import method_of
from tautline.scene.solver import divided
from tautline.scene.values.printed import in_percent, quantity
from tautline.study.trials.between_frames import (
    ENOUGH,
    SECONDS,
    BetweenFrames,
    at_times,
    between_frames,
    divisor,
    frames_for_each,
    well_divided,
)
from tautline.study.trials.errors import HARDLY, apart, ends_apart, twist_apart
from tautline.study.trials.history import OF_STRING, History, Watched, watch
from tautline.study.trials.trial import GIVEN_UP, Setting, Subject, Trial
from tautline.system.model import Model

SHORTER, LONGER, HALF = (0.5, 1.0 / 3.0), (2.0, 4.0), (0.5,)
"""Steps of the other runs over those of the first: with dry friction or where it is asked for, without, and for an
explicit method, which longer steps make unstable, and for controlled steps of which a frame holds one or two."""
NEAR = 1.5
"""The longer step of the other run where steps are controlled, at most: a frame holds a whole number of it."""
MORE, BARELY = 4, 1.25
"""Steps that a frame may then hold more, less one; and the least step that is enough longer than the run's own to tell,
over that."""
SAFETY = 1.25
"""Roache's factor of safety for an order that was observed in three runs."""
ORDER, LOWEST = 2.0, 0.5
"""Highest order of the implicit methods, and the lowest that an observed order counts for."""
FORCE_ORDER = 1.0
"""Highest order that counts for the amplitude of a force: its errors change sign, and then seem to fall too fast."""
POOR = 0.01
"""Share of a motion from which the error is warned of."""
SAME_TIME = 1.0e-9
"""Share of a run within which two frames are of one time."""
ALLOWED, AT_LEAST = 3.0, 2.0
"""Times its share of the first run's processor time that another may take, and a time, s, that each may take."""

NOT_KNOWN = "the error due to the time step is not known: {}"
"""The warning of a run whose error is not known, with the reason."""
CUT_SHORT = "the run that was to show it was interrupted"
"""That reason, on Ctrl-C."""


class StepError(NamedTuple):
    """Estimated error of a run due to the length of its steps.

    Attributes
    ----------
    step : float
        The shortest of the other runs, s.
    place : str
        What was looked at.
    distance : float
        By how much that point may be off at most during the run, m.
    position : float
        The same over the largest distance that it moves.
    force_place : str
        The force that was looked at; empty where a scene has none.
    force : float or None
        By how much its amplitude (half of its range) may be off, over that amplitude, or over a hundredth of its
        largest value where that is more; of a run whose accuracy was asked for or whose steps are controlled, by how
        much its highest and its lowest value may be off together, over twice as much.
    steps : tuple of float
        Of all other runs, s.
    changes : tuple of float
        Largest distances, m, between one run and the next: the first and the others, or in the order of longer steps.
    bound : float or None
        The error of each step, m, by which the run's steps are controlled; None where they are fixed.
    taken : float or None
        The step of the run itself, s: with `step: auto` no key of the scene says it.
    amplitude, largest : float or None
        Of the force, half of its range and its largest size, N; None where they were not kept.
    friction : bool
        Whether the scene has dry friction.
    chosen : bool
        Whether the run chose its steps by itself, as with `step: auto`.
    blow_said : str
        The largest blow of the run, as a sentence has it; empty where it has none.
    blow, blow_size : float or None
        By how much it may be off, over itself, and itself, N. The first is None where it is not known: where the other
        steps are longer, or another run has no such blow.
    twist_place : str
        The twist that was looked at, that of a string; empty where a scene has none.
    twist, twist_angle : float or None
        By how much it may be off at most during the run, over what it varies by, and in rad; None where there is none.
    """

    step: float
    place: str
    distance: float
    position: float
    force_place: str
    force: float | None
    steps: tuple[float, ...] = ()
    changes: tuple[float, ...] = ()
    bound: float | None = None
    taken: float | None = None
    amplitude: float | None = None
    largest: float | None = None
    friction: bool = False
    chosen: bool = False
    blow_said: str = ""
    blow: float | None = None
    blow_size: float | None = None
    twist_place: str = ""
    twist: float | None = None
    twist_angle: float | None = None

    @property
    def warning(self) -> str | None:
        """What a reader should know, if the error is a large one; see `warned`."""
        return self.warned()

    def warned(self, step: str = "solver.step", step_error: str = "solver.step_error") -> str | None:
        """What a reader should know, if the error is a large one; None where it is small.

        Parameters
        ----------
        step, step_error : str
            What the step, and the error that steps are controlled by, are called in the scene's file.
        """
        if not max(self.position, self.force or 0.0, self.blow or 0.0, self.twist or 0.0) > POOR:
            return None
        text = f"{self._how_far_off()}. This is estimated from {self._other_runs()}. "
        steps, shorter = self.steps or (self.step,), "Take a shorter step"
        if self.bound is None and len(steps) == 1 and self.taken is not None and self.step < self.taken:
            # An explicit run, maybe with `step: auto`, which is no number to be made smaller; this one is known to run.
            shorter += f" than {quantity(self.taken, 's')}, such as with --step '{quantity(self.step, 's')}'"
        if self.bound is not None:
            shorter = f"Give a smaller {step_error} (now {self.bound:.2g} m)"
            if not self.chosen:
                shorter += f" and a smaller {step}"
                shorter += f" (now {quantity(self.taken, 's')})" if self.taken is not None else ""
        if len(self.steps) > 1 and self.steps[1] < self.steps[0]:
            text += f"{shorter} and compare"
            friction = ". Where friction decides what slips first, a shorter step need not do better"
            return text + (friction if self.friction else "")
        return text + f"{shorter}, or run with --verify, which estimates it more closely from shorter steps"

    def _how_far_off(self) -> str:
        """By how much place, force and twist may be off; what is off by the larger share comes first."""
        way = f"{self.distance:.2g} m, {in_percent(self.position)} of its motion"
        told = [(self.position, f"the {self.place}", way)]
        if self.force is not None:
            told.append((self.force, f"the amplitude of the {self.force_place}", self._of_force()))
        if self.twist is not None and self.twist_angle is not None:
            off = quantity(float(f"{math.degrees(self.twist_angle):.2g}"), "deg")
            told.append((self.twist, f"the {self.twist_place}", f"{off}, {in_percent(self.twist)}"))
        if self.blow is not None and self.blow_size is not None:
            off = quantity(float(f"{self.blow * self.blow_size:.2g}"), "N")
            told.append((self.blow, f"the {self.blow_said}", f"{off}, {in_percent(self.blow)}"))
        (_, first, much), *others = sorted(told, key=lambda one: -one[0])
        return f"{first} may be off by {much}" + "".join(f", and {what} by {off}" for _, what, off in others)

    def _other_runs(self) -> str:
        """The runs that it is estimated from: ``a run with half the step, 0.025 s``."""
        steps = self.steps or (self.step,)
        if len(steps) > 1 or self.bound is None or self.taken is None:
            return f"{'runs' if len(steps) > 1 else 'a run'} with steps of {_listed(steps)}"
        share = steps[0] / self.taken
        times = "half" if abs(share - 0.5) < SAME_TIME else f"{share:.3g} times"
        return f"a run with {times} the step, {_listed(steps)}"

    def _of_force(self) -> str:
        """Error of the force's amplitude: in per cent of it, or where it hardly varies beside what it varies about."""
        assert self.force is not None
        if self.amplitude is None or self.largest is None:
            return in_percent(self.force)
        size = max(self.amplitude, HARDLY * self.largest)
        off = quantity(float(f"{self.force * size:.2g}"), "N")
        if self.amplitude == size:
            return f"{off}, {in_percent(self.force)}"
        varies, about = (quantity(float(f"{x:.3g}"), "N") for x in (2.0 * self.amplitude, self.largest))
        return f"{off} (it varies by {varies} in {about})"


def runs_for(model: Model, asked: bool | None = None) -> tuple[float, ...]:
    """Steps of the other runs over a model's own: those of `step_error`; none where nothing is to be estimated.

    Parameters
    ----------
    asked : bool or None
        Whether an estimate was asked for; None takes one where steps are fixed, or controlled and a longer one tells.
    """
    controlled = model.solver.step_error > 0.0
    if asked is None and controlled and model.longer_steps_tell:
        return _near(model)
    explicit = method_of(model.solver.method).explicit
    # An explicit method with `step: auto` chooses for stability: its steps say nothing of its error.
    if asked is False or (asked is None and (controlled or (model.solver.automatic and not explicit))):
        return ()
    if asked is None and not _fixed(model):
        return HALF
    return SHORTER if asked or model.system.has_friction else LONGER


def _near(model: Model) -> tuple[float, ...]:
    """A step that is a little longer; half of one where a frame holds no more than two, and none is a little longer.

    A frame may hold a few steps more if these can be divided among more frames within it: 34 have no divisor but 2.
    """
    count = round(float(model.solver.interval) / _step_taken(model))
    if count < 3:
        return HALF
    least = math.ceil(count / NEAR)
    longer = [least + more for more in range(MORE) if least + more <= count / BARELY] or [least]
    return (count / next((steps for steps in longer if divisor(steps) >= ENOUGH), least),)


def _fixed(model: Model) -> bool:
    solver = model.solver
    return not method_of(solver.method).explicit and not solver.automatic and solver.step_error == 0.0


def step_error(
    subject: Subject,
    result: Result,
    setting: Setting | None = None,
    progress: Callable[[float, float], None] | None = None,
    parts: Sequence[float] = SHORTER,
) -> StepError | None:
    """Run a scene with other steps and estimate the error of a run.

    Parameters
    ----------
    subject : Subject
        The scene.
    result : Result
        Its run.
    setting : Setting or None
        How it was run, if not as the scene says.
    progress : callable or None
        Called with simulated and wall time, s; both go on from one of the other runs to the next.
    parts : sequence of float
        Steps of the other runs over those of the first, see `runs_for`.

    Returns
    -------
    StepError or None
        None where the error is not known, see `estimate`, and where nothing moves.
    """
    found = estimate(subject, result, setting, progress, parts)
    return found if isinstance(found, StepError) else None


def estimate(
    subject: Subject,
    result: Result,
    setting: Setting | None = None,
    progress: Callable[[float, float], None] | None = None,
    parts: Sequence[float] = SHORTER,
    begin: Callable[[], None] | None = None,
) -> StepError | str:
    """The same as `step_error`, but a sentence that says why where the error is not known; empty if nothing moves.

    ``begin`` is called before the first of the other runs.
    """
    return looked_at(subject, result, setting, progress, parts, begin)[0]


def looked_at(
    subject: Subject,
    result: Result,
    setting: Setting | None = None,
    progress: Callable[[float, float], None] | None = None,
    parts: Sequence[float] = SHORTER,
    begin: Callable[[], None] | None = None,
    judged_by: Model | None = None,
) -> tuple[StepError | str, BetweenFrames | None]:
    """The same as `estimate`, and what the run does between its frames.

    The first of the other runs tells the latter where ``judged_by``, the model that was run, with its limits, is given.
    """
    if len(result.time) < 2:
        return "the result has a single frame", None
    try:
        watched = watch(result)
    except ResultError as error:
        return error.cause, None
    if not watched.moves:
        return "", None
    if begin is not None:
        begin()
    given = setting or Setting()
    model = subject.model(given)
    own, bound = _step_taken(model), model.solver.step_error or None
    if model.solver.automatic and method_of(model.solver.method).explicit:
        own = float(result.attributes.get("step") or own)
    histories, steps, spent, runs = [watched.of(result)], [own], 0.0, [result]
    between = None
    for number, part in enumerate(parts):
        onward = _onward(progress, number * float(result.time[-1]), spent)
        interval = float(model.solver.interval)
        if number == 0 and own * part < interval:
            # Of 13 steps in a frame none can be stored but the last, of 12 every second one. A longer step than a frame
            # stands in none, and leaves out frames of a run that keeps every step.
            part = interval / well_divided(round(interval / divided(interval, own * part))) / own
        first = number == 0 and judged_by is not None
        finer = frames_for_each(model, own, own * part, len(result.time)) if first else 1
        trial = _other(subject, result, given, own * part, part, onward, finer)
        if isinstance(trial, str) or not trial.done or trial.result is None:
            if number and part > 1.0:
                break  # four times the step may be too long to run at all; twice the step has told something
            return (trial if isinstance(trial, str) else _why(trial, own * part)), between
        spent += trial.wall_time or 0.0
        run = trial.result
        if finer > 1 and judged_by is not None:
            between, run = between_frames(judged_by, result, run), at_times(run, result.time)
        runs.append(run)
        histories.append(watched.of(run))
        steps.append(float(trial.result.attributes["step"]))
    found = _stated(result, watched, histories, steps, bound)
    if isinstance(found, StepError):
        blow = _blow(model, runs, steps)
        friction, chosen = bool(model.system.has_friction), bool(model.solver.automatic)
        return found._replace(friction=friction, chosen=chosen, **blow), between
    return found, between


def _blow(model: Model, runs: Sequence[Result], steps: Sequence[float]) -> dict[str, Any]:
    """Error of the largest blow of the first run as `StepError` has it; nothing of a run without one."""
    if not model.blow or model.figures is None:
        return {}
    told = [model.figures(run, (model.blow,)).get(model.blow) for run in runs]
    sizes = [float(figure["value"]) if figure is not None else 0.0 for figure in told]
    if told[0] is None or not sizes[0] > 0.0:
        return {}
    found = {"blow_said": str(told[0]["text"]).partition(" (")[0], "blow_size": sizes[0]}
    if steps[1] > steps[0]:
        return found
    off = from_shorter([abs(x - sizes[0]) for x in sizes[1:]], [step / steps[0] for step in steps[1:]])
    # Of runs in which it is another one, or is not there, it is not known how far it is off.
    return found | ({"blow": off / sizes[0]} if off < sizes[0] else {})


def _step_taken(model: Model) -> float:
    """The step as it divides the interval of the frames, s."""
    return divided(float(model.solver.interval), float(model.solver.step))


def _other(
    subject: Subject, result: Result, given: Setting, step: float, part: float,
    progress: Callable[[float, float], None] | None, finer: int = 1,
) -> Trial | str:  # fmt: skip
    """A run with another step, and with a smaller error of each where that is controlled; why there is none.

    It stores ``finer`` frames for each of the run's own.
    """
    solver = subject.model(given).solver
    # The local error of a second-order method goes with the third power of the step.
    error = solver.step_error * part**3 if solver.step_error > 0.0 else None
    seconds = AT_LEAST + ALLOWED * float(result.attributes.get("cpu_time", 0.0)) / part
    if finer > 1:
        # The steps are those that divide the run's own frames.
        interval = float(solver.interval)
        seconds += SECONDS * finer * len(result.time)
        subject, step = replace(subject, interval=interval / finer), divided(interval, step)
    try:
        return subject.run(replace(given, step=step, step_error=error), seconds=seconds, progress=progress)
    except Interrupted:
        return CUT_SHORT
    except SceneError as refused:
        return refused.problems[0].cause


def _why(trial: Trial, step: float) -> str:
    """Why a run tells nothing."""
    if trial.status == GIVEN_UP:
        return f"the run with steps of {step:.3g} s was given up {trial.sentence}"
    how = "was refused" if trial.status == "refused" else "stopped"
    return f"the run with steps of {step:.3g} s {how}: {trial.sentence or trial.status}"


def _onward(
    progress: Callable[[float, float], None] | None, since: float, spent: float
) -> Callable[[float, float], None] | None:
    """What shows progress, for a run that comes after others of so much simulated and wall time, s."""
    return None if progress is None else lambda simulated, wall: progress(since + simulated, spent + wall)


def _stated(
    result: Result, watched: Watched, histories: list[History], steps: list[float], bound: float | None
) -> StepError | str:
    """The error of the first of some runs."""
    shorter = steps[1] < steps[0]
    pairs = [(0, i) for i in range(1, len(steps))] if shorter else [(i, i - 1) for i in range(1, len(steps))]
    changes: list[tuple[float, float, float | None, float | None]] = []
    for coarse, fine in pairs:
        common = at_common_times(histories[coarse], histories[fine])
        if common is None:
            return "the runs with other steps have no frames at the same times"
        distance, position, force = apart(*common, watched.extent)
        if bound is not None and force is not None:
            # Errors of the highest and the lowest value may cancel in the amplitude.
            force = ends_apart(*(x.force for x in common))
        changes.append((distance, position, force, twist_apart(*common)))
    # Of what one of the runs does not show nothing is known.
    shown_by_all = [None if None in kind else kind for kind in zip(*changes, strict=True)]
    ratios = [steps[i] / steps[i - 1] for i in range(1, len(steps))]
    if shorter:
        shares = [steps[i] / steps[0] for i in range(1, len(steps))]
        found = [from_shorter(x, shares) if x is not None else None for x in shown_by_all]
    else:
        both = zip(shown_by_all, (ORDER, ORDER, FORCE_ORDER, ORDER), strict=True)
        found = [from_longer(x, ratios, order) if x is not None else None for x, order in both]
    if not np.isfinite([x for x in found if x is not None]).all():
        return "the runs with other steps differ too much for an estimate"
    place, force_place = watched.point_said, watched.force_said
    distance, position, force, twist = found
    assert distance is not None and position is not None
    seen = histories[0].force
    amplitude, largest = (0.5 * float(np.ptp(seen)), float(np.abs(seen).max())) if seen.size else (None, None)
    return StepError(
        min(steps[1:]), place, distance, position, force_place, force, tuple(steps[1:]),
        tuple(change[0] for change in changes), bound, steps[0], amplitude, largest,
    )._replace(**of_twist(twist, histories[0]))  # fmt: skip


def of_twist(error: float | None, run: History) -> dict[str, Any]:
    """What `StepError` has of a string's twist that is off by a share of what it varies by in a run."""
    if error is None:
        return {}
    return {"twist_place": OF_STRING, "twist": error, "twist_angle": error * float(np.ptp(run.twist))}


def from_shorter(changes: Sequence[float], shares: Sequence[float]) -> float:
    """Error of a run from its differences to runs with these shares of its step, as of a method of first order."""
    return max(change / (1.0 - share) for change, share in zip(changes, shares, strict=True))


def from_longer(
    changes: Sequence[float], ratios: Sequence[float], highest: float = ORDER, lowest: float = LOWEST
) -> float:
    """Error of a run from its difference to one with longer steps, and that run's to one with longer ones still.

    Parameters
    ----------
    changes : sequence of float
        |u2 - u1| and |u3 - u2|; the second may be lacking, and the order is then taken as one.
    ratios : sequence of float
        h2/h1 and h3/h2.
    highest, lowest : float
        The orders that count at most and at least.
    """
    p = order_of(changes, ratios, highest, lowest) if len(changes) > 1 else 1.0
    found = changes[0] / (ratios[0] ** p - 1.0)
    if len(changes) > 1:
        # A small first difference beside a large second one is chance where no method is of so high an order.
        found = max(found, changes[1] / (ratios[0] ** p * (ratios[1] ** p - 1.0)))
    return SAFETY * found


def order_of(changes: Sequence[float], ratios: Sequence[float], highest: float, lowest: float = LOWEST) -> float:
    """The order p for which the second difference over the first is r1^p (r2^p - 1) / (r1^p - 1), within bounds."""
    (first, second), (r1, r2) = changes, ratios
    low, high = lowest, highest

    def too_low(p: float) -> bool:
        return second * (r1**p - 1.0) > first * r1**p * (r2**p - 1.0)

    if not too_low(low):
        return low
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if too_low(middle) else (low, middle)
    return high


def _listed(steps: Sequence[float]) -> str:
    return " and ".join(f"{step:.3g} s" for step in steps)


def at_common_times(first: History, second: History) -> tuple[History, History] | None:
    """Both histories at the times that both have; None where these are not two."""
    near = SAME_TIME * max(float(first.time[-1]), float(second.time[-1]))
    place = np.searchsorted(first.time, second.time - near)
    there = place < first.time.size
    there[there] = np.abs(first.time[place[there]] - second.time[there]) <= 2.0 * near
    if np.count_nonzero(there) < 2:
        return None
    return _frames(first, place[there]), _frames(second, np.flatnonzero(there))


def _frames(history: History, which: np.ndarray) -> History:
    scalars = (x[which] if x.size else x for x in (history.force, history.twist))
    return History(history.time[which], history.position[which], *scalars)
