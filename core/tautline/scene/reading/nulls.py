"""Numbers that rigs write for a value that is missing."""

from __future__ import annotations

import numpy as np

NULLS = (-999.0, -999.25, -9999.0, -9999.25)
"""What the formats of rigs (WITS, LAS) write for a value that is missing."""
ROUNDING = 1e-12
"""Relative rounding of a number that was converted."""
NEAR = 0.5
"""Share of such a number below which others of the same column show that it may be a reading as well."""


def written_for_none(read: np.ndarray, factors: float | np.ndarray = 1.0) -> np.ndarray:
    """Which numbers (c,) stand for none as they were written, before they were multiplied by factors (c,)."""
    marks = np.outer(np.broadcast_to(factors, read.shape), NULLS)
    return np.isclose(read[:, None], marks, rtol=ROUNDING, atol=0.0).any(axis=1)
