"""Which columns of a file are the times and the values of a table: one that is not clear is refused, never chosen."""

import pytest
from pydantic import TypeAdapter

from tautline.scene.errors import SceneError
from tautline.scene.functions import places, time_function
from tautline.scene.reading.columns import Columns


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
