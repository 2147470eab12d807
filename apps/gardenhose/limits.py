"""What the run of a hose is judged by: how far its elements fold or stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.cable.model.limits import WITHIN, stretches_within
from tautline.results.assessment.limits import stretch_limits


def limits(result: Any) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames.

    A hose of rubber may stretch: its strain is not judged.
    """
    stretch, places = stretches(*(np.asarray(result[name]) for name in ("arc_length", "position", "slope")))
    return stretch_limits(result.time, stretch, places)


def stretches(s: np.ndarray, position: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """|r'| of shapes (m, k) at nodes and between them, and names of the k places.

    Parameters
    ----------
    s : (nodes,) array
        Unstretched distance of the nodes from the root, m.
    position, slope : (m, nodes, 3) array
        Of the nodes, m and 1.
    """
    length = np.diff(s)
    inside = stretches_within(np.diff(position, axis=1), slope[:, :-1], slope[:, 1:], length)
    at = np.concatenate([s, *(s[:-1] + x * length for x in WITHIN)])
    stretch = np.concatenate([np.linalg.norm(slope, axis=-1), inside], axis=1)
    return stretch, [f"{x:.4g} m from the root" for x in at]
