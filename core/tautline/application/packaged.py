"""An application whose scenes have a ``solver`` section and whose modules have the usual names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module, resources
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from tautline.application.defaults import Defaults
from tautline.study.trials.variations import varied

if TYPE_CHECKING:
    from tautline.results.result import Result
    from tautline.scene.errors import SceneWarning
    from tautline.scene.reading.document import Document
    from tautline.system.model import Model
    from tautline.view.space.appearance import Appearance, Look


class Packaged(Defaults):
    """A package with ``scene`` (read, json_schema), ``warnings`` (warnings, figures), ``build``, ``figures``.

    Every module is imported by the method that needs it. An application adds its title and what it recognises, and in
    ``rooms`` where a module stands that is not on top of the package.

    Attributes
    ----------
    name : str
        Of the application, its package and its console script.
    starters : tuple of str
        Names of its templates; the first is the default of ``new``.
    rooms : mapping
        Module -> its place in the package, where that is another: ``{"build": "model.build"}``.
    package : str
        The package, where that is not called as the application.
    """

    name: str
    starters: tuple[str, ...]
    rooms: Mapping[str, str] = MappingProxyType({})
    package: str = ""

    def _place(self, name: str) -> str:
        return f"{self.package or self.name}.{self.rooms.get(name, name)}"

    def _module(self, name: str) -> Any:
        return import_module(self._place(name))

    @property
    def templates(self) -> Mapping[str, str]:
        """Commented starter scenes."""
        folder = resources.files(self.package or self.name) / "templates"
        return {name: (folder / f"{name}.yaml").read_text(encoding="utf8") for name in self.starters}

    def read(self, path: Path | Document) -> Any:
        """Read and validate a scene, of which the document may have been read already; raises SceneError."""
        return self._module("scene").read(path)

    def vary(self, scene: Any, what: str, *value: Any) -> Any:
        """Copy of a scene that is varied by a function of the package's ``variations``; None if it has none of it."""
        return varied(self._place("variations"), scene, what, *value)

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        return self._module("scene").json_schema()

    def own_warnings(self, scene: Any) -> list[SceneWarning]:
        """What is large compared with what, by ``warnings`` of the package's ``warnings``."""
        return self._module("warnings").warnings(scene)

    def check_figures(self, scene: Any) -> dict[str, Any]:
        """What ``check`` tells of a scene in figures."""
        return self._module("warnings").figures(scene)

    def describe(self, figures: dict[str, Any]) -> list[tuple[str, str]]:
        """Rows of a table for people, of what `check_figures` gives; none if ``warnings`` has no ``describe``."""
        rows = getattr(self._module("warnings"), "describe", None)
        return [] if rows is None else rows(figures)

    def draw(self, scene: Any, path: Path) -> Path:
        """Draw a scene before it runs, by ``draw_scene`` of ``figures``; raises ResultError if it has none."""
        drawing = getattr(self._module("figures"), "draw_scene", None)
        return super().draw(scene, path) if drawing is None else drawing(scene, path)

    def build(self, scene: Any) -> Model:
        """Compile a scene; raises SceneError."""
        model = self._module("build").build(scene)
        if getattr(getattr(scene, "output", None), "statistics", False):
            from tautline.application.statistics import keep_of

            model.keep = keep_of(model, scene)
        return model

    @property
    def figure_names(self) -> Mapping[str, str]:
        """Names of figures, and what they show."""
        return self._module("figures").FIGURES

    def pictures(self, results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Any]:
        """Draw results: name -> Figure, and nothing is written; raises ResultError for an unknown name."""
        return self._module("figures").draw(results, what, vs)

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
        return self._module("figures").figures(results, folder, what, formats, stem, vs)

    def appearance(self, result: Result, look: Look) -> Appearance:
        """What a result looks like in space; raises ResultError for an unknown view."""
        from tautline.view.space.appearance import chosen

        module = self._module("appearance")
        return module.appearance(result, chosen(module.VIEWS, look))
