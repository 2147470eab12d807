"""Cubic Hermite shape functions on the unit interval, tabulated at the points of a quadrature.

``N = (H1, L H2, H3, L H4)`` interpolates position between (r1, r1', r2, r2'), r' being the slope with respect to the
material coordinate p and L = p2 - p1 (eqs 2.3-2.6, with x = s from 0 to 1).
"""

from __future__ import annotations

import numpy as np

WEIGHT, PLACE, SHAPE, FIRST, SECOND, THIRD = 0, 1, 2, 6, 10, 14
"""Columns of a table: weight, x, and from there on the four functions and their derivatives by x."""


def gauss(points: int) -> tuple[np.ndarray, np.ndarray]:
    """Places and weights of Gauss quadrature on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(points)
    return 0.5 * (x + 1.0), 0.5 * w


def lobatto() -> tuple[np.ndarray, np.ndarray]:
    """Places and weights of three-point Lobatto quadrature (Simpson's rule) on [0, 1]."""
    return np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6.0


def table(places: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Table (n, 18) of the shape functions and their derivatives at n places."""
    x, one = places, np.ones_like(places)
    columns = [
        weights, x,
        1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2,
        6 * x**2 - 6 * x, 1 - 4 * x + 3 * x**2, 6 * x - 6 * x**2, 3 * x**2 - 2 * x,
        12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2,
        12 * one, 6 * one, -12 * one, 6 * one,
    ]  # fmt: skip
    return np.ascontiguousarray(np.column_stack(columns), dtype=np.float64)
