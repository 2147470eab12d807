"""Units of measure, exact where they are exact.

Common units are in a table of fractions, so that `36 mm` is 0.036 to the last bit and no library need be loaded.
Any other name is asked of pint, whose import takes half a second. A test proves that the table equals pint.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from tautline.scene.refusal import nearest
from tautline.scene.values.unclear import unclear


@dataclass(frozen=True)
class Unit:
    """A unit: ``factor * pi**turns`` in SI, with exponents of mass, length and time (and the rest as text).

    ``angle`` and ``cycles`` are the exponents of the radian and of the cycle that a hertz counts. Neither is a
    dimension, but a rotary speed and a frequency differ by nothing else: see :func:`converted`.
    """

    factor: Fraction
    turns: int = 0
    mass: int = 0
    length: int = 0
    time: int = 0
    other: str = ""
    angle: int = 0
    cycles: int = 0

    @property
    def dimension(self) -> tuple[int, int, int, str]:
        """Exponents of mass, length and time, and any other dimension by name; angles have none."""
        return self.mass, self.length, self.time, self.other

    @property
    def is_rate(self) -> bool:
        """Whether it is so many per time, or per time squared, and nothing else."""
        return self.time < 0 and self.mass == self.length == 0 and not self.other

    def __mul__(self, unit: Unit) -> Unit:
        return Unit(
            self.factor * unit.factor,
            self.turns + unit.turns,
            self.mass + unit.mass,
            self.length + unit.length,
            self.time + unit.time,
            " ".join(sorted(f"{self.other} {unit.other}".split())),
            self.angle + unit.angle,
            self.cycles + unit.cycles,
        )

    def __pow__(self, n: int) -> Unit:
        other = " ".join([f"({self.other})^{n}".replace(" ", "*")] if self.other and n != 1 else [self.other])
        exponents = (self.mass * n, self.length * n, self.time * n)
        return Unit(self.factor**n, self.turns * n, *exponents, other, self.angle * n, self.cycles * n)

    def si(self, number: Fraction | Decimal) -> float:
        """Value in SI of so many of this unit, rounded once (twice where pi is in it)."""
        # Whole numbers are divided with one rounding, in lowest terms or not: to reduce a fraction takes far longer.
        up, down = number.as_integer_ratio()
        exact = up * self.factor.numerator / (down * self.factor.denominator)
        return exact * math.pi**self.turns if self.turns else exact


def _table() -> dict[str, Unit]:
    one, ten = Fraction(1), Fraction(10)
    prefixes = {"": one, "k": ten**3, "M": ten**6, "G": ten**9, "m": ten**-3, "u": ten**-6, "c": ten**-2, "d": ten**-1}
    bases: dict[str, tuple[Unit, tuple[str, ...]]] = {
        "m": (Unit(one, length=1), ("", "k", "m", "u", "c", "d")),
        "g": (Unit(ten**-3, mass=1), ("", "k", "m")),
        "s": (Unit(one, time=1), ("", "m", "u")),
        "N": (Unit(one, mass=1, length=1, time=-2), ("", "k", "M", "G", "m")),
        "Pa": (Unit(one, mass=1, length=-1, time=-2), ("", "k", "M", "G")),
        "J": (Unit(one, mass=1, length=2, time=-2), ("", "k", "M")),
        "W": (Unit(one, mass=1, length=2, time=-3), ("", "k", "M")),
        "Hz": (Unit(one, time=-1, cycles=1), ("", "k", "m")),
        "rad": (Unit(one, angle=1), ("", "m")),
    }
    units = {
        prefix + name: Unit(prefixes[prefix]) * unit for name, (unit, allowed) in bases.items() for prefix in allowed
    }
    metre, kg, second, newton, pascal = (units[name] for name in ("m", "kg", "s", "N", "Pa"))
    inch = Unit(Fraction(254, 10_000)) * metre
    pound = Unit(Fraction(45_359_237, 10**8)) * kg
    pound_force = Unit(Fraction(45_359_237 * 980_665, 10**13)) * newton
    gallon = Unit(Fraction(231)) * inch**3
    foot = Unit(Fraction(12)) * inch
    psi = pound_force * inch**-2
    degree = Unit(Fraction(1, 180), turns=1, angle=1)
    units |= {
        "t": Unit(ten**3) * kg, "tonne": Unit(ten**3) * kg,
        "min": Unit(Fraction(60)) * second, "h": Unit(Fraction(3600)) * second, "hour": Unit(Fraction(3600)) * second,
        "deg": degree, "degree": degree, "°": degree, "gon": Unit(Fraction(1, 200), turns=1, angle=1),
        "rpm": Unit(Fraction(1, 30), turns=1, time=-1, angle=1), "rev": Unit(Fraction(2), turns=1, angle=1),
        "hp": Unit(Fraction(550)) * foot * pound_force * second**-1,
        "bar": Unit(ten**5) * pascal, "l": Unit(ten**-3) * metre**3, "L": Unit(ten**-3) * metre**3,
        "cc": Unit(ten**-6) * metre**3, "%": Unit(ten**-2),
        "in": inch, "inch": inch, "ft": foot, "foot": foot, "feet": foot,
        "lb": pound, "lbm": pound, "lbf": pound_force,
        "klbf": Unit(ten**3) * pound_force, "kip": Unit(ten**3) * pound_force,
        "psi": psi, "ksi": Unit(ten**3) * psi, "kpsi": Unit(ten**3) * psi, "Mpsi": Unit(ten**6) * psi,
        "lbs": pound, "klb": Unit(ten**3) * pound, "klbm": Unit(ten**3) * pound,
        "usft": Unit(Fraction(1200, 3937)) * metre, "kft": Unit(ten**3) * foot, "hr": Unit(Fraction(3600)) * second,
        "ppf": pound * foot**-1, "pcf": pound * foot**-3,
        "gal": gallon, "ppg": pound * gallon**-1,
        **dict.fromkeys(("bbl", "bbls", "barrel", "barrels"), Unit(Fraction(42)) * gallon),
        "sg": Unit(ten**3) * kg * metre**-3,
    }  # fmt: skip
    return units


TABLE = _table()
"""Units read without pint. `bbl` is the oil barrel of 42 US gallons, so is `barrel`, which is another
one to pint. `ppg` are pounds per US gallon, `ppf` and `pcf` pounds per foot and per cubic foot, `sg`
1000 kg/m^3, `usft` the foot of the US survey."""

METRIC = frozenset("meter gram second newton pascal joule watt hertz radian liter bar dyne erg poise stokes".split())
"""Units, by pint's names, that take any SI prefix. Others take those in the table: pint would read `mpsi` as a
thousandth of a psi and `pin` as a picoinch, which nobody means."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>[A-Za-zµμ]+|°|%)"
    r"(?:\s*(?:\^|\*\*)\s*(?P<power>-?\d{1,2}|\(-?\d{1,2}\))|(?P<bare>-?\d)(?![\d.])|(?P<raised>⁻[¹²³⁴]|[²³⁴]))?"
    r"|(?P<divide>/)|(?P<times>\*|·|⋅|-(?=[A-Za-z]))|(?P<open>\()|(?P<close>\)))"
)
RAISED = str.maketrans("⁻¹²³⁴", "-1234")
"""Powers that are written above the line."""
JOINED = re.compile("[A-Za-z]+(?:_[A-Za-z]+)+")
"""Names of two words or more, joined by lines below."""
PREFIX = re.compile("da|[numcdhkgtµμ]")
"""Prefixes of a thousand and the like, in small letters."""
LONGEST = 80
RPM = 2.0 * math.pi / 60.0
"""One turn a minute, rad/s."""


class UnknownUnit(ValueError):
    """A unit that neither the table nor pint knows, or an expression that is none; ``str()`` says which.

    Attributes
    ----------
    cause : str
        What is wrong.
    name : str
        The unit that is not known; empty of an expression that is none.
    """

    def __init__(self, cause: str, name: str = "") -> None:
        super().__init__(cause, name)
        self.cause, self.name = cause, name

    def __str__(self) -> str:
        return f"{self.cause}; {nearest_unit(self.name, TABLE)}" if self.name else self.cause

    def told(self, written: str, wanted: Unit) -> str:
        """The same where a unit of one kind is wanted: of others only one that is nearly what was written is named.

        Parameters
        ----------
        written : str
            The whole expression, of which the unit that is not known may be a part.
        wanted : Unit
        """
        if not self.name:
            return self.cause
        alike = [name for name, unit in TABLE.items() if unit.dimension == wanted.dimension]
        # A name that is all of the unit can be none of another quantity: `xpm` is no rpm where a speed is wanted.
        alone = written.strip() == self.name
        meant = (nearest_unit(self.name, known) for known in ((alike,) if alone else (alike, TABLE)) if known)
        close = next((one for one in meant if one.startswith("did you mean")), "")
        if not close and alone and alike:
            close = f"known: {', '.join(alike)}"
        return f"{self.cause}; {close}" if close else self.cause


class Uncounted(ValueError):
    """A rate that does not say whether turns or radians are counted."""


def converted(written: Unit, wanted: Unit) -> Unit:
    """The unit by which a number of ``written`` is read where ``wanted`` is expected: of the same dimension.

    A turn is a cycle, so that 60 rpm are 1 Hz. A frequency may also be written as so many per time, ``12 1/min``. A
    rotary speed may not, nor in Hz, as that can be meant as turns and as radians. Elsewhere a radian is one.

    Raises
    ------
    Uncounted
        For a rotary speed or acceleration of something that is not counted.
    """
    if wanted.cycles and written.angle == wanted.cycles and not written.cycles:
        return written * TURN**-wanted.cycles
    if wanted.angle and (written.cycles or (wanted.is_rate and written.angle != wanted.angle)):
        raise Uncounted("does not say whether turns or radians are counted")
    return written


TURN = Unit(Fraction(2), turns=1, angle=1)


@functools.lru_cache(maxsize=512)
def read_unit(text: str) -> Unit:
    """Read a unit expression such as ``kg/m^3``, ``N m s/rad``, ``deg/30m`` or ``ft-lbf``.

    Factors are taken from left to right; a number after a stroke belongs with the unit after it, so ``deg/30 m`` is
    degrees per thirty metres.

    Raises
    ------
    UnknownUnit
        If a name is unknown or means several units, or the expression cannot be read.
    """
    if len(text) > LONGEST:
        raise UnknownUnit("too long for a unit")
    tokens, at = [], 0
    while at < len(text.rstrip()):
        match = TOKEN.match(text, at)
        if match is None:
            raise _no_part(text, at)
        tokens.append(match)
        at = match.end()
    unit, rest = _product(tokens)
    if rest:
        raise UnknownUnit("a closing bracket too many")
    return unit


def _no_part(text: str, at: int) -> UnknownUnit:
    """The refusal of what begins at a place of a text and is no part of a unit; a name with a line in it is told whole.

    So pint and others write names of two words, such as `short_ton`.
    """
    whole = next((word[0] for word in JOINED.finditer(text) if word.start() < at < word.end()), "")
    if why := unclear(whole):
        return UnknownUnit(f"'{whole}' {why}")
    return UnknownUnit(f"'{text[at:].strip()}' is not part of a unit")


def _product(tokens: list[re.Match[str]]) -> tuple[Unit, list[re.Match[str]]]:
    unit, sign, empty = Unit(Fraction(1)), 1, True
    while tokens and not tokens[0]["close"]:
        token, *tokens = tokens
        if token["divide"] or token["times"]:
            if sign < 0 or (empty and token["times"]):
                raise UnknownUnit("two signs in a row")
            sign = -1 if token["divide"] else 1
            empty = False
            continue
        if token["open"]:
            inner, tokens = _product(tokens)
            if not tokens:
                raise UnknownUnit("a bracket is not closed")
            tokens = tokens[1:]
        elif token["number"]:
            inner = Unit(Fraction(token["number"]))
            if inner.factor == 0 or not (sign < 0 or (empty and tokens and tokens[0]["divide"])):
                raise UnknownUnit(f"the number {token['number']} cannot be part of a unit there")
            if sign < 0 and tokens and tokens[0]["name"]:
                inner, tokens = inner * _unit_factor(tokens[0]), tokens[1:]
        else:
            inner = _unit_factor(token)
        unit, sign, empty = unit * inner**sign, 1, False
    if empty or sign < 0:
        raise UnknownUnit("a unit is missing")
    return unit, tokens


def _unit_factor(token: re.Match[str]) -> Unit:
    name = token["name"]
    if name not in TABLE and (why := unclear(name)):
        raise UnknownUnit(f"'{name}' {why}")
    raised = (token["raised"] or "").translate(RAISED)
    power = int((token["power"] or token["bare"] or raised or "1").strip("()"))
    return (TABLE.get(name) or ask_pint(name)) ** power


def nearest_unit(written: str, known: Iterable[str]) -> str:
    """Say which known unit was probably meant, or list those there are.

    One that differs from what was written by prefixes only, such as kN from kkN, is never said to be meant: the numbers
    would be read a thousandth, or a thousand times, as large.
    """
    units = list(known)
    told = nearest(written, units)
    by_prefix = any(told == f"did you mean '{unit}'?" for unit in units if _differs_by_prefix(written, unit))
    return f"known: {', '.join(units)}" if by_prefix else told


def _differs_by_prefix(one: str, other: str) -> bool:
    ways, others = _prefixes(one), _prefixes(other)
    # The same prefixes with the same name are one unit, in other letters or as a plural.
    return any(name in others and others[name] != prefix for name, prefix in ways.items()) and not any(
        others.get(name) == prefix for name, prefix in ways.items()
    )


def _prefixes(unit: str) -> dict[str, str]:
    """Ways to read a unit as a name behind prefixes, of which there may be none or more than one."""
    rest = unit[:LONGEST].lower()
    rest = rest[:-1] if len(rest) > 2 and rest.endswith("s") else rest
    found, reached = {rest: ""}, [(rest, "")]
    while reached:
        name, before = reached.pop()
        for end in (1, 2):
            if end < len(name) and PREFIX.fullmatch(name[:end]) and name[end:] not in found:
                found[name[end:]] = before + name[:end]
                reached.append((name[end:], before + name[:end]))
    return found


@functools.lru_cache(maxsize=256)
def ask_pint(name: str) -> Unit:
    """Look a single unit up in pint.

    Raises
    ------
    UnknownUnit
        If pint does not know it, if it has an offset (a temperature scale), or a prefix that it does not take.
    """
    registry = pint_registry()
    try:
        found = registry.parse_units(name)
        base = registry.Quantity(1.0, found).to_base_units()
        magnitude = float(base.magnitude)
        twice = float(registry.Quantity(2.0, found).to_base_units().magnitude)
        dimension = {str(key): float(value) for key, value in base.dimensionality.items()}
        counted = {str(key): float(value) for key, value in base.unit_items()}
    except Exception as error:  # pint raises a dozen kinds, and for a name that a person typed all mean the same
        raise UnknownUnit(f"unknown unit '{name}'", name) from error
    prefix, stem, _ = registry.parse_unit_name(name)[0]
    if prefix and stem not in METRIC:
        said = f"'{name}' would be a {prefix}{stem.replace('_', ' ')}, and that unit takes no such prefix"
        raise UnknownUnit(said, name)
    exponents = {key: dimension.pop(f"[{key}]", 0.0) for key in ("mass", "length", "time")}
    offset = not math.isclose(twice, 2.0 * magnitude, rel_tol=1e-12)
    if (
        not math.isfinite(magnitude)
        or magnitude <= 0.0
        or offset
        or any(not n.is_integer() for n in exponents.values())
    ):
        raise UnknownUnit(f"unit '{name}' cannot be used here")
    # Counts have no dimension in pint, and are neither turns nor cycles: a becquerel is no frequency.
    dimension |= {key: counted[key] for key in ("count",) if key in counted}
    other = " ".join(f"{key}^{value:g}" for key, value in sorted(dimension.items()))
    mass, length, time = (int(exponents[key]) for key in ("mass", "length", "time"))
    angle, cycles = int(counted.get("radian", 0.0)), int(stem == "hertz")
    return Unit(Fraction(magnitude), 0, mass, length, time, other, angle, cycles)


@functools.cache
def pint_registry() -> Any:
    """Return pint's registry with the units of the oilfield that it lacks; loaded when first asked for."""
    import pint

    registry: Any = pint.UnitRegistry()
    registry.define("ppg = pound / gallon")
    registry.define("ppf = pound / foot")
    registry.define("pcf = pound / foot ** 3")
    registry.define("fpm = foot / minute")
    registry.define("sg = 1000 kilogram / meter ** 3")
    return registry
