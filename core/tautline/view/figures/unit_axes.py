"""Other units on a figure that was drawn in SI: labels, ticks, headings and legends; the drawn data stay as they are.

Ticks stand where the other unit has round numbers. Units are read off the labels, ``hook load [MN]``, so whatever an
application draws is converted, and what has no other unit in the system (seconds, shares) is left alone.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator
from typing import Any

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, Locator, LogFormatterMathtext, LogLocator, MaxNLocator, NullFormatter

from tautline.scene.values.printed import converted, in_words

UNIT = re.compile(r"\[([^\[\]]+)\]$")


class UnitLocator(Locator):
    """Places, in SI, where another unit, ``factor`` of which make one of SI, has round numbers."""

    def __init__(self, rounds: MaxNLocator | LogLocator, factor: float) -> None:
        self.rounds, self.factor = copy.copy(rounds), factor

    def set_axis(self, axis: Any) -> None:
        """Belong to an axis."""
        super().set_axis(axis)
        self.rounds.set_axis(axis)

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Ticks between two places."""
        return self.rounds.tick_values(vmin * self.factor, vmax * self.factor) / self.factor

    def __call__(self) -> Any:
        """Ticks of the axis as it is."""
        assert self.axis is not None
        return self.tick_values(*sorted(self.axis.get_view_interval()))


def use_units(figure: Figure, system: str) -> Figure:
    """Convert all axes of a figure to the units of a system, colour bars among them; returns it.

    An axis without a label has the unit of the others of its direction, if they agree: of several panels in a row the
    first may have the label.
    """
    for which in ("xaxis", "yaxis"):
        axes: list[Axis] = [getattr(plot, which) for plot in figure.axes]
        words = {found[1] for axis in axes if (found := UNIT.search(axis.get_label_text()))}
        for axis in axes:
            _convert(axis, next(iter(words)) if len(words) == 1 else "", system)
    for plot in figure.axes:
        for place in ("left", "center", "right"):
            if text := plot.get_title(loc=place):
                plot.set_title(in_words(text, system), loc=place, fontsize=plot.title.get_fontsize())
    for words in _words_beside_curves(figure):
        words.set_text(in_words(words.get_text(), system))
    return figure


def _words_beside_curves(figure: Figure) -> Iterator[Text]:
    """Texts of the legends of a figure and of its panels, and those that stand within the panels."""
    legends = [*figure.legends, *(plot.get_legend() for plot in figure.axes)]
    for legend in legends:
        if legend is not None:
            yield from (legend.get_title(), *legend.get_texts())
    for plot in figure.axes:
        yield from plot.texts


def _convert(axis: Axis, usual: str, system: str) -> None:
    text = axis.get_label_text()
    found = UNIT.search(text)
    if (text and not found) or not (found or usual):
        return
    # Across a bar of colours there are neither label nor ticks.
    if not text and not len(axis.get_majorticklocs()):
        return
    # A bar of colours that lifts what is weak has a function for a scale.
    if axis.get_scale() not in ("linear", "function", "log"):
        return
    low, high = axis.get_view_interval()
    size = max(abs(low), abs(high)) or 1.0
    value, name = converted(size, found[1] if found else usual, system)
    if found:
        axis.set_label_text(in_words(text[: found.start()], system) + f"[{name}]")
    factor = value / size
    # Panels that share an axis share its ticks, which the first of them converts; each has a label of its own.
    if factor == 1.0 or isinstance(axis.get_major_locator(), UnitLocator):
        return
    if axis.get_scale() == "log":
        axis.set_major_locator(UnitLocator(LogLocator(), factor))
        axis.set_minor_locator(UnitLocator(LogLocator(subs="auto"), factor))
        powers = LogFormatterMathtext()
        axis.set_major_formatter(FuncFormatter(lambda place, _: powers(float(f"{place * factor:.9g}"))))
        axis.set_minor_formatter(NullFormatter())
        return
    rounds = axis.get_major_locator()
    axis.set_major_locator(UnitLocator(rounds if isinstance(rounds, MaxNLocator) else MaxNLocator("auto"), factor))
    axis.set_major_formatter(FuncFormatter(lambda place, _: _round(place * factor)))


def _round(value: float) -> str:
    return f"{round(value, 9):.10g}".replace("-", "\N{MINUS SIGN}")
