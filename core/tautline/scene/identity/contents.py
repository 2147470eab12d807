"""What a scene is: a hash of all that it says of the model, whatever else it says of how that is solved and shown.

It is derived from the fields of the scene. What does not count is named, so that a field which is added later counts.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from tautline.scene.reading.files import files_of, names_file

SOLVED_BY = (
    "method", "rho_inf", "alpha_m", "alpha_f", "step", "end", "control", "step_error", "tolerance", "frequency",
    "max_iterations", "max_halvings", "newton", "criterion", "accuracy",
)  # fmt: skip
"""Keys of ``solver`` that say how a scene is solved, and for how long."""
BESIDES = frozenset({"title", "units", "output", "limits", *(f"solver.{key}" for key in SOLVED_BY)})
"""What does not count in the scenes of applications, by key path without places in lists."""


PLAIN = frozenset({bool, int, float, str, type(None)})
"""Types of what is told by how Python writes it."""


def model_hash(scene: Any, besides: Collection[str] = BESIDES, folder: Path | None = None) -> str:
    """Hash of a scene's model, 16 hexadecimal digits: a run can be gone on with where it agrees.

    Parameters
    ----------
    scene : pydantic model, dataclass or named tuple
        A validated scene, SI.
    besides : collection of str
        Fields that do not count, as key paths without places in lists: ``solver.step``.
    folder : Path or None
        Folder of the files that the scene names (`tautline.scene.reading.files`); they count by their contents.

    Raises
    ------
    TypeError
        For a value that cannot be told by its contents: it must never be passed over in silence.
    """
    digest = sha256()
    for part in _contents(scene, "", besides, folder):
        digest.update(part + b"\0")
    return digest.hexdigest()[:16]


def says_the_same(scene: Any, other: Any) -> bool:
    """Whether two scenes say the same, and have the same driven from outside; in which text or file does not matter.

    Names of files that are relative say the same where they are relative to the same folder.
    """
    if scene is other:
        return True
    if type(scene) is not type(other) or scene.driven != other.driven:
        return False
    if any(getattr(scene, name) != getattr(other, name) for name in type(scene).model_fields):
        return False
    absolute = all(Path(name).is_absolute() for name in files_of(scene))
    return absolute or scene.folder.resolve() == other.folder.resolve()


def _contents(value: Any, path: str, besides: Collection[str], folder: Path | None) -> Iterator[bytes]:
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        yield type(value).__name__.encode()
        names: tuple[str, ...] = value._fields
        said = [(name, each) for name, each in zip(names, value, strict=True) if f"{path}.{name}" not in besides]
        if all(_is_plain(each) for _, each in said):
            # Some scenes have 100,000 of them: all of one at once.
            yield repr(said).encode()
        else:
            for name, each in said:
                yield name.encode()
                yield from _contents(each, f"{path}.{name}", besides, folder)
    elif isinstance(value, (BaseModel, dict)) or dataclasses.is_dataclass(value):
        yield type(value).__name__.encode()
        for name, each, is_file in _fields(value):
            inner = f"{path}.{name}" if path else str(name)
            if inner not in besides:
                yield str(name).encode()
                yield from _of_file(each, folder) if is_file else _contents(each, inner, besides, folder)
    elif isinstance(value, (tuple, list)):
        yield f"{len(value)} values".encode()
        for each in value:
            yield from _contents(each, path, besides, folder)
    elif isinstance(value, np.ndarray):
        yield f"array {value.dtype} {value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif value is None or isinstance(value, (bool, int, float, str)):
        yield f"{type(value).__name__} {value!r}".encode()
    else:
        raise TypeError(f"{path}: what a {type(value).__name__} holds cannot be told")


def _is_plain(value: Any) -> bool:
    """Whether a value is a number, a text, nothing, or a row of such."""
    kind = type(value)
    return kind in PLAIN or (kind is tuple and all(type(each) in PLAIN for each in value))


def _fields(value: Any) -> Iterator[tuple[Any, Any, bool]]:
    """Name, value, and whether it is the name of a file."""
    if isinstance(value, dict):
        yield from ((name, each, False) for name, each in value.items())
    elif isinstance(value, BaseModel):
        fields = type(value).model_fields.items()
        yield from ((name, getattr(value, name), names_file(field)) for name, field in fields)
    else:
        # What does not count where two are compared, such as where a scene was read, is no part of what it says.
        own = (field.name for field in dataclasses.fields(value) if field.compare)
        yield from ((name, getattr(value, name), False) for name in own)


def _of_file(name: Any, folder: Path | None) -> Iterator[bytes]:
    """Contents of a file that is named; the name where there is none, or where it cannot be read."""
    if isinstance(name, str) and folder is not None:
        try:
            yield sha256((folder / name).read_bytes()).digest()
            return
        except OSError:
            pass
    yield f"file {name!r}".encode()
