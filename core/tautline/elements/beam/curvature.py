"""The square of the curvature of a curve r(p) with its derivatives by z = (r', r'').

kappa^2 = (a c - b^2) / a^3 with a = r'.r', b = r'.r'', c = r''.r''. It is smooth where the curve is straight; kappa
itself (eqs 2.55, 2.99-2.108) is not. Functions of e = r' and k = r'' take three numbers each, or three lanes of four
elements.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, store
from tautline.kernels.vector import dot

AXES = 3


@kernel(forceinline=True)
def products_of(e, k):
    """a, b and c."""
    return dot(e, e), dot(e, k), dot(k, k)


@kernel(forceinline=True)
def derivatives_of(a, b, c):
    """kappa^2, and its derivatives by a, b and c."""
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    return (a * c - b * b) * third, (3.0 * b * b - 2.0 * a * c) * third * inverse, -2.0 * b * third, inverse * inverse


@kernel(forceinline=True)
def second_derivatives_of(a, b, c):
    """Derivatives of kappa^2 by aa, ab, ac and bb; those by bc and cc are zero."""
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    by_aa = (6.0 * a * c - 12.0 * b * b) * third * inverse * inverse
    return by_aa, 6.0 * b * third * inverse, -2.0 * third, -2.0 * third


@kernel(forceinline=True)
def gradient_of(e, k, by_a, by_b, by_c):
    """d(kappa^2)/dr' and d(kappa^2)/dr'', with what :func:`derivatives_of` returned."""
    twice_a, twice_c = 2.0 * by_a, 2.0 * by_c
    by_e = (twice_a * e[0] + by_b * k[0], twice_a * e[1] + by_b * k[1], twice_a * e[2] + by_b * k[2])
    by_k = (by_b * e[0] + twice_c * k[0], by_b * e[1] + twice_c * k[1], by_b * e[2] + twice_c * k[2])
    return by_e, by_k


@kernel(forceinline=True)
def second_of(first, second, e, k, f, l, same):
    """Second derivatives of kappa^2 by (r'_i, r'_j), (r'_i, r''_j) and (r''_i, r''_j).

    ``first`` and ``second`` are the derivatives by a, b, c; (e, k) and (f, l) are r' and r'' along axes i and j, which
    are the ``same`` or not.
    """
    by_a, by_b, by_c = first
    by_aa, by_ab, by_ac, by_bb = second
    slopes = 4.0 * by_aa * e * f + 2.0 * by_ab * (e * l + k * f) + by_bb * k * l
    mixed = 2.0 * by_ab * e * f + 4.0 * by_ac * e * l + by_bb * k * f
    turns = by_bb * e * f
    if same:
        return slopes + 2.0 * by_a, mixed + by_b, turns + 2.0 * by_c
    return slopes, mixed, turns


@kernel
def square_of(z):
    """kappa^2 of z (6,)."""
    a, b, c = products_of((z[0], z[1], z[2]), (z[3], z[4], z[5]))
    return (a * c - b * b) / (a * a * a)


@kernel
def write_gradient(z, gradient):
    """Write d(kappa^2)/dz (6,); returns kappa^2."""
    e, k = (z[0], z[1], z[2]), (z[3], z[4], z[5])
    a, b, c = products_of(e, k)
    square, by_a, by_b, by_c = derivatives_of(a, b, c)
    by_e, by_k = gradient_of(e, k, by_a, by_b, by_c)
    gradient[0], gradient[1], gradient[2] = by_e
    gradient[3], gradient[4], gradient[5] = by_k
    return square


@kernel
def write_hessian(z, hessian):
    """Write the second derivatives (6, 6)."""
    a, b, c = products_of((z[0], z[1], z[2]), (z[3], z[4], z[5]))
    _, by_a, by_b, by_c = derivatives_of(a, b, c)
    first, second = (by_a, by_b, by_c), second_derivatives_of(a, b, c)
    for i in range(AXES):
        for j in range(AXES):
            slopes, mixed, turns = second_of(first, second, z[i], z[3 + i], z[j], z[3 + j], i == j)
            hessian[i, j] = slopes
            hessian[i, 3 + j] = mixed
            hessian[3 + j, i] = mixed
            hessian[3 + i, 3 + j] = turns


@kernel(forceinline=True)
def store_hessian(e, k, factor, four, at):
    """``factor`` times the same of four elements, (6, 6) lanes in memory from a place on; returns kappa^2."""
    a, b, c = products_of(e, k)
    square, by_a, by_b, by_c = derivatives_of(a, b, c)
    by_aa, by_ab, by_ac, by_bb = second_derivatives_of(a, b, c)
    first = factor * by_a, factor * by_b, factor * by_c
    second = factor * by_aa, factor * by_ab, factor * by_ac, factor * by_bb
    for i in range(AXES):
        for j in range(AXES):
            slopes, mixed, turns = second_of(first, second, e[i], k[i], e[j], k[j], i == j)
            store(four, at + (6 * i + j) * LANES, slopes)
            store(four, at + (6 * i + 3 + j) * LANES, mixed)
            store(four, at + (6 * (3 + j) + i) * LANES, mixed)
            store(four, at + (6 * (3 + i) + 3 + j) * LANES, turns)
    return square
