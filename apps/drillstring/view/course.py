"""Hole and string of a result: the well's curve, diameters and sections, and how the string runs between its lumps.

A result holds all of it. One that was written without the well's frame and the diameters is read with the scene that it
carries; if that cannot be read either, as when its survey is not at hand, they are told from what is left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from drillstring.model.prepared import prepared, well_of
from drillstring.scene.scene import DrillstringScene
from drillstring.well.sections import direction_angles
from drillstring.well.wellbore import Wellbore, WellboreError, from_survey
from tautline.results.errors import ResultError
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

PIPE = 0.127
"""Outer diameter, m, of a string of which none is known: the most common drill pipe's, 5 in."""

ROOM = 1.6
"""Diameter of the hole that a string in free space would lie in, over its own."""
UPRIGHT = np.radians(60.0)
"""Inclination at the table up to which there is a derrick above it."""


@dataclass(frozen=True, eq=False)
class Course:
    """Hole and string at m frames and n + 1 lumps.

    Attributes
    ----------
    well : Wellbore
    stations : (k,) array
        Measured depths of the points that the hole's path is stored at, m.
    hole : float or None
        Diameter of the hole, m; None in free space, and where nobody knows it.
    rest : (n + 1,) array
        Unstretched measured depth of the lumps, m, rising.
    depth : (m, n + 1) array
        Measured depth of the lumps, m.
    lateral : (m, n + 1, 2) array
        Their offset on m1 and m2, m.
    diameter : (n,) array
        Outer diameter of the links, m.
    section : (n,) array of str
        Section of each link.
    added : int
        Lumps at the upper end that the result has not: 1 where its first link hangs from the rotary table.
    notes : tuple of str
        What is not the result's own.
    """

    well: Wellbore
    stations: np.ndarray
    hole: float | None
    rest: np.ndarray
    depth: np.ndarray
    lateral: np.ndarray
    diameter: np.ndarray
    section: np.ndarray
    added: int
    notes: tuple[str, ...]

    @property
    def tributary(self) -> np.ndarray:
        """Unstretched length that belongs to each lump, (n + 1,) m."""
        half = 0.5 * np.diff(self.rest)
        return np.append(half, 0.0) + np.append(0.0, half)

    @property
    def path(self) -> np.ndarray:
        """Measured depths to draw the hole at, m: of its stations, and of the bit where that goes deeper."""
        lowest = float(self.depth.max())
        return np.append(self.stations, lowest) if lowest > self.stations[-1] else self.stations

    @property
    def deepest(self) -> float:
        """Largest measured depth of string and hole, m."""
        return float(self.depth.max() if self.hole is None else self.path[-1])

    @property
    def widest(self) -> float:
        """Largest distance from the hole's axis of anything, m; in free space there is some room about the pipe."""
        if self.hole is not None:
            return 0.5 * self.hole
        pipe = 0.5 * float(self.diameter.max())
        return max(ROOM * pipe, float(np.hypot(self.lateral[..., 0], self.lateral[..., 1]).max()) + pipe)

    @property
    def upright(self) -> bool:
        """Whether the string hangs at its upper end, so that there is a floor with a derrick."""
        return bool(self.well.inclination(0.0) < UPRIGHT)

    def downwards(self, depth: np.ndarray) -> np.ndarray:
        """Share of m1 and m2 that points down, (k, 2), at measured depths (k,)."""
        m1, m2, _ = self.well.frame(depth)
        return np.column_stack([m1[:, 2], m2[:, 2]])

    def of_lumps(self, values: np.ndarray) -> np.ndarray:
        """Values (m, lumps) of the result at all lumps, (m, n + 1); an added one has those of the first."""
        return np.concatenate([values[:, :1]] * self.added + [values], axis=1)

    def curvature(self) -> np.ndarray:
        """Curvature of the string at its lumps, (m, n + 1) 1/m: the model's own, and the hole's at both ends.

        The angle between neighbouring links over half their lengths; in a curved hole the hole's own turning comes to
        the change of the links' directions in its frame (Bergou et al., "Discrete elastic rods", 2008).
        """
        u, v = self.lateral[..., 0], self.lateral[..., 1]
        turn = np.stack(self.well.turning(self.depth), axis=-1)
        inside = 0.5 * np.sum(np.diff(turn, axis=1) * (self.lateral[:, 1:] + self.lateral[:, :-1]), axis=-1)
        way = np.stack([np.diff(self.depth, axis=1) - inside, np.diff(u, axis=1), np.diff(v, axis=1)], axis=-1)
        way /= np.linalg.norm(way, axis=-1, keepdims=True)
        bend = np.diff(way, axis=1)
        bend[..., 1:] += 0.5 * (turn[:, 2:] - turn[:, :-2])
        found = np.hypot(*self.well.curvature(self.depth))
        found[:, 1:-1] = np.linalg.norm(bend, axis=-1) / self.tributary[1:-1]
        return found

    def slopes(self) -> np.ndarray:
        """Rates of measured depth and offsets by `rest` at the lumps, (m, n + 1, 3), of smooth curves through them.

        They are those of the cubic spline without bending at its ends. Offsets inside a hole take the cubic that does
        not swing beyond its points, F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984): two lumps that
        lie on the wall shall not push the pipe between them through it.
        """
        if self.hole is None:
            across = CubicSpline(self.rest, self.lateral, axis=1, bc_type="natural").derivative()
        else:
            across = PchipInterpolator(self.rest, self.lateral, axis=1).derivative()
        # What a lump moved along the hole is small beside its depth, and loses nothing beside it.
        along = CubicSpline(self.rest, self.depth - self.rest, axis=1, bc_type="natural").derivative()
        return np.concatenate([1.0 + along(self.rest)[..., None], across(self.rest)], axis=-1)


def course_of(result: Any) -> Course:
    """Read the course of a result.

    Raises
    ------
    ResultError
        If it has neither the lumps' positions nor their measured depths.
    """
    position, depth = result["position"], result["measured_depth"]
    links = result["tension"].shape[1]
    added = int(depth.shape[1] == links)
    if added:
        depth = np.concatenate([np.minimum(0.0, depth[:, :1]), depth], axis=1)
    rest = result["unstretched_depth"] if "unstretched_depth" in result else depth[0]
    notes: list[str] = []
    well, stations, own = _well(result, position, notes)
    if own and "lateral_displacement" in result:
        lateral = result["lateral_displacement"]
    else:
        m1, m2, _ = well.frame(depth[:, added:])
        off = position - well.position(depth[:, added:])
        lateral = np.stack([np.sum(off * m1, axis=-1), np.sum(off * m2, axis=-1)], axis=-1)
    if added:
        lateral = np.concatenate([np.zeros_like(lateral[:, :1]), lateral], axis=1)
    diameter, section, hole = _pipe(result, links, notes)
    return Course(well, stations, hole, rest, depth, lateral, diameter, section, added, tuple(notes))


def scene_of(result: Any) -> DrillstringScene | None:
    """Read the scene that a result carries; None if it has none that can be read."""
    try:
        text = str(result.attributes.get("scene", ""))
        return validate(DrillstringScene, Document.parse(text, result.path or Path("result")))
    except SceneError:
        return None


def _well(result: Any, position: np.ndarray, notes: list[str]) -> tuple[Wellbore, np.ndarray, bool]:
    """The well, the stations of its stored path, and whether offsets are from it, and not from the string itself."""
    stations = result["well_depth"] if "well_depth" in result else None
    if "well_side" in result and stations is not None:
        side, way = result["well_side"], result["well_direction"]
        k1, k2 = np.ascontiguousarray(result["well_curvature"].T)
        phi1, phi2 = (np.concatenate([[0.0], np.cumsum(k[:-1] * np.diff(stations))]) for k in (k1, k2))
        path = result["well_position"]
        well = Wellbore(stations, k1[:-1], k2[:-1], phi1, phi2, path, side, np.cross(way, side), way)
        return well, stations, True
    scene = scene_of(result)
    try:
        drilled = None if scene is None else well_of(scene)
    except SceneError:
        drilled = None
    if drilled is not None:
        return drilled, drilled.md if stations is None else stations, True
    if "well_position" in result:
        notes.append("well interpolated: its frame is not in the result")
        return *_through(result, result["well_position"], stations), True
    notes.append("well as the string lies: it is not in the result")
    return *_through(result, position[0], result["measured_depth"][0]), False


def _through(result: Any, points: np.ndarray, depth: np.ndarray | None) -> tuple[Wellbore, np.ndarray]:
    """A well from the rotary table through points (k, 3), with a spline's directions there, and its stations."""
    if depth is None:
        depth = np.cumsum(np.linalg.norm(np.diff(points, axis=0, prepend=np.zeros((1, 3))), axis=1))
    below = depth > 0.0
    stations, path = np.append(0.0, depth[below]), np.concatenate([np.zeros((1, 3)), points[below]])
    try:
        way = CubicSpline(stations, path).derivative()(stations)
        # Where arcs with these directions would miss the next point a little, they begin anew there.
        return replace(from_survey(stations, *direction_angles(way)), positions=path), stations
    except (ValueError, WellboreError):
        cause = "its well path has no length, points that coincide, or a sharp bend"
        raise ResultError(result.path or "result", cause, "run the scene again") from None


def _pipe(result: Any, links: int, notes: list[str]) -> tuple[np.ndarray, np.ndarray, float | None]:
    """Outer diameter and section of each link, and the hole's diameter, None in free space."""
    if "outer_diameter" in result:
        hole = float(result["hole_diameter"][0]) if "hole_diameter" in result else None
        names = result["section"] if "section" in result else np.full(links, "string")
        # A link that hangs from the rotary table is as thick as the one below it.
        outer = result["outer_diameter"]
        return np.pad(outer, (max(links - outer.size, 0), 0), mode="edge"), names, hole
    scene = scene_of(result)
    try:
        lumps = None if scene is None else prepared(scene).lumps
    except SceneError:
        lumps = None
    if scene is not None and lumps is not None and lumps.length.size == links:
        names = np.array([lumps.tubes[k].name for k in lumps.section])
        return lumps.of_links(lambda tube: tube.od), names, None if scene.well.wall is None else scene.well.diameter
    notes.append(f"pipe taken as {PIPE:g} m, no hole: diameters are not in the result")
    return np.full(links, PIPE), np.full(links, "string"), None
