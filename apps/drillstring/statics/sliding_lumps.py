"""Lumps under friction all one way: what the statics of torque and drag ask of the lumped model.

Where a string is pushed beyond its limit of buckling Newton's method finds one of many shapes, or none. So it is braced
there, as a beam is (sliding_beam.py): springs across the hole at the lumps, centred on its axis, that rub as the wall
does. A chain of links of length L, bending stiffness EI and compression F buckles as a wave that grows by the angle th
from lump to lump, with x = 2 - 2 cos(th) from 0 to 4, unless each lump has a spring of K >= F x/L - EI x^2/L^3. The
largest of these is the beam's, K = F^2 L/(4 EI) at x = F L^2/(2 EI), or where links are longer than that a zigzag's,
x = 4.
"""

from __future__ import annotations

import numpy as np

from drillstring.groups.contact import CENTRED, WallContact, nothing_kept
from drillstring.groups.sliding import Sliding
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.elements.nodal.load import Loads
from tautline.integrators.state import State
from tautline.lumped.bend import Bends
from tautline.lumped.curve import PER_BODY
from tautline.system.system import System

BRACED = 1.3
"""Braces over those that a pushed string needs."""
ZIGZAG = 4.0
"""x = 2 - 2 cos(th) of lumps that lie in turn on one side and on the other."""
ASIDE, MOST_ASIDE = 0.01, 1.0e-5
"""Offset from the hole's axis that a search with braces begins with, on which a brace has no direction to press in:
the share of a lump's clearance, and the most of it, m. One that begins at a wall, or tenths of a millimetre off the
axis, where a vertical string comes to lie, finds its balance too slowly or not at all."""


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
    braces : WallContact or None
        Springs across the hole at the same lumps, which have no clearance; None before any is needed.
    loads : Loads
        What pulls at the bit, and what more friction there is at the contacts: see :meth:`press`.
    """

    def __init__(self, system: System, lumps: Lumps, well: Wellbore, depth: float, above: float) -> None:
        self.system, self.lumps, self.above = system, lumps, above
        (self.contact,) = (g for g in system.groups if isinstance(g, WallContact))
        self.tributary = lumps.tributary
        top, bottom = lumps.reach
        self.reach = top[1:], bottom[1:]
        self.bends = any(isinstance(g, Bends) for g in system.groups)
        self.braces: WallContact | None = None
        given = next((g for g in system.groups if isinstance(g, Loads)), Loads(np.zeros(0, np.int64), np.zeros(0)))
        along = PER_BODY * self.contact.springs.body
        places = np.concatenate([given.place, along, along + 3])
        self.loads = Loads(places, np.append(given.value, np.zeros(2 * along.size)))

    def press(self, along: np.ndarray, about: np.ndarray, q: np.ndarray) -> None:
        """Load the contacts along the hole (n,) N and about its axis (n,) N m."""
        self.loads.value[-2 * along.size :] = np.append(along, about)

    def slide(self, rows: np.recarray) -> tuple:
        """The groups that slide, with rows (n,) of ``SLIDING``."""
        law = Sliding(rows)
        wall = self.contact._replace(law=law)
        return (wall, self.loads) if self.braces is None else (wall, self.braces._replace(law=law), self.loads)

    def brace(self, pushed: np.ndarray, limit: np.ndarray) -> bool:
        """Keep links under a compression (n,) N from buckling where one is beyond its limit (n,) N.

        Returns whether that changed anything. A string that buckles nowhere has no braces at all, and the groups of
        :meth:`slide` are as they were. In one that does all that is pushed is braced: between the two sides of the
        hole nothing else holds it.
        """
        length = self.lumps.length
        rigidity = self.lumps.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
        # Without bending stiffness the zigzag comes first.
        wave = np.minimum(ZIGZAG, pushed * length**2 / (2.0 * rigidity)) if self.bends else ZIGZAG
        rigidity = rigidity * float(self.bends)
        spring = pushed * wave / length - rigidity * wave**2 / length**3
        if not (pushed > limit).any():
            spring[:] = 0.0
        if self.braces is None:
            if not spring.any():
                return False
            springs = self.contact.springs.copy()
            springs.stiffness = springs.damping = springs.clearance = springs.viscous = 0.0
            self.braces = self.contact._replace(
                springs=springs, scratch=np.zeros_like(self.contact.scratch), kept=nothing_kept(springs.size)
            )
        before = self.braces.springs.stiffness.copy()
        self.braces.springs.stiffness = self.spread(BRACED * spring / length)[1:]
        return not np.array_equal(before, self.braces.springs.stiffness)

    @property
    def jump(self) -> float:
        """Largest force, N, that a brace has from one side of the axis to none on it, where it has no direction."""
        return 0.0 if self.braces is None else CENTRED * float(self.braces.springs.stiffness.max())

    def bit_depth(self, q: np.ndarray) -> float:
        """Measured depth of the bit, m."""
        return float(self.lumps.measured_depth[-1] + q[-PER_BODY])

    def shift(self, state: State, up: float) -> None:
        """Move the string up the hole as a whole."""
        state.q[np.isin(self.system.free, PER_BODY * np.arange(self.lumps.length.size + 1))] -= up

    def move_aside(self, state: State) -> None:
        """Take lumps that are braced off the hole's axis, if they lie on it.

        A string that nothing braces stays there: slightly off it a nearly weightless one finds its balance too slowly.
        """
        if self.braces is None:
            return
        springs = self.contact.springs
        aside = np.zeros(PER_BODY * (self.lumps.length.size + 1))
        first = PER_BODY * springs.body + 1
        # Across either axis: with the least of them it is beyond where it has no direction.
        aside[first] = aside[first + 1] = np.maximum(CENTRED, np.minimum(MOST_ASIDE, ASIDE * springs.clearance))
        across = [np.isin(self.system.free, first + way) for way in (0, 1)]
        centred = np.hypot(*(state.q[where] for where in across)) < CENTRED
        for where in across:
            state.q[where] += np.where(centred, aside[self.system.free[where]], 0.0)

    def measured_depth(self, q: np.ndarray) -> np.ndarray:
        """Of the places, (n + 1,) m."""
        return self.lumps.measured_depth + q[::PER_BODY]

    def wall_force(self, q: np.ndarray) -> np.ndarray:
        """Normal force of the wall and of the braces at the places, (n + 1,) N."""
        rows, springs = q.reshape(-1, PER_BODY), self.contact.springs
        offset = np.hypot(rows[springs.body, 1], rows[springs.body, 2])
        side = np.zeros(rows.shape[0])
        side[springs.body] = np.maximum(0.0, springs.stiffness * (offset - springs.clearance))
        if self.braces is not None:
            side[springs.body] += self.braces.springs.stiffness * offset
        return side

    def spread(self, per_metre: np.ndarray) -> np.ndarray:
        """Force at the places (n + 1,) N of a force per metre of each link (n,) N/m."""
        halves = 0.5 * per_metre * self.lumps.length
        return np.append(halves, 0.0) + np.append(0.0, halves)
