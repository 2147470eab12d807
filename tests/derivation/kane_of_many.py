"""The whole string by one KanesMethod: all bodies at once, from their positions in the earth's frame.

Nothing is taken from ``tautline.lumped.derive``: the Bishop frame of one arc is written as a rotation of the earth's
frame about a fixed axis, velocities are derivatives of positions, weights are loads along the vertical, and links and
bends are the derivatives of the total energy of all of them, by complex steps: what has no inertia needs no algebra. It
grows beyond use with the number of bodies; three are enough to see that one body, one link and one bend, looped over,
are the same equations.
"""

import itertools
from typing import NamedTuple

import numpy as np
import sympy as sp
from sympy.physics import mechanics as me


class Numbers(NamedTuple):
    """Of n bodies and n - 1 links: as in the kernels' records, SI; ``down`` (3,) in the frame at s = 0 of the arc."""

    k1: float
    k2: float
    down: np.ndarray
    place: np.ndarray
    mass: np.ndarray
    polar: np.ndarray
    transverse: np.ndarray
    lateral_mass: np.ndarray
    weight: np.ndarray
    damping: np.ndarray
    e: np.ndarray
    axial: np.ndarray
    torsional: np.ndarray
    bending: np.ndarray
    link_damping: float


STEP = 1e-30
"""Of a derivative by a complex step, which is exact to rounding."""


def gradient(function, x):
    """Derivatives of a function of an array of numbers."""
    steps = np.eye(x.size).reshape(-1, *x.shape) * STEP * 1j
    return np.array([function(x + step).imag for step in steps]).reshape(x.shape) / STEP


def stretches(numbers, q):
    """Vectors of the links in the frame of the hole, corrected for offsets inside the bend, and their lengths."""
    k = numbers.k1, numbers.k2
    vectors = []
    for (s1, u1, v1, _), (s2, u2, v2, _) in itertools.pairwise(q):
        inside = (k[0] * (u1 + u2) + k[1] * (v1 + v2)) * (s2 - s1) / 2
        vectors.append(np.array([s2 - s1 - inside, u2 - u1, v2 - v1]))
    return vectors, [np.sqrt(d @ d) for d in vectors]


def strain_energy(numbers, q):
    """Total strain energy of stretching, torsion and bending."""
    vectors, lengths = stretches(numbers, q)
    rest = np.diff(numbers.place)
    total = sum(
        numbers.axial[i] * (lengths[i] - rest[i]) ** 2 / 2 + numbers.torsional[i] * (q[i + 1][3] - q[i][3]) ** 2 / 2
        for i in range(len(lengths))
    )
    for i in range(len(lengths) - 1):
        turned = [k * (q[i + 2][0] - q[i][0]) / 2 for k in (numbers.k1, numbers.k2)]
        bend = vectors[i + 1] / lengths[i + 1] - vectors[i] / lengths[i] + np.array([0, *turned])
        total += numbers.bending[i] * (bend @ bend) / 2
    return total


def dissipation(numbers, q, w):
    """Rayleigh's function of bodies and links: half the power that they take."""
    total = np.sum(numbers.damping * w**2) / 2
    for i in range(len(q) - 1):
        rate = np.sum(gradient(lambda x, i=i: stretches(numbers, x)[1][i], q) * w)
        total += numbers.link_damping * numbers.axial[i] * rate**2 / 2
        total += numbers.link_damping * numbers.torsional[i] * (w[i + 1][3] - w[i][3]) ** 2 / 2
    return total


def equations(numbers):
    """A function (q, w) -> mass matrix (4 n, 4 n) and forcing (4 n,), q with measured depth s in place of x."""
    n, t = numbers.mass.size, me.dynamicsymbols._t
    q = [me.dynamicsymbols(f"s{i} u{i} v{i} th{i}") for i in range(n)]
    w = [me.dynamicsymbols(f"ws{i} wu{i} wv{i} wth{i}") for i in range(n)]
    flat_q, flat_w = [x for body in q for x in body], [x for body in w for x in body]
    earth, origin = me.ReferenceFrame("N"), me.Point("O")
    origin.set_vel(earth, 0)
    k = float(np.hypot(numbers.k1, numbers.k2))
    n1, n2 = numbers.k1 / k, numbers.k2 / k
    axis = -n2 * earth.x + n1 * earth.y
    down = sum(g * e for g, e in zip(numbers.down, (earth.x, earth.y, earth.z), strict=True))
    bodies, loads = [], []

    rates = dict(zip([x.diff(t) for x in flat_q], flat_w, strict=True))
    for i in range(n):
        s, u, v, theta = q[i]
        bishop, steel = me.ReferenceFrame(f"B{i}"), me.ReferenceFrame(f"R{i}")
        bishop.orient_axis(earth, axis, k * s)
        steel.orient_axis(bishop, bishop.z, theta)
        along = (n1 * earth.x + n2 * earth.y) * (1 - sp.cos(k * s)) / k + earth.z * sp.sin(k * s) / k
        e1, e2 = numbers.e[i]
        centre = origin.locatenew(f"C{i}", along + u * bishop.x + v * bishop.y + e1 * steel.x + e2 * steel.y)
        centre.set_vel(earth, centre.pos_from(origin).dt(earth))
        inertia = me.inertia(steel, numbers.transverse[i], numbers.transverse[i], numbers.polar[i])
        bodies.append(me.RigidBody(f"body{i}", centre, steel, numbers.mass[i], (inertia, centre)))
        loads.append((centre, numbers.weight[i] * down))
    kane = me.KanesMethod(earth, flat_q, flat_w, kd_eqs=[x.diff(t) - y for x, y in zip(flat_q, flat_w, strict=True)])
    kane.kanes_equations(bodies, loads=loads)
    plain = sp.symbols(f"x0:{8 * n}")
    names = dict(zip([*flat_w, *flat_q], [*plain[4 * n :], *plain[: 4 * n]], strict=True))
    both = [part.xreplace(rates).xreplace(names) for part in (kane.mass_matrix, kane.forcing)]
    function = sp.lambdify(plain, both, "numpy", cse=True)
    # What follows the lateral motion only.
    lateral = np.diag(np.outer(numbers.lateral_mass, [0.0, 1.0, 1.0, 0.0]).ravel())

    def evaluate(position, speed):
        mass, forcing = function(*position, *speed)
        at, moving = position.reshape(n, 4), speed.reshape(n, 4)
        stiff = gradient(lambda x: strain_energy(numbers, x), at)
        lost = gradient(lambda x: dissipation(numbers, at, x), moving)
        return np.asarray(mass) + lateral, np.asarray(forcing).ravel() - (stiff + lost).ravel()

    return evaluate
