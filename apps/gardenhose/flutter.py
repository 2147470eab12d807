"""Where a hose becomes unstable: eigenvalues about its shape at rest against the speed of flow.

Small motions exp(lambda t) about the static shape: the hose flutters where a complex pair crosses to growth, and
diverges where a real one does. The motion is in the plane of the static shape (of direction and gravity) or out of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq, linear_sum_assignment

from gardenhose.estimates import average, onset
from gardenhose.estimates import speeds as speeds_of
from gardenhose.scene import HoseScene
from gardenhose.static import Form, form
from tautline.integrators.vibration.vibrations import DENSE, Vibrations, vibrations
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.threads import one_thread

MODES = 8
"""Pairs of eigenvalues that are followed."""
DOFS, SLOWEST = 6, 60
"""Unknowns of an element, and how many motions are sought of a hose that has too many for all."""
SPEEDS = 48
"""Intervals, about, of a range of speeds that is not told, from zero to half as much again as the critical one."""
PRECISION = 1.0e-10
"""Relative precision of the critical speed."""
STILL, ROUNDING = 1.0e-7, 10.0
"""Growth over the size of the eigenvalue, and over what it may be off by rounding, that is none."""
BEYOND = 1.0e-3
"""How far past a critical speed the way in which it becomes unstable is looked at, relative to it."""
REAL = 1.0e-6
"""Frequency over the size of the eigenvalue below which a hose diverges and does not flutter."""
ALIKE = 1.0e-6
"""Relative difference of the eigenvalues of two planes in which a straight hose moves alike."""
TRIALS = 10
"""Speeds up to the estimated critical one at which it is looked for."""
FARTHEST = 4.0
"""Multiple of the estimated critical speed up to which one is looked for."""

SPRINGS = ("penalty", "augmented")
"""Couplings that tie hose and water by springs, alone or beside multipliers."""

Plane = Literal["in", "out", "any"]


class Critical(NamedTuple):
    """A speed, m/s, at which a motion in or out of the plane begins to grow, its frequency Hz, and the way it does."""

    speed: float
    frequency: float
    plane: Plane
    kind: Literal["flutter", "divergence"]


class Stability(NamedTuple):
    """Eigenvalues against speed.

    ``speed`` (k,) m/s, rising; ``eigenvalues`` (k, m) 1/s, each column one mode followed from speed to speed, and of a
    straight hose, which moves in all planes alike, those of one plane;
    ``out_of_plane`` (k, m) the share of the motion that is; ``grows`` (k,) whether any motion does, by more than what
    may be rounding; ``critical`` what becomes unstable, the lowest speed first, a plane once, and once more where it is
    unstable without flow; ``stable_from`` the speed, m/s, from which nothing grows that does at the slowest one, None
    where nothing does there or it never ceases.
    """

    speed: np.ndarray
    eigenvalues: np.ndarray
    out_of_plane: np.ndarray
    grows: np.ndarray
    critical: list[Critical]
    stable_from: float | None = None


def normal_of(scene: HoseScene) -> np.ndarray | None:
    """Unit normal of the plane of direction and gravity; None where these are parallel, or there is no gravity."""
    across = np.cross(scene.hose.unit_direction, scene.gravity)
    size = float(np.linalg.norm(across))
    return across / size if size > 1e-9 * float(np.linalg.norm(scene.gravity)) and size > 0.0 else None


class _Linear:
    """A scene's eigenvalues at any speed, each static shape sought from the nearest one known."""

    def __init__(self, scene: HoseScene) -> None:
        self.scene, self.normal = _tied(scene), normal_of(scene)
        self.known: dict[float, Form] = {}
        self.solved: dict[float, tuple[Vibrations, np.ndarray]] = {}

    def at(self, speed: float) -> tuple[Vibrations, np.ndarray]:
        """The motions that grow fastest or are slowest, and which share of each is out of the plane."""
        if speed in self.solved:
            return self.solved[speed]
        near = min(self.known.values(), key=lambda one: abs(one.speed - speed), default=None)
        found = form(self.scene, speed, near)
        self.known[speed] = found
        motions = vibrations(found.system, found.state, None if found.system.size <= DENSE else SLOWEST)
        if self.normal is None:
            motions = _of_one_plane(motions)
        self.solved[speed] = motions, self._share(motions.shape)
        return self.solved[speed]

    def _share(self, shape: np.ndarray) -> np.ndarray:
        if self.normal is None:
            return np.zeros(shape.shape[1])
        count = len(self.known[next(iter(self.known))].position)
        nodes = shape[: 7 * count].reshape(count, 7, -1)[:, :3]
        across = np.einsum("nck,c->nk", nodes, self.normal)
        whole = (np.abs(nodes) ** 2).sum(axis=(0, 1))
        return (np.abs(across) ** 2).sum(axis=0) / np.where(whole > 0.0, whole, 1.0)

    def growth(self, speed: float, plane: Plane) -> tuple[float, complex]:
        """Largest growth rate of motions in a plane less what may be rounding, 1/s, and the eigenvalue that has it."""
        motions, share = self.at(speed)
        those = np.full(share.size, True) if plane == "any" else (share > 0.5) == (plane == "out")
        chosen = motions.value[those]
        if not chosen.size:
            return -np.inf, 0j
        grows = chosen.real - STILL * np.abs(chosen) - ROUNDING * motions.rounding[those]
        fastest = int(np.argmax(grows))
        return float(grows[fastest]), complex(chosen[fastest])


def _of_one_plane(motions: Vibrations) -> Vibrations:
    """The motions of a straight hose, each that it makes in two planes once.

    What stretches it has no like. Of two pairs that meet, as where they are about to flutter, two are left.
    """
    value, kept = motions.value, np.full(motions.value.size, True)
    for i in range(value.size):
        if kept[i]:
            apart = np.abs(value[i + 1 :] - value[i])
            near = kept[i + 1 :] & (apart <= ALIKE * np.abs(value[i]) + ROUNDING * motions.rounding[i])
            if near.any():
                kept[i + 1 + np.argmin(np.where(near, apart, np.inf))] = False
    return Vibrations(value[kept], motions.shape[:, kept], motions.rounding[kept])


def _tied(scene: HoseScene) -> HoseScene:
    """The scene with hose and water tied without springs, on which entering water excites a fast mode of its own.

    Springs that support multipliers are so stiff that bending would be lost in the rounding of eigenvalues. A hose of
    many elements has no multipliers either: of its motions only the slowest are sought.
    """
    long = DOFS * scene.hose.element_count > DENSE
    if scene.document is None or scene.coupling == "linear" or (scene.coupling not in SPRINGS and not long):
        return scene
    values = {("coupling",): ("linear", "coupling"), ("stiffness",): (None, "stiffness")}
    return validate(HoseScene, scene.document.replaced(values))


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
        Pairs of eigenvalues to follow.

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
    linear = _Linear(scene)
    grid = np.unique(np.array(speeds, float)) if speeds is not None else _range(linear)
    rows = [linear.at(float(speed)) for speed in grid]
    # Modes are told apart where the flow is slowest.
    backwards = abs(grid[0]) > abs(grid[-1])
    values, shares = _follow(rows[::-1] if backwards else rows, modes)
    values, shares = (values[::-1], shares[::-1]) if backwards else (values, shares)
    planes: tuple[Plane, ...] = ("any",) if linear.normal is None else ("in", "out")
    found = [critical for plane in planes for critical in _crossings(linear, grid, plane)[:1]]
    if 0.0 in grid:
        found += [_kind(linear, 0.0, plane) for plane in planes if _grows(linear, 0.0, plane)]
    grows = np.array([_grows(linear, speed, "any") for speed in grid])
    critical = sorted(found, key=lambda one: abs(one.speed))
    return Stability(grid, values, shares, grows, critical, _stable_from(linear, grid, grows))


def _stable_from(linear: _Linear, grid: np.ndarray, grows: np.ndarray) -> float | None:
    """Speed from which nothing grows that does at the slowest one of a range."""
    if not grows[np.argmin(np.abs(grid))]:
        return None
    way = -1.0 if grid[-1] <= 0.0 else 1.0
    grid, grows = (grid[::-1], grows[::-1]) if way < 0.0 else (grid, grows)
    for left, right, before, after in zip(grid[:-1], grid[1:], grows[:-1], grows[1:], strict=True):
        if before and not after and way * right > 0.0:
            return _locate(linear, float(left), float(right), "any").speed
    return None


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
    return _crossings(_Linear(scene), np.array(speeds, float), plane, ceasing)


def _range(linear: _Linear) -> np.ndarray:
    """Speeds from zero to half as much again as the first critical one, those that were tried among them, rising.

    A hose that falls without flow may be held up by more of it: the first critical speed is beyond that.
    """
    guess = direction_of(linear.scene) * _guess(linear.scene)
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
    return np.sort([guess * (i / finer) / TRIALS + 0.0 for i in range(count + 1)])


def direction_of(scene: HoseScene) -> float:
    """1 where the scene's flow is fastest from root to tip, or nothing flows, -1 from tip to root."""
    sampled = speeds_of(scene)
    return -1.0 if sampled[np.argmax(np.abs(sampled))] < 0.0 else 1.0


def _guess(scene: HoseScene) -> float:
    """A speed near the critical one, m/s: by the table of straight uniform hoses, else from thrust and stiffness."""
    hose = average(scene, 1.0)
    u, _ = onset(scene, hose)
    if u is not None and hose.dimensionless_speed:
        return u / hose.dimensionless_speed
    pull = (hose.mass + hose.water) * float(np.linalg.norm(scene.gravity)) * hose.length
    stiff = min(piece.axial_stiffness for piece in scene.hose.pieces)
    return float(np.sqrt((pull or 0.1 * stiff) / hose.thrust))


def _crossings(linear: _Linear, grid: np.ndarray, plane: Plane, ceasing: bool = False) -> list[Critical]:
    """Where motions begin to grow, or cease to, as the water goes faster, to either side, the slowest first."""
    found = []
    grows = [_grows(linear, speed, plane) for speed in grid]
    for left, right, before, after in zip(grid[:-1], grid[1:], grows[:-1], grows[1:], strict=True):
        faster = abs(right) > abs(left)
        if before != after and ceasing == (after != faster):
            found.append(_locate(linear, float(left), float(right), plane))
    return sorted(found, key=lambda one: abs(one.speed))


def _grows(linear: _Linear, speed: float, plane: Plane) -> bool:
    return linear.growth(float(speed), plane)[0] > 0.0


def _locate(linear: _Linear, left: float, right: float, plane: Plane) -> Critical:
    """Critical speed between one at which nothing grows and one at which something does."""
    size = max(abs(left), abs(right))
    speed = float(brentq(lambda u: linear.growth(u, plane)[0], left, right, xtol=PRECISION * size, rtol=1e-12))
    return _kind(linear, speed, plane)


def _kind(linear: _Linear, speed: float, plane: Plane) -> Critical:
    """In which way a hose becomes unstable at a speed, or is where nothing flows."""
    # The speed that a search ends with is one at which it has solved.
    _, value = linear.growth(speed, plane)
    # Where a pair meets at zero rounding has a say in what it looks like: the eigenvalue past it says which it is.
    _, past = linear.growth(speed * (1.0 + BEYOND), plane)
    diverges = abs(past.imag) <= REAL * abs(past)
    return Critical(
        speed, 0.0 if diverges else value.imag / (2.0 * np.pi), plane, "divergence" if diverges else "flutter"
    )


def _follow(rows: list[tuple[Vibrations, np.ndarray]], modes: int) -> tuple[np.ndarray, np.ndarray]:
    """Give each mode a column of its own over all speeds: the eigenvalue and shape nearest to the last."""
    # Two real ones may become a pair, of which one is listed: at other speeds there may be fewer.
    modes = min(modes, *(motions.value.size for motions, _ in rows))
    # The slowest at first, real ones of heavy damping left out: they belong to no vibration. Those that grow stay.
    first, share = rows[0]
    damped = (first.value.imag == 0.0) & (first.value.real <= 0.0)
    order = np.argsort(np.abs(first.value) + np.where(damped, np.inf, 0.0), kind="stable")[:modes]
    values, shares, shapes = [first.value[order]], [share[order]], first.shape[:, order]
    for motions, share in rows[1:]:
        alike = np.abs(shapes.conj().T @ motions.shape)
        alike /= np.linalg.norm(shapes, axis=0)[:, None] * np.linalg.norm(motions.shape, axis=0)
        apart = np.abs(motions.value - values[-1][:, None]) / (np.abs(values[-1]) + 1e-300)[:, None]
        _, chosen = linear_sum_assignment(apart + (1.0 - alike))
        values.append(motions.value[chosen])
        shares.append(share[chosen])
        shapes = motions.shape[:, chosen]
    return np.array(values), np.array(shares)
