"""Frames that move by prescription: the vessel, and booms that slew and luff upon it.

A point is drawn in ground coordinates with every frame at rest. While the frames move, a point drawn at x in a frame
with pivot p stands at ``C + R (x - p)``, C being where the pivot is. Both follow from the frame's six motions and its
parent, exactly and for large angles, with two derivatives that are carried through each product: nothing is
differenced.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crane.sea.content import GOLDEN
from tautline.kernels.moving_frame import ENTRIES, places_of
from tautline.kernels.time_function import TimeFunctions, sample, sample_all
from tautline.scene.errors import Problem, SceneError
from tautline.scene.functions import Constant
from tautline.system.time_functions import FrameEntry, FrameSet, FunctionRequest, Steering, compile_functions

GROUND = -1
MOTIONS = ("surge", "sway", "heave", "roll", "pitch", "yaw")

LOOKS = np.arange(1, 102) * GOLDEN % 1.0
"""Shares of the run at which a motion's size is looked at."""
JUMP = 1.0e-6
"""Share of its largest rate, or second rate, by which a motion jumps where it is not called smooth."""
GRACE = 1.0
"""Time by which the last piece outlasts the run, s: the run's last instant must not lie where all is held."""

SPEED = "_speed"
"""What is behind the name of a motion where its speed is driven."""
STILL = (Constant(value=0.0),) * len(MOTIONS)


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame and how it moves in its parent.

    A point x of it stands at ``pivot + (surge, sway, heave) + Rz(yaw) Ry(pitch) Rx(roll) (x - pivot)`` in its parent.
    A boom is a frame whose yaw is its slew and whose pitch is its luff: about the slewed boom's own y, so that a
    positive luff lowers a boom that points along x.

    Attributes
    ----------
    name : str
        Its name.
    parent : int
        Its parent's place in the list of frames, before its own, or `GROUND`.
    pivot : tuple of float
        The point that it turns about, drawn at rest, m.
    motion : tuple of 6
        Functions of time (models of `tautline.scene.functions`, or `Samples`) in the order of `MOTIONS`: m, rad.
    key : str
        Where it stands in the scene, for messages.
    words : tuple of 6 str
        What the scene calls its motions.
    """

    name: str
    parent: int
    pivot: tuple[float, float, float]
    motion: tuple[Any, ...] = field(default=STILL)
    key: str = ""
    words: tuple[str, ...] = MOTIONS

    def motion_key(self, i: int) -> str:
        """Where its i-th motion stands in the scene."""
        return f"{self.key or self.name}.{self.words[i]}"

    def inputs_of(self, i: int) -> tuple[str, str]:
        """Names under which its i-th motion and the speed of that are driven while a run goes on."""
        name = f"{self.name}.{self.words[i]}"
        return name, name + SPEED


def boom(name: str, parent: int, pivot: tuple[float, float, float], slew: Any, luff: Any, key: str = "") -> Frame:
    """Frame of a boom that slews about its parent's z, then luffs about its own y, both rad."""
    still = STILL[0]
    words = (*MOTIONS[:4], "luff", "slew")
    return Frame(name, parent, pivot, (still, still, still, still, luff, slew), key, words)


def motion_of(frames: Sequence[Frame], values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place of every frame while its motions have given values; see `tautline.kernels.moving_frame.places_of`.

    Parameters
    ----------
    frames : sequence of Frame
        Parents before children.
    values : float64 (frames, 6, m, 3)
        Value, rate and second rate of every frame's motions at m times.

    Returns
    -------
    value, rate, second : float64 (m, frames, 12)
        C and the three columns of R, and their first and second time derivatives.
    """
    return places_of(_parents(frames), np.array([frame.pivot for frame in frames]), np.asarray(values, dtype=float))


def _parents(frames: Sequence[Frame]) -> np.ndarray:
    for k, frame in enumerate(frames):
        if frame.parent != GROUND and not 0 <= frame.parent < k:
            raise ValueError(f"frame {frame.name} stands before its parent")
    return np.array([frame.parent for frame in frames], dtype=np.int64)


def point_of(entries: np.ndarray, pivot: Sequence[float], point: Sequence[float]) -> np.ndarray:
    """Where a point stands that is drawn in a frame, ``C + R (x - p)``.

    Parameters
    ----------
    entries : float64 (..., 12)
        C and R of the frame.
    pivot, point : sequence of 3 floats
        Where the frame's pivot and the point are drawn, m.

    Returns
    -------
    float64 (..., 3)
        m. Of a derivative of C and R, that derivative of the place.
    """
    x, y, z = np.subtract(point, pivot)
    return entries[..., :3] + x * entries[..., 3:6] + y * entries[..., 6:9] + z * entries[..., 9:]


def requests_of(frames: Sequence[Frame], end: float, live: Collection[str] = ()) -> list[FunctionRequest]:
    """Functions of time that place every frame, for the time loop; they are made there of the frames' motions.

    Parameters
    ----------
    frames : sequence of Frame
        Parents before children.
    end : float
        Time to which the run goes, s: up to it no motion may jump.
    live : collection of str
        Names of motions (``boom.slew``) that are driven while the run goes on, though they may be at rest now.

    Returns
    -------
    list of FunctionRequest
        Entry j of frame k is request ``12 k + j``: a `Constant` where it does not move, else a `FrameEntry`.

    Raises
    ------
    SceneError
        If a motion or its speed jumps.
    """
    if not frames:
        return []
    functions = _compiled(frames, end)
    for k in range(len(frames)):
        _Path(frames, functions, k, end).check_jumps()
    numbers = np.arange(len(MOTIONS) * len(frames)).reshape(len(frames), len(MOTIONS))
    moves = np.array(
        [
            [_moves(frame, i, functions, n, end, live) for i, n in enumerate(row)]
            for frame, row in zip(frames, numbers, strict=True)
        ]
    )
    there = moves | sample_all(functions, numbers.ravel(), np.zeros(1))[:, 0].any(axis=1).reshape(moves.shape)
    motions = tuple(
        tuple(_motion_request(frame, i, end) if there[k, i] else None for i in range(len(MOTIONS)))
        for k, frame in enumerate(frames)
    )
    made = FrameSet(tuple(int(p) for p in _parents(frames)), tuple(frame.pivot for frame in frames), motions)
    at_first, still = _still_entries(frames, functions, moves)
    return [
        FunctionRequest(
            Constant(value=float(at_first[k, j])) if still[k, j] else FrameEntry(made, k, j), end=end, key=frame.key
        )
        for k, frame in enumerate(frames)
        for j in range(ENTRIES)
    ]


def _motion_request(frame: Frame, i: int, end: float) -> FunctionRequest:
    unit = "m" if i < 3 else "rad"
    name, speed = frame.inputs_of(i)
    what = f"{frame.words[i]} of {frame.name}"
    steered = Steering(name, unit, what), Steering(speed, f"{unit}/s", f"speed of the {what}", 1)
    # Of a boom only slew and luff are its own.
    inputs = steered if i >= 4 or frame.words == MOTIONS else ()
    return FunctionRequest(frame.motion[i], end=end, key=frame.motion_key(i), inputs=inputs)


def _moves(frame: Frame, i: int, functions: TimeFunctions, number: int, end: float, live: Collection[str]) -> bool:
    """Whether a motion has a rate anywhere in the run, or may be given one."""
    if any(name in live for name in frame.inputs_of(i)):
        return True
    if isinstance(frame.motion[i], Constant):
        return False
    breaks = np.unique(_breaks_of(functions, number))
    edges = np.concatenate(([0.0], breaks[(breaks > 0.0) & (breaks < end)], [end]))
    # A move may be short, and at rest at both its ends.
    times = np.concatenate((edges, end * LOOKS, edges[:-1] + GOLDEN * np.diff(edges)))
    return bool(np.any(sample(functions, number, times)[:, 1:]))


def _still_entries(
    frames: Sequence[Frame], functions: TimeFunctions, moves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Entries (frames, 12) at t = 0, and which of them no motion changes, whatever it does.

    Every motion that moves is given rates of its own: an entry that has no rate then depends on none of them.
    """
    start = sample_all(functions, range(functions.entry.size), np.zeros(1)).reshape(len(frames), 6, 1, 3)
    at_first = motion_of(frames, start)[0][0]
    tried = np.repeat(start, 2, axis=2)
    tried[..., 1:] = 0.0
    some = np.random.default_rng(0).uniform(0.3, 0.9, (*moves.shape, 2, 3))
    tried[moves] = some[moves]
    _, rate, second = motion_of(frames, tried)
    return at_first, ~np.any((rate != 0.0) | (second != 0.0), axis=0)


def _compiled(frames: Sequence[Frame], end: float) -> TimeFunctions:
    if not end > 0.0:
        raise ValueError("the end of the run must be later than its start")
    return compile_functions(
        [
            FunctionRequest(motion, end=end, key=frame.motion_key(i))
            for frame in frames
            for i, motion in enumerate(frame.motion)
        ]
    )


def with_grace(time: np.ndarray, derivatives: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Knots (m,), s, and values with two derivatives (3, m, ...), with one more knot after the end.

    It is reached with the last acceleration: the motion goes on as it ends.
    """
    value, rate, second = derivatives[:, -1]
    later = np.array([value + GRACE * (rate + 0.5 * GRACE * second), rate + GRACE * second, second])
    return np.append(time, time[-1] + GRACE), np.concatenate((derivatives, later[:, None]), axis=1)


def _breaks_of(functions: TimeFunctions, i: int) -> np.ndarray:
    """Times at which the formula of a function changes, s."""
    f = functions
    first, last = f.track_from[i], f.track_to[i]
    return np.concatenate(
        (f.breaks[f.break_from[first] : f.break_from[last]], f.waves[f.wave_from[i] : f.wave_to[i], 4])
    )


class _Path:
    """A frame with all those it rides on, and what their motions do in a run."""

    def __init__(self, frames: Sequence[Frame], functions: TimeFunctions, k: int, end: float) -> None:
        self.end = end
        self.functions = functions
        chain = [k]
        while frames[chain[0]].parent != GROUND:
            chain.insert(0, frames[chain[0]].parent)
        self.frames = [frames[k] for k in chain]
        self.indices = [k * len(MOTIONS) + i for k in chain for i in range(len(MOTIONS))]

    def motions(self, time: np.ndarray) -> np.ndarray:
        """Value, rate and second rate of all motions (frames, 6, m, 3), at the end as it is reached."""
        before = np.minimum(time, np.nextafter(self.end, 0.0))
        sampled = np.array([sample(self.functions, i, before) for i in self.indices])
        return sampled.reshape(len(self.frames), len(MOTIONS), time.size, 3)

    def check_jumps(self) -> None:
        """Refuse motions that jump, or whose speed does; raises SceneError naming the motion and the time."""
        breaks = np.unique(np.concatenate([_breaks_of(self.functions, i) for i in self.indices]))
        breaks = breaks[(breaks > 0.0) & (breaks < np.nextafter(self.end, 0.0))]
        jump = np.abs(self.motions(breaks) - self.motions(np.nextafter(breaks, 0.0)))
        edges = np.concatenate(([0.0], breaks, [self.end]))
        between = np.concatenate((self.end * LOOKS, edges[:-1] + GOLDEN * np.diff(edges)))
        largest = np.abs(self.motions(np.union1d(breaks, between))).max(axis=2)
        jumps = jump[..., :2] > JUMP * largest[:, :, None, :2]
        for k, i, at in np.argwhere(np.any(jumps, axis=3)):
            what = "the motion itself jumps" if jumps[k, i, at, 0] else "its speed jumps"
            cure = "use ramps and cubic tables; let a table begin and end flat, with its first and last value twice"
            key = self.frames[k].motion_key(i)
            raise SceneError([Problem("scene", None, key, None, f"{what} at t = {breaks[at]:g} s", cure)])
