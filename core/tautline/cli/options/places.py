"""Places that files are written to, as they are typed: a `Path` drops the slash by which a name is that of a folder."""

from __future__ import annotations

from pathlib import Path


def file_named(text: str) -> Path:
    """The path of a file, of a command that writes one.

    Raises
    ------
    ResultError
        If the name ends in a slash.
    """
    from tautline.results.errors import ResultError
    from tautline.results.output_path import ends_as_folder

    if ends_as_folder(text):
        cause = "is a folder by the slash at its end, and a file is written"
        raise ResultError(text, cause, "name a file in it, or leave out the slash")
    return Path(text)
