"""The garden-hose application as the command line sees it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import MappingProxyType
from typing import Any

from tautline.application.packaged import Packaged


class Gardenhose(Packaged):
    """Pipes that convey fluid."""

    name = "gardenhose"
    title = "Hoses, risers and pipes conveying fluid: shape under flow, onset of flutter, limit cycles."
    starters = ("hose", "riser", "supported")
    rooms = MappingProxyType(
        {
            "figures": "view.figures",
            "appearance": "view.appearance",
        }
    )

    @property
    def verbs(self) -> Sequence[Callable[..., None]]:
        """Commands that other applications do not have."""
        from gardenhose.verbs import flutter, static

        return (static, flutter)

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a hose is ours."""
        return "hose" in root
