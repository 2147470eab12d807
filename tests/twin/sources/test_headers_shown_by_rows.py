"""Where a header begins in a line is shown by whole rows; no line ends a source, and no column is read for another.

The reference are the numbers that the rows were written from.
"""

import io
import math

import pytest
from twin.sources.test_sources_of_data import written

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream


def read(tmp_path, of, text, columns=("load",)):
    """Rows that have a stamp, and the source."""
    source = CsvFile(written(tmp_path / "r.csv", text), columns) if of == "file" else Stream(io.StringIO(text), columns)
    rows = []
    while not source.ended:
        rows += [row] if (row := source.poll(0.05)) is not None and row.time == row.time else []
    return [(row.time, *row.values.values()) for row in rows], source


EVENT = "time,load,event\n0,100,run\n1,101,run\n"
BEFORE = [(0.0, 100.0), (1.0, 101.0)]
SHORT = {
    "the first row": (EVENT + "index,time,load,event\n2,2,102\n3,3,103,run\n4,4,104,run\n", [3, 4]),
    "a later row": (EVENT + "temp,time,load,event\n20,2,102,\n20,3,10\n20,4,104,\n20,5,105,run\n", [2, 4, 5]),
    "two rows": (EVENT + "index,time,load,event\n2,2,102\n3,3,103\n4,4,104,run\n5,5,105,run\n", [4, 5]),
    "no text": ("time,load\n0,100\n1,101\ntemp,time,load\n20,2\n20,3,103\n20,4,104\n", [3, 4]),
    "a date": (EVENT + "date,time,load,event\n2026-01-01,2,102\n2026-01-01,3,103,run\n", [3]),
    "a reordered header": (
        "time,a,load,temp,event,\n0,7,100,20,run,\n1,7,101,21,run,\n2,7,102,22,stopa,load,temp,time,event,\n"
        "7,103,23,\n7,104,24,4,run,\n7,105,25,5,run,\n",
        [4, 5],
    ),
}  # fmt: skip


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize(("text", "behind"), SHORT.values(), ids=SHORT)
def test_a_row_that_lacks_a_cell_does_not_decide_where_a_header_begins(tmp_path, of, text, behind):
    """The load was read from the column of the time, to the end of the file."""
    rows, source = read(tmp_path, of, text)
    assert rows == BEFORE + [(float(k), 100.0 + k) for k in behind]
    assert any("Rows are left out until one shows" in note for note in source.notes) == (source.refused > 0)


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_header_with_a_column_added_in_front_and_a_last_column_that_is_always_empty_is_read_at_once(tmp_path, of):
    """Twenty rows were left out, and then the source ended."""
    rows, source = read(
        tmp_path, of, EVENT + "index,time,load,event\n" + "".join(f"0,{k},{100 + k},\n" for k in range(2, 40))
    )
    assert rows == BEFORE + [(float(k), 100.0 + k) for k in range(2, 40)] and source.refused == 0


@pytest.mark.parametrize("of", ["file", "stream"])
def test_rows_that_never_show_where_a_header_begins_end_no_source(tmp_path, of):
    text = "name,time,load,event\na,0,100,run\na,1,101\na,2,102\na,3,103,run\n" + "a,name,time,load,event\n"
    text += "".join(f"a,{k},{100 + k},run\n" for k in range(4, 40)) + "time,load\n50,150\n"
    rows, source = read(tmp_path, of, text)
    assert rows[-1] == (50.0, 150.0) and all(load == 100.0 + time for time, load in rows if load == load)
    assert source.refused + len(rows) >= 37


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_line_of_units_behind_a_header_in_doubt_holds_where_a_row_shows_the_header(tmp_path, of):
    text = "time,load\ns,kN\n0,100\n1,101\ntemp,time,load\nK,ms,kN\n20,2000,102\n20,3000,103\n"
    assert read(tmp_path, of, text)[0] == BEFORE + [(2.0, 102.0), (3.0, 103.0)]


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("remark", ["tare,load", "tare,load,x", "overload,time"])
def test_a_remark_that_names_all_columns_and_no_stamp_ends_no_source_and_takes_no_row(tmp_path, of, remark):
    text = f"time,load,heave\n0,100,7\n1,101,7\n{remark}\n2,102,7\n3,103,7\n"
    assert read(tmp_path, of, text)[0] == BEFORE + [(2.0, 102.0), (3.0, 103.0)]


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("last", ["alarm", ""], ids=["an empty column", "a separator at the end"])
def test_two_rows_that_ran_into_one_are_left_out_and_told_also_where_the_last_cell_is_empty(tmp_path, of, last):
    """`2,10` and `3,103,0.4,` were read as a load of 103 and a heave of 103.5."""
    text = f"time,load,heave,{last}\n0,100,0.1,\n1,101,0.2,\n2,103,103.5,0.4,\n4,104,0.5,\n"
    rows, source = read(tmp_path, of, text, ("load", "heave"))
    assert rows == [(0.0, 100.0, 0.1), (1.0, 101.0, 0.2), (4.0, 104.0, 0.5)]
    assert source.refused == 1 and "two lines may have run into one" in source.notes[0]


@pytest.mark.parametrize("of", ["file", "stream"])
def test_rows_that_all_have_more_cells_from_one_on_are_read_from_the_third_on(tmp_path, of):
    text = "time,load,heave\n0,100,7\n1,101,7\n" + "".join(f"{k},{100 + k},7,\n" for k in range(2, 8))
    rows, source = read(tmp_path, of, text)
    assert str(rows[2:4]) == "[(2.0, nan), (3.0, nan)]" and "Readings of such rows are left out" in source.notes[0]
    assert rows[4:] == [(float(k), 100.0 + k) for k in range(4, 8)] and source.refused == 0


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("remark", ["OVERLOAD,", "A,B,", "winch stopped, 5 t,"])
def test_rows_with_a_remark_and_a_separator_more_count_however_often_they_come(tmp_path, of, remark):
    """The rows of the alarm were left out for good, as a number of the header's stood behind the map's column."""
    spare = "," * remark.count(",")
    rows = [f"{k},{100 + k},0.{k},{remark if k % 2 else spare[1:]}" for k in range(8)]
    text = f"time,load,heave{spare}\n" + "\n".join(rows) + "\n"
    read_rows, source = read(tmp_path, of, text)
    assert read_rows == [(float(k), 100.0 + k) for k in range(8)] and source.refused == 0


MOVED = {
    "last column empty": "time,wind,load\n0,500,200\n1,501,201\n3,504,504,\n5,505,205\n",
    "NaN in its place": "time,wind,load,alarm\n0,1,200,\n1,1,201,\n3,53,1.5,NaN,\n5,1,205,\n",
    "behind rows with remarks": "time,wind,load,\n0,1,200,\n1,1,201,STOP,\n3,54,1,,\n5,1,205,\n",
}


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("text", MOVED.values(), ids=MOVED)
def test_a_longer_row_whose_numbers_may_have_moved_has_its_readings_missing(tmp_path, of, text):
    """`3,50` and `4,504,`, whose load is missing, were read as a load of 504, without a word."""
    rows, source = read(tmp_path, of, text)
    assert str(rows) == "[(0.0, 200.0), (1.0, 201.0), (3.0, nan), (5.0, 205.0)]" and source.refused == 0
    assert "two lines may have run into one" in source.notes[-1]


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_longer_row_counts_where_no_other_stamp_is_in_it(tmp_path, of):
    stamp = "2026-01-01 00:00:0"
    text = f"time,load,heave\n{stamp}0,100,7\n{stamp}1,101,7\n{stamp}2,102,7,\n{stamp}3,103,7\n"
    rows, source = read(tmp_path, of, text)
    assert [load for _, load in rows] == [100.0, 101.0, 102.0, 103.0] and not source.notes


MARKS = {
    "behind a header that comes again": ("time;load\n0;999.5\n1;1,001\ntime;load\n2;1,002\n", [999.5, None, None]),
    "in another column": ("time;heave;load\n0;0.12;998\n1;0.13;1,001\n", [998.0, None]),
    "in the stamp": ("time;load\n0,5;998\n1,0;1.001\n", [998.0, None]),
    "in another column than that of decimal commas": ("time;heave;load\n0;1,5;999.5\n1;2,5;1,001\n", [999.5, None]),
    "shown by no cell": ("time;load\n0;998\n1;1,001\n", [998.0, 1.001]),
    "decimal everywhere": ("time;heave;load\n0,5;1,25;1,001\n1,0;1,5;1,002\n", [1.001, 1.002]),
}  # fmt: skip


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize(("text", "loads"), MARKS.values(), ids=MARKS)
def test_a_mark_of_thousands_is_known_by_the_decimal_mark_of_the_table(tmp_path, of, text, loads):
    """`1,001` was read as 1.001 where another column, the stamp, or rows before a header showed points."""
    rows, source = read(tmp_path, of, text)
    assert [None if math.isnan(load) else load for _, load in rows] == loads
    assert len(source.notes) == (None in loads)


def test_a_number_with_an_underscore_is_none_as_in_tables_of_scenes(tmp_path):
    rows, _ = read(tmp_path, "file", "time,load\n0,100\n1,1_000\n")
    assert rows[0] == (0.0, 100.0) and math.isnan(rows[1][1])
