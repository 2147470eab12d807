"""The longest steps at which a bit is followed: at rest, where it chatters, and where its blades make it bounce.

At rest. An explicit method takes the torque of a bit as a function of its speed, in full above ``slip_speed``: a
damper, T / (J slip_speed) 1/s, and a step beyond the reach of the method over that overshoots: the bit swings from
one full torque to the other. Friction is bounded, so nothing blows up, and the critical step does not count it.

With blades. The lump of mass m at the bit stands on chips of stiffness K = n a zeta eps, and each blade cuts what the
one before has left a delay 2 pi / (n Omega) ago: it may swing up by itself at about sqrt(K / m), and bounce. A method
that damps what its step cannot follow takes that away, and shows smooth drilling, with no other sign.
"""

from __future__ import annotations

import math

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, torque_at
from drillstring.drilling.end_groups import BLOCK, ROTATION, requests
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps
from tautline.kernels.time_function import sample
from tautline.scene.methods import method_of
from tautline.scene.values.printed import quantity
from tautline.system.time_functions import compile_functions

SAFE = 0.8
"""Share of that step that is taken where the step is chosen: weight on the bit may rise above that of the scene."""

OF_THE_PERIOD, OF_THE_DELAY = 0.03, 0.05
"""Step over the period of the bit on its chips, and over the delay between two blades, up to which a bit is followed.
With rho_inf 0.5 a bit that swings up in truth did so at 0.6 and 1.2 times the first, and no more at 6 times."""

ROUNDED = 1.0e-9
"""Relative difference of two steps that is rounding."""

INSTANTS = 201
"""Times of a run at which its fastest rotary speed is looked for."""

MANY = 1.0e6
"""Steps of a run that take a minute or more."""


def calm_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Longest step, s, at which a bit at rest does not chatter; infinite where it cannot."""
    if not scene.bit.on_bottom or not scene.solver.explicit:
        return math.inf
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, 0.0, True)[0]
    inertia = float(lumps.of_lumps(lambda tube: tube.rotary_inertia)[-1])
    torque = max(torque_at(b, scene.bit.weight or 0.0, spin) for spin in (0.0, -math.ulp(0.0)))
    reach = method_of(scene.solver.method).reach_of_vibration
    return reach * scene.bit.slip_speed * inertia / torque if torque > 0.0 else math.inf


def blade_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Longest step, s, at which a bit is seen to bounce on its blades; infinite where they cut nothing in the run."""
    if not scene.bit.on_bottom or scene.bit.cutting is None or scene.bit.cutting.blades is None:
        return math.inf
    functions = compile_functions(requests(scene))
    times = np.linspace(0.0, scene.solver.end, INSTANTS)
    spin = float(sample(functions, ROTATION, times)[:, 1].max())
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, spin, False)[0]
    lowered = bool(np.any(sample(functions, BLOCK, times)[:, 1] > 0.0)) or bool(scene.driven)
    if spin <= 0.0 or (b.weight <= b.limit and not lowered):
        return math.inf
    mass = float(lumps.of_lumps(lambda tube: tube.mass_per_length)[-1])
    period = 2.0 * math.pi * math.sqrt(mass / (b.blades * b.cut_weight))
    delay = 2.0 * math.pi / (b.blades * spin)
    return min(OF_THE_PERIOD * period, OF_THE_DELAY * delay)


def longest_step(scene: DrillstringScene, lumps: Lumps, step: float) -> float:
    """The longest step, s, that a run takes where it would be ``step``: one that is chosen is short enough."""
    if scene.solver.step != "auto":
        return step
    return min(step, SAFE * calm_step(scene, lumps), blade_step(scene, lumps))


def chatter_told(scene: DrillstringScene, lumps: Lumps, step: float) -> list[str]:
    """Sentences where a bit at rest chatters at a step of a run, s, or may bounce unseen; none of one short enough."""
    return [*rest_told(scene, lumps, step), *blades_told(scene, lumps, step)]


def rest_told(scene: DrillstringScene, lumps: Lumps, step: float) -> list[str]:
    """A sentence where a bit at rest chatters at a step of a run, s; none of one that is short enough."""
    calm = calm_step(scene, lumps)
    if not step > calm:
        return []
    speed = scene.bit.slip_speed * step / calm
    return [
        f"a bit at rest chatters at a step of {step:.4g} s, and loses energy: take a step of {calm:.2g} s, a "
        f"slip_speed of {speed:.2g} rad/s, or generalized-alpha, whose bit sticks exactly"
    ]


def blades_told(scene: DrillstringScene, lumps: Lumps, step: float) -> list[str]:
    """A sentence where a bit with blades may bounce unseen at a step of a run, s; none of one that is short enough."""
    seen = blade_step(scene, lumps)
    # Frames divide into whole steps, which are rounded.
    if not step > (1.0 + ROUNDED) * seen:
        return []
    digit = 10.0 ** (math.floor(math.log10(seen)) - 1)
    enough = f"{digit * math.floor(seen / digit):.2g} s"
    return [
        f"a step of {quantity(step, 's')} is too long for a bit with blades. Blades may make the bit bounce. Steps "
        f"longer than about {enough} damp that away, and the run may then show smooth drilling. Take a step of "
        f"{enough} or less"
    ]


def slowed_told(scene: DrillstringScene, lumps: Lumps) -> str:
    """A sentence where a chosen step becomes so short by the bit at rest that the run takes long; else empty."""
    taken = SAFE * calm_step(scene, lumps)
    steps = scene.solver.end / taken
    if scene.solver.step != "auto" or steps < MANY:
        return ""
    return (
        f"the bit would chatter at rest with steps longer than {taken:.2g} s, so the run takes {steps:.2g} steps: give "
        "a larger slip_speed, or take generalized-alpha, whose bit sticks exactly"
    )
