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
from crane.assembly.layout import Layout
from crane.assembly.loads import buoyancy_of, displacement_of, pull, wet_share
from crane.groups.immersion import EDGE
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene
from crane.sea.waves import waves_of
from tautline.results.variable import at_start
from tautline.scene.solver import step_taken
from tautline.scene.values.printed import rounded
from tautline.scene.values.ranges import sized

CURE = "Give {name} a `height`, with `bottom`: water then acts on what of that is under water"

OTHERWISE = 0.1
"""Share of a height by which it is more or less under water from which that is told."""
FEWEST_FALLS = 0.3
"""Upward pull on a load of a tension of 1 N, N, below which it does not hang on the rope."""
OUT = 0.01
"""Height above the surface, m, from which something is out of the water: below it lie rounding, and rest at it."""


def feels_water(body: Body) -> bool:
    """Whether water acts on a body at any height: on one with a `height` it acts where there is water."""
    return body.height is None and _meets_water(body)


def _meets_water(body: Body) -> bool:
    return body.volume > 0.0 or any((*body.added_mass, *body.drag.linear, *body.drag.quadratic))


def _height(scene: CraneScene, z: Any) -> np.ndarray:
    """How far something at heights, m, is above the surface, m; nan without water."""
    return np.asarray(z, float) - (np.nan if scene.water is None else scene.water.surface)


def dipped(scene: CraneScene) -> Iterator[tuple[int, Body]]:
    """Numbers and bodies on which water acts and which begin in it; of those drawn above it the scene is warned."""
    for k, body in enumerate(scene.bodies):
        if (feels_water(body) or feels_water(body.after_release())) and _height(scene, body.position[2]) <= OUT:
            yield k, body


def dry(scene: CraneScene) -> Iterator[tuple[str, str]]:
    """Key and text of bodies that the water acts on as if they were in it, and that are drawn above it."""
    for k, body in enumerate(scene.bodies):
        height = float(_height(scene, body.position[2]))
        if feels_water(body) and height > OUT:
            text = (
                f"{body.name} is drawn {height:.3g} m above the water. Buoyancy, drag "
                f"and added mass act on a body at any height. {CURE.format(name=body.name)}"
            )
            yield f"bodies[{k}]", text


def hoisted_out(found: Estimate) -> Iterator[tuple[str, str]]:
    """Key and text of the one body that winches hoist out of the water, by the rope that they take in."""
    hoist = _hoist(found.scene)
    if hoist is not None:
        k, begin, rise = hoist
        body = found.scene.bodies[k]
        about = f"{body.name} is hoisted by {rise:.4g} m, out of the water at about t = {begin:.3g} s"
        yield f"bodies[{k}]", f"{about}. {_told(found.scene, _on_hook(body, begin))}"


def _hoist(scene: CraneScene) -> tuple[int, float, float] | None:
    """Number of the one body that winches hoist out of the water, when, s, and by how much in all, m; or None."""
    loose, wet = hoisted_spans(scene), list(dipped(scene))
    if not loose or len(scene.bodies) != 1 or not wet:
        return None
    _, time, taken = reeled_of(scene)
    (k, body), rise = wet[0], taken / len(loose)
    out = _wrong(body, time, _height(scene, body.position[2] + rise))
    return (k, float(time[np.argmax(out)]), float(rise.max())) if out.any() else None


def _wrong(body: Body, time: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Whether water acts on a body that is out of it, (n,), at times, (n,) s, by its heights, (n,) m."""
    let_go = np.zeros(time.shape, bool) if body.release is None else time >= body.release.at
    acts: np.ndarray = np.where(let_go, feels_water(body.after_release()), feels_water(body))
    return acts & (height > OUT)


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
        out = _wrong(body, time, height)
        if out.any():
            begin = float(time[np.argmax(out)])
            told.append(
                f"{body.name} comes out of the water, first at t = {begin:.4g} s, and is up to "
                f"{float(height[out].max()):.3g} m above the surface{_behind(scene, _on_hook(body, begin))}"
            )
    return told


def taken_off_the_water(result: Any, layout: Layout) -> np.ndarray | None:
    """By how much more than at the start of a run its rope would carry at rest, the load being where it is, N.

    Still water lifts it there: what waves do beyond that is no rest.

    Parameters
    ----------
    result : Result
        With the places of bodies.

    Returns
    -------
    array (m, 1) or None
        The same all along the rope; None where no one load with a height hangs on it.
    """
    scene = layout.scene
    hung = pull(scene, layout.path)
    if scene.water is None or len(hung) != 1 or "body_position" not in result:
        return None
    (name, force) = next(iter(hung.items()))
    body, falls = scene.body(name), abs(float(force[2]))
    if body.height is None or body.volume == 0.0 or falls < FEWEST_FALLS:
        return None
    k = scene.bodies.index(body)
    then, begun = np.asarray(result["body_position"])[:, k, 2], float(at_start(result, "body_position")[k, 2])
    shares = _shares(scene, body, np.append(begun, then))
    less = displacement_of(scene, body) * float(np.linalg.norm(scene.gravity)) / falls * (shares[0] - shares[1:])
    return np.asarray(less[:, None])


def comes_through(result: Any, scene: CraneScene) -> bool:
    """Whether still water would lift a body with a height otherwise at some time of a run than at its start."""
    if scene.water is None or "body_position" not in result:
        return False
    places, begun = np.asarray(result["body_position"]), at_start(result, "body_position")
    for k, body in enumerate(scene.bodies):
        z = np.append(begun[k, 2], places[:, k, 2])
        if body.height is not None and body.volume > 0.0 and float(np.ptp(_shares(scene, body, z))) > OTHERWISE:
            return True
    return False


def _shares(scene: CraneScene, body: Body, z: Any) -> np.ndarray:
    """Shares of a body's height below the level of the water, by heights of its position, m."""
    assert body.height is not None
    return np.asarray(np.clip((body.bottom - _height(scene, z)) / body.height, 0.0, 1.0))


def at_the_surface(found: Estimate) -> Iterator[tuple[str, str]]:
    """Keys and texts of bodies with a height that pass the surface: in a sea, and in too few steps."""
    scene = found.scene
    spans = hoisted_spans(scene)
    _, time, taken = reeled_of(scene)
    way, waves = np.array([0.0]) if not spans else taken / len(spans), waves_of(scene)
    for k, body in enumerate(scene.bodies):
        if body.height is None:
            continue
        lows = _height(scene, body.lowest + way)
        # Where waves reach it as well.
        crest = 0.0 if waves is None else waves.highest()
        # Samples may be further apart than a thin body is high: from one to the next it passes all between them.
        pairs = np.stack((lows, np.append(lows[1:], lows[-1])))
        passes = (pairs.min(axis=0) < crest) & (pairs.max(axis=0) > -body.height - crest)
        if not passes.any():
            continue
        deepest = wet_share(scene, body, body.position[2] + float(way.min())) * displacement_of(scene, body)
        if buoyancy_of(scene, body) < body.mass < deepest:
            text = (
                f"{body.name} floats up as the winch lowers it: it takes the place of {deepest:.4g} kg of water, and "
                f"has {body.mass:.4g} kg. Its rope goes slack. Give it less volume or more mass"
            )
            yield f"bodies[{k}]", text
        if waves is None and scene.vessel is not None and scene.vessel.sea is not None:
            text = (
                f"{body.name} is in the water's surface, and the surface stays level here: the sea moves the vessel "
                "only. Waves load such a body, and often decide whether it may be lifted. Give `water:` the waves: "
                "{elevation: vessel}"
            )
            yield f"bodies[{k}]", text
        speed = float(np.abs(np.diff(way) / np.diff(time))[passes[:-1]].max(initial=0.0)) if way.size > 1 else 0.0
        speed += 0.0 if waves is None else waves.fastest()
        step = step_taken(scene.solver, scene.output.interval)
        if not scene.controlled and speed * step > EDGE * body.height:
            enough = rounded(EDGE * body.height / speed, 1)
            text = (
                f"{step:.3g} s is long for {body.name}, which passes the surface with up to {speed:.3g} m/s: water "
                f"takes hold of it within {EDGE:.0%} of its height. Take {enough:g} s or less"
            )
            yield "solver.step", text


def heights_of(scene: CraneScene) -> dict[str, dict[str, str]]:
    """Name of each body that may come out of the water -> what a sweep is asked for: its largest height."""
    made = {body.name: f"{body.name}.position[2]" for _, body in dipped(scene)}
    return {name: {"output": output, "statistic": "max", "name": f"{output} max"} for name, output in made.items()}


def out_of_water_in_storms(
    data: Any, columns: Mapping[str, Mapping[str, str]], scene: CraneScene, begin: float
) -> list[str]:
    """Sentences on bodies that storms lift out of the water.

    Parameters
    ----------
    data : Dataset
        Of the sweep.
    columns : mapping
        As `heights_of` has them.
    scene : CraneScene
        Of a storm, with its end.
    begin : float
        From when on a storm counts, s.
    """
    told = []
    for name, column in columns.items():
        body = _in_storm(scene.body(name), begin, scene.solver.end)
        if column["name"] not in data or not feels_water(body):
            continue
        height = _height(scene, np.asarray(data[column["name"]].values, float))
        storms = int((height > OUT).sum())
        if storms:
            told.append(
                f"{name} comes out of the water in {storms} of {int(np.isfinite(height).sum())} storms, up to "
                f"{float(np.nanmax(height)):.3g} m above the surface{_behind(scene, body)}"
            )
    return told


def _in_storm(body: Body, begin: float, end: float) -> Body:
    """What of a body water acts on for as long as a storm counts, s.

    Of one that is let go meanwhile it is what remains: the largest height of a storm does not tell when it was reached.
    """
    if body.release is None or body.release.at > end or (body.release.at > begin and not feels_water(body)):
        return body
    return body.after_release()


def _on_hook(body: Body, time: float) -> Body:
    """What of a body is there at a time, s."""
    return body.after_release() if body.release is not None and time >= body.release.at else body


def _behind(scene: CraneScene, body: Body) -> str:
    """The end of a sentence on what came: what it hides, and the cure where no warning of the scene has told it."""
    if _hoist(scene) is None:
        return f". {_told(scene, body)}"
    lifted = _lifted(scene, body)
    hidden = f": {sized(lifted, 'N')} of buoyancy are taken off its weight there" if lifted > 0.0 else ""
    return f"{hidden}. The scene's own warning says what to do"


def _lifted(scene: CraneScene, body: Body) -> float:
    """Buoyancy of a body, N."""
    return buoyancy_of(scene, body) * float(np.linalg.norm(scene.gravity))


def _told(scene: CraneScene, body: Body) -> str:
    """What is wrong from then on, and the cure."""
    lifted = _lifted(scene, body)
    acts = "Buoyancy, drag and added mass act on a body at any height"
    if lifted > 0.0:
        acts += (
            f": {sized(lifted, 'N')} of buoyancy are taken off its weight in air, too. Tensions and amplification are "
            "too low there, and safety factors too high"
        )
    return f"{acts}. {CURE.format(name=body.name)}"
