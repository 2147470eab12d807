"""Whether the numba that is installed is one that we know: ours is a subclass of its compiler, which may change."""

from __future__ import annotations

import re
from importlib import metadata

from tautline.kernels.machine.sources import version_of_numba

_NUMBERS = re.compile(r"(\d+)\.(\d+)")


def version_note(installed: str | None = None, requirements: list[str] | None = None) -> str | None:
    """What to tell of a numba outside the range that tautline asks for; None where it is within, or nothing is known.

    pip refuses such a numba unless it is told not to look.
    """
    try:
        installed = installed or version_of_numba()
        wanted = metadata.requires("tautline") if requirements is None else requirements
    except metadata.PackageNotFoundError:
        return None
    asked = next((one for one in wanted or () if re.match(r"numba\b", one)), "")
    lowest, below = (re.search(sign + r"\s*(\d+\.\d+)", asked) for sign in (">=", "<(?!=)"))
    found = _version(installed)
    if found is None or lowest is None or below is None:
        return None
    if (_version(lowest[1]) or found) <= found < (_version(below[1]) or found):
        return None
    return (
        f"numba {installed} is not tested with this version of tautline, which asks for {lowest[1]} to below "
        f"{below[1]}. If compiling fails, set TAUTLINE_PLAIN_NUMBA=1, or run: "
        f"pip install 'numba>={lowest[1]},<{below[1]}'"
    )


def _version(text: str) -> tuple[int, int] | None:
    numbers = _NUMBERS.match(text)
    return (int(numbers[1]), int(numbers[2])) if numbers else None
