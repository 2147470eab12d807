"""A state that another run has saved: the result does not splice the frames of two runs."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[3] / "data"
HOIST = DATA / "hoist.yaml"
LATE = "from a state that another run saved"


def late(result):
    return [line for line in result.attributes["warnings"] if LATE in line]


@pytest.fixture(scope="module")
def heavy():
    """The state of 5 t at 0.5 s, and its run to 1 s."""
    sim = tautline.Simulation(HOIST)
    sim.advance_to(0.5)
    state = sim.save()
    sim.advance_to(1.0)
    return pickle.loads(pickle.dumps(state)), sim.result


def test_a_state_of_another_start_is_where_the_result_begins(heavy):
    """With the frames of 2 t before it, 22 % of the energy was created numerically: 5 t hung where 2 t had."""
    state, whole = heavy
    sim = tautline.Simulation(HOIST, parameters={"payload.mass": 2000.0})
    own = sim.save()
    sim.advance_to(1.0)
    sim.restore(state)
    sim.advance_to(1.0)
    found = sim.result
    assert found.attributes["status"] == "done" and found.attributes["energy_error"] < 1e-5
    assert len(late(found)) == 1 and "0.5 s" in late(found)[0]
    same = np.asarray(whole["time"]) >= 0.5 - 1e-9
    assert np.array_equal(found["time"], np.asarray(whole["time"])[same])
    assert np.array_equal(found["tension"], np.asarray(whole["tension"])[same])
    assert "where the result begins" in found.attributes["headline"]["dynamic_amplification"]["text"]
    assert found.attributes["start"] == {}
    assert late(sim.copy().result)
    sim.restore(own)
    sim.advance_to(0.1)
    assert not late(sim.result) and sim.result["time"][0] == 0.0 and sim.result.attributes["start"]["found"] == "static"


def test_of_the_same_start_the_frame_of_the_start_stays_and_those_of_another_drive_go(heavy):
    state, whole = heavy
    sim = tautline.Simulation(HOIST)
    sim.inputs["winch.pay_out_speed"] = -0.5
    sim.advance_to(1.0)
    sim.restore(state)
    sim.advance_to(0.6)
    found = sim.result
    assert np.allclose(found["time"], [0.0, 0.5, 0.55, 0.6])
    assert len(late(found)) == 1
    assert np.array_equal(found["tension"][1:], whole["tension"][10:13])


@pytest.mark.parametrize("keep", [True, 5.0])
def test_a_state_of_a_simulation_that_keeps_no_frames_is_not_spliced_either(keep):
    """Of the same start with another drive: the load leapt by 5 m from one frame to the next, without a word."""
    other, sim = tautline.Simulation(HOIST, keep=False), tautline.Simulation(HOIST, keep=keep)
    other.inputs["winch.pay_out_speed"] = -0.5
    other.advance_to(0.5)
    sim.advance_to(1.0)
    sim.restore(pickle.loads(pickle.dumps(other.save())))
    sim.advance_to(0.6)
    found, heights = sim.result, sim.result["body_position"][:, 0, 2]
    assert len(late(found)) == 1 and found["time"][-3:] == pytest.approx([0.5, 0.55, 0.6])
    # What is told of the whole run is over its start, of which both runs have the frame.
    start = tautline.Simulation(HOIST)["body_position"][0, 2]
    assert found.attributes["headline"]["rise"]["value"] == pytest.approx(heights[-1] - start)


def test_a_state_of_the_simulation_itself_keeps_its_frames(heavy):
    _, whole = heavy
    sim = tautline.Simulation(HOIST)
    sim.advance_to(0.52)
    here = sim.save()
    sim.advance_to(1.0)
    sim.restore(here)
    sim.advance_to(1.0)
    assert not late(sim.result) and len(sim.result["time"]) == len(whole["time"])
