"""``--set key=value``: a scene with other values than its file has."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

from tautline.application import installed
from tautline.application.installed import Change, overridden
from tautline.scene.errors import Problem, SceneError, option_error
from tautline.scene.reading.document import Document, PartlyReplacedError, in_turn

OPTION = "--set"
EXAMPLE = "write --set 'solver.step=2 ms'"

S = TypeVar("S")


def changed(document: Document, given: Sequence[str] | None) -> Document:
    """The document with the values that were given in place of its own; itself where there are none.

    A value that is replaced counts for nothing: the scene is validated afterwards, as a whole.

    Parameters
    ----------
    given : sequence of str or None
        ``key=value`` each, the value as it would stand in the file.

    Raises
    ------
    PartlyReplacedError
        Naming the option, for what is no key with a value, a key that stands twice, and one that leads nowhere: of all
        that were given.
    """
    values, wrong = dict[str, Any](), list[Problem]()
    for text in given or ():
        try:
            key, value = _key_and_value(text)
        except SceneError as error:
            wrong += error.problems
            continue
        if key in values:
            wrong += option_error(OPTION, text, f"gives {key} a second time", "leave one of the two out").problems
            continue
        values[key] = value
    try:
        made = document.changed(values, OPTION) if values else document
    except PartlyReplacedError as error:
        raise PartlyReplacedError([*wrong, *error.problems], error.document) from None
    if wrong:
        raise PartlyReplacedError(wrong, made)
    return made


def change_of(given: Sequence[str] | None, end: float | None = None) -> Change | None:
    """The same for whoever finds the application of a scene and has it read; None where nothing is changed.

    Parameters
    ----------
    given : sequence of str or None
        As of `changed`.
    end : float or None
        Simulated time, s, in place of the scene's.
    """
    if not given and end is None:
        return None

    def change(application: Any, document: Document) -> Document:
        def ended(document: Document) -> Document:
            made = None if end is None else overridden(application, document, {"end": end})
            return document if made is None else made

        return in_turn(document, lambda document: changed(document, given), ended)

    return change


def read_changed(read: Callable[[Path | Document], S], path: Path, given: Sequence[str] | None) -> S:
    """What `read` makes of a file with the values that were given in place of its own; raises SceneError."""
    if not given:
        return read(path)
    return installed.read_changed(read, Document.read(path), lambda document: changed(document, given))


def as_given(given: Sequence[str] | None) -> str:
    """The options as a shell takes them, for the next command."""
    return "".join(f" {OPTION} {shlex.quote(text)}" for text in given or ())


def _key_and_value(text: str) -> tuple[str, Any]:
    """What was given, taken apart; raises SceneError for what is no key with a value."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise option_error(OPTION, text, "is no key with a value", EXAMPLE)
    return key.strip(), _value(value, text)


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
