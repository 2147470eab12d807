"""From the items of a file to the parts of a scene: ids looked up, defaults filled in, one item held against another.

All faults are collected and told at once. What needs lengths is left to `tautline.cable.input.material`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from tautline.cable.input import couplings as joints
from tautline.cable.input.geometry import COINCIDENT, chord, mean_direction
from tautline.cable.input.initial import initial_value
from tautline.cable.input.lines import Laid, lay, nodes_of
from tautline.cable.input.parts import CableScene, Curve, Element, Motion, Node, Place, Vector
from tautline.cable.input.register import Numbered, Register, known_ids
from tautline.cable.input.syntax import models as w
from tautline.cable.input.syntax.entries import DOFS
from tautline.cable.input.syntax.nodal import NODAL, item_of
from tautline.cable.input.syntax.thesis_compat import without_alternatives
from tautline.scene.errors import SceneWarning
from tautline.scene.reading.document import Document

STEEPEST = 1.0e3
"""Slope dr/dp, the stretch of the cable, that is surely something else."""


def resolve(written: w.WrittenCable, meant: Document, document: Document, before: Sequence[SceneWarning]) -> CableScene:
    """Make a scene of what is written.

    Parameters
    ----------
    written : WrittenCable
    meant, document : Document
        The file as its oddities are meant, for key paths in messages, and as it stands.
    before : sequence of SceneWarning
        What reading the file has found.

    Raises
    ------
    SceneError
        Listing every fault with its line, key and cure.
    """
    kept, warnings = without_alternatives(written.CableModel, meant)
    register = Register(meant, [(item.kind, item.model, ("CableModel", i, item.kind)) for i, item in kept])
    register.check_ids()
    motions = _motions(register)
    material = written.CableModelMaterial
    drawn = lay(register, material.Gravity)
    elements = _elements(register, material, drawn)
    nodes = _nodes(register, elements, {motion.id: motion for motion in motions}, drawn)
    ties, ignored = joints.ties(register)
    couplings = joints.couplings(register)
    scene = CableScene(
        title=written.title,
        gravity=material.Gravity,
        solver=written.GeneralizedAlpha,
        document=document,
        nodes=nodes,
        elements=elements,
        ties=ties,
        couplings=couplings,
        motions=motions,
        nodal=tuple(part for item in NODAL.values() for part in register.make(item.model, item.made)),
        plots=_plots(written, register),
        warnings=(*before, *warnings, *ignored),
        limits=written.limits,
    )
    register.report()
    _check_loose(scene, register)
    register.report()
    return scene


def _vector(values: tuple[float, ...]) -> Vector:
    return values[0], values[1], values[2]


def _motions(register: Register) -> tuple[Motion, ...]:
    made = []
    for _, model, place in register.of(w.VelocityDefined, w.Function):
        line = register.line(place)
        if isinstance(model, w.VelocityDefined):
            made.append(Motion(model.id, model.pos0, model.timeList, model.velocityList, None, line, place))
        else:
            made.append(Motion(model.id, initial_value(model.value), (), (), model.value, line, place))
    return tuple(made)


def _elements(register: Register, material: w.Material, drawn: dict[Place, Laid]) -> tuple[Element, ...]:
    made: list[Element] = []
    lines = {line.place: line for line in register.lines}
    for _, model, place in register.of(w.CubicElement, w.LinearElement, w.Line):
        if place in lines:
            section, laid = _section(register, model, material, place), drawn.get(place)
            if section is not None and laid is not None:
                line = lines[place]
                one = _element(register, model, place, line.kind, line.nodes[:2], section)._replace(length=laid.length)
                ends = zip(line.elements, pairwise(line.nodes), strict=True)
                # Of a hundred thousand alike `_replace` takes three times as long.
                (_, kind, _), same = one[:3], one[3:]
                made += [Element(id, kind, nodes, *same) for id, nodes in ends]
            continue
        cubic = isinstance(model, w.CubicElement)
        key, kind = ("nodes7", 7) if cubic else ("nodes4", 4)
        ids = model.nodes7 if cubic else model.nodes4
        instead = "use a CableALEelementLin with nodes4" if cubic else "use a CableALEelement with nodes7"
        good = [register.has_node((*place, key, i), node, kind, instead) for i, node in enumerate(ids)]
        section = _section(register, model, material, place)
        if ids[0] == ids[1]:
            register.refuse((*place, key), f"joins node {ids[0]} to itself", "name two nodes")
        elif all(good) and section is not None:
            made.append(_element(register, model, place, kind, (ids[0], ids[1]), section))
    return tuple(made)


def _section(register: Register, model: Any, material: w.Material, place: Place) -> dict[str, float] | None:
    """EA N, rhoA kg/m and damping s of an item, its own or the material's; None if one is missing, which is refused."""
    values: dict[str, float | None] = {}
    for name, default, example in (("EA", "CableStiffness", "1.0e6 (N)"), ("rhoA", "CableMass", "6.5 (kg/m)")):
        values[name] = getattr(model, name) if getattr(model, name) is not None else getattr(material, default)
        if values[name] is None:
            cure = f"add `{name}:`, such as {example}, or {default} to CableModelMaterial"
            register.refuse((*place, name), "is missing", cure)
    values["damping"] = model.cDamp if model.cDamp is not None else material.CableDamping or 0.0
    known = {name: value for name, value in values.items() if value is not None}
    return known if len(known) == len(values) else None


def _element(
    register: Register, model: Any, place: Place, kind: int, nodes: tuple[int, ...], section: dict[str, float]
) -> Element:
    return Element(
        id=model.id,
        kind="cubic" if kind == 7 else "linear",
        nodes=(nodes[0], nodes[1]),
        EJ=model.EJ,
        strain=model.strain,
        compression=model.compression,
        quadrature=model.quadrature if kind == 7 else None,
        load=_vector(model.load),
        line=register.line(place),
        place=place,
        **section,
    )


def _nodes(
    register: Register, elements: tuple[Element, ...], motions: dict[int, Motion], drawn: dict[Place, Laid]
) -> tuple[Node, ...]:
    made: list[Node] = []
    joined: dict[int, list[Element]] = {}
    for element in elements:
        for node in element.nodes:
            if node in register.nodes:
                joined.setdefault(node, []).append(element)
    lines: dict[int, list[Numbered]] = {}
    for line in register.lines:
        lines.setdefault(line.nodes[0], []).append(line)
    for _, model, place in register.of(w.Node7Dof, w.Node4Dof):
        kind = 7 if isinstance(model, w.Node7Dof) else 4
        names = DOFS[kind].split()
        for i, function in enumerate(model.BC_functions):
            at = (*place, "BC_functions", i)
            if function and function not in motions:
                cure = f"known: {known_ids(motions)}" if motions else "add a Function_VelocityDefined with this id"
                register.refuse(at, f"there is no function {function}", cure)
            elif function and not model.BC[i]:
                cause = f"function {function} cannot move {names[i]}, which BC leaves free"
                register.refuse(at, cause, f"set BC to 1 there (entry {i + 1}), or the function to 0")
        follows = motions.get(model.BC_functions[-1])
        if follows is not None and model.p is not None and model.p != follows.pos0:
            cause = f"function {follows.id}, which p follows, begins at {follows.pos0:g} m"
            register.refuse((*place, "p"), cause, "remove p, or give the function the same first value")
        slope = _slope(register, model, place, joined.get(model.id, []), drawn) if kind == 7 else None
        held = tuple(bool(flag) for flag in model.BC)
        made.append(
            Node(
                id=model.id,
                kind=kind,
                position=_vector(model.xyz),
                slope=slope,
                p=model.p,
                held=held,
                functions=tuple(model.BC_functions),
                line=register.line(place),
                place=place,
            )
        )
        # Nodes between two ends come between them, so that the numbers of neighbours are close to one another.
        for line in lines.pop(model.id, []):
            if line.place in drawn:
                made += nodes_of(line, drawn[line.place], register.line(line.place))
    for line in (line for some in lines.values() for line in some if line.place in drawn):
        made += nodes_of(line, drawn[line.place], register.line(line.place))
    return tuple(made)


def _slope(
    register: Register, model: w.Node7Dof, place: Place, joined: list[Element], drawn: dict[Place, Laid]
) -> Vector:
    """Slope of a cubic node: as given, or along the elements that it joins."""
    if model.xyz_d is not None:
        if math.hypot(*model.xyz_d) <= COINCIDENT:
            register.refuse((*place, "xyz_d"), "has no direction", "give the direction of the cable, such as [1, 0, 0]")
        elif math.hypot(*model.xyz_d) > STEEPEST:
            cause = f"is {math.hypot(*model.xyz_d):.3g} long, and dr/dp of an unstretched cable is 1"
            register.refuse((*place, "xyz_d"), cause, "give the direction of the cable, such as [1, 0, 0]")
        return _vector(model.xyz_d)
    along = [_tangent(register, element, model.id, drawn) for element in joined]
    mean = along[0] if len(along) == 1 and joined[0].place in drawn else mean_direction(along)
    if mean is None and joined:
        cause = "is missing, and the elements at the node point to no common direction"
        register.refuse((*place, "xyz_d"), cause, "add `xyz_d:`, the direction of the cable, such as [1, 0, 0]")
    return mean or (1.0, 0.0, 0.0)


def _tangent(register: Register, element: Element, node: int, drawn: dict[Place, Laid]) -> Vector:
    """Direction of an element at one of its nodes: its line's slope there, or its chord."""
    laid = drawn.get(element.place)
    if laid is not None:
        x, y, z = laid.slope[0 if element.nodes[0] == node else -1].tolist()
        return x, y, z
    return chord(*(_position(register, end, drawn) for end in element.nodes))


def _position(register: Register, node: int, drawn: dict[Place, Laid]) -> Vector:
    """Where a node is: as it is written, or where its line lies."""
    if node in register.nodes:
        return _vector(register.nodes[node].xyz)
    for line in register.lines:
        if line.place in drawn and node in line.between:
            x, y, z = drawn[line.place].place[1 + line.between.index(node)].tolist()
            return x, y, z
    return math.nan, math.nan, math.nan


def _check_loose(scene: CableScene, register: Register) -> None:
    """Refuse nodes that no element joins and whose free degrees of freedom nothing gives any mass."""
    joined = {node for element in scene.elements for node in element.nodes}
    heavy = {node for part in scene.nodal if item_of(part).mass(part) > 0.0 for node in part.nodes}
    slaves = {coupling.slave for coupling in scene.couplings}
    for node in scene.nodes:
        if node.id in joined:
            continue
        names = DOFS[node.kind].split()
        loose = [
            name
            for i, name in enumerate(names)
            if not node.held[i] and (node.id, i + 1) not in slaves and not (i < 3 and node.id in heavy)
        ]
        if loose:
            cause = f"no element joins node {node.id}, and BC leaves {', '.join(loose)} free: nothing there has a mass"
            register.refuse((*node.place, "BC"), cause, "hold them with 1, join the node to an element, or remove it")


def _plots(written: w.WrittenCable, register: Register) -> tuple[tuple[Curve, ...], ...]:
    elements = register.element_ids
    panels = []
    for i, panel in enumerate(written.Plots):
        curves = []
        for j, curve in enumerate(panel.SubPlot):
            place: Place = ("Plots", i, "SubPlot", j)
            if curve.Cable is not None and curve.Cable not in elements:
                cause = f"there is no cable element {curve.Cable}"
                register.refuse((*place, "Cable"), cause, f"known: {known_ids(elements)}", str(curve.Cable))
            if curve.Node is not None and register.has_node((*place, "Node"), curve.Node) and curve.what == "rp":
                register.has_node((*place, "Node"), curve.Node, 7, "a linear node has no slope: plot its r or v")
            line = register.line(place)
            curves.append(Curve(curve.Cable, curve.Node, curve.axis, curve.what, curve.text, line, place))
        panels.append(tuple(curves))
    return tuple(panels)
