"""The map of a twin: which sensor is which input or output, what is estimated, what is watched."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import pydantic
from pydantic_core import PydanticCustomError

from tautline.live.errors import UnknownName
from tautline.live.simulation import Simulation
from tautline.scene.errors import Problem, SceneError
from tautline.scene.model import Model, Scene, Switch, word
from tautline.scene.refusal import meant, nearest, refusal
from tautline.scene.values.printed import quantity as printed
from tautline.scene.values.printed import significant
from tautline.scene.values.quantity import Quantity, quantity
from tautline.scene.values.units import Uncounted, UnknownUnit, converted, read_unit
from tautline.system.handles import PART
from tautline.twin.map_faults import other_quantity, outside

Seconds = Annotated[float, quantity("s", positive=True)]
Wait = Annotated[float, quantity("s", nonnegative=True)]
Written = pydantic.StrictBool | float | str
"""A number, or a text with a unit; it is read when the quantity that it belongs to is known. True is told as none."""
TIMES_SD = re.compile(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*sd\s*")
PER_CENT = re.compile(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*%\s*")
WINDOW = 3.0
"""Of the estimate, s, where the map gives none and the application's operation none either."""
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
    range: tuple[Written, Written] | None = None
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
    range: tuple[Written, Written] | None = None
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
    ahead: Wait = 0.0
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

    sensors: Annotated[list[Sensor], pydantic.Field(min_length=1)]
    time: str = ""
    estimate: tuple[Estimate, ...] = ()
    window: Seconds | None = None
    delay: Wait | None = None
    watch: tuple[Watch, ...] = ()
    keep: tuple[str, ...] = ()
    lost: Seconds = 5.0
    forecast_every: Seconds = 0.5
    restrict: Switch | None = None
    run_in: Seconds = 10.0
    ahead: Wait = 2.0


class Names(pydantic.BaseModel):
    """Names and units of a simulation: all that a map can refer to.

    Attributes
    ----------
    limits : tuple of Watch
        Limits that the scene gives itself, as far as a twin can watch them.
    unwatched : tuple of str
        Names of those that it cannot: of figures of a whole run, and of single numbers of an array.
    rivals : dict of str to list of str
        Inputs that drive the same as another one does, as a winch's place and its speed, by its name.
    judged_by : dict of str to (str, str)
        Outputs that are watched in place of others, above and below a bound, as the limits of a scene are judged.
    """

    inputs: dict[str, str]
    outputs: dict[str, str]
    shapes: dict[str, tuple[int, ...]]
    parameters: dict[str, str]
    limits: tuple[Watch, ...] = ()
    unwatched: tuple[str, ...] = ()
    rivals: dict[str, list[str]] = {}
    judged_by: dict[str, tuple[str, str]] = {}

    def elements(self, read: TwinMap) -> dict[str, str]:
        """Units of the single numbers of arrays that a map names, such as ``tip.position[0]``, by name."""
        outputs = [*(one.output for one in read.sensors), *(one.output for one in read.watch), *read.keep]
        found = {}
        for name in outputs:
            parts = PART.fullmatch(name or "")
            shape = self.shapes.get(parts[1], ()) if parts else ()
            at = [int(place) for place in parts[2].split(",")] if parts else []
            if parts and len(at) == len(shape) and all(place < size for place, size in zip(at, shape, strict=True)):
                found[parts[0]] = self.outputs[parts[1]]
        return found


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

    def told(self, value: float) -> str:
        """A value, SI, in words: in the column's unit."""
        if not self.column_unit:
            return printed(float(value), self.unit)
        return f"{significant(float(value) / self.factor)} {self.column_unit}"

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
    """A bound on an output or a residual, in SI; a bound on a residual may be a multiple of its standard deviation."""

    model_config = pydantic.ConfigDict(frozen=True)
    name: str
    target: str
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


def plan_of(
    read: TwinMap, names: Names, values: Mapping[str, float], signals: Mapping[str, str] | None = None,
    further: Collection[str] = (),
) -> Plan:  # fmt: skip
    """Check a map against what the scene has.

    Parameters
    ----------
    values : mapping
        Parameters of the scene as it is written, where an estimate says no start.
    signals : mapping, optional
        What the application asks for beside inputs and outputs: name -> unit.
    further : collection of str
        What it finds itself, which can be kept too.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    reader = _Reader(read, names, dict(values), dict(signals or {}), further)
    plan = reader.plan()
    if reader.problems:
        raise SceneError(reader.problems)
    return plan


def checked(
    read: TwinMap, scene: Any, signals: Mapping[str, str], further: Collection[str]
) -> tuple[Plan, Names, Simulation]:
    """A map checked against a scene, the names that the scene has, and its simulation, driven by the map.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    try:
        sim = Simulation(scene, driven_by(read), keep=False)
    except UnknownName:
        # Told by the line of the map, beside all else that is wrong with it.
        plan_of(read, names_of(Simulation(scene, keep=False)), {}, signals, further)
        raise
    names = names_of(sim)
    names = names.model_copy(update={"outputs": names.outputs | names.elements(read)})
    values = {name: sim.parameters[name] for name in names.parameters}
    return plan_of(read, names, values, signals, further), names, sim


class _Reader:
    """Turns the texts of a map into numbers, and collects what is wrong."""

    def __init__(
        self, read: TwinMap, names: Names, values: dict[str, float], signals: dict[str, str], further: Collection[str]
    ) -> None:
        self.map, self.names, self.values, self.signals, self.further = read, names, values, signals, further
        self.outputs = names.outputs | names.elements(read)
        self.problems: list[Problem] = []

    def fault(self, key: tuple[str | int, ...], cause: str, cure: str) -> None:
        self.problems.append(self.map.problem(key, cause, cure))

    def number(
        self, key: tuple[str | int, ...], written: Written | None, unit: str, default: float, factor: float = 1.0
    ) -> float:
        """A number in SI; a fault where it is none. One without a unit is in that of so many SI units."""
        if written is None:
            return default
        try:
            return float(Quantity(unit).read(written)) * (1.0 if isinstance(written, str) else factor)
        except PydanticCustomError as error:
            self.fault(key, error.message(), str((error.context or {}).get("cure", "")))
            return default

    def known(self, key: tuple[str | int, ...], kind: str, name: str, known: Mapping[str, Any]) -> bool:
        if name in known:
            return True
        self.fault(key, f"there is no {kind} '{name}'", nearest(name, sorted(known)))
        return False

    def measured(self, key: tuple[str | int, ...], name: str, measured: set[str]) -> bool:
        """Whether a sensor measures an output; a fault where none does, but for one that is only misspelt there."""
        sound = {one for one in measured if one in self.outputs}
        if name in sound:
            return True
        if f"did you mean '{name}'?" not in {meant(one, sorted(self.outputs)) for one in measured - sound}:
            cure = f"add a sensor with output: {name}" if name in self.outputs else nearest(name, sorted(sound))
            self.fault(key, f"no sensor measures '{name}'", cure if sound else "add a sensor with output:")
        return False

    def plan(self) -> Plan:
        read = self.map
        channels = [self.channel(i, sensor) for i, sensor in enumerate(read.sensors)]
        self.repeated("sensors", [one.column for one in read.sensors], "column")
        self.repeated_names(channels)
        self.rivals()
        measured = {sensor.output for sensor in read.sensors if sensor.output}
        unknowns = [self.unknown(i, one, measured) for i, one in enumerate(read.estimate)]
        self.repeated("estimate", [one.name for one in read.estimate], "parameter")
        self.repeated("watch", [one.name for one in read.watch], "name", "give each alarm a name of its own")
        alarms = [self.alarm(i, one, measured) for i, one in enumerate([*read.watch, *self.limits()])]
        for i, name in enumerate(read.keep):
            self.known(("keep", i), "output", name, {**self.outputs, **dict.fromkeys(self.further)})
        if read.estimate and not measured:
            self.fault(
                ("estimate",), "nothing is measured that an estimate could come from", "add a sensor with output:"
            )
        restrict = bool(self.names.limits) if read.restrict is None else read.restrict
        return Plan(
            channels=[c for c in channels if c], unknowns=[u for u in unknowns if u], alarms=[a for a in alarms if a],
            keep=list(read.keep), time=read.time, window=read.window or WINDOW, delay=read.delay, lost=read.lost,
            forecast_every=read.forecast_every, restrict=restrict, run_in=read.run_in, ahead=read.ahead,
        )  # fmt: skip

    def limits(self) -> list[Watch]:
        """The scene's own limits, looked for as far ahead as the map says; what the map names itself comes first."""
        own = {(one.output, side) for one in self.map.watch for side in _sides(one)}
        called = {one.name for one in self.map.watch if one.name}
        return [
            one.model_copy(update={"ahead": self.map.ahead})
            for one in self.names.limits
            if one.name not in called and not own & {(one.output, side) for side in _sides(one)}
        ]

    def repeated(self, key: str, names: list[str], what: str, cure: str = "leave one of them out") -> None:
        for i, name in enumerate(names):
            if name and name in names[:i]:
                self.fault((key, i, what), f"'{name}' stands twice", cure)

    def repeated_names(self, channels: Sequence[Channel | None]) -> None:
        """Refuse a second sensor of what another one measures or drives, at the key that names it."""
        named: set[str] = set()
        for i, (sensor, channel) in enumerate(zip(self.map.sensors, channels, strict=True)):
            if channel is None:
                continue  # its name is refused already
            if sensor.name in named:
                self.fault(("sensors", i, sensor.kind), f"'{sensor.name}' stands twice", "leave one of them out")
            named.add(sensor.name)

    def rivals(self) -> None:
        """Refuse a second sensor that drives what another one drives: each row would give both for one advance."""
        driven: list[str] = []
        for i, sensor in enumerate(self.map.sensors):
            if sensor.input is None:
                continue
            for other in self.names.rivals.get(sensor.input, []):
                if other in driven:
                    one = next((name for name in (sensor.input, other) if name in self.outputs), None)
                    measured = f", or measure one of them: write output: {one}" if one else ""
                    cause = f"{sensor.input} and {other} drive the same"
                    self.fault(("sensors", i, "input"), cause, f"leave one of them out{measured}")
            driven.append(sensor.input)

    def channel(self, i: int, sensor: Sensor) -> Channel | None:
        is_input = sensor.input is not None
        kinds = {"input": self.names.inputs, "output": self.names.outputs, "signal": self.signals}
        kind, key = sensor.kind, ("sensors", i, sensor.kind)
        known = kinds[kind]
        if sensor.name not in known and (other := next((one for one in kinds if sensor.name in kinds[one]), None)):
            cure = f"there is {'a' if other == 'signal' else 'an'} {other} of that name: write {other}: {sensor.name}"
            self.fault(key, f"there is no {kind} '{sensor.name}'", cure)
            return None
        if not self.known(key, kind, sensor.name, known):
            return None
        unit = known[sensor.name]
        if kind == "output" and self.names.shapes.get(sensor.name, ()):
            first = ",".join("0" for _ in self.names.shapes[sensor.name])
            cure = f"name one of its numbers: {sensor.name}[{first}]"
            self.fault(("sensors", i, "output"), f"{sensor.name} is an array", cure)
            return None
        factor = self.factor(("sensors", i, "unit"), sensor.unit, unit)
        share = PER_CENT.fullmatch(sensor.sd) if isinstance(sensor.sd, str) and unit else None
        sd = float(share[1]) / 100.0 if share else self.number(("sensors", i, "sd"), sensor.sd, unit, math.nan, factor)
        if sd <= 0.0:
            self.fault(("sensors", i, "sd"), "must be greater than zero", "give the sensor's standard deviation")
        low, high = self.bounds(("sensors", i, "range"), sensor.range, unit, factor)
        zero = 0.0 if sensor.zero == "first" else float(sensor.zero)
        waves = sensor.forecast == "waves" or (sensor.forecast is None and sensor.name.startswith("vessel."))
        return Channel(
            column=sensor.column, name=sensor.name, is_input=is_input, is_output=kind == "output", unit=unit,
            scale=sensor.scale * factor,
            zero=zero, zero_first=sensor.zero == "first", sd=sd, relative=share is not None, low=low, high=high,
            waves=waves, lost_after=sensor.lost_after or self.map.lost, column_unit=sensor.unit, factor=factor,
        )  # fmt: skip

    def factor(self, key: tuple[str | int, ...], written: str, wanted: str) -> float:
        """What a reading in the column's unit is multiplied by."""
        if not written:
            return 1.0
        try:
            unit, si = read_unit(written), read_unit(wanted) if wanted else read_unit("%")
            if unit.dimension != si.dimension:
                self.fault(key, *other_quantity(written, unit, wanted, si))
                return 1.0
            from fractions import Fraction

            return converted(unit, si).si(Fraction(1))
        except (UnknownUnit, Uncounted) as error:
            self.fault(key, f"'{written}' {error}", f"write a unit such as {wanted or '%'}")
            return 1.0

    def bounds(
        self, key: tuple[str | int, ...], given: tuple[Written, Written] | None, unit: str, factor: float = 1.0
    ) -> tuple[float, float]:
        if given is None:
            return -math.inf, math.inf
        low = self.number((*key, 0), given[0], unit, -math.inf, factor)
        high = self.number((*key, 1), given[1], unit, math.inf, factor)
        if not low < high:
            self.fault(key, "ends before it begins", "write the smaller number first")
        return low, high

    def unknown(self, i: int, one: Estimate, measured: set[str]) -> Unknown | None:
        key, target = ("estimate", i), one.parameter or one.offset or ""
        if one.parameter is not None:
            if not self.known((*key, "parameter"), "parameter", target, self.names.parameters):
                return None
            unit, default = self.names.parameters[target], self.values.get(target, 0.0)
        else:
            if not self.measured((*key, "offset"), target, measured):
                return None
            unit, default = self.outputs[target], 0.0
        start = self.number((*key, "start"), one.start, unit, default)
        sd = self.number((*key, "sd"), one.sd, unit, 1.0)
        low, high = self.bounds((*key, "range"), one.range, unit)
        if not sd > 0.0:
            self.fault((*key, "sd"), "must be greater than zero", "say how far off the start may be")
        if one.range is not None and low < high and not low <= start <= high:
            self.fault((*key, "start"), *outside(one.start, default, one.range, (low, high), unit))
        drift = self.drift((*key, "drift"), one.drift, unit)
        return Unknown(
            name=one.name, target=target, is_offset=one.parameter is None, unit=unit, start=start, sd=sd, low=low,
            high=high, drift=drift,
        )  # fmt: skip

    def drift(self, key: tuple[str | int, ...], written: Written, unit: str) -> float:
        """A drift, so much per root of a second: ``1 kg/s^0.5``."""
        if not isinstance(written, str):
            return self.number(key, written, unit, 0.0)
        for ending in ("/s^0.5", "/sqrt(s)", "/√s"):
            text = written.replace(" ", "")
            if text.endswith(ending):
                rest = text.removesuffix(ending)
                return self.number(key, float(rest) if _is_number(rest) else rest, unit, 0.0)
        if _is_number(written):
            return float(written)
        self.fault(key, "is no drift", f"write so much per root of a second, such as '1 {unit or ''}/s^0.5'")
        return 0.0

    def alarm(self, i: int, one: Watch, measured: set[str]) -> Alarm | None:
        key, target = ("watch", i), one.output or one.residual or ""
        kind = "output" if one.output else "residual"
        if one.output:
            if not self.known((*key, kind), kind, target, self.outputs):
                return None
        elif not self.measured((*key, kind), target, measured):
            return None
        asked = target
        if one.output and target in self.names.judged_by:
            # What raises an alarm is what a run is judged by.
            target = self.names.judged_by[target][one.above is None]
        unit = self.outputs[target]
        times = one.residual is not None and isinstance(one.above, str) and TIMES_SD.fullmatch(one.above)
        if times:
            above, below = float(times[1]), -math.inf
        else:
            above = self.number((*key, "above"), one.above, unit, math.inf)
            below = self.number((*key, "below"), one.below, unit, -math.inf)
        side, bound = ("above", one.above) if one.above is not None else ("below", one.below)
        said = f"{asked} {side} {bound}" if isinstance(bound, str) else f"{asked} {side} {bound:.10g} {unit}".strip()
        return Alarm(
            name=one.name or said, target=target, is_residual=one.residual is not None, above=above, below=below,
            times_sd=bool(times), ahead=one.ahead, lasting=one.for_, unit=unit,
        )  # fmt: skip


def bare_bounds(read: TwinMap, plan: Plan) -> list[str]:
    """Sentences on bounds without a unit beside a sensor that has one: they are in SI units, unlike its readings."""
    units = {one.name: one for one in plan.measured if one.column_unit and one.factor != 1.0}
    sentences = []
    for one in read.watch:
        channel = units.get(one.output or one.residual or "")
        if channel is None:
            continue
        for side in _sides(one):
            bound = getattr(one, side)
            if isinstance(bound, str) or bound == 0.0:
                continue
            sentences.append(
                f"watch: `{side}: {bound:.10g}` of {channel.name} has no unit and counts as {bound:.10g} "
                f"{channel.unit}. The sensor {channel.column} is in {channel.column_unit}. "
                f"If the bound is too, write `{side}: {bound:.10g} {channel.column_unit}`"
            )
    return sentences


def _sides(one: Watch) -> list[str]:
    return [side for side in ("above", "below") if getattr(one, side) is not None]


def watches_of(bounds: Sequence[Any], outputs: Collection[str]) -> tuple[list[Watch], list[str]]:
    """Limits of a scene as entries of ``watch``, and the names of those that no twin can watch.

    Parameters
    ----------
    bounds : sequence of tautline.results.assessment.bounds.Bound
    outputs : collection of str
        Names of what can be read while a simulation runs.
    """
    from tautline.results.assessment.limits import AT_MOST

    entries = [
        Watch.model_validate({
            "output": one.output, "above" if one.sense == AT_MOST else "below": one.limit, "for": one.lasting,
            "name": one.name,
        })
        for one in bounds if one.of_frames and one.output in outputs
    ]  # fmt: skip
    kept = {one.name for one in entries}
    return entries, [one.name for one in bounds if one.name not in kept]


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def names_of(sim: Simulation) -> Names:
    """Names and units of what a simulation has."""

    def units(told: Mapping[str, Any]) -> dict[str, str]:
        return {name: one["unit"] for name, one in told.items()}

    outputs = sim.outputs.describe()
    limits, unwatched = watches_of(sim.model.bounds, outputs)
    return Names(
        limits=tuple(limits),
        unwatched=tuple(unwatched),
        inputs=units(sim.inputs.describe()),
        rivals={name: others for name in sim.inputs if (others := sim.inputs.rivals(name))},
        outputs=units(outputs),
        parameters=units(sim.parameters.describe()),
        shapes={name: tuple(one["shape"]) for name, one in outputs.items()},
        judged_by={name: one.judged_by for name, one in sim.outputs.handles.items() if all(one.judged_by)},
    )
