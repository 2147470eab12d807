"""Speeds of booms and vessels as inputs of runs and of linear models, against runs and kinematics."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[2] / "data"
OUTPUTS = ["payload.position", "payload.velocity", "winch.tension"]
END, SPEED = 0.3, 1.0e-4


def of(inputs, step="0.5 ms"):
    scene = tautline.read(DATA / "slewing.yaml").replace(
        {"path[0].drum.pay_out": {"constant": 0}, "frames[0].slew": {"constant": 0}, "solver.step": step}
    )
    sim = tautline.Simulation(scene, inputs=inputs, keep=False)
    sim.advance(0.1)
    return sim


def read(sim):
    return np.concatenate([np.ravel(sim[name]) for name in OUTPUTS])


def linear(plant):
    """Outputs at the end, for each unit of a speed that rises from 0 to 1 by a cubic."""

    def input_at(t):
        x = t / END
        return (3.0 - 2.0 * x) * x * x, 6.0 * (1.0 - x) * x / END

    def rates(t, x):
        return plant.A @ x + plant.B[:, 0] * input_at(t)[0]

    found = solve_ivp(
        rates, (0.0, END), np.zeros(len(plant.A)), "Radau", rtol=1e-7, atol=1e-9, jac=plant.A, max_step=END / 20
    )
    value, rate = input_at(END)
    return plant.C @ found.y[:, -1] + plant.D[:, 0] * value + plant.E[:, 0] * rate


@pytest.mark.parametrize("name", ["boom.luff", "vessel.heave"])
def test_velocities_and_tensions_by_the_speed_of_a_boom_and_of_a_vessel_are_those_of_runs(name):
    speed = f"{name}_speed"
    sim = of([speed])
    with pytest.raises(SimulationError, match=f"follows the rate of {name} at once.*take {speed} in its place"):
        sim.linearise([name], OUTPUTS)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        plant = sim.linearise([speed], OUTPUTS)
    assert plant.states[-1] == name and plant.units[speed] in ("rad/s", "m/s")
    moved, still = sim.copy(), sim.copy()
    moved.inputs[speed], still.inputs[speed] = (SPEED, 0.0), (0.0, 0.0)
    moved.advance(END)
    still.advance(END)
    run = (read(moved) - read(still)) / SPEED
    here = linear(plant)
    for part, tolerance in ((slice(0, 3), 3e-3), (slice(3, 6), 3e-3), (slice(6, 7), 2e-2)):
        assert np.allclose(here[part], run[part], rtol=0.0, atol=tolerance * np.abs(run[part]).max())


def test_a_boom_that_is_slewed_by_its_speed_goes_as_far_as_the_integral_of_that():
    sim = of(["boom.slew_speed"], "2 ms")
    sim.inputs["boom.slew_speed"] = 0.02, 0.0  # by a cubic with no rate at its ends: the mean is half
    sim.advance(0.4)
    assert sim.inputs["boom.slew"] == pytest.approx(0.5 * 0.02 * 0.4, rel=1e-9)
    sim.inputs["boom.slew_speed"] = 0.02, 0.0
    sim.advance(0.4)
    assert sim.inputs["boom.slew"] == pytest.approx(1.5 * 0.02 * 0.4, rel=1e-9)


def test_the_speed_of_a_vessel_that_the_scene_does_not_have_is_driven_like_its_place():
    sim = of(["vessel.pitch_speed"], "2 ms")
    assert {"vessel.pitch", "vessel.pitch_speed"} <= set(sim.inputs)
    sim.inputs["vessel.pitch_speed"] = 0.01, 0.0
    with pytest.raises(SimulationError, match="drive the same"):
        sim.inputs["vessel.pitch"] = 0.01
