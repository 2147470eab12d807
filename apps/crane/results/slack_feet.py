"""Rope that is slack at its foot, of which the mesh hangs a part on the foot.

A straight element hangs half of its weight on either end. Where the lowest element of a span is slack, or pulls with
less than that half, the foot would have to push: in truth all of that weight hangs from above. The tension at the top
is too low by it, and what is at the foot carries it. Of rope that is too long half hangs on the foot in truth, too:
while all of it lies in the lowest element only the rest lacks, the weight of half the way between the nodes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import carries_nothing, stands
from crane.geometry.sagging import PLUMB, foot_of_catenary
from crane.results.course import nodes_of
from crane.scene.scene import Anchor, CraneScene
from tautline.scene.values.ranges import sized

TOLD = 0.02
"""Share of the tension at the top that may lack there without a word."""
MATTERS = 0.005
"""Share of the largest tension of all below which what lacks does not matter."""
LASTS = 1.0
"""How long it has to last, s, or all through a shorter run: rope that snaps is slack for moments."""
PARTS = 200
"""Of a span, of which some are under water."""
ROUNDING = 1.0e-9
FIELDS = ("tension", "axial_force", "position", "material_coordinate")


class Foot(NamedTuple):
    """An element at an end of a span: numbers of the span and its foot, of the element, of its nodes from below."""

    span: int
    side: int
    element: int
    low: int
    high: int


class Lack(NamedTuple):
    """What lacks at the top of a span over its foot, by the number of the span and the side of the foot, N.

    ``top`` is the tension there in truth; ``spare`` half the weight of the rope that is too long in the lowest element.
    ``at_least`` where more may lack: up to ``most``, by which the elements go that are asked for.
    """

    span: int
    side: int
    lacks: float
    top: float
    spare: float = 0.0
    at_least: bool = False
    most: float = 0.0


def slack_feet(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on spans whose foot stays slack while they hang from above, one for each.

    Parameters
    ----------
    result : Result
        Of one that keeps statistics nothing is told: they do not say what was at the same time.
    scene : CraneScene
    """
    if scene.output.statistics or np.linalg.norm(scene.gravity) == 0.0 or any(name not in result for name in FIELDS):
        return []
    time, tension = np.asarray(result.time, float), np.asarray(result["tension"])
    largest = float(tension.max(initial=0.0))
    found = []
    for foot in _feet(scene):
        # Where the foot would push the tension is shown as 0.
        frames = np.flatnonzero(
            (tension[:, foot.span, foot.side] <= 0.0) & (tension[:, foot.span, 1 - foot.side] > 0.0)
        )
        if frames.size == 0:
            continue
        lacks, spare = np.zeros(time.size), np.zeros(time.size)
        lacks[frames], spare[frames] = _lacking(result, scene, foot, frames)
        top = tension[:, foot.span, 1 - foot.side] + lacks
        begin, end = _longest(time, (lacks > TOLD * top) & (lacks > MATTERS * largest))
        if end > begin and time[end] - time[begin] >= min(LASTS, float(time[-1] - time[0])):
            k = begin + int(np.argmax(lacks[begin : end + 1]))
            lack = Lack(foot.span, foot.side, float(lacks[k]), float(top[k]), float(spare[k]))
            found.append(_sentence(scene, lack, time[[begin, end]]))
    return found


def _feet(scene: CraneScene) -> list[Foot]:
    """Both ends of every span: which of them is the foot shows when the rope rises from it."""
    nodes = nodes_of(scene)
    feet = []
    for k in range(len(scene.path) - 1):
        first, last = int(nodes[k]), int(nodes[k + 1])
        feet += [Foot(k, 0, first, first, first + 1), Foot(k, 1, last - 1, last, last - 1)]
    return feet


def _lacking(result: Any, scene: CraneScene, foot: Foot, frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What a foot would have to push with at frames to bear its half of the element's weight, N.

    And half the weight of the rope that is too long between the nodes, N, which the foot bears in truth, too.
    """
    position = np.asarray(result["position"])
    low, high = position[frames, foot.low], position[frames, foot.high]
    material = np.asarray(result["material_coordinate"])
    length = np.abs(material[frames, foot.high] - material[frames, foot.low])
    way = high - low
    up = -np.array(scene.gravity, float)
    rise = np.maximum(way @ (up / float(np.linalg.norm(up))), 0.0)
    distance = np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)
    half = 0.5 * _net_weight(scene, 0.5 * (low[:, 2] + high[:, 2]))
    force = np.asarray(result["axial_force"])[frames, foot.element]
    spare = np.maximum(length - distance, 0.0) * rise / distance
    return np.maximum(half * rise - np.maximum(force, 0.0), 0.0), np.maximum(half, 0.0) * spare


def _longest(time: np.ndarray, holds: np.ndarray) -> tuple[int, int]:
    """First and last frame of the longest time for which something holds; the same frame twice where it never does."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], holds.astype(int), [0]))))
    stays = [(int(begin), int(end) - 1) for begin, end in edges.reshape(-1, 2)]
    return max(stays, key=lambda stay: time[stay[1]] - time[stay[0]], default=(0, 0))


def _net_weight(scene: CraneScene, height: Any) -> np.ndarray:
    """Weight of the rope at heights, less its buoyancy where that is under water, N/m."""
    water, rope = scene.water, scene.rope
    mass = np.full(np.shape(height), rope.mass_per_length)
    if water is not None and rope.diameter is not None:
        mass = mass - 0.25 * math.pi * rope.diameter**2 * water.density * (height < water.surface)
    return mass * float(np.linalg.norm(scene.gravity))


def foreseen(found: Estimate) -> Iterator[tuple[str, str]]:
    """The same of the start, before a run: slack rope over a load that stands, or between fixed places.

    Key and text of the span of which most lacks; one or none.
    """
    scene, path = found.scene, found.path
    length = scene.rope.length
    if length is None or length <= float(path.chords.sum()) or np.linalg.norm(scene.gravity) == 0.0:
        return  # of next to no gravity the square is none
    standing = {body.name for body in scene.bodies if stands(scene, body)}
    cases = []
    for k in range(len(scene.elements)):
        heights = path.tangents[k] @ -np.array(scene.gravity, float)
        side = int(heights[1] < heights[0])
        foot = scene.path[k + side]
        if getattr(foot, "body", None) in standing or (isinstance(foot, Anchor) and carries_nothing(scene)):
            one = _at_rest(found, k, side)
            if one.lacks > TOLD * one.top and one.lacks > MATTERS * found.largest_tension:
                cases.append(one)
    if cases:
        one = max(cases, key=lambda case: case.lacks)
        text = f"the rope begins slack at {scene.path[one.span + one.side].name}. {_told(scene, one)}"
        yield "mesh.elements_per_span", text


def _at_rest(found: Estimate, k: int, side: int) -> Lack:
    """What lacks at the top of a span that hangs with its share of what is too long of the rope, at rest.

    The lowest element bears nothing, or next to it, where the rope turns round in it. A rope that hangs steep, and not
    plumb, is a polygon there: what its foot takes off is then less than that of a catenary, by some share.
    """
    scene, path = found.scene, found.path
    ends, distance = path.tangents[k][[side, 1 - side]], path.spans[k].length
    up = -np.array(scene.gravity, float)
    size = float(np.linalg.norm(up))
    rise = float((ends[1] - ends[0]) @ up) / size
    across = float(np.linalg.norm(ends[1] - ends[0] - rise * up / size))
    surplus = (float(scene.rope.length or 0.0) / float(path.chords.sum()) - 1.0) * float(path.chords[k])
    length = distance + surplus
    parts = np.linspace(ends[0, 2], ends[1, 2], 2 * PARTS + 1)[1::2]
    mean, low = float(_net_weight(scene, parts).mean()), float(_net_weight(scene, ends[0, 2]))
    if rise <= 0.0 or mean <= 0.0 or low <= 0.0:
        return Lack(k, side, 0.0, 1.0)
    half = 0.5 * low * length / scene.elements[k] * rise / distance
    foot = foot_of_catenary(across, rise, length, mean, scene.rope.axial_stiffness)
    top = mean * rise + foot
    if across > PLUMB * rise:
        return Lack(k, side, half - foot, top, at_least=True, most=half)
    return Lack(k, side, half - foot * low / mean, top, spare=foot * low / mean)


def _told(scene: CraneScene, one: Lack) -> str:
    """What a slack foot makes of the tension at the top of a span, and the cure.

    Half the weight of an element goes as one over the elements; what is too long of the rope stays.
    """
    k, elements = one.span, scene.elements[one.span]
    lower, upper = scene.path[k + one.side].name, scene.path[k + 1 - one.side].name
    most = max(one.most, one.lacks + one.spare)
    enough = max(elements + 1, math.ceil(elements * most / (TOLD * one.top + one.spare) * (1.0 - ROUNDING)))
    about = "at least" if one.at_least else "about"
    return (
        f"The lowest element then gives half of its weight to {lower}. Of a real rope that hangs from {upper}: the "
        f"tension there is {about} {sized(one.lacks, 'N')} too low, {100.0 * one.lacks / one.top:.2g} % of it. Take "
        f"{enough} elements or more for that span, which has {elements}"
    )


def _sentence(scene: CraneScene, one: Lack, during: np.ndarray) -> str:
    lower = scene.path[one.span + one.side].name
    return (
        f"the rope hangs slack at {lower} from t = {during[0]:.4g} s to {during[1]:.4g} s. "
        f"{_told(scene, one)} (mesh.elements_per_span)"
    )
