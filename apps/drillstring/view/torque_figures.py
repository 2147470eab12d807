"""Figures of ``torque-drag``: the broomstick, and what happens along the string at the deepest of the depths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drillstring.statics.back_calculation import Measured
from drillstring.statics.statics import Profile
from drillstring.statics.torque_drag import Case, Point
from drillstring.view.torque_summary import column_unit
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, colour, label, sample_line, styled

LOOKS: dict[str, dict[str, Any]] = {
    "pick_up": {"ls": "-"}, "slack_off": {"ls": "--"}, "rotating": {"ls": ":"},
    "reaming_up": {"ls": "-", "lw": 0.8}, "reaming_down": {"ls": "--", "lw": 0.8},
}  # fmt: skip
"""Lines of each motion."""
NAMES = {
    "pick_up": "pick up", "slack_off": "slack off", "rotating": "rotating off bottom",
    "reaming_up": "reaming up", "reaming_down": "reaming down",
}  # fmt: skip
SINE, HELIX = COLOURS[4], COLOURS[3]
SHOWN_BEYOND = 1.3
"""Limits are drawn as far as so many times the largest force of the string."""
ROUNDING = 1.0e-8
"""Share of the string's weight per length below which a side force is rounding of a string that touches nothing."""


@styled
def torque_drag_figure(
    cases: Sequence[Case], title: str = "Torque and drag", system: str = "si", measured: Measured | None = None
) -> Figure:
    """Tension with buckling limits, side force and torque along the string; above them the broomstick.

    Parameters
    ----------
    cases : sequence of Case
        One to a model and a friction factor, each a colour; directions are told apart by the lines.
    title : str
        Heading.
    system : str
        Units: ``si`` or ``field``.
    measured : Measured, optional
        Hook loads to mark in the broomstick, which is drawn where there are several depths.
    """
    several = len(cases[0].points) > 1
    rows = 2 if several else 1
    figure, plots = axes(rows, 3, 11.0, 4.9 * rows + 0.9, title, sharey="row")
    if several:
        _broomstick(plots[0], cases, system, measured)
    deepest = [max(case.points, key=lambda point: point.depth) for case in cases]
    beyond = _profiles(plots[-1], deepest, system, several)
    beside = len({case.model for case in cases}) > 1
    handles = [
        sample_line(f"friction {case.friction:.3g}" + beside * f", {case.model}", color=colour(k, len(cases)))
        for k, case in enumerate(cases)
    ]
    handles += [sample_line(NAMES[motion], color=QUIET, **LOOKS[motion]) for motion in cases[0].motions]
    for words, ink, where in zip(("buckles into a sine", "buckles into a helix"), (SINE, HELIX), beyond, strict=True):
        handles += [sample_line(words + where, color=ink, lw=3, alpha=0.6)]
    handles += [sample_line(words, ls="") for case in cases for words in _not_drawn(case)]
    if measured is not None:
        handles += [sample_line("measured", color="black", ls="", marker="o", mfc="white")]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _not_drawn(case: Case) -> list[str]:
    """Which motions of a case have no curve, or gaps in theirs, and why."""
    told = []
    for motion in case.motions:
        missing = [point for point in case.points if motion not in point.profiles]
        if missing:
            why = "locks up" if any(motion in point.locks for point in missing) else "no equilibrium"
            where = f" at {len(missing)} of {len(case.points)} depths" if len(case.points) > 1 else ""
            told.append(f"no {NAMES[motion]} at friction {case.friction:.3g}: {why}{where}")
    return told


def _broomstick(plots: Sequence[Axes], cases: Sequence[Case], system: str, measured: Measured | None) -> None:
    """Hook loads, torque, and drag against the depth of the bit."""
    motions = cases[0].motions
    hook = np.concatenate([case.hook_loads(motion) for case in cases for motion in motions])
    force, newton = column_unit("N", _largest(hook), system)
    moment, metre = column_unit("N m", _largest(np.concatenate([case.torques for case in cases])), system)
    length, name = column_unit("m", max(point.depth for point in cases[0].points), system)
    for k, case in enumerate(cases):
        depth, ink = np.array([point.depth for point in case.points]) / length, colour(k, len(cases))
        for motion in motions:
            loads = case.hook_loads(motion)
            plots[0].plot(loads / force, depth, color=ink, marker="o", ms=2.5, **LOOKS[motion])
            if motion != "rotating":
                drag = (loads - case.hook_loads("rotating")) / force
                plots[2].plot(drag, depth, color=ink, marker="o", ms=2.5, **LOOKS[motion])
        for motion in motions[2:]:
            plots[1].plot(case.torques_of(motion) / moment, depth, color=ink, marker="o", ms=2.5, **LOOKS[motion])
    if measured is not None:
        for loads in (measured.pick_up, measured.slack_off):
            plots[0].plot(loads / force, measured.depth / length, "o", color="black", mfc="white", ms=5)
    for plot, text, unit in zip(
        plots, ("hook load", "surface torque", "drag: hook load less rotating"), (newton, metre, newton), strict=True
    ):
        plot.set_xlabel(label(text, unit))
    plots[2].axvline(0.0, color="black", lw=0.8)
    plots[0].set_ylabel(label("measured depth of the bit", name))
    _downwards(plots[0], max(point.depth for point in cases[0].points) / length)


def _profiles(plots: Sequence[Axes], points: Sequence[Point], system: str, several: bool) -> list[str]:
    """Tension and the limits, side force and torque along the string with the bit at one depth.

    Gives what the legend adds to each of the limits: whether it lies beyond the axis.
    """
    tension = np.concatenate([one.tension for point in points for one in point.profiles.values()] or [np.zeros(1)])
    twist = np.concatenate([one.torque for point in points for one in point.profiles.values()] or [np.zeros(1)])
    sides = [[_without_rounding(one, point.depth) for one in point.profiles.values()] for point in points]
    side = np.concatenate([one for of_point in sides for one in of_point] or [np.zeros(1)])
    force, newton = column_unit("N", _largest(tension), system)
    moment, metre = column_unit("N m", _largest(twist), system)
    load, per_metre = column_unit("N/m", _largest(side), system)
    length, name = column_unit("m", points[0].depth, system)
    for k, point in enumerate(points):
        ink, stations = colour(k, len(points)), point.stations
        for (motion, one), pressed in zip(point.profiles.items(), sides[k], strict=True):
            # From the hook to the bit: a link's middle is not where a string is pulled or pushed most.
            pulled = -stations.compression(one.hook_load, one.tension).ravel()
            plots[0].plot(pulled / force, stations.measured_depth.ravel() / length, color=ink, **LOOKS[motion])
            plots[1].plot(pressed / load, one.measured_depth / length, color=ink, **LOOKS[motion])
            if motion not in ("pick_up", "slack_off"):
                plots[2].plot(one.torque / moment, one.link_depth / length, color=ink, **LOOKS[motion])
    for plot, values in ((plots[1], side), (plots[2], twist)):
        if _largest(values) == 0.0:
            # A string that touches nothing: its line stands off the edge.
            plot.set_xlim(-0.05, 1.0)
    plots[0].axvline(0.0, color="black", lw=0.8)
    beyond = _limits(plots[0], points[0], SHOWN_BEYOND * max(_largest(tension), 1.0), force, length)
    where = f", bit at {points[0].depth / length:.0f} {name}" if several else ""
    plots[0].set_xlabel(label("effective tension" + where, newton))
    plots[1].set_xlabel(label("side force", per_metre))
    plots[2].set_xlabel(label("torque, of the string that turns", metre))
    plots[0].set_ylabel(label("measured depth", name))
    _downwards(plots[0], points[0].depth / length)
    return beyond


def _limits(plot: Axes, point: Point, reach: float, force: float, length: float) -> list[str]:
    """Draw the buckling limits; the axis holds those up to a compression, N, and the lines go on to its edge.

    Gives what the legend adds to each: whether it lies beyond the axis, for a line that ends looks like no limit.
    """
    depth, limits = point.stations.measured_depth.ravel() / length, point.stations.limits
    loads = [np.where(np.isfinite(one), -one / force, np.nan).ravel() for one in (limits.sinusoidal, limits.helical)]
    look: dict[str, Any] = {"lw": 3, "alpha": 0.6, "zorder": 1}
    lines = [
        plot.plot(np.where(one >= -reach / force, one, np.nan), depth, color=ink, **look)[0]
        for one, ink in zip(loads, (SINE, HELIX), strict=True)
    ]
    edge, right = plot.get_xlim()
    plot.set_xlim(edge, right)
    for line, one in zip(lines, loads, strict=True):
        line.set_xdata(one)
    outside = [one[~np.isnan(one)] < edge for one in loads]
    return [
        "" if not one.any() else ", beyond the axis" if one.all() else ", in part beyond the axis" for one in outside
    ]


def _without_rounding(profile: Profile, depth: float) -> np.ndarray:
    """Side forces of a profile, N/m: zero where all are rounding beside the weight of a string of a depth, m."""
    side = profile.side_force
    return side if _largest(side) > ROUNDING * _largest(profile.tension) / depth else np.zeros_like(side)


def _largest(values: np.ndarray) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max(initial=0.0))


def _downwards(plot: Axes, depth: float) -> None:
    plot.set_ylim(1.03 * depth, -0.01 * depth)
