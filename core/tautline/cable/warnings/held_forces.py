"""Forces, masses and springs that do nothing, as the node that has them is held."""

from __future__ import annotations

from collections.abc import Iterator

from tautline.cable.input.parts import CableScene, Place
from tautline.scene.warnings import warning


@warning("cable")
def _held(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Of each item the first such node: along some axes only, a held node is a support that meets a load."""
    held = {node.id: node.held[:3] for node in scene.nodes} if scene.forces else {}
    for part in scene.forces:
        force = part.model.force
        along = [axis for axis, size in enumerate(force) if size != 0.0]
        lost = [node for node in part.nodes if along and all(held[node][axis] for axis in along)]
        if lost:
            axes = " and ".join("xyz"[axis] for axis in along)
            text = (
                f"node {lost[0]} is held along {axes} (BC): the force moves nothing there, and appears in no result. "
                "Free the node along the force, or name the node that is meant"
            )
            yield (*part.place, "force"), text


@warning("cable")
def _still(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Of each mass and each spring to the ground the first node that nothing moves: one that follows a function has
    inertia."""
    still = {node.id for node in scene.nodes if all(node.held[:3]) and not any(node.functions[:3])}
    for what, key, parts in (("mass", "mass", scene.masses), ("spring", "nodes7", scene.anchors)):
        for part in parts:
            lost = [node for node in part.nodes if node in still]
            if lost:
                text = (
                    f"the place of node {lost[0]} is held (BC): the {what} does nothing there, and appears in no "
                    "result. Free the node, or name the node that is meant"
                )
                yield (*part.place, key if getattr(part.model, key, None) is not None else "nodes4"), text
