"""Spans of rope: ALE elements that are straight between two marks, a mark and a node, or two nodes.

A span from material p1 to p2 is Lambda long from mark to mark (`crane.geometry.line`), stretched by lambda = Lambda /
(p2 - p1). Its particles at the marks move at v_i = c_i. - t p_i., t = lambda e, and those between linearly in p. So

    T = rhoA L (v1.v1 + v1.v2 + v2.v2) / 6,   V = L W(lambda) - rhoA L g.(c1 + c2) / 2,

and the residual is Lagrange's: d/dt dT/dq. - dT/dq + dV/dq, in which the momentum that is turned at a kink and that
which goes round a sheave come out by themselves. With Green's strain, eps = (lambda^2 - 1)/2, or engineering strain,
eps = lambda - 1,

    W = EA eps^2 / 2,   N = EA (eps + c eps.) eps',   eps' = deps/dlambda = lambda or 1;

a rope that takes no compression has W = 0 where it is shorter than unstretched, and N = 0 where N would be negative.

Where rope runs onto a drum it keeps its stretch. What resists p. there is T lambda, and not T lambda - W: the rope is
not let go, and pulls at the drum with T R.
"""

from __future__ import annotations

from math import pi
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
    apply,
    apply_back,
    bend_of,
    difference,
    find_line,
    new_line,
    place,
    row,
    vary_gradient,
    write,
    write_turn,
)
from tautline.elements.slackening import edge_of_slack
from tautline.kernels.changes import COUNT
from tautline.kernels.dofs import add_block, add_entry
from tautline.kernels.groups import EMPTY, OFF_WHEEL, SLACK_ON_WHEEL, TWO_BLOCKED, Edge, register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot, scaled, scaled_sum

FRAME = 12
"""Numbers of a frame in the full vectors: its origin and the columns of its rotation."""
STATION = 4
"""Degrees of freedom of a station: its position, and the material coordinate p that is there."""
MATERIAL = 3
SPAN = np.dtype(
    [
        ("a", "i8"), ("b", "i8"), ("wheel1", "i8"), ("wheel2", "i8"), ("stiffness", "f8"), ("mass", "f8"),
        ("damping", "f8"), ("load", "f8", (3,)), ("slack", "i8"), ("keeps1", "i8"), ("keeps2", "i8"),
        ("engineering", "i8"),
    ]
)  # fmt: skip
"""A span: its stations' places, the wheels there or ``POINT``, EA N, rhoA kg/m, c s, weight N/m, whether it slacks,
whether the rope beyond its beginning and its end keeps its stretch, and whether its strain is engineering strain."""
BETWEEN = np.dtype([("a", "i8"), ("b", "i8"), ("wheel1", "i8"), ("wheel2", "i8")])
"""Two items between which a span of the path runs: their places, and the wheels there or ``POINT``."""
FORCE, FIRST, LAST, FIRST_PSI, LAST_PSI, STRETCH = range(6)
BY_STRETCH, BY_SPEED, INERTIA, STRAIGHT, ON_WHEELS, STRAIN_ENERGY, STRETCH_RATE, ELASTIC_FORCE, SIZE = range(6, 15)
"""Places in ``found``: N in the middle (N), what is left of the tension at either end beside what turns the rope's
momentum, T - rhoA u^2 (N), both psi (rad), lambda, dN/dLambda (N/m), dN/dLambda. (N s/m), rhoA L / 6 (kg), l, and
Lambda - l, or NaN where there is no line (m), W (J/m), lambda. (1/s), and dW/dlambda (N)."""
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

    ``items`` (k,) of ``BETWEEN`` are whole spans of the path, each with a wheel at one of its ends at least. ``laid``
    (n + 1,) m is p of the stations where the run begins, from which turns and rope paid out are counted.

    ``found`` (n, 14) is what the last evaluation found, for laws that depend on it; ``start`` (n, 3) the directions;
    ``turned`` (n, 2) both psi of the last accepted state, from which turns are counted: a wild attempt must not leave a
    turn too many. ``is_slack`` (n,) says whether each is slack, and ``kinks`` (1,) how many have come to be so, or taut
    again, since somebody asked. ``seen`` (2, m) are the positions and velocities of which ``found`` tells, as far as
    the spans reach into the full vectors, and ``brought_in`` (1,) W is what turning wheels put in there: who asks of
    the same state need not look again. Scratch: ``line``, ``motion``, ``change`` (14, 3) and ``block`` (8, 8).
    """

    rows: np.recarray
    items: np.recarray
    laid: np.ndarray
    wheels: np.recarray
    found: np.ndarray
    start: np.ndarray
    turned: np.ndarray
    is_slack: np.ndarray
    kinks: np.ndarray
    seen: np.ndarray
    brought_in: np.ndarray
    line: Line
    motion: Motion
    change: np.ndarray
    block: np.ndarray


@kernel
def _stretch(g, n, q, v, start):
    """Line, lambda and force of a span; the line is looked for from the direction ``start``, and left there."""
    s, line, number = g.rows[n], g.line, g.motion.number
    find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, v, start, g.turned[n], line)
    size, size_d = q[s.b + MATERIAL] - q[s.a + MATERIAL], v[s.b + MATERIAL] - v[s.a + MATERIAL]
    lam = line.number[PATH] / size
    path_d = line.number[RATE] + dot(line.g, difference(s.b, s.a, v))
    lam_d = (path_d - lam * size_d) / size
    if s.engineering == 1:
        strain, slope, bend = lam - 1.0, 1.0, 0.0
    else:
        strain, slope, bend = 0.5 * (lam * lam - 1.0), lam, 1.0
    viscous = s.damping * slope * lam_d
    number[L], number[L_D], number[LAM], number[LAM_D] = size, size_d, lam, lam_d
    number[ENERGY], number[ELASTIC] = 0.5 * s.stiffness * strain * strain, s.stiffness * strain * slope
    number[TENSION] = s.stiffness * (strain + viscous) * slope
    number[BY_LAM] = s.stiffness * (slope * slope + (strain + 2.0 * viscous) * bend)
    number[BY_RATE] = s.stiffness * s.damping * slope * slope
    if s.slack == 1 and strain < 0.0:
        number[ENERGY] = number[ELASTIC] = 0.0
    if s.slack == 1 and number[TENSION] < 0.0:
        number[TENSION] = number[BY_LAM] = number[BY_RATE] = 0.0


@kernel
def _find(g, n, q, v):
    """The same, and what other groups ask of it."""
    _stretch(g, n, q, v, g.start[n])
    s, number = g.rows[n], g.motion.number
    size, size_d = number[L], number[L_D]
    g.found[n, FORCE], g.found[n, STRETCH] = number[TENSION], number[LAM]
    g.found[n, BY_STRETCH] = (number[BY_LAM] - number[BY_RATE] * size_d / size) / size
    g.found[n, BY_SPEED] = number[BY_RATE] / size
    g.found[n, INERTIA] = s.mass * size / 6.0
    g.found[n, STRAIN_ENERGY], g.found[n, STRETCH_RATE] = number[ENERGY], number[LAM_D]
    g.found[n, ELASTIC_FORCE] = number[ELASTIC]
    _keep_length(g, n)


@kernel(forceinline=True)
def _keep_length(g, n):
    number = g.line.number
    g.found[n, FIRST_PSI], g.found[n, LAST_PSI] = number[PSI1], number[PSI2]
    g.found[n, STRAIGHT] = number[LENGTH]
    g.found[n, ON_WHEELS] = number[PATH] - number[LENGTH] if number[FOUND] == 1.0 else np.nan


class Flow(NamedTuple):
    """How a span moves: ``k`` rhoA L / 6 and its rate; t = lambda e, its rate and that of e; velocities of the
    particles at both marks and their momenta; ``p``, what the flow of material sweeps along, and E^T p; kinetic energy;
    tau, what of the residual goes with the stretch; p.e."""

    k: float
    k_d: float
    t: tuple
    t_d: tuple
    e_d: tuple
    v1: tuple
    v2: tuple
    m1: tuple
    m2: tuple
    p: tuple
    turned_p: tuple
    kinetic: float
    tau: float
    p_e: float


@kernel(forceinline=True)
def _flow(g, n, v):
    """How the span moves of which the line was found last."""
    s, line, number = g.rows[n], g.line, g.motion.number
    lam, lam_d, size = number[LAM], number[LAM_D], number[L]
    p1_d, p2_d = v[s.a + MATERIAL], v[s.b + MATERIAL]
    e, bend = row(line.e), bend_of(line)
    e_d = scaled_sum(row(line.drift), 1.0, apply(bend, difference(s.b, s.a, v)))
    t, t_d = scaled(lam, e), scaled_sum(scaled(lam_d, e), lam, e_d)
    v1, v2 = scaled_sum(place(v, s.a), -p1_d, t), scaled_sum(place(v, s.b), -p2_d, t)
    k = s.mass * size / 6.0
    m1, m2 = scaled(k, scaled_sum(v2, 2.0, v1)), scaled(k, scaled_sum(v1, 2.0, v2))
    p = scaled_sum(scaled(p1_d, m1), p2_d, m2)
    kinetic = 0.5 * (dot(v1, m1) + dot(v2, m2))
    tau = (kinetic + dot(p, t)) / size
    k_d = s.mass * number[L_D] / 6.0
    return Flow(k, k_d, t, t_d, e_d, v1, v2, m1, m2, p, apply_back(bend, p), kinetic, tau, dot(p, e))


@kernel(forceinline=True)
def _momenta(f, p1_d, p2_d, p1_dd, p2_dd, a1, a2):
    """Accelerations of the particles at both marks, and the rates of their momenta; ``a1, a2`` those of the marks."""
    a1 = scaled_sum(scaled_sum(a1, -p1_dd, f.t), -p1_d, f.t_d)
    a2 = scaled_sum(scaled_sum(a2, -p2_dd, f.t), -p2_d, f.t_d)
    n1 = scaled_sum(scaled(f.k, scaled_sum(a2, 2.0, a1)), f.k_d, scaled_sum(f.v2, 2.0, f.v1))
    n2 = scaled_sum(scaled(f.k, scaled_sum(a1, 2.0, a2)), f.k_d, scaled_sum(f.v1, 2.0, f.v2))
    return a1, a2, n1, n2


@kernel
def _move(g, n, v, a):
    """Keep how the span moves, and its accelerations, for its tangent."""
    s, x, number = g.rows[n], g.motion.point, g.motion.number
    f = _flow(g, n, v)
    a1, a2, n1, n2 = _momenta(
        f, v[s.a + MATERIAL], v[s.b + MATERIAL], a[s.a + MATERIAL], a[s.b + MATERIAL], place(a, s.a), place(a, s.b)
    )
    number[K], number[K_D], number[KINETIC], number[TAU], number[P_E] = f.k, f.k_d, f.kinetic, f.tau, f.p_e
    write(f.t, x[T])
    write(f.t_d, x[T_D])
    write(f.e_d, x[E_D])
    write(f.v1, x[V1])
    write(f.v2, x[V2])
    write(f.m1, x[M1])
    write(f.m2, x[M2])
    write(f.p, x[P])
    write(f.turned_p, x[TURNED_P])
    write(a1, x[A1])
    write(a2, x[A2])
    write(n1, x[N1])
    write(n2, x[N2])


@kernel
def _mark_evaluated(g, q, v):
    """Remember of which state ``found`` tells."""
    for i in range(g.seen.shape[1]):
        g.seen[0, i] = q[i]
        g.seen[1, i] = v[i]


@kernel
def _is_evaluated(g, row, x):
    """Whether ``found`` tells of these positions (row 0), or velocities (row 1)."""
    others = 0
    for i in range(g.seen.shape[1]):
        others += 0 if x[i] == g.seen[row, i] else 1
    return others == 0


@kernel(forceinline=True)
def turns_with_frame(s, wheels):
    """Whether a wheel at either end of a span turns with its frame."""
    if s.wheel1 != POINT and wheels[s.wheel1].turns == 1:
        return True
    return s.wheel2 != POINT and wheels[s.wheel2].turns == 1


@kernel(forceinline=True)
def _brought_in(g, f):
    """Power, W, that the wheels of a span put in which turn with their frames while the stations stand still."""
    number, line = g.motion.number, g.line
    rate = line.number[RATE]
    turning = scaled_sum(scaled(rate / number[L], row(line.e)), number[LAM], row(line.drift))
    return dot(f.p, turning) + number[TENSION] * rate


@kernel
def _residual(g, t, q, v, a, r):
    number, line = g.motion.number, g.line
    _mark_evaluated(g, q, v)
    g.brought_in[0] = 0.0
    for n in range(g.rows.size):
        s = g.rows[n]
        i, j = s.a, s.b
        _find(g, n, q, v)
        f = _flow(g, n, v)
        _, _, n1, n2 = _momenta(
            f, v[i + MATERIAL], v[j + MATERIAL], a[i + MATERIAL], a[j + MATERIAL], place(a, i), place(a, j)
        )
        force, lam, size = number[TENSION], number[LAM], number[L]
        slack = 1 if s.slack == 1 and force == 0.0 else 0
        if slack != g.is_slack[n]:
            g.is_slack[n] = slack
            g.kinks[0] += 1
        if turns_with_frame(s, g.wheels):
            g.brought_in[0] += _brought_in(g, f)
        e, load = row(line.e), row(s.load)
        pull = scaled_sum(scaled(f.p_e / size + force, row(line.g)), lam, f.turned_p)
        r1 = scaled_sum(scaled_sum(n1, -1.0, pull), -0.5 * size, load)
        r2 = scaled_sum(scaled_sum(n2, 1.0, pull), -0.5 * size, load)
        for c in range(AXES):
            r[i + c] += r1[c]
            r[j + c] += r2[c]
        # The rows of a mark say how the momentum of the rope between the marks changes, that of what runs through a
        # moving mark with them: it is no force.
        first, last = v[i + MATERIAL] * dot(place(v, i), e), v[j + MATERIAL] * dot(place(v, j), e)
        g.found[n, FIRST], g.found[n, LAST] = -dot(r1, e) - s.mass * first, dot(r2, e) - s.mass * last
        lifted = 0.5 * (dot(load, place(q, i)) + dot(load, place(q, j)))
        inner, let_go = f.tau + force * lam + lifted, number[ENERGY]
        r[i + MATERIAL] += inner - (1 - s.keeps1) * let_go - dot(f.t_d, f.m1) - dot(f.t, n1)
        r[j + MATERIAL] -= inner - (1 - s.keeps2) * let_go + dot(f.t_d, f.m2) + dot(f.t, n2)


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
    d_inner = d_tau + d_force * lam + force * d_lam
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
        d_inner - (1 - s.keeps1) * d_energy - dot(y[3], x[M1]) - dot(x[T_D], y[6]) - dot(y[2], x[N1]) - dot(x[T], y[8])
    )  # fmt: skip
    block[STATION + MATERIAL, column] = (
        -d_inner + (1 - s.keeps2) * d_energy - dot(y[3], x[M2]) - dot(x[T_D], y[7]) - dot(y[2], x[N2]) - dot(x[T], y[9])
    )  # fmt: skip


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    g.seen[0, 0] = np.nan
    for n in range(g.rows.size):
        s = g.rows[n]
        _find(g, n, q, v)
        write_turn(g.line)
        _move(g, n, v, a)
        for column in range(2 * STATION):
            _vary(g, n, q, v, a, column, cm, cc, ck)
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, g.block)


@kernel
def _mass(g, q, matrix, dofs):
    """m_ij ((1, -t), (-t^T, t.t)) rhoA L, m = ((1/3, 1/6), (1/6, 1/3)); no velocity has a part in it."""
    block = g.block
    g.seen[0, 0] = np.nan
    for n in range(g.rows.size):
        s = g.rows[n]
        find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, q, g.start[n], g.turned[n], g.line)
        size = q[s.b + MATERIAL] - q[s.a + MATERIAL]
        lam = g.line.number[PATH] / size
        g.found[n, STRETCH] = lam
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
def _commit(g, t, h, q, v, a):
    # What was evaluated last is all but the accepted state, which is near enough to count turns by.
    for n in range(g.rows.size):
        g.turned[n, 0], g.turned[n, 1] = g.found[n, FIRST_PSI], g.found[n, LAST_PSI]


@kernel
def _kink(g, changed):
    changed[COUNT] += g.kinks[0]
    g.kinks[0] = 0


@kernel
def _energy(g, t, q, v, energy):
    g.seen[0, 0] = np.nan
    for n in range(g.rows.size):
        s = g.rows[n]
        _find(g, n, q, v)
        energy[0] += _flow(g, n, v).kinetic
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
    if _is_evaluated(g, 0, q) and _is_evaluated(g, 1, v):
        p[0] += g.brought_in[0]
        return
    for n in range(g.rows.size):
        if turns_with_frame(g.rows[n], g.wheels):
            _find(g, n, q, v)
            p[0] += _brought_in(g, _flow(g, n, v))
    g.seen[0, 0] = np.nan


@kernel
def add_by_tension(found, direction, n, a, b, first, row, x, cm, cc, ck, matrix, dofs):
    """Add x times the derivative of the tension at one end of span n to a row: N's, and that of the rope beside it.

    ``a`` and ``b`` are the places of its stations, ``direction`` (spans, 3) and ``found`` what the spans found.
    """
    by = x * (ck * found[n, BY_STRETCH] + cc * found[n, BY_SPEED])
    mass = x * cm * found[n, INERTIA]
    by_a = -by - 2.0 * mass if first else -by + mass
    by_b = by - mass if first else by + 2.0 * mass
    # Of a longer element a way grows lambda more slowly.
    slower = x * ck * found[n, BY_SPEED] * found[n, STRETCH_RATE]
    for c in range(AXES):
        add_entry(matrix, dofs, row, a + c, by_a * direction[n, c])
        add_entry(matrix, dofs, row, b + c, by_b * direction[n, c])
    add_entry(matrix, dofs, row, a + MATERIAL, slower - by_a * found[n, STRETCH])
    add_entry(matrix, dofs, row, b + MATERIAL, -slower - by_b * found[n, STRETCH])


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
        # Nobody asks for its psi.
        find_line(item.a, item.b, item.wheel1, item.wheel2, g.wheels, q, q, direction, g.turned[0], g.line)
        left = g.line.number[LENGTH] if g.line.number[FOUND] == 1.0 else 0.0
        for wheel in (item.wheel1, item.wheel2):
            if wheel != POINT and left < MET * abs(g.wheels[wheel].radius):
                alarm[0], alarm[1] = TWO_BLOCKED, item.a


@kernel
def _alarm(g, t, q, alarm):
    _met(g, q, alarm)
    if alarm[0] != 0:
        return
    seen = _is_evaluated(g, 0, q)
    if not seen:
        g.seen[0, 0] = np.nan
    for n in range(g.rows.size):
        s = g.rows[n]
        if not seen:
            find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, q, g.start[n], g.turned[n], g.line)
            _keep_length(g, n)
        straight, on_wheels = g.found[n, STRAIGHT], g.found[n, ON_WHEELS]
        # Without a line the sum is no number.
        if not (q[s.b + MATERIAL] > q[s.a + MATERIAL] and straight + on_wheels > 0.0):
            alarm[0], alarm[1] = EMPTY, s.a
            return
        # A node of taut rope is as near to its wheel as its element is short. Where less than half of the rope that is
        # not laid on the wheel reaches to the node, a slack rope has fallen there.
        material = q[s.b + MATERIAL] - q[s.a + MATERIAL] - on_wheels
        if s.slack == 1 and straight < FALLEN * material:
            for side in range(2):
                wheel = s.wheel1 if side == 0 else s.wheel2
                if wheel != POINT and straight < MET * abs(g.wheels[wheel].radius):
                    alarm[0], alarm[1] = SLACK_ON_WHEEL, s.a if side == 0 else s.b
                    return
        # A wheel between two spans has rope on it as long as the rope runs on before it leaves; and it has place for
        # one turn.
        if n > 0 and s.wheel1 != POINT and g.rows[n - 1].wheel2 == s.wheel1:
            wrap = g.found[n, FIRST_PSI] - g.found[n - 1, LAST_PSI]
            if not (wrap * g.wheels[s.wheel1].radius > 0.0 and abs(wrap) < 2.0 * pi):
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


def _edges(g: Spans, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far spans that go slack are from that; one that shortens is slack once its damping would push."""
    found = []
    for s, lam, rate in zip(g.rows, g.found[:, STRETCH], g.found[:, STRETCH_RATE], strict=True):
        if s.slack == 1:
            size = float(q[s.b + MATERIAL] - q[s.a + MATERIAL])
            slope = 1.0 if s.engineering == 1 else lam
            strain = lam - 1.0 if s.engineering == 1 else 0.5 * (lam * lam - 1.0)
            places = *range(s.a, s.a + AXES), *range(s.b, s.b + AXES)
            found.append(edge_of_slack(places, size * float(strain + s.damping * slope * rate), s.stiffness / size))
    return found


register(
    Spans, residual=_residual, tangent=_tangent, mass=_mass, kink=_kink, energy=_energy, dissipation=_dissipation,
    supply=_supply, commit=_commit, alarm=_alarm, record=_record,
    edges=_edges,
)  # fmt: skip


def new_spans(rows: np.recarray, wheels: np.recarray, items: np.recarray | None = None) -> Spans:
    """Group of spans with its scratch; without ``items`` nobody asks whether two of them have met."""
    n = len(rows)
    items = np.zeros(0, BETWEEN).view(np.recarray) if items is None else items
    reach = max(STATION + max(rows["a"].max(), rows["b"].max()), FRAME + wheels["frame"].max(initial=-FRAME))
    return Spans(
        rows, items, np.zeros(n + 1), wheels, np.zeros((n, SIZE)), np.zeros((n, 3)),
        np.zeros((n, 2)), np.zeros(n, np.int64), np.zeros(1, np.int64), np.full((2, reach), np.nan), np.zeros(1),
        new_line(), Motion(np.zeros((13, 3)), np.zeros(14)), np.zeros((14, 3)), np.zeros((8, 8)),
    )  # fmt: skip


__all__ = ["MATERIAL", "POINT", "SPAN", "STATION", "Spans", "add_by_tension", "new_spans"]
