"""A drill-string scene as lumps: its groups, its degrees of freedom, and how they are coupled."""

from __future__ import annotations

import numpy as np

from drillstring.drilling.end_groups import BLOCK, ROTATION, Along, groups_at_ends, is_driven
from drillstring.model.assembled import Assembled
from drillstring.model.lumped_string import (
    bends_of,
    bodies_of,
    buoyed_weight,
    contact_of,
    curve_of,
    drag_of,
    lateral_mass,
    links_of,
)
from drillstring.results.observe import Observer
from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.kernels.time_function import TimeFunctions, value_at
from tautline.lumped.bend import Bends
from tautline.lumped.body import EccentricBodies
from tautline.lumped.curve import PER_BODY
from tautline.system.system import Degrees, assemble

DIRECTIONS = ("along the hole", "north side", "east side", "rotation")
ROUNDING = 1.0e-6
"""Share of EA that counts as a large force where a string weighs next to nothing: its residual cannot be smaller than
the rounding of its stiffness."""
REACH = 0.3
"""Part of the shortest link by which a lump may move in one iteration of the search for an equilibrium."""
IN_A_HOLE, GIVING = 1.0, 1.0 / 30.0
"""That way in a hole, m; and over the stretch of the string if it hung straight down and its depth in a soft wall."""
SAGGING = 1.0 / 300.0
"""The same over the string's length, at least, in free space: there a string may sag by as much as it is long."""


def assemble_lumps(
    scene: DrillstringScene, well: Wellbore, lumps: Lumps, functions: TimeFunctions, law: str
) -> Assembled:
    """The lumped model of a string in its hole; ``law`` is the friction law that the method can take."""
    start = [value_at(functions, k, 0.0) for k in (BLOCK, ROTATION)]
    moving = any(rate != 0.0 for _, rate, _ in start)
    driven = is_driven(scene)
    groups, weight = _groups(scene, well, lumps, functions, law, moving)
    degrees = _degrees(scene, lumps, weight, driven)
    degrees.value[PER_BODY::PER_BODY] = start[BLOCK][0]
    velocity = np.zeros(degrees.value.size)
    velocity[0::PER_BODY] = start[BLOCK][1]
    velocity[3::PER_BODY] = start[ROTATION][1]
    # While the equilibrium is sought nothing turns: a controller that asks for speed would wind the string up.
    system = assemble(
        groups, degrees, functions, velocity, *_stencils(lumps, groups), at_rest=[3] if driven else [],
        window=groups[0].curve.window,
    )  # fmt: skip
    first = PER_BODY * np.arange(lumps.length.size)
    system.neighbours, system.reach = np.column_stack((first, first + PER_BODY)), _axial_limit(scene, lumps)
    return Assembled(system, Observer(well, lumps, groups, driven), reach(scene, lumps))


def reach(scene: DrillstringScene, lumps: Lumps) -> float:
    """How far a lump or a node may move in one iteration of the search for an equilibrium, m.

    In a hole it is little, but for a string that stretches by much: thrown far across the wall, a string may come to
    rest where none would lie, folded up or pressed through, and that is an equilibrium too.
    """
    short, axial_limit = REACH * float(lumps.length.min()), _axial_limit(scene, lumps)
    return max(short, axial_limit) if scene.well.wall is None else min(short, axial_limit)


def _axial_limit(scene: DrillstringScene, lumps: Lumps) -> float:
    """How far lumps may move along the hole in one such iteration, m, their neighbours with them."""
    if scene.well.wall is None:
        return SAGGING * lumps.total
    weight = lumps.of_lumps(lambda tube: weight_in(fluid_of(scene.mud), tube, scene.gravity))
    stiffness = lumps.of_links(lambda tube: tube.youngs_modulus * tube.area).min()
    whole = float(np.abs(weight).sum())
    stretch = (0.5 * whole + abs(scene.bit.load)) * lumps.total / float(stiffness)
    sinking = whole / (scene.well.wall.stiffness * scene.well.wall.lumps)
    return max(IN_A_HOLE, GIVING * (stretch + sinking))


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
        groups.append(drag_of(lumps, curve, fluid))
    if wall is not None:
        groups.append(
            contact_of(
                lumps, curve, links, lateral, scene.well.diameter, wall, scene.damping.contact_rotation, law, moving
            )
        )
    bit = PER_BODY * lumps.length.size
    depth = float(lumps.measured_depth[-1])
    along = Along(np.array([bit]), np.ones(1), depth)
    groups.extend(groups_at_ends(scene, functions, 3, along, bit + 3, lumps.tubes))
    return tuple(groups), weight


def _degrees(scene: DrillstringScene, lumps: Lumps, weight: np.ndarray, driven: bool) -> Degrees:
    """Four degrees of freedom a lump; the top one follows block and rotary and does not leave the axis."""
    count = lumps.length.size + 1
    stiffness = lumps.of_links(lambda tube: tube.youngs_modulus * tube.area)
    force = float(np.abs(weight).sum()) + abs(scene.bit.load) + ROUNDING * float(stiffness.max())
    radius = max(tube.od for tube in lumps.tubes) / 2.0
    sections, depths = np.append(lumps.section, lumps.section[-1]).tolist(), lumps.measured_depth.tolist()
    places = [
        f"{lumps.tubes[section].name} at {depth:.1f} m: " for section, depth in zip(sections, depths, strict=True)
    ]
    names = [place + direction for place in places for direction in DIRECTIONS]
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
