"""What of the rope rides on the vessel and on each frame; and those that are turned or moved for nothing.

Motion reaches the rope by the drums, sheaves and anchors that ride on what moves, directly or on a frame upon it.
Without one the motion changes nothing in a run, unless the sea that it is the response to acts on the loads.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from crane.scene.scene import VESSEL, Anchor, CraneScene, Drum, Frame, PathItem
from crane.scene.surroundings import ROTATIONS, TRANSLATIONS
from tautline.scene.functions import Constant

NAMED = 3
"""Items of the path, or frames, that are named as what could ride."""


def carries(scene: CraneScene, name: str) -> bool:
    """Whether an item of the path rides on the vessel, or on a frame of this name."""
    return any(name in _below(scene, item) for item in scene.path)


def brings_sea(scene: CraneScene) -> bool:
    """Whether the waves on the loads are those that the vessel's motion is the response to."""
    return scene.water is not None and scene.water.waves is not None and scene.water.waves.elevation == "vessel"


def idle(scene: CraneScene) -> Iterator[tuple[str, str]]:
    """Key and text of what is turned or moved for nothing: of several that stand on each other the outermost."""
    named: list[str] = []
    for k, frame in sorted(enumerate(scene.frames), key=lambda one: -len(_below(scene, one[1]))):
        turned = any(not _is_zero(motion) for motion in (frame.slew, frame.luff))
        if turned and not carries(scene, frame.name) and not _stands_below(scene, frame.name, named):
            named.append(frame.name)
            yield f"frames[{k}]", _said(frame.name, how_to_mount(scene, frame.name))
    if scene.vessel is None or carries(scene, VESSEL) or brings_sea(scene) or _stands_below(scene, VESSEL, named):
        return
    motion: Any = scene.vessel.motion
    if any(not _is_zero(getattr(motion, name, None)) for name in TRANSLATIONS + ROTATIONS):
        yield "vessel", _said(f"the {VESSEL}", how_to_mount(scene, VESSEL))


def how_to_mount(scene: CraneScene, name: str) -> str:
    """What to write so that the path rides on a frame, or on the vessel, with a small first letter."""
    loose = [item for item in scene.path if _can_ride(item)]
    if not loose:
        return "remove it: bodies carry all of the path"
    if name == VESSEL:
        # What rides on a frame goes with it: then the frame is to stand on the vessel.
        roots = [_below(scene, item)[-1] for item in loose if _below(scene, item)]
        if roots:
            return f"write parent: {VESSEL} at {_listed(roots)}"
    return f"write frame: {name} at {_listed([item.name for item in loose])}"


def _said(what: str, cured: str) -> str:
    # True of what moves, and of what stands still and is only turned or shifted.
    return (
        f"no drum, sheave or anchor of the path rides on {what}. How it is turned or moved changes nothing in the run. "
        f"{cured[0].upper()}{cured[1:]}, or remove what turns or moves it"
    )


def _below(scene: CraneScene, item: PathItem | Frame) -> list[str]:
    """Names of what an item of the path rides on, from its own frame down to the vessel, or to the last frame."""
    names: list[str] = []
    frames = {frame.name: frame for frame in scene.frames}
    name = scene.frame_of(item)
    while name is not None:
        names.append(name)
        name = scene.frame_of(frames[name]) if name in frames else None
    return names


def _stands_below(scene: CraneScene, name: str, others: list[str]) -> bool:
    """Whether one of the other frames stands on this."""
    return any(name in _below(scene, scene.frame(other)) for other in others)


def _can_ride(item: PathItem) -> bool:
    """Whether an item of the path may ride on a frame: what a body carries may not."""
    return isinstance(item, (Drum, Anchor)) or getattr(item, "center", None) is not None


def _is_zero(function: Any) -> bool:
    """Whether a motion is none, for good; None stands for a file, or for a sea, which is some."""
    return isinstance(function, Constant) and function.value == 0.0


def _listed(names: list[str]) -> str:
    """``winch and tip``; of many, the first ones."""
    once = list(dict.fromkeys(names))
    if len(once) > NAMED:
        return f"{', '.join(once[:NAMED])} and {len(once) - NAMED} more"
    return " and ".join(filter(None, (", ".join(once[:-1]), once[-1])))
