"""A lump that begins to slip is solved for with its neighbours, not with the whole string: the motion is the same."""

from functools import cache

import numpy as np
import pytest
from physics.wells.strings import shipped

from drillstring.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.simulation import simulate

LUMPS = 150
CASES = {
    "exact friction": {},
    "regularised friction": {
        "well__wall__friction": {"static": 0.3, "kinetic": 0.2, "law": "regularised"},
        # its steps take several times as long
        "model__elements": 100,
        "solver__end": 0.1,
    },
    "a pinned bit that a controller turns": {
        "solver__end": 0.5,
        "bit__lateral": "pinned",
        "top__rotation": {"controller": {"speed": "60 rpm", "proportional": 2e3, "integral": 2e3, "inertia": 2e3}},
    },
}


@cache
def run(case, in_parts, step=1e-3):
    """Some seconds of the J-well in many lumps, with friction; every event solved for in all rows, or in its own."""
    changes = {"model__elements": LUMPS, "solver__end": 1.0, "solver__step": step, **CASES[case]}
    model = build(shipped("jwell", **changes))
    assert model.system.window.size == 2
    if not in_parts:
        model.system.window = np.zeros(0, np.int64)
    return simulate(model), model.system.size


@pytest.mark.parametrize(("case", "bound"), list(zip(CASES, (1e-8, 1e-8, 5e-4), strict=True)))
def test_a_string_moves_the_same_whether_events_are_solved_for_in_their_neighbourhood_or_in_all_rows(case, bound):
    (part, _), (whole, _) = run(case, True), run(case, False)
    # residuals may be a billionth of the string's weight, a millinewton on a spring of a hundred meganewtons per metre;
    # lumps that roll in the hole remember it: with a tenth of the tolerance they differ by 6e-5 m, all rows or not
    assert np.abs(part["position"] - whole["position"]).max() < bound
    assert np.abs(part["velocity"] - whole["velocity"]).max() < 1e3 * bound
    assert np.allclose(part["hook_load"], whole["hook_load"], rtol=10.0 * bound, atol=0)
    assert part.attributes["energy_error"] < 2.0 * whole.attributes["energy_error"] + 1e-9


def test_the_rows_that_are_solved_for_again_are_those_around_what_has_changed():
    (part, size), (whole, _) = run("exact friction", True), run("exact friction", False)
    every = size * whole.attributes["newton_iterations"]
    assert whole.attributes["equations_solved"] == every
    # an iteration over all rows in each step; what comes after it is in each about a sixth of them
    again = part.attributes["newton_iterations"] - part.attributes["steps"]
    assert again > 0.15 * part.attributes["steps"]
    assert part.attributes["equations_solved"] - size * part.attributes["steps"] < 0.5 * size * again


def test_where_a_step_is_long_for_the_lumps_more_of_them_are_taken_and_the_motion_is_the_same():
    (part, _), (whole, _) = run("exact friction", True, 1e-2), run("exact friction", False, 1e-2)
    assert part.attributes["halvings"] == whole.attributes["halvings"]
    assert np.abs(part["position"] - whole["position"]).max() < 1e-6


def test_a_long_string_comes_to_the_same_rest_whether_its_contacts_are_followed_in_part_or_in_all_rows():
    rests = []
    for in_parts in (True, False):
        model = build(shipped("jwell", model__elements=400))
        if not in_parts:
            model.system.window = np.zeros(0, np.int64)
        state = new_state(model.system)
        rests.append((find_equilibrium(model.system, state, model.step_limit), state.q))
        assert not in_parts or tuple(model.system.window) == (0, model.system.q.size)
    (part, q), (whole, expected) = rests
    assert np.abs(q - expected).max() < 1e-11
    # in the vertical part the string peels off the wall lump by lump
    assert whole.iterations > 50 and part.iterations < whole.iterations / 3
