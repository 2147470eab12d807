"""Figs 2.21 and 2.22 of the thesis: two elements hit by a hammer, their axial force and its lines."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.page import number, table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import DOCS, picture
from tautline.cable.input.scene import read, with_values
from tautline.cable.model.build import build
from tautline.simulation import simulate
from tautline.view.figures.figure import COLOURS, Figure, axes, label, outline, styled
from tautline.view.figures.spectrum import spectrum

SCENE = DOCS.parent / "data" / "cantilever_bar.yaml"
HIT = 1.0
"""How long the hammer pushes, s (Paper 2 of the thesis, section 4.1: 0.01 N for 1 s)."""
SHOWN = 10.0
"""Seconds of the axial force that are drawn."""
RUNS = {
    # solver, step s, frames per second
    "RK4, h = 0.001 s": ("RK4", 1e-3, 100.0),
    "RK4, h = 0.01 s": ("RK4", 1e-2, 100.0),
    "generalized-α, h = 0.4 s": ("G-alpha", 0.4, 2.5),
    "RK4, h = 0.14 s": ("RK4", 0.14, 1.0 / 0.14),
}
THESIS = ("0.25", "–", "–", "–", "3.1")
"""Lines that it prints, Hz."""
FLOOR = 3e-5
"""Amplitude, m, below which no line is looked for: the hit moves the tip by 11 mm."""


class Swing(NamedTuple):
    """A run: times s, displacement of the tip m, force in the middle of element 1 N."""

    time: np.ndarray
    tip: np.ndarray
    force: np.ndarray

    def lines(self) -> tuple[np.ndarray, np.ndarray]:
        """Amplitude spectrum of the tip once the hammer has let go: Hz, m."""
        after = self.time >= HIT - 1e-9
        return spectrum(self.time[after], self.tip[after])


def swing(kind: str, step: float, frames: float, end: float) -> Swing:
    """Run data/cantilever_bar.yaml with another solver."""
    chosen = {"type": kind, "time_step": step, "time_end": end, "plotpoints": frames}
    result = simulate(build(with_values(read(SCENE), {("GeneralizedAlpha", k): (v, k) for k, v in chosen.items()})))
    return Swing(result["time"], result["position"][:, 2, 0] - 1.0, result["axial_force"][:, 1])


def line_near(frequency: np.ndarray, amplitude: np.ndarray, where: float) -> float | None:
    """Frequency, Hz, of the highest peak of a spectrum within 5 % of one, if there is a peak."""
    inner = amplitude[1:-1]
    peaks = 1 + np.flatnonzero((inner > amplitude[:-2]) & (inner >= amplitude[2:]) & (inner > FLOOR))
    close = peaks[np.abs(frequency[peaks] - where) < 0.05 * where]
    return float(frequency[close[np.argmax(amplitude[close])]]) if close.size else None


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    end = 20.0 if quick else 100.0
    exact = bars.textbook(2, 1.0) / (2.0 * np.pi)
    runs = {name: swing(*chosen, end) for name, chosen in RUNS.items()}
    found = {name: [line_near(*one.lines(), where) for where in exact] for name, one in runs.items()}
    rows = []
    for i, where in enumerate(exact):
        cells = ["–" if (line := lines[i]) is None else f"{line:.3f}" for lines in found.values()]
        rows.append((f"{i + 1}", f"{(2 * i + 1) / 4.0:.3f}", f"{where:.4f}", *cells, THESIS[i]))
    header = ("mode", "bar itself", "two elements, exact", *RUNS, "thesis")
    short, long = list(runs.values())[:2]
    apart = float(np.abs(short.force - long.force).max() / np.abs(short.force).max())
    images = picture(_force_figure(runs), "fig_2_21", "Axial force after the hammer, Fig. 2.21", quick)
    images += picture(_lines_figure(runs, exact), "fig_2_22", "Spectrum of the tip, Fig. 2.22", quick)
    return (
        "\n### Figs 2.21 and 2.22: the hammer test\n\n`data/cantilever_bar.yaml`: two elements of 0.5 m, 1 kg/m, 1 N, "
        f"0.01 N on the tip for {HIT:g} s, {end:g} s in all; generalized-α with the thesis' α_m = -0.05, α_f = 0.10. "
        "Frequencies in Hz: peaks of the amplitude spectrum of the tip once the hammer has let go (Hann window, "
        f"{end - HIT:g} s). Exact: eigenvalues of the textbook's matrices. Bar: (2 i - 1) S/(4 L). A dash: no peak "
        f"above {FLOOR:g} m within 5 % of the exact.\n\n"
        + table(header, rows)
        + "\n"
        + table(("figure", "ours", "thesis", "difference and why"), _printed(found, exact))
        + "\nWhat differs: the thesis sees more lines with 0.001 s than with 0.01 s. Here both show all five, and "
        f"their forces differ by {100.0 * apart:.1f} % of the largest: 0.01 s is {100.0 / exact[-1]:.0f} steps to the "
        "fastest period, and the blow of 1 s is the same for both. The smaller lines between are sums and differences "
        "of the five, from the squares in Green's strain. With 0.14 s, just below the longest step, RK4 is stable and "
        "damps the fast modes away: only low lines are left, as the thesis says of its longest step.\n" + images
    )  # fmt: skip


def _printed(found: dict[str, list[float | None]], exact: np.ndarray) -> list[tuple[str, ...]]:
    """What the thesis prints, beside ours."""
    fastest, slowest = found["RK4, h = 0.001 s"][-1], found["generalized-α, h = 0.4 s"][0]
    critical, rule = bars.STEP_LIMIT / (2.0 * np.pi * exact[-1]), bars.STEP_LIMIT * 0.19 * 0.5 / 2.0
    late = "" if slowest is None else f": {100.0 * (slowest / exact[0] - 1.0):+.1f} %"
    return [
        ("highest line, Hz", number(fastest, 4), "3.1", "none but rounding"),
        ("RK4's longest step, 2.8/ω, s", f"{critical:.4f}", "“congruent with the criterion”",
         f"eq. 2.151 with 0.19 L_e gives {rule:.4f}, {100.0 * (1.0 - rule / critical):.0f} % shorter, as in Fig. 2.10"),
        ("first line of generalized-α, Hz", number(slowest, 3), "0.25",
         "the thesis names the bar's own; with ten steps to a period the method's is slower" + late),
    ]  # fmt: skip


@styled
def _force_figure(runs: dict[str, Swing]) -> Figure:
    figure, plots = axes(1, 1, 8.0, 4.6, "Two-element hammer test: axial force in element 1")
    plot = plots[0, 0]
    looks = ({"lw": 2.6, "alpha": 0.45}, {"ls": "--", "lw": 1.2}, {"marker": "o", "ms": 4.5, "lw": 1.2})
    for at, ((name, one), look) in enumerate(zip(list(runs.items())[:3], looks, strict=True)):
        shown = one.time <= SHOWN + 1e-9
        plot.plot(one.time[shown], 1e3 * one.force[shown], color=COLOURS[at], label=name, **look)
    plot.axhline(0.0, color="black", lw=0.8)
    plot.set_xlim(0.0, SHOWN)
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label("axial force", "mN"))
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@styled
def _lines_figure(runs: dict[str, Swing], exact: np.ndarray) -> Figure:
    figure, plots = axes(1, 1, 8.0, 5.0, "Two-element hammer test: amplitude spectrum of the tip")
    plot = plots[0, 0]
    looks = ({"lw": 2.6, "alpha": 0.45}, {"ls": "--", "lw": 1.1}, {"lw": 1.4})
    for at, ((name, one), look) in enumerate(zip(list(runs.items())[:3], looks, strict=True)):
        frequency, amplitude = one.lines()
        plot.semilogy(frequency[1:], amplitude[1:], color=COLOURS[at], label=name, **look)
    for at, where in enumerate(exact):
        words = "eigenfrequencies, exact" if at == 0 else None
        plot.axvline(where, color="black", lw=0.9, ls=":", zorder=0.5, label=words)
        text = plot.text(where, 1.01, f"{where:.2f}", transform=plot.get_xaxis_transform(), ha="center", fontsize=8)
        outline(text)
    plot.set_xlim(0.0, 4.0)
    plot.set_ylim(1e-6, 2e-2)
    plot.set_xlabel(label("frequency", "Hz"))
    plot.set_ylabel(label("amplitude of the tip", "m"))
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure
