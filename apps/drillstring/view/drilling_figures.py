"""Figures of a bit on bottom: speeds, torques, weight and rate of penetration against time, and the phase portrait."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from drillstring.results.drilling import last_part, stick_slip
from tautline.results.result import Result
from tautline.scene.values.units import RPM
from tautline.view.figures.comparison import NothingToShow, marker, names, over_time, title
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    Axes,
    Figure,
    axes,
    colour,
    label,
    legend_above,
    scale,
    shade,
    styled,
    widen,
)

STUCK = 1e-3
"""Rotary speed of a bit, rad/s, below which it is shaded as stuck."""


def _require_bit(results: Sequence[Result]) -> None:
    for result in results:
        if "weight_on_bit" not in result:
            raise NothingToShow(result, "no bit on the bottom")


@styled
def drilling(results: Sequence[Result]) -> Figure:
    """Rotary speed of bit and drive, torque on bit and at the surface, weight on bit, rate of penetration."""
    _require_bit(results)
    drills = any(np.any(result["rate_of_penetration"] != 0.0) for result in results)
    rows = 4 if drills else 3
    figure, plots = axes(rows, 1, 8.6, 2.1 * rows + 0.5, title(results), sharex=True)
    speed, moment, weight = plots[0, 0], plots[1, 0], plots[2, 0]
    torque_by, torque_unit = scale([result["surface_torque"] for result in results], "N m")
    force_by, force_unit = scale([result["weight_on_bit"] for result in results], "N")
    called = names(results)
    alone = len(results) == 1
    shown: dict[Axes, list[np.ndarray]] = {plot: [] for plot in plots[:, 0]}
    for number, result in enumerate(results):
        look = {"color": colour(number, len(results)), "lw": 1.1} | marker(result.time)
        time, spin = result.time, result["rotation_rate"] / RPM
        if alone:
            top = look | {"color": QUIET}
            speed.plot(time, spin[:, 0], label="drive", **top)
            moment.plot(time, result["surface_torque"] / torque_by, label="surface", **top)
        curves = {speed: spin[:, -1], moment: result["torque_on_bit"] / torque_by}
        curves[weight] = result["weight_on_bit"] / force_by
        if drills:
            curves[plots[3, 0]] = 3600.0 * result["rate_of_penetration"]
        for plot, values in curves.items():
            plot.plot(time, values, label=("bit" if alone else called[number]), **look)
            shown[plot].append(values)
    if alone:
        stuck = np.abs(results[0]["rotation_rate"][:, -1]) < STUCK
        for plot in plots[:, 0]:
            shade(plot, results[0].time, stuck, text="bit stuck" if plot is speed else "")
    speed.set_ylabel(label("rotary speed", "rpm"))
    moment.set_ylabel(label("torque", torque_unit))
    weight.set_ylabel(label("weight on bit", force_unit))
    if drills:
        plots[3, 0].set_ylabel(label("penetration", "m/h"))
    for plot, least in zip(plots[:, 0], (0.1, 1.0 / torque_by, 1e3 / force_by, 0.1), strict=False):
        widen(plot, np.concatenate(shown[plot]), least)
    legend_above(speed)
    return over_time(figure, plots, [result.time for result in results])


@styled
def phase(results: Sequence[Result]) -> Figure:
    """Rotary speed of the bit against the twist of the string: the last half of the run drawn, what was before faint.

    Stick-slip is a loop with a straight foot, where the bit stands and the string is wound up; steady turning a point.
    """
    _require_bit(results)
    figure, plots = axes(1, 1, 6.4, 5.2, title(results))
    plot = plots[0, 0]
    called = names(results)
    shown = []
    for number, result in enumerate(results):
        if len(result.time) < 2:
            raise NothingToShow(result, "one frame: nothing changes in it")
        ink = colour(number, len(results))
        twist = (result["rotation"][:, 0] - result["rotation"][:, -1]) / (2.0 * pi)
        spin = result["rotation_rate"][:, -1] / RPM
        last = last_part(result.time)
        first = "before" if len(results) == 1 else None
        plot.plot(twist, spin, color=QUIET if len(results) == 1 else ink, lw=0.6, alpha=0.5, label=first)
        severity = stick_slip(result.time, result["rotation_rate"][:, -1])["severity"]
        told = f"severity {severity:.2f}" if np.isfinite(severity) else "the bit rocks: no severity"
        words = "last half" if len(results) == 1 else called[number]
        plot.plot(twist[last], spin[last], color=ink, lw=1.3, label=f"{words}, {told}")
        plot.plot(
            twist[-1],
            spin[-1],
            color=COLOURS[1] if len(results) == 1 else ink,
            marker="o",
            ms=5,
            ls="",
            label="end" if number == 0 else None,
        )
        shown.append(spin)
    plot.axhline(0.0, color="black", lw=0.8)
    plot.set_xlabel(label("twist of the string", "turns"))
    plot.set_ylabel(label("rotary speed of the bit", "rpm"))
    widen(plot, np.concatenate(shown), 0.1)
    figure.legend(*plot.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
