"""A scene in the syntax of the thesis' Appendix A: read, checked, and made into the parts that the builder takes.

`tautline.cable.input.syntax.models` holds the models of the file, `tautline.cable.input.parts` those of the scene, and
`tautline.cable.input.references` leads from the ones to the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tautline.cable.input.couplings import check_couplings
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import CableScene, Place
from tautline.cable.input.references import resolve
from tautline.cable.input.syntax.models import file_model
from tautline.cable.input.syntax.thesis_compat import read_compat
from tautline.scene.errors import SceneError
from tautline.scene.extensions import problems_of_extensions
from tautline.scene.model import validate
from tautline.scene.reading.document import Document


def read(path: str | Path | Document) -> CableScene:
    """Read and validate a scene file, or a document that was read already.

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
    return file_model().model_json_schema()


def _scene(document: Document) -> CableScene:
    model = file_model()
    meant, warnings = read_compat(document)
    try:
        written = validate(model, meant)
    except SceneError as error:
        # An unknown key may be of an extension that could not be loaded: that comes first, for it is the cause then.
        raise SceneError([*problems_of_extensions(str(document.path)), *error.problems]) from None
    scene = replace(resolve(written, meant, document, warnings), made_by=_scene)
    # A scene whose lengths or couplings contradict each other is refused here, not when it is built.
    check_couplings(scene, material_coordinates(scene))
    return scene
