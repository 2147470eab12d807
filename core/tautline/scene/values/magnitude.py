"""Which numbers can be computed with, whatever they measure."""

from __future__ import annotations

SMALLEST, LARGEST = 1.0e-30, 1.0e30
"""Between these lie all lengths, masses and stiffnesses from a nanotube's to anything: what can be computed with."""
OUTSIDE = "is beyond all that can be computed with", f"give a number from {SMALLEST:g} to {LARGEST:g}, in SI"
"""Cause and cure for a number that is neither zero nor between them."""


def is_outside(value: float | None) -> bool:
    """Whether a number that is not zero is too small or too large to be raised to a power."""
    return value is not None and value != 0.0 and not SMALLEST <= abs(value) <= LARGEST
