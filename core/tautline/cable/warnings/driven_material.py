"""What to tell of material that is driven through an element at two rates, where a run begins at rest."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tautline.cable.input.couplings import NEARLY, SAME_RATE, alike_within, rates_at_start
from tautline.cable.input.parts import CableScene, Element
from tautline.cable.warnings.coarse_lines import Sentences
from tautline.scene.warnings import warning

TOO_LITTLE = 1e-7
"""Force over EA, a strain, below which a force is not worth a word."""

SETTLES = {
    "static": "`start: static` lets material flow on at both rates, for they nearly agree",
    "relaxed": "Dynamic relaxation lets no material flow on at two rates, for elements would change meanwhile: "
    "take start: static",
}
"""What a start at rest makes of two rates that nearly agree."""


class _Driven(NamedTuple):
    """An element whose material is driven at both ends, its rates there, m/s, and within what share they are alike."""

    element: Element
    rates: tuple[float, float]
    alike: float

    @property
    def apart(self) -> float:
        """Difference of the rates over the larger."""
        first, second = self.rates
        return abs(first - second) / (max(abs(first), abs(second)) or 1.0)

    @property
    def flows(self) -> bool:
        """Whether both ends flow on while the rope rests: at one rate, or nearly."""
        return 0.0 not in self.rates and self.apart <= self.alike


@warning("cable")
def _two_rates(scene: CableScene) -> Sentences:
    """Material that a start at rest lets flow on at two rates, or at one end of an element only."""
    if driven := _driven(scene):
        yield from _nearly_one_rate(scene, driven)
        yield from _half_flowing(scene, driven)


def _nearly_one_rate(scene: CableScene, driven: list[_Driven]) -> Sentences:
    """Elements that grow slowly from the first moment on, for functions drive both ends nearly alike."""
    drives = _drives_of_p(scene)
    found = []
    for one in driven:
        here, there = (drives(node) for node in one.element.nodes)
        # Where the same functions move both ends by factors of their own, the difference is meant.
        if here and there and here != there and SAME_RATE < one.apart <= NEARLY:
            found.append(one)
    if not found:
        return
    element, (first, second), _ = max(found, key=lambda one: one.apart)
    change = f"{'grows' if second > first else 'shrinks'} by {abs(second - first):.3g} m/s of material"
    others = f", as do {len(found) - 1} more like it" if len(found) > 1 else ""
    text = (
        f"material runs at {first:.9g} m/s at node {element.nodes[0]} when the run begins, and at {second:.9g} m/s at "
        f"node {element.nodes[1]}: this element {change}{others}. {SETTLES[scene.solver.start]}. If one speed is "
        "meant, couple p of one node to p of the other by LinearCoupl, or write the functions with more digits"
    )
    yield element.place, text


def _half_flowing(scene: CableScene, driven: list[_Driven]) -> Sentences:
    """Elements of which a start at rest lets one node flow on and not the other: they take in momentum that is lost."""
    flowing = {node for one in driven if one.flows for node in one.element.nodes}
    found: list[tuple[float, Element, tuple[int, float], tuple[int, float]]] = []
    for element, rates, _ in driven:
        ends = tuple(zip(element.nodes, rates, strict=True))
        runs = [end for end in ends if end[0] in flowing]
        # A node whose own rate is 0 is right where it stands.
        stands = [end for end in ends if end[0] not in flowing and end[1] != 0.0]
        force = element.rhoA * runs[0][1] ** 2 if runs and stands else 0.0
        if force > TOO_LITTLE * element.EA:
            found.append((force, element, runs[0], stands[0]))
    if not found:
        return
    force, element, (node, speed), (other, rate) = max(found, key=lambda entry: entry[0])
    others = f" {len(found) - 1} more elements are like this one." if len(found) > 1 else ""
    text = (
        f"`start: {scene.solver.start}` lets material flow on at {speed:.9g} m/s at node {node}, beside which an "
        f"element keeps its length, and takes it to stand still at node {other}, whose {rate:.9g} m/s differ by more "
        f"than {100.0 * alike_within(scene.solver.start):.3g} %. Forces at rest in elements near them are off by about "
        f"rhoA v^2 = {force:.3g} N, and the rope swings when the run begins.{others} Let all speeds grow from 0, or "
        "begin at one rate, and change them later"
    )
    yield element.place, text


def _driven(scene: CableScene) -> list[_Driven]:
    """Elements whose material is held at both ends and runs at one of them at least, of a scene that begins at rest."""
    if scene.solver.start not in ("static", "relaxed") or not scene.motions:
        return []
    rate_of, kinds = rates_at_start(scene), {node.id: node.kind for node in scene.nodes}
    found = []
    for element in scene.elements:
        (first, held), (second, there) = (rate_of(node, kinds[node]) for node in element.nodes)
        if held and there and (first or second):
            found.append(_Driven(element, (first, second), alike_within(scene.solver.start)))
    return found


def _drives_of_p(scene: CableScene) -> Callable[[int], frozenset[int]]:
    """Of a node: the functions that drive its p."""
    nodes = {node.id: node for node in scene.nodes}
    masters = {coupling.slave: coupling.masters for coupling in scene.couplings}

    def of(node: int, dof: int) -> frozenset[int]:
        if (node, dof) not in masters:
            return frozenset({nodes[node].functions[dof - 1]} - {0})
        return frozenset().union(*(of(master, number) for master, number, _ in masters[node, dof]))

    return lambda node: of(node, nodes[node].kind)
