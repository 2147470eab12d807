"""False stamps, and columns in rows of their own, in a file that is read once more: it is gone on with as if in one."""

import json
import math

import pytest

from tautline.twin.signals.rows import Rows
from tautline.twin.sources.record import Record
from tautline.twin.sources.rereading import LOST, LOST_BEFORE, Rereading

STAMPS = [0.1 * k for k in range(100)]
SENTINEL = 4294967.295
FALSE = {
    "the same twice": {20: SENTINEL, 50: SENTINEL},
    "neighbouring": {20: 1e6, 50: 1e6 + 0.1},
    "rising": {20: 1e6, 50: 1e6 + 0.1, 60: 1e6 + 0.2},
    "falling": {20: 1e6, 50: 1e6 - 0.1, 60: 1e6 - 0.2},
    "one hour ahead": {20: 3602.0, 30: 3603.0},
    "some seconds ahead": {20: 8.0, 30: 9.0},
    "rising by seconds": {20: 3602.0, 50: 3605.0},
}
EVERY = 7
"""Rows from one false stamp to the next, where there are many."""


def with_false(stamps, false):
    """Stamps with false ones before those at some places."""
    return [one for k, stamp in enumerate(stamps) for one in ([false[k]] if k in false else []) + [stamp]]


def one_column(stamps):
    """Records whose reading is their stamp."""
    return [Record(stamp, {"a": stamp}, 0.0) for stamp in stamps]


def columns_apart(count, apart):
    """Records of two columns in rows of their own, so many seconds apart."""
    return [
        Record(0.1 * k + apart * j, {one: float(k) if one == name else math.nan for one in "ab"}, 0.0)
        for k in range(count)
        for j, name in enumerate("ab")
    ]


class Process:
    """What reads a file from its begin, and goes on from what another has saved.

    It is killed after so many answers, with what it had saved then.
    """

    def __init__(self, records, saved=None, finish=True, answers=math.inf):
        self.rows = Rows(list(records[0].values))
        if saved is not None:
            self.rows.recall(saved["rows"])
        begin = math.nan if saved is None else self.rows.reached
        self.reading = Rereading({} if saved is None else saved["heard"], begin, self.rows.shift)
        self.answered, self.saved, self._answers = [], saved, answers
        for record in records:
            self._take(self.reading.new(record))
        self._take(self.reading.rest())
        if not self._killed:
            self._save()
        while finish and not self._killed and (row := self.rows.ready(True)) is not None:
            self.answered.append((row.time, *row.values.tolist()))

    @property
    def _killed(self):
        return len(self.answered) >= self._answers

    def _save(self):
        heard = self.reading.memory(self.rows.held, self.rows.newest)
        self.saved = json.loads(json.dumps({"heard": heard, "rows": self.rows.memory()}))

    def _take(self, new):
        for record in new:
            if self._killed:
                return
            self.rows.place = self.reading.place
            self.rows.add(record.time, record.values)
            while (row := self.rows.ready()) is not None:
                self.answered.append((row.time, *row.values.tolist()))
                self._save()


def text(rows):
    """Rows that can be compared, also where a reading is missing."""
    return [str(row) for row in rows]


@pytest.mark.parametrize("cut", [40, 56, 70, 90])
@pytest.mark.parametrize("false", FALSE.values(), ids=FALSE)
def test_a_file_with_false_stamps_is_gone_on_with_as_if_it_were_read_in_one(false, cut):
    records = one_column(with_false(STAMPS, false))
    whole = Process(records).answered
    first = Process(records[:cut], finish=False)
    assert first.answered + Process(records, first.saved).answered == whole
    assert whole[-1][0] == STAMPS[-1]


@pytest.mark.parametrize("cut", [80, 81, 120, 121])
def test_columns_in_rows_of_their_own_are_counted_once_where_a_file_is_read_again(cut):
    records = columns_apart(100, apart=0.002)
    whole = Process(records).answered
    first = Process(records[:cut], finish=False)
    assert text(first.answered + Process(records, first.saved).answered) == text(whole)
    assert len(whole) == 100


@pytest.mark.parametrize("lost", [slice(100, 130), slice(60, 100), slice(55, 60), slice(51, 125)])
@pytest.mark.parametrize("stamp", [SENTINEL, 3602.0])
def test_false_stamps_in_a_file_that_lost_rows_are_not_believed_and_none_that_are_new_is_lost(lost, stamp):
    stamps = [0.1 * k for k in range(240)]
    false = dict.fromkeys(range(6, 240, EVERY), stamp)
    records = one_column(with_false(stamps, false))
    first = Process(records[:150], finish=False)
    again = Process(records[: lost.start] + records[lost.stop :], first.saved)
    kept = {record.time for record in records[: lost.start] + records[lost.stop :]} - {stamp}
    reached = first.answered[-1][0]
    assert [time for time, _ in again.answered] == [time for time in stamps if time > reached and time in kept]
    # what has gone on in the shorter file is known by its places again
    longer = records[: lost.start] + records[lost.stop :] + one_column([24.0 + 0.1 * k for k in range(9)])
    part = Process(records[: lost.start] + records[lost.stop :], first.saved, finish=False)
    both = part.answered + Process(longer, part.saved).answered
    assert [time for time, _ in both][: len(again.answered)] == [time for time, _ in again.answered]
    assert len(both) == len(again.answered) + 9


@pytest.mark.parametrize("first_left", [1, 60, 120])
def test_false_stamps_before_what_is_new_are_not_believed_in_a_file_whose_begin_was_cut_off(first_left):
    stamps = [0.1 * k for k in range(240)]
    records = one_column(with_false(stamps, dict.fromkeys(range(6, 240, EVERY), SENTINEL)))
    first = Process(records[:150], finish=False)
    again = Process(records[first_left:], first.saved)
    reached = first.answered[-1][0]
    assert [time for time, _ in again.answered] == [time for time in stamps if time > reached]


def test_a_file_that_was_shortened_below_what_was_read_is_gone_on_with_by_its_stamps():
    stamps = [0.1 * k for k in range(240)]
    first = Process(one_column(stamps[:150]), finish=False)
    again = Process(one_column([*stamps[:60], *stamps[145:180]]), first.saved)
    reached = first.answered[-1][0]
    assert [time for time, _ in again.answered] == [time for time in stamps[145:180] if time > reached]
    assert again.reading.notes == [LOST]


@pytest.mark.parametrize("lost", [0, 20])
def test_rows_that_are_left_out_of_a_file_that_lost_some_behind_a_clock_that_was_set_back_are_told(lost):
    records = one_column([*(0.1 * k for k in range(60)), *(0.1 * k - 4.0 for k in range(60, 240))])
    first = Process(records[:150], finish=False)
    again = Process(records[:100] + records[100 + lost :], first.saved)
    assert len(first.answered) + len(again.answered) == 240 - lost
    assert again.reading.notes == ([LOST_BEFORE] if lost else [])


@pytest.mark.parametrize("answers", [1, 2, 3, 5, 6, 20])
def test_a_process_that_is_killed_while_it_goes_on_in_a_file_that_lost_rows_loses_none(answers):
    stamps = [0.1 * k for k in range(240)]
    records = one_column(with_false(stamps, dict.fromkeys(range(6, 240, EVERY), SENTINEL)))
    first = Process(records[:150], finish=False)
    fewer = records[:60] + records[100:]
    whole = Process(fewer, first.saved).answered
    killed = Process(fewer, first.saved, answers=answers)
    assert killed.answered + Process(fewer, killed.saved).answered == whole


@pytest.mark.parametrize("false", FALSE.values(), ids=FALSE)
def test_a_state_of_an_earlier_version_is_gone_on_with_by_places(false):
    records = one_column(with_false(STAMPS, false))
    first = Process(records[:70], finish=False)
    heard = {key: first.saved["heard"][key] for key in ("read", "held", "mark", "shown")}
    assert first.answered + Process(records, first.saved | {"heard": heard}).answered == Process(records).answered


def test_a_row_of_the_same_time_as_the_last_that_was_answered_is_not_lost():
    stamps = [0.1 * k for k in range(100)]
    records = [Record(stamp, {"a": float(k), "b": math.nan}, 0.0) for k, stamp in enumerate(stamps)]
    records.append(Record(stamps[-1], {"a": math.nan, "b": 7.0}, 0.0))
    first = Process(records[:-1], finish=False)
    assert Process(records, first.saved).answered[-1] == (stamps[-1], 99.0, 7.0)
