"""Natural frequencies of a string against rotary speed: lateral ones of the assembly, torsional and axial of the whole.

They are those of small vibrations about the static equilibrium of the scene, undamped, as its model has them, lumps or
a beam: tension and weight on bit, buoyed weight, added mass and mud inside; a contact that bears load is a spring
across the hole, and by its normal force one around it; friction does not hold. The rock under a bit on bottom is a
spring along the hole, which a hole that deepens by drilling would only damp. The models have no gyroscopic and no
rotatory inertia of bending, so that frequencies do not depend on rotary speed; `Mode.turning` tells what these would
do.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, stiffness_of
from drillstring.model.prepared import tubes_of, well_of
from drillstring.modes import bha
from drillstring.modes.lateral_modes import Support, lateral_modes
from drillstring.modes.natural_modes import Mode, with_errors
from drillstring.modes.rest import Rest, rest_of
from drillstring.scene.scene import LUMPED, DrillstringScene

IN_A_BEND = 15.0
"""Longest element of a beam for axial modes in a curved hole, m, in the coarser of two meshes: longer ones leave the
hole's curve between their points of contact, and what then moves along it they resist by bending."""


class Critical(NamedTuple):
    """Rotary speed (rad/s) at which ``order`` times it meets the frequency of a mode, by its number."""

    mode: int
    order: float
    speed: float


@dataclass(frozen=True)
class Campbell:
    """What a Campbell diagram shows; speeds rad/s, frequencies Hz, depths m; links or elements of the finer mesh.

    ``loose`` are stabilisers that neither touch the wall nor are held; ``model`` is ``lumped`` or ``ale-ancf``.
    ``rock`` is the stiffness that holds the bit along the hole, N/m, 0 of one that is free.
    """

    modes: list[Mode]
    supports: list[Support]
    top: float
    bottom: float
    speeds: tuple[float, float]
    orders: tuple[float, ...]
    up_to: float
    links: dict[str, int]
    loose: tuple[str, ...] = ()
    model: str = LUMPED
    rock: float = 0.0

    @property
    def critical(self) -> list[Critical]:
        """Crossings inside the range of speeds, from slow to fast."""
        low, high = self.speeds
        found = [
            Critical(k, order, 2.0 * pi * mode.frequency / order)
            for k, mode in enumerate(self.modes)
            for order in self.orders
            if mode.frequency > 0.0
        ]
        return sorted((one for one in found if low <= one.speed <= high), key=lambda one: one.speed)

    @property
    def unstable(self) -> list[Mode]:
        """Modes that grow: the string buckles, or is not at rest where it seems to be."""
        return [mode for mode in self.modes if mode.frequency < 0.0]


def campbell(
    scene: DrillstringScene,
    speeds: tuple[float, float],
    orders: tuple[float, ...] = (1.0, 2.0, 3.0),
    kinds: tuple[str, ...] = ("lateral",),
    up_to: float | None = None,
    top: float | None = None,
    held: frozenset[str] = frozenset(),
) -> Campbell:
    """Natural frequencies and critical speeds.

    Parameters
    ----------
    scene : DrillstringScene
    speeds : (float, float)
        Rotary speeds from and to, rad/s.
    orders : tuple of float
        Multiples of the rotary speed that excite.
    kinds : tuple of str
        Of ``KINDS``.
    up_to : float, optional
        Highest frequency, Hz; by default three times the fastest speed.
    top : float, optional
        Measured depth of the upper end of the lateral modes, m, where it is not to be found.
    held : set of str
        Names of sections whose lumps are held where they rest, and ``bit``, which is held on the axis.

    Raises
    ------
    SceneError
        As the builder does, and where the mesh would be too large.
    StoppedEarly
        NO_EQUILIBRIUM.
    """
    highest = up_to if up_to is not None else 3.0 * speeds[1] / (2.0 * pi)
    if "bit" in held:
        scene = scene.model_copy(update={"bit": scene.bit.model_copy(update={"lateral": "pinned"})})
    well = well_of(scene)
    bottom = float(sum(tube.length for tube in tubes_of(scene, well.length)))
    modes: list[Mode] = []
    supports: list[Support] = []
    links: dict[str, int] = {}
    upper = 0.0
    if "lateral" in kinds:
        found, supports, upper, links["lateral"] = lateral_modes(scene, highest, top, held)
        modes += found
    for kind in ("torsional", "axial"):
        if kind in kinds:
            found, links[kind] = _of_a_rod(scene, kind, highest)
            modes += found
    names = [scene.string[i].name for i in bha.stabilisers_of(scene)] if supports and scene.well.wall else []
    holding = {support.section for support in supports[1:]}
    loose = tuple(name for name in dict.fromkeys(names) if name not in holding)
    rock = _rock(scene)
    return Campbell(modes, supports, upper, bottom, speeds, orders, highest, links, loose, scene.model.kind, rock)


def _rock(scene: DrillstringScene) -> float:
    """Stiffness that holds the bit along the hole, N/m."""
    if not scene.bit.on_bottom:
        return 0.0
    tubes = tubes_of(scene, well_of(scene).length)
    return stiffness_of(bit_row(scene.bit, scene.well.diameter, tubes, 0.0, False)[0])


def _of_a_rod(scene: DrillstringScene, kind: str, highest: float) -> tuple[list[Mode], int]:
    """Torsional or axial modes of the whole string, with all that hangs on its ends, and links of the finer mesh."""
    well = well_of(scene)
    tubes = tubes_of(scene, well.length)
    if kind == "torsional":
        slowest = min(np.sqrt(tube.torsional_stiffness / tube.rotary_inertia) for tube in tubes)
    else:
        slowest = min(np.sqrt(tube.youngs_modulus * tube.area / tube.mass_per_length) for tube in tubes)
    # In torsion the elements of a beam are no better than links.
    model = LUMPED if kind == "torsional" else scene.model.kind
    longest = float(slowest) / highest / bha.PER_WAVE[model]
    if model != LUMPED and np.hypot(well.k1, well.k2).any():
        longest = min(longest, IN_A_BEND)
    mesh = bha.evenly(scene, longest)
    rough, modes = (_rod_modes(rest_of(one), kind, highest) for one in (mesh, mesh.doubled()))
    return with_errors(modes, rough), 2 * sum(mesh.counts)


def _rod_modes(linear: Rest, kind: str, highest: float) -> list[Mode]:
    frequency, shapes = linear.along(kind, highest)
    depth = linear.lumps.measured_depth
    return [
        Mode(kind, "", float(f), np.nan, depth, (shape / shape[np.abs(shape).argmax()])[:, None], 0.0)
        for f, shape in zip(frequency, shapes.T, strict=True)
    ]
