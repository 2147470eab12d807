"""Waves as bodies find them: the water's motion, and tangent and powers of what it does to a body with a height.

References: Airy's formulas, written with hyperbolic functions; differences; the work of the forces.
"""

from functools import cache

import numpy as np
import pytest
from cranes.groups.test_bodies_at_the_surface import BOTTOM, HEIGHT, SURFACE, group
from cranes.hooks import Hooks

from crane.groups.current import new_current
from crane.groups.waves import ACCELERATION, VELOCITY, look, new_sea, stir
from tautline.kernels.jit import in_python
from tautline.system.waves import Waves, wave_number

WAY = np.array([np.cos(0.7), np.sin(0.7)])
TIME = 31.7


def waves(depth=np.inf, ramp=0.0, size=1.0):
    frequency = np.array([0.55, 0.8, 1.3])
    number = wave_number(frequency, depth)
    origin = np.array([3.0, -2.0])
    return Waves(
        size * np.array([0.8, 0.5, 0.2]), frequency, np.array([0.3, 2.0, 4.4]), number, WAY, origin, ramp, depth
    )


def moves(made, t, x, y, deep):
    sea = new_sea(made)
    with in_python():
        found = look(sea, t, x, y)
        stir(sea, t, found[0], deep)
    return found, sea.moves.copy()


def airy(made, t, x, y, z):
    """Elevation, and velocity (3,) at z below the level, of waves that are grown."""
    s = (np.array([x, y]) - made.origin) @ made.direction
    theta = made.frequency * t + made.phase - made.number * s
    d = min(made.depth, 400.0)
    along = made.amplitude * made.frequency * np.cosh(made.number * (d + z)) / np.sinh(made.number * d)
    up = made.amplitude * made.frequency * np.sinh(made.number * (d + z)) / np.sinh(made.number * d)
    horizontal = (along * np.sin(theta)).sum() * made.direction
    return (made.amplitude * np.sin(theta)).sum(), np.array([*horizontal, (up * np.cos(theta)).sum()])


@pytest.mark.parametrize("depth", [np.inf, 40.0, 9.0])
@pytest.mark.parametrize("z", [-0.01, -4.0, -8.5])
def test_water_moves_as_airy_says_where_wheeler_has_stretched_it_from(depth, z):
    made = waves(depth)
    eta, velocity = airy(made, TIME, 5.0, 1.0, z)
    deep = -z * (1.0 + eta / depth)
    found, (u, a) = moves(made, TIME, 5.0, 1.0, deep)
    assert found[0] == pytest.approx(eta, abs=1e-12)
    assert u == pytest.approx(velocity, rel=1e-6, abs=1e-9)
    later, sooner = (airy(made, TIME + h, 5.0, 1.0, z)[1] for h in (1e-4, -1e-4))
    assert a == pytest.approx((later - sooner) / 2e-4, rel=1e-5, abs=1e-7)
    east = [airy(made, TIME, 5.0 + h * WAY[0], 1.0 + h * WAY[1], z)[0] for h in (1e-4, -1e-4)]
    assert found[2] == pytest.approx((east[0] - east[1]) / 2e-4, rel=1e-6)


def test_water_at_the_surface_rises_with_it_and_that_on_the_sea_bed_stays_on_it():
    made = waves(9.0)
    found, (u, _) = moves(made, TIME, 5.0, 1.0, 0.0)
    assert u[2] == pytest.approx(found[1], rel=1e-12)
    _, (u, a) = moves(made, TIME, 5.0, 1.0, 9.0 + found[0])
    assert u[2] == pytest.approx(0.0, abs=1e-12) and a[2] == pytest.approx(0.0, abs=1e-12) and abs(u[0]) > 0.01


@pytest.mark.parametrize("t", [0.0, 3.0, 19.0, 25.0])
def test_while_waves_grow_the_acceleration_is_the_rate_of_the_velocity_and_the_rate_that_of_the_surface(t):
    made, h = waves(ramp=20.0), 1e-4
    (eta, rate, _), (u, a) = moves(made, t, 5.0, 1.0, 2.0)
    later, sooner = (moves(made, t + by, 5.0, 1.0, 2.0) for by in (h, -h))
    assert rate == pytest.approx((later[0][0] - sooner[0][0]) / (2 * h), rel=1e-6, abs=1e-8)
    assert a == pytest.approx((later[1][VELOCITY] - sooner[1][VELOCITY]) / (2 * h), rel=1e-5, abs=1e-7)
    assert eta == pytest.approx(made.elevation(5.0, 1.0, t), abs=1e-12)
    if t == 0.0:
        assert not u.any() and not moves(made, t, 5.0, 1.0, 2.0)[1][ACCELERATION].any()


@cache
def hooks(depth=np.inf, ramp=0.0, size=1.0, shear=False):
    """A body in waves, which a current that changes with depth may go with."""
    made = group(waves=waves(depth, ramp, size))
    if shear:
        made = made._replace(current=new_current([0.0, 0.7, 15.0], [[1.2, 0.3], [0.5, -0.4], [-0.1, 0.1]], SURFACE))
    return Hooks((made,), 3, [np.arange(3)])


LOWEST = {"half": -1.0, "nearly in": -1.99, "just in": -2.01, "deep": -12.0}


def state(lowest, rising, **sea):
    """Positions by how high the lowest point is above the surface as it is, and relative to it in or out."""
    q, v, a = np.random.default_rng(3).normal(size=(3, 3))
    (eta, _, _), (u, _) = moves(waves(**sea), TIME, q[0], q[1], 0.0)
    q[2], v[2] = SURFACE + eta + lowest + BOTTOM, u[2] + (0.9 if rising else -0.9)
    return q, v, a


@pytest.mark.parametrize("rising", [True, False], ids=["out", "in"])
@pytest.mark.parametrize("lowest", LOWEST.values(), ids=LOWEST)
def test_what_waves_put_in_is_what_is_stored_and_lost(lowest, rising):
    assert hooks().imbalance(*state(lowest, rising), 1e-4, TIME) < 2e-6
    assert hooks(ramp=40.0).imbalance(*state(lowest, rising), 1e-4, TIME) < 2e-6


def test_a_body_that_moves_with_the_water_loses_nothing():
    q, v, _ = state(LOWEST["deep"], rising=True)
    deep = -LOWEST["deep"] - 0.5 * HEIGHT
    v[:] = moves(waves(), TIME, q[0], q[1], deep)[1][VELOCITY]
    assert hooks().powers(q, v, TIME)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("rising", [True, False], ids=["out", "in"])
@pytest.mark.parametrize("weights", [(1, 0, 0), (0, 1, 0), (0, 0, 1)], ids=["mass", "damping", "stiffness"])
@pytest.mark.parametrize("lowest", LOWEST.values(), ids=LOWEST)
@pytest.mark.parametrize(
    "sea", [{}, {"ramp": 40.0}, {"depth": 9.0}, {"size": 3.0, "depth": 14.0}, {"shear": True}], ids=str
)
def test_the_tangent_is_the_residuals_difference(sea, lowest, weights, rising):
    """How the water's motion changes with place is in it, over any depth and while waves grow."""
    wave = {key: value for key, value in sea.items() if key != "shear"}
    assert hooks(**sea).tangent_error(*state(lowest, rising, **wave), *weights, h=1e-5, t=TIME) < 1e-6


def test_small_waves_leave_the_stiffness_that_of_still_water():
    small = Hooks((group(waves=waves(size=1e-4)),), 3, [np.arange(3)])
    q, v, a = np.random.default_rng(3).normal(size=(3, 3))
    q[2] = SURFACE - 1.0 + BOTTOM
    assert small.tangent_error(q, v, a, 0, 0, 1, h=1e-5, t=TIME) < 1e-4
