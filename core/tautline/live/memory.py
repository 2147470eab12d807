"""The state of a simulation as one block of bytes: saved, restored, sent to another process."""

from __future__ import annotations

import hashlib
import math
import numbers
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tautline.live.errors import SimulationError


@dataclass(frozen=True, eq=False)
class State:
    """A simulation at an instant. It can be pickled, and restored in any process by a simulation of the same scene.

    Attributes
    ----------
    time : float
        s.
    scene : str
        What the scene is, as `model_hash` of a result.
    layout : str
        What the block holds.
    block : uint8 (n,)
        The bytes of all arrays of the state.
    frames : int
        Frames that were kept until then.
    changed : tuple of str
        Names of parameters that were changed after the start.
    given : tuple of str
        Names of parameters with which the start was found.
    stopped : tuple of str
        Why the simulation cannot go on, and the word of its status; empty where it can.
    explicit : tuple of float
        What is known of the step of an explicit method (`tautline.integrators.explicit_step.ExplicitStep.memory`).
    start, last : str
        Marks of the frame that the run began with, and of the newest that was kept; empty where that is not known.
    displaced : tuple of str
        Names of what was displaced.
    ties : tuple of float
        What displacements have opened of what multipliers tie (`tautline.live.look.Ties.memory`).
    """

    time: float
    scene: str
    layout: str
    block: np.ndarray
    frames: int
    changed: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    stopped: tuple[str, str] = ("", "")
    explicit: tuple[float, ...] = ()
    start: str = ""
    last: str = ""
    displaced: tuple[str, ...] = ()
    ties: tuple[float, ...] = ()

    @property
    def told(self) -> dict[str, Any]:
        """All that it holds beside the block, by name, as numbers, words and lists of them that JSON knows."""
        return {name: read(getattr(self, name)) for name, read in READ.items()}

    def __reduce__(self) -> Any:
        return as_sent, (self.told, self.block, _sum_of(self.told, self.block))


def _sum_of(told: Mapping[str, Any], block: np.ndarray) -> int:
    """A sum of all that a state holds, which hardly any damage leaves as it is."""
    named = repr([(name, told[name]) for name in sorted(told)])
    return zlib.crc32(block, zlib.crc32(named.encode("utf8")))


def number_of(told: Any) -> float:
    """A number of what was sent, which may be infinite or none; raises TypeError for what is no number."""
    if isinstance(told, bool) or not isinstance(told, numbers.Real):
        raise TypeError(told)
    return float(told)


def _time(told: Any) -> float:
    """A time of what was sent, s; raises TypeError or ValueError for what is none."""
    if not 0.0 <= number_of(told) < math.inf:
        raise ValueError(told)
    return float(told)


def word_of(told: Any) -> str:
    """A word of what was sent; raises TypeError for what is none."""
    if not isinstance(told, str):
        raise TypeError(told)
    return told


def _count(told: Any) -> int:
    if isinstance(told, bool) or not isinstance(told, numbers.Integral):
        raise TypeError(told)
    if told < 0:
        raise ValueError(told)
    return int(told)


def _listed(told: Any) -> Sequence[Any]:
    # A word is a sequence too, of letters.
    if not isinstance(told, list | tuple):
        raise TypeError(told)
    return told


def _words(told: Any) -> tuple[str, ...]:
    return tuple(word_of(word) for word in _listed(told))


def _stop(told: Any) -> tuple[str, str]:
    why, word = _words(told)
    return why, word


def _numbers(told: Any) -> tuple[float, ...]:
    return tuple(number_of(number) for number in _listed(told))


READ: dict[str, Callable[[Any], Any]] = {
    "time": _time, "scene": word_of, "layout": word_of, "frames": _count, "changed": _words, "given": _words,
    "stopped": _stop, "explicit": _numbers, "start": word_of, "last": word_of, "displaced": _words, "ties": _numbers,
}  # fmt: skip
"""What a state holds beside its block, and how it is read of what was sent."""


def read_exactly(read: Mapping[str, Callable[[Any], Any]], told: Any) -> dict[str, Any]:
    """What was sent, each name read in its own way.

    Raises
    ------
    SimulationError
        Where a name is missing or another is there, and where what stands under one is not of its kind.
    """
    try:
        if not isinstance(told, Mapping) or told.keys() != read.keys():
            raise KeyError(told)
        return {name: of(told[name]) for name, of in read.items()}
    except (KeyError, OverflowError, TypeError, ValueError):
        raise damaged() from None


def state_of(told: Any, block: np.ndarray) -> State:
    """A state of what was sent of it, whose bytes are known to be undamaged.

    Parameters
    ----------
    told : mapping
        As `State.told` gives it, also by way of JSON.
    block : uint8 (n,)

    Raises
    ------
    SimulationError
        For what is told beside the block and cannot be.
    """
    if not isinstance(block, np.ndarray) or block.dtype != np.uint8:
        raise damaged()
    return State(block=block, **read_exactly(READ, told))


def as_sent(told: Any, block: np.ndarray, expected: int) -> State:
    """A state from another process; there are places in it, and a wrong one would have the loop write anywhere.

    Parameters
    ----------
    told : mapping
        As `State.told` gives it.
    block : uint8 (n,)
    expected : int
        The sum of both.

    Raises
    ------
    SimulationError
        For what has another sum than is expected, and for what is told beside the block and cannot be.
    """
    state = state_of(told, block)
    if _sum_of(state.told, block) != expected:
        raise damaged()
    return state


def damaged() -> SimulationError:
    """The refusal of a state that is not what was saved."""
    return SimulationError("the saved state is damaged, or of another version of Tautline", "save it again")


class Memory:
    """Arrays that together are a state; they are written in place.

    Parameters
    ----------
    arrays : iterable of (str, array)
        Names, which are those of another simulation of the same scene too, and arrays.
    forces : sequence of str
        Names of forces that were added, in their order.
    told : str
        By which numbers places of frames are told, which names and sizes of arrays do not tell.
    """

    def __init__(self, arrays: Iterable[tuple[str, np.ndarray]], forces: Sequence[str] = (), told: str = "") -> None:
        self._views, seen, numbers = [], set(), []
        # Arrays of two forces are alike: by their names alone one is told from another.
        described = [f"force {name}" for name in forces] + ([f"frames {told}"] if told else [])
        for name, array in arrays:
            place = (array.ctypes.data, array.nbytes)
            if array.nbytes == 0 or place in seen:  # an array that two groups share is kept once
                continue
            seen.add(place)
            self._views.append(_bytes_of(array))
            described.append(f"{name} {array.dtype.itemsize} {array.shape}")
            numbers.append(_numbers_in(array))
        ends = np.cumsum([view.size for view in self._views])
        self._parts = [(int(end) - view.size, int(end), view) for end, view in zip(ends, self._views, strict=True)]
        self.size = int(ends[-1]) if len(ends) else 0
        self.layout = hashlib.sha256("\n".join(described).encode()).hexdigest()
        starts = [first + places for (first, _, _), places in zip(self._parts, numbers, strict=True)]
        self._numbers = np.concatenate(starts) if starts else np.zeros(0, np.intp)

    def read(self) -> np.ndarray:
        """A copy of all bytes."""
        return np.concatenate(self._views)

    def write(self, block: np.ndarray) -> None:
        """Put bytes back."""
        for first, last, view in self._parts:
            view[:] = block[first:last]

    def combine(
        self, base: np.ndarray, others: Sequence[np.ndarray], weights: Sequence[float] | np.ndarray
    ) -> np.ndarray:
        """Bytes of the state ``base + sum of weight (other - base)``: a state that is extrapolated along differences.

        Floats are combined where all of them are finite. All else, such as what sticks and what slips, is the base's.
        """
        places = self._numbers[:, None] + np.arange(8)
        mean = base[places].view(np.float64)[:, 0]
        total = mean.copy()
        with np.errstate(invalid="ignore", over="ignore"):
            for other, weight in zip(others, weights, strict=True):
                total += weight * (other[places].view(np.float64)[:, 0] - mean)
        block = base.copy()
        block[places] = np.where(np.isfinite(total), total, mean)[:, None].view(np.uint8)
        return block


def _numbers_in(array: np.ndarray) -> np.ndarray:
    """Where its floats begin, in bytes from its own begin."""
    fields = [(array.dtype, 0)] if array.dtype.names is None else []
    for name in array.dtype.names or ():
        kind, offset = array.dtype.fields[name][:2]
        fields += [(kind.base, offset + 8 * k) for k in range(int(np.prod(kind.shape, dtype=int)))]
    own = np.array([offset for kind, offset in fields if kind == np.float64], np.intp)
    return (np.arange(array.size)[:, None] * array.dtype.itemsize + own).ravel()


def _bytes_of(array: np.ndarray) -> np.ndarray:
    """The bytes of an array, not a copy."""
    plain = array.view(np.ndarray)
    return plain.reshape(-1).view(np.uint8)


def check(state: Any, scene: str, layout: str, size: int) -> None:
    """Refuse what is no state of this simulation; raises SimulationError."""
    cure = "restore what save() of a simulation of the same scene gave"
    if not isinstance(state, State):
        raise SimulationError(f"{type(state).__name__} is no saved state", cure)
    if state.scene != scene:
        raise SimulationError("the state belongs to another scene", cure)
    if state.layout != layout or state.block.dtype != np.uint8 or state.block.shape != (size,):
        cause = (
            "the state was written by another version of the program, or belongs to a simulation with other inputs, "
            "other forces or forces in another order, or another method"
        )
        raise SimulationError(cause, cure)
    if not (np.isfinite(state.time) and state.time >= 0.0):
        raise SimulationError("the state is damaged: it has no time", cure)


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
    frames: Any
    memory: Memory
    forces: list[Any]
