"""What is wrong with a kernel that others wrote, said so that they can put it right."""

from __future__ import annotations

import re
from typing import Any

from tautline.errors import TautlineError

COLOUR = re.compile(r"\x1b\[[0-9;]*m")
STEP = re.compile(r"Failed in \w+ mode|raised from ")
"""Lines of numba's that tell of its own steps."""
MORE = re.compile(r'File "|During: |There (is|are) \d+ candidate|- Of which')
"""Lines with which the rest of what numba says begins: where it was, and all that it tried."""
PLACE = re.compile(r"\bat (\S.*) \((\d+)\)$", flags=re.MULTILINE)
LONGEST = 300
"""Characters that are shown of what numba said."""
CURE = "correct it there: a hook works on numbers and on arrays that exist, and makes no new ones (docs/extending.md)"


class KernelError(TautlineError):
    """A kernel that cannot be compiled.

    Attributes
    ----------
    path : str
        File and line of the mistake.
    cause, cure : str
        What is wrong, and what to do.
    """

    def __init__(self, path: str, cause: str, cure: str) -> None:
        self.path, self.cause, self.cure = path, cause, cure
        super().__init__(f"{path}: {cause}; {cure}")


def error_of_hook(kind: type, hook: str, function: Any, error: Exception) -> KernelError:
    """What the compiler's error means to those who wrote a hook of a kind of group.

    Parameters
    ----------
    kind : type
        The kind of group.
    hook : str
        Name of the hook.
    function : function
        As it was written.
    error : Exception
        What numba raised.
    """
    text, code = COLOUR.sub("", str(error)), function.__code__
    # Numba writes the innermost place first, and its own functions have places too.
    places = (f"{file}:{line}" for file, line in PLACE.findall(text) if "/numba/" not in file.replace("\\", "/"))
    place = next(places, f"{code.co_filename}:{code.co_firstlineno}")
    named = f"{function.__module__}.{function.__qualname__}"
    cause = f"hook {hook!r} of kind {kind.__name__} ({named}) cannot be compiled: {_first_lines(text)}"
    return KernelError(place, cause, CURE)


def words_of(error: Exception) -> str:
    """What numba said is wrong, as one line."""
    return _first_lines(COLOUR.sub("", str(error)))


def _first_lines(text: str) -> str:
    """The lines of numba's that say what is wrong, as one."""
    said: list[str] = []
    for line in (line.strip() for line in text.splitlines()):
        if said and MORE.match(line):
            break
        if line and not STEP.match(line):
            said.append(line)
    whole = " ".join(said).rstrip(".")
    return whole if len(whole) <= LONGEST else whole[:LONGEST] + "..."
