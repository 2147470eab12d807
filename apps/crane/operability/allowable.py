"""From the maxima of storms to the allowable significant wave height.

Of each sea state Gumbel's distribution is fitted to the maxima over the seeds. What is compared with a limit is the
most probable largest, or a percentile of the largest. Over the significant height it is made monotone (no higher sea is
allowed because its draw was lucky) and interpolated by monotone cubics (Fritsch and Carlson 1980): the allowable height
is where that curve meets the limit. Its interval comes from the bounds of the fit in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from crane.operability.conditions import Condition, highest
from crane.operability.criteria import Criterion
from tautline.scene.vector import EARTH_GRAVITY
from tautline.statistics.gumbel import FEWEST, Estimate, fit_gumbel

COMPUTED, STEEP, FAILED, FEW = "computed", "not physical: too steep", "failed", "too few storms"
ABSENT = "does not occur"
INSIDE, BELOW, ABOVE, BREAKS, STOPPED, SLACK, UNKNOWN = (
    "", "below the lowest calculated", "at least the highest calculated", "at least the steepest wave",
    "a storm of the next height failed", "all storms of the next height, or all but one, leave the rope slack",
    "not known",
)  # fmt: skip
"""How an allowable height is bounded: found between heights; smaller than all; larger than all of the grid, or than all
that are physical; the last one below a height of which a storm did not come to its end, or of which all storms but one
at most have no tension left, so that nothing tells how far beyond the limit they are."""

UPWARDS = (ABOVE, BREAKS)
"""Bounds from below: the height is at least that."""


class Allowable(NamedTuple):
    """An allowable significant height, m, its interval, and how the height and both ends are bounded."""

    height: float
    low: float
    high: float
    bound: str
    low_bound: str = ""
    high_bound: str = ""


FITTED = (
    "location",
    "scale",
    *(f"{what}{end}" for what in ("most_probable", "percentile", "exceedance") for end in ("", "_low", "_high")),
)


def fitted(values: np.ndarray, one: Criterion, ratio: float, share: float, confidence: float) -> dict[str, float]:
    """Extremes of the maxima of storms, (n,), in the sense of a limit; NaN where there are too few, or one is unknown.

    A safety factor without end is known: it is fitted as the tension that it is of, which is none. So is one of the
    fit that has no end, which is infinite here.

    A storm that failed is no draw that is lacking by chance: what fails is often what snaps, and an extreme of the
    others would be too small.
    """
    if values.size < FEWEST or not one.known(values).all():
        return dict.fromkeys(FITTED, math.nan)
    # A force that has fallen below is none that the floor holds, such as a component, or the force of a rod.
    bound = -one.floor if values.min() >= one.floor else math.inf
    fit = fit_gumbel(one.badness(values), ratio, bound)
    # Location and scale are those of what is fitted: of a quotient those of what it is divided by.
    found = {"location": one.sign * fit.location, "scale": fit.scale}
    for name, estimate in (
        ("most_probable", fit.most_probable(confidence)), ("percentile", fit.percentile(share, confidence)),
    ):  # fmt: skip
        # Low and high are those of the value, whichever of them is the bad one.
        low, high = sorted(float(one.from_badness(end)) for end in (estimate.low, estimate.high))
        found |= {name: float(one.from_badness(estimate.value)), f"{name}_low": low, f"{name}_high": high}
    limit = float(one.badness(one.limit))
    beyond = fit.exceedance(limit, confidence)
    if fit.scale == 0.0 and one.strict and limit == fit.location:
        beyond = Estimate(1.0, 1.0, 1.0)
    return found | {"exceedance": beyond.value, "exceedance_low": beyond.low, "exceedance_high": beyond.high}


def allowable(
    heights: np.ndarray,
    values: np.ndarray,
    lows: np.ndarray,
    highs: np.ndarray,
    limit: float,
    top: float,
    strict: bool = False,
) -> Allowable:
    """The allowable height of one limit, period and heading.

    Parameters
    ----------
    heights : (n,) array
        Increasing, of the sea states that were run, m.
    values, lows, highs : (n,) array
        What is compared with the limit, with large values bad; infinite where storms failed.
    limit : float
    top : float
        Largest height of the grid, physical or not, m.
    strict : bool
        Whether what is equal to the limit is beyond it.
    """
    known = ~np.isnan(values)
    if not known.any():
        return Allowable(math.nan, math.nan, math.nan, UNKNOWN)
    heights = heights[known]
    # An end of the interval may lie beyond the grid where the height itself does not.
    ends = [crossing(heights, one[known], limit, strict) for one in (values, highs, lows)]
    ends = [(height, BREAKS if bound == ABOVE and heights[-1] < top else bound) for height, bound in ends]
    middle, low, high = ends
    low, high = min(low, middle, key=lambda end: end[0]), max(high, middle, key=lambda end: end[0])
    return Allowable(middle[0], low[0], high[0], middle[1], low[1], high[1])


def crossing(heights: np.ndarray, values: np.ndarray, limit: float, strict: bool = False) -> tuple[float, str]:
    """Where the monotone curve through values (n,) meets a limit, and how that is bounded."""
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    rising = np.maximum.accumulate(values)
    beyond = rising >= limit if strict else rising > limit
    if beyond[0]:
        return 0.0, BELOW if np.isfinite(rising[0]) else STOPPED
    if not beyond[-1]:
        return float(heights[-1]), ABOVE
    k = int(np.argmax(beyond))
    usable = np.isfinite(rising)
    if not usable[k]:
        # Storms of that height failed: nothing is known between.
        return float(heights[k - 1]), STOPPED
    if rising[k - 1] == limit:
        return float(heights[k - 1]), INSIDE
    curve = PchipInterpolator(heights[usable], rising[usable])
    return float(brentq(lambda height: float(curve(height)) - limit, heights[k - 1], heights[k])), INSIDE


class Table(NamedTuple):
    """All that is found of the storms of a grid.

    Attributes
    ----------
    heights, periods : (n,) and (m,) arrays
    headings : list
        rad; None for the scene's own.
    seeds : (s,) array
    status : (headings, periods, heights) array of str
    values : (limits, headings, periods, heights, seeds) array
        The largest or smallest of each storm.
    extremes : dict
        `FITTED` -> (limits, headings, periods, heights).
    allowable : (limits, headings, periods) array of Allowable
    done : (headings, periods, heights) array
        Number of storms that came to their end, each with a value for every limit.
    gravity : float
        That the waves have, m/s^2.
    """

    heights: np.ndarray
    periods: np.ndarray
    headings: Sequence[float | None]
    seeds: np.ndarray
    status: np.ndarray
    values: np.ndarray
    extremes: dict[str, np.ndarray]
    allowable: np.ndarray
    done: np.ndarray
    gravity: float = EARTH_GRAVITY

    @property
    def failed(self) -> list[tuple[int, ...]]:
        """Places of the sea states of which storms failed: heading, period, height."""
        return [at for at in np.ndindex(*self.status.shape) if self.status[at] == FAILED]


def governing(table: Table) -> np.ndarray:
    """Number of the limit that allows the least, (headings, periods); -1 where what one of them allows is not known.

    Of a table of one limit or more. Of equal heights one that was found counts before one that the grid bounds, and
    then that with the least low end.
    """
    heights, lows = (_read(table, name) for name in ("height", "low"))
    bounded = np.reshape([one.bound in UPWARDS for one in table.allowable.ravel()], heights.shape)
    least = np.lexsort((lows, bounded, heights), axis=0)[0]
    return np.where(np.isfinite(heights).all(axis=0), least, -1)


def of_all(table: Table) -> np.ndarray:
    """What all limits allow together, (headings, periods) of `Allowable`.

    Height and both ends are the least of all limits, each with its own bound: what is allowed with a limit more is
    never more, nor surer.
    """
    found = np.empty(table.allowable.shape[1:], object)
    for (i, j), k in np.ndenumerate(governing(table)):
        known = k >= 0
        found[i, j] = _least(table.allowable[:, i, j]) if known else Allowable(math.nan, math.nan, math.nan, UNKNOWN)
    return found


def _least(limits: Iterable[Allowable]) -> Allowable:
    limits = list(limits)
    ends = [
        min(pairs, key=lambda end: (end[0], end[1] in UPWARDS))
        for pairs in (
            [(one.height, one.bound) for one in limits], [(one.low, one.low_bound) for one in limits],
            [(one.high, one.high_bound) for one in limits],
        )
    ]  # fmt: skip
    middle, low, high = ends
    return Allowable(middle[0], low[0], high[0], middle[1], low[1], high[1])


def _read(table: Table, name: str) -> np.ndarray:
    """A number of all allowable heights, (limits, headings, periods)."""
    return np.array([getattr(one, name) for one in table.allowable.ravel()], float).reshape(table.allowable.shape)


def tabulate(
    rows: Any, conditions: Sequence[Condition], criteria: Sequence[Criterion], seeds: Sequence[int],
    ratio: float, share: float, confidence: float, compared: str, nothing: Collection[str] = (),
) -> Table:  # fmt: skip
    """Put the cases of a sweep into the grid of their sea states, fit, and find the allowable heights.

    Parameters
    ----------
    rows : xarray.Dataset
        Of the sweep, a case for each seed of each physical condition.
    ratio : float
        Duration that is asked about over that of the runs.
    share, confidence : float
        Percentile and confidence, 0 to 1.
    compared : str
        ``most_probable`` or ``percentile``: what is compared with the limits.
    nothing : collection of str
        Figures that are 0 of a storm without them: without slack there is no snap.
    """
    heights = np.array(sorted({one.height for one in conditions}))
    periods = np.array(sorted({one.period for one in conditions}))
    headings = list(dict.fromkeys(one.heading for one in conditions))
    shape = (len(headings), len(periods), len(heights))
    status = np.full(shape, ABSENT, object)
    values = np.full((len(criteria), *shape, len(seeds)), np.nan)
    extremes = {name: np.full((len(criteria), *shape), np.nan) for name in FITTED}
    done, number = rows["status"].values == "done", np.zeros(shape, int)
    case = 0
    for one in conditions:
        at = (
            headings.index(one.heading),
            int(np.searchsorted(periods, one.period)),
            int(np.searchsorted(heights, one.height)),
        )
        if not one.physical:
            status[at] = STEEP
            continue
        some = slice(case, case + len(seeds))
        case += len(seeds)
        good = done[some]
        for k, criterion in enumerate(criteria):
            found = rows[criterion.column].values[some] if criterion.column in rows else np.full(len(seeds), np.nan)
            if criterion.column in nothing:
                found = np.where(np.isnan(found), 0.0, found)
            values[(k, *at)] = np.where(good, found, np.nan)
            good = good & criterion.known(found)
        number[at] = good.sum()
        status[at] = FAILED if not good.all() else COMPUTED if good.size >= FEWEST else FEW
        for k, criterion in enumerate(criteria if status[at] == COMPUTED else ()):
            for name, value in fitted(values[(k, *at)], criterion, ratio, share, confidence).items():
                extremes[name][(k, *at)] = value
    return Table(
        heights, periods, headings, np.array(seeds), status, values, extremes,
        _allowables(criteria, heights, periods, headings, status, extremes, compared), number,
        conditions[0].gravity,
    )  # fmt: skip


def _allowables(
    criteria: Sequence[Criterion], heights: np.ndarray, periods: np.ndarray, headings: Sequence[Any],
    status: np.ndarray, extremes: dict[str, np.ndarray], compared: str,
) -> np.ndarray:  # fmt: skip
    found = np.empty((len(criteria), len(headings), len(periods)), object)
    for k, i, j in np.ndindex(*found.shape):
        run = (status[i, j] != STEEP) & (status[i, j] != ABSENT)
        bounds = [criteria[k].badness(extremes[f"{compared}{end}"][k, i, j][run]) for end in ("", "_low", "_high")]
        # A storm that did not come to its end is none to lift in.
        failed = status[i, j][run] == FAILED
        slack = (extremes["scale"][k, i, j] == 0.0) & (extremes["location"][k, i, j] == criteria[k].floor)
        slack = slack[run] & criteria[k].broken_by(criteria[k].floor)
        bounds = [np.where(failed | slack, np.inf, one) for one in bounds]
        low, high = np.minimum(bounds[1], bounds[2]), np.maximum(bounds[1], bounds[2])
        made = allowable(
            heights[run], bounds[0], low, high, float(criteria[k].badness(criteria[k].limit)), float(heights[-1]),
            criteria[k].strict,
        )  # fmt: skip
        found[k, i, j] = _mark_slack_bounds(made, heights[run], slack & ~failed)
        if not run.any():
            found[k, i, j] = Allowable(math.nan, math.nan, math.nan, UNKNOWN)
    return found


def _mark_slack_bounds(made: Allowable, heights: np.ndarray, slack: np.ndarray) -> Allowable:
    """Replace `STOPPED` by `SLACK`, or by `BELOW` at a height of 0, where slack ropes bound it, not failed runs."""
    ends = []
    for height, bound in ((made.height, made.bound), (made.low, made.low_bound), (made.high, made.high_bound)):
        after = heights > height
        if bound == STOPPED and after.any() and slack[np.argmax(after)]:
            bound = BELOW if height == 0.0 else SLACK
        ends.append(bound)
    return made._replace(bound=ends[0], low_bound=ends[1], high_bound=ends[2])


def steepest(periods: np.ndarray, gravity: float) -> np.ndarray:
    """Largest significant height of each period, m."""
    return np.array([highest(float(period), gravity) for period in periods])
