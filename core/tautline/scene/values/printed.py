"""Numbers as people write them: four digits, a prefix, the units of a system."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, Protocol

from tautline.scene.values.systems import SYSTEMS, choices_of, in_system

PREFIXED = {"N", "J", "W", "Pa", "N m", "N/m", "Hz"}
"""Units that people write with k, M or G in front; a metre or a second stays what it is."""
FIGURE = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
BETWEEN = r" (?:to|and|x|×|by) "
"""A figure in a sentence, and what stands between two that have one unit."""
HELD = "\u00a0"
"""In place of blanks it holds a figure and its unit together, so that they are not converted."""
PREFIXES = {"G": 1e9, "M": 1e6, "k": 1e3, "m": 1e-3, "": 1.0}
LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"))
"""Prefixes of large figures, the largest first."""


NOISE = 1.0e-12
"""Share of a number that is rounding of the few operations that made it."""
MOST_DIGITS = 15
"""Significant digits that all numbers of the computer bear."""
MEANT = 10.0
"""Share of a whole up to which it is told in numbers: of what hardly is there it says nothing but that it is large."""


def in_percent(share: float, digits: int = 2) -> str:
    """A share as text."""
    return f"{significant(100.0 * share, digits)} %" if not share > MEANT else f"more than {100.0 * MEANT:.0f} %"


def significant(value: float, digits: int = 4) -> str:
    """Write a number to so many significant digits, without an exponent where it reads well."""
    if value == 0.0:
        return "0"
    if not math.isfinite(value):
        return "–"
    size = math.floor(math.log10(abs(value)))
    if -4 <= size < 7:
        text = f"{value:.{max(0, digits - 1 - size)}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    return f"{value:.{digits - 1}e}"


def rounded(value: float, digits: int, *, up: bool = False, within: float = NOISE) -> float:
    """A number with so many significant digits that is no larger, or ``up`` no smaller: ``rounded(0.587, 2)`` is 0.58.

    Parameters
    ----------
    value : float
        What is 0, infinite or no number stays what it is.
    digits : int
    up : bool
        Whether to round towards larger numbers.
    within : float
        Share of the number by which it may pass the digits that it is meant to have: those of 0.58 are 0.58.
    """
    if value == 0.0 or not math.isfinite(value):
        return value
    place = math.floor(math.log10(abs(value))) - digits + 1
    # A power of ten below 1 is no number of the computer, and the quotient by it is beside what was meant.
    # That of the least numbers is beyond the largest one, so it is taken in two parts.
    part = min(-place, 300)
    count = value / 10.0**place if place >= 0 else value * 10.0**part * 10.0 ** (-place - part)
    room = within * abs(count)
    return float(f"{math.ceil(count - room) if up else math.floor(count + room)}e{place}")


def digits_apart(one: float, other: float, least: int = 4) -> int:
    """How many significant digits, of the larger of two different values, show two of their difference; 15 at most."""
    size, difference = max(abs(one), abs(other)), abs(one - other)
    if not (0.0 < difference < math.inf):
        return least
    return max(least, min(MOST_DIGITS, math.floor(math.log10(size)) - math.floor(math.log10(difference)) + 2))


class Teller(Protocol):
    """How a value is said, with so many significant digits."""

    def __call__(self, value: float, digits: int = 4, /) -> str:
        """The value in words."""


def told_apart(one: float, other: float, tell: Teller) -> tuple[str, str]:
    """Two values as `tell` says them: with more digits where they differ and would look the same."""
    digits = digits_apart(one, other) if tell(one) == tell(other) else 4
    return tell(one, digits), tell(other, digits)


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """Write a figure with its unit: ``1.234 MN``."""
    if value is None:
        return "–"
    if isinstance(value, (list, tuple)):
        return ", ".join(quantity(item, unit, digits) for item in value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return f"{value} {unit}".strip()
    if isinstance(value, int) and not unit:
        return str(value)
    prefix = ""
    if unit in PREFIXED:
        for factor, letter in LARGE:
            if abs(value) >= factor:
                value, prefix = value / factor, letter
                break
    return f"{significant(float(value), digits)} {prefix}{unit}".strip()


def shown(value: Any, unit: str, system: str = "si", digits: int = 4) -> str:
    """Write a figure that is given in SI in the units of a system (a key of `systems.SYSTEMS`)."""
    if isinstance(value, (list, tuple)):
        return ", ".join(shown(item, unit, system, digits) for item in value)
    system = _read_in(unit, system)
    if unit in SYSTEMS[system] and isinstance(value, (int, float)) and not isinstance(value, bool):
        converted, name = in_system(float(value), unit, system)
        return f"{significant(converted, digits)} {name}"
    return quantity(value, unit, digits)


def _read_in(unit: str, system: str) -> str:
    """The system that a unit is read in: an angle is read in degrees by everybody."""
    return "metric" if (unit, system) == ("rad", "si") else system


def scales(unit: str, system: str = "si") -> list[tuple[float, float, str]]:
    """What `shown` chooses from, as data for a page: size in SI from which on it is taken, factor, and unit.

    The largest unit comes first, and the last takes all that is smaller but zero (`scale_of_zero`).
    """
    system = _read_in(unit, system)
    if unit in SYSTEMS[system]:
        return choices_of(unit, system)
    large = [(factor, 1.0 / factor, f"{letter}{unit}") for factor, letter in LARGE] if unit in PREFIXED else []
    return [*large, (0.0, 1.0, unit)]


def scale_of_zero(unit: str, system: str = "si") -> tuple[float, str]:
    """Factor and unit in which `shown` writes zero: a system's first unit, and without one the plain unit of SI."""
    first = 0 if unit in SYSTEMS[_read_in(unit, system)] else -1
    _, factor, name = scales(unit, system)[first]
    return factor, name


def read(word: str, system: str) -> tuple[float, str] | None:
    """Factor and SI unit of a unit with its prefix, ``kN m`` -> (1e3, "N m"); None of one that has no other."""
    known = SYSTEMS[system]
    if word in known:
        return 1.0, word
    if word[1:] in known and word[0] in PREFIXES:
        return PREFIXES[word[0]], word[1:]
    return None


def converted(value: float, word: str, system: str) -> tuple[float, str]:
    """A figure in a unit with its prefix in the units of a system; both as they were where that names none."""
    known = read(word, system)
    return in_system(value * known[0], known[1], system) if known else (value, word)


def printed_in(attributes: Mapping[str, Any]) -> str:
    """In which units a result of these attributes is printed: ``si``, ``metric`` or ``field``; its numbers are SI.

    Files of earlier versions call it `units`.
    """
    return str(attributes.get("printed_in") or attributes.get("units") or "si")


def as_typed(text: str) -> str:
    """A text whose figures `in_words` leaves in the units they have: what was typed, or might have been."""
    return text.replace(" ", HELD)


def in_words(text: str, system: str) -> str:
    """A heading or a sentence with its figures converted: ``drill pipe at 1240 m`` -> ``drill pipe at 4068 ft``.

    Of several figures with one unit, ``0.1 to 0.4 m``, all are converted, to the unit of the largest.
    """
    known = sorted(SYSTEMS[system], key=len, reverse=True)
    if not known:
        return text.replace(HELD, " ")
    units = "|".join(re.escape(f"{letter}{unit}") for unit in known for letter in PREFIXES)

    def put(found: re.Match[str]) -> str:
        values = [float(number) for number in re.findall(FIGURE, found[1])]
        largest = max(values, key=abs)
        converted_to, unit = converted(largest, found[2], system)
        share = converted_to / largest if largest else 1.0
        # Depths of ten thousand feet and more are written out.
        written = iter(f"{x:.0f}" if abs(x) >= 1000.0 else f"{x:.4g}" for x in (share * value for value in values))
        return f"{re.sub(FIGURE, lambda _: next(written), found[1])} {unit}"

    # Of a unit that is written as a product or a quotient, N m/rad, no part is one.
    pattern = rf"(?<![\w.])({FIGURE}(?:{BETWEEN}{FIGURE})*) ({units})(?!\w|(?: (?:m|s|kg|N|rad))*[/²³^])"
    return re.sub(pattern, put, text).replace(HELD, " ")
