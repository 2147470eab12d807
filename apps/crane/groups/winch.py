"""Rope that is wound up on drums; those that a motor drives, by torque or to hold a tension; and how much is left."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crane.groups.span import (
    FIRST,
    FIRST_PSI,
    LAST,
    MATERIAL,
    STRAIN_ENERGY,
    STRETCH,
    STRETCH_RATE,
    add_by_tension,
)  # fmt: skip
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import DRUM_FULL, RUN_OUT, Integral, register
from tautline.kernels.jit import kernel
from tautline.kernels.time_function import TimeFunctions, evaluate

WOUND = np.dtype([("p", "i8"), ("sign", "f8"), ("rope", "f8"), ("begin", "f8"), ("span", "i8")])
"""Rope that comes onto a drum: the place of p at its mark, which stands behind its centre; sign, +1 at the beginning of
the rope, where p grows as it is hoisted, and -1 at its end; rhoA kg/m; p at the start; and the span that leaves it."""
DRUM = np.dtype(
    [
        ("p", "i8"), ("sign", "f8"), ("radius", "f8"), ("inertia", "f8"), ("rope", "f8"), ("stored", "f8"),
        ("begin", "f8"), ("function", "i8"), ("holds", "i8"), ("proportional", "f8"), ("integral", "f8"),
        ("limit", "f8"), ("span", "i8"), ("a", "i8"), ("b", "i8"),
    ]
)  # fmt: skip
"""A drum whose motion is not prescribed: p, sign, rope, begin and span as in ``WOUND``; R m; inertia kg m^2; rope on it
at the start m (infinite: no end of it); the function of its torque N m or, where it holds a tension (holds 1), of that
N; its gains, 1 and 1/s; largest torque N m; and the places of the stations of its span."""


class WoundRope(NamedTuple):
    """Rope on drums (n,) of ``WOUND``; ``gravity`` (3,) m/s^2; ``found`` as in `Slips`; ``water`` (3,): the level of
    its surface m, what a metre of rope displaces N, and half the width over which rope enters it m.

    A span has the energies of its rope in space (`crane.groups.span`), and what is wound up leaves it. So the rope that
    has come onto the drum since the start, S long, has them too: with the drum's centre c

        T = rhoA S c. . c. / 2,   V = -rhoA S g . c + integral of W dS + S B f,

    with the buoyancy B of a metre of rope and f the depth of c below the surface (`crane.groups.hydrodynamics`).

    Without them the motion of a driven drum, and the work of any, would depend on where the scene's origin lies and on
    how fast it moves; and a loaded rope would lose its strain where it comes onto the drum. It is wound up with the
    stretch that it has. What is paid out comes with that of the span, whatever it was wound up with: ``strain`` (n,) J,
    the integral, is less than what is left on the drum where the load has grown. ``last`` (n, 2) is p and W at the end
    of the last step.
    """

    rows: np.recarray
    gravity: np.ndarray
    found: np.ndarray
    strain: np.ndarray
    last: np.ndarray
    water: np.ndarray


@kernel
def _wound(w, q):
    """Rope that has come onto the drum since the start, m."""
    return w.sign * (q[w.p] - w.begin)


@kernel
def _afloat(g, w, q):
    """Depth of a drum's centre below the surface, m, 0 above it; and its rate by the depth, the share under water."""
    deep, width = g.water[0] - q[w.p - 1], g.water[2]
    x = min(max(deep / width, -1.0), 1.0)
    inside = width * (0.1875 + 0.5 * x + 0.375 * x**2 - 0.0625 * x**4)
    return inside + max(0.0, deep - width), 0.25 * (2.0 + 3.0 * x - x**3)


@kernel
def _wound_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        w = g.rows[n]
        if g.water[1] > 0.0:
            deep, share = _afloat(g, w, q)
            r[w.p] += w.sign * g.water[1] * deep
            r[w.p - 1] -= _wound(w, q) * g.water[1] * share
        for c in range(MATERIAL):
            o = w.p - MATERIAL + c
            r[o] += w.rope * (_wound(w, q) * (a[o] - g.gravity[c]) + w.sign * v[w.p] * v[o])
            r[w.p] -= w.sign * w.rope * (0.5 * v[o] * v[o] + g.gravity[c] * q[o])


@kernel
def _wound_energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        w = g.rows[n]
        energy[1] += g.strain[n]
        if g.water[1] > 0.0:
            energy[2] += _wound(w, q) * g.water[1] * _afloat(g, w, q)[0]
        for c in range(MATERIAL):
            o = w.p - MATERIAL + c
            energy[0] += 0.5 * w.rope * _wound(w, q) * v[o] * v[o]
            energy[2] -= w.rope * _wound(w, q) * g.gravity[c] * q[o]


@kernel
def _wound_commit(g, t, h, q, v, a):
    for n in range(g.rows.size):
        w = g.rows[n]
        now = g.found[w.span, STRAIN_ENERGY]
        if h > 0.0:
            g.strain[n] += 0.5 * (g.last[n, 1] + now) * w.sign * (q[w.p] - g.last[n, 0])
        g.last[n, 0], g.last[n, 1] = q[w.p], now


register(WoundRope, residual=_wound_residual, energy=_wound_energy, commit=_wound_commit)


class Drums(NamedTuple):
    """Drums (n,) of ``DRUM``; ``found`` and ``direction`` as in `Slips`; ``sum`` (n,) is the integral of what tension
    lacks, N s, ``torque`` (n,) that of the last step. While the torque is at its limit, the integral does not grow. It
    lessens there as soon as the tension is beyond what is asked for.

    A drum turns with the rope that comes onto it, at theta. = lambda p. / R. So a torque acts on p with lambda / R, and
    what turns, with the mass m = I/R^2 + rhoA S at the rim, has T = m (lambda p.)^2 / 2 and resists with

        lambda m (lambda p.. + lambda. p.) + rhoA (lambda p.)^2 dS/dp / 2.
    """

    rows: np.recarray
    found: np.ndarray
    direction: np.ndarray
    sum: np.ndarray
    torque: np.ndarray
    functions: TimeFunctions


@kernel
def _pull(g, d, v):
    """Tension at a drum, N, with what turns the rope's momentum."""
    turned = d.rope * g.found[d.span, STRETCH] * v[d.p] * v[d.p]
    return turned + (g.found[d.span, FIRST] if d.sign > 0.0 else g.found[d.span, LAST])


@kernel
def _stretch(g, d):
    """That of the rope which comes onto a drum; slack rope lies on it as long as it is."""
    return max(1.0, g.found[d.span, STRETCH])


@kernel
def _stretching(g, d):
    """Its rate, 1/s."""
    return g.found[d.span, STRETCH_RATE] if g.found[d.span, STRETCH] > 1.0 else 0.0


@kernel
def _drum_torque(g, n, t, v):
    d = g.rows[n]
    asked, _, _ = evaluate(g.functions, d.function, t)
    if d.holds == 1:
        lack = asked - _pull(g, d, v)
        asked = (asked + d.proportional * lack + d.integral * g.sum[n]) * d.radius
    return min(max(asked, -d.limit), d.limit)


@kernel
def _stored(d, q):
    """Rope on the drum, m; what has no end has no inertia of its own either."""
    return max(0.0, d.stored + d.sign * (q[d.p] - d.begin)) if d.stored < np.inf else 0.0


@kernel
def _drum_inertia(d, q):
    """Of drum and rope at the rim, kg."""
    return d.inertia / (d.radius * d.radius) + d.rope * _stored(d, q)


@kernel
def _drum_residual(g, t, q, v, a, r):
    for n in range(g.rows.size):
        d = g.rows[n]
        stretch = _stretch(g, d)
        changed = _drum_inertia(d, q) * (stretch * a[d.p] + _stretching(g, d) * v[d.p])
        r[d.p] += stretch * changed + 0.5 * d.sign * d.rope * (stretch * v[d.p]) ** 2
        r[d.p] -= d.sign * _stretch(g, d) / d.radius * _drum_torque(g, n, t, v)


@kernel
def _drum_mass(g, q, matrix, dofs):
    for n in range(g.rows.size):
        d = g.rows[n]
        add_entry(matrix, dofs, d.p, d.p, _drum_inertia(d, q) * _stretch(g, d) ** 2)


@kernel
def _add_by_stretch(g, n, t, q, v, a, cc, ck, matrix, dofs):
    """What changes with the stretch of the rope that comes onto a drum."""
    d, stretch = g.rows[n], g.found[g.rows[n].span, STRETCH]
    by = _drum_inertia(d, q) * (2.0 * stretch * a[d.p] + _stretching(g, d) * v[d.p])
    by += d.sign * (d.rope * stretch * v[d.p] ** 2 - _drum_torque(g, n, t, v) / d.radius)
    by = ck * by + cc * _drum_inertia(d, q) * stretch * v[d.p]
    by /= q[d.b + MATERIAL] - q[d.a + MATERIAL]
    for c in range(MATERIAL):
        add_entry(matrix, dofs, d.p, d.a + c, -by * g.direction[d.span, c])
        add_entry(matrix, dofs, d.p, d.b + c, by * g.direction[d.span, c])
    add_entry(matrix, dofs, d.p, d.a + MATERIAL, by * stretch)
    add_entry(matrix, dofs, d.p, d.b + MATERIAL, -by * stretch)


@kernel
def _drum_tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    for n in range(g.rows.size):
        d = g.rows[n]
        x = _drum_inertia(d, q) * (cm * _stretch(g, d) + cc * _stretching(g, d))
        x += d.sign * d.rope * _stretch(g, d) * (cc * v[d.p] + ck * a[d.p])
        x *= _stretch(g, d)
        add_entry(matrix, dofs, d.p, d.p, x)
        if g.found[d.span, STRETCH] > 1.0:
            _add_by_stretch(g, n, t, q, v, a, cc, ck, matrix, dofs)
        if d.holds == 1 and d.proportional > 0.0 and abs(_drum_torque(g, n, t, v)) < d.limit:
            by = d.sign * _stretch(g, d) * d.proportional
            add_by_tension(g.found, g.direction, d.span, d.a, d.b, d.sign > 0.0, d.p, by, cm, cc, ck, matrix, dofs)


@kernel
def _drum_energy(g, t, q, v, energy):
    for n in range(g.rows.size):
        d = g.rows[n]
        energy[0] += 0.5 * _drum_inertia(d, q) * (_stretch(g, d) * v[d.p]) ** 2


@kernel
def _drum_supply(g, t, q, v, p):
    for n in range(g.rows.size):
        d = g.rows[n]
        p[0] += d.sign * _stretch(g, d) * v[d.p] / d.radius * _drum_torque(g, n, t, v)
        if d.stored == np.inf:
            # Nobody keeps the energy of the rope that comes onto a drum without an end of it.
            p[0] -= 0.5 * d.sign * d.rope * _stretch(g, d) ** 2 * v[d.p] ** 3


@kernel
def _drum_commit(g, t, h, q, v, a):
    for n in range(g.rows.size):
        d = g.rows[n]
        g.torque[n] = _drum_torque(g, n, t, v)
        if d.holds == 1:
            asked, _, _ = evaluate(g.functions, d.function, t)
            lack = asked - _pull(g, d, v)
            # Without a proportional gain nothing but the integral brings the torque back from its limit.
            if abs(g.torque[n]) < d.limit or g.torque[n] * lack < 0.0:
                g.sum[n] += h * lack


@kernel
def _drum_record(g, out, at):
    for n in range(g.rows.size):
        out[at[0]] = g.torque[n]
        at[0] += 1


def _integrals(g: Drums) -> list[Integral]:
    """Those that a torque within its limit follows."""
    rows = g.rows
    follow = (rows["holds"] == 1) & (rows["integral"] > 0.0) & (np.abs(g.torque) < rows["limit"])
    text = "integral of the missing tension"
    return [Integral(g.sum, int(n), int(rows["p"][n]), text) for n in np.flatnonzero(follow)]


register(
    Drums, residual=_drum_residual, mass=_drum_mass, tangent=_drum_tangent, energy=_drum_energy,
    supply=_drum_supply, commit=_drum_commit, record=_drum_record,
    feels=lambda drums: bool(drums.rows["holds"].any()),  # the tension at a drum has what accelerates the rope in it
    integrals=_integrals,
)  # fmt: skip


class Supplies(NamedTuple):
    """Rope on drums (n,): place of p at the mark, p where none is left and where no more fits, infinite where there is
    no such end, and +1 where p falls as rope is paid out.

    The rope leaves a drum at p + rho psi / lambda: what has turned round it, or what it leads to, has laid that on or
    taken it off as well. ``span`` is the number of the span there, ``side`` 0 where the drum is at its beginning and 1
    at its end, ``rho`` its signed radius m, or 0 where nothing turns; ``begin`` psi at the start rad, and ``found`` as
    in `Slips`. What lies beyond the mark is the span's in everything else, its inertia too: no drum has that again.
    """

    p: np.ndarray
    least: np.ndarray
    most: np.ndarray
    sign: np.ndarray
    span: np.ndarray
    side: np.ndarray
    rho: np.ndarray
    begin: np.ndarray
    found: np.ndarray


@kernel
def _supply_commit(g, t, h, q, v, a):
    if h > 0.0:
        return
    for i in range(g.p.size):
        if np.isnan(g.begin[i]):
            g.begin[i] = g.found[g.span[i], FIRST_PSI + g.side[i]]


@kernel
def _leaves(g, i, q):
    """p where the rope leaves a drum, as far as turning has moved it since the start."""
    if g.rho[i] == 0.0 or np.isnan(g.begin[i]):
        return q[g.p[i]]
    turned = g.found[g.span[i], FIRST_PSI + g.side[i]] - g.begin[i]
    return q[g.p[i]] + g.rho[i] * turned / max(1.0, g.found[g.span[i], STRETCH])


@kernel
def _supply_alarm(g, t, q, alarm):
    for i in range(g.p.size):
        at = _leaves(g, i, q)
        if g.sign[i] * (at - g.least[i]) < 0.0:
            alarm[0], alarm[1] = RUN_OUT, g.p[i]
            return
        if g.sign[i] * (at - g.most[i]) > 0.0:
            alarm[0], alarm[1] = DRUM_FULL, g.p[i]
            return


register(Supplies, alarm=_supply_alarm, commit=_supply_commit)
