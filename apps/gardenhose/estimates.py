"""Rough estimates of a hose: where it loses its stability, how fast it swings, which step of RK4 is stable.

Onset and frequency are those of a uniform pipe without gravity or damping; a hose of several sections is averaged. A
mass and a nozzle at the tip count. They are good enough to choose a step and a mesh; `gardenhose flutter` computes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from gardenhose.scene import HoseScene, Segment
from tautline.integrators.vibration.critical_step import critical_step
from tautline.kernels.hermite import FIRST, SECOND, SHAPE, WEIGHT, gauss, lobatto, table
from tautline.kernels.time_function import TimeFunctions, sample
from tautline.system.time_functions import FunctionRequest, compile_functions

RADIANS_PER_ELEMENT = 2.0
"""Phase u L_e / L of the flow's bending waves over an element, beyond which frequency and growth of flutter err by
half a per cent or more (cubic elements against four times as many, beta 0.2 to 0.8, u to 17)."""
ONSET = np.array(
    [
        (0.001, 4.195, 14.63), (0.05, 4.445, 14.44), (0.1, 4.750, 14.22), (0.15, 5.123, 13.96), (0.2, 5.591, 13.71),
        (0.25, 6.214, 13.61), (0.28, 6.757, 13.93), (0.29, 7.036, 14.35), (0.296, 7.332, 15.06), (0.297, 7.452, 15.46),
        (0.298, 8.245, 21.53), (0.3, 8.270, 21.89), (0.31, 8.352, 23.05), (0.35, 8.548, 25.07), (0.4, 8.778, 26.07),
        (0.45, 9.035, 26.44), (0.5, 9.322, 26.50), (0.55, 9.640, 26.40), (0.6, 9.991, 26.30), (0.65, 10.405, 26.42),
        (0.68, 10.748, 26.92), (0.69, 10.930, 27.42), (0.695, 11.118, 28.15), (0.696, 12.738, 43.47),
        (0.7, 12.769, 43.60), (0.75, 13.135, 44.53), (0.8, 13.493, 44.83), (0.85, 13.870, 45.00), (0.9, 14.331, 45.61),
        (0.915, 14.539, 46.23), (0.924, 14.786, 47.36), (0.925, 17.389, 71.63), (0.95, 17.670, 72.27),
    ]
)  # fmt: skip
"""Onset of a cantilever's flutter: beta = M / (m + M), u = L U sqrt(M / EJ), omega L^2 sqrt((m + M) / EJ).

The problem is that of Gregory and Paidoussis (1966), y'''' + u^2 y'' + 2 sqrt(beta) u y'. + y.. = 0, clamped and free.
The numbers are ours: a Galerkin solution with the first 30 modes of the cantilever at rest, they in turn from 40
Hermite elements; the lowest u at which an eigenvalue crosses into the right half-plane, by bisection. Half as many
modes and elements move it by less than 0.2 %. Where the boundary folds back (beta near 0.30, 0.69 and 0.92) it is
the lowest branch, so the table jumps.
"""

SUPPORTS = {
    ("clamped", "free"): (3.51602, 1 / 8, None),
    ("pinned", "pinned"): (9.86960, 5 / 384, math.pi),
    ("clamped", "pinned"): (15.41821, 0.0054161, 4.49341),
    ("pinned", "clamped"): (15.41821, 0.0054161, 4.49341),
    ("clamped", "clamped"): (22.37329, 1 / 384, 2 * math.pi),
}
"""Beams by their supports: first natural frequency and largest sag under a uniform load, over sqrt(EJ / m L^4) and
w L^4 / EJ; and the u of divergence, that of Euler's column under the thrust M U^2, where both ends are held."""

POLYNOMIALS = 12
"""Of the Galerkin solution of a cantilever with a mass or a nozzle at its tip."""
HIGHEST, STRIDE = 20.0, 0.5
"""Largest u at which that solution looks for flutter, and from one u to the next."""
HEAVIEST = 10.0
"""Mass at the tip over that of hose and water above which the onset is not estimated: the tip hardly moves, growth is
so slow that the least damping stops it, and the estimate without damping is per cents too low."""
GROWING = 1.0e-8
"""Growth rate over the size of the eigenvalue that is no rounding."""

SAMPLES = 4001
FASTEST = 1.0e60
"""Speed, m/s, that stands for all above it, whose square could not be computed with."""
FINE = 0.05
"""Time between samples over that within which a change of the flow is looked for, at most."""
FOLLOWED, LONGEST = 32, 6000
"""Stretches of the run that are followed in such steps, and of how many steps at most."""
ENOUGH_ELEMENTS = 12
"""Elements of a piece from which more of them do not change its highest frequency."""


@dataclass(frozen=True)
class Average:
    """The hose as if it were of one section, and its flow at the largest speed of the run.

    Attributes
    ----------
    length, mass, water : float
        m; kg/m of hose and water.
    bending : float
        EJ, N m^2: the harmonic mean.
    thrust : float
        Momentum M U^2 of the water, N.
    """

    length: float
    mass: float
    water: float
    bending: float
    thrust: float

    @property
    def mass_ratio(self) -> float:
        """M / (m + M)."""
        return self.water / (self.mass + self.water)

    @property
    def dimensionless_speed(self) -> float | None:
        """u = L U sqrt(M / EJ); None without bending stiffness."""
        return self.length * math.sqrt(self.thrust / self.bending) if self.bending > 0.0 else None

    @property
    def time_scale(self) -> float:
        """Time by which frequencies are made dimensionless, s; inf without bending stiffness."""
        if self.bending == 0.0:
            return math.inf
        return self.length**2 * math.sqrt((self.mass + self.water) / self.bending)


def speeds(scene: HoseScene, count: int = SAMPLES) -> np.ndarray:
    """Speed of the water in the first segment at so many times through the run, and where its function breaks, m/s."""
    return _flow(scene, count, 1)


def rates(scene: HoseScene) -> np.ndarray:
    """Rates of that speed at as many times, m/s^2."""
    return _flow(scene, SAMPLES, 2)


def _flow(scene: HoseScene, count: int, order: int) -> np.ndarray:
    if scene.water is None:
        return np.zeros(1)
    functions, end = _compiled(scene), scene.solver.end
    breaks = _breaks(functions, end)
    # The speed goes on there, and its rate may leap.
    before = np.nextafter(breaks, 0.0) if order > 1 else breaks
    return _flow_at(functions, np.unique(np.concatenate((np.linspace(0.0, end, count), breaks, before))), order)


def _compiled(scene: HoseScene) -> TimeFunctions:
    """The function of the water's speed. As in the run a table is made of straight lines: its rate is integrated."""
    assert scene.water is not None
    request = FunctionRequest(scene.water.speed, integrate=True, end=scene.solver.end, key="water.speed")
    return compile_functions([request])


def _flow_at(functions: TimeFunctions, times: np.ndarray, order: int) -> np.ndarray:
    return np.clip(np.nan_to_num(sample(functions, 0, times)[:, order]), -FASTEST, FASTEST)


def _breaks(functions: TimeFunctions, end: float) -> np.ndarray:
    """Where the function goes over from one curve to another within the run."""
    return functions.breaks[(functions.breaks > 0.0) & (functions.breaks <= end)]


def transit(scene: HoseScene) -> float:
    """Time that a wave of stretch takes along hose and water, s; waves of pressure are not in the model."""
    return sum(
        piece.length * math.sqrt((piece.mass_per_length + (piece.water_mass_per_length or 0.0)) / piece.axial_stiffness)
        for piece in scene.hose.pieces
    )


def largest_change(scene: HoseScene, within: float) -> float:
    """By how much the speed of the flow in the first segment changes within so many seconds at most, m/s.

    Straight lines change the most from a break, or up to one. Curves and waves are followed in short steps where they
    change the most, and in stretches spread over the run: what swings faster than the samples shows nothing in them.
    """
    end = scene.solver.end
    if scene.water is None or not 0.0 < within < end:
        return 0.0
    functions = _compiled(scene)
    breaks = _breaks(functions, end)
    coarse = np.union1d(np.linspace(0.0, end, SAMPLES), breaks)
    step, apart = FINE * within, np.diff(coarse)
    steepness = np.abs(np.diff(_flow_at(functions, coarse, 1))) / np.maximum(apart, within)
    spread = np.linspace(0, apart.size - 1, FOLLOWED).astype(int)
    steps = np.ceil((apart + within) / step)
    fine = [coarse, breaks - within, breaks + within]
    for k in [*steepness.argsort()[::-1][:FOLLOWED].tolist(), *(spread.tolist() if functions.waves.size else ())]:
        fine.append(coarse[k] + step * np.arange(min(int(steps[k]), LONGEST)))
    times = np.unique(np.clip(np.concatenate(fine), 0.0, end))
    return _largest_range(times, _flow_at(functions, times, 1), within)


def _largest_range(times: np.ndarray, values: np.ndarray, within: float) -> float:
    """Largest difference of two values that are so many seconds apart at most."""
    # A little more, as sums of times are rounded.
    last = np.searchsorted(times, times + within * (1.0 + 1e-9), side="right")
    count, found = last - np.arange(times.size), 0.0
    high = low = values
    # Ranges of 1, 2, 4, ... values; two of them cover any number.
    for level in range(int(count.max()).bit_length()):
        length = 2**level
        k = np.flatnonzero((count >= length) & (count < 2 * length))
        other = last[k] - length
        ranges = np.maximum(high[k], high[other]) - np.minimum(low[k], low[other])
        found = max(found, float(ranges.max(initial=0.0)))
        high, low = np.maximum(high[:-length], high[length:]), np.minimum(low[:-length], low[length:])
    return found


def direction_of(scene: HoseScene) -> float:
    """1 where the scene's flow is fastest from root to tip, or nothing flows, -1 from tip to root."""
    sampled = speeds(scene)
    return -1.0 if sampled[np.argmax(np.abs(sampled))] < 0.0 else 1.0


def thrust(scene: HoseScene, piece: Segment, speed: float) -> float:
    """Momentum M U^2 in a piece, N, at a speed in the first: M U is the same in all."""
    first = scene.hose.pieces[0].water_mass_per_length
    if first is None or piece.water_mass_per_length is None:
        return 0.0
    return (first * speed) ** 2 / piece.water_mass_per_length


def pushes(scene: HoseScene, speed: float) -> list[float]:
    """Push on each piece of a straight hose with a free end, N, over |r'|, at a speed in the first.

    Water that gets faster at the nozzle, or where the bore narrows, pushes back with what its momentum grows by; what
    stands between that and the root bears it. Negative is a pull, of a bore that widens. Zero where the end is held:
    that bears the nozzle.
    """
    pieces = scene.hose.pieces
    if scene.water is None or scene.hose.end != "free":
        return [0.0] * len(pieces)
    momentum = [thrust(scene, piece, speed) for piece in pieces]
    gained = [after - here for here, after in pairwise([*momentum, momentum[-1] * scene.water.outlet])]
    return [sum(gained[k:]) for k in range(len(pieces))]


def radians(scene: HoseScene, piece: Segment, speed: float) -> float:
    """Phase over a piece of the waves in which the flow bends it at a speed in the first; its EJ is not zero."""
    return math.sqrt(thrust(scene, piece, speed) / piece.bending_stiffness) * piece.length


def fine_up_to(scene: HoseScene) -> float:
    """Speed, m/s, up to which elements are short enough for the waves in which the flow bends the hose.

    Infinite where nothing flows, and where a piece without bending stiffness has waves as short as its elements allow.
    """
    pieces = scene.hose.pieces
    if any(piece.bending_stiffness == 0.0 for piece in pieces):
        return math.inf
    coarsest = max(radians(scene, piece, 1.0) / piece.elements for piece in pieces)
    return RADIANS_PER_ELEMENT / coarsest if coarsest > 0.0 else math.inf


def average(scene: HoseScene, speed: float) -> Average:
    """Average the hose over its length, at a speed (m/s) of the water in its first segment."""
    pieces, length = scene.hose.pieces, scene.hose.total_length

    def mean(of: Callable[[Segment], float]) -> float:
        return sum(of(piece) * (piece.length / length) for piece in pieces)

    soft = any(piece.bending_stiffness == 0.0 for piece in pieces)
    return Average(
        length=length,
        mass=mean(lambda piece: piece.mass_per_length),
        water=mean(lambda piece: piece.water_mass_per_length or 0.0),
        bending=0.0 if soft else 1.0 / mean(lambda piece: 1.0 / piece.bending_stiffness),
        thrust=mean(lambda piece: thrust(scene, piece, speed)),
    )


@lru_cache(maxsize=1)
def _shapes() -> tuple[np.ndarray, ...]:
    """Products of x^2 P_k(2 x - 1) over a cantilever of length one: mass, stiffness, slope, curvature; the tip."""
    x, weight = np.polynomial.legendre.leggauss(POLYNOMIALS + 4)
    x, weight = 0.5 * (x + 1.0), 0.5 * weight
    line, square = np.polynomial.Polynomial([-1.0, 2.0]), np.polynomial.Polynomial([0.0, 0.0, 1.0])
    made = []
    for k in range(POLYNOMIALS):
        legendre = np.polynomial.legendre.leg2poly([0.0] * k + [math.sqrt(2.0 * k + 1.0)])
        shape = square * np.polynomial.Polynomial(legendre)(line)
        made.append([shape(x), shape.deriv(1)(x), shape.deriv(2)(x), np.full(1, shape(1.0))])
    value, slope, curvature, tip = (np.array(one) for one in zip(*made, strict=True))
    weighted = value * weight
    return weighted @ value.T, (curvature * weight) @ curvature.T, weighted @ slope.T, weighted @ curvature.T, tip[:, 0]


def _cantilever(heavy: float) -> tuple[np.ndarray, ...]:
    """Stiffness, slope and curvature of a cantilever in shapes of mass one; `heavy` is its tip's over its own."""
    mass, *others, tip = _shapes()
    root = np.linalg.inv(np.linalg.cholesky(mass + heavy * np.outer(tip, tip)))
    return tuple(root @ one @ root.T for one in others)


@lru_cache(maxsize=8)
def onset_of_a_cantilever(beta: float, heavy: float = 0.0, outlet: float = 1.0) -> tuple[float | None, float | None]:
    """Lowest u of flutter and omega L^2 sqrt((m + M) / EJ) there; None without flutter up to u = 20.

    Galerkin's solution of y'''' + outlet u^2 y'' + 2 sqrt(beta) u y'. + y.. = 0, clamped and free: the jet of a nozzle
    takes M U times its own speed with it, so that its reaction, which follows the tip, adds M U^2 (outlet - 1) to
    M U^2 (Gregory and Paidoussis, 1966; Paidoussis, Fluid-Structure Interactions 1, chapter 3).

    Parameters
    ----------
    beta : float
        M / (m + M).
    heavy : float
        Mass at the tip over that of hose and water.
    outlet : float
        Speed of the jet over that in the hose.
    """
    if not heavy <= HEAVIEST or not outlet <= FASTEST:
        return None, None
    stiffness, slope, curvature = _cantilever(heavy)
    n = len(stiffness)
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, n:] = np.eye(n)

    def fastest(u: float) -> complex:
        """The eigenvalue that grows most for its size."""
        matrix[n:, :n] = -stiffness - outlet * u * u * curvature
        matrix[n:, n:] = -2.0 * math.sqrt(beta) * u * slope
        values = np.linalg.eigvals(matrix)
        return complex(values[np.argmax(values.real / np.abs(values))])

    def grows(u: float) -> bool:
        value = fastest(u)
        return value.real > GROWING * abs(value)

    # A nozzle brings the onset nearer to no speed: the strides are of the thrust's root.
    stride = STRIDE / max(1.0, math.sqrt(outlet))
    for count in range(1, round(HIGHEST / STRIDE) + 1):
        if grows(count * stride):
            below, above = (count - 1) * stride, count * stride
            break
    else:
        return None, None
    while above - below > 1e-4 * above:
        middle = 0.5 * (below + above)
        below, above = (below, middle) if grows(middle) else (middle, above)
    return above, abs(fastest(above).imag)


def onset(scene: HoseScene, hose: Average) -> tuple[float | None, float | None]:
    """Estimate u and frequency (Hz) at which the hose loses its stability, as `plain_onset`; mass and nozzle count.

    None, too, where mass and nozzle leave no flutter up to u = 20, and with a mass above `HEAVIEST`.
    """
    plain = plain_onset(scene, hose)
    outlet = scene.water.outlet if scene.water is not None else 1.0
    heavy = tip_share(scene, hose)
    if plain[1] in (None, 0.0) or (heavy == 0.0 and outlet == 1.0):
        return plain
    u, omega = onset_of_a_cantilever(hose.mass_ratio, heavy, outlet)
    return u, None if omega is None else omega / (2.0 * math.pi * hose.time_scale)


def tip_share(scene: HoseScene, hose: Average) -> float:
    """Mass at a free tip over that of hose and water."""
    return scene.hose.tip_mass / ((hose.mass + hose.water) * hose.length) if scene.hose.end == "free" else 0.0


def plain_onset(scene: HoseScene, hose: Average) -> tuple[float | None, float | None]:
    """Estimate u and frequency (Hz) at which the hose loses its stability: flutter, or divergence (0 Hz) if held.

    Nothing at the tip counts. None where there is no estimate: without water or bending stiffness, and for a hose that
    swings about its root.
    """
    support = SUPPORTS.get((scene.hose.root_support, scene.hose.end))
    if support is None or hose.water == 0.0 or hose.bending == 0.0:
        return None, None
    if support[2] is not None:
        return support[2], 0.0
    beta = hose.mass_ratio
    omega = float(np.interp(beta, ONSET[:, 0], ONSET[:, 2]))
    return float(np.interp(beta, ONSET[:, 0], ONSET[:, 1])), omega / (2.0 * math.pi * hose.time_scale)


def near_onset(scene: HoseScene) -> float:
    """A speed near the critical one, m/s: that of straight uniform hoses, else from thrust and stiffness.

    A nozzle counts: one that is narrow makes a jet of which a thousandth of the speed is enough.
    """
    hose = average(scene, 1.0)
    u = onset(scene, hose)[0] or plain_onset(scene, hose)[0]
    if u is not None and hose.dimensionless_speed:
        return u / hose.dimensionless_speed
    pull = (hose.mass + hose.water) * float(np.linalg.norm(scene.gravity)) * hose.length
    stiff = min(piece.axial_stiffness for piece in scene.hose.pieces)
    return float(np.sqrt((pull or 0.1 * stiff) / hose.thrust))


def first_frequency(scene: HoseScene, hose: Average) -> float | None:
    """First natural frequency at rest, Hz, without gravity; None for a hose that swings or cannot bend back.

    The mass at the tip counts; one that is much heavier than the hose hangs on a spring 3 EJ / L^3.
    """
    support = SUPPORTS.get((scene.hose.root_support, scene.hose.end))
    if support is None or hose.bending == 0.0:
        return None
    omega, heavy = support[0], tip_share(scene, hose)
    if heavy > HEAVIEST:
        omega = math.sqrt(3.0 / (heavy + 33.0 / 140.0))  # Rayleigh's mass of the beam
    elif heavy > 0.0:
        omega = math.sqrt(np.linalg.eigvalsh(_cantilever(heavy)[0])[0])
    return omega / (2.0 * math.pi * hose.time_scale)


def _unit_matrix(first: int, points: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Matrix (4, 4) of a cubic element of length one from the functions or derivatives that begin at a column."""
    rows = table(*points)
    part = rows[:, first : first + 4]
    return np.einsum("p,pi,pj", rows[:, WEIGHT], part, part)


def _stiffness_matrix(piece: Segment, order: int) -> np.ndarray:
    """Of N' N' or N'' N'', at the points that the elements have: with bending the axial ones are Lobatto's."""
    if order == 2:
        return _unit_matrix(SECOND, gauss(3))
    return _unit_matrix(FIRST, lobatto() if piece.bending_stiffness > 0.0 else gauss(3))


def _largest(scene: HoseScene, stiffness: Callable[[Segment], float], order: int, held: tuple[int, int]) -> float:
    """Largest eigenvalue of stiffness against mass of the straight hose, 1/s^2 (1/s for a damping).

    The fastest motion sits in the piece with the fastest element; its neighbours count, the rest of the hose does not.

    Parameters
    ----------
    stiffness : callable
        EA or EJ of a piece, or that times its damping.
    order : int
        Derivative that it resists: 1 axial, 2 bending.
    held : tuple of int
        How many of (r, r') are held at root and tip.
    """
    pieces = scene.hose.pieces
    mass = _unit_matrix(SHAPE, gauss(4))

    def density(piece: Segment) -> float:
        return piece.mass_per_length + (piece.water_mass_per_length or 0.0)

    def rate(piece: Segment) -> float:
        return stiffness(piece) / density(piece) / (piece.length / piece.elements) ** (2 * order)

    fastest = max(range(len(pieces)), key=lambda i: rate(pieces[i]))
    if not 0.0 < rate(pieces[fastest]) < math.inf:
        return rate(pieces[fastest])
    first, last = max(0, fastest - 1), min(len(pieces), fastest + 2)
    parts = [piece for piece in pieces[first:last] for _ in range(min(piece.elements, ENOUGH_ELEMENTS))]
    k, m = np.zeros((2, 2 * len(parts) + 2, 2 * len(parts) + 2))
    for i, piece in enumerate(parts):
        h, at = piece.length / piece.elements, slice(2 * i, 2 * i + 4)
        scale = np.outer(*[np.array([1.0, h, 1.0, h])] * 2)
        k[at, at] += stiffness(piece) * _stiffness_matrix(piece, order) * scale / h ** (2 * order - 1)
        m[at, at] += density(piece) * mass * scale * h
    if last == len(pieces):
        m[-2, -2] += scene.hose.tip_mass
    free = np.arange(held[0] if first == 0 else 0, len(k))
    if last == len(pieces):
        free = free[free < len(k) - 2] if held[1] == 2 else free[free != len(k) - 2] if held[1] else free
    if free.size == 0:
        return 0.0
    k, m = k[np.ix_(free, free)], m[np.ix_(free, free)]
    if not (np.isfinite(k).all() and np.isfinite(m).all()):
        return math.nan
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            # M = L L^T leaves the eigenvalues of L^-1 K L^-T. SciPy solves the pair, and takes 0.2 s to import.
            root = np.linalg.inv(np.linalg.cholesky(m))
            return float(np.linalg.eigvalsh(root @ k @ root.T)[-1])
    except np.linalg.LinAlgError:  # numbers of no hose, whose matrices lose their rank
        return math.nan


@dataclass(frozen=True)
class Limit:
    """RK4's critical step, s, as it is and as it were without damping; what moves, and its damping ratio."""

    step: float
    undamped: float
    motion: str
    damping: float


def rk4_limit(scene: HoseScene) -> Limit:
    """Critical step of RK4 by the fastest axial and bending motion of hose and water together, about straight.

    An element's highest frequency is the 2 S / L_eff of eq. 2.151, here of the mesh with its ends as they are held.
    Damping that grows with stiffness makes that motion decay at c omega^2 where c omega / 2 > 1, which is what then
    sets the step: 2.785 / (c omega^2), shorter than 2.8 / omega.
    """
    hose = scene.hose
    clamped = hose.root_support == "clamped", hose.end == "clamped"
    held = 1, 0 if hose.end == "free" else 1
    slope = hose.clamp == "slope"
    along = tuple(h + (c and slope) for h, c in zip(held, clamped, strict=True))
    across = tuple(h + c for h, c in zip(held, clamped, strict=True))
    limits = []
    for motion, order, ends in (("axial", 1, along), ("bending", 2, across)):

        def stiffness(piece: Segment, order: int = order) -> float:
            return piece.axial_stiffness if order == 1 else piece.bending_stiffness

        square = _largest(scene, stiffness, order, ends)
        decay = _largest(scene, lambda piece, of=stiffness: of(piece) * piece.damping, order, ends)
        ratio = 0.5 * decay / math.sqrt(square) if square > 0.0 else 0.0
        limits.append(Limit(critical_step(square, decay), critical_step(square, 0.0), motion, ratio))
    known = [limit for limit in limits if not math.isnan(limit.step)]
    return min(known, key=lambda limit: limit.step) if known else Limit(math.inf, math.inf, "", 0.0)
