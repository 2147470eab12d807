"""Bodies that turn by a quaternion without constraint, and sockets on them."""

from functools import cache

import numpy as np
import pytest
from cranes.hooks import Hooks, run
from scipy.integrate import solve_ivp
from scipy.linalg import eig
from scipy.spatial.transform import Rotation

from crane.geometry.quaternion import quaternion_of, rotation_of
from crane.groups.rigid import FREQUENCY, RIGID, new_rigids
from crane.groups.sockets import SOCKET, new_sockets
from crane.sea.frames import Frame, motion_of
from tautline.elements.nodal.node import SPRING, PointMasses, Springs

ONE_BY_ONE = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
INERTIA = (2.0, 3.0, 4.0)
GRAVITY = 9.81


def rows_of(kind, *rows):
    made = np.zeros(len(rows), kind).view(np.recarray)
    made[:] = list(rows)
    return made


def rigids(place=0, turn=3, inertia=INERTIA, frequency=FREQUENCY):
    return new_rigids(rows_of(RIGID, (place, turn, inertia, inertia, np.inf, frequency)))


def sockets(offset, stiffness, damping=0.0, arm=0, turn=3):
    return new_sockets(rows_of(SOCKET, (arm, turn, offset, stiffness, damping)))


@cache
def top(inertia=INERTIA, frequency=FREQUENCY):
    return Hooks((rigids(turn=0, inertia=inertia, frequency=frequency),), 4, [np.arange(4)])


@cache
def socket(damping=0.4):
    return Hooks((sockets((0.3, -0.2, 0.5), 7.0, damping),), 7, [np.arange(7)])


def rotation(q):
    return Rotation.from_quat(np.roll(q, -1)).as_matrix()


def rate_of(quaternion, spin):
    """Rate of a quaternion, of a body that turns at `spin` in its own axes."""
    s, v = quaternion[0], quaternion[1:]
    return 0.5 * np.append(-v @ spin, s * np.asarray(spin) + np.cross(v, spin))


def spin_of(quaternion, rate):
    """Angular velocity in the body's axes, for quaternions of any length."""
    s, v, sd, vd = quaternion[0], quaternion[1:], rate[0], rate[1:]
    return 2.0 * (s * vd - sd * v - np.cross(v, vd)) / (quaternion @ quaternion)


@pytest.mark.parametrize("weights", ONE_BY_ONE, ids=["mass", "damping", "stiffness"])
@pytest.mark.parametrize("norm", [1.0, 0.8, 1.3])
def test_the_tangent_of_a_body_is_its_residuals_difference(norm, weights):
    q, v, a = np.random.default_rng(1).normal(size=(3, 4))
    q *= norm / np.linalg.norm(q)
    assert top().tangent_error(q, v, a, *weights, h=1e-3) < 1e-9


@pytest.mark.parametrize("weights", ONE_BY_ONE[1:], ids=["damping", "stiffness"])
@pytest.mark.parametrize("seed", range(3))
def test_the_tangent_of_a_socket_is_its_residuals_difference(seed, weights):
    q, v, a = np.random.default_rng(seed).normal(size=(3, 7))
    assert socket().tangent_error(q, v, a, *weights, h=1e-3) < 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_power_is_what_is_stored_and_lost(seed):
    for hooks in (top(), socket(), socket(0.0)):
        q, v, a = np.random.default_rng(seed).normal(size=(3, hooks.system.size))
        assert hooks.imbalance(q, v, a, 1e-3) < 1e-8


def test_the_mass_matrix_is_regular_and_that_of_accelerations():
    q = np.random.default_rng(2).normal(size=4)
    mass = top().mass(q)
    assert np.allclose(mass, top().tangent(q, np.zeros(4), np.zeros(4), 1, 0, 0), rtol=0, atol=1e-13)
    unit = q / np.linalg.norm(q)
    assert np.linalg.eigvalsh(top().mass(unit)) == pytest.approx([8.0, 12.0, 12.0, 16.0])


def test_the_energy_is_that_of_the_spin():
    q = quaternion_of((0.3, -0.8, 1.9))
    spin = np.array([1.0, -2.0, 0.5])
    kinetic, strain, potential = top().energies(q, rate_of(q, spin))
    assert kinetic == pytest.approx(0.5 * spin @ (INERTIA * spin))
    assert (abs(strain), potential) == (pytest.approx(0.0, abs=1e-25), 0.0)


def motion(hooks, q, v, times):
    """Quaternions and their rates (m, 4) of a free motion, by DOP853."""
    n = q.size

    def slope(t, y):
        return np.append(y[n:], hooks.acceleration(y[:n].copy(), y[n:].copy()))

    found = solve_ivp(slope, (0, times[-1]), np.append(q, v), "DOP853", times, rtol=1e-11, atol=1e-12)
    return np.split(np.ascontiguousarray(found.y.T), [n], axis=1)


def test_a_free_body_turns_as_eulers_equations_say():
    # About the middle axis: it tumbles. So fast that DOP853, which follows the norm's own frequency, has few steps.
    spin, q = np.array([4.8, 32.0, 3.2]), quaternion_of((0.4, 0.2, -1.0))
    times, inertia = np.linspace(0.0, 0.625, 6), np.array(INERTIA)
    found, rates = motion(top(), q, rate_of(q, spin), times)

    def euler(t, y):
        turn = Rotation.from_quat(y[:4])
        return np.append(
            np.roll(rate_of(np.roll(turn.as_quat(), 1), y[4:]), -1), np.cross(inertia * y[4:], y[4:]) / inertia
        )

    start = np.append(np.roll(q, -1), spin)
    exact = solve_ivp(euler, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13).y.T
    momentum = rotation(q) @ (inertia * spin)
    for made, rate, y in zip(found, rates, exact, strict=True):
        now = spin_of(made, rate)
        assert np.abs(rotation(made) - Rotation.from_quat(y[:4]).as_matrix()).max() < 1e-8
        assert np.abs(now - y[4:]).max() < 1e-8
        assert rotation(made) @ (inertia * now) == pytest.approx(momentum, abs=1e-8)
        assert top().energies(made, rate)[:2].sum() == pytest.approx(0.5 * spin @ (inertia * spin), rel=1e-9)
    assert np.abs((found**2).sum(axis=1) - 1.0).max() < 1e-9


def test_a_symmetric_top_precesses_as_the_closed_form_says():
    across, along = 5.0, 2.0
    spin, q = np.array([11.2, 0.0, 48.0]), quaternion_of((1.0, 0.5, 0.2))
    times = np.linspace(0.0, 0.5, 5)
    found, _ = motion(top((across, across, along)), q, rate_of(q, spin), times)
    momentum = rotation(q) @ (np.array([across, across, along]) * spin)
    for t, made in zip(times, found, strict=True):
        own = Rotation.from_rotvec([0.0, 0.0, spin[2] * (1.0 - along / across) * t]).as_matrix()
        precession = Rotation.from_rotvec(momentum / across * t).as_matrix()
        assert np.abs(rotation(made) - precession @ rotation(q) @ own).max() < 1e-8


def test_no_rotation_depends_on_the_norm():
    """Neither on where it starts, nor on how it swings; the norm swings at its own frequency."""
    spin, q = np.array([0.3, 2.0, 0.2]), quaternion_of((0.4, 0.2, -1.0))
    # half a swing of the slower norm
    times, v = np.linspace(0.0, 0.5, 7), rate_of(quaternion_of((0.4, 0.2, -1.0)), spin)
    plain, _ = motion(top(INERTIA, 7.0), q, v, times)
    for frequency in (50.0, 7.0):
        size = np.sqrt(1.2)
        # a rate along the quaternion itself is no rotation
        found, _ = motion(top(INERTIA, frequency), size * q, size * (v + 0.5 * q), times)
        assert np.abs(rotation_of(found) - rotation_of(plain)).max() < 1e-8
        swing = 0.2 * np.cos(frequency * times) + 1.2 / frequency * np.sin(frequency * times)
        assert (found**2).sum(axis=1) - 1.0 == pytest.approx(swing, abs=1e-7)


def test_the_integrator_keeps_energy_and_momentum_of_a_tumbling_body_to_second_order():
    spin, q = np.array([0.3, 2.0, 0.2]), quaternion_of((0.4, 0.2, -1.0))
    inertia = np.array(INERTIA)
    momentum = rotation(q) @ (inertia * spin)
    drifts = []
    for step in (4e-3, 2e-3):
        result = run(
            (rigids(turn=0),), q, rate_of(q, spin), [np.arange(4)], step=step, end=20.0, interval=0.1, scale=10.0
        )  # fmt: skip
        q_s, v_s = np.array(result["q"]), np.array(result["v"])
        now = [rotation(a) @ (inertia * spin_of(a, b)) for a, b in zip(q_s, v_s, strict=True)]
        drifts.append(np.abs(np.array(now) - momentum).max() / np.linalg.norm(momentum))
        energy = np.array(result["kinetic_energy"]) + np.array(result["strain_energy"])
        assert np.ptp(energy) < 2e-6 * energy[0]
        assert np.abs((q_s**2).sum(axis=1) - 1.0).max() < 1e-8
    assert drifts[0] < 2e-6
    assert drifts[0] / drifts[1] == pytest.approx(4.0, rel=0.2)


def test_roll_pitch_and_yaw_are_those_of_frames():
    angles = (0.4, -0.7, 2.5)
    still = np.zeros((1, 6, 1, 3))
    still[0, 3:, 0, 0] = angles
    entries = motion_of([Frame("turned", -1, (0.0, 0.0, 0.0))], still)[0][0, 0]
    assert rotation_of(quaternion_of(angles)) == pytest.approx(entries[3:].reshape(3, 3).T, abs=1e-15)
    assert rotation_of(3.0 * quaternion_of(angles)) == pytest.approx(rotation(quaternion_of(angles)), abs=1e-15)


def test_a_socket_pulls_a_point_of_the_body_with_force_and_moment():
    rng = np.random.default_rng(3)
    q, v = rng.normal(size=(2, 7))
    offset, (stiffness, damping) = np.array([0.3, -0.2, 0.5]), (7.0, 0.4)
    turn, spin = rotation(q[3:]), spin_of(q[3:], v[3:])
    gap = q[:3] - turn @ offset
    rate = v[:3] - turn @ np.cross(spin, offset)
    pull = stiffness * gap + damping * rate
    r = socket().residual(q, v, np.zeros(7))
    assert r[:3] == pytest.approx(pull)
    moment = np.cross(offset, turn.T @ pull)
    wobble = rng.normal(size=4)
    # virtual work; along the quaternion itself there is none
    assert -r[3:] @ wobble == pytest.approx(moment @ spin_of(q[3:], wobble))
    assert r[3:] @ q[3:] == pytest.approx(0.0, abs=1e-13)
    assert socket().energies(q, v)[1] == pytest.approx(0.5 * stiffness * gap @ gap)
    assert socket().powers(q, v) == pytest.approx((damping * rate @ rate, 0.0))


MASS, ARM = 800.0, np.array([0.2, -0.1, 1.1])
MOMENTS = (300.0, 420.0, 180.0)


def hanging(stiffness=1e10):
    """A body that a socket holds by a point at the origin, in equilibrium: its centre below the point.

    The arm is the way from the centre to the origin: it has the body's mass, and the weight pulls it up.
    """
    q = np.zeros(7)
    turn, _ = Rotation.align_vectors([[0, 0, 1.0]], [ARM / np.linalg.norm(ARM)])
    q[3:] = np.roll(turn.as_quat(), 1)
    q[:3] = turn.as_matrix() @ ARM + [0.0, 0.0, MASS * GRAVITY / stiffness]
    weights = PointMasses(np.array([0]), np.array([MASS]), 0.0, np.array([0.0, 0.0, GRAVITY]))
    return (weights, rigids(0, 3, MOMENTS), sockets(ARM, stiffness)), q


def frequencies(groups, q, stencils, free, ends=()):
    """Angular frequencies about an equilibrium of the degrees of freedom that are free; `ends` go with others."""
    hooks, zero = Hooks(groups, q.size, stencils), np.zeros(q.size)
    share = np.eye(q.size)
    for end, masters in dict(ends).items():
        for master, factor in masters:
            share[end, master] = factor
    share = share[:, free]
    assert np.abs(share.T @ hooks.residual(q, zero, zero)).max() < 1e-6 * MASS * GRAVITY
    mass, stiffness = hooks.mass(q), hooks.tangent(q, zero, zero, 0, 0, 1)
    inverse = eig(share.T @ mass @ share, share.T @ stiffness @ share, right=False)
    return np.sort(1.0 / np.sqrt(inverse[inverse.real > 1e-9].real))


def test_a_body_on_a_fixed_point_swings_as_a_compound_pendulum():
    groups, q = hanging()
    found = frequencies(groups, q, [np.arange(7)], np.arange(7))
    turn, arm = rotation(q[3:]), np.linalg.norm(ARM)
    about = turn @ np.diag(MOMENTS) @ turn.T + MASS * arm**2 * np.diag([1, 1, 0])
    # nothing holds it against turning about the plumb line
    across = about[:2, :2] - np.outer(about[:2, 2], about[2, :2]) / about[2, 2]
    expected = np.sqrt(MASS * GRAVITY * arm / np.linalg.eigvalsh(across)[::-1])
    swings = found[(found > 1.0) & (found < 10.0)]
    assert swings == pytest.approx(expected, rel=1e-5)


def test_a_body_on_a_rope_swings_as_a_double_pendulum():
    length, arm = 4.0, np.array([0.0, 0.0, 1.1])
    spring = Springs(rows_of(SPRING, (13, 0, 1e10, 0.0, length)), np.zeros((6, 6)))
    weights = PointMasses(np.array([3]), np.array([MASS]), 0.0, np.array([0.0, 0.0, -GRAVITY]))
    groups = weights, rigids(3, 9, MOMENTS), sockets(arm, 1e10, arm=6, turn=9), spring
    q, sag = np.zeros(16), MASS * GRAVITY / 1e10
    q[2], q[5], q[8], q[9] = -length - sag, -length - arm[2] - 2.0 * sag, arm[2] + sag, 1.0
    # The rope's end is at the arm from the centre.
    ends = {c: [(3 + c, 1.0), (6 + c, 1.0)] for c in range(3)}
    found = frequencies(groups, q, [np.arange(16)], np.arange(3, 13), ends)
    swings = found[(found > 0.5) & (found < 30.0)]
    expected = []
    for moment in MOMENTS[:2]:
        mass = MASS * np.outer([length, arm[2]], [length, arm[2]]) + np.diag([0.0, moment])
        expected += list(np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, MASS * GRAVITY * np.diag([length, arm[2]])))))
    assert swings == pytest.approx(np.sort(expected), rel=1e-5)


def test_a_pendulum_on_a_socket_keeps_its_energy_over_a_long_run():
    """Far from plumb and spinning: it goes round in space."""
    drifts = []
    for step in (4e-3, 2e-3):
        groups, q = hanging(stiffness=1e7)
        turn = Rotation.from_euler("x", 70, degrees=True)
        q[3:] = np.roll((turn * Rotation.from_quat(np.roll(q[3:], -1))).as_quat(), 1)
        q[:3] = turn.apply(q[:3])
        v, spin = np.zeros(7), np.array([0.3, 1.0, 2.0])
        v[3:] = rate_of(q[3:], spin)
        v[:3] = rotation(q[3:]) @ np.cross(spin, ARM)
        result = run(groups, q, v, [np.arange(7)], step=step, end=60.0, interval=0.05, scale=MASS * GRAVITY)
        kinetic = np.array(result["kinetic_energy"])
        total = kinetic + np.array(result["strain_energy"]) + np.array(result["potential_energy"])
        drifts.append(np.abs(total - total[0]).max() / kinetic.max())
        gap = np.array(result["q"])[:, :3] - np.array([rotation(x) @ ARM for x in np.array(result["q"])[:, 3:]])
        assert np.abs(gap).max() < 0.05
    assert drifts[0] < 2e-4 and drifts[0] > 3.0 * drifts[1]
