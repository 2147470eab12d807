"""What `simulate --accuracy` reaches and costs: thirty scenes, judged by far smaller steps and by another method.

Without --quick the section is also written into docs/performance.md. ``--asked 0.05`` asks for another error.
"""

from __future__ import annotations

import statistics
import sys
from typing import Any, NamedTuple

import tautline
from benchmarks import jwell
from benchmarks.accuracy.cases import CASES, Case
from benchmarks.accuracy.error_estimates import written
from benchmarks.page import Section, load, machine, number, quick_asked, table
from tautline.application.installed import Installed
from tautline.scene.limits import without_limits
from tautline.scene.methods import implicit_like
from tautline.simulation import simulate
from tautline.study.accuracy.choice import Seen, differences, finer, look_at, run_to_accuracy
from tautline.study.trials.history import Watched, watch

PAGE, DATA = jwell.ROOT / "docs" / "performance.md", jwell.ROOT / "data"
TITLE = "Accuracy that is asked for"
ASKED = 0.01
FINER = 8.0
"""Steps of the reference over those of the run that is judged."""
AGAIN_FINER = 4.0
"""How many times as many steps both references take where they differ too much to judge it."""
OTHER = (1.0, 0.7)
"""Steps of both references over that; the second has another rho_inf too."""
PROVED = 0.25
"""Share of the error asked for by which both references may differ for it to be judged."""
MOST_STEPS = 4.0e6
"""Steps that a reference may take."""
AGAIN = 3
"""Runs of the best fixed setting and of the one chosen, of which the fastest counts: most are short."""


class Judged(NamedTuple):
    """A case: what was stated and reached, and its cost over that of the cheapest fixed setting that reaches it."""

    case: Case
    met: bool | None
    stated: float
    error: float
    doubt: float
    step: float
    method: str
    runs: int
    cost: float | None
    best: str


def judged(case: Case, asked: float) -> Judged:
    """Run a case to an accuracy, and find its error and the cheapest fixed setting."""
    scene = tautline.read(DATA / f"{case.scene}.yaml")
    application = Installed().of(scene)
    scene = application.with_overrides(scene.replace(case.keys) if case.keys else scene, end=case.end)
    interval = float(application.build(scene).solver.interval)
    # The kernels are loaded before anything is timed.
    tried = _run(application, scene, implicit_like(scene.solver.method), interval / finer(8.0), interval)
    watched = watch(tried)
    chosen = run_to_accuracy(application, scene, asked)
    told: dict[str, Any] = chosen.accuracy or {}
    exact = _references(application, scene, interval, float(told["step"]), watched, PROVED * asked)
    error = _error(look_at(chosen, watched), exact, watched)
    doubt = max(differences(exact[1], exact[0], watched.extent).values())
    best, cheapest = _best(application, scene, interval, asked, exact, watched)
    spent = min(_spent(told), *(_spent(run_to_accuracy(application, scene, asked).accuracy) for _ in range(AGAIN - 1)))
    return Judged(
        case, told["met"], float(told["reached"] or 0.0), error, doubt, float(told["step"]), str(told["method"]),
        len(told["runs"]), None if cheapest is None else spent / cheapest, best,
    )  # fmt: skip


def _spent(told: dict[str, Any]) -> float:
    """Processor time of all runs, s: that which looks between the frames of the last is among them."""
    return float(told["cost"] * told["runs"][-1]["cpu_time"])


def _run(application: Any, scene: Any, method: str, step: float, interval: float, rho_inf: float | None = None) -> Any:
    arranged = application.with_overrides(
        scene, method=method, step=step, rho_inf=rho_inf, control="fixed", interval=interval
    )
    return simulate(application.build(without_limits(arranged)))


def _references(
    application: Any, scene: Any, interval: float, step: float, watched: Watched, allowed: float
) -> list[Seen]:
    """Runs with far smaller steps, the second with other numerical dissipation: as small as makes both agree."""
    method, end = implicit_like(scene.solver.method), float(scene.solver.end)
    usual = scene.solver.rho_inf
    rhos = (None, 0.6 if usual is None or usual > 0.7 else 0.9)
    shortest, least = step / FINER, end / MOST_STEPS
    while True:
        shortest = max(shortest, least)
        made = [
            _run(application, scene, method, shortest / part, interval, rho)
            for part, rho in zip(OTHER, rhos, strict=True)
        ]
        exact = [look_at(run, watched) for run in made]
        doubt = max(differences(exact[1], exact[0], watched.extent).values())
        if doubt <= allowed or shortest <= least:
            return exact
        shortest /= AGAIN_FINER


def _error(run: Seen, exact: list[Seen], watched: Watched) -> float:
    """The largest error of position, force and twist against both references."""
    return max(max(differences(run, one, watched.extent).values()) for one in exact)


def _best(
    application: Any, scene: Any, interval: float, asked: float, exact: list[Seen], watched: Watched
) -> tuple[str, float | None]:
    """The cheapest fixed setting that reaches what is asked, and its processor time, s."""
    method, divisor, taken = implicit_like(scene.solver.method), 1.0, None
    while taken is None and divisor <= 1024.0:
        try:
            run = _run(application, scene, method, interval / divisor, interval)
        except tautline.StoppedEarly:
            run = None
        if run is not None and _error(look_at(run, watched), exact, watched) <= asked:
            taken = [float(run.attributes["cpu_time"])]
            taken += [
                float(_run(application, scene, method, interval / divisor, interval).attributes["cpu_time"])
                for _ in range(AGAIN - 1)
            ]
            break
        divisor = finer(1.01 * divisor)
    return f"{1e3 * interval / divisor:.3g} ms" if taken else "none", min(taken) if taken else None


HEADER = (
    "scene", "stated", "%", "error, %", "method", "step, ms", "runs", "cheapest fixed step", "cost over its",
)  # fmt: skip


def measure(quick: bool, asked: float = ASKED) -> Section:
    """All cases."""
    found = []
    for case in CASES[19:20] if quick else CASES:
        found.append(judged(case, asked))
        print(case.name, found[-1].error, file=sys.stderr, flush=True)
    return told(found, asked)


def told(found: list[Judged], asked: float) -> Section:
    """The section of all cases."""
    rows = []
    for one in found:
        case = one.case
        error = number(100.0 * one.error)
        rows.append(
            (
                case.name, {True: "reached", False: "not reached", None: "not judged"}[one.met],
                number(100.0 * one.stated), f"({error})" if one.doubt > PROVED * asked else error, one.method,
                number(1e3 * one.step), str(one.runs), one.best, number(one.cost),
            )
        )  # fmt: skip
    reached = sum(bool(one.met) and one.error <= asked for one in found)
    false = sum(bool(one.met) and one.error > asked for one in found)
    below = sum(one.stated < one.error for one in found)
    costs = sorted(one.cost for one in found if one.cost is not None)
    within = sum(cost <= 3.0 for cost in costs)
    unreached = sum(one.met is False for one in found)
    text = (
        f"`simulate --accuracy '{100.0 * asked:g} %'` on {len(found)} scenes "
        f"([what it does](study.md#an-accuracy-that-is-asked-for)). Reached: {reached}. Stated as reached and not: "
        f"{false}. Stated as not reached: {unreached}. Errors stated that are below the true one: {below}. "
        "All its runs together cost, in processor time of the loops, "
        f"{statistics.median(costs):.2g} times the cheapest fixed step that reaches the error (median; largest "
        f"{costs[-1]:.2g}; at most 3 in {within} of {len(costs)}). That step is known only to who has the reference. "
        f"The error is the largest of position, amplitude of the force and twist, against two with {FINER:g} times "
        "as many steps or more, one of them with another rho_inf: as many as make them agree to a quarter of what was "
        f"asked, up to {MOST_STEPS:.0e}; in brackets where they do not.\n\n" + table(HEADER, rows)
    )
    return Section(TITLE, text, [])


if __name__ == "__main__":
    asked = ASKED
    if "--asked" in sys.argv:
        place = sys.argv.index("--asked")
        asked = float(sys.argv[place + 1])
        del sys.argv[place : place + 2]
    quick, before = quick_asked(__doc__), load()
    section = measure(quick, asked)
    print(f"{section}\n{machine(before)}.")
    if not quick and asked == ASKED:
        PAGE.write_text(written(PAGE.read_text(encoding="utf8"), section), encoding="utf8")
