"""What the thesis' own example does and YAML reads otherwise: understood, and said as a warning.

Three departures from YAML and from our syntax: ``{Cable:0, what:N}`` without blanks, which YAML takes for keys named
``Cable:0`` without a value; a key given twice (`document.REPEATABLE`); and a second, linear version
of the model beside the cubic one.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Sequence
from typing import Any

from tautline.cable.input.syntax.models import KINDS, Item, LinearCoupl, LinearElement, Multiplier4, Node4Dof, Node7Dof
from tautline.scene.errors import SceneError, SceneWarning
from tautline.scene.reading.document import Document, join_key

GLUED = re.compile(r"(?P<key>\w+):(?P<value>\S.*)")
OF_LINEAR = (Node4Dof, LinearElement, Multiplier4)


def read_compat(document: Document) -> tuple[Document, list[SceneWarning]]:
    """Copy of a document that says what its author meant, and a warning for each liberty taken."""
    warnings = []
    for path, line in document.repeats:
        text = f"stands in line {line} as well: the last one counts, remove the other"
        warnings.append(SceneWarning(_at(document, path), text))
    root = {key: value for key, value in document.root.items()}
    glued: list[tuple[str | int, ...]] = []
    for key in ("CableModel", "Plots"):
        if key in root:
            root[key] = _unglued(root[key], (key,), glued)
    if glued:
        more = f" and {len(glued) - 1} more" if len(glued) > 1 else ""
        key, value = str(glued[0][-1]).split(":", 1)
        text = f"is read as `{key}: {value}`: put a blank after the colon{more and f' (here{more})'}"
        warnings.append(SceneWarning(_at(document, glued[0]), text))
    return dataclasses.replace(document, root=root), warnings


def _at(document: Document, path: Sequence[str | int]) -> str:
    """Key path and line, for a warning."""
    return f"{join_key(tuple(path))} (line {document.line(tuple(path))})"


def _unglued(value: Any, path: tuple[str | int, ...], found: list[tuple[str | int, ...]]) -> Any:
    """Copy of a value whose glued keys are taken apart; their paths are appended to `found`."""
    if isinstance(value, list):
        return [_unglued(entry, (*path, i), found) for i, entry in enumerate(value)]
    if not isinstance(value, dict):
        return value
    copy: dict[str, Any] = {}
    for key, entry in value.items():
        match = GLUED.fullmatch(key) if entry is None and key not in KINDS else None
        if match is None or match["key"] in value or match["key"] in copy:
            copy[key] = _unglued(entry, (*path, key), found)
            continue
        try:
            copy[match["key"]] = Document.parse(f"x: {match['value']}").root["x"]
        except SceneError:
            copy[key] = entry
        else:
            found.append((*path, key))
    return copy


def without_alternatives(
    items: Sequence[Item], document: Document
) -> tuple[list[tuple[int, Item]], list[SceneWarning]]:
    """Items with their places in the list, without the linear copy of a cubic model that the appendix appends.

    It is a copy if every ``Node4Dof`` has a ``Node7Dof`` of the same id at the same point. What goes is all that is
    written for linear nodes, and the couplings after its first node whose ids are taken already.
    """
    numbered = list(enumerate(items))
    points = {item.model.id: item.model.xyz for item in items if isinstance(item.model, Node7Dof)}
    copies = [i for i, item in numbered if isinstance(item.model, Node4Dof)]
    if not copies or any(points.get(items[i].model.id) != items[i].model.xyz for i in copies):
        return numbered, []
    kept, dropped = [], 0
    for i, item in _with_couplings(numbered, copies[0]):
        if item is None or isinstance(item.model, OF_LINEAR):
            dropped += 1
        else:
            kept.append((i, item))
    text = (
        f"begins a copy of the model for linear elements, every node of which has a Node7Dof at its place: its "
        f"{dropped} items are left out; keep one of the alternatives, or give the nodes ids of their own"
    )
    return kept, [SceneWarning(_at(document, ("CableModel", copies[0], "Node4Dof")), text)]


def _with_couplings(numbered: Sequence[tuple[int, Item]], first: int) -> Iterator[tuple[int, Item | None]]:
    """Items, None for a coupling of the copy."""
    seen: set[int] = set()
    for i, item in numbered:
        if isinstance(item.model, LinearCoupl):
            if i > first and item.model.id in seen:
                yield i, None
                continue
            seen.add(item.model.id)
        yield i, item
