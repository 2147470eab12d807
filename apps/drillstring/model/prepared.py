"""What a run, its warnings, statics, modes and figures all need of a scene: the hole, and the pipe in it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drillstring.scene.hole import DRILLED, Build, Hold
from drillstring.scene.scene import DrillstringScene, Section, check_lengths
from drillstring.string.buoyancy import check_weight
from drillstring.string.lumps import Lumps, ToolJoints, Tube, cut
from drillstring.well import wellbore
from drillstring.well.sections import dogleg_severity
from drillstring.well.survey import MAX_DOGLEG_SEVERITY, Survey, read_survey
from tautline.scene.errors import SceneError
from tautline.scene.reading.files import stamps
from tautline.scene.values.printed import shown


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scene before it is compiled.

    Attributes
    ----------
    well : Wellbore
        The curve of the hole.
    lumps : Lumps
        The string cut as the scene asks; its sections are ``lumps.tubes``.
    """

    well: wellbore.Wellbore
    lumps: Lumps


def prepared(scene: DrillstringScene) -> Prepared:
    """The hole and the string of a scene, made once for all that ask.

    Raises
    ------
    SceneError
        As `well_of` and `tubes_of` do.
    """
    well = well_of(scene)
    pipe = scene.string, scene.material, scene.mud, scene.model.elements
    return scene.once(
        "lumps", (*_hole(scene), *pipe), lambda: Prepared(well, cut(tubes_of(scene, well.length), scene.model.elements))
    )


def _hole(scene: DrillstringScene) -> tuple[Any, ...]:
    """What the curve of the hole depends on."""
    well = scene.well
    return well.sections, well.survey, well.diameter, well.inclination, well.azimuth, stamps(well, scene.folder)


def well_of(scene: DrillstringScene) -> wellbore.Wellbore:
    """The curve of the hole, made once.

    Raises
    ------
    SceneError
        Where sections or survey stations make no hole; a survey's by row.
    """
    return scene.once("hole", _hole(scene), lambda: _drilled(scene))


def survey_of(scene: DrillstringScene) -> Survey:
    """The stations of a hole that is given by a survey, read once.

    Raises
    ------
    SceneError
        Where there is no such file, and by row for what it may not hold.
    """
    return scene.once("survey", _hole(scene), lambda: _surveyed(scene))


def _surveyed(scene: DrillstringScene) -> Survey:
    given = scene.well.survey
    assert scene.document is not None and given is not None
    path = Path(scene.document.folder) / given.file
    if not path.is_file():
        cause = "is a folder, not a file" if path.is_dir() else f"there is no file {path}"
        raise SceneError([scene.problem("well.survey", cause, "give its path relative to the scene's folder")])
    return read_survey(path, given.units, max_gap=given.max_gap, max_dogleg_severity=_sharpest_bend(scene))


def _drilled(scene: DrillstringScene) -> wellbore.Wellbore:
    well = scene.well
    if well.survey is not None:
        survey = survey_of(scene)
        try:
            return wellbore.from_survey(survey.md, survey.inc, survey.azi)
        except wellbore.WellboreError as error:
            raise SceneError([scene.problem("well.survey", error.message, error.cure)]) from None
    _check_bends(scene)
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


def _sharpest_bend(scene: DrillstringScene) -> float:
    """Curvature, rad/m, beyond which a bend is taken for a slip of the pen; holes of the laboratory may have any."""
    return MAX_DOGLEG_SEVERITY if scene.well.diameter >= DRILLED else math.inf


def _check_bends(scene: DrillstringScene) -> None:
    """Refuse bends that no hole has, as those of a survey are."""
    problems, limit = [], _sharpest_bend(scene)
    for i, piece in enumerate(scene.well.sections or ()):
        if isinstance(piece, Hold) or piece.curvature <= limit:
            continue
        kind = "build" if isinstance(piece, Build) else "turn"
        bend, most = (dogleg_severity(one, scene.units) for one in (piece.curvature, limit))
        radius = shown(piece.bend_radius, "m", scene.units)
        cause = f"the hole bends by {bend}, a radius of {radius}; no well bends by more than {most}"
        problems.append(scene.problem(f"well.sections[{i}].{kind}.{piece.key}", cause, _usual(piece.key, scene.units)))
    if problems:
        raise SceneError(problems)


def _usual(key: str, system: str) -> str:
    """What to write for a bend that no hole has: a usual one, in the units of the scene."""
    if key == "radius":
        return f"give one such as {shown(570.0, 'm', system)}"
    return f"write it with its unit, such as {'3 deg/100ft' if system == 'field' else '3 deg/30m'}"


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
        joints = _joints_of(section)
        area = np.pi / 4.0 * (section.od**2 - section.id**2)
        if joints is not None:
            area += joints.share * (np.pi / 4.0 * (joints.od**2 - joints.id**2) - area)
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
                joints=joints,
            )
        )
    check_weight(scene, tubes)
    return tubes


def _joints_of(section: Section) -> ToolJoints | None:
    """Tool joints that count in mass and torsion; None where their length and spacing are not given."""
    if section.tool_joint_length is None or section.tool_joint_spacing is None:
        return None
    bore = section.id if section.tool_joint_id is None else section.tool_joint_id
    return ToolJoints(section.contact_diameter, bore, section.tool_joint_length / section.tool_joint_spacing)
