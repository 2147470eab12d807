"""Bending stiffness of a rope whose elements are straight: a discrete elastic curve, bent where two elements meet.

A station between elements of directions e1, e2 and free unstretched lengths h1, h2 has the kink phi, and s =
sin^2(phi / 2) = |e2 - e1|^2 / 4. Half of each element is bent there by

    kappa^2 = u = f(s) / h^2,  h = (h1 + h2) / 2,  f = 4 (s + s^2 / 3 + 8 s^3 / 45),  V = EJ h u / 2.

f is phi^2 up to the power phi^8, as for an arc of a circle; being a polynomial of the directions it has smooth forces
through straight, and through a fold, where those of tan(phi / 2) would grow beyond bounds.

What is lost is EJ c h kappa.^2, smoothed as in ``tautline.elements.beam.bending``: EJ c h u.^2 / (u + k0^2) / 4. u does
not change while the rope turns as a rigid body. As u is that of the station, a particle that runs through a curve which
stands still loses nothing.

Next to a wheel an element is the line that touches it (`crane.geometry.line`), and free is what does not lie on the
wheel: h_i = L - rho1 psi1 + rho2 psi2, the strain on the wheel being neglected. Its direction is that of the rope at
the wheel, not in its middle, so that all of its length is bent at the next station: h = h1 + h2 / 2. With
`crane.groups.arcs` the energy is then stationary where the rope leaves the wheel with the curvature 1 / R, as an
elastica does; meshes show it that are far finer than sqrt(EJ / T). On others the rope runs EJ / (2 T R) beside the line
that touches the wheel all the same.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import AXES, COS1, LENGTH, PATH, POINT, RATE, Line, W, find_line, new_line, write_turn
from crane.geometry.turning import TURNED_Z, Y, add_psi, add_turning, radius_of, sandwich
from crane.groups.span import MATERIAL, STATION, turns_with_frame
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import EMPTY, register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

BEND = np.dtype([("first", "i8"), ("second", "i8"), ("stiffness", "f8"), ("damping", "f8"), ("smoothing", "f8")])
"""A kink: numbers of the spans before and after its station, EJ N m^2, c s, k0 1/m."""
PAIR = 2 * STATION
SHAPE, SHAPE_1, SHAPE_2, MEAN, HELD_1, HELD_2 = range(6)
"""Places in ``number``: f and its derivatives by s, h (m), and the rates of h that wheels turning at either
end cause (m/s)."""


class Bends(NamedTuple):
    """Kinks (n,) of ``BEND`` between spans of ``SPAN``, over ``wheels`` of ``WHEEL``.

    The stations of a kink are equally far from one another in the full vectors. ``start`` (spans, 3) holds directions,
    ``turned`` (spans, 2) psi of the accepted lines. Scratch: ``before``, ``after`` the lines; ``number`` (6,); ``kink``
    (3,) is e2 - e1, ``share`` (2,) dh/dh_i, ``reach`` (2, 3) dh/de_i; ``gradient`` (4, 8) and ``hessian`` (2, 8, 8) go
    by (d1, L1, d2, L2); ``vector`` (3, 3), ``middle`` (3, 3), ``block`` (12, 12).
    """

    rows: np.recarray
    spans: np.recarray
    wheels: np.recarray
    start: np.ndarray
    turned: np.ndarray
    before: Line
    after: Line
    number: np.ndarray
    kink: np.ndarray
    share: np.ndarray
    reach: np.ndarray
    gradient: np.ndarray
    hessian: np.ndarray
    vector: np.ndarray
    middle: np.ndarray
    block: np.ndarray


FORCE, BY_U, BY_H, SPEED = range(4)
"""Rows of ``gradient``: of the energy and the dissipation, of u, of h; and the rates of (d1, L1, d2, L2)."""


@kernel
def _write_side(g, n, side, line, q, v):
    """Line of one element, and how h follows its direction; returns its part of h."""
    s = g.spans[n]
    find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, v, g.start[n], g.turned[n], line)
    write_turn(line)
    number, reach = line.number, g.reach[side]
    share = 0.5 if s.wheel1 == POINT and s.wheel2 == POINT else 1.0
    held = -number[RATE]
    for c in range(AXES):
        reach[c] = 0.0
        sign = 1.0 if side == 1 else -1.0
        g.kink[c] += sign * line.e[c]
    for end in range(2):
        n_wheel = s.wheel1 if end == 0 else s.wheel2
        if n_wheel != POINT:
            w = line.wheel[end, W]
            rho = g.wheels[n_wheel].radius if end == 0 else -g.wheels[n_wheel].radius
            held += rho * dot(w, line.drift)
            for c in range(AXES):
                reach[c] += share * rho / number[COS1 + end] * w[c]
    g.share[side] = share
    g.number[HELD_1 + side] = share * held
    return share * (q[s.b + MATERIAL] - q[s.a + MATERIAL] - (number[PATH] - number[LENGTH]))


@kernel
def _write_kink(g, row, q, v):
    """Both lines, f and h of a kink; returns u."""
    g.kink.fill(0.0)
    h = _write_side(g, row.first, 0, g.before, q, v) + _write_side(g, row.second, 1, g.after, q, v)
    s = 0.25 * dot(g.kink, g.kink)
    number = g.number
    number[MEAN] = h
    number[SHAPE] = 4.0 * s * (1.0 + s * (1.0 / 3.0 + s * (8.0 / 45.0)))
    number[SHAPE_1] = 4.0 + s * (8.0 / 3.0 + s * (32.0 / 15.0))
    number[SHAPE_2] = 8.0 / 3.0 + s * (64.0 / 15.0)
    return number[SHAPE] / (h * h)


@kernel
def _write_gradient(g, value, slope, out):
    """Gradient of f P(h) by (d1, L1, d2, L2), for P and its derivative."""
    by_e, by_h = 0.5 * value * g.number[SHAPE_1], slope * g.number[SHAPE]
    for side in range(2):
        turn, sign = (g.before.turn, -by_e) if side == 0 else (g.after.turn, by_e)
        for c in range(AXES):
            g.vector[Y, c] = sign * g.kink[c] + by_h * g.reach[side, c]
        for c in range(AXES):
            out[STATION * side + c] = (
                turn[0, c] * g.vector[Y, 0] + turn[1, c] * g.vector[Y, 1] + turn[2, c] * g.vector[Y, 2]
            )
        out[STATION * side + MATERIAL] = by_h * g.share[side]


@kernel
def _held_rate(g, value, slope):
    """Rate of f P(h) that turning wheels cause while the stations stand still."""
    turned = 0.0
    for c in range(AXES):
        turned += g.kink[c] * (g.after.drift[c] - g.before.drift[c])
    held = g.number[HELD_1] + g.number[HELD_2]
    return 0.5 * value * g.number[SHAPE_1] * turned + slope * g.number[SHAPE] * held


@kernel
def _write_hessian(g, row, value, slope, second, out):
    """Second derivatives of f P(h) by (d1, L1, d2, L2), for P and its derivatives."""
    number, kink, m = g.number, g.kink, g.middle
    ee, e, eh, hh = (
        0.25 * value * number[SHAPE_2], 0.5 * value * number[SHAPE_1], 0.5 * slope * number[SHAPE_1],
        second * number[SHAPE],
    )  # fmt: skip
    by_h = slope * number[SHAPE]
    for one in range(2):
        left, sign1 = (g.before, -1.0) if one == 0 else (g.after, 1.0)
        for two in range(2):
            right, sign2 = (g.before, -1.0) if two == 0 else (g.after, 1.0)
            for i in range(AXES):
                k1, x1 = sign1 * kink[i], g.reach[one, i]
                for j in range(AXES):
                    k2, x2 = sign2 * kink[j], g.reach[two, j]
                    m[i, j] = ee * k1 * k2 + eh * (k1 * x2 + x1 * k2) + hh * x1 * x2
                m[i, i] += sign1 * sign2 * e
            if one == two:
                s = g.spans[row.first if one == 0 else row.second]
                rho1, rho2 = radius_of(g.wheels, s.wheel1), radius_of(g.wheels, s.wheel2)
                if rho1 != 0.0:
                    add_psi(left, 0, -by_h * g.share[one] * rho1, m)
                if rho2 != 0.0:
                    add_psi(left, 1, by_h * g.share[one] * rho2, m)
                for c in range(AXES):
                    g.vector[Y, c] = sign1 * e * kink[c] + by_h * g.reach[one, c]
                add_turning(left, rho1, rho2, g.vector, m)
            row_at, column_at = STATION * one, STATION * two
            sandwich(left.turn, m, right.turn, out, row_at, column_at)
            for i in range(AXES):
                by_1 = by_2 = 0.0
                for k in range(AXES):
                    by_1 += left.turn[k, i] * (eh * sign1 * kink[k] + hh * g.reach[one, k])
                    by_2 += right.turn[k, i] * (eh * sign2 * kink[k] + hh * g.reach[two, k])
                out[row_at + i, column_at + MATERIAL] = by_1 * g.share[two]
                out[row_at + MATERIAL, column_at + i] = by_2 * g.share[one]
                if one == two:
                    for j in range(AXES):
                        out[row_at + i, column_at + j] -= (
                            left.e[i] * g.vector[TURNED_Z, j] + g.vector[TURNED_Z, i] * left.e[j]
                        )
            out[row_at + MATERIAL, column_at + MATERIAL] = hh * g.share[one] * g.share[two]


@kernel
def _speed(g, row, v):
    """Write the gradient of u and the rates of (d1, L1, d2, L2); returns u.."""
    h = g.number[MEAN]
    value, slope = 1.0 / (h * h), -2.0 / (h * h * h)
    _write_gradient(g, value, slope, g.gradient[BY_U])
    rate = _held_rate(g, value, slope)
    for side in range(2):
        s = g.spans[row.first if side == 0 else row.second]
        for c in range(STATION):
            k = STATION * side + c
            g.gradient[SPEED, k] = v[s.b + c] - v[s.a + c]
            rate += g.gradient[BY_U, k] * g.gradient[SPEED, k]
    return rate


@kernel
def _viscosity(row, u):
    """c EJ / (u + k0^2) / 4: times h u. it is the viscous force upon u."""
    return 0.25 * row.damping * row.stiffness / (u + row.smoothing * row.smoothing)


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.rows.size):
        row = g.rows[i]
        u = _write_kink(g, row, q, v)
        h = g.number[MEAN]
        value, slope = 0.5 * row.stiffness / h, -0.5 * row.stiffness / (h * h)
        if row.damping != 0.0:
            force = _viscosity(row, u) * h * _speed(g, row, v)
            value += force / (h * h)
            slope -= 2.0 * force / (h * h * h)
        _write_gradient(g, value, slope, g.gradient[FORCE])
        first, second = g.spans[row.first], g.spans[row.second]
        for c in range(STATION):
            one, two = g.gradient[FORCE, c], g.gradient[FORCE, STATION + c]
            r[first.a + c] -= one
            r[first.b + c] += one - two
            r[second.b + c] += two


@kernel
def _add_viscous(g, row, u, rate, cc, ck):
    """Add to the tangent what the viscous force upon u changes by, along the gradient of u."""
    gradient, h = g.gradient, g.number[MEAN]
    k = _viscosity(row, u)
    fading = k * h * rate / (u + row.smoothing * row.smoothing)
    _write_hessian(g, row, 1.0 / h**2, -2.0 / h**3, 6.0 / h**4, g.hessian[1])
    # h by itself, as f P(h) would have it with f = 1
    for side in range(2):
        turn = g.before.turn if side == 0 else g.after.turn
        for c in range(AXES):
            gradient[BY_H, STATION * side + c] = (
                turn[0, c] * g.reach[side, 0] + turn[1, c] * g.reach[side, 1] + turn[2, c] * g.reach[side, 2]
            )
        gradient[BY_H, STATION * side + MATERIAL] = g.share[side]
    for j in range(PAIR):
        turned = 0.0
        for i in range(PAIR):
            turned += g.hessian[1, i, j] * gradient[SPEED, i]
        by = (cc * k * h - ck * fading) * gradient[BY_U, j] + ck * k * (h * turned + rate * gradient[BY_H, j])
        for i in range(PAIR):
            g.hessian[0, i, j] += gradient[BY_U, i] * by


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    """Exact, but for what damping has of the turning of wheels with their frames."""
    block = g.block
    for n in range(g.rows.size):
        row = g.rows[n]
        u = _write_kink(g, row, q, v)
        h = g.number[MEAN]
        value, slope, second = 0.5 * row.stiffness / h, -0.5 * row.stiffness / h**2, row.stiffness / h**3
        rate = 0.0
        if row.damping != 0.0:
            rate = _speed(g, row, v)
            force = _viscosity(row, u) * h * rate
            value += force / h**2
            slope -= 2.0 * force / h**3
            second += 6.0 * force / h**4
        _write_hessian(g, row, ck * value, ck * slope, ck * second, g.hessian[0])
        if row.damping != 0.0:
            _add_viscous(g, row, u, rate, cc, ck)
        block.fill(0.0)
        for one in range(2):
            for two in range(2):
                for x in range(STATION):
                    for y in range(STATION):
                        k = g.hessian[0, STATION * one + x, STATION * two + y]
                        i, j = STATION * one + x, STATION * two + y
                        block[i, j] += k
                        block[i, j + STATION] -= k
                        block[i + STATION, j] -= k
                        block[i + STATION, j + STATION] += k
        s = g.spans[row.first]
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, block)


@kernel
def _energy(g, t, q, v, energy):
    for i in range(g.rows.size):
        u = _write_kink(g, g.rows[i], q, v)
        energy[1] += 0.5 * g.rows[i].stiffness * g.number[MEAN] * u


@kernel
def _dissipation(g, t, q, v, p):
    for i in range(g.rows.size):
        row = g.rows[i]
        if row.damping != 0.0:
            u = _write_kink(g, row, q, v)
            p[0] += _viscosity(row, u) * g.number[MEAN] * _speed(g, row, v) ** 2


@kernel
def _supply(g, t, q, v, p):
    """What wheels that turn with their frames put in while the stations stand still."""
    for i in range(g.rows.size):
        row = g.rows[i]
        before, after = g.spans[row.first], g.spans[row.second]
        if not (turns_with_frame(before, g.wheels) or turns_with_frame(after, g.wheels)):
            continue
        u = _write_kink(g, row, q, v)
        h = g.number[MEAN]
        p[0] += 0.5 * row.stiffness * _held_rate(g, 1.0 / h, -1.0 / (h * h))
        if row.damping != 0.0:
            force = _viscosity(row, u) * h * _speed(g, row, v)
            p[0] += force * _held_rate(g, 1.0 / (h * h), -2.0 / (h * h * h))


@kernel
def _alarm(g, t, q, alarm):
    """A kink that has no free rope about it."""
    for i in range(g.rows.size):
        _write_kink(g, g.rows[i], q, q)
        if not g.number[MEAN] > 0.0:
            alarm[0], alarm[1] = EMPTY, g.spans[g.rows[i].first].b
            return


register(
    Bends, residual=_residual, tangent=_tangent, energy=_energy, dissipation=_dissipation, supply=_supply, alarm=_alarm
)


def new_bends(
    spans: np.recarray, wheels: np.recarray, stiffness: float, damping: float = 0.0, smoothing: float = 0.0,
    turned: np.ndarray | None = None,
) -> Bends:  # fmt: skip
    """Kinks of a rope at all stations between two spans that touch no wheel there.

    Parameters
    ----------
    spans : (n,) records of ``SPAN``
        Along the rope.
    wheels : (m,) records of ``WHEEL``
    stiffness : float
        EJ, N m^2.
    damping : float
        c, s.
    smoothing : float
        k0, 1/m; needed where there is damping.
    turned : (n, 2) array, optional
        Both psi of each span's accepted line, that of :class:`crane.groups.span.Spans`; zeros where nothing goes round.

    Raises
    ------
    ValueError
        For damping without smoothing, and for stations that are not equally far apart in the full vectors.
    """
    if damping != 0.0 and not smoothing > 0.0:
        raise ValueError("damping of bending needs a smoothing > 0")
    turned = np.zeros((len(spans), 2)) if turned is None else turned
    rows = []
    for n in range(len(spans) - 1):
        one, two = spans[n], spans[n + 1]
        if one.b == two.a and one.wheel2 == POINT and two.wheel1 == POINT:
            if one.b - one.a != two.b - two.a:
                raise ValueError(f"stations {one.a}, {one.b} and {two.b} are not equally far apart")
            rows.append((n, n + 1, stiffness, damping, smoothing))
    return Bends(
        np.array(rows, BEND).view(np.recarray), spans, wheels, np.zeros((len(spans), 3)), turned, new_line(),
        new_line(), np.zeros(6), np.zeros(3), np.zeros(2), np.zeros((2, 3)), np.zeros((4, PAIR)),
        np.zeros((2, PAIR, PAIR)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3 * STATION, 3 * STATION)),
    )  # fmt: skip


def stencils(bends: Bends) -> np.ndarray:
    """Places (n, 12) that each kink couples, for the numbering of unknowns."""
    first = np.array([bends.spans[n].a for n in bends.rows.first], dtype=np.int64)
    step = np.array([bends.spans[n].b - bends.spans[n].a for n in bends.rows.first], dtype=np.int64)
    places = first[:, None, None] + step[:, None, None] * np.arange(3)[:, None] + np.arange(STATION)
    return places.reshape(-1, 3 * STATION)
