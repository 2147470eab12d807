"""Texts of cable scenes for the tests: ropes as chains of equal elements, in the syntax of the thesis' Appendix A."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium

GRAVITY = 9.81
PINNED = (1, 1, 1, 0, 0, 0, 1)
FREE = (0, 0, 0, 0, 0, 0, 1)


def numbers(values) -> str:
    """A list as the file has it, with every digit."""
    return "[" + ", ".join(repr(float(x)) if not isinstance(x, (int, np.integer)) else str(x) for x in values) + "]"


def node(i, xyz, slope=None, held=FREE, p=None, functions=None) -> str:
    """A cubic node; a linear one where `slope` is None."""
    more = "" if p is None else f", p: {float(p)!r}"
    more += "" if functions is None else f", BC_functions: {list(functions)}"
    if slope is None:
        return f"  - Node4Dof: {{id: {i}, xyz: {numbers(xyz)}, BC: {list(held)}{more}}}\n"
    return f"  - Node7Dof: {{id: {i}, xyz: {numbers(xyz)}, xyz_d: {numbers(slope)}, BC: {list(held)}{more}}}\n"


def element(i, a, b, EA, EJ=0.0, rhoA=1.0, damping=0.0, strain="green", linear=False, extra="") -> str:
    """An element."""
    if linear:
        head, bending = f"CableALEelementLin: {{id: {i}, nodes4: [{a}, {b}]", ""
    else:
        head, bending = f"CableALEelement: {{id: {i}, nodes7: [{a}, {b}]", f", EJ: {EJ!r}"
    return f"  - {head}, EA: {EA!r}{bending}, rhoA: {rhoA!r}, cDamp: {damping!r}, strain: {strain}{extra}}}\n"


def chain(
    xyz: np.ndarray,
    p: np.ndarray,
    held: dict[int, Sequence[int]],
    slopes: np.ndarray | None = None,
    linear: bool = False,
    reverse: bool = False,
    functions: dict[int, Sequence[int]] | None = None,
    **material,
) -> str:
    """Nodes at `xyz` (n + 1, 3) with material coordinates `p`, and the elements between them.

    `held` names what is not `FREE`, by index. `slopes` default to the chords. `reverse` lets p run the other way along
    the same nodes: p becomes its opposite, slopes turn round, elements go from the last node to the first.
    """
    n = len(xyz) - 1
    if slopes is None:
        slopes = np.gradient(xyz, p, axis=0)
    sign = -1.0 if reverse else 1.0
    text = ""
    for i in range(n + 1):
        bc = held.get(i, FREE)
        bc = (*bc[:3], bc[6]) if linear and len(bc) == 7 else bc
        moves = (functions or {}).get(i)
        text += node(i, xyz[i], None if linear else sign * slopes[i], bc, sign * p[i], moves)
    for i in range(n):
        a, b = (i + 1, i) if reverse else (i, i + 1)
        text += element(i, a, b, linear=linear, **material)
    return text


def scene(items: str, gravity=(0.0, 0.0, -GRAVITY), **solver) -> str:
    """The whole file; keywords go into ``GeneralizedAlpha``."""
    chosen = {"type": "G-alpha", "time_step": 0.01, "time_end": 0.01} | solver
    settings = ", ".join(f"{key}: {value}" for key, value in chosen.items())
    return (
        f"CableModelMaterial: {{Gravity: {numbers(gravity)}}}\nCableModel:\n{items}GeneralizedAlpha: {{{settings}}}\n"
    )


def model_of(items: str, gravity=(0.0, 0.0, -GRAVITY), **solver):
    """The scene made ready to run."""
    return build(parse(scene(items, gravity, **solver)))


class Still:
    """A scene at static equilibrium: positions, slopes and the forces of the supports, node by node."""

    def __init__(self, model, linear=False, nodes=None):
        """`nodes` is their number where multipliers come after them."""
        self.model, self.state = model, new_state(model.system)
        find_equilibrium(model.system, self.state, model.step_limit)
        size = 4 if linear else 7
        end = None if nodes is None else size * nodes
        self.unknowns = self.state.full_q[:end].reshape(-1, size)
        self.forces = self.state.residual[:end].reshape(-1, size)

    @property
    def position(self):
        return self.unknowns[:, :3]


def straight(start, end, n) -> np.ndarray:
    """Equally spaced points (n + 1, 3)."""
    return np.linspace(np.asarray(start, float), np.asarray(end, float), n + 1)


def turned(angle, axis=1) -> np.ndarray:
    """Rotation matrix about a coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    i, j = [k for k in range(3) if k != axis]
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix
