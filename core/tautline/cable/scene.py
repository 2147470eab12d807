"""A scene in the syntax of the thesis' Appendix A: read, checked, and made into the parts that the builder takes.

`tautline.cable.written` holds the models of the file, `tautline.cable.parts` those of the scene, and
`tautline.cable.references` leads from the ones to the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from tautline.cable.joints import check_couplings
from tautline.cable.material import material_coordinates
from tautline.cable.parts import (
    Anchor as Anchor,
)
from tautline.cable.parts import (
    Coupling,
    Curve,
    Element,
    Force,
    Mass,
    Motion,
    Node,
    Place,
    Spring,
    Tie,
    Vector,
)
from tautline.cable.plots import SubPlot
from tautline.cable.quirks import read_quirks
from tautline.cable.references import Parts, resolve
from tautline.cable.solver import CableSolver
from tautline.cable.written import EXAMPLE, Items, Material
from tautline.scene.document import Document
from tautline.scene.errors import Caution, Problem
from tautline.scene.model import Model, validate

__all__ = [
    "Anchor", "CableScene", "CableSolver", "Coupling", "Curve", "Element", "Force", "Mass", "Motion", "Node", "Spring",
    "Tie", "json_schema", "parse", "read", "with_values",
]  # fmt: skip


class WrittenCable(Model):
    """The whole file."""

    title: str | None = None
    CableModelMaterial: Material = Field(examples=["{Gravity: [0, 0, -9.81]}"])
    CableModel: Items = Field(examples=[f"[{EXAMPLE}]"])
    Plots: Annotated[tuple[SubPlot, ...], Field()] = ()
    GeneralizedAlpha: CableSolver = Field(examples=["{type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 10}"])


@dataclass(frozen=True)
class CableScene:
    """All that a run needs to know; parts in the order of the file, references checked.

    Attributes
    ----------
    gravity : (3,) m/s^2
    plots : tuple of panels, each a tuple of Curve
    text, path : str, Path
        The file.
    cautions : tuple of Caution
        Liberties that the reader took; `tautline.cable.cautions` has more to say.
    document : Document
        For messages.
    """

    title: str | None
    gravity: Vector
    nodes: tuple[Node, ...]
    elements: tuple[Element, ...]
    ties: tuple[Tie, ...]
    couplings: tuple[Coupling, ...]
    forces: tuple[Force, ...]
    anchors: tuple[Anchor, ...]
    springs: tuple[Spring, ...]
    masses: tuple[Mass, ...]
    motions: tuple[Motion, ...]
    plots: tuple[tuple[Curve, ...], ...]
    solver: CableSolver
    cautions: tuple[Caution, ...]
    document: Document = field(repr=False, compare=False)

    @property
    def text(self) -> str:
        """The text of the file."""
        return self.document.text

    @property
    def path(self) -> Path:
        """The file, as it was named."""
        return self.document.path

    def problem(self, place: Place, cause: str, cure: str = "") -> Problem:
        """Build a problem at a key path, such as ``(*node.place, "BC")``, for a check that the builder makes."""
        return self.document.problem(place, cause, cure)


def read(path: str | Path) -> CableScene:
    """Read and validate a scene file.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    return _scene(Document.read(path))


def parse(text: str, path: str | Path = "scene.yaml") -> CableScene:
    """Validate a text; `path` names it in messages.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    return _scene(Document.parse(text, path))


def with_values(scene: CableScene, values: Mapping[Place, tuple[Any, str]]) -> CableScene:
    """Copy of a scene with other values: key path -> (value, the option it came from, named in messages).

    Raises
    ------
    SceneError
        If the scene is not valid with them.
    """
    return _scene(scene.document.replaced(values))


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of a cable scene."""
    return WrittenCable.model_json_schema()


def _scene(document: Document) -> CableScene:
    meant, cautions = read_quirks(document)
    written = validate(WrittenCable, meant)
    parts: Parts = resolve(written, meant)
    scene = CableScene(
        title=written.title,
        gravity=written.CableModelMaterial.Gravity,
        solver=written.GeneralizedAlpha,
        document=document,
        **{name: value for name, value in vars(parts).items() if name != "cautions"},
        cautions=(*cautions, *parts.cautions),
    )
    # A scene whose lengths or couplings contradict each other is refused here, not when it is built.
    check_couplings(scene, material_coordinates(scene))
    return scene
