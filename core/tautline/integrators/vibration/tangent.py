"""Whether the tangent is the derivative of the residual: along random directions, at a state of a run."""

from __future__ import annotations

import numpy as np

from tautline.integrators.generalized_alpha import GeneralizedAlpha
from tautline.integrators.linearise import SUMS
from tautline.integrators.state import State
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand, reduce
from tautline.kernels.jit import entry
from tautline.kernels.matrix import clear, new_matrix, rows_of
from tautline.system.system import System

DIRECTIONS = 3
DROWNED = 1.0e-6
"""Share of the largest of the three parts below which a part is rounding of the residual."""
ROUNDED = 1.0e-6
"""Share of the largest row's terms below which a row's own are taken for that much: they drown in rounding."""
SHARES = (1.0e3, 1.0, 1.0e-3, 1.0e-5, 1.0e-7)
"""Of the way of a step: how far a difference reaches. Of each row the best counts: rounding spoils the small, kinks the
large."""

KINKED, ASIDE = 1.0e-3, 1.0e-2
"""Error of a row from which the state is looked at again a little aside, and how far of the way of a step that is."""


@entry
def _linearised(groups, dofs, state, t, cm, cc, ck, matrix, residual):
    """Residual (n,) of the state as it stands, and where any of them is positive the matrix cm M + cc C + ck K."""
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    expand(dofs, state.a, state.full_a)
    state.residual.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
    reduce(dofs, state.residual, residual)
    if cm + cc + ck > 0.0:
        clear(matrix)
        over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)
        over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)


def tangent_error(system: System, state: State, t: float, method: GeneralizedAlpha, seed: int = 1) -> float:
    """Largest difference of the tangent of the last step and a difference of its residual, relative.

    The parts that belong to position, velocity and acceleration are compared one by one, and of each every row with
    its own size: at a usual step the mass is nearly all of the whole, and a stiff part would hide a soft one beside it.
    A row's size is what its terms would be together if none cancelled another.

    Parameters
    ----------
    system : System
    state : State
        After an accepted step that ends at t, s. It is left as it was.
    method : GeneralizedAlpha
        That has made the step.

    Returns
    -------
    float
        Over a few random directions; zero where nothing is free or no step was made.
    """
    h, n = float(method.last_step[0]), system.size
    if h <= 0.0 or n == 0:
        return 0.0
    beta = (1.0 - method.alpha_m) / (method.beta * h * h * (1.0 - method.alpha_f))
    parts = (0.0, 0.0, 1.0), (0.0, method.gamma / (method.beta * h), 0.0), (beta, 0.0, 0.0)
    random, lengths = np.random.default_rng(seed), _lengths(state, method.length, h)
    ways = [random.uniform(-1.0, 1.0, n) * lengths for _ in range(DIRECTIONS)]
    kept = [array.copy() for array in state]
    found = _errors_of_rows(system, state, t, parts, ways)
    if found.max() > KINKED:
        # A step may leave a law on kinks in several unknowns, as it leaves a bit whose blades have cut:
        # there no tangent is right for all directions. A little aside it is smooth.
        for part in parts:
            _move(state, [array.copy() for array in state], ASIDE * random.uniform(-1.0, 1.0, n) * lengths, part)
        found = np.minimum(found, _errors_of_rows(system, state, t, parts, ways))
    for array, values in zip(state, kept, strict=True):
        array[...] = values
    return float(found.max())


def _errors_of_rows(
    system: System, state: State, t: float, parts: tuple[tuple[float, float, float], ...], ways: list[np.ndarray]
) -> np.ndarray:
    """Largest relative error of each row (n,) of the tangent at a state, over its parts and some ways (n,) to go."""
    n = system.size
    groups = system.link(SUMS)
    matrix, none = new_matrix(n, system.bandwidth, system.border), new_matrix(0, 0)
    kept, tangents = [array.copy() for array in state], []
    rows = np.zeros((3, n))
    for part in parts:
        _linearised(groups, system.dofs, state, t, *part, matrix, rows[0])
        tangents.append(rows_of(matrix))
    worst = np.zeros(n)
    for x in ways:
        products = [tangent @ x for tangent in tangents]
        terms = [(abs(tangent) @ np.abs(x)) / system.scale for tangent in tangents]
        largest = max(float(term.max()) for term in terms)
        for part, product, term in zip(parts, products, terms, strict=True):
            if term.max() <= DROWNED * largest:
                continue
            size = system.scale * np.maximum(term, ROUNDED * largest)
            best = np.full(n, np.inf)
            for share in SHARES:
                for sign, row in ((1.0, 1), (-1.0, 2)):
                    _move(state, kept, sign * share * x, part)
                    _linearised(groups, system.dofs, state, t, 0.0, 0.0, 0.0, none, rows[row])
                # A law that is just slipping stands on a kink, and the tangent is that of one of its sides.
                sides = (rows[1] - rows[2]) / 2.0, rows[1] - rows[0], rows[0] - rows[2]
                wrong = np.min([np.abs(side / share - product) for side in sides], axis=0)
                best = np.minimum(best, wrong / size)
            worst = np.maximum(worst, best)
    for array, values in zip(state, kept, strict=True):
        array[...] = values
    return worst


def _lengths(state: State, length: np.ndarray, h: float) -> np.ndarray:
    """How far each unknown goes in a step, and some part of the largest at least: (n,)."""
    way = h * np.abs(state.v) + h * h * np.abs(state.a)
    known = np.where(length > 0.0, length, 1.0)
    return np.maximum(way, 1e-3 * float((way * known).max(initial=0.0)) / known) + 1e-9 / known


def _move(state: State, kept: list[np.ndarray], x: np.ndarray, part: tuple[float, float, float]) -> None:
    """Move accelerations, velocities or positions alone as a correction of the step by x would: part (cm, cc, ck)."""
    cm, cc, ck = part
    state.q[:] = kept[0] + ck * x
    state.v[:] = kept[1] + cc * x
    state.a[:] = kept[2] + cm * x
