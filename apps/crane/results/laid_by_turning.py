"""Rope that lies on a drum, or has come off it, because the drum or what its rope leads to turns about it.

It is no part of what the equations take from the drum: from mark to mark a span keeps its rope. So the stiffness and
the weight of the rope stay those of the start, whatever turning has laid on or taken off. That is told.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.layout import Layout
from crane.assembly.prepared import motion_of
from crane.results.course import nodes_of
from crane.results.observe import LEAD_ANGLE
from crane.scene.keys import where
from crane.scene.scene import Anchor, CraneScene, Drum
from crane.sea.frames import GROUND, point_of
from tautline.kernels.moving_frame import ENTRIES
from tautline.kernels.time_function import sample_all
from tautline.scene.values.printed import in_percent
from tautline.system.time_functions import compile_functions

MATTERS = 0.02
"""Share of the rope in a drum's span that turning may take off or lay on without a word."""
SAMPLES = 2001
SMALLEST = 1.0e-3
"""Rope below which a span has none, m."""


class Worst(NamedTuple):
    """When turning has changed the rope in a drum's span the most: time s, rope off the drum m, and rope computed m."""

    time: float
    off: float
    rope: float


def laid_by_turning(result: Any, layout: Layout) -> list[str]:
    """Sentences on drums that turning has unwound or wound by more than a share of the rope in their span.

    Also of what was told before the run: who runs a scene from Python, or drives it, has not been told.

    Parameters
    ----------
    result : Result
        Of one that keeps statistics nothing is told: they do not say what was at the same time.
    layout : Layout
        Of its scene.
    """
    scene = layout.scene
    if scene.output.statistics or LEAD_ANGLE not in result:
        return []
    time, lead = np.asarray(result.time, float), np.asarray(result[LEAD_ANGLE])
    material = np.asarray(result["material_coordinate"])[:, nodes_of(scene)]
    told = []
    for k, i in enumerate(_drums(scene)):
        span = _span(scene, i)
        rope = material[:, span + 1] - material[:, span]
        worst = _worst(time, abs(float(layout.wheels.radius[i])) * lead[:, k], rope)
        if worst is not None:
            told.append(f"{scene.path[i].name}: {_sentence(scene, i, worst)}")
    return told


def turning_foreseen(found: Estimate) -> Iterator[tuple[str, str]]:
    """The same before a run, as far as frames and the vessel alone turn what the rope leads to: key and text."""
    scene = found.scene
    for i in _drums(scene):
        if (worst := _foreseen(found.layout, i)) is not None:
            yield where(scene, scene.path[i]), _sentence(scene, i, worst)


def _foreseen(layout: Layout, i: int) -> Worst | None:
    scene = layout.scene
    time = np.linspace(0.0, scene.solver.end, SAMPLES)
    off = unwound(layout, i, time)
    if off is None:
        return None
    # Over the sheave beside it the rope runs on with its load: what is computed is as long as the line less `off`.
    drawn, last = layout.path.spans[_span(scene, i)].length, _beside(scene, i) in (0, len(scene.path) - 1)
    return _worst(time, off, np.full_like(off, drawn) if last else drawn - off)


def unwound(layout: Layout, i: int, time: np.ndarray) -> np.ndarray | None:
    """Rope that turning will have taken off the drum at place i of the path, (m,) m, at times (m,) s.

    None where nothing turns about it, or where the rope leads from it to what rides on a body.
    """
    scene, j = layout.scene, _beside(layout.scene, i)
    if not layout.turns_about(i) or getattr(scene.path[j], "body", None) is not None:
        return None
    functions = compile_functions(motion_of(scene).requests)
    here, columns = _carried(layout, i, time, functions)
    there, _ = _carried(layout, j, time, functions)
    # As the drum sees it: about its axis, from its mark.
    away = np.einsum("mkc,mc->mk", columns, there - here)
    axis, mark = layout.wheels.axis[i], layout.wheels.mark[i]
    angle = np.unwrap(np.arctan2(away @ np.cross(axis, mark), away @ mark))
    rho = float(layout.wheels.radius[i])
    return (-rho if i == 0 else rho) * (angle - angle[0])


def _carried(layout: Layout, i: int, time: np.ndarray, functions: Any) -> tuple[np.ndarray, np.ndarray]:
    """Centre of an item (m, 3) m and the columns of the rotation of its frame (m, 3, 3) at times (m,) s."""
    scene, item = layout.scene, layout.scene.path[i]
    point: Any = item.position if isinstance(item, Anchor) else getattr(item, "center", None)
    name = scene.frame_of(item)
    k = GROUND if name is None else next(k for k, frame in enumerate(layout.frames) if frame.name == name)
    if k == GROUND:
        return np.tile(np.array(point, float), (time.size, 1)), np.tile(np.eye(3), (time.size, 1, 1))
    entries = sample_all(functions, range(ENTRIES * k, ENTRIES * (k + 1)), time)[:, :, 0].T
    return point_of(entries, layout.frames[k].pivot, point), entries[:, 3:].reshape(-1, 3, 3)


def _drums(scene: CraneScene) -> list[int]:
    return [i for i, item in enumerate(scene.path) if isinstance(item, Drum)]


def _span(scene: CraneScene, i: int) -> int:
    """Number of the span that leaves a drum."""
    return 0 if i == 0 else len(scene.path) - 2


def _beside(scene: CraneScene, i: int) -> int:
    """Place of the item that the rope leads to from a drum."""
    return 1 if i == 0 else len(scene.path) - 2


def _worst(time: np.ndarray, off: np.ndarray, rope: np.ndarray) -> Worst | None:
    """The worst of histories (m,) of rope that has come off, over the rope that is computed, m; None of little."""
    rope = np.maximum(rope, SMALLEST)
    k = int(np.argmax(np.abs(off) / rope))
    return Worst(float(time[k]), float(off[k]), float(rope[k])) if abs(off[k]) > MATTERS * rope[k] else None


def _sentence(scene: CraneScene, i: int, worst: Worst) -> str:
    name, other = scene.path[i].name, scene.path[_beside(scene, i)].name
    does = f"takes {worst.off:.3g} m of rope off it" if worst.off > 0.0 else f"lays {-worst.off:.3g} m of rope on it"
    sense = "stiff and too light" if worst.off > 0.0 else "soft and too heavy"
    real = max(worst.rope + worst.off, SMALLEST)
    return (
        f"what turns about the drum {does} by t = {worst.time:.4g} s. The load follows that. But the stiffness and the "
        f"weight of the rope stay those of the rope at the start: between {name} and {other} {worst.rope:.3g} m are "
        f"computed where there are {real:.3g} m, {in_percent(abs(worst.off) / real)} off. The rope there is computed "
        f"too {sense}. Where bounce, snaps or sag matter, draw the scene as it is after the turning"
    )
