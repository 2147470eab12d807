"""The garden-hose application as the command line sees it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from tautline.application.packaged import Packaged

if TYPE_CHECKING:
    from tautline.results.tables.finding import Table


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

    sometimes = ("node", "node_amplitude", "node_frequency")

    @property
    def tables(self) -> Mapping[str, Table]:
        """Verbs whose findings a sweep collects."""
        from gardenhose import verbs
        from tautline.results.tables.finding import Table

        return {
            "static": Table(("speed",), verbs.read_static, verbs.static_findings),
            "flutter": Table(("speed", "modes"), verbs.read_flutter, verbs.flutter_findings),
        }

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a hose is ours."""
        return "hose" in root
