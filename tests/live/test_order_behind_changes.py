"""What is changed from outside counts from that time on: implicit methods keep their second order behind it.

Reference: closed forms of one mass on a spring, in two pieces.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

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


@pytest.mark.parametrize("method", ["type: G-alpha, rho_inf: 0.8", "type: G-alpha, rho_inf: 0.3", "type: Newmark"])
def test_a_stiffness_that_is_set_in_every_step_is_followed_in_second_order(method):
    """It grows by a half in a second, and is set to its values in the middle of steps. Reference: solve_ivp."""

    def grown(t):
        return STIFFNESS * (1.0 + 0.5 * t)

    exact = solve_ivp(lambda t, y: [y[1], LOAD - grown(t) * y[0]], [0.0, 1.5], [0.0, 0.0], rtol=1e-11, atol=1e-13)
    errors = []
    for step in (0.01, 0.005):
        sim = mass_on_a_spring(step, method)
        for k in range(round(1.5 / step)):
            sim.parameters["cables.axial_stiffness"] = grown((k + 0.5) * step)
            sim.advance_to((k + 1) * step)
        errors.append(abs(float(sim["node 1.position"][0]) - 1.0 - exact.y[0, -1]))
    assert errors[0] < 0.1 * LOAD / STIFFNESS
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.6)


def test_a_value_that_is_set_again_changes_nothing():
    plain, same = mass_on_a_spring(0.01), mass_on_a_spring(0.01)
    for k in range(1, 31):
        same.parameters["cables.axial_stiffness"] = STIFFNESS
        for sim in (plain, same):
            sim.advance_to(0.01 * k)
    np.testing.assert_array_equal(same["node 1.position"], plain["node 1.position"])


def test_a_light_node_of_a_stiff_rope_that_is_displaced_does_not_fold_it():
    """2 cm along, of an element of 1 m: the tension is at most that of the element that it stretches, EA 2 %, twice."""
    nodes = [f"Node4Dof: {{id: {k}, xyz: [{k}, 0, 0], BC: [{int(k in (0, 100))}, 1, 1, 1]}}" for k in range(101)]
    lines = [
        f"CableALEelementLin: {{id: {k}, nodes4: [{k}, {k + 1}], EA: 5.0e+6, rhoA: 1, strain: engineering}}"
        for k in range(100)
    ]
    text = "CableModelMaterial: {Gravity: [0, 0, 0]}\nCableModel:\n" + "".join(f"  - {one}\n" for one in nodes + lines)
    sim = tautline.Simulation(text + "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 1}\n")
    sim.advance_to(0.05)
    sim.displace("node 50.position", [0.02, 0.0, 0.0])
    largest = 0.0
    for k in range(40):
        sim.advance_to(0.055 + 0.005 * k)
        largest = max(largest, np.abs(np.asarray(sim["axial_force"])).max())
    assert largest < 2.0 * 0.02 * 5.0e6
