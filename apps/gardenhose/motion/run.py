"""A stored run of a hose as the figures want it: the tip between frames, its limit cycle, the plane of its motion."""

from __future__ import annotations

import functools

import numpy as np

from gardenhose.motion.curves import Plane, Trace, plane_of
from gardenhose.motion.limit_cycle import LimitCycle, limit_cycle
from tautline.results.result import Result

CHANGES = 0.05
"""Share of the largest flow speed by which it changes where the speed counts as ramped."""
SPREAD = 6
"""Points between two frames of a curve in time."""


class Run:
    """What the figures need of a result, read once."""

    def __init__(self, result: Result, name: str) -> None:
        self.result, self.name = result, name
        self.time, self.tip, self.tip_velocity = result.time, result["tip"], result["tip_velocity"]
        self.flow = result["flow_speed"] if "flow_speed" in result else np.zeros(len(self.time))
        self.arc_length = result["arc_length"]
        self.length = float(self.arc_length[-1])
        self.cycle: LimitCycle = limit_cycle(self.time, self.tip, self.tip_velocity, self.length)
        self.trace = Trace(self.time, self.tip, self.tip_velocity)

    @functools.cached_property
    def position(self) -> np.ndarray:
        """Of the nodes, (frames, nodes, 3) m."""
        return self.result["position"]

    @functools.cached_property
    def plane(self) -> Plane:
        """The plane that the hose moves in during the cycles that the numbers stand for."""
        inside = (self.time >= self.cycle.start) & (self.time <= self.cycle.end) if self.cycle.cycles else slice(None)
        position = self.position[inside]
        return plane_of(position, towards=(position[:, -1] - position[:, 0]).mean(axis=0))

    @property
    def dense(self) -> np.ndarray:
        """Times of the frames and between them, so that few frames a period still draw round curves."""
        frames = len(self.time)
        return np.interp(np.arange(SPREAD * (frames - 1) + 1) / SPREAD, np.arange(frames), self.time)

    @property
    def settled_time(self) -> np.ndarray:
        """Dense times of the cycles that the numbers stand for; of the whole run where there is none."""
        cycle, per_frame = self.cycle, SPREAD * max(len(self.time) - 1, 1)
        if cycle.cycles == 0:
            return np.linspace(self.time[0], self.time[-1], per_frame + 1)
        share = (cycle.end - cycle.start) / (self.time[-1] - self.time[0])
        return np.linspace(cycle.start, cycle.end, max(200, int(share * per_frame)) + 1)

    @property
    def ramped(self) -> bool:
        """Whether the flow speed changes in the run so that a motion has time to answer."""
        size = float(np.abs(self.flow).max())
        if len(self.time) < 3 or size == 0.0 or np.ptp(self.flow) <= CHANGES * size:
            return False
        changing = np.abs(np.diff(self.flow)) > 1e-6 * size
        spent = float(np.diff(self.time)[changing].sum())
        return spent > 3.0 * self.cycle.period and spent > 0.1 * (self.time[-1] - self.time[0])
