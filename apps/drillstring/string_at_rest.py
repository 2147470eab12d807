"""A string at rest and what it is for small motions: mass and stiffness of what is free."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array

from drillstring import bha
from drillstring.build import build, tubes_of, well_of
from drillstring.contact import WallContact
from drillstring.string import Lumps, cut
from drillstring.wellbore import Wellbore
from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State, new_state
from tautline.kernels.matrix import new_matrix, sparse
from tautline.lumped.bend import Bends
from tautline.lumped.curve import PER_BODY
from tautline.system.system import System

X, U, V, TURN = range(PER_BODY)


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
        model = build(mesh.scene)
        state = new_state(model.system)
        find_equilibrium(model.system, state, model.step_limit)
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
        parts = []
        for part in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
            matrix = new_matrix(system.size, system.bandwidth, system.border)
            evaluate(system, self.state, 0.0, 1.0, True, *part, matrix, np.zeros(system.size))
            parts.append(csc_array(sparse(matrix))[number][:, number])
        return parts[0].diagonal(), csc_array(0.5 * (parts[1] + parts[1].T))

    def free(self, lumps: np.ndarray, directions: tuple[int, ...]) -> np.ndarray:
        """Full degrees of freedom of some lumps that are free."""
        rows = (PER_BODY * lumps[:, None] + np.array(directions)).ravel()
        return rows[self.system.dofs.number[rows] >= 0]


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
