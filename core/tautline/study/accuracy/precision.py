"""Error against run time: methods and steps, meshes and constraints, beside a reference that proves itself."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tautline.integrators.state import State
from tautline.integrators.status import Interrupted, StoppedEarly
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.integrators.vibration.tangent import tangent_error
from tautline.kernels.memory import form_of
from tautline.scene.errors import SceneError, option_error
from tautline.scene.methods import method_of
from tautline.simulation import simulate
from tautline.study.accuracy.findings import Row, Study
from tautline.study.accuracy.grid import Grid as Grid
from tautline.study.accuracy.grid import settings
from tautline.study.accuracy.judge import choose_reference
from tautline.study.accuracy.reference import CLEAR, Reference
from tautline.study.trials.errors import compare
from tautline.study.trials.history import Watched, watch
from tautline.study.trials.omissions import of_study, unseen
from tautline.study.trials.trial import Setting, Subject, Trial, run_model
from tautline.system.model import Model
from tautline.system.system import System

WRONG_TANGENT = 1.0e-2
"""Relative error of a row of a tangent that is no rounding."""
MANY = 20_000
"""Steps from which a run of a kind that was not run yet is first tried on a part of its time."""
PART = 0.02
"""That part."""
MESH_ORDERS = np.linspace(0.5, 4.0, 71)
"""Orders, rising, with which a mesh may converge."""
EVERY = 16
"""Looks at a run from one at which the tangent is compared to the next."""


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
        Processor time, s, that one run may be expected to take; longer ones are left out, and said to be.
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
        If the scene does not come to its end as it stands, nor with any other setting.
    """
    require_tolerance(tolerance)
    before = os.getloadavg()[0]
    progress("the scene as it stands")
    base, tangent, shrinks, stop = _as_it_stands(subject)
    solver = subject.model(Setting()).solver
    step = min(solver.step, solver.interval)
    if base is not None:
        watched = watch(base.result, point)
        step = float(base.attribute("end")) / max(1, int(base.attribute("steps")))
    wanted = settings(subject, grid, step, shrinks, reduced)
    trials: list[Trial] = []
    found, interrupted = None, False
    try:
        for setting in wanted:
            progress(str(setting))
            trials.append(_tried(subject, setting, trials, repetitions, budget))
        if base is None:
            base = next((trial for trial in trials if trial.done), None)
            if base is None:
                assert stop is not None
                raise stop
            watched = watch(base.result, point)
        finest = max((setting.elements for setting in wanted), default=1.0)
        finest *= 2.0 if len({setting.elements for setting in wanted}) > 1 else 1.0
        found = choose_reference(subject, watched, trials, base, finest, tolerance, budget, reference, progress)
    except Interrupted:
        if base is None:
            raise
        interrupted = True
    rows = tuple(_row(trial, watched, found) for trial in trials)
    if found is not None and not interrupted:
        found = replace(found, mesh_error=mesh_error(subject, watched, found, [s.elements for s in wanted], progress))
    load = before, os.getloadavg()[0]
    warnings = () if interrupted else tuple(_warnings(found, tangent, rows, tolerance, watched))
    left_out = of_study(subject, grid.steps is not None) if reduced else ()
    return Study(
        rows, found, watched, tolerance, tangent, load, warnings, left_out, interrupted, stop, unseen(subject)
    )  # fmt: skip


def require_tolerance(tolerance: float) -> None:
    """Raise SceneError for an error that nothing can be below, or everything."""
    if not 0.0 < tolerance < np.inf:
        raise option_error(
            "tolerance", f"{tolerance:g}", "is no error to ask for", "give a share above 0, such as 0.01"
        )


def _tried(subject: Subject, setting: Setting, trials: Sequence[Trial], repetitions: int, budget: float) -> Trial:
    """Run a setting, if it can be expected to take no longer than the budget, s."""
    expected = _expected(trials, setting)
    if expected is None:
        expected = _tried_in_part(subject, setting)
    if expected is not None and expected > budget:
        about = f"about {expected:.0f} s" if np.isfinite(expected) else "longer still"
        return Trial(setting, "left out", f"would take {about}; a run may take {budget:g} s")
    return subject.run(setting, repetitions)


def _as_it_stands(subject: Subject) -> tuple[Trial | None, float | None, float, StoppedEarly | None]:
    """A run with the scene's own settings, the largest error of its tangent, and by what its critical step shrinks.

    Elements of a rope that is hoisted become shorter, and what was stable at the start is not at the end. There is no
    run where it stopped, which is told last.
    """
    model = subject.model(Setting())
    comparison, search = TangentLook(model.system), CriticalStep(model.system, method_of(subject.explicit))
    steps: list[float] = []

    def look(state: State, t: float, method: Any) -> None:
        comparison(state, t, method)
        steps.append(search.search(state, t)[0])

    base: Trial | None = None
    stop: StoppedEarly | None = None
    try:
        base = Trial(Setting(), "done", "", simulate(model, announce=subject.announce, look=look))
    except StoppedEarly as early:
        stop = early
    alike = bool(steps) and np.isfinite(steps[0]) and _same_laws(subject, model)
    shrinks = min(steps) / steps[0] if alike and base is not None else 1.0
    return base, comparison.largest_of(subject), shrinks, stop


def _same_laws(subject: Subject, model: Model) -> bool:
    """Whether an explicit method runs a scene with the laws of the run as it stands: of friction it may take others."""
    try:
        other = subject.model(Setting(subject.explicit))
    except SceneError:
        return False
    return form_of(other.system.groups) == form_of(model.system.groups)


class TangentLook:
    """Compares the tangent with differences of the residual, at some of the states of a run."""

    def __init__(self, system: System) -> None:
        self.system, self.looks = system, 0
        self.errors: list[float] = []

    def __call__(self, state: State, t: float, method: Any = None) -> None:
        """Look at a state, if it is one of every few."""
        self.looks += 1
        if hasattr(method, "corrector") and (self.looks <= 4 or self.looks % EVERY == 0):
            self.errors.append(tangent_error(self.system, state, t, method))

    def largest_of(self, subject: Subject) -> float | None:
        """The largest error; of an implicit run of the scene where it has no tangent of its own, None if it cannot."""
        if self.errors:
            return max(self.errors)
        try:
            model = subject.model(Setting(subject.implicit))
        except SceneError:
            return None
        other = TangentLook(model.system)
        run_model(model, Setting(subject.implicit), look=other)
        return max(other.errors, default=None)


def _tried_in_part(subject: Subject, setting: Setting) -> float | None:
    """Processor time of a setting by that of the first part of its run, s; None for few steps, and where it stops."""
    if not setting.step or setting.step_error is not None:
        return None
    try:
        solver = subject.model(setting).solver
    except SceneError:
        return None
    end = max(PART * solver.end, solver.interval)
    if solver.end / setting.step < MANY or end >= solver.end:
        return None
    trial = replace(subject, end=end).run(setting)
    return trial.cpu_time * solver.end / end if trial.done and trial.cpu_time is not None else None


def _expected(trials: Sequence[Trial], setting: Setting) -> float | None:
    """Processor time of a setting by that of one that differs in the step alone, s."""
    for trial in reversed(trials):
        like = trial.setting
        fixed = setting.step_error is None and like.step_error is None
        if like.kind == setting.kind and setting.step and like.step and fixed:
            spent = trial.cpu_time
            if trial.status == "left out":
                return float("inf")
            if trial.done and spent is not None:
                return spent * like.step / setting.step
    return None


def mesh_error(
    subject: Subject,
    watched: Watched,
    reference: Reference,
    meshes: Sequence[float],
    progress: Callable[[str], None] = lambda text: None,
) -> float:
    """Error of the reference's mesh, relative: zero where meshes are not compared.

    Runs with the reference's own method and step, so that the mesh is all in which they differ, are off a reference of
    twice the finest by e and, of r times fewer elements, by e'. Where errors fall as n^-p these are as 1 - 2^-p to
    r^p - 2^-p, which tells p (between one half and four), and the reference is off by e / (2^p - 1).
    """
    sizes = sorted(set(meshes))[-2:]
    if len(sizes) < 2:
        return 0.0
    found = []
    for size in sizes:
        progress(f"mesh: {size:g} x the elements, step {reference.step:.3g} s")
        trial = subject.run(replace(reference.setting, elements=size))
        if not trial.done or trial.result is None:
            return 0.0
        found.append(compare(watched.of(trial.result), reference.history, watched.extent).position)
    (coarse, fine), (before, error) = sizes, found
    order = np.interp(before / max(error, 1e-300), _growth(fine / coarse, MESH_ORDERS), MESH_ORDERS)
    return float(error / (2.0**order - 1.0))


def _growth(ratio: float, order: np.ndarray) -> np.ndarray:
    """Difference of a coarser mesh from one of twice the finest over that of the finest, for orders of convergence."""
    return (ratio**order - 2.0**-order) / (1.0 - 2.0**-order)


def _elsewhere(rows: Sequence[Row], tolerance: float, unknown: float) -> list[tuple[str, float]]:
    """Methods whose finest runs agree on something that is not the reference, and by how much that is off.

    ``unknown`` is the relative error that the reference itself may have: what is no further off may be right.
    """
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
        if coarse >= 1.9 * fine > 0.0 and error > max(tolerance, CLEAR * unknown) and before < 1.5 * error:
            found.append((name, error))
    return found


def still(watched: Watched) -> str:
    """What there is to say of errors where the point that is looked at does not move."""
    return f"{watched.point_said} does not move: no error can be seen there; name another with --point, if any does"


def _not_proved(what: str, difference: float) -> str:
    """What there is to say of a force or a twist that the reference does not know to the tolerance."""
    return (
        f"only position is proved: {what} differs by {100.0 * difference:.2g} % between the two finest runs of the "
        "reference, and smaller errors of it mean nothing"
    )


def _row(trial: Trial, watched: Watched, reference: Reference | None) -> Row:
    if not trial.done or trial.result is None or reference is None:
        return Row(trial, None)
    return Row(trial, compare(watched.of(trial.result), reference.history, watched.extent))


def _warnings(
    reference: Reference | None, tangent: float | None, rows: Sequence[Row], tolerance: float, watched: Watched
) -> list[str]:
    found = []
    if not watched.moves:
        found.append(still(watched))
    elsewhere = _elsewhere(rows, tolerance, 0.0 if reference is None else reference.error)
    if elsewhere:
        names = "; ".join(f"{name} by {100.0 * error:.2g} %" for name, error in elsewhere)
        found.append(
            f"these runs do not converge to the reference: {names}. They solve another problem (explicit methods "
            "take other laws of friction; meshes and penalties have errors of their own)"
        )
    if reference is None:
        found.append("no reference: no four runs of falling step came to their end; name a step with --reference-step")
    elif not reference.converged:
        text = f"the reference is not proved: {reference.why}"
        found.append(f"{text}; errors below {max(reference.error, 1e-16):.1e} mean nothing")
    if reference is not None and reference.force_error is not None and reference.force_error > tolerance:
        found.append(
            f"{_not_proved('the amplitude of the force', reference.force_error)}. A smaller solver.tolerance lets less "
            "of the iterations be seen in it"
        )
    if reference is not None and reference.twist_error is not None and reference.twist_error > tolerance:
        found.append(_not_proved(f"the {watched.twist_said}", reference.twist_error))
    if tangent is not None and tangent > WRONG_TANGENT:
        found.append(
            f"a tangent is wrong by {tangent:.1e} of its size: implicit methods iterate more than they should, and "
            "frequencies that are found with it are wrong; report the scene"
        )
    return found
