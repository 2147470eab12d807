"""The equations of motion at any state that is given: residual, mass and tangent, for whoever integrates them."""

from __future__ import annotations

from tautline.kernels import groups as over
from tautline.kernels.dofs import expand, prescribe, reduce
from tautline.kernels.jit import entry, kernel
from tautline.kernels.matrix import clear

SUMS = ("begin", "residual", "mass", "smooth_tangent", "switching_tangent")


@kernel
def _take(dofs, functions, state, t, q, v, a):
    """Make a state of reduced vectors, with what is held where it is at time t."""
    prescribe(dofs, functions, t, state.full_q, state.full_v, state.full_a)
    expand(dofs, q, state.full_q)
    expand(dofs, v, state.full_v)
    expand(dofs, a, state.full_a)


@kernel
def _sum(groups, dofs, state, t, cm, cc, ck, matrix, residual):
    """Residual of the full vectors as they are, and cm M + cc C + ck K."""
    state.residual.fill(0.0)
    over.residual(groups, t, state.full_q, state.full_v, state.full_a, state.residual)
    reduce(dofs, state.residual, residual)
    clear(matrix)
    if cm != 0.0 or cc != 0.0 or ck != 0.0:
        over.smooth_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)
        over.switching_tangent(groups, t, state.full_q, state.full_v, state.full_a, cm, cc, ck, matrix, dofs)


@entry
def evaluate_at(groups, dofs, functions, state, matrix, t, h, q, v, a, cm, cc, ck, residual):
    """Residual r (n,) and cm M + cc C + ck K at reduced vectors; groups begin an explicit step of h s there."""
    _take(dofs, functions, state, t, q, v, a)
    if h > 0.0:
        over.begin(groups, t, h, 0.0, 0.0, state.full_q, state.full_v, state.full_a)
    _sum(groups, dofs, state, t, cm, cc, ck, matrix, residual)


@entry
def evaluate_full(groups, dofs, state, t, cm, cc, ck, matrix, residual):
    """The same of the full vectors of a state as they are: no law begins a step."""
    _sum(groups, dofs, state, t, cm, cc, ck, matrix, residual)


@entry
def evaluate_mass(groups, dofs, functions, state, matrix, t, q):
    """The mass matrix at reduced positions."""
    prescribe(dofs, functions, t, state.full_q, state.full_v, state.full_a)
    expand(dofs, q, state.full_q)
    clear(matrix)
    over.mass(groups, state.full_q, matrix, dofs)


@entry
def settle(groups, state, t, h):
    """Have the laws take note of the state as it is, as at the end of a step of h s in which nothing has moved."""
    over.commit(groups, t, h, state.full_q, state.full_v, state.full_a)
