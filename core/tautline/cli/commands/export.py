"""The verb ``export``."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tautline.application.installed import Catalogue
from tautline.cli.output.console import console, print_json, say, say_missing
from tautline.cli.output.holes import told_of_holes

if TYPE_CHECKING:
    from tautline.results.result import Result
    from tautline.view.space.appearance import Look

Progress = Callable[[int, int], None]
MANY = 5000
"""Files for ParaView from which on their number is told before they are written."""
ENDINGS = (".pvd", ".csv")


def export(
    catalogue: Catalogue,
    path: Path,
    output: Path | str | None,
    vtk: bool,
    csv: bool,
    what: Sequence[str],
    look: Look,
    as_json: bool,
    every: int = 1,
) -> None:
    """Write a result for other programs: ParaView, spreadsheets. The result itself stays as it is.

    Parameters
    ----------
    output : Path, str or None
        A folder, or the beginning of the names of files, with or without ``.pvd`` or ``.csv``; by default the result's
        name in the current folder. A text that ends in a slash is a folder, which is made where its parent is there.
        The ending of another kind of file is refused.
    vtk, csv : bool
        A ``.pvd`` with its frames, tables; one of them at least.
    what : sequence of str
        Variables that go into tables; empty for all.
    look : Look
        Of what ParaView shows.
    every : int
        Of so many frames ParaView gets one, and the last.

    Raises
    ------
    ResultError
        If nothing is asked for, or options contradict each other; if the result cannot be read, a variable is unknown,
        or a file cannot be written.
    """
    from tautline.results.output_path import made_for, names_folder
    from tautline.results.result import Result
    from tautline.results.tables.pieces import pieces_said

    _check(vtk, csv, output, what, look, every)
    result = Result.read(path)
    base = _base(path, output)
    files: list[Path] = []
    larger = ""
    with made_for(base.parent) if output is not None and names_folder(output) else nullcontext():
        if csv:
            from tautline.results.tables.table import write_csv

            with told_of_holes([result]), _counted("tables") as progress:
                files += write_csv(result, base.with_name(f"{base.name}.csv"), tuple(what), progress)
        if vtk:
            with told_of_holes([result]):
                made, larger = _write_vtk(catalogue, result, base, look, every)
            files += made
    warnings = say_missing(result)
    if said := pieces_said(result):
        say(f"{result.path}: {said}", "yellow")
        warnings.append({"where": str(result.path), "text": said})
    _say_files(files, larger)
    if as_json:
        print_json({"status": "done", "files": [str(file) for file in files], "warnings": warnings})


def _write_vtk(catalogue: Catalogue, result: Result, base: Path, look: Look, every: int) -> tuple[list[Path], str]:
    """Write ParaView's files; gives them, and what is larger in them than it is."""
    from tautline.application.space import appearance_of
    from tautline.results.errors import ResultError

    application = catalogue.for_result(result)
    if getattr(application, "appearance", None) is None:
        cause = f"results of {application.name} have no appearance in space"
        raise ResultError("--vtk", cause, "leave it out, and take --csv")
    # Places and radii in a file are measured there: true, unless a factor was asked for.
    look = look if look.exaggerate is not None else replace(look, exaggerate=1.0)
    seen = appearance_of(application, result, look)
    seen = seen if every == 1 else seen.thinned(every)
    try:
        from tautline.view.files.paraview import write_paraview
        from tautline.view.files.parts import parts_of

        moving = [part.moves for part in parts_of(seen)]
        count = _most_files(moving, len(seen.time))
        if count > MANY:
            fewer = -(-count // MANY)
            left = _most_files(moving, len(seen.thinned(fewer).time))
            say(f"up to {count} files will be written. --every {every * fewer} writes {left} at most", "yellow")
        with _counted("frames") as progress:
            files = write_paraview(seen, result, base.with_name(f"{base.name}.pvd"), progress)
        return files, "; ".join(f"{text} {factor:.6g} times as large" for text, factor in seen.enlarged)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("vtk", "vtkmodules"):
            raise
        raise ResultError("--vtk", "needs VTK, which is not installed", "pip install pyvista") from None


def _most_files(moving: Sequence[bool], frames: int) -> int:
    """Files of parts, by whether each may move: those that do have one a frame."""
    return sum(frames if moves else 1 for moves in moving)


def _check(vtk: bool, csv: bool, output: Path | str | None, what: Sequence[str], look: Look, every: int) -> None:
    """Refuse options that leave nothing to do, or that nothing asked for heeds."""
    from tautline.results.errors import ResultError
    from tautline.results.output_path import OTHER_KINDS, names_folder

    if str(output) == "-":
        raise ResultError(
            "-o", "- is no name of files, and they do not go to standard output", "name a file or a folder"
        )

    if not (vtk or csv):
        cause = "nothing is asked for"
        raise ResultError("export", cause, "give --vtk (a .pvd that ParaView opens), --csv (tables), or both")
    if what and not csv:
        cause = "chooses variables of tables, and none are asked for"
        raise ResultError("--what", cause, "add --csv, or leave it out: every quantity is in ParaView's files")
    for option, given in (("--view", look.view), ("--exaggerate", look.exaggerate), ("--every", every != 1)):
        if given and not vtk:
            raise ResultError(option, "changes what ParaView shows, and tables stay as they are", "add --vtk")
    if output is None or names_folder(output):
        return
    output = Path(output)
    ending = output.suffix.lower()
    if ending == ".nc" or (ending in OTHER_KINDS and ending not in ENDINGS):
        cure = f"name it {output.with_suffix('.csv' if csv else '.pvd').name}, or without an ending"
        raise ResultError(output, f"ends in {ending}, the name of another kind of file", cure)
    if (ending == ".pvd" and not vtk) or (ending == ".csv" and not csv):
        other = "--vtk" if ending == ".pvd" else "--csv"
        raise ResultError(output, f"ends in {ending}, but {other} is not given", f"add {other}, or give another name")


def _base(path: Path, output: Path | str | None) -> Path:
    """Folder and beginning of the names of files."""
    from tautline.results.output_path import names_folder

    if output is None:
        return Path(path.stem)
    if names_folder(output):
        return Path(output) / path.stem
    output = Path(output)
    return output.with_suffix("") if output.suffix.lower() in ENDINGS else output


@contextmanager
def _counted(what: str) -> Iterator[Progress | None]:
    """A bar of progress on a terminal, None elsewhere."""
    if not console().is_terminal:
        yield None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (MofNCompleteColumn(), TextColumn(what), BarColumn(bar_width=40), TimeRemainingColumn(compact=True))
    with Progress(*columns, console=console(), transient=True) as bar:
        task = bar.add_task("", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _say_files(files: list[Path], larger: str) -> None:
    for file in files:
        if file.suffix == ".vtp":
            continue
        frames = [one for one in files if one.suffix == ".vtp"] if file.suffix == ".pvd" else []
        more = f" and {len(frames)} files in {frames[0].parent}; open it in ParaView" if frames else ""
        more += f". In it: {larger}" if frames and larger else ""
        say(f"wrote {file}{more}", "green")
