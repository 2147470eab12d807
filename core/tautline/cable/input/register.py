"""The items of a cable's file by their kinds and ids, and the faults that are found in them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Any, NamedTuple

from tautline.cable.input.parts import Place
from tautline.cable.input.syntax import models as w
from tautline.scene.errors import Problem, SceneError
from tautline.scene.reading.document import Document

SPACES: dict[type, str] = {
    w.Node7Dof: "node",
    w.Node4Dof: "node",
    w.CubicElement: "element",
    w.LinearElement: "element",
    w.VelocityDefined: "function",
    w.Function: "function",
}
"""Kinds of item that share their ids; all others are told apart by their key, with 7 or 4 at its end or not."""


class Numbered(NamedTuple):
    """A `CableLine` of a file: model, key path, kind of its nodes (7 or 4), and the ids of all of them, end to end."""

    model: w.Line
    place: Place
    kind: int
    nodes: tuple[int, ...]

    @property
    def key(self) -> str:
        """The key that names its ends."""
        return f"nodes{self.kind}"

    @property
    def between(self) -> tuple[int, ...]:
        """Ids of the nodes between its ends."""
        return self.nodes[1:-1]

    @property
    def elements(self) -> range:
        """Ids of its elements."""
        return range(self.model.id, self.model.id + self.model.elements)


class Register:
    """All items, the nodes by their ids, those between the ends of lines, and the faults found so far."""

    def __init__(self, document: Document, items: list[tuple[str, Any, Place]]) -> None:
        self.document, self.items = document, items
        self.problems: list[Problem] = []
        self.nodes: dict[int, Any] = {}
        for _, model, _ in items:
            if isinstance(model, (w.Node7Dof, w.Node4Dof)):
                self.nodes.setdefault(model.id, model)
        self.lines = numbered(items, self.nodes)
        self.between = {node: line.kind for line in self.lines for node in line.between}

    def of(self, *kinds: type) -> list[tuple[str, Any, Place]]:
        """Items of some kinds: key, model, key path."""
        return [item for item in self.items if type(item[1]) in kinds]

    def refuse(self, place: Place, cause: str, cure: str, value: str | None = None) -> None:
        """Note a fault."""
        self.problems.append(self.document.problem(place, cause, cure, value))

    def report(self) -> None:
        """Raise what was found, in the order of the file."""
        if self.problems:
            raise SceneError(sorted(dict.fromkeys(self.problems), key=lambda problem: problem.line or 0))

    def line(self, place: Place) -> int:
        """Line of a key path."""
        return self.document.line(place) or 1

    def dofs(self, node: int) -> int:
        """Number of degrees of freedom of a node: 7 or 4."""
        if node in self.nodes:
            return 7 if isinstance(self.nodes[node], w.Node7Dof) else 4
        return self.between[node]

    def is_held(self, node: int, number: int) -> bool:
        """Whether a node holds a degree of freedom, numbered from one; those between the ends of a line hold p."""
        if node in self.nodes:
            return bool(self.nodes[node].BC[number - 1])
        return number == self.between[node]

    @property
    def element_ids(self) -> list[int]:
        """Ids of all elements."""
        one = [model.id for _, model, _ in self.of(w.CubicElement, w.LinearElement)]
        return [*one, *(id for line in self.lines for id in line.elements)]

    def check_ids(self) -> None:
        """Every id once; at least one node and one element."""
        spaces: dict[str, list[tuple[Sequence[int], Place]]] = {}
        for key, model, place in self.items:
            space = SPACES.get(type(model), key.removesuffix("7").removesuffix("4"))
            if model.id is not None and not isinstance(model, w.Line):
                spaces.setdefault(space, []).append(((model.id,), (*place, "id")))
        for line in self.lines:
            spaces.setdefault("element", []).append((line.elements, (*line.place, "id")))
            spaces.setdefault("node", []).append((line.between, (*line.place, "between")))
        for space, entries in spaces.items():
            lines: dict[int, int] = {}
            for numbers, place in sorted(entries, key=lambda entry: entry[1][1]):
                twice = next((number for number in numbers if number in lines), None)
                if twice is not None:
                    is_line = place[2] == "CableLine"
                    which = f"the id {twice}, which is one of this line's {len(numbers)}," if is_line else "this id"
                    cause = f"the {space} in line {lines[twice]} has {which} already"
                    cure = f"give it one of its own, such as {max(max(ids, default=0) for ids, _ in entries) + 1}"
                    self.refuse(place, cause, cure)
                at = self.line(place[:-1])
                for number in numbers:
                    lines.setdefault(number, at)
        if not self.nodes:
            cure = f"add `- {w.EXAMPLE[1:-1]}`"
            self.refuse(("CableModel",), "has no nodes", cure)
        if not self.of(w.CubicElement, w.LinearElement, w.Line):
            cure = "add `- CableALEelement: {id: 0, nodes7: [0, 1], EA: 1.0e6, rhoA: 1.0}`"
            self.refuse(("CableModel",), "has no cable elements", cure)

    def has_node(self, place: Place, node: int, kind: int | None = None, instead: str = "") -> bool:
        """Whether a node exists and is of a kind; notes a fault if not."""
        if node not in self.nodes and node not in self.between:
            known = known_ids({*self.nodes, *self.between})
            self.refuse(place, f"there is no node {node}", f"known: {known}", str(node))
            return False
        if kind is not None and self.dofs(node) != kind:
            cause = f"node {node} is a Node{self.dofs(node)}Dof, and a Node{kind}Dof is wanted"
            self.refuse(place, cause, instead or f"name a Node{kind}Dof", str(node))
            return False
        return True

    def make(self, kind: type, build: Callable[[Any, Place, int, Any], Any]) -> tuple[Any, ...]:
        """Parts that sit on nodes: ``build(model, place, line, ids)`` for each item whose nodes are good."""
        made = []
        for _, model, place in self.of(kind):
            key, dofs = ("nodes7", 7) if model.nodes7 is not None else ("nodes4", 4)
            ids = getattr(model, key)
            other = "nodes4" if dofs == 7 else "nodes7"
            good = [self.has_node((*place, key, i), node, dofs, f"write {other}") for i, node in enumerate(ids)]
            if len(set(ids)) < len(ids):
                self.refuse((*place, key), "names a node twice", "name each node once")
            elif all(good):
                made.append(build(model, place, self.line(place), ids))
        return tuple(made)


def numbered(items: Sequence[tuple[str, Any, Place]], nodes: Collection[int]) -> list[Numbered]:
    """Lines among the items of a file, their nodes numbered as they say, or after all that have a number."""
    lines = [(model, place) for _, model, place in items if isinstance(model, w.Line)]
    given = [model.between + model.elements - 1 for model, _ in lines if model.between is not None]
    following, found = max([-1, *nodes, *(last - 1 for last in given)]) + 1, []
    for model, place in lines:
        first, last = model.nodes7 or model.nodes4 or ()
        begin = following if model.between is None else model.between
        if model.between is None:
            following += model.elements - 1
        kind = 7 if model.nodes7 is not None else 4
        found.append(Numbered(model, place, kind, (first, *range(begin, begin + model.elements - 1), last)))
    return found


def known_ids(ids: Iterable[int]) -> str:
    """Ids in words: ``0 to 4``, or a list if there are gaps."""
    known = sorted(ids)
    if len(known) > 2 and known[-1] - known[0] == len(known) - 1:
        return f"{known[0]} to {known[-1]}"
    return ", ".join(map(str, known[:12])) + (", ..." if len(known) > 12 else "") or "none"
