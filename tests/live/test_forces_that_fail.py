"""Forces that a user adds and that are wrong: told with their name, and never by a process that ends."""

import os
from pathlib import Path

import numba
import numpy as np
import pytest

import tautline
from tautline.elements.nodal.node import PointMasses
from tautline.integrators.status import Status, StoppedEarly
from tautline.kernels.compiling.errors import KernelError
from tautline.live.errors import SimulationError

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"
compiled = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="is about what is compiled")


@pytest.fixture(scope="module")
def standing():
    return tautline.Simulation(tautline.read(HOIST))


@numba.njit
def in_a_window(t, q, v, force):
    if t < 0.05:
        force[0] = 1000.0


@numba.njit
def in_a_window_written(t, q, v, force):
    force[:] = 0.0
    if t < 0.05:
        force[0] = 1000.0


@compiled
def test_a_compiled_force_is_zero_where_it_writes_nothing(standing):
    # the force of its last call acted for ever
    found = []
    for force in (in_a_window, in_a_window_written, lambda t, q, v: [1000.0 if t < 0.05 else 0.0, 0.0, 0.0]):
        sim = standing.copy()
        sim.add_force(force, on="payload.position")
        sim.advance(0.1)
        found.append(sim["payload.position"][0])
    assert found[0] == found[1] == pytest.approx(found[2], abs=1e-12)


@numba.njit
def raising(t, q, v, force):
    if t > 0.02:
        raise ValueError("the table ends")


@numba.njit
def no_number(t, q, v, force):
    force[1] = np.nan if t > 0.02 else 0.0


def no_number_in_python(t, q, v):
    return [0.0, np.nan if t > 0.02 else 0.0, 0.0]


@compiled
@pytest.mark.parametrize(
    ("force", "said"),
    [(raising, "raised an error"), (no_number, "no finite number"), (no_number_in_python, "no finite number")],
)
def test_a_force_that_raises_or_is_no_number_is_named_in_place_of_a_motion_that_overflows(standing, force, said):
    sim = standing.copy()
    sim.add_force(force, on="payload.position")
    with pytest.raises(StoppedEarly) as stop:
        sim.advance(0.1)
    assert stop.value.status == Status.NO_FORCE and stop.value.part == f"force {force.__name__}"
    assert said in stop.value.sentence and "overflowed" not in stop.value.sentence


def failing(calls, since=0.02):
    """A force that raises from a time on, and notes when it is called."""

    def force(t, q, v):
        calls.append(t)
        if t > since:
            raise ValueError("the plant does not answer")
        return [0.0, 0.0, 0.0]

    return force


def test_a_force_that_raised_is_not_called_again_before_it_is_told(standing):
    # with each halving of the step it was: what it does beside its force was done twelve times
    calls, sim = [], standing.copy()
    sim.add_force(failing(calls), on="payload.position")
    before = sim.save()
    for times in (1, 2):
        with pytest.raises(ValueError, match="the plant does not answer"):
            sim.advance(0.1)
        assert len([t for t in calls if t > 0.02]) == times and "a force raised ValueError" in sim.stopped
        sim.restore(before)


def test_a_force_that_raises_in_the_very_last_of_its_calls_stops_that_advance(standing):
    def run(fails_at):
        calls, sim = [], standing.copy()

        def force(t, q, v):
            calls.append(t)
            if len(calls) == fails_at:
                raise ValueError("the last")
            return [0.0, 0.0, 0.0]

        sim.add_force(force, on="payload.position")
        try:
            sim.advance(0.05)
        finally:
            stopped.append(sim.stopped)
        return len(calls)

    stopped = []
    count = run(0)
    with pytest.raises(ValueError, match="the last"):
        run(count)
    assert stopped[0] == "" and "a force raised ValueError" in stopped[1]


def test_equations_raise_what_a_force_raises_and_go_on_with_the_next_evaluation(standing):
    # they gave no number, and no word of it
    calls, sim = [], standing.copy()
    sim.add_force(failing(calls), on="payload.position")
    equations = sim.equations
    t, q, v = equations.state()
    for ask in (equations.acceleration, lambda t, q, v: equations.tangent(t, q, v, 0.0 * q).toarray()):
        with pytest.raises(ValueError, match="the plant does not answer"):
            ask(0.03, q, v)
        assert np.isfinite(ask(t, q, v)).all()


@numba.njit
def too_far(t, q, v, force):
    force[3] = 1.0e5


@numba.njit
def reading_too_far(t, q, v, force):
    force[0] = q[5]


@compiled
@pytest.mark.parametrize("force", [too_far, reading_too_far])
def test_a_compiled_force_that_asks_for_a_place_beyond_its_vectors_is_refused(standing, force):
    # compiled, it wrote into memory of something else and ended the process
    with pytest.raises(SimulationError, match=rf"{Path(__file__).name}:\d+: index \d is out of bounds.*places 0 to 2"):
        standing.copy().add_force(force, on="payload.position")


GUST = np.full(10, 1000.0)


@numba.njit
def from_now_on(t, q, v, force):
    force[0] = GUST[int((t - 0.2) / 0.01)]


@compiled
def test_a_compiled_force_is_looked_at_with_the_time_at_which_it_is_added(standing):
    sim = standing.copy()
    with pytest.raises(SimulationError, match=r"a place that an array has not .*index -20 .*t is 0 s now"):
        sim.add_force(from_now_on, on="payload.position")
    sim.advance(0.2)
    sim.add_force(from_now_on, on="payload.position")
    sim.advance(0.02)
    assert sim["payload.position"][0] != standing["payload.position"][0]


class Endless:
    """What a compiled force is written as, without an end in Python."""

    @staticmethod
    def py_func(t, q, v, force):
        while True:
            force[0] += 1.0


@numba.njit
def returning(t, q, v, force):
    return np.array([1000.0, 0.0, 0.0])


@numba.njit("void(float32, float32[:], float32[:], float32[:])")
def of_halves(t, q, v, force):
    force[0] = 1000.0


@compiled
@pytest.mark.parametrize(
    ("force", "said"), [(returning, r"returns array\(float64"), (of_halves, "cannot be compiled: Invalid use")]
)
def test_a_compiled_force_of_another_form_is_refused_with_the_form_that_it_needs(standing, force, said):
    with pytest.raises(SimulationError, match=rf"{said}.*writes into force, with @njit") as refused:
        standing.copy().add_force(force, on="payload.position")
    assert len(str(refused.value)) < 600 and "\n" not in str(refused.value)


@pytest.mark.parametrize("beyond", [-2, 400])
def test_a_group_that_is_added_with_a_place_that_is_not_there_is_refused(standing, beyond):
    size = standing.model.system.q.size
    group = PointMasses(np.array([size + beyond]), np.array([1.0]), 0.0, np.zeros(3))
    with pytest.raises(KernelError, match=rf"of kind PointMasses.*place \d+ of an array of {size}"):
        standing.copy().add_force(group)


def test_a_force_that_raises_while_a_model_is_linearised_is_told(standing):
    # matrices full of nan came back
    sim, calls = standing.copy(), []

    def third(t, q, v):
        calls.append(t)
        if len(calls) == 3:
            raise ValueError("the table ends")
        return [0.0, 0.0, 0.0]

    sim.add_force(third, on="payload.position")
    with pytest.raises(ValueError, match="the table ends"):
        sim.linearise(["winch.pay_out_speed"], ["payload.position"])


def test_a_keyboard_interrupt_that_a_force_raises_is_no_ctrl_c_and_the_time_is_that_of_the_outputs(standing):
    sim, times = standing.copy(), []

    def interrupts(t, q, v):
        times.append(t)
        if t > 0.02:
            raise KeyboardInterrupt
        return [0.0, 0.0, 0.0]

    sim.add_force(interrupts, on="payload.position")
    with pytest.raises(KeyboardInterrupt):
        sim.advance(0.1)
    assert sim.time == pytest.approx(0.02) and f"{sim.time:.6g} s" in sim.stopped


@compiled
@pytest.mark.parametrize(
    "function", [raising, no_number, lambda t, q, v: [0.0, np.nan, 0.0]], ids=["raises", "nan", "Python"]
)
def test_a_force_that_fails_without_an_error_is_told_by_name_while_a_model_is_linearised(standing, function):
    sim = standing.copy()
    sim.advance(0.05)
    sim.add_force(function, on="payload.position")
    with pytest.raises(SimulationError, match=r"force .*: it (raised|gave)"):
        sim.linearise(["winch.pay_out_speed"], ["payload.position"])
