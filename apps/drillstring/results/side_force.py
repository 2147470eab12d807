"""The largest side force per length, of the wall's forces on lumps: a figure that does not depend on the mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.string.lumps import Lumps

JOINT = 10.0
"""Length over which the side force is averaged, m: about a joint of pipe. A point force would be without bound else."""
SHARE = 0.05
"""Of a short string, such as one of the laboratory, over which it is averaged in place of that."""


class SideForce(NamedTuple):
    """Largest mean side force N/m, over a length m, with the lump nearest to the middle of that piece."""

    value: float
    length: float
    lump: int


def largest_side_force(contact: np.ndarray, lumps: Lumps) -> SideForce:
    """Largest side force per length at any time and place.

    The force on a lump is spread evenly over the piece of string that belongs to it. What is left are means over pieces
    of a fixed length: with shorter elements they converge, also where the hole presses at a point, such as at a kink.

    Parameters
    ----------
    contact : (m, n + 1) array
        Normal force of the wall on each lump, N.
    lumps : Lumps
    """
    upper, lower = lumps.reach
    edges = np.append(upper - upper[0], lower[-1] - upper[0])
    length = min(JOINT, SHARE * edges[-1])
    # The mean is linear in where the piece begins while neither end passes an edge: it is largest with an end at one.
    begins = np.clip(np.concatenate([edges, edges - length]), 0.0, edges[-1] - length)
    summed = np.concatenate([np.zeros((len(contact), 1)), np.cumsum(contact, axis=1)], axis=1)
    mean = (_at(summed, edges, begins + length) - _at(summed, edges, begins)) / length
    most = mean.max(axis=0)
    k = int(most.argmax())
    middle = begins[k] + 0.5 * length
    lump = int(np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, contact.shape[1] - 1))
    return SideForce(float(most[k]), length, lump)


def _at(summed: np.ndarray, edges: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Force on all that is above places x (k,), (m, k), of what is above edges (m, n)."""
    i = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    share = (x - edges[i]) / (edges[i + 1] - edges[i])
    return summed[:, i] * (1.0 - share) + summed[:, i + 1] * share
