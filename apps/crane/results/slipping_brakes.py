"""Brakes that were closed in a run and let their drums turn."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from crane.assembly.friction import closure_of
from crane.assembly.held_loads import CLOSED
from crane.scene.scene import CraneScene, Drum
from tautline.kernels.time_function import sample
from tautline.results.resumption import INPUTS_DRIVEN
from tautline.scene.functions import Constant
from tautline.system.time_functions import FunctionRequest, compile_functions

SLIPS = 0.01
"""Share of the radius by which rope passes a drum that slips. What holds a drum gives way by a thousandth of that."""
TURNS = 0.001
"""Share of the radius, 1/s, from which on the speed of the rope is that of a drum that turns.

A drum that creeps to a stop passes less than `SLIPS` below it, if it is slowed down by 5e-5 R/s2 or more. One that
is held gives way slower: by 4e-5 R/s as its motor jumps by four fifths of the load's moment.
"""
FALLS = 0.01
"""Share of its speed that a drum loses that slows down."""
PARTS = 20
"""Parts of the time between two frames at whose ends it is looked whether a brake is closed."""
HALVINGS = 40
"""Of the time within which a brake closes: rounding is all that is left then."""
ROUNDING = 1.0e-9
"""Share by which two times that are the same may differ: of the last frame and solver.end, of a corner and a frame."""


class Slip(NamedTuple):
    """Rope that passed a drum under its closed brake."""

    begin: float
    """Time of the last frame before it, s."""
    passed: float
    """Rope, m, positive out."""
    held: bool
    """Whether the drum was at rest in that closure before; if not, it turned throughout."""
    unfinished: bool = False
    """Whether the last frame finds the brake slowing down a drum that turned throughout."""


class Closure(NamedTuple):
    """What a function tells of a brake."""

    is_closed: Callable[[np.ndarray], np.ndarray]
    """Of times (k,), s, whether the brake is closed, as bool (k,)."""
    corners: np.ndarray
    """Times (n,), s, at which the closure has a corner: there it is least, if it is a table."""


def remarks(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on brakes that slipped while they were closed; none of brakes that were driven from outside.

    A brake that stops a drum that turned when it closed has done its work: nothing is said of it.

    Parameters
    ----------
    result : Result
        With ``paid_out``; of one that keeps statistics nothing is told, with windows or without.
    scene : CraneScene
    """
    # Between the windows of statistics nobody knows what passed while the brake was open.
    if scene.output.statistics or result.attributes.get(INPUTS_DRIVEN):
        return []
    if "paid_out" not in result or "pay_out_speed" not in result:
        return []
    time, paid_out, speed = (np.asarray(a, float) for a in (result.time, result["paid_out"], result["pay_out_speed"]))
    # A run that was stopped, or is looked at on its way, is not helped by a later end.
    stopped = bool(time[-1] < scene.solver.end * (1.0 - ROUNDING))
    found = []
    for k, drum in enumerate(scene.drums):
        if drum.prescribed or drum.brake is None or drum.brake.torque == 0.0:
            continue
        rest = TURNS * drum.radius
        closure, spans = _closures(drum, time)
        for slip in slips_of(time, paid_out[:, k], speed[:, k], rest, spans, SLIPS * drum.radius):
            if slip.held:
                found.append(_of_held(drum, slip))
            else:
                closed = slip.begin if closure is None else closing(time, slip.begin, *closure)
                found.append(_of_turning(drum, slip, closed, stopped, float(time[-1])))
    return found


def _moment(time: float) -> str:
    """A time in s to the millisecond, without zeros at its end."""
    return f"{time:.3f}".rstrip("0").rstrip(".")


def _rope(slip: Slip) -> str:
    return f"{abs(slip.passed):.3g} m of rope {'ran out' if slip.passed > 0.0 else 'was taken in'}"


def _of_held(drum: Drum, slip: Slip) -> str:
    closure = closure_of(drum)
    share = " times brake.closed" if isinstance(closure, Constant) and closure.value < CLOSED else ""
    return (
        f"the brake of {drum.name} slipped while it was closed, from t = {_moment(slip.begin)} s: {_rope(slip)} while "
        f"it stayed closed. Its heat and wear are not computed. If it is to hold, give brake.torque{share} more than "
        "the load and the motor pull with"
    )


def _of_turning(drum: Drum, slip: Slip, closed: float, stopped: bool, end: float) -> str:
    """Of a brake that closed at a time, s, on a drum that turned, in a run that was perhaps stopped; its end, s."""
    since = "" if _moment(slip.begin) == _moment(closed) else f"from the frame at t = {_moment(slip.begin)} s on, "
    rope = f"{since}{_rope(slip)} while it stayed closed"
    begins = f"the brake of {drum.name} was closed at t = {_moment(closed)} s on a drum that turned, and"
    if slip.unfinished and stopped:
        return (
            f"{begins} slowed it down. It had not stopped the drum when the run stopped. The last frame is at "
            f"t = {_moment(end)} s. Until then: {rope}"
        )
    if slip.unfinished:
        return (
            f"{begins} slowed it down. The run ended while it still turned: {rope}. Whether the brake stops it is not "
            "known. To see it, give a later solver.end"
        )
    return (
        f"{begins} did not stop it: {rope}. Its heat and wear are not computed. If it is to stop the drum, give more "
        "brake.torque, or keep it closed for longer"
    )


def _closures(drum: Drum, time: np.ndarray) -> tuple[Closure | None, list[tuple[int, int]]]:
    """What closes a brake, None for a constant, and its closures of :func:`closures_of`."""
    closure = closure_of(drum)
    if isinstance(closure, Constant):
        # One that stays partly closed holds with that share of its torque, and slips beyond it.
        return None, [(0, time.size)] if closure.value > 0.0 else []
    function = compile_functions([FunctionRequest(closure)])
    made = Closure(lambda moments: sample(function, 0, moments)[:, 0] >= CLOSED, function.breaks)
    return made, closures_of(time, *made)


def closures_of(
    time: np.ndarray, is_closed: Callable[[np.ndarray], np.ndarray], corners: np.ndarray
) -> list[tuple[int, int]]:
    """Frames, from the first to the last not counted, between which a brake is closed all the time.

    Parameters
    ----------
    time : (m,) array
        Of the frames, s.
    is_closed : callable
        Tells of times (k,) whether the brake is closed, as bool (k,).
    corners : (n,) array
        Times, s, at which the closure has a corner: there it is least, if it is a table.
    """
    closed = is_closed(time)
    opened = np.zeros(max(time.size - 1, 0), bool)
    # A brake may open and close again between two frames. One part after the other, so as to hold no more than frames.
    for part in np.arange(1, PARTS) / PARTS:
        opened |= ~is_closed(time[:-1] + part * np.diff(time))
    within = corners[(corners > time[0]) & (corners < time[-1])]
    opened[np.searchsorted(time, within[~is_closed(within)]) - 1] = True
    found: list[tuple[int, int]] = []
    edges = np.flatnonzero(np.diff(np.concatenate([[0], closed.astype(int), [0]])))
    for first, end in edges.reshape(-1, 2).tolist():
        cuts = first + 1 + np.flatnonzero(opened[first : end - 1])
        found += itertools.pairwise([first, *cuts.tolist(), end])
    return found


def closing(
    time: np.ndarray, begin: float, is_closed: Callable[[np.ndarray], np.ndarray], corners: np.ndarray
) -> float:
    """When a brake closed, s, that is closed at a frame and was open between that frame and the one before.

    Where it was open at no time that is looked at, as at the first frame, this is the time of the frame itself.

    Parameters
    ----------
    time : (m,) array
        Of the frames, s.
    begin : float
        Time of the frame, s.
    is_closed, corners
        As of :func:`closures_of`.
    """
    at = int(np.searchsorted(time, begin))
    if at == 0:
        return begin
    before = float(time[at - 1])
    within = corners[(corners > before) & (corners < begin)]
    moments = np.union1d(np.linspace(before, begin, PARTS + 1), within)
    opened = np.flatnonzero(~is_closed(moments[:-1]))
    if not opened.size:
        return begin
    last = int(opened[-1])
    still, closed = float(moments[last]), float(moments[last + 1])
    for _ in range(HALVINGS):
        middle = 0.5 * (still + closed)
        if is_closed(np.array([middle]))[0]:
            closed = middle
        else:
            still = middle
    # What closes smoothly is all but closed before the corner at which it has closed.
    after = corners[(corners >= closed) & (corners <= begin + ROUNDING * abs(begin))]
    return float(after.min(initial=begin)) if after.size else closed


def slips_of(
    time: np.ndarray,
    paid_out: np.ndarray,
    speed: np.ndarray,
    rest: float,
    closures: list[tuple[int, int]],
    least: float,
) -> list[Slip]:
    """The longest slip of a drum that its brake had held, of one that it did not stop, and of one it had yet to stop.

    A drum that turns when its brake closes is looked at from where it has come to rest. One that still turns as the run
    ends, and slows down, the brake had yet to stop.

    Parameters
    ----------
    time, paid_out, speed : (m,) array
        s; m of rope since the start; its rate, m/s.
    rest : float
        Speed, m/s, up to which the drum is at rest.
    closures : list of (int, int)
        Of :func:`closures_of`.
    least : float
        Rope, m, that counts as slip.

    Returns
    -------
    list of Slip
        None of a kind that there was not. All of one is of the same closure, the one with the most rope.
    """
    found: dict[tuple[bool, bool], Slip] = {}
    for first, end in closures:
        still = np.flatnonzero(_at_rest(speed[first:end], rest))
        held = bool(still.size)
        start = first + int(still[0]) if held else first
        passed = paid_out[start:end] - paid_out[start]
        over = np.flatnonzero(np.abs(passed) > least)
        if over.size:
            begin = float(time[start + max(int(over[0]) - 1, 0)]) if held else float(time[first])
            far = float(passed[np.argmax(np.abs(passed))])
            unfinished = not held and end == time.size and _slows_down(time[first:], speed[first:])
            kind = held, unfinished
            if kind not in found or abs(far) > abs(found[kind].passed):
                found[kind] = Slip(begin, far, held, unfinished)
    return list(found.values())


def _at_rest(speed: np.ndarray, rest: float) -> np.ndarray:
    """Of each frame, whether the drum is at rest, or turned back since the frame before and so was at rest between."""
    back = np.concatenate([[False], speed[1:] * speed[:-1] < 0.0])
    return (np.abs(speed) <= rest) | back


def _slows_down(time: np.ndarray, speed: np.ndarray) -> bool:
    """Whether the speed falls, by the straight line through the last half of its values.

    A load that bounces swings the speed about that line; of a fall by less than `FALLS` nobody knows what it comes to.
    """
    last = max(2, (time.size + 1) // 2)
    lapse, size = time[-last:] - time[-1], np.abs(speed[-last:])
    slope = float(np.polyfit(lapse, size, 1)[0])
    return bool(slope * lapse[0] > FALLS * float(size.max()))
