"""Critical step against the stiffness of penalty springs and of contact: Fig. 2.26 for any scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tautline.integrators.status import StoppedEarly
from tautline.run import Run
from tautline.scene.errors import SceneError
from tautline.scene.methods import method_of
from tautline.study.robustness.critical import CriticalStepSearch
from tautline.study.trials.trial import Setting, Subject

DECADES = (-4, -3, -2, -1, 0, 1, 2, 3)
"""Of stiffness about the scene's own."""


class Stiffness(NamedTuple):
    """A stiffness, N/m, of ``penalty`` springs or ``contact``, and the critical step at the start, s, or None."""

    kind: str
    value: float
    critical_step: float | None


def penalties(subject: Subject, progress: Callable[[str], None] = lambda text: None) -> list[Stiffness]:
    """Critical steps of the scene with its springs made softer and stiffer; empty where it has none."""
    own = subject.application.vary(subject.scene, "stiffnesses") or {}
    found = []
    for kind in ("penalty", "contact"):
        stiffness = own.get(kind)
        for decade in DECADES if stiffness else ():
            value = float(stiffness) * 10.0**decade
            progress(f"{kind} stiffness {value:.2g} N/m")
            found.append(Stiffness(kind, value, _critical(subject, kind, value)))
    return found


def _critical(subject: Subject, kind: str, value: float) -> float | None:
    try:
        varied = subject.varied(kind, value)
        if varied is None:
            return None
        try:
            model = varied.model(Setting(subject.explicit))
        except SceneError:
            model = varied.model(Setting())
        run = Run(model)
        run.start()
    except (SceneError, StoppedEarly):
        return None
    look = CriticalStepSearch(model.system, method_of(subject.explicit))
    look(run.state, 0.0)
    return look.start if np.isfinite(look.start) else None
