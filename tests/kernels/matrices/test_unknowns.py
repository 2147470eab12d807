"""Full and reduced unknowns: ties are T^T S T, held degrees drop out, the band is no wider than it need be."""

import numpy as np
import pytest
from kernels.strings import short_string as string
from scipy.sparse import csr_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from tautline.cable.input.scene import parse
from tautline.cable.model.build import assemble_cables
from tautline.integrators.linearise import evaluate, matrices
from tautline.integrators.state import new_state
from tautline.kernels import groups as over
from tautline.kernels.dofs import RUN, expand, reduce, runs_of
from tautline.kernels.jit import entry
from tautline.kernels.matrix import new_matrix
from tautline.scene.functions import Harmonic
from tautline.system.masters import Masters
from tautline.system.pattern import narrow, pattern_of
from tautline.system.system import Degrees, assemble, number_by_mass
from tautline.system.time_functions import FunctionRequest, compile_functions

FULL = 4 * string.BODIES
NAMES = [f"degree {i}" for i in range(FULL)]
FUNCTIONS = compile_functions([FunctionRequest(Harmonic(amplitude=0.1, period=3.0, phase=0.4))])
EVERY = [np.arange(FULL)[None, :]]
TIES = {9: [(5, 0.5), (13, -0.3)], 7: [(3, 1.0)], 6: [(5, -2.0)]}


def scene(ties=TIES, held=(1, 2), prescribed=(0,), mass_stencils=EVERY, value=None):
    """A string with bending in a curved hole at a random state, some of its degrees of freedom held or tied."""
    rng = np.random.default_rng(11)
    state = string.random_state(rng)
    seats = string.curve(string.WELLS["spatial"], state)
    lumps = string.bodies(seats, rng, eccentric=True)
    groups = (lumps, string.links(seats, rng, damping=0.2), string.bends(seats, rng))
    degrees = Degrees(NAMES, state.q.copy() if value is None else value, np.ones(FULL))
    for i in held:
        degrees.fix(i)
    for i in prescribed:
        degrees.prescribe(i, 0)
    for i, masters in ties.items():
        degrees.tie(i, masters)
    return assemble(groups, degrees, FUNCTIONS, state.v, EVERY, mass_stencils), state


def transformation(system, ties=TIES):
    """T (full, n): full = T reduced, found by name."""
    at = {name: k for k, name in enumerate(system.names)}
    T = np.zeros((FULL, system.size))
    for i in range(FULL):
        for j, factor in ties.get(i, [(i, 1.0)]):
            if NAMES[j] in at:
                T[i, at[NAMES[j]]] = factor
    return T


@entry
def _expand(dofs, reduced, full):
    expand(dofs, reduced, full)


@entry
def _reduce(dofs, full, reduced):
    reduce(dofs, full, reduced)


@entry
def _add_mass(groups, q, matrix, dofs):
    over.diagonal_mass(groups, q, matrix, dofs)


def test_expand_multiplies_by_the_transformation_and_reduce_by_its_transpose():
    system, _ = scene()
    T, rng = transformation(system), np.random.default_rng(1)
    x, r = rng.standard_normal(system.size), rng.standard_normal(FULL)
    full, reduced = np.full(FULL, 7.0), np.full(system.size, 7.0)
    _expand(system.dofs, x, full)
    _reduce(system.dofs, r, reduced)
    moves = T.any(axis=1)
    assert np.allclose(full[moves], (T @ x)[moves], rtol=1e-15, atol=1e-15)
    assert np.array_equal(full[~moves], np.full(3, 7.0))
    assert np.allclose(reduced, T.T @ r, rtol=1e-14, atol=1e-14)


def _nodes(count, width, held, ends):
    """Degrees of freedom of a chain of nodes that are free: ``held`` of each are not, and the first of both ends."""
    free = np.ones((count, width), dtype=bool)
    free[:, held] = False
    free[[0, -1], :ends] = False
    return free.ravel()


def _drawn(seed):
    """A chain of which some degree of freedom is held, or let go, beside; or any order."""
    rng = np.random.default_rng(seed)
    width = int(rng.integers(1, 9))
    free = _nodes(int(rng.integers(1, 40)), width, rng.integers(0, width, 1), int(rng.integers(0, width)))
    some = rng.integers(0, free.size, int(rng.integers(0, 3)))
    free[some] = ~free[some]
    return rng.permutation(np.flatnonzero(free)) if seed % 7 == 0 else np.flatnonzero(free)


@pytest.mark.parametrize("seed", range(60))
def test_unknowns_that_lie_in_series_go_where_each_belongs(seed):
    free = _drawn(seed)
    system, _ = scene()
    none = np.zeros(0, dtype=np.int64)
    dofs = system.dofs._replace(free=free, runs=runs_of(free), tied=none)
    reduced, full = np.random.default_rng(seed).standard_normal(free.size), np.full(400, 7.0)
    expected = full.copy()
    expected[free] = reduced
    _expand(dofs, reduced, full)
    assert np.array_equal(full, expected)
    back = np.zeros(free.size)
    _reduce(dofs, full, back)
    assert np.array_equal(back, reduced)


def test_ropes_whose_nodes_hold_their_material_are_three_series_and_strings_one():
    rope = np.flatnonzero(_nodes(1001, 7, [6], 3))
    assert runs_of(rope).size == 3 * RUN
    assert runs_of(np.arange(5, 50)).tolist() == [0, 45, 5, 0, 45, 1]
    assert runs_of(np.flatnonzero(np.random.default_rng(0).random(500) < 0.5)).size == 0
    assert runs_of(np.zeros(0, dtype=np.int64)).size == 0
    assert any(runs_of(_drawn(seed)).size for seed in range(60))


@pytest.mark.parametrize("ties", [{}, TIES], ids=["no ties", "ties"])
def test_tangent_and_residual_of_a_tied_system_are_those_of_the_free_one_transformed(ties):
    system, _ = scene(ties)
    T, rng = transformation(system, ties), np.random.default_rng(2)
    state = new_state(system)
    state.q[:] += 0.02 * rng.standard_normal(system.size)
    state.v[:] = rng.standard_normal(system.size)
    reduced = matrices(system, state, at_rest=False)
    residual, k = np.zeros(system.size), system.bandwidth
    evaluate(system, state, 0.0, 1.0, False, 1.0, 0.0, 0.0, new_matrix(system.size, k), residual)
    # What the groups saw: free and tied accelerations zero, the prescribed one its function's.
    acceleration = np.where(np.arange(FULL) == 0, state.full_a, 0.0)
    full = string.State(state.full_q, state.full_v, acceleration)
    assert np.allclose(full.q[T.any(axis=1)], (T @ state.q)[T.any(axis=1)])
    r, _, parts = string.evaluate(system.groups, full)
    for S, name in zip(reduced, ("mass", "damping", "stiffness"), strict=True):
        expected = T.T @ parts[name] @ T
        assert np.allclose(S, expected, rtol=0, atol=1e-12 * np.abs(expected).max()), name
    assert np.allclose(residual, T.T @ r, rtol=0, atol=1e-12 * np.abs(r).max())


def test_the_mass_hook_of_a_tied_system_is_the_free_one_transformed():
    system, state = scene()
    T = transformation(system)
    bands = [new_matrix(system.size, system.mass_bandwidth) for _ in range(5)]
    parts = string.Parts(*bands, system.dofs)
    string.add_parts(system.groups[:1], 0.0, *state, np.zeros(FULL), parts, np.zeros(3))
    free = string.evaluate(system.groups[:1], state)[2]["hook"]
    assert np.allclose(string.dense(parts.hook), T.T @ free @ T, rtol=0, atol=1e-12)


def test_a_mass_matrix_that_comes_out_diagonal_takes_the_blocks_of_eccentric_bodies():
    """Lateral motion held, nothing couples the rest: the explicit method then keeps a diagonal (n,) and no band."""
    lateral = [i for i in range(FULL) if i % 4 in (1, 2)]
    own = [np.arange(FULL).reshape(-1, 4)[:, 1:]]
    system, state = scene({}, held=lateral, prescribed=(), mass_stencils=own)
    assert system.mass_bandwidth == 0
    diagonal = np.zeros(system.size)
    _add_mass(over.link(system.groups[:1], "diagonal_mass"), state.q, diagonal, system.dofs)
    free = string.evaluate(system.groups[:1], state)[2]["hook"]
    T = transformation(system, {})
    assert np.allclose(np.diag(diagonal), T.T @ free @ T, rtol=0, atol=1e-12)


def test_the_mass_matrix_in_its_own_order_is_the_same_matrix():
    """The lumps' mass couples an axial degree with the tied ones only: another order of the unknowns is best for it."""
    own = [np.arange(FULL).reshape(-1, 4)]
    system, state = scene(mass_stencils=own)
    numbering = number_by_mass(system)
    assert numbering.bandwidth <= system.mass_bandwidth
    full = system.size - 1
    found = []
    for dofs in (system.dofs, numbering.dofs):
        bands = [new_matrix(system.size, full) for _ in range(5)]
        string.add_parts(system.groups[:1], 0.0, *state, np.zeros(FULL), string.Parts(*bands, dofs), np.zeros(3))
        found.append(string.dense(bands[-1]))
    order = numbering.order
    assert sorted(order) == list(range(system.size))
    assert np.array_equal(found[1], found[0][np.ix_(order, order)])
    i, j = np.nonzero(found[1])
    assert np.abs(i - j).max() <= numbering.bandwidth
    full_vector, reduced = np.arange(1.0, FULL + 1.0), np.zeros((2, system.size))
    for dofs, x in zip((system.dofs, numbering.dofs), reduced, strict=True):
        _reduce(dofs, full_vector, x)
    assert np.array_equal(reduced[1], reduced[0][order])


def test_the_mass_matrix_of_a_rope_takes_each_direction_for_itself():
    """Position and slope of two nodes in one direction: three diagonals beside the main one, however many elements."""
    nodes = "".join(
        f"  - Node7Dof: {{id: {i}, xyz: [{i}, 0, 0], xyz_d: [1, 0, 0], BC: [{int(i == 0)}, 0, 0, 0, 0, 0, 1]}}\n"
        for i in range(9)
    )
    elements = "".join(
        f"  - CableALEelement: {{id: {i}, nodes7: [{i}, {i + 1}], EA: 1000, EJ: 0, rhoA: 1, cDamp: 0}}\n"
        for i in range(8)
    )
    solver = "GeneralizedAlpha: {type: RK4, time_step: 1.0e-4, time_end: 0.1, plotpoints: 10}\n"
    system = assemble_cables(
        parse(f"CableModelMaterial: {{Gravity: [0, 0, -9.81]}}\nCableModel:\n{nodes}{elements}{solver}")
    ).system
    assert number_by_mass(system).bandwidth == 3
    assert system.mass_bandwidth > 6


def test_a_held_degree_starts_where_its_value_and_function_put_it():
    system, state = scene()
    running = new_state(system)
    matrices(system, running, at_rest=False)
    w = 2.0 * np.pi / 3.0
    assert running.full_q[:3] == pytest.approx([state.q[0] + 0.1 * np.sin(0.4), *state.q[1:3]], rel=1e-14)
    assert running.full_v[:3] == pytest.approx([0.1 * w * np.cos(0.4), 0.0, 0.0], rel=1e-14)
    assert running.full_a[:3] == pytest.approx([-0.1 * w * w * np.sin(0.4), 0.0, 0.0], rel=1e-14)


def test_a_tied_degrees_own_value_does_not_move_its_master():
    """A tied degree is the sum of factors times others: what was written in its own place says nothing."""
    value = np.zeros(FULL)
    value[3], value[5] = 0.3, 0.4
    system, _ = scene({7: [(3, 1.0)], 6: [(5, -2.0)]}, value=value)
    state = new_state(system)
    at = {name: k for k, name in enumerate(system.names)}
    assert [state.q[at[NAMES[3]]], state.q[at[NAMES[5]]]] == [0.3, 0.4]


def test_each_unknown_and_its_scale_keep_their_names_when_the_order_changes():
    rng = np.random.default_rng(3)
    order = rng.permutation(20)
    degrees = Degrees([f"{i}" for i in range(20)], np.arange(20.0), 1.0 + np.arange(20.0))
    system = assemble((), degrees, FUNCTIONS, np.zeros(20), [np.column_stack([order[:-1], order[1:]])], [])
    assert system.bandwidth == 1 and system.mass_bandwidth == 0
    assert [float(name) for name in system.names] == [scale - 1.0 for scale in system.scale]
    assert np.array_equal(new_state(system).q, system.scale - 1.0)


def natural_bandwidth(stencils, masters, free):
    rank = {i: k for k, i in enumerate(free)}
    wide = 0
    for stencil in stencils:
        for row in stencil:
            seen = [rank[m] for i in row for m in masters.get(i, [i]) if m in rank]
            wide = max([wide, *(abs(a - b) for a in seen for b in seen)])
    return wide


@pytest.mark.parametrize("seed", range(40))
def test_the_band_is_never_wider_than_in_the_order_of_building(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 30))
    stencils = [rng.integers(0, n, (int(rng.integers(1, n)), int(rng.integers(2, 4)))) for _ in range(2)]
    degrees = Degrees([f"{i}" for i in range(n)], np.zeros(n), np.ones(n))
    kinds = rng.choice(["free", "held", "tied"], n, p=[0.7, 0.15, 0.15])
    kinds[:2] = "free"
    free = np.flatnonzero(kinds == "free")
    masters = {}
    for i in range(n):
        if kinds[i] == "held":
            degrees.fix(i)
        elif kinds[i] == "tied":
            masters[i] = list(rng.choice(free, 2, replace=False))
            degrees.tie(i, [(int(j), 0.5) for j in masters[i]])
    system = assemble((), degrees, FUNCTIONS, np.zeros(n), stencils, stencils[:1])
    assert system.bandwidth <= natural_bandwidth(stencils, masters, free)
    # And it holds every entry that a stencil may add.
    for stencil, bandwidth in ((stencils[0], system.bandwidth), (stencils[1], system.bandwidth),
                               (stencils[0], system.mass_bandwidth)):  # fmt: skip
        for row in stencil:
            seen = [u for i in row for u in system.dofs.unknown[system.dofs.start[i] : system.dofs.start[i + 1]]]
            assert not seen or max(seen) - min(seen) <= bandwidth


def test_a_chain_keeps_its_order_and_a_shuffled_one_gets_it_back():
    for order in (np.arange(200), np.random.default_rng(5).permutation(200)):
        triples = order[np.arange(198)[:, None] + np.arange(3)]
        pattern = pattern_of(Masters.of(np.arange(200), [], {}), 200, [triples])
        found, border = narrow(pattern)
        assert border == 0 and pattern.renumbered(np.argsort(found)).width() == 2
        assert np.array_equal(found, order) or np.array_equal(found, order[::-1])
        assert np.array_equal(pattern.toarray().sum(axis=0), pattern.degree)


def test_orders_are_in_the_mean_as_narrow_as_those_of_scipys_cuthill_mckee():
    widths = []  # of single ones either may be narrower: ties are broken otherwise
    for seed in range(100):
        rng = np.random.default_rng(seed)
        size, width = int(rng.integers(20, 200)), int(rng.integers(1, 6))
        near = np.arange(size - width)[:, None] + np.sort(rng.integers(0, width + 1, (size - width, 2)), axis=1)
        near = near[rng.random(len(near)) < 0.9]  # in several pieces, where entries are left out
        pattern = pattern_of(Masters.of(np.arange(size), [], {}), size, [rng.permutation(size)[near]])
        order, border = narrow(pattern)
        assert border == 0 and np.array_equal(np.sort(order), np.arange(size))
        other = reverse_cuthill_mckee(csr_array(pattern.toarray()), symmetric_mode=True)
        widths.append([pattern.renumbered(np.argsort(one)).width() for one in (order, other)])
    ours, scipys = np.mean(widths, axis=0)
    assert ours <= 1.05 * scipys


def test_what_all_others_depend_on_becomes_the_border():
    spokes = np.column_stack([np.full(150, 77), np.delete(np.arange(151), 77)])
    order, border = narrow(pattern_of(Masters.of(np.arange(151), [], {}), 151, [spokes]))
    assert border == 1 and order[-1] == 77
    assert narrow(pattern_of(Masters.of(np.arange(0), [], {}), 0, []))[1] == 0


def with_multipliers(rng):
    """A pattern of a chain with hubs that all depend on, and multipliers of a few of either; entries (n, n) for it."""
    chain, hubs, ties = 150, int(rng.integers(1, 4)), int(rng.integers(1, 7))
    size = chain + hubs + ties
    bare = np.arange(chain + hubs, size)
    near = np.arange(chain - 1)[:, None] + np.arange(2)
    spokes = [np.column_stack([np.full(chain, chain + hub), np.arange(chain)]) for hub in range(hubs)]
    # Many take the same few: some of them are left without one of their own in the band.
    ends = [rng.choice([*range(chain, chain + hubs), 3, 4, 90], int(rng.integers(1, 3)), replace=False) for _ in bare]
    held = [np.append(places, one)[None, :] for places, one in zip(ends, bare, strict=True)]
    number = rng.permutation(size)
    stencils = [number[rows] for rows in (near, *spokes, *held)]
    pattern = pattern_of(Masters.of(np.arange(size), [], {}), size, stencils, number[bare])
    entries = pattern.toarray() * rng.normal(size=(size, size))
    entries[np.ix_(number[bare], number[bare])] = 0.0
    return pattern, entries


def test_the_band_can_be_factorised_wherever_the_whole_matrix_can_and_no_multiplier_leaves_it_for_nothing():
    moved = 0
    for seed in range(20):
        pattern, entries = with_multipliers(np.random.default_rng(seed))
        if np.linalg.matrix_rank(entries) < pattern.size:
            continue
        order, border = narrow(pattern)
        inner, outer = order[: pattern.size - border], order[pattern.size - border :]
        assert np.linalg.matrix_rank(entries[np.ix_(inner, inner)]) == inner.size
        for one in np.intersect1d(outer, pattern.bare):
            more = np.append(inner, one)
            assert np.linalg.matrix_rank(entries[np.ix_(more, more)]) < more.size
            moved += 1
    assert moved > 10
