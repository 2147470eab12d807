"""Which columns of a file are the times and the values of a table: one that is not clear is refused, never chosen."""

import pytest

from tautline.scene.errors import SceneError
from tautline.scene.functions import places
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
