"""Changes of status of laws that switch (stick, slip), as ``switch`` hooks of groups tell them: how many, and where.

The array ``changed`` (5,) of integers holds them. A kind that does not know windows adds to ``changed[COUNT]`` only;
then it is not known where the matrix is out of date.
"""

from __future__ import annotations

import numpy as np

from tautline.kernels.jit import kernel

COUNT, EVER, PLACED, FIRST, PAST = range(5)
"""Places in ``changed``: changes of status just counted; whether there were any in the step; how many of the changes
are known by their place; the first and past the last full degree of freedom that these stand at."""


def new_changed() -> np.ndarray:
    """No change of a law's status."""
    return np.zeros(5, np.int64)


@kernel
def note_change(changed, place, width):
    """Count a change of status of a law whose force acts on ``width`` full degrees of freedom from ``place`` on."""
    if changed[PLACED] == 0:
        changed[FIRST] = place
        changed[PAST] = place + width
    changed[COUNT] += 1
    changed[PLACED] += 1
    changed[FIRST] = min(changed[FIRST], place)
    changed[PAST] = max(changed[PAST], place + width)
