"""What to tell of material that is driven through an element at two rates that nearly agree."""

from __future__ import annotations

from collections.abc import Callable

from tautline.cable.coarse_lines import Sentences
from tautline.cable.input.couplings import SAME_RATE, rates_at_start
from tautline.cable.input.parts import CableScene, Element
from tautline.scene.warnings import warning

NEARLY = 0.01
"""Difference of two rates of p over the larger, below which one rate may be meant by both."""


@warning("cable")
def _nearly_one_rate(scene: CableScene) -> Sentences:
    """Material whose flow a start at rest leaves out, for functions drive both ends of an element nearly alike."""
    if scene.solver.start not in ("static", "relaxed") or not scene.motions:
        return
    drives, kinds = _drives_of_p(scene), {node.id: node.kind for node in scene.nodes}
    several: list[Element] = []
    for element in scene.elements:
        first, second = (drives(node) for node in element.nodes)
        # Where the same functions move both ends by factors of their own, the difference is meant.
        if first and second and first != second:
            several.append(element)
    if not several:
        return
    rate_of = rates_at_start(scene)
    found: list[tuple[float, Element, float, float]] = []
    for element in several:
        (one, held), (other, there) = (rate_of(node, kinds[node]) for node in element.nodes)
        apart = abs(one - other) / (max(abs(one), abs(other)) or 1.0)
        if held and there and SAME_RATE < apart <= NEARLY:
            found.append((apart, element, one, other))
    if not found:
        return
    _, element, one, other = max(found, key=lambda entry: entry[0])
    others = f" and of {len(found) - 1} more like it" if len(found) > 1 else ""
    text = (
        f"material runs at {one:.9g} m/s at node {element.nodes[0]} when the run begins, and at {other:.9g} m/s at "
        f"node {element.nodes[1]}. `start: {scene.solver.start}` lets material flow on where both rates are equal to "
        f"{SAME_RATE:.0e} of them. Material of this element{others} is taken to stand still, and the rope swings when "
        "the run begins. If one speed is meant, couple p of one node to p of the other by LinearCoupl, or write the "
        "functions with more digits"
    )
    yield element.place, text


def _drives_of_p(scene: CableScene) -> Callable[[int], frozenset[int]]:
    """Of a node: the functions that drive its p."""
    nodes = {node.id: node for node in scene.nodes}
    masters = {coupling.slave: coupling.masters for coupling in scene.couplings}

    def of(node: int, dof: int) -> frozenset[int]:
        if (node, dof) not in masters:
            return frozenset({nodes[node].functions[dof - 1]} - {0})
        return frozenset().union(*(of(master, number) for master, number, _ in masters[node, dof]))

    return lambda node: of(node, nodes[node].kind)
