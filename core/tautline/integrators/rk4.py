"""The classical Runge-Kutta method of order four, eqs 2.113-2.115."""

from __future__ import annotations

from tautline.integrators.corrector.newton import DONE, NOT_FINITE
from tautline.integrators.explicit import BEFORE, Explicit, accelerate, account, end_step, explicit_stepping, is_finite
from tautline.integrators.state import observe_motion, restore
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand_held, prescribe
from tautline.kernels.jit import kernel
from tautline.scene import methods


class RungeKutta4(Explicit):
    """Scratch of the method."""

    __slots__ = ()


@kernel(forceinline=True)
def rk4_step(method, groups, dofs, functions, state, t, h):
    """Advance the state from t by h. Returns a status."""
    over.begin(groups, t, h, 0.0, 0.0, state.full_q, state.full_v, state.full_a)
    q, v = state.keep[0], state.keep[1]
    sum_v, sum_a = method.slopes[0], method.slopes[1]
    for i in range(q.size):
        q[i], v[i], state.keep[2, i], state.keep[3, i] = state.q[i], state.v[i], state.a[i], state.auxiliary[i]
        sum_v[i] = sum_a[i] = 0.0
    for stage in range(4):
        now = t + h * (0.5 if stage == 1 or stage == 2 else BEFORE if stage == 3 else 0.0)
        if stage % 2 == 1:
            # The first stage is where the last step ended, and the middle two share their time.
            prescribe(dofs, functions, now, state.full_q, state.full_v, state.full_a)
        if stage == 0 or method.driven:
            expand_held(dofs, state.full_a)
        status = accelerate(method, groups, dofs, now, state)
        if stage == 0 and not is_finite(state.a):
            status = NOT_FINITE  # before work is booked with what is no number
        if status != DONE:
            restore(state)
            return status
        if stage == 0:
            account(method, groups, dofs, t, state)
            observe_motion(state, state.v, state.a, h)
        weight = 1.0 / 3.0 if stage == 1 or stage == 2 else 1.0 / 6.0
        ahead = h if stage == 2 else 0.5 * h
        for i in range(q.size):
            sum_v[i] += weight * state.v[i]
            sum_a[i] += weight * state.a[i]
            state.q[i] = q[i] + ahead * state.v[i]
            state.v[i] = v[i] + ahead * state.a[i]
    for i in range(q.size):
        state.q[i] = q[i] + h * sum_v[i]
        state.v[i] = v[i] + h * sum_a[i]
    return end_step(method, groups, dofs, functions, state, t, h)


RK4 = explicit_stepping(RungeKutta4, rk4_step, methods.RK4.polynomial)
