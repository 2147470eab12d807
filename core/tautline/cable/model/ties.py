"""Ties of a scene as equations: multipliers and penalty springs, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from tautline.cable.input.geometry import COINCIDENT
from tautline.cable.input.material import SHORTEST
from tautline.cable.input.parts import Tie
from tautline.cable.input.syntax.nodal import item_of
from tautline.cable.model.layout import Layout
from tautline.cable.model.magnitudes import penalty_stiffness, stiffest_element, stiffness_of
from tautline.cable.model.refused import branches, massless
from tautline.constraints.equations import equations
from tautline.constraints.multiplier import Multipliers
from tautline.constraints.penalty import Penalties
from tautline.integrators.state import WORST
from tautline.integrators.status import Status
from tautline.scene.errors import Problem, SceneError
from tautline.system.soundness import null_motions, redundant
from tautline.system.system import System

MISMATCH = 1.0e-9
"""Distance, m, by which two nodes may miss one another and still count as together."""
STIFF_TIE = 1.0e3
"""Penalty over the stiffest element from which a step without solution may be due to it."""
WORDS = ("r = r", "p = p", "r' = r'")


class Equation(NamedTuple):
    """One equation of a tie: (place, factor) of its degrees of freedom, offset, what it is."""

    tie: Tie
    row: list[tuple[int, float]]
    offset: float
    name: str

    def value(self, q: np.ndarray) -> float:
        """Value at positions q."""
        return sum(factor * q[place] for place, factor in self.row) + self.offset


def equations_of(layout: Layout) -> list[Equation]:
    """Every equation of the scene's ties, but for those between degrees of freedom that are held anyway."""
    made: list[Equation] = []
    for tie in layout.scene.ties:
        first, second = tie.nodes
        places = {
            0: [(layout.start[first] + c, layout.start[second] + c) for c in range(3)],
            1: [(layout.material(first), layout.material(second))],
            2: [(layout.start[first] + 3 + c, layout.start[second] + 3 + c) for c in range(3)],
        }[tie.what]
        for axis, (i, j) in enumerate(places):
            offset = -tie.offset[axis] if tie.what == 0 else 0.0
            name = f"{WORDS[tie.what]} of nodes {first} and {second}" + (f", {'xyz'[axis]}" if tie.what != 1 else "")
            _append(layout, made, Equation(tie, [(j, 1.0), (i, -1.0)], offset, name))
    for part in layout.scene.nodal:
        for row, offset, name in item_of(part).equations(layout, part):
            tie = Tie(part.id or 0, "multiplier", part.nodes, 0, None, (0.0, 0.0, 0.0), part.line, part.place)
            _append(layout, made, Equation(tie, list(row), offset, name))
    return made


def _append(layout: Layout, made: list[Equation], equation: Equation) -> None:
    """Append an equation, unless all that it is about is held; raises SceneError if it then does not hold.

    One of an item of others whose numbers are none is refused too.
    """
    if not np.isfinite([equation.offset, *(factor for _, factor in equation.row)]).all():
        cause = f"{equation.name}: a factor or the offset of this equation is no finite number"
        raise SceneError([layout.scene.problem(equation.tie.place, cause, "correct `equations` of its item")])
    tie, error = equation.tie, abs(equation.value(layout.initial))
    if not all(layout.is_held(place) for place, _ in equation.row):
        made.append(equation)
    elif error > MISMATCH and tie.method != "penalty":
        cause = f"{equation.name}: {'both' if len(equation.row) == 2 else 'all'} are held, {error:g} apart"
        raise SceneError([layout.scene.problem(tie.place, cause, "free one of them, or remove the constraint")])


def check_sound(layout: Layout, made: Sequence[Equation]) -> None:
    """Refuse constraints that say a thing twice, nodes that may slide along their rope without moving any of it, nodes
    at which three ropes share a slope, and what is free and has no mass.

    Raises
    ------
    SceneError
        Naming the tie, or the node.
    """
    rows = [e for e in made if e.tie.method != "penalty"]
    problems: list[Problem] = []
    found = redundant(
        [e.row for e in rows], layout.degrees.motion, layout.degrees.masters, [e.value(layout.initial) for e in rows]
    )
    for i in found:
        cause = f"{rows[i].name}: follows from the other constraints"
        problems.append(
            layout.scene.problem(
                rows[i].tie.place, cause, "remove it: the force of a repeated constraint is not determined"
            )
        )
    problems += _lost(layout)
    problems += _null_motions(layout, rows)
    problems += branches(layout)
    problems += massless(layout, (place for e in rows for place, _ in e.row))
    if problems:
        raise SceneError(problems)


def _lost(layout: Layout) -> list[Problem]:
    """Elements without length once each node stands where its function begins and its masters put it."""
    scene = layout.scene
    first, second = (layout.initial[layout.lasts[end]] for end in layout.ends.T)
    material = second - first
    apart = np.linalg.norm(layout.chords(), axis=1)
    linear = np.array([element.kind == "linear" for element in scene.elements])
    problems = []
    for i in np.flatnonzero(~(material > SHORTEST) | (linear & ~(apart > COINCIDENT))).tolist():
        cause = "has both of its nodes at one point once functions and couplings hold"
        if not material[i] > SHORTEST:
            cause = f"has {material[i]:.3g} m of cable between its nodes once functions and couplings hold"
        cure = "let the functions and couplings of its nodes begin where the nodes are drawn"
        problems.append(scene.problem(scene.elements[i].place, cause, cure))
    return problems


def _null_motions(layout: Layout, rows: Sequence[Equation]) -> list[Problem]:
    scene = layout.scene
    tangents = np.zeros((len(scene.nodes), 3))
    chords = layout.chords()
    chords /= np.maximum(np.linalg.norm(chords, axis=1), 1e-300)[:, None]
    for end in layout.ends.T:
        np.add.at(tangents, end, chords)
    places, material = layout.starts, layout.lasts
    cubic = np.array([node.kind == 7 for node in scene.nodes])
    tangents[cubic] = layout.initial[places[cubic][:, None] + 3 + np.arange(3)]
    beads = [[(layout.material(node), 1.0)] for node in scene.heavy_nodes]
    wrong = null_motions(
        places, tangents, material, layout.degrees.motion, layout.degrees.masters, [e.row for e in rows] + beads
    )
    problems = []
    for i in dict.fromkeys(wrong):
        node = scene.nodes[i]
        cause = f"node {node.id} may slide along the rope without moving any of it: position and p are both free"
        cure = "hold p (last entry of BC), or hold the position along the rope, or couple p to that of a neighbour"
        problems.append(scene.problem((*node.place, "BC"), cause, cure))
    return problems


def constraint_groups(layout: Layout, made: Sequence[Equation], weight: float) -> tuple[list[Any], list[str]]:
    """Groups of multipliers and penalties, and notes on what was chosen; adds the multipliers' degrees of freedom."""
    groups: list[Any] = []
    notes: list[str] = []
    multiplied = [e for e in made if e.tie.method != "penalty"]
    if multiplied:
        degrees = layout.degrees
        first = len(degrees.names)
        degrees.names += [f"multiplier of {e.name}" for e in multiplied]
        degrees.value = np.append(degrees.value, np.zeros(len(multiplied)))
        degrees.scale = np.append(degrees.scale, np.full(len(multiplied), degrees.scale.max()))
        table = equations([e.row for e in multiplied], [e.offset for e in multiplied])
        unknown = np.arange(first, first + len(multiplied))
        groups.append(Multipliers(table, unknown, weight, np.zeros(1)))
    sprung = [e for e in made if e.tie.method != "multiplier"]
    if sprung:
        chosen = penalty_stiffness(layout.scene)
        stiffness = [stiffness_of(layout.scene, e.tie, chosen) for e in sprung]
        groups.append(Penalties(equations([e.row for e in sprung], [e.offset for e in sprung]), np.array(stiffness)))
        if any(e.tie.stiffness is None for e in sprung):
            notes.append(
                f"penalty stiffness of the ties that give none: {chosen:.3g} N/m, by the stiffest "
                "element and by what rounding allows. Slopes take it times the square of an element's length"
            )
    return groups, notes


def stiff_tie(layout: Layout, system: System, state: Any, status: Status) -> tuple[Status, int, str] | None:
    """Status, place and detail of a step without solution where a stiff penalty ties what was worst; None elsewhere.

    Parameters
    ----------
    layout : Layout
    system : System
    state : State
        Of the last accepted step, with the unknown that was worst in the one that failed.
    status : Status
        How the run ended.
    """
    scene, worst = layout.scene, int(state.counters[WORST])
    if status is not Status.NOT_CONVERGED or worst < 0:
        return None
    place = int(system.free[worst])
    # After those of the nodes come p of fluids and multipliers, which are no node's.
    if place > layout.lasts[-1]:
        return None
    node = list(layout.start)[int(np.searchsorted(layout.starts, place, side="right")) - 1]
    chosen, least = penalty_stiffness(scene), STIFF_TIE * stiffest_element(scene)
    for tie in scene.ties:
        # What a spring between slopes gives is told by that between positions beside it.
        if tie.method != "penalty" or tie.what == 2 or node not in tie.nodes:
            continue
        stiffness = stiffness_of(scene, tie, chosen)
        if stiffness >= least:
            detail = (
                f"a penalty spring of {stiffness:.3g} N/m ties node {node}. So stiff a spring may be the cause: give a "
                f"smaller `p_spring`, or LagMultipl{layout.kind[node]} in place of Penalty{layout.kind[node]}"
            )
            return status, worst, detail
    return None
