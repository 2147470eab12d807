"""Lumps under friction all one way: what the statics of torque and drag ask of the lumped model."""

from __future__ import annotations

import numpy as np

from drillstring.groups.contact import WallContact
from drillstring.groups.sliding import Sliding
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.elements.nodal.load import Loads
from tautline.integrators.state import State
from tautline.lumped.curve import PER_BODY
from tautline.system.system import System


class SlidingLumps:
    """A lumped string that slides; its places are the lumps, and all but the one in the drive touch the wall.

    Attributes
    ----------
    contact : WallContact
        The wall, whose law is to be changed.
    tributary : (n + 1,) array
        Length that belongs to each place, m; contacts are the last of them.
    reach : two (n,) arrays
        From where to where along the unstretched string the contacts reach, m.
    loads : Loads
        What pulls at the bit, and what more friction there is at the contacts: see :meth:`press`.
    """

    buckles = False
    """Lumps are too far apart for the shapes of buckling."""

    def __init__(self, system: System, lumps: Lumps, well: Wellbore, depth: float, above: float) -> None:
        self.system, self.lumps, self.above = system, lumps, above
        (self.contact,) = (g for g in system.groups if isinstance(g, WallContact))
        self.tributary = lumps.tributary
        top, bottom = lumps.reach
        self.reach = top[1:], bottom[1:]
        given = next((g for g in system.groups if isinstance(g, Loads)), Loads(np.zeros(0, np.int64), np.zeros(0)))
        along = PER_BODY * self.contact.springs.body
        places = np.concatenate([given.place, along, along + 3])
        self.loads = Loads(places, np.append(given.value, np.zeros(2 * along.size)))

    def press(self, along: np.ndarray, about: np.ndarray, q: np.ndarray) -> None:
        """Load the contacts along the hole (n,) N and about its axis (n,) N m."""
        self.loads.value[-2 * along.size :] = np.append(along, about)

    def slide(self, rows: np.recarray) -> tuple:
        """The groups that slide, with rows (n,) of ``SLIDING``."""
        return self.contact._replace(law=Sliding(rows)), self.loads

    def bit_depth(self, q: np.ndarray) -> float:
        """Measured depth of the bit, m."""
        return float(self.lumps.measured_depth[-1] + q[-PER_BODY])

    def shift(self, state: State, up: float) -> None:
        """Move the string up the hole as a whole."""
        state.q[np.isin(self.system.free, PER_BODY * np.arange(self.lumps.length.size + 1))] -= up

    def measured_depth(self, q: np.ndarray) -> np.ndarray:
        """Of the places, (n + 1,) m."""
        return self.lumps.measured_depth + q[::PER_BODY]

    def wall_force(self, q: np.ndarray) -> np.ndarray:
        """Normal force of the wall at the places, (n + 1,) N."""
        rows, springs = q.reshape(-1, PER_BODY), self.contact.springs
        depth = np.hypot(rows[springs.body, 1], rows[springs.body, 2]) - springs.clearance
        side = np.zeros(rows.shape[0])
        side[springs.body] = np.maximum(0.0, springs.stiffness * depth)
        return side

    def spread(self, per_metre: np.ndarray) -> np.ndarray:
        """Force at the places (n + 1,) N of a force per metre of each link (n,) N/m."""
        halves = 0.5 * per_metre * self.lumps.length
        return np.append(halves, 0.0) + np.append(0.0, halves)
