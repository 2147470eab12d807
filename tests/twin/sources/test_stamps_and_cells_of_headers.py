"""Tables of live data whose header does not say the unit of the stamps, or has fewer cells than the rows."""

import io
import json

import pytest
from twin.sources.test_sources_of_data import all_of, written

from tautline.scene.errors import SceneError
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.reading_units import OtherQuantity, factor_stated
from tautline.twin.sources.stream import Stream


def file(tmp_path, text, time=""):
    return CsvFile(written(tmp_path / "r.csv", text), ["a"], time)


def stream(_, text, time=""):
    return Stream(io.StringIO(text), ["a"], time)


def stamps(source):
    return [row.time for row in all_of(source)]


UNITS = {
    "TIME [MS]": 1e-3, "Time (Ms)": 1e-3, "TIME (MIN)": 60.0, "Time [Sec.]": 1.0, "Time [S]": 1.0, "time [ms]": 1e-3,
    "time_ms": 1e-3, "TimeMs": 1e-3, "t_ms": 1e-3, "Time/s": 1.0, "time_s": 1.0, "Elapsed Time (min)": 60.0,
    "time (UTC)": 1.0, "Time [-]": 1.0, "timestamp": 1.0, "time [h]": 3600.0,
    "Time (CST)": 1.0, "Time [Z]": 1.0, "Time [Europe/Berlin]": 1.0, "Time (PLC)": 1.0, "Timestamp (Unix ms)": 1e-3,
    "time_ms (PLC)": 1e-3, "Time_s (PLC)": 1.0, "time [n/a]": 1.0,
}  # fmt: skip


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("title", "factor"), UNITS.items(), ids=UNITS)
def test_stamps_are_in_the_unit_that_a_table_of_a_scene_would_have_them_in(tmp_path, of, title, factor):
    """`[MS]` and `time_ms` were read in seconds, and minutes of a crane in as many hours, without a word."""
    assert stamps(of(tmp_path, f"{title},a\n0,1\n40,2\n")) == pytest.approx([0.0, 40.0 * factor], rel=1e-12)


ASKED = {
    ("time_ms", "time_ms"): 1e-3, ("clock_ms", "clock_ms"): 1e-3, ("x", "x [MS]"): 1e-3, ("t_min", "t_min [min]"): 60.0,
    ("Time [m]", "Time [min]"): 60.0, ("time_ms [s]", "time_ms"): 1.0, ("seq", "seq"): 1.0,
    ("Time (ms) [UTC]", "Time (ms) [UTC]"): 1e-3, ("time (ms) rel", "time (ms) rel"): 1e-3,
    ("time (ms) rel", "time (ms) rel [min]"): 60.0, ("x (a) (b)", "x (a) (b) [ms]"): 1e-3,
}  # fmt: skip


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("pair", "factor"), ASKED.items(), ids=map(str, ASKED))
def test_stamps_that_the_map_names_are_in_the_unit_of_their_header_or_of_the_map_or_of_their_name(
    tmp_path, of, pair, factor
):
    title, asked = pair
    assert stamps(of(tmp_path, f"{title},a\n0,1\n40,2\n", asked)) == pytest.approx([0.0, 40.0 * factor], rel=1e-12)


def test_objects_have_their_stamps_in_the_unit_of_the_name_that_the_map_gives():
    text = "".join(json.dumps({"time_ms": stamp, "a": 1}) + "\n" for stamp in (0, 40))
    assert stamps(stream(None, text, "time_ms")) == [0.0, 0.04]


@pytest.mark.parametrize("of", [file, stream])
def test_a_stamp_that_the_map_does_not_name_is_told_once_with_what_its_numbers_count(tmp_path, of):
    """`Time_ms` of some loggers has days, and `Run Time (h)` may be the hours that a pump has run."""
    source = of(tmp_path, "Run Time (h),a\n0,1\n40,2\n")
    assert stamps(source) == [0.0, 144000.0]
    (note,) = source.notes
    assert "`Run Time` is taken as the time, and its numbers count 3600 s each" in note
    named = of(tmp_path, "Run Time (h),a\n0,1\n40,2\n", "Run Time (h)")
    assert stamps(named) == [0.0, 144000.0] and not named.notes


def test_the_cure_of_a_stamp_in_doubt_is_one_that_helps(tmp_path):
    with pytest.raises(SceneError) as error:
        stamps(file(tmp_path, "Time (rel) [m],a\n0,1\n40,2\n", "Time (rel) [m]"))
    asked = str(error.value).split('`time: "')[1].split('"')[0]
    assert stamps(file(tmp_path, "Time (rel) [m],a\n0,1\n40,2\n", asked)) == [0.0, 40.0]


DOUBTFUL = (
    "Time [m],",
    "Time [M],",
    "Time (m:s),",
    "Time (HH:MM:SS),",
    "Time [kN],",
    "Time [datetime],",
    "t_min,t_min",
    "time_m,time_m",
)


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("given", DOUBTFUL)
def test_numbers_as_stamps_in_a_unit_that_is_not_clear_are_refused_at_the_start(tmp_path, of, given):
    title, asked = given.split(",")
    with pytest.raises(SceneError, match=r"not clear in which unit .* \[s\]"):
        stamps(of(tmp_path, f"{title},a\n0,1\n40,2\n", asked))


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("title", ["Time (HH:MM:SS)", "Time [UTC]", "time [ISO 8601]", "Time [dd.mm.yyyy hh:mm]"])
def test_dates_need_no_unit_whatever_stands_in_the_brackets(tmp_path, of, title):
    rows = "1970-01-01T00:00:00Z,1\n1970-01-01T00:00:40Z,2\n"
    assert stamps(of(tmp_path, f"{title},a\n{rows}")) == [0.0, 40.0]


def test_an_end_of_a_name_that_is_not_understood_is_told_and_seconds_are_read(tmp_path):
    source = file(tmp_path, "time_x,a\n0,1\n40,2\n", "time_x")
    assert stamps(source) == [0.0, 40.0]
    (note,) = source.notes
    assert "Seconds are read" in note and '`time: "time_x [s]"`' in note


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("below", "factor"), [("MS,KN", 1e-3), ("ms,kN", 1e-3), ("Min.,kN", 60.0), ("UTC,kN", 1.0)])
def test_a_unit_of_time_below_the_header_may_be_in_capitals(tmp_path, of, below, factor):
    assert stamps(of(tmp_path, f"time,a\n{below.replace('KN', 'kN')}\n0,1\n40,2\n"))[-2:] == [0.0, 40.0 * factor]


# -- rows with more cells than the header

LONG = {
    "R": ('"time","a"\n"1",0,5\n"2",40,6\n', "fills 3 cells, and the header has 2.*row name"),
    "R with tabs": ("time\ta\n1\t0\t5\n2\t40\t6\n", "fills 3 cells, and the header has 2.*row.names = FALSE"),
    "R, one row": ('"time","a"\n"1",0,5\n', ":2: the row .* one cell less than this row"),
    "a decimal comma in a stamp": ("time,a\n1970-01-01 00:00:00,500,1\n", "has 2; if numbers have decimal commas"),
    "milliseconds behind a comma": ("time,b,a\n2026-01-01 00:00:00,100,10.01,Bad\n", "has 3; if numbers have decimal"),
    "row names and a missing value": ("time,b,a\n1,0.0,5.0,-\n2,1.0,6.0,7.0\n", "has 3.*row name"),
    "decimal commas": ("time,b,a\n0,00,0,00,49,05\n", "fills 6 cells, and the header has 3.*decimal commas"),
}


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize(("text", "said"), LONG.values(), ids=LONG)
def test_a_table_whose_rows_have_more_cells_than_its_header_is_refused_at_the_start(tmp_path, of, text, said):
    """Decimals of the stamps were read as the places of a winch: a load of 5 t weighed half a ton, in good health."""
    with pytest.raises(SceneError, match=said):
        stamps(of(tmp_path, text))


@pytest.mark.parametrize("of", [file, stream])
def test_a_row_that_two_lines_have_run_into_is_left_out_counted_and_told_once(tmp_path, of):
    source = of(tmp_path, "time,b,a\n0,1,2\n1,1,2\n2,1,43,1,2\n3,1,44,1,2\n5,1,2\n")
    rows = [(row.time, row.values["a"]) for row in all_of(source)]
    assert rows == [(0.0, 2.0), (1.0, 2.0), (5.0, 2.0)] and source.refused == 2
    (note,) = source.notes
    assert "'2,1,43,1,2' fills 5 cells, and the header has 3" in note and "left out" in note


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("text", ["time,a\n0,1,\n1,2,,,\n", "time,a,\n0,1,\n1,2,7\n", "time;a\n0;1;\n1;2;\n"])
def test_separators_at_the_ends_of_rows_are_no_cells_too_many(tmp_path, of, text):
    source = of(tmp_path, text)
    assert [(row.time, row.values["a"]) for row in all_of(source)] == [(0.0, 1.0), (1.0, 2.0)]
    assert source.refused == 0 and not source.notes


REMARKS = {
    "event without a title": "time,b,a\n0,1,2\n1,1,95,OVERLOAD\n2,1,4\n",
    "events of two words": "time,b,a\n0,1,2\n1,1,95,OVERLOAD,winch 1\n2,1,4\n",
    "event in the first row": "time,b,a\n0,1,2,start\n1,1,95,OVERLOAD\n2,1,4\n",
    "event behind another column": "time,a,b\n0,2,1\n1,95,1,OVERLOAD\n2,4,1\n",
    "text with a comma": "time,a,remark\n0,2,\n1,95,too high, stopped\n2,4,\n",
    "text with a comma and a number": "time,a,remark\n0,2,ok\n1,95,too high, 2 falls, stopped\n2,4,ok\n",
    "the same in the first row": "time,a,remark\n0,2,start, 2 stands\n1,95,\n2,4,\n",
    "the same behind a row without a value": "time,a,b,remark\n0,2,3,\n1,95,,\n2,4,5,start, 2 stands\n",
    "a dash behind a remark": "time,a\n0,2\n1,95,slip,-\n2,4\n",
}


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("text", REMARKS.values(), ids=REMARKS)
def test_a_row_with_a_remark_beyond_the_header_counts_and_that_is_told_once(tmp_path, of, text):
    """Loggers write events so: the rows with the overload were left out, and the alarm with them."""
    source = of(tmp_path, text)
    assert [(row.time, row.values["a"]) for row in all_of(source)] == [(0.0, 2.0), (1.0, 95.0), (2.0, 4.0)]
    (note,) = source.notes
    assert "words in more cells than the header" in note and source.refused == 0


MOVED = {
    "row name": "time,a,b,state\n1,0,5,7,ok\n2,40,6,7,ok\n",
    "decimal comma": "time,a,b,state\n0,5,7,ok\n1,2,5,7,ok\n",
    "a number with its unit": "time,b,a\n0,1,5\n1,1,5,5 kN\n",
    "a date": "time,b,a\n0,1,5\n1,1,5,1970-01-01T00:00:02Z\n",
    "no number": "time,b,a\n0,1,5\n1,1,5,NaN\n",
    "a decimal comma before a bad sensor": "time,a,b\n0,5,7\n1,10,5,Bad\n",
    "a sensor that is off": "time,b,a\n0,1,5\n1,1,5,OFF\n",
    "milliseconds behind a comma": "time,b,a\n0,1,5\n1970-01-01 00:00:01,100,5,slip\n",
}


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("text", MOVED.values(), ids=MOVED)
def test_a_row_too_long_whose_numbers_may_have_moved_is_not_read_though_it_ends_with_words(tmp_path, of, text):
    try:
        source = of(tmp_path, text)
        rows = all_of(source)
    except SceneError:
        return
    assert [row.time for row in rows] == [0.0] and source.refused == 1


DAYS = '"VarName";"TimeString";"a";"Validity";"Time_ms"\n"load";"2026-01-01 00:00:00";1,5;1;46023000000,0\n'


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("time", ["", "Time_ms"])
def test_days_of_a_spreadsheet_that_are_called_milliseconds_are_refused_with_the_cure(tmp_path, of, time):
    """46023 days after 1899-12-30 are 2026-01-01: a second is 11.574 of `Time_ms`, and was read as 0.0116 s."""
    with pytest.raises(SceneError, match=r"days of a spreadsheet.*`time: TimeString`"):
        stamps(of(tmp_path, DAYS, time))
    assert stamps(of(tmp_path, DAYS, "TimeString")) == [1767225600.0]
    assert stamps(of(tmp_path, DAYS, "Time_ms [ms]")) == [46023000.0]


DAY = "1970-01-01 00:00:0"
STATES = {
    "whole seconds and three digits": f"time,b,a\n{DAY}0,120,2\n{DAY}1,121,95,slip\n{DAY}2,119,4\n",
    "the same before a text": f"time,b,a,note\n{DAY}0,120,2,\n{DAY}1,121,95,stop, 2 stands\n{DAY}2,119,4,\n",
    "a stamp in quotes": f'time,b,a\n"{DAY}0",120,2,start\n"{DAY}1",121,95\n"{DAY}2",119,4\n',
    "a zone behind the stamp": f"time,b,a\n{DAY}0Z,120,2,start\n{DAY}1Z,121,95\n{DAY}2Z,119,4\n",
    "a stamp without seconds": f"time,b,a\n1970-01-01T00:00,120,2,start\n{DAY}1,121,95\n{DAY}2,119,4\n",
    "a status that is off": "time,a,state\n0,2,ON\n1,95,OFF, 2 stands\n2,4,ON\n",
    "a status without a title": "time,a\n0,2,ON\n1,95,OFF\n2,4,ON\n",
    "a sensor that is bad before a remark": "time,b,a\n0,1,2\n1,1,95\n2,1,4,slip\n3,1,Bad,slip\n",
}  # fmt: skip


@pytest.mark.parametrize("of", [file, stream])
@pytest.mark.parametrize("text", STATES.values(), ids=STATES)
def test_rows_with_events_are_not_lost_by_three_digits_behind_a_stamp_or_by_a_status_that_is_off(tmp_path, of, text):
    """At 99 rpm the row with the event was read, at 100 rpm it was left out."""
    source = of(tmp_path, text)
    rows = [(row.time, row.values["a"]) for row in all_of(source) if row.time < 3.0]
    assert rows == [(0.0, 2.0), (1.0, 95.0), (2.0, 4.0)] and source.refused == 0


@pytest.mark.parametrize("of", [file, stream])
def test_one_number_in_a_column_of_states_lets_no_decimal_comma_pass_later(tmp_path, of):
    source = of(tmp_path, "time,a,b,state\n0,10,1,run\n1,10,1,7\n2,10,1,run\n3,11,5,1,run\n4,12,1,run\n")
    assert [row.time for row in all_of(source)] == [0.0, 1.0, 2.0, 4.0] and source.refused == 1


@pytest.mark.parametrize("of", [file, stream])
def test_a_first_row_whose_stamp_may_go_on_behind_a_comma_is_refused_with_a_zone_as_the_cure_that_reads_it(
    tmp_path, of
):
    text = f"time,b,a\n{DAY}0,120,2,start\n"
    with pytest.raises(SceneError, match=f"write them with a zone: {DAY}0Z"):
        all_of(of(tmp_path, text))
    assert [row.values["a"] for row in all_of(of(tmp_path, text.replace(f"{DAY}0", f"{DAY}0Z")))] == [2.0]


@pytest.mark.parametrize("of", [file, stream])
def test_a_first_row_with_text_that_has_commas_is_refused_with_quotes_as_the_cure(tmp_path, of):
    with pytest.raises(SceneError, match="if commas are part of a text, put it in quotes"):
        all_of(of(tmp_path, "time,a,d,note\n0,1,5,start, 2 stands\n"))


@pytest.mark.parametrize("of", [file, stream])
def test_a_value_that_is_missing_in_the_first_rows_says_nothing_of_those_with_text_behind_it(tmp_path, of):
    source = of(tmp_path, "time,a,remark\n0,,\n1,,\n2,95,start, 2 stands\n")
    assert [row.values["a"] for row in all_of(source)][-1] == 95.0 and source.refused == 0


# -- masses for forces, alone and within torques and pressures

FOOT, POUND, INCH, G = 0.3048, 0.45359237, 0.0254, 9.80665
"""Metres, kilograms, metres; standard gravity: international values."""
WEIGHTS = [
    *((one, "kN m", FOOT * POUND * G / 1e3) for one in ("ft-lb", "lb-ft", "ft lb", "ft-lbs", "FT-LB", "ft.lb", "ftlb")),
    *((one, "kN m", FOOT * POUND * G) for one in ("kft-lb", "KFT-LB", "klb-ft", "kft.lbf", "kft-lbf")),
    ("in-lb", "N m", INCH * POUND * G), ("IN-LBS", "N m", INCH * POUND * G), ("kg m", "N m", G), ("t m", "kN m", G),
    *((one, "bar", G / 10) for one in ("kg/cm2", "kg/cm\u00b2", "KG/CM2")), ("lb/in2", "psi", 1.0), ("PSI", "psi", 1.0),
    ("t", "kN", G), ("KLB", "kN", POUND * G), ("klbs", "kN", POUND * G), ("kN", "t", 1 / G), ("kN", "kg", 1e3 / G),
    ("mg", "m/s^2", G / 1e3), ("g", "m/s^2", G), ("kN.m", "kN m", 1.0),
    *((one, "kN", G) for one in ("tonne", "tonnes", "Mg")), ("kilogram", "kN", G / 1e3), ("kilograms", "kN", G / 1e3),
    *((one, "klbf", 1e-3) for one in ("pound", "pounds")), ("grams", "N", G / 1e3), ("stone", "N", 14 * POUND * G),
    ("newtons", "kg", 1 / G), ("kilonewton", "t", 1 / G), ("tonnes", "kg", 1e3),
]  # fmt: skip


@pytest.mark.parametrize(("stated", "asked", "factor"), WEIGHTS)
def test_a_mass_in_place_of_a_force_is_its_weight_also_within_a_torque_or_a_pressure(stated, asked, factor):
    found, _ = factor_stated(stated, asked)
    assert found == pytest.approx(factor, rel=1e-9)


@pytest.mark.parametrize(
    ("stated", "asked"),
    [("ft-lb", "kN m"), ("kg/cm2", "bar"), ("t", "kN"), ("tonnes", "kN"), ("kN", "t"), ("mg", "m/s^2")],
)
def test_what_is_assumed_of_a_mass_or_a_weight_is_told(stated, asked):
    assert any(word in factor_stated(stated, asked)[1] for word in ("as the weight", "as the mass", "gravity"))


@pytest.mark.parametrize(
    ("stated", "asked"),
    [("kg", "kN m"), ("kg/cm2", "kN"), ("kg m", "bar"), ("kg/m3", "bar"), ("m", "kN m"), ("kg", "m")],
)
def test_a_mass_in_place_of_something_else_than_a_force_stays_another_quantity(stated, asked):
    with pytest.raises(OtherQuantity):
        factor_stated(stated, asked)


@pytest.mark.parametrize("title", ["time_ms [s]", "Minutes since start [ms]"])
def test_a_stamp_with_two_units_is_read_by_its_brackets_and_told_unless_the_map_says_it(tmp_path, title):
    text = f"{title},a\n0,1\n40,2\n"
    source = file(tmp_path, text, title.split(" [")[0])
    assert stamps(source) == pytest.approx([0.0, 40.0 * (1e-3 if "[ms]" in title else 1.0)])
    assert len(source.notes) == 1 and f"'{title}' have two units: that in brackets is read" in source.notes[0]
    assert not file(tmp_path, text, title).notes


@pytest.mark.parametrize("title", ["time_ms [msec]", "Time/h (hours)", "time_s [UTC]", "time [ms]"])
def test_a_unit_that_is_said_twice_is_no_contradiction(tmp_path, title):
    assert not any("two units" in note for note in file(tmp_path, f"{title},a\n0,1\n").notes)


@pytest.mark.parametrize("of", [file, stream])
def test_days_times_a_million_are_no_milliseconds_whatever_stands_beside_them(tmp_path, of):
    source = of(tmp_path, DAYS.replace("TimeString", "Datum").replace("VarName", "Name"), "")
    assert not [stamp for stamp in stamps(source) if stamp == stamp] and "days of a spreadsheet" in source.notes[0]


@pytest.mark.parametrize("of", [file, stream])
def test_where_a_row_showed_that_seconds_have_a_comma_a_stamp_of_a_whole_second_proves_nothing(tmp_path, of):
    """Milliseconds were read as a load behind a row at a whole second, which Python writes without a fraction."""
    second = "2026-01-01 00:00:0"
    rows = [f"{second}0,100", f"{second}0,100,101", f"{second}1,110", f"{second}1,300,OVERFLOW"]
    source = of(tmp_path, "time,a\n" + "\n".join(rows) + "\n", "")
    found = [(row.time, row.values["a"]) for row in all_of(source) if row.time == row.time]
    assert found == [(1767225600.0, 100.0), (1767225601.0, 110.0)]
