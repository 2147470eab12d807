"""The garden hose of the thesis' Case 3: error against run time, limit cycles, stability boundary.

Writes docs/hose_validation.md, each part in its place, and the figures of docs/hose.md. With --quick nothing is
written.
"""

from __future__ import annotations

import argparse
import functools
import importlib.util
import sys
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

from benchmarks.hose import figures as hose_figures
from benchmarks.hose import runs as hoses
from benchmarks.page import Section, load, machine, number, table
from gardenhose.flutter import crossings
from gardenhose.scene import HoseScene
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

PAGE = hoses.ROOT / "docs" / "hose_validation.md"
ASKED = 0.03
"""CPU seconds per simulated second that were asked for."""
STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
TIGHT = 1e-8
"""Tolerance of the runs that others are compared with."""
TIGHTER = 1e-6
"""Tolerance of the runs that limit cycles are read from."""
BELOW = 0.96
"""Share of its critical step that RK4 runs at: the limit falls a little as the hose bends."""
SETTLING = {15.0: 10.0, 25.0: 5.0, 35.0: 5.0}
"""Lengths of the runs that limit cycles are read from, s."""
BETAS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.28, 0.29, 0.295, 0.298, 0.305, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.68, 0.69,
         0.694, 0.698, 0.705, 0.75, 0.8, 0.85, 0.9, 0.915, 0.92, 0.93, 0.95)  # fmt: skip
TABLED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)


def timed(repeats: int, *of: Any, **keys: Any) -> list[hoses.Run]:
    """Repeat a run; the first warms up."""
    return [hoses.run(*of, **keys) for _ in range(repeats + 1)][1:]


def spread(values: list[float], digits: int = 2) -> str:
    """Smallest to largest."""
    return f"{number(min(values), digits)} to {number(max(values), digits)}"


def speed(quick: bool = False) -> Section:
    """CPU seconds per simulated second, step 1 ms, ten elements."""
    end, repeats = (0.5, 1) if quick else (5.0, 11)
    rows, loops = [], []
    for flow in hoses.SPEEDS:
        runs = timed(repeats, flow, end, 1e-3)
        whole, loop = ([x / end for x in of] for of in ([run.cpu for run in runs], [run.loop for run in runs]))
        one = runs[0].attributes
        loops.append(median(loop))
        rows.append(
            (f"{flow:g}", number(median(loop)), spread(loop), number(median(whole)), spread(whole), f"{ASKED:g}",
             number(1e6 * median(loop) * end / one["steps"], 3),
             number(one["newton_iterations"] / one["steps"], 3), number(one["factorisations"] / one["steps"]))
        )  # fmt: skip
    header = (
        "flow, m/s", "time loop, median", "spread", "whole call, median", "spread", "asked", "µs per step",
        "iterations per step", "factorisations per step",
    )  # fmt: skip
    text = (
        f"`data/hose.yaml` with a constant speed: 10 elements in three dimensions, generalized-alpha (rho_inf 0.9) at "
        f"1 ms, {end:g} s simulated, a frame every 5 ms, {repeats} repetitions after one that warms up. Seconds per "
        "simulated second: those of the compiled time loop, and the CPU time of all of `tautline.simulate`, which "
        "reads nothing from disk but builds the scene, keeps the frames and finds the limit cycle.\n\n"
        + table(header, rows)
    )
    what = "hose fluttering at 15 / 25 / 35 m/s, seconds per simulated second at 1 ms"
    return Section("Run time of the hose", text, [(what, " / ".join(number(x) for x in loops), f"asked: {ASKED:g}")])


measure = speed
"""What `report.py` puts on its page."""


def precision(quick: bool = False) -> Section:
    """Error of the tip at 1 s against CPU time."""
    meshes, steps, repeats, finest = ((10,), (2e-3,), 1, 5e-4) if quick else ((10, 20), STEPS, 7, 1e-5)
    exact = hoses.exact_tip()
    keys: dict[str, Any] = {"output__interval": "20 ms"}
    rows, curves = [], []
    for n in meshes:
        keys["hose__elements"] = n
        converged = hoses.run(15.0, 1.0, finest, solver__tolerance=TIGHT, **keys).end
        points = [_point(timed(repeats, 15.0, 1.0, step, **keys), converged, exact) for step in steps]
        curves.append(hose_figures.Curve(f"generalized-alpha, {n} elements", *np.array(points)[:, [0, 4, 5]].T))
        for step, point in zip(steps, points, strict=True):
            rows.append(("generalized-alpha", f"{n}", f"{step:g}", *_cells(point)))
        rows.append(("the same, converged", f"{n}", f"{finest:g}", "–", "–", "–", "–", "–",
                     f"{np.linalg.norm(converged - exact):.1e}"))  # fmt: skip
    if not quick:
        keys["hose__elements"] = 10
        converged = hoses.run(15.0, 1.0, finest, solver__tolerance=TIGHT, **keys).end
        step = BELOW * hoses.critical_step(15.0, hose__elements=10)
        explicit = timed(3, 15.0, 1.0, step, **keys, solver__method="rk4")
        point = _point(explicit, converged, exact)
        curves.append(hose_figures.Curve("RK4, 10 elements", *np.array([point])[:, [0, 4, 5]].T))
        rows.append(("RK4", "10", f"{explicit[0].attributes['step']:.3g}", *_cells(point)))
        hose_figures.precision(curves)
    header = (
        "method", "elements", "step, s", "time loop, s", "spread", "whole call, CPU s", "spread",
        "error of time: to the same mesh converged, m", "error: to the exact hose, m",
    )  # fmt: skip
    text = (
        f"Distance of the tip at 1 s from where it should be: 15 m/s from t = 0 on, from rest, straight. Medians of "
        f"{repeats} runs (3 of RK4). The converged run of a mesh has a step of {finest:g} s and a tolerance of "
        f"{TIGHT:g}; the exact hose is `tests/references/hose_tip.csv`, global polynomials without finite elements. "
        "RK4 runs just below its critical step.\n\n"
        + table(header, rows)
        + "\n![Error of the tip against run time](images/hose_precision.png)\n"
    )
    return Section("Error against run time", text, [])


def _point(runs: list[hoses.Run], converged: np.ndarray, exact: np.ndarray) -> tuple[float, ...]:
    """Loop s, CPU s, spread of both in between, errors m; see `_cells`."""
    loop, whole = [run.loop for run in runs], [run.cpu for run in runs]
    assert runs[0].failure is None, runs[0].failure
    errors = (float(np.linalg.norm(runs[0].end - other)) for other in (converged, exact))
    return median(loop), min(loop), max(loop), median(whole), *errors, min(whole), max(whole)


def _cells(point: tuple[float, ...]) -> tuple[str, ...]:
    loop, low, high, whole, to_converged, to_exact, least, most = point
    return (
        number(loop), spread([low, high]), number(whole), spread([least, most]), f"{to_converged:.1e}",
        f"{to_exact:.1e}",
    )  # fmt: skip


def cycles(quick: bool = False) -> Section:
    """Limit cycles, converged in step and mesh, and the same by all couplings and methods."""
    flows = (35.0,) if quick else hoses.SPEEDS
    meshes, steps = ((10,), (1e-3,)) if quick else ((10, 20), (1e-3, 5e-4, 2.5e-4))
    exact = hoses.exact_cycles()
    rows = []
    for flow in flows:
        truth = exact["cycles"][f"{flow:g}"]
        true = (truth["frequency"], truth["z_range"])
        for n in meshes:
            for step in steps:
                rows.append((f"{flow:g}", f"{n}", f"{step:g}", *_against(_cycle(flow, step, elements=n), true)))
        rows.append((f"{flow:g}", "exact", "exact", f"{true[0]:.5g}", "", f"{true[1]:.5f}", ""))
    header = ("flow, m/s", "elements", "step, s", "frequency, Hz", "from the exact", "peak to peak, z, m",
              "from the exact")  # fmt: skip
    names = ("linear",) if quick else ("linear", "lagrange", "penalty", "augmented")
    others = []
    for flow in flows:
        base = _cycle(flow, 5e-4)
        for coupling in names:
            found = _cycle(flow, 5e-4, coupling=coupling)
            others.append((f"{flow:g}", coupling, "generalized-alpha", "0.0005", *_against(found, base, 1)))
        if not quick:
            fine = _cycle(flow, 5e-5)
            others.append((f"{flow:g}", "linear", "generalized-alpha", "5e-05", *_against(fine, base, 1)))
            step = BELOW * hoses.critical_step(flow)
            explicit = _cycle(flow, step, method="rk4")
            others.append((f"{flow:g}", "linear", "RK4", f"{step:.3g}", *_against(explicit, base, 1)))
    text = (
        f"Constant speed from t = 0, generalized-alpha (rho_inf 0.9), tolerance {TIGHTER:g}, frames every 1 ms; "
        "frequency and extent of the "
        "tip's motion along z over the last cycles of "
        + ", ".join(f"{SETTLING[flow]:g} s ({flow:g} m/s)" for flow in flows)
        + ". The exact hose is `tests/references/hose_cycles.json`: motion in the plane, polynomials; two "
        f"resolutions of it differ by up to {_own_error(exact):.1e} of the frequency.\n\n"
        + table(header, rows)
        + "\nAll ways to couple water and hose, and RK4 just below its critical step, beside the first row of each "
        "speed (10 elements):\n\n"
        + table(("flow, m/s", "coupling", "method", "step, s", "frequency, Hz", "from the first",
                 "peak to peak, z, m", "from the first"), others)
        + "\n![Phase portraits](images/hose_portraits.png)\n"
    )  # fmt: skip
    return Section("Limit cycles", text, [])


def _own_error(exact: dict[str, Any]) -> float:
    """Relative difference of the frequencies that the reference finds with more and with fewer modes."""
    both = [[one["frequency"] for one in exact[key].values()] for key in ("cycles", "cycles_coarser")]
    return float(np.abs(np.divide(*both) - 1.0).max())


@functools.cache
def _cycle(flow: float, step: float, elements: int = 10, coupling: str = "linear", method: str = "") -> Any:
    """Frequency, Hz, and extent along z, m, or how the run failed."""
    keys: dict[str, Any] = {"hose__elements": elements, "output__interval": "1 ms", "coupling": coupling}
    keys["solver__tolerance"] = TIGHTER
    run = hoses.run(flow, SETTLING[flow], step, **keys, **({"solver__method": method} if method else {}))
    cycle = run.cycle
    return run.failure or (cycle.frequency, 2.0 * float(cycle.axis_amplitude[2]))


def _against(found: Any, base: Any, digits: int = 2) -> tuple[str, ...]:
    """Frequency and extent, each with its relative difference."""
    if isinstance(found, str):
        return found, "–", "–", "–"
    apart = [f"{a / b - 1.0:+.{digits}e}" if a != b else "0" for a, b in zip(found, base, strict=True)]
    return f"{found[0]:.5g}", apart[0], f"{found[1]:.5f}", apart[1]


def straight(beta: float, elements: int = 20) -> HoseScene:
    """A hose of length, bending stiffness and mass one, weightless, undamped, all but inextensible: u = U sqrt(M)."""
    text = f"""
hose:
  {{length: 1, elements: {elements}, axial_stiffness: 1.0e+7, bending_stiffness: 1, mass_per_length: {1.0 - beta!r}}}
water: {{mass_per_length: {beta!r}, speed: 0}}
gravity: [0, 0, 0]
disturbance: [0, 0, 1.0e-3]
solver: {{step: 1 ms, end: 1 s}}
output: {{interval: 10 ms}}
"""
    return validate(HoseScene, Document.parse(text, "straight.yaml"))


def boundary(quick: bool = False) -> Section:
    """Critical speeds of straight cantilevers beside the exact boundary of Gregory and Paidoussis' problem."""
    dots, apart, rows = [], [], []
    for beta in (0.2,) if quick else sorted({*BETAS, *TABLED}):
        exact, ends = _passages(beta)
        found = _crossings(beta, [u for u, _ in exact])
        assert len(found) == len(exact), (beta, exact, found)
        if ends:
            exact = exact + ends
            found = found + _crossings(beta, [u for u, _ in ends], ceasing=True)
        dots += [(beta, u) for u, _ in found]
        apart += [abs(ours / u - 1.0) for (u, _), (ours, _) in zip(exact, found, strict=True)]
        if beta in TABLED:
            (u, omega), (ours, frequency) = exact[0], found[0]
            rows.append((f"{beta:g}", f"{u:.4f}", f"{ours:.4f}", f"{ours / u - 1.0:+.1e}", f"{omega:.3f}",
                         f"{frequency:.3f}", f"{frequency / omega - 1.0:+.1e}"))  # fmt: skip
    if not quick:
        hose_figures.boundary(np.array(dots), _reference().boundary_curve())
    header = ("mass ratio β", "u, exact", "u, 20 elements", "difference", "ω, exact", "ω, 20 elements", "difference")
    text = (
        "A straight cantilever without weight and damping, 20 elements, EA L²/EJ = 1e7: the lowest speed at which a "
        "small motion grows, by the search of `gardenhose flutter`, beside the exact determinant of Gregory and "
        "Païdoussis' problem (Proc. R. Soc. A 293, 1966), solved by `tests/references/hose.py`. "
        "u = U L √(M/EJ), ω in √(EJ/(m + M))/L².\n\n"
        + table(header, rows)
        + f"\nThe figure shows all {len(dots)} passages at {len({beta for beta, _ in dots})} mass ratios from "
        f"{dots[0][0]:g} to {dots[-1][0]:g}. Where the boundary is S-shaped there are three at one β: the cantilever "
        "becomes unstable, stable again, and unstable. The largest relative difference from the exact u is "
        f"{max(apart):.1e}.\n"
        "\n![Stability boundary](images/hose_boundary.png)\n"
    )
    return Section("Stability boundary", text, [])


def _passages(beta: float) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Exact u and omega at which the cantilever becomes unstable, and those at which it becomes stable again."""
    growing, onsets, ends = 0, [], []
    for one in _reference().critical_speeds(beta):
        growing += 1 if one.becomes == "unstable" else -1
        if one.becomes == "unstable" and growing == 1:
            onsets.append((one.u, one.omega))
        if growing == 0:
            ends.append((one.u, one.omega))
    return onsets, ends


def _crossings(beta: float, near: list[float], ceasing: bool = False) -> list[tuple[float, float]]:
    """u and omega of our passages: onsets are sought coarsely below the first exact one too, finely about all."""
    coarse = np.arange(1.5, near[0] - 0.5, 1.5) if not ceasing else ()
    fine = np.unique(np.concatenate([u * (1.0 + np.array([-1e-2, -2e-3, 2e-3, 1e-2])) for u in near]))
    found = crossings(straight(beta), [u / np.sqrt(beta) for u in (*coarse, *fine)], ceasing=ceasing)
    return [(one.speed * float(np.sqrt(beta)), 2.0 * np.pi * one.frequency) for one in found]


@functools.cache
def _reference() -> Any:
    """The reference's own solution, loaded by its path: it is called as this script is."""
    spec = importlib.util.spec_from_file_location("hose_reference", hoses.REFERENCES / "hose.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


PARTS: dict[str, Callable[[bool], Section]] = {
    "precision": precision, "cycles": cycles, "boundary": boundary
}  # fmt: skip
HEAD = (
    "# The hose beside references\n\nWritten by `python -m benchmarks.hose.validation`; "
    "`python -m benchmarks.hose.validation precision` (or "
    f"{', '.join(list(PARTS)[1:])}) measures one part anew. The claims that tests hold the program to are in "
    "[claims.md](claims.md), what the keys mean in [hose.md](hose.md).\n"
)


def write(part: str, section: Section, measured: str) -> None:
    """Put a part on the page, in its place."""
    texts = {}
    if PAGE.exists():
        page = PAGE.read_text(encoding="utf8")
        for name in PARTS:
            _, _, rest = page.partition(f"<!-- {name} -->\n")
            texts[name] = rest.partition(f"<!-- end of {name} -->")[0]
    texts[part] = f"{section}\nMeasured: {measured}.\n"
    marked = [f"<!-- {name} -->\n{texts[name]}<!-- end of {name} -->\n" for name in PARTS if texts.get(name)]
    PAGE.write_text("\n".join([HEAD, *marked]), encoding="utf8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", nargs="?", choices=[*PARTS, "figures", "all"], default="all")
    parser.add_argument("--quick", action="store_true", help="a reduced run that only shows that it runs")
    asked = parser.parse_args()
    for name in PARTS if asked.part == "all" else [asked.part]:
        if name == "figures":
            continue
        before = load()
        section = PARTS[name](asked.quick)
        print(f"{section}\n{machine(before)}.\n", flush=True)
        if not asked.quick:
            write(name, section, machine(before))
    if asked.part in ("figures", "all") and not asked.quick:
        hose_figures.write()


if __name__ == "__main__":
    main()
