"""Functions of time, as they are written in a scene.

One vocabulary for every prescribed motion: ``constant``, ``ramp``, ``table``, ``harmonic``, ``chirp``, ``spectrum``,
``sum``; a bare number is a constant. The unit of the value belongs to the place: ``block: Annotated[FunctionOfTime,
time_function("m")]`` reads lengths, a rotary speed reads ``rad/s``. `tautline.system.time_functions` compiles them.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NoReturn

import numpy as np
from pydantic import (
    Field,
    GetCoreSchemaHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    create_model,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from tautline.scene.choices.branches import Branch, OneOf
from tautline.scene.choices.words import word
from tautline.scene.curves import beyond
from tautline.scene.errors import SceneError
from tautline.scene.model import Model, Whole
from tautline.scene.reading.columns import HEADER, NUMBER, Columns
from tautline.scene.reading.files import FileName
from tautline.scene.reading.time_columns import TIMES, is_of_days, time_columns, time_head, unit_of_time
from tautline.scene.refusal import fault, nearest, refusal
from tautline.scene.values.magnitude import SMALLEST
from tautline.scene.values.quantity import quantity
from tautline.scene.values.ranges import rate_of, sized

Time = Annotated[float, quantity("s", of="moment")]
Duration = Annotated[float, quantity("s", positive=True, of="duration")]
Period = Annotated[float, quantity("s", positive=True, of="period")]
Angle = Annotated[float, quantity("rad", of="phase")]
RESPONSE = "response to waves"
Number = Annotated[float, quantity("", of=RESPONSE)]
MOST_COMPONENTS = 5000
SHORTEST_RAMP = 1.0e-9
LONGEST_GAP = 3.0
"""Usual intervals without a row that are bridged where no `gap` is given."""
RECORD, EVEN, MOSTLY = 8, 0.1, 0.75
"""Rows from which on a file of even rows may be a record; how even its intervals are, and what share of them."""
MANY, ORDINARY = 20, 0.9
"""Rows from which on a file may be a record with uneven rows, and the share of its intervals that are no gaps."""
FELT = 0.01
"""Share of the spread of all rows beyond two of them that a curve may go in a gap."""
OFFERED = 4
"""Columns that are offered by name where it is not clear which one is meant."""
RATES = ("m/s", "rad/s")
"""Units of values between which a table goes straight unless told otherwise."""


class _OfUnit(Model):
    """A function whose class is made for the unit of its value: it is made anew where one is unpickled.

    Attributes
    ----------
    made_of : tuple of str
        Unit, row of the table of plausible ranges and key, of a class that was made; empty for what is written here.
    """

    made_of: ClassVar[tuple[str, ...]] = ()

    def __reduce__(self) -> Any:
        if not self.made_of:
            return super().__reduce__()
        return _blank, self.made_of, self.__getstate__()


class Constant(Model):
    """A value that does not change."""

    value: float


class Ramp(_OfUnit):
    """A smooth (C2, quintic) transition from `from_` to `to` that begins at `at` and takes `over`.

    With `rate` in place of `to` the *slope* goes smoothly from zero to `rate`, and the value grows on at that rate.
    """

    to: float | None = None
    rate: float | None = None
    over: Duration
    from_: float = Field(0.0, alias="from")
    at: Time = 0.0

    @model_validator(mode="after")
    def _one_end(self) -> Ramp:
        if self.over < SHORTEST_RAMP:
            raise fault("over", "is no time in which anything can move", "take some steps' time, or a constant value")
        if self.to is None and self.rate is None:
            raise fault("to", "is missing", "give `to: value`, or `rate: slope` for a value that grows on")
        if self.to is not None and self.rate is not None:
            raise fault("rate", "is given together with `to`", "keep one of the two")
        return self


class Table(_OfUnit):
    """Values at times, inline or from a CSV file; held constant before the first and after the last."""

    time: tuple[Time, ...] = Field((), examples=["[0, 1, 2]"])
    value: tuple[float, ...] = Field((), examples=["[0, 0.5, 0.5]"])
    file: FileName | None = None
    column: str | None = None
    gap: Annotated[
        Duration | None,
        Field(description="longest time without a row in a file; default of a record: three times the usual one"),
    ] = None
    interpolation: Annotated[
        Literal["linear", "cubic"] | None,
        Field(description="default: linear for a velocity, cubic for a position, a force, a torque or a share"),
    ] = None

    @model_validator(mode="after")
    def _rows(self) -> Table:
        if self.gap is not None and self.file is None:
            raise fault("gap", "is given without a file", "leave it out: rows of a list are as far apart as is meant")
        if not self.time:
            raise fault("time", "is an empty list", "give at least one time, or a file")
        if len(self.time) != len(self.value):
            cause = f"has {len(self.value)} entries, and time has {len(self.time)}"
            raise fault("value", cause, "give a value for every time")
        for i, (earlier, later) in enumerate(itertools.pairwise(self.time), 1):
            if not later > earlier:
                cause = f"must be later than the one before ({earlier:g} s)"
                raise fault(("time", i), cause, "put the times in increasing order, each once")
            if later - earlier < SMALLEST:
                raise fault(("time", i), "is no time after the one before", "give times that are some steps apart")
        return self


class Harmonic(_OfUnit):
    """``mean + amplitude sin(2 pi t / period + phase)``, the sine under a quintic envelope over the first `ramp`."""

    amplitude: float
    by_unit: ClassVar[Mapping[tuple[str, str], tuple[str, str]]] = {
        ("period", "s"): ("Hz", "frequency"),
        ("frequency", "Hz"): ("s", "period"),
    }

    period: Period | None = None
    frequency: Annotated[float, quantity("Hz", positive=True, of="frequency")] | None = None
    phase: Angle = 0.0
    mean: float = 0.0
    ramp: Annotated[float, quantity("s", nonnegative=True, of="duration")] = 0.0

    @model_validator(mode="after")
    def _one_period(self) -> Harmonic:
        if self.period is None and self.frequency is None:
            raise fault("period", "is missing", "give `period:` in seconds, or `frequency:` in Hz")
        if self.period is not None and self.frequency is not None:
            raise fault("frequency", "is given together with `period`", "keep one of the two")
        return self


class Chirp(_OfUnit):
    """``amplitude [sin(2 pi (t - shift) / period + rate (t - shift)^2) - (the same at t = 0)]``; `rate` in rad/s^2."""

    amplitude: float
    period: Period
    rate: Annotated[float, quantity("rad/s^2", of="angular acceleration")]
    shift: Time = 0.0


class Spectrum(_OfUnit):
    """A random sea: JONSWAP waves, times the response `rao` (the value per metre of wave, in m/m or rad/m)."""

    kind: Annotated[Literal["jonswap"], word("jonswap")] = "jonswap"
    significant_height: Annotated[float, quantity("m", nonnegative=True, of="significant wave height")] = Field(
        examples=["2.5 m"]
    )
    peak_period: Annotated[float, quantity("s", positive=True, of="peak period")] = Field(examples=["9 s"])
    gamma: Annotated[float, quantity("", positive=True, at_most=20.0, of="peak factor")] = 3.3
    seed: Annotated[Whole, Field(ge=0)] = 0
    rao: Number = 1.0
    components: Annotated[Whole, Field(ge=1, le=MOST_COMPONENTS)] = 200
    ramp: Annotated[float, quantity("s", nonnegative=True, of="duration")] = 0.0


class Sum(Model):
    """Several functions, added."""

    terms: tuple[Any, ...]


def terms_of(function: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """A function that is no sum, or those of a sum and of the sums in it, each with its keys: ``sum[1].sum[0].``."""
    if not isinstance(function, Sum):
        yield key, function
        return
    for i, term in enumerate(function.terms):
        yield from terms_of(term, f"{key}sum[{i}].")


class Velocity(Model):
    """A position given by its velocity, zero at t = 0."""

    velocity: Any


FunctionOfTime = Constant | Ramp | Table | Harmonic | Chirp | Spectrum | Sum
Position = FunctionOfTime | Velocity


class _Terms:
    """The list under ``sum``: read when it occurs, because functions hold functions."""

    def __init__(self, unit: str, of: str) -> None:
        self.unit, self.of = unit, of

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def read(value: Any, info: core_schema.ValidationInfo) -> Any:
            if not isinstance(value, list) or not value:
                raise refusal("is not a list of functions", "write a list: sum: [{constant: 1.0}, {harmonic: ...}]")
            return _terms(self.unit, self.of).validate_python(value, context=info.context)

        return core_schema.with_info_before_validator_function(read, core_schema.any_schema())


@functools.cache
def _terms(unit: str, of: str) -> TypeAdapter[Any]:
    return TypeAdapter(list[Annotated[Any, time_function(unit, of=of)]])


def places(columns: Columns, asked: Any) -> tuple[int, int]:
    """Where time and value stand in the file of a table, whose column of values may be asked for by name.

    A time is in the unit that its header has in brackets or at its end, ``time_ms``, and in s where it has none.
    `tautline.scene.reading.time_columns` says by which names it is found.
    Without a name the value is the only column beside time, or the one that is called `value`. Columns without a name
    below a header, such as the numbers of rows that other programs write, are none where two others have names and one
    of those is the time. Else they count: programs write the times without a name, too, or give units only.

    Raises
    ------
    SceneError
        If there is no such column, or if it is not clear which one is the time or the value.
    """
    named = [i for i, name in enumerate(columns.names) if name]
    may_be = time_columns(columns)
    if len(may_be) > 1 and not all(columns.names[i] == columns.names[may_be[0]] for i in may_be):
        called = " or ".join(columns.titles[i] for i in may_be[:OFFERED])
        cause = f"it is not clear which column is the time: {called}"
        columns.stop(columns.header_line, "", None, cause, "call the column of times `time` in the header")
    known = may_be[0] if may_be else None
    shown = named if len(named) > 1 and known in named else columns.filled()
    at, wanted = _asked(columns, asked) if isinstance(asked, str) else (None, "value")
    meant = isinstance(asked, str) or wanted in columns.names
    if known is None and len(shown) > 2 and meant:
        known = _growing(columns, [i for i in shown if columns.names[i] != wanted])
    if len(shown) > 2 and (known is None or (not meant and columns.names[known] not in TIMES)):
        _unclear(columns, shown, "and none is called time", "call the column of times `time` in the header")
    time = known if known is not None else shown[0] if shown else 0
    if known is None and meant and len(shown) == 2 and columns.names[time] == wanted:
        time = shown[1]
    _take_unit(columns, time, known is not None)
    for name in (columns.names[time], wanted if at is None else ""):
        if name and (twice := columns.names.count(name)) > 1:
            cause = f"{twice} columns are called '{name}'"
            columns.stop(columns.header_line, name, None, cause, "give the ones that are not meant another name")
    beside = [i for i in shown if i != time]
    if meant:
        return time, columns.index((wanted,)) if at is None else at
    if len(beside) > 1:
        names = [columns.names[i] for i in beside[:OFFERED]]
        cure = f"write beside the file which one is meant: {' or '.join(f'`column: {name}`' for name in names)}"
        _unclear(columns, beside, "beside time, and none is called value", cure)
    return time, beside[0] if beside else columns.index(("value",))


def _asked(columns: Columns, name: str) -> tuple[int | None, str]:
    """The name of the column that a scene asks for, and its place where it is asked for by its whole title.

    Raises
    ------
    SceneError
        If there is no such column; its key is that of the scene.
    """
    if name.lower() in columns.names:
        return None, name.lower()
    place = columns.titled(name)
    if place is not None:
        return place, columns.names[place]
    bare = HEADER.fullmatch(name)
    title = bare["name"] if bare else name
    columns.refuse_title_lines()
    cause = f"there is no column '{name}' in {columns.path.name}, line {columns.header_line}"
    if title.lower() in columns.names:
        there = columns.titles[columns.names.index(title.lower())]
        cause, cure = f"{cause}, but '{there}'", f'write `column: "{there}"`, as in the header'
    else:
        cure = f"name it in the header; {nearest(name, [one for one in columns.names if one])}"
    columns.stop(columns.header_line, "column", name, cause, cure)


def _take_unit(columns: Columns, time: int, named: bool) -> None:
    """Give the column of times the unit that its name ends with, where it has none in brackets; s where it has none.

    `named` is whether the column is the time by its header, and not only by its place.

    Raises
    ------
    SceneError
        If the name ends with what may be a unit of time and may be something else, or is not understood.
    """
    title, unit = columns.titles[time], columns.units[time]
    in_brackets = unit_of_time(unit)
    if in_brackets != "" or not title:
        columns.units[time] = in_brackets or unit
        return
    first = next(iter(columns.rows[0][1][time:]), "").replace(",", ".")
    if is_of_days(title, columns.names, float(first) if NUMBER.fullmatch(first) else 0.0):
        cause = f"'{title}' has the days of a spreadsheet times a million here, as WinCC writes, and no milliseconds"
        cure = (
            "write the times in seconds from the start of the run; if these are milliseconds, call the column time [ms]"
        )
        columns.stop(columns.header_line, title, None, cause, cure)
    head = time_head(title)
    if head.doubtful or (head.kind == "min" and not named):
        cause = f"'{title}' is taken for the times, and it is not clear in which unit they are"
        cure = "write the unit of the times in brackets, such as time [s], time [min] or time [hour]"
        columns.stop(columns.header_line, title, None, cause, cure)
    columns.units[time] = head.unit


def _growing(columns: Columns, listed: Sequence[int]) -> int | None:
    """The first of some columns, if it has no name, and its numbers grow from row to row, and those of no other do.

    Numbers of rows and depths grow as times do: a column whose name is none of the time's is not taken for it.
    """
    growing = [i for i in listed if columns.grows(i)]
    return growing[0] if growing == listed[:1] and not columns.names[growing[0]] else None


def _unclear(columns: Columns, listed: Sequence[int], which: str, cure: str) -> NoReturn:
    """Refuse a file in which a table's time or value may be one of several columns; raises SceneError."""
    if not columns.headed:
        cause = f"has {len(listed)} columns and no header: it is not clear which are time and value"
        cure = "write a header above the numbers, such as time,value, or keep only these two columns"
        columns.stop(columns.header_line, "", None, cause, cure)
    nameless = next((i for i in listed if not columns.names[i]), None)
    if nameless is not None:
        cause = f"the header gives no name to column {nameless + 1}: it is not clear which are time and value"
        columns.stop(columns.header_line, "", None, cause, "give each column a name, such as time,value")
    columns.refuse_title_lines()
    names = ", ".join(columns.titles[i] for i in listed)
    columns.stop(columns.header_line, "", None, f"has {len(listed)} columns {which}: {names}", cure)


def _from_file(data: Any, info: ValidationInfo, unit: str) -> Any:
    """Replace ``file:`` by the times and values in it."""
    if not isinstance(data, dict) or not isinstance(data.get("file"), str):
        return data
    if data.get("time") is not None or data.get("value") is not None:
        raise fault("file", "is given together with time and value", "keep the file, or the lists")
    folder = (info.context or {}).get("folder", Path())
    try:
        columns = Columns(Path(folder) / data["file"])
        time, value = places(columns, data.get("column"))
        times, values = columns.values(time, "s"), columns.values(value, unit)
        columns.in_order(time, times)
        if data.get("interpolation") != "linear" and (data.get("interpolation") or unit not in RATES):
            _without_gaps(columns, time, times, values, unit, data.get("gap"))
        return data | {"time": list(times), "value": list(values)}
    except SceneError as error:
        first = error.problems[0]
        if first.key == "column":  # of the scene, and not of the file
            raise fault("column", first.cause, first.cure) from None
        if first.line is None:  # no line of the file is to blame, but that it was named
            raise fault("file", first.cause, first.cure) from None
        words = first.cause
        if first.value is not None:
            whole = first.key == "row"
            words = f"the row '{first.value}' {words}" if whole else f"{first.value} in {first.key} {words}"
        raise refusal(words, first.cure, file=first.file, line=first.line) from None


def usual_interval(time: np.ndarray, least: int = RECORD) -> float:
    """The time between the rows (n,) of a record that no gap is judged to be shorter than, s: 0 of what is no record.

    Of even rows the median. Stamps of a logger jitter, and a row is lost here and there: of many rows it is what nine
    of ten intervals stay within. So a gap among even rows is seen, and rows that are uneven throughout have none.
    """
    intervals = np.diff(time)
    if time.size < least:
        return 0.0
    usual = float(np.median(intervals))
    if usual > 0.0 and np.mean(np.abs(intervals - usual) < EVEN * usual) >= MOSTLY:
        return usual
    return max(usual, float(np.quantile(intervals, ORDINARY))) if time.size >= max(least, MANY) else 0.0


def _without_gaps(
    columns: Columns, place: int, times: Sequence[float], values: Sequence[float], unit: str, gap: Any
) -> None:
    """Refuse a record with a long time without a row, which the curve does not bridge by itself; raises SceneError.

    A table of some rows as somebody thought them out is no record, unless the scene states the longest gap. A curve
    that stays between the two rows invents nothing: a hoist that has come to rest has no rows to fill in.
    """
    t, value = np.array(times), np.array(values)
    intervals, usual = np.diff(t), usual_interval(t)
    if not intervals.size or (gap is None and not usual):
        return
    try:
        longest = LONGEST_GAP * usual if gap is None else TypeAdapter(Duration).validate_python(gap)
    except ValidationError:
        return  # refused under its own key, with all else that is wrong there
    long = np.flatnonzero(intervals > longest * (1.0 + 1e-9))
    if not long.size:
        return
    for i, off in zip(long.tolist(), beyond(t, value, long).tolist(), strict=True):
        if off <= FELT * float(np.ptp(value)):
            continue
        (before, _), (line, row) = columns.rows[i], columns.rows[i + 1]
        more = f", and a curve through the rows goes {sized(off, unit)} beyond them there"
        cause = f"comes {intervals[i]:.6g} s after line {before} with no row between{more}"
        cure = "fill it in, give a longer `gap:` if the motion is known to be smooth, or write `interpolation: linear`"
        columns.stop(line, columns.names[place] or "time", row[place], cause, cure)


@functools.cache
def _models(unit: str, of: str) -> dict[str, type[Model]]:
    """Return the models of the functions whose value has a unit, and a row in the table of plausible ranges."""
    per_second = {"m/s": "m/s^2", "rad/s": "rad/s^2"}.get(unit, f"{unit or 1}/s")
    value: Any = Annotated[float, quantity(unit, of=of)]
    per_metre: Any = Annotated[float, quantity(f"{unit or 1}/m", of=RESPONSE)]
    slope: Any = Annotated[float, quantity(per_second, of=rate_of(unit) if of else "")]

    def read_file(cls: type, data: Any, info: ValidationInfo) -> Any:
        return _from_file(data, info, unit)

    def ask(table: Table, info: ValidationInfo) -> Table:
        # A second validation, of a scene that is sound, asks for what is doubtful: pydantic knows the key, and we not.
        asked = (info.context or {}).get("record")
        if asked is not None:
            asked(table, unit)
        return table

    method: Any = classmethod(read_file)
    from_file: Any = model_validator(mode="before")(method)
    asked: Any = model_validator(mode="after")(ask)
    made: dict[str, type[_OfUnit]] = {
        "ramp": create_model(
            "Ramp",
            __base__=Ramp,
            to=(value | None, None),
            rate=(slope | None, None),
            from_=(value, Field(0.0, alias="from")),
        ),
        "table": create_model(
            "Table",
            __base__=Table,
            __validators__={"from_file": from_file, "asked": asked},
            value=(tuple[value, ...], Field((), examples=["[0, 0.5, 0.5]"])),
        ),
        "harmonic": create_model("Harmonic", __base__=Harmonic, amplitude=(value, ...), mean=(value, 0.0)),
        "chirp": create_model("Chirp", __base__=Chirp, amplitude=(value, ...)),
        "spectrum": create_model("Spectrum", __base__=Spectrum, rao=(per_metre, 1.0)),
    }
    for key, model in made.items():
        model.made_of = unit, of, key
        model.__doc__ = model.__mro__[1].__doc__  # of the schema, which editors show
    return dict(made)


def _blank(unit: str, of: str, key: str) -> Model:
    """A function of time of which nothing is set yet."""
    model = _models(unit, of)[key]
    return model.__new__(model)


@functools.cache
def branches(unit: str, of: str = "") -> dict[str, Branch]:
    """Return the ways to write a function of time whose value has a unit, by key."""
    keyed = {"constant": Branch(Annotated[float, quantity(unit, of=of)], lambda value: Constant(value=value))}
    keyed |= {key: Branch(model) for key, model in _models(unit, of).items()}
    terms = Annotated[Any, _Terms(unit, of)]
    return keyed | {"sum": Branch(terms, lambda terms: Sum(terms=tuple(terms)))}


def time_function(
    unit: str, velocity: str | None = None, *, of: str = "", velocity_of: str = "", **others: Branch
) -> OneOf:
    """Annotate a function of time: ``Annotated[FunctionOfTime, time_function("m/s", of="winch speed")]``.

    Parameters
    ----------
    unit : str
        SI unit of the value.
    velocity : str, optional
        Unit of the value's rate: the function may then also be written ``{velocity: function}``, read as `Velocity`.
    of, velocity_of : str
        Rows of value and rate in the table of plausible ranges, `tautline.scene.values.ranges`.
    **others : Branch
        Further keys allowed in its place.
    """
    keyed = dict(branches(unit, of))
    if velocity is not None:
        inner = Annotated[Any, time_function(velocity, of=velocity_of)]
        keyed["velocity"] = Branch(inner, lambda function: Velocity(velocity=function))
    plain = Branch(Annotated[float, quantity(unit, of=of)], lambda value: Constant(value=value))
    return OneOf("a function of time", keyed | others, plain, example="{ramp: {to: 2.0, over: 1.0}}")
