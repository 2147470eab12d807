"""A hose and the water in it as a scene of cables: the hose's elements, the water's on top of them, what ties them.

Both have their own nodes. Those of the hose come first, from 1 at the root, and hold its material; those of the water
let it through, p falling at the rate at which water flows on towards the tip (thesis, section 2.7.1). Where the bore
changes a chain of water ends and the next begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any, NamedTuple

import numpy as np

from gardenhose.estimates import average, speeds
from gardenhose.scene import HoseScene, Segment
from tautline.cable.input.parts import CableScene, Coupling, Element, Motion, Node, Place, Tie
from tautline.cable.input.syntax.nodal import NodalPart
from tautline.cable.input.syntax.nodal_items import PointMass
from tautline.cable.input.syntax.solver import CableSolver
from tautline.cable.model.build import Assembly, assemble_cables
from tautline.cable.model.layout import Layout
from tautline.cable.model.magnitudes import outweighs, too_stiff
from tautline.elements.nodal.jet import JET, Jets
from tautline.kernels.time_function import TimeFunctions
from tautline.scene.reading.document import Document
from tautline.system.records import records_of

METHODS = {"lagrange": "multiplier", "penalty": "penalty", "augmented": "augmented"}
STARTS = {"straight": "as given", "static": "static", "relaxed": "relaxed"}
"""What a start of a hose is called in a scene of cables."""
FREE, HELD = False, True
FOLLOWS_NOTHING = (0,) * 7
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
    s = [np.zeros(1)]
    for piece in scene.hose.pieces:
        s.append(s[-1][-1] + piece.length * np.arange(1, piece.elements + 1) / piece.elements)
    return np.concatenate(s)


def streams(scene: HoseScene) -> list[Stream]:
    """The water from the root to the tip; empty where there is none."""
    if scene.water is None:
        return []
    masses = [float(piece.water_mass_per_length or 0.0) for piece in scene.hose.pieces]
    begin = [0, *accumulate(piece.elements for piece in scene.hose.pieces)]
    cuts = [k for k in range(1, len(masses)) if abs(masses[k] - masses[k - 1]) > BORES_DIFFER * masses[k]]
    found, node = [], begin[-1] + 2
    for here, after in pairwise([0, *cuts, len(masses)]):
        found.append(Stream(masses[here], masses[0] / masses[here], begin[here], begin[after], node))
        node += begin[after] - begin[here] + 1
    return found


def cables_of(scene: HoseScene, fused: bool = True) -> CableScene:
    """The scene of cables that a hose is.

    With linear coupling all that hose and water share is one unknown, and their elements are ``fused`` into one.
    """
    s = arc_lengths(scene)
    document = scene.document or Document.parse("{}", "scene.yaml")
    nodes, couplings = _hose_nodes(scene, s)
    water, is_fused = streams(scene), fused and scene.coupling == "linear"
    motions = [_motion(scene, stream, k, float(s[stream.start])) for k, stream in enumerate(water, 1)]
    elements: list[Element] = []
    for k, piece in enumerate(scene.hose.pieces):
        flow = next(((of.mass, m.id) for of, m in zip(water, motions, strict=True) if of.stop > len(elements)), None)
        elements += _hose_elements(scene, len(elements), k, piece, flow if is_fused else None)
    ties: list[Tie] = []
    if not is_fused:
        for stream, motion in zip(water, motions, strict=True):
            _add_water(scene, s, stream, motion.id, nodes, elements, couplings, ties)
    masses = []
    if scene.hose.tip_mass > 0.0:
        mass = PointMass(id=1, nodes7=(len(s),), mass=scene.hose.tip_mass)
        masses = [NodalPart("PointMass", mass, (len(s),), 0, ("hose", "tip_mass"))]
    solver = CableSolver.model_construct(end=scene.solver.end, mass_damping=0.0, start=STARTS[scene.start])
    return CableScene(
        title=scene.title, gravity=scene.gravity, nodes=tuple(nodes), elements=tuple(elements), ties=tuple(ties),
        couplings=tuple(couplings), nodal=tuple(masses), motions=tuple(motions),
        plots=(), solver=solver, warnings=(), document=document,
    )  # fmt: skip


def _positions(scene: HoseScene, s: np.ndarray) -> list[tuple[float, float, float]]:
    """Places of the nodes at unstretched distances s (n,), m, from the root of the straight hose, m."""
    x, y, z = (r + s * d for r, d in zip(scene.hose.root, scene.hose.unit_direction, strict=True))
    return list(zip(x.tolist(), y.tolist(), z.tolist(), strict=True))


def _hose_nodes(scene: HoseScene, s: np.ndarray) -> tuple[list[Node], list[Coupling]]:
    """Nodes of the hose, its ends held as the scene says; couplings where a clamp leaves the strain free."""
    hose, last = scene.hose, len(s)
    supports = {1: hose.root_support, last: hose.end}
    places, direction = _positions(scene, s), hose.unit_direction
    free, place = (FREE,) * 6 + (HELD,), ("hose", "end")
    nodes = [
        Node(i, 7, position, direction, p, free, FOLLOWS_NOTHING, 0, place)
        for i, (position, p) in enumerate(zip(places, s.tolist(), strict=True), 1)
    ]
    couplings: list[Coupling] = []
    for i, support in supports.items():
        held = [support != "free"] * 3 + [FREE] * 3 + [HELD]
        if support == "clamped":
            held[3:6], slaves = _clamp(scene, i)
            couplings += slaves
        key = "root_support" if i == 1 else "end"
        nodes[i - 1] = _node(i, places[i - 1], direction, s[i - 1], held, 0, ("hose", key))
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
    i: int, position: Any, slope: Any, p: float, held: Sequence[bool], function: int, place: Place
) -> Node:  # fmt: skip
    functions = (0,) * 6 + (function,) if function else FOLLOWS_NOTHING
    return Node(i, 7, position, slope, float(p), tuple(held), functions, 0, place)


def _hose_elements(
    scene: HoseScene, first: int, k: int, piece: Segment, conveyed: tuple[float, int] | None
) -> list[Element]:  # fmt: skip
    """Elements of piece k, of which ``first`` stand before it."""
    place: Place = ("hose",) if scene.hose.segments is None else ("hose", "segments", k)
    damping, strain, load = float(piece.damping or 0.0), scene.hose.strain, (0.0, 0.0, 0.0)
    section = piece.axial_stiffness, piece.bending_stiffness, piece.mass_per_length
    return [
        Element(i, "cubic", (i, i + 1), *section, damping, strain, True, None, load, 0, place, True, conveyed)
        for i in range(first + 1, first + piece.elements + 1)
    ]


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
    places = _positions(scene, s)
    for k, i in enumerate(range(stream.start, stream.stop + 1)):
        node, hose = stream.first + k, i + 1
        held = [FREE] * 6 + [k == 0]
        nodes.append(_node(node, places[i], direction, s[i], held, motion if k == 0 else 0, place))
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


def step_limit(scene: HoseScene) -> float:
    """Largest change of an unknown in one iteration of a search for rest, m."""
    return 0.5 * float(np.diff(arc_lengths(scene)).min())


def assembled(scene: HoseScene, fused: bool = True, functions: TimeFunctions | None = None) -> Assembly:
    """The equations of a scene, with the velocity that it begins with; see `cables_of`.

    ``functions`` are those of the scene, in which the water may be held at another speed.
    """
    cables = cables_of(scene, fused)
    made = assemble_cables(cables, lambda layout: _jets(scene, layout), functions)
    made.system.hidden = outweighs(cables) and outweighs(cables, _thrust(scene))
    made.system.softer = stiff_beside_all(scene, cables)
    _disturb(scene, made)
    return made


def stiff_beside_all(scene: HoseScene, cables: CableScene) -> str:
    """Cause and cure where a hose is too stiff along itself beside its weight and its water's thrust, else empty.

    Between two ends it is stretched by what acts, and its stiffness makes its shape.
    """
    if scene.hose.end != "free" or not outweighs(cables):
        return ""
    return too_stiff(cables, _thrust(scene), "hose")


def _thrust(scene: HoseScene) -> float:
    """Momentum M U^2 of the water at its fastest, N."""
    return average(scene, float(np.abs(speeds(scene)).max())).thrust


def _jets(scene: HoseScene, layout: Layout) -> list[Any]:
    """Where the water's speed changes: from bore to bore, and in the nozzle at a free end."""
    found = streams(scene)
    rows = []
    for k, (here, after) in enumerate(pairwise(found)):
        rows.append(_jet(layout, here, k, here.mass / after.mass - 1.0))
    if found and scene.water is not None and scene.water.outlet != 1.0:
        rows.append(_jet(layout, found[-1], len(found) - 1, scene.water.outlet - 1.0))
    return [Jets(records_of(JET, rows))] if rows else []


def place_of_flow(layout: Layout, stream: Stream, number: int) -> int:
    """Full place of a stream's p."""
    return layout.flow[number + 1] if layout.flow else layout.material(stream.first)


def _jet(layout: Layout, stream: Stream, number: int, gain: float) -> dict[str, Any]:
    material = place_of_flow(layout, stream, number)
    return {"node": layout.start[stream.stop + 1], "material": material, "mass": stream.mass, "gain": gain}


def _disturb(scene: HoseScene, made: Assembly) -> None:
    """Let the hose begin with a velocity that grows as (s/L)^2 to that of its tip."""
    if not any(scene.disturbance):
        return
    tip, s = np.array(scene.disturbance), arc_lengths(scene)
    x = s / s[-1]
    v, start = made.system.v, made.layout.start
    held = made.layout.degrees.motion
    pairs = [(i + 1, i) for i in range(len(s))]
    for stream in [] if made.layout.flow else streams(scene):
        pairs += [(stream.first + k, i) for k, i in enumerate(range(stream.start, stream.stop + 1))]
    for node, i in pairs:
        for c in range(3):
            for place, value in ((start[node] + c, x[i] ** 2), (start[node] + 3 + c, 2.0 * x[i] / s[-1])):
                if place not in held:
                    v[place] = value * tip[c]
