"""What a force that was added does is in the linear model whole, wherever it acts."""

import numba
import numpy as np
import pytest

import tautline
from tautline.cable.input.scene import parse

COUNT, STIFF, FAR, DAMPING = 12, 100.0, 50.0, 4.0
ENDS = """
title: Masses in a row
CableModelMaterial: {Gravity: [0, 0, 0]}
CableModel:
"""
SOLVER = "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 2}"


def row_of_masses():
    """Masses of 1 kg, 1 m apart, with springs between them; the first one is held to a wall by another."""
    nodes = [f"  - Node4Dof: {{id: {i}, xyz: [{i}, 0, 0], BC: [{int(i == 0)}, 1, 1, 1]}}" for i in range(COUNT + 1)]
    springs = [
        f"  - CableALEelementLin: {{id: {i}, nodes4: [{i}, {i + 1}], EA: {STIFF}, rhoA: 0, strain: engineering}}"
        for i in range(COUNT)
    ]
    masses = [f"  - PointMass: {{id: {i}, nodes4: [{i}], mass: 1}}" for i in range(1, COUNT + 1)]
    return tautline.Simulation(parse(ENDS + "\n".join([*nodes, *springs, *masses, SOLVER]) + "\n"))


def place_of(sim, node):
    return int(np.ravel(sim.outputs.handle(f"node {node}.position").places[1])[0])


def stiffness_and_damping():
    """Those of the row with a spring, and a damper, from its first mass to its last, by hand."""
    stiff = STIFF * (2.0 * np.eye(COUNT) - np.eye(COUNT, k=1) - np.eye(COUNT, k=-1))
    stiff[-1, -1] = STIFF
    far = np.zeros((COUNT, COUNT))
    far[np.ix_([0, -1], [0, -1])] = [[1.0, -1.0], [-1.0, 1.0]]
    return stiff + FAR * far, DAMPING * far


def in_python(first, last):
    def force(t, q, v):
        pull = FAR * (q[last] - q[first] - (COUNT - 1)) + DAMPING * (v[last] - v[first])
        found = np.zeros(len(q))
        found[first], found[last] = pull, -pull
        return found

    return force


def compiled(first, last):
    @numba.njit
    def force(t, q, v, f):
        pull = FAR * (q[last] - q[first] - (COUNT - 1)) + DAMPING * (v[last] - v[first])
        f[first], f[last] = pull, -pull

    return force


@pytest.mark.parametrize("make", [in_python, compiled])
@pytest.mark.parametrize("named", [True, False], ids=["on two places", "on all places"])
def test_a_force_between_distant_places_is_whole_in_the_linear_model(make, named):
    # the tangent of the steps has no room for it: entries of -50 N/m, or all of them, were left out without a word
    sim = row_of_masses()
    first, last = place_of(sim, 1), place_of(sim, COUNT)
    if named:
        sim.add_force(make(0, 1), on=[first, last])
    else:
        sim.add_force(make(first, last))
    stiff, damped = stiffness_and_damping()
    plant = sim.linearise([], [])
    order = np.argsort([int(name.split()[1].rstrip(":")) for name in plant.states[:COUNT]])
    own = plant.A[COUNT:]
    np.testing.assert_allclose(-own[:, :COUNT][np.ix_(order, order)], stiff, atol=1e-6)
    np.testing.assert_allclose(-own[:, COUNT:][np.ix_(order, order)], damped, atol=1e-6)
    equations = sim.equations
    t, q, v = equations.state()
    found = equations.tangent(t, q, v, np.zeros(COUNT), 0.0, 0.0, 1.0).toarray()
    np.testing.assert_allclose(found[np.ix_(order, order)], stiff, atol=1e-6)
    jacobian = equations.first_order_tangent(t, np.concatenate((q, v)))
    np.testing.assert_allclose(-jacobian[COUNT:, COUNT:][np.ix_(order, order)], damped, atol=1e-6)


def test_to_linearise_leaves_the_tangent_of_the_steps_as_it_is():
    found = []
    for look in (False, True):
        sim = row_of_masses()
        sim.add_force(in_python(0, 1), on=[place_of(sim, 1), place_of(sim, COUNT)])
        sim.displace("node 1.position", np.array([1.1, 0.0, 0.0]))
        if look:
            sim.linearise([], [])
        sim.advance_to(0.1)
        found.append(sim["node 12.position"].copy())
    np.testing.assert_array_equal(*found)
