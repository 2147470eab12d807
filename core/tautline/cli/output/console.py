"""Where words go: people read standard error, programs read one JSON object from standard output."""

from __future__ import annotations

import errno
import functools
import json
import math
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from tautline.errors import TautlineWarning
from tautline.whole_file import legible

if TYPE_CHECKING:
    from rich.console import Console

    from tautline.results.errors import WriteError
    from tautline.results.result import Result


@functools.cache
def console(width: int | None = None) -> Console:
    """Return the console on standard error; with a width, the one whose lines are as long as that."""
    from rich.console import Console

    class Lasting(Console):
        """One whose reader may go away, and whose disk may be full: what is computed goes on."""

        def on_broken_pipe(self) -> None:
            self.quiet = True
            _point_at_nothing(sys.stderr)

        def _check_buffer(self) -> None:
            try:
                super()._check_buffer()
            except OSError:
                self.on_broken_pipe()

    # What stands between two colons, as in 60:100:20, is no emoji.
    return Lasting(stderr=True, highlight=False, soft_wrap=width is None, emoji=False, width=width)


def say(text: str, style: str = "") -> None:
    """Print a line for people; brackets in it are just brackets."""
    console().print(legible(text), style=style or None, markup=False)


@contextmanager
def warnings_said() -> Iterator[None]:
    """Print warnings of this package as lines for people; those of others are shown as they were."""
    shown = warnings.showwarning

    def show(message: Any, category: type[Warning], *where: Any, **more: Any) -> None:
        if issubclass(category, TautlineWarning):
            say(f"warning: {message}", "yellow")
        else:
            shown(message, category, *where, **more)

    warnings.showwarning = show
    try:
        yield
    finally:
        warnings.showwarning = shown


def say_missing(result: Result) -> list[dict[str, str]]:
    """Warn of a result that is about to be shown and is not of a whole run, or lacks a number; for ``--json`` too."""
    from tautline.cli.output.holes import hole_told
    from tautline.results.naming import shortfall

    where = str(result.path or "result")
    found = [text for text in (shortfall(result), hole_told(result)) if text]
    for text in found:
        say(f"{where}: {text}", "yellow")
    return [{"where": where, "text": text} for text in found]


def finite(value: Any) -> Any:
    """Replace numbers that are not finite by None, at any depth: JSON knows neither NaN nor infinity."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return value


def print_json(value: dict[str, Any]) -> None:
    """Print the one JSON object of a command."""
    print_text(json.dumps(finite(value), allow_nan=False, default=str) + "\n")


def print_text(text: str) -> None:
    """Write to standard output; a reader that went away is no error.

    Raises
    ------
    WriteError
        If it is closed or cannot be written, as on a full disk.
    """
    try:
        if sys.stdout is None:
            raise OSError(errno.EBADF, "it is closed")
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        abandon_output()
    except OSError as error:
        abandon_output()
        raise unwritable(error) from None


def unwritable(error: OSError) -> WriteError:
    """What a command says of a standard output that cannot be written."""
    from tautline.results.errors import WriteError

    cause = f"cannot be written: {error.strerror}"
    return WriteError("standard output", cause, "point it at a file on a disk with room")


def abandon_output() -> None:
    """Point standard output at nothing, so that the interpreter's last flush cannot fail either."""
    _point_at_nothing(sys.stdout)


def flush_words() -> None:
    """Write what waits for standard output and standard error; what cannot be written is left out.

    The interpreter would end with an exit code of its own, 120, where its last flush fails.
    """
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            _point_at_nothing(stream)


def _point_at_nothing(stream: Any) -> None:
    if stream is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
