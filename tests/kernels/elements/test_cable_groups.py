"""Groups of rope elements against the blind reference in references/ale_ancf.py; loads and springs; constraints.

The reference knows kinematics and energies alone, in power series; its derivatives are exact complex steps.
Residuals agree to 1e-10, tangents to 1e-9 of the largest entry: production and reference share no formula, and differ
by rounding only (1e-14 here). Groups without a reference are held against differences of fourth order, 1e-7.
"""

import numpy as np
import pytest
from kernels.elements import cable_groups as rope
from kernels.elements.cable_groups import (
    CUBIC,
    KINDS,
    LINEAR,
    SHAPES,
    State,
    ask,
    close,
    derivative,
    moved,
    new_state,
    parts,
)
from of_the_suite import studies
from references import ale_ancf as reference

from tautline.constraints.equations import equations
from tautline.constraints.multiplier import Multipliers
from tautline.constraints.penalty import Penalties
from tautline.elements.nodal.load import Loads
from tautline.elements.nodal.node import SPRING, Anchors, PointMasses, Springs, timed_forces
from tautline.kernels import groups as over
from tautline.kernels.jit import entry

RESIDUAL, TANGENT, DIFFERENCE = 1e-10, 1e-9, 1e-7
STRESSED = [name for name in KINDS if "tension" in name or "bending" in name]
INERT = [name for name in KINDS if name not in STRESSED]
MIXED = (0.7, -1.3, 2.1)


def tangent_cases():
    """Each kind at the states that bring out all of its terms; a second rule of integration at one.

    In the suite each is fast, and what has a tension slack besides: the others go the same ways through the code.
    """
    cases = []
    for name in KINDS:
        # Exactly straight ropes in bending have a test of their own.
        shapes = ["folded", "fast flow"] + (["slack"] if "tension" in name else [])
        shapes += [] if "bending" in name else ["straight"]
        for shape in shapes if "Lobatto" not in name else ["fast flow"]:
            marks = () if shape in ("fast flow", "slack") else pytest.mark.study
            cases.append(pytest.param(name, shape, id=f"{name}, {shape}", marks=marks))
    return cases


def counted(kind, array):
    """The entries of a vector, or of a stack of matrices, that a kind answers for."""
    keep = rope.counted(kind)
    return array[keep] if array.ndim == 1 else array[..., keep, :][..., keep]


# against the reference
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", KINDS)
def test_the_residual_is_the_references(name, shape):
    kind = KINDS[name]
    for seed, damped in ((0, True), (1, True), (2, False)):
        state = new_state(kind.node, shape, kind.still, seed)
        force = rope.force(kind, state, damped)
        # A straight rope has no bending force: 1 N is the size of it in the other states.
        size = 1.0 if "bending" in name else 0.0
        assert close(counted(kind, ask(kind.make(damped), state).residual), counted(kind, force), RESIDUAL, size)


@pytest.mark.parametrize("name", KINDS)
def test_what_is_no_unknown_of_the_rope_is_left_alone(name):
    kind = KINDS[name]
    answer = ask(kind.make(), new_state(kind.node, still=kind.still), MIXED)
    strangers = np.ones(answer.residual.size, dtype=bool)
    for element in range(2):
        strangers[rope.rows_of(kind.node, element)] = False
    assert not answer.residual[strangers].any()
    assert not answer.tangent[strangers].any()
    assert not answer.tangent[:, strangers].any()


@pytest.mark.parametrize(("name", "shape"), tangent_cases())
def test_each_part_of_the_tangent_is_the_derivative_of_the_reference(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, kind.still)
    group = kind.make()
    slopes, made = counted(kind, rope.slopes(kind, state)), counted(kind, parts(group, state))
    for part, slope, word in zip(made, slopes, ("by a", "by v", "by q"), strict=True):
        # The viscous bending of a straight rope is zero to rounding; all else has a size.
        assert close(part, slope, TANGENT, 1e-9), word
    mixed = counted(kind, ask(group, state, MIXED).tangent)
    assert close(mixed, np.tensordot(MIXED, slopes, 1), TANGENT)


@pytest.mark.parametrize("name", ["flow", "flowing tension", "flowing bending", "linear flow"])
def test_the_tangent_is_also_the_difference_of_the_residual(name):
    kind = KINDS[name]
    state = new_state(kind.node)
    group = kind.make()
    for part, field in zip(parts(group, state), ("a", "v", "q"), strict=True):
        slope = derivative(lambda x, f=field: rope.residual(group, state._replace(**{f: x})), getattr(state, field))
        assert close(part, slope, DIFFERENCE), field


@entry
def _add_diagonal(groups, q, diagonal, dofs):
    over.diagonal_mass(groups, q, diagonal, dofs)


@pytest.mark.parametrize("name", KINDS)
def test_the_mass_hook_adds_to_a_diagonal_what_stands_on_that_of_the_matrix(name):
    """An explicit method whose mass matrix is diagonal holds no more than that."""
    kind = KINDS[name]
    state, group = new_state(kind.node, still=kind.still), kind.make()
    diagonal = np.zeros(state.q.size)
    _add_diagonal(over.link((group,), "diagonal_mass"), state.q, diagonal, rope.all_free(state.q.size))
    assert np.array_equal(diagonal, np.diagonal(ask(group, state).mass))


@pytest.mark.parametrize("name", KINDS)
def test_the_mass_hook_is_the_tangent_by_acceleration_and_positive(name):
    kind = KINDS[name]
    for shape in ("anyhow", "folded", "fast flow"):
        state = new_state(kind.node, shape, kind.still)
        answer = ask(kind.make(), state, (1.0, 0.0, 0.0))
        assert close(answer.mass, answer.tangent, 1e-15)
        assert close(answer.mass, answer.mass.T, 1e-14)
        if name in INERT:
            whole = np.zeros_like(answer.mass)
            for e in range(2):
                rows = rope.rows_of(kind.node, e)
                whole[np.ix_(rows, rows)] += reference.mass(state.q[rows], rope.MASS[e], kind.node == LINEAR)
            assert close(counted(kind, answer.mass), counted(kind, whole), RESIDUAL)
            assert np.linalg.eigvalsh(answer.mass).min() > -1e-12
        else:
            assert not answer.mass.any()


# energy
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", KINDS)
def test_energies_are_the_references(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, kind.still)
    linear = kind.node == LINEAR
    energies = np.zeros(3)
    for e in range(2):
        rows = rope.rows_of(kind.node, e)
        q, v = state.q[rows], state.v[rows]
        if name in INERT:
            energies[0] += reference.kinetic_energy(q, v, rope.MASS[e], linear)
            energies[2] += reference.potential_energy(q, rope.LOAD[e], linear)
        elif "bending" in name:
            energies[1] += reference.strain_energy(q, 0.0, rope.EJ[e])
        else:
            rule = "lobatto" if "Lobatto" in name else "gauss"
            material = {"strain": rope.STRAIN[e], "compression": rope.COMPRESSION[e], "axial": (rule, 3)}
            energies[1] += reference.strain_energy(q, rope.EA[e], 0.0, linear=linear, **material)
    assert np.allclose(ask(kind.make(), state).energy, energies, rtol=RESIDUAL, atol=1e-15)


@pytest.mark.parametrize("shape", ["anyhow", "slack", "folded"])
@pytest.mark.parametrize("name", STRESSED)
def test_the_undamped_residual_is_the_gradient_of_the_energy_by_all_unknowns_with_p(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, kind.still)
    group = kind.make(False)
    gradient = derivative(lambda q: ask(group, state._replace(q=q)).energy[1], state.q)
    assert close(counted(kind, ask(group, state).residual), counted(kind, gradient), DIFFERENCE, 1e-3)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", KINDS)
def test_what_is_lost_is_the_velocity_times_the_damping_force(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, kind.still)
    damped, undamped = (ask(kind.make(d), state) for d in (True, False))
    power = state.v @ (damped.residual - undamped.residual)
    assert damped.power[0] == pytest.approx(power, rel=1e-9, abs=1e-12)
    assert damped.power[0] >= 0.0 == undamped.power[0]
    if shape == "anyhow":
        assert damped.power[0] > 1e-2


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", KINDS)
def test_power_of_the_residual_is_the_energys_rate_what_is_lost_and_what_comes_in_with_the_material(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, kind.still)
    group = kind.make() if name != "linear flow" else rope.linear_flow(kinks=({}, {}))
    answer = ask(group, state)
    power = rope.rate(lambda x: ask(group, moved(state, x)).energy.sum(), 1e-4 if shape == "fast flow" else 1e-3)
    lost, driven = answer.power
    # Bending is straight for a moment only: 1 W is the size of what follows.
    scale = 1e-7 * max(np.abs(answer.residual * state.v).max(), 1.0)
    assert answer.residual @ state.v == pytest.approx(power + lost - driven, abs=scale)


@pytest.mark.parametrize("name", ["flow", "linear flow"])
def test_what_comes_in_with_the_material_is_the_references_flux(name):
    kind = KINDS[name]
    group = kind.make() if name != "linear flow" else rope.linear_flow(kinks=({}, {}))
    for shape in ("anyhow", "fast flow"):
        state = new_state(kind.node, shape)
        flux = 0.0
        for e in range(2):
            rows = rope.rows_of(kind.node, e)
            given = (x[rows] for x in state)
            powers = reference.power_balance(*given, rope.MASS[e], rope.LOAD[e], linear=kind.node == LINEAR)
            flux += powers["kinetic_flux"] + powers["potential_flux"]
        assert ask(group, state).power[1] == pytest.approx(flux, rel=1e-10)


def test_where_linear_elements_turn_momentum_the_power_balance_closes_too():
    kind = KINDS["linear flow"]
    for shape in ("anyhow", "fast flow"):
        state = new_state(LINEAR, shape)
        answer = ask(kind.make(), state)
        power = rope.rate(lambda x, s=state: ask(kind.make(), moved(s, x)).energy.sum(), 1e-4)
        lost, driven = answer.power
        scale = 1e-7 * np.abs(answer.residual * state.v).max()
        assert answer.residual @ state.v == pytest.approx(power + lost - driven, abs=scale)


# one kind against another
@pytest.mark.parametrize("shape", [s for s in SHAPES if s != "fast flow"])
@pytest.mark.parametrize(
    ("still", "moving"),
    [("inertia", "flow"), ("tension", "flowing tension"), ("tension, Lobatto", "flowing tension, Lobatto"),
     ("bending", "flowing bending"), ("linear inertia", "linear flow")],
)  # fmt: skip
def test_with_the_material_at_rest_both_kinds_say_the_same(still, moving, shape):
    one, other = KINDS[still], KINDS[moving]
    state = new_state(one.node, shape, still=True)
    a, b = ask(one.make(), state, MIXED), ask(other.make(), state, MIXED)
    size = 1.0 if "bending" in still else 0.0
    assert close(counted(one, a.residual), counted(one, b.residual), 1e-12, size)
    assert close(counted(one, a.tangent), counted(one, b.tangent), 1e-12)
    assert close(counted(one, a.mass), counted(one, b.mass), 1e-12)
    assert np.allclose(a.energy, b.energy, rtol=1e-12, atol=1e-14)
    assert np.allclose(a.power, b.power, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("name", STRESSED)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_rigid_rotation_loses_nothing_and_a_rigid_motion_stores_nothing(name, shape):
    kind = KINDS[name]
    state = new_state(kind.node, shape, still=True)
    spin, speed = np.array([0.7, -2.0, 1.1]), np.array([3.0, 1.0, -2.0])
    turn, _ = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))
    q, v = state.q.copy(), np.zeros_like(state.v)
    for start in rope.STARTS[kind.node]:
        v[start : start + 3] = speed + np.cross(spin, q[start : start + 3])
        q[start : start + 3] = turn @ q[start : start + 3] + speed
        if kind.node == CUBIC:
            v[start + 3 : start + 6] = np.cross(spin, state.q[start + 3 : start + 6])
            q[start + 3 : start + 6] = turn @ q[start + 3 : start + 6]
    turning = State(state.q, v, state.a)
    damped, undamped = ask(kind.make(), turning), ask(kind.make(False), turning)
    assert damped.power[0] == pytest.approx(0.0, abs=1e-24)
    size = 1.0 if "bending" in name else 0.0
    assert close(counted(kind, damped.residual), counted(kind, undamped.residual), 1e-13, size)
    elsewhere = ask(kind.make(), state._replace(q=q)).energy
    assert elsewhere == pytest.approx(ask(kind.make(), state).energy, rel=1e-12, abs=1e-28)


# bending where the rope is straight
@pytest.mark.parametrize("name", ["bending", "flowing bending"])
def test_exactly_straight_the_bending_force_is_zero_and_its_tangent_finite(name):
    kind = KINDS[name]
    state = new_state(CUBIC, "straight", kind.still)
    # On an axis the curvature is zero to the last bit, not to rounding.
    for start, x in zip(rope.STARTS[CUBIC], (0.0, 1.0, 3.0), strict=True):
        state.q[start : start + 7] = (x, 0.0, 0.0, 1.0, 0.0, 0.0, x)
    answer = ask(kind.make(), state, MIXED)
    assert not answer.residual.any() and not answer.energy.any() and not answer.power.any()
    assert np.isfinite(answer.tangent).all() and answer.tangent.any()
    slopes = counted(kind, rope.slopes(kind, state))
    assert close(counted(kind, answer.tangent), np.tensordot(MIXED, slopes, 1), TANGENT)


@pytest.mark.parametrize("name", ["bending", "flowing bending"])
def test_bending_passes_through_straight_smoothly(name):
    """On the way through straight R(x) = x K d to second order; the smoothed damping fades as x^2 and does not jump."""
    kind, counts = KINDS[name], rope.counted(KINDS["bending"])
    straight = new_state(CUBIC, "straight", still=True)
    way = np.random.default_rng(5).standard_normal(straight.q.size)
    way[rope.materials(CUBIC)] = 0.0
    group, resting = kind.make(), straight._replace(v=0 * straight.v)
    slope = parts(group, resting)[2] @ way
    lost = {}
    for x in (1e-2, -1e-2, 1e-4, -1e-4, 1e-6, -1e-6, 1e-9, -1e-9):
        here = resting._replace(q=straight.q + x * way)
        miss = np.abs(ask(group, here).residual - x * slope)[counts].max()
        # Of second order in x, and rounding of positions of 1 m.
        assert miss <= (30.0 * abs(x) + 1e-14 / abs(x)) * abs(x) * np.abs(slope).max()
        moving = ask(group, here._replace(v=way), MIXED)
        assert np.isfinite(moving.residual).all() and np.isfinite(moving.tangent).all()
        lost[x] = moving.power[0] / x**2
    for x in (-1e-4, 1e-6, -1e-6, 1e-9, -1e-9):
        assert lost[x] == pytest.approx(lost[1e-4], rel=2e-2)


# open ends
@pytest.mark.parametrize("shape", SHAPES)
def test_an_open_end_carries_its_own_stored_energy_away(shape):
    state = new_state(CUBIC, shape)
    answer = ask(rope.outlets(), state)
    expected_residual, power = np.zeros(state.q.size), 0.0
    for e in range(2):
        rows = rope.rows_of(CUBIC, e)
        material = {"strain": rope.STRAIN[e], "compression": rope.COMPRESSION[e]}
        psi = reference.strain_energy_density(state.q[rows], float(e), rope.EA[e], rope.EJ[e], **material)[0]
        p = rows[6 if e == 0 else 13]
        expected_residual[p] = psi if e == 0 else -psi
        power += (-psi if e == 0 else psi) * state.v[p]
    assert np.allclose(answer.residual, expected_residual, rtol=RESIDUAL, atol=1e-15)
    assert answer.power == pytest.approx([0.0, power], rel=RESIDUAL)
    # v.R is what leaves: the store grows by what the forces do and by what comes in.
    assert answer.residual @ state.v == pytest.approx(-power, rel=RESIDUAL)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_tangent_of_an_open_end_is_the_derivative_of_its_energy(shape):
    state = new_state(CUBIC, shape)

    def force(q):
        r = np.zeros(q.size, q.dtype)
        for e in range(2):
            rows = rope.rows_of(CUBIC, e)
            material = {"strain": rope.STRAIN[e], "compression": rope.COMPRESSION[e]}
            psi = reference.strain_energy_density(q[rows], float(e), rope.EA[e], rope.EJ[e], **material)[0]
            r[rows[6 if e == 0 else 13]] = psi if e == 0 else -psi
        return r

    made = parts(rope.outlets(), state)
    assert not made[:2].any()
    assert close(made[2], reference.jacobian(force, state.q), TANGENT)


# what hangs on nodes
PLACE = np.array([3, 10])


def node_groups():
    values = np.array([[1.0, -2.0, 0.5], [0.3, 0.0, 4.0]])
    rows = [
        {"a": 3, "b": 10, "stiffness": 3.0, "damping": 0.7, "length": 1.3},
        {"a": 17, "b": 10, "stiffness": 0.4, "damping": 2.0, "length": 0.0},
    ]
    table = equations([[(3, 1.0), (10, -1.0)], [(6, 0.5), (12, 2.0), (19, -3.0)]], [0.3, -0.7])
    return {
        "masses": PointMasses(PLACE, np.array([2.0, 0.3]), 0.4, np.array([0.0, 1.0, -9.0])),
        "anchors": Anchors(PLACE, np.array([3.0, 5.0]), np.array([0.2, 0.0]), values),
        "springs": Springs(rope.records_of(SPRING, rows), np.zeros((6, 6))),
        "forces": timed_forces(PLACE, values, np.array([[0.0, 1.0], [-1.0, 0.02]])),
        "loads": Loads(PLACE, np.array([1.0, -2.0])),
        "penalties": Penalties(table, np.array([20.0, 7.0])),
    }


@pytest.mark.parametrize("name", node_groups())
@pytest.mark.parametrize("seed", [0, *studies(1)])
def test_what_hangs_on_nodes_has_tangents_that_are_differences_and_balances_its_power(name, seed):
    group, state = node_groups()[name], new_state(CUBIC, seed=seed)
    for part, field in zip(parts(group, state), ("a", "v", "q"), strict=True):
        slope = derivative(lambda x, f=field: rope.residual(group, state._replace(**{f: x})), getattr(state, field))
        assert close(part, slope, DIFFERENCE, 1e-4), field
    answer = ask(group, state, MIXED)
    assert close(answer.tangent, np.tensordot(MIXED, parts(group, state), 1), 1e-13)
    assert np.array_equal(answer.mass, parts(group, state)[0])
    power = rope.rate(lambda x: ask(group, moved(state, x)).energy.sum())
    lost, driven = answer.power
    assert answer.residual @ state.v == pytest.approx(power + lost - driven, rel=1e-8, abs=1e-8)
    assert lost >= 0.0
    assert (driven == 0.0) == (name != "forces")


def test_springs_pull_by_stretch_and_rate_along_their_line():
    state = new_state(CUBIC, seed=4)
    r = rope.residual(node_groups()["springs"], state)
    line, rate = state.q[10:13] - state.q[3:6], state.v[10:13] - state.v[3:6]
    size = np.linalg.norm(line)
    force = 3.0 * (size - 1.3) + 0.7 * (line / size) @ rate
    assert r[3:6] == pytest.approx(-force * line / size, rel=1e-13)


def test_a_spring_whose_ends_meet_pulls_nowhere_and_stays_finite():
    state = new_state(CUBIC, seed=4)
    state.q[10:13] = state.q[3:6]
    answer = ask(node_groups()["springs"], state, MIXED)
    assert not answer.residual[3:6].any()
    assert np.isfinite(answer.tangent).all()


@pytest.mark.parametrize(
    ("t", "h", "beta", "acts"),
    [
        (0.0, 0.1, 0.0, (1.0, 0.2)),  # the share of an explicit step from 0 to 0.1 s
        (0.0, 0.1, 4.0, (1.0, 0.0)),  # of the time from 0.05 to 0.15 s around the end of an implicit step
        (0.92, 0.1, 4.0, (0.3, 0.0)),
        (0.96, 0.1, 4.0, (0.0, 0.0)),
        (-0.5, 0.1, 4.0, (0.0, 1.0)),
        (0.0, 0.1, -1.0, (1.0, 1.0)),  # an equilibrium is one under the forces of its own time
        (0.02, 0.1, -1.0, (1.0, 0.0)),
        (0.0, 0.0, 0.0, (1.0, 1.0)),
    ],
)
def test_a_force_acts_for_the_share_of_a_step_that_it_lasts(t, h, beta, acts):
    group, state = node_groups()["forces"], new_state(CUBIC)
    answer = ask(group, state, t=t, h=h, beta=beta)
    force = np.zeros(state.q.size)
    for k, place in enumerate(PLACE):
        force[place : place + 3] = acts[k] * group.value[k]
    assert answer.residual == pytest.approx(-force, rel=1e-12, abs=1e-14)
    # what acts from here on is a jump of the power: it is booked for the time to come
    assert sum(answer.power) == pytest.approx(force @ state.v, abs=1e-13)


# multipliers
ROWS, OFFSETS, UNKNOWN, WEIGHT = (
    ([[(3, 1.0), (10, -1.0)], [(6, 0.5), (12, 2.0), (19, -3.0)]]),
    (0.3, -0.7),
    (0, 25),
    1.7,
)


def multipliers():
    return Multipliers(equations(ROWS, OFFSETS), np.array(UNKNOWN), WEIGHT, np.zeros(1))


def gradient():
    g = np.zeros((2, rope.SIZE[CUBIC]))
    for i, row in enumerate(ROWS):
        for place, factor in row:
            g[i, place] = factor
    return g


@pytest.mark.parametrize(("beta", "by"), [(4.0e4, "a"), (0.0, "a"), (-1.0, "q")])
def test_a_multiplier_pulls_along_its_gradient_and_its_row_is_its_equation(beta, by):
    """lambda = w a and beta' w phi = 0 in a step, w G a = 0 in an explicit one, lambda = w q and w phi = 0 at rest."""
    state, g, unknown = new_state(CUBIC, seed=6), gradient(), np.array(UNKNOWN)
    r = rope.residual(multipliers(), state, beta=beta)
    force = WEIGHT * g.T @ getattr(state, by)[unknown]
    phi = g @ state.q + OFFSETS
    force[unknown] += WEIGHT * {"a": beta * phi if beta else g @ state.a, "q": phi}[by]
    assert r == pytest.approx(force, rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("beta", [4.0, 0.0, -1.0])
def test_the_tangent_of_multipliers_is_the_difference_of_their_residual(beta):
    group, state = multipliers(), new_state(CUBIC, seed=6)
    for part, field in zip(parts(group, state, beta=beta), ("a", "v", "q"), strict=True):
        slope = derivative(
            lambda x, f=field: rope.residual(group, state._replace(**{f: x}), beta=beta), getattr(state, field)
        )
        assert np.allclose(part, slope, rtol=0, atol=1e-9), field


def test_in_a_step_columns_and_rows_of_multipliers_are_alike():
    """cm = beta', ck = 1: the matrix beta' (M, w G^T; w G, 0) of eqs 2.90-2.93, symmetric for every step."""
    for beta in (4.0, 4.0e12):
        tangent = ask(multipliers(), new_state(CUBIC), (beta, 0.0, 1.0), beta=beta).tangent
        assert np.array_equal(tangent, tangent.T)
        assert np.abs(tangent).max() == pytest.approx(beta * WEIGHT * 3.0)


def test_the_mass_of_multipliers_and_what_they_miss():
    state, g, unknown = new_state(CUBIC, seed=6), gradient(), np.array(UNKNOWN)
    gaps = np.zeros((2, state.q.size))
    answer = ask(multipliers(), state, gaps=gaps)
    mass = np.zeros_like(answer.mass)
    mass[unknown] = WEIGHT * g
    assert np.array_equal(answer.mass, mass + mass.T)
    assert gaps[0][unknown] == pytest.approx(WEIGHT * (g @ state.q + OFFSETS))
    assert gaps[1][unknown] == pytest.approx(WEIGHT * (g @ state.v))
    assert np.count_nonzero(gaps) == 4


def test_multipliers_do_no_work_where_their_equations_hold():
    state, g = new_state(CUBIC, seed=6), gradient()
    v = state.v - np.linalg.pinv(g) @ (g @ state.v)
    unknown = np.array(UNKNOWN)
    v[unknown] = 0.0
    r = rope.residual(multipliers(), state._replace(v=v), beta=4.0)
    assert r @ v == pytest.approx(0.0, abs=1e-12)


def test_a_penalty_is_a_spring_on_its_equation():
    state, g = new_state(CUBIC, seed=7), gradient()
    phi = g @ state.q + OFFSETS
    answer = ask(node_groups()["penalties"], state)
    assert answer.residual == pytest.approx(g.T @ (np.array([20.0, 7.0]) * phi), rel=1e-13)
    assert answer.energy[1] == pytest.approx(0.5 * np.array([20.0, 7.0]) @ phi**2)
