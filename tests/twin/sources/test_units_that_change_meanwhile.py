"""A unit that is stated with the readings may change or be left out later: readings stay right, and it is told."""

import asyncio
import io
import json
import math
import time as clock
from datetime import UTC, datetime

import pytest
from twin.sources.messages import Message, without_broker
from twin.sources.test_sources_of_data import Running, all_of, free_port

from tautline.twin.sources.opening import open_source
from tautline.twin.sources.stream import Stream

UNITS = {"a": "kN", "b": "m"}
KIP = 4.4482216152605
"""A kip in kN, exact by the definitions of pound and standard gravity."""


@pytest.fixture
def mqtt():
    source = without_broker(list(UNITS), time="", units=UNITS)
    yield source
    source.close()


def readings(source, messages, topic="crane/a"):
    found = []
    for k, one in enumerate(messages):
        source._take(None, None, Message(json.dumps({"time": k, **one}), topic))
        found.append(source.poll(0.0).values["a"])
    return found


def told(source, words):
    return [note for note in source.notes if words in note]


def test_a_unit_that_is_missing_is_the_one_that_was_stated_last_and_this_is_told_once(mqtt):
    sent = [{"value": 49000, "unit": "N"}, {"value": 49000}, {"value": 49000, "unit": ""}, {"value": 49000}]
    assert readings(mqtt, sent) == pytest.approx([49.0] * 4)
    assert len(told(mqtt, "no unit of a is given any more: its readings are taken in N, the last one")) == 1


def test_behind_a_unit_that_nobody_knows_readings_are_taken_in_the_maps_and_this_is_said(mqtt):
    sent = [{"value": 49, "unit": "kN"}, {"value": 49, "unit": "nope"}, {"value": 49}]
    assert readings(mqtt, sent) == pytest.approx([49.0] * 3)
    (note,) = told(mqtt, "no unit of a is given any more")
    assert note.endswith("its readings are taken in kN, as nope, the last one, is no known unit")


def test_each_change_of_a_unit_is_told_also_back_to_the_one_before(mqtt):
    sent = [
        {"value": 49, "unit": "kN"},
        {"value": 49e3, "unit": "N"},
        {"value": 49, "unit": "kN"},
        {"value": 1, "unit": "N"},
    ]
    assert readings(mqtt, sent) == pytest.approx([49.0, 49.0, 49.0, 1e-3])
    assert len(told(mqtt, "has changed from kN to N")) == 2 and len(told(mqtt, "has changed from N to kN")) == 1


def test_a_unit_that_changes_with_every_message_is_not_told_for_ever(mqtt):
    readings(mqtt, [{"value": 1, "unit": ("kN", "N")[k % 2]} for k in range(200)])
    assert len(mqtt.notes) < 30 and len(told(mqtt, "this is told no more")) == 1


def test_the_unit_of_another_machine_is_none_of_this_one(mqtt):
    mqtt._take(None, None, Message(json.dumps({"time": 0, "value": 49, "unit": "kN"}), "one/a"))
    mqtt._take(None, None, Message(json.dumps({"time": 1, "value": 49e3, "unit": "N"}), "two/a"))
    mqtt._take(None, None, Message(json.dumps({"time": 2, "value": 49}), "one/a"))
    assert [one.values["a"] for one in all_of(mqtt, patience=0.2)] == [49.0, 49.0]


@pytest.mark.parametrize("form", [lambda unit: unit, lambda unit: {"a": unit}])
def test_the_unit_in_lines_of_json_is_converted_and_its_change_is_told(form):
    lines = [{"time": k, "a": 10.0, "unit": form("kN" if k < 3 else "kip")} for k in range(6)]
    source = Stream(io.StringIO("".join(json.dumps(one) + "\n" for one in lines)), list(UNITS), units=UNITS)
    assert [one.values["a"] for one in all_of(source)] == pytest.approx([10.0] * 3 + [10.0 * KIP] * 3)
    assert len(told(source, "in the data the unit of a has changed from kN to kip")) == 1


@pytest.mark.parametrize("more", [{}, {"a": 0, "quality": "bad"}])
def test_a_unit_that_is_stated_without_a_good_reading_holds_for_those_to_come(more):
    lines = [{"time": 0, "units": {"a": "N"}, **more}, {"time": 1, "a": 49e3}]
    source = Stream(io.StringIO("".join(json.dumps(one) + "\n" for one in lines)), list(UNITS), units=UNITS)
    assert [one.values["a"] for one in all_of(source)][-1] == 49.0


def test_a_unit_beside_a_bad_reading_of_its_topic_holds_for_those_to_come(mqtt):
    mqtt._take(None, None, Message(json.dumps({"time": 0, "value": 0, "unit": "N", "quality": "bad"}), "crane/a"))
    assert readings(mqtt, [{"value": 49000}]) == [49.0]


def test_an_object_of_units_is_no_reading_that_is_left_out(mqtt):
    assert readings(mqtt, [{"a": 49000, "units": {"a": "N"}}], "crane/x") == [49.0]
    assert not told(mqtt, "holds an object")


def test_one_unit_beside_several_columns_does_not_count_and_this_is_told_with_a_cure():
    lines = [{"time": k, "a": 10.0, "b": 2.0, "unit": "kip"} for k in range(3)]
    source = Stream(io.StringIO("".join(json.dumps(one) + "\n" for one in lines)), list(UNITS), units=UNITS)
    assert [one.values["a"] for one in all_of(source)] == [10.0] * 3
    (note,) = told(source, "stands beside several columns")
    assert '{"unit": {"a": "..."}}' in note


def in_lines(found, **more):
    """Readings of `a` in lines of JSON, and their source."""
    text = "".join(json.dumps({"time": k, **one}) + "\n" for k, one in enumerate(found))
    source = Stream(io.StringIO(text), ["a"], units=UNITS, **more)
    return [one.values["a"] for one in all_of(source)], source


@pytest.mark.parametrize("beside", [{"depth": 2}, {"depth": "2.5"}, {"depth": 2, "seq": 7}])
def test_one_unit_beside_numbers_that_are_no_columns_does_not_count_and_this_is_told(beside):
    found, source = in_lines([{"a": 5, **beside, "unit": "m"}, {"a": 5}])
    assert found == [5.0, 5.0] and len(source.notes) == 1
    (note,) = told(source, "stands beside several columns")
    assert '{"unit": {"a": "..."}}' in note


def test_quality_status_and_stamp_are_no_numbers_that_a_unit_may_be_of():
    found, _ = in_lines([{"a": 49e3, "quality": 192, "status": 0, "unit": "N"}])
    assert found == pytest.approx([49.0])


def test_one_unit_in_rows_without_a_column_is_not_told_of():
    _, source = in_lines([{"depth": 5, "speed": 2, "unit": "m"}])
    assert source.notes == []


def test_a_unit_of_another_quantity_that_nothing_ties_to_a_column_holds_for_its_row_alone():
    rows = [{"a": 49e3, "unit": "N"}, {"a": 5, "unit": "A"}, {"a": 49e3}, {"a": 5, "unit": "A"}]
    found, source = in_lines(rows)
    assert found == pytest.approx([49.0, math.nan, 49.0, math.nan], nan_ok=True)
    (note,) = told(source, "'A' is a unit of another quantity")
    assert "holds for readings beside it alone" in note and "give that key another name" in note


def test_a_unit_of_another_quantity_that_is_of_a_reading_for_sure_holds_on_and_the_last_is_not_said_to_be_taken(mqtt):
    sent = [{"value": 5, "unit": "m", "b": 1}, {"value": 5, "b": 1}]
    assert all(math.isnan(one) for one in readings(mqtt, sent))
    (note,) = told(mqtt, "given any more")
    assert note.endswith("its readings count as missing, as m, the last one, is of another quantity")


@pytest.mark.parametrize("keys", [("unit", "units"), ("units", "unit")])
@pytest.mark.parametrize("first", [True, False])
def test_an_object_of_units_goes_before_one_unit_whatever_their_order(keys, first):
    one, other = {keys[0]: {"a": "N"}}, {keys[1]: "kip"}
    found, _ = in_lines([{"a": 49e3} | (one | other if first else other | one)])
    assert found == pytest.approx([49.0])


def test_a_change_is_told_in_one_sentence_that_names_the_column_once():
    _, source = in_lines([{"a": 1, "unit": one} for one in ("kN", "N", "kN", "quux", "kN")])
    head = "in the data the unit of a has changed from"
    assert source.notes == [
        f"{head} kN to N: its readings are converted to kN",
        f"{head} N to kN: its readings are in kN, as the map says",
        f"{head} kN to quux, which is no known unit: its readings are taken in kN",
    ]


def test_blanks_around_a_unit_are_no_change():
    found, source = in_lines([{"a": 49, "unit": one} for one in ("kN", " kN ", "kN")])
    assert found == [49.0] * 3 and source.notes == []


def test_units_that_change_nothing_are_told_once():
    found, source = in_lines([{"a": 49, "unit": ("kN", "KN")[k % 2]} for k in range(50)])
    assert found == [49.0] * 50 and len(source.notes) == 1


def test_the_unit_of_the_map_that_is_stated_in_the_first_row_alone_is_not_told_as_missing():
    found, source = in_lines([{"a": 49, "unit": "kN"}, {"a": 49}, {"a": 49}])
    assert found == [49.0] * 3 and source.notes == []
    # Where units have changed, nothing shows that this one was meant.
    _, source = in_lines([{"a": 49e3, "unit": "N"}, {"a": 49, "unit": "kN"}, {"a": 49}])
    assert len(told(source, "given any more")) == 1


def test_a_stream_that_is_gone_on_with_knows_the_unit_that_was_stated_before_and_tells_it_once():
    _, first = in_lines([{"a": 49e3, "unit": "N"}, {"a": 49e3}])
    found, source = in_lines([{"a": 49e3}, {"a": 49e3}, {"a": 49, "unit": "kN"}], stated=first.stated)
    assert found == pytest.approx([49.0] * 3)
    before, change = source.notes
    assert "was N when the state was saved: its readings are converted to kN. This holds until" in before
    assert "has changed from N to kN" in change


def test_units_that_are_kept_are_those_of_the_record_that_was_taken_and_not_of_one_that_waits():
    rows = [{"time": 0, "a": 1, "unit": "kN"}, {"time": 1, "a": 1}, {"time": 2, "a": 1, "unit": "N"}]
    source = Stream(io.StringIO("".join(json.dumps(one) + "\n" for one in rows)), ["a"], units=UNITS)
    found = [(record.time, list(source.stated.values())) for record in iter(lambda: source.poll(5.0), None)]
    assert found == [(0.0, [("kN",)]), (1.0, [("kN",)]), (2.0, [("N",)])]


def test_a_message_knows_the_unit_of_its_topic_from_before(mqtt):
    readings(mqtt, [{"value": 49e3, "unit": "N"}])
    again = without_broker(list(UNITS), time="", units=UNITS, stated=mqtt.stated)
    try:
        assert readings(again, [{"value": 49e3}]) == pytest.approx([49.0])
    finally:
        again.close()


# -- OPC UA ------------------------------------------------------------------------------------------------------------


def info(text):
    from asyncua import ua

    return ua.EUInformation(DisplayName=ua.LocalizedText(text))


@pytest.fixture(scope="module")
def serving():
    """A server and its port. It takes more than a second of the processor to lay out the nodes of the standard."""
    port = free_port()
    running = server(port)
    yield running, port
    running.stop()


def server(port):
    asyncua = pytest.importorskip("asyncua")

    async def start():
        made = asyncua.Server()
        await made.init()
        made.set_endpoint(f"opc.tcp://127.0.0.1:{port}/tautline/")
        space = await made.register_namespace("urn:crane")
        made.variable = await made.nodes.objects.add_variable(space, "a", 49.0)
        made.unit = await made.variable.add_property(0, "EngineeringUnits", info("kN"))
        await made.start()
        return made

    return Running(start, lambda made: made.stop())


def send(running, value, unit=None, status=0, apart=0.0):
    """Write a reading, and before it a unit."""
    from asyncua import ua

    async def work():
        if unit is not None:
            await running.thing.unit.write_value(info(unit))
            await asyncio.sleep(apart)
        now = datetime.now(UTC)
        variant = ua.Variant(float(value), ua.VariantType.Double)
        data = ua.DataValue(variant, ua.StatusCode(status), SourceTimestamp=now, ServerTimestamp=now)
        await running.thing.variable.write_value(data)

    running.do(work())


def hear(source, seconds):
    found, end = [], clock.monotonic() + seconds
    while clock.monotonic() < end:
        if (record := source.poll(0.02)) is not None and record.values["a"] == record.values["a"]:
            found.append(record.values["a"])
    return found


@pytest.mark.parametrize("semantics_changed", [False, True])
def test_a_unit_that_the_server_changes_while_it_is_connected_is_taken_and_told(hurried, serving, semantics_changed):
    running, port = serving
    send(running, 49.0, "kN")
    source = open_source(f"opc.tcp://127.0.0.1:{port}/tautline/", ["a"], units={"a": "kN"})
    try:
        end = clock.monotonic() + 20.0
        while clock.monotonic() < end and not hear(source, 0.1):
            send(running, 49.0)
        # A good status with the bit 0x4000, SemanticsChanged (OPC UA part 4, 7.39.1).
        send(running, 49_000.0, "N", 0x4000 if semantics_changed else 0)
        found = hear(source, 0.5)
        for _ in range(10):
            send(running, 49_000.0)
            found += hear(source, 0.06)
        assert found and found == pytest.approx([49.0] * len(found))
        assert len(told(source, "the server says that the unit of a has changed from kN to N")) == 1
    finally:
        source.close()
