"""Ties and couplings: what joins nodes besides elements."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

from tautline.cable.input.initial import initial_rate
from tautline.cable.input.parts import CableScene, Coupling, Dof, Node, Tie
from tautline.cable.input.register import Register
from tautline.cable.input.syntax import models as w
from tautline.cable.input.syntax.entries import DOFS
from tautline.scene.errors import Problem, SceneError, SceneWarning

METHODS = {"LagMultipl": "multiplier", "Penalty": "penalty", "AugLagrange": "augmented"}
APART = 1.0e-9
"""Gap of a constraint at the start, m or as a share of the node's place, that is no rounding."""
SAME_RATE = 1.0e-6
"""Difference of two rates over the larger, below which they are one: above what rounding leaves of a table's rate."""
NEARLY = 0.01
"""Difference of two rates over the larger, up to which material flows on while its rope rests. In dynamic relaxation
the element would grow meanwhile: there it is `SAME_RATE`."""
FAR = 1.0e-3
"""Gap of a coupling, as a share of the shortest element at the slave, that no drawing is rounded by."""


def alike_within(start: str) -> float:
    """Difference of two rates over the larger, up to which a start of a scene counts them as one."""
    return SAME_RATE if start == "relaxed" else NEARLY


def ties(register: Register) -> tuple[tuple[Tie, ...], list[SceneWarning]]:
    """Ties between good nodes, and a warning for each that means nothing."""
    made, warnings = [], []
    for key, model, place in register.of(w.Multiplier7, w.Multiplier4, w.Penalty7, w.Penalty4):
        cubic = isinstance(model, w.Multiplier7)
        name, kind = ("nodes7", 7) if cubic else ("nodes4", 4)
        ids = getattr(model, name)
        instead = f"use {key[:-1]}{4 if cubic else 7} with {'nodes4' if cubic else 'nodes7'}"
        good = [register.has_node((*place, name, i), node, kind, instead) for i, node in enumerate(ids)]
        line = register.line(place)
        if ids[0] == ids[1]:
            register.refuse((*place, name), f"ties node {ids[0]} to itself", "name two nodes")
        elif all(good) and not cubic and model.constr == 2:
            text = f"{key} {model.id} is ignored: linear nodes have no slope that could be tied; remove it"
            warnings.append(SceneWarning(f"CableModel[{place[1]}].{key}.constr (line {line})", text))
        elif all(good):
            offset = model.offset or (0.0, 0.0, 0.0)
            stiffness = getattr(model, "p_spring", None)
            made.append(
                Tie(model.id, METHODS[key[:-1]], (ids[0], ids[1]), model.constr, stiffness, offset, line, place)
            )
    return tuple(made), warnings


def couplings(register: Register) -> tuple[Coupling, ...]:
    """Couplings whose slaves are free, slaves once, and not their own masters."""
    made: list[Coupling] = []
    slaves: dict[Dof, Coupling] = {}
    for _, model, place in register.of(w.LinearCoupl):
        good = _has_dof(register, (*place, "sNode"), (*place, "sDof"), model.sNode, model.sDof)
        for i, master in enumerate(model.masters):
            at = (*place, "masters", i)
            good &= _has_dof(register, (*at, "mNode"), (*at, "mDof"), master.mNode, master.mDof)
        if not good:
            continue
        slave = (model.sNode, model.sDof)
        name = DOFS[register.dofs(model.sNode)].split()[model.sDof - 1]
        masters = tuple((master.mNode, master.mDof, master.factor) for master in model.masters)
        coupling = Coupling(model.id, slave, model.f0, masters, register.line(place), place)
        if register.is_held(model.sNode, model.sDof):
            cause = f"node {model.sNode} holds {name} with BC: it cannot follow masters"
            register.refuse(
                (*place, "sDof"), cause, f"set its BC to 0 there (entry {model.sDof}), or remove the coupling"
            )
        elif slave in slaves:
            cause = f"{name} of node {model.sNode} is a slave in line {slaves[slave].line} already"
            register.refuse((*place, "sDof"), cause, "keep one of the couplings; one may name several masters")
        else:
            slaves[slave] = coupling
            made.append(coupling)
    for coupling in made:
        if ring := _ring(coupling.slave, slaves):
            way = " -> ".join(f"{node}:{dof}" for node, dof in ring)
            cause = f"follows itself (node:dof {way})"
            register.refuse((*coupling.place, "masters"), cause, "let one of them be free, and no slave")
    return tuple(made)


def _has_dof(register: Register, at_node: tuple, at_dof: tuple, node: int, dof: int) -> bool:
    if not register.has_node(at_node, node):
        return False
    most = register.dofs(node)
    if dof <= most:
        return True
    cause = f"node {node} is a Node{most}Dof and has {most} degrees of freedom"
    register.refuse(at_dof, cause, f"give 1 to {most}: {DOFS[most]}")
    return False


def _ring(start: Dof, slaves: dict[Dof, Coupling]) -> list[Dof] | None:
    """Way from a slave through its masters back to itself, if there is one."""
    stack: list[list[Dof]] = [[start]]
    seen: set[Dof] = set()
    while stack:
        way = stack.pop()
        for node, dof, _ in slaves[way[-1]].masters:
            if (node, dof) == start:
                return [*way, start]
            if (node, dof) in slaves and (node, dof) not in seen:
                seen.add((node, dof))
                stack.append([*way, (node, dof)])
    return None


def value_of(node: Node, dof: int, p: Mapping[int, float]) -> float:
    """Value at the start of a degree of freedom, numbered from one, as the scene draws it; ``p`` by node id, m."""
    return (*node.position, *(node.slope or ()), p[node.id])[dof - 1]


def rates_at_start(scene: CableScene) -> Callable[[int, int], tuple[float, bool]]:
    """Of a node and a degree of freedom, numbered from one: its rate when a run begins, m/s, and whether it is held.

    What is driven, and what follows it, begins at the speed of its drive; nothing else moves.
    """
    nodes = {node.id: node for node in scene.nodes}
    masters = {coupling.slave: coupling.masters for coupling in scene.couplings}
    motions = {motion.id: motion for motion in scene.motions}

    @functools.cache
    def begins(function: int) -> float:
        # Only of those that are asked for: a function that is not plain is compiled for its rate.
        return initial_rate(motions[function]) if function in motions else 0.0

    def of(node: int, dof: int) -> tuple[float, bool]:
        if (node, dof) not in masters:
            return begins(nodes[node].functions[dof - 1]), nodes[node].held[dof - 1]
        parts = [(factor, *of(*master)) for *master, factor in masters[node, dof]]
        return sum(factor * rate for factor, rate, _ in parts), all(held for *_, held in parts)

    return of


def coupling_gap(coupling: Coupling, nodes: Mapping[int, Node], p: Mapping[int, float]) -> tuple[float, str]:
    """How far a slave is drawn from where its masters put it, m or 1, and the sentence that says so; 0 for rounding."""
    value = value_of(nodes[coupling.slave[0]], coupling.slave[1], p)
    masters = [factor * value_of(nodes[node], dof, p) for node, dof, factor in coupling.masters]
    gap = value - coupling.f0 - sum(masters)
    if abs(gap) <= APART * max(1.0, abs(value), *map(abs, masters)):
        return 0.0, ""
    fits = coupling.f0 + gap
    fits = 0.0 if abs(fits) <= APART * max(abs(coupling.f0), abs(gap)) else fits
    text = (
        f"does not hold at the start: the slave begins at {value:.6g}, its masters put it at {value - gap:.6g}; let "
        f"them begin alike, or give f0: {fits:.6g}"
    )
    return abs(gap), text


def check_couplings(scene: CableScene, p: Mapping[int, float]) -> None:
    """Refuse couplings that would pull a slave far from where it is drawn.

    Far is more than ``FAR`` of the shortest element at the slave's node, or of one for slopes: what is drawn is then
    not what would run, and an element may have no length left.

    Raises
    ------
    SceneError
        Naming each such coupling, where the slave is drawn, and where it would be.
    """
    nodes = {node.id: node for node in scene.nodes}
    problems: list[Problem] = []
    for coupling in scene.couplings:
        node, dof = coupling.slave
        is_slope = 3 < dof < nodes[node].kind
        lengths = [abs(p[e.nodes[1]] - p[e.nodes[0]]) for e in scene.elements if node in e.nodes]
        gap, text = coupling_gap(coupling, nodes, p)
        if gap > FAR * (1.0 if is_slope else min(lengths, default=1.0)):
            cause, cure = text.split("; ", 1)
            problems.append(scene.problem(coupling.place, cause, cure))
    if problems:
        raise SceneError(problems)
