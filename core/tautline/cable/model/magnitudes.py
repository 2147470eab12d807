"""What counts as large in a scene: its mass, its forces, its coordinates, and the stiffness of springs that tie it."""

from __future__ import annotations

import math
from math import sqrt
from typing import Any

import numpy as np

from tautline.cable.input.geometry import drawn_of
from tautline.cable.input.material import element_lengths, material_coordinates
from tautline.cable.input.parts import CableScene, Tie
from tautline.cable.input.syntax.nodal import item_of
from tautline.integrators.state import WORST
from tautline.integrators.status import Status
from tautline.scene.model import MADE
from tautline.system.system import System

STIFF_SHARE = 1.0e-4
"""Share of the largest axial stiffness that counts as a large force."""
TOO_STIFF, ENOUGH = 1.0e8, 1.0e7
"""EA over the force that acts: from the first on it may hide beside stretch and rounding; at the second the stretch is
1e-7, and six digits of a shape are those of a rope without any."""
STIFF = 1.0e6
"""Chosen penalty over the stiffest element, at most: a joint gives 1e-6 of the stretch of an element."""
ROUNDED = float(np.finfo(float).eps)
"""Of a coordinate, by which the gap of two nodes is rounded."""
JOINED, ACTING = "shortest elements at nodes", "force that acts"
"""Where a scene keeps them."""


def mass_of(scene: CableScene) -> float:
    """All mass of ropes and of what hangs on nodes, kg; raises what `element_lengths` does."""
    ropes = sum(e.rhoA * length for e, length in zip(scene.elements, _lengths(scene).tolist(), strict=True))
    return ropes + sum(item_of(part).mass(part) * len(part.nodes) for part in scene.nodal)


def given_force(scene: CableScene) -> float:
    """All weight, loads and forces that a scene gives, N."""
    gravity, lengths = float(np.linalg.norm(scene.gravity)), _lengths(scene).tolist()
    loads = sum(math.hypot(*e.load) * length for e, length in zip(scene.elements, lengths, strict=True) if any(e.load))
    forces = sum(item_of(part).force(part) * len(part.nodes) for part in scene.nodal)
    return mass_of(scene) * gravity + loads + forces


def largest_force(scene: CableScene) -> float:
    """Force that counts as large, N: all weight, loads and forces, and a little of the stiffness."""
    axial = max((e.EA for e in scene.elements), default=0.0)
    bending = max((e.EJ for e in scene.elements), default=0.0)
    stiff = max(axial, 1e-3 * bending)
    return given_force(scene) + STIFF_SHARE * stiff or 1.0


def acting_force(scene: CableScene) -> float:
    """Force that a scene at rest has to balance, N: what is given, else that which bends a rope by its own length.

    Stiffness along a rope is no part of it, however large: it carries what acts and makes none of it. The scene keeps
    it: warnings and the builder ask it several times.
    """
    kept = scene.__dict__.setdefault(MADE, {})
    if ACTING not in kept:
        kept[ACTING] = _acting_force(scene)
    return float(kept[ACTING])


def _acting_force(scene: CableScene) -> float:
    gravity, lengths = float(np.linalg.norm(scene.gravity)), _lengths(scene).tolist()
    fluid = sum(e.conveyed[0] * length for e, length in zip(scene.elements, lengths, strict=True) if e.conveyed)
    bending = max((e.EJ for e in scene.elements), default=0.0)
    return given_force(scene) + gravity * fluid or (
        bending / float(_lengths(scene).sum()) ** 2 if bending > 0.0 else 0.0
    )


def too_stiff(scene: CableScene, flow: float = 0.0, thing: str = "rope") -> str:
    """Cause and cure where ropes are too stiff along themselves for sixteen digits; empty where they are not.

    ``flow`` (N) is the thrust of what flows through them, which acts beside what the scene gives. ``thing`` is what
    whoever wrote the scene calls one of them.
    """
    if not outweighs(scene, flow) or stretched(scene, flow):
        return ""
    axial, acts = max(e.EA for e in scene.elements), acting_force(scene) + flow
    return (
        f"the axial stiffness EA = {axial:.3g} N may be too large beside the {acts:.2g} N that act. With sixteen "
        "digits a search for rest or a step may not tell bending from stretch. Give less: where the ends do not "
        f"stretch the {thing}, EA = {ENOUGH * acts:.1g} N gives the same shape to six digits"
    )


def outweighs(scene: CableScene, flow: float = 0.0) -> bool:
    """Whether EA is so far above what acts, and a thrust ``flow`` (N), that rounding of the one may hide the other."""
    axial, acts = max((e.EA for e in scene.elements), default=0.0), acting_force(scene) + flow
    return acts > 0.0 and TOO_STIFF * acts < axial < math.inf


def stretched(scene: CableScene, flow: float = 0.0) -> bool:
    """Whether ropes may carry more than what acts on them: EA then makes tension, and less of it another shape.

    That is so where springs pull, and of ropes held at two places or more where an end is driven or a rope is drawn
    next to as long as its material: what acts across it, and a thrust ``flow`` (N), then stretches it by about
    sqrt(acts / EA). A rope that is held at one place hangs by what acts alone.
    """
    if any(item_of(part).stiffness(part) > 0.0 for part in scene.nodal):
        return True
    if sum(any(node.held[:3]) for node in scene.nodes) < 2:
        return False
    ropes = [i for i, element in enumerate(scene.elements) if element.EA > 0.0]
    ends = {node for i in ropes for node in scene.elements[i].nodes}
    if any(any(node.functions) for node in scene.nodes if node.id in ends):
        return True
    stretch = sqrt((acting_force(scene) + flow) / max(scene.elements[i].EA for i in ropes)) if ropes else 0.0
    # By chords: the ends of slack rope, drawn with slopes of their own, have longer arcs than material.
    return bool((drawn_of(scene).distance > (1.0 - stretch) * _lengths(scene))[ropes].any())


def stiff_along(system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of a step without solution in a system that is `too_stiff`; None of any other.

    What was left in the step that failed is not kept. A long step may fail as well, so both are said.
    """
    if status is not Status.NOT_CONVERGED or not system.softer:
        return None
    return status, int(state.counters[WORST]), f"try a smaller step first; if none helps, {system.softer}"


def stiffest_element(scene: CableScene) -> float:
    """Largest stiffness of an element against the motion of its ends, EA/L or 12 EJ/L^3, N/m."""
    if not scene.elements:
        return 0.0
    axial, bending = np.array([(e.EA, e.EJ) for e in scene.elements]).T
    length = _lengths(scene)
    return float(np.maximum(axial / length, 12.0 * bending / length**3).max())


def rounded_gap(scene: CableScene) -> float:
    """By how much the gap of two tied nodes may be rounded, m: of positions, and of p where p is tied."""
    places = [abs(x) for node in scene.nodes for x in node.position]
    if any(tie.what == 1 for tie in scene.ties):
        places += map(abs, material_coordinates(scene).values())
    return ROUNDED * max(1.0, max(places, default=0.0))


def penalty_stiffness(scene: CableScene) -> float:
    """Penalty stiffness of ties that give none, N/m.

    A spring k beside elements of stiffness K gives K/k of their stretch, and the rounding d of its gap leaves a force
    k d beside forces F. Their sum is least at k = sqrt(K F/d). Where coordinates are small that is more than any joint
    needs, and k is 10^6 K. The square root rule (eq. 2.158) has 10^8 K: rounding then is all that is left of the force.
    """
    stiffest = stiffest_element(scene)
    if not stiffest > 0.0:
        return 1.0
    return min(STIFF * stiffest, sqrt(stiffest * largest_force(scene) / rounded_gap(scene)))


def rounding_error(scene: CableScene) -> float:
    """Error of eq. 2.78 that the rounding of gaps leaves in the springs of ties, the root of their energy in J.

    An iteration cannot bring a gap closer to where it should be than the coordinates of both nodes are rounded.
    """
    sprung = [tie for tie in scene.ties if tie.method != "multiplier"]
    if not sprung:
        return 0.0
    chosen, gap = penalty_stiffness(scene), 2.0 * rounded_gap(scene)
    across = {0: 3.0 * gap**2, 1: gap**2, 2: 3.0 * (2.0 * ROUNDED) ** 2}
    return sqrt(sum(stiffness_of(scene, tie, chosen) * across[tie.what] for tie in sprung))


def stiffness_of(scene: CableScene, tie: Tie, chosen: float) -> float:
    """Stiffness of a tie's springs, N/m (N m for slopes): its own, else ``chosen``, times L^2 for slopes."""
    if tie.stiffness is not None:
        return tie.stiffness
    if tie.what != 2:
        return chosen
    shortest = _shortest(scene)
    return chosen * min((shortest[node] for node in tie.nodes if node in shortest), default=1.0) ** 2


def _shortest(scene: CableScene) -> dict[int, float]:
    """Length of the shortest element at each node, m, by node id; found once for thousands of ties."""
    kept = scene.__dict__.setdefault(MADE, {})
    if JOINED not in kept:
        found: dict[int, float] = {}
        for element, length in zip(scene.elements, _lengths(scene).tolist(), strict=True):
            for node in element.nodes:
                found[node] = min(length, found.get(node, math.inf))
        kept[JOINED] = found
    return kept[JOINED]


def _lengths(scene: CableScene) -> np.ndarray:
    return np.abs(element_lengths(scene))
