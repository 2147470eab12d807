"""Rigid bodies that turn.

A body's attitude is a quaternion Q of four free unknowns (quaternion.py), N = Q.Q. The angular velocity in the body's
axes,

    w = 2 G(Q) Q. / N,

depends on the direction of Q alone: so does T = w.J w / 2, and Lagrange's equations of it are Euler's, turned back by
2 G^T / N. The norm, which would have neither mass nor stiffness, gets both of its own,

    T_n = m N.^2 / 2,   V_n = m f^2 (N - 1)^2 / 2,   m the mean of J.

N is a harmonic oscillator of frequency f that nothing drives and that drives nothing: no motion of the body depends on
it, and there is no multiplier.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.geometry.quaternion import QUATERNION, into_body, out_of_body, product
from crane.groups.masses import supply_of_release
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

FREQUENCY = 50.0
"""Of the norm of a quaternion, rad/s, unless a row says otherwise."""
RIGID = np.dtype(
    [
        ("place", "i8"), ("turn", "i8"), ("inertia", "f8", (3,)), ("remaining", "f8", (3,)), ("released", "f8"),
        ("frequency", "f8"),
    ]
)  # fmt: skip
"""A body: where its centre of mass and its quaternion begin, principal moments kg m^2, what remains of them from a time
(s) on, infinite once that is past, and the frequency of the norm rad/s."""


class Rigids(NamedTuple):
    """Rotation of bodies (n,) of ``RIGID``; ``vector`` (10, 4), ``number`` (4,) and ``block`` (4, 4) are scratch.

    ``inertia`` (n, 3) is what each has in the step under way, ``kept`` (n, 3) what it had after the last, and
    ``let_go`` (n, 2) W as in `crane.groups.masses.Bodies`: a load that is released takes its rotation with it.
    Mass, weight and drag of the centre belong to other groups. ``steady`` (n,) N m is added to the tangent, and to no
    moment, while rest is sought: where nothing resists a turn, as about the rope, the body then stays as it is drawn.
    """

    rows: np.recarray
    inertia: np.ndarray
    kept: np.ndarray
    let_go: np.ndarray
    steady: np.ndarray
    vector: np.ndarray
    number: np.ndarray
    block: np.ndarray


SPIN, MOMENTUM, SPIN_D, TORQUE, CHANGE, D_SPIN, D_MOMENTUM, D_SPIN_D, D_TORQUE, TURNED = range(10)
NORM, NORM_D, NORM_DD, MASS = range(4)


@kernel
def _add_cross(a, b, out):
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@kernel
def _find_spin(g, n, q, v):
    """N and its rate, angular velocity and angular momentum in the body's axes."""
    b, x, number = g.rows[n], g.vector, g.number
    norm = product(q, b.turn, q, b.turn)
    number[NORM], number[NORM_D] = norm, 2.0 * product(q, b.turn, v, b.turn)
    number[MASS] = (g.inertia[n, 0] + g.inertia[n, 1] + g.inertia[n, 2]) / 3.0
    into_body(q, b.turn, v, b.turn, x[SPIN])
    for c in range(AXES):
        x[SPIN, c] *= 2.0 / norm
        x[MOMENTUM, c] = g.inertia[n, c] * x[SPIN, c]


@kernel
def _find_torque(g, n, q, v, a):
    """The torque J w. + w x J w that the motion takes, and the second rate of N."""
    b, x, number = g.rows[n], g.vector, g.number
    number[NORM_DD] = 2.0 * (product(q, b.turn, a, b.turn) + product(v, b.turn, v, b.turn))
    into_body(q, b.turn, a, b.turn, x[SPIN_D])
    for c in range(AXES):
        # G(Q.) Q. is nothing, so that the second rate of Q is all there is.
        x[SPIN_D, c] = (2.0 * x[SPIN_D, c] - x[SPIN, c] * number[NORM_D]) / number[NORM]
        x[TORQUE, c] = g.inertia[n, c] * x[SPIN_D, c]
    _add_cross(x[SPIN], x[MOMENTUM], x[TORQUE])
    out_of_body(q, b.turn, x[TORQUE], x[TURNED])


@kernel
def _begin(g, t, h, beta, gamma, q, v, a):
    """A load drops at the beginning of a step, with its mass: one begins at its time, up to rounding."""
    for n in range(g.rows.size):
        b = g.rows[n]
        g.let_go[n, 0] = g.let_go[n, 1] = 0.0
        drops = beta >= 0.0 and t + 0.5 * h >= b.released
        for c in range(AXES):
            g.inertia[n, c] = b.remaining[c] if drops else g.kept[n, c]
        if drops and h > 0.0 and gamma >= 0.0:
            _find_spin(g, n, q, v)
            energy = 0.0
            for c in range(AXES):
                energy += 0.5 * (g.kept[n, c] - g.inertia[n, c]) * g.vector[SPIN, c] ** 2
            g.let_go[n, 1 if beta > 0.0 else 0] = 2.0 * energy / h


@kernel
def _commit(g, t, h, q, v, a):
    if h == 0.0:
        return
    for n in range(g.rows.size):
        for c in range(AXES):
            if g.inertia[n, c] != g.kept[n, c]:
                # It happens once.
                g.rows[n].released = np.inf
            g.kept[n, c] = g.inertia[n, c]


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        b, number = g.rows[n], g.number
        _find_spin(g, n, q, v)
        _find_torque(g, n, q, v, a)
        kept = 2.0 * number[MASS] * (number[NORM_DD] + b.frequency * b.frequency * (number[NORM] - 1.0))
        for k in range(QUATERNION):
            r[b.turn + k] += 2.0 / number[NORM] * g.vector[TURNED, k] + kept * q[b.turn + k]


@kernel
def _vary_torque(g, n, q, v, a, column, cm, cc, ck):
    """Changes of spin and torque along one degree of freedom: position ck, velocity cc, acceleration cm."""
    b, x, number = g.rows[n], g.vector, g.number
    norm, norm_d, j = number[NORM], number[NORM_D], b.turn
    d_norm = 2.0 * ck * q[j + column]
    d_norm_d = 2.0 * (ck * v[j + column] + cc * q[j + column])
    # The change of Q, Q. and Q.. is along one axis u: G(u) Q. ck + G(Q) u cc, in which G(Q) u = -G(u) Q.
    change, spin, rate = x[CHANGE], x[D_SPIN], x[D_SPIN_D]
    change.fill(0.0)
    change[column] = 1.0
    into_body(change, 0, q, j, x[D_TORQUE])
    into_body(change, 0, v, j, spin)
    into_body(change, 0, a, j, rate)
    for c in range(AXES):
        by_unit = x[D_TORQUE, c]
        spin[c] = (2.0 * (ck * spin[c] - cc * by_unit) - x[SPIN, c] * d_norm) / norm
        rate[c] = 2.0 * (ck * rate[c] - cm * by_unit) - spin[c] * norm_d - x[SPIN, c] * d_norm_d
        rate[c] = (rate[c] - x[SPIN_D, c] * d_norm) / norm
        x[D_MOMENTUM, c] = g.inertia[n, c] * spin[c]
        x[D_TORQUE, c] = g.inertia[n, c] * rate[c]
    _add_cross(spin, x[MOMENTUM], x[D_TORQUE])
    _add_cross(x[SPIN], x[D_MOMENTUM], x[D_TORQUE])


@kernel
def _vary(g, n, q, v, a, column, cm, cc, ck):
    """Write one column of a body's tangent."""
    b, x, number, block = g.rows[n], g.vector, g.number, g.block
    j, norm, stiffness = b.turn, number[NORM], b.frequency * b.frequency
    _vary_torque(g, n, q, v, a, column, cm, cc, ck)
    d_norm = 2.0 * ck * q[j + column]
    d_norm_dd = 2.0 * (ck * a[j + column] + cm * q[j + column]) + 4.0 * cc * v[j + column]
    kept = 2.0 * number[MASS] * (number[NORM_DD] + stiffness * (norm - 1.0))
    d_kept = 2.0 * number[MASS] * (d_norm_dd + stiffness * d_norm)
    for k in range(QUATERNION):
        block[k, column] = d_kept * q[j + k] - 2.0 / (norm * norm) * d_norm * x[TURNED, k]
    block[column, column] += ck * (kept + g.steady[n])
    out_of_body(q, j, x[D_TORQUE], x[D_SPIN])
    out_of_body(x[CHANGE], 0, x[TORQUE], x[D_SPIN_D])
    for k in range(QUATERNION):
        block[k, column] += 2.0 / norm * (x[D_SPIN, k] + ck * x[D_SPIN_D, k])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        _find_spin(g, n, q, v)
        _find_torque(g, n, q, v, a)
        for column in range(QUATERNION):
            _vary(g, n, q, v, a, column, cm, cc, ck)
        add_block(matrix, dofs, g.rows[n].turn, 0, QUATERNION, g.block)


@kernel
def _mass(g, q, matrix, dofs):
    """4 G^T J G / N^2 + 4 m Q Q^T."""
    x = g.vector
    for n in range(g.rows.size):
        b = g.rows[n]
        norm = product(q, b.turn, q, b.turn)
        mean = (g.inertia[n, 0] + g.inertia[n, 1] + g.inertia[n, 2]) / 3.0
        for column in range(QUATERNION):
            x[CHANGE].fill(0.0)
            x[CHANGE, column] = 1.0
            into_body(q, b.turn, x[CHANGE], 0, x[MOMENTUM])
            for c in range(AXES):
                x[MOMENTUM, c] *= 4.0 * g.inertia[n, c] / (norm * norm)
            out_of_body(q, b.turn, x[MOMENTUM], x[TURNED])
            for k in range(QUATERNION):
                g.block[k, column] = x[TURNED, k] + 4.0 * mean * q[b.turn + k] * q[b.turn + column]
        add_block(matrix, dofs, b.turn, 0, QUATERNION, g.block)


@kernel
def _energy(g, t, q, v, e):
    for n in range(g.rows.size):
        _find_spin(g, n, q, v)
        x, number, f = g.vector, g.number, g.rows[n].frequency
        for c in range(AXES):
            e[0] += 0.5 * x[SPIN, c] * x[MOMENTUM, c]
        e[0] += 0.5 * number[MASS] * number[NORM_D] ** 2
        e[1] += 0.5 * number[MASS] * (f * (number[NORM] - 1.0)) ** 2


register(
    Rigids, begin=_begin, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, supply=supply_of_release,
    commit=_commit, lengths=lambda g: [np.arange(turn, turn + QUATERNION) for turn in g.rows["turn"]],
)  # fmt: skip


def new_rigids(rows: np.recarray) -> Rigids:
    """Group of rotating bodies with its scratch."""
    inertia = np.array(rows["inertia"], dtype=float)
    return Rigids(
        rows, inertia, inertia.copy(), np.zeros((len(rows), 2)), np.zeros(len(rows)), np.zeros((10, 4)), np.zeros(4),
        np.zeros((4, 4)),
    )  # fmt: skip
