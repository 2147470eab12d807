"""The server of the page: lines of the twin go to every browser that looks, as events (server-sent events).

It runs in a thread of its own. The twin hands lines over and never waits: a browser that does not read loses the oldest
lines, and what nobody looks at is not drawn. One who comes late gets the last minutes and the last picture at once.

A page stays open over many runs of a twin, so the first event says which twin this is, and which program made the page.

All that is kept for browsers is written in the server's thread alone: between what one gets at first and what comes for
it after that there is no gap, and nothing comes twice.
"""

from __future__ import annotations

import asyncio
import hashlib
import json
import logging
import secrets
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from tautline.scene.errors import option_error
from tautline.scene.values.moments import stamp_said
from tautline.scene.values.printed import scale_of_zero, scales
from tautline.twin.page.hosts import KnownHosts, addresses_of, bound, plain
from tautline.twin.page.picture import Picture
from tautline.twin.page.waiting import Waiting

HERE = Path(__file__).parent
FILES = {"/": ("page.html", "text/html"), "/page.js": ("page.js", "text/javascript"),
         "/page.css": ("page.css", "text/css")}  # fmt: skip
LATEST = 3000
"""Lines that are kept for those who come late."""
WAITING = 400
"""Lines that wait for a browser before the oldest are left out."""
ALIVE_EVERY = 1.0
"""Time without an event after which a browser gets a word, s. A page to which none comes for long says so."""
DRAWN_EVERY = 0.5
"""Time between two pictures, s."""
FAREWELL = 0.3
"""Time that browsers have to go after they were told that it has ended, s."""
OF_TEXTS = ("m", "N", "rad/s")
"""Units of numbers that the page says in a sentence."""
TALKER = "uvicorn.error"
"""Logger of the server's warnings."""
STARTS_WITHIN = 10.0
"""How long the server may take to start, s."""


class Page:
    """A page that shows a twin.

    Parameters
    ----------
    port : int
        0 for a free one; the one taken is in ``port``.
    title : str
    units : mapping
        Name -> unit of what lines hold.
    application : Application
        Says what the machine looks like.
    host : str
        Address that is listened at, or name of this computer; by default nobody can see it from another one.
    system : str
        The scene's ``units``, in which the page shows numbers, by the rule of the printed tables.
    names : collection of str
        Further names under which it is asked for, such as that of a reverse proxy.
    mark : str
        Of the twin, the same where it goes on in another process: an open page keeps what it shows then. Without one
        this is a twin that no page has seen.

    Raises
    ------
    SceneError
        Where the port is taken, for a host that is not this computer, and where what serves pages is not installed.
    """

    def __init__(
        self, port: int, title: str, units: Mapping[str, str], application: Any, host: str = "127.0.0.1",
        system: str = "si", names: Collection[str] = (), mark: str = "",
    ) -> None:  # fmt: skip
        try:
            import uvicorn
        except ImportError:
            cure = "pip install 'tautline[live]'"
            raise option_error("--serve", str(port), "needs starlette and uvicorn", cure) from None
        known = sorted({*units.values(), *OF_TEXTS})
        self._files = {path: ((HERE / name).read_bytes(), kind) for path, (name, kind) in FILES.items()}
        about = {
            "twin": mark or secrets.token_hex(8),
            "program": _hash(content for content, _ in self._files.values()),
            "title": title,
            "units": dict(units),
            "scales": {unit: scales(unit, system) for unit in known},
            "zeros": {unit: scale_of_zero(unit, system) for unit in known},
        }
        self._about = json.dumps(about)
        self.host, self._names, self._socket = plain(host), names, bound(host, port)
        self.port = int(self._socket.getsockname()[1])
        self._picture = Picture(application)
        self._lines: deque[str] = deque(maxlen=LATEST)
        self._trouble = ""
        self._drawn: dict[str, str] = {}  # the last shape and the picture of it
        self._watching: set[Waiting] = set()
        self._newest: tuple[Any, np.ndarray] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        # Neither logging nor signals of the process are touched, but for `_without_warnings`.
        config = uvicorn.Config(self._app(), log_config=None, access_log=False, lifespan="off", loop="asyncio",
                                timeout_graceful_shutdown=1)  # fmt: skip
        self._server = uvicorn.Server(config)
        self._up = threading.Event()
        self._thread = threading.Thread(target=self._run, name="page of the twin", daemon=True)
        self._thread.start()
        self._up.wait(STARTS_WITHIN)

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return self.addresses[0]

    @property
    def addresses(self) -> list[str]:
        """All of these, where it is shown to other computers too."""
        return addresses_of(self.host, self.port)

    def publish(self, line: Mapping[str, Any], model: Any = None, row: np.ndarray | None = None) -> None:
        """Hand a line over, and the frame that it belongs to; returns at once.

        Parameters
        ----------
        line : mapping
            As the twin tells it; what is not finite is None. Browsers get its stamps in words, too (``stamp``).
        model, row : Model, (width,) array
            Of the simulation and its frame, which is copied.
        """
        alarms = [{**one, "stamp": stamp_said(one["since"])} for one in line["alarms"]]
        text = json.dumps({**line, "alarms": alarms, "stamp": stamp_said(line["time"])}, allow_nan=False)
        if model is not None and row is not None:
            self._newest = model, row.copy()
        self._call(self._take, text)

    def tell(self, trouble: str) -> None:
        """Say why no line comes, until one does; returns at once."""
        self._call(self._fall_silent, json.dumps({"text": trouble}))

    def _call(self, what: Callable[[str], None], text: str) -> None:
        """Let the server's thread do something; nothing where it has ended, or never began."""
        if self._loop is not None:
            with suppress(RuntimeError):
                self._loop.call_soon_threadsafe(what, text)

    def close(self, reason: str = "the twin was stopped") -> None:
        """End the server; browsers are told why."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._send, "ended", json.dumps({"text": reason}))
            self._loop.call_soon_threadsafe(self._loop.call_later, FAREWELL, self._hang_up)
        else:
            self._server.should_exit = True
        self._thread.join(5.0)
        self._socket.close()

    # -- in the server's thread ----------------------------------------------------------------------------------------

    def _run(self) -> None:
        async def serve() -> None:
            self._loop = asyncio.get_running_loop()
            drawing = asyncio.create_task(self._draw())
            self._up.set()
            await self._server.serve(sockets=[self._socket])
            drawing.cancel()

        with _without_warnings():
            asyncio.run(serve())

    def _take(self, text: str) -> None:
        """Keep a line, and give it to all who look."""
        self._lines.append(text)
        self._trouble = ""
        self._send("line", text)

    def _fall_silent(self, text: str) -> None:
        """Keep why no line comes, and tell all who look."""
        self._trouble = text
        self._send("silent", text)

    def _send(self, kind: str, text: str) -> None:
        """Give every browser an event."""
        for waiting in self._watching:
            waiting.put(kind, text)

    def _hang_up(self) -> None:
        """End the server; who has not gone by itself is cut off, for uvicorn logs each of those as an error."""
        for one in list(self._server.server_state.connections):
            if one.transport is not None:
                one.transport.abort()
        self._server.should_exit = True

    async def _draw(self) -> None:
        """Draw the newest frame again and again, while somebody looks."""
        loop, drawn, number, shape = asyncio.get_running_loop(), None, 0, ""
        while True:
            await asyncio.sleep(DRAWN_EVERY)
            newest = self._newest
            if not self._watching or newest is None or newest is drawn:
                continue
            drawn = newest
            picture = await loop.run_in_executor(None, self._picture.of, *newest)
            if picture["number"] != number:
                number, shape = picture["number"], json.dumps(self._picture.shape)
                self._send("shape", shape)
            self._drawn = {"shape": shape, "picture": json.dumps(picture)}
            self._send("picture", self._drawn["picture"])

    async def _events(self) -> AsyncIterator[str]:
        """What one browser gets: all that is known, and then what comes."""
        waiting = Waiting(WAITING)
        # Both at once, before anything is waited for: what comes from here on waits, and is only there.
        self._watching.add(waiting)
        begin = [("about", self._about), ("lines", "[" + ",".join(self._lines) + "]")]
        begin += [("silent", self._trouble)] if self._trouble else []
        begin += self._drawn.items()
        try:
            for kind, text in begin:
                yield _event(kind, text)
            while not (self._server.should_exit and waiting.empty):
                try:
                    kind, text = await waiting.next(ALIVE_EVERY)
                except TimeoutError:
                    # A word now and then tells the browser that the server lives, and the server that the browser does.
                    yield _event("alive", "{}")
                    continue
                yield _event(kind, text)
                if kind == "ended":
                    break
        finally:
            self._watching.discard(waiting)

    def _app(self) -> Any:
        from starlette.applications import Starlette
        from starlette.middleware import Middleware
        from starlette.responses import Response, StreamingResponse
        from starlette.routing import Route

        async def events(_request: Any) -> StreamingResponse:
            # A proxy that gathers events would give them late, or never.
            headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
            return StreamingResponse(self._events(), media_type="text/event-stream", headers=headers)

        async def file(request: Any) -> Response:
            content, kind = self._files[request.url.path]
            # Nothing but what comes from here is run or asked for.
            rules = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:"
            headers = {"Content-Security-Policy": rules, "Cache-Control": "no-store"}
            return Response(content, media_type=kind, headers=headers)

        routes = [*(Route(path, file) for path in FILES), Route("/events", events)]
        known = Middleware(KnownHosts, host=self.host, names=self._names)
        return Starlette(routes=routes, middleware=[known])


@contextmanager
def _without_warnings() -> Iterator[None]:
    """Keep warnings of the server in this thread off standard error, such as that a request is no HTTP.

    Whoever reaches the port could write there otherwise, among the alarms. Other servers in the process are not
    touched, and where the process has a handler for the logger it still gets everything.
    """
    logger, thread = logging.getLogger(TALKER), threading.get_ident()

    def passes(record: logging.LogRecord) -> bool:
        return record.thread != thread or record.levelno > logging.WARNING or logger.hasHandlers()

    logger.addFilter(passes)
    try:
        yield
    finally:
        logger.removeFilter(passes)


def _hash(contents: Iterable[bytes]) -> str:
    """Tells one version of the page's files from another."""
    found = hashlib.sha256()
    for content in contents:
        found.update(content)
    return found.hexdigest()[:16]


def _event(kind: str, text: str) -> str:
    return f"event: {kind}\ndata: {text}\n\n"
