"""A twin that does not keep up with the rows of a machine says so; rows that were written before wait for nobody."""

import io
import json
import time as clock

import pytest
from twin.rehearsal import STILL

from tautline.twin.signals.backlog import FALLS_BACK, LIMIT, Backlog
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.opc_ua.client import OpcUa
from tautline.twin.sources.opc_ua.holding import Change
from tautline.twin.sources.stream import Stream
from tautline.twin.twin import Twin

STEP = 0.1
MAP = """
sensors: [{column: winch, unit: m, input: winch.pay_out}]
watch: [{output: winch.tension, above: 80 kN, ahead: 2 s, name: overload}]
"""


def delayed(cost, count=200, pace=1.0, limit=LIMIT):
    """By how much the twin is behind at each row, s, where it takes `cost` for one.

    Rows come `pace` times as fast as they were measured. The clock is simulated: a row is taken when it has come and
    the one before is answered.
    """
    now = [1000.0]
    backlog, found = Backlog(limit, lambda: now[0]), []
    for k in range(count):
        arrived = 1000.0 + STEP * k / pace
        now[0] = max(now[0], arrived)
        backlog.take(STEP * k, arrived)
        now[0] += cost
        seconds, tell = backlog.judge()
        found.append((seconds, backlog.behind, tell))
    return found


def test_a_twin_that_takes_longer_for_a_row_than_the_next_takes_to_come_is_behind_by_what_has_added_up():
    found = delayed(0.12)
    # 0.02 s more with every row: exact for a queue that is served one by one.
    assert found[-1][0] == pytest.approx(0.12 + 199 * 0.02, abs=1e-6) and found[-1][1]
    first = next(k for k, one in enumerate(found) if one[1])
    assert found[first][0] == pytest.approx(LIMIT, abs=0.03)
    told = [k for k, one in enumerate(found) if one[2]]
    assert len(told) == 1 and told[0] - first == pytest.approx(FALLS_BACK / 0.12, abs=2)


def test_a_twin_that_keeps_up_is_never_behind():
    assert not any(behind or tell for _, behind, tell in delayed(0.09))


def test_rows_that_were_written_before_wait_for_nobody():
    assert not any(behind for _, behind, _ in delayed(0.12, pace=1e5))


def test_a_shorter_look_ahead_is_of_no_use_sooner():
    first = [next(k for k, one in enumerate(delayed(0.12, limit=limit)) if one[1]) for limit in (0.5, LIMIT, 10.0)]
    assert first[0] < first[1] == first[2]


def test_a_twin_that_was_late_at_its_start_is_behind_until_it_has_caught_up_and_nothing_is_told_to_help():
    now = [1005.0]
    backlog, found = Backlog(now=lambda: now[0]), []
    for k in range(200):
        arrived = 1000.0 + STEP * k
        now[0] = max(now[0], arrived) + 0.02
        backlog.take(STEP * k, arrived)
        found.append((*backlog.judge(), backlog.behind))
    behind = [one[2] for one in found]
    assert any(behind) and not behind[-1] and not any(one[1] for one in found)
    assert behind.index(False, behind.index(True)) < 70


def judged(cost, arrivals, begin=0.0):
    """Seconds behind, whether behind, held up, and told, of rows that arrive at times, s; the clock is simulated."""
    now = [1000.0 + begin]
    backlog, found = Backlog(now=lambda: now[0]), []
    for k, at in enumerate(arrivals):
        now[0] = max(now[0], 1000.0 + at)
        backlog.take(STEP * k, 1000.0 + at)
        now[0] += cost
        seconds, tell = backlog.judge()
        found.append((seconds, backlog.behind, backlog.held_up, tell))
    return found


def in_bursts(every, count=800):
    """When rows arrive that a gateway sends together every so many seconds, s."""
    rows = round(every / STEP)
    return [every * (k // rows + 1) + 1e-4 * (k % rows) for k in range(count)]


@pytest.mark.parametrize("every", [5.0, 20.0])
def test_rows_that_are_sent_together_are_not_behind_while_they_are_answered_faster_than_their_stamps_go_by(every):
    assert not any(behind or tell for _, behind, _, tell in judged(0.09, in_bursts(every)))


def test_rows_that_are_sent_together_and_answered_slower_than_their_stamps_go_by_are_behind_within_two_bursts():
    found = judged(0.13, in_bursts(20.0))
    # The first burst may have been written before. 0.03 s a row add up to the 6 s that each burst is answered late.
    assert next(k for k, one in enumerate(found) if one[1]) <= 2 * 200 and found[-1][0] == pytest.approx(24.0, abs=1.0)
    assert sum(one[3] for one in found) == 1


def test_rows_that_come_in_pairs_do_not_hide_an_overload():
    found = judged(0.12, [2 * STEP * (k // 2 + 1) for k in range(200)])
    assert next(k for k, one in enumerate(found) if one[1]) == pytest.approx(LIMIT / 0.02, abs=20)


def test_a_twin_that_begins_late_is_behind_from_its_second_row_on_and_is_not_said_not_to_keep_up():
    found = judged(0.02, [STEP * k for k in range(400)], begin=30.0)
    assert all(one[1] and one[2] for one in found[1:50]) and not any(one[3] for one in found)
    assert not found[-1][1] and not found[-1][2]
    # One that begins late and does not keep up either is said so after a while.
    found = judged(0.12, [STEP * k for k in range(400)], begin=30.0)
    assert found[1][2] and not found[-1][2] and sum(one[3] for one in found) == 1


def after_a_stall(stall, pairs=False, steady=3.0, cost=0.15):
    """What is judged of rows at 20 Hz that wait `stall` s in the link, go on for `steady` s, and then take `cost` each.

    Gives (true wait, seconds behind, whether behind) of the last. In `pairs` every second row comes with the next.
    """
    now, found = [0.0], []
    backlog, step, end = Backlog(now=lambda: now[0]), 0.05, 20.0 + stall
    begin = round((end + steady) / step)
    for k in range(begin + 600):
        at = step * (k + 1 - k % 2 if pairs else k)
        if 20.0 <= step * k < end:
            at = end + 1e-5 * k
        now[0] = max(now[0], at) + (cost if k >= begin else 0.0)
        backlog.take(step * k, at)
        seconds, _ = backlog.judge()
        if k >= begin:
            found.append((now[0] - at, seconds, backlog.behind))
        elif now[0] <= at:
            backlog.none_waits()
    return found


@pytest.mark.parametrize("stall", [2.0, 30.0, 300.0])
def test_a_link_that_stalled_and_gave_its_rows_at_once_does_not_hide_that_the_twin_falls_behind_later(stall):
    found = after_a_stall(stall)
    wait = next(wait for wait, _, behind in found if behind)
    assert LIMIT <= wait <= LIMIT + 0.2
    assert [seconds for wait, seconds, _ in found] == pytest.approx([wait for wait, _, _ in found], abs=0.05)


def test_rows_that_come_in_pairs_after_a_stall_hide_nothing_for_more_than_thrice_as_long_as_it_took():
    wait = next(wait for wait, _, behind in after_a_stall(10.0, pairs=True, steady=30.0) if behind)
    assert LIMIT <= wait <= LIMIT + 0.4


def test_a_gap_of_the_stamps_hides_nothing():
    now = [1000.0]
    backlog = Backlog(now=lambda: now[0])
    for k in range(20):
        stamp = STEP * k + (86400.0 if k > 3 else 0.0)
        backlog.take(stamp, 1000.0 + STEP * k)
    now[0] = 1000.0 + STEP * k + 4.0
    assert backlog.judge()[0] == pytest.approx(4.0) and backlog.behind


def test_the_alarm_of_a_twin_that_catches_up_says_so():
    made, now = Twin(STILL, MAP, live=True), [1030.0]
    made.backlog = Backlog(now=lambda: now[0])
    lines = []
    for k in range(60):
        now[0] += 0.02
        lines += made.add(STEP * k, [0.0], 1000.0 + STEP * k)
    assert {line["health"] for line in lines} == {"degraded"}
    texts = [one["text"] for line in lines for one in line["alarms"] if one["name"] == "behind the machine"]
    assert len(texts) == len(lines) and all("has begun late, or was held up, and catches up" in one for one in texts)


def test_the_alarm_ends_where_a_state_goes_on_with_a_source_that_is_not_live():
    made = Twin(STILL, MAP)
    made.watch.judge_backlog(0.0, 4.0, True)
    lines = [line for k in range(60) for line in made.add(STEP * k, [0.0])]
    assert lines[0]["alarms"] and not lines[-1]["alarms"]


def answered(late):
    """Lines of a twin whose rows are each taken so long after their arrival, s; the clock is simulated."""
    made, now = Twin(STILL, MAP, live=True), [0.0]
    made.backlog = Backlog(now=lambda: now[0])
    lines = []
    for k in range(30):
        now[0] = 1000.0 + STEP * k + late
        lines += made.add(STEP * k, [0.0], 1000.0 + STEP * k)
    return lines


def test_the_lines_of_a_twin_that_is_behind_have_an_alarm_and_degraded_health():
    *_, line = answered(4.0)
    (alarm,) = [one for one in line["alarms"] if one["name"] == "behind the machine"]
    assert "4.0 s behind the machine" in alarm["text"] and line["health"] == "degraded"
    *_, line = answered(0.2)
    assert not line["alarms"] and line["health"] == "good"


def test_rows_that_are_answered_in_a_silence_have_waited_for_other_rows_only():
    made, now = Twin(STILL, MAP, live=True), [0.0]
    made.backlog = Backlog(now=lambda: now[0])
    for k in range(30):
        now[0] = 1000.0 + STEP * k
        made.add(STEP * k, [0.0], now[0])
    now[0] += 5.0
    *_, line = made.answers(silent=True)
    assert line["health"] == "good" and not line["alarms"]


def test_rows_from_python_without_a_time_of_arrival_are_not_behind():
    made, lines = Twin(STILL, MAP, live=True), []
    for k in range(30):
        lines += made.add(STEP * k, [0.0])
    assert lines[-1]["health"] == "good" and not lines[-1]["alarms"]


def test_records_that_nobody_has_taken_are_counted(monkeypatch, tmp_path):
    stream = Stream(io.StringIO("".join(json.dumps({"time": k, "a": 1}) + "\n" for k in range(7))), ["a"])
    end = clock.monotonic() + 5.0
    while stream.waiting < 7 and clock.monotonic() < end:
        clock.sleep(0.01)
    assert stream.waiting == 7
    stream.poll(0.1)
    assert stream.waiting == 6
    pytest.importorskip("asyncua")
    monkeypatch.setattr(OpcUa, "_listen", lambda self: None)
    source = OpcUa("opc.tcp://localhost:4840/x", ["a", "b"])
    for k in range(5):
        source._put(Change(1.0 * k, "a", 1.0, 1.0 * k))
        source._put(Change(1.0 * k, "b", 1.0, 1.0 * k))
    assert source.waiting == 5
    source.close()


def test_a_row_of_a_replay_that_is_asked_for_late_has_arrived_when_it_was_due(tmp_path):
    (tmp_path / "r.csv").write_text("time,a\n0,1\n1,1\n2,1\n3,1\n")
    now = [100.0]
    source, arrived = CsvFile(tmp_path / "r.csv", ["a"], speed=1.0, now=lambda: now[0], sleep=lambda s: None), []
    for _ in range(4):
        now[0] += 5.0
        arrived.append(source.poll(0.0).arrived)
    assert arrived == [100.0, 101.0, 102.0, 103.0]
