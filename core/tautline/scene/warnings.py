"""Warnings of a scene before it runs: each is one function, registered for the scenes of one application."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from tautline.entry_points import packages_of_ours
from tautline.errors import TautlineError
from tautline.scene.errors import SceneWarning
from tautline.scene.extensions import load_extensions
from tautline.scene.reading.document import Document, join_key, split_key

Place = str | tuple[str | int, ...]
Check = Callable[[Any], Iterable[tuple[Any, str]]]
C = TypeVar("C", bound=Check)

REGISTERED: dict[str, dict[str, Check]] = {}
"""For each application its checks by module and name, in the order in which they are reported."""


def warning(application: str) -> Callable[[C], C]:
    """Register a function that warns of scenes of an application.

    It is called with the scene that the application has read, and gives pairs of a key path, as text or as a tuple such
    as ``("solver", "step")``, and a text: what is large compared with what, and what to do. Every
    verb that reads a scene prints them. A function of the same module and name takes the place of an earlier one, as in
    a notebook.

    Parameters
    ----------
    application : str
        ``cable``, ``crane``, ``drillstring``, ``gardenhose``, or another one's name.
    """

    def register(check: C) -> C:
        REGISTERED.setdefault(application, {})[f"{check.__module__}.{check.__qualname__}"] = check
        return check

    return register


def warnings_of(application: str, scene: Any) -> list[SceneWarning]:
    """What the registered functions find in a scene; the line stands beside a key path that is a tuple."""
    cure = "its items and warnings are missing; repair or uninstall it"
    found = [
        SceneWarning(f"extension {name}", f"could not be loaded ({why}): {cure}")
        for name, why in load_extensions().items()
    ]
    for check in REGISTERED.get(application, {}).values():
        named = f"{check.__module__}.{check.__qualname__}"
        found += [_warning(scene, place, text) for place, text in asked(check, named, scene)]
    return found


def asked(check: Callable[..., Iterable[tuple[Any, str]]], named: str, *given: Any) -> list[tuple[Any, str]]:
    """What a function warns of. Where one of others fails, that is its warning: it must not keep a scene from running.

    Raises
    ------
    TautlineError
        What the function refuses on purpose.
    """
    try:
        return [_pair(one) for one in check(*given) or ()]
    except TautlineError:
        raise
    except Exception as error:
        if check.__module__.partition(".")[0] in packages_of_ours():
            raise
        last = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{last.filename}:{last.lineno}"
        if last.filename == __file__:  # it gave something else than pairs
            code = inspect.unwrap(check).__code__
            place = f"{code.co_filename}:{code.co_firstlineno}"
        return [(named, f"this warning failed ({place}: {type(error).__name__}: {error}); correct it there")]


def _pair(given: Any) -> tuple[Any, str]:
    """A place and a text; raises TypeError."""
    match given:
        case (str() | tuple()) as place, str() as text:
            return place, text
    raise TypeError(f"it gave {given!r}, and not pairs of a key path and a text")


def line_of(document: Document | None, where: str) -> int | None:
    """Line of the key that a warning names, or of the nearest above it; None where the file does not hold it.

    None, too, for a place that states its line itself.
    """
    path = split_key(where)
    if document is None or not path or "(line " in where or document.origin(path):
        return None
    return document.line(path)


def _warning(scene: Any, place: Place, text: str) -> SceneWarning:
    if isinstance(place, str):
        return SceneWarning(place, text)
    document = getattr(scene, "document", None)
    line = document.line(place) if document is not None else None
    return SceneWarning(join_key(place) + (f" (line {line})" if line else ""), text)
