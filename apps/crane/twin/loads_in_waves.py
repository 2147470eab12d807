"""What waves make of a crane's sensors that nobody measures: loads with a height in waves whose phases are drawn.

The real sea has the spectrum of the scene at best, and other phases. By how much the tension then misses is known as a
standard deviation: that of the force on the load, by linear theory and the spectrum, and twice its variance, as the
simulated sea and the real one have it both.

Buoyancy rho g V s(x) of a load that pierces the surface is linearised over how the surface goes up and down about the
load: it has the standard deviation that s has then. The pressure of the waves and the added mass act against it with
the acceleration of the water in the middle of what is under water, drag beside both with its velocity.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crane.assembly.layout import Layout
from crane.assembly.loads import pull
from crane.groups.immersion import share_of
from crane.scene.bodies import Body
from crane.scene.scene import CraneScene
from crane.sea.waves import waves_of
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.waves import Waves
from tautline.twin.operation import Blur

WHY = "waves move the load, and no sensor shows their phases: what they do to the tension is known as a deviation only"
SUSPECT = "waves"
PLACES, WEIGHTS = np.polynomial.hermite_e.hermegauss(9)
"""Places of the surface, in standard deviations, and weights with which a normal one is averaged."""
NO_PULL = 0.1
"""Upward pull on a load of a tension of 1 N, N, below which it does not hang on the rope."""


def doubts_of_waves(scene: CraneScene) -> list[str]:
    """Sentences for a twin of loads with a height: what it does not know of the sea."""
    names = [body.name for body in scene.bodies if body.height is not None]
    if not names or scene.water is None:
        return []
    loads = ", ".join(names)
    if scene.water.waves is None:
        return [
            f"the scene has no waves: where the real sea has some, their force on {loads} passes for weight at the "
            "surface. Give water.waves: the deviations that are told then have that force"
        ]
    return [
        f"the waves on {loads} are not those of the real sea, as no sensor shows their phases. Near the surface the "
        "force of the waves is therefore in the deviations that are told, and health is not good there"
    ]


class LoadsInWaves:
    """The bodies of a scene that have a height, and what the sea does to each.

    Parameters
    ----------
    scene : CraneScene
    """

    def __init__(self, scene: CraneScene) -> None:
        water = scene.water
        self._bodies = {} if water is None else {one.name: one for one in scene.bodies if one.height is not None}
        self._surface = 0.0 if water is None else water.surface
        self._density = 0.0 if water is None else water.density
        self._gravity = float(np.linalg.norm(scene.gravity)) or EARTH_GRAVITY
        self._waves: Waves | None = None
        self._pulls: Mapping[str, Any] = {}

    @property
    def reads(self) -> tuple[str, ...]:
        """Outputs that it wants."""
        return tuple(f"{name}.position" for name in self._bodies)

    def built(self, layout: Layout) -> None:
        """Take notice of how the rope holds the loads, and of the waves that are simulated."""
        self._pulls, self._waves = pull(layout.scene, layout.path), waves_of(layout.scene)

    def blurred(self, read: Mapping[str, np.ndarray], sensors: Mapping[str, str]) -> Blur:
        """What waves make of sensors in N, each taken for the tension of the rope, and of those they shake."""
        forces, rates, near = 0.0, 0.0, False
        for name, body in self._bodies.items():
            assert body.height is not None
            wet = self._surface - float(np.asarray(read[f"{name}.position"])[0, 2]) + body.bottom
            near |= -body.height < wet < 2.0 * body.height
            upward = abs(float(self._pulls[name][2])) if name in self._pulls else 0.0
            if self._waves is not None and upward > NO_PULL:
                force = self._force(self._waves, body, wet) / upward
                forces += float(np.sum(force**2))
                rates += float(np.sum((self._waves.frequency * force) ** 2))
        # Half the square of an amplitude, once for the sea that is simulated and once for the real one.
        sds = np.array([np.sqrt(forces) if unit == "N" else 0.0 for unit in sensors.values()])
        lasts = np.pi * float(np.sqrt(forces / rates)) if rates > 0.0 else 0.0
        return Blur(sds, lasts, WHY, SUSPECT if near else "")

    def _force(self, waves: Waves, body: Body, wet: float) -> np.ndarray:
        """Amplitudes (n,) of the upward force on a body whose lowest point is so deep below the level, by wave."""
        assert body.height is not None
        swell = max(float(np.sqrt(0.5 * np.sum(waves.amplitude**2))), 1e-9)
        shares = np.array([share_of.py_func((wet + swell * at) / body.height)[2] for at in PLACES])
        weight = WEIGHTS / WEIGHTS.sum()
        share = float(weight @ shares)
        displaced = self._density * body.volume
        stiff = displaced * self._gravity * float(np.sqrt(weight @ (shares - share) ** 2)) / swell
        middle = min(max(0.5 * max(wet, 0.0), wet - 0.5 * body.height), waves.depth)
        k, turn = waves.number, waves.frequency
        reach = (np.exp(-k * middle) - np.exp(-k * (2.0 * waves.depth - middle))) / (
            1.0 - np.exp(-2.0 * k * waves.depth)
        )
        speed = float(np.sqrt(0.5 * np.sum((waves.amplitude * turn * reach) ** 2)))
        drag = body.drag.linear[2] + body.drag.quadratic[2] * np.sqrt(8.0 / np.pi) * speed
        inertia = share * (displaced + body.added_mass[2]) * turn**2 * reach
        return np.asarray(waves.amplitude * np.hypot(stiff - inertia, share * drag * turn * reach))
