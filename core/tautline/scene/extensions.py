"""What others add to the program: modules that installed packages name, imported before the first scene is read."""

from __future__ import annotations

import functools

from tautline import entry_points
from tautline.scene.errors import Problem

GROUP = "tautline.extensions"
"""Entry points of this group name modules that register items, warnings and the like as they are imported."""


@functools.cache
def load_extensions() -> dict[str, str]:
    """Import the extensions, once; returns why one could not be loaded, by its name."""
    broken: dict[str, str] = {}
    for point in entry_points.in_group(GROUP):
        try:
            point.load()
        except (Exception, SystemExit) as error:  # a broken one must not keep the others from being used
            broken[point.name] = f"{type(error).__name__}: {_words(error)}"
    return broken


def _words(error: BaseException) -> str:
    """What an error says; of one of syntax with the whole path of its file, of which Python tells the last part."""
    if isinstance(error, SyntaxError) and error.filename is not None:
        return f"{error.msg} ({error.filename}, line {error.lineno})"
    return str(error)


def problems_of_extensions(file: str) -> list[Problem]:
    """Each extension that could not be loaded as a problem, for a file that may need it."""
    return [
        Problem(file, None, "", None, f"the extension {name} could not be loaded ({why})", "repair or uninstall it")
        for name, why in load_extensions().items()
    ]
