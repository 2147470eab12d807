"""Stamps: seconds, or a date and time; and which column has them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from tautline.scene.reading.columns import HEADER
from tautline.scene.values.units import UnknownUnit, read_unit

NAMES = ("time", "t", "timestamp", "stamp")
"""Columns of the stamp, where none is named."""
UNIX = (1.0e8, 1.0e11)
"""Stamps between these are seconds since 1970, s: no machine counts three years of its own."""


def stamp_of(value: Any, factor: float = 1.0) -> float:
    """A stamp in seconds: a number times its unit, or ISO 8601 (UTC where it names no zone); NaN for anything else.

    A number may have a comma in place of its point, as readings may.
    """
    number = number_of(value)
    if not math.isnan(number) or not isinstance(value, str):
        return number * factor
    try:
        moment = datetime.fromisoformat(value.strip())
    except ValueError:
        return math.nan
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def stamp_said(time: float) -> str:
    """A stamp, s, as people read it: seconds, or the time of day in UTC where it is a Unix time."""
    if not UNIX[0] <= time < UNIX[1]:
        return f"{time:.1f} s"
    tenths = round(10.0 * time)
    return f"{datetime.fromtimestamp(tenths // 10, UTC):%Y-%m-%d %H:%M:%S}.{tenths % 10} UTC"


def number_of(value: Any) -> float:
    """A reading; NaN for what is no number. A comma in place of a point is understood."""
    if isinstance(value, bool) or value is None:
        return math.nan
    if isinstance(value, (int, float)):
        return float(value)
    text = str(value).strip()
    try:
        return float(text)
    except ValueError:
        try:
            return float(text.replace(",", ".")) if text.count(",") == 1 else math.nan
        except ValueError:
            return math.nan


def heads(titles: Sequence[str]) -> tuple[list[str], list[str]]:
    """Names and units of a header's cells: ``heave [cm]``."""
    found = [HEADER.fullmatch(title) for title in titles]
    return [one["name"] if one else "" for one in found], [(one["unit"] or "") if one else "" for one in found]


def seconds_in(unit: str) -> float:
    """What a stamp in a unit is multiplied by; 1 where the unit is none of time."""
    try:
        read = read_unit(unit) if unit else None
    except UnknownUnit:
        return 1.0
    return float(read.factor) if read is not None and read.dimension == read_unit("s").dimension else 1.0


def stamp_column(names: Sequence[str], asked: str) -> str | None:
    """The column of the stamp: that asked for, or the first that is called so."""
    if asked:
        return asked if asked in names else None
    return next((name for known in NAMES for name in names if name.lower() == known), None)
