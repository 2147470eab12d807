"""Axial stiffness and damping of cubic elements: the first terms of eqs 2.48 and 2.49.

With e = r' and a measure of strain eps(e.e), the energy EA eps^2 / 2 and the dissipation EA c eps.^2 / 2 per metre of
material give the force S h e against e, where h = 2 d(eps)/d(e.e) and S = EA (eps + c eps.): h = 1 for Green's strain
(eq. 2.52), 1/|e| for engineering strain. A rope that carries no compression has S = 0 where it is slack. Where material
moves past the nodes the strain rate is that of a particle, e. = r'[v] - L. W - u r'', and the rows of p are the
derivative of the stored energy by L and the power of the damping (the print of 2.48 leaves the former out).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

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
    row_of,
    shape_of,
    vectors,
    write_own,
    write_pairs,
)
from tautline.elements.flow import NX, NXL, NXX, NXXL, combine, watch_length, write_shapes
from tautline.elements.slackening import edges_of_slack
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import Edge, register
from tautline.kernels.hermite import FIRST, PLACE, WEIGHT
from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, load, pack, spread, sqrt, store, where
from tautline.kernels.vector import dot, scaled_sum

TENSION = np.dtype(
    [("a", "i8"), ("b", "i8"), ("stiffness", "f8"), ("damping", "f8"), ("engineering", "i8"), ("slack", "i8")]
)
"""An element: its nodes' places, EA N, c s, whether strain is engineering strain, whether it goes slack."""


PRODUCTS = 6
"""Products of the shape functions of r2 - r1, r1' and r2': 11, 12, 13, 22, 23, 33."""
POINT = (PRODUCTS + AXES * AXES) * LANES
"""Places in ``four``, after a block, of these at a point and of the force's change with e there."""


class Tension(NamedTuple):
    """Elements (n,) of ``TENSION`` through whose nodes nothing moves.

    ``points`` (k, 18) is the table of the shape functions; scratch are ``four`` (``BLOCK_OF_FOUR`` + k ``POINT``,) and
    ``block`` (12, 12).
    """

    rows: np.recarray
    points: np.ndarray
    four: np.ndarray
    block: np.ndarray


def new_tension(rows: np.recarray, points: np.ndarray) -> Tension:
    """A group of elements through whose nodes nothing moves, with its scratch."""
    return Tension(rows, points, np.zeros(BLOCK_OF_FOUR + points.shape[0] * POINT), np.zeros((12, 12)))


class FlowingTension(NamedTuple):
    """The same with moving material; scratch are ``shapes`` (6, 4), ``vector`` (9, 3) and ``block`` (14, 14)."""

    rows: np.recarray
    points: np.ndarray
    shapes: np.ndarray
    vector: np.ndarray
    block: np.ndarray


@kernel
def strain_of(row, square):
    """Strain for e.e, and h = 2 d(eps)/d(e.e) with twice its own derivative."""
    if row.engineering == 0:
        return 0.5 * (square - 1.0), 1.0, 0.0
    size = sqrt(square)
    return size - 1.0, 1.0 / size, -1.0 / (square * size)


@kernel(forceinline=True)
def _strain_of_four(engineering, engineered, square):
    """What :func:`strain_of` says of four elements; ``engineering`` is 1 in the lanes that have engineering strain.

    ``engineered`` tells whether any has: a rope of Green's strain alone takes no root.
    """
    strain, d_strain, d_factor = 0.5 * (square - 1.0), spread(1.0), spread(0.0)
    if engineered:
        size = sqrt(square)
        strain = strain + engineering * (size - 1.0 - strain)
        d_strain = d_strain + engineering * (1.0 / size - d_strain)
        d_factor = -engineering / (square * size)
    return strain, d_strain, d_factor


@kernel
def is_slack(row, strain):
    """Whether the rope carries nothing at a strain."""
    return row.slack == 1 and strain < 0.0


@kernel(forceinline=True)
def _properties(rows, each):
    """EA, damping, and flags of engineering strain and of going slack, of four elements."""
    i, j, k, l = rows[each[0]], rows[each[1]], rows[each[2]], rows[each[3]]
    return (
        pack(i.stiffness, j.stiffness, k.stiffness, l.stiffness),
        pack(i.damping, j.damping, k.damping, l.damping),
        pack(i.engineering, j.engineering, k.engineering, l.engineering),
        pack(i.slack, j.slack, k.slack, l.slack),
    )


@kernel(forceinline=True)
def _is_any(rows, each):
    """Whether any of four elements is damped, has engineering strain, goes slack."""
    i, j, k, l = rows[each[0]], rows[each[1]], rows[each[2]], rows[each[3]]
    damped = i.damping != 0.0 or j.damping != 0.0 or k.damping != 0.0 or l.damping != 0.0
    return (
        damped,
        i.engineering + j.engineering + k.engineering + l.engineering > 0,
        i.slack + j.slack + k.slack + l.slack > 0,
    )


@kernel(forceinline=True)
def tension_of_four(g, each, counts, i, j, shape, q, v, sums):
    """Add to what works on r2 - r1, r1' and r2' of four elements, three lanes each, what their tension adds.

    ``i`` and ``j`` are the places of their nodes, ``shape`` is what :func:`~tautline.elements.cubic.shape_of` returns.
    """
    on_chord, on_first, on_second = sums
    length = lengths_of(q, i, j)
    stiffness, damping, engineering, slack = _properties(g.rows, each)
    damped, engineered, slackens = _is_any(g.rows, each)
    h = 1.0 / length
    rates = shape
    if damped:
        rates = shape_of(v, i, j)
    for k in range(g.points.shape[0]):
        p = g.points[k]
        # The first functions of both positions are opposite: position enters by its difference.
        n1, n2, n3 = p[FIRST + 2] * h, p[FIRST + 1], p[FIRST + 3]
        e = combined((n1, n2, n3), shape)
        strain, d_strain, _ = _strain_of_four(engineering, engineered, dot(e, e))
        carried = p[WEIGHT] * length * stiffness * counts
        if slackens:
            carried = where(slack * strain < 0.0, 0.0, carried)
        if damped:
            strain = strain + damping * d_strain * dot(e, combined((n1, n2, n3), rates))
        force = carried * strain * d_strain
        on_chord = scaled_sum(on_chord, n1 * force, e)
        on_first = scaled_sum(on_first, n2 * force, e)
        on_second = scaled_sum(on_second, n3 * force, e)
    return on_chord, on_first, on_second


@kernel
def _residual(g, t, q, v, a, r):
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        sums = tension_of_four(g, each, counts, i, j, shape_of(q, i, j), q, v, nothing())
        add_forces(r, i, j, *sums)


@kernel(forceinline=True)
def write_tension_tangent(g, each, i, j, shape, q, v, cc, ck):
    """Write how the tension of four elements changes with r2 - r1, r1' and r2' into ``g.four``."""
    length = lengths_of(q, i, j)
    stiffness, damping, engineering, slack = _properties(g.rows, each)
    damped, engineered, slackens = _is_any(g.rows, each)
    h = 1.0 / length
    rates = shape
    if damped:
        rates = shape_of(v, i, j)
    none = spread(0.0)
    for k in range(g.points.shape[0]):
        p = g.points[k]
        n1, n2, n3 = functions = p[FIRST + 2] * h, spread(p[FIRST + 1]), spread(p[FIRST + 3])
        e = combined(functions, shape)
        strain, d_strain, d_factor = _strain_of_four(engineering, engineered, dot(e, e))
        weight = p[WEIGHT] * length * stiffness
        if slackens:
            weight = where(slack * strain < 0.0, 0.0, weight)
        # The force's change with e is along e e^T + mixed e e.^T + across I.
        stress, along, mixed, e_d = strain, d_strain * d_strain, none, e
        if damped:
            e_d = combined(functions, rates)
            rate = dot(e, e_d)
            stress = strain + damping * d_strain * rate
            along = along + damping * d_strain * d_factor * rate
            mixed = ck * weight * damping * d_strain * d_strain
        along = weight * (ck * (along + stress * d_factor) + cc * damping * d_strain * d_strain)
        across = ck * weight * stress * d_strain
        at = BLOCK_OF_FOUR + k * POINT
        _store_products(g.four, at, n1, n2, n3)
        for x in range(AXES):
            for y in range(AXES):
                change = along * e[x] * e[y]
                if damped:
                    change = change + mixed * e[x] * e_d[y]
                if x == y:
                    change = change + across
                store(g.four, at + (PRODUCTS + AXES * x + y) * LANES, change)
    _sum_points(g.four, g.points.shape[0])


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(0, g.rows.size, LANES):
        each, counts = members(n, g.rows.size)
        i, j = nodes_of(g.rows, each)
        write_tension_tangent(g, each, i, j, shape_of(q, i, j), q, v, cc, ck)
        add_blocks(matrix, dofs, g.four, 0, each, counts, i, j, g.block)


@kernel(forceinline=True)
def _store_products(four, at, n1, n2, n3):
    store(four, at, n1 * n1)
    store(four, at + LANES, n1 * n2)
    store(four, at + 2 * LANES, n1 * n3)
    store(four, at + 3 * LANES, n2 * n2)
    store(four, at + 4 * LANES, n2 * n3)
    store(four, at + 5 * LANES, n3 * n3)


@kernel(forceinline=True)
def _sum_points(four, points):
    """Write four elements' blocks: the force's change at their points times the products of the shape functions."""
    for x in range(AXES):
        for y in range(AXES):
            f11 = f12 = f13 = f22 = f23 = f33 = spread(0.0)
            for k in range(points):
                at = BLOCK_OF_FOUR + k * POINT
                change = load(four, at + (PRODUCTS + AXES * x + y) * LANES)
                f11 = f11 + change * load(four, at)
                f12 = f12 + change * load(four, at + LANES)
                f13 = f13 + change * load(four, at + 2 * LANES)
                f22 = f22 + change * load(four, at + 3 * LANES)
                f23 = f23 + change * load(four, at + 4 * LANES)
                f33 = f33 + change * load(four, at + 5 * LANES)
            write_own(four, 0, x, y, (f11, f22, f33))
            write_pairs(four, 0, x, y, False, (f12, f13, f23))


@kernel
def _energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        h = 1.0 / length
        for k in range(g.points.shape[0]):
            p = g.points[k]
            shape = (p[FIRST] * h, p[FIRST + 1], p[FIRST + 2] * h, p[FIRST + 3])
            square = 0.0
            for c in range(AXES):
                square += combine(shape, q, first, c) ** 2
            strain, _, _ = strain_of(row, square)
            if not is_slack(row, strain):
                energy[1] += 0.5 * p[WEIGHT] * length * row.stiffness * strain * strain


@kernel
def _dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        row = g.rows[n]
        if row.damping == 0.0:
            continue
        first = vectors(row.a, row.b)
        length = q[row.b + MATERIAL] - q[row.a + MATERIAL]
        h = 1.0 / length
        for k in range(g.points.shape[0]):
            at = g.points[k]
            shape = (at[FIRST] * h, at[FIRST + 1], at[FIRST + 2] * h, at[FIRST + 3])
            square = rate = 0.0
            for c in range(AXES):
                slope = combine(shape, q, first, c)
                square += slope * slope
                rate += slope * combine(shape, v, first, c)
            strain, d_strain, _ = strain_of(row, square)
            if not is_slack(row, strain):
                p[0] += at[WEIGHT] * length * row.stiffness * row.damping * (d_strain * rate) ** 2


def edges_of_tension(g: Tension | FlowingTension, q: np.ndarray, v: np.ndarray) -> list[Edge]:
    """How far elements are from where they go slack, or taut again."""
    return edges_of_slack(g.rows, g.points, MATERIAL, q)


register(
    Tension, residual=_residual, tangent=_tangent, energy=_energy, dissipation=_dissipation, edges=edges_of_tension
)


# -- with moving material ------------------------------------------------------------------------------------------

SLOPE, RATE, BY_L, RATE_BY_L, Y1, Y2, Y1L, Y2L, BYY_L = range(9)
"""Rows of ``vector``: e, e., e_L, (e.)_L at a fixed place; how a particle's e moves with p_1 and p_2, and that by L;
e_LL."""


@kernel
def _write_slopes(g, row, k, q, v):
    """Shapes and vectors of a point; returns L, its rate, u, x, strain, h, its derivative, and the strain rate."""
    s, z = g.shapes, g.vector
    first = vectors(row.a, row.b)
    p1, p2 = row.a + MATERIAL, row.b + MATERIAL
    length = q[p2] - q[p1]
    l_d = v[p2] - v[p1]
    write_shapes(g.points[k], length, s)
    x = g.points[k, PLACE]
    u = (1.0 - x) * v[p1] + x * v[p2]
    square = rate = 0.0
    for c in range(AXES):
        e, turn, e_l = combine(s[NX], q, first, c), combine(s[NXX], q, first, c), combine(s[NXL], q, first, c)
        turn_l = combine(s[NXXL], q, first, c)
        e_ll = -2.0 * e_l / length
        e_d = combine(s[NX], v, first, c) + l_d * e_l - u * turn
        z[SLOPE, c], z[RATE, c], z[BY_L, c], z[BYY_L, c] = e, e_d, e_l, e_ll
        z[RATE_BY_L, c] = combine(s[NXL], v, first, c) + l_d * e_ll - u * turn_l
        z[Y1, c], z[Y2, c] = -e_l - (1.0 - x) * turn, e_l - x * turn
        z[Y1L, c], z[Y2L, c] = -e_ll - (1.0 - x) * turn_l, e_ll - x * turn_l
        square += e * e
        rate += e * e_d
    strain, d_strain, d_factor = strain_of(row, square)
    return length, l_d, u, x, strain, d_strain, d_factor, rate


@kernel
def _flowing_residual(g, t, q, v, a, r):
    s, z = g.shapes, g.vector
    for n in range(g.rows.size):
        row = g.rows[n]
        first = vectors(row.a, row.b)
        p1, p2 = row.a + MATERIAL, row.b + MATERIAL
        for k in range(g.points.shape[0]):
            length, _, _, _, strain, d_strain, _, rate = _write_slopes(g, row, k, q, v)
            if is_slack(row, strain):
                continue
            weight = g.points[k, WEIGHT]
            elastic = row.stiffness * strain * d_strain
            viscous = row.stiffness * row.damping * d_strain * d_strain * rate
            stored = 0.5 * row.stiffness * strain * strain
            drop1 = drop2 = 0.0
            for c in range(AXES):
                force = weight * length * (elastic + viscous) * z[SLOPE, c]
                for i in range(VECTORS):
                    r[first[i] + c] += s[NX, i] * force
                stored += length * elastic * z[SLOPE, c] * z[BY_L, c]
                drop1 += viscous * z[SLOPE, c] * z[Y1, c]
                drop2 += viscous * z[SLOPE, c] * z[Y2, c]
            r[p1] += weight * (length * drop1 - stored)
            r[p2] += weight * (length * drop2 + stored)


@kernel
def _flowing_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    block = g.block
    for n in range(g.rows.size):
        row = g.rows[n]
        block.fill(0.0)
        for k in range(g.points.shape[0]):
            at = _write_slopes(g, row, k, q, v)
            if not is_slack(row, at[4]):
                _add_point(g, row, k, at, cc, ck)
        add_block(matrix, dofs, row.a, row.b - row.a, NODE, block)


@kernel
def _add_point(g, row, k, at, cc, ck):
    """A point's part of the block (14, 14); ``at`` is what :func:`_write_slopes` returned for it."""
    length, l_d, u, x, strain, d_strain, d_factor, rate = at
    s, z, block = g.shapes, g.vector, g.block
    weight, stiffness, viscosity = g.points[k, WEIGHT], row.stiffness, row.stiffness * row.damping
    elastic, viscous = stiffness * strain * d_strain, viscosity * d_strain * d_strain * rate
    # Derivatives of the elastic force F = elastic e and of the viscous one T = viscous e, by e and by e.:
    # F_e = f1 e e^T + elastic I; T_e = t1 e e^T + t2 e e.^T + viscous I; T_e. = t2 e e^T.
    f1 = stiffness * (d_strain * d_strain + strain * d_factor)
    t1 = 2.0 * viscosity * d_strain * d_factor * rate
    t2 = viscosity * d_strain * d_strain
    e, e_d, e_l = z[SLOPE], z[RATE], z[BY_L]
    along_l = rate_along_l = along_rate_l = 0.0
    for c in range(AXES):
        along_l += e[c] * e_l[c]
        rate_along_l += e_d[c] * e_l[c]
        along_rate_l += e[c] * z[RATE_BY_L, c]
    for j in range(VECTORS):
        shape, moved = s[NX, j], l_d * s[NXL, j] - u * s[NXX, j]
        for y in range(AXES):
            column = row_of(j) + y
            # The force's change with X_j and its rate; what the rows of p see of it.
            drop1 = drop2 = pull = 0.0
            for c in range(AXES):
                by_x = shape * ((f1 + t1) * e[c] * e[y] + t2 * e[c] * e_d[y]) + moved * t2 * e[c] * e[y]
                viscous_by = shape * (t1 * e[c] * e[y] + t2 * e[c] * e_d[y]) + moved * t2 * e[c] * e[y]
                elastic_by = shape * f1 * e[c] * e[y]
                if c == y:
                    by_x += shape * (elastic + viscous)
                    viscous_by += shape * viscous
                    elastic_by += shape * elastic
                change = ck * by_x + cc * shape * t2 * e[c] * e[y]
                for i in range(VECTORS):
                    block[row_of(i) + c, column] += weight * length * s[NX, i] * change
                viscous_by = ck * viscous_by + cc * shape * t2 * e[c] * e[y]
                drop1 += viscous_by * z[Y1, c]
                drop2 += viscous_by * z[Y2, c]
                pull += elastic_by * e_l[c]
            drop1 += ck * viscous * e[y] * (-s[NXL, j] - (1.0 - x) * s[NXX, j])
            drop2 += ck * viscous * e[y] * (s[NXL, j] - x * s[NXX, j])
            stored = ck * (elastic * e[y] * shape + length * (pull + elastic * e[y] * s[NXL, j]))
            block[MATERIAL, column] += weight * (length * drop1 - stored)
            block[NODE + MATERIAL, column] += weight * (length * drop2 + stored)
    for side in range(2):
        sign = 2.0 * side - 1.0
        column = side * NODE + MATERIAL
        along_y = 0.0
        for c in range(AXES):
            along_y += e[c] * z[Y1 + side, c]
        drop1 = drop2 = stored = 0.0
        for c in range(AXES):
            viscous_l = e[c] * (t1 * along_l + t2 * (rate_along_l + along_rate_l)) + viscous * e_l[c]
            elastic_l = f1 * e[c] * along_l + elastic * e_l[c]
            by_p = ck * sign * viscous_l + cc * t2 * e[c] * along_y
            change = by_p + ck * sign * elastic_l
            grown = ck * sign * (elastic + viscous) * e[c]
            for i in range(VECTORS):
                block[row_of(i) + c, column] += weight * (
                    length * s[NX, i] * change + (s[NX, i] + length * s[NXL, i]) * grown
                )
            drop1 += length * (by_p * z[Y1, c] + ck * sign * viscous * e[c] * z[Y1L, c])
            drop1 += ck * sign * viscous * e[c] * z[Y1, c]
            drop2 += length * (by_p * z[Y2, c] + ck * sign * viscous * e[c] * z[Y2L, c])
            drop2 += ck * sign * viscous * e[c] * z[Y2, c]
            stored += 2.0 * elastic * e[c] * e_l[c] + length * (elastic_l * e_l[c] + elastic * e[c] * z[BYY_L, c])
        block[MATERIAL, column] += weight * (drop1 - ck * sign * stored)
        block[NODE + MATERIAL, column] += weight * (drop2 + ck * sign * stored)


@kernel
def _flowing_dissipation(g, t, q, v, p):
    for n in range(g.rows.size):
        row = g.rows[n]
        if row.damping == 0.0:
            continue
        for k in range(g.points.shape[0]):
            length, _, _, _, strain, d_strain, _, rate = _write_slopes(g, row, k, q, v)
            if not is_slack(row, strain):
                p[0] += g.points[k, WEIGHT] * length * row.stiffness * row.damping * (d_strain * rate) ** 2


register(
    FlowingTension, residual=_flowing_residual, tangent=_flowing_tangent, energy=_energy,
    dissipation=_flowing_dissipation, alarm=watch_length, edges=edges_of_tension,
)  # fmt: skip
