"""OPC UA: what a server sends together, variable by variable, is taken in the order in which it was measured."""

import math
from datetime import UTC, datetime
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.connection import Connection
from tautline.twin.sources.opc_ua import client
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


@pytest.mark.parametrize(("step", "size", "alive"), BURSTS)
@pytest.mark.parametrize("by", [-1.5, -1.01, 5.5])
@pytest.mark.parametrize("delay", [None, 3.0])
def test_one_stamp_out_of_order_tears_no_row_apart_and_is_no_clock_that_was_set_back(
    opcua, step, size, alive, by, delay
):
    odd = 253

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


@pytest.mark.parametrize("each", [0.005, 0.015])
def test_a_stream_that_comes_one_by_one_is_held_for_a_period_at_most(opcua, monkeypatch, each):
    now, sent = 2000.0, 0

    def take(timeout):
        nonlocal now, sent
        came = 2000.0 + each * (sent + 1)
        if came > now + timeout:
            now += timeout
            return None
        now, sent = max(now, came), sent + 1
        return Change(BEGIN + each * sent, "winch", 0.0, came)

    monkeypatch.setattr(client, "clock", SimpleNamespace(monotonic=lambda: now))
    monkeypatch.setattr(opcua, "_take", take)
    gathered = opcua._gather(take(1.0))
    assert 0.03 < now - gathered[0].arrived < 1e-3 * client.PERIOD + client.GATHER
    assert len(gathered) == sent > 2


def test_a_stamp_at_the_begin_of_opc_ua_time_is_none():
    assert _seconds(datetime(1601, 1, 1, tzinfo=UTC), 5.0) == 5.0
    assert _seconds(datetime(1970, 1, 1, 0, 0, 7), 5.0) == 7.0
