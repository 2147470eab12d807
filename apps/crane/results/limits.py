"""What a crane's run is judged by: the rope's strength, strain and bending, and the angles that it runs at."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crane.results.angles import hook_span
from crane.results.course import nodes_of
from crane.results.summary import ends_of, size_of_angles, span_ends
from crane.scene.path import DRUM_FLEET_LIMIT, Drum, Sheave
from crane.scene.scene import CraneScene
from crane.scene.strength import strain_bound
from tautline.results.assessment.limits import AT_LEAST, judged, strain_limit, stretch_limits

LEAST_RATIO = 16.0
"""Sheave over rope diameter below which bending wears a wire rope out quickly; codes ask for 16 to 25 (ISO 16625)."""
SIDELEAD = math.radians(5.0)
"""Angle of the hook's rope out of the plane of its sheave. Booms are rated for a few degrees."""

Records = Iterator[dict[str, Any]]


def limits(result: Any, scene: CraneScene) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames."""
    return [*_strength(result, scene), *_strain(result, scene), *_angles(result, scene), *_bending(result, scene)]


def _strength(result: Any, scene: CraneScene) -> Records:
    """The rope's breaking load."""
    if scene.rope.breaking_load is None:
        return
    text = "largest tension, and the breaking load"
    yield judged("breaking_load", text, "N", result.time, ends_of(result), scene.rope.breaking_load, span_ends(scene))


def _strain(result: Any, scene: CraneScene) -> Records:
    """Strain of the rope where it is taut, and how far its elements fold or stretch between wheels."""
    spans = [
        f"{one.name} to {two.name}"
        for one, two, n in zip(scene.path[:-1], scene.path[1:], scene.elements, strict=True)
        for _ in range(n)
    ]
    force = np.asarray(result["axial_force"])
    yield from strain_limit(result.time, force / scene.rope.axial_stiffness, strain_bound(scene), spans)
    on_wheel = np.zeros(force.shape[1] + 1, bool)
    wheels = [isinstance(item, (Drum, Sheave)) for item in scene.path]
    on_wheel[np.asarray(nodes_of(scene))[wheels]] = True
    # Beside a wheel the rope does not run to the node, which is the wheel's centre.
    free = np.flatnonzero(~(on_wheel[1:] | on_wheel[:-1]))
    length = np.linalg.norm(np.diff(result["position"], axis=1)[:, free], axis=-1)
    material = np.abs(np.diff(result["material_coordinate"], axis=1)[:, free])
    stretch = length / np.maximum(material, 1e-12)
    yield from stretch_limits(result.time, stretch, [spans[k] for k in free])


def _angles(result: Any, scene: CraneScene) -> Records:
    """Fleet angles at sheaves and drums, and sidelead."""
    if scene.sheaves:
        size = size_of_angles(result["fleet_angle"]).max(axis=-1)
        bounds = np.array([sheave.fleet_limit for sheave in scene.sheaves])
        names = [sheave.name for sheave in scene.sheaves]
        yield judged("fleet_angle", "largest fleet angle at a sheave", "rad", result.time, size, bounds, names)
    if scene.drums:
        names, angle = [drum.name for drum in scene.drums], size_of_angles(result["drum_fleet_angle"])
        text = "largest fleet angle at a drum"
        yield judged("drum_fleet_angle", text, "rad", result.time, angle, DRUM_FLEET_LIMIT, names)
    hung = hook_span(scene)
    if hung is not None and "sidelead" in result:
        side, place = size_of_angles(result["sidelead"])[:, None], scene.path[hung[0]].name
        yield judged("sidelead", "largest sidelead of the hook rope", "rad", result.time, side, SIDELEAD, [place])


def _bending(result: Any, scene: CraneScene) -> Records:
    """Wheels small for their rope."""
    wheels = [item for item in scene.path if isinstance(item, (Drum, Sheave))]
    if scene.rope.diameter is None or not wheels:
        return
    ratio = np.array([[2.0 * item.radius / scene.rope.diameter for item in wheels]])
    names, text = [item.name for item in wheels], "smallest D/d of sheaves and drums"
    # It is the same at all times.
    yield judged("bending_ratio", text, "", result.time[:1], ratio, LEAST_RATIO, names, AT_LEAST) | {"time": None}
