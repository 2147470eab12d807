"""Addresses of brokers and servers, and what the user is told of connections to them and of rows that stop coming."""

from __future__ import annotations

import errno
import socket
import ssl
import time as clock
from collections import deque
from collections.abc import Callable
from urllib.parse import SplitResult, urlsplit

import numpy as np

from tautline.scene.errors import option_error, shorten

LARGEST_PORT = 65535
PATIENCE = 5.0
"""After how long without any answer this is told, s."""
USUAL = 2.5
"""Usual time between rows for which none may come before this is told."""
NOTICED, PAUSES, FEW = 1.0, 20, 3
"""Shortest pause that is kept, s; how many of the last are; and how many tell what is usual of rows in bursts."""
ANOTHER = 1.5
"""Pauses between rows that cannot be used, within which another one is expected."""
REFUSED = "the connection is refused"


def split_address(text: str, written: str, example: str) -> SplitResult:
    """Parts of an address, of which the port can be used.

    Parameters
    ----------
    text : str
        The address, with what a URL cannot have escaped.
    written : str
        The address as the user wrote it.
    example : str
        A good one, for the cure.

    Raises
    ------
    SceneError
        For a port that is none, and for what is no address.
    """
    try:
        parts = urlsplit(text)
    except ValueError:
        raise option_error("--source", written, "is no address", f"write it as in {example}") from None
    try:
        good = parts.port is None or parts.port > 0
    except ValueError:
        good = False
    if not good:
        cause = f"has no port that can be: a port is a whole number from 1 to {LARGEST_PORT}"
        raise option_error("--source", written, cause, f"write it as in {example}, or leave the port out")
    return parts


class Notice(str):
    """A sentence on a connection, and in a word how it is: ``connected``, ``lost``, ``silent`` or ``heard``."""

    status: str

    def __new__(cls, text: str, status: str) -> Notice:
        """The sentence, with its word."""
        made = super().__new__(cls, text)
        made.status = status
        return made


class Connection:
    """Tells once that an address is waited for, once that it answers, and once that the connection was lost.

    Attempts go on all the while. A cause is told again only after the address has answered.

    Parameters
    ----------
    address : str
        Of the broker or the server.
    notes : list of str
        Where the sentences go.
    now : callable
        The clock, s.
    """

    def __init__(self, address: str, notes: list[str], now: Callable[[], float] = clock.monotonic) -> None:
        self._name, self._notes, self._now = without_password(address), notes, now
        self._begun = now()
        self._told: set[str] = set()
        self._there = self._was_there = False

    def failed(self, cause: str, answered: bool = False) -> None:
        """Take notice of an attempt that failed; `answered` where the other side itself said no."""
        # After a loss nothing else is to be expected than that nobody answers, and the loss was told.
        if cause in self._told or (self._was_there and not answered):
            return
        self._told.add(cause)
        self._notes.append(f"no data from {self._name} yet: {cause}; tautline tries again until it is connected")

    def made(self) -> None:
        """Take notice that the other side has answered."""
        if not self._there:
            self._notes.append(Notice(f"connected to {self._name}", "connected"))
        self._there = self._was_there = True
        self._told.clear()

    def lost(self, cause: str = "") -> None:
        """Take notice that the connection is no more; nothing is told where there was none."""
        if self._there:
            because = f": {cause}" if cause else ""
            text = f"the connection to {self._name} was lost{because}; tautline tries again until it is back"
            self._notes.append(Notice(text, "lost"))
        self._there = False

    def watch(self) -> None:
        """Tell where there was no answer for long, not even that the connection is refused."""
        if not (self._was_there or self._told) and self._now() - self._begun > PATIENCE:
            self.failed(f"no answer for {PATIENCE:g} s")


class Silence:
    """Tells once that rows of use have stopped coming, and once that they come again, by this computer's clock.

    A logger that hangs, or a publisher that has died behind a broker that lives, breaks no connection: what was told of
    the last row would stand as if it were of now. So it would where rows come on whose stamps are empty or stand still.

    Parameters
    ----------
    name : str
        Of the source.
    patience : float
        For how long none may come before this is told, s, where rows are not so far apart anyway.
    now : callable
        The clock, s.
    """

    def __init__(self, name: str, patience: float, now: Callable[[], float] = clock.monotonic) -> None:
        self._name, self._patience, self._now = without_password(name), patience, now
        self._heard, self._pauses, self._told = now(), deque[float](maxlen=PAUSES), False
        self._begun = False
        self._useless, self._useless_at, self._between = 0, -np.inf, 0.0

    def heard(self, passed: float) -> list[Notice]:
        """Take notice of a row that can be used, `passed` s after the last one; what is to be told of it."""
        if self._begun and passed > NOTICED:
            self._pauses.append(passed)
        told, self._told, self._begun, self._heard = self._told, False, True, self._now()
        return [Notice(f"{self._name}: rows come again, after {passed:.0f} s", "heard")] if told else []

    def rested(self) -> None:
        """Take notice that the twin was busy with a row, and did not listen."""
        self._heard = self._now()

    def useless(self, count: int) -> None:
        """Take notice of how many rows, lines and messages have come by now that cannot be used."""
        if count > self._useless:
            now = self._now()
            # The pause between the last two, where they came one behind the other, and not the last after hours.
            pause = now - self._useless_at
            self._between = pause if pause <= self._patience else 0.0
            self._useless_at = now
        self._useless = count

    def watch(self, interval: float, why: str = "", wait: float = 0.0) -> list[Notice]:
        """What is to be told as no row of use comes now, of a source of rows `interval` s apart by their stamps.

        `interval` is NaN where it is not known; `why` says what those rows are that have come, where some did, and
        `wait` for how long those that come may be of use yet, s.
        """
        come = bool(why) and self._comes(interval)
        wait = float(np.nan_to_num(wait)) if come else 0.0
        if self._told or self.seconds <= max(self._patience, self._usual(interval), wait):
            return []
        self._told = True
        if come:
            what = f"rows come, but for {self.seconds:.0f} s none of them can be used: {why}"
        else:
            before = f"; before that came {why}" if why else ""
            what = f"no row has come for {self._without_any:.0f} s{before}"
        last = "What is shown is of the last row that was used" if why else "What is shown is of the last row"
        last = last if self._begun else "Nothing is known of the machine yet"
        text = f"{self._name}: {what}. {last}, and no alarm can come before the next"
        return [Notice(text, "silent")]

    def in_short(self, interval: float, why: str = "") -> str:
        """What a page shows while it lasts: as told by `watch`, but of now."""
        if why and self._comes(interval):
            return f"no rows that can be used ({why}) for {self.seconds:.0f} s"
        return f"no rows for {self._without_any:.0f} s"

    def _usual(self, interval: float) -> float:
        """For how long no row comes at times though the source lives, s."""
        usual = USUAL * float(np.nan_to_num(interval))
        if len(self._pauses) >= FEW:
            usual = max(usual, USUAL * float(np.median(self._pauses)))
        return usual

    def _comes(self, interval: float) -> bool:
        """Whether rows that cannot be used come now, and not only came since the last one that could be."""
        return self._now() - self._useless_at <= max(NOTICED, self._usual(interval), ANOTHER * self._between)

    @property
    def _without_any(self) -> float:
        """Since the last row, also one that could not be used, s."""
        return min(self.seconds, self._now() - self._useless_at)

    @property
    def lasts(self) -> bool:
        """Whether it was told that no rows come, and none that can be used has come since."""
        return self._told

    @property
    def seconds(self) -> float:
        """Since the last row that could be used, s."""
        return self._now() - self._heard


def without_password(address: str) -> str:
    """An address as it may be printed."""
    parts = urlsplit(address)
    user, at, host = parts.netloc.rpartition("@")
    hidden = f"{user.partition(':')[0]}@{host}" if at else host
    return address.replace(parts.netloc, hidden, 1)


def cause_of(error: BaseException | None) -> str:
    """Why a connection could not be made, in plain words."""
    if isinstance(error, ConnectionRefusedError) or f"[Errno {errno.ECONNREFUSED}]" in str(error):
        return REFUSED
    if isinstance(error, socket.gaierror):
        return "the name of the host is not known"
    if isinstance(error, ssl.SSLCertVerificationError):
        return f"the certificate of the host is not trusted ({error.verify_message})"
    if isinstance(error, TimeoutError):
        return "no answer in time"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return shorten(str(error)) or type(error).__name__
