"""The same scenes by Tautline and by Exudyn, in turn, in one run: CPU time, and the error of each.

Writes its tables into docs/performance.md. With --quick it is a reduced run that writes
nothing; -o FILE keeps all that was measured as JSON, case by case, and --tables FILE writes the tables from it (those
that are there were written from results.json); --references makes the references anew that take minutes. Exudyn
comes with `pip install 'tautline[race]'`; without it only Tautline runs, and nothing is written.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.page import RACE, between, load, machine, number, table
from benchmarks.race import peer, scenes
from benchmarks.race.scenes import Case

PAGE = scenes.ROOT / "docs" / "performance.md"
BEGIN, END = RACE
OURS = "Tautline"
MISSING = (
    "Exudyn is not installed, so only Tautline runs and nothing is compared: `pip install 'tautline[race]'` adds it."
)
TIGHTER = 0.1
"""Share of the tolerances with which the run that is judged is repeated, to see what the tolerance leaves."""
REFINED, REFINED_STEP = 1000, 2e-4
"""Elements and step, s, of the runs that are the reference of ropes."""
COMMON = 200
"""Elements of the mesh on which both programs are compared beside it."""
MODES = (20, 26)
"""Of the hose's reference, and of the one that it is compared with."""
TITLES = {
    "bar": "Bar",
    "catenary": "Hanging rope",
    "flowing": "Flowing rope",
    "hose": "Hose",
    "sheave": "Load on a rope over a sheave",
}
NOTES = {
    "bar": "A bar of EA 1000 N, 1 kg/m and 1 m, pulled by 1 N from t = 0 on; engineering strain. It moves along itself "
    "only: Tautline holds the rest, Exudyn leaves it free, each the quicker way. Judged by its end over 0.5 s, against "
    "the exact motion of the same mesh, by its modes.",
    "catenary": "A rope of 110 m over a span of 100 m (EA 1e7 N, EJ 10 N m², 5 kg/m, engineering strain), from the "
    "elastic catenary; one end moves outwards by 1 − cos πt m, 2 s. Judged by nine places along it, every 0.1 s.",
    "flowing": "The same rope, which runs through both ends at 5 m/s. With 1000 elements over 0.2 s: all of Exudyn's "
    "elements share one axial coordinate, which fills the factors of its matrix. Exudyn has this element in the plane "
    "only.",
    "hose": "`data/hose.yaml` with a constant speed and engineering strain, over 2 s. Judged by the tip over the first "
    "second, every 20 ms, against global polynomials without finite elements. Exudyn's curvature is θ' per "
    "unstretched length, Tautline's is the geometric one, and neither has the other: the polynomials take that of the "
    "program. Exudyn computes it in the plane only, and the hose flutters out of the plane first.",
    "sheave": "A load of 1 t on a rope (EA 1e7 N) over a sheave without friction, from a wall; let go 17 degrees from "
    "plumb with the rope stretched by its weight, so that it swings and bounces, over 50 s. Exudyn's "
    "`ReevingSystemSprings` is a rope without mass, with one force all along: this is the fair one of its two ways, as "
    "all else here is the same. Cable elements in contact with a circle have mass and friction, but press into the "
    "circle by a penalty: Exudyn's own example of a belt drive takes steps of 0.01 to 0.03 ms. Tautline's rope must "
    "have mass; it is 2e-8 of the load here. Rope that has mass, friction on the sheave and rope reeled in are left "
    "out: the connector cannot have "
    "the first two. Judged by the load over 10 s, every 0.1 s, against two equations solved to 1e-12, with Green's "
    "strain for Tautline, which has no other over sheaves, and engineering strain for Exudyn.",
}
"""What each scene is, how it is judged, and what of it the peer cannot do."""
HOW = (
    "Written by `python -m benchmarks.race.race`. Exudyn (Gerstmayr and others, University of Innsbruck; C++) is the "
    "open program nearest to this one: ANCF cable elements, the generalized-alpha method. Both get the same scene, "
    "start, mesh, method, rho_inf and step. They run in turn in one process, and neither writes anything.\n\n"
    "Times are CPU times, medians. The time of a step is that of the solving alone: Tautline's compiled time loop; "
    "Exudyn's `SolveDynamic` less what the same takes for one step, which stands beside it as setting up (the first "
    "factors of a sparse matrix take long). The whole call goes from the scene's numbers to the last state, with all "
    "but imports and compilation. Exudyn is set as its manual advises: the module without range checks, modified "
    "Newton, no Python function in the loop, one thread; of its integrations of an element the one with the least "
    "work, which does not lock; of its linear solvers the one that a short run finds quickest. Where it has an element "
    "in the plane and one in space, both ran. **Tautline computes in three dimensions throughout.**"
    "\n\nThe error is the largest distance from the reference, over all places and times that are looked at. "
    "`tolerance` is how far a tenth of the tolerance moves the same run. Each program has the loosest power of ten "
    "with which that is less than a tenth of its error, so that errors are compared and not tolerances."
)


@dataclass
class Row:
    """One program in one case: all times, s; counts of a run; error and what the tolerance leaves, m; how it failed."""

    case: Case
    program: str
    element: str
    solver: str
    solve: list[float] = field(default_factory=list)
    whole: list[float] = field(default_factory=list)
    set_up: float = 0.0
    iterations: int = 0
    jacobians: int = 0
    error: float | None = None
    tolerance_leaves: float | None = None
    failure: str | None = None

    @property
    def per_step(self) -> float | None:
        """CPU time of a step without setting up, us, median; None where the run failed."""
        return None if self.failure or not self.solve else self.over_steps(median(self.solve))

    def over_steps(self, solve: float) -> float:
        """Time of a step, us, of a run that took so long, s: what a run of one step takes is left out."""
        return 1e6 * (solve - self.set_up) / (self.case.steps - (self.set_up > 0.0))


def ours(case: Case, judged: bool = False, tighter: float = 1.0) -> peer.Outcome:
    """Run a case by Tautline, from its text on."""
    from tautline.integrators.status import StoppedEarly
    from tautline.simulation import simulate

    end, every = (case.judged, case.every) if judged else (case.end, case.end)
    began, failure = time.process_time(), None
    model = scenes.build(case, scenes.text(replace(case, tolerance=tighter * case.tolerance), end, every))
    try:
        result = simulate(model)
    except StoppedEarly as stop:
        result, failure = stop.result, f"{stop.status.name} at {stop.time:.3g} s"
    whole, facts = time.process_time() - began, result.attributes
    places = scenes.points(case, result) if judged and failure is None else None
    spent = (float(facts["cpu_time"]), whole, int(facts["newton_iterations"]), int(facts["factorisations"]))
    return peer.Outcome(*spent, places, failure)


def race(case: Case, with_peer: bool) -> list[Row]:
    """Both programs in turn, so that a busy minute strikes both; the first round warms up."""
    rivals = [peer.quickest(case, rival) for rival in peer.rivals(case)] if with_peer else []
    element = {"sheave": "span"}.get(case.scene, "ALE-ANCF")
    rows = [Row(case, OURS, element, "banded")]
    rows += [Row(case, "Exudyn", rival.element, rival.solver, set_up=peer.set_up(case, rival)) for rival in rivals]
    for turn in range(case.rounds + 1):
        if not turn:
            # Tautline compiles what it lacks. The peer was run already, to choose its solver.
            ours(case)
            continue
        outcomes = [ours(case), *(peer.run(case, rival) for rival in rivals)]
        for row, outcome in zip(rows, outcomes, strict=True):
            row.solve.append(outcome.solve)
            row.whole.append(outcome.whole)
            row.iterations, row.jacobians = outcome.iterations, outcome.jacobians
            row.failure = outcome.failure or row.failure
    for row, rival in zip(rows, [None, *rivals], strict=True):
        _judge(row, rival)
    return rows


def _judge(row: Row, rival: peer.Rival | None) -> None:
    """Measure the error of a program, and how much of it is due to its tolerance."""
    found = [
        (ours(row.case, True, share) if rival is None else peer.run(row.case, rival, True, share))
        for share in (1.0, TIGHTER)
    ]
    row.failure = row.failure or found[0].failure
    if found[0].points is not None:
        row.error = scenes.error(found[0].points, scenes.reference(row.case, rival is None))
        row.tolerance_leaves = scenes.error(found[0].points, found[1].points)


def short(value: float | None) -> str:
    """An error, m; a dash where there is none."""
    return "–" if value is None else f"{value:.1e}"


def spread(row: Row) -> str:
    """Smallest and largest time of a step, us."""
    return f"{number(row.over_steps(min(row.solve)), 3)} to {number(row.over_steps(max(row.solve)), 3)}"


def lines(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    """Rows of the table of one scene."""
    made, first = [], next((row for row in rows if row.program == OURS), None)
    for row in rows:
        if row.program == OURS:
            first = row
        flow = f"{row.case.speed:g} m/s" if row.case.scene == "hose" else f"{row.case.elements}"
        begin = (flow, f"{1000.0 * row.case.step:g}", row.program, f"{row.element}, {row.solver}")
        if row.failure:
            made.append((*begin, row.failure, *["–"] * 8))
            continue
        steps, base = row.case.steps, first.per_step if first is not None else None
        ratio = "1" if row.program == OURS else "–" if not base else number(row.per_step / base)
        made.append(
            (*begin, number(row.per_step, 3), spread(row), ratio, number(1000.0 * row.set_up) if row.set_up else "–",
             number(median(row.whole)), number(row.iterations / steps), f"{row.jacobians}", short(row.error),
             short(row.tolerance_leaves))
        )  # fmt: skip
    return made


def full(rows: Sequence[Row], stored: dict[str, Any], quick: bool = False) -> str:
    """All that was measured, in Markdown: one table for each scene."""
    parts = [f"## Race with Exudyn {peer.version() or '(not installed)'}\n\n{HOW}"]
    for scene, title in TITLES.items():
        own = [row for row in rows if row.case.scene == scene]
        if not own:
            continue
        header = (
            {"hose": "flow", "sheave": "spans"}.get(scene, "elements"), "step, ms", "program", "element, linear solver",
            "µs per step, median", "spread", "over Tautline", "setting up, ms", "whole call, s",
            "iterations per step", "factorisations", "error, m", "tolerance, m",
        )  # fmt: skip
        parts.append(f"### {title}\n\n{NOTES[scene]}{_proof(scene, stored)}\n\n{table(header, lines(own))}".rstrip())
    return "\n\n".join(parts) + "\n"


def _proof(scene: str, stored: dict[str, Any]) -> str:
    """How good the stored references of a scene are."""
    if scene in ("catenary", "flowing") and scene in stored:
        one = stored[scene]
        who = "the mean of both programs" if scene == "catenary" else "Tautline, as Exudyn would take hours,"
        return (
            f" The reference is {who} with {REFINED} elements and {1000.0 * REFINED_STEP:g} ms. Half the elements and "
            f"twice the step were {one['coarser']:.1e} m from there. On one mesh of {COMMON} elements, with "
            f"{2000.0 * REFINED_STEP:g} ms, both programs differ by {one['apart']:.1e} m."
        )
    if scene == "hose":
        apart: dict[str, float] = {}
        for key, one in stored.items():
            if key.startswith("hose"):
                flow = key.removeprefix("hose ").split(",")[0]
                apart[flow] = max(apart.get(flow, 0.0), one["apart"])
        each = ", ".join(f"{way:.1e} m at {flow}" for flow, way in apart.items())
        return f" {MODES[0]} and {MODES[1]} modes differ by up to {each}." if apart else ""
    return ""


def brief(rows: Sequence[Row]) -> str:
    """The short table: one line for each case, with the quicker of Exudyn's elements."""
    made = []
    for case in dict.fromkeys(row.case for row in rows):
        own = [row for row in rows if row.case == case]
        mine = next(row for row in own if row.program == OURS)
        others = [row for row in own if row.program != OURS]
        best = min(others, key=lambda row: row.per_step or float("inf"), default=None)
        if best is None:
            continue
        ratio = number(best.per_step / mine.per_step) if best.per_step and mine.per_step else "–"
        made.append((case.name, _cell(mine), _cell(best), ratio, short(mine.error), short(best.error)))
    header = ("scene", "Tautline, µs per step", "Exudyn, µs per step", "Exudyn over Tautline", "error, m",
              "Exudyn's error, m")  # fmt: skip
    return table(header, made)


def _cell(row: Row) -> str:
    return row.failure or number(row.per_step, 3)


# ----------------------------------------------------------------------------------------------------------------------
# references
# ----------------------------------------------------------------------------------------------------------------------
def rope_reference(scene: str) -> dict[str, Any]:
    """A fine mesh with a short step by both programs, or by Tautline alone where Exudyn would take hours.

    Kept with it: how far both programs are apart on one coarser mesh, and how far a run with half the elements and
    twice the step is from the reference.
    """
    case = Case(scene, REFINED, REFINED_STEP, 2.0, 2.0, 0.1, 1e-7, 1e-5, 1e-4,
                speed=scenes.FLOW if scene == "flowing" else 0.0)  # fmt: skip
    half = replace(case, elements=case.elements // 2, step=2.0 * case.step)
    common = replace(half, elements=COMMON, relative=1e-6)
    rival = peer.rivals(case)[0]
    fine = [ours(case, True).points]
    if scene != "flowing":
        fine.append(peer.run(case, rival, True).points)
    mean = np.mean(fine, axis=0)
    return {
        "made": f"{'mean of Tautline and' if len(fine) > 1 else 'Tautline, beside'} Exudyn {peer.version()}",
        "apart": scenes.error(ours(common, True).points, peer.run(common, rival, True).points),
        "coarser": scenes.error(ours(half, True).points, mean),
        "times": case.times.round(9).tolist(),
        "points": mean.round(9).tolist(),
    }


def hose_reference(speed: float, material: bool) -> dict[str, Any]:
    """Global polynomials, and how far those with fewer modes are from them."""
    times = 0.02 * np.arange(1, 51)
    fewer, more = (scenes.hose_exact(speed, material, times, modes) for modes in MODES)
    return {
        "made": f"global polynomials, {MODES[1]} modes",
        "apart": float(np.abs(fewer - more).max()),
        "times": times.round(9).tolist(),
        "points": more.round(9).tolist(),
    }


def write_references() -> None:
    """Make all stored references anew; takes some ten minutes."""
    made: dict[str, Any] = {scene: rope_reference(scene) for scene in ("catenary", "flowing")}
    for case in scenes.cases(False):
        if case.scene == "hose":
            for own in (True, False):
                made[scenes.reference_name(case, own)] = hose_reference(case.speed, not own)
    scenes.STORED.write_text(json.dumps(made) + "\n", encoding="utf8")


# ----------------------------------------------------------------------------------------------------------------------
def as_json(rows: Sequence[Row], measured: str) -> str:
    """Everything, for a comparison with another version."""
    records = [{**asdict(row), "name": row.case.name, "per_step": row.per_step} for row in rows]
    return json.dumps({"measured": measured, "exudyn": peer.version(), "rows": records}, indent=1) + "\n"


def from_json(text: str) -> tuple[list[Row], str]:
    """Rows, and the machine that they were measured on."""
    kept = json.loads(text)
    names = {one.name for one in fields(Row)}
    rows = [Row(**{key: row[key] for key in names} | {"case": Case(**row["case"])}) for row in kept["rows"]]
    return rows, kept["measured"]


SHORT = (
    "One line for each case, with the quicker of Exudyn's elements. "
    "Tautline computes in space, Exudyn's quicker cable element in the plane."
)


def write(rows: Sequence[Row], measured: str) -> None:
    """Put both tables into the page, the short one first."""
    text = f"{full(rows, _stored())}\nMeasured: {measured}."
    title, rest = text.split("\n\n", 1)
    old = PAGE.read_text(encoding="utf8")
    part = f"{BEGIN}\n{title}\n\n{SHORT}\n\n{brief(rows)}\n{rest}\n{END}"
    PAGE.write_text(between(old, part, BEGIN, END), encoding="utf8")


def _stored() -> dict[str, Any]:
    return json.loads(scenes.STORED.read_text(encoding="utf8")) if scenes.STORED.exists() else {}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a reduced run that only shows that it runs")
    parser.add_argument("--scene", choices=[*TITLES], action="append", help="only these scenes; nothing is written")
    parser.add_argument("--references", action="store_true", help="make the stored references anew, and race nothing")
    parser.add_argument("--tables", type=Path, metavar="FILE", help="write the tables from what -o kept; race nothing")
    parser.add_argument("-o", dest="output", type=Path, help="keep all that was measured, as JSON")
    asked = parser.parse_args()
    if asked.tables is not None:
        write(*from_json(asked.tables.read_text(encoding="utf8")))
        return
    with_peer = peer.version() is not None
    if asked.references:
        if not with_peer:
            parser.error("the references of ropes are made by both programs: `pip install 'tautline[race]'`")
        write_references()
        return
    if not with_peer:
        print(MISSING)
    before, rows, measured = load(), [], ""
    for case in scenes.cases(asked.quick):
        if asked.scene and case.scene not in asked.scene:
            continue
        rows += race(case, with_peer)
        told = "; ".join(f"{row.element} {_cell(row)}" for row in rows if row.case == case)
        print(f"{case.name}: {told}", flush=True)
        measured = machine(before) + (f"; Exudyn {peer.version()}" if with_peer else "")
        if asked.output is not None:
            asked.output.write_text(as_json(rows, measured), encoding="utf8")
    print(f"\n{full(rows, _stored())}\n{brief(rows)}\nMeasured: {measured}.")
    if with_peer and not asked.quick and not asked.scene:
        write(rows, measured)


if __name__ == "__main__":
    main()
