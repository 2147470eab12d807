"""Where the page of a twin is listened for, and under which names of a computer it is given."""

from __future__ import annotations

import errno
import ipaddress
import re
import socket
from collections.abc import Collection, Sequence
from typing import Any

from tautline.scene.errors import option_error, shorten

ALL = ("0.0.0.0", "::", "")
"""Addresses at which all computers of the network are answered."""
OWN = ("127.0.0.1", "localhost", "::1")
"""Names of this computer that lead nowhere else."""
NOT_OURS = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)
"""Errors of an address that this computer does not have."""
NAME = re.compile(r"[a-z0-9_-]+(\.[a-z0-9_-]+)*")
"""A name of a computer, in small letters: labels with dots between them (RFC 1123, with the underscore that is met)."""
SHORT = re.compile(r"[0-9.]+")
"""An address of IPv4 in any form: 0 is 0.0.0.0, 127.1 is 127.0.0.1."""
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
        bare = name[1:-1] if name.startswith("[") and name.endswith("]") else name
        if ":" in name:
            good = ":" in plain(bare) and _is_address(bare)
        else:
            good = NAME.fullmatch(_in_ascii(name.lower()).removesuffix(".")) is not None
        if not good:
            cure = "write the name alone, without http:// and port, such as twin.example.com"
            cure = "give each name by itself: a star stands for none" if "*" in name else cure
            raise option_error("--serve-name", name, "is no name of a computer", cure)
    return tuple(_host_of(name) for name in names)


def plain(host: str) -> str:
    """A name in small letters without the dot of the root, or an address in its usual form."""
    host = _in_ascii(host.lower()).removesuffix(".")
    if _is_address(host):
        return str(ipaddress.ip_address(host))
    if SHORT.fullmatch(host):
        try:
            return socket.inet_ntoa(socket.inet_aton(host))
        except OSError:
            return host
    return host


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


def _in_ascii(name: str) -> str:
    """A name as browsers ask for it: letters that ASCII lacks are written by others (RFC 3490)."""
    try:
        return name if name.isascii() else name.encode("idna").decode()
    except UnicodeError:
        return name


def addresses_of(host: str, port: int) -> list[str]:
    """Where browsers find a page: at all addresses of this computer, by its name, and on itself by `localhost`.

    Other computers may know that name while this one does not, so one of the two leads there from everywhere.
    """
    hosts = [host]
    if host in ALL:
        hosts = list(dict.fromkeys([socket.gethostname() or "127.0.0.1", "localhost"]))
    return [f"http://[{one}]:{port}" if ":" in one else f"http://{one}:{port}" for one in hosts]


def bound(host: str, port: int) -> socket.socket:
    """A socket at a port of this computer, by IPv4 or else by IPv6; raises SceneError where there can be none.

    A name may have addresses that this computer lacks: the first counts that it has. A port that is taken at that one
    is refused, or two pages would have one address.
    """
    try:
        flags = socket.AI_PASSIVE
        found = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=flags)
    except (OSError, UnicodeError, OverflowError) as error:
        raise _not_bound(host, port, error) from None
    faults: list[OSError] = []
    for family, kind, _, _, place in sorted(found, key=lambda one: one[0] != socket.AF_INET):
        try:
            return _listening(family, kind, place)
        except OSError as error:
            faults.append(error)
            if error.errno not in NOT_OURS:
                break
    raise _not_bound(host, port, faults[-1])


def _listening(family: int, kind: int, place: Any) -> socket.socket:
    made = socket.socket(family, kind)
    try:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(place)
        made.listen()
    except OSError:
        made.close()
        raise
    return made


def _not_bound(host: str, port: int, error: Exception) -> Exception:
    """Why a host cannot be listened at, and what to write."""
    unknown = isinstance(error, (socket.gaierror, UnicodeError))
    elsewhere = unknown or getattr(error, "errno", None) in NOT_OURS
    cause = f"cannot be listened at on {host}: {getattr(error, 'strerror', None) or error}"
    cure = NO_HOST if elsewhere else "give another port, or 0 for a free one"
    return option_error("--serve", str(port), cause, cure)


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
        self._known = None if host in ALL else {plain(one) for one in (*OWN, host, *names)}

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
    """The name of a header ``Host`` in its plain form, without its port; with what is no port nobody knows it."""
    if header.startswith("["):
        host, _, rest = header[1:].partition("]")
        port = rest.removeprefix(":")
    elif header.count(":") == 1:
        host, _, port = header.partition(":")
    else:
        host, port = header, ""
    return plain(host) if not port or (port.isascii() and port.isdecimal()) else header
