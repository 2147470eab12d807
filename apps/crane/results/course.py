"""The rope's course through a run, from what was stored: directions of spans, where it touches, what lies on sheaves.

A result holds where items and nodes are; how a taut rope touches its wheels follows from that and the wheels' axes, and
these from the scene. A span of several elements begins and ends with the direction of its first and of its last one.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crane.assembly.layout import Layout, entries_of, lay_out
from crane.results.observe import LEAD_ANGLE, WRAP_MIDDLE
from crane.rope_life.bending import Contact, drum_contact
from crane.scene.scene import CraneScene, Drum, Sheave
from crane.scene.surroundings import Motion
from tautline.results.errors import ResultError
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.system.time_functions import compile_functions
from tautline.version import __version__

SETTLED, MOST_ITERATIONS = 1.0e-9, 30
AXES, COLUMN = 3, 3
TURN = 2.0 * np.pi


def scene_of(result: Any) -> CraneScene:
    """Read the scene that a result carries.

    Raises
    ------
    ResultError
        Where it cannot be read, as when files that it names are not beside the result.
    """
    place = result.path or Path("result")
    try:
        return validate(CraneScene, Document.parse(str(result.attributes.get("scene", "")), place))
    except SceneError as error:
        first = error.problems[0]
        cause = f"its scene cannot be read: {': '.join(filter(None, (first.key, first.cause)))}"
        cure, by = "put the files that the scene names beside the result", result.attributes.get("version")
        if by and by != __version__:
            cure = f"read it with Tautline {by}, which wrote it, or {cure}"
        raise ResultError(place, cause, cure) from None


def laid_out(scene: CraneScene) -> Layout:
    """Lay a scene out; with its vessel at rest where the file of its motion is not at hand."""
    try:
        return lay_out(scene)
    except SceneError:
        if scene.vessel is None:
            raise
        return lay_out(scene.model_copy(update={"vessel": scene.vessel.model_copy(update={"motion": Motion()})}))


@dataclass(frozen=True, eq=False)
class Course:
    """Way of the rope at m frames over n items.

    Attributes
    ----------
    scene : CraneScene
    layout : Layout
    center, axis : (m, n, 3) array
        Centres and unit axes of the items, m; the axis of a point is of no meaning.
    comes, leaves : (m, n, 3) array
        Direction of the rope where it runs onto an item and where it leaves; 0 where there is none.
    middle : (m, n) array
        Right-handed angle about the axis from an item's mark to the middle of what lies on it, rad.
    """

    scene: CraneScene
    layout: Layout
    center: np.ndarray
    axis: np.ndarray
    comes: np.ndarray
    leaves: np.ndarray
    middle: np.ndarray

    def touch(self, i: int, comes: bool) -> np.ndarray:
        """Point where the rope runs onto an item, or leaves it, (m, 3) m."""
        return self.center[:, i] + _beside(
            self.comes[:, i] if comes else self.leaves[:, i], self.axis[:, i], float(self.layout.wheels.radius[i])
        )


def nodes_of(scene: CraneScene) -> np.ndarray:
    """Number, from 0, of the node of each item of the path."""
    return np.concatenate(([0], np.cumsum(scene.elements)))


def course_of(result: Any, layout: Layout, frames: Any = slice(None), columns: np.ndarray | None = None) -> Course:
    """Find the rope's course at some frames.

    Parameters
    ----------
    result : Result, or mapping of variables
    layout : Layout
        Of its scene.
    frames : slice or int array
    columns : (m, n, 3, 3) array, optional
        Of the rotation of what each item rides on; by default as the scene moves it.
    """
    scene, wheels = layout.scene, layout.wheels
    node = nodes_of(scene)
    position = result["position"][frames]
    center = position[:, node]
    if columns is None:
        columns = _columns(layout, np.ascontiguousarray(result.time[frames]))
    axis = np.einsum("mijc,ij->mic", columns, wheels.axis)
    rho = np.array(wheels.radius)
    first, last = node[:-1], node[1:]
    single = (last - first == 1)[:, None]
    # The next node of a span of several elements is a point; else it is the wheel at the other end.
    after = np.where(single, center[:, 1:], position[:, first + 1])
    before = np.where(single, center[:, :-1], position[:, last - 1])
    far, near = np.where(single[:, 0], rho[1:], 0.0), np.where(single[:, 0], rho[:-1], 0.0)
    comes, leaves = np.zeros_like(center), np.zeros_like(center)
    leaves[:, :-1] = _tangents(after - center[:, :-1], axis[:, :-1], rho[:-1], axis[:, 1:], far)
    comes[:, 1:] = _tangents(center[:, 1:] - before, axis[:, :-1], near, axis[:, 1:], rho[1:])
    mark = np.einsum("mijc,ij->mic", columns, wheels.mark) * np.sign(rho)[:, None]
    middle = _middle(result, frames, layout, mark, axis, comes, leaves)
    return Course(scene, layout, center, axis, comes, leaves, middle)


def _columns(layout: Layout, time: np.ndarray) -> np.ndarray:
    """Columns of the rotation of what each item rides on, (m, n, 3, 3): [..., j, :] is the j-th."""
    degrees = layout.degrees
    functions = compile_functions(layout.requests.of)
    made: dict[int, np.ndarray] = {}
    for frame in {int(place) for place in layout.wheels.frame}:
        places = range(frame + COLUMN, frame + COLUMN + AXES * AXES)
        entries = entries_of(degrees, functions, places, time)
        made[frame] = entries.reshape(-1, AXES, AXES)
    return np.stack([made[int(place)] for place in layout.wheels.frame], axis=1)


def _beside(e: np.ndarray, axis: np.ndarray, rho: float | np.ndarray) -> np.ndarray:
    """From a wheel's centre to where a rope of direction e touches: rho (e x a)/|e x a|."""
    w = np.cross(e, axis)
    size = np.maximum(np.linalg.norm(w, axis=-1, keepdims=True), 1e-12)
    return np.asarray(rho)[..., None] * w / size


def _tangents(d: np.ndarray, a1: np.ndarray, rho1: np.ndarray, a2: np.ndarray, rho2: np.ndarray) -> np.ndarray:
    """Directions of many spans between wheels d apart, (m, k, 3): e = normalised(d + x2(e) - x1(e))."""
    e = d / np.linalg.norm(d, axis=-1, keepdims=True)
    if not (np.any(rho1) or np.any(rho2)):
        return e
    for _ in range(MOST_ITERATIONS):
        chord = d + _beside(e, a2, rho2) - _beside(e, a1, rho1)
        last, e = e, chord / np.maximum(np.linalg.norm(chord, axis=-1, keepdims=True), 1e-300)
        if float(np.abs(e - last).max(initial=0.0)) < SETTLED:
            break
    return e


def _middle(
    result: Any, frames: Any, layout: Layout, mark: np.ndarray, axis: np.ndarray, comes: np.ndarray, leaves: np.ndarray
) -> np.ndarray:
    """Angles from the marks to the middle of the wraps; to where the rope touches at an end of the path.

    Whole turns are those that the run has counted; of a scene in which nothing turns about a wheel there are none.
    """
    rho, path = np.array(layout.wheels.radius), layout.scene.path
    sigma = np.sign(rho)
    side = _beside(np.where(np.any(comes != 0.0, axis=-1, keepdims=True), comes, leaves), axis, sigma)
    across = np.einsum("mic,mic->mi", axis, np.cross(mark, side))
    angle = np.arctan2(across, np.einsum("mic,mic->mi", mark, side))
    counted = np.zeros_like(angle)
    sheaves = [i for i, item in enumerate(path) if isinstance(item, Sheave)]
    if sheaves:
        # From where it runs on, half the wrap further; of this sum only what is left of whole turns is known.
        angle[:, sheaves] += 0.5 * sigma[sheaves] * result["wrap_angle"][frames]
        if WRAP_MIDDLE in result:
            counted[:, sheaves] = result[WRAP_MIDDLE][frames]
    drums = [i for i, item in enumerate(path) if isinstance(item, Drum)]
    if drums and LEAD_ANGLE in result:
        takes_off = sigma[drums] * np.where(np.array(drums) == 0, -1.0, 1.0)
        counted[:, drums] = takes_off * result[LEAD_ANGLE][frames]
    angle = counted + (angle - counted + np.pi) % TURN - np.pi
    return np.where(rho == 0.0, 0.0, angle)


def contacts_of(result: Any, course: Course) -> list[Contact]:
    """Rope on every drum and sheave of the path through a whole run, for `crane.rope_life.bending.bending_cycles`."""
    scene, layout = course.scene, course.layout
    node = nodes_of(scene)
    tension, material = result["tension"], result["material_coordinate"]
    stiffness, rho = scene.rope.axial_stiffness, np.array(layout.wheels.radius)
    reference = np.array(layout.wheels.axis[int(np.argmax(np.abs(rho)))])
    made: list[Contact] = []
    for i, item in enumerate(scene.path):
        if not isinstance(item, (Sheave, Drum)):
            continue
        sides = ([tension[:, i - 1, 1]] if i > 0 else []) + ([tension[:, i, 0]] if i < len(node) - 1 else [])
        pulled = np.maximum(np.max(sides, axis=0), 0.0)
        stretch = 1.0 + pulled / stiffness
        middle = material[:, node[i]] + rho[i] * course.middle[:, i] / stretch
        side = float(np.sign(rho[i]) * np.dot(layout.wheels.axis[i], reference))
        # Axes more across one another than along bend in neither the same way nor the other.
        side = side if abs(side) > 0.5 else 0.0
        if isinstance(item, Drum):
            stored = "before" if i == 0 else "after"
            made.append(drum_contact(item.name, middle, pulled, item.radius, side, stored))
            continue
        k = next(j for j, other in enumerate(scene.sheaves) if other is item)
        half = 0.5 * item.radius * result["wrap_angle"][:, k] / stretch
        made.append(Contact(item.name, middle - half, middle + half, pulled, item.radius, side))
    return _apart(made)


def _apart(contacts: list[Contact]) -> list[Contact]:
    """The same without the overlap that rounding and a slack rope may leave between neighbours."""
    for k in range(len(contacts) - 1):
        one, two = contacts[k], contacts[k + 1]
        over = np.maximum(one.off - two.on, 0.0) if np.all(np.isfinite(one.off + two.on)) else np.zeros(1)
        if over.any():
            off, on = one.off - 0.5 * over, two.on + 0.5 * over
            contacts[k] = one._replace(off=off, on=np.minimum(one.on, off))
            contacts[k + 1] = two._replace(on=on, off=np.maximum(two.off, on))
    return contacts
