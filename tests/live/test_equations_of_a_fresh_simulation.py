"""What sticks before the first step sticks in the equations too: brakes, bearings and sheaves."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tautline

DATA = Path(__file__).parents[2] / "data"
BRAKED = """
title: A load that hangs from a drum whose brake is closed
rope: {mass_per_length: 1.0, axial_stiffness: 1.0e7 N, bending_stiffness: 0, damping: 1.0e-3, diameter: 20 mm,
       compression: none}
bodies: [{name: payload, mass: 1 t, position: [0.5, 0, -20]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, torque: 0 N m, inertia: 50,
           brake: {torque: 20 kN m, closed: 1}}
  - end:  {name: hook, body: payload}
mesh: {elements_per_span: 2}
gravity: [0, 0, -9.81]
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 1 ms, end: 2 s}
output: {interval: 50 ms}
"""
G, MASS, LENGTH, STIFFNESS = 9.81, 1000.0, 20.0, 1.0e7


def test_a_brake_that_no_step_has_loaded_holds_in_the_equations_as_in_the_run():
    """It holds 4 t, and 2 t hang from the first instant on: the load falls by what the rope stretches, twice at most.

    A brake that takes every state for the one it was closed in gives way to any load: 0.1 m in a fifth of a second.
    """
    sim = tautline.Simulation(BRAKED, keep=False)
    sim.parameters["payload.mass"] = 2.0 * MASS
    equations = sim.equations
    t, q, v = equations.state()
    load = equations.names.index("payload: z")
    found = solve_ivp(equations.first_order, (t, 0.2), np.concatenate((q, v)), "BDF", rtol=1e-7, atol=1e-9)
    begin = sim["payload.position"][2]
    sim.advance_to(0.2)
    fall, run = q[load] - found.y[load, -1], begin - sim["payload.position"][2]
    assert 0.0 < fall < 1.05 * 2.0 * MASS * G * LENGTH / STIFFNESS
    assert abs(fall - run) < 1.0e-3


SCENES = ["hoist", "hookblock", "landing", "sixteen_falls", "slewing", "reeled_span", "jwell", "tripping", "hanging"]


@pytest.mark.parametrize("scene", SCENES)
def test_the_tangent_before_the_first_step_is_the_derivative_of_the_residual(scene):
    """Against central differences, each row by its own largest: 2e10 stood against 5e5 at a braked drum."""
    equations = tautline.Simulation(DATA / f"{scene}.yaml", keep=False).equations
    t, q, v = equations.state()
    a, h = np.zeros(equations.size), 1.0e-8
    exact = equations.tangent(t, q, v, a).toarray()
    moves = h * np.eye(equations.size)
    moved = [equations.residual(t, q + d, v, a) - equations.residual(t, q - d, v, a) for d in moves]
    size = np.abs(exact)
    wrong = np.abs(np.array(moved).T / (2.0 * h) - exact) / (size.max(axis=1) + 1e-9 * size.max())[:, None]
    assert wrong.max() < 1.0e-4
