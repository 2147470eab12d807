"""Scenes that no run can be right of: a cubic rope that forks at a node, and degrees of freedom without inertia."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from tautline.cable.input.parts import Element
from tautline.cable.model.layout import Layout
from tautline.scene.errors import Problem

RUNNING_ON = 2
"""Nodes to which cubic elements may lead from one node: a curve comes from one and runs on to the other."""

MASSLESS = ("PointForce", "OneNodeSpring", "TwoNodeSpring")
"""Items on nodes that have no mass."""


def branches(layout: Layout) -> list[Problem]:
    """Nodes from which cubic elements lead to three other nodes, or more.

    Elements with the same two nodes are one curve, such as a core in its armour: their forces add up.
    """
    scene = layout.scene
    cubic = np.array([element.kind == "cubic" for element in scene.elements], dtype=bool)
    ways = np.unique(np.sort(layout.ends[cubic], axis=1), axis=0)
    meet = np.bincount(ways.ravel(), minlength=len(scene.nodes))
    problems = []
    for place in np.flatnonzero(meet > RUNNING_ON).tolist():
        node = scene.nodes[place].id
        # Of those laid over each other the first is named.
        ways_on = {frozenset(e.nodes): e for e in reversed(scene.elements) if e.kind == "cubic" and node in e.nodes}
        ends = list(reversed(ways_on.values()))
        names = ", ".join(str(element.id) for element in ends[:-1]) + f" and {ends[-1].id}"
        cause = (
            f"{len(ends)} cubic elements, {names}, end at node {node} and share its slope: all of them have one "
            "direction and one stretch there, so their forces would be wrong, however short the elements"
        )
        cure = (
            f"end all but one at nodes of their own at the same point, and tie r of each of these to node {node} "
            "(LagMultipl7 with constr: 0)"
        )
        problems.append(scene.problem((*ends[RUNNING_ON].place, "nodes7"), cause, cure))
    return problems


def massless(layout: Layout, tied: Iterable[int]) -> list[Problem]:
    """Of positions and slopes that are free and have no mass the first: no acceleration follows from a force there.

    ``tied`` are degrees of freedom that a constraint ties to others: these may give them mass.
    """
    scene = layout.scene
    massive = [e.rhoA > 0.0 or (e.conveyed is not None and e.conveyed[0] > 0.0) for e in scene.elements]
    if all(massive):
        return []
    moved = {node for e, has in zip(scene.elements, massive, strict=True) if has for node in e.nodes}
    # An item of a user's own may have inertia of which it tells nothing.
    moved |= {*scene.heavy_nodes} | {node for part in scene.nodal if part.key not in MASSLESS for node in part.nodes}
    turned = {n for e, has in zip(scene.elements, massive, strict=True) if has and e.kind == "cubic" for n in e.nodes}
    joined = {*tied, *layout.degrees.masters}
    joined |= {place for slave in layout.degrees.masters for place, _ in layout.degrees.resolved(slave)}
    found: dict[int, tuple[Element, str]] = {}
    for element in (e for e, has in zip(scene.elements, massive, strict=True) if not has):
        for node in element.nodes:
            first = layout.start[node]
            for what, places, has in (
                ("position", range(first, first + 3), node in moved),
                ("slope", range(first + 3, first + 6), node in turned or element.kind != "cubic"),
            ):
                if not has and any(not layout.is_held(place) and place not in joined for place in places):
                    found.setdefault(node, (element, what))
    return [_massless(layout, found)] if found else []


def _massless(layout: Layout, found: dict[int, tuple[Element, str]]) -> Problem:
    node, (element, what) = next(iter(found.items()))
    more = len(found) - 1
    others = f", and so it is at {more} other node{'s' * (more > 1)}" if more else ""
    cause = f"the {what} of node {node} is free and has no mass{others}: the elements that end there have rhoA = 0"
    cure = "give them rhoA, or a small share of that of their neighbours where their mass does not count"
    if what == "position":
        cure += "; a PointMass gives mass to the position alone"
    return layout.scene.problem((*element.place, "rhoA"), cause, cure)
