"""Ways of points that go around something: coloured by time, and the amplitudes of their circles."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import PowerNorm

from tautline.view.figures.figure import SHADES, Axes, Figure


def draw_path(plot: Axes, time: np.ndarray, x: np.ndarray, y: np.ndarray) -> Any:
    """Draw a path, from dark to bright as time goes on, and return what a bar of colours can be made of.

    Parameters
    ----------
    time, x, y : (m,) array
    """
    points = np.stack([x, y], axis=1)
    path = LineCollection(np.stack([points[:-1], points[1:]], axis=1).tolist(), cmap=SHADES, lw=0.9)
    path.set_array(time[:-1])
    plot.add_collection(path)
    return path


def draw_amplitudes(plot: Axes, time: np.ndarray, frequency: np.ndarray, amplitude: np.ndarray) -> Any:
    """Draw spectra over time as shades, the weak ones lifted; returns what a bar of colours can be made of.

    Parameters
    ----------
    time : (w,) array
    frequency : (k,) array
    amplitude : (k, w) array
        NaN where nothing is to be drawn.
    """
    norm = PowerNorm(0.5, 0.0, float(np.nanmax(amplitude, initial=0.0)) or 1.0)
    return plot.pcolormesh(time, frequency, amplitude, cmap=SHADES.reversed(), norm=norm, rasterized=True)


def bar_beside(figure: Figure, plot: Axes, colours: Any, text: str) -> None:
    """Put a bar of colours beside a plot."""
    bar = figure.colorbar(colours, ax=plot, aspect=30, pad=0.02)
    bar.set_label(text)
    bar.outline.set_visible(False)
