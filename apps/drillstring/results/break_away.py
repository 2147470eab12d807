"""When a stuck bit lets go in a run, from its frames; `drillstring.statics.strokes` tells it beforehand."""

from __future__ import annotations

from typing import Any

import numpy as np

MOVED = 1.0e-5
"""Displacement of the bit, m, from which it has moved: a stuck one creeps by less than a tenth of it, elastically."""
AT_REST = 1.0e-8
"""Speed, m/s, and rotary speed, rad/s, below which an end of the string is at rest at the start."""
ON_BOTTOM = "weight_on_bit"
"""Variable of a result in which the bit drills."""
TURNED = 1.0e-3
"""Turn of the bit, rad, from which friction is around the pipe, not along the hole."""


def break_away_figures(result: Any) -> dict[str, tuple[float, str, str]]:
    """Headline figures of a run in which the top moves and the bit, held by friction, follows later.

    The moment is the last frame in which the bit has not moved. There are none where the string starts in motion or
    turns, where no friction acts, where the bit stands on bottom, and where it stays.
    """
    if ON_BOTTOM in result and np.any(result[ON_BOTTOM] != 0.0):
        return {}
    block, bit = result["block_position"], result["bit_depth"]
    starts = (result["axial_velocity"][0], result["rotation_rate"][0])
    if any(np.abs(speed).max() > AT_REST for speed in starts) or not np.ptp(block) > 0.0:
        return {}
    moved = np.flatnonzero(np.abs(bit - bit[0]) > MOVED)
    if not moved.size:
        return {}
    last = int(moved[0]) - 1
    held = np.abs(result["friction_force"][: last + 1]).max() > 0.0
    if not held or np.abs(result["rotation"][: last + 1, -1]).max() > TURNED:
        return {}
    stroke = block[last] - block[0]
    way = "down" if stroke >= 0.0 else "up"
    return {
        # Down is positive. The summary prints a stroke that is told as upwards without its sign.
        "break_away_stroke": (stroke, "m", f"break-away of the bit: stroke of the block, {way}"),
        "break_away_hook_load": (result["hook_load"][last], "N", "break-away of the bit: hook load"),
        "break_away_time": (result.time[last], "s", "break-away of the bit: time"),
    }
