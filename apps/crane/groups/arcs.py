"""Bending of rope on the wheels it lies on.

There it is bent to 1 / R, and has EJ / (2 R^2) for each metre: V = EJ psi / (2 rho) between a wheel's mark and where a
span leaves it, the strain of the rope being neglected. Its moment EJ / (2 R) holds the line of a rope under tension T
off the wheel by EJ / (2 T R), as an elastica lifts off. On a drum also what is stored beyond the mark is bent so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.geometry.line import (
    AXES,
    COS1,
    DRIFT,
    MARK_RATE,
    PLANE,
    POINT,
    PSI1,
    B,
    Line,
    W,
    find_line,
    new_line,
    write_turn,
)
from crane.geometry.turning import TURNED_Z, Y, add_psi, add_turning, radius_of, sandwich
from crane.groups.span import MATERIAL, STATION
from tautline.kernels.dofs import add_block
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.vector import dot

ARC = np.dtype([("span", "i8"), ("side", "i8"), ("stiffness", "f8"), ("stored", "i8"), ("begin", "f8")])
"""Rope on a wheel, from its mark to the span: the span's number, 0 for the wheel before it and 1 for that after it, EJ
N m^2, whether all the rope beyond the mark lies on the wheel, as on a drum, and p at that mark at the start, m: the
energy of a drum counts from there, or it would depend on which way the path is written."""


class Arcs(NamedTuple):
    """Arcs (n,) of ``ARC`` on spans of ``SPAN``, over ``wheels`` of ``WHEEL``.

    ``start`` (spans, 3) holds directions, ``turned`` (spans, 2) psi of the accepted lines; the rest is scratch:
    ``vector`` and ``middle`` (3, 3), ``block`` (8, 8).
    """

    rows: np.recarray
    spans: np.recarray
    wheels: np.recarray
    start: np.ndarray
    turned: np.ndarray
    line: Line
    vector: np.ndarray
    middle: np.ndarray
    block: np.ndarray


@kernel
def _write_arc(g, row, q, v):
    """The line of an arc; returns dV/dpsi."""
    s = g.spans[row.span]
    find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, v, g.start[row.span], g.turned[row.span], g.line)
    write_turn(g.line)
    if row.side == 0:
        return 0.5 * row.stiffness / g.wheels[s.wheel1].radius
    return -0.5 * row.stiffness / g.wheels[s.wheel2].radius


@kernel
def _stored(g, row):
    """dV/dp on a drum: at the mark before the span it grows with p, at that after the span it falls."""
    if row.stored == 0:
        return 0.0
    s = g.spans[row.span]
    radius = g.wheels[s.wheel1 if row.side == 0 else s.wheel2].radius
    return (0.5 if row.side == 0 else -0.5) * row.stiffness / (radius * radius)


@kernel
def _mark(g, row):
    """Place of p at the mark of an arc's wheel."""
    s = g.spans[row.span]
    return (s.a if row.side == 0 else s.b) + MATERIAL


@kernel
def _arc_residual(g, t, q, v, a, r):
    for i in range(g.rows.size):
        row = g.rows[i]
        s, turn = g.spans[row.span], g.line.turn
        f = -_write_arc(g, row, q, v) / g.line.number[COS1 + row.side]
        w = g.line.wheel[row.side, W]
        for c in range(AXES):
            force = f * (turn[0, c] * w[0] + turn[1, c] * w[1] + turn[2, c] * w[2])
            r[s.a + c] -= force
            r[s.b + c] += force
        r[_mark(g, row)] += _stored(g, row)


@kernel
def _arc_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    line, m, x, block = g.line, g.middle, g.vector, g.block
    for i in range(g.rows.size):
        row = g.rows[i]
        s = g.spans[row.span]
        f = ck * _write_arc(g, row, q, v)
        m.fill(0.0)
        add_psi(line, row.side, f, m)
        for c in range(AXES):
            x[Y, c] = -f / line.number[COS1 + row.side] * line.wheel[row.side, W, c]
        add_turning(line, radius_of(g.wheels, s.wheel1), radius_of(g.wheels, s.wheel2), x, m)
        block.fill(0.0)
        sandwich(line.turn, m, line.turn, block, 0, 0)
        for c in range(AXES):
            for d in range(AXES):
                k = block[c, d] - line.e[c] * x[TURNED_Z, d] - x[TURNED_Z, c] * line.e[d]
                block[c, d] = block[STATION + c, STATION + d] = k
                block[STATION + c, d] = block[c, STATION + d] = -k
        add_block(matrix, dofs, s.a, s.b - s.a, STATION, block)


@kernel
def _arc_energy(g, t, q, v, energy):
    for i in range(g.rows.size):
        row = g.rows[i]
        energy[1] += _write_arc(g, row, q, v) * g.line.number[PSI1 + row.side]
        energy[1] += _stored(g, row) * (q[_mark(g, row)] - row.begin)


@kernel
def _arc_supply(g, t, q, v, p):
    """What wheels that turn with their frames put in while the stations stand still."""
    for i in range(g.rows.size):
        row = g.rows[i]
        s, line = g.spans[row.span], g.line
        f = _write_arc(g, row, q, v)
        turns = s.wheel1 != POINT and g.wheels[s.wheel1].turns == 1
        if turns or (s.wheel2 != POINT and g.wheels[s.wheel2].turns == 1):
            x = line.wheel[row.side]
            swept = dot(x[W], line.drift) / line.number[COS1 + row.side]
            p[0] += f * (dot(x[PLANE], x[DRIFT]) - dot(x[B], x[MARK_RATE]) - swept)


register(Arcs, residual=_arc_residual, tangent=_arc_tangent, energy=_arc_energy, supply=_arc_supply)


def new_arcs(
    spans: np.recarray, wheels: np.recarray, stiffness: float, stored: tuple[bool, bool] = (True, True),
    turned: np.ndarray | None = None, begin: tuple[float, float] = (0.0, 0.0),
) -> Arcs:  # fmt: skip
    """Rope on all wheels that spans touch.

    Parameters
    ----------
    spans : (n,) records of ``SPAN``
        Along the rope.
    wheels : (m,) records of ``WHEEL``
    stiffness : float
        EJ, N m^2.
    stored : (bool, bool)
        Whether all the rope beyond its first and its last mark lies on the wheel there.
    turned : (n, 2) array, optional
        Both psi of each span's accepted line, that of :class:`crane.groups.span.Spans`; zeros where nothing goes round.
    begin : (float, float)
        p at the first and at the last mark at the start, m.
    """
    turned = np.zeros((len(spans), 2)) if turned is None else turned
    rows = []
    for n, s in enumerate(spans):
        if s.wheel1 != POINT:
            rows.append((n, 0, stiffness, int(n == 0 and stored[0]), begin[0]))
        if s.wheel2 != POINT:
            rows.append((n, 1, stiffness, int(n == len(spans) - 1 and stored[1]), begin[1]))
    return Arcs(
        np.array(rows, ARC).view(np.recarray), spans, wheels, np.zeros((len(spans), 3)), turned, new_line(),
        np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((2 * STATION, 2 * STATION)),
    )  # fmt: skip
