"""The hole as it is written in a scene: its course, its wall, and the friction there."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.choices.words import word
from tautline.scene.model import Model, Whole
from tautline.scene.reading.files import FileName
from tautline.scene.refusal import fault, refusal
from tautline.scene.values.quantity import quantity

MOST_ELEMENTS = 100_000
DRILLED = 0.07
"""Diameter of a hole, m, below which it is one of the laboratory."""

Length = Annotated[float, quantity("m", positive=True, of="length")]
HoleDiameter = Annotated[float, quantity("m", positive=True, of="hole diameter")]
Depth = Annotated[float, quantity("m", positive=True, of="depth")]
BendRadius = Annotated[float, quantity("m", positive=True, of="radius of curvature")]
Distance = Annotated[float, quantity("m", nonnegative=True, of="length")]
Angle = Annotated[float, quantity("rad", of="angle")]
Speed = Annotated[float, quantity("m/s", positive=True, of="slip speed")]
Factor = Annotated[float, quantity("", nonnegative=True, of="friction factor")]
Inclination = Annotated[float, quantity("rad", nonnegative=True, at_most=3.1415926535897936, of="inclination")]


class Hold(Model):
    """A straight piece of the well."""

    length: Distance


OF_THE_WELL = {"diameter": ("", "a hole has one diameter: write it as well.diameter")}
"""What people look for in a section, and where it stands."""


class _Arc(Model):
    """A piece of the well of constant curvature: `radius`, or `rate` in rad/m (``3 deg/30m``)."""

    elsewhere = OF_THE_WELL

    radius: BendRadius | None = Field(None, examples=["1000 m"])
    rate: Annotated[float, quantity("rad/m", positive=True, of="dogleg severity")] | None = None

    @model_validator(mode="after")
    def _one_curvature(self) -> Self:
        if self.radius is None and self.rate is None:
            raise fault("radius", "is missing", "give `radius: 1000 m`, or `rate: 3 deg/30m`")
        if self.radius is not None and self.rate is not None:
            raise fault("rate", "is given together with `radius`", "keep one of the two")
        return self

    @property
    def curvature(self) -> float:
        """Curvature, 1/m."""
        return self.rate if self.rate is not None else 1.0 / self.radius if self.radius else 0.0

    @property
    def key(self) -> str:
        """Which of the two was given."""
        return "rate" if self.rate is not None else "radius"

    @property
    def bend_radius(self) -> float:
        """Radius of the arc, m, whichever of the two was given."""
        return 1.0 / self.curvature


class Build(_Arc):
    """An arc to another inclination (rad), and to another azimuth where one is given."""

    to: Inclination
    azimuth: Angle | None = None


class Turn(_Arc):
    """An arc to another azimuth (rad) at the same inclination."""

    to: Angle


class Survey(Model):
    """A survey file: `md`, `inc`, `azi` are units for its columns, where its header does not state them.

    `max_gap` (m) is the longest interval in which the hole turns and has no station.
    """

    file: FileName
    md: str | None = None
    inc: str | None = None
    azi: str | None = None
    max_gap: Length = Field(500.0, examples=["800 m"])

    @property
    def units(self) -> dict[str, str]:
        """Units that were given, by column."""
        return {key: unit for key, unit in (("md", self.md), ("inc", self.inc), ("azi", self.azi)) if unit is not None}


LAW = word("projection", "karnopp", "regularised", aliases={"regularized": "regularised"})


class Pair(Model):
    """Friction factors at rest and in slip."""

    static: Factor
    kinetic: Factor

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.kinetic > self.static:
            cause = f"larger than static = {self.static:g}"
            raise fault("kinetic", cause, "friction of slip is at most that of rest: swap them, or give one number")
        return self


class Friction(Pair):
    """Coulomb friction of string on wall; speeds in m/s."""

    law: Annotated[Literal["projection", "karnopp", "regularised"], LAW] = "projection"
    slip_velocity: Speed = Field(1.0e-5, examples=["1.0e-5"])
    decay_velocity: Speed = Field(1.0e-3, examples=["1 mm/s"])


AnyFriction = OneOf(
    "friction",
    {},
    plain=Branch(Factor, lambda value: Friction(static=value, kinetic=value)),
    whole=Branch(Friction),
    example="0.2 or {static: 0.3, kinetic: 0.2}",
)


AnyPair = OneOf(
    "friction",
    {},
    plain=Branch(Factor, lambda value: Pair(static=value, kinetic=value)),
    whole=Branch(Pair),
    example="0.2 or {static: 0.25, kinetic: 0.2}",
)


class Casing(Model):
    """The cased part of the hole: measured depth of its `shoe` (m), and friction above it; the law is the wall's."""

    shoe: Depth = Field(examples=["1200 m"])
    friction: Annotated[Pair, AnyPair] = Field(examples=["0.2"])


class Wall(Model):
    """The hole's wall: contact `stiffness` (N/m) and `damping` (N s/m) of one lump of the largest section.

    They hold for a string of `lumps` lumps; the builder scales both by diameter and tributary length.
    """

    stiffness: Annotated[float, quantity("N/m", positive=True, of="contact stiffness")]
    damping: Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")] = 0.0
    lumps: Annotated[Whole, Field(ge=1, le=MOST_ELEMENTS)] = 12
    friction: Annotated[Friction, AnyFriction] = Friction(static=0.0, kinetic=0.0)
    casing: Casing | None = None


def _no_wall(text: str) -> None:
    if text.lower() != "none":
        raise refusal("is not a wall", "write `none` for free space, or {stiffness: 1.0e9, friction: 0.2}")


AnyWall = OneOf(
    "a wall", {}, plain=Branch(str, _no_wall), whole=Branch(Wall), example="{stiffness: 1.0e9, friction: 0.2}, or none"
)
AnySurvey = OneOf(
    "a survey", {}, plain=Branch(str, lambda file: Survey(file=file)), whole=Branch(Survey), example="survey.csv"
)
SECTIONS = "[{hold: 600 m}, {build: {rate: 3 deg/30 m, to: 60 deg}}]"
STRAIGHT_ON = "it goes on as the piece before it ends, and the first as well.inclination and well.azimuth say"
BUILD, TURN = "{rate: 3 deg/30 m, to: 60 deg}", "{rate: 3 deg/30 m, to: 90 deg}"
AnySection = OneOf(
    "a section of the well",
    {
        "hold": Branch(Distance, lambda length: Hold(length=length), without=STRAIGHT_ON),
        "build": Branch(Build, example=BUILD),
        "turn": Branch(Turn, example=TURN),
    },
    example="{hold: 2200 m} or {build: {radius: 1000 m, to: 90 deg}}",
)


class Well(Model):
    """The hole, from the rotary table down; directions at the table in rad."""

    inclination: Inclination = 0.0
    azimuth: Angle = 0.0
    sections: Annotated[tuple[Annotated[Hold | Build | Turn, AnySection], ...], Field(min_length=1)] | None = Field(
        None, examples=[SECTIONS]
    )
    survey: Annotated[Survey | None, AnySurvey] = None
    diameter: HoleDiameter = Field(examples=["8.5 in"])
    wall: Annotated[Wall | None, AnyWall] = Field(examples=["none, or {stiffness: 1.0e9, friction: 0.2}"])

    @model_validator(mode="after")
    def _one_path(self) -> Well:
        if self.sections is None and self.survey is None:
            raise fault("sections", "is missing", "add `sections: [{hold: 2200 m}]`, or `survey: survey.csv`")
        if self.sections is not None and self.survey is not None:
            raise fault("survey", "is given together with `sections`", "keep one of the two")
        return self
