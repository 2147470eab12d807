"""Rows that broke off with a header behind them, torn at every place: no row that is read has a value of another one.

The reference are the numbers that the rows were written from. All of them differ, so that a number that is read as
another column's, or as another row's, is seen.
"""

import csv
import io
import random

import pytest
from of_the_suite import studies
from twin.sources.test_sources_of_data import written

from tautline.scene.errors import SceneError
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.record import SourceStopped
from tautline.twin.sources.stream import Stream

COLUMNS = ["winch", "rope"]
CELLS = {
    "time": lambda k: f"{0.05 * k:.2f}",
    "stamp": lambda k: f"1970-01-01 00:00:{0.05 * k:06.3f}",
    "winch": lambda k: f"{200 + 0.5 * k:.1f}",
    "rope": lambda k: f"{500 + 0.25 * k:.2f}",
    "id": lambda k: str(100 + k),
    "name": lambda k: "crane",
    "alarm": lambda k: "",
    "status": lambda k: ("OK", "", "OVERLOAD", "2 stands")[k % 4],
}
LAYOUTS = {
    "stamp first": "time winch rope", "word first": "name time winch rope", "empty first": "alarm time winch rope",
    "number first": "id time winch rope", "date first": "stamp winch rope", "status last": "time winch rope status",
    "number first and status last": "id time winch rope status",
    "word first and status last": "name time rope winch status",
    "words between": "time status winch name rope",
}  # fmt: skip
TRUTH = {k: (0.05 * k, 200 + 0.5 * k, 500 + 0.25 * k) for k in range(60)}


def line_of(cells, separator=",", quoting=csv.QUOTE_MINIMAL):
    text = io.StringIO()
    csv.writer(text, delimiter=separator, quoting=quoting, lineterminator="").writerow(cells)
    return text.getvalue()


def rows_of(columns, numbers, *form):
    return [line_of([CELLS[column](k) for column in columns], *form) for k in numbers]


def read(path, text, of):
    """Rows that were read, and whether the source ended before the end of the text."""
    source = CsvFile(written(path / "r.csv", text), COLUMNS) if of == "file" else Stream(io.StringIO(text), COLUMNS)
    rows = []
    try:
        while not source.ended:
            rows += [row] if (row := source.poll(0.05)) is not None else []
    except (SceneError, SourceStopped):
        return rows, True
    return rows, False


def false_rows(rows):
    """Rows that have a value that is not in the row that was written."""
    found = []
    for row in rows:
        true = TRUTH.get(round(row.time / 0.05)) if row.time == row.time else None
        values = [row.time, *(row.values[column] for column in COLUMNS)]
        if row.time == row.time and (
            true is None or any(v == v and abs(v - t) > 1e-9 for v, t in zip(values, true, strict=True))
        ):
            found.append(values)
    return found


def torn(columns, others, *form, cut, between=()):
    """A table that broke off in its fifth row, before a header of others."""
    before, behind = rows_of(columns, range(5), *form), rows_of(others, range(6, 10), *form)
    lines = [line_of(columns, *form), *before[:4], before[4][:cut] + line_of(others, *form), *between, *behind]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("quoting", [csv.QUOTE_MINIMAL, csv.QUOTE_NONNUMERIC], ids=["plain", "quoted"])
@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_behind_a_row_that_is_torn_anywhere_with_the_same_header_behind_it_rows_are_read_right(
    tmp_path, layout, quoting
):
    """Later rows were read one column off where the first cell was torn and was a word, or the source ended."""
    columns = layout.split()
    length = len(rows_of(columns, [4], ",", quoting)[0])
    for cut in range(length + 1):
        rows, ended = read(tmp_path, torn(columns, columns, ",", quoting, cut=cut), "file")
        assert not ended and not false_rows(rows)
        numbers = [round(row.time / 0.05) for row in rows if row.time == row.time]
        assert numbers[-2:] == [8, 9]
        # Behind a piece of words only, three rows show that it was none of a longer header.
        assert numbers[-4:] == [6, 7, 8, 9] or columns[0] == "name" or columns[1] == "status"


@pytest.mark.parametrize("quoting", [csv.QUOTE_MINIMAL, csv.QUOTE_NONNUMERIC], ids=["plain", "quoted"])
@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_behind_a_row_that_is_torn_anywhere_with_another_header_behind_it_no_value_is_of_another_column(
    tmp_path, layout, quoting
):
    columns = layout.split()
    others = [{"winch": "rope", "rope": "winch"}.get(one, one) for one in columns]
    length = len(rows_of(columns, [4], ",", quoting)[0])
    for cut in range(length + 1):
        for header in (others, ["id", *columns], ["status", *others]):
            if len({*header}) == len(header):
                rows, _ = read(tmp_path, torn(columns, header, ",", quoting, cut=cut), "file")
                assert not false_rows(rows), (cut, header)


def any_table(chance):
    """A table of 30 rows at random: now and then one breaks off before a header, the same one or another."""
    separator, quoting = chance.choice(",;\t"), chance.choice([csv.QUOTE_MINIMAL, csv.QUOTE_ALL])
    beside = chance.sample(["id", "name", "alarm", "status"], chance.randint(0, 3))
    columns = [*beside, chance.choice(["time", "stamp"]), "winch", "rope"]
    chance.shuffle(columns)
    lines, ends, k = [line_of(columns, separator, quoting)], chance.choice(["", separator]), 0
    short = chance.random() < 0.2
    while k < 30:
        (line,) = rows_of(columns, [k], separator, quoting)
        line += ends
        if short and columns[-1] in ("status", "alarm"):
            line = line.rstrip(separator)
        if chance.random() < 0.1 and k > 0:
            if chance.random() < 0.5:
                columns = [*columns]
                chance.shuffle(columns)
                if chance.random() < 0.3 and "id" not in columns:
                    columns = ["id", *columns]
            line = line[: chance.randint(0, len(line))] + line_of(columns, separator, quoting)
        lines.append(line)
        k += 1
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("seeds", [[*range(20), 1122, 1142, 3783, 5046], *studies(range(20, 3000))], ids=len)
def test_no_row_of_any_table_with_rows_that_broke_off_has_a_value_of_another_row_or_column(tmp_path, seeds):
    for seed in seeds:
        text = any_table(random.Random(seed))
        for of in ("file", "stream"):
            rows, _ = read(tmp_path, text, of)
            assert not false_rows(rows), text
