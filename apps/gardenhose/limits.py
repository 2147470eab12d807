"""What the run of a hose is judged by: how far its elements fold or stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.results.assessment.limits import stretch_limits


def limits(result: Any) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames.

    A hose of rubber may stretch: its strain is not judged.
    """
    places = [f"{x:.4g} m from the root" for x in np.asarray(result["arc_length"])]
    return stretch_limits(result.time, np.linalg.norm(np.asarray(result["slope"]), axis=-1), places)
