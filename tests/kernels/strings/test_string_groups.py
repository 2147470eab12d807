"""Bodies, links and bends: tangents are differences of residuals, residuals gradients of energies, powers balance."""

import numpy as np
import pytest
from kernels.strings import short_string as string
from kernels.strings.short_string import PER_BODY, PLACES, WELLS, check_tangent, close

from drillstring.well import wellbore

KINDS = {
    "bodies": lambda seats, rng: string.bodies(seats, rng),
    "eccentric bodies": lambda seats, rng: string.bodies(seats, rng, eccentric=True),
    "links": lambda seats, rng: string.links(seats, rng),
    "damped links": lambda seats, rng: string.links(seats, rng, damping=0.3),
    "stiff bends": lambda seats, rng: string.bends(seats, rng),
    "soft bends": lambda seats, rng: string.bends(seats, rng, stiff=False),
}
SEEDS = range(3)


@pytest.fixture(params=[(kind, well, seed) for kind in KINDS for well in WELLS for seed in SEEDS], ids=str)
def case(request):
    """A group of one kind at a random state in one of the wells."""
    kind, well, seed = request.param
    rng = np.random.default_rng([seed, list(WELLS).index(well), list(KINDS).index(kind)])
    state = string.random_state(rng)
    return (KINDS[kind](string.curve(WELLS[well], state), rng),), state


def test_each_part_of_the_tangent_is_the_difference_of_the_residual(case):
    check_tangent(*case)


@pytest.mark.parametrize(("first", "last"), [(0, 3), (5, 6), (7, 9), (12, 16)])
def test_in_a_window_the_residual_and_the_tangents_columns_are_those_of_the_whole(case, first, last):
    groups, state = case
    r, _, parts = string.evaluate(groups, state)
    window = groups[0].curve.window
    window[:] = first, last
    inside, _, narrow = string.evaluate(groups, state)
    assert np.array_equal(inside[first:last], r[first:last])
    assert all(np.array_equal(narrow[name][:, first:last], parts[name][:, first:last]) for name in ("mixed", "damping"))
    # a bend, the longest, reaches two bodies further: nothing is asked for beyond
    if last <= PER_BODY:
        assert not np.any(inside[3 * PER_BODY :])
    if first >= 3 * PER_BODY:
        assert not np.any(inside[:PER_BODY])


def test_the_mass_hook_is_the_tangent_by_acceleration(case):
    parts = string.evaluate(*case)[2]
    assert np.allclose(parts["hook"], parts["mass"], rtol=1e-14, atol=1e-14)
    assert np.array_equal(parts["mass"], parts["mass"].T)
    if np.any(parts["mass"]):
        assert np.linalg.eigvalsh(parts["mass"]).min() > 0.0


def test_the_residual_at_rest_is_the_gradient_of_the_energy(case):
    groups, state = case
    still = state._replace(v=np.zeros_like(state.v), a=np.zeros_like(state.a))
    gradient = string.derivative(lambda q: string.energy(groups, still._replace(q=q))[1:].sum(), still.q)
    assert close(string.residual(groups, still), gradient)


def test_power_of_the_residual_is_the_energys_rate_and_what_is_lost(case):
    groups, state = case
    power = string.rate(
        lambda h: string.energy(groups, state._replace(q=state.q + h * state.v, v=state.v + h * state.a)).sum()
    )
    lost, driven = string.losses(groups, state)
    assert string.residual(groups, state) @ state.v == pytest.approx(power + lost, rel=1e-7, abs=1e-8)
    assert lost >= 0.0 == driven


@pytest.mark.parametrize("well", WELLS)
def test_eccentric_bodies_with_no_eccentricity_are_bodies(well):
    rng = np.random.default_rng(1)
    state = string.random_state(rng)
    seats = string.curve(WELLS[well], state)
    plain = string.bodies(seats, rng)
    eccentric = string.EccentricBodies(*plain)
    for one, other in zip(string.evaluate((plain,), state)[:2], string.evaluate((eccentric,), state)[:2], strict=True):
        assert np.allclose(one, other, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("well", ["vertical", "inclined"])
def test_in_a_straight_hole_a_link_is_the_chord_in_space(well):
    rng = np.random.default_rng(2)
    state = string.random_state(rng)
    group = string.links(string.curve(WELLS[well], state), rng)
    x, u, v, theta = state.q.reshape(-1, PER_BODY).T
    points = WELLS[well].point(PLACES + x, u, v)
    stretch = np.linalg.norm(np.diff(points, axis=0), axis=1) - np.diff(PLACES)
    strain = 0.5 * group.springs.axial @ stretch**2 + 0.5 * group.springs.torsional @ np.diff(theta) ** 2
    assert string.energy((group,), state)[1] == pytest.approx(strain, rel=1e-13)


@pytest.mark.parametrize("well", ["vertical", "inclined"])
def test_in_a_straight_hole_a_string_turned_as_a_rigid_body_keeps_its_strain_energy(well):
    rng = np.random.default_rng(3)
    state = string.random_state(rng)
    seats = string.curve(WELLS[well], state)
    groups = string.links(seats, rng), string.bends(seats, rng)
    q = state.q.reshape(-1, PER_BODY)
    points = np.column_stack([PLACES + q[:, 0], q[:, 1], q[:, 2]])
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turn *= np.linalg.det(turn)
    turned = points @ turn.T + rng.standard_normal(3)
    other = np.column_stack([turned[:, 0] - PLACES, turned[:, 1:], q[:, 3]]).ravel()
    before, after = (string.energy(groups, state._replace(q=x))[1] for x in (state.q, other))
    assert after == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize("well", WELLS)
def test_torsion_sees_differences_of_rotation_only(well):
    rng = np.random.default_rng(4)
    state = string.random_state(rng)
    group = string.links(string.curve(WELLS[well], state), rng, damping=0.2)
    spin = np.tile([0.0, 0.0, 0.0, 1.0], string.BODIES)
    turned = state._replace(q=state.q + 2.5 * spin, v=state.v - 4.0 * spin)
    one, other = string.residual((group,), state), string.residual((group,), turned)
    assert np.allclose(one, other, rtol=0, atol=1e-13 * np.abs(one).max())
    twist = np.diff(state.q[3::4]) + 0.2 * np.diff(state.v[3::4])
    torque = group.springs.torsional * twist
    assert np.allclose(one[3::4], -np.diff(torque, prepend=0.0, append=0.0), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("well", WELLS)
def test_a_string_at_its_places_on_the_axis_is_unstretched_and_a_soft_one_unbent(well):
    rest = string.State(*np.zeros((3, PLACES.size * PER_BODY)))
    rng = np.random.default_rng(5)
    seats = string.curve(WELLS[well], rest)
    groups = string.links(seats, rng), string.bends(seats, rng, stiff=False)
    assert string.energy(groups, rest)[1] == pytest.approx(0.0, abs=1e-28)
    assert np.allclose(string.residual(groups, rest), 0.0, atol=1e-14)


@pytest.mark.parametrize("well", WELLS)
def test_a_stiff_string_on_the_axis_is_bent_as_the_hole_turns(well):
    """docs/lumped_string.md: U = EI / (2 lb) (D1^2 + D2^2), D_a half the turning from link to link."""
    rest = string.State(*np.zeros((3, PLACES.size * PER_BODY)))
    group = string.bends(string.curve(WELLS[well], rest), np.random.default_rng(6))
    turns = [0.5 * (phi[2:] - phi[:-2]) for phi in WELLS[well].turning(PLACES)]
    bending = 0.5 * group.stiffness @ (turns[0] ** 2 + turns[1] ** 2)
    assert string.energy((group,), rest)[1] == pytest.approx(bending, rel=1e-12, abs=1e-28)


def test_a_stretched_link_on_an_arc_pulls_its_ends_inwards_with_half_its_tension_times_the_turning_each():
    """The soft string's side force T k (docs/lumped_string.md)."""
    well = WELLS["spatial one arc"]
    q = np.zeros((2, PER_BODY))
    q[1, 0] = 0.2
    state = string.State(q.ravel(), np.zeros(8), np.zeros(8))
    group = string.links(string.curve(well, state, PLACES[:2]), np.random.default_rng(7))
    turning = [phi[1] - phi[0] for phi in well.turning(PLACES[:2] + q[:, 0])]
    tension = group.springs.axial[0] * 0.2
    r = string.residual((group,), state).reshape(-1, PER_BODY)
    for end in r:
        assert end[1:3] == pytest.approx([-0.5 * tension * turn for turn in turning], rel=1e-12)
    assert r[:, 0] == pytest.approx([-tension, tension], rel=1e-12)


@pytest.mark.parametrize("well", WELLS)
def test_the_frames_downward_vector_and_depth_are_the_wellbores(well):
    """And along an arc they obey g1' = -k1 g3, g2' = -k2 g3, g3' = k1 g1 + k2 g2, tvd' = g3."""
    hole, step = WELLS[well], 0.05
    for s in (0.05, 1.7, 2.9, 4.4):
        state = string.State(*np.zeros((3, PER_BODY)))
        seats = string.curve(hole, state, np.array([s]))
        for x in (-step, 0.0, step):
            g, depth = string.down(seats, 0, x)
            if hole.arc(s + x) == hole.arc(s) and s + x >= 0.0:
                assert np.allclose(g, [e[2] for e in hole.frame(s + x)], rtol=0, atol=1e-14)
                assert depth == pytest.approx(hole.tvd(s + x), abs=1e-13)
        k1, k2 = seats.seats.k1[0], seats.seats.k2[0]
        (g1, g2, g3), _ = string.down(seats, 0, 0.0)
        slope = string.rate(lambda x, seats=seats: np.append(*string.down(seats, 0, x)), step)
        assert np.allclose(slope, [-k1 * g3, -k2 * g3, k1 * g1 + k2 * g2, g3], rtol=0, atol=1e-6)


def test_a_hole_so_slightly_curved_that_it_is_straight_gives_the_straight_holes_forces():
    """k -> 0 without loss of digits: 1 - cos and l - l0 are written so."""
    rng = np.random.default_rng(8)
    state = string.random_state(rng)
    straight = wellbore.from_survey(np.array([0.0, 9.0]), np.full(2, 0.8), np.full(2, 2.1))
    bent = wellbore.from_survey(np.array([0.0, 9.0]), np.array([0.8, 0.8 + 1e-9]), np.full(2, 2.1))
    one, other = ((lambda seats: (string.bodies(seats, np.random.default_rng(9)),
                   string.links(seats, np.random.default_rng(9)), string.bends(seats, np.random.default_rng(9))))
                  (string.curve(well, state)) for well in (straight, bent))  # fmt: skip
    assert np.allclose(string.residual(one, state), string.residual(other, state), rtol=0, atol=1e-8)
    assert np.allclose(string.energy(one, state), string.energy(other, state), rtol=0, atol=1e-8)
