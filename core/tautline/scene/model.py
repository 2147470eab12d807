"""The base of all that a person writes in a scene, and how pydantic's errors become problems with a line and a cure."""

from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeVar

import pydantic
from pydantic import ConfigDict, PrivateAttr, Strict, ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from tautline.arguments import MAPPING, check_given
from tautline.scene.errors import LONGEST, Problem, SceneError, shorten
from tautline.scene.identity.contents import says_the_same
from tautline.scene.identity.frozen import Frozen
from tautline.scene.reading.document import Document, Path_, join_key, split_key
from tautline.scene.reading.files import files_of
from tautline.scene.reading.slips import decimal_comma, run_together
from tautline.scene.refusal import KIND, must_be, nearest_key, refusal
from tautline.scene.values.habits import other_minus
from tautline.scene.values.printed import in_words
from tautline.scene.values.quantity import Quantity, is_written_in, suited

MARK = "|"
"""Begins the tag of a branch that is no key of the file; dropped from key paths."""

DOUBT = "doubt"
"""The error type of a number that is sound and doubtful: see `tautline.scene.unit_slips`."""
MADE = "made once"
"""Where a scene keeps what was prepared of it: no name of a field."""
TRUTHS = {"true": ("true", "yes", "y", "on", "1"), "false": ("false", "no", "n", "off", "0")}
"""What is written where true or false is meant; most of it was that in YAML 1.1."""
WITHOUT_TEXT = (
    "a scene that was put together in Python cannot be changed by keys",
    "read it from a file, a text or a dict: tautline.read",
)
"""Why a scene without a document has no copy with other values, and the cure."""
MOST_FAULTS = 100
"""Faults of one mapping that are told; a table of words for numbers has as many as rows."""

BASED = re.compile(r"0x[0-9a-fA-F]+|0o[0-7]+")
"""A number of YAML that nobody writes for a quantity."""
ENTRIES = "each entry of a list begins with `- `"
"""Said where a mapping stands in place of a list: the dashes were forgotten."""

Whole = Annotated[int, Strict()]
"""A whole number; true and 12.0 are none."""
Switch = Annotated[bool, Strict()]
"""True or false; 0 and 'no' are neither."""
PARTS = "parts of the last variant"
"""Where it keeps them."""

T = TypeVar("T")


class _Part(NamedTuple):
    """A part of a scene's file that a variant has changed: what it was, the changes, what it became, and its model."""

    base: Any
    changes: tuple[Any, ...]
    value: Any
    model: Any


def _by_part(changes: Mapping[str, Any]) -> dict[str, tuple[Any, ...] | None]:
    """Changes by the part of the file that they are in, to be compared; None where a value is no single one."""
    found: dict[str, Any] = {}
    for key, value in changes.items():
        part = re.split(r"[.\[]", key, maxsplit=1)[0] if isinstance(key, str) else ""
        single = type(value) in (str, int, float, bool)
        before = found.get(part, ())
        found[part] = (*before, (key, type(value), value)) if single and before is not None else None
    return found


class Model(Frozen):
    """A frozen mapping of known keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True, defer_build=True)
    elsewhere: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Keys that are looked for here and are not: key -> a field in which it may be looked for, too, and where it is."""
    by_unit: ClassVar[Mapping[tuple[str, str], tuple[str, str]]] = {}
    """Keys of which the unit tells that another was meant: (key, its SI unit) -> the SI unit of the other, and that."""

    @pydantic.model_validator(mode="wrap")
    @classmethod
    def _say_keys(cls, data: Any, handler: pydantic.ModelWrapValidatorHandler[Self]) -> Self:
        data = cls._in_full(data)
        if not isinstance(data, (dict, cls)):
            kind = "is empty" if data is None else "is a list" if isinstance(data, list) else "is not a mapping"
            raise refusal(kind, f"write a mapping of keys: {', '.join(cls._keys())}")
        try:
            return handler(data)
        except ValidationError as error:
            found = _drop_consequential_errors(cls, error.errors(include_url=False), data)
            details = [_detail(cls, e, data) for e in found[:MOST_FAULTS]]
            raise ValidationError.from_exception_data(cls.__name__, details) from None

    @classmethod
    def _in_full(cls, given: Any) -> Any:
        """The mapping that a short form stands for; anything else as it is."""
        return given

    @classmethod
    def _keys(cls) -> list[str]:
        return [f.alias or name for name, f in cls.model_fields.items()]

    @classmethod
    def _example(cls, key: str) -> str:
        for name, info in cls.model_fields.items():
            if key in (name, info.alias) and not info.examples:
                return next((m.example for m in info.metadata if isinstance(m, Quantity)), "")
        return cls._stated(key)

    @classmethod
    def _stated(cls, key: str) -> str:
        """The example that a field states for itself, if any."""
        fields = (info for name, info in cls.model_fields.items() if key in (name, info.alias))
        return next((str(info.examples[0]) for info in fields if info.examples), "")


def _drop_consequential_errors(model: type[Model], errors: Sequence[Any], data: Any) -> list[Any]:
    """Errors without those that follow from an unknown key.

    A missing key is there, and misspelt. What stands before a decimal comma is not the number that was meant.
    """
    unknown = [str(e["loc"][0]) for e in errors if len(e["loc"]) == 1 and e["type"] == "extra_forbidden"]
    cut = {before for key in unknown if (before := decimal_comma(data, key)[1])}
    meant = {nearest_key(key, model._keys(), model.model_fields) for key in unknown if not decimal_comma(data, key)[0]}
    run_in = {key for one in unknown if (key := run_together(model._keys(), data, one)[0])}

    def follows(error: Any) -> bool:
        place = error["loc"]
        if place and place[0] in cut:
            return True
        missing = len(place) == 1 and error["type"] == "missing"
        return missing and (any(one.startswith(f"did you mean '{place[0]}'?") for one in meant) or place[0] in run_in)

    return [error for error in errors if not follows(error)]


def _detail(model: type[Model], error: Any, data: Any = None) -> InitErrorDetails:
    """Rebuild one of pydantic's errors, with a cure that only the model knows; `data` is what was validated."""
    kind, place, context = error["type"], error["loc"], error.get("ctx") or {}
    known: Any = kind
    if len(place) == 1 and kind == "missing":
        example = model._example(str(place[0]))
        known = refusal("is missing", f"add `{place[0]}:`" + (f", such as {example}" if example else ""))
    elif len(place) == 1 and kind == "extra_forbidden":
        cure, before = decimal_comma(data, str(place[0]))
        cure = cure or run_together(model._keys(), data, str(place[0]))[1]
        cure = cure or model.elsewhere.get(str(place[0]), ("", ""))[1]
        words = {"cause": "unknown key", "cure": cure or nearest_key(str(place[0]), model._keys(), model.model_fields)}
        known = PydanticCustomError(KIND, "{cause}", words | ({"before": before} if before else {}))
    elif kind == DOUBT:
        known = PydanticCustomError(DOUBT, "doubtful", context)
    elif kind == KIND or "error" in context:
        words = {"cause": error["msg"]} | {k: v for k, v in context.items() if k != "error"}
        if len(place) == 1 and "cure" in words and (stated := model._stated(str(place[0]))):
            words["cure"] = suited(words["cure"], error["input"], stated)
        within = error["input"] if len(place) == 1 and isinstance(error["input"], dict) else ()
        stands = (text for key, (field, text) in model.elsewhere.items() if key in within and place[0] == field)
        words["cure"] = next(stands, _by_unit(model, error, words.get("cure", "")))
        known = PydanticCustomError(KIND, "{cause}", words)
    elif len(place) == 1 and kind in ("tuple_type", "list_type") and (stated := model._stated(str(place[0]))):
        told = next(
            (f": {f.description}" for n, f in model.model_fields.items() if n == place[0] and f.description), ""
        )
        dashes = f"; {ENTRIES}" if isinstance(error["input"], dict) else ""
        known = refusal("must be a list", f"give a list such as {stated}{told}{dashes}")
    return InitErrorDetails(type=known, loc=place, input=error["input"], ctx=context)


def _by_unit(model: type[Model], error: Any, cure: str) -> str:
    """The cure with the key that was probably meant, where what was written has that key's unit; else as it is."""
    key, wanted = str(error["loc"][0]) if error["loc"] else "", (error.get("ctx") or {}).get("wanted", "")
    unit, other = model.by_unit.get((key, wanted), ("", ""))
    if not other or not is_written_in(error["input"], unit):
        return cure
    return f"did you mean '{other}'? '{key}' takes {cure.removeprefix('expected ')}"


class Scene(Model):
    """A whole scene: a model that remembers the file it was read from."""

    _document: Document | None = PrivateAttr(None)
    _driven: frozenset[str] = PrivateAttr(frozenset())

    def __getstate__(self) -> dict[Any, Any]:
        """What is pickled: not what was prepared once, which is prepared again where it is needed."""
        state = super().__getstate__()
        return {**state, "__dict__": {key: value for key, value in state["__dict__"].items() if key != MADE}}

    def __eq__(self, other: object) -> bool:
        """Whether both say the same, wherever that is written."""
        return says_the_same(self, other)

    @property
    def driven(self) -> frozenset[str]:
        """Names of what is driven from outside while it runs, though the scene may hold it still."""
        return self._driven

    def driven_by(self, names: Iterable[str]) -> Self:
        """A copy in which more is driven from outside."""
        copy = self.model_copy()
        copy._driven = self._driven | frozenset(names)
        return copy

    @property
    def document(self) -> Document | None:
        """The file; None if the scene was made in Python."""
        return self._document

    @property
    def folder(self) -> Path:
        """Folder that files named in the scene are relative to."""
        return Path() if self._document is None else self._document.folder

    @classmethod
    def read(cls, path: str | Path | Document) -> Self:
        """Read and validate a file, or validate a document that was read already.

        Raises
        ------
        SceneError
            Listing every fault with its line, key and cure.
        """
        return validate(cls, Document.read(path))

    @classmethod
    def parse(cls, text: str, path: str | Path = "scene.yaml") -> Self:
        """Validate a text; `path` names it in messages.

        Raises
        ------
        SceneError
            Listing every fault with its line, key and cure.
        """
        return validate(cls, Document.parse(text, path))

    def replace(self, changes: Mapping[str, Any], origin: str = "replace") -> Self:
        """The scene as it would be read with other values in its file; this one stays as it is.

        Parameters
        ----------
        changes : mapping
            Key -> value: ``{"bodies[0].mass": "6 t", "solver.step": "2 ms"}``. Keys are those of the file, indices of
            lists in brackets; values are as in YAML: texts with units, numbers, lists, mappings.
        origin : str
            What the values came from, for messages.

        Returns
        -------
        Scene
            It shares what was prepared of this one as far as that does not depend on what is changed.

        Raises
        ------
        SceneError
            For an unknown key, with the nearest, and for a scene that is not sound with the new values.
        ArgumentTypeError
            For changes that are no mapping.
        """
        check_given(changes=(changes, MAPPING))
        known = self._known_parts(changes)
        return self._remade(lambda document: document.changed(changes, origin).with_parts(known), changes)

    def with_values(self, values: Mapping[Path_, tuple[Any, str]]) -> Self:
        """The same by key paths: key path -> (value, the option it came from, named in messages)."""
        return self._remade(lambda document: document.replaced(values))

    def varied(self, values: Mapping[Path_, Any], origin: str) -> Self:
        """The same by key paths, with one origin for all: key path -> value."""
        return self.with_values({path: (value, origin) for path, value in values.items()})

    @property
    def written(self) -> Mapping[str, Any]:
        """What the file says, key -> value, before it was validated.

        Raises
        ------
        SceneError
            For a scene that was put together in Python.
        """
        return self._text.root

    @property
    def _text(self) -> Document:
        if self._document is None:
            raise SceneError([self.problem("", *WITHOUT_TEXT)])
        return self._document

    def _remade(self, change: Callable[[Document], Document], changes: Mapping[str, Any] | None = None) -> Self:
        changed = self._with_document(change(self._text))
        changed.share(self)
        changed._driven = self._driven
        if changes:
            changed._keep_parts(self, changes)
        return changed

    def _known_parts(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """Parts of the file that the last variant had changed to the same: key -> what stood there.

        Variants that differ in a weight alone have one vessel: it is read once, and what was prepared of it stays.
        """
        if self._document is None or not (kept := self.__dict__.get(MADE, {}).get(PARTS)):
            return {}
        asked = _by_part(changes)
        return {
            key: part.value
            for key, part in kept.items()
            if part.base is self._document.root.get(key) and part.changes == asked.get(key)
        }

    def _keep_parts(self, base: Scene, changes: Mapping[str, Any]) -> None:
        """Keep the parts that were changed for the next variant: those of the last one only.

        One that names a file is not kept: the file may be written anew.
        """
        assert self._document is not None and base._document is not None
        names, kept = self._names(), self.__dict__[MADE].setdefault(PARTS, {})
        for key, asked in _by_part(changes).items():
            if key not in names or asked is None:
                continue
            value, model = self._document.root.get(key), getattr(self, names[key])
            if next(files_of(model), None) is None:
                kept[key] = _Part(base._document.root.get(key), asked, value, model)

    @classmethod
    @functools.cache
    def _names(cls) -> dict[str, str]:
        """Fields by the keys of the file."""
        return {field.alias or name: name for name, field in cls.model_fields.items()}

    def _with_document(self, document: Document) -> Self:
        """The scene of a document; of what is the same object there as in our own, or in the last variant, the models
        are taken over."""
        assert self._document is not None
        before, names, kept = self._document.root, self._names(), self.__dict__.get(MADE, {}).get(PARTS, {})
        root = {}
        for key, value in document.root.items():
            if key in names and value is before.get(key):
                root[key] = getattr(self, names[key])
            elif key in kept and value is kept[key].value:
                root[key] = kept[key].model
            else:
                root[key] = value
        try:
            scene = type(self).model_validate(root, context={"folder": document.folder})
        except ValidationError:
            # Read in full, it says what is wrong as it would have been written.
            return validate(type(self), document)
        scene._document = document
        return scene

    def once(self, what: str, depends_on: tuple[Any, ...], make: Callable[[], T]) -> T:
        """What `make` gives; it is called again only where what it depends on has changed.

        Copies of a scene share what was made of it, and so do scenes that `share`: a run, the run that measures its
        error, and the warnings before them prepare a scene once.

        Parameters
        ----------
        what : str
            Names what is made.
        depends_on : tuple
            All that `make` looks at, comparable: parts of the scene, and `reading.files.stamps` of its files.
        make : callable
            -> what is to be made.
        """
        made = self.__dict__.setdefault(MADE, {})
        known = made.get(what)
        if known is None or known[0] != depends_on:
            made[what] = known = (depends_on, make())
        return known[1]

    def share(self, other: Scene) -> None:
        """Use what was made `once` of another scene, where it depends on nothing in which the two differ."""
        self.__dict__[MADE] = other.__dict__.setdefault(MADE, {})

    def problem(self, key: str | tuple[str | int, ...], cause: str, cure: str = "") -> Problem:
        """Build a problem at a key path, for a check that needs more than the scene itself."""
        document = self._document or Document(Path("scene"), "", {}, tree=Document.parse("{}").tree)
        system = getattr(self, "units", "si")
        return document.problem(key, in_words(cause, system), in_words(cure, system))


M = TypeVar("M", bound=Model)


def validate(model: type[M], document: Document) -> M:
    """Turn a document into a model.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    based = [
        document.problem(path, "is a number of base 8 or 16", "write it with the digits 0 to 9")
        for path, text in document.scalars() if BASED.fullmatch(text) and not document.origin(path)
    ]  # fmt: skip
    if based:
        raise SceneError(based)
    try:
        scene = model.model_validate(document.root, context={"folder": document.folder})
    except ValidationError as error:
        problems = [_problem(e, document) for e in error.errors(include_url=False) if not _full(e)]
        problems = [one for one in problems if not _lacked_by_an_option(one, problems, document)]
        problems.sort(key=lambda problem: problem.line or 0)
        raise SceneError(list(dict.fromkeys(problems))) from None
    if isinstance(scene, Scene):
        scene._document = document
    return scene


def _lacked_by_an_option(problem: Problem, others: Sequence[Problem], document: Document) -> bool:
    """Whether a key is missing in a mapping that an option made, as the file's own is misspelt: what it lacks is there.

    ``--end`` makes a `solver` where the file says `solvr`.
    """
    *above, _ = split_key(problem.key) or ("",)
    made = bool(above) and document.origin(tuple(above)) is not None and document.line(tuple(above)) is None
    if problem.cause != "is missing" or not made:
        return False
    return any(one.cure.startswith(f"did you mean '{above[-1]}'?") for one in others)


def _full(error: Any) -> bool:
    """Whether a list is called too short that is long enough as written: pydantic counts entries without a fault."""
    given, least = error["input"], (error.get("ctx") or {}).get("min_length", 0)
    return error["type"] == "too_short" and isinstance(given, (list, tuple)) and len(given) >= least


def _problem(error: Any, document: Document) -> Problem:
    path = tuple(part for part in error["loc"] if not (isinstance(part, str) and part.startswith(MARK)))
    context = error.get("ctx") or {}
    if error["type"] == KIND:
        cause, cure = str(context.get("cause", "")), suited(str(context.get("cure", "")), error["input"])
        if "file" in context:
            return Problem(str(context["file"]), context.get("line"), "", None, cause, cure)
        before = str(context.get("before", ""))
        if before and (document.written((*path[:-1], before)) or "").startswith("-0"):
            cure = cure.replace("Write 0.", "Write -0.", 1)
        beside = str(context.get("beside", ""))
        if beside.startswith("."):
            beside = join_key((*path[:-1], beside[1:]))
        cause += _shown_beside(document, beside)
    else:
        cause, cure = plain_words(error)
    value = None
    if error["type"] != "missing" and document.written(path) is None and isinstance(error["input"], (str, int, float)):
        value = str(error["input"])
    return document.problem(path, cause, cure, value)


def _shown_beside(document: Document, key: str) -> str:
    """The value that another contradicts, in brackets: key, text and line; nothing where there is none."""
    written = document.written(key) if key else None
    if written is None:
        return ""
    place = document.origin(split_key(key)) or f"line {document.line(key)}"
    return f" ({key} = {shorten(written)}, {place})"


def plain_words(error: Any) -> tuple[str, str]:
    """Cause and cure of one of pydantic's own errors."""
    kind, given = str(error["type"]), error["input"]
    context: dict[str, Any] = error.get("ctx") or {}
    if kind == "literal_error":
        words = [word.strip(" '") for word in context["expected"].replace(" or ", ", ").split(", ")]
        close = difflib.get_close_matches(str(given)[:LONGEST], words, n=1)
        return "is not known here", must_be(words, close[0] if close else "")
    if given is None:
        return "is empty", "give a value, or remove the key"
    if isinstance(given, str) and (told := other_minus(given)):
        return told
    if kind.startswith("bool_"):
        return "must be true or false", _truth(given)
    names = {"int": ("a whole number", "12"), "string": ("a text", "drill pipe")}
    names |= {"float": ("a number", "0.5"), "tuple": ("a list", "[0, 1]"), "list": ("a list", "[0, 1]")}
    if kind.startswith("int_") and isinstance(given, float) and given.is_integer():
        return "must be a whole number, written without a point or an exponent", f"write {given:.0f}"
    if kind.startswith("int_") and isinstance(given, str) and re.fullmatch(r"[+-]?[0-9]+", given.strip()):
        return "is text, not a number", f"remove the quotes: write {given.strip()}"
    if kind in ("tuple_type", "list_type") and isinstance(given, dict):
        return "must be a list", f"write a list: {ENTRIES}"
    for name, (what, example) in names.items():
        if kind.startswith(f"{name}_"):
            return f"must be {what}", f"give {what} such as {example}"
    if kind in ("too_short", "too_long", "missing"):
        least, most = context.get("min_length"), context.get("max_length")
        if kind == "too_short" and least == 1:
            return "is an empty list", "give at least one entry"
        return f"has {context.get('actual_length', 'too few')} entries", f"give {least or most or 'all of them'}"
    limits = {"greater_than_equal": ("ge", "at least"), "greater_than": ("gt", "more than")}
    limits |= {"less_than_equal": ("le", "at most"), "less_than": ("lt", "less than")}
    if kind in limits:
        name, relation = limits[kind]
        return f"must be {relation} {context[name]}", f"give a number that is {relation} {context[name]}"
    return str(error["msg"]).lower(), "see the schema"


def _truth(given: Any) -> str:
    """What to write in place of a word or a number that was meant as true or false."""
    said = str(given).strip().lower()
    meant = next((word for word, others in TRUTHS.items() if said in others), None)
    if meant is None:
        return "write true or false, without quotes"
    why = "" if said == meant else f"; {given} is a {'number' if said in ('0', '1') else 'word'} in YAML 1.2"
    return f"write {meant}, without quotes{why}"
