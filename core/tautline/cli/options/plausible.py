"""Bare numbers on the command line that are probably meant in another unit than SI's."""

from __future__ import annotations

import re

from tautline.scene.unit_slips import units_that_fit
from tautline.scene.values.ranges import RANGES, in_range


def doubt_of_bare(text: str, option: str, name: str) -> str:
    """What to ask of the first number without a unit that is outside of what is plausible; empty for none.

    Parameters
    ----------
    text : str
        One number, ``A,B,C``, or ``FROM:TO:STEP``.
    option : str
        As it is told.
    name : str
        Row in the table of plausible ranges, `tautline.scene.values.ranges`.
    """
    row = RANGES[name]
    parts = re.split("[,:]", text)
    # The last of three is a step.
    for word in (part.strip() for part in (parts[:2] if ":" in text else parts)):
        try:
            value = float(word)
        except ValueError:
            continue
        if not row.holds(value):
            units = units_that_fit(word, row.unit, row, "si", row.holds)
            cure = f"Write the unit: {' or '.join(f'{word} {unit}' for unit, _ in units)}" if units else "Check it"
            read = f"a number without a unit is read in {row.unit}, and {word} {row.unit} is unusual for a {name}"
            return f"{option} {text}: {read}. {in_range(row)} is plausible. {cure}"
    return ""
