"""Section 2.8 of the thesis, Figs 2.32 to 2.36: what solvers cost and how far they are off, by `tautline.study`."""

from __future__ import annotations

from benchmarks.page import Section, load, show
from benchmarks.thesis.precision import curves, hanging, hose, steps, times

PARTS = (
    times, hose, steps, hanging,
    curves,
)  # fmt: skip


def measure(quick: bool) -> Section:
    """Figs 2.32 to 2.36, and error against run time of four scenes."""
    before = load()
    parts = "".join(part.part(quick) for part in PARTS)
    text = (
        "All runs and references are those of `tautline.study` ([study.md](study.md)). Times are CPU times of the "
        "compiled time loop, medians of repeated runs, unless a real-time factor is named, which is wall time. Ratios "
        f"mean more than times: the load of the machine was {before} before and {load()} after (over 1/5/15 minutes)."
        "\n\n"
    )
    return Section("Run time and accuracy (section 2.8)", text + parts, [])


if __name__ == "__main__":
    show(measure, __doc__)
