"""What a run of a cable is judged by: its strain, and how far its elements fold or stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.cable.input.parts import CableScene
from tautline.results.assessment.limits import ANY_STRAIN, strain_limit, stretch_limits


def limits(result: Any, scene: CableScene) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames.

    |r'| is judged at cubic nodes and along linear elements.
    """
    stiff = [k for k, element in enumerate(scene.elements) if element.EA > 0.0]
    strain = np.asarray(result["axial_force"])[:, stiff] / np.array([scene.elements[k].EA for k in stiff])
    found = strain_limit(result.time, strain, ANY_STRAIN, [f"element {scene.elements[k].id}" for k in stiff])
    stretches, places = [], []
    cubic = sorted({node for element in scene.elements if element.kind == "cubic" for node in element.nodes})
    index = {node.id: i for i, node in enumerate(scene.nodes)}
    if cubic:
        stretches.append(np.linalg.norm(np.asarray(result["slope"])[:, [index[k] for k in cubic]], axis=-1))
        places += [f"node {k}" for k in cubic]
    linear = [element for element in scene.elements if element.kind == "linear"]
    if linear:
        first, second = np.array([[index[node] for node in element.nodes] for element in linear]).T
        position, material = np.asarray(result["position"]), np.asarray(result["material_coordinate"])
        length = np.linalg.norm(position[:, second] - position[:, first], axis=-1)
        stretches.append(length / np.maximum(material[:, second] - material[:, first], 1e-12))
        places += [f"element {element.id}" for element in linear]
    return found + (stretch_limits(result.time, np.concatenate(stretches, axis=1), places) if stretches else [])
