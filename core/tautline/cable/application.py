"""Cables in the thesis' syntax as an application; everything heavy is imported when it is needed."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from tautline.application.packaged import Packaged
from tautline.study.trials.overrides import SETTINGS, Place, overrides

if TYPE_CHECKING:
    from tautline.cable.input.parts import CableScene
    from tautline.scene.reading.document import Document

KEYS = {"method": "type", "step": "time_step", "end": "time_end", "step_error": "tolerance", "interval": "plotpoints"}
"""What the command line calls the keys of ``GeneralizedAlpha`` that have another name there."""
PLACES: dict[str, Place] = {key: ("GeneralizedAlpha", KEYS.get(key, key)) for key in (*SETTINGS, "alpha_m", "alpha_f")}


def _overrides(given: dict[str, Any]) -> dict[Place, tuple[Any, str]]:
    """Values to replace in a file: key path -> (value, the option that it came from)."""
    if given.get("interval"):
        # The file says how many frames a second there are.
        given["interval"] = 1.0 / given["interval"]
    return overrides(given, PLACES)


class Cable(Packaged):
    """Cables of ALE-ANCF elements, written as in the thesis' Appendix A."""

    name = "cable"
    package = "tautline.cable"
    title = "Cables of ALE-ANCF elements: nodes, elements, constraints and forces, one by one."
    starters = ("bar", "span")
    step_key = "GeneralizedAlpha.time_step"
    rooms = MappingProxyType(
        {
            "scene": "input.scene",
            "build": "model.build",
            "figures": "view.figures",
            "appearance": "view.appearance",
            "variations": "study.variations",
        }
    )

    def recognises(self, root: dict[str, Any]) -> bool:
        """A scene with a cable model, or with what only such a scene has, is a cable's."""
        return any(key in root for key in ("CableModel", "CableModelMaterial", "GeneralizedAlpha"))

    def with_overrides(self, scene: CableScene, **given: Any) -> CableScene:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        from tautline.cable.input.scene import with_values

        values = _overrides(given)
        if not values:
            return scene
        read = with_values(scene, values)
        # Only the solver has changed: parts that a study has varied stay varied.
        return replace(scene, solver=read.solver, document=read.document)

    def overridden(self, document: Document, **given: Any) -> Document:
        """The same of a document that is not validated yet, so that what is replaced counts for nothing."""
        return document.replaced(_overrides(given))

    def as_written(self, scene: CableScene) -> tuple[Any, Any]:
        """The models of the file, and the document as the thesis' oddities are meant."""
        from tautline.cable.input.syntax.models import WrittenCable
        from tautline.cable.input.syntax.thesis_compat import read_compat

        return WrittenCable, read_compat(scene.document)[0]
