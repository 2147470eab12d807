"""Bars of any number of elements, joined in three ways, as subjects of a study; what a run of them took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from benchmarks.thesis.bars import scenes as bars
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.study.trials.errors import Errors, compare
from tautline.study.trials.history import watch
from tautline.study.trials.trial import Subject, Trial
from tautline.system.model import Model

ALPHAS = {"alpha_m": -0.05, "alpha_f": 0.1, "eps_energy": 1e-10, "maxIter": 20}
"""Of the thesis' generalized-alpha (Appendix A)."""
HIT = 0.01
"""The hammer's force, N, for 1 s."""


def subject_of(items: Sequence[str], end: float, interval: float, gravity: float = 0.0, **solver: Any) -> Subject:
    """A scene of bars under study; RK4 does not look after its step, see `unguarded`."""
    listed = "".join(f"  - {item}\n" for item in items)
    settings = {"type": "G-alpha", "time_end": end} | ALPHAS | solver
    written = ", ".join(f"{key}: {value!r}" for key, value in settings.items())
    heading = f"CableModelMaterial: {{Gravity: [{gravity!r}, 0, 0]}}"
    scene = parse(f"{heading}\nCableModel:\n{listed}GeneralizedAlpha: {{{written}}}\n")
    return Subject(Cable(), scene, interval=interval, change=unguarded)


def unguarded(model: Model) -> Model:
    """The model without the watch over RK4's step, which takes as long as hundreds of steps of a bar."""
    return replace(model, solver=replace(model.solver, guarded=False))


def tied(count: int, EA: float) -> list[str]:
    """One metre and one kilogram in equal elements, each with its own nodes, tied in position and slope (eq. 2.157).

    Written with multipliers; a study imposes the ties in other ways.
    """
    items = []
    for i in range(count):
        ends = (i / count, (i + 1) / count)
        items += [bars.node(2 * i, ends[0], "pinned" if i == 0 else "free"), bars.node(2 * i + 1, ends[1])]
        items.append(bars.element(i, (2 * i, 2 * i + 1), EA))
    pairs = [(2 * i + 1, 2 * i + 2, what) for i in range(count - 1) for what in (0, 2)]
    return items + [f"LagMultipl7: {{id: {k}, nodes7: [{a}, {b}], constr: {w}}}" for k, (a, b, w) in enumerate(pairs)]


def hammer(last: int) -> str:
    """The blow on the bar's last node."""
    return f"PointForce: {{id: 0, nodes7: [{last}], force: [{HIT!r}, 0, 0], timeInterval: [0, 1]}}"


def per_step(trial: Trial) -> float | None:
    """CPU time of a step, microseconds; None where it did not come to its end."""
    return 1e6 * trial.cpu_time / trial.attribute("steps") if trial.done and trial.cpu_time is not None else None


def off(trial: Trial, other: Trial) -> Errors | None:
    """How far a run is off another of the same scene; None where one of them did not come to its end."""
    if not (trial.done and other.done) or trial.result is None or other.result is None:
        return None
    watched = watch(other.result)
    return compare(watched.of(trial.result), watched.of(other.result), watched.extent)


def over(time: float | None, unit: float | None) -> float | None:
    """A time over another; None where there is none."""
    return time / unit if time is not None and unit else None


def cpu(trial: Trial) -> float | None:
    """CPU time of a run that came to its end, s."""
    return trial.cpu_time if trial.done else None
