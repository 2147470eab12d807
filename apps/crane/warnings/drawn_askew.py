"""Loads that are drawn beside their rope: the static start hangs them plumb, far from where they are drawn."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import TOUCHES
from crane.assembly.loads import rises
from crane.geometry.tangents import beside
from crane.scene.scene import CraneScene, Drum, End, Sheave
from tautline.results.assessment.start import FAR
from tautline.scene.values.ranges import sized


def drawn_askew(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of each load that hangs by one end from a fixed place, and is drawn far from the plumb line there.

    A run says the same after it has moved the load: of a length of a tenth of the scene, as here.
    """
    scene = found.scene
    g = np.array(scene.gravity, float)
    weight = float(np.linalg.norm(g))
    if scene.start != "static" or weight == 0.0:
        return
    down = g / weight
    places = np.array([*found.path.tangents.reshape(-1, 3), *(body.position for body in scene.bodies)])
    size = float(np.ptp(places, axis=0).max())
    for k, body in enumerate(scene.bodies):
        ends = [i for i, item in enumerate(scene.path) if getattr(item, "body", None) == body.name]
        if len(ends) != 1 or not _hangs_free(scene, k, ends[0]):
            continue
        off = _off(found, ends[0], down)
        if off > FAR * size:
            above = scene.path[1 if ends[0] == 0 else ends[0] - 1].name
            text = (
                f"{body.name} is drawn {sized(float(f'{off:.3g}'), 'm')} beside the plumb line below {above}, and "
                "hangs from nothing else. start: static moves it there before the run begins. Draw it below, or write "
                "start: as drawn to let it swing from where it is"
            )
            yield f"bodies[{k}].position", text


def _hangs_free(scene: CraneScene, k: int, i: int) -> bool:
    """Whether a body hangs by item i of the path alone, from what does not ride on a body itself."""
    body, item = scene.bodies[k], scene.path[i]
    other = scene.path[1 if i == 0 else i - 1]
    held = body.spring is not None or body.guide or body.inertia is not None or body.force is not None
    free = isinstance(item, End) and getattr(other, "body", None) is None and not held and body.mass > 0.0
    grounded = scene.ground is not None and body.lowest <= scene.ground.level + TOUCHES
    return free and not grounded and not rises(scene, body)


def _off(found: Estimate, i: int, down: np.ndarray) -> float:
    """Distance of the load at end i of the path from where the rope would lead it plumb, m."""
    k, j = (0, 1) if i == 0 else (i - 1, i - 1)
    place, load = found.path.tangents[k][:: -1 if i == 0 else 1]
    other = found.scene.path[j]
    if isinstance(other, (Drum, Sheave)):
        # A rope that swings to plumb leaves its wheel elsewhere.
        axis, travel = np.array(other.unit_axis), -down if i == 0 else down
        side = int(found.path.sigma[j]) * (beside(travel, axis) - beside(found.path.spans[k].e, axis))
        place = place + other.radius * side
    led = load - place
    return float(np.linalg.norm(led - (led @ down) * down))
