"""OPC UA: what a server sends together, variable by variable, is taken in the order in which it was measured."""

import math
import threading
from datetime import UTC, datetime
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.connection import Connection
from tautline.twin.sources.opc_ua import client
from tautline.twin.sources.opc_ua.bursts import Bursts
from tautline.twin.sources.opc_ua.client import OpcUa, _seconds
from tautline.twin.sources.opc_ua.holding import Change

BEGIN, STEP = 1795900000.0, 0.1
COLUMNS = ["winch", "heave", "tension"]


@pytest.fixture
def opcua(monkeypatch):
    """A source that listens to nobody: its queue is filled by hand."""
    pytest.importorskip("asyncua")
    monkeypatch.setattr(OpcUa, "_listen", lambda self: None)
    source = OpcUa("opc.tcp://localhost:4840/x", COLUMNS)
    monkeypatch.setattr(Connection, "watch", lambda self: None)
    yield source
    source.close()


def truth(column, k):
    """What is measured at the k-th stamp."""
    return (1.0 + COLUMNS.index(column)) * STEP * k


def send_first(source):
    for name in COLUMNS:
        source._put(Change(BEGIN, name, 0.0, 1000.0, True))


def send(source, steps, arrived, stamps=None, columns=COLUMNS):
    """One notification: each variable with the readings of all steps, at stamps of their own where they are given."""
    for i, name in enumerate(columns):
        for j, k in enumerate(steps):
            stamp = BEGIN + STEP * k if stamps is None else stamps[j]
            source._put(Change(stamp, name, truth(name, k), arrived + 1e-4 * (i * len(steps) + j)))


def records(source):
    """All records of what is in the queue."""
    found = []
    while source.waiting or source._next is not None or not source._queue.empty():
        record = source.poll(0.0)
        found += [record] if record is not None else []
    return found


def measured(record):
    """The readings of a record that were measured at its stamp."""
    return {name: x for name, x in record.values.items() if x == x and name not in record.repeated}


def measured_records(source, after=BEGIN):
    return [one for one in records(source) if one.time > after and measured(one)]


def is_whole(record):
    """Whether all readings of a record were measured at its stamp."""
    k = round((record.time - BEGIN) / STEP)
    return measured(record) == pytest.approx({name: truth(name, k) for name in COLUMNS})


def test_a_notification_with_several_readings_a_variable_gives_whole_records_in_the_order_of_their_stamps(opcua):
    send_first(opcua)
    for burst in range(10):
        send(opcua, range(5 * burst + 1, 5 * burst + 6), 1000.5 + 0.5 * burst)
        opcua._put(1000.51 + 0.5 * burst)  # the server is alive
    found = measured_records(opcua)
    assert [one.time for one in found] == pytest.approx([BEGIN + STEP * k for k in range(1, 51)], abs=1e-6)
    assert all(is_whole(one) for one in found)


def burst_records(source, size):
    """Records of twelve bursts of so many stamps, between which the server says that it is alive."""
    send_first(source)
    for burst in range(12):
        arrived = 1000.0 + STEP * size * (burst + 1)
        for q in range(1, size):
            source._put(arrived - STEP * (size - q) - 0.02)
        send(source, range(size * burst + 1, size * burst + size + 1), arrived)
        source._put(arrived + 0.02)
    return records(source)


def answered(given, delay):
    """Rows in the order in which they are handed on, and what put them right."""
    rows, found = Rows(COLUMNS, delay=delay, live=True), []
    for one in given:
        rows.add(one.time, one.values, one.arrived, one.repeated)
        while (row := rows.ready()) is not None:
            found.append(row)
    return found, rows


def assert_true(found, rows, size):
    """All rows have the readings of their stamps, and none was late."""
    assert len(found) > 10 * size - 10 and not rows.counts["late"] and not rows.notes
    assert min(b.time - a.time for a, b in pairwise(found)) > 0.9 * STEP
    for row in found:
        k = round((row.time - BEGIN) / STEP)
        assert row.values.tolist() == pytest.approx([truth(name, k) for name in COLUMNS])


@pytest.mark.parametrize("size", [5, 10])
def test_bursts_within_the_delay_give_the_readings_of_their_stamps_and_none_is_late(opcua, size):
    assert_true(*answered(burst_records(opcua, size), STEP * size + 0.2), size)


def test_bursts_beyond_the_delay_are_no_clock_that_was_set_back_and_it_is_said_which_delay_helps(opcua):
    given = burst_records(opcua, 10)
    found, rows = answered(given, None)
    assert not rows.counts["clock set back"] and found[-1].time < BEGIN + 12.0
    (note,) = rows.notes
    assert_true(*answered(given, float(note.split("`delay: ")[1].split(" s`")[0])), 10)


def test_a_burst_that_is_minutes_late_loses_no_reading(opcua):
    send_first(opcua)
    send(opcua, range(1, 51), 1005.0)
    opcua._put(1005.1)
    records(opcua)
    send(opcua, range(51, 3051), 1305.0)
    found = measured_records(opcua, BEGIN + 5.05)
    assert len(found) == 3000 and all(is_whole(one) for one in found)


def test_a_clock_that_is_set_back_within_a_burst_stays_set_back_for_all_variables(opcua):
    send_first(opcua)
    send(opcua, range(1, 21), 1002.0)
    opcua._put(1002.1)
    records(opcua)
    stamps = [BEGIN + STEP * k for k in (21, 22, 23)] + [BEGIN + STEP * k - 1.05 for k in (24, 25, 26)]
    send(opcua, range(21, 27), 1002.6, stamps)
    found = measured_records(opcua)
    assert [one.time for one in found] == stamps
    assert [measured(one) for one in found] == [
        pytest.approx({name: truth(name, k) for name in COLUMNS}) for k in range(21, 27)
    ]


def test_readings_of_one_stamp_all_stay_in_the_order_in_which_they_came(opcua):
    send_first(opcua)
    send(opcua, range(1, 5), 1001.0, stamps=[BEGIN + 1.0] * 4)
    shown = [measured(one) for one in measured_records(opcua)]
    for name in COLUMNS:
        assert [one[name] for one in shown if name in one] == [truth(name, k) for k in range(1, 5)]


def test_a_variable_whose_clock_is_off_by_a_constant_takes_its_place_by_its_own_stamps(opcua):
    send_first(opcua)
    send(opcua, range(1, 11), 1000.5, columns=["winch", "heave"])
    send(opcua, range(1, 11), 1000.51, [BEGIN + STEP * k + 0.03 for k in range(1, 11)], ["tension"])
    times = [one.time for one in measured_records(opcua)]
    assert len(times) == 20 and times == sorted(times)


def test_first_readings_hold_before_what_was_sent_with_them_however_new_their_stamps(opcua):
    for name in COLUMNS:
        opcua._put(Change(BEGIN, name, 0.0, 1000.0, True))
        opcua._put(Change(BEGIN + STEP, name, truth(name, 1), 1000.0))
    first, then = records(opcua)
    assert dict(first.values) == dict.fromkeys(COLUMNS, 0.0) and is_whole(then)


def test_a_stream_without_pauses_is_not_gathered_without_end(opcua):
    send_first(opcua)
    for k in range(1, 1001):
        opcua._put(Change(BEGIN + 0.01 * k, "winch", 0.0, 1000.0 + 0.01 * k))
    while opcua.poll(0.0) is None:
        pass
    assert opcua._queue.qsize() > 500


def queued(source, count, size, step, stamp, alive):
    """Records of so many stamps, in bursts of `size` stamps, with a sign of life after every so many.

    The first hundred come one by one.
    """
    send_first(source)
    for k in range(1, count + 1):
        arrived = 1000.0 + step * (k if k <= 100 else size * math.ceil(k / size))
        for name in COLUMNS:
            source._put(Change(stamp(name, k), name, truth(name, k), arrived))
        if k % alive == 0 or (k <= 100 and size > 1):
            source._put(arrived + 1e-3)
    return records(source)


BURSTS = [(0.1, 20, 20), (0.1, 5, 5), (0.01, 1, 100), (0.01, 1, 10), (0.01, 5, 5)]
"""Step of stamps, s; stamps in a burst; and after how many the server says that it is alive."""
STRAYS = [
    *((3.0, odd, by) for odd in (241, 253, 260) for by in (-1.5, -1.01, 5.5, 30.5)),
    *((None, odd, by) for odd in (241, 253) for by in (-1.5, -1.01, 5.5)),
]
"""Delay of rows, s; which stamp is out of order; and by how many steps. Without a delay none waits beyond its burst."""


@pytest.mark.parametrize(("step", "size", "alive"), BURSTS)
@pytest.mark.parametrize(("delay", "odd", "by"), STRAYS)
def test_one_stamp_out_of_order_tears_no_row_apart_and_is_no_clock_that_was_set_back(
    opcua, step, size, alive, by, delay, odd
):
    def stamp(name, k):
        return BEGIN + step * (k + (by if (name, k) == ("winch", odd) else 0.0))

    found, rows = answered(queued(opcua, 500, size, step, stamp, alive), delay)
    assert not rows.notes and not rows.counts["clock set back"] and rows.counts["late"] <= 1
    found += [*iter(lambda: rows.ready(end=True), None)]
    steps = {round((row.time - BEGIN) / step): row for row in found if np.isfinite(row.values).all()}
    assert set(range(501)) - set(steps) <= {odd}
    for k, row in steps.items():
        true = k if k != odd else row.values[1] / truth("heave", 1)
        assert row.values.tolist() == pytest.approx([truth(name, true) for name in COLUMNS])


@pytest.mark.parametrize("back", [30.5, 36000.0])
@pytest.mark.parametrize("at", [241, 245, 251, 256])
def test_a_clock_that_is_set_back_by_several_readings_within_bursts_is_told_and_no_reading_is_lost(opcua, at, back):
    def stamp(name, k):
        return BEGIN + STEP * (k - (back if k >= at else 0.0))

    found, rows = answered(queued(opcua, 500, 20, STEP, stamp, 20), 2.5)
    found += [*iter(lambda: rows.ready(end=True), None)]
    assert rows.counts["clock set back"] == 1 and len(rows.notes) == 1 and len(found) == 501
    for k, row in enumerate(found):
        assert row.values.tolist() == pytest.approx([truth(name, k) for name in COLUMNS])


@pytest.mark.parametrize("each", [7, 100, 1000])
def test_a_burst_that_is_minutes_late_is_whole_where_signs_of_life_come_in_between(opcua, each):
    send_first(opcua)
    send(opcua, range(1, 51), 1005.0)
    opcua._put(1005.1)
    records(opcua)
    for n, (name, k) in enumerate((name, k) for name in COLUMNS for k in range(51, 1251)):
        if n % each == each - 1:
            opcua._put(1125.0 + 1e-5 * n)
        opcua._put(Change(BEGIN + STEP * k, name, truth(name, k), 1125.0 + 1e-5 * n))
    found = measured_records(opcua, BEGIN + 5.05)
    assert len(found) == 1200 and all(is_whole(one) for one in found)


def test_a_variable_that_comes_seldom_stays_after_a_clock_that_was_set_back_before_its_first_reading_of_a_burst(opcua):
    """The others show within the burst when that was. Later bursts are in the order of their stamps again."""
    back, found = 24, []
    send_first(opcua)
    for begin in (1, 21, 41, 61):
        for name, each in zip(COLUMNS, (1, 1, 10), strict=True):
            for k in [k for k in range(begin, begin + 20) if k % each == 0]:
                stamp = BEGIN + STEP * (k if k < back else k - 30.5)
                opcua._put(Change(stamp, name, truth(name, k), 1000.0 + STEP * begin))
        opcua._put(1000.01 + STEP * begin)
        found += [measured(one) for one in records(opcua)]
    assert [one for one in found if one][1:] == [
        pytest.approx({name: truth(name, k) for name in COLUMNS if k % 10 == 0 or name != "tension"})
        for k in range(1, 81)
    ]


def test_a_clock_that_was_set_back_between_bursts_tears_no_row_apart_of_a_variable_that_came_later(opcua):
    send_first(opcua)
    send(opcua, range(1, 21), 1002.0, columns=["winch", "heave"])
    opcua._put(1002.1)
    records(opcua)
    stamps = [BEGIN + STEP * k - 5.05 for k in range(21, 41)]
    send(opcua, range(21, 41), 1004.0, stamps)
    shown = [measured(one) for one in measured_records(opcua, -math.inf)]
    assert shown == [pytest.approx({name: truth(name, k) for name in COLUMNS}) for k in range(21, 41)]


def gathered(source, monkeypatch, coming):
    """What is gathered of changes that come at their times by a false clock, and how long it was held, s."""
    now, left = coming[0].arrived, list(coming)

    def take(timeout):
        nonlocal now
        if not left or left[0].arrived > now + timeout:
            now += timeout
            return None
        now = max(now, left[0].arrived)
        return left.pop(0)

    monkeypatch.setattr(client, "clock", SimpleNamespace(monotonic=lambda: now))
    monkeypatch.setattr(source, "_take", take)
    found = source._gather(take(1.0))
    return found, now - coming[0].arrived


def stream(step, together=1, stray=None, stalled=0.0):
    """Changes of a variable for 3 s, so many at a time; the first come at once after they were held up for a while."""
    for k in range(round(3.0 / step)):
        came = 2000.0 + max(step * together * (k // together), stalled)
        yield Change(BEGIN + step * k + (30.0 if k == stray else 0.0), "winch", 0.0, came + 1e-5 * (k % together))


@pytest.mark.parametrize(("step", "together"), [(0.005, 1), (0.015, 1), (0.005, 3)])
@pytest.mark.parametrize("stray", [None, 1, 2])
def test_a_stream_without_pauses_is_held_for_a_period_at_most_with_a_stray_stamp_too(
    opcua, monkeypatch, step, together, stray
):
    found, held = gathered(opcua, monkeypatch, list(stream(step, together, stray)))
    assert 0.03 < held < 1e-3 * client.PERIOD + client.GATHER and len(found) > 2


def test_a_stream_that_was_held_up_is_held_as_long_again_at_most(opcua, monkeypatch):
    found, held = gathered(opcua, monkeypatch, list(stream(0.01, stalled=0.3)))
    assert 0.25 < held < 0.35 and len(found) > 50


@pytest.mark.parametrize("pause", [0.002, 0.005, 0.01, 0.015, 0.019])
@pytest.mark.parametrize("each", [2e-5, 1e-4])
def test_notifications_that_were_held_up_are_taken_together_whatever_pauses_are_between_them(
    opcua, monkeypatch, pause, each
):
    """Three of ten variables with sixty readings each; those of the stream come after a longer pause."""
    now, coming = 2000.0, []
    for n in range(30):
        now += pause if n in (10, 20) else 0.0
        for k in range(60):
            coming.append(Change(BEGIN + 0.02 * k, f"v{n}", 0.0, now))
            now += each
    then = [Change(BEGIN + 1.2, f"v{n}", 0.0, now + 1.5 * client.GATHER) for n in range(30)]
    found, held = gathered(opcua, monkeypatch, coming + then)
    assert found == coming and held < now - 2000.0 + 1.5 * client.GATHER
    records = Bursts().records(found)
    assert [len(one) for one in records] == [30] * 60


def test_what_waits_is_looked_at_only_while_nothing_is_put_to_it(opcua):
    """A deque that is changed while it is looked through is an error."""
    last, found = Change(BEGIN, "winch", 0.0, 1000.0), []
    opcua._put(last)
    looks = [
        threading.Thread(target=lambda: found.append(opcua._goes_on(last))),
        threading.Thread(target=lambda: found.append(opcua.waiting)),
    ]
    with opcua._queue.mutex:  # as one that puts something to it has it
        for one in looks:
            one.start()
            one.join(0.05)
        assert not found
    for one in looks:
        one.join(5.0)
    assert found in ([True, 1], [1, True])


def test_a_stamp_at_the_begin_of_opc_ua_time_is_none():
    assert _seconds(datetime(1601, 1, 1, tzinfo=UTC), 5.0) == 5.0
    assert _seconds(datetime(1970, 1, 1, 0, 0, 7), 5.0) == 7.0
