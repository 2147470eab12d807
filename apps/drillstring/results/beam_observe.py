"""What the frames of a beam mean: the same variables as those of lumps, node by node and element by element."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillstring.drilling.end_groups import numbers_of_ends
from drillstring.drilling.top_drive import TopDrive
from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.beam_points import NODE, TURN, Points, nodes_of
from drillstring.results import places as parts
from drillstring.results.drilling import observed_at_ends
from drillstring.results.observe import coordinates_of
from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.application.modelling import energies_of
from tautline.elements.beam.twist import Twist
from tautline.elements.nodal.load import Loads
from tautline.kernels.hermite import FIRST, SECOND, WEIGHT, gauss, lobatto, table

PASSES = 20
"""Times that a point is looked for on the arc on which it was found last."""


def nearest(well: Wellbore, points: np.ndarray, guess: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Measured depth of the place of a hole's axis that is nearest to each point, and the point's offset on m1 and m2.

    Parameters
    ----------
    well : Wellbore
    points : (..., 3) array
        North, east, down, m.
    guess : (...) array
        Measured depths near which to look, m.

    Returns
    -------
    s, u, v : (...) arrays
        In m.
    """
    s = np.broadcast_to(guess, points.shape[:-1]).astype(float)
    for _ in range(PASSES):
        moved = _on_arc(well, points, s)
        done = np.array_equal(well.arc(moved), well.arc(s)) and np.array_equal(moved < 0.0, s < 0.0)
        s = moved
        if done:
            break
    m1, m2, _ = well.frame(s)
    off = points - well.position(s)
    return s, np.sum(off * m1, axis=-1), np.sum(off * m2, axis=-1)


def _on_arc(well: Wellbore, points: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Measured depth of the nearest place on the arc that holds s, which goes on beyond its ends."""
    i = well.arc(s)
    k1, k2 = well.curvature(s)
    off = points - well.positions[i]
    along = np.sum(off * well.tangents[i], axis=-1)
    k = np.hypot(k1, k2)
    inside = 1.0 - k1 * np.sum(off * well.m1s[i], axis=-1) - k2 * np.sum(off * well.m2s[i], axis=-1)
    angle = np.arctan2(k * along, inside)
    return well.md[i] + np.where(k > 0.0, angle / np.where(k > 0.0, k, 1.0), along)


class BeamObserver:
    """Turns frames into variables; all of it vectorised over the frames of a batch."""

    on_demand = None

    def __init__(
        self, scene: DrillstringScene, well: Wellbore, mesh: Lumps, points: Points, groups: tuple[Any, ...]
    ) -> None:
        self.well, self.mesh, self.nodes = well, mesh, nodes_of(mesh)
        self.contact = next((g for g in groups if isinstance(g, BeamContact)), None)
        self.drive = next((g for g in groups if isinstance(g, TopDrive)), None)
        self.twist = next(g for g in groups if isinstance(g, Twist))
        self.points, self.groups = points, groups
        self.own = (0 if self.contact is None else 3 * self.contact.springs.size) + numbers_of_ends(groups)
        self.diameter = scene.well.diameter if scene.well.wall is not None else None
        self.lag = scene.damping.structural
        self.bends = scene.model.bending != "none"
        self.rigidity = mesh.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
        fluid = fluid_of(scene.mud)
        self.per_metre = mesh.of_links(lambda tube: weight_in(fluid, tube, scene.gravity))
        self.weight = mesh.of_lumps(lambda tube: weight_in(fluid, tube, scene.gravity))
        straight = np.concatenate([well.position(mesh.measured_depth), well.frame(mesh.measured_depth)[2]], axis=-1)
        self.unstretched = self._potential(straight[None, :, :])[0] + self._of_loads(straight)

    def _potential(self, q: np.ndarray) -> np.ndarray:
        """Energy of the buoyed weight of elements with the unknowns (..., nodes, at least 6), J."""
        length = self.mesh.length
        mean = 0.5 * (q[:, :-1, 2] + q[:, 1:, 2]) + length / 12.0 * (q[:, :-1, 5] - q[:, 1:, 5])
        return -(self.per_metre * length * mean).sum(axis=-1)

    def _of_loads(self, straight: np.ndarray) -> float:
        """Energy -F q, J, of constant forces on nodes that lie straight (nodes, 6): of the bit's force.

        The coordinates of a beam are positions; those of lumps count from the unstretched string.
        """
        loads = [g for g in self.groups if isinstance(g, Loads)]
        return -sum(float(g.value @ straight[g.place // NODE, g.place % NODE]) for g in loads)

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        clearance = None
        if self.contact is not None:
            # A node has the clearance of the element above it, that in the drive of the one below.
            inside = self.contact.springs.clearance[:-1:2]
            clearance = np.append(inside[:1], inside)
        return coordinates_of(self.well, self.mesh, self.weight, clearance, self.diameter, parts.NODE)

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        rows, nodes = frames.time.size, self.mesh.length.size + 1
        every = NODE * self.nodes.count
        all_q, all_v = (x[:, :every].reshape(rows, -1, NODE) for x in (frames.q, frames.v))
        q, v = all_q[:, :nodes], all_v[:, :nodes]
        s, x, y = nearest(self.well, q[:, :, :3], self.mesh.measured_depth)
        k1, k2 = self.well.curvature(s)
        tangent = self.well.frame(s)[2]
        speed = np.sum(v[:, :, :3] * tangent, axis=-1) / (1.0 - k1 * x - k2 * y)
        contact, friction, around = self._contact(frames)
        first = self.well.frame(np.zeros(1))[2][0]
        return {
            "position": q[:, :, :3].copy(),
            "velocity": v[:, :, :3].copy(),
            "measured_depth": s,
            "lateral_displacement": np.stack([x, y], axis=-1),
            "rotation": q[:, :, TURN].copy(),
            "axial_velocity": speed,
            "rotation_rate": v[:, :, TURN].copy(),
            "tension": self._tension(all_q, all_v),
            "torque": self._torque(q, v),
            "contact_force": contact,
            "friction_force": friction,
            "friction_around": around,
            "hook_load": -frames.residual[:, :3] @ first,
            "surface_torque": self._surface_torque(frames),
            "block_position": q[:, 0, :3] @ first,
            "bit_speed": speed[:, -1],
            "bit_depth": s[:, -1],
            **energies_of(frames),
            "potential_energy": frames.energy[:, 2] - self.unstretched,
        } | observed_at_ends(frames, self.groups)

    def _tension(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Effective tension of each element: its mean along the element, with Kelvin-Voigt damping.

        The energy EI kappa^2 / 2 is that of the curvature per metre as it is stretched, so that it pushes along the
        line as well: T = EA strain - EI kappa^2 / |r'|.
        """
        axial = self.mesh.of_links(lambda tube: tube.youngs_modulus * tube.area)
        strain = np.zeros((q.shape[0], self.mesh.length.size))
        for row in table(*lobatto()):
            slope, rate = (self._interpolated(row[FIRST : FIRST + 4], x, 1) for x in (q, v))
            size = np.linalg.norm(slope, axis=-1)
            strain += row[WEIGHT] * (size - 1.0 + self.lag * np.sum(slope * rate, axis=-1) / size)
        tension = axial * strain
        for row in table(*gauss(3)) if self.bends else ():
            slope = self._interpolated(row[FIRST : FIRST + 4], q, 1)
            turn = self._interpolated(row[SECOND : SECOND + 4], q, 2)
            size = np.linalg.norm(slope, axis=-1)
            square = np.sum(np.cross(slope, turn) ** 2, axis=-1) / size**6
            tension -= row[WEIGHT] * self.rigidity * square / size
        return tension

    def _interpolated(self, shape: np.ndarray, x: np.ndarray, order: int) -> np.ndarray:
        """The first or second derivative of r by p at a place of every element, or of its rate."""
        a, b = x[:, self.nodes.a // NODE], x[:, self.nodes.b // NODE]
        length = self.mesh.length[:, None]
        of_slopes = shape[1] * a[:, :, 3:6] + shape[3] * b[:, :, 3:6]
        return (shape[2] * (b[:, :, :3] - a[:, :, :3]) / length + of_slopes) / length ** (order - 1)

    def _torque(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        twist = np.diff(q[:, :, TURN], axis=1) + self.lag * np.diff(v[:, :, TURN], axis=1)
        return -self.twist.rows.stiffness * twist

    def _contact(self, frames: Any) -> list[np.ndarray]:
        """Normal force and friction along and around the hole; what acts inside an element is shared by its nodes."""
        if self.contact is None:
            shape = frames.time.size, self.mesh.length.size + 1
            return [np.zeros(shape) for _ in range(3)]
        own = frames.own[:, : 3 * self.contact.springs.size].reshape(frames.time.size, -1, 3)
        return [self.points.to_nodes(own[:, :, k]) for k in range(3)]

    def _surface_torque(self, frames: Any) -> np.ndarray:
        if self.drive is not None:
            return frames.own[:, -1] - self.drive.inertia * frames.a[:, TURN]
        return frames.residual[:, TURN].copy()
