"""What of a run is compared: the path of a point, the axial force in an element, and the twist of a string."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from tautline.results.errors import ResultError
from tautline.results.result import Result

POINTS = ("tip", "body_position", "position")
"""Variables that hold positions, the first that a result has: a hose's tip, a crane's bodies, nodes or lumps."""
FORCES = ("axial_force", "tension")
ENDS, END_NAMES = "end_force", ("start", "end")
"""The axial force at both ends of each element, and what these are called. The largest force that a run shows is one of
these or of a middle: of cubic elements, and of a load that comes at once, ends vary far more than middles do."""
VARIES_MORE = 1.0e-6
"""Share by which an end's force has to vary more than that of any middle: those of one strain vary alike."""
RESTING = 1.0e-9
"""Share of the scene's size below which a point has not moved, and of a force below which that has not varied."""
MOVES = 1.0e-3
"""Share of the largest motion from which the last point is the one to look at, and not the one between the ends that
moves most: an end may be held, or led by what moves it."""

TWIST = 0.05
"""Twist of a string, rad, from which it is looked at: by so much it has to vary."""
OF_STRING = "twist of the string"
"""What this is called in a sentence."""


class Place(NamedTuple):
    """Where in a result: a variable and, where it has more than one, which: its label, and its number of so many.

    In a mesh that is divided evenly the place is as far along as it was, between two elements if need be; in any other
    it is what has the label. ``end`` is that of an element, 0 or 1; None where the variable has no ends.
    """

    variable: str
    label: str
    number: int
    count: int
    end: int | None = None

    def __str__(self) -> str:
        of_end = "" if self.end is None else f", {END_NAMES[self.end]}"
        return f"{self.variable.replace('_', ' ')} {self.label}".strip() + of_end

    @property
    def column(self) -> int:
        """Which of `forces` this is, of a mesh of its own."""
        return self.number if self.end is None else (1 + self.end) * self.count + self.number


class History(NamedTuple):
    """Time (m,) s, position (m, 3) m, axial force (m,) N, twist of a string (m,) rad; empty where a scene has none."""

    time: np.ndarray
    position: np.ndarray
    force: np.ndarray
    twist: np.ndarray = np.zeros(0)


class Watched(NamedTuple):
    """The point and the force that a study looks at, the size of the scene, m, and whether point or twist moves.

    `point_said`, `force_said` and `twist_said` are as a sentence has them: ``position of payload``; empty where there
    is none. The twist is that between both ends of a string. `rests` is whether the point does not move: a string may
    turn in place.
    """

    point: Place
    force: Place | None
    extent: float
    moves: bool
    point_said: str
    force_said: str
    twist_said: str = ""
    rests: bool = False

    def of(self, result: Result) -> History:
        """The history of a run of the scene, or of a variant of it."""
        position = _at(result, self.point, 2)
        force = np.zeros(0) if self.force is None else _at(result, self.force, 1)
        return History(np.asarray(result.time, float), position, force, _twist(result))


def watch(result: Result, point: str | None = None) -> Watched:
    """Choose what to look at: the far end, or what moves most where that is held, and the force that varies most.

    A hose's tip that is held gives way to the hose's nodes. Of a string that turns the twist is looked at as well: what
    sticks and slips turns while it hardly moves.

    Parameters
    ----------
    result : Result
        A run of the scene.
    point : str or None
        Label of a node, a lump or a body, if the user has chosen one.

    Raises
    ------
    ResultError
        If nothing has that label, or the result holds no positions.
    """
    there = [name for name in POINTS if name in result]
    if not there:
        raise ResultError("study", "the scene's result holds no positions", "study a scene that moves in space")
    extent = float(max(np.ptp(result[name].reshape(-1, 3), axis=0).max() for name in there))
    chosen = _named(result, point) if point is not None else _far_end(result, there)
    way = _ways(_at(result, chosen, 2)).max()
    force = _force(result)
    moved, turned = bool(way > RESTING * extent), twists(_twist(result))
    said = _name_of(result, chosen), _name_of(result, force), OF_STRING if turned else ""
    return Watched(chosen, force, extent, moved or turned, *said, rests=not moved)


def twists(twist: np.ndarray) -> bool:
    """Whether a twist (m,) rad varies so much that it is looked at."""
    return bool(twist.size) and float(np.ptp(twist)) > TWIST


def _twist(result: Result) -> np.ndarray:
    """By how much the far end of a string is turned against the first (m,) rad; empty for what has no torque."""
    if "torque" not in result or "rotation" not in result or result["rotation"].ndim != 2:
        return np.zeros(0)
    rotation = np.asarray(result["rotation"], float)
    return rotation[:, -1] - rotation[:, 0]


def _name_of(result: Result, place: Place | None) -> str:
    """A place as a sentence has it: ``position of payload``, ``axial force of element 1``, or by the result's name."""
    if place is None:
        return ""
    dims, what = result.variables[place.variable].dims, place.variable.replace("_", " ")
    if len(dims) > 1 and f"{dims[1]}_name" in result:
        return f"{what} of {result[f'{dims[1]}_name'][place.number]}"
    if not place.label:
        return what
    kind = dims[1].replace("_", " ")
    # A number tells nothing without what it counts; a name of the scene needs no more.
    of = f"{kind} {place.label}" if place.label[0].isdigit() else place.label
    if place.end is not None:
        return f"axial force at the {END_NAMES[place.end]} of {of}"
    return f"{what.removeprefix(f'{kind} ')} of {of}"


def _ways(position: np.ndarray) -> np.ndarray:
    """Largest distance of points from where they begin, m."""
    return np.linalg.norm(position - position[0], axis=-1).max(axis=0)


def _far_end(result: Result, there: list[str]) -> Place:
    variable = there[0]
    most = max(float(_ways(result[name]).max(initial=0.0)) for name in there)
    if len(there) > 1 and result[variable].ndim == 2 and _ways(result[variable]) < MOVES * most:
        variable = there[1]
    if result[variable].ndim == 2:
        return Place(variable, "", 0, 1)
    moved = _ways(result[variable])
    inner = moved[1:-1] if moved.size > 2 else moved
    chosen = int(inner.argmax()) + (moved.size > 2)
    if moved[-1] >= MOVES * moved.max() or variable == "body_position":
        chosen = moved.size - 1 if variable != "body_position" else int(moved.argmax())
    return _place(result, variable, chosen, moved.size)


def forces(result: Result) -> np.ndarray:
    """All forces (m, n) N that one may be looked at of: those of middles, of starts and of ends; of cranes tensions."""
    variable = _force_variable(result)
    if variable is None:
        return np.zeros((0, 0))
    middles = np.asarray(result[variable], float)
    if not _has_ends(result, variable):
        return middles
    ends = np.asarray(result[ENDS], float)
    return np.concatenate([middles, ends[:, :, 0], ends[:, :, 1]], axis=1)


def _force_variable(result: Result) -> str | None:
    there = (name for name in FORCES if name in result)
    return next((name for name in there if result[name].ndim == 2 and result[name].shape[1]), None)


def _has_ends(result: Result, variable: str) -> bool:
    return variable == FORCES[0] and ENDS in result


def _force(result: Result) -> Place | None:
    """The force that varies most; an end's where that varies more than those of all middles."""
    variable = _force_variable(result)
    if variable is None:
        return None
    count = result[variable].shape[1]
    varies = np.ptp(forces(result), axis=0)
    chosen = int(varies[:count].argmax())
    most = int(varies.argmax())
    if varies[most] <= (1.0 + VARIES_MORE) * varies[chosen]:
        return _place(result, variable, chosen, count)
    end, number = divmod(most - count, count)
    return _place(result, variable, number, count)._replace(variable=ENDS, end=end)


def _place(result: Result, variable: str, index: int, count: int) -> Place:
    return Place(variable, _labels(result, variable, count)[index], index, count)


def _labels(result: Result, variable: str, count: int) -> list[str]:
    """Labels along a variable's second dimension: its coordinate, or numbers from one."""
    dims = result.variables[variable].dims
    if len(dims) > 1 and dims[1] in result:
        labels: Any = result[dims[1]]
        return [f"{x:g}" if isinstance(x, (float, np.floating)) else str(x) for x in labels]
    return [str(i + 1) for i in range(count)]


def _named(result: Result, label: str) -> Place:
    known: list[str] = []
    for variable in POINTS:
        if variable in result and result[variable].ndim == 3:
            count = result[variable].shape[1]
            labels = _labels(result, variable, count)
            if label in labels:
                return _place(result, variable, labels.index(label), count)
            known += labels
    few = ", ".join(known[:12]) + (" ..." if len(known) > 12 else "")
    raise ResultError("--point", f"nothing is called '{label}'", f"give one of {few}" if known else "leave it out")


def _at(result: Result, place: Place, dimensions: int) -> np.ndarray:
    values = np.asarray(result[place.variable], float)
    if place.end is not None:
        return _at_end(values[:, :, place.end], place, result)
    if values.ndim == dimensions:
        return values
    count = values.shape[1]
    nodes = dimensions == 2
    even = (count - 1) % max(1, place.count - 1) == 0 if nodes else count % place.count == 0
    even = even or ((place.count - 1) % max(1, count - 1) == 0 if nodes else place.count % count == 0)
    labels = _labels(result, place.variable, count)
    if count == place.count:
        return values[:, place.number]
    if not even and place.label in labels and 0 < place.number < place.count - 1:
        return values[:, labels.index(place.label)]
    if nodes:
        index = place.number * (count - 1) / max(1, place.count - 1)
    else:
        index = (place.number + 0.5) * count / place.count - 0.5
    return _between(values, min(max(index, 0.0), count - 1.0))


def _at_end(values: np.ndarray, place: Place, result: Result) -> np.ndarray:
    """The force (m,) at an end of an element that is as far along in another mesh; all values (m, count) are given."""
    assert place.end is not None
    count, outermost = values.shape[1], (place.count - 1) * place.end
    labels = _labels(result, place.variable, count)
    even = count % place.count == 0 or place.count % count == 0
    if count != place.count and not even and place.label in labels and place.number != outermost:
        return values[:, labels.index(place.label)]
    index = (place.number + place.end) * count / place.count - place.end
    return _between(values, min(max(index, 0.0), count - 1.0))


def _between(values: np.ndarray, index: float) -> np.ndarray:
    """Values at a place between two of the second dimension."""
    low = min(int(index), values.shape[1] - 1)
    part = index - low
    return values[:, low] if part < 1e-9 else (1.0 - part) * values[:, low] + part * values[:, low + 1]
