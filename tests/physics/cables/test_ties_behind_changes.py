"""What multipliers tie, behind changes from outside; forces that begin and end in steps of very different lengths."""

import numpy as np
import pytest
from of_the_suite import studies

import tautline
from tautline.live.errors import SimulationError
from tautline.results.errors import ResultError

MASSES, STIFFNESS, FORCE = (0.35, 0.55), 60.0, 1.0
TURN = float(np.sqrt(STIFFNESS / sum(MASSES)))
BARS = """
CableModelMaterial: {{Gravity: [0, 0, 0]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [{0}, 0, 0], BC: [1, 1, 1, 1]{driven}}}
  - Node4Dof: {{id: 1, xyz: [{1}, 0, 0], BC: [0, 1, 1, 1]}}
  - Node4Dof: {{id: 2, xyz: [{2}, 0, 0], BC: [0, 1, 1, 1]}}
  - Node4Dof: {{id: 3, xyz: [{3}, 0, 0], BC: [1, 1, 1, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: 30, rhoA: 0, strain: engineering}}
  - CableALEelementLin: {{id: 1, nodes4: [2, 3], EA: 30, rhoA: 0, strain: engineering}}
  - PointMass: {{id: 0, nodes4: [1], mass: 0.35}}
  - PointMass: {{id: 1, nodes4: [2], mass: 0.55}}
  - PointForce: {{id: 0, nodes4: [1], force: [{force}, 0, 0]}}
  - {tie}: {{id: 0, nodes4: [1, 2], constr: 0, offset: [0.3, 0, 0]}}
GeneralizedAlpha: {{type: {type}, time_step: {step}, time_end: 2, plotpoints: 200}}
"""


def bars(tie="LagMultipl4", type="G-alpha, rho_inf: 0.8", step=0.001, at=0.0, force=FORCE):
    """Two masses on bars of 30 N/m, tied 0.3 m apart: one mass of 0.9 kg on 60 N/m."""
    places = [at, at + 1.0, at + 1.3, at + 2.3]
    return BARS.format(*places, driven="", tie=tie, type=type, step=step, force=force)


@pytest.mark.parametrize("type", ["G-alpha, rho_inf: 0.8", "Newmark", *studies("G-alpha, rho_inf: 0.0")])
@pytest.mark.parametrize("at", [0.0, 1000.7])
@pytest.mark.parametrize("tie", ["LagMultipl4", *studies("AugLagrange4")])
def test_masses_that_multipliers_tie_stay_one_mass_behind_a_force_that_is_added(tie, at, type):
    # The last digit of 1.3 - 1.0 - 0.3, over a step that is next to nothing, was a speed of 1000 m/s.
    sim = tautline.Simulation(bars(tie, type, at=at))
    sim.advance(0.05)
    sim.add_force(lambda t, q, v: [0.0, 0.0, 0.0], on="node 1.position")
    for time in (0.051, 0.052, 0.1):
        sim.advance_to(time)
        exact = FORCE / STIFFNESS * TURN * np.sin(TURN * time)
        assert [sim[f"node {i}.velocity"][0] for i in (1, 2)] == pytest.approx([exact, exact], rel=2e-3)
    assert sim.result.attributes["status"] == "done"


def test_what_multipliers_tie_is_displaced_together_or_not_at_all():
    sim = tautline.Simulation(bars(force=0.0))
    sim.advance(0.01)
    sim.displace("node 1.position", [0.01, 0.0, 0.0])
    with pytest.raises(SimulationError, match="no longer stands at what it is tied to, by the multiplier of r = r"):
        sim.advance(0.01)
    other = sim.copy()
    with pytest.raises(SimulationError, match="no longer stands at what it is tied to"):
        other.advance(0.01)
    sim.restore(sim.save())
    sim.displace("node 2.position", [0.01, 0.0, 0.0])
    sim.advance(0.2)
    exact = 0.01 * np.cos(0.2 * TURN)
    assert sim["node 1.position"][0] - 1.0 == pytest.approx(exact, abs=1e-5)
    assert sim["node 2.position"][0] - 1.3 == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("before", [0.0, 0.01])
@pytest.mark.parametrize("type", ["RK4", "G-alpha, rho_inf: 0.8", *studies("Newmark")])
@pytest.mark.parametrize("tie", ["LagMultipl4", *studies("AugLagrange4")])
def test_what_multipliers_tie_is_displaced_together_by_every_method_and_before_the_first_advance(tie, type, before):
    # Before an advance the speeds were -12 and 8 m/s a millisecond later. RK4 put both masses half way.
    sim = tautline.Simulation(bars(tie, type, force=0.0))
    if before:
        sim.advance(before)
    sim.displace("node 1.position", [0.01, 0.0, 0.0])
    with pytest.raises(SimulationError, match="no longer stands at what it is tied to, by the multiplier of r = r"):
        sim.advance(0.01)
    sim.displace("node 2.position", [0.01, 0.0, 0.0])
    sim.advance(0.2)
    exact = 0.01 * np.cos(0.2 * TURN)
    assert sim["node 1.position"][0] - 1.0 == pytest.approx(exact, abs=1e-5)
    assert sim["node 2.position"][0] - 1.3 == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("type", ["RK4", "G-alpha, rho_inf: 0.8"])
def test_nothing_else_goes_on_from_a_state_whose_ties_are_torn(type):
    """Neither a run nor an integrator of others; from the state whose ties are whole again both do."""
    scene = tautline.read(bars(type=type, force=0.0))
    sim = tautline.Simulation(scene)
    sim.advance(0.01)
    sim.displace("node 1.position", [0.01, 0.0, 0.0])
    with pytest.raises(SimulationError, match="no longer stands at what it is tied to"):
        _ = sim.equations
    with pytest.raises(ResultError, match="no longer stands at what it is tied to, by the multiplier of r = r"):
        tautline.simulate(scene, resume=sim.result)
    sim.displace("node 2.position", [0.01, 0.0, 0.0])
    assert sim.equations.size
    on = tautline.simulate(scene, resume=sim.result)
    exact = 0.01 * np.cos((on.time[-1] - 0.01) * TURN)
    assert on["position"][-1, 1, 0] - 1.0 == pytest.approx(exact, abs=2e-4)


@pytest.mark.parametrize("tie", ["LagMultipl4", *studies("AugLagrange4")])
def test_masses_that_are_tied_keep_one_speed_where_the_end_of_their_bar_goes_at_once(tie):
    """The base goes off at 0.5 m/s at 0.3 s, within no step: no mass on a spring is ever faster than twice that."""
    text = BARS.replace(
        "CableModel:\n",
        "CableModel:\n  - Function: {{id: 1, value: {{table: {{time: [0, 0.3035, 3], value: [0, 0, 1.34825], "
        "interpolation: linear}}}}}}\n",
    )
    scene = text.format(
        0, 1.0, 1.3, 2.3, driven=", BC_functions: [1, 0, 0, 0]", tie=tie, type="G-alpha, rho_inf: 0.8", step=0.01,
        force=0.0,
    )  # fmt: skip
    result = tautline.simulate(tautline.read(scene))
    speeds = result["velocity"][:, 1:3, 0].T
    assert np.abs(speeds).max() < 0.51 and np.abs(speeds[0] - speeds[1]).max() < 1e-9


PUSHED = """
CableModelMaterial: {{Gravity: [0, 0, 0]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 1, 1, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: {stiffness}, rhoA: 0, strain: engineering}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1}}
  - PointForce: {{id: 0, nodes4: [1], force: [1, 0, 0]{interval}}}
GeneralizedAlpha: {{type: {type}, time_step: 0.01, time_end: 100, plotpoints: 5}}
"""


@pytest.mark.parametrize("type", ["G-alpha, rho_inf: 0.8", "Newmark", *studies("G-alpha, rho_inf: 0.0")])
@pytest.mark.parametrize("short", [0.001, *studies(0.0001, 0.0017, 0.003)])
def test_a_constant_force_stays_what_it_is_where_advances_are_long_and_short_in_turn(short, type):
    # After 90 pairs of 0.01 and 0.001 s the force was 5e7 times too large.
    sim = tautline.Simulation(PUSHED.format(stiffness=1.0, type=type, interval=""))
    for _ in range(100):
        sim.advance(0.01)
        sim.advance(short)
    assert sim["node 1.position"][0] - 1.0 == pytest.approx(1.0 - np.cos(sim.time), abs=2e-3)


@pytest.mark.parametrize("begin", [0.0523, 0.0611, *studies(0.0477, 0.0559)])
@pytest.mark.parametrize("lengths", [[0.01, 0.001], [0.01, 0.001, 0.001, 0.004], *studies([0.01, 0.0002])])
def test_a_pulse_has_its_impulse_where_steps_are_long_and_short_in_turn(lengths, begin):
    lasts = 0.0377
    sim = tautline.Simulation(
        PUSHED.format(
            stiffness=1e-6, type="G-alpha, rho_inf: 0.8", interval=f", timeInterval: [{begin}, {begin + lasts}]"
        )
    )
    while sim.time < 0.5:
        for length in lengths:
            sim.advance(length)
    assert sim["node 1.velocity"][0] == pytest.approx(lasts, rel=0.015)
