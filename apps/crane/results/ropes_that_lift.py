"""Ropes that run so fast over a sheave that they would leave it.

A rope of speed u that is bent by a sheave needs the tension rhoA u^2 to be turned; only what it has above that presses
it on the sheave. Of a rope that has less the equations keep the arc where it is: the sheave then pulls the rope.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from crane.assembly.layout import Layout
from crane.results.course import course_of, nodes_of
from crane.results.summary import SLACK
from crane.scene.scene import Sheave
from tautline.scene.values.ranges import sized

DOUBT = 2.0
"""How often rhoA u^2 at a frame may be what the speed between frames says of it: nearer is looked at in full."""
FIELDS = ("position", "material_coordinate", "tension", "wrap_angle", "sheave_load")


def ropes_that_lift(result: Any, layout: Layout) -> list[str]:
    """Sentences on sheaves that pull a rope which is not slack, one for each.

    Parameters
    ----------
    result : Result
        Of one that keeps statistics nothing is told: they do not say what was at the same time.
    layout : Layout
        Of its scene.
    """
    scene = layout.scene
    sheaves = [i for i, item in enumerate(scene.path) if isinstance(item, Sheave)]
    if not sheaves or scene.output.statistics or len(result.time) < 2 or any(name not in result for name in FIELDS):
        return []
    time, tension = np.asarray(result.time, float), np.asarray(result["tension"])
    at_sheaves = np.array(sheaves)
    lower = np.minimum(tension[:, at_sheaves - 1, 1], tension[:, at_sheaves, 0])
    turning = scene.rope.mass_per_length * _speeds(time, _material(result, layout)[:, at_sheaves]) ** 2
    # Where the rope hangs loose it presses on nothing, and that is told as slack.
    doubtful = (lower > SLACK * float(tension.max())) & (lower < DOUBT * turning)
    frames = np.flatnonzero(doubtful.any(axis=1))
    if frames.size == 0:
        return []
    course = course_of(result, layout, frames)
    inwards = course.leaves[:, at_sheaves] - course.comes[:, at_sheaves]
    load = np.asarray(result["sheave_load"])[frames]
    pulls = doubtful[frames] & (np.einsum("mkc,mkc->mk", load, inwards) < 0.0)
    found = []
    for k, i in enumerate(sheaves):
        if pulls[:, k].any():
            begin = float(time[frames[int(np.argmax(pulls[:, k]))]])
            most = float(np.linalg.norm(load[pulls[:, k], k], axis=-1).max())
            found.append(_sentence(scene.path[i].name, begin, most))
    return found


def _material(result: Any, layout: Layout) -> np.ndarray:
    """Material at each item's mark, (m, items) m."""
    return np.asarray(result["material_coordinate"])[:, nodes_of(layout.scene)]


def _speeds(time: np.ndarray, material: np.ndarray) -> np.ndarray:
    """Speed of the rope at each frame, of the times before and behind it the larger, m/s."""
    passed = np.abs(np.diff(material, axis=0)) / np.maximum(np.diff(time), np.finfo(float).tiny)[:, None]
    return np.maximum(np.concatenate((passed[:1], passed)), np.concatenate((passed, passed[-1:])))


def _sentence(name: str, begin: float, most: float) -> str:
    return (
        f"the rope runs too fast to stay on {name}, first at t = {begin:.4g} s: its tension is below rhoA u^2, which "
        f"turns rope of the speed u. A real rope would leave the sheave. Here it is kept on it, by a pull of up to "
        f"{sized(most, 'N')}. What is shown from then on is not what the rope would do. Keep the rope tighter or "
        "slower, by a heavier hook or a brake"
    )
