"""The search for rest: iterations made one by one, and what an evaluation leaves of it."""

from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from tautline.application.installed import Installed
from tautline.integrators.linearise import NO_SEARCH, evaluate, search_on
from tautline.integrators.newton_at_rest import (
    AWAY,
    FOUND,
    ITERATION,
    LEFT,
    LOOSE,
    MORE,
    NEAREST,
    SHIFT,
    STEP_LIMIT,
    Search,
)
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium, neighbours
from tautline.kernels.dofs import HELD, TIED
from tautline.kernels.matrix import new_factors, new_matrix

LIMIT, TOLERANCE, MANY = 0.1, 1e-10, 200


def built(name):
    """A system of its own: groups remember where they last found the rope."""
    scene = tautline.read(f"data/{name}.yaml")
    return Installed().of(scene).build(scene).system


@pytest.fixture
def system():
    return built("hoist")


def search_of(system, shift=0.0):
    factors = new_factors(system.size, system.bandwidth, system.border)
    numbers = np.array([LIMIT, TOLERANCE, shift, np.inf, np.inf])
    pairs, room, ways = np.zeros((0, 2), np.int64), np.zeros(0), np.ones(system.size)
    return Search(factors, system.at_rest, system.scale, ways, pairs, room, numbers, np.zeros(4, np.int64))


def test_neighbours_of_a_node_whose_position_is_mixed_from_others_may_not_go_far():
    # Five nodes in a row, three numbers each: the first is held, the fourth lies between two others.
    number = np.array([HELD] * 3 + [0, 1, 2] + [3, 4, 5] + [TIED] * 3 + [6, 7, 8])
    beside = np.array([(3 * i + axis, 3 * i + 3 + axis) for i in range(4) for axis in range(3)])
    room = np.repeat([1.0, 2.0, 3.0, 4.0], 3)
    dofs = SimpleNamespace(number=number)
    pairs, beyond, far = neighbours(SimpleNamespace(size=9, dofs=dofs, neighbours=beside, room_between=room))
    assert pairs.tolist() == [[HELD, 0], [HELD, 1], [HELD, 2], [0, 3], [1, 4], [2, 5]]
    assert beyond.tolist() == [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    assert far.tolist() == [0, 1, 2]


def test_an_iteration_moves_no_two_ends_of_an_element_further_apart_than_the_limit_of_a_step():
    system = built("reeled_span")
    pairs, room, _ = neighbours(system)
    assert pairs.shape[0] > 5
    search, state = search_of(system, 1.0), new_state(system)
    search = search._replace(lever=np.zeros(system.size), pairs=pairs, room=room)
    search.numbers[STEP_LIMIT], search.counts[LEFT] = 1e-6, 1
    before = state.q.copy()
    assert search_on(system, state, search) == MORE
    moved = np.append(state.q - before, 0.0)
    apart = np.abs(moved[pairs[:, 0]] - moved[pairs[:, 1]])
    assert apart.max() == pytest.approx(1e-6, rel=1e-6)


@pytest.mark.parametrize("name", ["hoist", "sixteen_falls"])
@pytest.mark.parametrize("shift", [0.0, 1.0])
def test_iterations_one_by_one_and_all_at_once_end_at_the_same_place_to_the_bit(name, shift):
    found = []
    for left in (1, MANY):
        system = built(name)
        search, state = search_of(system, shift), new_state(system)
        search.counts[LEFT] = left
        stands = MORE
        while stands == MORE and search.counts[ITERATION] < MANY:
            stands = search_on(system, state, search)
        found.append((stands, search.counts[ITERATION], search.numbers[SHIFT], state.q.tobytes()))
    assert found[0] == found[1]
    assert found[0][0] == FOUND and found[0][1] > 2
    assert found[0][2] <= shift


def test_what_is_found_is_in_balance(system):
    """The residual of an evaluation, which knows nothing of a search, is the tolerance's share of the scale at most."""
    state = new_state(system)
    found = find_equilibrium(system, state, LIMIT, TOLERANCE)
    residual = np.zeros(system.size)
    evaluate(
        system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0,
        new_matrix(system.size, system.bandwidth, system.border), residual,
    )  # fmt: skip
    moves = np.setdiff1d(np.arange(system.size), system.at_rest)
    assert found.iterations > 2
    assert (np.abs(residual[moves]) <= 10.0 * TOLERANCE * system.scale[moves]).all()


def test_an_evaluation_moves_nothing_and_leaves_no_search_behind(system):
    state = new_state(system)
    before = state.q.copy()
    residual = np.zeros(system.size)
    evaluate(
        system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0,
        new_matrix(system.size, system.bandwidth, system.border), residual,
    )  # fmt: skip
    assert residual.any() and np.array_equal(state.q, before)
    assert not NO_SEARCH.counts.any() and not NO_SEARCH.numbers.any()


def test_a_search_says_that_it_has_left_what_numbers_can_hold(system):
    search, state = search_of(system), new_state(system)
    search.counts[LEFT] = MANY
    state.q[0] = np.nan
    assert search_on(system, state, search) == AWAY


def test_a_search_says_that_nothing_resists(system):
    """A rope without stiffness is pulled down by its weight, and no force grows with that."""
    (spans,) = (group for group in system.groups if type(group).__name__ == "Spans")
    spans.rows["stiffness"] = 0.0
    spans.rows["damping"] = 0.0
    search, state = search_of(system), new_state(system)
    search.counts[LEFT] = MANY
    assert search_on(system, state, search) == LOOSE
    assert np.isfinite(search.numbers[NEAREST]) and search.numbers[NEAREST] > 0.0


def test_a_string_of_many_short_lumps_is_at_rest_as_soon_as_one_of_few_and_as_long():
    # A rod of EA that weighs w a metre in the mud, bit free, is longer by w L^2 / 2 EA; here by 5.87 m, while a lump of
    # 0.3 m may move by 0.09 m against its neighbour. 400 iterations were not enough for 20,000.
    found = {}
    for lumps in (200, 20_000):
        text = VERTICAL.replace("LUMPS", str(lumps))
        scene = tautline.read(text)
        model = Installed().of(scene).build(scene)
        state = new_state(model.system)
        spent = find_equilibrium(model.system, state, model.step_limit).iterations
        found[lumps] = spent, float(state.full_q[4 * lumps])
    weight = 9.81 * (7850.0 - 1200.0)  # a cubic metre of steel in the mud
    stretch = weight * 6000.0**2 / (2.0 * 200e9)
    assert all(spent <= 20 for spent, _ in found.values())
    assert [way for _, way in found.values()] == pytest.approx([stretch] * 2, rel=1e-4)


VERTICAL = """
well: {sections: [{hold: 6000 m}], diameter: 0.2 m, wall: {stiffness: 1.0e9, friction: {static: 0.3, kinetic: 0.2}}}
string: [{name: drill pipe, length: rest, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1200}
model: {kind: lumped, elements: LUMPS}
solver: {method: generalized-alpha, step: 1 ms, end: 1 ms}
output: {interval: 1 ms}
"""
