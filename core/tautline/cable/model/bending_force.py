"""What bending does to the axial force of a section.

The energy of bending is EJ kappa^2 / 2 per metre of material, and kappa = theta' / lambda is geometric: a stretch at a
fixed change of angle theta' flattens the curve. So the force along the tangent that goes with lambda is, beside that of
the strain, the derivative of this energy by lambda, -EJ kappa^2 / lambda. The damping of bending acts in the same way,
with its moment in place of EJ kappa. At a section, both together balance the forces on what lies beyond it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.cable.input.parts import Element
from tautline.cable.model.elements import STILL, flow_of, lengths_of, smoothing_of
from tautline.cable.model.layout import Layout


class BendingForce:
    """Of the elements that bend; ``elements`` are their places among those of the scene."""

    def __init__(self, layout: Layout, elements: Sequence[Element]) -> None:
        self.elements = np.array([k for k, e in enumerate(elements) if e.kind == "cubic" and e.EJ > 0.0], dtype=int)
        bent = [elements[k] for k in self.elements]
        # A rope that does not spin about its own line is damped so only where no material moves through its nodes.
        spinless = np.array([e.spinless and flow_of(layout, e) == STILL for e in bent], dtype=bool)
        self.smoothing = np.where(spinless, 0.0, smoothing_of(lengths_of(layout, bent)) if bent else 0.0)

    def of(
        self, slope: np.ndarray, slope_rate: np.ndarray, turn: np.ndarray, turn_rate: np.ndarray,
        stiffness: np.ndarray, viscosity: np.ndarray,
    ) -> np.ndarray:  # fmt: skip
        """Its part of the axial force, N, in a point of each element.

        Parameters
        ----------
        slope, slope_rate, turn, turn_rate : (m, elements, 3) array
            r' and r'' at the point and their rates for the particle there.
        stiffness, viscosity : (elements,) array
            EJ in N m^2, and EJ c in N m^2 s.
        """
        a = np.maximum(_dot(slope, slope), np.finfo(float).tiny)
        along = _dot(slope, turn) / a
        across = turn - along[..., None] * slope
        square = _dot(across, across) / a**2
        moment = stiffness * square
        if viscosity.any():
            # Half of the rate of kappa^2: the vector of curvature, across / a, times its rate.
            rate = turn_rate - along[..., None] * slope_rate - 2.0 * (_dot(slope, slope_rate) / a)[..., None] * turn
            half = _dot(rate, across) / a**2
            share = square / np.maximum(square + self.smoothing**2, np.finfo(float).tiny)
            moment = moment + viscosity * share * half
        return -moment / np.sqrt(a)


def _dot(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return (x * y).sum(axis=-1)
