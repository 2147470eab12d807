"""What a crane stands on and in: the vessel and its motion, turning frames, water and ground."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from tautline.scene.functions import Constant, FunctionOfTime, Spectrum, time_function
from tautline.scene.model import MARK, Model
from tautline.scene.names import Name
from tautline.scene.reading.files import FileName
from tautline.scene.refusal import fault, nearest, raise_all
from tautline.scene.values.quantity import quantity
from tautline.scene.values.units import UnknownUnit, read_unit
from tautline.scene.vector import Position

ZERO = Constant(value=0.0)
TRANSLATIONS, ROTATIONS = ("surge", "sway", "heave"), ("roll", "pitch", "yaw")
COLUMNS = dict.fromkeys(("t", "time"), "s") | dict.fromkeys(TRANSLATIONS, "m") | dict.fromkeys(ROTATIONS, "rad")
"""Columns of a file of a vessel's motion, and their units in SI."""

Drift = Annotated[FunctionOfTime, time_function("m", of="surge or sway")]
Heave = Annotated[FunctionOfTime, time_function("m", of="heave")]
Tilt = Annotated[FunctionOfTime, time_function("rad", of="roll or pitch")]
Yaw = Annotated[FunctionOfTime, time_function("rad", of="yaw")]
Slew = Annotated[FunctionOfTime, time_function("rad", of="slew")]
Luff = Annotated[FunctionOfTime, time_function("rad", of="luff")]


class Frame(Model):
    """Turns about a pivot, and carries drums, sheaves, anchors and other frames: a boom.

    Attributes
    ----------
    pivot : tuple of float
        As drawn, m.
    parent : str or None
        What it stands on: a frame, ``vessel`` or ``ground``; None for the vessel where there is one.
    slew, luff : functions of time
        rad, about z and then about its own y.
    """

    name: Name = Field(examples=["boom"])
    pivot: Position = Field(examples=["[0, 0, 0]"])
    parent: str | None = None
    slew: Slew = ZERO
    luff: Luff = ZERO


class Motion(Model):
    """Six motions of a vessel, functions of time: surge, sway, heave in m; roll, pitch, yaw in rad."""

    surge: Drift = ZERO
    sway: Drift = ZERO
    heave: Heave = ZERO
    roll: Tilt = ZERO
    pitch: Tilt = ZERO
    yaw: Yaw = ZERO


def _units(units: dict[str, str]) -> dict[str, str]:
    def faults() -> Any:
        for column, written in units.items():
            if column.lower() not in COLUMNS:
                yield column, "is no column of a motion", nearest(column, COLUMNS)
                continue
            wanted = COLUMNS[column.lower()]
            cure = f"give a unit like {wanted}"
            try:
                if read_unit(written).dimension != read_unit(wanted).dimension:
                    yield column, f"'{written}' is not a unit of {column}", cure
            except UnknownUnit as error:
                yield column, str(error), cure

    raise_all(faults())
    return units


class MotionFile(Model):
    """Six motions from a CSV file of a motion reference unit.

    Attributes
    ----------
    file : str
        Relative to the scene's folder.
    units : dict
        Units of columns whose header gives none: ``{roll: deg}``.
    gap : float or None
        Longest time without a row that is bridged, s.
    ramp, begin : float
        Time over which the motion grows from nothing, and the file's time at the start of the run, s.
    """

    file: FileName
    units: Annotated[dict[str, str], AfterValidator(_units)] = Field(default={}, examples=["{roll: deg, pitch: deg}"])
    gap: Annotated[float, quantity("s", positive=True, of="duration")] | None = None
    ramp: Annotated[float, quantity("s", nonnegative=True, of="duration")] = 0.0
    begin: Annotated[float, quantity("s", of="moment of a record")] = 0.0


class SeaMotion(Model):
    """Six motions in a random sea, by a CSV file of response amplitude operators, relative to the scene's folder.

    `direction` is the one of the sea, rad, where the file holds several.
    """

    sea: Spectrum = Field(examples=["{significant_height: 2.5, peak_period: 9}"])
    rao: FileName = Field(examples=["vessel.csv"])
    direction: Annotated[float, quantity("rad", of="angle")] | None = None

    @model_validator(mode="after")
    def _one_response(self) -> SeaMotion:
        if "rao" in self.sea.model_fields_set:
            cause = "is given together with a file of all six"
            raise fault(("sea", "rao"), cause, "remove it, or write the spectrum under one motion, such as heave")
        return self


def _way(motion: Any) -> str:
    """Which way a motion is written."""
    if isinstance(motion, MotionFile) or (isinstance(motion, dict) and "file" in motion):
        return f"{MARK}file"
    if isinstance(motion, SeaMotion) or (isinstance(motion, dict) and ("sea" in motion or "rao" in motion)):
        return f"{MARK}sea"
    return f"{MARK}six"


AnyMotion = Annotated[
    Annotated[Motion, Tag(f"{MARK}six")]
    | Annotated[MotionFile, Tag(f"{MARK}file")]
    | Annotated[SeaMotion, Tag(f"{MARK}sea")],
    Discriminator(_way),
]


class Vessel(Model):
    """The ship: drums, sheaves, anchors and frames ride on it unless they say otherwise.

    `reference` is the point whose motion is given, m, as drawn.
    """

    reference: Position = Field(examples=["[0, 0, 0]"])
    motion: AnyMotion = Motion()


class Water(Model):
    """Still water below `surface`, m; `rope_drag` and `added_mass` are coefficients of the rope across its length."""

    surface: Annotated[float, quantity("m", of="position")] = Field(examples=["0"])
    density: Annotated[float, quantity("kg/m^3", positive=True, of="water density")] = Field(examples=["1025"])
    rope_drag: Annotated[float, quantity("", nonnegative=True, of="drag coefficient")] = 0.0
    added_mass: Annotated[float, quantity("", nonnegative=True, of="added mass coefficient")] = 0.0


class Ground(Model):
    """Level ground, which bodies land on: height m, stiffness N/m, damping N s/m, coefficient of friction."""

    level: Annotated[float, quantity("m", of="position")] = Field(examples=["0"])
    stiffness: Annotated[float, quantity("N/m", positive=True, of="contact stiffness")] = Field(examples=["1.0e7"])
    damping: Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")] = 0.0
    friction: Annotated[float, quantity("", nonnegative=True, of="friction factor")] = 0.0


class Limits(Model):
    """What an actuator can do: stroke m (either way), speed m/s, acceleration m/s^2; None for no limit."""

    stroke: Annotated[float, quantity("m", positive=True, of="stroke")] | None = None
    speed: Annotated[float, quantity("m/s", positive=True, of="winch speed")] | None = None
    acceleration: Annotated[float, quantity("m/s^2", positive=True, of="acceleration")] | None = None


class HeaveCompensation(Model):
    """Pays out what the heave of the rope's last fixed point takes in: the share `gain`, after a `delay`, s."""

    gain: Annotated[float, quantity("", nonnegative=True, at_most=2.0, of="control gain")] = Field(examples=["0.95"])
    delay: Annotated[float, quantity("s", nonnegative=True, of="delay")] = 0.0
    limits: Limits = Limits()
