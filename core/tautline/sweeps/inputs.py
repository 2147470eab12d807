"""Files that the scenes of a sweep name, as they were when it began: each case reads them again, wherever it runs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from tautline.scene.errors import SceneError, option_error
from tautline.scene.reading.files import files_of

Stamp = tuple[int, int]
"""Time of the last change, ns, and size of a file: as long as they stay, it is taken for the same."""
NO_FILE = "no file"


class InputChanged(SceneError):
    """A file that a sweep reads and that is not what it was when the sweep began."""


def hashes_of(scenes: Iterable[Any]) -> dict[str, str]:
    """Path -> hash of the contents of each file that scenes name."""
    return {path: hash_of(path) for path in sorted({path for scene in scenes for path in _paths_of(scene)})}


def stamps_of(paths: Iterable[str]) -> dict[str, Stamp]:
    """Path -> stamp, of files that may be lacking."""
    return {path: _stamp(path) for path in paths}


class Inputs:
    """The files of a sweep, as one process sees them.

    Parameters
    ----------
    hashes : mapping
        Path -> hash of its contents when the sweep began.
    """

    def __init__(self, hashes: Mapping[str, str]) -> None:
        self.hashes = hashes
        self._seen: dict[str, Stamp] = {}

    def of_case(self, scene: Any, changes: Mapping[str, Any]) -> list[str]:
        """Paths of the files that a case reads: those of the scene, and those that its values name."""
        if not self.hashes:
            return []
        folder = _folder_of(scene)
        named = (str(folder / text) for text in _texts(list(changes.values())))
        return sorted({*_paths_of(scene), *named} & self.hashes.keys())

    def check(self, stamps: Mapping[str, Stamp]) -> None:
        """Compare files by their stamps, and by their contents where a stamp is new.

        Raises
        ------
        InputChanged
            Naming the first file that is not what it was.
        """
        for path, stamp in stamps.items():
            if self._seen.get(path) == stamp:
                continue
            found = hash_of(path)
            if found != self.hashes[path]:
                cause = "is not the file that it was when the sweep began"
                raise InputChanged(
                    option_error(path, "", "is not there any more" if found == NO_FILE else cause).problems
                )
            self._seen[path] = stamp


def _folder_of(scene: Any) -> Path:
    return Path(getattr(scene, "folder", None) or ".").resolve()


def _paths_of(scene: Any) -> list[str]:
    folder = _folder_of(scene)
    return [str(folder / name) for name in files_of(scene)]


def _texts(value: Any) -> Iterator[str]:
    """All texts in a value as it stands in a scene."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list, tuple)):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)


def _stamp(path: str) -> Stamp:
    try:
        status = Path(path).stat()
    except OSError:
        return -1, -1
    return status.st_mtime_ns, status.st_size


def hash_of(path: str) -> str:
    """Hash of the contents of a file, `NO_FILE` where there is none that can be read."""
    try:
        return sha256(Path(path).read_bytes()).hexdigest() if Path(path).is_file() else NO_FILE
    except OSError:
        return NO_FILE
