"""Error against time: our integrators, and those of SciPy, which drive the same equations (`Simulation.equations`)."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import jwell
import numpy as np
from page import Section, number, show, table
from scipy.integrate import solve_ivp

import tautline

REPEATED = 5
"""Runs of ours of which the fastest counts: they are short."""
COLOURS = {
    "rk4": "C0", "generalized-alpha": "C1", "DOP853": "C2", "Radau": "C3", "BDF": "C4",
}  # fmt: skip
PICTURE = jwell.ROOT / "docs" / "images" / "work_precision.png"
ROPE = """
title: A slack rope that is let go
rope: {mass_per_length: 2.0, axial_stiffness: 2.0e4, damping: 2.0e-3, diameter: 22 mm, breaking_load: 0.4 MN}
path:
  - anchor: {name: left, position: [0, 0, 0]}
  - anchor: {name: right, position: [10, 0, 0]}
mesh: {elements_per_span: 8}
start: as drawn
solver: {method: generalized-alpha, rho_inf: 1, step: 0.2 ms, end: 1 s}
output: {interval: 10 ms}
"""


class Case(NamedTuple):
    """A scene, until when, the steps of ours, and tolerances of SciPy's methods."""

    title: str
    scene: Any
    end: float
    steps: dict[str, tuple[float, ...]]
    theirs: dict[str, tuple[float, ...]]
    exact: tuple[str, float]
    """Method and tolerance of the reference."""


def cases() -> list[Case]:
    """The three scenes; forces are smooth over the time that is run."""
    data = jwell.ROOT / "data"
    half = tuple(2.0**-k for k in range(6))
    loose = tuple(10.0**-k for k in range(3, 10))
    return [
        Case(
            "Hammer bar", data / "cantilever_bar.yaml", 0.9,
            {"rk4": tuple(0.04 * x for x in half), "generalized-alpha": tuple(0.02 * x for x in half)},
            {"DOP853": loose[:6], "Radau": loose[:4], "BDF": loose[:4]}, ("DOP853", 1e-11),
        ),
        Case(
            "Rope let go", ROPE, 0.5,
            {"rk4": tuple(4e-4 * x for x in half[:4]), "generalized-alpha": tuple(8e-3 * x for x in half)},
            {"DOP853": loose[:4], "Radau": loose[:3], "BDF": loose[:3]}, ("DOP853", 1e-9),
        ),
        Case(
            "Hose, 35 m/s", data / "hose.yaml", 0.05,
            {"rk4": tuple(5e-6 * x for x in half[:2]), "generalized-alpha": tuple(2e-3 * x for x in half)},
            {"Radau": loose[:5], "BDF": loose[:4]}, ("Radau", 1e-9),
        ),
    ]  # fmt: skip


def reference(case: Case) -> np.ndarray:
    """Positions at the end by a method of SciPy with a tolerance far below those of the curves."""
    return theirs(case, *case.exact)[1]


def theirs(case: Case, method: str, tolerance: float) -> tuple[float, np.ndarray]:
    """CPU time s, and positions (n,) at the end, of a method of SciPy."""
    equations = tautline.Simulation(case.scene, keep=False).equations
    t, q, v = equations.state()
    more = {} if method == "DOP853" else {"jac": equations.first_order_tangent}
    began = time.process_time()
    found = solve_ivp(
        equations.first_order, (t, case.end), np.concatenate((q, v)), method=method, rtol=tolerance,
        atol=1e-3 * tolerance, **more,
    )  # fmt: skip
    used = time.process_time() - began
    return used, found.y[: equations.size, -1] if found.success else np.full(equations.size, np.nan)


def ours(case: Case, method: str, step: float) -> tuple[float, np.ndarray]:
    """CPU time s of the steps, and positions (n,) at the end, of a method of ours."""
    scene = tautline.read(case.scene)
    from tautline.application.installed import Installed

    application = Installed().of(scene)
    scene = application.with_overrides(scene, method=method, step=step, end=case.end, interval=case.end)
    sim = tautline.Simulation(scene, keep=False)
    begin, taken = sim.save(), []
    for _ in range(REPEATED):
        sim.restore(begin)
        before = sim.wall_time
        try:
            sim.advance_to(case.end)
        except tautline.StoppedEarly:
            return np.nan, np.full(sim.model.system.size, np.nan)
        taken.append(sim.wall_time - before)
    return min(taken), sim.equations.state()[1]


def curves(case: Case, quick: bool) -> Iterator[tuple[str, np.ndarray]]:
    """Name, and rows of CPU time s and error m, of every method."""
    began = time.perf_counter()
    exact = reference(case)
    print(f"{case.title}: reference {time.perf_counter() - began:.1f} s", file=sys.stderr)
    for method, steps in case.steps.items():
        rows = [ours(case, method, step) for step in (steps[:2] if quick else steps)]
        yield f"ours, {method}", _errors(rows, exact)
    for method, tolerances in case.theirs.items():
        rows = [theirs(case, method, tolerance) for tolerance in (tolerances[:2] if quick else tolerances)]
        yield f"SciPy, {method}", _errors(rows, exact)


def _errors(rows: list[tuple[float, np.ndarray]], exact: np.ndarray) -> np.ndarray:
    found = np.array([(used, np.abs(q - exact).max()) for used, q in rows])
    return found[np.isfinite(found).all(axis=1)]


def draw(found: dict[str, dict[str, np.ndarray]]) -> None:
    """The figure: a panel for each scene."""
    from tautline.view.figures.figure import save, styled

    save(styled(_drawn)(found), PICTURE)


def _drawn(found: dict[str, dict[str, np.ndarray]]) -> Any:
    from tautline.view.figures.figure import axes

    figure, plots = axes(1, len(found), 3.6 * len(found), 3.9, "Error at the end against CPU time")
    plots = plots.ravel()
    for plot, (title, each) in zip(plots, found.items(), strict=True):
        for name, rows in each.items():
            if len(rows):
                ours = name.startswith("ours")
                look = {"marker": "o" if ours else "x", "linestyle": "-" if ours else "--"}
                plot.loglog(rows[:, 0], rows[:, 1], label=name, color=COLOURS[name.rpartition(" ")[2]], **look)
        plot.set_title(title)
        plot.set_xlabel("CPU time, s")
    plots[0].set_ylabel("error, m")
    plots[0].legend(fontsize="small")
    return figure


def measure(quick: bool) -> Section:
    """All curves; the table gives the time for an error of a ten-thousandth of a metre and less."""
    found, rows = {}, []
    for case in cases():
        found[case.title] = dict(curves(case, quick))
        for name, each in found[case.title].items():
            cells = []
            for wanted in (1e-4, 1e-6, 1e-8):
                good = each[each[:, 1] <= wanted] if len(each) else each
                cells.append(number(1e3 * good[:, 0].min()) if len(good) else "–")
            rows.append((case.title, name, *cells))
    if not quick:
        draw(found)
    header = ("scene", "method", "1e-4 m", "1e-6 m", "1e-8 m")
    text = (
        "CPU time, ms, until the largest error of a position at the end is below so much; a dash where none of the "
        "runs came there. SciPy's methods call our equations once for each evaluation, from Python; Radau and BDF are "
        "given our tangent.\n\n" + table(header, rows)
    )
    return Section("Integrators of others", text, [])


if __name__ == "__main__":
    show(measure, __doc__)
