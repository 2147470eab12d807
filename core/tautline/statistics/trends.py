"""Whether the extremes of a run grow while it lasts: those of parts of equal length, and a straight line through them.

Extremes of a longer time follow from those of a shorter one in a steady state alone. A load that swings undamped, or is
hoisted all the time, has none: the largest of its later parts is larger. Of a steady state the line has no slope but
for chance, and what chance does is seen in the slopes of independent runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from tautline.results.tables.finding import Finding

TREND = " trend"
"""Ends the name of the trend of an extreme."""
PARTS = 6
"""Of a run. By more of them no more is found of a swing that grows as the square root of the time."""
LARGEST = "largest"
CERTAIN = 0.975
"""Confidence, on one side, with which a slope is told: of steady states one in forty is taken for one that grows."""


class Trends:
    """The trends of extremes in a run, over the time that counts.

    Parameters
    ----------
    names : mapping
        Name of a figure or of a column of an output -> ``largest`` or ``smallest``.
    begin, end : float
        Of the time that counts, s.
    """

    def __init__(self, names: Mapping[str, str], begin: float, end: float) -> None:
        self.names, self.edges = names, np.linspace(begin, end, PARTS + 1)
        # A frame at the end of the run is of its last part.
        self.edges[-1] = math.inf
        self.parts: dict[str, np.ndarray] = {}

    def watch(self, model: Any) -> None:
        """Have the figures of a model found in each part of its run, too, where any is asked for.

        A result that keeps statistics asks for figures of its frames as they come, piece by piece.
        """
        figures = model.figures
        if not self.names or figures is None:
            return

        def with_parts(result: Any, names: Collection[str]) -> dict[str, dict[str, Any]]:
            self._look(result, figures)
            found: dict[str, dict[str, Any]] = figures(result, names)
            return found

        model.figures = with_parts

    def _look(self, result: Any, figures: Callable[..., Mapping[str, Mapping[str, Any]]]) -> None:
        time = np.asarray(result.time)
        wanted = tuple(self.names)
        part = np.searchsorted(self.edges * (1.0 - 1e-12), time, side="right") - 1
        for k in np.unique(part[part >= 0]):
            found = figures(result.from_time(self.edges[k], self.edges[k + 1]), wanted)
            for name, way in self.names.items():
                if name in found:
                    self._join(name, int(k), float(found[name]["value"]), way)

    def _join(self, name: str, k: int, value: float, way: str) -> None:
        parts = self.parts.setdefault(name, np.full(PARTS, math.nan))
        parts[k] = (np.fmax if way == LARGEST else np.fmin)(parts[k], value)

    def findings(
        self, found: Mapping[str, Finding], outputs: Mapping[str, tuple[np.ndarray, np.ndarray]]
    ) -> dict[str, Finding]:
        """Name and trend of each extreme that was found in every part.

        Parameters
        ----------
        found : mapping
            All findings of the run: units.
        outputs : mapping
            Name of a column of an output -> its values and times, s, at all frames that count, (m,) each.
        """
        made = {}
        for name, way in self.names.items():
            if name not in found or not (name in self.parts or name in outputs):
                continue
            parts = self._of_output(*outputs[name], way) if name in outputs else self.parts[name]
            text = f"change of {name} from the first sixth of the time to the last"
            made[f"{name}{TREND}"] = Finding(trend(parts), found[name].unit, text)
        return made

    def _of_output(self, values: np.ndarray, time: np.ndarray, way: str) -> np.ndarray:
        """The extremes of parts, (PARTS,), of values at times, (m,); nan of parts without a frame."""
        part = np.searchsorted(self.edges * (1.0 - 1e-12), time, side="right") - 1
        worst = np.max if way == LARGEST else np.min
        return np.array([worst(values[part == k]) if (part == k).any() else math.nan for k in range(PARTS)])


def trend(parts: np.ndarray) -> float:
    """Change along the line of least squares through values (n,) of parts, from the first to the last; nan without."""
    if not np.isfinite(parts).all():
        return math.nan
    x = np.linspace(-0.5, 0.5, len(parts))
    # Numbers near the largest there are overflow in a sum, and not in one of shares.
    size = float(np.abs(parts).max()) or 1.0
    return float(parts / size @ x / (x @ x)) * size


def grows(slopes: np.ndarray, certain: float = CERTAIN) -> bool:
    """Whether slopes are above zero by more than chance, by Student's t of independent runs.

    Parameters
    ----------
    slopes : (states, runs) array
        Slopes in several states; those of a run in all states hang together. nan or inf where there is none.
    certain : float
        Confidence, on one side.
    """
    from scipy.stats import t as student

    slopes = np.where(np.isfinite(slopes), slopes, math.nan)
    slopes = slopes[np.isfinite(slopes).any(axis=1)]
    largest = np.nanmax(np.abs(slopes), axis=1, keepdims=True, initial=0.0)
    # Squares of shares of the largest do not overflow.
    scaled = slopes[largest[:, 0] > 0.0] / largest[largest[:, 0] > 0.0]
    scaled = scaled / np.sqrt(np.nanmean(scaled**2, axis=1, keepdims=True))
    scaled = scaled[:, np.isfinite(scaled).any(axis=0)]
    if scaled.shape[0] == 0 or scaled.shape[1] < 2:
        return False
    of_runs = np.nanmean(scaled, axis=0)
    error = float(of_runs.std(ddof=1)) / math.sqrt(of_runs.size)
    return float(of_runs.mean()) > float(student.ppf(certain, of_runs.size - 1)) * error
