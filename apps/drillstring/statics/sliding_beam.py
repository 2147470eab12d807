"""A beam under friction all one way: what the statics of torque and drag ask of the string's ALE-ANCF model.

What buckling does to the wall force is Mitchell's helix (helix.py), here as for lumps; the shape of it is not sought,
and where a string is pushed beyond its limit Newton's method would find one of many, or none. So a pushed beam is
braced: springs across the hole at its points, of a foundation k = c F^2/(4 EI) per metre. A beam on it buckles at
F = 2 sqrt(k EI) (M. Hetenyi, "Beams on Elastic Foundation", 1946, ch. 7), so c = 1 is the least, and then k r is the
helix's wall force itself; elements that are long for the waves of buckling need up to 2.4. The braces are centred on
the hole's axis, and rub as the wall does: what they bear of the side force the wall does not, and both together are
what balance asks for.
"""

from __future__ import annotations

import numpy as np

from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.beam_points import NODE, nodes_of, points_of
from drillstring.groups.contact import PAD
from drillstring.groups.sliding import SLIDING, Sliding
from drillstring.results.beam_observe import nearest
from drillstring.string.lumps import Lumps
from drillstring.well.in_hole import AXES
from drillstring.well.wellbore import Wellbore
from tautline.elements.beam.bending import Bending
from tautline.elements.nodal.load import Loads
from tautline.integrators.state import State
from tautline.system.records import records
from tautline.system.system import System

BRACED = 1.3
"""Braces over those that a pushed beam needs: too many lift a string that still lies on the wall off it."""
NEEDED = np.array(
    [[0.0, 5.0, 14.0, 30.0, 34.0, 40.0, 50.0, 60.0, 100.0, 150.0, 300.0, 1000.0],
     [1.0, 1.03, 1.57, 1.58, 1.98, 2.28, 2.37, 2.28, 1.73, 1.28, 0.70, 0.223]]
)  # fmt: skip
"""The c that elements of a length L need against F L^2/EI, by Bloch waves along them with the elements' quadratures."""
UNBENT = 57.0
"""Needed k over F/L^2 of elements without bending, which is where c F L^2/(4 EI) of very long ones ends."""


class SlidingBeam:
    """A beam that slides; its places are its points of contact, two of each element and the bit.

    Attributes
    ----------
    contact : BeamContact
        The wall, whose law is to be changed.
    tributary : (k,) array
        Length that belongs to each place, m; all of them are contacts.
    reach : two (k,) arrays
        From where to where along the unstretched string the contacts reach, m.
    braces : BeamContact
        Springs across the hole at the same points, which have no clearance.
    loads : Loads
        What pulls at the bit, and what more friction there is at the contacts: see :meth:`press`.
    """

    def __init__(self, system: System, lumps: Lumps, well: Wellbore, depth: float, above: float) -> None:
        self.system, self.lumps, self.well = system, lumps, well
        (self.contact,) = (g for g in system.groups if isinstance(g, BeamContact))
        points = points_of(lumps)
        self.points, self.tributary = points, points.length
        ends = np.concatenate([[0.0], np.cumsum(points.length)])
        self.reach = ends[:-1], ends[1:]
        unstretched = lumps.measured_depth[points.element] + points.place * lumps.length[points.element]
        self.unstretched = unstretched - above
        self.at_nodes = np.append(lumps.measured_depth, lumps.measured_depth[nodes_of(lumps).twins[:, 1] // NODE])
        self.at_nodes -= above
        bends = any(isinstance(g, Bending) for g in system.groups)
        self.rigidity = lumps.of_links(lambda tube: tube.youngs_modulus * tube.second_moment) if bends else None
        springs = records(points.length.size, PAD, radius=self.contact.springs.radius)
        self.braces = self.contact._replace(springs=springs, law=Sliding(records(springs.size, SLIDING)))
        rows = self.contact.hole.points
        given = next((g for g in system.groups if isinstance(g, Loads)), Loads(np.zeros(0, np.int64), np.zeros(0)))
        vectors = rows.place[:, :, None] + np.arange(AXES)
        places = np.concatenate([given.place, vectors.ravel(), rows.turn.ravel()])
        pull = given.value
        if pull.size:
            # It pulls along the hole where the bit is to be, not where that of an unstretched string would be.
            pull = (pull @ well.frame(lumps.measured_depth[-1])[2]) * well.frame(depth)[2]
        self.loads = Loads(places, np.append(pull, np.zeros(vectors.size + rows.turn.size)))
        self.own = given.place.size

    def press(self, along: np.ndarray, about: np.ndarray, q: np.ndarray) -> None:
        """Load the contacts along the hole (k,) N and about its axis (k,) N m, with the string as it lies."""
        rows = self.contact.hole.points
        tangent = self.well.frame(self._seats(q)[0])[2]
        forces = rows.weight[:, :, None] * (along[:, None] * tangent)[:, None, :]
        turns = rows.share * about[:, None]
        self.loads.value[self.own :] = np.append(forces.ravel(), turns.ravel())

    def slide(self, rows: np.recarray) -> tuple:
        """The groups that slide, with rows (k,) of ``SLIDING``."""
        law = Sliding(rows)
        self.braces = self.braces._replace(law=law)
        return self.contact._replace(law=law), self.braces, self.loads

    def brace(self, pushed: np.ndarray, limit: np.ndarray) -> bool:
        """Keep elements under a compression (n,) N from buckling; returns whether that changed anything.

        All that are pushed are braced, and not those beyond their ``limit`` (n,) N alone.
        """
        stiffness = longest = UNBENT * pushed / self.lumps.length**2
        if self.rigidity is not None:
            size = pushed * self.lumps.length**2 / self.rigidity
            needed = np.interp(size, *NEEDED) * pushed**2 / (4.0 * self.rigidity)
            stiffness = np.where(size > NEEDED[0, -1], longest, needed)
        before = self.braces.springs.stiffness.copy()
        self.braces.springs.stiffness = self.spread(BRACED * stiffness)
        return not np.array_equal(before, self.braces.springs.stiffness)

    jump = 0.0
    """What a brace jumps by on the axis, N: see the lumps. A beam's nodes are held there by its bending."""

    def bit_depth(self, q: np.ndarray) -> float:
        """Measured depth of the bit, m."""
        return float(self._seats(q)[0][-1])

    def shift(self, state: State, up: float) -> None:
        """Move the string up the hole as a whole: nodes keep their place across the hole, and their direction in it."""
        q = state.full_q.copy()
        q[self.system.free] = state.q
        nodes = q[: NODE * self.at_nodes.size].reshape(-1, NODE)
        s, u, v = nearest(self.well, nodes[:, :AXES], self.at_nodes)
        before, after = (np.stack(self.well.frame(x), axis=1) for x in (s, s - up))
        slope = np.einsum("iab,ib->ia", before, nodes[:, AXES : 2 * AXES])
        nodes[:, :AXES] = self.well.point(s - up, u, v)
        nodes[:, AXES : 2 * AXES] = np.einsum("iab,ia->ib", after, slope)
        state.q[:] = q[self.system.free]

    def move_aside(self, state: State) -> None:
        """A beam may lie on the hole's axis: its nodes hold it there."""

    def measured_depth(self, q: np.ndarray) -> np.ndarray:
        """Of the places, (k,) m."""
        return self._seats(q)[0]

    def wall_force(self, q: np.ndarray) -> np.ndarray:
        """Normal force of the wall and of the braces at the places, (k,) N."""
        springs = self.contact.springs
        _, u, v = self._seats(q)
        offset = np.hypot(u, v)
        wall = np.maximum(0.0, springs.stiffness * (offset - springs.clearance))
        return wall + self.braces.springs.stiffness * offset

    def spread(self, per_metre: np.ndarray) -> np.ndarray:
        """Force at the places (k,) N of a force per metre of each element (n,) N/m."""
        return per_metre[self.points.element] * self.tributary

    def _seats(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Measured depth of the points, and their offset from the hole's axis on m1 and m2, (k,) m each."""
        rows = self.contact.hole.points
        at = (rows.weight[:, :, None] * q[rows.place[:, :, None] + np.arange(AXES)]).sum(axis=1)
        return nearest(self.well, at, self.unstretched)
