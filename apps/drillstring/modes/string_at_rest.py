"""A string at rest and what it is for small motions: mass and stiffness of what is free."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array

from drillstring.drilling.bit_numbers import stiffness_of
from drillstring.drilling.bit_rock import BladeBit, RockBit
from drillstring.groups.contact import WallContact
from drillstring.model.build import build
from drillstring.model.prepared import tubes_of, well_of
from drillstring.modes import bha
from drillstring.modes.natural_modes import modes_below
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps, cut
from drillstring.well.wellbore import Wellbore
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State, new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.kernels.matrix import new_matrix, sparse
from tautline.lumped.bend import Bends
from tautline.lumped.curve import PER_BODY
from tautline.system.model import Model
from tautline.system.system import System

X, U, V, TURN = range(PER_BODY)


def at_rest(scene: DrillstringScene) -> tuple[Model, State]:
    """A scene's model, and its state in static equilibrium; raises as `StringAtRest.of` does."""
    model = build(scene)
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    return model, state


def mass_and_stiffness(system: System, state: State) -> list[csc_array]:
    """Sparse mass and stiffness (n, n) of a system's free unknowns at a state of rest."""
    parts = []
    for part in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        evaluate(system, state, 0.0, 1.0, True, *part, matrix, np.zeros(system.size))
        parts.append(csc_array(sparse(matrix)))
    mass, stiffness = parts
    return [mass, stiffness + _held_by_rock(system)]


def _held_by_rock(system: System) -> csc_array:
    """Stiffness (n, n) of the rock under a bit, which as a group of the run acts only once that has begun."""
    along = np.zeros((system.dofs.start.size - 1, 1))
    for group in system.groups:
        if isinstance(group, (RockBit, BladeBit)):
            along[group.places, 0] = np.sqrt(stiffness_of(group.row[0])) * group.direction
    moved = csc_array(expansion(system).T @ csc_array(along))
    return csc_array(moved @ moved.T)


def expansion(system: System) -> csc_array:
    """How much of each free unknown is in each full degree of freedom, (full, m)."""
    dofs = system.dofs
    full = np.repeat(np.arange(dofs.start.size - 1), np.diff(dofs.start))
    free = dofs.unknown >= 0
    entries = dofs.factor[free], (full[free], dofs.unknown[free])
    return csc_array(coo_array(entries, shape=(dofs.start.size - 1, system.size)))


class Vibrations(NamedTuple):
    """Modes between supports: frequencies (k,) Hz; moves of the lumps or nodes along the hole, on m1 and on m2,
    (n + 1, 3, k); and what of their mass moves so, (n + 1, 3) kg, 0 where it is held.
    """

    frequency: np.ndarray
    moves: np.ndarray
    mass: np.ndarray


@dataclass(frozen=True)
class StringAtRest:
    """A cut string at rest: its lumps, the forces of the wall (n + 1,), and sparse mass and stiffness (n, n)."""

    cut: bha.Cut
    well: Wellbore
    lumps: Lumps
    system: System
    state: State
    normal: np.ndarray

    @classmethod
    def of(cls, mesh: bha.Cut) -> StringAtRest:
        """Find the rest of a cut string; raises SceneError, and StoppedEarly where it finds none."""
        model, state = at_rest(mesh.scene)
        well = well_of(mesh.scene)
        lumps = cut(tubes_of(mesh.scene, well.length), sum(mesh.counts))
        q, normal = state.full_q.reshape(-1, PER_BODY), np.zeros(lumps.length.size + 1)
        for group in model.system.groups:
            if isinstance(group, WallContact):
                s = group.springs
                gap = np.hypot(q[s.body, U], q[s.body, V]) - s.clearance
                normal[s.body] = np.maximum(0.0, s.stiffness * gap)
        return cls(mesh, well, lumps, model.system, state, normal)

    def matrices(self, rows: np.ndarray, fixed: np.ndarray | None = None) -> tuple[np.ndarray, csc_array]:
        """Diagonal of the mass and stiffness of some full degrees of freedom, all others held.

        ``fixed`` (n + 1,) says which lumps are held sideways.
        """
        system = self.system if fixed is None else _clamped(self.system, self.lumps, fixed)
        number = system.dofs.number[rows]
        mass, stiffness = (part[number][:, number] for part in mass_and_stiffness(system, self.state))
        return mass.diagonal(), csc_array(0.5 * (stiffness + stiffness.T))

    def free(self, lumps: np.ndarray, directions: tuple[int, ...]) -> np.ndarray:
        """Full degrees of freedom of some lumps that are free."""
        rows = (PER_BODY * lumps[:, None] + np.array(directions)).ravel()
        return rows[self.system.dofs.number[rows] >= 0]

    def lateral(self, at: int, fixed: np.ndarray, highest: float) -> Vibrations:
        """Modes below a lump up to a frequency, Hz; ``fixed`` (n + 1,) lumps are held sideways, those above wholly."""
        every = np.arange(self.lumps.length.size + 1)
        rows = np.sort(np.append(self.free(every[at + 1 :], (X,)), self.free(every[~fixed], (U, V))))
        mass, stiffness = self.matrices(rows, fixed)
        frequency, vectors = modes_below(mass, stiffness, highest)
        full, weights = np.zeros((every.size * PER_BODY, frequency.size)), np.zeros(every.size * PER_BODY)
        full[rows], weights[rows] = vectors, mass
        moves = full.reshape(every.size, PER_BODY, -1)[:, : V + 1]
        return Vibrations(frequency, moves, weights.reshape(-1, PER_BODY)[:, : V + 1])

    def along(self, kind: str, highest: float) -> tuple[np.ndarray, np.ndarray]:
        """Torsional or axial modes up to a frequency: frequencies (k,) Hz, and shapes at the lumps (n + 1, k)."""
        rows = self.free(np.arange(self.lumps.length.size + 1), (TURN if kind == "torsional" else X,))
        frequency, vectors = modes_below(*self.matrices(rows), highest)
        shapes = np.zeros((self.lumps.length.size + 1, frequency.size))
        shapes[rows // PER_BODY] = vectors
        return frequency, shapes

    @property
    def pinned(self) -> bool:
        """Whether the bit is held on the axis."""
        return bool(self.system.dofs.number[PER_BODY * self.lumps.length.size + U] < 0)


def _clamped(system: System, lumps: Lumps, fixed: np.ndarray) -> System:
    """Where links that are held end, only that half of a bend gives way which belongs to the link that is free.

    With the whole bend a clamped end would err by the first order of a link's length.
    """
    groups = []
    for group in system.groups:
        if isinstance(group, Bends):
            rigidity = lumps.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
            above, here, below = fixed[:-2], fixed[1:-1], fixed[2:]
            stiffness = group.stiffness.copy()
            for held, link in ((above & ~below, slice(1, None)), (below & ~above, slice(None, -1))):
                half = (rigidity / (0.5 * lumps.length))[link]
                stiffness[held & here] = half[held & here]
            group = group._replace(stiffness=stiffness)
        groups.append(group)
    return replace(system, groups=tuple(groups), linked={})
