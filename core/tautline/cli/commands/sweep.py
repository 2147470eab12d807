"""The verb ``sweep``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Catalogue, refuse_scene
from tautline.cli.options.changes import as_given, change_of
from tautline.cli.output.called import typed
from tautline.cli.output.console import console, print_json, say
from tautline.cli.output.first_run import compiling
from tautline.cli.output.numba_version import version_note
from tautline.cli.output.preparing import preparing
from tautline.cli.output.progress import Counter
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.cli.output.summary import two_columns
from tautline.cli.run import Ended, ExitCode
from tautline.scene.errors import SceneError, option_error
from tautline.scene.values.printed import printed_in, quantity, shown, significant

if TYPE_CHECKING:
    from tautline.scene.errors import SceneWarning
    from tautline.sweeps.sweep import Outcome
    from tautline.sweeps.table import Variables

TOLD = 5
"""Failed cases that are told one by one."""


def sweep(
    catalogue: Catalogue, file: Path, jobs: int | None, dask: str | None, output: Path | None, resume: bool,
    changes: Sequence[str] | None, as_json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Run a sweep and report.

    Parameters
    ----------
    file : Path
        Of the sweep, which names the scene.
    output : Path or None
        Folder; by default the name of the sweep's file, in the current folder.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    Ended
        If it was interrupted, or no case came to its end; that was reported, and what was finished is kept.
    """
    from tautline.sweeps.file import notes_of, read_sweep, scene_path

    if not file.exists():
        raise option_error("SWEEP", str(file), "there is no such file", "name the YAML file of a sweep")
    try:
        read = read_sweep(file)
    except SceneError:
        refuse_scene(file, "vary", f"name the file of a sweep, which says `scene: {file}` and what varies")
        raise
    place = scene_path(read)
    for change in changes or ():
        key = change.partition("=")[0].strip()
        if key in read.vary:
            cause = f"the sweep varies {key}: its values would take the place of this one"
            raise option_error("--set", change, cause, "leave it out here, or under vary")
    application, scene = catalogue.read(place, change_of(changes))
    folder = output or Path(file.stem)
    with preparing(place, scene, quiet):
        warnings = application.warnings(scene)
    print_warnings(warnings)
    if not quiet:
        for note in notes_of(read):
            say(f"note: {note}")
    if note := version_note():
        say(f"warning: {note}", "yellow")

    from tautline.sweeps.doubts import doubts_of_values
    from tautline.sweeps.execution import Execution
    from tautline.sweeps.sweep import run_sweep

    with Counter("cases", shown=not quiet) as bar:
        execution = Execution(jobs, dask, folder, resume, progress=bar)
        if not quiet:
            execution = replace(execution, announce=compiling, say=say)
        outcome = run_sweep(read, application, scene, execution)
    figures, undrawn = _draw(outcome, folder)
    doubts = failures(outcome) + _left_out(outcome) + outcome.unsatisfied.warnings(len(outcome.cases))
    doubts += doubts_of_values(outcome.cases, scene, application.warnings)
    following = typed(catalogue.name, "sweep", file, "-o", folder, "--resume") + as_given(changes)
    _report(file, outcome, figures, undrawn, warnings, doubts, as_json, quiet, following)


def _draw(outcome: Outcome, folder: Path) -> tuple[list[Path], list[str]]:
    """Draw what the plan has a figure for, and tell what is not drawn; the journal says which are the sweep's."""
    if outcome.result is None:
        return [], []
    from tautline.sweeps.figures import draw, not_drawn
    from tautline.sweeps.journal import list_figures

    drawn = draw(outcome.data, outcome.cases, folder) if outcome.done else []
    list_figures(folder, drawn)
    return drawn, not_drawn(outcome.data, outcome.cases) if outcome.done else []


def _report(
    file: Path, outcome: Outcome, figures: list[Path], undrawn: list[str], warnings: Sequence[SceneWarning],
    doubts: list[str], as_json: bool, quiet: bool, following: str,
) -> None:  # fmt: skip
    """Tell how the sweep ended; ``following`` is the command that goes on with it.

    ``doubts`` make its numbers less sure than they read: they are told whoever asks for quiet.
    """
    if not quiet:
        console().print(two_columns(_rows(outcome)))
        for path in (outcome.result, outcome.table, outcome.percentiles, *figures):
            if path is not None:
                say(f"wrote {path}", "green")
        for text in undrawn:
            say(f"note: {text}")
    for text in doubts:
        say(f"warning: {text}", "yellow")
    if outcome.aside is not None:
        say(f"results of an earlier sweep are not those of this one: they are in {outcome.aside}", "yellow")
    if outcome.interrupted:
        if outcome.lost:
            say(outcome.lost, "red")
        say(f"interrupted; go on: {following}", "yellow")
    if as_json:
        print_json(
            {
                "sweep": str(file),
                "status": outcome.ended,
                "cases": len(outcome.cases),
                "done": outcome.done,
                "failed": outcome.failed,
                "earlier": outcome.earlier,
                "result": None if outcome.result is None else str(outcome.result),
                "table": None if outcome.table is None else str(outcome.table),
                "samples_of_indices": {name: left for name, (left, _) in _samples(outcome).items()},
                "percentiles": None if outcome.percentiles is None else str(outcome.percentiles),
                "earlier_results": None if outcome.aside is None else str(outcome.aside),
                "figures": [str(path) for path in figures],
                "not_drawn": undrawn,
                "limits_not_satisfied": outcome.unsatisfied.told(),
                "warnings": doubts,
                "scene_warnings": warning_records(warnings),
                "wall_time": outcome.wall_time,
                "cpu_time": outcome.cpu_time,
                "overhead": outcome.overhead,
            }
        )
    if outcome.interrupted:
        raise Ended(ExitCode.STOPPED_EARLY if outcome.lost else ExitCode.INTERRUPTED)
    if not outcome.done:
        raise Ended(ExitCode.STOPPED_EARLY)


def _rows(outcome: Outcome) -> list[tuple[str, str]]:
    """Rows of the summary: the smallest and the largest of what was collected, and what it took."""
    import numpy as np

    from tautline.sweeps.table import TIMES

    data, system, rows = outcome.data, printed_in(outcome.data.attrs), []
    for name, one in data.data_vars.items():
        if name in TIMES or one.dims != outcome.cases.dims or not one.is_number:
            continue
        unit = str(one.attrs.get("units") or "")
        low, high = (shown(float(value), unit, system) for value in (np.nanmin(one.values), np.nanmax(one.values)))
        rows.append((str(name), low if low == high else f"{low} to {high}"))
    rows += _percentiles(data, system)
    rows += [("", ""), ("cases", str(len(outcome.cases))), ("done", str(outcome.done))]
    if outcome.failed:
        rows.append(("failed", str(outcome.failed)))
    if outcome.earlier:
        rows.append(("finished before", str(outcome.earlier)))
    rows += [("wall time", quantity(outcome.wall_time, "s")), ("processor time", quantity(outcome.cpu_time, "s"))]
    if outcome.overhead is not None and outcome.loop_time >= 1.0:
        rows.append(("beside the compiled loops", f"{significant(100.0 * outcome.overhead, 2)} %"))
    return rows


def _left_out(outcome: Outcome) -> list[str]:
    """What percentiles and indices do not hold: cases that failed or have no number, seldom a fair draw of all."""
    told = []
    told += _left_of_samples(outcome)
    if outcome.percentiles is not None and outcome.failed:
        told.append(f"percentiles are those of the {outcome.done} cases that came to their end: they may be biased")
    if outcome.percentiles is not None and outcome.interrupted:
        told.append(f"percentiles are those of the {outcome.done} cases so far, of {len(outcome.cases)}")
    return told + _empty(outcome) + _without_number(outcome) + _along(outcome)


def _left_of_samples(outcome: Outcome) -> list[str]:
    """Of how many samples Sobol' indices are, where it is not all of them; those of one number in one sentence.

    And what has none, since no parameter changes it.
    """
    from tautline.sweeps.indices import has_indices

    numbers: dict[tuple[int, int], list[str]] = {}
    same: list[str] = []
    for name, (left, made) in _samples(outcome).items():
        if left > 1 and not has_indices(outcome.data, name):
            same.append(name)
        elif left < made:
            numbers.setdefault((left, made), []).append(name)
    rule = "a sample of which a case failed, or has no number, is left out"
    told = [f"there are no Sobol' indices of {', '.join(same)}: the same in all samples"] if same else []
    return told + [
        f"Sobol' indices of {', '.join(names)} are those of {left} of {made} samples: {rule}"
        if left > 1
        else f"there are no Sobol' indices of {', '.join(names)}: {left} of {made} samples are left, for {rule}"
        for (left, made), names in numbers.items()
    ]


def _samples(outcome: Outcome) -> dict[str, tuple[int, int]]:
    """Samples that are left for indices, and those of the plan, by what was collected."""
    from tautline.sweeps.indices import samples_left

    found = {str(name): samples_left(outcome.data, str(name)) for name in outcome.data.data_vars}
    return {name: both for name, both in found.items() if both is not None}


def _empty(outcome: Outcome) -> list[str]:
    """Collected numbers that no case has, though some came to their end: without slack there is no snap."""
    numbers = ((name, one) for name, one in outcome.data.data_vars.items() if one.values.dtype.kind == "f")
    empty = [str(name) for name, one in numbers if one.dims == outcome.cases.dims and not one.is_number]
    return [f"{name}: no case has one; its column is empty" for name in empty] if outcome.done else []


def _along(outcome: Outcome) -> list[str]:
    """Numbers along an axis, of which indices and a tornado are not made."""
    from tautline.sweeps.plans import ONE

    cases = outcome.cases
    if not cases.indices and cases.plan.name != ONE:
        return []
    what = "Sobol' indices" if cases.indices else "no tornado"
    number = len(cases.dims)
    many = {
        str(name): one.dims[-1]
        for name, one in outcome.data.data_vars.items()
        if one.dims[:number] == cases.dims and len(one.dims) == number + 1
    }
    if not many:
        return []
    axis = next(iter(many.values()))
    made = f"no {what} are" if cases.indices else f"{what} is"
    return [f"{', '.join(many)}: numbers along {axis}, of which {made} made; give one {axis}"]


def _without_number(outcome: Outcome) -> list[str]:
    """Quantities that some cases lack, though they came to their end: a string that locks up has no hook load."""
    from tautline.sweeps.table import percentiles_of

    told = []
    for name, (_, one) in percentiles_of(outcome.data).items():
        if (least := int(one.values.min())) < outcome.done:
            where = f" (at {one.dims[0]} {_place(outcome.data, one)}, where most lack it)" if one.dims else ""
            lack = "no case has a" if least == 0 else f"{outcome.done - least} of {outcome.done} cases have no"
            rest = (
                "there are no percentiles" if least == 0 else "its percentiles are those of the others, and are biased"
            )
            told.append(f"{name}: {lack} number{where}; {rest}")
    return told


def _place(data: Variables, one: Any) -> str:
    """Where the least number of cases have a number."""
    k, axis = int(one.values.argmin()), data.coords.get(one.dims[0])
    if axis is None:
        return str(k)
    return shown(float(axis.values[k]), str(axis.attrs.get("units") or ""), printed_in(data.attrs))


def _shown(value: float, unit: str, system: str) -> str:
    """A percentile; one of cases without end is not one that is missing."""
    return "no end" if math.isinf(value) else shown(value, unit, system)


def _percentiles(data: Variables, system: str) -> list[tuple[str, str]]:
    """P10, P50 and P90 of each number; of what has an axis those at its last place."""
    from tautline.sweeps.table import RANKS, percentiles_of

    rows, ranks = [], ", ".join(f"P{rank:g}" for rank in RANKS)
    for name, (one, _) in percentiles_of(data).items():
        unit, place, values = str(one.attrs.get("units") or ""), "", one.values
        if values.ndim > 1:
            along, values = one.dims[1], values[:, -1]
            axis = data.coords.get(along)
            at = one.values.shape[1] - 1 if axis is None else float(axis.values[-1])
            axis_unit = "" if axis is None else str(axis.attrs.get("units") or "")
            place = f" at {along} {shown(at, axis_unit, system)}"
        told = ", ".join(_shown(float(value), unit, system) for value in values)
        rows.append((f"{name}{place}: {ranks}", told))
    return rows


def failures(outcome: Outcome) -> list[str]:
    """The first cases that failed, and why, a line each."""
    status: Any = outcome.data["status"].values.ravel()
    message: Any = outcome.data["message"].values.ravel()
    failed = [case for case, one in enumerate(status) if one not in ("done", "not run")]
    told = [f"case {case}: {status[case]}: {message[case]}" for case in failed[:TOLD]]
    more = len(failed) - TOLD
    return told + ([f"... and {more} more; status and message of each are in the table"] if more > 0 else [])
