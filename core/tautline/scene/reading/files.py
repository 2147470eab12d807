"""Files that a scene names: which fields name them, and whether one was written again since it was read."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

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
        for name, is_file in _worth_a_look(type(value)):
            held = getattr(value, name)
            if held is not None and is_file:
                yield held
            else:
                yield from files_of(held)
    elif isinstance(value, (tuple, list)):
        for each in value:
            yield from files_of(each)


@functools.cache
def _worth_a_look(model: type[BaseModel]) -> tuple[tuple[str, bool], ...]:
    """Fields of a class of models that may hold the name of a file: name, and whether it is one itself.

    Asked once for a class: a well may have a hundred thousand sections, all of them of numbers.
    """
    fields = model.model_fields.items()
    return tuple(
        (name, names_file(field)) for name, field in fields if names_file(field) or not _is_plain(field.annotation)
    )


def _is_plain(kind: Any) -> bool:
    """Whether a type has nothing but numbers, words and None."""
    parts = getattr(kind, "__args__", ())
    if getattr(kind, "__origin__", None) is Literal:
        return True
    return all(map(_is_plain, parts)) if parts else kind in (float, int, bool, str, type(None), None)


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
