"""OPC UA: a variable that is not sent again holds as long as the server is alive and calls it good."""

import time as clock
from datetime import UTC, datetime, timedelta
from itertools import pairwise

import pytest
from twin.sources.test_sources_of_data import free_port, server

from tautline.twin.sources.opc_ua import holding
from tautline.twin.sources.opc_ua.holding import Change, Holding
from tautline.twin.sources.opening import open_source

BEGIN = datetime(2026, 11, 23, 12, tzinfo=UTC)
COLUMNS = ["heave", "rope_tension"]


def send(running, k, values, status=0):
    """Write values with the stamp of a row; those in `values` only."""
    from asyncua import ua

    async def work():
        stamp = BEGIN + timedelta(seconds=0.05 * k)
        for name, value in values.items():
            variant = ua.Variant(value, ua.VariantType.Double)
            data = ua.DataValue(variant, ua.StatusCode(status), SourceTimestamp=stamp, ServerTimestamp=stamp)
            await running.thing.variables[name].write_value(data)

    running.do(work())


def now(running):
    """Row of this moment, by the clock of the stamps."""
    return (clock.monotonic() - running.begun) / 0.05


def records(source, seconds):
    found, end = [], clock.monotonic() + seconds
    while clock.monotonic() < end:
        if (record := source.poll(0.02)) is not None:
            found.append(record)
    return found


@pytest.fixture(scope="module")
def serving():
    """A server and its port. It takes most of a second to start: it lays out five thousand nodes of the standard."""
    port = free_port()
    running = server(port)
    yield running, port
    running.stop()


@pytest.fixture
def connected(serving):
    """A server with values of a first row, and a source that has heard them."""
    running, port = serving
    running.begun = clock.monotonic()
    send(running, 0, {"heave": 0.25, "rope_tension": 49.0})
    source = open_source(f"opc.tcp://127.0.0.1:{port}/tautline/", COLUMNS)
    end = clock.monotonic() + 20.0
    while clock.monotonic() < end and not records(source, 0.1):
        pass
    yield running, source
    source.close()


def test_rows_come_once_a_second_where_a_server_has_nothing_to_send(connected):
    _, source = connected
    rows, end = [], clock.monotonic() + 30.0
    while len(rows) < 3 and clock.monotonic() < end:
        rows += records(source, 0.1)
    assert len(rows) >= 3
    assert all(dict(row.values) == {"heave": 0.25, "rope_tension": 49.0} for row in rows)
    steps = [b.time - a.time for a, b in pairwise(rows)]
    assert steps == pytest.approx([1.0] * len(steps), abs=1e-3)


def test_a_value_that_is_written_anew_without_a_change_is_a_reading_of_its_stamp(hurried, connected):
    running, source = connected
    found, begin = [], round(now(running)) + 20
    for k in range(20):
        send(running, begin + k, {"heave": 0.25, "rope_tension": 50.0 + 0.1 * k})
        found += records(source, 0.06)
    found += records(source, 0.4)
    rows = {round((row.time - BEGIN.timestamp()) / 0.05 - begin, 3): dict(row.values) for row in found}
    assert [rows[k]["heave"] for k in range(20)] == [0.25] * 20
    assert [rows[k]["rope_tension"] for k in range(20)] == pytest.approx([50.0 + 0.1 * k for k in range(20)])


def test_a_variable_whose_status_goes_bad_has_no_reading_and_this_is_told_though_its_value_stays(hurried, connected):
    running, source = connected
    changed = now(running)
    send(running, changed, {"rope_tension": 49.0}, status=0x808D0000)  # BadOutOfService
    after, rows, end = BEGIN.timestamp() + 0.05 * changed, [], clock.monotonic() + 30.0
    while len(rows) < 3 and clock.monotonic() < end:
        rows += [row for row in records(source, 0.1) if row.time > after + 0.2]
    assert len(rows) >= 3
    assert all(row.values["rope_tension"] != row.values["rope_tension"] for row in rows)
    assert all(row.values["heave"] in (0.25,) for row in rows)
    assert [note for note in source.notes if "rope_tension" in note and "count as missing" in note]


@pytest.mark.parametrize(("status", "used"), [(0x40930000, True), (0x40900000, False)])
def test_an_uncertain_reading_is_used_unless_its_status_says_that_it_is_not_measured(hurried, connected, status, used):
    running, source = connected
    changed = now(running)
    send(running, changed, {"rope_tension": 60.0}, status=status)
    rows, end = [], clock.monotonic() + 30.0
    while (not rows or rows[-1].time < BEGIN.timestamp() + 0.05 * changed + 0.5) and clock.monotonic() < end:
        rows += records(source, 0.1)
    assert [row.values["rope_tension"] == 60.0 for row in rows[-1:]] == [used]
    word = "are used" if used else "count as missing"
    assert len([note for note in source.notes if "Uncertain" in note and word in note]) == 1


def test_nothing_is_held_any_more_when_the_server_is_lost(hurried, connected):
    running, source = connected
    running.do(running.thing.stop())
    end = clock.monotonic() + 30.0
    while not any("was lost" in note for note in source.notes) and clock.monotonic() < end:
        records(source, 0.1)
    records(source, 0.3)
    assert not records(source, 1.0)
    running.do(running.thing.start())


def test_a_sensor_that_is_measured_once_a_second_makes_no_stairs_among_faster_ones():
    made, rows = Holding(["fast", "slow"], 0.05), []
    for k in range(201):
        changes = [Change(0.05 * k, "fast", 0.1 * k, 0.05 * k, k == 0)]
        if k % 20 == 0:
            changes.append(Change(0.05 * k, "slow", 7.0 + k, 0.05 * k, k == 0))
        rows += made.records(changes)
    slow = [k for k, row in enumerate(rows) if row.values["slow"] == row.values["slow"] and k > 80]
    assert slow == [100, 120, 140, 160, 180, 200]


def test_a_lever_that_is_moved_now_and_then_has_a_reading_in_every_row():
    made, rows = Holding(["fast", "lever"], 0.05), []
    for k in range(400):
        changes = [Change(0.05 * k, "fast", 0.1 * k, 0.05 * k, k == 0)]
        if k in (0, 7, 60, 64, 200, 203, 310):
            changes.append(Change(0.05 * k, "lever", float(k), 0.05 * k, k == 0))
        rows += made.records(changes)
    known = [row.values["lever"] == row.values["lever"] for row in rows]
    assert known.count(False) <= 7  # one after each change
    assert all(known[k] for k in range(320, 400))


def test_how_often_a_variable_is_measured_is_found_once_a_change_however_many_records_repeat_it(monkeypatch):
    made, asked, usual = Holding(["a", "b"], 0.05), [], holding._usual
    monkeypatch.setattr(holding, "_usual", lambda given: asked.append(given) or usual(given))
    for k in range(31):
        made.records([Change(0.1 * k, name, 0.1 * k, 0.1 * k, k == 0) for name in "ab"])
    changes = len(asked)
    assert 0 < changes <= 60
    # five seconds of silence: readings of every tenth of a second hold
    more = made.until(8.0)
    assert len(more) > 40 and {one.values["a"] for one in more} == {3.0} and len(asked) == changes


def test_what_stood_still_while_the_connection_was_lost_goes_on_from_its_own_clock():
    made = Holding(["a"], 0.05, now=lambda: 1e9)
    made.records([Change(100.0, "a", 1.0, 0.0, True)])
    made.until(10.0)
    made.forget()
    assert made.until(20.0) == []
    assert made.records([Change(100.0, "a", 1.0, 30.0, True)])[0].time == 130.0


def test_a_machine_that_has_stood_for_an_hour_stands_there_now_and_not_an_hour_ago():
    now = 1.795e9
    made = Holding(["a"], 0.05, now=lambda: now)
    at = clock.monotonic()
    assert made.records([Change(now - 3600.0, "a", 1.0, at, True)]) == []
    rows = made.until(at + 4.1)
    assert rows[0].time == pytest.approx(now, abs=1.0) and len(rows) == 4


def test_the_first_readings_have_the_clock_of_the_changes_after_them():
    made = Holding(["a", "b"], 0.05)
    assert made.records([Change(10.0, "a", 1.0, 500.0, True), Change(700.0, "b", 2.0, 500.0, True)]) == []
    first, *_, second = made.records([Change(1000.0, "a", 1.5, 500.4)])
    assert first.time == pytest.approx(999.6) and dict(first.values) == {"a": 1.0, "b": 2.0}
    assert second.time == 1000.0 and second.values["b"] == 2.0
