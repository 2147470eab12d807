"""Cables in the thesis' syntax as the command line sees them; everything heavy is imported when it is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.study.trials.overrides import SETTINGS, Place, overrides
from tautline.study.trials.variations import varied

if TYPE_CHECKING:
    from tautline.cable.input.scene import CableScene
    from tautline.results.result import Result
    from tautline.scene.errors import Caution
    from tautline.system.model import Model
    from tautline.view.space.appearance import Appearance, Look

TEMPLATES = ("bar", "span")
KEYS = {"method": "type", "step": "time_step", "end": "time_end", "step_error": "tolerance", "interval": "plotpoints"}
"""What the command line calls the keys of ``GeneralizedAlpha`` that have another name there."""
PLACES: dict[str, Place] = {key: ("GeneralizedAlpha", KEYS.get(key, key)) for key in (*SETTINGS, "alpha_m", "alpha_f")}


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
        from tautline.cable.input.scene import read

        return read(path)

    def with_overrides(self, scene: CableScene, **given: Any) -> CableScene:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        from tautline.cable.input.scene import with_values

        if given.get("interval"):
            # The file says how many frames a second there are.
            given["interval"] = 1.0 / given["interval"]
        values = overrides(given, PLACES)
        if not values:
            return scene
        read = with_values(scene, values)
        # Only the solver has changed: parts that a study has varied stay varied.
        return replace(scene, solver=read.solver, document=read.document)

    def vary(self, scene: CableScene, what: str, *value: Any) -> Any:
        """Copy of a scene that is varied by a function of ``cable.study.variations``; None if it has none of it."""
        return varied("tautline.cable.study.variations", scene, what, *value)

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        from tautline.cable.input.scene import json_schema

        return json_schema()

    def cautions(self, scene: CableScene) -> list[Caution]:
        """What is large compared with what, and what the reader made of oddities."""
        from tautline.cable.input.models import file_model
        from tautline.cable.input.thesis_compat import read_quirks
        from tautline.cable.warnings import cautions
        from tautline.scene.content import too_fast
        from tautline.scene.doubts import slips_of_units
        from tautline.scene.errors import Caution

        text = too_fast(scene, scene.solver)
        more = [Caution("GeneralizedAlpha.time_step", text)] if text else []
        document, _ = read_quirks(scene.document)
        return slips_of_units(file_model(), document) + cautions(scene) + more

    def check_figures(self, scene: CableScene) -> dict[str, Any]:
        """Counts, length and mass."""
        from tautline.cable.warnings import figures

        return figures(scene)

    def build(self, scene: CableScene) -> Model:
        """Compile a scene; raises SceneError."""
        from tautline.cable.model.build import build

        return build(scene)

    @property
    def figure_names(self) -> Mapping[str, str]:
        """Names of figures, and what they show."""
        from tautline.cable.view.figures import FIGURES

        return FIGURES

    def pictures(self, results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Any]:
        """Draw results: name -> Figure, and nothing is written."""
        from tautline.cable.view.figures import draw

        return draw(results, what, vs)

    def figures(
        self,
        results: Sequence[Result],
        folder: Path,
        what: Sequence[str],
        formats: Sequence[str],
        stem: str | None,
        vs: str | None = None,
    ) -> list[Path]:
        """Draw results into files."""
        from tautline.cable.view.figures import figures

        return figures(results, folder, what, formats, stem, vs)

    def appearance(self, result: Result, look: Look) -> Appearance:
        """What a result looks like in space; raises ResultError for an unknown view."""
        from tautline.cable.view.appearance import VIEWS, appearance
        from tautline.view.space.appearance import chosen

        return appearance(result, chosen(VIEWS, look))
