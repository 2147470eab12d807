"""Figures of what a twin has found: estimates with their bands, residuals of sensors, alarms and health."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime

import numpy as np
from matplotlib.ticker import MaxNLocator

from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, over_time, title
from tautline.view.figures.drawings import Drawing
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    Axes,
    Figure,
    axes,
    label,
    legend_above,
    scale,
    shortened,
    styled,
)

ESTIMATE, DEVIATION, RESIDUAL = "estimate ", "deviation ", "residual "
"""Beginnings of the names of variables of a twin's result."""
BAND = 2.0
"""Standard deviations on both sides of an estimate, as the command prints them: 95 % of a normal distribution."""
STAMP = 1.0e8
"""Seconds from which on a time is a date, counted from 1970."""
LETTERS = 30
"""Of a vertical axis' label in one line."""
HEALTHS = ("good", "degraded", "lost")
STATES, ALARM = "alarm_state", "alarm"
"""Variable of the state of each alarm, and of their names; results of earlier versions have the number alone."""
DOUBTED, CERTAIN = 1, 2
USUAL = 99.0
"""Percentile of the sizes of residuals that a panel shows in any case, and all of the later half of the rows."""
FAR = 2.0
"""How many times as large as those a residual is before it is left out of the picture, and told in words."""


def _named(result: Result, beginning: str) -> list[str]:
    return [name.removeprefix(beginning) for name in result.variables if name.startswith(beginning)]


def _times(result: Result) -> tuple[np.ndarray, str]:
    """Times, s, from the first where they are dates, and what the axis says."""
    time = np.asarray(result.time, float)
    if time.size == 0:
        raise NothingToShow(result, "no rows", "see what the twin printed")
    if time[0] < STAMP:
        return time, label("time", "s")
    begin = datetime.fromtimestamp(float(time[0]), UTC)
    return time - time[0], label(f"time since {begin:%Y-%m-%d %H:%M:%S} UTC", "s")


def _known(values: np.ndarray) -> np.ndarray:
    return values[np.isfinite(values)]


def _one_each(
    result: Result, beginning: str, draw: Callable[..., str], nothing: NothingToShow, words: str = ""
) -> Figure:
    """A panel for each variable with a beginning; ``draw`` puts it in and returns its unit, `words` stand before names.

    Raises
    ------
    NothingToShow
        That which is given, where the result has none of them.
    """
    time, along = _times(result)
    names = _named(result, beginning)
    if not names:
        raise nothing
    rows = len(names)
    figure, plots = axes(rows, 1, 8.0, 4.4 if rows == 1 else 2.2 * rows + 0.6, title([result]), sharex=True)
    for plot, name in zip(plots[:, 0], names, strict=True):
        unit = draw(plot, result, name, time)
        plot.set_ylabel(label(f"{words}{name}", unit or "–", LETTERS))
    return _finished(figure, plots, time, along)


@styled
def estimates(results: Sequence[Result]) -> Figure:
    """Estimates against time, each with its band of two standard deviations."""
    (result,) = results
    cure = "name what is not known under `estimate` in the map"
    return _one_each(result, ESTIMATE, _draw_estimate, NothingToShow(result, "no estimate", cure))


def _draw_estimate(plot: Axes, result: Result, name: str, time: np.ndarray) -> str:
    value, sd = (np.asarray(result[beginning + name], float) for beginning in (ESTIMATE, DEVIATION))
    factor, unit = scale([_known(value)], result.variables[ESTIMATE + name].units)
    low, high = (value - BAND * sd) / factor, (value + BAND * sd) / factor
    words = f"± {BAND:g} standard deviations"
    plot.fill_between(time, low, high, color=COLOURS[0], alpha=0.25, lw=0, label=words)
    plot.plot(time, value / factor, color=COLOURS[0], label="estimate", **marker(time))
    return unit


@styled
def residuals(results: Sequence[Result]) -> Figure:
    """What sensors show less what the scene expects, against time."""
    (result,) = results
    cure = "give a sensor of the map an `output`"
    return _one_each(result, RESIDUAL, _draw_residual, NothingToShow(result, "no residual", cure), "residual of ")


def _draw_residual(plot: Axes, result: Result, name: str, time: np.ndarray) -> str:
    value = np.asarray(result[RESIDUAL + name], float)
    usual = _usual_size(value)
    far = np.abs(value) > FAR * usual if usual > 0.0 else np.zeros(value.shape, bool)
    factor, unit = scale([_known(np.where(far, np.nan, value))], result.variables[RESIDUAL + name].units)
    plot.axhline(0.0, color=QUIET, lw=0.8, zorder=0)
    plot.plot(time, value / factor, color=COLOURS[0], lw=1.0, label="measured less expected", **marker(time))
    if far.any():
        shown = _known(value[~far]) / factor
        low, high = min(0.0, float(shown.min())), max(0.0, float(shown.max()))
        plot.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))
        k = int(np.nanargmax(np.abs(value)))
        rows = "1 row is" if far.sum() == 1 else f"{far.sum()} rows are"
        words = f"{rows} beyond, the farthest with {value[k] / factor:.3g} {unit} at {time[k]:.4g} s"
        plot.text(0.99, 0.97, words, transform=plot.transAxes, ha="right", va="top", fontsize=8)
    return unit


def _usual_size(value: np.ndarray) -> float:
    """Size that hardly any residual has more of: what stands at the start, before anything is estimated, is far off."""
    whole, later = _known(np.abs(value)), _known(np.abs(value[len(value) // 2 :]))
    return float(max(np.percentile(whole, USUAL), later.max(initial=0.0))) if whole.size else 0.0


@styled
def alarms(results: Sequence[Result]) -> Figure:
    """When each alarm stood, and how far the data can be trusted, against time; of old results how many stood."""
    (result,) = results
    time, along = _times(result)
    if not {"alarms", "health"} <= set(result.variables):
        raise NothingToShow(result, "no alarms")
    names = _alarms_that_came(result)
    more = max(0, len(names or ()) - 6)
    heights = [1.0 + more / 6.0, 1.0]
    figure, plots = axes(2, 1, 8.0, 4.4 + 0.3 * more, title([result]), sharex=True, height_ratios=heights)
    upper, lower = plots[:, 0]
    if names is None:
        _draw_count(upper, result, time)
    else:
        _draw_bars(upper, result, names, time)
    lower.step(time, np.asarray(result["health"], float), color=COLOURS[1], where="post", **marker(time))
    lower.set_yticks(range(len(HEALTHS)), HEALTHS)
    lower.set_ylim(len(HEALTHS) - 0.8, -0.2)
    lower.set_ylabel("health of the data")
    return _finished(figure, plots, time, along)


def _alarms_that_came(result: Result) -> dict[str, int] | None:
    """Alarms that stood at any time, each with its place among all; None of a result that does not tell them apart."""
    if not {STATES, ALARM} <= set(result.variables):
        return None
    states = np.asarray(result[STATES])
    if states.shape[1] and (states < 0).all(axis=1).any():
        return None  # of rows of an earlier version no alarm is known, and the number is what all rows have
    came = np.flatnonzero((states > 0).any(axis=0))
    return {str(result[ALARM][k]): int(k) for k in came}


def _draw_bars(plot: Axes, result: Result, names: Mapping[str, int], time: np.ndarray) -> None:
    """A line for each alarm, with a bar for as long as it stood; hollow in doubt, blank where it was not watched."""
    states = np.asarray(result[STATES])
    for row, k in enumerate(names.values()):
        for state, fill in ((CERTAIN, COLOURS[1]), (DOUBTED, "none")):
            spans = _spans(states[:, k] == state, time)
            word = ("certain" if state == CERTAIN else "in doubt") if row == 0 else None
            plot.broken_barh(spans, (row - 0.35, 0.7), facecolor=fill, edgecolor=COLOURS[1], lw=0.8, label=word)
    plot.set_yticks(range(len(names)), [shortened(name) for name in names])
    plot.set_ylim(max(1, len(names)) - 0.5, -0.5)
    plot.grid(visible=False, axis="y")
    plot.set_ylabel("alarms")
    if not names:
        plot.text(0.5, 0.5, "no alarm", transform=plot.transAxes, ha="center", va="center")


def _spans(holds: np.ndarray, time: np.ndarray) -> list[tuple[float, float]]:
    """Begin and length, s, of each stretch of rows at which something holds, up to the row at which it does no more."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(int)))
    begins, ends = edges[::2], np.minimum(edges[1::2], len(time) - 1)
    return [(float(time[a]), float(time[b] - time[a])) for a, b in zip(begins, ends, strict=True)]


def _draw_count(upper: Axes, result: Result, time: np.ndarray) -> None:
    """How many alarms stood."""
    count = np.asarray(result["alarms"], float)
    upper.step(time, count, color=COLOURS[0], where="post", **marker(time))
    upper.set_ylim(-0.1, max(1.0, float(_known(count).max(initial=0.0))) + 0.3)
    upper.yaxis.set_major_locator(MaxNLocator(integer=True))
    upper.set_ylabel(label("alarms", "–"))


def _finished(figure: Figure, plots: np.ndarray, time: np.ndarray, along: str) -> Figure:
    legend_above(plots[0, 0])
    over_time(figure, plots, [time])
    last: Axes = plots[-1, 0]
    last.set_xlabel(along)
    return figure


DRAWINGS = {
    "estimates": Drawing("estimates with two standard deviations", estimates, together=False, compared=True),
    "residuals": Drawing("sensors, measured less expected", residuals, together=False, compared=True),
    "alarms": Drawing("alarms by name, and health of the data", alarms, together=False, compared=True),
}
"""Figures of the result of a twin."""
