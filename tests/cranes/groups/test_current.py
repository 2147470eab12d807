"""Rope and bodies in a steady current: what they feel is what they would, moving the other way, in still water."""

from functools import cache

import numpy as np
import pytest
from cranes.groups.test_bodies_at_the_surface import ADDED as BODY_ADDED
from cranes.groups.test_bodies_at_the_surface import LOWEST, SURFACE
from cranes.groups.test_bodies_at_the_surface import WET as WET_LOADS
from cranes.groups.test_bodies_at_the_surface import group as still_body
from cranes.groups.test_bodies_at_the_surface import state as body_state
from cranes.groups.test_immersed_rope import ADDED, DENSITY, DIAMETER, DRAG, GRAVITY, WET_ONES, at, state
from cranes.hooks import Hooks

from crane.groups.current import carry, new_current, no_current
from crane.groups.hydrodynamics import WET, new_wet

FLOW = np.array([0.9, -0.4])
UNIFORM = (np.zeros(1), FLOW[None], 0.0)
SHEARED = (np.array([0.5, 2.0, 2.6]), np.array([[0.9, 0.1], [0.4, -0.3], [-0.2, 0.5]]), 0.0)
OF_ALL = np.array([*FLOW, 0.0, 0.0] * 2)
"""The current's velocity at both stations; nothing of it at their material."""


@cache
def rope(kind="still"):
    rows = np.zeros(1, WET).view(np.recarray)
    rows[0] = (0, 4, DIAMETER, DENSITY, DRAG, ADDED)
    current = {"still": no_current, "uniform": lambda: new_current(*UNIFORM), "sheared": lambda: new_current(*SHEARED)}
    return Hooks((new_wet(rows, 0.0, (0.0, 0.0, -GRAVITY), current=current[kind]()),), 8, [np.arange(8)])


@cache
def body(flows=False):
    made = still_body()
    return Hooks(
        (made._replace(current=new_current(np.zeros(1), FLOW[None], SURFACE)) if flows else made,), 3, [np.arange(3)]
    )


@pytest.mark.parametrize("heights", WET_ONES.values(), ids=WET_ONES)
def test_rope_in_a_current_feels_what_it_would_moving_the_other_way_in_still_water(heights):
    """Galilei's relativity: force, tangent and what is lost."""
    q, v, a = state(heights)
    assert rope("uniform").residual(q, v, a) == pytest.approx(rope().residual(q, v - OF_ALL, a), rel=1e-12, abs=1e-12)
    for weights in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        here, there = rope("uniform").tangent(q, v, a, *weights), rope().tangent(q, v - OF_ALL, a, *weights)
        assert here == pytest.approx(there, rel=1e-12, abs=1e-9)
    assert rope("uniform").powers(q, v)[0] == pytest.approx(rope().powers(q, v - OF_ALL)[0], rel=1e-12)


@pytest.mark.parametrize("lowest", LOWEST.values(), ids=LOWEST)
@pytest.mark.parametrize("sinking", [True, False], ids=["in", "out"])
def test_a_load_in_a_current_feels_what_it_would_moving_the_other_way_in_still_water(lowest, sinking):
    q, v, a = body_state(lowest, sinking)
    past = v - [*FLOW, 0.0]
    assert body(True).residual(q, v, a) == pytest.approx(body().residual(q, past, a), rel=1e-12, abs=1e-12)
    assert body(True).powers(q, v)[0] == pytest.approx(body().powers(q, past)[0], rel=1e-12, abs=1e-12)
    assert body(True).mass(q) == pytest.approx(body().mass(q)) and max(BODY_ADDED) > 0.0


@pytest.mark.parametrize("heights", WET_ONES.values(), ids=WET_ONES)
@pytest.mark.parametrize("kind", ["uniform", "sheared"])
def test_power_is_what_is_stored_and_lost_and_what_the_current_puts_in(heights, kind):
    assert rope(kind).imbalance(*state(heights), 1e-4) < 1e-7


@pytest.mark.parametrize("weights", [(1, 0, 0), (0, 1, 0), (0, 0, 1)], ids=["mass", "damping", "stiffness"])
@pytest.mark.parametrize("heights", WET_ONES.values(), ids=WET_ONES)
def test_the_tangent_of_rope_is_the_residuals_difference_where_a_current_changes_with_depth(heights, weights):
    h = 2e-5 if weights[2] else 1e-3
    assert rope("sheared").tangent_error(*state(heights), *weights, h=h) < 1e-7


@pytest.mark.parametrize("sinking", [True, False], ids=["in", "out"])
@pytest.mark.parametrize("lowest", WET_LOADS.values(), ids=WET_LOADS)
def test_power_of_a_load_is_what_is_stored_and_lost_and_what_the_current_puts_in(lowest, sinking):
    assert body(True).imbalance(*body_state(lowest, sinking), 1e-4) < 1e-6


def test_rope_at_rest_across_a_current_is_pushed_by_morisons_drag():
    q, still = at((0, 0, -1.0), (0, 0, -4.0), 0.0, 3.0), np.zeros(8)
    pushed = rope("uniform").residual(q, still, still) - rope().residual(q, still, still)
    speed = np.hypot(*FLOW)
    for c in (0, 1):
        force = 0.5 * DENSITY * DRAG * DIAMETER * speed * FLOW[c] * 3.0
        assert -(pushed[c] + pushed[4 + c]) == pytest.approx(force, rel=1e-6)
    assert pushed[[2, 3, 6, 7]] == pytest.approx(np.zeros(4), abs=1e-9)


def test_a_current_along_a_level_rope_neither_pushes_nor_works():
    q, still = at((0, 0, -2.0), (3 * 0.9, 3 * -0.4, -2.0), 0.0, 3.0), np.zeros(8)
    pushed = rope("uniform").residual(q, still, still) - rope().residual(q, still, still)
    assert pushed == pytest.approx(np.zeros(8), abs=1e-9)


@pytest.mark.parametrize(("z", "expected"), [
    (5.0, [0.9, 0.1]), (0.0, [0.9, 0.1]), (-0.5, [0.9, 0.1]), (-1.25, [0.65, -0.1]), (-2.0, [0.4, -0.3]),
    (-2.3, [0.1, 0.1]), (-2.6, [-0.2, 0.5]), (-400.0, [-0.2, 0.5]),
])  # fmt: skip
def test_between_two_depths_a_current_goes_along_straight_lines_and_beyond_them_it_is_constant(z, expected):
    current = new_current(*SHEARED)
    carry.py_func(current, z)
    assert current.flow == pytest.approx([*expected, 0.0])
