"""The crane application as the command line sees it."""

from __future__ import annotations

from typing import Any

from tautline.cli.packaged import Packaged


class Crane(Packaged):
    """Ropes over sheaves."""

    name = "crane"
    title = "Cranes: ropes over sheaves, winches, hook blocks and ships; tensions, snap loads, slip, payload motion."
    starters = ("hoist", "hookblock", "landing", "slewing", "lift")

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with the path of a rope is ours."""
        return "path" in root
