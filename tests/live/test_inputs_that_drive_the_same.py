"""A place and its speed are two inputs of one function: one advance takes one of them."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live.errors import SimulationError
from tautline.live.fmu.writing import write_fmu

DATA = Path(__file__).parents[2] / "data"
PLACE, SPEED = "winch.pay_out", "winch.pay_out_speed"


@pytest.fixture
def sim():
    return tautline.Simulation(DATA / "hoist.yaml", initial={SPEED: 0.0, "vessel.heave": 0.0}, keep=False)


@pytest.mark.parametrize(("first", "second"), [(PLACE, SPEED), (SPEED, PLACE)])
def test_a_place_and_its_speed_in_one_advance_are_refused_and_the_first_stays(sim, first, second):
    sim.inputs[first] = 0.1
    with pytest.raises(SimulationError, match=r"drive the same.*winch.pay_out = \(value, rate\)"):
        sim.inputs[second] = 0.2
    sim.advance(0.5)
    assert sim[first] == pytest.approx(0.1)


def test_control_that_changes_from_a_speed_that_grows_to_a_place_has_the_place(sim):
    for k in range(1, 5):
        sim.inputs[SPEED] = 0.02 * k, 0.2
        sim.advance(0.1)
    sim.inputs[PLACE] = 0.10
    sim.advance(0.5)
    assert sim[PLACE] == pytest.approx(0.10, abs=1e-12)
    sim.advance(0.5)
    assert sim[PLACE] == pytest.approx(0.10, abs=1e-12) and sim[SPEED] == pytest.approx(0.0, abs=1e-12)
    sim.inputs[SPEED] = 0.1
    sim.advance(0.5)
    assert sim[SPEED] == pytest.approx(0.1)


def test_control_of_a_speed_goes_on_from_where_a_moving_place_has_it(sim):
    """The place is left in the middle of its way, and nothing of it comes after."""
    sim.inputs[PLACE] = 0.05, 0.2
    sim.advance(0.5)
    places = [sim[PLACE]]
    for _ in range(20):
        sim.inputs[SPEED] = 0.2
        sim.advance(0.05)
        places.append(sim[PLACE])
    assert np.allclose(np.diff(places), 0.2 * 0.05, rtol=1e-9)


def test_two_initial_values_of_one_thing_are_refused():
    with pytest.raises(SimulationError, match="drive the same"):
        tautline.Simulation(DATA / "hoist.yaml", initial={SPEED: 0.0, PLACE: 0.0})


@pytest.mark.parametrize(("scene", "inputs"), [("hoist", [PLACE, SPEED]), ("jwell", ["top.block", "top.block_speed"])])
def test_an_fmu_with_two_inputs_that_drive_the_same_is_not_written(scene, inputs, tmp_path):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    with pytest.raises(SimulationError, match="drive the same"):
        write_fmu(DATA / f"{scene}.yaml", tmp_path / "two.fmu", inputs, ["kinetic_energy"])
    assert list(tmp_path.iterdir()) == []
