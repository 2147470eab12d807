"""What is wrong with a scene, said so that the reader can put it right."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

from tautline.errors import TautlineError

SHOWN = 20
"""Problems printed; a file of one error repeated thousands of times must not fill the screen."""


LONGEST = 80
"""Characters shown of a value or a key path."""


def shorten(text: str) -> str:
    """Put a text on one line, its end left out if it is long."""
    line = " ".join(text.split())
    return line if len(line) <= LONGEST else line[:LONGEST] + "..."


def printable(text: str) -> str:
    """A text without characters that steer a terminal: they are told by their numbers, such as ``\\x1b``."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t" else c.encode("unicode_escape").decode() for c in text)


@dataclass(frozen=True)
class Problem:
    """One fault: where it is, what was written, why it cannot be, what to do.

    ``str()`` gives ``jwell.yaml:17: string[1].od = 0.10: smaller than id = 0.1086; swap od and id``.
    """

    file: str
    line: int | None
    key: str
    value: str | None
    cause: str
    cure: str = ""

    def __str__(self) -> str:
        where = self.file if self.line is None else f"{self.file}:{self.line}"
        key, value = shorten(self.key), shorten(self.value or "")
        # An option has no key: what was given to it stands beside its name.
        where = f"{where} {value}" if value and not key else where
        what = key if self.value is None or not key else f"{key} = {value}"
        text = ": ".join(part for part in (where, what, self.cause) if part)
        return printable(f"{text}; {self.cure}" if self.cure else text)


class Doubt(Problem):
    """A warning beside the faults of a scene, which may be their cause; its sentence has the line and the value."""

    def __str__(self) -> str:
        return f"warning: {self.file}: {shorten(self.key)}: {self.cause}"


ALIKE = 3
"""Lines of a file with one and the same fault that are shown one by one."""
NUMBERS = re.compile(r"[\d.]+")
"""In what they differ."""


class SceneError(TautlineError):
    """A scene that cannot be run.

    Attributes
    ----------
    problems : list of Problem
        All that was found, in the order of the file. ``str()`` is one per line.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = list(problems)
        super().__init__(self.problems)

    def translate(self, subject: Callable[[str], str], sentence: Callable[[str], str]) -> None:
        """See `TautlineError.translate`; what it is about may stand in the place of the file."""
        told = (replace(one, cause=sentence(one.cause), cure=sentence(one.cure)) for one in self.problems)
        SceneError.__init__(self, [replace(one, file=subject(one.file)) for one in told])

    def __str__(self) -> str:
        alike: dict[tuple[str, str, str], set[int]] = {}
        told = []
        for problem in self.problems:
            kind = problem.file, problem.key, NUMBERS.sub("", problem.cause)
            rows = alike.setdefault(kind, set())
            if problem.line is not None:
                rows.add(problem.line)
            if len(rows) <= ALIKE:
                told.append((kind, problem))
        lines = [str(problem) for _, problem in told[:SHOWN]]
        last = {kind: i for i, (kind, _) in enumerate(told[:SHOWN])}
        for kind, i in last.items():
            if len(alike[kind]) > ALIKE:
                lines[i] += f"\n... and {len(alike[kind]) - ALIKE} more like this"
        if len(told) > SHOWN:
            lines.append(f"... and {len(told) - SHOWN} more")
        return "\n".join(lines)


def option_error(option: str, value: str, cause: str, cure: str = "") -> SceneError:
    """An option of a command that cannot be: what was given to it, why not, and what would do."""
    return SceneError([Problem(option, None, "", value, cause, cure)])


@dataclass(frozen=True)
class SceneWarning:
    """A warning of ``check``: the key in the scene and its line, and what is large compared with what.

    One `of_a_run` counts in a run of the scene alone, as that of a long step does. Statics and modes do not give it.
    """

    where: str
    text: str
    line: int | None = None
    of_a_run: bool = field(default=False, compare=False)

    def __str__(self) -> str:
        line = f" (line {self.line})" if self.line else ""
        return f"{self.where}{line}: {self.text}"
