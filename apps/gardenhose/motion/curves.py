"""Curves through what a run stores: the tip's path between frames, the hose between nodes, and planes to draw in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

ITERATIONS = 16
"""Of the search for a passage, which gains digits as a secant's does."""


class Trace:
    """A signal between its frames: the polynomial of degree seven through value and rate at the four frames around.

    At 20 frames a period it misses a sine by 1e-9 of its amplitude; a cubic between two frames misses it by 3e-5.

    Parameters
    ----------
    time : (m,) array
        Rising, s.
    value, rate : (m,) or (m, d) array
        The signal and its derivative by time; m >= 1.
    """

    def __init__(self, time: np.ndarray, value: np.ndarray, rate: np.ndarray) -> None:
        self.time, self.value, self.rate = time, value, rate
        if len(time) < 2:
            return
        frames = min(4, len(time))
        first = np.clip(np.arange(len(time) - 1) - 1, 0, len(time) - frames)
        around = np.repeat(first[:, None] + np.arange(frames), 2, axis=1)
        self._step = np.diff(time)
        place = (time[around] - time[:-1, None]) / self._step[:, None]
        shape = (-1, 1) if value.ndim > 1 else (-1,)
        table = value[around]
        rates = rate[around] * self._step.reshape(-1, 1, *shape[1:])
        self._place, self._coefficients = place, [table[:, 0]]
        for order in range(1, 2 * frames):
            apart = (place[:, order:] - place[:, :-order]).reshape(*table[:, 1:].shape[:2], *shape[1:])
            # Every frame stands twice in the table: between its copies the first difference is the rate.
            same = apart == 0.0
            slope = np.diff(table, axis=1) / np.where(same, 1.0, apart)
            table = np.where(same, rates[:, :-1], slope) if order == 1 else slope
            self._coefficients.append(table[:, 0])

    def __call__(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value and rate at any times (n,), each (n,) or (n, d); outside the frames, the nearest polynomial."""
        if len(self.time) < 2:
            shape = (len(time), *self.value.shape[1:])
            return np.broadcast_to(self.value[0], shape), np.broadcast_to(self.rate[0], shape)
        at = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2)
        tail = (-1,) + (1,) * (self.value.ndim - 1)
        step = self._step[at].reshape(tail)
        x = ((time - self.time[at]) / self._step[at]).reshape(tail)
        value, slope = self._coefficients[-1][at], np.zeros_like(self._coefficients[-1][at])
        for order in range(len(self._coefficients) - 2, -1, -1):
            away = x - self._place[at, order].reshape(tail)
            slope = slope * away + value
            value = value * away + self._coefficients[order][at]
        return value, slope / step

    def root(self, low: np.ndarray, high: np.ndarray, level: Any = 0.0, rate: bool = False) -> np.ndarray:
        """Times between low and high, (n,) each, at which a single signal, or its rate, passes a level."""
        below, above = (self(time)[int(rate)] - level for time in (low, high))
        # The Illinois rule: a secant, whose weight halves at the end that stays where it is twice.
        stayed = np.zeros(np.shape(low))
        for _ in range(ITERATIONS):
            span = above - below
            share = np.where(span != 0.0, -below / np.where(span != 0.0, span, 1.0), 0.5)
            middle = low + np.clip(share, 0.0, 1.0) * (high - low)
            left = self(middle)[int(rate)] - level
            beyond = left * above > 0.0
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
            side = np.where(beyond, 1.0, -1.0)
            weight = np.where(stayed == side, 0.5, 1.0)
            below, above = np.where(beyond, weight * below, left), np.where(beyond, left, weight * above)
            stayed = side
            if not np.any(left):
                break
        return middle

    def extrema(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of all local extremes of a single signal."""
        before, after = self.rate[:-1], self.rate[1:]
        at = np.flatnonzero(((before > 0) & (after <= 0)) | ((before < 0) & (after >= 0)))
        if at.size == 0:
            return np.zeros(0), np.zeros(0)
        time = self.root(self.time[at], self.time[at + 1], rate=True)
        return time, self(time)[0]


def directions(points: np.ndarray) -> np.ndarray:
    """Unit vectors of largest, middle and least extent of points (n, 3) about the origin, (3, 3), one a row.

    The largest component of each is positive.
    """
    size = np.abs(points).max()
    if not size > 0.0:
        return np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    values, vectors = np.linalg.eigh((points / size).T @ (points / size))
    largest, middle, least = vectors[:, ::-1].T
    if values[1] <= 1e-20 * values[2]:
        # Points on a line lie in many planes: that with the axis it leans to least is as good as any.
        least = np.cross(largest, np.eye(3)[np.argmin(np.abs(largest))])
        least /= np.linalg.norm(least)
        middle = np.cross(least, largest)
    return np.array([axis * np.copysign(1.0, axis[np.abs(axis).argmax()]) for axis in (largest, middle, least)])


class Plane(NamedTuple):
    """A plane to draw in."""

    across: np.ndarray
    """Unit vector to the right, (3,)."""
    up: np.ndarray
    """Unit vector upwards, (3,)."""

    def __call__(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Components of points (..., 3) to the right and upwards, (...) each."""
        return points @ self.across, points @ self.up


def plane_of(points: np.ndarray, towards: np.ndarray | None = None) -> Plane:
    """The plane that points lie in, or nearly so: upright, with z upwards, where it can be.

    A coordinate plane is taken exactly if the points are within a degree or so of it. Points on a line, or close to
    one, are drawn in the upright plane through it.

    Parameters
    ----------
    points : (n, 3) array
        Such as the nodes at many times.
    towards : (3,) array, optional
        What should point to the right rather than to the left, such as the vector from root to tip.
    """
    motion = points.reshape(-1, 3) - points.reshape(-1, 3).mean(axis=0)
    along, second, normal = directions(motion)
    z = np.array([0.0, 0.0, 1.0])
    if np.abs(motion @ second).max() < 1e-6 * max(np.abs(motion @ along).max(), np.finfo(float).tiny):
        side = np.cross(along, z)
        normal = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([0.0, 1.0, 0.0])
    normal = snapped(normal)
    up = z - (z @ normal) * normal
    if np.linalg.norm(up) < 0.05:
        up = np.array([0.0, 1.0, 0.0]) - normal[1] * normal
    up /= np.linalg.norm(up)
    across = np.cross(up, normal)
    towards = motion[-1] - motion[0] if towards is None else towards
    reach = towards @ across
    # What stands upright may go either way: then as the axes do.
    sign = reach if abs(reach) > 1e-3 * np.linalg.norm(towards) else across[np.abs(across).argmax()]
    return Plane(snapped(across * np.copysign(1.0, sign)), snapped(up))


def snapped(direction: np.ndarray, within: float = 0.02) -> np.ndarray:
    """A unit vector, or the axis that it all but is: what is off it is less than `within`."""
    largest = int(np.abs(direction).argmax())
    axis = np.zeros(3)
    axis[largest] = np.copysign(1.0, direction[largest])
    return axis if np.linalg.norm(direction - axis) < within else direction


def name_of(direction: np.ndarray) -> str:
    """Name of a direction: ``x``, ``−z``, ``along (0.71, 0, 0.71)``."""
    largest = int(np.abs(direction).argmax())
    if abs(direction[largest]) > 1.0 - 1e-9:
        return ("−" if direction[largest] < 0.0 else "") + "xyz"[largest]
    return "along (" + ", ".join(f"{part + 0.0:.2g}" for part in np.round(direction, 2)) + ")"


def shape_of(position: np.ndarray, slope: np.ndarray, arc_length: np.ndarray, points: int = 12) -> np.ndarray:
    """The hose as the cubic that its elements take it for.

    Parameters
    ----------
    position, slope : (..., nodes, 3) array
        m, and m per m of hose.
    arc_length : (nodes,) array
        Unstretched length from the root, m.
    points : int
        Steps in an element.

    Returns
    -------
    (..., (nodes - 1) points + 1, 3) array, m
    """
    x = (np.arange(points) / points)[:, None]
    length = np.diff(arc_length)[:, None, None]
    before, after = np.asarray(position)[..., :-1, None, :], np.asarray(position)[..., 1:, None, :]
    start, end = np.asarray(slope)[..., :-1, None, :], np.asarray(slope)[..., 1:, None, :]
    curve = (1 - 3 * x**2 + 2 * x**3) * before + (3 * x**2 - 2 * x**3) * after
    curve = curve + length * ((x - 2 * x**2 + x**3) * start + (x**3 - x**2) * end)
    flat = curve.reshape(*curve.shape[:-3], -1, 3)
    return np.concatenate([flat, np.asarray(position)[..., -1:, :]], axis=-2)


def spread(times: np.ndarray, start: float, end: float, count: int) -> Sequence[int]:
    """Indices of at most `count` frames between two times, evenly spread; the nearest one if there is none."""
    inside = np.flatnonzero((times >= start - 1e-12) & (times <= end + 1e-12))
    if inside.size == 0:
        inside = np.array([int(np.abs(times - end).argmin())])
    chosen: list[int] = np.unique(inside[np.linspace(0, inside.size - 1, min(count, inside.size)).round().astype(int)])
    return chosen
