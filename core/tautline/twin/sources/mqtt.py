"""Sensor data from an MQTT broker."""

from __future__ import annotations

import json
import math
import queue
import sys
import time as clock
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import unquote

from tautline.scene.errors import option_error
from tautline.twin.pace import Pace
from tautline.twin.sources.connection import Connection, cause_of, split_address
from tautline.twin.sources.objects import SAID_OF, UNIT, VALUE, ObjectReadings, why_no_reading
from tautline.twin.sources.record import Record, SourceFault
from tautline.twin.sources.stamps import Stamps
from tautline.twin.sources.stated_units import Remarks, Stated

MOST = 10_000
"""Records that may wait; beyond, the oldest is dropped."""
PORTS = {"mqtt": 1883, "mqtts": 8883}
QUALITY = 1
"""At least once: what comes twice is told by its stamp."""
DELAYS = (1, 30)
"""Shortest and longest time between attempts to connect again, s."""
KEEPALIVE = 15
ASKED_AGAIN = 30.0
"""Time after which a topic is asked for again that the broker has refused, s."""
LONGEST_TOPIC = 65535
"""Bytes of a topic, at most."""
LISTED = 6
"""Keys that a message names."""
UNSPECIFIED = "Unspecified error"
"""What paho calls a connection that ended without a word."""


class Mqtt:
    """Subscribes to a topic, and connects again by itself when the broker was lost.

    A message is a JSON object with a stamp and columns; or one column, of which the last level of the topic is the
    name: ``{"time": ..., "value": ...}``, or a bare number, which has the time of its arrival. So has an object
    without a stamp, unless the map names one. The ``unit`` beside a ``value`` is converted. A ``quality`` or a
    ``status`` that is not good makes readings count as missing.

    Parameters
    ----------
    address : str
        ``mqtt://[user:password@]host[:port]/topic``; ``mqtts`` for TLS. The topic may have wildcards.
    columns : sequence of str
    time : str
        The key of the stamp; empty for the usual names.
    units : mapping, optional
        Units by column that the readings are wanted in.

    Raises
    ------
    SceneError
        For an address without host or topic or with a bad port, for a topic that no broker takes, and where paho-mqtt
        is not installed.
    """

    def __init__(
        self, address: str, columns: Sequence[str], time: str = "", units: Mapping[str, str] | None = None,
        stated: Stated | None = None,
    ) -> None:  # fmt: skip
        whole = address.replace("#", "%23")
        parts = split_address(whole, address, "mqtt://localhost:1883/crane/#")
        # A topic may begin with a slash, and have a question mark: only the slash behind the host is none of it.
        behind = whole.partition("://")[2][len(parts.netloc) :]
        topic = unquote(behind[1:]) if behind.startswith("/") else ""
        if not parts.hostname or not topic:
            cure = "write mqtt://host:1883/topic, such as mqtt://localhost/crane/#"
            raise option_error("--source", address, "has no host or no topic", cure)
        if fault := fault_of_topic(topic):
            raise option_error("--source", address, *fault)
        try:
            from paho.mqtt import client as paho
        except ImportError:
            raise option_error("--source", address, "needs paho-mqtt", "pip install tautline[live]") from None
        self.name, self.live, self.again, self.ended = address, True, False, False
        self.refused = self.left_out = self.dropped = 0
        self.factors: dict[str, float] = {}
        self.notes: list[str] = []
        self.pace = Pace()
        self._connection = Connection(address, self.notes)
        self._columns, self._topic = list(columns), topic
        self._stamps = Stamps(time, self.notes, columns)
        self._topics: dict[str, str] = {}
        self._remarks = Remarks(self.notes)
        self._readings = ObjectReadings(columns, units or {}, self.notes, self.factors, stated)
        self._fault: BaseException | None = None
        self._ask_at = math.inf
        self._queue: queue.Queue[Record] = queue.Queue(MOST)
        self._client = paho.Client(paho.CallbackAPIVersion.VERSION2)
        if parts.username:
            self._client.username_pw_set(unquote(parts.username), unquote(parts.password or ""))
        if parts.scheme == "mqtts":
            self._client.tls_set()
        self._client.on_connect = self._subscribe
        self._client.on_subscribe = self._subscribed
        self._client.on_connect_fail = self._not_reached
        self._client.on_disconnect = self._lost
        self._client.on_message = self._take
        self._client.reconnect_delay_set(*DELAYS)
        self._client.connect_async(parts.hostname, parts.port or PORTS[parts.scheme], KEEPALIVE)
        self._client.loop_start()

    def _subscribe(self, client: Any, data: Any, flags: Any, reason: Any, *_: Any) -> None:
        """At every connection: a broker that was started again knows nothing of us."""
        if reason.is_failure:
            self._connection.failed(f"the broker refuses: {str(reason).lower()}", answered=True)
            return
        self._ask()

    def _ask(self) -> None:
        self._ask_at = math.inf
        try:
            self._client.subscribe(self._topic, QUALITY)
        except Exception as fault:  # told by `poll`, as the thread of paho may be the one that would die of it
            self._fault = fault

    def _subscribed(self, client: Any, data: Any, number: Any, reasons: Sequence[Any], *_: Any) -> None:
        """The broker's answer: only with it is known whether messages may come."""
        refused = [one for one in reasons if one.is_failure]
        if not refused:
            self._connection.made()
            return
        self._ask_at = clock.monotonic() + ASKED_AGAIN
        because = "" if str(refused[0]) == UNSPECIFIED else f" ({str(refused[0]).lower()})"
        cause = (
            f"the broker refuses topic {self._topic}{because}. Its access rules may not let this user read that topic"
        )
        self._connection.failed(cause, answered=True)

    def _not_reached(self, *_: Any) -> None:
        # paho calls this while it handles the error, and does not hand it on.
        self._connection.failed(cause_of(sys.exc_info()[1]))

    def _lost(self, client: Any, data: Any, flags: Any, reason: Any, *_: Any) -> None:
        self._ask_at = math.inf  # it is asked for at the next connection
        if not self.ended:
            self._connection.lost("" if str(reason) == UNSPECIFIED else str(reason).lower())

    def _take(self, client: Any, data: Any, message: Any) -> None:
        try:
            record = self._read(message.topic, message.payload, bool(message.retain))
        except Exception as fault:  # told by `poll`: the thread of paho would die of it in silence
            self._fault = fault
            return
        if record is None:
            return
        self.pace.take(record.time, record.arrived, record.values)
        while True:
            try:
                self._queue.put_nowait(record)
                return
            except queue.Full:
                self.dropped += 1
                try:
                    self._queue.get_nowait()
                except queue.Empty:
                    pass

    def _read(self, topic: str, payload: bytes, retained: bool = False) -> Record | None:
        """A record out of a message; None for what is none, which is counted."""
        try:
            found: Any = json.loads(payload)
        except (ValueError, RecursionError):  # the second for brackets in brackets without end
            self.refused += 1
            return None
        column = topic.rpartition("/")[2]
        values = dict.fromkeys(self._columns, math.nan)
        stamp: Any = None
        if isinstance(found, dict):
            key = self._stamps.column([str(name) for name in found])
            stamp = self._readings.stamp(self._stamps, key, found[key]) if key is not None else None
            self._readings.hear_units(found, f"topic {topic}:", key, column)
            if not self._readings.are_good(found, f"topic {topic}:"):
                self.left_out += 1
                return None
            values |= self._readings.values(found, f"topic {topic}:", key, column)
        elif column in values:
            values[column] = self._readings.number(column, found)
        if why := why_no_reading(found, self._columns, column):
            self._remarks.tell(f"no reading {topic}", f"topic {topic}: {why}")
        if _are_none(values):
            if column in values or (isinstance(found, dict) and values.keys() & found.keys()):
                self.refused += 1
            else:
                self.left_out += 1  # it is of other things
            return None
        if self._lacks_stamp(topic, found, stamp, retained) or _are_none(self._of_its_topic(topic, values, retained)):
            self.left_out += 1
            return None
        return Record(clock.time() if stamp is None else stamp, values, clock.monotonic())

    def _of_its_topic(self, topic: str, values: dict[str, float], retained: bool) -> dict[str, float]:
        """Take out readings of columns that come from another topic: from the first that sends them now.

        What the broker has kept always comes first, and it may be of a topic that nobody sends any more.
        """
        for name in [name for name, value in values.items() if not math.isnan(value)]:
            first = self._topics.get(name, topic) if retained else self._topics.setdefault(name, topic)
            if are_of_two(first, topic, name):
                self._remarks.tell(
                    f"topics of {name}",
                    f"column '{name}' comes from two topics, {first} and {topic}: readings of {topic} are left out. "
                    "Name a topic in --source that leads to one machine",
                )
                values[name] = math.nan
        return values

    def _lacks_stamp(self, topic: str, found: Any, stamp: float | None, retained: bool) -> bool:
        """Whether a message is left out as it has no stamp: nothing shows how old is what the broker has kept."""
        if retained and stamp is None:
            what = "a message" if isinstance(found, dict) else "a number"
            self._remarks.tell(
                f"retained {topic}",
                f"topic {topic}: {what} without a stamp, which the broker has kept, is left out. Its age is not known",
            )
            return True
        return isinstance(found, dict) and stamp is None and self._lacks_time(topic, found)

    def _lacks_time(self, topic: str, found: Mapping[str, Any]) -> bool:
        """Whether an object without a stamp is left out, as the map names one; either is told."""
        if self._stamps.asked:
            text = f"topic {topic}: messages without '{self._stamps.asked}' are left out. The map gives that as `time`"
            self._remarks.tell(f"time of {topic}", text)
            return True
        known = {*self._columns, VALUE, *UNIT, *SAID_OF}
        others = [str(name) for name in found if str(name) not in known]
        text = f"topic {topic}: messages have no time, so the time of arrival counts"
        if others:
            text += f". Keys that are no columns: {', '.join(others[:LISTED])}{', ...' if len(others) > LISTED else ''}"
            text += f". Write `time: {others[0]}` in the map if {others[0]} is the time"
        self._remarks.tell(f"time of {topic}", text)
        return False

    def poll(self, timeout: float) -> Record | None:
        """The next record; None where none came within so many seconds.

        Raises
        ------
        SourceFault
            Where reading a message, or asking for the topic, has failed by a fault of the program.
        """
        if self._fault is not None:
            self.ended = True
            raise SourceFault(self.name, self._fault)
        self._connection.watch()
        if clock.monotonic() >= self._ask_at:
            self._ask()
        try:
            return self._queue.get(timeout=timeout) if timeout > 0.0 else self._queue.get_nowait()
        except queue.Empty:
            return None

    @property
    def stated(self) -> Stated:
        """Units that were stated last: what the broker sends meanwhile is not sent again."""
        return self._readings.stated

    @property
    def waiting(self) -> int:
        """Records that have come and were not taken yet."""
        return self._queue.qsize()

    def close(self) -> None:
        """Let go of the broker."""
        self.ended = True
        self._client.disconnect()
        self._client.loop_stop()


def fault_of_topic(topic: str) -> tuple[str, str] | None:
    """Why no broker takes a topic to subscribe to (MQTT 3.1.1, 4.7), and what helps; None for a good one."""
    whole = "# stands for all levels below: write it last and alone between slashes, as in crane/#"
    one = "+ stands for one level: write it alone between slashes, as in site/+/rope"
    levels = topic.split("/")
    for level in levels:
        if "#" in level and len(level) > 1:
            return f"has # beside other characters, in '{level}'", whole
        if "+" in level and len(level) > 1:
            return f"has + beside other characters, in '{level}'", one
    if "#" in levels[:-1]:
        return "has # before the end of the topic", whole
    if "\0" in topic:
        return "has a character NUL in its topic", "leave %00 out"
    try:
        size = len(topic.encode())
    except UnicodeEncodeError:
        return "has a topic that is no text in UTF-8", "write such a character with %, as in caf%C3%A9"
    if size > LONGEST_TOPIC:
        return f"has a topic of {size} bytes: a topic has {LONGEST_TOPIC} at most", "write a shorter one, with # or +"
    return None


def _are_none(values: Mapping[str, float]) -> bool:
    return all(math.isnan(value) for value in values.values())


def are_of_two(first: str, topic: str, column: str) -> bool:
    """Whether two topics that bring one column are those of two machines.

    Beside the topic of the column, of which it is the last level, there may be one that has all columns.
    """
    (path, _, last), (other_path, _, other) = first.rpartition("/"), topic.rpartition("/")
    return path != other_path or (last != other and column not in (last, other))
