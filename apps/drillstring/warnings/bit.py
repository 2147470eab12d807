"""What to tell a user about a bit on bottom before the run: too heavy, without torque, drilled away from, undamped."""

from __future__ import annotations

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, rate_at, torque_at, weight_at
from drillstring.drilling.end_groups import BLOCK, ROTATION
from drillstring.model.build import requests
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import Lumps
from drillstring.string.strength import tension_at_rest
from drillstring.well.wellbore import Wellbore
from tautline.kernels.time_function import sample, value_at
from tautline.scene.errors import SceneWarning
from tautline.scene.methods import RK4, method_of
from tautline.scene.solver import longest_step
from tautline.scene.values.printed import shown
from tautline.system.time_functions import compile_functions

LIMIT = RK4.reach_of_vibration
"""omega h beyond which RK4 is unstable."""
OFF = 0.05
"""Difference of the block's speed from the rate of penetration, over the latter, that is told."""
UPRIGHT = np.radians(10.0)
"""Inclination below which a pipe in compression is not held by the hole."""
RINGS = 0.95
"""Spectral radius at infinity above which the shock of a bit that sticks goes on to oscillate."""


def bit_warnings(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a bit on bottom."""
    return [
        *_of_weight(scene, well, lumps), *_of_torque(scene), *_of_drilling(scene, lumps), *_of_method(scene),
        *_of_chatter(scene, lumps),
    ]  # fmt: skip


def _of_weight(scene: DrillstringScene, well: Wellbore, lumps: Lumps) -> list[SceneWarning]:
    tension = np.append(tension_at_rest(scene, well, lumps), scene.bit.load)
    weight, hook = (shown(force, "N", scene.units) for force in (scene.bit.weight or 0.0, float(tension[0])))
    if tension[0] < 0.0:
        # No refusal: rigs with pull-down push strings so, and the model computes what they do.
        cause = f"{weight} is more than the string weighs along the hole: the hook load is {hook} at rest"
        if scene.top.weight + tension[0] < 0.0:
            cause += ", and a hoist cannot push"
        else:
            cause += ", which the top drive's weight gives"
        return [SceneWarning("bit.weight", f"{cause}; take less, or a heavier string, unless the rig has a pull-down")]
    end = lumps.tubes[0].length
    if len(lumps.tubes) > 1 and tension[1] < 0.0 and float(well.inclination(np.array([end]))[0]) < UPRIGHT:
        name, pressed = lumps.tubes[0].name, shown(-float(tension[1]), "N", scene.units)
        return [
            SceneWarning(
                "bit.weight",
                f"{weight} puts the lower end of {name} under {pressed} of compression in an upright hole: it may "
                "buckle; take less, or more collars",
            )
        ]
    return []


def _of_torque(scene: DrillstringScene) -> list[SceneWarning]:
    """Where a bit is turned that has no law of torque."""
    if scene.bit.torque is not None or scene.bit.cutting is not None:
        return []
    functions = compile_functions(requests(scene))
    if not np.any(sample(functions, ROTATION, np.linspace(0.0, scene.solver.end, 201))[:, 1]):
        return []
    cause = "is not given: the rock is taken to resist the turning bit with no torque at all, whatever its weight"
    cure = "give bit.torque, such as {static: 8 kN m, kinetic: 4 kN m}, or bit.cutting"
    return [SceneWarning("bit.torque", f"{cause}; {cure}")]


def _of_drilling(scene: DrillstringScene, lumps: Lumps) -> list[SceneWarning]:
    """Where the block is not lowered as fast as the bit drills."""
    functions = compile_functions(requests(scene))
    feed = value_at(functions, BLOCK, scene.solver.end)[1]
    spin = value_at(functions, ROTATION, scene.solver.end)[1]
    if scene.bit.penetration is None and scene.bit.cutting is None:
        if feed <= 0.0:
            return []
        cause = f"lowers the bit at {_rate(scene, feed)} onto a bottom that is not drilled"
        return [SceneWarning("top.block", f"{cause}; give bit.penetration or bit.cutting, or hold the block")]
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, spin, False)[0]
    rate = rate_at(b, scene.bit.weight or 0.0, spin)
    if abs(feed - rate) <= OFF * rate:
        return []
    then = weight_at(b, feed, spin)
    found = shown(then, "N", scene.units) if np.isfinite(then) else "no steady value, for the bit does not turn"
    moves = "raised" if feed < 0.0 else "lowered"
    return [
        SceneWarning(
            "top.block",
            f"is {moves} at {_rate(scene, abs(feed))} at the end and the bit drills {_rate(scene, rate)} with its "
            f"weight: the weight on bit goes to {found}",
        )
    ]


def _rate(scene: DrillstringScene, rate: float) -> str:
    """A rate of penetration as drillers say it."""
    return shown(3600.0 * rate, "m/h", scene.units, digits=3)


def _of_method(scene: DrillstringScene) -> list[SceneWarning]:
    alpha_f = scene.solver.alphas[1]
    sticks = scene.bit.torque is not None or scene.bit.cutting is not None
    # rho_inf = alpha_f / (1 - alpha_f) on the line of eqs 2.79-2.80; Newmark's is 1
    rho = alpha_f / (1.0 - alpha_f) if method_of(scene.solver.method).has_alphas and alpha_f < 1.0 else 1.0
    if scene.solver.explicit or not sticks or rho <= RINGS:
        return []
    return [
        SceneWarning(
            "solver.rho_inf" if method_of(scene.solver.method).has_alphas else "solver.method",
            "does not damp what a step cannot follow: after the shock of a bit that sticks its torque oscillates, and "
            "the bit is released too early; take generalized-alpha with rho_inf 0.9 or less",
        )
    ]


def _of_chatter(scene: DrillstringScene, lumps: Lumps) -> list[SceneWarning]:
    """Where an explicit step is too long for the torque of a bit at rest, which rises with its speed."""
    if not scene.solver.explicit:
        return []
    b = bit_row(scene.bit, scene.well.diameter, lumps.tubes, 0.0, True)[0]
    inertia = float(lumps.of_lumps(lambda tube: tube.density * tube.polar_moment)[-1])
    steepness = torque_at(b, scene.bit.weight or 0.0, 0.0) / inertia
    step = longest_step(scene.solver, scene.output.interval)
    if steepness * step <= LIMIT * scene.bit.slip_speed:
        return []
    return [
        SceneWarning(
            "bit.slip_speed",
            f"a bit at rest chatters at a step of {step:g} s, and loses energy: take a step of "
            f"{LIMIT * scene.bit.slip_speed / steepness:.2g} s, a slip_speed of {steepness * step / LIMIT:.2g} "
            "rad/s, or generalized-alpha, whose bit sticks exactly",
        )
    ]
