"""What a hose's result looks like in space: the hose, the water moving through it, what holds it, the tip's path."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping

import numpy as np

from gardenhose.cables import streams
from gardenhose.motion.curves import Trace
from gardenhose.scene import HoseScene
from tautline.cable.input.embedded_scene import embedded
from tautline.cable.view.appearance import enlarged_by, extent_of, factor_of, quantities, sampled
from tautline.cable.view.symbols import ball, mass, pin, plate, supports
from tautline.results.naming import title_of
from tautline.results.result import Result
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.view.space.appearance import (
    DECK,
    STEEL,
    WATER,
    Appearance,
    History,
    Line,
    Look,
    Solid,
    Values,
    axes_of,
    pose_of,
    still,
)
from tautline.view.space.cubic import Chain, at_a_frame, facing, steps_for
from tautline.view.space.mesh import turned_about

VIEWS: Mapping[str, str] = {"space": "the hose as it lies in space"}
"""Names for ``--view``."""

MARKS = 10
"""Marks of the water along the hose."""
JUMP = 1.0 / 3.0
"""Of their spacing that marks may move from one frame to the next: the eye still tells which way."""
NICE = (1.0, 2.0, 5.0)
"""Times powers of ten, that marks are slowed down by."""
MARK, SIGN, PATH = 0.009, 0.06, 0.0005
"""Half width of a mark, size of a support, radius of the tip's path, over the extent of the picture."""
FINE = 4
"""Points of the tip's path from one frame to the next."""
UP = np.array([0.0, 0.0, 1.0])
MOST_POINTS = 20_000
"""Of the tip's path."""


def appearance(result: Result, look: Look) -> Appearance:
    """Say what a result looks like.

    The hose is the cubic of its elements. ``axial_force`` at its points is linear between the middles of elements,
    where it is stored; ``curvature`` is that of the cubic at the points. A hose's scene gives no diameter: its radius
    is zero. Marks travel with the water, by the integral of ``flow_speed`` over time.

    Parameters
    ----------
    look : Look
        `exaggerate` is a factor on displacements from the first frame, across the hose as it lay then.

    Raises
    ------
    ResultError
        If the result carries a scene that is no hose's; or for an unknown view or factor.
    """
    scene, factor = _scene_of(result), factor_of(look, VIEWS)
    hose = _chain(result, factor)
    force, velocity = np.asarray(result["axial_force"]), np.asarray(result["velocity"])
    points = at_a_frame(hose.points)
    places = np.concatenate([hose.points(slice(i, i + 1)) for i in range(0, hose.frames, max(1, hose.frames // 60))])
    extent = extent_of(places)
    shown = quantities(hose, force, velocity, None, curved=True)
    marks, notes = _water(result, scene, hose, extent)
    path = _path(result, hose, extent)
    held, more = _held(result, scene, hose, extent)
    return Appearance(
        units=look.units,
        title=title_of(result, "hose"),
        time=np.asarray(result.time),
        lines=(Line("hose", points, 0.0, shown, nodes=hose.nodes), *path),
        solids=(*held, *marks),
        eye=facing(sampled(places), places[0, -1] - places[0, 0]),
        notes=(*more, *notes),
        enlarged=enlarged_by(factor, "displacements across the hose, from its first frame,"),
    )


def _scene_of(result: Result) -> HoseScene | None:
    """The scene that a result carries; None for one made in Python without a text, which tells of no supports."""
    if not result.attributes.get("scene"):
        return None
    return embedded(result, lambda text, name: validate(HoseScene, Document.parse(text, name)))


def _chain(result: Result, factor: float) -> Chain:
    position = np.asarray(result["position"])
    material = np.broadcast_to(np.asarray(result["arc_length"]), position.shape[:2])
    elements = position.shape[1] - 1
    straight = np.zeros(elements, dtype=bool)
    slope = np.asarray(result["slope"])
    return Chain(position, slope, material, straight, steps_for(elements), factor, across=True)


def _path(result: Result, hose: Chain, extent: float) -> tuple[Line, ...]:
    """Where the tip goes in the whole run, thin; none of a run of one frame, or of a tip that stays."""
    time, tip = np.asarray(result.time), np.asarray(result["tip"])
    if len(time) < 2 or np.ptp(tip, axis=0).max() < 1e-6 * extent:
        return ()
    count = min(FINE * (len(time) - 1) + 1, MOST_POINTS)
    dense = np.interp(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, len(time)), time)
    places = hose.enlarged(Trace(time, tip, np.asarray(result["tip_velocity"]))(dense)[0], float(hose.material[0, -1]))
    return (Line("path of the tip", still(places), PATH * extent, colour=STEEL, thick=False, measured=False),)


def _held(
    result: Result, scene: HoseScene | None, hose: Chain, extent: float
) -> tuple[list[Solid], list[str]]:  # fmt: skip
    """Signs of what holds the ends, a ball for a free tip or a mass at it, and what to say of them."""
    if scene is None:
        return [], []
    size, way, meshes = SIGN * extent, np.array(scene.hose.unit_direction), []
    for support, place, behind in (
        (scene.hose.root_support, hose.position[0, 0], -1.0),
        (scene.hose.end, hose.position[0, -1], 1.0),
    ):
        if support != "free":
            points, triangles = plate(size, way, behind) if support == "clamped" else pin(size)
            meshes.append((points + place, triangles))
    held = supports(meshes)
    solids = [Solid(held.name, held.points, held.triangles, None, DECK, smooth=False)]

    def tip(frame: int) -> np.ndarray:
        return hose.points(slice(frame, frame + 1))[0, -1]

    histories = _of_the_tip(result)
    if scene.hose.tip_mass > 0.0:
        solids.append(mass(scene.hose.tip_mass, tip, extent, "tip mass", histories))
        return solids, ["the mass at the tip is a sign, not to scale"]
    if scene.hose.end == "free":
        points, triangles = ball(0.5 * MARK * extent)
        solids.append(Solid("tip", points, triangles, lambda frame: pose_of(tip(frame)), STEEL, histories=histories))
    return solids, []


def _of_the_tip(result: Result) -> tuple[History, ...]:
    """Where the tip is and how fast it moves, and how fast the water is."""
    tip, velocity = np.asarray(result["tip"]), np.asarray(result["tip_velocity"])
    found = [History("z", "height", "m", tip[:, 2])]
    found += [History(axis, axis, "m", tip[:, c]) for c, axis in enumerate("xy")]
    found.append(History("tip_speed", "speed of the tip", "m/s", np.linalg.norm(velocity, axis=1)))
    if "flow_speed" in result:
        found.append(History("flow_speed", "speed of the water", "m/s", np.asarray(result["flow_speed"])))
    return tuple(found)


def _water(result: Result, scene: HoseScene | None, hose: Chain, extent: float) -> tuple[list[Solid], list[str]]:
    """Marks that move with the water, and what to say of them."""
    if "flow_speed" not in result or not np.any(result["flow_speed"]):
        return [], []
    time, speed = np.asarray(result.time), np.asarray(result["flow_speed"])
    travelled = _travelled(time, speed)
    place, ways = _ways(scene, np.asarray(result["arc_length"]))
    spacing = ways[-1] / MARKS
    furthest = float(np.abs(np.diff(travelled)).max()) if len(time) > 1 else 0.0
    slower = _nice(furthest / (JUMP * spacing))
    shift = travelled / slower
    radius = MARK * extent
    points, triangles = turned_about([(0.0, -1.2 * radius), (radius, -1.2 * radius), (0.0, 1.8 * radius)], 16)

    @functools.lru_cache(maxsize=1)
    def poses(frame: int) -> list[np.ndarray]:
        passed = (np.arange(MARKS) + (shift[frame] / spacing) % 1.0) * spacing
        at, ways_there = hose.place(frame, np.interp(passed, ways, place))
        if speed[frame] < 0.0:
            ways_there = -ways_there
        return [pose_of(one, axes_of(way if np.any(way) else UP)) for one, way in zip(at, ways_there, strict=True)]

    def pose_at(k: int) -> Values:
        return lambda frame: poses(frame)[k]

    solids = [Solid(f"water {k + 1}", points, triangles, pose_at(k), WATER) for k in range(MARKS)]
    if slower == 1.0:
        return solids, ["marks move with the water"]
    return solids, [f"marks move with the water, {slower:g} times more slowly than it does"]


def _travelled(time: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Integral of a speed over time by the trapezoidal rule, (frames,) m."""
    return np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (speed[1:] + speed[:-1]))])


def _ways(scene: HoseScene | None, arc_length: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places along the hose (n,) m, and how far water in the first piece goes while other water gets there (n,) m.

    Where the bore is narrower the water is faster than ``flow_speed``, which is that in the first piece.
    """
    if scene is None or not (found := streams(scene)):
        return arc_length, arc_length
    rate = np.concatenate([np.full(stream.stop - stream.start, 1.0 / stream.ratio) for stream in found])
    return arc_length, np.concatenate([[0.0], np.cumsum(np.diff(arc_length) * rate)])


def _nice(least: float) -> float:
    """The smallest of 1, 2, 5, 10, 20 and so on that is no less."""
    if least <= 1.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(least))
    return next(power * step for step in (*NICE, 10.0) if power * step >= least * (1.0 - 1e-12))
