"""Where the hole acts on a beam: at two points of every element and at the bit, each for the length belonging to it.

They are the middles of the halves of an element, so that all spans between them are half an element long. With the bit
there are as many of them as the beam has unknowns in a direction. Fewer, at nodes and halfway say, leave the slopes
free to swing against each other along the string, where no friction ever stops them; more make friction indeterminate,
as the feet of a table with four legs; and points at uneven distances leave spans that sag out of the hole.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillstring.string.lumps import Lumps, Tube
from drillstring.well.in_hole import MOST, PIECE, POINT, Hole
from drillstring.well.wellbore import Wellbore
from tautline.elements.cubic import MATERIAL
from tautline.kernels.hermite import SHAPE, table
from tautline.system.records import records

NODE = 8
"""Degrees of freedom of a node: r, r', p, theta."""
TURN = 7
"""Place of theta among them."""
PLACES, BIT = (0.25, 0.75), 0.125
"""Points of an element from its upper end, and the part of the last element that belongs to the bit."""
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

    def to_nodes(self, values: np.ndarray) -> np.ndarray:
        """Forces at the points (..., n), shared by lever between the nodes of their element, (..., nodes)."""
        out = np.zeros((*values.shape[:-1], self.mesh.length.size + 1))
        np.add.at(out, (..., self.element), values * (1.0 - self.place))
        np.add.at(out, (..., self.element + 1), values * self.place)
        return out


def points_of(mesh: Lumps) -> Points:
    """The points where a string touches the wall and the mud."""
    n = mesh.length.size
    element = np.append(np.repeat(np.arange(n), 2), n - 1)
    share = np.full(element.size, 0.5)
    share[-2:] = 0.5 - BIT, BIT
    halves = np.zeros((element.size, len(mesh.tubes)))
    halves[np.arange(element.size), mesh.section[element]] = share * mesh.length[element]
    return Points(mesh, element, np.append(np.tile(PLACES, n), 1.0), halves)


def nodes_as_points(mesh: Lumps, nodes: np.ndarray) -> Points:
    """Some nodes of a mesh, each for the length that belongs to it."""
    last = nodes == mesh.length.size
    return Points(mesh, nodes - last, last.astype(float), mesh.halves[nodes])


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
