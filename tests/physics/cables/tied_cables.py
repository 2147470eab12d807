"""Cable scenes whose spans are joined in every way that a scene can join them, and what a test asks of a run."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.integrators.vibration.modes import modes
from tautline.simulation import simulate

WAYS = ("shared", "coupling", "multiplier", "augmented", "penalty")
KEYS = {"multiplier": "LagMultipl7", "augmented": "AugLagrange7", "penalty": "Penalty7"}
DOFS = {0: (1, 2, 3), 1: (7,), 2: (4, 5, 6)}
RK4_LIMIT = 2.0 * 2.0**0.5
"""omega h at which |R(i omega h)| of the classical Runge-Kutta method is one: y^6/72 = y^8/576."""
FREE = (0,) * 7
"""BC of a node that nothing holds."""
PINNED = (1, 1, 1, 0, 0, 0, 1)
"""BC of a node whose position and material are held, and whose slope is free."""


# items of a scene
def scene(items, gravity=(0, 0, 0), **solver):
    """Text of a scene: items are lines under CableModel; the solver is RK4 with steps of 1 ms unless it says else."""
    settings = {"type": "RK4", "time_step": 1e-3, "time_end": 0.1} | solver
    listed = "".join(f"  - {item}\n" for item in items)
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    return f"CableModelMaterial: {{Gravity: {list(gravity)}}}\nCableModel:\n{listed}GeneralizedAlpha: {{{written}}}\n"


def node(id, xyz, BC=(0, 0, 0, 0, 0, 0, 1), slope=(1, 0, 0), functions=None):
    follows = f", BC_functions: {list(functions)}" if functions else ""
    return f"Node7Dof: {{id: {id}, xyz: {list(map(float, xyz))}, xyz_d: {list(slope)}, BC: {list(BC)}{follows}}}"


def element(id, first, second, EA=1.0, EJ=0.0, rhoA=1.0, **more):
    further = "".join(f", {key}: {value}" for key, value in more.items())
    return f"CableALEelement: {{id: {id}, nodes7: [{first}, {second}], EA: {EA}, EJ: {EJ}, rhoA: {rhoA}{further}}}"


def couple(id, slave, dof, masters, f0=0.0):
    """LinearCoupl with masters as (node, dof, factor)."""
    listed = ", ".join(f"{{mNode: {m}, mDof: {d}, factor: {f}}}" for m, d, f in masters)
    return f"LinearCoupl: {{id: {id}, sNode: {slave}, sDof: {dof}, f0: {f0}, masters: [{listed}]}}"


def join(way, first, second, whats=(0, 2), stiffness=None, offset=(0, 0, 0)):
    """Items that join two nodes by r (0), p (1), r' (2); the stiffness is one for each of ``whats``, or for all."""
    if way == "shared":
        return []
    shift = dict(zip(DOFS[0], offset, strict=True))
    if way == "coupling":
        dofs = [dof for what in whats for dof in DOFS[what]]
        return [couple(10 * second + dof, second, dof, [(first, dof, 1)], shift.get(dof, 0)) for dof in dofs]
    made = []
    for k, what in enumerate(whats):
        sprung = stiffness is not None and way != "multiplier"
        spring = f", p_spring: {np.broadcast_to(stiffness, len(whats))[k]}" if sprung else ""
        moved = f", offset: {list(offset)}" if what == 0 and any(offset) else ""
        made.append(
            f"{KEYS[way]}: {{id: {10 * second + what}, nodes7: [{first}, {second}], constr: {what}{spring}{moved}}}"
        )
    return made


# what is asked of them
def model_of(text):
    return build(parse(text))


def run(text):
    return simulate(model_of(text))


def run_with_frames(text):
    """Result of a run, and its q, v, a (frames, n_full): the degrees of freedom of the nodes in order come first."""
    model, kept = model_of(text), []
    observe = model.observe

    def watch(frames):
        kept.append([np.array(part) for part in (frames.q, frames.v, frames.a)])
        return observe(frames)

    result = simulate(replace(model, observe=watch))
    return result, [np.concatenate(parts) for parts in zip(*kept, strict=True)]


def of_nodes(result, name, ids):
    """A variable (time, nodes, ...) of some nodes."""
    places = [list(np.array(result["node"])).index(i) for i in ids]
    return np.array(result[name])[:, places]


def at_rest(text):
    """Model in static equilibrium and its state."""
    model = model_of(text)
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    return model, state


def fastest(text):
    """Largest angular frequency, rad/s, about the start of the scene."""
    model = model_of(text)
    return modes(model.system, new_state(model.system)).omega[-1]


def run_unwatched(text):
    """Result of a run without the look-out that an explicit one keeps for its step: only its own growth can end it."""
    with patch.object(CriticalStep, "search", return_value=(np.inf, 0)):
        return run(text)
