"""What one step costs: RK4 beside generalized-alpha, with kept factors and with a new tangent in every iteration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import tautline
from benchmarks.hose import runs as hoses
from benchmarks.page import number, table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import DOCS
from benchmarks.thesis.precision import scenes
from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.study.accuracy.grid import EXPLICIT, critical_at_start
from tautline.study.trials.trial import Setting, Subject, Trial

DATA = DOCS.parent / "data"
COUNTS = (1, 2, 4, 8)
FIRST_PERIOD = 4.0
"""Of the hammer bar, s."""
METHODS = {
    "RK4": Setting("rk4"),
    "generalized-α": Setting("generalized-alpha"),
    "full Newton": Setting("generalized-alpha", newton="full"),
}
RK4, KEPT, FULL = METHODS
WHY = {
    "hose at 35 m/s": "steps of microseconds need one iteration",
    "hoist": "not met: RK4 makes a mass matrix and its factors four times a step, and one iteration does",
}
SAID = "“about 3”"
"""How many times cheaper a step of RK4 is in the thesis (section 4.1), of the hammer bar."""


class Compared(NamedTuple):
    """One scene: its name, runs by their names in `METHODS`, all of one step, and implicit ones of their own step."""

    name: str
    runs: dict[str, Trial]
    longer: dict[str, Trial]

    def ratio(self, method: str) -> float | None:
        """CPU time of a step over that of RK4, both of one length."""
        return scenes.over(scenes.per_step(self.runs[method]), scenes.per_step(self.runs[RK4]))

    def own_ratio(self, method: str) -> float | None:
        """CPU time of a step of its own length over that of a step of RK4."""
        return scenes.over(scenes.per_step(self.longer[method]), scenes.per_step(self.runs[RK4]))

    def times(self, method: str) -> float | None:
        """CPU time over that of RK4 for the same simulated time."""
        return scenes.over(scenes.cpu(self.longer[method]), scenes.cpu(self.runs[RK4]))


def compared(name: str, subject: Subject, step: float | None, own: float, repetitions: int) -> Compared:
    """Run a scene in three ways at a step, or at the longest of RK4's usual ones with which it comes to its end.

    The implicit two are then run with the step ``own``, s, that the scene takes with them.
    """
    critical = critical_at_start(subject, METHODS[RK4]) if step is None else None
    for h in [step] if step is not None else [share * (critical or 0.0) for share in EXPLICIT]:
        runs = {RK4: subject.run(_at(RK4, h), repetitions)}
        if runs[RK4].done:
            break
    runs |= {other: subject.run(_at(other, h), repetitions) for other in (KEPT, FULL)}
    return Compared(name, runs, {other: subject.run(_at(other, own), repetitions) for other in (KEPT, FULL)})


def _at(method: str, step: float | None) -> Setting:
    chosen = METHODS[method]
    return Setting(chosen.method, step, newton=chosen.newton)


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    repetitions = 1 if quick else 7
    found = [_bar(n, 20.0 if quick else 400.0, repetitions) for n in (COUNTS[:2] if quick else COUNTS)]
    found += _others(quick, repetitions)
    return (
        "\n### What one step costs\n\nMicroseconds of CPU per step, all three at the same step: the longest of RK4's "
        f"({', '.join(f'{share:g}' for share in EXPLICIT)} of its critical step at the start) with which it comes to "
        "the end, and the scene's own for the J-well. Full Newton is `newton: full`, a new tangent in every iteration, "
        f"which the thesis has (eq. 2.87); otherwise factors are kept. Medians of {repetitions}.\n\n"
        + table(
            ("scene", "step, s", RK4, KEPT, "over RK4", "its iterations", FULL, "over RK4", "its iterations"),
            [_row(one) for one in found],
        )
        + "\n"
        + table(("claim", "ours", "thesis", "why"), _claims(found))
        + "\nEach at the step that it is used with: RK4 as above, generalized-α at that of the scene, which for the "
        "bar is a tenth of its first period. The last column is for the same simulated time, and tells which is the "
        "cheaper to run; how far off either is stands under [error against run time](#error-against-run-time-of-four-"
        "scenes).\n\n"
        + table(
            (
                "scene",
                "step of generalized-α, s",
                "over RK4's",
                f"{KEPT}, a step over one of RK4",
                "its iterations",
                f"{FULL}, a step over one of RK4",
                "its iterations",
                "CPU for the same time, over RK4",
            ),
            [_own_row(one) for one in found],
        )
        + "\nRK4 evaluates forces four times a step, and a mass matrix that changes as often. An iteration with kept "
        "factors is one evaluation and one solution, so that generalized-α is the cheaper where one or two suffice: "
        "the more so the dearer the forces are beside the rest. With a new tangent in each it is RK4 that is cheaper, "
        "but for the hoist, whose mass matrix changes with the rope that is reeled.\n"
    )


def _bar(count: int, end: float, repetitions: int) -> Compared:
    subject = scenes.subject_of([*bars.bar(count, 1.0), scenes.hammer(count)], end, 0.1 * end, time_step=0.01)
    return compared(f"hammer bar, n = {count}", subject, None, 0.1 * FIRST_PERIOD, repetitions)


def _others(quick: bool, repetitions: int) -> list[Compared]:
    """The hose without and with damping, the J-well and the hoist."""
    free, damped = hoses.changed({"hose.damping": 0.0}), hoses.changed({})
    found = [
        (name, Subject(Gardenhose(), scene, end=end, change=scenes.unguarded), None, 1e-3)
        for name, scene, end in (
            ("hose at 35 m/s, undamped", free, 0.02 if quick else 0.5),
            ("hose at 35 m/s", damped, 0.01 if quick else 0.02),
        )
    ]
    if not quick:
        well, hoist = (tautline.read(DATA / name) for name in ("jwell.yaml", "hoist.yaml"))
        found.append(("J-well", Subject(Drillstring(), well, end=10.0, change=scenes.unguarded), 1e-3, 1e-3))
        found.append(("hoist", Subject(Crane(), hoist, end=2.0, change=scenes.unguarded), None, 5e-3))
    return [compared(name, subject, step, own, repetitions) for name, subject, step, own in found]


def _row(one: Compared) -> tuple[str, ...]:
    step = one.runs[RK4].setting.step
    cells = [number(scenes.per_step(one.runs[RK4]))]
    for method in (KEPT, FULL):
        trial = one.runs[method]
        cells += [number(scenes.per_step(trial)), number(one.ratio(method)), number(_iterations(trial))]
    return one.name, number(step), *cells


def _own_row(one: Compared) -> tuple[str, ...]:
    step = one.longer[KEPT].setting.step or 0.0
    cells = [number(step), number(step / (one.runs[RK4].setting.step or step))]
    for method in (KEPT, FULL):
        cells += [number(one.own_ratio(method)), number(_iterations(one.longer[method]))]
    return one.name, *cells, number(one.times(KEPT))


def _iterations(trial: Trial) -> float | None:
    """Newton iterations of a step."""
    return trial.attribute("newton_iterations") / trial.attribute("steps") if trial.done else None


def _claims(found: Sequence[Compared]) -> list[tuple[str, ...]]:
    bars_alone = [one for one in found if one.name.startswith("hammer")]
    kept, full = (_spread([one.ratio(method) for one in bars_alone]) for method in (KEPT, FULL))
    others = [
        (f"{one.name}, full Newton", f"{number(one.ratio(FULL))}; {number(one.own_ratio(FULL))} each at its own step",
         "–", WHY.get(one.name, ""))
        for one in found if one not in bars_alone
    ]  # fmt: skip
    return [
        ("a step of generalized-α over one of RK4, hammer bar, full Newton", full, SAID,
         "forces and tangents are compiled alike here"),
        ("the same with kept factors", kept, "–", "factors are made a few times a run, not in every iteration"),
        *others,
    ]  # fmt: skip


def _spread(ratios: Sequence[float | None]) -> str:
    there = [ratio for ratio in ratios if ratio is not None]
    return f"{min(there):.1f} to {max(there):.1f}" if there else "–"
