"""Where things stand in a scene, as text for messages."""

from __future__ import annotations

from crane.scene.scene import CraneScene, PathItem


def where(scene: CraneScene, item: PathItem, key: str = "") -> str:
    """Key path of an item of the path, or of a key of it."""
    first, place, kind = scene.key_of(item)
    return f"{first}[{place}].{kind}" + (f".{key}" if key else "")
