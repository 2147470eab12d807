"""How far elements that carry no compression are from where they go slack, or taut again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautline.kernels.groups import Edge
from tautline.kernels.hermite import FIRST

AXES, SLOPE = 3, 3
"""Components of a vector; where r' begins among the unknowns of a cubic node, behind its position."""
TAUT, SLACK = "is stretched", "is slack"


def edge_of_slack(places: Sequence[int], stretch: float, stiffness: float) -> Edge:
    """That of an element that is stretched by ``stretch`` m, negative where it is slack, with ``stiffness`` N/m."""
    return Edge(tuple(map(int, places)), stretch >= 0.0, abs(stretch), float(stiffness), TAUT, SLACK)


def edges_of_slack(rows: np.recarray, points: np.ndarray, material: int, q: np.ndarray) -> list[Edge]:
    """Those of all elements of ``TENSION`` that go slack, each at the point that is nearest to it.

    Parameters
    ----------
    rows : recarray (n,)
        Elements.
    points : (k, 18)
        Table of the shape functions; none (0, 18) for elements that are straight between their nodes.
    material : int
        Place of p among the unknowns of a node.
    q : (n_full,)
        Positions.
    """
    found = []
    for row in rows[rows.slack == 1]:
        length = float(q[row.b + material] - q[row.a + material])
        extra = _elongations(row, points, length, q)
        places = *range(row.a, row.a + AXES), *range(row.b, row.b + AXES)
        stretch = length * float(extra[np.argmin(np.abs(extra))])
        found.append(edge_of_slack(places, stretch, row.stiffness / length))
    return found


def _elongations(row: Any, points: np.ndarray, length: float, q: np.ndarray) -> np.ndarray:
    """|r'| - 1 (k,) of an element at its points, or the one of a straight one: by either strain it is slack at 0."""
    i, j = row.a + np.arange(AXES), row.b + np.arange(AXES)
    slopes = ((q[j] - q[i]) / length)[None]
    if points.size:
        first = points[:, FIRST : FIRST + 4, None]
        slopes = (
            (first[:, 0] * q[i] + first[:, 2] * q[j]) / length + first[:, 1] * q[i + SLOPE] + first[:, 3] * q[j + SLOPE]
        )
    return np.asarray(np.sqrt((slopes**2).sum(axis=1)) - 1.0)
