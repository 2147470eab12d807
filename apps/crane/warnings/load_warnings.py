"""What to tell of loads before a run: those that float, overturn or lie, and what a release leaves on the hook."""

from __future__ import annotations

import math
from collections.abc import Iterator

from crane.assembly.estimates import Estimate
from crane.assembly.layout import orientation_of
from crane.assembly.loads import displacement_of, floating, rises
from crane.geometry.quaternion import quaternion_of
from crane.scene.scene import CraneScene

ANOTHER_SIDE = 90.0
"""Angle, deg, by which a body is turned from its drawing beyond which another side of it is up."""
TOO_FAST = 1000.0
"""Swing of what remains of a load over that of the whole, as sqrt(mass), from which steps may not follow it."""
Sentences = Iterator[tuple[str, str]]
"""Keys and texts of warnings."""


def load_warnings(found: Estimate) -> Sentences:
    """Keys and texts of what is doubtful of a scene's bodies."""
    scene = found.scene
    yield from _floating(found)
    yield from _stays_on_the_hook(scene)
    yield from _turned(scene)
    yield from _without_moment(scene)


def _floating(found: Estimate) -> Sentences:
    """Bodies that do not pull on the rope that they hang on."""
    scene = found.scene
    for one in floating(scene, found.path):
        name, cure = scene.bodies[one.body].name, f"{one.cure[0].upper()}{one.cure[1:]}"
        if one.tall:
            yield (
                f"bodies[{one.body}]",
                f"{name} floats in the surface, and its rope goes slack: {one.cause(name)}. {cure}",
            )
            continue
        if one.by_rope is None and scene.start == "static" and scene.rope.length is not None:
            text = (
                f"{name} floats at any height: {one.cause(name)}. It is drawn below what its rope leads to, and begins "
                f"above that, as a buoy that its rope holds down. Draw it there. Or, if it is to hang, {one.cure}"
            )
        else:
            what, at = ("", ", at any height") if one.by_rope is None else (" up with its rope", "")
            text = f"{name} floats{what}: {one.cause(name)}{at}. Its rope goes slack. {cure}"
        yield f"bodies[{one.body}]", text


def _stays_on_the_hook(scene: CraneScene) -> Sentences:
    """Bodies that lose mass and keep what inertia, water, wind and ground have found of all of it."""
    for k, body in enumerate(scene.bodies):
        release = body.release
        if release is None:
            continue
        if body.inertia is not None and release.inertia is None:
            text = (
                f"{body.name} keeps the moments of inertia of all its {body.mass:.4g} kg when "
                f"{release.remaining:.4g} kg of it remain. It then turns too slowly. Give `inertia:` in release, "
                "with the moments that remain"
            )
            yield f"bodies[{k}].release", text
        has = {
            "volume": body.volume > 0.0,
            "added_mass": any(body.added_mass),
            "drag": any((*body.drag.linear, *body.drag.quadratic)),
            "force": body.force is not None,
            "bottom": body.bottom > 0.0,
            "height": body.height is not None,
        }
        stay = [key for key, some in has.items() if some and getattr(release, key) is None]
        if stay:
            keys = " and ".join(filter(None, (", ".join(f"`{key}`" for key in stay[:-1]), f"`{stay[-1]}`")))
            text = (
                f"{body.name} keeps all its {keys} when {release.remaining:.4g} kg of {body.mass:.4g} kg remain, as if "
                f"the load that drops left them on the hook. Give {keys} in release, as "
                f"{'it is' if len(stay) == 1 else 'they are'} of what remains: zero where nothing does"
            )
            yield f"bodies[{k}].release", text
        yield from _floats_after(scene, k)
        yield from _thrown(scene, k)


def _thrown(scene: CraneScene, k: int) -> Sentences:
    """A body that turns and of which so little remains that no step follows the rope that throws it."""
    body, left = scene.bodies[k], scene.bodies[k].after_release()
    faster = math.sqrt(body.mass / left.mass) if left.mass > 0.0 else 0.0
    if body.inertia is not None and faster > TOO_FAST:
        text = (
            f"{left.mass:.4g} kg remain of {body.mass:.4g} kg of {body.name}, which turns. On the same rope they swing "
            f"{faster:.2g} times as fast as the whole, and the run may stop there. Give the mass of hook and shackle"
        )
        yield f"bodies[{k}].release.remaining", text


def _floats_after(scene: CraneScene, k: int) -> Sentences:
    """A body that the water lifts once its load has dropped."""
    body, left = scene.bodies[k], scene.bodies[k].after_release()
    # What has a height may be let go in air.
    deep = left.height is None or (scene.water is not None and left.lowest < scene.water.surface)
    lifted = displacement_of(scene, left)
    if deep and lifted > left.mass and displacement_of(scene, body) <= body.mass:
        text = (
            f"{body.name} floats up when its load has dropped: it takes the place of {lifted:.4g} kg of water, and "
            f"{left.mass:.4g} kg of it remain. Give `volume:` in release, with that of what remains"
        )
        yield f"bodies[{k}].release", text


def _turned(scene: CraneScene) -> Sentences:
    """Bodies that the static start turns upside down: hung below their centre, or buoys held down above it."""
    for k, body in enumerate(scene.bodies):
        if body.inertia is None:
            continue
        drawn, laid = quaternion_of(body.orientation), orientation_of(scene, body)
        angle = 2.0 * math.degrees(math.acos(min(1.0, abs(float(drawn @ laid)))))
        if angle > ANOTHER_SIDE:
            side, other = ("above", "below") if rises(scene, body) else ("below", "above")
            text = (
                f"start: static turns {body.name} by {angle:.3g} deg, because the rope holds it {side} its centre of "
                f"mass. Give the `end` an offset {other} the centre, or give the body an `orientation:`, or write "
                "start: as drawn"
            )
            yield f"bodies[{k}]", text


def _without_moment(scene: CraneScene) -> Sentences:
    """Bodies that turn, and may meet the ground, which does not resist that."""
    for k, body in enumerate(scene.bodies if scene.ground is not None else ()):
        if body.inertia is not None:
            text = (
                f"the ground pushes at the centre of {body.name} and gives it no moment. There it turns freely: it "
                f"neither tips over an edge nor lies flat, and `bottom` stays {body.bottom:.4g} m below its centre. "
                "Forces of lift-off and landing are right only if the rope pulls through the centre. Remove `inertia:` "
                "if its rotation does not matter"
            )
            yield f"bodies[{k}].inertia", text
