"""The longest explicit step at which a bit at rest does not chatter.

An explicit method takes the torque of a bit as a function of its speed, in full above ``slip_speed``. At rest that is a
damper, T / (J slip_speed) 1/s, and a step beyond the reach of the method over that overshoots: the bit swings from
one full torque to the other. Friction is bounded, so nothing blows up, and the critical step does not count it.
"""

from __future__ import annotations

import math

from drillstring.drilling.bit_numbers import bit_row, torque_at
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps
from tautline.scene.methods import method_of

SAFE = 0.8
"""Share of that step that is taken where the step is chosen: weight on the bit may rise above that of the scene."""

MANY = 1.0e6
"""Steps of a run that take a minute or more."""


def calm_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Longest step, s, at which a bit at rest does not chatter; infinite where it cannot."""
    if not scene.bit.on_bottom or not scene.solver.explicit:
        return math.inf
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, 0.0, True)[0]
    inertia = float(lumps.of_lumps(lambda tube: tube.rotary_inertia)[-1])
    torque = torque_at(b, scene.bit.weight or 0.0, 0.0)
    reach = method_of(scene.solver.method).reach_of_vibration
    return reach * scene.bit.slip_speed * inertia / torque if torque > 0.0 else math.inf


def longest_step(scene: DrillstringScene, lumps: Lumps, step: float) -> float:
    """The longest step, s, that a run takes where it would be ``step``: one that is chosen is short enough."""
    return min(step, SAFE * calm_step(scene, lumps)) if scene.solver.step == "auto" else step


def chatter_told(scene: DrillstringScene, lumps: Lumps, step: float) -> list[str]:
    """A sentence where a bit at rest chatters at a step of a run, s; none of one that is short enough."""
    calm = calm_step(scene, lumps)
    if not step > calm:
        return []
    speed = scene.bit.slip_speed * step / calm
    return [
        f"a bit at rest chatters at a step of {step:.4g} s, and loses energy: take a step of {calm:.2g} s, a "
        f"slip_speed of {speed:.2g} rad/s, or generalized-alpha, whose bit sticks exactly"
    ]


def slowed_told(scene: DrillstringScene, lumps: Lumps) -> str:
    """A sentence where a chosen step becomes so short by the bit at rest that the run takes long; else empty."""
    taken = longest_step(scene, lumps, math.inf)
    steps = scene.solver.end / taken
    if scene.solver.step != "auto" or steps < MANY:
        return ""
    return (
        f"the bit would chatter at rest with steps longer than {taken:.2g} s, so the run takes {steps:.2g} steps: give "
        "a larger slip_speed, or take generalized-alpha, whose bit sticks exactly"
    )
