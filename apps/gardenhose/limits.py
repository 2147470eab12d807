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
    s, position, slope = (np.asarray(result[name]) for name in ("arc_length", "position", "slope"))
    length = np.diff(s)
    inside = stretches_within(np.diff(position, axis=1), slope[:, :-1], slope[:, 1:], length)
    at = np.concatenate([s, *(s[:-1] + x * length for x in WITHIN)])
    stretch = np.concatenate([np.linalg.norm(slope, axis=-1), inside], axis=1)
    return stretch_limits(result.time, stretch, [f"{x:.4g} m from the root" for x in at])
