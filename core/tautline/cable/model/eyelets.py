"""Nodes that material slides through, as a group that watches whether their supports still hold them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautline.cable.model.layout import Layout
from tautline.cable.model.ties import Equation
from tautline.elements.nodal.eyelet import Eyelets


def eyelets(layout: Layout, made: Sequence[Equation]) -> list[Any]:
    """The scene's free p's with what stops them from sliding; empty where there are none, or none can be watched.

    Watched are those that are held by positions alone. A p that is tied to others by multipliers, carries a point mass,
    or is mixed from several unknowns is held by what the build has looked at.
    """
    scene = layout.scene
    stops: dict[int, list[tuple[int, int, int]]] = {}
    others: set[int] = set()
    bound = {place for e in made if e.tie.method != "penalty" for place, _ in e.row}
    heavy = set(scene.heavy_nodes)
    chords = _chords(layout)
    for node in scene.nodes:
        if node.id in layout.still_nodes:
            continue
        start, p = layout.start[node.id], layout.material(node.id)
        masters = [i for i, _ in layout.degrees.resolved(p) if i not in layout.degrees.motion]
        if not masters:
            continue
        position = {start, start + 1, start + 2, p}
        coupled = any(i in layout.degrees.masters and not layout.is_held(i) for i in position - {p})
        if len(masters) > 1 or coupled or node.id in heavy or position & bound:
            others.update(masters)
            continue
        held = [axis for axis in range(3) if layout.is_held(start + axis)]
        ways = [(start + 3, -1)] if node.kind == 7 else chords.get(node.id, [])
        stops.setdefault(masters[0], []).extend((axis, tip, tail) for axis in held for tip, tail in ways)
    watched = {p: rows for p, rows in stops.items() if rows and p not in others}
    if not watched:
        return []
    first = np.cumsum([0] + [len(rows) for rows in watched.values()])
    table = np.array([row for rows in watched.values() for row in rows], dtype=np.int64)
    axis, tip, tail = (np.ascontiguousarray(column) for column in table.T)
    return [Eyelets(np.array(list(watched), dtype=np.int64), first.astype(np.int64), axis, tip, tail)]


def _chords(layout: Layout) -> dict[int, list[tuple[int, int]]]:
    """Places of both ends of the linear elements at each node."""
    chords: dict[int, list[tuple[int, int]]] = {}
    for element in layout.scene.elements:
        if element.kind == "linear":
            first, second = element.nodes
            for node in element.nodes:
                chords.setdefault(node, []).append((layout.start[second], layout.start[first]))
    return chords
