"""Ties and couplings: what joins nodes besides elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tautline.cable import written as w
from tautline.cable.entries import DOFS
from tautline.cable.parts import Coupling, Dof, Tie
from tautline.scene.errors import Caution

if TYPE_CHECKING:
    from tautline.cable.references import Register

METHODS = {"LagMultipl": "multiplier", "Penalty": "penalty", "AugLagrange": "augmented"}


def ties(register: Register) -> tuple[tuple[Tie, ...], list[Caution]]:
    """Ties between good nodes, and a caution for each that means nothing."""
    made, cautions = [], []
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
            cautions.append(Caution(f"CableModel[{place[1]}].{key}.constr (line {line})", text))
        elif all(good):
            offset = model.offset or (0.0, 0.0, 0.0)
            stiffness = getattr(model, "p_spring", None)
            made.append(
                Tie(model.id, METHODS[key[:-1]], (ids[0], ids[1]), model.constr, stiffness, offset, line, place)
            )
    return tuple(made), cautions


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
        if register.nodes[model.sNode].BC[model.sDof - 1]:
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
