"""Where words go: people read standard error, programs read one JSON object from standard output."""

from __future__ import annotations

import functools
import json
import math
import os
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console


@functools.cache
def console() -> Console:
    """Return the console on standard error."""
    from rich.console import Console

    # What stands between two colons, as in 60:100:20, is no emoji.
    return Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)


def say(text: str, style: str = "") -> None:
    """Print a line for people; brackets in it are just brackets."""
    console().print(text, style=style or None, markup=False)


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
    """Write to standard output; a reader that went away is no error."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        abandon_output()


def abandon_output() -> None:
    """Point standard output at nothing, so that the interpreter's last flush cannot fail either."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
