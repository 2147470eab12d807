"""Behind a blow the forces are those of the state as it is, and the energy ledger goes on right."""

from pathlib import Path

import numpy as np
import pytest
from physics.lifting.crane_scenes import fall

import tautline
from tautline.live.errors import SimulationError
from tautline.results.assessment.balance import ENERGIES

HOIST = Path(__file__).parents[3] / "data" / "hoist.yaml"
G, MASS, LENGTH, ELEMENTS = 9.81, 5000.0, 25.0, 4
EA, RHO, DAMPING = 8.0e7, 6.5, 1.0e-3


def a_fall(elements=ELEMENTS, **more):
    rope = {"axial_stiffness": EA, "mass_per_length": RHO, "damping": DAMPING}
    return fall(MASS, LENGTH, elements, rope=rope, start="static", **more)


def own_forces(sim):
    """N = EA (eps + c eps.) lambda of every element, with Green's strain, of the places and speeds of nodes alone."""
    way, speed = np.diff(sim["position"], axis=0), np.diff(sim["velocity"], axis=0)
    material = np.diff(sim["material_coordinate"])
    length = np.linalg.norm(way, axis=1)
    stretch, rate = length / material, np.einsum("ec,ec->e", way, speed) / length / material
    force = EA * (0.5 * (stretch**2 - 1.0) + DAMPING * stretch * rate) * stretch
    return np.maximum(force, 0.0), RHO * G * material


def energies(sim):
    return np.array([sim[name] for name in ENERGIES])


@pytest.mark.parametrize("step", [5.0e-3, 2.0e-4])
@pytest.mark.parametrize("name, by", [("position", [0.0, 0.0, -0.01]), ("position", [1.0, 0.0, 0.0]),
                                      ("velocity", [0.0, 0.0, -1.0])])  # fmt: skip
def test_the_step_behind_a_blow_loses_no_more_than_there_is_and_the_energy_balances(step, name, by):
    """The way of the blow counted as motion through the dampers: up to 30 times its work was lost."""
    sim = tautline.Simulation(a_fall(solver={"step": step}))
    sim.advance(2.0 * step)
    before = energies(sim)
    sim.displace(f"payload.{name}", by)
    struck = energies(sim)
    sim.advance(step)
    brought, gone = struck - before, energies(sim) - struck
    work = brought[3]
    assert work == pytest.approx(brought[:3].sum(), rel=1e-9) and work > 100.0
    assert 0.0 <= gone[4] < work
    assert abs(gone[:3].sum() + gone[4] - gone[3]) < 0.01 * work


@pytest.mark.parametrize("elements", [1, ELEMENTS])
@pytest.mark.parametrize("ahead", [0.0, 0.01], ids=["before any step", "after a step"])
@pytest.mark.parametrize("name, by", [("position", [0.0, 0.0, -0.05]), ("position", [1.0, 0.0, 0.0]),
                                      ("velocity", [0.0, 0.0, -1.0]), ("position", [0.0, 0.0, 0.5])],
                         ids=["down", "aside", "speed", "slack"])  # fmt: skip
def test_the_tension_behind_a_blow_is_that_of_own_numbers(elements, ahead, name, by):
    """Tensions were those of before the blow, to the bit, once a step had been made."""
    sim = tautline.Simulation(a_fall(elements))
    if ahead:
        sim.advance(ahead)
    sim.displace(f"payload.{name}", by)
    force, weight = own_forces(sim)
    way = np.diff(sim["position"], axis=0)
    along = -way[:, 2] / np.linalg.norm(way, axis=1)
    first, last = force + 0.5 * weight * along, force - 0.5 * weight * along
    ends = np.where(force[[0, -1]] > 0.0, [first[0], last[-1]], 0.0)
    assert np.allclose(sim["axial_force"], force, rtol=1e-6, atol=1e-3)
    assert np.allclose(sim["tension"][0], ends, rtol=1e-5, atol=1.0)
    assert sim["max_tension"] == pytest.approx(max(ends), rel=1e-5, abs=1.0)


def test_a_stiffness_that_changes_is_in_the_tension_at_once():
    sim = tautline.Simulation(a_fall())
    sim.advance(0.01)
    before = sim["tension"][0].copy()
    sim.parameters["rope.axial_stiffness"] = 1.5 * EA
    force = 1.5 * own_forces(sim)[0]
    assert sim["tension"][0] - before == pytest.approx(force[[0, -1]] / 3.0, rel=1e-3)


def test_a_force_of_the_user_is_not_called_by_a_blow_and_the_run_goes_on_as_without_a_look():
    called = []

    def push(t, q, v):
        called.append(t)
        return np.zeros(3)

    sim, plain = tautline.Simulation(a_fall()), tautline.Simulation(a_fall())
    sim.add_force(push, on="payload.position")
    for one in (sim, plain):
        one.advance(0.01)
    count = len(called)
    for one in (sim, plain):
        one.displace("payload.position", [0.0, 0.0, -0.01])
    assert len(called) == count and sim["tension"] == pytest.approx(plain["tension"], rel=1e-9)
    for one in (sim, plain):
        one.advance(0.01)
    assert len(called) > count and sim["payload.position"] == pytest.approx(plain["payload.position"], abs=1e-9)


def test_a_displacement_that_would_move_nothing_is_refused():
    """It was taken, nothing moved, and the result said that the winch was displaced."""
    sim = tautline.Simulation(HOIST)
    with pytest.raises(SimulationError, match="held or prescribed"):
        sim.displace("winch.position", [0.0, 1.0, 0.0])
    assert "displaced" not in sim.result.attributes
