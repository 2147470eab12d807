"""A hose's small motions in a few shapes: eigenvalues at many speeds of flow for little.

Shapes that the hose has at some speeds serve at all speeds between (Galerkin's method with the modes for a basis). At
the speeds that they are of they give its eigenvalues as they are, between these nearly. That tells where to look: what
is said of the hose is computed with all its unknowns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from gardenhose.static import Form
from tautline.integrators.linearise import evaluate
from tautline.integrators.vibration.vibrations import Vibrations
from tautline.kernels.dofs import HELD
from tautline.kernels.matrix import new_matrix, sparse

SLOWEST, FASTEST = 12, 6
"""Motions of a speed whose shapes are taken: the slowest ones, and of all those that decay least."""
LEAST = 1.0e-5
"""Part of a shape that is new, relative, below which it is left out."""
MOST_SHAPES = 60
POINTS = 6
"""Speeds over which matrices are interpolated: those of a straight hose go with speed and its square."""
TRUSTED = 1.2
"""Size of an eigenvalue, over the largest of which the shape was taken, up to which it is believed."""
NEAR_ZERO = 1.0e-4
"""Decay over the size of the eigenvalue that may be growth when computed with all unknowns."""
PROMINENT = 10.0
"""How far a growth rate falls to either side of a peak that is not rounding, over the same size times 1e-7."""
SIDE = 8
"""Speeds to either side of a peak within which it falls by that."""


class Reduced:
    """Motions of a hose in a plane, in shapes of some speeds.

    Parameters
    ----------
    forms : list of Form
        At rest at rising speeds of flow.
    motions : list of Vibrations
        At the same speeds.
    share : list of (k,) array
        Of each motion that is out of the plane.
    normal : (3,) array or None
        Of the plane of a hose that is bent; None for a straight one, which moves alike in all planes.
    direction : (3,) array
        Of the hose at its root.
    out : bool
        Motions out of the plane, and not in it.
    still : float
        Growth over the size of the eigenvalue that is none.
    """

    def __init__(
        self,
        forms: Sequence[Form],
        motions: Sequence[Vibrations],
        share: Sequence[np.ndarray],
        normal: np.ndarray | None,
        direction: np.ndarray,
        out: bool,
        still: float,
    ) -> None:
        self.speed, self.still = np.array([one.speed for one in forms]), still
        chosen = [_of_plane(one, part, normal, out) for one, part in zip(motions, share, strict=True)]
        self.trusted = np.array([TRUSTED * np.abs(one.value[slow]).max(initial=0.0) for one, slow, _ in chosen])
        shapes = np.hstack([one.shape[:, slow | fast] for one, slow, fast in chosen])
        self.matrices = np.zeros((len(forms), 3, 0, 0))
        if not shapes.size:
            return
        parts = _parts(shapes, len(forms[0].position), normal, direction, out)
        basis = _basis(forms[0], parts)
        self.matrices = np.array([_projected(one, basis) for one in forms])

    def at(self, speeds: np.ndarray) -> np.ndarray:
        """Eigenvalues (k, n) at speeds (k,), 1/s, of each conjugate pair one; nan for those that are not believed."""
        n = self.matrices.shape[-1]
        made = np.empty((len(speeds), 2 * n, 2 * n))
        for one, speed in zip(made, speeds, strict=True):
            mass, damping, stiffness = self._between(float(speed))
            one[:n, :n], one[:n, n:] = 0.0, np.eye(n)
            one[n:] = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
        value = np.linalg.eigvals(made) if n else np.zeros((len(speeds), 0), complex)
        limit = np.interp(speeds, self.speed, self.trusted)[:, None]
        return np.where((value.imag >= -1e-9 * np.abs(value)) & (np.abs(value) <= limit), value, np.nan)

    def growth(self, speed: float) -> float:
        """Largest growth rate at a speed less what may be rounding, 1/s."""
        return float(self.growths(self.at(np.array([speed])))[0])

    def growths(self, values: np.ndarray) -> np.ndarray:
        """Largest growth rate (k,) of eigenvalues (k, n), less what may be rounding."""
        grows = values.real - self.still * np.abs(values)
        return np.where(np.isnan(grows), -np.inf, grows).max(axis=1, initial=-np.inf)

    def _between(self, speed: float) -> np.ndarray:
        """Matrices (3, n, n) of mass, damping and stiffness at a speed, by the polynomial through those about it."""
        count = min(POINTS, len(self.speed))
        first = int(np.clip(np.searchsorted(self.speed, speed) - count // 2, 0, len(self.speed) - count))
        at = self.speed[first : first + count]
        weights = [np.prod([(speed - b) / (a - b) for b in at if b != a]) for a in at]
        return np.tensordot(weights, self.matrices[first : first + count], 1)


class Peak(NamedTuple):
    """A speed, m/s, at which a motion grows fastest, and its growth rate less what may be rounding, 1/s."""

    speed: float
    growth: float


def peaks(reduced: Reduced, speeds: np.ndarray, values: np.ndarray) -> list[Peak]:
    """Where the growth rate of one motion or another is largest among rising speeds, and may be above zero.

    Each motion is followed to the speeds beside one by its eigenvalue.
    """
    found: list[Peak] = []
    for i in range(1, len(speeds) - 1):
        here = values[i][~np.isnan(values[i])]
        before, after = (_nearest(values[k], here) for k in (i - 1, i + 1))
        bent = np.abs(before.real - 2.0 * here.real + after.real)
        top = (here.real >= before.real) & (here.real >= after.real)
        # A parabola through the three is at most an eighth of that above the middle one. Near where pairs meet curves
        # are steeper than a parabola.
        top &= here.real + bent > -NEAR_ZERO * np.abs(here)
        for j in np.flatnonzero(top & _stands_out(values, i, here)):
            speed, value = _summit(reduced, speeds[i - 1 : i + 2], np.array([before[j], here[j], after[j]]))
            if value.real > -NEAR_ZERO * abs(value):
                found.append(Peak(speed, value.real - reduced.still * abs(value)))
    return found


def _stands_out(values: np.ndarray, i: int, here: np.ndarray) -> np.ndarray:
    """Whether motions (n,) at a speed grow faster than to either side by more than rounding."""
    fall = []
    for way in (-1, 1):
        last, deepest = here, here.real
        for k in range(i + way, i + way * (SIDE + 1), way):
            if not 0 <= k < len(values):
                break
            last = _nearest(values[k], last)
            deepest = np.minimum(deepest, last.real)
        fall.append(here.real - deepest)
    return np.minimum(*fall) > PROMINENT * 1e-7 * np.abs(here)


def _nearest(values: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Of values (m,), some of them nan, the nearest to each of others (n,)."""
    known = values[~np.isnan(values)]
    if not known.size:
        return np.full(to.size, -np.inf, complex)
    return known[np.abs(known - to[:, None]).argmin(axis=1)]


def _summit(reduced: Reduced, speeds: np.ndarray, values: np.ndarray) -> tuple[float, complex]:
    """Speed between the outer two of three at which a motion, known at each, grows fastest, and its eigenvalue."""
    whole = speeds[2] - speeds[0]
    curve = np.polynomial.Polynomial.fit(speeds, values, 2)

    def value(speed: float) -> complex:
        return complex(_nearest(reduced.at(np.array([speed]))[0], np.array([curve(speed)]))[0])

    best = minimize_scalar(
        lambda u: -value(u).real, bounds=(speeds[0], speeds[2]), method="bounded", options={"xatol": 1e-4 * whole}
    )
    speed = float(best.x) if -best.fun >= values[1].real else float(speeds[1])
    return speed, value(speed)


def _of_plane(
    motions: Vibrations, share: np.ndarray, normal: np.ndarray | None, out: bool
) -> tuple[Vibrations, np.ndarray, np.ndarray]:
    """Motions of a speed with marks of the slowest of a plane, and of those that decay least."""
    those = np.full(share.size, True) if normal is None else (share > 0.5) == out
    slow, fast = np.zeros((2, share.size), bool)
    slow[np.flatnonzero(those)[:SLOWEST]] = True
    order = np.argsort(np.where(those, -motions.value.real, np.inf))[:FASTEST]
    fast[order] = those[order]
    return motions, slow, fast


def _parts(shapes: np.ndarray, count: int, normal: np.ndarray | None, direction: np.ndarray, out: bool) -> np.ndarray:
    """Real shapes (n_full, k) of a plane, from complex ones of the hose."""
    nodes = shapes[: 7 * count].reshape(count, 7, -1)
    vectors = nodes[:, :6].reshape(count, 2, 3, -1)
    if normal is None:
        # Which plane each lies in, and how it turns, is chance: what it has across the hose in two is laid into one.
        first = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
        first /= np.linalg.norm(first)
        laid = [
            first[:, None] * np.einsum("npck,c->npk", vectors, e)[:, :, None]
            for e in (first, np.cross(direction, first))
        ]
        parts = np.concatenate(laid, axis=-1)
    else:
        across = normal[:, None] * np.einsum("npck,c->npk", vectors, normal)[:, :, None]
        parts = across if out else vectors - across
    made = np.zeros((len(shapes), parts.shape[-1]), complex)
    made[: 7 * count].reshape(count, 7, -1)[:, :6] = parts.reshape(count, 6, -1)
    return np.hstack([made.real, made.imag])


def _basis(form: Form, parts: np.ndarray) -> np.ndarray:
    """Orthonormal shapes (n, r) of the unknowns that span full ones (n_full, k), the weightiest at most."""
    dofs = form.system.dofs
    rows = np.repeat(np.arange(dofs.number.size), np.diff(dofs.start))
    held = (dofs.number[rows] == HELD) | (dofs.unknown < 0)
    entries = (dofs.factor[~held], (rows[~held], dofs.unknown[~held]))
    expand = csr_array(entries, shape=(dofs.number.size, form.system.size))
    size = np.linalg.norm(parts, axis=0)
    parts = parts[:, size > 1e-6 * size.max(initial=0.0)] / size[size > 1e-6 * size.max(initial=0.0)]
    reduced = splu((expand.T @ expand).tocsc()).solve(np.ascontiguousarray(expand.T @ parts))
    left, weight, _ = np.linalg.svd(reduced, full_matrices=False)
    return left[:, weight > LEAST * weight.max(initial=0.0)][:, :MOST_SHAPES]


def _projected(form: Form, basis: np.ndarray) -> np.ndarray:
    """Matrices (3, r, r) of mass, damping and stiffness about a shape at rest, for motions in a basis."""
    system, state = form.system, form.state
    keep, made = state.residual.copy(), []
    for cm, cc, ck in np.eye(3):
        matrix = new_matrix(system.size, system.bandwidth, system.border)
        evaluate(system, state, 0.0, 1.0, True, cm, cc, ck, matrix, np.zeros(system.size))
        made.append(basis.T @ (sparse(matrix) @ basis))
    state.residual[:] = keep
    return np.array(made)
