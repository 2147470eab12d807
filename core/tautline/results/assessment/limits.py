"""What a run is judged by: the worst of a quantity over all stored frames, against a limit, with time and place.

A record is a dict of ``name``, ``text`` (what it is, in words), ``unit``, ``sense`` (``at most`` or ``at least``),
``limit``, ``value``, ``passed``, ``time`` s and ``place``. Values are those of the frames that are kept: what happens
between two frames is not seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

AT_MOST, AT_LEAST = "at most", "at least"
STRETCH = (0.5, 2.0)
"""Length over unstretched length, |r'|, outside of which an element is folded or overstretched."""
STRAIN, STEEL_STRAIN, ANY_STRAIN = 0.05, 0.02, 0.2
"""Strain that no hoisting rope bears; that none of steel does, whose wires break at about that; and that hardly any
cable does: ropes of nylon break at 0.15 to 0.3."""
STEEL = 4.0e10
"""Young's modulus, Pa, from which a rope or pipe is taken for one of metal: wire rope has 50 to 130 GPa."""


def judged(
    name: str,
    text: str,
    unit: str,
    time: np.ndarray,
    values: np.ndarray,
    limit: float | np.ndarray,
    places: Sequence[str],
    sense: str = AT_MOST,
) -> dict[str, Any]:
    """The record of a limit: of the place and time at which it is exceeded by most, or most nearly met.

    Parameters
    ----------
    name, text, unit : str
        Key, what it is in words, and SI unit.
    time : (m,) array
        Of the frames, s.
    values : (m, n) array
        At every place.
    limit : float or (n,) array
        Of all places, or of each; greater than zero. Infinite where there is none.
    places : sequence of str
        Names of the n places.
    sense : str
        `AT_MOST` or `AT_LEAST`.
    """
    values = np.asarray(values, float)
    limits = np.broadcast_to(np.asarray(limit, float), values.shape[1:])
    worst = values / limits
    k = int(np.argmax(worst) if sense == AT_MOST else np.argmin(worst))
    i, j = divmod(k, values.shape[1])
    value, bound = float(values[i, j]), float(limits[j])
    # What is at its limit but for rounding has kept it.
    passed = value <= bound * (1.0 + 1e-9) if sense == AT_MOST else value >= bound * (1.0 - 1e-9)
    return {
        "name": name, "text": text, "unit": unit, "sense": sense, "limit": bound, "value": value, "passed": passed,
        "time": float(time[i]), "place": places[j],
    }  # fmt: skip


def stretch_limits(time: np.ndarray, stretch: np.ndarray, places: Sequence[str]) -> list[dict[str, Any]]:
    """Records of |r'|, (m, n), which is to stay between the two of `STRETCH`; none where there is no place."""
    if stretch.size == 0:
        return []
    low, high = STRETCH
    return [
        judged(
            "least_stretch",
            "smallest stretch, length over unstretched length",
            "",
            time,
            stretch,
            low,
            places,
            AT_LEAST,
        ),
        judged("most_stretch", "largest stretch, length over unstretched length", "", time, stretch, high, places),
    ]


def strain_limit(
    time: np.ndarray, strain: np.ndarray, limit: float | np.ndarray, places: Sequence[str]
) -> list[dict[str, Any]]:
    """Record of tension over EA, (m, n), which is the strain where that is small; none where there is no place."""
    if strain.size == 0:
        return []
    return [judged("strain", "largest tension / EA", "", time, np.maximum(strain, 0.0), limit, places)]
