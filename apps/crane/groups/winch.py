"""Drums that a motor drives, by torque or to hold a tension; and how much rope is left on a drum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.groups.span import FIRST, LAST, MATERIAL, STRETCH
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import DRUM_FULL, RUN_OUT, register
from tautline.kernels.jit import kernel
from tautline.kernels.time_function import TimeFunctions, evaluate

DRUM = np.dtype(
    [
        ("p", "i8"), ("way", "f8"), ("gear", "f8"), ("inertia", "f8"), ("rope", "f8"), ("stored", "f8"),
        ("begin", "f8"), ("function", "i8"), ("holds", "i8"), ("proportional", "f8"), ("integral", "f8"),
        ("limit", "f8"),
        ("span", "i8"),
    ]
)  # fmt: skip
"""A drum whose motion is not prescribed: the place of p at its mark, which stands behind its centre; +1 at the
beginning of the rope, where p grows as it is hoisted, and -1 at its end; gear = lambda/R 1/m (turns of the drum in rad
per metre of material); inertia kg m^2; rhoA kg/m; rope on the drum at the start m (infinite: no end of it) and p there;
the function of its torque N m or, where it holds a tension (holds 1), of that N; its gains, 1 and 1/s; largest torque
N m; and the span that leaves it."""


class Drums(NamedTuple):
    """Drums (n,) of ``DRUM``; ``found`` as in `Slips`; ``sum`` (n,) is the integral of what tension lacks, N s,
    ``torque`` (n,) that of the last step; ``gravity`` (3,) m/s^2.

    A span has the energies of its rope in space (`crane.groups.span`), and what is wound up leaves it. So the rope that
    has come onto the drum since the start, S long, has them too: with the drum's centre c

        T = rhoA S c. . c. / 2,   V = -rhoA S g . c.

    Without them the motion of a driven drum would depend on where the scene's origin lies, and on how fast it moves.
    """

    rows: np.recarray
    gravity: np.ndarray
    found: np.ndarray
    sum: np.ndarray
    torque: np.ndarray
    functions: TimeFunctions


@kernel
def _pull(g, d):
    """What the rope pulls at a drum with, N."""
    return g.found[d.span, FIRST] if d.way > 0.0 else g.found[d.span, LAST]


@kernel
def _drum_torque(g, n, t):
    d = g.rows[n]
    asked, _, _ = evaluate(g.functions, d.function, t)
    if d.holds == 1:
        lack = asked - _pull(g, d)
        asked = (asked + d.proportional * lack + d.integral * g.sum[n]) * g.found[d.span, STRETCH] / d.gear
    return min(max(asked, -d.limit), d.limit)


@kernel
def _stored(d, q):
    """Rope on the drum, m; what has no end has no inertia of its own either."""
    return d.stored + d.way * (q[d.p] - d.begin) if d.stored < np.inf else 0.0


@kernel
def _wound(d, q):
    """Rope that has come onto the drum since the start, m."""
    return d.way * (q[d.p] - d.begin)


@kernel
def _drum_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        d = g.rows[n]
        wound = _wound(d, q)
        for c in range(MATERIAL):
            o = d.p - MATERIAL + c
            r[o] += d.rope * (wound * (a[o] - g.gravity[c]) + d.way * v[d.p] * v[o])
            r[d.p] -= d.way * d.rope * (0.5 * v[o] * v[o] + g.gravity[c] * q[o])
        stretch = g.found[d.span, STRETCH]
        mass = d.inertia * d.gear * d.gear + d.rope * max(0.0, _stored(d, q)) * stretch * stretch
        r[d.p] += mass * a[d.p] + 0.5 * d.way * d.rope * (stretch * v[d.p]) ** 2
        r[d.p] -= d.way * d.gear * _drum_torque(g, n, t)


@kernel
def _drum_mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        d = g.rows[n]
        add_entry(matrix, dofs, d.p, d.p, d.inertia * d.gear * d.gear + d.rope * max(0.0, _stored(d, q)))


@kernel
def _drum_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        d = g.rows[n]
        mass = d.inertia * d.gear * d.gear + d.rope * max(0.0, _stored(d, q))
        add_entry(matrix, dofs, d.p, d.p, cm * mass + cc * d.way * d.rope * v[d.p] + ck * d.way * d.rope * a[d.p])


@kernel
def _drum_energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        d = g.rows[n]
        mass = d.inertia * d.gear * d.gear + d.rope * max(0.0, _stored(d, q))
        energy[0] += 0.5 * mass * v[d.p] ** 2
        for c in range(MATERIAL):
            o = d.p - MATERIAL + c
            energy[0] += 0.5 * d.rope * _wound(d, q) * v[o] * v[o]
            energy[2] -= d.rope * _wound(d, q) * g.gravity[c] * q[o]


@kernel
def _drum_supply(g, t, q, v, p):
    for n in range(g.rows.size):
        d = g.rows[n]
        p[0] += d.way * d.gear * _drum_torque(g, n, t) * v[d.p]


@kernel
def _drum_commit(g, t, h, q, v, a):
    for n in range(g.rows.size):
        d = g.rows[n]
        g.torque[n] = _drum_torque(g, n, t)
        if d.holds == 1 and abs(g.torque[n]) < d.limit:
            asked, _, _ = evaluate(g.functions, d.function, t)
            g.sum[n] += h * (asked - _pull(g, d))


@kernel
def _drum_record(g, out, at):
    for n in range(g.rows.size):
        out[at[0]] = g.torque[n]
        at[0] += 1


register(
    Drums, residual=_drum_residual, mass=_drum_mass, tangent=_drum_tangent, energy=_drum_energy,
    supply=_drum_supply, commit=_drum_commit, record=_drum_record,
)  # fmt: skip


class Supplies(NamedTuple):
    """Rope on drums (n,): place of p at the mark, p where none is left and where no more fits, infinite where there is
    no such end, and +1 where p falls as rope is paid out."""

    p: np.ndarray
    least: np.ndarray
    most: np.ndarray
    way: np.ndarray


@kernel
def _supply_alarm(g, t, q, alarm):
    for i in range(g.p.size):
        if g.way[i] * (q[g.p[i]] - g.least[i]) < 0.0:
            alarm[0], alarm[1] = RUN_OUT, g.p[i]
            return
        if g.way[i] * (q[g.p[i]] - g.most[i]) > 0.0:
            alarm[0], alarm[1] = DRUM_FULL, g.p[i]
            return


register(Supplies, alarm=_supply_alarm)
