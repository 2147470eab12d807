"""The ends of a string as a scene gives them: the block and the drive that hold its top, and the bit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautline.scene.functions import Constant, FunctionOfTime, Position, time_function
from tautline.scene.model import Branch, Model, Switch, word
from tautline.scene.quantity import quantity
from tautline.scene.refusal import fault


class Controller(Model):
    """A top drive that holds its speed: proportional (N m s/rad) and integral (N m/rad) gains, inertia (kg m^2)."""

    speed: Annotated[FunctionOfTime, time_function("rad/s")] = Field(examples=["120 rpm"])
    proportional: Annotated[float, quantity("N m s/rad", nonnegative=True)]
    integral: Annotated[float, quantity("N m/rad", nonnegative=True)] = 0.0
    torque_limit: Annotated[float, quantity("N m", positive=True)] | None = None
    inertia: Annotated[float, quantity("kg m^2", positive=True)]


BLOCK = time_function("m", velocity="m/s")
ROTATION = time_function("rad/s", controller=Branch(Controller))


class Top(Model):
    """The block's position (m, positive down the hole) and the rotary speed (rad/s), or the drive that makes it."""

    block: Annotated[Position, BLOCK] = Field(Constant(value=0.0), examples=["{velocity: {ramp: {to: 0.5, over: 2}}}"])
    rotation: Annotated[FunctionOfTime | Controller, ROTATION] = Field(Constant(value=0.0), examples=["60 rpm"])


class Bit(Model):
    """The lower end; `force` in N along the string, positive downhole."""

    on_bottom: Switch = False
    lateral: Annotated[Literal["free", "pinned"], word("free", "pinned")] = "free"
    force: Annotated[float, quantity("N")] = 0.0

    @model_validator(mode="after")
    def _off(self) -> Bit:
        if self.on_bottom:
            raise fault(
                "on_bottom", "drilling is not available yet", "set it to false; `force` can stand for bit weight"
            )
        return self
