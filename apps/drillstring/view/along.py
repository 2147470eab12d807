"""Tension and torque all along a string, of what its links have in their middles and its ends have from outside.

A result tells both in the middles of links only. At the ends of a string in a hole they are what acts there: hook load
and surface torque at the top; at the bit its force less the weight on bit, and the torque on bit. That is exact, with
friction and in motion too. Between two links the tension is shared as `drillstring.string.strength` shares it, by the
links' weights. In free space a string may leave what holds it at an angle, and the force along the hole is not that
along the string. There, and where no scene tells the bit's force, an end differs from the middle of its link by half of
the link's buoyed weight: that is right at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillstring.string.strength import ends_of_links
from drillstring.view.course import Course, scene_of


def tension_along(result: Any, course: Course) -> np.ndarray:
    """Effective tension at lumps and middles of links in turn, (m, 2 n + 1) N: from the first lump to the last."""
    tension = np.asarray(result["tension"], float)
    weight = _weights(result, course)
    upper, _ = ends_of_links(weight[1:] / (weight[:-1] + weight[1:]), np.zeros(len(tension)), tension)
    top, bottom = _by_weight(result, course, tension)
    if course.hole is not None:
        top = np.asarray(result["hook_load"], float) if "hook_load" in result else top
        bottom = _force_of_bit(result, bottom)
    return _in_turn(top, upper[:, 1:], bottom, tension)


def torque_along(result: Any, course: Course) -> np.ndarray:
    """Torque at lumps and middles of links in turn, (m, 2 n + 1) N m; where no torque on bit is told, it has none."""
    torque = np.asarray(result["torque"], float)
    half = np.diff(course.rest)
    upper, _ = ends_of_links(half[1:] / (half[:-1] + half[1:]), np.zeros(len(torque)), torque)
    top = np.asarray(result["surface_torque"], float) if "surface_torque" in result else torque[:, 0]
    bit = np.asarray(result["torque_on_bit"], float) if "torque_on_bit" in result else np.zeros(len(torque))
    return _in_turn(top, upper[:, 1:], bit, torque)


def _by_weight(result: Any, course: Course, tension: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tension at the first and the last lump, (m,) N each, if the weight of half a link is all that acts beyond the
    middles of the first and the last link; that of the middles where the result has no weights."""
    if course.added or "buoyed_weight" not in result:
        return tension[:, 0], tension[:, -1]
    weight, position = np.asarray(result["buoyed_weight"], float), np.asarray(result["position"], float)
    way = position[:, [1, -1]] - position[:, [0, -2]]
    first, last = (weight[[0, -1]] * way[..., 2] / np.linalg.norm(way, axis=-1)).T
    return tension[:, 0] + first, tension[:, -1] - last


def _force_of_bit(result: Any, otherwise: np.ndarray) -> np.ndarray:
    """Force on the string's lower end, (m,) N, positive downhole; what is given where no scene tells it."""
    scene = scene_of(result)
    if scene is None:
        return otherwise
    weight = np.asarray(result["weight_on_bit"], float) if "weight_on_bit" in result else np.zeros(otherwise.size)
    return scene.bit.force - weight


def _weights(result: Any, course: Course) -> np.ndarray:
    """Buoyed weights of the links, (n,) N; their lengths where some do not weigh, or the result has no weights.

    A lump has half the weights of the links beside it, so that the first tells the first link's, and so on.
    """
    length = np.diff(course.rest)
    if course.added or "buoyed_weight" not in result:
        return length
    found, before = np.empty(length.size), 0.0
    for i, lump in enumerate(np.asarray(result["buoyed_weight"], float)[:-1]):
        found[i] = before = 2.0 * lump - before
    return found if found.min() > 0.0 else length


def _in_turn(top: np.ndarray, inside: np.ndarray, bottom: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Values of lumps and middles in turn, (m, 2 n + 1).

    Parameters
    ----------
    top, bottom : (m,) array
        Of the first and the last lump.
    inside : (m, n - 1) array
        Of the lumps between two links.
    middles : (m, n) array
    """
    found = np.empty((len(middles), 2 * middles.shape[1] + 1))
    found[:, 0], found[:, 2:-1:2], found[:, -1], found[:, 1::2] = top, inside, bottom, middles
    return found
