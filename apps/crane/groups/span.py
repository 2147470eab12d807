"""Spans of rope: ALE elements that are straight between two marks, a mark and a node, or two nodes.

A span from material p1 to p2 is Lambda long from mark to mark (`crane.geometry.line`), stretched by lambda = Lambda /
(p2 - p1). Its particles at the marks move at v_i = c_i. - t p_i., t = lambda e, and those between linearly in p. So

    T = rhoA L (v1.v1 + v1.v2 + v2.v2) / 6,   V = L W(lambda) - rhoA L g.(c1 + c2) / 2,

and the residual is Lagrange's: d/dt dT/dq. - dT/dq + dV/dq, in which the momentum that is turned at a kink and that
which goes round a sheave come out by themselves. Green's strain, N = EA (eps + c eps.) lambda; a rope that takes no
compression has W = 0 where it is shorter than unstretched, and N = 0 where N would be negative.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import (
    AXES,
    FOUND,
    LENGTH,
    PATH,
    POINT,
    PSI1,
    PSI2,
    RATE,
    Line,
    dot,
    find_line,
    new_line,
    vary_gradient,
)
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import EMPTY, OFF_WHEEL, SLACK_ON_WHEEL, TWO_BLOCKED, register
from tautline.kernels.jit import kernel

STATION = 4
"""Degrees of freedom of a station: its position, and the material coordinate p that is there."""
MATERIAL = 3
SPAN = np.dtype(
    [
        ("a", "i8"), ("b", "i8"), ("wheel1", "i8"), ("wheel2", "i8"), ("stiffness", "f8"), ("mass", "f8"),
        ("damping", "f8"), ("load", "f8", (3,)), ("slack", "i8"),
    ]
)  # fmt: skip
"""A span: its stations' places, the wheels there or ``POINT``, EA N, rhoA kg/m, c s, weight N/m, whether it slacks."""
BETWEEN = np.dtype([("a", "i8"), ("b", "i8"), ("wheel1", "i8"), ("wheel2", "i8")])
"""Two items between which a span of the path runs: their places, and the wheels there or ``POINT``."""
FORCE, FIRST, LAST, FIRST_PSI, LAST_PSI, STRETCH, BY_STRETCH, BY_SPEED, INERTIA, SIZE = range(10)
"""Places in ``found``: N in the middle (N), what is left of the tension at either end beside what turns the rope's
momentum, T - rhoA u^2 (N), both psi (rad), lambda, dN/dLambda (N/m), dN/dLambda. (N s/m), rhoA L / 6 (kg)."""
MET = 0.05
"""Straight rope between a sheave and what hangs from it, over the radius, below which the two have met."""
FAR_APART = 2.0
"""Distance of two centres, over the sum of the radii, at which nothing can have met."""
FALLEN = 0.5
"""Distance of a node from its wheel, over the rope between, below which the rope has fallen onto the wheel."""
RECORDED = 6
"""How many of them are recorded; the direction (3,) follows."""


class Motion(NamedTuple):
    """Kinematics of a span, and scratch: ``point`` (13, 3) vectors, ``number`` (14,) indexed by names below."""

    point: np.ndarray
    number: np.ndarray


V1, V2, A1, A2, M1, M2, N1, N2, T, T_D, E_D, P, TURNED_P = range(13)
L, L_D, LAM, LAM_D, K, K_D, TENSION, ENERGY, ELASTIC, TAU, KINETIC, P_E, BY_LAM, BY_RATE = range(14)


class Spans(NamedTuple):
    """Spans (n,) of ``SPAN`` over ``wheels`` (m,) of ``WHEEL``.

    ``items`` (k,) of ``BETWEEN`` are whole spans of the path, each with a wheel at one of its ends at least.

    ``found`` (n, 4) is what the last evaluation found, for laws that depend on it; ``start`` (n, 3) the directions;
    ``is_slack`` (n,) whether each was slack when its tangent was made. Scratch: ``line``, ``motion``, ``change``
    (11, 3) and ``block`` (8, 8).
    """

    rows: np.recarray
    items: np.recarray
    wheels: np.recarray
    found: np.ndarray
    start: np.ndarray
    is_slack: np.ndarray
    line: Line
    motion: Motion
    change: np.ndarray
    block: np.ndarray


@kernel
def _stretch(g, n, q, v, start):
    """Line, lambda and force of a span; the line is looked for from the direction ``start``, and left there."""
    s, line, number = g.rows[n], g.line, g.motion.number
    find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, v, start, line)
    size, size_d = q[s.b + MATERIAL] - q[s.a + MATERIAL], v[s.b + MATERIAL] - v[s.a + MATERIAL]
    lam = line.number[PATH] / size
    path_d = line.number[RATE]
    for c in range(AXES):
        path_d += line.g[c] * (v[s.b + c] - v[s.a + c])
    lam_d = (path_d - lam * size_d) / size
    strain = 0.5 * (lam * lam - 1.0)
    number[L], number[L_D], number[LAM], number[LAM_D] = size, size_d, lam, lam_d
    number[ENERGY], number[ELASTIC] = 0.5 * s.stiffness * strain * strain, s.stiffness * strain * lam
    number[TENSION] = s.stiffness * (strain + s.damping * lam * lam_d) * lam
    number[BY_LAM] = s.stiffness * (strain + lam * lam + 2.0 * s.damping * lam * lam_d)
    number[BY_RATE] = s.stiffness * s.damping * lam * lam
    if s.slack == 1 and strain < 0.0:
        number[ENERGY] = number[ELASTIC] = 0.0
    if s.slack == 1 and number[TENSION] < 0.0:
        number[TENSION] = number[BY_LAM] = number[BY_RATE] = 0.0


@kernel
def _find(g, n, q, v):
    """The same, and what other groups ask of it."""
    _stretch(g, n, q, v, g.start[n])
    s, line, number = g.rows[n], g.line, g.motion.number
    size, size_d = number[L], number[L_D]
    g.found[n, FORCE], g.found[n, STRETCH] = number[TENSION], number[LAM]
    g.found[n, FIRST_PSI], g.found[n, LAST_PSI] = line.number[PSI1], line.number[PSI2]
    g.found[n, BY_STRETCH] = (number[BY_LAM] - number[BY_RATE] * size_d / size) / size
    g.found[n, BY_SPEED] = number[BY_RATE] / size
    g.found[n, INERTIA] = s.mass * size / 6.0


@kernel
def _move(g, n, q, v):
    """Velocities of the particles at both marks, the rates of e and t, and the kinetic energy."""
    s, line = g.rows[n], g.line
    x, number = g.motion.point, g.motion.number
    lam, lam_d, size = number[LAM], number[LAM_D], number[L]
    p1_d, p2_d = v[s.a + MATERIAL], v[s.b + MATERIAL]
    k = s.mass * size / 6.0
    number[K], number[K_D] = k, s.mass * number[L_D] / 6.0
    for c in range(AXES):
        e_d = line.drift[c]
        for d in range(AXES):
            e_d += line.turn[c, d] * (v[s.b + d] - v[s.a + d])
        x[E_D, c] = e_d
        t, t_d = lam * line.e[c], lam_d * line.e[c] + lam * e_d
        x[T, c], x[T_D, c] = t, t_d
        v1, v2 = v[s.a + c] - t * p1_d, v[s.b + c] - t * p2_d
        x[V1, c], x[V2, c] = v1, v2
        x[M1, c], x[M2, c] = k * (2.0 * v1 + v2), k * (v1 + 2.0 * v2)
        x[P, c] = p1_d * x[M1, c] + p2_d * x[M2, c]
    number[KINETIC] = 0.5 * (dot(x[V1], x[M1]) + dot(x[V2], x[M2]))
    number[TAU] = (number[KINETIC] + dot(x[P], x[T])) / size
    number[P_E] = dot(x[P], line.e)
    for c in range(AXES):
        x[TURNED_P, c] = line.turn[0, c] * x[P, 0] + line.turn[1, c] * x[P, 1] + line.turn[2, c] * x[P, 2]


@kernel
def _accelerate(g, n, v, a):
    """Accelerations of the particles at both marks, and the rates of their momenta."""
    s = g.rows[n]
    x, k, k_d = g.motion.point, g.motion.number[K], g.motion.number[K_D]
    p1_d, p2_d, p1_dd, p2_dd = v[s.a + MATERIAL], v[s.b + MATERIAL], a[s.a + MATERIAL], a[s.b + MATERIAL]
    for c in range(AXES):
        a1 = a[s.a + c] - x[T, c] * p1_dd - x[T_D, c] * p1_d
        a2 = a[s.b + c] - x[T, c] * p2_dd - x[T_D, c] * p2_d
        x[A1, c], x[A2, c] = a1, a2
        x[N1, c] = k * (2.0 * a1 + a2) + k_d * (2.0 * x[V1, c] + x[V2, c])
        x[N2, c] = k * (a1 + 2.0 * a2) + k_d * (x[V1, c] + 2.0 * x[V2, c])


@kernel
def _residual(g, t, q, v, a, r):
    x, number, line = g.motion.point, g.motion.number, g.line
    for n in range(g.rows.size):
        s = g.rows[n]
        i, j = s.a, s.b
        _find(g, n, q, v)
        _move(g, n, q, v)
        _accelerate(g, n, v, a)
        force, lam, size = number[TENSION], number[LAM], number[L]
        lifted = first = last = 0.0
        for c in range(AXES):
            pull = number[P_E] * line.g[c] / size + lam * x[TURNED_P, c] + force * line.g[c]
            weight = 0.5 * size * s.load[c]
            r1, r2 = x[N1, c] - pull - weight, x[N2, c] + pull - weight
            r[i + c] += r1
            r[j + c] += r2
            first -= r1 * line.e[c]
            last += r2 * line.e[c]
            lifted += 0.5 * s.load[c] * (q[i + c] + q[j + c])
        g.found[n, FIRST], g.found[n, LAST] = first, last
        inner = number[TAU] - number[ENERGY] + force * lam + lifted
        r[i + MATERIAL] += inner - dot(x[T_D], x[M1]) - dot(x[T], x[N1])
        r[j + MATERIAL] -= inner + dot(x[T_D], x[M2]) + dot(x[T], x[N2])


@kernel
def _vary_line(g, n, v, column, cc, ck):
    """How a span's line changes along one degree of freedom: e, e. and the gradient g of its way, y 0, 1 and 11.

    Returns the changes of the stretch, of the way's rate, and of the way between the tangents' ends. How the
    direction's derivative E changes is taken as between two points: that is exact for ropes that lie in their wheels'
    planes, and small in any case, for what it multiplies is the momentum that flows through.
    """
    s, line, x, y, number = g.rows[n], g.line, g.motion.point, g.change, g.motion.number
    e, turn, gradient = line.e, line.turn, line.g
    axis, sign = column % STATION, -1.0 if column < STATION else 1.0
    if axis == MATERIAL:
        for c in range(AXES):
            y[0, c] = y[1, c] = y[2, c] = y[11, c] = 0.0
        return -number[LAM] * (sign * ck) / number[L], 0.0, 0.0
    # d moves by sign along one axis.
    along = sign * ck * e[axis]
    speed = bent = turned = 0.0
    for c in range(AXES):
        y[0, c] = sign * ck * turn[c, axis]
        y[12, c] = sign * ck if c == axis else 0.0
        speed += (v[s.b + c] - v[s.a + c]) * e[c]
    rho1 = g.wheels[s.wheel1].radius if s.wheel1 != POINT else 0.0
    rho2 = g.wheels[s.wheel2].radius if s.wheel2 != POINT else 0.0
    vary_gradient(rho1, rho2, line, y[12], y[0], y[13], y[11])
    for c in range(AXES):
        turned += y[0, c] * (v[s.b + c] - v[s.a + c])
        bent += y[11, c] * (v[s.b + c] - v[s.a + c])
    for c in range(AXES):
        swept = x[E_D, c] - line.drift[c]
        y[1, c] = sign * cc * turn[c, axis] - (y[0, c] * speed + e[c] * turned + swept * along) / line.number[LENGTH]
    return sign * ck * gradient[axis] / number[L], sign * cc * gradient[axis] + bent, along


@kernel
def _vary_momenta(g, n, v, a, column, cm, cc, grown, size_v, d_lam, d_lam_d):
    """How what moves changes along one degree of freedom, by the changes of length, stretch and their rates.

    Written to y: 2 t, 3 t., 4 and 5 velocities at both marks, 6 and 7 momenta, 8 and 9 their rates, 10 P.
    """
    s, e, x, y, number = g.rows[n], g.line.e, g.motion.point, g.change, g.motion.number
    lam, lam_d, k, k_d = number[LAM], number[LAM_D], number[K], number[K_D]
    axis = column % STATION
    c_of_1 = 1.0 if column < STATION else 0.0
    c_of_2 = 1.0 - c_of_1
    p1_d, p2_d, p1_dd, p2_dd = v[s.a + MATERIAL], v[s.b + MATERIAL], a[s.a + MATERIAL], a[s.b + MATERIAL]
    dp1_d = dp2_d = dp1_dd = dp2_dd = 0.0
    if axis == MATERIAL:
        dp1_d, dp2_d, dp1_dd, dp2_dd = c_of_1 * cc, c_of_2 * cc, c_of_1 * cm, c_of_2 * cm
    dk, dk_d = s.mass * grown / 6.0, s.mass * size_v / 6.0
    for c in range(AXES):
        dt = d_lam * e[c] + lam * y[0, c]
        dt_d = d_lam_d * e[c] + lam_d * y[0, c] + d_lam * x[E_D, c] + lam * y[1, c]
        own = 1.0 if c == axis else 0.0
        dv1 = own * c_of_1 * cc - dt * p1_d - x[T, c] * dp1_d
        dv2 = own * c_of_2 * cc - dt * p2_d - x[T, c] * dp2_d
        da1 = own * c_of_1 * cm - dt * p1_dd - x[T, c] * dp1_dd - dt_d * p1_d - x[T_D, c] * dp1_d
        da2 = own * c_of_2 * cm - dt * p2_dd - x[T, c] * dp2_dd - dt_d * p2_d - x[T_D, c] * dp2_d
        v1, v2, a1, a2 = x[V1, c], x[V2, c], x[A1, c], x[A2, c]
        y[2, c], y[3, c], y[4, c], y[5, c] = dt, dt_d, dv1, dv2
        y[6, c] = dk * (2.0 * v1 + v2) + k * (2.0 * dv1 + dv2)
        y[7, c] = dk * (v1 + 2.0 * v2) + k * (dv1 + 2.0 * dv2)
        y[8, c] = dk * (2.0 * a1 + a2) + k * (2.0 * da1 + da2) + dk_d * (2.0 * v1 + v2) + k_d * (2.0 * dv1 + dv2)
        y[9, c] = dk * (a1 + 2.0 * a2) + k * (da1 + 2.0 * da2) + dk_d * (v1 + 2.0 * v2) + k_d * (dv1 + 2.0 * dv2)
        y[10, c] = dp1_d * x[M1, c] + dp2_d * x[M2, c] + p1_d * y[6, c] + p2_d * y[7, c]


@kernel
def _vary(g, n, q, v, a, column, cm, cc, ck):
    """Write the derivative of the residual along one degree of freedom: position ck, velocity cc, acceleration cm."""
    s, line, block, x, y, number = g.rows[n], g.line, g.block, g.motion.point, g.change, g.motion.number
    e, turn, gradient = line.e, line.turn, line.g
    lam, lam_d, size, size_d = number[LAM], number[LAM_D], number[L], number[L_D]
    force, axis, sign = number[TENSION], column % STATION, -1.0 if column < STATION else 1.0
    grown = size_v = 0.0
    if axis == MATERIAL:
        grown, size_v = sign * ck, sign * cc
    d_lam, d_path_d, along = _vary_line(g, n, v, column, cc, ck)
    d_lam_d = (d_path_d - d_lam * size_d - lam * size_v - lam_d * grown) / size
    _vary_momenta(g, n, v, a, column, cm, cc, grown, size_v, d_lam, d_lam_d)
    d_force = number[BY_LAM] * d_lam + number[BY_RATE] * d_lam_d
    d_energy = number[ELASTIC] * d_lam
    d_kinetic = dot(x[M1], y[4]) + dot(x[M2], y[5]) + number[KINETIC] * grown / size
    d_tau = (d_kinetic + dot(y[10], x[T]) + dot(x[P], y[2]) - number[TAU] * grown) / size
    d_inner = d_tau - d_energy + d_force * lam + force * d_lam
    if axis != MATERIAL:
        d_inner += 0.5 * ck * s.load[axis]
    d_along = dot(y[10], e) + dot(x[P], y[0])
    shifted = dot(y[0], x[P])
    for c in range(AXES):
        turned_p = -(y[0, c] * number[P_E] + e[c] * shifted + x[TURNED_P, c] * along) / line.number[LENGTH]
        for d in range(AXES):
            turned_p += turn[d, c] * y[10, d]
        pull = d_along * gradient[c] / size + number[P_E] * (y[11, c] - gradient[c] * grown / size) / size
        pull += d_lam * x[TURNED_P, c] + lam * turned_p + d_force * gradient[c] + force * y[11, c]
        weight = 0.5 * grown * s.load[c]
        block[c, column] = y[8, c] - pull - weight
        block[STATION + c, column] = y[9, c] + pull - weight
    block[MATERIAL, column] = (
        d_inner - dot(y[3], x[M1]) - dot(x[T_D], y[6]) - dot(y[2], x[N1]) - dot(x[T], y[8])
    )  # fmt: skip
    block[STATION + MATERIAL, column] = (
        -d_inner - dot(y[3], x[M2]) - dot(x[T_D], y[7]) - dot(y[2], x[N2]) - dot(x[T], y[9])
    )  # fmt: skip


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        s = g.rows[n]
        _find(g, n, q, v)
        _move(g, n, q, v)
        _accelerate(g, n, v, a)
        for column in range(2 * STATION):
            _vary(g, n, q, v, a, column, cm, cc, ck)
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, g.block)


@kernel
def _mass(g, q, matrix, dofs):
    """m_ij ((1, -t), (-t^T, t.t)) rhoA L, m = ((1/3, 1/6), (1/6, 1/3)); no velocity has a part in it."""
    block = g.block
    for n in range(g.rows.size):
        s = g.rows[n]
        find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, q, g.start[n], g.line)
        size = q[s.b + MATERIAL] - q[s.a + MATERIAL]
        lam = g.line.number[PATH] / size
        for i in range(2):
            for j in range(2):
                m = s.mass * size / (3.0 if i == j else 6.0)
                for c in range(AXES):
                    for d in range(AXES):
                        block[i * STATION + c, j * STATION + d] = m if c == d else 0.0
                    block[i * STATION + c, j * STATION + MATERIAL] = -m * lam * g.line.e[c]
                    block[i * STATION + MATERIAL, j * STATION + c] = -m * lam * g.line.e[c]
                block[i * STATION + MATERIAL, j * STATION + MATERIAL] = m * lam * lam
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, block)


@kernel
def _switch(g, t, q, v, converged, changed):
    """A span that goes slack, or taut again, has another tangent; the residual knows by itself."""
    if converged:
        return
    for n in range(g.rows.size):
        _find(g, n, q, v)
        slack = 1 if g.rows[n].slack == 1 and g.motion.number[TENSION] == 0.0 else 0
        if slack != g.is_slack[n]:
            g.is_slack[n] = slack
            changed[0] += 1


@kernel
def turns_with_frame(s, wheels):
    """Whether a wheel at either end of a span turns with its frame."""
    if s.wheel1 != POINT and wheels[s.wheel1].turns == 1:
        return True
    return s.wheel2 != POINT and wheels[s.wheel2].turns == 1


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        s = g.rows[n]
        _find(g, n, q, v)
        _move(g, n, q, v)
        energy[0] += g.motion.number[KINETIC]
        energy[1] += g.motion.number[L] * g.motion.number[ENERGY]
        for c in range(AXES):
            energy[2] -= 0.5 * g.motion.number[L] * s.load[c] * (q[s.a + c] + q[s.b + c])


@kernel
def _dissipation(g, t, q, v, p):
    number, start = g.motion.number, g.change[0]
    for n in range(g.rows.size):
        # What the accepted state has left for others stays.
        for c in range(AXES):
            start[c] = g.start[n, c]
        _stretch(g, n, q, v, start)
        p[0] += (number[TENSION] - number[ELASTIC]) * number[LAM_D] * number[L]


@kernel
def _supply(g, t, q, v, p):
    """What wheels that turn with their frames put in while the stations stand still."""
    x, number, line = g.motion.point, g.motion.number, g.line
    for n in range(g.rows.size):
        if not turns_with_frame(g.rows[n], g.wheels):
            continue
        _find(g, n, q, v)
        if line.number[RATE] != 0.0 or dot(line.drift, line.drift) > 0.0:
            _move(g, n, q, v)
            rate = line.number[RATE] / number[L]
            for c in range(AXES):
                p[0] += x[P, c] * (rate * line.e[c] + number[LAM] * line.drift[c])
            p[0] += number[TENSION] * line.number[RATE]


@kernel
def _met(g, q, alarm):
    """Two items that have come together: it is the rope between them that counts, and not an element's."""
    direction = g.change[0]
    for n in range(g.items.size):
        item = g.items[n]
        radii = apart = 0.0
        for wheel in (item.wheel1, item.wheel2):
            if wheel != POINT:
                radii += abs(g.wheels[wheel].radius)
        for c in range(AXES):
            apart += (q[item.b + c] - q[item.a + c]) ** 2
        # Centres that are far apart need no line: it is no shorter than what lies between the rims.
        if apart > (FAR_APART * radii) ** 2:
            continue
        direction.fill(0.0)
        find_line(item.a, item.b, item.wheel1, item.wheel2, g.wheels, q, q, direction, g.line)
        left = g.line.number[LENGTH] if g.line.number[FOUND] == 1.0 else 0.0
        for wheel in (item.wheel1, item.wheel2):
            if wheel != POINT and left < MET * abs(g.wheels[wheel].radius):
                alarm[0], alarm[1] = TWO_BLOCKED, item.a


@kernel
def _alarm(g, t, q, alarm):
    _met(g, q, alarm)
    if alarm[0] != 0:
        return
    for n in range(g.rows.size):
        s = g.rows[n]
        find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, q, g.start[n], g.line)
        if not (q[s.b + MATERIAL] > q[s.a + MATERIAL] and g.line.number[PATH] > 0.0 and g.line.number[FOUND] == 1.0):
            alarm[0], alarm[1] = EMPTY, s.a
            return
        # A node of taut rope is as near to its wheel as its element is short. Where less than half of the rope that is
        # not laid on the wheel reaches to the node, a slack rope has fallen there.
        straight = g.line.number[LENGTH]
        material = q[s.b + MATERIAL] - q[s.a + MATERIAL] - (g.line.number[PATH] - straight)
        if s.slack == 1 and straight < FALLEN * material:
            for side in range(2):
                wheel = s.wheel1 if side == 0 else s.wheel2
                if wheel != POINT and straight < MET * abs(g.wheels[wheel].radius):
                    alarm[0], alarm[1] = SLACK_ON_WHEEL, s.a if side == 0 else s.b
                    return
        g.found[n, FIRST_PSI], g.found[n, LAST_PSI] = g.line.number[PSI1], g.line.number[PSI2]
        # A wheel between two spans has rope on it as long as the rope runs on before it leaves.
        if n > 0 and s.wheel1 != POINT and g.rows[n - 1].wheel2 == s.wheel1:
            wrap = g.found[n, FIRST_PSI] - g.found[n - 1, LAST_PSI]
            if not wrap * g.wheels[s.wheel1].radius > 0.0:
                alarm[0], alarm[1] = OFF_WHEEL, s.a
                return


@kernel
def _record(g, out, at):
    for n in range(g.rows.size):
        for k in range(RECORDED):
            out[at[0]] = g.found[n, k]
            at[0] += 1
        for c in range(AXES):
            out[at[0]] = g.start[n, c]
            at[0] += 1


register(
    Spans, residual=_residual, tangent=_tangent, mass=_mass, switch=_switch, energy=_energy, dissipation=_dissipation,
    supply=_supply, alarm=_alarm, record=_record,
)  # fmt: skip


def new_spans(rows: np.recarray, wheels: np.recarray, items: np.recarray | None = None) -> Spans:
    """Group of spans with its scratch; without ``items`` nobody asks whether two of them have met."""
    n = len(rows)
    items = np.zeros(0, BETWEEN).view(np.recarray) if items is None else items
    return Spans(
        rows, items, wheels, np.zeros((n, SIZE)), np.zeros((n, 3)), np.zeros(n, np.int64), new_line(),
        Motion(np.zeros((13, 3)), np.zeros(14)), np.zeros((14, 3)), np.zeros((8, 8)),
    )  # fmt: skip


__all__ = ["MATERIAL", "POINT", "SPAN", "STATION", "Spans", "new_spans"]
