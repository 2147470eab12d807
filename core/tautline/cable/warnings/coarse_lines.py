"""Warnings of lines of cable whose elements are too few for their bend."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator

import numpy as np

from tautline.cable.input.geometry import Drawn, arc_lengths, chord, drawn_of
from tautline.cable.input.lines import TAUT, hanging
from tautline.cable.input.parts import CableScene, Element, Place
from tautline.cable.input.syntax.models import MOST_OF_A_LINE
from tautline.scene.model import MADE
from tautline.scene.warnings import warning

FEW = 12
"""Elements of a line from which on a bend is short beside the line: what it spoils are the forces near it. A bend that
is only that of a line's ends, as no number of elements cures it, is told of lines of fewer."""
MOST_TURN = math.radians(30.0)
"""Angle by which an element of a line with Gauss points may turn without a warning. The force in the middle of an
element of a catenary of 110 m over 100 m is off by 9 % where it turns by 31 degrees, and by 3 % where it does by 23."""
MUCH_TURN = math.radians(45.0)
"""Angle from which on forces at Gauss points may be off by half and more: of 300 m over 20 m they are by 41 % at 56
degrees and by 82 % at 82. Of 10 m over 1 m they are by 12 % at 42."""
FEWEST, MOST_OF_FEWEST = 3, math.radians(60.0)
"""With Lobatto points forces are right to 0.4 % up to a right angle in lines of so many elements or more; in those of
150 m over 100 m to 1.4 %. With fewer they are off by 11 % at 80 degrees, by 2 % at 68 and by 0.1 % at 40: there this
angle counts."""
MOST_COUNTED = 500
"""Elements up to which the least number that is enough is looked for; beyond, a number is told that is enough."""
PRESTRETCHED = 0.05
"""Strain at the start that is more likely a slip of the pen than meant."""
RIGHT_ANGLE = 0.5 * math.pi
LINES = "lines"
"""Where a scene keeps them."""

Sentences = Iterator[tuple[Place, str]]


@warning("cable")
def _coarse_lines(scene: CableScene) -> Sentences:
    """Lines whose elements turn far: their forces are those of a shape that a cubic does not have."""
    for place, (number, turn) in turned(scene).items():
        length = scene.elements[number].length
        cure = cure_of(scene, place)
        if turn > RIGHT_ANGLE:
            text = (
                f"are too few for the bend of the hanging cable: an element of {length:.4g} m turns by more than a "
                f"right angle. {cure}"
            )
        else:
            text = (
                f"are too few for the bend of the cable: one turns by {math.degrees(turn):.0f} degrees. "
                f"{_consequence(scene, place, turn)}. {cure}"
            )
        yield (*place, "elements"), text


def _consequence(scene: CableScene, place: Place, turn: float) -> str:
    """What an element that turns by less than a right angle does to forces."""
    count, *_, points = _lines(scene)[place]
    if points != "gauss" or count < FEWEST:
        return "Its forces may be off by a tenth"
    return f"Gauss points may make the forces near there wrong by {'half or more' if turn > MUCH_TURN else 'a tenth'}"


def _most_turn(points: str, count: int) -> float:
    """Angle, rad, by which an element may turn without a warning, in a line of so many."""
    if points == "gauss":
        return MOST_TURN
    return RIGHT_ANGLE if count >= FEWEST else MOST_OF_FEWEST


def turned(scene: CableScene) -> dict[Place, tuple[int, float]]:
    """Lines that are warned of, by their key path: the element that turns most, and by how much, rad."""
    drawn = drawn_of(scene)
    sizes = np.linalg.norm(drawn.first, axis=1) * np.linalg.norm(drawn.second, axis=1)
    cosine = (drawn.first * drawn.second).sum(axis=1) / np.where(sizes > 0.0, sizes, 1.0)
    found: dict[Place, tuple[int, float]] = {}
    for i in np.flatnonzero(~drawn.linear & (sizes > 0.0) & (cosine < math.cos(MOST_TURN))).tolist():
        element, turn = scene.elements[i], math.acos(max(-1.0, float(cosine[i])))
        # An element of no given length that turns so far is told of as one that begins stretched.
        is_meant = turn <= RIGHT_ANGLE or element.length is not None
        if element.place[-1] == "CableLine" and is_meant and turn > found.get(element.place, (0, 0.0))[1]:
            found[element.place] = i, turn
    return {place: one for place, one in found.items() if one[1] > RIGHT_ANGLE or _is_coarse(scene, place, one[1])}


def _is_coarse(scene: CableScene, place: Place, turn: float) -> bool:
    """Whether more elements are better for a line of which one turns by an angle, rad."""
    (count, *_, points), span = _lines(scene)[place], _span(scene, place)
    if turn <= _most_turn(points, count):
        return False
    return count < FEW or (_hangs(scene, *span) and not _is_quiet(*span, count, points))


def _hangs(scene: CableScene, width: float, rise: float, length: float) -> bool:
    """Whether a line of a span, rise and length, m, is drawn as a catenary."""
    return any(scene.gravity) and math.hypot(width, rise) < length * (1.0 - TAUT)


def cure_of(scene: CableScene, place: Place) -> str:
    """What to do about a line whose elements are too few: with Gauss points, first to take others."""
    count, *_, points = _lines(scene)[place]
    more = _more_elements(scene, place, points)
    if points != "gauss":
        return more
    span = _span(scene, place)
    least = count if count >= FEWEST else FEWEST
    if _hangs(scene, *span) and not _is_quiet(*span, count, "lobatto"):
        least = _enough_of_hanging(*span, count, "lobatto")
    if least > MOST_COUNTED:
        return more
    few = f" and {least} elements or more" if least > count else ""
    return f"Give `quadrature: lobatto`{few}. Without it: {more[0].lower()}{more[1:]}"


def _more_elements(scene: CableScene, place: Place, points: str) -> str:
    """How many elements a line needs with such points, or what else is to be done."""
    least = _enough(scene, place, points)
    two = "draw two lines that end at the bottom, each at a node of its own, and tie r of these nodes"
    if least <= MOST_OF_A_LINE:
        return f"Give {least} or more" + (f", or {two}" if least > MOST_COUNTED else "")
    width, _, length = _span(scene, place)
    return (
        f"The line hangs folded: at right angles to gravity its ends are only {width:.3g} m apart, too close for a "
        f"length of {length:.6g} m. Even {MOST_OF_A_LINE} elements are too few for such a fold. Move the ends farther "
        f"apart, or {two}"
    )


def _enough(scene: CableScene, place: Place, points: str) -> int:
    """Elements from which on a line is not warned of, however many they are."""
    width, rise, length = _span(scene, place)
    if not _hangs(scene, width, rise, length):
        # Its ends alone are bent, however many elements it has.
        return FEW
    return _enough_of_hanging(width, rise, length, _lines(scene)[place][0], points)


def _span(scene: CableScene, place: Place) -> tuple[float, float, float]:
    """How far the ends of a line are apart across gravity and against it, and its unstretched length, m."""
    _, length, way, _ = _lines(scene)[place]
    gravity = np.array(scene.gravity)
    rise = -float(way @ gravity) / (float(np.linalg.norm(gravity)) or 1.0)
    return math.sqrt(max(0.0, float(way @ way) - rise**2)), rise, length


def _lines(scene: CableScene) -> dict[Place, tuple[int, float, np.ndarray, str]]:
    """Elements of each line, its unstretched length, m, the vector (3,) between its ends, m, and its points of
    quadrature; found once."""
    kept = scene.__dict__.setdefault(MADE, {})
    if LINES not in kept:
        places = {node.id: node.position for node in scene.nodes}
        own: dict[Place, list[Element]] = {}
        for element in scene.elements:
            if element.place[-1] == "CableLine":
                own.setdefault(element.place, []).append(element)
        kept[LINES] = {
            place: (
                len(elements),
                sum(element.length or 0.0 for element in elements),
                np.array(chord(places[elements[0].nodes[0]], places[elements[-1].nodes[1]])),
                elements[0].axial_points,
            )
            for place, elements in own.items()
        }
    return kept[LINES]


@functools.lru_cache(maxsize=1024)
def _enough_of_hanging(width: float, rise: float, length: float, own: int, points: str) -> int:
    """Elements that are enough for a line of `own` that hangs; its span, rise and length in m."""
    _, _, (begin, end) = hanging(width, rise, length, np.array([0.0, length]))
    # Along a catenary the steepness grows evenly: an element turns most where it is level in its middle.
    count = max(FEW, math.ceil((end - begin) / (2.0 * math.tan(0.5 * _most_turn(points, FEW)))))
    while MOST_COUNTED > count > own + 1 and _is_quiet(width, rise, length, count - 1, points):
        count -= 1
    return max(count, own + 1)


def _is_quiet(width: float, rise: float, length: float, count: int, points: str) -> bool:
    """Whether nothing is said of a hanging line of so many elements; its span, rise and length in m."""
    along, up, steep = hanging(width, rise, length, length * np.arange(count + 1) / count)
    turn = float(np.diff(np.arctan(steep)).max())
    if turn > _most_turn(points, count):
        return False
    level = np.zeros(count + 1)
    place = np.column_stack([along, up, level])
    slope = np.column_stack([level + 1.0, steep, level]) / np.hypot(1.0, steep)[:, None]
    lengths = np.full(count, length / count)
    drawn = Drawn(np.zeros(count, bool), np.diff(place, axis=0), slope[:-1], slope[1:])
    return float(np.abs(arc_lengths(drawn, lengths) / lengths - 1.0).max()) <= PRESTRETCHED
