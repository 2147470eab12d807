"""A bit at rest by RK4: a chosen step does not chatter, and a result says of a given one that it does."""

from pathlib import Path

import numpy as np
import yaml

import tautline
from drillstring.warnings import warnings

TEMPLATE = Path(__file__).parents[3] / "data" / "drilling.yaml"
END = 1.0
TOLD = "a bit at rest chatters at a step of"


def scene(step, method="rk4"):
    made = yaml.safe_load(TEMPLATE.read_text())
    made["solver"] = {"method": method, "step": step, "end": END}
    made["output"] = {"interval": 0.05}
    made["model"]["elements"] = 12
    made["well"]["wall"] = "none"
    return made


def chatters(result):
    return [one for one in result.warnings if one.startswith(TOLD)]


def test_a_step_that_is_chosen_is_too_short_for_a_bit_at_rest_to_chatter():
    """Against an implicit method, by which the bit sticks exactly; with 12.5 ms it was 0.26 rad off."""
    found = tautline.simulate(scene("auto"), verify=False)
    exact = tautline.simulate(scene(2.0e-4, "generalized-alpha"), verify=False)
    assert found.attributes["step"] < 2.0e-3
    assert not chatters(found)
    assert np.abs(found["rotation"] - exact["rotation"]).max() < 0.01
    assert np.abs(found["rotation_rate"][:, -1]).max() < 0.01


def test_a_simulation_that_chooses_its_step_does_not_chatter_either():
    sim = tautline.Simulation(scene("auto"))
    for k in range(1, 11):
        sim.advance_to(0.05 * k)
    assert np.abs(sim.result["rotation_rate"][:, -1]).max() < 0.01
    assert not chatters(sim.result)


def test_the_result_of_a_step_at_which_a_bit_chatters_says_so_by_the_step_that_was_taken():
    """5.5 ms are no whole part of the interval."""
    (said,) = chatters(tautline.simulate(scene(0.0055), end=0.2, verify=False))
    assert said.startswith(f"{TOLD} 0.005 s")


def test_the_result_of_a_simulation_tells_of_the_steps_that_its_advances_made():
    sim = tautline.Simulation(scene(0.0125))
    sim.advance(0.05)
    assert f"{TOLD} 0.0125 s" in chatters(sim.result)[0]
    short = tautline.Simulation(scene(0.0125))
    for _ in range(100):
        short.advance(0.001)
    assert not chatters(short.result)


def test_a_bit_that_makes_a_chosen_step_so_short_that_the_run_takes_long_is_told_before_it():
    slow = tautline.read(scene("auto") | {"solver": {"method": "rk4", "step": "auto", "end": 60.0}})
    assert not [text for text in map(str, warnings(slow)) if "would chatter" in text]
    (said,) = [text for text in map(str, warnings(slow.replace({"bit.slip_speed": 1e-4}))) if "would chatter" in text]
    assert "so the run takes" in said and "larger slip_speed" in said
