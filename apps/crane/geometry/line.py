"""The taut line between two wheels or points, and how its length follows them, inside compiled code.

The line of direction e touches a wheel of signed radius rho about the unit axis a at rho w, w = e x a / |e x a|; psi is
the angle about a from the wheel's mark m to w, whole turns among it: a line may go round its wheel. A rope from mark to
mark is Lambda = l + rho1 psi1 - rho2 psi2 long. With e' the part of e in a wheel's plane, of length c = cos(fleet
angle), dw = e' dpsi / c and dpsi = -w.de / c (the axis standing still), and so de = E dd for d = c2 - c1, with

    E = A^-1 (1 - e e^T),  A = l + (1 - e e^T) (rho2 e2' w2^T / c2^2 - rho1 e1' w1^T / c1^2),

whose inverse follows by Woodbury's formula from a 2 x 2 matrix. The gradient of Lambda is e at zero fleet angle, and

    g = dLambda/dd = e - E^T (rho1 (1 - c1)/c1 w1 - rho2 (1 - c2)/c2 w2)

in general: without the second term a rope that leaves its sheave askew would make energy out of nothing.
"""

from __future__ import annotations

from math import atan2, floor, pi, sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.kernels.vector import cross, dot, scaled, scaled_sum

AXES = 3
WHEEL = np.dtype([("frame", "i8"), ("radius", "f8"), ("axis", "f8", (3,)), ("mark", "f8", (3,)), ("turns", "i8")])
"""A wheel: where its frame begins in the full vectors, signed radius m, unit axis and mark in its frame, and whether
that frame turns."""
POINT = -1
"""In place of a wheel's number: a point."""
COLUMNS = 3
"""Place of the first column of a frame's rotation after its origin."""
LENGTH, PATH, PSI1, PSI2, COS1, COS2, RATE, FOUND = range(8)
"""Places in ``number``: l, Lambda (m), both psi (rad), both cosines of fleet angles, the rate of Lambda at which wheels
that turn with their frames change it (m/s), and whether a line exists (1 or 0)."""
MOST_ITERATIONS = 60
SETTLED, STALLED = 1.0e-15, 1.0e-11
"""Distance across the line between where it ends and where it should, over its size, at which it is found; and at which
it is, too, when an iteration brings it no nearer."""
TURNED = 0.5
"""Largest change of a direction in one iteration."""
NO_LENGTH = 1.0e-9
"""Length, m, in place of that of a line which does not exist."""
ZERO = (0.0, 0.0, 0.0)


class Line(NamedTuple):
    """A line, and scratch.

    ``e, g, drift`` (3,): direction, gradient of its length, and the rate of e that turning wheels cause, 1/s; ``turn``
    (3, 3) is E, 1/m, where :func:`write_turn` was asked for it; ``wheel`` (2, 8, 3) holds of each wheel axis, mark, w,
    e' / c, the rates of axis and mark, b = a x m and the drift of w; ``bend`` (2, 2, 3) holds of each wheel the
    vectors of :class:`Bend`; ``number`` (8,) is indexed by names above.
    """

    e: np.ndarray
    g: np.ndarray
    drift: np.ndarray
    turn: np.ndarray
    wheel: np.ndarray
    bend: np.ndarray
    number: np.ndarray


AXIS, MARK, W, PLANE, AXIS_RATE, MARK_RATE, B, DRIFT = range(8)
U, ACROSS = range(2)


def new_line() -> Line:
    """Room for a line."""
    return Line(
        np.zeros(3), np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((2, 8, 3)), np.zeros((2, 2, 3)), np.zeros(8)
    )


# Vectors are tuples of three numbers here, which stay in registers; where they are kept they are rows of arrays.


@kernel(forceinline=True)
def row(a):
    """A row of an array as a vector."""
    return a[0], a[1], a[2]


@kernel(forceinline=True)
def place(q, i):
    """Three numbers of a full vector from a place on."""
    return q[i], q[i + 1], q[i + 2]


@kernel(forceinline=True)
def write(a, out):
    """Keep a vector in a row of an array."""
    out[0], out[1], out[2] = a


@kernel(forceinline=True)
def difference(a, b, q):
    """What leads from place b of a full vector to place a."""
    return scaled_sum(place(q, a), -1.0, place(q, b))


@kernel(forceinline=True)
def _turned(x, f, q):
    """A vector of a frame, or its rate, by the frame's columns in a full vector; f is where the frame begins."""
    a, b, c = f + COLUMNS, f + COLUMNS + 3, f + COLUMNS + 6
    return scaled_sum(scaled_sum(scaled(x[0], place(q, a)), x[1], place(q, b)), x[2], place(q, c))


class Rim(NamedTuple):
    """Where a line touches a wheel of signed radius ``rho``, m: w, e' / c and c. Of a point zeros, and c = 1.

    c is 0 where a line runs along the axis, and touches nowhere.
    """

    rho: float
    w: tuple
    plane: tuple
    c: float


@kernel(forceinline=True)
def _rim(e, axis, rho):
    """Where a line of direction e touches a wheel."""
    if rho == 0.0:
        return Rim(rho, ZERO, ZERO, 1.0)
    across = cross(e, axis)
    c = sqrt(dot(across, across))
    w = scaled(1.0 / c if c > 0.0 else 0.0, across)
    return Rim(rho, w, cross(axis, w), c)


class Bend(NamedTuple):
    """E in parts: E x = (x - e (e.x) - u1 (t1.x) - u2 (t2.x)) / l, by Woodbury's formula."""

    e: tuple
    over_l: float
    u1: tuple
    t1: tuple
    u2: tuple
    t2: tuple


@kernel(forceinline=True)
def _bend(e, l, one, two):
    """E of a line of length l between two rims: u_i = rho_i (e'_i - c_i e) / c_i^2, and u_1 with the other sign."""
    f1, f2 = -one.rho / one.c, two.rho / two.c
    s12, s21 = f2 * dot(one.w, two.plane), f1 * dot(two.w, one.plane)
    over = 1.0 / (l * l - s12 * s21)
    return Bend(
        e,
        1.0 / l,
        scaled(f1, scaled_sum(one.plane, -one.c, e)),
        scaled(over, scaled_sum(scaled(l, one.w), -s12, two.w)),
        scaled(f2, scaled_sum(two.plane, -two.c, e)),
        scaled(over, scaled_sum(scaled(l, two.w), -s21, one.w)),
    )


@kernel(forceinline=True)
def apply(b, x):
    """E x: how the direction turns while its end moves by x."""
    y = scaled_sum(scaled_sum(scaled_sum(x, -dot(b.e, x), b.e), -dot(b.t1, x), b.u1), -dot(b.t2, x), b.u2)
    return scaled(b.over_l, y)


@kernel(forceinline=True)
def apply_back(b, x):
    """E^T x."""
    y = scaled_sum(scaled_sum(scaled_sum(x, -dot(b.e, x), b.e), -dot(b.u1, x), b.t1), -dot(b.u2, x), b.t2)
    return scaled(b.over_l, y)


@kernel(forceinline=True)
def bend_of(line):
    """E of the line that was found last."""
    b, l = line.bend, line.number[LENGTH]
    over_l = 1.0 / l if l > 0.0 else 0.0
    return Bend(row(line.e), over_l, row(b[0, U]), row(b[0, ACROSS]), row(b[1, U]), row(b[1, ACROSS]))


@kernel
def write_turn(line):
    """Write E as a matrix."""
    b = bend_of(line)
    for i in range(AXES):
        for j in range(AXES):
            unit = 1.0 if i == j else 0.0
            taken = line.e[i] * line.e[j] + line.bend[0, U, i] * line.bend[0, ACROSS, j]
            line.turn[i, j] = (unit - taken - line.bend[1, U, i] * line.bend[1, ACROSS, j]) * b.over_l


@kernel(forceinline=True)
def _first_direction(d, axis, delta):
    """Direction to begin with: that of the closed form for wheels of parallel axes, else of the centres; or zero."""
    d2 = dot(d, d)
    e = d
    if d2 > delta * delta:
        e = scaled_sum(scaled(sqrt(d2 - delta * delta), d), delta, cross(axis, d))
    size = sqrt(dot(e, e))
    return scaled(1.0 / size if size > 0.0 else 0.0, e)


@kernel(forceinline=True)
def _improve(d, e, axis1, rho1, axis2, rho2):
    """Newton's iteration on the direction: l e - x2(e) + x1(e) = d, across e.

    Returns e, l and both rims; l is 0 where no line is.
    """
    size, last = abs(rho1) + abs(rho2), np.inf
    one, two = _rim(e, axis1, rho1), _rim(e, axis2, rho2)
    for _ in range(MOST_ITERATIONS):
        if one.c == 0.0 or two.c == 0.0:
            break
        chord = scaled_sum(scaled_sum(d, rho2, two.w), -rho1, one.w)
        along = dot(chord, e)
        across = scaled_sum(chord, -along, e)
        wrong = max(abs(across[0]), abs(across[1]), abs(across[2]))
        l = along if along > 0.0 else 0.1 * sqrt(dot(chord, chord))
        if wrong <= SETTLED * (l + size) or (wrong >= last and wrong <= STALLED * (l + size)):
            return e, along, one, two
        last = wrong
        # What is left across the line, over its length, is how far it turns.
        de = apply(_bend(e, l, one, two), across)
        turned = max(abs(de[0]), abs(de[1]), abs(de[2]))
        e = scaled_sum(e, TURNED / turned if turned > TURNED else 1.0, de)
        e = scaled(1.0 / sqrt(dot(e, e)), e)
        one, two = _rim(e, axis1, rho1), _rim(e, axis2, rho2)
    return e, 0.0, one, two


@kernel
def vary_gradient(rho1, rho2, line, move, de, y, dg):
    """Change of g while d moves by ``move`` and e, with it, by ``de``: the Hessian of Lambda, applied.

    With s = rho1 (1 - c1)/c1 w1 - rho2 (1 - c2)/c2 w2 and sigma = E^T s it is g = e - sigma. From A E = 1 - e e^T,

        dg = de + e (de.sigma) + E^T (dA^T sigma - ds),   dA = dl + d((1 - e e^T) B),

    where B is the bracket of A. A and s are made of e, w, e'/c and c alone, and of these
    dw = -(e'/c) u, d(e'/c) = w u, dc = -(e.a)(a.de)/c with u = w.de/c. ``y`` (3,) is scratch.
    """
    e, number = line.e, line.number
    if rho1 == 0.0 and rho2 == 0.0:
        for k in range(AXES):
            dg[k] = de[k]
        return
    dl = turned = 0.0
    for k in range(AXES):
        dl += e[k] * move[k]
        turned += de[k] * (e[k] - line.g[k])
        y[k] = 0.0
    for side in range(2):
        rho = -rho1 if side == 0 else rho2
        if rho == 0.0:
            continue
        x, c = line.wheel[side], number[COS1 + side]
        u = dot(x[W], de) / c
        dc = -dot(e, x[AXIS]) * dot(x[AXIS], de) / c
        swept = dot(x[PLANE], e) - dot(x[PLANE], line.g)
        grown = dot(x[W], e) - dot(x[W], line.g)
        dl -= rho * u * dot(e, x[PLANE])
        for k in range(AXES):
            dw = -u * x[PLANE, k]
            # dB^T sigma, and what s loses.
            y[k] += rho * ((dw * swept + x[W, k] * u * grown) / c - dc / (c * c) * x[W, k] * swept)
            y[k] += rho * ((1.0 - c) / c * dw - dc / (c * c) * x[W, k]) - rho * turned * x[W, k]
    for k in range(AXES):
        y[k] += dl * (e[k] - line.g[k])
    for k in range(AXES):
        dg[k] = de[k] + e[k] * turned
        for j in range(AXES):
            dg[k] += line.turn[j, k] * y[j]


@kernel(forceinline=True)
def _psi(rim, axis, mark, before):
    """psi of a rim, by whole turns as near as can be to what it was before: a line may go round its wheel."""
    psi = atan2(dot(rim.w, cross(axis, mark)), dot(rim.w, mark))
    return psi + 2.0 * pi * floor((before - psi) / (2.0 * pi) + 0.5)


@kernel
def _find_straight(d, start, line):
    """The line between two points."""
    size = sqrt(dot(d, d))
    h = 1.0 / size if size > 0.0 else 0.0
    e, number = scaled(h, d), line.number
    number[LENGTH] = number[PATH] = size
    number[COS1] = number[COS2] = 1.0
    number[PSI1] = number[PSI2] = number[RATE] = 0.0
    number[FOUND] = 1.0 if size > 0.0 else 0.0
    for c in range(AXES):
        line.e[c] = line.g[c] = start[c] = e[c]
        line.drift[c] = 0.0
    line.bend.fill(0.0)


@kernel
def find_line(a, b, wheel1, wheel2, wheels, q, v, start, turned, line):
    """Find the line between two stations, and how it follows them.

    Parameters
    ----------
    a, b : int
        Where the stations' positions begin in the full vectors.
    wheel1, wheel2 : int
        Numbers of the wheels there, or ``POINT``.
    wheels : (n,) records of ``WHEEL``
    q, v : full vectors
    start : (3,) array
        Direction to begin with, or zeros; the direction found is left there.
    turned : (2,) array
        Both psi of the last accepted state: those found are less than half a turn away from them.
    line : Line
        What is found, but for ``turn``.
    """
    d = difference(b, a, q)
    if wheel1 == POINT and wheel2 == POINT:
        _find_straight(d, start, line)
        return
    rho1 = rho2 = 0.0
    axis1 = mark1 = axis2 = mark2 = ZERO
    turns, number = False, line.number
    if wheel1 != POINT:
        wheel = wheels[wheel1]
        rho1, turns = wheel.radius, wheel.turns == 1
        axis1, mark1 = _turned(wheel.axis, wheel.frame, q), _turned(wheel.mark, wheel.frame, q)
    if wheel2 != POINT:
        wheel = wheels[wheel2]
        rho2, turns = wheel.radius, turns or wheel.turns == 1
        axis2, mark2 = _turned(wheel.axis, wheel.frame, q), _turned(wheel.mark, wheel.frame, q)
    e = row(start)
    if e[0] == 0.0 and e[1] == 0.0 and e[2] == 0.0:
        e = _first_direction(d, axis1 if rho1 != 0.0 else axis2, rho1 - rho2)
    e, l, one, two = _improve(d, e, axis1, rho1, axis2, rho2)
    found = l > 0.0
    if not found:
        l = NO_LENGTH
    write(e if found else ZERO, start)
    psi1 = _psi(one, axis1, mark1, turned[0]) if rho1 != 0.0 else 0.0
    psi2 = _psi(two, axis2, mark2, turned[1]) if rho2 != 0.0 else 0.0
    bend = _bend(e, l, one, two)
    # g = e - E^T (k1 w1 - k2 w2): the second part is that of the fleet angles.
    k1, k2 = rho1 * (1.0 - one.c) / one.c, rho2 * (1.0 - two.c) / two.c
    write(scaled_sum(e, -1.0, apply_back(bend, scaled_sum(scaled(k1, one.w), -k2, two.w))), line.g)
    number[LENGTH], number[PATH] = l, l + rho1 * psi1 - rho2 * psi2
    number[PSI1], number[PSI2], number[COS1], number[COS2] = psi1, psi2, one.c, two.c
    number[RATE], number[FOUND] = 0.0, 1.0 if found else 0.0
    _keep(e, bend, line)
    _keep_rim(one, axis1, mark1, line.wheel[0])
    _keep_rim(two, axis2, mark2, line.wheel[1])
    if turns:
        _write_drift(wheel1, wheel2, wheels, one, two, bend, v, line)
    else:
        write(ZERO, line.drift)


@kernel(forceinline=True)
def _keep(e, bend, line):
    write(e, line.e)
    write(bend.u1, line.bend[0, U])
    write(bend.t1, line.bend[0, ACROSS])
    write(bend.u2, line.bend[1, U])
    write(bend.t2, line.bend[1, ACROSS])


@kernel(forceinline=True)
def _keep_rim(rim, axis, mark, x):
    write(axis, x[AXIS])
    write(mark, x[MARK])
    write(rim.w, x[W])
    write(rim.plane, x[PLANE])
    write(cross(axis, mark), x[B])


@kernel(forceinline=True)
def _drift_of_w(e, rim, axis_d):
    """Rate of w while e stands still and the axis turns: (1 - w w^T)(e x a.) / c."""
    swept = cross(e, axis_d)
    return scaled(1.0 / rim.c, scaled_sum(swept, -dot(swept, rim.w), rim.w))


@kernel(forceinline=True)
def _rate_of_psi(rim, x, drift):
    """Rates of w along itself and of psi. psi counts from the mark, which turns along; the rim's point goes back along
    the line as e turns towards w."""
    swept = dot(rim.w, drift)
    return swept + dot(rim.plane, x[DRIFT]) - dot(x[B], x[MARK_RATE]) - swept / rim.c


@kernel
def _write_drift(wheel1, wheel2, wheels, one, two, bend, v, line):
    """Rates of e and of Lambda that wheels cause which turn with their frames, the stations standing still."""
    pull, x1, x2 = ZERO, line.wheel[0], line.wheel[1]
    if wheel1 != POINT:
        wheel = wheels[wheel1]
        write(_turned(wheel.axis, wheel.frame, v), x1[AXIS_RATE])
        write(_turned(wheel.mark, wheel.frame, v), x1[MARK_RATE])
        write(_drift_of_w(bend.e, one, x1[AXIS_RATE]), x1[DRIFT])
        pull = scaled_sum(pull, -one.rho, x1[DRIFT])
    if wheel2 != POINT:
        wheel = wheels[wheel2]
        write(_turned(wheel.axis, wheel.frame, v), x2[AXIS_RATE])
        write(_turned(wheel.mark, wheel.frame, v), x2[MARK_RATE])
        write(_drift_of_w(bend.e, two, x2[AXIS_RATE]), x2[DRIFT])
        pull = scaled_sum(pull, two.rho, x2[DRIFT])
    drift = apply(bend, pull)
    write(drift, line.drift)
    rate = 0.0
    if wheel1 != POINT:
        rate += one.rho * _rate_of_psi(one, x1, drift)
    if wheel2 != POINT:
        rate -= two.rho * _rate_of_psi(two, x2, drift)
    line.number[RATE] = rate
