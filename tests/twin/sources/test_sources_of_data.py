"""Sources of sensor data: files, standard input, a broker and a server that the test starts."""

import asyncio
import io
import json
import socket
import subprocess
import sys
import threading
import time as clock
from datetime import UTC, datetime, timedelta

import pytest
import yaml

from tautline.scene.errors import SceneError
from tautline.twin.sources.csv_file import CsvFile
from tautline.twin.sources.opening import open_source
from tautline.twin.sources.stream import Stream


def all_of(source, most=100, patience=5.0):
    found, end = [], clock.monotonic() + patience
    while not source.ended and len(found) < most and clock.monotonic() < end:
        if (record := source.poll(0.05)) is not None:
            found.append(record)
    return found


def written(path, text):
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "times"),
    [
        ("time,a,b\n0,1,2\n0.5,3,\n", [0.0, 0.5]),
        ("# by hand\nt [ms];a [m];b\n0;1,0;2\n500;3;x\n", [0.0, 0.5]),
        ("time [s];a;b\n0,000000;1,0;2\n0,500000;3,0;\n", [0.0, 0.5]),
        ("a\tstamp\tb\n1\t2026-11-23T12:00:00Z\t2\n3\t2026-11-23T12:00:00.500+00:00\t\n", [0.0, 0.5]),
    ],
)
def test_a_table_is_read_whatever_separates_its_cells_and_however_its_stamps_are_written(tmp_path, text, times):
    rows = all_of(CsvFile(written(tmp_path / "r.csv", text), ["a", "b"]))
    assert [row.time - rows[0].time for row in rows] == pytest.approx(times)
    assert [row.values["a"] for row in rows] == [1.0, 3.0]
    assert rows[0].values["b"] == 2.0 and rows[1].values["b"] != rows[1].values["b"]


def test_a_file_is_replayed_at_the_speed_that_is_asked_for(tmp_path):
    path = written(tmp_path / "r.csv", "time,a\n" + "".join(f"{0.5 * k},1\n" for k in range(5)))
    now = [100.0]

    def sleep(seconds):
        now[0] += seconds

    source = CsvFile(path, ["a"], speed=2.0, now=lambda: now[0], sleep=sleep)
    arrived = [row.arrived for row in all_of(source)]
    assert [t - 100.0 for t in arrived] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])


def test_a_replay_does_not_wait_for_a_stamp_far_ahead_that_is_wrong(tmp_path):
    path = written(tmp_path / "r.csv", "time,a\n0,1\n1,2\n99999,3\n2,4\n3,5\n")
    now = [0.0]

    def sleep(seconds):
        now[0] += seconds

    source = CsvFile(path, ["a"], speed=1.0, now=lambda: now[0], sleep=sleep)
    assert [(row.values["a"], row.arrived) for row in all_of(source)] == [(1, 0), (2, 1), (3, 2), (4, 2), (5, 3)]


def test_a_column_that_is_not_there_is_refused_with_the_nearest(tmp_path):
    path = written(tmp_path / "r.csv", "time,heave\n0,1\n")
    with pytest.raises(SceneError, match="there is no column 'heav'; did you mean 'heave'"):
        CsvFile(path, ["heav"])
    with pytest.raises(SceneError, match="there is no column of time"):
        CsvFile(written(tmp_path / "s.csv", "a,b\n0,1\n"), ["a"])
    with pytest.raises(SceneError, match="is empty"):
        CsvFile(written(tmp_path / "t.csv", ""), ["a"])


def test_lines_that_cannot_be_read_are_counted_and_the_others_are_not_lost():
    text = '{"time": 0, "a": 1}\n{broken\n[1]\n\n{"time": 1, "a": "2.5"}\n'
    source = Stream(io.StringIO(text), ["a"])
    rows = all_of(source)
    assert [(row.time, row.values["a"]) for row in rows] == [(0.0, 1.0), (1.0, 2.5)]
    assert source.refused == 2 and source.ended


def values_of(rows):
    return [[None if x != x else x for x in row.values.values()] for row in rows]


@pytest.mark.parametrize("of", ["file", "stream"])
def test_the_last_cell_of_a_line_that_was_cut_is_missing_and_the_cells_before_it_count(tmp_path, of):
    text = "time,a,b,c\n0,1,2,3\n1,1,2.5,3\n2,1,2"
    source = CsvFile(written(tmp_path / "r.csv", text), ["a", "b", "c"])
    source = Stream(io.StringIO(text), ["a", "b", "c"]) if of == "stream" else source
    assert values_of(all_of(source)) == [[1.0, 2.0, 3.0], [1.0, 2.5, 3.0], [1.0, None, None]]


def test_a_stamp_that_was_cut_is_none(tmp_path):
    source = CsvFile(written(tmp_path / "r.csv", "a,time,b\n1,1000,2\n1,1001,2\n1,10"), ["a"])
    assert [row.time for row in all_of(source)] == [1000.0, 1001.0] and source.refused == 1


def test_a_table_whose_lines_all_leave_out_their_last_cells_loses_no_column(tmp_path):
    source = CsvFile(written(tmp_path / "r.csv", "time,a,b,c\n0,1,2\n1,1,2\n2,1,2\n"), ["a", "b"])
    assert values_of(all_of(source)) == [[1.0, None], [1.0, 2.0], [1.0, 2.0]]
    source = CsvFile(written(tmp_path / "r.csv", "time,a,b,\n0,1,2\n1,1,2\n"), ["a", "b"])
    assert values_of(all_of(source)) == [[1.0, 2.0], [1.0, 2.0]]


def test_tabs_at_the_end_of_a_line_of_a_stream_are_empty_cells():
    rows = all_of(Stream(io.StringIO("time\ta\tb\n0\t1\t2\n1\t3\t\n"), ["a", "b"]))
    assert values_of(rows) == [[1.0, 2.0], [3.0, None]]


def test_addresses_without_host_or_topic_are_refused():
    with pytest.raises(SceneError, match="has no host or no topic"):
        open_source("mqtt://host", ["a"])
    with pytest.raises(SceneError, match="is of no known kind"):
        open_source("http://host", ["a"])


@pytest.mark.parametrize(
    "address",
    ["mqtt://localhost:abc/x", "mqtt://localhost:99999/x", "mqtts://localhost:0/x", "opc.tcp://localhost:x/y"],
)
def test_a_port_that_cannot_be_is_refused_with_the_ports_that_can(address):
    with pytest.raises(SceneError, match="a whole number from 1 to 65535; write it as in"):
        open_source(address, ["a"])


def test_an_opc_ua_address_without_a_host_is_refused():
    with pytest.raises(SceneError, match="has no host; write it as in"):
        open_source("opc.tcp:///crane", ["a"])


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Running:
    """Coroutines that start and stop something, on a loop of their own."""

    def __init__(self, start, stop):
        self._stop = stop
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.thing = self.do(start())

    def do(self, work):
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(timeout=20.0)

    def stop(self):
        self.do(self._stop(self.thing))
        self.loop.call_soon_threadsafe(self.loop.stop)


class Broker:
    """A broker in a process of its own, that can be lost."""

    def __init__(self, folder, port):
        settings = {
            "listeners": {"default": {"type": "tcp", "bind": f"127.0.0.1:{port}"}},
            "plugins": {"amqtt.plugins.authentication.AnonymousAuthPlugin": {"allow_anonymous": True}},
        }
        path = written(folder / "broker.yaml", yaml.safe_dump(settings))
        code = "from amqtt.scripts.broker_script import main; main()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, "-c", str(path)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        end = clock.monotonic() + 20.0
        while clock.monotonic() < end:
            with socket.socket() as one:
                if one.connect_ex(("127.0.0.1", port)) == 0:
                    return
            clock.sleep(0.05)

    def stop(self):
        self.process.kill()
        self.process.wait(10.0)


def test_mqtt_gives_what_is_published_also_after_the_broker_was_lost(tmp_path):
    paho = pytest.importorskip("paho.mqtt.client")
    pytest.importorskip("amqtt")
    port = free_port()
    running = Broker(tmp_path, port)
    source = open_source(f"mqtt://127.0.0.1:{port}/crane/#", ["heave", "rope_tension"])

    def publish(messages):
        client = paho.Client(paho.CallbackAPIVersion.VERSION2)
        client.connect("127.0.0.1", port)
        client.loop_start()
        for topic, payload in messages:
            client.publish(topic, payload, qos=1).wait_for_publish(5.0)
        client.disconnect()
        client.loop_stop()

    def until_heard(messages, count):
        """Publish until the subscription, which connects in its own time, has heard something."""
        end, found = clock.monotonic() + 20.0, []
        while len(found) < count and clock.monotonic() < end:
            publish(messages)
            found += all_of(source, most=count - len(found), patience=0.5)
        return found

    try:
        row = json.dumps({"time": 5.0, "heave": 0.25, "rope_tension": 49.0})
        first = until_heard([("crane/row", row)], 1)[0]
        assert (first.time, dict(first.values)) == (5.0, {"heave": 0.25, "rope_tension": 49.0})
        all_of(source, patience=0.3)
        publish(
            [("crane/heave", "0.5"), ("crane/rope_tension", json.dumps({"time": 6.0, "value": 48.0})), ("crane/x", "?")]
        )
        one, other = all_of(source, most=2)
        assert one.values["heave"] == 0.5 and one.values["rope_tension"] != one.values["rope_tension"]
        assert other.time == 6.0 and other.values["rope_tension"] == 48.0
        running.stop()
        running = Broker(tmp_path, port)
        again = until_heard([("crane/row", row)], 1)
        assert again and again[0].values["heave"] == 0.25
    finally:
        source.close()
        running.stop()


def server(port):
    asyncua = pytest.importorskip("asyncua")

    async def start():
        made = asyncua.Server()
        await made.init()
        made.set_endpoint(f"opc.tcp://127.0.0.1:{port}/tautline/")
        space = await made.register_namespace("urn:crane")
        thing = await made.nodes.objects.add_object(space, "Crane")
        made.variables = {name: await thing.add_variable(space, name, 0.0) for name in ("heave", "rope_tension")}
        await made.start()
        return made

    return Running(start, lambda made: made.stop())


def write(running, time, values):
    from asyncua import ua

    async def work():
        for name, value in values.items():
            data = ua.DataValue(ua.Variant(value, ua.VariantType.Double), SourceTimestamp=time, ServerTimestamp=time)
            await running.thing.variables[name].write_value(data)

    running.do(work())


def test_opc_ua_gives_the_changes_of_a_stamp_as_one_record_also_after_the_server_was_lost(hurried):
    pytest.importorskip("asyncua")
    port = free_port()
    running = server(port)
    source = open_source(f"opc.tcp://127.0.0.1:{port}/tautline/", ["heave", "rope_tension"])
    begin = datetime(2026, 11, 23, 12, tzinfo=UTC)

    def heard(running, wanted):
        end, k = clock.monotonic() + 30.0, 0
        while clock.monotonic() < end:
            k += 1
            stamp = begin + timedelta(seconds=k)
            write(running, stamp, {"heave": 0.1 * k, "rope_tension": 40.0 + k})
            for record in all_of(source, patience=0.6):
                if record.time >= begin.timestamp() and record.values["heave"] == record.values["heave"]:
                    return record
        return None

    try:
        found = heard(running, 1)
        k = round(found.time - begin.timestamp())
        assert dict(found.values) == pytest.approx({"heave": 0.1 * k, "rope_tension": 40.0 + k})
        running.stop()
        running = server(port)
        assert heard(running, 1) is not None
    finally:
        source.close()
        running.stop()


@pytest.mark.parametrize("text", ["time,a\n0,1\n", '{"time": 0, "a": 1}\n'])
def test_a_stream_that_begins_with_a_byte_order_mark_is_read(text):
    source = Stream(io.StringIO("\ufeff" + text), ["a"])
    assert [(row.time, row.values["a"]) for row in all_of(source)] == [(0.0, 1.0)] and source.refused == 0


def test_text_in_utf_16_is_refused_with_the_encoding_that_is_wanted(tmp_path):
    data = "time,a\n0,1\n".encode("utf-16")
    source = Stream(io.StringIO(data.decode(errors="replace")), ["a"])
    with pytest.raises(SceneError, match="is not UTF-8 text; save it as UTF-8"):
        all_of(source)
    (tmp_path / "r.csv").write_bytes(data)
    with pytest.raises(SceneError, match="is not UTF-8 text; save it as UTF-8"):
        CsvFile(tmp_path / "r.csv", ["a"])
