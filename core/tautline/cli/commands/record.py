"""The verb ``record``: a scene with sensors, and what they show."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from tautline.application.installed import Catalogue
from tautline.cli.options.changes import as_given, change_of
from tautline.cli.options.sensors import read_sensors
from tautline.cli.output.called import quoted, typed
from tautline.cli.output.console import print_json, say
from tautline.cli.output.preparing import preparing
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.cli.run import Ended, ExitCode
from tautline.results.errors import WriteError
from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from tautline.twin.record import Sensing


@dataclass(frozen=True, kw_only=True)
class RecordOptions:
    """What the command line gave of a record and its sensors, as it is written there."""

    end: str | None
    rate: str
    noise: str | None
    delay: str | None
    dropout: str | None
    jitter: str | None
    gap: Sequence[str] | None
    fault: Sequence[str] | None
    seed: int
    input_noise: Sequence[str] | None


def record(
    catalogue: Catalogue, path: Path, map: Path, output: Path, changes: Sequence[str] | None,
    given: RecordOptions, as_json: bool, quiet: bool, force: bool = False,
) -> None:  # fmt: skip
    """Run a scene with sensors, and write what they show.

    Parameters
    ----------
    force : bool
        Whether a record that is there may be replaced.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    """
    from tautline.integrators.status import Interrupted
    from tautline.results.output_path import check_record
    from tautline.twin.record import record as recorded

    application, scene = catalogue.read(path, change_of(changes))
    read = read_sensors(map)
    sensing = _sensing(given)
    until = _number("--end", given.end, "s", float("nan"))
    check_record(output, force)
    with preparing(path, scene, quiet):
        warnings = application.warnings(scene)
    print_warnings(warnings)
    rows = recorded(scene, read, sensing, None if until != until else until)
    try:
        first = next(rows, None)
    except Interrupted:
        raise KeyboardInterrupt from None  # before there was a row
    if first is None:
        cause = "no row is left of the record, by --gap and --dropout"
        raise option_error("-o", str(output), cause, "leave fewer rows out, or give a later --end")
    units = {one.column: one.unit for one in read.sensors}
    written = _write_rows(path, output, units, itertools.chain([first], rows))
    unfinished = ExitCode.INTERRUPTED if written.status == "interrupted" else ExitCode.STOPPED_EARLY
    if not written.rows:
        say(f"nothing of the record is kept: {output} is as it was", "yellow")
        raise Ended(unfinished)
    for name in written.empty:
        cause = "it is no part of the simulation, or a fault takes it away"
        say(f"warning: {name} is empty in all rows: {cause}. A twin of this record will call it lost", "yellow")
    following = typed(catalogue.name, "twin", path, "--map", map) + as_given(changes)
    following += f" --source {quoted(str(output))}"
    kept = "" if written.status == "done" else ", what there was until then"
    if not quiet:
        say(f"wrote {output}: {written.rows} rows{kept}. Next: {following}", "green")
    if as_json:
        report = {"status": written.status, "scene": str(path), "record": str(output), "rows": written.rows}
        print_json(report | {"scene_warnings": warning_records(warnings)})
    if written.status != "done":
        raise Ended(unfinished)


def _sensing(given: RecordOptions) -> Sensing:
    """What the sensors do to what they measure; raises SceneError."""
    from tautline.twin.record import Sensing, read_fault, read_gap, read_input_noise

    noise = None if given.noise is None else _share("--noise", given.noise)
    sensing = Sensing(
        rate=_number("--rate", given.rate, "Hz", 10.0), noise=noise,
        dropout=_share("--dropout", given.dropout), jitter=_number("--jitter", given.jitter, "s", 0.0),
        delay=_number("--delay", given.delay, "s", 0.0), gaps=[read_gap(text) for text in given.gap or ()],
        faults=[read_fault(text) for text in given.fault or ()], seed=given.seed,
        input_noise=dict(read_input_noise(text) for text in given.input_noise or ()),
    )  # fmt: skip
    if not sensing.rate > 0.0:
        raise option_error("--rate", given.rate, "is no rate", "give rows a second, such as 10 Hz")
    return sensing


class Written(NamedTuple):
    """How far a record was written: its rows, columns without a value in any of them, and how its run ended."""

    rows: int
    empty: list[str]
    status: str


def _write_rows(
    scene: Path, output: Path, units: Mapping[str, str], rows: Iterable[tuple[float, dict[str, float]]]
) -> Written:
    """Write a record row by row, as far as the run comes and there is room; says why where that is not to its end.

    Parameters
    ----------
    scene : Path
        Whose run it is.
    units : mapping of str to str
        Of the columns, in their order; empty where a column has none.
    rows : iterable of (float, dict)
        Time, s, and a value for each column, NaN where its sensor shows nothing.
    """
    from tautline.integrators.status import Interrupted, StoppedEarly
    from tautline.results.tables.lines import WholeLines

    columns = list(units)
    count, empty, status = 0, set(columns), "done"
    with WholeLines(output) as lines:
        try:
            lines.write(["time [s]", *(f"{name} [{units[name]}]" if units[name] else name for name in columns)])
            for time, values in rows:
                lines.write([f"{time:.6f}", *_cells(values, columns)])
                empty -= {name for name in empty if values[name] == values[name]}
                count += 1
        except StoppedEarly as stop:
            say(f"{scene}: {stop.line}", "red")
            status = stop.status.word
        except (KeyboardInterrupt, Interrupted):  # the second is the first, heard within a step
            status = "interrupted"
        except WriteError as error:
            say(f"{error.path}: {error.cause}; {error.cure}", "red")
            status = "could not be written"
        if count:
            lines.keep()
    return Written(count, [name for name in columns if name in empty], status)


def _number(option: str, text: str | None, unit: str, default: float) -> float:
    """An option's number, zero or more: plain, or a quantity; the default where it is not given."""
    from pydantic_core import PydanticCustomError

    from tautline.scene.values.quantity import Quantity

    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        try:
            value = float(Quantity(unit).read(text))
        except PydanticCustomError as error:
            cure = str((error.context or {}).get("cure", ""))
            raise option_error(option, text, error.message(), cure) from None
    if not 0.0 <= value < math.inf:
        raise option_error(option, text, "is to be zero or more, and finite", "give such a number")
    return value


def _share(option: str, text: str | None) -> float:
    """An option's share of rows, or of what is measured, at most all of it."""
    value = _number(option, text, "", 0.0)
    bare = re.fullmatch(r"[0-9.eE+-]+", str(text)) is not None
    # A plain 1 is more probably one per cent than noise as large as what is measured.
    if value > 1.0 or (bare and value == 1.0 and option == "--noise"):
        whole = "what is measured" if option == "--noise" else "all rows"
        cure = f"write `{text} %` if that is meant" if bare else "give 100 % or less"
        raise option_error(option, str(text), f"is {100.0 * value:.6g} % of {whole}", cure)
    return value


def _cells(values: dict[str, float], columns: Sequence[str]) -> list[str]:
    return [f"{values[name]:.9g}" if values[name] == values[name] else "" for name in columns]
