"""Record arrays as groups keep them: a row for each member, a column for each of its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def records(count: int, dtype: np.dtype, **columns: ArrayLike) -> np.recarray:
    """Record array of ``count`` rows with the named columns filled in, the others zero."""
    rows = np.zeros(count, dtype)
    for name, values in columns.items():
        rows[name] = values
    return rows.view(np.recarray)


def records_of(dtype: np.dtype, rows: Sequence[Mapping[str, Any]]) -> np.recarray:
    """Record array of rows that all name the same columns; the others are zero."""
    names = rows[0] if rows else ()
    return records(len(rows), dtype, **{name: [row[name] for row in rows] for name in names})
