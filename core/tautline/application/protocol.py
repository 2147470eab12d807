"""What an application offers to the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from tautline.results.result import Result
    from tautline.scene.errors import SceneWarning
    from tautline.scene.reading.document import Document
    from tautline.view.space.appearance import Appearance, Look


class Application(Protocol):
    """One kind of scene. Making one must be cheap: everything heavy is imported by the methods that need it.

    Attributes
    ----------
    name : str
        Name of its console script: ``drillstring``.
    title : str
        One line for ``--help``.

    It may have more: ``verbs``, typer commands of its own; ``describe(figures)``, rows of a table (what, how much) that
    ``check`` prints of `check_figures`; ``draw(scene, path)``, which ``check --figure`` calls and which returns the
    path; ``tables``, verbs whose findings a sweep collects, name -> `tautline.results.tables.finding.Table`;
    ``sometimes``, names of the figures of a run that only some runs have; ``aside(figures, limits)``, names of those of
    its headline and its limits that the printed summary leaves out.
    """

    name: str
    title: str

    @property
    def templates(self) -> Mapping[str, str]:
        """Name -> YAML text of the commented starter scenes; the first is the default of ``new``."""

    def recognises(self, root: dict[str, Any]) -> bool:
        """Whether a scene's mapping is of this kind."""

    def read(self, path: Path | Document) -> Any:
        """Read and validate a scene, of which the document may have been read already; raises SceneError."""

    def with_overrides(self, scene: Any, **given: Any) -> Any:
        """Copy of a scene with other solver settings; raises SceneError naming the option.

        Parameters
        ----------
        scene
            What `read` gives.
        **given
            ``method``, ``step``, ``end``, ``rho_inf``, ``control``, ``step_error``, ``interval`` of the output, and
            ``accuracy``, which is given only where one is asked for; None keeps what the scene says.
        """

    def vary(self, scene: Any, what: str, *value: Any) -> Any:
        """Copy of a scene that is varied in one respect, for a study; None if it has nothing of the kind.

        Parameters
        ----------
        scene
            What `read` gives.
        what : str
            ``elements``, ``stiffness``, ``shortest`` with a factor; ``contact``, ``penalty`` with a stiffness, N/m;
            ``constraint`` with a name. ``constraints``, ``stiffnesses`` and ``bars`` tell of the scene itself (see
            docs/study.md).
        *value
            The factor, the stiffness or the name.
        """

    def schema(self) -> dict[str, Any]:
        """JSON schema of a scene."""

    def warnings(self, scene: Any) -> list[SceneWarning]:
        """Say what is large compared with what, for ``check`` and before a run."""

    def check_figures(self, scene: Any) -> dict[str, Any]:
        """Extra keys of ``check --json``."""

    def driven(self, scene: Any, names: Sequence[str]) -> Any:
        """The scene, made so that what is named can be driven while it runs, also what it holds still.

        Raises
        ------
        tautline.scene.errors.SceneError
            For what cannot be.
        """

    def build(self, scene: Any) -> Any:
        """Compile a scene into a Model; raises SceneError."""

    @property
    def figure_names(self) -> Mapping[str, str]:
        """Names of figures, and what they show."""

    def pictures(self, results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Any]:
        """Draw results: name -> Figure, and nothing is written; raises ResultError for an unknown name.

        Parameters
        ----------
        results : sequence of Result
            All of this application.
        what : sequence of str
            Names of figures or of variables; empty for the usual figures.
        vs : str or None
            Variable to draw variables against, in place of time.
        """

    def figures(
        self,
        results: Sequence[Result],
        folder: Path,
        what: Sequence[str],
        formats: Sequence[str],
        stem: str | None,
        vs: str | None = None,
    ) -> list[Path]:
        """Draw results into files; see `pictures`.

        Parameters
        ----------
        results, what, vs
            As of `pictures`.
        folder : Path
            Where the files go.
        formats : sequence of str
            ``png``, ``svg``, ``pdf``.
        stem : str or None
            Beginning of the file names, and the whole name where there is one figure; None for the first result's
            name followed by the figure's.
        """

    def appearance(self, result: Result, look: Look) -> Appearance:
        """What a result looks like in space; raises ResultError for an unknown view."""
