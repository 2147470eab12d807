"""The thesis' items on nodes, and one of ours: point masses, forces for a time, springs with dampers.

Each is a model of what is written, a part of the scene, a function that makes its group, and one registration. Forces
are added up in the order of the registrations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from tautline.cable.input.syntax.entries import Damping, Id, Pair, Stiffness, Thrust, Time, listed
from tautline.cable.input.syntax.nodal import NodalItem, NodalPart, OnNodes, Place, all_nodes, register_item
from tautline.scene.refusal import fault
from tautline.scene.solver import longest_step
from tautline.scene.values.quantity import quantity


def _alone(layout: Any, part: Any) -> tuple[()]:
    """Each coordinate for itself: nothing is coupled."""
    return ()


class PointMass(OnNodes):
    """A mass at nodes, kg; gravity acts on it."""

    id: Id
    mass: Annotated[float, quantity("kg", positive=True, of="mass")]


def _masses(layout: Any, parts: Sequence[NodalPart]) -> list[Any]:
    from tautline.elements.nodal.node import PointMasses

    scene = layout.scene
    places, values = zip(*((layout.start[node], m.model.mass) for m in parts for node in m.nodes), strict=True)
    gravity = np.array(scene.gravity, float)
    return [PointMasses(np.array(places), np.array(values, float), scene.solver.mass_damping, gravity)]


register_item(
    NodalItem(
        key="PointMass",
        model=PointMass,
        groups=_masses,
        coupled=_alone,
        mass=lambda part: part.model.mass,
    )
)


class PointForce(OnNodes):
    """A force, N, while `timeInterval` (s) lasts; ours: without it, always."""

    id: Id
    force: Thrust = Field(examples=["[0, 8.5, 0]"])
    timeInterval: Annotated[tuple[Time, ...], listed(2, "a first and a last time", "[0, 1.0]")] | None = None

    @model_validator(mode="after")
    def _forwards(self) -> PointForce:
        if self.timeInterval is not None and not self.timeInterval[1] > self.timeInterval[0]:
            begins, ends = self.timeInterval
            cause = "ends as it begins" if begins == ends else "ends before it has begun"
            cure = "give a later time to end" if begins == ends else "give the earlier time first"
            raise fault("timeInterval", cause, f"{cure}, such as [0, 1.0]")
        return self

    @property
    def interval(self) -> tuple[float, float]:
        """When it acts, s; infinity where no end is given."""
        first, last = self.timeInterval or (0.0, math.inf)
        return first, last


def _forces(layout: Any, parts: Sequence[NodalPart]) -> list[Any]:
    from tautline.elements.nodal.node import timed_forces

    rows = [(layout.start[node], f.model.force, f.model.interval) for f in parts for node in f.nodes]
    places, values, intervals = zip(*rows, strict=True)
    return [timed_forces(np.array(places), np.array(values, float), np.array(intervals, float))]


def _untimely(scene: Any, part: NodalPart) -> Iterator[tuple[Place, str]]:
    """Of a force that begins too late, or is shorter than steps whose length is not known before."""
    solver, (first, last) = scene.solver, part.model.interval
    if first >= solver.end:
        yield (*part.place, "timeInterval"), f"begins after the run has ended ({solver.end:g} s)"
    longest = longest_step(solver, solver.interval)
    chosen = not solver.explicit and (solver.control != "fixed" or solver.step == "auto")
    alpha_m, alpha_f = solver.alphas
    if chosen and alpha_m != alpha_f and last - first < longest:
        text = (
            f"the force lasts {last - first:.3g} s, from {first:g} to {last:g} s. Steps may be as long as "
            f"{longest:.3g} s, and change their length beside it. Its impulse may then be off by a tenth. Take "
            f"control: fixed, or time_step: {last - first:.3g} or less"
        )
        yield (*part.place, "timeInterval"), text


register_item(
    NodalItem(
        key="PointForce",
        model=PointForce,
        groups=_forces,
        coupled=_alone,
        force=lambda part: float(np.linalg.norm(part.model.force)),
        warnings=_untimely,
    )
)


class OneNodeSpring(OnNodes):
    """A spring and damper from a node to where it began."""

    id: Id
    stiffness: Stiffness
    damping: Damping = 0.0


def _anchors(layout: Any, parts: Sequence[NodalPart]) -> list[Any]:
    from tautline.elements.nodal.node import Anchors

    rows = [(layout.start[node], a.model.stiffness, a.model.damping) for a in parts for node in a.nodes]
    places, stiffness, damping = zip(*rows, strict=True)
    home = np.array([layout.initial[place : place + 3] for place in places])
    return [Anchors(np.array(places), np.array(stiffness, float), np.array(damping, float), home)]


register_item(
    NodalItem(
        key="OneNodeSpring",
        model=OneNodeSpring,
        groups=_anchors,
        coupled=_alone,
        stiffness=lambda part: part.model.stiffness,
    )
)


class TwoNodeSpring(OnNodes):
    """Ours: a spring and damper between two nodes; `length` at rest, m, by default their first distance."""

    id: Id
    nodes7: Pair | None = None
    nodes4: Pair | None = None
    stiffness: Stiffness
    damping: Damping = 0.0
    length: Annotated[float, quantity("m", nonnegative=True, of="distance")] | None = None


def _springs(layout: Any, parts: Sequence[NodalPart]) -> list[Any]:
    from tautline.elements.nodal.node import SPRING, Springs

    rows = np.zeros(len(parts), SPRING).view(np.recarray)
    for i, part in enumerate(parts):
        spring, (a, b) = part.model, (layout.start[node] for node in part.nodes)
        apart = float(np.linalg.norm(layout.initial[b : b + 3] - layout.initial[a : a + 3]))
        rows[i] = (a, b, spring.stiffness, spring.damping, apart if spring.length is None else spring.length)
    return [Springs(rows, np.zeros((6, 6)))]


register_item(
    NodalItem(
        key="TwoNodeSpring",
        model=TwoNodeSpring,
        groups=_springs,
        coupled=all_nodes,
        stiffness=lambda part: part.model.stiffness,
    )
)
