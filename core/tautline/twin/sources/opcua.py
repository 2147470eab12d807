"""Sensor data from an OPC UA server."""

from __future__ import annotations

import asyncio
import math
import queue
import threading
import time as clock
from collections.abc import Sequence
from datetime import UTC
from typing import Any

from tautline.scene.errors import option_error
from tautline.twin.sources.address import split_address
from tautline.twin.sources.connection import Connection, cause_of
from tautline.twin.sources.record import Record
from tautline.twin.sources.stamps import number_of

MOST = 100_000
PORT = 4840
PERIOD = 50.0
"""How often the server is asked to send changes, ms."""
TOGETHER = 0.002
"""Stamps that are no further apart than this make one record, s."""
GATHER = 0.02
"""How long the rest of a record is waited for, s."""
DELAYS = (0.5, 15.0)
"""Shortest and longest time between attempts to connect again, s."""
WATCHED = 1.0
"""How often the connection is looked at, s."""
DEEPEST, LARGEST = 8, 5000
"""Levels and nodes that are searched for a name."""


class OpcUa:
    """Subscribes to variables, and connects again by itself when the server was lost.

    Parameters
    ----------
    address : str
        ``opc.tcp://host[:port]/path``.
    columns : sequence of str
        Browse names below Objects, or node ids such as ``ns=2;s=Winch.Position``.

    Raises
    ------
    SceneError
        For an address without host or with a bad port, and where asyncua is not installed.
    """

    def __init__(self, address: str, columns: Sequence[str]) -> None:
        example = "opc.tcp://localhost:4840/crane"
        parts = split_address(address, address, example)
        if not parts.hostname:
            raise option_error("--source", address, "has no host", f"write it as in {example}")
        try:
            import asyncua  # noqa: F401
        except ImportError:
            raise option_error("--source", address, "needs asyncua", "pip install tautline[live]") from None
        self.name, self.live, self.again, self.ended = address, True, False, False
        self.refused = 0
        self.dropped, self.notes = 0, list[str]()
        self.factors: dict[str, float] = {}
        self.missing: list[str] = []
        self._connection = Connection(address, self.notes)
        self._address = address if parts.port else parts._replace(netloc=f"{parts.netloc}:{PORT}").geturl()
        self._columns = list(columns)
        self._queue: queue.Queue[tuple[float, str, float, float]] = queue.Queue(MOST)
        self._next: tuple[float, str, float, float] | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True, name="tautline OPC UA")
        self._thread.start()

    def _listen(self) -> None:
        asyncio.run(self._connect_again_and_again())

    async def _connect_again_and_again(self) -> None:
        delay = DELAYS[0]
        while not self._closing.is_set():
            self._followed = False
            try:
                await self._follow()
            except Exception as error:  # whatever the network does, the next attempt is the answer
                if self._followed:
                    self._connection.lost("" if isinstance(error, OSError) else cause_of(error))
                else:
                    self._connection.failed(cause_of(error), answered=not isinstance(error, OSError))
            if self._followed:
                delay = DELAYS[0]
            await asyncio.sleep(0.0 if self._closing.is_set() else delay)
            delay = min(2.0 * delay, DELAYS[1])

    async def _follow(self) -> None:
        """Follow the variables until the connection is lost."""
        from asyncua import Client

        async with Client(self._address, timeout=4.0) as client:
            nodes = await self._find(client)
            handler = _Handler(self, {str(node.nodeid): name for name, node in nodes.items()})
            subscription = await client.create_subscription(PERIOD, handler)
            followed = await subscription.subscribe_data_change(list(nodes.values())) if nodes else []
            refused = {name for name, one in zip(nodes, followed, strict=True) if not isinstance(one, int)}
            self._connection.made()
            self._followed = True
            self._tell_missing(set(self._columns) - set(nodes) | refused)
            while not self._closing.is_set():
                await asyncio.sleep(min(WATCHED, 0.1 if self._closing.is_set() else WATCHED))
                await client.check_connection()

    def _tell_missing(self, names: set[str]) -> None:
        """Say which variables there are none of; again only where it is others."""
        missing = sorted(names)
        if missing and missing != self.missing:
            cure = "compare them with the `column` of the sensors in the map"
            self.notes.append(f"the server has no variable {', '.join(missing)}: there is no reading of it; {cure}")
        self.missing = missing

    async def _find(self, client: Any) -> dict[str, Any]:
        """Nodes by column: by their id, or by their browse name."""
        ids = [name for name in self._columns if name.startswith(("ns=", "i=", "s="))]
        found = {name: node for name in ids if (node := _node(client, name)) is not None}
        wanted = set(self._columns) - set(ids)
        level, seen = [client.nodes.objects], 0
        for _ in range(DEEPEST):
            below = []
            for node in level:
                for child in await node.get_children():
                    seen += 1
                    name = (await child.read_browse_name()).Name
                    if name in wanted:
                        found.setdefault(name, child)
                    below.append(child)
            level = below
            if not wanted - set(found) or seen > LARGEST:
                break
        return found

    def poll(self, timeout: float) -> Record | None:
        """The next record: the changes of one stamp."""
        self._connection.watch()
        first = self._take(timeout)
        if first is None:
            return None
        values = dict.fromkeys(self._columns, math.nan)
        values[first[1]] = first[2]
        while (more := self._take(GATHER)) is not None:
            if abs(more[0] - first[0]) > TOGETHER or not math.isnan(values[more[1]]):
                self._next = more
                break
            values[more[1]] = more[2]
        return Record(first[0], values, first[3])

    def take_change(self, time: float, column: str, value: float) -> None:
        """Put a change into the queue; one that finds no room is counted."""
        try:
            self._queue.put_nowait((time, column, value, clock.monotonic()))
        except queue.Full:
            self.dropped += 1

    def _take(self, timeout: float) -> tuple[float, str, float, float] | None:
        if self._next is not None:
            found, self._next = self._next, None
            return found
        try:
            return self._queue.get(timeout=timeout) if timeout > 0.0 else self._queue.get_nowait()
        except queue.Empty:
            return None

    def close(self) -> None:
        """Let go of the server."""
        self.ended = True
        self._closing.set()
        self._thread.join(timeout=5.0)


def _node(client: Any, text: str) -> Any:
    """The node of an id; None where the text is no id."""
    from asyncua.ua import UaError

    try:
        return client.get_node(text)
    except (UaError, ValueError):
        return None


class _Handler:
    """What the client calls with every change."""

    def __init__(self, source: OpcUa, names: dict[str, str]) -> None:
        self._source, self._names = source, names

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        """Take a change; its stamp is that of the source."""
        stamp = data.monitored_item.Value.SourceTimestamp
        time = clock.time() if stamp is None else stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp()
        self._source.take_change(time, self._names[str(node.nodeid)], number_of(value))
