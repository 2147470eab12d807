"""What can be driven, read and changed of cables while they run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from tautline.cable.model.layout import Layout
from tautline.system.handles import Handles, Parameter, inputs_of, number, outputs_of, prepared_of

OF_NODES = {
    "position": "position", "velocity": "velocity", "slope": "slope", "material_coordinate": "material_coordinate",
    "material_velocity": "material_velocity",
}  # fmt: skip
OF_ELEMENTS = {"axial_force": "axial_force", "curvature": "curvature"}
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
    for name, start in zip(names["node"], layout.starts, strict=True):
        for what, vector in (("position", "q"), ("velocity", "v")):
            output = f"{name}.{what}"
            outputs[output] = replace(outputs[output], places=(vector, start + np.arange(3)))
    parameters = {one.name: one for one in stiffnesses(groups, "cables")}
    return Handles(inputs_of(layout.requests), outputs, parameters, prepared_of(layout.requests))


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
