"""The verb ``study``."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.application.installed import Catalogue
from tautline.cli.options.changes import change_of
from tautline.cli.options.lists import number, numbers, one_of, words
from tautline.cli.output.console import console, print_json, say
from tautline.cli.output.first_run import compiling
from tautline.cli.output.preparing import preparing, told_if_long
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.cli.run import Ended, ExitCode
from tautline.scene.errors import Problem, SceneError
from tautline.scene.methods import named as method_named
from tautline.scene.values.printed import significant

if TYPE_CHECKING:
    from rich.table import Table

    from tautline.integrators.status import StoppedEarly
    from tautline.scene.errors import SceneWarning
    from tautline.study.accuracy.precision import Grid, Row, Study
    from tautline.study.trials.trial import Subject

QUICK_END, QUICK_BUDGET = 0.1, 5.0
"""Share of the simulated time that a quick look takes, and the processor time, s, that it gives one run."""
ENDINGS = (".csv", ".nc", ".png")
MOST_TOLERANCE = 0.5
"""Relative error that nobody can mean to ask for."""
WIDEST = 400
"""Letters of a line of a table, at most."""
NEWTON = ("modified", "full")
NOT_RUN = ("refused", "left out")


@dataclass(frozen=True, kw_only=True)
class Options:
    """What the command line gave for any look at a scene by many runs, as it is written there but for `end`, s."""

    tolerance: str
    end: float | None
    point: str | None
    budget: float
    quick: bool
    changes: Sequence[str] | None


@dataclass(frozen=True, kw_only=True)
class StudyOptions(Options):
    """What it gave for a study."""

    methods: str | None
    steps: str | None
    elements: str | None
    constraints: str | None
    newton: str | None
    reference: str | None
    reference_step: str | None
    repeat: int


def study(catalogue: Catalogue, path: Path, output: Path | str | None, asked: StudyOptions, as_json: bool) -> None:
    """Run a grid of settings of a scene and report errors against run time.

    Parameters
    ----------
    output : Path, str or None
        Beginning of the names of the files that are written, or a folder for them, which is made where a text ends in a
        slash; by default the scene's name with ``_study``.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    Ended
        If the scene as it stands stopped early, or on Ctrl-C; what there was is reported.
    """
    from tautline.integrators.status import Interrupted, StoppedEarly
    from tautline.study.accuracy.precision import study as run

    # What is wrong with options is said before a scene is prepared, which may take long.
    grid, tolerance, reference = _grid(asked), percentage(asked.tolerance, "--tolerance"), _reference(asked)
    subject, warnings = prepared(catalogue, path, asked)
    stem = stem_of(path, output, "study")
    budget = asked.budget if not asked.quick else min(asked.budget, QUICK_BUDGET)
    try:
        with working() as progress:
            found = run(
                subject, grid, tolerance, budget=budget, point=asked.point,
                repetitions=1 if asked.quick else asked.repeat, reference=reference, progress=progress,
                reduced=asked.quick,
            )  # fmt: skip
    except StoppedEarly as stop:
        stopped(path, stop, as_json, warnings)
    except Interrupted:
        say("interrupted", "yellow")
        raise Ended(ExitCode.INTERRUPTED) from None
    refused = [row.trial.sentence for row in found.rows if row.trial.status == "refused"]
    if refused and len(refused) == len(found.rows):
        # What would do for the scene as it stands is not what was asked for here.
        cause, cure = refused[0].partition("; ")[0], "give other --steps, --methods or --elements, or a later --end"
        raise SceneError([Problem(str(path), None, "", None, f"no setting can be run: {cause}", cure)])
    _report(path, stem, found, as_json, warnings)
    if found.interrupted:
        say("interrupted", "yellow")
        raise Ended(ExitCode.INTERRUPTED)
    if found.stop is not None:
        raise Ended(ExitCode.STOPPED_EARLY)


def prepared(catalogue: Catalogue, path: Path, asked: Options) -> tuple[Subject, list[SceneWarning]]:
    """Read a scene for a study, and print its warnings, which are handed on; raises SceneError."""
    from tautline.study.trials.trial import Subject

    application, scene = catalogue.read(path, change_of(asked.changes, asked.end))
    with preparing(path, scene):
        warnings = list(application.warnings(scene))
    print_warnings(warnings)
    end, whole = asked.end, None
    if end is None and asked.quick:
        solver = application.build(scene).solver
        whole = float(solver.end)
        end = min(max(QUICK_END * whole, 20.0 * solver.interval, 20.0 * solver.step), whole)
    announced: list[int] = []

    def announce(kernels: int) -> Callable[[], None] | None:
        announced.append(kernels)
        return compiling(kernels) if len(announced) == 1 else None

    return Subject(application, scene, end=end, whole=whole, announce=announce), warnings


@contextmanager
def working() -> Iterator[Any]:
    """A line that says what is being run; a function that changes it. Without a terminal it is told as time passes."""
    if not console().is_terminal:
        stage = [""]
        with told_if_long(lambda: f"running: {stage[0] or 'the scene as it stands'}. Ctrl-C ends it"):
            yield lambda text: stage.__setitem__(0, text)
        return
    with console().status("") as status:
        yield lambda text: status.update(text.replace("[", "\\["))


def stem_of(path: Path, output: Path | str | None, word: str) -> Path:
    """Beginning of the names of files; raises ResultError where one of them could not be written."""
    from tautline.results.errors import ResultError
    from tautline.results.output_path import check_folder, check_made, names_folder

    usual = Path(f"{path.stem}_{word}")
    stem = Path(output) if output is not None else usual
    if output is not None and names_folder(output):
        check_made(stem)
        stem /= usual
        if not stem.parent.exists():
            return stem  # it is made with the first file, and nothing is in its way
    elif stem.suffix in ENDINGS:
        stem = stem.with_suffix("")
    for ending in ENDINGS:
        file = named(stem, ending)
        check_folder(file)
        if file.is_dir() or (file.exists() and not os.access(file, os.W_OK)):
            cause = "is a folder" if file.is_dir() else "is write-protected"
            raise ResultError(file, cause, "name others with -o")
        if file.is_file():
            _check_replaceable(file, ending)
        if not file.exists() and not os.access(file.parent, os.W_OK):
            raise ResultError(file, "cannot be written: permission denied", "name another folder with -o")
    return stem


def _check_replaceable(file: Path, ending: str) -> None:
    """Raise ResultError where a file is no figure, or no table of a study but a result: it would be lost."""
    from tautline.results.errors import ResultError
    from tautline.results.output_path import SIGNATURE, check_drawn, check_found

    if ending == ".png":
        check_drawn(file)
    elif ending == ".nc":
        with file.open("rb") as table:
            start = table.read(len(SIGNATURE))
        if start not in (b"", SIGNATURE):
            raise ResultError(file, "exists and is no NetCDF file: it would be lost", "name others with -o")
        check_found(file)


def named(stem: Path, ending: str) -> Path:
    """A file of a study: what stands before the ending may hold points itself."""
    return stem.parent / (stem.name + ending)


def stopped(path: Path, stop: Any, as_json: bool, warnings: Sequence[SceneWarning]) -> None:
    """Report that a scene does not come to its end, neither as it stands nor otherwise; always raises Ended."""
    tell_of(path, stop)
    if as_json:
        print_json({"scene": str(path)} | stop_record(stop) | {"scene_warnings": warning_records(warnings)})
    raise Ended(ExitCode.STOPPED_EARLY) from None


def tell_of(path: Path, stop: StoppedEarly | None) -> None:
    """Say how a scene as it stands stopped, if it did."""
    if stop is not None:
        say(f"{path} as it stands stopped at t = {stop.time:.6g} s, {stop.part}: {stop.sentence}", "red")


def stop_record(stop: StoppedEarly | None) -> dict[str, Any]:
    """Keys of the reports in JSON: status, and where and why a scene as it stands stopped, if it did."""
    if stop is None:
        return {"status": "done"}
    where = {"time": stop.time, "part": stop.part, "sentence": stop.sentence}
    return {"status": stop.status.word, "stopped": where}


def machine(load: Sequence[float]) -> str:
    """What a run time was measured on."""
    cores = os.cpu_count() or 1
    loads = f"load {load[0]:.2f} before and {load[1]:.2f} after"
    return f"{platform.machine()}, {cores} cores of which a run takes one, {loads}"


def show(table: Table) -> None:
    """Print a table in full: on a narrow terminal its lines run on, and nothing is cut off."""
    needed = console(WIDEST).measure(table).maximum
    console(max(console().width, needed)).print(table)


def percentage(text: str, option: str) -> float:
    """A share, or a percentage; raises SceneError naming the option."""
    return number(text, option, "", MOST_TOLERANCE, "give a share such as 0.01, or 1 %")


def _grid(asked: StudyOptions) -> Grid:
    from tautline.study.accuracy.precision import Grid

    methods = words(asked.methods, "--methods", method_named)
    steps = numbers(asked.steps, "--steps", "s")
    return Grid(
        methods or None, steps or None, numbers(asked.elements, "--elements", "") or [1.0],
        words(asked.constraints, "--constraints", str),
        words(asked.newton, "--newton", one_of(NEWTON, {})),
    )  # fmt: skip


def _reference(asked: StudyOptions) -> Any:
    from tautline.study.trials.trial import Setting

    method, step = asked.reference, asked.reference_step
    if method is None and step is None:
        return None
    return Setting(
        None if method is None else words(method.replace(",", " "), "--reference", method_named)[0],
        None if step is None else number(step, "--reference-step", "s"),
    )


def _report(path: Path, stem: Path, found: Study, as_json: bool, warnings: Sequence[SceneWarning]) -> None:
    from tautline.results.output_path import make_folder
    from tautline.study.figures import work_precision
    from tautline.study.record import run_record, study_record, write_csv, write_netcdf

    records, whole = [run_record(row) for row in found.rows], study_record(found)
    show(_table(found.rows))
    if any(row.shortened for row in found.rows):
        say("* the run took shorter steps than asked for, by itself; step_taken in the tables is their mean")
    if found.reference is not None:
        say(_of_reference(found))
    if found.left_out:
        say(f"a quick look: {'; '.join(found.left_out)}")
    watched = found.watched
    places = [place for place in (watched.point_said, watched.force_said, watched.twist_said) if place]
    compared = " and ".join(filter(None, (", ".join(places[:-1]), places[-1])))
    say(f"compared: {compared}; {machine(found.load)}")
    for sentence in dict.fromkeys(_reason(row) for row in found.rows if row.trial.status in NOT_RUN):
        say(sentence)
    for warning in found.warnings:
        say(f"warning: {warning}", "yellow")
    tell_of(path, found.stop)
    proved = found.reference is not None and found.reference.converged
    say(found.advice, "green" if proved and not found.unseen else "yellow")
    files = []
    make_folder(stem.parent)
    if records:
        kept = {key: value for key, value in (whole["reference"] or {}).items() if isinstance(value, (str, int, float))}
        attributes = {"scene": str(path), "advice": whole["advice"], "point": whole["point"]}
        attributes |= {f"reference_{key}": int(v) if isinstance(v, bool) else v for key, v in kept.items()}
        files = [
            write_csv(records, named(stem, ".csv")),
            write_netcdf(records, attributes, named(stem, ".nc")),
        ]
        files.append(work_precision(found, f"{path.stem}: error against run time", named(stem, ".png")))
    for file in files:
        say(f"wrote {file}")
    if as_json:
        status = {"status": "interrupted"} if found.interrupted else stop_record(found.stop)
        ends = {"files": [str(file) for file in files], "scene_warnings": warning_records(warnings)}
        print_json({"scene": str(path)} | status | whole | ends)


def _reason(row: Row) -> str:
    """Why a setting was not run: a table has no room for it."""
    trial = row.trial
    return f"{trial.status}: {trial.setting}: {trial.sentence}"


def _of_reference(found: Study) -> str:
    reference = found.reference
    assert reference is not None
    order = "hidden by rounding" if reference.observed_order is None else f"{reference.observed_order:.2f}"
    proved = "proved" if reference.converged else "NOT proved"
    return (
        f"reference ({proved}): {reference.setting.method}, step {reference.step:.3g} s, observed order {order}, "
        f"its own error about {reference.error:.1e}"
        + (f", and of its mesh about {reference.mesh_error:.1e}" if reference.mesh_error > 0.0 else "")
    )


def _table(rows: Sequence[Row]) -> Table:
    from rich.table import Table

    from tautline.study.record import run_record

    records = [run_record(row) for row in rows]
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan")
    further = [key for key in ("step_error", "elements", "constraint", "newton") if len({r[key] for r in records}) > 1]
    heads = {"step_error": "step error", "elements": "elements x"}
    columns = ["method", "step, s", *(heads.get(key, key) for key in further)]
    kinds = ["position_error", "force_error", "twist_error", "phase_error", "rmse"]
    # Of a hose, a cable or a crane nothing twists.
    kinds = [key for key in kinds if key != "twist_error" or any(r[key] is not None for r in records)]
    heads |= {"position_error": "position", "force_error": "force", "twist_error": "twist"}
    heads |= {"phase_error": "phase, rad", "rmse": "RMSE, m"}
    columns += [heads[key] for key in kinds]
    columns += ["CPU, s", "wall, s", "spread", "real time", "steps"]
    for name in [*columns, "iterations", "status"]:
        table.add_column(name, justify="left" if name in ("method", "status", "constraint", "newton") else "right")
    for row, r in zip(rows, records, strict=True):
        # A mark tells that the run is not of the step that it stands with.
        r |= {"steps": f"{r['steps']}*"} if row.shortened else {}
        table.add_row(
            str(r["method"] or "–"), _number(r["step"], 4), *(_number(r[key]) for key in further),
            *(_number(r[key]) for key in kinds),
            *(_number(r[key]) for key in ("cpu_time", "wall_time", "wall_time_spread", "real_time_factor")),
            *(str(r[key]) if r[key] is not None else "–" for key in ("steps", "newton_iterations")), r["status"],
        )  # fmt: skip
    return table


def _number(value: Any, digits: int = 2) -> str:
    if value is None:
        return "–"
    if isinstance(value, str):
        return value
    return f"{value:.1e}" if 0.0 < abs(value) < 1e-3 else significant(float(value), digits)
