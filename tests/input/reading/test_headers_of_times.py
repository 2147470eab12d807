"""Headers as loggers write them: which of them are times and in what unit, which are refused, which are no times."""

import pytest
from pydantic import TypeAdapter

from tautline.scene.errors import SceneError
from tautline.scene.functions import places, time_function
from tautline.scene.reading.columns import Columns
from tautline.scene.reading.time_columns import time_head, unit_of_time

IN_UNITS = {
    1.0: (
        "Time [s]", "time(s)", "Time (sec)", "Time (seconds)", "Time [Sec.]", "Time [S]", "TIME_S",
        "Time/s", "t/s", "t_s",
        "t_sec", "tsec", "time_sec", "timesec", "Time_Seconds", "Time, s", "Time.s", "time:s", "Elapsed",
        "Elapsed_Time",
        "elapsed_seconds", "Elapsed seconds", "Test Time (s)", "Relative Time", "timestamp", "Timestamp", "TimeStamp",
        "Date/Time", "DateTime", "Time Stamp", "RunTime", "sim_time", "System Time", "log time",
        "Time (UTC)", "Time [UTC]",
        "Time [-]", "Time [--]", "time []", "Time (local)", "Time (abs)", "Time s (rel)",
        "Time [GMT]",
        "Time since start [s]", "time_since_start", "time_since_start_s", "Time since start (sec)", "time_from_start",
        "Seconds since start", "seconds_since_epoch", "s since start", "seconds", "sec", "Zeit", "Zeit [s]",
        "Zeit (s)",
        "Zeit[s]", "Zeit / s", "Zeit in s", "Zeit_Sekunden", "Zeit [Sek]", "Zeit [Sek.]", "Zeit [Sekunden]",
        "Sekunden",
        "Time [sek]", "Temps (s)", "temps_secondes", "tiempo_s", "tiempo [segundos]", "Tiempo (seg)", "segundos",
        "tempo [s]", "tijd_s", "tid [s]", "tid_sekunder", "Sekunder", "czas [s]", "czas_sekundy", "sekundy",
        "t [s]", "t",
        "T [s]", "T(s)", "Time (s, rel)", "Time [s since start]", "Laufzeit", "Laufzeit_s", "uptime_s", "Zeitstempel",
        "Time\u00a0[s]", "'time'",
    ),
    1e-3: (
        "Time [ms]", "TIME [MS]", "Time (Ms)", "time_ms", "TIME_MS", "Time ms", "TimeMs", "timeMS",
        "TIMEMS", "timems",
        "t_ms", "t ms", "tms", "t [ms]", "T [MS]", "time/ms", "Time, ms", "Time (in ms)", "Time (ms, rel)",
        "time ms utc",
        "time in ms", "Time [msec]", "Time [millis]", "Time [milliseconds]", "timestamp_ms", "timestampms",
        "Timestamp(ms)", "time_stamp_ms", "elapsed_ms", "elapsedMs", "ms elapsed", "msElapsed", "Elapsed Time (ms)",
        "ms since epoch", "milliseconds_since_start", "millis_since_boot", "time_since_start_ms",
        "time ms since boot",
        "time_since_boot_in_ms", "ms", "millis", "milliseconds", "unix_ms", "unixms", "epoch_ms", "epochms",
        "epochMillis",
        "uptime_ms", "uptimems", "runtimems", "simtimems", "RunTimeMs", "durationms", "tick_ms", "Zeit_ms", "zeitms",
        "Zeit [ms]", "Zeit_Millisekunden", "Zeit in Millisekunden", "Millisekunden", "temps_millisecondes",
        "tiempo_milisegundos", "czas_milisekundy", "tid_millisekunder", "Date Time ms",
        "mSec", "mS", "t_mSec", "t_mS", "Time_mSec", "tick_mSec", "Zeit_mSek", "Zeit mSek", "Laufzeit_mSec",
        "MilliSeconds", "milliSeconds", "MilliSec", "timeMilliSeconds", "RunTimeMilliSeconds", "Milli Seconds",
        "TimemSec", "Run Time mSec", "Laufzeit Milli Sekunden",
    ),
    1e-6: (
        "time_us", "Time [\u00b5s]", "Time [\u03bcs]", "time_\u00b5s", "Time [US]", "t_us", "tus", "Zeit_Mikrosekunden",
        "uS", "uSec", "\u00b5Sec", "microSeconds", "Micro Sec", "time_uSec",
    ),
    1e-9: ("time_ns", "timestamp_ns", "Time [ns]", "t_ns", "Timestamp (nanoseconds)"),
    60.0: (
        "Time [min]", "TIME (MIN)", "Time(Min)", "Time [Min.]", "Time [minutes]", "time_min", "TIME_MIN", "TimeMin",
        "time-min", "Time/min", "timemin", "Elapsed Time (min)", "elapsed_min", "Total Time [min]", "Minutes",
        "minutes elapsed", "minutesElapsed", "Minutes (elapsed)", "Minutes since start", "minutes_since_start",
        "min since start", "time_minutes_since_start", "Time [in minutes]", "RunTimeMin", "Zeit_min", "Zeit [min]",
        "Zeit [Minuten]", "Zeit_Minuten", "Zeit in Minuten", "Minuten", "t_Minuten", "t_minutes",
        "Laufzeit_min", "minutos",
        "tiempo_minutos", "minuty", "czas [minuty]", "tid_minutter", "minutter", "temps (minutes)", "min",
    ),
    3600.0: (
        "Time [h]", "TIME [H]", "Time [hr]", "Time (hrs)", "time_h", "time_hours", "hours", "hours since start",
        "elapsed_hours", "Zeit [h]", "Zeit [Std]", "Zeit_Stunden", "Stunden", "heures", "temps_heures",
        "tiempo_horas",
        "horas", "godziny", "czas [godziny]", "Tid [timer]",
    ),
    86400.0: ("time_days", "Time [d]", "days", "days since start", "Zeit [Tage]"),
}  # fmt: skip
READ = [(title, factor) for factor, titles in IN_UNITS.items() for title in titles]


def made_of(folder, text):
    (folder / "record.csv").write_text(text, encoding="utf8")
    read = TypeAdapter(time_function("m", of="length"))
    return read.validate_python({"table": {"file": "record.csv"}}, context={"folder": folder})


@pytest.mark.parametrize(("title", "factor"), READ, ids=[title for title, _ in READ])
def test_times_are_read_in_the_unit_that_their_header_says_wherever_it_says_it(title, factor, tmp_path):
    made = made_of(tmp_path, f"{title};value\n0;1\n40;2\n")
    assert made.time == pytest.approx((0.0, 40.0 * factor), rel=1e-12) and made.value == (1.0, 2.0)


UNCLEAR = (
    "min_elapsed", "min time", "h time", "time_m", "TIME_M", "t_m", "zeit_m", "tmin", "TMIN", "time_mon",
    "time h min",
    "hour min", "minutes seconds", "ms_tick", "minutes_x", "Zeit_xyz", "Zeit 1 x", "time_std", "hora",
    "heure", "godzina",
    "timer", "Time(ms)_1", "seconds_h", "h_min",
    "m_sec", "tick_10ms", "uptime_cs", "tenths of seconds", "1/10 sec", "0.1 sec", "100th sec", "5min", "10min",
    "100 ms", "x 10 ms", "hundredths_s", "kilo seconds", "half hours",
    "deciseconds", "Centiseconds", "time_centisec", "Dezisekunden", "Std",
)  # fmt: skip


@pytest.mark.parametrize("title", UNCLEAR)
def test_a_time_of_which_the_unit_is_not_sure_is_refused(title, tmp_path):
    (tmp_path / "record.csv").write_text(f"{title};value\n0;1\n40;2\n")
    with pytest.raises(SceneError, match="not clear in which unit"):
        places(Columns(tmp_path / "record.csv"), None)


NOT_UNITS = (
    "Time [m]",
    "Time [M]",
    "Time (m:s)",
    "Time (HH:MM:SS)",
    "Time [1/s]",
    "Time [kN]",
    "Time [ms/s]",
    "Time [s, min]",
    "Time [datetime]",
    "Time (date)",
    "Time [ISO 8601]",
)


@pytest.mark.parametrize("title", NOT_UNITS)
def test_brackets_of_a_time_that_hold_no_unit_of_time_are_refused(title, tmp_path):
    (tmp_path / "record.csv").write_text(f"{title};value\n0;1\n40;2\n")
    columns = Columns(tmp_path / "record.csv")
    with pytest.raises(SceneError):
        columns.values(places(columns, None)[0], "s")


OTHERS = (
    "tension_min", "Tension min", "hmin", "torque_min", "mean_ms", "rpm_min", "min_tension", "min_rpm",
    "MinTension", "minimum",
    "terms", "items", "rms", "RMS_ms", "params", "alarms", "arms", "minor", "admin", "seconds_of_arc", "second_winch",
    "SecondHook", "hour_meter", "hours_on_bottom", "drilling hours", "day_rate", "days_to_td", "month", "d", "h", "s",
    "h_from_bottom", "d_from_bit", "s_from_bit", "hook_height_m", "speed_m_s", "speed [m/min]",
    "v_m_per_min", "rate_per_min",
    "flow_l_min", "ROP_ft_hr", "rop [ft/h]", "spm", "strokes/min", "T_min", "T_max", "T_h", "T_d",
    "period_s", "dt_ms",
    "dead time", "ping_ms", "latency ms", "depth", "tms_ok", "temp", "temperature_min", "status", "ms_ok", "usage",
    "sek_ok", "class", "dns", "wob_min", "hours_run", "vmin", "pmin", "umin", "us_ft",
)  # fmt: skip


@pytest.mark.parametrize("title", OTHERS)
def test_a_column_that_has_no_word_of_time_and_letters_of_a_unit_is_no_time(title, tmp_path):
    assert time_head(title).kind == ""
    for header, row, asked, expected in (
        (f"elapsed;{title}", "0;1", None, (0, 1)),
        (f"{title};Zeit_ms", "1;0", None, (1, 0)),
        (f"a;{title};time", "1;2;0", "a", (2, 0)),
    ):
        (tmp_path / "record.csv").write_text(f"{header}\n{row}\n{row}\n")
        assert places(Columns(tmp_path / "record.csv"), asked) == expected


@pytest.mark.parametrize("text", ["MS", "Ms", "ms", "in ms", "msec.", "ms, rel"])
def test_letters_of_a_unit_of_time_in_brackets_may_be_large_or_small(text):
    assert unit_of_time(text) == "ms"


@pytest.mark.parametrize("text", ["m", "M", "kN", "HH:MM:SS", "m:s", "hh:mm:ss.fff", "dd.mm.yyyy", "1/s", "C"])
def test_what_is_no_unit_of_time_for_sure_is_none(text):
    assert unit_of_time(text) is None


@pytest.mark.parametrize("text", ["", "-", "UTC", "utc", "GMT+1", "UTC +02:00", "CET", "Europe/Berlin", "PLC", "local"])
def test_what_says_whose_time_it_is_is_no_unit_and_no_fault(text):
    assert unit_of_time(text) == ""


def test_minutes_of_another_language_are_the_times_also_where_the_value_is_first(tmp_path):
    made = made_of(tmp_path, "load;Minuten\n5;0\n6;40\n")
    assert made.time == (0.0, 2400.0) and made.value == (5.0, 6.0)
