"""Strokes of the block that move a stuck bit, from two equilibria.

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

from typing import NamedTuple

import numpy as np

from drillstring.statics.statics import Profile


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
