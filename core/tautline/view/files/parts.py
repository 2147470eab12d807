"""An appearance as parts for ParaView: polygons and lines with named arrays, one part to a block, frame by frame."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

from tautline.view.space.appearance import Appearance, Arrows, Level, Line, Ruler, Solid, placed

BEYOND = 0.75
"""Of the extent of all else, that a level plane goes on to either side of its middle."""


@dataclass(frozen=True)
class Part:
    """What ParaView shows and hides as one block.

    Attributes
    ----------
    name : str
    moves : bool
        Whether it is not the same at every frame.
    data : callable
        Frame -> vtkPolyData, the same object every time.
    state : callable or None
        Frame -> bytes, that are equal at two frames if the part is; None where it is not worth the asking.
    """

    name: str
    moves: bool
    data: Callable[[int], vtkPolyData]
    state: Callable[[int], bytes] | None = None


def parts_of(appearance: Appearance) -> list[Part]:
    """Parts of an appearance: lines, solids, arrows, levels and rulers; things that differ by a number are one part."""
    frames = len(appearance.time)
    found = [_lines(name, some, frames) for name, some in _named(appearance.lines)]
    found += [_solids(name, some) for name, some in _named(appearance.solids)]
    found += [_arrows(arrows) for arrows in appearance.arrows]
    if appearance.levels:
        extent = appearance.extent(sorted({0, frames // 2, frames - 1}))
        found += [_level(level, extent) for level in appearance.levels]
    found += [_ruler(ruler) for ruler in appearance.rulers]
    return found


def labelled(name: str, unit: str) -> str:
    """Name of an array with its unit: ``axial_force [N]``."""
    return f"{name} [{unit}]" if unit else name


def add_texts(data: vtkPolyData, name: str, texts: Sequence[str]) -> None:
    """Add words to a part's field data."""
    array = vtkStringArray()
    array.SetName(name)
    for text in texts:
        array.InsertNextValue(text)
    data.GetFieldData().AddArray(array)


def add_array(data: Any, name: str, values: np.ndarray) -> None:
    """Add an array, (n,) or (n, components), to point, cell or field data, in place of one of that name."""
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    data.AddArray(array)


def _named(things: Sequence[Any]) -> list[tuple[str, list[Any]]]:
    """Things by their name without a number at its end, in the order of the first of each."""
    found: dict[str, list[Any]] = {}
    for thing in things:
        found.setdefault(re.sub(r"[\s_#]*\d+$", "", thing.name) or thing.name, []).append(thing)
    return list(found.items())


def _lines(name: str, lines: Sequence[Line], frames: int) -> Part:
    counts = [len(line.points(0)) for line in lines]
    data, number = vtkPolyData(), np.arange(1, len(lines) + 1, dtype=np.int32)
    data.SetLines(_cells(np.arange(sum(counts)), np.cumsum([0, *counts])))
    node = np.full(sum(counts), -1, dtype=np.int32)
    for line, start in zip(lines, np.cumsum([0, *counts]), strict=False):
        node[start + np.asarray(line.nodes, dtype=int)] = np.arange(1, len(line.nodes) + 1)
    of_points = data.GetPointData()
    _add_radii(data, lines, counts)
    add_array(of_points, "node", node)
    add_array(of_points, "line", np.repeat(number, counts))
    add_array(data.GetCellData(), "line", number)
    add_texts(data, "names", [line.name for line in lines])
    known = {q.name: labelled(q.name, q.unit) for line in lines for q in line.quantities}
    shown = [{q.name: q.values for q in line.quantities} for line in lines]

    def at(frame: int) -> vtkPolyData:
        _place(data, np.concatenate([line.points(frame) for line in lines]), float)
        for quantity, label in known.items():
            # A line without a quantity has no number there, which ParaView draws in a colour of its own.
            each = [
                values[quantity](frame) if quantity in values else np.full(count, np.nan)
                for values, count in zip(shown, counts, strict=True)
            ]
            add_array(of_points, label, np.concatenate(each).astype(float))
        if known:
            of_points.SetActiveScalars(next(iter(known.values())))
        return data

    asked = [call for line in lines for call in (line.points, *(q.values for q in line.quantities))]
    return Part(name, frames > 1 and any(call(0) is not call(1) for call in asked), at)


def _add_radii(data: vtkPolyData, lines: Sequence[Line], counts: Sequence[int]) -> None:
    """Radii of the points and of the lines, m: none where no line has a known one, else NaN of a line without."""
    radius = [
        np.where(line.measured and np.max(line.radius) > 0.0, np.broadcast_to(line.radius, count), np.nan)
        for line, count in zip(lines, counts, strict=True)
    ]
    if np.isnan(np.concatenate(radius)).all():
        return
    add_array(data.GetPointData(), "radius [m]", np.concatenate(radius))
    add_array(data.GetCellData(), "radius [m]", np.array([one.max() for one in radius]))


def _solids(name: str, solids: Sequence[Solid]) -> Part:
    points = [np.asarray(solid.points, float) for solid in solids]
    corners = np.cumsum([0, *(len(one) for one in points)])
    triangles = np.concatenate([s.triangles + start for s, start in zip(solids, corners, strict=False)])
    faces = [len(solid.triangles) for solid in solids]
    data = vtkPolyData()
    data.SetPolys(_cells(triangles.ravel(), 3 * np.arange(len(triangles) + 1)))
    add_array(data.GetCellData(), "solid", np.repeat(np.arange(1, len(solids) + 1, dtype=np.int32), faces))
    add_array(data.GetCellData(), "colour", np.repeat([_rgb(solid.colour) for solid in solids], faces, axis=0))
    add_texts(data, "names", [solid.name for solid in solids])

    def at(frame: int) -> vtkPolyData:
        # A body is drawn: 1e-7 of its distance from the origin is enough, and half the size.
        here = [p if s.pose is None else placed(p, s.pose(frame)) for p, s in zip(points, solids, strict=True)]
        _place(data, np.concatenate(here), np.float32)
        return data

    poses = [solid.pose for solid in solids if solid.pose is not None]
    return Part(name, bool(poses), at, lambda frame: b"".join(pose(frame).tobytes() for pose in poses))


def _arrows(arrows: Arrows) -> Part:
    data, label = vtkPolyData(), labelled(arrows.name, arrows.unit)

    def at(frame: int) -> vtkPolyData:
        points = np.asarray(arrows.points(frame), float).reshape(-1, 3)
        _place(data, points, float)
        data.SetVerts(_cells(np.arange(len(points)), np.arange(len(points) + 1)))
        add_array(data.GetPointData(), label, np.asarray(arrows.vectors(frame), float).reshape(-1, 3))
        data.GetPointData().SetActiveVectors(label)
        return data

    def state(frame: int) -> bytes:
        return b"".join(np.asarray(one(frame), float).tobytes() for one in (arrows.points, arrows.vectors))

    return Part(arrows.name, True, at, state)


def _level(level: Level, extent: np.ndarray) -> Part:
    low, high = extent.min(axis=0), extent.max(axis=0)
    (x, y), reach = 0.5 * (low + high)[:2], BEYOND * float(np.linalg.norm(high - low))
    corners = [(x + a * reach, y + b * reach, level.height) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    data = vtkPolyData()
    _place(data, np.array(corners), float)
    data.SetPolys(_cells(np.arange(4), np.array([0, 4])))
    add_array(data.GetCellData(), "colour", np.array([_rgb(level.colour)]))
    return Part(level.name, False, lambda frame: data)


def _ruler(ruler: Ruler) -> Part:
    data, count = vtkPolyData(), len(ruler.points)
    _place(data, np.asarray(ruler.points), float)
    data.SetVerts(_cells(np.arange(count), np.arange(count + 1)))
    if count > 1:
        data.SetLines(_cells(np.arange(count), np.array([0, count])))
    label = labelled(ruler.text, ruler.unit)
    add_array(data.GetPointData(), label, np.asarray(ruler.numbers, float))
    data.GetPointData().SetActiveScalars(label)
    return Part(ruler.text, False, lambda frame: data)


def _place(data: vtkPolyData, points: np.ndarray, kind: Any) -> None:
    places = vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=kind), deep=True))
    data.SetPoints(places)


def _cells(points: np.ndarray, starts: np.ndarray) -> vtkCellArray:
    """Cells whose points lie one behind the other; `starts` (cells + 1,) says where each begins."""
    cells = vtkCellArray()
    arrays = [numpy_to_vtk(np.ascontiguousarray(one, dtype=np.int32), deep=True) for one in (starts, points)]
    cells.SetData(*arrays)
    return cells


def _rgb(colour: str) -> np.ndarray:
    """Red, green and blue, (3,) of 0 to 255, of ``#RRGGBB``."""
    return np.array([int(colour[i:j], 16) for i, j in pairwise((1, 3, 5, 7))], dtype=np.uint8)
