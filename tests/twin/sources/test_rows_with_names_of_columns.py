"""Rows whose text names columns of the map: they are rows, and no headers.

The reference are the numbers that the rows were written from.
"""

import io

import pytest
from twin.sources.test_sources_of_data import written

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream
from tautline.twin.sources.table import lines
from tautline.twin.sources.table.header import Header
from tautline.twin.sources.table.lines import Lines


def read(tmp_path, of, text, columns):
    """Rows with a stamp that were read, and their source."""
    source = CsvFile(written(tmp_path / "r.csv", text), columns) if of == "file" else Stream(io.StringIO(text), columns)
    rows = []
    while not source.ended:
        rows += [row] if (row := source.poll(0.05)) is not None and row.time == row.time else []
    return [(row.time, *row.values.values()) for row in rows], source


EVENTS = {
    "an overload": ("time,load,alarm,source", "overload,load"),
    "a torque": ("time,load,alarm,source", "high load,load"),
    "a word that ends with t": ("t,load,event,channel", "start,load"),
    "two columns": ("time,winch,rope,from,to", "aux winch,winch rope"),
    "three columns": ("time,winch,rope,alarm,from,to", "aux winch,winch,rope"),
    "a stamp and one of two columns": ("time,winch,rope,axis,control", "time,winch"),
    "a remark without titles": ("time,winch,rope", "slack rope,winch"),
}  # fmt: skip


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize(("titles", "event"), EVENTS.values(), ids=EVENTS)
def test_a_row_with_an_event_that_names_columns_is_read_and_so_are_all_behind_it(tmp_path, of, titles, event):
    """The source ended at `6.00,50.058,overload,load`: a header was seen in the midst of that row."""
    columns = ["load"] if "load" in titles else ["winch", "rope"]
    rows = [(float(k), *(100.0 * i + k for i in range(1, len(columns) + 1))) for k in range(9)]
    empty = "," * (titles.count(",") - len(columns))
    text = [",".join(map(str, row)) + ("," + event if row[0] == 5.0 else empty) for row in rows]
    found, source = read(tmp_path, of, "\n".join([titles, *text]) + "\n", columns)
    assert found == rows and source.refused == 0


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("event", ["preload,load", "reset,load"])
def test_rows_that_all_name_a_column_are_read(tmp_path, of, event):
    rows = [(float(k), 100.0 + k) for k in range(9)]
    text = "t,load,state,channel\n" + "".join(f"{time},{load},{event}\n" for time, load in rows)
    assert read(tmp_path, of, text, ["load"])[0] == rows


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("event", ["load,time", "time,load"])
def test_where_all_rows_end_with_all_titles_the_first_is_left_out_counted_and_told(tmp_path, of, event):
    """No row was read, none was counted, and nothing said why."""
    rows = [(float(k), 100.0 + k) for k in range(9)]
    text = "time,load,mode,trigger\n" + "".join(f"{time},{load},{event}\n" for time, load in rows)
    found, source = read(tmp_path, of, text, ["load"])
    assert found == rows[1:] and source.refused == 1
    (note,) = source.notes
    assert f"0.0,100.0,{event}' is a row, or one that broke off with a header after it: it is left out" in note


@pytest.mark.parametrize("of", ["file", "stream"])
def test_one_row_that_ends_with_all_titles_takes_no_other_row_with_it(tmp_path, of):
    """Rows behind it were left out, up to twenty, and then the source ended."""
    rows = [(float(k), 100.0 + k) for k in range(60)]
    text = [f"{time},{load},time,{'load' if time == 5.0 else 'position'}" for time, load in rows]
    found, source = read(tmp_path, of, "\n".join(["time,load,axis,control", *text]) + "\n", ["load"])
    assert found == [row for row in rows if row[0] != 5.0] and source.refused == 1


@pytest.mark.parametrize("text", ["no overload", "winch rope ok", "load ok,rope,3", "OVERLOAD time"])
def test_no_header_is_looked_for_in_a_row_whose_text_cannot_be_one(monkeypatch, text):
    """Each such row took ten times as long: all ways to split it were tried."""
    monkeypatch.setattr(lines, "_Search", None)
    titles = ["time", "load", *(f"text {i}" for i in range(text.count(",") + 1))]
    read_by = Lines(Header(",".join(titles), ["load"], "", "test"))
    assert [read_by.take(f"{k},{100 + k},{text}") for k in range(3)] == [
        (float(k), {"load": 100.0 + k}) for k in range(3)
    ]


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("word", ["OVERRANGE", "Bad", "calibrating"])
def test_behind_a_header_with_a_column_added_in_front_a_sensor_may_show_a_word(tmp_path, of, word):
    """All such rows were left out, with the numbers of the other sensor, and then the source ended."""
    before, behind = ([(float(k), 100.0 + k, 200.0 + k) for k in part] for part in (range(5), range(5, 40)))
    text = ["time,winch,rope", *(",".join(map(str, row)) for row in before), "id,time,winch,rope"]
    text += [f"{i},{time},{word},{rope}" for i, (time, _, rope) in enumerate(behind)]
    found, _ = read(tmp_path, of, "\n".join(text) + "\n", ["winch", "rope"])
    assert [(time, rope) for time, _, rope in found] == [(time, rope) for time, _, rope in before + behind]
    assert all(winch != winch for _, winch, _ in found[5:])
