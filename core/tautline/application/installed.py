"""Which application a scene or a result belongs to."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from tautline import entry_points
from tautline.errors import ArgumentError, TautlineError
from tautline.scene.errors import Problem, SceneError
from tautline.scene.refusal import nearest

if TYPE_CHECKING:
    from tautline.application.protocol import Application
    from tautline.results.result import Result
    from tautline.scene.reading.document import Document, PartlyReplacedError

GROUP = "tautline.applications"
"""Entry points of this group name the classes of applications."""

NEEDED = ("name", "title", "recognises", "read", "build", "schema", "templates")
"""What no application can be without: it is asked of each for every scene, or by `tautline` itself."""

Change = Callable[["Application", "Document"], "Document"]
"""What another text than the file's is made with before a scene is validated: values of the command line."""

S = TypeVar("S")

_registered: dict[str, Any] = {}


def register(application: Any) -> Any:
    """Make an application known to this process that is not installed; returns it, so that it decorates a class.

    Parameters
    ----------
    application : type
        Makes an `Application` when it is called without arguments.

    Raises
    ------
    ArgumentError
        If one that comes with the program has its name: scenes of that would find none.
    """
    name = getattr(application, "name", application.__name__)
    if name in _with_us() and not _is_of(application, _with_us()[name]):
        raise ArgumentError(f"an application that comes with Tautline is called {name}; choose another name")
    _registered[name] = application
    return application


def _with_us() -> dict[str, str]:
    """Packages of the applications that come with the program, by name."""
    points = filter(entry_points.is_of_ours, entry_points.in_group(GROUP))
    return {point.name: entry_points.package_of(point) for point in points}


def _of_point(point: Any) -> Any:
    """What an entry point names, made; raises ArgumentError for one of others that takes the name of one of ours."""
    made, ours = point.load()(), _with_us()
    taken = {point.name, getattr(made, "name", "")} & ours.keys()
    if taken and not entry_points.is_of_ours(point):
        raise ArgumentError(f"an application that comes with Tautline is called {min(taken)}; choose another name")
    return made


def unknown_names(names: Iterable[str], own: str) -> dict[str, str]:
    """Names that no application has that is installed or registered, each with the nearest that one has."""
    known = {own, *_registered, *(point.name for point in entry_points.in_group(GROUP))}
    unknown = set(names) - known
    if unknown:  # an application may have another name than its entry point
        known |= {application.name for application in Installed().all()}
    return {name: nearest(name, sorted(known)) for name in sorted(unknown - known)}


def _is_of(application: Any, package: str) -> bool:
    return str(getattr(application, "__module__", "")).split(".")[0] == package


def refuse_other_kind(path: Path, own: Callable[[dict[str, Any]], bool]) -> None:
    """Refuse what is no scene of an application by its kind; a list of unknown keys would say less.

    Parameters
    ----------
    path : Path
        One that the application cannot read: nothing is said of what is no YAML.
    own : callable
        Whether the mapping of a file is a scene of that application.

    Raises
    ------
    SceneError
        For a sweep, the map of a twin, and a scene of another application.
    """
    root = _root(path)
    if own(root):
        return
    _refuse_no_scene(root, str(path))
    if name := _application_of(root):
        own = f"`{name}`, or " if has_command(name) else ""
        cure = f"use {own}`tautline`, which knows all kinds"
        raise SceneError([Problem(str(path), None, "", None, f"is a scene of {name}", cure)])


def read_changed(read: Callable[[Document], S], document: Document, change: Callable[[Document], Document]) -> S:
    """The scene that `read` makes of a document with other values, validated with them.

    Raises
    ------
    SceneError
        Of the scene with the values. Where some cannot be put into the document, of these, and then of the document
        with the others: what those replace is no fault.
    """
    from tautline.scene.reading.document import PartlyReplacedError

    try:
        document = change(document)
    except PartlyReplacedError as error:
        raise SceneError(_all_faults(error, read)) from None
    return read(document)


def _all_faults(error: PartlyReplacedError, read: Callable[[Document], Any]) -> list[Problem]:
    """Faults of values that found no place, and of the document without them, which may be why they found none."""
    others = _faults(read, error.document)
    faulty = {other.key for other in others}
    return [*(problem for problem in error.problems if not _innocent(problem, error.document, faulty, read)), *others]


def _faults(read: Callable[[Document], Any], document: Document) -> list[Problem]:
    """What is wrong with a document."""
    try:
        read(document)
    except SceneError as found:
        return found.problems
    return []


def _innocent(problem: Problem, document: Document, faulty: Set[str], read: Callable[[Document], Any]) -> bool:
    """Whether a value found no place only because what it should be in is no mapping, or no list, but ought to be."""
    from tautline.scene.reading.document import join_key, split_key

    *above, part = split_key(problem.key) or ("",)
    place = join_key(tuple(above))
    if not above or place not in faulty:
        return False
    such = {part: None} if isinstance(part, str) else [None]
    mended = document.replaced({tuple(above): (such, problem.file)})
    return all(other.key != place for other in _faults(read, mended))


def overridden(application: Application, document: Document, given: Mapping[str, Any]) -> Document | None:
    """A document with other solver settings; None where the application can only change a scene that was read."""
    make = getattr(application, "overridden", None)
    found: Document | None = None if make is None else make(document, **given)
    return found


def key_of_setting(application: Application, name: str) -> str:
    """The key in a scene's file of what an option of ``simulate`` sets; empty of what it has no option for."""
    from tautline.scene.reading.document import Document, join_key

    try:
        made = overridden(application, Document.parse("title: ''"), {name: 1.0})
    except TautlineError:
        return ""
    return "" if made is None else next((join_key(path) for path in made.origins), "")


def has_command(name: str) -> bool:
    """Whether a command of that name is installed."""
    return any(point.name == name for point in entry_points.in_group("console_scripts"))


def refuse_scene(path: Path, key: str, cure: str) -> None:
    """Refuse a scene where another file is wanted, one that has a key; raises SceneError with the cure."""
    root = _root(path)
    if key not in root and (name := _application_of(root)):
        raise SceneError([Problem(str(path), None, "", None, f"is a scene of {name}", cure)])


def _root(path: Path) -> dict[str, Any]:
    """The mapping of a file; empty for what is no YAML, of which others say what is wrong."""
    from tautline.scene.reading.document import Document

    try:
        return Document.read(path).root
    except SceneError:
        return {}


def _application_of(root: dict[str, Any]) -> str:
    """Name of the application whose scene a mapping is; empty for none."""
    return next((one.name for one in Installed().all() if _claims(one, root)), "")


def _claims(application: Application, root: dict[str, Any], failed: dict[str, str] | None = None) -> bool:
    """Whether an application takes a mapping for its scene; one that fails at it does not: others may.

    What it raises is kept in ``failed`` by its name: an application may ask for a key that scenes of others lack.
    """
    try:
        return bool(application.recognises(root))
    except Exception as error:
        if failed is not None:
            failed[application.name] = f"{type(error).__name__}: {error}"
        return False


def _made(make: Callable[[], Any]) -> Application:
    """An application of an entry point.

    Raises
    ------
    TypeError
        Where it lacks something that every application has.
    Exception
        What its code raises.
    """
    application = make()
    lacking = [name for name in NEEDED if not hasattr(type(application), name) and name not in vars(application)]
    if lacking:
        raise TypeError(f"it has no {', no '.join(f'`{name}`' for name in lacking)}; see docs/extending.md")
    made: Application = application
    return made


def _refuse_no_scene(root: dict[str, Any], name: str) -> None:
    """Refuse a sweep and the map of a twin where a scene is wanted; raises SceneError."""
    kinds = {"vary": ("is the file of a sweep, and no scene", f"use `sweep {name}`"),
             "sensors": ("is the map of a twin, and no scene", f"use `twin SCENE --map {name}`")}  # fmt: skip
    for key, (cause, cure) in kinds.items():
        if key in root:
            raise SceneError([Problem(name, None, "", None, cause, cure)])


class Catalogue(Protocol):
    """The applications that a command serves."""

    name: str
    title: str

    def all(self) -> list[Application]:
        """All of them, loaded."""

    def for_scene(self, source: Path | Document) -> Application:
        """Find the one that a scene file, or a document, belongs to; raises SceneError if there is none."""

    def read(self, path: Path, change: Change | None = None) -> tuple[Application, Any]:
        """Read a scene, its file once, and change it before it is validated; raises SceneError.

        Returns the application that it belongs to, too.
        """

    def for_result(self, result: Result) -> Application:
        """Find the one that a result belongs to; raises SceneError if there is none."""

    def refuse_foreign(self, result: Result) -> None:
        """Raise SceneError for a result of an application that is not served, also where none is needed to read it."""


class Single:
    """The catalogue of an application's own console script: it takes every scene as its own."""

    def __init__(self, application: Application) -> None:
        self.application = application
        self.name, self.title = application.name, application.title

    def all(self) -> list[Application]:
        """List the one application."""
        return [self.application]

    def for_scene(self, source: Path | Document) -> Application:
        """Return the one application, whose own messages about a foreign scene say more than ours could."""
        return self.application

    def read(self, path: Path, change: Change | None = None) -> tuple[Application, Any]:
        """Let the one application read the scene; of a file of another kind it says of which, and nothing else."""
        from tautline.scene.reading.document import Document

        try:
            if change is not None:
                return self.application, read_changed(
                    self.application.read, Document.read(path), functools.partial(change, self.application)
                )
            return self.application, self.application.read(path)
        except SceneError:
            refuse_other_kind(path, self.application.recognises)
            raise

    def for_result(self, result: Result) -> Application:
        """Return the one application; raises SceneError for a result of a scene that is another's."""
        self.refuse_foreign(result)
        return self.application

    def refuse_foreign(self, result: Result) -> None:
        """Raise SceneError for a result of a scene that is another's, whatever is asked of it."""
        made_by = str(result.attributes.get("application", ""))
        if made_by and made_by != self.name and any(one.name == made_by for one in Installed().all()):
            cause = f"is the result of a scene of {made_by}, and not of {self.name}"
            raise SceneError([Problem(str(result.path), None, "", None, cause, "take `tautline`, which knows all")])


def _loaded(makers: Iterable[tuple[str, Callable[[], Any]]]) -> tuple[dict[str, Application], dict[str, str]]:
    """Applications by name, and why some could not be made: a broken one must not keep the others from being used."""
    found: dict[str, Application] = {}
    broken: dict[str, str] = {}
    for name, make in makers:
        try:
            found[name] = _made(make)
        except (Exception, SystemExit) as error:
            broken[name] = f"{type(error).__name__}: {error}"
    return found, broken


class Installed:
    """All applications that are installed."""

    name = "tautline"
    title = "Slender things under tension: simulates any scene of any installed application."

    def all(self) -> list[Application]:
        """Load them all; those that cannot be loaded are left out, see `broken`."""
        return list((self._loaded[0] | self._own[0]).values())

    @property
    def broken(self) -> dict[str, str]:
        """Why an application could not be loaded, or lacks what every application has, by name."""
        return self._loaded[1] | self._own[1]

    @functools.cached_property
    def _loaded(self) -> tuple[dict[str, Application], dict[str, str]]:
        return _loaded((point.name, functools.partial(_of_point, point)) for point in entry_points.in_group(GROUP))

    @property
    def _own(self) -> tuple[dict[str, Application], dict[str, str]]:
        return _loaded(_registered.items())

    def for_scene(self, source: Path | Document) -> Application:
        """Ask each whether the scene is its own."""
        from tautline.scene.reading.document import Document

        document = Document.read(source)
        return self._recognising(document.root, str(document.path))

    def read(self, path: Path, change: Change | None = None) -> tuple[Application, Any]:
        """Read the file, ask each whether the scene is its own, and let that one make it of what was read."""
        from tautline.scene.reading.document import Document

        document = Document.read(path)
        application = self.for_scene(document)
        if change is not None:
            return application, read_changed(application.read, document, functools.partial(change, application))
        return application, application.read(document)

    def of(self, scene: Any) -> Application:
        """Find the one that a scene, already read, belongs to."""
        return self._recognising(scene.document.root, str(scene.document.path))

    def for_result(self, result: Result) -> Application:
        """Ask each about the scene that a result carries."""
        from tautline.scene.reading.document import Document

        path = str(result.path)
        return self._recognising(Document.parse(str(result.attributes.get("scene", "")), path).root, path)

    def refuse_foreign(self, result: Result) -> None:
        """Refuse none: tables are also made of the result of an application that is not installed any more."""

    def _recognising(self, root: dict[str, Any], name: str) -> Application:
        failed: dict[str, str] = {}
        for application in self.all():
            if _claims(application, root, failed):
                return application
        _refuse_no_scene(root, name)
        known = ", ".join(application.name for application in self.all()) or "none"
        cure = (
            f"installed applications: {known}; `new --list` shows scenes of each. An application of your own has to be "
            "installed or registered: docs/extending.md"
        )
        for application_name, why in self.broken.items():
            cure += f"; {application_name} could not be loaded ({why})"
        for application_name, why in failed.items():
            cure += f"; `recognises` of {application_name} failed at this scene ({why})"
        raise SceneError([Problem(name, None, "", None, "no installed application knows this kind of scene", cure)])
