"""Elements of a scene as groups: each term of the equations for the elements that have it, and for no others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import tautline.elements.cable  # noqa: F401  (terms of the same elements run together)
from tautline.cable.input.parts import Element
from tautline.cable.model.layout import Layout
from tautline.cable.model.sections import Sections
from tautline.elements.beam.bending import BENDING, FlowingBending, new_bending
from tautline.elements.beam.bending_damping import VISCOUS, BendingDamping
from tautline.elements.flow import Flow
from tautline.elements.inertia import INERTIA, Inertia
from tautline.elements.linear import LinearInertia, LinearTension
from tautline.elements.linear_flow import LINEAR_FLOW, LinearFlow
from tautline.elements.nodal.outlet import OUTLET, Outlets
from tautline.elements.pipe import PIPE, Pipes
from tautline.elements.shared_flow import SharedFlow, unit_matrices
from tautline.elements.tension import TENSION, FlowingTension, new_tension
from tautline.kernels.hermite import gauss, lobatto, table
from tautline.system.records import records

SMOOTHING = 0.01
"""Curvature from which bending is damped in full, over that of an element bent to a radius of its own length."""


TOGETHER = 1.0e-9
"""Distance, m, below which two ends of ropes are one corner."""


STILL, SHARED, MOVING = "still", "shared", "moving"
"""How material moves through an element: not at all, through both nodes at one rate, or anyhow."""


def flow_of(layout: Layout, element: Element) -> str:
    """How material moves through an element, or may."""
    if layout.still_nodes.issuperset(element.nodes):
        return STILL
    # Linear elements have one kind of flow inertia, which serves any rates.
    return SHARED if element.kind == "cubic" and _keeps_length(layout, element) else MOVING


def _keeps_length(layout: Layout, element: Element) -> bool:
    """Whether the material of both nodes moves at one rate: none is gained or lost between them."""
    first, second = (layout.rate_of(layout.material(node)) for node in element.nodes)
    return first == second


def _all_still(layout: Layout) -> bool:
    """Whether no node's material moves."""
    return len(layout.still_nodes) == len(layout.scene.nodes)


def steady_flow(layout: Layout) -> list[int]:
    """Places of the p of material that is driven through elements of constant length: it flows on while they rest.

    An element keeps its length where one motion drives both of its ends, and at the start of a run where several drive
    them at one rate, or nearly: that state is at rest, whatever the rates are later. Each node flows on at its own.
    """
    places: set[int] = set()
    for element in () if _all_still(layout) else layout.scene.elements:
        first, second = (layout.material(node) for node in element.nodes)
        if layout.still_nodes.issuperset(element.nodes):
            continue
        always = _keeps_length(layout, element) and layout.is_held(first) and layout.is_held(second)
        if always or layout.run_alike(first, second):
            places.update((first, second))
    return sorted({*places, *layout.flow.values()})


def element_groups(layout: Layout, sections: Sections) -> list[Any]:
    """Groups of inertia, tension, bending and open ends, of the kinds that the scene has.

    ``sections`` is told which rows are of which elements.
    """
    scene, all_still = layout.scene, _all_still(layout)
    sorts: dict[tuple, list[Element]] = {}
    for element in scene.elements:
        if element.conveyed is None:
            flow = STILL if all_still else flow_of(layout, element)
            sorts.setdefault((element.kind, flow), []).append(element)
    pipes = [element for element in scene.elements if element.conveyed is not None]
    groups: list[Any] = [
        sections.of(_pipes(layout, some), some)
        for rule in RULES
        if (some := [e for e in pipes if e.axial_points == rule])
    ]
    for (kind, flow), elements in sorts.items():
        massive = [e for e in elements if e.rhoA > 0.0 or any(e.load)]
        if massive:
            groups.append(sections.of(_inertia(layout, kind, flow, massive), massive))
        # At a constant length only damping sees the material move: without it the stored energy is all there is.
        for moving in (False, True):
            some = [e for e in elements if (flow == MOVING or (flow == SHARED and e.damping > 0.0)) == moving]
            for quadrature in RULES:
                stiff = [e for e in some if e.EA > 0.0 and e.axial_points == quadrature]
                if stiff:
                    groups.append(sections.of(_tension(layout, kind, moving, stiff, quadrature), stiff))
            bent = [e for e in some if e.EJ > 0.0 and kind == "cubic"]
            if bent:
                groups.append(sections.of(_bending(layout, moving, bent), bent))
            spinless = [e for e in bent if e.spinless and e.damping > 0.0 and not moving]
            if spinless:
                groups.append(sections.of(_bending_damping(layout, spinless), spinless))
    open_ends = _outlets(layout)
    if open_ends:
        last = [element for element, _ in open_ends]
        columns = _ends(layout, last) | _strain(last) | {"bending": [element.EJ for element in last]}
        rows = records(len(last), OUTLET, **columns, end=[end for _, end in open_ends])
        groups.append(Outlets(rows, np.zeros((4, 4)), np.zeros((3, 6))))
    return groups


RULES = ("gauss", "lobatto")


def _ends(layout: Layout, elements: Sequence[Element]) -> dict[str, Any]:
    """Where both nodes of each element stand."""
    if len(elements) == len(layout.scene.elements):
        a, b = layout.starts[layout.ends].T
        return {"a": a, "b": b}
    start = layout.start
    return {"a": [start[e.nodes[0]] for e in elements], "b": [start[e.nodes[1]] for e in elements]}


def _inertia(layout: Layout, kind: str, flow: str, elements: list[Element]) -> Any:
    scene, mass = layout.scene, np.array([e.rhoA for e in elements])
    columns: dict[str, Any] = _ends(layout, elements) | {
        "mass": mass,
        "damping": scene.solver.mass_damping,
        "load": mass[:, None] * np.array(scene.gravity) + np.array([e.load for e in elements]),
    }
    if kind == "linear" and flow != STILL:
        goes_on = Counter(node for e in scene.elements if e.kind == "linear" for node in e.nodes)
        columns["kinks"] = [[float(goes_on[node] > 1) for node in e.nodes] for e in elements]
        return LinearFlow(records(len(elements), LINEAR_FLOW, **columns), np.zeros((3, 3)), np.zeros((8, 8)))
    rows = records(len(elements), INERTIA, **columns)
    if kind == "linear":
        return LinearInertia(rows)
    if flow == SHARED:
        return SharedFlow(rows, unit_matrices(), np.zeros((4, 3, 4)), np.zeros((14, 14)))
    if flow == MOVING:
        return Flow(rows, table(*gauss(4)), np.zeros((6, 4)), np.zeros((10, 3)), np.zeros((14, 14)))
    return Inertia(rows, np.zeros((4, 4)))


def _strain(elements: Sequence[Element]) -> dict[str, list[float]]:
    """Axial stiffness, and by which strain it counts."""
    return {
        "stiffness": [e.EA for e in elements],
        "engineering": [e.strain == "engineering" for e in elements],
        "slack": [not e.compression for e in elements],
    }


def _tension(layout: Layout, kind: str, moving: bool, elements: list[Element], quadrature: str) -> Any:
    columns = _ends(layout, elements) | _strain(elements)
    rows = records(len(elements), TENSION, **columns, damping=[e.damping for e in elements])
    points = table(*(gauss(3) if quadrature == "gauss" else lobatto()))
    if kind == "linear":
        return LinearTension(rows, np.zeros((4, 3)), np.zeros((8, 8)))
    if moving:
        return FlowingTension(rows, points, np.zeros((6, 4)), np.zeros((9, 3)), np.zeros((14, 14)))
    return new_tension(rows, points)


def _bending(layout: Layout, moving: bool, elements: list[Element]) -> Any:
    rows = records(
        len(elements),
        BENDING,
        **_ends(layout, elements),
        stiffness=[e.EJ for e in elements],
        damping=[0.0 if e.spinless and not moving else e.damping for e in elements],
        smoothing=smoothing_of(lengths_of(layout, elements)),
    )
    common = rows, table(*gauss(3))
    if moving:
        return FlowingBending(
            *common, np.zeros((5, 4)), np.zeros((14, 6)), np.zeros((2, 6, 6)), np.zeros((14, 14))
        )  # fmt: skip
    return new_bending(*common)


def smoothing_of(lengths: np.ndarray) -> np.ndarray:
    """Curvature, 1/m, far below which an element of a length, m, is hardly damped in bending."""
    return SMOOTHING / lengths


def _pipes(layout: Layout, elements: list[Element]) -> Pipes:
    fluids = [e.conveyed for e in elements if e.conveyed is not None]
    rows = records(
        len(elements),
        PIPE,
        **_ends(layout, elements),
        **_strain(elements),
        flow=[layout.flow[motion] for _, motion in fluids],
        length=lengths_of(layout, elements),
        gravity=layout.scene.gravity,
        mass=[e.rhoA for e in elements],
        fluid=[mass for mass, _ in fluids],
        bending=[e.EJ for e in elements],
        damping=[e.damping for e in elements],
    )
    axial = table(*(gauss(3) if elements[0].axial_points == "gauss" else lobatto()))
    scratch = np.zeros((1, 6)), np.zeros((6, 6)), np.zeros((9, 9)), np.zeros((12, 12))
    return Pipes(rows, axial, table(*gauss(3)), unit_matrices(), *scratch)


def _bending_damping(layout: Layout, elements: list[Element]) -> BendingDamping:
    viscosity = [e.EJ * e.damping for e in elements]
    rows = records(len(elements), VISCOUS, **_ends(layout, elements), viscosity=viscosity)
    scratch = np.zeros((2, 4)), np.zeros((4, 6)), np.zeros((2, 3, 6)), np.zeros((6, 6)), np.zeros((12, 12))
    return BendingDamping(rows, table(*gauss(3)), *scratch)


def lengths_of(layout: Layout, elements: Sequence[Element]) -> np.ndarray:
    """Material lengths of elements at t = 0 (m,), m."""
    last = layout.last
    first, second = (layout.initial[[last[e.nodes[end]] for e in elements]] for end in (0, 1))
    return second - first


def _outlets(layout: Layout) -> list[tuple[Element, int]]:
    """Open ends, element and 0 or 1: where a rope stops at a node that lets material through, however much."""
    uses = Counter(node for e in layout.scene.elements for node in e.nodes)
    joined = {node for tie in layout.scene.ties if tie.what == 1 for node in tie.nodes}
    joined |= {node for c in layout.scene.couplings for node in _coupled_in_place(layout, c)}
    last = [node for node, count in uses.items() if count == 1]
    opened = {node for node in last if node not in joined and not layout.is_held(layout.material(node))}
    if not opened:
        return []
    return [
        (element, end)
        for element in layout.scene.elements
        if element.kind == "cubic"
        for end, node in enumerate(element.nodes)
        if node in opened and not any(_goes_on(layout, node, other) for other in last)
    ]


def _coupled_in_place(layout: Layout, coupling: Any) -> list[int]:
    """Nodes of which one takes its position from the other: the rope goes on from the one to the other."""
    return [coupling.slave[0], *(m[0] for m in coupling.masters)] if coupling.slave[1] <= 3 else []


def _goes_on(layout: Layout, node: int, other: int) -> bool:
    """Whether two ends stand at one point with the same p, which moves alike: a corner, for the rope."""
    if node == other:
        return False
    start, there = layout.start[node], layout.start[other]
    apart = layout.initial[start : start + 3] - layout.initial[there : there + 3]
    p, q = layout.material(node), layout.material(other)
    together = np.abs(apart).max() <= TOGETHER and abs(layout.initial[p] - layout.initial[q]) <= TOGETHER
    return bool(together and layout.rate_of(p) == layout.rate_of(q))


Stencil = np.ndarray


def stencils(layout: Layout, groups: Sequence[Any]) -> tuple[list[Stencil], list[Stencil]]:
    """Degrees of freedom that elements couple in the tangent, and in the mass matrix."""
    whole: list[Stencil] = []
    massive: list[Stencil] = []
    for kind, size in (("cubic", 7), ("linear", 4)):
        if some := [e for e in layout.scene.elements if e.kind == kind]:
            ends = np.column_stack(list(_ends(layout, some).values()))
            whole.append((ends[:, :, None] + np.arange(size)).reshape(len(some), -1))
    shapes: dict[type, Callable[[np.ndarray], np.ndarray]] = {
        Inertia: lambda ends: _axes(ends, (0, 3)),
        LinearInertia: lambda ends: _axes(ends, (0,)),
        Pipes: lambda ends: _axes(ends, (0, 3)),
        SharedFlow: lambda ends: (ends[:, :, None] + np.arange(7)).reshape(len(ends), -1),
        Flow: lambda ends: (ends[:, :, None] + np.arange(7)).reshape(len(ends), -1),
        LinearFlow: lambda ends: (ends[:, :, None] + np.arange(4)).reshape(len(ends), -1),
    }
    for group in groups:
        if type(group) in shapes:
            massive.append(shapes[type(group)](np.column_stack([group.rows.a, group.rows.b])))
    return whole, massive


def _axes(ends: np.ndarray, vectors: tuple[int, ...]) -> np.ndarray:
    """A row for each element and axis: its component of the vectors at both nodes."""
    places = (ends[:, :, None] + np.array(vectors)).reshape(len(ends), 1, -1)
    return (places + np.arange(3)[None, :, None]).reshape(3 * len(ends), -1)
