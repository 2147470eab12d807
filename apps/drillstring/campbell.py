"""Natural frequencies of a string against rotary speed: lateral ones of the assembly, torsional and axial of the whole.

They are those of small vibrations about the static equilibrium of the scene, undamped, as the lumped model has them:
tension and weight on bit, buoyed weight, added mass and mud inside; a contact that bears load is a spring across the
hole, and by its normal force one around it; friction does not hold. The model has no gyroscopic and no rotatory inertia
of bending, so that frequencies do not depend on rotary speed; `Mode.turning` tells what these would do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import eigsh

from drillstring import bha
from drillstring.build import build, tubes_of, well_of
from drillstring.contact import WallContact
from drillstring.scene import DrillstringScene
from drillstring.string import Lumps, cut
from drillstring.wellbore import Wellbore
from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import State, new_state
from tautline.kernels.matrix import new_matrix, sparse
from tautline.lumped.bend import Bends
from tautline.lumped.curve import PER_BODY
from tautline.system.system import System

KINDS = ("lateral", "torsional", "axial")
X, U, V, TURN = range(PER_BODY)
DENSE = 1500
"""Unknowns up to which all modes are found by dense algebra."""
BATCH = 40
"""Modes that are asked for at a time where there are more unknowns."""
SAME = 1e-5
"""Relative difference below which two frequencies are those of one mode in either plane."""
INCLINED = 0.01
"""Sine of the inclination from which on a hole has a high side."""
ALONG, ASKEW = np.cos(np.radians(30.0)), 0.5
"""Share of a direction from which on a mode is said to be in its plane; size of the lesser axis of one that is in none.
"""


class Mode(NamedTuple):
    """A natural mode.

    ``kind`` lateral, torsional or axial; ``plane`` of a lateral one; ``frequency`` Hz, negative for the growth rate
    over 2 pi of what is not stable; ``error`` Hz, by Richardson's rule from a mesh of half as many links, NaN where
    that has no such mode; ``depth`` (k,) measured depth of the lumps, m; ``shape`` (k, 2) up and sideways, or (k, 1),
    one where it is largest; ``turning`` ratio of polar rotatory inertia to mass of the motion (0 but for lateral ones).
    """

    kind: str
    plane: str
    frequency: float
    error: float
    depth: np.ndarray
    shape: np.ndarray
    turning: float

    def gyroscopic(self, speed: float) -> float:
        """Half the relative difference that gyroscopic terms would make between forward and backward whirl.

        First order in a rotary speed, rad/s: J Omega / (2 m omega), with the ratio of ``turning``.
        """
        return self.turning * speed / (4.0 * pi * self.frequency) if self.frequency > 0.0 else 0.0

    @property
    def rotatory(self) -> float:
        """Relative fall of the frequency by rotatory inertia, to first order."""
        return 0.25 * self.turning


class Support(NamedTuple):
    """What holds the string sideways: from and to which measured depth m, section, how, the wall's force N (else 0)."""

    top: float
    bottom: float
    section: str
    how: str
    force: float


class Critical(NamedTuple):
    """Rotary speed (rad/s) at which ``order`` times it meets the frequency of a mode, by its number."""

    mode: int
    order: float
    speed: float


@dataclass(frozen=True)
class Campbell:
    """What a Campbell diagram shows; speeds rad/s, frequencies Hz, depths m; links of the finer mesh by kind."""

    modes: list[Mode]
    supports: list[Support]
    top: float
    bottom: float
    speeds: tuple[float, float]
    orders: tuple[float, ...]
    up_to: float
    links: dict[str, int]

    @property
    def critical(self) -> list[Critical]:
        """Crossings inside the range of speeds, from slow to fast."""
        low, high = self.speeds
        found = [
            Critical(k, order, 2.0 * pi * mode.frequency / order)
            for k, mode in enumerate(self.modes)
            for order in self.orders
            if mode.frequency > 0.0
        ]
        return sorted((one for one in found if low <= one.speed <= high), key=lambda one: one.speed)

    @property
    def unstable(self) -> list[Mode]:
        """Modes that grow: the string buckles, or is not at rest where it seems to be."""
        return [mode for mode in self.modes if mode.frequency < 0.0]


@dataclass(frozen=True)
class _Linear:
    """A cut string at rest: its lumps, the forces of the wall (n + 1,), and sparse mass and stiffness (n, n)."""

    cut: bha.Cut
    well: Wellbore
    lumps: Lumps
    system: System
    state: State
    normal: np.ndarray

    @classmethod
    def of(cls, mesh: bha.Cut) -> _Linear:
        model = build(mesh.scene)
        state = new_state(model.system)
        find_equilibrium(model.system, state, model.step_limit)
        well = well_of(mesh.scene)
        lumps = cut(tubes_of(mesh.scene, well.length), sum(mesh.counts))
        q, normal = state.full_q.reshape(-1, PER_BODY), np.zeros(lumps.length.size + 1)
        for group in model.system.groups:
            if isinstance(group, WallContact):
                s = group.springs
                gap = np.hypot(q[s.body, U], q[s.body, V]) - s.clearance
                normal[s.body] = np.maximum(0.0, s.stiffness * gap)
        return cls(mesh, well, lumps, model.system, state, normal)

    def matrices(self, rows: np.ndarray, fixed: np.ndarray | None = None) -> tuple[np.ndarray, csc_array]:
        """Diagonal of the mass and stiffness of some full degrees of freedom, all others held.

        ``fixed`` (n + 1,) says which lumps are held sideways.
        """
        system = self.system if fixed is None else _clamped(self.system, self.lumps, fixed)
        number = system.dofs.number[rows]
        parts = []
        for part in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
            matrix = new_matrix(system.size, system.bandwidth, system.border)
            evaluate(system, self.state, 0.0, 1.0, True, *part, matrix, np.zeros(system.size))
            parts.append(csc_array(sparse(matrix))[number][:, number])
        return parts[0].diagonal(), csc_array(0.5 * (parts[1] + parts[1].T))

    def free(self, lumps: np.ndarray, directions: tuple[int, ...]) -> np.ndarray:
        """Full degrees of freedom of some lumps that are free."""
        rows = (PER_BODY * lumps[:, None] + np.array(directions)).ravel()
        return rows[self.system.dofs.number[rows] >= 0]


def _clamped(system: System, lumps: Lumps, fixed: np.ndarray) -> System:
    """Where links that are held end, only that half of a bend gives way which belongs to the link that is free.

    With the whole bend a clamped end would err by the first order of a link's length.
    """
    groups = []
    for group in system.groups:
        if isinstance(group, Bends):
            rigidity = lumps.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
            above, here, below = fixed[:-2], fixed[1:-1], fixed[2:]
            stiffness = group.stiffness.copy()
            for held, link in ((above & ~below, slice(1, None)), (below & ~above, slice(None, -1))):
                half = (rigidity / (0.5 * lumps.length))[link]
                stiffness[held & here] = half[held & here]
            group = group._replace(stiffness=stiffness)
        groups.append(group)
    return replace(system, groups=tuple(groups), linked={})


def campbell(
    scene: DrillstringScene,
    speeds: tuple[float, float],
    orders: tuple[float, ...] = (1.0, 2.0, 3.0),
    kinds: tuple[str, ...] = ("lateral",),
    up_to: float | None = None,
    top: float | None = None,
    held: frozenset[str] = frozenset(),
) -> Campbell:
    """Natural frequencies and critical speeds.

    Parameters
    ----------
    scene : DrillstringScene
    speeds : (float, float)
        Rotary speeds from and to, rad/s.
    orders : tuple of float
        Multiples of the rotary speed that excite.
    kinds : tuple of str
        Of ``KINDS``.
    up_to : float, optional
        Highest frequency, Hz; by default three times the fastest speed.
    top : float, optional
        Measured depth of the upper end of the lateral modes, m, where it is not to be found.
    held : set of str
        Names of sections whose lumps are held where they rest, and ``bit``, which is held on the axis.

    Raises
    ------
    SceneError
        As the builder does, and where the mesh would be too large.
    StoppedEarly
        NO_EQUILIBRIUM.
    """
    highest = up_to if up_to is not None else 3.0 * speeds[1] / (2.0 * pi)
    if "bit" in held:
        scene = scene.model_copy(update={"bit": scene.bit.model_copy(update={"lateral": "pinned"})})
    well = well_of(scene)
    bottom = float(sum(tube.length for tube in tubes_of(scene, well.length)))
    modes: list[Mode] = []
    supports: list[Support] = []
    links: dict[str, int] = {}
    upper = 0.0
    if "lateral" in kinds:
        found, supports, upper, links["lateral"] = _lateral(scene, highest, top, held)
        modes += found
    for kind in ("torsional", "axial"):
        if kind in kinds:
            found, links[kind] = _of_a_rod(scene, kind, highest)
            modes += found
    return Campbell(modes, supports, upper, bottom, speeds, orders, highest, links)


# -- lateral


def _lateral(
    scene: DrillstringScene, highest: float, top: float | None, held: frozenset[str]
) -> tuple[list[Mode], list[Support], float, int]:
    """Modes of two meshes, one for the error of the other; supports, upper end and links of the finer."""
    end = 0.0
    if top is not None:
        end = top
    elif scene.well.wall is not None:
        first = _Linear.of(bha.coarse(scene))
        at = _upper_end(first, bha.lowest_end(scene))
        # One link higher: a finer string finds its place on the wall within the last coarse link.
        end = float(first.lumps.measured_depth[max(0, at - 1)])
    mesh = bha.fine(scene, end, highest)
    both = []
    for one in (mesh, mesh.doubled()):
        linear = _Linear.of(one)
        depth = linear.lumps.measured_depth
        at = int(np.argmin(np.abs(depth - top))) if top is not None else 0
        if top is None and scene.well.wall is not None:
            at = _upper_end(linear, bha.lowest_end(scene))
        both.append((linear, at, _lateral_modes(linear, at, highest, held)))
    (_, _, rough), (linear, at, modes) = both
    links = linear.lumps.length.size - at
    return with_errors(modes, rough), _supports(linear, at, held), float(linear.lumps.measured_depth[at]), links


def _upper_end(linear: _Linear, lowest: float) -> int:
    """Deepest lump on the wall above a measured depth; 0, the drive, where there is none."""
    touching = np.flatnonzero((linear.normal > 0.0) & (linear.lumps.measured_depth <= lowest))
    return int(touching[-1]) if touching.size else 0


def _lateral_modes(linear: _Linear, at: int, highest: float, held: frozenset[str]) -> list[Mode]:
    """Modes below a lump, which is held with all above it; motion along the hole goes with them."""
    lumps = np.arange(at + 1, linear.lumps.length.size + 1)
    every = np.arange(linear.lumps.length.size + 1)
    fixed = np.array([i <= at or bool(_sections_of(linear.lumps, i) & held) for i in every])
    along, across = linear.free(lumps, (X,)), linear.free(every[~fixed], (U, V))
    rows = np.sort(np.concatenate([along, across]))
    mass, stiffness = linear.matrices(rows, fixed)
    frequency, vectors = modes_below(mass, stiffness, highest)
    full = np.zeros((linear.lumps.length.size + 1, PER_BODY, frequency.size))
    full.reshape(-1, frequency.size)[rows] = vectors
    weights = np.zeros((linear.lumps.length.size + 1, PER_BODY))
    weights.reshape(-1)[rows] = mass
    shares = np.einsum("ik,ikm->km", weights, full**2)
    bending = np.flatnonzero(shares[U] + shares[V] > shares[X])
    up, right, names = _planes(linear)
    sideways = np.stack(
        [up[:, 0, None] * full[:, U] + up[:, 1, None] * full[:, V],
         right[:, 0, None] * full[:, U] + right[:, 1, None] * full[:, V]], axis=1,
    )  # fmt: skip
    found: list[Mode] = []
    k = 0
    while k < bending.size:
        m = bending[k]
        again = k + 1 < bending.size and abs(frequency[bending[k + 1]] - frequency[m]) <= SAME * abs(frequency[m])
        found.append(_mode(linear, at, float(frequency[m]), sideways[..., m], weights[:, U], names, again))
        k += 2 if again else 1
    return found


def _planes(linear: _Linear) -> tuple[np.ndarray, np.ndarray, tuple[str, str]]:
    """Unit vectors (n + 1, 2) on m1, m2 of two directions across the hole at each lump, and what they are called.

    Up and sideways, where the hole is inclined from top to bottom; else the two of the frame.
    """
    m1, m2, _ = linear.well.frame(linear.lumps.measured_depth)
    down = np.stack([m1[:, 2], m2[:, 2]], axis=1)
    level = np.hypot(down[:, 0], down[:, 1])
    if level[-1] <= INCLINED:
        ones, zeros = np.ones(level.size), np.zeros(level.size)
        return np.stack([ones, zeros], 1), np.stack([zeros, ones], 1), ("north-south", "east-west")
    up = np.where(level[:, None] > INCLINED, -down / np.maximum(level, INCLINED)[:, None], -down[-1] / level[-1])
    return up, np.stack([-up[:, 1], up[:, 0]], axis=1), ("up-down", "sideways")


def _mode(
    linear: _Linear, at: int, frequency: float, shape: np.ndarray, mass: np.ndarray, names: tuple[str, str], pair: bool
) -> Mode:
    """Name the plane of a shape (n + 1, 2), and turn one of a pair, whose plane is anyone's, into the first plane."""
    _, size, turned = np.linalg.svd(np.sqrt(mass)[:, None] * shape, full_matrices=False)
    if pair:
        shape = np.stack([shape @ turned[0], np.zeros(len(shape))], axis=1)
        plane = "any plane"
    elif size[1] > ASKEW * size[0]:
        plane = "in space"
    else:
        main = np.abs(turned[0])
        plane = names[int(np.argmax(main))] if main.max() >= ALONG else "oblique"
    shape = shape / shape.flat[np.abs(shape).argmax()]
    lumps = linear.lumps
    polar = lumps.of_links(lambda tube: tube.density * tube.polar_moment)
    slopes = (polar[:, None] * np.diff(shape, axis=0) ** 2 / lumps.length[:, None])[at:].sum()
    turning = float(slopes / (mass[:, None] * shape**2).sum())
    return Mode("lateral", plane, frequency, np.nan, lumps.measured_depth[at:], shape[at:], turning)


def _sections_of(lumps: Lumps, i: int) -> set[str]:
    """Names of the sections that a lump belongs to."""
    return {tube.name for tube, length in zip(lumps.tubes, lumps.halves[i], strict=True) if length > 0.0}


def _supports(linear: _Linear, at: int, held: frozenset[str]) -> list[Support]:
    """What holds the part that is looked at, from the top down; neighbours on the wall are told as one."""
    lumps, normal = linear.lumps, linear.normal
    depth, last = lumps.measured_depth, lumps.length.size
    name = [lumps.tubes[k].name for k in lumps.section]
    how = "in the top drive" if at == 0 else "lies on the wall" if normal[at] > 0.0 else "held"
    found = [Support(float(depth[at]), float(depth[at]), name[at], how, float(normal[at]) if at else 0.0)]
    i = at + 1
    while i <= last:
        named = sorted(_sections_of(lumps, i) & held)
        j = i
        while j <= last and (_sections_of(lumps, j) & held if named else _rests(linear, j, held)):
            j += 1
        if j > i:
            thick = max(range(i - 1, min(j, last)), key=lambda k: lumps.tubes[lumps.section[k]].contact_od)
            section, how = (named[0], "held") if named else (name[thick], "on the wall")
            force = 0.0 if named else float(normal[i:j].sum())
            found.append(Support(float(depth[i]), float(depth[j - 1]), section, how, force))
        i = max(j, i + 1)
    if linear.system.dofs.number[PER_BODY * last + U] < 0:
        found.append(Support(float(depth[-1]), float(depth[-1]), "bit", "held on the axis", 0.0))
    return found


def _rests(linear: _Linear, i: int, held: frozenset[str]) -> bool:
    """Whether a lump lies on the wall and is not held otherwise."""
    return bool(linear.normal[i] > 0.0) and not _sections_of(linear.lumps, i) & held


# -- torsional and axial


def _of_a_rod(scene: DrillstringScene, kind: str, highest: float) -> tuple[list[Mode], int]:
    """Torsional or axial modes of the whole string, with all that hangs on its ends, and links of the finer mesh."""
    tubes = tubes_of(scene, well_of(scene).length)
    if kind == "torsional":
        slowest = min(np.sqrt(tube.shear_modulus / tube.density) for tube in tubes)
    else:
        slowest = min(np.sqrt(tube.youngs_modulus * tube.area / tube.mass_per_length) for tube in tubes)
    mesh = bha.coarse(scene, float(slowest) / highest / bha.PER_WAVE)
    rough, modes = (_rod_modes(_Linear.of(one), kind, highest) for one in (mesh, mesh.doubled()))
    return with_errors(modes, rough), 2 * sum(mesh.counts)


def _rod_modes(linear: _Linear, kind: str, highest: float) -> list[Mode]:
    direction = TURN if kind == "torsional" else X
    rows = linear.free(np.arange(linear.lumps.length.size + 1), (direction,))
    frequency, vectors = modes_below(*linear.matrices(rows), highest)
    shapes = np.zeros((linear.lumps.length.size + 1, frequency.size))
    shapes[rows // PER_BODY] = vectors
    depth = linear.lumps.measured_depth
    return [
        Mode(kind, "", float(f), np.nan, depth, (shape / shape[np.abs(shape).argmax()])[:, None], 0.0)
        for f, shape in zip(frequency, shapes.T, strict=True)
    ]


# -- algebra


def modes_below(mass: np.ndarray, stiffness: csc_array, highest: float) -> tuple[np.ndarray, np.ndarray]:
    """Modes of K x = omega^2 M x up to a frequency, Hz.

    Parameters
    ----------
    mass : (n,) array
        Diagonal of M.
    stiffness : (n, n) sparse array
        Symmetric.

    Returns
    -------
    frequency : (k,) array
        Hz, rising, negative where omega^2 is.
    vectors : (n, k) array
        Of unit mass.
    """
    root = 1.0 / np.sqrt(mass)
    scaled = csc_array(diags_array(root) @ stiffness @ diags_array(root))
    limit, n = (2.0 * pi * highest) ** 2, mass.size
    if n <= DENSE:
        square, vectors = eigh(scaled.toarray(), subset_by_value=(-np.inf, limit))
    else:
        count = BATCH
        while True:
            square, vectors = eigsh(scaled, min(count, n - 2), sigma=-1e-3 * limit)
            if square.max() > limit or count >= n - 2:
                break
            count *= 2
        order = np.argsort(square)
        order = order[square[order] <= limit]
        square, vectors = square[order], vectors[:, order]
    return np.sign(square) * np.sqrt(np.abs(square)) / (2.0 * pi), root[:, None] * vectors


def with_errors(modes: list[Mode], rough: list[Mode]) -> list[Mode]:
    """Modes with the error that those of half as many links tell: a third of the difference, for order two.

    Each mode is compared with the nearest in frequency of its kind and plane.
    """
    found = []
    for mode in modes:
        like = [one.frequency for one in rough if one.plane == mode.plane]
        nearest = min(like, key=lambda f, own=mode.frequency: abs(f - own), default=np.nan)
        found.append(mode._replace(error=abs(nearest - mode.frequency) / 3.0))
    return found
