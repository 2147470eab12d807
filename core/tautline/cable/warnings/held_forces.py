"""Forces that do nothing, as the node on which they act is held along them."""

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
