"""One row of data: what all columns show at a stamp."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Row:
    """Values (c,) of all columns at a stamp, NaN where there is none; ``raw`` and ``stamp`` are what the source gave.

    ``places`` are those of its records among all that the source gives; one that is ``new`` is known to repeat none.
    ``repeated`` (c,) are columns whose readings are those of before, which held as nothing else was sent.
    The data of now ``begin`` with one of a live source where those before it were old when they came.
    """

    time: float
    values: np.ndarray
    arrived: float = 0.0
    after_gap: bool = False
    places: list[int] = field(default_factory=list)
    joined: bool = False
    new: bool = False
    begins: bool = False
    repeated: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))
    raw: np.ndarray = field(init=False, compare=False)
    stamp: float = field(init=False, compare=False)

    def __post_init__(self) -> None:
        self.raw, self.stamp = self.values.copy(), self.time
        if not len(self.repeated):
            self.repeated = np.zeros(len(self.values), bool)

    @property
    def measured(self) -> np.ndarray:
        """Columns (c,) with readings that were measured at this stamp."""
        return np.isfinite(self.values) & ~self.repeated

    def fill(self, other: Row) -> None:
        """Take readings of another row for what is empty here, and true ones for those that are repeated."""
        mine = np.isfinite(self.values) & ~(self.repeated & other.measured)
        self.values = np.where(mine, self.values, other.values)
        self.repeated = np.where(mine, self.repeated, other.repeated)
