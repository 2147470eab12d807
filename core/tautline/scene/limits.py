"""Limits that a scene gives itself: bounds on its outputs and figures, by which its runs are judged.

What outputs there are, and in which units, only the model of a scene can tell: bounds stay as they are written here,
and `tautline.application.limits` reads them.
"""

from __future__ import annotations

from dataclasses import is_dataclass, replace
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from tautline.scene.model import Model
from tautline.scene.refusal import fault, refusal
from tautline.scene.values.quantity import quantity

EXAMPLE = "[{output: winch.tension, above: 60 kN, name: overload}]"
ABOVE, BELOW = "above", "below"
ROW = "bound of an output"
"""Its row in the table of plausible ranges."""


class AsWritten:
    """Annotation of a number, or a text with a unit, which is read when the unit of its output is known."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Take a number or a text as it stands."""
        return core_schema.no_info_plain_validator_function(_number_or_text)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """A number, or a text."""
        text = {"type": "string", "description": "a number with its unit"}
        described = "in the SI unit of the output unless a unit is given; 60 kN"
        return {"anyOf": [{"type": "number"}, text], "description": described, "quantity": ROW}


def _number_or_text(given: Any) -> float | str:
    if isinstance(given, bool) or not isinstance(given, (int, float, str)):
        raise refusal(
            "is empty" if given is None else "is not a number", "give a number with the output's unit, such as 60 kN"
        )
    return given


class Side(NamedTuple):
    """One bound of a limit: the key that it stands under, how it is written, and what it is called."""

    key: str
    written: float | str
    name: str


class Limit(Model):
    """A bound on an output or a figure: a run fails it where the value is ``above`` or ``below``.

    Attributes
    ----------
    output : str
        Name of an output, of one of its numbers (``payload.position[2]``), or of a figure of the whole run.
    above, below : float or str
        As written; one of them at least.
    for_ : float
        How long the bound has to be passed without a break to count, s; zero: in one frame.
    name : str
        By default ``winch.tension above 60 kN``.
    """

    output: str = Field(examples=["winch.tension"])
    above: Annotated[float | str, AsWritten()] | None = None
    below: Annotated[float | str, AsWritten()] | None = None
    for_: Annotated[float, quantity("s", nonnegative=True, of="duration")] = Field(0.0, alias="for")
    name: str = ""

    @model_validator(mode="after")
    def _bounded(self) -> Limit:
        if self.above is None and self.below is None:
            raise refusal("has no bound", "write above: or below:, such as above: 60 kN")
        if not self.output.strip():
            raise fault("output", "is empty", "name an output, such as winch.tension")
        return self

    @property
    def sides(self) -> list[Side]:
        """Its bounds, each with a name of its own."""
        given = [(key, written) for key, written in ((ABOVE, self.above), (BELOW, self.below)) if written is not None]
        named = self.name.strip()
        if named and len(given) == 1:
            return [Side(*given[0], named)]
        return [Side(key, to, f"{named} {key}" if named else f"{self.output} {key} {_said(to)}") for key, to in given]


def _said(written: float | str) -> str:
    return written.strip() if isinstance(written, str) else f"{written:g}"


def _named_once(limits: tuple[Limit, ...]) -> tuple[Limit, ...]:
    """Refuse two limits of one name: a sweep has a column for each."""
    known: dict[str, int] = {}
    for i, limit in enumerate(limits):
        for side in limit.sides:
            if known.setdefault(side.name, i) != i:
                cause = f"'{side.name}' is the name of limits[{known[side.name]}] already"
                raise fault((i, "name" if limit.name.strip() else "output"), cause, "give it a name of its own: name:")
    return limits


Limits = Annotated[tuple[Limit, ...], AfterValidator(_named_once), Field(examples=[EXAMPLE])]
"""The key ``limits`` of a scene."""


def without_limits(scene: Any) -> Any:
    """A scene, or a dataclass of one, that gives no limits; itself where it gives none."""
    if not getattr(scene, "limits", ()):
        return scene
    if is_dataclass(scene) and not isinstance(scene, type):
        return replace(scene, limits=())
    return scene.model_copy(update={"limits": ()})
