"""The nominal curve as the bodies see it: arcs of constant curvature in a Bishop frame.

A body's arc is chosen at the start of a step and held during it, going on beyond its ends: within a step every
expression is smooth, and a body that sits on the joint of two arcs cannot make the iteration go back and forth.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel

PER_BODY = 4
"""Degrees of freedom of a body: x along the curve from its unstretched place, lateral u and v, rotation theta."""


STRIDE, PLACES, ALONE = np.int64(PER_BODY), np.int64(3), np.int64(1)
"""All degrees of freedom of a body, those of its place (x, u, v), and one body, as arguments: plain constants would be
compiled into the callee, once for every value."""

ARC = np.dtype([(name, np.float64) for name in ("start", "k1", "k2", "turn1", "turn2", "g1", "g2", "g3", "depth")])
"""An arc: measured depth of its start m, curvature 1/m, cumulative turning rad, components there of the downward unit
vector along (m1, m2, t), vertical depth m."""

SEAT = np.dtype([(name, np.float64) for name in ("place", "k1", "k2", "turn1", "turn2")] + [("arc", np.int64)])
"""A body on the curve: unstretched measured depth m, curvature of the arc it is held to, the turning extrapolated to
x = 0 so that it is ``turn + k x``, and the arc's index."""


class Curve(NamedTuple):
    """Record arrays: ``arcs`` (m,) of ``ARC`` and ``seats`` (n,) of ``SEAT``.

    ``window`` (2,) are the first and past the last full degree of freedom that residuals, tangents and laws are asked
    for at the moment: the corrector narrows it to a part of the string that is not in balance yet.
    """

    arcs: np.recarray
    seats: np.recarray
    window: np.ndarray


@kernel
def members(curve, span, count):
    """First and past the last of ``count`` members that touch the window, each of ``span`` successive bodies."""
    first, last = curve.window[0] // PER_BODY, -(-curve.window[1] // PER_BODY)
    return max(0, first - span + 1), min(count, last)


@kernel
def hold_arcs(curve, q):
    """Choose the arc of every body for the step that begins at q."""
    last = curve.arcs.size - 1
    for i in range(curve.seats.size):
        seat = curve.seats[i]
        s = seat.place + q[PER_BODY * i]
        j = seat.arc
        while j < last and s >= curve.arcs[j + 1].start:
            j += 1
        while j > 0 and s < curve.arcs[j].start:
            j -= 1
        arc = curve.arcs[j]
        back = seat.place - arc.start
        seat.arc = j
        seat.k1 = arc.k1
        seat.k2 = arc.k2
        seat.turn1 = arc.turn1 + arc.k1 * back
        seat.turn2 = arc.turn2 + arc.k2 * back


@kernel
def downward(curve, i, x):
    """Downward unit vector in the frame at body i: its components along (m1, m2, t)."""
    seat = curve.seats[i]
    arc = curve.arcs[seat.arc]
    k = sqrt(seat.k1 * seat.k1 + seat.k2 * seat.k2)
    if k == 0.0:
        return arc.g1, arc.g2, arc.g3
    n1, n2 = seat.k1 / k, seat.k2 / k
    angle = k * (seat.place + x - arc.start)
    c, s = cos(angle), sin(angle)
    along = n1 * arc.g1 + n2 * arc.g2
    turned = along * c - arc.g3 * s
    return arc.g1 + n1 * (turned - along), arc.g2 + n2 * (turned - along), arc.g3 * c + along * s


@kernel
def vertical_depth(curve, i, x):
    """Vertical depth of the curve at body i, m."""
    seat = curve.seats[i]
    arc = curve.arcs[seat.arc]
    k = sqrt(seat.k1 * seat.k1 + seat.k2 * seat.k2)
    run = seat.place + x - arc.start
    if k == 0.0:
        return arc.depth + arc.g3 * run
    along = (seat.k1 * arc.g1 + seat.k2 * arc.g2) / k
    angle = k * run
    # 1 - cos loses every digit on a slight curve: 2 sin^2(angle / 2).
    half = sin(0.5 * angle)
    return arc.depth + (arc.g3 * sin(angle) + along * 2.0 * half * half) / k


def records(count: int, dtype: np.dtype, **columns: np.ndarray | float) -> np.recarray:
    """Record array of ``count`` rows with the named columns filled in, the others zero."""
    rows = np.zeros(count, dtype).view(np.recarray)
    for name, values in columns.items():
        rows[name] = values
    return rows
