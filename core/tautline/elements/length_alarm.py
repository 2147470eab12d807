"""The alarm of an element between whose nodes no material is left."""

from __future__ import annotations

from tautline.kernels.groups import EMPTY
from tautline.kernels.jit import kernel


@kernel(forceinline=True)
def report_empty(rows, material, q, alarm):
    """Raise the alarm of an element whose length is gone; ``material`` is the place of p among a node's unknowns."""
    for n in range(rows.size):
        if not q[rows[n].b + material] > q[rows[n].a + material]:
            alarm[0] = EMPTY
            alarm[1] = rows[n].a + material
