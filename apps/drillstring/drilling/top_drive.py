"""The top drive under a speed controller with a torque limit (docs/lumped_string.md)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import register
from tautline.kernels.jit import kernel
from tautline.kernels.time_function import TimeFunctions, evaluate


class TopDrive(NamedTuple):
    """PI speed control at full degree of freedom ``place``: torque, limited, on the drive's own inertia kg m^2.

    T = proportional (Omega - phi') + integral (int Omega dt - phi + lead), |T| <= limit; the reference angle is
    function ``angle`` of the scene. Where ``asked`` is not -1, T is what that function says, and there are no gains. At
    its limit the drive does not wind up: while it is too slow for the torque that it gives (too fast, the other way)
    the angle ``lead`` takes back what the integral would grow by. ``torque`` (1,) is that of the last accepted step,
    ``lead`` (2,) that angle and by how much the reference was ahead then, rad.
    """

    functions: TimeFunctions
    angle: int
    place: int
    inertia: float
    proportional: float
    integral: float
    limit: float
    asked: int
    torque: np.ndarray
    lead: np.ndarray


@kernel
def _torque(g, t, q, v):
    """Torque asked for, N m, and whether it is within the limit."""
    angle, speed, _ = evaluate(g.functions, g.angle, t)
    asked = g.proportional * (speed - v[g.place]) + g.integral * (angle - q[g.place] + g.lead[0])
    if g.asked >= 0:
        asked, _, _ = evaluate(g.functions, g.asked, t)
    if abs(asked) > g.limit:
        return np.copysign(g.limit, asked), False
    return asked, True


@kernel
def _residual(g, t, q, v, a, r):
    torque, _ = _torque(g, t, q, v)
    r[g.place] += g.inertia * a[g.place] - torque


@kernel
def _mass(g, q, matrix, dofs):
    add_entry(matrix, dofs, g.place, g.place, g.inertia)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    _, within = _torque(g, t, q, v)
    x = cm * g.inertia
    if within:
        x += cc * g.proportional + ck * g.integral
    add_entry(matrix, dofs, g.place, g.place, x)


@kernel
def _energy(g, t, q, v, e):
    e[0] += 0.5 * g.inertia * v[g.place] ** 2


@kernel
def _supply(g, t, q, v, p):
    torque, _ = _torque(g, t, q, v)
    p[0] += torque * v[g.place]


@kernel
def _commit(g, t, h, q, v, a):
    torque, within = _torque(g, t, q, v)
    angle, speed, _ = evaluate(g.functions, g.angle, t)
    ahead = angle - q[g.place]
    if not within and torque * (speed - v[g.place]) > 0.0 and h > 0.0:
        g.lead[0] -= ahead - g.lead[1]
    g.lead[1] = ahead
    g.torque[0] = torque


@kernel
def _record(g, out, at):
    out[at[0]] = g.torque[0]
    at[0] += 1


register(
    TopDrive, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy, supply=_supply,
    commit=_commit, record=_record,
)  # fmt: skip
