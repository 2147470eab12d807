"""Scenes with too few equations along the rope, or with the same equation twice, are told from sound ones."""

import numpy as np
import pytest

from tautline.system.soundness import null_motions, redundant

X, Y, Z, P = range(4)
SLACK = 1e-8


class Rope:
    """Nodes of x, y, z, p in a row, with what holds them; node i starts at full degree of freedom 4 i."""

    def __init__(self, tangents):
        self.tangents = np.asarray(tangents, dtype=float)
        self.fixed, self.couplings, self.rows = set(), {}, []

    def fix(self, node, *dofs):
        self.fixed |= {4 * node + dof for dof in dofs}
        return self

    def fix_everywhere(self, *dofs):
        for node in range(len(self.tangents)):
            self.fix(node, *dofs)
        return self

    def couple(self, node, dof, *masters):
        self.couplings[4 * node + dof] = [(4 * master + dof, factor) for master, factor in masters]
        return self

    def tie(self, a, b, *dofs):
        self.rows += [[(4 * a + dof, 1.0), (4 * b + dof, -1.0)] for dof in dofs]
        return self

    def sliding(self):
        first = 4 * np.arange(len(self.tangents))
        return null_motions(first, self.tangents, first + P, self.fixed, self.couplings, self.rows)


def along(direction, nodes=5):
    return Rope([np.asarray(direction) / np.linalg.norm(direction)] * nodes)


def free_between_held_ends(direction=(1, 2, 2)):
    """A rope with p fixed at every node but the middle one, whose ends are pinned."""
    rope = along(direction).fix(0, X, Y, Z).fix(4, X, Y, Z)
    for node in (0, 1, 3, 4):
        rope.fix(node, P)
    return rope


class TestNullMotion:
    def test_p_fixed_everywhere_is_sound_with_nothing_else_held(self):
        assert along((1, 0, 0)).fix_everywhere(P).sliding() == []

    def test_p_free_at_an_end_pinned_in_space_is_sound(self):
        rope = along((1, 2, 2)).fix(0, X, Y, Z)
        for node in range(1, 5):
            rope.fix(node, P)
        assert rope.sliding() == []

    def test_p_free_at_a_node_free_in_space_is_singular(self):
        assert free_between_held_ends().sliding() == [2]

    def test_p_free_at_a_node_fixed_in_space_is_sound(self):
        assert free_between_held_ends().fix(2, X, Y, Z).sliding() == []

    def test_one_axis_that_has_a_part_along_the_rope_is_enough(self):
        assert free_between_held_ends().fix(2, Z).sliding() == []

    def test_a_rope_along_x_is_not_held_by_y_and_z(self):
        assert along((1, 0, 0)).fix_everywhere(Y, Z).sliding() == [0, 1, 2, 3, 4]

    def test_rounding_in_a_tangent_does_not_hold_a_rope(self):
        assert free_between_held_ends((1, 1e-7, 0)).fix(2, Y, Z).sliding() == [2]
        assert free_between_held_ends((1, 1e-5, 0)).fix(2, Y, Z).sliding() == []

    def test_a_penalty_spring_is_no_equation(self):
        """A spring or a penalty tie reaches the check as nothing at all: what it would hold is reported."""
        assert free_between_held_ends().sliding() == [2]
        assert free_between_held_ends().tie(2, 1, X, Y, Z).sliding() == []

    def test_p_tied_to_a_neighbour_with_p_fixed_is_sound(self):
        assert free_between_held_ends().tie(2, 1, P).sliding() == []
        assert free_between_held_ends().couple(2, P, (3, 1.0)).sliding() == []

    def test_a_coupling_in_space_to_a_node_that_is_held_counts(self):
        assert free_between_held_ends((1, 0, 0)).couple(2, X, (0, 0.5), (4, 0.5)).sliding() == []
        assert free_between_held_ends((1, 0, 0)).couple(2, Y, (0, 0.5), (4, 0.5)).sliding() == [2]

    def test_one_p_shared_by_a_rope_with_pinned_ends_is_sound(self):
        rope = along((3, 0, 4))
        for node in range(1, 5):
            rope.couple(node, P, (0, 1.0))
        assert rope.sliding() == [0]
        assert rope.fix(0, X, Y, Z).fix(4, X, Y, Z).sliding() == []

    @pytest.mark.parametrize("held", [False, True])
    def test_interpolated_p_is_as_sound_as_its_masters(self, held):
        rope = along((0, 0, 1)).fix(0, P)
        for node in (1, 2, 3):
            rope.couple(node, P, (0, 1 - node / 4), (4, node / 4))
        if held:
            rope.fix(4, X, Y, Z)
        assert rope.sliding() == ([] if held else [4])

    def test_the_node_named_is_the_one_that_slides_farthest(self):
        rope = along((1, 0, 0)).fix_everywhere(P)
        rope.fixed -= {4 * 1 + P, 4 * 3 + P}
        assert rope.couple(1, P, (3, 0.5)).sliding() == [3]
        assert rope.couple(1, P, (3, 2.0)).sliding() == [1]

    def test_the_farthest_is_found_where_the_equations_were_solved_for_another(self):
        rope = along((1, 0, 0)).fix(0, P).fix(4, P)
        rope.rows = [[(4 + P, 1.0), (8 + P, -1.0), (12 + P, 1.0)], [(8 + P, 1.0), (12 + P, 1.0)]]
        assert rope.sliding() == [1], "c = (2, 1, -1)"

    def test_two_ropes_tied_end_to_end_slide_together_where_they_are_in_line_and_not_at_a_kink(self):
        def tied(first, second):
            rope = Rope([first, first, second, second]).fix(0, P).fix(3, P)
            return rope.tie(1, 2, X, Y, Z, P).sliding()

        assert tied((1, 0, 0), (1, 0, 0)) in ([1], [2])
        assert tied((1, 0, 0), (0.8, 0.6, 0)) == []
        assert tied((0.6, 0.8, 0), (0.6 + 1e-9, 0.8, 0)) in ([1], [2])
        assert tied((0.6, 0.8, 0), (0.6 + 1e-4, 0.8, 0)) == []

    def test_nodes_without_p_and_degrees_of_freedom_of_no_node_stay_where_they_are(self):
        nodes, material, tangents = np.array([0, 4]), np.array([-1, 7]), np.array([[1.0, 0, 0], [1.0, 0, 0]])
        assert null_motions(nodes, tangents, material, {}, {}) == [1]
        assert null_motions(nodes, tangents, material, {}, {4: [(0, 1.0)]}) == []
        assert null_motions(nodes, tangents, material, {}, {}, [[(4, 1.0), (99, -1.0)]]) == []

    @pytest.mark.parametrize("seed", range(40))
    def test_as_many_as_the_mass_matrix_of_a_straight_rope_leaves_without_resistance(self, seed):
        """On a straight rope of linear elements the kinematic test is exact: v'Mv = 0 is r' = t p' at each node."""
        rng = np.random.default_rng(seed)
        nodes = 7
        direction = np.array([(1, 0, 0), (0, 0.6, 0.8), (1 / 3, 2 / 3, -2 / 3)][seed % 3])
        rope = along(direction, nodes)
        for node in range(nodes):
            rope.fix(node, *(dof for dof in range(4) if rng.random() < 0.12))
        for node in range(1, nodes):
            dof = int(rng.choice([X, P, P]))
            if rng.random() < 0.5 and 4 * node + dof not in rope.fixed:
                masters = [(int(m), float(rng.uniform(-2, 2))) for m in rng.choice(node, min(2, node), replace=False)]
                rope.couple(node, dof, *masters)
        for _ in range(3):
            a, b = rng.choice(nodes, 2, replace=False)
            rope.tie(int(a), int(b), int(rng.choice([X, Z, P])))

        full = 4 * nodes
        mass = np.zeros((full, full))
        for i in range(nodes - 1):
            slides = np.hstack([np.eye(3), -direction[:, None]])
            local = np.kron(np.array([[2, 1], [1, 2]]) / 6, slides.T @ slides)
            mass[4 * i : 4 * i + 8, 4 * i : 4 * i + 8] += local
        equations = dense(held_and_coupled(rope.fixed, rope.couplings) + rope.rows, full)
        nullity = full - np.linalg.matrix_rank(np.vstack([mass, equations]), tol=SLACK)
        assert len(rope.sliding()) == nullity

    @pytest.mark.parametrize("shared", ["fixed", "chained", "interpolated", "own"])
    def test_ten_thousand_nodes_are_judged_as_few_are(self, shared):
        nodes = 10_000
        rope = along((1, 2, 2), nodes).fix(0, X, Y, Z, P).fix(nodes - 1, X, Y, Z)
        for node in range(1, nodes - 1):
            if shared == "fixed":
                rope.fix(node, P)
            elif shared == "chained":
                rope.couple(node, P, (node + 1, 1.0))
            elif shared == "interpolated":
                rope.couple(node, P, (0, 1 - node / nodes), (nodes - 1, node / nodes))
        sliding = rope.sliding()
        assert len(sliding) == (nodes - 2 if shared == "own" else 0)


def difference(a, b):
    return [(a, 1.0), (b, -1.0)]


def held_and_coupled(fixed, couplings):
    return [[(i, 1.0)] for i in fixed] + [[(i, 1.0), *((j, -f) for j, f in m)] for i, m in couplings.items()]


def dense(rows, full):
    matrix = np.zeros((len(rows), full))
    for k, row in enumerate(rows):
        for j, factor in row:
            matrix[k, j] += factor
    return matrix


class TestRedundant:
    def test_independent_rows_are_all_kept(self):
        assert redundant([difference(0, 1), difference(1, 2), difference(3, 4)]) == {}

    def test_a_row_that_repeats_another_is_found_in_any_scale_and_order(self):
        assert redundant([[(0, 1.0), (1, -1.0)], [(1, 3.0), (0, -3.0)]]) == {1: 0.0}

    def test_the_last_of_a_ring_of_ties_is_the_redundant_one(self):
        assert redundant([difference(0, 1), difference(1, 2), difference(0, 2)]) == {2: 0.0}

    def test_a_row_of_nothing_is_redundant(self):
        assert redundant([[], [(3, 0.0)], [(3, 1.0), (3, -1.0)]]) == {0: 0.0, 1: 0.0, 2: 0.0}

    def test_a_row_over_held_degrees_of_freedom_is_redundant_and_its_constant_the_contradiction(self):
        rows = [difference(0, 1), difference(1, 2)]
        assert redundant(rows, fixed={0, 1}) == {0: 0.0}
        assert redundant(rows, fixed={0, 1}, residuals=[0.25, 7.0]) == {0: 0.25}

    def test_couplings_are_seen_through(self):
        halves = {2: [(0, 0.5), (1, 0.5)]}
        rows = [difference(2, 0), difference(0, 1)]
        assert redundant(rows, couplings=halves) == {1: 0.0}
        assert redundant([difference(2, 0)], fixed={0, 1}, couplings=halves) == {0: 0.0}
        assert redundant([difference(2, 0)], fixed={0}, couplings=halves) == {}

    def test_slaves_of_slaves_are_seen_through(self):
        assert redundant([difference(0, 3)], couplings={0: [(1, 2.0)], 1: [(2, 0.5)], 2: [(3, 1.0)]}) == {0: 0.0}

    def test_the_mismatch_is_what_the_rows_before_leave_of_it_in_its_own_unit(self):
        rows = [difference(0, 1), difference(1, 2), [(0, -4.0), (2, 4.0)]]
        assert redundant(rows, residuals=[0.5, 0.25, -3.0]) == {2: 0.0}
        assert redundant(rows, residuals=[0.5, 0.25, -2.0]) == {2: 1.0}

    def test_rounding_in_factors_hides_no_redundancy_and_small_differences_are_none(self):
        third = [(0, 1 / 3), (1, 0.1 + 0.2)]
        assert redundant([third, [(0, 1.0), (1, 0.9)]]) == {1: 0.0}
        assert redundant([third, [(0, 1.0), (1, 0.9 + 1e-6)]]) == {}

    @pytest.mark.parametrize("seed", range(30))
    def test_rank_and_mismatch_agree_with_dense_algebra(self, seed):
        rng = np.random.default_rng(seed)
        full = 12
        rows = [
            [(int(j), float(rng.integers(-3, 4))) for j in rng.choice(full, rng.integers(1, 4), replace=False)]
            for _ in range(14)
        ]
        fixed = {int(j) for j in rng.choice(full, 2, replace=False)}
        couplings = {j: [((j + 1) % full, 0.7), ((j + 5) % full, -0.4)] for j in (0, 3) if j not in fixed}
        residuals = rng.normal(size=len(rows))

        given = held_and_coupled(fixed, couplings)
        matrix = dense(given + rows, full)
        constants = np.concatenate([np.zeros(len(given)), residuals])
        expected, kept = {}, list(range(len(given)))
        for k in range(len(given), len(matrix)):
            if np.linalg.matrix_rank(matrix[[*kept, k]], tol=SLACK) > len(kept):
                kept.append(k)
            else:
                part = np.linalg.lstsq(matrix[kept].T, matrix[k], rcond=None)[0]
                expected[k - len(given)] = constants[k] - part @ constants[kept]
        found = redundant(rows, fixed, couplings, residuals)
        assert list(found) == list(expected)
        np.testing.assert_allclose(list(found.values()), list(expected.values()), atol=1e-8)

    @pytest.mark.parametrize("order", ["forwards", "backwards", "mixed"])
    def test_ten_thousand_rows_are_judged_in_any_order(self, order):
        count = 10_000
        ties = list(range(count))
        if order == "backwards":
            ties.reverse()
        elif order == "mixed":
            np.random.default_rng(5).shuffle(ties)
        rows = [difference(k, k + 1) for k in ties]
        assert redundant(rows, fixed={0}, couplings={count + 1: [(3, 0.5), (count, 0.5)]}) == {}
        assert list(redundant(rows, fixed={0, count})) == [count - 1]

    def test_ten_thousand_rows_of_several_entries_are_judged_in_no_order(self):
        rng = np.random.default_rng(2)
        rows = [[(int(j), float(rng.normal())) for j in rng.choice(40_000, 3, replace=False)] for _ in range(10_000)]
        assert redundant(rows) == {}
