"""How a cable scene is varied for a study: finer or coarser elements, other stiffness and constraints, a sliver.

Each function takes a scene and returns another, of parts as a file could have given them and with the document of the
first; the scene given stays as it is.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from typing import Any

from tautline.cable.input.parts import CableScene, Element, Tie
from tautline.cable.input.syntax.nodal import NodalPart
from tautline.cable.model.magnitudes import penalty_stiffness
from tautline.cable.study.refinement import Chart, Place, divided, runs_of
from tautline.scene.errors import SceneError
from tautline.study.robustness.bar import Bar

METHODS: dict[str, Any] = {"lagrange": "multiplier", "penalty": "penalty", "augmented": "augmented"}
"""Methods of ties by the names of the ways in which constraints can be imposed."""
MIXED = "as written"
"""The way of a scene whose ties are not all of one method."""
ALONG = 1.0e-6
"""Component of a slope below which an axis is across the rope."""
DIGITS = 9
"""Of the lengths and speeds of two elements that are alike."""


def elements(scene: CableScene, factor: float) -> CableScene | None:
    """Divide every run of like elements into ``factor`` times as many, at least one; None if that changes nothing.

    Nodes that a load, a tie, a support or a plot refers to stay, and the new ones stand on the curve between them.

    Raises
    ------
    SceneError
        Where nothing would be left of an element.
    """
    chart = Chart(scene)
    plan = []
    for run in runs_of(chart):
        n = len(run.elements)
        wanted = max(1, math.floor(n * factor + 0.5))
        if wanted != n:
            shares = [divmod(k * n, wanted) for k in range(wanted + 1)]
            plan.append((run, [(whole, rest / wanted) for whole, rest in shares]))
    return divided(chart, plan) if plan else None


def stiffness(scene: CableScene, factor: float) -> CableScene:
    """Axial and bending stiffness of all elements times ``factor``."""
    stiffer = (element._replace(EA=factor * element.EA, EJ=factor * element.EJ) for element in scene.elements)
    return replace(scene, elements=tuple(stiffer))


def contact(scene: CableScene, value: float) -> CableScene | None:
    """Stiffness of the springs that hold nodes to where they began, N/m; None without any."""
    if not scene.anchors:
        return None

    def stiff(part: NodalPart) -> NodalPart:
        return replace(part, model=part.model.model_copy(update={"stiffness": float(value)}))

    return replace(scene, nodal=tuple(stiff(one) if one.key == "OneNodeSpring" else one for one in scene.nodal))


def penalty(scene: CableScene, value: float) -> CableScene | None:
    """Stiffness of penalty springs, with multipliers or without, N/m; None without any.

    Those between slopes take it times the square of the shortest element's length at their nodes, as the builder does.
    """
    if not any(_is_sprung(tie) for tie in scene.ties):
        return None
    chart = Chart(scene)
    ties = (
        replace(tie, stiffness=float(value) * _square(chart, tie)) if _is_sprung(tie) else tie for tie in scene.ties
    )
    return replace(scene, ties=tuple(ties))


def shortest(scene: CableScene, factor: float) -> CableScene:
    """Cut the last element of the file in two, of which the second is ``factor`` times shorter than the shortest.

    Raises
    ------
    SceneError
        If nothing would be left of one of them.
    """
    chart = Chart(scene)
    last = scene.elements[-1]
    sliver = min(chart.length(element) for element in scene.elements) / factor
    x = 1.0 - sliver / chart.length(last)
    if not 0.0 < x < 1.0:
        cause = f"nothing is left of its {chart.length(last):.4g} m if {sliver:.4g} m are cut off"
        raise SceneError([scene.problem(last.place, cause, "cut off less, but more than zero")])
    run = next(run for run in runs_of(chart) if last in run.elements)
    places: list[Place] = [(k, 0.0) for k in range(len(run.nodes))]
    at = run.elements.index(last)
    return divided(chart, [(run, [*places[: at + 1], (at, x), *places[at + 1 :]])])


def constraints(scene: CableScene) -> tuple[str, ...]:
    """Ways to impose the scene's ties, its own first: ``as written`` where they are of several; none without ties."""
    methods = {tie.method for tie in scene.ties}
    if not methods:
        return ()
    own = MIXED if len(methods) > 1 else next(name for name, method in METHODS.items() if method in methods)
    return (own, *(name for name in METHODS if name != own))


def constraint(scene: CableScene, name: str) -> CableScene | None:
    """Impose all ties in one way, None without ties; springs keep the stiffness that the scene gives them.

    Raises
    ------
    SceneError
        If it is no such way.
    """
    if not scene.ties:
        return None
    if name == MIXED:
        return scene
    if name not in METHODS:
        known = ", ".join(constraints(scene))
        raise SceneError([scene.problem(("CableModel",), f"ties cannot be imposed by '{name}'", f"known: {known}")])
    method = METHODS[name]
    ties = (
        replace(tie, method=method, stiffness=None if method == "multiplier" else tie.stiffness) for tie in scene.ties
    )
    return replace(scene, ties=tuple(ties))


def stiffnesses(scene: CableScene) -> dict[str, float | None]:
    """Largest stiffness of springs to where nodes began, and of penalty springs, N/m, as :func:`penalty` takes it."""
    found: list[float] = []
    sprung = [tie for tie in scene.ties if _is_sprung(tie)]
    if sprung:
        chart = Chart(scene)
        found = [tie.stiffness / _square(chart, tie) for tie in sprung if tie.stiffness is not None]
        if len(found) < len(sprung):
            found.append(penalty_stiffness(scene))
    anchored = max((anchor.model.stiffness for anchor in scene.anchors), default=None)
    return {"contact": anchored, "penalty": max(found, default=None)}


def bars(scene: CableScene) -> list[Bar]:
    """One of every kind of unlike elements along which sound runs: that have mass, and stiffness along them."""
    chart = Chart(scene)
    uses = Counter(node for element in scene.elements for node in element.nodes)
    tied = {node for tie in scene.ties if tie.what == 0 for node in tie.nodes}
    for coupling in scene.couplings:
        if coupling.slave[1] <= 3:
            tied |= {coupling.slave[0], *(master[0] for master in coupling.masters)}
    kinds: dict[tuple, list[Element]] = {}
    for element in scene.elements:
        if element.EA > 0.0 and element.rhoA > 0.0:
            ends = [node for node in element.nodes if uses[node] == 1 and node not in tied]
            free = any(_moves_along(chart, element, node) for node in ends)
            length, speed = chart.length(element), math.sqrt(element.EA / element.rhoA)
            key = _shape(element), f"{length:.{DIGITS}g}", f"{speed:.{DIGITS}g}", free
            kinds.setdefault(key, []).append(element)
    made = []
    for (shape, _, _, free), alike in kinds.items():
        length, speed = chart.length(alike[0]), math.sqrt(alike[0].EA / alike[0].rhoA)
        more = f" and {len(alike) - 1} more" if len(alike) > 1 else ""
        made.append(Bar(f"element {alike[0].id}{more} of {length:.4g} m", length, speed, shape, free))
    return made


def _shape(element: Element) -> str:
    """Name of an element's shape for `Bar`: one that bends takes Lobatto points along itself, unless it is told."""
    if element.kind == "linear":
        return "linear"
    return "bent" if (element.quadrature or ("lobatto" if element.EJ > 0.0 else "gauss")) == "lobatto" else "cubic"


def _is_sprung(tie: Tie) -> bool:
    return tie.method != "multiplier"


def _square(chart: Chart, tie: Tie) -> float:
    """What a tie's stiffness is to that of one between positions: 1, or between slopes a length squared, m^2."""
    if tie.what != 2:
        return 1.0
    lengths = [chart.length(element) for element in chart.scene.elements if set(element.nodes) & set(tie.nodes)]
    return min(lengths, default=1.0) ** 2


def _moves_along(chart: Chart, element: Element, node: int) -> bool:
    """Whether a node may move along an element that ends there."""
    first, second = (chart.begin(end) for end in element.nodes)
    along = chart.begin(node)[1] if element.kind == "cubic" else (second - first)[0] / chart.length(element)
    start = chart.layout.start[node]
    return any(abs(along[c]) > ALONG and not chart.layout.is_held(start + c) for c in range(3))
