"""A pipe that conveys fluid, as it is written in a YAML file.

The pipe is called a hose and the fluid water, whatever they are. The models below hold what the file says, in SI,
validated; the builder computes with `Hose.pieces`, in which nothing is left open.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, model_validator

from tautline.scene.choices.words import UnitSystem, word
from tautline.scene.errors import SceneError, option_error
from tautline.scene.functions import Constant, FunctionOfTime, time_function
from tautline.scene.limits import Limits
from tautline.scene.model import Model, Scene, Whole, validate
from tautline.scene.reading.document import Document
from tautline.scene.refusal import fault, raise_all
from tautline.scene.solver import Output, Solver, check_output
from tautline.scene.values.magnitude import LARGEST, OUTSIDE, is_outside
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import EARTH_GRAVITY, Direction, Gravity, Position, Vector, Velocity, unit

MOST_ELEMENTS = 100_000
FAR_AWAY = 1.0e9
"""Distance of the root from the origin, in lengths of an element, at which rounding would bend the hose."""
PLAIN_HOSE = "{length: 0.5, elements: 10, axial_stiffness: 10, bending_stiffness: 0.00108, mass_per_length: 0.00313}"

Length = Annotated[float, quantity("m", positive=True, of="length")]
AxialStiffness = Annotated[float, quantity("N", positive=True, of="axial stiffness")]
BendingStiffness = Annotated[float, quantity("N m^2", nonnegative=True, of="bending stiffness")]
MassPerLength = Annotated[float, quantity("kg/m", positive=True, of="mass per length")]
Damping = Annotated[float, quantity("s", nonnegative=True, of="damping time")]
Elements = Annotated[Whole, Field(ge=1, le=MOST_ELEMENTS, examples=["10"])]


SEGMENTS = (
    "[{length: 0.5 m, elements: 4, axial_stiffness: 10 N, bending_stiffness: 0.00108 N*m^2, "
    "mass_per_length: 0.0031 kg/m}]"
)


class Segment(Model):
    """A piece of the hose of one section.

    EA in N, EJ in N m^2, mass in kg/m, `damping` (stress over rate of strain, as a share of the stiffness) in s;
    `water_mass_per_length`, kg/m, where the bore differs from the rest.
    """

    length: Length
    elements: Elements
    axial_stiffness: AxialStiffness = Field(examples=["10 N"])
    bending_stiffness: BendingStiffness = Field(examples=["0.00108 N*m^2"])
    mass_per_length: MassPerLength = Field(examples=["0.0031 kg/m"])
    damping: Damping = 0.0
    water_mass_per_length: MassPerLength | None = None


UNIFORM = ("length", "elements", "axial_stiffness", "bending_stiffness", "mass_per_length", "damping")
"""Keys of a hose of one section, given in place of its segments; all but the last must be."""


class Hose(Model):
    """The pipe: its section or sections, where it begins and how its ends are held.

    Attributes
    ----------
    root, direction : tuple of float
        Where it begins, m, and the way it leaves (of any length but zero).
    clamp : str
        What a clamped end holds: ``direction`` leaves the axial strain free, ``slope`` holds all of r'.
    strain : str
        ``green``, or ``engineering`` for a material that is linear in the stretch.
    """

    length: Length | None = None
    elements: Elements | None = None
    axial_stiffness: AxialStiffness | None = None
    bending_stiffness: BendingStiffness | None = None
    mass_per_length: MassPerLength | None = None
    damping: Damping | None = None
    segments: Annotated[tuple[Segment, ...], Field(min_length=1)] | None = Field(None, examples=[SEGMENTS])
    root: Position = (0.0, 0.0, 0.0)
    direction: Direction = (1.0, 0.0, 0.0)
    clamp: Annotated[Literal["direction", "slope"], word("direction", "slope")] = "direction"
    root_support: Annotated[Literal["clamped", "pinned"], word("clamped", "pinned")] = "clamped"
    end: Annotated[Literal["free", "pinned", "clamped"], word("free", "pinned", "clamped")] = "free"
    tip_mass: Annotated[float, quantity("kg", nonnegative=True, of="mass")] = 0.0
    strain: Annotated[Literal["green", "engineering"], word("green", "engineering")] = "green"

    _water: float | None = PrivateAttr(None)

    @property
    def pieces(self) -> tuple[Segment, ...]:
        """The hose from its root to its tip; a hose of one section is one piece.

        `water_mass_per_length` of each is what flows there, kg/m, and None only where the scene has no water.
        """
        segments = self.segments
        if segments is None:
            given = {key: getattr(self, key) for key in UNIFORM if getattr(self, key) is not None}
            segments = (Segment(**given),)
        return tuple(
            segment.model_copy(update={"water_mass_per_length": self._water})
            if segment.water_mass_per_length is None
            else segment
            for segment in segments
        )

    @property
    def total_length(self) -> float:
        """Unstretched length, m."""
        return sum(piece.length for piece in self.pieces)

    @property
    def element_count(self) -> int:
        """Number of elements of all pieces."""
        return sum(piece.elements for piece in self.pieces)

    @property
    def unit_direction(self) -> Vector:
        """The way the hose leaves its root, as a unit vector."""
        return unit(self.direction)

    @model_validator(mode="after")
    def _one_way(self) -> Hose:
        given = [key for key in UNIFORM if getattr(self, key) is not None]
        if self.segments is not None:
            raise_all(
                (key, "is given together with segments", "give it in each segment, or remove `segments`")
                for key in given
            )
            return self
        lacking = [key for key in UNIFORM[:-1] if key not in given]
        if len(lacking) == len(UNIFORM) - 1:
            cause = "is missing, and there are no segments"
            raise fault("length", cause, f"give {', '.join(UNIFORM[:-1])}, or `segments:` with these")
        raise_all((key, "is missing", f"add `{key}:`, such as {Segment._example(key)}") for key in lacking)
        return self

    @model_validator(mode="after")
    def _place(self) -> Hose:
        if not any(self.direction):
            raise fault("direction", "has no direction: all three numbers are zero", "give one such as [1, 0, 0]")
        total = 0
        for i, piece in enumerate(self.segments or ()):
            total += piece.elements
            if total > MOST_ELEMENTS:
                cause = f"brings the hose to {total} elements, more than {MOST_ELEMENTS}"
                raise fault(("segments", i, "elements"), cause, "take fewer, longer elements")
        for i, piece in enumerate(self.pieces):
            at = () if self.segments is None else ("segments", i)
            raise_all(
                ((*at, key), *OUTSIDE) for key in (*UNIFORM, "water_mass_per_length") if is_outside(getattr(piece, key))
            )
        if is_outside(self.tip_mass):
            raise fault("tip_mass", *OUTSIDE)
        shortest = min(piece.length / piece.elements for piece in self.pieces)
        if max(abs(x) for x in (*self.root, self.total_length)) > FAR_AWAY * shortest:
            cause = f"is so far away that rounding would bend elements of {shortest:.3g} m"
            raise fault("root", cause, "put the origin near the hose, and give positions in m")
        return self


class Water(Model):
    """The fluid: mass per length of hose, kg/m, and its speed relative to the hose, m/s, in the first segment.

    Positive from root to tip; `outlet` is the speed of the jet over that in the hose.
    """

    mass_per_length: MassPerLength = Field(examples=["0.000785 kg/m"])
    speed: Annotated[FunctionOfTime, time_function("m/s", of="flow speed")] = Field(
        examples=["15 m/s, or {ramp: {to: 15, over: 0.1}}"]
    )
    outlet: Annotated[float, quantity("", positive=True, of="ratio of outlet speed")] = 1.0


COUPLINGS = word("linear", "lagrange", "penalty", "augmented")


class HoseScene(Scene):
    """A hose and the water in it: all that a run needs to know.

    Attributes
    ----------
    stiffness : float or None
        Of the springs that tie hose and water, N/m; None for the builder's choice.
    gravity, disturbance : tuple of float
        m/s^2, and the tip's velocity at the start, m/s, which falls off as (s/L)^2 towards the root.
    document : Document or None
        The file it was read from.
    """

    title: str | None = None
    units: UnitSystem = "si"
    hose: Hose = Field(examples=[PLAIN_HOSE])
    water: Water | None = None
    coupling: Annotated[Literal["linear", "lagrange", "penalty", "augmented"], COUPLINGS] = "linear"
    stiffness: Annotated[float, quantity("N/m", positive=True, of="spring stiffness")] | None = None
    gravity: Gravity = (0.0, 0.0, -EARTH_GRAVITY)
    disturbance: Velocity = (0.0, 0.0, 0.0)
    start: Annotated[Literal["straight", "static", "relaxed"], word("straight", "static", "relaxed")] = "straight"
    solver: Solver = Field(examples=["{method: generalized-alpha, rho_inf: 0.9, step: 1 ms, end: 5 s}"])
    output: Output = Field(examples=["{interval: 5 ms}"])
    limits: Limits = ()

    @model_validator(mode="after")
    def _flow(self) -> HoseScene:
        if self.water is None:
            for i, piece in enumerate(self.hose.segments or ()):
                if piece.water_mass_per_length is not None:
                    key = ("hose", "segments", i, "water_mass_per_length")
                    raise fault(key, "is given, and the scene has no water", "add `water:`, or remove this")
            if self.coupling != "linear":
                raise fault("coupling", "there is no water to couple", "add `water:`, or remove this")
        else:
            if is_outside(self.water.mass_per_length):
                raise fault(("water", "mass_per_length"), *OUTSIDE)
            self.hose._water = self.water.mass_per_length
            if self.water.outlet != 1.0 and self.hose.end != "free":
                cause = f"a hose whose end is {self.hose.end} has no jet"
                raise fault(("water", "outlet"), cause, "remove it, or let the end be free")
        if self.stiffness is not None and self.coupling in ("linear", "lagrange"):
            cause = f"is not used: coupling {self.coupling} has no springs"
            raise fault("stiffness", cause, "remove it, or give coupling: penalty or augmented")
        return self

    @model_validator(mode="after")
    def _start(self) -> HoseScene:
        hose = self.hose
        for key in ("gravity", "disturbance"):
            if max(map(abs, getattr(self, key))) > LARGEST:
                raise fault(key, *OUTSIDE)
        if any(self.disturbance) and hose.end != "free":
            cause = f"is a velocity of the tip, which is {hose.end}"
            raise fault("disturbance", cause, "remove it, and let gravity across the hose start the motion")
        if self.start == "static" and not any(self.gravity):
            cause = "there is no rest to be found without gravity: "
            cure = "give gravity, or start: straight"
            if hose.root_support == "pinned" and hose.end == "free":
                raise fault("start", cause + "the hose is pinned at its root and free to turn about it", cure)
            if any(piece.bending_stiffness == 0.0 for piece in hose.pieces):
                raise fault("start", cause + "nothing straightens a hose without bending stiffness", cure)
        return self

    @model_validator(mode="after")
    def _frames(self) -> HoseScene:
        check_output(self.solver, self.output)
        return self


def read(path: str | Path | Document) -> HoseScene:
    """Read and validate a scene file, or a document that was read already.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    return HoseScene.read(path)


def tied(scene: HoseScene) -> HoseScene:
    """The scene with hose and water tied by what they share, without springs or multipliers: the same mechanics.

    Beside springs that are stiff enough to tie, the stiffness of bending is lost in rounding.
    """
    if scene.document is None or scene.coupling == "linear":
        return scene
    values: dict[tuple[str | int, ...], tuple[Any, str]] = {
        ("coupling",): ("linear", "coupling"), ("stiffness",): (None, "stiffness"),
    }  # fmt: skip
    return validate(HoseScene, scene.document.replaced(values))


def with_speed(scene: HoseScene, value: float) -> HoseScene:
    """Copy of a scene whose water flows at a constant speed.

    Parameters
    ----------
    scene : HoseScene
        The scene; it must have water.
    value : float
        Speed in the first segment, m/s.

    Raises
    ------
    SceneError
        If there is no water, or the speed is no finite number.
    """
    if scene.water is None:
        cure = "add `water: {mass_per_length: ..., speed: ...}`"
        raise SceneError([scene.problem("water", "is missing: nothing can flow", cure)])
    if not math.isfinite(value):
        raise option_error("--speed", str(value), "is not a finite number", "give a speed in m/s")
    if scene.document is None:
        water = scene.water.model_copy(update={"speed": Constant(value=float(value))})
        return scene.model_copy(update={"water": water})
    return scene.with_values({("water", "speed"): (float(value), "--speed")})


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a hose scene."""
    return HoseScene.model_json_schema()
