"""A load that is hoisted to its sheave: the critical step of the rope above it falls to a half within four seconds.

The reference is generalized-alpha with a step of 0.5 ms, another integrator, which knows no critical step.
"""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline import run as running
from tautline.integrators.status import Status, StoppedEarly

DATA = Path(__file__).parents[2] / "data"
HOISTED = {"bodies[0].position": [12.4, 0.0, 20.0], "solver.end": "4.4 s", "mesh.elements_per_span": 2}


def hoisted(**how):
    return tautline.simulate(tautline.read(DATA / "hoist.yaml").replace(HOISTED), **how)


@pytest.fixture(scope="module")
def reference():
    return hoisted(step="0.5 ms")


@pytest.fixture(scope="module")
def chosen():
    return hoisted(method="rk4", step="auto")


def test_a_step_that_is_chosen_follows_the_critical_one_down(chosen, reference):
    # It was ten steps beyond: 1494 kN in place of 51.17.
    assert chosen.attributes["energy_error"] < 1e-6
    np.testing.assert_allclose(chosen["tension"], reference["tension"], atol=3.0)


def test_steps_that_are_chosen_do_not_depend_on_how_busy_the_machine_is(chosen, monkeypatch):
    monkeypatch.setattr(running, "BATCH", 1e-3)
    again = hoisted(method="rk4", step="auto")
    assert again.attributes["steps"] == chosen.attributes["steps"]
    for name in ("time", "position", "velocity", "tension", "strain_energy"):
        np.testing.assert_array_equal(again[name], chosen[name])


def test_a_live_simulation_follows_the_critical_step_down(reference):
    scene = tautline.read(DATA / "hoist.yaml").replace(HOISTED | {"solver.method": "rk4", "solver.step": "auto"})
    live = tautline.Simulation(scene, keep=False)
    for _ in reference.time[1:]:
        live.advance(0.05)
    np.testing.assert_allclose(np.ravel(live["winch.tension"])[0], np.ravel(reference["tension"][-1])[0], atol=3.0)


def test_what_a_step_beyond_the_critical_one_made_is_done_again(chosen, monkeypatch):
    # A run that looks so seldom that its first look comes too late
    monkeypatch.setattr("tautline.integrators.explicit_step.FEWEST_STEPS", 100_000)
    late = hoisted(method="rk4", step="auto")
    assert late.attributes["energy_error"] < 1e-6
    np.testing.assert_allclose(late["tension"], chosen["tension"], atol=1.0)
    assert (np.diff(late.time) > 0.0).all() and late.time.size == chosen.time.size


def test_a_step_that_is_given_ends_the_run_where_the_critical_one_has_fallen_below_it():
    with pytest.raises(StoppedEarly) as stop:
        hoisted(method="rk4", step="0.62 ms")
    assert stop.value.status == Status.UNSTABLE and stop.value.time > 3.0


def test_a_run_that_is_gone_on_with_is_judged_by_its_energy_from_there_on(reference):
    scene = tautline.read(DATA / "hoist.yaml").replace(HOISTED | {"output.interval": "0.2 s"})
    first = tautline.simulate(scene, method="rk4", step="auto", end=2.0)
    whole = tautline.simulate(scene, method="rk4", step="auto", resume=first)
    assert whole.attributes["energy_error"] < 1e-6
    np.testing.assert_allclose(whole["tension"], reference["tension"][::4], atol=3.0)


def test_a_step_that_is_chosen_is_looked_at_anew_when_a_parameter_is_changed():
    scene = tautline.read(DATA / "hoist.yaml").replace(HOISTED | {"path[0].drum.pay_out": {"constant": 0.0}})
    live = {}
    for how in ({"solver.method": "rk4", "solver.step": "auto"}, {"solver.step": "0.5 ms"}):
        sim = live[how["solver.step"]] = tautline.Simulation(scene.replace(how))
        sim.advance_to(1.0)
        sim.parameters["rope.damping"] = 20.0 * sim.parameters["rope.damping"]
        sim.advance_to(2.0)
    # It was 1906 kN after 1.9 s, in place of 50.
    np.testing.assert_allclose(live["auto"].result["tension"], live["0.5 ms"].result["tension"], atol=20.0)


@pytest.mark.parametrize("end", [Status.TWO_BLOCKED, Status.UNSTABLE])
def test_a_live_run_doubts_its_step_where_motion_has_grown_and_not_where_blocks_have_met(end):
    live = tautline.Simulation(
        tautline.read(DATA / "hoist.yaml").replace({"solver.method": "rk4", "solver.step": "auto"})
    )
    live.advance(0.1)
    with pytest.raises(StoppedEarly):
        live._stop(live.time, end)
    said = [one for one in live.result.attributes["warnings"] if "longer than the critical one" in one]
    assert bool(said) == (end == Status.UNSTABLE)
