"""Figures 2.37 and 2.39 to 2.41 of the thesis, drawn again: the string at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks import jwell
from benchmarks.thesis.strings.rod import CASES, LENGTH, PIPE, Curve, linear
from tautline.view.figures.figure import COLOURS, QUIET, Axes, axes, label, save, styled

IMAGES = jwell.ROOT / "docs" / "images" / "thesis"
LEAST = 1e-7
"""Distance, m, below which a logarithmic axis shows nothing."""
LOOKS = (
    {"color": COLOURS[4], "marker": "o", "ms": 7.0, "mfc": "none", "ls": "none"},
    {"color": COLOURS[1], "marker": "o", "ms": 3.2, "ls": "none"},
    {"color": COLOURS[2], "marker": "s", "ms": 6.0, "mfc": "none", "ls": "--"},
    {"color": COLOURS[0], "marker": "", "ls": "-"},
    {"color": COLOURS[3], "marker": "", "ls": ":"},
)
"""10 and 20 lumps, long and short elements, and short ones with what makes them better."""


class Form(NamedTuple):
    """A model's answer: its name, its curve, which of that are nodes, how far each point is from the exact one, m."""

    name: str
    curve: Curve
    nodes: np.ndarray
    distance: np.ndarray


class Hung(NamedTuple):
    """A model of the hanging string: name, unstretched places of its nodes, how far these go down, the error, m."""

    name: str
    s: np.ndarray
    down: np.ndarray
    error: np.ndarray


@styled
def hanging(exact: tuple[np.ndarray, np.ndarray], hung: Sequence[Hung], whole: Sequence[Hung]) -> None:
    """Fig. 2.37: how far the nodes of the hanging string go down, and what that is off."""
    figure, plots = axes(1, 2, 9.5, 5.4, "Fig. 2.37: the string hangs in its weight", sharey=True)
    left, right = plots[0]
    left.plot(100 * exact[1], exact[0], color="black", lw=1.0, label="closed form")
    for number, one in enumerate(whole):
        style = {"color": QUIET, "lw": 0.9, "ls": (":", "-.", "--")[number % 3], "label": one.name}
        left.plot(100 * one.down, one.s, **style)
    marks = (("o", 10.0), ("x", 5.0), ("s", 7.0), (".", 5.0), ("D", 6.0))
    for number, one in enumerate(hung):
        marker, size = marks[number]
        look = {"color": COLOURS[number], "mfc": "none", "ls": "none", "marker": marker, "ms": size, "label": one.name}
        left.plot(100 * one.down, one.s, **look)
        right.plot(1000 * one.error, one.s, **(look | {"ls": "-", "lw": 0.8, "label": ""}))
    left.set_ylabel(label("unstretched distance from the top", "m"))
    left.set_xlabel(label("displacement downwards", "cm"))
    right.set_xlabel(label("displacement less the closed form", "mm"))
    left.set_xlim(left=0.0)
    left.set_ylim(LENGTH + 20.0, -20.0)
    for plot in (left, right):
        plot.axhline(PIPE.length, color=QUIET, lw=0.8, zorder=0)
    right.text(-4.4, PIPE.length - 8.0, "pipe above, collar below", color="#606060", fontsize=8, va="bottom")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    IMAGES.mkdir(parents=True, exist_ok=True)
    save(figure, IMAGES / "fig_2_37.png")


@styled
def level(name: str, number: int, exact: Curve, forms: Sequence[Form], with_linear: bool) -> None:
    """Figs 2.39 to 2.41: a configuration's shape, and below how far each model is from the exact rod."""
    gravity, force = CASES[name]
    true_scale = abs(exact.sag) > 100.0
    pull = f", pulled by {force / 1e3:.0f} kN" if force else ""
    title = f"Fig. 2.{number}: configuration {name}, gravity {gravity:g} m/s²{pull}"
    figure, plots = axes(2, 1, 8.5, 7.2, title, height_ratios=[1.15, 1.0])
    shape, off = plots[:, 0]
    shape.plot(exact.x, exact.y, color="black", lw=3.0, alpha=0.25, label="exact extensible rod")
    if with_linear:
        beam = linear(name)
        shape.plot(beam.x, beam.y, color=QUIET, lw=1.1, ls="-.", label="linear beam")
    for form, look in zip(forms, LOOKS, strict=False):
        shape.plot(form.curve.x, form.curve.y, markevery=list(form.nodes), label=form.name, **look)
        seen = form.distance > LEAST
        shown = np.where(seen, form.distance, np.nan)
        marked = look | {"ls": "-" if look["ls"] == "none" else look["ls"], "lw": 1.0}
        off.plot(form.curve.s, shown, markevery=[i for i in form.nodes if seen[i]], **marked)
    _label_shape(shape, true_scale, exact)
    off.set_yscale("log")
    off.set_xlabel(label("unstretched distance from the pin", "m"))
    off.set_ylabel(label("distance from the exact rod", "m"))
    off.set_xlim(-15.0, LENGTH + 15.0)
    figure.legend(*shape.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    IMAGES.mkdir(parents=True, exist_ok=True)
    save(figure, IMAGES / f"fig_2_{number}.png")


def _label_shape(plot: Axes, true_scale: bool, exact: Curve) -> None:
    """Write what the axes are; a sag of metres over a kilometre is drawn larger than it is, and says so."""
    plot.set_xlabel(label("x", "m"))
    plot.set_ylabel(label("y", "m"))
    if true_scale:
        plot.set_aspect("equal", adjustable="datalim")
        words = "true scale"
    else:
        plot.set_xlim(-15.0, LENGTH + 15.0)
        plot.set_ylim(1.18 * exact.sag, -0.08 * exact.sag)
        words = "heights enlarged"
    plot.text(0.99, 0.03, words, transform=plot.transAxes, ha="right", color="#606060", fontsize=9)
