"""Rows that stop coming while no connection breaks: told once, and so is that they come again."""

import json
import time
from types import SimpleNamespace

import pytest
from cli.in_process import commands_of
from twin.rehearsal import STILL

from crane.application import Crane
from tautline.cli.commands import twin as command
from tautline.twin import twin
from tautline.twin.pace import Pace
from tautline.twin.signals import backlog
from tautline.twin.sources import connection
from tautline.twin.sources.connection import Silence
from tautline.twin.sources.record import Record

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope_tension, unit: kN, output: winch.tension, sd: 0.5 kN}
lost: 1.2 s
ahead: 0 s
"""


class Clock:
    time = 0.0

    def __call__(self):
        return self.time


@pytest.fixture(autouse=True)
def _nobody_waits(monkeypatch):
    """Who sleeps here finds that so much time has passed: a silence of seconds takes no second."""
    slept, monotonic = [0.0], time.monotonic

    def sleep(seconds):
        slept[0] += seconds

    passing = SimpleNamespace(**vars(time) | {"monotonic": lambda: monotonic() + slept[0], "sleep": sleep})
    monkeypatch.setitem(globals(), "time", passing)
    for module in (twin, command):
        monkeypatch.setattr(module, "clock", passing)
    for kind in (connection.Silence, backlog.Backlog):
        monkeypatch.setattr(kind.__init__, "__defaults__", (*kind.__init__.__defaults__[:-1], passing.monotonic))


def said(pauses, interval, patience=5.0, after=100.0):
    """For each pause, s, whether it was told; the last one is looked at until `after`."""
    clock, found = Clock(), []
    silence = Silence("a", patience, clock)
    silence.heard(0.0)
    for pause in [*pauses, after]:
        told, begun = [], clock.time
        while clock.time < begun + pause - 1e-9:
            clock.time += min(0.5, begun + pause - clock.time)
            told += [one.status for one in silence.watch(interval)]
        told += [one.status for one in silence.heard(silence.seconds)]
        found.append(told)
    return found


def test_rows_that_have_stopped_are_told_once_and_when_they_come_again():
    assert said([0.1, 0.1, 8.0, 0.1, 3.0], 0.1) == [[], [], ["silent", "heard"], [], [], ["silent", "heard"]]


@pytest.mark.parametrize("interval", [10.0, 60.0])
def test_a_slow_logger_is_not_silent_between_its_rows(interval):
    found = said(5 * [interval], interval, after=4.0 * interval)
    assert found[:5] == 5 * [[]] and found[5] == ["silent", "heard"]


def test_packets_of_a_radio_are_no_silences_once_they_are_usual():
    found = said(10 * [8.0], 0.1)
    assert found[3:10] == 7 * [[]] and found[10] == ["silent", "heard"]


class Hangs:
    """A live source whose rows stop for a while."""

    name, live, again, ended, refused, left_out, dropped, waiting = "logger", True, False, False, 0, 0, 0, 0

    def __init__(self, pause):
        self.notes, self.factors, self.pace, self._pause = [], {}, Pace(), pause
        self._rows = [(0.1 * k, {"winch_pos": 0.0, "rope_tension": 49.0}) for k in range(12)]

    def poll(self, timeout):
        if len(self._rows) == 4 and self._pause > 0.0:
            time.sleep(min(0.2, self._pause))
            self._pause -= 0.2
            return None
        if self._rows:
            return Record(*self._rows.pop(0), time.monotonic())
        self.ended = True
        return None

    def close(self):
        pass


class Useless(Hangs):
    """One that goes on with rows of which none can be used, `rate` a second, and then with good ones."""

    def __init__(self, stamps, rate, pause):
        super().__init__(pause)
        self._stamps, self._rate, self._sent, self._since = stamps, rate, 0, None

    def poll(self, timeout):
        if len(self._rows) != 4 or self._pause <= 0.0:
            return super().poll(timeout)
        now = time.monotonic()
        self._since = self._since or now
        if now - self._since > self._pause:
            self._pause = 0.0
            return None
        if now - self._since < self._sent / self._rate:
            time.sleep(min(timeout, 0.9 / self._rate))
            return None
        self._sent += 1
        return Record(self._stamps(self._sent), {"winch_pos": 0.0, "rope_tension": 90.0}, now)


USELESS = {
    "without a stamp that can be read": lambda _: float("nan"),
    "with a stamp that another row had": lambda _: 0.7,
    "that came too late": lambda k: -1.0 - k,
}


@pytest.mark.parametrize("rate", [4.0, 100.0])
@pytest.mark.parametrize("why", USELESS)
def test_rows_that_come_and_cannot_be_used_are_a_silence_and_the_reason_is_named(
    why, rate, tmp_path, capsys, monkeypatch
):
    words, told, times = commanded(lambda: Useless(USELESS[why], rate, 2.5), tmp_path, capsys, monkeypatch)
    assert [one["connection"] for one in words] == ["silent", "heard"]
    assert f" rows {why}. What is shown" in words[0]["text"] and words[0]["time"] == pytest.approx(0.7)
    assert "rows come, but for" in told and times == pytest.approx([0.1 * k for k in range(12)])


def commanded(source, tmp_path, capsys, monkeypatch):
    """What the command tells programs of the connection, what it tells people, and the times of its lines."""
    (tmp_path / "map.yaml").write_text(MAP)
    (tmp_path / "s.yaml").write_text(STILL)
    monkeypatch.setattr("tautline.twin.sources.opening.open_source", lambda *_, **__: source())
    code, out, told = commands_of(Crane(), capsys)(
        "twin", tmp_path / "s.yaml", "--map", tmp_path / "map.yaml", "--source", "x", "--json"
    )
    assert code == 0, told
    lines = [json.loads(line) for line in out.splitlines()]
    return [one for one in lines if "connection" in one], told, [one["time"] for one in lines if "lag" in one]


def test_rows_that_are_put_in_their_place_for_longer_than_that_are_no_silence(tmp_path, capsys, monkeypatch):
    """Those of a column whose rows come later than those of another, which has ended: the newest stamp stands still."""
    monkeypatch.setitem(globals(), "MAP", MAP + "delay: 5 s\n")
    words, _, times = commanded(lambda: Useless(lambda k: 0.01 + 0.02 * k, 12.0, 2.4), tmp_path, capsys, monkeypatch)
    assert not words and len(times) > 30


def test_the_command_tells_people_and_programs_that_nothing_is_known_any_more(tmp_path, capsys, monkeypatch):
    (tmp_path / "map.yaml").write_text(MAP)
    (tmp_path / "s.yaml").write_text(STILL)
    monkeypatch.setattr("tautline.twin.sources.opening.open_source", lambda *_, **__: Hangs(3.0))
    code, out, told = commands_of(Crane(), capsys)(
        "twin", tmp_path / "s.yaml", "--map", tmp_path / "map.yaml", "--source", "x", "--json"
    )
    assert code == 0, told
    words = [one for one in map(json.loads, out.splitlines()) if "connection" in one]
    assert [one["connection"] for one in words] == ["silent", "heard"]
    assert words[0]["time"] == pytest.approx(0.7) and "no row has come for" in words[0]["text"]
    assert "logger: no row has come for" in told and "logger: rows come again" in told


class LastUseless(Hangs):
    """One that hangs behind a single row that cannot be used."""

    def __init__(self, stamp, pause):
        super().__init__(pause)
        self._rows.insert(8, (stamp, {"winch_pos": 0.0, "rope_tension": 90.0}))


@pytest.mark.parametrize(
    "stamp, why",
    [
        (float("nan"), "1 row without a stamp that can be read"), (0.7, "1 row with a stamp that another row had"),
        (-5.0, "1 row that came too late"),
    ],
)  # fmt: skip
def test_a_source_that_hangs_behind_a_row_that_cannot_be_used_is_not_told_to_come(
    stamp, why, tmp_path, capsys, monkeypatch
):
    words, told, _ = commanded(lambda: LastUseless(stamp, 3.0), tmp_path, capsys, monkeypatch)
    assert [one["connection"] for one in words] == ["silent", "heard"]
    assert f"no row has come for 2 s; before that came {why}. What is shown" in told and "rows come, but" not in told


def test_a_page_tells_that_no_rows_come_at_all_as_soon_as_those_have_ended_that_cannot_be_used():
    clock = Clock()
    silence = Silence("a", 1.2, clock)
    silence.heard(0.0)
    found = []
    for count in (1, 2, 3, 4, 4, 4, 4):
        clock.time += 1.0
        silence.useless(count)
        silence.watch(0.1, "so many")
        found.append(silence.in_short(0.1, "so many"))
    assert found[3] == "no rows that can be used (so many) for 4 s"
    assert found[5:] == ["no rows for 2 s", "no rows for 3 s"]


def test_rows_of_a_clock_that_was_set_back_are_no_silence_while_it_is_not_known_yet(tmp_path, capsys, monkeypatch):
    stamps = [float(k) for k in range(6)] + [k - 3600.0 for k in range(6)]
    words, told, times = commanded(lambda: Paced(stamps, 0.8), tmp_path, capsys, monkeypatch)
    assert not words and "was set back by" in told and len(times) == 12


def test_late_rows_of_a_slow_source_that_hangs_are_told_as_soon_as_others():
    clock = Clock()
    silence = Silence("a", 1.2, clock)
    silence.heard(0.0)
    clock.time = 1.0
    silence.useless(1)
    told = []
    while not told:
        clock.time += 0.5
        told = silence.watch(1.0, "1 row that came too late", 6.0)
    assert clock.time == 4.0 and "no row has come for 3 s; before that came 1 row that came too late" in told[0]


class Paced(Hangs):
    """One of rows `apart` s apart."""

    def __init__(self, stamps, apart):
        super().__init__(0.0)
        self._rows = [(one, {"winch_pos": 0.0, "rope_tension": 49.0}) for one in stamps]
        self._apart, self._due = apart, 0.0

    def poll(self, timeout):
        now = time.monotonic()
        self._due = self._due or now
        if now < self._due:
            time.sleep(min(timeout, self._due - now))
            return None
        self._due += self._apart
        return super().poll(timeout)


@pytest.mark.parametrize("pause", [1.7, 3.0])
def test_a_source_whose_stamps_were_never_read_is_said_to_come_at_every_moment_though_it_comes_slowly(pause):
    """Nothing is known of how far apart its rows are but how they came."""
    now = [0.0]
    silence, said = Silence("mqtt", 5.0, lambda: now[0]), set()
    for k in range(1, 200):
        now[0] = 0.1 * k
        silence.useless(int(now[0] / pause))
        silence.watch(float("nan"), "3 rows without a stamp")
        if now[0] > 2.0 * pause:
            said.add(silence.in_short(float("nan"), "3 rows without a stamp").split(" for ")[0])
    assert said == {"no rows that can be used (3 rows without a stamp)"}
    now[0] += 10.0
    assert silence.in_short(float("nan"), "3 rows without a stamp").startswith("no rows for ")
