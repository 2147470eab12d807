"""Where a force raises, time and all outputs are those of the last step that was accepted."""

from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[3] / "data"


class Broken(Exception):
    """What the force raises."""


EXPLICIT = {"solver.method": "rk4", "solver.step": "0.1 ms"}


def hoist(raises, how=None):
    sim = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace(how or {}))

    def force(t, q, v):
        if raises and t > 0.62:
            raise Broken
        return np.zeros(3)

    sim.add_force(force, on="payload.position")
    return sim


@pytest.mark.parametrize("how", [{}, EXPLICIT], ids=["implicit", "explicit"])
def test_all_outputs_after_a_force_that_raised_are_of_the_time_that_is_told(how):
    """`body_position` was of 0.6 s, and `payload.position` of 0.62 s: 28 mm apart. With rk4 positions were NaN."""
    sim, whole = hoist(True, how), hoist(False, how)
    with pytest.raises(Broken):
        sim.advance(1.0)
    whole.advance_to(sim.time)
    assert 0.61 < sim.time < 0.63
    assert np.array_equal(sim["payload.position"], sim["body_position"][0])
    for name in ("body_velocity", "kinetic_energy", "potential_energy", "winch.pay_out", "tension", "winch.torque"):
        assert np.allclose(sim[name], whole[name], rtol=1e-5, atol=1e-9), name


def test_outputs_after_an_explicit_step_that_failed_are_those_before_it():
    """The load was told at the height of the failed step, 100 m above."""
    sim = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace(EXPLICIT))
    sim.advance_to(0.2)
    sim.displace("payload.velocity", [0.0, 0.0, 1e6])
    before = sim["payload.position"]
    with pytest.raises(tautline.StoppedEarly):
        sim.advance_to(0.3)
    assert sim.time == pytest.approx(0.2) and sim["payload.position"] == pytest.approx(before)


def test_a_force_that_is_no_number_at_a_frame_stops_an_explicit_run_there():
    """The result was refused with a fault of the program, and with it all frames before."""
    sim = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace(EXPLICIT))
    sim.add_force(lambda t, q, v: np.full(3, np.nan if t > 0.3 else 0.0), on="payload.position")
    with pytest.raises(tautline.StoppedEarly, match="NO_FORCE"):
        sim.advance_to(0.5)
    assert np.isfinite(sim["payload.position"]).all() and sim.result["time"][-1] == pytest.approx(0.25)


def test_to_read_a_result_calls_no_force_of_the_users():
    calls = []
    sim = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace(EXPLICIT))

    def force(t, q, v):
        calls.append(t)
        return np.zeros(3)

    sim.add_force(force, on="payload.position")
    sim.advance_to(0.32)
    count = len(calls)
    assert sim.result and sim.save() and len(calls) == count > 0
