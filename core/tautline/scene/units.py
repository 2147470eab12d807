"""Units of measure, exact where they are exact.

Common units are in a table of fractions, so that `36 mm` is 0.036 to the last bit and no library need be loaded.
Any other name is asked of pint, whose import takes half a second. A test proves that the table equals pint.
"""

from __future__ import annotations

import functools
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from tautline.scene.refusal import nearest


@dataclass(frozen=True)
class Unit:
    """A unit: ``factor * pi**turns`` in SI, with exponents of mass, length and time (and the rest as text)."""

    factor: Fraction
    turns: int = 0
    mass: int = 0
    length: int = 0
    time: int = 0
    other: str = ""

    @property
    def dimension(self) -> tuple[int, int, int, str]:
        """Exponents of mass, length and time, and any other dimension by name; angles have none."""
        return self.mass, self.length, self.time, self.other

    def __mul__(self, unit: Unit) -> Unit:
        return Unit(
            self.factor * unit.factor,
            self.turns + unit.turns,
            self.mass + unit.mass,
            self.length + unit.length,
            self.time + unit.time,
            " ".join(sorted(f"{self.other} {unit.other}".split())),
        )

    def __pow__(self, n: int) -> Unit:
        other = " ".join([f"({self.other})^{n}".replace(" ", "*")] if self.other and n != 1 else [self.other])
        return Unit(self.factor**n, self.turns * n, self.mass * n, self.length * n, self.time * n, other)

    def si(self, number: Fraction) -> float:
        """Value in SI of so many of this unit, rounded once (twice where pi is in it)."""
        exact = float(number * self.factor)
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
        "Hz": (Unit(one, time=-1), ("", "k", "m")),
        "rad": (Unit(one), ("", "m")),
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
    units |= {
        "t": Unit(ten**3) * kg, "tonne": Unit(ten**3) * kg,
        "min": Unit(Fraction(60)) * second, "h": Unit(Fraction(3600)) * second, "hour": Unit(Fraction(3600)) * second,
        "deg": Unit(Fraction(1, 180), turns=1), "degree": Unit(Fraction(1, 180), turns=1),
        "°": Unit(Fraction(1, 180), turns=1), "rpm": Unit(Fraction(1, 30), turns=1, time=-1),
        "bar": Unit(ten**5) * pascal, "l": Unit(ten**-3) * metre**3, "L": Unit(ten**-3) * metre**3,
        "cc": Unit(ten**-6) * metre**3, "%": Unit(ten**-2),
        "in": inch, "inch": inch, "ft": foot, "foot": foot, "feet": foot,
        "lb": pound, "lbm": pound, "lbf": pound_force,
        "klbf": Unit(ten**3) * pound_force, "kip": Unit(ten**3) * pound_force,
        "psi": pound_force * inch**-2, "ksi": Unit(ten**3) * pound_force * inch**-2,
        "Mpsi": Unit(ten**6) * pound_force * inch**-2,
        "lbs": pound, "kft": Unit(ten**3) * foot, "hr": Unit(Fraction(3600)) * second,
        "ppf": pound * foot**-1, "pcf": pound * foot**-3,
        "gal": gallon, "ppg": pound * gallon**-1, "bbl": Unit(Fraction(42)) * gallon,
        "sg": Unit(ten**3) * kg * metre**-3,
    }  # fmt: skip
    return units


TABLE = _table()
"""Units read without pint. `bbl` is the oil barrel of 42 US gallons, `ppg` pounds per US gallon, `ppf`
and `pcf` pounds per foot and per cubic foot, `sg` 1000 kg/m^3."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?)"
    r"|(?P<name>[A-Za-zµμ]+|°|%)"
    r"(?:\s*(?:\^|\*\*)\s*(?P<power>-?\d{1,2}|\(-?\d{1,2}\))|(?P<bare>-?\d)(?![\d.])|(?P<raised>[²³⁴]))?"
    r"|(?P<divide>/)|(?P<times>\*|·|⋅|-(?=[A-Za-z]))|(?P<open>\()|(?P<close>\)))"
)
LONGEST = 80


class UnknownUnit(ValueError):
    """A unit that neither the table nor pint knows, or an expression that is none; ``str()`` says which."""


@functools.lru_cache(maxsize=512)
def read_unit(text: str) -> Unit:
    """Read a unit expression such as ``kg/m^3``, ``N m s/rad``, ``deg/30m`` or ``ft-lbf``.

    Factors are taken from left to right; a number after a stroke belongs with the unit after it, so ``deg/30 m`` is
    degrees per thirty metres.

    Raises
    ------
    UnknownUnit
        If a name is unknown or the expression cannot be read.
    """
    if len(text) > LONGEST:
        raise UnknownUnit("too long for a unit")
    tokens, at = [], 0
    while at < len(text.rstrip()):
        match = TOKEN.match(text, at)
        if match is None:
            raise UnknownUnit(f"'{text[at:].strip()}' is not part of a unit")
        tokens.append(match)
        at = match.end()
    unit, rest = _product(tokens)
    if rest:
        raise UnknownUnit("a closing bracket too many")
    return unit


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
                inner, tokens = inner * _named(tokens[0]), tokens[1:]
        else:
            inner = _named(token)
        unit, sign, empty = unit * inner**sign, 1, False
    if empty or sign < 0:
        raise UnknownUnit("a unit is missing")
    return unit, tokens


def _named(token: re.Match[str]) -> Unit:
    name = token["name"]
    raised = {"²": "2", "³": "3", "⁴": "4"}.get(token["raised"] or "", "")
    power = int((token["power"] or token["bare"] or raised or "1").strip("()"))
    return (TABLE.get(name) or ask_pint(name)) ** power


@functools.lru_cache(maxsize=256)
def ask_pint(name: str) -> Unit:
    """Look a single unit up in pint.

    Raises
    ------
    UnknownUnit
        If pint does not know it, or if it has an offset (a temperature scale).
    """
    registry = pint_registry()
    try:
        base = registry.Quantity(1.0, registry.parse_units(name)).to_base_units()
        magnitude = float(base.magnitude)
        dimension = {str(key): float(value) for key, value in base.dimensionality.items()}
    except Exception as error:  # pint raises a dozen kinds, and for a name that a person typed all mean the same
        raise UnknownUnit(f"unknown unit '{name}'; {nearest(name, TABLE)}") from error
    exponents = {key: dimension.pop(f"[{key}]", 0.0) for key in ("mass", "length", "time")}
    if not math.isfinite(magnitude) or magnitude <= 0.0 or any(not n.is_integer() for n in exponents.values()):
        raise UnknownUnit(f"unit '{name}' cannot be used here")
    other = " ".join(f"{key}^{value:g}" for key, value in sorted(dimension.items()))
    mass, length, time = (int(exponents[key]) for key in ("mass", "length", "time"))
    return Unit(Fraction(magnitude), 0, mass, length, time, other)


@functools.cache
def pint_registry() -> Any:
    """Return pint's registry with the units of the oilfield that it lacks; loaded when first asked for."""
    import pint

    registry: Any = pint.UnitRegistry()
    registry.define("ppg = pound / gallon")
    registry.define("ppf = pound / foot")
    registry.define("pcf = pound / foot ** 3")
    registry.define("sg = 1000 kilogram / meter ** 3")
    return registry
