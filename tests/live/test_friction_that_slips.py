"""What slips slips in a linear model too: sheaves, drums and strings, against runs and differences of the equations."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.linalg import expm

import tautline
from tautline.lumped.curve import PER_BODY

DATA = Path(__file__).parents[2] / "data"
SPEED = "winch.pay_out_speed"

LIFT = """
title: A load that is hoisted over a sheave
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e+7, damping: 1.0e-4, diameter: 36 mm, breaking_load: 1.1 MN}
bodies: [{name: payload, mass: 5 t, position: [12.4, 0, 5]}]
path:
  - drum:   {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over,
             pay_out: {ramp: {to: -2.0, over: 0.5}}}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, law: no_slip}
  - end:    {name: hook, body: payload}
mesh: {elements_per_span: 3}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 1 ms, end: 12 s}
output: {interval: 50 ms}
"""
SHEAVES = {
    "efficiency": {"law": {"efficiency": 0.97}},
    "bearing": {"inertia": 20.0, "bearing": {"friction": 0.05, "radius": 0.06}},
    "capstan that is locked": {"law": "capstan", "friction": 0.12, "locked": True},
    "capstan with a rim": {"law": "capstan", "friction": 0.02, "inertia": 2.0e5},
}


def lift(sheave=None, drum=None):
    scene = yaml.safe_load(LIFT)
    scene["path"][1]["sheave"].update(sheave or {})
    if drum:
        scene["path"][0]["drum"].pop("pay_out")
        scene["path"][0]["drum"].update(drum)
    return scene


def by_differences(equations, steps):
    """K and C (n, n) by differences of fourth order of the residual, at the state of the equations."""
    t, q, v = equations.state()
    a, n = equations.acceleration(t, q, v), equations.size
    found = []
    for moved, step in enumerate(steps):
        matrix = np.zeros((n, n))
        for j, (times, weight) in ((j, each) for j in range(n) for each in ((1.0, 2 / 3), (2.0, -1 / 12))):
            for sign in (1.0, -1.0):
                q_v = [q.copy(), v.copy()]
                q_v[moved][j] += sign * times * step
                matrix[:, j] += sign * weight / step * equations.residual(t, *q_v, a)
        exact = equations.tangent(t, q, v, a, 0.0, float(moved), 1.0 - moved).toarray()
        found.append((exact, matrix))
    return found


@pytest.mark.parametrize("how", SHEAVES)
def test_the_tangent_of_a_sheave_that_slips_is_that_of_friction_at_its_limit(how):
    """The spring that holds what sticks, 6e7 N/m, is not in it.

    What the limit leaves out of its derivatives is small in their row: the momentum of the rope that runs, 10 N s/m at
    2 m/s, and how far the rope goes round the sheave.
    """
    sim = tautline.Simulation(lift(SHEAVES[how]))
    sim.advance_to(0.4)
    for (exact, differences), bound in zip(by_differences(sim.equations, (1e-5, 1e-5)), (1e-3, 3e-2), strict=True):
        wrong = np.abs(exact - differences).max(axis=1)
        assert (wrong < bound * np.abs(differences).max(axis=1)).all()


def test_the_tangent_of_a_drum_that_slips_in_its_friction_is_exact():
    sim = tautline.Simulation(lift(drum={"torque": 2.0e4, "inertia": 50.0, "friction_torque": 3.0e3}))
    sim.advance_to(1.0)
    for exact, differences in by_differences(sim.equations, (1e-5, 1e-5)):
        assert np.abs(exact - differences).max() < 1e-6 * np.abs(differences).max()


@pytest.mark.parametrize("sheave", [SHEAVES["bearing"], SHEAVES["efficiency"]])
def test_a_load_over_a_sheave_that_slips_answers_its_winch_as_in_a_run(sheave):
    """As if it stuck, the load would follow by 5 mm for each m/s, and not by 124.

    The winch is slow: in a linear model the rope does not grow shorter meanwhile.
    """
    scene = lift(sheave)
    scene["path"][0]["drum"]["pay_out"]["ramp"]["to"] = -0.05
    sim = tautline.Simulation(scene, inputs=[SPEED], keep=False)
    sim.advance_to(3.0)
    end, count, size = 0.3, 60, 1e-4
    plant = sim.linearise([SPEED], ["payload.position"])
    begin, here, seen = sim.inputs[SPEED], sim.save(), []
    for sign in (1.0, -1.0):
        sim.restore(here)
        for s in np.arange(1, count + 1) / count:
            given = sign * size * np.array([s**3 * (10 - 15 * s + 6 * s * s), 30.0 * (s * (1 - s)) ** 2 / end])
            sim.inputs[SPEED] = begin + given[0], given[1]
            sim.advance(end / count)
        seen.append(sim["payload.position"])
    run = (seen[0] - seen[1]) / (2.0 * size)
    n, fine = len(plant.A), 3000
    step = expm(np.block([[plant.A, plant.B], [np.zeros((1, n + 1))]]) * end / fine)
    x = np.zeros(n)
    for s in (np.arange(fine) + 0.5) / fine:
        x = step[:n, :n] @ x + step[:n, n] * s**3 * (10 - 15 * s + 6 * s * s)
    assert abs((plant.C @ x)[2] - run[2]) < 1e-3 * abs(run[2])
    assert abs(run[2]) > 0.1  # m for each m/s


def test_the_tangent_of_a_string_that_slips_along_its_wall_is_exact():
    """Lumps that slide have friction of the normal force alone; two of them stick, and are left out."""
    sim = tautline.Simulation(DATA / "jwell.yaml")
    sim.advance_to(3.0)
    for exact, differences in by_differences(sim.equations, (2e-8, 1e-7)):
        names = sim.model.system.names
        slipping = range(len(names) - 2 * PER_BODY)
        wrong = np.abs(exact - differences)[slipping].max(axis=1)
        assert (wrong < 1e-4 * np.abs(differences)[slipping].max(axis=1)).all()
