"""Where a step fails of which some halves were accepted, time and outputs are of the same instant."""

from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[3] / "data"


def hoist(step):
    """Two-blocked near 12.98 s; from 1 s on the winch takes in 2 m/s, so that its rope tells the time."""
    return tautline.read(DATA / "hoist.yaml").replace({"solver.step": step})


def time_by_the_winch(pay_out):
    return 0.5 - pay_out / 2.0


@pytest.mark.parametrize("step", ["5 ms", "20 ms", "50 ms"])
def test_time_at_a_stop_is_that_of_the_outputs(step):
    """It was up to a whole step earlier: 12.95 s for 12.983 s with steps of 50 ms."""
    sim = tautline.Simulation(hoist(step))
    with pytest.raises(tautline.StoppedEarly) as found:
        sim.advance(30.0)
    told = time_by_the_winch(sim["winch.pay_out"])
    assert abs(sim.time - told) < 1e-9
    assert found.value.time == sim.time and found.value.result.attributes["restart_time"] == sim.time


def test_a_run_that_stops_tells_the_time_that_it_came_to_and_holds_the_state_of_its_restart_time():
    sim = tautline.Simulation(hoist("50 ms"))
    with pytest.raises(tautline.StoppedEarly):
        sim.advance(30.0)
    with pytest.raises(tautline.StoppedEarly) as found:
        tautline.simulate(hoist("50 ms"), end=30.0)
    result = found.value.result
    assert abs(found.value.time - sim.time) < 1e-9
    assert f"{sim.time:.5g} s" in str(found.value)
    again = result.attributes["restart_time"]
    assert again in np.asarray(result["time"]) and again <= found.value.time


def test_a_stopped_state_that_is_saved_stands_at_the_time_of_its_outputs():
    sim = tautline.Simulation(hoist("50 ms"))
    with pytest.raises(tautline.StoppedEarly):
        sim.advance(30.0)
    other = sim.copy()
    assert other.time == sim.time and abs(time_by_the_winch(other["winch.pay_out"]) - other.time) < 1e-9
