"""Figures that every application has: energies and their balance, and spectra of what swings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, names, over_time, title
from tautline.view.figures.drawings import Drawing
from tautline.view.figures.figure import (
    COLOURS,
    STYLES,
    Figure,
    axes,
    colour,
    label,
    legend_above,
    sample_line,
    scale,
    shortened,
    styled,
    widen,
)
from tautline.view.figures.spectrum import LOBE, largest_line, late_spectrum

Panels = Mapping[tuple[str, str], Sequence[tuple[str, np.ndarray] | None]]
"""Text and unit of a panel -> of each result, a name and a history (frames,); None where a result has none."""

ENERGIES = {
    "kinetic_energy": "kinetic",
    "strain_energy": "strain",
    "potential_energy": "potential",
    "dissipated_energy": "dissipated",
    "external_work": "work from outside",
}
LEAST_CHANGE = 1e-8
"""Share of the largest energy below which its changes, and what is missing from their balance, are rounding."""
DECADES = 5
"""That a spectrum shows."""
LEAST_LINE = 1e-9
"""Share of a signal's size below which what swings is rounding."""
SHARE = 0.5
"""Of a run, at its end, that a spectrum is taken of."""
FEWEST_FRAMES = 16
"""Of a spectrum, which would show nothing but its window."""


def energies(words: str = ENERGIES["external_work"], together: bool = True) -> Drawing:
    """Figure of energies; `words` say what does work on the scene from outside."""

    def make(results: Sequence[Result]) -> Figure:
        return energy_figure([getattr(run, "result", run) for run in results], words)

    return Drawing("energies and their balance", make, together)


@styled
def energy_figure(results: Sequence[Result], words: str) -> Figure:
    """Changes of the energies since the start, and what is missing from their balance."""
    changes = [{name: result[name] - result[name][0] for name in ENERGIES if name in result} for result in results]
    for result, change in zip(results, changes, strict=True):
        if not change:
            raise NothingToShow(result, "no energies")
    figure, plots = axes(2, 1, 8.0, 5.6, title(results), sharex=True, height_ratios=(2.2, 1.0))
    upper, lower = plots[:, 0]
    size = max(float(np.abs(result[name]).max()) for result, c in zip(results, changes, strict=True) for name in c)
    least = np.array([LEAST_CHANGE * size or 1e-3])
    factor, unit = scale([least, *(values for change in changes for values in change.values())], "J")
    balances = [sum(values if name != "external_work" else -values for name, values in c.items()) for c in changes]
    small, small_unit = scale([least, *balances], "J")
    texts = ENERGIES | {"external_work": words}
    for run, (result, change) in enumerate(zip(results, changes, strict=True)):
        look = {"ls": STYLES[run % len(STYLES)]} | marker(result.time)
        for number, (name, values) in enumerate(change.items()):
            text = texts[name] if run == 0 else None
            upper.plot(result.time, values / factor, color=COLOURS[number], label=text, **look)
        lower.plot(result.time, balances[run] / small, color=COLOURS[6], **look)
    whole = np.concatenate([values for change in changes for values in change.values()])
    widen(upper, whole / factor, float(least[0]) / factor)
    widen(lower, np.concatenate(balances) / small, float(least[0]) / small)
    upper.set_ylabel(label("change since the start", unit))
    lower.set_ylabel(label("balance error", small_unit))
    legend_above(upper)
    if len(results) > 1:
        lines = [sample_line(name, color="black", ls=STYLES[k % len(STYLES)]) for k, name in enumerate(names(results))]
        lower.legend(handles=lines, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return over_time(figure, plots, [result.time for result in results])


@styled
def spectrum_figure(results: Sequence[Result], panels: Panels) -> Figure:
    """Amplitude spectra of the second half of runs, about a straight line; the largest line is named.

    The window is that of Blackman and Harris: it makes a line four times as wide as one over the time looked at.

    Parameters
    ----------
    panels : Panels
        What swings.

    Raises
    ------
    NothingToShow
        If a result has too few frames, or nothing swings.
    """
    for result in results:
        if len(result.time) < FEWEST_FRAMES:
            raise NothingToShow(result, f"{len(result.time)} frames, too few for a spectrum")
    found = [
        [
            (k, *made, *late_spectrum(results[k].time, made[1], SHARE))
            for k, made in enumerate(histories)
            if made is not None
        ]
        for histories in panels.values()
    ]
    shown = [
        (head, lines)
        for head, lines in zip(panels, found, strict=True)
        if any(size.max() > LEAST_LINE * np.abs(signal).max() for _, _, signal, _, size in lines)
    ]
    if not shown:
        raise NothingToShow(results[0], "nothing that swings")
    heading = title(results, f"spectrum of {_half_of(results)}")
    figure, plots = axes(len(shown), 1, 8.0, 3.2 * len(shown) + 0.9, heading, sharex=True)
    widest = 0.0
    for plot, ((text, unit), lines) in zip(plots[:, 0], shown, strict=True):
        factor, unit = scale([size for *_, size in lines], unit)
        top = max(float(size.max()) for *_, size in lines) / factor
        for run, name, signal, frequency, size in lines:
            swings = size.max() > LEAST_LINE * np.abs(signal).max()
            largest = largest_line(size) if swings else None
            words = (
                f"{shortened(name)}: {_named(frequency, size / factor, unit, largest) if swings else 'does not swing'}"
            )
            words = words if len(results) == 1 else f"{names(results)[run]}, {words}"
            look = {"color": colour(run, len(results)), "lw": 1.1}
            plot.semilogy(frequency[1:], np.maximum(size[1:] / factor, 1e-300), label=words, **look)
            if largest is not None:
                plot.plot(frequency[largest], size[largest] / factor, marker="v", ms=6, ls="", color=look["color"])
            widest = max(widest, float(frequency[size / factor > top * 10.0**-DECADES].max(initial=0.0)))
        plot.set_ylim(top * 10.0**-DECADES, 3.0 * top)
        plot.set_ylabel(label(f"amplitude of\n{text}", unit))
        legend_above(plot, 2)
    plots[-1, 0].set_xlabel(label("frequency", "Hz"))
    plots[-1, 0].set_xlim(0.0, widest)
    figure.align_ylabels(plots[:, 0])
    return figure


def _half_of(results: Sequence[Result]) -> str:
    """Which part of runs a spectrum is of, in words."""
    parts = {
        f"{result.time[-1] - SHARE * (result.time[-1] - result.time[0]):.4g} to {result.time[-1]:.4g} s"
        for result in results
    }
    return f"the second half, {parts.pop()}" if len(parts) == 1 else "the second half of each"


def _named(frequency: np.ndarray, size: np.ndarray, unit: str, largest: int | None) -> str:
    """What a legend says of a spectrum's largest line."""
    slowest = frequency[min(LOBE, len(frequency) - 1)]
    if largest is None:
        return f"slower than {slowest:.2g} Hz, the run is too short to tell it from drift"
    slower = f", largest above {slowest:.2g} Hz" if size[: LOBE + 1].max() > size[largest] else ""
    return f"{size[largest]:.3g} {unit} at {frequency[largest]:.3g} Hz{slower}"
