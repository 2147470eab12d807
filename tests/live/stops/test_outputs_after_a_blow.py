"""A blow, and a parameter that changes, are seen in all outputs at once, and a result names what was displaced."""

from pathlib import Path

import numpy as np
import pytest
from physics.lifting.crane_scenes import anchor, body, crane, end

import tautline
from tautline.live.errors import SimulationError

DATA = Path(__file__).parents[3] / "data"


def test_a_blow_is_in_all_outputs_at_once_and_in_the_result():
    """Half of them were old until the next advance. The energy that it brings is that of 5 t and of the rope's end.

    The end of the last element (39 kg, 6 m) goes along, and what is next to it in part: a third to half of it.
    """
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.advance(1.0)
    before, speed = sim["kinetic_energy"], sim["payload.velocity"][2]
    assert "displaced" not in sim.result.attributes
    sim.displace("payload.velocity", [0.0, 0.0, 2.0])
    assert np.array_equal(sim["body_velocity"][0], sim["payload.velocity"])
    brought = 0.5 * 5000.0 * ((speed + 2.0) ** 2 - speed**2)
    of_rope = 39.0 / 5000.0 * brought
    assert of_rope / 3.0 < sim["kinetic_energy"] - before - brought < of_rope / 2.0
    assert sim.result.attributes["displaced"] == sim.copy().result.attributes["displaced"] == "payload.velocity"


def test_a_mass_that_changes_is_in_the_energies_at_once():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.advance(1.0)
    before, speed = sim["kinetic_energy"], sim["payload.velocity"][2]
    sim.parameters["payload.mass"] = 6000.0
    brought = 0.5 * 1000.0 * speed**2
    assert abs(sim["kinetic_energy"] - before - brought) < 1e-6 * before


def a_rigid_load_on_one_rope():
    """Its eye is 1 m above its centre, and 8 m below the anchor."""
    load = body("payload", 2000.0, (0.0, 0.0, 1.0), inertia=[900.0, 1700.0, 1500.0])
    path = [anchor((0.0, 0.0, 10.0)), end("payload", name="hook", offset=(0.0, 0.0, 1.0))]
    return crane(path, [load], {"mass_per_length": 1.0}, mesh={"elements_per_span": 2}, start="static")


@pytest.mark.parametrize("scene", [DATA / "hoist.yaml", a_rigid_load_on_one_rope()], ids=["point", "rigid"])
def test_the_rope_s_end_goes_along_with_its_load_at_once(scene):
    """A load that is moved and does not turn takes every point of it along as far. The ends were old until a step."""
    sim = tautline.Simulation(scene)
    sim.advance(0.1)
    place, speed, energy = sim["hook.position"], sim["hook.velocity"], sim["strain_energy"]
    sim.displace("payload.position", [0.0, 1.0, 0.0])
    sim.displace("payload.velocity", [0.3, 0.0, 0.0])
    assert sim["hook.position"] - place == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert sim["hook.velocity"] - speed == pytest.approx([0.3, 0.0, 0.0], abs=1e-12)
    assert sim["strain_energy"] > 10.0 * energy  # 1 m aside stretches the last element


@pytest.mark.parametrize("name, by", [("hook.position", [0.01, 0, 0]), ("hook.velocity[0]", 0.01)])
def test_what_only_rides_on_a_load_is_not_displaced_by_itself_and_the_load_is_named(name, by):
    """It was taken, and nothing moved."""
    sim = tautline.Simulation(a_rigid_load_on_one_rope())
    carrier = name.partition("[")[0].replace("hook", "payload")
    with pytest.raises(SimulationError, match=f"displace {carrier}: "):
        sim.displace(name, by)
    assert "displaced" not in sim.result.attributes
