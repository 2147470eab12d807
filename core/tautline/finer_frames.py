"""Frames between those that a run stores, kept in memory as they come: what the stored ones miss is seen in them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from tautline.integrators.time_loop import Frames, frames_of
from tautline.results.brief_store import BriefStore
from tautline.results.on_demand import OnDemand
from tautline.results.result import Result
from tautline.system.model import Model

FEW = 3
"""Steps in an interval up to which each of them may have a frame."""


def on_demand(model: Model, frames: Frames) -> OnDemand:
    """The variables of frames that stay as they are, and their time, each made when it is asked for."""
    made = model.seen(frames)
    if not isinstance(made, OnDemand):
        made = OnDemand({name: partial(made.__getitem__, name) for name in made})
    return made.also(time=lambda: frames.time)


class FinerFrames:
    """Further frames of a run, at steps between its own. They are in memory, and nothing is made of them before it is
    asked for.

    Of small scenes a frame costs as much as a step: unless an interval has few steps, two lie between two frames.

    Parameters
    ----------
    count : int
        How many there are at most for each of the run's own, with that one.

    Attributes
    ----------
    own : ndarray, shape (m,)
        Whether a frame is one of the run's own, of the one at the start and all that are due.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self.own = np.ones(1, bool)
        self._rows: list[np.ndarray] = []
        self._taken, self._width = 0, 0

    def divide(self, ends: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Times (m,) s of all frames, and the steps before each, from those of the run's own.

        They stand after whole steps, as evenly as these allow: five steps have frames after 2, 3 and 5.
        """
        begins = np.append(0.0, ends[:-1])
        cuts = {int(n): self._cuts(int(n)) for n in set(steps.tolist())}
        times, counts, own = [], [], [True]
        for begin, end, n in zip(begins, ends, steps.tolist(), strict=True):
            cut = cuts[n]
            times.append(np.append(begin + (end - begin) * cut[:-1] / n, end))
            counts.append(np.diff(cut, prepend=0))
            own += [False] * (cut.size - 1) + [True]
        self.own = np.array(own)
        self._rows, self._taken = [], 0
        return np.concatenate(times), np.concatenate(counts)

    def _cuts(self, steps: int) -> np.ndarray:
        """Steps (k,) of an interval after which a frame stands, its own among them."""
        parts = min(self.count, steps, max(FEW, steps // 2))
        return np.array([round(k * steps / parts) for k in range(1, parts + 1)], np.int64)

    def take(self, frames: Frames) -> Frames:
        """Keep frames as they come, and return those of them that are the run's own."""
        rows = frames.rows.copy()
        own = self.own[self._taken : self._taken + len(rows)]
        self._rows.append(rows)
        self._taken, self._width = self._taken + len(rows), frames.q.shape[1]
        return frames_of(rows[own], self._width)

    def result(self, model: Model, attributes: Mapping[str, Any]) -> Result | None:
        """All frames that were taken, as a result of a run with such attributes; None where there are none."""
        if not self._rows:
            return None
        store = BriefStore(None, model.variables, model.coordinates, dict(attributes))
        store.append(on_demand(model, frames_of(np.concatenate(self._rows), self._width)))
        return store.result
