"""The string as it is drawn: a smooth curve through its lumps, across the hole by a factor, in either view."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from drillstring.view.course import Course

POINTS, LEAST = 480, 4
"""Points of a string, about, and the fewest of one link."""
STEP_IN = 0.01
"""Share of a link over which its diameter becomes that of the link above, where sections meet."""

LEVEL = 1.0e-3
"""Departure over depth below which a hole departs in no direction to speak of."""


class Blend(NamedTuple):
    """Values at points between two neighbours of a row: number of the first, and the share of the second."""

    first: np.ndarray
    share: np.ndarray

    def of(self, values: np.ndarray) -> np.ndarray:
        """Values (n,) at the points, (m,)."""
        second = np.minimum(self.first + 1, values.size - 1)
        return values[self.first] + self.share * (values[second] - values[self.first])


class Drawn:
    """Points of a string and its hole in a picture.

    Parameters
    ----------
    course : Course
    factor : float
        On everything across the hole.
    unrolled : bool
        Whether the hole is straightened: x and y are the offsets on m2 and m1, and z is less the measured depth.

    Attributes
    ----------
    link, tube : (m,) array of int
        Link that each of the string's points lies on, and the one whose diameter it has: of two the lower, and the
        upper one.
    nodes : (n + 1,) array of int
        Points that are lumps.
    lumps, halves : Blend
        Values at the points of what is known at lumps, and of what is known at lumps and middles of links in turn.
    """

    def __init__(self, course: Course, factor: float, unrolled: bool) -> None:
        self.course, self.factor, self.unrolled = course, factor, unrolled
        self._values = np.concatenate([course.depth[..., None], course.lateral], axis=-1)
        self._slopes = course.slopes()
        self.link, share, self.nodes = _spread(course.section)
        self.tube = np.where(share > 0.0, self.link, np.maximum(self.link - 1, 0))
        self.lumps = Blend(self.link, share)
        length = np.diff(course.rest)[self.link]
        lower = share > 0.5
        self.halves = Blend(2 * self.link + lower, 2.0 * share - lower)
        t = share[:, None]
        # The cubic's values and slopes at both ends, over the unstretched length.
        self._shape = (
            (1.0 + 2.0 * t) * (1.0 - t) ** 2, t * (1.0 - t) ** 2 * length[:, None],
            t**2 * (3.0 - 2.0 * t), t**2 * (t - 1.0) * length[:, None],
        )  # fmt: skip

    def points(self, frame: int) -> np.ndarray:
        """Points of the string, (m, 3) m."""
        return self.place(*self._along(frame, slice(None)).T)

    def place(self, s: Any, u: Any, v: Any) -> np.ndarray:
        """Points, (..., 3) m, at measured depths and offsets, m; the offsets are drawn by the factor larger."""
        if self.unrolled:
            return np.stack(np.broadcast_arrays(self.factor * v, self.factor * u, np.negative(s)), axis=-1)
        return turned_over(self.course.well.point(s, self.factor * u, self.factor * v))

    def axes(self, s: Any) -> np.ndarray:
        """Bishop frame at measured depths, (..., 3, 3): its columns are m1, m2, and down the hole."""
        if self.unrolled:
            return np.broadcast_to([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]], (*np.shape(s), 3, 3))
        return np.stack([turned_over(side) for side in self.course.well.frame(s)], axis=-1)

    @property
    def eye(self) -> tuple[float, float, float]:
        """Direction to an eye that sees the hole depart to the right; unrolled, its low side there."""
        course = self.course
        if self.unrolled:
            right, least = course.downwards(course.path).mean(axis=0)[::-1], LEVEL
        else:
            ends = turned_over(course.well.position(course.path))[:, :2]
            right = ends[np.argmax(np.hypot(*(ends - ends[0]).T))] - ends[0]
            least = LEVEL * course.deepest
        length = float(np.hypot(*right))
        x, y = right / length if length > least else (1.0, 0.0)
        if not course.upright:
            # From straight beside it: what is level shall look level.
            return (float(y), float(-x), 0.0)
        # A little from its right and from above, so that one sees that things are round.
        return (float(y + 0.25 * x), float(-x + 0.25 * y), 0.25)

    @property
    def right(self) -> np.ndarray:
        """Level unit vector to the right of the picture, (3,)."""
        x, y, _ = self.eye
        return np.array([-y, x, 0.0]) / np.hypot(x, y)

    def end(self, frame: int) -> tuple[np.ndarray, np.ndarray]:
        """Place of the lower end, (3,) m, and axes (3, 3) that stand in the string there: the last one down it."""
        last = self._along(frame, slice(-2, None))
        above, end = self.place(*last.T)
        x, y, down = self.axes(last[1, 0]).T
        way = end - above
        size = float(np.linalg.norm(way))
        z = way / size if size > 0.0 else down
        side = x if abs(x @ z) < 0.9 else y
        side = side - (side @ z) * z
        side /= np.linalg.norm(side)
        across = np.cross(z, side)
        return end, np.column_stack([side, across, z])

    def _along(self, frame: int, which: slice) -> np.ndarray:
        """Measured depth and offsets at points of the string, (m, 3) m."""
        value, slope = self._values[frame], self._slopes[frame]
        i = self.link[which]
        a, b, c, d = (shape[which] for shape in self._shape)
        return a * value[i] + b * slope[i] + c * value[i + 1] + d * slope[i + 1]


def turned_over(vectors: np.ndarray) -> np.ndarray:
    """North, east, down as x, y, z with z up: east, north, -down."""
    return np.stack([vectors[..., 1], vectors[..., 0], -vectors[..., 2]], axis=-1)


def _spread(section: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Link and share of it of every point, and the points that are lumps."""
    each = max(LEAST, -(-POINTS // section.size))
    even = np.arange(each) / each
    stepped = np.concatenate([[0.0, STEP_IN], even[1:]])
    changes = np.append(False, section[1:] != section[:-1])
    shares = [stepped if change else even for change in changes]
    link = np.repeat(np.arange(section.size), [share.size for share in shares])
    nodes = np.append(np.searchsorted(link, np.arange(section.size)), link.size)
    return np.append(link, section.size - 1), np.append(np.concatenate(shares), 1.0), nodes
