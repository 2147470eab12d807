"""Cables in the thesis' syntax as the command line sees them; everything heavy is imported when it is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tautline.cable.scene import CableScene
    from tautline.results.result import Result
    from tautline.scene.errors import Caution
    from tautline.system.model import Model

TEMPLATES = ("bar", "span")
KEYS = {"method": "type", "step": "time_step", "end": "time_end", "rho_inf": "rho_inf"}
"""What the command line calls the keys of ``GeneralizedAlpha``."""


class Cable:
    """Cables of ALE-ANCF elements, written as in the thesis' Appendix A."""

    name = "cable"
    title = "Cables of ALE-ANCF elements: nodes, elements, constraints and forces, one by one."

    @property
    def templates(self) -> Mapping[str, str]:
        """Commented starter scenes."""
        folder = resources.files("tautline.cable") / "templates"
        return {name: (folder / f"{name}.yaml").read_text(encoding="utf8") for name in TEMPLATES}

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a cable model, or with what only such a scene has, is a cable's."""
        return any(key in root for key in ("CableModel", "CableModelMaterial", "GeneralizedAlpha"))

    def read(self, path: Path) -> CableScene:
        """Read and validate a scene; raises SceneError."""
        from tautline.cable.scene import read

        return read(path)

    def with_overrides(
        self,
        scene: CableScene,
        method: str | None = None,
        step: float | None = None,
        end: float | None = None,
        rho_inf: float | None = None,
    ) -> CableScene:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        from tautline.cable.scene import with_values

        given = {"method": method, "step": step, "end": end, "rho_inf": rho_inf}
        values: dict[tuple[str | int, ...], tuple[Any, str]] = {
            ("GeneralizedAlpha", KEYS[key]): (value, "--" + key.replace("_", "-"))
            for key, value in given.items()
            if value is not None
        }
        if rho_inf is not None:
            # It stands for both alphas, which the thesis' scenes always give.
            values |= {("GeneralizedAlpha", key): (None, "--rho-inf") for key in ("alpha_m", "alpha_f")}
        return with_values(scene, values) if values else scene

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        from tautline.cable.scene import json_schema

        return json_schema()

    def cautions(self, scene: CableScene) -> list[Caution]:
        """What is large compared with what, and what the reader made of oddities."""
        from tautline.cable.cautions import cautions

        return cautions(scene)

    def check_figures(self, scene: CableScene) -> dict[str, Any]:
        """Counts, length and mass."""
        from tautline.cable.cautions import figures

        return figures(scene)

    def build(self, scene: CableScene) -> Model:
        """Compile a scene; raises SceneError."""
        from tautline.cable.build import build

        return build(scene)

    def figures(
        self, results: Sequence[Result], folder: Path, what: Sequence[str], formats: Sequence[str], stem: str | None
    ) -> list[Path]:
        """Draw results."""
        from tautline.cable.figures import figures

        return figures(results, folder, what, formats, stem)
