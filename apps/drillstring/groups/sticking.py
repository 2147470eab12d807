"""Which contacts of a string with the wall stick where it is only looked at, by each law of friction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from drillstring.groups.friction import SLIP, STICK, Karnopp, Projection
from tautline.kernels.groups import Edge, Stuck

CURE = "set the parameter wall.friction to 0"


def stuck_on_the_wall(
    law: Any, springs: np.recarray, places: np.ndarray, name_of: Callable[[int], str] = lambda i: ""
) -> list[Stuck]:
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
    name_of : callable
        Name of the contact of a number, where the place's is another's.
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
    return [
        Stuck(int(places[i]), text, float(law.rows.static[i] * normal[i]), "N", CURE, name=name_of(int(i)))
        for i in chosen
    ]


def edge_of_the_wall(place: int, spring: Any, offset: float, rate: float, down: float, name: str = "") -> Edge:
    """How far a contact is from where its normal force, k pen + d pen_rate, is nothing.

    Parameters
    ----------
    place : int
        Full place of a degree of freedom of what touches.
    spring : record
        The contact.
    offset, rate : float
        Offset from the hole's axis, m, and its rate, m/s.
    down : float
        Component of the downward unit vector from the hole's axis to the contact.
    name : str
        Of what touches, where the place's is another's.
    """
    pressed = float(offset - spring.clearance + spring.damping / spring.stiffness * rate)
    share = _leaves(rate, down) if pressed > 0.0 else _meets(rate, down)
    return Edge((place,), pressed > 0.0, abs(pressed), float(spring.stiffness), HELD, FREE, share, name)


def _leaves(rate: float, down: float) -> float:
    """Share of the weight with which what touches may lift off. A string that lies still has many light contacts,
    where its tension in a bend lifts it, and rests at all of them."""
    return abs(float(down)) if abs(rate) > STILL and abs(down) > UPRIGHT else 0.0


def _meets(rate: float, down: float) -> float:
    """Share of the weight with which what is clear is pressed to the wall, or 1 where it moves towards it."""
    if rate > STILL:
        return 1.0
    return float(down) if down > UPRIGHT else 0.0


STILL = 1.0e-6
"""Speed across the hole, m/s, below which a string lies still: it goes 1e-5 m in 10 s."""
UPRIGHT = 1.0e-3
"""Share of the weight across a hole below which that hole is vertical: its weight presses a string to no side."""
HELD, FREE = "is pressed into the wall of the hole", "is clear of the wall of the hole"


def let_go_without_friction(law: Any) -> None:
    """Let contacts go whose friction has been set to nothing since the last step: none will be made that would."""
    if isinstance(law, Projection):
        free = law.rows.static == 0.0
        law.rows.settled[free] = law.rows.status[free] = SLIP
        law.rows.factor[free] = 0.0
