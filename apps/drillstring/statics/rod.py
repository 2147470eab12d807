"""The exact extensible rod: a string's shape at rest in free space, without lumps and without elements.

The rod is the geometrically exact planar extensible elastica (Antman, Nonlinear Problems of Elasticity, 2nd ed. 2005,
ch. 4): cross-sections stay plane and at right angles to the axis, the strain e of the axis
is T / EA and the curvature per unstretched length M / EJ. With S the unstretched length from the top, x along the
straight hole and y across it on its high side, theta the slope against the hole, and (H, V) the force along x and y
that the part below exerts on the part above, at an inclination phi of the hole from the downward vertical:

    x' = (1 + e) cos(theta),   y' = (1 + e) sin(theta),   e = T / EA,   T = H cos(theta) + V sin(theta)
    H' = -w cos(phi),          V' = w sin(phi)                                  balance of forces: n' + f = 0
    theta' = M / EJ,           M' = (1 + e) (H sin(theta) - V cos(theta))       balance of moments: m' + r' x n = 0

w is the weight per unstretched length in the fluid, and T then the effective tension. The sections of a string have
their own EA, EJ and w; x, y, theta, M and V are continuous where they meet.

End conditions that it takes: the top ``pinned`` (x = y = M = 0) or ``clamped`` (x = y = theta = 0); the lower end
``guided`` (y = 0, M = 0, free along the hole under the force H) or ``free`` (V = 0, M = 0, the same force). A string in
a scene is pinned at the block; ``bit.lateral: pinned`` guides its end, and that is what configurations A, B and C of
the thesis have (Fig. 2.38). Pinned at the top and free below it is a pendulum, and hangs straight: `hang`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.integrate import solve_bvp

TOLERANCE = 1.0e-8
"""Relative residual of the collocation to which the rod is solved."""
TIGHTER = 1.0 / 16.0
"""Times the tolerance, on half the mesh, of the solution beside which the error is estimated: the order is four."""
WHILE_LOADING = 1.0e-4
"""Tolerance on the way to the whole load."""
FIRST_SHARE, LEAST_SHARE = 0.02, 1.0e-4
"""Share of the load to begin with, and the least step of it that is tried before giving up."""
MOST_PLACES = 60_000
"""Places of a mesh above which the boundary layers of the rod are too thin for it."""
STATES = 5
"""x, y, theta, M and V of a section."""


class NoRod(Exception):
    """The boundary value problem was not solved; its text says where it ended."""


class Piece(NamedTuple):
    """A section of the rod: length m, EA N, EJ N m^2, and weight per unstretched length in the fluid, N/m."""

    length: float
    axial: float
    bending: float
    weight: float


class Rod(NamedTuple):
    """A rod at rest.

    Attributes
    ----------
    length : float
        Unstretched, m.
    locate : callable
        From unstretched lengths (n,) m to x along the hole and y on its high side, (2, n) m, from the top.
    tension : callable
        From unstretched lengths (n,) m to tensions (n,) N.
    hook_load : float
        Force along the hole at the top, N.
    stretch : float
        By how much the axis is longer than unstretched, m.
    error : float
        Largest error of a position, m, estimated; zero for a closed form.
    """

    length: float
    locate: Callable[[np.ndarray], np.ndarray]
    tension: Callable[[np.ndarray], np.ndarray]
    hook_load: float
    stretch: float
    error: float


def hang(pieces: Sequence[Piece], force: float = 0.0, inclination: float = 0.0) -> Rod:
    """The string that hangs straight down from its pinned top: a closed form.

    The tension is the weight below and the force, T(S) = F + sum of w L below, and a point goes down by the integral
    of T / EA: of one piece, ``w (L S - S^2 / 2) / EA``, which at its end is ``w L^2 / (2 EA)``.

    Parameters
    ----------
    pieces : sequence of Piece
        From the top down.
    force : float
        At the lower end, N, positive downwards.
    inclination : float
        Of the hole, rad, along and across which places are told.
    """
    lengths = np.array([piece.length for piece in pieces])
    axial, weight = (np.array([piece[k] for piece in pieces]) for k in (1, 3))
    start = np.concatenate([[0.0], np.cumsum(lengths)])
    below = force + np.concatenate([np.cumsum((weight * lengths)[::-1])[::-1], [0.0]])
    longer = np.concatenate([[0.0], np.cumsum((below[1:] + 0.5 * weight * lengths) * lengths / axial)])

    def inside(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        k = np.clip(np.searchsorted(start, s, side="right") - 1, 0, lengths.size - 1)
        return k, s - start[k]

    def locate(s: np.ndarray) -> np.ndarray:
        k, z = inside(np.asarray(s, float))
        down = s + longer[k] + (below[k] * z - 0.5 * weight[k] * z**2) / axial[k]
        return np.array([np.cos(inclination) * down, -np.sin(inclination) * down])

    def tension(s: np.ndarray) -> np.ndarray:
        k, z = inside(np.asarray(s, float))
        return below[k] - weight[k] * z

    hook = float(force + np.cos(inclination) * (below[0] - force))
    return Rod(float(start[-1]), locate, tension, hook, float(longer[-1]), 0.0)


def bend(
    pieces: Sequence[Piece],
    inclination: float,
    force: float = 0.0,
    top: Literal["pinned", "clamped"] = "pinned",
    end: Literal["guided", "free"] = "guided",
    tolerance: float = TOLERANCE,
) -> Rod:
    """The rod in a straight hole by collocation (scipy.integrate.solve_bvp), the load brought on by degrees.

    It is solved twice: to the tolerance, and to a sixteenth of that on the same mesh with every interval halved. The
    second is finer whatever the first took; how far the two are apart is the error that is told, that of the first.

    Parameters
    ----------
    pieces : sequence of Piece
        From the top down.
    inclination : float
        Of the hole from the downward vertical, rad.
    force : float
        Along the hole at the lower end, N, positive downhole; it keeps its direction.
    top, end : str
        How the ends are held; see the module.
    tolerance : float
        Relative residual of the collocation.

    Returns
    -------
    Rod

    Raises
    ------
    NoRod
        Where the load cannot be brought on: nothing holds the rod, or it buckles on the way.
    """
    if top == "pinned" and end == "free":
        raise NoRod("pinned at its top and free below it is a pendulum: see `hang`")
    problem = _Problem(tuple(pieces), inclination, force, top, end)
    mesh, state = problem.straight()
    share, step = 0.0, FIRST_SHARE
    while share < 1.0:
        goal = min(1.0, share + step)
        found = problem.solve(goal, mesh, state, WHILE_LOADING)
        if found is None:
            step /= 3.0
            if step < LEAST_SHARE:
                raise NoRod(f"no shape was found beyond {100.0 * share:.3g} % of its load")
            continue
        mesh, state, share, step = found.x, found.y, goal, 3.0 * step
    loose = problem.solve(1.0, mesh, state, tolerance)
    tight = None
    if loose is not None:
        halved = np.sort(np.concatenate([loose.x, 0.5 * (loose.x[1:] + loose.x[:-1])]))
        tight = problem.solve(1.0, halved, loose.sol(halved), TIGHTER * tolerance)
    if loose is None or tight is None:
        raise NoRod(f"its boundary layers are too thin for a mesh of {MOST_PLACES} places")
    return problem.rod(loose.sol, tight.sol)


class _Problem:
    """The boundary value problem of all sections side by side, each over a share 0 to 1 of its own length.

    Lengths are over the rod's length L, forces over the whole load P, and moments over EJ / L of the first section.
    """

    def __init__(self, pieces: tuple[Piece, ...], inclination: float, force: float, top: str, end: str) -> None:
        self.pieces, self.top, self.end = pieces, top, end
        self.lengths = np.array([piece.length for piece in pieces])
        self.total = float(self.lengths.sum())
        weights = np.array([piece.weight for piece in pieces])
        load = float(np.abs(weights) @ self.lengths) + abs(force)
        if load == 0.0:
            raise NoRod("neither weight nor force acts on it")
        self.load, self.force = load, force
        self.along = weights * np.cos(inclination) * self.lengths / load
        self.across = weights * np.sin(inclination) * self.lengths / load
        # Force along the hole at the head of each section: what hangs below, and the force at the end.
        self.heads = force / load + np.cumsum(self.along[::-1])[::-1]
        self.moment = pieces[0].bending / self.total

    def straight(self) -> tuple[np.ndarray, np.ndarray]:
        """A mesh that is fine at the sections' ends, where the boundary layers are, and the rod without load."""
        mesh = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 201)))
        state = np.zeros((STATES * len(self.pieces), mesh.size))
        start = np.concatenate([[0.0], np.cumsum(self.lengths)]) / self.total
        for k in range(len(self.pieces)):
            place = start[k] + mesh * (start[k + 1] - start[k])
            state[STATES * k] = place
            state[STATES * k + 4] = self.across.sum() * (place - (0.5 if self.end == "guided" else 1.0))
        return mesh, state

    def solve(self, share: float, mesh: np.ndarray, state: np.ndarray, tolerance: float) -> Any:
        """Solve with a share of the load; None where that fails."""
        with np.errstate(all="ignore"):
            found = solve_bvp(
                lambda z, y: self._slopes(share, z, y), self._ends, mesh, state, tol=tolerance, max_nodes=MOST_PLACES
            )
        return found if found.success and np.isfinite(found.y).all() else None

    def _strain(self, k: int, share: float, z: np.ndarray, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Strain of section k, and the force along the hole over the load."""
        h = self.heads[k] - self.along[k] * z
        return share * self.load * (h * np.cos(part[2]) + part[4] * np.sin(part[2])) / self.pieces[k].axial, h

    def _slopes(self, share: float, z: np.ndarray, state: np.ndarray) -> np.ndarray:
        rows = []
        stiff = share * self.load * self.total / self.moment
        for k, piece in enumerate(self.pieces):
            part = state[STATES * k : STATES * (k + 1)]
            strain, h = self._strain(k, share, z, part)
            sine, cosine = np.sin(part[2]), np.cos(part[2])
            scale = piece.length / self.total
            rows += [
                scale * (1.0 + strain) * cosine,
                scale * (1.0 + strain) * sine,
                scale * part[3] * self.moment * self.total / piece.bending,
                scale * stiff * (1.0 + strain) * (h * sine - part[4] * cosine),
                np.full_like(sine, self.across[k]),
            ]
        return np.vstack(rows)

    def _ends(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        held = first[[0, 1, 3 if self.top == "pinned" else 2]]
        below = last[[-4 if self.end == "guided" else -1, -2]]
        return np.concatenate([held, last[:-STATES] - first[STATES:], below])

    def rod(self, loose: Callable, tight: Callable) -> Rod:
        """The solution in metres, with what the looser one tells of its error."""
        start = np.concatenate([[0.0], np.cumsum(self.lengths)])

        def states(solution: Callable, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            s = np.asarray(s, float)
            k = np.clip(np.searchsorted(start, s, side="right") - 1, 0, len(self.pieces) - 1)
            z = np.clip((s - start[k]) / self.lengths[k], 0.0, 1.0)
            return k, z, solution(z).reshape(len(self.pieces), STATES, -1)[k, :, np.arange(s.size)].T

        def locate(s: np.ndarray) -> np.ndarray:
            return self.total * states(tight, s)[2][:2]

        def tension(s: np.ndarray) -> np.ndarray:
            k, z, part = states(tight, s)
            h = self.heads[k] - self.along[k] * z
            return self.load * (h * np.cos(part[2]) + part[4] * np.sin(part[2]))

        places = np.concatenate([np.linspace(a, b, 401) for a, b in pairwise(start)])
        error = self.total * float(np.abs(states(loose, places)[2][:2] - states(tight, places)[2][:2]).max())
        # Five points of Gauss on each of 400 parts of a section, which are closer at its ends, where the layers are.
        nodes, weights = np.polynomial.legendre.leggauss(5)
        mesh = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 401)))
        stretch = 0.0
        for k, piece in enumerate(self.pieces):
            half = 0.5 * np.diff(mesh)
            z = (0.5 * (mesh[1:] + mesh[:-1]))[:, None] + half[:, None] * nodes
            part = tight(z.ravel())[STATES * k : STATES * (k + 1)]
            strain, _ = self._strain(k, 1.0, z.ravel(), part)
            stretch += piece.length * float((strain.reshape(z.shape) @ weights) @ half)
        return Rod(self.total, locate, tension, float(self.load * self.heads[0]), stretch, error)
