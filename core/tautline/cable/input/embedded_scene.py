"""The scene that a result carries; read without any library that draws."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from tautline.cable.input.parts import CableScene
from tautline.cable.input.scene import parse
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.errors import SceneError

T = TypeVar("T")


def scene_of(result: Result) -> CableScene:
    """Scene of a result, from the text that it carries.

    Raises
    ------
    ResultError
        If the text is no scene of a cable.
    """
    return embedded(result, parse)


def embedded(result: Result, read: Callable[[str, str], T]) -> T:
    """Scene of a result in elements of this kind, as `read` makes it of the text and of a name for messages.

    Raises
    ------
    ResultError
        If `read` refuses the text by SceneError.
    """
    name = str(result.path or "result")
    try:
        return read(str(result.attributes.get("scene", "")), name)
    except SceneError as error:
        cause = f"carries a scene that cannot be read: {error.problems[0].cause}"
        raise ResultError(name, cause, "run the scene again") from None
