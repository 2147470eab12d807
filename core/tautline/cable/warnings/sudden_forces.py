"""Forces along a rope without damping that begin or end at once: the mesh lets their front ring."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tautline.cable.input.geometry import chord
from tautline.cable.input.material import element_lengths
from tautline.cable.input.parts import CableScene, Element, Node, Place
from tautline.cable.input.syntax.nodal import item_of
from tautline.cable.model.magnitudes import given_force
from tautline.scene.warnings import warning

SMALL = 0.1
"""Share of the other forces up to which one that begins at once is not told: its ringing, about half of it, is then
some 5 % of the whole."""
FEW = 4
"""Elements below which a scene is one of springs and masses, in which nobody looks for the front of a wave."""
SHARP = 0.5
"""Length, over that of an element, of a front that has run along all rope, from which on the mesh follows it. A bar of
20 cubic elements without damping has 21 to 27 % too much behind its front, and 0.1 % where that is 0.6 of one."""


class _Along(NamedTuple):
    """An element at a node: its length, m, the direction out of it at that node, and its pull as it is drawn, N."""

    element: Element
    length: float
    outwards: np.ndarray
    pull: float


@warning("cable")
def _sudden(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Of each item the first node at which a rope takes a good part of its force along itself."""
    if not scene.forces or len(scene.elements) < FEW:
        return
    nodes = {node.id: node for node in scene.nodes}
    beside = _beside(scene, nodes)
    masses: dict[int, float] = defaultdict(float)
    for part in scene.nodal:
        for node in part.nodes:
            masses[node] += item_of(part).mass(part)
    total, given = float(element_lengths(scene).sum()), given_force(scene)
    for part in scene.forces:
        force, (first, last) = np.array(part.model.force, float), part.model.interval
        begins = first < scene.solver.end and (first > 0.0 or scene.solver.start == "as given")
        if not begins and not first < last < scene.solver.end:
            continue
        others = given - float(np.linalg.norm(force)) * len(part.nodes)
        for node in part.nodes:
            # A rope that is drawn stretched may bear the force from the start on.
            borne = sum((one.pull * one.outwards for one in beside[node]), np.zeros(3))
            jump = force - borne if begins and first <= 0.0 else force
            found = _ringing(np.where(nodes[node].held[:3], 0.0, jump), beside[node], masses[node], total, others)
            if found is not None:
                yield (*part.place, "force"), _text("begins" if begins else "ends", node, found, total)
                break


def _beside(scene: CableScene, nodes: dict[int, Node]) -> dict[int, list[_Along]]:
    """Elements with mass at the nodes that have a force."""
    pushed = {node for part in scene.forces for node in part.nodes}
    found: dict[int, list[_Along]] = defaultdict(list)
    for element, length in zip(scene.elements, element_lengths(scene).tolist(), strict=True):
        if pushed.isdisjoint(element.nodes) or element.rhoA == 0.0 or not length > 0.0:
            continue
        a, b = element.nodes
        for node, other in ((a, b), (b, a)):
            away = np.array(chord(nodes[other].position, nodes[node].position))
            distance = float(np.linalg.norm(away))
            if node in pushed and distance > 0.0:
                pull = element.EA * (distance / length - 1.0)
                found[node].append(_Along(element, length, away / distance, pull))
    return found


def _ringing(jump: np.ndarray, beside: list[_Along], mass: float, total: float, others: float) -> _Along | None:
    """The element along which a jump of force, N, sends a front that is too sharp for the mesh."""
    for one in beside:
        # A body at the node lets the force into the rope within the time mass / (rhoA a): a front as long as this.
        longest = max(math.sqrt(one.element.damping * total * _speed(one)), mass / one.element.rhoA)
        if longest < SHARP * one.length and abs(float(jump @ one.outwards)) > SMALL * max(others, abs(one.pull)):
            return one
    return None


def _speed(one: _Along) -> float:
    """Of waves along the element, m/s."""
    return math.sqrt(one.element.EA / one.element.rhoA)


def _text(does: str, node: int, found: _Along, total: float) -> str:
    # With this the front is as long as an element once it has run along all rope.
    enough = found.length**2 / (total * _speed(found))
    return (
        f"{does} at once at node {node}, along element {found.element.id}, whose damping is too small for its length. "
        "A wave with a sharp front runs along the rope. Behind such a front the computed force rings: the largest "
        "force may be too large by about 25 %. More elements or shorter steps alone do not help. Give the rope "
        f"damping, such as cDamp: {enough:.2g}, or let the force grow in several steps, each a PointForce with its "
        "timeInterval"
    )
