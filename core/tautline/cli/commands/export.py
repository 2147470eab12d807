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
    from tautline.view.space.appearance import Appearance, Look

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
    from tautline.results.errors import naming_written
    from tautline.results.output_path import made_for
    from tautline.results.result import Result
    from tautline.results.tables.pieces import pieces_said

    _check(vtk, csv, output, what, look, every)
    result = Result.read(path)
    catalogue.refuse_foreign(result)
    base = _base(path, output)
    files: list[Path] = []
    # All that may be refused is looked at before the first file is written.
    seen = _seen(catalogue, result, look, every) if vtk else None
    made = made_for(base.parent) if output is not None and _is_folder(output) else nullcontext()
    with made, naming_written("files", files):
        if seen is not None:
            from tautline.view.files.paraview import check_target

            check_target(_named(base, output, ".pvd"), seen)
        if csv:
            from tautline.results.tables.table import write_csv

            with told_of_holes([result]), _counted("tables") as progress:
                files += write_csv(result, _named(base, output, ".csv"), tuple(what), progress)
        if seen is not None:
            with told_of_holes([result]):
                files += _write_vtk(seen, result, _named(base, output, ".pvd"), every)
    warnings = say_missing(result)
    if said := pieces_said(result):
        say(f"{result.path}: {said}", "yellow")
        warnings.append({"where": str(result.path), "text": said})
    _say_files(files, "" if seen is None else _larger(seen))
    if as_json:
        print_json({"status": "done", "files": [str(file) for file in files], "warnings": warnings})


def _seen(catalogue: Catalogue, result: Result, look: Look, every: int) -> Appearance:
    """What ParaView is to show; raises ResultError where there is nothing, or nothing to write it with."""
    from tautline.application.space import appearance_of
    from tautline.results.errors import ResultError

    application = catalogue.for_result(result)
    if getattr(application, "appearance", None) is None:
        cause = f"results of {application.name} have no appearance in space"
        raise ResultError("--vtk", cause, "leave it out, and take --csv")
    # Places and radii in a file are measured there: true, unless a factor was asked for.
    look = look if look.exaggerate is not None else replace(look, exaggerate=1.0)
    with told_of_holes([result]):
        seen = appearance_of(application, result, look)
    try:
        import tautline.view.files.parts  # noqa: F401 - it needs VTK
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("vtk", "vtkmodules"):
            raise
        raise ResultError("--vtk", "needs VTK, which is not installed", "pip install pyvista") from None
    return seen if every == 1 else seen.thinned(every)


def _write_vtk(seen: Appearance, result: Result, path: Path, every: int) -> list[Path]:
    """Write ParaView's files."""
    from tautline.view.files.paraview import write_paraview
    from tautline.view.files.parts import parts_of

    moving = [part.moves for part in parts_of(seen)]
    count = _most_files(moving, len(seen.time))
    if count > MANY:
        fewer = -(-count // MANY)
        left = _most_files(moving, len(seen.thinned(fewer).time))
        say(f"up to {count} files will be written. --every {every * fewer} writes {left} at most", "yellow")
    with _counted("frames") as progress:
        return write_paraview(seen, result, path, progress)


def _larger(seen: Appearance) -> str:
    """What is larger in ParaView's files than it is."""
    return "; ".join(f"{text} {factor:.6g} times as large" for text, factor in seen.enlarged)


def _most_files(moving: Sequence[bool], frames: int) -> int:
    """Files of parts, by whether each may move: those that do have one a frame."""
    return sum(frames if moves else 1 for moves in moving)


def _check(vtk: bool, csv: bool, output: Path | str | None, what: Sequence[str], look: Look, every: int) -> None:
    """Refuse options that leave nothing to do, or that nothing asked for heeds."""
    from tautline.results.errors import ResultError
    from tautline.results.output_path import OTHER_KINDS, is_device

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
    if output is None or _is_folder(output):
        return
    output = Path(output)
    if is_device(output):
        raise ResultError(output, "is no name of files, and several are written", "name a file or a folder")
    ending = output.suffix.lower()
    if ending == ".nc" or (ending in OTHER_KINDS and ending not in ENDINGS):
        cure = f"name it {output.with_suffix('.csv' if csv else '.pvd').name}, or without an ending"
        raise ResultError(output, f"ends in {ending}, the name of another kind of file", cure)
    if (ending == ".pvd" and not vtk) or (ending == ".csv" and not csv):
        other = "--vtk" if ending == ".pvd" else "--csv"
        raise ResultError(output, f"ends in {ending}, but {other} is not given", f"add {other}, or give another name")


def _is_folder(output: Path | str) -> bool:
    """Whether files go into a folder of that name: not into that of the frames of an earlier export of this name."""
    from tautline.results.output_path import ends_as_folder, names_folder

    if not names_folder(output):
        return False
    if ends_as_folder(output):
        return True
    from tautline.view.files.paraview import holds_frames

    return not holds_frames(Path(output))


def _base(path: Path, output: Path | str | None) -> Path:
    """Folder and beginning of the names of files."""
    if output is None:
        return Path(path.stem)
    if _is_folder(output):
        return Path(output) / path.stem
    output = Path(output)
    return output.with_suffix("") if output.suffix.lower() in ENDINGS else output


def _named(base: Path, output: Path | str | None, ending: str) -> Path:
    """The file of an ending: the one that was named, as it is written, where it has this ending."""
    given = None if output is None else Path(output)
    if given is not None and given.suffix.lower() == ending and given.with_suffix("") == base:
        return given
    return base.with_name(base.name + ending)


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
        frames = [one for one in files if one.suffix == ".vtp"] if file.suffix.lower() == ".pvd" else []
        more = f" and {len(frames)} files in {frames[0].parent}; open it in ParaView" if frames else ""
        more += f". In it: {larger}" if frames and larger else ""
        say(f"wrote {file}{more}", "green")
