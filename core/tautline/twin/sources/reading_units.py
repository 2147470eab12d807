"""Units that the header of a table gives, beside those of the map."""

from __future__ import annotations

import math

from tautline.errors import TautlineError
from tautline.scene.reading.columns import NO_UNIT, unit_named
from tautline.scene.values.units import Uncounted, UnknownUnit, converted, read_unit


class OtherQuantity(TautlineError):
    """A unit of the header that measures something else than that of the map; ``str()`` says why."""


def factor_between(header: str, asked: str) -> float | None:
    """What a reading in the header's unit is multiplied by to be in the map's; exactly 1 where both are the same.

    None where nothing can be said: the map gives a unit, and the header one that nobody knows; or the other way round.

    Raises
    ------
    OtherQuantity
        For units of different dimensions, and for a rotary speed of something that is not counted.
    """
    header, asked = unit_named(header), unit_named(asked)
    if header in NO_UNIT or header == asked:
        return 1.0
    if not asked:
        return None
    try:
        written, wanted = read_unit(header), read_unit(asked)
    except UnknownUnit:
        return None
    if written.dimension != wanted.dimension:
        raise OtherQuantity("is a unit of another quantity")
    try:
        read = converted(written, wanted)
    except Uncounted as error:
        raise OtherQuantity(str(error)) from None
    return float(read.factor / wanted.factor) * math.pi ** (read.turns - wanted.turns)
