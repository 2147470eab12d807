"""A crane, as it is written in a YAML file: a rope, its way over drums and sheaves, and what hangs on it.

The models hold what the file says, in SI, validated. Here is the whole; `crane.scene.path`, `crane.scene.bodies` and
`crane.scene.surroundings` hold its parts, and `crane.scene.consistency` what they must not say of each other. All that
needs geometry, from overlapping sheaves to a body below its sheave, is the builder's to refuse.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from crane.scene.bodies import Body as Body
from crane.scene.bodies import Drag as Drag
from crane.scene.bodies import Release as Release
from crane.scene.bodies import Spring as Spring
from crane.scene.consistency import GROUND, MOST_ELEMENTS, VESSEL, check_consistency
from crane.scene.path import ITEMS, Anchor, Drum, End, PathItem, Sheave
from crane.scene.path import Bearing as Bearing
from crane.scene.path import Brake as Brake
from crane.scene.path import Efficiency as Efficiency
from crane.scene.path import Gains as Gains
from crane.scene.path import Layers as Layers
from crane.scene.surroundings import Frame, Ground, HeaveCompensation, Vessel, Water
from crane.scene.surroundings import Limits as Limits
from crane.scene.surroundings import Motion as Motion
from crane.scene.surroundings import MotionFile as MotionFile
from crane.scene.surroundings import SeaMotion as SeaMotion
from tautline.scene.choices.words import UnitSystem, word
from tautline.scene.limits import Limits as LimitsOfRun
from tautline.scene.model import MARK, Model, Scene, Whole
from tautline.scene.reading.document import Document
from tautline.scene.refusal import fault
from tautline.scene.solver import Output, Solver, check_output
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import EARTH_GRAVITY, Gravity

__all__ = [
    "Anchor", "Bearing", "Body", "Brake", "CraneScene", "Drag", "Drum", "Efficiency", "End", "Frame", "Gains",
    "Ground", "HeaveCompensation", "Layers", "Limits", "Mesh", "Motion", "MotionFile", "PathItem", "Release", "Rope",
    "SeaMotion", "Sheave", "Spring", "Vessel", "Water", "json_schema", "read",
]  # fmt: skip

ELEMENTS_PER_SPAN = 4
PLAIN_ROPE = "{mass_per_length: 6.5, axial_stiffness: 8.0e7}"
PLAIN_PATH = "[{anchor: {name: top, position: [0, 0, 30]}}, {end: {name: hook, body: payload}}]"


class Rope(Model):
    """The rope, the same all along.

    Attributes
    ----------
    mass_per_length, axial_stiffness, bending_stiffness : float
        kg/m; EA, N; EJ, N m^2, where 0 leaves no curvature terms anywhere.
    damping : float
        Stress over rate of strain, as a share of the stiffness, s; None for as much as damps what the mesh cannot carry
        (`crane.assembly.mesh_damping`).
    diameter, breaking_load : float or None
        m and N.
    compression : str
        ``none``: no compression, or ``elastic``.
    strain : str
        ``green``: (lambda^2 - 1)/2, or ``engineering``: lambda - 1, that EA is the stiffness for.
    bending_life : float or None
        Bending cycles that the rope lasts at a fifth of its breaking load, by its maker's tests: for the account of a
        twin (`crane.rope_life.account`).
    length : float or None
        Unstretched, m, from end to end of the path at the start, a drum counting where the rope leaves it; None for the
        length with which the load rests where it is drawn, or `as drawn` the path's own.
    """

    mass_per_length: Annotated[float, quantity("kg/m", positive=True, of="mass per length")] = Field(
        examples=["6.5 kg/m"]
    )
    axial_stiffness: Annotated[float, quantity("N", positive=True, of="axial stiffness")] = Field(examples=["8.0e7 N"])
    bending_stiffness: Annotated[float, quantity("N m^2", nonnegative=True, of="bending stiffness")] = 0.0
    damping: Annotated[float, quantity("s", nonnegative=True, of="damping time")] | None = None
    diameter: Annotated[float, quantity("m", positive=True, of="rope diameter")] | None = None
    breaking_load: Annotated[float, quantity("N", positive=True, of="breaking load")] | None = None
    compression: Annotated[Literal["none", "elastic"], word("none", "elastic")] = "none"
    strain: Annotated[Literal["green", "engineering"], word("green", "engineering")] = "green"
    bending_life: Annotated[float, quantity("", positive=True, of="number of cycles")] | None = None
    length: Annotated[float, quantity("m", positive=True, of="length")] | None = None

    @property
    def wave_speed(self) -> float:
        """Of tension along the rope, m/s."""
        return math.sqrt(self.axial_stiffness / self.mass_per_length)

    @model_validator(mode="after")
    def _stable(self) -> Rope:
        if self.compression == "elastic" and self.bending_stiffness == 0.0:
            cause = "a rope without bending stiffness buckles under any compression"
            raise fault("compression", cause, "give bending_stiffness, or compression: none")
        return self


Elements = Annotated[Whole, Field(ge=1, le=MOST_ELEMENTS)]


def _one_or_each(value: Any) -> str:
    return f"{MARK}each" if isinstance(value, (list, tuple)) else f"{MARK}one"


class Mesh(Model):
    """How finely the rope is modelled: elements in every span, or a list with a number for each span."""

    elements_per_span: Annotated[
        Annotated[Elements, Tag(f"{MARK}one")] | Annotated[tuple[Elements, ...], Tag(f"{MARK}each")],
        Discriminator(_one_or_each),
    ] = ELEMENTS_PER_SPAN


class CraneSolver(Solver):
    """The time integrator of a crane: its steps are controlled by their error, unless ``control: fixed``, or rk4.

    Through slack a fixed step can converge, without a failure, to a wrong answer.
    """

    by_error: ClassVar[bool] = True

    @classmethod
    def _in_full(cls, given: Any) -> Any:
        """A solver that was made in Python as any other is: it is the same with what was given."""
        other = isinstance(given, Solver) and not isinstance(given, cls)
        return super()._in_full(given.model_dump(exclude_unset=True) if other else given)


class CraneScene(Scene):
    """A rope over sheaves and all that moves it: what a run needs to know.

    Attributes
    ----------
    path : tuple of Drum, Sheave, End and Anchor
        The path of the rope, from one of its ends to the other.
    gravity : tuple of float
        m/s^2, z up.
    start : str
        ``static``: at rest, with the length of rope that lets it rest as drawn; or ``as drawn``.
    document : Document or None
        The file it was read from.
    """

    title: str | None = None
    units: UnitSystem = "si"
    rope: Rope = Field(examples=[PLAIN_ROPE])
    bodies: tuple[Body, ...] = Field((), examples=["[{name: payload, mass: 5 t, position: [12, 0, 5]}]"])
    path: Annotated[tuple[Annotated[PathItem, ITEMS], ...], Field(min_length=1, examples=[PLAIN_PATH])]
    frames: tuple[Frame, ...] = Field((), examples=["[{name: boom, pivot: [0, 0, 18], slew: 0}]"])
    vessel: Vessel | None = None
    water: Water | None = None
    ground: Ground | None = None
    heave_compensation: HeaveCompensation | None = None
    mesh: Mesh = Mesh()
    gravity: Gravity = (0.0, 0.0, -EARTH_GRAVITY)
    start: Annotated[Literal["static", "as drawn"], word("static", "as drawn", aliases={"drawn": "as drawn"})] = (
        "static"
    )
    solver: CraneSolver = Field(examples=["{method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 12 s}"])
    output: Output = Field(examples=["{interval: 50 ms}"])
    limits: LimitsOfRun = ()

    @model_validator(mode="after")
    def _consistent(self) -> CraneScene:
        check_consistency(self)
        check_output(self.solver, self.output)
        return self

    @property
    def sheaves(self) -> tuple[Sheave, ...]:
        """Sheaves, in the order of the path."""
        return tuple(item for item in self.path if isinstance(item, Sheave))

    @property
    def drums(self) -> tuple[Drum, ...]:
        """Drums, in the order of the path: none, one or two."""
        return tuple(item for item in self.path if isinstance(item, Drum))

    @property
    def elements(self) -> tuple[int, ...]:
        """Number of elements of each span; there is one span fewer than there are items of the path."""
        asked = self.mesh.elements_per_span
        return asked if isinstance(asked, tuple) else (asked,) * (len(self.path) - 1)

    @property
    def controlled(self) -> bool:
        """Whether the step is controlled by its error, see `CraneSolver`."""
        solver = self.solver
        if solver.explicit:
            return False
        return solver.control == "error" or solver.step == "auto" or "control" not in solver.model_fields_set

    def body(self, name: str) -> Body:
        """Find a body by its name; KeyError if there is none."""
        return _named(self.bodies, name)

    def frame(self, name: str) -> Frame:
        """Find a frame by its name; KeyError if there is none."""
        return _named(self.frames, name)

    def item(self, name: str) -> PathItem:
        """Find an item of the path by its name; KeyError if there is none."""
        return _named(self.path, name)

    def frame_of(self, item: PathItem | Frame) -> str | None:
        """Name of what an item is mounted on, or a frame stands on.

        Returns
        -------
        str or None
            Name of a frame, or ``vessel``; None for the ground, and for what rides on a body.
        """
        if isinstance(item, End) or (isinstance(item, Sheave) and item.body is not None):
            return None
        name = item.parent if isinstance(item, Frame) else item.frame
        if name is None:
            return None if self.vessel is None else VESSEL
        return None if name == GROUND else name

    def key_of(self, item: PathItem) -> tuple[str | int, ...]:
        """Key path of an item of the path, such as ``("path", 1, "sheave")``, for messages."""
        return next(("path", i, item.key) for i, other in enumerate(self.path) if other is item)


def _named(things: tuple[Any, ...], name: str) -> Any:
    try:
        return next(thing for thing in things if thing.name == name)
    except StopIteration:
        raise KeyError(name) from None


def read(path: str | Path | Document) -> CraneScene:
    """Read and validate a scene file, or a document that was read already.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    return CraneScene.read(path)


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a crane scene."""
    return CraneScene.model_json_schema()
