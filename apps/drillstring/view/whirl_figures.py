"""The figure of whirl: the orbit of one lump, how fast it goes around, how wide, and with which frequencies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillstring.results.places import depth_said, part_of
from drillstring.results.whirl import Whirl, busiest, goes_around, turns, whirl_of
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, title
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, equal_scale, label, sample_line, styled
from tautline.view.figures.orbit import bar_beside, draw_amplitudes, draw_path
from tautline.view.figures.spectrum import full_spectra

LEAST_MOTION = 1e-7
"""Motion across the hole below which there is no whirl to show, m."""
LETTERS = 26
"""In a line of the label of the bar of spectra."""
FAINT = 4e-3
"""Share of the largest amplitude below which spectra are blank."""
SEEN = 0.02
"""Share of the largest amplitude that frequencies must have to be within the picture."""
NEAR = 0.3
"""Share of the rate of rolling from which on a whirl is near to it."""
HERTZ = 2.0 * np.pi


def lump_of(result: Result, name: str) -> int:
    """Number of the lump that a name after a colon means: a number, or ``bit``; raises ResultError."""
    last = result["lateral_displacement"].shape[1] - 1
    if name.strip() == "bit":
        return last
    if name.strip().isascii() and name.strip().isdigit() and int(name) <= last:
        return int(name)
    raise ResultError("--what", f"there is no {part_of(result)} '{name}'", f"name one from 0 to {last}, or bit")


@styled
def whirl(results: Sequence[Result], name: str = "") -> Figure:
    """Orbit, whirl rate, offset and spectra of the lump that moves most, or of the one that is named."""
    (result,) = results
    if not {"lateral_displacement", "rotation_rate", "velocity"} <= result.variables.keys() or len(result.time) < 2:
        raise NothingToShow(result, "no history of motion across the hole")
    lump, part = lump_of(result, name) if name else busiest(result), part_of(result)
    if not turns(result):
        raise NothingToShow(result, "a string that does not turn: there is no whirl")
    if not name and not goes_around(result, lump):
        cause = f"no whirl: {part} {lump} moves most, and does not go around the hole"
        raise NothingToShow(result, cause, f"ask for whirl:{lump} to see it all the same")
    one = whirl_of(result, lump)
    if np.ptp(result["lateral_displacement"][:, lump], axis=0).max() < LEAST_MOTION:
        raise NothingToShow(result, f"no motion of {part} {lump} across the hole")
    words = "the bit" if lump == result["lateral_displacement"].shape[1] - 1 else f"{part} {lump}"
    heading = title(results, f"whirl of {words}")
    figure, plots = axes(2, 2, 10.5, 8.2, heading, width_ratios=[1.0, 1.35], height_ratios=[1.2, 1.0])
    ratio = one.ratio()
    _orbit(figure, plots[0, 0], one)
    # Here, and not in the heading: what a scene calls itself is not put into other units.
    plots[0, 0].set_title(f"{words}, {depth_said(one.depth)}", fontsize=10)
    _rate(plots[0, 1], one, ratio)
    _offset(plots[1, 0], one)
    _spectra(figure, plots[1, 1], one)
    handles = [sample_line("whirl", color=COLOURS[0])]
    handles += [sample_line("rotary speed: forward whirl", color=COLOURS[2], ls="--")]
    if one.rolling is not None:
        handles += [sample_line("rolling backward on the wall", color=COLOURS[1], ls="--")]
        handles += [sample_line("wall", color="black")]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _orbit(figure: Figure, plot: Axes, one: Whirl) -> None:
    """The path across the hole, from dark to bright as time goes on, inside the circle that the wall leaves."""
    east, north = 1e3 * one.offset.imag, 1e3 * one.offset.real
    across, up = east, north
    if one.clearance is not None:
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        plot.plot(1e3 * one.clearance * np.cos(turn), 1e3 * one.clearance * np.sin(turn), color="black", lw=1.0)
        across, up = (np.r_[values, -1e3 * one.clearance, 1e3 * one.clearance] for values in (east, north))
    path = draw_path(plot, one.time, east, north)
    equal_scale(plot, across, up, 1e-3)
    plot.set_xlabel(label("offset along m2", "mm"))
    plot.set_ylabel(label("offset along m1", "mm"))
    bar_beside(figure, plot, path, label("time", "s"))


def _rate(plot: Axes, one: Whirl, ratio: float) -> None:
    """Whirl rate against time, beside that of forward whirl and that of rolling."""
    rate = one.rate() / HERTZ
    plot.plot(one.time, rate, color=COLOURS[0], lw=1.0)
    plot.plot(one.time, one.spin / HERTZ, color=COLOURS[2], ls="--", lw=1.0)
    low, high = np.nanmin(rate, initial=0.0), np.nanmax(rate, initial=0.0)
    if one.rolling is not None:
        # Where nothing comes near the line of rolling, it would flatten all the rest.
        rolls = one.spin * one.rolling / HERTZ
        plot.plot(one.time, rolls, color=COLOURS[1], ls="--", lw=1.0)
        backward = np.nanmax(np.where(rolls != 0.0, rate / np.where(rolls != 0.0, rolls, 1.0), 0.0), initial=0.0)
        if backward < NEAR:
            margin = 0.1 * max(high - low, 2.0 * float(np.abs(one.spin).max()) / HERTZ)
            plot.set_ylim(low - margin, high + margin)
    plot.axhline(0.0, color="black", lw=0.8)
    plot.set_xlim(one.time[0], one.time[-1])
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label("whirl rate, clockwise", "Hz"))
    if np.isfinite(ratio):
        plot.set_title(f"mean whirl ratio, last {one.span}: {round(ratio, 2) + 0.0:+.2f}", fontsize=10)


def _offset(plot: Axes, one: Whirl) -> None:
    """Distance from the hole's axis against time."""
    plot.plot(one.time, 1e3 * np.abs(one.offset), color=COLOURS[0], lw=1.0)
    if one.clearance is not None:
        plot.axhline(1e3 * one.clearance, color="black", lw=1.0)
    plot.set_ylim(0.0, 1.1e3 * max(float(np.abs(one.offset).max()), one.clearance or 0.0))
    plot.set_xlim(one.time[0], one.time[-1])
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label("offset from the axis", "mm"))


def _spectra(figure: Figure, plot: Axes, one: Whirl) -> None:
    """Amplitudes of circular motion, forward above and backward below, against time."""
    middle, frequency, amplitude = full_spectra(one.time, one.offset)
    if not middle.size:
        plot.text(
            0.5, 0.5, "too few frames for spectra", ha="center", va="center", transform=plot.transAxes, color=QUIET
        )
        plot.set_axis_off()
        return
    largest = float(amplitude.max()) or 1.0
    shown = np.where(amplitude > FAINT * largest, 1e3 * amplitude, np.nan)
    image = draw_amplitudes(plot, middle, frequency, shown)
    plot.plot(one.time, one.spin / HERTZ, color=COLOURS[2], ls="--", lw=1.0)
    strong = np.abs(frequency)[(amplitude > SEEN * largest).any(axis=1)]
    reach = 1.3 * max(float(strong.max()), float(np.abs(one.spin).max()) / HERTZ)
    if one.rolling is not None:
        plot.plot(one.time, one.spin * one.rolling / HERTZ, color=COLOURS[1], ls="--", lw=1.0)
    reach = min(reach, float(frequency[-1]))
    plot.set_ylim(-reach, reach)
    plot.set_xlim(one.time[0], one.time[-1])
    plot.axhline(0.0, color="black", lw=0.8)
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label("frequency, clockwise", "Hz"))
    bar_beside(figure, plot, image, label(f"amplitude; white: below {FAINT:.2g} of the largest", "mm", LETTERS))
