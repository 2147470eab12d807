"""Rows that were written before and are piped in: nobody waits for them, and they are answered as a file is."""

import io
import json
import time
import types

import pytest
from cli.in_process import commands_of

from crane.application import Crane
from tautline.twin import restrictions
from tautline.twin.pace import Pace
from tautline.twin.sources import stream
from tautline.twin.twin import Twin

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: heave, unit: m, input: vessel.heave}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
watch:
  - {output: winch.tension, above: 80 kN, name: overload}
ahead: 1 s
"""


@pytest.fixture
def slow_looks(monkeypatch):
    """A clock that goes on by a second at each look at it: what makes way for rows is then done piece by piece."""
    now = iter(range(10**9))
    monkeypatch.setattr(restrictions, "clock", types.SimpleNamespace(perf_counter=lambda: float(next(now))))


def test_a_record_that_is_piped_in_is_answered_as_the_file_however_long_looks_ahead_take(
    slow_looks, tmp_path, monkeypatch, capsys
):
    rows = [f"{0.2 * k:.1f},{-0.01 * k * k:.4f},0,49\n" for k in range(20)]
    text = "time,winch_pos,heave,rope_tension\n" + "".join(rows)
    (tmp_path / "r.csv").write_text(text)
    (tmp_path / "map.yaml").write_text(MAP)
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    found = []
    for source in (tmp_path / "r.csv", "-"):
        words = ["twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--json", "--source", source]
        code, out, told = commands_of(Crane(), capsys)(*words)
        assert code == 0 and "cannot look ahead" not in told
        found.append([json.loads(line) | {"lag": 0.0} for line in out.splitlines()])
    assert len(found[0]) == len(rows)
    assert found[0] == found[1]


ARRIVALS = {
    "as they were measured, behind those that were kept": [(0.2 * k, 1e-3 * k) for k in range(10)]
    + [(2.0 + 0.2 * k, 0.2 * k) for k in range(1, 15)],
    "all at once": [(0.2 * k, 1e-3 * k) for k in range(24)],
}


@pytest.mark.parametrize("how", ARRIVALS)
def test_looks_ahead_make_way_as_soon_as_a_row_that_came_as_it_was_measured_waits_behind_a_record(
    how, slow_looks, tmp_path, monkeypatch, capsys
):
    text = "time,winch_pos,heave,rope_tension\n" + "".join(f"{stamp:.1f},0,0,49\n" for stamp, _ in ARRIVALS[how])
    now, asked, whole = iter([arrived for _, arrived in ARRIVALS[how]]), [], Twin.work
    monkeypatch.setattr(stream, "clock", types.SimpleNamespace(monotonic=lambda: next(now)))
    monkeypatch.setattr(Twin, "work", lambda self, seconds=None: asked.append(seconds) or whole(self, seconds))
    monkeypatch.setattr("sys.stdin", io.StringIO(text))  # it is read long before the scene is ready
    (tmp_path / "map.yaml").write_text(MAP)
    words = ["twin", "data/hoist.yaml", "--map", tmp_path / "map.yaml", "--json", "--source", "-"]
    code, out, told = commands_of(Crane(), capsys)(*words)
    assert code == 0 and len(out.splitlines()) == 24, told
    assert {seconds is None for seconds in asked} == {how == "all at once"}


def test_rows_that_wait_for_room_come_at_the_pace_of_the_twin_and_are_a_record_still(monkeypatch):
    now, rows = [0.0], 40
    monkeypatch.setattr(stream, "MOST", 2)
    monkeypatch.setattr(stream, "clock", types.SimpleNamespace(monotonic=lambda: now[0]))
    text = "time,a\n" + "".join(f"{0.1 * k:.1f},0\n" for k in range(rows))
    source, taken_rows = stream.Stream(io.StringIO(text), ["a"]), 0
    while taken_rows < rows:
        while not source._queue.full() and taken_rows + source.waiting < rows - 1:
            time.sleep(1e-4)  # the thread that reads has come to the next row that finds no room
        now[0] += 1.0
        taken_rows += source.poll(1.0) is not None
    assert source.pace.is_record


def taken(*rows):
    """What is known of rows that came so, stamp and arrival in s, after each."""
    pace = Pace()
    for stamp, arrived in rows:
        pace.take(stamp, arrived)
        yield pace.is_record


def test_rows_that_all_come_at_once_are_a_record_also_behind_a_gap_in_it():
    rows = [(0.2 * k, 1e-4 * k) for k in range(50)] + [(1000.0 + 0.2 * k, 0.01 + 1e-4 * k) for k in range(50)]
    assert list(taken(*rows)) == [False] + [True] * 99


@pytest.mark.parametrize("rate", [0.2, 5.0, 50.0])
def test_rows_that_come_as_they_are_measured_are_no_record_nor_are_those_that_a_stalled_link_gives_at_once(rate):
    rows = [(k / rate, k / rate) for k in range(int(20 * rate))]
    stalled = [(20.0 + k / rate, 50.0 + 1e-4 * k) for k in range(int(30 * rate))]
    assert not any(taken(*rows, *stalled))


def test_what_a_broker_has_kept_is_no_record_as_soon_as_rows_come_as_they_are_measured():
    kept = [(k / 5.0, 1e-4 * k) for k in range(10)]
    last = list(taken(*kept, *((2.0 + k / 5.0, k / 5.0) for k in range(20))))[-1]
    assert not last


@pytest.mark.parametrize("apart", [30.0, 130.0, 1000.0])
def test_a_record_ends_with_rows_of_now_however_seldom_they_come(apart):
    kept = [(k / 20.0, 1e-4 * k) for k in range(10)]
    assert list(taken(*kept, *((apart * k, apart * k) for k in range(1, 4))))[-3:] == [False] * 3


def test_a_record_of_rows_minutes_apart_is_one_and_two_sensors_whose_stamps_step_to_and_fro_end_it_too():
    assert all(list(taken(*((200.0 * k, 1e-4 * k) for k in range(10))))[1:])
    both = [(k / 5.0 - 0.3 * (k % 2), k / 5.0) for k in range(1, 20)]
    assert not list(taken(*((k / 20.0 - 10.0, 1e-4 * k) for k in range(10)), *both))[-1]
