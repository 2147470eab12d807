"""A reference that proves itself: steps are halved until the two finest agree in the order of their method."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tautline.scene.methods import method_of
from tautline.study.trials.errors import compare, motion
from tautline.study.trials.history import History, Watched
from tautline.study.trials.trial import Setting, Trial

WITHIN = 0.5
"""By how much the observed order may be off."""
SHARE = 0.1
"""Share of the error asked for that the reference itself may have."""
CLEAR = 4.0
"""Times the reference's own error that a run must be off, for its error to mean something."""
ROUNDING = 1.0e-11
"""Relative difference of two runs that is rounding at least: no order is to be seen below."""
SUMS = 8.0 * float(np.finfo(float).eps)
"""Rounding of a coordinate over its size, of the few sums of a step: steps add up as a random walk."""
ENOUGH = 4
"""Runs that a reference takes: two orders are seen in them, and one of them may be luck."""
MOST = 14
"""Halvings, at most."""


@dataclass(frozen=True)
class Reference:
    """The finest run, and what is known of its error.

    Attributes
    ----------
    trial : Trial
    history : History
    setting : Setting
    differences : tuple of (float, float)
        Step, s, and difference of position to the run of half that step, relative.
    observed_order : float or None
        From the last three runs; None where rounding hides it.
    error : float
        Of the reference's position, relative, estimated after Richardson with the observed order (at least one half).
    converged : bool
        Whether the error is small enough and the order is the method's.
    why : str
        What is lacking, for people; empty if converged.
    mesh_error : float
        Estimated error of its mesh, relative, where meshes are compared; what is proved is the step.
    force_error : float or None
        Difference of the force's amplitude between the two finest, over that amplitude: only position is proved.
    twist_error : float or None
        Difference of a string's twist between the two finest, over what it varies by: as of a method of first order.
    """

    trial: Trial
    history: History
    setting: Setting
    differences: tuple[tuple[float, float], ...]
    observed_order: float | None
    error: float
    converged: bool
    why: str
    mesh_error: float = 0.0
    force_error: float | None = None
    twist_error: float | None = None

    @property
    def step(self) -> float:
        """Step of the finest run, s."""
        return float(self.trial.attribute("step"))


class Runs(Protocol):
    """What makes runs of a setting: a subject."""

    def run(self, setting: Setting) -> Trial:
        """Run a setting."""


def find_reference(
    subject: Runs,
    watched: Watched,
    setting: Setting,
    tolerance: float,
    budget: float,
    finest: float | None = None,
    judged: Sequence[History] = (),
    progress: Callable[[str], None] = lambda text: None,
) -> Reference | None:
    """Halve the step of a setting until its error is a tenth of a tolerance, in the order of the method.

    Parameters
    ----------
    subject : Runs
        What makes the runs.
    setting : Setting
        Method and first step, s.
    tolerance : float
        Relative error of position that the study is about.
    budget : float
        Wall time, s, that one run may take: no step is tried that would take longer.
    finest : float or None
        Step, s, to stop at, or as much below as four runs take; None for as fine as it must be.
    judged : sequence of History
        What it is to judge: the reference goes on until its own error is well below theirs, or the budget is used up.

    Returns
    -------
    Reference or None
        None if fewer than four runs came to their end.
    """
    assert setting.method is not None and setting.step is not None
    runs: list[tuple[Trial, History]] = []
    best: Reference | None = None
    proved: Reference | None = None
    step = setting.step if finest is None else 2.0 ** (ENOUGH - 1) * finest
    for _ in range(MOST):
        progress(f"reference: {setting.method}, step {step:.3g} s")
        trial = subject.run(_with_step(setting, step))
        if trial.done and trial.result is not None:
            runs.append((trial, watched.of(trial.result)))
        if len(runs) >= ENOUGH:
            best = _judged(runs, watched, tolerance, float(method_of(setting.method).order))
            proved = best if best.converged else proved
            if best.converged and (finest is not None or _clear(best, judged, watched, SHARE * tolerance)):
                return best
        spent = trial.cpu_time or 0.0
        named = finest is not None and step <= finest * (1.0 + 1e-9) and len(runs) >= ENOUGH
        if 2.0 * spent > budget or named:
            break
        step *= 0.5
    return proved or best


def _clear(reference: Reference, judged: Sequence[History], watched: Watched, twist: float) -> bool:
    """Whether the reference's own error is well below those of all runs that it judges, and of twist below a share."""
    if (reference.twist_error or 0.0) > twist:
        return False
    errors = (compare(history, reference.history, watched.extent).position for history in judged)
    return all(error >= CLEAR * reference.error for error in errors) or reference.error <= ROUNDING


def _with_step(setting: Setting, step: float) -> Setting:
    return Setting(setting.method, step, None, setting.rho_inf, setting.elements, setting.constraint, setting.newton)


def _rounding(history: History, extent: float, steps: int) -> float:
    """Relative difference of two runs that is rounding: of coordinates, over so many steps, over what they move."""
    size = motion(history, extent)
    return max(ROUNDING, SUMS * steps**0.5 * float(np.abs(history.position).max(initial=0.0)) / size)


def _order(coarse: tuple[float, float], fine: tuple[float, float], floor: float = ROUNDING) -> float | None:
    """Order that two differences show, steps being what they are; None where rounding hides it."""
    (step, first), (shorter, second) = coarse, fine
    if second <= floor or first <= 0.0:
        return None
    # Steps are made to divide the frames: two runs may differ by a factor that is not two.
    return math.log(first / second) / math.log(max(step / shorter if shorter > 0.0 else 2.0, 1.0 + 1e-9))


def _judged(runs: list[tuple[Trial, History]], watched: Watched, tolerance: float, order: float) -> Reference:
    """What the last four runs, and the differences of all before, say of the finest."""
    found: list[tuple[float, float]] = []
    force, twist = None, None
    for (trial, coarse), (_, fine) in itertools.pairwise(runs):
        errors = compare(coarse, fine, watched.extent)
        found.append((float(trial.attribute("step")), errors.position))
        force, twist = errors.force, errors.twist
    second = found[-1][1]
    floor = _rounding(runs[-1][1], watched.extent, int(runs[-1][0].attribute("steps") or 1))
    orders = [_order(found[i], found[i + 1], floor) for i in (-3, -2)]
    observed = orders[-1]
    gain = 2.0 ** (order if observed is None else float(np.clip(observed, 0.5, order))) - 1.0
    error = max(second, floor) / gain
    odd = [each for each in orders if each is not None and abs(each - order) > WITHIN]
    if odd and observed is not None:
        # Orders that jump promise nothing: the larger of the last differences may come again.
        error = max(found[-2][1], second) / (2.0**0.5 - 1.0)
    why = []
    if error > SHARE * tolerance:
        why.append(f"its own error is about {error:.1e}, more than a tenth of the tolerance {tolerance:.1e}")
    if odd and observed is not None:
        seen = ", ".join("hidden" if each is None else f"{each:.2g}" for each in orders)
        why.append(f"the observed orders are {seen}, not {order:g}: laws that switch, or steps still too long")
    trial, history = runs[-1]
    return Reference(
        trial,
        history,
        trial.setting,
        tuple(found),
        observed,
        error,
        not why,
        "; ".join(why),
        force_error=force,
        twist_error=twist,
    )
