"""The drill-string application as the command line sees it; everything heavy is imported when it is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drillstring.scene import DrillstringScene
    from tautline.results.result import Result
    from tautline.scene.errors import Caution
    from tautline.system.model import Model

TEMPLATES = ("jwell", "vertical")


class Drillstring:
    """Drill strings in deviated wells."""

    name = "drillstring"
    title = "Drill strings in deviated wells: hook load, torque, friction, bit motion, faster than real time."

    @property
    def templates(self) -> Mapping[str, str]:
        """Commented starter scenes."""
        folder = resources.files("drillstring") / "templates"
        return {name: (folder / f"{name}.yaml").read_text(encoding="utf8") for name in TEMPLATES}

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a well or a string is a drill string."""
        return "well" in root or "string" in root

    def read(self, path: Path) -> DrillstringScene:
        """Read and validate a scene; raises SceneError."""
        from drillstring.scene import read

        return read(path)

    def with_overrides(
        self,
        scene: DrillstringScene,
        method: str | None = None,
        step: float | None = None,
        end: float | None = None,
        rho_inf: float | None = None,
    ) -> DrillstringScene:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        from drillstring.scene import DrillstringScene
        from tautline.scene.model import validate

        given = {"method": method, "step": step, "end": end, "rho_inf": rho_inf}
        values = {
            ("solver", key): (value, "--" + key.replace("_", "-")) for key, value in given.items() if value is not None
        }
        if not values:
            return scene
        assert scene.document is not None
        return validate(DrillstringScene, scene.document.replaced(values))

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        from drillstring.scene import json_schema

        return json_schema()

    def cautions(self, scene: DrillstringScene) -> list[Caution]:
        """What is large compared with what."""
        from drillstring.cautions import cautions

        return cautions(scene)

    def check_figures(self, scene: DrillstringScene) -> dict[str, Any]:
        """Well and string in figures."""
        from drillstring.cautions import figures

        return figures(scene)

    def build(self, scene: DrillstringScene) -> Model:
        """Compile a scene; raises SceneError."""
        from drillstring.build import build

        return build(scene)

    def figures(
        self, results: Sequence[Result], folder: Path, what: Sequence[str], formats: Sequence[str], stem: str | None
    ) -> list[Path]:
        """Draw results."""
        from drillstring.figures import figures

        return figures(results, folder, what, formats, stem)
