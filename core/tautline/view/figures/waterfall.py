"""Waterfalls: what runs along a slender thing, as colours over time and length."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, title
from tautline.view.figures.figure import BOTH_WAYS, SHADES, Figure, axes, label, scale, styled

SIGNED = 0.02
"""Share of the largest magnitude which the other sign must have for a range to count as signed."""

USUAL = 99.5
"""Percentile of the values that the colours reach to, where the largest is more than twice of that."""


def edges_of(middles: np.ndarray) -> np.ndarray:
    """Edges of cells about points (n,): halfway between them, and as far beyond the outer ones, (n + 1,)."""
    if len(middles) == 1:
        return middles[0] + np.array([-0.5, 0.5])
    between = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate([[2.0 * middles[0] - between[0]], between, [2.0 * middles[-1] - between[-1]]])


@styled
def waterfall_figure(
    result: Result,
    values: np.ndarray,
    edges: np.ndarray,
    words: tuple[str, str],
    along: tuple[str, str],
    downwards: bool = False,
) -> Figure:
    """Draw values over time and length as an image.

    Parameters
    ----------
    values : (frames, n) array
        Of the n cells.
    edges : (n + 1,) array
        Of the cells along the thing, rising.
    words, along : (str, str)
        Text and unit of the values, and of the length.
    downwards : bool
        Whether the length grows downwards, as a depth does.

    Raises
    ------
    NothingToShow
        If there is one frame.
    """
    time = result.time
    if len(time) < 2:
        raise NothingToShow(result, "one frame: nothing changes in it")
    # A blow of one frame must not leave all the rest in the dark.
    usual, largest = float(np.percentile(values, USUAL)), float(values.max())
    rare: dict[str, Any] = {}
    text = words[0]
    if values.min() >= 0.0 and 0.0 < 2.0 * usual < largest:
        by, of = scale([values], words[1])
        largest, rare, text = usual, {"extend": "max"}, f"{text}, at most {largest / by:.3g} {of}".rstrip()
    factor, unit = scale([np.minimum(values, largest)], words[1])
    figure, plots = axes(1, 1, 8.6, 4.8, title([result]))
    plot = plots[0, 0]
    colours, low, high = _colours_of(float(values.min()) / factor, largest / factor)
    frames = np.concatenate([time[:1], 0.5 * (time[1:] + time[:-1]), time[-1:]])
    image = plot.pcolorfast(frames, edges, values.T / factor, cmap=colours, vmin=low, vmax=high)
    plot.grid(False)
    plot.set_xlim(frames[0], frames[-1])
    first = 0.0 if 0.0 < edges[0] < 0.02 * edges[-1] else edges[0]
    plot.set_ylim(*((edges[-1], first) if downwards else (first, edges[-1])))
    plot.set_xlabel(label("time", "s"))
    plot.set_ylabel(label(*along))
    bar = figure.colorbar(image, ax=plot, aspect=30, pad=0.02, **rare)
    bar.set_label(label(text, unit or "–"))
    bar.outline.set_visible(False)
    return figure


def _colours_of(low: float, high: float) -> tuple[Any, float, float]:
    """The colours of values from `low` to `high`, and the range that they cover: a wider one where all are equal."""
    size = max(abs(low), abs(high))
    colours = SHADES
    if min(-low, high) > SIGNED * size:
        # White stays at zero, and equal colours mean equal amounts either way.
        ends = 0.5 + 0.5 * np.array([low, high]) / size
        colours = BOTH_WAYS.resampled(512)
        colours = type(BOTH_WAYS).from_list("part", colours(np.linspace(ends[0], ends[1], 256)))
    if high - low <= 1e-9 * size or size == 0.0:
        low, high = low - (0.1 * size or 1.0), high + (0.1 * size or 1.0)
    return colours, low, high
