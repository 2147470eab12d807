"""The plan of a twin: its map in SI, checked against a scene. Channels, unknowns and alarms."""

from __future__ import annotations

import math

import pydantic

from tautline.scene.values.printed import quantity as printed
from tautline.scene.values.printed import significant


class Channel(pydantic.BaseModel):
    """A sensor with its numbers in SI.

    Attributes
    ----------
    sd : float
        Standard deviation, SI; with `relative` a share of what is computed; NaN where none is given.
    scale, zero : float
        ``value = scale * (reading - zero)``: SI out of a reading in the column's unit.
    low, high : float
        What the sensor can show, SI.
    column_unit, factor : str, float
        Unit that the map gives the column, and how many SI units it is; empty and 1 where it gives none.
    """

    model_config = pydantic.ConfigDict(frozen=True)
    column: str
    name: str
    is_input: bool
    is_output: bool = True
    unit: str
    scale: float
    zero: float
    zero_first: bool
    sd: float
    relative: bool
    low: float
    high: float
    waves: bool
    lost_after: float
    column_unit: str = ""
    factor: float = 1.0

    @property
    def is_set(self) -> bool:
        """Whether it drives the simulation as a speed or a torque that a machine is set to, and stays at."""
        return self.is_input and (self.unit.endswith("/s") or self.unit == "N m")

    def told(self, value: float, digits: int = 4) -> str:
        """A value, SI, in words: in the column's unit, with so many significant digits."""
        if not self.column_unit:
            return printed(float(value), self.unit, digits)
        return f"{significant(float(value) / self.factor, digits)} {self.column_unit}"

    @property
    def shown(self) -> tuple[float, float]:
        """Its range in the column's unit: what readings can be; infinite where the first of them says what is zero."""
        if self.zero_first:
            return -math.inf, math.inf
        low, high = (one / self.scale + self.zero for one in (self.low, self.high))
        return min(low, high), max(low, high)


class Unknown(pydantic.BaseModel):
    """A quantity that is estimated, in SI."""

    model_config = pydantic.ConfigDict(frozen=True)
    name: str
    target: str
    is_offset: bool
    unit: str
    start: float
    sd: float
    low: float
    high: float
    drift: float


class Alarm(pydantic.BaseModel):
    """A bound on an output or a residual, in SI; a bound on a residual may be a multiple of its standard deviation.

    Attributes
    ----------
    asked : str
        What the map, or the limit of the scene, names: it is told by this name.
    target : str
        What of the simulation counts for it: that which is asked, or an output by which a run is judged in its place.
    shown_by : str
        Name of the sensor that shows it: that of what is asked, or where only what counts is measured, of that.
    """

    model_config = pydantic.ConfigDict(frozen=True)
    name: str
    asked: str
    target: str
    shown_by: str
    is_residual: bool
    above: float
    below: float
    times_sd: bool
    ahead: float
    lasting: float
    unit: str


class Plan(pydantic.BaseModel):
    """A map that was checked against a scene: everything in SI."""

    channels: list[Channel]
    unknowns: list[Unknown]
    alarms: list[Alarm]
    keep: list[str]
    time: str
    window: float
    delay: float | None
    lost: float
    forecast_every: float
    restrict: bool
    run_in: float
    ahead: float

    @property
    def inputs(self) -> list[Channel]:
        """Sensors that drive the scene."""
        return [one for one in self.channels if one.is_input]

    @property
    def measured(self) -> list[Channel]:
        """Sensors that are compared with the scene."""
        return [one for one in self.channels if one.is_output]
