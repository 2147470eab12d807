"""Vibrations followed over a parameter, such as the speed of a flow: which of one place goes on as which of the next.

Two places are near enough where each motion that is followed has one at the next that is much more like it than any
other, by eigenvalue and shape together. Where they are not, a place between them is looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from tautline.errors import ArgumentError
from tautline.integrators.vibration.vibrations import Vibrations

ROUNDING = 10.0
"""How many times what rounding may make of an eigenvalue it may be off and still be the same."""
MUCH, LARGEST = 0.5, 0.6
"""Unlikeness of one motion that goes on as another without doubt: over that of any other motion, and at most."""
MEETING = 0.25
"""Unlikeness, at most, of a pair and of each of the two real motions that it becomes or is made of."""
REAL, IDLE = 1.0e-6, 0.1
"""Frequency over the size of an eigenvalue up to which it is real, and up to which one that decays is no vibration."""
CLOSE = 0.02
"""Relative distance of eigenvalues that decay alike, at most."""
FOREIGN = 1.0
"""Unlikeness from which a motion that may be another one is: its eigenvalue, its shape, or much of both is another."""
FINEST = 1.0e-3
"""Distance of two places over that of the first from the last below which none is looked for between them."""

Unlikeness = Callable[[Vibrations, Vibrations], np.ndarray]
"""Of each motion (n,) from each of others (m,): 0 of the same and never less, 1 and more of others; (n, m)."""


class Paths(NamedTuple):
    """Motions over a parameter.

    ``place`` (k,) are its values, among them those between that had to be looked at; ``number`` (k, m) that of each
    motion at a place, -1 where it is not found; ``sure`` (k - 1, m) whether a motion goes on from a place to the next
    without doubt, or ends there without doubt: one of two real ones that become a pair does. Where all that is left is
    much unlike a motion it is not found from there on, and that is not sure.
    """

    place: np.ndarray
    number: np.ndarray
    sure: np.ndarray


def follow(
    at: Callable[[float], Vibrations],
    places: Sequence[float],
    count: int,
    unlikeness: Unlikeness,
    growing: Callable[[Vibrations], np.ndarray],
    most: int,
) -> Paths:
    """Follow the slowest motions of the first place over all, and beside them those that grow anywhere.

    What grows at some place need not be slow at the first one: with heavy damping it is none of the slowest there.

    Parameters
    ----------
    at : callable
        Motions at a place.
    places : sequence of float
        Rising or falling, one at least.
    count : int
        Motions of the first place that are followed, those that there are at most.
    unlikeness : callable
        Of the motions of two places, of the eigenvalue's unit none.
    growing : callable
        Whether each motion of a place grows, (n,) bool.
    most : int
        Places between those given that are looked at, at most.

    Raises
    ------
    ArgumentError
        Without a place.
    """
    if not len(places):
        raise ArgumentError("no place to follow motions from")
    places, known, added = list(places), dict[tuple[float, float], np.ndarray](), 0
    falling, span = places[0] > places[-1], abs(places[-1] - places[0])
    while True:
        for pair in pairwise(places):
            if pair not in known:
                known[pair] = unlikeness(at(pair[0]), at(pair[1]))
        motions = [at(place) for place in places]
        number, sure = _paths(motions, [known[pair] for pair in pairwise(places)], count, growing)
        wide = np.abs(np.diff(places)) > FINEST * span
        between = [0.5 * (places[k] + places[k + 1]) for k in np.flatnonzero(wide & ~sure.all(axis=1))]
        if not between or added >= most:
            return Paths(np.array(places), number, sure)
        new = between[: most - added]
        added += len(new)
        places = sorted([*places, *new], reverse=falling)


def apart(before: Vibrations, after: Vibrations, least: float = 0.0) -> np.ndarray:
    """Distances (n, m) of eigenvalues (n,) and (m,) over the larger; those of what is nothing but rounding are none.

    ``least``, 1/s, is the least that they are over: where a motion diverges its eigenvalue passes zero, and how far one
    there is from the next, over themselves, gets no less with nearer places.
    """
    size = np.maximum(np.maximum(np.abs(before.value)[:, None], np.abs(after.value)), least)
    rounding = ROUNDING * np.maximum(before.rounding[:, None], after.rounding)
    return np.abs(before.value[:, None] - after.value) / np.maximum(np.maximum(size, rounding), 1e-300)


def _paths(
    motions: Sequence[Vibrations],
    unlike: Sequence[np.ndarray],
    count: int,
    growing: Callable[[Vibrations], np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Columns, as those of `Paths`, of the slowest motions at the first place, and of those that grow at any."""
    nothing = np.zeros((len(motions), 0), int)
    number, sure = _onward(motions, unlike, _slowest(motions[0], count), nothing)
    for k, one in enumerate(motions):
        for grows in np.flatnonzero(growing(one)):
            if grows in number[k]:
                continue
            start = np.array([grows])
            after, sure_after = _onward(motions[k:], unlike[k:], start, number[k:])
            back = [one.T for one in unlike[:k]][::-1]
            before, sure_before = _onward(motions[k::-1], back, start, number[k::-1])
            number = np.hstack([number, np.concatenate([before[:0:-1], after])])
            sure = np.hstack([sure, np.concatenate([sure_before[::-1], sure_after])])
    return number, sure


def _slowest(motions: Vibrations, count: int) -> np.ndarray:
    """Numbers of the slowest motions. Real ones of heavy damping belong to no vibration: they come last."""
    damped = (np.abs(motions.value.imag) <= REAL * np.abs(motions.value)) & (motions.value.real <= 0.0)
    return np.argsort(np.abs(motions.value) + np.where(damped, np.inf, 0.0), kind="stable")[:count]


def _onward(
    motions: Sequence[Vibrations], unlike: Sequence[np.ndarray], start: np.ndarray, taken: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Columns of motions of the first place, going on as none of those that are taken at each place (k, n)."""
    number, sure = [start], []
    for (before, after), costs, others in zip(pairwise(motions), unlike, taken[1:], strict=True):
        free = np.setdiff1d(np.arange(after.value.size), others)
        those, certain = _next(before.value, after.value, costs, number[-1], free)
        number.append(those)
        sure.append(certain)
    return np.array(number), np.array(sure, bool).reshape(len(motions) - 1, start.size)


def _idle(value: np.ndarray) -> np.ndarray:
    """Whether motions decay and hardly vibrate, as fast ones of heavy damping do, which lie ever closer together."""
    return (value.real <= 0.0) & (np.abs(value.imag) <= IDLE * np.abs(value))


def _next(
    before: np.ndarray, after: np.ndarray, costs: np.ndarray, those: np.ndarray, free: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which motions, of those that are free, go on with some of the place before, and whether without doubt."""
    found, sure = np.full(those.size, -1), np.full(those.size, True)
    held = np.flatnonzero(those >= 0)
    if not held.size or not after.size:
        return found, sure
    real_before, real_after = (np.abs(value.imag) <= REAL * np.abs(value) for value in (before, after))
    idle_before, idle_after = _idle(before), _idle(after)
    rows, columns = linear_sum_assignment(costs[those[held]][:, free])
    found[held[rows]] = free[columns]
    for m in held:
        i, j, nearest = those[m], found[m], int(np.argmin(costs[those[m]]))
        close = np.abs(before[i] - after) <= CLOSE * np.abs(before[i])
        idle = j >= 0 and idle_before[i] and idle_after[j] and bool(costs[i, j] < MEETING or close[j])
        # The one that it is by far most like goes on with another: it ends. Two real ones become one pair.
        if not idle and (j < 0 or MUCH * costs[i, j] > costs[i, nearest]):
            found[m] = -1
            joins = real_before[i] and not real_after[nearest] and costs[i, nearest] < MEETING
            sure[m] = joins or (idle_before[i] and bool((idle_after & close).any()))
            continue
        if not real_before[i] and real_after[j]:
            j = found[m] = _growing_half(costs[i], after, j, np.setdiff1d(free[real_after[free]], found))
        if idle:
            continue  # Of many that decay alike, which is which is not asked.
        beside, above = np.delete(costs[i], j), np.delete(costs[:, j], i)
        if costs[i, j] < MEETING and real_before[i] != real_after[j]:
            # Of two real ones that a pair becomes, or that become one, either goes on.
            beside = beside[~np.delete(real_after, j)] if real_after[j] else beside
            above = above[~np.delete(real_before, i)] if real_before[i] else above
        elif costs[i, j] < MEETING and real_before[i] and real_after[j]:
            # Two that a pair became just before are alike in shape. One that grows and one that decays change no place.
            beside = beside[~np.delete(real_after & (after.real * after[j].real < 0.0), j)]
            above = above[~np.delete(real_before & (before.real * before[i].real < 0.0), i)]
        others = min(beside.min(initial=np.inf), above.min(initial=np.inf))
        sure[m] = costs[i, j] < LARGEST and costs[i, j] <= MUCH * others
        if costs[i, j] >= FOREIGN:
            found[m] = -1
    return found, sure


def _growing_half(costs: np.ndarray, after: np.ndarray, one: int, others: np.ndarray) -> int:
    """Of two real motions that a pair has become the one that grows, or decays slower: it is the one that diverges.

    They part so fast that the slower half may be less like the pair than the other: half as much is still one of it.
    """
    halves = [one, *others[costs[others] < max(MEETING, costs[one] / MUCH)]] if costs[one] < MEETING else [one]
    return int(max(halves, key=lambda k: after[k].real))
