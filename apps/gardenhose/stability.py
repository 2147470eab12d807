"""What is found of a hose's stability: critical speeds, windows, and eigenvalues along the speeds of flow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from gardenhose.vibration.linear_hose import Plane


class Critical(NamedTuple):
    """A speed, m/s, at which a motion in or out of the plane begins to grow, its frequency Hz, and the way it does."""

    speed: float
    frequency: float
    plane: Plane
    kind: Literal["flutter", "divergence"]


class Window(NamedTuple):
    """Speeds, m/s, between which a hose is unstable, the slower first.

    It begins at the slowest speed looked at where the hose is unstable there, and has no end where it is at the
    fastest.
    """

    begin: float
    end: float | None


class Way(NamedTuple):
    """What a hose does as its water flows faster one way.

    ``sign`` 1 from root to tip, -1 from tip to root. ``speed`` (k,) m/s, rising, those asked for that go this way, and
    0 between those of both ways; ``grows`` (k,) as in `Stability`. ``critical``, ``windows`` and ``stable_from`` as
    there, but of this way, the slowest first.
    """

    sign: float
    speed: np.ndarray
    grows: np.ndarray
    critical: list[Critical]
    windows: list[Window]
    stable_from: float | None

    @property
    def direction(self) -> Literal["root to tip", "tip to root"]:
        """From where to where the water flows."""
        return "root to tip" if self.sign > 0.0 else "tip to root"

    @property
    def slowest(self) -> float:
        """The slowest speed that was looked at, m/s."""
        return float(min(self.speed, key=abs))

    @property
    def fastest(self) -> float:
        """The fastest speed that was looked at, m/s."""
        return float(max(self.speed, key=abs))


class Curves(NamedTuple):
    """Modes along all speeds at which they were computed to be followed, those asked for among them.

    ``speed`` (k,) m/s, rising; ``eigenvalues`` (k, m) 1/s, the columns those of `Stability`; ``out_of_plane`` (k, m);
    ``sure`` (k - 1, m) whether a mode goes on from a speed to the next without doubt; ``marks`` the round ones, in the
    scene's units, of which each is one of the speeds but for rounding.
    """

    speed: np.ndarray
    eigenvalues: np.ndarray
    out_of_plane: np.ndarray
    sure: np.ndarray
    marks: Sequence[float]

    def doubtful(self) -> list[tuple[int, float, float]]:
        """Modes, from 0, and the two speeds between which it is not sure what they go on as."""
        places = zip(*np.nonzero(~self.sure), strict=True)
        return [(int(mode), float(self.speed[k]), float(self.speed[k + 1])) for k, mode in places]


class Stability(NamedTuple):
    """Eigenvalues against speed.

    ``speed`` (k,) m/s, rising; ``eigenvalues`` (k, m) 1/s, each column one mode followed from speed to speed: those
    asked for and all that grow at a speed, not a number where one is no more found, and of a straight hose, which moves
    in all planes alike, those of one plane;
    ``out_of_plane`` (k, m) the share of the motion that is; ``grows`` (k,) whether any motion does, by more than what
    may be rounding; ``critical`` what becomes unstable, the lowest speed first, a plane once for each way of flow, and
    once more where it is unstable without flow; ``stable_from`` the speed, m/s, from which nothing grows that does at
    the slowest one, None where nothing does there or it never ceases; of speeds of both signs that from root to tip.
    ``windows`` between which speeds the hose is unstable, whatever the plane, the slowest first, way after way.
    ``ways`` holds these for each way of flow. ``resolution`` m/s is how far apart the speeds are at which windows were
    looked for: a growth rate that rises above zero and falls again within less may be missed; None where one speed was
    looked at. ``curves`` are the modes at more speeds than were asked for. ``fine_up_to`` m/s is the speed up to which
    elements are short enough for the waves of the flow.
    """

    speed: np.ndarray
    eigenvalues: np.ndarray
    out_of_plane: np.ndarray
    grows: np.ndarray
    critical: list[Critical]
    stable_from: float | None = None
    windows: Sequence[Window] = ()
    resolution: float | None = None
    curves: Curves | None = None
    ways: Sequence[Way] = ()
    fine_up_to: float = np.inf

    @property
    def unstable_at(self) -> Literal["none", "part", "all", "unknown"]:
        """At which of the speeds looked at, rest between those of both signs among them, the hose is unstable.

        Unknown where nothing grows at any, and elements are too coarse for the fastest.
        """
        grows = np.concatenate([way.grows for way in self.ways]) if self.ways else self.grows
        if grows.any():
            return "all" if grows.all() else "part"
        return "unknown" if np.abs(self.speed).max() > self.fine_up_to else "none"
