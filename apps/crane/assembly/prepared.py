"""What is prepared once of a crane: the motion of its frames over the whole run, and the heave compensation.

Warnings, the run, the run that measures its error and the figures all ask here. Following the motion of frames takes
most of the time before a long run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from crane.scene.scene import Anchor, CraneScene, Drum, PathItem
from crane.sea.compensation import Compensation, compensate, lift_of, unlimited
from crane.sea.frames import GROUND, Frame, requests_of
from crane.sea.vessel import frames_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import TimeFunctions, sample_all
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant
from tautline.scene.reading.files import stamps
from tautline.system.time_functions import FrameLift, FunctionRequest, compile_functions


@dataclass(frozen=True, eq=False)
class FrameMotion:
    """How the frames of a scene move.

    Attributes
    ----------
    frames : tuple of Frame
    places : dict
        Number of each frame by its name.
    requests : list of FunctionRequest
        The functions of time of the frames' twelve numbers, frame by frame.
    entries : (frames, 12) array
        These numbers at t = 0.
    """

    frames: tuple[Frame, ...]
    places: dict[str, int]
    requests: list[FunctionRequest]
    entries: np.ndarray

    def held(self, functions: TimeFunctions) -> FrameMotion:
        """The same with the numbers at t = 0 that a scene's functions give, of which some are held at other values.

        What moves a frame comes first among the functions of a scene.
        """
        moved = [n for n, request in enumerate(self.requests) if not isinstance(request.model, Constant)]
        entries = self.entries.copy()
        entries.ravel()[moved] = sample_all(functions, range(len(moved)), np.zeros(1))[:, 0, 0]
        return replace(self, entries=entries)


def _of_frames(scene: CraneScene) -> tuple[Any, ...]:
    """What the motion of the frames depends on."""
    return scene.vessel, scene.frames, scene.solver.end, stamps(scene.vessel, scene.folder), scene.driven


def motion_of(scene: CraneScene) -> FrameMotion:
    """How the frames of a scene move: found once, as it takes most of the time before a long run.

    Raises
    ------
    SceneError
        For faults of the files of a vessel's motion, and motions that jump; with their line.
    """
    return scene.once("motion", _of_frames(scene), lambda: _motion(scene))


def _motion(scene: CraneScene) -> FrameMotion:
    end = scene.solver.end
    _check_files(scene)
    try:
        frames, places = frames_of(scene.vessel, scene.frames, scene.folder, end)
        requests = requests_of(frames, end, scene.driven)
        functions = compile_functions(requests)
        at_first = sample_all(functions, range(len(requests)), np.zeros(1))[:, 0, 0]
        return FrameMotion(frames, places, requests, at_first.reshape(-1, ENTRIES))
    except SceneError as error:
        problems = [
            scene.problem(p.key, p.cause, p.cure) if p.line is None and p.key else p for p in error.problems
        ]  # fmt: skip
        raise SceneError(problems) from None


def _check_files(scene: CraneScene) -> None:
    """Refuse a vessel whose file is not there, at the key that names it."""
    motion = None if scene.vessel is None else scene.vessel.motion
    for key in ("file", "rao"):
        name = getattr(motion, key, None)
        if name is not None and not (path := scene.folder / name).is_file():
            cause = "is a folder, not a file" if path.is_dir() else f"there is no file {path}"
            cure = "give its path relative to the scene's folder"
            raise SceneError([scene.problem(f"vessel.motion.{key}", cause, cure)])


def compensation_of(scene: CraneScene) -> Compensation | None:
    """What the heave compensation does, found once: it answers the heave of `heave_point`.

    Raises
    ------
    SceneError
        Where nothing rides on the vessel, and as `motion_of`.
    """
    if scene.heave_compensation is None:
        return None
    motion = motion_of(scene)
    if not motion.frames:
        return None
    return scene.once(
        "compensation", (*_of_frames(scene), scene.path, scene.heave_compensation), lambda: _compensation(scene, motion)
    )


def heave_of(scene: CraneScene, point: PathItem | None = None) -> FrameLift | Constant:
    """Height of a point on the vessel above where it is with the vessel at rest, m: of `heave_point`, if none is given.

    That one is answered.
    """
    return lift_of(motion_of(scene).requests, *_led(scene, motion_of(scene), point))


def heave_point(scene: CraneScene) -> PathItem:
    """The item of the path whose heave is answered: counted from the drum, the last that rides on vessel or frame.

    With a drum at either end it is the last before the load, of the way from the first drum that the compensation
    drives, or of that from the other where nothing of the first way rides there. A drum is it only where nothing else
    rides on vessel or frame.

    Raises
    ------
    SceneError
        Where nothing does.
    """
    tip = next((tip for tip in _tips(scene) if tip is not None), None)
    if tip is None:
        cause = "nothing of the path rides on the vessel: there is no heave to answer"
        raise SceneError([scene.problem("heave_compensation", cause, "remove it, or put the crane on the vessel")])
    return tip


def unanswered(scene: CraneScene) -> list[tuple[Drum, PathItem | None]]:
    """Of two drums that the compensation drives that whose tip is another one than `heave_point`, and this tip.

    It is None where nothing of that drum's way rides on vessel or frame: it does not heave. The list may be empty.
    """
    if not _two_drums(scene) or not all(drum.prescribed for drum in scene.drums):
        return []
    answered = heave_point(scene)
    return [(drum, tip) for drum, tip in zip(scene.drums, _tips(scene), strict=True) if tip is not answered]


def _tips(scene: CraneScene) -> list[PathItem | None]:
    """What `_tip` finds of the ways from the drums that the compensation drives, in the order of the path."""
    path = scene.path
    if not _two_drums(scene):
        return [_tip(scene, path if isinstance(path[0], Drum) else path[::-1])]
    ways = [order for order in (path, path[::-1]) if order[0].prescribed]
    return [_tip(scene, order) for order in ways]


def _two_drums(scene: CraneScene) -> bool:
    return isinstance(scene.path[0], Drum) and isinstance(scene.path[-1], Drum)


def _tip(scene: CraneScene, order: Sequence[PathItem]) -> PathItem | None:
    """The last item that rides on vessel or frame, of two drums before the load; of items as counted from a drum."""
    if _two_drums(scene):
        loads = [k for k, item in enumerate(order) if getattr(item, "body", None) is not None]
        order = order[: loads[0]] if loads else order
    led = [item for item in order if scene.frame_of(item) is not None]
    return next((item for item in led[::-1] if not isinstance(item, Drum)), led[-1] if led else None)


def answers_no_heave(scene: CraneScene) -> bool:
    """Whether the point whose heave is answered rides on a frame that does not stand on the vessel."""
    motion = motion_of(scene)
    k = motion.places[scene.frame_of(heave_point(scene))]
    while k not in (GROUND, motion.places["vessel"]):
        k = motion.frames[k].parent
    return k == GROUND


def _led(scene: CraneScene, motion: FrameMotion, point: PathItem | None = None) -> tuple[int, int, tuple[float, ...]]:
    """Numbers of the frame of a point, else of that whose heave is answered, and of the vessel; its place drawn, m."""
    places, tip = motion.places, point or heave_point(scene)
    return places[scene.frame_of(tip)], places["vessel"], tip.position if isinstance(tip, Anchor) else tip.center


def _compensation(scene: CraneScene, motion: FrameMotion) -> Compensation:
    asked = scene.heave_compensation
    led = _led(scene, motion)
    if (free := unlimited(motion.requests, *led, asked)) is not None:
        return free
    return compensate(lift_of(motion.requests, *led), asked.gain, asked.delay, asked.limits, scene.solver.end)
