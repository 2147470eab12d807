"""What a crane stands on and in: the vessel and its motion, turning frames, water and ground."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag, model_validator

from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.choices.words import word
from tautline.scene.functions import Constant, FunctionOfTime, Harmonic, Spectrum, branches, terms_of, time_function
from tautline.scene.model import MARK, Model
from tautline.scene.names import Name
from tautline.scene.reading.files import FileName
from tautline.scene.refusal import fault, nearest, raise_all
from tautline.scene.values.quantity import quantity
from tautline.scene.values.units import UnknownUnit, read_unit
from tautline.scene.vector import Position, listed

if TYPE_CHECKING:
    import numpy as np

ZERO = Constant(value=0.0)
IN_SEA = ("heave", "pitch", "roll", "surge", "sway")
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

    @property
    def sea(self) -> Spectrum | None:
        """The sea that its motion is the response to; None where there is none, or only the motion is known.

        Where motions have spectra of their own, the first one of `IN_SEA` says what the sea is.
        """
        if isinstance(self.motion, SeaMotion):
            return self.motion.sea
        return next(iter(self.seas.values()), None)

    @property
    def seas(self) -> dict[str, Spectrum]:
        """Spectra that its motions have of their own, by the motion."""
        found = {name: getattr(self.motion, name, None) for name in IN_SEA}
        return {name: one for name, one in found.items() if isinstance(one, Spectrum)}


WAVES = ("spectrum", "harmonic", "sum")
Elevation = Annotated[
    Any,
    OneOf(
        "waves",
        {key: branch for key, branch in branches("m", "heave").items() if key in WAVES},
        Branch(Annotated[Literal["vessel"], word("vessel", forms=[f"{{{way}: ...}}" for way in WAVES])], str),
        example="{spectrum: {significant_height: 1.5, peak_period: 8, ramp: 20}}, or vessel",
    ),
]


class WaterWaves(Model):
    """Long-crested waves on the water, which act on bodies with a `height`.

    Attributes
    ----------
    elevation : function of time, or ``vessel``
        Height of the surface above its level, m: a harmonic, a spectrum, or a sum of them, where x = y = 0. Or the sea
        that the vessel's motion is the response to.
    direction : float or None
        In which they run, rad, from x towards y; None for that of the vessel's responses, or along x.
    """

    elevation: Elevation = Field(examples=["{spectrum: {significant_height: 1.5, peak_period: 8, ramp: 20}}"])
    direction: Annotated[float, quantity("rad", of="angle")] | None = None

    @model_validator(mode="after")
    def _sines(self) -> WaterWaves:
        if self.elevation != "vessel":
            _check_sines(self.elevation)
        return self


def _check_sines(elevation: Any) -> None:
    """Refuse a function of time that is no sum of waves which grow together."""
    terms = [term for _, term in terms_of(elevation)]
    for term in terms:
        if not isinstance(term, (Harmonic, Spectrum)):
            cause = "holds a function that is no wave: each wave has a length of its own, by its frequency"
            raise fault("elevation", cause, "give a spectrum, a harmonic, or a sum of these")
        if isinstance(term, Harmonic) and term.mean != 0.0:
            raise fault("elevation", "has a mean, and waves have none", "give that level as water.surface")
        if isinstance(term, Spectrum) and "rao" in term.model_fields_set:
            raise fault("elevation", "has a response `rao`, and it is the sea itself", "remove `rao`")
    if len({term.ramp for term in terms}) > 1:
        raise fault("elevation", "has terms of several ramps, and waves grow together", "give each the same `ramp`")


DEPTHS = listed(None, "depths below the surface", "[0, 50, 400]")
SPEEDS = listed(None, "a speed for each depth", "[0.9, 0.5, 0.1]")
WAYS = listed(None, "a direction for each depth", "[30 deg, 30 deg, 60 deg]")


def _entries(given: tuple[float, ...]) -> str:
    return "1 entry" if len(given) == 1 else f"{len(given)} entries"


class CurrentProfile(Model):
    """A current by `depth` below the surface, m: `speed` m/s at each, and `direction` rad, which may be that of all.

    Components of the velocity go along straight lines between the depths, and are constant beyond.
    """

    depth: Annotated[tuple[Annotated[float, quantity("m", nonnegative=True, of="depth")], ...], DEPTHS] = Field(
        examples=["[0, 50, 400]"]
    )
    speed: Annotated[tuple[Annotated[float, quantity("m/s", nonnegative=True, of="current speed")], ...], SPEEDS] = (
        Field(examples=["[0.9, 0.5, 0.1]"])
    )
    direction: Annotated[tuple[Annotated[float, quantity("rad", of="angle")], ...], WAYS] | None = None

    @model_validator(mode="after")
    def _rows(self) -> CurrentProfile:
        for key in ("speed", "direction"):
            given = getattr(self, key)
            if given is not None and len(given) != len(self.depth):
                cause = f"has {_entries(given)}, and depth has {len(self.depth)}"
                raise fault(key, cause, f"give a {key} for every depth")
        for i, (above, below) in enumerate(pairwise(self.depth), 1):
            if not below > above:
                cause = f"must be deeper than the one before ({above:g} m)"
                raise fault(("depth", i), cause, "put the depths in increasing order, each once")
        return self


class Current(Model):
    """A steady, level current, which moves all water at a depth alike.

    Attributes
    ----------
    speed : float or None
        At all depths, m/s; None where there is a `profile`.
    direction : float
        To which it flows, rad, from x towards y.
    profile : CurrentProfile or None
        By depth, in place of `speed`.
    """

    speed: Annotated[float, quantity("m/s", nonnegative=True, of="current speed")] | None = None
    direction: Annotated[float, quantity("rad", of="angle")] = 0.0
    profile: CurrentProfile | None = None

    @model_validator(mode="after")
    def _one(self) -> Current:
        if self.speed is None and self.profile is None:
            raise fault("speed", "is missing", "give speed, such as 0.8 m/s, or a profile of depth and speed")
        if self.speed is not None and self.profile is not None:
            raise fault("speed", "is given, and a profile too", "keep one of them")
        if self.profile is not None and self.profile.direction is not None and "direction" in self.model_fields_set:
            raise fault("direction", "is given, and profile.direction too", "keep one of them")
        return self

    @property
    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Depths (n,) m, and velocities (n, 2) m/s there."""
        import numpy as np

        if self.profile is None:
            depth, speed, ways = np.zeros(1), np.full(1, self.speed), np.full(1, self.direction)
        else:
            depth, speed = np.array(self.profile.depth), np.array(self.profile.speed)
            given = self.profile.direction
            ways = np.full(depth.size, self.direction) if given is None else np.array(given)
        return depth, np.stack([speed * np.cos(ways), speed * np.sin(ways)], axis=1)

    @property
    def flows(self) -> bool:
        """Whether water moves at any depth."""
        return any(self.profile.speed) if self.profile is not None else bool(self.speed)


class Water(Model):
    """Water below `surface`, m, with `waves` and a `current` or still; `rope_drag` and `added_mass` are coefficients of
    the rope across it.

    Waves do not act on the rope.
    """

    surface: Annotated[float, quantity("m", of="position")] = Field(examples=["0"])
    density: Annotated[float, quantity("kg/m^3", positive=True, of="water density")] = Field(examples=["1025"])
    waves: WaterWaves | None = None
    current: Current | None = None
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
