"""Pipes that convey a fluid: inertia of both, tension, bending and damping of one cubic element in one loop.

Where the fluid shares position and slope with the pipe, so that only its material moves, their elements are one: the
sum of `Inertia`, `SharedFlow`, `Tension`, `Bending` and `BendingDamping`, whose formulas these are. What it saves is
the walk through nodes, points and places in the matrix, five times over. One place in the full vectors has the rate at
which the fluid's p falls behind the nodes. The strains depend on r_b - r_a, r'_a and r'_b alone: the inner block.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.beam.curvature import square_of
from tautline.elements.cubic import AXES, VECTORS
from tautline.elements.shared_flow import C, D, E, M, times_c, times_e
from tautline.elements.tension import strain_of
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.hermite import FIRST, SECOND, WEIGHT
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

PIPE = np.dtype(
    [("a", "i8"), ("b", "i8"), ("flow", "i8")]
    + [(name, "f8") for name in ("length", "mass", "fluid", "stiffness", "bending", "damping")]
    + [("gravity", "f8", (3,)), ("engineering", "i8"), ("slack", "i8")]
)  # fmt: skip
"""An element: its nodes' places and that of the fluid's p; L m, mass of pipe and of fluid kg/m, EA N, EJ N m^2, c s,
gravity m/s^2, whether strain is engineering strain; ``slack`` is 0."""


class Pipes(NamedTuple):
    """Elements (n,) of ``PIPE``; tables (k, 18) of the points of the axial and of the bending terms.

    ``unit`` (4, 4, 4) are M, C, D, E of an element of length and mass one. Scratch are ``vector``
    (1, 6), ``stress`` (6, 6), ``inner`` (9, 9) and ``block`` (12, 12).
    """

    rows: np.recarray
    axial: np.ndarray
    points: np.ndarray
    unit: np.ndarray
    vector: np.ndarray
    stress: np.ndarray
    inner: np.ndarray
    block: np.ndarray


Z = 0
"""The row of ``vector``: (r', r'')."""


@kernel
def _inertia(e, q, v, a, r):
    """Rows of inertia, flow and weight, and that of the fluid's p."""
    i, j, length, u, b = e.a, e.b, e.length, v[e.flow], a[e.flow]
    both, turned = (e.mass + e.fluid) * length / 420.0, u * u / length
    pull = 0.0
    for c in range(AXES):
        x1, x2, x3, x4 = q[i + c], length * q[i + 3 + c], q[j + c], length * q[j + 3 + c]
        v1, v2, v3, v4 = v[i + c], length * v[i + 3 + c], v[j + c], length * v[j + 3 + c]
        a1, a2, a3, a4 = a[i + c], length * a[i + 3 + c], a[j + c], length * a[j + 3 + c]
        w = -2.0 * u
        w1, w2, w3, w4 = w * v1 - b * x1, w * v2 - b * x2, w * v3 - b * x3, w * v4 - b * x4
        c1, c2, c3, c4 = times_c(w1, w2, w3, w4)
        e1, e2, e4 = times_e(x1, x2, x3, x4)
        half = 0.5 * (e.mass + e.fluid) * e.gravity[c] * length
        sixth = half * length / 6.0
        flow1, flow3 = c1 - turned * (e1 + x2), c3 + turned * (e1 + x4)
        r[i + c] += both * (156.0 * a1 + 22.0 * a2 + 54.0 * a3 - 13.0 * a4) + e.fluid * flow1 - half
        r[j + c] += both * (54.0 * a1 + 13.0 * a2 + 156.0 * a3 - 22.0 * a4) + e.fluid * flow3 - half
        to_a, to_b = e.fluid * (c2 - turned * e2), e.fluid * (c4 - turned * e4)
        r[i + 3 + c] += length * (both * (22.0 * a1 + 4.0 * a2 + 13.0 * a3 - 3.0 * a4) + to_a) - sixth
        r[j + 3 + c] += length * (both * (-13.0 * a1 - 3.0 * a2 - 22.0 * a3 + 4.0 * a4) + to_b) + sixth
        c1, c2, c3, c4 = times_c(x1, x2, x3, x4)
        along = a1 * c1 + a2 * c2 + a3 * c3 + a4 * c4
        along += ((w1 - w3) * e1 + w2 * e2 + w4 * e4) / length
        ends = q[j + 3 + c] * q[j + 3 + c] - q[i + 3 + c] * q[i + 3 + c]
        pull += e.gravity[c] * (x3 - x1) - (along + 0.5 * u * u * ends)
    r[e.flow] += e.fluid * pull


@kernel
def _at(p, first, power, h):
    """Weights of the distance and of both slopes at a point, of the derivative that begins at a column."""
    return p[first + 2] * power * h, p[first + 1] * power, p[first + 3] * power


@kernel
def _mix(w, x, i, j):
    """A vector at a point from the weights of the distance and both slopes: its three components."""
    return (
        w[0] * (x[j] - x[i]) + w[1] * x[i + 3] + w[2] * x[j + 3],
        w[0] * (x[j + 1] - x[i + 1]) + w[1] * x[i + 4] + w[2] * x[j + 4],
        w[0] * (x[j + 2] - x[i + 2]) + w[1] * x[i + 5] + w[2] * x[j + 5],
    )


@kernel
def _gathered(sums, w, x, y, z):
    """Sums of forces on the distance and on both slopes (9), with that of a force against a vector of a point."""
    return (
        sums[0] + w[0] * x, sums[1] + w[0] * y, sums[2] + w[0] * z,
        sums[3] + w[1] * x, sums[4] + w[1] * y, sums[5] + w[1] * z,
        sums[6] + w[2] * x, sums[7] + w[2] * y, sums[8] + w[2] * z,
    )  # fmt: skip


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        row = g.rows[n]
        _inertia(row, q, v, a, r)
        i, j, h = row.a, row.b, 1.0 / row.length
        sums = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for k in range(g.axial.shape[0]):
            p = g.axial[k]
            w = _at(p, FIRST, 1.0, h)
            e = _mix(w, q, i, j)
            strain, d_strain, _ = strain_of(row, dot(e, e))
            if row.damping != 0.0:
                strain += row.damping * d_strain * dot(e, _mix(w, v, i, j))
            force = p[WEIGHT] * row.length * row.stiffness * strain * d_strain
            sums = _gathered(sums, w, force * e[0], force * e[1], force * e[2])
        for k in range(g.points.shape[0] if row.bending > 0.0 else 0):
            p = g.points[k]
            w1, w2 = _at(p, FIRST, 1.0, h), _at(p, SECOND, h, h)
            e, b = _mix(w1, q, i, j), _mix(w2, q, i, j)
            x, beta, y = 1.0 / dot(e, e), dot(e, b), dot(b, b)
            scale = p[WEIGHT] * row.length * row.bending
            # EJ/2 times the gradient of (a c - b^2)/a^3, a = e.e, b = e.b = beta, c = b.b = y.
            by_e = scale * (3.0 * beta * beta * x - 2.0 * y) * x * x * x
            by_b, mixed = scale * x * x, -scale * beta * x * x * x
            fx, fy, fz = by_e * e[0] + mixed * b[0], by_e * e[1] + mixed * b[1], by_e * e[2] + mixed * b[2]
            gx, gy, gz = by_b * b[0] + mixed * e[0], by_b * b[1] + mixed * e[1], by_b * b[2] + mixed * e[2]
            if row.damping != 0.0:
                e_d, b_d = _mix(w1, v, i, j), _mix(w2, v, i, j)
                two = 2.0 * dot(e, e_d)
                yx = x * (b_d[0] - x * (beta * e_d[0] + two * b[0]))
                yy = x * (b_d[1] - x * (beta * e_d[1] + two * b[1]))
                yz = x * (b_d[2] - x * (beta * e_d[2] + two * b[2]))
                along = x * dot(e, (yx, yy, yz))
                yx, yy, yz = yx - along * e[0], yy - along * e[1], yz - along * e[2]
                viscous = scale * row.damping * x
                pull = 2.0 * dot((yx, yy, yz), b)
                fx -= viscous * x * (beta * yx + pull * e[0])
                fy -= viscous * x * (beta * yy + pull * e[1])
                fz -= viscous * x * (beta * yz + pull * e[2])
                gx, gy, gz = gx + viscous * yx, gy + viscous * yy, gz + viscous * yz
            sums = _gathered(_gathered(sums, w1, fx, fy, fz), w2, gx, gy, gz)
        for c in range(AXES):
            r[i + c] -= sums[c]
            r[j + c] += sums[c]
            r[i + 3 + c] += sums[3 + c]
            r[j + 3 + c] += sums[6 + c]


@kernel
def _write_inertia(g, row, u, b, cm, cc, ck):
    """Write the part of the block that is the same for all axes."""
    unit, block, length = g.unit, g.block, row.length
    both, fluid = (row.mass + row.fluid) * length * cm, row.fluid
    turned = -fluid * (2.0 * u * cc + ck * b)
    pressed = ck * fluid * u * u / length
    block.fill(0.0)
    for x in range(VECTORS):
        left = length if x % 2 == 1 else 1.0
        for y in range(VECTORS):
            right = length if y % 2 == 1 else 1.0
            entry = left * right * (both * unit[M, x, y] + turned * unit[C, x, y] + pressed * unit[D, x, y])
            for c in range(AXES):
                block[3 * x + c, 3 * y + c] = entry


@kernel
def _add_axial(g, row, q, v, cc, ck):
    """Add the axial part to the inner block, of distance and slopes."""
    i, j, h, inner = row.a, row.b, 1.0 / row.length, g.inner
    for k in range(g.axial.shape[0]):
        p = g.axial[k]
        w = _at(p, FIRST, 1.0, h)
        e, e_d = _mix(w, q, i, j), _mix(w, v, i, j)
        rate = dot(e, e_d)
        strain, d_strain, d_factor = strain_of(row, dot(e, e))
        weight = p[WEIGHT] * row.length * row.stiffness
        stress = strain + row.damping * d_strain * rate
        along = ck * (d_strain * d_strain + row.damping * d_strain * d_factor * rate + stress * d_factor)
        along = weight * (along + cc * row.damping * d_strain * d_strain)
        mixed = weight * ck * row.damping * d_strain * d_strain
        own = weight * ck * stress * d_strain
        for x in range(AXES):
            for y in range(AXES):
                entry = along * e[x] * e[y] + mixed * e[x] * e_d[y] + (own if x == y else 0.0)
                for s in range(3):
                    part = w[s] * entry
                    for o in range(3):
                        inner[3 * s + x, 3 * o + y] += part * w[o]


@kernel
def _across(e, x, y):
    """The part of a vector y across e, x being 1/e.e."""
    along = x * dot(e, y)
    return y[0] - along * e[0], y[1] - along * e[1], y[2] - along * e[2]


@kernel
def _write_stress(e, b, e_d, b_d, stiffness, viscosity, cc, ck, stress):
    """Write cc d(f_e, f_b)/d(e., b.) + ck d(f_e, f_b)/d(e, b) of bending and its damping (6, 6).

    The second derivatives of EJ kappa^2 / 2 (`write_hessian` of the curvature), and of the damping those of
    `tautline.elements.beam.bending_damping`, as sums of dyads: every row of a block is a combination of e, b, e., w and
    of b^, the part of b across e, and of one. With e.^ and b.^ likewise, dw/de. = -(beta P + 2 b^ e^T)/a^2 and
    dw/db. = P/a,

        dw/de = c1 e^T + c2 b^T + c3 e.^T - (e.y) P/a - e w^T/a,   dw/db = c2 e^T - 2 epsilon P/a^2,
        c1 = -2 b.^/a^2 + (4 beta e.^ + 8 epsilon b^)/a^3,   c2 = -e.^/a^2,   c3 = -2 b^/a^2.
    """
    x, beta, size = 1.0 / dot(e, e), dot(e, b), dot(b, b)
    xx = x * x
    bent = _across(e, x, b)
    # kappa^2 = (a c - beta^2)/a^3: its derivatives by a, beta and c = b.b.
    half = 0.5 * ck * stiffness
    by_a, by_b, by_c = half * (3.0 * beta * beta * x - 2.0 * size) * x * xx, -2.0 * half * beta * x * xx, half * xx
    by_aa, by_ab = half * (6.0 * size - 12.0 * beta * beta * x) * xx * xx, 6.0 * half * beta * xx * xx
    by_ac = by_bb = -2.0 * half * x * xx
    epsilon = dot(e, e_d)
    y = (
        x * b_d[0] - xx * (beta * e_d[0] + 2.0 * epsilon * b[0]),
        x * b_d[1] - xx * (beta * e_d[1] + 2.0 * epsilon * b[1]),
        x * b_d[2] - xx * (beta * e_d[2] + 2.0 * epsilon * b[2]),
    )
    along, w = x * dot(e, y), _across(e, x, y)
    turned, driven = _across(e, x, e_d), _across(e, x, b_d)
    square, pull, b2, b3 = dot(bent, bent), dot(w, b), -xx * dot(b, turned), -2.0 * xx * dot(b, bent)
    b1 = xx * (x * (4.0 * beta * dot(b, turned) + 8.0 * epsilon * square) - 2.0 * dot(b, driven))
    k, c = ck * viscosity * xx, cc * viscosity * xx * xx
    one_ee = 2.0 * by_a + k * (beta * along - 2.0 * pull) + c * beta * beta
    one_eb = by_b + k * 2.0 * beta * xx * epsilon - c / x * beta
    one_be = by_b - k / x * along - c / x * beta
    one_bb = 2.0 * by_c - 2.0 * k * x * epsilon + c / xx
    for i in range(AXES):
        ei, bi, wi = e[i], b[i], w[i]
        c1 = xx * (x * (4.0 * beta * turned[i] + 8.0 * epsilon * bent[i]) - 2.0 * driven[i])
        w_e, w_b = c1 + along * x * ei, xx * (2.0 * epsilon * x * ei - turned[i])
        force = beta * wi + 2.0 * pull * ei
        ee_e = 4.0 * by_aa * ei + 2.0 * by_ab * bi + k * (4.0 * x * force - beta * w_e - 2.0 * b1 * ei)
        ee_e += c * ((4.0 * square - beta * beta * x) * ei + 2.0 * beta * bent[i])
        ee_b = 2.0 * by_ab * ei + by_bb * bi + k * (beta * xx * turned[i] - wi - 2.0 * b2 * ei)
        ee_r = 2.0 * k * (beta * xx * bent[i] - b3 * ei)
        ee_w, ee_c = 3.0 * k * beta * x * ei, 2.0 * (k * along + c * beta) * ei
        eb_e = 2.0 * by_ab * ei + by_bb * bi - k * (wi + beta * w_b + 2.0 * b2 * ei) + c * beta * ei
        eb_b, eb_w, eb_c = 4.0 * by_ac * ei, -2.0 * k * ei, (4.0 * k * xx * epsilon - 2.0 * c / x) * ei
        be_e = 2.0 * by_ab * ei + 4.0 * by_ac * bi + k * (w_e / x - 2.0 * wi) + c * (beta * ei - 2.0 / x * bent[i])
        be_b, be_r, be_w = by_bb * ei - k * x * turned[i], -2.0 * k * x * bent[i], -k * ei
        bb_e = by_bb * ei + k / x * w_b - c / x * ei
        for j in range(AXES):
            stress[i, j] = ee_e * e[j] + ee_b * b[j] + ee_r * e_d[j] + ee_w * w[j] + ee_c * bent[j]
            stress[i, 3 + j] = eb_e * e[j] + eb_b * b[j] + eb_w * w[j] + eb_c * bent[j]
            stress[3 + i, j] = be_e * e[j] + be_b * b[j] + be_r * e_d[j] + be_w * w[j]
            stress[3 + i, 3 + j] = bb_e * e[j]
        stress[i, i] += one_ee
        stress[i, 3 + i] += one_eb
        stress[3 + i, i] += one_be
        stress[3 + i, 3 + i] += one_bb


@kernel
def _add_bending(g, row, q, v, cc, ck):
    """Add the part of bending and its damping to the inner block."""
    i, j, h, inner, stress = row.a, row.b, 1.0 / row.length, g.inner, g.stress
    for k in range(g.points.shape[0]):
        p = g.points[k]
        w1, w2 = _at(p, FIRST, 1.0, h), _at(p, SECOND, h, h)
        weight = p[WEIGHT] * row.length * row.bending
        vectors = _mix(w1, q, i, j), _mix(w2, q, i, j), _mix(w1, v, i, j), _mix(w2, v, i, j)
        _write_stress(*vectors, weight, row.damping * weight, cc, ck, stress)
        for x in range(AXES):
            for y in range(AXES):
                ee, eb, be, bb = stress[x, y], stress[x, 3 + y], stress[3 + x, y], stress[3 + x, 3 + y]
                for s in range(3):
                    by_e, by_b = w1[s] * ee + w2[s] * be, w1[s] * eb + w2[s] * bb
                    for o in range(3):
                        inner[3 * s + x, 3 * o + y] += by_e * w1[o] + by_b * w2[o]


@kernel
def _add_inner(inner, block):
    """Add the inner block (9, 9) to the rows of positions and slopes (12, 12): the distance is r_b - r_a."""
    for x in range(AXES):
        for y in range(AXES):
            d = inner[x, y]
            block[x, y] += d
            block[x, 6 + y] -= d
            block[6 + x, y] -= d
            block[6 + x, 6 + y] += d
            for s in range(2):
                to, up = inner[x, 3 + 3 * s + y], inner[3 + 3 * s + x, y]
                block[x, 3 + 6 * s + y] -= to
                block[6 + x, 3 + 6 * s + y] += to
                block[3 + 6 * s + x, y] -= up
                block[3 + 6 * s + x, 6 + y] += up
                for o in range(2):
                    block[3 + 6 * s + x, 3 + 6 * o + y] += inner[3 + 3 * s + x, 3 + 3 * o + y]


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        _write_inertia(g, row, v[row.flow], a[row.flow], cm, cc, ck)
        if cc != 0.0 or ck != 0.0:
            g.inner.fill(0.0)
            _add_axial(g, row, q, v, cc, ck)
            if row.bending != 0.0:
                _add_bending(g, row, q, v, cc, ck)
            _add_inner(g.inner, g.block)
        add_block(matrix, dofs, row.a, row.b - row.a, 2 * AXES, g.block)


@kernel
def _mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        _write_inertia(g, row, 0.0, 0.0, 1.0, 0.0, 0.0)
        add_block(matrix, dofs, row.a, row.b - row.a, 2 * AXES, g.block)


@kernel
def _energy(g, t, q, v, energy):
    z, unit = g.vector, g.unit
    for n in range(g.rows.size):
        row = g.rows[n]
        i, j, length, u = row.a, row.b, row.length, v[row.flow]
        h, both = 1.0 / length, row.mass + row.fluid
        for c in range(AXES):
            x = (q[i + c], length * q[i + 3 + c], q[j + c], length * q[j + 3 + c])
            rate = (v[i + c], length * v[i + 3 + c], v[j + c], length * v[j + 3 + c])
            for k in range(VECTORS):
                for l in range(VECTORS):
                    own = both * length * unit[M, k, l] * rate[k] * rate[l]
                    carried = u * h * unit[E, k, l] * x[k] * x[l] - 2.0 * unit[C, k, l] * rate[k] * x[l]
                    energy[0] += 0.5 * (own + row.fluid * u * carried)
            middle = 0.5 * (x[0] + x[2]) + (x[1] - x[3]) / 12.0
            energy[2] -= both * row.gravity[c] * length * middle
        for k in range(g.axial.shape[0]):
            e = _mix(_at(g.axial[k], FIRST, 1.0, h), q, i, j)
            strain, _, _ = strain_of(row, dot(e, e))
            energy[1] += 0.5 * g.axial[k, WEIGHT] * length * row.stiffness * strain * strain
        for k in range(g.points.shape[0]):
            p = g.points[k]
            e, b = _mix(_at(p, FIRST, 1.0, h), q, i, j), _mix(_at(p, SECOND, h, h), q, i, j)
            for c in range(AXES):
                z[Z, c], z[Z, 3 + c] = e[c], b[c]
            energy[1] += 0.5 * p[WEIGHT] * length * row.bending * square_of(z[Z])


@kernel
def _dissipation(g, t, q, v, power):
    for n in range(g.rows.size):
        row = g.rows[n]
        i, j, length = row.a, row.b, row.length
        h = 1.0 / length
        if row.damping == 0.0:
            continue
        for k in range(g.axial.shape[0]):
            p = g.axial[k]
            w = _at(p, FIRST, 1.0, h)
            e = _mix(w, q, i, j)
            _, d_strain, _ = strain_of(row, dot(e, e))
            power[0] += p[WEIGHT] * length * row.stiffness * row.damping * (d_strain * dot(e, _mix(w, v, i, j))) ** 2
        for k in range(g.points.shape[0]):
            p = g.points[k]
            w1, w2 = _at(p, FIRST, 1.0, h), _at(p, SECOND, h, h)
            e, b, e_d, b_d = _mix(w1, q, i, j), _mix(w2, q, i, j), _mix(w1, v, i, j), _mix(w2, v, i, j)
            x, beta, two = 1.0 / dot(e, e), dot(e, b), 2.0 * dot(e, e_d)
            yx = x * (b_d[0] - x * (beta * e_d[0] + two * b[0]))
            yy = x * (b_d[1] - x * (beta * e_d[1] + two * b[1]))
            yz = x * (b_d[2] - x * (beta * e_d[2] + two * b[2]))
            along = dot(e, (yx, yy, yz))
            square = yx * yx + yy * yy + yz * yz - along * along * x
            power[0] += p[WEIGHT] * length * row.bending * row.damping * square


@kernel
def _supply(g, t, q, v, power):
    """The energy of the fluid that an element takes in at its ends."""
    for n in range(g.rows.size):
        row = g.rows[n]
        i, j, u = row.a, row.b, v[row.flow]
        taken = 0.0
        for c in range(AXES):
            out, into = v[j + c] - u * q[j + 3 + c], v[i + c] - u * q[i + 3 + c]
            taken += 0.5 * (out * out - into * into) - row.gravity[c] * (q[j + c] - q[i + c])
        power[0] += row.fluid * taken * u


register(
    Pipes, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, dissipation=_dissipation, supply=_supply,
    constant_mass=True,
)  # fmt: skip
