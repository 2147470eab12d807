"""What is written in the map of a twin: which sensor is which input or output, what is estimated, what is watched."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import pydantic

from tautline.scene.choices.words import word
from tautline.scene.model import Model, Scene, Switch
from tautline.scene.refusal import refusal
from tautline.scene.values.quantity import quantity

Seconds = Annotated[float, quantity("s", positive=True)]
Wait = Annotated[float, quantity("s", nonnegative=True)]
RANGE = pydantic.Field(None, examples=["[4 t, 6 t]"], description="the least and the most")
LONGEST_AHEAD = 600.0
"""Longest that can be looked ahead, s: nobody knows what a machine is made to do by then, and a run takes memory."""
Ahead = Annotated[float, quantity("s", nonnegative=True, at_most=LONGEST_AHEAD)]
Written = pydantic.StrictBool | float | str
"""A number, or a text with a unit; it is read when the quantity that it belongs to is known. True is told as none."""
OFFSET = "offset "
"""Begins the name of an estimated offset: ``offset winch.tension``."""


class Sensor(Model):
    """A column of the data, and what it is in the scene.

    ``value = scale * (reading - zero)``, both in the unit of the column; so are `sd` and `range` without a unit. A
    `signal` is what only the application asks for, to know what the machine is at: the flow of a rig's pumps.
    """

    column: str
    unit: str = ""
    input: str | None = None
    output: str | None = None
    signal: str | None = None
    sd: Written | None = None
    scale: float = 1.0
    zero: Annotated[float | Literal["first"], pydantic.Field(union_mode="left_to_right")] = 0.0
    range: tuple[Written, Written] | None = RANGE
    forecast: Annotated[Literal["hold", "waves"] | None, word("hold", "waves")] = None
    lost_after: Seconds | None = None

    @pydantic.model_validator(mode="after")
    def _one_of(self) -> Sensor:
        kinds = {"input": self.input, "output": self.output, "signal": self.signal}
        given = [name for name, value in kinds.items() if value is not None]
        if not given:
            cure = (
                "write what the column is in the scene, as input: or output:, or signal: for what the application reads"
            )
            raise refusal("gives none of input, output and signal", cure)
        if len(given) > 1:
            raise refusal(f"gives {' and '.join(given)}", "a column is one of them: keep one")
        if self.scale == 0.0 or not math.isfinite(self.scale):
            cure = "give the factor by which readings are multiplied, such as -1"
            raise refusal(f"has a scale of {self.scale:g}, by which no reading can be multiplied", cure)
        return self

    @property
    def kind(self) -> Literal["input", "output", "signal"]:
        """The key that says what it is in the scene."""
        return "input" if self.input is not None else "output" if self.output is not None else "signal"

    @property
    def name(self) -> str:
        """What it measures in the scene."""
        return self.input or self.output or self.signal or ""


class Estimate(Model):
    """A number that is not known: a parameter of the scene, or the offset of a sensor."""

    parameter: str | None = None
    offset: str | None = None
    start: Written | None = None
    sd: Written
    range: tuple[Written, Written] | None = RANGE
    drift: Written = 0.0

    @pydantic.model_validator(mode="after")
    def _one_of(self) -> Estimate:
        if (self.parameter is None) == (self.offset is None):
            raise refusal(
                "needs either parameter or offset", "name a parameter of the scene, or the output of a sensor"
            )
        return self

    @property
    def name(self) -> str:
        """Its name in the lines that come out."""
        return self.parameter or OFFSET + (self.offset or "")


class Watch(Model):
    """Something that raises an alarm."""

    output: str | None = None
    residual: str | None = None
    above: Written | None = None
    below: Written | None = None
    ahead: Ahead = 0.0
    for_: Wait = pydantic.Field(0.0, alias="for")
    name: str = ""

    @pydantic.model_validator(mode="after")
    def _sound(self) -> Watch:
        if (self.output is None) == (self.residual is None):
            raise refusal("needs either output or residual", "name an output, or the residual of a sensor")
        if self.above is None and self.below is None:
            raise refusal("has no bound", "write above: or below:")
        if self.residual is not None and self.ahead:
            raise refusal("looks ahead at a residual", "there is none before the data are there: leave out `ahead`")
        return self


class TwinMap(Scene):
    """The whole file."""

    sensors: Annotated[
        list[Sensor], pydantic.Field(min_length=1, examples=["[{column: load, unit: kN, output: winch.tension}]"])
    ]
    time: str = ""
    estimate: tuple[Estimate, ...] = pydantic.Field(
        (), examples=["[{parameter: 'bodies[0].mass', sd: 100 kg, range: [4 t, 6 t]}]"]
    )
    window: Seconds | None = None
    delay: Wait | None = None
    watch: tuple[Watch, ...] = pydantic.Field((), examples=["[{output: winch.tension, above: 60 kN, name: overload}]"])
    keep: tuple[str, ...] = pydantic.Field((), examples=["[winch.tension]"])
    lost: Seconds = 5.0
    forecast_every: Seconds = 0.5
    restrict: Switch | None = None
    run_in: Seconds = 10.0
    ahead: Ahead = 2.0


def read_map(path: str | Path | Mapping[str, Any]) -> TwinMap:
    """Read a map from a file, a YAML text or a dict.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    from tautline.scene.reading.source import document_of

    return TwinMap.read(document_of(path, None))


def driven_by(read: TwinMap) -> list[str]:
    """Names of the inputs that a map drives."""
    return [sensor.input for sensor in read.sensors if sensor.input is not None]
