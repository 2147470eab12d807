"""Error against run time: methods and steps, meshes and constraints, beside a reference that proves itself."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tautline.integrators.critical_step import CriticalStep
from tautline.integrators.generalized_alpha import GeneralizedAlpha
from tautline.integrators.status import Interrupted, StoppedEarly
from tautline.integrators.tangent import tangent_error
from tautline.kernels.groups import offers
from tautline.scene.errors import SceneError
from tautline.simulation import Run, simulate
from tautline.study.advice import advice
from tautline.study.errors import Errors, compare
from tautline.study.history import Watched, watch
from tautline.study.reference import Reference, find_reference
from tautline.study.trial import Setting, Subject, Trial

IMPLICIT = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25)
"""Steps of implicit methods over the scene's."""
EXPLICIT = (0.95, 0.5, 0.25, 0.125)
"""Steps of RK4 over its critical step."""
LOOSER = (100.0, 10.0, 1.0, 0.1)
"""Errors of a step over the scene's, where the step is controlled by its error."""
METHODS = ("rk4", "generalized-alpha", "newmark")
WRONG_TANGENT = 1.0e-3
"""Relative error of a tangent that is no rounding."""
FEW_STEPS = 20.0
"""Steps of RK4, over those that the scene takes, up to which it is tried as the reference."""


@dataclass(frozen=True)
class Grid:
    """What is to be run; None leaves the choice to the study.

    Attributes
    ----------
    methods : sequence of str or None
    steps : sequence of float or None
        s.
    elements : sequence of float
        Number of elements over the scene's own.
    constraints : sequence of str
        Ways to impose constraints; ``all`` for those that the scene has.
    """

    methods: Sequence[str] | None = None
    steps: Sequence[float] | None = None
    elements: Sequence[float] = (1.0,)
    constraints: Sequence[str] = ()


@dataclass(frozen=True)
class Row:
    """A run and how far it is off; no errors where it did not come to its end."""

    trial: Trial
    errors: Errors | None

    @property
    def factor(self) -> float | None:
        """Real-time factor."""
        reached = None if self.trial.result is None else float(self.trial.result.time[-1])
        return None if not reached or self.trial.wall_time is None else self.trial.wall_time / reached


@dataclass(frozen=True)
class Study:
    """What a study has found.

    Attributes
    ----------
    rows : tuple of Row
    reference : Reference or None
        None where no three runs of it came to their end.
    watched : Watched
    tolerance : float
    tangent : float
        Largest relative error of the tangent along a run with the scene's own settings.
    load : tuple of float
        Mean number of processes that wanted a processor in the last minute, before and after.
    """

    rows: tuple[Row, ...]
    reference: Reference | None
    watched: Watched
    tolerance: float
    tangent: float
    load: tuple[float, float]
    warnings: tuple[str, ...] = field(default=())
    interrupted: bool = False

    @property
    def advice(self) -> str:
        """One sentence: which setting to take."""
        return advice(self)


def study(
    subject: Subject,
    grid: Grid,
    tolerance: float = 0.01,
    repetitions: int = 3,
    budget: float = 60.0,
    point: str | None = None,
    reference: Setting | None = None,
    progress: Callable[[str], None] = lambda text: None,
    reduced: bool = False,
) -> Study:
    """Run a grid of settings and compare each with a reference.

    Parameters
    ----------
    tolerance : float
        Relative error of position that is asked for.
    repetitions : int
        Of each run, for its time; long runs are not repeated.
    budget : float
        Wall time, s, that one run may be expected to take; longer ones are left out, and said to be.
    point : str or None
        Label of the node, lump or body to look at.
    reference : Setting or None
        Method and finest step of the reference, if it is not to choose its own.
    reduced : bool
        Whether the default grid is cut to every other step, for a quick look.

    Raises
    ------
    SceneError, ResultError
        For bad input.
    StoppedEarly
        If the scene as it stands does not come to its end.
    """
    before = os.getloadavg()[0]
    progress("the scene as it stands")
    base, tangent = _as_it_stands(subject)
    watched = watch(base.result, point)
    step = float(base.attribute("end")) / max(1, int(base.attribute("steps")))
    trials: list[Trial] = []
    found, interrupted = None, False
    try:
        for setting in _settings(subject, grid, step, reduced):
            progress(str(setting))
            trials.append(_tried(subject, setting, trials, repetitions, budget))
        found = _reference(subject, grid, watched, trials, base, tolerance, budget, reference, progress)
    except Interrupted:
        interrupted = True
    rows = tuple(_row(trial, watched, found) for trial in trials)
    load = before, os.getloadavg()[0]
    warnings = () if interrupted else tuple(_warnings(found, tangent, rows, tolerance))
    return Study(rows, found, watched, tolerance, tangent, load, warnings, interrupted)


def _tried(subject: Subject, setting: Setting, trials: Sequence[Trial], repetitions: int, budget: float) -> Trial:
    """Run a setting, if it can be expected to take no longer than the budget, s."""
    expected = _expected(trials, setting)
    if expected is not None and expected > budget:
        about = f"about {expected:.0f} s" if np.isfinite(expected) else "longer still"
        return Trial(setting, "left out", f"would take {about}; a run may take {budget:g} s")
    return subject.run(setting, repetitions)


def _as_it_stands(subject: Subject) -> tuple[Trial, float]:
    """A run with the scene's own settings, and the largest error of its tangent; raises SceneError."""
    model = subject.model(Setting())
    wrong = [0.0]

    def look(state: Any, t: float, method: Any) -> None:
        if isinstance(method, GeneralizedAlpha) and len(wrong) <= 12:
            wrong.append(tangent_error(model.system, state, t, method))

    result = simulate(model, announce=subject.announce, look=look)
    return Trial(Setting(), "done", "", result), max(wrong)


def _settings(subject: Subject, grid: Grid, step: float, reduced: bool) -> list[Setting]:
    """Every combination that is asked for, the cheapest of each kind first."""
    own = subject.model(Setting()).solver
    methods = grid.methods or ("rk4", "generalized-alpha" if own.method == "rk4" else own.method)
    asked = tuple(grid.constraints)
    if "all" in asked:
        asked = tuple(subject.application.vary(subject.scene, "constraints") or ())
    found: list[Setting] = []
    for constraint in asked or (None,):
        for elements in sorted(grid.elements):
            for method in methods:
                steps = sorted(_steps(subject, grid, method, elements, constraint, step), reverse=True)
                for h in steps[::2] if reduced and grid.steps is None else steps:
                    found.append(Setting(method, h, None, None, elements, constraint))
                if own.step_error > 0.0 and method != "rk4" and grid.steps is None:
                    errors = [own.step_error * factor for factor in (LOOSER[2:3] if reduced else LOOSER)]
                    found += [Setting(method, own.step, e, None, elements, constraint) for e in errors]
    return found


def _steps(
    subject: Subject, grid: Grid, method: str, elements: float, constraint: str | None, step: float
) -> Sequence[float]:
    if grid.steps is not None:
        return grid.steps
    if method != "rk4":
        return [step * factor for factor in IMPLICIT]
    critical = critical_at_start(subject, Setting(method, None, None, None, elements, constraint))
    return [critical * factor for factor in EXPLICIT] if critical is not None else [step]


def critical_at_start(subject: Subject, setting: Setting) -> float | None:
    """Critical step of RK4 where the scene starts, s; None where it cannot be run so, or nothing vibrates."""
    try:
        run = Run(subject.model(setting))
        run.start()
    except (SceneError, StoppedEarly):
        return None
    critical, _ = CriticalStep(run.model.system).search(run.state, 0.0)
    return critical if np.isfinite(critical) else None


def _expected(trials: Sequence[Trial], setting: Setting) -> float | None:
    """Wall time of a setting by that of one that differs in the step alone, s."""
    for trial in reversed(trials):
        like = trial.setting
        same = (like.method, like.elements, like.constraint) == (setting.method, setting.elements, setting.constraint)
        if same and setting.step and like.step and setting.step_error is None and like.step_error is None:
            wall = trial.wall_time
            if trial.status == "left out":
                return float("inf")
            if trial.done and wall is not None:
                return wall * like.step / setting.step
    return None


def _reference(
    subject: Subject, grid: Grid, watched: Watched, trials: Sequence[Trial], base: Trial, tolerance: float,
    budget: float, asked: Setting | None, progress: Callable[[str], None],
) -> Reference | None:  # fmt: skip
    """The reference asked for; or of RK4 where it can do it and nothing switches, and of the scene's method."""
    finest = max(grid.elements) * (2.0 if len(set(grid.elements)) > 1 else 1.0)
    judged = [watched.of(trial.result) for trial in trials if trial.done and trial.result is not None]
    if asked is not None:
        setting = Setting(asked.method or base.attribute("method"), asked.step, None, None, finest)
        return find_reference(subject, watched, setting, tolerance, budget, asked.step, judged, progress)
    model = subject.model(Setting(elements=finest))
    method = base.attribute("method")
    steps = [t.setting.step for t in trials if t.done and t.setting.step and t.setting.method == method]
    interval = model.solver.interval
    own = min(steps, default=interval)
    candidates = [(method, own)]
    critical = critical_at_start(subject, Setting("rk4", None, None, None, finest))
    taken = float(base.attribute("end")) / max(1, int(base.attribute("steps")))
    if critical is not None and FEW_STEPS * critical > taken and not offers(model.system.groups, "switch"):
        candidates.insert(0, ("rk4", 0.9 * critical))
    best: Reference | None = None
    for method, step in candidates:
        divided = interval / 2.0 ** max(0, int(np.ceil(np.log2(interval / step) - 1e-9)))
        setting = Setting(method, divided, None, None, finest)
        found = find_reference(subject, watched, setting, tolerance, budget, None, judged, progress)
        if found is not None and found.converged:
            return found
        if found is not None and (best is None or found.error < best.error):
            best = found
    return best


def _elsewhere(rows: Sequence[Row], tolerance: float) -> list[tuple[str, float]]:
    """Methods whose finest runs agree on something that is not the reference, and by how much that is off."""
    kinds: dict[str, list[tuple[float, float]]] = {}
    for row in rows:
        s = row.trial.setting
        if row.errors is not None and s.step_error is None:
            name = ", ".join(part for part in (s.method, s.constraint) if part)
            name += f", elements x {s.elements:g}" if s.elements != 1.0 else ""
            kinds.setdefault(name, []).append((float(row.trial.attribute("step")), row.errors.position))
    found = []
    for name, points in kinds.items():
        (fine, error), (coarse, before), *_ = [*sorted(points), (0.0, 0.0), (0.0, 0.0)]
        if coarse >= 1.9 * fine > 0.0 and error > tolerance and before < 1.5 * error:
            found.append((name, error))
    return found


def _row(trial: Trial, watched: Watched, reference: Reference | None) -> Row:
    if not trial.done or trial.result is None or reference is None:
        return Row(trial, None)
    return Row(trial, compare(watched.of(trial.result), reference.history, watched.extent))


def _warnings(reference: Reference | None, tangent: float, rows: Sequence[Row], tolerance: float) -> list[str]:
    found = [
        f"{name} stays {100.0 * error:.2g} % off the reference as its step falls: it solves another problem "
        "(explicit methods take other laws of friction; meshes and penalties have errors of their own)"
        for name, error in _elsewhere(rows, tolerance)
    ]
    if reference is None:
        found.append("no reference: no three runs of falling step came to their end; name a step with --reference-step")
    elif not reference.converged:
        text = f"the reference is not proved: {reference.why}"
        found.append(f"{text}; errors below {max(reference.error, 1e-16):.1e} mean nothing")
    if tangent > WRONG_TANGENT:
        found.append(
            f"a tangent is wrong by {tangent:.1e} of its size: implicit methods iterate more than they should, and "
            "frequencies that are found with it are wrong; report the scene"
        )
    return found
