"""An appearance in a PyVista plotter: built once, moved from frame to frame.

What changes with time is written into arrays that the plotter already holds, so a film costs little more than its
pictures' pixels.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from tautline.scene.values.systems import length_unit
from tautline.view.figures.figure import round_numbers, scale_in
from tautline.view.space.appearance import ARROW, Appearance, Arrows, Line, Solid
from tautline.view.space.camera import ANGLE, CLOSE, Aim, aim, fitted
from tautline.view.space.colours import Shading, shading
from tautline.view.space.graphics import graphics, new_plotter
from tautline.view.space.mesh import turned_about
from tautline.view.space.scales import grid_pitch, scales
from tautline.view.space.surroundings import FLOOR_NAME, SHADED, Surface, ground_colour, shadow, sun, surfaces
from tautline.view.space.tube import rings, skin

SIZE = (1280, 720)
FONT = str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf")
INK = "#202020"
SIDES, ROUND_SIDES = 6, 32
THINNEST = 0.002
"""Least radius of a line as a share of the picture's size: two or three pixels thick."""
WIDE = 0.006
"""Radius of a line as a share of the picture's size from which its sides would show."""
LEGEND = 0.13
"""Share of the width that the legend takes."""
FOOT = 0.04
"""Share of half the height by which everything is moved up, off the clock and the notes."""
HEADROOM = 1.2
"""Room around what is seen."""
LOOKED_AT = 24
"""Frames, about, that the camera is placed for."""
ZENITH, HAZE, PAPER = "#B9D1E8", "#F1F4F6", "#FFFFFF"
"""Background at the top and at the bottom of a picture; and at the top of one that is below ground."""
LIFT = 5.0e-4
"""Height of a shadow above what it falls on, over the picture's size, so that it is seen."""
GRID, PIECES = 30, 12
"""Lines of a grid to either side of its middle, and pieces of each, which fade."""
NEAREST = 1e-3
"""Distance of the nearest thing that is shown over that of the farthest, without zoom."""
NOTE_WIDTH = 110
"""Letters in a line of notes."""
SHARP = 30.0
"""Angle at which faces meet in an edge, degrees."""


class Stage:
    """A plotter with everything in it.

    Parameters
    ----------
    appearance : Appearance
    colour : str or None
        Quantity that colours the lines, ``none`` for plain ones, None for the first.
    radius : float or None
        Factor on the true thickness of lines; None for true, but thick enough to see.
    camera : str
        See `tautline.view.space.camera.aim`.
    size : tuple of int
        Of the picture, pixels.
    window : bool
        Whether it is to be a window on a screen.
    smooth : bool
        Whether edges are smoothed by several samples a pixel; by software that costs more than the picture.

    Attributes
    ----------
    plotter : pyvista.Plotter
    shading : Shading or None
        What the legend shows.
    frame : int
        The one that is shown.
    size, seen : float
        Extent of everything, and of what the picture shows of it, m.

    Raises
    ------
    ResultError
        If there is no such quantity or view, or nothing to draw with.
    """

    def __init__(
        self,
        appearance: Appearance,
        colour: str | None = None,
        radius: float | None = None,
        camera: str = "",
        size: tuple[int, int] = SIZE,
        window: bool = False,
        smooth: bool = True,
    ) -> None:
        self.appearance, self.radius = appearance, radius
        self.aim: Aim = aim(camera, appearance.eye)
        self.shading: Shading | None = shading(appearance, colour)
        self.scale = min(size[0] / SIZE[0], size[1] / SIZE[1])
        self.pyvista = graphics()
        self.plotter = new_plotter(off_screen=not window, window_size=list(size), lighting="none")
        self._light()
        if not smooth:
            self.plotter.render_window.SetMultiSamples(0)
        frames = len(appearance.time)
        looked_at = np.unique(np.linspace(0, frames - 1, min(frames, LOOKED_AT)).round().astype(int))
        extent = appearance.extent([int(frame) for frame in looked_at])
        self.rulers, self.surfaces = scales(appearance, extent), surfaces(appearance, extent)
        self._extent = np.concatenate([extent, *(one.points for one in self.rulers)])
        self.size = max(float(np.ptp(self._extent, axis=0).max()), 1e-6)
        self.frame = 0
        if self.aim.zoom == CLOSE:
            self.aim = self.aim._replace(zoom=self._close())
        self.seen = self.size / self.aim.zoom
        self._followed = appearance.place_of(self.aim.follows) if self.aim.follows else None
        self._moves: list[Callable[[int], None]] = []
        base = appearance.base(extent)
        self._flat = None if base is None else shadow(self.sun, base + LIFT * self.size)
        self._shade = next((one.level.colour for one in self.surfaces if one.level.height == base), "")
        for add, parts in (
            (self._line, appearance.lines), (self._solid, appearance.solids), (self._arrows, appearance.arrows),
            (self._surface, self.surfaces), (self._label, appearance.labels), (self._ruler, self.rulers),
        ):  # fmt: skip
            for part in parts:
                add(part)  # type: ignore[operator]
        self._words()
        self.look()
        self.show(0)

    def _light(self) -> None:
        """Sky behind everything; a sun that stands still, and a little light from the eye."""
        self.plotter.set_background(HAZE, top=ZENITH if self.appearance.floor or self.appearance.levels else PAPER)
        # VTK strews noise over a gradient, which makes a picture five times as large.
        self.plotter.renderer.SetDitherGradient(False)
        self.sun = sun(self.appearance.eye)
        key = self.pyvista.Light(light_type="scene light", intensity=0.78)
        key.positional, key.position, key.focal_point = False, tuple(self.sun), (0.0, 0.0, 0.0)
        self.plotter.add_light(key)
        self.plotter.add_light(self.pyvista.Light(light_type="headlight", intensity=0.5))

    def show(self, frame: int) -> None:
        """Move everything to a frame; nothing is rendered."""
        self.frame = int(np.clip(frame, 0, len(self.appearance.time) - 1))
        for move in self._moves:
            move(self.frame)
        if self._followed is not None:
            self._go_along(self._followed(self.frame))

    def _close(self) -> float:
        """Zoom at which what is followed takes about a seventh of the picture."""
        for solid in self.appearance.solids:
            if solid.name == self.aim.follows or solid.name.endswith(f" {self.aim.follows}"):
                return max(1.0, self.size / (7.0 * max(float(np.ptp(solid.points, axis=0).max()), 1e-3 * self.size)))
        return 8.0

    def _go_along(self, place: np.ndarray) -> None:
        """Move the camera with what it follows; whoever has turned it keeps the direction."""
        camera = self.plotter.camera
        shift = place - np.array(camera.focal_point)
        camera.position, camera.focal_point = tuple(np.array(camera.position) + shift), tuple(place)

    def look(self) -> None:
        """Put the camera where it began."""
        width, height = self.plotter.window_size
        side = LEGEND if self.shading is not None else 0.0
        place = fitted(self._extent, self.aim, (1.0 - side) * width / height)
        camera = self.plotter.camera
        camera.position = tuple(place.focus + HEADROOM * (place.eye - place.focus))
        camera.focal_point, camera.up = tuple(place.focus), tuple(place.up)
        camera.view_angle = ANGLE
        # The legend stands at the right, clock and notes at the foot: the middle of the rest is to the left, and above.
        camera.SetWindowCenter(side, -FOOT)
        # Levels reach far, so the nearest thing that is shown would be far away too when seen from close by.
        self.plotter.renderer.SetNearClippingPlaneTolerance(float(np.clip(NEAREST / self.aim.zoom, 1e-5, NEAREST)))
        self.plotter.renderer.ResetCameraClippingRange()

    def picture(self) -> np.ndarray:
        """Render, and return the picture, (height, width, 3) uint8."""
        self.plotter.render()
        return np.ascontiguousarray(self.plotter.screenshot(return_img=True))

    def close(self) -> None:
        """Free the plotter."""
        self.plotter.close()

    def thickness(self, line: Line) -> np.ndarray:
        """Radius that a line is drawn with, (m,) m."""
        true = np.broadcast_to(np.asarray(line.radius, float), len(line.points(0)))
        if not line.thick:
            return np.array(true)
        if not true.any():
            # Of a line whose thickness nobody knows, the visible one is what a factor is taken of.
            return np.full(len(true), THINNEST * self.seen * (1.0 if self.radius is None else self.radius))
        return np.maximum(true, THINNEST * self.seen) if self.radius is None else self.radius * true

    def _line(self, line: Line) -> None:
        radius = self.thickness(line)
        sides = ROUND_SIDES if radius.max() > WIDE * self.seen else SIDES
        points, normals = rings(line.points(0), radius, sides)
        mesh = self._mesh(points, skin(len(radius), sides, closed=not line.hollow), normals)
        quantity = None
        if self.shading is not None:
            quantity = next((one for one in line.quantities if one.name == self.shading.name), None)
        look: dict[str, Any] = {"color": line.colour, "opacity": line.opacity, "ambient": 0.4, "diffuse": 0.75}
        if quantity is not None and self.shading is not None:
            mesh.point_data["value"] = np.zeros(len(points))
            look |= {"scalars": "value", "cmap": self._colours(), "clim": (self.shading.low, self.shading.high)}
        actor = self.plotter.add_mesh(mesh, show_scalar_bar=False, reset_camera=False, **look)
        actor.prop.interpolation = "phong" if sides == ROUND_SIDES else "gouraud"
        if line.hollow:
            actor.prop.culling = "front"
        shade, colours = self.shading, None if quantity is None else mesh.point_data["value"]
        dark = self._shadow(mesh) if line.thick and not line.hollow else None

        def move(frame: int) -> None:
            at, out = rings(line.points(frame), radius, sides)
            mesh.points[:] = at
            mesh.point_data["Normals"][:] = out
            if quantity is not None and shade is not None and colours is not None:
                colours[:] = np.repeat(quantity.values(frame) / shade.factor, sides)
            mesh.GetPoints().Modified()
            mesh.Modified()
            if dark is not None and self._flat is not None:
                dark.points[:] = at @ self._flat[:3, :3].T + self._flat[:3, 3]
                dark.GetPoints().Modified()
                dark.Modified()

        self._moves.append(move)

    def _triangulated(self, points: np.ndarray, triangles: np.ndarray) -> Any:
        """A surface of triangles (n, 3). PyVista 0.45 forgets the memory of faces that are given without their size."""
        sized = np.column_stack((np.full(len(triangles), 3), triangles))
        return self.pyvista.PolyData(points, sized.ravel())

    def _shadow(self, mesh: Any, pose: Any = None) -> Any:
        """The shadow of a mesh on what everything stands on; a mesh of its own where no pose moves it."""
        if self._flat is None or not self._shade:
            return None
        flat = self._flat
        own = self.pyvista.PolyData(np.array(mesh.points), mesh.faces)
        colour = tuple(SHADED * part for part in self.pyvista.Color(ground_colour(self._shade)).float_rgb)
        actor = self.plotter.add_mesh(own, color=colour, lighting=False, reset_camera=False, pickable=False)
        if pose is not None:
            self._moves.append(lambda frame: setattr(actor, "user_matrix", flat @ pose(frame)))
        return own

    def _solid(self, solid: Solid) -> None:
        mesh = self._triangulated(np.asarray(solid.points, float), solid.triangles)
        if solid.smooth:
            mesh = mesh.compute_normals(feature_angle=SHARP, split_vertices=True, consistent_normals=False)
        look = {"color": solid.colour, "opacity": solid.opacity, "ambient": 0.3, "specular": 0.15}
        actor = self.plotter.add_mesh(mesh, reset_camera=False, **look)
        pose = solid.pose
        if solid.opacity > 0.3:
            self._shadow(mesh, pose or (lambda frame: np.eye(4)))
        if pose is not None:
            self._moves.append(lambda frame: setattr(actor, "user_matrix", pose(frame)))

    def _arrows(self, arrows: Arrows) -> None:
        shape, triangles = turned_about([(0.0, 0.0), (0.02, 0.0), (0.02, 0.72), (0.07, 0.72), (0.0, 1.0)], SIDES)
        if arrows.pushes:
            shape = shape - [0.0, 0.0, 1.0]
        count, corners = len(arrows.points(0)), len(shape)
        if count == 0 or not arrows.longest > 0.0:
            return
        faces = (triangles + corners * np.arange(count)[:, None, None]).reshape(-1, 3)
        mesh = self._mesh(np.zeros((count * corners, 3)), faces)
        look = {"color": arrows.colour, "ambient": 0.3, "smooth_shading": False}
        self.plotter.add_mesh(mesh, reset_camera=False, **look)
        factor = ARROW * self.seen / arrows.longest

        def move(frame: int) -> None:
            vectors = np.asarray(arrows.vectors(frame), float)
            length = np.linalg.norm(vectors, axis=1)
            z = np.where(length[:, None] > 0.0, vectors / np.maximum(length, 1e-300)[:, None], [0.0, 0.0, 1.0])
            u = np.cross(np.eye(3)[np.argmin(np.abs(z), axis=1)], z)
            u /= np.linalg.norm(u, axis=1, keepdims=True)
            axes = np.stack([u, np.cross(z, u), z], axis=1) * (factor * length)[:, None, None]
            at = np.einsum("pj,kjc->kpc", shape, axes) + arrows.points(frame)[:, None]
            mesh.points[:] = at.reshape(-1, 3)
            mesh.GetPoints().Modified()
            mesh.Modified()

        self._moves.append(move)

    def _surface(self, surface: Surface) -> None:
        """Floor, ground or water, with its waves."""
        level = surface.level
        mesh = self._mesh(surface.points, surface.triangles)
        colour = level.colour if level.clear else ground_colour(level.colour)
        rgba = np.empty((len(surface.points), 4), np.uint8)
        rgba[:, :3] = [round(255 * part) for part in self.pyvista.Color(colour).float_rgb]
        rgba[:, 3] = np.rint(255 * level.opacity * np.minimum(2.5 * surface.fade, 1.0))
        mesh.point_data["rgba"] = rgba
        self.plotter.add_mesh(
            mesh, scalars="rgba", rgba=True, lighting=False, reset_camera=False, pickable=False
        )  # fmt: skip
        if not level.clear:
            self._grid(level.height)
        if level.waves is None:
            return
        still = rgba[:, :3].astype(float)

        def move(frame: int) -> None:
            heights = surface.heights(float(self.appearance.time[frame]))
            mesh.points[:, 2] = heights
            bright = still * surface.light(heights, self.sun)[:, None]
            mesh.point_data["rgba"][:, :3] = np.minimum(bright, 255.0).astype(np.uint8)
            mesh.GetPoints().Modified()
            mesh.Modified()

        self._moves.append(move)

    def _grid(self, height: float) -> None:
        """Lines of a round pitch on a level; they fade as it does."""
        metres, _ = length_unit(self.appearance.units)
        pitch = grid_pitch(self.size / metres) * metres
        middle = np.round(0.5 * (self._extent.min(axis=0) + self._extent.max(axis=0)) / pitch)[:2] * pitch
        line, along = pitch * np.arange(-GRID, GRID + 1), pitch * GRID * np.linspace(-1.0, 1.0, PIECES + 1)
        b, a = np.meshgrid(np.repeat(along, 2)[1:-1], line)
        rows = np.stack([a.ravel(), b.ravel()], axis=-1)
        ends = np.concatenate([rows, rows[:, ::-1]])
        share = np.clip(1.0 - np.hypot(*ends.T) / (GRID * pitch), 0.0, 1.0)
        points = np.column_stack([ends + middle, np.full(len(ends), height + 0.5 * LIFT * self.size)])
        cells = np.column_stack([np.full(len(ends) // 2, 2), np.arange(len(ends)).reshape(-1, 2)])
        mesh = self.pyvista.PolyData(points, lines=cells.ravel())
        mesh.point_data["rgba"] = np.column_stack([
            np.broadcast_to(np.array([90, 100, 108]), (len(ends), 3)), np.rint(70 * share)
        ]).astype(np.uint8)  # fmt: skip
        self.plotter.add_mesh(
            mesh, scalars="rgba", rgba=True, lighting=False, line_width=self.scale, reset_camera=False, pickable=False
        )

    def _label(self, label: Any) -> None:
        place = self._words_at(label.text, label.place(0), (10, 0))
        self._moves.append(lambda frame: place.SetValue(*label.place(frame)))

    def _ruler(self, ruler: Any) -> None:
        points = np.asarray(ruler.points, float)
        if len(points) > 1:
            self.plotter.add_mesh(
                self.pyvista.lines_from_points(points), color=INK, line_width=2 * self.scale, reset_camera=False
            )
        self.plotter.add_mesh(
            self.pyvista.PolyData(points), color=INK, point_size=7 * self.scale, render_points_as_spheres=True,
            reset_camera=False,
        )  # fmt: skip
        for k, (point, number) in enumerate(zip(points, ruler.numbers, strict=True)):
            last = f" {ruler.unit}" if k == len(points) - 1 else ""
            self._words_at(f"{number:g}{last}", point, (-10, 0), right=True)
        self._words_at(ruler.text, points[int(np.argmax(points[:, 2]))], (0, 20), right=True)

    def _words_at(self, text: str, place: Any, offset: tuple[int, int], right: bool = False) -> Any:
        """Words beside a point, in front of everything; returns the vtkCoordinate of the point."""
        from vtkmodules.vtkRenderingCore import vtkCoordinate, vtkTextActor

        # VTK has an actor for words in space; it draws its letters anew whenever it moves, which takes longer than the
        # rest of a picture.
        actor, point = vtkTextActor(), vtkCoordinate()
        point.SetCoordinateSystemToWorld()
        point.SetValue(*place)
        beside = actor.GetPositionCoordinate()
        beside.SetCoordinateSystemToDisplay()
        beside.SetReferenceCoordinate(point)
        beside.SetValue(*(round(self.scale * pixels) for pixels in offset), 0.0)
        actor.SetInput(text)
        actor.SetTextScaleModeToNone()
        self._lettering(actor.GetTextProperty(), 13)
        if right:
            actor.GetTextProperty().SetJustificationToRight()
        actor.GetTextProperty().SetVerticalJustificationToCentered()
        self.plotter.add_actor(actor, reset_camera=False, pickable=False)
        return point

    def _lettering(self, look: Any, points: int) -> None:
        from vtkmodules.vtkRenderingCore import vtkTextProperty

        look.SetFontFamily(4)  # VTK_FONT_FILE
        look.SetFontFile(FONT)
        look.SetFontSize(round(self.scale * points))
        look.SetColor(0.125, 0.125, 0.125)
        assert isinstance(look, vtkTextProperty)

    def _words(self) -> None:
        """Title, time, notes and legend."""
        title = self.plotter.add_text(self.appearance.title, position=(0.015, 0.96), viewport=True, font_size=1)
        self._lettering(title.prop, 17)
        clock = self.plotter.add_text(" ", position=(0.015, 0.025), viewport=True, font_size=1)
        self._lettering(clock.prop, 15)
        digits = _digits(self.appearance.time)
        self._moves.append(lambda frame: setattr(clock, "input", f"t = {self.appearance.time[frame]:.{digits}f} s"))
        notes = [*self._grid_notes(), *self.appearance.remarks, *self._thickness_notes(), *self._arrow_notes()]
        if notes:
            words = self.plotter.add_text(_wrapped(notes), position=(0.16, 0.028), viewport=True, font_size=1)
            self._lettering(words.prop, 12)
        if self.shading is not None:
            self._legend(self.shading)

    def _grid_notes(self) -> list[str]:
        """The pitch of the grid, and whether lengths are true."""
        true = [] if self.appearance.enlarged else ["lengths and motions 1:1"]
        metres, unit = length_unit(self.appearance.units)
        grids = [f"grid of {grid_pitch(self.size / metres):g} {unit}" for one in self.surfaces if not one.level.clear]
        floor = (
            " on a floor that is not in the scene" if any(one.level.name == FLOOR_NAME for one in self.surfaces) else ""
        )
        return true + [text + floor for text in grids[:1]]

    def _thickness_notes(self) -> list[str]:
        """How much thicker than it is each line is drawn; lines of one factor share a note."""
        of: dict[str, list[str]] = {}
        for line in self.appearance.lines:
            true, drawn = np.max(line.radius), float(self.thickness(line).max())
            if true > 0.0 and line.thick and drawn > 1.05 * true:
                factor = drawn / true
                of.setdefault(f"{factor:{'.0f' if factor >= 10.0 else '.2g'}}", []).append(line.name)
        return [
            f"{' and '.join(names) if len(names) < 3 else 'lines'} drawn {factor} times as thick"
            for factor, names in of.items()
        ]

    def _arrow_notes(self) -> list[str]:
        """What the longest arrow of each kind stands for."""
        said = []
        for arrows in self.appearance.arrows:
            factor, unit = scale_in(self.appearance.units, [np.array([arrows.longest])], arrows.unit)
            if arrows.longest > 0.0:
                said.append(f"{arrows.text}: longest arrow {arrows.longest / factor:.3g} {unit}".rstrip())
        return said

    def _legend(self, shade: Shading) -> None:
        bar = self.plotter.add_scalar_bar(
            " ", mapper=self._legend_mapper(shade), vertical=True, n_labels=0, fmt="%g",
            position_x=1.0 - LEGEND + 0.035, position_y=0.16, width=0.02, height=0.66, unconstrained_font_size=True,
        )  # fmt: skip
        bar.SetBarRatio(1.0)
        bar.SetTitle("")
        left, bottom, high = 1.0 - LEGEND + 0.035, 0.16, 0.66
        for number in round_numbers(shade.low, shade.high, 6):
            share = (number - shade.low) / (shade.high - shade.low)
            place = (left + 0.026, bottom + high * share)
            words = self.plotter.add_text(f"{number:g}", position=place, viewport=True, font_size=1)
            self._lettering(words.prop, 13)
            words.prop.SetVerticalJustificationToCentered()
        name, _, unit = shade.title.partition(" [")
        text = f"{name}\n[{unit}" if unit and len(shade.title) > 16 else shade.title
        words = self.plotter.add_text(text, position=(1.0 - 0.5 * LEGEND, 0.86), viewport=True, font_size=1)
        self._lettering(words.prop, 14)
        words.prop.SetJustificationToCentered()
        words.prop.SetVerticalJustificationToBottom()

    def _legend_mapper(self, shade: Shading) -> Any:
        table = self.pyvista.LookupTable(cmap=self._colours(), scalar_range=(shade.low, shade.high))
        mapper = self.pyvista.DataSetMapper(self.pyvista.PolyData(np.zeros((1, 3))))
        mapper.lookup_table = table
        mapper.scalar_range = (shade.low, shade.high)
        return mapper

    def _colours(self) -> Any:
        from matplotlib.colors import ListedColormap

        assert self.shading is not None
        return ListedColormap(self.shading.table / 255.0)

    def _mesh(self, points: np.ndarray, triangles: np.ndarray, normals: np.ndarray | None = None) -> Any:
        mesh = self._triangulated(np.asarray(points, np.float32), triangles)
        if normals is not None:
            mesh.point_data["Normals"] = normals.astype(np.float32)
            mesh.point_data.active_normals_name = "Normals"
        return mesh


def _wrapped(notes: list[str]) -> str:
    """Notes one after the other, in lines that fit beside the clock."""
    return "\n".join(textwrap.wrap("; ".join(notes), NOTE_WIDTH))


def _digits(time: np.ndarray) -> int:
    """Digits after the point that tell the times of frames apart."""
    step = float(np.diff(time).min()) if len(time) > 1 else 1.0
    return next((k for k in range(1, 6) if np.abs(np.round(time, k) - time).max() < 0.02 * step), 6)
