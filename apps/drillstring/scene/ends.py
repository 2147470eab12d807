"""The ends of a string as a scene gives them: the block and the drive that hold its top, and the bit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from drillstring.scene.bit import Bit as Bit
from tautline.scene.choices.branches import Branch
from tautline.scene.choices.words import word
from tautline.scene.functions import Constant, FunctionOfTime, Position, time_function
from tautline.scene.model import Model
from tautline.scene.refusal import fault
from tautline.scene.values.quantity import quantity


class Controller(Model):
    """A top drive under control: speed wanted, gains (N m s/rad, N m/rad), largest torque N m, inertia kg m^2.

    `kind` is ``pi`` with the gains that are given; ``soft-torque`` with gains that let no torsional wave come back from
    the drive, found from the string where they are not given; or ``stiff``, which holds the speed exactly.
    """

    kind: Annotated[Literal["pi", "soft-torque", "stiff"], word("pi", "soft-torque", "stiff")] = "pi"
    speed: Annotated[FunctionOfTime, time_function("rad/s", of="rotary speed")] = Field(examples=["120 rpm"])
    proportional: Annotated[float, quantity("N m s/rad", nonnegative=True, of="control gain")] | None = None
    integral: Annotated[float, quantity("N m/rad", nonnegative=True, of="control gain")] | None = None
    torque_limit: Annotated[float, quantity("N m", positive=True, of="torque")] | None = None
    inertia: Annotated[float, quantity("kg m^2", positive=True, of="moment of inertia")] | None = None

    @model_validator(mode="after")
    def _complete(self) -> Controller:
        if self.kind == "stiff":
            if self.torque_limit is not None:
                cause = "a stiff drive gives whatever torque holds its speed"
                raise fault("torque_limit", cause, "remove it, or take kind: pi")
            return self
        needed = {"inertia": "2000"} | ({"proportional": "1500 N m s/rad"} if self.kind == "pi" else {})
        for key, example in needed.items():
            if getattr(self, key) is None:
                raise fault(key, "is missing", f"add `{key}:`, such as {example}")
        return self


BLOCK = time_function("m", velocity="m/s", of="block position", velocity_of="block speed")
SPEED_OF_BLOCK = {("block", "m"): ("m/s", "block: {velocity: ...}")}
"""How it is written where the unit says that it is a speed."""
ROTATION = time_function("rad/s", controller=Branch(Controller), of="rotary speed")


class Top(Model):
    """The block's position (m, positive down the hole) and the rotary speed (rad/s), or the drive that makes it.

    `weight` (N) is that of block and drive: it moves nothing, and is added where hook loads are told with the block.
    """

    by_unit = SPEED_OF_BLOCK

    block: Annotated[Position, BLOCK] = Field(Constant(value=0.0), examples=["{velocity: {ramp: {to: 0.5, over: 2}}}"])
    rotation: Annotated[FunctionOfTime | Controller, ROTATION] = Field(Constant(value=0.0), examples=["60 rpm"])
    weight: Annotated[float, quantity("N", nonnegative=True, of="hook load")] = 0.0
