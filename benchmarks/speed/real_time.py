"""Real-time factor of the J-well, warm, beside the thesis' and an untuned trial's."""

from __future__ import annotations

from statistics import median

from benchmarks import jwell
from benchmarks.page import Section, number, show, table

CASES = (
    ("generalized-alpha", 1e-3, 19.9, 0.021),
    ("generalized-alpha", 1e-2, 3.06, 0.0026),
    ("rk4", 1e-3, 2.29, 0.0083),
)
"""Method, step s, and the real-time factors of the thesis' Table 2.5 and of a planar trial."""


def measure(quick: bool) -> Section:
    """Run the cases in turn, so that a busy minute of the machine strikes all of them; the first round warms up."""
    end, repeats = (1.0, 2) if quick else (40.0, 11)
    rounds = [[jwell.run(method, step, end) for method, step, _, _ in CASES] for _ in range(repeats + 1)][1:]
    rows, headline = [], []
    for (method, step, thesis, trial), runs in zip(CASES, zip(*rounds, strict=True), strict=True):
        factors = [run.real_time_factor for run in runs]
        one = runs[0].attributes
        row = (
            method, f"{step:g}", number(median(factors)), f"{number(min(factors))} to {number(max(factors))}",
            number(median(run.wall for run in runs) / one["steps"] * 1e6),
            number(one["newton_iterations"] / one["steps"], 3) if one["newton_iterations"] else "–",
            one["halvings"] if runs[0].failure is None else runs[0].failure,
            number(median(run.cpu for run in runs)), number(thesis, 3), number(trial),
        )  # fmt: skip
        rows.append(row)
        what = f"real-time factor of the J-well, {method} at {1000 * step:g} ms"
        headline.append((what, number(median(factors)), f"thesis, in Python: {thesis:g}"))
    header = (
        "method", "step, s", "real-time factor, median", "smallest to largest", "µs per step",
        "Newton iterations per step", "step halvings", "CPU of the whole call, s", "thesis", "trial",
    )  # fmt: skip
    text = (
        f"`data/jwell.yaml`, 12 lumps, {end:g} s simulated, a frame every 50 ms, {repeats} repetitions after one that "
        "warms up. Real-time factor: wall time of the compiled time loop over simulated time. The CPU time is that of "
        "`tautline.simulate`, with the start, the frames and the energy balance. `rk4` takes the regularised law.\n\n"
        + table(header, rows)
    )
    return Section("Real time", text, headline)


if __name__ == "__main__":
    show(measure, __doc__)
