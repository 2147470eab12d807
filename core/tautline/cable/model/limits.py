"""What a run of a cable is judged by: its strain, and how far its elements fold or stretch."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.cable.input.parts import CableScene, Element
from tautline.results.assessment.limits import ANY_STRAIN, strain_limit, stretch_limits

WITHIN = np.array([0.25, 0.5, 0.75])
"""Places along a cubic element at which |r'| is judged beside its ends: one that folds has no length in its middle."""

MIDDLE = np.array([0.5])
"""Where the axial force is told."""


def stretches_within(
    chord: np.ndarray, slope1: np.ndarray, slope2: np.ndarray, length: np.ndarray, places: np.ndarray = WITHIN
) -> np.ndarray:
    """|r'| of cubic elements at some places, by Hermite's polynomials (eqs 2.4 and 2.8).

    Parameters
    ----------
    chord, slope1, slope2 : (m, n, 3) array
        From the first node to the second, m, and r' at both.
    length : (m, n) or (n,) array
        Unstretched, m.
    places : (k,) array
        Along an element, from 0 to 1.

    Returns
    -------
    (m, k n) array
        The n elements at the first place, then at the next.
    """
    along = chord / np.maximum(length, 1e-12)[..., None]
    inside = [
        6.0 * x * (1.0 - x) * along + (1.0 - x) * (1.0 - 3.0 * x) * slope1 + x * (3.0 * x - 2.0) * slope2
        for x in places.tolist()
    ]
    return np.concatenate([np.linalg.norm(each, axis=-1) for each in inside], axis=1)


def limits(result: Any, scene: CableScene, stiffness: np.ndarray) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames.

    |r'| is judged at cubic nodes and between them, and along linear elements. ``stiffness`` (elements,) is EA in N, by
    which the axial force was made.
    """
    index = {node.id: i for i, node in enumerate(scene.nodes)}
    stiff = [k for k, element in enumerate(scene.elements) if element.EA > 0.0]
    strain = np.asarray(result["axial_force"])[:, stiff] / stiffness[stiff]
    bent = [i for i, k in enumerate(stiff) if scene.elements[k].kind == "cubic" and scene.elements[k].EJ > 0.0]
    if bent:
        # Their axial force has a part of bending, which stretches nothing.
        strain[:, bent] = _stretching(result, [scene.elements[stiff[i]] for i in bent], index)
    found = strain_limit(result.time, strain, ANY_STRAIN, [f"element {scene.elements[k].id}" for k in stiff])
    stretches, places = [], []
    cubic = sorted({node for element in scene.elements if element.kind == "cubic" for node in element.nodes})
    if cubic:
        stretches.append(np.linalg.norm(np.asarray(result["slope"])[:, [index[k] for k in cubic]], axis=-1))
        places += [f"node {k}" for k in cubic]
        elements = [element for element in scene.elements if element.kind == "cubic"]
        stretches.append(stretches_within(*_shapes(result, elements, index)))
        places += [f"element {element.id}" for element in elements] * WITHIN.size
    linear = [element for element in scene.elements if element.kind == "linear"]
    if linear:
        first, second = np.array([[index[node] for node in element.nodes] for element in linear]).T
        position, material = np.asarray(result["position"]), np.asarray(result["material_coordinate"])
        length = np.linalg.norm(position[:, second] - position[:, first], axis=-1)
        stretches.append(length / np.maximum(material[:, second] - material[:, first], 1e-12))
        places += [f"element {element.id}" for element in linear]
    return found + (stretch_limits(result.time, np.concatenate(stretches, axis=1), places) if stretches else [])


Shapes = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _shapes(result: Any, elements: list[Element], index: dict[int, int]) -> Shapes:
    """Of cubic elements: from the first node to the second, r' at both, and the unstretched length."""
    first, second = np.array([[index[node] for node in element.nodes] for element in elements]).T
    position, slope, material = (np.asarray(result[k]) for k in ("position", "slope", "material_coordinate"))
    chord, length = position[:, second] - position[:, first], material[:, second] - material[:, first]
    return chord, slope[:, first], slope[:, second], length


def _stretching(result: Any, elements: list[Element], index: dict[int, int]) -> np.ndarray:
    """The force of the strain in the middle of elements that bend, over EA: epsilon, by Green's strain times |r'|."""
    stretch = stretches_within(*_shapes(result, elements, index), MIDDLE)
    green = np.array([element.strain != "engineering" for element in elements])
    return np.where(green, 0.5 * (stretch**2 - 1.0) * stretch, stretch - 1.0)
