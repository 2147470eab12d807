"""Groups whose tangent is a tenth too large and whose every other kernel is right: faults to be found.

`Mount` is a mass, a damper and a spring at one unknown, whose data say by how much each part of its tangent is off: the
same compiled code is right or wrong. `WrongTension` and its like are groups of ours with another tangent: the type of
a group chooses its code, so each is a type of its own, and takes seconds to compile.
"""

import sys
from typing import NamedTuple

import numpy as np
from numba import cloudpickle
from study.oscillators import subject

from tautline.elements.linear import LinearTension
from tautline.elements.linear import _tangent as tangent_of_linear
from tautline.elements.tension import Tension
from tautline.elements.tension import _tangent as tangent_of_tension
from tautline.kernels.dofs import add_entry
from tautline.kernels.groups import KINDS, register
from tautline.kernels.jit import kernel

# As in tests/order/two_masses.py: what is compiled for these groups goes into the cache with the classes themselves.
cloudpickle.register_pickle_by_value(sys.modules[__name__])

TOO_LARGE = 1.1


class Mount(NamedTuple):
    """Mass kg, damping N s/m and stiffness N/m at a full place; ``told`` (3,) over what is true.

    The spring pushes back what is beyond ``home`` m, and where ``one_sided`` is 1 leaves alone what is not.
    """

    place: int
    mass: float
    damping: float
    stiffness: float
    home: float
    one_sided: int
    told: np.ndarray


@kernel
def _stiffness(g, q):
    return 0.0 if g.one_sided == 1 and q[g.place] < g.home else g.stiffness


@kernel
def _residual(g, t, q, v, a, r):
    o = g.place
    r[o] += g.mass * a[o] + g.damping * v[o] + _stiffness(g, q) * (q[o] - g.home)


@kernel
def _mass(g, q, matrix, dofs):
    add_entry(matrix, dofs, g.place, g.place, g.mass)


@kernel
def _tangent(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    entry = cm * g.told[0] * g.mass + cc * g.told[1] * g.damping + ck * g.told[2] * _stiffness(g, q)
    add_entry(matrix, dofs, g.place, g.place, entry)


@kernel
def _energy(g, t, q, v, e):
    e[0] += 0.5 * g.mass * v[g.place] ** 2
    e[1] += 0.5 * _stiffness(g, q) * (q[g.place] - g.home) ** 2


@kernel
def _dissipation(g, t, q, v, p):
    p[0] += g.damping * v[g.place] ** 2


register(
    Mount, constant_mass=True, residual=_residual, mass=_mass, tangent=_tangent, energy=_energy,
    dissipation=_dissipation,
)  # fmt: skip


def mounted(mass=0.5, damping=1.0, stiffness=50.0, told=(1.0, 1.0, 1.0), gap=None):
    """A change of a model that puts a mount at its first free unknown, at rest where the mass of `oscillator` rests.

    With a gap, m, it is that far away and pushes only.
    """

    def change(model):
        near = np.abs(model.system.q - 1.0)[model.system.free].argmin()
        place, home = int(model.system.free[near]), 1.0 + (gap or 0.0)
        numbers = float(mass), float(damping), float(stiffness), home
        extra = Mount(place, *numbers, int(gap is not None), np.array(told, float))
        model.system.groups = (*model.system.groups, extra)
        return model

    return change


class WrongLinearTension(LinearTension):
    """Axial force of linear elements."""


class WrongTension(Tension):
    """Axial force of cubic elements."""


@kernel
def _linear(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    tangent_of_linear(g, t, q, v, a, TOO_LARGE * cm, TOO_LARGE * cc, TOO_LARGE * ck, matrix, dofs)


@kernel
def _tension(g, t, q, v, a, cm, cc, ck, matrix, dofs):
    tangent_of_tension(g, t, q, v, a, TOO_LARGE * cm, TOO_LARGE * cc, TOO_LARGE * ck, matrix, dofs)


WRONG = {LinearTension: (WrongLinearTension, _linear), Tension: (WrongTension, _tension)}
for kind, (wrong, tangent) in WRONG.items():
    register(wrong, constant_mass=KINDS[kind].constant_mass, **(KINDS[kind].hooks | {"tangent": tangent}))


def faulty(kind):
    """A change of a model that gives all groups of a kind their wrong tangent."""

    def change(model):
        groups = tuple(WRONG[kind][0](*g) if type(g) is kind else g for g in model.system.groups)
        assert any(type(g) is WRONG[kind][0] for g in groups), "the scene has no such group"
        model.system.groups = groups
        return model

    return change


def faulty_subject(text, kind, **more):
    """A scene under study whose groups of a kind have a wrong tangent in every run."""
    return subject(text, change=faulty(kind), **more)
