"""Whether a result can be written where it was asked for, found out before a long run instead of after it."""

from __future__ import annotations

import errno
import json
import os
import re
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shlex import quote
from uuid import uuid4

from tautline.results.errors import FULL, ResultError, WriteError
from tautline.whole_file import for_hidden, place_of

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""First bytes of every HDF5 file, which NetCDF-4 is."""
OURS = "tautline"
"""How the attribute ``format`` of our files begins."""
FIGURES = (".png", ".svg", ".pdf")
"""Endings of figures."""
PIXELS = (b"\x89PNG\r\n", b"%PDF", b"GIF8", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*", b"RIFF", b"\x1aE\xdf\xa3")
"""How files of pictures and films begin, and of PDF, but for svg and mp4."""
DRAWN = (*PIXELS, b"%!PS", b"\xc5\xd0\xd3\xc6", b"%% Creator: Matplotlib, PGF backend")
"""How files of figures begin, those of pictures and films among them, but for svg and mp4."""
ZIPPED = b"\x1f\x8b"
"""How files begin that gzip has made, such as svgz."""
LOOKED_AT = 65536
"""Bytes of a file in which its `<svg` is looked for: a licence, or a DOCTYPE with entities, may stand before it."""
SVG = re.compile(
    rb"(?is)(?>\s|<\?.*?\?>|<!--.*?-->|<!doctype\s+(?:\w+:)?svg\b[^\[>]*(?:\[.*?\]\s*)?>)*+<(?:\w+:)?svg[\s>]"
)
"""How a file of svg begins: its first element is svg, where that of a web page with a figure in it is not."""
RECORD = b"time [s]"
"""How records of sensors begin that `record` has written."""
TWIN = "twin"
"""The application that results of twins name."""
WORDS = "words.npy"
"""What stands in the archive that a twin keeps its state in."""
UNIT = "resources/unit.json"
"""What says in an FMU of ours what goes in and out."""
PAGES, DOCTYPE = (".html", ".htm"), b"<!doctype html"
"""Endings of web pages, and how they begin."""


OPEN = ("/dev/fd", "/proc")
"""Where what a process has open has names; /dev/stdout is a link to one. It may be a file on a disk all the same."""
OTHER_KINDS = frozenset(".csv .txt .json .yaml .yml .xlsx .mat .vtk .pvd .png .svg .pdf .jpg .gif .mp4 .html".split())
"""Endings of names of files that no result is."""


def check_target(path: str | Path) -> Path:
    """Check that a result may be written to a path; an earlier result there may be replaced, nothing else.

    Returns
    -------
    Path

    Raises
    ------
    ResultError
        If the folder is missing or not writable, or the path is a folder, a file that is no result, or named as a
        table, a picture, a scene or a page.
    """
    path = Path(path)
    if str(path) == "-":
        raise ResultError(
            path, "is no file, and a result is one", "name it, such as result.nc; --json prints the report"
        )
    check_folder(path)
    try:
        place = place_of(path)
        check_folder(place)
        if path.is_dir():
            raise ResultError(path, "is a folder", f"name a file in it, such as {path / 'result.nc'}")
        if path.exists():
            _check_replaceable(path)
        elif path.suffix.lower() in OTHER_KINDS:
            cure = f"name it {path.with_suffix('.nc').name}; `export --csv` writes tables, `plot` and `render` pictures"
            raise ResultError(path, "is the name of another kind of file, and a result is a NetCDF file", cure)
        probe = place.parent / f".{for_hidden(place.name)}.{uuid4().hex[:8]}.part"
        probe.touch()
        probe.unlink()
    except OSError as error:
        cure = "give another name or folder with -o"
        raise ResultError(path, f"cannot be written: {error.strerror}", cure) from None
    except ValueError as error:
        raise ResultError(path, f"cannot be written: {error}", "give another name with -o") from None
    return path


def check_record(path: Path, force: bool = False) -> Path:
    """Check that a record of sensors may be written to a path, and return it.

    Its header does not tell a record of ours from one of a machine, which nobody can make again.

    Parameters
    ----------
    force : bool
        Whether a record that is there may be replaced; what is no record is kept even so.

    Raises
    ------
    ResultError
        If the folder is missing or not writable, or the path is a folder or a file that would be lost.
    """
    if str(path) == "-":
        raise ResultError(path, "is no file, and a record is one", "name it, -o record.csv, or -o /dev/stdout")
    check_folder(path)
    try:
        if path.is_dir():
            raise ResultError(path, "is a folder", f"name a file in it: -o {path / 'record.csv'}")
        if not path.exists() and path.suffix.lower() in {*OTHER_KINDS, ".nc"} - {".csv"}:
            cure = f"name it {path.with_suffix('.csv').name}"
            raise ResultError(path, "is the name of another kind of file, and a record is a CSV file", cure)
        if path.is_file():  # a pipe, such as /dev/stdout, would wait to be read
            with path.open("rb") as file:
                start = file.read(len(RECORD))
            if start and start != RECORD:
                raise ResultError(path, "exists and is not a record: it would be lost", "name another file with -o")
            if start and not force:
                cure = "name another file with -o, or replace it with --force"
                raise ResultError(path, "exists: a record would be lost", cure)
        if not os.access(path if path.exists() else path.parent, os.W_OK):
            raise ResultError(path, "cannot be written: permission denied", "give another name or folder with -o")
    except OSError as error:
        cure = "give another name or folder with -o"
        raise ResultError(path, f"cannot be written: {error.strerror}", cure) from None
    return path


def check_found(path: Path, state: Path | None = None) -> Path:
    """Check that a twin may begin a result at a path, and return it; what took hours to find is not to be lost.

    Parameters
    ----------
    state : Path, optional
        The file that the twin was to go on from, which is not there.

    Raises
    ------
    ResultError
        Where a twin has written rows, or a simulation frames.
    """
    others = "name another file with -o, or replace it with --force"
    writer = _writer(path) if path.is_file() else ""
    if writer == TWIN and state is not None:
        cause = f"holds what a twin has found, and {state} is not there, the state that --resume would go on from"
        raise ResultError(path, f"{cause}: it would be lost", f"put the state back, {others}")
    if writer == TWIN:
        raise ResultError(path, "holds what a twin has found: it would be lost", f"go on with --resume, {others}")
    if writer:
        raise ResultError(path, "is the result of a simulation: it would be lost", others)
    return path


def check_simulated(path: Path) -> Path:
    """Check that a simulation may write its result to a path, and return it: an earlier one is replaced, no twin's.

    Raises
    ------
    ResultError
        Where a twin has written rows: what it has seen does not come again.
    """
    if path.is_file() and _writer(path) == TWIN:
        raise ResultError(path, "holds what a twin has found: it would be lost", "name another file with -o")
    return path


def _writer(path: Path) -> str:
    """The application that has written rows or frames into a file; empty for any other file."""
    import h5py

    from tautline.results.attributes import attributes_of, mark_of

    try:
        with h5py.File(path, "r") as file:
            ours = mark_of(file).startswith(OURS) and "time" in file and len(file["time"]) > 0
            return str(attributes_of(file).get("application", "")) or "unknown" if ours else ""
    except OSError:
        return ""


def check_state(path: Path) -> Path:
    """Check that a twin's state may be written to a path, and return it; an earlier one there may be replaced.

    Raises
    ------
    ResultError
        If the folder is missing, or the path is a folder or a file that is no state.
    """
    check_folder(path)
    if path.is_dir():
        raise ResultError(path, "is a folder", f"name a file in it: --state {path / 'twin.state'}")
    if path.is_file() and path.stat().st_size and not _holds_words(path):
        raise ResultError(path, "exists and is no state of a twin: it would be lost", "name another file with --state")
    return path


def _holds_words(path: Path) -> bool:
    """Whether a file is an archive with what every state of a twin has."""
    try:
        with zipfile.ZipFile(path) as archive:
            return WORDS in archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return False


def check_unit(path: Path) -> Path:
    """Check that an FMU may be written to a path, and return it; an earlier one of ours there may be replaced.

    Raises
    ------
    ResultError
        For another ending than .fmu, a folder that is not there, and a file that is no FMU of ours: it would be lost.
    """
    if path.suffix != ".fmu":
        raise ResultError(path, "is no name of an FMU", "let it end with .fmu")
    check_folder(path)
    if path.is_dir():
        raise ResultError(path, "is a folder", f"name a file in it: -o {path / 'scene.fmu'}")
    if path.exists() and not path.is_file():
        raise ResultError(path, "is not a regular file", "name another with -o")
    if path.is_file() and not os.access(path, os.W_OK):
        raise ResultError(path, "is write-protected", "name another with -o, or make it writable")
    if path.is_file() and path.stat().st_size and not _is_our_unit(path):
        raise ResultError(path, "exists and is no FMU of Tautline: it would be lost", "name another file with -o")
    return path


def _is_our_unit(path: Path) -> bool:
    """Whether a file is an archive with the description and the scene that every FMU of ours has."""
    try:
        with zipfile.ZipFile(path) as archive:
            told = json.loads(archive.read(UNIT))
            return isinstance(told, dict) and {"inputs", "outputs", "version"} <= set(told)
    except (OSError, KeyError, ValueError, RuntimeError, zipfile.BadZipFile):
        return False


def ends_as_folder(place: str | Path) -> bool:
    """Whether a name ends in a slash, as that of a folder does; a `Path` has dropped it."""
    return str(place).endswith(("/", os.sep)) and str(place) != Path(place).anchor


def names_folder(place: str | Path) -> bool:
    """Whether a place is a folder: one that is there, or by a slash at its end one that is to be made.

    So it is of every command that writes several files.
    """
    return ends_as_folder(place) or Path(place).is_dir()


def is_device(path: Path) -> bool:
    """Whether a name is of a device, a pipe, or what a process has open, as /dev/stdout: no files stand beside it."""
    place = str(Path(os.path.abspath(path)).parent)
    return place == "/dev" or place.startswith(OPEN) or (path.exists() and not (path.is_file() or path.is_dir()))


def check_made(folder: Path) -> None:
    """Raise ResultError where a folder can neither be found nor made: its parent is missing, or it is a file."""
    check_folder(folder)
    if folder.exists() and not folder.is_dir():
        raise ResultError(folder, "is a file, not a folder", "name another with -o")


@contextmanager
def made_for(folder: Path) -> Iterator[None]:
    """Make a folder, if it is not there, for the files that are written inside; not for a refusal.

    Raises
    ------
    ResultError, WriteError
        Where it cannot be made.
    """
    made = not folder.exists()
    make_folder(folder)
    try:
        yield
    except ResultError:
        if made and not any(folder.iterdir()):
            folder.rmdir()
        raise


def make_folder(folder: Path) -> None:
    """Make a folder in one that is there; nothing where it is there itself.

    Raises
    ------
    ResultError
        Where it cannot be made; WriteError where the disk is full.
    """
    check_folder(folder)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        if error.strerror in FULL:
            cure = "make room, or name another with -o"
            raise WriteError(folder, f"cannot be made: {error.strerror}", cure) from None
        if error.errno == errno.EEXIST:
            raise ResultError(folder, "is a file, not a folder", "name another with -o") from None
        # Of /proc the system says that there is no such file or directory, which is no reason that helps.
        reason = "the folder that it is to be in takes none" if error.errno == errno.ENOENT else error.strerror
        raise ResultError(folder, f"cannot be made: {reason}", "name another folder with -o") from None


def check_folder(path: Path, option: str = "-o") -> None:
    """Raise ResultError if the folder that a file would go to is not there; `option` names another file."""
    try:
        found, folder = path.parent.exists(), path.parent.is_dir()
        file = next((one for one in path.parents if one.is_file()), None)
    except (OSError, ValueError) as error:
        raise ResultError(path, f"cannot be written: {error}", f"give another name with {option}") from None
    if file is not None:
        raise ResultError(path, f"{file} is a file, not a folder", f"name another folder with {option}")
    if not found:
        raise ResultError(
            path, f"there is no folder {path.parent}", f"make it, mkdir -p {quote(str(path.parent))}, or name another"
        )
    if not folder:
        raise ResultError(path, f"{path.parent} is a file, not a folder", f"name another folder with {option}")


def check_figure(path: Path, option: str = "-o") -> Path:
    """Check that a figure may be written to a path, by its ending and its folder, and return it.

    Parameters
    ----------
    option : str
        By which another is named.

    Raises
    ------
    ResultError
        For another ending than that of a format of figures, for a folder that is not there, and for a file that is no
        figure: it would be lost.
    """
    if path.suffix.lower() not in FIGURES:
        cure = f"name it {', '.join(FIGURES[:-1])} or {FIGURES[-1]}"
        raise ResultError(path, f"ends in '{path.suffix}', which is no format of figures", cure)
    check_folder(path, option)
    return check_drawn(path, option)


def check_drawn(path: Path, option: str = "-o") -> Path:
    """Check that a figure, a picture or a film may take the place of what is at a path, and return it.

    A name may be a link to what is no figure, such as the result that is drawn.

    Parameters
    ----------
    option : str
        By which another is named.

    Raises
    ------
    ResultError
        Where a file is there that is none of these: it would be lost.
    """
    try:
        if path.is_file() and not os.path.realpath(path).startswith(("/dev/", "/proc/")):
            with path.open("rb") as file:
                start = file.read(LOOKED_AT)
            if start and not _is_drawn(start):
                what = f"is a link to {os.path.realpath(path)}, which" if path.is_symlink() else "exists and"
                raise ResultError(path, f"{what} is no figure: it would be lost", f"name another file with {option}")
    except OSError as error:
        raise ResultError(path, f"cannot be read: {error.strerror}", f"name another file with {option}") from None
    return path


def _is_drawn(start: bytes) -> bool:
    """Whether a file that begins so is a figure, a picture or a film."""
    if start.startswith(ZIPPED):
        try:
            return _is_svg(zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(start, LOOKED_AT))
        except zlib.error:
            return False
    return _is_svg(start) or start.startswith(DRAWN) or start[4:8] == b"ftyp"


def _is_svg(start: bytes) -> bool:
    return SVG.match(start.removeprefix(b"\xef\xbb\xbf")) is not None


def check_page(path: Path) -> Path:
    """Check that a web page may be written to a path, and return it; an earlier page there may be replaced.

    Raises
    ------
    ResultError
        For another ending than .html, a folder that is not there, and a file that is no page: it would be lost.
    """
    if path.suffix.lower() not in PAGES:
        raise ResultError(path, f"ends in '{path.suffix}', and is to be a web page", "name it .html")
    check_folder(path, "--html")
    try:
        if path.is_file() and path.stat().st_size and not _begins_as_page(path):
            raise ResultError(path, "exists and is not a web page: it would be lost", "name another file with --html")
    except OSError as error:
        raise ResultError(path, f"cannot be read: {error.strerror}", "name another with --html") from None
    return path


def _begins_as_page(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(DOCTYPE)).lower() == DOCTYPE


def check_table(path: Path | None, begins: str) -> Path | None:
    """The same of a table, where one was asked for; an earlier one of the same command may be replaced.

    Parameters
    ----------
    begins : str
        How the first line of such a table begins.

    Raises
    ------
    ResultError
        For another ending than .csv, for a folder that is not there, and for a file that would be lost.
    """
    if path is None:
        return None
    if path.suffix.lower() != ".csv":
        raise ResultError(path, f"ends in '{path.suffix}', and is to be a table", "name it .csv")
    check_folder(path, "--csv")
    if path.is_file():
        with path.open("rb") as file:
            start = file.read(len(begins.encode()))
        if start and start != begins.encode():
            raise ResultError(path, "exists and is another table: it would be lost", "name another file with --csv")
    return path


def _check_replaceable(path: Path) -> None:
    if not path.is_file():
        raise ResultError(path, "is not a regular file", "name another with -o")
    if not os.access(path, os.W_OK):
        raise ResultError(path, "is write-protected", "name another with -o, or make it writable")
    with path.open("rb") as file:
        start = file.read(len(SIGNATURE))
    if start and start != SIGNATURE:
        raise ResultError(path, "exists and is not a result: it would be lost", "name another file with -o")
    if start and not _is_result(path):
        cause = "is a NetCDF file, but not a Tautline result: it would be lost"
        raise ResultError(path, cause, "name another file with -o")


def _is_result(path: Path) -> bool:
    """Whether a file is a result of ours, or one that cannot be opened: damaged, or written to at this time."""
    import h5py

    from tautline.results.attributes import mark_of

    try:
        with h5py.File(path, "r") as file:
            return mark_of(file).startswith(OURS)
    except OSError:
        return True
