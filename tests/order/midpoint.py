"""The explicit midpoint rule, a method of one file and one registration.

k = f(t, y), y1 = y + h f(t + h/2, y + h k / 2): of second order, with the stability polynomial 1 + z + z^2/2.
"""

from tautline.integrators.corrector.newton import DONE
from tautline.integrators.explicit import Explicit, accelerate, account, end_step, explicit_stepping
from tautline.integrators.state import keep, observe_motion, restore
from tautline.kernels import groups as over
from tautline.kernels.dofs import expand_held, prescribe
from tautline.kernels.jit import kernel
from tautline.scene.methods import Method, register

POLYNOMIAL = (1.0, 1.0, 0.5)


class Midpoint(Explicit):
    """Scratch of the method: its type chooses the step."""

    __slots__ = ()


@kernel(forceinline=True)
def midpoint_step(method, groups, dofs, functions, state, t, h):
    """Advance the state from t by h. Returns a status."""
    over.begin(groups, t, h, 0.0, 0.0, state.full_q, state.full_v, state.full_a)
    keep(state)
    q, v = state.keep[0], state.keep[1]
    for stage in range(2):
        now = t + 0.5 * h * stage
        if stage == 1:
            prescribe(dofs, functions, now, state.full_q, state.full_v, state.full_a)
        if stage == 0 or method.driven:
            expand_held(dofs, state.full_a)
        status = accelerate(method, groups, dofs, now, state)
        if status != DONE:
            restore(state)
            return status
        if stage == 0:
            account(method, groups, dofs, t, state)
            observe_motion(state, state.v, state.a, h)
        ahead = 0.5 * h if stage == 0 else h
        for i in range(q.size):
            state.q[i] = q[i] + ahead * state.v[i]
            state.v[i] = v[i] + ahead * state.a[i]
    return end_step(method, groups, dofs, functions, state, t, h)


MIDPOINT = register(
    Method("midpoint", explicit_stepping(Midpoint, midpoint_step, POLYNOMIAL), order=2, polynomial=POLYNOMIAL)
)
