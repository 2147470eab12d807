"""What to tell a user about a scene before it runs: large against what, and what to do."""

from __future__ import annotations

from math import degrees, pi, sqrt
from typing import Any

import numpy as np

from drillstring.model.lumped_string import lateral_mass
from drillstring.model.prepared import prepared, well_of
from drillstring.model.variations import bars
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.string.buoyancy import buoyancy_warnings
from drillstring.string.fluid import fluid_of
from drillstring.string.lumps import Lumps
from drillstring.string.strength import yield_warnings
from drillstring.warnings.wall import wall_warnings
from tautline.kernels.time_function import sample
from tautline.results.rounding import unrounded
from tautline.scene.errors import SceneWarning
from tautline.scene.methods import RK4
from tautline.scene.solver import longest_step
from tautline.scene.values.printed import shown
from tautline.system.time_functions import FunctionRequest, compile_functions

SLIP_FOR_NEWTON = 1.0e-3
SLIP_FOR_CREEP = 1.0e-3
"""Slip velocities, m/s, of the regularised law: below one Newton's method struggles, above the other it creeps."""
PAST_THE_END = 5.0
"""Metres that a string may hang past the hole's end, by its stretch and the heave, without a word."""
STAND = 45.0
"""Metres above the table to which a rig pulls the top of a string, before the stand is set back: four joints."""
LONG_FOR_MOTION = 0.05
"""Step over the fastest axial period of interest at which amplitudes are lost."""


def _lumps(scene: DrillstringScene) -> Lumps:
    return prepared(scene).lumps


def contact_critical_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Critical step of RK4 by the stiffest contact, eq. 2.170, the mud that moves with a lump counted; inf if none.

    A beam's elements ring along the hole faster than lumps do: for them it is the shorter of the two.
    """
    wall = scene.well.wall
    if wall is None:
        return float("inf")
    if scene.model.kind == BEAM:
        from drillstring.groups.beam_points import points_of
        from drillstring.model.beam_frequency import contact_frequency

        rattling = contact_frequency(points_of(lumps), wall, fluid_of(scene.mud), scene.well.diameter)
        return RK4.reach_of_vibration / max(rattling, *(bar.fastest for bar in bars(scene)))
    mass = lumps.of_lumps(lambda tube: tube.mass_per_length)
    mass = mass + lateral_mass(lumps, fluid_of(scene.mud), scene.well.diameter)
    od = lumps.largest(lambda tube: tube.od)
    stiffness = wall.stiffness * od / od.max() * lumps.tributary / (lumps.total / wall.lumps)
    return RK4.reach_of_vibration / float(np.sqrt((stiffness / mass)[1:].max()))


def _reach_of_block(scene: DrillstringScene) -> tuple[float, float]:
    """Highest and lowest position of the block, m down from the table."""
    end = scene.solver.end
    functions = compile_functions([FunctionRequest(scene.top.block, end=end, key="top.block")])
    positions = sample(functions, 0, np.linspace(0.0, end, 2001))[:, 0]
    return float(positions.min()), float(positions.max())


def _block_warnings(scene: DrillstringScene, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a block that takes the string out of the hole as it was drilled, at either end."""
    highest, lowest = _reach_of_block(scene)
    found = []
    past = lowest + lumps.total - well_of(scene).length
    if past > PAST_THE_END and not scene.bit.on_bottom:
        found.append(
            SceneWarning(
                "top.block",
                f"lowers the bit {past:.3g} m past the end of the hole, where the hole is taken to go on with its last "
                "curvature; deepen the well, or shorten the string",
            )
        )
    if -highest > lumps.total:
        cause = f"lifts the top of the string {-highest:.0f} m above the table, and all of it is {lumps.total:.0f} m"
        found.append(SceneWarning("top.block", f"{cause}: the string leaves the hole; give a shorter way"))
    elif -highest > STAND:
        cause = f"lifts the top of the string {-highest:.0f} m above the table, which few derricks can"
        cure = "the pipe stands there in one piece, straight on from the hole: trip stand by stand, a run for each"
        found.append(SceneWarning("top.block", f"{cause}: {cure}, or ask torque-drag for many depths"))
    return found


def _casing_warnings(scene: DrillstringScene, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of a casing that is longer than the hole, and of a string that moves past its shoe."""
    casing = None if scene.well.wall is None else scene.well.wall.casing
    if casing is None:
        return []
    found, well = [], well_of(scene)
    if casing.shoe > well.length:
        cause = f"{casing.shoe:g} m is below the end of the hole at {well.length:.0f} m: all of it is taken as cased"
        found.append(SceneWarning("well.wall.casing.shoe", f"{cause}; give the measured depth of the shoe"))
    highest, lowest = _reach_of_block(scene)
    moved, longest = lowest - highest, float(lumps.length.max())
    if moved > longest:
        cause = f"the block moves {moved:.3g} m, more than a link of {longest:.3g} m: lumps"
        found.append(
            SceneWarning(
                "well.wall.casing",
                f"{cause} keep the friction of where they start when they pass the shoe; torque-drag at several depths "
                "has it right",
            )
        )
    return found


def _friction_warnings(scene: DrillstringScene) -> list[SceneWarning]:
    """Warnings of slip velocities of the regularised law."""
    solver, wall = scene.solver, scene.well.wall
    if wall is None or wall.friction.static <= 0.0 or wall.friction.law != "regularised":
        return []
    found = []
    slow = wall.friction.slip_velocity
    if not solver.explicit and slow < SLIP_FOR_NEWTON:
        found.append(
            SceneWarning(
                "well.wall.friction.law",
                f"regularised friction with slip_velocity {slow:g} m/s is hard on an implicit method: steps are "
                "halved and may fail; use law: projection, which is exact",
            )
        )
    if slow > SLIP_FOR_CREEP:
        found.append(
            SceneWarning(
                "well.wall.friction.slip_velocity",
                f"{slow:g} m/s: a stuck string creeps at up to that speed; use law: projection",
            )
        )
    return found


def _mesh_warnings(scene: DrillstringScene, lumps: Lumps) -> list[SceneWarning]:
    """Warnings of elements that are too long."""
    if scene.model.kind == BEAM:
        from drillstring.warnings.beam import mesh_warnings

        if found := mesh_warnings(scene, well_of(scene), lumps):
            return found
    longest = float(lumps.length.max())
    if longest <= 0.25 * lumps.total or lumps.total <= 500.0:
        return []
    return [
        SceneWarning(
            "model.elements",
            f"an element is {longest:.0f} m long, {100 * longest / lumps.total:.0f} % of the string: friction and "
            "curvature are coarse; take more elements",
        )
    ]


def warnings(scene: DrillstringScene) -> list[SceneWarning]:
    """Warnings of a scene; raises SceneError where well and string do not fit."""
    lumps = _lumps(scene)
    found = []
    solver = scene.solver
    critical = contact_critical_step(scene, lumps)
    step = longest_step(solver, 0.0)
    if solver.explicit and step > critical:
        found.append(
            SceneWarning(
                "solver.step",
                f"{step:g} s is longer than RK4's critical step of {critical:.3g} s (stiffest wall contact, "
                "eq. 2.170): the run will become unstable; take a smaller step, or method: generalized-alpha",
            )
        )
    ratio = scene.output.interval / step if step > 0.0 else 1.0
    if abs(ratio - round(ratio)) > 1e-6:
        steps = int(np.ceil(ratio))
        found.append(
            SceneWarning(
                "output.interval",
                f"{scene.output.interval:g} s is not a whole number of steps of {step:g} s: "
                f"the step taken is {scene.output.interval / steps:.6g} s",
            )
        )
    sound = min(sqrt(tube.youngs_modulus / tube.density) for tube in lumps.tubes)
    period = 4.0 * lumps.total / sound
    if not solver.explicit and step > LONG_FOR_MOTION * period:
        found.append(
            SceneWarning(
                "solver.step",
                f"{step:g} s is long against the string's first axial period of about {period:.2g} s: its "
                f"motion is damped by the algorithm; take {0.01 * period:.1g} s or less",
            )
        )
    found += buoyancy_warnings(scene, lumps.tubes)
    found += wall_warnings(scene, well_of(scene), lumps)
    found += _friction_warnings(scene)
    found += _block_warnings(scene, lumps)
    found += _casing_warnings(scene, lumps)
    found += yield_warnings(scene, well_of(scene), lumps)
    if scene.bit.on_bottom:
        from drillstring.warnings.bit import bit_warnings

        found += bit_warnings(scene, well_of(scene), lumps)
    if scene.bit.load < 0.0:
        from drillstring.warnings.compression import buckling_warnings

        found += buckling_warnings(scene, well_of(scene), lumps)
    return found + _mesh_warnings(scene, lumps)


def figures(scene: DrillstringScene) -> dict[str, Any]:
    """Figures of well and string for ``check --json``, SI."""
    ready = prepared(scene)
    well, lumps = ready.well, ready.lumps
    end = well.position(np.array([well.length]))[0]
    stations = np.linspace(0.0, well.length, 2001)
    k1, k2 = well.curvature(stations)
    return {
        "well": {
            "length": well.length,
            **{name: unrounded(float(x), well.length) for name, x in zip(("north", "east"), end[:2], strict=True)},
            "vertical_depth": float(end[2]),
            "largest_inclination": float(well.inclination(stations).max()),
            "largest_curvature": float(np.hypot(k1, k2).max()),
        },
        "string": {
            "length": lumps.total,
            "elements": int(lumps.length.size),
            "mass": float(lumps.of_lumps(lambda tube: tube.mass_per_length).sum()),
            "displacement": float(lumps.of_lumps(lambda tube: pi / 4.0 * (tube.od**2 - tube.id**2)).sum()),
        },
        "critical_step_rk4": contact_critical_step(scene, lumps) if scene.well.wall is not None else None,
        "printed_in": scene.units,
    }


def describe(figures: dict[str, Any]) -> list[tuple[str, str]]:
    """Rows of a table for people, in the units that the scene asks for."""
    well, string = figures["well"], figures["string"]
    rows = [
        ("measured depth of the well", well["length"], "m"),
        ("true vertical depth", well["vertical_depth"], "m"),
        ("largest inclination", degrees(well["largest_inclination"]), "deg"),
        ("length of the string", string["length"], "m"),
        ("mass of the string", string["mass"], "kg"),
        ("displacement of its tubes", string["displacement"], "m^3"),
        ("elements", string["elements"], ""),
    ]
    if figures["critical_step_rk4"] is not None:
        rows.append(("critical step of RK4", figures["critical_step_rk4"], "s"))
    return [(text, shown(value, unit, figures["printed_in"])) for text, value, unit in rows]
