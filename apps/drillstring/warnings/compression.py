"""What to tell of a string that is pushed: where it buckles, and why a run does or does not show that."""

from __future__ import annotations

from math import ceil, pi, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene
from drillstring.statics.helix import limits_at
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown

STATIONS = 200
"""Places along the string at which its compression is compared with what buckles it."""
TO_A_HALF_WAVE = {LUMPED: 4, BEAM: 2}
"""Elements that a half wave of buckling wants. A column of n links to a half wave buckles at a compression that is
(pi / 2 n)^2 / 3 too low, 5 % with four; a cubic element bends by itself."""
FLAT = 1.0e-6
"""Size of the hole's directions out of a plane, over that within it, below which the hole lies in the plane."""


class Buckled(NamedTuple):
    """Where a string at rest is farthest beyond its limit: section, compression and limit N, from and to which m."""

    section: int
    compression: float
    limit: float
    top: float
    bottom: float


def buckled_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> Buckled | None:
    """Where the string at rest and without friction is compressed beyond its sinusoidal limit (buckling.py)."""
    edges = np.linspace(0.0, lumps.total, STATIONS + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    section = np.searchsorted(np.cumsum([tube.length for tube in lumps.tubes])[:-1], middle, side="right")
    weight = np.array([weight_in(fluid_of(scene.mud), tube, scene.gravity) for tube in lumps.tubes])[section]
    gained = weight * np.diff(well.tvd(edges))
    pushed = -(np.cumsum(gained[::-1])[::-1] - 0.5 * gained + scene.bit.load)
    at = np.flatnonzero(pushed > 0.0)
    if at.size == 0:
        return None
    tubes = [lumps.tubes[k] for k in section[at]]
    clearance = np.array([0.5 * (scene.well.diameter - tube.contact_od) for tube in tubes])
    limit = limits_at(well, middle[at], tubes, weight[at], clearance).sinusoidal
    beyond = pushed[at] > limit
    if not beyond.any():
        return None
    worst = int(np.argmax(np.where(beyond, pushed[at] / np.maximum(limit, 1e-9), 0.0)))
    span = edges[at[beyond][0]], edges[at[beyond][-1] + 1]
    return Buckled(int(section[at[worst]]), float(pushed[at[worst]]), float(limit[worst]), *map(float, span))


def buckling_warnings(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a string that buckles, in a run that cannot show it."""
    if scene.well.wall is None or scene.model.bending == "none" or scene.bit.load >= 0.0:
        return []
    found = buckled_at_rest(scene, well, lumps)
    if found is None:
        return []
    causes, cures = [], []
    tubes = [tube for tube in lumps.tubes if tube.eccentricity != (0.0, 0.0)]
    if not tubes and (flat := _flatness(well)) is not None:
        causes.append(f"{flat}, and nothing pushes the string out of it")
        cures.append(f"give string[{found.section}] an `eccentricity`, such as [0, 2 mm], or the hole its survey")
    tube = lumps.tubes[found.section]
    half_wave = pi * sqrt(2.0 * tube.youngs_modulus * tube.second_moment / found.compression)
    longest = float(lumps.length[lumps.section == found.section].max())
    wanted = ceil(tube.length * TO_A_HALF_WAVE[scene.model.kind] / half_wave)
    now = int((lumps.section == found.section).sum())
    if wanted > now:
        lengths = [shown(length, "m", scene.units) for length in (longest, half_wave)]
        causes.append(f"elements of {lengths[0]} are long for half waves of {lengths[1]}")
        total = lumps.length.size + wanted - now
        cures.append(f"give string[{found.section}] `elements: {wanted}` and model `elements: {total}`")
    if not causes:
        return []
    pushed, limit = (shown(force, "N", scene.units) for force in (found.compression, found.limit))
    span = " to ".join(shown(depth, "m", scene.units) for depth in (found.top, found.bottom))
    told = f"compresses {tube.name} by up to {pushed} at rest and buckles it beyond {limit}, from {span}"
    cause = f"{told}, which the run will not show: {'; '.join(causes)}"
    where = "bit.weight" if scene.bit.on_bottom and scene.bit.weight else "bit.force"
    return [SceneWarning(where, f"{cause}; to see it {', and '.join(cures)}, or else take less")]


def _flatness(well: Wellbore) -> str | None:
    """How the hole keeps a string from leaving its plane, in words; None where it does not lie in one."""
    t = well.frame(np.linspace(0.0, well.length, STATIONS))[2]
    size = np.linalg.svd(np.vstack([t, [0.0, 0.0, 1.0]]), compute_uv=False)
    if size[2] > FLAT * size[0]:
        return None
    return "the hole is perfectly straight" if np.ptp(t, axis=0).max() < FLAT else "the hole lies in one plane"
