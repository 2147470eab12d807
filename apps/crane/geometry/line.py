"""The taut line between two wheels or points, and how its length follows them, inside compiled code.

The line of direction e touches a wheel of signed radius rho about the unit axis a at rho w, w = e x a / |e x a|; psi is
the angle about a from the wheel's mark m to w. A rope from mark to mark is Lambda = l + rho1 psi1 - rho2 psi2 long.
With e' the part of e in a wheel's plane, of length c = cos(fleet angle), dw = e' dpsi / c and dpsi = -w.de / c (the
axis standing still), and so de = E dd for d = c2 - c1, with

    E = A^-1 (1 - e e^T),  A = l + (1 - e e^T) (rho2 e2' w2^T / c2^2 - rho1 e1' w1^T / c1^2),

whose inverse follows by Woodbury's formula from a 2 x 2 matrix. The gradient of Lambda is e at zero fleet angle, and

    g = dLambda/dd = e - E^T (rho1 (1 - c1)/c1 w1 - rho2 (1 - c2)/c2 w2)

in general: without the second term a rope that leaves its sheave askew would make energy out of nothing.
"""

from __future__ import annotations

from math import atan2, sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel

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
SETTLED = 1.0e-15
TURNED = 0.5
"""Largest change of a direction in one iteration."""


class Line(NamedTuple):
    """A line, and scratch.

    ``e, g, drift`` (3,): direction, gradient of its length, and the rate of e that turning wheels cause, 1/s; ``turn``
    (3, 3) is E, 1/m; ``wheel`` (2, 8, 3) holds of each wheel axis, mark, w, e' / c, the rates of axis and mark, b = a x
    m and the drift of w; ``number`` (8,) is indexed by names above.
    """

    e: np.ndarray
    g: np.ndarray
    drift: np.ndarray
    turn: np.ndarray
    wheel: np.ndarray
    number: np.ndarray


AXIS, MARK, W, PLANE, AXIS_RATE, MARK_RATE, B, DRIFT = range(8)


def new_line() -> Line:
    """Room for a line."""
    return Line(np.zeros(3), np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((2, 8, 3)), np.zeros(8))


@kernel
def dot(a, b):
    """Product of two vectors (3,)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def _cross(a, b, out):
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def _place(wheel, q, axis, mark, x):
    """Axis and mark of a wheel, or their rates, from its frame's columns in a full vector."""
    f = wheel.frame + COLUMNS
    for c in range(AXES):
        x[axis, c] = wheel.axis[0] * q[f + c] + wheel.axis[1] * q[f + 3 + c] + wheel.axis[2] * q[f + 6 + c]
        x[mark, c] = wheel.mark[0] * q[f + c] + wheel.mark[1] * q[f + 3 + c] + wheel.mark[2] * q[f + 6 + c]


@kernel
def _beside(e, x):
    """w and e' / c of a wheel for a direction; returns c, zero where the line runs along the axis."""
    _cross(e, x[AXIS], x[W])
    c = sqrt(dot(x[W], x[W]))
    if c == 0.0:
        return 0.0
    for k in range(AXES):
        x[W, k] /= c
    _cross(x[AXIS], x[W], x[PLANE])
    return c


@kernel
def _start(a, b, q, rho1, rho2, line):
    """Direction to begin with: that of the closed form for wheels of parallel axes, else of the centres."""
    e, number = line.e, line.number
    d2 = 0.0
    for c in range(AXES):
        e[c] = q[b + c] - q[a + c]
        d2 += e[c] * e[c]
    axis = line.wheel[0, AXIS] if rho1 != 0.0 else line.wheel[1, AXIS]
    delta = rho1 - rho2
    if d2 > delta * delta:
        l = sqrt(d2 - delta * delta)
        n = line.drift
        _cross(axis, e, n)
        for c in range(AXES):
            e[c] = l * e[c] + delta * n[c]
    size = sqrt(dot(e, e))
    number[FOUND] = 1.0 if size > 0.0 else 0.0
    for c in range(AXES):
        e[c] = e[c] / size if size > 0.0 else 0.0


@kernel
def _improve(a, b, q, rho1, rho2, line):
    """Newton's iteration on the direction: l e - x2(e) + x1(e) = d, across e. Returns l, or zero where no line is."""
    e, one, two = line.e, line.wheel[0], line.wheel[1]
    residual = line.g
    number = line.number
    for _ in range(MOST_ITERATIONS):
        c1 = c2 = 1.0
        if rho1 != 0.0:
            c1 = _beside(e, one)
        if rho2 != 0.0:
            c2 = _beside(e, two)
        if c1 == 0.0 or c2 == 0.0:
            return 0.0
        number[COS1], number[COS2] = c1, c2
        l = size = 0.0
        for c in range(AXES):
            residual[c] = q[b + c] - q[a + c] + rho2 * two[W, c] - rho1 * one[W, c]
            l += residual[c] * e[c]
            size += residual[c] * residual[c]
        if l <= 0.0:
            l = 0.1 * sqrt(size)
        worst = 0.0
        along = dot(residual, e)
        for c in range(AXES):
            residual[c] -= along * e[c]
            worst = max(worst, abs(residual[c]))
        # u_i = rho_i (e'_i - c_i e) / c_i^2: both vanish where the line lies in its wheels' planes.
        s12 = s21 = 0.0
        if rho1 != 0.0 and rho2 != 0.0:
            s12 = rho2 / c2 * dot(one[W], two[PLANE])
            s21 = -rho1 / c1 * dot(two[W], one[PLANE])
        y1, y2 = dot(one[W], residual), dot(two[W], residual)
        if rho1 == 0.0:
            y1 = 0.0
        if rho2 == 0.0:
            y2 = 0.0
        determinant = l * l - s12 * s21
        z1, z2 = (l * y1 - s12 * y2) / determinant, (l * y2 - s21 * y1) / determinant
        limit = 1.0
        for c in range(AXES):
            u1 = -rho1 / c1 * (one[PLANE, c] - c1 * e[c]) if rho1 != 0.0 else 0.0
            u2 = rho2 / c2 * (two[PLANE, c] - c2 * e[c]) if rho2 != 0.0 else 0.0
            residual[c] = (residual[c] - u1 * z1 - u2 * z2) / l
            limit = max(limit, abs(residual[c]) / TURNED)
        size = 0.0
        for c in range(AXES):
            e[c] += residual[c] / limit
            size += e[c] * e[c]
        size = sqrt(size)
        for c in range(AXES):
            e[c] /= size
        if worst <= SETTLED * (l + abs(rho1) + abs(rho2)):
            return along
    return 0.0 if worst > 1.0e-11 * (l + abs(rho1) + abs(rho2)) else along


@kernel
def _write_turn(rho1, rho2, l, line):
    """E and g."""
    e, g, turn, one, two, number = line.e, line.g, line.turn, line.wheel[0], line.wheel[1], line.number
    c1, c2 = number[COS1], number[COS2]
    s12 = s21 = 0.0
    if rho1 != 0.0 and rho2 != 0.0:
        s12 = rho2 / c2 * dot(one[W], two[PLANE])
        s21 = -rho1 / c1 * dot(two[W], one[PLANE])
    determinant = l * l - s12 * s21
    for i in range(AXES):
        u1 = -rho1 / c1 * (one[PLANE, i] - c1 * e[i]) if rho1 != 0.0 else 0.0
        u2 = rho2 / c2 * (two[PLANE, i] - c2 * e[i]) if rho2 != 0.0 else 0.0
        for j in range(AXES):
            w1 = one[W, j] if rho1 != 0.0 else 0.0
            w2 = two[W, j] if rho2 != 0.0 else 0.0
            unit = 1.0 if i == j else 0.0
            taken = u1 * (l * w1 - s12 * w2) / determinant + u2 * (l * w2 - s21 * w1) / determinant
            turn[i, j] = (unit - e[i] * e[j] - taken) / l
    k1 = rho1 * (1.0 - c1) / c1 if rho1 != 0.0 else 0.0
    k2 = rho2 * (1.0 - c2) / c2 if rho2 != 0.0 else 0.0
    for i in range(AXES):
        g[i] = e[i]
        for j in range(AXES):
            g[i] -= turn[j, i] * (k1 * one[W, j] - k2 * two[W, j])


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


@kernel
def _psi(x):
    return atan2(dot(x[W], x[B]), dot(x[W], x[MARK]))


@kernel
def find_line(a, b, wheel1, wheel2, wheels, q, v, start, line):
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
    line : Line
        What is found.
    """
    e, number = line.e, line.number
    number.fill(0.0)
    line.drift.fill(0.0)
    if wheel1 == POINT and wheel2 == POINT:
        size = 0.0
        for c in range(AXES):
            e[c] = q[b + c] - q[a + c]
            size += e[c] * e[c]
        size = sqrt(size)
        number[LENGTH] = number[PATH] = size
        number[COS1] = number[COS2] = 1.0
        number[FOUND] = 1.0 if size > 0.0 else 0.0
        h = 1.0 / size if size > 0.0 else 0.0
        for c in range(AXES):
            e[c] *= h
            line.g[c] = start[c] = e[c]
        for i in range(AXES):
            for j in range(AXES):
                line.turn[i, j] = ((1.0 if i == j else 0.0) - e[i] * e[j]) * h
        return
    rho1 = rho2 = 0.0
    turns = False
    if wheel1 != POINT:
        rho1 = wheels[wheel1].radius
        _place(wheels[wheel1], q, AXIS, MARK, line.wheel[0])
        turns = wheels[wheel1].turns == 1
    if wheel2 != POINT:
        rho2 = wheels[wheel2].radius
        _place(wheels[wheel2], q, AXIS, MARK, line.wheel[1])
        turns = turns or wheels[wheel2].turns == 1
    if start[0] == 0.0 and start[1] == 0.0 and start[2] == 0.0:
        _start(a, b, q, rho1, rho2, line)
        line.drift.fill(0.0)
    else:
        number[FOUND] = 1.0
        for c in range(AXES):
            e[c] = start[c]
    number[COS1] = number[COS2] = 1.0
    l = _improve(a, b, q, rho1, rho2, line)
    if not l > 0.0:
        number[FOUND] = 0.0
        l = 1.0e-9
    for c in range(AXES):
        start[c] = e[c] if number[FOUND] == 1.0 else 0.0
    path = l
    if rho1 != 0.0:
        number[COS1] = _beside(e, line.wheel[0])
        _cross(line.wheel[0, AXIS], line.wheel[0, MARK], line.wheel[0, B])
        number[PSI1] = _psi(line.wheel[0])
        path += rho1 * number[PSI1]
    if rho2 != 0.0:
        number[COS2] = _beside(e, line.wheel[1])
        _cross(line.wheel[1, AXIS], line.wheel[1, MARK], line.wheel[1, B])
        number[PSI2] = _psi(line.wheel[1])
        path -= rho2 * number[PSI2]
    number[LENGTH], number[PATH] = l, path
    _write_turn(rho1, rho2, l, line)
    if turns:
        _write_drift(wheel1, wheel2, wheels, rho1, rho2, l, v, line)


@kernel
def _drift_of_w(e, c, x, out):
    """Rate of w while e stands still and the axis turns: (1 - w w^T)(e x a.) / c."""
    _cross(e, x[AXIS_RATE], out)
    along = dot(out, x[W])
    for k in range(AXES):
        out[k] = (out[k] - along * x[W, k]) / c


@kernel
def _write_drift(wheel1, wheel2, wheels, rho1, rho2, l, v, line):
    """Rates of e and of Lambda that wheels cause which turn with their frames, the stations standing still."""
    number = line.number
    pull = line.drift
    pull.fill(0.0)
    for side in range(2):
        n, rho = (wheel1, -rho1) if side == 0 else (wheel2, rho2)
        if n == POINT:
            continue
        x = line.wheel[side]
        _place(wheels[n], v, AXIS_RATE, MARK_RATE, x)
        _drift_of_w(line.e, number[COS1 + side], x, x[DRIFT])
        for c in range(AXES):
            pull[c] += rho * x[DRIFT, c]
    # E already projects; it is applied in place.
    x, y, z = pull[0], pull[1], pull[2]
    for c in range(AXES):
        pull[c] = line.turn[c, 0] * x + line.turn[c, 1] * y + line.turn[c, 2] * z
    rate = 0.0
    for side in range(2):
        n, rho = (wheel1, rho1) if side == 0 else (wheel2, -rho2)
        if n == POINT:
            continue
        x = line.wheel[side]
        c = number[COS1 + side]
        swept = dot(x[W], line.drift)
        # psi counts from the mark, which turns along; the rim's point goes back along the line as e turns towards w.
        psi_d = -swept / c + dot(x[PLANE], x[DRIFT]) - dot(x[B], x[MARK_RATE])
        rate += rho * (swept + psi_d)
    number[RATE] = rate
