"""The text of a file: whether there is one, and in which encoding."""

from __future__ import annotations

import codecs
import difflib
from pathlib import Path

from tautline.scene.errors import Problem, SceneError

LARGEST_FILE = 10_000_000
RESULT = b"\x89HDF\r\n\x1a\n"
"""First bytes of a NetCDF-4 file."""

ALIKE = 0.5
"""Share of letters that two names have in common, from which one may be meant by the other."""
LEGACY = "tautline-legacy"
"""How text that is read piece by piece is decoded, as `decode` does: ``errors=LEGACY``."""


def _of_windows(error: UnicodeError) -> tuple[str, int]:
    """Bytes that are no UTF-8 as letters of Windows-1252, as instruments write them."""
    assert isinstance(error, UnicodeDecodeError)
    return error.object[error.start : error.end].decode("cp1252", errors="replace"), error.end


codecs.register_error(LEGACY, _of_windows)


def read_text(path: Path) -> str:
    """Read a text file, in UTF-8 or in whatever its byte order mark says.

    Raises
    ------
    SceneError
        If there is no such file, or it is not a text, or it is over 10 MB (it is then not read at all).
    """

    def refuse(cause: str, cure: str, line: int | None = None) -> SceneError:
        return SceneError([Problem(str(path), line, "", None, cause, cure)])

    try:
        status = path.stat()
        if path.is_dir():
            raise refuse("is a folder", "name a scene file in it")
        if not path.is_file():
            raise refuse("is not a regular file", "name a scene file, such as jwell.yaml")
        with path.open("rb") as file:
            if file.read(len(RESULT)) == RESULT:
                raise refuse("is a result, and no scene", "name the scene it was made from, or use `plot`")
        if status.st_size > LARGEST_FILE:
            size = f"{status.st_size / 1e6:.0f} MB"
            raise refuse(
                f"is {size} long, and scenes are under 10 MB", "keep long tables in a CSV file and name it here"
            )
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (FileNotFoundError, NotADirectoryError):
        raise refuse("there is no such file", _neighbour(path)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise refuse(f"cannot be read: {reason}", "check the name and its permissions") from None
    return decode(data, path)


def _neighbour(path: Path) -> str:
    try:
        names = [file.name for file in path.parent.iterdir()]
    except OSError:
        return "check the folder's name"
    alike = {name: _alike(name, path.name) for name in names}
    close = max(alike, key=lambda name: alike[name], default="")
    return f"did you mean {path.parent / close}?" if alike.get(close) else "check the name"


def _alike(name: str, other: str) -> float:
    """How far two names may be one with a slip of the pen, up to 1; 0 where only their endings are alike.

    All scenes end alike, and capitals are easily wrong.
    """
    ends = (name.casefold(), other.casefold()), (Path(name).stem.casefold(), Path(other).stem.casefold())
    pairs = [difflib.SequenceMatcher(None, *pair) for pair in ends]
    if any(one.real_quick_ratio() < ALIKE or one.quick_ratio() < ALIKE for one in pairs):
        return 0.0  # bounds of it, which are found at once: a folder may hold very many files
    whole, stem = (one.ratio() for one in pairs)
    return whole if min(whole, stem) >= ALIKE else 0.0


def decode(data: bytes, path: Path, legacy: bool = False) -> str:
    """Decode a file's bytes; `legacy`: what is not UTF-8 and has no zero byte is Windows-1252, as instruments write it.

    Raises
    ------
    SceneError
        Naming the first byte that is not text.
    """
    marks = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe\x00\x00": "utf-32", b"\x00\x00\xfe\xff": "utf-32"}
    marks |= {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
    encoding = next((name for mark, name in marks.items() if data.startswith(mark)), "utf-8")
    at, cause = None, ""
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        if legacy and encoding == "utf-8" and b"\0" not in data:
            return data.decode("cp1252", errors="replace")
        at, cause = error.start, f"byte {error.start + 1} is not {encoding.upper().removesuffix('-SIG')} text"
    else:
        if encoding == "utf-8" and b"\0" in data:
            at = data.index(b"\0")
            cause = f"byte {at + 1} is zero, as in a binary file"
    if at is None:
        return text
    line = data[:at].count(b"\n") + 1
    cure = "this is a binary file, or one in another encoding: save it as UTF-8 text"
    raise SceneError([Problem(str(path), line, "", None, cause, cure)])
