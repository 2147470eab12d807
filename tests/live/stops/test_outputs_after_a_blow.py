"""A blow, and a parameter that changes, are seen in all outputs at once, and a result names what was displaced."""

from pathlib import Path

import numpy as np

import tautline

DATA = Path(__file__).parents[3] / "data"


def test_a_blow_is_in_all_outputs_at_once_and_in_the_result():
    """Half of them were old until the next advance. The energy that it brings is that of 5 t."""
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.advance(1.0)
    before, speed = sim["kinetic_energy"], sim["payload.velocity"][2]
    assert "displaced" not in sim.result.attributes
    sim.displace("payload.velocity", [0.0, 0.0, 2.0])
    assert np.array_equal(sim["body_velocity"][0], sim["payload.velocity"])
    brought = 0.5 * 5000.0 * ((speed + 2.0) ** 2 - speed**2)
    assert abs(sim["kinetic_energy"] - before - brought) < 1e-6 * brought
    assert sim.result.attributes["displaced"] == sim.copy().result.attributes["displaced"] == "payload.velocity"


def test_a_mass_that_changes_is_in_the_energies_at_once():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.advance(1.0)
    before, speed = sim["kinetic_energy"], sim["payload.velocity"][2]
    sim.parameters["payload.mass"] = 6000.0
    brought = 0.5 * 1000.0 * speed**2
    assert abs(sim["kinetic_energy"] - before - brought) < 1e-6 * before
