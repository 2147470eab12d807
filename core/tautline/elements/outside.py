"""Forces that somebody else computes: a function at an address, of time, positions and velocities of some places."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.numba_registration import taught

STEP = 1.0e-6
"""Change of a position, m or rad, or of a velocity, by which derivatives of the force are found."""

RAISED, NO_NUMBER = 1.0, 2.0
"""Marks of a force that raised an error, and of one that was no number where positions and velocities were."""


class OutsideForces(NamedTuple):
    """A force on full degrees of freedom ``places`` (k,).

    ``address`` (1,) is that of a C function ``void(double t, double *q, double *v, double *f, int64 k)``, which is
    handed positions and velocities (k,) of the places and writes the force (k,), N or N m. ``known`` (k, k) is one
    where the tangent has room for a derivative. Scratch: ``q``, ``v`` (k,), ``f``, ``g`` (k + 1,); behind the force the
    function may leave a mark: see `RAISED` and `NO_NUMBER`.
    """

    places: np.ndarray
    address: np.ndarray
    known: np.ndarray
    q: np.ndarray
    v: np.ndarray
    f: np.ndarray
    g: np.ndarray


def _call(address, t, q, v, f, k):
    """Call a C function that is known by its address."""


taught("calls", "called_at", _call)


@kernel
def _take(g, q, v):
    for i in range(g.places.size):
        g.q[i] = q[g.places[i]]
        g.v[i] = v[g.places[i]]


@kernel
def _residual(g, t, q, v, a, r):
    _take(g, q, v)
    _call(g.address[0], t, g.q, g.v, g.f, g.places.size)
    for i in range(g.places.size):
        r[g.places[i]] -= g.f[i]


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    """Central differences over each place that the tangent has room for."""
    n = g.places.size
    _take(g, q, v)
    for j in range(n):
        if g.known[j, j] == 0:
            continue
        for order in range(2):
            factor = ck if order == 0 else cc
            if factor == 0.0:
                continue
            x = g.q if order == 0 else g.v
            kept = x[j]
            h = STEP * max(1.0, abs(kept))
            x[j] = kept + h
            _call(g.address[0], t, g.q, g.v, g.f, n)
            x[j] = kept - h
            _call(g.address[0], t, g.q, g.v, g.g, n)
            x[j] = kept
            for i in range(n):
                slope = (g.f[i] - g.g[i]) / (2.0 * h)
                if g.known[i, j] == 1 and slope != 0.0:
                    add_entry(matrix, dofs, g.places[i], g.places[j], -factor * slope)


@kernel
def _supply(g, t, q, v, p):
    _take(g, q, v)
    _call(g.address[0], t, g.q, g.v, g.f, g.places.size)
    for i in range(g.places.size):
        p[0] += g.f[i] * g.v[i]


register(OutsideForces, residual=_residual, tangent=_tangent, supply=_supply)
