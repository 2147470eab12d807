"""Rope in water: buoyancy, drag across it, added mass."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from cranes.hooks import Hooks, run
from scipy.integrate import quad

from crane.geometry.line import POINT, WHEEL
from crane.groups.hydrodynamics import WET, new_wet
from crane.groups.span import SPAN, new_spans
from tautline.elements.nodal.node import SPRING, PointMasses, Springs
from tautline.results.assessment.balance import ENERGIES

DENSITY, GRAVITY = 1025.0, 9.81
DIAMETER, DRAG, ADDED = 0.05, 1.2, 0.9
SECTION = 0.25 * np.pi * DIAMETER**2
ONE_BY_ONE = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
HEIGHTS = {
    "below": (-3.0, -2.0),
    "piercing": (-1.0, 0.7),
    "piercing, drawn down": (0.8, -0.3),
    "a tip": (0.02, 1.0),
    "nearly level at the surface": (0.004, -0.012),
    "level at the surface": (0.01, 0.01),
    "level and just wet": (-0.024, -0.024),
    "across the edge": (-0.02, 0.02),
    "above": (1.0, 2.0),
}
WET_ONES = {name: z for name, z in HEIGHTS.items() if name != "above"}


def group(diameter=DIAMETER, drag=DRAG, added=ADDED, surface=0.0):
    rows = np.zeros(1, WET).view(np.recarray)
    rows[0] = (0, 4, diameter, DENSITY, drag, added)
    return new_wet(rows, surface, (0.0, 0.0, -GRAVITY))


@cache
def hooks(**options):
    return Hooks((group(**options),), 8, [np.arange(8)])


def state(heights, seed=0):
    """Stations some metres apart with 3 m of rope between them, that move anyhow."""
    q, v, a = np.random.default_rng(seed).normal(size=(3, 8))
    q[4] += 3.0
    q[2], q[6] = heights
    q[3], q[7] = 10.0, 13.0
    return q, v, a


def at(a, b, pa=0.0, pb=1.0):
    """Stations in full vectors."""
    return np.array([*a, pa, *b, pb], dtype=float)


@pytest.mark.parametrize("weights", ONE_BY_ONE, ids=["mass", "damping", "stiffness"])
@pytest.mark.parametrize("heights", WET_ONES.values(), ids=WET_ONES)
def test_the_tangent_is_the_residuals_difference(heights, weights):
    h = 2e-5 if weights[2] else 1e-3
    assert hooks().tangent_error(*state(heights), *weights, h=h) < 1e-8


@pytest.mark.parametrize("heights", WET_ONES.values(), ids=WET_ONES)
@pytest.mark.parametrize("options", [{}, {"added": 0.0}, {"drag": 0.0}], ids=["all", "no added mass", "no drag"])
def test_power_is_what_is_stored_and_lost(heights, options):
    assert hooks(**options).imbalance(*state(heights), 1e-4) < 1e-7


@pytest.mark.parametrize("heights", HEIGHTS.values(), ids=HEIGHTS)
def test_the_mass_is_what_accelerations_meet(heights):
    q, v, a = state(heights)
    assert np.allclose(hooks().mass(q), hooks().tangent(q, v, a, 1, 0, 0), rtol=0, atol=1e-14)


def test_rope_in_the_air_is_let_be():
    q, v, a = state(HEIGHTS["above"])
    assert not np.any(hooks().residual(q, v, a))
    assert not np.any(hooks().tangent(q, v, a, 1, 1, 1))
    assert not np.any(hooks().energies(q, v)) and hooks().powers(q, v) == (0.0, 0.0)


def test_rope_without_coefficients_has_buoyancy_only():
    q, v, a = state(HEIGHTS["piercing"])
    bare = hooks(drag=0.0, added=0.0)
    assert np.array_equal(bare.residual(q, v, a), bare.residual(q, 0 * v, 0 * a))
    assert not np.any(bare.mass(q)) and bare.powers(q, v) == (0.0, 0.0)


def share(depth, diameter=DIAMETER):
    x = np.clip(2.0 * depth / diameter, -1.0, 1.0)
    return 0.25 * (2.0 + 3.0 * x - x**3)


@pytest.mark.parametrize("heights", HEIGHTS.values(), ids=HEIGHTS)
def test_what_is_under_water_is_lifted_by_the_water_it_displaces(heights):
    q, v, a = state(heights)
    r = hooks(drag=0.0, added=0.0).residual(q, v, a)

    def depth(xi):
        return -(1.0 - xi) * heights[0] - xi * heights[1]

    edges = [0.0, 1.0]
    if heights[0] != heights[1]:
        edges += [(z - heights[0]) / (heights[1] - heights[0]) for z in (-0.5 * DIAMETER, 0.5 * DIAMETER)]
    edges = np.unique(np.clip(edges, 0.0, 1.0))
    for station, shape in ((0, lambda xi: 1.0 - xi), (4, lambda xi: xi)):
        part = sum(quad(lambda xi, n=shape: n(xi) * share(depth(xi)), *e)[0] for e in pairwise(edges))
        assert -r[station + 2] == pytest.approx(3.0 * DENSITY * SECTION * GRAVITY * part, rel=1e-10, abs=1e-12)
    assert not np.any(r[[0, 1, 4, 5]])
    # what holds p is the rate of the potential with L
    assert r[7] == -r[3] == pytest.approx(hooks().energies(q, v)[2] / 3.0)


def test_buoyancy_of_a_chord_that_pierces_the_surface_is_the_sharp_ones_but_for_the_diameter():
    q, _, _ = state((-1.0, 0.7))
    sharp = 3.0 * DENSITY * SECTION * GRAVITY * 1.0**2 / (2.0 * 1.7)
    assert hooks().energies(q, 0 * q)[2] == pytest.approx(sharp, rel=(0.5 * DIAMETER) ** 2 / 5.0)


def test_a_level_rope_at_the_surface_is_half_lifted_and_a_thin_one_too():
    for diameter in (DIAMETER, 1e-3):
        q = at((0, 0, 2.0), (3, 0, 2.0), 0.0, 3.0)
        lift = -hooks(diameter=diameter, surface=2.0).residual(q, 0 * q, 0 * q)
        expected = 0.5 * 3.0 * DENSITY * 0.25 * np.pi * diameter**2 * GRAVITY
        assert lift[2] + lift[6] == pytest.approx(expected)


def test_the_force_is_smooth_where_rope_gets_wet():
    """Neither it nor its tangent jumps, through edges of share and for chords that become level."""
    for tilt in (0.0, 1e-9, 1e-3, 0.2):
        heights = np.linspace(-0.3, 0.3, 1201)
        lifts = []
        for z in heights:
            q = at((0, 0, z), (3, 0, z + tilt), 0.0, 3.0)
            lifts.append(hooks().residual(q, at((1, 2, 3), (2, 1, 0.5), 0.1, 0.2), 0 * q))
        bends = np.abs(np.diff(lifts, 2, axis=0)).max(axis=0)
        size = np.ptp(lifts, axis=0)
        # of a share that goes from 0 to 1 with the cubic law over 100 of these steps
        assert np.all(bends <= 1.2e-3 * size + 1e-9)


def test_rope_as_heavy_as_water_has_no_weight_at_its_stations_nor_in_its_material():
    rows = np.zeros(1, SPAN).view(np.recarray)
    rows[0] = (0, 4, POINT, POINT, 1.0, DENSITY * SECTION, 0.0, (0, 0, -GRAVITY * DENSITY * SECTION), 1, 0, 0, 0)
    spans = new_spans(rows, np.zeros(0, WHEEL).view(np.recarray))
    both = Hooks((spans, group()), 8, [np.arange(8)])
    q = at((0, 0, -3.0), (1, 0, -2.5), 0.0, 3.0)
    assert both.residual(q, 0 * q, 0 * q) == pytest.approx(0.0, abs=1e-12)
    assert both.energies(q, 0 * q).sum() == pytest.approx(0.0, abs=1e-12)


def test_drag_of_rope_that_swings_about_its_end():
    """0.5 rho Cd d (w s)^2 across the rope; that along it is nothing, however fast it slides."""
    q, spin, length = at((0, 0, -1), (3, 0, -5), 0.0, 5.0), 2.0, 5.0
    v = at((0, 0, 0), (spin * 4, 0, spin * 3), -7.0, 4.0)
    v[[0, 2, 4, 6]] += np.array([0.6, -0.8, 0.6, -0.8]) * 11.0
    r = hooks(added=0.0).residual(q, v, 0 * q)
    r[[2, 6]] -= hooks(added=0.0).residual(q, 0 * q, 0 * q)[[2, 6]]
    across, along = np.array([0.8, 0.0, 0.6]), np.array([0.6, 0.0, -0.8])
    force = 0.5 * DENSITY * DRAG * DIAMETER * spin**2 * length**3
    assert (r[:3] + r[4:7]) @ across == pytest.approx(force / 3.0, rel=1e-5)
    assert r[4:7] @ across * length == pytest.approx(force * length / 4.0, rel=1e-5)
    assert r[:3] @ along == pytest.approx(0.0, abs=1e-9) and r[4:7] @ along == pytest.approx(0.0, abs=1e-9)
    assert hooks().powers(q, v)[0] == pytest.approx(force * spin * length / 4.0, rel=1e-5)


def test_drag_acts_where_the_water_is():
    q = at((0, 0, 1.0), (0, 0, -3.0), 0.0, 4.0)
    v = at((2, 0, 0), (2, 0, 0), 0.0, 0.0)
    r = hooks(added=0.0).residual(q, v, 0 * q)
    force = 0.5 * DENSITY * DRAG * DIAMETER * 2.0**2 * 3.0
    assert r[0] + r[4] == pytest.approx(force, rel=1e-6)
    assert 4.0 * r[4] / (r[0] + r[4]) == pytest.approx(1.0 + 1.5, rel=1e-4)


def test_the_water_does_not_notice_rope_or_stations_that_move_along_a_line_which_turns():
    spin, slip = 1.3, 2.0
    across, along = np.array([0.8, 0.0, 0.6]), np.array([0.6, 0.0, -0.8])
    made = []
    for speed in (0.0, slip):
        q, v, a = np.zeros((3, 8))
        for place, s in ((0, 2.0), (4, 6.0)):
            q[place : place + 3] = s * along - [0, 0, 3.0]
            v[place : place + 3] = s * spin * across + speed * along
            a[place : place + 3] = -s * spin**2 * along + 2.0 * speed * spin * across
            q[place + 3], v[place + 3] = s, -3.0 * speed
        made.append(hooks(drag=0.0).residual(q, v, a) - hooks(drag=0.0).residual(q, 0 * v, 0 * a))
    assert made[1] == pytest.approx(made[0], abs=1e-10)
    assert made[0] == pytest.approx(0.0, abs=1e-10)


def test_level_rope_sinks_as_the_closed_form_says():
    """(m + rho Ca A L) v. = W - c v^2: v = v_t tanh(t / tau), and the ledger closes."""
    length, mass = 4.0, 30.0
    rope = group()
    masses = PointMasses(np.array([0, 4]), np.full(2, 0.5 * mass), 0.0, np.array([0.0, 0.0, -GRAVITY]))
    q = at((0, 0, -1), (length, 0, -1), 0.0, length)
    displaced = DENSITY * SECTION * length
    weight, drag = (mass - displaced) * GRAVITY, 0.5 * DENSITY * DRAG * DIAMETER * length
    result = run(
        (masses, rope), q, 0 * q, [np.arange(8)], (3, 7), step=1e-3, end=1.5, interval=0.01, scale=300.0
    )  # fmt: skip
    terminal = np.sqrt(weight / drag)
    tau = (mass + ADDED * displaced) / np.sqrt(weight * drag)
    time = np.array(result["time"])
    assert -np.array(result["v"])[:, 2] == pytest.approx(terminal * np.tanh(time / tau), abs=1e-5)
    assert result.attributes["energy_error"] < 1e-6


def test_a_rope_that_falls_into_the_water_closes_its_ledger():
    masses = PointMasses(np.array([0, 4]), np.array([20.0, 30.0]), 0.0, np.array([0.0, 0.0, -GRAVITY]))
    rows = np.zeros(1, SPRING).view(np.recarray)
    rows[0] = (0, 4, 1e5, 0.0, 3.0)
    spring = Springs(rows, np.zeros((6, 6)))
    q = at((0, 0, 3.0), (2.0, 1.0, 1.0), 0.0, 3.0)
    v = at((1.0, 0.0, 0.0), (0.0, 2.0, -1.0), 0.0, 0.0)
    errors = []
    for step in (2e-3, 1e-3):
        result = run(
            (spring, masses, group()), q, v, [np.arange(8)], (3, 7), step=step, end=2.0, interval=0.01, scale=500.0
        )  # fmt: skip
        assert np.array(result["q"])[-1, 2] < -1.0
        assert np.array(result["dissipated_energy"])[-1] > 10.0
        kinetic, strain, potential, work, lost = (np.array(result[name]) for name in ENERGIES)
        gained = kinetic + strain + potential + lost - work
        assert np.abs(work).max() > 1.0
        errors.append(np.abs(gained - gained[0]).max() / np.ptp(potential))
    assert errors[0] < 1e-5 and errors[0] > 3.0 * errors[1]
