"""The catalogue of standard tubulars, and how a person names one: ``5 in 19.50 lb/ft S135``.

Dimensions and weights are in `catalogue/tubulars.csv`, with their sources beside it.
"""

from __future__ import annotations

import csv
import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib import resources
from math import pi
from typing import Any

from tautline.errors import TautlineError

INCH = 0.0254
POUND_PER_FOOT = 0.45359237 / 0.3048
KSI = 4.4482216152605e6 / INCH**2 / 1e3
"""SI values of the catalogue's units: m, kg/m, Pa."""
STEEL = 7850.0
"""Density, kg/m^3, of what a changed bore adds to or takes from a catalogue weight."""
SAME_WEIGHT = 0.051
"""Nominal weights, lb/ft, that differ by less are one weight written twice: 16.6 and 16.60, 24.2 and 24.22."""
MOST_LISTED = 8
"""Tubulars that a refusal lists."""
LARGEST_SIZE = 14.0
"""Inches: a bare number above it is a weight."""
LONGEST = 100
"""Characters of the longest name that is read."""
FRACTIONS = {"½": "1/2", "¼": "1/4", "¾": "3/4", "⅛": "1/8", "⅜": "3/8", "⅝": "5/8", "⅞": "7/8"}
KINDS = {
    "HWDP": ("heavy weight drill pipe", "heavy wall drill pipe", "heavy weight", "hevi wate", "hwdp"),
    "drill pipe": ("drill pipe", "drillpipe", "pipe", "dp"),
    "drill collar": ("drill collars", "drill collar", "collars", "collar", "dc"),
}
"""How kinds are written, those that contain another first."""
EXAMPLE = "such as '5 in 19.50 lb/ft S135', 'HWDP 5 in', 'drill collar 6 1/2 x 2 13/16'"

NUMBER = r"\d+\s+\d+/[1-9]\d*|\d+/[1-9]\d*|\d*\.\d+|\d+\.?"
SIZE = rf"(?P<number>{NUMBER})\s*(?P<unit>lbs?/ft|lbm/ft|lbf/ft|ppf|lbs?|#|inches|inch|in\b\.?|\"|'')?"
CONNECTION = rf"\b(?:nc\s*-?\s*(\d\d)|({NUMBER})\s*(?:in\s*|\"\s*)?(fh|reg|if|xh))\b"
GRADE = r"\b(?:grade\s*)?([a-z])\s*-?\s*(\d{2,3})\b(?![./\d])|\bgrade\s*([a-z])\b|(?<=\s)([egs])\b"


class NoSuchTubular(TautlineError, ValueError):
    """Words that name no tubular of the catalogue, or several; `cause` and `cure` say which."""

    def __init__(self, cause: str, cure: str) -> None:
        super().__init__(f"{cause}; {cure}")
        self.cause, self.cure = cause, cure


@dataclass(frozen=True)
class Tubular:
    """A row of the catalogue.

    Attributes
    ----------
    kind : str
        ``drill pipe``, ``HWDP`` or ``drill collar``.
    size, bore : str
        Outside and inside diameter as they are written, inches.
    nominal : float or None
        Nominal weight, lb/ft: a name, not what the pipe weighs.
    grade, connection : str
        Empty where there is none.
    od, id : float
        Of the tube, m.
    tool_joint_od, tool_joint_id : float or None
        m.
    plain_end : float or None
        Published mass of the bare tube, kg/m.
    mass_per_length : float or None
        With tool joints and upsets, kg/m; None for a collar, whose geometry says it.
    yield_strength : float
        Minimum yield strength of the tube, Pa.
    """

    kind: str
    size: str
    bore: str
    nominal: float | None
    grade: str
    connection: str
    od: float
    id: float
    tool_joint_od: float | None
    tool_joint_id: float | None
    plain_end: float | None
    mass_per_length: float | None
    yield_strength: float

    @property
    def label(self) -> str:
        """What it is called, in a form that finds it again."""
        if self.kind == "drill pipe":
            return f"drill pipe {self.size} in {self.nominal:.2f} lb/ft {self.grade}"
        return f"HWDP {self.size} in" if self.kind == "HWDP" else f"drill collar {self.size} x {self.bore} in"

    @property
    def area(self) -> float:
        """Cross-section of the tube's steel, m^2."""
        return pi / 4.0 * (self.od**2 - self.id**2)

    @property
    def yield_load(self) -> float:
        """Tension at which the new tube yields, N: cross-section times minimum yield strength (API RP 7G)."""
        return self.area * self.yield_strength

    def keys(self, od: float | None = None, id: float | None = None) -> dict[str, Any]:
        """Keys of a section of the string, SI.

        With another outside or inside diameter than the catalogue's (m), as of a worn pipe, the weight changes by the
        steel that is there or is not, and the yield load with the cross-section.
        """
        outside, inside = self.od if od is None else od, self.id if id is None else id
        # A bore as wide as the pipe is refused by the section itself.
        area = pi / 4.0 * (outside**2 - inside**2) if outside > inside else self.area
        keys = {"name": self.label, "od": outside, "id": inside, "yield_load": area * self.yield_strength}
        if self.mass_per_length is not None:
            keys["mass_per_length"] = self.mass_per_length + STEEL * (area - self.area)
        if self.tool_joint_od is not None:
            keys |= {"tool_joint_od": self.tool_joint_od, "tool_joint_id": self.tool_joint_id}
        return keys


def inches(text: str) -> float:
    """``6 1/2`` or ``4.276`` as a number."""
    return float(sum(Fraction(part.rstrip(".")) for part in text.split()))


@functools.cache
def catalogue() -> tuple[Tubular, ...]:
    """All rows of the catalogue, in its order."""
    text = (resources.files("drillstring") / "catalogue" / "tubulars.csv").read_text(encoding="utf8")
    rows = csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
    return tuple(_tubular(row) for row in rows)


def _tubular(row: dict[str, str]) -> Tubular:
    def scaled(name: str, factor: float) -> float | None:
        return inches(row[name]) * factor if row[name] else None

    return Tubular(
        kind=row["kind"],
        size=row["size [in]"],
        bore=row["id [in]"],
        nominal=scaled("nominal [lb/ft]", 1.0),
        grade=row["grade"],
        connection=row["connection"],
        od=inches(row["size [in]"]) * INCH,
        id=inches(row["id [in]"]) * INCH,
        tool_joint_od=scaled("tool joint od [in]", INCH),
        tool_joint_id=scaled("tool joint id [in]", INCH),
        plain_end=scaled("plain end [lb/ft]", POUND_PER_FOOT),
        mass_per_length=scaled("weight [lb/ft]", POUND_PER_FOOT),
        yield_strength=float(row["yield [ksi]"]) * KSI,
    )


@dataclass(frozen=True)
class Wanted:
    """What words say of a tubular; None where they say nothing. Inches and lb/ft."""

    kind: str | None = None
    size: float | None = None
    bore: float | None = None
    weight: float | None = None
    grade: str | None = None
    connection: str | None = None

    def distance(self, one: Tubular) -> float:
        """How far a tubular is from what is wanted; below 1 it is one of those that are meant."""
        far = 1e4 * (self.kind not in (None, one.kind))
        if self.size is not None:
            far += 1e3 * _apart(self.size, inches(one.size), 1e-3)
        if self.bore is not None:
            far += 1e2 * _apart(self.bore, inches(one.bore), 1e-3)
        if self.weight is not None:
            known = [one.nominal, None if one.mass_per_length is None else one.mass_per_length / POUND_PER_FOOT]
            # A weight with tool joints may name heavy weight pipe, which has no other.
            weights = [w for w in (known if one.kind == "HWDP" else known[:1]) if w is not None]
            far += min((10.0 * _apart(self.weight, w, SAME_WEIGHT) for w in weights), default=1e3)
        far += 5.0 * (self.grade not in (None, one.grade))
        return far + 2.0 * (self.connection not in (None, one.connection))


def _apart(a: float, b: float, same: float) -> float:
    """Zero for what is the same, one at least and growing for what is not."""
    return 0.0 if abs(a - b) <= same else 1.0 + abs(a - b)


def read_words(text: str) -> Wanted:
    """Take the words for a tubular apart.

    Raises
    ------
    NoSuchTubular
        For a grade that is unknown, and for what cannot be understood.
    """
    if len(text) > LONGEST:
        raise NoSuchTubular("is too long for the name of a tubular", f"give one {EXAMPLE}")
    rest = " " + text.lower().translate(str.maketrans({"“": '"', "”": '"', "″": '"', "×": "x", ",": " "})) + " "
    for mark, fraction in FRACTIONS.items():
        rest = rest.replace(mark, f" {fraction}")
    rest = re.sub(r"(?<=\d)-(?=\d+/\d)", " ", rest)
    kind = None
    for name, words in KINDS.items():
        for written in words:
            pattern = rf"\b{written}\b".replace(" ", r"[\s_-]*")
            if kind is None and re.search(pattern, rest):
                kind, rest = name, re.sub(pattern, " ", rest, count=1)
    connection, rest = _connection(rest)
    grade, rest = _grade(rest)
    numbers = [(inches(m["number"]), m["unit"] or "", rest[: m.start()].rstrip()) for m in re.finditer(SIZE, rest)]
    left = re.sub(r"\b(?:x|in|by|api|new)\b", " ", re.sub(SIZE, " ", rest)).split()
    if left:
        raise NoSuchTubular(f"'{left[0]}' is not understood", f"give a tubular {EXAMPLE}")
    size = bore = weight = None
    for value, unit, before in numbers:
        heavy = unit.startswith(("lb", "ppf", "#")) or (not unit and value > LARGEST_SIZE)
        if size is None and not heavy:
            size = value
        elif not heavy and bore is None and (kind == "drill collar" or before.endswith("x") or unit):
            bore = value
        elif weight is None:
            weight = value
        else:
            raise NoSuchTubular(f"{value:g} is one number too many", f"give a tubular {EXAMPLE}")
    if not numbers and kind is None and grade is None and connection is None:
        raise NoSuchTubular("names no tubular", f"give one {EXAMPLE}")
    if size is None and connection is not None and not connection.startswith("NC"):
        # 5 1/2 FH is on 5 1/2 in pipe; a numbered connection says nothing of the pipe's size.
        size = inches(connection.rsplit(" ", 1)[0])
    return Wanted(kind, size, bore, weight, grade, connection)


def _connection(rest: str) -> tuple[str | None, str]:
    found = re.search(CONNECTION, rest)
    if found is None:
        return None, rest
    name = f"NC{found[1]}" if found[1] else f"{' '.join(found[2].split())} {found[3].upper()}"
    return name, rest[: found.start()] + " " + rest[found.end() :]


def _grade(rest: str) -> tuple[str | None, str]:
    found = re.search(GRADE, rest)
    if found is None:
        return None, rest
    letter = (found[1] or found[3] or found[4]).upper()
    known = sorted({one.grade for one in catalogue() if one.grade}, key=lambda grade: int(grade[1:]))
    for grade in known:
        if grade == f"{letter}{found[2] or grade[1:]}":
            return grade, rest[: found.start()] + " " + rest[found.end() :]
    cure = f"known grades: {', '.join(known)}; for another give `od`, `id`, `mass_per_length` and `yield_load`"
    raise NoSuchTubular(f"'{found[0].strip().upper()}' is no grade of the catalogue", cure)


def matching(text: str) -> tuple[Tubular, ...]:
    """All tubulars that words may mean, in the catalogue's order; raises NoSuchTubular for words not understood."""
    wanted = read_words(text)
    return tuple(one for one in catalogue() if wanted.distance(one) < 1.0)


def find(text: str) -> Tubular:
    """The one tubular that words mean.

    Raises
    ------
    NoSuchTubular
        Where they mean none, with the nearest; or several, with a list.
    """
    found = matching(text)
    if len(found) == 1:
        return found[0]
    if not found:
        wanted = read_words(text)
        near = sorted(catalogue(), key=wanted.distance)[:3]
        cure = f"the nearest are {_listed(near)}; `drillstring tubulars` lists all"
        raise NoSuchTubular("is not in the catalogue of tubulars", cure)
    more = len(found) - MOST_LISTED
    listed = _listed(found[:MOST_LISTED]) + (f", and {more} more" if more > 0 else "")
    raise NoSuchTubular(f"may mean {len(found)} tubulars: {listed}", "name one of them, with its grade or bore")


def _listed(some: Sequence[Tubular]) -> str:
    return ", ".join(f"'{one.label}'" for one in some)
