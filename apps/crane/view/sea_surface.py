"""The sea that a vessel's motion is the response to, as a surface."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tautline.scene.functions import Spectrum
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.time_functions import jonswap
from tautline.view.space.sea import Waves, wave_number

MOTIONS = ("heave", "pitch", "roll", "surge", "sway")
"""Of a vessel whose motions each have a spectrum of their own, the first one says what the sea is."""


def waves_of(scene: Any) -> Waves | None:
    """Waves of a scene's sea; None where it has none, or only the vessel's motion is known.

    A vessel's spectrum is that of the sea times its response `rao`; in phase with the wave at the vessel's reference.
    Waves run along x, or in the `direction` of the scene.
    """
    if scene.vessel is None or scene.water is None:
        return None
    motion, direction = scene.vessel.motion, 0.0
    if hasattr(motion, "sea"):
        sea, direction = motion.sea, motion.direction or 0.0
    else:
        found = (getattr(motion, name, None) for name in MOTIONS)
        sea = next((one for one in found if isinstance(one, Spectrum)), None)
    if sea is None:
        return None
    amplitude, frequency, phase = jonswap(sea.model_copy(update={"rao": 1.0}))
    gravity = float(np.linalg.norm(scene.gravity)) or EARTH_GRAVITY
    depth = scene.water.surface - scene.ground.level if scene.ground is not None else np.inf
    number = wave_number(frequency, depth if depth > 0.0 else np.inf, gravity)
    way, origin = np.array([math.cos(direction), math.sin(direction)]), np.array(scene.vessel.reference[:2], float)
    return Waves(amplitude, frequency, phase, number, way, origin, float(sea.ramp))
