"""Where a hose becomes unstable: eigenvalues about its shape at rest against the speed of flow.

Small motions exp(lambda t) about the static shape: the hose flutters where a complex pair crosses to growth, and
diverges where a real one does. The motion is in the plane of the static shape (of direction and gravity) or out of it.

Over the mass ratio the boundary folds back (R. W. Gregory and M. P. Paidoussis, Proc. R. Soc. A 293, 1966): a hose may
be unstable in a window of speeds, stable once more, and unstable for good much later. Between the speeds at which
eigenvalues are computed such windows are looked for with the hose's motions in few shapes: see
`gardenhose.vibration.reduced`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from gardenhose.estimates import direction_of, fine_up_to, near_onset
from gardenhose.scene import HoseScene
from gardenhose.stability import Critical, Curves, Stability, Way, Window
from gardenhose.static import form
from gardenhose.vibration.linear_hose import MODES, STILL, LinearHose, Plane, growths
from gardenhose.vibration.reduced import Reduced, peaks
from tautline.integrators.status import StoppedEarly
from tautline.integrators.vibration.following import Paths, follow
from tautline.scene.errors import SceneError
from tautline.scene.values.printed import shown
from tautline.scene.values.systems import in_system
from tautline.threads import one_thread

SPEEDS = 48
"""Intervals, about, of a range of speeds that is not told, from zero to half as much again as the critical one."""
PRECISION = 1.0e-10
"""Relative precision of the critical speed."""
BEYOND = 1.0e-3
"""How far past a critical speed the way in which it becomes unstable is looked at, relative to it."""
REAL = 1.0e-6
"""Frequency over the size of the eigenvalue below which a hose diverges and does not flutter."""
TRIALS = 10
"""Speeds up to the estimated critical one at which it is looked for."""
FARTHEST = 4.0
"""Multiple of the estimated critical speed up to which one is looked for."""
SCANNED, MOST_SCANNED = 200, 1500
"""Speeds up to the estimated critical one, and at most, at which windows are looked for with motions in few shapes."""
APART, MOST_BETWEEN = 6, 12
"""Speeds up to the estimated critical one whose shapes do for all between, and how many are added to those given."""
ABOUT = 1.0e-6
"""How near the speed at which growth begins is to where it does in few shapes, relative."""
NEWTON = 1.0e-4
"""Step from there, relative, whose square is no more than that of a speed which is only told."""
BETWEEN = 64
"""Speeds, at most, at which eigenvalues are computed beside those asked for to tell which is which."""
SAME = 1.0e-12
"""Distance of two speeds over the largest one up to which they are one speed that was rounded in two ways."""
ROUND = 8
"""Intervals, at most, between round speeds of a range."""


@one_thread()
def stability(scene: HoseScene, speeds: Sequence[float] | None = None, modes: int = MODES) -> Stability:
    """Eigenvalues over a range of speeds, and where motions begin to grow.

    Parameters
    ----------
    scene : HoseScene
        With water.
    speeds : sequence of float or None
        m/s, in any order; None goes from zero to well beyond the first critical speed.
    modes : int
        Pairs of eigenvalues to follow: the slowest at the slowest speed. What grows at any speed is followed too.

    Without ``speeds`` the flow goes the way that the scene's does (`direction_of`); from tip to root they are negative.

    Raises
    ------
    SceneError
        Without water.
    StoppedEarly
        Where no static shape is found.
    """
    if scene.water is None:
        cure = "add `water: {mass_per_length: ..., speed: ...}`"
        raise SceneError([scene.problem("water", "is missing: nothing can flow", cure)])
    linear = LinearHose(scene, modes)
    grid = np.unique(np.array(speeds, float)) if speeds is not None else _range(linear)
    planes: tuple[Plane, ...] = ("any",) if linear.normal is None else ("in", "out")
    looked_at = _through_rest(grid)
    scans = _scans(linear, looked_at, planes)
    tried = {plane: _with_witnesses(linear, looked_at, plane, scan) for plane, scan in scans.items()}
    if speeds is None:
        grid = looked_at = _with_others(grid, np.concatenate(list(tried.values())))
    curves = _curves(linear, grid, modes)
    asked = np.searchsorted(curves.speed, grid)
    values, shares = curves.eigenvalues[asked], curves.out_of_plane[asked]
    ways = [_way(linear, sign, looked_at, tried, scans) for sign in _signs(looked_at)]
    grows = np.array([_grows(linear, speed, "any") for speed in grid])
    # What is unstable without flow is so whichever way the water goes. Of speeds that are one but for rounding, as of a
    # pipe held at both ends, that from root to tip is first.
    critical = sorted(dict.fromkeys(one for way in ways for one in way.critical), key=_by_speed)
    windows = [one for way in ways for one in way.windows]
    return Stability(
        grid, values, shares, grows, critical, ways[0].stable_from, windows, _apart(scans), curves, ways,
        fine_up_to(linear.scene),
    )  # fmt: skip


def _by_speed(critical: Critical) -> float:
    return float(f"{abs(critical.speed):.8e}")


def _through_rest(speeds: np.ndarray) -> np.ndarray:
    """Rising speeds, and rest among those of both signs.

    What a hose does at a speed one way tells nothing of what it does the other way: both begin at rest.
    """
    return np.union1d(speeds, [0.0]) if speeds[0] < 0.0 < speeds[-1] else speeds


def _signs(speeds: np.ndarray) -> list[float]:
    """The ways, 1 and -1, that water goes at rising speeds."""
    ways = {1.0: speeds[-1] > 0.0 or speeds[0] >= 0.0, -1.0: speeds[0] < 0.0}
    return [sign for sign, goes in ways.items() if goes]


def _way(
    linear: LinearHose,
    sign: float,
    looked_at: np.ndarray,
    tried: dict[Plane, np.ndarray],
    scans: dict[Plane, _Scan | None],
) -> Way:
    """What becomes unstable, and between which speeds it is, as the water goes faster one way."""
    critical, windows = list[Critical](), list[Window]()
    for plane, speeds in tried.items():
        side, scan = speeds[sign * speeds >= 0.0], scans[plane]
        begin = _passages(linear, side, plane, True, scan)
        end = _passages(linear, side, plane, False, scan)
        if begin:
            first = _locate(linear, begin[0].left, begin[0].right, plane, scan)
            begin[0] = begin[0]._replace(speed=first.speed)
            critical.append(first)
        if 0.0 in side and _grows(linear, 0.0, plane):
            critical.append(_kind(linear, 0.0, plane))
        windows += _windows(linear, side, plane, begin, end)
    speed = looked_at[sign * looked_at >= 0.0]
    grows, windows = np.array([_grows(linear, one, "any") for one in speed]), _joined(windows)
    return Way(sign, speed, grows, sorted(critical, key=_by_speed), windows, _stable_from(speed, windows))


@one_thread()
def falls_from(scene: HoseScene, speed: float) -> float:
    """Rate, 1/s, at which a hose leaves its shape at rest at a speed, m/s, for good; 0 where it does not.

    It diverges from it, or would fall from it without flow too. One that only flutters about its shape comes back.

    Raises
    ------
    StoppedEarly
        Where no static shape is found.
    """
    linear = LinearHose(scene)
    motions, _ = linear.at(speed)
    grows = motions.value[growths(motions) > 0.0]
    if grows.size and form(linear.scene, 0.0, linear.known[speed]).negative <= 0:
        grows = grows[grows.imag == 0.0]
    return float(grows.real.max(initial=0.0))


def on_the_start(scene: HoseScene, speed: float) -> list[str]:
    """Sentences on the shape at rest that a run starts from, where the least push moves the hose away for good.

    The water flows at a speed, m/s.

    A hose that flutters about its shape is none of these: that is the motion which a run shows.
    """
    rate = _rate(scene, speed)
    if not rate:
        return []
    flow, time = shown(speed, "m/s", scene.units), shown(1.0 / rate, "s", scene.units)
    return [
        f"the run starts from an unstable equilibrium: at {flow} the hose leaves it for good, and its motion grows e "
        f"times in {time}. What it does then follows from the least push. With start: relaxed it begins in a "
        "shape in which it can stay, if there is one"
    ]


def _rate(scene: HoseScene, speed: float) -> float:
    """Rate, 1/s, at which a hose leaves the shape at rest of t = 0; 0 where it stays, or no shape is found."""
    try:
        return falls_from(scene, speed) if speed else 0.0
    except StoppedEarly:
        return 0.0


class _Scan(NamedTuple):
    """A hose's motions of a plane in few shapes, and the rising speeds (k,), m/s, at which they are looked at."""

    reduced: Reduced
    speed: np.ndarray


def _scans(linear: LinearHose, grid: np.ndarray, planes: Sequence[Plane]) -> dict[Plane, _Scan | None]:
    """What tells where to look between speeds, for each plane; nothing where there is but one speed."""
    if grid.size < 2:
        return dict.fromkeys(planes)
    guess = near_onset(linear.scene)
    nodes = _filled(grid, max(guess / APART, float(grid[-1] - grid[0]) / MOST_BETWEEN))
    step = max(guess / SCANNED, float(grid[-1] - grid[0]) / MOST_SCANNED)
    rows = [linear.at(float(speed)) for speed in nodes]
    forms = [linear.known[float(speed)] for speed in nodes]
    direction, made = np.array(linear.scene.hose.unit_direction), dict[Plane, _Scan | None]()
    for plane in planes:
        motions, share = [one for one, _ in rows], [one for _, one in rows]
        reduced = Reduced(forms, motions, share, linear.normal, direction, plane == "out", STILL)
        made[plane] = _Scan(reduced, _filled(nodes, step))
    return made


def _apart(scans: dict[Plane, _Scan | None]) -> float | None:
    """How far apart the speeds of scans are, m/s."""
    return max((float(np.diff(scan.speed).max()) for scan in scans.values() if scan is not None), default=None)


def _filled(speeds: np.ndarray, gap: float) -> np.ndarray:
    """Rising speeds, and between each two as many more as leave no gap wider than one given."""
    parts = [
        left + (right - left) * np.arange(n) / n
        for left, right in pairwise(speeds)
        for n in [max(1, int(np.ceil((right - left) / gap * (1.0 - 1e-9))))]
    ]
    return np.concatenate([*parts, speeds[-1:]])


def _with_witnesses(linear: LinearHose, grid: np.ndarray, plane: Plane, scan: _Scan | None) -> np.ndarray:
    """Speeds, and among them one of each window of growth, and of decay, that lies between them."""
    if scan is None:
        return grid
    values = scan.reduced.at(scan.speed)
    found = peaks(scan.reduced, scan.speed, values)
    speed = np.concatenate([scan.speed, [one.speed for one in found]])
    growth = np.concatenate([scan.reduced.growths(values), [one.growth for one in found]])
    order = np.argsort(speed, kind="stable")
    speed, growth = speed[order], growth[order]
    grows = growth > 0.0
    known = np.array([_grows(linear, one, plane) for one in grid])
    more = []
    for run in np.split(np.arange(speed.size), np.flatnonzero(np.diff(grows)) + 1):
        inside = (grid >= speed[run[0]]) & (grid <= speed[run[-1]])
        if not (known[inside] == grows[run[0]]).any():
            farthest = np.argmax(growth[run]) if grows[run[0]] else np.argmin(growth[run])
            more.append(float(speed[run[farthest]]))
    # What nearly grows in few shapes may grow.
    more += [one.speed for one in found if one.growth <= 0.0]
    return np.unique(np.concatenate([grid, more]))


def _windows(
    linear: LinearHose, speeds: np.ndarray, plane: Plane, begin: list[_Passage], end: list[_Passage]
) -> list[Window]:
    """Between which speeds of one way motions of a plane grow, by where they begin to and cease to."""
    slowest = float(min(speeds, key=abs))
    begins = [*([slowest] if _grows(linear, slowest, plane) else []), *(one.speed for one in begin)]
    return [Window(*pair) for pair in zip(begins, [*(one.speed for one in end), None], strict=False)]


def _joined(windows: Iterable[Window]) -> list[Window]:
    """Windows of several planes as those of the hose, of one way of flow, the slowest first."""
    made: list[Window] = []
    for one in sorted(windows, key=lambda window: abs(window.begin)):
        last = next((k for k, other in enumerate(made) if _meet(other, one)), None)
        if last is None:
            made.append(one)
        else:
            ends = [made[last].end, one.end]
            known = [end for end in ends if end is not None]
            made[last] = Window(made[last].begin, max(known, key=abs) if len(known) == len(ends) else None)
    return made


def _meet(slower: Window, faster: Window) -> bool:
    """Whether a window begins within one that begins no later."""
    return slower.end is None or abs(faster.begin) <= abs(slower.end)


def _stable_from(speeds: np.ndarray, windows: Sequence[Window]) -> float | None:
    """Speed of one way from which nothing grows that does at the slowest one."""
    slowest = float(min(speeds, key=abs))
    return next((one.end for one in windows if one.begin == slowest), None)


@one_thread()
def crossings(scene: HoseScene, speeds: Sequence[float], plane: Plane = "any", ceasing: bool = False) -> list[Critical]:
    """Every speed in a range at which motions of a plane begin to grow, or cease to, as the water goes faster.

    Parameters
    ----------
    scene : HoseScene
    speeds : sequence of float
        Speeds of the water that are tried, m/s, in order; a passage is sought between each two neighbours.
    plane : str
        Plane of the motion: ``in``, ``out`` or ``any``.
    ceasing : bool
        Whether to find the speeds at which the last motion that grows ceases to, and not those at which the first
        begins to. A cantilever's boundary is S-shaped over the mass ratio (R. W. Gregory and M. P. Paidoussis,
        Proc. R. Soc. A 293, 1966): between two onsets it is stable once more.

    Returns
    -------
    list of Critical
        The slowest first.
    """
    return _crossings(LinearHose(scene), np.array(speeds, float), plane, ceasing)


def _range(linear: LinearHose) -> np.ndarray:
    """Speeds from zero to half as much again as the first critical one, those that were tried among them, rising.

    A hose that falls without flow may be held up by more of it: the first critical speed is beyond that.
    """
    guess = direction_of(linear.scene) * near_onset(linear.scene)
    tried, stood = 0, not _grows(linear, 0.0, "any")
    while tried < TRIALS * FARTHEST:
        tried += 1
        grows = _grows(linear, guess * tried / TRIALS, "any")
        if grows and stood:
            break
        stood = stood or not grows
    finer = max(1, round(SPEEDS / (1.5 * tried)))
    count = int(np.ceil(1.5 * tried * finer))
    # A speed that was tried is found again to the bit: whole numbers are divided last.
    found = np.array([guess * (i / finer) / TRIALS + 0.0 for i in range(count + 1)])
    # The round ones, which are written along the curves, stand for those between that they are next to.
    for one in _round_between(float(found.min()), float(found.max()), linear.scene.units):
        nearest = int(np.abs(found - one).argmin())
        found[nearest] = one if nearest % finer and nearest != count else found[nearest]
    return np.sort(found)


def _crossings(linear: LinearHose, grid: np.ndarray, plane: Plane, ceasing: bool = False) -> list[Critical]:
    """Where motions begin to grow, or cease to, as the water goes faster, to either side, the slowest first."""
    found = [_locate(linear, *pair, plane) for pair in _passed(linear, grid, plane, not ceasing)]
    return sorted(found, key=lambda one: abs(one.speed))


def _passed(linear: LinearHose, grid: np.ndarray, plane: Plane, begins: bool) -> list[tuple[float, float]]:
    """Neighbours among speeds between which motions begin to grow as the water goes faster, or cease to."""
    grows = [_grows(linear, speed, plane) for speed in grid]
    return [
        (float(left), float(right))
        for (left, right), (before, after) in zip(pairwise(grid), pairwise(grows), strict=True)
        if before != after and begins == (after == (abs(right) > abs(left)))
    ]


class _Passage(NamedTuple):
    """Two speeds between which motions begin to grow or cease to, and that at which they do, m/s."""

    left: float
    right: float
    speed: float


def _passages(linear: LinearHose, grid: np.ndarray, plane: Plane, begins: bool, scan: _Scan | None) -> list[_Passage]:
    """Where motions begin to grow or cease to by one step of Newton's from where they do in few shapes."""
    pairs = _passed(linear, grid, plane, begins)
    found = [_Passage(*pair, _stepped(linear, *pair, plane, scan)) for pair in pairs]
    return sorted(found, key=lambda one: abs(one.speed))


def _stepped(linear: LinearHose, left: float, right: float, plane: Plane, scan: _Scan | None) -> float:
    size = max(abs(left), abs(right))
    if scan is not None and scan.reduced.growth(left) * scan.reduced.growth(right) < 0.0:
        near = _near(scan, left, right)
        far = ABOUT * size
        slope = (scan.reduced.growth(near + far) - scan.reduced.growth(near - far)) / (2.0 * far)
        step = linear.growth(near, plane)[0] / slope if slope else np.inf
        if abs(step) < NEWTON * size and left < near - step < right:
            return near - step
    return _locate(linear, left, right, plane, scan).speed


def _near(scan: _Scan, left: float, right: float) -> float:
    """Where growth begins or ceases in few shapes."""
    size = max(abs(left), abs(right))
    return float(brentq(scan.reduced.growth, left, right, xtol=PRECISION * size, rtol=1e-12))


def _grows(linear: LinearHose, speed: float, plane: Plane) -> bool:
    return linear.growth(float(speed), plane)[0] > 0.0


def _locate(linear: LinearHose, left: float, right: float, plane: Plane, scan: _Scan | None = None) -> Critical:
    """Critical speed between one at which nothing grows and one at which something does."""
    size = max(abs(left), abs(right))
    left, right = _narrowed(linear, left, right, plane, scan)
    speed = float(brentq(lambda u: linear.growth(u, plane)[0], left, right, xtol=PRECISION * size, rtol=1e-12))
    return _kind(linear, speed, plane)


def _narrowed(linear: LinearHose, left: float, right: float, plane: Plane, scan: _Scan | None) -> tuple[float, float]:
    """The speeds to either side of where growth begins or ceases in few shapes, if it does so between them."""
    if scan is None or scan.reduced.growth(left) * scan.reduced.growth(right) > 0.0:
        return left, right
    size = max(abs(left), abs(right))
    near = _near(scan, left, right)
    grows = _grows(linear, left, plane)
    for speed in (near - ABOUT * size, near + ABOUT * size):
        if left < speed < right:
            left, right = (speed, right) if _grows(linear, speed, plane) == grows else (left, speed)
    return left, right


def _kind(linear: LinearHose, speed: float, plane: Plane) -> Critical:
    """In which way a hose becomes unstable at a speed, or is where nothing flows."""
    # The speed that a search ends with is one at which it has solved.
    _, value = linear.growth(speed, plane)
    # Where a pair meets at zero rounding has a say in what it looks like: the eigenvalue past it says which it is.
    _, past = linear.growth(speed * (1.0 + BEYOND), plane)
    diverges = abs(past.imag) <= REAL * abs(past)
    return Critical(
        speed, 0.0 if diverges else value.imag / (2.0 * np.pi), plane, "divergence" if diverges else "flutter"
    )


def _curves(linear: LinearHose, grid: np.ndarray, modes: int) -> Curves:
    """Modes followed from the slowest flow on, where they are told apart, over speeds that are near enough for it."""
    marks = _round_between(float(grid[0]), float(grid[-1]), linear.scene.units)
    # What has been computed already costs nothing.
    inside = [speed for speed in linear.solved if grid[0] <= speed <= grid[-1]]
    speeds = _with_others(grid, np.array([*inside, *marks]))
    backwards = abs(grid[0]) > abs(grid[-1])
    paths = follow(
        lambda speed: linear.at(float(speed))[0],
        (speeds[::-1] if backwards else speeds).tolist(),
        modes,
        linear.unlike,
        lambda motions: growths(motions) > 0.0,
        BETWEEN,
    )
    if backwards:
        paths = Paths(*(part[::-1] for part in paths))
    rows = [linear.at(float(speed)) for speed in paths.place]
    values = np.full(paths.number.shape, complex(np.nan, np.nan))
    shares = np.zeros(paths.number.shape)
    for (motions, share), those, value, part in zip(rows, paths.number, values, shares, strict=True):
        value[those >= 0], part[those >= 0] = motions.value[those[those >= 0]], share[those[those >= 0]]
    return Curves(paths.place, values, shares, paths.sure, marks)


def _with_others(asked: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Rising speeds: those asked for, and of others each that is not one of these, or of the others, but for rounding.

    The speed that is asked for as 5.6000000000000005 m/s and the mark at 5.6 are one.
    """
    made = asked
    for speed in np.setdiff1d(others, asked):
        if np.abs(made - speed).min() > SAME * max(abs(asked[0]), abs(asked[-1])):
            made = np.append(made, speed)
    return np.sort(made)


def _round_between(low: float, high: float, system: str) -> list[float]:
    """Speeds of a range, m/s, that are few digits in the units of a system."""
    factor, _ = in_system(1.0, "m/s", system)
    low, high = factor * low, factor * high
    if high == low:
        return []
    power = 10.0 ** np.floor(np.log10((high - low) / ROUND))
    step = next(size * power for size in (1.0, 2.0, 5.0, 10.0) if (high - low) / (size * power) <= ROUND)
    numbers = step * np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1.0)
    return [float(np.clip(number, low, high)) / factor + 0.0 for number in numbers]
