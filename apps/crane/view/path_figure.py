"""The path of the rope as a picture: of a scene before it runs, and of a run at its first and last frame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crane.assembly.layout import Layout
from crane.geometry.reeving import Wheel, turned
from crane.results.course import Course, nodes_of
from crane.scene.scene import Anchor, CraneScene, Drum, Sheave
from crane.view.rope_outline import outline
from tautline.view.figures.figure import COLOURS, QUIET, Axes, Figure, axes, equal_scale, label, save, shortened, styled
from tautline.view.figures.figure import outline as edged

ARC_POINTS, CIRCLE_POINTS = 24, 61
OUT_OF_PLANE = 0.02
"""Share of a path's size by which it may leave a plane that is shown alone."""
FAR = 4.0
"""Size of a path over that of the crane's fixed wheels from which these get a picture of their own."""
MOST_NAMES, MOST_LETTERS = 12, 24
"""Names in a picture, and letters of one: a longer one would leave the picture no room."""
APART = (0.2, 0.05)
"""Share of a picture's size across and up within which two names would be written over each other."""
NEAR_AXIS = 0.15
"""Share of the width of a picture within which a name that is centred there would stand over the axis."""
BEYOND = 0.3
"""Share of a path's height by which water or ground may lie below or above it and is shown with it."""
NAMES, UP = "xyz", 2
WATER, GROUND_COLOUR = "#56B4E9", "#8C6D46"


class Snapshot(NamedTuple):
    """A crane at one time.

    `rope` (k, 3) is its line, `wheels` are (centre, axis, radius, is a drum), `bodies` and `ends` (name, place); m.
    """

    rope: np.ndarray
    wheels: list[tuple[np.ndarray, np.ndarray, float, bool]]
    bodies: list[tuple[str, np.ndarray]]
    ends: list[tuple[str, np.ndarray]]
    words: str
    time: float


def of_scene(layout: Layout) -> Snapshot:
    """A scene as drawn, at t = 0."""
    scene, path, rows = layout.scene, layout.path, layout.wheels
    wheels = []
    for i, item in enumerate(scene.path):
        frame = int(rows.frame[i])
        columns = layout.entries[_number(layout, frame)].reshape(-1)[3:].reshape(3, 3) if frame else np.eye(3)
        wheels.append(Wheel(item.name, _place(layout, i), columns.T @ rows.axis[i], abs(float(rows.radius[i]))))
    discs = [
        (wheel.center, wheel.axis, wheel.radius, isinstance(item, Drum))
        for wheel, item in zip(wheels, scene.path, strict=True)
        if wheel.radius > 0.0
    ]
    bodies = [(body.name, np.array(body.position, float)) for body in scene.bodies]
    return Snapshot(outline(path, wheels), discs, bodies, _ends(scene, [w.center for w in wheels]), "as drawn", 0.0)


def _number(layout: Layout, place: int) -> int:
    return next(k for k, at in layout.frame.items() if at == place)


def _place(layout: Layout, i: int) -> np.ndarray:
    """Centre of an item at t = 0: the span that touches it tells, where what it rides on has not been placed yet."""
    path, k = layout.path, min(i, len(layout.path.spans) - 1)
    side = path.spans[k].x1 if k == i else path.spans[k].x2
    return path.tangents[k, 0 if k == i else 1] - side


def _ends(scene: CraneScene, center: Sequence[np.ndarray]) -> list[tuple[str, np.ndarray]]:
    return [(item.name, place) for item, place in zip(scene.path, center, strict=True) if isinstance(item, Anchor)]


def of_run(result: Any, course: Course, frame: int, words: str) -> Snapshot:
    """A run at one frame of a course; `frame` counts the frames of the result, and the course holds all of them."""
    scene, rho = course.scene, course.layout.wheels.radius
    position, node = result["position"][frame], nodes_of(scene)
    points: list[np.ndarray] = []
    for i, item in enumerate(scene.path):
        if i > 0:
            points += [*position[node[i - 1] + 1 : node[i]], course.touch(i, comes=True)[frame]]
        if isinstance(item, Sheave):
            k = next(j for j, other in enumerate(scene.sheaves) if other is item)
            center, axis = course.center[frame, i], np.sign(rho[i]) * course.axis[frame, i]
            x = points[-1] - center
            angles = np.linspace(0.0, float(result["wrap_angle"][frame, k]), ARC_POINTS)[1:-1]
            points += [center + turned(x, axis, float(angle)) for angle in angles]
        if i < len(scene.path) - 1:
            points.append(course.touch(i, comes=False)[frame])
    discs = [
        (course.center[frame, i], course.axis[frame, i], abs(float(rho[i])), isinstance(item, Drum))
        for i, item in enumerate(scene.path)
        if rho[i] != 0.0
    ]
    bodies = [(body.name, result["body_position"][frame, k]) for k, body in enumerate(scene.bodies)]
    ends = _ends(scene, list(course.center[frame]))
    return Snapshot(np.array(points), discs, bodies, ends, words, float(result.time[frame]))


def _circle(center: np.ndarray, axis: np.ndarray, radius: float) -> np.ndarray:
    """Points around a wheel, (k, 3)."""
    u = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    u = u / np.linalg.norm(u)
    angle = np.linspace(0.0, 2.0 * np.pi, CIRCLE_POINTS)[:, None]
    return center + radius * (np.cos(angle) * u + np.sin(angle) * np.cross(axis, u))


@styled
def path_figure(shots: Sequence[Snapshot], scene: CraneScene, title: str) -> Figure:
    """Elevation of the path of the rope, its plan where it leaves a plane, and the crane where the load is far below.

    Parameters
    ----------
    shots : sequence of Snapshot
        One, or a first and a last; the last stands out.
    """
    everything = np.concatenate([_all_points(shot) for shot in shots])
    size = np.ptp(everything, axis=0)
    across = 0 if size[0] >= size[1] else 1
    views: list[tuple[str, tuple[int, int], np.ndarray]] = [("Elevation", (across, 2), _to_levels(scene, everything))]
    fixed = [_circle(*disc[:3]) for _, disc in _fixed_discs(scene, shots[-1])]
    if fixed:
        head = np.concatenate(fixed)
        if FAR * max(float(np.ptp(head, axis=0).max()), 1e-9) < float(size.max()):
            views.append(("Crane", (across, 2), head))
    if size[1 - across] > OUT_OF_PLANE * float(size.max()):
        views.append(("Plan", (0, 1), everything))
    least = 0.12 * float(size.max())
    figure, plots = _frame(views, title)
    for plot, (name, plane, extent) in zip(plots[0], views, strict=True):
        narrow = 0.12 * float(np.ptp(extent, axis=0).max()) if name == "Crane" else least
        for k, shot in enumerate(shots):
            _draw(plot, shot, plane, last=k == len(shots) - 1)
        equal_scale(plot, extent[:, plane[0]], extent[:, plane[1]], narrow)
        if np.ptp(plot.get_xlim()) < 0.3 * np.ptp(plot.get_ylim()):
            # So narrow a picture has room for one number.
            left, right = plot.get_xlim()
            plot.set_xticks([0.0 if left < 0.0 < right else float(f"{0.5 * (left + right):.2g}")])
        if name != "Plan":
            _levels(plot, scene)
        _names(plot, scene, shots[-1], plane)
        plot.set_title(name)
        # What equal scales leave over stands below: above, a heading would be written over.
        plot.set_anchor("N")
        plot.set_xlabel(label(NAMES[plane[0]], "m"))
        plot.set_ylabel(label(NAMES[plane[1]], "m"))
    handles, texts = plots[0, 0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower center", ncols=len(texts))
    return figure


def _frame(views: Sequence[tuple[str, tuple[int, int], np.ndarray]], title: str) -> tuple[Figure, Any]:
    """A figure with plots as wide as their contents."""
    ratios = []
    for _, (a, b), extent in views:
        own = max(0.12 * float(np.ptp(extent, axis=0).max()), 1e-9)
        wide, high = (max(float(np.ptp(extent[:, c])), own) for c in (a, b))
        ratios.append(float(np.clip(wide / high, 0.4, 1.6)))
    height = 5.6
    width = 3.9 * sum(ratios) + 1.1 * len(views) + 0.6
    return axes(1, len(views), max(width, 4.5), height, title, width_ratios=ratios)


def _all_points(shot: Snapshot) -> np.ndarray:
    circles = [_circle(*disc[:3]) for disc in shot.wheels]
    return np.concatenate([shot.rope, *circles, *(place[None] for _, place in (*shot.bodies, *shot.ends))])


def _levels_of(scene: CraneScene) -> list[tuple[float, str, str]]:
    """Height m, colour and name of the water's surface and of the ground."""
    levels = [(scene.water.surface, WATER, "water")] if scene.water is not None else []
    return levels + ([(scene.ground.level, GROUND_COLOUR, "ground")] if scene.ground is not None else [])


def _to_levels(scene: CraneScene, points: np.ndarray) -> np.ndarray:
    """Points, and with them those levels that lie near: a load that is drawn above the water is lowered into it."""
    low, high = points[:, 2].min(), points[:, 2].max()
    near = BEYOND * (high - low)
    found = [level for level, _, _ in _levels_of(scene) if low - near <= level <= high + near]
    return np.concatenate([points, *([[*points[0, :2], level]] for level in found)])


def _fixed_discs(
    scene: CraneScene, shot: Snapshot
) -> list[tuple[Drum | Sheave, tuple[np.ndarray, np.ndarray, float, bool]]]:
    """Wheels that ride on no body."""
    wheels = [item for item in scene.path if isinstance(item, (Drum, Sheave))]
    pairs = zip(wheels, shot.wheels, strict=True)
    return [(item, disc) for item, disc in pairs if isinstance(item, Drum) or item.body is None]


def _draw(plot: Axes, shot: Snapshot, plane: tuple[int, int], last: bool) -> None:
    """Draw a snapshot: the last one in colours, others in grey behind it."""
    a, b = plane
    colour, ink = (COLOURS[0], "black") if last else (QUIET, QUIET)
    for center, axis, radius, drum in shot.wheels:
        circle = _circle(center, axis, radius)
        look: dict[str, Any] = {"fc": "#F4F4F4" if last else "none", "ec": ink, "lw": 1.6 if drum else 0.9}
        plot.fill(circle[:, a], circle[:, b], zorder=2.2, **look)
        plot.plot(center[a], center[b], color=ink, marker=".", ms=3, ls="", zorder=2.3)
    plot.plot(shot.rope[:, a], shot.rope[:, b], color=colour, lw=1.3, label=f"rope {shot.words}", zorder=2.4)
    for _, place in shot.bodies:
        # Behind the wheels: a hook block's sheaves stand in its middle.
        fill = COLOURS[1] if last else "white"
        plot.plot(place[a], place[b], marker="s", ms=8, ls="", mfc=fill, mec=ink, zorder=2.1)
    for _, place in shot.ends:
        plot.plot(place[a], place[b], marker="^", ms=6, ls="", mfc=ink, mec=ink)


def _levels(plot: Axes, scene: CraneScene) -> None:
    """Draw the water's surface and the ground, where they are in the picture."""
    bottom, top = plot.get_ylim()
    for level, colour, name in _levels_of(scene):
        if bottom < level < top:
            plot.axhline(level, color=colour, lw=1.2, zorder=0)
            # Beside the picture: inside it stands the rope.
            plot.text(1.02, level, name, transform=plot.get_yaxis_transform(), color=colour, va="center", fontsize=9)


class _Name(NamedTuple):
    """A name to be written in a picture: its place in the plane, m, and where from there it stands."""

    name: str
    at: np.ndarray
    stands: dict[str, Any]


BESIDE: dict[str, Any] = {"xytext": (8, 0), "va": "center"}
ABOVE: dict[str, Any] = {"xytext": (0, 3), "ha": "center", "va": "bottom"}
BELOW: dict[str, Any] = {"xytext": (0, -3), "ha": "center", "va": "top"}


def _names(plot: Axes, scene: CraneScene, shot: Snapshot, plane: tuple[int, int]) -> None:
    """Write names beside bodies, as long as there are few; and those of wheels and ends for which there is room."""
    if len(shot.bodies) > MOST_NAMES:
        return
    axes = list(plane)
    bodies = [_Name(name, place[axes], BESIDE) for name, place in shot.bodies]
    others = [_Name(name, place[axes], BESIDE) for name, place in shot.ends]
    if UP in plane:
        # From above wheels are lines, close together.
        others += [_of_wheel(item, disc, shot.rope, plane) for item, disc in _fixed_discs(scene, shot)]
    limits = np.array([plot.get_xlim(), plot.get_ylim()])
    written: list[np.ndarray] = []
    for k, one in enumerate([*bodies, *others]):
        inside = bool(np.all((one.at >= limits[:, 0]) & (one.at <= limits[:, 1])))
        close = any(bool(np.all(np.abs(one.at - at) < APART * np.ptp(limits, axis=1))) for at in written)
        if not inside or (k >= len(bodies) and (close or len(written) >= MOST_NAMES)):
            continue
        written.append(one.at)
        words = shortened(one.name, MOST_LETTERS)
        # Centred near the axis a name would be written over it.
        near_axis = "ha" in one.stands and one.at[0] - limits[0, 0] < NEAR_AXIS * np.ptp(limits[0])
        stands = one.stands | ({"ha": "left"} if near_axis else {})
        edged(plot.annotate(words, tuple(one.at), textcoords="offset points", fontsize=9, **stands))


def _of_wheel(
    item: Drum | Sheave, disc: tuple[np.ndarray, np.ndarray, float, bool], rope: np.ndarray, plane: tuple[int, int]
) -> _Name:
    """The name of a wheel, above it or below, where the rope does not go: outside of its turn, or behind a drum."""
    center, axis, radius, drum = disc
    a, b = plane
    touching = rope[np.linalg.norm(rope - center, axis=1) < 1.02 * radius]
    on_top = bool(touching.size == 0 or touching[:, b].mean() >= center[b])
    circle = _circle(center, axis, radius)[:, b]
    above = on_top != drum
    return _Name(item.name, np.array([center[a], circle.max() if above else circle.min()]), ABOVE if above else BELOW)


def draw_scene_figure(layout: Layout, path: Path) -> Path:
    """Draw a scene as it stands at t = 0 into a file; raises ResultError if it cannot be written."""
    scene = layout.scene
    name = scene.document.path.stem if scene.document is not None else "scene"
    return save(path_figure([of_scene(layout)], scene, scene.title or name), path)
