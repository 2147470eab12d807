"""Cables that are written as one item: how they lie between their ends."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from tautline.cable.input.geometry import COINCIDENT
from tautline.cable.input.parts import Node, Place, Vector
from tautline.cable.input.register import Numbered, Register

TAUT = 1.0e-9
"""Length beyond the distance of its ends, over that, up to which a cable lies straight."""
MOST_STRETCH = 1.0e3
"""Distance of its ends over its length that is surely something else."""
UPRIGHT = 1.0e-6
"""Horizontal distance of its ends, over its length, below which no hanging cable is drawn."""
STEPS = 100
"""Newton steps for the catenary, of which ten are many."""


class Laid(NamedTuple):
    """How a cable lies: places (n + 1, 3), m, and slopes dr/dp (n + 1, 3) of its nodes; unstretched length of an
    element, m, None for as long as it lies."""

    place: np.ndarray
    slope: np.ndarray
    length: float | None


def lay(register: Register, gravity: Vector) -> dict[Place, Laid]:
    """How each line with good ends lies, by its key path: straight, or hanging where it is longer than the distance.

    Faults are noted in the register.
    """
    found: dict[Place, Laid] = {}
    at: dict[int, Vector] = {}
    for line in register.lines:
        first, last = line.nodes[0], line.nodes[-1]
        good = [register.has_node((*line.place, line.key, i), node, line.kind) for i, node in enumerate((first, last))]
        if first == last:
            register.refuse((*line.place, line.key), f"leads from node {first} to itself", "name two nodes")
        elif all(good):
            ends = [register.nodes[node].xyz if node in register.nodes else at.get(node) for node in (first, last)]
            if None in ends:
                cause, cure = "ends at a node of a line that is drawn later", "write this line after that one"
                if not {first, last}.isdisjoint(line.between):
                    cause = f"ends at a node between its own ends, {line.between[0]} to {line.between[-1]}"
                    cure = "name two nodes that are written, or number those between from another `between`"
                register.refuse((*line.place, line.key), cause, cure)
                continue
            _check_coordinates(register, line)
            laid = _lay(register, line, np.array(ends[0], float), np.array(ends[1], float), np.array(gravity, float))
            if laid is not None:
                found[line.place] = laid
                at |= zip(line.between, map(tuple, laid.place[1:-1].tolist()), strict=True)
    return found


def _check_coordinates(register: Register, line: Numbered) -> None:
    """Refuse a length that the material coordinates of both ends contradict."""
    first, last = (getattr(register.nodes.get(node), "p", None) for node in (line.nodes[0], line.nodes[-1]))
    length = line.model.length
    if None not in (first, last, length) and abs(last - first - length) > TAUT * length:
        cause = f"is {length:.10g} m, and p of its ends differs by {last - first:.10g} m"
        register.refuse((*line.place, "length"), cause, "leave `length` out, or p of one end")


def _lay(register: Register, line: Numbered, first: np.ndarray, last: np.ndarray, gravity: np.ndarray) -> Laid | None:
    """How one line lies between two points, m; None if it is refused."""
    n, length, apart = line.model.elements, line.model.length, float(np.linalg.norm(last - first))
    share = np.arange(n + 1)[:, None] / n
    if length is None or apart >= length * (1.0 - TAUT):
        if apart <= COINCIDENT:
            cause = f"nodes {line.nodes[0]} and {line.nodes[-1]} stand at one point"
            register.refuse((*line.place, line.key), cause, "move one of them, or give the line a `length`")
            return None
        if apart > MOST_STRETCH * (length or apart):
            cause = f"its ends are {apart:.3g} m apart: no cable is stretched so far"
            register.refuse((*line.place, "length"), cause, "give the unstretched length in m")
            return None
        stretch = 1.0 if length is None else apart / length
        slope = np.broadcast_to(stretch * (last - first) / apart, (n + 1, 3))
        return Laid(first + share * (last - first), slope, None if length is None else length / n)
    weight = float(np.linalg.norm(gravity))
    up = -gravity / weight if weight > 0.0 else np.zeros(3)
    rise = float((last - first) @ up)
    level = last - first - rise * up
    width = float(np.linalg.norm(level))
    if weight == 0.0 or width <= UPRIGHT * length:
        cause = f"is longer than the {apart:.6g} m between its ends, "
        if weight > 0.0:
            cause += "which stand above one another"
        else:
            cause += "and without gravity a line is not drawn as it hangs: its `load` is not looked at"
        cure = "give `length` up to that distance, or draw the cable with nodes and elements of its own"
        register.refuse((*line.place, "length"), cause, cure)
        return None
    along, high, steep = hanging(width, rise, length, share[:, 0] * length)
    place = first + along[:, None] * level / width + high[:, None] * up
    place[0], place[-1] = first, last
    cosine = 1.0 / np.hypot(1.0, steep)
    return Laid(place, cosine[:, None] * level / width + (cosine * steep)[:, None] * up, length / n)


def hanging(width: float, rise: float, length: float, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The inextensible catenary: way along and up (n,), m, and its steepness dz/dx (n,), at arcs s (n,), m.

    With a the radius at the lowest point, sqrt(length^2 - rise^2) = 2 a sinh x and width = 2 a x (Irvine, Cable
    Structures, 1981, section 1.2): sinh(x) / x is found by Newton's method on its logarithm.
    """
    ratio = math.log(math.sqrt((length - rise) * (length + rise)) / width)
    x = math.sqrt(6.0 * ratio) if ratio < 1.0 else ratio + math.log(2.0 * ratio + 1.0) + 0.7
    for _ in range(STEPS):
        excess = x + math.log(-math.expm1(-2.0 * x) / (2.0 * x)) - ratio
        change = excess / (1.0 / math.tanh(x) - 1.0 / x)
        x -= change
        if abs(change) <= 1e-15 * x:
            break
    a = 0.5 * width / x
    begin = math.atanh(rise / length) - x
    steep = math.sinh(begin) + s / a
    return a * (np.arcsinh(steep) - begin), a * (np.hypot(1.0, steep) - math.cosh(begin)), steep


def nodes_of(line: Numbered, laid: Laid, at_line: int) -> list[Node]:
    """Nodes between the ends of a line; they hold their material."""
    held, follows = (False,) * (line.kind - 1) + (True,), (0,) * line.kind
    kind: Any = line.kind
    places = map(tuple, laid.place[1:-1].tolist())
    slopes = map(tuple, laid.slope[1:-1].tolist()) if kind == 7 else [None] * len(line.between)
    return [
        Node(id, kind, place, slope, None, held, follows, at_line, line.place)
        for id, place, slope in zip(line.between, places, slopes, strict=True)
    ]
