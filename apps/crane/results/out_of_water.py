"""Bodies that come out of the water and are computed as if they were still in it: foreseen, in a run, and in storms.

Buoyancy, drag and added mass act on a body at any height. In air its rope bears all of its weight, and the equations
take the buoyancy off: tension and amplification come out too low, and a safety factor too high.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from crane.assembly.drum_supply import hoisted_spans, reeled_of
from crane.assembly.estimates import Estimate
from crane.assembly.loads import buoyancy_of
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene
from tautline.scene.values.ranges import sized

CURE = (
    "Judge what is in air by a scene of its own, without volume, drag and added_mass of {name}. The way through the "
    "surface is not covered"
)


def feels_water(body: Body) -> bool:
    """Whether water acts on a body, at any height."""
    return body.volume > 0.0 or any((*body.added_mass, *body.drag.linear, *body.drag.quadratic))


def _height(scene: CraneScene, z: Any) -> np.ndarray:
    """How far something at heights, m, is above the surface, m; nan without water."""
    return np.asarray(z, float) - (np.nan if scene.water is None else scene.water.surface)


def dipped(scene: CraneScene) -> Iterator[tuple[int, Body]]:
    """Numbers and bodies on which water acts and which begin in it; of those drawn above it the scene is warned."""
    for k, body in enumerate(scene.bodies):
        if (feels_water(body) or feels_water(body.after_release())) and _height(scene, body.position[2]) <= 0.0:
            yield k, body


def dry(scene: CraneScene) -> Iterator[tuple[str, str]]:
    """Key and text of bodies that the water acts on as if they were in it, and that are drawn above it."""
    for k, body in enumerate(scene.bodies):
        height = float(_height(scene, body.position[2]))
        if feels_water(body) and height > 0.0:
            text = (
                f"{body.name} is drawn {height:.3g} m above the water. Buoyancy, drag "
                "and added mass act on a body at any height. Leave them out while it is in air"
            )
            yield f"bodies[{k}]", text


def hoisted_out(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of the one body that winches hoist out of the water, by the rope that they take in."""
    scene, wet = found.scene, list(dipped(found.scene))
    loose = hoisted_spans(scene)
    if not loose or len(scene.bodies) != 1 or not wet:
        return
    _, time, taken = reeled_of(scene)
    (k, body), rise = wet[0], taken / len(loose)
    height = _height(scene, body.position[2] + rise)
    out = height > 0.0
    if out.any():
        left, begin = _on_hook(body, float(time[np.argmax(out)])), float(time[np.argmax(out)])
        if feels_water(left):
            about = f"{body.name} is hoisted by {float(rise.max()):.4g} m, out of the water at about t = {begin:.3g} s"
            yield f"bodies[{k}]", f"{about}. {_told(scene, left)}"


def out_of_water(result: Any, scene: CraneScene) -> list[str]:
    """Sentences on bodies that rise above the surface in a run.

    Parameters
    ----------
    result : Result
        Of one that keeps statistics the largest height of its windows counts.
    """
    if scene.water is None or "body_position" not in result:
        return []
    time, places, told = np.asarray(result.time), np.asarray(result["body_position"]), []
    for k, body in dipped(scene):
        height = _height(scene, places[:, k, 2])
        out = height > 0.0
        if not out.any():
            continue
        begin = float(time[np.argmax(out)])
        left = _on_hook(body, begin)
        if feels_water(left):
            told.append(
                f"{body.name} comes out of the water, first at t = {begin:.4g} s, and is up to "
                f"{float(height.max()):.3g} m above the surface. {_told(scene, left)}"
            )
    return told


def heights_of(scene: CraneScene) -> dict[str, dict[str, str]]:
    """Name of each body that may come out of the water -> what a sweep is asked for: its largest height."""
    made = {body.name: f"{body.name}.position[2]" for _, body in dipped(scene)}
    return {name: {"output": output, "statistic": "max", "name": f"{output} max"} for name, output in made.items()}


def out_of_water_in_storms(data: Any, columns: Mapping[str, Mapping[str, str]], scene: CraneScene) -> list[str]:
    """Sentences on bodies that storms lift out of the water; `columns` are those of `heights_of`."""
    told = []
    for name, column in columns.items():
        if column["name"] not in data:
            continue
        height = _height(scene, np.asarray(data[column["name"]].values, float))
        storms = int((height > 0.0).sum())
        if storms:
            told.append(
                f"{name} comes out of the water in {storms} of {int(np.isfinite(height).sum())} storms, up to "
                f"{float(np.nanmax(height)):.3g} m above the surface. {_told(scene, scene.body(name))}"
            )
    return told


def _on_hook(body: Body, time: float) -> Body:
    """What of a body is there at a time, s."""
    return body.after_release() if body.release is not None and time >= body.release.at else body


def _told(scene: CraneScene, body: Body) -> str:
    """What is wrong from then on, and the cure."""
    lifted = buoyancy_of(scene, body) * float(np.linalg.norm(scene.gravity))
    acts = "Buoyancy, drag and added mass act on a body at any height"
    if lifted > 0.0:
        acts += (
            f": {sized(lifted, 'N')} of buoyancy are taken off its weight in air, too. Tensions and amplification are "
            "too low there, and safety factors too high"
        )
    return f"{acts}. {CURE.format(name=body.name)}"
