"""What a rope passes on its way: drums, sheaves, and the points where it ends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.choices.words import word
from tautline.scene.functions import Constant, FunctionOfTime, Ramp, Table, time_function
from tautline.scene.model import Model, Switch, Whole
from tautline.scene.names import Name
from tautline.scene.refusal import fault, raise_all
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import Position, Vector, not_zero, three, unit

UPRIGHT = 0.1
"""Sine of the angle within which an axis counts as upright, or as level: there a word of the wrap means nothing."""
MOST_FRICTION = 10.0
"""Coefficient in a groove: a turn of rope then holds 10^27 times its pull, which is what can be computed with."""
MOST_TURNS, MOST_LAYERS = 100_000, 1000
FLEET_LIMIT = math.radians(4.0)
DRUM_FLEET_LIMIT = math.radians(2.0)
"""Of a grooved drum; of a smooth one 1.5 deg is usual."""


Radius = Annotated[float, quantity("m", positive=True, of="radius of a sheave or drum")]
PinRadius = Annotated[float, quantity("m", positive=True, of="bearing radius")]
Inertia = Annotated[float, quantity("kg m^2", positive=True, of="moment of inertia")]
Axis = Annotated[
    tuple[Annotated[float, quantity("", of="direction")], ...],
    three("[0, 1, 0]"),
    not_zero("give the axis it turns about, such as [0, 1, 0]"),
]
Friction = Annotated[float, quantity("", nonnegative=True, at_most=2.0, of="friction factor")]
Wrap = Annotated[Literal["over", "under", "left", "right"], word("over", "under", "left", "right")]


class Disc(Model):
    """Round about an axis, with the rope laid over, under, left or right of its centre.

    Attributes
    ----------
    radius : float
        Pitch radius, m: to the middle of the rope.
    axis : tuple of float
        Of any length but zero.
    wrap : str
        The side of the centre that the rope passes; ``left`` and ``right`` are those of its travel, from the first
        item of the path to the last, for an axis that is upright.
    frame : str or None
        What it is mounted on: a frame, ``vessel`` or ``ground``; None for the vessel where there is one.
    """

    name: Name = Field(examples=["boom tip"])
    radius: Radius = Field(examples=["0.4 m"])
    axis: Axis = Field(examples=["[0, 1, 0]"])
    wrap: Wrap = Field(examples=["over"])
    frame: str | None = None

    @property
    def unit_axis(self) -> Vector:
        """The axis, as a unit vector."""
        return unit(self.axis)

    @model_validator(mode="after")
    def _side(self) -> Disc:
        x, y, z = self.unit_axis
        if self.wrap in ("over", "under") and math.hypot(x, y) < UPRIGHT:
            cause = "the axis is upright: nothing passes over or under it"
            raise fault("wrap", cause, "give left or right, of the rope's travel")
        if self.wrap in ("left", "right") and abs(z) < UPRIGHT:
            raise fault("wrap", "the axis is level: nothing passes left or right of it", "give over or under")
        return self


class Brake(Model):
    """Holds the drum by friction up to `torque`, N m: to the time `until`, s, or by the share that `closed` gives.

    `closed` is a function of time, 0 where the brake is open and 1 where it is closed. With neither it stays closed.
    Where the curve of a table between two rows goes beyond 0 or 1, it counts as 0 or 1.
    """

    torque: Annotated[float, quantity("N m", nonnegative=True, of="torque")]
    until: Annotated[float, quantity("s", nonnegative=True, of="moment")] | None = None
    closed: Annotated[FunctionOfTime, time_function("", of="share")] | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Brake:
        if self.until is not None and self.closed is not None:
            raise fault("closed", "is given together with `until`", "keep one of the two")
        beyond = [value for value in _values_of(self.closed) if not 0.0 <= value <= 1.0]
        if beyond:
            raise fault("closed", *no_share(beyond[0], "at some time"))
        return self


def _values_of(function: FunctionOfTime | None) -> tuple[float, ...]:
    """Values between which a function goes, of those that have such."""
    if isinstance(function, Constant):
        return (function.value,)
    if isinstance(function, Table):
        return function.value
    if isinstance(function, Ramp) and function.to is not None:
        return function.from_, function.to
    return ()


def no_share(closed: float, when: str) -> tuple[str, str]:
    """Cause and cure of a brake that is to be closed by a share below 0 or above 1 at a time."""
    return f"is {closed:.6g} {when}", "give a share from 0, open, to 1, closed"


def pushing(tension: float, when: str) -> tuple[str, str]:
    """Cause and cure of a tension below 0, N, that a winch is to hold at a time."""
    cause = f"is {tension:.6g} N {when}, and a rope only pulls: the motor would drive the rope out slack"
    return cause, "give a tension that is not below 0, positive where the winch pulls"


class Gains(Model):
    """Of a winch that holds a tension: ``torque = R (T + proportional e + integral times the integral of e)``.

    ``e = T - tension at the drum``, N; `proportional` is a number, `integral` in 1/s.
    """

    proportional: Annotated[float, quantity("", nonnegative=True, of="control gain")] = 0.0
    integral: Annotated[float, quantity("1/s", nonnegative=True, of="control gain")] = 0.0


class Layers(Model):
    """Rope on a drum in layers of so many turns, on a core of a radius, m; `count` is how many layers there may be."""

    turns: Annotated[Whole, Field(ge=1, le=MOST_TURNS, examples=["40"])]
    core_radius: Radius
    count: Annotated[Whole, Field(ge=1, le=MOST_LAYERS)] | None = None

    def pitch_radius(self, layer: int, diameter: float) -> float:
        """Pitch radius of a layer, m; the first is 1, and each lies in the hollows of the one below."""
        return self.core_radius + (0.5 + (layer - 1) * 0.5 * math.sqrt(3.0)) * diameter

    def pitch_radii(self, diameter: float) -> str:
        """Where layers lie and why, in words: who counts with a whole diameter a layer finds more room."""
        first = f"the first layer lies at core_radius + d/2 = {self.pitch_radius(1, diameter):.4g} m"
        if self.count is None or self.count == 1:
            return first
        last = f"layer {self.count} at {self.pitch_radius(self.count, diameter):.4g} m"
        return f"{first}, each further one sqrt(3)/2 d above in the hollows of that below, {last}"

    def capacity(self, diameter: float) -> float | None:
        """Length of rope of a diameter, m, that fills all layers; None if their number is not given."""
        if self.count is None:
            return None
        return 2.0 * math.pi * self.turns * sum(self.pitch_radius(j + 1, diameter) for j in range(self.count))


DRIVES = ("pay_out", "speed", "torque", "tension")
OF_A_MOTOR = ("inertia", "brake", "friction_torque")
OF_A_TENSION = ("gains", "torque_limit")


class Drum(Disc):
    """A winch at an end of the rope, driven in one of four ways.

    Attributes
    ----------
    pay_out : function of time or None
        Speed of the unstretched rope that leaves the drum, m/s, positive out. The input of a simulation that is
        called so, ``winch.pay_out``, is its integral, a length in m; this one is ``winch.pay_out_speed`` there.
    speed : function of time or None
        Of the drum, rad/s, positive where it pays out.
    torque : function of time or None
        Of the motor, N m at the drum, positive where it hoists.
    tension : function of time or None
        N, that the winch holds by its torque; `gains` of its controller and a `torque_limit`, N m.
    inertia, brake, friction_torque
        Of a drum that is driven by torque or tension: kg m^2, with motor and gear; the brake; and N m against the
        motion at any speed.
    rope_on_drum : float or None
        Unstretched length on the drum at the start, m; None for no end of it.
    """

    key: ClassVar[str] = "drum"
    by_unit: ClassVar[Mapping[tuple[str, str], tuple[str, str]]] = {
        ("speed", "rad/s"): ("m/s", "pay_out"),
        ("pay_out", "m/s"): ("rad/s", "speed"),
        ("torque", "N m"): ("N", "tension"),
        ("tension", "N"): ("N m", "torque"),
    }

    center: Position = Field(examples=["[0, 0, 0]"])
    pay_out: Annotated[FunctionOfTime, time_function("m/s", of="winch speed")] | None = None
    speed: Annotated[FunctionOfTime, time_function("rad/s", of="drum speed")] | None = None
    torque: Annotated[FunctionOfTime, time_function("N m", of="torque")] | None = None
    tension: Annotated[FunctionOfTime, time_function("N", of="force")] | None = None
    inertia: Inertia | None = None
    brake: Brake | None = None
    friction_torque: Annotated[float, quantity("N m", nonnegative=True, of="torque")] = 0.0
    gains: Gains | None = None
    torque_limit: Annotated[float, quantity("N m", positive=True, of="torque")] | None = None
    layers: Layers | None = None
    rope_on_drum: Annotated[float, quantity("m", positive=True, of="length")] | None = None

    @property
    def drive(self) -> str:
        """What drives it: ``pay_out``, ``speed``, ``torque`` or ``tension``."""
        return next(key for key in DRIVES if getattr(self, key) is not None)

    @property
    def prescribed(self) -> bool:
        """Whether its motion is prescribed, and not found from torques."""
        return self.drive in ("pay_out", "speed")

    @model_validator(mode="after")
    def _one_drive(self) -> Drum:
        given = [key for key in DRIVES if getattr(self, key) is not None]
        if not given:
            cause = "is missing: nothing drives the drum"
            cure = "give one of `pay_out:`, `speed:`, `torque:`, `tension:`; a drum at rest has `pay_out: 0`"
            raise fault("pay_out", cause, cure)
        raise_all((key, f"is given together with {given[0]}", "keep one of the two") for key in given[1:])
        drive = given[0]
        if self.prescribed:
            cause, cure = f"is not used: {drive} prescribes the drum's motion", "remove it, or drive the drum by torque"
            raise_all((key, cause, cure) for key in OF_A_MOTOR if key in self.model_fields_set)
        elif self.inertia is None:
            cause = f"is missing: the drum's motion follows from its {drive}"
            raise fault("inertia", cause, "add `inertia:`, of drum, gear and motor, such as 2000")
        if drive != "tension":
            cause, cure = f"is not used: the drum is driven by {drive}", "remove it, or give `tension:` in its place"
            raise_all((key, cause, cure) for key in OF_A_TENSION if key in self.model_fields_set)
        slack = [value for value in _values_of(self.tension) if value < 0.0]
        if slack:
            raise fault("tension", *pushing(slack[0], "at some time"))
        return self

    @model_validator(mode="after")
    def _core(self) -> Drum:
        if self.layers is not None and self.layers.core_radius > self.radius:
            cause = f"is larger than the drum's pitch radius, {self.radius:g} m: the rope would lie inside the core"
            raise fault(("layers", "core_radius"), cause, "give the radius of the bare drum, and `radius` of its rope")
        return self


class Efficiency(Model):
    """A sheave that takes a share of the tension: the rope that leaves it pulls with 1/efficiency of the other side."""

    efficiency: float


Law = Literal["frictionless", "no_slip", "capstan"] | Efficiency
WORDS = Annotated[
    Literal["frictionless", "no_slip", "capstan"],
    word("frictionless", "no_slip", "capstan", forms=("{efficiency: 0.98}",)),
]
SHARE = Branch(
    Annotated[float, quantity("", positive=True, at_most=1.0, of="share")], lambda share: Efficiency(efficiency=share)
)
LAWS = OneOf("a law", {"efficiency": SHARE}, Branch(WORDS), example="no_slip or {efficiency: 0.98}")


def _usual(law: Any, info: ValidationInfo) -> Any:
    """Take the law that a sheave follows where none is given."""
    if law is not None:
        return law
    return "no_slip" if info.data.get("inertia") else "frictionless"


EFFICIENCY = {"efficiency": ("friction", "the efficiency of a sheave stands in `law`: write law: {efficiency: 0.98}")}
"""Where people look for it, and where it stands."""


class Bearing(Model):
    """Friction of a sheave's bearing: its coefficient, and the radius where it acts, m."""

    elsewhere = EFFICIENCY

    friction: Friction
    radius: PinRadius


class Sheave(Disc):
    """A sheave with a fixed centre, or on a body.

    Attributes
    ----------
    body, offset
        The body it rides on, and its centre from the body's position, m.
    center : tuple of float or None
        Of a sheave that is on no body, m, as drawn.
    inertia : float
        kg m^2.
    law : str or Efficiency
        How rope and sheave touch: ``frictionless``, ``no_slip``, ``capstan`` (slips beyond `friction`), or
        `Efficiency`. Where the scene gives none: ``no_slip`` with inertia, ``frictionless`` without.
    groove : float or None
        Full angle of a V groove, rad, which wedges the rope of a capstan.
    locked : bool
        Whether a capstan is kept from turning.
    fleet_limit : float
        Angle between rope and sheave plane above which `check` warns, rad.
    """

    key: ClassVar[str] = "sheave"
    elsewhere = EFFICIENCY

    body: str | None = None
    offset: Position = (0.0, 0.0, 0.0)
    center: Position | None = None
    inertia: Annotated[float, quantity("kg m^2", nonnegative=True, of="moment of inertia")] = 0.0
    law: Annotated[Law, LAWS, BeforeValidator(_usual)] = Field(default=None, validate_default=True)
    friction: Friction | None = None
    groove: Annotated[float, quantity("rad", positive=True, at_most=math.pi, of="groove angle")] | None = None
    locked: Switch = False
    bearing: Bearing | None = None
    fleet_limit: Annotated[float, quantity("rad", positive=True, at_most=0.5 * math.pi, of="fleet angle")] = FLEET_LIMIT

    @property
    def groove_friction(self) -> float:
        """Coefficient of friction between a capstan's rope and its groove: mu, or mu / sin(half angle)."""
        mu = self.friction or 0.0
        return mu if self.groove is None else mu / math.sin(0.5 * self.groove)

    @model_validator(mode="after")
    def _mounting(self) -> Sheave:
        if self.body is None:
            if self.center is None:
                raise fault("center", "is missing", "give `center: [x, y, z]`, or `body:` for a sheave on a body")
            if "offset" in self.model_fields_set:
                raise fault("offset", "is not used: the sheave is on no body", "remove it, or give `body:`")
            return self
        if self.center is not None:
            cure = "remove it; `offset` is the centre from the body's position"
            raise fault("center", f"is given together with body {self.body}", cure)
        if self.frame is not None:
            raise fault("frame", f"is given together with body {self.body}", "keep one: the body carries the sheave")
        return self

    @model_validator(mode="after")
    def _touch(self) -> Sheave:
        law = "efficiency" if isinstance(self.law, Efficiency) else self.law
        if law == "capstan":
            if self.friction is None:
                raise fault("friction", "is missing beside law: capstan", "add `friction:`, such as 0.1")
        else:
            cause, cure = f"is not used by law: {law}", "give law: capstan, or remove it"
            raise_all((key, cause, cure) for key in ("friction", "groove") if getattr(self, key) is not None)
        if self.locked and (law != "capstan" or self.inertia > 0.0 or self.bearing is not None):
            cause = "is a capstan that does not turn: it has no inertia and no bearing, and no other law"
            raise fault("locked", cause, "give law: capstan alone, or remove it")
        if self.inertia > 0.0 and law == "frictionless":
            cause, cure = "is not used by law: frictionless, which turns no sheave", "give law: no_slip, or remove it"
            raise fault("inertia", cause, cure)
        if self.groove is not None and self.groove_friction > MOST_FRICTION:
            cause = f"wedges the rope to a coefficient of friction of {self.groove_friction:.3g}: it can never slip"
            raise fault("groove", cause, "give a wider angle, such as 40 deg, or law: no_slip")
        if self.bearing is not None:
            if law not in ("no_slip", "capstan"):
                raise fault("bearing", f"is not used by law: {law}", "give law: no_slip or capstan, or remove it")
            if self.bearing.radius >= self.radius:
                cause = f"is not smaller than the sheave's, {self.radius:g} m"
                raise fault(("bearing", "radius"), cause, "give the radius of the pin")
        return self


class End(Model):
    """An end of the rope on a body, at an `offset` from its position, m."""

    key: ClassVar[str] = "end"

    name: Name = Field(examples=["hook"])
    body: str
    offset: Position = (0.0, 0.0, 0.0)


class Anchor(Model):
    """An end of the rope on a frame, the vessel or the ground, at a position as drawn, m."""

    key: ClassVar[str] = "anchor"

    name: Name = Field(examples=["dead end"])
    position: Position = Field(examples=["[0, 0, 30]"])
    frame: str | None = None


PathItem = Drum | Sheave | End | Anchor
ITEMS = OneOf(
    "an item of the path",
    {kind.key: Branch(kind) for kind in (Drum, Sheave, End, Anchor)},
    example="{end: {name: hook, body: payload}}",
)
