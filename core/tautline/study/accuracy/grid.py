"""Which settings a study runs: methods, steps, meshes, and ways to impose constraints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.run import Run
from tautline.scene.errors import SceneError, option_error
from tautline.scene.methods import explicit_like, implicit_like, method_of
from tautline.study.trials.trial import Setting, Subject

IMPLICIT = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25)
"""Steps of implicit methods over the scene's."""
EXPLICIT = (0.95, 0.5, 0.25, 0.125)
"""Steps of explicit methods over their critical step."""
LOOSER = (100.0, 10.0, 1.0, 0.1)
"""Errors of a step over the scene's, where the step is controlled by its error."""


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
    newton : sequence of str
        ``modified``, ``full``: whether implicit methods keep old factors.
    """

    methods: Sequence[str] | None = None
    steps: Sequence[float] | None = None
    elements: Sequence[float] = (1.0,)
    constraints: Sequence[str] = ()
    newton: Sequence[str] = ()


def settings(subject: Subject, grid: Grid, step: float, shrinks: float, reduced: bool) -> list[Setting]:
    """Every combination that is asked for, the cheapest of each kind first.

    Parameters
    ----------
    step : float
        That the scene takes in the mean, s.
    shrinks : float
        Least critical step along a run, over that at its start.
    reduced : bool
        Whether every other step of the usual grid is left out.

    Raises
    ------
    SceneError
        For a way to impose constraints that the scene does not have.
    """
    own = subject.model(Setting()).solver
    methods = grid.methods or (explicit_like(own.method), implicit_like(own.method))
    found: list[Setting] = []
    for constraint in _constraints(subject, grid.constraints) or (None,):
        for elements in sorted(set(grid.elements)):
            if elements != 1.0 and subject.varied("elements", elements) is None:
                continue
            for method, newton in _iterated(methods, grid.newton):
                kind = Setting(method, None, None, None, elements, constraint, newton)
                steps = _steps(subject, grid, kind, step, shrinks)
                steps = sorted({_divided(h, own.interval) for h in steps}, reverse=True)
                found += [replace(kind, step=h) for h in (steps[::2] if reduced and grid.steps is None else steps)]
                if own.step_error > 0.0 and not method_of(method).explicit and grid.steps is None:
                    errors = [own.step_error * factor for factor in (LOOSER[2:3] if reduced else LOOSER)]
                    found += [replace(kind, step=own.interval, step_error=error) for error in errors]
    return found


def _iterated(methods: Sequence[str], newton: Sequence[str]) -> list[tuple[str, str | None]]:
    """Each method, the implicit ones with each way to iterate that is asked for."""
    ways = {method: newton if newton and not method_of(method).explicit else (None,) for method in methods}
    return [(method, each) for method in methods for each in ways[method]]


def _divided(step: float, interval: float) -> float:
    """The step that is taken where frames of an interval are divided into equal steps, s."""
    return step if step >= interval else interval / np.ceil(interval / step - 1e-9)


def _constraints(subject: Subject, asked: Sequence[str]) -> Sequence[str]:
    """Ways to impose constraints that are asked for; raises SceneError for one that the scene does not have."""
    known = tuple(subject.application.vary(subject.scene, "constraints") or ())
    if "all" in asked:
        return known
    for name in asked:
        if name not in known:
            cause = "the scene cannot impose its constraints so"
            cure = (
                f"give some of {', '.join(known)}, or all" if known else "leave --constraints out: there is no choice"
            )
            raise option_error("--constraints", name, cause, cure)
    return asked


def _steps(subject: Subject, grid: Grid, setting: Setting, step: float, shrinks: float) -> Sequence[float]:
    if grid.steps is not None:
        return grid.steps
    if not method_of(setting.method).explicit:
        return [step * factor for factor in IMPLICIT]
    critical = critical_at_start(subject, setting)
    return [critical * shrinks * factor for factor in EXPLICIT] if critical is not None else [step]


def critical_at_start(subject: Subject, setting: Setting) -> float | None:
    """Critical step where the scene starts, s; None where it cannot be run so, or nothing vibrates."""
    try:
        run = Run(subject.model(setting))
        run.start()
    except (SceneError, StoppedEarly):
        return None
    critical, _ = CriticalStep(run.model.system, method_of(run.model.solver.method)).search(run.state, 0.0)
    return critical if np.isfinite(critical) else None
