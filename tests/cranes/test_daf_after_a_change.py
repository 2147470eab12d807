"""The dynamic amplification factor is by the tension at the start: where a parameter changed since, it says so."""

from pathlib import Path

import tautline

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
