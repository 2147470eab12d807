"""The option ``--map``: which sensor of a machine is what in the scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tautline.application.installed import refuse_scene
from tautline.scene.errors import SceneError, option_error

if TYPE_CHECKING:
    from tautline.twin.map.file import TwinMap


def read_sensors(path: Path) -> TwinMap:
    """The map of a twin; raises SceneError, for a scene in its place in one line."""
    from tautline.twin.map.file import read_map

    if not path.exists():
        raise option_error("--map", str(path), "there is no such file", "docs/twin.md has an example")
    try:
        return read_map(path)
    except SceneError:
        refuse_scene(path, "sensors", "name the map of its sensors with --map")
        raise
