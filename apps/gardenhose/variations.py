"""How a hose's scene is varied for a study: finer or coarser elements, other stiffness and ties, a sliver at the tip.

Each function takes a validated scene and returns another, as it would be read from a file that says so; the scene given
stays as it is.
"""

from __future__ import annotations

import math
from typing import Any

from gardenhose.cables import assembled
from gardenhose.scene import UNIFORM, HoseScene, Segment
from tautline.cable.model.magnitudes import penalty_stiffness
from tautline.scene.reading.document import Path_
from tautline.study.robustness.bar import Bar

ORIGIN = "study"
"""What messages name in place of a line."""
WAYS = ("linear", "lagrange", "penalty", "augmented")
SPRUNG = ("penalty", "augmented")
"""Couplings that have springs."""


def elements(scene: HoseScene, factor: float) -> HoseScene | None:
    """Give every piece of the hose ``factor`` times its elements, at least one; None if that changes nothing.

    Raises
    ------
    SceneError
        For more elements than a hose may have.
    """
    counts = [piece.elements for piece in scene.hose.pieces]
    wanted = [max(1, math.floor(count * factor + 0.5)) for count in counts]
    if wanted == counts:
        return None
    return _with_hose(scene, [{"elements": count} for count in wanted])


def stiffness(scene: HoseScene, factor: float) -> HoseScene:
    """Axial and bending stiffness of the hose times ``factor``; raises SceneError where they are beyond all hoses."""
    keys = ("axial_stiffness", "bending_stiffness")
    return _with_hose(scene, [{key: factor * getattr(piece, key) for key in keys} for piece in scene.hose.pieces])


def contact(scene: HoseScene, value: float) -> None:
    """A hose touches nothing: None."""
    return None


def penalty(scene: HoseScene, value: float) -> HoseScene | None:
    """Stiffness of the springs that tie hose and water, N/m; None where no springs do."""
    return scene.varied({("stiffness",): value}, ORIGIN) if _sprung(scene) else None


def shortest(scene: HoseScene, factor: float) -> HoseScene:
    """Cut an element off the tip that is ``factor`` times shorter than the shortest; the piece above keeps its own.

    Raises
    ------
    SceneError
        If nothing would be left of the last piece, or the hose had too many elements, or such short ones that rounding
        would bend them.
    """
    pieces = [_written(piece) for piece in _own(scene)]
    sliver = min(piece.length / piece.elements for piece in scene.hose.pieces) / factor
    end = pieces[-1] | {"length": sliver, "elements": 1}
    pieces[-1] |= {"length": pieces[-1]["length"] - sliver}
    return _segmented(scene, [*pieces, end])


def constraints(scene: HoseScene) -> tuple[str, ...]:
    """Ways to couple hose and water, the scene's own first; none without water."""
    if scene.water is None:
        return ()
    return (scene.coupling, *(way for way in WAYS if way != scene.coupling))


def constraint(scene: HoseScene, name: str) -> HoseScene | None:
    """Couple hose and water in another way, None without water; a stiffness that it has no springs for is left out.

    Raises
    ------
    SceneError
        If there is no such way.
    """
    if scene.water is None:
        return None
    values: dict[Path_, Any] = {("coupling",): name}
    if scene.stiffness is not None and name not in SPRUNG:
        values["stiffness",] = None
    return scene.varied(values, ORIGIN)


def stiffnesses(scene: HoseScene) -> dict[str, float | None]:
    """Stiffness of contact, of which there is none, and of the springs that tie hose and water, N/m.

    Where the scene leaves the latter to the builder, it is what the builder chooses for positions.
    """
    chosen = scene.stiffness
    if chosen is None and _sprung(scene):
        chosen = penalty_stiffness(assembled(scene).layout.scene)
    return {"contact": None, "penalty": chosen}


def bars(scene: HoseScene) -> list[Bar]:
    """One element of every piece of the hose, its water moving with it, and the last one where the tip is free."""
    pieces, made = scene.hose.pieces, []
    for i, piece in enumerate(pieces):
        length = piece.length / piece.elements
        speed = math.sqrt(piece.axial_stiffness / (piece.mass_per_length + (piece.water_mass_per_length or 0.0)))
        name = f"hose, element of {length:.4g} m" if len(pieces) == 1 else f"segment {i + 1}, element of {length:.4g} m"
        free = i == len(pieces) - 1 and scene.hose.end == "free"
        shape = "bent" if piece.bending_stiffness > 0.0 else "cubic"
        if piece.elements > 1 or not free:
            made.append(Bar(name, length, speed, shape, False))
        if free:
            made.append(Bar(f"{name} at the tip", length, speed, shape, True))
    return made


def _sprung(scene: HoseScene) -> bool:
    return scene.water is not None and scene.coupling in SPRUNG


def _own(scene: HoseScene) -> tuple[Segment, ...]:
    """Pieces with what they say themselves: no bore where the scene's is meant."""
    segments, pieces = scene.hose.segments, scene.hose.pieces
    return segments or tuple(piece.model_copy(update={"water_mass_per_length": None}) for piece in pieces)


def _written(piece: Segment) -> dict[str, Any]:
    """A piece as it would stand in a file, in SI."""
    return {key: value for key, value in piece.model_dump().items() if value is not None}


def _with_hose(scene: HoseScene, changes: list[dict[str, Any]]) -> HoseScene:
    """Copy of a scene with changes to each piece, which stay where they are written."""
    if scene.hose.segments is None:
        return scene.varied({("hose", key): value for key, value in changes[0].items()}, ORIGIN)
    pieces = [_written(piece) | change for piece, change in zip(scene.hose.segments, changes, strict=True)]
    return scene.varied({("hose", "segments"): pieces}, ORIGIN)


def _segmented(scene: HoseScene, pieces: list[dict[str, Any]]) -> HoseScene:
    """Copy of a scene whose hose is given by segments."""
    kept = {key: value for key, value in scene.written["hose"].items() if key not in (*UNIFORM, "segments")}
    return scene.varied({("hose",): kept | {"segments": pieces}}, ORIGIN)
