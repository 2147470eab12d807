"""What to tell of material that functions of time drive through a taut element faster than waves run along it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tautline.cable.input.geometry import arc_lengths, drawn_of
from tautline.cable.input.material import element_lengths
from tautline.cable.input.parts import CableScene
from tautline.cable.model.magnitudes import acting_force
from tautline.cable.short_waves import (
    Curve,
    Overtaken,
    cure_of,
    curves_of,
    most_overtaken,
    speeds,
    through,
    what_it_does,
)
from tautline.cable.warnings.coarse_lines import Sentences
from tautline.cable.warnings.drawn_out import Known, driven_p, known_by, sampled
from tautline.scene.warnings import warning


@warning("cable")
def _fast_material(scene: CableScene) -> Sentences:
    """The element whose short waves grow most, with the tension with which the scene draws it.

    A start at rest has another tension, and so soon has a scene that is drawn with less than what acts on it.
    """
    if scene.solver.start != "as given" or not scene.motions:
        return
    worst = _worst(scene)
    if worst is not None:
        element = worst.curve.element
        others = f" {worst.more} more elements are like this one." if worst.more else ""
        text = (
            f"material is driven through this element faster than waves run along it, from {worst.begin:.4g} to "
            f"{worst.end:.4g} s, if it stays as taut as it is drawn: {speeds(worst)}. {what_it_does()} "
            f"{cure_of(worst)}.{others}"
        )
        yield element.place, text


def _worst(scene: CableScene) -> Overtaken | None:
    """The element to tell of, if any."""
    curves = curves_of(scene, driven_p(scene))
    if not curves:
        return None
    known, kinds = known_by(scene), {node.id: node.kind for node in scene.nodes}
    driven: list[tuple[Curve, list[Known]]] = []
    for curve in curves:
        ends = [known(node, kinds[node]) for node in curve.element.nodes]
        if all(end is not None and end.motions for end in ends):
            driven.append((curve, [end for end in ends if end is not None]))
    if not driven:
        return None
    tensions, lengths, acts = _drawn_tensions(scene), element_lengths(scene), acting_force(scene)
    pulled = [(curve, ends, sum(tensions[k] for k in curve.places)) for curve, ends in driven]
    taut = [(curve, ends, tension) for curve, ends, tension in pulled if acts < tension < np.inf]
    if not taut:
        return None
    times, moved = sampled({motion.id: motion for motion in scene.motions}, scene.solver.end)
    rate, ones = _rates(times, moved), np.ones(times.size)
    seen = (
        (through(rate(first), rate(second)), tension * ones, lengths[curve.places[0]] * ones)
        for curve, (first, second), tension in taut
    )
    return most_overtaken([curve for curve, *_ in taut], times, seen)


def _rates(times: np.ndarray, moved: Callable[[int], np.ndarray]) -> Callable[[Known], np.ndarray]:
    """Of what is known in advance: its rate (m,), m/s, found once for what is driven alike."""
    found: dict[frozenset[tuple[int, float]], np.ndarray] = {}

    def of(known: Known) -> np.ndarray:
        key = frozenset(known.motions.items())
        if key not in found:
            found[key] = sum((factor * moved(motion)[:, 1] for motion, factor in key), np.zeros(times.size))
        return found[key]

    return of


def _drawn_tensions(scene: CableScene) -> np.ndarray:
    """T = N/|r'| (elements,), N, of the mean stretch with which each element is drawn; no number of what is no rope.

    It is EA times Green's strain, or EA (1 - 1/|r'|).
    """
    lengths = element_lengths(scene)
    stiffness = np.array([element.EA for element in scene.elements], dtype=float)
    engineering = np.array([element.strain == "engineering" for element in scene.elements])
    with np.errstate(all="ignore"):
        stretch = arc_lengths(drawn_of(scene), lengths) / lengths
        return stiffness * np.where(engineering, 1.0 - 1.0 / stretch, 0.5 * (stretch**2 - 1.0))
