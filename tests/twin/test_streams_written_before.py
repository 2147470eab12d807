"""Rows that were written before and are piped in: nobody waits for them, and they are answered as a file is."""

import io
import json
import types

import pytest
from cli.in_process import commands_of

from crane.application import Crane
from tautline.twin import restrictions
from tautline.twin.signals.backlog import Backlog

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


def taken(*rows):
    """What is known of rows that came so, stamp and arrival in s, after each."""
    backlog = Backlog()
    for stamp, arrived in rows:
        backlog.take(stamp, arrived)
        yield backlog.is_record


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
