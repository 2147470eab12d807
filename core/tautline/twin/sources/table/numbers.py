"""Numbers in the cells of a table: which comma or point is decimal, and which may mark thousands."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from tautline.scene.reading.columns import NUMBER, may_mark_thousands
from tautline.twin.sources.stamps import number_of


@dataclass
class Marks:
    """Decimal marks of a column where commas do not separate cells.

    Attributes
    ----------
    table, asked : dict of str
        By mark, a cell that shows it to be decimal: of any column, and of the stamp and the columns of the map. Both
        are the same for all columns.
    decimal, unsure : dict of str
        By mark, a cell of this column that shows it to be decimal, and one in which it may mark thousands as well.
    """

    table: dict[str, str] = field(default_factory=dict)
    asked: dict[str, str] = field(default_factory=dict)
    decimal: dict[str, str] = field(default_factory=dict)
    unsure: dict[str, str] = field(default_factory=dict)

    def take(self, cell: str, beside: Sequence[str] = (), asked: Sequence[str] = ()) -> tuple[bool, str]:
        """Learn from a number what its mark means.

        Gives whether the mark is taken as decimal, and what is to be said of it and of those before, empty for nothing.
        Numbers `beside` it in its row, also in columns that nobody asks for, may show which mark is decimal. Where they
        show both to be, such as a version `2.1` among decimal commas, only those that are `asked` for do.
        """
        mark, other = (",", ".") if "," in cell else (".", ",")
        if mark in self.decimal:
            return True, ""
        if not may_mark_thousands(cell):
            self.decimal[mark] = cell
            self._learn([cell], self.table)
            self._learn([cell], self.asked)
            wrong = self.unsure.pop(other, "")
            said = (
                "the second may have a mark of thousands. Cells like it were read as decimals before, and may be wrong"
            )
            return True, f"'{cell}' and '{wrong}': {said}; from here on they are left out" if wrong else ""
        self._learn(beside, self.table)
        self._learn(asked, self.asked)
        anywhere = self.asked if mark in self.table else self.table
        shown = self.decimal.get(other) or anywhere.get(other)
        before = shown or self.unsure.get(other)
        if before is None:
            self.unsure.setdefault(mark, cell)
            return True, ""
        one = "the second" if shown else "one of the two"
        said = f"{one} may have a mark of thousands. Cells like the second are left out"
        read = "; those before were read as decimals, and may be wrong" if mark in self.unsure else ""
        return False, f"'{before}' and '{cell}': {said}{read}"

    @staticmethod
    def _learn(cells: Sequence[str], shown: dict[str, str]) -> None:
        """Keep the marks that numbers show to be decimal."""
        for cell in cells:
            mark = "," if "," in cell else "."
            if mark in cell and NUMBER.fullmatch(cell.replace(",", ".")) and not may_mark_thousands(cell):
                shown.setdefault(mark, cell)


class Numbers:
    """Reads numbers of cells.

    Parameters
    ----------
    separator : str
        Between cells.
    asked : sequence of int
        Cells of the stamp and of the columns of the map.
    tell : callable
        (kind, sentence) -> None; says once what of that kind is to be known.

    Attributes
    ----------
    marks : dict of str to Marks
        By column.
    """

    def __init__(self, separator: str, asked: Sequence[int], tell: Callable[[str, str], None]) -> None:
        self._separator, self._asked, self._tell = separator, asked, tell
        self.marks: dict[str, Marks] = {}

    def read(self, name: str, cell: str, beside: Sequence[str]) -> float:
        """A cell's number; NaN for one with a comma or a point that may be a mark of thousands.

        So it is with a comma in a table that commas separate; and in a table that has both, where the first is taken.
        `beside` are all cells of the row.
        """
        if self._separator != ",":
            return number_of(cell) if self._is_of_one_mark(name, cell, beside) else math.nan
        if "," not in cell:
            return number_of(cell)
        self._tell(
            "comma",
            f"column '{name}' has cells such as \"{cell}\". In a table with commas between its cells this may be a "
            "mark of thousands or a decimal comma. Such cells are left out: write numbers without marks of "
            "thousands and with a decimal point, or put ; between the cells if these are decimal commas",
        )
        return math.nan

    def _is_of_one_mark(self, name: str, cell: str, beside: Sequence[str]) -> bool:
        """Whether the mark of a cell, if any, is taken as decimal; tells once where the table leaves that in doubt.

        `999.5` shows that its mark is decimal, in any column, and `1,001` shows nothing: where the other mark came
        before, or is beside it, it is left out until a cell shows its mark to be decimal, too. Then other columns that
        nobody asks for show nothing more.
        """
        if not ("," in cell or "." in cell) or math.isnan(number_of(cell)):
            return True
        marks = self.marks.get(name)
        if marks is None:
            same = next(iter(self.marks.values()), Marks())
            marks = self.marks[name] = Marks(same.table, same.asked)
        asked = [beside[place] for place in self._asked if place < len(beside)]
        decimal, note = marks.take(cell, beside, asked)
        if note:
            self._tell("marks", f"column '{name}' has cells such as {note}: write numbers without marks of thousands")
        return decimal
