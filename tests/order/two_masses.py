"""A small nonlinear problem for the integrators: mass and damping depend on the state, one coordinate is prescribed.

    M(q) a + c(q, v) + k(q) = f(t),   q = (x, y, z),   z(t) given

as a group of compiled kernels, and once more in plain numpy for a reference by DOP853.
"""

import sys
from typing import NamedTuple

import numpy as np
from numba import cloudpickle
from scipy.integrate import solve_ivp

from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.scene.functions import Harmonic
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import FunctionRequest, compile_functions

AMPLITUDE, PERIOD = 0.3, 2.5
START = np.array([0.6, -0.4, 0.1])
VELOCITY = np.array([0.5, 0.8])


# What is compiled for this group goes into the cache with the class itself, not with its name: the class would not be
# found by the next run of a program, and the machine code would outlive a change of this file.
cloudpickle.register_pickle_by_value(sys.modules[__name__])


class TwoMasses(NamedTuple):
    """The problem's left side; ``block`` is zeros (3, 3)."""

    block: np.ndarray


@kernel
def _write_mass(block, x, y):
    block[0, 0] = 2.0 + 0.5 * np.sin(x)
    block[1, 1] = 1.5 + 0.3 * x * x
    block[2, 2] = 1.0
    block[0, 1] = 0.4 * np.cos(y)
    block[1, 0] = block[0, 1]
    block[0, 2] = 0.3 + 0.1 * x
    block[2, 0] = block[0, 2]
    block[1, 2] = 0.2 * y
    block[2, 1] = block[1, 2]


@kernel
def _add(block, matrix, dofs):
    for i in range(3):
        for j in range(3):
            add_entry(matrix, dofs, i, j, block[i, j])


@kernel
def _residual(g, t, q, v, a, r):
    x, y, z = q[0], q[1], q[2]
    _write_mass(g.block, x, y)
    for i in range(3):
        for j in range(3):
            r[i] += g.block[i, j] * a[j]
    r[0] += (0.3 + 0.2 * y * y) * v[0] + 0.1 * v[0] * v[1]
    r[1] += 0.2 * (1.0 + x * x) * v[1] * np.sqrt(1.0 + v[1] * v[1])
    r[0] += 4.0 * x + 2.0 * x**3 + 1.5 * (x - y) + 2.5 * (x - z) - np.sin(3.0 * t)
    r[1] += 3.0 * np.sin(y) - 1.5 * (x - y) - 0.5 * np.cos(2.0 * t)
    r[2] += 2.5 * (z - x)


@kernel
def _mass(g, q, matrix, dofs):
    _write_mass(g.block, q[0], q[1])
    _add(g.block, matrix, dofs)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    x, y = q[0], q[1]
    b = g.block
    _write_mass(b, x, y)
    for i in range(3):
        for j in range(3):
            b[i, j] *= cm
    b[0, 0] += cc * (0.3 + 0.2 * y * y + 0.1 * v[1])
    b[0, 1] += cc * 0.1 * v[0]
    root = np.sqrt(1.0 + v[1] * v[1])
    b[1, 1] += cc * 0.2 * (1.0 + x * x) * (root + v[1] * v[1] / root)
    b[0, 0] += ck * (0.5 * np.cos(x) * a[0] + 0.1 * a[2] + 8.0 + 6.0 * x * x)
    b[0, 1] += ck * (-0.4 * np.sin(y) * a[1] + 0.4 * y * v[0] - 1.5)
    b[0, 2] -= ck * 2.5
    b[1, 0] += ck * (0.6 * x * a[1] + 0.4 * x * v[1] * root - 1.5)
    b[1, 1] += ck * (-0.4 * np.sin(y) * a[0] + 0.2 * a[2] + 3.0 * np.cos(y) + 1.5)
    b[2, 0] += ck * (0.1 * a[0] - 2.5)
    b[2, 1] += ck * 0.2 * a[1]
    b[2, 2] += ck * 2.5
    _add(b, matrix, dofs)


register(TwoMasses, residual=_residual, mass=_mass, tangent=_tangent)


def system():
    """The problem, compiled; z is prescribed and swings about its start."""
    functions = compile_functions([FunctionRequest(Harmonic(amplitude=AMPLITUDE, period=PERIOD))])
    degrees = Degrees(["x", "y", "z"], START.copy(), np.array([5.0, 5.0, 5.0]))
    degrees.prescribe(2, 0)
    every = [np.array([[0, 1, 2]])]
    return assemble((TwoMasses(np.zeros((3, 3))),), degrees, functions, np.append(VELOCITY, 0.0), every, every)


def forces(t, q, v):
    """Mass matrix and all but the inertia, in numpy and in other words than above."""
    x, y = q[:2]
    mass = np.array(
        [
            [2 + np.sin(x) / 2, 0.4 * np.cos(y), 0.3 + x / 10],
            [0.4 * np.cos(y), 1.5 + 0.3 * x**2, y / 5],
            [0.3 + x / 10, y / 5, 1],
        ]
    )
    stiffness = np.array([[8.0, -1.5, -2.5], [-1.5, 1.5, 0.0], [-2.5, 0.0, 2.5]])
    springs = stiffness @ q + np.array([2 * x**3, 3 * np.sin(y), 0])
    dampers = np.array([v[0] * (0.3 + y**2 / 5 + v[1] / 10), (1 + x**2) * v[1] * np.hypot(1, v[1]) / 5, 0])
    return mass, springs + dampers - np.array([np.sin(3 * t), np.cos(2 * t) / 2, 0])


def motion(t):
    """Position, velocity, acceleration of z."""
    w = 2 * np.pi / PERIOD
    return START[2] + AMPLITUDE * np.sin(w * t), AMPLITUDE * w * np.cos(w * t), -AMPLITUDE * w**2 * np.sin(w * t)


def accelerations(t, q, v):
    """Accelerations of x and y, and the force that moves z, for (2,) q and v."""
    z, rate, second = motion(t)
    mass, rest = forces(t, np.append(q, z), np.append(v, rate))
    a = np.linalg.solve(mass[:2, :2], -rest[:2] - mass[:2, 2] * second)
    return a, mass[2] @ np.append(a, second) + rest[2]


def reference(end):
    """q, v, a of x and y and the force on z at time ``end``, good to about 1e-12."""

    def slope(t, state):
        return np.concatenate([state[2:], accelerations(t, state[:2], state[2:])[0]])

    start = np.concatenate([START[:2], VELOCITY])
    last = solve_ivp(slope, (0.0, end), start, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    a, force = accelerations(end, last[:2], last[2:])
    return last[:2], last[2:], a, force
