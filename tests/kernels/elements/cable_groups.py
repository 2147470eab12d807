"""Two elements of rope in a row with all numbers near one, and what the references say of them.

Their nodes stand in the full vectors in another order than along the rope, with strangers around them, and the second
element differs from the first in everything. The compiled hooks are called through one entry for all kinds of group.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from references import ale_ancf as reference

from tautline.elements.beam.bending import BENDING, FlowingBending, new_bending
from tautline.elements.flow import Flow
from tautline.elements.inertia import INERTIA, Inertia
from tautline.elements.linear import LinearInertia, LinearTension
from tautline.elements.linear_flow import LINEAR_FLOW, LinearFlow
from tautline.elements.nodal.outlet import OUTLET, Outlets
from tautline.elements.tension import TENSION, FlowingTension, new_tension
from tautline.kernels import groups as over
from tautline.kernels.dofs import Dofs
from tautline.kernels.hermite import gauss, lobatto, table
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix
from tautline.system.records import records_of

CUBIC, LINEAR = 7, 4
STARTS = {CUBIC: (10, 3, 17), LINEAR: (7, 3, 11)}
"""Places of the three nodes along the rope."""
SIZE = {CUBIC: 26, LINEAR: 17}
MASS, FRICTION, LOAD = (2.0, 0.7), (0.3, 0.0), ((1.0, 2.0, -3.0), (0.0, 0.4, 0.9))
EA, EJ, DAMPING, SMOOTHING = (3.0, 5.0), (0.7, 0.4), (0.4, 0.15), (0.5, 0.05)
STRAIN, COMPRESSION = ("green", "engineering"), (True, False)


class State(NamedTuple):
    """Full position, velocity, acceleration (n,)."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray


class Answer(NamedTuple):
    """Residual (n,), energies (3,), power lost and put in (2,), and the tangent by (cm, cc, ck) and the mass (n, n)."""

    residual: np.ndarray
    energy: np.ndarray
    power: np.ndarray
    tangent: np.ndarray
    mass: np.ndarray


# -- states ------------------------------------------------------------------------------------------------------------
def rows_of(kind, element):
    """Full places of an element's unknowns, in the order of the reference."""
    i, j = STARTS[kind][element : element + 2]
    return np.r_[i : i + kind, j : j + kind]


def materials(kind):
    """Full places of p of the three nodes."""
    return np.array(STARTS[kind]) + kind - 1


def curve_state(name, rng):
    """Positions and slopes (3, 3) of the nodes of a curve, and their p (3,)."""
    p = np.array([0.3, 1.2, 2.5])
    along = np.array([1.0, 2.0, 2.0]) / 3.0
    if name == "straight":
        return 1.07 * np.outer(p, along), np.tile(1.07 * along, (3, 1)), p
    if name == "slack":
        sag = 0.1 * np.outer((p - p[1]) ** 2, [0.0, 1.0, -0.3])
        return 0.8 * np.outer(p, along) + sag, np.tile(0.7 * along, (3, 1)) + 0.1 * rng.standard_normal((3, 3)), p
    if name == "folded":
        back = np.array([[0.0, 0.0, 0.0], [0.9, 0.1, 0.0], [0.05, 0.2, 0.1]])
        return back, np.array([[1.1, 0.0, 0.1], [0.0, 0.3, 0.1], [-1.2, 0.1, 0.0]]), p
    if name == "strongly bent":
        angle = 2.2 * (p - p[0])
        turn = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * angle])
        return np.column_stack([np.sin(angle), 1.0 - np.cos(angle), 0.05 * angle**2]) / 2.0, 1.1 * turn, p
    position = np.array([[0.0, 0.0, 0.0], [0.8, 0.3, -0.2], [2.1, 0.1, 0.3]])
    slope = np.array([[1.0, 0.1, 0.2], [0.9, -0.3, 0.1], [1.1, 0.2, 0.0]])
    shaken = 0.05 * rng.standard_normal((2, 3, 3))
    return position + shaken[0], slope + shaken[1], p + 0.05 * rng.standard_normal(3)


SHAPES = ("anyhow", "straight", "slack", "folded", "strongly bent", "fast flow")


def new_state(kind, shape="anyhow", still=False, seed=0):
    """A state with random rates; material rests if ``still``, and moves at about 30 m/s in a fast flow."""
    rng = np.random.default_rng([seed, len(shape)])
    position, slope, p = curve_state(shape, rng)
    q, v, a = rng.standard_normal((3, SIZE[kind]))
    for node, start in enumerate(STARTS[kind]):
        q[start : start + 3] = position[node]
        if kind == CUBIC:
            q[start + 3 : start + 6] = slope[node]
        q[start + kind - 1] = p[node]
    if shape == "fast flow":
        v[materials(kind)] += 30.0
    if still:
        v[materials(kind)] = a[materials(kind)] = 0.0
    return State(q, v, a)


# -- groups ------------------------------------------------------------------------------------------------------------
def _ends(kind):
    starts = STARTS[kind]
    return [{"a": starts[e], "b": starts[e + 1]} for e in range(2)]


def _inertias(kind, damped, record=INERTIA, more=({}, {})):
    rows = [
        ends | {"mass": MASS[e], "damping": FRICTION[e] if damped else 0.0, "load": LOAD[e]} | more[e]
        for e, ends in enumerate(_ends(kind))
    ]
    return records_of(record, rows)


def _tensions(kind, damped):
    rows = [
        ends
        | {"stiffness": EA[e], "damping": DAMPING[e] if damped else 0.0}
        | {"engineering": int(STRAIN[e] == "engineering"), "slack": int(not COMPRESSION[e])}
        for e, ends in enumerate(_ends(kind))
    ]
    return records_of(TENSION, rows)


def _bendings(damped):
    rows = [
        ends | {"stiffness": EJ[e], "damping": DAMPING[e] if damped else 0.0, "smoothing": SMOOTHING[e]}
        for e, ends in enumerate(_ends(CUBIC))
    ]
    return records_of(BENDING, rows)


GAUSS, LOBATTO, FINE = table(*gauss(3)), table(*lobatto()), table(*gauss(4))
KINKS = ({"kinks": (0.0, 1.0)}, {"kinks": (1.0, 0.0)})


def inertia(damped=True):
    return Inertia(_inertias(CUBIC, damped), np.zeros((4, 4)))


def flow(damped=True):
    return Flow(_inertias(CUBIC, damped), FINE, np.zeros((6, 4)), np.zeros((10, 3)), np.zeros((14, 14)))


def tension(damped=True, points=GAUSS):
    return new_tension(_tensions(CUBIC, damped), points)


def flowing_tension(damped=True, points=GAUSS):
    scratch = np.zeros((6, 4)), np.zeros((9, 3)), np.zeros((14, 14))
    return FlowingTension(_tensions(CUBIC, damped), points, *scratch)


def bending(damped=True):
    return new_bending(_bendings(damped), GAUSS)


def flowing_bending(damped=True):
    scratch = np.zeros((5, 4)), np.zeros((14, 6)), np.zeros((2, 6, 6)), np.zeros((14, 14))
    return FlowingBending(_bendings(damped), GAUSS, *scratch)


def linear_inertia(damped=True):
    return LinearInertia(_inertias(LINEAR, damped))


def linear_flow(damped=True, kinks=KINKS):
    """The middle node joins two elements: momentum is turned there."""
    return LinearFlow(_inertias(LINEAR, damped, LINEAR_FLOW, kinks), np.zeros((3, 3)), np.zeros((8, 8)))


def linear_tension(damped=True):
    return LinearTension(_tensions(LINEAR, damped), np.zeros((4, 3)), np.zeros((8, 8)))


def outlets():
    """Both ends of the rope."""
    rows = [
        ends
        | {"end": e, "stiffness": EA[e], "bending": EJ[e]}
        | {"engineering": int(STRAIN[e] == "engineering"), "slack": int(not COMPRESSION[e])}
        for e, ends in enumerate(_ends(CUBIC))
    ]
    return Outlets(records_of(OUTLET, rows), np.zeros((4, 4)), np.zeros((3, 6)))


# -- references: element, q, v, a of that element -> its force ---------------------------------------------------------
def inertial(e, q, v, a, linear, damped):
    force = reference.inertia(q, v, a, MASS[e], LOAD[e], linear)
    if damped and FRICTION[e]:
        # A particle's velocity is the sum of the virtual displacements times the rates: the damping is M v.
        force = force + FRICTION[e] * reference.mass(q, MASS[e], linear) @ v
    return force


def _axial(e, q, v, damped, linear, rule):
    material = {"strain": STRAIN[e], "compression": COMPRESSION[e], "axial": (rule, 3), "linear": linear}
    force = reference.elastic(q, EA[e], 0.0, **material)
    return force + reference.damping(q, v, EA[e], 0.0, DAMPING[e], **material) if damped else force


def _bent(e, q, v, damped):
    force = reference.elastic(q, 0.0, EJ[e])
    return force + reference.damping(q, v, 0.0, EJ[e], DAMPING[e], SMOOTHING[e]) if damped else force


def turned(q, v):
    """Force of the momentum turned at the middle node of the linear rope, in full (n,)."""
    (i, j, k), r = STARTS[LINEAR], np.zeros(SIZE[LINEAR], np.result_type(q, v))
    slopes = [(q[y : y + 3] - q[x : x + 3]) / (q[y + 3] - q[x + 3]) for x, y in ((i, j), (j, k))]
    # Each side of it with the mass of its own element.
    for mass, sides in zip(MASS, ((slopes[0], 0 * slopes[0]), (0 * slopes[1], slopes[1])), strict=True):
        force, material = reference.kink(*sides, v[j + 3], mass)
        r[j : j + 3] += force
        r[j + 3] += material
    return r


class Kind(NamedTuple):
    """A kind of group: its maker, nodes, whether its material rests, the reference of an element and of the rest."""

    make: Callable[..., Any]
    node: int
    still: bool
    force: Callable[..., np.ndarray]
    whole: Callable[..., np.ndarray] | None = None


KINDS = {
    "inertia": Kind(inertia, CUBIC, True, lambda e, q, v, a, d: inertial(e, q, v, a, False, d)),
    "flow": Kind(flow, CUBIC, False, lambda e, q, v, a, d: inertial(e, q, v, a, False, d)),
    "tension": Kind(tension, CUBIC, True, lambda e, q, v, a, d: _axial(e, q, v, d, False, "gauss")),
    "tension, Lobatto": Kind(
        lambda d=True: tension(d, LOBATTO), CUBIC, True, lambda e, q, v, a, d: _axial(e, q, v, d, False, "lobatto")
    ),
    "flowing tension": Kind(flowing_tension, CUBIC, False, lambda e, q, v, a, d: _axial(e, q, v, d, False, "gauss")),
    "flowing tension, Lobatto": Kind(
        lambda d=True: flowing_tension(d, LOBATTO), CUBIC, False,
        lambda e, q, v, a, d: _axial(e, q, v, d, False, "lobatto"),
    ),
    "bending": Kind(bending, CUBIC, True, lambda e, q, v, a, d: _bent(e, q, v, d)),
    "flowing bending": Kind(flowing_bending, CUBIC, False, lambda e, q, v, a, d: _bent(e, q, v, d)),
    "linear inertia": Kind(linear_inertia, LINEAR, True, lambda e, q, v, a, d: inertial(e, q, v, a, True, d)),
    "linear flow": Kind(
        linear_flow, LINEAR, False, lambda e, q, v, a, d: inertial(e, q, v, a, True, d), lambda q, v: turned(q, v)
    ),
    "linear tension": Kind(linear_tension, LINEAR, False, lambda e, q, v, a, d: _axial(e, q, v, d, True, "gauss")),
}  # fmt: skip


def force(kind, state, damped=True):
    """Residual of the reference (n,)."""
    r = np.zeros(state.q.size)
    for e in range(2):
        rows = rows_of(kind.node, e)
        r[rows] += kind.force(e, *(x[rows] for x in state), damped)
    return r if kind.whole is None else r + kind.whole(state.q, state.v)


def slopes(kind, state):
    """Derivatives of the reference by a, v and q, complex steps (3, n, n)."""
    n = state.q.size
    made = np.zeros((3, n, n))
    for part, which in enumerate((2, 1, 0)):
        for e in range(2):
            rows = rows_of(kind.node, e)
            given = [x[rows] for x in state]
            made[part][np.ix_(rows, rows)] += reference.jacobian(
                lambda x, e=e, w=which, g=given: kind.force(e, *g[:w], x, *g[w + 1 :], True), given[which]
            )
    if kind.whole is not None:
        made[1] += reference.jacobian(lambda v: kind.whole(state.q, v), state.v)
        made[2] += reference.jacobian(lambda q: kind.whole(q, state.v), state.q)
    return made


def counted(kind):
    """Which unknowns a kind answers for: a still one leaves out p, which is held."""
    keep = np.ones(SIZE[kind.node], dtype=bool)
    if kind.still:
        keep[materials(kind.node)] = False
    return keep


# -- hooks -------------------------------------------------------------------------------------------------------------
HOOKS = ("begin", "residual", "energy", "dissipation", "supply", "smooth_tangent", "mass", "violation")


@entry
def _ask(groups, t, h, beta, gamma, q, v, a, c, r, e, p, gaps, tangent, mass, dofs):
    over.begin(groups, t, h, beta, gamma, q, v, a)
    over.residual(groups, t + h if beta > 0.0 else t, q, v, a, r)  # an implicit step asks at its end
    over.energy(groups, t, q, v, e)
    over.dissipation(groups, t, q, v, p)
    over.supply(groups, t, q, v, p[1:])
    over.smooth_tangent(groups, t, q, v, a, c[0], c[1], c[2], tangent, dofs)
    over.mass(groups, q, mass, dofs)
    over.violation(groups, 0, q, v, gaps[0])
    over.violation(groups, 1, q, v, gaps[1])


@lru_cache
def all_free(n):
    """Every degree of freedom its own unknown."""
    each = np.arange(n)
    filled = {
        "start": np.arange(n + 1),
        "unknown": each,
        "factor": np.ones(n),
        "number": each.copy(),
        "free": each.copy(),
    }
    return Dofs(
        **{name: filled.get(name, np.zeros(0, float if name == "offset" else np.int64)) for name in Dofs._fields}
    )


_linked: list[Any] = [None, None]
"""The group that was asked last, and its list of hooks: it is asked many times."""


def _link(group):
    if _linked[0] is not group:
        _linked[:] = group, over.link((group,), *HOOKS)
    return _linked[1]


def ask(group, state, factors=(0.0, 0.0, 0.0), t=0.0, h=0.1, beta=0.0, gaps=None):
    """Call all hooks of a group; ``factors`` are cm, cc and ck of the tangent, ``gaps`` (2, n) takes violations."""
    n = state.q.size
    r, e, p = np.zeros(n), np.zeros(3), np.zeros(3)
    tangent, mass = new_matrix(n, n - 1), new_matrix(n, n - 1)
    gaps = np.zeros((2, n)) if gaps is None else gaps
    _ask(
        _link(group), t, h, float(beta), 0.0, *state, np.array(factors, float), r, e, p, gaps, tangent,
        mass, all_free(n),
    )  # fmt: skip
    return Answer(r, e, np.array([p[0], p[1] + p[2]]), dense(tangent), dense(mass))


def residual(group, state, **given):
    return ask(group, state, **given).residual


def parts(group, state, **given):
    """The tangent by a, by v and by q, (3, n, n)."""
    return np.stack([ask(group, state, tuple(c), **given).tangent for c in np.eye(3)])


def derivative(f, x, step=1e-3):
    """Derivative of f(x) by x, central differences of fourth order."""
    columns = []
    for d in step * np.eye(x.size):
        near, far = (np.asarray(f(x + k * d)) - np.asarray(f(x - k * d)) for k in (1, 2))
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.stack(columns, axis=-1)


def rate(f, step=1e-3):
    """Derivative of f(x) at x = 0, for a number x."""
    return derivative(lambda x: f(x[0]), np.zeros(1), step)[..., 0]


def moved(state, x):
    """The state a short time x later."""
    return State(state.q + x * state.v + 0.5 * x * x * state.a, state.v + x * state.a, state.a)


def close(one, other, tolerance, size=0.0):
    """Whether two arrays agree to a share of the largest entry, or of ``size`` if that is more."""
    largest = max(np.abs(one).max(initial=0.0), np.abs(other).max(initial=0.0), size)
    return bool(np.abs(one - other).max(initial=0.0) <= tolerance * largest)
