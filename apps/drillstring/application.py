"""The drill-string application as the command line sees it."""

from __future__ import annotations

from typing import Any

from tautline.cli.packaged import Packaged


class Drillstring(Packaged):
    """Drill strings in deviated wells."""

    name = "drillstring"
    title = "Drill strings in deviated wells: hook load, torque, friction, bit motion, faster than real time."
    starters = ("jwell", "vertical")

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a well or a string is a drill string."""
        return "well" in root or "string" in root
