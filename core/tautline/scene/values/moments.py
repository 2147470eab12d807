"""Moments as people read them."""

from __future__ import annotations

from datetime import UTC, datetime

UNIX = (1.0e8, 1.0e11)
"""Stamps between these are seconds since 1970, s: no machine counts three years of its own."""


def stamp_said(time: float) -> str:
    """A stamp, s, as people read it: seconds, or the time of day in UTC where it is a Unix time."""
    if not UNIX[0] <= time < UNIX[1]:
        return f"{time:.1f} s"
    tenths = round(10.0 * time)
    return f"{datetime.fromtimestamp(tenths // 10, UTC):%Y-%m-%d %H:%M:%S}.{tenths % 10} UTC"


def duration_said(seconds: float) -> str:
    """A duration in words: ``0.35 s``, ``3600 s``."""
    return f"{seconds:.0f} s" if seconds >= 100.0 else f"{seconds:.3g} s"
