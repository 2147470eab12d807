"""What either model of a string hands to the builder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np

from tautline.system.system import System


class Observer(Protocol):
    """Reads what an engineer asks about out of a model's frames; ``own`` is how many numbers its groups record."""

    own: int
    on_demand: Callable[[Any], Mapping[str, np.ndarray]] | None
    """As `observe`, each variable made when it is asked for, of frames that stay as they are; None: no such way."""

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        ...

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        ...


class Assembled(NamedTuple):
    """A string's system and observer, and the longest way of an unknown in one iteration towards equilibrium, m."""

    system: System
    observer: Observer
    step_limit: float
