"""Alarms near their bound: noise lets single rows be certain, and others not. A driver is told of what lasts.

Readings are written here, in kN: a load that hangs still with 49 kN, and a bound of 48 kN that what is computed is
beyond. A reading of 48.5 shows it as well; one of 47.5 shows less, and makes it doubtful.
"""

import re

import numpy as np
import pytest
from cli.in_process import commands_of
from twin.rehearsal import STILL, WEIGHT, weight_twin

from crane.application import Crane
from tautline.twin.forecast import Found
from tautline.twin.pace import Pace
from tautline.twin.signals.sensors import Health
from tautline.twin.sources.record import Record
from tautline.twin.twin import Twin
from tautline.twin.watch import Compared, Watch

MAP = """
sensors:
  - {column: rope, unit: kN, output: winch.tension, sd: 0.5 kN, range: [0, 60]}
watch:
  - {output: winch.tension, above: 48 kN, name: overload}
ahead: 0 s
"""
MORE, LESS, NONE = 48.5, 47.5, 40.0
CLEAR = 1.0
"""How long a condition has to be over for its alarm to end, s, by docs/twin_alarms.md."""


@pytest.fixture(scope="module")
def judged():
    """A function that judges readings of 10 Hz beside a computed value, kN, and gives time and alarm of each row."""
    plan = Twin(STILL, MAP).plan

    def judge(readings, computed=48.1, sd=0.2):
        health = Health(plan.channels[0])
        watch, found = Watch(plan, [health], None), []
        for k, reading in enumerate(readings):
            time = 0.1 * k
            value = health.check(time, 1e3 * (reading + 1e-3 * (k % 7)))
            now = computed(time) if callable(computed) else computed
            watch.judge(Compared(
                time, np.array([value]), {"winch.tension": (1e3 * now, 1e3 * sd)}, np.zeros(1), np.full(1, 500.0),
                np.isfinite([value]), np.ones(1), True, None,
            ))  # fmt: skip
            found.append((time, watch.alarms.active.get("overload")))
        return found

    return judge


@pytest.mark.parametrize("every", [2, 3, 9])
def test_an_overload_of_which_a_row_a_second_is_certain_is_certain_all_the_time(every, judged):
    found = judged([MORE if k % every == 0 else LESS for k in range(100)])
    assert all(alarm.known and "not certain" not in alarm.text for _, alarm in found)


def test_an_overload_of_which_no_row_is_certain_any_more_is_in_doubt_a_second_after_the_last(judged):
    found = judged([MORE if k <= 20 else LESS for k in range(60)])
    assert all(alarm.known == (time < 2.0 + CLEAR - 1e-9) for time, alarm in found)
    assert all("That is not certain" in alarm.text for _, alarm in found[31:])


def test_an_overload_becomes_certain_in_the_row_that_shows_it(judged):
    found = judged([LESS] * 20 + [MORE] + [LESS] * 5 + [MORE])
    assert not any(alarm.known for _, alarm in found[:20]) and all(alarm.known for _, alarm in found[20:])


def test_an_overload_begins_and_ends_in_the_same_rows_whether_it_is_certain_or_not(judged):
    """Computed and measured beyond the bound from 1 s to 3 s, and within it before and behind."""
    ends = []
    for shown in ([MORE], [MORE, LESS, LESS], [LESS]):
        rows = [shown[k % len(shown)] if 10 <= k < 30 else NONE for k in range(60)]
        found = judged(rows, lambda time: 48.1 if 0.95 < time < 2.95 else NONE)
        ends.append([time for time, alarm in found if alarm is not None])
    assert ends[0] == ends[1] == ends[2]
    assert ends[0][0] == pytest.approx(1.0) and ends[0][-1] == pytest.approx(2.9 + CLEAR - 0.1)


@pytest.mark.parametrize(
    ("shown", "silent"), [(-5.0, 0.0), (np.nan, 1.0)], ids=["its wire is broken", "it is unplugged"]
)
def test_an_overload_whose_sensor_fails_is_in_doubt_at_once_where_what_is_computed_is_near_the_bound(
    shown, silent, judged
):
    """By docs/twin_alarms.md the last reading of a silent sensor counts for a second; one of -5 kN is out of range."""
    found = judged([MORE] * 20 + [shown] * 40)
    assert all(alarm.known == (time < 2.0 + silent - 0.05) for time, alarm in found)
    assert all("That is not certain" in alarm.text for time, alarm in found if time > 2.0 + silent)


def test_a_danger_ahead_that_was_certain_is_in_doubt_at_once_where_all_that_is_computed_is():
    twin = weight_twin(start="5 t", map=WEIGHT)

    def known(unsure, value):
        watch = Watch(twin.plan, twin.readings.health, None)
        for time, worst, doubt in ((1.0, 95e3, False), (1.1, value, unsure)):
            found = Found(0.5, {"overload": (1.5, worst)}, beyond={"overload": [(1.5, worst)]}, known=True)
            watch.judge(Compared(
                time, np.full(3, np.nan), {"winch.tension": (50e3, 400.0)}, np.zeros(1), np.ones(1),
                np.zeros(1, bool), np.ones(1), True, found, moved={"winch.tension": 0.0}, unsure=doubt,
            ))  # fmt: skip
        return watch.alarms.active["overload"].known

    assert known(unsure=False, value=80.1e3), "it is near its bound, and was certain a tenth of a second ago"
    assert not known(unsure=True, value=95e3)


class Readings:
    """A source of readings, 10 Hz."""

    def __init__(self, readings):
        self.name, self.live, self.again, self.ended = "readings", False, False, False
        self.refused = self.left_out = self.dropped = self.waiting = 0
        self.notes, self.factors, self.pace = [], {}, Pace()
        self._rows = [Record(0.1 * k, {"rope": one + 1e-3 * (k % 7)}, 0.0) for k, one in enumerate(readings)]

    def poll(self, timeout):
        if self._rows:
            return self._rows.pop(0)
        self.ended = True
        return None

    def close(self):
        pass


def test_the_command_tells_an_overload_once_then_that_it_is_in_doubt_and_that_it_is_certain_in_sentences(
    capsys, tmp_path, monkeypatch
):
    (tmp_path / "scene.yaml").write_text(STILL)
    (tmp_path / "map.yaml").write_text(MAP)
    source = Readings([MORE, LESS] * 10 + [LESS] * 20 + [MORE] * 2 + [np.nan] * 15)
    monkeypatch.setattr("tautline.twin.sources.opening.open_source", lambda *_, **__: source)
    code, _, told = commands_of(Crane(), capsys)(
        "twin", tmp_path / "scene.yaml", "--map", tmp_path / "map.yaml", "--source", "readings"
    )
    lines = re.findall(r"([\d.]+ s: .*?)(?=[\d.]+ s: |rows processed)", " ".join(told.split()))
    said = [one for one in lines if "overload" in one]
    begins = [
        "0.0 s: ALARM overload: winch.tension measured: 48.5",
        "2.8 s: overload is in doubt now: winch.tension computed: ",
        "4.0 s: overload is certain now: winch.tension measured: 48.5",
        "5.2 s: overload is in doubt now: winch.tension computed: ",  # the last reading came at 4.1 s
    ]
    assert code == 0 and len(said) == len(begins), said
    assert all(one.startswith(begin) for one, begin in zip(said, begins, strict=True)), said
