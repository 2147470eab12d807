"""What only just touches or is taut, or is about to: it acts otherwise one way than the other, and a plant has one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tautline.integrators.state import State
from tautline.kernels.groups import Edge, known_of
from tautline.kernels.jit import in_python
from tautline.live.plant.stuck import NAMED
from tautline.system.system import System

GRAVITY = 9.81
LIGHT = 0.1
"""Share of the weight of what touches up to which it is not carried by that. What rests on something stiff is pressed
in by less than any motion; a small one does not lift it all the same."""


class Near(NamedTuple):
    """What is at an edge, with the name of what it belongs to."""

    name: str
    edge: Edge

    @property
    def told(self) -> str:
        """What it is, how far it is from the other side, and what that would be."""
        one = self.edge
        stiffness = f"{one.stiffness:.3g} N/m"
        if one.acts:
            here = f"{self.name} {one.held} by {one.gap:.3g} m, with {one.stiffness * one.gap:.3g} N"
            return f"{here}. The linear model has it held with {stiffness}; further back nothing holds it"
        here = f"{self.name} {one.free} by {one.gap:.3g} m"
        return f"{here}. The linear model has it free; beyond that it is held with {stiffness}"


def what_is_near(system: System, state: State, mass_at: Callable[[Sequence[int]], float], small: float) -> list[Near]:
    """What is within ``small`` m of an edge in a system whose residual was asked for.

    Parameters
    ----------
    system : System
    state : State
        Its full positions and velocities.
    mass_at : callable
        Some full places -> mass, kg, that moves with them.
    small : float
        m.
    """
    kinds = [(edges, g) for g in system.groups if (edges := known_of(g).edges)]
    with in_python():
        found = [one for edges, g in kinds for one in edges(g, state.full_q, state.full_v)]
    near = [one for one in found if is_near(one, mass_at, small)]
    return [Near(one.name or system.places[one.places[0]].rpartition(": ")[0], one) for one in near]


def is_near(one: Edge, mass_at: Callable[[Sequence[int]], float], small: float) -> bool:
    """Whether one is within ``small`` m, something brings it there, and it does not rest with a good part of that."""
    if one.gap > small or one.share == 0.0:
        return False
    return not one.acts or one.stiffness * one.gap <= LIGHT * GRAVITY * one.share * mass_at(one.places)


def near_said(found: Sequence[Near]) -> list[str]:
    """One warning of all that is at an edge, the nearest first, with the ways out; none where nothing is."""
    if not found:
        return []
    some = ". ".join(one.told for one in sorted(found, key=lambda near: near.edge.gap)[:NAMED])
    more = len(found) - NAMED
    rest = f". {more} more are so near: plant.near lists them" if more > 0 else ""
    ways = "Advance the simulation until it is clear or rests, or displace it by more"
    return [f"the linear model is right one way only. {some}{rest}. {ways}"]
