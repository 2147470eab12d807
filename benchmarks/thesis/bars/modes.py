"""Table 2.1 and Figs 2.10 and 2.12 of the thesis: the highest axial frequencies of one element and of a mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.page import table
from benchmarks.thesis.bars import scenes as bars
from benchmarks.thesis.pictures import picture
from tautline.view.figures.figure import COLOURS, QUIET, Figure, axes, label, styled

EA = 1000.0
SOUND = float(np.sqrt(EA))
"""Speed of sound S, m/s: 1 kg/m."""
TABLE_2_1 = {
    # place of the mode among ours, from the slowest on; printed omega rad/s, L_eff/L_e, h_max ms
    ("MSD f/f", ""): (1, "63.3", "1.00", "44.3"),
    ("f/f", "1"): (3, "412.5", "0.15", "6.8"),
    ("f/f", "2"): (0, "0", "0", "0"),
    ("f/f", "3"): (1, "99.37", "0.64", "28.2"),
    ("f/f", "4"): (2, "244.9", "0.26", "11.4"),
    ("p/f", "1"): (2, "330.4", "0.19", "8.5"),
    ("p/f", "2"): (1, "152.9", "0.41", "18.3"),
    ("p/f", "3"): (0, "49.7", "1.27", "56.3"),
    ("p/p", "1"): (1, "244.9", "0.31", "13.7"),
    ("p/p", "2"): (0, "100.0", "0.63", "20.8"),
    ("+/-", "1"): (0, "99.4", "0.64", "28.2"),
    ("+/-", "2"): (1, "99.9", "0.63", "28.0"),
    ("+/+", "1"): (0, "0", "0", "0"),
    ("+/+", "2"): (1, "204.9", "0.31", "13.7"),
}
WHY = {
    ("MSD f/f", ""): "ω rounded the wrong way: 2 S/L_e = 63.246",
    ("f/f", "2"): "rigid motion: the step has no limit, where 0 is printed",
    ("p/f", "3"): "h cut off, not rounded: 56.36",
    (
        "p/p",
        "1",
    ): "**misprint of ω**: 244.9 is f/f 4; the printed L_eff 0.31 and h 13.7 ms belong to 204.9, which +/+ 2, "
    "the same motion, has",
    ("p/p", "2"): "**misprint of h**: 2.8/100.0 is 28.0 ms, which +/- 2, the same motion, has",
    ("+/-", "2"): "last digit of ω: the same motion as p/p 2, √10 S/L_e = 100.0, and its h 28.0 ms belongs to that",
    ("+/+", "1"): "rigid motion, as f/f 2",
}
"""What is to be said of the rows in which a printed figure is not ours to its last digit."""
SHAPES = {
    # of the fastest mode: our full degrees of freedom, the printed vector (eqs 2.146 to 2.148)
    "f/f": ((0, 3, 7, 10), (-0.06, 0.71, 0.06, 0.71), "free - free"),
    "p/f": ((3, 7, 10), (0.38, 0.10, 0.92), "pinned - free"),
    "p/p": ((3, 10), (0.71, 0.71), "pinned - pinned"),
}
MESHES = (1, 2, 4, 8, 16)
DRAWN = tuple(range(1, 17))
SHARE = 0.19
"""L_eff/L_e of the rule for a mesh with a free end: p/f 1 as printed."""
ZERO = 0.77
"""Where the thesis sees the fastest mode of the free element at rest, of s from -1 to 1."""


def items_of(name: str) -> list[str]:
    """Scene of the element of a row of Table 2.1."""
    if name == "MSD f/f":
        return bars.chain(1, EA, pinned=False)
    if name in ("f/f", "p/f", "p/p"):
        first, second = ("pinned" if letter == "p" else "free" for letter in name.split("/"))
        return bars.bar(1, EA, (first, second))
    sign = -1.0 if name == "+/-" else 1.0
    patterns = (bars.same(1, 1, sign, 1.0), bars.same(4, 4, sign, 1.0 - sign))
    return [*bars.bar(1, EA, ("free", "free")), *patterns]


def table_2_1() -> str:
    """Table 2.1 with ours beside."""
    rows, found, explained = [], {}, set()
    for (name, which), (place, *printed) in TABLE_2_1.items():
        if name not in found:
            found[name] = bars.modes_of(items_of(name)).omega
        omega = float(found[name][place])
        rigid = omega < 1e-6 * float(found[name][-1])
        ours = (0.0, np.inf, np.inf) if rigid else (omega, 2.0 * SOUND / omega, 1e3 * bars.STEP_LIMIT / omega)
        cells = []
        for value, text, digits in zip(ours, printed, (3, 4, 2), strict=True):
            exact = f"{value:.{digits}f}" if np.isfinite(value) else "∞"
            if abs(value - float(text)) > 0.5 * 10.0 ** -len(text.partition(".")[2]):
                explained.add((name, which))
                text = f"**{text}**"
            cells += [exact, text]
        # Each row that is not ours to its last digit is explained, and no other.
        rows.append((f"{name} {which}".strip(), *cells, WHY.get((name, which), "")))
    assert explained == set(WHY), explained ^ set(WHY)
    header = ("configuration", "ω, rad/s: ours", "thesis", "L_eff/L_e: ours", "thesis", "h_max, ms: ours", "thesis",
              "difference and why")  # fmt: skip
    return (
        "### Table 2.1: one element\n\nρA = 1 kg/m, L_e = 1 m, EA = 1000 N. Ours: eigenvalues of the program's own "
        "mass and stiffness of a scene with one element, its two nodes free, pinned, or tied by couplings (the "
        "patterns of eqs 2.152 and 2.153); MSD is a spring between two half masses. L_eff = 2 S/ω, h_max = 2.8/ω. A "
        "printed figure in bold is not ours to its last digit.\n\n"
        + table(header, rows)
        + "\nWhat differs: two misprints, of p/p 1 and p/p 2, three last digits, and the steps of rigid motion.\n"
    )  # fmt: skip


def fastest_shapes(quick: bool) -> str:
    """Fig. 2.12 and the vectors of eqs 2.146 to 2.148."""
    s = np.linspace(-1.0, 1.0, 401)
    xi = (1.0 + s) / 2.0
    rows, curves = [], []
    for name, (places, printed, words) in SHAPES.items():
        shape = bars.modes_of(items_of(name)).shape[:, -1]
        shape = shape * np.sign(shape[10]) / np.linalg.norm(shape[list(places)])
        curves.append((words, _cubic(xi, shape[[0, 3, 7, 10]])))
        ours = shape[list(places)]
        apart = float(np.abs(ours - printed).max())
        rows.append((words, *(f"({', '.join(f'{x:.3f}' for x in v)})" for v in (ours, printed)), f"{apart:.3f}"))
        assert apart < 0.006, (name, ours)
    crossing, of_printed = _last_zero(s, curves[0][1]), _last_zero(s, _cubic(xi, SHAPES["f/f"][1]))
    text = picture(_shapes_figure(s, curves), "fig_2_12", "Fastest modes of one element, Fig. 2.12", quick)
    return (
        "\n### Fig. 2.12: the fastest mode of one element\n\nUnknowns that are free, in the order of eqs 2.146 to "
        "2.148 (L_e = 1 m), of length one.\n\n"
        + table(("element", "ours", "thesis", "largest difference"), rows)
        + "\nWhat differs: the printed 0.71 of the free element is 0.704; all else is ours rounded. That element is at "
        f"rest at s = ±{crossing:.3f}. The thesis' ±{ZERO} is where its rounded vector is (±{of_printed:.3f}).\n" + text
    )  # fmt: skip


def _cubic(xi: np.ndarray, ends: Sequence[float]) -> np.ndarray:
    """Displacement along an element of length one from (u, u') of its ends, eq. 2.11."""
    shapes = (1 - 3 * xi**2 + 2 * xi**3, xi - 2 * xi**2 + xi**3, 3 * xi**2 - 2 * xi**3, xi**3 - xi**2)
    return sum(value * shape for value, shape in zip(ends, shapes, strict=True))


def _last_zero(s: np.ndarray, u: np.ndarray) -> float:
    """Largest s at which u passes zero."""
    last = int(np.flatnonzero(u[:-1] * u[1:] <= 0.0)[-1])
    return float(s[last] - u[last] * (s[last + 1] - s[last]) / (u[last + 1] - u[last]))


@styled
def _shapes_figure(s: np.ndarray, curves: list[tuple[str, np.ndarray]]) -> Figure:
    figure, plots = axes(1, 1, 7.0, 4.2, "Fastest axial mode of one element, $L_e$ = 1 m")
    plot = plots[0, 0]
    plot.axhline(0.0, color="black", lw=0.8)
    for number, (words, u) in enumerate(curves):
        plot.plot(s, u, color=COLOURS[number], label=words)
    plot.set_xlim(-1.0, 1.0)
    plot.set_xlabel(label("place along the element s", "–"))
    plot.set_ylabel(label("displacement along the bar", "m"))
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def highest(quick: bool) -> str:
    """Fig. 2.10: highest frequency against the number of elements."""
    ours = {n: float(bars.modes_of(bars.bar(n, EA), bars.GRAVITY).omega[-1]) for n in (MESHES[:3] if quick else DRAWN)}
    masses = {n: float(bars.modes_of(bars.chain(n, EA), bars.GRAVITY).omega[-1]) for n in ours}
    rows, ratios = [], {}
    for n in (n for n in MESHES if n in ours):
        still, rule = float(bars.modes_of(bars.bar(n, EA)).omega[-1]), 2.0 * SOUND * n / SHARE
        ratios[n] = still / (2.0 * SOUND * n)
        apart = still / float(bars.textbook(n, EA)[-1]) - 1.0
        assert abs(apart) < 1e-10, (n, apart)
        rows.append((f"{n}", f"{ours[n]:.1f}", f"{still:.1f}", f"{masses[n]:.1f}", f"{2.0 * SOUND * n:.1f}",
                     f"{ratios[n]:.3f}", f"{1e3 * bars.STEP_LIMIT / still:.2f}",
                     f"{1e3 * bars.STEP_LIMIT / rule:.2f}"))  # fmt: skip
    alone, *others = ratios.values()
    reserve = sorted(1.0 - SHARE * ratio for ratio in others)
    pinned = float(bars.modes_of(bars.bar(4, EA, ("pinned", "pinned"))).omega[-1]) / (8.0 * SOUND)
    one = float(bars.modes_of(items_of("p/p")).omega[-1]) / (2.0 * SOUND)
    text = picture(_highest_figure(ours, masses), "fig_2_10", "Highest axial frequency, Fig. 2.10", quick)
    header = ("elements", "ω, rad/s, hanging", "without weight", "masses and springs", "2 S/L_e", "ω L_e/(2 S)",
              "h_max = 2.8/ω, ms", "by L_eff = 0.19 L_e, ms")  # fmt: skip
    return (
        "\n### Fig. 2.10: the highest axial frequency of a mesh\n\n1 m, 1 kg/m, 1000 N, pinned at the top, "
        f"{bars.GRAVITY} m/s² along it. Masses and springs: half an element's mass at the ends of the chain. Without "
        "weight ours is the textbook's cubic bar to rounding; the weight stretches the bar by up to 1 %, which by "
        "Green's strain makes it stiffer.\n\n"
        + table(header, rows)
        + "\nWhat differs: the thesis prints no figures here, and says that the ratio of the curves verifies Table "
        f"2.1. It does for one element alone, {alone:.2f} = 1/{1.0 / alone:.3f}. In a mesh of two and more it is "
        f"{min(others):.2f} to {max(others):.2f}, L_eff = {1.0 / min(others):.2f} L_e, because the neighbour of the "
        f"end element resists with its slope as well; so the rule with {SHARE} keeps a reserve of "
        f"{100.0 * reserve[0]:.0f} % to {100.0 * reserve[-1]:.0f} % of the step. Pinned at both ends, four elements "
        f"have {pinned:.4f}: p/p 1, 1/{1.0 / one:.4f} = {one:.4f}.\n" + text
    )  # fmt: skip


@styled
def _highest_figure(ours: dict[int, float], masses: dict[int, float]) -> Figure:
    figure, plots = axes(1, 1, 7.0, 4.6, "Highest axial frequency, 1 m, 1 kg/m, EA = 1000 N")
    plot = plots[0, 0]
    n = np.array(list(ours))
    plot.plot(n, 2.0 * SOUND * n / SHARE, color=QUIET, ls="--", lw=1.0, label="$2S/L_{eff}$ with $L_{eff} = 0.19 L_e$")
    plot.plot(n, list(ours.values()), color=COLOURS[0], marker="o", ms=4, label="cubic ALE-ANCF elements")
    plot.plot(n, list(masses.values()), color=COLOURS[1], marker="s", ms=4, ls="", label="masses and springs")
    plot.plot(n, 2.0 * SOUND * n, color="black", ls=":", lw=1.2, label="$2S/L_e$, eq. 2.142")
    plot.set_xlim(0.0, n[-1] + 0.5)
    plot.set_ylim(bottom=0.0)
    plot.set_xticks(range(0, int(n[-1]) + 1, 2))
    plot.set_xlabel(label("elements", ""))
    plot.set_ylabel(label("highest angular frequency", "rad/s"))
    plot.legend(loc="upper left")
    return figure


def part(quick: bool) -> str:
    """The whole subject, in Markdown."""
    return table_2_1() + fastest_shapes(quick) + highest(quick)
