"""Whether extremes of shorter storms may be scaled to a longer time: they may not where they grow while storms last."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from crane.operability.asked import Asked
from crane.operability.criteria import Criterion
from tautline.scene.values.printed import shown
from tautline.statistics.trends import CERTAIN, TREND, grows

FELT = 0.05
"""Share of what is left to a limit below which it is no matter what grows, were it to go on all the time."""


def trends_of(criteria: Sequence[Criterion]) -> dict[str, str]:
    """Columns of extremes that are scaled -> which extreme they are."""
    return {one.column: "largest" if one.way > 0.0 else "smallest" for one in criteria if one.extreme}


def growing_notes(data: Any, asked: Asked, criteria: Sequence[Criterion], system: str) -> list[str]:
    """What grows in storms that are scaled, and by how much: scaled values of it are too mild.

    Parameters
    ----------
    data : Dataset
        Of the sweep, with the trends that `trends_of` asks for; nothing is told where it has none.
    """
    states = sum(one.physical for one in asked.conditions)
    return list(_growing(data, (states, len(asked.seeds)), asked, criteria, system))


def _growing(
    data: Any, shape: tuple[int, int], asked: Asked, criteria: Sequence[Criterion], system: str
) -> Iterator[str]:
    done = data["status"].values.reshape(shape) == "done"
    for one in criteria:
        if f"{one.column}{TREND}" not in data:
            continue
        values, slopes = (
            np.where(done, np.asarray(data[name].values, float).reshape(shape), math.nan)
            for name in (one.column, f"{one.column}{TREND}")
        )
        slopes = one.way * slopes
        state = _told_of(values, slopes, one, asked.duration / asked.simulated)
        if state is None or not grows(slopes):
            continue
        change = shown(float(np.nanmean(slopes[state])), one.unit, system)
        worst = shown(_worst(values[state], one), one.unit, system)
        yield (
            f"limit '{one.text}': {one.name} gets worse while a storm lasts, by {change} in the mean from the first "
            f"sixth of its time to the last, where the worst is {worst}. So there is no steady state, and what is "
            f"scaled from {asked.simulated:g} s to {asked.duration:g} s is too mild. A load that swings "
            f"undamped does this, or one that is always hoisted. Take --simulate {asked.duration:g}s: values of "
            f"storms as long as --duration need no steady state. (Told with {100.0 * CERTAIN:g} % confidence of one "
            "side)"
        )


def _told_of(values: np.ndarray, slopes: np.ndarray, one: Criterion, ratio: float) -> int | None:
    """The state, of (states, seeds) values and slopes, whose growth is most of what is left to the limit, or beyond it.

    None where it is next to nothing of that in all states, were it to go on all the time.
    """
    shares = []
    for k in range(len(values)):
        known = np.isfinite(slopes[k])
        away = abs(one.limit - _worst(values[k], one)) if known.any() else math.inf
        grown = float(slopes[k][known].mean()) * ratio if known.any() else 0.0
        shares.append(grown / away if away > 0.0 else math.inf if grown > 0.0 else 0.0)
    state = int(np.argmax(shares))
    return state if shares[state] > FELT else None


def _worst(values: np.ndarray, one: Criterion) -> float:
    """The worst value of the storms of a state, as it is collected."""
    return float(np.nanmax(values) if one.way > 0.0 else np.nanmin(values))
