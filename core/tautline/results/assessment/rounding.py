"""Figures that are no more than the rounding of what they are made of read 0: a string at rest has no speed of 1e-13.

A coordinate of size x is known to eps x. What is a difference of coordinates is known no better, and a method that
finds its velocities from positions, a step h apart, knows them to eps x / h. Both are small beside anything that a
figure tells, but not beside 0; a real small motion is larger, for a step has to be able to move something.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

ROUNDED = 32.0 * float(np.finfo(float).eps)
"""Rounding of a figure over the size of what it is a difference of: some tens of operations."""
FARTHEST = 1.0e9
"""No place of a scene is farther away, m."""
PLACES = ("position", "measured_depth", "well_position")
"""Variables of results that say where things are, m."""


def unrounded(value: Any, scale: float) -> Any:
    """A number, or each of a list, with 0 in the place of what rounding makes of numbers as large as ``scale``."""
    if isinstance(value, (list, tuple)):
        return [unrounded(item, scale) for item in value]
    if isinstance(value, float) and abs(value) <= ROUNDED * scale:
        return 0.0
    return value


def without_rounding(headline: Mapping[str, Mapping[str, Any]], result: Any, step: float) -> dict[str, dict[str, Any]]:
    """Figures of a run (name -> value, unit, text), lengths and speeds that are rounding read 0.

    Parameters
    ----------
    headline : mapping
        SI.
    result : Result
        Of which they are.
    step : float
        Mean step, s.
    """
    per_metre = {"m": 1.0, "m/s": 1.0 / step if step > 0.0 else 0.0}
    # Places need not be known, which may have to be made for it, where every figure is far larger than their rounding.
    could_be = any(
        unrounded(figure["value"], FARTHEST * per_metre[figure["unit"]]) != figure["value"]
        for figure in headline.values()
        if figure.get("unit") in per_metre
    )
    size = 0.0
    if could_be:
        size = max((float(np.abs(result[name]).max(initial=0.0)) for name in PLACES if name in result), default=0.0)
    scales = {unit: size * factor for unit, factor in per_metre.items()}
    return {
        name: {**figure, "value": unrounded(figure["value"], scales.get(str(figure.get("unit")), 0.0))}
        for name, figure in headline.items()
    }
