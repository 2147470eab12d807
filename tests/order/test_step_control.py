"""Step control: the step follows the error that a run may make, and no further than it has to."""

import numpy as np
import pytest

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Status, StoppedEarly
from tautline.simulation import simulate

SCENE = """
CableModelMaterial: {{Gravity: [0, 0, -9.81]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 0, 0, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: 2.0e3, EJ: 0, rhoA: 1.0e-3, cDamp: 0, compression: false}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1.0}}
GeneralizedAlpha: {{type: G-alpha, rho_inf: 0.9, eps_energy: 1.0e-10, time_step: {step}, time_end: 2.0, plotpoints: 50,
                   control: {control}, {tolerance}}}
"""


def run(step, tolerance=None):
    more = "" if tolerance is None else f"tolerance: {tolerance!r}"
    control = "fixed" if tolerance is None else "error"
    return simulate(build(parse(SCENE.format(step=step, control=control, tolerance=more))))


@pytest.fixture(scope="module")
def exact():
    """The swing of the mass on its elastic rope, by a step at which it has converged."""
    return np.asarray(run(1e-5)["position"])[:, 1]


def error(result, exact):
    return np.abs(np.asarray(result["position"])[:, 1] - exact).max()


def test_a_tenth_of_the_tolerance_gives_a_smaller_error_by_more_steps(exact):
    runs = [run(0.02, tolerance) for tolerance in (1e-5, 1e-6, 1e-7)]
    errors, steps = [error(r, exact) for r in runs], [r.attributes["steps"] for r in runs]
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]
    assert steps[0] < steps[1] < steps[2]


def test_control_reaches_an_error_that_the_nominal_step_misses(exact):
    assert error(run(0.02), exact) > 20.0 * error(run(0.02, 1e-7), exact)


def test_steps_grow_back_after_they_were_halved():
    """A step that would have to be as short as the shortest all the way would need many more of them."""
    attributes = run(0.02, 1e-6).attributes
    assert 0 < attributes["halvings"]
    assert attributes["steps"] < 100 * 2 ** min(6, attributes["halvings"])


def test_an_error_that_no_halving_reaches_stops_the_run_by_its_name():
    with pytest.raises(StoppedEarly) as stop:
        run(0.02, 1e-30)
    assert stop.value.status == Status.INACCURATE
    assert stop.value.part.startswith("node 1")


def test_a_step_that_chooses_itself_keeps_the_error_it_is_given(exact):
    errors = [error(run("auto", tolerance), exact) for tolerance in (1e-5, 1e-6)]
    # what steps leave out adds up over two seconds of swinging: a hundred times the error of one, measured
    assert 3.0 * errors[1] < errors[0] < 2e-3
    assert errors[1] < 4e-4
    given = run("auto").attributes
    assert given["step"] == pytest.approx(2.0 / given["steps"])


def test_a_step_that_chooses_itself_needs_no_tolerance(exact):
    """It is a millionth of the rope's length then."""
    result = run("auto")
    assert error(result, exact) < 1e-3
    assert result.attributes["steps"] < 100_000


def test_rk4_chooses_a_step_below_its_critical_one():
    """The rope alone, a bar that is pulled: 2.8 / omega without damping, 2.785 / (c omega^2) with much of it."""
    text = SCENE.replace("mass: 1.0", "mass: 1.0e-3").replace("cDamp: 0", "cDamp: {c}").replace("G-alpha", "RK4")
    text = text.replace("time_end: 2.0", "time_end: 0.2")
    omega = np.sqrt(2.0e3 / (1.0e-3 + 1.0e-3 / 3.0))
    for c, critical in ((0.0, 2.8 / omega), (0.01, 2.785 / (0.01 * omega**2))):
        result = simulate(build(parse(text.format(step="auto", control="fixed", tolerance="", c=c))))
        assert 0.6 * critical < result.attributes["step"] < 0.9 * critical
        assert result.attributes["status"] == "done"
