"""Groups by themselves: calls from Python of their hooks, and runs of a few of them."""

import numpy as np

from tautline.integrators.generalized_alpha import alphas
from tautline.kernels import groups as over
from tautline.kernels.groups import link
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix
from tautline.results.assessment.balance import ENERGIES
from tautline.results.variable import Variable
from tautline.simulation import simulate
from tautline.system.model import Model, SolverSettings
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

SUMS = ("residual", "mass", "smooth_tangent", "energy", "dissipation", "supply")


class Hooks:
    """Groups over `size` free degrees of freedom, by stencils that list what they couple."""

    def __init__(self, groups, size, stencils):
        degrees = Degrees([f"x{i}" for i in range(size)], np.zeros(size), np.ones(size))
        stencils = [np.atleast_2d(s) for s in stencils]
        self.system = assemble(groups, degrees, compile_functions([]), np.zeros(size), stencils, stencils)
        self.linked, self.order = link(groups, *SUMS), np.argsort(self.system.free)

    def residual(self, q, v, a, t=0.0):
        """Residual (n,)."""
        r = np.zeros(len(q))
        _residual(self.linked, float(t), *_vectors(q, v, a), r)
        return r

    def _matrix(self):
        return new_matrix(self.system.size, self.system.bandwidth, self.system.border)

    def tangent(self, q, v, a, cm, cc, ck, t=0.0):
        """cm dr/da + cc dr/dv + ck dr/dq (n, n)."""
        matrix = self._matrix()
        _tangent(self.linked, float(t), *_vectors(q, v, a), float(cm), float(cc), float(ck), matrix, self.system.dofs)
        return dense(matrix)[np.ix_(self.order, self.order)]

    def mass(self, q):
        """Mass matrix (n, n)."""
        matrix = self._matrix()
        _mass(self.linked, *_vectors(q), matrix, self.system.dofs)
        return dense(matrix)[np.ix_(self.order, self.order)]

    def energies(self, q, v, t=0.0):
        """Kinetic, strain and potential energy (3,)."""
        e = np.zeros(3)
        _energy(self.linked, float(t), *_vectors(q, v), e)
        return e

    def powers(self, q, v, t=0.0):
        """Power lost, and put in."""
        p = np.zeros(3)
        _dissipation(self.linked, float(t), *_vectors(q, v), p)
        return p[0], p[1]

    def acceleration(self, q, v):
        """Acceleration (n,) of a free motion."""
        return np.linalg.solve(self.mass(q), -self.residual(q, v, np.zeros(q.size)))

    def tangent_error(self, q, v, a, cm, cc, ck, h=1e-6, t=0.0):
        """Largest difference of the tangent from the residual's, over its largest entry."""
        made = self.tangent(q, v, a, cm, cc, ck, t)
        steps = np.eye(q.size) * h
        # two differences together cancel what a curved residual leaves in one
        first, second = (
            np.array(
                [
                    self.residual(q + k * ck * s, v + k * cc * s, a + k * cm * s, t)
                    - self.residual(q - k * ck * s, v - k * cc * s, a - k * cm * s, t)
                    for s in steps
                ]
            ).T
            / (2.0 * k * h)
            for k in (1.0, 2.0)
        )
        expected = (4.0 * first - second) / 3.0
        return np.abs(made - expected).max() / np.abs(expected).max()

    def imbalance(self, q, v, a, h=1e-5, t=0.0):
        """Power into the groups less what becomes of it, over the largest of the three."""

        def energy(later):
            return self.energies(q + later * v + 0.5 * later**2 * a, v + later * a, t + later).sum()

        e = {k: energy(k * h) for k in (-2, -1, 1, 2)}
        stored = (8.0 * (e[1] - e[-1]) - (e[2] - e[-2])) / (12.0 * h)
        lost, given = self.powers(q, v, t)
        power = self.residual(q, v, a, t) @ v
        return abs(power - stored - lost + given) / max(abs(power), abs(stored), abs(lost), abs(given))


def _vectors(*given):
    return [np.ascontiguousarray(x, dtype=float) for x in given]


@entry
def _residual(groups, t, q, v, a, r):
    over.residual(groups, t, q, v, a, r)


@entry
def _tangent(groups, t, q, v, a, cm, cc, ck, matrix, dofs):
    over.smooth_tangent(groups, t, q, v, a, cm, cc, ck, matrix, dofs)


@entry
def _mass(groups, q, matrix, dofs):
    over.mass(groups, q, matrix, dofs)


@entry
def _energy(groups, t, q, v, e):
    over.energy(groups, t, q, v, e)


@entry
def _dissipation(groups, t, q, v, p):
    over.dissipation(groups, t, q, v, p)
    over.supply(groups, t, q, v, p[1:])


def run(groups, q, v, stencils, held=(), *, step, end, interval, scale=1.0):
    """Result of a run with the trapezoidal rule: `q`, `v` (frames, n) and energies. No group may record numbers."""
    degrees = Degrees([f"x{i}" for i in range(q.size)], q.copy(), np.full(q.size, scale))
    for i in held:
        degrees.fix(i)
    stencils = [np.atleast_2d(s) for s in stencils]
    system = assemble(groups, degrees, compile_functions([]), v.copy(), stencils, stencils)
    solver = SolverSettings("generalized-alpha", step, end, interval, *alphas(1.0), tolerance=1e-11)
    variables = [Variable(name, ("time",), "J", name) for name in ENERGIES]
    variables += [Variable(name, ("time", "unknown"), "1", name) for name in "qv"]

    def observe(frames):
        energies = {name: frames.energy[:, k].copy() for k, name in enumerate(ENERGIES)}
        return {**energies, "q": frames.q.copy(), "v": frames.v.copy()}

    unknowns = {"unknown": ("unknown", np.arange(q.size), "", "degree of freedom")}
    return simulate(Model(system, solver, variables, unknowns, {}, observe, lambda result: {}, start="as given"))
