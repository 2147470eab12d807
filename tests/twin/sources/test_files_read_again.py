"""A file that is read once more from its begin, where a twin goes on from a state: no row is lost or taken twice."""

import json
import math

import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.record import Record
from tautline.twin.sources.rereading import Rereading

STAMPS = [0.1 * k for k in range(100)]
SET_BACK = [*STAMPS[:60], *(t - 4.0 for t in STAMPS[60:])]
"""The clock is set back by 4 s after 60 rows."""
FUTURE = [*STAMPS[:70], 1e6, *STAMPS[70:]]
SWAPPED = [*STAMPS[:68], STAMPS[69], STAMPS[68], *STAMPS[70:]]


def records(stamps):
    return [Record(t, {"a": float(k)}, 0.0) for k, t in enumerate(stamps)]


def taken(stamps, memory=None, rows=None, end=True):
    """What a process hands on of a file: readings in order; and what it saves."""
    rows = Rows(["a"]) if rows is None else rows
    begin = math.nan if memory is None else rows.reached
    reading = Rereading(memory["heard"] if memory else {}, begin, rows.shift)
    found = []

    def add(new):
        for one in new:
            rows.place = reading.place
            rows.add(one.time, one.values)
            while (row := rows.ready()) is not None:
                found.append(float(row.values[0]))

    for record in records(stamps):
        add(reading.new(record))
    add(reading.rest())
    saved = {"heard": reading.memory(rows.held), "rows": rows.memory()}
    while end and (row := rows.ready(True)) is not None:
        found.append(float(row.values[0]))
    return found, json.loads(json.dumps(saved))


def gone_on(stamps, memory):
    rows = Rows(["a"])
    rows.recall(memory["rows"])
    return taken(stamps, memory, rows)[0]


@pytest.mark.parametrize("stamps", [STAMPS, SET_BACK, FUTURE, SWAPPED])
@pytest.mark.parametrize("cut", [3, 40, 59, 61, 62, 64, 66, 69, 71, 72, 100])
def test_a_file_that_has_grown_is_gone_on_with_where_it_ended_also_where_its_clock_was_set_back(stamps, cut):
    whole = taken(stamps)[0]
    first, memory = taken(stamps[:cut], end=False)
    assert first + gone_on(stamps, memory) == whole


@pytest.mark.parametrize("lost", [slice(100, 120), slice(60, 100)])
def test_a_file_that_has_lost_rows_since_loses_none_that_are_new(lost):
    stamps = [0.1 * k for k in range(240)]
    first, memory = taken(stamps[:120], end=False)
    fewer = [*stamps[: lost.start], *stamps[lost.stop :]]
    found = gone_on(fewer, memory)
    answered = stamps[: len(first)]
    # readings are places in the file: those behind what was answered
    assert [fewer[int(k)] for k in found] == [t for t in fewer if t > answered[-1]]


def test_another_file_is_gone_on_with_by_its_stamps_and_its_rows_are_not_those_of_the_first():
    _, memory = taken(STAMPS)
    other = [t + 0.05 for t in STAMPS] + [10.0 + t for t in STAMPS]
    found = gone_on(other, memory)
    new = [float(k) for k, t in enumerate(other) if t > STAMPS[-4] + 1e-9]
    assert len(found) >= 100 and found == new[-len(found) :]


def test_a_state_that_has_not_counted_rows_is_gone_on_with_by_stamps():
    first, memory = taken(STAMPS[:50], end=False)
    assert first + gone_on(STAMPS, memory | {"heard": {}}) == taken(STAMPS)[0]


@pytest.mark.parametrize(("stamps", "shift"), [(STAMPS, 0.0), (SET_BACK, 4.0)])
def test_a_file_whose_last_row_was_changed_in_its_place_is_not_said_to_have_surely_lost_rows(stamps, shift):
    _, memory = taken(stamps, end=False)
    reading = Rereading(memory["heard"], 9.0, shift)
    seen = records(stamps)
    seen[-1].values["a"] = -1.0
    for record in seen:
        list(reading.new(record))
    list(reading.rest())
    assert len(reading.notes) == 1
    assert "the file has lost rows, or some were changed, since the state was saved" in reading.notes[0]
