"""Self-tests of the pendulums on a rope of changing length: Bessel functions, geometry, balances."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv, yv

from references import pendulum
from references.pendulum import fixed, hoisted, planar, slewing, spherical

ORIGIN = fixed(0, 0, 0)


@pytest.mark.parametrize("speed", [-1.5, 2.0])
def test_small_swing_at_constant_speed_is_bessels(speed):
    """l th'' + 2 v th' + g th = 0 with l = l0 + v t: th = [A J_1(z) + B Y_1(z)]/z, z = 2 sqrt(g l)/|v|."""
    times, g = np.linspace(0, 10, 51), 9.81
    swing = planar(times, lambda t: (20 + speed * t, speed, 0.0), 1e-5)
    z = 2 * np.sqrt(g * (20 + speed * times)) / abs(speed)
    # d(J_1/z)/dz = -J_2/z
    A, B = np.linalg.solve([[jv(1, z[0]) / z[0], yv(1, z[0]) / z[0]], [jv(2, z[0]), yv(2, z[0])]], [1e-5, 0])
    assert swing.angle == pytest.approx((A * jv(1, z) + B * yv(1, z)) / z, abs=1e-13)


@pytest.mark.parametrize("radius", [0.0, 0.4])
def test_payload_hangs_on_the_tangent_and_is_pulled_along_it(radius):
    """Tangent and free length from the position alone; Newton's law by differences of the positions."""
    length, h = hoisted(12.0, -2.0, 1.0), 1e-3
    times = np.arange(0, 5 + h / 2, h)
    swing = planar(times, length, 0.9, 0.3, radius)
    x = np.array([swing.x, swing.z])
    free = np.sqrt(np.sum(x * x, 0) - radius**2)
    assert free == pytest.approx(swing.free, rel=1e-11)
    bearing = np.unwrap(np.arctan2(swing.z, swing.x)) + np.arctan2(free, radius)  # of the point of contact
    along = (x - radius * np.array([np.cos(bearing), np.sin(bearing)])) / free
    # rope on the sheave past th = 0 and free rope make the length fed
    fed = np.array([length(t)[0] for t in times])
    assert free - radius * bearing == pytest.approx(fed, rel=1e-11)
    pull = (-x[:, 4:] + 16 * x[:, 3:-1] - 30 * x[:, 2:-2] + 16 * x[:, 1:-3] - x[:, :-4]) / (12 * h * h)
    pull[1] += 9.81
    assert pull == pytest.approx(-swing.tension[2:-2] * along[:, 2:-2], abs=1e-6)


def test_power_of_the_winch_is_tension_times_speed():
    length = hoisted(12.0, -2.0, 1.0)
    times = np.linspace(0, 5, 5001)
    swing = planar(times, length, 0.9, 0.3, 0.4)
    speed = np.array([length(t)[1] for t in times])
    energy = (speed**2 + (swing.free * swing.rate) ** 2) / 2 + 9.81 * swing.z
    power = -swing.tension * speed
    work = np.sum((power[1:] + power[:-1]) / 2) * 1e-3 - (np.gradient(power)[-1] - np.gradient(power)[0]) / 12 * 1e-3
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-8)


def test_in_a_plane_the_spherical_pendulum_is_the_planar_one():
    times, length = np.linspace(0, 8, 17), hoisted(20.0, -1.5, 2.0)
    flat = planar(times, length, 0.7, 0.2)
    rate = 0.2 * np.array([np.cos(0.7), 0, np.sin(0.7)])
    space = spherical(times, length, [np.sin(0.7), 0, -np.cos(0.7)], rate, ORIGIN)
    assert space.position[:, [0, 2]] == pytest.approx(np.array([flat.x, flat.z]).T, abs=1e-10)
    assert space.tension == pytest.approx(flat.tension, rel=1e-10)


def test_hoisting_keeps_the_moment_of_momentum_about_the_vertical():
    times, length = np.linspace(0, 8, 17), hoisted(20.0, -1.5, 2.0)
    swing = spherical(times, length, [0.3, 0.1, -0.9], [0.05, 0.2, 0.0], ORIGIN)
    moment = np.cross(swing.position, swing.velocity)[:, 2]
    assert moment == pytest.approx(np.full(17, moment[0]), rel=1e-11)
    assert np.linalg.norm(swing.direction, axis=1) == pytest.approx(np.ones(17), abs=1e-11)


def test_payload_of_a_slewing_boom_can_turn_with_it():
    """Steady slewing: tan(th) = w^2 (r + l sin(th))/g outwards, tension m g/cos(th)."""
    r, l, w, g = 8.0, 15.0, 0.4, 9.81
    th = brentq(lambda th: np.tan(th) - w * w * (r + l * np.sin(th)) / g, 0, 1, xtol=1e-15)

    def pivot(t):
        out, along = np.array([np.cos(w * t), np.sin(w * t), 0]), np.array([-np.sin(w * t), np.cos(w * t), 0])
        return r * out, r * w * along, -r * w * w * out

    times = np.linspace(0, 20, 21)
    rate = [0, w * np.sin(th), 0]
    swing = spherical(times, lambda _: (l, 0.0, 0.0), [np.sin(th), 0, -np.cos(th)], rate, pivot, mass=2000.0)
    distance = np.hypot(*swing.position[:, :2].T)
    assert distance == pytest.approx(np.full(21, r + l * np.sin(th)), rel=1e-10)
    assert swing.tension == pytest.approx(np.full(21, 2000 * g / np.cos(th)), rel=1e-10)


def test_slewing_tip_moves_as_its_derivatives_say():
    tip, h = slewing(7.8, 6.0, 0.25, 2.0), 1e-4
    for t in (0.7, 1.9, 5.0):
        before, now, after = (tip(t + k * h) for k in (-1, 0, 1))
        for order in (0, 1):
            assert (after[order] - before[order]) / (2 * h) == pytest.approx(now[order + 1], abs=1e-7)


def test_small_swing_keeps_its_action_while_the_rope_is_hauled_in_slowly():
    """(energy of the swing)/frequency: amplitude as l^(-3/4)."""
    times = np.linspace(0, 300, 12001)
    swing = pendulum.planar(times, lambda t: (20 - 0.06 * t, -0.06, 0.0), 1e-3)
    first, last = np.abs(swing.angle[:400]).max(), np.abs(swing.angle[-400:]).max()
    assert last / first == pytest.approx((20 / 2.1) ** 0.75, rel=0.03)
