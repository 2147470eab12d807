"""Slips of the pen by which YAML makes a key of a value: a decimal comma, a missing blank or colon."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

AFTER_COMMA = re.compile(r"[0-9]+([eE][+-]?[0-9]+)?(\s+\S.*|[^\W\d].*|\s*%)?", re.ASCII)
"""What stands behind a decimal comma: digits, and a unit."""
WITHOUT_BLANK = re.compile(r"([^\W\d]\w*):(\S.*)")
"""A key and its value with no blank behind the colon: in braces YAML reads all of it as a key."""

WITHOUT_COLON = re.compile(r"([^\W\d]\w*)\s+([-+.\d\[{'\"].*)")
"""A key and a value that begins as numbers, lists and quoted words do, with no colon between them."""


def run_together(known: Sequence[str], data: Any, key: str) -> tuple[str, str]:
    """Key and cure of ``step:5 ms`` and ``step 5 ms`` in braces, all of which is read as a key of `data`.

    Both are empty where it is no such slip, or the key is not one of those `known`.
    """
    parts, lacks = WITHOUT_BLANK.fullmatch(key), "a blank is missing after the colon"
    if parts is None and isinstance(data, dict) and data.get(key, data) is None:
        parts, lacks = WITHOUT_COLON.fullmatch(key), "a colon is missing"
    if parts is None or parts[1] not in known:
        return "", ""
    return parts[1], f"{lacks}: write {parts[1]}: {parts[2]}"


def decimal_comma(data: Any, key: str) -> tuple[str, str]:
    """What to write for ``friction: 0,25``, which in braces is the key friction with 0, and the key 25 with nothing.

    Returns
    -------
    cure, before : str
        Empty where it is no decimal comma. `before` is the key in front: of ``-0`` its value has lost the sign, which
        the document still has.
    """
    after = AFTER_COMMA.fullmatch(key)
    if after is None or not isinstance(data, dict) or data.get(key, data) is not None:
        return "", ""
    keys = list(data)
    before = data[keys[keys.index(key) - 1]] if keys.index(key) > 0 else None
    if isinstance(before, float) and 1.0 <= abs(before) < 1000.0 and round(before, 3) == before:
        # Of 5.000,0 t YAML has read 5.0.
        name = str(keys[keys.index(key) - 1])
        return f"is it a decimal comma behind a mark of thousands? Write one number with a point, for {name}", name
    whole = isinstance(before, int) and not isinstance(before, bool)
    if not whole and not (isinstance(before, str) and re.fullmatch(r"-0+", before)):
        return "", ""
    name = str(keys[keys.index(key) - 1])
    cure = f"is it a decimal comma? Write {before}.{key} with a point, for {name}"
    if re.match(r"\d{3}(?!\d)", key) and re.fullmatch(r"-?[1-9]\d{0,2}", str(before)):
        cure += f". Does it mark thousands? Then write {before}{key}"
    return cure, name
