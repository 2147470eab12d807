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
"""Turn of any part of the string, rad, from which friction there is around the pipe, not along the hole."""
BESIDE_FRICTION = 0.1
"""Largest share of what is not friction, inertia above all, in the change of hook load. Of a J-well pulled at 0.05 to
1 m/s with friction 0.02 to 0.3 the stroke is within 8 % of that between two equilibria where friction carries nine
tenths; where it carries six tenths the stroke is up to 67 % longer, and without friction it is the way of the block
until the wave reaches the bit.
"""


def break_away_figures(result: Any) -> dict[str, tuple[float, str, str]]:
    """Headline figures of a run in which the top moves and the bit, held by friction, follows later.

    The moment is the last frame in which the bit has not moved. There are none where the string starts in motion,
    where any part of it has turned before, where friction does not carry the change of hook load, where the bit
    stands on bottom, and where it stays.
    """
    if ON_BOTTOM in result and np.any(result[ON_BOTTOM] != 0.0):
        return {}
    if getattr(result, "start", {}):
        # A part of a run, without its start: the bit may have moved before.
        return {}
    block, bit = result["block_position"], result["bit_depth"]
    starts = (result["axial_velocity"][0], result["rotation_rate"][0])
    if any(np.abs(speed).max() > AT_REST for speed in starts) or not np.ptp(block) > 0.0:
        return {}
    moved = np.flatnonzero(np.abs(bit - bit[0]) > MOVED)
    if not moved.size:
        return {}
    last = int(moved[0]) - 1
    turned = np.abs(result["rotation"][: last + 1] - result["rotation"][0]).max() > TURNED
    if turned or not _held_by_friction(result, last):
        return {}
    stroke = block[last] - block[0]
    way = "down" if stroke >= 0.0 else "up"
    return {
        # Down is positive. The summary prints a stroke that is told as upwards without its sign.
        "break_away_stroke": (stroke, "m", f"break-away of the bit: stroke of the block, {way}"),
        "break_away_hook_load": (result["hook_load"][last], "N", "break-away of the bit: hook load"),
        "break_away_time": (result.time[last], "s", "break-away of the bit: time"),
    }


def _held_by_friction(result: Any, last: int) -> bool:
    """Whether friction carries what the hook load has changed by since the start.

    Along the hole hook load = weight + friction + inertia, with forces on the string positive down the hole.
    """
    friction = result["friction_force"]
    change = result["hook_load"][last] - result["hook_load"][0]
    carried = friction[last].sum() - friction[0].sum()
    return bool(carried != 0.0 and abs(change - carried) <= BESIDE_FRICTION * abs(change))
