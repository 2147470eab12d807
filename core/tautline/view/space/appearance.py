"""What a result looks like in space: lines with thickness, solids that move, arrows, levels; at any frame.

An application says it once, of its stored variables. Windows, pictures, films, web pages and ParaView's files are made
of it, and none of them knows what a sheave or a wellbore is. Nothing here imports a library of graphics.

Axes are x, y and z up, in m: who stores north, east and down turns it over, ``(east, north, -down)``.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tautline.results.errors import ResultError
from tautline.system.waves import Waves

Values = Callable[[int], np.ndarray]
"""An array at a frame, counted from 0."""

STEEL, ROPE, PAINT, LOAD, DECK = "#8A9199", "#3B3B3B", "#E8B021", "#C4572B", "#6E7F8D"
WATER, GROUND, MUD = "#3E8FC4", "#9C7A54", "#A8926B"
"""Colours of things, so that a sheave is the same grey in every picture."""
ARROW = 0.1
"""Length of the longest arrow as a share of the picture's size."""


@dataclass(frozen=True)
class Look:
    """What a user asks for that an application must know when it says what a result looks like.

    Attributes
    ----------
    view : str
        Name out of the application's ``VIEWS``; empty for the first.
    exaggerate : float or None
        Factor on what lies across a slender thing: sag, offset in a hole. None for what the application finds
        readable, which the picture then says.
    units : str
        Of legends and scales: ``si``, ``metric`` or ``field``.
    """

    view: str = ""
    exaggerate: float | None = None
    units: str = "si"


@dataclass(frozen=True)
class Quantity:
    """A number at every point of a line.

    Attributes
    ----------
    name : str
        Of the array in a file, and on the command line: ``axial_force``.
    text, unit : str
        For people: ``axial force``, ``N``.
    values : callable
        Frame -> (points,) array, SI.
    low, high : float
        Range over all frames, SI.
    where : str
        Where on a thing the values are taken, where there is more than these: a legend says it beside the range.
    """

    name: str
    text: str
    unit: str
    values: Values
    low: float
    high: float
    where: str = ""

    @property
    def signed(self) -> bool:
        """Whether it has either sign, so that zero is the middle of its colours."""
        return self.low < 0.0 < self.high and min(-self.low, self.high) > 0.02 * max(-self.low, self.high)


@dataclass(frozen=True)
class Line:
    """A slender thing, drawn as a tube along its points.

    Attributes
    ----------
    name : str
    points : callable
        Frame -> (m, 3) array, m; m >= 2 and the same at every frame.
    radius : float or (m,) array
        True radius, m; zero where nobody knows it.
    quantities : tuple of Quantity
        Each of m values; the first is what colours it unless another is asked for.
    colour : str
        Of a line that shows no quantity.
    nodes : (k,) array of int
        Points that are nodes of the model; what is picked is the nearest of them. Their numbers count from 1.
    hollow : bool
        A pipe seen from outside and inside: its near side is left out and its far side is pale, as a wellbore's.
    opacity : float
    thick : bool
        Whether it is made thicker where it would be too thin to see. A wellbore of the string's scale is not.
    measured : bool
        Whether its radius is a thing's own. That of a sign, or of a rope whose diameter is guessed, is there to be
        seen, and files for other programs leave it out.
    """

    name: str
    points: Values
    radius: float | np.ndarray
    quantities: tuple[Quantity, ...] = ()
    colour: str = ROPE
    nodes: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    hollow: bool = False
    opacity: float = 1.0
    thick: bool = True
    measured: bool = True


@dataclass(frozen=True, eq=False)
class History:
    """A number of a thing as a whole over time: the tension at a drum.

    Attributes
    ----------
    name, text, unit : str
        As of a `Quantity`.
    values : (frames,) array
        SI; not finite where it is not known.
    """

    name: str
    text: str
    unit: str
    values: np.ndarray


@dataclass(frozen=True)
class Solid:
    """A thing that moves without changing its shape.

    Attributes
    ----------
    name : str
    points : (n, 3) array
        In its own axes, m.
    triangles : (k, 3) array of int
        Seen from outside they run anticlockwise.
    pose : callable or None
        Frame -> (4, 4) array that takes its own axes into space; None if it never moves.
    colour : str
    opacity : float
    smooth : bool
        Whether neighbouring faces are shaded as one round surface where they meet at less than 30 degrees.
    histories : tuple of History
        What is told of it when it is picked; the first is drawn as a curve.
    """

    name: str
    points: np.ndarray
    triangles: np.ndarray
    pose: Values | None = None
    colour: str = STEEL
    opacity: float = 1.0
    smooth: bool = True
    histories: tuple[History, ...] = ()


@dataclass(frozen=True)
class Arrows:
    """Vectors at points: forces of a wall. Where one is zero nothing is drawn.

    Attributes
    ----------
    name, text, unit : str
        As of a `Quantity`.
    points, vectors : callable
        Frame -> (k, 3) array each: where they act, m, and the unit.
    longest : float
        Largest length of a vector over all frames, in the unit; drawn a tenth of the picture long.
    colour : str
    pushes : bool
        Whether they are drawn with their heads where they act, as what pushes from outside, and not with their tails.
    """

    name: str
    text: str
    unit: str
    points: Values
    vectors: Values
    longest: float
    colour: str = LOAD
    pushes: bool = False

    def tails(self, frame: int, size: float) -> np.ndarray:
        """Where they begin in a picture of a size, m, (k, 3)."""
        points = np.asarray(self.points(frame), float)
        if not self.pushes or not self.longest > 0.0:
            return points
        return points - ARROW * size / self.longest * np.asarray(self.vectors(frame), float)


@dataclass(frozen=True)
class Level:
    """A level plane that goes on beyond the picture: sea surface, ground, formation top. `height` in m.

    A sea may have `waves` about its height; without them it is still.
    """

    name: str
    height: float
    colour: str = WATER
    opacity: float = 0.45
    waves: Waves | None = None

    @property
    def clear(self) -> bool:
        """Whether one sees through it, as through water."""
        return self.opacity < 0.6


@dataclass(frozen=True)
class Label:
    """Words at a place that may move: `place` is a callable, frame -> (3,) array, m."""

    text: str
    place: Values


@dataclass(frozen=True)
class Ruler:
    """A straight scale with ticks, such as true vertical depth.

    Attributes
    ----------
    text, unit : str
    points : (k, 3) array
        Where its ticks are, m.
    numbers : (k,) array
        What is written there.
    """

    text: str
    unit: str
    points: np.ndarray
    numbers: np.ndarray


@dataclass(frozen=True)
class Appearance:
    """All of a picture, at every frame.

    Attributes
    ----------
    title : str
    time : (frames,) array
        s.
    lines, solids, arrows, levels, labels, rulers : tuple
    eye : tuple of float
        Direction from what is seen to the eye, of a view that shows it well.
    notes : tuple of str
        What a reader of the picture must know: that a derrick is a symbol.
    enlarged : tuple of (str, float)
        What is drawn larger than it is, and how many times: ``("across the hole", 190.0)``. Empty where all lengths
        and motions are true. The thickness of lines is told by whoever draws them.
    floor : bool
        Whether a floor may be drawn below everything, where there is no ground; a well has none.
    source : (frames,) array of int or None
        Frames of the result that these are; None for all of them.
    units : str
        Of what legends say: ``si``, ``metric`` or ``field``; quantities themselves are in SI.
    axes : str
        What x, y and z are, where other files of the result have other axes: a note of files for other programs.

    Names of lines, solids and arrows differ; those that differ by a number at the end are of one kind.
    """

    title: str
    time: np.ndarray
    lines: tuple[Line, ...] = ()
    solids: tuple[Solid, ...] = ()
    arrows: tuple[Arrows, ...] = ()
    levels: tuple[Level, ...] = ()
    labels: tuple[Label, ...] = ()
    rulers: tuple[Ruler, ...] = ()
    eye: tuple[float, float, float] = (0.9, -1.0, 0.5)
    notes: tuple[str, ...] = ()
    enlarged: tuple[tuple[str, float], ...] = ()
    floor: bool = True
    source: np.ndarray | None = None
    units: str = "si"
    axes: str = ""

    @functools.cached_property
    def quantities(self) -> dict[str, list[Quantity]]:
        """Quantities of all lines by name, in the order of the lines."""
        found: dict[str, list[Quantity]] = {}
        for line in self.lines:
            for quantity in line.quantities:
                found.setdefault(quantity.name, []).append(quantity)
        return found

    @property
    def remarks(self) -> tuple[str, ...]:
        """Its notes, and what is drawn larger than it is, as sentences."""
        return (*(f"{text} drawn {factor:.6g} times as large" for text, factor in self.enlarged), *self.notes)

    def thinned(self, every: int) -> Appearance:
        """The same with every so many of its frames, and the last."""
        frames = np.unique([*range(0, len(self.time), every), len(self.time) - 1])

        def chosen_of(values: Any) -> Any:
            return None if values is None else lambda frame: values(int(frames[frame]))

        def line(one: Line) -> Line:
            shown = tuple(replace(quantity, values=chosen_of(quantity.values)) for quantity in one.quantities)
            return replace(one, points=chosen_of(one.points), quantities=shown)

        return replace(
            self,
            time=self.time[frames],
            lines=tuple(map(line, self.lines)),
            solids=tuple(
                replace(
                    one,
                    pose=chosen_of(one.pose),
                    histories=tuple(replace(each, values=each.values[frames]) for each in one.histories),
                )
                for one in self.solids
            ),
            arrows=tuple(
                replace(one, points=chosen_of(one.points), vectors=chosen_of(one.vectors)) for one in self.arrows
            ),
            labels=tuple(replace(one, place=chosen_of(one.place)) for one in self.labels),
            source=frames if self.source is None else self.source[frames],
        )

    def place_of(self, name: str) -> Values:
        """Where a thing is, frame -> (3,) array: a solid, a label, or the middle of a line.

        Raises
        ------
        ResultError
            If there is nothing of that name.
        """
        places = {line.name: functools.partial(_halfway, line) for line in self.lines}
        places |= {label.text: label.place for label in self.labels}
        places |= {solid.name: functools.partial(_middle, solid) for solid in self.solids}
        # `winch` will do for `drum winch`.
        likely = [known for known in places if known == name or known.endswith(f" {name}")]
        if not likely:
            raise ResultError("--camera", f"there is no '{name}' to follow", f"known: {', '.join(places)}")
        return places[min(likely, key=len)]

    def extent(self, frames: Sequence[int]) -> np.ndarray:
        """Points, (n, 3) m, that a picture of these frames must hold; levels are left out."""
        found = [line.points(frame) for line in self.lines for frame in (frames if not line.hollow else frames[:1])]
        for solid in self.solids:
            box = _corners(solid.points)
            for frame in frames if solid.pose is not None else frames[:1]:
                found.append(box if solid.pose is None else placed(box, solid.pose(frame)))
        found += [np.reshape(arrows.points(frame), (-1, 3)) for arrows in self.arrows for frame in frames]
        found += [ruler.points for ruler in self.rulers]
        found = [points for points in found if len(points)] or [np.zeros((1, 3))]
        size = float(np.ptp(np.concatenate(found), axis=0).max())
        return np.concatenate([*found, *(one.tails(frame, size) for one in self.arrows for frame in frames)])

    def base(self, points: np.ndarray) -> float | None:
        """Height of what everything stands on, m: the highest ground below all points (n, 3), else a floor there.

        None where there is neither: in a well, and where water is all that is below.
        """
        low, size = float(points[:, 2].min()), float(np.ptp(points, axis=0).max(initial=0.0))
        below = [one.height for one in self.levels if not one.clear]
        if below:
            return max(below)
        return low - 0.01 * size if self.floor and not self.levels else None


def chosen(views: Mapping[str, str], look: Look) -> Look:
    """A look with one of the views that there are; raises ResultError if it asks for another."""
    if look.view and look.view not in views:
        known = "; ".join(f"{name} ({text})" for name, text in views.items())
        raise ResultError("--view", f"there is no view '{look.view}'", f"known: {known}")
    return replace(look, view=look.view or next(iter(views)))


def stored(array: np.ndarray) -> Values:
    """Make the callable of an array whose leading axis is time."""
    return lambda frame: array[frame]


def still(array: np.ndarray) -> Values:
    """Make the callable of an array that is the same at every frame."""
    return lambda frame: array


def ranged(
    name: str, text: str, unit: str, values: np.ndarray, along: Values | None = None, where: str = ""
) -> Quantity:
    """Make a quantity of an array with a leading axis time.

    Parameters
    ----------
    values : (frames, ...) array
        Its least and its largest value are the range.
    along : callable or None
        Frame -> values at the points of the line, where those are not what is stored.
    where : str
        See `Quantity`.
    """
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
    return Quantity(name, text, unit, along or stored(values), low, high, where)


def placed(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Points (n, 3) of a thing's own axes in space."""
    return points @ pose[:3, :3].T + pose[:3, 3]


def pose_of(place: Any, columns: Any = None) -> np.ndarray:
    """A pose, (4, 4): a place (3,) m, and the axes of the thing as columns (3, 3) of a rotation."""
    pose = np.eye(4)
    pose[:3, 3] = place
    if columns is not None:
        pose[:3, :3] = columns
    return pose


def axes_of(axis: np.ndarray, angle: float = 0.0) -> np.ndarray:
    """Rotation, (3, 3), that takes z into a unit axis, and turns right-handed about it by an angle, rad."""
    z = np.asarray(axis, float) / np.linalg.norm(axis)
    u = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    u /= np.linalg.norm(u)
    v = np.cross(z, u)
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * u + s * v, c * v - s * u, z])


def _halfway(line: Line, frame: int) -> np.ndarray:
    points = line.points(frame)
    return points[len(points) // 2]


def _middle(solid: Solid, frame: int) -> np.ndarray:
    middle = solid.points.mean(axis=0, keepdims=True)
    return middle[0] if solid.pose is None else placed(middle, solid.pose(frame))[0]


def _corners(points: np.ndarray) -> np.ndarray:
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
