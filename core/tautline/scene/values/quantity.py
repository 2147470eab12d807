"""Numbers with units: a bare number is SI, text carries its unit."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tautline.scene.refusal import nearest, refusal
from tautline.scene.values.habits import flow_for_speed, habit, other_minus
from tautline.scene.values.magnitude import LARGEST, OUTSIDE, is_outside
from tautline.scene.values.ranges import EXAMPLES, RANGES
from tautline.scene.values.units import Uncounted, Unit, UnknownUnit, converted, read_unit

NUMBER = re.compile(r"\s*(?P<number>[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>.*?)\s*", re.DOTALL)
MIXED = re.compile(
    r"\s*(?P<sign>[-+]?)(?P<whole>\d{1,9})\s+(?P<up>\d{1,4})/(?P<down>\d{1,4})\s*(?P<unit>[^\d\s/].*)", re.DOTALL
)
"""A mixed number with its unit, as inches are written: ``12 1/4 in``."""
FRACTION = re.compile(r"\s*(?P<up>[-+]?\d{1,9})\s*/\s*(?P<down>\d{1,9})\s*(?P<unit>[^\d\s/].*)", re.DOTALL)
WITH_POWER = re.compile(r"[-+]?\d+\.\d*[eE][-+]\d+")
"""Powers of ten that YAML 1.1, which PyYAML reads, takes for numbers; YAML 1.2 and JSON take ``8.0e7`` as well."""
LARGEST_EXPONENT = 400
POUND = re.compile(r"lbs?\b")
PER_GRAVITY = read_unit("s^2/m")
"""A force times this is a mass: where one is written for the other, the pound is to blame."""

MEANINGS = {
    "": ("a plain number", "0.2"),
    "m": ("a length", "0.127 or 5 in"),
    "m^2": ("an area", "0.0034 or 34 cm^2"),
    "m^4": ("a second moment of area", "3.586e-5 or 86 in^4"),
    "m/s": ("a speed", "0.5 m/s"),
    "m/s^2": ("an acceleration", "9.81 m/s^2"),
    "s": ("a time", "0.001 or 1 ms"),
    "1/s": ("a rate", "0.1 1/s"),
    "rad": ("an angle", "90 deg, or radians as a bare number"),
    "rad/s": ("a rotary speed", "120 rpm, or rad/s as a bare number"),
    "rad/s^2": ("an angular acceleration", "0.5 rad/s^2"),
    "rad/m": ("a curvature", "3 deg/30m"),
    "kg": ("a mass", "5000 or 5 t"),
    "kg/m": ("a mass per length", "29.0 or 19.5 lb/ft"),
    "kg/m^3": ("a density", "1840 or 12.5 ppg"),
    "kg m^2": ("a moment of inertia", "2000 kg m^2"),
    "N": ("a force", "5.0e4 or 50 kN"),
    "N m": ("a torque", "2.0e4 or 20 kN m"),
    "N m^2": ("a bending stiffness", "0.001 N m^2"),
    "N/m": ("a stiffness", "1.0e9 or 1 GN/m"),
    "N s/m": ("a damping coefficient", "10 N s/m"),
    "N m/rad": ("a torsional stiffness", "200 N m/rad"),
    "N m s/rad": ("a rotary damping coefficient", "20 N m s/rad"),
    "Pa": ("a stress or modulus", "2.0e11 or 200 GPa"),
    "Hz": ("a frequency", "0.1 Hz"),
}
"""What a quantity of each unit is called, and an example of how to write one."""
MEANINGS_OF = {
    ("N/m", "load per length"): ("a load per length", "10 N/m"),
    ("m/m", "response to waves"): ("a displacement per metre of wave", "0.6 m/m"),
    ("rad/m", "response to waves"): ("a rotation per metre of wave", "2 deg/m, or rad/m as a bare number"),
    ("N/m", "response to waves"): ("a force per metre of wave", "20 kN/m"),
    ("N m/m", "response to waves"): ("a torque per metre of wave", "20 kN m/m"),
    ("m/s/m", "response to waves"): ("a speed per metre of wave", "0.1 m/s/m"),
    ("rad/s/m", "response to waves"): ("a rotary speed per metre of wave", "2 deg/s/m, or rad/s/m as a bare number"),
    ("1/m", "response to waves"): ("a share per metre of wave", "0.1 1/m"),
}
"""The same of a row of the table of plausible ranges that is called otherwise than most quantities of its unit."""

FROM_MODULUS = {
    "axial stiffness": "EA is the modulus times the metal area",
    "bending stiffness": "EJ is the modulus times the second moment of area",
}
"""Rows of that table for which a modulus is given by mistake, and how they follow from it."""


NEWTON_METRE = re.compile(r"\b([kM]?N)m(?![A-Za-z])")
"""Newton and metre written as one word: a power behind it is that of both."""


def _meant_apart(unit: str, wanted: Unit) -> str:
    """The question whether a power of `Nm` was meant for the metre alone, where that is what is wanted; else empty."""
    apart = NEWTON_METRE.sub(r"\1 m", unit)
    try:
        fits = apart != unit and _may_stand_for(read_unit(apart), wanted)
    except UnknownUnit:
        return ""
    return f"did you mean '{apart}'? " if fits else ""


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float: unit, bounds, and words allowed in place of a number.

    Bounds are in SI. `words` are accepted as they stand (``length: rest``). `of` is its row in the table of plausible
    ranges (`values.ranges`): every key of a scene has one. Numbers whose powers overflow are refused, but for
    one of `any_size`, such as a part of a direction, which is scaled before it is used.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    words: tuple[str, ...] = ()
    of: str = ""
    any_size: bool = False

    def __post_init__(self) -> None:
        """Refuse a row that is not in the table, or is one of another unit: a slip of who declares the key."""
        if self.of and self.of not in RANGES:
            cure = "or add a row to tautline.scene.values.ranges.RANGES"
            raise ValueError(f"no plausible range is called '{self.of}'; {nearest(self.of, RANGES)}, {cure}")
        if self.of and (RANGES[self.of].low is not None and RANGES[self.of].unit != self.unit):
            raise ValueError(f"the plausible range of '{self.of}' is not in {self.unit or 'pure numbers'}")

    @property
    def meaning(self) -> str:
        """What it is, in words: ``a length``."""
        return self._called(f"a quantity in {self.unit}", "")[0]

    @property
    def example(self) -> str:
        """How one is written: as others of its row are, else as others of its unit."""
        text = EXAMPLES.get(self.of) or self._called("", f"1.0 {self.unit}")[1]
        return f"{text}, or the word {' or '.join(self.words)}" if self.words else text

    def _called(self, meaning: str, example: str) -> tuple[str, str]:
        return MEANINGS_OF.get((self.unit, self.of)) or MEANINGS.get(self.unit, (meaning, example))

    @property
    def cure(self) -> str:
        """The sentence that ends a refusal."""
        return f"give {self.meaning} such as {self.example}"

    def read(self, written: Any) -> float | str:
        """Return the value in SI, or one of the words.

        Raises
        ------
        PydanticCustomError
            If it is not a finite number with the right unit and within the bounds.
        """
        if isinstance(written, str) and written in self.words:
            return written
        value = self._text(written) if isinstance(written, str) else self._number(written)
        self._bound(value, bare=not isinstance(written, str))
        return value

    def _number(self, written: Any) -> float:
        if isinstance(written, bool) or written is None or not isinstance(written, (int, float)):
            if written is None:
                raise refusal("is empty", self.cure)
            kinds = {
                bool: "true and false are not numbers",
                dict: "a mapping is not a number",
                list: "a list is not a number",
            }
            raise refusal(kinds.get(type(written), f"{type(written).__name__} is not a number"), self.cure)
        try:
            value = float(written)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise refusal("is not a finite number", self.cure)
        return value

    def _text(self, written: str) -> float:
        match = NUMBER.fullmatch(decimal(written) if self.unit == "m" else written)
        if match is None:
            if written.strip().lower().lstrip("+-.") in ("nan", "inf", "infinity"):
                raise refusal("is not a finite number", self.cure)
            if told := other_minus(written):
                raise refusal(*told)
            hint = f"{nearest(written, self.words)}, or " if self.words else ""
            raise refusal("is not a number with a unit", hint + self.cure)
        number, unit = match["number"], match["unit"]
        exponent = number.lower().partition("e")[2] or "0"
        if abs(int(exponent[:6])) > LARGEST_EXPONENT or len(number) > LARGEST_EXPONENT:
            raise refusal("is not a finite number", self.cure)
        if not unit:
            cure = f"remove the quotes, or add the unit: {self.cure}"
            if exponent != "0" and not WITH_POWER.fullmatch(number):
                cure += f". If PyYAML has read the file: it takes {number} for text. Give the path of the file instead"
            raise refusal("is text, not a number", cure)
        if re.match(r"(\d+\s*)?/\s*\d", unit):
            raise refusal("is a fraction, and nothing is computed", f"{_without_fraction(written)}{self.cure}")
        if told := habit(number, unit, self.unit):
            raise refusal(*told)
        wanted = read_unit(self.unit) if self.unit else read_unit("%")
        try:
            read = read_unit(unit)
        except UnknownUnit as error:
            if apart := _meant_apart(unit, wanted):
                raise refusal(f"'{unit}' is not a unit", apart + self.cure) from error
            raise refusal(error.told(unit, wanted), self.cure) from error
        if not _may_stand_for(read, wanted):
            if told := flow_for_speed(unit, read, self.unit):
                raise refusal(*told)
            if POUND.search(unit) and read.dimension == (wanted * PER_GRAVITY).dimension:
                raise refusal("a pound is a mass", f"write lbf, klbf or ft-lbf for a force: {self.cure}")
            expected = f"expected {self.meaning} such as {self.example}"
            if self.of in FROM_MODULUS and read.dimension == read_unit("Pa").dimension:
                expected += f". {FROM_MODULUS[self.of]}"
            cure = _meant_apart(unit, wanted) + expected
            raise refusal(f"'{unit}' is not the unit of {self.meaning}", cure, wanted=self.unit)
        try:
            value = converted(read, wanted).si(Decimal(number))
        except Uncounted as error:
            raise refusal(f"'{unit}' {error}", self.cure) from error
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise refusal("is not a finite number", self.cure)
        return value

    def _bound(self, value: float, bare: bool) -> None:
        unit = f" {self.unit}" if self.unit else ""
        if self.above is not None and not value > self.above:
            least = "greater than zero" if self.above == 0.0 else f"greater than {self.above:g}{unit}"
            raise refusal(f"must be {least}", self.cure)
        if self.at_least is not None and not value >= self.at_least:
            least = "negative" if self.at_least == 0.0 else f"less than {self.at_least:g}{unit}"
            raise refusal(f"must not be {least}", self.cure)
        if self.below is not None and not value < self.below:
            bound = f"less than {self.below:g}{unit}"
            raise refusal(f"must be {bound}", f"give {self.meaning} of {bound}")
        if self.at_most is not None and not value <= self.at_most:
            bound = f"{self.at_most:g}{unit}"
            cure = f"give {self.meaning} of at most {bound}"
            if self.unit == "rad" and bare and math.radians(value) <= self.at_most:
                cure = f"a bare number is in radians: write {value:g} deg if these are degrees, or {cure}"
            raise refusal(f"must not be more than {bound}", cure)
        # What may not be negative is a size, by which things are divided; what may be is a place, and added to others.
        is_size = self.above is not None or self.at_least is not None
        if not self.any_size and (is_outside(value) if is_size else abs(value) > LARGEST):
            raise refusal(*OUTSIDE)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def _validate(self, written: Any, info: core_schema.ValidationInfo) -> float | str:
        value = self.read(written)
        # A second validation, of a scene that is sound, asks for what is doubtful: pydantic knows the key, and we not.
        doubt = (info.context or {}).get("doubt")
        if doubt is not None and not isinstance(value, str):
            doubt(self, written, value)
        return value

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number"}
        names = {"above": "exclusiveMinimum", "at_least": "minimum", "below": "exclusiveMaximum", "at_most": "maximum"}
        number |= {key: getattr(self, name) for name, key in names.items() if getattr(self, name) is not None}
        text = (
            {"type": "string", "description": "a number with its unit"}
            if self.unit
            else {"type": "string", "pattern": "%$"}
        )
        choices = [number, text] + ([{"enum": list(self.words)}] if self.words else [])
        what = f"{self.meaning}, in {self.unit} unless a unit is given" if self.unit else self.meaning
        return {"anyOf": choices, "description": f"{what}; {self.example}"} | ({"quantity": self.of} if self.of else {})


def as_in_a_file(text: str | None) -> float | str | None:
    """A number as a scene's file would give it: with its unit as it was typed, or a plain one; None for None."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return text


def quantity(
    unit: str,
    *,
    positive: bool = False,
    nonnegative: bool = False,
    below: float | None = None,
    at_most: float | None = None,
    words: tuple[str, ...] = (),
    of: str = "",
    any_size: bool = False,
) -> Quantity:
    """Annotate a float: ``Length = Annotated[float, quantity("m", positive=True, of="length")]``.

    Parameters
    ----------
    unit : str
        Unit of a bare number, in SI; empty for a pure number.
    positive, nonnegative : bool
        Lower bound of zero, excluded or included.
    below, at_most : float, optional
        Upper bound in SI, excluded or included.
    words : tuple of str
        Words allowed in place of a number.
    of : str
        Row of the table of plausible ranges, `values.ranges`. Every key of a scene names one; the options of a
        command need none.
    any_size : bool
        Whether it may be smaller or larger than what can be computed with.
    """
    low = 0.0 if nonnegative else None
    return Quantity(unit, 0.0 if positive else None, low, below, at_most, words, of, any_size)


def decimal(written: str) -> str:
    """A mixed number as a decimal one, ``12.25 in`` for ``12 1/4 in``; any other text as it is.

    Of a fraction that has no end as a decimal, such as 1/3, thirty digits are kept, which no float tells apart.
    """
    match = MIXED.fullmatch(written)
    if match is None or int(match["down"]) <= int(match["up"]):
        return written
    return f"{match['sign']}{_digits(int(match['whole']), int(match['up']), int(match['down']))} {match['unit']}"


def _digits(whole: int, up: int, down: int) -> str:
    """``12.25`` for 12, 1, 4."""
    after = f"{10**30 * up // down:030d}".rstrip("0")
    return f"{whole}.{after}" if after else str(whole)


def _without_fraction(written: str) -> str:
    """What to write in place of a fraction: ``write 0.5 in, or ``; empty where that is not known."""
    match = MIXED.fullmatch(written) or FRACTION.fullmatch(written)
    if match is None or int(match["down"]) == 0:
        return ""
    value = Fraction(int(match["up"]), int(match["down"]))
    if "whole" in match.groupdict():
        value = (int(match["whole"]) + value) * (-1 if match["sign"] == "-" else 1)
    return f"write {float(value):.6g} {match['unit'].strip()}, or "


def _may_stand_for(read: Unit, wanted: Unit) -> bool:
    """Whether what is written in a unit may be read where another is wanted.

    An angle has no dimension, but neither is a share, a coefficient or a ratio of lengths one.
    """
    is_an_angle_alone = not any(wanted.dimension) and read.angle and not wanted.angle
    return read.dimension == wanted.dimension and not is_an_angle_alone


def is_written_in(written: Any, unit: str) -> bool:
    """Whether what was written is a number with a unit, and the unit is one of the quantity whose SI unit is given."""
    match = NUMBER.fullmatch(written) if isinstance(written, str) else None
    if match is None or not match["unit"]:
        return False
    try:
        return _may_stand_for(read_unit(match["unit"]), read_unit(unit))
    except UnknownUnit:
        return False


def suited(cure: str, written: Any, example: str | None = None) -> str:
    """A cure whose example is of the size of its field, and in the unit of what was written.

    Parameters
    ----------
    cure : str
        That of a :class:`Quantity`; any other stays as it is.
    written : any
        What was refused.
    example : str, optional
        A value of the field, such as ``15 m/h``; else it is that of all quantities of the unit.
    """
    for unit, (meaning, general) in MEANINGS.items():
        usual = [general, *(text for row, text in EXAMPLES.items() if RANGES[row].unit == unit)]
        of_unit = re.search(rf"{re.escape(meaning)} such as ({'|'.join(map(re.escape, usual))})(?![\w^/])", cure)
        if of_unit is not None:
            first = example or re.split(" or |, ", of_unit[1])[0]
            better = _like(written, first, unit) or example or of_unit[1]
            return f"{cure[: of_unit.start(1)]}{better}{cure[of_unit.end(1) :]}"
    return cure


def _like(written: Any, example: str, unit: str) -> str | None:
    """An example in the unit that was written, to two digits; None where that is no unit of it."""
    match, given = (NUMBER.fullmatch(decimal(text)) if isinstance(text, str) else None for text in (written, example))
    if match is None or given is None or not match["unit"]:
        return None
    try:
        own, other, si = read_unit(match["unit"]), read_unit(given["unit"] or unit or "%"), read_unit(unit or "%")
        if not _may_stand_for(own, si) or not _may_stand_for(other, si):
            return None
        own, other = converted(own, si), converted(other, si)
    except (UnknownUnit, Uncounted):
        return None
    value = Fraction(given["number"]) if not given["unit"] else Fraction(other.si(Fraction(given["number"])))
    size = float(value) / own.si(Fraction(1))
    return f"{float(f'{size:.2g}'):g} {match['unit']}"
