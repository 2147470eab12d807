"""A hose scene compiled into a model: cables, thrust of jets, start."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from gardenhose.cables import STARTS, arc_lengths, assembled, place_of_flow, step_limit, streams
from gardenhose.estimates import average, speeds
from gardenhose.limits import limits
from gardenhose.observe import Observer, variables
from gardenhose.scene import HoseScene, tied
from gardenhose.summary import FIGURES, JOINED, OTHERS, headline
from tautline.application.limits import with_limits
from tautline.application.modelling import attributes_of, settings_of
from tautline.cable.model.build import Assembly
from tautline.cable.model.handles import at_ends, stiffnesses
from tautline.cable.model.magnitudes import stiff_along
from tautline.integrators.state import State, new_state
from tautline.integrators.statics.attainable import within_rounding
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.stability import Rest, find_stable_equilibrium
from tautline.kernels.time_function import TimeFunctions, value_at
from tautline.scene.solver import error_of_steps, unused_alphas
from tautline.system.handles import Handles, inputs_of, outputs_of, prepared_of, same_as
from tautline.system.model import Model

TOLERANCE = 1.0e-4
"""Error of eq. 2.78 that counts as solved, in the root of energy over `energy_of`: it moves the tip of the hose of
Table 2.2 by less in a second than a step of 1 ms does (docs/hose.md)."""
CONTRACTION = 0.3
"""A fluttering hose turns so far in a step that factors seldom serve the next: old ones are given more time."""
LONG_STEP, TIGHTEST = 2.0e-3, 1.0e-7
"""Step over L^2 sqrt((m + M)/EJ) from which TOLERANCE is as it stands, 1 ms for the hose of Table 2.2; with shorter
steps it falls as their square, the order of the method, down to the second figure."""
FEW = 101
"""Looks at the water's speed for what is usual: a scale needs no more."""
FORCE_SHARE = 1.0e-2
"""What an iteration may leave out of the axial force, over one that is usual."""
STEP_ERROR = 1.0e-5
"""Error of a step over the hose's length, where the step is chosen and the scene gives none."""


def build(scene: HoseScene, functions: TimeFunctions | None = None) -> Model:
    """Compile a scene; ``functions`` are its own, in which the water may be held at another speed.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        Where what holds the hose says a thing twice.
    """
    made = assembled(scene, functions=functions)
    found = streams(scene)
    # Read now: a run writes into the functions.
    at_first = -value_at(made.layout.functions, 0, 0.0)[1] if found else 0.0
    observer = Observer(scene, made, place_of_flow(made.layout, found[0], 0) if found else None)
    solver, length = scene.solver, scene.hose.total_length
    error = error_of_steps(solver, STEP_ERROR * length)
    notes = [*made.notes, *unused_alphas(scene.solver)]
    if solver.step == "auto" and error > 0.0:
        notes.append(f"step: auto keeps the error of a step below {error:.2g} m")
    # Results of a simulation that is stepped ask once more, each time one is read.
    of_the_start = cache(lambda: _of_the_start(scene, at_first))
    model = Model(
        system=made.system,
        solver=settings_of(
            solver, scene.output.interval, tolerance_of(scene), "energy", error,
            projection="identity", stabilise=2, energy_unit=energy_of(scene), contraction=CONTRACTION,
        ),
        variables=variables(observer),
        coordinates=observer.coordinates(),
        attributes=attributes_of(
            scene, "gardenhose", "z up; axial_force is positive in tension and counts the damping; flow_speed is "
            "relative to the hose, positive from root to tip",
        ),
        observe=observer.observe,
        frames_tell_all=False,
        headline=headline,
        limits=limits,
        remarks=lambda result: of_the_start(),
        figure_units=FIGURES,
        statistics={"rules": JOINED, "possible": (*OTHERS, *FIGURES)},
        start=STARTS[scene.start],
        step_limit=step_limit(scene),
        settle=None if scene.coupling == "linear" else lambda state: begin_at_rest(scene, made, state),
        notes=notes,
        aside=_aside(scene),
        handles=lambda: _handles(made, model),
        cause=lambda state, status: stiff_along(made.system, state, status),
        anew=lambda held: build(scene, held),
    )  # fmt: skip
    return with_limits(within_rounding(model), scene)


def _aside(scene: HoseScene) -> str:
    """How to choose the side to which a hose falls: it is straight as it is drawn."""
    if scene.hose.end != "free":
        return "Let a little of `gravity` act to the side that is meant, such as a thousandth of it"
    return (
        "Let a little of `gravity` act to the side that is meant, or give `disturbance`, such as a hundredth of a "
        "metre a second that way"
    )


def _of_the_start(scene: HoseScene, speed: float) -> list[str]:
    """Sentences on the shape at rest that a run starts from, where its pivots tell nothing: water leaves a free end.

    ``speed``, m/s, is that of the water then.
    """
    if scene.start != "static" or scene.hose.end != "free" or scene.water is None:
        return []
    # Eigenvalues need scipy, which only a run of such a hose loads.
    from gardenhose.flutter import on_the_start

    return on_the_start(scene, speed)


def _handles(made: Assembly, model: Model) -> Handles:
    """What can be driven, read and changed of a hose while it runs."""
    outputs = outputs_of(model.variables, model.coordinates)
    s = model.coordinates["arc_length"][1]
    reaches = [f"element {k}, {a:.4g} to {b:.4g} m" for k, (a, b) in enumerate(pairwise(s.tolist()), 1)]
    outputs |= at_ends(outputs, labels=reaches)
    outputs["tip.position"] = same_as(outputs["tip"], "tip.position")
    outputs["tip.velocity"] = same_as(outputs["tip_velocity"], "tip.velocity")
    if "flow_speed" in outputs:
        outputs["water.speed"] = same_as(outputs["flow_speed"], "water.speed")
    parameters = {one.name: one for one in stiffnesses(made.system.groups, "hose")}
    return Handles(inputs_of(made.layout.requests), outputs, parameters, prepared_of(made.layout.requests))


def begin_at_rest(scene: HoseScene, made: Assembly, state: State) -> Rest:
    """Bring a scene to rest in the shape that it has with hose and water `tied`, by which its stability is judged.

    Parameters
    ----------
    made : Assembly
        Of the scene as it is.
    state : State
        Where the equilibrium is left.

    Raises
    ------
    StoppedEarly
        NO_EQUILIBRIUM, where none was found at all.
    """
    alike = assembled(tied(scene), functions=made.layout.functions)
    there = new_state(alike.system)
    judged = find_stable_equilibrium(alike.system, there, step_limit(scene))
    full, of_hose = made.system.q.copy(), {i: i for i in range(1, len(arc_lengths(scene)) + 1)}
    for stream in streams(scene):
        of_hose |= {stream.first + k: i + 1 for k, i in enumerate(range(stream.start, stream.stop + 1))}
    for node, hose in of_hose.items():
        place, like = made.layout.start[node], alike.layout.start[hose]
        full[place : place + 6] = there.full_q[like : like + 6]
    moves = np.setdiff1d(np.arange(made.system.size), made.system.algebraic)
    state.q[moves] = full[made.system.free[moves]]
    find_equilibrium(made.system, state, step_limit(scene))
    return judged


def tolerance_of(scene: HoseScene) -> float:
    """Tolerance where the scene gives none: what is left of an iteration is to be less than what a step leaves out.

    And it is to be no more than a small share of the axial force, which an energy that moves the tip by nothing may
    hide in a pipe that hardly stretches: a force F in a spring k is F^2/k.
    """
    slow = average(scene, 1.0).time_scale
    if scene.solver.step == "auto" or not np.isfinite(slow):
        return TIGHTEST
    steps = float(scene.solver.step) / (LONG_STEP * slow)
    stiffest = max(piece.axial_stiffness * piece.elements / piece.length for piece in scene.hose.pieces)
    seen = FORCE_SHARE * axial_force_of(scene) / float(np.sqrt(energy_of(scene) * stiffest))
    return float(np.clip(min(TOLERANCE * steps**2, seen or TOLERANCE), TIGHTEST, TOLERANCE))


def axial_force_of(scene: HoseScene) -> float:
    """Axial force that is usual for a hose, N: its weight and the thrust of its water at the fastest."""
    fastest = float(np.abs(speeds(scene, FEW)).max())
    return _mass_of(scene) * float(np.linalg.norm(scene.gravity)) + average(scene, 1.0).thrust * fastest**2


def _mass_of(scene: HoseScene) -> float:
    """Of the hose, what it carries at its tip, and what is in it, kg."""
    pieces = sum((p.mass_per_length + (p.water_mass_per_length or 0.0)) * p.length for p in scene.hose.pieces)
    return pieces + scene.hose.tip_mass


def energy_of(scene: HoseScene) -> float:
    """Energy that is large for a hose, J: that of bending it to a radius of its length, or of lifting it by that."""
    length = scene.hose.total_length
    bending = max(piece.bending_stiffness for piece in scene.hose.pieces) / length
    weight = _mass_of(scene) * float(np.linalg.norm(scene.gravity)) * length
    stretch = 1e-4 * max(piece.axial_stiffness for piece in scene.hose.pieces) * length
    return max(bending, weight, stretch)
