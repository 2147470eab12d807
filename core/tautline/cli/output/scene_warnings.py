"""Warnings of a scene, as every verb that reads one prints them and tells them in JSON."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.cli.output.console import say

if TYPE_CHECKING:
    from tautline.scene.errors import SceneWarning

OF_A_RUN = ("solver", "output", "start")
"""Sections of a scene that count in a run alone: steps, frames, and where it starts."""


def print_warnings(warnings: Iterable[SceneWarning], scene: Path | None = None) -> None:
    """Print warnings, one to a line, after the file of the scene where there are several."""
    named = "" if scene is None else f"{scene}: "
    for warning in warnings:
        say(f"warning: {named}{warning}", "yellow")


def warning_records(warnings: Iterable[SceneWarning]) -> list[dict[str, Any]]:
    """What JSON tells of warnings: ``where`` and ``text`` of each."""
    return [{"where": warning.where, "text": warning.text} for warning in warnings]


def warnings_without_a_run(scene: Any) -> list[SceneWarning]:
    """Warnings of a scene for a verb that makes no run of it: those of steps, frames and start are left out.

    Raises
    ------
    SceneError
        For a scene that cannot be run.
    """
    from tautline.application.installed import Installed

    found = Installed().of(scene).warnings(scene)
    return [one for one in found if not one.of_a_run and one.where.split(".")[0] not in OF_A_RUN]
