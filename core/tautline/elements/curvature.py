"""The square of the curvature of a curve r(p) with its derivatives by z = (r', r'').

kappa^2 = (a c - b^2) / a^3 with a = r'.r', b = r'.r'', c = r''.r''. It is smooth where the curve is straight; kappa
itself (eqs 2.55, 2.99-2.108) is not.
"""

from __future__ import annotations

from tautline.kernels.jit import kernel
from tautline.kernels.lanes import LANES, store

AXES = 3


@kernel
def square_of(z):
    """kappa^2 of z (6,)."""
    a = z[0] * z[0] + z[1] * z[1] + z[2] * z[2]
    b = z[0] * z[3] + z[1] * z[4] + z[2] * z[5]
    c = z[3] * z[3] + z[4] * z[4] + z[5] * z[5]
    return (a * c - b * b) / (a * a * a)


@kernel
def write_gradient(z, gradient):
    """Write d(kappa^2)/dz (6,); returns kappa^2."""
    a = z[0] * z[0] + z[1] * z[1] + z[2] * z[2]
    b = z[0] * z[3] + z[1] * z[4] + z[2] * z[5]
    c = z[3] * z[3] + z[4] * z[4] + z[5] * z[5]
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    by_a = 2.0 * (3.0 * b * b - 2.0 * a * c) * third * inverse
    by_b = -2.0 * b * third
    by_c = 2.0 * inverse * inverse
    for i in range(AXES):
        gradient[i] = by_a * z[i] + by_b * z[3 + i]
        gradient[3 + i] = by_b * z[i] + by_c * z[3 + i]
    return (a * c - b * b) * third


@kernel(forceinline=True)
def derivatives_of(e, k):
    """kappa^2 of e = r' and k = r'', three numbers or lanes each; and 2 d(kappa^2)/d(a, b / 2, c).

    These are the factors of :func:`gradient_of`.
    """
    a = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    b = e[0] * k[0] + e[1] * k[1] + e[2] * k[2]
    c = k[0] * k[0] + k[1] * k[1] + k[2] * k[2]
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    square = (a * c - b * b) * third
    return square, 2.0 * (3.0 * b * b - 2.0 * a * c) * third * inverse, -2.0 * b * third, 2.0 * inverse * inverse


@kernel(forceinline=True)
def gradient_of(e, k, by_a, by_b, by_c):
    """d(kappa^2)/dr' and d(kappa^2)/dr'', with the factors that :func:`derivatives_of` returned."""
    by_e = (by_a * e[0] + by_b * k[0], by_a * e[1] + by_b * k[1], by_a * e[2] + by_b * k[2])
    by_k = (by_b * e[0] + by_c * k[0], by_b * e[1] + by_c * k[1], by_b * e[2] + by_c * k[2])
    return by_e, by_k


@kernel
def write_hessian(z, hessian):
    """Write the second derivatives (6, 6)."""
    a = z[0] * z[0] + z[1] * z[1] + z[2] * z[2]
    b = z[0] * z[3] + z[1] * z[4] + z[2] * z[5]
    c = z[3] * z[3] + z[4] * z[4] + z[5] * z[5]
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    by_a = (3.0 * b * b - 2.0 * a * c) * third * inverse
    by_b = -2.0 * b * third
    by_c = inverse * inverse
    by_aa = (6.0 * a * c - 12.0 * b * b) * third * inverse * inverse
    by_ab = 6.0 * b * third * inverse
    by_ac = -2.0 * third
    by_bb = -2.0 * third
    for i in range(AXES):
        e, k = z[i], z[3 + i]
        for j in range(AXES):
            f, l = z[j], z[3 + j]
            one = 1.0 if i == j else 0.0
            hessian[i, j] = 2.0 * by_a * one + 4.0 * by_aa * e * f + 2.0 * by_ab * (e * l + k * f) + by_bb * k * l
            mixed = by_b * one + 2.0 * by_ab * e * f + 4.0 * by_ac * e * l + by_bb * k * f
            hessian[i, 3 + j] = mixed
            hessian[3 + j, i] = mixed
            hessian[3 + i, 3 + j] = 2.0 * by_c * one + by_bb * e * f


@kernel(forceinline=True)
def store_hessian(e, k, four):
    """Write second derivatives by (r', r''), (6, 6) lanes, to memory, as :func:`write_hessian`; returns kappa^2."""
    a = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    b = e[0] * k[0] + e[1] * k[1] + e[2] * k[2]
    c = k[0] * k[0] + k[1] * k[1] + k[2] * k[2]
    inverse = 1.0 / a
    third = inverse * inverse * inverse
    by_a = (3.0 * b * b - 2.0 * a * c) * third * inverse
    by_b = -2.0 * b * third
    by_c = inverse * inverse
    by_aa = (6.0 * a * c - 12.0 * b * b) * third * inverse * inverse
    by_ab = 6.0 * b * third * inverse
    by_ac = -2.0 * third
    by_bb = -2.0 * third
    for i in range(AXES):
        for j in range(AXES):
            slopes = 4.0 * by_aa * e[i] * e[j] + 2.0 * by_ab * (e[i] * k[j] + k[i] * e[j]) + by_bb * k[i] * k[j]
            mixed = 2.0 * by_ab * e[i] * e[j] + 4.0 * by_ac * e[i] * k[j] + by_bb * k[i] * e[j]
            turns = by_bb * e[i] * e[j]
            if i == j:
                slopes, mixed, turns = slopes + 2.0 * by_a, mixed + by_b, turns + 2.0 * by_c
            store(four, (6 * i + j) * LANES, slopes)
            store(four, (6 * i + 3 + j) * LANES, mixed)
            store(four, (6 * (3 + j) + i) * LANES, mixed)
            store(four, (6 * (3 + i) + 3 + j) * LANES, turns)
    return (a * c - b * b) * third
