"""Bodies with a height in water: tangent, powers and forces of their buoyancy, drag and added mass, and the way in.

References: differences, the work of the forces, Archimedes, and the momentum of body and added mass, which is kept as
the body comes in (von Karman, NACA TN 321, 1929).
"""

from functools import cache

import numpy as np
import pytest
from cranes.hooks import Hooks, run
from scipy.integrate import quad

from crane.groups.current import no_current
from crane.groups.immersion import EDGE, IMMERSED, Immersed, new_scratch, share_of
from crane.groups.waves import new_sea
from tautline.elements.nodal.node import PointMasses
from tautline.results.assessment.balance import ENERGIES

MASS, HEIGHT, BOTTOM, SURFACE = 400.0, 2.0, 0.7, 1.5
BUOYANCY, DISPLACED = 7000.0, 710.0
ADDED, LINEAR, QUADRATIC = (300.0, 250.0, 500.0), (20.0, 30.0, 40.0), (90.0, 80.0, 70.0)
LOWEST = {"dry": 0.3, "touching": 0.005, "half": -1.1, "nearly in": -1.99, "just in": -2.01, "deep": -40.0}
"""How high the lowest point is above the surface, m."""
WET = {name: z for name, z in LOWEST.items() if name != "dry"}


def group(buoyancy=BUOYANCY, added=ADDED, linear=LINEAR, quadratic=QUADRATIC, waves=None):
    rows = np.zeros(1, IMMERSED).view(np.recarray)
    rows[0] = (0, 0, HEIGHT, BOTTOM, buoyancy, DISPLACED, added, linear, quadratic)
    still = np.zeros((1, 2), np.int64), np.zeros((1, 2))
    return Immersed(rows, rows.copy(), SURFACE, *still, new_sea(waves), no_current(), *new_scratch())


@cache
def hooks():
    return Hooks((group(),), 3, [np.arange(3)])


def state(lowest, sinking=True):
    q, v, a = np.random.default_rng(3).normal(size=(3, 3))
    q[2], v[2] = SURFACE + lowest + BOTTOM, -0.8 if sinking else 0.8
    return q, v, a


def share(lowest):
    return share_of.py_func(-lowest / HEIGHT)


@pytest.mark.parametrize("sinking", [True, False], ids=["in", "out"])
@pytest.mark.parametrize("weights", [(1, 0, 0), (0, 1, 0), (0, 0, 1)], ids=["mass", "damping", "stiffness"])
@pytest.mark.parametrize("lowest", WET.values(), ids=WET)
def test_the_tangent_is_the_residuals_difference(lowest, weights, sinking):
    if lowest == LOWEST["deep"] and weights[2]:
        assert not hooks().tangent(*state(lowest, sinking), *weights).any()
    else:
        assert hooks().tangent_error(*state(lowest, sinking), *weights, h=1e-5) < 1e-7


@pytest.mark.parametrize("sinking", [True, False], ids=["in", "out"])
@pytest.mark.parametrize("lowest", WET.values(), ids=WET)
def test_power_is_what_is_stored_and_lost(lowest, sinking):
    assert hooks().imbalance(*state(lowest, sinking), 1e-4) < 1e-6


def test_dry_bodies_are_let_be_and_deep_ones_have_all_of_it():
    q, v, a = state(LOWEST["dry"])
    assert not hooks().residual(q, v, a).any() and not hooks().energies(q, v).any() and not hooks().mass(q).any()
    q, v, a = state(LOWEST["deep"])
    expected = np.array(ADDED) * a + (np.array(LINEAR) + np.array(QUADRATIC) * abs(v)) * v - [0.0, 0.0, BUOYANCY]
    assert np.allclose(hooks().residual(q, v, a), expected, rtol=1e-14)


@pytest.mark.parametrize("lowest", LOWEST.values(), ids=LOWEST)
def test_the_mass_is_what_accelerations_meet(lowest):
    q, v, a = state(lowest)
    assert np.allclose(hooks().mass(q), hooks().tangent(q, v, a, 1, 0, 0), rtol=0, atol=1e-12)


def test_the_share_is_that_of_the_height_under_water():
    for x in (EDGE, 0.25, 0.5, 1.0 - EDGE):
        bend, slope, wet, _ = share_of.py_func(x)
        assert (bend, slope) == (0.0, 1.0) and wet == pytest.approx(x, abs=1e-15)
    for x in np.linspace(-0.05, 1.05, 23):
        # Each is the integral of the one before.
        found = [quad(lambda y, k=k: share_of.py_func(y)[k], -0.1, x, points=_kinks(x))[0] for k in (0, 1, 2)]
        assert found == pytest.approx(share_of.py_func(x)[1:], abs=1e-9)


def _kinks(x):
    edges = [0.5 * EDGE * s + end for end in (0.0, 1.0) for s in (-1.0, 1.0)]
    return [one for one in edges if one < x] or None


def drop(lowest, velocity, end=0.5):
    """A mass without weight that comes to the surface with a speed, and added mass alone: velocities (frames, 3)."""
    q = np.array([0.0, 0.0, SURFACE + lowest + BOTTOM])
    masses = PointMasses(np.array([0]), np.array([MASS]), 0.0, np.zeros(3))
    groups = (masses, group(buoyancy=0.0, linear=(0.0,) * 3, quadratic=(0.0,) * 3))
    result = run(groups, q, np.array(velocity, dtype=float), [np.arange(3)], step=5e-4, end=end, interval=0.01)
    heights = np.array([share(z - BOTTOM - SURFACE)[2] for z in result["q"][:, 2]])
    energy = sum(result[name] for name in ENERGIES)
    return result["v"], heights, energy


def test_body_and_added_mass_keep_their_momentum_on_the_way_in():
    speeds, shares, energy = drop(0.2, (1.0, -2.0, -8.0))
    assert shares[0] == 0.0 and shares[-1] == 1.0
    for c, begin in enumerate((1.0, -2.0, -8.0)):
        assert speeds[:, c] == pytest.approx(MASS * begin / (MASS + shares * ADDED[c]), rel=1e-5)
    assert energy == pytest.approx(energy[0], rel=3e-5)


def test_on_the_way_out_water_stays_behind_and_the_speed_stays():
    speeds, shares, energy = drop(-2.5, (1.0, -2.0, 8.0))
    assert shares[0] == 1.0 and shares[-1] == 0.0
    assert speeds == pytest.approx(np.tile([1.0, -2.0, 8.0], (len(speeds), 1)), abs=1e-9)
    assert energy == pytest.approx(energy[0], rel=3e-5)
