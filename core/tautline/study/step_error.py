"""What the length of its steps does to a run: the same scene once more with other steps, and how far apart the two are.

A smooth motion tells by its own period how well a step resolves it. Dry friction does not: which contact lets go
first may turn on the last digit, and a step ten times shorter may be no nearer. Only another run shows it. It has half
the step: one of twice the step may end where this one does by chance while both are wrong, and where steps are too long
already it tells of its own error only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tautline.integrators.generalized_alpha import GeneralizedAlpha
from tautline.integrators.method import method_for
from tautline.integrators.status import Interrupted, StoppedEarly
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.simulation import simulate
from tautline.study.errors import apart
from tautline.study.history import History, Place, watch
from tautline.study.trial import Setting, Subject
from tautline.system.model import Model

HALF = 0.5
"""Steps of the other run over those of the first."""
POOR = 0.01
"""Share of a motion from which the difference is warned of."""
SAME_TIME = 1.0e-9
"""Share of a run within which two frames are of one time."""


class StepError(NamedTuple):
    """Difference of two runs.

    Attributes
    ----------
    step : float
        Of the other run, s.
    place : str
        What was looked at.
    distance : float
        Largest distance of that point in the one run from where it is in the other, m.
    position : float
        The same over the largest way that it goes.
    force_place : str
        The force that was looked at; empty where a scene has none.
    force : float or None
        Difference of its amplitude (half of its range) over that amplitude.
    """

    step: float
    place: str
    distance: float
    position: float
    force_place: str
    force: float | None

    @property
    def warning(self) -> str | None:
        """What a reader should know, if the difference is a large one."""
        if not max(self.position, self.force or 0.0) > POOR:
            return None
        told = [f"the {self.place} is off by {self.distance:.2g} m, {100.0 * self.position:.2g} % of its way"]
        if self.force is not None:
            told.append(f"the amplitude of the {self.force_place} by {100.0 * self.force:.2g} %")
        return (
            f"with steps of {self.step:.3g} s {', and '.join(told)}: the result is known about that well. Take a "
            "shorter step and compare; where friction decides what slips first, a shorter one need not do better"
        )


def tells_nothing_itself(model: Model) -> bool:
    """Whether a run has no estimate of what its steps do: fixed steps of an implicit method, with dry friction."""
    solver, system = model.solver, model.system
    implicit = isinstance(method_for(system, solver), GeneralizedAlpha)
    return implicit and not solver.automatic and solver.step_error == 0.0 and system.has_friction


def step_error(
    subject: Subject,
    result: Result,
    setting: Setting | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> StepError | None:
    """Run a scene once more, with steps half as long.

    Parameters
    ----------
    subject : Subject
        The scene.
    result : Result
        Its run.
    setting : Setting or None
        How it was run, if not as the scene says.
    progress : callable or None
        Called with simulated and wall time, s.

    Returns
    -------
    StepError or None
        None where there is nothing to compare: a scene without a point that moves in space, a run of a single frame,
        and where the other run does not come to its end.
    """
    if len(result.time) < 2:
        return None
    given = setting or Setting()
    model = subject.model(given)
    solver = model.solver
    interval = float(solver.interval)
    taken = interval / math.ceil(interval / min(solver.step, interval) - SAME_TIME)
    other = Setting(given.method, HALF * taken, None, given.rho_inf, given.elements, given.constraint)
    try:
        second = simulate(subject.model(other), progress=progress)
    except (SceneError, StoppedEarly, Interrupted):
        return None
    watched = watch(result)
    found = _at_common_times(watched.of(result), watched.of(second))
    if found is None:
        return None
    distance, position, force = apart(*found, watched.extent)
    names = (_name(result, place) for place in (watched.point, watched.force))
    return StepError(float(second.attributes["step"]), next(names), distance, position, next(names), force)


def _name(result: Result, place: Place | None) -> str:
    """A place as a sentence has it: ``position of body 12``."""
    if place is None:
        return ""
    dims, what = result.variables[place.variable].dims, place.variable.replace("_", " ")
    return f"{what} of {dims[1].replace('_', ' ')} {place.label}" if place.label else what


def _at_common_times(first: History, second: History) -> tuple[History, History] | None:
    """Both histories at the times that both have; None where these are not two."""
    near = SAME_TIME * max(float(first.time[-1]), float(second.time[-1]))
    place = np.searchsorted(first.time, second.time - near)
    there = place < first.time.size
    there[there] = np.abs(first.time[place[there]] - second.time[there]) <= 2.0 * near
    if np.count_nonzero(there) < 2:
        return None
    return _frames(first, place[there]), _frames(second, np.flatnonzero(there))


def _frames(history: History, which: np.ndarray) -> History:
    return History(
        history.time[which], history.position[which], history.force[which] if history.force.size else history.force
    )
