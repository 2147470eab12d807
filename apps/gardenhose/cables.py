"""A hose and the water in it as a scene of cables: the hose's elements, the water's on top of them, what ties them.

Both have their own nodes. Those of the hose come first, from 1 at the root, and hold its material; those of the water
let it through, p falling at the rate at which water flows on towards the tip (thesis, section 2.7.1). Where the bore
changes a chain of water ends and the next begins.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from gardenhose.scene import HoseScene, Segment
from tautline.cable.input.parts import CableScene, Coupling, Element, Motion, Node, Place, Tie
from tautline.cable.input.syntax.nodal import NodalPart
from tautline.cable.input.syntax.nodal_items import PointMass
from tautline.cable.input.syntax.solver import CableSolver
from tautline.scene.reading.document import Document

METHODS = {"lagrange": "multiplier", "penalty": "penalty", "augmented": "augmented"}
FREE, HELD = False, True
SPEED: Place = ("water", "speed")
BORES_DIFFER = 1.0e-9
"""Relative difference of the water's mass per length above which two pieces have two bores."""


class Stream(NamedTuple):
    """Water of one bore: mass per length of hose kg/m, speed over that in the first piece, hose nodes it lies between.

    ``first`` is the id of its first node.
    """

    mass: float
    ratio: float
    start: int
    stop: int
    first: int


def arc_lengths(scene: HoseScene) -> np.ndarray:
    """Unstretched distance of each node from the root (n,), m."""
    s = [0.0]
    for piece in scene.hose.pieces:
        s += [s[-1] + piece.length * (k + 1) / piece.elements for k in range(piece.elements)]
    return np.array(s)


def pieces_of_elements(scene: HoseScene) -> list[tuple[int, Segment]]:
    """The piece of the hose, with its number, that each element belongs to."""
    return [(k, piece) for k, piece in enumerate(scene.hose.pieces) for _ in range(piece.elements)]


def streams(scene: HoseScene) -> list[Stream]:
    """The water from the root to the tip; empty where there is none."""
    if scene.water is None:
        return []
    masses = [float(piece.water_mass_per_length or 0.0) for _, piece in pieces_of_elements(scene)]
    cuts = [0]
    for k in range(1, len(masses)):
        if abs(masses[k] - masses[k - 1]) > BORES_DIFFER * masses[k]:
            cuts.append(k)
    cuts.append(len(masses))
    found, node = [], len(masses) + 2
    for start, stop in pairwise(cuts):
        found.append(Stream(masses[start], masses[0] / masses[start], start, stop, node))
        node += stop - start + 1
    return found


def cables_of(scene: HoseScene, fused: bool = True) -> CableScene:
    """The scene of cables that a hose is.

    With linear coupling all that hose and water share is one unknown, and their elements are ``fused`` into one.
    """
    s = arc_lengths(scene)
    document = scene.document or Document.parse("{}", "scene.yaml")
    nodes, couplings = _hose_nodes(scene, s)
    elements = [_hose_element(scene, i, k, piece) for i, (k, piece) in enumerate(pieces_of_elements(scene))]
    ties: list[Tie] = []
    motions: list[Motion] = []
    for stream in streams(scene):
        motions.append(_motion(scene, stream, len(motions) + 1, float(s[stream.start])))
        if fused and scene.coupling == "linear":
            for i in range(stream.start, stream.stop):
                elements[i] = replace(elements[i], conveyed=(stream.mass, motions[-1].id))
        else:
            _add_water(scene, s, stream, motions[-1].id, nodes, elements, couplings, ties)
    masses = []
    if scene.hose.tip_mass > 0.0:
        mass = PointMass(id=1, nodes7=(len(s),), mass=scene.hose.tip_mass)
        masses = [NodalPart("PointMass", mass, (len(s),), 0, ("hose", "tip_mass"))]
    solver = CableSolver.model_construct(end=scene.solver.end, mass_damping=0.0)
    return CableScene(
        title=scene.title, gravity=scene.gravity, nodes=tuple(nodes), elements=tuple(elements), ties=tuple(ties),
        couplings=tuple(couplings), nodal=tuple(masses), motions=tuple(motions),
        plots=(), solver=solver, warnings=(), document=document,
    )  # fmt: skip


def _position(scene: HoseScene, s: float) -> tuple[float, float, float]:
    x, y, z = (r + s * d for r, d in zip(scene.hose.root, scene.hose.unit_direction, strict=True))
    return x, y, z


def _hose_nodes(scene: HoseScene, s: np.ndarray) -> tuple[list[Node], list[Coupling]]:
    """Nodes of the hose, its ends held as the scene says; couplings where a clamp leaves the strain free."""
    hose, last = scene.hose, len(s)
    supports = {1: hose.root_support, last: hose.end}
    nodes, couplings = [], []
    for i in range(1, last + 1):
        support = supports.get(i, "free")
        held = [support != "free"] * 3 + [FREE] * 3 + [HELD]
        if support == "clamped":
            clamp, slaves = _clamp(scene, i)
            held[3:6] = clamp
            couplings += slaves
        key = "root_support" if i == 1 else "end"
        nodes.append(_node(i, _position(scene, s[i - 1]), hose.unit_direction, s[i - 1], held, 0, ("hose", key)))
    return nodes, couplings


def _clamp(scene: HoseScene, node: int) -> tuple[list[bool], list[Coupling]]:
    """What of r' a clamp holds: all of it, or all but its length, which is left to one component."""
    direction = scene.hose.unit_direction
    if scene.hose.clamp == "slope":
        return [HELD] * 3, []
    main = int(np.argmax(np.abs(direction)))
    held, slaves = [HELD] * 3, []
    held[main] = FREE
    for axis in range(3):
        if axis != main and direction[axis] != 0.0:
            held[axis] = FREE
            master = (node, 4 + main, direction[axis] / direction[main])
            slaves.append(Coupling(10 * node + axis, (node, 4 + axis), 0.0, (master,), 0, ("hose", "direction")))
    return held, slaves


def _node(
    i: int, position: Any, slope: Any, p: float, held: list[bool], function: int, place: Place
) -> Node:  # fmt: skip
    return Node(i, 7, position, slope, float(p), tuple(held), (0,) * 6 + (function,), 0, place)


def _hose_element(scene: HoseScene, i: int, k: int, piece: Segment) -> Element:
    place: Place = ("hose",) if scene.hose.segments is None else ("hose", "segments", k)
    return Element(
        i + 1, "cubic", (i + 1, i + 2), piece.axial_stiffness, piece.bending_stiffness, piece.mass_per_length,
        float(piece.damping or 0.0), scene.hose.strain, True, None, (0.0, 0.0, 0.0), 0, place, spinless=True,
    )  # fmt: skip


def _motion(scene: HoseScene, stream: Stream, id: int, begins: float) -> Motion:
    """What drives a stream: p falls as the water flows on."""
    assert scene.water is not None
    return Motion(id, begins, (), (), None, 0, SPEED, rate=scene.water.speed, factor=-stream.ratio)


def _add_water(
    scene: HoseScene,
    s: np.ndarray,
    stream: Stream,
    motion: int,
    nodes: list[Node],
    elements: list[Element],
    couplings: list[Coupling],
    ties: list[Tie],
) -> None:
    """Nodes and elements of one stream, and what ties it to the hose."""
    place, direction, begins = SPEED, scene.hose.unit_direction, float(s[stream.start])
    for k, i in enumerate(range(stream.start, stream.stop + 1)):
        node, hose = stream.first + k, i + 1
        held = [FREE] * 6 + [k == 0]
        nodes.append(_node(node, _position(scene, s[i]), direction, s[i], held, motion if k == 0 else 0, place))
        if k > 0:
            # All of it flows at the rate of the first node.
            master = (stream.first, 7, 1.0)
            couplings.append(Coupling(10 * node + 7, (node, 7), float(s[i]) - begins, (master,), 0, place))
            ends = (node - 1, node)
            load = (0.0, 0.0, 0.0)
            elements.append(
                Element(
                    len(elements) + 1, "cubic", ends, 0.0, 0.0, stream.mass, 0.0, "green", True, None, load, 0, place
                )
            )
        if scene.coupling == "linear":
            couplings += [
                Coupling(10 * node + dof, (node, dof), 0.0, ((hose, dof, 1.0),), 0, ("coupling",))
                for dof in range(1, 7)
            ]
        else:
            method: Any = METHODS[scene.coupling]
            ties += [
                Tie(2 * node + what, method, (hose, node), what, scene.stiffness, (0.0, 0.0, 0.0), 0, ("coupling",))
                for what in (0, 2)
            ]
