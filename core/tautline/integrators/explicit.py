"""What explicit methods share: scratch, accelerations by M a = F, the way back onto constraints, and the end of a step.

Such a method knows acceleration and reactions at the start of its steps only. :mod:`tautline.integrators.rk4` is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from tautline.integrators.corrector.newton import DONE, SINGULAR
from tautline.integrators.state import WORST, book_losses, book_work, restore, watch, work_of_means
from tautline.integrators.status import Status
from tautline.integrators.stepping import Stepping, add, turned_by
from tautline.kernels import groups as over
from tautline.kernels.dofs import Dofs, expand, prescribe, reduce
from tautline.kernels.factors.band import NARROW
from tautline.kernels.groups import feel_acceleration, has_constant_mass
from tautline.kernels.jit import entry, kernel, stands_for
from tautline.kernels.matrix import Factors, add_at, clear, factorise_matrix, new_factors, solve_inside, solve_matrix
from tautline.kernels.numba_registration import is_array
from tautline.system.model import SolverSettings
from tautline.system.system import MassNumbering, System, number_by_mass

UNSTABLE = int(Status.UNSTABLE)
BEFORE = 1.0 - 1.0e-9
"""Where in a step its last stage sees what is prescribed: a kink at the step's end belongs to the next step."""
SPEED_LIMIT = 1.0e4
"""Speed (m/s or rad/s) beyond which an explicit run has plainly left physics: no slender thing moves twice as fast as
sound in steel."""


class Explicit(NamedTuple):
    """Scratch of an explicit method; each has a class of its own below this one.

    ``mass`` is (n,) where the mass matrix is diagonal, else its factors.
    ``constant`` says whether the mass matrix stays what it is, and ``made`` (1,) whether its factors are there;
    ``driven`` whether anything is moved, and ``coupled`` whether the mass couples that to what is free; ``felt``
    whether forces depend on accelerations otherwise than by the mass. The mass matrix
    has its own order of the unknowns, ``dofs`` and ``order``: see `tautline.system.system.MassNumbering`.
    ``projection`` are the factors of (B, G^T; G, 0) that put a step back onto the constraints ``stabilise`` times, B
    being the unit matrix (eq. 2.128), or empty where B = M (eq. 2.127); ``algebraic`` lists the multipliers.
    """

    mass: np.ndarray | Factors
    made: np.ndarray
    constant: int
    slopes: np.ndarray
    power: np.ndarray
    at: np.ndarray
    coupled: int
    driven: int
    felt: int
    projection: Factors
    stabilise: int
    algebraic: np.ndarray
    change: np.ndarray
    dofs: Dofs
    order: np.ndarray


def new_scratch(kind: type[Explicit], system: System, settings: SolverSettings) -> Any:
    """Make the scratch of an explicit method for a system; ``kind`` is its class."""
    projection, stabilise = settings.projection, settings.stabilise
    # With multipliers the mass matrix has rows of another kind, and nothing but masses is solved for.
    felt = feel_acceleration(system.groups) and system.algebraic.size == 0
    n, by_mass = system.size, _as_it_is(system) if felt else number_by_mass(system)
    driven = int(system.dofs.driven.size > 0)
    diagonal = by_mass.bandwidth == 0 and by_mass.border == 0
    # Fewer diagonals than the narrow kernel takes would only be slower.
    size = n, max(by_mass.bandwidth, NARROW), by_mass.border
    identity = projection == "identity" and system.algebraic.size > 0 and stabilise > 0
    factors = new_factors(*size) if identity else new_factors(0, 0)
    if identity:
        algebraic = np.argsort(by_mass.order)[system.algebraic]
        _write_projection(system.link(("constraint_mass",)), by_mass.dofs, system.q, factors.matrix, algebraic)
        factorise_matrix(factors)
    return kind(
        np.zeros(n) if diagonal and not felt else new_factors(*size), np.zeros(1),
        int(has_constant_mass(system.groups)),
        np.zeros((2, n)), np.zeros(2), np.zeros(2, np.int64), int(system.mass_couples_held and driven), driven,
        int(felt),
        factors, int(stabilise) if system.algebraic.size and projection != "none" else 0, system.algebraic, np.zeros(n),
        by_mass.dofs, by_mass.order,
    )  # fmt: skip


def _as_it_is(system: System) -> MassNumbering:
    """The system's own order of its unknowns: what is felt couples more of them than masses do."""
    return MassNumbering(system.dofs, np.arange(system.size), system.bandwidth, system.border)


@entry
def _write_projection(groups, dofs, q, matrix, algebraic):
    """(1, G^T; G, 0), in the columns and rows that the constraints themselves write."""
    over.constraint_mass(groups, q, matrix, dofs)
    n = matrix.band.shape[0]
    for i in range(n + matrix.corner.shape[0]):
        free = True
        for k in algebraic:
            if k == i:
                free = False
        if free:
            add_at(matrix, i, i, 1.0)


@kernel
def project(method, groups, dofs, order, state):
    """Put positions (order 0) or velocities (1) back onto the constraints: q -= F phi, eqs 2.127-2.128."""
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    state.residual.fill(0.0)
    over.violation(groups, order, state.full_q, state.full_v, state.residual)
    x = method.change
    reduce(method.dofs, state.residual, x)
    if method.projection.pivots.size + method.projection.corner_pivots.size > 0:
        solve_matrix(method.projection, x)
    else:
        solve_with(method.mass, x)
    target = state.q if order == 0 else state.v
    for i in range(x.size):
        target[method.order[i]] -= x[i]
    for i in method.algebraic:
        state.q[i] = 0.0
        state.v[i] = 0.0


def solve_with(mass, x):
    """Solve M x = b by what :func:`make_mass` made, in place."""
    (_divide if isinstance(mass, np.ndarray) else solve_matrix)(mass, x)


@stands_for(solve_with, inline="always")
def _solve_with(mass, x):
    chosen = _divide if is_array(mass) else solve_inside

    def solve(mass, x):
        chosen(mass, x)
        return 0

    return solve


@kernel
def _divide(mass, x):
    for i in range(x.size):
        x[i] /= mass[i]


def make_mass(mass, groups, dofs, q):
    """Make the mass matrix and its factors; returns 0 or the row whose mass is missing."""
    chosen = _make_diagonal if isinstance(mass, np.ndarray) else _make_factors
    return chosen(mass, groups, dofs, q)


@stands_for(make_mass)
def _make_mass(mass, groups, dofs, q):
    chosen = _make_diagonal if is_array(mass) else _make_factors
    return lambda mass, groups, dofs, q: chosen(mass, groups, dofs, q)


@kernel
def _make_diagonal(mass, groups, dofs, q):
    mass.fill(0.0)
    over.diagonal_mass(groups, q, mass, dofs)
    for i in range(mass.size):
        if mass[i] <= 0.0:
            return i + 1
    return 0


@kernel
def _make_factors(mass, groups, dofs, q):
    clear(mass.matrix)
    over.mass(groups, q, mass.matrix, dofs)
    return factorise_matrix(mass)


def make_acceleration_jacobian(mass, groups, dofs, t, state):
    """Make the derivative of the residual by accelerations, and its factors; returns 0 or the row without a pivot."""
    return 0 if isinstance(mass, np.ndarray) else _make_acceleration_jacobian(mass, groups, dofs, t, state)


@stands_for(make_acceleration_jacobian)
def _make_acceleration_jacobian_or_nothing(mass, groups, dofs, t, state):
    chosen = _feel_nothing if is_array(mass) else _make_acceleration_jacobian
    return lambda mass, groups, dofs, t, state: chosen(mass, groups, dofs, t, state)


@kernel
def _feel_nothing(mass, groups, dofs, t, state):
    return 0


@kernel
def _make_acceleration_jacobian(mass, groups, dofs, t, state):
    q, v, a = state.full_q, state.full_v, state.full_a
    clear(mass.matrix)
    over.smooth_tangent(groups, t, q, v, a, 1.0, 0.0, 0.0, mass.matrix, dofs)
    over.switching_tangent(groups, t, q, v, a, 1.0, 0.0, 0.0, mass.matrix, dofs)
    return factorise_matrix(mass)


@kernel(forceinline=True)
def accelerate(method, groups, dofs, t, state):
    """Set the acceleration at time t from position and velocity, what is held being where it is then: M a = F.

    The full accelerations are those of what is held, as :func:`expand_held` makes them. Where forces depend on
    accelerations, such as the friction of a heavy rope, whose tension is also what accelerates it, M a - F(a) is linear
    in them as long as nothing changes its status: it is solved for from those of the stage before by its derivative.
    """
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    residual, x = state.residual, method.change
    for i in range(residual.size):
        residual[i] = 0.0
    if method.felt:
        expand(dofs, state.a, state.full_a)
    if method.felt or method.driven:
        over.residual(groups, t, state.full_q, state.full_v, state.full_a, residual)
    else:
        over.force(groups, t, state.full_q, state.full_v, state.full_a, residual)
    reduce(method.dofs, residual, x)
    if method.felt or not (method.constant and method.made[0] == 1.0):
        if method.felt:
            row = make_acceleration_jacobian(method.mass, groups, method.dofs, t, state)
        else:
            row = make_mass(method.mass, groups, method.dofs, state.full_q)
        if row != 0:
            state.counters[WORST] = method.order[row - 1]
            return SINGULAR
        method.made[0] = 1.0
    solve_with(method.mass, x)
    for i in range(x.size):
        k = method.order[i]
        state.a[k] = (state.a[k] if method.felt else 0.0) - x[i]
    return DONE


@kernel(forceinline=True)
def account(method, groups, dofs, t, state):
    """Book work up to time t, after :func:`accelerate`.

    The force that moves it depends on the free accelerations where the mass couples the two.
    """
    if method.coupled:
        _react(groups, dofs, t, state)
    book_work(groups, dofs, state, t, method.power, work_of_means(dofs, state))


@kernel
def _react(groups, dofs, t, state):
    """The residual with the accelerations that there are: the forces that hold what is held."""
    expand(dofs, state.a, state.full_a)
    state.residual.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)


@kernel(forceinline=True)
def end_step(method, groups, dofs, functions, state, t, h):
    """Close a step from t to t + h whose positions and velocities are made, or go back to its start. Returns a status.

    ``state.keep`` (4, n) holds position, velocity, acceleration and the auxiliary at its start.
    """
    for i in method.algebraic:
        state.q[i] = 0.0
        state.v[i] = 0.0
    prescribe(dofs, functions, t + h, state.full_q, state.full_v, state.full_a)
    for i in range(state.q.size):
        if not abs(state.v[i]) < SPEED_LIMIT:
            state.counters[WORST] = i
            restore(state)
            return UNSTABLE
    for _ in range(method.stabilise):
        project(method, groups, dofs, 0, state)
        project(method, groups, dofs, 1, state)
    expand(dofs, state.q, state.full_q)
    expand(dofs, state.v, state.full_v)
    status = watch(groups, dofs, state, t + h, method.at)
    if status != DONE:
        restore(state)
        return status
    over.commit(groups, t + h, h, state.full_q, state.full_v, state.full_a)
    book_losses(groups, state, t, h, method.power)
    return DONE


@kernel
def is_finite(x):
    """Whether all numbers of a vector are finite."""
    for i in range(x.size):
        if not np.isfinite(x[i]):
            return False
    return True


def sums_of(method: Explicit) -> tuple[str, ...]:
    """What an explicit method asks of the groups, beside what every method does."""
    masses = "diagonal_mass" if isinstance(method.mass, np.ndarray) else "mass"
    return ("force", "violation", masses, *(("smooth_tangent", "switching_tangent") if method.felt else ()))


def explicit_stepping(kind: type[Explicit], step: Any, polynomial: Sequence[float]) -> Stepping:
    """What an explicit method steps with.

    Parameters
    ----------
    kind : type
        Class of its scratch, below `Explicit`.
    step : kernel
        ``step(method, groups, dofs, functions, state, t, h)`` -> status.
    polynomial : sequence of float
        That of its record.
    """
    return add(
        Stepping(
            kind,
            make=lambda system, settings: new_scratch(kind, system, settings),
            step=step,
            explicit=True,
            sums=sums_of,
            amplification=turned_by(polynomial),
        )
    )
