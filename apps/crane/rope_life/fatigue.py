"""Tension ranges that tire a rope: rainflow cycles of a history, and the one range that does the same damage.

Counting is that of ASTM E1049-85, section 5.4.4, by the `rainflow` package: closed cycles count one, and the ranges
that are left at the end of a run one half each.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crane.rope_life.events import checked
from tautline.errors import ArgumentError

SLOPE = 5.0
"""Exponent m of the S-N curve of wire ropes, by which tensions and their ranges are weighed."""


@dataclass(frozen=True, eq=False)
class RainflowCycles:
    """Cycles of a history, largest range first; all arrays of length 0 where nothing varies."""

    range: np.ndarray
    """(n,) N, positive."""
    mean: np.ndarray
    """(n,) N, half-way between the cycle's extremes."""
    count: np.ndarray
    """(n,), 1 for a closed cycle and 0.5 for a half."""
    begin: np.ndarray
    """(n,) s, when the earlier of its extremes is; of equal neighbours, the last."""
    end: np.ndarray
    """(n,) s, when the later is."""


def rainflow_counts(time: np.ndarray, tension: np.ndarray, least: float = 0.0) -> RainflowCycles:
    """Rainflow cycles of a tension.

    Parameters
    ----------
    time : (m,) array
        Times of the frames, s, in order. What happens between frames is not seen.
    tension : (m,) array
        N.
    least : float
        Ranges not above it are counted but left out of the table, N; the others do not change.

    Raises
    ------
    ArgumentError
        Where there is no frame, times fall, or a number is not finite.
    """
    from rainflow import extract_cycles

    time, tension = checked(time, tension=tension)
    if tension.ndim != 1:
        raise ArgumentError(f"tension: shape {tension.shape}; cycles are those of one history, (m,)")
    # The package takes the end of a history from its third sample on; one more that changes nothing makes up for it.
    samples = [*tension.tolist(), float(tension[-1])]
    found = [cycle for cycle in extract_cycles(samples) if cycle[0] > least]
    found.sort(key=lambda cycle: (-cycle[0], cycle[3]))
    table = np.array(found, float).reshape(-1, 5)
    begin, end = (time[np.minimum(table[:, k].astype(int), len(time) - 1)] for k in (3, 4))
    return RainflowCycles(table[:, 0], table[:, 1], table[:, 2], begin, end)


def equivalent_range(cycles: RainflowCycles, slope: float, count: float | None = None) -> float:
    """Constant range that does the damage of all cycles, after Palmgren and Miner: (sum n S^m / N)^(1/m).

    Parameters
    ----------
    cycles : RainflowCycles
    slope : float
        Exponent m of the S-N curve, N S^m = constant, above 0; mean tension is not allowed for.
    count : float, optional
        Number of cycles N of the constant range; that of `cycles` by default.

    Returns
    -------
    float
        N; 0 where nothing varies.

    Raises
    ------
    ArgumentError
        Where slope or count is not above 0 and finite.
    """
    number = float(cycles.count.sum()) if count is None and cycles.count.size else count
    for name, value in (("slope", slope), ("count", 1.0 if number is None else number)):
        if not (np.isfinite(value) and value > 0.0):
            raise ArgumentError(f"{name} = {value}: must be finite and above 0")
    if number is None or cycles.range.size == 0:
        return 0.0
    # In shares of the largest range no power overflows.
    largest = float(cycles.range.max())
    return largest * float(((cycles.count * (cycles.range / largest) ** slope).sum() / number) ** (1.0 / slope))
