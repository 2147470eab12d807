"""What can be driven, read and changed of cables while they run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from tautline.cable.model.layout import Layout
from tautline.cable.model.observe import extreme_force
from tautline.system.handles import Handles, Output, Parameter, inputs_of, number, outputs_of, prepared_of

OF_NODES = {
    "position": "position", "velocity": "velocity", "slope": "slope", "material_coordinate": "material_coordinate",
    "material_velocity": "material_velocity",
}  # fmt: skip
OF_ELEMENTS = {"axial_force": "axial_force", "curvature": "curvature"}
LARGEST, LEAST = "largest_axial_force", "least_axial_force"
"""Outputs of each element by which bounds on `axial_force` are judged."""
STIFFNESSES = (
    ("axial_stiffness", "N", "EA", {"engineering": "stiffness"}),
    ("bending_stiffness", "N m^2", "EJ", {"engineering": "bending", "smoothing": "stiffness"}),
    ("damping", "s", "damping", {"engineering": "damping", "smoothing": "damping"}),
    ("fluid_mass", "kg/m", "mass of fluid per length", {"engineering": "fluid"}),
)
"""What is called how, and the field of a record that holds it. Records with ``engineering`` are of elements in tension,
those with ``smoothing`` of elements that bend; springs and masses have neither."""


def handles(layout: Layout, groups: tuple[Any, ...], model: Any) -> Handles:
    """All handles of cables: by the ids of nodes, elements and functions."""
    names = {
        "node": [f"node {x}" for x in model.coordinates["node"][1]],
        "element": [f"element {x}" for x in model.coordinates["element"][1]],
    }
    outputs = outputs_of(model.variables, model.coordinates, OF_NODES | OF_ELEMENTS, names)
    outputs |= at_ends(outputs, names["element"])
    for name, start in zip(names["node"], layout.starts, strict=True):
        for what, vector in (("position", "q"), ("velocity", "v")):
            output = f"{name}.{what}"
            outputs[output] = replace(outputs[output], places=(vector, start + np.arange(3)))
    parameters = {one.name: one for one in stiffnesses(groups, "cables")}
    return Handles(inputs_of(layout.requests), outputs, parameters, prepared_of(layout.requests))


def at_ends(
    outputs: Mapping[str, Output], elements: Sequence[str] = (), labels: Sequence[str] = ()
) -> dict[str, Output]:
    """Largest and least axial force of each element, by which bounds on `axial_force` are judged, and it itself.

    Parameters
    ----------
    elements : sequence of str
        Names of the elements, where each has an output of its own too: ``element 3`` of ``element 3.axial_force``.
    labels : sequence of str
        What the place of each is called, where that is more than its number.
    """
    middle = outputs["axial_force"]
    made = {"axial_force": replace(middle, judged_by=(LARGEST, LEAST))}
    for name, word in ((LARGEST, "largest"), (LEAST, "least")):
        of_frames = partial(extreme_force, least=name == LEAST)
        made[name] = replace(
            middle, name=name, text=f"{word} axial force at the ends and in the middle of an element", variable="",
            labels=tuple(labels), value=partial(_first, of_frames), series=of_frames,
        )  # fmt: skip
    for k, element in enumerate(elements):
        own = f"{element}.axial_force"
        judges = f"{element}.{LARGEST}", f"{element}.{LEAST}"
        made[own] = replace(outputs[own], judged_by=judges)
        made |= {
            judge: replace(made[name].part((k,)), name=judge)
            for judge, name in zip(judges, (LARGEST, LEAST), strict=True)
        }
    return made


def _first(series: Callable[[Any], np.ndarray], frame: Mapping[str, np.ndarray]) -> np.ndarray:
    return series(frame)[0]


def stiffnesses(groups: tuple[Any, ...], thing: str) -> Iterator[Parameter]:
    """Stiffnesses, damping and mass of fluid of all elements, where all have the same."""
    for name, unit, text, fields in STIFFNESSES:
        arrays = [
            rows[field]
            for rows in (getattr(group, "rows", None) for group in groups)
            for kind, field in fields.items()
            if isinstance(rows, np.ndarray) and {kind, field} <= set(rows.dtype.names or ())
        ]
        values = np.concatenate([array.ravel() for array in arrays]) if arrays else np.zeros(0)
        if values.size and values[0] != 0.0 and np.ptp(values) == 0.0:
            yield number(f"{thing}.{name}", unit, f"{text} of all elements", arrays)
