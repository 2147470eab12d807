"""The house style of figures: size, type, colours that everyone can tell apart, units at every axis.

Figures are made without pyplot, so they need no display and no backend: saving one chooses what its format wants.
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import chain
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes as Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize, to_rgb
from matplotlib.figure import Figure as Page
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.text import Text
from matplotlib.ticker import (
    AutoLocator,
    FuncFormatter,
    LogFormatter,
    LogFormatterSciNotation,
    MaxNLocator,
    ScalarFormatter,
)

from tautline.results.errors import ResultError, naming_written, unwritten
from tautline.results.output_path import check_drawn
from tautline.scene.values.systems import SYSTEMS, in_system
from tautline.view.figures.missing_letters import missing_letters_told
from tautline.whole_file import legible, whole_file

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe and Ito's colours (jfly.uni-koeln.de/color), told apart by colour-blind readers; yellow is left out."""

STYLES = ("-", "--", ":", "-.")
"""Lines of the first thing, the second and so on, where colours tell something else apart."""

QUIET = "#9A9A9A"
SHADE = "#EDEDED"

SHADES = LinearSegmentedColormap.from_list("time", matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 64)))
"""Colours of times and speeds, of a share from 0 to 1, without the yellow that is lost on paper."""

BOTH_WAYS = LinearSegmentedColormap.from_list("both ways", ("#00517F", COLOURS[0], "#F5F5F5", COLOURS[1], "#8A3D00"))
"""Colours of what has either sign: white is zero."""

STYLE: dict[Any, Any] = {
    "figure.dpi": 100,
    "savefig.dpi": 160,
    "font.size": 10,
    "axes.labelsize": 10,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.8,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "axes.prop_cycle": cycler(color=COLOURS),
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}

styled = matplotlib.rc_context(STYLE)
"""Decorator of every function that draws: the style holds inside it, and a user's own settings are left alone."""

LONGEST_NAME = 40
"""Letters of a name that a legend has room for."""

LETTERS, LETTERS_OF_LEGEND = 10.5, 14.6
"""Letters of a heading and of a legend in an inch."""

LETTERS_OF_TICKS = 10.8
"""Digits of the numbers at an axis in an inch."""
ROUNDING = 1.0e-6
"""Difference, as a share of their size, by which values differ that are as good as one."""

UNIT = re.compile(r"(?<=\s)\[([^\[\]]+)\]$")
"""Unit at the end of a label."""
POWER = re.compile("1e([−-]?[0-9]+)")
"""Power of ten as matplotlib writes it at the end of an axis."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
ENOUGH = 0.05
"""Of a unit without a prefix, or with one that makes it smaller, from which on it is taken: 0.4 N, not 400 mN."""


class Figure(Page):
    """A figure unknown to pyplot: it needs no display and no closing, and notebooks show it."""

    def _repr_png_(self) -> bytes:
        """PNG of the figure, which notebooks ask for."""
        written = io.BytesIO()
        with matplotlib.rc_context(STYLE):
            with powers_in_labels(self), missing_letters_told():
                self.savefig(written, format="png", dpi=self.dpi)
        return written.getvalue()


def axes(
    rows: int = 1, columns: int = 1, width: float = 8.0, height: float = 4.5, title: str = "", **subplots: Any
) -> tuple[Figure, np.ndarray]:
    """Make a figure; call it from a function decorated with `styled`.

    Parameters
    ----------
    rows, columns : int
        Number of plots.
    width, height : float
        Size of the whole figure, inches.
    title : str
        Heading of the figure; a line of it that is too long goes on in one more, and is cut off there.
    **subplots
        Passed on to ``Figure.subplots``: ``sharex``, ``width_ratios`` and so on.

    Returns
    -------
    figure : Figure
        Unknown to pyplot: it needs no closing.
    plots : (rows, columns) array of Axes
    """
    figure = Figure(figsize=(width, height), layout="constrained")
    plots = figure.subplots(rows, columns, squeeze=False, **subplots)
    if title:
        room = max(20, int(LETTERS * width))
        lines = [
            line for part in title.splitlines() for line in textwrap.wrap(part, room, max_lines=2, placeholder=" …")
        ]
        figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=12)
    return figure, plots


def shortened(name: str, most: int = LONGEST_NAME) -> str:
    """A name of at most so many letters: its first ones, and more of its last, which more often tell names apart."""
    first = most // 3
    return name if len(name) <= most else f"{name[:first].rstrip()}…{name[first + 1 - most :].lstrip()}"


def colour(number: int, count: int) -> Any:
    """Colour of one thing among several; of more than there are colours, a shade."""
    return COLOURS[number] if count <= len(COLOURS) else SHADES(number / (count - 1))


def legend_above(plot: Axes, columns: int | None = None) -> None:
    """Put the legend above the plot, off its curves; none if nothing has a name.

    Parameters
    ----------
    columns : int, optional
        As many as the names leave room for, by default.
    """
    handles, texts = plot.get_legend_handles_labels()
    if not texts:
        return
    place = plot.get_subplotspec()
    whole = plot.get_figure(root=True)
    wide = (whole.get_figwidth() if whole is not None else 8.0) / (
        place.get_gridspec().ncols if place is not None else 1
    ) - 0.8
    most = min(columns or 6, len(texts))
    # Columns are filled from the left, and each is as wide as its longest name and its line.
    fits = (n for n in range(most, 1, -1) if sum(_widths(texts, n)) < LETTERS_OF_LEGEND * wide)
    # A power of ten of the axis stands where the legend begins.
    plot.yaxis.set_offset_position("right")
    columns = next(fits, 1)
    plot.legend(handles, texts, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2)


def _widths(texts: Sequence[str], columns: int) -> list[int]:
    """Letters that the columns of a legend take, line and gap included."""
    return [max(map(len, part)) + 9 for part in np.array_split(np.array(texts, object), columns)]


def scale(values: Sequence[np.ndarray], unit: str) -> tuple[float, str]:
    """Choose the factor to divide by and the unit to write, so that labels stay short: N -> (1e6, "MN").

    Units other than forces, moments and energies stay as they are.
    """
    if unit not in ("N", "N m", "J", "W", "Pa"):
        return 1.0, unit
    largest = max((float(np.max(np.abs(array))) for array in values if array.size), default=0.0)
    for factor, letter in PREFIXES:
        if largest >= (factor if factor > 1.0 else ENOUGH * factor):
            return factor, letter + unit
    return 1.0, unit


def scale_in(system: str, values: Sequence[np.ndarray], unit: str) -> tuple[float, str]:
    """Choose factor and unit as `scale` does; in another system those that it names."""
    if unit not in SYSTEMS[system]:
        return scale(values, unit)
    size = max((float(np.max(np.abs(array))) for array in values if array.size), default=0.0) or 1.0
    value, name = in_system(size, unit, system)
    return size / value, name


def label(text: str, unit: str, letters: int = 0) -> str:
    """Axis label: ``hook load [MN]``; in lines of so many letters at most, if that is said, ending at commas first."""
    whole = f"{text} [{unit}]" if unit else text
    if not letters:
        return whole
    # A unit such as [N m] or [kft-lbf] is one word.
    first, *others = whole.replace(f"[{unit}]", f"[{unit}]".replace(" ", "\0")).split(", ")
    lines = textwrap.wrap(first, letters, break_on_hyphens=False)
    for part in others:
        if lines and len(lines[-1]) + len(part) + 2 <= letters:
            lines[-1] += f", {part}"
        else:
            begun, lines = f"{lines.pop()}," if lines else "", lines
            lines += [*filter(None, [begun]), *textwrap.wrap(part, letters, break_on_hyphens=False)]
    return "\n".join(lines).replace("\0", " ")


def widen(plot: Axes, values: np.ndarray, least: float) -> None:
    """Keep a vertical axis from blowing rounding up: it spans at least `least`, in the axis' unit, about the values."""
    low, high = (float(np.min(values)), float(np.max(values))) if values.size else (0.0, 0.0)
    if high - low < least:
        middle = 0.5 * (low + high)
        plot.set_ylim(middle - 0.55 * least, middle + 0.55 * least)


def but_for_rounding(values: np.ndarray) -> tuple[float, float]:
    """Smallest and largest of some values; where they differ by rounding alone, one per cent below and above them."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    size = max(abs(low), abs(high))
    if high - low > ROUNDING * size:
        return low, high
    return low - 0.01 * (size or 1.0), high + 0.01 * (size or 1.0)


def flatten_rounding(plot: Axes, values: np.ndarray, along: str = "y") -> None:
    """Keep an axis from blowing up values that differ by rounding alone."""
    known = values[np.isfinite(values)]
    low, high = but_for_rounding(known)
    if known.size and low < known.min():
        getattr(plot, f"set_{along}lim")(low, high)


class RoomForLabels(AutoLocator):
    """Ticks of a horizontal axis, as few as the lengths of their labels leave room for, and two at least."""

    def tick_values(self, vmin: float, vmax: float) -> np.ndarray:
        """Round numbers from below one value to above another."""
        found = super().tick_values(vmin, vmax)
        if self.axis is None:
            return found
        letters = LETTERS_OF_TICKS * self.axis.axes.bbox.width / self.axis.axes.figure.dpi
        for most in range(len(found), 1, -1):
            found = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(vmin, vmax)
            seen = found[(found >= vmin) & (found <= vmax)]
            texts = self.axis.get_major_formatter().format_ticks(seen)
            if sum(len(text) + 2 for text in texts) <= letters or len(seen) <= 2:
                break
        return found


def shade(plot: Axes, time: np.ndarray, flags: np.ndarray, colour: str = SHADE, text: str = "") -> None:
    """Shade the times at which flags is true.

    Parameters
    ----------
    time : (n,) array
    flags : (n,) array of bool
        A frame's flag holds halfway to its neighbours.
    """
    if time.size < 2 or not flags.any():
        return
    edges = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    changes = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    for number, (first, last) in enumerate(changes.reshape(-1, 2)):
        words = text if number == 0 else "_" + text
        plot.axvspan(edges[first], edges[last], color=colour, lw=0, zorder=0, label=words)


def shades_between(low: float, high: float, by_ratio: bool = False) -> Normalize:
    """What gives values their share of `SHADES`: by their differences, or of positive ones by their ratios."""
    return LogNorm(low, high) if by_ratio else Normalize(low, high)


def bar_of_shades(
    figure: Figure, plots: Any, low: float, high: float, text: str, by_ratio: bool = False, **look: Any
) -> Colorbar:
    """Put a bar of `SHADES` below plots, from one value to another.

    Parameters
    ----------
    plots : Axes or array of Axes
        What gives it room.
    text : str
        Its label.
    by_ratio : bool
        Whether it is logarithmic.
    **look
        Passed on to ``Figure.colorbar``: ``shrink``, ``pad`` and so on.
    """
    colours = ScalarMappable(shades_between(low, high, by_ratio), SHADES)
    bar = figure.colorbar(colours, ax=plots, location="bottom", aspect=40, **look)
    bar.set_label(text)
    if not by_ratio:
        bar.locator = RoomForLabels()
    return bar


def sample_line(text: str, **look: Any) -> Line2D:
    """A line that is only in the legend."""
    return Line2D([], [], label=text, **look)


def outline(text: Text, width: float = 2.0) -> None:
    """Set letters off from the curves below them by a white edge."""
    text.set_path_effects([withStroke(linewidth=width, foreground="white")])


def lighter(ink: str, white: float) -> tuple[float, float, float]:
    """A colour mixed with some part of white, 0 to 1: red, green and blue."""
    red, green, blue = ((1.0 - white) * part + white for part in to_rgb(ink))
    return red, green, blue


def round_numbers(low: float, high: float, most: int) -> list[float]:
    """About so many round numbers from low to high, both included where they are round."""
    found = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(low, high)
    return [float(value) for value in found if low - 1e-9 <= value <= high + 1e-9]


def height_over_width(x: np.ndarray, y: np.ndarray, least: float) -> float:
    """Height over width of what `equal_scale` shows."""
    wide, high = (max(float(np.ptp(values)), least) for values in (x, y))
    return high / wide


def equal_scale(
    plot: Axes, x: np.ndarray, y: np.ndarray, least: float, larger: tuple[float, float] = (1.0, 1.0)
) -> None:
    """Show points at the same scale both ways, at least `least` each way, in their unit; or one way so often larger."""
    plot.set_aspect(larger[1] / larger[0], adjustable="box")
    for values, limit, factor in zip((x, y), (plot.set_xlim, plot.set_ylim), larger, strict=True):
        middle, size = 0.5 * (values.min() + values.max()), max(float(np.ptp(values)), least / factor)
        limit(middle - 0.55 * size, middle + 0.55 * size)
    (left, right), (bottom, top) = plot.get_xlim(), plot.get_ylim()
    shown = larger[0] * (right - left) / (larger[1] * (top - bottom))
    plot.locator_params(axis="x", nbins=int(np.clip(6.0 * shown, 2, 6)))


def thin_logarithms(figure: Figure) -> None:
    """Keep the numbers below logarithmic axes apart: between powers of ten 2 and 5 or 3, or none over many decades."""
    for plot in figure.axes:
        low, high = sorted(plot.get_xlim())
        # What has been given numbers of its own keeps them; within less than a decade matplotlib thins them itself.
        if plot.get_xscale() != "log" or not isinstance(plot.xaxis.get_minor_formatter(), LogFormatter):
            continue
        decades = np.log10(high / low)
        if decades >= 0.9:
            few = (2, 5) if decades < 1.2 else (3,) if decades < 2.1 else ()
            plot.xaxis.set_minor_formatter(FuncFormatter(lambda x, _, few=few: _power(x) if _digit(x) in few else ""))


@contextmanager
def powers_in_labels(figure: Figure) -> Iterator[None]:
    """Write the power of ten of an axis into the unit of its label: beside the axis it is taken for that of another.

    Afterwards the figure is as it was: whoever goes on with it may change the label, and the power must not go with it.
    """
    with ExitStack() as afterwards:
        for plot in figure.axes:
            for axis in (plot.xaxis, plot.yaxis):
                _power_into_label(axis, afterwards)
        yield


def _power_into_label(axis: Axis, afterwards: ExitStack) -> None:
    """Write the power of ten of one axis into its label, until `afterwards` is closed."""
    numbers, text, beside = axis.get_major_formatter(), axis.get_label_text(), axis.get_offset_text()
    # Without a unit the power stands at the end of the axis. Where it is hidden it is written already.
    hidden = not beside.get_visible()
    if hidden or not isinstance(numbers, ScalarFormatter) or not (unit := UNIT.search(text)):
        return
    # All that it knows: matplotlib does not tell the limits of its powers, and axes may share it.
    afterwards.callback(vars(numbers).update, dict(vars(numbers)))
    low, high = sorted(axis.get_view_interval())
    places = np.array(axis.get_majorticklocs())
    numbers.set_locs(places[(places >= low) & (places <= high)])
    if not (found := POWER.fullmatch(numbers.get_offset())):
        return
    power = int(found[1].replace("−", "-"))
    # The layout may move ticks, and the power is written.
    numbers.set_powerlimits((power, power))
    name = unit[1] if unit[1] != "–" else ""
    afterwards.callback(axis.set_label_text, text)
    axis.set_label_text(f"{text[: unit.start()]}[10{str(power).translate(RAISED)} {name}".rstrip() + "]")
    afterwards.callback(beside.set_visible, True)
    beside.set_visible(False)


def _digit(x: float) -> int:
    """The first digit of a number that has but one."""
    return round(float(x / 10.0 ** np.floor(np.log10(x) + 1e-9)))


def _power(x: float) -> str:
    return str(LogFormatterSciNotation(minor_thresholds=(np.inf, np.inf))(x))


def _spell(figure: Figure) -> None:
    """Write names of files that are no UTF-8 in letters that can be drawn."""
    for text in figure.findobj(Text):
        told = text.get_text()
        if not told.isascii() and legible(told) != told:
            text.set_text(legible(told))


@styled
def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure; the ending of the name says the format.

    Raises
    ------
    ResultError
        If the file cannot be written or is there and no figure, or the format is unknown; WriteError where the disk is
        full.
    """
    path = check_drawn(Path(path))
    try:
        _spell(figure)
        thin_logarithms(figure)
        with powers_in_labels(figure), missing_letters_told(), whole_file(path) as waiting:
            figure.savefig(waiting)
    except OSError as error:
        raise unwritten(path, error) from None
    except ValueError as error:
        raise ResultError(path, f"cannot be written: {error}", "use png, svg or pdf") from None
    return path


def save_all(figures: Mapping[str, Figure], folder: Path, stem: str, formats: Sequence[str], whole: bool) -> list[Path]:
    """Write figures as ``stem_name.format``, or as ``stem.format`` if there is one figure and `whole` says so.

    Raises
    ------
    ResultError
        As of `save`; it names the figures that are written by then.
    """
    bases = {name: stem if whole and len(figures) == 1 else f"{stem}_{name}" for name in figures}
    places = {name: [folder / f"{base}.{ending}" for ending in formats] for name, base in bases.items()}
    for place in chain.from_iterable(places.values()):
        check_drawn(place)
    written: list[Path] = []
    with naming_written("figures", written):
        for name, of_it in places.items():
            for place in of_it:
                written.append(save(figures[name], place))
    return written
