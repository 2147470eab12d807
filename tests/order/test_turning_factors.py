"""Factors that turn with a rope's nodes: what they solve, for whom, and how few have to be made."""

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, model_of, scene, straight
from scipy.sparse.linalg import splu

from tautline.integrators.corrector.rows import STRIP
from tautline.integrators.corrector.turning import Fixed, Turning, face, to_faced, to_turned, turn, turning_of
from tautline.kernels.jit import entry
from tautline.live.simulation import Simulation
from tautline.simulation import simulate

BETA, GAMMA = 1.0e6, 1.0e3
"""How acceleration and velocity follow position in a step of a millisecond, 1/s^2 and 1/s."""


@entry
def _faces(turning, full):
    face(turning, full)


@entry
def _turns(turning, full):
    turn(turning, full)


@entry
def _turn_to_faced(turning, x):
    to_faced(turning, x)


@entry
def _turn_to_turned(turning, x):
    to_turned(turning, x)


def _arc(n=12, length=6.0):
    """A rope along an arc in the plane of x and z, pinned at the origin: places and material coordinates."""
    p = np.linspace(0.0, length, n + 1)
    angle = 0.3 * p
    return np.column_stack((np.sin(angle), 0.0 * p, np.cos(angle) - 1.0)) / 0.3, p


def _about_y(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


@pytest.mark.parametrize("angle", [0.01, 0.7, -1.5])
def test_solutions_by_turned_factors_are_those_of_the_rope_that_has_turned(angle):
    xyz, p = _arc()
    sim = Simulation(scene(chain(xyz, p, {0: PINNED}, EA=1.0e5, EJ=3.0)))
    equations, system = sim.equations, model_of(chain(xyz, p, {0: PINNED}, EA=1.0e5, EJ=3.0)).system
    turning = turning_of(system)
    assert turning.slope.size == 13
    t, q, v, a = *equations.state(), np.zeros(equations.size)
    rotation = _about_y(angle)
    turned = (q.reshape(-1, 3) @ rotation.T).ravel()
    full = np.array(system.q)
    full[system.dofs.free] = q
    _faces(turning, full)
    full[system.dofs.free] = turned
    _turns(turning, full)
    b = np.random.default_rng(3).normal(size=q.size)
    x = b.copy()
    _turn_to_faced(turning, x)
    x = splu(equations.tangent(t, q, v, a, BETA, GAMMA, 1.0).tocsc()).solve(x)
    _turn_to_turned(turning, x)
    exact = splu(equations.tangent(t, turned, v, a, BETA, GAMMA, 1.0).tocsc()).solve(b)
    np.testing.assert_allclose(x, exact, rtol=0.0, atol=1e-9 * np.abs(exact).max())
    # As they were the factors are of no use to the rope that has turned.
    if abs(angle) > 0.5:
        stale = splu(equations.tangent(t, q, v, a, BETA, GAMMA, 1.0).tocsc()).solve(b)
        assert np.abs(stale - exact).max() > 0.1 * np.abs(exact).max()


def test_what_was_just_made_is_solved_with_as_it_is():
    turning = turning_of(model_of(chain(*_arc(), {0: PINNED}, EA=1.0e5, EJ=3.0)).system)
    _faces(turning, np.random.default_rng(1).normal(size=200))
    x = np.arange(75.0)
    _turn_to_faced(turning, x)
    _turn_to_turned(turning, x)
    np.testing.assert_array_equal(x, np.arange(75.0))


@pytest.mark.parametrize("slope", [(-1.0, 0.0, 0.0), (-0.2, 0.0, 5.0), (0.0, 0.0, 0.0)], ids=["back", "far", "none"])
def test_a_node_that_turned_by_more_than_a_right_angle_is_solved_for_as_it_was(slope):
    xyz, p = straight((0.0, 0.0, 0.0), (3.0, 0.0, 0.0), 3), np.arange(4.0)
    system = model_of(chain(xyz, p, {0: PINNED}, EA=1.0e5, EJ=3.0)).system
    turning, full = turning_of(system), np.array(system.q)
    _faces(turning, full)
    full[system.slopes[2] : system.slopes[2] + 3] = slope
    _turns(turning, full)
    x = np.random.default_rng(2).normal(size=system.size)
    before = x.copy()
    _turn_to_faced(turning, x)
    np.testing.assert_array_equal(x, before)


def test_a_node_that_is_held_in_one_axis_does_not_turn_and_a_line_of_bars_has_none_that_does():
    xyz, p = _arc(4)
    planar = (0, 1, 0, 0, 1, 0, 1)
    turning = turning_of(model_of(chain(xyz, p, {0: PINNED, 2: planar}, EA=1.0e5, EJ=3.0)).system)
    assert isinstance(turning, Turning)
    assert turning.slope.size == 4  # three nodes with r and r', and the slope of the pinned one
    bars = chain(xyz, p, {0: (1, 1, 1, 0, 0, 0, 1)}, EA=1.0e5, linear=True)
    assert isinstance(turning_of(model_of(bars).system), Fixed)


def test_a_rope_that_swings_keeps_its_factors_for_hundreds_of_steps():
    xyz, p = straight((0.0, 0.0, 0.0), (24.0, 0.0, -32.0), 40), np.linspace(0.0, 40.0, 41)
    items = chain(xyz, p, {0: PINNED}, EA=1.0e5, EJ=1.0)
    run = simulate(model_of(items, time_step=0.001, time_end=1.0, rho_inf=0.8, plotpoints=10.0))
    assert np.abs(np.asarray(run["position"])[-1] - np.asarray(run["position"])[0]).max() > 2.0
    assert run.attributes["factorisations"] <= 10  # 60 as they were
    full = simulate(model_of(items, time_step=0.001, time_end=1.0, rho_inf=0.8, plotpoints=10.0, newton="full"))
    np.testing.assert_allclose(run["position"], full["position"], rtol=0.0, atol=1e-6)


def test_full_vectors_are_the_unknowns_of_a_rope_of_several_strips_after_every_step():
    n = 600
    assert 6 * n > 2 * STRIP
    xyz, p = straight((0.0, 0.0, 0.0), (60.0, 0.0, 0.0), n), np.linspace(0.0, 60.0, n + 1)
    sim = Simulation(scene(chain(xyz, p, {0: PINNED}, EA=1.0e5, EJ=3.0)))
    state, free = sim.parts.state, sim.model.system.dofs.free
    for _ in range(3):
        sim.advance(0.01)
        assert np.abs(state.v).max() > 0.0
        for reduced, full in ((state.q, state.full_q), (state.v, state.full_v), (state.a, state.full_a)):
            np.testing.assert_array_equal(full[free], reduced)
