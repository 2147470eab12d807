"""The figure of ``campbell``: frequencies and multiples of the rotary speed, their crossings, and the shapes below."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillstring.modes.campbell import Campbell
from drillstring.modes.natural_modes import KINDS, Mode
from drillstring.view.campbell_summary import model_of, name_of, names_of
from drillstring.view.torque_summary import column_unit
from tautline.scene.values.units import RPM
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    Axes,
    Figure,
    axes,
    label,
    lighter,
    outline,
    sample_line,
    styled,
)

INKS = dict(zip(KINDS, (COLOURS[0], COLOURS[1], COLOURS[2]), strict=True))
PLANES: dict[str, str] = {"sideways": "--", "east-west": "--", "in space": ":", "oblique": "-."}
"""Lines of lateral modes in other planes than up and down, or any."""
MOST_SHAPES = 4
"""Shapes of a kind."""
ROOM = 0.06
"""Of the width and the height: speeds of crossings are written no closer than that."""
EDGE = 0.97
"""Part of the width up to which they are: beyond are the names of modes."""
COLUMN = 26.0
"""Width of a column of names, points."""
LIGHTEST = 0.7
"""Part of white in the last of several shapes of a kind."""
FEW = 24
"""Modes up to which those that are lateral are drawn thicker."""
APART = 0.028
"""Of the height: names closer than that run into one another."""


@styled
def campbell_figure(found: Campbell, title: str = "Campbell diagram", system: str = "si") -> Figure:
    """Draw the diagram, and below it the shapes of the lowest modes of each kind.

    Parameters
    ----------
    found : Campbell
    title : str
        Heading.
    system : str
        Units: ``si`` or ``field``.
    """
    kinds = [kind for kind in KINDS if any(mode.kind == kind for mode in found.modes)]
    figure, plots = axes(2, 1, 9.0, 9.0, title, height_ratios=[1.9, 1.0])
    _diagram(plots[0, 0], found)
    place = plots[1, 0].get_subplotspec()
    plots[1, 0].remove()
    panels = place.subgridspec(1, max(1, len(kinds)))
    for column, kind in enumerate(kinds):
        _shapes(figure.add_subplot(panels[0, column]), found, kind, system)
    handles = [sample_line(kind, color=INKS[kind]) for kind in kinds]
    handles += [
        sample_line(plane, color=INKS["lateral"], ls=look)
        for plane, look in PLANES.items()
        if any(mode.plane == plane for mode in found.modes)
    ]
    handles += [sample_line("multiple of the rotary speed", color=QUIET)]
    handles += [sample_line("critical speed, rpm", color="black", ls="", marker="o", ms=5)]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(6, len(handles)))
    return figure


def _diagram(plot: Axes, found: Campbell) -> None:
    low, high = (speed / RPM for speed in found.speeds)
    plot.set_xlim(low, high)
    plot.set_ylim(0.0, found.up_to)
    for order in found.orders:
        rate = order / 60.0
        plot.plot([low, high], [low * rate, high * rate], color=QUIET, lw=1.0, zorder=1)
        at = min(high, found.up_to / rate)
        plot.annotate(
            name_of(order), (0.96 * at, 0.96 * at * rate), ha="center", va="center", color="#606060", fontsize=9,
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none"}, zorder=5,
        )  # fmt: skip
    # Names stand to the right, those of a kind in one column.
    taken: dict[str, list[float]] = {kind: [] for kind in INKS if any(mode.kind == kind for mode in found.modes)}
    for name, mode in zip(names_of(found.modes), found.modes, strict=True):
        if mode.frequency <= 0.0:
            continue
        thick = 1.4 if mode.kind == "lateral" and len(found.modes) <= FEW else 0.8
        look: dict[str, Any] = {"color": INKS[mode.kind], "ls": PLANES.get(mode.plane, "-"), "lw": thick}
        plot.plot([low, high], [mode.frequency, mode.frequency], zorder=2, **look)
        if all(abs(f - mode.frequency) > APART * found.up_to for f in taken[mode.kind]):
            taken[mode.kind].append(mode.frequency)
            away = 4.0 + COLUMN * list(taken).index(mode.kind)
            plot.annotate(
                name, (high, mode.frequency), (away, 0), textcoords="offset points", va="center", fontsize=8,
                color=INKS[mode.kind], annotation_clip=False,
            )  # fmt: skip
    _crossings(plot, found)
    plot.set_xlabel(label("rotary speed", "rpm"))
    plot.set_ylabel(label("frequency", "Hz"))
    plot.set_title(f"model: {model_of(found)}", loc="left", fontsize=9, color="#606060")


def _crossings(plot: Axes, found: Campbell) -> None:
    """Mark all crossings, and write the speed at those that leave room for it, lateral modes first."""
    width, height = found.speeds[1] / RPM, found.up_to
    written: list[tuple[float, float]] = []
    for one in sorted(found.critical, key=lambda one: found.modes[one.mode].kind != "lateral"):
        mode = found.modes[one.mode]
        x, y = one.speed / RPM, mode.frequency
        plot.plot(x, y, marker="o", ms=4.5, color=INKS[mode.kind], mec="black", mew=0.6, ls="", zorder=4)
        if x < EDGE * width and all(abs(x - a) > ROOM * width or abs(y - b) > ROOM * height for a, b in written):
            text = plot.annotate(
                f"{x:.0f}", (x, y), (3, 3), textcoords="offset points", fontsize=8, color="black", zorder=5
            )
            outline(text)
            written.append((x, y))


def _shapes(plot: Axes, found: Campbell, kind: str, system: str) -> None:
    """Shapes of the lowest modes of a kind along the string; of lateral ones with what holds the string."""
    modes = [mode for mode in found.modes if mode.kind == kind][:MOST_SHAPES]
    length, unit = column_unit("m", found.bottom, system)
    for number, (name, mode) in enumerate(zip(names_of(modes), modes, strict=True)):
        ink = lighter(INKS[kind], LIGHTEST * number / (MOST_SHAPES - 1))
        plot.plot(mode.depth / length, _seen(mode), color=ink, ls=PLANES.get(mode.plane, "-"), label=_named(mode, name))
    plot.axhline(0.0, color="black", lw=0.8)
    if kind == "lateral":
        at = np.array([0.5 * (one.top + one.bottom) for one in found.supports]) / length
        for one in found.supports:
            ends = np.array([one.top, one.bottom]) / length
            plot.plot(ends, [0.0, 0.0], color="black", lw=4.0, solid_capstyle="butt", zorder=4)
        plot.plot(at, np.zeros(at.size), ls="", marker="^", ms=7, color="black", clip_on=False, zorder=5)
    plot.set_title(f"{kind} modes", fontsize=10)
    plot.set_xlabel(label("measured depth", unit))
    plot.set_ylim(-1.15, 1.15)
    plot.set_yticks([])
    plot.locator_params(axis="x", nbins=5)
    plot.legend(loc="upper left", bbox_to_anchor=(0.0, -0.28), ncols=2, fontsize=8, borderaxespad=0.0)


def _seen(mode: Mode) -> np.ndarray:
    """Motion in the plane in which a mode moves most."""
    return mode.shape[:, int(np.abs(mode.shape).max(axis=0).argmax())]


def _named(mode: Mode, name: str) -> str:
    return f"{name}, {'unstable' if mode.frequency <= 0.0 else f'{mode.frequency:.3g} Hz'}"
