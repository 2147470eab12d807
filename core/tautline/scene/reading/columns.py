"""Columns of numbers from a CSV file, by header, with units in the header or without."""

from __future__ import annotations

import csv
import math
import re
from fractions import Fraction
from pathlib import Path

from pydantic_core import PydanticCustomError

from tautline.scene.errors import SceneError
from tautline.scene.reading.text import decode
from tautline.scene.refusal import nearest, refusal
from tautline.scene.values.magnitude import LARGEST, OUTSIDE
from tautline.scene.values.units import Uncounted, Unit, UnknownUnit, converted, read_unit

LARGEST_TABLE = 200_000_000
HEADER = re.compile(r"\s*(?P<name>[^\[(,;]*?)\s*(?:[\[(]\s*(?P<unit>[^\])]*?)\s*[\])])?\s*")


class Columns:
    """The columns of a CSV file.

    Separators are commas, semicolons or tabs; lines that begin with ``#`` are skipped; headers are ``time``,
    ``time [s]`` or ``time (s)``. A file without a header has columns without names.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    PydanticCustomError
        Naming the file and the line at fault.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        rows = self._rows()
        first_line, first = rows[0]
        self.headed = not all(_is_number(cell) for cell in first)
        heads = [HEADER.fullmatch(cell) for cell in first] if self.headed else []
        self.names = [head["name"].lower() if head else "" for head in heads] or [""] * len(first)
        self.units = [(head["unit"] or "") if head else "" for head in heads] or [""] * len(first)
        self.rows = rows[1:] if self.headed else rows
        self.header_line = first_line
        if not self.rows:
            raise self.refuse(first_line, "holds a header and no rows", "add rows of numbers")

    def refuse(self, line: int | None, cause: str, cure: str) -> Exception:
        """Error at a line of this file."""
        return refusal(cause, cure, file=str(self.path), line=line)

    def _rows(self) -> list[tuple[int, list[str]]]:
        try:
            if not self.path.is_file():
                raise self.refuse(None, "there is no such file", "check the name: it is relative to the scene's folder")
            if self.path.stat().st_size > LARGEST_TABLE:
                raise self.refuse(None, f"is over {LARGEST_TABLE / 1e6:.0f} MB", "thin it out")
            text = decode(self.path.read_bytes(), self.path)
        except PydanticCustomError:
            raise
        except SceneError as error:
            problem = error.problems[0]
            raise self.refuse(problem.line, problem.cause, problem.cure) from None
        except (OSError, ValueError) as error:
            raise self.refuse(None, f"cannot be read: {error}", "check the name and its permissions") from None
        lines = [(i, s) for i, s in enumerate(text.splitlines(), 1) if s.strip() and not s.lstrip().startswith("#")]
        if not lines:
            raise self.refuse(None, "is empty", "add rows of numbers")
        separator = next((mark for mark in ("\t", ";", ",") if mark in lines[0][1]), ",")
        try:
            cells = csv.reader((s for _, s in lines), delimiter=separator, strict=False)
            return [(i, row) for (i, _), row in zip(lines, cells, strict=False)]
        except csv.Error as error:
            raise self.refuse(None, f"is not a CSV file: {error}", "write plain rows of numbers") from None

    def index(self, names: tuple[str, ...], otherwise: int | None = None) -> int:
        """Find the column of one of these names; `otherwise` is used if none has it.

        Raises
        ------
        PydanticCustomError
            If there is no such column.
        """
        for name in names:
            if name.lower() in self.names:
                return self.names.index(name.lower())
        if otherwise is not None and otherwise < len(self.names):
            return otherwise
        cure = f"name it in the header; {nearest(names[0], [n for n in self.names if n])}"
        raise self.refuse(self.header_line, f"there is no column '{names[0]}'", cure)

    def values(self, column: int, unit: str) -> tuple[float, ...]:
        """Return a column in SI.

        Parameters
        ----------
        column : int
            Its index.
        unit : str
            The SI unit wanted; what stands in the header is converted to it.

        Raises
        ------
        PydanticCustomError
            If a cell is no finite number, or the header's unit is another quantity's.
        """
        scale = self._scale(column, unit)
        values = []
        for line, row in self.rows:
            cell = row[column].strip() if column < len(row) else ""
            try:
                value = float(cell)
            except ValueError:
                value = math.nan
            if not math.isfinite(value) or "_" in cell:
                shown = f"'{cell}'" if cell else "an empty cell"
                raise self.refuse(line, f"{shown} in column {column + 1} is not a finite number", "give a number")
            values.append(value)
        factor = scale.si(Fraction(1))
        if factor != 1.0:
            values = [value * factor for value in values]
        if (largest := max(values, key=abs)) and abs(largest) > LARGEST:
            line, row = self.rows[values.index(largest)]
            cause, cure = OUTSIDE
            raise self.refuse(line, f"'{row[column].strip()}' in column {column + 1} {cause}", cure)
        return tuple(values)

    def _scale(self, column: int, unit: str) -> Unit:
        wanted = read_unit(unit) if unit else read_unit("m/m")
        written = self.units[column]
        if not written:
            return wanted
        try:
            found = read_unit(written)
        except UnknownUnit as error:
            raise self.refuse(
                self.header_line, str(error), f"write the header as {self.names[column]} [{unit}]"
            ) from None
        if found.dimension != wanted.dimension:
            cause = f"'{written}' in the header of column {column + 1} is not a unit like {unit}"
            raise self.refuse(self.header_line, cause, f"write the header as {self.names[column]} [{unit}]")
        try:
            return converted(found, wanted)
        except Uncounted as error:
            cause = f"'{written}' in the header of column {column + 1} {error}"
            raise self.refuse(self.header_line, cause, f"write the header as {self.names[column]} [{unit}]") from None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
