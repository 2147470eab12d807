"""``--set key=value``: a scene with other values than its file has."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from typing import Any, TypeVar

from tautline.scene.errors import SceneError, option_error
from tautline.scene.reading.document import Document

OPTION = "--set"
EXAMPLE = "write --set 'solver.step=2 ms'"

S = TypeVar("S")


def changed(scene: S, given: Sequence[str] | None) -> S:
    """The scene with the values that were given, by ``scene.replace``; the scene itself where there are none.

    Parameters
    ----------
    given : sequence of str or None
        ``key=value`` each, the value as it would stand in the file; where a key stands twice, the last one counts.

    Raises
    ------
    SceneError
        Naming the option, for what is no key with a value, an unknown key, and values that the scene cannot have.
    """
    if not given:
        return scene
    values: dict[str, Any] = {}
    for text in given:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise option_error(OPTION, text, "is no key with a value", EXAMPLE)
        values.pop(key.strip(), None)
        values[key.strip()] = _value(value, text)
    scene_of: Any = scene
    return scene_of.replace(values, origin=OPTION)


def as_given(given: Sequence[str] | None) -> str:
    """The options as a shell takes them, for the next command."""
    return "".join(f" {OPTION} {shlex.quote(text)}" for text in given or ())


def _value(text: str, whole: str) -> Any:
    """What a text stands for after a key and a colon."""
    try:
        root = Document.parse(f"value: {text}").root
    except SceneError as error:
        problem = error.problems[0]
        raise option_error(OPTION, whole, problem.cause, problem.cure) from None
    if len(root) > 1:
        raise option_error(OPTION, whole, "is more than one key with its value", f"{EXAMPLE}, and --set again")
    return root["value"]
