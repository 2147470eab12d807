"""The few numbers that sum a run up, and their form in the file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, is_dataclass
from typing import Any

PLAIN = frozenset({str, int, bool, type(None)})
"""Classes of which every value is fit for JSON as it is."""


@dataclass(frozen=True)
class Figure:
    """One headline number.

    Attributes
    ----------
    value : float, int, str, list or None
        In SI units.
    unit : str
        SI unit; empty for a count or a ratio.
    text : str
        What it is, in words: ``largest hook load``.
    """

    value: Any
    unit: str
    text: str


def plain(value: Any) -> Any:
    """Make a value fit for JSON: numpy numbers and arrays become Python's, numbers that are not finite become None."""
    if type(value) in PLAIN or (type(value) is float and math.isfinite(value)):
        return value
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple, set)):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)


def to_json(value: Any) -> str:
    """One line of JSON without NaN or infinity, which JSON does not know."""
    return json.dumps(plain(value), ensure_ascii=False, allow_nan=False)
