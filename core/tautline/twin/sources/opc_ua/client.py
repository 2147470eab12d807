"""Sensor data from an OPC UA server."""

from __future__ import annotations

import asyncio
import math
import queue
import threading
import time as clock
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC
from itertools import count
from typing import Any

from tautline.scene.errors import option_error
from tautline.twin.pace import Pace
from tautline.twin.sources.connection import Connection, cause_of, split_address
from tautline.twin.sources.objects import ObjectReadings, what_is
from tautline.twin.sources.opc_ua.bursts import Bursts, measured_over
from tautline.twin.sources.opc_ua.holding import Change, Holding
from tautline.twin.sources.opc_ua.nodes import (
    DEEPEST,
    LARGEST,
    Choice,
    chosen,
    is_id,
    listed,
    names_of_unit,
    nodes_by_column,
    unit_nodes,
    units_of,
    variables_of,
)
from tautline.twin.sources.record import Record, SourceFault
from tautline.twin.sources.stated_units import Remarks, Stated, StatedUnits

MOST = 100_000
PORT = 4840
PERIOD = 50.0
"""How often the server is asked to send changes, ms."""
GATHER, HURRIED = 0.02, 0.002
"""Pause that ends what is sent together, and such a pause once a period has gone by, s: a stream whose readings come
one by one may have none of the first kind, and is not held up longer."""
CATCHES_UP = 2.0
"""Readings that come so many times as fast as they were measured were held up: the first kind of pause ends them."""
LONGEST_GATHERED = 1.0
"""How far apart readings may arrive that are taken together, s."""
DELAYS = (0.5, 15.0)
"""Shortest and longest time between attempts to connect again, s."""
KEEPALIVES = 5
"""Periods after which a server that has nothing to send is to say that it is alive."""
LIFETIME = 10_000
"""Periods after which a server may give up a client that asks for nothing."""
WATCHED = 0.1
"""How often the connection is looked at, s."""
NAMED = 12
"""Variables that a message names at most."""
NO_YEAR = 1601
"""Year in which the stamps of OPC UA begin: one of it is none."""
SAYS = "the server says that"
"""Who gives units, for messages."""
UNITS_EVERY = 30.0
"""How often units are read again of a server that does not send changes of them, s."""
DEAF = 60.0
"""How long a server may say nothing at all before it is connected to anew, s."""


class Lost:
    """In the queue: the connection was lost here, and nothing holds any more."""


Heard = Change | float | Lost
"""What waits in the queue: a change, when the server was alive, s, or that it was lost."""


class OpcUa:
    """Subscribes to variables, and connects again by itself when the server was lost.

    Parameters
    ----------
    address : str
        ``opc.tcp://host[:port]/path``.
    columns : sequence of str
        Browse names below Objects that one variable has, or node ids such as ``ns=2;s=Winch.Position``.
    units : mapping, optional
        Units by column that the readings are wanted in; those of the server are converted.

    Raises
    ------
    SceneError
        For an address without host or with a bad port, and where asyncua is not installed.
    """

    def __init__(self, address: str, columns: Sequence[str], units: Mapping[str, str] | None = None) -> None:
        example = "opc.tcp://localhost:4840/crane"
        parts = split_address(address, address, example)
        if not parts.hostname:
            raise option_error("--source", address, "has no host", f"write it as in {example}")
        try:
            import asyncua  # noqa: F401
        except ImportError:
            raise option_error("--source", address, "needs asyncua", "pip install tautline[live]") from None
        self.name, self.live, self.again, self.ended = address, True, False, False
        self.refused = self.left_out = 0
        self.dropped, self.notes, self.pace = 0, list[str](), Pace()
        self.factors: dict[str, float] = {}
        self.stated: Stated = {}  # a server is asked for its units at each connection
        self.missing: list[str] = []
        self._told: set[str] = set()
        self._units, self._remarks = units or {}, Remarks(self.notes)
        self._readings = ObjectReadings(columns, self._units, self.notes, self.factors)
        self._stated = StatedUnits(self._units, self.notes, self.factors)
        self._scales: dict[str, float] = {}
        self._connection = Connection(address, self.notes)
        self._address = address if parts.port else parts._replace(netloc=f"{parts.netloc}:{PORT}").geturl()
        self._columns = list(columns)
        self._queue: queue.Queue[Heard] = queue.Queue(MOST)
        self._next: Heard | None = None
        self._holding = Holding(columns, 1e-3 * PERIOD, notes=self.notes)
        self._bursts = Bursts()
        self._made: deque[Record] = deque()
        self._fault: BaseException | None = None
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True, name="tautline OPC UA")
        self._thread.start()

    def _listen(self) -> None:
        try:
            asyncio.run(self._connect_again_and_again())
        except BaseException as fault:  # told by `poll`: a thread that died in silence would be waited for without end
            self._fault = fault

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
            self._put(Lost())
            if self._followed:
                delay = DELAYS[0]
            await asyncio.sleep(0.0 if self._closing.is_set() else delay)
            delay = min(2.0 * delay, DELAYS[1])

    async def _follow(self) -> None:
        """Follow the variables until the connection is lost."""
        from asyncua import Client, ua

        asked = ua.CreateSubscriptionParameters(
            RequestedPublishingInterval=PERIOD, RequestedLifetimeCount=LIFETIME, RequestedMaxKeepAliveCount=KEEPALIVES,
            MaxNotificationsPerPublish=LIFETIME, PublishingEnabled=True, Priority=0,
        )  # fmt: skip
        async with Client(self._address, timeout=4.0) as client:
            choice, whole = await self._choose(client)
            nodes = nodes_by_column(client, choice.ids)
            units = await unit_nodes(nodes)
            self._scale(await units_of(units))
            handler = _Handler(self, nodes, units)
            subscription = await client.create_subscription(asked, handler)
            handles = count(1)
            refused = await _subscribe(subscription, nodes, handles)
            await _subscribe(subscription, units, handles)
            self._connection.made()
            self._followed = True
            self._tell_missing(set(self._columns) - set(nodes) - set(choice.doubted) | refused, whole)
            self._tell_choice(choice, whole)
            told, read = 0.0, clock.monotonic()
            while not self._closing.is_set():
                await asyncio.sleep(WATCHED)
                await client.check_connection()
                alive = await _alive(client, subscription)
                if clock.monotonic() - alive > DEAF:
                    raise TimeoutError
                if handler.doubted or clock.monotonic() - read > UNITS_EVERY:
                    read = clock.monotonic()
                    self._scale(await units_of(units))
                    handler.believe()
                await asyncio.sleep(0.0)  # what came with this sign of life is taken before it
                if alive > told:
                    told = alive
                    self._put(alive)

    def _tell_missing(self, columns: set[str], whole: bool) -> None:
        """Say which variables there are none of, or were not found; again only where it is others."""
        missing = sorted(columns)
        if missing and missing != self.missing:
            unseen = [one for one in missing if not whole and not is_id(one)]
            if none := [one for one in missing if one not in unseen]:
                cure = "compare them with the `column` of the sensors in the map"
                names = listed(none, NAMED)
                self.notes.append(f"the server has no variable {names}: there is no reading of it; {cure}")
            if unseen:
                self.notes.append(
                    f"variable {listed(unseen, NAMED)}: not found among the nodes that were searched, and others were "
                    "not searched. There is no reading of it; write its node id as `column` in the map"
                )
        self.missing = missing

    def _scale(self, units: Mapping[str, list[str]]) -> None:
        """Convert readings of now on from the units that the server gives; one that has changed is told."""
        self._scales |= {column: self._stated.factor(column, names, SAYS) for column, names in units.items()}

    def take_unit(self, column: str, unit: Any) -> None:
        """Take a unit that the server sends as it is changed."""
        self._scale({column: names_of_unit(unit)})

    def read(self, column: str, value: Any) -> float:
        """A reading of a variable, in the map's unit; NaN for what is no number, which is told once."""
        if value is None or not isinstance(value, (int, float, str)) or isinstance(value, bool):
            why = f"the server gives {column} {what_is(value)}, and that is no number: its readings count as missing"
            self._remarks.tell(f"kind of {column}", why)
            return math.nan
        found = self._readings.number(column, value)
        if isinstance(value, str) and math.isnan(found) and "," not in value:
            why = f"the server gives {column} {what_is(value)}, and that is no number: such readings count as missing"
            self._remarks.tell(f"kind of {column}", why)
        return found * self._scales.get(column, 1.0)

    async def _choose(self, client: Any) -> tuple[Choice, bool]:
        """Variables of the columns, and whether all nodes were searched; none are where all columns are ids."""
        named = any(not is_id(name) for name in self._columns)
        variables, whole = await variables_of(client) if named else ([], True)
        return chosen(self._columns, variables), whole

    def _tell_choice(self, choice: Choice, whole: bool) -> None:
        """Say which columns are not taken, for they may be of another machine; the same once only."""
        cure = "So there is no reading of it; write the right node id as `column` in the map"
        texts = [*(f"{why}. {cure}" for why in choice.doubted.values()), *choice.remarks]
        if not whole:
            texts.append(
                f"the server has more than {LARGEST} nodes, or more than {DEEPEST} levels of them, and not all were "
                "searched for names. A name may be there once more; write node ids as `column` in the map"
            )
        self.notes += [text for text in texts if text not in self._told]
        self._told.update(texts)

    def poll(self, timeout: float) -> Record | None:
        """The next record: the changes of one stamp, and what still holds.

        Raises
        ------
        SourceFault
            Where the thread that follows the server has died.
        """
        if self._fault is not None:
            self.ended = True
            raise SourceFault(self.name, self._fault)
        self._connection.watch()
        if self._made:
            return self._made.popleft()
        first = self._take(timeout)
        if isinstance(first, float):
            self._made.extend(self._holding.until(first))
            return self._made.popleft() if self._made else None
        if isinstance(first, Lost):
            self._holding.forget()
            self._bursts.forget()
        if first is None or isinstance(first, Lost):
            return None
        for changes in self._bursts.records(self._gather(first)):
            self._made.extend(self._holding.records(changes))
        return self._made.popleft() if self._made else None

    def _gather(self, first: Change) -> list[Change]:
        """A change and those that have come with it, up to a pause, or a sign of life that none follows at once."""
        found, begun, held, alive = [first], clock.monotonic(), 0.0, None
        while True:
            came_in = found[-1].arrived - first.arrived
            hurries = came_in >= held and clock.monotonic() - begun >= 1e-3 * PERIOD
            more = self._take(HURRIED if hurries else GATHER)
            if isinstance(more, Change) and more.arrived - first.arrived <= LONGEST_GATHERED:
                found.append(more)
            elif isinstance(more, float) and self._goes_on(found[-1]):
                alive = more
            elif more is None and hurries and came_in < (held := measured_over(found) / CATCHES_UP):
                continue
            else:
                self._next = alive if more is None else more
                return found

    def _goes_on(self, last: Change) -> bool:
        """Whether the next in the queue is a change that came without a pause: a sign of life was between both."""
        with self._queue.mutex:  # another thread fills it
            following = self._queue.queue[0] if self._queue.queue else None
        return isinstance(following, Change) and following.arrived - last.arrived <= GATHER

    def take_change(self, change: Change) -> None:
        """Put a change into the queue; one that finds no room is counted."""
        if not change.first:  # the first reading of a variable is as old as its last change
            self.pace.take(change.time, change.arrived, {change.column: change.value})
        self._put(change)

    def tell_status(self, column: str, status: str, used: bool) -> None:
        """Say that the server calls a reading of a variable no good."""
        then = "its readings are used" if used else "its readings count as missing"
        self.notes.append(f"the server gives {column} the status {status}: {then}")

    def _put(self, what: Heard) -> None:
        try:
            self._queue.put_nowait(what)
        except queue.Full:
            self.dropped += 1

    def _take(self, timeout: float) -> Heard | None:
        """What was heard next; None where nothing was."""
        if self._next is not None:
            kept, self._next = self._next, None
            return kept
        try:
            return self._queue.get(timeout=timeout) if timeout > 0.0 else self._queue.get_nowait()
        except queue.Empty:
            return None

    @property
    def waiting(self) -> int:
        """Records that have come and were not taken yet: as many as the variable with most changes has."""
        with self._queue.mutex:
            waits = [*self._queue.queue, self._next]
        changes = Counter(one.column for one in waits if isinstance(one, Change))
        return len(self._made) + max(changes.values(), default=0)

    def close(self) -> None:
        """Let go of the server."""
        self.ended = True
        self._closing.set()
        self._thread.join(timeout=5.0)


async def _subscribe(subscription: Any, nodes: dict[str, Any], handles: Iterator[int]) -> set[str]:
    """Ask for every new status, value and stamp; gives the names of variables that the server does not send.

    `handles` are numbers that no other variable of the subscription has.
    """
    from asyncua import ua

    refused = set(nodes)
    # A machine that stands still sends new stamps only. A server that does not know this filter is asked without.
    for trigger in (ua.DataChangeTrigger.StatusValueTimestamp, None):
        names, requests = sorted(refused), []
        for name in names:
            wanted = ua.MonitoringParameters(ClientHandle=next(handles), SamplingInterval=PERIOD, QueueSize=0)
            if trigger is not None:
                wanted.Filter = ua.DataChangeFilter(Trigger=trigger)
            item = ua.ReadValueId(NodeId=nodes[name].nodeid, AttributeId=ua.AttributeIds.Value)
            requests.append(ua.MonitoredItemCreateRequest(item, ua.MonitoringMode.Reporting, wanted))
        followed = await subscription.create_monitored_items(requests) if requests else []
        refused = {name for name, one in zip(names, followed, strict=True) if not isinstance(one, int)}
    return refused


async def _alive(client: Any, subscription: Any) -> float:
    """When the server last said that it is alive, by ``time.monotonic()``, s."""
    if hasattr(subscription, "last_publish_at"):
        return float(subscription.last_publish_at or clock.monotonic())
    now = clock.monotonic()  # asyncua before 2.0 does not tell: then the server is asked
    await client.nodes.server_state.read_value()
    return now


NO_READING = (0x408F0000, 0x40900000, 0x40910000, 0x40920000)
"""Uncertain statuses of what is not measured: last usable value with and without a connection, substitute, initial."""


SEMANTICS_CHANGED = 0x4000
"""Bit of a status whose reading may mean something else than before, such as by another unit (part 4, 7.39.1)."""


@dataclass(frozen=True)
class _Sent:
    """What was sent of a variable: as :class:`Change`, with its value in the server's unit."""

    time: float
    column: str
    value: Any
    arrived: float
    first: bool
    usable: bool


class _Handler:
    """What the client calls with every change.

    Parameters
    ----------
    source : OpcUa
    nodes, units : mapping of str to Node
        Variables by column, and those of their units.

    Attributes
    ----------
    doubted : set of str
        Columns whose unit is to be read again: their changes wait for that.
    """

    def __init__(self, source: OpcUa, nodes: Mapping[str, Any], units: Mapping[str, Any]) -> None:
        self._source, self.doubted = source, set[str]()
        self._names = {str(node.nodeid): name for name, node in nodes.items()}
        self._units = {str(node.nodeid): name for name, node in units.items()}
        self._known: set[str] = set()
        self._status: dict[str, int] = {}
        self._marked: set[str] = set()
        self._withheld: list[_Sent] = []

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        """Take a change; its stamp is that of the source, or of the server where the source gives none."""
        sent, id = data.monitored_item.Value, str(node.nodeid)
        if id in self._units:
            self._source.take_unit(self._units[id], value)
            return
        column = self._names[id]
        time = _seconds(sent.SourceTimestamp, _seconds(sent.ServerTimestamp, clock.time()))
        first = column not in self._known
        self._known.add(column)
        self._doubt(column, sent.StatusCode)
        change = _Sent(time, column, value, clock.monotonic(), first, self._usable(column, sent.StatusCode))
        if column in self.doubted:
            self._withheld.append(change)
        else:
            self._take(change)

    def believe(self) -> None:
        """Take what waited for the units, which were read again now."""
        withheld, self._withheld = self._withheld, []
        self.doubted.clear()
        for one in withheld:
            self._take(one)

    def _take(self, sent: _Sent) -> None:
        reading = self._source.read(sent.column, sent.value) if sent.usable else math.nan
        self._source.take_change(Change(sent.time, sent.column, reading, sent.arrived, sent.first))

    def _doubt(self, column: str, status: Any) -> None:
        """Let changes wait where the status begins to say that the unit may be another one; it may go on to say so."""
        if status is None or not int(status.value) & SEMANTICS_CHANGED:
            self._marked.discard(column)
        elif column not in self._marked:
            self._marked.add(column)
            self.doubted.add(column)

    def _usable(self, column: str, status: Any) -> bool:
        """Whether a reading counts by its status: good, or uncertain and measured. Another status is told once."""
        code = 0 if status is None else int(status.value) & 0xFFFF0000
        good, uncertain = code >> 30 == 0, code >> 30 == 1
        usable = good or (uncertain and code not in NO_READING)
        if code != self._status.get(column, 0) and not good:
            self._source.tell_status(column, str(status.name), usable)
        self._status[column] = 0 if good else code
        return usable


def _seconds(stamp: Any, otherwise: float) -> float:
    """A stamp of OPC UA in seconds since 1970; UTC, which it has no zone for.

    None is sent as the beginning of 1601, and may be read so (part 6, 5.2.2.5).
    """
    if stamp is None or stamp.year <= NO_YEAR:
        return otherwise
    return float(stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp())
