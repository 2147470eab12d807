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

from tautline.results.errors import ResultError, unwritten
from tautline.scene.values.systems import length_unit
from tautline.view.figures.figure import round_numbers, scale_in
from tautline.view.space.appearance import Appearance, History, Level, Line, Quantity, Values
from tautline.view.space.camera import ANGLE
from tautline.view.space.colours import shading
from tautline.view.space.scales import scales
from tautline.view.space.surroundings import deep
from tautline.whole_file import whole_file

WEB = resources.files("tautline.view") / "web"

STEPS = 65534
"""Numbers are stored in so many steps of their range; one more says that there is none."""
UNKNOWN = 65535
TOLD = 3
"""Decimal digits of a quantity's range that are stored and told, at least: the range is 1000 to 10 000 steps."""
MOST = 40_000_000
"""Bytes of what changes with time, before it is packed: in base64 a page stays below 60 MB even if nothing packs."""
USUAL = 25_000_000
"""Bytes of what changes with time from which a page holds no more than `ENOUGH` pictures."""
PICTURES, ENOUGH = 1500, 500
"""Most pictures of a page, and as many as it has whatever it weighs, below `MOST`: between them it interpolates."""
MOMENTS = 20_000
"""Most values in the history of a thing."""
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
        start = self.add(middle)
        self._changes(count, stride)
        return {"at": start, "rows": len(array), "width": array.shape[1], "stride": stride, "step": step}

    def numbers(self, values: Values, factor: float, digits: int) -> dict[str, Any]:
        """Append what a callable gives at every frame, over a factor, as decimal numbers: see `decimals`."""
        return self.decimals(np.stack([np.ravel(values(int(k))) for k in self.frames]) / factor, digits)

    def decimals(self, array: np.ndarray, digits: int) -> dict[str, Any]:
        """Append an array (rows, width) rounded to so many digits after the point.

        What is read of it are the very digits to which the numbers themselves would be rounded. Fewer are stored where
        so many would not fit, which the returned ``digits`` says; else as `rows`.
        """
        array = np.where(np.isfinite(array), array, np.nan)
        if not array.size or np.array_equal(array, np.broadcast_to(array[:1], array.shape), equal_nan=True):
            array = array[:1]
        known = np.isfinite(array)
        count = _counted(np.where(known, array, 0.0), digits)
        there = known.any(axis=0)
        low = np.where(known, count, np.inf).min(axis=0, initial=np.inf)
        high = np.where(known, count, -np.inf).max(axis=0, initial=-np.inf)
        middle = np.rint(0.5 * (np.where(there, low, 0.0) + np.where(there, high, 0.0)))
        off = np.where(known, count - middle, 0.0)
        if np.abs(off).max(initial=0.0) >= STEPS // 2:
            return self.decimals(array, digits - 1)
        steps = np.where(known, off + STEPS // 2, UNKNOWN).astype(np.uint16)
        start = self.add(middle)
        self._changes(steps, 1)
        return {"at": start, "rows": len(array), "width": array.shape[1], "stride": 1, "digits": digits}

    def _changes(self, steps: np.ndarray, stride: int) -> None:
        # A number is like the one before it on the line, and changes like it: differences along both are small.
        change = np.diff(steps, axis=0, prepend=np.uint16(0))
        change[:, stride:] -= change[:, :-stride].copy()
        self.add(_planes(change.view(np.int16).T))

    def corners(self, triangles: np.ndarray) -> dict[str, Any]:
        """Append the corners (k, 3) of triangles, each as the difference from that of the triangle before."""
        change = np.diff(np.asarray(triangles, np.int32), axis=0, prepend=np.int32(0))
        return {"at": self.add(_planes(change)), "count": len(triangles)}

    def text(self) -> str:
        """All of it, packed, in base64."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 9)).decode()


def write_page(
    appearance: Appearance, path: Path, colour: str | None = None, radius: float | None = None, frames: int = PICTURES
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
        fewer, of large results, for a page that stays small. The page says so, and interpolates between them.

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
    path = Path(path)
    try:
        with whole_file(path) as waiting:
            waiting.write_text(assembled(appearance.title, scene, pack.text()), encoding="utf-8", newline="\n")
    except OSError as error:
        raise unwritten(path, error, "name another with --html") from None
    return path


def thinned(appearance: Appearance, most: int) -> np.ndarray:
    """Frames that a page holds: at most so many, evenly, the first and the last among them; fewer if they are large."""
    numbers = sum(line.points(0).size * (1 + len(line.quantities) / 3) for line in appearance.lines)
    numbers += sum(12 for solid in appearance.solids if solid.pose is not None)
    numbers += sum(2 * arrows.points(0).size for arrows in appearance.arrows)
    light, room = (max(int(size / (2 * max(numbers, 1))), 2) for size in (USUAL, MOST))
    count = min(len(appearance.time), most, max(light, ENOUGH), room)
    return np.unique(np.linspace(0, len(appearance.time) - 1, count).round().astype(int))


def describe(appearance: Appearance, pack: Pack, colour: str | None, radius: float | None) -> dict[str, Any]:
    """All of a page but its large arrays, which go into the pack."""
    looked_at = pack.frames[np.unique(np.linspace(0, len(pack.frames) - 1, LOOKED_AT).round().astype(int))]
    extent = appearance.extent([int(frame) for frame in looked_at])
    base = appearance.base(extent)
    rulers = scales(appearance, extent)
    extent = np.concatenate([extent, *(one.points for one in rulers)])
    low, high = extent.min(axis=0), extent.max(axis=0)
    middle, size = 0.5 * (low + high), max(float((high - low).max()), 1e-6)
    shown = shading(appearance, colour)
    told = {name: _quantity(appearance, name, found) for name, found in appearance.quantities.items()}
    lines = [_line(line, pack, middle, told) for line in appearance.lines]
    moments = np.unique(np.linspace(0, len(appearance.time) - 1, MOMENTS).round().astype(int))
    moments = moments if len(appearance.time) > MOMENTS else np.arange(len(appearance.time))
    return {
        "title": appearance.title,
        "notes": list(appearance.notes),
        "time": [float(time) for time in np.asarray(appearance.time)[pack.frames]],
        "frames": len(appearance.time),
        "numbers": [int(frame) for frame in pack.frames],
        "moments": [float(time) for time in np.asarray(appearance.time)[moments]],
        "size": size,
        "length": dict(zip(("metres", "unit"), length_unit(appearance.units), strict=True)),
        "outermost": _outermost(extent - middle).round(6).tolist(),
        "eye": [float(part) for part in appearance.eye],
        "angle": ANGLE,
        "factor": radius,
        "error": max([0.5 * line["points"]["step"] for line in lines], default=0.0),
        "colour": None if shown is None else shown.name,
        "enlarged": [[text, float(factor)] for text, factor in appearance.enlarged],
        "base": None if base is None else float(base - middle[2]),
        "floor": base is not None and all(one.clear for one in appearance.levels),
        "above": float(middle[2]),
        "quantities": list(told.values()),
        "lines": lines,
        "solids": _solids(appearance, pack, middle, moments),
        "arrows": [
            {
                "name": one.name, "text": one.text, "colour": one.colour, "longest": float(one.longest),
                "pushes": one.pushes, "said": _number(one.longest, one.unit, appearance.units),
                "points": pack.track(one.points, middle), "vectors": pack.track(one.vectors),
            }
            for one in appearance.arrows
            if one.longest > 0.0 and len(one.points(0))
        ],
        "levels": [_level(one, middle, deep(one, extent)) for one in appearance.levels],
        "labels": [{"text": one.text, "place": pack.track(one.place, middle)} for one in appearance.labels],
        "rulers": [
            {
                "text": f"{one.text}, {one.unit}" if one.unit else one.text,
                "points": (np.asarray(one.points, float) - middle).round(6).tolist(),
                "numbers": [_tidy(float(number)) for number in one.numbers],
            }
            for one in rulers
        ],
    }  # fmt: skip


def _counted(array: np.ndarray, digits: int) -> np.ndarray:
    """Numbers in steps of a decimal digit, rounded as their text would be: 1.005, which is a little less, to 1.00."""
    steps = array * 10.0**digits
    count = np.rint(steps)
    close = np.abs(np.abs(steps - np.floor(steps)) - 0.5) < 1e-6
    if digits >= 0:
        count[close] = [np.rint(float(f"{one:.{digits}f}") * 10.0**digits) for one in array[close]]
    return np.asarray(count)


def _planes(change: np.ndarray) -> np.ndarray:
    """Bytes of integers of either sign, first the lowest of all; what is near zero has zeros in the others."""
    bits = 8 * change.dtype.itemsize
    unsigned = ((change << 1) ^ (change >> (bits - 1))).astype(f"<u{change.dtype.itemsize}")
    return np.ascontiguousarray(np.ascontiguousarray(unsigned).reshape(-1, 1).view(np.uint8).T)


def _level(level: Level, middle: np.ndarray, is_deep: bool) -> dict[str, Any]:
    said = {
        "name": level.name, "height": float(level.height - middle[2]), "colour": level.colour,
        "opacity": level.opacity, "clear": level.clear, "deep": is_deep,
        "waves": None,
    }  # fmt: skip
    if (waves := level.waves) is not None:
        said["waves"] = {
            name: [float(f"{one:.9g}") for one in getattr(waves, name)]
            for name in ("amplitude", "frequency", "phase", "number")
        } | {
            "direction": [float(one) for one in waves.direction],
            "origin": [float(one) for one in np.asarray(waves.origin) - middle[:2]],
            "ramp": float(waves.ramp),
        }
    return said


def _line(line: Line, pack: Pack, middle: np.ndarray, told: dict[str, dict[str, Any]]) -> dict[str, Any]:
    radius = np.asarray(line.radius, float)
    return {
        "name": line.name, "colour": line.colour, "hollow": line.hollow, "opacity": line.opacity, "thick": line.thick,
        "radius": float(radius) if radius.ndim == 0 else [float(f"{one:.6g}") for one in radius],
        "nodes": [int(node) for node in line.nodes],
        "points": pack.track(line.points, middle),
        "quantities": {
            one.name: pack.numbers(one.values, told[one.name]["factor"], told[one.name]["digits"])
            for one in line.quantities
        },
    }  # fmt: skip


def _solids(appearance: Appearance, pack: Pack, middle: np.ndarray, moments: np.ndarray) -> list[dict[str, Any]]:
    # Frame by frame, as everyone asks: an application may find the places of all its solids at once.
    solids = appearance.solids
    every = range(len(appearance.time)) if any(solid.pose is not None for solid in solids) else pack.frames
    poses = [
        [None if solid.pose is None else np.asarray(solid.pose(int(frame)), float)[:3] for solid in solids]
        for frame in every
    ]
    said = []
    for k, solid in enumerate(solids):
        points = np.asarray(solid.points, float)
        moves = solid.pose is not None
        whole = np.stack([row[k] for row in poses]) if moves else np.eye(4)[None, :3]
        pose = whole[pack.frames] if moves else whole
        said.append({
            "name": solid.name, "colour": solid.colour, "opacity": solid.opacity, "smooth": solid.smooth,
            "size": float(np.ptp(points, axis=0).max(initial=0.0)),
            "points": pack.rows(points), "triangles": pack.corners(solid.triangles),
            "turn": pack.rows(pose[:, :, :3].reshape(len(pose), 9)), "place": pack.rows(pose[:, :, 3] - middle),
            "turns": [int(one) for one in whole_turns(whole[:, :, :3], pack.frames)] if moves else [],
            "histories": [_history(appearance, one, pack, moments) for one in solid.histories],
        })  # fmt: skip
        if not any(said[-1]["turns"]):
            said[-1]["turns"] = []
    return said


def whole_turns(rotation: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Whole turns that a body makes from each of some frames to the next, beside the least rotation between them.

    Parameters
    ----------
    rotation : (n, 3, 3) array
        At all frames; from each to the next a body turns by less than half a turn.
    frames : (m,) array of int
        Increasing.

    Returns
    -------
    (m - 1,) array of int
        Positive about the axis of the least rotation.
    """
    step = _rotation_vector(np.swapaxes(rotation[:-1], 1, 2) @ rotation[1:])
    travelled = np.concatenate([np.zeros((1, 3)), np.cumsum(step, axis=0)])
    least = _rotation_vector(np.swapaxes(rotation[frames[:-1]], 1, 2) @ rotation[frames[1:]])
    angle = np.linalg.norm(least, axis=1)
    along = np.einsum("ij,ij->i", np.diff(travelled[frames], axis=0), least) / np.maximum(angle, 1e-12)
    return np.where(angle > 1e-9, np.rint((along - angle) / (2.0 * np.pi)), 0.0).astype(int)


def _rotation_vector(matrix: np.ndarray) -> np.ndarray:
    """Rotation vectors (n, 3), rad, of matrices (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(matrix).as_rotvec()) if len(matrix) else np.zeros((0, 3))


def _history(appearance: Appearance, history: History, pack: Pack, moments: np.ndarray) -> dict[str, Any]:
    """A number of a thing at every moment, in the unit that its range wants."""
    values = np.asarray(history.values, float)
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    factor, unit = scale_in(appearance.units, [np.array([low, high])], history.unit)
    digits = _digits_of((high - low) / factor, max(abs(low), abs(high)) / factor)
    track = pack.decimals(values[moments, None] / factor, digits)
    return {"name": history.name, "text": history.text, "unit": unit, "digits": track["digits"], "values": track}


def _digits_of(span: float, size: float) -> int:
    """Digits after the point with which numbers that differ by at most `span` are told apart, of a size."""
    least = max(span, 0.02 * size)
    return int(np.clip(np.ceil(TOLD - np.log10(least)), -12, 12)) if least > 0.0 else 0


def _quantity(appearance: Appearance, name: str, found: Sequence[Quantity]) -> dict[str, Any]:
    """Legend of a quantity: its colours, ends and round numbers, in the unit that its title names."""
    shade = shading(appearance, name)
    assert shade is not None
    low, high = min(one.low for one in found), max(one.high for one in found)
    ticks = round_numbers(shade.low, shade.high, 5)
    return {
        "name": name, "text": found[0].text, "title": shade.title, "factor": shade.factor,
        "unit": shade.unit, "digits": _digits_of((high - low) / shade.factor, max(abs(low), abs(high)) / shade.factor),
        "low": shade.low, "high": shade.high, "table": shade.table.tobytes().hex(),
        "ticks": [[tick, _tidy(tick)] for tick in ticks],
        "range": [_tidy(low / shade.factor, 4), _tidy(high / shade.factor, 4)], "where": found[0].where,
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
