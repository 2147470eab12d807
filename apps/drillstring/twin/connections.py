"""What each stand tells: when the string was in slips, how much longer it is since, and its steady hook loads.

Hook loads of a string that is picked up, slacked off and turned off bottom at steady speed are the points of a
broomstick plot, from which friction factors are found.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from math import nan
from typing import Any, NamedTuple

import numpy as np

MOTIONS = ("pick_up", "slack_off", "rotating")


class Sample(NamedTuple):
    """What was measured at a time, s: block position m and its rate m/s, positive down; hook load N; rad/s; N m; m."""

    time: float
    block: float
    rate: float
    hook_load: float
    rotary_speed: float
    torque: float
    bit_depth: float


class Connection(NamedTuple):
    """A time in slips.

    ``start`` and ``end``, s, are when the slips took over and gave back half of the string's weight; ``added``, m, is
    by how much higher the block took the string up again than it had put it down: the length of a stand that was added,
    negative of one that was laid down, near zero of slips without a stand. ``bit_depth`` m at the end.
    """

    start: float
    end: float
    added: float
    bit_depth: float


class Plateau(NamedTuple):
    """A stretch of steady motion off bottom.

    ``motion`` is pick_up, slack_off or rotating; ``start`` and ``end`` in s; hook load N as mean and standard deviation
    of single samples; mean surface torque N m; block speed m/s, positive down; rotary speed rad/s; bit depth m at its
    middle; number of samples; number of the stand, that of connections before it.
    """

    motion: str
    start: float
    end: float
    hook_load: float
    hook_load_sd: float
    block_speed: float
    rotary_speed: float
    torque: float
    bit_depth: float
    samples: int
    stand: int


class Connections:
    """Collects times in slips; told of every sample whether the string hangs in them, None where that is not known.

    One whose beginning was not seen is left out: it would tell a wrong length.
    """

    def __init__(self) -> None:
        self.all: list[Connection] = []
        self._start: tuple[float, float] | None = None
        self._was: bool | None = None

    def add(self, sample: Sample, in_slips: bool | None) -> Connection | None:
        """The connection that ends with this sample, if one does."""
        ended = None
        if in_slips and self._was is False:
            self._start = sample.time, sample.block
        elif in_slips is False and self._start is not None:
            begun, block = self._start
            ended = Connection(begun, sample.time, block - sample.block, sample.bit_depth)
            self.all.append(ended)
            self._start = None
        elif in_slips is None:
            self._start = None
        self._was = in_slips
        return ended

    def memory(self) -> dict[str, Any]:
        """What another process needs to know of the slips under way, for JSON."""
        return {"start": self._start, "was": self._was}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on with slips that another process saw set."""
        start = memory["start"]
        self._start, self._was = None if start is None else (float(start[0]), float(start[1])), memory["was"]


class Plateaus:
    """Collects stretches of steady motion.

    Parameters
    ----------
    settling : float
        Time, s, at the beginning of a motion that does not count: the string is stretched, and stops sliding the way it
        slid before.
    leaving : float
        Time, s, at its end that does not count either: the state is told late.
    shortest : float
        Least duration of what is left, s.
    steady : float
        Largest difference of the block's speed from its median, as a share of that.
    """

    def __init__(self, settling: float = 4.0, leaving: float = 1.5, shortest: float = 3.0, steady: float = 0.2) -> None:
        self.settling, self.leaving, self.shortest, self.steady = settling, leaving, shortest, steady
        self.all: list[Plateau] = []
        self._motion: str | None = None
        self._samples: deque[Sample] = deque()

    def add(self, sample: Sample, motion: str | None, stand: int) -> Plateau | None:
        """The plateau that this sample ends, if one does; ``motion`` is one of `MOTIONS`, or None for any other."""
        found = None
        if motion != self._motion:
            found = self._finished(stand)
            self._motion = motion
            self._samples.clear()
        if motion is not None:
            self._samples.append(sample)
        return found

    def _finished(self, stand: int) -> Plateau | None:
        if self._motion is None or not self._samples:
            return None
        first, last = self._samples[0].time + self.settling, self._samples[-1].time - self.leaving
        kept = np.array([one for one in self._samples if first <= one.time <= last])
        if kept.ndim == 2 and self._motion != "rotating":
            usual = np.median(kept[:, 2])
            kept = kept[np.abs(kept[:, 2] - usual) <= self.steady * abs(usual)]
        if kept.ndim != 2 or not len(kept) or kept[-1, 0] - kept[0, 0] < self.shortest:
            return None
        loads = kept[:, 3][np.isfinite(kept[:, 3])]
        if not loads.size:
            return None
        begun, ended = kept[0, 0], kept[-1, 0]
        moved = float((kept[-1, 1] - kept[0, 1]) / (ended - begun)) if self._motion != "rotating" else 0.0
        made = Plateau(
            self._motion, float(begun), float(ended), float(loads.mean()), float(loads.std(ddof=loads.size > 1)), moved,
            _mean(kept[:, 4]), _mean(kept[:, 5]), _mean(kept[:, 6]), len(kept), stand,
        )  # fmt: skip
        self.all.append(made)
        return made


def _mean(values: np.ndarray) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else nan
