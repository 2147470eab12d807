"""What to tell a user about a cable scene before it runs: large against what, and what to do."""

from __future__ import annotations

import functools
import itertools
import math
from collections import Counter
from collections.abc import Callable
from decimal import ROUND_FLOOR, Context
from typing import Any

import numpy as np

import tautline.cable.warnings.changed_material
import tautline.cable.warnings.drawn_out
import tautline.cable.warnings.driven_material
import tautline.cable.warnings.fast_material
import tautline.cable.warnings.held_forces
import tautline.cable.warnings.held_rates
import tautline.cable.warnings.sudden_forces  # noqa: F401  (warns too)
from tautline.cable.input.couplings import APART, coupling_gap, rates_at_start, value_of
from tautline.cable.input.geometry import Drawn, arc_lengths, chord, drawn_of
from tautline.cable.input.material import element_lengths, material_coordinates, nodes_key
from tautline.cable.input.parts import CableScene, Node, Place, Tie
from tautline.cable.input.syntax.nodal import item_of
from tautline.cable.model.magnitudes import (
    given_force,
    largest_force,
    penalty_stiffness,
    rounded_gap,
    stiffest_element,
    stiffness_of,
    too_stiff,
)
from tautline.cable.model.sides import sides_of
from tautline.cable.warnings.coarse_lines import PRESTRETCHED, Sentences, cure_of, turned
from tautline.scene.errors import SceneWarning
from tautline.scene.methods import RK4
from tautline.scene.model import MADE
from tautline.scene.reading.document import join_key
from tautline.scene.solver import longest_step, step_taken
from tautline.scene.warnings import asked, warning

ROUNDED_SHARE = 1.0e-3
"""Share of a scene's largest force from which on that what rounding leaves in a penalty spring is told."""
AT_REST = 1.0e-9
"""Strain, and difference of slopes, below which an element is drawn as it is without a force."""
SOFT_SHARE = 0.01
"""Stretch of a penalty spring over that of the rope on both sides, from which on it is told."""
RIGHT = -1.0e-9
"""Cosine below which an angle is more than a right one."""
FASTEST = "fastest part"
"""Where a scene keeps it."""
COUNTED = ("PointMass", "PointForce", "OneNodeSpring", "TwoNodeSpring")
"""Items on nodes that ``check`` counts by another name than their key."""
WHAT = {0: "r = r", 1: "p = p", 2: "r' = r'"}


def warnings(scene: CableScene) -> list[SceneWarning]:
    """What the reader found; the functions of this file are registered, and asked as those of users are."""
    return list(scene.warnings)


def figures(scene: CableScene) -> dict[str, Any]:
    """Figures of the cable for ``check --json``: counts, unstretched length m, mass kg, RK4's critical step s."""
    lengths = element_lengths(scene).tolist()
    ropes = sum(element.rhoA * length for element, length in zip(scene.elements, lengths, strict=True))
    points = sum(item_of(part).mass(part) * len(part.nodes) for part in scene.nodal)
    parts = ("nodes", "elements", "ties", "couplings", "forces", "anchors", "springs", "masses", "motions")
    others = {part.key: len(scene.items_of(part.key)) for part in scene.nodal if part.key not in COUNTED}
    counts = {part: len(getattr(scene, part)) for part in parts} | others
    square, _ = _fastest(scene)
    return {
        "cable": counts | {"length": sum(lengths), "mass": ropes + points},
        "critical_step_rk4": RK4.reach_of_vibration / math.sqrt(square) if square > 0.0 else None,
    }


@functools.cache
def _unit_element(kind: str) -> tuple[float, float, tuple[float, float]]:
    """Largest eigenvalues, axial and bending, of a free element of unit length, stiffness and mass; how easily r and
    r' of its end move (diagonal of the inverse mass)."""
    if kind == "linear":
        return 12.0, 0.0, (4.0, 0.0)
    x, weights = np.polynomial.legendre.leggauss(5)
    x, weights = 0.5 * (x + 1.0), 0.5 * weights
    value = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    first = np.array([6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x])
    second = np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])
    inverse = np.linalg.inv((value * weights) @ value.T)
    axial, bending = (
        float(np.linalg.eigvals(inverse @ ((shape * weights) @ shape.T)).real.max()) for shape in (first, second)
    )
    return axial, bending, (float(inverse[0, 0]), float(inverse[1, 1]))


def _fastest(scene: CableScene) -> tuple[float, Place]:
    """Largest squared frequency, rad^2/s^2, of any part by itself, and the part: an upper bound but for sums."""
    kept = scene.__dict__.setdefault(MADE, {})
    if FASTEST not in kept:
        with np.errstate(all="ignore"):
            found = [(0.0, ()), *_squares(scene)]
        kept[FASTEST] = max((entry for entry in found if math.isfinite(entry[0])), key=lambda entry: entry[0])
    return kept[FASTEST]


def _squares(scene: CableScene) -> list[tuple[float, Place]]:
    """Squared frequencies of the parts; infinite or undefined for numbers that are no cable's."""
    found: list[tuple[float, Place]] = []
    lengths = element_lengths(scene)
    for kind in ("cubic", "linear"):
        some = [i for i, element in enumerate(scene.elements) if element.kind == kind and element.rhoA > 0.0]
        if some:
            axial, bending, _ = _unit_element(kind)
            elements = [scene.elements[i] for i in some]
            EA, EJ, density = (np.array([getattr(e, name) for e in elements]) for name in ("EA", "EJ", "rhoA"))
            length = lengths[some]
            squares = axial * EA / (density * length**2) + bending * EJ / (density * length**4)
            fastest = int(np.argmax(np.where(np.isfinite(squares), squares, 0.0)))
            found.append((float(squares[fastest]), elements[fastest].place))
    ease = _ease(scene, lengths)
    # Multipliers hold what springs beside them would only pull together.
    sprung = [tie for tie in scene.ties if tie.method == "penalty"]
    chosen = penalty_stiffness(scene) if sprung else 0.0
    nodes = {node.id: node for node in scene.nodes} if sprung else {}
    for tie in sprung:
        # Rope that slides through a held node has the inertia of rope whose end moves along it.
        turns = int(tie.what == 2)
        moving = [node for node in tie.nodes if not _is_held(nodes[node], tie.what)]
        both = sum(ease.get(node, (0.0, 0.0))[turns] for node in moving)
        found.append((float(stiffness_of(scene, tie, chosen) * both), tie.place))
    for part in scene.nodal:
        stiffness = item_of(part).stiffness(part)
        if stiffness > 0.0:
            easiest = max(ease.get(node, (0.0, 0.0))[0] for node in part.nodes)
            found.append((float(stiffness * easiest), part.place))
    return found


def _is_held(node: Node, what: int) -> bool:
    """Whether all of a node's position (0), p (1) or slope (2) is held, or follows a function."""
    return all(node.held[{0: slice(0, 3), 1: slice(-1, None), 2: slice(3, 6)}[what]])


def _ease(scene: CableScene, lengths: np.ndarray) -> dict[int, tuple[float, float]]:
    """How easily r and r' of the nodes move that springs join, at most: 1/kg and 1/(kg m^2), by node id."""
    sprung = {node for tie in scene.ties if tie.method == "penalty" for node in tie.nodes}
    sprung |= {node for part in scene.nodal if item_of(part).stiffness(part) > 0.0 for node in part.nodes}
    ease: dict[int, tuple[float, float]] = {}
    for element, length in zip(scene.elements, lengths, strict=True) if sprung else ():
        if element.rhoA == 0.0 or sprung.isdisjoint(element.nodes):
            continue
        mass, (easy, turning) = element.rhoA * length, _unit_element(element.kind)[2]
        for node in element.nodes:
            # A node between two elements is harder to move than the end of either.
            known = ease.get(node, (math.inf, math.inf))
            ease[node] = min(known[0], easy / mass), min(known[1], turning / (mass * length**2))
    return ease


@warning("cable")
def _steps(scene: CableScene) -> Sentences:
    square, place = _fastest(scene)
    step = step_taken(scene.solver, scene.solver.interval)
    if scene.solver.explicit and step * math.sqrt(square) > RK4.reach_of_vibration:
        text = (
            f"{step:g} s may be longer than RK4's critical step, which is at least about "
            f"{RK4.reach_of_vibration / math.sqrt(square):.2g} s (eq. 2.137, by {join_key(place)} in line "
            f"{scene.document.line(place)} alone): `stability` finds it; take a smaller step, or type: G-alpha"
        )
        yield ("GeneralizedAlpha", "time_step"), text


@warning("cable")
def _jumps(scene: CableScene) -> Sentences:
    """Prescribed velocities that change within less than a step: their acceleration lasts for all of it."""
    if scene.solver.control != "fixed" or scene.solver.step == "auto":
        return
    step = float(scene.solver.step)
    for motion in scene.motions:
        rise = [abs(b - a) > 0.0 for a, b in itertools.pairwise(motion.velocities)]
        over = [b - a for a, b in itertools.pairwise(motion.times)]
        short = [i for i, (changes, lasts) in enumerate(zip(rise, over, strict=True), 1) if changes and lasts < step]
        if short:
            i = short[0]
            text = (
                f"the velocity changes by {abs(motion.velocities[i] - motion.velocities[i - 1]):.3g} m/s within "
                f"{over[i - 1]:.3g} s, and a step is {step:g} s: give it some steps, or take shorter ones"
            )
            yield (*motion.place, "timeList", i), text


@warning("cable")
def _frames(scene: CableScene) -> Sentences:
    solver = scene.solver
    place = ("GeneralizedAlpha", "plotpoints")
    step = longest_step(solver, solver.interval)
    if solver.plotpoints * step > 1.0 + 1e-9:
        text = (
            f"{solver.plotpoints:g} frames a second are more than there are steps of {step:g} s: every step "
            "is kept; ask for fewer, or take smaller steps"
        )
        yield place, text
    elif 0.0 < solver.plotpoints * solver.end < 1.0 - 1e-9:
        yield place, f"{solver.plotpoints:g} frames a second leave only the first and the last of {solver.end:g} s"
    ratio = solver.interval / step
    if abs(ratio - round(ratio)) > 1e-6 * ratio:
        text = (
            f"a frame every {solver.interval:g} s is not a whole number of steps of {step:g} s: the step "
            f"taken is {solver.interval / math.ceil(ratio):.6g} s"
        )
        yield place, text


@warning("cable")
def _lengths(scene: CableScene) -> Sentences:
    """Elements that begin stretched or backwards, and ends without mass."""
    nodes = {node.id: node for node in scene.nodes}
    heavy = set(scene.heavy_nodes)
    heavy |= {node for element in scene.elements if element.rhoA > 0.0 for node in element.nodes}
    lengths = element_lengths(scene)
    drawn = drawn_of(scene)
    arcs = arc_lengths(drawn, lengths)
    loose = {node.id for node in scene.nodes if node.id not in heavy and not all(node.held[:3])}
    massless: set[Place] = set()
    bent = ~drawn.linear & ((drawn.first * drawn.second).sum(axis=1) < 0.0)
    told = set(turned(scene))
    for i in np.flatnonzero(bent | _odd(scene, drawn, lengths, arcs, loose)).tolist():
        element, length, arc = scene.elements[i], float(lengths[i]), float(arcs[i])
        first, second = (nodes[node] for node in element.nodes)
        line = chord(first.position, second.position)
        is_laid = element.place[-1] == "CableLine"
        # The slopes of a line that is stretched are as long as it is stretched; where it hangs they are 1 long.
        hangs = first.slope is not None and abs(math.hypot(*first.slope) - arc / length) > PRESTRETCHED
        if is_laid and element.length is not None and (bent[i] or hangs):
            if element.place not in told:
                told.add(element.place)
                text = (
                    f"are too few for the bend of the hanging cable: an element of {length:.4g} m is drawn {arc:.4g} m "
                    f"long. {cure_of(scene, element.place)}"
                )
                yield (*element.place, "elements"), text
            continue
        if element.kind == "cubic" and not is_laid:
            for node in (first, second):
                if sum(a * b for a, b in zip(node.slope or line, line, strict=True)) < 0.0:
                    text = (
                        f"the slope of node {node.id} points back along the element, which begins folded: swap the "
                        "element's nodes, or turn xyz_d round"
                    )
                    yield (*element.place, "nodes7"), text
        # Where the scene says how long an element is, slopes follow from it.
        stretch = 1.0 if element.length is None else arc / length
        for node in (first, second) if element.kind == "cubic" and not is_laid else ():
            size = math.hypot(*(node.slope or ()))
            if abs(size - stretch) > PRESTRETCHED:
                text = f"is {size:.3g} long: it is dr/dp, and 1 where the cable is not stretched; give a unit vector"
                yield (*node.place, "xyz_d"), text
        if abs(arc / length - 1.0) > PRESTRETCHED:
            word = "stretched" if arc > length else "shortened"
            text = (
                f"is {word} by {100.0 * abs(arc / length - 1.0):.2g} % at the start: {arc:.4g} m lie where "
                f"{length:.4g} m of cable are; put right "
                f"{'`p:` or pos0' if element.length is None else '`length:`'} if that is not meant"
            )
            yield (*element.place, nodes_key(element) if element.length is None else "length"), text
        for node in (first, second):
            if node.id in loose and not (node.place == element.place and node.place in massless):
                massless.add(node.place)
                yield (*element.place, "rhoA"), f"node {node.id} is free and has no mass: give rhoA, or a PointMass"


def _odd(scene: CableScene, drawn: Drawn, lengths: np.ndarray, arcs: np.ndarray, loose: set[int]) -> np.ndarray:
    """Whether there may be something to say about each element (m,)."""
    odd = ~(np.abs(arcs / lengths - 1.0) <= PRESTRETCHED)
    for slope in (drawn.first, drawn.second):
        folded, size = (slope * drawn.chord).sum(axis=1) < 0.0, np.sqrt((slope * slope).sum(axis=1))
        odd |= ~drawn.linear & (folded | ~(np.abs(size - 1.0) <= PRESTRETCHED))
    if loose:
        odd |= np.array([not loose.isdisjoint(element.nodes) for element in scene.elements])
    return odd


@warning("cable")
def _corners(scene: CableScene) -> Sentences:
    """Cubic elements that share the slope of a node, and lead away from one another by more than a right angle."""
    cubic = [element for element in scene.elements if element.kind == "cubic"]
    along = drawn_of(scene).chord[~drawn_of(scene).linear]
    along = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    ends = np.array([element.nodes for element in cubic], dtype=np.int64).T.ravel()
    order = np.argsort(ends, kind="stable")
    one, other = order[:-1] % max(len(cubic), 1), order[1:] % max(len(cubic), 1)
    cosine = (along[one] * along[other]).sum(axis=1)
    meet = Counter(ends.tolist())
    # Where more than two meet the scene is refused.
    two = np.array([meet[node] == 2 for node in ends[order[1:]].tolist()], dtype=bool)
    apart = two & (cosine < RIGHT)
    told: set[int] = set()
    for i in np.flatnonzero((ends[order[1:]] == ends[order[:-1]]) & apart).tolist():
        first, second, node = cubic[one[i]], cubic[other[i]], int(ends[order[i]])
        if node in told or first.place == second.place:
            continue  # Of one line its bend is told.
        told.add(node)
        angle = math.degrees(math.acos(max(-1.0, float(cosine[i]))))
        text = (
            f"elements {first.id} and {second.id} share the slope of node {node}, and lead {angle:.0f} degrees apart: "
            "swap the nodes of one where the cable runs on; at a corner, end one at a node of its own and tie r"
        )
        yield (*second.place, "nodes7"), text


@warning("cable")
def _kinks(scene: CableScene) -> Sentences:
    """Cubic ropes without bending stiffness on which something acts at a node: neither their direction nor their strain
    jumps there, and one should.
    """
    rounds: dict[int, list[bool]] = {}
    slack = any(element.EJ == 0.0 for element in scene.elements)
    for element in scene.elements if slack else ():
        for node in element.nodes if element.kind == "cubic" else ():
            rounds.setdefault(node, []).append(element.EJ == 0.0 and element.quadrature != "lobatto")
    within = {node for node, sides in rounds.items() if len(sides) > 1 and all(sides)}
    if not within:
        return
    acted = {node.id for node in scene.nodes if any(node.held[:3])} & within
    acted -= _guided(scene) | _kept_in_planes(scene) if acted else set()
    # How much a spring pulls is not known before the run.
    acted |= {node for part in (*scene.forces, *scene.masses) for node in part.nodes}
    acted |= {node for tie in scene.ties if tie.what == 0 for node in tie.nodes}
    bent = [node for node in scene.nodes if node.id in within & acted]
    if bent:
        others = f", and {len(bent) - 1} more like it" if len(bent) > 1 else ""
        text = (
            f"elements with EJ = 0 share the slope of node {bent[0].id}{others}: a rope has a corner where a force or "
            "a support acts across it, and its strain jumps where one acts along it. Cubic elements are smooth there. "
            "The axial force beside it may be off by a tenth, or more, however many elements there are: give them "
            "quadrature: lobatto, use linear elements (nodes4), or end one element at a node of its own and tie r"
        )
        key = "quadrature" if bent[0].place[-1] == "CableLine" else "xyz_d"
        yield (*bent[0].place, key), text


def _guided(scene: CableScene) -> set[int]:
    """Nodes with held slopes, and so without a corner, whose supports are all across the rope: they take no tension."""
    drawn = drawn_of(scene)
    along: dict[int, Any] = {}
    for element, line, size in zip(scene.elements, np.abs(drawn.chord), drawn.distance, strict=True):
        for node in element.nodes:
            along[node] = along.get(node, False) | (line > AT_REST * size)
    return {
        node.id
        for node in scene.nodes
        if sum(node.held[3:6]) >= 2 and not np.any(along.get(node.id, False) & np.array(node.held[:3], dtype=bool))
    }


def _kept_in_planes(scene: CableScene) -> set[int]:
    """Nodes whose supports only keep a cable in a plane: they have no part in its tension, and bend nothing.

    Both nodes of all elements there are held across the plane, where they are drawn in it, and nothing acts across it
    on what lies between them, or their slopes are held as well.
    """
    drawn = drawn_of(scene)
    flat = np.max(np.abs([drawn.chord, drawn.first, drawn.second]), axis=0) <= AT_REST
    fixed = {node.id: [h and not f for h, f in zip(node.held, node.functions, strict=True)] for node in scene.nodes}
    across = {node.id: [True] * 3 for node in scene.nodes}
    for element, plane in zip(scene.elements, flat.tolist(), strict=True):
        if element.kind == "linear":
            continue
        for i in range(3):
            loaded = element.load[i] != 0.0 or element.rhoA * scene.gravity[i] != 0.0
            rows = (i, i + 3) if loaded else (i,)
            if not plane[i] or not all(fixed[node][row] for node in element.nodes for row in rows):
                across[element.nodes[0]][i] = across[element.nodes[1]][i] = False
    return {node.id for node in scene.nodes if all(across[node.id][i] for i in range(3) if node.held[i])}


@warning("cable")
def _gaps(scene: CableScene) -> Sentences:
    """Constraints that do not hold at the start, and functions that begin elsewhere than their nodes."""
    p, nodes = material_coordinates(scene), {node.id: node for node in scene.nodes}
    begins = {motion.id: motion.pos0 for motion in scene.motions}
    for tie in scene.ties:
        apart = _apart(tie, *(nodes[node] for node in tie.nodes), p)
        if apart > APART * max(1.0, *(abs(x) for node in tie.nodes for x in (*nodes[node].position, p[node]))):
            keep = "give `offset:` to keep them apart, or " if tie.what == 0 else ""
            text = (
                f"{WHAT[tie.what]} does not hold at the start: nodes {tie.nodes[0]} and {tie.nodes[1]} differ by "
                f"{apart:.3g}; {keep}let them begin alike"
            )
            yield (*tie.place, "constr"), text
    for coupling in scene.couplings:
        gap, text = coupling_gap(coupling, nodes, p)
        if gap > 0.0:
            yield coupling.place, text
    for node in (node for node in scene.nodes if any(node.functions)):
        for i, function in enumerate(node.functions[:-1]):
            place = value_of(node, i + 1, p)
            if function and abs(begins[function] - place) > APART * max(1.0, abs(place)):
                text = (
                    f"function {function} begins at {begins[function]:.6g}, and the node stands at {place:.6g}: it is "
                    "put where the function begins; give the function that first value"
                )
                yield (*node.place, "BC_functions", i), text


@warning("cable")
def _flow_at_ties(scene: CableScene) -> Sentences:
    """Ties of p through which material does not flow at one rate when a run begins: what is free begins at rest."""
    ties = [tie for tie in scene.ties if tie.what == 1] if scene.motions else []
    if not ties:
        return
    rate_of, kinds = rates_at_start(scene), {node.id: node.kind for node in scene.nodes}
    for tie in ties:
        rates = {node: rate_of(node, kinds[node]) for node in tie.nodes}
        slow, fast = sorted(tie.nodes, key=lambda node: abs(rates[node][0]))
        apart = abs(rates[fast][0] - rates[slow][0])
        # Where both are held the tie does nothing.
        if apart > APART * abs(rates[fast][0]) and not all(held for _, held in rates.values()):
            text = (
                f"material moves at {rates[fast][0]:.3g} m/s at node {fast} when the run begins, and at "
                f"{rates[slow][0]:.3g} m/s at node {slow}, on the other side of the tie. The tie makes both equal at "
                "once, and the forces of the first steps are those of this jump. Couple p of one node to p of the "
                "other by LinearCoupl in place of this tie, or let the speed grow from 0"
            )
            yield tie.place, text


@warning("cable")
def _multipliers_on_what_is_driven(scene: CableScene) -> Sentences:
    """Positions tied by multipliers to a node that follows a function: a change of its speed makes them swing."""
    moving = {one.id for one in scene.motions if any(one.velocities) or one.rate or one.function}
    driven = {one.id for one in scene.nodes if moving.intersection(one.functions[:3])}
    for tie in scene.ties:
        if tie.method == "multiplier" and tie.what == 0 and len(driven.intersection(tie.nodes)) == 1:
            (first,) = driven.intersection(tie.nodes)
            (other,) = set(tie.nodes) - {first}
            text = (
                f"node {first} is driven, and multipliers put node {other} at its place. Where the speed changes fast, "
                f"`multiplier` and the velocity of node {other} swing from step to step about the right values. Axial "
                "forces and energy are right. A LinearCoupl of the positions in place of this tie has none of that"
            )
            yield tie.place, text


def _apart(tie: Tie, first: Node, second: Node, p: dict[int, float]) -> float:
    """Distance of two tied nodes from what their tie wants."""
    if tie.what == 1:
        return abs(p[second.id] - p[first.id])
    if tie.what == 2:
        return math.dist(second.slope or (), first.slope or ())
    return math.dist(chord(first.position, second.position), tie.offset)


@warning("cable")
def _twice(scene: CableScene) -> Sentences:
    """Nodes that are made equal in more than one way."""
    kinds = {node.id: node.kind for node in scene.nodes}
    ways: dict[tuple[frozenset[int], int], list[tuple[str, Place]]] = {}
    for tie in scene.ties:
        ways.setdefault((frozenset(tie.nodes), tie.what), []).append((tie.method, tie.place))
    for coupling in scene.couplings:
        node, dof = coupling.slave
        what = 1 if dof == kinds[node] else 0 if dof <= 3 else 2
        for master, _, _ in coupling.masters:
            entries = ways.setdefault((frozenset((node, master)), what), [])
            if "coupling" not in {method for method, _ in entries}:
                entries.append(("coupling", coupling.place))
    for (pair, what), entries in ways.items():
        if len(entries) > 1 and len(pair) > 1:
            names = " and ".join(map(str, sorted(pair)))
            methods = ", ".join(method for method, _ in entries)
            yield entries[-1][1], f"nodes {names} are tied by {WHAT[what]} more than once ({methods}): keep one"


@warning("cable")
def _stiff_along(scene: CableScene) -> Sentences:
    """Ropes so stiff along themselves that what acts is lost beside it: at the stiffest."""
    text = too_stiff(scene)
    if text:
        yield (*max(scene.elements, key=lambda element: element.EA).place, "EA"), text


@warning("cable")
def _penalties(scene: CableScene) -> Sentences:
    """Springs between r and p so stiff that rounding makes their forces, or so soft that the rope opens at them."""
    sprung = [tie for tie in scene.ties if tie.method != "multiplier" and tie.what != 2]
    if not sprung:
        return
    with np.errstate(all="ignore"):
        stiffest, chosen = stiffest_element(scene), penalty_stiffness(scene)
        gap, force = rounded_gap(scene), largest_force(scene)
    better = _one_digit_below(chosen)
    # What is chosen is chosen for all: it is told of the first.
    left_out = [tie for tie in sprung if tie.stiffness is None and chosen * gap > ROUNDED_SHARE * force][:1]
    for tie in left_out:
        text = (
            f"{chosen:.2g} N/m is chosen, the best beside coordinates as large as here. Rounding of them still changes "
            f"the forces by up to {chosen * gap:.1g} N; {_without_rounding(tie)}"
        )
        yield tie.place, text
    give, loaded = _give(scene), not _carries_nothing(scene)
    stiff: list[tuple[float, Tie, str]] = []
    soft: list[tuple[float, Tie, str]] = []
    for tie in sprung:
        if tie.stiffness is None:
            continue
        stiffness = tie.stiffness
        rope, how = give(tie)
        if stiffness * gap > ROUNDED_SHARE * force:
            # Beside elements without any stiffness there is neither a multiple to tell nor a spring to advise.
            beside = f" is {stiffness / stiffest:.1g} times the stiffest element" if stiffest > 0.0 else ""
            cured = stiffest > 0.0 and better * gap <= ROUNDED_SHARE * force
            cure = f"give {better:.1g}" if cured else _without_rounding(tie)
            text = f"{stiffness:.2g} N/m{beside}: rounding eats the forces, by up to {stiffness * gap:.1g} N; {cure}"
            stiff.append((stiffness, tie, text))
        elif loaded and tie.method == "penalty" and 0.0 < stiffness * rope < 1.0 / SOFT_SHARE:
            more = "" if tie.what == 0 else " So much of it appears or vanishes at the tie."
            text = (
                f"{stiffness:.3g} N/m is soft beside the rope on both sides of the tie. It adds about "
                f"{100.0 / (stiffness * rope):.3g} % to the {how} of that rope.{more} Give "
                f"{1.0 / (SOFT_SHARE * rope):.2g} or more, or use LagMultipl{_kind(tie)}"
            )
            soft.append((1.0 / (stiffness * rope), tie, text))
    yield from _worst_of(stiff, "stiff")
    yield from _worst_of(soft, "soft")


def _worst_of(found: list[tuple[float, Tie, str]], word: str) -> Sentences:
    """The sentence of the worst of some ties, by the size of what is wrong, and how many there are."""
    if not found:
        return
    _, tie, text = max(found, key=lambda one: one[0])
    others = len(found) - 1
    if others:
        text += f". This is the worst of {len(found)} ties that are too {word}"
    yield (*tie.place, "p_spring"), text


def _carries_nothing(scene: CableScene) -> bool:
    """Whether a scene gives its rope nothing to carry: nothing weighs, pulls or moves, and it is drawn as it rests."""
    moved = any(e.conveyed for e in scene.elements) or any(any(node.functions) for node in scene.nodes)
    if moved or given_force(scene) > 0.0 or scene.items_of("TwoNodeSpring"):
        return False
    drawn, lengths = drawn_of(scene), element_lengths(scene)
    slopes = np.concatenate([drawn.first[~drawn.linear], drawn.second[~drawn.linear]])
    straight = np.abs(drawn.first - drawn.second)[~drawn.linear].max(initial=0.0) <= AT_REST
    unstretched = np.abs(arc_lengths(drawn, lengths) / lengths - 1.0).max(initial=0.0) <= AT_REST
    return bool(straight and unstretched and np.abs(np.linalg.norm(slopes, axis=1) - 1.0).max(initial=0.0) <= AT_REST)


def _kind(tie: Tie) -> str:
    """Number at the end of a tie's key: the degrees of freedom of its nodes."""
    return "7" if str(tie.place[-1]).endswith("7") else "4"


def _without_rounding(tie: Tie) -> str:
    """What to do where rounding is felt with any spring."""
    return f"use LagMultipl{_kind(tie)}, or put the origin near the ropes, where coordinates are small"


def _one_digit_below(x: float) -> float:
    """The largest number of one digit that is not above x: what is advised must not itself be told as too stiff."""
    return float(Context(prec=1, rounding=ROUND_FLOOR).create_decimal_from_float(x))


def _give(scene: CableScene) -> Callable[[Tie], tuple[float, str]]:
    """How far a newton moves the rope on both sides of a tie, m/N, and how: by its stretch, else by its bending.

    What has bending stiffness alone is taken as a beam of both sides that is clamped at one end: L^3/(3 EJ).
    """
    lengths = element_lengths(scene).tolist()
    parts = list(zip(scene.elements, lengths, strict=True))
    stretch = sides_of(scene, [length / e.EA if e.EA > 0.0 else 0.0 for e, length in parts])
    # L/EJ^(1/3): of elements in a row their sum counts, and its cube.
    bend = sides_of(scene, [length / math.cbrt(e.EJ) if e.EJ > 0.0 else 0.0 for e, length in parts])

    def of(tie: Tie) -> tuple[float, str]:
        rope = sum(stretch(node) for node in tie.nodes)
        if rope > 0.0 or tie.what != 0:
            return rope, "stretch"
        return sum(bend(node) for node in tie.nodes) ** 3 / 3.0, "bending"

    return of


@warning("cable")
def _slope_penalties(scene: CableScene) -> Sentences:
    """Penalty springs between slopes so soft that the rope has a kink at them. Ropes that do not bend load none."""
    given = [(tie.stiffness, tie) for tie in scene.ties if tie.method == "penalty" and tie.what == 2]
    sprung = [(stiffness, tie) for stiffness, tie in given if stiffness is not None]
    if not sprung or _carries_nothing(scene):
        return
    lengths = element_lengths(scene).tolist()
    # L/EJ, the angle by which 1 N m bends the rope, rad; no moment passes where nothing resists bending.
    bend = sides_of(scene, [n / e.EJ if e.EJ > 0.0 else math.inf for e, n in zip(scene.elements, lengths, strict=True)])
    beside = [(stiffness * sum(bend(node) for node in tie.nodes), stiffness, tie) for stiffness, tie in sprung]
    soft = [
        (1.0 / multiple, tie, _soft_slopes(stiffness, multiple))
        for multiple, stiffness, tie in beside
        if 0.0 < multiple < 1.0 / SOFT_SHARE
    ]
    yield from _worst_of(soft, "soft")


def _soft_slopes(stiffness: float, multiple: float) -> str:
    """What is told of a spring between slopes, N m, that is a multiple of the rope's EJ/L."""
    return (
        f"{stiffness:.3g} N m is soft beside the bending stiffness of the rope on both sides of the tie. It adds about "
        f"{100.0 / multiple:.3g} % to the angle by which that rope bends. Give "
        f"{stiffness / (SOFT_SHARE * multiple):.2g} or more, or use LagMultipl7"
    )


@warning("cable")
def _idle(scene: CableScene) -> Sentences:
    """What is written and has no effect."""
    used = {function for node in scene.nodes for function in node.functions}
    for motion in scene.motions:
        if motion.id not in used:
            yield (*motion.place, "id"), f"no BC_functions names function {motion.id}: it moves nothing"
    for part in scene.nodal:
        yield from asked(item_of(part).warnings, f"warnings of {part.key}", scene, part)
    for motion in scene.motions:
        if motion.velocities and not any(motion.velocities):
            yield (*motion.place, "velocityList"), "is zero throughout: nothing moves"
