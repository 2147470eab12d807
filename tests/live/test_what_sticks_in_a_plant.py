"""A plant names what sticks in it, frees what holds nothing, and warns of modes that no step follows."""

import warnings
from pathlib import Path

import numpy as np
import pytest
import yaml

import tautline
from tautline.scene.functions import Constant

DATA = Path(__file__).parents[2] / "data"
SPEED, LOAD = "winch.pay_out_speed", "payload.position"
FREQUENCY = 0.02

LIFT = """
title: A load that hangs over a sheave
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e+7, damping: 1.0e-4, diameter: 36 mm, breaking_load: 1.1 MN}
bodies: [{name: payload, mass: 5 t, position: [12.4, 0, 5]}]
path:
  - drum:   {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, law: no_slip}
  - end:    {name: hook, body: payload}
mesh: {elements_per_span: 3}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 1 ms, end: 12 s}
output: {interval: 50 ms}
"""


def lift(drum, sheave=None):
    scene = yaml.safe_load(LIFT)
    scene["path"][0]["drum"].update(drum)
    scene["path"][1]["sheave"].update(sheave or {})
    return scene


def plant_of(sim, inputs=(), outputs=()):
    """A plant, and what is warned of."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        plant = sim.linearise(list(inputs), list(outputs))
    return plant, [str(one.message) for one in said]


def follows(plant):
    """Metres that the load goes down for each that is paid out slowly."""
    return -float((plant.response(FREQUENCY) * 2j * np.pi * FREQUENCY)[0, 2, 0].real)


def told_most(text):
    """The force up to which something is told to stick, N."""
    return float(text.partition("more than ")[2].split()[0])


def test_a_sheave_that_sticks_in_its_bearing_is_named_once_with_the_way_out():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    plant, said = plant_of(sim, [SPEED], [LOAD])
    assert follows(plant) < 0.1
    assert len(plant.stuck) == 1 and plant.stuck[0].startswith("boom tip: its bearing sticks")
    (text,) = said
    assert plant.stuck[0] in text and "Advance the simulation until it slips" in text and "bearing_friction" in text


def test_a_sheave_whose_bearing_friction_is_set_to_nothing_is_free_in_a_plant():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.parameters["boom tip.bearing_friction"] = 0.0
    plant, said = plant_of(sim, [SPEED], [LOAD])
    assert plant.stuck == () and not said
    assert follows(plant) == pytest.approx(1.0, abs=0.01)


def test_a_sheave_that_turns_is_not_named():
    sim = tautline.Simulation(DATA / "hoist.yaml")
    sim.advance(0.5)
    plant, said = plant_of(sim, [SPEED], [LOAD])
    assert plant.stuck == () and not said


def test_the_force_that_is_told_is_that_of_the_pin_times_friction_and_radii():
    """mu r/R times what both sides of the rope press on the pin with, of a load at rest."""
    sim = tautline.Simulation(lift({"pay_out": 0.0}, {"inertia": 20.0, "bearing": {"friction": 0.05, "radius": 0.06}}))
    plant, _ = plant_of(sim)
    told = told_most(plant.stuck[0])
    tension = 9.81 * (5000.0 + 6.5 * 25.0)
    along = np.array([12.0, 0.0, 30.0]) / np.hypot(12.0, 30.0)  # the rope to the drum, about
    pressed = tension * np.linalg.norm(along + np.array([0.0, 0.0, 1.0]))
    assert told == pytest.approx(0.05 * 0.06 / 0.4 * pressed, rel=0.02)


def test_a_brake_that_is_open_before_the_first_step_holds_nothing_in_a_plant():
    motor = {"torque": "26 kN m", "inertia": 300.0}
    free, _ = plant_of(tautline.Simulation(lift(motor)), ["winch.torque"], [LOAD])
    opened = tautline.Simulation(lift(motor | {"brake": {"torque": "60 kN m", "closed": 0.0}}))
    plant, said = plant_of(opened, ["winch.torque"], [LOAD])
    assert not said
    assert np.allclose(plant.response(0.05), free.response(0.05), rtol=1e-9)


def test_a_brake_that_is_too_weak_at_rest_slips_in_a_plant_as_in_the_first_step():
    """It holds 12 kN of 49 kN."""
    motor = {"torque": 0.0, "inertia": 300.0, "brake": {"torque": "60 kN m", "closed": 0.1}}
    plant, said = plant_of(tautline.Simulation(lift(motor)), ["winch.torque"], [LOAD])
    later = tautline.Simulation(lift(motor))
    later.advance_to(0.01)
    assert plant.stuck == () and not said
    behind, _ = plant_of(later, ["winch.torque"], [LOAD])
    assert np.allclose(plant.response(0.5), behind.response(0.5), rtol=1e-2, atol=1e-9)


@pytest.mark.parametrize("torque", [1.0, 1.0e4, 0.9 * 9.81 * 0.5 * (5000.0 + 6.5 * 25.0)])
def test_a_drum_that_slips_in_a_plant_is_not_said_to_stick(torque):
    """Rope on the drum is stretched as that beside it: the limit goes with the stretch of a soft rope, 0.5 %."""
    scene = lift({"torque": 0.0, "inertia": 500.0, "brake": {"torque": torque}})
    scene["rope"]["axial_stiffness"] = 1.0e7
    plant, said = plant_of(tautline.Simulation(scene), ["winch.torque"], [LOAD])
    assert plant.stuck == () and not said
    assert np.abs(plant.response(0.05)).max() > 1e-9


def test_a_drum_that_its_brake_holds_is_named_with_the_pull_at_which_it_slips():
    scene = lift({"torque": "26 kN m", "inertia": 300.0, "brake": {"torque": "60 kN m", "closed": 0.5}})
    plant, said = plant_of(tautline.Simulation(scene))
    assert (
        plant.stuck[0].startswith("winch: its brake holds it") and told_most(plant.stuck[0]) == 6e4
    )  # 30 kN m / 0.5 m
    assert "open its brake" in said[0]


def test_lumps_that_stick_to_the_wall_are_named_and_go_free_without_friction():
    sim = tautline.Simulation(DATA / "jwell.yaml")
    sim.advance(0.3)
    plant, said = plant_of(sim)
    lumps = [one for one in plant.stuck if "on the wall" in one]
    assert lumps and len(said) == 1 and "plant.stuck lists them" in said[0]
    sim.parameters["wall.friction"] = 0.0
    free, said = plant_of(sim)
    assert free.stuck == () and not said
    # Neither is anything held by the damper that stands for sticking.
    assert np.abs(free.eigenvalues).max() < 1e-4 * np.abs(plant.eigenvalues).max()


def test_a_bit_that_no_step_has_seen_yet_sticks_as_it_does_behind_the_first_step():
    """Its slow modes are those of a string that is held at its bit."""
    sim = tautline.Simulation(DATA / "drilling.yaml")
    early, said = plant_of(sim)
    assert any("the bit sticks in the rock" in one for one in early.stuck) and any("8000 N m" in one for one in said)
    sim.advance(sim.model.solver.step)
    late, _ = plant_of(sim)
    slow = [np.sort(p.eigenvalues.imag[(p.eigenvalues.imag > 0.1) & (np.abs(p.eigenvalues) < 20.0)])
            for p in (early, late)]  # fmt: skip
    assert slow[0].size == slow[1].size and np.allclose(*slow, rtol=1e-3)


def hose(coupling):
    scene = tautline.read(DATA / "hose.yaml")
    water = scene.water.model_copy(update={"speed": Constant(value=8.0)})
    return scene.model_copy(update={"coupling": coupling, "start": "static", "water": water})


@pytest.mark.parametrize("coupling", ["linear", "lagrange", "augmented", "penalty"])
def test_modes_of_penalty_springs_that_grow_unseen_by_a_run_are_warned_of(coupling):
    plant, said = plant_of(tautline.Simulation(hose(coupling)))
    if coupling != "penalty":
        assert not said and plant.eigenvalues.real.max() < 1e-3
        return
    (text,) = said
    assert "modes that grow" in text and "linear, lagrange or augmented" in text


def water_on_springs(stiffness, speed=8.0, elements=10, held=False):
    """Largest growth rate, 1/s, of water on springs to a pipe that is held still: M (w.. + 2 U w.' + U^2 w'') + k w."""
    mass, h = 7.854e-4, 0.5 / elements
    x, w = np.polynomial.legendre.leggauss(6)
    x, w = 0.5 * (x + 1.0), 0.5 * w * h
    shape = np.array([1 - 3 * x**2 + 2 * x**3, h * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, h * (x**3 - x**2)])
    slope = np.array([6 * x**2 - 6 * x, h * (1 - 4 * x + 3 * x**2), 6 * x - 6 * x**2, h * (3 * x**2 - 2 * x)]) / h
    curve = np.array([12 * x - 6, h * (6 * x - 4), 6 - 12 * x, h * (6 * x - 2)]) / h**2
    size = 2 * elements + 2
    m, c, k = np.zeros((3, size, size))
    for e in range(elements):
        own = slice(2 * e, 2 * e + 4)
        m[own, own] += mass * (shape * w) @ shape.T
        c[own, own] += 2.0 * mass * speed * (shape * w) @ slope.T
        k[own, own] += mass * speed**2 * (shape * w) @ curve.T
    k += np.diag(np.tile([stiffness, stiffness * h**2], elements + 1))
    if held:
        m, c, k = (part[1:, 1:] for part in (m, c, k))
    n = len(m)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    return np.linalg.eigvals(a).real.max()


def test_water_whose_first_node_is_on_a_spring_grows_by_the_flow_and_not_by_the_stiffness():
    """The energy that flows in, M U v^2 of the first node, is missing where it is held: the equations are unstable."""
    rates = [water_on_springs(k) for k in (1e4, 1e6)]
    assert min(rates) > 500.0 and rates[0] == pytest.approx(rates[1], rel=0.02)
    assert water_on_springs(1e5, speed=4.0) == pytest.approx(0.5 * rates[0], rel=0.02)
    assert water_on_springs(1e5, elements=20) == pytest.approx(2.0 * rates[0], rel=0.02)
    assert water_on_springs(1e5, held=True) < 1.0
