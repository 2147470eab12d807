"""A line of units below the header says what they would say in brackets in the header."""

import io

import pytest
from twin.sources.test_sources_of_data import all_of, written

from tautline.scene.errors import SceneError
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.record import SourceStopped
from tautline.twin.sources.stream import Stream

UNITS = {"winch": "m", "heave": "m", "rope": "kN"}


def file(tmp_path, text):
    return CsvFile(written(tmp_path / "r.csv", text), list(UNITS), units=UNITS)


def stream(_, text):
    return Stream(io.StringIO(text), list(UNITS), units=UNITS)


def rows_of(source):
    return [(row.time, *row.values.values()) for row in all_of(source) if row.time == row.time]


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("head", "row"),
    [
        ("time,winch,heave,rope\ns,m,m,N\n", "2,1,3,4000\n"),
        ("time;winch;heave;rope\n[ms];[cm];[m];[kN]\n", "2000;100;3;4\n"),
        ("time,winch,heave,rope,remark\nUTC,m,-,N,\n", "2,1,3,4000,x\n"),
        ("time,winch,heave [cm],rope\ns,m,,N\n", "2,1,300,4000\n"),
        ("time,winch,heave [m],rope\ns,m,meter,N\n", "2,1,3,4000\n"),
    ],
)
def test_units_in_the_line_below_the_header_are_those_of_the_columns(tmp_path, of, head, row):
    source = of(tmp_path, head + row)
    assert rows_of(source) == [(2.0, 1.0, 3.0, 4.0)]
    assert source.factors["rope"] == (1e-3 if ",N" in head else 1.0) and source.refused == 0 and not source.notes


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("time,winch,heave,rope\ns,m,m,m\n", r"its unit is \[m\], and the map says kN"),
        ("time,winch,heave,rope [kN]\ns,m,m,N\n", r"the unit is \[kN\] in the header and N in the line below it"),
    ],
)
def test_units_below_a_header_that_contradict_the_map_or_the_header_are_refused(tmp_path, of, head, said):
    with pytest.raises(SceneError, match=said):
        all_of(of(tmp_path, head + "0,1,1,1\n"))


@pytest.mark.parametrize("of", [file, stream])
def test_units_below_a_header_that_comes_later_hold_from_there_or_end_the_source(tmp_path, of):
    first, again = "time,winch,heave,rope\n0,1,2,3\n", "time,winch,heave,rope\n"
    assert rows_of(of(tmp_path, first + again + "s,m,m,N\n1,1,2,3000\n"))[1] == (1.0, 1.0, 2.0, 3.0)
    source = of(tmp_path, first + again + "s,m,m,m\n1,1,2,3000\n")
    with pytest.raises(SourceStopped, match="and the map says kN"):
        while not source.ended:
            source.poll(0.05)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("line", ["begun,by,the,mate\n", ",,,\n", "s,2,m,N\n", "time,winch,heave,rope\n"])
def test_another_line_below_the_header_gives_no_units(tmp_path, of, line):
    assert rows_of(of(tmp_path, f"time,winch,heave,rope\n{line}0,1,2,3\n"))[0] == (0.0, 1.0, 2.0, 3.0)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(
    ("between", "told", "rope"),
    [
        ("time,winch,heave,rope\ns,m,m,N\n", ["r.csv:4: other units than before"], 4.0),
        ("time,winch,heave,rope\ns,m,m,kN\n", [], 4000.0),
        ("time,winch,heave,rope [N]\ns,m,m,N\n", ["r.csv:3: a new header"], 4.0),
        ("time,winch,heave,rope\n", [], 4000.0),
    ],
)
def test_units_that_change_midway_by_a_line_of_units_are_told(tmp_path, of, between, told, rope):
    """The titles come without units, which alone say nothing new: the line behind them does."""
    source = of(tmp_path, "time [s],winch [m],heave [m],rope [kN]\n1,1,3,4\n" + between + "2,1,3,4000\n")
    assert rows_of(source) == [(1.0, 1.0, 3.0, 4.0), (2.0, 1.0, 3.0, rope)]
    notes = [note for note in source.notes if "before" in note or "new header" in note]
    assert len(notes) == len(told) and all(one[5:] in note for one, note in zip(told, notes, strict=True))


@pytest.mark.parametrize("of", [file, stream])
def test_a_line_of_units_that_takes_back_what_its_titles_changed_is_told(tmp_path, of):
    text = "time,winch,heave,rope [N]\n1,1,3,4000\ntime,winch,heave,rope\ns,m,m,N\n2,1,3,4000\n"
    source = of(tmp_path, text)
    assert [row[-1] for row in rows_of(source)] == [4.0, 4.0]
    assert ":3: a new header" in " ".join(source.notes)
    assert ":4: the units of before again" in " ".join(source.notes)
