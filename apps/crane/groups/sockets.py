"""Sockets that tie a rope to a point of a rigid body: a spring of no length with a damper, the same in every direction.

The point o of the body is at the lever R o from its centre (quaternion.py); force and tangent are those of the gap and
of its exact derivatives by the quaternion. The rope's end is known by its arm, the way to it from the centre. Of two
positions the gap would have the rounding, which grows with the distance from the origin: times the stiffness of a
socket it is a force that no iteration brings to rest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES
from crane.geometry.quaternion import QUATERNION, pair, product
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel

SOCKET = np.dtype(
    [
        ("arm", "i8"), ("turn", "i8"), ("offset", "f8", (3,)), ("stiffness", "f8"), ("damping", "f8"),
    ]
)  # fmt: skip
"""A spring of no length with a damper: place of the way from the body's centre to the rope's end, and of the body's
quaternion; the point of the body in its axes from its centre, m; N/m and N s/m, the same in every direction."""


class Sockets(NamedTuple):
    """Sockets (n,) of ``SOCKET``.

    ``unit`` (4, 4) is the identity; ``lever`` (6, 3) holds R o, its four derivatives by the quaternion and its rate,
    ``curved`` (4, 4, 3) the second derivatives, ``pull`` (2, 3) the gap and the force across it; ``change`` (3,) and
    ``block`` (7, 7) are scratch.
    """

    rows: np.recarray
    unit: np.ndarray
    lever: np.ndarray
    curved: np.ndarray
    pull: np.ndarray
    change: np.ndarray
    block: np.ndarray


LEVER, LEVER_D = 0, 5
GAP, PULL = range(2)
WIDTH = 7
"""Degrees of freedom of a socket: the arm and the quaternion."""


@kernel
def _place_of(s, i):
    """Where one of a socket's degrees of freedom is in the full vectors."""
    return s.arm + i if i < AXES else s.turn + i - AXES


@kernel
def _reach(g, n, q, v):
    """Lever, gap and force of a socket. Returns N."""
    s, lever, pull = g.rows[n], g.lever, g.pull
    norm = product(q, s.turn, q, s.turn)
    pair(s.offset, q, s.turn, q, s.turn, lever[LEVER])
    lever[LEVER_D].fill(0.0)
    for c in range(AXES):
        lever[LEVER, c] /= norm
    for k in range(QUATERNION):
        pair(s.offset, q, s.turn, g.unit[k], 0, lever[1 + k])
        for c in range(AXES):
            lever[1 + k, c] = 2.0 * (lever[1 + k, c] - lever[LEVER, c] * q[s.turn + k]) / norm
            lever[LEVER_D, c] += lever[1 + k, c] * v[s.turn + k]
    for c in range(AXES):
        pull[GAP, c] = q[s.arm + c] - lever[LEVER, c]
        rate = v[s.arm + c] - lever[LEVER_D, c]
        pull[PULL, c] = s.stiffness * pull[GAP, c] + s.damping * rate
    return norm


@kernel
def _bend(g, n, q, norm):
    """Second derivatives of a socket's lever."""
    s, lever, curved = g.rows[n], g.lever, g.curved
    for k in range(QUATERNION):
        for l in range(QUATERNION):
            pair(s.offset, g.unit[k], 0, g.unit[l], 0, curved[k, l])
            for c in range(AXES):
                other = lever[1 + k, c] * q[s.turn + l] + lever[1 + l, c] * q[s.turn + k]
                other += lever[LEVER, c] * g.unit[k, l]
                curved[k, l, c] = 2.0 * (curved[k, l, c] - other) / norm


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        s = g.rows[n]
        _reach(g, n, q, v)
        for c in range(AXES):
            r[s.arm + c] += g.pull[PULL, c]
            for k in range(QUATERNION):
                r[s.turn + k] -= g.lever[1 + k, c] * g.pull[PULL, c]


@kernel
def _vary_pull(g, n, v, column, cc, ck, out):
    """Write the change of a socket's force along one of its degrees of freedom: position ck, velocity cc."""
    s, lever = g.rows[n], g.lever
    by = ck * s.stiffness + cc * s.damping
    out.fill(0.0)
    if column < AXES:
        out[column] = by
        return
    k = column - AXES
    for c in range(AXES):
        turned = 0.0
        for l in range(QUATERNION):
            turned += g.curved[k, l, c] * v[s.turn + l]
        out[c] = -by * lever[1 + k, c] - ck * s.damping * turned


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        s, change = g.rows[n], g.change
        _bend(g, n, q, _reach(g, n, q, v))
        for column in range(WIDTH):
            _vary_pull(g, n, v, column, cc, ck, change)
            for c in range(AXES):
                g.block[c, column] = change[c]
            for k in range(QUATERNION):
                x = 0.0
                for c in range(AXES):
                    x -= g.lever[1 + k, c] * change[c]
                    if column >= AXES:
                        x -= ck * g.curved[k, column - AXES, c] * g.pull[PULL, c]
                g.block[AXES + k, column] = x
        for i in range(WIDTH):
            for j in range(WIDTH):
                add_entry(matrix, dofs, _place_of(s, i), _place_of(s, j), g.block[i, j])


@kernel
def _energy(g, t, q, v, e):
    for n in range(g.rows.size):
        _reach(g, n, q, v)
        for c in range(AXES):
            e[1] += 0.5 * g.rows[n].stiffness * g.pull[GAP, c] ** 2


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        s = g.rows[n]
        if s.damping > 0.0:
            _reach(g, n, q, v)
            for c in range(AXES):
                p[0] += s.damping * (v[s.arm + c] - g.lever[LEVER_D, c]) ** 2


register(
    Sockets, residual=_residual, tangent=_tangent, energy=_energy,
    dissipation=_dissipation,
)  # fmt: skip


def new_sockets(rows: np.recarray) -> Sockets:
    """Group of sockets with its scratch."""
    return Sockets(
        rows, np.eye(4), np.zeros((6, 3)), np.zeros((4, 4, 3)), np.zeros((2, 3)), np.zeros(3),
        np.zeros((WIDTH, WIDTH)),
    )  # fmt: skip
