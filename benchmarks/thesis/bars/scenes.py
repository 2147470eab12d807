"""Scenes of the thesis' Cases 1 and 2: bars along x that only stretch, chains of masses and springs, and their modes.

x points down where there is gravity: the bar then hangs from its first node.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.linalg import eigh

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.vibration.modes import Modes, modes
from tautline.system.model import Model

GRAVITY = 9.81
STEP_LIMIT = 2.8
"""omega h on the imaginary axis up to which RK4 is stable, as the thesis rounds it (eq. 2.137); 2 sqrt 2 is exact."""
ENDS = {"free": 0, "pinned": 1}
"""BC of a node's position along the bar; its slope along the bar is always free."""


# items of a scene
def node(number: int, x: float, end: str = "free") -> str:
    """A node of cubic elements at x m, which is also its material coordinate."""
    place = f"xyz: [{x!r}, 0, 0], xyz_d: [1, 0, 0]"
    return f"Node7Dof: {{id: {number}, {place}, BC: [{ENDS[end]}, 1, 1, 0, 1, 1, 1], p: {x!r}}}"


def element(number: int, nodes: tuple[int, int], EA: float, strain: str = "green") -> str:
    """A cubic element of 1 kg/m that does not bend and loses nothing."""
    material = f"EA: {float(EA)!r}, EJ: 0, rhoA: 1, cDamp: 0, strain: {strain}"
    return f"CableALEelement: {{id: {number}, nodes7: {list(nodes)}, {material}}}"


def same(number: int, dof: int, sign: float, at_rest: float) -> str:
    """Node 1's unknown is node 0's, or its negative, but for a constant part: a pattern of eqs 2.152 and 2.153."""
    masters = f"[{{mNode: 0, mDof: {dof}, factor: {sign}}}]"
    return f"LinearCoupl: {{id: {number}, sNode: 1, sDof: {dof}, f0: {at_rest}, masters: {masters}}}"


def bar(count: int, EA: float, ends: Sequence[str] = ("pinned", "free"), strain: str = "green") -> list[str]:
    """One metre and one kilogram in equal elements."""
    kinds = [ends[0], *(count - 1) * ["free"], ends[1]]
    nodes = [node(i, i / count, kind) for i, kind in enumerate(kinds)]
    return [*nodes, *(element(i, (i, i + 1), EA, strain) for i in range(count))]


def chain(count: int, EA: float, last: float = 0.5, pinned: bool = True) -> list[str]:
    """One metre and one kilogram as equal springs with masses between: the mass-spring model.

    A spring is a linear element without mass. ``last`` is the share of an element's mass that stands at each end of
    the chain: half of it, or all, as where each mass stands at the outer end of its own element.
    """
    length = 1.0 / count
    items = []
    for i in range(count + 1):
        held = int(pinned and i == 0)
        items.append(f"Node4Dof: {{id: {i}, xyz: [{i * length!r}, 0, 0], BC: [{held}, 1, 1, 1], p: {i * length!r}}}")
        if not held:
            mass = length * (last if i in (0, count) else 1.0)
            items.append(f"PointMass: {{id: {i}, nodes4: [{i}], mass: {mass!r}}}")
    spring = f"EA: {float(EA)!r}, rhoA: 0, strain: engineering"
    return items + [f"CableALEelementLin: {{id: {i}, nodes4: [{i}, {i + 1}], {spring}}}" for i in range(count)]


# what they make
def model_of(items: Sequence[str], gravity: float = 0.0, **solver: Any) -> Model:
    """The equations of a scene; RK4 with steps of 0.1 ms to 1 s unless `solver` says else."""
    settings = {"type": "RK4", "time_step": 1e-4, "time_end": 1.0} | solver
    listed = "".join(f"  - {item}\n" for item in items)
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    heading = f"CableModelMaterial: {{Gravity: [{gravity!r}, 0, 0]}}"
    return build(parse(f"{heading}\nCableModel:\n{listed}GeneralizedAlpha: {{{written}}}\n"))


def modes_of(items: Sequence[str], gravity: float = 0.0) -> Modes:
    """Modes about equilibrium, angular frequencies rising."""
    model = model_of(items, gravity)
    state = new_state(model.system)
    if gravity:
        find_equilibrium(model.system, state, model.step_limit)
    return modes(model.system, state)


# what they are compared with
def textbook(count: int, EA: float, held: Sequence[int] = (0,)) -> np.ndarray:
    """Angular frequencies, rad/s, of `bar` from the printed matrices of the cubic Hermite element, unknowns (u, u')."""
    h = 1.0 / count
    size = np.outer(*[(1.0, h, 1.0, h)] * 2)
    k = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) * size * EA / (30.0 * h)
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * size * h / 420.0
    stiffness, mass = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for e in range(count):
        part = slice(2 * e, 2 * e + 4)
        stiffness[part, part] += k
        mass[part, part] += m
    free = np.setdiff1d(np.arange(len(mass)), held)
    squares = eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.abs(squares))
