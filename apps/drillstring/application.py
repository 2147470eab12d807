"""The drill-string application as the command line sees it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from tautline.cli.packaged import Packaged


class Drillstring(Packaged):
    """Drill strings in deviated wells."""

    name = "drillstring"
    title = "Drill strings in deviated wells: hook load, torque, friction, bit motion, faster than real time."
    starters = ("jwell", "vertical", "drilling")

    @property
    def verbs(self) -> Sequence[Callable[..., None]]:
        """Commands that other applications do not have."""
        from drillstring.campbell_verbs import campbell
        from drillstring.form_verbs import form
        from drillstring.stick_slip_verbs import stick_slip
        from drillstring.torque_verbs import torque_drag
        from drillstring.tubular_verbs import tubulars

        return (form, torque_drag, campbell, stick_slip, tubulars)

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a well or a string is a drill string."""
        return "well" in root or "string" in root
