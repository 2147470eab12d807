"""A window that is gone through anew, a few rows at a time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np

from tautline.twin.estimation.horizon import Sample
from tautline.twin.estimation.log import Checkpoint, Logged


@dataclass
class Passage:
    """How far the spare family has gone through the window. It holds no more than numbers: it can be kept and copied.

    Attributes
    ----------
    begin, reached : float
        Time of the data at which it began, and up to which it has gone, s.
    late : float
        How long after the begin the last blow comes, s.
    kept : deque of Checkpoint
        States of the spare family on the way.
    samples : list of Sample
        What the rows tell that were gone through and observed.
    rows, frames : list
        Those that were gone through and not yet observed, and the frames of all simulations there.
    """

    begin: float
    reached: float
    late: float
    kept: deque[Checkpoint]
    samples: list[Sample] = field(default_factory=list)
    rows: list[Logged] = field(default_factory=list)
    frames: list[np.ndarray] = field(default_factory=list)
