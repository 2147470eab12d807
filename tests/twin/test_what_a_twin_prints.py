"""What the command ``twin`` prints for people: notes of its source, counts, times."""

import json
import re
import subprocess
import sys

import numpy as np
import pytest
from cli.in_process import commands_of

from crane.application import Crane
from tautline.scene.values.moments import stamp_said
from tautline.twin.pace import Pace
from tautline.twin.signals.sensors import Health
from tautline.twin.sources.record import Record
from tautline.twin.twin import Twin

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
watch:
  - {output: winch.tension, above: 30 kN, name: overload}
window: 1 s
ahead: 0 s
"""


class Given:
    """A source of rows that the test gives."""

    def __init__(self, rows, dropped=0, notes=()):
        self.name, self.live, self.again, self.ended, self.refused = "given", False, True, False, 0
        self.left_out = 0
        self.dropped, self.notes, self._rows = dropped, list(notes), list(rows)
        self.factors, self.pace = {}, Pace()
        self.waiting = 0

    def poll(self, timeout):
        if self._rows:
            time, values = self._rows.pop(0)
            return Record(time, values, 0.0)
        self.ended = True
        return None

    def close(self):
        pass


@pytest.fixture
def twin(capsys, tmp_path, monkeypatch):
    """The command with a source of the test, or with a text as its file: exit code, standard output, standard error."""
    (tmp_path / "map.yaml").write_text(MAP)
    command = commands_of(Crane(), capsys)

    def run(source, *options):
        where = tmp_path / "r.csv"
        if isinstance(source, str):
            where.write_text(source)
        else:
            monkeypatch.setattr("tautline.twin.sources.opening.open_source", lambda *_, **__: source)
        return command("twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--source", where, *options)

    return run


def rows(begin=0.0, count=6):
    return [(begin + 0.1 * k, {"winch_pos": 0.0, "rope_tension": 49.0}) for k in range(count)]


def test_notes_of_the_source_are_printed_and_records_that_it_dropped_are_counted(twin):
    code, out, told = twin(Given(rows(), 5, ["nobody answers"]), "--json")
    assert code == 0 and len(out.splitlines()) == 6
    assert "nobody answers" in told
    assert "records dropped, as they came too fast  5" in " ".join(told.split("\n")).replace("   ", " ")


HEADER = "time [s];winch_pos [m];rope_tension [kN]\n"


def test_stamps_and_readings_with_decimal_commas_are_used(twin):
    code, out, _ = twin(HEADER + "".join(f"0,{k}00000;0,0;49,05\n" for k in range(6)), "--json")
    assert code == 0 and len(out.splitlines()) == 6


def test_a_null_is_counted_where_the_header_has_another_unit_than_the_map(twin):
    readings = ["49050", "49050", "-999.25", "49050", "49050", "49050"]
    text = "time [s];winch_pos [m];rope_tension [N]\n" + "".join(f"0.{k};0;{one}\n" for k, one in enumerate(readings))
    code, _, told = twin(text, "--json")
    assert code == 0 and "rows with a reading that stands for none (-999.25)  1" in told


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEADER + "yesterday;0;49\ntoday;0;49\n", "2 rows without a stamp that can be read; a stamp is a number"),
        (HEADER, "the source gave no row"),
        ("winch_pos;rope_tension;time\n0\n0\n", "2 lines could not be read"),
    ],
)
def test_a_twin_that_could_use_no_row_says_what_was_wrong_and_ends_with_3(twin, text, said):
    code, out, told = twin(text, "--json")
    assert code == 3 and not out
    assert f"no row of data could be used: {said}" in told and "rows processed" in told


def test_a_file_with_nothing_new_for_a_twin_that_goes_on_is_no_fault(twin, tmp_path):
    (tmp_path / "map.yaml").write_text(MAP + "delay: 0 s\n")  # else the last rows are answered anew
    text = HEADER + "".join(f"0.{k};0;49\n" for k in range(6))
    assert twin(text, "--resume", tmp_path / "twin.state")[0] == 0
    code, _, told = twin(text, "--resume", tmp_path / "twin.state")
    assert code == 0 and "nothing is new: 6 rows not after 0.5 s, from" in told
    code, _, told = twin(text + "today;0;49\n", "--resume", tmp_path / "twin.state")
    assert code == 0 and "goes on, 1 row without a stamp" in told and "could be used" not in told


def test_false_stamps_of_a_file_end_no_twin_that_goes_on_and_a_file_that_lost_rows_is_told(twin, tmp_path):
    lines = [f"{0.1 * k:.1f};0;49\n" for k in range(100)]
    lines[30:30], lines[20:20] = ["4294967.295;0;49\n"], ["4294967.295;0;49\n"]
    seen = []
    for part, lost in ((lines[:82], False), (lines[:90], False), (lines[:60] + lines[65:], True)):
        code, out, told = twin(HEADER + "".join(part), "--resume", tmp_path / "twin.state", "--json")
        assert code == 0 and ("has lost rows" in told) == lost
        times = [json.loads(line)["time"] for line in out.splitlines()]
        seen = [time for time in seen if time < times[0]] + times  # the last rows of a part are answered anew
    assert seen == pytest.approx([0.1 * k for k in range(100)])


@pytest.mark.parametrize(
    ("begin", "said"),
    [(7.25, "7.2 s: ALARM overload"), (1795810503.25, "2026-11-27 20:15:03.2 UTC: ALARM overload")],
)
def test_an_alarm_is_told_with_its_time_in_seconds_or_where_stamps_are_unix_times_in_utc(twin, begin, said):
    _, _, told = twin(Given(rows(begin)))
    assert told.startswith(said)


@pytest.mark.parametrize(
    ("time", "said"),
    [
        (11.05, "11.1 s"), (999999.96, "1000000.0 s"), (1.0e8, "1973-03-03 09:46:40.0 UTC"),
        (1.8e12, "1800000000000.0 s"), (1795810503.96, "2026-11-27 20:15:04.0 UTC"), (float("nan"), "nan s"),
    ],
)  # fmt: skip
def test_a_time_is_written_as_people_read_it(time, said):
    assert stamp_said(time) == said


LOGGED = """
import logging, sys
from tautline.cli.commands.twin import silence_library_logs
from tautline.twin.sources.opening import open_source
open_source("opc.tcp://127.0.0.1:1/x", ["a"]).close()
other = logging.getLogger("asyncua.client.ua_session")
other.warning("before")
silence_library_logs()
other.warning("meanwhile")
logging.getLogger("another").warning("of others")
logging.basicConfig()
other.warning("asked for")
"""


def test_what_the_library_of_opc_ua_logs_is_kept_off_by_the_command_alone_and_from_no_handler():
    pytest.importorskip("asyncua")
    done = subprocess.run([sys.executable, "-c", LOGGED], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and not done.stdout
    assert done.stderr.splitlines() == ["before", "of others", "WARNING:asyncua.client.ua_session:asked for"]


NOON = 1795896000.0
"""2026-11-28 20:00:00 UTC."""


def rope_health():
    """Health of a load cell in newtons with values that swing, up to four seconds after `NOON`."""
    plan = Twin("data/hoist.yaml", MAP).plan
    health = Health(next(one for one in plan.channels if one.is_output))
    for k in range(80):
        health.check(NOON + 0.05 * k, 49e3 + 500.0 * np.sin(1.7 * k))
    return health


def test_since_when_a_sensor_is_stuck_is_said_as_a_time_of_day():
    health = rope_health()
    for k in range(80, 100):
        health.check(NOON + 0.05 * k, 49123.0)
    assert health.fault in ("stuck", "clipped")
    assert health.text == "rope_tension has shown 49.12 kN since 2026-11-28 20:00:04.0 UTC"


def test_by_how_much_a_sensor_is_off_on_average_is_said_without_a_limit_and_from_the_first_seconds_on():
    health = rope_health()
    for k in range(40):  # two seconds
        health.compare(NOON + 4.0 + 0.05 * k, 49e3 + 60e3, 49e3, 500.0, settled=True)
    assert health.mean_residual == pytest.approx(60e3)
    for k in range(40, 400):
        health.compare(NOON + 4.0 + 0.05 * k, 49e3, 49e3, 500.0, settled=True)
    # The mean of a time constant of 20 s: 2 s of 60 kN, and 18 s of nothing behind them.
    assert health.mean_residual == pytest.approx(60e3 * (np.exp(-18 / 20) - np.exp(-1)) / (1 - np.exp(-1)), rel=0.03)


def test_when_a_reading_jumped_is_said_as_a_time_of_day():
    health = rope_health()
    health.check(NOON + 4.0, 400e3, [49e3, 49.1e3])
    assert "at 2026-11-28 20:00:04.0 UTC; left out so far: 1" in health.jump


def test_when_a_twin_began_again_from_rest_is_said_as_a_time_of_day():
    twin = Twin("data/hoist.yaml", MAP)
    for stamp, readings in [*rows(NOON), *rows(NOON + 3600.0)]:
        twin.add(stamp, readings)
    twin.finish()
    twin._leave_bounce(NOON + 3601.0)
    told = [note for note in twin.notes if "from rest" in note]
    assert len(told) == 2
    assert told[0].endswith("begun again from rest at 2026-11-28 21:00:00.0 UTC")
    assert told[1].startswith("At 2026-11-28 21:00:01.0 UTC the simulated load bounced")


def test_rows_that_were_not_answered_when_the_command_was_stopped_are_counted(twin):
    class Stopped(Given):
        def poll(self, timeout):
            self.waiting = len(self._rows)
            if self.waiting <= 2:
                raise KeyboardInterrupt
            return super().poll(timeout)

    given = rows()
    code, out, told = twin(Stopped(given), "--json")
    left = len(given) - len(out.splitlines())
    assert code == 130 and left > 2
    assert re.search(rf"rows not processed +{left}\b", told)


def test_an_alarm_that_began_with_a_reading_out_of_range_and_becomes_certain_is_told_again(twin, tmp_path):
    text = MAP.replace("sd: 0.5 kN", "sd: 0.5 kN, range: [0 kN, 90 kN]").replace("30 kN", "80 kN")
    (tmp_path / "map.yaml").write_text(text)
    readings = [49.0] * 5 + [120.0] * 10 + [85.0] * 10
    given = [(0.1 * k, {"winch_pos": 0.0, "rope_tension": one}) for k, one in enumerate(readings)]
    code, _, err = twin(Given(given))
    told = " ".join(err.split())
    assert code == 0 and "ALARM overload: winch.tension measured: 120 kN" in told
    assert told.index("That is not certain") < told.index("overload is certain now: winch.tension measured: 85 kN")


def test_two_alarms_of_one_name_are_refused_for_one_would_end_the_other(twin, tmp_path):
    second = "  - {output: hook.tension, above: 30 kN, name: overload}\nwindow"
    (tmp_path / "map.yaml").write_text(MAP.replace("window", second))
    code, _, err = twin(Given(rows()))
    assert code == 2 and "watch[1].name" in err and "'overload' stands twice" in " ".join(err.split())


def test_the_summary_says_once_that_stated_deviations_do_not_hold_the_mesh_where_something_is_estimated(twin, tmp_path):
    text = HEADER + "".join(f"0.{k};0;49\n" for k in range(4))
    assert "mesh" not in twin(text)[2]
    (tmp_path / "map.yaml").write_text(MAP + "estimate: [{parameter: payload.mass, start: 5 t, sd: 1 t}]\n")
    assert " ".join(twin(text)[2].split()).count("not in ± a mesh that is too coarse: compare with a twin of more") == 1
