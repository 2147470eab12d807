"""Bodies that hang on a rope: payloads, hook blocks, counterweights."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from tautline.scene.choices.words import word
from tautline.scene.functions import FunctionOfTime, time_function
from tautline.scene.model import Model
from tautline.scene.names import Name
from tautline.scene.refusal import fault, refusal
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import Position, Velocity, listed, three

FORCES = listed(3, "three forces: along x, y and z", "[0, 0, {ramp: {to: 1 kN, over: 2}}]")
XYZ = "xyz"
LEFT = ("inertia", "volume", "added_mass", "drag", "force", "bottom", "height")
"""Keys of a release that say what remains of the body's own."""

Mass = Annotated[float, quantity("kg", nonnegative=True, of="mass")]
Masses = Annotated[tuple[Annotated[float, quantity("kg", nonnegative=True, of="mass")], ...], three("[0, 0, 60 t]")]
Stiffnesses = Annotated[
    tuple[Annotated[float, quantity("N/m", nonnegative=True, of="spring stiffness")], ...], three("[0, 0, 1.0e6]")
]
Dampings = Annotated[
    tuple[Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")], ...], three("[0, 0, 1.0e3]")
]
Quadratics = Annotated[
    tuple[Annotated[float, quantity("N s^2/m^2", nonnegative=True, of="quadratic drag")], ...], three("[0, 0, 2.0e5]")
]
Inertias = Annotated[
    tuple[Annotated[float, quantity("kg m^2", positive=True, of="moment of inertia")], ...], three("[900, 900, 400]")
]
Angles = Annotated[tuple[Annotated[float, quantity("rad", of="angle")], ...], three("[0, 0, 90 deg]")]
Height = Annotated[float, quantity("m", positive=True, of="distance")]
Forces = Annotated[tuple[Annotated[FunctionOfTime, time_function("N", of="force")], ...], FORCES]


def _once(axes: tuple[str, ...]) -> tuple[str, ...]:
    twice = next((axis for axis in axes if axes.count(axis) > 1), None)
    if twice is not None:
        raise refusal(f"holds {twice} twice", "give each axis once, such as [x, y]")
    return axes


Axes = Annotated[tuple[Annotated[Literal["x", "y", "z"], word("x", "y", "z")], ...], AfterValidator(_once)]


COEFFICIENT = {"Cd": ("", "write drag: {quadratic: [x, y, z]}, of each axis Cd rho A / 2 in N s^2/m^2")}
"""What people give in place of a quadratic drag, and how it is written."""


class Drag(Model):
    """Of water along x, y and z: `linear` in N s/m, `quadratic` in N s^2/m^2."""

    elsewhere = COEFFICIENT

    linear: Dampings = (0.0, 0.0, 0.0)
    quadratic: Quadratics = (0.0, 0.0, 0.0)


class Spring(Model):
    """Holds a body along x, y and z: stiffness N/m, damping N s/m; `rest`, m, is where it pulls to, None as drawn."""

    stiffness: Stiffnesses
    damping: Dampings = (0.0, 0.0, 0.0)
    rest: Position | None = None

    @model_validator(mode="after")
    def _some(self) -> Spring:
        if not any((*self.stiffness, *self.damping)):
            raise fault("stiffness", "holds nothing: all three numbers are zero", "give one, or remove the spring")
        return self


class Release(Model):
    """The load drops: at a time, s, the mass becomes what remains, kg, and so do the moments of inertia, kg m^2.

    The others are those of what remains, as `Body` has them. Where one is None nothing changes.
    """

    at: Annotated[float, quantity("s", nonnegative=True, of="moment")]
    remaining: Mass
    inertia: Inertias | None = None
    volume: Annotated[float, quantity("m^3", nonnegative=True, of="volume")] | None = None
    added_mass: Masses | None = None
    drag: Drag | None = None
    force: Forces | None = None
    bottom: Annotated[float, quantity("m", nonnegative=True, of="distance")] | None = None
    height: Height | None = None


class Body(Model):
    """A point with mass, or a rigid body where it has `inertia`.

    Attributes
    ----------
    position, velocity : tuple of float
        At the start, m and m/s.
    added_mass, drag, volume
        Of the water around it: kg along x, y and z; see `Drag`; m^3, for buoyancy.
    guide : tuple of str
        Axes along which it is held.
    inertia : tuple of float or None
        Principal moments, kg m^2, of a rigid body.
    orientation : tuple of float
        Roll, pitch and yaw of its principal axes at the start, rad.
    bottom : float
        Depth of its lowest point below its position, m, which touches the ground.
    height : float or None
        From its lowest point to its highest, m: what water does to it grows with the part of that which is under
        water. None where water acts on all of it, at any height.
    force : tuple of functions of time, or None
        Along x, y and z, N.
    """

    elsewhere = COEFFICIENT

    name: Name = Field(examples=["payload"])
    mass: Mass = Field(examples=["5 t"])
    position: Position = Field(examples=["[12.4, 0, 5]"])
    velocity: Velocity = (0.0, 0.0, 0.0)
    added_mass: Masses = (0.0, 0.0, 0.0)
    drag: Drag = Drag()
    volume: Annotated[float, quantity("m^3", nonnegative=True, of="volume")] = 0.0
    guide: Axes = Field((), examples=["[x, y]"], description="of x, y and z those along which it is held")
    spring: Spring | None = None
    inertia: Inertias | None = None
    orientation: Angles = (0.0, 0.0, 0.0)
    release: Release | None = None
    bottom: Annotated[float, quantity("m", nonnegative=True, of="distance")] = 0.0
    height: Height | None = None
    force: Forces | None = None

    @property
    def lowest(self) -> float:
        """Height of its lowest point at the start, m."""
        return self.position[2] - self.bottom

    def after_release(self) -> Body:
        """What is on the hook after the load has dropped."""
        if self.release is None:
            return self
        given = {key: getattr(self.release, key) for key in LEFT if getattr(self.release, key) is not None}
        return self.model_copy(update={"mass": self.release.remaining, **given})

    @model_validator(mode="after")
    def _rigid(self) -> Body:
        left = None if self.release is None else self.release.inertia
        if self.inertia is None:
            if "orientation" in self.model_fields_set:
                raise fault("orientation", "is not used: a point has none", "remove it, or give `inertia:`")
            if left is not None:
                cause = "is not used: the body is a point, which does not turn"
                raise fault(("release", "inertia"), cause, "remove it, or give the body `inertia:`")
            return self
        for key, moments in (("inertia", self.inertia), (("release", "inertia"), left)):
            largest = max(moments or (0.0,))
            if largest > (sum(moments or (0.0,)) - largest) * (1.0 + 1e-9):
                cause = f"no body is so: {largest:g} is more than the other two moments together"
                raise fault(key, cause, "give the principal moments about the centre of mass")
        if left is not None and any(after > before for after, before in zip(left, self.inertia, strict=True)):
            cause = "is more than the whole body has about an axis: what drops takes inertia with it"
            raise fault(("release", "inertia"), cause, "give the moments of what remains on the hook")
        return self

    @model_validator(mode="after")
    def _tall(self) -> Body:
        if self.height is not None and "bottom" not in self.model_fields_set:
            cause = "says how tall the body is, and nothing says how far its lowest point is below its position"
            raise fault("height", cause, "give `bottom:` as well")
        if self.height is None and self.release is not None and self.release.height is not None:
            raise fault(("release", "height"), "is given, and the body has none before", "give the body its `height:`")
        return self

    @model_validator(mode="after")
    def _guided(self) -> Body:
        for i, axis in enumerate(XYZ):
            if axis in self.guide and self.velocity[i] != 0.0:
                cause = f"is along {axis}, where the guide holds the body"
                raise fault(("velocity", i), cause, f"set it to 0, or take {axis} out of guide")
        return self

    @model_validator(mode="after")
    def _dropped(self) -> Body:
        if self.release is not None and self.mass == 0.0:
            raise fault("mass", "is nothing that a release can drop", "give the mass of the load with its hook")
        if self.release is not None and self.release.remaining >= self.mass:
            cause = f"is no less than the body has, {self.mass:g} kg: nothing drops"
            cure = "0" if self.inertia is None else "the mass of hook and shackle"
            raise fault(("release", "remaining"), cause, f"give what remains on the hook, such as {cure}")
        return self
