"""Annotations of what recurs in cable scenes: vectors, flags, ids, each with a refusal that says what is expected."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from tautline.scene.model import Whole
from tautline.scene.refusal import refusal
from tautline.scene.values.quantity import quantity
from tautline.scene.vector import Acceleration as Acceleration
from tautline.scene.vector import listed, three

DOFS = {7: "rx ry rz r'x r'y r'z p", 4: "rx ry rz p"}


def _flag(value: Any) -> Any:
    if isinstance(value, bool) or value not in (0, 1):
        raise refusal("is neither 0 nor 1", "give 1 to hold the degree of freedom, 0 to leave it free")
    return value


def _ordinal(value: Any) -> Any:
    if isinstance(value, int) and not isinstance(value, bool) and value < 0:
        raise refusal("must not be negative", "give an id such as 0")
    return value


Id = Annotated[Whole, BeforeValidator(_ordinal)]
Ids = Annotated[tuple[Id, ...], listed(None, "ids of nodes", "[2]")]
Pair = Annotated[tuple[Id, ...], listed(2, "the ids of two nodes", "[0, 1]")]
Position = Annotated[tuple[Annotated[float, quantity("m", of="position")], ...], three("[0.5, 0, 0]")]
Slope = Annotated[tuple[Annotated[float, quantity("", of="direction")], ...], three("[1, 0, 0]")]
Thrust = Annotated[tuple[Annotated[float, quantity("N", of="force")], ...], three("[0, 8.5, 0]")]
Load = Annotated[tuple[Annotated[float, quantity("N/m", of="load per length")], ...], three("[0, 0, -10]")]
Flag = Annotated[int, BeforeValidator(_flag)]
Flags7 = Annotated[tuple[Flag, ...], listed(7, f"a 0 or 1 for each of {DOFS[7]}", "[1, 1, 1, 0, 0, 0, 1]")]
Flags4 = Annotated[tuple[Flag, ...], listed(4, f"a 0 or 1 for each of {DOFS[4]}", "[1, 1, 1, 1]")]
Functions7 = Annotated[
    tuple[Id, ...], listed(7, f"a function's id or 0 for each of {DOFS[7]}", "[0, 0, 0, 0, 0, 0, 1]")
]
Functions4 = Annotated[tuple[Id, ...], listed(4, f"a function's id or 0 for each of {DOFS[4]}", "[0, 0, 0, 1]")]
Dof = Annotated[Whole, Field(ge=1, le=7)]
AxialStiffness = Annotated[float, quantity("N", nonnegative=True, of="axial stiffness")]
BendingStiffness = Annotated[float, quantity("N m^2", nonnegative=True, of="bending stiffness")]
MassPerLength = Annotated[float, quantity("kg/m", nonnegative=True, of="mass per length")]
DampingTime = Annotated[float, quantity("s", nonnegative=True, of="damping time")]
Damping = Annotated[float, quantity("N s/m", nonnegative=True, of="damping coefficient")]
Stiffness = Annotated[float, quantity("N/m", positive=True, of="spring stiffness")]
Time = Annotated[float, quantity("s", of="moment")]
Length = Annotated[float, quantity("m", of="material coordinate")]
Speed = Annotated[float, quantity("m/s", of="speed")]
