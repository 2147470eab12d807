"""Colours of quantities, the same in windows, films and web pages."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.colors import LinearSegmentedColormap

from tautline.results.errors import ResultError
from tautline.view.figures.figure import SHADES, scale_in
from tautline.view.space.appearance import Appearance

SHADE_COUNT = 256

EITHER_SIGN = LinearSegmentedColormap.from_list("sign", ["#123C9C", "#4F7FD0", "#949494", "#E0685A", "#A80F1F"])
"""Colours of what has either sign: as dark in the middle as a thin line needs on white paper."""


class Shading(NamedTuple):
    """How a quantity is coloured.

    Attributes
    ----------
    name : str
        Of the quantity.
    title : str
        Of the legend: ``tension [kN]``.
    unit : str
        In the title.
    factor : float
        What SI values are divided by for the legend's unit.
    low, high : float
        Ends of the legend, in its unit.
    table : (256, 3) array of uint8
        Colours from low to high.
    """

    name: str
    title: str
    unit: str
    factor: float
    low: float
    high: float
    table: np.ndarray


def table(low: float, high: float, signed: bool) -> np.ndarray:
    """Colours from low to high, (256, 3) uint8; of what has either sign zero is grey, and both sides are to scale."""
    share = np.linspace(0.0, 1.0, SHADE_COUNT)
    if signed:
        share = 0.5 + 0.5 * (low + (high - low) * share) / max(-low, high)
    return (255.0 * (EITHER_SIGN if signed else SHADES)(share)[:, :3]).round().astype(np.uint8)


def shading(appearance: Appearance, asked: str | None) -> Shading | None:
    """Choose what colours the lines.

    Parameters
    ----------
    asked : str or None
        Name of a quantity, ``none`` for plain lines; None for the first that there is.

    Raises
    ------
    ResultError
        If no line has that quantity.
    """
    known = appearance.quantities
    if asked == "none" or (asked is None and not known):
        return None
    name = next(iter(known)) if asked is None else asked
    if name not in known:
        raise ResultError("--colour", f"nothing here has '{name}'", f"known: {', '.join([*known, 'none'])}")
    found = known[name]
    low, high = min(one.low for one in found), max(one.high for one in found)
    signed = any(one.signed for one in found)
    factor, unit = scale_in(appearance.units, [np.array([low, high])], found[0].unit)
    low, high = low / factor, high / factor
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = 0.01 * abs(low) or 1.0
        low, high = low - room, high + room
    text = f"{found[0].text} [{unit}]" if unit else found[0].text
    return Shading(name, text, unit, factor, low, high, table(low, high, signed))
