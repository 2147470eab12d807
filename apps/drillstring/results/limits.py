"""What a drill string's run is judged by: depth in the wall, strain and yield load; and whether it had to be pushed."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillstring.results.places import reaches_of_links
from drillstring.scene.scene import DrillstringScene
from drillstring.string.buoyancy import buoyed_weight
from drillstring.string.lumps import Lumps
from drillstring.string.strength import extreme_tension
from tautline.results.assessment.limits import STEEL, STEEL_STRAIN, STRAIN, judged, strain_limit
from tautline.scene.values.printed import shown

INTO_THE_WALL = 1.0
"""Depth of the string in the wall over its clearance, above which the wall is no wall."""
ROUNDING = 1.0e-6
"""Share of the largest tension below which a hook load is what rounding leaves."""
PUSHED = 0.01
"""Share of the string's buoyed weight up to which a push is none that counts: a moment's wave in a string that falls
onto its wall is less, and no figure of a rig is known better."""
MOVED = 1.0e-6
"""Way of the block, m, below which it counts as held."""
SNUG = 0.05
"""Share of the hole's diameter that a stabiliser, which fits the hole, is taken to have for its clearance."""


def limits(result: Any, scene: DrillstringScene, lumps: Lumps) -> list[dict[str, Any]]:
    """Records of `tautline.results.assessment.limits`, from the stored frames of either kind of string."""
    tension = extreme_tension(scene, lumps, result["hook_load"], result["tension"])
    links = reaches_of_links(lumps)
    modulus = lumps.of_links(lambda tube: tube.youngs_modulus)
    strain = tension / lumps.of_links(lambda tube: tube.youngs_modulus * tube.area)
    found = strain_limit(result.time, strain, np.where(modulus > STEEL, STEEL_STRAIN, STRAIN), links)
    strength = np.array([section.yield_load or np.inf for section in scene.string])[lumps.section]
    if np.isfinite(strength).any():
        text = "largest tension, and the yield load"
        found.append(judged("yield_load", text, "N", result.time, np.maximum(tension, 0.0), strength, links))
    return [*found, *_into_the_wall(result)]


def pushed_at_the_top(result: Any, scene: DrillstringScene, lumps: Lumps) -> list[str]:
    """A sentence where the hoist would have to push: hook load and the weight of the block together are below zero."""
    hook, block = np.asarray(result["hook_load"]), scene.top.weight
    lowest = int(hook.argmin())
    # Of a string that is not pulled rounding leaves a hook load of either sign.
    least = max(ROUNDING * float(np.abs(result["tension"]).max()), PUSHED * abs(buoyed_weight(scene, lumps.tubes)))
    if hook[lowest] + block >= -least:
        return []
    load = shown(float(hook[lowest]), "N", scene.units)
    given, cures = (
        "no top.weight is given",
        ["put less force on the bit", "give top.weight, that of block and top drive"],
    )
    if block > 0.0:
        given, cures = f"top.weight is only {shown(block, 'N', scene.units)}", cures[:1]
    if _lowered(np.asarray(result["block_position"])[: lowest + 1]):
        cures = ["lower the block more slowly", *cures]
    cure = ", or ".join(cures)
    return [
        f"the hook load falls to {load} at t = {result.time[lowest]:.4g} s, and {given}. The hoist would have to push "
        "the string down, and a hoist cannot push. A rig without pull-down does not do what this run shows. "
        f"{cure[0].upper()}{cure[1:]}. Where the model begins below the rig, add the weight of the string above it to "
        "top.weight"
    ]


def _lowered(block: np.ndarray) -> bool:
    """Whether a block, positions (m,) in m, positive down, came below where it had been."""
    return bool((block - np.minimum.accumulate(block)).max() > MOVED)


def _into_the_wall(result: Any) -> list[dict[str, Any]]:
    """How deep the string goes into the wall over its clearance; none for a string in free space."""
    if "clearance" not in result:
        return []
    clearance = np.asarray(result["clearance"])
    depth = np.linalg.norm(np.asarray(result["lateral_displacement"]), axis=-1) - clearance
    reference = np.maximum(clearance, SNUG * float(result["hole_diameter"][0]))
    places = [f"{x:.4g} m" for x in np.asarray(result["unstretched_depth"])]
    text = "largest penetration of the wall / clearance"
    shares = np.maximum(depth, 0.0) / reference
    return [judged("penetration", text, "", result.time, shares, INTO_THE_WALL, places)]
