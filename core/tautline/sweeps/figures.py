"""Figures of a sweep: curves over one parameter, maps over two, bars of what matters, shares of variance."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautline.sweeps.indices import PARAMETER
from tautline.sweeps.plans import GRID, ONE, Cases
from tautline.sweeps.table import PERCENTILES, TIMES, Column, Variables
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    SHADES,
    axes,
    bar_of_shades,
    colour,
    label,
    save,
    scale_in,
    styled,
)

MOST_FIGURES = 6
"""Figures of one kind that are drawn; the dataset holds all."""
MOST_CURVES = 8
DEPTH = "depth"
"""Axis that is drawn downwards."""
HEIGHT, WIDTH = 3.2, 6.4
NARROW, WIDE = 26, 60
"""Letters in a line of an axis' label: keys are long."""


def draw(data: Variables, cases: Cases, folder: Path, ending: str = "png") -> list[Path]:
    """Draw what the plan has a figure for into a folder: a file for each number that was collected.

    Raises
    ------
    ResultError
        If one cannot be written.
    """
    names = [name for name, one in data.data_vars.items() if _drawn(name, one, cases)][:MOST_FIGURES]
    made: list[tuple[str, Any]] = []
    if cases.indices:
        made = [(f"{name}_indices", _indices_figure(data, name)) for name in names if f"{name}_first" in data]
    elif cases.plan.name == ONE:
        made = [(f"{name}_tornado", _tornado(data, cases, name)) for name in names]
    elif cases.plan.name == GRID and 1 <= len(_long(cases)) <= 2:
        draw_one = _lines if len(_long(cases)) == 1 or not _numeric(cases) else _map
        made = [(name, draw_one(data, cases, name)) for name in names]
    elif cases.plan.name != GRID:
        made = [(name, _scatter(data, cases, name)) for name in names]
        bands = [name for name, one in data.data_vars.items() if name.endswith(PERCENTILES) and len(one.dims) == 2]
        made += [(name, _band(data, name)) for name in bands[:MOST_FIGURES]]
    written: list[Path] = []
    for name, figure in made:
        if figure is not None:
            path = folder / f"{_slug(name)}.{ending}"
            if path in written:
                path = folder / f"{_slug(name)}_{len(written) + 1}.{ending}"
            written.append(save(figure, path))
    return written


def _drawn(name: str, one: Column, cases: Cases) -> bool:
    """Whether a variable is a number of each case."""
    return name not in TIMES and one.dims == cases.dims and one.is_number


def _long(cases: Cases) -> list[int]:
    """Dimensions with more than one value."""
    return [k for k, length in enumerate(cases.shape) if length > 1]


def _numeric(cases: Cases) -> bool:
    return all(cases.parameters[k].numeric for k in _long(cases))


def _slug(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_]+", "_", name).strip("_") or "figure"


def _scaled(data: Variables, name: str) -> tuple[np.ndarray, str]:
    """Values of a variable in the unit that keeps labels short, and the label of their axis."""
    values, unit = data[name].values, str(data[name].attrs.get("units") or "")
    factor, unit = scale_in(str(data.attrs.get("units") or "si"), [values[np.isfinite(values)]], unit)
    return values / factor, label(name.replace("_", " "), unit)


def _title(data: Variables, name: str) -> str:
    title = str(data.attrs.get("title") or "")
    return f"{title}: {name.replace('_', ' ')}" if title else name.replace("_", " ")


@styled
def _lines(data: Variables, cases: Cases, name: str) -> Any:
    """A curve over the first parameter with several values; of a second that has no numbers one for each value."""
    long = sorted(_long(cases), key=lambda k: not cases.parameters[k].numeric)
    values, text = _scaled(data, name)
    values = np.moveaxis(values.reshape(cases.shape), long, range(len(long)))
    values = values.reshape(cases.shape[long[0]], -1)[:, :MOST_CURVES]
    one = cases.parameters[long[0]]
    figure, plots = axes(1, 1, WIDTH, HEIGHT, _title(data, name))
    plot = plots[0, 0]
    places, text_of_places = _places(one, data)
    order = np.argsort(places)
    places, values = places[order], values[order]
    for k, column in enumerate(values.T):
        word = _word(cases.parameters[long[1]].values[k]) if len(long) > 1 else None
        plot.plot(places, column, "o-", ms=3.5, color=colour(k, values.shape[1]), label=word)
    _ticks(plot, one, text_of_places)
    plot.set_ylabel(text)
    if len(long) > 1:
        plot.legend(title=cases.parameters[long[1]].key)
    return figure


def _places(
    one: Any, data: Variables, letters: int = WIDE, numbers: np.ndarray | None = None
) -> tuple[np.ndarray, str]:
    """Places of a parameter's values on an axis, in the unit that keeps labels short, and the label of the axis.

    Those of cases, where their `numbers` are given.
    """
    if not one.numeric:
        return np.arange(len(one.values), dtype=float), _in_lines(one.key, "", letters)
    numbers = np.array(one.numbers, float) if numbers is None else numbers
    factor, unit = scale_in(str(data.attrs.get("units") or "si"), [numbers[np.isfinite(numbers)]], one.unit)
    return numbers / factor, _in_lines(one.key, unit, letters)


def _in_lines(key: str, unit: str, letters: int) -> str:
    """A key as the label of an axis, broken at its dots and nowhere else."""
    lines = label(key.replace(".", ". "), unit, letters).split("\n")
    return "\n".join(line.replace(". ", ".") for line in lines)


def _word(value: Any) -> str:
    return str(value)


def _ticks(plot: Any, one: Any, text: str, along: str = "x") -> None:
    """Name an axis by a parameter, and its places by the values where these are no numbers."""
    getattr(plot, f"set_{along}label")(text)
    if not one.numeric:
        getattr(plot, f"set_{along}ticks")(range(len(one.values)), [_word(value) for value in one.values])
    elif _logarithmic(np.array(one.numbers)):
        getattr(plot, f"set_{along}scale")("log")


def _logarithmic(numbers: np.ndarray) -> bool:
    """Whether numbers rise by equal ratios, and by much."""
    if numbers.size < 3 or not (numbers > 0.0).all() or numbers.max() < 10.0 * numbers.min():
        return False
    ratios = np.diff(np.log(numbers))
    return bool(np.allclose(ratios, ratios[0], rtol=1e-6))


@styled
def _map(data: Variables, cases: Cases, name: str) -> Any:
    """Colours over two parameters; cases that failed are left white."""
    from tautline.view.figures.waterfall import edges_of

    across, up = _long(cases)
    values, text = _scaled(data, name)
    values = np.moveaxis(values.reshape(cases.shape), (up, across), (0, 1)).reshape(
        cases.shape[up], cases.shape[across]
    )
    one, two = cases.parameters[across], cases.parameters[up]
    order_x, order_y = np.argsort(one.numbers), np.argsort(two.numbers)
    figure, plots = axes(1, 1, WIDTH, HEIGHT + 0.8, _title(data, name))
    plot = plots[0, 0]
    (x, text_x), (y, text_y) = _places(one, data), _places(two, data, NARROW)
    x, y = x[order_x], y[order_y]
    shown = np.ma.masked_invalid(values[np.ix_(order_y, order_x)])
    low, high = float(shown.min()), float(shown.max())
    if low == high:
        # One colour for all, at the middle of a bar that is as wide as the number is large.
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    # Where an axis is logarithmic, halfway between two values is so by their ratio.
    x_edges, y_edges = (
        np.exp(edges_of(np.log(at))) if each.numeric and _logarithmic(np.array(each.numbers)) else edges_of(at)
        for at, each in ((x, one), (y, two))
    )
    plot.pcolormesh(x_edges, y_edges, shown, cmap=SHADES, vmin=low, vmax=high)
    plot.grid(False)
    _ticks(plot, one, text_x)
    _ticks(plot, two, text_y, "y")
    bar_of_shades(figure, plot, low, high, text)
    return figure


@styled
def _tornado(data: Variables, cases: Cases, name: str) -> Any:
    """How far each parameter alone moves a number from that of the scene, the largest on top."""
    values, text = _scaled(data, name)
    if not np.isfinite(values[0]):
        return None
    spans = []
    for one in cases.parameters:
        of_it = np.array([value is not None for value in cases.values[one.key]])
        moved = values[of_it]
        if np.isfinite(moved).any():
            spans.append((one, float(np.nanmin(moved)), float(np.nanmax(moved)), moved, cases.numbers[one.key][of_it]))
    if not spans:
        return None
    spans.sort(key=lambda span: max(span[2], values[0]) - min(span[1], values[0]))
    figure, plots = axes(1, 1, WIDTH + 1.0, 1.4 + 0.42 * len(spans), _title(data, name))
    plot = plots[0, 0]
    for place, (_, _, _, moved, numbers) in enumerate(spans):
        middle = np.mean(numbers) if np.isfinite(numbers).all() else np.inf
        for value, number in zip(moved, numbers, strict=True):
            if np.isfinite(value):
                above = not number < middle
                plot.barh(place, value - values[0], left=values[0], color=COLOURS[1 if above else 0], height=0.6)
    plot.axvline(values[0], color=QUIET, lw=1.0)
    plot.set_yticks(range(len(spans)), [span[0].key for span in spans])
    plot.grid(axis="y", visible=False)
    plot.set_xlabel(text)
    _legend_of_ends(plot, values[0])
    return figure


def _legend_of_ends(plot: Any, at: float) -> None:
    """Say what the colours are, by bars of no length."""
    for k, text in enumerate(("smaller value", "larger value")):
        plot.barh(0, 0.0, left=at, color=COLOURS[k], label=text)
    plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)


@styled
def _scatter(data: Variables, cases: Cases, name: str) -> Any:
    """A number against each parameter in turn."""
    numeric = [one for one in cases.parameters if one.numeric][:4]
    if not numeric:
        return None
    values, text = _scaled(data, name)
    figure, plots = axes(1, len(numeric), 1.0 + 2.9 * len(numeric), HEIGHT, _title(data, name), sharey=True)
    for plot, one in zip(plots[0], numeric, strict=True):
        places, text_of_places = _places(one, data, NARROW, cases.numbers[one.key])
        plot.plot(places, values, ".", ms=4)
        plot.set_xlabel(text_of_places)
    plots[0, 0].set_ylabel(text)
    return figure


@styled
def _band(data: Variables, name: str) -> Any:
    """Percentiles of a number along its axis: against depth as drillers draw it, else from left to right."""
    along = data[name].dims[1]
    values, text = _scaled(data, name)
    places = data[along].values if along in data.coords else np.arange(values.shape[1])
    unit = str(data[along].attrs.get("units") or "") if along in data.coords else ""
    factor, unit = scale_in(str(data.attrs.get("units") or "si"), [places], unit)
    downwards, places = along == DEPTH, places / factor
    figure, plots = axes(1, 1, WIDTH, HEIGHT + (1.2 if downwards else 0.0), _title(data, name))
    plot, (low, middle, high) = plots[0, 0], values
    if downwards:
        plot.fill_betweenx(places, low, high, color=COLOURS[0], alpha=0.25, lw=0, label="P10 to P90")
        plot.plot(middle, places, color=COLOURS[0], label="P50")
        plot.invert_yaxis()
        plot.set_xlabel(text)
        plot.set_ylabel(label("measured depth", unit))
    else:
        plot.fill_between(places, low, high, color=COLOURS[0], alpha=0.25, lw=0, label="P10 to P90")
        plot.plot(places, middle, color=COLOURS[0], label="P50")
        plot.set_xlabel(label(along, unit))
        plot.set_ylabel(text)
    plot.legend()
    return figure


@styled
def _indices_figure(data: Variables, name: str) -> Any:
    """First-order and total indices, with their intervals."""
    keys: Sequence[str] = [str(key) for key in data[PARAMETER].values]
    figure, plots = axes(1, 1, WIDTH + 1.0, 1.4 + 0.5 * len(keys), _title(data, name))
    plot, places = plots[0, 0], np.arange(len(keys))[::-1]
    for k, word in enumerate(("first", "total")):
        shares, half = data[f"{name}_{word}"].values, data[f"{name}_{word}_interval"].values
        text = {"first": "alone", "total": "with all its interactions"}[word]
        plot.barh(places + 0.2 - 0.4 * k, shares, 0.36, xerr=half, color=COLOURS[k], label=text, ecolor=QUIET)
    plot.set_yticks(places, keys)
    plot.grid(axis="y", visible=False)
    plot.set_xlabel("share of the variance")
    plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure
