"""Variables of an OPC UA server, and which of them a column is."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tautline.twin.sources.reading_units import unit_of_code

DEEPEST, LARGEST = 8, 5000
"""Levels and nodes that are searched for a name."""
TOGETHER = 8
"""Nodes that the server is asked about at a time."""
LISTED = 4
"""Node ids that a message names at most."""


@dataclass(frozen=True)
class Variable:
    """A variable of a server.

    Attributes
    ----------
    id : str
        Node id, ``ns=2;s=Winch.Position``.
    name : str
        Browse name.
    path : tuple of str
        Node ids of the folders above it, from below Objects on.
    folder : str
        Their names, for messages.
    """

    id: str
    name: str
    path: tuple[str, ...] = ()
    folder: str = ""

    def __str__(self) -> str:
        return f"{self.id} ({self.folder or 'Objects'})"


@dataclass
class Choice:
    """Which variables the columns are.

    Attributes
    ----------
    ids : dict of str to str
        Node ids by column.
    doubted : dict of str to str
        Why a column that is there is not taken, for the user.
    remarks : list of str
        What is to be known of those that are taken.
    """

    ids: dict[str, str] = field(default_factory=dict)
    doubted: dict[str, str] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)


def is_id(column: str) -> bool:
    """Whether a column is a node id rather than a browse name."""
    return column.startswith(("ns=", "i=", "s="))


def chosen(columns: Sequence[str], variables: Sequence[Variable]) -> Choice:
    """Choose variables for columns: by their ids, or by names that only one variable has.

    Two machines at one server have variables of equal names. Such a name says nothing, and a name that is there once
    may be of the other machine: it is taken only where it stands apart from the namesakes of the columns that are not
    meant.
    """
    found, known = Choice(), {one.id: one for one in variables}
    named: dict[str, list[Variable]] = {}
    for one in variables:
        named.setdefault(one.name, []).append(one)
    others = list[tuple[Variable, Variable]]()  # a namesake that is not meant, or may not be, and the one that is
    single: dict[str, Variable] = {}
    for column in columns:
        if is_id(column):
            found.ids[column] = column
    meant = {known[one].id for one in found.ids if one in known}
    for column in columns:
        if is_id(column):
            if column in known:
                others += [(a, known[column]) for a in named[known[column].name] if a.id not in meant]
        elif len(same := named.get(column, [])) > 1:
            others += [(a, b) for a in same for b in same if a is not b]
            which = listed([str(one) for one in same])
            found.doubted[column] = (
                f"the server has {len(same)} variables {column}: {which}. Nothing shows which one is meant"
            )
        elif same:
            single[column] = same[0]
    for column, one in single.items():
        other = next((a for a, b in others if _is_beside(one, a, b)), None)
        if other is None:
            found.ids[column] = one.id
        else:
            found.doubted[column] = (
                f"{column} is {one}. It stands with {other.name} {other}, and that one may be of another machine"
            )
    taken = {column: known[one] for column, one in found.ids.items() if one in known}
    if single.keys() & taken and len({one.path for one in taken.values()}) > 1:
        places = listed([f"{column} is {one}" for column, one in taken.items()])
        found.remarks.append(
            f"the columns are variables of several folders: {places}. "
            "If these belong to several machines, write the right node ids as `column` in the map"
        )
    return found


def listed(names: Sequence[str], most: int = LISTED) -> str:
    """Names for a message, with how many more there are."""
    more = len(names) - most
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:most])} and {more} more"


def _is_beside(one: Variable, other: Variable, meant: Variable) -> bool:
    """Whether a variable is in the part of the server that has another one, and not the namesake of that."""
    first, second = (*other.path, other.id), (*meant.path, meant.id)
    parts = next((k for k, (a, b) in enumerate(zip(first, second, strict=False)) if a != b), 0)
    return one.path[: parts + 1] == first[: parts + 1]


async def variables_of(client: Any) -> tuple[list[Variable], bool]:
    """All variables below Objects without those of the server itself, and whether all nodes were looked at."""
    from asyncua import ua

    found, seen, whole = [], {client.nodes.server.nodeid}, True
    level: list[tuple[Any, tuple[str, ...], str]] = [(client.nodes.objects, (), "")]
    for _ in range(DEEPEST):
        below = []
        for some in _in_parts(level):
            listed = await asyncio.gather(*(node.get_children_descriptions() for node, _, _ in some))
            for (_, path, folder), children in zip(some, listed, strict=True):
                for child in children:
                    if child.NodeId in seen or child.NodeClass not in (ua.NodeClass.Object, ua.NodeClass.Variable):
                        continue
                    seen.add(child.NodeId)
                    one, name = child.NodeId.to_string(), child.BrowseName.Name
                    if child.NodeClass == ua.NodeClass.Variable:
                        found.append(Variable(one, name, path, folder))
                    where = f"{folder}/{name}" if folder else name
                    below.append((client.get_node(child.NodeId), (*path, one), where))
            if len(seen) > LARGEST:
                return found, False
        level, whole = below, not below
        if whole:
            break
    return found, whole


def _in_parts(level: Sequence[Any]) -> Iterator[Sequence[Any]]:
    for k in range(0, len(level), TOGETHER):
        yield level[k : k + TOGETHER]


async def unit_nodes(nodes: Mapping[str, Any]) -> dict[str, Any]:
    """The variable of the unit of each column that the server has one of (OPC UA part 8: EngineeringUnits)."""
    found = await asyncio.gather(*(_unit_node(node) for node in nodes.values()))
    return {column: node for column, node in zip(nodes, found, strict=True) if node is not None}


async def _unit_node(node: Any) -> Any:
    from asyncua.ua import UaError

    try:
        return await node.get_child("0:EngineeringUnits")
    except (UaError, ValueError):
        return None


async def units_of(units: Mapping[str, Any]) -> dict[str, list[str]]:
    """The unit that each variable of :func:`unit_nodes` has now, and its other names."""
    found = await asyncio.gather(*(_unit_of(node) for node in units.values()))
    return {column: names for column, names in zip(units, found, strict=True) if names}


async def _unit_of(node: Any) -> list[str]:
    from asyncua.ua import UaError

    try:
        return names_of_unit(await node.read_value())
    except (UaError, ValueError):
        return []


def names_of_unit(unit: Any) -> list[str]:
    """Names of an ``EUInformation``: its text, and that of its common code."""
    text, code = getattr(unit, "DisplayName", None), getattr(unit, "UnitId", 0)
    names = [str(getattr(text, "Text", None) or ""), unit_of_code(int(code or 0))]
    return [one for one in names if one]


def nodes_by_column(client: Any, ids: Mapping[str, str]) -> dict[str, Any]:
    """Nodes of ids; a text that is no id has none."""
    from asyncua.ua import UaError

    found = {}
    for column, text in ids.items():
        try:
            found[column] = client.get_node(text)
        except (UaError, ValueError):
            continue
    return found
