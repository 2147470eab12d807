"""Rigid bodies that turn, and sockets that tie a rope to a point of one.

A body's attitude is a quaternion Q = (s, x, y, z) of four free unknowns: R turns the body's axes into space by Q / |Q|,
and a vector o of the body is at R o = vec(Q o Q*) / N, N = Q.Q. The angular velocity in the body's axes,

    w = 2 G(Q) Q. / N,   G(Q) b = vec(Q* b),

depends on the direction of Q alone: so does T = w.J w / 2, and Lagrange's equations of it are Euler's, turned back by
2 G^T / N. The norm, which would have neither mass nor stiffness, gets both of its own,

    T_n = m N.^2 / 2,   V_n = m f^2 (N - 1)^2 / 2,   m the mean of J.

N is a harmonic oscillator of frequency f that nothing drives and that drives nothing: no motion of the body depends on
it, and there is no multiplier.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import NamedTuple

import numpy as np

from crane.line import AXES
from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

QUATERNION = 4
FREQUENCY = 50.0
"""Of the norm of a quaternion, rad/s, unless a row says otherwise."""

RIGID = np.dtype([("place", "i8"), ("turn", "i8"), ("inertia", "f8", (3,)), ("frequency", "f8")])
"""A body: where its centre of mass and its quaternion begin, principal moments kg m^2, frequency of the norm rad/s."""
SOCKET = np.dtype(
    [
        ("station", "i8"), ("place", "i8"), ("turn", "i8"), ("offset", "f8", (3,)), ("stiffness", "f8"),
        ("damping", "f8"),
    ]
)  # fmt: skip
"""A spring of no length with a damper: place of the rope's position; of the body's centre and quaternion; the point of
the body in its axes from its centre, m; N/m and N s/m, the same in every direction."""


class Rigids(NamedTuple):
    """Rotation of bodies (n,) of ``RIGID``; ``vector`` (10, 4), ``number`` (4,) and ``block`` (4, 4) are scratch.

    Mass, weight and drag of the centre belong to other groups.
    """

    rows: np.recarray
    vector: np.ndarray
    number: np.ndarray
    block: np.ndarray


SPIN, MOMENTUM, SPIN_D, TORQUE, CHANGE, D_SPIN, D_MOMENTUM, D_SPIN_D, D_TORQUE, TURNED = range(10)
NORM, NORM_D, NORM_DD, MASS = range(4)


@kernel
def _into_body(a, i, b, j, out):
    """G(a) b, of quaternions that begin at places i and j."""
    s, x, y, z = a[i], a[i + 1], a[i + 2], a[i + 3]
    out[0] = s * b[j + 1] - b[j] * x - (y * b[j + 3] - z * b[j + 2])
    out[1] = s * b[j + 2] - b[j] * y - (z * b[j + 1] - x * b[j + 3])
    out[2] = s * b[j + 3] - b[j] * z - (x * b[j + 2] - y * b[j + 1])


@kernel
def _out_of_body(a, i, b, out):
    """G(a)^T b (4,) of a vector b of the body."""
    s, x, y, z = a[i], a[i + 1], a[i + 2], a[i + 3]
    out[0] = -(x * b[0] + y * b[1] + z * b[2])
    out[1] = s * b[0] + y * b[2] - z * b[1]
    out[2] = s * b[1] + z * b[0] - x * b[2]
    out[3] = s * b[2] + x * b[1] - y * b[0]


@kernel
def _add_cross(a, b, out):
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@kernel
def _product(a, i, b, j):
    """Of two quaternions that begin at places i and j."""
    return a[i] * b[j] + a[i + 1] * b[j + 1] + a[i + 2] * b[j + 2] + a[i + 3] * b[j + 3]


@kernel
def _find_spin(g, n, q, v):
    """N and its rate, angular velocity and angular momentum in the body's axes."""
    b, x, number = g.rows[n], g.vector, g.number
    norm = _product(q, b.turn, q, b.turn)
    number[NORM], number[NORM_D] = norm, 2.0 * _product(q, b.turn, v, b.turn)
    number[MASS] = (b.inertia[0] + b.inertia[1] + b.inertia[2]) / 3.0
    _into_body(q, b.turn, v, b.turn, x[SPIN])
    for c in range(AXES):
        x[SPIN, c] *= 2.0 / norm
        x[MOMENTUM, c] = b.inertia[c] * x[SPIN, c]


@kernel
def _find_torque(g, n, q, v, a):
    """The torque J w. + w x J w that the motion takes, and the second rate of N."""
    b, x, number = g.rows[n], g.vector, g.number
    number[NORM_DD] = 2.0 * (_product(q, b.turn, a, b.turn) + _product(v, b.turn, v, b.turn))
    _into_body(q, b.turn, a, b.turn, x[SPIN_D])
    for c in range(AXES):
        # G(Q.) Q. is nothing, so that the second rate of Q is all there is.
        x[SPIN_D, c] = (2.0 * x[SPIN_D, c] - x[SPIN, c] * number[NORM_D]) / number[NORM]
        x[TORQUE, c] = b.inertia[c] * x[SPIN_D, c]
    _add_cross(x[SPIN], x[MOMENTUM], x[TORQUE])
    _out_of_body(q, b.turn, x[TORQUE], x[TURNED])


@kernel
def _rigid_residual(g, t, q, v, a, r):
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
    _into_body(change, 0, q, j, x[D_TORQUE])
    _into_body(change, 0, v, j, spin)
    _into_body(change, 0, a, j, rate)
    for c in range(AXES):
        by_unit = x[D_TORQUE, c]
        spin[c] = (2.0 * (ck * spin[c] - cc * by_unit) - x[SPIN, c] * d_norm) / norm
        rate[c] = 2.0 * (ck * rate[c] - cm * by_unit) - spin[c] * norm_d - x[SPIN, c] * d_norm_d
        rate[c] = (rate[c] - x[SPIN_D, c] * d_norm) / norm
        x[D_MOMENTUM, c] = b.inertia[c] * spin[c]
        x[D_TORQUE, c] = b.inertia[c] * rate[c]
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
    block[column, column] += ck * kept
    _out_of_body(q, j, x[D_TORQUE], x[D_SPIN])
    _out_of_body(x[CHANGE], 0, x[TORQUE], x[D_SPIN_D])
    for k in range(QUATERNION):
        block[k, column] += 2.0 / norm * (x[D_SPIN, k] + ck * x[D_SPIN_D, k])


@kernel
def _rigid_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        _find_spin(g, n, q, v)
        _find_torque(g, n, q, v, a)
        for column in range(QUATERNION):
            _vary(g, n, q, v, a, column, cm, cc, ck)
        add_block(matrix, dofs, g.rows[n].turn, 0, QUATERNION, g.block)


@kernel
def _rigid_mass(g, q, matrix, dofs):
    """4 G^T J G / N^2 + 4 m Q Q^T."""
    x = g.vector
    for n in range(g.rows.size):
        b = g.rows[n]
        norm = _product(q, b.turn, q, b.turn)
        mean = (b.inertia[0] + b.inertia[1] + b.inertia[2]) / 3.0
        for column in range(QUATERNION):
            x[CHANGE].fill(0.0)
            x[CHANGE, column] = 1.0
            _into_body(q, b.turn, x[CHANGE], 0, x[MOMENTUM])
            for c in range(AXES):
                x[MOMENTUM, c] *= 4.0 * b.inertia[c] / (norm * norm)
            _out_of_body(q, b.turn, x[MOMENTUM], x[TURNED])
            for k in range(QUATERNION):
                g.block[k, column] = x[TURNED, k] + 4.0 * mean * q[b.turn + k] * q[b.turn + column]
        add_block(matrix, dofs, b.turn, 0, QUATERNION, g.block)


@kernel
def _rigid_energy(g, t, q, v, e):
    for n in range(g.rows.size):
        _find_spin(g, n, q, v)
        x, number, f = g.vector, g.number, g.rows[n].frequency
        for c in range(AXES):
            e[0] += 0.5 * x[SPIN, c] * x[MOMENTUM, c]
        e[0] += 0.5 * number[MASS] * number[NORM_D] ** 2
        e[1] += 0.5 * number[MASS] * (f * (number[NORM] - 1.0)) ** 2


register(Rigids, residual=_rigid_residual, mass=_rigid_mass, tangent=_rigid_tangent, energy=_rigid_energy)


class Sockets(NamedTuple):
    """Sockets (n,) of ``SOCKET``.

    ``unit`` (4, 4) is the identity; ``lever`` (6, 3) holds R o, its four derivatives by the quaternion and its rate,
    ``curved`` (4, 4, 3) the second derivatives, ``pull`` (2, 3) the gap and the force across it; ``change`` (3,) and
    ``block`` (10, 10) are scratch.
    """

    rows: np.recarray
    unit: np.ndarray
    lever: np.ndarray
    curved: np.ndarray
    pull: np.ndarray
    change: np.ndarray
    block: np.ndarray


ARM, ARM_D = 0, 5
GAP, PULL = range(2)
WIDTH = 10
"""Degrees of freedom of a socket: the station's position, the centre, the quaternion."""


@kernel
def _place_of(s, i):
    """Where one of a socket's degrees of freedom is in the full vectors."""
    if i < AXES:
        return s.station + i
    return s.place + i - AXES if i < 2 * AXES else s.turn + i - 2 * AXES


@kernel
def _pair(o, a, i, b, j, out):
    """The symmetric bilinear form of two quaternions that is vec(Q o Q*) of one."""
    plain, along_a, along_b = a[i] * b[j], 0.0, 0.0
    for c in range(AXES):
        plain -= a[i + 1 + c] * b[j + 1 + c]
        along_a += a[i + 1 + c] * o[c]
        along_b += b[j + 1 + c] * o[c]
    x = a[i] * b[j + 1] + b[j] * a[i + 1]
    y = a[i] * b[j + 2] + b[j] * a[i + 2]
    z = a[i] * b[j + 3] + b[j] * a[i + 3]
    for c in range(AXES):
        out[c] = plain * o[c] + along_a * b[j + 1 + c] + along_b * a[i + 1 + c]
    out[0] += y * o[2] - z * o[1]
    out[1] += z * o[0] - x * o[2]
    out[2] += x * o[1] - y * o[0]


@kernel
def _reach(g, n, q, v):
    """Lever, gap and force of a socket. Returns N."""
    s, lever, pull = g.rows[n], g.lever, g.pull
    norm = _product(q, s.turn, q, s.turn)
    _pair(s.offset, q, s.turn, q, s.turn, lever[ARM])
    lever[ARM_D].fill(0.0)
    for c in range(AXES):
        lever[ARM, c] /= norm
    for k in range(QUATERNION):
        _pair(s.offset, q, s.turn, g.unit[k], 0, lever[1 + k])
        for c in range(AXES):
            lever[1 + k, c] = 2.0 * (lever[1 + k, c] - lever[ARM, c] * q[s.turn + k]) / norm
            lever[ARM_D, c] += lever[1 + k, c] * v[s.turn + k]
    for c in range(AXES):
        pull[GAP, c] = q[s.station + c] - q[s.place + c] - lever[ARM, c]
        rate = v[s.station + c] - v[s.place + c] - lever[ARM_D, c]
        pull[PULL, c] = s.stiffness * pull[GAP, c] + s.damping * rate
    return norm


@kernel
def _bend(g, n, q, norm):
    """Second derivatives of a socket's lever."""
    s, lever, curved = g.rows[n], g.lever, g.curved
    for k in range(QUATERNION):
        for l in range(QUATERNION):
            _pair(s.offset, g.unit[k], 0, g.unit[l], 0, curved[k, l])
            for c in range(AXES):
                other = lever[1 + k, c] * q[s.turn + l] + lever[1 + l, c] * q[s.turn + k] + lever[ARM, c] * g.unit[k, l]
                curved[k, l, c] = 2.0 * (curved[k, l, c] - other) / norm


@kernel
def _socket_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        s = g.rows[n]
        _reach(g, n, q, v)
        for c in range(AXES):
            r[s.station + c] += g.pull[PULL, c]
            r[s.place + c] -= g.pull[PULL, c]
            for k in range(QUATERNION):
                r[s.turn + k] -= g.lever[1 + k, c] * g.pull[PULL, c]


@kernel
def _vary_pull(g, n, v, column, cc, ck, out):
    """Write the change of a socket's force along one of its degrees of freedom: position ck, velocity cc."""
    s, lever = g.rows[n], g.lever
    by = ck * s.stiffness + cc * s.damping
    out.fill(0.0)
    if column < 2 * AXES:
        out[column % AXES] = by if column < AXES else -by
        return
    k = column - 2 * AXES
    for c in range(AXES):
        turned = 0.0
        for l in range(QUATERNION):
            turned += g.curved[k, l, c] * v[s.turn + l]
        out[c] = -by * lever[1 + k, c] - ck * s.damping * turned


@kernel
def _socket_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        s, change = g.rows[n], g.change
        _bend(g, n, q, _reach(g, n, q, v))
        for column in range(WIDTH):
            _vary_pull(g, n, v, column, cc, ck, change)
            for c in range(AXES):
                g.block[c, column] = change[c]
                g.block[AXES + c, column] = -change[c]
            for k in range(QUATERNION):
                x = 0.0
                for c in range(AXES):
                    x -= g.lever[1 + k, c] * change[c]
                    if column >= 2 * AXES:
                        x -= ck * g.curved[k, column - 2 * AXES, c] * g.pull[PULL, c]
                g.block[2 * AXES + k, column] = x
        for i in range(WIDTH):
            for j in range(WIDTH):
                add_entry(matrix, dofs, _place_of(s, i), _place_of(s, j), g.block[i, j])


@kernel
def _socket_energy(g, t, q, v, e):
    for n in range(g.rows.size):
        _reach(g, n, q, v)
        for c in range(AXES):
            e[1] += 0.5 * g.rows[n].stiffness * g.pull[GAP, c] ** 2


@kernel
def _socket_dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        s = g.rows[n]
        if s.damping > 0.0:
            _reach(g, n, q, v)
            for c in range(AXES):
                p[0] += s.damping * (v[s.station + c] - v[s.place + c] - g.lever[ARM_D, c]) ** 2


register(
    Sockets, residual=_socket_residual, tangent=_socket_tangent, energy=_socket_energy,
    dissipation=_socket_dissipation,
)  # fmt: skip


def new_rigids(rows: np.recarray) -> Rigids:
    """Group of rotating bodies with its scratch."""
    return Rigids(rows, np.zeros((10, 4)), np.zeros(4), np.zeros((4, 4)))


def new_sockets(rows: np.recarray) -> Sockets:
    """Group of sockets with its scratch."""
    return Sockets(
        rows, np.eye(4), np.zeros((6, 3)), np.zeros((4, 4, 3)), np.zeros((2, 3)), np.zeros(3),
        np.zeros((WIDTH, WIDTH)),
    )  # fmt: skip


def quaternion_of(orientation: Sequence[float]) -> np.ndarray:
    """Quaternion (4,) of ``Rz(yaw) Ry(pitch) Rx(roll)``, from roll, pitch and yaw, rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(0.5 * angle), sin(0.5 * angle)) for angle in orientation)
    return np.array(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def rotation_of(quaternion: np.ndarray) -> np.ndarray:
    """Matrices (..., 3, 3) whose columns are a body's axes in space, from quaternions (..., 4) of any length."""
    unit = quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True)
    s, v = unit[..., :1, None], unit[..., 1:]
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack((zero, -z, y, z, zero, -x, -y, x, zero), axis=-1).reshape(*x.shape, 3, 3)
    return np.eye(3) + 2.0 * (s * cross + cross @ cross)


__all__ = [
    "FREQUENCY", "QUATERNION", "RIGID", "SOCKET", "Rigids", "Sockets", "new_rigids", "new_sockets", "quaternion_of",
    "rotation_of",
]  # fmt: skip
