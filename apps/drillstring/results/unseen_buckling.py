"""What is said of a string that is pushed beyond its buckling limit where a run cannot show that it buckles.

`check` says it of the weight on bit at rest, and a run of the largest push that it has seen, by the same rule.
"""

from __future__ import annotations

from math import ceil, pi, sqrt
from typing import Any

import numpy as np

from drillstring.drilling.end_groups import turns
from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene
from drillstring.string.buckled import Buckled, buckled_at_rest, buckled_in_frames
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.scene.values.printed import shown

TO_A_HALF_WAVE = {LUMPED: 4, BEAM: 2}
"""Elements that a half wave of buckling wants. A column of n links to a half wave buckles at a compression that is
(pi / 2 n)^2 / 3 too low, 5 % with four; a cubic element bends by itself."""
STATIONS = 200
"""Places at which the hole's direction is looked at."""
FLAT = 1.0e-6
"""Size of the hole's directions out of a plane, over that within it, below which the hole lies in the plane."""
OFF_THE_PLANE = 1.0e-6
"""Way of a string out of the hole's plane, m, from which something has pushed it there."""


def told_at_rest(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> str:
    """What is said of a string whose bit pushes it beyond its limit at rest; empty where nothing is."""
    if not _asked(scene) or scene.bit.load >= 0.0:
        return ""
    found = buckled_at_rest(scene, well, lumps)
    if found is None:
        return ""
    pushed = shown(found.compression, "N", scene.units)
    what = f"compresses {lumps.tubes[found.section].name} by up to {pushed} at rest"
    flat = _flatness(well)
    if _leaves_the_plane(scene, lumps):
        flat = None
    return _told(scene, lumps, found, what, "will", flat)


def told_of_a_run(result: Any, scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[str]:
    """A sentence on the frame of a run in which the string is farthest beyond its limit, where the run cannot show it.

    Of a run that keeps statistics the frames are those of its windows.
    """
    hook, tension = np.asarray(result["hook_load"], float), np.asarray(result["tension"], float)
    if not _asked(scene) or not np.isfinite(tension).all() or not np.isfinite(hook).all():
        return []
    seen = buckled_in_frames(scene, well, lumps, hook, tension)
    if seen is None:
        return []
    frame, found = seen
    flat = _flatness(well)
    # A string that is pushed may leave its plane after it is pushed the most, and buckles then.
    if flat is not None and _off_the_plane(well, lumps, np.asarray(result["lateral_displacement"][frame:])):
        flat = None
    pushed, pulled = (shown(force, "N", scene.units) for force in (found.compression, -found.compression))
    where = f"at {shown(found.depth, 'm', scene.units)} and t = {result.time[frame]:.4g} s"
    what = f"{lumps.tubes[found.section].name} is compressed by up to {pushed}: its tension is {pulled} {where}"
    told = _told(scene, lumps, found, what, "does", flat)
    return [told] if told else []


def _asked(scene: DrillstringScene) -> bool:
    """Whether a run of a scene may be thought to show buckling: there is a wall, and the string bends."""
    return scene.well.wall is not None and scene.model.bending != "none"


def _told(scene: DrillstringScene, lumps: Lumps, found: Buckled, what: str, will: str, flat: str | None) -> str:
    """Limit, stretch, causes and cures behind ``what`` is pushed; empty where a run shows that it buckles.

    ``will`` is the verb of what the run shows, and ``flat`` how the hole keeps the string in its plane, if it does.
    """
    causes, cures = _reasons(scene, lumps, found, flat)
    if not causes:
        return ""
    limit = shown(found.limit, "N", scene.units)
    span = " to ".join(shown(depth, "m", scene.units) for depth in (found.top, found.bottom))
    cause = f"{what}. Beyond {limit} it buckles: from {span}. The run {will} not show that. {'. '.join(causes)}"
    return f"{cause}. To see it, {'. In any case '.join(cures)}. Or take less force"


def _reasons(scene: DrillstringScene, lumps: Lumps, found: Buckled, flat: str | None) -> tuple[list[str], list[str]]:
    """Why a run cannot show that a string buckles, and what would have it shown."""
    causes, cures = [], []
    tube, own = lumps.tubes[found.section], lumps.section == found.section
    if flat is not None:
        # What is judged at rest is not flat where the string will leave its plane: this is a run that ends too early.
        pushes = _leaves_the_plane(scene, lumps)
        why = (
            "the string has not left its plane before the run ends" if pushes else "nothing pushes the string out of it"
        )
        causes.append(f"The {flat}, and {why}")
        cures.append("let the run last longer (`solver.end`)" if pushes else _push(scene, lumps, found.section))
    half_wave = pi * sqrt(2.0 * tube.youngs_modulus * tube.second_moment / found.compression)
    wanted, now = ceil(tube.length * TO_A_HALF_WAVE[scene.model.kind] / half_wave), int(own.sum())
    if wanted > now:
        lengths = [shown(length, "m", scene.units) for length in (float(lumps.length[own].max()), half_wave)]
        causes.append(f"Elements of {lengths[0]} are too long for half waves of {lengths[1]}")
        total = lumps.length.size + wanted - now
        cures.append(f"give string[{found.section}] `elements: {wanted}` and model `elements: {total}`")
    return causes, cures


def _eccentric(lumps: Lumps) -> bool:
    """Whether any section has its mass off its axis."""
    return any(one.eccentricity != (0.0, 0.0) for one in lumps.tubes)


def _leaves_the_plane(scene: DrillstringScene, lumps: Lumps) -> bool:
    """Whether a string will be pushed out of the plane of its hole: mass off its axis does it in turning."""
    return _eccentric(lumps) and turns(scene)


def _push(scene: DrillstringScene, lumps: Lumps, section: int) -> str:
    """What would push a string out of the plane of its hole; without a turn an eccentricity does not."""
    own = f"give string[{section}] an `eccentricity`, such as [0, 2 mm]"
    turn = "let the string turn (`top.rotation`), since an eccentricity pushes nothing while it does not"
    cures = [*([] if _eccentric(lumps) else [own]), *([] if turns(scene) else [turn])]
    return f"{', and '.join(cures)}{', ' * bool(cures)}or give the hole its survey".removeprefix("or ")


def _directions(well: Wellbore) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The hole's directions (n, 3); how far these and the plumb line extend along three axes (3,); the axes (3, 3)."""
    t = well.frame(np.linspace(0.0, well.length, STATIONS))[2]
    _, size, axes = np.linalg.svd(np.vstack([t, [0.0, 0.0, 1.0]]), full_matrices=False)
    return t, size, axes


def _flatness(well: Wellbore) -> str | None:
    """How the hole keeps a string from leaving its plane, in words without `the`; None where it does not lie in one."""
    t, size, _ = _directions(well)
    if size[2] > FLAT * size[0]:
        return None
    return "hole is perfectly straight" if np.ptp(t, axis=0).max() < FLAT else "hole lies in one plane"


def _off_the_plane(well: Wellbore, lumps: Lumps, offset: np.ndarray) -> bool:
    """Whether a string is ever out of the plane of its hole, from its offsets (frames, bodies, 2) on m1 and m2, m.

    Friction around a pipe that turns pushes it there. A hole that is upright has no plane: any offset counts.
    """
    _, size, axes = _directions(well)
    m1, m2, _ = well.frame(lumps.measured_depth)
    ways = (
        np.abs(offset[..., 0] * (m1 @ axis) + offset[..., 1] * (m2 @ axis)) for axis in axes[size <= FLAT * size[0]]
    )
    return any(float(way.max(initial=0.0)) > OFF_THE_PLANE for way in ways)
