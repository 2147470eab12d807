"""How far what `simulate` finds with half the step is from the error itself, in scenes with dry friction."""

from __future__ import annotations

import statistics
from typing import NamedTuple

import jwell
from page import Section, number, show, table

import tautline
from crane.application import Crane
from drillstring.application import Drillstring
from tautline.study.errors import compare
from tautline.study.history import watch
from tautline.study.step_error import step_error
from tautline.study.trial import Setting, Subject

SCENES = (("jwell", 4.0), ("jwell", 40.0), ("tripping", 10.0), ("hoist", 12.0), ("sixteen_falls", 5.0))
"""Shipped scenes, and how much of each is simulated, s."""
LONGER = (1.0, 2.5, 5.0, 10.0)
"""Steps over the scene's own."""
FINER = 32.0
"""Step over that of the run which is taken for exact."""


class Told(NamedTuple):
    """One run: its step, s, its error of position and of the amplitude of the force, and what half the step told."""

    step: float
    position: float
    force: float | None
    change: float
    force_change: float | None
    warned: bool


def told(subject: Subject, step: float) -> Told | None:
    """Run a scene with a step, with half of it and with a small part of it; None where one of them stops."""
    setting = Setting(step=step)
    run, exact = subject.run(setting), subject.run(Setting(step=step / FINER))
    if not (run.done and exact.done and run.result is not None and exact.result is not None):
        return None
    watched = watch(exact.result)
    error = compare(watched.of(run.result), watched.of(exact.result), watched.extent)
    found = step_error(subject, run.result, setting)
    if found is None or error.position is None:
        return None
    taken = float(run.attribute("step") or step)
    return Told(taken, error.position, error.force, found.position, found.force, found.warning is not None)


def measure(quick: bool) -> Section:
    """Scenes with friction at their own step and at longer ones."""
    rows, ratios = [], []
    for name, end in SCENES[:1] if quick else SCENES:
        application = Crane() if name in ("hoist", "sixteen_falls") else Drillstring()
        scene = tautline.read(jwell.ROOT / "data" / f"{name}.yaml")
        subject = Subject(application, scene, end=0.5 if quick else end)
        own = subject.model(Setting()).solver.step
        for times in LONGER[:1] if quick else LONGER:
            one = told(subject, times * own)
            if one is None:
                rows.append((name, f"{end:g}", number(times * own), *("–",) * 5))
                continue
            ratios.append(one.change / one.position)
            changes = (one.position, one.change, one.force, one.force_change)
            percent = (number(None if x is None else 100.0 * x) for x in changes)
            rows.append((name, f"{end:g}", number(one.step), *percent, "yes" if one.warned else "–"))
    header = (
        "scene", "simulated, s", "step, s", "error of position, %", "change by half the step, %",
        "error of the force's amplitude, %", "change by half the step, %", "warned of",
    )  # fmt: skip
    spread = f"from {number(min(ratios))} to {number(max(ratios))}, {number(statistics.median(ratios))} in the median"
    text = (
        "Where dry friction acts, `simulate` runs a scene once more with half the step and tells by how much the "
        f"result has changed. Beside it the error, against a run with {FINER:g} steps in place of one (which is as far "
        "from the truth as friction lets it be). A method of first order is off by twice the change, one of second by "
        "four thirds of it. Where contacts let go in another order neither is more than a measure of how well the "
        f"result is known. Change over error of position: {spread}.\n\n" + table(header, rows)
    )
    return Section("What half the step tells of the error", text, [])


if __name__ == "__main__":
    show(measure, __doc__)
