"""The order at which every registered method converges, against DOP853 on the same equations."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import two_masses

from tautline.integrators.generalized_alpha import alphas
from tautline.integrators.linearise import start_moving
from tautline.integrators.method import METHODS
from tautline.integrators.state import HALVINGS, ITERATIONS, STEPS, new_state
from tautline.integrators.status import Status
from tautline.integrators.time_loop import new_frames, run_steps
from tautline.system.model import SolverSettings

END = 2.0
ORDERS = {"rk4": 4, "newmark": 2, "generalized-alpha": 2}
STEP_COUNTS = (40, 80, 160, 320)
PARAMETERS = {
    "rho_inf 0": alphas(0.0),
    "rho_inf 0.5": alphas(0.5),
    "rho_inf 1": alphas(1.0),
    "alpha_m 0.1, alpha_f 0.3": (0.1, 0.3),
}


class Ending(NamedTuple):
    """x and y, z's force, and counters at the end of a run."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    force: float
    z: float
    counters: np.ndarray


@cache
def truth():
    return two_masses.reference(END)


def run(method, steps, ends=(END,), alpha=PARAMETERS["rho_inf 0.5"], **changes):
    system = two_masses.system()
    settings = SolverSettings(method, 0.0, END, END, *alpha, **({"tolerance": 1e-13} | changes))
    state = new_state(system)
    start_moving(system, state, 1e-3)
    rows = len(ends)
    frames = new_frames(rows, 3, 0)
    counts = np.broadcast_to(np.asarray(steps, dtype=np.int64), rows).copy()
    status, filled, _ = run_steps(METHODS[method](system, settings), system, state, np.array(ends), counts, 0.0, frames)
    assert (Status(status), filled) == (Status.DONE, rows)
    q, v, a, r = (x[-1] for x in (frames.q, frames.v, frames.a, frames.residual))
    return Ending(q[:2].copy(), v[:2].copy(), a[:2].copy(), r[2], q[2], state.counters.copy())


def errors(ending):
    """Errors in position, velocity, acceleration and in the force on z."""
    q, v, a, force = truth()
    return [np.abs(x - y).max() for x, y in zip(ending[:4], (q, v, a, force), strict=True)]


def fitted_orders(counts, endings):
    logs = np.log([errors(e) for e in endings])
    return -np.polyfit(np.log(counts), logs, 1)[0]


@pytest.mark.parametrize("method", METHODS)
def test_every_method_converges_at_its_order_in_position_velocity_and_acceleration(method):
    orders = fitted_orders(STEP_COUNTS, [run(method, n) for n in STEP_COUNTS])
    assert orders[:3] == pytest.approx([ORDERS[method]] * 3, abs=0.2)


@pytest.mark.parametrize("method", METHODS)
def test_the_force_that_moves_a_prescribed_degree_converges_with_the_rest(method):
    orders = fitted_orders(STEP_COUNTS, [run(method, n) for n in STEP_COUNTS])
    assert orders[3] == pytest.approx(ORDERS[method], abs=0.2)


@pytest.mark.parametrize("case", PARAMETERS)
def test_generalized_alpha_is_of_second_order_for_any_of_its_parameters(case):
    orders = fitted_orders(STEP_COUNTS, [run("generalized-alpha", n, alpha=PARAMETERS[case]) for n in STEP_COUNTS])
    assert orders == pytest.approx([2.0] * 4, abs=0.2)


def test_newmark_is_generalized_alpha_with_alphas_of_zero():
    one, other = run("newmark", 100, alpha=(0.3, 0.4)), run("generalized-alpha", 100, alpha=(0.0, 0.0))
    assert all(np.array_equal(x, y) for x, y in zip(one, other, strict=True))


@pytest.mark.parametrize("method", METHODS)
def test_a_prescribed_degree_is_where_its_function_says(method):
    assert run(method, 40).z == pytest.approx(two_masses.motion(END)[0], abs=1e-14)


@pytest.mark.parametrize("case", PARAMETERS)
def test_the_energy_criterion_leads_to_the_same_second_order(case):
    endings = [
        run("generalized-alpha", n, alpha=PARAMETERS[case], criterion="energy", tolerance=1e-12) for n in STEP_COUNTS
    ]
    assert fitted_orders(STEP_COUNTS, endings)[:3] == pytest.approx([2.0] * 3, abs=0.2)


@pytest.mark.parametrize("case", PARAMETERS)
def test_steps_of_unequal_length_keep_the_second_order(case):
    """Steps of h and h / 2 in turn, as where frames do not divide alike, or steps are halved and doubled again."""

    def in_turn(n):
        ends = np.linspace(0.0, END, n + 1)[1:]
        return run("generalized-alpha", 1 + np.arange(n) % 2, ends=tuple(ends), alpha=PARAMETERS[case])

    orders = fitted_orders(STEP_COUNTS, [in_turn(n) for n in STEP_COUNTS])
    assert orders == pytest.approx([2.0] * 4, abs=0.2)


@pytest.mark.parametrize("case", PARAMETERS)
def test_steps_that_had_to_be_halved_are_no_worse_than_whole_ones(case):
    alpha = PARAMETERS[case]
    for n in STEP_COUNTS:
        whole = run("generalized-alpha", n, alpha=alpha)
        halved = run("generalized-alpha", n, alpha=alpha, max_iterations=2, tolerance=1e-10)
        assert whole.counters[HALVINGS] == 0 < halved.counters[HALVINGS]
        assert halved.counters[STEPS] > n == whole.counters[STEPS]
        assert max(np.array(errors(halved)) / errors(whole)) < 1.2


def test_a_step_that_no_halving_saves_ends_the_run_with_its_status():
    system = two_masses.system()
    settings = SolverSettings("newmark", 0.0, END, END, 0.0, 0.0, tolerance=1e-13, max_iterations=1, max_halvings=2)
    state = new_state(system)
    start_moving(system, state, 1e-3)
    before = state.q.copy(), state.v.copy(), state.a.copy()
    method, steps = METHODS["newmark"](system, settings), np.array([20])
    status, filled, reached = run_steps(method, system, state, np.array([END]), steps, 0.0, new_frames(1, 3, 0))
    assert (Status(status), filled, reached) == (Status.NOT_CONVERGED, 0, 0.0)
    assert all(np.array_equal(x, y) for x, y in zip(before, (state.q, state.v, state.a), strict=True))
    assert state.counters[STEPS] == 0


def test_a_tight_criterion_costs_iterations_and_a_loose_one_accuracy():
    tight, loose = run("generalized-alpha", 80), run("generalized-alpha", 80, tolerance=1e-2)
    assert tight.counters[ITERATIONS] > loose.counters[ITERATIONS]
    assert min(np.array(errors(loose))[:3] / errors(tight)[:3]) > 1.2
