"""The nominal curve of a well: circular arcs, carried with a frame that does not turn about the tangent.

Measured depth s runs down the hole from the rotary table. The Bishop frame (m1, m2, t), right-handed, obeys

    t' = k1 m1 + k2 m2,    m1' = -k1 t,    m2' = -k2 t,

and (k1, k2) is constant on a circular arc. Starting from s0 with K = k1 m1 + k2 m2 taken at s0, the equations have
the closed solution, with d = s - s0, k = |K|, A = sin(k d)/k and B = (1 - cos(k d))/k**2,

    r = r0 + A t0 + B K,    t = cos(k d) t0 + A K,    m_a = m_a0 - k_a (r - r0),

which needs no division by k and so holds on straight hole too. A Frenet frame would be undefined there and would
jump wherever the plane of the dogleg changes.

Coordinates are north, east, down, with the rotary table as origin. In a vertical start m1 is north and m2 east; an
inclined start carries that frame along the dogleg from the vertical.

The stations' directions are joined by minimum curvature, as in J. E. Sawaryn and J. L. Thorogood, "A compendium of
directional calculations based on the minimum curvature method", SPE Drilling & Completion 20(1), 2005. wellpathpy
(LGPL-3.0) does that too and serves as a reference in the tests, but it returns positions at the stations only: the
arcs, the frame and the points in between would still be ours, so it is not a dependency.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from drillstring.well.sections import (
    EAST,
    NORTH,
    Build,
    Hold,
    Piece,
    Section,
    Turn,
    Vector,
    WellboreError,
    check_finite,
    check_inclination,
    direction,
    direction_angles,
    dogleg,
    drill,
    rise,
)

__all__ = ["Build", "Hold", "Section", "Turn", "Wellbore", "WellboreError", "from_sections", "from_survey"]

LARGEST_DOGLEG = math.radians(179.0)
"""Doglegs [rad] beyond this are refused: opposite directions do not say in which plane the hole turned round."""


@dataclass(frozen=True, eq=False)
class Wellbore:
    """A curve of n arcs of constant curvature components, with its Bishop frame.

    Above s = 0 the hole goes on straight along its first direction; beyond the end the last arc goes on with the
    same curvature. Treat the arrays as read-only: they are plain contiguous float64 because compiled code takes them.

    Attributes
    ----------
    md : (n + 1,) array
        Measured depth of each arc's start and of the end [m]; md[0] = 0.
    k1, k2 : (n,) arrays
        Components of the curvature on m1 and m2, one over the radius [1/m].
    phi1, phi2 : (n + 1,) arrays
        Cumulative turning, the integrals of k1 and k2 from the rotary table [rad], at md.
    positions : (n + 1, 3) array
        North, east, down at md [m].
    m1s, m2s, tangents : (n + 1, 3) arrays
        Unit vectors of the frame at md.
    """

    md: np.ndarray
    k1: np.ndarray
    k2: np.ndarray
    phi1: np.ndarray
    phi2: np.ndarray
    positions: np.ndarray
    m1s: np.ndarray
    m2s: np.ndarray
    tangents: np.ndarray

    @property
    def length(self) -> float:
        """Measured depth of the end [m]."""
        return float(self.md[-1])

    def arc(self, s) -> np.ndarray:
        """Index of the arc that holds s [m], of s' shape; the first above the hole, the last beyond its end.

        At the joint of two arcs it is the lower one.
        """
        return np.clip(np.searchsorted(self.md, s, side="right") - 1, 0, len(self.k1) - 1)

    def _local(self, s) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Arc, depth into the arc [m] and curvature components [1/m] at s."""
        s = np.asarray(s, dtype=float)
        i = self.arc(s)
        above = s < 0.0
        return i, s - self.md[i], np.where(above, 0.0, self.k1[i]), np.where(above, 0.0, self.k2[i])

    def curvature(self, s) -> tuple[np.ndarray, np.ndarray]:
        """Curvature components k1, k2 [1/m] at measured depth s [m], each of s' shape."""
        _, _, k1, k2 = self._local(s)
        return k1, k2

    def turning(self, s) -> tuple[np.ndarray, np.ndarray]:
        """Cumulative turning [rad] from the rotary table to s [m]: piecewise linear, zero above the table."""
        i, d, k1, k2 = self._local(s)
        return self.phi1[i] + k1 * d, self.phi2[i] + k2 * d

    def _carried(self, s) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Position [m], m1, m2 and t at s, each of shape s.shape + (3,)."""
        i, d, k1, k2 = self._local(s)
        r, m1, m2, t = self.positions[i], self.m1s[i], self.m2s[i], self.tangents[i]
        return _along_arc(r, m1, m2, t, k1[..., None], k2[..., None], d[..., None])

    def frame(self, s) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Unit vectors m1, m2 and t (downhole) at s [m], each of shape s.shape + (3,), in north, east, down."""
        return self._carried(s)[1:]

    def position(self, s) -> np.ndarray:
        """North, east, down [m] of the curve at s [m], shape s.shape + (3,)."""
        return self._carried(s)[0]

    def point(self, s, u, v) -> np.ndarray:
        """North, east, down [m] of the point u m1 + v m2 [m] off the curve at s [m]; s, u, v broadcast."""
        s, u, v = np.broadcast_arrays(s, u, v)
        r, m1, m2, _ = self._carried(s)
        return r + u[..., None] * m1 + v[..., None] * m2

    def tvd(self, s) -> np.ndarray:
        """True vertical depth [m] below the rotary table at s [m]."""
        return self.position(s)[..., 2]

    def level(self) -> np.ndarray:
        """Measured depths [m] at which the hole is level, (m,): where it turns from going down to going up, or back.

        Along an arc of curvature k the tangent's part downwards is t_z cos(k d) + n_z sin(k d), n being its normal.
        """
        curvature = np.hypot(self.k1, self.k2)
        bent = np.flatnonzero(curvature > 0.0)
        k, length = curvature[bent], np.diff(self.md)[bent]
        normal = (self.k1 * self.m1s[:-1, 2] + self.k2 * self.m2s[:-1, 2])[bent] / k
        first = np.arctan2(-self.tangents[bent, 2], normal) % np.pi
        places = [self.md[bent] + turn / k for turn in (first, first + np.pi)]
        inside = [turn <= k * length for turn in (first, first + np.pi)]
        return np.sort(np.concatenate([place[within] for place, within in zip(places, inside, strict=True)]))

    def inclination(self, s) -> np.ndarray:
        """Angle of the hole from the downward vertical [rad], 0 to pi, at s [m]."""
        return direction_angles(self.frame(s)[2])[0]

    def azimuth(self, s) -> np.ndarray:
        """Azimuth of the hole clockwise from north [rad], 0 to 2 pi, at s [m]; 0 where the hole is vertical."""
        return direction_angles(self.frame(s)[2])[1]


def from_sections(sections: Sequence[Section], inclination: float = 0.0, azimuth: float = 0.0) -> Wellbore:
    """Well of straight, building and turning sections, from the rotary table down.

    Sections of no length (a build to the present inclination, say) are dropped.

    Parameters
    ----------
    sections : sequence of Hold, Build, Turn
        Lengths and radii in m, angles in rad.
    inclination, azimuth : float
        Direction of the hole at the rotary table [rad].

    Returns
    -------
    Wellbore

    Raises
    ------
    WellboreError
        A length or radius that is not positive, an inclination outside 0 to pi, a build off the present azimuth, a
        turn of a vertical hole or by half a circle, no sections, no length. `index` is the section's number.
    """
    check_inclination(inclination, "inclination", None)
    check_finite(azimuth, "azimuth", None)
    pieces: list[Piece] = []
    heading = (float(inclination), float(azimuth))
    for index, section in enumerate(sections):
        added, heading = drill(section, index, *heading)
        pieces += added
    if not pieces:
        raise WellboreError("the well has no length", "give at least one section with a length above zero")
    return _assemble(inclination, azimuth, pieces)


def from_survey(md, inc, azi) -> Wellbore:
    """Well through the stations of a survey by minimum curvature: one arc to an interval.

    If the first station lies below the rotary table, the hole above it is taken as straight, along the station's
    direction. The azimuth of a vertical station plays no part.

    Parameters
    ----------
    md : (n,) array_like
        Measured depths [m], rising, the first not negative; n >= 2, or n = 1 with a depth above zero.
    inc, azi : (n,) array_like
        Inclination and azimuth [rad]; any number of whole turns may be added to an azimuth.

    Returns
    -------
    Wellbore

    Raises
    ------
    WellboreError
        Arrays of unequal length or not finite, depths that do not rise, an inclination outside 0 to pi, a dogleg of
        more than 179 degrees between two stations. `index` is the lower station's number.
    """
    md, inc, azi = (np.atleast_1d(np.asarray(x, dtype=float)) for x in (md, inc, azi))
    _check_stations(md, inc, azi)
    tangents = direction(inc, azi)
    if md[0] > 0.0:
        md, tangents = np.concatenate([[0.0], md]), np.concatenate([tangents[:1], tangents])
    upper, lower = tangents[:-1], tangents[1:]
    angle = dogleg(upper, lower)
    # The arc leaves along `upper`; its normal is what of (lower - upper) stands square to that. The difference keeps
    # its digits where the dogleg is tiny, and the projection is as good there as anywhere.
    normal = (lower - upper) - np.sum((lower - upper) * upper, axis=1, keepdims=True) * upper
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0.0)
    lengths = np.diff(md)
    bends = (angle / lengths)[:, None] * normal
    return _assemble(inc[0], azi[0], zip(lengths.tolist(), bends.tolist(), lower.tolist(), strict=True))


def _along_arc(r0, m1, m2, t, k1, k2, d):
    """Position and frame at depth d [m] into an arc; all arguments broadcast against (..., 3)."""
    angle = np.hypot(k1, k2) * d
    a = d * np.sinc(angle / np.pi)  # sin(k d) / k
    b = 0.5 * (d * np.sinc(0.5 * angle / np.pi)) ** 2  # (1 - cos(k d)) / k**2, without cancellation
    bend = k1 * m1 + k2 * m2
    step = a * t + b * bend
    return r0 + step, m1 - k1 * step, m2 - k2 * step, np.cos(angle) * t + a * bend


def _assemble(inclination: float, azimuth: float, pieces: Iterable[Piece]) -> Wellbore:
    """Carry the frame down the pieces and keep it at every joint.

    Each frame follows from the one above, so this is a loop; it runs over plain numbers, because NumPy takes a hundred
    times as long for vectors of three, and surveys have up to a hundred thousand stations.
    """
    md, phi1, phi2 = 0.0, 0.0, 0.0
    r: Vector = (0.0, 0.0, 0.0)
    m1, m2, t = _first_frame(inclination, azimuth)
    joints, curvatures = [(md, phi1, phi2, *r, *m1, *m2, *t)], []
    for length, bend, end in pieces:
        k1, k2 = _dot(bend, m1), _dot(bend, m2)
        step = _step_along(m1, m2, t, k1, k2, length)
        r = (r[0] + step[0], r[1] + step[1], r[2] + step[2])
        # The end's direction is known exactly: squaring the frame to it keeps rounding from piling up over arcs.
        c0, c1, c2 = m1[0] - k1 * step[0], m1[1] - k1 * step[1], m1[2] - k1 * step[2]
        off = _dot((c0, c1, c2), end)
        t = t0, t1, t2 = end
        c0, c1, c2 = c0 - off * t0, c1 - off * t1, c2 - off * t2
        size = math.sqrt(c0 * c0 + c1 * c1 + c2 * c2)
        m1 = m10, m11, m12 = c0 / size, c1 / size, c2 / size
        m2 = (t1 * m12 - t2 * m11, t2 * m10 - t0 * m12, t0 * m11 - t1 * m10)
        md, phi1, phi2 = md + length, phi1 + k1 * length, phi2 + k2 * length
        joints.append((md, phi1, phi2, *r, *m1, *m2, *t))
        curvatures.append((k1, k2))
    table = np.array(joints)
    k = np.array(curvatures)
    scalars = (k[:, 0], k[:, 1], table[:, 1], table[:, 2])
    vectors = (table[:, 3:6], table[:, 6:9], table[:, 9:12], table[:, 12:15])
    return Wellbore(*(np.ascontiguousarray(part) for part in (table[:, 0], *scalars, *vectors)))


def _dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _step_along(m1: Vector, m2: Vector, t: Vector, k1: float, k2: float, d: float) -> Vector:
    """Way [m] from the start of an arc to depth d [m] into it: what `_along_arc` does, of one arc in plain numbers."""
    # Rounded as NumPy's hypot does, which `math.hypot` is not: both give the same curve to the last bit.
    angle = abs(complex(k1, k2)) * d
    a, b = d * _sinc(angle / math.pi), 0.5 * (d * _sinc(0.5 * angle / math.pi)) ** 2
    return (
        a * t[0] + b * (k1 * m1[0] + k2 * m2[0]),
        a * t[1] + b * (k1 * m1[1] + k2 * m2[1]),
        a * t[2] + b * (k1 * m1[2] + k2 * m2[2]),
    )


def _sinc(x: float) -> float:
    """sin(pi x) / (pi x), as `numpy.sinc`."""
    y = math.pi * x
    return math.sin(y) / y if y else 1.0


def _first_frame(inclination: float, azimuth: float) -> tuple[Vector, Vector, Vector]:
    """North, east, down turned about the level axis by the inclination: the frame carried along the dogleg."""
    axis = math.cos(azimuth) * EAST - math.sin(azimuth) * NORTH
    high = rise(inclination, azimuth)
    m1 = math.cos(azimuth) * high - math.sin(azimuth) * axis
    m2 = math.sin(azimuth) * high + math.cos(azimuth) * axis
    return m1.tolist(), m2.tolist(), direction(inclination, azimuth).tolist()


def _check_stations(md: np.ndarray, inc: np.ndarray, azi: np.ndarray) -> None:
    """Raise WellboreError at the first station that no arc can reach."""
    if not (md.ndim == 1 and md.shape == inc.shape == azi.shape):
        raise WellboreError("md, inc and azi have different lengths", "give one value of each for every station")
    for name, values in (("md", md), ("inc", inc), ("azi", azi)):
        for index in np.flatnonzero(~np.isfinite(values))[:1]:
            raise WellboreError(f"{name} is not a finite number at station {index}", "give a number", int(index))
    if md.size == 0 or md[-1] <= 0.0:
        raise WellboreError("the survey has no length", "give at least two stations at rising depths")
    if md[0] < 0.0:
        raise WellboreError(f"md = {md[0]:g} m lies above the rotary table", "measure depth from the table down", 0)
    for index in np.flatnonzero(np.diff(md) <= 0.0)[:1] + 1:
        raise WellboreError(
            f"md = {md[index]:g} m at station {index} is not below the one before, {md[index - 1]:g} m",
            "sort the stations by measured depth and keep one at each depth",
            int(index),
        )
    for index in np.flatnonzero((inc < 0.0) | (inc > np.pi))[:1]:
        check_inclination(float(inc[index]), "inc", int(index))
    tangents = direction(inc, azi)
    for index in np.flatnonzero(dogleg(tangents[:-1], tangents[1:]) > LARGEST_DOGLEG)[:1] + 1:
        raise WellboreError(
            f"the hole turns right round between stations {index - 1} and {index}, md {md[index - 1]:g} to "
            f"{md[index]:g} m: its plane is not known",
            "add a station in between, or correct the angles",
            int(index),
        )
