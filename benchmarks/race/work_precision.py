"""Error against CPU time on eight scenes: our integrators, SciPy's on the same equations, and Exudyn where it has them.

SciPy's methods drive `Simulation.equations`; Exudyn (`pip install 'tautline[race]'`) runs its own model of the same
mesh, and is judged against its own finest run. Without it its curves are left out, and nothing is written.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import tautline
from benchmarks.page import Section, number, show, table
from benchmarks.race import peer
from benchmarks.race import work_precision_scenes as scenes
from benchmarks.race.work_precision_scenes import BY_ERROR, ROOT, Scene
from tautline.application.installed import Installed

REPEATED, ENOUGH = 5, 0.5
"""Runs of ours of which the fastest counts, and the time, s, after which there are no more."""
LONGEST = 20.0
"""Time, s, of a run of others after which no tighter tolerance is tried."""
WANTED = (0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6)
"""Errors of the table, as shares of the motion."""
COLOURS = {
    "rk4": "C0", "generalized-alpha": "C1", "DOP853": "C2", "Radau": "C3", "BDF": "C4", "Exudyn": "C5",
    BY_ERROR: "C6",
}  # fmt: skip
PICTURE = ROOT / "docs" / "images" / "work_precision.png"

Curve = list[tuple[float, float]]
"""CPU time s and error of each run."""


class Judge:
    """What the runs of a scene are compared by: places of the watched unknowns at some times."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.sim = tautline.Simulation(scene.scene, keep=False)
        equations = self.sim.equations
        self.chosen = [i for i, name in enumerate(equations.names) if scene.watched(name)]
        self.less = equations.names.index(scene.less) if scene.less else None
        self.start = self.of(equations.state()[1])
        self.exact = np.zeros(0)
        self.extent = 1.0

    def of(self, q: np.ndarray) -> np.ndarray:
        """What is watched of positions (n,) or (times, n)."""
        found = np.asarray(q)[..., self.chosen]
        return found if self.less is None else found - np.asarray(q)[..., [self.less]]

    def take(self, exact: np.ndarray) -> None:
        """Judge by these positions (times, n) from now on."""
        self.exact = self.of(exact)
        everything = np.vstack([self.start, self.exact])
        self.extent = float(np.ptp(everything, axis=0).max())

    def error(self, found: np.ndarray) -> float:
        """Largest difference over the largest way that anything watched goes."""
        return float(np.abs(self.of(found) - self.exact).max()) / self.extent


def theirs(judge: Judge, method: str, tolerance: float) -> tuple[float, np.ndarray]:
    """CPU time s, and positions (times, n), of a method of SciPy."""
    equations = tautline.Simulation(judge.scene.scene, keep=False).equations
    t, q, v = equations.state()
    more = {} if method == "DOP853" else {"jac": equations.first_order_tangent}
    began = time.process_time()
    found = solve_ivp(
        equations.first_order, (t, judge.scene.end), np.concatenate((q, v)), method=method, rtol=tolerance,
        atol=1e-3 * tolerance * judge.scene.size, t_eval=judge.scene.times, **more,
    )  # fmt: skip
    used = time.process_time() - began
    many = len(judge.scene.times), equations.size
    return used, found.y[: equations.size].T if found.success else np.full(many, np.nan)


def ours(judge: Judge, method: str, step: float) -> tuple[float, np.ndarray]:
    """CPU time s of the steps, and positions (times, n), of a method of ours.

    ``step`` is that of the run, s; of `BY_ERROR` the error of a step, m, that it keeps.
    """
    times = judge.scene.times
    given = judge.scene.scene
    if method == BY_ERROR:
        given = given.replace({"solver.control": "error", "solver.step_error": step}, origin="work_precision.py")
        method, step = "generalized-alpha", float(given.solver.step)
    scene = Installed().of(given).with_overrides(given, method=method, step=step, end=times[-1], interval=times[0])
    sim = tautline.Simulation(scene, keep=False)
    begin, taken = sim.save(), []
    found = np.full((times.size, sim.equations.size), np.nan)
    while len(taken) < REPEATED and sum(taken) < ENOUGH:
        sim.restore(begin)
        spent = 0.0
        for k, t in enumerate(times):
            before = sim.wall_time
            try:
                sim.advance_to(float(t))
            except tautline.StoppedEarly:
                return np.nan, found
            spent += sim.wall_time - before
            found[k] = sim.equations.state()[1]
        taken.append(spent)
    return min(taken), found


def _of_ours(judge: Judge, quick: bool) -> Iterator[tuple[str, Curve]]:
    for method, steps in judge.scene.steps.items():
        runs = (ours(judge, method, step) for step in (steps[:2] if quick else steps))
        yield f"ours, {method}", [(used, judge.error(q)) for used, q in runs]


def _of_scipy(judge: Judge, quick: bool) -> Iterator[tuple[str, Curve]]:
    for method, tolerances in judge.scene.theirs.items():
        curve: Curve = []
        for tolerance in tolerances[:2] if quick else tolerances:
            used, q = theirs(judge, method, tolerance)
            curve.append((used, judge.error(q)))
            if used > LONGEST:
                break
        yield f"SciPy, {method}", curve


def _of_peer(scene: Scene, quick: bool) -> Iterator[tuple[str, Curve]]:
    """The peer's curve, by its own finest run; with half of a step and a residual a thousandth of those before it."""
    if scene.race is None or peer.version() is None:
        return
    steps = scene.race_steps[:2] if quick else scene.race_steps
    rival = peer.quickest(scene.race, peer.rivals(scene.race)[0])
    outcomes = []
    for step in (*steps, 0.5 * steps[-1]):
        case = replace(scene.race, step=step, relative=1e-9, absolute=1e-9)
        solving = peer.run(case, rival)
        outcomes.append((solving.solve, peer.run(case, rival, judged=True).points))
    exact = outcomes[-1][1]
    if exact is None:
        return
    extent = float(np.ptp(exact, axis=0).max())
    curve = [(used, np.nan if q is None else float(np.abs(q - exact).max()) / extent) for used, q in outcomes[:-1]]
    yield "Exudyn", curve


def curves(scene: Scene, quick: bool) -> Iterator[tuple[str, np.ndarray]]:
    """Name, and rows of CPU time s and error, of every method."""
    began, judge = time.perf_counter(), Judge(scene)
    who, method, size = scene.exact
    judge.take((ours if who == "ours" else theirs)(judge, method, size)[1])
    print(f"{scene.title}: reference {time.perf_counter() - began:.1f} s, {judge.extent:.3g}", file=sys.stderr)
    for part in (_of_ours(judge, quick), _of_scipy(judge, quick), _of_peer(scene, quick)):
        for name, rows in part:
            found = np.array(rows)
            print(f"  {name}: " + ", ".join(f"{t:.3g} s {e:.1e}" for t, e in rows), file=sys.stderr)
            yield name, found[np.isfinite(found).all(axis=1)]


def draw(found: dict[str, dict[str, np.ndarray]]) -> None:
    """The figure: a panel for each scene."""
    from tautline.view.figures.figure import save, styled

    save(styled(_drawn)(found), PICTURE)


def _drawn(found: dict[str, dict[str, np.ndarray]]) -> Any:
    from tautline.view.figures.figure import axes

    rows = (len(found) + 3) // 4
    figure, plots = axes(rows, 4, 14.4, 3.7 * rows, "Error against CPU time")
    plots = plots.ravel()
    for plot, (title, each) in zip(plots, found.items(), strict=True):
        for name, points in each.items():
            if len(points):
                ours = name.startswith("ours")
                look = {"marker": "o" if ours else "x", "linestyle": "-" if ours else "--"}
                plot.loglog(points[:, 0], points[:, 1], label=name, color=COLOURS[name.rpartition(", ")[2]], **look)
        plot.set_title(title)
        plot.set_xlabel("CPU time, s")
        plot.set_ylabel("error, share of the motion")
    names = {label: line for plot in plots for line, label in zip(*plot.get_legend_handles_labels(), strict=True)}
    figure.legend(names.values(), names.keys(), loc="outside lower center", ncols=len(names))
    return figure


def _best(each: dict[str, np.ndarray], whose: str, error: float) -> tuple[float, str] | None:
    """Shortest CPU time s of one's methods for an error, and the method; None where none comes there."""
    good = [
        (float(rows[rows[:, 1] <= error, 0].min()), name.removeprefix(f"{whose}, "))
        for name, rows in each.items()
        if name.startswith(whose) and len(rows) and (rows[:, 1] <= error).any()
    ]
    return min(good, default=None)


def _lines(run: Sequence[Scene], found: dict[str, dict[str, np.ndarray]]) -> list[tuple[str, ...]]:
    """Rows of the table: of each scene ours, SciPy's and Exudyn's quickest."""
    rows = []
    for scene in run:
        each = found[scene.title]
        for whose in ("ours", "SciPy", "Exudyn"):
            if not any(name.startswith(whose) for name in each):
                continue
            best = [_best(each, whose, error) for error in WANTED]
            cells = ["–" if one is None else f"{number(1e3 * one[0])}" for one in best]
            named = sorted({one[1] for one in best if one is not None and one[1] != whose})
            rows.append((scene.title, whose, *cells, ", ".join(named)))
    return rows


def measure(quick: bool) -> Section:
    """All curves, the figure, and a table of the times for errors from a tenth to a millionth of the motion."""
    run = scenes.QUICK if quick else scenes.SCENES
    found = {scene.title: dict(curves(scene, quick)) for scene in run}
    if not quick and peer.version() is not None:
        draw(found)
    header = ("scene", "whose", "10 %", "1 %", "0.1 %", "1e-4", "1e-5", "1e-6", "methods that were quickest")
    text = (
        "CPU time, ms, of the quickest run whose error is below so much; a dash where none came there. The error is "
        "the largest difference of what is watched, over the longest way that any of it goes. SciPy's methods call "
        "our equations once for each evaluation, from Python; Radau and BDF are given our tangent. Exudyn runs its own "
        "model of the same mesh, and is judged by its own finest run.\n\n" + table(header, _lines(run, found)) + "\n\n"
        + "\n".join(f"- {scene.title}: {scene.told}" for scene in run)
    )  # fmt: skip
    return Section("Integrators of others", text, [])


if __name__ == "__main__":
    show(measure, __doc__)
