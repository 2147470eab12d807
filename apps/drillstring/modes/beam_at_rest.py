"""A beam at rest and its natural modes: what of its unknowns is free, and how they move nodes along and across.

The matrices are those of the run, consistent mass and tangent, so that vibrations are of higher order in the elements'
length than those of lumps; torsion alone has linear elements with half of the inertia at each end, as lumps have.
The run's unknowns are P z, with the columns of P for what may move: a node wholly, along the hole only, or not at all.
A node that moves along the hole by z has the slope change z' t + z K with the curvature K of the hole. The springs that
keep the slopes of two sections in one direction count as rigid: their own frequencies would drown slow vibrations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csc_array

from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.beam_points import NODE, TURN, nodes_of, points_of
from drillstring.model.prepared import tubes_of, well_of
from drillstring.modes import bha
from drillstring.modes.natural_modes import modes_below
from drillstring.modes.string_at_rest import Vibrations, at_rest, expansion, mass_and_stiffness
from drillstring.results.beam_observe import nearest
from drillstring.string.fluid import fluid_of, mass_beside
from drillstring.string.lumps import Lumps, cut
from drillstring.well.in_hole import AXES
from drillstring.well.wellbore import Wellbore
from tautline.system.system import System


@dataclass(frozen=True)
class BeamAtRest:
    """A cut beam at rest: its mesh, the wall's forces at the nearest nodes (n + 1,), and mass and stiffness (m, m).

    ``frame`` (n + 1, 3, 3) holds t, m1 and m2 at the nodes, and ``bend`` (n + 1, 3) the hole's curvature, 1/m.
    """

    cut: bha.Cut
    well: Wellbore
    lumps: Lumps
    system: System
    normal: np.ndarray
    mass: csc_array
    stiffness: csc_array
    frame: np.ndarray
    bend: np.ndarray

    @classmethod
    def of(cls, mesh: bha.Cut) -> BeamAtRest:
        """Find the rest of a cut string; raises SceneError, and StoppedEarly where it finds none."""
        model, state = at_rest(mesh.scene)
        well = well_of(mesh.scene)
        lumps = cut(tubes_of(mesh.scene, well.length), sum(mesh.counts))
        q, count = state.full_q, lumps.length.size + 1
        s, _, _ = nearest(well, q[: NODE * count].reshape(-1, NODE)[:, :AXES], lumps.measured_depth)
        m1, m2, t = well.frame(s)
        k1, k2 = well.curvature(s)
        bend = k1[:, None] * m1 + k2[:, None] * m2
        mass, stiffness = mass_and_stiffness(model.system, state)
        stiffness = csc_array(0.5 * (stiffness + stiffness.T))
        normal = _pressed(model.system, well, lumps, q)
        return cls(mesh, well, lumps, model.system, normal, mass, stiffness, np.stack([t, m1, m2], axis=1), bend)

    @property
    def pinned(self) -> bool:
        """Whether the bit is held on the axis."""
        bit = NODE * self.lumps.length.size
        return bool((self.system.dofs.number[bit : bit + AXES] < 0).any())

    def lateral(self, at: int, fixed: np.ndarray, highest: float) -> Vibrations:
        """Modes below a node up to a frequency, Hz; ``fixed`` (n + 1,) nodes are held sideways, those above wholly.

        A beam goes on straight where it enters what holds it, but for the drive, which holds it as a pin.
        """
        columns = _Columns(self.system)
        for i in range(at + 1, self.lumps.length.size + 1):
            beside = fixed[max(i - 1, 0) : i + 2]
            clamped = fixed[i] and beside.sum() > 1
            if self._guided(i):
                columns.add_guide(self.guide, [], self.bend[i])
            else:
                columns.add(NODE * i, self.frame[i, :1] if fixed[i] else self.frame[i])
            self._turn(columns, i, not clamped)
        if at == 0:
            self._turn(columns, 0, True)
        frequency, full = self._modes(columns, highest)
        moves = np.einsum("iab,ibk->iak", self.frame, full)
        fluid, hole = fluid_of(self.cut.scene.mud), self.cut.scene.well.diameter
        along = self.lumps.of_lumps(lambda tube: tube.mass_per_length)
        across = along + self.lumps.of_lumps(lambda tube: mass_beside(fluid, tube, hole))
        moving = np.arange(along.size) > at
        across = np.where(moving & ~fixed, across, 0.0)
        return Vibrations(frequency, moves, np.stack([np.where(moving, along, 0.0), across, across], axis=1))

    def along(self, kind: str, highest: float) -> tuple[np.ndarray, np.ndarray]:
        """Torsional or axial modes up to a frequency: frequencies (k,) Hz, and shapes at the nodes (n + 1, k)."""
        columns, last = _Columns(self.system), self.lumps.length.size
        if kind == "torsional":
            for i in range(last + 1):
                columns.add(NODE * i + TURN, np.ones((1, 1)))
            frequency, full = self._modes(columns, highest, TURN, 1)
            return frequency, full[:, 0]
        for i in range(last + 1):
            slopes = self._slopes(i)
            for place in slopes:
                columns.add(place, self.frame[i, :1])
            if self._guided(i):
                columns.add_guide(self.guide, slopes, self.bend[i])
            elif i > 0:
                columns.add_along(NODE * i, self.frame[i, 0], slopes, self.bend[i])
        frequency, full = self._modes(columns, highest)
        return frequency, np.einsum("ib,ibk->ik", self.frame[:, 0], full)

    @property
    def guide(self) -> int:
        """Number of the unknown that a bit held on the axis moves by."""
        free = self.system.dofs.number[NODE * nodes_of(self.lumps).count :]
        return int(free[free >= 0][0])

    def _guided(self, i: int) -> bool:
        return self.pinned and i == self.lumps.length.size

    def _turn(self, columns: _Columns, i: int, free: bool) -> None:
        """Let the slopes of a node change in size, each by itself, and if they are free in direction, together."""
        slopes = self._slopes(i)
        for place in slopes:
            columns.add(place, self.frame[i, :1])
        for way in self.frame[i, 1:] if free else ():
            columns.add_along(slopes[0], way, slopes[1:], way)

    def _slopes(self, i: int) -> list[int]:
        """Where the slopes of a node begin; at a change of section there are two."""
        twins = nodes_of(self.lumps).twins
        return [NODE * i + AXES, *(int(twin) + AXES for twin, node in twins if node == NODE * i)]

    def _modes(
        self, columns: _Columns, highest: float, first: int = 0, count: int = AXES
    ) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies (k,), and what becomes of some unknowns of every node (n + 1, count, k)."""
        basis = columns.matrix()
        mass, stiffness = (csc_array(basis.T @ part @ basis) for part in (self.mass, self.stiffness))
        frequency, vectors = modes_below(mass, stiffness, highest)
        full = expansion(self.system) @ (basis @ vectors)
        nodes = full[: NODE * (self.lumps.length.size + 1)].reshape(self.lumps.length.size + 1, NODE, -1)
        return frequency, nodes[:, first : first + count]


class _Columns:
    """Columns of P while they are found."""

    def __init__(self, system: System) -> None:
        self.number, self.size, self.count = system.dofs.number, system.size, 0
        self.rows: list[int] = []
        self.columns: list[int] = []
        self.values: list[float] = []

    def add(self, place: int, ways: np.ndarray) -> None:
        """Let the unknowns from a place on move in some ways (k, unknowns), each by itself."""
        for way in ways:
            self._put(place, way)
            self._close()

    def add_along(self, place: int, way: np.ndarray, slopes: list[int], turn: np.ndarray) -> None:
        """Let a node, or a slope, move in one way, and other slopes turn with it."""
        self._put(place, way)
        for slope in slopes:
            self._put(slope, turn)
        self._close()

    def add_guide(self, number: int, slopes: list[int], turn: np.ndarray) -> None:
        """Let a node move by the unknown that guides it, and its slopes turn with it."""
        self._entry(number, 1.0)
        for slope in slopes:
            self._put(slope, turn)
        self._close()

    def matrix(self) -> csc_array:
        """P, (m, columns)."""
        return csc_array(coo_array((self.values, (self.rows, self.columns)), shape=(self.size, self.count)))

    def _put(self, place: int, way: np.ndarray) -> None:
        for k, value in enumerate(way):
            if self.number[place + k] >= 0:
                self._entry(int(self.number[place + k]), float(value))

    def _entry(self, row: int, value: float) -> None:
        self.rows.append(row)
        self.columns.append(self.count)
        self.values.append(value)

    def _close(self) -> None:
        """The next column, where this one has entries: what is held has none."""
        if self.columns and self.columns[-1] == self.count:
            self.count += 1


def _pressed(system: System, well: Wellbore, lumps: Lumps, q: np.ndarray) -> np.ndarray:
    """Forces of the wall on the points of a beam, each at its nearest node, (n + 1,) N."""
    normal, points = np.zeros(lumps.length.size + 1), points_of(lumps)
    for group in system.groups:
        if isinstance(group, BeamContact):
            rows = group.hole.points
            at = (rows.weight[:, :, None] * q[rows.place[:, :, None] + np.arange(AXES)]).sum(axis=1)
            place = lumps.measured_depth[points.element] + points.place * lumps.length[points.element]
            _, u, v = nearest(well, at, place)
            force = group.springs.stiffness * np.maximum(0.0, np.hypot(u, v) - group.springs.clearance)
            np.add.at(normal, points.element + (points.place > 0.5), force)
    return normal
