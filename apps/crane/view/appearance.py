"""What a run of a crane looks like in space: its rope, what it runs over, what hangs on it and what carries it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from crane.geometry.quaternion import rotation_of
from crane.results.course import Course, course_of, laid_out, scene_of
from crane.scene.scene import Body, CraneScene, Drum, End, Sheave
from crane.sea.waves import waves_of, waves_seen
from crane.view import histories, machinery
from crane.view.rope_line import RopeLine, cut, rope_line
from crane.view.structure import Site, structure
from tautline.results.naming import title_of
from tautline.results.result import Result
from tautline.view.space.appearance import (
    GROUND,
    LOAD,
    PAINT,
    STEEL,
    WATER,
    Appearance,
    Label,
    Level,
    Line,
    Look,
    Quantity,
    Solid,
    axes_of,
    chosen,
    placed,
    ranged,
    stored,
)  # fmt: skip
from tautline.view.space.mesh import Mesh, joined

VIEWS: Mapping[str, str] = {
    "whole": "the crane, its load, and the sea",
    "crane": "the crane alone, where its load hangs far below",
    "load": "the load and the rope above it, where that is long",
}
"""Names for ``--view``; the first is the one that is shown where none is asked for."""

DENSITY = 800.0
"""Of a load as drawn, kg/m^3: steel's frame, with what is in it."""
PROPORTIONS = np.array([1.25, 1.0, 0.8])
MOST_LABELS = 6
FAR = 4.0
"""Length of the rope to a load from which it is far away, over what of it is shown with either end alone."""
SLEWED, WIDE = 0.9, 0.6
"""Cosines of the angles to either side from which a crane is seen as slewing, and as slewing far."""
UP = np.array([0.0, 0.0, 1.0])


def appearance(result: Result, look: Look) -> Appearance:
    """Say what a run looks like.

    Parameters
    ----------
    result : Result
    look : Look
        `exaggerate` is a factor on the sag of spans across their chords.

    Raises
    ------
    ResultError
        For a view that there is not, and where the scene that the result carries cannot be read.
    """
    look = chosen(VIEWS, look)
    scene = scene_of(result)
    course = course_of(result, laid_out(scene))
    factor = 1.0 if look.exaggerate is None else look.exaggerate
    rope = rope_line(result, course, factor)
    site = Site(result, course)
    loads = [_Load(site, k) for k in range(len(scene.bodies))]
    site.loads = [(np.array(load.body.position), 0.5 * float(load.box.size[0])) for load in loads]
    ropes, crane, load = _shown(rope, site, loads, look.view)
    built = structure(site) if crane else []
    solids = [*built, *_drums(site)] if crane else []
    solids += _sheaves(site, crane, load)
    shown = loads if load else []
    for one in shown:
        solids += one.solids()
    eye = _eye(rope.points, course)
    levels = tuple(_levels(ropes, site))
    invented = [word for word, there in (("structure", built), ("bodies", shown)) if there]
    notes = [f"symbols: {' and '.join(invented)}"] if invented else []
    if site.lost:
        notes.append("the vessel's turns are not shown: the file of its motion is not at hand")
    deck = next((solid for solid in solids if solid.name == "deck"), None)
    if deck is not None and scene.water is None and scene.ground is None:
        lowest = [float(rope.points[..., 2].min())] + [one.lowest for one in loads]
        sea = _sea_below(deck, len(result.time))
        if sea < min(lowest):
            levels = (Level("sea", sea, WATER),)
            notes.append("the sea is not in the scene: it is drawn for the vessel, without waves")
    if deck is not None and scene.water is not None and deck.points[:, 2].max() < scene.water.surface:
        notes.append("the winch is where the scene has it: its deck is under water")
    if any(level.waves is not None for level in levels):
        notes.append(_said_of_waves(scene))
    return Appearance(
        units=look.units,
        title=title_of(result),
        time=np.array(result.time),
        lines=tuple(_line(one, site, f"rope {k + 1}" if k else "rope") for k, one in enumerate(ropes)),
        solids=tuple(solids),
        levels=levels,
        labels=tuple(one.label(eye) for one in shown) if len(shown) <= MOST_LABELS else (),
        eye=eye,
        notes=tuple(notes),
        enlarged=(("sag of the rope", factor),) if factor != 1.0 else (),
    )


def _said_of_waves(scene: CraneScene) -> str:
    """Where drawn waves come from, and what they do not act on."""
    water = "still water" if scene.water is None or scene.water.current is None else "the current without waves"
    if waves_of(scene) is None:
        return f"waves are those of the vessel's motion; forces on rope and load are those of {water}"
    return f"waves act on bodies with a height; forces on the rope are those of {water}"


def _shown(rope: RopeLine, site: Site, loads: list[_Load], view: str) -> tuple[list[RopeLine], bool, bool]:
    """Parts of the rope in a view, and whether the crane is in it, and the load; all of it where the load is near."""
    aboard = [not isinstance(item, End) and getattr(item, "body", None) is None for item in site.scene.path]
    reach = 0.5 * site.size if view == "crane" else 4.0 * max((load.box.size.max() for load in loads), default=0.0)
    between = [k for k in range(len(aboard) - 1) if aboard[k] != aboard[k + 1]]
    first, last = rope.spans[between].T if between else np.zeros((2, 0), dtype=int)
    long = np.linalg.norm(rope.points[:, last] - rope.points[:, first], axis=-1).max(initial=0.0)
    if view not in ("crane", "load") or not 0.0 < FAR * reach < long:
        return [rope], True, True
    kept = aboard if view == "crane" else [not one for one in aboard]
    return cut(rope, kept, reach), view == "crane", view == "load"


def _levels(ropes: list[RopeLine], site: Site) -> Iterator[Level]:
    """Water and ground, where they are near what is seen."""
    scene = site.scene
    heights = np.concatenate([rope.points[..., 2].ravel() for rope in ropes])
    room = max(2.0 * float(np.ptp(heights)), site.size)
    near = (float(heights.min()) - room, float(heights.max()) + room)
    if scene.water is not None and near[0] < scene.water.surface < near[1]:
        yield Level("water", scene.water.surface, WATER, waves=waves_seen(scene))
    if scene.ground is not None and near[0] < scene.ground.level < near[1]:
        yield Level("ground", scene.ground.level, GROUND, 0.9)


def _sea_below(deck: Solid, frames: int) -> float:
    """Height of a calm sea in which a vessel's deck floats as drawn, m, and which never washes over it."""
    low, top = float(deck.points[:, 2].min()), float(deck.points[:, 2].max())
    if deck.pose is None:
        return 0.5 * (low + top)
    tops = [placed(deck.points, deck.pose(frame))[:, 2].max() for frame in range(frames)]
    return min(0.5 * (low + top), float(min(tops)) - 0.2 * (top - low))


def _line(rope: RopeLine, site: Site, name: str) -> Line:
    quantities: list[Quantity] = [ranged("tension", "tension", "N", rope.tension)]
    if rope.speed is not None:
        quantities.append(ranged("rope_speed", "rope speed", "m/s", rope.speed))
    known = site.scene.rope.diameter is not None
    return Line(
        name, stored(rope.points), 0.5 * site.diameter, tuple(quantities), nodes=rope.nodes, measured=known
    )  # fmt: skip


def _eye(points: np.ndarray, course: Course) -> tuple[float, float, float]:
    """Direction from which a crane in a plane is seen nearly square on, its load's side a little nearer.

    A crane that slews is seen so in the middle of the run, and from higher up; one that slews far from behind, so that
    it is seen square on at either end of its way.
    """
    middle = len(points) // 2
    shown, axis = points[middle], course.axis[middle]
    flat = shown[:, :2] - shown[:, :2].mean(axis=0)
    spread, axes = np.linalg.eigh(flat.T @ flat)
    normal = np.array([axes[0, 0], axes[1, 0], 0.0])
    level = [i for i, rho in enumerate(course.layout.wheels.radius) if rho and abs(axis[i, 2]) < 0.7]
    if np.sqrt(spread[1] / len(shown)) < 0.03 * float(np.ptp(shown, axis=0).max()) or spread[0] > 0.5 * spread[1]:
        normal = np.array([*axis[level[0], :2], 0.0]) if level else np.array([0.0, 1.0, 0.0])
    normal = normal / np.linalg.norm(normal)
    turned = min((float((course.axis[:, i] @ axis[i]).min()) for i in level), default=1.0)
    if turned < WIDE:
        normal = np.cross(UP, normal)
    # From the front where that is open: against y, else along x.
    toward = -normal[1] if abs(normal[1]) > 1e-3 else normal[0]
    normal = normal if toward > 0.0 else -normal
    side = np.cross(UP, normal)
    ahead = 1.0 if float((shown[-1] - shown.mean(axis=0)) @ side) >= 0.0 else -1.0
    x, y, z = normal + (0.42 * ahead if turned > WIDE else 0.15) * side + (0.22 if turned > SLEWED else 0.5) * UP
    return float(x), float(y), float(z)


def _wheel_poses(site: Site, i: int, angle: np.ndarray) -> np.ndarray:
    """Poses (m, 4, 4) of a wheel about its own z, turned by angles about its axis."""
    item = site.scene.path[i]
    on_body = isinstance(item, Sheave) and item.body is not None
    mount = site.poses[None if on_body else site.scene.frame_of(item)]
    c, s = np.cos(angle), np.sin(angle)
    poses = np.zeros((len(angle), 4, 4))
    poses[:, 0, 0], poses[:, 0, 1], poses[:, 1, 0], poses[:, 1, 1] = c, -s, s, c
    poses[:, 2, 2] = poses[:, 3, 3] = 1.0
    poses[:, :3, :3] = mount[:, :3, :3] @ axes_of(np.array(item.unit_axis)) @ poses[:, :3, :3]
    poses[:, :3, 3] = site.course.center[:, i]
    return poses


def _sheaves(site: Site, crane: bool, load: bool) -> Iterator[Solid]:
    """Sheaves on the crane, and those on loads, which turn as far as was stored."""
    if not site.scene.sheaves:
        return
    turned = site.result["sheave_rotation"]
    numbers = [i for i, item in enumerate(site.scene.path) if isinstance(item, Sheave)]
    for k, i in enumerate(numbers):
        item = site.scene.path[i]
        if not (crane if item.body is None else load):
            continue
        mesh = machinery.sheave(item.radius, site.diameter, site.width(i))
        told = histories.of_sheave(site.result, site.scene.path, i)
        yield Solid(f"sheave {item.name}", *mesh, stored(_wheel_poses(site, i, turned[:, k])), STEEL, histories=told)


def _drums(site: Site) -> Iterator[Solid]:
    """Drums, which turn against the path of the rope where they take it in."""
    numbers = [i for i, item in enumerate(site.scene.path) if isinstance(item, Drum)]
    turned = site.result["drum_rotation"] if numbers else np.zeros((0, 0))
    for k, i in enumerate(numbers):
        item = site.scene.path[i]
        way = np.sign(site.course.layout.wheels.radius[i]) * (1.0 if i == 0 else -1.0)
        mesh = machinery.drum(item.radius, site.diameter, 2.0 * site.drum_half(i))
        told = histories.of_drum(site.result, site.scene.path, i)
        poses = stored(_wheel_poses(site, i, way * turned[:, k]))
        yield Solid(f"drum {item.name}", *mesh, poses, STEEL, histories=told)


class _Box(NamedTuple):
    """A load as a box: size and centre, and where its slings meet, in the body's axes, (3,) m each."""

    size: np.ndarray
    center: np.ndarray
    apex: np.ndarray


class _Load:
    """A body, as a hook block where sheaves ride on it, with a load below."""

    def __init__(self, site: Site, k: int) -> None:
        self.site, self.k, self.body = site, k, site.scene.bodies[k]
        self.place = site.result["body_position"][:, k]
        path = site.scene.path
        self.wheels = [
            (i, item) for i, item in enumerate(path) if isinstance(item, Sheave) and item.body == self.body.name
        ]
        self.ends = [np.array(item.offset) for item in path if isinstance(item, End) and item.body == self.body.name]
        self.box = self._box()

    @property
    def poses(self) -> np.ndarray:
        """Of the body's axes, (m, 4, 4)."""
        poses = np.tile(np.eye(4), (len(self.place), 1, 1))
        poses[:, :3, 3] = self.place
        if self.body.inertia is not None and "body_turn" in self.site.result:
            turns = self.site.result["body_turn"][:, self.k]
            poses[:, :3, :3] = [rotation_of(turn) for turn in turns]
        return poses

    @property
    def lowest(self) -> float:
        """Height of its underside where it is lowest, m, were it level."""
        return float(self.place[:, 2].min() + self.box.center[2] - 0.5 * self.box.size[2])

    def _apex(self) -> np.ndarray:
        """Where the load hangs from: the rope's end, or a swivel below the sheaves."""
        if self.wheels:
            offsets = np.array([item.offset for _, item in self.wheels])
            radius = max(item.radius for _, item in self.wheels)
            return np.array([*offsets[:, :2].mean(axis=0), offsets[:, 2].min() - 1.5 * radius])
        return np.mean(self.ends, axis=0) if self.ends else np.zeros(3)

    def _box(self) -> _Box:
        body, apex = self.body, self._apex()
        if body.inertia is not None:
            return _Box(_size_of(body), np.zeros(3), apex)
        volume = body.volume or body.mass / DENSITY
        size = volume ** (1.0 / 3.0) * PROPORTIONS
        below = 0.7 * size[2]
        ground = self.site.scene.ground
        if body.bottom > 0.0 or body.height is not None:
            hanging = max(apex[2] + body.bottom, 0.2 * body.bottom)
            high = 0.75 * hanging if body.height is None else body.height
            flat = float(np.clip(np.sqrt(volume / (PROPORTIONS[:2].prod() * high)), 0.3 * high, 2.5 * high))
            size = np.array([*(flat * PROPORTIONS[:2]), high])
            return _Box(size, np.array([*apex[:2], -body.bottom + 0.5 * high]), apex)
        if ground is not None and float(self.place[:, 2].min()) + apex[2] - below - size[2] < ground.level:
            # It touches with its own position: what is below that is as flat as it can be.
            size = size * (1.2, 1.2, 0.1)
            return _Box(size, np.array([*apex[:2], -0.5 * size[2]]), np.array([*apex[:2], 0.0]))
        return _Box(size, apex - (0.0, 0.0, below + 0.5 * size[2]), apex)

    def solids(self) -> Iterator[Solid]:
        """Cheek plates, slings and load."""
        name, d, poses = self.body.name, self.site.diameter, stored(self.poses)
        thick = max(0.8 * d, 0.012 * float(self.box.size[0]))
        load, slings = machinery.slung(self.box.size, self.box.center, self.box.apex, thick)
        parts: list[Mesh] = [slings]
        if self.wheels:
            parts += self._plates()
        told = histories.of_load(self.site.result, self.site.scene.path, self.k, name)
        colour = PAINT if self.wheels else STEEL
        yield Solid(f"rigging of {name}", *joined(*parts), poses, colour, smooth=False, histories=told)
        if self.box.size.any():
            release, time = self.body.release, self.site.result.time
            fallen = np.array([release is not None and at >= release.at for at in time])
            # What the result tells afterwards is of what is left on the hook.
            told = tuple(replace(one, values=np.where(fallen, np.nan, one.values)) for one in told)
            yield Solid(name, *load, stored(self._falling()), LOAD, smooth=False, histories=told)

    def _plates(self) -> Iterator[Mesh]:
        """Plates on either side of sheaves of one axis, down to the swivel."""
        left = list(self.wheels)
        while left:
            axis = np.array(left[0][1].unit_axis)
            row = [one for one in left if abs(axis @ np.array(one[1].unit_axis)) > 0.99]
            left = [one for one in left if one not in row]
            pins = np.array([item.offset for _, item in row])
            swivel = self.box.apex + ((pins - self.box.apex) @ axis)[:, None] * axis
            radius = 0.28 * max(item.radius for _, item in row)
            half = 0.75 * max(self.site.width(i) for i, _ in row)
            yield machinery.cheeks(np.concatenate([pins, swivel]), axis, radius, half, 0.4 * self.site.diameter)

    def _falling(self) -> np.ndarray:
        """Poses of the load, which falls freely once it is released, to the ground or the water."""
        poses, release = self.poses, self.body.release
        time = self.site.result.time
        if release is None or release.at >= time[-1]:
            return poses
        scene, first = self.site.scene, int(np.searchsorted(time, release.at))
        gone = (time[first:] - time[first])[:, None]
        speed = self.site.result["body_velocity"][first, self.k]
        fallen = self.place[first] + gone * speed + 0.5 * gone**2 * np.array(scene.gravity)
        floors = [scene.water.surface] if scene.water is not None else []
        floors += [scene.ground.level] if scene.ground is not None else []
        low = [level - self.box.center[2] for level in floors if level - self.box.center[2] < self.place[first, 2]]
        lowest = max(low, default=float(self.place[:, 2].min() - 4.0 * self.box.size[2]))
        fallen[:, 2] = np.maximum(fallen[:, 2], lowest)
        poses[first:, :3, 3] = fallen
        poses[first:, :3, :3] = poses[first, :3, :3]
        return poses

    def label(self, eye: tuple[float, float, float]) -> Label:
        """Its name, beside the load."""
        side = np.cross(UP, eye)
        at = self.box.center + 0.75 * self.box.size[0] * side / np.linalg.norm(side)
        place = self.place
        return Label(self.body.name, lambda frame: place[frame] + at)


def _size_of(body: Body) -> np.ndarray:
    """Edges of the box that has a rigid body's mass and principal moments, m."""
    moments = np.array(body.inertia)
    return np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / max(body.mass, 1e-9), 1e-6))
