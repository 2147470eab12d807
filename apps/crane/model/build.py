"""A crane scene compiled into a model: the rope's spans, what they run over and what hangs on them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from crane.assembly.drum_supply import check_drums
from crane.assembly.groups import groups_of
from crane.assembly.layout import AXES, Layout, lay_out
from crane.assembly.prepared import compensation_of
from crane.assembly.static_start import draw_true, finds_rope, stretch_of
from crane.geometry.quaternion import QUATERNION
from crane.groups.span import MATERIAL, STATION
from crane.model.handles import handles
from crane.results.ends.two_blocking import two_blocking
from crane.results.ends.wound_up import wound_up
from crane.results.laid_by_turning import laid_by_turning
from crane.results.limits import limits
from crane.results.observe import COORDINATE_UNITS, Observer, variables
from crane.results.out_of_water import out_of_water
from crane.results.ropes_that_lift import ropes_that_lift
from crane.results.set_down import set_down_askew
from crane.results.slack_feet import slack_feet
from crane.results.slipping_brakes import remarks
from crane.results.summary import (
    JOINED,
    NOTHING,
    OF_EVENTS,
    OF_PIECES,
    OF_TURNS,
    figure_units,
    figures_of_turns,
    headline,
    possible_figures,
)
from crane.scene.scene import Anchor, CraneScene, Drum, End, Sheave
from crane.sea.compensation import Compensation
from tautline.application.limits import with_limits
from tautline.application.modelling import attributes_of, settings_of
from tautline.integrators.statics.attainable import within_rounding
from tautline.kernels.time_function import TimeFunctions, copy_of, sample_all
from tautline.results.resumption import FRAMES_TOLD
from tautline.scene.solver import unused_alphas
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.model import Model
from tautline.system.system import System, assemble
from tautline.system.time_functions import FrameEntry, FunctionRequest, Steering, compile_functions

STEP_ERROR = 3.0e-5
"""Error of a step, m, where the scene gives none."""
TOLERANCE = 1.0e-8
"""Largest residual, as a share of the rope's tension, that counts as solved."""


def build(scene: CraneScene, functions: TimeFunctions | None = None) -> Model:
    """Compile a scene; ``functions`` are its own where some are held at other values, as frames of a start are.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        For a path that no rope can take, faults of files, and more rope than a drum holds.
    """
    check_drums(scene)
    made = assembled(scene, functions)
    layout, system, notes = made.layout, made.system, [*made.notes, *unused_alphas(scene.solver)]
    observer = Observer(layout, system.groups, made.compensation)

    def told(result: Any, names: Collection[str] = ()) -> dict[str, dict[str, Any]]:
        return headline(result, scene, layout, names)

    solver, water = scene.solver, scene.water
    has = made.compensation is not None, observer.waves is not None
    stored = layout.once(f"variables, {has}", lambda: variables(observer))
    places = layout.once("coordinates", observer.coordinates)
    error = float(solver.step_error or STEP_ERROR) if scene.controlled else 0.0
    model = Model(
        system=system,
        solver=settings_of(solver, scene.output.interval, TOLERANCE, "force", error),
        variables=stored,
        coordinates=places,
        attributes=_attributes(scene, layout, made.compensation),
        observe=observer.observe,
        on_demand=observer.on_demand,
        headline=told,
        limits=lambda result: limits(result, scene),
        remarks=lambda result: [
            *set_down_askew(result, scene), *remarks(result, scene), *ropes_that_lift(result, layout),
            *slack_feet(result, scene), *laid_by_turning(result, layout), *out_of_water(result, scene),
        ],
        figures=told,
        figure_units=layout.once(f"figure units, {bool(scene.rope.diameter)}", lambda: figure_units(scene)),
        nothing=NOTHING,
        longer_steps_tell=True,
        blow="max_snap",
        start="static" if scene.start == "static" else "as given",
        step_limit=0.3 * float(layout.path.chords.min()),
        own=observer.own,
        notes=notes,
        settle=lambda state: draw_true(layout, system, state),
        at_rest=observer.at_rest,
        memory={"hangs": observer.hangs},
        other_start="as drawn",
        carried="the current" if water is not None and water.current is not None and water.current.flows else "",
        handles=lambda: handles(made, stored, places),
        cause=lambda state, status: (
            two_blocking(layout, system, state, status) or wound_up(layout, system, state, status)
        ),
        anew=lambda held: build(scene, held),
        statistics={
            "watched": ("tension",), "fatigue": ("tension",), "needs": ("tension",), "rules": JOINED,
            "names": OF_PIECES,
            "of_turns": lambda turns: figures_of_turns(turns, scene), "turned": OF_TURNS,
            "possible": possible_figures(scene) if scene.output.statistics else (),
        },
        extremes=OF_EVENTS,
    )  # fmt: skip
    return with_limits(within_rounding(model), scene)


def _attributes(scene: CraneScene, layout: Layout, compensation: Compensation | None) -> Mapping[str, Any]:
    """What a result says of its scene, and of what was computed ahead of the run: another may not go on with that."""
    found = attributes_of(scene, "crane", COORDINATE_UNITS)
    if any(isinstance(request.model, FrameEntry) for request in layout.requests.of):
        found = {**found, FRAMES_TOLD: "at their pivots"}
    if compensation is None or not compensation.made_with:
        return found
    return {**found, "prepared": f"heave compensation: {compensation.made_with}"}


class Assembly:
    """The equations of a scene, and what was found on the way: `layout`, `system`, `compensation`, `notes`."""

    def __init__(self, layout: Layout, system: System, compensation: Compensation | None, notes: list[str]) -> None:
        self.layout, self.system, self.compensation, self.notes = layout, system, compensation, notes


def assembled(scene: CraneScene, functions: TimeFunctions | None = None) -> Assembly:
    """Lay a scene out and write its equations; see `build`."""
    layout = lay_out(scene, functions)
    tension = _tension(scene)
    _tie_material(layout, tension)
    compensation = _drive(layout)
    made, contacts = groups_of(layout)
    requests = tuple(layout.requests.of)
    if functions is None:
        # A run writes into them, so that each has its own.
        functions = copy_of(scene.once("functions", requests, lambda: compile_functions(requests)))
    at_first = sample_all(functions, range(len(requests)), np.zeros(1))[:, 0, 0]
    groups = tuple(make(functions) for make in made)
    layout.degrees.scale[:] = max(tension, 1.0e-6 * scene.rope.axial_stiffness)
    velocity = np.zeros(len(layout.degrees.names))
    for body in scene.bodies:
        place = layout.body[body.name]
        velocity[place : place + AXES] = body.velocity
    still = [layout.material(i) for i, item in enumerate(scene.path) if isinstance(item, Drum) and not item.prescribed]
    turns = [turn + k for turn in layout.turn.values() for k in range(QUATERNION)]
    at_rest = [*still, *layout.rim.values()]
    # Laws and sockets couple too: they are asked for each scene, also where its geometry was met before.
    stencils = _stencils(layout, contacts)
    system = assemble(groups, layout.degrees, functions, velocity, *stencils, at_rest=at_rest, turns=turns)
    driven = system.dofs.driven
    system.q[system.dofs.held[driven]] = system.dofs.offset[driven] + at_first[system.dofs.motion[driven]]
    # What is wrong with the path is among the scene's warnings, and is not said twice.
    return Assembly(layout, system, compensation, [])


def _tension(scene: CraneScene) -> float:
    """Tension that the rope may be expected to have, N: the load on its falls, and its own weight."""
    carried = {item.body for item in scene.path if isinstance(item, (End, Sheave)) and item.body is not None}
    ends = sum(
        (2 if isinstance(item, Sheave) else 1)
        for item in scene.path
        if isinstance(item, (End, Sheave)) and item.body is not None
    )
    g = float(np.linalg.norm(scene.gravity)) or EARTH_GRAVITY
    weight = sum(scene.body(name).mass for name in carried) * g
    return weight / max(ends, 1) + 1.0e-9 * scene.rope.axial_stiffness


def _tie_material(layout: Layout, tension: float) -> None:
    """Lay the rope's material along its path, and tie that of nodes to the marks about them."""
    scene, degrees, path = layout.scene, layout.degrees, layout.path
    stretch = hung = stretch_of(tension, scene.rope.axial_stiffness, scene.rope.strain)
    if scene.rope.length is not None:
        stretch = float(path.chords.sum()) / scene.rope.length
    elif scene.start == "as drawn":
        stretch = 1.0
    p = np.concatenate(([0.0], np.cumsum(path.chords / stretch)))
    radius = layout.wheels["radius"]
    for i, item in enumerate(scene.path):
        place = layout.material(i)
        degrees.value[place] = p[i]
        if isinstance(item, (End, Anchor)):
            degrees.fix(place)
    for i, (first, last) in enumerate(layout.spans):
        before, after = radius[i] * path.after[i] / stretch, radius[i + 1] * path.before[i + 1] / stretch
        one, two = layout.material(i), layout.material(i + 1)
        for k in range(first + 1, last):
            w = (k - first) / (last - first)
            place = layout.station[k] + MATERIAL
            degrees.value[place] = (1.0 - w) * (p[i] + before) + w * (p[i + 1] + after)
            degrees.tie(place, [(one, 1.0 - w), (two, w)], (1.0 - w) * before + w * after)
    # What it turns goes by the stretch that it has at rest: a load hangs lower on a rope that is longer than the path.
    layout.stretch = max(hung if scene.bodies and scene.start != "as drawn" else stretch, 1.0)


def _drive(layout: Layout) -> Compensation | None:
    """Prescribe the material at drums whose motion is prescribed; a drum's compensation comes in addition."""
    scene, degrees = layout.scene, layout.degrees
    compensation = compensation_of(scene)
    # Rope that a drum holds back at the start would be added again elsewhere, or stretch what is laid as drawn.
    from_zero = scene.start != "static" or finds_rope(layout)
    for i, item in enumerate(scene.path):
        if not (isinstance(item, Drum) and item.prescribed):
            continue
        way = -1.0 if i == 0 else 1.0
        key = f"path[{i}].drum.{item.drive}"
        drive, factor = (item.pay_out, 1.0) if item.drive == "pay_out" else (item.speed, item.radius)
        steered = (
            Steering(
                f"{item.name}.pay_out", "m", "length of unstretched rope paid out since the start", 0, way,
                zero_at_start=from_zero,
            ),
            Steering(f"{item.name}.pay_out_speed", "m/s", "speed of unstretched rope, positive out", 1, way),
        )  # fmt: skip
        request = FunctionRequest(
            drive, integrate=True, end=scene.solver.end, key=key, factor=way * factor, inputs=steered
        )
        laid = _further(layout, f"{item.name}: laid out", float(degrees.value[layout.material(i)]), None)
        masters = [(laid, 1.0), (_further(layout, f"{item.name}: operator", 0.0, request), 1.0)]
        if compensation is not None:
            added = FunctionRequest(compensation.pay_out, end=scene.solver.end, key="heave_compensation", factor=way)
            masters.append((_further(layout, f"{item.name}: compensation", 0.0, added), 1.0))
        layout.supply[i] = laid
        degrees.tie(layout.material(i), masters)
    return compensation


def _further(layout: Layout, name: str, value: float, request: FunctionRequest | None) -> int:
    """A further degree of freedom, which follows a value and a function of time, or is fixed."""
    degrees = layout.degrees
    place = degrees.add(name, value)
    if request is None:
        degrees.fix(place)
    else:
        degrees.prescribe(place, layout.requests.add(request))
    return place


def _stencils(layout: Layout, contacts: list[np.ndarray]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """What spans, contacts and bodies couple."""
    stations = np.array(layout.station)
    spans = np.concatenate((stations[:-1, None] + np.arange(STATION), stations[1:, None] + np.arange(STATION)), axis=1)
    single = np.array([[place] for place in layout.rim.values()], dtype=np.int64).reshape(-1, 1)
    bodies = np.array([place + np.arange(AXES) for place in layout.body.values()], dtype=np.int64).reshape(-1, AXES)
    turns = np.array([place + np.arange(QUATERNION) for place in layout.turn.values()], dtype=np.int64)
    return [spans, single, bodies, *contacts], [spans, single, bodies, turns.reshape(-1, QUATERNION)]
