"""What is told of a crane's parts when they are picked: numbers of drums, sheaves and loads over the run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from crane.scene.scene import Drum, End, Sheave
from tautline.view.space.appearance import History


def of_drum(result: Any, path: Any, i: int) -> tuple[History, ...]:
    """Of the drum at place `i` of the path."""
    k = sum(isinstance(item, Drum) for item in path[:i])
    return tuple(
        _stored(
            result,
            k,
            ("drum_tension", "rope tension", "N"),
            ("pay_out_speed", "pay-out speed", "m/s"),
            ("paid_out", "rope paid out", "m"),
            ("drum_rotation", "rotation, paying out", "rad"),
            ("winch_torque", "torque", "N m"),
            ("winch_power", "power", "W"),
        )
    )


def of_sheave(result: Any, path: Any, i: int) -> tuple[History, ...]:
    """Of the sheave at place `i` of the path: tension on either side, and what the rope does there."""
    k = sum(isinstance(item, Sheave) for item in path[:i])
    found = []
    if "tension" in result:
        tension = np.asarray(result["tension"])
        # By the neighbours, as figures say it: which side runs on and which off changes with the rope's direction.
        before, after = path[i - 1].name, path[i + 1].name
        found.append(History("tension_before", f"tension, side of {before}", "N", tension[:, i - 1, 1]))
        found.append(History("tension_after", f"tension, side of {after}", "N", tension[:, i, 0]))
    if "sheave_load" in result:
        load = np.linalg.norm(np.asarray(result["sheave_load"])[:, k], axis=-1)
        found.append(History("sheave_load", "force of the rope", "N", load))
    kinds = (("sheave_rotation", "rotation", "rad"), ("wrap_angle", "angle of contact", "rad"))
    return (*found, *_stored(result, k, *kinds))


def of_load(result: Any, path: Any, k: int, name: str) -> tuple[History, ...]:
    """Of the body with number `k` and a name: tension of the rope that ends in it, height, speed."""
    found = []
    for i, item in enumerate(path):
        if isinstance(item, End) and item.body == name and "tension" in result:
            tension = np.asarray(result["tension"])
            span = tension[:, i - 1, 1] if i else tension[:, 0, 0]
            found.append(History("rope_tension", "rope tension", "N", span))
    place, speed = np.asarray(result["body_position"])[:, k], np.asarray(result["body_velocity"])[:, k]
    found.append(History("height", "height", "m", place[:, 2]))
    found.append(History("vertical_speed", "vertical speed", "m/s", speed[:, 2]))
    found += [History(axis, axis, "m", place[:, c]) for c, axis in enumerate("xy")]
    return tuple(found)


def _stored(result: Any, k: int, *kinds: tuple[str, str, str]) -> Iterator[History]:
    """Column `k` of stored variables, where they are there: names, words, units."""
    for name, text, unit in kinds:
        if name in result:
            yield History(name, text, unit, np.asarray(result[name])[:, k])
