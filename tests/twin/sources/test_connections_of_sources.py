"""What a live source says of its connection: that it is waited for, that it answers, that it was lost."""

import json
import socket
import ssl
import threading
import time as clock

import pytest
from twin.sources.messages import Message, without_broker
from twin.sources.test_sources_of_data import free_port, server

from tautline.twin.sources.connection import PATIENCE, Connection, cause_of, without_password
from tautline.twin.sources.mqtt import MOST
from tautline.twin.sources.opening import open_source


def heard(source, words, patience=15.0):
    """The note with these words, once it was said; None where it was not."""
    end = clock.monotonic() + patience
    while clock.monotonic() < end:
        source.poll(0.05)
        if found := [note for note in source.notes if words in note]:
            return found[0]
    return None


@pytest.mark.parametrize("address", ["mqtt://user:secret@127.0.0.1:{}/crane/#", "opc.tcp://127.0.0.1:{}/crane"])
def test_a_source_that_nobody_answers_says_once_that_it_is_waited_for_and_why(address):
    pytest.importorskip("paho.mqtt.client" if address.startswith("mqtt") else "asyncua")
    source = open_source(address.format(free_port()), ["heave"])
    try:
        note = heard(source, "the connection is refused")
        assert note is not None and "tries again" in note and "secret" not in note
        clock.sleep(1.5)
        assert len(source.notes) == 1
    finally:
        source.close()


def refusing_broker(port):
    """Takes connections and says to all of them that the password is bad."""
    listening = socket.create_server(("127.0.0.1", port))

    def serve():
        while True:
            try:
                one, _ = listening.accept()
            except OSError:
                return
            with one:
                one.recv(1024)
                one.sendall(bytes([0x20, 0x02, 0x00, 0x04]))
                one.recv(1024)

    threading.Thread(target=serve, daemon=True).start()
    return listening


def test_a_broker_that_refuses_the_password_is_told_with_this_cause():
    pytest.importorskip("paho.mqtt.client")
    port = free_port()
    with refusing_broker(port):
        source = open_source(f"mqtt://user:secret@127.0.0.1:{port}/crane/#", ["heave"])
        try:
            assert heard(source, "the broker refuses: bad user name or password") is not None
            assert not any("lost" in note or "connected to" in note for note in source.notes)
        finally:
            source.close()


def test_opc_ua_says_that_it_is_connected_what_the_server_lacks_and_that_it_was_lost():
    pytest.importorskip("asyncua")
    port = free_port()
    running = server(port)
    source = open_source(f"opc.tcp://127.0.0.1:{port}/tautline/", ["heave", "hook", "ns=2;s=nowhere", "ns=x"])
    try:
        note = heard(source, "the server has no variable")
        assert note is not None and "hook, ns=2;s=nowhere, ns=x" in note
        assert source.notes[0].startswith("connected to opc.tcp://")
    finally:
        running.stop()
    try:
        assert heard(source, "was lost; tautline tries again") is not None
        assert len(source.notes) == 3
    finally:
        source.close()


def test_messages_that_find_no_room_are_counted():
    source, message = without_broker(["heave"]), Message(json.dumps({"time": 1.0, "heave": 0.5}))
    for _ in range(MOST + 7):
        source._take(None, None, message)
    source.close()
    assert source.dropped == 7 and source.refused == 0


def test_an_address_without_any_answer_is_told_after_some_seconds():
    now, notes = [0.0], []
    connection = Connection("mqtt://host/x", notes, lambda: now[0])
    connection.watch()
    assert not notes
    now[0] = PATIENCE + 0.1
    connection.watch()
    connection.watch()
    assert notes == ["no data from mqtt://host/x yet: no answer for 5 s; tautline tries again until it is connected"]


def test_a_loss_is_told_once_and_a_refusal_after_it_too():
    notes = []
    connection = Connection("mqtt://host/x", notes)
    connection.made()
    connection.lost("keep alive timeout")
    connection.lost()
    connection.failed("the connection is refused")
    connection.failed("the broker refuses: not authorized", answered=True)
    connection.made()
    assert [note.split(";")[0] for note in notes] == [
        "connected to mqtt://host/x",
        "the connection to mqtt://host/x was lost: keep alive timeout",
        "no data from mqtt://host/x yet: the broker refuses: not authorized",
        "connected to mqtt://host/x",
    ]


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ConnectionRefusedError(111, "Connect call failed"), "the connection is refused"),
        (OSError("Multiple exceptions: [Errno 111] Connect call failed"), "the connection is refused"),
        (socket.gaierror(-2, "Name or service not known"), "the name of the host is not known"),
        (TimeoutError(), "no answer in time"),
        (OSError(113, "No route to host"), "No route to host"),
        (ssl.SSLError(1, "wrong version number"), "wrong version number"),
        (ValueError(), "ValueError"),
    ],
)
def test_a_cause_is_said_in_plain_words(error, said):
    assert cause_of(error) == said


def test_a_printed_address_has_no_password():
    assert without_password("mqtt://me:secret@host:1883/a@b/#") == "mqtt://me@host:1883/a@b/#"
    assert without_password("opc.tcp://host:4840/crane") == "opc.tcp://host:4840/crane"
