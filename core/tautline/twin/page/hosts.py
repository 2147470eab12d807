"""Where the page of a twin is listened for, and under which names of a computer it is given."""

from __future__ import annotations

import errno
import socket
from collections.abc import Collection, Sequence
from typing import Any

from tautline.scene.errors import option_error, shorten

ALL = ("0.0.0.0", "::", "")
"""Addresses at which all computers of the network are answered."""
OWN = ("127.0.0.1", "localhost", "::1")
"""Names of this computer that lead nowhere else."""
MOST_PORT = 65535
EXAMPLE = "write a number such as 8080, or 0.0.0.0:8080"
NO_HOST = "give a name or an address of this computer, or 0.0.0.0 for all of its addresses"


def place_of(text: str) -> tuple[str, int]:
    """Host and port of ``PORT``, ``HOST:PORT`` or ``[ADDRESS]:PORT``; raises SceneError for anything else."""
    if "/" in text:
        plain = text.split("://", 1)[-1].strip("/")
        cure = f"write {plain}" if ":" in plain and "/" not in plain else EXAMPLE
        raise option_error("--serve", text, "is an address of a page, and no port", cure)
    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdecimal()) or int(port) > MOST_PORT:
        raise option_error("--serve", text, "is no port", EXAMPLE)
    return host.removeprefix("[").removesuffix("]") or "127.0.0.1", int(port)


def checked_names(names: Sequence[str], serves: bool) -> tuple[str, ...]:
    """Further names under which the page is asked for; raises SceneError for what is none, or where none is served."""
    for name in names:
        if not serves:
            raise option_error("--serve-name", name, "names a page, and none is shown", "give --serve too")
        if not name or _host_of(name) != name.lower() or "/" in name:
            cure = "write the name alone, without http:// and port, such as twin.example.com"
            raise option_error("--serve-name", name, "is no name of a computer", cure)
    return tuple(names)


def address_of(host: str, port: int) -> str:
    """Where a browser finds a page: at all addresses of this computer, by its name."""
    if host in ALL:
        host = socket.gethostname() or "127.0.0.1"
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def bound(host: str, port: int) -> socket.socket:
    """A socket at a port of this computer, by IPv4 or IPv6; raises SceneError where there can be none."""
    made = None
    try:
        family, kind, _, _, place = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM,
                                                       flags=socket.AI_PASSIVE)[0]  # fmt: skip
        made = socket.socket(family, kind)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(place)
        made.listen()
    except (OSError, UnicodeError, OverflowError) as error:
        if made is not None:
            made.close()
        unknown = isinstance(error, (socket.gaierror, UnicodeError))
        elsewhere = unknown or getattr(error, "errno", None) in (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)
        cause = f"cannot be listened at on {host}: {getattr(error, 'strerror', None) or error}"
        cure = NO_HOST if elsewhere else "give another port, or 0 for a free one"
        raise option_error("--serve", str(port), cause, cure) from None
    return made


class KnownHosts:
    """Answers requests under known names only: a page from elsewhere whose name was made to lead here gets nothing.

    Parameters
    ----------
    app : ASGI application
    host : str
        Address that is listened at. Whoever serves all computers is asked under any name.
    names : collection of str
        Further names, such as that of a reverse proxy.
    """

    def __init__(self, app: Any, host: str, names: Collection[str] = ()) -> None:
        self._app = app
        self._known = None if host in ALL else {one.lower() for one in (*OWN, host, *names)}

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Give a request on, or say how the page is shown under its name."""
        from starlette.datastructures import Headers
        from starlette.responses import PlainTextResponse

        name = _host_of(Headers(scope=scope).get("host", ""))
        if self._known is None or name in self._known:
            await self._app(scope, receive, send)
            return
        text = (
            f"This page is not shown under the name '{shorten(name)}'.\n"
            f"Start the twin with --serve-name NAME beside --serve, or let the proxy send the header Host: localhost.\n"
        )
        await PlainTextResponse(text, status_code=400)(scope, receive, send)


def _host_of(header: str) -> str:
    """The name of a header ``Host``, without its port, in small letters."""
    if header.startswith("["):
        return header[1:].partition("]")[0].lower()
    host, _, port = header.rpartition(":")
    return (host if host and port.isdecimal() else header).lower()
