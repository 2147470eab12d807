"""One web page that holds a result in three dimensions and plays it: no network, no server, any browser."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import zlib
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from tautline.results.errors import ResultError
from tautline.view.figures.figure import round_numbers, scale_in
from tautline.view.space.appearance import Appearance, Line, Quantity, Solid, Values
from tautline.view.space.camera import ANGLE
from tautline.view.space.colours import shading

WEB = resources.files("tautline.view") / "web"

STEPS = 65534
"""Numbers are stored in so many steps of their range; one more says that there is none."""
UNKNOWN = 65535
SHADES = 16_000
"""Steps of a quantity: finer than what is written of it."""
MOST = 40_000_000
"""Bytes of what changes with time, before it is packed: in base64 a page stays below 60 MB even if nothing packs."""
LOOKED_AT = 60
"""Frames, about, that the camera is placed for."""
DIRECTIONS = 160
"""Directions in which the outermost points are looked for."""


class Pack:
    """Bytes of a page, each array at an offset that is a multiple of four.

    Parameters
    ----------
    frames : (n,) array of int
        Frames of the result that the page holds.
    """

    def __init__(self, frames: np.ndarray) -> None:
        self.frames = frames
        self._parts: list[bytes] = []
        self._end = 0

    def add(self, array: np.ndarray) -> int:
        """Append an array as it is, little endian; its offset."""
        part = array.astype(array.dtype.newbyteorder("<")).tobytes()
        part += bytes(-len(part) % 4)
        start, self._end = self._end, self._end + len(part)
        self._parts.append(part)
        return start

    def track(self, values: Values, shift: Any = 0.0, steps: int = STEPS) -> dict[str, Any]:
        """Append what a callable gives at every frame, less a shift."""
        stride = 3 if np.ndim(values(int(self.frames[0]))) == 2 else 1
        array = np.stack([(np.asarray(values(int(k)), float) - shift).ravel() for k in self.frames])
        return self.rows(array, stride, steps)

    def rows(self, array: np.ndarray, stride: int = 1, steps: int = STEPS) -> dict[str, Any]:
        """Append an array (rows, width) in steps of its range, each column about a middle of its own.

        Returns
        -------
        dict
            ``at``, ``rows`` (1 if all are the same), ``width``, ``stride`` (3 for the points of a line) and ``step``;
            half a step is the largest error.
        """
        array = np.where(np.isfinite(array), array, np.nan)
        if not array.size or np.array_equal(array, np.broadcast_to(array[:1], array.shape), equal_nan=True):
            array = array[:1]
        known = np.isfinite(array)
        low, high = np.where(known, array, np.inf).min(axis=0), np.where(known, array, -np.inf).max(axis=0)
        there = known.any(axis=0)
        middle = (0.5 * (np.where(there, low, 0.0) + np.where(there, high, 0.0))).astype(np.float32)
        off = np.where(known, array - middle, 0.0)
        step = float(np.abs(off).max(initial=0.0)) / (steps // 2) or 1.0
        count = np.where(known, np.rint(off / step) + STEPS // 2, UNKNOWN).astype(np.uint16)
        # A number is like the one before it on the line, and changes like it: differences along both are small.
        change = np.diff(count, axis=0, prepend=np.uint16(0))
        change[:, stride:] -= change[:, :-stride].copy()
        start = self.add(middle)
        self.add(_planes(change.view(np.int16).T))
        return {"at": start, "rows": len(array), "width": array.shape[1], "stride": stride, "step": step}

    def corners(self, triangles: np.ndarray) -> dict[str, Any]:
        """Append the corners (k, 3) of triangles, each as the difference from that of the triangle before."""
        change = np.diff(np.asarray(triangles, np.int32), axis=0, prepend=np.int32(0))
        return {"at": self.add(_planes(change)), "count": len(triangles)}

    def text(self) -> str:
        """All of it, packed, in base64."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 9)).decode()


def write_page(
    appearance: Appearance, path: Path, colour: str | None = None, radius: float | None = None, frames: int = 400
) -> Path:
    """Write a page that shows a result, plays it and tells the values under the pointer.

    Parameters
    ----------
    appearance : Appearance
    path : Path
    colour : str or None
        Name of the quantity that colours the lines at first, ``none`` for plain ones, None for the first that there is.
    radius : float or None
        Factor on the true thickness of lines; None for true, but thick enough to see.
    frames : int
        Most frames in the page; of more, evenly many are left out, but neither the first nor the last. There may be
        fewer, for a page below 60 MB. The page says so.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    ResultError
        If no line has that quantity, `radius` or `frames` is not positive, or the page cannot be written.
    """
    if radius is not None and not 0.0 < radius < np.inf:
        raise ResultError("--radius", f"{radius:g} is no factor on a thickness", "give a number above 0, such as 5")
    if frames < 1:
        raise ResultError(path, f"a page of {frames} frames shows nothing", "give 1 or more")
    kept = thinned(appearance, frames)
    pack = Pack(kept)
    scene = describe(appearance, pack, colour, radius)
    try:
        Path(path).write_text(assembled(appearance.title, scene, pack.text()), encoding="utf-8", newline="\n")
    except OSError as error:
        raise ResultError(path, f"it cannot be written: {error.strerror}") from error
    return Path(path)


def thinned(appearance: Appearance, most: int) -> np.ndarray:
    """Frames that a page holds: at most so many, evenly, the first and the last among them; fewer if they are large."""
    numbers = sum(line.points(0).size * (1 + len(line.quantities) / 3) for line in appearance.lines)
    numbers += sum(12 for solid in appearance.solids if solid.pose is not None)
    numbers += sum(2 * arrows.points(0).size for arrows in appearance.arrows)
    room = max(int(MOST / (2 * max(numbers, 1))), 2)
    count = min(len(appearance.time), most, room)
    return np.unique(np.linspace(0, len(appearance.time) - 1, count).round().astype(int))


def describe(appearance: Appearance, pack: Pack, colour: str | None, radius: float | None) -> dict[str, Any]:
    """All of a page but its large arrays, which go into the pack."""
    looked_at = pack.frames[np.unique(np.linspace(0, len(pack.frames) - 1, LOOKED_AT).round().astype(int))]
    extent = appearance.extent([int(frame) for frame in looked_at])
    low, high = extent.min(axis=0), extent.max(axis=0)
    middle, size = 0.5 * (low + high), max(float((high - low).max()), 1e-6)
    shown = shading(appearance, colour)
    lines = [_line(line, pack, middle) for line in appearance.lines]
    return {
        "title": appearance.title,
        "notes": list(appearance.notes),
        "time": [float(time) for time in np.asarray(appearance.time)[pack.frames]],
        "frames": len(appearance.time),
        "numbers": [int(frame) for frame in pack.frames],
        "size": size,
        "outermost": _outermost(extent - middle).round(6).tolist(),
        "eye": [float(part) for part in appearance.eye],
        "angle": ANGLE,
        "factor": radius,
        "error": max([0.5 * line["points"]["step"] for line in lines], default=0.0),
        "colour": None if shown is None else shown.name,
        "quantities": [_quantity(appearance, name, found) for name, found in appearance.quantities.items()],
        "lines": lines,
        "solids": _solids(appearance.solids, pack, middle),
        "arrows": [
            {
                "name": one.name, "text": one.text, "colour": one.colour, "longest": float(one.longest),
                "said": _number(one.longest, one.unit, appearance.units),
                "points": pack.track(one.points, middle), "vectors": pack.track(one.vectors),
            }
            for one in appearance.arrows
            if one.longest > 0.0 and len(one.points(0))
        ],
        "levels": [
            {"name": one.name, "height": float(one.height - middle[2]), "colour": one.colour, "opacity": one.opacity}
            for one in appearance.levels
        ],
        "labels": [{"text": one.text, "place": pack.track(one.place, middle)} for one in appearance.labels],
        "rulers": [
            {
                "text": f"{one.text}, {one.unit}" if one.unit else one.text,
                "points": (np.asarray(one.points, float) - middle).round(6).tolist(),
                "numbers": [f"{number:g}" for number in one.numbers],
            }
            for one in appearance.rulers
        ],
    }  # fmt: skip


def _planes(change: np.ndarray) -> np.ndarray:
    """Bytes of integers of either sign, first the lowest of all; what is near zero has zeros in the others."""
    bits = 8 * change.dtype.itemsize
    unsigned = ((change << 1) ^ (change >> (bits - 1))).astype(f"<u{change.dtype.itemsize}")
    return np.ascontiguousarray(np.ascontiguousarray(unsigned).reshape(-1, 1).view(np.uint8).T)


def _line(line: Line, pack: Pack, middle: np.ndarray) -> dict[str, Any]:
    radius = np.asarray(line.radius, float)
    return {
        "name": line.name, "colour": line.colour, "hollow": line.hollow, "opacity": line.opacity, "thick": line.thick,
        "radius": float(radius) if radius.ndim == 0 else [float(f"{one:.6g}") for one in radius],
        "nodes": [int(node) for node in line.nodes],
        "points": pack.track(line.points, middle),
        "quantities": {one.name: pack.track(one.values, steps=SHADES) for one in line.quantities},
    }  # fmt: skip


def _solids(solids: Sequence[Solid], pack: Pack, middle: np.ndarray) -> list[dict[str, Any]]:
    # Frame by frame, as everyone asks: an application may find the places of all its solids at once.
    poses = [
        [np.eye(4)[:3] if solid.pose is None else np.asarray(solid.pose(int(frame)), float)[:3] for solid in solids]
        for frame in pack.frames
    ]
    said = []
    for k, solid in enumerate(solids):
        points, pose = np.asarray(solid.points, float), np.stack([row[k] for row in poses])
        said.append({
            "name": solid.name, "colour": solid.colour, "opacity": solid.opacity, "smooth": solid.smooth,
            "size": float(np.ptp(points, axis=0).max(initial=0.0)),
            "points": pack.rows(points), "triangles": pack.corners(solid.triangles),
            "turn": pack.rows(pose[:, :, :3].reshape(len(pose), 9)), "place": pack.rows(pose[:, :, 3] - middle),
        })  # fmt: skip
    return said


def _quantity(appearance: Appearance, name: str, found: Sequence[Quantity]) -> dict[str, Any]:
    """Legend of a quantity: its colours, ends and round numbers, in the unit that its title names."""
    shade = shading(appearance, name)
    assert shade is not None
    low, high = min(one.low for one in found), max(one.high for one in found)
    ticks = round_numbers(shade.low, shade.high, 5)
    return {
        "name": name, "text": found[0].text, "title": shade.title, "factor": shade.factor,
        "unit": shade.unit,
        "low": shade.low, "high": shade.high, "table": shade.table.tobytes().hex(),
        "ticks": [[tick, _tidy(tick)] for tick in ticks],
        "range": [_tidy(low / shade.factor, 4), _tidy(high / shade.factor, 4)],
    }  # fmt: skip


def _tidy(number: float, digits: int = 10) -> str:
    """A number for people, with a true minus sign."""
    return f"{number + 0.0:.{digits}g}".replace("-", "−")


def _number(value: float, unit: str, system: str) -> str:
    factor, letters = scale_in(system, [np.array([value])], unit)
    return f"{_tidy(value / factor, 3)} {letters}".strip()


def _outermost(points: np.ndarray) -> np.ndarray:
    """Points, (k, 3), that a picture from any side must hold: those that lie farthest in some direction."""
    # Directions evenly over the sphere, on a spiral of the golden angle.
    k = np.arange(DIRECTIONS) + 0.5
    z, angle = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    ways = np.stack([flat * np.cos(angle), flat * np.sin(angle), z])
    best, reached = np.zeros(DIRECTIONS, dtype=int), np.full(DIRECTIONS, -np.inf)
    for start in range(0, len(points), 20_000):
        reach = points[start : start + 20_000] @ ways
        at = reach.argmax(axis=0)
        farther = reach[at, np.arange(DIRECTIONS)] > reached
        best[farther] = start + at[farther]
        reached = np.maximum(reached, reach.max(axis=0))
    return points[np.unique(best)]


def assembled(title: str, scene: dict[str, Any], data: str) -> str:
    """The page's text; what comes from a scene is escaped, so that it can be nothing but text.

    Scripts and style are allowed by their digest only: whatever else finds its way into a page is not run.
    """
    script = "\n".join((WEB / name).read_text(encoding="utf-8") for name in ("scene.js", "viewer.js", "reader.js"))
    library, style = ((WEB / name).read_text(encoding="utf-8") for name in ("three.min.js", "viewer.css"))
    licences = "three.js (c) three.js authors, fflate (c) Arjun Barrett; both under the MIT licence"
    parts = {
        "title": html.escape(title),
        "style": style,
        "scripts": " ".join(_digest(text) for text in (library, script)),
        "styles": _digest(style),
        "licences": licences,
        "library": library,
        "viewer": script,
        "scene": _inert(scene),
        "data": data,
    }
    # All marks are filled at once: a title that reads like a mark stays a title.
    template = (WEB / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda mark: parts[mark[1]], template)


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _inert(scene: dict[str, Any]) -> str:
    """JSON that cannot end the element it stands in, whatever words it holds."""
    text = json.dumps(scene, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
