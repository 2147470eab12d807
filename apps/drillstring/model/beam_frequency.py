"""The highest frequency at which a beam rattles on the wall: what an explicit method's step must follow."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from drillstring.groups.beam_points import Points
from drillstring.scene.hole import Wall
from drillstring.string.fluid import Fluid, mass_beside
from tautline.kernels.hermite import SHAPE, table
from tautline.threads import one_thread

CONSISTENT = np.array(
    [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]]
)
CONSISTENT /= 420.0
"""Mass matrix of an element of length and mass one."""


@one_thread()
def contact_frequency(points: Points, wall: Wall, fluid: Fluid, hole_diameter: float) -> float:
    """Largest frequency across the hole of one element alone on the springs of the wall, rad/s.

    That of the whole string is at most so much (Fried's bound on assembled eigenvalues).
    """
    mesh = points.mesh
    shapes = table(points.place, np.ones(points.place.size))[:, SHAPE : SHAPE + 4]
    stiffness = wall.stiffness * points.largest(lambda tube: tube.od) / max(tube.od for tube in mesh.tubes)
    stiffness = stiffness * points.length / (mesh.total / wall.lumps)
    beside = points.of(lambda tube: mass_beside(fluid, tube, hole_diameter))
    mass = mesh.of_links(lambda tube: tube.mass_per_length) * mesh.length
    largest = 0.0
    for element in {int(np.flatnonzero(mesh.section == k)[0]) for k in set(mesh.section)} | {mesh.length.size - 1}:
        of_it = points.element == element
        n = shapes[of_it]
        m = mass[element] * CONSISTENT + n.T @ (beside[of_it, None] * n)
        largest = max(largest, float(eigh(n.T @ (stiffness[of_it, None] * n), m, eigvals_only=True)[-1]))
    return float(np.sqrt(largest))
