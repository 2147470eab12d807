"""What carries a crane's wheels, drawn to fit them: booms, heads, stands, pedestal and deck, and how all of it moves.

Of this a scene gives only pivots and where wheels and anchors stand. A boom goes from its frame's pivot, or from beside
the drum where there is no frame, to the sheaves that are farthest from there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from crane.results.course import Course
from crane.scene.scene import Anchor, Drum, End, Sheave
from crane.view import machinery
from crane.view.poses import poses_of
from crane.view.rope_line import PITCH, diameter_of, turns_on
from tautline.view.space.appearance import DECK, PAINT, STEEL, Solid, stored
from tautline.view.space.mesh import Mesh, box, cylinder, joined, moved

VESSEL = "vessel"
LOST = 1.0e-6
"""Distance between where a wheel is and where its frame puts it, m, from which the frame's motion is not known."""
HEAD = 0.15
"""Share of a boom's length within which sheaves belong to its head."""
CONCRETE = "#A9A59C"
UP = np.array([0.0, 0.0, 1.0])


class Fixed(NamedTuple):
    """A wheel or an anchor that is on no body: its number on the path, its mount by name, and its place as drawn."""

    i: int
    item: Any
    mount: str | None
    place: np.ndarray


class Site:
    """A crane's geometry as drawn, and the poses of its frames.

    Attributes
    ----------
    poses : dict
        Of ``None`` for the ground, ``vessel`` and each frame: (m, 4, 4), which takes a place as drawn to where it is.
    loads : list of (array (3,), float)
        Places of loads as drawn, and half the length of each, m, that a deck keeps clear of.
    lost : bool
        Whether the vessel's motion was not at hand, so that only its shift is known, from what rides on it.
    """

    def __init__(self, result: Any, course: Course) -> None:
        self.result, self.course, self.scene = result, course, course.scene
        self.diameter = diameter_of(self.scene)
        self.fixed = [
            Fixed(i, item, self.scene.frame_of(item), np.array(_drawn(item), dtype=float))
            for i, item in enumerate(self.scene.path)
            if not isinstance(item, End) and getattr(item, "body", None) is None
        ]
        self.loads: list[tuple[np.ndarray, float]] = []
        self.poses = poses_of(course.layout, np.ascontiguousarray(result.time))
        self.lost = self._find_vessel()

    def root(self, mount: str | None) -> str | None:
        """What a mount stands on in the end: ``vessel``, or None for the ground."""
        while mount is not None and mount != VESSEL:
            mount = self.scene.frame_of(self.scene.frame(mount))
        return mount

    def _find_vessel(self) -> bool:
        """Shift what rides on the vessel to where it was stored; whether that was needed."""
        aboard = [one for one in self.fixed if self.root(one.mount) == VESSEL]
        if not aboard:
            return False
        shift = np.mean(
            [self.course.center[:, one.i] - _at(self.poses[one.mount], one.place) for one in aboard], axis=0
        )
        if float(np.abs(shift).max()) < LOST:
            return False
        for mount, pose in self.poses.items():
            if self.root(mount) == VESSEL:
                pose[:, :3, 3] += shift
        return True

    @property
    def size(self) -> float:
        """Largest distance along an axis between the wheels and anchors that are on no body, m; of one, its own."""
        radius = max((getattr(one.item, "radius", 0.0) for one in self.fixed), default=0.0)
        places = np.array([one.place for one in self.fixed]).reshape(-1, 3)
        return float(np.ptp(places, axis=0).max(initial=0.0)) if len(places) > 1 else 10.0 * radius

    def solid(self, name: str, mesh: Mesh, mount: str | None, colour: str) -> Solid:
        """A solid as drawn on a mount."""
        pose = None if mount is None else stored(self.poses[mount])
        return Solid(name, *mesh, pose, colour, smooth=False)

    def width(self, i: int) -> float:
        """Width of a sheave along its axis, m: less than to the next one beside it."""
        item = self.scene.path[i]
        wide = 2.2 * self.diameter
        for j, other in enumerate(self.scene.path):
            if j == i or not isinstance(other, Sheave) or other.body != item.body:
                continue
            apart = self.course.center[0, j] - self.course.center[0, i]
            aside = abs(float(apart @ self.course.axis[0, i]))
            off = float(np.sqrt(max(apart @ apart - aside**2, 0.0)))
            if aside > 0.1 * self.diameter and off < item.radius + other.radius:
                wide = min(wide, 0.9 * aside)
        return wide

    def drum_half(self, i: int) -> float:
        """Half a drum's length between its flanges, m: the rope leaves in the middle, and lies on one side of it."""
        return (float(turns_on(self.result, self.course, i).max()) * PITCH + 1.5) * self.diameter


def _drawn(item: Any) -> Any:
    return item.position if isinstance(item, Anchor) else item.center


def _at(pose: np.ndarray, place: np.ndarray) -> np.ndarray:
    return pose[:, :3, :3] @ place + pose[:, :3, 3]


class _Boom(NamedTuple):
    """A boom: mount, foot and tip, a level unit vector across it, what is at its head, and half its head's breadth."""

    mount: str | None
    foot: np.ndarray
    tip: np.ndarray
    across: np.ndarray
    head: list[Fixed]
    half: float

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.tip - self.foot))


def structure(site: Site) -> list[Solid]:
    """Everything that carries the wheels."""
    made: list[Solid] = []
    booms = list(_booms(site))
    for boom in booms:
        name = "boom" if boom.mount is None or boom.mount == VESSEL else boom.mount
        made.append(site.solid(name, _lattice(site, boom), boom.mount, PAINT))
        made += _plates(site, boom.head, boom.mount, f"{name} head")
    held = {one.i for boom in booms for one in boom.head}
    made += _bases(site, booms)
    for one in site.fixed:
        if one.i not in held:
            made += _holder(site, one, booms)
    return made


def _booms(site: Site) -> Iterator[_Boom]:
    scene = site.scene
    for mount in site.poses:
        here = [one for one in site.fixed if one.mount == mount]
        tips = [one.place for one in here if isinstance(one.item, Sheave)]
        if mount is not None and mount != VESSEL:
            tips += [np.array(frame.pivot) for frame in scene.frames if scene.frame_of(frame) == mount]
            tips = tips or [one.place for one in here if isinstance(one.item, Anchor)]
            foot = np.array(scene.frame(mount).pivot)
        else:
            foot = _foot(here, tips)
        if foot is None or not tips:
            continue
        distance = [float(np.linalg.norm(tip - foot)) for tip in tips]
        length = max(distance)
        if length < 4.0 * site.diameter:
            continue
        far = tips[int(np.argmax(distance))]
        head = [
            one for one in here
            if not isinstance(one.item, Drum) and float(np.linalg.norm(one.place - far)) < HEAD * length
        ]  # fmt: skip
        wheels = [one for one in head if isinstance(one.item, Sheave)]
        tip = np.mean([one.place for one in wheels], axis=0) if wheels else far
        across = np.cross(UP, tip - foot)
        size = float(np.linalg.norm(across))
        if size < 0.05 * length:
            across = np.array(wheels[0].item.unit_axis) if wheels else np.array([0.0, 1.0, 0.0])
            across = across - across[2] * UP if abs(across[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
            size = float(np.linalg.norm(across))
        across = across / size
        half = max((abs(float((one.place - tip) @ across)) for one in head), default=0.0) + 2.2 * site.diameter
        yield _Boom(mount, foot, tip, across, head, half)


def _foot(here: list[Fixed], tips: list[np.ndarray]) -> np.ndarray | None:
    """Foot of a boom without a frame: before the drum, as low as that stands; None without a drum."""
    drums = [one for one in here if isinstance(one.item, Drum)]
    if not drums or not tips:
        return None
    way = np.mean(tips, axis=0) - drums[0].place
    level = float(np.hypot(way[0], way[1]))
    radius = drums[0].item.radius
    ahead = min(2.0 * radius, 0.3 * level) * np.array([way[0], way[1], 0.0]) / max(level, 1e-9)
    return drums[0].place + ahead - np.array([0.0, 0.0, _standing(drums[0])])


def _standing(drum: Fixed) -> float:
    """Height of a drum's axle above what it stands on, m."""
    return 1.6 * float(drum.item.radius)


def _lattice(site: Site, boom: _Boom) -> Mesh:
    length = boom.length
    foot = max(0.02 * length, boom.half)
    for one in site.fixed:
        if isinstance(one.item, Drum) and np.linalg.norm(one.place - boom.foot) < 0.2 * length:
            foot = max(foot, site.drum_half(one.i) + 0.6 * one.item.radius)
    middle = max(0.02 * length, boom.half)
    return machinery.lattice(boom.foot, boom.tip, boom.across, (foot, middle, boom.half), 0.05 * length)


def _plates(site: Site, head: list[Fixed], mount: str | None, name: str) -> list[Solid]:
    """Cheek plates that hold sheaves of one axis, and anchors beside them."""
    wheels = [one for one in head if isinstance(one.item, Sheave)]
    if not wheels:
        return []
    axis = np.array(wheels[0].item.unit_axis)
    held = [one for one in head if isinstance(one.item, Anchor) or abs(axis @ np.array(one.item.unit_axis)) > 0.99]
    radius = 0.28 * max(one.item.radius for one in wheels)
    half = 0.75 * max(site.width(one.i) for one in wheels)
    mesh = machinery.cheeks(np.array([one.place for one in held]), axis, radius, half, 0.3 * site.diameter)
    return [site.solid(name, mesh, mount, PAINT)]


def _holder(site: Site, one: Fixed, booms: list[_Boom]) -> list[Solid]:
    """What holds a wheel or an anchor that is at no boom's head."""
    name, d = one.item.name, site.diameter
    if isinstance(one.item, Anchor):
        return [site.solid(f"anchor {name}", moved(machinery.hook(2.5 * d), np.eye(3), one.place), one.mount, STEEL)]
    if isinstance(one.item, Drum):
        axis, half = np.array(one.item.unit_axis), site.drum_half(one.i) + 0.4 * one.item.radius
        ahead = np.cross(axis, UP) if abs(axis[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
        bars = []
        for side in (-1.0, 1.0):
            axle = one.place + side * half * axis
            for way in (-1.0, 1.0):
                foot = axle + way * 0.8 * one.item.radius * ahead - np.array([0.0, 0.0, _standing(one)])
                bars.append(machinery.strut(axle, foot, 0.09 * one.item.radius))
        return [site.solid(f"stand of {name}", joined(*bars), one.mount, PAINT)]
    own = next((boom for boom in booms if boom.mount == one.mount), None)
    made = _plates(site, [one], one.mount, f"plates of {name}")
    if own is not None:
        way = own.tip - own.foot
        share = float(np.clip((one.place - own.foot) @ way / (way @ way), 0.0, 1.0))
        bracket = machinery.strut(one.place, own.foot + share * way, 0.12 * one.item.radius)
        made.append(site.solid(f"bracket of {name}", bracket, one.mount, PAINT))
    else:
        top = one.place + np.array([0.0, 0.0, 1.8 * one.item.radius])
        beam = joined(
            machinery.strut(one.place, top, 0.12 * one.item.radius),
            moved(box((3.0 * one.item.radius, 1.5 * one.item.radius, 0.4 * one.item.radius)), np.eye(3), top),
        )
        made.append(site.solid(f"beam above {name}", beam, one.mount, PAINT))
    return made


def _bases(site: Site, booms: list[_Boom]) -> Iterator[Solid]:
    """Deck or foundation, and pedestals of what slews on it."""
    scene = site.scene
    for root in (None, VESSEL):
        pivots = [np.array(frame.pivot) for frame in scene.frames if scene.frame_of(frame) == root]
        drums = [one for one in site.fixed if one.mount == root and isinstance(one.item, Drum)]
        if not pivots and not drums:
            continue
        feet = np.array([*pivots, *(one.place for one in drums)])
        middle = feet.mean(axis=0)
        tips = [boom.tip for boom in booms if site.root(boom.mount) == root]
        tips = tips or [middle + (100.0 * site.diameter, 0.0, 0.0)]
        way = max((tip - middle for tip in tips), key=lambda x: float(np.hypot(x[0], x[1])))
        size = max(float(np.linalg.norm(tip - middle)) for tip in tips)
        heights = [one.place[2] - _standing(one) for one in drums] + [pivot[2] - 0.22 * size for pivot in pivots]
        level = float(min(heights))
        solid_ground = scene.ground is not None and root is None and 0.0 <= level - scene.ground.level < 2.0 * size
        if solid_ground:
            level = scene.ground.level
        radius = 0.05 * size
        for k, pivot in enumerate(pivots):
            mesh = machinery.column(np.array([*pivot[:2], level]), pivot - (0.0, 0.0, 0.03 * size), radius)
            yield site.solid(f"pedestal {k + 1}", mesh, root, PAINT)
        if not solid_ground:
            name, colour, thick = ("deck", DECK, 0.06) if root == VESSEL else ("foundation", CONCRETE, 0.025)
            if drums or root == VESSEL:
                slab = _slab(site, feet, middle, way, thick * size, size)
            else:
                # All around a crane that slews, and small, so as to hide no load.
                spread = float(np.linalg.norm((feet - middle)[:, :2], axis=1).max())
                slab = moved(
                    cylinder(spread + 0.15 * size, thick * size), np.eye(3), (*middle[:2], -0.5 * thick * size)
                )
            mesh = moved(slab, np.eye(3), (0.0, 0.0, level))
            yield site.solid(name, mesh, root, colour)


def _slab(site: Site, feet: np.ndarray, middle: np.ndarray, way: np.ndarray, thick: float, size: float) -> Mesh:
    """A slab with its top at height 0 under the machinery, clear of what hangs from the tip at the start."""
    reach = float(np.hypot(way[0], way[1]))
    along = np.array([way[0], way[1], 0.0]) / reach if reach > 0.05 * size else np.array([1.0, 0.0, 0.0])
    across = np.cross(UP, along)
    a, b = (feet - middle) @ along, (feet - middle) @ across
    broad = max((site.drum_half(one.i) for one in site.fixed if isinstance(one.item, Drum)), default=0.0)
    least, front, back = a.max() + 0.08 * size, min(0.35 * size, 0.6 * reach), a.min() - 0.3 * size
    for place, half in site.loads:
        at = float((place - middle) @ along)
        front = min(front, at - 1.2 * half - 0.02 * size) if at > 0.0 else front
    front = max(front, least)
    half = max(float(np.abs(b).max()) + 1.5 * broad, 0.2 * size)
    center = middle + 0.5 * (front + back) * along
    mesh = box((front - back, 2.0 * half, thick))
    return moved(mesh, np.column_stack([along, across, UP]), (center[0], center[1], -0.5 * thick))
