"""What a simulation works with, for what stands beside it: a linearisation, a twin."""

from __future__ import annotations

from typing import Any, NamedTuple

from tautline.integrators.time_loop import Frames
from tautline.live.memory import Memory


class Parts(NamedTuple):
    """What a simulation works with: its own arrays, no copies, as they are until a force is added or it is restored.

    Attributes
    ----------
    state : tautline.integrators.state.State
    method : NamedTuple
        Of integration, with its arrays.
    frames : Frames
        The one frame that it stands at.
    memory : Memory
        Of all that a saved state holds.
    forces : list
        Those that were added.
    """

    state: Any
    method: Any
    frames: Frames
    memory: Memory
    forces: list[Any]
