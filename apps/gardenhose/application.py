"""The garden-hose application as the command line sees it; everything heavy is imported when it is needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gardenhose.scene import HoseScene
    from tautline.results.result import Result
    from tautline.scene.errors import Caution
    from tautline.system.model import Model

TEMPLATES = ("hose", "riser", "supported")


class Gardenhose:
    """Pipes that convey fluid."""

    name = "gardenhose"
    title = "Hoses, risers and pipes conveying fluid: shape under flow, onset of flutter, limit cycles."

    @property
    def verbs(self) -> Sequence[Callable[..., None]]:
        """Commands that other applications do not have."""
        from gardenhose.verbs import flutter, static

        return (static, flutter)

    @property
    def templates(self) -> Mapping[str, str]:
        """Commented starter scenes."""
        folder = resources.files("gardenhose") / "templates"
        return {name: (folder / f"{name}.yaml").read_text(encoding="utf8") for name in TEMPLATES}

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a hose is ours."""
        return "hose" in root

    def read(self, path: Path) -> HoseScene:
        """Read and validate a scene; raises SceneError."""
        from gardenhose.scene import read

        return read(path)

    def with_overrides(
        self,
        scene: HoseScene,
        method: str | None = None,
        step: float | None = None,
        end: float | None = None,
        rho_inf: float | None = None,
    ) -> HoseScene:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        from gardenhose.scene import HoseScene
        from tautline.scene.model import validate

        given = {"method": method, "step": step, "end": end, "rho_inf": rho_inf}
        values = {
            ("solver", key): (value, "--" + key.replace("_", "-")) for key, value in given.items() if value is not None
        }
        if not values:
            return scene
        assert scene.document is not None
        return validate(HoseScene, scene.document.replaced(values))

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        from gardenhose.scene import json_schema

        return json_schema()

    def cautions(self, scene: HoseScene) -> list[Caution]:
        """What is large compared with what."""
        from gardenhose.cautions import cautions

        return cautions(scene)

    def check_figures(self, scene: HoseScene) -> dict[str, Any]:
        """Hose and flow in figures, with rough estimates of where flutter begins."""
        from gardenhose.cautions import figures

        return figures(scene)

    def build(self, scene: HoseScene) -> Model:
        """Compile a scene; raises SceneError."""
        from gardenhose.build import build

        return build(scene)

    def figures(
        self, results: Sequence[Result], folder: Path, what: Sequence[str], formats: Sequence[str], stem: str | None
    ) -> list[Path]:
        """Draw results."""
        from gardenhose.figures import figures

        return figures(results, folder, what, formats, stem)
