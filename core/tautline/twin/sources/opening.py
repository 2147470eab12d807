"""A source by its address."""

from __future__ import annotations

import io
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from tautline.scene.errors import Problem, SceneError, option_error
from tautline.scene.reading.text import LEGACY
from tautline.twin.sources.record import Source
from tautline.twin.sources.stated_units import Stated

SCHEMES = ("mqtt://", "mqtts://", "opc.tcp://")


def open_source(
    address: str, columns: Sequence[str], *, time: str = "", speed: float | None = None,
    units: Mapping[str, str] | None = None, stated: Stated | None = None,
) -> Source:  # fmt: skip
    """Open a source.

    Parameters
    ----------
    address : str
        A CSV file, or a pipe in its place; ``-`` for standard input; ``mqtt://[user:password@]host[:port]/topic``;
        ``opc.tcp://host[:port]/path``.
    columns : sequence of str
        Those that are wanted.
    time : str
        The column of the stamp, with its unit where that is not seconds, ``time [ms]``; empty for the usual names.
    speed : float or None
        Of the replay of a file, times real time; None for as fast as possible.
    units : mapping, optional
        Units by column that the readings are wanted in. Where the header of a table, a server or a message gives
        another unit of the same quantity, readings are converted.
    stated : dict, optional
        `stated` of the source that an operation goes on from: units that hold until others are stated.

    Raises
    ------
    SceneError
        For an address that leads to nothing, for columns that a file does not have, and for units of another quantity.
    """
    if address == "-":
        from tautline.twin.sources.stream import Stream

        if isinstance(sys.stdin, io.TextIOWrapper):
            # A byte that is no UTF-8 spoils no stream; and lines may end with CR alone, as those of a file may.
            sys.stdin.reconfigure(errors=LEGACY, newline="")
        return Stream(sys.stdin, columns, time, units=units, stated=stated)
    if address.startswith(("mqtt://", "mqtts://")):
        from tautline.twin.sources.mqtt import Mqtt

        return Mqtt(address, columns, time, units, stated)
    if address.startswith("opc.tcp://"):
        from tautline.twin.sources.opc_ua.client import OpcUa

        return OpcUa(address, columns, units)
    if "://" in address:
        raise option_error("--source", address, "is of no known kind", f"known: a file, -, {', '.join(SCHEMES)}")
    path = Path(address)
    if path.exists() and not path.is_file() and not path.is_dir():
        return _of_pipe(path, columns, time, units, stated)
    from tautline.twin.sources.csv_file import CsvFile

    return CsvFile(path, columns, time, speed, units=units)


def _of_pipe(
    path: Path, columns: Sequence[str], time: str, units: Mapping[str, str] | None, stated: Stated | None
) -> Source:
    """A named pipe, or a device: what comes is written meanwhile, and is no file that is replayed.

    Opening it waits until somebody writes there.
    """
    from tautline.twin.sources.stream import Stream

    try:
        file = path.open(encoding="utf-8", errors=LEGACY, newline="")
    except OSError as error:
        cause = f"cannot be read: {error.strerror}"
        raise SceneError([Problem(str(path), None, "", None, cause, "check the name of --source")]) from None
    return Stream(file, columns, time, str(path), units, stated)
