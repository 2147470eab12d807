"""Where along the cable each node begins: its material coordinate p."""

from __future__ import annotations

import heapq
import math
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from tautline.cable.input.geometry import COINCIDENT, FARTHEST, Drawn, chord, unstretched_lengths
from tautline.cable.input.parts import CableScene, Element, Place
from tautline.scene.errors import Problem, SceneError
from tautline.scene.model import MADE

COORDINATES, LENGTHS = "material coordinates", "lengths of elements"
"""Where a scene keeps them."""
ALIKE = 1.0e-6
"""Share of its length by which p along an element with a length may be off: positions are rounded."""
SHORTEST = 1.0e-12
"""Length of an element, m, below which it has none."""


def material_coordinates(scene: CableScene) -> dict[int, float]:
    """Material coordinates of all nodes at the start.

    Known are those that nodes give, and of nodes whose p follows a function, its first value. The rest follow along
    the elements, each as long as the scene says or as it lies (`unstretched_lengths`). Between two known nodes the
    lengths are stretched alike, so that the strain is the same in all elements between them. A chain with no known node
    begins where it is tied to one that has: by p = p, else by r = r; if it is tied to none, its first node has p = 0.

    Returns
    -------
    dict of int to float
        Node id -> p, m.

    Raises
    ------
    SceneError
        Where p does not grow along an element, or an element's length cannot be told.
    """
    return dict(_kept(scene)[COORDINATES])


def element_lengths(scene: CableScene) -> np.ndarray:
    """Material in each element at the start (m,), m; raises what `material_coordinates` does."""
    return _kept(scene)[LENGTHS].copy()


def _kept(scene: CableScene) -> dict[str, Any]:
    """What the scene keeps: warnings, checks and the builder ask it a dozen times, and a scene does not change."""
    kept = scene.__dict__.setdefault(MADE, {})
    if COORDINATES not in kept:
        kept[COORDINATES], kept[LENGTHS] = _found(scene)
    return kept


def _found(scene: CableScene) -> tuple[dict[int, float], np.ndarray]:
    """Material coordinates of all nodes, by node id, m, and by how much they grow along each element (m,), m."""
    fixed = known_coordinates(scene)
    nodes = {node.id: node for node in scene.nodes}
    # Of an element between known nodes the length does not matter.
    asked = [element for element in scene.elements if not fixed.keys() >= {*element.nodes}]
    given = np.array([math.nan if element.length is None else element.length for element in asked])
    as_it_lies = [element for element in asked if element.length is None]
    given[np.isnan(given)] = unstretched_lengths(Drawn.of(as_it_lies, nodes))
    drawn = given.tolist()
    problems = [_unknown(scene, element) for element, length in zip(asked, drawn, strict=True) if math.isnan(length)]
    if problems:
        raise SceneError(problems)
    p = dict(fixed)
    if len(p) < len(nodes):
        p |= _along_elements(scene, fixed, {e.id: length for e, length in zip(asked, drawn, strict=True)})
    grown = np.array([p[e.nodes[1]] for e in scene.elements]) - np.array([p[e.nodes[0]] for e in scene.elements])
    wrong = np.flatnonzero(~((grown > SHORTEST) & (grown < FARTHEST))).tolist()
    problems = [_backwards(scene, scene.elements[i], p) for i in wrong] or list(_contradictions(scene, grown))
    if problems:
        raise SceneError(problems)
    return {node.id: p[node.id] for node in scene.nodes}, grown


def _along_elements(scene: CableScene, fixed: dict[int, float], lengths: dict[int, float]) -> dict[int, float]:
    """Coordinates of all nodes from those that are fixed and from the lengths of elements, m, by their ids."""
    chains = _Chains(scene, lengths)
    p = dict(fixed)
    waiting = []
    for chain in chains.all():
        if any(node in fixed for node in chain):
            p |= chains.fill(chain, fixed)
        else:
            waiting.append(chain)
    _fill_from_ties(chains, waiting, _Links(scene), p)
    return p


def known_coordinates(scene: CableScene) -> dict[int, float]:
    """Material coordinates, m, that the scene itself gives, by node id."""
    begins = {motion.id: motion.pos0 for motion in scene.motions}
    known: dict[int, float] = {}
    for node in scene.nodes:
        if node.functions[-1]:
            known[node.id] = begins[node.functions[-1]]
        elif node.p is not None:
            known[node.id] = node.p
    return known


class _Chains:
    """Nodes joined by elements."""

    def __init__(self, scene: CableScene, lengths: dict[int, float]) -> None:
        self.nodes = [node.id for node in scene.nodes]
        self.order = {node: i for i, node in enumerate(self.nodes)}
        self.arms: dict[int, list[tuple[int, float]]] = {node: [] for node in self.nodes}
        self.joined: dict[int, list[int]] = {node: [] for node in self.nodes}
        self.ends = {element.nodes[1] for element in scene.elements}
        joined, arms = self.joined, self.arms
        for element in scene.elements:
            first, second = element.nodes
            joined[first].append(second)
            joined[second].append(first)
            if (length := lengths.get(element.id)) is not None:
                arms[first].append((second, length))
                arms[second].append((first, -length))

    def all(self) -> Iterator[list[int]]:
        """Connected chains, each as its nodes in the scene's order."""
        seen: set[int] = set()
        for node in self.nodes:
            if node in seen:
                continue
            queue, chain = deque([node]), {node}
            while queue:
                for other in self.joined[queue.popleft()]:
                    if other not in chain:
                        chain.add(other)
                        queue.append(other)
            seen |= chain
            yield sorted(chain, key=self.order.__getitem__)

    def start(self, chain: list[int]) -> int:
        """Return the node where the material begins: no element ends there."""
        return next((node for node in chain if node not in self.ends), chain[0])

    def fill(self, chain: list[int], fixed: dict[int, float]) -> dict[int, float]:
        """Coordinates of a chain's nodes, some of which are fixed."""
        p = {node: fixed[node] for node in chain if node in fixed}
        queue = deque(p)
        several = len(p) > 1
        while queue:
            node = queue.popleft()
            for other, length in self.arms[node]:
                if other not in p:
                    p[other] = p[node] + length
                    queue.append(other)
        return self._even(p, fixed) if several and len(p) > sum(node in fixed for node in p) else p

    def _even(self, p: dict[int, float], fixed: dict[int, float]) -> dict[int, float]:
        """Spread what the lengths lack between fixed nodes in proportion: springs of stiffness 1/L in equilibrium."""
        import numpy as np
        from scipy.sparse import coo_array
        from scipy.sparse.linalg import spsolve

        free = {node: i for i, node in enumerate(node for node in p if node not in fixed)}
        rows, columns, entries = [], [], []
        force = np.zeros(len(free))
        for node, i in free.items():
            for other, length in self.arms[node]:
                stiffness = 1.0 / abs(length)
                force[i] += stiffness * (p[other] - length - p[node])
                for column, entry in ((node, stiffness), (other, -stiffness)):
                    if column in free:
                        rows.append(i)
                        columns.append(free[column])
                        entries.append(entry)
        if not np.any(np.abs(force) > 1e-13 * max(1.0, *map(abs, p.values()))):
            return p
        matrix = coo_array((entries, (rows, columns)), shape=(len(free), len(free))).tocsc()
        shift = np.atleast_1d(spsolve(matrix, force))
        return p | {node: p[node] + float(shift[i]) for node, i in free.items()}


class _Links:
    """What makes p of two nodes equal, or lets a chain begin where another one is: p = p before r = r."""

    def __init__(self, scene: CableScene) -> None:
        kinds = {node.id: node.kind for node in scene.nodes}
        links: tuple[list[tuple[int, int, float]], ...] = ([], [])
        for tie in scene.ties:
            if tie.what in (0, 1):
                links[1 - tie.what].append((*tie.nodes, 0.0))
        for coupling in scene.couplings:
            (slave, dof), (master, followed, factor) = coupling.slave, coupling.masters[0]
            if len(coupling.masters) > 1 or factor != 1.0 or slave == master:
                continue
            if dof == kinds[slave] and followed == kinds[master]:
                links[0].append((slave, master, coupling.f0))
            elif dof == followed and dof <= 3:
                links[1].append((slave, master, 0.0))
        self.links = [*links[0], *links[1]]
        self.at: dict[int, list[int]] = defaultdict(list)
        for number, (first, second, _) in enumerate(self.links):
            self.at[first].append(number)
            self.at[second].append(number)

    def beside(self, node: int) -> Iterator[int]:
        """Nodes that a node is linked to."""
        for number in self.at.get(node, ()):
            first, second, _ = self.links[number]
            yield second if first == node else first

    def start(self, chain: list[int], p: dict[int, float]) -> tuple[int, float] | None:
        """Return a node of a chain that is tied to one whose p is known, and the p that it takes from there."""
        own = set(chain)
        for number in sorted({number for node in chain for number in self.at.get(node, ())}):
            first, second, offset = self.links[number]
            if first in own and second in p:
                return first, p[second] + offset
            if second in own and first in p:
                return second, p[first] - offset
        return None


def _fill_from_ties(chains: _Chains, waiting: list[list[int]], links: _Links, p: dict[int, float]) -> None:
    """Give chains without a known node their coordinates: the first that is tied to a known one, else the first.

    Each chain is looked at once, and a tie when one of its ends becomes known.
    """
    place = {node: i for i, chain in enumerate(waiting) for node in chain}
    tied: list[int] = []

    def note(nodes: Iterable[int]) -> None:
        for node in nodes if links.links else ():
            for other in links.beside(node):
                if other in place and other not in p:
                    heapq.heappush(tied, place[other])

    note(list(p))
    left = dict.fromkeys(range(len(waiting)))
    while left:
        while tied and tied[0] not in left:
            heapq.heappop(tied)
        number = heapq.heappop(tied) if tied else next(iter(left))
        del left[number]
        chain = waiting[number]
        node, value = links.start(chain, p) or (chains.start(chain), 0.0)
        filled = chains.fill(chain, {node: value})
        p |= filled
        note(filled)


def _contradictions(scene: CableScene, grown: np.ndarray) -> Iterator[Problem]:
    """Cables with a length that p at their ends contradicts: another cable, or a function, has made it.

    ``grown`` is by how much p grows along each element (m,), m.
    """
    given = np.array([math.nan if element.length is None else element.length for element in scene.elements])
    told: set[Place] = set()
    for i in np.flatnonzero(np.abs(grown - given) > ALIKE * given).tolist():
        place = scene.elements[i].place
        if place in told:
            continue
        told.add(place)
        own = [j for j, element in enumerate(scene.elements) if element.place == place]
        length, has = float(given[own].sum()), float(grown[own].sum())
        cause = (
            f"is {length:.6g} m, and p at its ends differs by {has:.6g} m: another cable or function leads there too"
        )
        cure = "end this cable at a node of its own, and tie its r to the other with LinearCoupl or LagMultipl7"
        yield scene.problem((*place, "length"), cause, cure)


def _unknown(scene: CableScene, element: Element) -> Problem:
    nodes = {node.id: node for node in scene.nodes}
    first, second = element.nodes
    key = nodes_key(element)
    apart = math.hypot(*chord(nodes[first].position, nodes[second].position))
    if apart >= FARTHEST:
        cause = f"nodes {first} and {second} are {apart:.3g} m apart: no element is that long"
        return scene.problem((*element.place, key), cause, "give positions in m, such as [0.5, 0, 0]")
    if apart <= COINCIDENT:
        cause = f"nodes {first} and {second} stand at one point: the element has no length"
        return scene.problem((*element.place, key), cause, "move one of them, or give both a `p:`")
    cause = f"the slopes of nodes {first} and {second} are too long: no length of the element fits its arc"
    return scene.problem((*element.place, key), cause, "give xyz_d as unit vectors, or give both nodes a `p:`")


def _backwards(scene: CableScene, element: Element, p: dict[int, float]) -> Problem:
    """What is wrong with an element along which p, by node id, m, does not grow, or grows out of all measure."""
    first, second = element.nodes
    if p[second] > p[first]:
        cause = f"p goes from {p[first]:g} m at node {first} to {p[second]:g} m at node {second}: "
        cause += "no element is that long" if p[second] - p[first] > 1.0 else "nothing is left of the element"
        return scene.problem((*element.place, nodes_key(element)), cause, "put right `p:` or pos0, in m")
    cause = f"p goes from {p[first]:g} m at node {first} to {p[second]:g} m at node {second}: it must grow"
    if _leads_to(scene, second, first):
        cause += f", and the elements lead round from node {second} to node {first} again: the cable is a ring"
        number, slopes = ("7", " and, for a smooth ring, r' (constr: 2)") if element.kind == "cubic" else ("4", "")
        cure = (
            f"a ring ends where it begins at a node of its own: let one of its elements end at a new node that stands "
            f"where the next one begins, and tie r (LagMultipl{number} with constr: 0){slopes} of the two"
        )
        return scene.problem((*element.place, nodes_key(element)), cause, cure)
    cure = f"swap the element's nodes, or put right `p:` and pos0 so that node {second} has the larger"
    return scene.problem((*element.place, nodes_key(element)), cause, cure)


def _leads_to(scene: CableScene, start: int, aim: int) -> bool:
    """Whether elements lead from a node to another, each gone along from its first node to its second."""
    ahead: dict[int, list[int]] = defaultdict(list)
    for element in scene.elements:
        ahead[element.nodes[0]].append(element.nodes[1])
    reached, open_ends = {start}, [start]
    while open_ends and aim not in reached:
        new = set(ahead[open_ends.pop()]) - reached
        reached |= new
        open_ends += new
    return aim in reached


def nodes_key(element: Element) -> str:
    """Key under which an element names its nodes."""
    return "nodes7" if element.kind == "cubic" else "nodes4"
