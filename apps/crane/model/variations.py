"""How a crane's scene is varied for a study: finer or coarser spans, other stiffness, one span of very short elements.

Each function takes a validated scene and returns another, as it would be read from a file that says so; the scene given
stays as it is.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from crane.groups.span import MATERIAL
from crane.model.build import assembled
from crane.scene.consistency import MOST_ELEMENTS
from crane.scene.scene import Anchor, CraneScene, Drum, PathItem
from tautline.scene.reading.document import Path_
from tautline.study.robustness.bar import Bar

ORIGIN = "study"
"""What messages name in place of a line."""
MESH: Path_ = ("mesh", "elements_per_span")
ALONG = 1.0e-6
"""Cosine of the angle between span and axis below which the axis is across it."""
ALIKE = 1.0e-9
"""Relative difference of lengths below which two elements are alike."""


class Stretch(NamedTuple):
    """Unstretched rope of a span, m: laid on the wheels at both its ends and straight between; and the way it runs."""

    before: float
    straight: float
    after: float
    direction: np.ndarray

    def shortest(self, count: int) -> float:
        """Length of the shortest of so many elements, m: those at the ends have what lies on the wheels as well."""
        ends = min(self.before, self.after) if count == 2 else self.before + self.after if count == 1 else 0.0
        return self.straight / count + ends

    def lengths(self, count: int) -> np.ndarray:
        """Lengths of all elements, (count,) m."""
        made = np.full(count, self.straight / count)
        made[0] += self.before
        made[-1] += self.after
        return made


def elements(scene: CraneScene, factor: float) -> CraneScene | None:
    """Give every span ``factor`` times its elements, at least one; None if that changes nothing.

    Raises
    ------
    SceneError
        For more elements than a rope may have.
    """
    wanted = [max(1, math.floor(count * factor + 0.5)) for count in scene.elements]
    if wanted == list(scene.elements):
        return None
    each = isinstance(scene.mesh.elements_per_span, tuple)
    return scene.varied({MESH: wanted if each else wanted[0]}, ORIGIN)


def stiffness(scene: CraneScene, factor: float) -> CraneScene:
    """Axial and bending stiffness of the rope times ``factor``; raises SceneError where they are beyond all ropes."""
    keys = ("axial_stiffness", "bending_stiffness")
    return scene.varied({("rope", key): factor * getattr(scene.rope, key) for key in keys}, ORIGIN)


def contact(scene: CraneScene, value: float) -> CraneScene | None:
    """Stiffness of the ground and of springs that hold bodies, along the axes that they act on, N/m; None without."""
    values: dict[Path_, Any] = {} if scene.ground is None else {("ground", "stiffness"): value}
    for i, body in enumerate(scene.bodies):
        if body.spring is not None and any(body.spring.stiffness):
            values["bodies", i, "spring", "stiffness"] = [value if k > 0.0 else 0.0 for k in body.spring.stiffness]
    return scene.varied(values, ORIGIN) if values else None


def penalty(scene: CraneScene, value: float) -> None:
    """No constraint of a rope over sheaves is a spring: None."""
    return None


def shortest(scene: CraneScene, factor: float) -> CraneScene | None:
    """Divide one span so finely that an element is ``factor`` times shorter than the shortest.

    It is the span for which that takes the fewest elements, and where it takes more than a rope may have, as many as it
    may; None if it has those already.

    Raises
    ------
    SceneError
        As `stretches_of` does.
    """
    stretches, counts = stretches_of(scene), list(scene.elements)
    target = min(span.shortest(count) for span, count in zip(stretches, counts, strict=True)) / factor
    wanted = [_count_for(span, target) for span in stretches]
    k = min(range(len(counts)), key=lambda i: wanted[i] - counts[i])
    count = min(wanted[k], MOST_ELEMENTS - sum(counts) + counts[k])
    if count <= counts[k]:
        return None
    counts[k] = count
    return scene.varied({MESH: counts}, ORIGIN)


def constraints(scene: CraneScene) -> tuple[str, ...]:
    """Tell in which ways constraints can be imposed: the spans of a rope share their unknowns and have none."""
    return ()


def constraint(scene: CraneScene, name: str) -> None:
    """There is no choice: None."""
    return None


def stiffnesses(scene: CraneScene) -> dict[str, float | None]:
    """Largest stiffness of ground and springs that hold bodies, N/m; and of penalty constraints: there are none."""
    found = [k for body in scene.bodies if body.spring is not None for k in body.spring.stiffness if k > 0.0]
    found += [] if scene.ground is None else [scene.ground.stiffness]
    return {"contact": max(found, default=None), "penalty": None}


def bars(scene: CraneScene) -> list[Bar]:
    """Every unlike element of every span as the rope is laid out; at its ends with what lies on the wheels there.

    Raises
    ------
    SceneError
        As `stretches_of` does.
    """
    speed = scene.rope.wave_speed
    made: list[Bar] = []
    for i, (span, count) in enumerate(zip(stretches_of(scene), scene.elements, strict=True)):
        unlike: list[tuple[float, str]] = []
        for k, length in enumerate(span.lengths(count)):
            at = _moving_end(scene, i, k, span)
            if not any(abs(length - other) <= ALIKE * length and at == there for other, there in unlike):
                unlike.append((float(length), at))
        for length, at in unlike:
            where = f"span {scene.path[i].name} - {scene.path[i + 1].name}, element of {length:.4g} m"
            made.append(Bar(where + (f" at {at}" if at else ""), length, speed, "linear", bool(at)))
    return made


def stretches_of(scene: CraneScene) -> list[Stretch]:
    """Rope of every span as it is laid out at the start.

    Raises
    ------
    SceneError
        Where no rope can take the path, and for faults of files.
    """
    layout = assembled(scene).layout
    path, radius = layout.path, np.array(layout.wheels.radius)
    made = []
    for i, (first, last) in enumerate(layout.spans):
        before, after = radius[i] * path.after[i], -radius[i + 1] * path.before[i + 1]
        p = [float(layout.degrees.value[layout.station[k] + MATERIAL]) for k in (first, last)]
        unstretched = (p[1] - p[0]) / float(path.chords[i])
        laid = (float(x) * unstretched for x in (before, path.spans[i].length, after))
        made.append(Stretch(*laid, path.spans[i].e))
    return made


def _count_for(span: Stretch, target: float) -> int:
    """Fewest elements of a span one of which is no longer than a length, m."""
    count = max(1, math.ceil(span.straight / target * (1.0 - ALIKE)))
    while span.shortest(count) > target * (1.0 + ALIKE):
        count += 1
    return count


def _moving_end(scene: CraneScene, i: int, k: int, span: Stretch) -> str:
    """Name of the rope's end that element k of span i has and that may move along it; nothing where it has none."""
    first, last = i == k == 0, i == len(scene.path) - 2 and k == scene.elements[i] - 1
    ends = [scene.path[0]] * first + [scene.path[-1]] * last
    return next((end.name for end in ends if _moves(scene, end, span.direction)), "")


def _moves(scene: CraneScene, end: PathItem, direction: np.ndarray) -> bool:
    """Whether an end of the rope may move along a direction: with a body that hangs on it, or off a driven drum."""
    if isinstance(end, Drum):
        return not end.prescribed
    if isinstance(end, Anchor):
        return False
    guide = scene.body(end.body).guide
    return any(abs(x) > ALONG and axis not in guide for x, axis in zip(direction, "xyz", strict=True))
