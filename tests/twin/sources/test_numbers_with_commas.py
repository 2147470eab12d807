"""A comma within a number: a decimal comma where commas do not separate cells; else it may be one of thousands."""

import io

import pytest
from twin.sources.test_sources_of_data import all_of, written

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.stream import Stream


def source_of(of, tmp_path, text):
    if of == "file":
        return CsvFile(written(tmp_path / "r.csv", text), ["winch", "tension"])
    return Stream(io.StringIO(text), ["winch", "tension"])


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("cell", ["49,053", "1,234,567", "-49,1", "49,053.5"])
def test_a_number_with_a_comma_among_commas_is_left_out_and_this_is_told_once(tmp_path, of, cell):
    source = source_of(of, tmp_path, f'time,winch,tension\n0,1,"{cell}"\n1,2,"{cell}"\n2,3,50\n')
    rows = all_of(source)
    assert [row.values["winch"] for row in rows] == [1.0, 2.0, 3.0]
    assert [row.values["tension"] for row in rows if row.values["tension"] == row.values["tension"]] == [50.0]
    (note,) = source.notes
    assert f"column 'tension' has cells such as \"{cell}\"" in note and "mark of thousands" in note


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_stamp_with_a_comma_among_commas_is_none_and_a_date_with_one_is(tmp_path, of):
    text = 'time,winch,tension\n"1,234",1,2\n"2026-01-01T00:00:00,5Z",1,2\n'
    source = source_of(of, tmp_path, text)
    first, second = all_of(source)
    assert first.time != first.time and second.time == 1767225600.5
    assert "column 'time'" in source.notes[0] and len(source.notes) == 1


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_decimal_comma_is_one_where_commas_do_not_separate(tmp_path, of, separator):
    text = "time,winch,tension\n0.5,1,x\n".replace(",", separator).replace(".", ",").replace("x", "49,053")
    source = source_of(of, tmp_path, text)
    (row,) = all_of(source)
    assert (row.time, row.values["tension"]) == (0.5, 49.053) and not source.notes


DECIMALS = {
    "header": ("time [min]", "", 60.0), "header in ms": ("time [ms]", "", 1e-3), "name": ("time_ms", "", 1e-3),
    "line below": ("time", "min", 60.0),
}  # fmt: skip


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("separator", [";", "\t"])
@pytest.mark.parametrize(("title", "below", "factor"), DECIMALS.values(), ids=DECIMALS)
def test_stamps_with_decimal_commas_are_in_the_unit_of_their_column(tmp_path, of, separator, title, below, factor):
    """Minutes were read as seconds where they had a comma, and as minutes where they had none."""
    rows = [title + ";winch;tension", *([below + ";m;kN"] if below else []), "0;1;2", "0,5;1;2", "1;1;2", "1,5;1;2"]
    source = source_of(of, tmp_path, "\n".join(rows).replace(";", separator) + "\n")
    assert [row.time for row in all_of(source)] == pytest.approx([0.0, 0.5 * factor, factor, 1.5 * factor], rel=1e-12)


@pytest.mark.parametrize("of", ["file", "stream"])
def test_stamps_of_milliseconds_since_1970_with_a_decimal_comma_are_told_as_those_without(tmp_path, of):
    source = source_of(of, tmp_path, "time;winch;tension\n1764410000000,5;1;2\n")
    assert not [row for row in all_of(source) if row.time == row.time]
    assert len(source.notes) == 1 and "stamps such as 1764410000000 are no seconds" in source.notes[0]


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_column_with_points_has_no_decimal_commas_and_such_cells_are_left_out_and_told_once(tmp_path, of, separator):
    """`1,001` beside `999.5`, as thousands are written in English, was read as 1.001."""
    text = "time;winch;tension\n0;1,5;999.5\n1;2,5;1,001\n2;3,5;998\n3;4,5;1,002\n".replace(";", separator)
    source = source_of(of, tmp_path, text)
    assert str([tuple(row.values.values()) for row in all_of(source)]) == (
        "[(1.5, 999.5), (2.5, nan), (3.5, 998.0), (4.5, nan)]"
    )
    (note,) = source.notes
    assert "column 'tension' has cells such as '999.5' and '1,001'" in note


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_first_value_with_a_point_among_decimal_commas_is_no_mark_of_thousands(tmp_path, of):
    """`0.0`, as programs write a first value, made all cells behind it missing."""
    source = source_of(of, tmp_path, "time;winch;tension\n0;0.0;0.0\n1;10,25;50,5\n2;10,5;1,001\n")
    assert [tuple(row.values.values()) for row in all_of(source)] == [(0.0, 0.0), (10.25, 50.5), (10.5, 1.001)]
    assert not source.notes


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_mark_that_is_shown_to_be_decimal_wins_over_one_that_came_first(tmp_path, of):
    """`999.5` was left out behind `1,001`, which was read as 1.001 through the whole file."""
    source = source_of(of, tmp_path, "time\twinch\ttension\n0\t1\t1,001\n1\t1\t999.5\n2\t1\t1,002\n3\t1\t998.5\n")
    read = [row.values["tension"] for row in all_of(source)]
    assert [one for one in read[1:] if one == one] == [999.5, 998.5]
    (note,) = source.notes
    assert "cells such as '999.5' and '1,001'" in note and "were read as decimals before, and may be wrong" in note


BESIDE_COMMAS = {"version": "2.1", "clock": "18.25", "day": "01.02", "science": "1.2E+05"}


@pytest.mark.parametrize("of", ["file", "stream"])
@pytest.mark.parametrize("beside", BESIDE_COMMAS.values(), ids=BESIDE_COMMAS)
def test_a_point_in_a_column_that_nobody_asks_for_takes_no_decimal_comma_from_others(tmp_path, of, beside):
    """With stamps such as `0,5` all of the tension was left out as if it had marks of thousands."""
    source = source_of(of, tmp_path, f"time;winch;tension;fw\n0,5;1;1,125;{beside}\n1,5;1;2,125;{beside}\n")
    assert [row.values["tension"] for row in all_of(source)] == [1.125, 2.125]
    assert not source.notes


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_comma_in_a_column_that_nobody_asks_for_makes_no_decimal_of_thousands(tmp_path, of):
    source = source_of(of, tmp_path, "time;tension;winch;note\n0;1,001;999.5;0,5\n1;1,002;999.5;0,5\n")
    assert str([row.values["tension"] for row in all_of(source)]) == "[nan, nan]"
    assert "cells such as '999.5' and '1,001'" in source.notes[0]
