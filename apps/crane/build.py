"""A crane scene compiled into a model: the rope's spans, what they run over and what hangs on them."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

import numpy as np

from crane.compensation import Compensation, compensate
from crane.frames import heave_of
from crane.layout import AXES, Layout, has_rim, lay_out
from crane.line import POINT
from crane.masses import BODY, DRUM, Bodies, Drums, Rims, Springs, Supplies
from crane.observe import COORDINATE_UNITS, Observer, variables
from crane.reach import draw_true, stretch_of
from crane.scene import Anchor, CraneScene, Drum, Efficiency, End, Sheave
from crane.slip import BEARING, CAPSTAN, EFFICIENCY, NONE, SLIP, TORQUE, Slips
from crane.span import MATERIAL, SPAN, STATION, Spans, new_spans
from crane.summary import headline
from tautline.kernels.time_function import evaluate
from tautline.scene.functions import Constant, Ramp
from tautline.scene.solver import error_of_steps, longest_step
from tautline.system.model import Model, SolverSettings
from tautline.system.system import System, assemble
from tautline.system.time_functions import FunctionRequest, compile_functions

STEP_ERROR = 3.0e-5
"""Error of a step, m, where the scene gives none."""
TOLERANCE = 1.0e-8
"""Largest residual, as a share of the rope's tension, that counts as solved."""
GRAVITY = 9.81
CLOSES = 1.0e-3
"""Time that a brake takes to close or open, s."""


def build(scene: CraneScene) -> Model:
    """Compile a scene.

    Returns
    -------
    Model

    Raises
    ------
    SceneError
        For a path that no rope can take, faults of files, and more rope than a drum holds.
    """
    made = assembled(scene)
    layout, system, notes = made.layout, made.system, list(made.notes)
    observer = Observer(layout, system.groups, made.compensation)
    solver = scene.solver
    alpha_m, alpha_f = solver.alphas
    error = error_of_steps(solver, STEP_ERROR) or (STEP_ERROR if scene.controlled else 0.0)
    return Model(
        system=system,
        solver=SolverSettings(
            solver.method, longest_step(solver, scene.output.interval), solver.end, scene.output.interval,
            alpha_m, alpha_f, solver.tolerance or TOLERANCE, solver.criterion or "force", solver.max_iterations,
            solver.max_halvings, step_error=error, automatic=solver.step == "auto",
        ),
        variables=variables(observer),
        coordinates=observer.coordinates(),
        attributes={
            "scene": scene.document.text if scene.document is not None else "",
            "title": scene.title or "",
            "application": "crane",
            "physics": _physics(scene),
            "conventions": COORDINATE_UNITS,
        },
        observe=observer.observe,
        headline=lambda result: headline(result, scene),
        start="static" if scene.start == "static" else "as given",
        step_limit=0.3 * float(layout.path.chords.min()),
        own=observer.own,
        notes=notes,
        settle=lambda state: draw_true(layout, system, state),
    )  # fmt: skip


class Assembly:
    """The equations of a scene, and what was found on the way: `layout`, `system`, `compensation`, `notes`."""

    def __init__(self, layout: Layout, system: System, compensation: Compensation | None, notes: list[str]) -> None:
        self.layout, self.system, self.compensation, self.notes = layout, system, compensation, notes


def assembled(scene: CraneScene) -> Assembly:
    """Lay a scene out and write its equations; see `build`."""
    layout = lay_out(scene)
    tension = _tension(scene)
    stretch = _tie_material(layout, tension)
    compensation = _drive(layout)
    groups, pending = _groups(layout, stretch)
    functions = compile_functions(layout.requests.of)
    groups = tuple(make(functions) for make in groups)
    layout.degrees.scale[:] = max(tension, 1.0e-6 * scene.rope.axial_stiffness)
    velocity = np.zeros(len(layout.degrees.names))
    for body in scene.bodies:
        place = layout.body[body.name]
        velocity[place : place + AXES] = body.velocity
    still = [layout.material(i) for i, item in enumerate(scene.path) if isinstance(item, Drum) and not item.prescribed]
    system = assemble(
        groups, layout.degrees, functions, velocity, *_stencils(layout, pending), at_rest=[*still, *layout.rim.values()]
    )
    for k, place in enumerate(system.dofs.held):
        if system.dofs.motion[k] >= 0:
            system.q[place] = system.dofs.offset[k] + evaluate(functions, system.dofs.motion[k], 0.0)[0]
    return Assembly(layout, system, compensation, [*layout.path.warnings])


def _physics(scene: CraneScene) -> str:
    """Hash of all that a scene says but how it is solved and what is kept: a run can be gone on with if it agrees."""
    return sha256(repr(scene.model_dump(exclude={"title", "solver", "output"})).encode()).hexdigest()[:16]


def _tension(scene: CraneScene) -> float:
    """Tension that the rope may be expected to have, N: the load on its falls, and its own weight."""
    carried = {item.body for item in scene.path if isinstance(item, (End, Sheave)) and item.body is not None}
    ends = sum(
        (2 if isinstance(item, Sheave) else 1)
        for item in scene.path
        if isinstance(item, (End, Sheave)) and item.body is not None
    )
    g = float(np.linalg.norm(scene.gravity)) or GRAVITY
    weight = sum(scene.body(name).mass for name in carried) * g
    return weight / max(ends, 1) + 1.0e-9 * scene.rope.axial_stiffness


def _tie_material(layout: Layout, tension: float) -> float:
    """Lay the rope's material along its path, and tie that of nodes to the marks about them; returns the stretch."""
    scene, degrees, path = layout.scene, layout.degrees, layout.path
    stretch = stretch_of(tension, scene.rope.axial_stiffness)
    if scene.rope.length is not None:
        stretch = float(path.chords.sum()) / scene.rope.length
    elif scene.start == "as drawn":
        stretch = 1.0
    p = np.concatenate(([0.0], np.cumsum(path.chords / stretch)))
    radius = layout.wheels.radius
    for i, item in enumerate(scene.path):
        place = layout.material(i)
        degrees.value[place] = p[i]
        if isinstance(item, (End, Anchor)):
            degrees.fix(place)
    for i, (first, last) in enumerate(layout.spans):
        before, after = radius[i] * path.after[i] / stretch, radius[i + 1] * path.before[i + 1] / stretch
        one, two = layout.material(i), layout.material(i + 1)
        for k in range(first + 1, last):
            w = (k - first) / (last - first)
            place = layout.station[k] + MATERIAL
            degrees.value[place] = (1.0 - w) * (p[i] + before) + w * (p[i + 1] + after)
            degrees.tie(place, [(one, 1.0 - w), (two, w)], (1.0 - w) * before + w * after)
    return stretch


def _drive(layout: Layout) -> Compensation | None:
    """Prescribe the material at drums whose motion is prescribed; a drum's compensation comes in addition."""
    scene, degrees = layout.scene, layout.degrees
    compensation = _compensation(layout)
    for i, item in enumerate(scene.path):
        if not (isinstance(item, Drum) and item.prescribed):
            continue
        way = -1.0 if i == 0 else 1.0
        key = f"path[{i}].drum.{item.drive}"
        drive, factor = (item.pay_out, 1.0) if item.drive == "pay_out" else (item.speed, item.radius)
        request = FunctionRequest(drive, integrate=True, end=scene.solver.end, key=key, factor=way * factor)
        masters = [(_further(layout, f"{item.name}: operator", degrees.value[layout.material(i)], request), 1.0)]
        if compensation is not None:
            added = FunctionRequest(compensation.pay_out, end=scene.solver.end, key="heave_compensation", factor=way)
            masters.append((_further(layout, f"{item.name}: compensation", 0.0, added), 1.0))
        layout.supply[i] = tuple(place for place, _ in masters)
        degrees.tie(layout.material(i), masters)
    return compensation


def _further(layout: Layout, name: str, value: float, request: FunctionRequest) -> int:
    """A further degree of freedom, which follows a value and a function of time."""
    degrees = layout.degrees
    degrees.names.append(name)
    degrees.value, degrees.scale = np.append(degrees.value, value), np.append(degrees.scale, 1.0)
    place = degrees.value.size - 1
    degrees.prescribe(place, layout.requests.add(request))
    return place


def _compensation(layout: Layout) -> Compensation | None:
    """What the heave compensation does: it answers the heave of the last point of the path that rides on the vessel."""
    scene = layout.scene
    asked = scene.heave_compensation
    if asked is None or not layout.frames:
        return None
    places = {frame.name: k for k, frame in enumerate(layout.frames)}
    order = scene.path if isinstance(scene.path[0], Drum) else scene.path[::-1]
    led = [item for item in order if scene.frame_of(item) is not None]
    tip = led[-1]
    k = places[scene.frame_of(tip)]
    point = tip.position if isinstance(tip, Anchor) else tip.center
    heave = heave_of(layout.frames, places["vessel"], k, point, scene.solver.end)
    return compensate(heave, asked.gain, asked.delay, asked.limits, scene.solver.end)


def _groups(layout: Layout, stretch: float) -> tuple[list[Any], list[np.ndarray]]:
    """Makers of the groups, which the compiled functions of time are given to, and stencils of what slips."""
    scene = layout.scene
    spans = _spans(layout)
    rows, pending = _slips(layout, spans, stretch)
    bodies, ground = _bodies(layout), scene.ground
    floor = np.array([ground.level, ground.stiffness, ground.damping, ground.friction] if ground else [0.0] * 4)
    gravity = np.array(scene.gravity, dtype=float)
    ends = np.ascontiguousarray(np.column_stack((spans.rows.a, spans.rows.b)))
    made: list[Any] = [lambda functions: spans]
    if rows:
        n, slips = len(rows), _records(SLIP, rows)
        made.append(
            lambda functions: Slips(
                slips,
                spans.found,
                spans.start,
                ends,
                np.zeros(n),
                np.zeros(n),
                np.zeros(n),
                np.zeros(n),
                np.zeros(n, np.int64),
                np.zeros(1),
                functions,
            )
        )
    drums = _drums(layout, spans)
    if drums:
        made.append(
            lambda functions: Drums(
                _records(DRUM, drums), spans.found, np.zeros(len(drums)), np.zeros(len(drums)), functions
            )
        )
    if bodies:
        mass = np.array([row[1] for row in bodies])
        made.append(
            lambda functions: Bodies(
                _records(BODY, bodies), gravity, floor, mass, mass.copy(), np.zeros(len(mass)), functions
            )
        )
    for group in (_rims(layout, stretch), _springs(layout), _supplies(layout)):
        if group is not None:
            made.append(lambda functions, group=group: group)
    return made, pending


def _records(kind: np.dtype, rows: list[tuple]) -> np.recarray:
    made = np.zeros(len(rows), kind).view(np.recarray)
    for i, row in enumerate(rows):
        made[i] = row
    return made


def _spans(layout: Layout) -> Spans:
    rope, rows = layout.scene.rope, []
    load = rope.mass_per_length * np.array(layout.scene.gravity)
    slack = int(rope.compression == "none")
    for i, (first, last) in enumerate(layout.spans):
        for k in range(first, last):
            one = i if k == first and layout.wheels.radius[i] != 0.0 else POINT
            two = i + 1 if k == last - 1 and layout.wheels.radius[i + 1] != 0.0 else POINT
            rows.append(
                (
                    layout.station[k],
                    layout.station[k + 1],
                    one,
                    two,
                    rope.axial_stiffness,
                    rope.mass_per_length,
                    rope.damping,
                    load,
                    slack,
                )
            )
    return new_spans(_records(SPAN, rows), layout.wheels)


def _around(layout: Layout, i: int) -> tuple[int, int]:
    """Numbers of the elements before and after an item that is no end of the path."""
    return layout.item[i] - 1, layout.item[i]


def _slips(layout: Layout, spans: Spans, stretch: float) -> tuple[list[tuple], list[np.ndarray]]:
    """Contacts that stick and slip, and for each the degrees of freedom that it couples."""
    scene, rows = layout.scene, []
    rope = scene.rope
    for i, item in enumerate(scene.path):
        p = layout.material(i)
        if isinstance(item, Drum):
            rows += _brakes(layout, i, item, p, stretch)
            continue
        if not isinstance(item, Sheave):
            continue
        before, after = _around(layout, i)
        stiffness = rope.axial_stiffness / max(layout.path.arcs[i], item.radius)
        rim = layout.rim.get(i, NONE)
        common = (before, after)
        if isinstance(item.law, Efficiency) and item.law.efficiency < 1.0:
            loss = 1.0 / item.law.efficiency - 1.0
            rows.append((EFFICIENCY, p, stretch, NONE, 0.0, *common, loss, stiffness, rope.mass_per_length, NONE))
        if item.law == "capstan" and (rim != NONE or item.locked) and item.groove_friction > 0.0:
            rows.append(
                (
                    CAPSTAN,
                    p,
                    -stretch,
                    rim,
                    -1.0 if rim != NONE else 0.0,
                    *common,
                    item.groove_friction,
                    stiffness,
                    rope.mass_per_length,
                    NONE,
                )
            )
        if item.bearing is not None and item.bearing.friction > 0.0 and not item.locked:
            share = item.bearing.friction * item.bearing.radius / item.radius
            where = (NONE, 0.0, rim, 1.0) if rim != NONE else (p, stretch, NONE, 0.0)
            rows.append((BEARING, *where, *common, share, stiffness, rope.mass_per_length, NONE))
    stencils = []
    for row in rows:
        places = [x for x in (row[1], row[3]) if x != NONE]
        for n in row[5:7]:
            if n != NONE:
                for s in (spans.rows.a[n], spans.rows.b[n]):
                    places += list(range(s, s + STATION))
        stencils.append(np.array([places], dtype=np.int64))
    return rows, stencils


def _brakes(layout: Layout, i: int, drum: Drum, p: int, stretch: float) -> list[tuple]:
    """A drum's brake and its friction."""
    if drum.prescribed:
        return []
    rows, rope, requests = [], layout.scene.rope, layout.requests
    stiffness = rope.axial_stiffness / drum.radius
    if drum.friction_torque > 0.0:
        always = requests.add(FunctionRequest(Constant(value=1.0)))
        force = drum.friction_torque / drum.radius
        rows.append((TORQUE, p, stretch, NONE, 0.0, NONE, NONE, force, stiffness, 0.0, always))
    if drum.brake is not None and drum.brake.torque > 0.0:
        closed: Any = Constant(value=1.0)
        if drum.brake.until is not None:
            closed = Ramp(**{"from": 1.0}, to=0.0, over=CLOSES, at=drum.brake.until)
        if drum.brake.closed is not None:
            closed = drum.brake.closed
        share = requests.add(FunctionRequest(closed, key=f"path[{i}].drum.brake"))
        force = drum.brake.torque / drum.radius
        rows.append((TORQUE, p, stretch, NONE, 0.0, NONE, NONE, force, stiffness, 0.0, share))
    return rows


def _drums(layout: Layout, spans: Spans) -> list[tuple]:
    rows, scene = [], layout.scene
    for i, item in enumerate(scene.path):
        if not isinstance(item, Drum) or item.prescribed:
            continue
        first = i == 0
        place = layout.material(i)
        span = 0 if first else len(spans.rows) - 1
        drive = item.torque if item.drive == "torque" else item.tension
        function = layout.requests.add(FunctionRequest(drive, key=f"path[{i}].drum.{item.drive}"))
        gains = item.gains
        begin = layout.degrees.value[place]
        rows.append(
            (
                place,
                1.0 if first else -1.0,
                1.0 / item.radius,
                item.inertia,
                scene.rope.mass_per_length,
                np.inf if item.rope_on_drum is None else item.rope_on_drum,
                begin,
                function,
                int(item.drive == "tension"),
                gains.proportional if gains else 0.0,
                gains.integral if gains else 0.0,
                item.torque_limit or np.inf,
                span,
            )
        )
    return rows


def _bodies(layout: Layout) -> list[tuple]:
    scene, rows = layout.scene, []
    water, up = scene.water, -np.array(scene.gravity, dtype=float)
    for k, body in enumerate(scene.bodies):
        functions = [-1, -1, -1]
        for c, force in enumerate(body.force or ()):
            functions[c] = layout.requests.add(FunctionRequest(force, key=f"bodies[{k}].force[{c}]"))
        released = body.release
        rows.append(
            (
                layout.body[body.name],
                body.mass,
                released.remaining if released else body.mass,
                released.at if released else np.inf,
                body.added_mass,
                body.drag.linear,
                body.drag.quadratic,
                (water.density * body.volume if water else 0.0) * up,
                functions,
                body.bottom,
                int(scene.ground is not None),
            )
        )
    return rows


def _rims(layout: Layout, stretch: float) -> Rims | None:
    """Rims on their own travel, or on the material that does not slip on them."""
    place, mass = [], []
    for i, item in enumerate(layout.scene.path):
        if isinstance(item, Sheave) and item.inertia > 0.0:
            own = has_rim(item)
            place.append(layout.rim[i] if own else layout.material(i))
            mass.append(item.inertia / item.radius**2 * (1.0 if own else stretch**2))
    return Rims(np.array(place, dtype=np.int64), np.array(mass)) if place else None


def _springs(layout: Layout) -> Springs | None:
    held = [(layout.body[body.name], body.spring, body.position) for body in layout.scene.bodies if body.spring]
    if not held:
        return None
    place = np.array([[at + c] for at, _, _ in held for c in range(AXES)])
    return Springs(
        place.ravel(),
        np.array([spring.stiffness[c] for _, spring, _ in held for c in range(AXES)]),
        np.array([spring.damping[c] for _, spring, _ in held for c in range(AXES)]),
        np.array([(spring.rest or drawn)[c] for _, spring, drawn in held for c in range(AXES)]),
    )


def _supplies(layout: Layout) -> Supplies | None:
    rows = []
    for i, item in enumerate(layout.scene.path):
        if isinstance(item, Drum) and item.rope_on_drum is not None:
            way = 1.0 if i == 0 else -1.0
            place = layout.material(i)
            begin = layout.degrees.value[layout.supply[i][0]] if i in layout.supply else layout.degrees.value[place]
            rows.append((place, begin - way * item.rope_on_drum, way))
    if not rows:
        return None
    place, least, way = zip(*rows, strict=True)
    return Supplies(np.array(place, dtype=np.int64), np.array(least), np.array(way))


def _stencils(layout: Layout, pending: list[np.ndarray]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """What spans, contacts and bodies couple."""
    stations = np.array(layout.station)
    spans = np.concatenate((stations[:-1, None] + np.arange(STATION), stations[1:, None] + np.arange(STATION)), axis=1)
    single = np.array([[place] for place in layout.rim.values()], dtype=np.int64).reshape(-1, 1)
    bodies = np.array([place + np.arange(AXES) for place in layout.body.values()], dtype=np.int64).reshape(-1, AXES)
    return [spans, single, bodies, *pending], [spans, single, bodies]
