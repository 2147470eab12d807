"""A header in the midst of rows, as where a log is begun anew: rows behind it are read by it, or the source stops."""

import io

import pytest
from twin.sources.test_sources_of_data import all_of, written

from tautline.scene.errors import SceneError
from tautline.twin.signals.rows import Rows
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.record import SourceStopped
from tautline.twin.sources.stream import Stream
from tautline.twin.sources.table.header import Header

UNITS = {"winch": "m", "rope": "kN"}
FIRST = "time [s],winch [m],rope [kN]\n0,1,50\n"


def file(tmp_path, text):
    return CsvFile(written(tmp_path / "r.csv", text), list(UNITS), units=UNITS)


def stream(_, text):
    return Stream(io.StringIO(text), list(UNITS), units=UNITS)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "later",
    [
        "time [s],rope [kN],winch [m]\n1,50,1\n",
        "time [s],winch [cm],rope [N]\n1,100,50000\n",
        "winch [m],rope [kN],time [ms]\n1,50,1000\n",
        "time [s];winch [m];rope [kN]\n1;1,0;50,0\n",
    ],
)
def test_rows_behind_a_header_that_comes_again_are_read_by_it_and_this_is_told_once(tmp_path, of, later):
    source = of(tmp_path, FIRST + later)
    rows = all_of(source)
    assert [(row.time, *row.values.values()) for row in rows] == [(0.0, 1.0, 50.0), (1.0, 1.0, 50.0)]
    assert source.refused == 0
    assert [note for note in source.notes if ":3: a new header" in note] == source.notes != []


@pytest.mark.parametrize("of", [file, stream])
def test_the_same_header_once_more_is_no_row_and_needs_no_word(tmp_path, of):
    source = of(tmp_path, FIRST + FIRST.replace("\n0,", "\n1,"))
    assert [row.time for row in all_of(source)] == [0.0, 1.0]
    assert source.refused == 0 and not source.notes


TORN = {
    "behind the stamp": "2,", "behind a cell": "2,7,", "in the last cell": "2,7,4", "in the stamp": "2.",
    "in a cell": "2,7", "behind a date": "1970-01-01T00:00:02,",
}  # fmt: skip


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("half", TORN.values(), ids=TORN)
def test_half_a_row_with_the_header_behind_it_is_left_out_and_told_and_rows_behind_it_are_as_before(tmp_path, of, half):
    """The number of a winch was read as the time, and a load as the place of the winch: a logger had lost its power."""
    source = of(tmp_path, f"{FIRST}{half}{FIRST.replace('0,1,50', '8,2,60')}9,3,70\n")
    rows = [(row.time, *row.values.values()) for row in all_of(source) if row.time == row.time]
    assert rows == [(0.0, 1.0, 50.0), (8.0, 2.0, 60.0), (9.0, 3.0, 70.0)]
    assert len(source.notes) == 1 and ":3: the row" in source.notes[0] and "breaks off" in source.notes[0]


MORE = {
    "a number": ("no,", "7,"), "no number in a row": ("no,", ","), "a word": ("state,", "run,"),
    "two": ("date,no,", "x,7,"),
}  # fmt: skip


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("title", "cell"), MORE.values(), ids=MORE)
def test_a_new_header_with_columns_added_in_front_is_no_broken_row_and_rows_are_read_by_it(tmp_path, of, title, cell):
    """Number of the row, time and winch were read as time, winch and load."""
    later = "".join(f"{cell}{row}\n" for row in ("8,2,60", "9,3,", "10,4,80"))
    source = of(tmp_path, f"{FIRST}{title}{FIRST.splitlines()[0]}\n{later}")
    rows = [(row.time, row.values["winch"]) for row in all_of(source)]
    assert rows == [(0.0, 1.0), (8.0, 2.0), (9.0, 3.0), (10.0, 4.0)]
    assert "a new header" in source.notes[0]


CHANGED = {
    "another order": ("2,time [s],rope [kN],winch [m]\n8,60,2\n", 60.0),
    "other units": ("2,time [s],winch [m],rope [N]\n8,2,60000\n", 60.0),
    "stamps in other units": ("2,time [ms],winch [m],rope [kN]\n8000,2,60\n", 60.0),
    "a column more": ("2,1,time [s],winch [m],rope [kN],C\n8,2,60,1\n", 60.0),
    "a word before the stamp": ("2,no,time [s],winch [m],rope [kN]\n7,8,2,60\n", 60.0),
    "in the stamp": ("2.time [s],rope [kN],winch [m]\n8,60,2\n", 60.0),
}


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("later", "rope"), CHANGED.values(), ids=CHANGED)
def test_rows_behind_half_a_row_and_another_header_are_read_by_that_header(tmp_path, of, later, rope):
    source = of(tmp_path, FIRST + later)
    rows = [(row.time, *row.values.values()) for row in all_of(source)]
    assert rows == [(0.0, 1.0, 50.0), (8.0, 2.0, rope)]
    assert "breaks off, and a header comes after it" in source.notes[0]


@pytest.mark.parametrize("of", [file, stream])
def test_other_units_below_a_header_behind_half_a_row_that_contradict_it_end_the_source(tmp_path, of):
    source = of(tmp_path, FIRST + "2,time [s],winch [m],rope [kN]\ns,m,N\n8,2,60000\n")
    with pytest.raises(SourceStopped, match=r"the unit is \[kN\] in the header and N"):
        all_of(source)


@pytest.mark.parametrize("of", [file, stream])
def test_a_header_whose_first_name_ends_as_that_of_the_first_one_is_a_new_header_and_no_half_row(tmp_path, of):
    source = of(tmp_path, "time,winch,rope\n0,1,50\nDatetime,winch,rope\n1970-01-01T00:00:01Z,2,60\n")
    assert [row.time for row in all_of(source)] == [0.0, 1.0] and not source.notes


@pytest.mark.parametrize("of", [file, stream])
def test_a_row_with_a_stamp_and_names_of_columns_in_a_long_remark_is_no_header_and_ends_no_source(tmp_path, of):
    source = of(tmp_path, f"{FIRST}1,1,50,2 t,winch,rope\n2,1,50\n")
    assert [row.time for row in all_of(source)] == [0.0, 2.0] and source.refused == 1


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("time [s],winch [m]", "there is no column 'rope'"),
        ("time [s],winch [m],rope [m]", "'m' is a unit of another quantity"),
        ("seconds,winch [m],rope [kN]", "there is no column of time"),
    ],
)
def test_a_header_by_which_rows_cannot_be_read_ends_the_source_after_the_rows_before_it(tmp_path, of, header, said):
    source = of(tmp_path, f"{FIRST}{header}\n1,1,50\n")
    found = []
    with pytest.raises(SourceStopped, match=said):
        while not source.ended:
            found += [row] if (row := source.poll(0.05)) is not None else []
    assert [row.time for row in found] == [0.0] and source.ended


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "line",
    ["s,m,t\n", "time,set by operator\n", "time,,overload\n", "t,,\n", "time [s],win\ntime [s],winch [m],rope [kN]\n"],
)
def test_units_remarks_and_a_torn_header_before_a_good_one_end_no_source(tmp_path, of, line):
    source = of(tmp_path, FIRST + line + "1,1,50\n")
    assert [row.time for row in all_of(source) if row.time == row.time] == [0.0, 1.0]


@pytest.mark.parametrize("of", [file, stream])
def test_half_a_header_at_the_end_of_a_file_is_no_header(tmp_path, of):
    source = of(tmp_path, FIRST + "time [s],winch [m],ro")
    assert [row.time for row in all_of(source) if row.time == row.time] == [0.0]


@pytest.mark.parametrize("of", [file, stream])
def test_a_header_whose_columns_are_all_renamed_ends_the_source(tmp_path, of):
    source = of(tmp_path, FIRST + "time [s],A,B\n1,1,50\n")
    with pytest.raises(SourceStopped, match="there is no column 'winch'"):
        while not source.ended:
            source.poll(0.05)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "later",
    [
        "time [s],pressure [bar],flow [m3/h],temperature [degC],mode\n1,210.5,3.2,41,1\n",
        "time [s],Winch [m],Rope [kN],extra\n1,7,8,9\n",
        "time,pressure,,flow\n1,7,,8\n",
        "Time [s],Winch [m],Rope [kN]\n1,7,8\n",
        "t [s],A,B\n1,7,8\n",
        "time [s],A\n1,7\n",
        "time [s],A\n1,7,8\n",
        "time,A\n1,7\n",
        "time,A\n# a comment\nno row\n1,7\n",
        "timestamp;A\n1,0;7,0\n",
        "time;A;B\n1;7;8\n",
        "seconds [s],A [bar]\n1,7,8\n",
        "Pressure [bar],Flow [m3/h],Clock\n7,8,1\n",
        "Datum,Druck,Fluss,Temperatur\n1,210.5,3.2,41\n",
    ],
)
def test_a_header_whose_columns_all_have_other_names_ends_the_source_whatever_their_number(tmp_path, of, later):
    source = of(tmp_path, FIRST + later)
    found = []
    with pytest.raises(SourceStopped, match="there is no column 'winch'"):
        while not source.ended:
            found += [row] if (row := source.poll(0.05)) is not None else []
    assert [(row.time, *row.values.values()) for row in found if row.time == row.time] == [(0.0, 1.0, 50.0)]


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "line",
    [
        "time,set by operator", "time,,overload", "t,,", "time", "overload", "s,m,t", "-,m,t", "error,lost", "a,b,c,d",
        "time,set by operator\nerror,lost", "pump [1],pump [2],-",
    ],
)  # fmt: skip
def test_a_remark_of_another_width_is_none_and_needs_no_word(tmp_path, of, line):
    source = of(tmp_path, FIRST + line + "\n1,1,50\n2,1,50\n")
    rows = [(row.time, *row.values.values()) for row in all_of(source) if row.time == row.time]
    assert rows == [(0.0, 1.0, 50.0), (1.0, 1.0, 50.0), (2.0, 1.0, 50.0)]
    assert not source.notes


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("units", ["s,m,kN", "s,m,API", "UTC,m,kN", "-,spm,t", "[s],[m],[kN]"])
def test_units_directly_below_a_header_end_no_source(tmp_path, of, units):
    source = of(tmp_path, FIRST.replace("\n", f"\n{units}\n", 1))
    assert [row.time for row in all_of(source) if row.time == row.time] == [0.0] and not source.notes


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("units", ["s,m,t", "UTC,m,t", "[s],[m],[t]"])
def test_a_tonne_below_a_header_of_kilonewtons_contradicts_it_and_is_no_stamp(tmp_path, of, units):
    with pytest.raises(SceneError, match=r"\[kN\] in the header and t in the line below it; give one of both"):
        all_of(of(tmp_path, FIRST.replace("\n", f"\n{units}\n", 1)))


@pytest.mark.parametrize("of", [file, stream])
def test_readings_are_missing_while_no_row_shows_whether_a_line_was_a_header_or_a_remark(tmp_path, of):
    source = of(tmp_path, FIRST + "time,overload\n1,7,\n2,7,\n3,1,50\n4,1,\n")
    rows = [(row.time, *row.values.values()) for row in all_of(source) if row.time == row.time]
    missing = float("nan")
    expected = [
        (0.0, 1.0, 50.0),
        (1.0, missing, missing),
        (2.0, missing, missing),
        (3.0, 1.0, 50.0),
        (4.0, 1.0, missing),
    ]
    assert str(rows) == str(expected)
    assert [note for note in source.notes if ":3: a new header, or a remark?" in note] == source.notes != []


def test_lines_that_are_all_shorter_than_the_header_are_read_also_behind_a_remark_as_short(tmp_path):
    first = "time [s],winch [m],rope [kN],mode,text\n0,1,50\n1,1,50\n"
    source = file(tmp_path, first + "error,winch,lost\n2,1,50\n")
    assert [row.time for row in all_of(source) if row.time == row.time] == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("of", [file, stream])
def test_a_line_without_a_stamp_is_no_header_even_where_it_names_a_column(tmp_path, of):
    source = of(tmp_path, FIRST + "time,1,50\nerror,winch,lost\n1,1,50\n")
    assert [row.time for row in all_of(source) if row.time == row.time] == [0.0, 1.0]
    assert not source.notes


def test_what_stands_for_none_is_told_by_the_header_of_its_own_row(tmp_path):
    source = file(tmp_path, FIRST + "time [s],winch [m],rope [N]\n1,1,-999.25\n")
    rows = Rows(list(UNITS))
    rows.factors = source.factors
    for row in all_of(source):
        rows.add(row.time, row.values)
    assert rows.counts["with a reading that stands for none (-999.25)"] == 1


def values(source):
    """Stamp, winch and rope of the rows that have a stamp."""
    return [(row.time, *row.values.values()) for row in all_of(source) if row.time == row.time]


ROWS = [(0.0, 1.0, 50.0), (1.0, 2.0, 51.0)]


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("header", "below"),
    [
        ("time,winch,rope", "Time [s],Rope paid out [m],Rope tension [kN]"),
        ("time,winch,rope", "Time,Rope paid out,Rope tension"),
        ("time,winch,rope", "Elapsed (s),Paid out (m),Tension (kN)"),
        ("time,winch,rope", "Time,Rope paid out,Rope tension\ns,m,kN"),
        ("time,winch,rope", "Time [s],Rope paid out [m],Rope tension [kN]\ns,m,kN"),
        ("time,winch,rope", "s,m,kN\nTime,Rope paid out,Rope tension"),
        ("time;winch;rope", "Time;Rope paid out;Rope tension"),
        ("time [s],winch [m],rope [kN]", "Time [s],Winch [m],Rope [kN]"),
        ("time [s],winch [m],rope [kN]", "TIME [S],WINCH [M],ROPE [KN]"),
        ("time,winch,rope", "TIME [S],WINCH [M],ROPE [KN]"),
    ],
)
def test_a_second_line_of_titles_below_the_header_describes_its_columns_and_ends_no_source(tmp_path, of, header, below):
    rows = "0,1,50\n1,2,51\n".replace(",", ";" if ";" in header else ",")
    source = of(tmp_path, f"{header}\n{below}\n{rows}")
    assert values(source) == ROWS
    assert len(source.notes) == 1 and "describes its columns" in source.notes[0]


def described(second, header="time [s],rope,tension [kN]", unit="N"):
    """The header of a table with a second line of titles, for the column `rope` in a unit of the map."""
    return Header(header, ("rope",), "", "rows.csv", {"rope": unit}).next_header(second, 2)


@pytest.mark.parametrize("second", ["TIME [S],SEIL [KN],KRAFT [KN]", "Zeit [s],Seil [kN],Kraft [kN]"])
def test_a_unit_in_capitals_in_a_second_line_of_titles_is_that_of_another_column_where_it_has_none(second):
    found = described(second)
    assert found.factors == {"rope": 1000.0} and len(found.notes) == 1


def test_a_unit_in_capitals_is_that_of_its_own_column_before_that_of_another():
    assert described("TIME [S],SEIL [MN],KRAFT [MN]", "time [s],rope,tension [mN]", "MN").factors == {"rope": 1.0}


@pytest.mark.parametrize("unit", ["KN", "Kn"])
def test_a_unit_that_no_one_knows_in_a_second_line_of_titles_is_told_though_another_column_has_it(unit):
    found = described(f"Zeit [s],Seil [{unit}],Kraft [kN]")
    assert found.factors == {"rope": 1.0}
    assert any(f"[{unit}] is no known unit: 'rope' is read as without this line" in note for note in found.notes)


@pytest.mark.parametrize("of", [file, stream])
def test_the_stamp_may_have_its_name_in_a_line_of_units(tmp_path, of):
    text = "timestamp,winch,rope\ntime,m,kN\n1970-01-01T00:00:00Z,1,50\n1970-01-01T00:00:01Z,2,51\n"
    assert values(of(tmp_path, text)) == ROWS


@pytest.mark.parametrize("of", [file, stream])
def test_a_description_of_columns_gives_their_units_where_the_header_has_none(tmp_path, of):
    source = of(tmp_path, "time,winch,rope\nTime [ms],Paid out [cm],Tension [N]\n0,100,50000\n1000,200,51000\n")
    assert values(source) == ROWS and source.factors == {"winch": 0.01, "rope": 0.001}


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time,winch,rope\nTime [s],Paid out [m],Mass [t]\n", "'t' is a unit of another quantity"),
        ("time,winch,rope [kN]\nTime [s],Paid out [m],Tension [N]\n", r"\[kN\] in the header and N in the line below"),
        ("time [s],winch,rope\nTime [ms],Paid out [m],Tension [kN]\n", r"\[s\] in the header and ms in the line below"),
        ("time,winch,rope\nTime [s],Paid out [m],Tension [kN]\ns,m,N\n", r"\[kN\] in the header and N in the line"),
        ("time [ms],winch,rope\ns,m,kN\n", r"\[ms\] in the header and s in the line below"),
    ],
)
def test_a_description_or_units_that_contradict_the_header_or_the_map_are_refused(tmp_path, of, text, said):
    with pytest.raises(SceneError, match=said):
        all_of(of(tmp_path, text + "0,1,50\n"))


@pytest.mark.parametrize("of", [file, stream])
def test_the_name_of_the_stamp_in_a_line_of_units_leaves_the_unit_of_the_header(tmp_path, of):
    assert values(of(tmp_path, "time [ms],winch,rope\ntime,m,kN\n0,1,50\n1000,2,51\n")) == ROWS


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "remark",
    [
        "Crew change (day)", "Pause (h)", "shift change [min]", "pause [min],", "logger restarted at time [h]",
        "event [s],crane stop", "Operator Smith (A), deputy Jones (B)", "Alarm: overload [kN], winch [m]",
        "Operator Smith (A); deputy Jones (B)", "time [s]", "rope", "NaN,NaN,NaN", "h [m],rope [kN]",
    ],
)  # fmt: skip
def test_a_remark_with_brackets_that_names_no_stamp_ends_no_source_before_rows_with_more_cells(tmp_path, of, remark):
    source = of(tmp_path, f"{FIRST}{remark}\n1,1,50\n2,1,50\n")
    assert values(source) == [(0.0, 1.0, 50.0), (1.0, 1.0, 50.0), (2.0, 1.0, 50.0)]
    assert not source.notes


@pytest.mark.parametrize("remark", ["Smith (A), Jones (B)", "Alarm: overload [kN], winch [m]"])
def test_a_remark_with_commas_ends_no_table_of_semicolons_with_decimal_commas(tmp_path, remark):
    source = file(tmp_path, f"time [s];winch [m];rope [kN]\n0;1,0;50\n{remark}\n1;2,0;51\n")
    assert values(source) == ROWS


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("later", ["event [s],A\n1,7\n", "load [t],wind [m/s]\n7,8\n", "Load [t];Wind [m/s]\n7;8\n"])
def test_a_line_with_units_and_fewer_cells_ends_the_source_where_rows_have_no_more(tmp_path, of, later):
    source = of(tmp_path, FIRST + later)
    with pytest.raises(SourceStopped, match="If that line is a remark, begin it with #, or delete it"):
        all_of(source)


FIVE = "time [s],winch [m],rope [kN],mode,wind\n0,1,50,2,7\n1,1,50,2\n2,1,50,2,7\n"


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("remark", ["stop, by operator, reason, fog", "NaN,NaN,NaN,NaN"])
def test_a_remark_ends_no_source_before_rows_as_short_as_some_were_before(tmp_path, of, remark):
    source = of(tmp_path, f"{FIVE}{remark}\n3,1,50,2\n4,1,50,2\n5,1,50,2,7\n")
    assert values(source) == [(float(k), 1.0, 50.0) for k in range(6)] and not source.notes


@pytest.mark.parametrize("of", [file, stream])
def test_the_first_row_that_lacks_its_last_cells_behind_a_remark_of_as_many_has_its_readings_missing(tmp_path, of):
    source = of(tmp_path, f"{FIVE}stop, by operator, fog\n3,1,50\n4,1,50,2,7\n")
    found = values(source)
    assert [row[0] for row in found] == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert str(found[3][1:]) == "(nan, nan)" and found[4] == (4.0, 1.0, 50.0)
    assert len(source.notes) == 1 and ":5: a new header, or a remark?" in source.notes[0]


@pytest.mark.parametrize("of", [file, stream])
def test_a_second_such_row_shows_a_header_and_ends_the_source(tmp_path, of):
    source = of(tmp_path, f"{FIVE}Datum,Druck,Fluss\n3,7,8\n4,7,8\n")
    found = []
    with pytest.raises(SourceStopped, match="there is no column 'winch'"):
        while not source.ended:
            found += [row] if (row := source.poll(0.05)) is not None else []
    assert str([row.values["rope"] for row in found if row.time >= 3.0]) == "[nan]"


@pytest.mark.parametrize("of", [file, stream])
def test_rows_as_short_as_a_line_that_names_a_stamp_have_readings_missing_while_longer_ones_may_come(tmp_path, of):
    source = of(tmp_path, f"{FIVE}time,by operator,reason,fog\n3,1,50,2\n4,1,50,2\n5,1,50,2,7\n")
    found = values(source)
    assert str([row[2] for row in found]) == "[50.0, 50.0, 50.0, nan, nan, 50.0]"


@pytest.mark.parametrize("of", [file, stream])
def test_no_source_is_blind_without_end_where_no_row_can_show_whether_a_line_was_a_header(tmp_path, of):
    first = "time [s],winch [m],rope [kN],mode,text\n0,1,50\n1,1,50\n"
    with pytest.raises(SourceStopped, match="there is no column 'winch'"):
        all_of(of(tmp_path, first + "time,by operator,fog\n2,1,50\n3,1,50\n"))


@pytest.mark.parametrize("of", [file, stream])
def test_half_a_row_behind_a_remark_of_as_many_cells_has_its_last_reading_missing(tmp_path, of):
    text = "time [s],winch [m],rope [kN],mode\n0,1,50,2\nbad,bad,bad\n1,1,5\n2,1,50,2\n"
    assert str(values(of(tmp_path, text))) == "[(0.0, 1.0, 50.0), (1.0, 1.0, nan), (2.0, 1.0, 50.0)]"


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "text",
    [
        "time,winch,rope\nTension,Time,Paid out\n50,0,1\n",
        "time,winch,rope\ntime,overload\n1,7,\nTime,Paid out,Tension\n2,7,8\n",
    ],
)
def test_a_line_in_another_order_or_behind_a_row_in_doubt_is_no_description(tmp_path, of, text):
    with pytest.raises(SourceStopped, match="there is no column 'winch'"):
        all_of(of(tmp_path, text))


@pytest.mark.parametrize("of", [file, stream])
def test_rows_in_doubt_before_any_other_row_end_the_source_in_plain_words(tmp_path, of):
    with pytest.raises(SourceStopped, match=r"known: Druck, time\. If that line is a remark, begin it with #, or "):
        all_of(of(tmp_path, "time,winch,rope\ntime,Druck\n1,7,\n2,7\n"))


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    "text",
    ["sep=;\ntime;winch;rope\n0;1;50\n1;2;51\n", "time, [s];winch;rope\n0;1;50\n1;2;51\n"]
    + ['"time", "winch", "rope"\n0, 1, 50\n1, 2, 51\n', "time, winch, rope\n0, 1, 50\n1, 2, 51\n"],
    ids=["of a spreadsheet", "a comma in a title", "blanks before quotes", "blanks"],
)
def test_headers_as_spreadsheets_and_scripts_write_them_are_read(tmp_path, of, text):
    assert values(of(tmp_path, text)) == ROWS


def test_a_file_in_windows_1252_is_read_as_tables_of_scenes_are(tmp_path):
    (tmp_path / "r.csv").write_bytes("time;Höhe [°]\n0;180\n".encode("cp1252"))
    (row,) = all_of(CsvFile(tmp_path / "r.csv", ["Höhe"], units={"Höhe": "rad"}))
    assert row.values["Höhe"] == pytest.approx(3.14159265)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("first", "line"),
    [
        ("winch,time,rope\n1,0,50\n", "2,aux winch,time,rope\n9,1,51\n"),
        ("time,winch,rope\n0,1,50\n", "1,2time,A,B\n2,7,8\n"),
        ("winch,rope,time\n1,50,0\n", "8rope,winch,time\n51,9,1\n"),
    ],
    ids=["a word before another title", "other names", "half a number before another title"],
)
def test_behind_a_header_that_begins_nowhere_rows_are_left_out_and_told_until_one_comes_on_a_line_of_its_own(
    tmp_path, of, first, line
):
    """`aux winch` behind half a row is the title of another column; one such line ended the source."""
    source = of(tmp_path, first + line + "time,winch,rope\n5,2,60\n")
    assert values(source) == [(0.0, 1.0, 50.0), (5.0, 2.0, 60.0)]
    assert source.refused == 1 and any("in the midst of a row" in note for note in source.notes)
