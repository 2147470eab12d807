"""The nominal curve as the bodies see it: arcs of constant curvature in a Bishop frame.

A body's arc is chosen at the start of a step and held during it, going on beyond its ends: within a step every
expression is smooth, and a body that sits on the joint of two arcs cannot make the iteration go back and forth.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import cos, load_fields, sin

PER_BODY = 4
"""Degrees of freedom of a body: x along the curve from its unstretched place, lateral u and v, rotation theta."""


STRIDE, PLACES, ALONE = np.int64(PER_BODY), np.int64(3), np.int64(1)
"""All degrees of freedom of a body, those of its place (x, u, v), and one body, as arguments: plain constants would be
compiled into the callee, once for every value."""

ARC = np.dtype([(name, np.float64) for name in ("start", "k1", "k2", "turn1", "turn2", "g1", "g2", "g3", "depth")])
"""An arc: measured depth of its start m, curvature 1/m, cumulative turning rad, components there of the downward unit
vector along (m1, m2, t), vertical depth m."""

SEAT = np.dtype(
    [
        (name, np.float64)
        for name in ("k1", "k2", "turn1", "turn2", "run", "bend", "n1", "n2", "g1", "g2", "g3", "place")
    ]
    + [("arc", np.int64), ("held", np.int64)]
)
"""A body on the curve: of the arc it is held to, curvature, the turning extrapolated to x = 0 so that it is
``turn + k x``, measured depth below its start at x = 0, size and direction of its curvature, and the downward unit
vector at its start; unstretched measured depth m, the arc's index, and 1 once an arc was chosen."""


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
        if j != seat.arc or seat.held == 0:
            _hold(seat, curve.arcs[j], j)


@kernel
def _hold(seat, arc, j):
    seat.arc = j
    seat.held = 1
    seat.run = seat.place - arc.start
    seat.k1, seat.k2 = arc.k1, arc.k2
    seat.turn1 = arc.turn1 + arc.k1 * seat.run
    seat.turn2 = arc.turn2 + arc.k2 * seat.run
    seat.g1, seat.g2, seat.g3 = arc.g1, arc.g2, arc.g3
    k = sqrt(arc.k1 * arc.k1 + arc.k2 * arc.k2)
    seat.bend = k
    # On a straight piece there is no direction of curvature, and nothing turns.
    seat.n1, seat.n2 = (arc.k1 / k, arc.k2 / k) if k > 0.0 else (0.0, 0.0)


@kernel(forceinline=True)
def _turned_down(run, bend, n1, n2, g1, g2, g3, x):
    angle = bend * (run + x)
    c, s = cos(angle), sin(angle)
    along = n1 * g1 + n2 * g2
    turned = along * c - g3 * s
    return g1 + n1 * (turned - along), g2 + n2 * (turned - along), g3 * c + along * s


@kernel
def downward(curve, i, x):
    """Downward unit vector in the frame at body i: its components along (m1, m2, t)."""
    seat = curve.seats[i]
    return _turned_down(seat.run, seat.bend, seat.n1, seat.n2, seat.g1, seat.g2, seat.g3, x)


@kernel(forceinline=True)
def downward_of_four(curve, i, last, x):
    """The same at bodies i to i + 3, in lanes."""
    run, bend, n1, n2 = load_fields(curve.seats.run, i, last)
    g1, g2, g3, _ = load_fields(curve.seats.g1, i, last)
    return _turned_down(run, bend, n1, n2, g1, g2, g3, x)


@kernel(forceinline=True)
def held_arcs(curve, i, last):
    """Curvature k1, k2 and turning at x = 0 of the arcs that bodies i to i + 3 are held to, in lanes."""
    return load_fields(curve.seats.k1, i, last)


@kernel
def vertical_depth(curve, i, x):
    """Vertical depth of the curve at body i, m."""
    seat = curve.seats[i]
    arc = curve.arcs[seat.arc]
    run = seat.run + x
    if seat.bend == 0.0:
        return arc.depth + arc.g3 * run
    along = seat.n1 * seat.g1 + seat.n2 * seat.g2
    angle = seat.bend * run
    # 1 - cos loses every digit on a slight curve: 2 sin^2(angle / 2).
    half = sin(0.5 * angle)
    return arc.depth + (seat.g3 * sin(angle) + along * 2.0 * half * half) / seat.bend
