"""Which columns of a file are the times and the values of a table: one that is not clear is refused, never chosen."""

import pytest
from pydantic import TypeAdapter

from crane.model.handles import bending_told
from crane.scene.scene import CraneScene
from tautline.scene.errors import SceneError
from tautline.scene.functions import places, time_function
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.document import Document

CRANE_OF_TABLE = """\
rope: {mass_per_length: 5.5 kg/m, axial_stiffness: 80 MN, diameter: 36 mm, damping: 10 ms}
bodies: [{name: load, mass: 5 t, position: [10.2, 0, 0]}]
path:
  - drum: {name: winch, center: [0, 0, 10], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: load}
vessel: {reference: [0, 0, 0], motion: {heave: {table: {file: record.csv, column: COLUMN}}}}
mesh: {elements_per_span: 4}
solver: {step: 2 ms, end: 20 s}
output: {interval: 10 ms}
"""


def found(folder, text, asked=None):
    """Places of time and value in a file."""
    (folder / "record.csv").write_text(text)
    return places(Columns(folder / "record.csv"), asked)


UNCLEAR = {
    "a height before the speed": ("time,hook_height,speed\n0,1,2\n", "hook_height, speed", "`column: speed`"),
    "motions of a vessel": ("t,surge,sway,heave\n0,1,2,3\n", "surge, sway, heave", "`column: heave`"),
    "numbers of rows": ("index,time,speed\n0,0,1\n", "index, speed", "`column: index` or `column: speed`"),
    "no header": ("0,0.0,1\n1,0.1,2\n", "has 3 columns and no header", "time,value"),
    "no column called time": ("index,seconds,speed\n0,0,1\n", "none is called time: index, seconds, speed", "`time`"),
    "two times": ("time,time,speed\n0,0,1\n", "2 columns are called 'time'", "another name"),
    "three columns and one name": (",speed,\n0,1,2\n", "gives no name to column 1", "such as time,value"),
    "two values": ("time,value,value\n0,1,2\n", "2 columns are called 'value'", "another name"),
}


@pytest.mark.parametrize(("text", "cause", "cure"), UNCLEAR.values(), ids=UNCLEAR)
def test_a_file_in_which_several_columns_may_be_meant_is_refused_with_their_names(text, cause, cure, tmp_path):
    with pytest.raises(SceneError) as error:
        found(tmp_path, text)
    problem = error.value.problems[0]
    assert cause in problem.cause and cure in problem.cure and problem.line == 1


CLEAR = {
    "one column beside time": ("time,speed\n0,1\n", None, (0, 1)),
    "time behind": ("speed,time\n0,1\n", None, (1, 0)),
    "no header": ("0,1\n1,2\n", None, (0, 1)),
    "separators at the ends": ("0,1,\n1,2,\n", None, (0, 1)),
    "an empty title": ("time,speed,\n0,1,\n", None, (0, 1)),
    "numbers of rows without a title": (",time,speed\n0,0,1\n", None, (1, 2)),
    "one called value": ("time,tension,value\n0,1,2\n", None, (0, 2)),
    "value first": ("value,seconds\n0,1\n", None, (1, 0)),
    "times without a name": (",speed\n0,1\n1,2\n", None, (0, 1)),
    "units only": ("[s],[m/s]\n0,1\n1,2\n", None, (0, 1)),
    "a value with a unit only": ("t (s),(m)\n0,1\n1,2\n", None, (0, 1)),
    "time with its unit as a word": ("time_s,hook_height_m,speed_m_s\n0,1,2\n", "speed_m_s", (0, 2)),
    "spaces": ("Time s;a;b\n0;1;2\n", "b", (0, 2)),
    "one word": ("a,TimeS,b\n0,1,2\n", "b", (1, 2)),
    "a stamp": ("Timestamp,a,b\n0,1,2\n", "b", (0, 2)),
    "seconds behind numbers of rows": ("index,seconds,speed\n0,0,2\n1,.1,2\n", "speed", (1, 2)),
    "another language": ("Zeit [s],Weg [m],v [m/s]\n0,1,2\n", "v", (0, 2)),
    "only the first grows": ("Zeit;Weg;v\n0,0;1;2\n0,1;1;3\n", "v", (0, 2)),
    "times without a name beside two columns": (",speed,depth\n0,1,2\n1,2,2\n", "speed", (0, 1)),
    "one that is asked for": ("time [s],hook_height [m],Speed [m/s]\n0,1,2\n", "speed", (0, 2)),
}


@pytest.mark.parametrize(("text", "asked", "expected"), CLEAR.values(), ids=CLEAR)
def test_the_columns_of_a_file_are_found_where_they_are_clear(text, asked, expected, tmp_path):
    assert found(tmp_path, text, asked) == expected


def test_a_time_that_is_not_called_so_is_refused_where_another_column_grows_too(tmp_path):
    with pytest.raises(SceneError, match="none is called time"):
        found(tmp_path, "index,Zeit,speed\n0,0,1\n1,0.1,3\n2,0.2,2\n", "speed")


UNITS = {
    "time_ms": 1e-3, "Time ms": 1e-3, "TimeMs": 1e-3, "timems": 1e-3, "t_ms": 1e-3, "timestamp_ms": 1e-3,
    "time_millis": 1e-3, "time_us": 1e-6, "time_\u00b5s": 1e-6, "t_ns": 1e-9, "time_min": 60.0, "time_h": 3600.0,
    "elapsed_ms": 1e-3, "t [ms]": 1e-3, "time_ms [s]": 1.0, "time": 1.0, "time_s": 1.0, "Zeit": 1.0,
}  # fmt: skip


@pytest.mark.parametrize(("head", "factor"), UNITS.items(), ids=UNITS)
def test_times_are_in_the_unit_at_the_end_of_their_name(head, factor, tmp_path):
    """Those of `time_ms` were taken for seconds, and the motion for a thousandth of what it was, without a word."""
    (tmp_path / "record.csv").write_text(f"{head},value\n0,1\n40,2\n", encoding="utf8")
    table = {"table": {"file": "record.csv"}}
    read = TypeAdapter(time_function("m", of="length"))
    (made,) = (read.validate_python(table, context={"folder": tmp_path}),)
    assert made.time == pytest.approx((0.0, 40.0 * factor), rel=1e-12)


def test_a_time_with_its_unit_in_its_name_is_found_among_others(tmp_path):
    assert found(tmp_path, "index,time_ms,speed\n0,0,1\n", "speed") == (1, 2)
    assert found(tmp_path, "time_ms,time,speed\n0,0,1\n", "speed") == (1, 2)


# -- what a header means, and what it does not

HEADS = {
    "time-min": 60.0, "Time/ms": 1e-3, "time/min": 60.0, "time-ms": 1e-3, "minutes": 60.0, "hours": 3600.0, "min": 60.0,
    "ms": 1e-3, "milliseconds": 1e-3, "t ms": 1e-3, "time in ms": 1e-3, "timemin": 60.0, "time_d": 86400.0,
    "time_days": 86400.0, "days": 86400.0, "TIME_MIN": 60.0, "TimeInMs": 1e-3, "time, ms": 1e-3, "sim_time_ms": 1e-3,
    "Uhrzeit_min": 60.0, "t-us": 1e-6, "Time [minutes]": 60.0, "Time [days]": 86400.0, "time (hrs)": 3600.0,
    "seconds": 1.0, "time utc": 1.0, "depth": 1.0, "x_s": 1.0, "T": 1.0,
    "time*ms": 1e-3, "time|ms": 1e-3, "Time (rel) [ms]": 1e-3,
}  # fmt: skip


@pytest.mark.parametrize(("head", "factor"), HEADS.items(), ids=HEADS)
def test_units_of_time_are_read_however_they_are_written(head, factor, tmp_path):
    """Seconds were read of all of these, silently, and a hoist of minutes was made in as many seconds."""
    (tmp_path / "record.csv").write_text(f"{head};value\n0;1\n40;2\n", encoding="utf8")
    read = TypeAdapter(time_function("m", of="length"))
    made = read.validate_python({"table": {"file": "record.csv"}}, context={"folder": tmp_path})
    assert made.time == pytest.approx((0.0, 40.0 * factor), rel=1e-12) and made.value == (1.0, 2.0)


DOUBTFUL = (
    "h", "d", "time_m", "time_wk", "time_start", "Time-xyz", "timestamp_iso", "time [ms]_x", "t_min", "t_h", "T_min",
    "T_h", "surge_min", "x_h", "seconds_h",
)  # fmt: skip


@pytest.mark.parametrize("head", DOUBTFUL)
def test_a_time_whose_unit_is_not_understood_is_refused_and_never_taken_for_seconds(head, tmp_path):
    with pytest.raises(SceneError, match="not clear in which unit") as error:
        found(tmp_path, f"{head},speed\n0,1\n1,2\n")
    assert "time [min]" in error.value.problems[0].cure


@pytest.mark.parametrize("other", ["max", "p_max", "mean"])
def test_min_beside_max_is_a_least_value_and_no_time_in_minutes(other, tmp_path):
    with pytest.raises(SceneError, match="not clear in which unit"):
        found(tmp_path, f"min,{other}\n0,1\n1,2\n")


FIRST = (
    "elapsed,T_min", "elapsed,T_h", "elapsed,T", "Zeit,T_min", "clock,T_h", "t,T_min", "t_s,T_h", "time,t", "time,T_ms",
    "elapsed [s],T_min [kN]", "Elapsed time,t_min", "Zeit,period [h]", "time,days", "depth,T_min", "depth,min",
)  # fmt: skip


@pytest.mark.parametrize("header", FIRST)
def test_a_tension_or_a_temperature_is_not_taken_for_the_time_where_the_first_column_may_be_it(header, tmp_path):
    """`elapsed,T_min` was read with the tensions as minutes and the times as tensions."""
    assert found(tmp_path, f"{header}\n0,1\n1,2\n") == (0, 1)


@pytest.mark.parametrize("header", ["speed,t_ms", "speed,time/min", "value,elapsed", "Weg,Zeit", "speed,minutes"])
def test_a_later_column_is_the_time_where_only_it_is_called_so(header, tmp_path):
    assert found(tmp_path, f"{header}\n0,1\n1,2\n") == (1, 0)


BRACKETS = {
    "timestamp,elapsed [s],value": 1, "elapsed,time_ms [ms],value": 1, "seconds,Elapsed time (min),value": 1,
    "t [mm],elapsed [s],value": 1, "elapsed,t [kN],value": 0,
}  # fmt: skip


@pytest.mark.parametrize(("header", "place"), BRACKETS.items(), ids=BRACKETS)
def test_of_two_times_by_name_the_one_with_its_unit_in_brackets_is_meant(header, place, tmp_path):
    assert found(tmp_path, f"{header}\n0,1,2\n1,2,3\n") == (place, 2)


TWO = "time_s,time_min,value", "hour,min,value", "hour,sec,value", "elapsed,time_ms,value", "timestamp,seconds,value"


@pytest.mark.parametrize("header", TWO)
def test_two_columns_that_may_be_the_time_are_refused_with_the_cure(header, tmp_path):
    with pytest.raises(SceneError, match="not clear which column is the time") as error:
        found(tmp_path, f"{header}\n0,1,2\n1,2,3\n")
    assert "call the column of times `time`" in error.value.problems[0].cure


GROWING = "index,value,temp", "sample,value,quality", "depth,value,load", "run,value,load"


@pytest.mark.parametrize("header", GROWING)
def test_numbers_that_grow_and_are_not_called_a_time_are_not_taken_for_it(header, tmp_path):
    """Numbers of rows were taken for seconds, and a hoist was made in ten times its time."""
    with pytest.raises(SceneError, match="none is called time") as error:
        found(tmp_path, f"{header}\n0,3,2\n1,3,1\n2,2,1\n")
    assert "call the column of times `time`" in error.value.problems[0].cure


def test_a_table_asked_for_by_a_name_of_the_first_column_takes_the_second_for_the_time(tmp_path):
    assert found(tmp_path, "h,x\n0,1\n1,2\n", "h") == (1, 0)


# -- a column that is asked for as it stands in the header

RECORD = "Time (s),Heave (ft),Roll (deg),Load (kN),Load (t)\n0,1,2,3,4\n"


@pytest.mark.parametrize(
    ("asked", "place"),
    [("Heave (ft)", 1), ("heave [ft]", 1), ("Roll(deg)", 2), ("Heave", 1), ("Load (kN)", 3), ("Load (t)", 4)],
)
def test_a_column_is_found_by_its_whole_title_with_the_unit(asked, place, tmp_path):
    assert found(tmp_path, RECORD, asked) == (0, place)


def test_a_column_in_another_unit_than_it_is_asked_for_is_refused_at_the_key_of_the_scene(tmp_path):
    scene = CRANE_OF_TABLE.replace("COLUMN", '"Heave (m)"')
    (tmp_path / "record.csv").write_text(RECORD)
    with pytest.raises(SceneError) as error:
        CraneScene.read(Document.parse(scene, tmp_path / "scene.yaml"))
    (problem,) = error.value.problems
    assert problem.line == 7 and problem.key.endswith("heave.table.column") and problem.value == "Heave (m)"
    assert "'Heave (ft)'" in problem.cause and 'column: "Heave (ft)"' in problem.cure


# -- rows that are longer than the header

LONG = {
    "row names of R": ('"time","value"\n"1",0,5\n"2",40,6\n', 2, 2, 3, "row name"),
    "row names of R with tabs": ("time\tvalue\n1\t0\t5\n2\t40\t6\n", 2, 2, 3, "row.names = FALSE"),
    "decimal commas": ("time,x\n0,000,1,5\n40,000,2,5\n", 2, 2, 4, "decimal commas, put semicolons"),
    "some decimal commas": ("time,x\n0,1\n40,2,5\n", 3, 2, 3, "decimal commas, put semicolons"),
    "two lines in one": ("time;x;y\n0;1;2\n1;1;2\n2;13;1;2\n", 4, 3, 4, "two lines have run into one"),
    "no header": ("0;1\n1;2;3\n", 2, 2, 3, "two lines"),
}


@pytest.mark.parametrize(("text", "line", "columns", "cells", "cure"), LONG.values(), ids=LONG)
def test_a_row_with_more_cells_than_the_header_is_refused_with_both_counts(text, line, columns, cells, cure, tmp_path):
    """Numbers of rows were read as the times, and decimals of the times as the values, without a word."""
    with pytest.raises(SceneError, match=f"fills {cells} cells, and .* has {columns}") as error:
        found(tmp_path, text, None)
    problem = error.value.problems[0]
    assert cure in problem.cure and problem.line == line


REMARKS = (
    "time,x,state\n0,1,ON\n1,2,OFF, 2 stands\n",
    "time,x\n0,1\n1,2,ream\n",
    "time,x,note\n0,1,\n1,2,ream, 2 stands\n",
    "time;x\n0;1\n1;2;ream;stop\n",
)


@pytest.mark.parametrize("text", REMARKS)
def test_a_remark_beyond_the_header_in_some_rows_is_passed_over(text, tmp_path):
    (tmp_path / "record.csv").write_text(text)
    assert Columns(tmp_path / "record.csv").values(1, "m") == (1.0, 2.0)


def test_a_first_line_of_numbers_with_a_remark_is_no_header_and_is_not_lost(tmp_path):
    """The row was taken for the header, and the table began a row later without a word."""
    (tmp_path / "record.csv").write_text("0,1,start\n1,2\n2,3\n")
    with pytest.raises(SceneError, match="begins with numbers as a row does") as error:
        Columns(tmp_path / "record.csv")
    assert error.value.problems[0].line == 1


def test_a_header_whose_first_titles_are_numbers_is_one_where_the_row_below_has_numbers_in_all_cells(tmp_path):
    (tmp_path / "record.csv").write_text("5,10,Depth,Time\n1,2,3,0\n1,2,4,1\n")
    assert Columns(tmp_path / "record.csv").names == ["5", "10", "depth", "time"]


MOVED = ("time,x,note\n1,0,5,ok\n2,40,6,ok\n", "time,x,note\n0,1,ok\n1,2,5,ok\n", "time,x\n0,1\n1,2,5 m\n")


@pytest.mark.parametrize("text", MOVED)
def test_rows_too_long_whose_numbers_may_have_moved_are_refused_though_they_end_with_words(text, tmp_path):
    (tmp_path / "record.csv").write_text(text)
    with pytest.raises(SceneError, match="cells, and the header has"):
        Columns(tmp_path / "record.csv")


@pytest.mark.parametrize(
    "text", ["time,x\n0,1,\n1,2,,,\n", "time,x,\n0,1,\n1,2\n", "time,x,\n0,1,9\n1,2,9\n", "time;x\n0,5;1,5;\n1;2\n"]
)
def test_separators_at_the_ends_of_lines_are_no_cells_too_many(text, tmp_path):
    (tmp_path / "record.csv").write_text(text)
    assert Columns(tmp_path / "record.csv").values(1, "m")[1] == 2.0


FIRST_ROWS = {
    "a word behind the number": "0,1 start\n1,2\n2,3\n", "a star": "0,1*\n1,2\n2,3\n", "a dash": "0,-\n1,2\n2,3\n",
    "thousands": "0;1.234,5\n1;999,5\n2;3\n", "a time of the day": "0:00,1\n1,2\n2,3\n",
}  # fmt: skip


@pytest.mark.parametrize("text", FIRST_ROWS.values(), ids=FIRST_ROWS)
def test_a_first_row_of_two_cells_that_is_not_quite_numbers_is_no_header(text, tmp_path):
    """It was passed over without a word, and the value of the second row held from the start."""
    with pytest.raises(SceneError, match="is no number that can be read"):
        found(tmp_path, text)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_column_with_decimal_points_and_with_commas_is_refused(separator, tmp_path):
    """`1,001` beside `999.5` was read as 1.001."""
    (tmp_path / "record.csv").write_text("time;v\n0;999.5\n1;1,001\n".replace(";", separator))
    with pytest.raises(SceneError, match=r"v = 1,001: has a comma, and 999\.5 in line 2 has a point"):
        Columns(tmp_path / "record.csv").values(1, "m")


@pytest.mark.parametrize("first", ["0.0", "2.0E+00", "-0.5"])
def test_a_value_with_a_point_among_decimal_commas_is_read_where_neither_can_mark_thousands(first, tmp_path):
    """A file with `0.0` as its first value was refused, with untrue words of thousands."""
    (tmp_path / "record.csv").write_text(f"time;v\n0;{first}\n1;10,25\n2;1,001\n")
    assert Columns(tmp_path / "record.csv").values(1, "m") == (float(first), 10.25, 1.001)


@pytest.mark.parametrize("stamp", ["46023000011,574", "0"])
def test_days_times_a_million_under_time_ms_are_no_milliseconds(stamp, tmp_path):
    """As WinCC writes them: a second is 11.574 of `Time_ms`, and was read as 0.0116 s."""
    text = f"VarName;TimeString;VarValue;Validity;Time_ms\nv;01.01.2026 00:00:01;-0,667;1;{stamp}\n"
    with pytest.raises(SceneError, match="days of a spreadsheet"):
        found(tmp_path, text, "VarValue")
    assert found(tmp_path, text.replace("Time_ms", "Time [ms]"), "VarValue") == (4, 2)


@pytest.mark.parametrize("standing", [4, 6, 9])
def test_a_remark_behind_a_column_that_is_mostly_a_word_and_sometimes_a_number_is_passed_over(standing, tmp_path):
    """A machine that stands most of the time shows `Off`: the whole file was refused."""
    rows = "".join(f"{k},{k / 10},{'Off' if k % 10 < standing else 12.5}\n" for k in range(40))
    assert found(tmp_path, f"time,heave,rpm\n{rows}40,4,12.5,STOP\n", "heave") == (0, 1)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "time,x,load,note\n0,5,100,\n1,2,7,300,\n3,7,400,\n",
            "has 5 cells, and most rows have 4: two lines may have run",
        ),
        ("time;load\n0.5;998\n1.5;1,001\n", "0.5 in line 2 has a point: one of both may be a mark of thousands"),
        ("time;load\n0,5;998\n1,5;1.001\n", "0,5 in line 2 has a comma: one of both may be a mark of thousands"),
    ],
    ids=["two lines in one row", "a comma of thousands", "a point of thousands"],
)
def test_two_lines_in_one_row_and_marks_that_other_columns_contradict_are_refused(tmp_path, text, told):
    """Loads of 7 and of 1.001 were read, where 1001 and none was meant."""
    (tmp_path / "record.csv").write_text(text)
    with pytest.raises(SceneError) as caught:
        columns = Columns(tmp_path / "record.csv")
        columns.numbers(columns.index(["load"]), "load")
    assert told in str(caught.value)


def test_a_limit_on_bending_of_a_rope_without_a_diameter_is_answered_with_the_diameter():
    """`tension` was proposed."""
    scene = CraneScene.parse(open("data/hoist.yaml").read())
    bare = scene.model_copy(update={"rope": scene.rope.model_copy(update={"diameter": None})})
    assert "give rope.diameter" in bending_told(bare)["bending"] and not bending_told(scene)


@pytest.mark.parametrize("beside", ["2.5", "1.2E+05"])
def test_a_point_in_a_column_that_is_not_read_takes_no_decimal_comma_from_others(beside, tmp_path):
    """One note among decimal commas, and the table was refused for marks of thousands that it has not."""
    (tmp_path / "record.csv").write_text(f"time;v;note\n0,5;1,125;\n1,5;2,125;{beside}\n")
    columns = Columns(tmp_path / "record.csv")
    assert columns.values(1, "m") == (1.125, 2.125)
    assert columns.values(0, "s") == (0.5, 1.5)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_column_that_is_read_shows_marks_of_thousands_whichever_is_read_first(order, tmp_path):
    (tmp_path / "record.csv").write_text("time;v;note\n0.5;1,125;0,5\n1.5;2,125;0,5\n")
    columns = Columns(tmp_path / "record.csv")
    with pytest.raises(SceneError, match=r"1,125: has a comma, and 0\.5 in line 2 has a point"):
        [columns.values(place, "m") for place in order]
