"""What gets among the lines of a source: names of files that `tail` writes, NUL bytes, and lines that are no rows."""

from __future__ import annotations

import re

from tautline.scene.errors import shorten

HEADING = re.compile(r"==> .+ <==")
"""What `tail` writes before lines of a file where it follows several: ``==> log.csv <==``."""
NUL = "\0"
MANY = 20
"""Lines in a row that cannot be read after which this is told: the machine is not watched meanwhile."""


class Strays:
    """Finds them in the lines of one source, and tells of each kind once.

    Parameters
    ----------
    name : str
        Of the source.
    notes : list of str
        Where sentences for the user go.
    """

    def __init__(self, name: str, notes: list[str]) -> None:
        self._name, self._notes, self._told = name, notes, set[str]()
        self._unread = 0

    def is_heading(self, line: str, number: int) -> bool:
        """Whether the `number`-th line is the name of a file, and no line of it; NUL bytes in a line are told here."""
        if NUL in line:
            self._tell(
                NUL,
                f"{self._name}:{number}: there are NUL bytes in the line, as a loss of power leaves them. "
                "Cells with such bytes count as missing",
            )
        if not (line.startswith("==>") and HEADING.fullmatch(line.rstrip())):
            return False
        self._tell(
            "heading",
            f"{self._name}:{number}: lines such as '{line.strip()}', by which `tail` names files, are passed over. "
            "Rows of all files are read by the header that came last: follow only files with the same columns",
        )
        return True

    def judge(self, line: str, is_row: bool) -> None:
        """Take notice whether a line could be read; many in a row that could not are told once, until one can be."""
        self._unread = 0 if is_row else self._unread + 1
        if self._unread == MANY:
            self._notes.append(
                f"{self._name}: the last {MANY} lines could not be read, and nothing is known of the machine "
                f"meanwhile. The last of them is '{shorten(line)}'"
            )

    def _tell(self, kind: str, note: str) -> None:
        if kind not in self._told:
            self._told.add(kind)
            self._notes.append(note)
