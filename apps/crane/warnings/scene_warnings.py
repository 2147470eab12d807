"""What to tell a user about a crane before it runs: large against what, and what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crane.assembly.drum_supply import Supply, capacity_of, check_drums, hoisted_spans, reeled_of, supply_of
from crane.assembly.estimates import Estimate, estimate, held_limit, rk4_limit
from crane.assembly.friction import bearing_ratio, groove_ratio, is_held, sticks_in_bearing
from crane.assembly.held_loads import CLOSED, lacks
from crane.assembly.mesh_damping import damping_of
from crane.assembly.prepared import answers_no_heave, compensation_of, heave_of, heave_point, unanswered
from crane.results.laid_by_turning import turning_foreseen, unwound
from crane.results.limits import LEAST_RATIO
from crane.results.out_of_water import at_the_surface, dry, hoisted_out
from crane.results.slack_feet import foreseen
from crane.scene.carried import idle
from crane.scene.keys import where
from crane.scene.path import DRUM_FLEET_LIMIT
from crane.scene.scene import CraneScene, Drum, Sheave
from crane.scene.strength import strain_bound
from crane.scene.surroundings import MotionFile, SeaMotion
from crane.sea.compensation import Compensation
from crane.sea.frames import MOTIONS
from crane.sea.mru import ANGLES, read_record
from crane.sea.record_doubts import doubts, doubts_of_table
from crane.sea.sea_doubts import doubts_of_depth, doubts_of_phases, doubts_of_sea, doubts_of_turns, doubts_of_waves
from crane.sea.vessel import read_response
from crane.sea.waves import waves_of
from crane.warnings.drawn_askew import drawn_askew
from crane.warnings.load_warnings import load_warnings
from crane.warnings.narrow_bights import narrow_bights
from crane.warnings.overhauling import too_light
from crane.warnings.sudden_starts import growth, start_warnings
from crane.warnings.tension_control import control_warnings
from tautline.kernels.time_function import sample
from tautline.scene.errors import SceneWarning
from tautline.scene.functions import Constant, Ramp, Spectrum, Sum, Table
from tautline.scene.solver import step_taken
from tautline.scene.unit_slips import meant, units_that_fit
from tautline.scene.values.printed import as_typed, in_percent, quantity, shown
from tautline.scene.values.ranges import RANGES, in_range, sized
from tautline.scene.vector import EARTH_GRAVITY
from tautline.system.time_functions import FunctionRequest, compile_functions

OUT_OF_IT = " with the load out of the water"
LEAST_SAFETY = 3.0
"""Breaking load over tension at rest: a rule of thumb of offshore lifting."""
LITTLE = 0.001
"""Of these below which it is told no closer."""
STEPS_PER_PERIOD = 10.0
FRAMES_PER_PERIOD = 4.0
MOMENTS = 1001
"""Times in a run at which two heaves are compared."""
OF_A_WAVE = "the time of a wave of tension along an element"
SAGGING = 0.02
"""Sag over length of a span from which it wants elements, however much it pulls."""
ENOUGH = 8
HELD_BACK = 0.01
"""Share of the run for which an actuator may be off its command without a word."""
RELATIONS = (
    ("axial_stiffness", "axial stiffness", "modulus of the rope", "EA"),
    ("breaking_load", "breaking load", "strength of the rope", "the load"),
    ("mass_per_length", "mass per length", "density of the rope", "the mass"),
)
"""Key, its row in the table of ranges, the row of it over the area, and what it is called."""

Sentences = Iterator[tuple[str, str]]


def warnings(scene: CraneScene) -> list[SceneWarning]:
    """Warnings of a scene, each with its cause and a cure; raises SceneError where it cannot be run."""
    check_drums(scene)
    found = estimate(scene)
    actuator = compensation_of(scene)
    sentences = [
        *(("path", text) for text in found.path.warnings),
        *rope_warnings(scene), *_fleet(found), *_bending(scene), *_safety(found), *_strain(found),
        *_sheaves(found), *_steps(found), *too_light(found), *_mesh(found), *foreseen(found), *turning_foreseen(found),
        *narrow_bights(found), *_undamped(scene), *_compression(scene), *_winches(found, actuator),
        *control_warnings(found), *_let_go(found), *start_warnings(found, actuator),
        *_held_back(scene, actuator), *_nothing_to_answer(scene, actuator), *_one_answer(scene, actuator),
        *dry(scene), *hoisted_out(found), *at_the_surface(found), *load_warnings(found),
        *_never(scene), *_record(scene),
        *doubts_of_motion(scene), *idle(scene), *drawn_askew(found),
    ]  # fmt: skip
    return [SceneWarning(place, text) for place, text in sentences]


def _never(scene: CraneScene) -> Sentences:
    """What is to happen at a time, and the run ends before."""
    end = float(scene.solver.end)
    late = f"the run ends at {end:.4g} s. Give an earlier time, or a later solver.end"
    for k, body in enumerate(scene.bodies):
        if body.release is not None and body.release.at >= end:
            yield f"bodies[{k}].release.at", f"{body.release.at:.4g} s: the load never drops, because {late}"
    for drum in scene.drums:
        until = None if drum.brake is None else drum.brake.until
        if until is not None and until >= end:
            yield where(scene, drum, "brake.until"), f"{until:.4g} s: the brake never opens, because {late}"
    for key, function in driven_functions(scene):
        for ramp in _ramps_of(function):
            if ramp.at >= end:
                yield key, f"a ramp at {ramp.at:.4g} s never begins, because {late}"


def doubts_of_motion(scene: CraneScene) -> Sentences:
    """Seas that no waves make, and responses whose phases can be read in two ways: key and text of each."""
    motion: Any = scene.vessel.motion if scene.vessel is not None else None
    gravity = math.hypot(*scene.gravity) or EARTH_GRAVITY
    if isinstance(motion, SeaMotion):
        seas = {"vessel.motion.sea": motion.sea}
        response = read_response(scene.folder / motion.rao, motion.direction)
        yield from (("vessel.motion.rao", text) for text in doubts_of_phases(response, motion.direction))
    else:
        each = {f"vessel.motion.{name}.spectrum": getattr(motion, name, None) for name in MOTIONS}
        seas = {key: one for key, one in each.items() if isinstance(one, Spectrum)}
    for key, sea in seas.items():
        yield from ((f"{key}.{name}", text) for name, text in doubts_of_sea(sea, gravity))
        if (moved := key.split(".")[2]) in ANGLES:
            yield from ((f"{key}.{name}", text) for name, text in doubts_of_turns(sea, moved))
    yield from _doubts_of_waves(scene)


def _doubts_of_waves(scene: CraneScene) -> Sentences:
    """Waves on the loads that break, that begin at once, or that are of another sea than the vessel's motion."""
    waves, key = waves_of(scene), "water.waves.elevation"
    if waves is None or scene.water is None or scene.water.waves is None:
        return
    if scene.water.waves.elevation == "vessel":
        assert scene.vessel is not None and scene.vessel.sea is not None
        yield from ((key, text) for text in doubts_of_depth(scene.vessel.sea.significant_height, waves.depth))
        return
    yield from ((f"{key}.{name}", text) for name, text in doubts_of_waves(scene.water.waves.elevation, waves))
    if scene.vessel is not None and scene.vessel.sea is not None:
        text = (
            "the loads are in these waves, and the vessel moves in another sea. Their phases do not fit. Write "
            "`elevation: vessel` for waves that are those of the vessel's sea"
        )
        yield key, text


def _record(scene: CraneScene) -> Sentences:
    """A record of the vessel's motion with rows that no vessel moves by."""
    motion = None if scene.vessel is None else scene.vessel.motion
    if isinstance(motion, MotionFile):
        record = read_record(scene.folder / motion.file, motion.units)
        for text in doubts(record, motion.begin, float(scene.solver.end), motion.ramp):
            yield "vessel.motion.file", text
    for name in MOTIONS:
        for table in _tables_of(getattr(motion, name, None)):
            for text in doubts_of_table(scene.folder / table.file, table, name, float(scene.solver.end)):
                yield f"vessel.motion.{name}", text


def _tables_of(function: Any) -> Iterator[Table]:
    """The tables from files that a function of time is made of."""
    if isinstance(function, Table) and function.file is not None:
        yield function
    for term in function.terms if isinstance(function, Sum) else ():
        yield from _tables_of(term)


def driven_functions(scene: CraneScene) -> Iterator[tuple[str, Any]]:
    """Keys and functions of time of winches, brakes and forces on bodies."""
    for drum in scene.drums:
        yield where(scene, drum, drum.drive), getattr(drum, drum.drive)
        if drum.brake is not None:
            yield where(scene, drum, "brake.closed"), drum.brake.closed
    for k, body in enumerate(scene.bodies):
        for c, force in enumerate(body.force or ()):
            yield f"bodies[{k}].force[{c}]", force
        for c, force in enumerate((body.release.force if body.release is not None else None) or ()):
            yield f"bodies[{k}].release.force[{c}]", force


def _ramps_of(function: Any) -> Iterator[Ramp]:
    """The ramps that a function of time is made of."""
    if isinstance(function, Ramp):
        yield function
    for term in function.terms if isinstance(function, Sum) else ():
        yield from _ramps_of(term)


def fleet_angle(found: Estimate, i: int) -> float:
    """Larger of the two angles of rope and plane at an item of the path, rad, as a size."""
    angles = found.path.fleet
    sides = ([angles[i - 1, 1]] if i > 0 else []) + ([angles[i, 0]] if i < len(angles) else [])
    return max(abs(float(angle)) for angle in sides)


def _fleet(found: Estimate) -> Sentences:
    """Rope that meets a sheave or a drum askew."""
    for i, item in enumerate(found.scene.path):
        if not isinstance(item, (Sheave, Drum)):
            continue
        limit = item.fleet_limit if isinstance(item, Sheave) else DRUM_FLEET_LIMIT
        angle = fleet_angle(found, i)
        if angle > limit:
            cure = "Turn the axis or move it into the path of the rope"
            cure += ", or raise fleet_limit" if isinstance(item, Sheave) else ""
            text = (
                f"the rope meets {item.name} at {math.degrees(angle):.3g} deg to its plane, more than "
                f"{math.degrees(limit):.3g} deg. It rubs on the flange and wears. {cure}"
            )
            yield where(found.scene, item), text


def _bending(scene: CraneScene) -> Sentences:
    """Sheaves small for their rope."""
    diameter = scene.rope.diameter
    if diameter is None or _doubted(scene, diameter):
        return
    small = [
        (2.0 * item.radius / diameter, item)
        for item in scene.path
        if isinstance(item, (Sheave, Drum)) and 2.0 * item.radius < LEAST_RATIO * diameter
    ]
    if small:
        ratio, item = min(small, key=lambda pair: pair[0])
        others = f" ({len(small) - 1} more below {LEAST_RATIO:g})" if len(small) > 1 else ""
        # Rounded down: 15.97 is not to read "16, below 16", and 0.021 is not 0.
        power = 10.0 ** max(1, 1 - math.floor(math.log10(ratio)))
        shown_ratio = f"{math.floor(power * ratio) / power:g}"
        text = (
            f"{'sheave' if isinstance(item, Sheave) else 'drum'} diameter {2.0 * item.radius:.3g} m "
            f"(2 x radius {item.radius:.3g} m) on {_thickness(diameter)} rope: D/d {shown_ratio}"
            f", below {LEAST_RATIO:g}{others}. Bending soon breaks wire rope there. Take a larger radius, or "
            "check rope.diameter"
        )
        yield where(scene, item, "radius"), text


def _safety(found: Estimate) -> Sentences:
    """Rope weak for its load."""
    breaking, tension = found.scene.rope.breaking_load, found.heaviest_tension
    if breaking is None or tension <= 0.0 or breaking >= LEAST_SAFETY * tension:
        return
    times = f"{breaking / tension:.2g}" if breaking >= LITTLE * tension else f"less than {LITTLE:g}"
    text = (
        f"{quantity(breaking, 'N', 3)} is {times} times the tension at rest, about {quantity(tension, 'N', 3)}"
        f"{OUT_OF_IT if tension > found.largest_tension else ''}. By a "
        f"rule of thumb of offshore lifting it should be {LEAST_SAFETY:g} times. Codes ask for their own factor. "
        "Take a stronger rope, more falls or less load"
    )
    yield "rope.breaking_load", text


def _strain(found: Estimate) -> Sentences:
    """Rope that its load at rest strains beyond the limit that a run is judged by."""
    tension, stiffness, bound = found.heaviest_tension, found.scene.rope.axial_stiffness, strain_bound(found.scene)
    if tension > bound * stiffness:
        text = (
            f"the tension at rest, about {quantity(tension, 'N', 3)}, is {in_percent(tension / stiffness, 3)} of EA = "
            f"{quantity(stiffness, 'N', 3)}, and the strain is about that. The limit of a run is {100.0 * bound:g} %: "
            "hoisting ropes break before that. See whether axial_stiffness and the load are what was meant"
        )
        yield "rope.axial_stiffness", text


def _sheaves(found: Estimate) -> Sentences:
    """Friction that cannot act."""
    for i, item in enumerate(found.scene.path):
        if not isinstance(item, Sheave) or item.law != "capstan" or item.locked:
            continue
        groove, bearing = groove_ratio(item, found.path, i), bearing_ratio(item, found.path, i)
        if sticks_in_bearing(item, found.path, i):
            text = (
                f"the rope slips over {item.name} and does not turn it. As drawn its groove holds up to a difference "
                f"of {in_percent(groove - 1.0, 3)} between the tensions, and its bearing up to "
                f"{in_percent(bearing - 1.0, 3)}. The bearing's friction never acts. Give more friction in the groove, "
                "less in the bearing, or law: no_slip"
            )
            yield where(found.scene, item, "bearing"), text
        elif item.inertia == 0.0 and (item.bearing is None or item.bearing.friction == 0.0):
            text = (
                f"nothing resists {item.name}: without inertia it turns with the rope. The friction of law: "
                "capstan never acts. Give inertia, a bearing, locked: true, or law: frictionless"
            )
            yield where(found.scene, item, "law"), text


def shortest(found: Estimate) -> list[float]:
    """Length of an element in every span when it is shortest, m, as far as the winches' motion is prescribed."""
    scene, path = found.scene, found.path
    reeled = float(reeled_of(scene)[2].max())
    loose = hoisted_spans(scene)
    share = reeled / max(1, len(loose))
    lengths = [span.length - (share if k in loose else 0.0) for k, span in enumerate(path.spans)]
    kept = [max(length, 1e-3 * span.length) for length, span in zip(lengths, path.spans, strict=True)]
    return [length / n for length, n in zip(kept, scene.elements, strict=True)]


def _explicit_limit(found: Estimate, lengths: list[float]) -> tuple[float, Drum | None]:
    """Longest step of RK4, s, with elements of these lengths in the spans, m; and the held drum that sets it."""
    scene = found.scene
    damping = damping_of(scene, found.path)
    limits: list[tuple[float, Drum | None]] = [
        (rk4_limit(scene, length, c), None) for length, c in zip(lengths, damping, strict=True)
    ]
    for drum in (one for one in scene.drums if is_held(one)):
        limits.append((held_limit(scene, drum, lengths[0 if drum is scene.path[0] else -1]), drum))
    return min(limits, key=lambda limit: limit[0])


def _steps(found: Estimate) -> Sentences:
    scene, frequency = found.scene, found.frequency
    solver, interval = scene.solver, scene.output.interval
    if solver.explicit:
        begin = [span.length / n for span, n in zip(found.path.spans, scene.elements, strict=True)]
        (critical, _), (later, held) = _explicit_limit(found, begin), _explicit_limit(found, shortest(found))
        falls = f", and {later:.2g} s when the spans are shortest" if later < 0.9 * critical else ""
        taken = step_taken(solver, interval)
        if solver.step == "auto" or taken > later:
            long = "" if solver.step == "auto" else f": {taken:g} s will be unstable"
            why = f"as long as {held.name} is held by its brake or friction" if held else OF_A_WAVE
            text = (
                f"rk4 takes steps of no more than about {critical:.2g} s here, {why}{falls}{long}. Steps "
                "of method: generalized-alpha are ten to a hundred times longer"
            )
            yield "solver.method" if solver.step == "auto" else "solver.step", text
    if frequency is None:
        return
    period = 1.0 / frequency
    if solver.step != "auto" and not scene.controlled and float(solver.step) * STEPS_PER_PERIOD > period:
        text = (
            f"{solver.step:g} s is long against the natural period of the load on the rope, about {period:.2g} s. "
            f"Fewer than {STEPS_PER_PERIOD:.0f} steps a period do not follow the motion. Take "
            f"{0.5 * period / STEPS_PER_PERIOD:.1g} s or less, or control: error"
        )
        yield "solver.step", text
    if interval * FRAMES_PER_PERIOD > period:
        text = (
            f"{interval:g} s keeps fewer than {FRAMES_PER_PERIOD:.0f} frames in a natural period of the load on the "
            f"rope, about {period:.2g} s. Peaks between frames are not seen. Take {period / 10.0:.1g} s or less where "
            "they matter"
        )
        yield "output.interval", text


def _mesh(found: Estimate) -> Sentences:
    """Elements too long for a heavy rope."""
    scene = found.scene
    g = np.array(scene.gravity, float)
    if found.tension is None:
        return
    for k, (span, n) in enumerate(zip(found.path.spans, scene.elements, strict=True)):
        tension = max(float(found.tension[k].max()), 1e-9 * scene.rope.axial_stiffness)
        load = scene.rope.mass_per_length * g
        across = float(np.linalg.norm(load - (load @ span.e) * span.e)) * span.length
        names = f"{scene.path[k].name} to {scene.path[k + 1].name}"
        if across / (8.0 * tension) > SAGGING and n < ENOUGH:
            sag = across * span.length / (8.0 * tension)
            text = (
                f"{n} from {names}: the rope sags by about {sag:.2g} m in {span.length:.3g} m, and is modelled as {n} "
                f"straight pieces. Take {ENOUGH} or more for that span"
            )
            yield "mesh.elements_per_span", text


def _undamped(scene: CraneScene) -> Sentences:
    """A rope that may go slack and that nothing damps: it oscillates between its nodes when it snaps."""
    rope = scene.rope
    if rope.damping == 0.0 and rope.compression == "none" and max(scene.elements) > 1:
        text = (
            "0: when slack rope snaps taut, its nodes oscillate without damping. Tensions are then up to 1.5 times too "
            "high with few elements, and the safety factor is as much too low. Remove `damping:`, for as much "
            "as the mesh needs, or give what the rope has"
        )
        yield "rope.damping", text


def _compression(scene: CraneScene) -> Sentences:
    if scene.rope.compression == "elastic":
        text = (
            "elastic: the rope carries compression as a rod does. It never goes slack, and no snap follows. Give none "
            "for a rope, unless it is known to stay taut"
        )
        yield "rope.compression", text


def _nothing_to_answer(scene: CraneScene, actuator: Compensation | None) -> Sentences:
    """A heave compensation of a point that the vessel does not carry."""
    if actuator is not None and answers_no_heave(scene):
        point = heave_point(scene)
        text = (
            f"it answers the heave of {point.name}, which rides on {scene.frame_of(point)}. That stands on the ground, "
            f"so no heave is answered and `compensator` stays 0. Put {scene.frame_of(point)} on the vessel "
            "(`parent: vessel`), or remove the compensation"
        )
        yield "heave_compensation", text


def _one_answer(scene: CraneScene, actuator: Compensation | None) -> Sentences:
    """Two drums that pay out by the heave of one tip while that of the other is another, or none."""
    for drum, point in [] if actuator is None else unanswered(scene):
        time = np.linspace(0.0, scene.solver.end, MOMENTS)
        other = Constant(value=0.0) if point is None else heave_of(scene, point)
        heaves = compile_functions([FunctionRequest(one) for one in (heave_of(scene), other)])
        answered, met = (sample(heaves, k, time)[:, 0] for k in range(2))
        off = float(np.abs(met - answered).max())
        if off > LITTLE * float(np.abs(answered).max()):
            tip = f"What {drum.name} leads over stands on the ground: its heave" if point is None else "That"
            of = "" if point is None else f" of {point.name}"
            where = "load" if scene.bodies else "rope between them"
            text = (
                f"both drums pay out by the heave of {heave_point(scene).name}. {tip}{of} differs by up to "
                f"{quantity(off, 'm', 3)}, and the rope on its side is wrong by `gain` times that. Expect it at the "
                f"{where}, or drive {'that drum' if point is not None else drum.name} by `tension`"
            )
            yield "heave_compensation", text


def _held_back(scene: CraneScene, actuator: Compensation | None) -> Sentences:
    """What keeps the actuator from its command: its limits, or a command that begins with a jump."""
    if scene.heave_compensation is None or actuator is None or actuator.away <= HELD_BACK:
        return
    off = (
        f"the actuator does not follow its command {100.0 * actuator.away:.2g} % of the time, and is up to "
        f"{actuator.error:.2g} m away from it"
    )
    limits = scene.heave_compensation.limits
    if any(limit is not None for limit in (limits.stroke, limits.speed, limits.acceleration)):
        met = {name: share for name, share in actuator.met.items() if share > 0.0}
        reached = [f"its {name} limit is reached {100.0 * share:.2g} % of the time" for name, share in met.items()]
        what = ", ".join(reached) or "it begins with a jump"
        text = f"{off}: {what}. Give it wider limits, or expect that much heave at the load"
        yield "heave_compensation.limits", text
    if actuator.sudden:
        text = (
            f"{off}. The tip heaves already at t = 0. After the delay the actuator would have to begin with a jump of "
            f"speed. {growth(scene)}. Or give no delay, or ignore the time just after t = 0"
        )
        yield "heave_compensation.delay", text


def rope_warnings(scene: CraneScene) -> Sentences:
    """Key and text of the numbers of a rope that are implausible for its diameter; none where that is not given."""
    rope = scene.rope
    if rope.diameter is None or _doubted(scene, rope.diameter):
        return
    area = 0.25 * math.pi * rope.diameter**2
    for key, name, over, what in RELATIONS:
        value, row = getattr(rope, key), RANGES[over]
        if value is None or row.holds(value / area):
            continue
        written = None if scene.document is None else scene.document.written(("rope", key))
        own = RANGES[name]
        options = units_that_fit(written or "", own.unit, own, scene.units, lambda x, row=row: row.holds(x / area))
        text = (
            f"{sized(value, own.unit)} does not go with a diameter of {_thickness(rope.diameter)}: {what} over the "
            f"area of its circle is {sized(value / area, row.unit)}, and {in_range(row)} is plausible. "
            f"{as_typed(meant(written or '', options, own.unit))}. Or see whether rope.diameter is what was meant"
        )
        yield f"rope.{key}", text


def _doubted(scene: CraneScene, diameter: float) -> bool:
    """Whether a diameter is in doubt by itself: it is told then, and what follows from it would only say it again."""
    return scene.document is not None and not RANGES["rope diameter"].holds(diameter)


def _thickness(diameter: float) -> str:
    """Diameter of a rope in mm, as ropes are ordered; one that no rope has in m."""
    return f"{1e3 * diameter:.4g} mm" if diameter < 1.0 else f"{diameter:.4g} m"


def _winches(found: Estimate, actuator: Compensation | None) -> Sentences:
    """Motion of winches that goes too far, and layers that count nothing: key and text of each.

    Parameters
    ----------
    found : Estimate
    actuator : Compensation or None
        Of the heave compensation, where there is one.
    """
    scene = found.scene
    for drum in scene.drums:
        yield from _layers(scene, drum)
        supply = supply_of(scene, drum)
        if supply is None:
            continue
        whole = _compensated(supply, actuator)
        off = unwound(found.layout, scene.path.index(drum), supply.time)
        if off is not None:
            whole = whole._replace(paid_out=whole.paid_out + off)
        yield from _empty(scene, drum, whole, off is not None)
        yield from _full(scene, drum, whole, off is not None)
    yield from _too_high(found)


def _let_go(found: Estimate) -> Sentences:
    """Brakes and motors that do not hold the load at rest."""
    for one in lacks(found.scene, found.path, found.tension):
        drum, braked = one.drum, one.brake is not None
        load, needed, friction, motor = (sized(x, "N m") for x in (one.load, one.needed, one.friction, one.motor))
        most = ", the limit of its torque," if one.limited else ""
        others = f"friction of {friction} and a motor with {motor}{most}"
        partly = braked and one.closed < CLOSED
        way = f"brake closed to {one.closed:.4g}, that is" if partly else "closed brake of"
        holds = f"A {way} {sized(one.brake or 0.0, 'N m')}, {others}" if braked else f"No brake, {others}"
        of = " of brake.torque times brake.closed" if partly else ""
        helped = ", with the friction of the sheaves on its side" if one.helped else ""
        key = "brake.torque" if braked else "torque_limit" if one.limited else drum.drive
        held = f"a tension of {sized(one.held, 'N')}" if key == "tension" else needed
        text = (
            "the drum does not hold the load, which falls from t = 0. The tension at rest, "
            f"{sized(one.tension, 'N')} on a radius of {drum.radius:.4g} m, turns the drum with {load}{helped}. "
            f"{holds} act against it. To hold the load at rest it takes {held} or more{of}; a load in motion "
            "pulls more"
        )
        yield where(found.scene, drum, key), text


def _layers(scene: CraneScene, drum: Drum) -> Sentences:
    """Layers of a drum of which nobody knows how much rope is on it."""
    if drum.layers is not None and drum.rope_on_drum is None:
        full = "" if drum.layers.count is None else ", and it is full as if it had begun empty"
        text = (
            "without rope_on_drum it is not known which layer the rope leaves from. drum_rotation and winch_torque go "
            f"by the drum's radius{full}. Give rope_on_drum, or remove layers"
        )
        yield where(scene, drum, "layers"), text


def _compensated(supply: Supply, actuator: Compensation | None) -> Supply:
    """Supply of the operator and of heave compensation together."""
    if actuator is None:
        return supply
    answered = sample(compile_functions([FunctionRequest(actuator.pay_out)]), 0, supply.time)[:, 0]
    return supply._replace(paid_out=supply.paid_out + answered)


def _empty(scene: CraneScene, drum: Drum, supply: Supply, turned: bool) -> Sentences:
    """A drum that runs out of rope; ``turned`` where something turns about it."""
    held, most = drum.rope_on_drum, float(supply.paid_out.max())
    if held is not None and most > held:
        k = int(np.argmax(supply.paid_out > held))
        way = "come off it, by turning too" if turned else "are paid out"
        cure = "turn or pay out less" if turned else "pay out less"
        text = (
            f"{held:.4g} m, and {most:.4g} m {way}. The run will stop at about t = {supply.time[k]:.3g} s, when "
            f"the drum is empty. Give more rope, or {cure}"
        )
        yield where(scene, drum, "rope_on_drum"), text


def _full(scene: CraneScene, drum: Drum, supply: Supply, turned: bool) -> Sentences:
    """A drum that heave compensation fills, or what turns about it; one that its operator fills is refused."""
    capacity, held = capacity_of(scene, drum), (drum.rope_on_drum or 0.0) - supply.paid_out
    if capacity is not None and held.max() > capacity:
        k = int(np.argmax(held > capacity))
        what = "what turning lays on" if turned else "heave compensation"
        text = (
            f"the layers hold {capacity:.4g} m, and with {what} it comes to {float(held.max()):.4g} m. The "
            f"run will stop at about t = {supply.time[k]:.3g} s, when the drum is full. Give it more turns or layers"
        )
        yield where(scene, drum, "layers"), text


def _too_high(found: Estimate) -> Sentences:
    """A load that is hoisted into what it hangs on."""
    scene = found.scene
    loose, (drums, time, taken) = hoisted_spans(scene), reeled_of(scene)
    room = sum(found.path.spans[k].length for k in loose)
    if loose and taken.max() > room:
        k, drum = int(np.argmax(taken > room)), drums[0]
        who = "reels" if len(drums) == 1 else f"{' and '.join(one.name for one in drums)} together reel"
        text = (
            f"{who} {float(taken.max()):.4g} m in, and there are {room:.4g} m between the load and what it hangs on. "
            f"The load meets the sheave at about t = {time[k]:.3g} s. Hoist less, or end earlier"
        )
        yield where(scene, drum, drum.drive), text


def figures(scene: CraneScene) -> dict[str, Any]:
    """Figures of the path of the rope for ``check --json``, m, rad and s; of fleet angles the larger of both sides."""
    found = estimate(scene)
    path, items = found.path, scene.path
    sheaves = [i for i, item in enumerate(items) if isinstance(item, Sheave)]
    return {
        "spans": [
            {"from": items[k].name, "to": items[k + 1].name, "length": float(span.length)}
            for k, span in enumerate(path.spans)
        ],
        "wraps": [{"sheave": items[i].name, "angle": float(path.wraps[i])} for i in sheaves],
        "fleet_angles": [{"sheave": items[i].name, "angle": fleet_angle(found, i)} for i in sheaves],
        "path_length": path.length,
        **({} if scene.heave_compensation is None else {"heave_of": heave_point(scene).name}),
        "damping": {"largest": max(damping_of(scene, path)), "given": scene.rope.damping is not None},
        "printed_in": scene.units,
    }


def describe(found: dict[str, Any]) -> list[tuple[str, str]]:
    """Rows of a table for people, of what `figures` found, in the units that the scene asks for."""
    system = found["printed_in"]
    rows = [(f"{span['from']} to {span['to']}", shown(span["length"], "m", system)) for span in found["spans"]]
    for wrap, fleet in zip(found["wraps"], found["fleet_angles"], strict=True):
        angles = shown(wrap["angle"], "rad", system), shown(fleet["angle"], "rad", system, digits=2)
        rows.append((f"around {wrap['sheave']}", f"{angles[0]}, fleet angle {angles[1]}"))
    rows.append(("length of the path", shown(found["path_length"], "m", system)))
    if "heave_of" in found:
        rows.append(("heave that is answered", f"that of {found['heave_of']}"))
    if not found["damping"]["given"]:
        rows.append(("damping of the rope", f"{found['damping']['largest']:.2g} s: rope.damping is not given"))
    return rows
