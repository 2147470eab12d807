"""Vectors as they are written in a scene: lists of three numbers, along x, y and z."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tautline.scene.model import MARK
from tautline.scene.refusal import refusal
from tautline.scene.values.quantity import quantity

Vector = tuple[float, float, float]


def listed(count: int | None, of: str, example: str) -> BeforeValidator:
    """Annotate a list of `count` entries, or of at least one."""
    return BeforeValidator(lambda value: _entries(value, count, f"give {of}, such as {example}"))


def _entries(value: Any, count: int | None, cure: str) -> Any:
    """A list of `count` entries, or of at least one, as it is; anything else is refused, a SceneError."""
    if not isinstance(value, (list, tuple)):
        raise refusal("is empty" if value is None else "is not a list", cure)
    if not value:
        raise refusal("is an empty list", cure)
    if count is not None and len(value) != count:
        entries = "1 entry" if len(value) == 1 else f"{len(value)} entries"
        raise refusal(f"has {entries}, not {count}", cure)
    return value


def three(example: str) -> BeforeValidator:
    """Annotate a list of three numbers; ``example`` stands in the refusal of anything else, a SceneError."""
    count, cure = 3, f"give three numbers: x, y and z, such as {example}"

    def read(value: Any) -> Any:
        if isinstance(value, (list, tuple)) and count < len(value) <= 2 * count and _may_be_parted(value):
            asked = f"{cure}. Are there decimal commas? Write decimal points"
            raise refusal(f"has {len(value)} entries, not {count}", asked)
        return _entries(value, count, cure)

    return BeforeValidator(read)


def _may_be_parted(value: Sequence[Any]) -> bool:
    """Whether decimal commas may have parted numbers in two, as 30,5 is two entries of a list."""
    numbers = all(type(one) in (int, float) for one in value)
    return numbers and any(type(one) is type(two) is int for one, two in itertools.pairwise(value))


def not_zero(cure: str) -> AfterValidator:
    """Annotate three numbers that are a direction: all zeros are refused, a SceneError, with what to do about it."""

    def read(vector: tuple[float, ...]) -> tuple[float, ...]:
        if not any(vector):
            raise refusal("has no direction: all three numbers are zero", cure)
        return vector

    return AfterValidator(read)


Position = Annotated[tuple[Annotated[float, quantity("m", of="position")], ...], three("[0, 0, 0]")]
Direction = Annotated[tuple[Annotated[float, quantity("", of="direction", any_size=True)], ...], three("[1, 0, 0]")]
Velocity = Annotated[tuple[Annotated[float, quantity("m/s", of="speed")], ...], three("[0, 0.01, 0]")]
Acceleration = Annotated[tuple[Annotated[float, quantity("m/s^2", of="gravity")], ...], three("[0, 0, -9.81]")]


class _Downwards:
    """Annotation of gravity: a vector, or a number, which acts downwards."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def tag(value: Any) -> str:
            return f"{MARK}vector" if isinstance(value, (list, tuple)) else f"{MARK}number"

        number = handler.generate_schema(Annotated[float, quantity("m/s^2", nonnegative=True, of="gravity")])
        choices: dict[Any, CoreSchema] = {
            f"{MARK}vector": handler.generate_schema(Acceleration),
            f"{MARK}number": core_schema.no_info_after_validator_function(lambda g: (0.0, 0.0, 0.0 - g), number),
        }
        return core_schema.tagged_union_schema(choices, discriminator=tag)


EARTH_GRAVITY = 9.81
"""Acceleration of gravity where a scene gives none, m/s^2; the standard one is 9.80665."""
Gravity = Annotated[Vector, _Downwards()]
"""Acceleration of gravity, m/s^2, z up; ``9.81`` is ``[0, 0, -9.81]``."""


def unit(vector: Sequence[float]) -> Vector:
    """Return the vector of length one along another that is not zero."""
    # Scaled first: the square of a very small or very large number is none.
    largest = max(abs(x) for x in vector)
    x, y, z = (x / largest for x in vector)
    size = math.hypot(x, y, z)
    return x / size, y / size, z / size
