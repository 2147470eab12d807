"""Eyelets: supports that material slides through, looked at for whether they still hold the nodes they hold.

A node whose p is free is held along its rope by the directions in which its position is held. Once the rope has turned
across all of them the node may slide along it by dp = c, dr = c r' with no material moving: the mass matrix is
singular (formulation notes, section 2). The build refuses scenes that begin so; this group gives the alarm where one
comes there.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from tautline.kernels.groups import LOOSE, register
from tautline.kernels.jit import kernel

ACROSS = 1.0e-3
"""Part of the rope's direction along what holds it below which it does not."""


class Eyelets(NamedTuple):
    """Unknown p's (m,), full places, each with its stops from ``first[k]`` to ``first[k + 1]``.

    A stop is a held component of a node's position: ``axis`` (k,) and the rope's direction there, the vector at full
    place ``tip`` (k,), less that at ``tail`` (k,) unless this is -1: r' of a cubic node, a chord of a linear one.
    """

    material: np.ndarray
    first: np.ndarray
    axis: np.ndarray
    tip: np.ndarray
    tail: np.ndarray


@kernel
def _watch(g, t, q, alarm):
    for k in range(g.material.size):
        most = 0.0
        for i in range(g.first[k], g.first[k + 1]):
            square = along = 0.0
            for c in range(3):
                x = q[g.tip[i] + c]
                if g.tail[i] >= 0:
                    x -= q[g.tail[i] + c]
                square += x * x
                if c == g.axis[i]:
                    along = abs(x)
            if square > 0.0:
                most = max(most, along / sqrt(square))
        if most < ACROSS:
            alarm[0] = LOOSE
            alarm[1] = g.material[k]


register(Eyelets, alarm=_watch)
