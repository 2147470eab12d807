"""Variants of the J-well from Python in a loop: wall time of all of it over that of the time loops alone."""

from __future__ import annotations

import time
from statistics import median

import tautline
from benchmarks import jwell
from benchmarks.page import Section, number, show, table

COUNT, QUICK = 50, 10
ENDS = (5.0, 10.0, 40.0)
"""Simulated time of each variant, s; the last is the scene's own."""
LOW, HIGH = 0.05, 0.35
"""Kinetic friction factors of the first and the last variant."""
AT_MOST = 1.2
"""Times the loops that variants of the scene's own length may cost."""


def loop(scene: object, count: int, end: float) -> tuple[float, float]:
    """Wall time of a number of variants, each changed, built, run and kept in memory, and of their loops alone, s."""
    began, loops = time.perf_counter(), 0.0
    for k in range(count):
        factor = LOW + (HIGH - LOW) * k / (count - 1)
        changes = {"well.wall.friction.kinetic": factor, "well.wall.friction.static": max(0.3, factor)}
        loops += tautline.simulate(scene.replace(changes), end=end).attributes["wall_time"]
    return time.perf_counter() - began, loops


def measure(quick: bool) -> Section:
    """One variant warms up; the loops of all lengths take turns, so that a busy minute strikes each of them."""
    scene = tautline.read(jwell.ROOT / "data" / "jwell.yaml")
    count, rounds = (QUICK, 1) if quick else (COUNT, 3)
    loop(scene, 2, 1.0)
    found = [[loop(scene, count, end) for end in ENDS] for _ in range(rounds)]
    rows, headline = [], []
    for end, runs in zip(ENDS, zip(*found, strict=True), strict=True):
        ratio = median(whole / loops for whole, loops in runs)
        beside = median((whole - loops) / count for whole, loops in runs)
        each = median(loops / count for _, loops in runs)
        rows.append((f"{end:g}", number(1e3 * each), number(1e3 * beside), number(ratio, 3)))
        if end == ENDS[-1]:
            what = f"{count} variants of the J-well in a loop, over their time loops"
            headline.append((what, number(ratio, 3), f"at most {AT_MOST:g}"))
    header = ("simulated, s", "time loop, ms", "all else, ms", "whole over loops")
    text = (
        f"`data/jwell.yaml` with {count} friction factors by `tautline.simulate(scene.replace({{...}}), end=...)`, "
        f"in memory; medians of {rounds} rounds. All else is the changed scene, its model, its static start and "
        "the frames. The hole, the lumps, the types and addresses of compiled code, and the list of applications are "
        "made once.\n\n" + table(header, rows)
    )
    return Section("Variants in a loop", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
