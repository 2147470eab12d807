"""A drill-string scene as a beam in space: ALE-ANCF elements with bending, twist, the wall and mud at points of them.

A node has position r, slope r', its material coordinate p, which is held, and the rotation theta. Elements end where
sections do. The wall and the mud act at two points of each and at the bit (beam_points.py).
The top moves on the straight line through the table's centre, as a block in its derrick does.
"""

from __future__ import annotations

import numpy as np

import tautline.elements.cable  # noqa: F401  (terms of the same elements run together)
from drillstring.drilling.end_groups import BLOCK, ROTATION, Along, groups_at_ends, is_driven
from drillstring.groups.beam_contact import BeamContact
from drillstring.groups.beam_eccentricity import OFF_AXIS, BeamEccentricity
from drillstring.groups.beam_mud import SLEEVE, BeamMud
from drillstring.groups.beam_points import NODE, TURN, Points, hole_of, nodes_as_points, nodes_of, points_of
from drillstring.groups.contact import PAD
from drillstring.model.assembled import Assembled
from drillstring.model.lumped_model import reach
from drillstring.model.lumped_string import law_of
from drillstring.results.beam_observe import BeamObserver
from drillstring.scene.scene import DrillstringScene
from drillstring.string.fluid import Fluid, fluid_of, mass_beside, weight_in
from drillstring.string.lumps import Lumps
from drillstring.well.in_hole import Hole
from drillstring.well.wellbore import Wellbore
from tautline.elements.beam.bending import BENDING, new_bending
from tautline.elements.beam.twist import TWISTED, Twist
from tautline.elements.beam.weld import Welds
from tautline.elements.cubic import AXES, MATERIAL
from tautline.elements.inertia import INERTIA, Inertia
from tautline.elements.tension import TENSION, new_tension
from tautline.kernels.hermite import gauss, lobatto, table
from tautline.kernels.time_function import TimeFunctions, value_at
from tautline.system.records import records
from tautline.system.system import Degrees, assemble

NAMES = ("north", "east", "down", "slope north", "slope east", "slope down", "material coordinate", "rotation")
ROUNDING = 1.0e-6
"""Share of EA that counts as a large force where a string weighs next to nothing, as in the lumped model."""
TOUCHING = 1.0e-6
"""Side force of a soft string over the weight per metre, beyond which it is looked for at the wall."""
WELDED = 1.0e4
"""Stiffness that keeps the slopes on both sides of a change of section in one direction, over that of an element."""
ACROSS = 1.0e-12
"""Cosine below which a direction counts as square to an axis."""


def assemble_beam(
    scene: DrillstringScene, well: Wellbore, mesh: Lumps, functions: TimeFunctions, law: str
) -> Assembled:
    """The ALE-ANCF model of a string in its hole; ``law`` is the friction law that the method can take."""
    start = [value_at(functions, k, 0.0) for k in (BLOCK, ROTATION)]
    moving = any(rate != 0.0 for _, rate, _ in start)
    points = points_of(mesh)
    elements = _elements(scene, mesh)
    around = _around(scene, well, mesh, points, law, moving)
    degrees, carriers = _degrees(scene, well, mesh, start[BLOCK][0])
    last = NODE * mesh.length.size
    direction = well.frame(mesh.measured_depth[-1])[2]
    datum = float(mesh.measured_depth[-1] - direction @ well.position(mesh.measured_depth[-1]))
    bit = Along(last + np.arange(AXES), direction, datum)
    groups = (*elements, *around, *groups_at_ends(scene, functions, TURN, bit, last + TURN, mesh.tubes))
    velocity = _velocity(well, mesh, start[BLOCK], start[ROTATION][1], len(degrees.names))
    velocity[[axial for axial, _ in carriers]] = start[BLOCK][1]
    stencils = _stencils(mesh, groups, carriers)
    driven = is_driven(scene)
    system = assemble(groups, degrees, functions, velocity, *stencils, at_rest=[TURN] if driven else [])
    return Assembled(system, BeamObserver(scene, well, mesh, points, groups), reach(scene, mesh))


def _elements(scene: DrillstringScene, mesh: Lumps) -> list:
    """Inertia with weight, tension, bending and twist of every element."""
    fluid, damping = fluid_of(scene.mud), scene.damping
    nodes, n = nodes_of(mesh), mesh.length.size
    ends = {"a": nodes.a, "b": nodes.b}
    mass = mesh.of_links(lambda tube: tube.mass_per_length)
    # What is given for a lump belongs to the length of one.
    per_metre = (scene.well.wall.lumps if scene.well.wall is not None else 12) / mesh.total
    load = np.zeros((n, AXES))
    load[:, 2] = mesh.of_links(lambda tube: weight_in(fluid, tube, scene.gravity))
    groups = [
        Inertia(
            records(
                n, INERTIA, **ends, mass=mass, load=load,
                damping=damping.mass_proportional + damping.translation * per_metre / mass,
            ),
            np.zeros((4, 4)),
        ),
        new_tension(
            records(
                n, TENSION, **ends, stiffness=mesh.of_links(lambda tube: tube.youngs_modulus * tube.area),
                damping=damping.structural, engineering=1,
            ),
            table(*lobatto()),
        ),
    ]  # fmt: skip
    if scene.model.bending != "none":
        rigidity = mesh.of_links(lambda tube: tube.youngs_modulus * tube.second_moment)
        rows = records(n, BENDING, **ends, stiffness=rigidity)
        groups.append(new_bending(rows, table(*gauss(3))))
        if nodes.twins.size:
            below = nodes.twins[:, 1] // NODE
            stiff = 4.0 * rigidity / mesh.length
            welds = WELDED * np.maximum(stiff[below - 1], stiff[below])
            groups.append(Welds(nodes.twins[:, 1] + AXES, nodes.twins[:, 0] + AXES, welds))
    inertia = 0.5 * mesh.length * mesh.of_links(lambda tube: tube.rotary_inertia)
    drag = 0.5 * mesh.length * damping.rotation * per_metre + damping.mass_proportional * inertia
    groups.append(
        Twist(
            records(
                n, TWISTED, a=ends["a"] + TURN, b=ends["b"] + TURN, damping=damping.structural, inertia=inertia,
                stiffness=mesh.of_links(lambda tube: tube.torsional_stiffness) / mesh.length, drag=drag,
            )
        )
    )  # fmt: skip
    return groups


def _around(scene: DrillstringScene, well: Wellbore, mesh: Lumps, points: Points, law: str, moving: bool) -> list:
    """What the hole does to the string: the wall and mud at all points, and centres of gravity off the axis."""
    fluid, groups = fluid_of(scene.mud), []
    hole = hole_of(well, points)
    beside = points.of(lambda tube: mass_beside(fluid, tube, scene.well.diameter))
    drag = 0.5 * fluid.density * fluid.drag * points.of(lambda tube: tube.od)
    if np.any(beside > 0.0) or np.any(drag > 0.0):
        rows = records(beside.size, SLEEVE, mass=beside, damping=scene.damping.mass_proportional * beside, drag=drag)
        groups.append(BeamMud(hole, rows, np.zeros((AXES, AXES))))
    mass = mesh.of_lumps(lambda tube: tube.mass_per_length)
    off = [mesh.of_lumps(lambda tube, k=k: tube.mass_per_length * tube.eccentricity[k]) / mass for k in (0, 1)]
    at = np.flatnonzero(np.hypot(*off) > 0.0)
    if at.size:
        weight = mesh.of_lumps(lambda tube: weight_in(fluid, tube, scene.gravity))
        rows = records(at.size, OFF_AXIS, mass=mass[at], weight=weight[at], e1=off[0][at], e2=off[1][at])
        groups.append(BeamEccentricity(hole_of(well, nodes_as_points(mesh, at)), rows))
    if scene.well.wall is not None:
        groups.append(_contact(scene, hole, points, fluid, law, moving))
    return groups


def _contact(scene: DrillstringScene, hole: Hole, points: Points, fluid: Fluid, law: str, moving: bool) -> BeamContact:
    """The wall at every point of the hole; what is given for a lump scales as in the lumped model."""
    wall = scene.well.wall
    assert wall is not None
    mesh = points.mesh
    od, contact_od = points.largest(lambda tube: tube.od), points.largest(lambda tube: tube.contact_od)
    share = points.length / (mesh.total / wall.lumps)
    scale = od / max(tube.od for tube in mesh.tubes) * share
    radius = 0.5 * contact_od
    mass = points.of(lambda tube: tube.mass_per_length)
    polar = points.of(lambda tube: tube.rotary_inertia)
    lateral = points.of(lambda tube: mass_beside(fluid, tube, scene.well.diameter))
    place = mesh.measured_depth[points.element] + points.place * mesh.length[points.element]
    # The stiffness that holds a point along the string: that of half elements up and down.
    stiffness = 4.0 * (mesh.of_links(lambda tube: tube.youngs_modulus * tube.area) / mesh.length)[points.element]
    return BeamContact(
        hole=hole,
        law=law_of(
            wall, law, place - 0.5 * points.length, place + 0.5 * points.length, mass, stiffness,
            1.0 / (1.0 / (mass + lateral) + radius**2 / polar), moving,
        ),
        springs=records(
            scale.size, PAD, stiffness=wall.stiffness * scale, damping=wall.damping * scale,
            clearance=0.5 * (scene.well.diameter - contact_od), radius=radius,
            viscous=scene.damping.contact_rotation * share,
        ),
        scratch=np.zeros((2, AXES + 1, AXES + 1)),
    )  # fmt: skip


def _degrees(
    scene: DrillstringScene, well: Wellbore, mesh: Lumps, block: float
) -> tuple[Degrees, list[tuple[int, int]]]:
    """Eight degrees of freedom a node, and the ends' ways along the hole; with the nodes that those carry."""
    nodes = nodes_of(mesh)
    at = np.append(np.arange(mesh.length.size + 1), nodes.twins[:, 1] // NODE)
    weight = mesh.of_lumps(lambda tube: weight_in(fluid_of(scene.mud), tube, scene.gravity))
    stiffness = mesh.of_links(lambda tube: tube.youngs_modulus * tube.area)
    force = float(np.abs(weight).sum()) + abs(scene.bit.load) + ROUNDING * float(stiffness.max())
    radius = max(tube.od for tube in mesh.tubes) / 2.0
    section = np.append(mesh.section, mesh.section[-1])[at]
    names = [
        f"{mesh.tubes[k].name} at {mesh.measured_depth[i]:.1f} m: {name}"
        for i, k in zip(at, section, strict=True)
        for name in NAMES
    ]
    moment = (force * mesh.tributary)[at]
    scale = np.column_stack([np.full((nodes.count, 3), force), np.tile(moment[:, None], 3)])
    scale = np.column_stack([scale, np.ones(nodes.count), np.full(nodes.count, force * radius)])
    degrees = Degrees(names, _at_first(scene, well, mesh, block).ravel(), scale.ravel())
    for twin, node in nodes.twins:
        for k in (0, 1, 2, TURN):
            degrees.tie(int(twin) + k, [(int(node) + k, 1.0)])
    for i in range(nodes.count):
        degrees.fix(NODE * i + MATERIAL)
    if not is_driven(scene):
        degrees.prescribe(TURN, ROTATION)
    carriers = [(_guide(degrees, 0, well, 0.0, "block", force), 0)]
    degrees.prescribe(carriers[0][0], BLOCK)
    degrees.value[carriers[0][0]] = 0.0
    if scene.bit.lateral == "pinned":
        bit = NODE * mesh.length.size
        carriers.append((_guide(degrees, bit, well, float(mesh.measured_depth[-1]), "bit", force), bit))
    return degrees, carriers


def _at_first(scene: DrillstringScene, well: Wellbore, mesh: Lumps, block: float) -> np.ndarray:
    """Unknowns of the nodes (k, NODE) of a string in the hole, from which the search for an equilibrium begins.

    A string that is to start straight is unstretched on the axis. Else it hangs in the tension of its weight, and lies
    where a string without stiffness does: Newton's method, begun on the axis, would throw it far across the wall.
    """
    nodes = nodes_of(mesh)
    strain = np.zeros(mesh.length.size)
    if scene.start != "straight":
        fluid = fluid_of(scene.mud)
        depth = well.tvd(mesh.measured_depth)
        weight = mesh.of_links(lambda tube: weight_in(fluid, tube, scene.gravity)) * np.diff(depth)
        tension = np.cumsum(weight[::-1])[::-1] - 0.5 * weight + scene.bit.load
        strain = tension / mesh.of_links(lambda tube: tube.youngs_modulus * tube.area)
    place = block + mesh.measured_depth + np.append(0.0, np.cumsum(strain * mesh.length))
    position, tangent = well.position(place), well.frame(place)[2]
    if scene.well.wall is not None and scene.start != "straight":
        position = position + _to_the_wall(scene, well, mesh, place, tension)
    rows = np.zeros((nodes.count, NODE))
    every = np.append(np.arange(place.size), nodes.twins[:, 1] // NODE)
    rows[:, :AXES], rows[:, MATERIAL] = position[every], mesh.measured_depth[every]
    # An element's slopes are stretched as it is; where two meet in one slope, by what they are in the mean.
    count = np.bincount(nodes.a // NODE, minlength=nodes.count) + np.bincount(nodes.b // NODE, minlength=nodes.count)
    sums = np.bincount(nodes.a // NODE, strain, nodes.count) + np.bincount(nodes.b // NODE, strain, nodes.count)
    rows[:, AXES : 2 * AXES] = (1.0 + sums / count)[:, None] * tangent[every]
    return rows


def _to_the_wall(
    scene: DrillstringScene, well: Wellbore, mesh: Lumps, place: np.ndarray, tension: np.ndarray
) -> np.ndarray:
    """From the hole's axis to where the side force w + T K of a soft string presses each node, (n + 1, 3) m."""
    wall = scene.well.wall
    assert wall is not None
    m1, m2, t = well.frame(place)
    k1, k2 = well.curvature(place)
    weight = mesh.of_lumps(lambda tube: weight_in(fluid_of(scene.mud), tube, scene.gravity)) / mesh.tributary
    pulled = 0.5 * (np.append(tension[:1], tension) + np.append(tension, tension[-1:]))
    side = weight[:, None] * (np.array([0.0, 0.0, 1.0]) - t[:, 2:] * t)
    side += pulled[:, None] * (k1[:, None] * m1 + k2[:, None] * m2)
    size = np.linalg.norm(side, axis=1)
    od, contact_od = mesh.largest(lambda tube: tube.od), mesh.largest(lambda tube: tube.contact_od)
    stiffness = wall.stiffness * od / od.max() * wall.lumps / mesh.total
    depth = 0.5 * (scene.well.diameter - contact_od) + size / stiffness
    touches = size > TOUCHING * weight.max()
    touches[0] = False
    if scene.bit.lateral == "pinned":
        touches[-1] = False
    return np.where(touches, depth / np.where(touches, size, 1.0), 0.0)[:, None] * side


def _guide(degrees: Degrees, node: int, well: Wellbore, depth: float, name: str, force: float) -> int:
    """Let a node move on the hole's tangent at a depth only: r = r(depth) + t x. Returns the place of x."""
    axial = len(degrees.names)
    degrees.names.append(f"{name}: along the hole")
    degrees.value, degrees.scale = np.append(degrees.value, 0.0), np.append(degrees.scale, force)
    at, along = well.position(depth), well.frame(depth)[2]
    degrees.value[axial] = float(along @ (degrees.value[node : node + AXES] - at))
    for c in range(AXES):
        if abs(along[c]) < ACROSS:
            degrees.value[node + c] = at[c]
            degrees.fix(node + c)
        else:
            degrees.tie(node + c, [(axial, float(along[c]))], float(at[c]))
    return axial


def _velocity(well: Wellbore, mesh: Lumps, block: tuple[float, float, float], spin: float, size: int) -> np.ndarray:
    """All of the string moves along the hole as the block does, and turns as the rotary does."""
    nodes = nodes_of(mesh)
    at = np.append(np.arange(mesh.length.size + 1), nodes.twins[:, 1] // NODE)
    place = mesh.measured_depth[at] + block[0]
    m1, m2, t = well.frame(place)
    k1, k2 = well.curvature(place)
    rows = np.zeros((nodes.count, NODE))
    rows[:, :3] = block[1] * t
    rows[:, 3:6] = block[1] * (k1[:, None] * m1 + k2[:, None] * m2)
    rows[:, TURN] = spin
    return np.append(rows.ravel(), np.zeros(size - rows.size))


def _stencils(mesh: Lumps, groups: tuple, carriers: list[tuple[int, int]]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Degrees of freedom that the tangents and the mass matrix couple, a row each."""
    nodes = nodes_of(mesh)
    pairs = np.column_stack([nodes.a, nodes.b])[:, :, None]
    whole = [(pairs + np.arange(NODE)).reshape(mesh.length.size, -1)]
    if nodes.twins.size:
        whole.append((nodes.twins[:, :, None] + np.arange(AXES, 2 * AXES)).reshape(len(nodes.twins), -1))
    if any(isinstance(g, BeamMud | BeamEccentricity) for g in groups):
        return whole, whole
    axes = (pairs + np.array([0, AXES])).reshape(mesh.length.size, 1, -1) + np.arange(AXES)[None, :, None]
    mass = [axes.reshape(AXES * mesh.length.size, -1)]
    # A node that is guided couples the directions of its way.
    mass += [node + np.arange(2 * AXES)[None, :] for _, node in carriers]
    return whole, mass
