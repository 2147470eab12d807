"""Limits that a scene gives itself: bounds on its outputs and figures, by which its runs are judged.

What outputs there are, and in which units, only the model of a scene can tell: bounds stay as they are written here,
and `tautline.application.limits` reads them.
"""

from __future__ import annotations

import re
from dataclasses import is_dataclass, replace
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from tautline.scene.errors import SceneWarning
from tautline.scene.model import Model
from tautline.scene.names import Name
from tautline.scene.refusal import fault, refusal
from tautline.scene.values.quantity import quantity

EXAMPLE = "[{output: winch.tension, above: 60 kN, name: overload}]"
ABOVE, BELOW = "above", "below"
AT_MOST, AT_LEAST = "at_most", "at_least"
FAILS = {ABOVE: ABOVE, AT_MOST: ABOVE, BELOW: BELOW, AT_LEAST: BELOW}
"""Keys of a bound, and the side of it on which a run fails: two name that side, two the side that is allowed."""
LARGEST = frozenset({"max", "largest", "longest", "amplification"})
SMALLEST = frozenset({"min", "smallest", "least", "safety"})
"""Words in the names of figures that are the largest, or the smallest, of a run."""
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
    """One bound of a limit.

    Attributes
    ----------
    key : str
        That it stands under.
    written : float or str
    name : str
        What it is called.
    fails : str
        `ABOVE` or `BELOW`: the side on which a run fails.
    """

    key: str
    written: float | str
    name: str
    fails: str


class Limit(Model):
    """A bound on an output or a figure: a run fails it where the value is ``above`` or ``below``.

    ``at_most`` is ``above``, and ``at_least`` is ``below``, by the side that is allowed.

    Attributes
    ----------
    output : str
        Name of an output, of one of its numbers (``payload.position[2]``), or of a figure of the whole run.
    above : float or str
        A run fails above it. As written, like the three others; one of the four must be given.
    below : float or str
        A run fails below it.
    at_most : float or str
        The largest value that is allowed: the same as ``above``.
    at_least : float or str
        The smallest value that is allowed: the same as ``below``.
    for_ : float
        How long the bound has to be passed without a break to count, s; zero: in one frame.
    name : str
        By default ``winch.tension above 60 kN``.
    """

    output: str = Field(examples=["winch.tension"])
    above: Annotated[float | str, AsWritten()] | None = None
    below: Annotated[float | str, AsWritten()] | None = None
    at_most: Annotated[float | str, AsWritten()] | None = None
    at_least: Annotated[float | str, AsWritten()] | None = None
    for_: Annotated[float, quantity("s", nonnegative=True, of="duration")] = Field(0.0, alias="for")
    name: Name = ""

    @model_validator(mode="after")
    def _bounded(self) -> Limit:
        keys = [key for key in FAILS if getattr(self, key) is not None]
        if not keys:
            cure = "write at_most: or at_least:, such as at_most: 60 kN; above: or below: name the side that fails"
            raise refusal("has no bound", cure)
        for one, other in ((ABOVE, AT_MOST), (BELOW, AT_LEAST)):
            if one in keys and other in keys:
                raise fault(other, f"stands beside `{one}`, which means the same", "remove one of the two")
        if not self.output.strip():
            raise fault("output", "is empty", "name an output, such as winch.tension")
        return self

    @property
    def sides(self) -> list[Side]:
        """Its bounds, each with a name of its own."""
        given = [(key, written, fails) for key, fails in FAILS.items() if (written := getattr(self, key)) is not None]
        named = self.name.strip()

        def name(written: float | str, fails: str) -> str:
            if named:
                return named if len(given) == 1 else f"{named} {fails}"
            return f"{self.output} {fails} {_said(written)}"

        return [Side(key, written, name(written, fails), fails) for key, written, fails in given]


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


def extreme_of(name: str) -> str:
    """Which extreme of a run a figure or output is by its name: ``largest``, ``smallest``, or nothing where neither."""
    # Names of figures, and the last part of an output's: what stands before it, a user has named.
    words = set(re.split(r"[^a-z]+", name.rpartition(".")[2].lower()))
    if not words & (LARGEST | SMALLEST) or words >= {"max", "min"}:
        return ""
    return "largest" if words & LARGEST else "smallest"


def reversed_limits(scene: Any) -> list[SceneWarning]:
    """Warn of bounds on the side where they say little: a largest value that has to be large, a smallest to be small.

    ``below: 15 kN`` of a maximum is kept by any run whose maximum is larger, and was probably meant the other way.
    """
    found = []
    for i, limit in enumerate(getattr(scene, "limits", ())):
        kind = extreme_of(limit.output)
        meant = ABOVE if kind == "largest" else BELOW
        if not kind or meant in [one.fails for one in limit.sides]:
            continue
        cure = AT_MOST if meant == ABOVE else AT_LEAST
        for side in limit.sides:
            document = getattr(scene, "document", None)
            line = document.line(("limits", i, side.key)) if document is not None else None
            written, where = _said(side.written), f" (line {line})" if line else ""
            text = (
                f"{written}{where} fails a run whose {limit.output} is {side.fails} {written}, and passes one that is "
                f"{meant} it, but this is the {kind} of a run. `above` and `below` name the side that fails. Was "
                f"{cure.replace('_', ' ')} {written} meant? Then write `{cure}: {written}`"
            )
            found.append(SceneWarning(f"limits[{i}].{side.key}", text))
    return found


def without_limits(scene: Any) -> Any:
    """A scene, or a dataclass of one, that gives no limits; itself where it gives none."""
    if not getattr(scene, "limits", ()):
        return scene
    if is_dataclass(scene) and not isinstance(scene, type):
        return replace(scene, limits=())
    return scene.model_copy(update={"limits": ()})
