"""Elements of a scene divided anew: other nodes on the curve that the scene draws, and what holds them.

A run is a row of like elements between two nodes that something else refers to: a support, a load, a tie. What stands
between these is mesh, and may be cut and joined at will. A new node stands on the cubic (or chord) of the element that
it cuts, where its material coordinate is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import CableScene, Coupling, Curve, Dof, Element, Node, Vector
from tautline.cable.model.layout import Layout

SAME = 1.0e-9
"""Difference of factors, or relative of coordinates, below which two couplings say the same."""

Place = tuple[int, float]
"""A place on a run: number of the element, from zero, and the share of it that lies before."""
Form = tuple[dict[Dof, float], float]
"""A degree of freedom in terms of others that are no slaves: their factors, and a constant."""


class Chart:
    """A scene with what its elements are to each other.

    Attributes
    ----------
    scene : CableScene
    p : dict
        Material coordinate of each node at the start, m.
    layout : Layout
    nodes : dict
        Nodes by their ids.
    """

    def __init__(self, scene: CableScene) -> None:
        self.scene = scene
        self.p = material_coordinates(scene)
        self.layout = Layout(scene, self.p, 1.0, 1.0)
        self.nodes = {node.id: node for node in scene.nodes}
        self.slaves = {coupling.slave: coupling for coupling in scene.couplings}

    def length(self, element: Element) -> float:
        """Unstretched length of an element, m."""
        return self.p[element.nodes[1]] - self.p[element.nodes[0]]

    def begin(self, node: int) -> np.ndarray:
        """Position and, of a cubic node, slope at the start, (2, 3) or (1, 3), with what is driven where it begins."""
        start, kind = self.layout.start[node], self.layout.kind[node]
        return np.array(self.layout.initial[start : start + kind - 1]).reshape(-1, 3)

    def form(self, dof: Dof) -> Form:
        """What a degree of freedom is in terms of those that are no slaves."""
        coupling = self.slaves.get(dof)
        if coupling is None:
            return {dof: 1.0}, 0.0
        factors, constant = self.sum_of([((node, number), factor) for node, number, factor in coupling.masters])
        return factors, constant + coupling.f0

    def sum_of(self, terms: Iterable[tuple[Dof, float]]) -> Form:
        """Sum of factors times degrees of freedom."""
        total: dict[Dof, float] = {}
        constant = 0.0
        for dof, factor in terms:
            masters, offset = self.form(dof)
            constant += factor * offset
            for master, share in masters.items():
                total[master] = total.get(master, 0.0) + factor * share
        return {dof: factor for dof, factor in total.items() if factor != 0.0}, constant


class Run(NamedTuple):
    """A row of like elements, and the ids of its nodes: one more."""

    elements: tuple[Element, ...]
    nodes: tuple[int, ...]


class Joint(NamedTuple):
    """What holds a node of the mesh: flags as a node has them, and what its slaves, numbered from one, follow."""

    held: tuple[bool, ...]
    slaves: dict[int, Form]


def weights(cubic: bool, x: float, length: float) -> np.ndarray:
    """How position and slope at a share of an element follow those of its ends.

    Returns
    -------
    (2, 2, 2) array
        By what it is of (r, r'), by end, by what is there of (r, r'); (1, 2, 1) of a linear element.
    """
    if not cubic:
        return np.array([[[1.0 - x], [x]]])
    value = [[1.0 - 3.0 * x**2 + 2.0 * x**3, length * (x - 2.0 * x**2 + x**3)],
             [3.0 * x**2 - 2.0 * x**3, length * (x**3 - x**2)]]  # fmt: skip
    slope = [[6.0 * (x**2 - x) / length, 1.0 - 4.0 * x + 3.0 * x**2], [6.0 * (x - x**2) / length, 3.0 * x**2 - 2.0 * x]]
    return np.array([value, slope])


def joint_between(chart: Chart, first: int, second: int, x: float) -> Joint:
    """What holds a node that cuts the element between two.

    Along an axis in which nothing of the element can move by itself, nothing of the node can: a bar that stays on its
    line is cut into bars that stay there. Where that is so of all three axes the element lies between two clamps, and
    what is cut out of it is free. Its p is held if those of both ends are, or keeps its share between them.
    """
    kind, layout = chart.layout.kind[first], chart.layout
    places = [layout.start[first], layout.start[second]]
    orders = range(2 if kind == 7 else 1)
    axes = [c for c in range(3) if all(layout.is_held(place + 3 * k + c) for place in places for k in orders)]
    held, slaves = [False] * kind, {}
    share = weights(kind == 7, x, chart.p[second] - chart.p[first])
    for c in axes if len(axes) < 3 else ():
        still = all(layout.is_still(place + 3 * k + c) for place in places for k in orders)
        for k in orders:
            ends = [(node, m, float(share[k, e, m])) for e, node in enumerate((first, second)) for m in orders]
            if still:
                held[3 * k + c] = True
            else:
                slaves[3 * k + c + 1] = chart.sum_of([((node, 3 * m + c + 1), factor) for node, m, factor in ends])
    p = _material(chart, first, second, x)
    if p is None:
        held[-1] = True
    else:
        slaves[kind] = p
    return Joint(tuple(held), slaves)


def _material(chart: Chart, first: int, second: int, x: float) -> Form | None:
    """What the p of a node between two follows; None where it stays."""
    layout, ends = chart.layout, [(node, chart.layout.kind[node]) for node in (first, second)]
    one, other = (layout.material(node) for node in (first, second))
    if layout.is_still(one) and layout.is_still(other):
        return None
    if layout.rate_of(one) == layout.rate_of(other):
        # Both go on alike: so does what is between them, and the builder sees it.
        factors, constant = chart.form(ends[0])
        return factors, constant + x * (chart.p[second] - chart.p[first])
    return chart.sum_of([(ends[0], 1.0 - x), (ends[1], x)])


def runs_of(chart: Chart) -> list[Run]:
    """All elements of a scene as runs, in the scene's order of their first ones."""
    scene = chart.scene
    after: dict[int, list[Element]] = {}
    before: dict[int, list[Element]] = {}
    for element in scene.elements:
        after.setdefault(element.nodes[0], []).append(element)
        before.setdefault(element.nodes[1], []).append(element)
    spoken = _spoken_of(scene)
    inner = {
        node.id
        for node in scene.nodes
        if node.id not in spoken and _is_mesh(chart, node, before.get(node.id, []), after.get(node.id, []))
    }
    runs, seen = [], set()
    for element in scene.elements:
        if element.id in seen:
            continue
        row = [element]
        while row[0].nodes[0] in inner:
            row.insert(0, before[row[0].nodes[0]][0])
        while row[-1].nodes[1] in inner:
            row.append(after[row[-1].nodes[1]][0])
        seen.update(one.id for one in row)
        runs.append(Run(tuple(row), (row[0].nodes[0], *(one.nodes[1] for one in row))))
    return runs


def _spoken_of(scene: CableScene) -> set[int]:
    """Nodes that something else than elements and their own couplings refers to."""
    parts = (*scene.ties, *scene.nodal)
    named = {node for part in parts for node in part.nodes}
    named |= {master[0] for coupling in scene.couplings for master in coupling.masters}
    named |= {curve.node for panel in scene.plots for curve in panel if curve.node is not None}
    return named | {node.id for node in scene.nodes if any(node.functions)}


def _is_mesh(chart: Chart, node: Node, before: Sequence[Element], after: Sequence[Element]) -> bool:
    """Whether a node is what cutting one element into two would have put there."""
    if len(before) != 1 or len(after) != 1 or not _alike(before[0], after[0]):
        return False
    first, second = before[0].nodes[0], after[0].nodes[1]
    x = (chart.p[node.id] - chart.p[first]) / (chart.p[second] - chart.p[first])
    held, slaves = joint_between(chart, first, second, x)
    own = {number: chart.form((id, number)) for id, number in chart.slaves if id == node.id}
    return node.held == held and own.keys() == slaves.keys() and all(_same(own[k], slaves[k]) for k in own)


def _alike(one: Element, other: Element) -> bool:
    """Whether two elements are pieces of the same rope."""
    same = {"id": 0, "nodes": (0, 0), "line": 0, "place": ()}
    return one._replace(**same) == other._replace(**same)


def _same(one: Form, other: Form) -> bool:
    dofs = one[0].keys() | other[0].keys()
    apart = [abs(one[0].get(dof, 0.0) - other[0].get(dof, 0.0)) for dof in dofs]
    return max(apart, default=0.0) <= SAME and abs(one[1] - other[1]) <= SAME * max(1.0, abs(one[1]))


def divided(chart: Chart, plan: Iterable[tuple[Run, Sequence[Place]]]) -> CableScene:
    """Scene with runs divided anew.

    Parameters
    ----------
    chart : Chart
        Of the scene.
    plan : pairs of Run and sequence of Place
        Where the nodes of a run are to stand, from ``(0, 0.0)`` to ``(number of elements, 0.0)``.

    Returns
    -------
    CableScene
        Nodes and elements that stay keep their ids and their order; new ones stand between those that they are between.
        Every node says its p, where no function does.

    Raises
    ------
    SceneError
        Where nothing is left of an element.
    """
    scene = chart.scene
    made = _Division(chart)
    for run, places in plan:
        made.divide(run, places)
    varied = replace(
        scene,
        nodes=made.all_nodes(),
        elements=made.all_elements(),
        couplings=(*(c for c in scene.couplings if c.slave[0] not in made.gone), *made.couplings),
        plots=tuple(tuple(made.renaming(curve) for curve in panel) for panel in scene.plots),
    )
    material_coordinates(varied)
    return varied


class _Division:
    """What changes of a scene while its runs are divided: new parts by the one they come after, and what is gone."""

    def __init__(self, chart: Chart) -> None:
        scene = chart.scene
        self.chart = chart
        self.order = {node.id: i for i, node in enumerate(scene.nodes)}
        self.nodes: dict[int, list[Node]] = {}
        self.elements: dict[int, list[Element]] = {}
        self.couplings: list[Coupling] = []
        self.gone: set[int] = set()
        self.pieces: dict[int, Element] = {}
        self.renamed: dict[int, int] = {}
        self.drawn = {curve.cable for panel in scene.plots for curve in panel}
        self.next = Counter(
            node=1 + max(node.id for node in scene.nodes),
            element=1 + max(element.id for element in scene.elements),
            coupling=1 + max((coupling.id for coupling in scene.couplings), default=-1),
        )

    def _number(self, kind: str) -> int:
        self.next[kind] += 1
        return self.next[kind] - 1

    def divide(self, run: Run, places: Sequence[Place]) -> None:
        """Put nodes at places of a run, and elements between them."""
        nodes = [run.nodes[k] if x == 0.0 else self._node(run.elements[k], x) for k, x in places]
        self.gone |= set(run.nodes) - set(nodes)
        free = {k: element.id for k, element in enumerate(run.elements)}
        owner: dict[int, int] = {}
        last = run.elements[0].id
        for ends, (begin, end) in zip(pairwise(nodes), pairwise(places), strict=True):
            within = range(begin[0], end[0] + (end[1] > 0.0))
            # An element that a plot draws goes on under its name.
            known = sorted((k for k in within if k in free), key=lambda k: (free[k] not in self.drawn, k))
            id = free.pop(known[0]) if known else self._number("element")
            owner |= {k: id for k in within if begin[0] + begin[1] <= k + 0.5 < end[0] + end[1]}
            piece = run.elements[begin[0]]._replace(id=id, nodes=ends, length=None)
            if known:
                self.pieces[id] = piece
                last = id
            else:
                self.elements.setdefault(last, []).append(piece)
        self.renamed |= {id: owner[k] for k, id in free.items()}

    def _node(self, element: Element, x: float) -> Node:
        """A new node at a share of an element."""
        chart, (first, second) = self.chart, element.nodes
        kind, id = chart.layout.kind[first], self._number("node")
        length = chart.length(element)
        ends = np.array([chart.begin(node) for node in (first, second)])
        position, *slope = np.einsum("kem,emc->kc", weights(kind == 7, x, length), ends)
        joint = joint_between(chart, first, second, x)
        for number, (factors, constant) in joint.slaves.items():
            masters = tuple((*dof, factor) for dof, factor in factors.items())
            self.couplings.append(
                Coupling(self._number("coupling"), (id, number), constant, masters, element.line, element.place)
            )
        made = Node(
            id=id, kind=chart.nodes[first].kind, position=_vector(position), slope=_vector(slope[0]) if slope else None,
            p=chart.p[first] + x * length, held=joint.held, functions=(0,) * kind, line=element.line,
            place=element.place,
        )  # fmt: skip
        forwards = self.order[first] < self.order[second]
        beside = self.nodes.setdefault(first if forwards else second, [])
        beside.insert(len(beside) if forwards else 0, made)
        return made.id

    def all_nodes(self) -> tuple[Node, ...]:
        """Nodes of the new scene."""
        made: list[Node] = []
        for node in self.chart.scene.nodes:
            if node.id not in self.gone:
                made.append(node if node.functions[-1] else node._replace(p=self.chart.p[node.id]))
            made += self.nodes.get(node.id, [])
        return tuple(made)

    def all_elements(self) -> tuple[Element, ...]:
        """Elements of the new scene."""
        made: list[Element] = []
        for element in self.chart.scene.elements:
            if element.id not in self.renamed:
                made += [self.pieces.get(element.id, element), *self.elements.get(element.id, [])]
        return tuple(made)

    def renaming(self, curve: Curve) -> Curve:
        """A curve of the element that is now where the one was that it drew."""
        return replace(curve, cable=self.renamed[curve.cable]) if curve.cable in self.renamed else curve


def _vector(values: np.ndarray) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
