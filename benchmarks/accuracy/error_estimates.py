"""What `simulate` states of its error beside the error itself: sixty scenes, fifty cranes, and every shipped scene.

Without --quick the section is also written into docs/performance.md.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any, NamedTuple

from benchmarks import jwell
from benchmarks.accuracy import crane_cases
from benchmarks.accuracy.error_cases import CHOSEN_BY, PROVED_WITH, QUICK, Case
from benchmarks.page import Section, load, machine, number, quick_asked, table
from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cable.application import Cable
from tautline.scene.reading.document import split_key
from tautline.study.trials.errors import compare
from tautline.study.trials.history import watch
from tautline.study.trials.step_error import SHORTER, estimate, runs_for
from tautline.study.trials.trial import Setting, Subject, Trial

PAGE, DATA = jwell.ROOT / "docs" / "performance.md", jwell.ROOT / "data"
TITLE = "What a run says of its error"
CRANES = ("hoist", "hookblock", "sixteen_falls", "slewing", "landing")
CABLES = ("reeled_span", "cantilever_bar")
FINER = (10.0, 20.0)
"""Step over those of the two runs which are taken for exact; the larger of both errors counts."""
PROVED = 0.25
"""Share of an error by which the two may differ for it to be proved."""
SHIPPED_END = {"cantilever_bar": 20.0}
"""Simulated time, s, of shipped scenes that are not looked at to their end: this one repeats itself."""
Pair = tuple[float, float | None]


class Told(NamedTuple):
    """One run: its error and what was stated of position and of the amplitude of force, and what the other runs cost.

    ``stated`` is None where nothing is said unasked; ``cost`` is in steps, ``work`` in Newton iterations, both over
    those of the run. ``doubt`` is the difference of the errors against the two references, over the larger.
    """

    step: float
    friction: bool
    error: Pair
    doubt: Pair
    stated: Pair | None
    why: str
    cost: float
    work: float

    def ratios(self, which: int) -> list[float]:
        """What was stated over the error; empty where there is none of both, or the error is not proved."""
        stated = None if self.stated is None else self.stated[which]
        error, doubt = self.error[which], self.doubt[which]
        if stated is None or error is None or not error > 0.0 or (doubt or 0.0) > PROVED:
            return []
        return [stated / error]


class Counting(Subject):
    """A subject that keeps count of the steps and the iterations of all its runs."""

    steps, iterations = 0, 0

    def run(self, *given: Any, **further: Any) -> Trial:
        """As the subject runs a setting."""
        trial = super().run(*given, **further)
        self.steps += int(trial.attribute("steps") or 0)
        self.iterations += int(trial.attribute("newton_iterations") or 0)
        return trial


def subject_of(case: Case) -> Counting:
    """The scene of a case, under study."""
    kinds = {**dict.fromkeys(CRANES, Crane), **dict.fromkeys(CABLES, Cable), "hose": Gardenhose}
    application = kinds.get(case.scene, Drillstring)()
    scene = application.read(DATA / f"{case.scene}.yaml")
    if case.keys:
        scene = scene.with_values({split_key(key): (value, key) for key, value in case.keys.items()})
    return Counting(application, scene, end=case.end)


def told(case: Case, unasked: bool = False) -> Told | None:
    """Run a case, let its error be estimated, and find that error; None where a run stops or nothing moves.

    Parameters
    ----------
    unasked : bool
        Whether only what `simulate` says by itself counts; else the estimate is asked for where steps are controlled.
    """
    subject, setting = subject_of(case), Setting(step=case.step)
    model = subject.model(setting)
    run = subject.run(setting)
    if not run.done or run.result is None or not watch(run.result).moves:
        return None
    own, work = subject.steps, subject.iterations
    parts = runs_for(model) if unasked or model.solver.step_error == 0.0 else SHORTER
    found = estimate(subject, run.result, setting, parts=parts) if parts else "says nothing unasked"
    spent = (subject.steps / own, subject.iterations / max(work, 1))
    step = float(run.attribute("step"))
    errors = _errors(subject, run, step, model.solver.step_error)
    if errors is None:
        return None
    worst = tuple(None if None in pair else max(pair) for pair in zip(*errors, strict=True))
    doubt = tuple(
        None if None in pair else abs(pair[0] - pair[1]) / max(*pair, 1e-300) for pair in zip(*errors, strict=True)
    )
    stated = None if isinstance(found, str) else (found.position, found.force)
    return Told(step, model.system.has_friction, worst, doubt, stated, found if isinstance(found, str) else "", *spent)


def _errors(subject: Subject, run: Trial, step: float, bound: float) -> list[Pair] | None:
    """Errors of position and force against both references, whose steps are controlled as the run's are."""
    found = []
    for finer in FINER:
        exact = subject.run(Setting(step=step / finer, step_error=bound / finer**3 or None))
        if not exact.done or exact.result is None:
            return None
        watched = watch(run.result)
        error = compare(watched.of(run.result), watched.of(exact.result), watched.extent)
        found.append((error.position, error.force))
    return found


def measure(quick: bool) -> Section:
    """All cases, all cranes with controlled steps, and all shipped scenes."""
    fixed = _measured({"chosen by": QUICK if quick else CHOSEN_BY, "proved with": () if quick else PROVED_WITH}, told)
    shipped = [] if quick else list(_shipped())
    parts = [_text(), *fixed, CRANES_TEXT, *_cranes(quick), SHIPPED, table(EACH[1:], shipped)]
    return Section(TITLE, "\n\n".join(part.strip() for part in parts) + "\n", [])


def _cranes(quick: bool) -> tuple[str, str]:
    """Tables of cranes whose steps are controlled."""
    chosen, proved = crane_cases.CHOSEN_BY, crane_cases.PROVED_WITH
    halves = {"chosen by": chosen[:1] if quick else chosen, "proved with": () if quick else proved}
    return _measured(halves, partial(told, unasked=True))


def _measured(halves: dict[str, Sequence[Case]], one_of: Callable[[Case], Told | None]) -> tuple[str, str]:
    """Tables of some cases: how often what was stated is enough, and each case."""
    rows: list[Sequence[str]] = []
    summaries: list[Sequence[str]] = []
    for half, cases in halves.items():
        done = list(zip(cases, _all(one_of, cases), strict=True))
        known = [one for _, one in done if one is not None]
        rows += [_row(half, str(case), case.end, one) for case, one in done]
        summaries += [_summary(half, known, which) for which in (0, 1)] if known else []
    return table(OVERALL, summaries), table(EACH, rows)


EACH = (
    "half", "scene", "simulated, s", "step, s", "error of position, %", "stated, %",
    "error of the force's amplitude, %", "stated, %", "steps of all runs over those of the run",
    "Newton iterations of all runs, likewise",
)  # fmt: skip
OVERALL = (
    "half", "of", "scenes", "stated is at least the error", "smallest stated over error", "median", "largest",
)  # fmt: skip
CRANES_TEXT = (
    "Cranes control the error of each step. They take one run with up to one and a half times the step, or with half "
    "of it where a frame holds no more than two steps. Of the force they state the highest and the lowest value "
    "together, which is no less than the error of the amplitude. The references have errors of each step that are "
    "smaller by 10³ and 20³. `slewing: step 25 ms` made two steps a frame an exception: twice the step stated 0.3 of "
    "the error."
)
SHIPPED = (
    "Every shipped scene as it stands. Scenes in which nothing moves are left out. "
    "An error in brackets is not proved: the two references differ by more than a quarter of it."
)


def _text() -> str:
    return (
        "`simulate` estimates the error that is due to its steps: with dry friction from runs with a half and a third "
        "of the step, as of a method of first order; else from twice and four times the step by the grid convergence "
        "index ([study.md](study.md#the-estimated-error)). Here it stands beside the error itself, against runs "
        f"with {FINER[0]:g} and {FINER[1]:g} steps in place of one, of which the larger counts. One half of the scenes "
        "was used to choose the estimate; the other, with other parameters, was not. Only errors that are proved count "
        "in the first table."
    )


def _summary(half: str, known: Iterable[Told], which: int) -> Sequence[str]:
    ratios = sorted(r for one in known for r in one.ratios(which))
    if not ratios:
        return (half, ("position", "force")[which], "0", *("–",) * 4)
    covered = sum(r >= 1.0 for r in ratios)
    figures = (number(x) for x in (ratios[0], statistics.median(ratios), ratios[-1]))
    return (half, ("position", "force")[which], str(len(ratios)), f"{covered} of {len(ratios)}", *figures)


def _row(half: str, name: str, end: float | None, one: Told | None) -> Sequence[str]:
    if one is None:
        return (half, name, number(end), *("–",) * 7)
    cells = []
    for which in (0, 1):
        error, doubt = one.error[which], one.doubt[which]
        text = number(None if error is None else 100.0 * error)
        cells.append(f"({text})" if (doubt or 0.0) > PROVED else text)
        stated = None if one.stated is None else one.stated[which]
        cells.append(number(None if stated is None else 100.0 * stated))
    return (half, name, number(end), number(one.step), *cells, number(one.cost), number(one.work))


def _all(one: Callable[[Case], Told | None], cases: Sequence[Case]) -> list[Told | None]:
    """All cases, in two processes if they are many."""
    if len(cases) <= len(QUICK):
        return [one(case) for case in cases]
    with ProcessPoolExecutor(2) as pool:
        return list(pool.map(one, cases))


def _shipped() -> Iterable[Sequence[str]]:
    cases = [Case(path.stem, {}, None, SHIPPED_END.get(path.stem)) for path in sorted(DATA.glob("*.yaml"))]
    for case, one in zip(cases, _all(partial(told, unasked=True), cases), strict=True):
        if one is not None:
            yield _row("", case.scene, case.end or subject_of(case).model(Setting()).solver.end, one)[1:]


def written(page: str, section: Section) -> str:
    """The page with this section in place of the one of its title."""
    before, _, rest = page.partition(f"## {section.title}\n")
    _, mark, after = rest.partition("\n## ")
    return f"{before}{section}{mark}{after}"


if __name__ == "__main__":
    quick, before = quick_asked(__doc__), load()
    section = measure(quick)
    print(f"{section}\n{machine(before)}.")
    if not quick:
        PAGE.write_text(written(PAGE.read_text(encoding="utf8"), section), encoding="utf8")
