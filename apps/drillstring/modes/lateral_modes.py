"""Lateral modes of the assembly between its contact points, the planes they are in, and what holds the string."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drillstring.modes import bha
from drillstring.modes.natural_modes import Mode, with_errors
from drillstring.modes.rest import Rest, rest_of
from drillstring.modes.string_at_rest import U, V, X
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps
from tautline.scene.errors import SceneError
from tautline.threads import one_thread

SAME = 1e-5
"""Relative difference below which two frequencies are those of one mode in either plane."""
INCLINED = 0.01
"""Sine of the inclination from which on a hole has a high side."""
ALONG, ASKEW = float(np.cos(np.radians(30.0))), 0.5
"""Share of a direction from which on a mode is in its plane; share of the lesser axis of one that is in none."""


class Support(NamedTuple):
    """What holds the string sideways: from and to which measured depth m, section, how, the wall's force N (else 0)."""

    top: float
    bottom: float
    section: str
    how: str
    force: float


@one_thread()
def lateral_modes(
    scene: DrillstringScene, highest: float, top: float | None, held: frozenset[str]
) -> tuple[list[Mode], list[Support], float, int]:
    """Modes of two meshes, one for the error of the other; supports, upper end and links of the finer."""
    end = 0.0
    if top is not None:
        end = top
    elif scene.well.wall is not None:
        first = rest_of(bha.coarse(scene))
        at = _upper_end(first, bha.lowest_end(scene))
        # One link higher: a finer string finds its place on the wall within the last coarse link.
        end = float(first.lumps.measured_depth[max(0, at - 1)])
    try:
        mesh = bha.fine(scene, end, highest)
    except SceneError:
        if end > 0.0 or bha.assembly_of(scene) == 0:
            raise
        # Nothing touches and the pipe is too long to be cut so finely: the assembly alone, held at its top.
        end = top = bha.top_of_assembly(scene)
        mesh = bha.fine(scene, end, highest)
    both = []
    for one in (mesh, mesh.doubled()):
        linear = rest_of(one)
        depth = linear.lumps.measured_depth
        at = int(np.argmin(np.abs(depth - top))) if top is not None else 0
        if top is None and scene.well.wall is not None:
            at = _upper_end(linear, bha.lowest_end(scene))
        both.append((linear, at, _lateral_modes(linear, at, highest, held)))
    (_, _, rough), (linear, at, modes) = both
    links = linear.lumps.length.size - at
    return with_errors(modes, rough), _supports(linear, at, held), float(linear.lumps.measured_depth[at]), links


def _upper_end(linear: Rest, lowest: float) -> int:
    """Deepest lump on the wall above a measured depth; 0, the drive, where there is none."""
    touching = np.flatnonzero((linear.normal > 0.0) & (linear.lumps.measured_depth <= lowest))
    return int(touching[-1]) if touching.size else 0


def _lateral_modes(linear: Rest, at: int, highest: float, held: frozenset[str]) -> list[Mode]:
    """Modes below a lump, which is held with all above it; motion along the hole goes with them."""
    every = np.arange(linear.lumps.length.size + 1)
    fixed = np.array([i <= at or bool(_sections_of(linear.lumps, int(i)) & held) for i in every])
    frequency, full, weights = linear.lateral(at, fixed, highest)
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


def _planes(linear: Rest) -> tuple[np.ndarray, np.ndarray, tuple[str, str]]:
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
    linear: Rest,
    at: int,
    frequency: float,
    shape: np.ndarray,
    mass: np.ndarray,
    names: tuple[str, str],
    pair: bool,
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
    polar = lumps.of_links(lambda tube: tube.rotary_inertia)
    slopes = (polar[:, None] * np.diff(shape, axis=0) ** 2 / lumps.length[:, None])[at:].sum()
    turning = float(slopes / (mass[:, None] * shape**2).sum())
    return Mode("lateral", plane, frequency, np.nan, lumps.measured_depth[at:], shape[at:], turning)


def _sections_of(lumps: Lumps, i: int) -> set[str]:
    """Names of the sections that a lump belongs to."""
    return {tube.name for tube, length in zip(lumps.tubes, lumps.halves[i], strict=True) if length > 0.0}


def _supports(linear: Rest, at: int, held: frozenset[str]) -> list[Support]:
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
    if linear.pinned:
        found.append(Support(float(depth[-1]), float(depth[-1]), "bit", "held on the axis", 0.0))
    return found


def _rests(linear: Rest, i: int, held: frozenset[str]) -> bool:
    """Whether a lump lies on the wall and is not held otherwise."""
    return bool(linear.normal[i] > 0.0) and not _sections_of(linear.lumps, i) & held
