"""A stream that is gone on with and repeats rows that were answered, such as the last lines of a log."""

import json
import time as clock
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest
from of_the_suite import studies

from tautline.cli.commands import twin as command
from tautline.twin.signals.rows import Rows
from tautline.twin.sources.connection import Silence
from tautline.twin.sources.record import Record
from tautline.twin.twin import Twin

STEP = 0.05
STAMPS = [round(1.8e9 + STEP * k, 2) for k in range(4000)]
COLUMNS = ("x", "y")
READ = 3000


def readings(k):
    return {"x": np.sin(0.1 * k), "y": float(k % 7)}


def taken(rows, numbers, first=0.0, every=0.0, stamps=STAMPS):
    """Stamps of the rows that are handed on of those with these numbers, which arrive from a time on."""
    came = []
    for i, k in enumerate(numbers):
        rows.add(stamps[k], readings(k), arrived=first + every * i)
        while (row := rows.ready()) is not None:
            came.append(row.time)
    return came


@pytest.fixture(scope="module")
def memory():
    """What a process kept that was ended behind some rows."""
    rows = Rows(COLUMNS)
    came = taken(rows, range(READ))
    return json.loads(json.dumps(rows.memory())), len(came)


def gone_on(memory):
    rows = Rows(COLUMNS, live=True)
    rows.recall(json.loads(json.dumps(memory)))
    return rows


@pytest.mark.parametrize("back", [21, 1000, 2500])
@pytest.mark.parametrize("old", [False, True], ids=["state of now", "state of an earlier version"])
def test_rows_that_a_resumed_stream_repeats_are_left_out_and_stamps_stay_as_they_are(memory, back, old):
    kept, answered = memory
    rows = gone_on({name: value for name, value in kept.items() if not (old and name == "answered")})
    # A log is read at once up to where it ends, and then as it grows.
    came = taken(rows, range(READ - back, READ)) + taken(rows, range(READ, READ + 100), 0.05, STEP)
    assert came == STAMPS[answered : answered + len(came)] and len(came) > 90
    assert rows.shift == 0.0 and not rows.counts["clock set back"] and not rows.notes
    assert rows.counts["doubled"] + rows.counts["late"] == back - (READ - answered)


@pytest.mark.parametrize("back", [1.5, 600.0])
def test_a_clock_that_was_set_back_while_no_twin_ran_is_seen_and_no_row_of_a_second_on_is_lost(memory, back):
    rows = gone_on(memory[0])
    shifted = [round(stamp - back - 0.01, 2) for stamp in STAMPS]
    came = taken(rows, range(READ, READ + 200), 0.0, STEP, shifted)
    assert rows.counts["clock set back"] == 1 and len(rows.notes) == 1
    assert len(came) > 200 - 1.0 / STEP - 10 and np.allclose(np.diff(came), STEP, atol=1e-6)
    assert came[0] > memory[0]["reached"]


@pytest.mark.parametrize(
    ("old", "told", "them"), [(100, "100 rows are", "They are"), (1, "1 row is", "It is")], ids=["many", "one"]
)
def test_a_stream_that_repeats_an_old_part_and_ends_there_is_left_out_and_sets_no_clock_back(memory, old, told, them):
    rows = gone_on(memory[0])
    assert not taken(rows, range(old)) and rows.ready(end=True) is None
    assert rows.shift == 0.0 and rows.counts["late"] == old
    (note,) = rows.notes
    assert note.startswith(f"{told} from before all that were answered") and note.endswith(f"{them} left out")


def test_a_stream_that_is_silent_has_not_ended_and_rows_in_doubt_wait_on(memory, monkeypatch):
    monkeypatch.setattr(command, "SILENCE", 0.0)
    rows, came = gone_on(memory[0]), []
    shifted = [round(stamp - 65.01, 2) for stamp in STAMPS]
    buffered = [(shifted[k], readings(k), 0.0) for k in range(READ, READ + 40)]
    measured = [(shifted[k], readings(k), 3.0 + STEP * (k - READ)) for k in range(READ + 40, READ + 200)]
    coming = [*(Record(*one) for one in buffered), None, None, *(Record(*one) for one in measured)]
    twin = SimpleNamespace(readings=SimpleNamespace(rows=rows), _answer=lambda row: row.time, work=lambda _: False)
    twin.answers = lambda **how: Twin.answers(twin, **how)
    source = SimpleNamespace(ended=False, live=True)

    def poll(_timeout):
        clock.sleep(0.001 if coming[0] is None else 0.0)
        source.ended = len(coming) == 1
        return coming.pop(0)

    def add(record):
        rows.add(record.time, record.values, record.arrived)
        came.extend(twin.answers())

    source.poll = poll
    told = {
        "silence": Silence("a stream", 5.0),
        "ending": None,
        "_hurries": False,
        "_notice": lambda _: None,
        "_watch_silence": lambda: None,
        "_not_used": Counter,
    }
    loop = SimpleNamespace(
        source=source, twin=twin, rereading=None, _add=add, _pass_on=lambda: None,
        _take_in=lambda answer: came.extend(answer()), **told,
    )  # fmt: skip
    loop._hear = lambda record, now: command._Loop._hear(loop, record, now)
    command._Loop._hear_all(loop)
    came.extend(Twin.finish(twin))
    assert len(came) == 200 and not rows.counts["late"] and rows.counts["clock set back"] == 1
    (note,) = rows.notes
    assert "set back by 64.9 s" in note


@pytest.mark.parametrize("back", [40.0, 65.0])
def test_rows_of_a_clock_that_was_set_back_are_not_taken_for_repeated_ones_though_they_come_all_at_once(memory, back):
    rows = gone_on(memory[0])
    shifted = [round(stamp - back - 0.01, 2) for stamp in STAMPS]
    came = taken(rows, range(READ, READ + 300), stamps=shifted)
    while (row := rows.ready(end=True)) is not None:
        came.append(row.time)
    assert rows.counts["clock set back"] == 1 and not rows.counts["late"] and not rows.counts["doubled"]
    assert len(came) >= 300 and np.allclose(np.diff(came), STEP, atol=1e-6)


def test_rows_that_waited_are_taken_back_one_by_one_so_that_few_are_looked_among():
    count, most, came = 3000, 0, []
    rows = Rows(COLUMNS, live=True)
    rows.recall({"reached": STAMPS[-1], "shift": 0.0, "interval": STEP, "counts": {}})
    stamps = [STAMPS[0] - STEP * (count + 1 - k) for k in range(count + 1)]
    assert not taken(rows, range(count), stamps=stamps)
    rows.add(stamps[count], readings(count), arrived=float(count))
    while (row := rows.ready()) is not None:
        came.append(row.time)
        most = max(most, len(rows.waiting))
    assert most < 10
    assert rows.counts["clock set back"] == 1 and not rows.counts["late"]
    assert len(came) >= count - 3 and np.allclose(np.diff(came), STEP, atol=1e-6)


def test_repeated_rows_with_other_readings_are_of_a_clock_that_was_set_back(memory):
    rows = gone_on(memory[0])
    for k in range(READ - 20, READ + 20):
        rows.add(STAMPS[k], {"x": 5.0 + 0.01 * k, "y": 1.0})
    assert rows.counts["clock set back"] == 1


def test_columns_that_come_in_rows_of_their_own_are_known_again(memory):
    rows = gone_on(memory[0])
    for k in range(READ - 30, READ):
        for late, name in enumerate(COLUMNS):
            rows.add(STAMPS[k] + 0.001 * late, {name: readings(k)[name]})
    assert rows.shift == 0.0 and not rows.counts["clock set back"]


def read_and_gone_on(records, read, back):
    """A stream of stamps and readings that is read, and gone on with from some records back; rows and their stamps."""
    rows = Rows(COLUMNS)
    for stamp, values in records[:read]:
        rows.add(stamp, values)
        while rows.ready() is not None:
            pass
    rows = gone_on(rows.memory())
    came = []
    for i, (stamp, values) in enumerate(records[read - back : read + 100]):
        rows.add(stamp, values, arrived=max(0, i + 1 - back) * STEP)
        while (row := rows.ready()) is not None:
            came.append(row.time)
    return rows, came


@pytest.mark.parametrize("back", [100, *studies(2500)])
@pytest.mark.parametrize("kind", ["late", "stamp twice"])
@pytest.mark.parametrize("every", [20, *studies(100)])
def test_rows_that_were_late_or_had_a_stamp_twice_set_no_clock_back_when_they_are_repeated(kind, every, back):
    records = []
    for k, stamp in enumerate(STAMPS):
        records.append((stamp, readings(k)))
        if k % every == 0 and k > 20:
            other = round(STAMPS[k - 10] + 0.017, 3) if kind == "late" else stamp
            records.append((other, {"x": 9.0, "y": float(k)}))
    rows, came = read_and_gone_on(records, READ, back)
    assert rows.shift == 0.0 and not rows.counts["clock set back"]
    assert 90 < len(came) < 110 and {*came} <= {*STAMPS} and np.allclose(np.diff(came), STEP, atol=1e-6)


@pytest.mark.parametrize("ahead", [2.0, *studies(86400.0)])
@pytest.mark.parametrize("at", [300, READ - 100], ids=["before the last minute", "within it"])
def test_a_repeated_row_with_a_stamp_from_the_future_does_not_end_what_a_stream_repeats(at, ahead):
    records = [(stamp, readings(k)) for k, stamp in enumerate(STAMPS)]
    records[at] = (STAMPS[READ] + ahead, readings(at))
    rows, came = read_and_gone_on(records, READ, READ)
    assert rows.shift == 0.0 and not rows.counts["clock set back"] and not rows.notes
    assert rows.counts["future"] == 2  # as it was read, and as it is repeated
    assert 90 < len(came) < 110 and {*came} <= {*STAMPS}


def test_a_row_from_the_future_among_those_of_a_clock_that_was_set_back_costs_no_other(memory):
    rows = gone_on(memory[0])
    shifted = [round(stamp - 65.01, 2) for stamp in STAMPS]
    taken(rows, range(READ, READ + 3), stamps=shifted)
    rows.add(STAMPS[-1], readings(0))
    came = taken(rows, range(READ + 3, READ + 300), stamps=shifted)
    assert rows.counts["clock set back"] == rows.counts["future"] == 1 and not rows.counts["late"]
    assert len(came) > 290 and np.allclose(np.diff(came), STEP, atol=1e-6)
