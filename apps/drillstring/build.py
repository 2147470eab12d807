"""A drill-string scene compiled into a model: wellbore, lumps, groups, start."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import numpy as np

from drillstring import wellbore
from drillstring.contact import WallContact
from drillstring.end_groups import BLOCK, ROTATION, Along, groups_at_ends, is_driven
from drillstring.ends import Controller
from drillstring.hole import Build, Hold
from drillstring.lumped_string import (
    bends_of,
    bodies_of,
    buoyed_weight,
    contact_of,
    curve_of,
    drag_of,
    fluid_of,
    lateral_mass,
    links_of,
)
from drillstring.observe import COORDINATE_UNITS, Observer, headline, variables
from drillstring.scene import DrillstringScene, check_lengths
from drillstring.string import Lumps, Tube, cut
from drillstring.survey import read_survey
from tautline.kernels.groups import offers
from tautline.kernels.time_function import evaluate
from tautline.lumped.bend import Bends
from tautline.lumped.body import EccentricBodies
from tautline.lumped.curve import PER_BODY
from tautline.scene.errors import SceneError
from tautline.scene.solver import error_of_steps, longest_step
from tautline.system.model import Model, SolverSettings
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import FunctionRequest, compile_functions

DIRECTIONS = ("along the hole", "north side", "east side", "rotation")
ROUNDING = 1.0e-6
"""Share of EA that counts as a large force where a string weighs next to nothing: its residual cannot be smaller than
the rounding of its stiffness."""
TOLERANCE = 1.0e-9
"""Largest residual over the string's weight that counts as solved: a millinewton on a meganewton."""
STEP_ERROR = 1.0e-5
"""Error of a step, m, where the step is chosen and the scene gives none."""


def well_of(scene: DrillstringScene) -> wellbore.Wellbore:
    """The curve of the hole.

    Raises
    ------
    SceneError
        Where sections or survey stations make no hole; a survey's by row.
    """
    well = scene.well
    if well.survey is not None:
        assert scene.document is not None
        path = Path(scene.document.folder) / well.survey.file
        survey = read_survey(path, well.survey.units, max_gap=well.survey.max_gap)
        try:
            return wellbore.from_survey(survey.md, survey.inc, survey.azi)
        except wellbore.WellboreError as error:
            raise SceneError([scene.problem("well.survey", error.message, error.cure)]) from None
    pieces: list[wellbore.Section] = []
    for piece in well.sections or ():
        if isinstance(piece, Hold):
            pieces.append(wellbore.Hold(piece.length))
        elif isinstance(piece, Build):
            pieces.append(wellbore.Build(piece.bend_radius, piece.to, piece.azimuth))
        else:
            pieces.append(wellbore.Turn(piece.bend_radius, piece.to))
    try:
        return wellbore.from_sections(pieces, well.inclination, well.azimuth)
    except wellbore.WellboreError as error:
        key = "well.sections" if error.index is None else f"well.sections[{error.index}]"
        raise SceneError([scene.problem(key, error.message, error.cure)]) from None


def tubes_of(scene: DrillstringScene, well_length: float) -> list[Tube]:
    """Sections of the string with their material, and ``rest`` resolved; raises SceneError as check_lengths does."""
    tubes = []
    for section, length in zip(scene.string, check_lengths(scene, well_length), strict=True):
        steel = scene.material
        density = section.density or steel.density
        area = np.pi / 4.0 * (section.od**2 - section.id**2)
        tubes.append(
            Tube(
                name=section.name,
                length=length,
                od=section.od,
                id=section.id,
                contact_od=section.contact_diameter,
                youngs_modulus=section.youngs_modulus or steel.youngs_modulus,
                shear_modulus=section.shear_modulus or steel.shear_modulus,
                density=density,
                mass_per_length=section.mass_per_length or density * area,
                second_moment=section.second_moment or np.pi / 64.0 * (section.od**4 - section.id**4),
                eccentricity=tuple(section.eccentricity),
                elements=section.elements,
            )
        )
    return tubes


def build(scene: DrillstringScene) -> Model:
    """Compile a scene.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        For what only the wellbore and the lumps can tell: a string longer than the hole, a survey with a gap.
    """
    well = well_of(scene)
    lumps = cut(tubes_of(scene, well.length), scene.model.elements)
    functions = compile_functions(_requests(scene))
    start = [evaluate(functions, k, 0.0) for k in (BLOCK, ROTATION)]
    driven = is_driven(scene)
    law, notes = _law(scene)
    moving = any(rate != 0.0 for _, rate, _ in start)
    groups, weight = _groups(scene, well, lumps, functions, law, moving)
    degrees = _degrees(scene, lumps, weight, driven)
    degrees.value[PER_BODY::PER_BODY] = start[BLOCK][0]
    velocity = np.zeros(degrees.value.size)
    velocity[0::PER_BODY] = start[BLOCK][1]
    velocity[3::PER_BODY] = start[ROTATION][1]
    # While the equilibrium is sought nothing turns: a controller that asks for speed would wind the string up.
    system = assemble(groups, degrees, functions, velocity, *_stencils(lumps, groups), at_rest=[3] if driven else [])
    observer = Observer(well, lumps, groups, driven)
    solver = scene.solver
    alpha_m, alpha_f = solver.alphas
    contacts = sum(g.springs.size for g in groups if isinstance(g, WallContact))
    criterion = solver.criterion or ("force" if offers(groups, "switch") else "energy")
    return Model(
        system=system,
        solver=SolverSettings(
            solver.method, longest_step(solver, scene.output.interval), solver.end, scene.output.interval,
            alpha_m, alpha_f, solver.tolerance or TOLERANCE, criterion, solver.max_iterations,
            solver.max_halvings, step_error=error_of_steps(solver, STEP_ERROR), automatic=solver.step == "auto",
        ),
        variables=variables(),
        coordinates=observer.coordinates(),
        attributes={
            "scene": scene.document.text if scene.document is not None else "",
            "title": scene.title or "",
            "application": "drillstring",
            "physics": _physics(scene),
            "conventions": COORDINATE_UNITS,
            "units": scene.units,
        },
        observe=observer.observe,
        headline=lambda result: headline(result, lumps),
        start="as given" if scene.start == "straight" else scene.start,
        step_limit=0.3 * float(lumps.length.min()),
        own=3 * contacts + (1 if driven else 0),
        notes=notes,
    )  # fmt: skip


def _physics(scene: DrillstringScene) -> str:
    """Hash of all that a scene says but how it is solved and what is kept: a run can be gone on with if it agrees."""
    said = scene.model_dump(exclude={"title", "units", "solver", "output"})
    return sha256(repr(said).encode()).hexdigest()[:16]


def _requests(scene: DrillstringScene) -> list[FunctionRequest]:
    """Block position, and the rotary's angle from where it is at t = 0."""
    rotation = scene.top.rotation
    speed = rotation.speed if isinstance(rotation, Controller) else rotation
    key = "top.rotation.controller.speed" if isinstance(rotation, Controller) else "top.rotation"
    return [
        FunctionRequest(scene.top.block, end=scene.solver.end, key="top.block"),
        FunctionRequest(speed, integrate=True, end=scene.solver.end, key=key),
    ]


def _law(scene: DrillstringScene) -> tuple[str, list[str]]:
    """The friction law that the method can take, and what to tell the user about it."""
    if scene.well.wall is None:
        return "none", []
    law = scene.well.wall.friction.law
    if law == "projection" and scene.solver.method == "rk4":
        if scene.well.wall.friction.static == 0.0:
            return "regularised", []
        speed = scene.well.wall.friction.slip_velocity
        return "regularised", [
            f"friction by projection is implicit: rk4 takes the regularised law instead, slip_velocity {speed:g} m/s "
            "(stuck lumps creep and chatter below their critical step; generalized-alpha does not)"
        ]
    return law, []


def _groups(scene, well, lumps: Lumps, functions, law: str, moving: bool):
    """The scene's groups, one of each kind that it has, and the lumps' buoyed weights."""
    fluid = fluid_of(scene.mud)
    wall = scene.well.wall
    curve = curve_of(well, lumps.measured_depth)
    weight = buoyed_weight(lumps, fluid, scene.gravity)
    lateral = lateral_mass(lumps, fluid, scene.well.diameter)
    reference = lumps.total / (wall.lumps if wall is not None else 12)
    links = links_of(lumps, curve, scene.damping.structural)
    groups = [bodies_of(lumps, curve, weight, lateral, scene.damping, lumps.tributary / reference), links]
    if scene.model.bending != "none" and lumps.length.size > 1:
        groups.append(bends_of(lumps, curve, scene.model.bending == "stiff"))
    if fluid.density * fluid.drag > 0.0:
        groups.append(drag_of(lumps, fluid))
    if wall is not None:
        groups.append(
            contact_of(
                lumps, curve, links, lateral, scene.well.diameter, wall, scene.damping.contact_rotation, law, moving
            )
        )
    bit = PER_BODY * lumps.length.size
    depth = float(lumps.measured_depth[-1])
    groups.extend(groups_at_ends(scene, functions, 3, Along(np.array([bit]), np.ones(1), depth), bit + 3))
    return tuple(groups), weight


def _degrees(scene: DrillstringScene, lumps: Lumps, weight: np.ndarray, driven: bool) -> Degrees:
    """Four degrees of freedom a lump; the top one follows block and rotary and does not leave the axis."""
    count = lumps.length.size + 1
    stiffness = lumps.of_links(lambda tube: tube.youngs_modulus * tube.area)
    force = float(np.abs(weight).sum()) + abs(scene.bit.force) + ROUNDING * float(stiffness.max())
    radius = max(tube.od for tube in lumps.tubes) / 2.0
    section = np.append(lumps.section, lumps.section[-1])
    names = [
        f"lump {i} of {count - 1} ({lumps.tubes[section[i]].name}, md {lumps.measured_depth[i]:.0f} m): {direction}"
        for i in range(count)
        for direction in DIRECTIONS
    ]
    degrees = Degrees(names, np.zeros(PER_BODY * count), np.tile([force, force, force, force * radius], count))
    degrees.prescribe(0, BLOCK)
    degrees.fix(1)
    degrees.fix(2)
    if not driven:
        degrees.prescribe(3, ROTATION)
    if scene.bit.lateral == "pinned":
        degrees.fix(PER_BODY * (count - 1) + 1)
        degrees.fix(PER_BODY * (count - 1) + 2)
    return degrees


def _stencils(lumps: Lumps, groups) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Degrees of freedom that the tangents and the mass matrix couple, a row each."""
    bodies = PER_BODY * np.arange(lumps.length.size + 1)[:, None]
    own = bodies + np.arange(PER_BODY)
    axial = bodies[:-1] + np.array([0, 1, 2, 4, 5, 6])
    torsional = bodies[:-1] + np.array([3, 7])
    stencils = [own, axial, torsional]
    if any(isinstance(g, Bends) for g in groups):
        stencils.append(bodies[:-2] + np.array([0, 1, 2, 4, 5, 6, 8, 9, 10]))
    eccentric = any(isinstance(g, EccentricBodies) for g in groups)
    return stencils, [own[:, 1:]] if eccentric else []
