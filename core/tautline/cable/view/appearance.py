"""What a cable's result looks like in space: its elements' cubics, what holds them, and what pulls at them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tautline.cable.input.embedded_scene import scene_of
from tautline.cable.input.parts import CableScene, Node
from tautline.cable.view.symbols import coil, mass, pin, plate, supports
from tautline.results.errors import ResultError
from tautline.results.naming import stem
from tautline.results.result import Result
from tautline.view.space.appearance import (
    STEEL,
    Appearance,
    Arrows,
    History,
    Line,
    Look,
    Quantity,
    Solid,
    Values,
    chosen,
    pose_of,
    ranged,
    still,
)  # fmt: skip
from tautline.view.space.cubic import Chain, at_a_frame, facing, steps_for
from tautline.view.space.mesh import moved
from tautline.whole_file import legible

VIEWS: Mapping[str, str] = {"space": "the cables as they lie in space"}
"""Names for ``--view``."""

SIGN = 0.04
"""Size of the signs of supports and springs, over the extent of all that a run's nodes pass through."""
LOOKED_AT = 60
"""Frames, about, of which the extent of a run is taken."""


def appearance(result: Result, look: Look) -> Appearance:
    """Say what a result looks like.

    Every chain of elements is a line along their cubics. ``axial_force`` at its points is linear in p between the
    middles of elements, where it is stored; ``curvature`` is that of the cubic at the points; ``speed`` is that of the
    cable's material. A cable scene gives no diameters: radii are zero.

    Parameters
    ----------
    look : Look
        `exaggerate` is a factor on displacements from the first frame.

    Raises
    ------
    ResultError
        If the result carries no scene of cables, or not the one that it was made of; or for an unknown view or factor.
    """
    scene = scene_of(result)
    factor = factor_of(look, VIEWS)
    position = np.asarray(result["position"])
    if position.shape[1] != len(scene.nodes) or np.shape(result["axial_force"])[1] != len(scene.elements):
        cause = f"has {position.shape[1]} nodes, and the scene that it carries {len(scene.nodes)}"
        raise ResultError(str(result.path or "result"), cause, "run the scene again")
    drawn = position[:1] + factor * (position - position[:1]) if factor != 1.0 else position
    extent = extent_of(drawn)
    lines = _cables(result, scene, factor)
    size, homes = SIGN * extent, {node.id: np.array(node.position) for node in scene.nodes}
    places = {node.id: _place(drawn, i) for i, node in enumerate(scene.nodes)}
    pulled = [(still(homes[i]), places[i]) for anchor in scene.anchors for i in anchor.nodes]
    pulled += [(places[spring.nodes[0]], places[spring.nodes[1]]) for spring in scene.springs]
    springs = [coil(*ends, size, name) for ends, name in _numbered("spring", pulled)]
    heavy = [(one.model.mass, i) for one in scene.masses for i in one.nodes if one.model.mass > 0.0]
    order = [node.id for node in scene.nodes]
    masses = [
        mass(kilograms, places[i], extent, name, _coordinates(position[:, order.index(i)]))
        for (kilograms, i), name in _numbered("mass", heavy)
    ]
    held = _supports(scene, places, size)
    signs = [text for text, some in (("supports", held), ("springs", springs), ("masses", masses)) if some]
    notes = [f"{_listed(signs)} are signs, not to scale"] if signs else []
    return Appearance(
        title=str(result.attributes.get("title") or scene.title or legible(stem(result, "cables"))),
        time=np.asarray(result.time),
        lines=(*lines, *springs),
        solids=(*held, *masses),
        arrows=_forces(scene, result.time, drawn),
        eye=facing(sampled(drawn)),
        notes=tuple(notes),
        enlarged=enlarged_by(factor),
    )


def factor_of(look: Look, views: Mapping[str, str]) -> float:
    """The factor on displacements that is asked for, 1 by default.

    Raises
    ------
    ResultError
        If it is not a positive number, or there is no such view.
    """
    look = chosen(views, look)
    factor = 1.0 if look.exaggerate is None else float(look.exaggerate)
    if not (math.isfinite(factor) and factor > 0.0):
        raise ResultError("--exaggerate", f"{factor:g} is no factor", "give a positive number, such as 20")
    return factor


def enlarged_by(factor: float, what: str = "displacements from the first frame") -> tuple[tuple[str, float], ...]:
    """What a picture shows larger than it is, and how many times."""
    return () if factor == 1.0 else ((what, factor),)


def sampled(position: np.ndarray) -> np.ndarray:
    """Places of nodes (frames, n, 3) at some of the frames, (k, 3)."""
    return position[:: max(1, len(position) // LOOKED_AT)].reshape(-1, 3)


def extent_of(position: np.ndarray) -> float:
    """Diagonal of the box that nodes (frames, n, 3) stay in, m."""
    points = sampled(position)
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) or 1.0


def quantities(
    chain: Chain, force: np.ndarray, velocity: np.ndarray, rate: np.ndarray | None, curved: bool
) -> tuple[Quantity, ...]:
    """Axial force, curvature if there is any, and speed along a chain.

    Parameters
    ----------
    force : (frames, n - 1) array
        In the middle of elements, N.
    velocity, rate : (frames, n, 3) array, (frames, n) array or None
        Of the nodes and of their p, m/s.
    """

    def along(frames: slice) -> np.ndarray:
        return chain.through_middles(frames, force)

    def speed(frames: slice) -> np.ndarray:
        return np.linalg.norm(chain.material_velocity(frames, velocity, rate), axis=-1)

    bent = (chain.quantity("curvature", "curvature", "1/m", chain.curvature),) if curved else ()
    return (
        ranged("axial_force", "axial force", "N", force, at_a_frame(along), "in the middle of each element"),
        *bent,
        chain.quantity("speed", "speed", "m/s", speed),
    )


def chains_of(scene: CableScene) -> list[list[int]]:
    """Places in the scene of the elements of each chain: one begins where one other, and no third, ends."""
    begins: dict[int, list[int]] = {}
    ends: dict[int, list[int]] = {}
    for i, element in enumerate(scene.elements):
        begins.setdefault(element.nodes[0], []).append(i)
        ends.setdefault(element.nodes[1], []).append(i)
    follows = {
        into[0]: begins[node][0] for node, into in ends.items() if len(into) == 1 and len(begins.get(node, ())) == 1
    }
    first = sorted(set(range(len(scene.elements))) - set(follows.values()))
    found = []
    for i in first:
        chain = [i]
        while chain[-1] in follows:
            chain.append(follows[chain[-1]])
        found.append(chain)
    return found


def _cables(result: Result, scene: CableScene, factor: float) -> list[Line]:
    """A line of each chain of elements."""
    stored = {
        name: np.asarray(result[name]) for name in ("position", "material_coordinate", "velocity", "material_velocity")
    }
    slope = np.asarray(result["slope"]) if "slope" in result else np.zeros_like(stored["position"])
    force, moves = np.asarray(result["axial_force"]), bool(np.any(stored["material_velocity"]))
    index = {node.id: i for i, node in enumerate(scene.nodes)}
    lines = []
    for elements, name in _numbered("cable", chains_of(scene)):
        straight = np.array([scene.elements[i].kind == "linear" for i in elements])
        nodes = [index[scene.elements[elements[0]].nodes[0]], *(index[scene.elements[i].nodes[1]] for i in elements)]
        chain = Chain(
            stored["position"][:, nodes], slope[:, nodes], stored["material_coordinate"][:, nodes], straight,
            2 if straight.all() else steps_for(len(elements)), factor,
        )  # fmt: skip
        rate = stored["material_velocity"][:, nodes] if moves else None
        shown = quantities(chain, force[:, elements], stored["velocity"][:, nodes], rate, not straight.all())
        lines.append(Line(name, at_a_frame(chain.points), 0.0, shown, nodes=chain.nodes))
    return lines


def _supports(scene: CableScene, places: dict[int, Values], size: float) -> list[Solid]:
    """Signs where all of r is held: a plate where the direction is held too, a cone where it is not."""
    begins, ends = {e.nodes[0] for e in scene.elements}, {e.nodes[1] for e in scene.elements}
    resting, moving = [], []
    for node in scene.nodes:
        if not all(node.held[:3]):
            continue
        mesh = _support(node, size, (node.id in ends) - float(node.id in begins), _hangs(scene, node))
        if any(node.functions[:3]):
            place = places[node.id]
            moving.append((mesh, lambda frame, place=place: pose_of(place(frame))))
        else:
            resting.append((mesh[0] + np.array(node.position), mesh[1]))
    carried = [Solid(name, *mesh, pose, STEEL, smooth=False) for (mesh, pose), name in _numbered("support", moving)]
    return ([supports(resting)] if resting else []) + carried


def _hangs(scene: CableScene, node: Node) -> bool:
    """Whether cables leave a node downwards, so that what holds it is above."""
    at = {one.id: np.array(one.position) for one in scene.nodes}
    ways = [
        at[b if a == node.id else a] - at[node.id] for e in scene.elements for a, b in [e.nodes] if node.id in (a, b)
    ]
    return bool(ways) and sum(way[2] for way in ways) < -0.7 * sum(np.linalg.norm(way) for way in ways)


def _support(node: Node, size: float, behind: float, hangs: bool) -> Any:
    clamped = node.kind == 7 and node.slope is not None and any(node.slope) and sum(node.held[3:6]) >= 2
    if clamped:
        return plate(size, np.array(node.slope), behind)
    return moved(pin(size), np.diag([1.0, -1.0, -1.0])) if hangs else pin(size)


def _forces(scene: CableScene, time: np.ndarray, position: np.ndarray) -> tuple[Arrows, ...]:
    """All forces on nodes; one acts from the first time of its interval until the last."""
    index = {node.id: i for i, node in enumerate(scene.nodes)}
    each = [(index[node], one.model.force, one.model.interval) for one in scene.forces for node in one.nodes]
    if not each:
        return ()
    nodes, force, interval = (np.array(one) for one in zip(*each, strict=True))
    acts = (interval[:, 0] <= time[:, None]) & (time[:, None] < interval[:, 1])
    longest = float(np.linalg.norm(force, axis=-1).max())
    if longest == 0.0:
        return ()

    def vectors(frame: int) -> np.ndarray:
        return acts[frame][:, None] * force

    return (Arrows("force", "force", "N", lambda frame: position[frame, nodes], vectors, longest),)


def _coordinates(position: np.ndarray) -> tuple[History, ...]:
    """Histories of a place (frames, 3), m; the height first."""
    return tuple(History(axis, axis, "m", position[:, c]) for axis, c in (("z", 2), ("x", 0), ("y", 1)))


def _place(position: np.ndarray, node: int) -> Values:
    return lambda frame: position[frame, node]


def _numbered(name: str, things: Sequence[Any]) -> list[tuple[Any, str]]:
    """Things, each with its name: ``mass`` where there is one, else ``mass 1`` and so on."""
    return [(one, name if len(things) == 1 else f"{name} {i}") for i, one in enumerate(things, start=1)]


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]
