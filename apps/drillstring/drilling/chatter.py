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

from drillstring.drilling.bit_numbers import bit_row, torque_at_rest
from drillstring.drilling.end_groups import BLOCK, ROTATION, from_outside, speeds_of
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps
from tautline.scene.methods import method_of
from tautline.scene.values.printed import quantity, rounded

SAFE = 0.8
"""Share of that step that is taken where the step is chosen: weight on the bit may rise above that of the scene."""

OF_THE_PERIOD, OF_THE_DELAY = 0.03, 0.05
"""Step over the period of the bit on its chips, and over the delay between two blades, up to which a bit is followed.
With rho_inf 0.5 a bit that swings up in truth did so at 0.6 and 1.2 times the first, and no more at 6 times."""

ROUNDED = 1.0e-9
"""Relative difference of two steps that is rounding."""

UNDAMPED = 0.95
"""Spectral radius at infinity above which a method keeps what its step cannot follow."""

MANY = 1.0e6
"""Steps of a run that take a minute or more."""


def calm_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Longest step, s, at which a bit at rest does not chatter; infinite where it cannot."""
    if not scene.bit.on_bottom or not scene.solver.explicit:
        return math.inf
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, 0.0, True)[0]
    inertia = float(lumps.of_lumps(lambda tube: tube.rotary_inertia)[-1])
    torque = max(torque_at_rest(b, scene.bit.weight or 0.0, way) for way in (1.0, -1.0))
    reach = method_of(scene.solver.method).reach_of_vibration
    return reach * scene.bit.slip_speed * inertia / torque if torque > 0.0 else math.inf


def blade_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Longest step, s, at which a bit is seen to bounce on its blades; infinite where they cut nothing in the run."""
    if not scene.bit.on_bottom or scene.bit.cutting is None or scene.bit.cutting.blades is None:
        return math.inf
    spin = float(speeds_of(scene, ROTATION).max())
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, spin, False)[0]
    if not (spin > 0.0 or from_outside(scene, ROTATION)):
        return math.inf
    if b.weight <= b.limit and not from_outside(scene, BLOCK) and not (speeds_of(scene, BLOCK) > 0.0).any():
        return math.inf
    mass = float(lumps.of_lumps(lambda tube: tube.mass_per_length)[-1])
    period = 2.0 * math.pi * math.sqrt(mass / (b.blades * b.cut_weight))
    # How fast something outside will turn the bit is not known.
    delay = 2.0 * math.pi / (b.blades * spin) if spin > 0.0 else math.inf
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
    enough = f"{rounded(seen, 2):.2g} s"
    wrong = "may damp that away, and the run may then show smooth drilling"
    if keeps_all(scene):
        wrong = "do not follow that, and the run may then show too little bouncing or too much"
    return [
        f"a step of {quantity(step, 's')} is too long for a bit with blades. Blades may make the bit bounce. Steps "
        f"longer than about {enough} {wrong}. Take a step of {enough} or less"
    ]


def keeps_all(scene: DrillstringScene) -> bool:
    """Whether a method damps hardly anything of what its step cannot follow; explicit ones do near their limit."""
    alpha_f, method = scene.solver.alphas[1], method_of(scene.solver.method)
    # rho_inf = alpha_f / (1 - alpha_f) on the line of eqs 2.79-2.80; Newmark's is 1
    rho = alpha_f / (1.0 - alpha_f) if method.has_alphas and alpha_f < 1.0 else 1.0
    return not scene.solver.explicit and rho > UNDAMPED


def shortened_told(scene: DrillstringScene, lumps: Lumps, step: float) -> list[str]:
    """A sentence where a chosen step, at most ``step`` s, is kept shorter to show how blades make the bit bounce."""
    seen = blade_step(scene, lumps)
    if scene.solver.step != "auto" or seen >= min(step, SAFE * calm_step(scene, lumps)):
        return []
    if slowed_told(scene, lumps):  # which says the same as a warning
        return []
    return [
        f"step: auto takes steps of {seen:.2g} s at most, which show whether the blades make the bit bounce: that is "
        f"{float(f'{scene.solver.end / seen:.2g}'):g} steps or more"
    ]


def slowed_told(scene: DrillstringScene, lumps: Lumps) -> list[tuple[str, str]]:
    """Key and sentence where a chosen step becomes so short by the bit that the run takes long; none where it is not.

    The bit is at rest, or its blades may make it bounce: what wants the shorter steps is told.
    """
    calm, seen = SAFE * calm_step(scene, lumps), blade_step(scene, lumps)
    taken = min(calm, seen)
    steps = scene.solver.end / taken
    if scene.solver.step != "auto" or steps < MANY:
        return []
    if calm <= seen:
        return [(
            "bit.slip_speed",
            f"the bit would chatter at rest with steps longer than {taken:.2g} s, so the run takes {steps:.2g} steps: "
            "give a larger slip_speed, or take generalized-alpha, whose bit sticks exactly",
        )]  # fmt: skip
    return [(
        "solver.step",
        f"auto takes steps of {taken:.2g} s at most, which show whether the blades make the bit bounce, so the run "
        f"takes {steps:.2g} steps. Take fewer elements or a shorter `solver.end`, or give a step where bouncing does "
        "not matter",
    )]  # fmt: skip
