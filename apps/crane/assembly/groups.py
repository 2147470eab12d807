"""The groups of a scene: spans, contacts, drums, bodies, rims, springs, rope on drums."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from crane.assembly.drum_supply import capacity_of, hoisted_spans, reeled_of
from crane.assembly.friction import contacts_of, couplings_of
from crane.assembly.layout import AXES, Layout, has_rim
from crane.assembly.loads import displacement_of
from crane.assembly.mesh_damping import damping_of
from crane.geometry.line import POINT
from crane.geometry.quaternion import QUATERNION
from crane.groups.arcs import Arcs, new_arcs
from crane.groups.bends import Bends, new_bends, stencils
from crane.groups.capstan_friction import SLIP, Slips
from crane.groups.current import Current, new_current, no_current
from crane.groups.hydrodynamics import NARROWEST, WET, Wet, new_wet
from crane.groups.immersion import IMMERSED, Immersed, new_scratch
from crane.groups.masses import BODY, Bodies, Releases, Rims, Springs
from crane.groups.rigid import FREQUENCY, RIGID, Rigids, new_rigids
from crane.groups.sockets import SOCKET, Sockets, new_sockets
from crane.groups.span import BETWEEN, MATERIAL, SPAN, Spans, new_spans
from crane.groups.waves import new_sea
from crane.groups.winch import DRUM, WOUND, Drums, Supplies, WoundRope
from crane.scene.bodies import Drag
from crane.scene.scene import Body, CraneScene, Drum, End, Sheave
from crane.sea.waves import waves_of
from tautline.kernels.time_function import TimeFunctions
from tautline.scene.functions import Constant
from tautline.system.records import records_of
from tautline.system.time_functions import FunctionRequest, Steering

SMOOTHING = 0.01
"""Curvature below which the damping of bending fades, over that of an element bent to its own length."""
STIFFER = 10.0
"""Stiffness of a socket over that of a metre of the rope, 1/m: the least."""
THAN_ITS_ROPE = 100.0
"""Stiffness of a socket over that of the rope beside it where that is short: a snap is then at most 0.5 % too soft."""
STIFFEST = 1000.0
"""The most, 1/m: rope that is hoisted to nothing asks for no end of it."""
Maker = Callable[[TimeFunctions], Any]


def groups_of(layout: Layout) -> tuple[list[Maker], list[np.ndarray]]:
    """Makers of all groups, which are given the scene's functions of time; and what contacts couple.

    Those that say what spans of rope find come after them: they stand in the order in which a residual is summed.
    """
    spans = _spans(layout)
    contacts = contacts_of(layout)
    made: list[Maker] = [lambda functions: spans]
    wet = _wet(layout, spans)
    if wet is not None:
        made.append(partial(_constant, wet))
    if contacts:
        made.append(partial(_slips, contacts, spans))
    made += [make for make in (_wound(layout, spans), _drums(layout, spans)) if make is not None]
    made += _bodies(layout)
    for group in (
        _rims(layout), _springs(layout), _supplies(layout, spans), _rigids(layout), _sockets(layout)
    ):  # fmt: skip
        if group is not None:
            made.append(partial(_constant, group))
    couplings = [*couplings_of(contacts, spans), *_couplings(layout)]
    if layout.scene.rope.bending_stiffness > 0.0:
        bends, arcs = _bending(layout, spans)
        made += [partial(_constant, bends), partial(_constant, arcs)]
        couplings.append(stencils(bends))
    return made, couplings


def _constant(group: Any, functions: TimeFunctions) -> Any:
    return group


def _bending(layout: Layout, spans: Spans) -> tuple[Bends, Arcs]:
    """Bending stiffness of the rope at its nodes, and on the wheels that it is laid about."""
    rope, path = layout.scene.rope, layout.scene.path
    longest = max(float(chord) / count for chord, count in zip(layout.path.chords, layout.scene.elements, strict=True))
    # What a mesh needs is damping of stretching: bending is damped where the scene asks for it.
    damping = rope.damping or 0.0
    smoothing = SMOOTHING / longest if damping > 0.0 else 0.0
    stored = isinstance(path[0], Drum), isinstance(path[-1], Drum)
    first, last = (float(layout.degrees.value[layout.material(i)]) for i in (0, len(path) - 1))
    return (
        new_bends(spans.rows, spans.wheels, rope.bending_stiffness, damping, smoothing, spans.turned),
        new_arcs(spans.rows, spans.wheels, rope.bending_stiffness, stored, spans.turned, (first, last)),
    )


def _spans(layout: Layout) -> Spans:
    rope = layout.scene.rope
    rows = np.zeros(len(layout.station) - 1, SPAN)
    rows["a"], rows["b"] = layout.station[:-1], layout.station[1:]
    rows["wheel1"] = rows["wheel2"] = POINT
    rows["stiffness"], rows["mass"], rows["slack"] = (
        rope.axial_stiffness,
        rope.mass_per_length,
        rope.compression == "none",
    )
    rows["load"] = rope.mass_per_length * np.array(layout.scene.gravity, dtype=float)
    on = _on_wheels(layout)
    rows["engineering"] = rope.strain == "engineering"
    path = layout.scene.path
    rows["keeps1"][0], rows["keeps2"][-1] = isinstance(path[0], Drum), isinstance(path[-1], Drum)
    for i, ((first, last), damping) in enumerate(zip(layout.spans, damping_of(layout.scene, layout.path), strict=True)):
        rows["damping"][first:last] = damping
        rows["wheel1"][first], rows["wheel2"][last - 1] = on[i], on[i + 1]
    spans = new_spans(rows.view(np.recarray), layout.wheels, _between(layout))
    spans.laid[:] = layout.degrees.value[np.array(layout.station) + MATERIAL]
    return spans


def _on_wheels(layout: Layout) -> list[int]:
    """Number of each item that is a wheel; POINT of the others."""
    return [i if radius != 0.0 else POINT for i, radius in enumerate(layout.wheels["radius"].tolist())]


def _between(layout: Layout) -> np.recarray:
    """Items that a sheave or a drum can meet, two by two."""
    on = _on_wheels(layout)
    rows = [
        {"a": layout.station[first], "b": layout.station[last], "wheel1": on[i], "wheel2": on[i + 1]}
        for i, (first, last) in enumerate(layout.spans)
    ]
    return records_of(BETWEEN, [row for row in rows if (row["wheel1"], row["wheel2"]) != (POINT, POINT)])


def _slips(contacts: list[dict[str, Any]], spans: Spans, functions: TimeFunctions) -> Slips:
    n = len(contacts)
    ends = np.ascontiguousarray(np.column_stack((spans.rows["a"], spans.rows["b"])))
    none = {"by_s": 0.0, "by_p": 0.0}
    rows = records_of(SLIP, [none | row for row in contacts])
    return Slips(
        rows=rows,
        found=spans.found,
        direction=spans.start,
        ends=ends,
        force=np.zeros(n),
        travel=np.zeros(n),
        now=np.zeros(n),
        power=np.zeros(n),
        slips=np.zeros(n, np.int64),
        acts=np.zeros(1),
        fresh=np.ones(1),
        by_p=rows["by_p"].copy(),
        follows=np.zeros(2),
        predicted=np.zeros((n, 2)),
        slid=np.zeros(n, np.int64),
        held=np.zeros(1, np.int64),
        functions=functions,
    )


def _at_drum(layout: Layout, spans: Spans, i: int) -> dict[str, Any]:
    """Where the rope comes onto a drum, and what it weighs."""
    return {
        "p": layout.material(i),
        "sign": 1.0 if i == 0 else -1.0,
        "rope": layout.scene.rope.mass_per_length,
        "begin": layout.degrees.value[layout.supply.get(i, layout.material(i))],
        "span": 0 if i == 0 else len(spans.rows) - 1,
    }


def _wound(layout: Layout, spans: Spans) -> Maker | None:
    """Rope on all drums."""
    rows = [_at_drum(layout, spans, i) for i, item in enumerate(layout.scene.path) if isinstance(item, Drum)]
    if not rows:
        return None
    n, gravity = len(rows), np.array(layout.scene.gravity, dtype=float)
    water, rope, wet = layout.scene.water, layout.scene.rope, np.array([0.0, 0.0, 1.0])
    if water is not None and rope.diameter is not None:
        lift = 0.25 * np.pi * rope.diameter**2 * water.density * float(np.linalg.norm(gravity))
        wet[:] = water.surface, lift, 0.5 * max(rope.diameter, NARROWEST)
    group = WoundRope(records_of(WOUND, rows), gravity, spans.found, np.zeros(n), np.zeros((n, 2)), wet)
    return partial(_constant, group)


def _drums(layout: Layout, spans: Spans) -> Maker | None:
    """Drums that are driven by torque or hold a tension."""
    rows, scene = [], layout.scene
    for i, item in enumerate(scene.path):
        if not isinstance(item, Drum) or item.prescribed:
            continue
        drive = item.torque if item.drive == "torque" else item.tension
        rows.append(
            {
                **_at_drum(layout, spans, i),
                "a": spans.rows["a"][0 if i == 0 else -1],
                "b": spans.rows["b"][0 if i == 0 else -1],
                "radius": item.radius,
                "inertia": item.inertia,
                "stored": np.inf if item.rope_on_drum is None else item.rope_on_drum,
                "function": layout.requests.add(
                    FunctionRequest(drive, key=f"path[{i}].drum.{item.drive}", inputs=_of_drum(item))
                ),
                "holds": int(item.drive == "tension"),
                "proportional": item.gains.proportional if item.gains else 0.0,
                "integral": item.gains.integral if item.gains else 0.0,
                "limit": item.torque_limit or np.inf,
            }
        )
    if not rows:
        return None
    n = len(rows)
    return lambda functions: Drums(
        records_of(DRUM, rows), spans.found, spans.start, np.zeros(n), np.zeros(n), functions
    )


def _of_drum(drum: Drum) -> tuple[Steering, ...]:
    if drum.drive == "torque":
        return (Steering(f"{drum.name}.torque", "N m", "torque of the drive"),)
    # A rope only pulls.
    return (Steering(f"{drum.name}.tension", "N", "tension that the drive holds", least=0.0),)


def _bodies(layout: Layout) -> list[Maker]:
    """Bodies, and what tells of their releases where there are any."""
    scene = layout.scene
    if not scene.bodies:
        return []
    gravity, ground = np.array(scene.gravity, dtype=float), scene.ground
    floor = np.array([ground.level, ground.stiffness, ground.damping, ground.friction] if ground else [0.0] * 4)
    rows = [_row_of(layout, k, body, _forces(layout, k, body)) for k, body in enumerate(scene.bodies)]
    released = np.array([body.release.at if body.release else np.inf for body in scene.bodies])
    releases = bool(np.isfinite(released).any())
    left = [
        row | (_left_of(layout, k, body, row["functions"]) if body.release is not None else {})
        for k, (body, row) in enumerate(zip(scene.bodies, rows, strict=True))
    ]
    mass = np.array([body.mass for body in scene.bodies], dtype=float)
    kept, gone = mass.copy(), np.zeros((len(mass), 2), np.int64)

    def bodies(functions: TimeFunctions) -> Bodies:
        made = records_of(BODY, rows)
        let_go = np.zeros((len(mass), 2))
        # Without a release nothing is ever left of a body, and both are one.
        after = records_of(BODY, left) if releases else made
        return Bodies(made, after, gravity, floor, gone, mass, kept, let_go, functions, _current(scene))

    return [
        bodies,
        *([partial(_constant, Releases(mass, kept, released))] if releases else []),
        *_immersed(layout, gone),
    ]


def _immersed(layout: Layout, gone: np.ndarray) -> list[Maker]:
    """Bodies that come into the water and out of it: those that have a height."""
    scene = layout.scene
    rows = [_wet_row(layout, k, body) for k, body in enumerate(scene.bodies) if body.height is not None]
    if not rows or scene.water is None:
        return []
    left = [row | _wet_row(layout, row["body"], scene.bodies[row["body"]].after_release()) for row in rows]
    made, after = records_of(IMMERSED, rows), records_of(IMMERSED, left)
    sea, surface = new_sea(waves_of(scene)), float(scene.water.surface)
    group = Immersed(made, after, surface, gone, np.zeros((len(rows), 2)), sea, _current(scene), *new_scratch())
    return [partial(_constant, group)]


def _wet_row(layout: Layout, k: int, body: Body) -> dict[str, Any]:
    """What water does to all of a body that has a height."""
    assert body.height is not None
    return {
        "place": layout.body[body.name],
        "body": k,
        "height": body.height,
        "bottom": body.bottom,
        "buoyancy": float(np.linalg.norm(_lift(layout, body.volume))),
        "displaced": displacement_of(layout.scene, body),
        "added": body.added_mass,
        "linear": body.drag.linear,
        "quadratic": body.drag.quadratic,
    }


def _forces(layout: Layout, k: int, body: Body) -> list[int]:
    """Numbers of the functions of time of the force on a body, or -1."""
    driven = [f"{body.name}.force[{c}]" for c in range(AXES)]
    forces = body.force or ((Constant(value=0.0),) * AXES if layout.scene.driven.intersection(driven) else ())
    functions = [-1, -1, -1]
    for c, force in enumerate(forces):
        steered = (Steering(driven[c], "N", f"force on {body.name} along {'xyz'[c]}"),)
        functions[c] = layout.requests.add(FunctionRequest(force, key=f"bodies[{k}].force[{c}]", inputs=steered))
    return functions


def _row_of(layout: Layout, k: int, body: Body, functions: list[int]) -> dict[str, Any]:
    """A body with all of its load."""
    return {
        "place": layout.body[body.name],
        "mass": body.mass,
        "remaining": body.release.remaining if body.release else body.mass,
        "released": body.release.at if body.release else np.inf,
        **_water_of(layout, body),
        "functions": functions,
        "bottom": body.bottom,
        "touches": int(layout.scene.ground is not None),
    }


def _left_of(layout: Layout, k: int, body: Body, functions: list[int]) -> dict[str, Any]:
    """What water, wind and ground find of a body after its release: what the scene says of it, and else all."""
    left = body.after_release()
    if body.release is not None and body.release.force is not None:
        functions = [
            layout.requests.add(FunctionRequest(force, key=f"bodies[{k}].release.force[{c}]"))
            for c, force in enumerate(body.release.force)
        ]
    return {
        **_water_of(layout, left),
        "functions": functions,
        "bottom": left.bottom,
    }


def _water_of(layout: Layout, body: Body) -> dict[str, Any]:
    """What water does to a body at any height; of one that has a height, `Immersed` does it."""
    if body.height is not None:
        body = body.model_copy(update={"added_mass": (0.0,) * AXES, "drag": Drag(), "volume": 0.0})
    return {
        "added": body.added_mass,
        "linear": body.drag.linear,
        "quadratic": body.drag.quadratic,
        "lift": _lift(layout, body.volume),
    }


def _lift(layout: Layout, volume: float) -> np.ndarray:
    """Buoyancy (3,) of a volume in the scene's water, N."""
    water = layout.scene.water
    return -(water.density if water else 0.0) * volume * np.array(layout.scene.gravity, dtype=float)


def _rims(layout: Layout) -> Rims | None:
    """Rims on their own travel, or on the material that does not slip on them."""
    place, mass = [], []
    for i, item in enumerate(layout.scene.path):
        if isinstance(item, Sheave) and item.inertia > 0.0:
            own = has_rim(item)
            place.append(layout.rim[i] if own else layout.material(i))
            mass.append(item.inertia / item.radius**2 * (1.0 if own else layout.stretch**2))
    return Rims(np.array(place, dtype=np.int64), np.array(mass)) if place else None


def _springs(layout: Layout) -> Springs | None:
    rows = [
        (
            layout.body[body.name] + c,
            body.spring.stiffness[c],
            body.spring.damping[c],
            (body.spring.rest or body.position)[c],
        )
        for body in layout.scene.bodies
        if body.spring is not None
        for c in range(AXES)
    ]
    if not rows:
        return None
    place, stiffness, damping, rest = zip(*rows, strict=True)
    return Springs(np.array(place, dtype=np.int64), *(np.array(x, dtype=float) for x in (stiffness, damping, rest)))


def _supplies(layout: Layout, spans: Spans) -> Supplies | None:
    rows = []
    for i, item in enumerate(layout.scene.path):
        if not isinstance(item, Drum):
            continue
        held, capacity = item.rope_on_drum, capacity_of(layout.scene, item)
        if held is None and capacity is None:
            continue
        at = _at_drum(layout, spans, i)
        sign, begin = at["sign"], at["begin"]
        least = begin - sign * (np.inf if held is None else held)
        most = begin + sign * (np.inf if capacity is None else capacity - (held or 0.0))
        rho = float(layout.wheels.radius[i]) if layout.turns_about(i) else 0.0
        rows.append((at["p"], at["span"], 0 if i == 0 else 1, least, most, sign, rho))
    if not rows:
        return None
    place, span, side, *numbers = zip(*rows, strict=True)
    p, beside, ends = (np.array(x, dtype=np.int64) for x in (place, span, side))
    least, most, signs, radii = (np.array(x, dtype=float) for x in numbers)
    return Supplies(p, least, most, signs, beside, ends, radii, np.full(len(p), np.nan), spans.found)


def _wet(layout: Layout, spans: Spans) -> Wet | None:
    """The rope in water; one without a diameter takes up no room and meets no drag."""
    water, rope = layout.scene.water, layout.scene.rope
    if water is None or rope.diameter is None:
        return None
    common = {
        "diameter": rope.diameter, "density": water.density, "drag": water.rope_drag, "added": water.added_mass
    }  # fmt: skip
    rows = [{"a": a, "b": b, **common} for a, b in pairwise(layout.station)]
    gravity = np.array(layout.scene.gravity, dtype=float)
    return new_wet(records_of(WET, rows), water.surface, gravity, spans, _current(layout.scene))


def _current(scene: CraneScene) -> Current:
    """The current of a scene, with a scratch of its own."""
    water = scene.water
    if water is None or water.current is None:
        return no_current()
    return new_current(*water.current.rows, water.surface)


def _rigids(layout: Layout) -> Rigids | None:
    scene = layout.scene
    rows = []
    for name, turn in layout.turn.items():
        body = scene.body(name)
        left = None if body.release is None else body.release.inertia
        rows.append(
            {
                "place": layout.body[name],
                "turn": turn,
                "inertia": body.inertia,
                "remaining": body.inertia if left is None else left,
                "released": body.release.at if left is not None and body.release is not None else np.inf,
                "frequency": FREQUENCY,
            }
        )
    return new_rigids(records_of(RIGID, rows)) if rows else None


def _stiffness_of_socket(layout: Layout, item: int) -> float:
    """Stiffness of a socket, N/m: it counts with the rope beside it where that is shortest, as far as it is hoisted."""
    scene, last = layout.scene, len(layout.spans) - 1
    span = min(item, last)
    hoisted = hoisted_spans(scene)
    taken = float(reeled_of(scene)[2].max()) / len(hoisted) if span in hoisted else 0.0
    shortest = max(layout.path.spans[span].length - taken, THAN_ITS_ROPE / STIFFEST)
    return max(STIFFER, THAN_ITS_ROPE / shortest) * scene.rope.axial_stiffness


def _sockets(layout: Layout) -> Sockets | None:
    rows = [
        {
            "arm": arm,
            "turn": layout.turn[_end(layout, i).body],
            "offset": _end(layout, i).offset,
            "stiffness": _stiffness_of_socket(layout, i),
            "damping": 0.0,
        }
        for i, arm in layout.arm.items()
    ]
    return new_sockets(records_of(SOCKET, rows)) if rows else None


def _couplings(layout: Layout) -> list[np.ndarray]:
    """What bodies that turn couple: their quaternions, and with them what hangs in a socket."""
    stencils = [np.arange(turn, turn + QUATERNION)[None] for turn in layout.turn.values()]
    for i, arm in layout.arm.items():
        turn = layout.turn[_end(layout, i).body]
        stencils.append(np.concatenate((arm + np.arange(AXES), turn + np.arange(QUATERNION)))[None])
    return stencils


def _end(layout: Layout, item: int) -> End:
    """The end of the rope that an item is."""
    end = layout.scene.path[item]
    assert isinstance(end, End)
    return end
