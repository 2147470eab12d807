"""Figures of error against run time: a colour for each mesh, full marks for RK4, open ones for generalized-alpha."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.view.figures.figure import COLOURS, QUIET, Axes, sample_line

LEAST = 1.0e-16
"""Error that is drawn for none: a logarithm needs one."""
MARKS = "osD^v"
NAMES = {"rk4": "RK4", "generalized-alpha": "generalized-α"}


def look(method: str, place: int) -> dict[str, object]:
    """How the curve of a method with the mesh at a place is drawn."""
    colour = COLOURS[place % len(COLOURS)]
    mark = {"color": colour, "marker": MARKS[place % len(MARKS)], "ms": 5.0, "lw": 1.3}
    return mark if method == "rk4" else mark | {"ls": "--", "mfc": "white"}


def curve(plot: Axes, points: Sequence[tuple[float | None, float | None]], method: str, place: int) -> None:
    """Draw errors against run times in the order given; what is lacking is left out."""
    shown = [(time, max(error, LEAST)) for time, error in points if time is not None and error is not None]
    if shown:
        plot.loglog(*np.array(shown).T, **look(method, place))


def samples(counts: Sequence[int]) -> list[object]:
    """Entries of the legend for meshes of so many elements, and for the methods."""
    found: list[object] = [
        sample_line(f"n = {n}", color=COLOURS[i], marker=MARKS[i], ms=5.0, ls="") for i, n in enumerate(counts)
    ]
    found.append(sample_line("RK4", color=QUIET, marker="o", ms=5.0))
    found.append(sample_line("generalized-α", color=QUIET, marker="o", ms=5.0, mfc="white", ls="--"))
    return found
