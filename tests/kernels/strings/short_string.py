"""Strings of a few lumps in holes of metres, all numbers near one: every term of the equations has weight.

The compiled hooks of a tuple of groups are called through the entries here; all degrees of freedom are free.
"""

from typing import Any, NamedTuple

import numpy as np

from drillstring.model.lumped_string import curve_of
from drillstring.well import wellbore
from tautline.kernels import groups as over
from tautline.kernels.dofs import Dofs
from tautline.kernels.jit import entry, kernel
from tautline.kernels.matrix import Matrix, dense, new_matrix
from tautline.lumped.bend import Bends, bend_slopes
from tautline.lumped.body import LUMP, Bodies, EccentricBodies
from tautline.lumped.curve import PER_BODY, downward, hold_arcs, vertical_depth
from tautline.lumped.link import SPRING, Links, link_slopes
from tautline.system.records import records

BODIES = 4
PLACES = np.array([0.1, 1.3, 2.9, 4.2])
WELLS = {
    "vertical": wellbore.from_survey(np.array([0.0, 9.0]), np.zeros(2), np.zeros(2)),
    "inclined": wellbore.from_survey(np.array([0.0, 9.0]), np.full(2, 0.8), np.full(2, 2.1)),
    "planar": wellbore.from_survey(np.array([0.0, 2.0, 9.0]), np.array([0.0, 0.0, 1.6]), np.full(3, 0.6)),
    "spatial": wellbore.from_survey(
        np.array([0.0, 1.1, 2.4, 5.0]), np.array([0.3, 0.7, 0.9, 1.4]), np.array([0.2, 0.9, 2.2, 3.0])
    ),
    "spatial one arc": wellbore.from_survey(np.array([0.0, 5.0]), np.array([0.4, 1.3]), np.array([0.5, 2.0])),
}


class State(NamedTuple):
    """Full position, velocity, acceleration (n,)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


def random_state(rng, offset=0.25):
    """Lumps near their places, off the axis by about ``offset``, turned anyhow, moving at about 1 m/s and 1 rad/s."""
    q = np.zeros((BODIES, PER_BODY))
    q[:, 0] = rng.uniform(-0.2, 0.2, BODIES)
    q[:, 1:3] = offset * rng.standard_normal((BODIES, 2))
    q[:, 3] = rng.uniform(-3.0, 3.0, BODIES)
    return State(q.ravel(), rng.standard_normal(q.size), rng.standard_normal(q.size))


def curve(well, state, places=PLACES):
    """The well as the kernels see it, every lump held to the arc that it is on."""
    seats = curve_of(well, places)
    hold(seats, state.q)
    return seats


def bodies(seats, rng, eccentric=False, damping=1.0):
    names = [n for n in LUMP.names if eccentric or n not in ("e1", "e2")]
    columns = {name: rng.uniform(0.3, 1.5, seats.seats.size) for name in names}
    for name in ("damping_along", "damping_across", "damping_about"):
        columns[name] *= damping
    kind = EccentricBodies if eccentric else Bodies
    return kind(seats, records(seats.seats.size, LUMP, **columns), np.zeros((3, 4, 4)))


def links(seats, rng, damping=0.0):
    length = np.diff(seats.seats.place)
    n = length.size
    springs = records(n, SPRING, length=length, axial=rng.uniform(1, 3, n), torsional=rng.uniform(1, 3, n))
    return Links(seats, springs, damping, link_slopes(), np.zeros((3, 6, 6)))


def bends(seats, rng, stiff=True):
    length = np.diff(seats.seats.place)
    stiffness = rng.uniform(0.5, 2.0, length.size - 1)
    return Bends(seats, length, stiffness, 1.0 if stiff else 0.0, bend_slopes(), np.zeros((9, 9)))


def all_free(n):
    """Every degree of freedom its own unknown."""
    each, none = np.arange(n), np.zeros(0, dtype=np.int64)
    whole = {"start": np.arange(n + 1), "factor": np.ones(n)}
    whole |= {name: each.copy() for name in ("unknown", "number", "free")}
    empty = {name: np.zeros(0) if name == "offset" else none.copy() for name in Dofs._fields if name not in whole}
    return Dofs(**whole, **empty)


@entry
def hold(curve, q):
    hold_arcs(curve, q)


@entry
def _down(curve, i, x, out):
    out[0], out[1], out[2] = downward(curve, i, x)
    out[3] = vertical_depth(curve, i, x)


@kernel
def add_tangent(groups, t, q, v, a, cm, cc, ck, matrix, dofs):
    over.smooth_tangent(groups, t, q, v, a, cm, cc, ck, matrix, dofs)
    over.switching_tangent(groups, t, q, v, a, cm, cc, ck, matrix, dofs)


@entry
def _add_parts(groups, t, q, v, a, r, parts, e):
    """Residual; tangent by cm, cc and ck; mass; energy."""
    over.residual(groups, t, q, v, a, r)
    over.energy(groups, t, q, v, e)
    add_tangent(groups, t, q, v, a, 1.0, 0.0, 0.0, parts.mass, parts.dofs)
    add_tangent(groups, t, q, v, a, 0.0, 1.0, 0.0, parts.damping, parts.dofs)
    add_tangent(groups, t, q, v, a, 0.0, 0.0, 1.0, parts.stiffness, parts.dofs)
    add_tangent(groups, t, q, v, a, 0.7, -1.3, 2.1, parts.mixed, parts.dofs)
    over.mass(groups, q, parts.hook, parts.dofs)


@entry
def _add_force(groups, t, q, v, a, r, e):
    """Residual and energy alone: differences ask for them hundreds of times."""
    over.residual(groups, t, q, v, a, r)
    over.energy(groups, t, q, v, e)


@entry
def _lose(groups, t, q, v, a, p):
    over.commit(groups, t, 0.0, q, v, a)
    over.dissipation(groups, t, q, v, p)
    over.supply(groups, t, q, v, p[1:])


PARTS = ("residual", "energy", "smooth_tangent", "switching_tangent", "mass")

_linked: list[Any] = [(), None]
"""The groups that were asked last, and their list of hooks: they are asked many times."""


def _link(groups):
    if len(groups) != len(_linked[0]) or any(one is not other for one, other in zip(groups, _linked[0], strict=True)):
        _linked[:] = groups, over.link(groups, *PARTS)
    return _linked[1]


def add_parts(groups, t, q, v, a, r, parts, e):
    """Add what the hooks of the groups give to r, e and the bands of ``parts``."""
    _add_parts(_link(groups), t, q, v, a, r, parts, e)


class Parts(NamedTuple):
    """Matrices: dr/da, dr/dv, dr/dq, a mixture of them, and what the mass hook gives."""

    mass: Matrix
    damping: Matrix
    stiffness: Matrix
    mixed: Matrix
    hook: Matrix
    dofs: Dofs


def down(seats, i, x):
    """Downward unit vector in the frame at body i displaced by x along the hole, and vertical depth."""
    out = np.zeros(4)
    _down(seats, i, x, out)
    return out[:3], out[3]


def evaluate(groups, state, t=0.0):
    """Residual (n,), energies (3,) and the dense parts of the tangent by name.

    Of many groups it is the sum of each alone: what is compiled for one kind serves all tests.
    """
    n = state.q.size
    if len(groups) > 1:
        each = [evaluate((group,), state, t) for group in groups]
        tangents = {name: sum(parts[name] for _, _, parts in each) for name in each[0][2]}
        return sum(r for r, _, _ in each), sum(e for _, e, _ in each), tangents
    r, e = np.zeros(n), np.zeros(3)
    parts = Parts(*(new_matrix(n, n - 1) for _ in range(5)), all_free(n))
    add_parts(groups, t, *state, r, parts, e)
    return r, e, {name: dense(band) for name, band in zip(parts._fields[:5], parts, strict=False)}


def losses(groups, state, t=0.0):
    """Power lost and power put in by a drive, W, once the state is accepted."""
    p = np.zeros(3)
    _lose(over.link(groups, "commit", "dissipation", "supply"), t, *state, p)
    return p[:2]


def force(groups, state, t=0.0):
    """Residual (n,) and energies (3,), of many groups the sum of each alone."""
    r, e = np.zeros(state.q.size), np.zeros(3)
    for group in groups:
        _add_force(_link((group,)), t, *state, r, e)
    return r, e


def residual(groups, state, t=0.0):
    return force(groups, state, t)[0]


def residual_together(groups, state, t=0.0):
    """Residual (n,) of all groups in one sum, as a run asks for it."""
    r = np.zeros(state.q.size)
    _add_force(over.link(groups, *PARTS), t, *state, r, np.zeros(3))
    return r


def energy(groups, state, t=0.0):
    return force(groups, state, t)[1]


def derivative(f, x, step=2e-3):
    """Derivative of f(x) by x: central differences of two steps, extrapolated (Richardson) to an error of step^4."""

    def slope(h):
        columns = [(np.asarray(f(x + d)) - np.asarray(f(x - d))) / (2 * h) for d in h * np.eye(x.size)]
        return np.stack(columns, axis=-1)

    return (4.0 * slope(step / 2) - slope(step)) / 3.0


def rate(f, step=2e-3):
    """Derivative of f(x) at x = 0, for a number x."""
    return derivative(lambda x: f(x[0]), np.zeros(1), step)[..., 0]


def close(one, other):
    """Whether a difference quotient is what it stands for."""
    return np.allclose(one, other, rtol=1e-6, atol=1e-6 * np.abs(one).max(initial=0.0) + 1e-9)


def check_tangent(groups, state):
    """Compare each part of the tangent with differences of the residual, and a mixture with its parts; the parts."""
    _, _, parts = evaluate(groups, state)
    for field, name in zip(state._fields, ("stiffness", "damping", "mass"), strict=True):
        slope = derivative(lambda x, field=field: residual(groups, state._replace(**{field: x})), getattr(state, field))
        assert close(parts[name], slope), name
    mixed = 0.7 * parts["mass"] - 1.3 * parts["damping"] + 2.1 * parts["stiffness"]
    assert np.allclose(parts["mixed"], mixed, rtol=0, atol=1e-13 * max(1.0, np.abs(mixed).max()))
    return parts
