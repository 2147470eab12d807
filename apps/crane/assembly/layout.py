"""Where everything of a crane scene stands in the full vectors: frames, bodies, stations of the rope, rims.

The rope is cut at stations: the items of its path, and the nodes that divide each span. A station has a position and
the material coordinate that is there. What rides on a frame follows its twelve numbers, what rides on a body its
position. Where that body turns, the way from its centre to the rope's end is free, and a socket holds it. The nodes of
a span are free, and their material follows that of the marks at both its ends in proportion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from crane.assembly.loads import floating, rises
from crane.assembly.prepared import FrameMotion, motion_of
from crane.geometry.line import WHEEL
from crane.geometry.quaternion import QUATERNION, quaternion_of, rotation_of, turned_least
from crane.geometry.reeving import Path, ReevingError, Wheel, reeve, sigma_of
from crane.geometry.sagging import Sag, sagging
from crane.groups.span import MATERIAL, STATION
from crane.scene.scene import Anchor, Body, CraneScene, End, Sheave
from crane.scene.strength import longest_strain
from crane.sea.frames import GROUND, Frame, point_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import TimeFunctions, sample_all
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant
from tautline.system.system import Degrees
from tautline.system.time_functions import FunctionRequest

T = TypeVar("T")
AXES = 3
ROUNDING = 1.0e-9
"""Share of its length by which a rope that is as long as its path may seem shorter."""
TOUCHES = 1.0e-6
"""Height over the ground, m, that rounding may leave of a body that is drawn on it."""
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])


@dataclass
class Requests:
    """Functions of time of a scene, as they are asked for."""

    of: list[FunctionRequest] = field(default_factory=list)

    def add(self, request: FunctionRequest) -> int:
        """Number of a function."""
        self.of.append(request)
        return len(self.of) - 1


@dataclass
class Layout:
    """A scene's geometry at t = 0 and its degrees of freedom.

    Attributes
    ----------
    scene : CraneScene
    frames : tuple of Frame
    frame : dict
        Place of each frame's twelve numbers, by its place among `frames`; `GROUND` too.
    body : dict
        Place of each body's position, by its name.
    station : list of int
        Places of all stations, along the rope.
    item : list of int
        Number of the station of each item of the path.
    rim : dict
        Place of the travel of a rim that the rope may slip on, by the number of its item.
    turn : dict
        Place of the quaternion of each body that turns, by its name.
    arm : dict
        Place of the way to the rope's end from the centre of the body that turns with it, by the number of its item.
    supply : dict
        Place of the material that is laid out at a drum of prescribed motion at the start, by the number of its item.
    wheels : (items,) records of ``WHEEL``
        With a radius of zero for points.
    path : Path
        The path of the rope at t = 0.
    entries : (frames, 12) array
        The frames' numbers at t = 0.
    stretch : float
        Of the rope as it is laid out, by which material and rims that do not slip go together.
    known : dict
        What `once` has made, shared by the layouts of all scenes of one geometry.
    """

    scene: CraneScene
    frames: tuple[Frame, ...]
    frame: dict[int, int]
    body: dict[str, int]
    station: list[int]
    item: list[int]
    rim: dict[int, int]
    turn: dict[str, int]
    arm: dict[int, int]
    supply: dict[int, int]
    wheels: np.recarray
    path: Path
    entries: np.ndarray
    degrees: Degrees
    requests: Requests
    stretch: float = 1.0
    known: dict[str, Any] = field(default_factory=dict, repr=False)

    def once(self, what: str, make: Callable[[], T]) -> T:
        """What ``make`` gives of the geometry alone: it is made for the first of many scenes that have it in common.

        It is not to be changed by anybody.
        """
        if what not in self.known:
            self.known[what] = make()
        return self.known[what]

    def of_scene(self, scene: CraneScene) -> Layout:
        """The same of a scene of the same geometry, with degrees of freedom, requests and wheels of its own."""
        return replace(
            self, scene=scene, supply=dict(self.supply), wheels=self.wheels.copy(), degrees=self.degrees.copy(),
            requests=Requests(list(self.requests.of)),
        )  # fmt: skip

    @property
    def spans(self) -> list[tuple[int, int]]:
        """First and last station of every span of the path, by their numbers."""
        return list(zip(self.item[:-1], self.item[1:], strict=True))

    def turns_about(self, item: int) -> bool:
        """Whether frames move an item against what the rope goes to from there: its line may go round the item.

        What swings on a rope beside an item that stands still does not count.
        """
        own = self._stands_on(item)
        beside = [i for i in (item - 1, item + 1) if 0 <= i < len(self.item)]
        return any(self._moves(frame) for i in beside for frame in own ^ self._stands_on(i))

    def _stands_on(self, item: int) -> set[int]:
        """Frames that carry an item, each with its parents; none of what rides on a body."""
        places = {frame.name: k for k, frame in enumerate(self.frames)}
        name = self.scene.frame_of(self.scene.path[item])
        k, found = GROUND if name is None else places[name], set()
        while k != GROUND:
            found.add(k)
            k = self.frames[k].parent
        return found

    def _moves(self, k: int) -> bool:
        """Whether a frame moves in its parent, or may be moved while the run goes on."""
        frame = self.frames[k]
        steered = any(name in self.scene.driven for i in range(len(frame.words)) for name in frame.inputs_of(i))
        return steered or any(not isinstance(motion, Constant) for motion in frame.motion)

    def material(self, item: int) -> int:
        """Place of the material coordinate at an item."""
        return self.station[self.item[item]] + MATERIAL


def entries_of(
    degrees: Degrees, functions: TimeFunctions, places: Sequence[int], time: np.ndarray, order: int = 0
) -> np.ndarray:
    """Values of held degrees of freedom at times (m,) s, or their rates (order 1): (m, len(places))."""
    entries = np.zeros((time.size, len(places)))
    if order == 0:
        entries[:] = degrees.value[list(places)]
    driven = [k for k, place in enumerate(places) if degrees.motion.get(place, -1) >= 0]
    numbers = [degrees.motion[places[k]] for k in driven]
    entries[:, driven] = sample_all(functions, numbers, time)[:, :, order].T
    return entries


def has_rim(item: Any) -> bool:
    """Whether a wheel's rim may move apart from the rope: a capstan that can turn."""
    return isinstance(item, Sheave) and item.law == "capstan" and item.inertia > 0.0 and not item.locked


def stands(scene: CraneScene, body: Body) -> bool:
    """Whether the ground is to carry a body from the start. Where the scene gives no length of rope, the rope does."""
    if scene.ground is None or scene.rope.length is None:
        return False
    return body.lowest <= scene.ground.level + TOUCHES


def orientation_of(scene: CraneScene, body: Body) -> np.ndarray:
    """Quaternion (4,) of a body that turns, as it is laid out: as drawn, or with its rope's end above its centre.

    Of a buoy that is below its centre.

    A search for rest goes on from there. A body is turned only if its scene does not say how it is turned: it hangs by
    one end, nothing carries it from below, and no `orientation` is given. It is turned by the least angle.
    """
    drawn = quaternion_of(body.orientation)
    ends = [item.offset for item in scene.path if isinstance(item, End) and item.body == body.name]
    up = -np.array(scene.gravity, dtype=float)
    said = stands(scene, body) or len(ends) != 1 or "orientation" in body.model_fields_set
    if scene.start != "static" or said or not any(ends[0]) or not up.any():
        return drawn
    return turned_least(drawn, rotation_of(drawn) @ ends[0], -up if rises(scene, body) else up)


def lay_out(scene: CraneScene, functions: TimeFunctions | None = None) -> Layout:
    """Lay a scene out, where its frames are at t = 0; ``functions`` are its own where some are held at other values.

    Raises
    ------
    SceneError
        Where no rope can take the path, and for faults of the files of a vessel's motion.
    """
    motion = motion_of(scene) if functions is None else motion_of(scene).held(functions)
    laid, wheels = scene.once("layout", _geometry(scene, motion), lambda: _laid_out(scene, motion))
    _refuse_load_above(scene, wheels)
    _refuse_short(scene, laid.path)
    _refuse_floating(scene, laid.path)
    return laid.of_scene(scene)


def _geometry(scene: CraneScene, motion: FrameMotion) -> tuple[Any, ...]:
    """All that a layout follows from: scenes with other masses, drags, forces or solvers have the same."""
    turned = [tuple(orientation_of(scene, body)) if body.inertia is not None else None for body in scene.bodies]
    bodies = tuple((body.name, body.position, body.guide, body.inertia) for body in scene.bodies), tuple(turned)
    still = scene.vessel is None
    return motion, still, scene.path, bodies, scene.rope, scene.elements, scene.gravity, scene.start


def _laid_out(scene: CraneScene, motion: FrameMotion) -> tuple[Layout, list[Wheel]]:
    """A layout, and its items as the geometry sees them."""
    frames, places, requests, entries = motion.frames, motion.places, motion.requests, motion.entries
    on = [_frame_number(scene, item, places) for item in scene.path]
    wheels = [
        _wheel(scene, item, *((entries[k], frames[k].pivot) if k != GROUND else (IDENTITY, (0.0, 0.0, 0.0))))
        for item, k in zip(scene.path, on, strict=True)
    ]
    _refuse_load_above(scene, wheels)
    path = _reeved(scene, wheels)
    _refuse_short(scene, path)
    _refuse_loose(scene, path)
    builder = _Builder(scene, frames, entries, requests)
    records = np.zeros(len(wheels), WHEEL).view(np.recarray)
    for i, (wheel, k) in enumerate(zip(wheels, on, strict=True)):
        turned = (entries[k] if k != GROUND else IDENTITY)[3:].reshape(3, 3).T
        mark = path.sigma[i] * path.marks[i]
        records[i] = (
            builder.frame[k], path.sigma[i] * wheel.radius, turned.T @ wheel.axis, turned.T @ mark,
            int(k != GROUND and _turns(requests, k)),
        )  # fmt: skip
    return builder.finish(records, wheels, on, path), wheels


def _turns(requests: list[FunctionRequest], k: int) -> bool:
    return any(not isinstance(r.model, Constant) for r in requests[ENTRIES * k + 3 : ENTRIES * (k + 1)])


def _frame_number(scene: CraneScene, item: Any, places: dict[str, int]) -> int:
    name = scene.frame_of(item)
    return GROUND if name is None else places[name]


def _wheel(scene: CraneScene, item: Any, entries: np.ndarray, pivot: Sequence[float]) -> Wheel:
    """An item as the geometry sees it, where it is at t = 0."""
    turned = entries[3:].reshape(3, 3).T
    if isinstance(item, End):
        body = scene.body(item.body)
        return Wheel(
            item.name, body.position + _turned(scene, body) @ item.offset, np.array([0, 1, 0]), 0.0, None, True
        )
    if isinstance(item, Anchor):
        return Wheel(item.name, point_of(entries, pivot, item.position), np.array([0, 1, 0]), 0.0, None, True)
    if isinstance(item, Sheave) and item.body is not None:
        center = np.add(scene.body(item.body).position, item.offset)
        return Wheel(item.name, center, np.array(item.unit_axis), item.radius, item.wrap)
    center = point_of(entries, pivot, item.center)
    return Wheel(item.name, center, turned @ np.array(item.unit_axis), item.radius, item.wrap)


def _turned(scene: CraneScene, body: Body) -> np.ndarray:
    """Rotation (3, 3) of a body as it is laid out."""
    return rotation_of(orientation_of(scene, body)) if body.inertia is not None else np.eye(AXES)


def _refuse_load_above(scene: CraneScene, wheels: list[Wheel]) -> None:
    """Refuse a load that is to hang at rest and is drawn above all that its rope leads to.

    A buoy may be there: rope of a given length holds it down.
    """
    up = -np.array(scene.gravity, dtype=float)
    if scene.start != "static":
        return
    for k, body in enumerate(scene.bodies):
        at = [i for i, item in enumerate(scene.path) if isinstance(item, (End, Sheave)) and item.body == body.name]
        beside = {j for i in at for j in (i - 1, i + 1) if 0 <= j < len(wheels)} - set(at)
        if not beside or body.spring is not None or body.mass == 0.0:
            continue
        highest = max(beside, key=lambda j: float(up @ wheels[j].center))
        if any(up @ wheels[highest].center > up @ wheels[i].center for i in at):
            continue
        name, cure = scene.path[highest].name, "put it below, or write start: as drawn"
        if scene.gravity[2] > 0.0:
            cure = f"gravity points up. Write {scene.gravity[2]:g} with a minus, or {cure}"
        cause = f"is above {name}, which it hangs from: no taut rope holds it up there"
        if rises(scene, body):
            if scene.rope.length is not None:
                continue
            cause = f"is above {name}, which holds it down: no length of rope is looked for there"
            cure = "give rope.length, or write start: as drawn"
        raise SceneError([scene.problem(f"bodies[{k}].position", cause, cure)])


def _refuse_floating(scene: CraneScene, path: Path) -> None:
    """Refuse a load that is to hang at rest as high as drawn and goes up."""
    if scene.start != "static" or scene.rope.length is not None:
        return
    problems = []
    for one in floating(scene, path):
        name = scene.bodies[one.body].name
        what = "does not pull on its rope" if one.by_rope is None else "does not keep its rope taut"
        cause = f"{name} {what}: {one.cause(name)}. No length of rope holds it where it is drawn"
        problems.append(scene.problem(f"bodies[{one.body}]", cause, f"{one.cure}, or start: as drawn"))
    if problems:
        raise SceneError(problems)


def _reeved(scene: CraneScene, wheels: list[Wheel]) -> Path:
    """The rope's path over the wheels, found once for scenes that differ in other things."""
    thickness = scene.rope.diameter or 0.0
    places = tuple((w.name, w.center.tobytes(), w.axis.tobytes(), w.radius, w.wrap, w.point) for w in wheels)
    try:
        return scene.once("reeving", (places, thickness), lambda: reeve(wheels, sigma_of(wheels), thickness))
    except ReevingError as error:
        key = "path" if error.index is None else f"path[{error.index}].{scene.path[error.index].key}"
        raise SceneError([scene.problem(key, error.message, error.cure)]) from None


def carries_nothing(scene: CraneScene) -> bool:
    """Whether the rope holds no body, and nothing but its own weight and its ends makes its tension."""
    return all(getattr(item, "body", None) is None for item in scene.path)


def sags_of(scene: CraneScene, path: Path) -> list[Sag]:
    """How the spans of a rope hang that carries nothing; each has its share of what is too much or too little."""
    weight = scene.rope.mass_per_length * np.array(scene.gravity, dtype=float)
    length = scene.rope.length
    spare = 1.0 if length is None else length / float(path.chords.sum())
    return [
        sagging(
            path.tangents[i],
            span.length + (spare - 1.0) * float(path.chords[i]), scene.elements[i], weight, scene.rope.axial_stiffness,
        )
        for i, span in enumerate(path.spans)
    ]  # fmt: skip


def _drawn(scene: CraneScene, path: Path) -> list[np.ndarray]:
    """Points that divide each span, (n + 1, 3): on its chord, or where rest is looked for of a rope that only sags."""
    if scene.start == "static" and carries_nothing(scene):
        return [sag.points for sag in sags_of(scene, path)]
    found = []
    for i, count in enumerate(scene.elements):
        first, last = path.tangents[i]
        found.append(np.array([first + k / count * (last - first) for k in range(count + 1)]))
    return found


def _refuse_short(scene: CraneScene, path: Path) -> None:
    """Refuse a rope that would have to be stretched beyond what it bears to reach along its path."""
    length, way = scene.rope.length, float(path.chords.sum())
    if length is None:
        return
    most = longest_strain(scene)
    if length * (1.0 + most) >= way * (1.0 - ROUNDING):
        return
    cause = (
        f"{length:.6g} m of rope are shorter than the path, which is {way:.6g} m from end to end with the arcs on its "
        f"wheels: it would be stretched by {100.0 * (way / length - 1.0):.3g} %, and {100.0 * most:.3g} % is the most "
        "that it bears"
    )
    cure = f"give {way:.6g} m or more, move the items of the path together, or remove `length:`"
    raise SceneError([scene.problem("rope.length", cause, cure)])


class _Builder:
    """Numbers degrees of freedom in the order: frames, bodies, stations, rims."""

    def __init__(self, scene: CraneScene, frames: tuple[Frame, ...], entries: np.ndarray, requests: list) -> None:
        self.scene, self.frames, self.entries = scene, frames, entries
        self.requests = Requests()
        self.names: list[str] = []
        self.value: list[float] = []
        self.motion: dict[int, int] = {}
        self.masters: dict[int, tuple[list[tuple[int, float]], float]] = {}
        self.frame = {GROUND: self._add("the ground", ENTRIES, IDENTITY)}
        for i in range(ENTRIES):
            self.motion[self.frame[GROUND] + i] = -1
        for k, frame in enumerate(frames):
            self.frame[k] = self._add(frame.name, ENTRIES, entries[k])
            for i in range(ENTRIES):
                request = requests[ENTRIES * k + i]
                still = isinstance(request.model, Constant)
                self.motion[self.frame[k] + i] = -1 if still else self.requests.add(request)
                if not still:
                    self.value[self.frame[k] + i] = 0.0
        self.body = {body.name: self._add_body(body) for body in scene.bodies}
        self.turn = {
            # The four numbers of a quaternion have no names that a user knows.
            body.name: self._add(f"{body.name}: orientation", QUATERNION, orientation_of(scene, body), words=())
            for body in scene.bodies
            if body.inertia is not None
        }

    def _add(self, name: str, count: int, value: Any, words: Sequence[str] = ("x", "y", "z", "material")) -> int:
        first = len(self.names)
        self.names += [f"{name}: {words[i]}" if count <= len(words) else name for i in range(count)]
        self.value += [float(x) for x in value]
        return first

    def _add_body(self, body: Body) -> int:
        place = self._add(body.name, AXES, body.position)
        for i, axis in enumerate("xyz"):
            if axis in body.guide:
                self.motion[place + i] = -1
        return place

    def _add_arm(self, end: End) -> int:
        arm = _turned(self.scene, self.scene.body(end.body)) @ end.offset
        # It is no place in space, and has none of their names.
        return self._add(f"{end.name} from the centre of {end.body}", AXES, arm, words=())

    def finish(self, records: np.recarray, wheels: list[Wheel], on: list[int], path: Path) -> Layout:
        """Add the rope's stations and rims, and tie what is tied."""
        scene = self.scene
        station: list[int] = []
        item, points = [], _drawn(scene, path)
        for i, wheel in enumerate(wheels):
            item.append(len(station))
            station.append(self._add(wheel.name, STATION, (*wheel.center, 0.0)))
            if i < len(wheels) - 1:
                count = scene.elements[i]
                drawn = points[i]
                for k in range(1, count):
                    at = drawn[k]
                    station.append(
                        self._add(f"rope {wheel.name} to {wheels[i + 1].name}, node {k}", STATION, (*at, 0.0))
                    )
        rim = {
            i: self._add(f"{thing.name}: rim", 1, [0.0]) for i, thing in enumerate(scene.path) if has_rim(thing)
        }  # fmt: skip
        arm = {
            i: self._add_arm(thing)
            for i, thing in enumerate(scene.path)
            if isinstance(thing, End) and thing.body in self.turn and any(thing.offset)
        }
        for i, thing in enumerate(scene.path):
            self._place(thing, station[item[i]], on[i], arm.get(i))
        layout = Layout(
            scene, self.frames, self.frame, self.body, station, item, rim, self.turn, arm, {}, records, path,
            self.entries,
            Degrees(self.names, np.array(self.value), np.ones(len(self.names))), self.requests,
        )  # fmt: skip
        layout.degrees.motion.update(self.motion)
        for place, (masters, offset) in self.masters.items():
            layout.degrees.tie(place, masters, offset)
        return layout

    def _place(self, thing: Any, place: int, k: int, arm: int | None) -> None:
        """Put an item on what it rides on."""
        if arm is not None:
            for c in range(AXES):
                self.masters[place + c] = [(self.body[thing.body] + c, 1.0), (arm + c, 1.0)], 0.0
            return
        if isinstance(thing, End) or (isinstance(thing, Sheave) and thing.body is not None):
            for c in range(AXES):
                self.masters[place + c] = [(self.body[thing.body] + c, 1.0)], thing.offset[c]
            return
        drawn = thing.position if isinstance(thing, Anchor) else thing.center
        f = self.frame[k]
        for c in range(AXES):
            if k == GROUND:
                self.motion[place + c] = -1
                self.value[place + c] = drawn[c]
            else:
                arms = np.subtract(drawn, self.frames[k].pivot).tolist()
                self.masters[place + c] = [(f + c, 1.0), *((f + 3 + 3 * j + c, arms[j]) for j in range(AXES))], 0.0


def _refuse_loose(scene: CraneScene, path: Path) -> None:
    """Refuse to look for the rest of a rope that neither gravity nor its own tension gives a shape."""
    length, way = scene.rope.length, float(path.chords.sum())
    if length is None or any(scene.gravity) or scene.start != "static" or length < way:
        return
    cause = (
        f"{length:.6g} m of rope are slack along the path of {way:.6g} m, and without gravity slack rope has no rest"
    )
    cure = f"give less than {way:.6g} m, or give gravity, or start: as drawn"
    raise SceneError([scene.problem("rope.length", cause, cure)])
