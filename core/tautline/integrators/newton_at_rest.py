"""Newton's method on a scene at rest, compiled: how one iteration follows from residual and tangent."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.kernels.matrix import VECTOR, Factors, factorise_apart, hold_row, new_factors, size_of_row, solve_apart
from tautline.kernels.memory import form_of
from tautline.kernels.separate import separate

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Residual that rounding leaves in a row, over the sum of its stiffnesses times positions."""
FALLS = 0.1
"""Share of the residual before below which an iteration has still brought something."""
STEP_LIMIT, TOLERANCE, SHIFT, PREVIOUS, NEAREST = range(5)
"""Places in ``numbers``: largest change of an unknown in one iteration; residual over its scale that counts as balance;
the shift, 1/s^2; and the residual over its scale of the iteration before and of the nearest so far."""
LEFT, ITERATION, WORST, WORST_THERE = range(4)
"""Places in ``counts``: iterations that may be made, those that were, and the rows that were worst last and at the
nearest residual."""
MORE, FOUND, AWAY, LOOSE = range(4)
"""How a search stands: it may go on, is in balance, has left what numbers can hold, or has a singular stiffness."""


class Search(NamedTuple):
    """A search for rest: what it needs beside the scene, and where it stands.

    ``at_rest`` (k,) are rows that stay where they are, ``scale`` (n,) is what residuals are judged by; ``lever`` (n,)
    says what moves by how much when an unknown changes by one: zero for multipliers, which are no way gone. ``pairs``
    (m, 2) are unknowns whose difference may change by no more than the limit of a step; one that is held is negative.
    ``room`` (m,) is by how many of these limits it may, of each.
    """

    factors: Factors
    at_rest: np.ndarray
    scale: np.ndarray
    lever: np.ndarray
    pairs: np.ndarray
    room: np.ndarray
    numbers: np.ndarray
    counts: np.ndarray


def no_search() -> Search:
    """What stands for no search where a scene is evaluated only."""
    rows, numbers = np.zeros(0, np.int64), np.zeros(0)
    pairs, counts = rows.reshape(0, 2), np.zeros(4, np.int64)
    return Search(new_factors(0, 0), rows, numbers, numbers, pairs, numbers, numbers, counts)


@kernel
def _balances(s, q, x, worst):
    """Whether no row's residual is more than the tolerance and rounding; the worst is asked first, for most are not."""
    tolerance, matrix = s.numbers[TOLERANCE], s.factors.matrix
    if x.size == 0:
        return True
    limit = tolerance * s.scale[worst]
    if abs(x[worst]) > limit and abs(x[worst]) > limit + ROUNDING * size_of_row(matrix, worst, q):
        return False
    for i in range(x.size):
        limit = tolerance * s.scale[i]
        if abs(x[i]) > limit and abs(x[i]) > limit + ROUNDING * size_of_row(matrix, i, q):
            return False
    return True


@separate(int, form_of(no_search()), VECTOR, VECTOR, late=True)
def iterate(s, q, x):
    """One iteration of a search from residual ``x`` (n,) and tangent, in its factors' matrix; returns how it stands.

    Positions ``q`` (n,) are moved; the shift fades as the residual falls. Both residual and tangent are used up. A run
    that begins as it is drawn compiles no search.
    """
    numbers, counts = s.numbers, s.counts
    for row in s.at_rest:
        hold_row(s.factors.matrix, row)
        x[row] = 0.0
    size, worst = 0.0, 0
    for i in range(x.size):
        one = abs(x[i]) / s.scale[i]
        if not np.isfinite(one):
            return AWAY
        if one > size:
            size, worst = one, i
    counts[WORST] = worst
    before = numbers[PREVIOUS]
    numbers[PREVIOUS] = size
    # What rounding may leave is enough only once the residual does not fall any more.
    if _balances(s, q, x, worst) and not numbers[TOLERANCE] < size < FALLS * before:
        return FOUND
    if size < numbers[NEAREST]:
        numbers[NEAREST], counts[WORST_THERE] = size, worst
    if numbers[SHIFT] > 0.0 and np.isfinite(before):
        numbers[SHIFT] *= min(4.0, max(0.1, size / before))
    if factorise_apart(s.factors) != 0:
        return LOOSE
    solve_apart(s.factors, x)
    largest, lost = 0.0, 0.0
    for i in range(x.size):
        one = abs(x[i] * s.lever[i])
        largest = max(largest, one)
        lost += 0.0 * one  # no number or infinite: neither becomes zero
    for k in range(s.pairs.shape[0]):
        i, j = s.pairs[k, 0], s.pairs[k, 1]
        largest = max(largest, abs((x[i] if i >= 0 else 0.0) - (x[j] if j >= 0 else 0.0)) / s.room[k])
    if largest > 0.0 and lost == 0.0:
        share = min(1.0, numbers[STEP_LIMIT] / largest)
        # Rounded before it is taken away: what is one instruction on one processor is two on another.
        for i in range(x.size):
            x[i] *= share
        for i in range(x.size):
            q[i] -= x[i]
    counts[ITERATION] += 1
    return MORE
