"""Made-up runs of cranes, for trying figures and summaries: the geometry is that of a taut rope, the forces are not."""

import re

import numpy as np
import yaml

from crane.assembly.layout import Layout
from crane.geometry.reeving import Wheel, reeve
from crane.results.course import laid_out, nodes_of
from crane.results.observe import Observer, variables
from crane.scene.scene import CraneScene, Drum, Sheave
from tautline.results.store import Store

ROPE = {"mass_per_length": 6.5, "axial_stiffness": 8.0e7, "diameter": "36 mm", "breaking_load": "1.1 MN"}
WINCH = {"drum": {"name": "winch", "center": [0, 0, 0], "radius": 0.5, "axis": [0, 1, 0], "wrap": "over", "pay_out": 0}}
TIP = {"sheave": {"name": "boom tip", "center": [12, 0, 30], "radius": 0.4, "axis": [0, 1, 0], "wrap": "over"}}
LOAD = {"name": "payload", "mass": "5 t", "position": [12.4, 0, 5]}
HOOK = {"end": {"name": "hook", "body": "payload"}}


def scene(path=(WINCH, TIP, HOOK), bodies=(LOAD,), rope=None, **more):
    """A crane scene; one fall where nothing else is said."""
    solver = {"step": "5 ms", "end": "10 s"} | more.pop("solver", {})
    output = {"interval": more.pop("interval", 0.05)}
    rope = ROPE | (rope or {})
    text = {"rope": rope, "bodies": list(bodies), "path": list(path), **more, "solver": solver, "output": output}
    return CraneScene.parse(yaml.safe_dump(text))


def one_fall(**more):
    return scene(title="One fall", **more)


def falls(count, law="no_slip", **more):
    """A block on an even number of falls, its sheaves and those above it in one row."""
    radius, middle = 0.4, 0.4 * count
    wheel = {"radius": radius, "axis": [0, 1, 0], "inertia": 10.0, "law": law}
    wheel |= {"friction": 0.1} if law == "capstan" else {}
    drum = {"drum": WINCH["drum"] | {"center": [-12, 0, 0]}}
    path, x = [drum], 0.0
    for k in range(count // 2):
        path.append({"sheave": wheel | {"name": f"head {k + 1}", "center": [x, 0, 30], "wrap": "over"}})
        block = {"name": f"block {k + 1}", "body": "block", "offset": [x + 2 * radius - middle, 0, 0], "wrap": "under"}
        path.append({"sheave": wheel | block})
        x += 4.0 * radius
    path.append({"anchor": {"name": "dead end", "position": [x - radius, 0, 30]}})
    body = {"name": "block", "mass": "50 t", "position": [middle, 0, 5]}
    return scene(path=path, bodies=[body], title=f"{count} falls", **more)


def fixed_rope(**more):
    """A rope between two anchors, with neither wheel nor body."""
    path = [{"anchor": {"name": "one", "position": [0, 0, 0]}}, {"anchor": {"name": "other", "position": [10, 0, 0]}}]
    return scene(path=path, bodies=(), title="A rope between two anchors", **more)


def elevator(**more):
    """Two masses over one sheave, without a drum."""
    bodies = [
        {"name": "car", "mass": "1 t", "position": [-0.5, 0, 0]},
        {"name": "counterweight", "mass": "1.1 t", "position": [0.5, 0, 10]},
    ]
    sheave = {"name": "top", "center": [0, 0, 30], "radius": 0.5, "axis": [0, 1, 0], "wrap": "over"}
    path = [{"end": {"name": "a", "body": "car"}}, {"sheave": sheave}, {"end": {"name": "b", "body": "counterweight"}}]
    return scene(path=path, bodies=bodies, title="Elevator", **more)


def result(of, path=None, frames=201, rise=15.0, sway=0.5, bounce=0.1, frequency=2.0, slack=False, across=0.0):
    """A result in which the first body rises by `rise` and sways; the tension is that at rest, and `bounce` of it."""
    layout = laid_out(of)
    time = of.output.interval * np.arange(frames)
    share = time / max(time[-1], 1e-9)
    move = np.stack([sway * np.sin(time), across * np.sin(1.3 * time), rise * share], axis=1)
    rest = max(of.bodies[0].mass * 9.81 if of.bodies else 1.0e4, 1.0) / max(1, len(of.sheaves))
    level = rest * (1.0 + bounce * np.sin(2 * np.pi * frequency * time) * (time > 0.0))
    if slack:
        level = np.where((share > 0.4) & (share < 0.5), 0.0, level)
    if len(of.bodies) > 1:
        other = of.bodies[1]
        moved = {of.bodies[0].name: move, other.name: -move}
    else:
        moved = {body.name: move for body in of.bodies}
    key = of.document.text, frames, rise, sway, across
    if key not in WAYS:
        WAYS[key] = _ways(of, layout, time, moved)
    store = _histories(of, layout, time, moved, level, WAYS[key])
    observer = Observer(layout, (), None)
    described = {"scene": of.document.text, "title": of.title or "", "application": "crane"}
    with Store(path, variables(observer), observer.coordinates(), described) as written:
        written.append(store)
        return written.finish()


WAYS = {}
"""Of results that were made, by what their ropes' ways depend on: to reeve a rope takes longest of all."""


def _ways(of: CraneScene, layout: Layout, time, moved):
    """Wheels, and the way of a taut rope over them, of every frame."""
    wheels = [_wheel(of, layout, i) for i in range(len(of.path))]
    return [_reeved(of, wheels, moved, k, layout.path.sigma) for k in range(len(time))]


def _histories(of: CraneScene, layout: Layout, time, moved, level, ways):
    items, node = of.path, nodes_of(of)
    first = np.concatenate(([0.0], np.cumsum(layout.path.chords)))
    spans, count = len(items) - 1, node[-1]
    names = {variable.name: variable for variable in variables(Observer(layout, (), None))}
    sizes = {"node": count + 1, "axis": 3, "element": count, "span": spans, "end": 2}
    sizes |= {"sheave": len(of.sheaves), "drum": len(of.drums), "body": len(of.bodies)}
    made = {name: np.zeros((len(time), *(sizes[dim] for dim in variable.dims[1:]))) for name, variable in names.items()}
    for k, way in enumerate(ways):
        made["position"][k], made["material_coordinate"][k] = _nodes(of, node, way, first[-1])
    made["axial_force"][:] = level[:, None]
    made["tension"][:] = level[:, None, None] * (1.0 + 0.01 * np.arange(spans)[:, None])
    for k, body in enumerate(of.bodies):
        made["body_position"][:, k] = np.array(body.position) + moved[body.name]
        made["body_velocity"][:, k] = np.gradient(moved[body.name], time, axis=0) if len(time) > 1 else 0.0
    _wheels(of, node, made, ways, level)
    _drums(of, node, made, time)
    for k, name in enumerate(("kinetic", "strain", "potential", "dissipated")):
        made[f"{name}_energy"] = (k + 1.0) * time**2
    made["external_work"] = 10.0 * time**2
    return made | {"time": time}


def _wheel(of, layout, i):
    item, path = of.path[i], layout.path
    k = min(i, len(path.spans) - 1)
    span = path.spans[k]
    center = path.tangents[k, int(k != i)] - (span.x1 if k == i else span.x2)
    wheel = isinstance(item, (Drum, Sheave))
    axis = item.unit_axis if wheel else (0, 1, 0)
    return Wheel(item.name, center, np.array(axis, float), item.radius if wheel else 0.0, None, not wheel)


def _reeved(of, wheels, moved, k, sigma):
    placed = []
    for wheel, item in zip(wheels, of.path, strict=True):
        shift = moved[item.body][k] if getattr(item, "body", None) else np.zeros(3)
        placed.append(Wheel(wheel.name, wheel.center + shift, wheel.axis, wheel.radius, None, wheel.point))
    return placed, reeve(placed, sigma)


def _nodes(of, node, way, total):
    """Positions of stations, and material reckoned from the rope's last end."""
    wheels, path = way
    position, marks = np.zeros((node[-1] + 1, 3)), total - np.concatenate((np.cumsum(path.chords[::-1])[::-1], [0.0]))
    material = np.zeros(node[-1] + 1)
    for i, wheel in enumerate(wheels):
        position[node[i]], material[node[i]] = wheel.center, marks[i]
    for k in range(len(wheels) - 1):
        inside = np.linspace(0.0, 1.0, node[k + 1] - node[k] + 1)[1:-1, None]
        begin, end = path.tangents[k]
        position[node[k] + 1 : node[k + 1]] = begin + inside * (end - begin)
        material[node[k] + 1 : node[k + 1]] = marks[k] + inside[:, 0] * (marks[k + 1] - marks[k])
    return position, material


def _wheels(of, node, made, ways, level):
    sheaves = [i for i, item in enumerate(of.path) if isinstance(item, Sheave)]
    for j, i in enumerate(sheaves):
        made["wrap_angle"][:, j] = [path.wraps[i] for _, path in ways]
        made["fleet_angle"][:, j] = [(path.fleet[i - 1, 1], path.fleet[i, 0]) for _, path in ways]
        e = np.array([path.spans[i].e - path.spans[i - 1].e for _, path in ways])
        made["sheave_load"][:, j] = level[:, None] * e
        travel = made["material_coordinate"][:, node[i]] - made["material_coordinate"][0, node[i]]
        made["sheave_rotation"][:, j] = -travel / of.path[i].radius
        made["slipping"][:, j] = (level > level.mean()) * (j == 1)


def _drums(of, node, made, time):
    for j, i in enumerate(i for i, item in enumerate(of.path) if isinstance(item, Drum)):
        way = -1.0 if i == 0 else 1.0
        lead = made["material_coordinate"][:, node[i]]
        made["drum_tension"][:, j] = made["tension"][:, 0, 0] if i == 0 else made["tension"][:, -1, 1]
        made["paid_out"][:, j] = way * (lead - lead[0])
        made["pay_out_speed"][:, j] = np.gradient(made["paid_out"][:, j], time) if len(time) > 1 else 0.0
        made["drum_rotation"][:, j] = made["paid_out"][:, j] / of.path[i].radius
        made["winch_power"][:, j] = -made["drum_tension"][:, j] * made["pay_out_speed"][:, j]


def forces_in(text, pattern):
    """Forces, N, that a message tells: ``FORCE`` in a pattern stands for one, such as 10.9 kN."""
    found = re.findall(pattern.replace("FORCE", r"([\d.e+]+ [kMG]?N)"), text)
    return [float(number) * {"N": 1.0, "kN": 1e3, "MN": 1e6, "GN": 1e9}[unit] for number, unit in map(str.split, found)]
