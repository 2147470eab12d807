"""Rows that have a separator more at their end now and then lose no reading; two lines that ran into one are not read.

What is right is what the rows were written from.
"""

from __future__ import annotations

import io
import math
import random

import pytest

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream


def read(tmp_path, of, text, columns=("load",), units=None):
    if of == "file":
        path = tmp_path / "rows.csv"
        path.write_text(text)
        source = CsvFile(path, list(columns), units=units)
    else:
        source = Stream(io.StringIO(text), list(columns), units=units)
    rows = []
    while not source.ended:
        if (row := source.poll(1.0)) is not None:
            rows.append((row.time, *row.values.values()))
    return rows, source


def table(rows, more, title="time,heave,load,mode\n"):
    """Rows of a table, of which those in `more` have a separator more at their end."""
    return title + "".join(",".join(cells) + ("," if k in more else "") + "\n" for k, cells in enumerate(rows))


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_separator_more_at_the_end_of_each_seventh_row_loses_no_reading(tmp_path, of):
    rows = [(f"{0.1 * k:.1f}", f"{0.3 * math.sin(k):.3f}", f"{9.8 + 0.01 * k:.3f}", "12") for k in range(60)]
    found, source = read(tmp_path, of, table(rows, range(3, 60, 7)))
    assert found == [(float(cells[0]), float(cells[2])) for cells in rows]
    assert source.notes == [] and source.refused == 0


@pytest.mark.parametrize("steps", ["even", "uneven"])
def test_whatever_rows_have_a_separator_more_no_reading_is_lost_or_wrong(tmp_path, steps):
    dice = random.Random(4)
    for _ in range(40):
        time, rows = 1000.0, []
        for _ in range(40):
            time += 0.1 if steps == "even" else dice.choice([0.1, 0.2, 0.7])
            mode = dice.choice(["auto", "", "", "1"])
            rows.append((f"{time:.2f}", f"{dice.gauss(0, 1):.3f}", f"{dice.gauss(50, 3):.3f}", mode))
        rows[:2] = [(*cells[:3], one) for cells, one in zip(rows, ("1", "auto"), strict=False)]
        found, source = read(tmp_path, "file", table(rows, dice.sample(range(3, 39), 8)))
        lost = [row for row in found if not math.isfinite(row[1])]
        right = {float(cells[0]): float(cells[2]) for cells in rows}
        assert all(load == right[at] for at, load in found if math.isfinite(load))
        # Without even steps nothing shows of two rows why a number is in a column of words.
        assert len(lost) + source.refused <= (0 if steps == "even" else 2)


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("lines", ["0.7,0.1,0.8,0.21,9.9,,", "0.7,0.1|0.7,0.21,9.9,,", "0.7,|0.9,0.21,9.9,,"])
def test_of_two_lines_in_one_no_number_is_read_also_where_rows_have_a_separator_more(tmp_path, of, lines):
    """A line that broke off has the next one behind it, itself once more, or one behind lines that are lost."""
    cells = [(f"{0.1 * k:.1f}", "0.20", "9.8", "", "") for k in range(7)]
    behind = [(f"{0.1 * k:.1f}", "0.20", "9.8", "", "") for k in range(10, 16)]
    title = "time,heave,load,mode,remark\n"
    text = table(cells, [2, 4], title) + lines.replace("|", "") + "\n" + table(behind, [2], "")
    found, _ = read(tmp_path, of, text)
    assert {load for _, load in found if math.isfinite(load)} == {9.8}
    assert len([load for _, load in found if math.isfinite(load)]) == 13


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("units", ["s,m,klbf", "s,m,kN"])
def test_titles_that_come_again_keep_their_units_until_a_line_of_units_says_otherwise(tmp_path, of, units):
    """The load was read 4.4 times too small behind the second page, and the twin believed it."""
    klbf = 4.4482216152605  # of its definition: 1000 lb x 0.45359237 kg/lb x 9.80665 m/s2
    text = "time,heave,load\ns,m,klbf\n0,0.1,2\n1,0.2,2\ntime,heave,load\n2,0.1,2\n"
    found, source = read(tmp_path, of, text, units={"load": "kN"})
    assert [load for _, load in found] == pytest.approx([2 * klbf] * 3) and source.notes == []
    found, source = read(tmp_path, of, f"{text}time,heave,load\n{units}\n3,0.1,2\n", units={"load": "kN"})
    assert found[-1] == pytest.approx((3.0, 2.0 if "kN" in units else 2 * klbf))
    assert [("other units than before" in note) for note in source.notes] == ([True] if "kN" in units else [])


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_row_that_begins_with_a_mark_for_nothing_is_no_remark_where_other_cells_have_it(tmp_path, of):
    text = "load,time,heave\n5,0,0.1\n6,1,#N/A\n#N/A,2,0.3\n#N/A for an hour\n# 7,3,0.4\n8,4,0.4\n"
    found, source = read(tmp_path, of, text, ["heave"])
    assert str(found) == "[(0.0, 0.1), (1.0, nan), (2.0, 0.3), (4.0, 0.4)]" and not source.notes


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_row_that_begins_with_a_mark_for_nothing_is_told_where_it_may_be_a_remark(tmp_path, of):
    found, source = read(tmp_path, of, "load,time,heave\n5,0,0.1\n#N/A,2,0.3\n8,4,0.4\n", ["heave"])
    assert found == [(0.0, 0.1), (4.0, 0.4)]
    assert [note for note in source.notes if "passed over as remarks" in note and "write an empty cell" in note]
