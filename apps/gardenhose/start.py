"""Whether a hose that begins at rest, with water that flows out of its free end, would stay there.

The tangent of such a shape is not symmetric: its pivots tell nothing, and eigenvalues judge it.
"""

from __future__ import annotations

import math

from gardenhose.estimates import speeds
from gardenhose.scene import HoseScene
from tautline.integrators.status import StoppedEarly
from tautline.scene.values.printed import shown


def on_the_start(scene: HoseScene) -> list[str]:
    """Sentences on the shape at rest that a run starts from, where the least push moves the hose away for good.

    A hose that flutters about its shape is none of these: that is the motion which a run shows.
    """
    rate = _rate(scene)
    if not rate:
        return []
    speed = shown(float(speeds(scene, 1)[0]), "m/s", scene.units)
    return [
        f"the run starts from an unstable balance: at {speed} the hose leaves it for good, and its motion grows "
        f"e times in {shown(1.0 / rate, 's', scene.units)}. What it does then follows from the least push. "
        "With start: relaxed it begins in a shape in which it can stay, if there is one"
    ]


def _rate(scene: HoseScene) -> float:
    """Rate, 1/s, at which a hose leaves the shape at rest of t = 0; 0 where it stays, or no shape is found."""
    speed = float(speeds(scene, 1)[0])
    if scene.start != "static" or scene.hose.end != "free" or speed == 0.0 or not math.isfinite(speed):
        return 0.0
    # Eigenvalues need scipy, which only a run of such a hose loads.
    from gardenhose.flutter import falls_from

    try:
        return falls_from(scene, speed)
    except StoppedEarly:
        return 0.0
