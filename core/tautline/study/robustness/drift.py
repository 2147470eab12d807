"""How far a run drifts off its constraints."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.integrators.state import State
from tautline.system.system import System


class Drift:
    """Looks at a run for the largest violation of what multipliers hold, m (or as the constraint's unit is)."""

    def __init__(self, system: System) -> None:
        from tautline.constraints.multiplier import Multipliers

        self.ties: Any = next((g for g in system.groups if isinstance(g, Multipliers)), None)
        self.largest = 0.0

    @property
    def there(self) -> bool:
        """Whether there is anything that multipliers hold."""
        return self.ties is not None and self.ties.unknown.size > 0

    def __call__(self, state: State, t: float, method: Any = None) -> None:
        """Take note of a state."""
        if not self.there:
            return
        e = self.ties.equations
        for i in range(e.offset.size):
            rows = slice(e.start[i], e.start[i + 1])
            gap = float(np.dot(e.factor[rows], state.full_q[e.place[rows]]) + e.offset[i])
            self.largest = max(self.largest, abs(gap))
