"""The verb ``plot``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tautline.application.installed import Catalogue
from tautline.application.twins import drawer
from tautline.cli.output.console import print_json, say, say_missing
from tautline.cli.output.holes import told_of_holes

FORMATS = ("png", "svg", "pdf")
PICTURES = ("jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "eps", "ps")
"""Endings that nobody gives to a folder."""


def plot(
    catalogue: Catalogue,
    paths: Sequence[Path],
    output: Path | str | None,
    what: Sequence[str],
    vs: str | None,
    form: str | None,
    as_json: bool,
) -> None:
    """Draw figures of one or more results.

    Parameters
    ----------
    output : Path, str or None
        A file if it ends in a known format, else a folder, which is made; by default the current folder. A text that
        ends in a slash is a folder, too.
    what : sequence of str
        Names of figures or of variables; empty for the application's default figures.
    vs : str or None
        Variable to draw the others against, in place of time.
    form : str or None
        ``png``, ``svg`` or ``pdf``; by default what the output's name ends in, or ``png``.

    Raises
    ------
    ResultError
        If a result cannot be read, they are of several applications, a figure is unknown or a file cannot be written.
    """
    from tautline.results.errors import ResultError
    from tautline.results.output_path import check_drawn
    from tautline.results.result import Result
    from tautline.statistics.store import check_whole
    from tautline.view.figures.comparison import listed

    results = [Result.read(path) for path in paths]
    for result in results:
        check_whole(result, "plot")
    application = drawer(results[0], catalogue.for_result)
    if form is not None and form not in FORMATS:
        raise ResultError(output or "--format", f"unknown format '{form}'", f"known: {', '.join(FORMATS)}")
    folder, stem, ending = _place(output)
    output = None if output is None else Path(output)
    if ending and form and ending.lower() != form:
        raise ResultError(output or "", f"ends in .{ending}, but --format says {form}", "leave one of them out")
    if ending and output is not None:
        check_drawn(output)
    made = _make(folder)
    against = {} if vs is None else {"vs": vs}
    try:
        with told_of_holes(results):
            written = application.figures(results, folder, tuple(what), (ending or form or "png",), stem, **against)
        if not written:
            held = listed([name for name in results[0].variables if name != "time"])
            raise ResultError(paths[0], "holds nothing that the usual figures show", f"name with --what: {held}")
    except ResultError as error:
        if made:
            # It was not there before: the figures in it are half of what was asked for.
            error.written.clear()
            for file in folder.iterdir():
                if file.suffix[1:].lower() in FORMATS:
                    file.unlink()
            if not any(folder.iterdir()):
                folder.rmdir()
        raise
    warnings = [warning for result in results for warning in say_missing(result)]
    for file in written:
        say(f"wrote {file}", "green")
    if as_json:
        print_json({"status": "done", "figures": [str(file) for file in written], "warnings": warnings})


def _make(folder: Path) -> bool:
    """Make a folder, and tell whether there was none; raises ResultError where it cannot be made."""
    from tautline.results.output_path import make_folder

    made = not folder.exists()
    make_folder(folder)
    return made


def _place(output: Path | str | None) -> tuple[Path, str | None, str | None]:
    """Folder, beginning of the file name and its ending, as it is written, that ``-o`` asks for."""
    from tautline.results.errors import ResultError
    from tautline.results.output_path import names_folder

    if output is None:
        return Path(), None, None
    if names_folder(output):
        return Path(output), None, None
    output = Path(output)
    ending = output.suffix[1:].lower()
    if ending in FORMATS:
        return output.parent, output.stem, output.suffix[1:]
    if ending in PICTURES:
        raise ResultError(output, f"ends in .{ending}, which is no format of figures", "name it .png, .svg or .pdf")
    if output.is_file():
        cause, cure = "is a file that is there, and no figure", "name a folder, or a figure that ends in"
        raise ResultError(output, cause, f"{cure} {', '.join(f'.{one}' for one in FORMATS)}")
    return output, None, None
