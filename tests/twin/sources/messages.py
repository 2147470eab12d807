"""Messages that come to a source of MQTT without a broker."""

import pytest

from tautline.twin.sources.opening import open_source


class Message:
    """What the client hands on of a message."""

    def __init__(self, payload, topic="crane/row", retain=False):
        self.topic, self.payload, self.retain = topic, payload.encode(), retain


def without_broker(columns, **more):
    """A source that looks for no broker, and has the messages that are handed to it.

    One that looks for a broker where there is none sleeps for a second before it can be closed.
    """
    pytest.importorskip("paho.mqtt.client")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("paho.mqtt.client.Client.loop_start", lambda client: None)
        return open_source("mqtt://127.0.0.1/crane/#", columns, **more)
