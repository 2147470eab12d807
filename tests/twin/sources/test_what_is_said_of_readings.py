"""What a message or a server says of its readings: their time, unit, quality and kind; nothing of it is passed over."""

import io
import json
import math

import pytest
from twin.sources.messages import Message, without_broker
from twin.sources.test_sources_of_data import all_of, free_port

from tautline.twin.sources.connection import Connection
from tautline.twin.sources.objects import is_good
from tautline.twin.sources.opc_ua.client import Lost, OpcUa
from tautline.twin.sources.opc_ua.holding import Change
from tautline.twin.sources.opc_ua.nodes import unit_nodes, units_of
from tautline.twin.sources.reading_units import unit_of_code
from tautline.twin.sources.stated_units import Remarks, factor_told
from tautline.twin.sources.stream import Stream

UNITS = {"a": "kN", "b": "m"}


def mqtt_of(time=""):
    return without_broker(list(UNITS), time=time, units=UNITS)


def take(source, found, topic="crane/row"):
    source._take(None, None, Message(json.dumps(found), topic))
    return source.poll(0.0)


def told(source, words):
    return [note for note in source.notes if words in note]


@pytest.fixture
def mqtt():
    source = mqtt_of()
    yield source
    source.close()


@pytest.mark.parametrize("key", ["time", "t", "timestamp", "ts", "datetime"])
def test_a_stamp_is_found_under_its_usual_names(mqtt, key):
    assert take(mqtt, {key: 1.7e9, "a": 1}).time == 1.7e9 and not told(mqtt, "time of arrival")


@pytest.mark.parametrize("key", ["ts", "t", "time"])
def test_a_column_of_the_map_is_no_stamp_unless_the_map_says_so(key):
    text = json.dumps({key: 5.0, "timestamp": 1.0, "a": 2}) + "\n"
    (row,) = all_of(Stream(io.StringIO(text), [key, "a"]))
    assert row.time == 1.0 and row.values == {key: 5.0, "a": 2.0}
    (row,) = all_of(Stream(io.StringIO(text), [key, "a"], key))
    assert row.time == 5.0
    (row,) = all_of(Stream(io.StringIO(f"{key},timestamp,a\n5,1,2\n"), [key, "a"]))
    assert row.time == 1.0 and row.values == {key: 5.0, "a": 2.0}


def test_a_key_that_may_be_something_else_is_told_once_when_it_is_taken_as_the_time(mqtt):
    for k in range(3):
        assert take(mqtt, {"ts": 1.7e9 + k, "a": 1}).time == 1.7e9 + k
    assert len(told(mqtt, "`ts` is taken as the time")) == 1


def test_milliseconds_since_1970_in_a_key_of_the_usual_names_are_told_with_a_cure(mqtt):
    take(mqtt, {"ts": 1.7e12, "a": 1})
    (note,) = told(mqtt, "are no seconds")
    assert 'time: "ts [ms]"' in note


def test_a_message_without_a_time_says_once_which_keys_are_no_columns_and_what_to_write(mqtt):
    for _ in range(3):
        assert take(mqtt, {"zeit": 5.0, "n": 1, "a": 1, "quality": "good"}) is not None
    (note,) = told(mqtt, "the time of arrival counts")
    assert note.startswith("topic crane/row: messages have no time") and "Keys that are no columns: zeit, n." in note
    assert "`time: zeit`" in note


def test_a_message_without_the_time_of_the_map_is_left_out_counted_and_told_once():
    source = mqtt_of("zeit")
    try:
        assert take(source, {"ts": 5.0, "a": 1}) is None and take(source, {"ts": 6.0, "a": 1}) is None
        assert (source.refused, source.left_out) == (0, 2)
        assert len(told(source, "messages without 'zeit' are left out")) == 1
        assert take(source, {"zeit": 7.0, "a": 1}).time == 7.0
    finally:
        source.close()


def test_the_unit_of_a_message_is_converted_and_told(mqtt):
    assert take(mqtt, {"time": 1, "value": 49000, "unit": "N"}, "crane/a").values["a"] == pytest.approx(49.0)
    assert mqtt.factors["a"] == pytest.approx(1e-3) and len(told(mqtt, "converted to kN")) == 1


def test_a_message_in_a_unit_of_another_quantity_is_no_reading_and_this_is_told_once(mqtt):
    for k in range(2):
        assert take(mqtt, {"time": k, "value": 5.0, "unit": "m"}, "crane/a") is None
    assert len(told(mqtt, "'m' is a unit of another quantity")) == 1


@pytest.mark.parametrize(
    "quality", ["Bad", "BadNoCommunication", "uncertain", 0, False, "0x80000000", "OPC_QUALITY_BAD"]
)
def test_a_reading_whose_quality_is_not_good_is_missing_and_this_is_told(mqtt, quality):
    assert take(mqtt, {"time": 1, "value": 0, "quality": quality}, "crane/a") is None
    assert len(told(mqtt, "is not good. Readings with it count as missing")) == 1
    assert take(mqtt, {"time": 2, "value": 3, "quality": "GOOD"}, "crane/a").values["a"] == 3.0


def test_a_message_whose_quality_is_not_good_is_left_out_and_is_none_that_could_not_be_read(mqtt):
    assert take(mqtt, {"time": 1, "a": 1, "quality": "Bad"}) is None and (mqtt.refused, mqtt.left_out) == (0, 1)


def test_qualities_of_opc_and_a_status_of_the_machine_are_told_from_each_other():
    good = [("quality", 192), ("quality", "Good (192)"), ("quality", True), ("status", 0), ("status", "ok")]
    assert all(is_good(*one) is True for one in good)
    assert [is_good("status", one) for one in (0x80000000, "Bad", "BadTimeout")] == [False, False, False]
    assert [is_good("status", one) for one in ("running", 7, None)] == [None, None, None]


@pytest.mark.parametrize(
    "quality", [2, 3, 24, 99, 0.98, "OPC_QUALITY_GOOD", "Q_GOOD", "0xC0", "high", "A", "G", "badge", "", {"code": 1}]
)
def test_a_reading_whose_quality_is_not_known_to_be_bad_is_used(mqtt, quality):
    for k in range(2):
        assert take(mqtt, {"time": k, "value": 3, "quality": quality}, "crane/a").values["a"] == 3.0
    assert len(told(mqtt, "is not known. Readings with it are used")) == (is_good("quality", quality) is None)


def test_small_qualities_are_bad_where_others_of_the_key_are_numbers_of_opc(mqtt):
    assert take(mqtt, {"time": 1, "value": 3, "quality": 24}, "crane/a") is not None
    assert take(mqtt, {"time": 2, "value": 3, "quality": 192}, "crane/a") is not None
    assert take(mqtt, {"time": 3, "value": 3, "quality": 24}, "crane/a") is None
    assert take(mqtt, {"time": 4, "value": 3, "quality": 64}, "crane/b") is None


@pytest.mark.parametrize("status", ["fault", "error 5", "error-free", "failover", "Offline", "invalid", False, 5])
def test_no_status_of_the_machine_drops_its_readings(mqtt, status):
    assert take(mqtt, {"time": 1, "a": 4, "status": status}).values["a"] == 4.0


def test_a_status_of_the_machine_leaves_its_readings_in_and_this_is_told(mqtt):
    assert take(mqtt, {"time": 1, "a": 4, "status": "running"}).values["a"] == 4.0
    assert len(told(mqtt, "the status running is not known. Readings with it are used")) == 1


def test_a_quality_in_a_line_of_a_stream_counts_as_in_a_message():
    text = '{"time": 0, "a": 1, "quality": "Bad"}\n{"time": 1, "a": 2, "quality": "Good"}\n'
    rows = all_of(Stream(io.StringIO(text), ["a"]))
    assert math.isnan(rows[0].values["a"]) and rows[1].values["a"] == 2.0


@pytest.mark.parametrize("text", ["1,234", "1,234,567", "49,5"])
def test_a_text_with_a_comma_in_an_object_is_left_out_and_told_as_in_a_table(mqtt, text):
    assert take(mqtt, {"time": 1, "a": text}) is None and take(mqtt, {"time": 2, "a": text, "b": 1}).values["b"] == 1.0
    assert len(told(mqtt, f"column 'a' has texts such as \"{text}\"")) == 1
    (row,) = all_of(Stream(io.StringIO(json.dumps({"time": 1, "a": text}) + "\n"), ["a"]))
    assert math.isnan(row.values["a"])


def test_a_stamp_with_a_comma_in_an_object_is_none_and_a_date_with_one_is(mqtt):
    assert math.isnan(take(mqtt, {"time": "1,234", "a": 1}).time)
    assert take(mqtt, {"time": "2026-01-01T00:00:00,5Z", "a": 1}).time == 1767225600.5


# -- OPC UA ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def opcua(monkeypatch):
    """A source that listens to nobody: its queue is filled by hand."""
    pytest.importorskip("asyncua")
    monkeypatch.setattr(OpcUa, "_listen", lambda self: None)
    source = OpcUa("opc.tcp://localhost:4840/x", list(UNITS), UNITS)
    monkeypatch.setattr(Connection, "watch", lambda self: None)
    yield source
    source.close()


def test_units_of_a_server_are_converted_by_name_or_common_code_and_told_once(opcua):
    for _ in range(2):  # a connection, and another one
        opcua._scale({"a": ["N"], "b": ["Millimeter", "mm"]})
    assert opcua.read("a", 49000) == pytest.approx(49.0) and opcua.read("b", 1500.0) == pytest.approx(1.5)
    assert opcua.factors == pytest.approx({"a": 1e-3, "b": 1e-3})
    assert len(told(opcua, "the server says that the unit of a is N: its readings are converted to kN")) == 1


def test_a_server_with_another_quantity_gives_no_reading_and_an_unknown_unit_is_told(opcua):
    opcua._scale({"a": ["m"], "b": ["quux"]})
    assert math.isnan(opcua.read("a", 5.0)) and opcua.read("b", 5.0) == 5.0
    assert len(told(opcua, "the map says kN")) == 1 and len(told(opcua, "quux, which is no known unit")) == 1


@pytest.mark.parametrize(
    ("stated", "asked", "factor"),
    [
        # Standard gravity 9.80665 m/s^2 and the pound of 0.45359237 kg are exact by definition.
        ("t", "tf", 1.0), ("t", "kN", 9.80665), ("kg", "kgf", 1.0), ("lb", "lbf", 1.0), ("lbs", "lbf", 1.0),
        ("klb", "klbf", 1.0), ("klb", "kN", 4.4482216152605), ("Nm", "N m", 1.0), ("Nm", "kN m", 1e-3), ("M", "m", 1.0),
        ("M", "mm", 1000.0), ("1/min", "rpm", 1.0), ("min-1", "rpm", 1.0), ("U/min", "rpm", 1.0),
        ("rev/min", "rpm", 1.0), ("Hz", "rpm", 60.0), ("1/min", "rad/s", 0.10471975511965977), ("°C", "degC", 1.0),
        ("KN", "kN", 1.0), ("kn", "kN", 1.0),
    ],
)  # fmt: skip
def test_units_in_free_text_are_understood_or_no_known_unit_and_never_make_right_readings_missing(
    stated, asked, factor
):
    notes = []
    assert factor_told("a", [stated], asked, "the server says that", Remarks(notes)) == pytest.approx(factor, rel=1e-12)
    assert "leave it out" not in "".join(notes)


def test_a_mass_beside_a_force_is_told_as_its_weight_once(mqtt):
    for k in range(2):
        assert take(mqtt, {"time": k, "value": 2.0, "unit": "t"}, "crane/a").values["a"] == pytest.approx(19.6133)
    assert len(told(mqtt, "converted to kN, as the weight of that mass")) == 1


def test_the_common_code_counts_where_the_text_is_of_another_quantity(opcua):
    opcua._scale({"a": ["m", "N"]})
    assert opcua.read("a", 49000) == pytest.approx(49.0)


@pytest.mark.parametrize("stated", ["m", "bar", "mA", "tons"])
def test_a_unit_that_is_surely_another_or_may_be_two_gives_no_reading_and_a_cure_that_holds(opcua, stated):
    opcua._scale({"a": [stated]})
    assert math.isnan(opcua.read("a", 5.0)) and "leave it out" not in opcua.notes[0]


def test_common_codes_are_read_by_their_letters():
    # UNECE recommendation 20: MTR is the metre; OPC UA part 8 gives 5067858 as its UnitId.
    assert unit_of_code(5067858) == "m" and unit_of_code(0x4E4557) == "N" and unit_of_code(0x423437) == "kN"
    assert unit_of_code(0) == unit_of_code(-1) == unit_of_code(1) == ""


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (True, "as true or false"),
        ([1.0, 2.0], "as a list of 2 values"),
        ("open", 'as the text "open"'),
        (None, "value"),
    ],
)
def test_a_value_that_is_no_number_is_told_once_for_each_column(opcua, value, words):
    assert math.isnan(opcua.read("a", value)) and math.isnan(opcua.read("a", value))
    (note,) = opcua.notes
    assert "the server gives a" in note and words in note and "count as missing" in note


def test_a_loss_behind_a_change_in_the_queue_lets_nothing_hold_any_more(opcua):
    at = 1000.0
    for k in range(3):
        opcua._put(Change(50.0 + 0.05 * k, "a", 1.0, at + 0.05 * k, k == 0))
    opcua._put(Lost())
    opcua._put(at + 60.0)
    while opcua.poll(0.0) is not None or not opcua._queue.empty():
        pass
    opcua._put(at + 120.0)
    assert opcua.poll(0.0) is None and opcua.poll(0.0) is None


def test_units_are_read_of_the_variables_of_a_server():
    asyncua = pytest.importorskip("asyncua")
    import asyncio

    async def work():
        server = asyncua.Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{free_port()}/x")
        index = await server.register_namespace("tautline")
        made = {name: await server.nodes.objects.add_variable(index, name, 1.0) for name in "abc"}
        for name, text, code in (("a", "N", 0), ("b", "Millimetre", 0x4D4D54)):
            unit = asyncua.ua.EUInformation(UnitId=code, DisplayName=asyncua.ua.LocalizedText(text))
            await made[name].add_property(0, "EngineeringUnits", unit)
        async with server, asyncua.Client(server.endpoint.geturl()) as client:
            nodes = {name: client.get_node(node.nodeid) for name, node in made.items()}
            return await units_of(await unit_nodes(nodes))

    assert asyncio.run(work()) == {"a": ["N"], "b": ["Millimetre", "mm"]}
