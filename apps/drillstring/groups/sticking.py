"""Which contacts of a string with the wall stick where it is only looked at, by each law of friction."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillstring.groups.friction import SLIP, STICK, Karnopp, Projection
from tautline.kernels.groups import Edge, Stuck

CURE = "set the parameter wall.friction to 0"


def stuck_on_the_wall(law: Any, springs: np.recarray, places: np.ndarray) -> list[Stuck]:
    """Contacts that stick, with the friction up to which they do.

    By `Karnopp` what is held is pushed by a constant force, and moves in a linear model as if nothing held it. What the
    regularised law holds creeps, and no law but these two sticks.

    Parameters
    ----------
    law : Projection, Karnopp, Regularised or Sliding
        The law of friction, with its rows.
    springs : recarray (n,)
        Contacts, with the normal force ``normal`` N of the last accepted step.
    places : int (n,)
        Full place of a degree of freedom of each contact.
    """
    if isinstance(law, Projection):
        held, text = (
            law.rows.settled == STICK,
            "friction holds it on the wall until all other forces together push it by more",
        )
    elif isinstance(law, Karnopp):
        held, text = law.rows.held == 1, "karnopp's friction holds it on the wall in a run, and not here, up to no more"
    else:
        return []
    normal = springs.normal
    chosen = np.flatnonzero(held & (normal > 0.0) & (law.rows.static > 0.0))
    return [Stuck(int(places[i]), text, float(law.rows.static[i] * normal[i]), "N", CURE) for i in chosen]


def edge_of_the_wall(place: int, spring: Any, offset: float, rate: float) -> Edge:
    """How far a contact is from where its normal force, k pen + d pen_rate, is nothing.

    Parameters
    ----------
    place : int
        Full place of a degree of freedom of what touches.
    spring : record
        The contact.
    offset, rate : float
        Offset from the hole's axis, m, and its rate, m/s.
    """
    pressed = float(offset - spring.clearance + spring.damping / spring.stiffness * rate)
    return Edge((place,), pressed > 0.0, abs(pressed), float(spring.stiffness), HELD, FREE)


HELD, FREE = "is pressed into the wall of the hole", "is clear of the wall of the hole"


def let_go_without_friction(law: Any) -> None:
    """Let contacts go whose friction has been set to nothing since the last step: none will be made that would."""
    if isinstance(law, Projection):
        free = law.rows.static == 0.0
        law.rows.settled[free] = law.rows.status[free] = SLIP
        law.rows.factor[free] = 0.0
