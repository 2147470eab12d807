"""What can be driven, read and changed of cables while they run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from tautline.cable.model.layout import Layout
from tautline.system.handles import Handles, Parameter, inputs_of, number, outputs_of

OF_NODES = {
    "position": "position", "velocity": "velocity", "slope": "slope", "material_coordinate": "material_coordinate",
    "material_velocity": "material_velocity",
}  # fmt: skip
OF_ELEMENTS = {"axial_force": "axial_force", "curvature": "curvature"}
STIFFNESSES = {
    "stiffness": ("axial_stiffness", "N", "EA"), "bending": ("bending_stiffness", "N m^2", "EJ"),
    "damping": ("damping", "s", "damping"), "fluid": ("fluid_mass", "kg/m", "mass of fluid per length"),
}  # fmt: skip
"""Fields of the records of elements, and what they are called."""


def handles(layout: Layout, groups: tuple[Any, ...], model: Any) -> Handles:
    """All handles of cables: by the ids of nodes, elements and functions."""
    names = {
        "node": [f"node {x}" for x in model.coordinates["node"][1]],
        "element": [f"element {x}" for x in model.coordinates["element"][1]],
    }
    outputs = outputs_of(model.variables, model.coordinates, OF_NODES | OF_ELEMENTS, names)
    parameters = {one.name: one for one in stiffnesses(groups, "cables")}
    return Handles(inputs_of(layout.requests), outputs, parameters)


def stiffnesses(groups: tuple[Any, ...], thing: str) -> Iterator[Parameter]:
    """Stiffnesses, damping and mass of fluid of all elements, where all have the same."""
    for field, (name, unit, text) in STIFFNESSES.items():
        arrays = [
            group.rows[field]
            for group in groups
            if isinstance(getattr(group, "rows", None), np.ndarray) and field in (group.rows.dtype.names or ())
        ]
        values = np.concatenate([array.ravel() for array in arrays]) if arrays else np.zeros(0)
        if values.size and values[0] != 0.0 and np.ptp(values) == 0.0:
            yield number(f"{thing}.{name}", unit, f"{text} of all elements", arrays)
