"""Figures of a sweep: curves over one parameter, maps over two, bars of what matters, shares of variance."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tautline.results.tables.netcdf import Column
from tautline.scene.values.printed import printed_in
from tautline.scene.values.printed import shown as printed
from tautline.sweeps.indices import PARAMETER, has_indices, samples_left
from tautline.sweeps.missing import Missing, listed_shortly
from tautline.sweeps.plans import AS_IN_THE_SCENE, GRID, ONE, PERCENTILES, Cases, Parameter, word_of
from tautline.sweeps.table import DATASET, TABLE, TIMES, Variables, percentiles_of
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    SHADES,
    STYLES,
    RoomForLabels,
    axes,
    bar_of_shades,
    but_for_rounding,
    colour,
    flatten_rounding,
    label,
    legend_above,
    save,
    scale_in,
    shades_between,
    shortened,
    styled,
)

MOST_FIGURES = 6
"""Figures of one kind that are drawn; the dataset holds all."""
MOST_LONG = 2
"""Parameters of several values that a figure of a grid has room for."""
PANELS, MOST_PANELS = 4, 16
"""Plots of points in a row, and in a figure: one a parameter."""
LINE, LINES = 0.19, 40
"""Height of a line of a legend, in, and lines in a column of it."""
DEPTH = "depth"
"""Axis that is drawn downwards."""
HEIGHT, WIDTH = 3.2, 6.4
NARROW, WIDE, BESIDE = 26, 60, 40
"""Letters in a line of an axis' label, and of a name beside bars: keys are long."""
FAILED = "#B00000"
"""Colour of crosses at cases without a number."""
MUCH, VERY_MUCH = 10.0, 30.0
"""Largest over smallest from which on an axis of equal ratios, and any of uneven steps, is logarithmic."""
HALF_DECADE = 10.0**0.5
"""Factor by which the outer cells of a logarithmic map reach beyond their values at most."""

GRACE, MOST_OF_WIDTH, ROUNDS = 0.15, 0.6, 60
"""What texts at the ends of bars get more than their width, the share of an axis that they may take up, and how often
the axis is widened for them: what is left falls by that share each time."""


def draw(data: Variables, cases: Cases, folder: Path, ending: str = "png") -> list[Path]:
    """Draw what the plan has a figure for into a folder: a file for each number that was collected.

    Raises
    ------
    ResultError
        If one cannot be written.
    """
    names = _names(data, cases)[:MOST_FIGURES]
    made: list[tuple[str, Any]] = []
    if cases.indices:
        made = [(f"{name}_indices", _indices_figure(data, name)) for name in names if has_indices(data, name)]
    elif cases.plan.name == ONE:
        made = [(f"{name}_tornado", _tornado(data, cases, name)) for name in names]
    elif cases.plan.name == GRID and 1 <= len(_long(cases)) <= MOST_LONG:
        draw_one = _lines if len(_long(cases)) == 1 or not _numeric(cases) else _map
        made = [(name, draw_one(data, cases, name)) for name in names]
    elif _is_scattered(cases):
        made = [(name, _scatter(data, cases, name)) for name in names]
        made += [(name, _band(data, name)) for name in _bands(data)[:MOST_FIGURES]]
    written: list[Path] = []
    for name, figure in made:
        if figure is not None:
            path = folder / f"{_slug(name)}.{ending}"
            if path in written:
                path = folder / f"{_slug(name)}_{len(written) + 1}.{ending}"
            written.append(save(figure, path))
    return written


def not_drawn(data: Variables, cases: Cases) -> list[str]:
    """What `draw` has no figure of, and where its numbers are: a sentence or more for each kind."""
    names, told = _names(data, cases), []
    if cases.plan.name == GRID and len(_long(cases)) > MOST_LONG and names:
        told.append(
            f"no figures are drawn of a grid in which {len(_long(cases))} parameters have several values. "
            f"{DATASET} and {TABLE} hold all numbers. For figures vary {MOST_LONG} parameters at most"
        )
        return told
    if cases.plan.name == GRID and not _long(cases) and names:
        told.append(f"no figures are drawn of one case. {TABLE} holds its numbers. For figures give a key two values")
        return told
    if cases.plan.name == ONE and not cases.indices:
        told += _without_a_tornado(data, names)
    left = names[MOST_FIGURES:] + (_bands(data)[MOST_FIGURES:] if _is_scattered(cases) else [])
    if left:
        told.append(
            f"not drawn: {', '.join(left)}. Of one kind {MOST_FIGURES} figures are drawn. {DATASET} and {TABLE} hold "
            "all numbers. The names that stand first under collect are drawn"
        )
    if _is_scattered(cases) and len(cases.parameters) > MOST_PANELS and names:
        keys = ", ".join(one.key for one in cases.parameters[MOST_PANELS:])
        told.append(
            f"not drawn: points over {keys}. A figure has {MOST_PANELS} plots. {TABLE} holds all numbers. "
            "The keys that stand first under vary are drawn"
        )
    return told


def _without_a_tornado(data: Variables, names: list[str]) -> list[str]:
    """A sentence on the numbers that have none: there is nothing to compare with, or nothing that is compared."""
    known = {name: np.isfinite(data[name].values) for name in names[:MOST_FIGURES]}
    reasons = {
        "The case with the scene's own values has no number": [name for name, there in known.items() if not there[0]],
        "Only the case with the scene's own values has a number": [
            name for name, there in known.items() if there[0] and not there[1:].any()
        ],
    }
    return [f"not drawn: {', '.join(left)}. {reason}" for reason, left in reasons.items() if left]


def _names(data: Variables, cases: Cases) -> list[str]:
    """Names of all numbers of the cases."""
    return [name for name, one in data.data_vars.items() if _drawn(name, one, cases)]


def _bands(data: Variables) -> list[str]:
    """Names of percentiles along an axis."""
    return [name + PERCENTILES for name, (one, _) in percentiles_of(data).items() if len(one.dims) == 2]


def _is_scattered(cases: Cases) -> bool:
    """Whether the figures of the plan are points over each parameter."""
    return cases.plan.name not in (GRID, ONE) and not cases.indices


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
    factor, unit = scale_in(_system(data), [values[np.isfinite(values)]], unit)
    return values / factor, label(shortened(name.replace("_", " "), WIDE), unit, NARROW)


def _system(data: Variables) -> str:
    return printed_in(data.attrs)


def _title(data: Variables, name: str, cases: Cases | None = None) -> str:
    """Heading of a figure; below it the cases that the figure has no number of."""
    title = str(data.attrs.get("title") or "")
    heading = f"{title}: {name.replace('_', ' ')}" if title else name.replace("_", " ")
    missing = Missing.of(data, name).sentence(cases, _system(data)) if cases is not None else ""
    return f"{heading}\n{missing}" if missing else heading


@styled
def _lines(data: Variables, cases: Cases, name: str) -> Any:
    """A curve over the first parameter with several values; of a second that has no numbers one for each value."""
    long = sorted(_long(cases), key=lambda k: not cases.parameters[k].numeric)
    values, text = _scaled(data, name)
    missing = Missing.of(data, name)
    values, lacking = (
        np.moveaxis(array.reshape(cases.shape), long, range(len(long))).reshape(cases.shape[long[0]], -1)
        for array in (values, missing.cases)
    )
    one, curves = cases.parameters[long[0]], values.shape[1]
    rows = min(curves, LINES)
    figure, plots = axes(1, 1, WIDTH, max(HEIGHT, 1.0 + LINE * rows), _title(data, name, cases))
    plot = plots[0, 0]
    places, text_of_places = _places(one, data)
    order = np.argsort(places)
    places, values, lacking = places[order], values[order], lacking[order]
    for k, column in enumerate(values.T):
        # Of more curves than there are colours neighbours have shades that differ little, and other lines.
        style = "-" if curves <= len(COLOURS) else STYLES[k % len(STYLES)]
        # Between two words there is nothing.
        style = style if one.numeric else ""
        word = shortened(word_of(cases.parameters[long[1]].values[k])) if len(long) > 1 else None
        plot.plot(places, column, f"o{style}", ms=3.5, color=colour(k, curves), label=word)
    for k, column in enumerate(lacking.T):
        # Of few curves each has its own row of crosses, and its colour.
        own = {"color": colour(k, curves)} if 1 < curves <= len(COLOURS) else {}
        _crosses(plot, places[column], missing.word, 0.04 * k if own else 0.0, **own)
    _ticks(plot, one, text_of_places, places=places)
    plot.set_ylabel(text)
    flatten_rounding(plot, values)
    if len(long) == 1:
        legend_above(plot)
    else:
        columns = -(-curves // LINES)
        heading = _in_lines(cases.parameters[long[1]].key, "", NARROW)
        figure.legend(title=heading, loc="outside right upper", ncols=columns, alignment="left")
        figure.set_figwidth(WIDTH + 1.5 * columns)
    return figure


def _crosses(plot: Any, places: np.ndarray, word: str, height: float = 0.0, **look: Any) -> None:
    """Mark places that have no number by crosses on the lower axis, or a share of its height above it."""
    if places.size:
        named = word not in plot.get_legend_handles_labels()[1]
        plot.plot(
            places, np.full(places.size, height), "x", ms=6, mew=1.6, clip_on=False, zorder=5,
            transform=plot.get_xaxis_transform(), label=word if named else None, **({"color": FAILED} | look),
        )  # fmt: skip


def _places(
    one: Any, data: Variables, letters: int = WIDE, numbers: np.ndarray | None = None
) -> tuple[np.ndarray, str]:
    """Places of a parameter's values on an axis, in the unit that keeps labels short, and the label of the axis.

    Those of cases, where their `numbers` are given.
    """
    if not one.numeric:
        return np.arange(len(one.values), dtype=float), _in_lines(one.key, "", letters)
    numbers = np.array(one.numbers, float) if numbers is None else numbers
    factor, unit = scale_in(_system(data), [numbers[np.isfinite(numbers)]], one.unit)
    return numbers / factor, _in_lines(one.key, unit, letters)


def _in_lines(key: str, unit: str, letters: int) -> str:
    """A key as the label of an axis, broken at its dots and nowhere else."""
    lines = label(key.replace(".", ". "), unit, letters).split("\n")
    return "\n".join(line.replace(". ", ".") for line in lines)


def _ticks(plot: Any, one: Any, text: str, along: str = "x", places: np.ndarray | None = None) -> None:
    """Name an axis by a parameter, and its places by the values where these are no numbers, or two far apart."""
    getattr(plot, f"set_{along}label")(text)
    if not one.numeric:
        getattr(plot, f"set_{along}ticks")(
            range(len(one.values)), [shortened(word_of(value), NARROW) for value in one.values]
        )
    elif _logarithmic(np.array(one.numbers)):
        getattr(plot, f"set_{along}scale")("log")
        if len(one.values) == 2 and places is not None:
            # Powers of ten may be far from both.
            getattr(plot, f"set_{along}ticks")(places, [f"{place:.4g}" for place in places])
            getattr(plot, f"set_{along}ticks")([], minor=True)


def _logarithmic(numbers: np.ndarray) -> bool:
    """Whether numbers rise by equal ratios, and by much, or by uneven steps, and by very much, as two may."""
    if numbers.size < 2 or not (numbers > 0.0).all() or numbers.max() < MUCH * numbers.min():
        return False
    numbers = np.sort(numbers)
    if numbers.size == 2:
        return bool(numbers[1] > VERY_MUCH * numbers[0])
    if numbers[-1] > VERY_MUCH * numbers[0]:
        steps = np.diff(numbers)
        return not np.allclose(steps, steps[0], rtol=1e-6)
    ratios = np.diff(np.log(numbers))
    return bool(np.allclose(ratios, ratios[0], rtol=1e-6))


def _edges_on_its_side(numbers: np.ndarray) -> np.ndarray:
    """Edges of cells about numbers (n,): of none above zero below it, for there may be no such mass or stiffness."""
    from tautline.view.figures.waterfall import edges_of

    edges = edges_of(numbers)
    return np.maximum(edges, 0.0) if numbers[0] > 0.0 else edges


def _edges_by_ratio(numbers: np.ndarray) -> np.ndarray:
    """Edges of cells about positive numbers (n,): halfway by their ratio, and beyond the outer ones half a decade."""
    from tautline.view.figures.waterfall import edges_of

    edges = np.exp(edges_of(np.log(numbers)))
    # Cells of values far apart would reach decades beyond all that was run.
    edges[0], edges[-1] = max(edges[0], numbers[0] / HALF_DECADE), min(edges[-1], numbers[-1] * HALF_DECADE)
    return edges


@styled
def _map(data: Variables, cases: Cases, name: str) -> Any:
    """Colours over two parameters; cases without a number are left white, with a cross."""
    across, up = _long(cases)
    values, text = _scaled(data, name)
    values = np.moveaxis(values.reshape(cases.shape), (up, across), (0, 1)).reshape(
        cases.shape[up], cases.shape[across]
    )
    one, two = cases.parameters[across], cases.parameters[up]
    order_x, order_y = np.argsort(one.numbers), np.argsort(two.numbers)
    figure, plots = axes(1, 1, WIDTH, HEIGHT + 0.8, _title(data, name, cases))
    plot = plots[0, 0]
    (x, text_x), (y, text_y) = _places(one, data), _places(two, data, NARROW)
    x, y = x[order_x], y[order_y]
    shown = np.ma.masked_invalid(values[np.ix_(order_y, order_x)])
    # Where all are one number but for rounding there is one colour.
    low, high = but_for_rounding(values)
    # Where an axis is logarithmic, halfway between two values is so by their ratio.
    x_edges, y_edges = (
        _edges_by_ratio(at) if _logarithmic(np.array(each.numbers)) else _edges_on_its_side(at)
        for at, each in ((x, one), (y, two))
    )
    by_ratio = low > 0.0 and high > VERY_MUCH * low
    plot.pcolormesh(x_edges, y_edges, shown, cmap=SHADES, norm=shades_between(low, high, by_ratio))
    plot.grid(False)
    _ticks(plot, one, text_x, places=x)
    _ticks(plot, two, text_y, "y", y)
    # A mesh does not widen an axis for cells without a number.
    plot.set_xlim(*sorted((x_edges[0], x_edges[-1])))
    plot.set_ylim(*sorted((y_edges[0], y_edges[-1])))
    if (rows_and_columns := np.nonzero(np.ma.getmaskarray(shown)))[0].size:
        rows, columns = rows_and_columns
        word = f"white: {Missing.of(data, name).word}"
        plot.plot(x[columns], y[rows], "x", color=FAILED, ms=6, mew=1.6, label=word)
        legend_above(plot)
    bar_of_shades(figure, plot, low, high, text, by_ratio)
    return figure


@styled
def _tornado(data: Variables, cases: Cases, name: str) -> Any:
    """How far each parameter alone moves a number from that of the scene, the largest on top.

    Each bar has its value at its end: two values above that of the scene have one colour.
    """
    values, text = _scaled(data, name)
    if not np.isfinite(values[0]):
        return None
    system, missing = _system(data), Missing.of(data, name)
    spans = [_Span.of(one, cases, values, system, missing) for one in cases.parameters]
    if not any(span.moved.size for span in spans):
        return None
    spans = sorted((span for span in spans if span.words or span.lacking), key=lambda span: span.reach(values[0]))
    most = max(span.most_on_a_side(values[0]) for span in spans)
    heading = _title(data, name, cases)
    high = max(0.42, LINE * most, LINE * max(span.lines for span in spans))
    figure, plots = axes(1, 1, WIDTH + 1.0, 1.4 + LINE * heading.count("\n") + high * len(spans), heading)
    plot = plots[0, 0]
    for place, span in enumerate(spans):
        _bars(plot, place, span, values[0])
    plot.axvline(values[0], color=QUIET, lw=1.0)
    plot.set_yticks(range(len(spans)), [span.name for span in spans])
    plot.grid(axis="y", visible=False)
    plot.set_xlabel(text)
    flatten_rounding(plot, np.concatenate([span.moved for span in spans] + [values[:1]]), "x")
    plot.xaxis.set_major_locator(RoomForLabels())
    numeric = [span.one for span in spans if span.one.numeric]
    if numeric:
        _legend_of_ends(plot, values[0], all(np.isfinite(one.base) for one in numeric))
    _make_room(figure, plot)
    return figure


class _Span(NamedTuple):
    """What a parameter alone makes of a number: for each value the number, the value in SI, and as it is told.

    `lacking` says of which of its values there is no number, and why; it is empty where there is one of each.
    """

    one: Parameter
    moved: np.ndarray
    numbers: np.ndarray
    words: list[str]
    lacking: str

    @classmethod
    def of(cls, one: Parameter, cases: Cases, values: np.ndarray, system: str, missing: Missing) -> _Span:
        """Of the cases that vary a parameter and have a number, from the smallest value to the largest."""
        own = cases.values[one.key]
        its = [k for k, value in enumerate(own) if value is not AS_IN_THE_SCENE and np.isfinite(values[k])]
        its = sorted(its, key=lambda k: cases.numbers[one.key][k]) if one.numeric else its
        numbers = cases.numbers[one.key][its]
        words = [printed(float(number), one.unit, system) for number in numbers]
        lost = missing.values_of(one, cases, system)
        lacking = f"{missing.word}: {listed_shortly(lost)}" if lost else ""
        return cls(one, values[its], numbers, words if one.numeric else [word_of(own[k]) for k in its], lacking)

    @property
    def name(self) -> str:
        """Its key, and below it the values without a number."""
        key = _in_lines(self.one.key, "", BESIDE)
        return f"{key}\n{label(self.lacking, '', BESIDE)}" if self.lacking else key

    @property
    def lines(self) -> int:
        """Of its name."""
        return self.name.count("\n") + 1

    def reach(self, base: float) -> float:
        """From the smallest number to the largest, that of the scene among them."""
        return float(np.max(self.moved, initial=base) - np.min(self.moved, initial=base))

    def most_on_a_side(self, base: float) -> int:
        """How many bars share the height of a place."""
        left = int((self.moved < base).sum())
        return max(left, self.moved.size - left)

    def colour_of(self, k: int) -> str:
        """By whether a value is larger than that of the scene, or of a scene without one than their middle."""
        if not self.one.numeric:
            return QUIET
        middle = self.one.base if np.isfinite(self.one.base) else float(np.mean(self.numbers))
        return COLOURS[int(self.numbers[k] > middle)]


def _bars(plot: Any, place: int, span: _Span, base: float) -> None:
    """Bars of a parameter: those on one side of the scene's number share the height, so that each is seen."""
    for side in (span.moved < base, span.moved >= base):
        its = np.flatnonzero(side)
        height = 0.7 / max(1, its.size)
        for row, k in enumerate(its.tolist()):
            at = place + height * (row - 0.5 * (its.size - 1))
            plot.barh(at, span.moved[k] - base, 0.9 * height, left=base, color=span.colour_of(k))
            before = span.moved[k] < base
            plot.annotate(
                shortened(span.words[k], NARROW), (span.moved[k], at), (-4 if before else 4, 0),
                textcoords="offset points", ha="right" if before else "left", va="center", fontsize=8,
            )  # fmt: skip


def _make_room(figure: Any, plot: Any) -> None:
    """Widen the axis until the values beside the ends of the bars lie in it, and the figure where they are long words.

    The layout does not know of them: it would make the axis narrower for texts beyond it, which then lie further out.
    """
    for text in plot.texts:
        text.set_in_layout(False)
    figure.draw_without_rendering()
    ends = np.array([text.xy[0] for text in plot.texts])
    places = plot.transData.transform(np.column_stack((ends, np.zeros(ends.size))))[:, 0]
    boxes = [text.get_window_extent() for text in plot.texts]
    left = (1.0 + GRACE) * np.maximum(0.0, places - [box.x0 for box in boxes])
    right = (1.0 + GRACE) * np.maximum(0.0, [box.x1 for box in boxes] - places)
    lacking = (left.max() + right.max()) / MOST_OF_WIDTH - plot.bbox.width
    if lacking > 0.0:
        figure.set_figwidth(figure.get_figwidth() + lacking / figure.dpi)
        figure.draw_without_rendering()
    least, most = low, high = plot.get_xlim()
    for _ in range(ROUNDS):
        scale = (high - low) / plot.bbox.width
        low, high = min(least, (ends - scale * left).min()), max(most, (ends + scale * right).max())
    plot.set_xlim(low, high)


def _legend_of_ends(plot: Any, at: float, of_scene: bool) -> None:
    """Say what the colours are, by bars of no length; whether the scene has all the values that they are beside."""
    than = " than in the scene" if of_scene else ""
    for k, text in enumerate((f"smaller value{than}", f"larger value{than}")):
        plot.barh(0, 0.0, left=at, color=COLOURS[k], label=text)
    # To the left there is room above the names.
    plot.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)


@styled
def _scatter(data: Variables, cases: Cases, name: str) -> Any:
    """A number against each parameter in turn; words stand side by side, in the order of their list."""
    shown = cases.parameters[:MOST_PANELS]
    values, text = _scaled(data, name)
    columns = min(PANELS, len(shown))
    rows = -(-len(shown) // columns)
    figure, plots = axes(rows, columns, 1.0 + 2.9 * columns, HEIGHT * rows, _title(data, name, cases), sharey=True)
    missing = Missing.of(data, name)
    for plot in plots.ravel()[len(shown) :]:
        plot.remove()
    for plot, one in zip(plots.ravel(), shown, strict=False):
        if one.numeric:
            places, text_of_places = _places(one, data, NARROW, cases.numbers[one.key])
        else:
            words = [word_of(value) for value in one.values]
            places = np.array([words.index(word_of(value)) for value in cases.values[one.key]], float)
            text_of_places = _in_lines(one.key, "", NARROW)
            plot.set_xticks(range(len(words)), [shortened(word, NARROW // 2) for word in words])
        plot.plot(places, values, ".", ms=4)
        _crosses(plot, places[missing.cases], missing.word)
        plot.set_xlabel(text_of_places)
    for plot in plots[:, 0]:
        plot.set_ylabel(text)
        flatten_rounding(plot, values)
    if missing.cases.any():
        figure.legend(*plots[0, 0].get_legend_handles_labels(), loc="outside lower right")
    return figure


@styled
def _band(data: Variables, name: str) -> Any:
    """Percentiles of a number along its axis: against depth as drillers draw it, else from left to right."""
    along = data[name].dims[1]
    values, text = _scaled(data, name)
    places = data[along].values if along in data.coords else np.arange(values.shape[1])
    unit = str(data[along].attrs.get("units") or "") if along in data.coords else ""
    factor, unit = scale_in(_system(data), [places], unit)
    # Places stand in the order in which they were asked for: a line over them as they stand would double back.
    order = np.argsort(places, kind="stable")
    downwards, places, values = along == DEPTH, places[order] / factor, values[:, order]
    figure, plots = axes(1, 1, WIDTH, HEIGHT + (1.2 if downwards else 0.0), _title(data, name))
    plot, (low, middle, high) = plots[0, 0], values
    flatten_rounding(plot, values, "x" if downwards else "y")
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
    legend_above(plot)
    return figure


@styled
def _indices_figure(data: Variables, name: str) -> Any:
    """First-order and total indices, with their intervals."""
    keys: Sequence[str] = [str(key) for key in data[PARAMETER].values]
    title, (left, made) = _title(data, name), samples_left(data, name) or (0, 0)
    if left < made:
        title += f"\nof {left} of {made} samples: of the others a case failed or has no number"
    figure, plots = axes(1, 1, WIDTH + 1.0, 1.4 + 0.5 * len(keys), title)
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
