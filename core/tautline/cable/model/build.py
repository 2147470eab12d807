"""A cable scene made ready to run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from tautline.application.limits import with_limits
from tautline.application.modelling import attributes_of, settings_of
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.parts import BESIDES_MODEL, CableScene
from tautline.cable.input.syntax.nodal import NODAL, item_of
from tautline.cable.model.elements import element_groups, steady_flow, stencils
from tautline.cable.model.emptied import empty_element
from tautline.cable.model.eyelets import eyelets
from tautline.cable.model.handles import handles
from tautline.cable.model.layout import Layout
from tautline.cable.model.limits import limits
from tautline.cable.model.magnitudes import (
    acting_force,
    largest_force,
    mass_of,
    outweighs,
    rounding_error,
    stiff_along,
    too_stiff,
)
from tautline.cable.model.observe import EXTREMES, Observer, figure_units, headline, variables
from tautline.cable.model.room import rooms
from tautline.cable.model.sections import Sections
from tautline.cable.model.ties import check_sound, constraint_groups, equations_of, stiff_tie
from tautline.cable.short_waves import overtaken
from tautline.constraints.multiplier import Multipliers
from tautline.integrators.statics.attainable import MANY, within_rounding
from tautline.kernels.time_function import TimeFunctions
from tautline.scene.solver import error_of_steps, unused_alphas
from tautline.system.model import Model
from tautline.system.system import System, assemble

ERROR = 1.0e-6
"""Error of a step over the length of all ropes, where the step is chosen and the scene gives none."""
FAR = 1.0 / 40.0
"""Share of a scene's extent by which nodes, and their neighbours with them, may move in an iteration towards rest."""
CONTRACTION = 0.25
"""New factors of a rope of cubic elements cost as much as ten iterations with old ones, which are given more time."""


class Assembly(NamedTuple):
    """A scene's equations: where its unknowns stand, the system, who reads its frames, elements' lengths m, notes."""

    layout: Layout
    system: System
    observer: Observer
    lengths: list[float]
    notes: list[str]


def assemble_cables(
    scene: CableScene,
    more: Callable[[Layout], list[Any]] = lambda layout: [],
    functions: TimeFunctions | None = None,
) -> Assembly:
    """Number a scene's unknowns and make its groups; ``more`` adds an application's own.

    ``functions`` are those of the scene, in which some are held at other values: what is driven at one rate flows on.

    An application's groups may couple what an element couples already, and nothing else.

    Raises
    ------
    SceneError
        For constraints that say a thing twice or contradict each other, and for nodes whose position along the rope and
        p are both free.
    """
    material = material_coordinates(scene)
    lengths = [abs(material[e.nodes[1]] - material[e.nodes[0]]) for e in scene.elements]
    mass, force = mass_of(scene), largest_force(scene)
    layout = Layout(scene, material, force, float(np.median(lengths)), functions)
    made = equations_of(layout)
    check_sound(layout, made)
    sections = Sections(scene.elements)
    elements = element_groups(layout, sections)
    whole, massive = stencils(layout, elements)
    constraints, notes = constraint_groups(layout, made, mass / max(1, len(scene.nodes)) or 1.0)
    loose = _node_groups(layout)
    groups = (*elements, *loose, *more(layout), *constraints, *eyelets(layout, made))
    algebraic: list[int] = []
    for group in constraints:
        table = group.equations
        rows = [table.place[table.start[i] : table.start[i + 1]] for i in range(table.offset.size)]
        if isinstance(group, Multipliers):
            algebraic = [int(i) for i in group.unknown]
            pairs = [np.append(row, group.unknown[i])[None, :] for i, row in enumerate(rows)]
            massive += pairs
            whole += pairs
        else:
            whole += [row[None, :] for row in rows]
    for part in scene.nodal:
        whole += [places[None, :] for places in item_of(part).coupled(layout, part)]
    system = assemble(
        groups, layout.degrees, layout.functions, layout.velocity, whole, massive, algebraic=algebraic,
        flowing=steady_flow(layout),
    )  # fmt: skip
    system.q[: layout.initial.size] = layout.initial
    system.force, system.reach = force, FAR * float(np.ptp(layout.initial))
    system.given, system.hidden, system.softer = acting_force(scene), outweighs(scene), too_stiff(scene)
    system.neighbours = (layout.starts[layout.ends][:, None, :] + np.arange(3)[:, None]).reshape(-1, 2)
    system.room, system.room_between = rooms(layout, lengths)
    system.slopes = layout.slopes
    observer = Observer(layout, sections, groups, [e.name for e in made if e.tie.method != "penalty"])
    return Assembly(layout, system, observer, lengths, notes)


def build(scene: CableScene, functions: TimeFunctions | None = None) -> Model:
    """Compile a scene; see :func:`assemble_cables`.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        As :func:`assemble_cables` does.
    """
    layout, system, observer, lengths, notes = assemble_cables(scene, functions=functions)
    notes += unused_alphas(scene.solver)
    solver = scene.solver
    error = error_of_steps(solver, ERROR * sum(lengths))
    if solver.step == "auto" and error > 0.0:
        notes.append(f"time_step: auto keeps the error of a step below {error:.2g} m")
    model = Model(
        system=system,
        solver=settings_of(
            solver, solver.interval, solver.tolerance, "energy", error,
            projection=solver.projection, stabilise=solver.stabilise, energy_unit=1.0, contraction=CONTRACTION,
        ),
        variables=variables(observer),
        coordinates=observer.coordinates(),
        attributes=attributes_of(
            scene, "cable", "axial_force is positive in tension and counts the damping; material_coordinate is p",
            BESIDES_MODEL,
        ),
        observe=observer.observe,
        frames_tell_all=False,
        headline=lambda result: headline(result, scene),
        limits=lambda result: limits(result, scene, observer.sections.numbers().stiffness),
        remarks=lambda result: overtaken(result, scene),
        figure_units=figure_units(scene),
        statistics={"rules": EXTREMES},
        start=solver.start,
        step_limit=max(0.5 * min(lengths), 1e-9),
        notes=notes,
        handles=lambda: handles(layout, system.groups, model),
        cause=lambda state, status: (
            empty_element(layout, state, status)
            or stiff_tie(layout, system, state, status)
            or stiff_along(system, state, status)
        ),
        anew=lambda held: build(scene, held),
    )  # fmt: skip
    return with_limits(within_rounding(model, "eps_energy", MANY, rounding_error(scene)), scene)


def _node_groups(layout: Layout) -> list[Any]:
    """Groups of the items on nodes: of those kinds that the scene has."""
    groups: list[Any] = []
    for key, item in NODAL.items():
        if parts := layout.scene.items_of(key):
            groups += item.groups(layout, parts)
    return groups
