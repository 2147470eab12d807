"""One rope span between two sheaves in space, by brute force from its Lagrangian, in multiple precision.

The rope runs from a mark on sheave 1 along the rim, along the straight tangent e, and along the rim of sheave 2 to the
mark there.  Each sheave has a signed radius rho (positive where the rope runs right-handed about the axis; 0: a point),
an axis a and a mark direction m normal to it, both carried by a frame that turns steadily.  With d = c2 - c1:

    w_i = (e x a_i)/|e x a_i|,  s = d + rho2 w2 - rho1 w1,  e = s/|s|,  l = |s|,
    psi_i: angle from m_i to w_i, right-handed about a_i, so that dw_i = (a_i x w_i) dpsi_i in the frame of the sheave,
    Lam = l + rho1 psi1 - rho2 psi2,  L = p2 - p1,  lambda = Lam/L,  eps = (lambda^2 - 1)/2 or lambda - 1,
    v_i = dc_i/dt - lambda e dp_i/dt,  T = rhoA L (v1.v1 + v1.v2 + v2.v2)/6,
    V = L EA eps^2/2 - rhoA L g.(c1 + c2)/2,  dissipated power D = L EA c (d eps/dt)^2.

Lagrange's equations of that are all there is here: nothing is differentiated by hand.  The tangent is iterated and the
derivatives are central differences with `STEP` in `DIGITS` digits, so that what comes out is exact to double precision.
The Lagrangian counts the rope between p1 and p2; the momentum and energy that rope carries through the two marks is in
the residual, and cancels between the two spans that meet at a mark.

The generalised coordinates are q = (c1, p1, c2, p2), 8 numbers; v and a are their rates.  SI units, angles in rad.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp
from numpy.typing import ArrayLike, NDArray

DIGITS = 50
STEP = 1e-15  # of the differences: they are wrong by its square, and by 10^-DIGITS over it
ITERATIONS = 1000

Exact = NDArray[np.object_]  # array of multiple-precision numbers


@dataclass(frozen=True)
class Sheave:
    """Rim and the frame that carries it.

    Parameters
    ----------
    radius : signed radius rho [m]; 0: a point, for which the rest has no meaning
    axis, mark : (3,) directions of axis and mark in the frame; the mark is taken normal to the axis
    rotation : (3, 3) of the frame at time 0: axis in space = rotation(t) @ axis
    rate : (3,) constant angular velocity of the frame, in space [rad/s]
    """

    radius: float = 0.0
    axis: ArrayLike = (0.0, 1.0, 0.0)
    mark: ArrayLike = (0.0, 0.0, 1.0)
    rotation: ArrayLike = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    rate: ArrayLike = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Span:
    """Two sheaves in the order of the rope, and the rope.

    Parameters
    ----------
    first, second : sheaves that the rope leaves and reaches
    EA : axial stiffness [N]
    rhoA : mass per unstretched length [kg/m]
    damping : time c of N = EA (eps + c deps/dt) lambda [s]
    gravity : (3,) [m/s2]
    engineering : whether eps is lambda - 1, and not Green's
    """

    first: Sheave
    second: Sheave
    EA: float
    rhoA: float
    damping: float = 0.0
    gravity: ArrayLike = (0.0, 0.0, -9.81)
    engineering: bool = False


class Geometry(NamedTuple):
    """Where a span is: floats from `geometry`, multiple precision inside this file."""

    e: Any  # (3,) unit tangent along the rope
    length: Any  # l, of the straight part [m]
    w: Any  # (2, 3) unit vectors from axis to tangent point over the sign of the radius; zero at a point
    psi: Any  # (2,) angles from the marks to w; zero at a point
    path: Any  # Lam, length from mark to mark [m]
    unstretched: Any  # L [m]
    stretch: Any  # lambda
    strain: Any  # eps


def _exact(values: Any) -> Exact:
    values = np.asarray(values, dtype=object)
    return np.array([mp.mpf(x) for x in values.ravel()], dtype=object).reshape(values.shape)


def _cross(a: Exact, b: Exact) -> Exact:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], dtype=object)


def _unit(a: Exact) -> Exact:
    return a / mp.sqrt(a @ a)


def _gradient(function: Callable[[Exact], Any], x: Exact) -> Exact:
    """Central differences for each x_j, in the first axis."""
    h = mp.mpf(STEP)
    rows = []
    for j in range(len(x)):
        step = _exact(np.zeros(len(x)))
        step[j] = h
        rows.append((function(x + step) - function(x - step)) / (2 * h))
    return np.array(rows, dtype=object)


# geometry
def _rotation(sheave: Sheave, time: Any) -> Exact:
    """expm(skew(rate) t) R0, by Rodrigues' formula."""
    start, rate = _exact(sheave.rotation), _exact(sheave.rate)
    speed = mp.sqrt(rate @ rate)
    if speed == 0:
        return start
    turned = [
        column
        + mp.sin(speed * time) / speed * _cross(rate, column)
        + (1 - mp.cos(speed * time)) / speed**2 * _cross(rate, _cross(rate, column))
        for column in start.T
    ]
    return np.array(turned, dtype=object).T


def _orientations(span: Span, time: Any) -> list[tuple[Any, Exact, Exact]]:
    """Signed radius, axis and mark in space of either sheave; rounding of the input is taken out of the directions."""
    result = []
    for sheave in (span.first, span.second):
        turned = _rotation(sheave, time)
        axis, mark = _unit(turned @ _exact(sheave.axis)), turned @ _exact(sheave.mark)
        result.append((mp.mpf(sheave.radius), axis, _unit(mark - axis * (axis @ mark))))
    return result


def _rim(radius: Any, axis: Exact, e: Exact) -> Exact:
    return _unit(_cross(e, axis)) if radius else 0 * e


def _chord(d: Exact, rims: list[tuple[Any, Exact, Exact]], e: Exact) -> Exact:
    """Vector s between the tangent points that belong to the direction e."""
    (rho1, a1, _), (rho2, a2, _) = rims
    return d + rho2 * _rim(rho2, a2, e) - rho1 * _rim(rho1, a1, e)


def _tangent(d: Exact, rims: list[tuple[Any, Exact, Exact]]) -> Exact:
    """Fixed point e = s(e)/|s(e)|, from the direction between the centres."""
    e, close = _unit(d), mp.mpf(10) ** (5 - mp.dps)
    for _ in range(ITERATIONS):
        before, e = e, _unit(_chord(d, rims, e))
        if max(abs(e - before)) < close:
            return e
    radii, distance = [float(rim[0]) for rim in rims], float(mp.sqrt(d @ d))
    raise ValueError(f"no tangent between signed radii {radii[0]:g} and {radii[1]:g} m at {distance:g} m of centres")


def _geometry(span: Span, q: Exact, time: Any) -> Geometry:
    rims = _orientations(span, time)
    d = q[4:7] - q[0:3]
    e = _tangent(d, rims)
    s = _chord(d, rims, e)
    length = mp.sqrt(s @ s)
    w = [_rim(rho, axis, e) for rho, axis, _ in rims]
    psi = [mp.atan2(w_i @ _cross(axis, mark), w_i @ mark) for w_i, (_, axis, mark) in zip(w, rims, strict=True)]
    path = length + rims[0][0] * psi[0] - rims[1][0] * psi[1]
    unstretched = q[7] - q[3]
    stretch = path / unstretched
    strain = stretch - 1 if span.engineering else (stretch**2 - 1) / 2
    return Geometry(e, length, w, psi, path, unstretched, stretch, strain)


# Lagrangian
def _kinetic(span: Span, at: Geometry, v: Exact) -> Any:
    v1, v2 = (v[k : k + 3] - at.stretch * at.e * v[k + 3] for k in (0, 4))
    return mp.mpf(span.rhoA) * at.unstretched * (v1 @ v1 + v1 @ v2 + v2 @ v2) / 6


def _elastic(span: Span, at: Geometry) -> Any:
    return at.unstretched * mp.mpf(span.EA) * at.strain**2 / 2


def _weight(span: Span, q: Exact) -> Any:
    return -mp.mpf(span.rhoA) * (q[7] - q[3]) * (_exact(span.gravity) @ (q[0:3] + q[4:7])) / 2


def _strain_rate(span: Span, q: Exact, v: Exact, time: Any) -> Any:
    """Total rate of eps, turning frames included."""
    h = mp.mpf(STEP)
    later, earlier = (_geometry(span, q + s * v, time + s).strain for s in (h, -h))
    return (later - earlier) / (2 * h)


def residual(span: Span, q: ArrayLike, v: ArrayLike, a: ArrayLike, time: float) -> NDArray[np.float64]:
    """d/dt dT/dv - dT/dq + dV/dq + L EA c (deps/dt) deps/dq: what has to act on (c1, p1, c2, p2) from outside [N].

    Parameters
    ----------
    q, v, a : (8,) coordinates [m], rates [m/s], accelerations [m/s2]
    time : at which the frames are taken [s]

    Raises
    ------
    ValueError : the sheaves have no common tangent, or the iteration does not reach it
    """
    with mp.workdps(DIGITS):
        q, v, a, time, h = _exact(q), _exact(v), _exact(a), mp.mpf(time), mp.mpf(STEP)

        def momentum(s: Any) -> Exact:
            at = _geometry(span, q + s * v + s**2 / 2 * a, time + s)
            return _gradient(lambda rates: _kinetic(span, at, rates), v + s * a)

        def positional(x: Exact) -> Exact:
            at = _geometry(span, x, time)
            return np.array([_elastic(span, at) + _weight(span, x) - _kinetic(span, at, v), at.strain], dtype=object)

        inertia = (momentum(h) - momentum(-h)) / (2 * h)
        conservative, strain = _gradient(positional, q).T
        viscous = (q[7] - q[3]) * mp.mpf(span.EA) * mp.mpf(span.damping) * _strain_rate(span, q, v, time)
        return (inertia + conservative + viscous * strain).astype(float)


def frame_power(span: Span, q: ArrayLike, v: ArrayLike, time: float) -> float:
    """Power that the frames have to put in because they turn, at fixed centres and p [W].

    It is -dT/dt + dV/dt + L EA c (deps/dt) deps/dt', the partial rates taken by the turning of the frames alone; with
    it d(T + V)/dt + D = residual.v + frame_power.
    """
    with mp.workdps(DIGITS):
        q, v, time, h = _exact(q), _exact(v), mp.mpf(time), mp.mpf(STEP)

        def turned(s: Any) -> Exact:
            at = _geometry(span, q, time + s)
            return np.array([_elastic(span, at) - _kinetic(span, at, v), at.strain], dtype=object)

        conservative, strain = (turned(h) - turned(-h)) / (2 * h)
        viscous = (q[7] - q[3]) * mp.mpf(span.EA) * mp.mpf(span.damping) * _strain_rate(span, q, v, time)
        return float(conservative + viscous * strain)


def geometry(span: Span, q: ArrayLike, time: float) -> Geometry:
    """Tangent, angles, length of the path and stretch, as floats and arrays of them."""
    with mp.workdps(DIGITS):
        return Geometry(*(np.array(x, dtype=float)[()] for x in _geometry(span, _exact(q), mp.mpf(time))))


def rotation(sheave: Sheave, time: float) -> NDArray[np.float64]:
    """Rotation (3, 3) of the frame of a sheave at a time."""
    with mp.workdps(DIGITS):
        return _rotation(sheave, mp.mpf(time)).astype(float)


def kinetic_energy(span: Span, q: ArrayLike, v: ArrayLike, time: float) -> float:
    """T of the rope between p1 and p2 [J]."""
    with mp.workdps(DIGITS):
        return float(_kinetic(span, _geometry(span, _exact(q), mp.mpf(time)), _exact(v)))


def strain_energy(span: Span, q: ArrayLike, time: float) -> float:
    """L EA eps^2/2 [J]."""
    with mp.workdps(DIGITS):
        return float(_elastic(span, _geometry(span, _exact(q), mp.mpf(time))))


def potential_energy(span: Span, q: ArrayLike) -> float:
    """Potential of the weight, zero at the origin [J]."""
    with mp.workdps(DIGITS):
        return float(_weight(span, _exact(q)))


def strain_rate(span: Span, q: ArrayLike, v: ArrayLike, time: float) -> float:
    """Rate of the strain deps/dt = deps/dlambda dlambda/dt, the turning of the frames included [1/s]."""
    with mp.workdps(DIGITS):
        return float(_strain_rate(span, _exact(q), _exact(v), mp.mpf(time)))


def dissipation(span: Span, q: ArrayLike, v: ArrayLike, time: float) -> float:
    """Power D = L EA c (deps/dt)^2 lost in the rope [W]."""
    with mp.workdps(DIGITS):
        q, v = _exact(q), _exact(v)
        rate = _strain_rate(span, q, v, mp.mpf(time))
        return float((q[7] - q[3]) * mp.mpf(span.EA) * mp.mpf(span.damping) * rate**2)


# data
@dataclass(frozen=True)
class Case:
    """A span in motion: the arguments of `residual`."""

    name: str
    span: Span
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    a: NDArray[np.float64]
    time: float


# name, range of rho1, of rho2, of l [m], greatest fleet angle [deg], angle between the axes about e [deg], damping [s]
KINDS = (
    ("open", (0.2, 1.0), (0.2, 1.0), (3, 30), 5, 0, 0.0),
    ("open, left-handed", (-1.0, -0.2), (-1.0, -0.2), (3, 30), 5, 0, 1e-3),
    ("crossed", (0.2, 1.0), (-1.0, -0.2), (3, 30), 5, 5, 1e-3),
    ("crossed back, axes askew", (-1.0, -0.2), (0.2, 1.0), (3, 30), 5, 90, 0.0),
    ("no fleet angle", (0.2, 1.0), (0.2, 1.0), (3, 30), 0, 0, 1e-3),
    ("drum to point", (0.4, 1.0), (0, 0), (3, 30), 5, 0, 1e-3),
    ("point to sheave", (0, 0), (-1.0, -0.2), (1, 30), 5, 0, 1e-3),
    ("point to point", (0, 0), (0, 0), (1, 30), 5, 0, 1e-3),
    ("shorter than its arcs", (0.8, 1.0), (0.8, 1.0), (1.0, 1.3), 5, 0, 1e-3),
    ("shorter than its arcs, crossed", (-1.0, -0.8), (0.8, 1.0), (1.0, 1.3), 5, 20, 1e-3),
    ("frames at rest", (0.2, 1.0), (-1.0, -0.2), (1, 30), 5, 10, 1e-3),
    ("small sheaves, long", (0.05, 0.2), (0.05, 0.2), (25, 30), 5, 180, 1e-3),
)


def _direction(rng: np.random.Generator, normal_to: Any = None) -> NDArray[np.float64]:
    x = rng.normal(size=3)
    if normal_to is not None:
        x -= normal_to * (normal_to @ x)
    return x / np.linalg.norm(x)


def _turned(x: NDArray[np.float64], axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Vector x turned about a unit axis."""
    return x * np.cos(angle) + np.cross(axis, x) * np.sin(angle) + axis * (axis @ x) * (1 - np.cos(angle))


def _random_sheave(
    rng: np.random.Generator,
    rho: float,
    e: NDArray[np.float64],
    axis: NDArray[np.float64],
    psi: float,
    speed: float,
    time: float,
) -> tuple[Sheave, NDArray[np.float64]]:
    """A sheave that at the time has this axis in space and its mark psi before w, and the vector to the tangent point.

    The frame turns with the angular speed about any direction.
    """
    w = np.cross(e, axis) / np.linalg.norm(np.cross(e, axis))
    start, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    start *= np.linalg.det(start)
    rate = speed * _direction(rng)
    now = rotation(Sheave(rotation=start, rate=rate), time)
    return Sheave(rho, now.T @ axis, now.T @ _turned(w, axis, -psi), start, rate), rho * w


def _random_case(rng: np.random.Generator, kind: tuple[Any, ...]) -> Case:
    name, *radii, lengths, fleet, askew, damping = kind
    rho = [rng.uniform(*radius) for radius in radii]
    length, e, time = rng.uniform(*lengths), _direction(rng), rng.uniform(0, 5)
    level = _direction(rng, e)
    axes = [level, _turned(level, e, np.radians(askew))]
    half_wraps = rng.uniform(1.1, 1.6, 2) if "shorter" in name else rng.uniform(0.3, 1.6, 2)
    # the arcs are on the side of the mark that makes the path longer: psi1 as rho1, psi2 against rho2
    psi = half_wraps * np.sign([rho[0], -rho[1]])
    pairs = []
    for k in (0, 1):
        angle = np.radians(rng.uniform(-fleet, fleet))
        speed = 0.0 if name == "frames at rest" else rng.uniform(0.1, 0.3)
        pairs.append(_random_sheave(rng, rho[k], e, np.cos(angle) * axes[k] + np.sin(angle) * e, psi[k], speed, time))
    (first, x1), (second, x2) = pairs
    path = length + rho[0] * psi[0] - rho[1] * psi[1]
    stretch, stretch_rate = 1 + rng.uniform(0.5e-3, 1.5e-3), 0.02 * rng.normal()
    c1, p1 = rng.uniform(-20, 20, 3), rng.uniform(0, 100)
    q = np.array([*c1, p1, *(c1 + x1 + length * e - x2), p1 + path / stretch])
    v = 2.0 * rng.normal(size=8)
    # p2 follows, so that a rope with both ends in motion stretches no faster than ropes do
    points = [v[k : k + 3] + np.cross(np.asarray(sheave.rate), x) for k, sheave, x in ((0, first, x1), (4, second, x2))]
    v[7] = v[3] + (e @ (points[1] - points[0]) - path / stretch * stretch_rate) / stretch
    span = Span(first, second, EA=8e7, rhoA=6.5, damping=damping)
    return Case(name, span, q, v, 3.0 * rng.normal(size=8), time)


def cases(seed: int) -> list[Case]:
    """A dozen spans of a crane in motion, one of each of `KINDS`.

    Radii to 1 m, spans of 1 to 30 m, fleet angles to 5 degrees, EA 8e7 N, 6.5 kg/m, strains of 0.5 to 1.5 per mille,
    speeds of some m/s, frames that turn at 0.1 to 0.3 rad/s about any direction.
    """
    rng = np.random.default_rng(seed)
    return [_random_case(rng, kind) for kind in KINDS]
