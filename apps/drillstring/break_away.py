"""When a stuck bit lets go: in a run, from its frames; and beforehand, from the statics.

Friction holds the bit until the top has stretched the string so far that all of it is mobilised. Two equilibria with
the bit at one place and friction in two directions differ by the stroke of the block that leads from one to the other:
``u = int dT/EA ds``, and in a curved hole what the string gains or loses in length by passing from one side to the
other. In a straight hole with friction q per length it is q L^2/(2 EA) from rest, where no friction acts yet, and twice
that after the string slid the other way.

Which factor holds the bit? What slips is held by kinetic friction, and slip comes down the string from the top; so
static friction acts on one place at a time, and where it is larger than the kinetic the bit goes soon after the stroke
of the *kinetic* factor: the more damping, the closer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from drillstring.statics import Profile

MOVED = 1.0e-5
"""Way of the bit, m, from which it has moved: a stuck one creeps by less than a tenth of it, elastically."""
AT_REST = 1.0e-8
"""Speed, m/s, and rotary speed, rad/s, below which an end of the string is at rest at the start."""
ON_BOTTOM = "weight_on_bit"
"""Variable of a result in which the bit drills."""
TURNED = 1.0e-3
"""Turn of the bit, rad, from which friction is around the pipe, not along the hole."""


class BreakAway(NamedTuple):
    """Strokes of the block that move the bit, m, positive: up and down from rest, and either way after the other one.

    At rest no friction acts along the hole, as after the string was turned off bottom. NaN where a direction has no
    equilibrium.
    """

    pick_up: float
    slack_off: float
    reversing: float


def break_away(free: Profile, profiles: dict[str, Profile]) -> BreakAway:
    """Strokes between the string without friction and with all of it, at the same place of the bit.

    Parameters
    ----------
    free : Profile
        Of no friction.
    profiles : dict of str to Profile
        ``pick_up`` and ``slack_off``, as far as they were found.
    """
    up, down = (profiles[way].block if way in profiles else np.nan for way in ("pick_up", "slack_off"))
    return BreakAway(free.block - up, down - free.block, down - up)


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
    return {
        "break_away_stroke": (block[last] - block[0], "m", "bit moves off: stroke of the block, down"),
        "break_away_hook_load": (result["hook_load"][last], "N", "bit moves off: hook load"),
        "break_away_time": (result.time[last], "s", "bit moves off: time"),
    }
