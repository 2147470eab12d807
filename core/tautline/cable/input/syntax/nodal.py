"""What may stand at nodes: forces, springs, masses, constraints; each kind is registered once, and then known to all.

One `NodalItem` says everything of a kind: the key under ``CableModel`` and the model of what is written there, the
groups of the solver that it becomes, and what the program has to know of it besides. Ours are in
`tautline.cable.input.syntax.nodal_items`; a user's own stand in a file of his (docs/extending.md).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import model_validator

from tautline.cable.input.syntax.entries import Id, Ids
from tautline.errors import ArgumentError, ArgumentTypeError
from tautline.scene.identity.frozen import says_what_to_do
from tautline.scene.model import Model
from tautline.scene.refusal import fault

Place = tuple[str | int, ...]


class OnNodes(Model):
    """Something at nodes of either kind: the base of the model of a kind of item."""

    id: Id | None = None
    nodes7: Ids | None = None
    nodes4: Ids | None = None

    @model_validator(mode="after")
    def _somewhere(self) -> OnNodes:
        if self.nodes7 is None and self.nodes4 is None:
            raise fault("nodes7", "is missing", "add `nodes7:`, such as [2], or nodes4 for nodes of linear elements")
        if self.nodes7 is not None and self.nodes4 is not None:
            raise fault("nodes4", "is given together with nodes7", "keep one; write a second item for the other")
        return self


@says_what_to_do
@dataclass(frozen=True, slots=True)
class NodalPart:
    """An item as the builder meets it: its key, its model, the ids of its nodes, its line and key path in the file."""

    key: str
    model: Any
    nodes: tuple[int, ...]
    line: int
    place: Place

    @property
    def id(self) -> int | None:
        """Its number in the file, if it has one."""
        return self.model.id


def _nothing(part: Any) -> float:
    return 0.0


def _none(*given: Any) -> tuple[Any, ...]:
    return ()


def each_node(layout: Any, part: Any) -> list[np.ndarray]:
    """The three coordinates of each node, for `NodalItem.coupled`: a force that looks at one node at a time."""
    return [layout.start[node] + np.arange(3) for node in part.nodes]


def all_nodes(layout: Any, part: Any) -> list[np.ndarray]:
    """The coordinates of all nodes together, for `NodalItem.coupled`: a force between nodes."""
    return [np.concatenate(each_node(layout, part))]


@dataclass(frozen=True)
class NodalItem:
    """A kind of item on nodes.

    Attributes
    ----------
    key : str
        The key under ``CableModel``.
    model : type
        What may be written there: a subclass of `OnNodes`, frozen; units and bounds by `quantity`.
    groups : callable
        ``groups(layout, parts)``: the groups of the solver for all items of the kind; there is at least one.
        ``layout.start[node]`` is the place of a node's x in the vectors of positions, ``layout.initial`` their values
        at the start. Compiled code is best imported in it, so that ``check`` does not wait for a compiler.
    coupled : callable
        ``coupled(layout, part)``: arrays of places, each of which the tangent couples with one another:
        `each_node` or `all_nodes`, or your own.
    mass, force, stiffness : callable
        Of a part, at each of its nodes: mass kg, size of the force N, and stiffness N/m. The mass counts as that of the
        node, mass and force scale the tolerance, and the stiffness enters RK4's critical step in ``check``.
    equations : callable
        ``equations(layout, part)``: linear equations between positions, which Lagrange multipliers keep:
        (row, offset, name) each; row is a list of (place, factor), and the sum of factor times q plus offset is zero.
    warnings : callable
        ``warnings(scene, part)``: (key path, text) of what is odd about an item.

    A number that a scene may not have is refused by the model, by annotations such as `quantity` and `not_zero`: a
    SceneError with line, key and cure.
    """

    key: str
    model: type[OnNodes]
    groups: Callable[[Any, Sequence[Any]], Sequence[Any]] = _none
    coupled: Callable[[Any, Any], Iterable[np.ndarray]] = each_node
    mass: Callable[[Any], float] = _nothing
    force: Callable[[Any], float] = _nothing
    stiffness: Callable[[Any], float] = _nothing
    equations: Callable[[Any, Any], Iterable[tuple[list[tuple[int, float]], float, str]]] = _none
    warnings: Callable[[Any, Any], Iterable[tuple[Place, str]]] = _none

    def made(self, model: Any, place: Place, line: int, nodes: tuple[int, ...]) -> NodalPart:
        """The part of an item in a scene."""
        return NodalPart(self.key, model, tuple(nodes), line, place)


NODAL: dict[str, NodalItem] = {}
"""All kinds, in the order in which their forces are added up."""


def register_item(item: NodalItem) -> None:
    """Make a kind of item known; one from the same module takes the place of an earlier one, as in a notebook.

    Raises
    ------
    ArgumentTypeError
        If its model is no `OnNodes`.
    ArgumentError
        If another module has registered the key.
    """
    if not (isinstance(item.model, type) and issubclass(item.model, OnNodes)):
        raise ArgumentTypeError(
            f"{item.key}: its model must be a subclass of tautline.cable.input.syntax.nodal.OnNodes"
        )
    earlier = NODAL.get(item.key)
    if earlier is not None and earlier.model.__module__ != item.model.__module__:
        raise ArgumentError(
            f"{item.key}: {earlier.model.__module__} has registered an item of this name; choose another"
        )
    NODAL[item.key] = item


def item_of(part: Any) -> NodalItem:
    """The kind of a part."""
    return NODAL[part.key]
