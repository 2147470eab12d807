"""Letters that the font of figures does not have: told once in plain words, where matplotlib would speak of each."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from tautline.errors import TautlineWarning

MISSING = re.compile(r"Glyph (?P<code>\d+) \(.*\) missing from font\(s\) (?P<font>.*?)\.?", re.DOTALL)
"""How matplotlib speaks of a letter that it cannot draw."""

_told: set[str] = set()
"""Letters that this process has told of: the title of a scene stands in all of its figures."""


@contextmanager
def missing_letters_told() -> Iterator[None]:
    """While a figure is drawn: one warning names all letters that the font lacks; other warnings stay as they are."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always", UserWarning)
        yield
    lacking: dict[str, str] = {}
    for one in heard:
        if found := MISSING.fullmatch(str(one.message)):
            lacking[chr(int(found["code"]))] = found["font"]
        else:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    new = {letter: font for letter, font in lacking.items() if letter not in _told}
    if not new:
        return
    _told.update(new)
    text = (
        f"the font of figures, {', '.join(dict.fromkeys(new.values()))}, lacks {' '.join(new)}: a box stands in the "
        "figure there; use other letters in titles and names"
    )
    warnings.warn(text, TautlineWarning, stacklevel=3)
