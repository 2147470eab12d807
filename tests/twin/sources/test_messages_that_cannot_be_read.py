"""One message never ends the reading: what cannot be read is counted, and a fault of the reading thread is told."""

import io
import json
import time as clock

import pytest
from twin.sources.messages import Message, without_broker
from twin.sources.test_sources_of_data import all_of, free_port, written

from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.opening import open_source
from tautline.twin.sources.record import SourceFault
from tautline.twin.sources.stream import Stream

HUGE = '{"time": 3.02, "a": 1' + "0" * 400 + "}"
DEEP = "[" * 100_000


def test_a_line_with_an_endless_number_or_brackets_without_end_does_not_end_a_stream():
    lines = ['{"time": 0, "a": 1}', HUGE, DEEP, '{"a": ' + DEEP, '{"time": 1, "a": 2}']
    source = Stream(io.StringIO("\n".join(lines) + "\n"), ["a"])
    rows = [row for row in all_of(source) if row.values["a"] == row.values["a"]]
    assert [(row.time, row.values["a"]) for row in rows] == [(0.0, 1.0), (1.0, 2.0)]
    assert source.ended and source.refused == 2


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_line_with_an_endless_cell_is_counted_as_one_that_cannot_be_read(tmp_path, of):
    text = f"time,a\n0,1\n1,{'x' * 200_000}\n2,3\n"
    made = CsvFile(written(tmp_path / "r.csv", text), ["a"]) if of == "file" else Stream(io.StringIO(text), ["a"])
    assert [row.time for row in all_of(made)] == [0.0, 2.0] and made.refused == 1


@pytest.fixture
def mqtt():
    source = without_broker(["a"])
    yield source
    source.close()


def of_messages(mqtt):
    """What was told, but for that nobody answers at the port."""
    return [note for note in mqtt.notes if "topic" in note]


def test_a_message_with_an_endless_number_or_brackets_without_end_is_counted_and_the_next_is_read(mqtt):
    for payload in (HUGE, DEEP, '{"time": 1, "a": 2}'):
        mqtt._take(None, None, Message(payload))
    assert mqtt.refused == 2 and mqtt.poll(0.1).values["a"] == 2.0


def test_a_column_that_two_topics_bring_is_taken_from_the_first_and_this_is_told_once(mqtt):
    for topic, value in (("site/one/a", 1), ("site/two/a", 2), ("site/one/a", 3), ("site/two/a", 4)):
        mqtt._take(None, None, Message(f'{{"time": {value}, "value": {value}}}', topic))
    assert [mqtt.poll(0.1).values["a"] for _ in range(2)] == [1.0, 3.0] and mqtt.poll(0.0) is None
    assert len([note for note in mqtt.notes if "column 'a' comes from two topics" in note]) == 1


def test_what_the_broker_has_kept_of_a_topic_that_is_used_no_more_takes_no_column_from_the_one_that_is(mqtt):
    mqtt._take(None, None, Message('{"time": 1, "value": 4}', "site/old/a", retain=True))
    for value in (5, 6):
        mqtt._take(None, None, Message(f'{{"time": {value}, "value": {value}}}', "site/a"))
    mqtt._take(None, None, Message('{"time": 1, "value": 4}', "site/old/a", retain=True))  # connected again
    assert [mqtt.poll(0.1).values["a"] for _ in range(3)] == [4.0, 5.0, 6.0] and mqtt.poll(0.0) is None
    (note,) = of_messages(mqtt)
    assert "two topics, site/a and site/old/a: readings of site/old/a are left out" in note
    assert (mqtt.refused, mqtt.left_out) == (0, 1)


LEFT_OUT = {
    '[{"time": 1, "a": 1}, {"time": 2, "a": 2}]': "a list of 2 values is left out",
    '{"time": 1, "values": {"a": 1}}': "'values' holds an object",
    '{"time": 1, "a": {"value": 1, "unit": "kN"}}': "'a' holds an object",
    '{"time": 1, "a": [1, 2]}': "'a' holds a list",
}


@pytest.mark.parametrize("payload", LEFT_OUT)
def test_a_message_of_which_columns_stand_deeper_is_told_in_words_once(mqtt, payload):
    for _ in range(2):
        mqtt._take(None, None, Message(payload, "crane/row"))
    (note,) = of_messages(mqtt)
    assert mqtt.poll(0.0) is None and f"topic crane/row: {LEFT_OUT[payload]}" in note
    assert mqtt.refused + mqtt.left_out == 2


def test_a_message_of_a_column_without_its_value_tells_its_keys_and_one_of_other_things_tells_nothing(mqtt):
    mqtt._take(None, None, Message('{"Value": 1, "Time": 2}', "crane/a"))
    mqtt._take(None, None, Message('{"state": {"b": 1}}', "crane/lamps"))
    mqtt._take(None, None, Message("[1, 2]", "crane/lamps"))
    (note,) = of_messages(mqtt)
    assert "without the key 'value'" in note and "Its keys: Value, Time" in note
    assert (mqtt.refused, mqtt.left_out) == (1, 2)


def test_a_topic_of_all_columns_may_come_beside_one_of_a_column_in_either_order(mqtt):
    for topic, payload in (("crane/a", "1"), ("crane/row", '{"time": 1, "a": 2}'), ("crane/a", "3")):
        mqtt._take(None, None, Message(payload, topic))
    assert [mqtt.poll(0.1).values["a"] for _ in range(3)] == [1.0, 2.0, 3.0]
    assert not [note for note in mqtt.notes if "two topics" in note]


def test_a_number_that_the_broker_has_kept_is_left_out_and_one_with_a_stamp_is_not(mqtt):
    mqtt._take(None, None, Message("5", "site/one/a", retain=True))
    assert mqtt.poll(0.0) is None and "Its age is not known" in mqtt.notes[-1]
    mqtt._take(None, None, Message('{"time": 1, "value": 6}', "site/one/a", retain=True))
    mqtt._take(None, None, Message("7", "site/one/a"))
    assert [mqtt.poll(0.1).values["a"] for _ in range(2)] == [6.0, 7.0]


@pytest.mark.parametrize("payload", ['{"a": 5}', '{"value": 5}'])
def test_an_object_without_a_stamp_that_the_broker_has_kept_is_left_out_and_a_new_one_is_not(mqtt, payload):
    mqtt._take(None, None, Message(payload, "crane/a", retain=True))
    assert mqtt.poll(0.0) is None and "a message without a stamp, which the broker has kept" in mqtt.notes[-1]
    mqtt._take(None, None, Message(payload, "crane/a"))
    assert mqtt.poll(0.1).values["a"] == 5.0


def failing(*_):
    raise RuntimeError("boom")


def test_a_fault_while_a_line_is_read_ends_the_source_with_a_sentence(monkeypatch):
    monkeypatch.setattr("tautline.twin.sources.stream.read_object", failing)
    source = Stream(io.StringIO('{"time": 0, "a": 1}\n'), ["a"])
    with pytest.raises(SourceFault, match="reading has stopped by a fault of the program"):
        all_of(source)
    assert source.ended


def test_a_fault_while_a_message_is_read_ends_the_source_with_a_sentence(mqtt, monkeypatch):
    monkeypatch.setattr(mqtt, "_read", failing)
    mqtt._take(None, None, Message("{}"))
    with pytest.raises(SourceFault, match="RuntimeError: boom"):
        mqtt.poll(0.1)
    assert mqtt.ended


def test_a_fault_of_the_thread_of_opc_ua_ends_the_source_with_a_sentence(monkeypatch):
    pytest.importorskip("asyncua")
    monkeypatch.setattr("tautline.twin.sources.opc_ua.client.OpcUa._connect_again_and_again", failing)
    source = open_source(f"opc.tcp://127.0.0.1:{free_port()}/x", ["a"])
    clock.sleep(0.2)
    with pytest.raises(SourceFault):
        source.poll(0.1)
    source.close()


MS = [1_700_000_000_000, 1_700_000_000_050]


@pytest.mark.parametrize("asked", ["", "time"])
def test_stamps_in_milliseconds_are_no_seconds_and_the_cure_is_told_once(asked):
    source = Stream(io.StringIO("".join(json.dumps({"time": t, "a": 1}) + "\n" for t in MS)), ["a"], asked)
    assert all(row.time != row.time for row in all_of(source))
    assert len(source.notes) == 1 and 'write `time: "time [ms]"` in the map' in source.notes[0]


def test_the_cure_of_stamps_in_milliseconds_reads_them(tmp_path, mqtt):
    wanted = [1.7e9, 1.7e9 + 0.05]
    lines = "".join(json.dumps({"time": t, "a": 1}) + "\n" for t in MS)
    table = "time,a\n" + "".join(f"{t},1\n" for t in MS)
    for made in (
        Stream(io.StringIO(lines), ["a"], "time [ms]"), Stream(io.StringIO(table), ["a"], "time [ms]"),
        CsvFile(written(tmp_path / "r.csv", table), ["a"], "time [ms]"),
        CsvFile(written(tmp_path / "s.csv", table.replace("time", "time [ms]")), ["a"], ""),
    ):  # fmt: skip
        assert [row.time for row in all_of(made)] == pytest.approx(wanted, abs=1e-6)
        assert made.notes == []


@pytest.mark.parametrize("of", ["file", "stream"])
def test_a_table_with_stamps_in_milliseconds_tells_the_cure(tmp_path, of):
    table = "time,a\n" + "".join(f"{t},1\n" for t in MS)
    made = CsvFile(written(tmp_path / "r.csv", table), ["a"]) if of == "file" else Stream(io.StringIO(table), ["a"])
    assert all(row.time != row.time for row in all_of(made))
    assert len(made.notes) == 1 and "milliseconds" in made.notes[0]
