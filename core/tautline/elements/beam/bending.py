"""Bending stiffness and damping of cubic elements: the second terms of eqs 2.48 and 2.49.

The energy is EJ kappa^2 / 2 per metre of material. The dissipation is EJ c (k.k.)^2 / (k.k + k0^2) / 2 with the vector
of curvature k, whose rate along itself is half that of kappa^2: smooth through the straight curve, and zero for a bent
rod that turns as a rigid body. ``smoothing`` k0 is a few per cent of the curvatures that occur: a beam that is bent far
less than k0 is hardly damped, one that is bent more is damped as eq. 2.49 says for bending in a plane.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.elements.beam.curvature import (
    derivatives_of,
    gradient_of,
    products_of,
    square_of,
    store_hessian,
    write_gradient,
    write_hessian,
)
from tautline.elements.cubic import (
    AXES,
    BLOCK_OF_FOUR,
    MATERIAL,
    NODE,
    VECTORS,
    add_blocks,
    add_forces,
    combined,
    lengths_of,
    members,
    nodes_of,
    nothing,
    place_of,
    row_of,
    shape_of,
    vectors,
    write_own,
    write_pairs,
)
from tautline.elements.flow import combine
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.hermite import FIRST, PLACE, SECOND, THIRD, WEIGHT
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, load, pack, spread, store
from tautline.kernels.vector import dot, scaled_sum

BENDING = np.dtype([("a", "i8"), ("b", "i8"), ("stiffness", "f8"), ("damping", "f8"), ("smoothing", "f8")])
"""An element: its nodes' places, EJ N m^2, c s, smoothing 1/m."""
BOTH = 6
"""Components of z = (r', r'')."""
FUNCTIONS = 2 * AXES
"""Shape functions at a point, N' and N'' of r2 - r1, r1' and r2'."""
POINT = (FUNCTIONS + BOTH * BOTH) * LANES
"""Places in ``four``, after a block, of four elements' functions at a point and of their stresses by z there."""


class Bending(NamedTuple):
    """Elements (n,) of ``BENDING`` through whose nodes nothing moves.

    ``points`` (k, 18) is the table of the shape functions; scratch are ``shapes`` (5, 4), ``vector`` (3, 6), ``four``
    (``BLOCK_OF_FOUR`` + k ``POINT``,) and ``block`` (12, 12).
    """

    rows: np.recarray
    points: np.ndarray
    shapes: np.ndarray
    vector: np.ndarray
    four: np.ndarray
    block: np.ndarray


def new_bending(rows: np.recarray, points: np.ndarray) -> Bending:
    """A group of elements through whose nodes nothing moves, with its scratch."""
    four = np.zeros(BLOCK_OF_FOUR + points.shape[0] * POINT)
    return Bending(rows, points, np.zeros((5, 4)), np.zeros((3, 6)), four, np.zeros((12, 12)))


class FlowingBending(NamedTuple):
    """The same with moving material; ``vector`` is (14, 6), ``stress`` (2, 6, 6) and ``block`` (14, 14)."""

    rows: np.recarray
    points: np.ndarray
    shapes: np.ndarray
    vector: np.ndarray
    stress: np.ndarray
    block: np.ndarray


NX, NXX, NXXX, NXL, NXXL = range(5)
"""Rows of ``shapes``: N', N'', N''' and the derivatives of the first two by L at a fixed place."""
Z, RATE, GRADIENT, TURNED, BY_L, BY_P, BYY_L, BY_PL, RATE_BY_L, Y1, Y2, Y1L, Y2L, PULL = range(14)
"""Rows of ``vector``: z, its rate, d(kappa^2)/dz, its rate with z; z_L and z' at a point, z_LL and z'_L, (z.)_L; how a
particle's z moves with p_1 and p_2, and that by L; scratch."""


@kernel
def _write_shapes(point, length, shapes):
    h = 1.0 / length
    for k in range(VECTORS):
        first, second, third = point[FIRST + k], point[SECOND + k], point[THIRD + k]
        slope = k % 2 == 1
        shapes[NX, k] = first if slope else first * h
        shapes[NXX, k] = second * h if slope else second * h * h
        shapes[NXXX, k] = third * h * h if slope else third * h * h * h
        shapes[NXL, k] = 0.0 if slope else -first * h * h
        shapes[NXXL, k] = -second * h * h if slope else -2.0 * second * h * h * h


@kernel
def _write_curve(g, k, q, first, length):
    """Write the shapes and z at a point."""
    s, z = g.shapes, g.vector
    _write_shapes(g.points[k], length, s)
    for c in range(AXES):
        z[Z, c], z[Z, 3 + c] = combine(s[NX], q, first, c), combine(s[NXX], q, first, c)


@kernel
def _rate(g, v, first):
    """Rate of kappa^2 at the point that was written last, where nothing moves through the nodes."""
    s, z = g.shapes, g.vector
    rate = 0.0
    for c in range(AXES):
        rate += z[GRADIENT, c] * combine(s[NX], v, first, c) + z[GRADIENT, 3 + c] * combine(s[NXX], v, first, c)
    return rate


@kernel
def _viscosity(row, square):
    """Viscous force over the rate of kappa^2 and its gradient, and the logarithmic derivative of that by kappa^2."""
    if row.damping == 0.0:
        return 0.0, 0.0
    depth = square + row.smoothing * row.smoothing
    return 0.25 * row.stiffness * row.damping / depth, -1.0 / depth


@kernel(forceinline=True)
def _properties(rows, each):
    """EJ, damping and the square of the smoothing curvature of four elements, and whether any of them is damped."""
    i, j, k, l = rows[each[0]], rows[each[1]], rows[each[2]], rows[each[3]]
    smoothing = pack(i.smoothing, j.smoothing, k.smoothing, l.smoothing)
    return (
        pack(i.stiffness, j.stiffness, k.stiffness, l.stiffness),
        pack(i.damping, j.damping, k.damping, l.damping),
        smoothing * smoothing,
        i.damping != 0.0 or j.damping != 0.0 or k.damping != 0.0 or l.damping != 0.0,
    )


@kernel(forceinline=True)
def bending_of_four(g, each, counts, i, j, shape, q, v, sums):
    """Add to what works on r2 - r1, r1' and r2' of four elements, three lanes each, what their bending adds.

    ``i`` and ``j`` are the places of their nodes, ``shape`` is what :func:`~tautline.elements.cubic.shape_of` returns.
    """
    on_chord, on_first, on_second = sums
    length = lengths_of(q, i, j)
    stiffness, damping, depth, damped = _properties(g.rows, each)
    h = 1.0 / length
    half = 0.5 * stiffness * counts
    rates = shape
    if damped:
        rates = shape_of(v, i, j)
    for k in range(g.points.shape[0]):
        p = g.points[k]
        # N' and N'' of position enter by its difference.
        n1, n2, n3 = p[FIRST + 2] * h, p[FIRST + 1], p[FIRST + 3]
        m1, m2, m3 = p[SECOND + 2] * h * h, p[SECOND + 1] * h, p[SECOND + 3] * h
        slope, turn = combined((n1, n2, n3), shape), combined((m1, m2, m3), shape)
        square, by_a, by_b, by_c = derivatives_of(*products_of(slope, turn))
        by_slope, by_turn = gradient_of(slope, turn, by_a, by_b, by_c)
        force = p[WEIGHT] * length * half
        if damped:
            rate = dot(by_slope, combined((n1, n2, n3), rates)) + dot(by_turn, combined((m1, m2, m3), rates))
            force = force + force * 0.5 * damping * rate / (square + depth)
        on_chord = scaled_sum(scaled_sum(on_chord, n1 * force, by_slope), m1 * force, by_turn)
        on_first = scaled_sum(scaled_sum(on_first, n2 * force, by_slope), m2 * force, by_turn)
        on_second = scaled_sum(scaled_sum(on_second, n3 * force, by_slope), m3 * force, by_turn)
    return on_chord, on_first, on_second


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        sums = bending_of_four(g, each, counts, i, j, shape_of(q, i, j), q, v, nothing())
        add_forces(r, i, j, *sums)


@kernel
def _write_stress(row, z, stress, square, rate, cc, ck):
    """How the force changes: ``stress[0]`` = ck dF/dz + cc dF/dz. and ``stress[1]`` the elastic part of dF/dz.

    F is the elastic force EJ/2 grad(kappa^2) plus the viscous one.
    """
    write_hessian(z[Z], stress[0])
    viscosity, fading = _viscosity(row, square)
    for x in range(BOTH):
        z[TURNED, x] = 0.0
        for y in range(BOTH):
            z[TURNED, x] += stress[0, x, y] * z[RATE, y]
    for x in range(BOTH):
        for y in range(BOTH):
            both = z[GRADIENT, x] * z[GRADIENT, y]
            viscous = viscosity * (fading * rate * both + z[GRADIENT, x] * z[TURNED, y] + rate * stress[0, x, y])
            stress[1, x, y] = 0.5 * row.stiffness * stress[0, x, y]
            stress[0, x, y] = ck * (stress[1, x, y] + viscous) + cc * viscosity * both


@kernel
def add_point(s, stress, weight, block):
    """Add a point's part of the block (12, 12), from its stress (6, 6) by z and the shapes' rows N' and N''."""
    for x in range(AXES):
        for y in range(AXES):
            ee, ek = weight * stress[x, y], weight * stress[x, 3 + y]
            ke, kk = weight * stress[3 + x, y], weight * stress[3 + x, 3 + y]
            for i in range(VECTORS):
                by_e = s[NX, i] * ee + s[NXX, i] * ke
                by_k = s[NX, i] * ek + s[NXX, i] * kk
                for j in range(VECTORS):
                    block[3 * i + x, 3 * j + y] += by_e * s[NX, j] + by_k * s[NXX, j]


@kernel(forceinline=True)
def _stress_of_four(four, at, factor, slope, turn, rates, viscosity, fading, cc, ck):
    """Make of the Hessian of kappa^2 that of F = (1 + viscosity d(kappa^2)/dt) grad(kappa^2): ck dF/dz + cc dF/dz.

    Both are ``factor`` times that.
    ``rates`` are those of slope and turn, ``fading`` is the logarithmic derivative of the viscosity by kappa^2.
    """
    _, by_a, by_b, by_c = derivatives_of(*products_of(slope, turn))
    by_slope, by_turn = gradient_of(slope, turn, by_a, by_b, by_c)
    gradient = (*by_slope, *by_turn)
    z_d = (*rates[0], *rates[1])
    rate = dot(by_slope, rates[0]) + dot(by_turn, rates[1])
    for y in range(BOTH):
        turned = spread(0.0)
        for x in range(BOTH):
            turned = turned + load(four, at + (BOTH * x + y) * LANES) * z_d[x]
        # A block is written when its points are summed: until then there is room for this.
        store(four, y * LANES, turned)
    for x in range(BOTH):
        for y in range(BOTH):
            place = at + (BOTH * x + y) * LANES
            hessian, both = load(four, place), factor * gradient[x] * gradient[y]
            changed = fading * rate * both + gradient[x] * load(four, y * LANES) + rate * hessian
            store(four, place, ck * (hessian + viscosity * changed) + cc * viscosity * both)


@kernel(forceinline=True)
def _sum_points(four, points):
    """Write four elements' blocks where all stresses are symmetric: functions times stresses times functions."""
    for x in range(AXES):
        for y in range(AXES):
            f11 = f12 = f13 = f22 = f23 = f33 = spread(0.0)
            for k in range(points):
                n = BLOCK_OF_FOUR + k * POINT
                m, stress = n + AXES * LANES, n + (FUNCTIONS + BOTH * x + y) * LANES
                ee, ek = load(four, stress), load(four, stress + AXES * LANES)
                ke, kk = load(four, stress + AXES * BOTH * LANES), load(four, stress + AXES * (BOTH + 1) * LANES)
                n1, n2, n3 = load(four, n), load(four, n + LANES), load(four, n + 2 * LANES)
                m1, m2, m3 = load(four, m), load(four, m + LANES), load(four, m + 2 * LANES)
                by_slope, by_turn = n1 * ee + m1 * ke, n1 * ek + m1 * kk
                f11 = f11 + by_slope * n1 + by_turn * m1
                f12 = f12 + by_slope * n2 + by_turn * m2
                f13 = f13 + by_slope * n3 + by_turn * m3
                by_slope, by_turn = n2 * ee + m2 * ke, n2 * ek + m2 * kk
                f22 = f22 + by_slope * n2 + by_turn * m2
                f23 = f23 + by_slope * n3 + by_turn * m3
                f33 = f33 + (n3 * ee + m3 * ke) * n3 + (n3 * ek + m3 * kk) * m3
            write_own(four, 0, x, y, (f11, f22, f33))
            write_pairs(four, 0, x, y, True, (f12, f13, f23))


@kernel(forceinline=True)
def _sum_points_of_any(four, points):
    """The same where stresses are not symmetric, as those of damping."""
    for i in range(AXES):
        for x in range(AXES):
            for y in range(AXES):
                f1 = f2 = f3 = spread(0.0)
                for k in range(points):
                    n = BLOCK_OF_FOUR + k * POINT
                    m, stress = n + AXES * LANES, n + (FUNCTIONS + BOTH * x + y) * LANES
                    ee, ek = load(four, stress), load(four, stress + AXES * LANES)
                    ke, kk = load(four, stress + AXES * BOTH * LANES), load(four, stress + AXES * (BOTH + 1) * LANES)
                    own, turned = load(four, n + i * LANES), load(four, m + i * LANES)
                    by_slope, by_turn = own * ee + turned * ke, own * ek + turned * kk
                    f1 = f1 + by_slope * load(four, n) + by_turn * load(four, m)
                    f2 = f2 + by_slope * load(four, n + LANES) + by_turn * load(four, m + LANES)
                    f3 = f3 + by_slope * load(four, n + 2 * LANES) + by_turn * load(four, m + 2 * LANES)
                row = place_of(i, x) + y * LANES
                store(four, row, f1)
                store(four, row + AXES * LANES, f2)
                store(four, row + 2 * AXES * LANES, f3)


@kernel(forceinline=True)
def write_bending_tangent(g, each, i, j, shape, q, v, cc, ck):
    """Write how the bending of four elements changes with r2 - r1, r1' and r2' into ``g.four``."""
    length = lengths_of(q, i, j)
    stiffness, damping, depth, damped = _properties(g.rows, each)
    h = 1.0 / length
    rates = shape
    if damped:
        rates = shape_of(v, i, j)
    for k in range(g.points.shape[0]):
        p, at = g.points[k], BLOCK_OF_FOUR + k * POINT
        first = p[FIRST + 2] * h, spread(p[FIRST + 1]), spread(p[FIRST + 3])
        second = p[SECOND + 2] * h * h, p[SECOND + 1] * h, p[SECOND + 3] * h
        for l in range(AXES):
            store(g.four, at + l * LANES, first[l])
            store(g.four, at + (AXES + l) * LANES, second[l])
        slope, turn = combined(first, shape), combined(second, shape)
        # The elastic force is EJ / 2 times the gradient of kappa^2.
        factor = 0.5 * p[WEIGHT] * length * stiffness
        if damped:
            square = store_hessian(slope, turn, factor, g.four, at + FUNCTIONS * LANES)
            both, depth_of_all = (combined(first, rates), combined(second, rates)), square + depth
            viscosity = 0.5 * damping / depth_of_all
            _stress_of_four(
                g.four, at + FUNCTIONS * LANES, factor, slope, turn, both, viscosity, -1.0 / depth_of_all, cc, ck
            )
        else:
            store_hessian(slope, turn, ck * factor, g.four, at + FUNCTIONS * LANES)
    if damped:
        _sum_points_of_any(g.four, g.points.shape[0])
    else:
        _sum_points(g.four, g.points.shape[0])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        write_bending_tangent(g, each, i, j, shape_of(q, i, j), q, v, cc, ck)
        add_blocks(matrix, dofs, g.four, 0, each, counts, i, j, g.block)


@kernel
def _energy(g, t, q, v, energy):
    z = g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        for k in range(g.points.shape[0]):
            _write_curve(g, k, q, first, length)
            energy[1] += 0.5 * g.points[k, WEIGHT] * length * row.stiffness * square_of(z[Z])


@kernel
def _dissipation(g, t, q, v, p):
    z = g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        if row.damping == 0.0:
            continue
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        for k in range(g.points.shape[0]):
            _write_curve(g, k, q, first, length)
            square = write_gradient(z[Z], z[GRADIENT])
            rate = _rate(g, v, first)
            p[0] += g.points[k, WEIGHT] * length * _viscosity(row, square)[0] * rate * rate


register(Bending, residual=_residual, tangent=_tangent, energy=_energy, dissipation=_dissipation)


# -- with moving material ------------------------------------------------------------------------------------------


@kernel
def _write_point(g, row, k, q, v):
    """Shapes and vectors of a point; returns length, its rate, u, x, kappa^2 and its rate for a particle."""
    s, z = g.shapes, g.vector
    first = vectors(row.a, row.b)
    p1, p2 = row.a + MATERIAL, row.b + MATERIAL
    length = q[p2] - q[p1]
    l_d = v[p2] - v[p1]
    _write_shapes(g.points[k], length, s)
    x = g.points[k, PLACE]
    u = (1.0 - x) * v[p1] + x * v[p2]
    for c in range(AXES):
        e, turn, third = combine(s[NX], q, first, c), combine(s[NXX], q, first, c), combine(s[NXXX], q, first, c)
        e_l, turn_l = combine(s[NXL], q, first, c), combine(s[NXXL], q, first, c)
        of_slopes = s[NXX, 1] * q[first[1] + c] + s[NXX, 3] * q[first[3] + c]
        third_of_slopes = s[NXXX, 1] * q[first[1] + c] + s[NXXX, 3] * q[first[3] + c]
        z[Z, c], z[Z, 3 + c] = e, turn
        z[BY_L, c], z[BY_L, 3 + c] = e_l, turn_l
        z[BY_P, c], z[BY_P, 3 + c] = turn, third
        z[BYY_L, c], z[BYY_L, 3 + c] = -2.0 * e_l / length, (6.0 * turn - 4.0 * of_slopes) / (length * length)
        z[BY_PL, c], z[BY_PL, 3 + c] = turn_l, (third_of_slopes - 3.0 * third) / length
        z[RATE, c], z[RATE, 3 + c] = combine(s[NX], v, first, c), combine(s[NXX], v, first, c)
        z[RATE_BY_L, c], z[RATE_BY_L, 3 + c] = combine(s[NXL], v, first, c), combine(s[NXXL], v, first, c)
    for c in range(BOTH):
        z[RATE, c] += l_d * z[BY_L, c] - u * z[BY_P, c]
        z[RATE_BY_L, c] += l_d * z[BYY_L, c] - u * z[BY_PL, c]
        z[Y1, c], z[Y2, c] = -z[BY_L, c] - (1.0 - x) * z[BY_P, c], z[BY_L, c] - x * z[BY_P, c]
        z[Y1L, c], z[Y2L, c] = -z[BYY_L, c] - (1.0 - x) * z[BY_PL, c], z[BYY_L, c] - x * z[BY_PL, c]
    square = write_gradient(z[Z], z[GRADIENT])
    rate = 0.0
    for c in range(BOTH):
        rate += z[GRADIENT, c] * z[RATE, c]
    return length, l_d, u, x, square, rate


@kernel
def _flowing_residual(g, t, q, v, a, r):
    s, z = g.shapes, g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        p1, p2 = row.a + MATERIAL, row.b + MATERIAL
        for k in range(g.points.shape[0]):
            length, _, _, _, square, rate = _write_point(g, row, k, q, v)
            weight = g.points[k, WEIGHT]
            elastic, viscous = 0.5 * row.stiffness, _viscosity(row, square)[0] * rate
            stored = elastic * square
            drop1 = drop2 = 0.0
            for c in range(BOTH):
                gradient = z[GRADIENT, c]
                shape = s[NX] if c < AXES else s[NXX]
                for i in range(VECTORS):
                    r[first[i] + c % AXES] += weight * length * shape[i] * (elastic + viscous) * gradient
                stored += length * elastic * gradient * z[BY_L, c]
                drop1 += viscous * gradient * z[Y1, c]
                drop2 += viscous * gradient * z[Y2, c]
            r[p1] += weight * (length * drop1 - stored)
            r[p2] += weight * (length * drop2 + stored)


@kernel
def _flowing_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        row = g.rows[n]
        g.block.fill(0.0)
        for k in range(g.points.shape[0]):
            length, l_d, u, x, square, rate = _write_point(g, row, k, q, v)
            _write_stress(row, g.vector, g.stress, square, rate, 0.0, 1.0)
            _add_vectors(g, row, k, length, l_d, u, x, square, rate, cc, ck)
            _add_material(g, row, k, length, square, rate, cc, ck)
        add_block(matrix, dofs, row.a, row.b - row.a, NODE, g.block)


@kernel
def _add_vectors(g, row, k, length, l_d, u, x, square, rate, cc, ck):
    """Columns of X1 ... X4 of a point's part of the block."""
    s, z, stress, block = g.shapes, g.vector, g.stress, g.block
    weight = g.points[k, WEIGHT]
    elastic, viscosity = 0.5 * row.stiffness, _viscosity(row, square)[0]
    viscous = viscosity * rate
    for j in range(VECTORS):
        moved_e, moved_k = l_d * s[NXL, j] - u * s[NXX, j], l_d * s[NXXL, j] - u * s[NXXX, j]
        for y in range(AXES):
            column = row_of(j) + y
            along = z[GRADIENT, y] * s[NX, j] + z[GRADIENT, 3 + y] * s[NXX, j]
            along_moved = z[GRADIENT, y] * moved_e + z[GRADIENT, 3 + y] * moved_k
            along_l = z[GRADIENT, y] * s[NXL, j] + z[GRADIENT, 3 + y] * s[NXXL, j]
            along_p = z[GRADIENT, y] * s[NXX, j] + z[GRADIENT, 3 + y] * s[NXXX, j]
            drop1 = ck * viscous * (-along_l - (1.0 - x) * along_p)
            drop2 = ck * viscous * (along_l - x * along_p)
            pull = 0.0
            for c in range(BOTH):
                by_x = stress[0, c, y] * s[NX, j] + stress[0, c, 3 + y] * s[NXX, j]
                rated = viscosity * z[GRADIENT, c] * (ck * along_moved + cc * along)
                change = ck * by_x + rated
                shape = s[NX] if c < AXES else s[NXX]
                for i in range(VECTORS):
                    block[row_of(i) + c % AXES, column] += weight * length * shape[i] * change
                elastic_by = stress[1, c, y] * s[NX, j] + stress[1, c, 3 + y] * s[NXX, j]
                viscous_by = ck * (by_x - elastic_by) + rated
                drop1 += viscous_by * z[Y1, c]
                drop2 += viscous_by * z[Y2, c]
                pull += elastic_by * z[BY_L, c]
            stored = ck * (elastic * along + length * (pull + elastic * along_l))
            block[MATERIAL, column] += weight * (length * drop1 - stored)
            block[NODE + MATERIAL, column] += weight * (length * drop2 + stored)


@kernel
def _add_material(g, row, k, length, square, rate, cc, ck):
    """Columns of p1 and p2 of a point's part of the block."""
    s, z, stress, block = g.shapes, g.vector, g.stress, g.block
    weight = g.points[k, WEIGHT]
    elastic, viscosity = 0.5 * row.stiffness, _viscosity(row, square)[0]
    viscous = viscosity * rate
    along_rate = 0.0
    for c in range(BOTH):
        along_rate += z[GRADIENT, c] * z[RATE_BY_L, c]
    for side in range(2):
        sign = 2.0 * side - 1.0
        column = side * NODE + MATERIAL
        along_y = 0.0
        for c in range(BOTH):
            along_y += z[GRADIENT, c] * z[Y1 + side, c]
        drop1 = drop2 = stored = 0.0
        for c in range(BOTH):
            whole = elastic_l = 0.0
            for y in range(BOTH):
                whole += stress[0, c, y] * z[BY_L, y]
                elastic_l += stress[1, c, y] * z[BY_L, y]
            rated = viscosity * z[GRADIENT, c] * (ck * sign * along_rate + cc * along_y)
            by_p = ck * sign * (whole - elastic_l) + rated
            change = ck * sign * whole + rated
            grown = ck * sign * (elastic + viscous) * z[GRADIENT, c]
            shape, shape_l = (s[NX], s[NXL]) if c < AXES else (s[NXX], s[NXXL])
            for i in range(VECTORS):
                block[row_of(i) + c % AXES, column] += weight * (
                    length * shape[i] * change + (shape[i] + length * shape_l[i]) * grown
                )
            held = ck * sign * viscous * z[GRADIENT, c]
            drop1 += length * (by_p * z[Y1, c] + held * z[Y1L, c]) + held * z[Y1, c]
            drop2 += length * (by_p * z[Y2, c] + held * z[Y2L, c]) + held * z[Y2, c]
            stored += 2.0 * elastic * z[GRADIENT, c] * z[BY_L, c]
            stored += length * (elastic_l * z[BY_L, c] + elastic * z[GRADIENT, c] * z[BYY_L, c])
        block[MATERIAL, column] += weight * (drop1 - ck * sign * stored)
        block[NODE + MATERIAL, column] += weight * (drop2 + ck * sign * stored)


@kernel
def _flowing_dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        row = g.rows[n]
        if row.damping == 0.0:
            continue
        for k in range(g.points.shape[0]):
            length, _, _, _, square, rate = _write_point(g, row, k, q, v)
            p[0] += g.points[k, WEIGHT] * length * _viscosity(row, square)[0] * rate * rate


register(
    FlowingBending, residual=_flowing_residual, tangent=_flowing_tangent, energy=_energy,
    dissipation=_flowing_dissipation,
)  # fmt: skip
