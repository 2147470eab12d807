"""What a scene can be read from: a file, a YAML text, or a dict."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tautline.arguments import PATH, check
from tautline.errors import ArgumentTypeError
from tautline.scene.errors import SceneError
from tautline.scene.reading.document import Document, plain
from tautline.scene.reading.scalars import written_out

NAME = Path("scene")
"""Names a text or a dict in messages, before the line."""


def document_of(source: Any, folder: str | Path | None = None) -> Document:
    """The document of a path, a YAML text or a dict.

    Parameters
    ----------
    source : path, str or mapping
        A str is a text if it has more than one line, or reads as a mapping of keys to values; else it is a path. A
        mapping becomes a text, by the lines of which messages name its faults.
    folder : path or None
        What the files that a text or a dict names are relative to; None for the current folder. Those of a file are
        relative to its own.

    Raises
    ------
    SceneError
        If there is no such file, if it is no text or too large, or if it is not YAML.
    ArgumentTypeError
        For anything else, and for a folder beside a file.
    """
    check(folder=(folder, PATH))
    home = Path() if folder is None else Path(folder)
    if isinstance(source, Mapping):
        return Document.parse(written_out(plain(dict(source), origin=str(NAME))), NAME, home)
    if isinstance(source, str) and is_text(source):
        return Document.parse(source, NAME, home)
    if isinstance(source, str) and not source.strip():
        raise ArgumentTypeError("a scene, the path of its file, its text or a dict is wanted, not an empty text")
    if not isinstance(source, (str, os.PathLike)):
        raise ArgumentTypeError(
            f"a scene, the path of its file, its text or a dict is wanted, not {type(source).__name__}"
        )
    if folder is not None:
        raise ArgumentTypeError("files that a scene's file names are relative to its own folder: leave `folder` out")
    return Document.read(Path(source))


def is_text(source: str) -> bool:
    """Whether a str is a scene itself, and not the name of its file."""
    if "\n" in source or source.lstrip().startswith("{"):
        return True
    try:
        Document.parse(source)
    except SceneError:
        return False
    return True
