"""Arrays of a result that hold no number somewhere (NaN): put there by hand, by another program or an old version."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tautline.results.result import Result

LOOKED_THROUGH = 100_000_000
"""Bytes of a result that is looked through unasked; to read so many takes some tenths of a second."""


def hole_of(result: Result) -> tuple[str, str] | None:
    """The first array along time with a number in some frames and none in others: its name and where.

    The times come first. An array that has no number at a place in any frame has none by what it is.
    """
    frames = len(result["time"])
    named = sorted((name for name, one in result.variables.items() if one.dims[:1] == ("time",)), key="time".__ne__)
    for name in named:
        values = result[name]
        if values.dtype.kind != "f" or frames != values.shape[0]:
            continue
        finite = np.isfinite(values.reshape(frames, -1))
        lost = (~finite & finite.any(axis=0)).any(axis=1)
        if lost.any():
            first = int(lost.argmax())
            time = float(result["time"][first])
            where = f"t = {time:.6g} s" if np.isfinite(time) else f"frame {first + 1}"
            return name, f"{where} first, in {int(lost.sum())} of {frames} frames"
    return None


def hole_told(result: Result) -> str:
    """A sentence on the first hole of a result that is about to be shown; empty where there is none to look for.

    What a twin has found may lack numbers; a large file is not read for this.
    """
    large = result.path is not None and result.path.stat().st_size > LOOKED_THROUGH
    hole = None if large or result.attributes.get("application") == "twin" else hole_of(result)
    return "" if hole is None else f"'{hole[0]}' holds no number (NaN) at {hole[1]}: nothing is shown there"


@contextmanager
def told_of_holes(results: Sequence[Result]) -> Iterator[None]:
    """What is made of results; where that fails and one of them lacks a number, this is told in place of the failure.

    Raises
    ------
    ResultError
        With the file, the array and the first time.
    """
    from tautline.results.errors import ResultError
    from tautline.scene.errors import SceneError

    try:
        # NumPy would speak of what is told below.
        with np.errstate(invalid="ignore"):
            yield
    except (ResultError, SceneError, OSError, ImportError, MemoryError):
        raise
    except Exception as error:
        for result in results:
            if (hole := hole_of(result)) is not None:
                cause = f"'{hole[0]}' holds no number (NaN) at {hole[1]}, and what is asked for cannot be made of that"
                cure = "run the scene again; `plot --what` and `export --csv` show what else is in it"
                raise ResultError(result.path or "result", cause, cure) from error
        raise
