"""What to tell a user about a drill string before it runs: large against what, and what to do."""

from __future__ import annotations

from math import ceil, degrees, pi, sqrt
from typing import Any

import numpy as np

from drillstring.drilling.bit_numbers import bit_row, torque_at, torque_at_rest
from drillstring.drilling.chatter import blades_told, keeps_all, rest_told, slowed_told
from drillstring.drilling.end_groups import BLOCK, ROTATION, requests, speeds_of, turns
from drillstring.drilling.weight_of_run import is_of_the_scene, weight_of_run
from drillstring.mesh import ELEMENTS, too_long
from drillstring.model.lumped_string import lateral_mass
from drillstring.model.prepared import Prepared, prepared
from drillstring.results.limits import SNUG
from drillstring.results.unseen_buckling import told_at_rest
from drillstring.scene.ends import Controller
from drillstring.scene.hole import DRILLED
from drillstring.scene.scene import BEAM, DrillstringScene
from drillstring.string.buoyancy import CURE, buoyed_mass, buoyed_weight
from drillstring.string.fluid import fluid_of, weight_in
from drillstring.string.lumps import Lumps
from drillstring.string.strength import largest_at_rest, tension_at, tension_at_rest
from drillstring.warnings.block_warnings import OFF, penetration
from drillstring.warnings.hole_warnings import OF_THE_HOLE, Check, Sentences, sharpest
from drillstring.well.sections import dogleg_severity
from tautline.kernels.time_function import sample, value_at
from tautline.results.assessment.rounding import unrounded
from tautline.scene.errors import SceneWarning
from tautline.scene.methods import RK4, method_of
from tautline.scene.solver import longest_step, step_taken
from tautline.scene.unit_slips import meant, units_that_fit
from tautline.scene.values.printed import as_typed, quantity, shown
from tautline.scene.values.ranges import RANGES
from tautline.scene.values.units import RPM
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
LARGEST_SHARE = 0.8
"""Share of the yield load above which a string at rest is warned of: what is left is the margin of overpull."""
DEEP = 0.5
"""Depth in the wall over the clearance that is warned of; a stabiliser's clearance is taken as `SNUG` at least."""
LEANING = 0.01
"""Sine of the inclination that a vertical hole is taken to have: none is straight."""
UPRIGHT = np.radians(10.0)
"""Inclination below which a pipe in compression is not held by the hole."""
THICK, HEAVIER = 0.7, 1.25
"""Inner over outer diameter up to which a pipe is a collar or heavy-weight pipe (0.35 to 0.65; drill pipe has 0.75 to
0.9), and its mass over that of drill pipe from which it is heavy."""
A_STAND = 27.0
"""Length of three joints, m: shorter heavy pipe at the table is a kelly or part of a top drive."""
STINGER = 0.5
"""Diameter of the pipe at the bit over that of the heavy pipe above, below which neither order drills: no drill pipe
carries collars more than twice as wide (9 1/2 in below 5 in)."""
A_COLLAR = 1.15
"""Diameter of a collar over that of drill pipe, at least; heavy-weight pipe is about as wide as the pipe."""
HORIZONTAL = np.radians(75.0)
"""Inclination at the end of a hole above which heavy pipe stands higher up on purpose."""
MORE_THAN_THE_STRING = "is more than the string weighs along the hole"
OF_THE_BOTTOM = ("weight", "torque", "penetration", "cutting", "rock", "slip_speed")
"""Keys of a bit that count on bottom only."""


UNRUBBED = 0.01
"""Share of the side force by weight from which it is told that the first half element has none."""


def too_heavy(scene: DrillstringScene) -> str:
    """What is said of a weight on bit that is more than the string's; empty where it is not."""
    told = dict(_weight_on_bit(scene, prepared(scene))).get("bit.weight", "")
    return told if MORE_THAN_THE_STRING in told else ""


def warnings(scene: DrillstringScene) -> list[SceneWarning]:
    """Warnings of a scene, each with its cause and a cure; raises SceneError where well and string do not fit."""
    ready = prepared(scene)
    return [
        SceneWarning(place, text, of_a_run=check in OF_A_RUN) for check in CHECKS for place, text in check(scene, ready)
    ]


# steps and frames
def _steps(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Steps that are too long for the contact, the frames or the string's own vibration."""
    solver, lumps = scene.solver, ready.lumps
    if solver.explicit:
        critical, taken = critical_step(scene, lumps), step_taken(solver, scene.output.interval)
        if taken > critical:
            text = (
                f"{taken:g} s is longer than RK4's critical step of about {critical:.3g} s (stiffest link or wall "
                "contact, eqs 2.142 and 2.170): the run will become unstable; take a smaller step, or method: "
                "generalized-alpha"
            )
            yield "solver.step", text
    step = longest_step(solver, 0.0)
    ratio = scene.output.interval / step if step > 0.0 else 1.0
    if abs(ratio - round(ratio)) > 1e-6:
        steps = int(np.ceil(ratio))
        text = (
            f"{scene.output.interval:g} s is not a whole number of steps of {step:g} s: the step taken is "
            f"{scene.output.interval / steps:.6g} s"
        )
        yield "output.interval", text
    sound = min(sqrt(tube.youngs_modulus / tube.density) for tube in lumps.tubes)
    period = 4.0 * lumps.total / sound
    if not solver.explicit and step > LONG_FOR_MOTION * period:
        text = (
            f"{step:g} s is long against the string's first axial period of about {period:.2g} s: its motion is damped "
            f"by the algorithm; take {0.01 * period:.1g} s or less"
        )
        yield "solver.step", text


def critical_step(scene: DrillstringScene, lumps: Lumps) -> float:
    """Critical step of RK4, s, about: of the fastest link along the string, or of the stiffest wall contact across it.

    Either by itself. A rock that springs back, and damping, may make it a few per cent shorter.
    """
    # Only `check`, and a run that is explicit, ask for it: no other loads what varies a scene for a study.
    from drillstring.model.variations import bars

    fastest = max(bar.fastest for bar in bars(scene))
    return RK4.reach_of_vibration / max(fastest, _fastest_contact(scene, lumps))


def _fastest_contact(scene: DrillstringScene, lumps: Lumps) -> float:
    """Largest frequency of a contact with the wall, rad/s, eq. 2.170, the mud that moves along counted; 0 if none."""
    wall = scene.well.wall
    if wall is None:
        return 0.0
    if scene.model.kind == BEAM:
        from drillstring.groups.beam_points import points_of
        from drillstring.model.beam_frequency import contact_frequency

        return contact_frequency(points_of(lumps), wall, fluid_of(scene.mud), scene.well.diameter)
    mass = lumps.of_lumps(lambda tube: tube.mass_per_length)
    mass = mass + lateral_mass(lumps, fluid_of(scene.mud), scene.well.diameter)
    od = lumps.largest(lambda tube: tube.od)
    stiffness = wall.stiffness * od / od.max() * lumps.tributary / (lumps.total / wall.lumps)
    return float(np.sqrt((stiffness / mass)[1:].max()))


# pipe
def _upside_down(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Collars or heavy-weight pipe at the rotary table and drill pipe at the bit: a list that goes from the bit up.

    Drill pipe has a thin wall, the others a thick one, so that tapered strings do not count, and no heavier pipe in the
    middle of a string. In a horizontal hole heavy pipe is put above light pipe on purpose, to push it. Nor is a string
    asked about that carries a casing, or ends in a stinger: wider than its heavy pipe, or much narrower, or shorter.
    """
    tubes, count, end = ready.lumps.tubes, *_ends_of_light_pipe(ready.lumps)
    heavy, light, motor = tubes[:count], tubes[count:end], tubes[end:]
    if not heavy or not light or scene.well.diameter < DRILLED:
        return
    length, last, widest = sum(tube.length for tube in heavy), light[-1], max(tube.od for tube in heavy)
    if length < A_STAND or min(tube.mass_per_length for tube in heavy) < HEAVIER * last.mass_per_length:
        return
    if not STINGER * heavy[-1].od <= last.od <= widest or length > sum(tube.length for tube in light):
        return
    # Below drill pipe a motor alone may hang; collars at the table then are a slip, but heavy-weight pipe need not be.
    if motor and (sum(tube.length for tube in motor) >= A_STAND or widest < A_COLLAR * last.od):
        return
    if float(ready.well.inclination(np.array([ready.well.length]))[0]) > HORIZONTAL:
        return
    below = f"{last.name} has only {motor[0].name} below it" if motor else f"{last.name} at the bit"
    text = (
        f"sections go from the rotary table down. This string has its heavy pipe at the top: {tubes[0].name} stands at "
        f"the table, and {below}. Was the list written from the bit up? Then reverse it"
    )
    yield "string", text


def _ends_of_light_pipe(lumps: Lumps) -> tuple[int, int]:
    """First section with a thin wall, and the one behind the last; both 0 where one with a thick wall is between."""
    thick = [tube.id <= THICK * tube.od for tube in lumps.tubes]
    if all(thick):
        return 0, 0
    begin, end = thick.index(False), len(thick) - thick[::-1].index(False)
    return (0, 0) if any(thick[begin:end]) else (begin, end)


def _floating(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Sections that float, and are held down by the others."""
    for i, tube in enumerate(ready.lumps.tubes):
        mass = buoyed_mass(scene, tube)
        if mass <= 0.0:
            cause = f"{tube.name} floats: with what is inside it is {-mass:.3g} kg/m lighter than the mud it displaces"
            yield f"string[{i}]", f"{cause}; {CURE}, if that is not meant"


def _yielding(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Sections whose tension at rest is more than `LARGEST_SHARE` of their yield load."""
    tension, place = largest_at_rest(scene, ready.well, ready.lumps)
    for i, section in enumerate(scene.string):
        if section.yield_load is None or float(tension[i]) <= LARGEST_SHARE * section.yield_load:
            continue
        share = float(tension[i]) / section.yield_load
        load, most = (shown(force, "N", scene.units) for force in (float(tension[i]), section.yield_load))
        where = shown(float(place[i]), "m", scene.units)
        text = (
            f"{section.name} carries {load} at rest at {where}, {100.0 * share:.0f} % of its yield load of {most}; "
            "take a higher grade, a heavier pipe, or a lighter string below it"
        )
        yield f"string[{i}].yield_load", text


# wall
def soft_wall(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A wall into which the string at rest sinks by its weight, and by its tension in bends: often a slip of a unit.

    No stiffness is implausible by itself: a rod of the laboratory lies in a soft tube. Weight across the hole and
    tension over the hole's radius press a metre of string on the wall. Both grow with the length of a lump, as the
    stiffness of its contact does (`drillstring.scene.hole.Wall`), so that the mesh does not count.
    """
    wall, well, lumps = scene.well.wall, ready.well, ready.lumps
    if wall is None:
        return
    places = lumps.measured_depth[1:] - 0.5 * lumps.length
    tubes = [lumps.tubes[k] for k in lumps.section]
    weight = np.array([abs(weight_in(fluid_of(scene.mud), tube, scene.gravity)) for tube in tubes])
    tension = np.abs(tension_at(scene, well, lumps, places))
    side = weight * np.maximum(np.sin(well.inclination(places)), LEANING)
    side = np.maximum(side, tension * np.hypot(*well.curvature(places)))
    diameter = np.array([tube.contact_od for tube in tubes])
    # Of a metre of wall: that of a lump of `wall.lumps` in all, by the largest diameter.
    stiffness = wall.stiffness * diameter / diameter.max() / (lumps.total / wall.lumps)
    clearance = 0.5 * (scene.well.diameter - diameter)
    room = np.maximum(clearance, SNUG * scene.well.diameter)
    depth = side / stiffness
    worst = int(np.argmax(depth / room))
    if depth[worst] <= DEEP * room[worst]:
        return
    enough = wall.stiffness * float(depth[worst] / room[worst]) / DEEP
    far, gap, place = (shown(float(x), "m", scene.units) for x in (depth[worst], clearance[worst], places[worst]))
    text = (
        f"{shown(wall.stiffness, 'N/m', scene.units)} is soft: weight and tension at rest press {tubes[worst].name} by "
        f"about {far} into the wall at {place}, and its clearance is {gap}. {_stiff_enough(scene, enough)}"
    )
    yield "well.wall.stiffness", text


def _stiff_enough(scene: DrillstringScene, enough: float) -> str:
    """What would be stiff enough, with the unit that was perhaps meant."""
    written = None if scene.document is None else scene.document.written("well.wall.stiffness")
    row = RANGES["contact stiffness"]
    fitting = units_that_fit(written or "", row.unit, row, scene.units, lambda value: value >= enough)
    asked = f"{as_typed(meant(written, fitting[:1], row.unit))}. Else give" if written and fitting else "Give"
    return f"{asked} {shown(enough, 'N/m', scene.units)} or more; 1.0e9 N/m is usual"


def _friction(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Slip velocities of the regularised law."""
    wall = scene.well.wall
    if wall is None or wall.friction.static <= 0.0 or wall.friction.law != "regularised":
        return
    slow = wall.friction.slip_velocity
    if not scene.solver.explicit and slow < SLIP_FOR_NEWTON:
        text = (
            f"regularised friction with slip_velocity {slow:g} m/s is hard on an implicit method: steps are halved and "
            "may fail; use law: projection, which is exact"
        )
        yield "well.wall.friction.law", text
    if slow > SLIP_FOR_CREEP:
        text = f"{slow:g} m/s: a stuck string creeps at up to that speed; use law: projection"
        yield "well.wall.friction.slip_velocity", text


def _shoe(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A casing that is longer than the hole."""
    casing = None if scene.well.wall is None else scene.well.wall.casing
    if casing is not None and casing.shoe > ready.well.length:
        # Rounded to metres, and put into feet after that, it would be another depth.
        shoe, end = (shown(depth, "m", scene.units) for depth in (casing.shoe, ready.well.length))
        cause = f"{shoe} is below the end of the hole at {end}: all of it is taken as cased"
        yield "well.wall.casing.shoe", f"{cause}; give the measured depth of the shoe"


def _past_the_shoe(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A string that moves past the shoe of its casing."""
    if scene.well.wall is None or scene.well.wall.casing is None:
        return
    highest, lowest = _reach_of_block(scene)
    moved, longest = lowest - highest, float(ready.lumps.length.max())
    if moved > longest:
        cause = f"the block moves {moved:.3g} m, more than a link of {longest:.3g} m: lumps"
        text = (
            f"{cause} keep the friction of where they start when they pass the shoe; torque-drag at several depths has "
            "it right"
        )
        yield "well.wall.casing", text


# block
def _reach_of_block(scene: DrillstringScene) -> tuple[float, float]:
    """Highest and lowest position of the block, m down from the table."""
    end = scene.solver.end
    functions = compile_functions([FunctionRequest(scene.top.block, end=end, key="top.block")])
    positions = sample(functions, 0, np.linspace(0.0, end, 2001))[:, 0]
    return float(positions.min()), float(positions.max())


def _block(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A block that takes the string out of the hole as it was drilled, at either end."""
    (highest, lowest), total = _reach_of_block(scene), ready.lumps.total
    past = lowest + total - ready.well.length
    if past > PAST_THE_END and not scene.bit.on_bottom:
        text = (
            f"lowers the bit {past:.3g} m past the end of the hole, where the hole is taken to go on with its last "
            "curvature; deepen the well, or shorten the string"
        )
        yield "top.block", text
    height, all_of_it = (shown(length, "m", scene.units) for length in (-highest, total))
    if -highest > total:
        cause = f"lifts the top of the string {height} above the table, and all of it is {all_of_it}"
        yield "top.block", f"{cause}: the string leaves the hole; give a shorter stroke"
    elif -highest > STAND:
        cause = f"lifts the top of the string {height} above the table, which few derricks can"
        cure = "the pipe stands there in one piece, straight on from the hole: trip stand by stand, a run for each"
        yield "top.block", f"{cause}: {cure}, or ask torque-drag for many depths"


# bit
def _off_bottom(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Keys of a bit on bottom, of one that hangs."""
    if scene.bit.on_bottom:
        return
    fields = type(scene.bit).model_fields
    given = [f"bit.{key}" for key in OF_THE_BOTTOM if getattr(scene.bit, key) not in (None, fields[key].default)]
    if given:
        further = f"{'have' if len(given) > 2 else 'has'} {', '.join(given[1:])}"
        more = f", and neither {further}" if len(given) > 1 else ""
        cure = "write on_bottom: true, or remove " + ("them" if more else "it")
        yield given[0], f"has no effect while bit.on_bottom is false{more}; {cure}"


def _weight_on_bit(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """More weight on bit than the string has, or than its collars have in an upright hole."""
    if not scene.bit.on_bottom:
        return
    lumps = ready.lumps
    tension = np.append(tension_at_rest(scene, ready.well, lumps), scene.bit.load)
    weight, hook = (shown(force, "N", scene.units) for force in (scene.bit.weight or 0.0, float(tension[0])))
    if tension[0] < 0.0:
        # No refusal: rigs with pull-down push strings so, and the model computes what they do.
        cannot = scene.top.weight + tension[0] < 0.0
        how = "and a hoist cannot push" if cannot else "which the top drive's weight gives"
        cause = f"{weight} {MORE_THAN_THE_STRING}: the hook load is {hook} at rest, {how}"
        yield "bit.weight", f"{cause}; take less, or a heavier string, unless the rig has a pull-down"
        return
    end = lumps.tubes[0].length
    upright = float(ready.well.inclination(np.array([end]))[0]) < UPRIGHT
    if len(lumps.tubes) > 1 and tension[1] < 0.0 and upright:
        name, pressed = lumps.tubes[0].name, shown(-float(tension[1]), "N", scene.units)
        text = (
            f"{weight} puts the lower end of {name} under {pressed} of compression in an upright hole: it may buckle; "
            "take less, or more collars"
        )
        yield "bit.weight", text


def _relaxed(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A start at rest with friction, of a string whose top is in motion then."""
    wall = scene.well.wall
    if scene.start != "relaxed" or wall is None or wall.friction.static <= 0.0:
        return
    functions = compile_functions(requests(scene))
    moving = {"turns": ROTATION, "moves": BLOCK}
    how = [word for word, one in moving.items() if value_at(functions, one, 0.0)[1] != 0.0]
    if how:
        text = (
            f"relaxed is a state of a string at rest, held by friction, and its top {' and '.join(how)} at t = 0: hook "
            "load and torque of the first seconds are those of a state that is over at once. Let the motion begin with "
            "a ramp, or write start: static"
        )
        yield "start", text


def _torque_on_bit(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A bit that is turned and has no law of torque."""
    if not scene.bit.on_bottom or scene.bit.torque is not None or scene.bit.cutting is not None:
        return
    if turns(scene):
        cause = "is not given: the rock is taken to resist the turning bit with no torque at all, whatever its weight"
        cure = "give bit.torque, such as {static: 8 kN m, kinetic: 4 kN m}, or bit.cutting"
        yield "bit.torque", f"{cause}; {cure}"


def _weak_drive(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A drive whose torque limit is less than its bit needs, to turn on or to begin to turn; the wall takes more.

    Each way in which the string is turned is judged by the torque of its own.
    """
    drive = scene.top.rotation
    if not scene.bit.on_bottom or not isinstance(drive, Controller) or drive.torque_limit is None:
        return
    speeds = speeds_of(scene, ROTATION)
    fastest_each = max(0.0, float(speeds.max())), min(0.0, float(speeds.min()))
    ways = [spin for spin in fastest_each if spin != 0.0]
    weight = scene.bit.weight or 0.0
    b = bit_row(scene.bit, scene.well.diameter, ready.lumps.tubes, 0.0, False)[0]
    limit, on = shown(drive.torque_limit, "N m", scene.units), shown(weight, "N", scene.units)
    stalls, may = dict[str, list[str]](), []
    for spin in ways:
        turning, resting = torque_at(b, weight, spin), torque_at_rest(b, weight, spin)
        needed, held = (shown(torque, "N m", scene.units) for torque in (turning, resting))
        which = "" if len(ways) == 1 else " forward" if spin > 0.0 else " backward"
        if drive.torque_limit < turning:
            fastest = f"{quantity(spin / RPM, 'rpm')}, the fastest of the run{which}"
            stalls.setdefault(f"the {needed} that the bit takes with {on} on it", []).append(fastest)
        elif drive.torque_limit < resting:
            may.append(f"the {held} that hold a bit at rest with {on} on it: the drive may stall there")
    # A bit that takes as much backward as forward is told of once.
    told = [f"{taken} at {', and at '.join(ways)}: the drive stalls" for taken, ways in stalls.items()]
    for text in dict.fromkeys(told or may):
        yield "top.rotation.controller.torque_limit", f"{limit} is less than {text}. Give more torque or less weight"


def _sticking(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A method that cannot damp the shock of a bit that sticks."""
    if not scene.bit.on_bottom:
        return
    method = method_of(scene.solver.method)
    sticks = scene.bit.torque is not None or scene.bit.cutting is not None
    if sticks and keeps_all(scene):
        text = (
            "does not damp what a step cannot follow: after the shock of a bit that sticks its torque oscillates, and "
            "the bit is released too early; take generalized-alpha with rho_inf 0.9 or less"
        )
        yield ("solver.rho_inf" if method.has_alphas else "solver.method"), text


def _chatter(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A step that is too long for a bit: explicit for its torque at rest, or for what its blades make it do."""
    step = step_taken(scene.solver, scene.output.interval)
    for text in rest_told(scene, ready.lumps, step):
        yield "bit.slip_speed", text
    for text in blades_told(scene, ready.lumps, step):
        yield "solver.step", text
    yield from slowed_told(scene, ready.lumps)


# buckling
def _buckling(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A string that buckles, in a run that cannot show it."""
    if text := told_at_rest(scene, ready.well, ready.lumps):
        yield "bit.weight" if scene.bit.on_bottom and scene.bit.weight else "bit.force", text


def _led_to(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """What is wrong with the largest weight on bit that the block's way makes, by the rules for `bit.weight`."""
    if not scene.bit.on_bottom or not is_of_the_scene(scene):
        return
    run = weight_of_run(scene, ready.lumps.tubes)
    peak = int(run.weight.argmax())
    weight = float(run.weight[peak])
    if weight <= (1.0 + OFF) * (scene.bit.weight or 0.0):
        return
    later = scene.model_copy(update={"bit": scene.bit.model_copy(update={"weight": weight})})
    told = shown(weight, "N", scene.units)
    for check in (_weight_on_bit, _buckling):
        if any(check(scene, ready)):
            continue
        for _, text in check(later, ready):
            cause = f"leads to a weight on bit of {told} at t = {run.time[peak]:.4g} s"
            yield "top.block", f"{cause}. It {text.removeprefix(f'{told} ')}"


# mesh
def _mesh(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Elements that are too long for the hole, or for the string."""
    if text := too_long(scene, ready):
        yield ELEMENTS, text


def _first_half(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A hole that is inclined at the table: the half element that hangs in the top drive there does not rub."""
    if scene.model.kind == BEAM or scene.well.wall is None or not scene.well.wall.friction.kinetic:
        return
    lumps = ready.lumps
    across = np.abs(lumps.of_lumps(lambda tube: buoyed_mass(scene, tube)))
    across *= np.sin(ready.well.inclination(lumps.measured_depth))
    share = float(across[0] / across.sum()) if across.sum() > 0.0 else 0.0
    if share <= UNRUBBED:
        return
    count = ceil(lumps.length.size * share / UNRUBBED)
    text = (
        "the hole is inclined at the rotary table. The first half element of the string hangs in the top drive and has "
        f"no contact with the wall. It has {100.0 * share:.2g} % of the side force by weight: torque and drag of a run "
        f"lack as much. With {count} elements it is {100.0 * UNRUBBED:g} %"
    )
    yield ELEMENTS, text


CHECKS: tuple[Check, ...] = (
    _steps, *OF_THE_HOLE, _upside_down, _floating, soft_wall, _friction, _block, _shoe,
    _past_the_shoe, _yielding, _relaxed, _off_bottom, _weight_on_bit, _torque_on_bit, _weak_drive, penetration,
    _sticking, _chatter, _buckling, _led_to, _mesh, _first_half,
)  # fmt: skip
"""What is looked at, in the order in which it is reported."""
OF_A_RUN = frozenset(
    {
        _relaxed,
        _steps,
        _friction,
        _block,
        _past_the_shoe,
        _torque_on_bit,
        _weak_drive,
        penetration,
        _sticking,
        _chatter,
        _buckling,
        _led_to,
        _first_half,
    }
)
"""Those of what the run of a scene does or does not show: its steps, its motions, and how the bit answers them."""


def figures(scene: DrillstringScene) -> dict[str, Any]:
    """Figures of well and string for ``check --json``, SI."""
    ready = prepared(scene)
    well, lumps = ready.well, ready.lumps
    end = well.position(np.array([well.length]))[0]
    stations = np.linspace(0.0, well.length, 2001)
    severity, begin, end_of_arc = sharpest(well)
    weight = buoyed_weight(scene, lumps.tubes)
    return {
        "well": {
            "length": well.length,
            **{name: unrounded(float(x), well.length) for name, x in zip(("north", "east"), end[:2], strict=True)},
            "vertical_depth": unrounded(float(end[2]), well.length),
            "largest_inclination": float(well.inclination(stations).max()),
            "largest_curvature": severity,
            "largest_curvature_depth": [begin, end_of_arc],
        },
        "string": {
            "length": lumps.total,
            "elements": int(lumps.length.size),
            "mass": float(lumps.of_lumps(lambda tube: tube.mass_per_length).sum()),
            "displacement": float(lumps.of_lumps(lambda tube: pi / 4.0 * (tube.od**2 - tube.id**2)).sum()),
            "buoyed_weight": weight,
            "hook_load_at_rest": unrounded(float(tension_at_rest(scene, well, lumps)[0]), abs(weight)),
        },
        "mud": None if scene.mud is None else scene.mud.density,
        "critical_step_rk4": critical_step(scene, lumps),
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
        (
            "weight of the string in mud" if figures["mud"] is not None else "weight of the string",
            string["buoyed_weight"],
            "N",
        ),
        ("hook load at rest, without friction", string["hook_load_at_rest"], "N"),
        ("elements", string["elements"], ""),
        ("critical step of RK4, about", figures["critical_step_rk4"], "s"),
    ]
    system = figures["printed_in"]
    told = [(text, shown(value, unit, system)) for text, value, unit in rows]
    told.insert(3, ("largest dogleg severity", _sharpest_told(well, system)))
    if figures["mud"] is None:
        told.append(("mud", "none: the string hangs in air"))
    return told


def _sharpest_told(well: dict[str, Any], system: str) -> str:
    """``3 deg/30 m at 600 to 1500 m``; nothing but the figure of a straight hole."""
    severity = dogleg_severity(well["largest_curvature"], system)
    begin, end = (shown(depth, "m", system) for depth in well["largest_curvature_depth"])
    return f"{severity} from {begin} to {end}" if well["largest_curvature"] > 0.0 else severity
