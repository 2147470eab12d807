"""Moving cables against closed forms, conservation laws and symmetries (tests/references/cables.py).

Figures in comments are what was measured; tolerances leave a factor of about two to four above them.
"""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, PINNED, chain, element, model_of, node, straight, turned
from references.cables import elastic_pendulum, sliding_rope, table_rope
from scipy.special import ellipk

from tautline.integrators.linearise import evaluate, start_moving
from tautline.integrators.state import new_state
from tautline.kernels.matrix import new_matrix
from tautline.simulation import simulate

ENERGIES = ("kinetic_energy", "strain_energy", "potential_energy", "external_work", "dissipated_energy")


def energies(result):
    """Kinetic, strain and potential energy, work and loss, each (time,)."""
    return [np.asarray(result[name]) for name in ENERGIES]


def imbalance(result):
    """Largest energy that is not accounted for at any frame, over what went through; written down here once more."""
    kinetic, strain, potential, work, lost = energies(result)
    missing = kinetic + strain + potential - work + lost
    through = np.abs(np.diff(work)).sum() + lost[-1] + np.ptp(kinetic) + np.ptp(strain) + np.ptp(potential)
    return np.abs(missing - missing[0]).max() / through


def order(method, steps, run):
    """Observed order of convergence from three runs at halved steps; ``run`` gives the state at the end."""
    coarse, middle, fine = (run(method, h) for h in steps)
    first, second = np.abs(coarse - middle).max(), np.abs(middle - fine).max()
    return np.log2(first / second)


# a rope slides through fixed points
def incline(angle, stretch, EA, held_slope, n=1, **solver):
    """A rope at `angle` below the horizontal through fixed ends a metre apart; all p follow that of the first node."""
    along = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    p = np.linspace(0, 1 / stretch, n + 1)
    held = {i: (0, 0, 0, *held_slope, 0) for i in range(n + 1)} | {i: (1, 1, 1, *held_slope, 0) for i in (0, n)}
    items = chain(straight(0 * along, along, n), p, held, slopes=np.tile(stretch * along, (n + 1, 1)), EA=EA)
    for i in range(1, n + 1):
        masters = "masters: [{mNode: 0, mDof: 7, factor: 1}]"
        items += f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {float(p[i])!r}, {masters}}}\n"
    return model_of(items, **solver)


@pytest.mark.parametrize("stretch", [1.0, 1.1])
@pytest.mark.parametrize("angle", [np.pi / 6, 1.2])
@pytest.mark.parametrize("n", [1, 3])
def test_rope_on_an_incline_begins_to_slide_with_g_sin_alpha(n, angle, stretch):
    # r'' of the material is -r' p'': p'' = -g sin(alpha)/stretch, the tension of both
    # ends being the same. Measured 4e-15 to 6e-11
    model = incline(angle, stretch, 1e5, (0, 0, 0), n, type="Newmark")
    state = new_state(model.system)
    start_moving(model.system, state, 1e-3)
    pdd = state.full_a[: 7 * (n + 1)].reshape(-1, 7)[:, 6]  # a constant stands after the nodes, for the couplings
    np.testing.assert_allclose(pdd, -GRAVITY * np.sin(angle) / stretch, rtol=1e-6)


def test_straight_rope_slides_down_an_incline_as_newton_says():
    # slopes held: it cannot sag. Measured 3e-15
    result = simulate(incline(np.pi / 6, 1.0, 1e5, (1, 1, 1), type="Newmark", time_step=1e-2, time_end=0.5))
    travel = -np.asarray(result["material_coordinate"])[:, 0]
    np.testing.assert_allclose(travel, sliding_rope(result["time"], np.pi / 6, GRAVITY), rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.asarray(result["material_coordinate"])[:, 1] + travel, 1.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize(("EA", "limit"), [(1e5, 1e-2), (1e7, 1e-3)])
def test_rope_that_may_sag_slides_down_an_incline_within_one_per_cent(EA, limit):
    # the sag swings and stretches the rope, which takes energy from the sliding: measured 5.2e-3 and 4.4e-4
    result = simulate(incline(np.pi / 6, 1.0, EA, (0, 0, 0), type="Newmark", time_step=1e-3, time_end=0.5))
    travel = -np.asarray(result["material_coordinate"])[:, 0]
    exact = sliding_rope(result["time"], np.pi / 6, GRAVITY)
    assert travel[-1] == pytest.approx(exact[-1], rel=limit)
    assert imbalance(result) < 2e-5  # what flows in above and out below counts as external work


def table(EA, tie, h, length=2.0, overhang=0.5):
    """A rope on a smooth table, level along x, of which a part hangs over the edge at the origin."""
    level = length - overhang
    tail, edge = (0, 1, 1, 0, 1, 1, 1), (1, 1, 1, 0, 1, 1, 0)
    below, tip = (1, 1, 1, 1, 1, 0, 0), (1, 1, 0, 1, 1, 0, 1)
    items = node(0, [-level, 0, 0], [1, 0, 0], tail, 0.0) + node(1, [0, 0, 0], [1, 0, 0], edge, level)
    items += node(2, [0, 0, 0], [0, 0, -1], below, level) + node(3, [0, 0, -overhang], [0, 0, -1], tip, length)
    items += element(0, 0, 1, EA=EA, strain="engineering") + element(1, 2, 3, EA=EA, strain="engineering")
    if tie == "coupling":
        items += "  - LinearCoupl: {id: 0, sNode: 2, sDof: 7, f0: 0, masters: [{mNode: 1, mDof: 7, factor: 1}]}\n"
    else:
        items += "  - LagMultipl7: {id: 0, nodes7: [1, 2], constr: 1}\n"
    return simulate(model_of(items, type="G-alpha", rho_inf=0.8, time_step=h, time_end=0.6))


@pytest.mark.parametrize("tie", ["coupling", "multiplier"])
@pytest.mark.parametrize(("EA", "limit"), [(1e4, 1.5e-3), (1e6, 1.5e-5)])
def test_rope_slides_off_a_table_by_the_hyperbolic_cosine(EA, limit, tie):
    # both ends of the rope are fixed to it, only p at the edge moves on. The reference is inextensible: measured
    # 5.0e-4 at weight/EA = 2e-3 and 4.5e-6 at 2e-5
    result = table(EA, tie, 1e-3)
    exact = table_rope(np.asarray(result["time"]), 0.5, 2.0, GRAVITY)
    tip, p = -np.asarray(result["position"])[:, 3, 2], np.asarray(result["material_coordinate"])
    assert np.abs(tip - exact).max() < limit * exact[-1]
    assert np.abs(2.0 - p[:, 1] - exact).max() < limit * exact[-1]
    np.testing.assert_allclose(p[:, 1], p[:, 2], rtol=0, atol=1e-9)
    assert imbalance(result) < 5e-6


# a rope over a fixed eyelet
def eyelet(EJ, method, h, end, EA=2e3, damping=0.0, n=(2, 2), reverse=False, mirror=False, **solver):
    """A rope from a fixed end through an eyelet at the origin, where p is free, to an end that swings and hoists."""
    inward, outward = np.array([0.9, 0.1, 0.2]), np.array([np.sin(0.6), 0.2, -np.cos(0.6)])
    inward, outward = inward / np.linalg.norm(inward), outward / np.linalg.norm(outward)
    if mirror:
        inward, outward = inward * [-1, 1, 1], outward * [-1, 1, 1]
    p = np.concatenate([np.linspace(0, 1, n[0] + 1), np.linspace(1, 2, n[1] + 1)[1:]])
    xyz = np.where(p[:, None] < 1, np.outer(p - 1, inward), np.outer(p - 1, outward))
    slopes = np.array([inward if x < 1 else outward for x in p])
    slopes[n[0]] = (inward + outward) / np.linalg.norm(inward + outward)
    held = {0: PINNED, n[0]: (1, 1, 1, 0, 0, 0, 0)}
    items = chain(xyz, p, held, slopes, reverse=reverse, EA=EA, EJ=EJ, damping=damping)
    return simulate(model_of(items, type=method, time_step=h, time_end=end, **solver))


@pytest.mark.parametrize(("EJ", "end"), [(0.0, 0.2), (1.0, 0.1)])
def test_rope_over_an_eyelet_keeps_its_energy(EJ, end):
    # RK4's own loss falls with h^5: measured 1.2e-10 and 9.3e-10 of the energy exchanged at 2.5e-5 s. (2.48) as
    # printed, without the jump of bending energy at the eyelet, is off by 2 % at any step (docs/cables.md)
    result = eyelet(EJ, "RK4", 2.5e-5, end, plotpoints=100)
    kinetic, strain, potential, work, lost = energies(result)
    exchanged = max(np.ptp(kinetic), np.ptp(strain), np.ptp(potential))
    total = kinetic + strain + potential
    assert np.abs(total - total[0]).max() < 1e-8 * exchanged
    assert exchanged > 1.0
    assert np.abs(work).max() == 0.0, "nothing comes in: both ends are the rope's own"
    assert np.abs(lost).max() == 0.0
    assert np.ptp(np.asarray(result["material_coordinate"])[:, 2]) > 0.02, "rope does go through the eyelet"


@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_damped_rope_over_an_eyelet_balances_its_energy(EJ):
    # measured 1.2e-5 and 9.5e-6: losses count at the middle of a step, to second order
    result = eyelet(EJ, "RK4", 5e-5, 0.2, damping=1e-3, plotpoints=100)
    assert result.attributes["energy_error"] < 2e-5
    assert imbalance(result) < 2e-5
    assert np.asarray(result["dissipated_energy"])[-1] > 1.0


@pytest.mark.parametrize("method", ["RK4", "G-alpha"])
@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_mirror_image_moves_as_the_mirror_image(EJ, method):
    given = dict(EJ=EJ, method=method, h=1e-4, end=0.1, damping=1e-3, plotpoints=100)
    one, other = eyelet(**given), eyelet(**given, mirror=True)
    moved = np.asarray(one["position"])
    assert np.ptp(moved[:, -1], axis=0).max() > 0.03
    np.testing.assert_allclose(np.asarray(other["position"]), moved * [-1, 1, 1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(other["material_coordinate"], one["material_coordinate"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ["RK4", "G-alpha"])
@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_direction_of_p_does_not_matter(EJ, method):
    # measured 6e-16 with RK4; with generalized-alpha what the iterations leave
    given = dict(EJ=EJ, method=method, h=1e-4, end=0.1, damping=1e-3, plotpoints=100, eps_energy=1e-14)
    one, other = eyelet(**given), eyelet(**given, reverse=True)
    np.testing.assert_allclose(other["position"], one["position"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        np.asarray(other["material_coordinate"]), -np.asarray(one["material_coordinate"]), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(other["axial_force"], one["axial_force"], rtol=0, atol=1e-8)


# a winch
def winch(method, h, EJ, at_first=False, damping=2e-3, end=0.4, rate=-20.0, over=10.0, **solver):
    """A slack span of 2 m between supports that is hauled in at one end, faster and faster."""
    n, length = 3, 2.0
    p = np.linspace(0, length, n + 1)
    xyz = np.stack([0.98 * p, 0.05 * np.sin(np.pi * p / length), -0.1 * np.sin(np.pi * p / length)], 1)
    functions = {0 if at_first else n: (0, 0, 0, 0, 0, 0, 1)}
    items = chain(xyz, p, {0: PINNED, n: PINNED}, functions=functions, EA=2e3, EJ=EJ, damping=damping)
    start, rate = (0.0, -rate) if at_first else (length, rate)
    items += (
        f"  - Function_VelocityDefined: {{id: 1, pos0: {start}, timeList: [0, {over}], velocityList: [0, {rate}]}}\n"
    )
    return simulate(model_of(items, type=method, time_step=h, time_end=end, massDamp=0.5, plotpoints=50, **solver))


@pytest.mark.parametrize(("method", "h"), [("RK4", 2e-4), ("Newmark", 1.25e-4)])
@pytest.mark.parametrize("EJ", [0.0, 0.5])
@pytest.mark.parametrize("at_first", [False, True])
def test_winch_balances_its_energy(at_first, EJ, method, h):
    # energy of material that leaves at the winch, stress on it and both dampings: measured 1.9e-7 and 1.1e-7 (RK4),
    # 3.2e-7 and 3.9e-7 (Newmark)
    result = winch(method, h, EJ, at_first)
    assert result.attributes["energy_error"] < 1e-6
    assert imbalance(result) < 1e-6
    _, strain, _, work, lost = energies(result)
    assert work[-1] > 10.0
    assert lost[-1] > 0.5
    assert strain[-1] > 5.0
    p = np.asarray(result["material_coordinate"])
    hauled = np.abs(p[-1, [0, -1]] - p[0, [0, -1]]).max()
    assert hauled == pytest.approx(0.4**2, rel=1e-9), "rate -2 t, integrated"


def test_imbalance_of_a_winch_falls_with_the_square_of_the_step():
    # nothing is left out: what is missing is the rule by which power is summed; measured 2.00
    errors = [winch("RK4", h, 0.5).attributes["energy_error"] for h in (4e-4, 2e-4, 1e-4)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)


# rigid motion
def forces(model, q, v):
    """Full residual at positions q and velocities v (nodes, 7) with no acceleration; loads apart, all forces."""
    system = model.system
    state = new_state(system)
    state.q[:], state.v[:] = q.ravel()[system.free], v.ravel()[system.free]
    state.full_v[:] = v.ravel()
    matrix = new_matrix(system.size, system.bandwidth, system.border)
    evaluate(system, state, 0.0, 1e-3, False, 1.0, 0.0, 0.0, matrix, np.zeros(system.size))
    return state.residual.reshape(-1, 7).copy()


def floating(bent, damping=0.1):
    """A free rope of three elements, straight and unstressed or bent and stretched."""
    p = np.linspace(0, 2, 4)
    xyz = np.outer(p, [2 / 3, -1 / 3, 2 / 3]) + bent * np.outer(np.sin(p), [0.2, 0.4, 0.0])
    return model_of(chain(xyz, p, {}, EA=1e4, EJ=3.0, damping=damping), gravity=(0, 0, 0))


@pytest.mark.parametrize("bent", [0, 1])
def test_rigid_motion_meets_no_damping(bent):
    # measured 1e-12 N of 800 N
    model = floating(bent)
    q = model.system.q.reshape(-1, 7).copy()
    v = np.zeros_like(q)
    still = forces(model, q, v)
    v[:, :3] = np.cross([0.3, -1.0, 2.0], q[:, :3]) + [1.0, 2.0, 3.0]
    v[:, 3:6] = np.cross([0.3, -1.0, 2.0], q[:, 3:6])
    assert np.abs(forces(model, q, v) - still).max() < 1e-10
    v[:, 3:6] *= 1.01
    if bent:
        assert np.abs(forces(model, q, v) - still).max() > 1e-2, "what is not rigid is damped"
    else:
        assert np.abs(still).max() < 1e-10, "and a straight rope has no force at all"


@pytest.mark.parametrize("bent", [0, 1])
def test_forces_turn_with_the_rope(bent):
    model = floating(bent)
    q = model.system.q.reshape(-1, 7).copy()
    turn = turned(1.0, axis=0) @ turned(0.7, axis=2)
    moved = q.copy()
    moved[:, :3] = q[:, :3] @ turn.T + [1.0, 2.0, 3.0]
    moved[:, 3:6] = q[:, 3:6] @ turn.T
    one, other = forces(model, q, 0 * q), forces(model, moved, 0 * q)
    for part in (slice(0, 3), slice(3, 6)):
        np.testing.assert_allclose(other[:, part], one[:, part] @ turn.T, rtol=0, atol=1e-9)


def test_mesh_that_moves_along_a_resting_rope_meets_no_damping():
    # dp = c, dr = c r', dr' = c r'' at the two ends of one bent element: no particle moves (docs/cables.md).
    # Measured 4e-14 N; the same motion of the nodes with p at rest is damped by 300 N
    xyz, p = np.array([[0.0, 0, 0], [0.9, 0.3, 0.1]]), np.array([0.0, 1.0])
    slopes = np.array([[1.0, 0.1, 0.2], [0.7, 0.8, -0.1]])
    chord = xyz[1] - xyz[0]
    turn = np.array([6 * chord - 4 * slopes[0] - 2 * slopes[1], -6 * chord + 2 * slopes[0] + 4 * slopes[1]])
    v = np.zeros((2, 7))
    for i, rate in enumerate((0.7, -0.4)):
        v[i] = rate * np.concatenate([slopes[i], turn[i], [1.0]])

    def damped(rates):
        both = []
        for damping in (0.0, 0.1):
            functions = {i: (0, 0, 0, 0, 0, 0, i + 1) for i in range(2)}
            items = chain(xyz, p, {}, slopes, functions=functions, EA=1e3, EJ=2.0, damping=damping)
            for i, rate in enumerate(rates):
                items += f"  - Function_VelocityDefined: {{id: {i + 1}, pos0: {p[i]}, timeList: [0, 1], "
                items += f"velocityList: [{rate}, {rate}]}}\n"
            model = model_of(items, gravity=(0, 0, 0))
            both.append(forces(model, model.system.q.reshape(-1, 7), v))
        return np.abs(both[1] - both[0]).max()

    assert damped((0.7, -0.4)) < 1e-10
    assert damped((0.0, 0.0)) > 1.0


@pytest.mark.parametrize("method", ["G-alpha", "Newmark", "RK4"])
def test_unstretched_rope_falls_freely_without_force(method):
    # measured 5e-15 m after a fall of 4.9 m, 1.2e-11 N
    n = 3
    p = np.linspace(0, 2, n + 1)
    items = chain(np.outer(p, [2 / 3, -1 / 3, 2 / 3]), p, {}, EA=1e4, EJ=3.0, damping=1e-3)
    result = simulate(model_of(items, type=method, time_step=1e-3, time_end=1.0, plotpoints=20))
    position, time = np.asarray(result["position"]), np.asarray(result["time"])
    exact = position[0] - GRAVITY / 2 * time[:, None, None] ** 2 * np.array([0, 0, 1])
    np.testing.assert_allclose(position, exact, rtol=0, atol=1e-12)
    assert np.abs(result["axial_force"]).max() < 1e-9
    assert np.asarray(result["dissipated_energy"]).max() < 1e-20


@pytest.mark.parametrize("method", ["G-alpha", "RK4"])
def test_straight_rope_that_is_thrown_flies_on_and_spins_without_loss(method):
    # along its axis it is thrown, and damping has nothing to act on; spun slowly, the stretch by the spin is tiny and
    # its loss is of the fourth order in the rate of spin: measured 3.3e-8 and 5.3e-7 J of 14 J
    p = np.linspace(0, 2, 4)
    along = np.array([2 / 3, -1 / 3, 2 / 3])
    lost = {}
    for spin in (0.0, 0.2, 0.4):
        items = chain(np.outer(p - 1, along), p, {}, EA=1e4, EJ=3.0, damping=1e-3)
        model = model_of(items, type=method, time_step=2e-4, time_end=0.2, plotpoints=10, gravity=(0, 0, 0))
        v = model.system.v.reshape(-1, 7)
        v[:, :3] = [1.0, 2.0, 3.0] + np.cross([0, spin, spin / 2], np.outer(p - 1, along))
        v[:, 3:6] = np.cross([0, spin, spin / 2], along)
        result = simulate(model)
        lost[spin] = float(result["dissipated_energy"][-1])
        middle = np.asarray(result["position"]).mean(axis=1)
        np.testing.assert_allclose(middle, np.outer(result["time"], [1.0, 2.0, 3.0]), rtol=0, atol=1e-12)
    assert lost[0.0] < 1e-20
    assert lost[0.4] < 2e-6
    assert lost[0.4] / lost[0.2] == pytest.approx(16.0, rel=0.1)


# pendulums
def pendulum(EA, mass, angle, stretch, h, end, method="RK4", strain="green", **solver):
    """A bob on one linear element, let go at an angle from the plumb line."""
    bob = stretch * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    items = chain(np.array([0 * bob, bob]), np.array([0.0, 1.0]), {0: PINNED}, linear=True, EA=EA, strain=strain)
    items += f"  - PointMass: {{id: 0, nodes4: [1], mass: {mass}}}\n"
    return simulate(model_of(items, type=method, time_step=h, time_end=end, **solver))


@pytest.mark.parametrize("strain", ["green", "engineering"])
def test_linear_element_with_a_bob_is_the_elastic_pendulum(strain):
    # the same ordinary differential equation: measured 7.8e-11 and 5.0e-11 m at 1e-3 s
    result = pendulum(200.0, 2.0, 1.0, 1.05, 1e-3, 2.0, strain=strain, plotpoints=50)
    exact = elastic_pendulum(np.asarray(result["time"]), 1.0, 200.0, 2.0, 1.0, GRAVITY, 1.0, 1.05, strain)
    assert np.abs(np.asarray(result["position"])[:, 1, [0, 2]].T - exact).max() < 1e-8
    assert np.ptp(exact[1]) > 0.4


def test_stiff_pendulum_returns_after_the_period_of_the_elliptic_integral():
    # T = 4 sqrt(I/(W L)) K(sin(angle/2)), I = (m + rhoA L/3) L^2, W = (m + rhoA L/2) g; from 1.5 rad. Measured 2.7e-6
    angle, mass = 1.5, 2.0
    period = 4 * np.sqrt((mass + 1 / 3) / (mass + 1 / 2) / GRAVITY) * ellipk(np.sin(angle / 2) ** 2)
    result = pendulum(1e6, mass, angle, 1.0, period / 2000, period, "G-alpha", plotpoints=8 / period)
    position = np.asarray(result["position"])[:, 1]
    np.testing.assert_allclose(position[-1], position[0], rtol=0, atol=1e-5)
    np.testing.assert_allclose(position[4], position[0] * [-1, 1, 1], rtol=0, atol=1e-5)
    np.testing.assert_allclose(position[[2, 6]], [[0, 0, -1]] * 2, rtol=0, atol=1e-3)  # fast there, and stretched


# order of the methods
def swing(EJ, damping):
    """A rope hung at one end that swings down in space; the runs end in its positions at 0.5 s."""
    p = np.linspace(0, 1, 4)
    xyz = np.stack([0.9 * p, 0.1 * p, -0.3 * p * np.sin(np.pi * p / 2)], 1)
    items = chain(xyz, p, {0: PINNED}, EA=200.0, EJ=EJ, damping=damping)

    def run(method, h):
        result = simulate(model_of(items, type=method, time_step=h, time_end=0.5, eps_energy=1e-12, plotpoints=2))
        return np.asarray(result["position"])[-1]

    return run


def through_the_eyelet(method, h):
    result = eyelet(0.0, method, h, 0.25, EA=500.0, damping=1e-3, n=(1, 2), eps_energy=1e-12, plotpoints=4)
    return np.append(np.asarray(result["position"])[-1].ravel(), np.asarray(result["material_coordinate"])[-1])


SWINGS = {"damped rope": swing(0.0, 1e-3), "bending rope": swing(0.05, 0.0), "rope over an eyelet": through_the_eyelet}


@pytest.mark.parametrize("method", ["G-alpha", "Newmark"])
@pytest.mark.parametrize("case", SWINGS)
def test_implicit_methods_are_of_second_order(case, method):
    # measured 2.00, 2.06, 2.00 (generalized-alpha) and 2.00, 2.10, 2.00 (Newmark)
    assert order(method, (2**-10, 2**-11, 2**-12), SWINGS[case]) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("case", SWINGS)
def test_runge_kutta_is_of_fourth_order(case):
    # measured 4.07, 3.89, 3.96
    finest = 15 if case == "rope over an eyelet" else 13
    assert order("RK4", (2.0 ** (2 - finest), 2.0 ** (1 - finest), 2.0**-finest), SWINGS[case]) == pytest.approx(
        4.0, abs=0.2
    )


def test_all_methods_agree_on_the_motion_of_a_cable():
    # measured 5.4e-6 and 5.1e-6 m at 2^-12 s, the error of second order
    ends = [SWINGS["damped rope"](method, 2**-12) for method in ("RK4", "G-alpha", "Newmark")]
    assert np.abs(ends[1] - ends[0]).max() < 1.5e-5
    assert np.abs(ends[2] - ends[0]).max() < 1.5e-5
