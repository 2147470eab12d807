"""What a twin looks like in space now: lines, and solids with their poses, as numbers for a page.

It is the appearance that the application gives a result, of one frame: what a page draws is what `render` draws.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.integrators.time_loop import frames_of
from tautline.results.store import Store
from tautline.version import __version__
from tautline.view.space.appearance import Appearance, Look

FACES = 20_000
"""Triangles of all solids beyond which solids are drawn as their boxes: a browser sorts them for every picture."""
DIGITS = 4
"""Of places, after the point of a metre."""


class Picture:
    """Pictures of a machine.

    Parameters
    ----------
    application : Application
        Says what a result looks like.
    """

    def __init__(self, application: Any) -> None:
        self.application = application
        self.shape: dict[str, Any] = {}
        self._model: Any = None

    def of(self, model: Any, row: np.ndarray) -> dict[str, Any]:
        """Where everything is.

        Parameters
        ----------
        model : Model
            Of the simulation; with another one, such as that of a longer string, ``shape`` changes too.
        row : (width,) array
            A frame of it.

        Returns
        -------
        dict
            ``number`` of the shape; ``lines``, a list of points each; ``poses``, sixteen numbers for each solid that
            moves, row by row.
        """
        frames = frames_of(row[None, :], model.system.q.size)
        store = Store(None, model.variables, model.coordinates, {**model.attributes, "version": __version__})
        store.append({"time": frames.time, **model.observe(frames)})
        appearance = self.application.appearance(store.result, Look())
        if self._model is not model:
            self._model = model
            self.shape = {**_shape(appearance), "number": self.shape.get("number", 0) + 1}
        return {
            "number": self.shape["number"],
            "lines": [_rounded(line.points(0)) for line in appearance.lines],
            "poses": [_rounded(one.pose(0).ravel(), 6) for one in appearance.solids if one.pose is not None],
        }


def _shape(appearance: Appearance) -> dict[str, Any]:
    boxes = sum(len(one.triangles) for one in appearance.solids) > FACES
    solids = []
    for one in appearance.solids:
        points, triangles = _box(one.points) if boxes else (one.points, one.triangles)
        solids.append({
            "name": one.name, "colour": one.colour, "opacity": one.opacity, "moves": one.pose is not None,
            "points": _rounded(points), "triangles": np.asarray(triangles).tolist(),
        })  # fmt: skip
    # What must be in view: all that there is, and where the loads may go is near it.
    extent = appearance.extent([0])
    return {
        "solids": solids,
        "lines": [
            {"name": one.name, "colour": one.colour, "radius": float(np.max(one.radius)), "hollow": one.hollow}
            for one in appearance.lines
        ],
        "levels": [
            {"name": one.name, "height": one.height, "colour": one.colour, "opacity": one.opacity}
            for one in appearance.levels
        ],
        "low": _rounded(extent.min(axis=0)), "high": _rounded(extent.max(axis=0)), "eye": list(appearance.eye),
        "notes": list(appearance.remarks),
    }  # fmt: skip


def _box(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (8, 3) and triangles of the box round points."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.array([[(low, high)[(k >> axis) & 1][axis] for axis in range(3)] for k in range(8)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, np.array([part for a, b, c, d in sides for part in ((a, b, c), (a, c, d))])


def _rounded(array: np.ndarray, digits: int = DIGITS) -> list[Any]:
    return np.round(np.asarray(array, float), digits).tolist()
