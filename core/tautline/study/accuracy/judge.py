"""Which run is the reference of a study."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from tautline.integrators.statics.attainable import within_rounding
from tautline.kernels.groups import may_switch
from tautline.scene.methods import method_of
from tautline.study.accuracy.grid import critical_at_start
from tautline.study.accuracy.reference import Reference, find_reference
from tautline.study.trials.history import Watched
from tautline.study.trials.trial import Setting, Subject, Trial
from tautline.system.model import Model

FEW_STEPS = 20.0
"""Steps of RK4, over those that the scene takes, up to which it is tried as the reference."""
BELOW = 0.9
"""Share of its critical step that RK4 begins with."""
SHARPER = 0.01
"""Tolerance of a reference, over that of the scene."""


class Sharpened:
    """A subject whose iterations leave so little that it is the step that a reference is wrong by.

    What iterations leave does not fall with the step: halving it would not show it, and the runs that are judged have
    it too. A run that does not come to its end so is made with the scene's own tolerance.

    Parameters
    ----------
    subject : Subject
    """

    def __init__(self, subject: Subject) -> None:
        self.subject, self.sharp = subject, replace(subject, change=lambda model: _sharpened(subject.change(model)))

    def run(self, setting: Setting) -> Trial:
        """Run a setting, as `Subject.run` does."""
        if setting.method is not None and method_of(setting.method).explicit:
            return self.subject.run(setting)
        trial = self.sharp.run(setting)
        return trial if trial.done else self.subject.run(setting)


def _sharpened(model: Model) -> Model:
    """A model with a smaller tolerance, as far as its numbers can reach it."""
    return within_rounding(replace(model, solver=replace(model.solver, tolerance=SHARPER * model.solver.tolerance)))


def choose_reference(
    subject: Subject,
    watched: Watched,
    trials: Sequence[Trial],
    base: Trial,
    finest: float,
    tolerance: float,
    budget: float,
    asked: Setting | None,
    progress: Callable[[str], None] = lambda text: None,
) -> Reference | None:
    """The reference asked for; else of RK4 where it can do it and no law switches, and of the scene's method.

    Parameters
    ----------
    trials : sequence of Trial
        What it is to judge.
    base : Trial
        The scene as it stands.
    finest : float
        Number of elements, over the scene's, that the reference has.
    asked : Setting or None
        Method, and the step to stop at, of the user's choice; either may be None.

    Returns
    -------
    Reference or None
        The first that is proved, or else the one with the least error; None where there are no four runs of any.
    """
    judged = [watched.of(trial.result) for trial in trials if trial.done and trial.result is not None]
    model = subject.model(Setting(elements=finest))
    first = _first_steps(subject, base, finest, may_switch(model.system.groups))
    named = None
    if asked is not None:
        method = asked.method or str(base.attribute("method"))
        named = asked.step
        first = {method: asked.step or first.get(method) or float(model.solver.interval)}
    best: Reference | None = None
    for method, step in first.items():
        interval = float(model.solver.interval)
        divided = interval / 2.0 ** max(0, int(np.ceil(np.log2(interval / step) - 1e-9)))
        setting = Setting(method, divided, None, None, finest)
        found = find_reference(Sharpened(subject), watched, setting, tolerance, budget, named, judged, progress)
        if found is not None and found.converged:
            return found
        if found is not None and (best is None or found.error < best.error):
            best = found
    return best


def _first_steps(subject: Subject, base: Trial, finest: float, switches: bool) -> dict[str, float]:
    """Methods that may be the reference, the best first, and the step that each begins with, s."""
    own = str(base.attribute("method"))
    taken = float(base.attribute("end")) / max(1, int(base.attribute("steps")))
    critical = critical_at_start(subject, Setting(subject.explicit, None, None, None, finest))
    found: dict[str, float] = {}
    if critical is not None and FEW_STEPS * critical > taken and not switches:
        found[subject.explicit] = BELOW * critical
    # From the scene's own step down: orders are seen early, and the last runs are as fine as what they judge asks.
    found.setdefault(own, taken)
    return found
