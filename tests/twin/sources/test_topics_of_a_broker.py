"""Topics that are subscribed to: which ones no broker takes, and what is told where one is refused."""

import socket
import threading

import pytest
from twin.sources.messages import without_broker
from twin.sources.test_connections_of_sources import heard

from tautline.scene.errors import SceneError
from tautline.twin.sources import mqtt
from tautline.twin.sources.opening import open_source
from tautline.twin.sources.record import SourceFault

pytest.importorskip("paho.mqtt.client", reason="MQTT needs the extra `live`")
REFUSES, GRANTS = 0x80, 0x01


def packet(one):
    """Kind and content of the next packet of MQTT; None where there is none."""
    head = one.recv(1)
    if not head:
        return None
    size, shift = 0, 0
    while True:
        (byte,) = one.recv(1)
        size, shift = size | (byte & 127) << shift, shift + 7
        if byte < 128:
            break
    content = b""
    while len(content) < size:
        content += one.recv(size - len(content))
    return head[0] >> 4, content


class Broker:
    """Takes every connection, and answers subscriptions with the codes that it was given, the last one for ever."""

    def __init__(self, *codes):
        self.codes, self.asked = list(codes), []
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                one, _ = self._listening.accept()
            except OSError:
                return
            with one:
                self._answer(one)

    def _answer(self, one):
        while (found := packet(one)) is not None:
            kind, content = found
            if kind == 1:
                one.sendall(b"\x20\x02\x00\x00")
            elif kind == 8:
                size = int.from_bytes(content[2:4], "big")
                self.asked.append(content[4 : 4 + size].decode())
                code = self.codes.pop(0) if len(self.codes) > 1 else self.codes[0]
                one.sendall(b"\x90\x03" + content[:2] + bytes([code]))

    def close(self):
        self._listening.close()


@pytest.fixture
def subscribe():
    """A function that opens a source at a broker; gives both."""
    made = []

    def one(path, *codes):
        broker = Broker(*codes)
        made.append(broker)
        source = open_source(f"mqtt://127.0.0.1:{broker.port}{path}", ["flow"])
        made.append(source)
        return broker, source

    yield one
    for thing in reversed(made):
        thing.close()


@pytest.mark.parametrize(
    ("topic", "said"),
    [
        ("hose#", "has # beside other characters, in 'hose#'"),
        ("hose/#/x", "has # before the end of the topic"),
        ("##", "has # beside other characters"),
        ("a+/b", "has + beside other characters, in 'a+'"),
        ("a%00b", "has a character NUL"),
        ("a/" + 65534 * "b", "has a topic of 65536 bytes"),
        (32768 * "ä", "has a topic of 65536 bytes"),
        ("a\udcff", "is no text in UTF-8"),
    ],
)
def test_a_topic_that_no_broker_takes_is_refused_before_the_twin_begins(topic, said):
    with pytest.raises(SceneError) as error:
        open_source(f"mqtt://127.0.0.1/{topic}", ["flow"])
    (problem,) = error.value.problems
    assert said in problem.cause and problem.cure


@pytest.mark.parametrize("topic", ["#", "+", "a/+/b/#", "+/+", "/", "$share/crane/a/#", "a/" + 65533 * "b"])
def test_a_topic_of_the_standard_is_taken(topic):
    assert mqtt.fault_of_topic(topic) is None


@pytest.mark.parametrize(
    ("path", "asked"),
    [
        ("/hose/%23", "hose/#"),
        ("//hose/#", "/hose/#"),
        ("///hose", "//hose"),
        ("/a?b=c/#", "a?b=c/#"),
        ("/a?", "a?"),
    ],
)
def test_a_topic_is_subscribed_as_it_is_written_without_the_one_slash_behind_the_host(subscribe, path, asked):
    broker, source = subscribe(path, GRANTS)
    assert heard(source, "connected to") is not None
    assert broker.asked == [asked]


def test_a_subscription_that_the_broker_refuses_is_told_with_its_topic_and_nothing_is_called_connected(subscribe):
    _, source = subscribe("/hose/#", REFUSES)
    note = heard(source, "the broker refuses topic hose/#")
    assert note is not None and "access rules" in note and "Unspecified" not in note
    assert not heard(source, "connected to", patience=0.5)
    assert len(source.notes) == 1


def test_a_topic_that_was_refused_is_asked_for_again_and_connected_is_told_when_it_is_granted(subscribe, monkeypatch):
    monkeypatch.setattr(mqtt, "ASKED_AGAIN", 0.2)
    broker, source = subscribe("/hose", REFUSES, REFUSES, GRANTS)
    assert heard(source, "connected to") is not None
    assert broker.asked == 3 * ["hose"]
    assert [note.split(" ")[0] for note in source.notes] == ["no", "connected"]


def test_a_fault_while_a_topic_is_asked_for_ends_the_twin_and_not_the_thread_of_the_client(monkeypatch):
    class Granted:
        is_failure = False

    source = without_broker(["flow"])
    monkeypatch.setattr(source._client, "subscribe", lambda *_: 1 / 0)
    source._subscribe(source._client, None, None, Granted())
    with pytest.raises(SourceFault):
        source.poll(0.0)
    source.close()
