"""Rows of a table with a header, cell by cell, as a CSV file or a stream of lines has them."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence

from tautline.scene.errors import Problem, SceneError
from tautline.scene.refusal import nearest
from tautline.twin.sources.stamps import heads, number_of, seconds_in, stamp_column, stamp_of

SEPARATORS = ";\t,"


class Header:
    """The header of a table, and how its rows are read.

    Parameters
    ----------
    line : str
        The header.
    columns : sequence of str
        Those that are wanted.
    time : str
        The column of the stamp; empty for the usual names.
    where : str
        File or stream, for messages.

    Raises
    ------
    SceneError
        Where the stamp or a wanted column is missing.
    """

    def __init__(self, line: str, columns: Sequence[str], time: str, where: str) -> None:
        self.separator = max(SEPARATORS, key=line.count)
        titles = self.cells(line)
        self.names, self.units = heads(titles)
        self.width = len(titles)
        stamp = stamp_column(self.names, time) or stamp_column(titles, time)
        problems = []
        if stamp is None:
            cause = f"there is no column '{time}'" if time else "there is no column of time"
            cure = nearest(time, sorted(self.names)) if time else "call it `time`, or name it in the map under `time:`"
            problems.append(Problem(where, 1, "", None, cause, cure))
        self.places: dict[str, int] = {}
        for column in columns:
            place = next((i for i, one in enumerate(titles) if column in (one, self.names[i])), None)
            if place is None:
                cure = nearest(column, sorted(name for name in self.names if name))
                problems.append(Problem(where, 1, "", None, f"there is no column '{column}'", cure))
            else:
                self.places[column] = place
        if problems:
            raise SceneError(problems)
        self.stamp = next(i for i, one in enumerate(titles) if stamp in (one, self.names[i]))
        self.factor = seconds_in(self.units[self.stamp])

    def cells(self, line: str) -> list[str]:
        """Cells of a line, without spaces around them."""
        return [cell.strip() for cell in next(csv.reader([line], delimiter=self.separator), [])]

    def read(self, line: str) -> tuple[float, Mapping[str, float]] | None:
        """Stamp and values of a line; None for a line that has too few cells."""
        cells = self.cells(line)
        if len(cells) <= self.stamp:
            return None
        values = {
            name: number_of(cells[place]) if place < len(cells) else float("nan") for name, place in self.places.items()
        }
        return stamp_of(cells[self.stamp], self.factor), values
