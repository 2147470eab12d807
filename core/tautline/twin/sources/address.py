"""Addresses of live sources."""

from __future__ import annotations

from urllib.parse import SplitResult, urlsplit

from tautline.scene.errors import option_error

LARGEST_PORT = 65535


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
