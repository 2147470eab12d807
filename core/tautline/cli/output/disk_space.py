"""What a result will take of the disk, told before the run begins where that is more than there is."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from tautline.whole_file import place_of

COPIES = 2
"""Files that a run keeps up in turn: one of them is whole whatever befalls the process."""
WORTH_A_LOOK = 1e8
"""Bytes of the unknowns of all frames from which the frames themselves are looked at."""


def bytes_ahead(model: Any) -> int:
    """Bytes of all frames of a run, of a frame as the scene is drawn; 0 where they are few, or are not kept.

    Parameters
    ----------
    model : Model
        From an application's builder.
    """
    system = getattr(model, "system", None)
    if system is None or getattr(model, "keep", None) is not None:
        return 0
    frames = 1 + round(model.solver.end / model.solver.interval)
    if 8.0 * 4 * system.q.size * frames < WORTH_A_LOOK:
        return 0
    from tautline.integrators.time_loop import new_frames

    drawn = new_frames(1, system.q.size, model.own)
    drawn.q[0] = system.q
    with np.errstate(all="ignore"):  # nothing moves in it yet
        return frames * sum(array.nbytes for array in model.observe(drawn).values())


def room_warning(model: Any, target: Path) -> str | None:
    """Warn where the disk has not the room that a run's result will take; None where it has."""
    needed = COPIES * bytes_ahead(model)
    free = shutil.disk_usage(place_of(target).parent).free
    if needed <= free:
        return None
    each, frames = needed / COPIES, 1 + round(model.solver.end / model.solver.interval)
    return (
        f"{target}: the result will be {size(each)}, {frames} frames of {size(each / frames)}, and as much again while "
        f"it runs; {size(free)} are free there. The run will stop when the disk is full, and keep what it has: take a "
        "longer output.interval, or name another folder with -o"
    )


def size(amount: float) -> str:
    """An amount of bytes in the unit that people read it in."""
    for unit, power in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if amount >= power:
            return f"{amount / power:.3g} {unit}"
    return f"{amount / 1e3:.3g} kB"
