"""Files for ParaView: one ``.pvd`` that names the times and the parts, and a folder of ``.vtp`` files beside it.

Opened in ParaView, the ``.pvd`` is one source with one time line. Each part, such as the rope, the sheaves or the sea,
is a block of it with its own name: it is shown, hidden, coloured and extracted by that name, and one source serves all.
What differs by a number only, as sheave 1 and sheave 2 do, is one part. A part that has not moved is not written
again: times share its file. Words at places (`tautline.view.space.appearance.Label`) are left out: a data set has none.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np

from tautline.results.errors import ResultError, WriteError
from tautline.results.output_path import check_folder
from tautline.results.result import Result
from tautline.view.space.appearance import Appearance
from tautline.whole_file import for_hidden, legible

if TYPE_CHECKING:
    from tautline.view.files.parts import Part

Progress = Callable[[int, int], None]
"""Called with the number of frames that are done, and of all."""
DIGITS = 4
"""Of a frame's number in a file's name, at least."""
CURE = "name another file with -o, or make room"


def write_paraview(
    appearance: Appearance, result: Result, path: str | Path, progress: Progress | None = None
) -> list[Path]:
    """Write what a result looks like for ParaView.

    Lines are polylines, one cell each, with point data: every quantity, ``radius [m]`` where it is known, ``node`` (its
    number in the line, from 1; -1 between nodes) and ``line`` (the number of its line in the part). Solids are
    triangles where they are at each frame, with cell data ``solid`` and ``colour``. Arrows are points with a vector,
    where they act. Units are SI and stand in the names of arrays. Numbers of the result that are one at each time, such
    as ``hook_load [N]``, are field data of the first lines; so are ``title`` and ``notes``.

    Parameters
    ----------
    appearance : Appearance
        Of the result.
    result : Result
        What is read only.
    path : str or Path
        The ``.pvd``; the ending is added where it lacks. An earlier one is replaced, and the files that it names.
    progress : callable, optional

    Returns
    -------
    list of Path
        The ``.pvd``, and the ``.vtp`` files.

    Raises
    ------
    ResultError
        If something else would be lost, or the folder is missing.
    WriteError
        If writing fails. Nothing is left of it then, and an earlier export stays whole; but for one that fails while
        files take their names, after which the same export may be given again.
    """
    path = Path(path)
    path = path if path.suffix.lower() == ".pvd" else path.with_name(path.name + ".pvd")
    folder = path.with_name(path.stem)
    check_target(path, appearance)
    waiting = path.with_name(f".{for_hidden(path.stem)}.{uuid4().hex[:8]}.part")
    listed, both = (path.with_name(f"{waiting.name}.{ending}") for ending in ("pvd", "both"))
    try:
        waiting.mkdir()
    except OSError as error:
        raise ResultError(path, f"cannot be written: {error.strerror}", "name another file or folder with -o") from None
    try:
        try:
            files = _write_frames(appearance, result, waiting, progress)
            listed.write_text(_collection(appearance.time, files, folder.name), encoding="utf8")
            # All is on the disk: from here on files only take their names, the collection last.
            _replace(waiting, folder, path, both)
            os.replace(listed, path)
        finally:
            shutil.rmtree(waiting, ignore_errors=True)
            listed.unlink(missing_ok=True)
            both.unlink(missing_ok=True)
    except OSError as error:
        raise WriteError(path, f"cannot be written: {error.strerror or error}", CURE) from None
    named = dict.fromkeys(name for _, names in files for name in names)
    return [path, *(folder / name for name in named)]


def check_target(path: Path, appearance: Appearance) -> None:
    """Raise ResultError where a ``.pvd`` and its folder cannot be at a path, or something else would be lost."""
    folder = path.with_name(path.stem)
    check_folder(path)
    if legible(folder.name) != folder.name:
        raise ResultError(path, "the XML in it cannot hold a name that is not UTF-8", "name another file with -o")
    if path.is_dir():
        raise ResultError(path, "is a folder", "name a file with -o")
    if path.exists() and _files_of(path) is None:
        raise ResultError(path, "exists and is no collection of ParaView's: it would be lost", "name another with -o")
    if folder.exists() and not folder.is_dir():
        raise ResultError(folder, "is a file, and the frames go into a folder of that name", "name another with -o")
    _check_frames(path, folder, appearance)


def _check_frames(path: Path, folder: Path, appearance: Appearance) -> None:
    """Raise ResultError where a frame would take the place of a file that is none of this ``.pvd``'s own."""
    try:
        there = set(os.listdir(folder)) if folder.is_dir() else set()
    except OSError as error:
        raise ResultError(folder, f"cannot be read: {error.strerror}", "name another with -o") from None
    if not there:
        return
    from tautline.view.files.parts import parts_of

    parts, frames = parts_of(appearance), len(appearance.time)
    wanted = [
        name
        for part, stem in zip(parts, _stems(parts), strict=True)
        for name in dict.fromkeys(_file_of(part, stem, frame, frames) for frame in range(frames))
    ]
    others = [one for one in _collections_of(folder) if not (path.exists() and one.samefile(path))]
    own = _frames_of(path, folder).difference(*(_frames_of(one, folder) for one in others))
    lost = next((name for name in wanted if name in there and name not in own), None)
    if lost is None:
        return
    owner = next((f" of {one.name}" for one in others if lost in _frames_of(one, folder)), "")
    cause = f"exists and is {'a frame' if owner else 'no frame'}{owner or f' of {path.name}'}: it would be lost"
    raise ResultError(folder / lost, cause, f"name another with -o, or move {folder.name} away")


def _write_frames(
    appearance: Appearance, result: Result, folder: Path, progress: Progress | None
) -> list[tuple[str, list[str]]]:
    """Write all parts; returns of each its name, and the name of its file at every frame."""
    from tautline.view.files.parts import add_array, add_texts, labelled, parts_of

    parts, frames = parts_of(appearance), len(appearance.time)
    stems = _stems(parts)
    # What is one number at each time goes with a part that has a file for every frame.
    host = next((part for part in parts if part.moves and part.state is None), None)
    scalars = {labelled(v.name, v.units): result[v.name] for v in result.variables.values() if v.dims == ("time",)}
    source = np.arange(frames) if appearance.source is None else appearance.source
    files: list[list[str]] = [[] for _ in parts]
    before: list[bytes | None] = [None] * len(parts)
    with _quiet_writer() as write:
        for frame in range(frames):
            for i, (part, stem) in enumerate(zip(parts, stems, strict=True)):
                state = b"" if not part.moves else part.state(frame) if part.state is not None else None
                if frame > 0 and state is not None and state == before[i]:
                    files[i].append(files[i][-1])
                    continue
                before[i] = state
                data = part.data(frame)
                if part is host or (host is None and frames == 1 and i == 0):
                    for name, values in scalars.items():
                        add_array(data.GetFieldData(), name, np.array([values[source[frame]]], dtype=float))
                if frame == 0 and (part is host or (host is None and i == 0)):
                    add_texts(data, "title", [appearance.title])
                    add_texts(data, "notes", [*appearance.remarks, *([appearance.axes] if appearance.axes else [])])
                files[i].append(_file_of(part, stem, frame, frames))
                write(data, folder / files[i][-1])
            if progress is not None:
                progress(frame + 1, frames)
    return [(part.name, names) for part, names in zip(parts, files, strict=True)]


@contextmanager
def _quiet_writer() -> Iterator[Callable[[Any, Path], None]]:
    """A function that writes a vtkPolyData, compressed, and raises OSError where VTK would only print."""
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkCommonMisc import vtkErrorCode
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()

    def write(data: Any, path: Path) -> None:
        writer.SetInputData(data)
        writer.SetFileName(str(path))
        if not writer.Write() or writer.GetErrorCode():
            reason = vtkErrorCode.GetStringFromErrorCode(writer.GetErrorCode()) or "the disk may be full"
            raise OSError(0, f"{path.name}: {reason}")

    before = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        yield write
    finally:
        vtkObject.SetGlobalWarningDisplay(before)


def _stems(parts: list[Part]) -> list[str]:
    """Beginnings of file names, one for each part, of plain letters."""
    found: list[str] = []
    for part in parts:
        plain = re.sub(r"[^A-Za-z0-9]+", "_", part.name).strip("_").lower() or "part"
        stem, number = plain, 2
        while stem in found:
            stem, number = f"{plain}_{number}", number + 1
        found.append(stem)
    return found


def _file_of(part: Part, stem: str, frame: int, frames: int) -> str:
    """Name of the file that a part has at a frame, if it is written there."""
    digits = max(DIGITS, len(str(frames - 1)))
    return f"{stem}_{frame:0{digits}d}.vtp" if part.moves else f"{stem}.vtp"


def _collection(time: np.ndarray, files: list[tuple[str, list[str]]], folder: str) -> str:
    """Text of the ``.pvd``; ParaView names blocks by ``name``."""
    rows = [
        f'    <DataSet timestep="{float(t)!r}" part="{i}" name={quoteattr(name)} '
        f"file={quoteattr(f'{folder}/{names[frame]}')}/>"
        for frame, t in enumerate(time)
        for i, (name, names) in enumerate(files)
    ]
    head = '<?xml version="1.0" encoding="UTF-8"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
    return head + "\n".join(rows) + "\n  </Collection>\n</VTKFile>\n"


def _files_of(path: Path) -> set[str] | None:
    """Files that a ``.pvd`` names; None if it is none."""
    try:
        root = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError, UnicodeDecodeError):
        return None
    if root.tag != "VTKFile" or root.get("type") != "Collection":
        return None
    return {one.get("file", "") for one in root.iter("DataSet")}


def holds_frames(folder: Path) -> bool:
    """Whether a folder is that of the frames of the ``.pvd`` of its name beside it."""
    return any(_frames_of(path, folder) for path in _collections_of(folder))


def _collections_of(folder: Path) -> list[Path]:
    """Files beside a folder that have its name and end in ``.pvd``, in letters of either case."""
    try:
        names = sorted(os.listdir(folder.parent))
    except OSError:
        return []
    paths = [folder.with_name(name) for name in names if name.lower().endswith(".pvd")]
    return [path for path in paths if path.stem == folder.name]


def _frames_of(path: Path, folder: Path) -> set[str]:
    """Names of the files in a folder beside a ``.pvd`` that it names; none if it is none."""
    files = [Path(file) for file in _files_of(path) or ()]
    return {file.name for file in files if file.parent == Path(folder.name)}


def _replace(waiting: Path, folder: Path, path: Path, both: Path) -> None:
    """Put new frames in the place of those that an earlier ``.pvd`` names; other files in the folder stay.

    Meanwhile the ``.pvd`` names old frames and new ones: whatever ends this, they are known as its own.
    """
    old = {name for name in _frames_of(path, folder) if name.endswith(".vtp")}
    named = sorted(old.union(file.name for file in waiting.iterdir()))
    both.write_text(_collection(np.zeros(1), [(name, [name]) for name in named], folder.name), encoding="utf8")
    os.replace(both, path)
    if not folder.exists():
        os.replace(waiting, folder)
        return
    for name in old:
        (folder / name).unlink(missing_ok=True)
    for file in sorted(waiting.iterdir()):
        os.replace(file, folder / file.name)
