"""What limits a scene's step, and what breaks it: critical step, conditioning, drift, and variants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from tautline.integrators.status import Interrupted, StoppedEarly
from tautline.scene.errors import SceneError
from tautline.scene.methods import method_of
from tautline.simulation import simulate
from tautline.study.accuracy.precision import WRONG_TANGENT, TangentLook, require_tolerance, still
from tautline.study.robustness.conditioning import Condition, conditioning
from tautline.study.robustness.critical import Critical, critical_steps
from tautline.study.robustness.drift import Drift
from tautline.study.robustness.penalties import Stiffness, penalties
from tautline.study.robustness.variants import Change, Variant, changes, variants
from tautline.study.trials.history import Watched, watch
from tautline.study.trials.omissions import of_time
from tautline.study.trials.trial import Setting, Subject

UNLIKE = 0.25
"""Relative difference of the critical step by eigenvalues and by real runs from which it is told."""


@dataclass(frozen=True)
class Stability:
    """What was found.

    Attributes
    ----------
    critical : Critical
    penalties : list of Stiffness
    conditions : list of Condition
    energy_drift : float or None
        Energy created numerically over what went through the system, in the scene as it stands.
    constraint_drift : float or None
        Largest violation of what multipliers hold, m; None where they hold nothing.
    tangent : float or None
        Largest relative error of the tangent; None where the scene has no implicit form.
    variants : list of Variant
    warnings : tuple of str
    left_out : tuple of str
        What a quick look has not tried.
    interrupted : bool
    stop : StoppedEarly or None
        How the scene as it stands stopped, if it did.
    """

    critical: Critical
    penalties: list[Stiffness]
    conditions: list[Condition]
    energy_drift: float | None
    constraint_drift: float | None
    tangent: float | None
    variants: list[Variant]
    warnings: tuple[str, ...]
    left_out: tuple[str, ...] = ()
    interrupted: bool = False
    stop: StoppedEarly | None = None


def stability(
    subject: Subject,
    tolerance: float = 0.01,
    budget: float = 20.0,
    point: str | None = None,
    quick: bool = False,
    progress: Callable[[str], None] = lambda text: None,
) -> Stability:
    """Look a scene over.

    Parameters
    ----------
    tolerance : float
        Relative error of position up to which a variant is right.
    budget : float
        Processor time, s, that one run of a variant may take.
    point : str or None
        Label of what to look at.
    quick : bool
        Fewer variants.

    Raises
    ------
    SceneError
        For bad input.
    """
    require_tolerance(tolerance)
    progress("the scene as it stands")
    stop: StoppedEarly | None = None
    energy = drift = tangent = watched = None
    try:
        energy, drift, tangent, watched = _as_it_stands(subject, point)
    except StoppedEarly as early:
        stop = early
    critical = critical_steps(subject, progress)
    found: list[Any] = [[], [], []]
    interrupted = False
    try:
        found[0] = penalties(subject, progress)
        progress("conditioning")
        found[1] = _conditions(subject)
        found[2] = variants(subject, tolerance, budget, point, quick, None, progress)
    except Interrupted:
        interrupted = True
    warnings = tuple([] if watched is None or not watched.rests else [still(watched)]) + tuple(
        _warnings(critical, tangent, found[2])
    )
    left_out = left_out_of(subject) if quick else ()
    return Stability(critical, *found[:2], energy, drift, tangent, found[2], warnings, left_out, interrupted, stop)


def _as_it_stands(subject: Subject, point: str | None) -> tuple[float | None, float | None, float | None, Watched]:
    """Drift of energy and of constraints, largest error of the tangent in a run of the scene, and what is looked at."""
    model = subject.model(Setting())
    drift, comparison = Drift(model.system), TangentLook(model.system)

    def look(state: Any, t: float, method: Any) -> None:
        drift(state, t)
        comparison(state, t, method)

    result = simulate(model, announce=subject.announce, look=look)
    return (
        result.attributes.get("energy_error"), drift.largest if drift.there else None,
        comparison.largest_of(subject), watch(result, point),
    )  # fmt: skip


def _conditions(subject: Subject) -> list[Condition]:
    try:
        return conditioning(subject)
    except SceneError:
        return []


def _warnings(critical: Critical, tangent: float | None, found: list[Variant]) -> list[str]:
    texts = []
    if tangent is not None and tangent > WRONG_TANGENT:
        texts.append(
            f"a tangent is wrong by {tangent:.1e} of its size: eigenvalues found with it are wrong; report the scene"
        )
    if critical.bisection is not None and critical.at_start is not None:
        high = critical.bisection[1]
        least = min(critical.at_start, critical.eigenvalue or critical.at_start)
        if high < (1.0 - UNLIKE) * least:
            text = f"real runs are unstable from {high:.3g} s on, below the {least:.3g} s of the eigenvalues"
            texts.append(f"{text}: what the state does between the looks, or a wrong tangent, makes it less")
    texts += [
        f"{v.name}: wrong by {100.0 * (v.error or 0.0):.2g} %, and the run {_stated_by_run(v)}"
        for v in found
        if v.silent
    ]
    return texts


def _stated_by_run(variant: Variant) -> str:
    return f"states {100.0 * variant.stated:.2g} %" if variant.stated else "said nothing"


def left_out_of(subject: Subject) -> tuple[str, ...]:
    """What a quick look at stability does not try: time, variants that the scene has, and the second judge."""
    method = subject.model(Setting()).solver.method
    tried = set(changes(quick=True))
    names = [c.name for c in changes(quick=False) if c not in tried and _has(subject, c, method)]
    left_out = [*of_time(subject)]
    if names:
        left_out.append(f"not tried: {', '.join(names)}")
    left_out.append("variants are judged by a quarter of their step alone")
    return tuple(left_out)


def _has(subject: Subject, change: Change, method: str) -> bool:
    """Whether a scene has what a change varies; what it refuses it has."""
    if change.rho_inf is not None:
        return method_of(method).has_alphas
    try:
        return not change.what or subject.varied(change.what, change.value) is not None
    except SceneError:
        return True
