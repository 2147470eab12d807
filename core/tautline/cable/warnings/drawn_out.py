"""What to tell of an element out of which functions of time will have drawn all material before a run ends."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from tautline.cable.input.couplings import value_of
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import CableScene, Element, Motion
from tautline.cable.warnings.coarse_lines import Sentences
from tautline.scene.warnings import warning

INSTANTS = 1000
"""How many instants of a run are looked at, beside those where a function has a corner."""


class Known(NamedTuple):
    """A degree of freedom that is known in advance: a number plus multiples of motions, by their ids."""

    constant: float
    motions: dict[int, float]


class _Drawn(NamedTuple):
    """An element that loses all of its material: when, s, what it began with, and what is drawn out by the end, m."""

    element: Element
    time: float
    begun: float
    drawn: float


@warning("cable")
def _drawn_out(scene: CableScene) -> Sentences:
    """The element that is without material first."""
    found = list(_emptied(scene))
    if not found:
        return
    element, time, begun, drawn = min(found, key=lambda one: one.time)
    first, second = element.nodes
    others = f", and so have {len(found) - 1} more like it later" if len(found) > 1 else ""
    cure = "let it begin with more"
    if element.place[-1] == "CableLine":
        cure = (
            "give the line fewer elements, which are then longer, or write the element that loses its cable as an item "
            "of its own"
        )
    text = (
        f"element {element.id} between nodes {first} and {second} has lost all of its {begun:.6g} m of cable at "
        f"{time:.6g} s{others}: its nodes draw {drawn:.6g} m out of it. The run stops there with NO_LENGTH. Draw out "
        f"less than the element has, or {cure}"
    )
    yield element.place, text


def _emptied(scene: CableScene) -> Iterator[_Drawn]:
    """Elements that are left without material; alike driven ones share what was found of how they are."""
    if not driven_p(scene):
        return
    known, motions = known_by(scene), {motion.id: motion for motion in scene.motions}
    times: np.ndarray = np.zeros(0)
    changes: dict[frozenset[tuple[int, float]], np.ndarray] = {}
    kinds = {node.id: node.kind for node in scene.nodes}
    for element in scene.elements:
        first, second = (known(node, kinds[node]) for node in element.nodes)
        if first is None or second is None:
            continue
        apart = _sum([(1.0, second), (-1.0, first)])
        if not apart.motions:
            continue
        if not times.size:
            times, moved = sampled(motions, scene.solver.end)
        key = frozenset(apart.motions.items())
        if key not in changes:
            changes[key] = sum((factor * moved(motion)[:, 0] for motion, factor in key), np.zeros(times.size))
        lengths = apart.constant + changes[key]
        # What begins without length is refused by name elsewhere.
        if lengths[0] > 0.0 and (gone := np.flatnonzero(lengths <= 0.0)).size:
            yield _Drawn(element, _crossing(times, lengths, int(gone[0])), lengths[0], lengths[0] - lengths.min())


def _crossing(times: np.ndarray, lengths: np.ndarray, i: int) -> float:
    """When a length becomes zero, s, between two instants of which it is at the second."""
    (before, after), (left, right) = times[i - 1 : i + 1], lengths[i - 1 : i + 1]
    return float(before + (after - before) * left / (left - right))


def _sum(parts: list[tuple[float, Known]], constant: float = 0.0) -> Known:
    """A number plus multiples of what is known."""
    motions: dict[int, float] = {}
    for factor, part in parts:
        constant += factor * part.constant
        for motion, own in part.motions.items():
            motions[motion] = motions.get(motion, 0.0) + factor * own
    return Known(constant, {motion: factor for motion, factor in motions.items() if factor != 0.0})


def driven_p(scene: CableScene) -> set[int]:
    """Nodes whose p follows a function or is coupled: that of any other is free or stands still."""
    found = {node.id for node in scene.nodes if node.functions[-1]} if scene.motions else set()
    if scene.couplings:
        kinds = {node.id: node.kind for node in scene.nodes}
        found |= {node for node, dof in (coupling.slave for coupling in scene.couplings) if dof == kinds[node]}
    return found


def known_by(scene: CableScene) -> Callable[[int, int], Known | None]:
    """Of a node and a degree of freedom, numbered from one: what is known of it in advance; None of what is free."""
    nodes, material = {node.id: node for node in scene.nodes}, material_coordinates(scene)
    couplings = {coupling.slave: coupling for coupling in scene.couplings}
    motions = {motion.id: motion for motion in scene.motions}

    @functools.cache
    def of(node: int, dof: int) -> Known | None:
        if coupling := couplings.get((node, dof)):
            parts = [(factor, of(master, number)) for master, number, factor in coupling.masters]
            sound = [(factor, part) for factor, part in parts if part is not None]
            return _sum(sound, coupling.f0) if len(sound) == len(parts) else None
        if not nodes[node].held[dof - 1]:
            return None
        if function := nodes[node].functions[dof - 1]:
            motion = motions[function]
            # A rate goes on from pos0, a function is the value itself.
            return Known(motion.pos0 if motion.function is None else 0.0, {function: 1.0})
        return Known(value_of(nodes[node], dof, material), {})

    return of


def sampled(motions: dict[int, Motion], end: float) -> tuple[np.ndarray, Callable[[int], np.ndarray]]:
    """Instants of a run (m,), s, and what a motion is at each (m, 3): its value, m, rate and second rate."""
    from tautline.cable.model.layout import request_of
    from tautline.kernels.time_function import sample
    from tautline.system.time_functions import compile_functions

    compiled = compile_functions([request_of(motion, end) for motion in motions.values()])
    corners = compiled.breaks[(compiled.breaks > 0.0) & (compiled.breaks < end)]
    times = np.unique(np.concatenate([np.linspace(0.0, end, INSTANTS + 1), corners]))
    place = {motion: i for i, motion in enumerate(motions)}
    return times, functools.cache(lambda motion: sample(compiled, place[motion], times))
