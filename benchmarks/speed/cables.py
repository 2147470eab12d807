"""Microseconds a step of cable scenes of many sizes, on one core."""

from __future__ import annotations

from statistics import median

from benchmarks.page import Section, number, show, table
from benchmarks.speed import ropes
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.simulation import simulate

ASKED = {("bar", 1, "RK4"): 0.5, ("bar", 4, "RK4"): 1.2, ("bar", 16, "RK4"): 4.0, ("bar", 64, "RK4"): 16.0,
         ("bar", 1, "G-alpha"): 1.0, ("bar", 4, "G-alpha"): 2.5, ("bar", 16, "G-alpha"): 8.0,
         ("bar", 64, "G-alpha"): 30.0, ("hanging", 100, "G-alpha"): 75.0, ("hanging", 1000, "G-alpha"): 650.0,
         ("flowing", 100, "G-alpha"): 95.0, ("flowing", 1000, "G-alpha"): 850.0}  # fmt: skip
"""What was asked of this version, microseconds a step."""


def _cases(quick: bool) -> list[tuple[str, int, str, str]]:
    """What is measured: kind, elements, method, scene."""
    sizes, long = ((1, 4), (20,)) if quick else ((1, 4, 16, 64), (100, 1000))
    cases = []
    for n in sizes:
        steps = 2000 if quick else 400000 // n
        cases.append(("bar", n, "RK4", ropes.bar(n, "RK4", 1e-4, 1e-4 * steps)))
        cases.append(("bar", n, "G-alpha", ropes.bar(n, "G-alpha", 1e-3, 1e-3 * steps)))
    for n in long:
        steps = 20 if quick else 100000 // n
        for kind, flow in (("hanging", None), ("flowing", "shared")):
            cases.append((kind, n, "G-alpha", ropes.rope(n, "G-alpha", 1e-3, 1e-3 * steps, flow)))
    return cases


def _measured(text: str, repeats: int) -> tuple[list[float], dict]:
    scene, spent, attributes = parse(text), [], {}
    for _ in range(repeats + 1):
        attributes = simulate(build(scene)).attributes
        spent.append(1e6 * attributes["wall_time"] / attributes["steps"])
    return spent[1:], attributes


def measure(quick: bool) -> Section:
    """Bars that only stretch, hanging ropes, and ropes that run at one free velocity; three dimensions."""
    rows, found = [], {}
    for kind, n, method, text in _cases(quick):
        spent, attributes = _measured(text, 1 if quick else 7)
        found[kind, n, method] = median(spent)
        iterations = attributes["newton_iterations"] / attributes["steps"]
        rows.append(
            (kind, f"{n}", method, number(median(spent), 3), f"{number(min(spent), 3)} to {number(max(spent), 3)}",
             number(ASKED.get((kind, n, method)), 3), number(iterations, 3) if method != "RK4" else "–")
        )  # fmt: skip
    header = (
        "scene",
        "elements",
        "method",
        "µs per step, median",
        "spread",
        "asked",
        "iterations per step",
    )
    text = (
        "Bars of cubic elements that only stretch (EA 1000, rhoA 1, 1 m; steps 0.1 ms by RK4, 1 ms by "
        "generalized-alpha); ropes of 1 m elements that swing (EA 1e5, rhoA 1, 1 ms), hanging from one end, or held at "
        "both and running through them at one free velocity. The first of eight runs warms up.\n\n"
        + table(header, rows)
    )
    shown = [("hanging", 1000), ("flowing", 1000)]
    headline = [
        (f"rope of {n} elements, {kind}, generalized-alpha, µs a step", number(found[kind, n, "G-alpha"], 3),
         f"asked: {ASKED[kind, n, 'G-alpha']:g}")
        for kind, n in shown
        if (kind, n, "G-alpha") in found
    ]  # fmt: skip
    return Section("Cost of a step of cable scenes", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
