"""Files that a scene names: which fields name them, and whether one was written again since it was read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo


class NamesFile:
    """Marks a field that holds the name of a file, relative to the scene's folder."""


FileName = Annotated[str, NamesFile()]
"""The type of such a field. What is derived from the fields of a scene (`model_hash`, preparation) finds it by this."""


def names_file(field: FieldInfo) -> bool:
    """Whether a field of a model holds the name of a file."""
    marks = [*field.metadata]
    for kind in getattr(field.annotation, "__args__", ()):  # FileName | None
        marks += getattr(kind, "__metadata__", ())
    return any(isinstance(mark, NamesFile) for mark in marks)


def files_of(value: Any) -> Iterator[str]:
    """Names of all files in a model and in what it holds."""
    if isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            held = getattr(value, name)
            if held is not None and names_file(field):
                yield held
            else:
                yield from files_of(held)
    elif isinstance(value, (tuple, list)):
        for each in value:
            yield from files_of(each)


def stamps(value: Any, folder: Path) -> tuple[tuple[str, int, int], ...]:
    """Time of the last change, ns, and size of each file in a model; -1 for a file that is not there."""
    found = []
    for name in files_of(value):
        try:
            status = (folder / name).stat()
            found.append((str(folder / name), status.st_mtime_ns, status.st_size))
        except OSError:
            found.append((str(folder / name), -1, -1))
    return tuple(found)
