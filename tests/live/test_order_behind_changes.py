"""What is changed from outside counts from that time on: implicit methods keep their second order behind it.

Reference: closed forms of one mass on a spring, in two pieces.
"""

from __future__ import annotations

import numpy as np
import pytest

import tautline

CHANGED_AT, END = 0.4, 0.9
STIFFNESS, LOAD = 100.0, 1.0


def swinging(x, v, stiffness, load, time):
    """Place and speed of 1 kg on a spring, a time later, s."""
    omega, rest = np.sqrt(stiffness), load / stiffness
    c, s = np.cos(omega * time), np.sin(omega * time)
    return rest + (x - rest) * c + v / omega * s, v * c - (x - rest) * omega * s


def mass_on_a_spring(step, method="type: G-alpha, rho_inf: 0.8"):
    return tautline.Simulation(
        f"""
CableModelMaterial: {{Gravity: [0, 0, 0]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 1, 1, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: {STIFFNESS}, rhoA: 0, strain: engineering}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1}}
  - PointForce: {{id: 0, nodes4: [1], force: [{LOAD}, 0, 0]}}
GeneralizedAlpha: {{{method}, time_step: {step}, time_end: 2}}
"""
    )


def add_force(sim):
    sim.add_force(lambda t, q, v: [10.0, 0.0, 0.0], on="node 1.position")


def set_stiffness(sim):
    sim.parameters["cables.axial_stiffness"] = 2.25 * STIFFNESS


def displace(sim):
    sim.displace("node 1.position", [0.1, 0.0, 0.0])


CHANGES = {
    "a force is added": (add_force, 0.0, STIFFNESS, LOAD + 10.0),
    "a stiffness is set": (set_stiffness, 0.0, 2.25 * STIFFNESS, LOAD),
    "a place is changed": (displace, 0.1, STIFFNESS, LOAD),
}


@pytest.mark.parametrize("name", CHANGES)
@pytest.mark.parametrize("method", ["type: G-alpha, rho_inf: 0.8", "type: G-alpha, rho_inf: 0.3", "type: Newmark"])
def test_motion_behind_a_change_is_of_second_order(name, method):
    change, moved, stiffness, load = CHANGES[name]
    x, v = swinging(0.0, 0.0, STIFFNESS, LOAD, CHANGED_AT)
    expected = swinging(x + moved, v, stiffness, load, END - CHANGED_AT)
    errors = []
    for step in (0.01, 0.005):
        sim = mass_on_a_spring(step, method)
        sim.advance_to(CHANGED_AT)
        change(sim)
        sim.advance_to(END)
        found = float(sim["node 1.position"][0]) - 1.0, float(sim["node 1.velocity"][0])
        errors.append(np.hypot(found[0] - expected[0], (found[1] - expected[1]) / np.sqrt(stiffness)))
    assert errors[0] < 0.012 * 0.11, "63 steps a period; it was 5 % of the swing"
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.4)


def test_a_change_is_no_push_of_a_mass_that_it_does_not_touch():
    """Bit for bit the motion is that without it, but for what finding the accelerations anew rounds."""
    plain, set_again = mass_on_a_spring(0.01), mass_on_a_spring(0.01)
    for sim in (plain, set_again):
        sim.advance_to(CHANGED_AT)
        if sim is set_again:
            sim.parameters["cables.axial_stiffness"] = STIFFNESS
        sim.advance_to(END)
    assert float(set_again["node 1.position"][0]) == pytest.approx(float(plain["node 1.position"][0]), rel=0, abs=2e-5)
