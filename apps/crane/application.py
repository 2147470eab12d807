"""The crane application as the command line sees it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from tautline.application.packaged import Packaged


class Crane(Packaged):
    """Ropes over sheaves."""

    name = "crane"
    title = "Cranes: ropes over sheaves, winches, hook blocks and ships; tensions, snap loads, slip, payload motion."
    starters = ("hoist", "hookblock", "landing", "slewing", "lift")
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
        from crane.verbs.operability import operability

        return (operability,)

    sometimes = ("longest_slack", "max_snap", "undamped_snaps", "snap_frames", "slipping_share")

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with the path of a rope is ours."""
        return "path" in root

    def driven(self, scene: Any, names: Any) -> Any:
        """The scene with what is named free to be driven; a vessel comes under it where its motion is named."""
        return self._module("handles").driven(scene, tuple(names))

    def operation(self, scene: Any, account: Path | None = None) -> Any:
        """What a twin knows of a crane's work; with the account of its rope, where one is asked for."""
        from crane.twin.operation import CraneOperation, Lifting

        return Lifting(scene) if account is None else CraneOperation(scene, account)

    def aside(self, figures: Any, limits: Any) -> frozenset[str]:
        """Names of figures and limits that the summary of a run leaves out, as others tell the same."""
        from crane.results.rows import aside

        return aside(figures, limits)

    def free_motions(self, scene: Any) -> Any:
        """What moves freely, by blows that no sensor sees: loads bounce on their ropes."""
        from crane.assembly.bouncing_loads import free_motions

        return free_motions(scene)
