"""A span as the kernels see it, made from a case of the reference; calls of its hooks from Python."""

import numpy as np
from references import span_lagrangian as exact

from crane.geometry.line import POINT, WHEEL
from crane.groups.span import SPAN, STATION, new_spans
from tautline.kernels import groups as over
from tautline.kernels.changes import COUNT, new_changed
from tautline.kernels.groups import link
from tautline.kernels.jit import entry
from tautline.kernels.matrix import dense, new_matrix
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import compile_functions

FRAME = 12
SUMS = ("residual", "mass", "smooth_tangent", "switching_tangent", "energy", "dissipation", "supply", "kink", "alarm")


class Held:
    """A span with its frames (the first 24 degrees of freedom, held) and two free stations.

    ``keeps`` says whether the rope beyond its beginning and its end keeps its stretch, as on a drum.
    """

    def __init__(
        self, span: exact.Span, q: np.ndarray, v: np.ndarray, time: float, slack: bool = False, keeps=(False, False)
    ) -> None:
        wheels, numbers = np.zeros(2, WHEEL), []
        self.q, self.v = np.zeros(2 * FRAME + 2 * STATION), np.zeros(2 * FRAME + 2 * STATION)
        for k, sheave in enumerate((span.first, span.second)):
            turned = exact.rotation(sheave, time)
            spin = np.array([np.cross(sheave.rate, column) for column in turned.T])
            self.q[FRAME * k + 3 : FRAME * k + 12] = turned.T.ravel()
            self.v[FRAME * k + 3 : FRAME * k + 12] = spin.ravel()
            axis = np.asarray(sheave.axis, dtype=float)
            mark = np.asarray(sheave.mark, dtype=float)
            axis = axis / np.linalg.norm(axis)
            mark = mark - axis * (axis @ mark)
            wheels[k] = (FRAME * k, sheave.radius, axis, mark / np.linalg.norm(mark), int(np.any(sheave.rate)))
            numbers.append(k if sheave.radius != 0.0 else POINT)
        rows = np.zeros(1, SPAN).view(np.recarray)
        load = span.rhoA * np.asarray(span.gravity, dtype=float)
        rows[0] = (
            24,
            28,
            numbers[0],
            numbers[1],
            span.EA,
            span.rhoA,
            span.damping,
            load,
            int(slack),
            *keeps,
            int(span.engineering),
        )
        self.q[24:], self.v[24:] = q, v
        self.group = new_spans(rows, wheels.view(np.recarray))
        degrees = Degrees([f"x{i}" for i in range(32)], self.q.copy(), np.ones(32))
        for i in range(24):
            degrees.fix(i)
        stencil = [np.arange(24, 32)[None]]
        self.system = assemble((self.group,), degrees, compile_functions([]), self.v.copy(), stencil, stencil)
        self.groups = link((self.group,), *SUMS)
        self.order = np.argsort(self.system.free)

    def residual(self, q, v, a):
        """Residual (8,)."""
        full = [np.concatenate((self.q[:24], q)), np.concatenate((self.v[:24], v)), np.concatenate((np.zeros(24), a))]
        r = np.zeros(32)
        _residual(self.groups, *full, r)
        return r[24:]

    def matrix(self, q, v, a, cm, cc, ck):
        """cm dr/da + cc dr/dv + ck dr/dq (8, 8)."""
        full = [np.concatenate((self.q[:24], q)), np.concatenate((self.v[:24], v)), np.concatenate((np.zeros(24), a))]
        matrix = new_matrix(self.system.size, self.system.bandwidth, self.system.border)
        _tangent(self.groups, *full, cm, cc, ck, matrix, self.system.dofs)
        return dense(matrix)[np.ix_(self.order, self.order)]

    def mass(self, q):
        """Mass matrix (8, 8)."""
        matrix = new_matrix(self.system.size, self.system.bandwidth, self.system.border)
        _mass(self.groups, np.concatenate((self.q[:24], q)), matrix, self.system.dofs)
        return dense(matrix)[np.ix_(self.order, self.order)]

    def energies(self, q, v):
        """Kinetic, strain and potential energy; power lost and put in."""
        e, p = np.zeros(3), np.zeros(3)
        _energies(self.groups, np.concatenate((self.q[:24], q)), np.concatenate((self.v[:24], v)), e, p)
        return e, p

    def power(self, q, v):
        """Power that turning wheels put in, W, and the alarm that is raised."""
        p, alarm = np.zeros(2), np.zeros(2, np.int64)
        _power(self.groups, np.concatenate((self.q[:24], q)), np.concatenate((self.v[:24], v)), p, alarm)
        return p[0], alarm[0]

    def kinks(self):
        """Spans that have gone slack, or become taut again, since it was asked last."""
        changed = new_changed()
        _kinks(self.groups, changed)
        return changed[COUNT]


@entry
def _power(groups, q, v, p, alarm):
    over.supply(groups, 0.0, q, v, p)
    over.alarm(groups, 0.0, q, alarm)


@entry
def _kinks(groups, changed):
    over.kink(groups, changed)


@entry
def _residual(groups, q, v, a, r):
    over.residual(groups, 0.0, q, v, a, r)


@entry
def _tangent(groups, q, v, a, cm, cc, ck, matrix, dofs):
    over.smooth_tangent(groups, 0.0, q, v, a, cm, cc, ck, matrix, dofs)
    over.switching_tangent(groups, 0.0, q, v, a, cm, cc, ck, matrix, dofs)


@entry
def _mass(groups, q, matrix, dofs):
    over.mass(groups, q, matrix, dofs)


@entry
def _energies(groups, q, v, e, p):
    over.energy(groups, 0.0, q, v, e)
    over.dissipation(groups, 0.0, q, v, p)
    over.supply(groups, 0.0, q, v, p[1:])
