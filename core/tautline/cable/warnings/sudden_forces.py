"""Forces along a rope without damping that change at once: the mesh lets their front ring."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from tautline.cable.input.geometry import chord
from tautline.cable.input.material import element_lengths
from tautline.cable.input.parts import CableScene, Element, Node, Place
from tautline.cable.input.syntax.nodal import NodalPart, item_of
from tautline.cable.model.magnitudes import given_force
from tautline.scene.values.printed import in_percent
from tautline.scene.warnings import warning

RINGS = 0.25
"""Share of what a front brings, by which the computed force is too large behind it: 20 to 30 % of any mesh."""
ENDS = 2.0
"""What a front brings where it comes to an end that is held, over the jump of the force that sent it."""
SMALL = 0.05
"""Share of the largest force up to which its ringing is not told."""
FEW = 4
"""Elements below which a scene is one of springs and masses, in which nobody looks for the front of a wave."""
SHARP = 0.5
"""Length, over that of an element, of a front that has run along all rope, from which on the mesh follows it. A bar of
20 cubic elements without damping has 21 to 27 % too much behind its front, and 0.1 % where that is 0.6 of one."""
TOGETHER = 0.25
"""Of the time in which a wave crosses an element: jumps within it are one to the mesh."""
ROUNDED = 1.0e-12
"""Of a run: forces that change over to each other within it do so at one time."""


class _Along(NamedTuple):
    """An element at a node: its length, m, the direction out of it at that node, and its pull as it is drawn, N."""

    element: Element
    length: float
    outwards: np.ndarray
    pull: float


class _Found(NamedTuple):
    """The worst jump at a node: its time, s, its size, N, and its ringing as a share of the largest force."""

    node: int
    along: _Along
    time: float
    jump: float
    share: float


class _Levels(NamedTuple):
    """The forces at a node: times at which they change, s, and their sums before the first and after each, N."""

    times: np.ndarray
    sums: np.ndarray


@warning("cable")
def _sudden(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Of each item the node at which its jump, with all that changes there at that time, rings the most."""
    if not scene.forces or len(scene.elements) < FEW:
        return
    nodes = {node.id: node for node in scene.nodes}
    at: dict[int, list[NodalPart]] = defaultdict(list)
    masses: dict[int, float] = defaultdict(float)
    worst: dict[Place, _Found] = {}
    for part in scene.forces:
        for node in part.nodes:
            at[node].append(part)
    beside, total = _beside(scene, nodes), float(element_lengths(scene).sum())
    for part in scene.nodal:
        for node in part.nodes:
            masses[node] += item_of(part).mass(part)
    for node in at:
        sharp = [one for one in beside[node] if _is_sharp(one, masses[node], total)]
        found = _worst(scene, nodes[node], at[node], sharp, total) if sharp else None
        if found is None:
            continue
        place = max((*_part_in(part, found), part.place) for part in at[node])[-1]
        if place not in worst or found.share > worst[place].share:
            worst[place] = found
    for place, found in worst.items():
        yield (*place, "force"), _text(found, total)


def _beside(scene: CableScene, nodes: dict[int, Node]) -> dict[int, list[_Along]]:
    """Elements along which waves run, at the nodes that have a force."""
    pushed = {node for part in scene.forces for node in part.nodes}
    found: dict[int, list[_Along]] = defaultdict(list)
    for element, length in zip(scene.elements, element_lengths(scene).tolist(), strict=True):
        if pushed.isdisjoint(element.nodes) or not min(element.rhoA, element.EA, length) > 0.0:
            continue
        a, b = element.nodes
        for node, other in ((a, b), (b, a)):
            away = np.array(chord(nodes[other].position, nodes[node].position))
            distance = float(np.linalg.norm(away))
            if node in pushed and distance > 0.0:
                pull = element.EA * (distance / length - 1.0)
                found[node].append(_Along(element, length, away / distance, pull))
    return found


def _is_sharp(one: _Along, mass: float, total: float) -> bool:
    """Whether a jump sends a front along the element that the mesh does not follow."""
    # A body at the node lets the force into the rope within the time mass / (rhoA a): a front as long as this.
    longest = max(math.sqrt(one.element.damping * total * _speed(one)), mass / one.element.rhoA)
    return longest < SHARP * one.length


def _levels(scene: CableScene, node: Node, parts: list[NodalPart], beside: list[_Along]) -> _Levels:
    """Forces at a node by their beginnings and ends, as they move it."""
    given = np.where(node.held[:3], 0.0, np.array([part.model.force for part in parts], float))
    spans = np.array([part.model.interval for part in parts], float)
    rounded = ROUNDED * scene.solver.end
    times = np.unique(spans[spans < scene.solver.end])
    # Of times that differ by rounding the last: forces that hand over to each other leave no gap.
    times = times[np.diff(times, append=math.inf) > rounded]
    acts = (spans[:, 0] <= times[:, None] + rounded) & (times[:, None] + rounded < spans[:, 1])
    after, before = acts @ given, np.zeros(3)
    if times.size and times[0] <= rounded:
        if scene.solver.start != "as given":
            return _Levels(times[1:], after)
        # A rope that is drawn stretched may bear the force from the start on.
        borne = sum((one.pull * one.outwards for one in beside), np.zeros(3))
        before = np.where(node.held[:3], 0.0, borne)
    return _Levels(times, np.vstack((before, after)))


def _worst(scene: CableScene, node: Node, parts: list[NodalPart], beside: list[_Along], total: float) -> _Found | None:
    """The jump at a node that rings the most beside the largest force."""
    levels = _levels(scene, node, parts, beside)
    if not levels.times.size:
        return None
    others, found = _others(scene, node.id, levels.times), None
    for one in beside:
        force, transit = levels.sums @ one.outwards, one.length / _speed(one)
        jumps, _ = _changes(levels.times, force, TOGETHER * transit)
        # Fronts that set out before the first is back from the other end may meet there.
        _, largest = _changes(levels.times, force, ENDS * total / _speed(one))
        drawn = max(0.0, abs(one.pull) - float(np.abs(force).max()))
        share = RINGS * ENDS * jumps / np.maximum(largest + np.maximum(others, drawn), np.finfo(float).tiny)
        # Of what changes as the run ends no front gets anywhere.
        share[levels.times > scene.solver.end - TOGETHER * transit] = 0.0
        k = int(share.argmax())
        # Rounding aside, so many steps as the advice says are enough.
        if share[k] > SMALL * (1.0 + 1e-6) and (found is None or share[k] > found.share):
            found = _Found(node.id, one, float(levels.times[k]), float(jumps[k]), float(share[k]))
    return found


def _changes(times: np.ndarray, force: np.ndarray, within: float) -> tuple[np.ndarray, float]:
    """By how much a force changes at each of its times and so long afterwards at most, N, and the largest it causes, N.

    What is at rest under a force bears, after it has jumped, as much again beyond the new one.
    """
    largest, jumps = float(np.abs(force).max()), np.zeros(times.size)
    for k, last in enumerate(np.searchsorted(times, times + within, side="right").tolist()):
        change = force[k + 1 : last + 1] - force[k]
        jumps[k] = np.abs(change).max()
        largest = max(largest, float(np.abs(force[k] + ENDS * change).max()))
    return jumps, largest


def _others(scene: CableScene, node: int, times: np.ndarray) -> np.ndarray:
    """What else acts in a scene at such times, N: weight, loads, and forces at other nodes."""
    spans = np.array([part.model.interval for part in scene.forces], float)
    each = np.array([item_of(part).force(part) for part in scene.forces])
    everywhere = np.array([len(part.nodes) for part in scene.forces])
    elsewhere = each * (everywhere - [part.nodes.count(node) for part in scene.forces])
    lasting = max(0.0, given_force(scene) - float(each @ everywhere))
    return np.array([lasting + elsewhere[(spans[:, 0] <= t) & (t <= spans[:, 1])].sum() for t in times.tolist()])


def _part_in(part: NodalPart, found: _Found) -> tuple[bool, float]:
    """Order of the forces at a node by what they have to do with its jump."""
    changes = min(abs(time - found.time) for time in part.model.interval)
    return changes <= TOGETHER * found.along.length / _speed(found.along), float(np.linalg.norm(part.model.force))


def _speed(one: _Along) -> float:
    """Of waves along the element, m/s."""
    return math.sqrt(one.element.EA / one.element.rhoA)


def _text(found: _Found, total: float) -> str:
    along = found.along
    # With this the front is as long as an element once it has run along all rope.
    enough = along.length**2 / (total * _speed(along))
    return (
        f"at t = {found.time:g} s the force at node {found.node} changes at once by {found.jump:.3g} N along element "
        f"{along.element.id}. The damping of this element is too small for the length of the rope. "
        "A wave with a sharp front runs along the rope. Behind such a front the computed force rings: the largest "
        f"force may be too large by about {in_percent(found.share)}. More elements or shorter steps alone do not "
        f"help. Give the rope damping, such as cDamp: {enough:.2g}, or let the force change in "
        f"{math.ceil(found.share / SMALL * (1.0 - 1e-6))} equal steps, spread over up to "
        f"{ENDS * total / _speed(along):.2g} s, each a PointForce with its timeInterval"
    )
