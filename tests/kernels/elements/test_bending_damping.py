"""Damping of bending without spin against its definition: complex steps of the curvature vector, no formula shared."""

import numpy as np
import pytest
from kernels.elements import cable_groups as rope
from kernels.elements.cable_groups import CUBIC, SHAPES, ask, close, new_state, parts

from tautline.elements.beam.bending_damping import VISCOUS, BendingDamping
from tautline.kernels.hermite import gauss, table
from tautline.system.records import records_of

STEP = 1e-40
VISCOSITY = (0.28, 0.06)
POINTS = gauss(3)


def group():
    rows = [ends | {"viscosity": c} for ends, c in zip(rope._ends(CUBIC), VISCOSITY, strict=True)]
    scratch = np.zeros((2, 4)), np.zeros((4, 6)), np.zeros((2, 3, 6)), np.zeros((6, 6)), np.zeros((12, 12))
    return BendingDamping(records_of(VISCOUS, rows), table(*POINTS), *scratch)


def curvature(z):
    """The principal normal times the curvature, of z = (r', r'')."""
    e, b = z[:3], z[3:]
    return b / (e @ e) - e * (e @ b) / (e @ e) ** 2


def jacobian(function, x):
    return np.array([function(x + 1j * STEP * unit).imag / STEP for unit in np.eye(x.size)]).T


def shapes(x, length):
    """N' and N'' of the cubic (2, 4) from its polynomials."""
    first = [6 * x * x - 6 * x, 1 - 4 * x + 3 * x * x, 6 * x - 6 * x * x, 3 * x * x - 2 * x]
    second = [12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2]
    return np.array([[y * length ** (k % 2 - 1) for k, y in enumerate(first)],
                     [y * length ** (k % 2 - 2) for k, y in enumerate(second)]])  # fmt: skip


def definition(state):
    """Force (n,) and power lost, from w = P dc/dt and its derivative by the rates."""
    force, power = np.zeros(state.q.size), 0.0
    for e, viscosity in enumerate(VISCOSITY):
        rows = rope.rows_of(CUBIC, e)
        q, v = state.q[rows], state.v[rows]
        length = q[13] - q[6]
        x, dx = (y[[0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12]].reshape(4, 3) for y in (q, v))
        for place, weight in zip(*POINTS, strict=True):
            s = shapes(place, length)
            z, rate = (s @ x).ravel(), (s @ dx).ravel()
            t = z[:3] / np.linalg.norm(z[:3])
            by_rate = (np.eye(3) - np.outer(t, t)) @ jacobian(curvature, z)
            w = by_rate @ rate
            push = viscosity * weight * length * (by_rate.T @ w).reshape(2, 3)
            nodal = (s.T @ push).ravel()
            force[rows[[0, 1, 2, 3, 4, 5, 7, 8, 9, 10, 11, 12]]] += nodal
            power += viscosity * weight * length * (w @ w)
    return force, power


@pytest.mark.parametrize("shape", [s for s in SHAPES if s != "fast flow"])
def test_force_and_power_are_those_of_the_definition(shape):
    for seed in range(3):
        state = new_state(CUBIC, shape, still=True, seed=seed)
        answer = ask(group(), state)
        force, power = definition(state)
        assert close(answer.residual, force, 1e-10)
        assert answer.power[0] == pytest.approx(power, rel=1e-10)
        assert not answer.energy.any()


@pytest.mark.parametrize("shape", ["anyhow", "straight", "folded", "strongly bent"])
def test_the_tangent_is_the_difference_of_the_force(shape):
    state = new_state(CUBIC, shape, still=True)
    keep = np.ones(state.q.size, dtype=bool)
    keep[rope.materials(CUBIC)] = False
    made = parts(group(), state)
    assert not made[0].any()
    for part, field in ((made[1], "v"), (made[2], "q")):
        slope = rope.derivative(
            lambda x, f=field: rope.residual(group(), state._replace(**{f: x})), getattr(state, field)
        )
        assert close(part[np.ix_(keep, keep)], slope[np.ix_(keep, keep)], 1e-7), field


def turned(axis, shape):
    """A curve that turns as a whole."""
    state = new_state(CUBIC, shape, still=True)
    v = np.zeros_like(state.q)
    for start in rope.STARTS[CUBIC]:
        for place in (start, start + 3):
            v[place : place + 3] = np.cross(axis, state.q[place : place + 3])
    return state._replace(v=v)


def test_turning_as_a_whole_costs_nothing_without_spin():
    # a straight curve about any axis; a plane one about the plane's normal
    assert ask(group(), turned((0.3, -1.2, 0.7), "straight")).power[0] < 1e-25
    state = turned((0.0, 0.0, 1.5), "strongly bent")
    flat = state.q.copy()
    for start in rope.STARTS[CUBIC]:
        flat[start + 2] = flat[start + 5] = 0.0
    v = np.zeros_like(flat)
    for start in rope.STARTS[CUBIC]:
        for place in (start, start + 3):
            v[place : place + 3] = np.cross((0.0, 0.0, 1.5), flat[place : place + 3])
    assert ask(group(), state._replace(q=flat, v=v)).power[0] < 1e-25


def test_a_straight_rope_is_damped_alike_in_both_planes():
    state = new_state(CUBIC, "straight", still=True)
    along = state.q[rope.STARTS[CUBIC][0] + 3 :][:3]
    along = along / np.linalg.norm(along)
    side = np.cross(along, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side)
    power = []
    for axis in (side, np.cross(along, side)):
        v = np.zeros_like(state.q)
        for start, (speed, slope) in zip(rope.STARTS[CUBIC], ((0.0, 0.1), (0.3, -0.2), (-0.1, 0.5)), strict=True):
            v[start : start + 3], v[start + 3 : start + 6] = speed * axis, slope * axis
        power.append(ask(group(), state._replace(v=v)).power[0])
    assert power[0] > 1e-4
    assert power[0] == pytest.approx(power[1], rel=1e-12)
