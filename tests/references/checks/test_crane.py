"""Self-tests of the closed forms of reeving and of the elevator: other methods, limits, balances."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from references import crane, elevator
from references.crane import FrictionAtwood
from references.elevator import Elevator


# Atwood's machine
def test_atwood_obeys_newton_and_the_sheave_takes_the_difference():
    a, T1, T2 = crane.atwood(80.0, 100.0, 12.0, 0.4)
    assert (T2 - T1) * 0.4 == pytest.approx(12.0 * a / 0.4)
    assert a == pytest.approx(20 * 9.81 / (180 + 75))


HEAVY = {"mass_1": 80.0, "mass_2": 100.0, "mass_per_length": 2.0, "length": 30.0, "inertia": 12.0, "radius": 0.4}


def test_heavy_rope_obeys_its_equation_and_keeps_its_energy():
    times = np.linspace(0, 2, 201)
    motion = crane.heavy_atwood(times, **HEAVY, x0=0.5, v0=-0.8)
    assert (motion.x[0], motion.v[0]) == (pytest.approx(0.5), pytest.approx(-0.8))
    assert np.gradient(motion.x, times, edge_order=2) == pytest.approx(motion.v, abs=1e-3)
    total = 80 + 100 + 2 * 30 + 12 / 0.4**2
    energy = total * motion.v**2 / 2 - 9.81 * (20 * motion.x + 2 * motion.x**2)
    assert energy == pytest.approx(np.full(201, energy[0]), abs=1e-10)
    # the rim and the rope on it
    turned = (12 / 0.4**2 + 2 * np.pi * 0.4) * motion.a
    assert motion.tension_2 - motion.tension_1 == pytest.approx(turned, abs=1e-10)


def test_light_rope_is_no_rope():
    light = {**HEAVY, "mass_per_length": 1e-7}
    motion = crane.heavy_atwood([1.0], **light, x0=0.0)
    a, T1, T2 = crane.atwood(80.0, 100.0, 12.0, 0.4)
    assert [motion.a[0], motion.tension_1[0], motion.tension_2[0]] == pytest.approx([a, T1, T2], rel=1e-7)
    assert motion.x[0] == pytest.approx(a / 2, rel=1e-6)


# capstan
def test_capstan_ratio_is_the_solution_of_its_equation():
    q = 6.5 * 4
    done = solve_ivp(lambda _, T: 0.12 * (T - q), (0, 2.5), [4e4], rtol=1e-12)
    assert crane.capstan_tension(4e4, 0.12, 2.5, q) == pytest.approx(done.y[0, -1], rel=1e-10)
    assert crane.capstan_ratio(0.1, np.pi, np.radians(60)) == pytest.approx(np.exp(0.2 * np.pi))


@pytest.mark.parametrize("friction", [0.0, 0.12])
def test_rope_with_weight_on_the_sheave_obeys_its_equation(friction):
    radius, rho, speed, a, g = 0.4, 6.5, 2.0, 1.3, 9.81

    def slope(angle, T):
        press = T - rho * speed**2 + rho * g * radius * np.sin(angle)
        return friction * press + rho * radius * (a + g * np.cos(angle))

    done = solve_ivp(slope, (0, 2.8), [500.0], rtol=1e-12, atol=1e-9)
    ratio, offset = crane.capstan_arc(friction, 2.8, radius, rho, speed, a, g)
    assert ratio * 500 + offset == pytest.approx(done.y[0, -1], rel=1e-10)


def test_slipping_atwood_is_newton_and_the_capstan():
    a, T1, T2 = crane.slipping_atwood(80.0, 130.0, 0.12)
    assert T2 / T1 == pytest.approx(np.exp(0.12 * np.pi))
    assert (T1 - 80 * 9.81, 130 * 9.81 - T2) == (pytest.approx(80 * a), pytest.approx(130 * a))
    assert crane.slipping_atwood(80.0, 130.0, 0.0)[0] == pytest.approx(crane.atwood(80.0, 130.0)[0])


def test_machine_with_friction_slips_over_a_locked_sheave_as_the_closed_form_says():
    machine = FrictionAtwood(80.0, 130.0, 0.12)
    motion = machine.simulate([0.0, 0.7])
    a, T1, T2 = crane.slipping_atwood(80.0, 130.0, 0.12)
    assert [motion.x[1], motion.v[1], motion.T1[1], motion.T2[1]] == pytest.approx([a * 0.245, a * 0.7, T1, T2])
    assert machine.energy(motion) + motion.heat == pytest.approx(np.full(2, 0.0), abs=1e-9)
    assert not motion.events


def test_machine_below_the_capstan_ratio_stays_and_comes_to_rest():
    machine = FrictionAtwood(100.0, 130.0, 0.12)
    assert np.all(machine.simulate([0.0, 1.0]).x == 0)
    motion = machine.simulate([0.0, 3.0], v0=1.0)
    a = crane.slipping_atwood(100.0, 130.0, 0.12)[0]
    assert motion.events == [(pytest.approx(-1 / a), 0)]
    assert (motion.v[1], motion.x[1]) == (0, pytest.approx(-0.5 / a))


@pytest.mark.parametrize("mirrored", [False, True])
def test_free_sheave_slips_then_sticks(mirrored):
    args = (80.0, 100.0, 20.0, 0.5, 0.1)
    time, speed, heat = crane.slip_of_free_sheave(*args, 3.0)
    sign = -1 if mirrored else 1
    machine = FrictionAtwood(*((100.0, 80.0) if mirrored else (80.0, 100.0)), 0.1, 20.0, 0.5)
    motion = machine.simulate([0.0, time, time + 1], v0=sign * 3.0)
    assert motion.events == [(pytest.approx(time, rel=1e-11), 0)]
    assert sign * motion.v[1:] == pytest.approx([speed, speed + crane.atwood(80.0, 100.0, 20.0, 0.5)[0]])
    assert motion.w[1:] == pytest.approx(motion.v[1:])
    assert motion.heat[1:] == pytest.approx([heat, heat])


def test_heavy_rope_sticks_then_slips_when_its_tensions_reach_the_ratio():
    machine = FrictionAtwood(300.0, 305.0, 0.03, 80.0, 0.4, 6.0, 30.0)
    times = np.linspace(0, 7, 29)
    motion = machine.simulate(times, x0=2.0)
    closed = {"mass_1": 300.0, "mass_2": 305.0, "mass_per_length": 6.0, "length": 30.0, "inertia": 80.0, "radius": 0.4}

    def spare(time):
        now = crane.heavy_atwood(time, **closed, x0=2.0)
        ratio, offset = crane.capstan_arc(0.03, np.pi, 0.4, 6.0, now.v, now.a)
        return ratio * now.tension_1 + offset - now.tension_2

    first = brentq(spare, 0.1, 7, xtol=1e-14)
    assert motion.events == [(pytest.approx(first, rel=1e-10), 1)]
    stuck = times < first
    assert motion.x[stuck] == pytest.approx(crane.heavy_atwood(times[stuck], **closed, x0=2.0).x, rel=1e-10)
    assert motion.v[-1] > motion.w[-1] + 0.01
    total = machine.energy(motion) + motion.heat
    assert total == pytest.approx(np.full(29, total[0]), abs=1e-8)


def test_sheave_faster_than_the_rope_drives_it_and_the_heat_is_what_is_lost():
    machine = FrictionAtwood(300.0, 305.0, 0.03, 80.0, 0.4, 6.0, 30.0)
    motion = machine.simulate(np.linspace(0, 7, 9), v0=0.2, w0=2.5)
    assert motion.slip[0] == -1
    assert [slip for _, slip in motion.events] == [0, 1]
    total = machine.energy(motion) + motion.heat
    assert total == pytest.approx(np.full(9, total[0]), rel=1e-11)


# blocks
@pytest.mark.parametrize("count", [1, 2, 3, 16])
@pytest.mark.parametrize("hoisting", [True, False])
def test_falls_carry_the_load_and_lose_power_at_each_sheave(count, hoisting):
    eta, load = 0.98, 8e5
    block = crane.falls(count, load, eta, hoisting)
    assert block.tensions.sum() == pytest.approx(load)
    sides = np.concatenate([[block.lead], block.tensions])
    assert sides[1:] / sides[:-1] == pytest.approx(np.full(count, eta if hoisting else 1 / eta))
    # power: the block moves at 1, rope passes the sheave before fall i (from 0) at count - i
    speeds = count - np.arange(count)
    lost = np.sum((sides[:-1] - sides[1:]) * speeds)
    assert block.lead * count == pytest.approx(load + lost)
    assert block.efficiency == pytest.approx(load / (block.lead * count) if hoisting else block.lead * count / load)
    if hoisting:
        assert block.efficiency == pytest.approx(eta * (1 - eta**count) / (count * (1 - eta)))


def test_falls_without_losses():
    block = crane.falls(4, 1000.0)
    assert [block.lead, block.advantage, block.efficiency, block.speed_ratio] == pytest.approx([250, 4, 1, 4])


@pytest.mark.parametrize("wrap", [np.pi, np.pi / 2, 0.3])
def test_bearing_friction_balances_the_sheave(wrap):
    eta = crane.bearing_efficiency(0.1, 0.06, 0.4, wrap)
    resultant = np.hypot(1 / eta - np.cos(wrap), np.sin(wrap))
    assert (1 / eta - 1) * 0.4 == pytest.approx(0.1 * 0.06 * resultant, rel=1e-12)
    if wrap == np.pi:
        assert eta == pytest.approx((0.4 - 0.006) / (0.4 + 0.006))


# axial vibration
def test_stretch_and_tangent_stiffness_are_those_of_greens_law():
    def tension(stretch):
        return 8e7 * stretch * (stretch**2 - 1) / 2

    stretch = crane.stretch_under(np.array([0.0, 49050.0, 1e6]), 8e7)
    assert tension(stretch) == pytest.approx([0, 49050, 1e6], abs=1e-7)
    slope = (tension(stretch + 1e-6) - tension(stretch - 1e-6)) / 2e-6
    assert crane.tangent_stiffness(stretch, 8e7) == pytest.approx(slope, rel=1e-8)


def test_bounce_is_the_slope_of_the_blocks_force():
    n, EA, L, M = 4, 8e7, 120.0, 2e4

    def force(y):
        return n * EA * (1 + n * y / L) * ((1 + n * y / L) ** 2 - 1) / 2

    rest = brentq(lambda y: force(y) - M * 9.81, 0, 1, xtol=1e-15)
    slope = (force(rest + 1e-5) - force(rest - 1e-5)) / 2e-5
    assert crane.bounce_frequency(n, EA, L, M, 9.81) == pytest.approx(np.sqrt(slope / M) / (2 * np.pi), rel=1e-8)
    assert crane.bounce_frequency(n, EA, L, M) == pytest.approx(n / (2 * np.pi) * np.sqrt(EA / (L * M)))


def test_bar_with_end_mass_lies_between_its_limits():
    EA, rho, L = 8e7, 6.5, 25.0
    quarter = np.sqrt(EA / rho) / (4 * L)
    assert crane.bar_frequencies(EA, rho, L, 1e-6) == pytest.approx(quarter * np.array([1, 3, 5, 7]), rel=1e-6)
    # Rayleigh: a third of the bar moves with the mass, to second order in rho L/M
    heavy = crane.bar_frequencies(EA, rho, L, 5000.0)
    assert heavy[0] == pytest.approx(crane.bounce_frequency(1, EA, L, 5000.0 + rho * L / 3), rel=2e-5)
    assert heavy[1:] == pytest.approx(2 * quarter * np.array([1, 2, 3]), rel=4e-3)


# the elevator
EQUAL = Elevator(length_2=20.0)
UNEQUAL = Elevator(mass_1=900.0, mass_2=1000.0)


def test_frequencies_of_the_symmetric_elevator_are_the_closed_form():
    k = EQUAL.stiffnesses[0]
    closed = elevator.symmetric_frequencies(1000.0, k, 200.0, 12.0, 0.35, 2e6)
    assert EQUAL.frequencies()[1:] == pytest.approx(np.sort(closed), rel=1e-10)
    assert EQUAL.frequencies()[0] < 1e-5


@pytest.mark.parametrize("lift", [EQUAL, UNEQUAL, Elevator(mass_1=300.0, length_1=3.0)])
def test_frequencies_of_the_elevator_are_the_roots_of_the_cubic(lift):
    args = (lift.mass_1, lift.mass_2, *lift.stiffnesses, lift.sheave_mass, lift.inertia, lift.radius, lift.roof)
    assert lift.frequencies()[1:] == pytest.approx(elevator.spring_frequencies(*args), rel=1e-9)


def test_stiff_ropes_and_free_sheave_are_limits():
    stiff = replace(UNEQUAL, axial_stiffness=1e13)
    closed = elevator.stiff_rope_frequency(900.0, 1000.0, 200.0, 12.0, 0.35, 2e6)
    assert stiff.frequencies()[1] == pytest.approx(closed, rel=1e-4)
    bare = replace(UNEQUAL, inertia=1e-7)
    series = 1 / np.sum(1 / bare.stiffnesses)
    closed = elevator.frictionless_frequencies(900.0, 1000.0, series, 200.0, 2e6)
    assert bare.frequencies()[1:3] == pytest.approx(closed, rel=1e-6)


def test_release_is_the_sum_of_its_modes():
    offset, times = np.array([0.01, -0.02, 0.003, 0.0]), np.linspace(0, 3, 31)
    mass, stiffness = EQUAL.matrices()
    scale = 1 / np.sqrt(mass)
    squares, vectors = np.linalg.eigh(scale[:, None] * stiffness * scale)
    parts = vectors.T @ (offset / scale)
    omega = np.sqrt(np.maximum(squares, 0))
    modal = np.array([scale * (vectors @ (parts * np.cos(omega * t))) for t in times])
    assert EQUAL.released(times, offset) == pytest.approx(modal, abs=1e-9)


def test_finite_motion_keeps_its_energy_and_is_the_linear_one_when_small():
    offset, times = np.array([1e-4, -5e-5, 2e-5, 0.0]), np.linspace(0, 2, 41)
    finite = EQUAL.finite(times, offset)
    assert finite.energy == pytest.approx(np.full(41, finite.energy[0]), abs=1e-6)
    assert finite.q == pytest.approx(EQUAL.released(times, offset), abs=2e-7)


def test_unequal_masses_run_away_with_atwoods_acceleration():
    stiff, times = replace(UNEQUAL, axial_stiffness=2e8, roof=1e9), np.array([0.0, 0.5, 1.0])
    a = crane.atwood(900.0, 1000.0, 12.0, 0.35)[0]
    for travel in (stiff.released(times, np.zeros(4))[:, 3], stiff.finite(times, np.zeros(4)).q[:, 3]):
        assert travel == pytest.approx(a * times**2 / 2, abs=2e-4)
