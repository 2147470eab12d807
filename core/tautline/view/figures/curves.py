"""Any stored variable against time, against another variable, or down a profile; several results are overlaid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.variable import outside
from tautline.view.figures.choice import Chosen, choose, split
from tautline.view.figures.comparison import marker, over_time
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    STYLES,
    Axes,
    Figure,
    axes,
    colour,
    label,
    legend_above,
    scale,
    styled,
)

MOST_LINES = 7
"""Columns up to which each has a line; of more, the range of all and the two ends are drawn."""
MOST_STYLED = len(STYLES)
"""Columns up to which each has a line in a comparison, where colours tell results apart."""
DASH = "–"
"""Unit of what has none."""
ROUNDING = 1.0e-9
"""Share of the largest magnitude below which differences are shown as none."""
FINEST = 1.0e-6
"""Difference of lengths, m, that is shown however far from the origin they are."""
DOUBLES = 1.0e-13
"""Share of a length by which some hundred roundings of doubles may change it: less is never shown."""
LETTERS = 30
"""Of a vertical axis' label in one line."""


class _Against(NamedTuple):
    """What a variable is drawn against: another, in the same order of results, and the times of a profile."""

    name: str
    chosen: list[Chosen]
    times: list[float]


@styled
def variable_figure(results: Sequence[Result], names: Sequence[str], what: str, vs: str | None, title: str) -> Figure:
    """Draw a variable, or a part of it.

    Parameters
    ----------
    names : sequence of str
        Of the results, for the legend.
    what : str
        As `tautline.view.figures.choice.choose` takes it.
    vs : str, optional
        Another variable to draw it against, in place of time. A history, such as ``block_position``, gives a loop, and
        so does one of the same things by name, such as ``paid_out`` of each drum. One along the same numbered
        dimension, such as ``measured_depth``, gives a profile at the last frame, or at the frames nearest to times in
        seconds that follow it, as ``measured_depth@0,12.5``.

    Raises
    ------
    ResultError
        If there is no such variable, or the two do not belong together.
    """
    chosen = [choose(result, what) for result in results]
    if len({len(one.panels()) for one in chosen}) > 1:
        raise ResultError("--what", f"'{what}' has other directions in another result", "plot them one by one")
    times = [result.time for result in results]
    if vs is None or vs == "time":
        if not chosen[0].changes:
            cure = "name what to draw it against with --vs"
            raise ResultError("--what", f"'{what}' does not change with time", cure)
        figure = _history(chosen, times, names, title)
        _draw_limits(figure.axes, chosen, results, names, split(what)[0])
        return figure
    against = _against(results, vs)
    if all(_pairs(one, other, against) for one, other in zip(chosen, against.chosen, strict=True)):
        return _loop(chosen, against, times, names, title)
    return _profile(chosen, against, times, names, title)


def _pairs(one: Chosen, other: Chosen, against: _Against) -> bool:
    """Whether two variables are histories to be drawn as pairs: of one thing, or both of the same things by name.

    Along numbered members, such as nodes, a profile is meant; so it is where times of one are named.
    """
    if not (one.changes and other.changes) or (against.times and other.items):
        return False
    single = other.values.size == len(other.values)
    return single or (one.things and one.items == other.items == other.dims[1:])


def _against(results: Sequence[Result], vs: str) -> _Against:
    """Read what is drawn against; raises ResultError."""
    name, _, words = vs.partition("@")
    try:
        times = [float(word.strip().removesuffix("s")) for word in words.split(",")] if words else []
    except ValueError:
        cause = f"'{words}' are no times in seconds"
        raise ResultError("--vs", cause, f"write them between commas: {name}@0,12.5") from None
    for result in results:
        _check_times(times, result)
    return _Against(name, [choose(result, name, "--vs") for result in results], times)


def _check_times(times: Sequence[float], result: Result) -> None:
    """Refuse times that a run does not have, as its pictures do; raises ResultError."""
    begin, end = float(result.time[0]), float(result.time[-1])
    for one in times:
        if outside(one, result.time):
            cause = f"t = {one:g} s is outside of the run{f' in {result.path}' if result.path else ''}"
            raise ResultError("--vs", cause, f"give times from {begin:g} to {end:g} s")


def _history(chosen: Sequence[Chosen], times: Sequence[np.ndarray], names: Sequence[str], title: str) -> Figure:
    """Draw against time, directions one below the other."""
    panels = [one.panels() for one in chosen]
    rows = len(panels[0])
    figure, plots = axes(rows, 1, 8.0, 4.4 if rows == 1 else 2.2 * rows + 0.6, title, sharex=True)
    for row, plot in enumerate(plots[:, 0]):
        parts = [own[row] for own in panels]
        factor, unit = scale([part[2] for part in parts], chosen[0].unit)
        for run, ((_, columns, values), time) in enumerate(zip(parts, times, strict=True)):
            many = len(columns) > (MOST_LINES if len(parts) == 1 else MOST_STYLED)
            if many:
                words = f"all {len(columns)}" if len(parts) == 1 else f"{names[run]}, all {len(columns)}"
                look = {"color": COLOURS[5] if len(parts) == 1 else colour(run, len(parts)), "alpha": 0.3, "lw": 0}
                low, high = values.min(axis=1) / factor, values.max(axis=1) / factor
                plot.fill_between(time, low, high, label=words, **look)
            for k, column, look in _looks(columns, run, len(parts), names, many):
                plot.plot(time, values[:, k] / factor, label=column, **look, **marker(time))
        _steady(plot, [part[2] / factor for part in parts], chosen, factor)
        plot.set_ylabel(label(parts[0][0], unit or DASH, LETTERS))
    legend_above(plots[0, 0])
    return over_time(figure, plots, times)


def _draw_limits(
    plots: Sequence[Axes], chosen: Sequence[Chosen], results: Sequence[Result], names: Sequence[str], name: str
) -> None:
    """Draw the limits that the scenes of results give of a variable, where they are not far from its values.

    One that not all of the results have is told with the names of those that have it, and is in the colour of a single
    one: the scenes may give several bounds under one name.
    """
    bounds: dict[tuple[str, float], list[int]] = {}
    for run, result in enumerate(results):
        for one in result.limits:
            if one.get("variable") == name and run not in (of := bounds.setdefault((one["name"], one["limit"]), [])):
                of.append(run)
    if not bounds or len(plots) != 1:
        return
    factor, _ = scale([one.values for one in chosen], chosen[0].unit)
    low, high = plots[0].get_ylim()
    for (words, bound), runs in sorted(bounds.items(), key=lambda pair: pair[0][1]):
        ink = "black"
        if len(runs) < len(results):
            words = f"{words} ({', '.join(names[run] for run in runs)})"
            ink = colour(runs[0], len(results)) if len(runs) == 1 else ink
        # One that is far away would press the curves into a line.
        if low - (high - low) <= bound / factor <= high + (high - low):
            plots[0].axhline(bound / factor, color=ink, lw=1.2, ls="--", label=words)
    legend_above(plots[0])


def _looks(
    columns: Sequence[str], run: int, runs: int, names: Sequence[str], many: bool
) -> list[tuple[int, str | None, dict[str, Any]]]:
    """Which columns have a line, its name and its look: colours tell columns of one result apart, else results."""
    shown = [0, len(columns) - 1] if many else list(range(len(columns)))
    looks = []
    for number, k in enumerate(shown):
        if runs == 1:
            words, look = columns[k] or None, {"color": COLOURS[number], "ls": "-"}
        else:
            words = f"{names[run]}, {columns[k]}" if columns[k] else names[run]
            look = {"color": colour(run, runs), "ls": STYLES[number % len(STYLES)]}
        looks.append((k, words, look | {"lw": 1.2}))
    return looks


def _steady(
    plot: Axes, values: Sequence[np.ndarray], chosen: Sequence[Chosen], factor: float, along: str = "y"
) -> None:
    """Keep rounding from filling the panel: what varies by less than that is shown as level.

    Values are in the unit of the axis, which is `factor` of that of the variable. Beside the largest magnitude in any
    direction what is not zero may be rounding. It is shown as zero then.
    """
    whole = np.concatenate([array.ravel() for array in values])
    if whole.size == 0 or not np.isfinite(whole).all():
        return
    size, least = max(one.size for one in chosen) / factor, _rounding(chosen) / factor
    own, middle = float(np.abs(whole).max()), 0.5 * float(whole.max() + whole.min())
    if np.ptp(whole) > least:
        return
    if own <= least:
        own, middle = size, 0.0
    half = 0.1 * own or 1.0
    getattr(plot, f"set_{along}lim")(middle - half, middle + half)


def _rounding(chosen: Sequence[Chosen]) -> float:
    """Largest difference of a variable's values that is shown as none, in its unit.

    Of a place on a map, 4 10^6 m from the origin, the share of other variables would be 4 mm, which a rope moves by.
    """
    size = max(one.size for one in chosen)
    share = ROUNDING * size
    return min(share, max(FINEST, DOUBLES * size)) if chosen[0].unit == "m" else share


def _loop(
    chosen: Sequence[Chosen], against: _Against, times: Sequence[np.ndarray], names: Sequence[str], title: str
) -> Figure:
    """Draw pairs of two histories, directions side by side; a ring is where a curve begins."""
    if against.times:
        raise ResultError("--vs", f"'{against.name}' has one value a frame: it is no profile", "leave the times out")
    panels = [one.panels() for one in chosen]
    columns = len(panels[0])
    figure, plots = axes(1, columns, 6.4 if columns == 1 else 3.6 * columns + 0.6, 4.8, title)
    across, across_unit = scale([one.values for one in against.chosen], against.chosen[0].unit)
    for place, plot in enumerate(plots[0]):
        parts = [own[place] for own in panels]
        factor, unit = scale([part[2] for part in parts], chosen[0].unit)
        for run, (part, other, time) in enumerate(zip(parts, against.chosen, times, strict=True)):
            many = len(part[1]) > (MOST_LINES if len(parts) == 1 else MOST_STYLED)
            for k, words, look in _looks(part[1], run, len(parts), names, many):
                whole = other.values.reshape(len(other.values), -1) / across
                x, y = whole[:, k if whole.shape[1] > 1 else 0], part[2][:, k] / factor
                plot.plot(x, y, label=words, **look, **marker(time))
                plot.plot(x[0], y[0], marker="o", ms=5, mfc="white", mec=look["color"], ls="", zorder=3)
        _steady(plot, [part[2] / factor for part in parts], chosen, factor)
        _steady(plot, [one.values / across for one in against.chosen], against.chosen, across, "x")
        plot.set_xlabel(label(against.chosen[0].text, across_unit or DASH))
        plot.set_ylabel(label(parts[0][0], unit or DASH, LETTERS))
    legend_above(plots[0, 0])
    return figure


def _profile(
    chosen: Sequence[Chosen], against: _Against, times: Sequence[np.ndarray], names: Sequence[str], title: str
) -> Figure:
    """Draw values along a dimension at chosen frames; a depth stands upright and grows downwards."""
    depth = "depth" in against.name
    columns = len(chosen[0].panels())
    size = (3.6 * columns + 1.6, 5.6) if depth else (8.0, 2.2 * columns + 2.2)
    shape = (1, columns) if depth else (columns, 1)
    figure, plots = axes(*shape, *size, title, sharex=not depth, sharey=depth)
    for place, plot in enumerate(plots.ravel()):
        parts = [own.panels()[place] for own in chosen]
        factor, unit = scale([part[2] for part in parts], chosen[0].unit)
        seen: list[np.ndarray] = []
        across, across_unit = scale([one.values for one in against.chosen], against.chosen[0].unit)
        for run, (part, one, other, time) in enumerate(zip(parts, chosen, against.chosen, times, strict=True)):
            wanted = against.times or [float(time[-1])]
            frames = list(dict.fromkeys(int(np.abs(time - at).argmin()) for at in wanted))
            for number, frame in enumerate(frames):
                y = (part[2][frame] if one.changes else part[2].ravel()) / factor
                x, y = _together(other.values[frame] if other.changes else other.values, y, against.name)
                seen.append(y)
                words = f"at {time[frame]:.4g} s" if one.changes or other.changes else ""
                words = ", ".join(text for text in (names[run] if len(parts) > 1 else "", words) if text)
                look = {"color": colour(number, len(frames)) if len(parts) == 1 else colour(run, len(parts))}
                look |= {"ls": STYLES[number % len(STYLES)] if len(parts) > 1 else "-", "marker": "o", "ms": 3}
                plot.plot(*((y, x / across) if depth else (x / across, y)), label=words or None, **look)
        _steady(plot, seen, chosen, factor, "x" if depth else "y")
        values, along = label(parts[0][0], unit or DASH), label(against.chosen[0].text, across_unit or DASH)
        if depth:
            plot.set_xlabel(values)
            plot.axvline(0.0, color=QUIET, lw=0.8, zorder=0)
        else:
            plot.set_ylabel(label(parts[0][0], unit or DASH, LETTERS))
    (plots[0, 0].set_ylabel if depth else plots[-1, 0].set_xlabel)(along)
    if depth:
        plots[0, 0].invert_yaxis()
    legend_above(plots[0, 0])
    return figure


def _together(x: np.ndarray, y: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a profile: what belongs to the pieces between points is drawn at their middles."""
    x, y = np.ravel(x), np.ravel(y)
    if len(x) == len(y) + 1 and len(y) > 0:
        x = 0.5 * (x[1:] + x[:-1])
    if len(x) != len(y):
        cause = f"'{name}' has {len(x)} values a frame, and what is drawn against it {len(y)}"
        raise ResultError("--vs", cause, "choose one value after a colon, or another variable")
    return x, y
