"""A map checked against a scene: texts become numbers in SI, and what is wrong is told by line, key and cure."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic_core import PydanticCustomError

from tautline.live.errors import UnknownName
from tautline.live.simulation import Simulation
from tautline.scene.errors import Problem, SceneError
from tautline.scene.refusal import meant, nearest
from tautline.scene.values.quantity import Quantity
from tautline.scene.values.units import Uncounted, UnknownUnit, converted, read_unit
from tautline.system.handles import Bounds
from tautline.twin.map.faults import other_quantity, outside
from tautline.twin.map.file import Estimate, Sensor, TwinMap, Watch, Written, driven_by
from tautline.twin.map.names import Names, names_of
from tautline.twin.map.plan import Alarm, Channel, Plan, Unknown

TIMES_SD = re.compile(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*sd\s*")
PER_CENT = re.compile(r"\s*([0-9.]+(?:[eE][-+]?\d+)?)\s*%\s*")
WINDOW = 3.0
"""Of the estimate, s, where the map gives none and the application's operation none either."""


def plan_of(
    read: TwinMap, names: Names, values: Mapping[str, float], signals: Mapping[str, str] | None = None,
    further: Mapping[str, str] | None = None,
) -> Plan:  # fmt: skip
    """Check a map against what the scene has.

    Parameters
    ----------
    values : mapping
        Parameters of the scene as it is written, where an estimate says no start.
    signals : mapping, optional
        What the application asks for beside inputs and outputs: name -> unit.
    further : mapping, optional
        What it finds itself, which can be kept too: name -> what to give so that it does, empty where nothing lacks.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    reader = _Reader(read, names, dict(values), dict(signals or {}), dict(further or {}))
    plan = reader.plan()
    if reader.problems:
        raise SceneError(reader.problems)
    return plan


def checked(
    read: TwinMap, scene: Any, signals: Mapping[str, str], further: Mapping[str, str]
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
        self, read: TwinMap, names: Names, values: dict[str, float], signals: dict[str, str], further: dict[str, str]
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
        cure = self.names.lacking.get(name, "") if kind == "parameter" else ""
        self.fault(key, f"there is no {kind} '{name}'", cure or nearest(name, sorted(known)))
        return False

    def kept(self, key: tuple[str | int, ...], name: str) -> None:
        """A fault where an output that is to be kept is none, or is found only where more is given."""
        if lacking := self.further.get(name):
            self.fault(key, "is found only where more is given", lacking)
        else:
            self.known(key, "output", name, {**self.outputs, **self.further})

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
            self.kept(("keep", i), name)
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
        if one.parameter is not None and target in self.names.bounds:
            low, high = self.may_be(key, one, self.names.bounds[target], start, (low, high))
        if not sd > 0.0:
            self.fault((*key, "sd"), "must be greater than zero", "say how far off the start may be")
        if one.range is not None and low < high and not low <= start <= high:
            self.fault((*key, "start"), *outside(one.start, default, one.range, (low, high), unit))
        drift = self.drift((*key, "drift"), one.drift, unit)
        return Unknown(
            name=one.name, target=target, is_offset=one.parameter is None, unit=unit, start=start, sd=sd, low=low,
            high=high, drift=drift,
        )  # fmt: skip

    def may_be(
        self, key: tuple[str | int, ...], one: Estimate, bounds: Bounds, start: float, span: tuple[float, float]
    ) -> tuple[float, float]:
        """Range of an estimate of a parameter; a fault where it begins, or may come, where the parameter cannot be.

        Without a range it comes no further than the most that the parameter may be.
        """
        told = f"give {bounds.told(self.names.parameters[one.parameter or ''])}"
        if one.start is not None and not bounds.hold(start):
            self.fault((*key, "start"), f"{one.parameter} = {start:g} cannot be", told)
        for k, end in enumerate(span):
            # An estimate rests on the end of its range, which may be the least that the parameter must exceed.
            if math.isfinite(end) and not bounds.least <= end <= bounds.most:
                self.fault((*key, "range", k), f"{one.parameter} = {end:g} cannot be", told)
        return span if one.range is not None else (span[0], bounds.most)

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
            # What is computed raises an alarm as a run is judged. A sensor shows what it is said to show.
            target = self.names.judged_by[target][one.above is None]
        unit = self.outputs[target]
        times = one.residual is not None and isinstance(one.above, str) and TIMES_SD.fullmatch(one.above)
        if times:
            above, below = float(times[1]), -math.inf
        else:
            above = self.number((*key, "above"), one.above, unit, math.inf)
            below = self.number((*key, "below"), one.below, unit, -math.inf)
        if times and one.below is not None:
            cause = "stands beside a bound in deviations, which counts both ways"
            self.fault((*key, "below"), cause, "leave it out, or watch it in an entry of its own")
        if above <= below:
            cause = f"is not above `below: {one.below}`, so that every value is beyond one of both"
            self.fault((*key, "above"), cause, "exchange them, or watch each in an entry of its own")
        side, bound = ("above", one.above) if one.above is not None else ("below", one.below)
        said = f"{asked} {side} {bound}" if isinstance(bound, str) else f"{asked} {side} {bound:.10g} {unit}".strip()
        return Alarm(
            name=one.name or said, asked=asked, target=target,
            shown_by=target if target in measured and asked not in measured else asked,
            is_residual=one.residual is not None, above=above, below=below, times_sd=bool(times), ahead=one.ahead,
            lasting=one.for_, unit=unit,
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


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
