"""Rope that is slack at its foot, of which the mesh hangs a part on the foot.

A straight element hangs half of its weight on either end. Where the lowest element of a span is slack, or pulls with
less than that half, the foot would have to push: in truth all of that weight hangs from above. The tension at the top
is too low by it, and what is at the foot carries it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import carries_nothing, stands
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


def slack_feet(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on spans whose foot stays slack while they hang from above, one for each.

    Parameters
    ----------
    result : Result
        Of one that keeps statistics nothing is told: they do not say what was at the same time.
    scene : CraneScene
    """
    if scene.output.statistics or not any(scene.gravity) or any(name not in result for name in FIELDS):
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
        lacks = np.zeros(time.size)
        lacks[frames] = _lacking(result, scene, foot, frames)
        top = tension[:, foot.span, 1 - foot.side] + lacks
        begin, end = _longest(time, (lacks > TOLD * top) & (lacks > MATTERS * largest))
        if end > begin and time[end] - time[begin] >= min(LASTS, float(time[-1] - time[0])):
            found.append(_sentence(scene, foot, time[[begin, end]], lacks[begin : end + 1], top[begin : end + 1]))
    return found


def _feet(scene: CraneScene) -> list[Foot]:
    """Both ends of every span: which of them is the foot shows when the rope rises from it."""
    nodes = nodes_of(scene)
    feet = []
    for k in range(len(scene.path) - 1):
        first, last = int(nodes[k]), int(nodes[k + 1])
        feet += [Foot(k, 0, first, first, first + 1), Foot(k, 1, last - 1, last, last - 1)]
    return feet


def _lacking(result: Any, scene: CraneScene, foot: Foot, frames: np.ndarray) -> np.ndarray:
    """What a foot would have to push with at frames to bear its half of the element's weight, N."""
    position = np.asarray(result["position"])
    low, high = position[frames, foot.low], position[frames, foot.high]
    material = np.asarray(result["material_coordinate"])
    length = np.abs(material[frames, foot.high] - material[frames, foot.low])
    way = high - low
    up = -np.array(scene.gravity, float)
    size = float(np.linalg.norm(up))
    rises = way @ (up / size) / np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)
    weight = _net_weight(scene, 0.5 * (low[:, 2] + high[:, 2]))
    force = np.asarray(result["axial_force"])[frames, foot.element]
    return np.maximum(0.5 * weight * length * np.maximum(rises, 0.0) - np.maximum(force, 0.0), 0.0)


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
    if length is None or length <= float(path.chords.sum()) or not any(scene.gravity):
        return
    standing = {body.name for body in scene.bodies if stands(scene, body)}
    cases = []
    for k, elements in enumerate(scene.elements):
        heights = path.tangents[k] @ -np.array(scene.gravity, float)
        side = int(heights[1] < heights[0])
        foot, ends = scene.path[k + side], path.tangents[k][[side, 1 - side]]
        if getattr(foot, "body", None) in standing or (isinstance(foot, Anchor) and carries_nothing(scene)):
            rise = abs(float(np.diff(heights)[0])) / float(np.linalg.norm(scene.gravity))
            parts = np.linspace(ends[0, 2], ends[1, 2], 2 * PARTS + 1)[1::2]
            top, half = rise * float(_net_weight(scene, parts).mean()), 0.5 * rise / elements
            lacks = half * float(_net_weight(scene, ends[0, 2])) - _least(found, k)
            if lacks > TOLD * top and lacks > MATTERS * found.largest_tension:
                cases.append((lacks, top, k, side))
    if cases:
        lacks, top, k, side = max(cases)
        text = f"the rope begins slack at {scene.path[k + side].name}. {_lack(scene, k, side, lacks, top)}"
        yield "mesh.elements_per_span", text


def _least(found: Estimate, k: int) -> float:
    """Tension at rest of a span of a rope between fixed places, where it is least, N; 0 over a load that stands."""
    if found.tension is None or not carries_nothing(found.scene):
        return 0.0
    return float(found.tension[k].min())


def _lack(scene: CraneScene, k: int, side: int, lacks: float, top: float) -> str:
    """What a slack foot makes of the tension at the top of a span, and the cure: it goes as one over the elements."""
    lower, upper, elements = scene.path[k + side].name, scene.path[k + 1 - side].name, scene.elements[k]
    enough = max(elements + 1, math.ceil(elements * lacks / (TOLD * top) * (1.0 - ROUNDING)))
    return (
        f"The lowest element then gives half of its weight to {lower}. Of a real rope all of that hangs from {upper}: "
        f"the tension there is about {sized(lacks, 'N')} too low, {100.0 * lacks / top:.2g} % of it. Take {enough} "
        f"elements or more for that span, which has {elements}"
    )


def _sentence(scene: CraneScene, foot: Foot, during: np.ndarray, lacks: np.ndarray, top: np.ndarray) -> str:
    k = int(np.argmax(lacks))
    lower = scene.path[foot.span + foot.side].name
    return (
        f"the rope hangs slack at {lower} from t = {during[0]:.4g} s to {during[1]:.4g} s. "
        f"{_lack(scene, foot.span, foot.side, float(lacks[k]), float(top[k]))} (mesh.elements_per_span)"
    )
