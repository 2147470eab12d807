"""The string of the thesis' Table 2.3 without any mesh: the exact extensible rod, the linear beam, the hanging bar.

The rod is the extensible Euler-Bernoulli elastica (Antman, Nonlinear Problems of Elasticity, ch. 4) in the unstretched
arc length s from the pinned end, x along the string, y up, all SI:

    x' = (1 + e) cos(theta),  y' = (1 + e) sin(theta),  theta' = M/EI,
    M' = (1 + e) (H sin(theta) - V cos(theta)),  V' = rho A g,  e = (H cos(theta) + V sin(theta))/EA.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from scipy.integrate import solve_bvp

YOUNG, DENSITY, GRAVITY = 200e9, 7850.0, 9.81


class Tube(NamedTuple):
    """A section of the string: length, outer and inner diameter m, second moment m^4 as Table 2.3 prints it."""

    length: float
    od: float
    id: float
    second_moment: float

    @property
    def axial(self) -> float:
        """EA, N."""
        return YOUNG * self.area

    @property
    def bending(self) -> float:
        """EI, N m^2."""
        return YOUNG * self.second_moment

    @property
    def mass(self) -> float:
        """Mass per length, kg/m."""
        return DENSITY * self.area

    @property
    def area(self) -> float:
        """Steel, m^2."""
        return float(np.pi / 4 * (self.od**2 - self.id**2))


PIPE, COLLAR = Tube(880.0, 0.127, 0.1086, 0.0594e-4), Tube(120.0, 0.165, 0.0572, 0.3595e-4)
TUBES = (PIPE, COLLAR)
LENGTH = PIPE.length + COLLAR.length


class Case(NamedTuple):
    """A configuration of section 2.9.4.3: gravity m/s^2 and force at the end N."""

    gravity: float
    force: float


CASES = {"A": Case(9.81e-6, 0.0), "B": Case(9.81e-4, 0.0), "C": Case(9.81, 1.5e6)}


class Curve(NamedTuple):
    """A shape: unstretched arc length s from the pin, x along the string, y up, each (n,) m."""

    s: np.ndarray
    x: np.ndarray
    y: np.ndarray

    @property
    def sag(self) -> float:
        """Largest sag, m, negative."""
        return float(self.y.min())

    @property
    def end(self) -> float:
        """How far the end has moved along x, m."""
        return float(self.x[-1] - self.s[-1])


WHERE = np.unique(np.concatenate([np.linspace(0.0, PIPE.length, 3521), np.linspace(PIPE.length, LENGTH, 481)]))
"""Places at which curves are compared, m: every quarter of a metre."""


class Rod:
    """The rod in equilibrium; ``at(s)`` gives (x, y), m."""

    def __init__(self, case: Case, tolerance: float = 1e-8) -> None:
        self.case = case
        self.weight = case.gravity * sum(tube.mass * tube.length for tube in TUBES)
        mesh = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 301)))
        state = np.zeros((10, mesh.size))
        state[0], state[5] = mesh * PIPE.length / LENGTH, (PIPE.length + mesh * COLLAR.length) / LENGTH
        for share in (0.02, 0.1, 0.3, 1.0):
            limit = tolerance if share == 1.0 else 1e-4
            found = solve_bvp(functools.partial(self._slopes, share), _ends, mesh, state, tol=limit, max_nodes=100_000)
            if not found.success:
                raise RuntimeError(f"the exact rod was not found: {found.message}")
            mesh, state = found.x, found.y
        self.solution = found.sol

    def _slopes(self, share: float, _: np.ndarray, state: np.ndarray) -> np.ndarray:
        """Derivatives of both sections' (x, y, theta, curvature, V) by the share of the section.

        Lengths over that of the string, forces over its weight; the curvature is M over the pipe's EI.
        """
        load = share * self.weight
        stiff = load * LENGTH**2 / PIPE.bending
        rows = []
        for part, tube in zip((state[:5], state[5:]), TUBES, strict=True):
            _, _, theta, curvature, v = part
            h = self.case.force / self.weight
            stretch = 1.0 + load * (h * np.cos(theta) + v * np.sin(theta)) / tube.axial
            slopes = (
                stretch * np.cos(theta),
                stretch * np.sin(theta),
                curvature * PIPE.bending / tube.bending,
                stiff * stretch * (h * np.sin(theta) - v * np.cos(theta)),
                np.full_like(theta, tube.mass * self.case.gravity * LENGTH / self.weight),
            )
            rows += [slope * tube.length / LENGTH for slope in slopes]
        return np.vstack(rows)

    def at(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the points (n,) of unstretched arc length s are, m."""
        pipe = self.solution(np.minimum(s / PIPE.length, 1.0))[:2]
        collar = self.solution(np.maximum((s - PIPE.length) / COLLAR.length, 0.0))[5:7]
        x, y = LENGTH * np.where(s <= PIPE.length, pipe, collar)
        return x, y


def _ends(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Pinned at s = 0, held in y and free of moment at the end, all continuous where the pipe meets the collar."""
    return np.concatenate([first[[0, 1, 3]], last[:5] - first[5:], last[[6, 8]]])


@functools.cache
def rod(name: str) -> Rod:
    """The exact rod of a configuration."""
    return Rod(CASES[name])


@functools.cache
def exact(name: str) -> Curve:
    """Its shape at `WHERE`."""
    return Curve(WHERE, *rod(name).at(WHERE))


def linear(name: str) -> Curve:
    """The linear beam on two pins, closed form: EI y'' = M, and no force along it and no motion in x."""
    gravity = CASES[name].gravity
    loads = [t.mass * gravity for t in TUBES]
    middle = (0.5 * PIPE.length, PIPE.length + 0.5 * COLLAR.length)
    reaction = sum(w * t.length * (LENGTH - m) for w, t, m in zip(loads, TUBES, middle, strict=True)) / LENGTH
    moment, shear, slope, height = 0.0, reaction, 0.0, 0.0
    start, pieces = 0.0, []
    for load, tube in zip(loads, TUBES, strict=True):
        turn = Polynomial([moment, shear, -0.5 * load]) / tube.bending
        angle = turn.integ(k=slope)
        rise = angle.integ(k=height)
        pieces.append((start, rise))
        end = tube.length
        moment, shear = moment + shear * end - 0.5 * load * end**2, shear - load * end
        slope, height, start = float(angle(end)), float(rise(end)), start + end
    s = WHERE
    (_, first), (joint, second) = pieces
    y = np.where(s <= joint, first(s), second(s - joint)) - height * s / LENGTH
    return Curve(s, s, y)


def hanging(s: np.ndarray) -> np.ndarray:
    """How far the points (n,) of the string that hangs by s = 0 go down, m: linear elasticity, dry weight."""
    shift, start = np.zeros_like(s), 0.0
    carried = GRAVITY * COLLAR.mass * COLLAR.length
    for tube, weight_below in zip(TUBES, (carried, 0.0), strict=True):
        load = GRAVITY * tube.mass
        z = np.clip(s - start, 0.0, tube.length)
        shift += (weight_below * z + load * (tube.length * z - 0.5 * z**2)) / tube.axial
        start += tube.length
    return shift
