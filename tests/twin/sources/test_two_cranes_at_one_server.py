"""OPC UA: names that two machines have, or that one has in two folders, are not taken for those of one machine."""

import time as clock
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cache

import pytest
from twin.sources.test_sources_of_data import Running, all_of, free_port

from tautline.twin.sources.opc_ua.nodes import Variable, chosen
from tautline.twin.sources.opening import open_source

COLUMNS = ["winch", "heave", "tension"]
pytestmark = pytest.mark.usefixtures("hurried")


@cache
def server():
    """A server without variables and its port, for all tests here: it takes most of a second to start."""
    asyncua = pytest.importorskip("asyncua")
    port = free_port()

    async def start():
        made = asyncua.Server()
        await made.init()
        made.set_endpoint(f"opc.tcp://127.0.0.1:{port}/crane")
        await made.start()
        return made

    return Running(start, lambda made: made.stop()), port


@pytest.fixture(scope="module", autouse=True)
def _server_stops():
    yield
    if server.cache_info().currsize:
        server()[0].stop()
        server.cache_clear()


@contextmanager
def variables_at(running, *places):
    """A server with variables at places such as ``A/winch``, with ids such as ``ns=2;s=A.winch``; for a ``with``."""
    asyncua = pytest.importorskip("asyncua")
    added = []

    async def add():
        made = running.thing
        space = await made.register_namespace("urn:crane")
        folders = {"": made.nodes.objects}
        for place in places:
            *above, name = place.split("/")
            for k in range(len(above)):
                where = "/".join(above[: k + 1])
                if where not in folders:
                    folders[where] = await folders["/".join(above[:k])].add_object(space, above[k])
                    added.append(folders[where])
            node = asyncua.ua.NodeId(place.replace("/", "."), space)
            one = await folders["/".join(above)].add_variable(node, name, 0.0)
            added.append(one)
            now = datetime.now(UTC)
            value = asyncua.ua.Variant(float(places.index(place)), asyncua.ua.VariantType.Double)
            await one.write_value(asyncua.ua.DataValue(value, SourceTimestamp=now, ServerTimestamp=now))

    running.do(add())
    try:
        yield
    finally:
        running.do(running.thing.delete_nodes(added))


def heard(columns, *places):
    """The first reading of each column, NaN where none comes, and the notes but that of the connection."""
    running, port = server()
    with variables_at(running, *places):
        source = open_source(f"opc.tcp://127.0.0.1:{port}/crane", columns)
        first, end = dict.fromkeys(columns, float("nan")), clock.monotonic() + 10.0
        try:
            while not source.notes and clock.monotonic() < end:
                source.poll(0.05)
            # What has come by then has come at once: first readings are waited with for a quarter of a second.
            for record in all_of(source, patience=1.0):
                first |= {name: one for name, one in record.values.items() if one == one}
            return first, source.notes[1:]
        finally:
            source.close()


def test_a_name_that_two_cranes_have_is_no_reading_and_is_told_with_both_node_ids():
    first, notes = heard(COLUMNS, *(f"{crane}/{name}" for crane in "AB" for name in COLUMNS))
    assert all(one != one for one in first.values())
    assert len(notes) == 3
    for name, note in zip(COLUMNS, notes, strict=True):
        assert f"2 variables {name}: ns=2;s=A.{name} (A), ns=2;s=B.{name} (B)" in note
        assert "write the right node id as `column` in the map" in note


@pytest.mark.study
def test_a_name_that_only_the_other_crane_has_is_not_mixed_with_the_ids_of_the_first():
    columns = ["ns=2;s=A.winch", "heave", "ns=2;s=A.tension"]
    first, notes = heard(columns, "A/winch", "A/motion", "A/tension", "B/winch", "B/heave", "B/tension")
    assert [first[name] for name in columns[::2]] == [0.0, 2.0] and first["heave"] != first["heave"]
    (note,) = notes
    assert "heave is ns=2;s=B.heave (B)" in note and "winch ns=2;s=B.winch (B)" in note


def test_a_crane_with_its_variables_in_several_folders_needs_no_ids_and_this_is_told():
    first, notes = heard(COLUMNS, "sensors/winch/winch", "sensors/heave", "sensors/hook/tension")
    assert list(first.values()) == [0.0, 1.0, 2.0]
    (note,) = notes
    assert "winch is ns=2;s=sensors.winch.winch (sensors/winch)" in note and "several folders" in note


@pytest.mark.study
def test_two_cranes_by_the_node_ids_of_one_are_read_without_a_word():
    columns = [f"ns=2;s=B.{name}" for name in COLUMNS]
    first, notes = heard(columns, *(f"{crane}/{name}" for crane in "AB" for name in COLUMNS))
    assert list(first.values()) == [3.0, 4.0, 5.0] and not notes


def test_a_name_that_was_not_searched_for_everywhere_is_not_said_to_be_missing_at_the_server(monkeypatch):
    monkeypatch.setattr("tautline.twin.sources.opc_ua.nodes.LARGEST", 1)
    first, notes = heard(["winch", "heave", "ns=2;s=nowhere"], "crane/winch", "heave")
    assert first["winch"] != first["winch"] and first["heave"] == 1.0
    none, unseen, _ = notes
    assert "the server has no variable ns=2;s=nowhere: " in none
    assert "variable winch: not found among the nodes that were searched, and others were not searched" in unseen
    assert "write its node id as `column`" in unseen


def test_columns_in_many_folders_are_told_in_a_remark_that_names_a_few():
    places = [f"folder{k}/y{k}" for k in range(60)]
    (remark,) = chosen([f"y{k}" for k in range(60)], variables(*places)).remarks
    assert "y3 is ns=2;s=folder3/y3 (folder3) and 56 more. " in remark and "y4" not in remark


def variables(*places):
    found = []
    for place in places:
        *above, name = place.split("/")
        path = tuple("/".join(above[: k + 1]) for k in range(len(above)))
        found.append(Variable(f"ns=2;s={place}", name, path, "/".join(above)))
    return found


@pytest.mark.parametrize(
    ("columns", "places", "taken"),
    [
        (["winch", "heave"], ["A/winch", "B/winch", "B/heave"], []),
        (["winch", "heave"], ["A/rope/winch", "B/rope/winch", "B/mru/heave"], []),
        (["winch", "heave"], ["A/winch", "B/winch", "ship/heave"], ["heave"]),
        (["ns=2;s=A/winch", "heave"], ["A/winch", "B/winch", "ship/heave"], ["ns=2;s=A/winch", "heave"]),
        (["ns=2;s=A/winch", "heave"], ["A/winch", "A/heave", "B/winch"], ["ns=2;s=A/winch", "heave"]),
        (["ns=2;s=A/winch", "ns=2;s=B/winch", "heave"], ["A/winch", "B/winch", "B/heave"], "all"),
    ],
)
def test_a_single_name_is_taken_unless_it_stands_with_what_may_be_another_machine(columns, places, taken):
    choice = chosen(columns, variables(*places))
    assert list(choice.ids) == (columns if taken == "all" else taken)
    assert choice.ids.keys().isdisjoint(choice.doubted) and choice.ids.keys() | choice.doubted.keys() == {*columns}
