"""Units in the header of a table: converted to those of the map, or refused; in silence never taken for others."""

import io
import time as clock

import pytest

from tautline.scene.errors import SceneError
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.reading_units import factor_between
from tautline.twin.sources.stream import Stream


def file(tmp_path, header, units, cell="49053.0699"):
    path = tmp_path / "r.csv"
    path.write_text(f"time [s],{header}\n0,{cell}\n")
    return CsvFile(path, list(units), units=units)


def test_readings_in_another_unit_of_the_same_quantity_are_converted(tmp_path):
    source = file(tmp_path, "rope_tension [N]", {"rope_tension": "kN"})
    assert source.poll(0.0).values["rope_tension"] == pytest.approx(49.0530699, rel=1e-15)
    assert not source.notes


def test_a_stream_converts_as_a_file_does():
    source = Stream(io.StringIO("time,speed [rpm]\n0,60\n"), ["speed"], units={"speed": "Hz"})
    end = clock.monotonic() + 5.0
    while (row := source.poll(0.05)) is None and clock.monotonic() < end:
        pass
    assert row.values["speed"] == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize(
    ("header", "unit", "said"),
    [
        ("rope_tension [m]", "kN", r"its unit is \[m\], and the map says kN: 'm' is a unit of another quantity"),
        ("rope_tension (t)", "kN", "'t' is a unit of another quantity"),
        ("rope_tension [Hz]", "rad/s", "does not say whether turns or radians are counted"),
    ],
)
def test_a_unit_of_another_quantity_is_refused_with_file_column_and_cure(tmp_path, header, unit, said):
    with pytest.raises(SceneError, match=said) as refused:
        file(tmp_path, header, {"rope_tension": unit})
    text = str(refused.value)
    assert "r.csv:1: column 'rope_tension'" in text and f"write [{unit}] in the header" in text


@pytest.mark.parametrize("header", ["rope_tension", "rope_tension []", "rope_tension [-]", "rope_tension [kN]"])
def test_readings_without_a_unit_or_in_that_of_the_map_stay_to_the_last_bit(tmp_path, header):
    source = file(tmp_path, header, {"rope_tension": "kN"}, "0.1234567890123")
    assert source.poll(0.0).values["rope_tension"] == 0.1234567890123 and not source.notes


@pytest.mark.parametrize(
    ("header", "unit", "said"),
    [
        ("rope_tension [KNx]", "kN", "which is no known unit: its readings are taken in kN"),
        ("rope_tension [kN]", "", "and the map gives no unit: its readings are taken in SI units"),
    ],
)
def test_a_unit_that_says_nothing_is_told_and_the_reading_stays(tmp_path, header, unit, said):
    source = file(tmp_path, header, {"rope_tension": unit})
    assert said in source.notes[0] and source.poll(0.0).values["rope_tension"] == 49053.0699


@pytest.mark.parametrize(
    ("header", "asked", "factor"),
    [
        ("deg", "rad", 0.017453292519943295),
        ("Degrees", "deg", 1.0),
        ("klbf", "kN", 4.4482216152605),
        ("%", "kN/MN", 10.0),
    ],
)
def test_factors_between_units_are_exact(header, asked, factor):
    assert factor_between(header, asked) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("header", "column", "cells"),
    [
        ("time,winch,winch,rope", "winch", r"cell 2 \('winch'\), cell 3 \('winch'\)"),
        ("time,rope [N],winch,rope [kN]", "rope", r"cell 2 \('rope \[N\]'\), cell 4 \('rope \[kN\]'\)"),
        ("time,winch,rope,time", "time", r"cell 1 \('time'\), cell 4 \('time'\)"),
    ],
)
def test_a_column_that_is_twice_in_a_header_is_refused_with_both_places(tmp_path, header, column, cells):
    said = rf"there are 2 columns '{column}' in the header: {cells}; give each column a name of its own"
    text, units = f"{header}\n0,1,2,3\n", {"winch": "m", "rope": "kN"}
    path = tmp_path / "r.csv"
    path.write_text(text)
    with pytest.raises(SceneError, match=said):
        CsvFile(path, list(units), units=units)
    source = Stream(io.StringIO(text), list(units), units=units)
    with pytest.raises(SceneError, match=said):
        source.poll(5.0)


def test_a_column_that_is_twice_and_not_wanted_is_no_fault_and_a_whole_title_names_one_of_two(tmp_path):
    source = file(tmp_path, "spare,spare,rope [N],rope [kN]", {"rope [kN]": "kN"}, "1,2,3000,3")
    assert source.poll(0.0).values["rope [kN]"] == 3.0
