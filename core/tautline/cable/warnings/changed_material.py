"""What to tell of material that passes a node between unlike elements: it becomes that of the next one."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from operator import attrgetter, countOf
from typing import NamedTuple

import numpy as np

from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import CableScene, Element
from tautline.cable.warnings.coarse_lines import Sentences
from tautline.cable.warnings.drawn_out import driven_p, known_by, sampled
from tautline.scene.warnings import warning

UNLIKE = 1.0e-9
"""Difference of two numbers over the larger, from which on they are not one."""
TOGETHER = 1.0e-9
"""Distance, m, and difference of p, m, below which ends of two elements are one place of a rope."""
WORDS = {
    "rhoA": ("kg/m", "mass"),
    "EA": ("N", "axial stiffness, and with it the energy that is stored in it"),
    "EJ": ("N m^2", "bending stiffness, and with it the energy that is stored in it"),
}
"""Numbers of an element per length of material, their units, and what changes with them."""


_Curves = dict[tuple[int, int], list[Element]]
"""Elements by the nodes between which they are: those between the same ones are one curve."""


class _Change(NamedTuple):
    """A node of moving material between unlike elements, and their numbers by name: those that differ."""

    node: int
    elements: tuple[Element, Element]
    unlike: dict[str, tuple[float, float]]


@warning("cable")
def _changed_material(scene: CableScene) -> Sentences:
    """The first node whose p is free or driven between elements of unlike material."""
    found = _changes(scene)
    if not found:
        return
    node, (one, other), unlike = found[0]
    numbers = " and ".join(f"{name} {a:.6g} and {b:.6g} {WORDS[name][0]}" for name, (a, b) in unlike.items())
    changed = ", its ".join(WORDS[name][1] for name in unlike)
    others = f" {len(found) - 1} more nodes are like this one." if len(found) > 1 else ""
    wrong = " So mass comes from nowhere or is lost." if "rhoA" in unlike else ""
    text = (
        f"p of node {node} is free or driven, and elements {one.id} and {other.id} on its sides have {numbers}. These "
        f"numbers belong to elements: material that passes the node changes its {changed}.{wrong} Let unlike material "
        f"meet at a node whose p is held, or give both elements one material.{others}"
    )
    yield other.place, text


def _changes(scene: CableScene) -> list[_Change]:
    """All such nodes, in the order of the elements.

    Material passes from the one curve that ends at a place to the one that begins there, and no other way.
    """
    moving = _moving(scene) if _unlike(scene) else set()
    where = _places(scene, moving)
    at: dict[int, tuple[_Curves, _Curves]] = {}
    for element in scene.elements if moving else ():
        for i, node in enumerate(element.nodes):
            if element.conveyed is None and node in moving:
                begins_or_ends = at.setdefault(where(node), ({}, {}))[i]
                begins_or_ends.setdefault(element.nodes, []).append(element)
    found = []
    for begins, ends in at.values():
        if len(begins) != 1 or len(ends) != 1:
            continue
        ((nodes, after),), (before,) = begins.items(), ends.values()
        pairs = zip(WORDS, _numbers(before), _numbers(after), strict=True)
        unlike = {name: (a, b) for name, a, b in pairs if abs(a - b) > UNLIKE * max(a, b)}
        if unlike:
            found.append(_Change(nodes[0], (before[0], after[0]), unlike))
    return found


def _unlike(scene: CableScene) -> bool:
    """Whether curves may differ: elements in their numbers, or in how many lie between the same nodes.

    100 000 of one line are looked through in milliseconds.
    """
    count = len(scene.elements)
    if not count:
        return False
    numbers, nodes = attrgetter(*WORDS), map(attrgetter("nodes"), scene.elements)
    return countOf(map(numbers, scene.elements), numbers(scene.elements[0])) < count or len(set(nodes)) < count


def _numbers(elements: list[Element]) -> tuple[float, ...]:
    """Of elements between the same nodes, which are one curve: the sums of their rhoA, EA and EJ."""
    return tuple(sum(getattr(element, name) for element in elements) for name in WORDS)


def _moving(scene: CableScene) -> set[int]:
    """Nodes whose p is free or driven: not held, itself or by a tie p = p, nor following what stands still."""
    some = {node.id for node in scene.nodes if not node.held[-1]} | driven_p(scene)
    if not some:
        return set()
    known, kinds = known_by(scene), {node.id: node.kind for node in scene.nodes}
    sampler: list[Callable[[int], np.ndarray]] = []

    @functools.cache
    def runs(motion: int) -> bool:
        if not sampler:
            sampler.append(sampled({one.id: one for one in scene.motions}, scene.solver.end)[1])
        return bool(sampler[0](motion)[:, 1].any())

    def held(node: int) -> bool:
        p = known(node, kinds[node])
        return p is not None and not any(runs(motion) for motion in p.motions)

    tied = _joined(tie.nodes for tie in scene.ties if tie.what == 1)
    at_rest = {tied(node) for tie in scene.ties if tie.what == 1 for node in tie.nodes if held(node)}
    return {node for node in some if tied(node) not in at_rest and not held(node)}


def _places(scene: CableScene, moving: set[int]) -> Callable[[int], int]:
    """Where along its rope a moving node is: nodes at one point with one p are one place if something joins them.

    That is a tie or a coupling of r or p, or one function that both follow. Ends that only lie at one point are ends of
    two ropes.
    """
    if not moving:
        return lambda node: node
    material, known = material_coordinates(scene), known_by(scene)
    nodes = {node.id: node for node in scene.nodes}
    pairs = [tie.nodes for tie in scene.ties if tie.what != 2]
    for coupling in scene.couplings:
        node, dof = coupling.slave
        if len(coupling.masters) == 1 and (dof <= 3 or dof == nodes[node].kind):
            pairs.append((node, coupling.masters[0][0]))
    leads: dict[frozenset[tuple[int, float]], int] = {}
    for node in sorted(moving):
        p = known(node, nodes[node].kind)
        if p is not None:
            pairs.append((leads.setdefault(frozenset(p.motions.items()), node), node))
    tied = _joined(pairs)
    first: dict[object, int] = {}

    def of(node: int) -> int:
        at = (round(x / TOGETHER) for x in (*nodes[node].position, material[node]))
        return first.setdefault((tied(node), *at), node)

    return of


def _joined(pairs: Iterable[tuple[int, int]]) -> Callable[[int], int]:
    """Of a node: one that stands for all that pairs join with it, directly or by others."""
    leader: dict[int, int] = {}

    def of(node: int) -> int:
        while (up := leader.get(node, node)) != node:
            leader[node] = leader.get(up, up)
            node = up
        return node

    for one, other in pairs:
        leader[of(other)] = of(one)
    return of
