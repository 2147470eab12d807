"""A drill string in a well, as it is written in a YAML file.

The models below hold what the file says, in SI, validated; `Wellbore` and the builder compute with it.
"""

from __future__ import annotations

from itertools import takewhile
from math import hypot
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from drillstring.scene.ends import Bit, Top
from drillstring.scene.hole import MOST_ELEMENTS, Well
from drillstring.scene.tubulars import EXAMPLE, INCH, NoSuchTubular, find
from tautline.errors import ArgumentTypeError
from tautline.scene.choices.words import UnitSystem, word
from tautline.scene.errors import SceneError
from tautline.scene.limits import Limits
from tautline.scene.model import Model, Scene, Switch, Whole
from tautline.scene.names import Name
from tautline.scene.reading.document import Document
from tautline.scene.refusal import fault
from tautline.scene.solver import Output, Solver, check_output
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import EARTH_GRAVITY

STRING = "[{name: drill pipe, length: rest, od: 0.127, id: 0.1086}]"

Density = Annotated[float, quantity("kg/m^3", positive=True, of="pipe density")]
MudDensity = Annotated[float, quantity("kg/m^3", positive=True, of="mud density")]
Modulus = Annotated[float, quantity("Pa", positive=True, of="Young's modulus")]
ShearModulus = Annotated[float, quantity("Pa", positive=True, of="shear modulus")]
Diameter = Annotated[float, quantity("m", positive=True, of="pipe diameter")]
Bore = Annotated[float, quantity("m", nonnegative=True, of="pipe diameter")]
Offset = Annotated[float, quantity("m", of="eccentricity")]


def _either(schema: dict[str, Any]) -> None:
    """Say in the JSON schema that a tubular stands for name and diameters."""
    needed = schema.pop("required")
    schema["anyOf"] = [{"required": ["tubular", "length"]}, {"required": needed}]


class Section(Model):
    """A piece of the string of one kind; `length` is a number or ``rest``, what the hole leaves for it.

    `tubular` names one of the catalogue, which gives name, diameters, mass and yield load where they are not given.

    Attributes
    ----------
    tool_joint_id : float, optional
        Bore of the tool joints whose length and spacing are given, m.
    tool_joint_length : float, optional
        Of pin and box together, m. With `tool_joint_spacing` they count in rotary inertia and torsional stiffness
        (which else are the tube's), of 5 in 19.50 lb/ft pipe 1.31 and 1.05 times as much.
    tool_joint_spacing : float, optional
        From one tool joint to the next, m.
    """

    model_config = ConfigDict(json_schema_extra=_either)

    tubular: str | None = Field(None, examples=["5 in 19.50 lb/ft S135"])
    name: Name = Field(examples=["drill pipe"])
    length: Annotated[float | Literal["rest"], quantity("m", positive=True, words=("rest",), of="length")] = Field(
        examples=["270 m"]
    )
    od: Diameter = Field(examples=["5 in"])
    id: Bore = Field(examples=["4.276 in"])
    tool_joint_od: Diameter | None = None
    tool_joint_id: Bore | None = Field(None, examples=["2.75 in"])
    tool_joint_length: Annotated[float, quantity("m", positive=True, of="length")] | None = Field(
        None, examples=["0.53 m"]
    )
    tool_joint_spacing: Annotated[float, quantity("m", positive=True, of="length")] | None = Field(
        None, examples=["9.4 m"]
    )
    second_moment: Annotated[float, quantity("m^4", positive=True, of="second moment")] | None = None
    mass_per_length: Annotated[float, quantity("kg/m", positive=True, of="pipe mass per length")] | None = None
    yield_load: Annotated[float, quantity("N", positive=True, of="yield load")] | None = None
    eccentricity: tuple[Offset, Offset] = Field(
        (0.0, 0.0), examples=["[0, 1.5 mm]"], description="both components, in the frame that turns with the pipe"
    )
    youngs_modulus: Modulus | None = None
    shear_modulus: ShearModulus | None = None
    density: Density | None = None
    elements: Annotated[Whole, Field(ge=1, le=MOST_ELEMENTS)] | None = None

    @property
    def contact_diameter(self) -> float:
        """Diameter that touches the wall, m: the tool joint's where given."""
        return self.od if self.tool_joint_od is None else self.tool_joint_od

    def _of_tubular(self, key: str) -> bool:
        """Whether a diameter is that of the tubular, which nobody has written."""
        return self.tubular is not None and find(self.tubular).keys().get(key) == getattr(self, key)

    def too_wide(self, hole: float) -> tuple[str, str, str]:
        """Key that says how wide it is, what does not fit into a hole of a diameter, m, and what to do.

        Of a tubular nobody has written a width. Without any room a contact has no side to press on: the direction of
        its force is that of the pipe's offset, which is none.
        """
        key, what = ("od", "outside diameter") if self.tool_joint_od is None else ("tool_joint_od", "tool joint")
        if not self._of_tubular(key):
            if self.contact_diameter == hole:
                cure = f"make {key} smaller, such as by 1 mm: a contact needs some clearance, to know where it presses"
                return key, "exactly as wide, does not fit", cure
            return key, "does not fit", f"widen well.diameter, or give a smaller {key}"
        size = _inches(self.contact_diameter)
        return "tubular", f"its {what}, {size}, does not fit", f"widen well.diameter, or take one of a smaller {what}"

    @model_validator(mode="before")
    @classmethod
    def _standard(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "tubular" not in data:
            return data
        words = data["tubular"]
        if not isinstance(words, str):
            kind = "is empty" if words is None else "must be a text"
            raise fault("tubular", kind, f"give a tubular {EXAMPLE}; `drillstring tubulars` lists all")
        if behind := _cut_off(data):
            name = ", ".join([words, *behind])
            raise fault("tubular", f"is cut at a comma, before '{behind[0]}'", f"write the name in quotes: '{name}'")
        try:
            standard = find(words)
        except NoSuchTubular as none:
            raise fault("tubular", none.cause, none.cure) from None
        return standard.keys(*(_diameter(data, key) for key in ("od", "id"))) | data

    @model_validator(mode="after")
    def _pipe(self) -> Section:
        if self.od <= self.id and self._of_tubular("od"):
            cause = f"leaves no wall: the od of the tubular is {_inches(self.od)}"
            raise fault("id", cause, "give a smaller id, or write od too")
        if self.od <= self.id:
            relation = "equal to" if self.od == self.id else "smaller than"
            cure = "the outer diameter must be the larger one: swap od and id, or correct the unit"
            if self._of_tubular("id"):
                raise fault("od", f"is {relation} the id of the tubular, {_inches(self.id)}", cure)
            raise fault("od", f"is {relation} the inner diameter", cure, beside=".id")
        if self.tool_joint_od is not None and self.tool_joint_od < self.od and self._of_tubular("tool_joint_od"):
            cause = f"wider than the tool joint of the tubular, {_inches(self.tool_joint_od)}"
            raise fault("od", cause, "give a smaller od, or write tool_joint_od too")
        if self.tool_joint_od is not None and self.tool_joint_od < self.od:
            of = "od of the tubular" if self._of_tubular("od") else "od"
            cause = f"smaller than the {of}, {_inches(self.od)}"
            raise fault("tool_joint_od", cause, "give at least that, or remove it")
        self._joints()
        if hypot(*self.eccentricity) >= 0.5 * self.contact_diameter:
            cause = f"the centre of gravity is {hypot(*self.eccentricity):g} m off the axis, outside of the pipe"
            raise fault("eccentricity", cause, "give some millimetres, such as [0, 2 mm]")
        return self

    def _joints(self) -> None:
        """Refuse tool joints that are given in part, or that cannot be."""
        both = {"tool_joint_length": self.tool_joint_length, "tool_joint_spacing": self.tool_joint_spacing}
        given = [key for key, value in both.items() if value is not None]
        if len(given) == 1:
            (missing,) = set(both) - set(given)
            example = {"tool_joint_length": "0.53 m", "tool_joint_spacing": "9.4 m"}[missing]
            raise fault(given[0], f"has no {missing} beside it", f"give both, such as {missing}: {example}")
        if given and self.tool_joint_od is None:
            raise fault(given[0], "has no tool_joint_od beside it", "give it, such as tool_joint_od: 6.625 in")
        if not given and self.tool_joint_id is not None and not self._of_tubular("tool_joint_id"):
            cause = "has no effect without tool_joint_length and tool_joint_spacing"
            raise fault("tool_joint_id", cause, "give both, or remove it")
        if self.tool_joint_length is not None and self.tool_joint_spacing is not None:
            if self.tool_joint_length >= self.tool_joint_spacing:
                cause = "not shorter than tool_joint_spacing, from one tool joint to the next"
                raise fault("tool_joint_length", cause, "give the length of pin and box together, such as 0.53 m")
            if self.tool_joint_id is not None and self.tool_joint_id >= self.contact_diameter:
                raise fault("tool_joint_id", "not smaller than tool_joint_od", "give the bore of the joint")


def _inches(diameter: float) -> str:
    """A diameter, m, as the catalogue has it, and in m."""
    return f"{diameter / INCH:.5g} in ({diameter:.4g} m)"


def _cut_off(data: dict[str, Any]) -> list[str]:
    """Words of a tubular behind a comma, which braces take for keys without a value."""
    keys = list(data)
    behind = takewhile(
        lambda key: data[key] is None and key not in Section.model_fields, keys[keys.index("tubular") + 1 :]
    )
    return [str(key) for key in behind]


def _diameter(data: dict[str, Any], key: str) -> float | None:
    """A diameter that is given, m; None for one that is not, or that its own field will refuse."""
    try:
        return float(quantity("m").read(data[key])) if key in data else None
    except (PydanticCustomError, ValidationError):
        return None


class Material(Model):
    """Of all sections that do not give their own."""

    youngs_modulus: Modulus
    shear_modulus: ShearModulus
    density: Density


class Mud(Model):
    """The fluid in the hole, and in the string where `inside`; `added_mass` and `drag` are coefficients."""

    density: MudDensity
    added_mass: Annotated[
        float | Literal["annular"], quantity("", nonnegative=True, words=("annular",), of="added mass coefficient")
    ] = 1.0
    drag: Annotated[float, quantity("", nonnegative=True, of="drag coefficient")] = 1.0
    inside: Switch = True
    inside_density: MudDensity | None = None

    @model_validator(mode="after")
    def _filled(self) -> Mud:
        if self.inside_density is not None and not self.inside:
            cause = "is given, and `inside: false` leaves the string empty"
            raise fault("inside_density", cause, "remove one of the two")
        return self


class Damping(Model):
    """Viscous coefficients of one lump (c_r, c_f2 and c_fc of Table 2.4), and of the steel itself.

    `rotation` and `contact_rotation` in N m s/rad, `translation` in N s/m, `structural` in s (times stiffness),
    `mass_proportional` in 1/s.
    """

    rotation: Annotated[float, quantity("N m s/rad", nonnegative=True, of="rotary damping")] = 0.0
    translation: Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")] = 0.0
    contact_rotation: Annotated[float, quantity("N m s/rad", nonnegative=True, of="rotary damping")] = 0.0
    structural: Annotated[float, quantity("s", nonnegative=True, of="damping time")] = 0.0
    mass_proportional: Annotated[float, quantity("1/s", nonnegative=True, of="rate of damping")] = 0.0


LUMPED, BEAM = "lumped", "ale-ancf"
"""Kinds of model: lumps along the hole, or a beam in space of ALE-ANCF elements."""
SOFT_BEAM = "a beam has its stiffness against every bend", "give stiff or none, or take kind: lumped"
"""Why a beam is not soft, and the cure."""
KIND = word(LUMPED, BEAM, aliases={"ancf": BEAM})


class StringModel(Model):
    """How the string is modelled: of which kind, with so many elements, and which bending."""

    kind: Annotated[Literal["lumped", "ale-ancf"], KIND] = "lumped"
    elements: Annotated[Whole, Field(ge=1, le=MOST_ELEMENTS, examples=["12"])]
    bending: Annotated[Literal["stiff", "soft", "none"], word("stiff", "soft", "none")] = "stiff"

    @model_validator(mode="after")
    def _kinds(self) -> StringModel:
        if self.kind == BEAM and self.bending == "soft":
            raise fault("bending", *SOFT_BEAM)
        return self


class DrillstringScene(Scene):
    """A drill string in a well: all that a run needs to know.

    Attributes
    ----------
    document : Document or None
        The file it was read from.
    """

    title: str | None = None
    units: UnitSystem = "si"
    gravity: Annotated[float, quantity("m/s^2", nonnegative=True, of="gravity")] = EARTH_GRAVITY
    well: Well = Field(examples=["{sections: [{hold: 2200 m}], diameter: 0.2032, wall: none}"])
    string: Annotated[tuple[Section, ...], Field(min_length=1, examples=[STRING])]
    material: Material = Field(examples=["{youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}"])
    mud: Mud | None = None
    damping: Damping = Damping()
    top: Top = Top()
    bit: Bit = Bit()
    model: StringModel = Field(examples=["{kind: lumped, elements: 12}"])
    start: Annotated[Literal["static", "relaxed", "straight"], word("static", "relaxed", "straight")] = "static"
    solver: Solver = Field(examples=["{method: generalized-alpha, step: 1 ms, end: 40 s}"])
    output: Output = Field(examples=["{interval: 50 ms}"])
    limits: Limits = ()

    @model_validator(mode="after")
    def _string(self) -> DrillstringScene:
        rests = [i for i, section in enumerate(self.string) if section.length == "rest"]
        if len(rests) > 1:
            raise fault(("string", rests[1], "length"), "a second section is the rest", "give its length as a number")
        return self

    @model_validator(mode="after")
    def _clearance(self) -> DrillstringScene:
        hole = self.well.diameter
        for i, section in enumerate(self.string):
            if section.contact_diameter >= hole:
                key, cause, cure = section.too_wide(hole)
                raise fault(("string", i, key), f"{cause} into the hole", cure, beside="well.diameter")
        return self

    @model_validator(mode="after")
    def _mesh(self) -> DrillstringScene:
        if self.model.elements < len(self.string):
            cause = f"fewer than the {len(self.string)} sections of the string"
            raise fault(("model", "elements"), cause, f"give at least {len(self.string)}: one for each section")
        asked = [section.elements or 0 for section in self.string]
        left = sum(1 for n in asked if n == 0)
        if sum(asked) + left > self.model.elements or (left == 0 and sum(asked) != self.model.elements):
            at = next(i for i, n in enumerate(asked) if n)
            cause = f"the sections ask for {sum(asked) + left} elements, and model.elements is {self.model.elements}"
            raise fault(("string", at, "elements"), cause, "make the two agree, or remove the section's elements")
        return self

    @model_validator(mode="after")
    def _frames(self) -> DrillstringScene:
        check_output(self.solver, self.output)
        return self


def read(path: str | Path | Document) -> DrillstringScene:
    """Read and validate a scene file, or a document that was read already.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    return DrillstringScene.read(path)


def scene_of(source: Any) -> DrillstringScene:
    """The scene of a drill string, or that of a path, text or dict.

    Raises
    ------
    SceneError
        As `tautline.read` does.
    ArgumentTypeError
        For what is none of these, and for the scene of another application.
    """
    from tautline import read as read_any  # looks for what is installed, as this application is

    scene = source if isinstance(source, DrillstringScene) else read_any(source)
    if not isinstance(scene, DrillstringScene):
        raise ArgumentTypeError(f"the scene of a drill string is wanted, not {type(scene).__name__}")
    return scene


def of_kind(scene: DrillstringScene, kind: str) -> DrillstringScene:
    """The scene with its string as a model of some kind; raises SceneError where that cannot have its bending."""
    if kind == BEAM and scene.model.bending == "soft":
        raise SceneError([scene.problem("model.bending", *SOFT_BEAM)])
    return scene.model_copy(update={"model": scene.model.model_copy(update={"kind": kind})})


def check_lengths(scene: DrillstringScene, well_length: float) -> tuple[float, ...]:
    """Lengths of the sections from the rotary table down, with what is left of the hole for ``rest``.

    Parameters
    ----------
    scene : DrillstringScene
        The scene.
    well_length : float
        Measured depth of the hole, m.

    Returns
    -------
    tuple of float
        A length for each section, m.

    Raises
    ------
    SceneError
        If the string is longer than the hole, or nothing is left for ``rest``.
    """
    given = sum(section.length for section in scene.string if section.length != "rest")
    rests = [i for i, section in enumerate(scene.string) if section.length == "rest"]
    left = well_length - given
    if rests and left <= 1e-9 * well_length:
        cause = f"no room is left: the other sections are {given:g} m long, and the hole {well_length:g} m"
        raise SceneError([scene.problem(("string", rests[0], "length"), cause, "shorten them, or deepen the well")])
    if left < -1e-9 * well_length:
        longest = max(range(len(scene.string)), key=lambda i: scene.string[i].length)
        cause = f"the string is {given:g} m long, and the hole {well_length:g} m"
        cure = "shorten the string (`length: rest` fills the hole), or deepen the well"
        raise SceneError([scene.problem(("string", longest, "length"), cause, cure)])
    lengths = tuple(left if section.length == "rest" else section.length for section in scene.string)
    shortest = min(range(len(lengths)), key=lengths.__getitem__)
    if lengths[shortest] <= 1e-9 * well_length:
        cause = f"is so short that it would be lost in rounding: the hole is {well_length:g} m long"
        raise SceneError([scene.problem(("string", shortest, "length"), cause, "give both lengths in the same unit")])
    return lengths


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a drill-string scene."""
    return DrillstringScene.model_json_schema()
