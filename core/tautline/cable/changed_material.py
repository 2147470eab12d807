"""What to tell of material that passes a node between unlike elements: it becomes that of the next one."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tautline.cable.coarse_lines import Sentences
from tautline.cable.drawn_out import known_by
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import CableScene, Element
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
    """All such nodes, in the order of the elements."""
    moves = _moving(scene)
    at: dict[object, list[tuple[int, frozenset[int], Element]]] = {}
    where = _places(scene)
    for element in scene.elements if len({_numbers([e]) for e in scene.elements}) > 1 else ():
        for node in element.nodes:
            if element.conveyed is None and moves(node):
                at.setdefault(where(node), []).append((node, frozenset(element.nodes), element))
    found = []
    for entries in at.values():
        curves: dict[frozenset[int], list[tuple[int, Element]]] = {}
        for node, ends, element in entries:
            curves.setdefault(ends, []).append((node, element))
        if len(curves) != 2:
            continue
        (first, second) = curves.values()
        pairs = zip(WORDS, _numbers([e for _, e in first]), _numbers([e for _, e in second]), strict=True)
        unlike = {name: (a, b) for name, a, b in pairs if abs(a - b) > UNLIKE * max(a, b)}
        if unlike:
            found.append(_Change(second[0][0], (first[0][1], second[0][1]), unlike))
    return found


def _numbers(elements: list[Element]) -> tuple[float, ...]:
    """Of elements between the same nodes, which are one curve: the sums of their rhoA, EA and EJ."""
    return tuple(sum(getattr(element, name) for element in elements) for name in WORDS)


def _moving(scene: CableScene) -> Callable[[int], bool]:
    """Whether p of a node is free or driven: not held, itself or by a tie p = p."""
    known, kinds = known_by(scene), {node.id: node.kind for node in scene.nodes}
    beside: dict[int, list[int]] = {}
    for tie in scene.ties:
        if tie.what == 1:
            for node, other in (tie.nodes, tie.nodes[::-1]):
                beside.setdefault(node, []).append(other)

    def held(node: int) -> bool:
        p = known(node, kinds[node])
        return p is not None and not p.motions

    def of(node: int) -> bool:
        seen, left = {node}, [node]
        while left:
            one = left.pop()
            if held(one):
                return False
            left += [other for other in beside.get(one, []) if other not in seen]
            seen.update(left)
        return True

    return of


def _places(scene: CableScene) -> Callable[[int], object]:
    """Where along its rope a node is: nodes at one point with one p, at the ends of two elements, are one place."""
    material = material_coordinates(scene)
    position = {node.id: node.position for node in scene.nodes}
    return lambda node: tuple(round(x / TOGETHER) for x in (*position[node], material[node]))
