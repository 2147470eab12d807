"""The dynamic amplification factor is by the tension at the start: where a parameter changed since, it says so."""

import pickle
from pathlib import Path

import tautline
from tautline.live.fmu.unit import from_bytes, to_bytes

HOIST = Path(__file__).parents[2] / "data" / "hoist.yaml"


def text_of(sim):
    return sim.result.headline["dynamic_amplification"]["text"]


def test_the_factor_says_that_it_is_by_the_load_at_the_start_after_a_parameter_was_changed():
    sim = tautline.Simulation(HOIST, parameters={"payload.mass": 5500.0})
    sim.advance(0.2)
    assert "at the start" not in text_of(sim)
    sim.parameters["payload.mass"] = 8000.0
    sim.advance(0.2)
    assert "by the load at the start" in text_of(sim) and "by the load at the start" in text_of(sim.copy())
    assert sim.result.attributes["parameters_changed"] == "payload.mass"


def test_what_was_changed_goes_with_a_state_and_is_forgotten_with_it():
    sim = tautline.Simulation(HOIST)
    sim.advance(0.1)
    before = sim.save()
    sim.parameters["payload.mass"] = 8000.0
    sim.advance(0.1)
    after = pickle.loads(pickle.dumps(sim.save()))
    sim.restore(before)
    sim.advance(0.2)
    assert sim.parameters["payload.mass"] == 5000.0
    assert "parameters_changed" not in sim.result.attributes and "at the start" not in text_of(sim)
    for one in (sim, tautline.Simulation(HOIST)):
        one.restore(after)
        one.advance(0.2)
        assert one.parameters["payload.mass"] == 8000.0
        assert one.result.attributes["parameters_changed"] == "payload.mass" and "at the start" in text_of(one)


def test_what_was_changed_goes_with_a_state_as_bytes_too():
    sim = tautline.Simulation(HOIST)
    sim.parameters["payload.mass"] = 8000.0
    beside = {"begin": 0.0, "timed": False, "initialised": True, "running": True}
    unit = beside | {"state": sim.save(), "sent": {}, "given": {}, "held": {}, "changed": {}}
    assert from_bytes(to_bytes(unit))["state"].changed == ("payload.mass",)
