"""A group of constant loads on single degrees of freedom."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.groups import register
from tautline.kernels.jit import kernel


class Loads(NamedTuple):
    """Force or moment ``value`` (n,) N, N m along the full degree of freedom ``place`` (n,)."""

    place: np.ndarray
    value: np.ndarray


@kernel
def _residual(g, t, q, v, a, r):
    for i in range(g.place.size):
        r[g.place[i]] -= g.value[i]


@kernel
def _energy(g, t, q, v, e):
    for i in range(g.place.size):
        e[2] -= g.value[i] * q[g.place[i]]


register(Loads, residual=_residual, energy=_energy)
