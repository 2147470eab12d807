"""Stiff and extreme variants of a scene: right, inaccurate by how much, or stopped by which error.

Each variant is run with the scene's step, and judged by runs of itself with shorter steps. A run that is wrong and says
nothing of it is a fault, of the scene's or of ours.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.scene.methods import method_of
from tautline.study.trials.errors import compare
from tautline.study.trials.history import History, Watched, watch
from tautline.study.trials.step_error import NOT_KNOWN, estimate, runs_for
from tautline.study.trials.trial import GIVEN_UP, Setting, Subject, Trial

STIFFNESSES = (1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6)
STEPS = (0.1, 10.0, 100.0)
SHORTEST = STEPS[0]
RADII = (0.0, 0.5, 1.0)
MESHES = (0.5, 2.0)
SHORTER = 100.0
CONTACTS = (1e4, 1e6, 1e8, 1e10, 1e12)
DIVIDED = (4.0, 16.0)
"""Parts of the step of the runs by which a variant is judged."""
MEANT = 2.0
"""Times what a run states of its own error, as lag in radians or from runs with other steps, that an error of position
may be without being a surprise."""
DOUBT = 0.5
"""Share of an error by which its estimate may be off; a finer run is asked for above."""


@dataclass(frozen=True)
class Change:
    """A variant: its name, what of the scene is varied with which value, and how it is set."""

    name: str
    what: str = ""
    value: float = 1.0
    step: float = 1.0
    rho_inf: float | None = None


@dataclass(frozen=True)
class Variant:
    """How a variant came out.

    Attributes
    ----------
    name : str
    outcome : str
        ``right``, ``inaccurate`` or ``stopped``; ``refused`` for a scene that cannot be, and ``unjudged`` where it was
        given up, or no run with a shorter step came to its end, or would have in time.
    error : float or None
        Relative error of position.
    status : str
        ``done``, or what stopped it.
    warnings : tuple of str
        What the run itself warned of.
    lag, energy_error : float
        Its own estimate of how late free oscillations are, rad, and the error of its energy balance.
    wall_time : float or None
        s.
    stated : float
        Relative error of position that `simulate` states, from runs with other steps; 0 where it states none, and where
        nothing depends on it.
    """

    name: str
    outcome: str
    error: float | None
    status: str
    warnings: tuple[str, ...] = ()
    wall_time: float | None = None
    lag: float = 0.0
    energy_error: float = 0.0
    stated: float = 0.0

    @property
    def silent(self) -> bool:
        """Whether it was wrong without a word: no warning, and more than what the run says of itself explains.

        That is its lag, the error that it states, and its energy: motion that has lost a share of it is off by the root
        of the share.
        """
        explained = max(MEANT * self.lag, MEANT * self.stated, math.sqrt(self.energy_error))
        return self.outcome == "inaccurate" and not self.warnings and (self.error or 0.0) > explained


def changes(quick: bool) -> list[Change]:
    """All variants, or every few of them."""
    found = [Change("as it stands")]
    found += [Change(f"stiffness x {f:g}", "stiffness", f) for f in (STIFFNESSES[2::3] if quick else STIFFNESSES)]
    found += [Change(f"step x {f:g}", step=f) for f in (STEPS[:2] if quick else STEPS)]
    found += [Change(f"rho_inf {r:g}", rho_inf=r) for r in (RADII[::2] if quick else RADII)]
    found += [Change(f"elements x {f:g}", "elements", f) for f in MESHES]
    found += [Change(f"shortest element / {SHORTER:g}", "shortest", SHORTER)]
    found += [Change(f"contact {k:g} N/m", "contact", k) for k in (CONTACTS[::4] if quick else CONTACTS)]
    return found


def variants(
    subject: Subject,
    tolerance: float,
    budget: float,
    point: str | None = None,
    quick: bool = False,
    method: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> list[Variant]:
    """Run every variant that the scene has.

    Parameters
    ----------
    tolerance : float
        Relative error of position up to which a run is right.
    budget : float
        Processor time, s, that one run may take: a longer one is given up.
    point : str or None
        Label of what to look at.
    quick : bool
        Fewer variants, each judged by one run less.
    method : str or None
        Method, in place of the scene's.
    """
    found: list[Variant] = []
    own = subject.model(Setting(method)).solver
    step = min(own.step, own.interval)
    base = subject.run(Setting(method))
    if not base.done:
        # What moves is told by a run that came further, if there is one.
        finer = subject.run(Setting(method, SHORTEST * step), seconds=budget)
        base = finer if finer.result is not None else base
    if base.result is None:
        return found
    watched = watch(base.result, point)
    for change in changes(quick):
        varied = _varied(subject, change)
        if varied is None or (change.rho_inf is not None and not method_of(own.method).has_alphas):
            continue
        progress(change.name)
        if isinstance(varied, Variant):
            found.append(varied)
            continue
        setting = Setting(method, step * change.step if change.step != 1.0 else None, None, change.rho_inf)
        found.append(_judged(varied, setting, step, change, tolerance, budget, watched, quick))
    return found


def _varied(subject: Subject, change: Change) -> Subject | Variant | None:
    try:
        return subject.varied(change.what, change.value) if change.what else subject
    except SceneError as error:
        return Variant(change.name, "refused", None, error.problems[0].cause)


def _judged(
    subject: Subject, setting: Setting, step: float, change: Change, tolerance: float, budget: float,
    watched: Watched, quick: bool,
) -> Variant:  # fmt: skip
    trial = subject.run(setting, seconds=budget)
    warnings = _warnings_of(subject, setting, trial)
    if trial.status == "refused":
        return Variant(change.name, "refused", None, trial.sentence)
    if trial.status == GIVEN_UP:
        return Variant(change.name, "unjudged", None, f"{GIVEN_UP} {trial.sentence}", warnings)
    if not trial.done or trial.result is None:
        return Variant(change.name, "stopped", None, trial.status, warnings, trial.wall_time)
    taken = float(trial.result.time[-1]) / max(1, int(trial.attribute("steps")))
    error, known = _error(subject, setting, trial, taken, watched, budget, quick)
    if error is None:
        return Variant(change.name, "unjudged", None, known, warnings, trial.wall_time)
    outcome = "right" if error <= tolerance else "inaccurate"
    stated = 0.0
    if outcome == "inaccurate" and not warnings:
        # What `simulate` finds out by itself, by further runs, is asked for only where it decides.
        stated, warnings = _stated(subject, setting, trial.result)
    own = (float(trial.attribute(name) or 0.0) for name in ("phase_lag", "energy_error"))
    return Variant(change.name, outcome, error, "done", warnings, trial.wall_time, *own, stated)


def _stated(subject: Subject, setting: Setting, result: Result) -> tuple[float, tuple[str, ...]]:
    """The error of position that ``simulate`` would state of a run, unasked, or the warning that it is not known.

    A statement is no warning here: whether it is near enough is to be seen.
    """
    parts = runs_for(subject.model(setting))
    if not parts:
        return 0.0, ()
    found = estimate(subject, result, setting, parts=parts)
    if isinstance(found, str):
        return 0.0, (NOT_KNOWN.format(found),) if found else ()
    return found.position, ()


def _warnings_of(subject: Subject, setting: Setting, trial: Trial) -> tuple[str, ...]:
    """What ``simulate`` would have said: the scene's warnings of its solver, and the run's own warnings."""
    of_run = [] if trial.result is None else trial.result.warnings
    try:
        scene = subject.arranged(setting)
    except SceneError:
        return tuple(of_run)
    of_scene = [str(c) for c in subject.application.warnings(scene) if _of_steps(c)]
    return (*of_scene, *of_run)


def _of_steps(warning: Any) -> bool:
    return any(word in str(warning.where) for word in ("solver", "GeneralizedAlpha", "mesh", "elements"))


def _error(
    subject: Subject, setting: Setting, trial: Trial, step: float, watched: Watched, budget: float, quick: bool
) -> tuple[float | None, str]:
    """Error of a run by runs of shorter steps; None, and why, where there is none to judge by."""
    assert trial.result is not None
    coarse = watched.of(trial.result)
    error: float | None = None
    why = "no run with a shorter step came to its end"
    finer: Sequence[float] = DIVIDED[:1] if quick else DIVIDED
    for part in finer:
        if (trial.cpu_time or 0.0) * part > budget:
            return error, f"a run to judge it by would take more than {budget:g} s"
        fine = subject.run(Setting(setting.method, step / part, None, setting.rho_inf), seconds=budget)
        if fine.status == GIVEN_UP:
            return error, f"the run to judge it by was {GIVEN_UP} {fine.sentence}"
        if not fine.done or fine.result is None:
            continue
        before, error = error, _distance(coarse, fine.result, watched)
        if before is not None and abs(error - before) <= DOUBT * error:
            break
    return error, why


def _distance(run: History, reference: Result, watched: Watched) -> float:
    try:
        return compare(run, watched.of(reference), watched.extent).position
    except ResultError:
        return float("inf")
