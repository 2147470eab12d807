"""A YAML file as plain values, with the line of every key.

PyYAML parses; the values are constructed here, because its own construction reads `8.0e7` as text and `no` as false,
takes duplicate keys, expands aliases without limit and can build arbitrary objects. Nothing is ever evaluated.
"""

from __future__ import annotations

import functools
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

from tautline.scene.errors import Problem, SceneError, shorten
from tautline.scene.reading.scalars import BOOLEAN, FLOAT, INTEGER, LONGEST_INTEGER, NOT_FINITE, NULL, written_out
from tautline.scene.reading.text import read_text

DEEPEST = 50
MOST_VALUES = 1_000_000

Key = str | int
Path_ = tuple[Key, ...]

UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
KEY = re.compile(r"[^.\[\]\s][^.\[\]]*(\[[0-9]{1,9}\])*(\.[^.\[\]\s][^.\[\]]*(\[[0-9]{1,9}\])*)*")
NO_ITEM = re.compile(r"\s*(-[^\s:-][^\s:]*):")
"""An item of a list without the space behind its dash: YAML takes the dash for the first letter of a key."""
CLOSING = {"while parsing a flow mapping": "{}", "while parsing a flow sequence": "[]"}
"""What YAML is at when brackets are not closed -> both of them."""
REPEATABLE = frozenset({"plotpoints"})
"""Keys that may stand twice, the last one counting, since the example in the thesis' Appendix A does it: told in
`Document.repeats`, for the reader to warn of. Any other duplicate key is an error."""


@dataclass
class Node:
    """A value as it stands in the file: `children` by key or index, or a scalar; `size` counts all values below."""

    line: int
    value: Any = None
    children: dict[Key, Node] = field(default_factory=dict)
    key_lines: dict[Key, int] = field(default_factory=dict)
    mapping: bool = False
    scalar: str | None = None
    size: int = 1
    height: int = 1

    def add(self, key: Key, child: Node, line: int) -> None:
        """Hang a finished value below this one."""
        self.children[key] = child
        self.key_lines[key] = line
        self.size += child.size
        self.height = max(self.height, child.height + 1)
        if self.mapping:
            self.value[key] = child.value
        else:
            self.value.append(child.value)


@dataclass(frozen=True)
class Document:
    """A scene file that was read, not yet validated.

    Attributes
    ----------
    path, folder : Path
        The file, as it was named, and the folder that file names in it are relative to.
    text : str
        The whole text, as it was read; see `told`.
    root : dict
        Plain values: dict, list, str, int, float, bool, None.
    origins : dict
        Where values came from that are not in the text: key path -> option such as ``--step``.
    repeats : tuple
        Keys of `REPEATABLE` that stand more than once: key path, line of the one that was passed over.
    home : Path or None
        The folder, where that is not the one of ``path``: of a text that stands in no file.
    """

    path: Path
    text: str
    root: dict[str, Any]
    tree: Node = field(repr=False)
    origins: dict[Path_, str] = field(default_factory=dict)
    repeats: tuple[tuple[Path_, int], ...] = ()
    home: Path | None = None

    @property
    def folder(self) -> Path:
        """Folder that file names in the scene are relative to."""
        return self.path.parent if self.home is None else self.home

    @functools.cached_property
    def told(self) -> str:
        """A text that says what the document holds: its own, or one written anew where values were replaced."""
        if not self.origins:
            return self.text
        changed = "".join(f"# {shorten(join_key(path))}, by {origin}\n" for path, origin in self.origins.items())
        return f"# {self.path.name}, changed:\n{changed}{written_out(self.root)}"

    @classmethod
    def read(cls, source: str | Path | Document) -> Document:
        """Read a file; a document, which was read already, is given back.

        Raises
        ------
        SceneError
            If there is no such file, if it is no text or too large, or if it is not YAML.
        """
        return source if isinstance(source, Document) else cls.parse(read_text(Path(source)), source)

    @classmethod
    def parse(cls, text: str, path: str | Path = "scene.yaml", home: Path | None = None) -> Document:
        """Read a text; `path` names it in messages, `home` is its folder where that is not the one of the path.

        Raises
        ------
        SceneError
            If it is not one YAML mapping of plain values.
        """
        path = Path(path)
        composer = _Composer(text, path)
        tree = composer.compose()
        return cls(path, text, tree.value, tree, repeats=tuple(composer.repeats), home=home)

    def line(self, key: str | Path_) -> int | None:
        """Line of a key path such as ``("string", 1, "od")`` or ``"string[1].od"``, or of the nearest above it."""
        node, line = self.tree, None
        for part in split_key(key):
            if part not in node.children:
                break
            line, node = node.key_lines[part], node.children[part]
        return line

    def scalars(self) -> Iterator[tuple[Path_, str]]:
        """Key path and text of every number of the file, as its author wrote it, in the order of the file."""
        left: list[tuple[Path_, Node]] = [((), self.tree)]
        while left:
            path, node = left.pop()
            if node.scalar is not None and isinstance(node.value, (int, float)):
                yield path, node.scalar
            left += [((*path, key), child) for key, child in reversed(node.children.items())]

    def written(self, key: str | Path_) -> str | None:
        """Return the text of a scalar as its author wrote it, None for anything else."""
        node, path = self.tree, split_key(key)
        if self.origin(path):
            value: Any = self.root
            for part in path:
                inside = isinstance(value, list) and part in range(len(value))
                value = value.get(part) if isinstance(value, dict) else value[part] if inside else None
            return None if value is None or isinstance(value, (dict, list)) else str(value)
        for part in path:
            if part not in node.children:
                return None
            node = node.children[part]
        return node.scalar

    def origin(self, path: Path_) -> str | None:
        """Option that a value, or the last of those that were changed in it, came from, such as ``--step``.

        None for what is in the text, and for the whole scene.
        """
        ends = range(len(path), 0, -1)
        outside = (self.origins[path[:end]] for end in ends if path[:end] in self.origins)
        inside = (origin for at, origin in reversed(self.origins.items()) if path and at[: len(path)] == path)
        return next(outside, None) or next(inside, None)

    def replaced(self, values: Mapping[Path_, tuple[Any, str]]) -> Document:
        """Copy with other values: key path -> (value, the option it came from, named in messages).

        A path may add a key to a mapping, and mappings on the way are made; it may not pass through a scalar.

        Raises
        ------
        PartlyReplacedError
            If a path leads through something that has no keys; it has the copy with all other values.
        """
        # What nothing is changed in stays the same object: it need not be read again.
        touched = {path[0] for path in values if path} if isinstance(self.root, dict) else set()
        root = {key: _copied(item) if key in touched else item for key, item in self.root.items()}
        origins, wrong = dict(self.origins), list[Problem]()
        for path, (value, origin) in values.items():
            try:
                _put(root, path, value, origin)
            except SceneError as error:
                wrong += error.problems
            else:
                origins[path] = origin
        made = replace(self, root=root, origins=origins)
        if wrong:
            raise PartlyReplacedError(wrong, made)
        return made

    def changed(self, values: Mapping[str, Any], origin: str) -> Document:
        """Copy with other values.

        Parameters
        ----------
        values : mapping
            Key such as ``bodies[0].mass`` -> value as it would stand in the file.
        origin : str
            What the values came from, for messages: ``--set``.

        Raises
        ------
        PartlyReplacedError
            For what is no name of a key, a value that no file could hold, and as `replaced` does.
        """
        named, wrong = dict[Path_, tuple[Any, str]](), list[Problem]()
        for key, value in values.items():
            try:
                named[key_named(key, origin)] = value, origin
            except SceneError as error:
                wrong += error.problems
        return in_turn(self, lambda document: _refuse(wrong, document), lambda document: document.replaced(named))

    def with_parts(self, known: Mapping[str, Any]) -> Document:
        """The same with objects, equal to its own, in the place of its parts: key -> object."""
        return replace(self, root={**self.root, **known}) if known else self

    def problem(self, key: str | Path_, cause: str, cure: str = "", value: str | None = None) -> Problem:
        """Build a problem at a key path; the value is shown as written."""
        path = split_key(key)
        shown, origin = self.written(path) if value is None else value, self.origin(path)
        if origin:
            return Problem(origin, None, join_key(path), shown, cause, cure)
        return Problem(str(self.path), self.line(path) or 1, join_key(path), shown, cause, cure)


class PartlyReplacedError(SceneError):
    """Values that cannot be put into a document.

    Attributes
    ----------
    document : Document
        The document with those values that can: what they replace is no fault any more.
    """

    def __init__(self, problems: Iterable[Problem], document: Document) -> None:
        super().__init__(problems)
        self.document = document


def in_turn(document: Document, *changes: Callable[[Document], Document]) -> Document:
    """The document with one change after another; PartlyReplacedError tells the faults of all of them."""
    wrong: list[Problem] = []
    for change in changes:
        try:
            document = change(document)
        except PartlyReplacedError as error:
            document, wrong = error.document, [*wrong, *error.problems]
    return _refuse(wrong, document)


def _refuse(wrong: Sequence[Problem], document: Document) -> Document:
    """The document as it is; PartlyReplacedError where something is wrong with values that were to be put into it."""
    if wrong:
        raise PartlyReplacedError(wrong, document)
    return document


def _put(root: dict[str, Any], path: Path_, value: Any, origin: str) -> None:
    """Put a value into a mapping, with the mappings that lack on the way; nothing changes where it finds no place."""
    place: Any = root
    for i, part in enumerate(path):
        if (wrong := _no_place(place, part)) is not None:
            raise SceneError([Problem(origin, None, join_key(path[: i + 1]), None, *wrong)])
        below = place.get(part) if isinstance(place, dict) else place[part]
        place = {} if below is None and isinstance(place, dict) else below
    value, place = plain(value, path, origin), root
    for part in path[:-1]:
        if isinstance(place, dict) and place.get(part) is None:
            place[part] = {}
        place = place[part]
    if path:
        place[path[-1]] = value


def _copied(value: Any) -> Any:
    """A copy in which what an alias repeats stands once for each place: a change of one is no change of the other."""
    if isinstance(value, dict):
        return {key: _copied(item) for key, item in value.items()}
    return [_copied(item) for item in value] if isinstance(value, list) else value


def _no_place(place: Any, part: Key) -> tuple[str, str] | None:
    """Why a value has nothing of some key or index, and what to do; None where it has, or can be given it."""
    if isinstance(place, dict) and isinstance(part, str):
        return None
    if isinstance(place, list):
        if isinstance(part, int) and part < len(place):
            return None
        if isinstance(part, str):
            return "this is a list, not a mapping", "name one of its entries by a number in brackets, the first by [0]"
        return "there is no such entry", f"{len(place)} in all, counted from 0: to add one, give the whole list"
    if place == {}:
        return "there is no list of this name", "check the name; small and capital letters differ"
    if isinstance(place, dict):
        return "is a mapping, not a list", f"known: {', '.join(map(shorten, place))}"
    return "there is no such key: what it should be in is a single value", "check the name, or give a whole mapping"


def key_named(name: str, origin: str) -> Path_:
    """``bodies[0].mass`` -> ``("bodies", 0, "mass")``; raises SceneError for what is no name of a key."""
    if isinstance(name, str) and KEY.fullmatch(name):
        return split_key(name)
    cure = "write it with a point before each key and a list's index in brackets, as string[0].od"
    raise SceneError([Problem(origin, None, "", str(name), "is no name of a key", cure)])


def _bare_part(line: str) -> str:
    """A name such as ``crate.position[2]`` that stands without quotes between { and }; empty where there is none."""
    rest = re.sub(r"\"[^\"]*\"|'[^']*'", "", line)
    found = re.search(r"\{(?:[^}]*?[:,{])? *([\w .-]*\w\[\d+\][\w.\[\]]*)", rest)
    return found.group(1).strip() if found else ""


def _dash_or_bracket(what: str, context: str, line: str, at_end: bool) -> tuple[str, str] | None:
    """Cause and cure of two slips that YAML describes by what it expected in place of them; None where it is neither.

    Parameters
    ----------
    what, context : str
        What YAML says of it, and what it was reading.
    line : str
        The line where it stopped.
    at_end : bool
        Whether nothing more stands in the file.
    """
    dash = NO_ITEM.match(line) if "indicator" in what or "<block end>" in what else None
    if dash is not None:
        cause = f"'{dash[1]}' is taken for a key: no space stands after its -"
        return cause, f"put a space after -, for an item of the list: `- {dash[1][1:]}:`"
    if at_end and (brackets := CLOSING.get(context)):
        return f"the bracket {brackets[0]} is not closed", f"write {brackets[1]} where its values end"
    return None


def _quoted(text: str) -> str:
    """A text as YAML wants it where it holds what else has a meaning."""
    return "'" + text.replace("'", "''") + "'"


def split_key(key: str | Path_) -> Path_:
    """``string[1].od`` -> ``("string", 1, "od")``."""
    if not isinstance(key, str):
        return tuple(key)
    parts = re.findall(r"[^.\[\]]+|\[\d+\]", key)
    return tuple(int(part[1:-1]) if part.startswith("[") else part for part in parts)


def join_key(path: Path_) -> str:
    """``("string", 1, "od")`` -> ``string[1].od``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def plain(value: Any, path: Path_ = (), origin: str = "") -> Any:
    """A copy of a Python value as a file would give it: dict, list, str, int, float, bool, None.

    Numbers and arrays of NumPy, tuples and paths become what they stand for.

    Raises
    ------
    SceneError
        For a value that no file can hold, with its key, and with its `origin` in place of the file.
    """
    if len(path) > DEEPEST:
        cause, cure = f"is nested more than {DEEPEST} deep", "check whether something stands inside of itself"
        raise SceneError([Problem(origin, None, join_key(path), None, cause, cure)])
    if hasattr(value, "tolist"):
        value = value.tolist()
    elif isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, dict):
        return {str(key): plain(each, (*path, str(key)), origin) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(each, (*path, i), origin) for i, each in enumerate(value)]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    cause, cure = f"a {type(value).__name__} cannot stand in a scene", "give a number, a text, a list or a dict"
    raise SceneError([Problem(origin, None, join_key(path), None, cause, cure)])


class _Composer:
    """Turns parser events into nodes, without recursion and within limits."""

    def __init__(self, text: str, path: Path) -> None:
        self.text, self.path = text, path
        self.anchors: dict[str, Node] = {}
        self.open: dict[str, Node] = {}
        self.stack: list[tuple[Node, str | None]] = []
        self.keys: list[tuple[str, int] | None] = []
        self.root: Node | None = None
        self.repeats: list[tuple[Path_, int]] = []

    def refuse(self, line: int | None, cause: str, cure: str = "", value: str | None = None) -> SceneError:
        return SceneError([Problem(str(self.path), line, join_key(self._place()), value, cause, cure)])

    def _place(self) -> Path_:
        """Key path of what is being read."""
        keys: list[Key] = []
        for (node, _), key in zip(self.stack, self.keys, strict=True):
            if node.mapping and key is not None:
                keys.append(key[0])
            elif not node.mapping:
                keys.append(len(node.children))
        return tuple(keys)

    def compose(self) -> Node:
        bad = UNPRINTABLE.search(self.text.removeprefix("\ufeff"))
        if bad:
            row = self.text.count("\n", 0, bad.start()) + 1
            raise self.refuse(row, f"the character U+{ord(bad[0]):04X} is not text", "remove it")
        documents = 0
        try:
            for event in self._events():
                mark: Any = event.start_mark
                line = mark.line + 1
                if isinstance(event, yaml.NodeEvent):
                    self._begin(event, line)
                elif isinstance(event, yaml.DocumentStartEvent):
                    documents += 1
                    if documents > 1:
                        raise self.refuse(
                            line, "a second document begins", "keep one scene in a file: remove the '---'"
                        )
                elif isinstance(event, yaml.CollectionEndEvent):
                    self._end(line)
        except yaml.MarkedYAMLError as error:
            raise self._syntax(error) from None
        except yaml.YAMLError as error:
            raise self.refuse(None, f"is not YAML: {error}", "check the file") from None
        if self.root is None or self.root.scalar == "":
            raise self.refuse(
                1, "is empty", "write a scene; the verb `new` writes one to start from, as `crane new` does"
            )
        if not self.root.mapping:
            kind = "a list" if self.root.scalar is None else "a single value"
            raise self.refuse(
                self.root.line, f"a scene is a mapping of keys to values, not {kind}", "write `key: value` lines"
            )
        return self.root

    def _events(self) -> Iterator[yaml.Event]:
        return iter(yaml.parse(self.text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)))

    def _begin(self, event: yaml.NodeEvent, line: int) -> None:
        waiting = bool(self.stack) and self.stack[-1][0].mapping and self.keys[-1] is None
        tag = getattr(event, "tag", None)
        if tag is not None:
            shown = tag.replace("tag:yaml.org,2002:", "!!")
            raise self.refuse(
                line, f"the tag {shown} is not allowed: nothing in a scene is evaluated", "remove the tag"
            )
        if waiting:
            self._key(event, line)
        elif isinstance(event, yaml.AliasEvent):
            if event.anchor in self.open:
                raise self.refuse(line, f"the alias *{event.anchor} stands inside of what it repeats", "write it out")
            if event.anchor not in self.anchors:
                raise self.refuse(
                    line, f"the alias *{event.anchor} repeats nothing", f"mark a value with &{event.anchor} first"
                )
            self._finish(self.anchors[event.anchor], line)
        elif isinstance(event, yaml.ScalarEvent):
            plain = event.implicit[0] and not event.style
            node = Node(line, self._scalar(event.value, line) if plain else event.value, scalar=event.value)
            if event.anchor:
                self.anchors[event.anchor] = node
            self._finish(node, line)
        else:
            if len(self.stack) >= DEEPEST:
                raise self.refuse(line, f"is nested more than {DEEPEST} deep", "check the brackets and aliases")
            mapping = isinstance(event, yaml.MappingStartEvent)
            node = Node(line, {} if mapping else [], mapping=mapping)
            if event.anchor:
                self.open[event.anchor] = node
            self.stack.append((node, event.anchor))
            self.keys.append(None)

    def _key(self, event: yaml.NodeEvent, line: int) -> None:
        if not isinstance(event, yaml.ScalarEvent):
            raise self.refuse(line, "a key must be a word", "write `key: value`")
        key = event.value
        if key == "<<":
            raise self.refuse(
                line, "the merge key << is not supported", "write the keys out, or repeat a whole value with an alias"
            )
        node = self.stack[-1][0]
        self.keys[-1] = (key, line)
        if key in node.children:
            first = node.key_lines[key]
            if key in REPEATABLE:
                self.repeats.append((self._place(), first))
                return
            raise self.refuse(line, f"duplicate key: it stands in line {first} already", "keep one of the two")

    def _end(self, line: int) -> None:
        node, anchor = self.stack.pop()
        self.keys.pop()
        if anchor:
            self.open.pop(anchor, None)
            self.anchors[anchor] = node
        self._finish(node, node.line)

    def _finish(self, node: Node, line: int) -> None:
        if not self.stack:
            self.root = node
            return
        parent, key = self.stack[-1][0], self.keys[-1]
        if parent.size + node.size > MOST_VALUES:
            cause = f"holds more than {MOST_VALUES} values"
            cure = "keep long tables in a CSV file; make the mesh coarser"
            if self.anchors:
                cause, cure = f"{cause} once its aliases are written out", f"remove the aliases; {cure}"
            raise self.refuse(line, cause, cure)
        if node.height + len(self.stack) > DEEPEST:
            raise self.refuse(line, f"is nested more than {DEEPEST} deep", "check the brackets and aliases")
        if parent.mapping:
            assert key is not None
            parent.add(key[0], node, key[1])
            self.keys[-1] = None
        else:
            parent.add(len(parent.children), node, line)

    def _scalar(self, text: str, line: int) -> Any:
        """Read a plain scalar by the core schema of YAML 1.2."""
        if NULL.fullmatch(text):
            return None
        if BOOLEAN.fullmatch(text):
            return text[0] in "tT"
        if INTEGER.fullmatch(text) and len(text) <= LONGEST_INTEGER:
            base = {"0o": 8, "0x": 16}.get(text[:2], 10)
            return int(text[2:], base) if base != 10 else int(text)
        finite = not NOT_FINITE.fullmatch(text)
        if finite and not FLOAT.fullmatch(text):
            return text
        value = float(text) if finite else math.nan
        if not math.isfinite(value):
            raise self.refuse(line, "is not a finite number", "give a number that can be computed with", text)
        return value

    def _syntax(self, error: yaml.MarkedYAMLError) -> SceneError:
        mark: Any = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else None
        lines = self.text.splitlines()
        around = lines[line - 1] if line and line <= len(lines) else ""
        what = str(error.problem or error.context or "cannot be read")
        if "nesting depth" in what:  # PyYAML's own limit, from 6.0.4 on
            return self.refuse(line, f"is nested more than {DEEPEST} deep", "check the brackets and aliases")
        if "\t" in around[: (mark.column if mark else 0) + 1] or re.match(r" *\t", around):
            # The key of the line is not read: the last one that was is another's.
            self.stack, self.keys = [], []
            return self.refuse(line, "a tab stands where YAML wants spaces", "indent with spaces")
        if "mapping values are not allowed" in what and ": " in around[: mark.column]:
            cause = "a colon followed by a space stands inside a text, and YAML takes it for another key"
            key, text = around.strip().split(": ", 1)
            return self.refuse(line, cause, f"put the text in quotes: {shorten(f'{key}: {_quoted(text)}')}")
        if bare := _bare_part(around):
            cause = f"{bare} stands between {{ and }}, where YAML takes a bracket for the start of a list"
            return self.refuse(line, cause, f'put the name in quotes: "{bare}"')
        began: Any = error.context_mark
        at_end = bool(line) and not any(lines[(line or 1) - 1 :])
        if slip := _dash_or_bracket(what, str(error.context), around, at_end):
            return self.refuse(began.line + 1 if at_end and began else line, *slip)
        since = f" ({error.context}, line {began.line + 1})" if began and error.context else ""
        return self.refuse(
            line, f"is not YAML: {what}{since}", "check the indentation, colons and brackets here and above"
        )
