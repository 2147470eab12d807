"""The drill-string application as the command line sees it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from tautline.application.packaged import Packaged
from tautline.scene.errors import option_error

if TYPE_CHECKING:
    from tautline.results.tables.finding import Table


class Drillstring(Packaged):
    """Drill strings in deviated wells."""

    name = "drillstring"
    title = "Drill strings in deviated wells: hook load, torque, friction, bit motion, faster than real time."
    starters = ("jwell", "vertical", "drilling")
    rooms = MappingProxyType(
        {
            "scene": "scene.scene",
            "build": "model.build",
            "handles": "model.handles",
            "figures": "view.figures",
            "appearance": "view.appearance",
            "variations": "model.variations",
        }
    )

    @property
    def verbs(self) -> Sequence[Callable[..., None]]:
        """Commands that other applications do not have."""
        from drillstring.verbs.campbell import campbell
        from drillstring.verbs.form import form
        from drillstring.verbs.stick_slip import stick_slip
        from drillstring.verbs.torque_drag import torque_drag
        from drillstring.verbs.tubulars import tubulars

        return (form, torque_drag, campbell, stick_slip, tubulars)

    sometimes = ("bit_stuck", "whirl_ratio", "bit_rotation_mean", "stick_slip_severity", "rotation_stuck")

    @property
    def tables(self) -> Mapping[str, Table]:
        """Verbs whose findings a sweep collects."""
        from drillstring.verbs import campbell, torque_drag
        from tautline.results.tables.finding import Table

        return {
            "torque-drag": Table(torque_drag.OPTIONS, torque_drag.read_options, torque_drag.findings),
            "campbell": Table(campbell.OPTIONS, campbell.read_options, campbell.findings),
        }

    def operation(self, scene: Any, account: Path | None = None) -> Any:
        """What a twin asks of a rig's work: slips, stands, the bit on and off bottom.

        Raises
        ------
        SceneError
            Where an account is asked for.
        """
        if account is not None:
            raise option_error("--account", str(account), "is for ropes: a drill string keeps none", "leave it out")
        from drillstring.twin.operation import RigOperation

        return RigOperation(scene)

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a well or a string is a drill string."""
        return "well" in root or "string" in root

    def driven(self, scene: Any, names: Sequence[str]) -> Any:
        """The scene with what is named free to be driven; `top.torque` takes the place of the drive's controller."""
        return self._module("handles").driven(scene, tuple(names))
