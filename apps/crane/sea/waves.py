"""The waves of a scene: those that its vessel answers, and those that act on its loads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from tautline.scene.functions import Harmonic, Spectrum, terms_of
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.time_functions import jonswap
from tautline.system.waves import Waves, wave_number


def vessel_waves(scene: Any) -> Waves | None:
    """Waves that a scene's vessel answers; None where it has none, or no water.

    A vessel's spectrum is that of the sea times its response `rao`; in phase with the wave at the vessel's reference.
    Waves run along x, or in the `direction` of the scene.
    """
    sea = None if scene.vessel is None else scene.vessel.sea
    if sea is None or scene.water is None:
        return None
    waves, direction = scene.water.waves, getattr(scene.vessel.motion, "direction", None)
    if waves is not None and waves.elevation == "vessel" and waves.direction is not None:
        direction = waves.direction
    return _waves(scene, sea.model_copy(update={"rao": 1.0}), direction or 0.0, scene.vessel.reference[:2])


def waves_of(scene: Any) -> Waves | None:
    """Waves that act on the loads of a scene; None where its water is still.

    Those of an `elevation` of their own have their phases where x = y = 0.
    """
    if scene.water is None or scene.water.waves is None:
        return None
    given = scene.water.waves
    if given.elevation == "vessel":
        return vessel_waves(scene)
    return _waves(scene, given.elevation, given.direction or 0.0, (0.0, 0.0))


def waves_seen(scene: Any) -> Waves | None:
    """Waves that are drawn: those on the loads, or else those that the vessel answers."""
    return waves_of(scene) or vessel_waves(scene)


def _waves(scene: Any, elevation: Any, direction: float, origin: Any) -> Waves:
    """The waves of a function of time in one direction, rad, over the ground of the scene."""
    parts = list(sines(elevation))
    amplitude, frequency, phase = (np.concatenate([part[k] for part in parts]) for k in range(3))
    gravity = float(np.linalg.norm(scene.gravity)) or EARTH_GRAVITY
    depth = scene.water.surface - scene.ground.level if scene.ground is not None else math.inf
    # Waves on loads have water below them. Those that are only drawn may lie below a quay: they are of deep water.
    depth = depth if depth > 0.0 else math.inf
    number = wave_number(frequency, depth, gravity)
    way = np.array([math.cos(direction), math.sin(direction)])
    # All terms grow over one time.
    ramp = float(next(terms_of(elevation))[1].ramp)
    return Waves(amplitude, frequency, phase, number, way, np.array(origin, float), ramp, depth, gravity)


def sines(function: Any) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Amplitudes, m, frequencies, rad/s, and phases, rad, of a spectrum, a harmonic, or a sum of them."""
    for _, term in terms_of(function):
        if isinstance(term, Spectrum):
            yield jonswap(term)
        elif isinstance(term, Harmonic):
            frequency = term.frequency if term.period is None else 1.0 / term.period
            assert frequency is not None
            yield np.array([term.amplitude]), np.array([2.0 * math.pi * frequency]), np.array([term.phase])
