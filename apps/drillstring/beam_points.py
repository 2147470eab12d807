"""Where the hole acts on a beam: at its nodes and at points of its elements, each for the length that belongs to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillstring.in_hole import MOST, PIECE, POINT, Hole
from drillstring.string import Lumps, Tube
from drillstring.wellbore import Wellbore
from tautline.elements.cubic import MATERIAL
from tautline.kernels.hermite import SHAPE, table
from tautline.lumped.curve import records

NODE = 8
"""Degrees of freedom of a node: r, r', p, theta."""
TURN = 7
"""Place of theta among them."""
CONTACT_POINTS = 1
"""Points of contact inside an element where the scene does not say how many."""
assert TURN == MATERIAL + 1


@dataclass(frozen=True)
class Nodes:
    """Where the nodes of a mesh begin in the full vectors.

    Where a section ends, two nodes stand at one place, for there the slope jumps: ``twins`` (k, 2) has the further one
    and the one it belongs to, and the element below has the further one. ``a`` and ``b`` (n,) are the nodes of the
    elements; the nodes of the mesh itself are at multiples of NODE.
    """

    a: np.ndarray
    b: np.ndarray
    twins: np.ndarray
    count: int


def nodes_of(mesh: Lumps) -> Nodes:
    """Nodes of a string's mesh."""
    n = mesh.length.size
    changes = np.flatnonzero(np.diff(mesh.section)) + 1
    twins = np.column_stack([NODE * (n + 1 + np.arange(changes.size)), NODE * changes])
    first = NODE * np.arange(n)
    a = first.copy()
    a[changes] = twins[:, 0]
    return Nodes(a, first + NODE, twins, n + 1 + changes.size)


@dataclass(frozen=True)
class Points:
    """Points of a string from the top down.

    ``element`` (n,) and ``place`` (n,), 0 to 1, say where on the mesh a point is; ``halves`` (n, sections) how many
    metres of each section belong to it.
    """

    mesh: Lumps
    element: np.ndarray
    place: np.ndarray
    halves: np.ndarray

    @property
    def length(self) -> np.ndarray:
        """Length that belongs to each point, (n,) m."""
        return self.halves.sum(axis=1)

    def of(self, per_length: Callable[[Tube], float]) -> np.ndarray:
        """A quantity per metre of section, summed over the metres that belong to each point, (n,)."""
        return self.halves @ np.array([per_length(tube) for tube in self.mesh.tubes], dtype=float)

    def largest(self, value: Callable[[Tube], float]) -> np.ndarray:
        """Largest of a quantity among the sections that a point belongs to, (n,)."""
        values = np.array([value(tube) for tube in self.mesh.tubes], dtype=float)
        return np.where(self.halves > 0.0, values, -np.inf).max(axis=1)

    def _some(self, which: np.ndarray) -> Points:
        return Points(self.mesh, self.element[which], self.place[which], self.halves[which])

    def below_the_top(self) -> Points:
        """All but the first, which hangs in the drive."""
        return self._some(np.arange(1, self.element.size))

    def at_nodes(self, nodes: np.ndarray) -> Points:
        """Those that are nodes of the mesh, by the nodes' numbers."""
        each = np.flatnonzero((self.place == 0.0) | (self.place == 1.0))
        return self._some(each[nodes])

    def to_nodes(self, values: np.ndarray) -> np.ndarray:
        """Forces at the points (..., n), shared by lever between the nodes of their element, (..., nodes)."""
        out = np.zeros((*values.shape[:-1], self.mesh.length.size + 1))
        np.add.at(out, (..., self.element), values * (1.0 - self.place))
        np.add.at(out, (..., self.element + 1), values * self.place)
        return out


def points_of(mesh: Lumps, inside: int) -> Points:
    """The nodes, and so many points evenly spaced inside each element."""
    n = mesh.length.size
    per = inside + 1
    element = np.append(np.repeat(np.arange(n), per), n - 1)
    place = np.append(np.tile(np.arange(per) / per, n), 1.0)
    halves = np.zeros((n * per + 1, len(mesh.tubes)))
    for piece in range(n * per):
        k, metres = mesh.section[piece // per], mesh.length[piece // per] / per
        halves[piece, k] += 0.5 * metres
        halves[piece + 1, k] += 0.5 * metres
    return Points(mesh, element, place, halves)


def hole_of(well: Wellbore, points: Points) -> Hole:
    """The hole as compiled code reads it, with the straight piece above the rotary table as its first arc."""
    count = well.k1.size
    arcs = records(count + 1, PIECE)
    table_of = {
        "start": well.md, "k1": well.k1, "k2": well.k2, "origin": well.positions, "m1": well.m1s, "m2": well.m2s,
        "t": well.tangents,
    }  # fmt: skip
    for name, values in table_of.items():
        arcs[name][1:] = values[:count]
        if name not in ("k1", "k2"):
            arcs[name][0] = values[0]
    rows, nodes = records(points.element.size, POINT), nodes_of(points.mesh)
    for i, (e, x) in enumerate(zip(points.element, points.place, strict=True)):
        if x in (0.0, 1.0):
            node = NODE * (int(e) + int(x))
            rows["vectors"][i], rows["turns"][i] = 1, 1
            rows["place"][i, 0], rows["weight"][i, 0] = node, 1.0
            rows["turn"][i, 0], rows["share"][i, 0] = node + TURN, 1.0
            continue
        shape = table(np.array([x]), np.ones(1))[0, SHAPE : SHAPE + MOST]
        a, b, length = nodes.a[e], nodes.b[e], points.mesh.length[e]
        rows["vectors"][i], rows["turns"][i] = MOST, 2
        rows["place"][i], rows["weight"][i] = (a, a + 3, b, b + 3), shape * (1.0, length, 1.0, length)
        rows["turn"][i], rows["share"][i] = (a + TURN, b + TURN), (1.0 - x, x)
    return Hole(arcs, rows)
