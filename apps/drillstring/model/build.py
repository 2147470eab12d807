"""A drill-string scene compiled into a model: wellbore, lumps, groups, start."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from drillstring.drilling.end_groups import notes_of_ends
from drillstring.model.lumped_model import assemble_lumps
from drillstring.results.drilling import variables_of_ends
from drillstring.results.limits import limits
from drillstring.results.observe import COORDINATE_UNITS, headline, variables
from drillstring.scene.ends import Controller
from drillstring.scene.hole import Build, Hold
from drillstring.scene.scene import BEAM, DrillstringScene, check_lengths
from drillstring.string.buoyancy import check_weight
from drillstring.string.factors import factors_of
from drillstring.string.lumps import Tube, cut
from drillstring.well import wellbore
from drillstring.well.survey import read_survey
from tautline.integrators.statics.attainable import within_rounding
from tautline.kernels.groups import offers
from tautline.scene.errors import SceneError
from tautline.scene.identity import model_hash
from tautline.scene.solver import error_of_steps, longest_step, unused_alphas
from tautline.system.model import Model, SolverSettings
from tautline.system.time_functions import FunctionRequest, compile_functions

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
        if not path.is_file():
            cause = "is a folder, not a file" if path.is_dir() else f"there is no file {path}"
            raise SceneError([scene.problem("well.survey", cause, "give its path relative to the scene's folder")])
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
    """Sections of the string with their material, and ``rest`` resolved.

    Raises
    ------
    SceneError
        As check_lengths does, and for a string that floats.
    """
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
    check_weight(scene, tubes)
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
    functions = compile_functions(requests(scene))
    law, notes = _law(scene)
    notes += notes_of_ends(scene, lumps.tubes)
    # A note and no warning: the scene may well be meant to be run by each method.
    notes += unused_alphas(scene.solver)
    string = _assembler(scene.model.kind)(scene, well, lumps, functions, law)
    system, observer = string.system, string.observer
    solver = scene.solver
    alpha_m, alpha_f = solver.alphas
    criterion = solver.criterion or ("force" if offers(system.groups, "switch") else "energy")
    model = Model(
        system=system,
        solver=SolverSettings(
            solver.method, longest_step(solver, scene.output.interval), solver.end, scene.output.interval,
            alpha_m, alpha_f, solver.tolerance or TOLERANCE, criterion, solver.max_iterations,
            solver.max_halvings, step_error=error_of_steps(solver, STEP_ERROR), automatic=solver.step == "auto",
            newton=solver.newton,
        ),
        variables=variables() + variables_of_ends(system.groups),
        coordinates=observer.coordinates(),
        attributes={
            "scene": scene.document.text if scene.document is not None else "",
            "title": scene.title or "",
            "application": "drillstring",
            "model_hash": model_hash(scene, folder=scene.folder),
            "conventions": COORDINATE_UNITS,
            "units": scene.units,
        },
        observe=observer.observe,
        headline=lambda result: headline(result, lumps, scene.top.weight),
        limits=lambda result: limits(result, scene, lumps),
        start="as given" if scene.start == "straight" else scene.start,
        step_limit=string.step_limit,
        confined=True,
        own=observer.own,
        notes=notes,
    )  # fmt: skip
    return within_rounding(model)


def _assembler(kind: str) -> Any:
    """What makes a system of the string, by the kind of its model."""
    if kind == BEAM:
        # Only a scene of a beam needs a beam's code.
        from drillstring.model.beam_model import assemble_beam

        return assemble_beam
    return assemble_lumps


def requests(scene: DrillstringScene) -> list[FunctionRequest]:
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
    if law == "projection" and scene.solver.explicit:
        if factors_of(scene.well.wall, "static").largest == 0.0:
            return "regularised", []
        speed = scene.well.wall.friction.slip_velocity
        return "regularised", [
            f"friction by projection is implicit: rk4 takes the regularised law instead, slip_velocity {speed:g} m/s "
            "(stuck lumps creep and chatter below their critical step; generalized-alpha does not)"
        ]
    return law, []
