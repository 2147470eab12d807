"""Where a force raises, time and all outputs are those of the last step that was accepted."""

from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[3] / "data"


class Broken(Exception):
    """What the force raises."""


def hoist(raises):
    sim = tautline.Simulation(DATA / "hoist.yaml")

    def force(t, q, v):
        if raises and t > 0.62:
            raise Broken
        return np.zeros(3)

    sim.add_force(force, on="payload.position")
    return sim


def test_all_outputs_after_a_force_that_raised_are_of_the_time_that_is_told():
    """`body_position` was of 0.6 s, and `payload.position` of 0.62 s: 28 mm apart."""
    sim, whole = hoist(True), hoist(False)
    with pytest.raises(Broken):
        sim.advance(1.0)
    whole.advance_to(sim.time)
    assert 0.61 < sim.time < 0.63
    assert np.array_equal(sim["payload.position"], sim["body_position"][0])
    for name in ("body_velocity", "kinetic_energy", "potential_energy", "winch.pay_out", "tension", "winch.torque"):
        assert np.allclose(sim[name], whole[name], rtol=1e-5, atol=1e-9), name
