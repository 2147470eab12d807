"""An application of one file: what every verb does where an application says nothing of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tautline.study.trials.overrides import SETTINGS, Place, overrides

if TYPE_CHECKING:
    from tautline.results.result import Result
    from tautline.scene.errors import SceneWarning
    from tautline.scene.reading.document import Document
    from tautline.view.space.appearance import Appearance, Look

PLACES: dict[str, Place] = {key: ("solver", key) for key in (*SETTINGS, "alpha_m", "alpha_f")}
PLACES["interval"] = ("output", "interval")


class Defaults:
    """Base of an application whose scenes have a ``solver`` and an ``output`` section.

    An application gives ``name``, ``title``, ``scene_type``, ``template``, and ``build(scene)``; all else it may give.

    Attributes
    ----------
    name : str
        Of the application.
    title : str
        One line for ``--help``.
    scene_type : type
        Class of its scenes, below `tautline.scene.model.Scene`.
    template : str
        Text of a commented starter scene.
    """

    name: str
    title: str
    scene_type: Any
    template: str = ""

    @property
    def templates(self) -> Mapping[str, str]:
        """Commented starter scenes."""
        return {self.name: self.template}

    def recognises(self, root: dict[str, Any]) -> bool:
        """Whether a scene has a key that every scene of this kind must have, and no other kind has here."""
        common = {"title", "units", "gravity", "solver", "output", "start"}
        own = {key for key, field in self.scene_type.model_fields.items() if field.is_required()} - common
        return bool(own) and own <= root.keys()

    def read(self, path: Path | Document) -> Any:
        """Read and validate a scene, of which the document may have been read already; raises SceneError."""
        return self.scene_type.read(path)

    def with_overrides(self, scene: Any, **given: Any) -> Any:
        """Copy of a scene with other solver settings; raises SceneError naming the option."""
        values = overrides(given, PLACES)
        return scene.with_values(values) if values else scene

    def overridden(self, document: Document, **given: Any) -> Document | None:
        """The same of a document that is not validated yet, so that what is replaced counts for nothing.

        None where only `with_overrides` knows how, as in an application that has its own and none of this.
        """
        if type(self).with_overrides is not Defaults.with_overrides:
            return None
        return document.replaced(overrides(given, PLACES))

    def vary(self, scene: Any, what: str, *value: Any) -> Any:
        """Copy of a scene that is varied for a study; None, for nothing is known of its mesh or stiffness."""
        return None

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""
        return self.scene_type.model_json_schema()

    def warnings(self, scene: Any) -> list[SceneWarning]:
        """Unit mistakes, limits on the wrong side, what `own_warnings` and registered functions find, too long a step.

        Raises
        ------
        SceneError
            Of `own_warnings`, for a scene that cannot be run. Before it stand numbers that are probably in a wrong
            unit: they may be the cause.
        """
        from tautline.application.limits import bare_limits
        from tautline.scene.content import too_fast
        from tautline.scene.errors import Doubt, SceneError, SceneWarning
        from tautline.scene.gaps import ends_of_records, gaps_of_records
        from tautline.scene.limits import reversed_limits
        from tautline.scene.solver import fixed_step
        from tautline.scene.unit_slips import slips_of_units
        from tautline.scene.values.printed import in_words
        from tautline.scene.warnings import line_of, warnings_of

        document = self.as_written(scene)[1]
        text = too_fast(scene, scene.solver)
        system = getattr(scene, "units", "si")
        slips = slips_of_units(*self.as_written(scene)) + gaps_of_records(document)
        if (end := getattr(scene.solver, "end", None)) is not None:
            slips += ends_of_records(*self.as_written(scene), float(end), fixed_step(scene.solver))
        try:
            found = self.own_warnings(scene) + warnings_of(self.name, scene) + self._warnings_of_nobody()
        except SceneError as error:
            doubtful = [
                Doubt(*astuple(document.problem(slip.where, slip.text))) for slip in slips if document is not None
            ]
            raise SceneError([*doubtful, *error.problems]) from None
        found += [SceneWarning(self.step_key, text)] if text else []
        ours = [replace(one, text=in_words(one.text, system), line=line_of(document, one.where)) for one in found]
        of_limits = bare_limits(scene, self.build) + reversed_limits(scene)
        return list(dict.fromkeys(slips + of_limits + ours))

    def _warnings_of_nobody(self) -> list[SceneWarning]:
        """Warnings that are registered for an application that there is not: they never come."""
        from tautline.application.installed import unknown_names
        from tautline.scene.errors import SceneWarning
        from tautline.scene.warnings import REGISTERED

        return [
            SceneWarning(check, f"is a warning for scenes of '{name}', and no application here is called so; {cure}")
            for name, cure in unknown_names(REGISTERED, self.name).items()
            for check in REGISTERED[name]
        ]

    step_key: str = "solver.step"
    """Key of the step in a scene."""

    def as_written(self, scene: Any) -> tuple[Any, Any]:
        """Class of the models that a file is read into, and the document."""
        return type(scene), scene.document

    def own_warnings(self, scene: Any) -> list[SceneWarning]:
        """What is large compared with what; nothing is known here."""
        return []

    def check_figures(self, scene: Any) -> dict[str, Any]:
        """What ``check`` tells of a scene in figures; none."""
        return {}

    def describe(self, figures: dict[str, Any]) -> list[tuple[str, str]]:
        """Rows of a table for people, of what `check_figures` gives; none."""
        return []

    def draw(self, scene: Any, path: Path) -> Path:
        """Draw a scene before it runs; refused with ResultError."""
        from tautline.results.errors import ResultError

        raise ResultError("--figure", f"scenes of {self.name} are not drawn", "leave it out, and `plot` the result")

    def driven(self, scene: Any, names: Sequence[str]) -> Any:
        """The scene, made so that what is named can be driven while it runs, also what it holds still."""
        return scene

    def build(self, scene: Any) -> Any:
        """Compile a scene into a Model; raises SceneError. Every application has its own."""
        raise NotImplementedError(f"{type(self).__name__} has no build")

    @property
    def drawings(self) -> Mapping[str, Any]:
        """Figures by their names, each a `tautline.view.figures.drawings.Drawing`."""
        from tautline.application.figures import DRAWINGS

        return DRAWINGS

    @property
    def figure_names(self) -> Mapping[str, str]:
        """Names of figures, and what they show."""
        return {name: one.text for name, one in self.drawings.items()}

    def pictures(self, results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Any]:
        """Draw results: name -> Figure, and nothing is written; raises ResultError for an unknown name."""
        from tautline.view.figures.drawings import drawn

        return drawn(results, self.drawings, what, vs)

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
        from tautline.view.figures.drawings import writing

        return writing(self.pictures)(results, folder, what, formats, stem, vs)

    def appearance(self, result: Result, look: Look) -> Appearance:
        """What a result looks like in space; raises ResultError for an unknown view, or a result without positions."""
        from tautline.application.figures import VIEWS, appearance
        from tautline.view.space.appearance import chosen

        return appearance(result, chosen(VIEWS, look))
