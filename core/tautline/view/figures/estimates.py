"""Figures of what a twin has found: estimates with their bands, residuals of sensors, alarms and health."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import UTC, datetime

import numpy as np

from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, over_time, title
from tautline.view.figures.drawings import Drawing
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, label, legend_above, scale, styled

ESTIMATE, DEVIATION, RESIDUAL = "estimate ", "deviation ", "residual "
"""Beginnings of the names of variables of a twin's result."""
BAND = 2.0
"""Standard deviations on both sides of an estimate, as the command prints them: 95 % of a normal distribution."""
STAMP = 1.0e8
"""Seconds from which on a time is a date, counted from 1970."""
LETTERS = 30
"""Of a vertical axis' label in one line."""
HEALTHS = ("good", "degraded", "lost")


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
    factor, unit = scale([_known(value)], result.variables[RESIDUAL + name].units)
    plot.axhline(0.0, color=QUIET, lw=0.8, zorder=0)
    plot.plot(time, value / factor, color=COLOURS[0], lw=1.0, label="measured less expected", **marker(time))
    return unit


@styled
def alarms(results: Sequence[Result]) -> Figure:
    """How many alarms there are, and how far the data can be trusted, against time."""
    (result,) = results
    time, along = _times(result)
    if not {"alarms", "health"} <= set(result.variables):
        raise NothingToShow(result, "no alarms")
    figure, plots = axes(2, 1, 8.0, 4.4, title([result]), sharex=True)
    upper, lower = plots[:, 0]
    count = np.asarray(result["alarms"], float)
    upper.step(time, count, color=COLOURS[0], where="post", **marker(time))
    upper.set_ylim(-0.1, max(1.0, float(_known(count).max(initial=0.0))) + 0.3)
    upper.yaxis.get_major_locator().set_params(integer=True)
    upper.set_ylabel(label("alarms", "–"))
    lower.step(time, np.asarray(result["health"], float), color=COLOURS[1], where="post", **marker(time))
    lower.set_yticks(range(len(HEALTHS)), HEALTHS)
    lower.set_ylim(len(HEALTHS) - 0.8, -0.2)
    lower.set_ylabel("health of the data")
    return _finished(figure, plots, time, along)


def _finished(figure: Figure, plots: np.ndarray, time: np.ndarray, along: str) -> Figure:
    legend_above(plots[0, 0])
    over_time(figure, plots, [time])
    last: Axes = plots[-1, 0]
    last.set_xlabel(along)
    return figure


DRAWINGS = {
    "estimates": Drawing("estimates with two standard deviations", estimates, together=False, compared=True),
    "residuals": Drawing("sensors, measured less expected", residuals, together=False, compared=True),
    "alarms": Drawing("number of alarms, and health of the data", alarms, together=False, compared=True),
}
"""Figures of the result of a twin."""
