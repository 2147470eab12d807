"""What a drill string's result looks like: string and hole, forces of the wall, rig and bit, at true depth or unrolled.

A string is 30 000 times longer than it is thick. So all that lies across the hole - its diameter, the pipe's, the
pipe's offset in it - is drawn larger by one factor, and the pipe still lies on the wall where it does in truth.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from drillstring.results.places import part_of
from drillstring.view.along import tension_along, torque_along
from drillstring.view.course import ROOM, Course, course_of
from drillstring.view.lettering import depth_scale, words
from drillstring.view.rig import bit, block, derrick
from drillstring.view.string_curve import Blend, Drawn
from tautline.results.errors import ResultError
from tautline.results.naming import title_of
from tautline.results.result import Result
from tautline.view.space.appearance import (
    DECK,
    GROUND,
    LOAD,
    MUD,
    PAINT,
    STEEL,
    Appearance,
    Arrows,
    History,
    Line,
    Look,
    Quantity,
    Solid,
    chosen,
    pose_of,
    ranged,
    still,
)
from tautline.view.space.mesh import turned_about

VIEWS: Mapping[str, str] = {
    "true": "true scale in north, east and depth",
    "unrolled": "straightened along the measured depth: offset in the hole against depth",
}
"""Names for ``--view``."""

AXES: Mapping[str, str] = {
    "true": "x is east, y is north, z is up; in tables and in the result x, y, z are north, east, down",
    "unrolled": "x is the offset on m2, y that on m1, z is less the measured depth",
}
"""What a view's axes are, for who compares it with a result's own."""

HOLE = 0.012
"""Diameter of a hole over the size of a picture at true depth."""
SLENDER = 7.0
"""Length over diameter of an unrolled hole."""
SAG = 0.125
"""Largest offset of a string in free space over the size of its picture, where the factor makes it so."""
CENTRED = 1.0e-6
"""Offset from the hole's axis, m, below which the wall pushes in no direction."""
SLANT = math.radians(2.0)
"""Inclination from which a hole has a low side."""
RIG, YARD = 0.07, 0.09
"""Height of the derrick, and radius of the ground around it, over the size of the picture."""


def appearance(result: Result, look: Look) -> Appearance:
    """Say what a result looks like.

    Parameters
    ----------
    result : Result
    look : Look
        `exaggerate` is the factor on all that lies across the hole; None for one that makes a hole in `HOLE` of the
        picture at true depth, and 1 in `SLENDER` unrolled.

    Raises
    ------
    ResultError
        If the view is unknown, the factor not above zero, or the result lacks positions, depths or tensions.
    """
    look = chosen(VIEWS, look)
    if look.exaggerate is not None and not 0.0 < look.exaggerate < math.inf:
        raise ResultError("--exaggerate", f"{look.exaggerate:g} is no factor", "give a number above zero, such as 50")
    course = course_of(result)
    unrolled = look.view == "unrolled"
    size = _size(course, unrolled)
    factor = look.exaggerate or _factor(course, size, unrolled)
    drawn = Drawn(course, factor, unrolled)
    low = _low_sides(drawn, size)
    return Appearance(
        title=title_of(result, "drill string"),
        time=result.time,
        lines=(_string(result, drawn), *_hole(drawn), *low),
        solids=_solids(result, drawn, size),
        arrows=_pushes(result, drawn),
        labels=words(drawn, size, low),
        rulers=(depth_scale(drawn, size, look.units),),
        eye=drawn.eye,
        notes=_notes(course, unrolled),
        enlarged=(("across the hole", factor),) if factor != 1.0 else (),
        floor=False,
        units=look.units,
        axes=AXES[look.view],
    )


def _string(result: Result, drawn: Drawn) -> Line:
    """The string, coloured by tension, torque, what the wall does to it, speeds, curvature."""
    course = drawn.course
    radius = 0.5 * drawn.factor * course.diameter[drawn.tube]
    found = [_quantity("tension", "tension", "N", tension_along(result, course), drawn.halves)]
    if "torque" in result:
        found.append(_quantity("torque", "torque", "N m", torque_along(result, course), drawn.halves))
    for name, stored, text in (
        ("contact_force_per_metre", "contact_force", "contact force"),
        ("friction_per_metre", "friction_force", "friction"),
        ("friction_around_per_metre", "friction_around", "friction around"),
    ):
        if stored in result:
            found.append(_quantity(name, text, "N/m", course.of_lumps(result[stored]) / course.tributary, drawn.lumps))
    for name, text, unit in (
        ("rotation_rate", "rotary speed", "rad/s"),
        ("axial_velocity", "axial speed", "m/s"),
    ):
        if name in result:
            found.append(_quantity(name, text, unit, course.of_lumps(result[name]), drawn.lumps))
    found.append(_quantity("curvature", "curvature", "1/m", course.curvature(), drawn.lumps))
    return Line("string", drawn.points, radius, tuple(found), nodes=drawn.nodes[course.added :])


def _quantity(name: str, text: str, unit: str, values: np.ndarray, blend: Blend) -> Quantity:
    return ranged(name, text, unit, values, lambda frame: blend.of(values[frame]))


def _hole(drawn: Drawn) -> tuple[Line, ...]:
    """The hole, seen into."""
    hole = drawn.course.hole
    if hole is None:
        return ()
    at = still(drawn.place(drawn.course.path, 0.0, 0.0))
    return (Line("hole", at, 0.5 * drawn.factor * hole, colour=MUD, hollow=True, opacity=0.45, thick=False),)


def _low_sides(drawn: Drawn, size: float) -> list[Line]:
    """Where the wall of an unrolled hole lies lowest: a line along every stretch of it that is not vertical."""
    course = drawn.course
    if course.hole is None or not drawn.unrolled:
        return []
    sides = course.downwards(course.path)
    steep = np.hypot(*sides.T)
    slanted = steep > math.sin(SLANT)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], slanted, [False]]).astype(int)))
    found: list[Line] = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first < 2:
            continue
        at = slice(first, last)
        low = drawn.place(course.path[at], *(0.5 * course.hole * sides[at] / steep[at, None]).T)
        name = "low side" if not found else f"low side {len(found) + 1}"
        found.append(Line(name, still(low), 0.002 * size, colour=DECK, thick=False, measured=False))
    return found


def _solids(result: Result, drawn: Drawn, size: float) -> tuple[Solid, ...]:
    """Derrick and block at the upper end, and the bit; the block moves as the string's upper end does."""
    course, height = drawn.course, RIG * size
    turned = result["rotation"][:, -1] if "rotation" in result else np.zeros(len(course.depth))
    # A bit is never so small that one looks for it, nor so long that it would hide the string.
    across = max(1.1 * drawn.factor * float(course.diameter[-1]), 0.006 * size)
    long = min(1.6 * across, 0.03 * size)

    def held(frame: int) -> np.ndarray:
        top = course.depth[frame, 0]
        x, y, down = drawn.axes(top).T
        return pose_of(drawn.place(top, *course.lateral[frame, 0]), np.column_stack([y, x, -down]))

    def drilling(frame: int) -> np.ndarray:
        place, axes = drawn.end(frame)
        c, s = math.cos(turned[frame]), math.sin(turned[frame])
        return pose_of(place, axes @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))

    # fmt: off
    made = [
        Solid(
            "block", *block((0.6 if course.upright else 0.3) * height), held, colour=PAINT,
            histories=_stored_histories(
                result, ("hook_load", "hook load", "N"), ("surface_torque", "surface torque", "N m"),
                ("block_position", "block position, down", "m"),
            ),
        ),
        Solid(
            "bit", *bit(across, long), drilling, colour=LOAD,
            histories=_stored_histories(
                result, ("weight_on_bit", "weight on bit", "N"), ("torque_on_bit", "torque on bit", "N m"),
                ("rotation_rate", "rotary speed", "rad/s"), ("bit_depth", "measured depth", "m"),
                ("bit_speed", "speed along the hole", "m/s"),
            ),
        ),
    ]
    # fmt: on
    if course.upright:
        made.append(Solid("derrick", *derrick(height), colour=STEEL, smooth=False))
        # Not a level that goes on: the well would be seen through it.
        bore = max(drawn.factor * course.widest, 0.005 * size)
        yard = [(bore, -0.002 * size), (_yard(drawn, size), -0.002 * size), (_yard(drawn, size), 0.0), (bore, 0.0)]
        made.append(Solid("rotary table level", *turned_about([*yard, yard[0]]), colour=GROUND, smooth=False))
    return tuple(made)


def _yard(drawn: Drawn, size: float) -> float:
    """Radius of the ground around a hole, m."""
    return max(YARD * size, 1.3 * drawn.factor * drawn.course.widest)


def _pushes(result: Result, drawn: Drawn) -> tuple[Arrows, ...]:
    """Normal forces of the wall, where the pipe touches it; they are drawn from outside."""
    course = drawn.course
    force = result["contact_force"] if "contact_force" in result else np.zeros((1, 0))
    longest = float(force.max(initial=0.0))
    if longest <= 0.0:
        return ()
    lateral, depth = course.lateral[:, course.added :], course.depth[:, course.added :]
    thick = course.diameter[np.maximum(np.arange(force.shape[1]) - 1 + course.added, 0)]

    def outwards(frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors in space, (n, 3), from the axis to the lumps, 0 at those that it goes through; and the wall."""
        offset = np.hypot(*lateral[frame].T)
        way = lateral[frame] * (np.where(offset > CENTRED, 1.0, 0.0) / np.maximum(offset, CENTRED))[:, None]
        reach = np.full(offset.size, 0.5 * course.hole) if course.hole is not None else offset + 0.5 * thick
        wall = drawn.place(depth[frame], *(reach[:, None] * way).T)
        return np.einsum("nci,ni->nc", drawn.axes(depth[frame])[..., :2], way), wall

    def points(frame: int) -> np.ndarray:
        return outwards(frame)[1]

    def vectors(frame: int) -> np.ndarray:
        return -force[frame][:, None] * outwards(frame)[0]

    text = f"contact force of a {part_of(result)}"
    return (Arrows("contact_force", text, "N", points, vectors, longest, LOAD, pushes=True),)


def _size(course: Course, unrolled: bool) -> float:
    """Largest extent of hole and string, m, without a factor."""
    if unrolled:
        return course.deepest
    string = course.well.point(course.depth[0], *course.lateral[0].T)
    points = string if course.hole is None else np.concatenate([string, course.well.position(course.stations)])
    return float(np.ptp(points, axis=0).max())


def _factor(course: Course, size: float, unrolled: bool) -> float:
    """Factor across the hole that makes it readable, of two digits and not below 1."""
    width = course.hole if course.hole is not None else ROOM * float(course.diameter.max())
    if unrolled:
        factor = size / (SLENDER * 2.0 * course.widest)
    else:
        factor = HOLE * size / width
        if course.hole is None:
            factor = min(factor, SAG * size / course.widest)
        # In a sharp bend a thicker hole would run into itself.
        sharpest = float(np.hypot(course.well.k1, course.well.k2).max())
        factor = min(factor, 1.0 / max(sharpest * width, 1e-12))
    return max(1.0, float(f"{factor:.2g}"))


def _notes(course: Course, unrolled: bool) -> tuple[str, ...]:
    along = ("depth along the hole at its true length",) if unrolled else ()
    symbols = ("derrick, block and bit are symbols",) if course.upright else ()
    return (*along, *symbols, *course.notes)


def _stored_histories(result: Result, *kinds: tuple[str, str, str]) -> tuple[History, ...]:
    """Stored variables, where they are there; of several columns the last, which is the bit's."""
    found = []
    for name, text, unit in kinds:
        if name in result:
            values = np.asarray(result[name])
            found.append(History(name, text, unit, values if values.ndim == 1 else values[:, -1]))
    return tuple(found)
