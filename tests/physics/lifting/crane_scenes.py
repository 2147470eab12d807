"""Texts of crane scenes, and what a test asks of their runs.

A scene is a dictionary as its YAML file reads, so that a test changes what it is about; `ran` writes and runs it. In
every run that is judged, all numbers are finite and the energy balances.
"""

from copy import deepcopy
from itertools import product

import numpy as np
import pytest
import yaml

from crane.assembly.layout import lay_out
from crane.model.build import build
from crane.scene.scene import CraneScene
from tautline.integrators.status import StoppedEarly
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

GRAVITY = 9.81
HOISTING = {"ramp": {"to": -2.0, "over": 1.0}}
ACROSS = (0.0, 1.0, 0.0)
ENERGIES = ("kinetic_energy", "strain_energy", "potential_energy")


# scenes
def crane(path, bodies=(), rope=None, **more):
    """A scene: the rope of hoist.yaml, 5 ms steps to 1 s and a frame every 10 ms where nothing else is said.

    `solver` and `interval` are among what may be said; the rest are keys of the scene.
    """
    solver = {"method": "generalized-alpha", "rho_inf": 0.6, "step": 5e-3, "end": 1.0} | more.pop("solver", {})
    output = {"interval": more.pop("interval", 0.01)}
    rope = {"mass_per_length": 6.5, "axial_stiffness": 8.0e7, "damping": 1.0e-4} | (rope or {})
    return deepcopy(
        {"rope": rope, "bodies": list(bodies), "path": list(path), **more, "solver": solver, "output": output}
    )


def body(name, mass, position, **more):
    return {"name": name, "mass": mass, "position": position, **more}


def drum(center=(0.0, 0.0, 0.0), radius=0.5, wrap="over", axis=ACROSS, name="winch", **more):
    """A drum at rest unless it is driven."""
    driven = {"torque", "tension", "speed", "pay_out"} & set(more)
    drive = more if driven else more | {"pay_out": 0.0}
    return {"drum": {"name": name, "center": center, "radius": radius, "axis": axis, "wrap": wrap, **drive}}


def sheave(center=None, radius=0.4, wrap="over", axis=ACROSS, name="boom tip", **more):
    placed = {} if center is None else {"center": center}
    return {"sheave": {"name": name, **placed, "radius": radius, "axis": axis, "wrap": wrap, **more}}


def anchor(position, name="top", **more):
    return {"anchor": {"name": name, "position": position, **more}}


def end(on, name="hook", **more):
    return {"end": {"name": name, "body": on, **more}}


def hoist(mass=5000.0, elements=4, drive=None, tip=None, **more):
    """One fall from a drum over a boom tip, as in hoist.yaml without its vessel."""
    path = [
        drum(**(drive or {"pay_out": HOISTING})),
        sheave((12.0, 0.0, 30.0), **({"inertia": 20.0} if tip is None else tip)),
        end("payload"),
    ]
    load = body("payload", mass, (12.4, 0.0, 5.0), **more.pop("load", {}))
    return crane(path, [load], mesh={"elements_per_span": elements}, **more)


def fall(mass=5000.0, length=25.0, elements=4, load=None, **more):
    """A payload plumb below an anchor."""
    path = [anchor((0.0, 0.0, 0.0)), end("payload")]
    bodies = [body("payload", mass, (0.0, 0.0, -length), **(load or {}))]
    return crane(path, bodies, mesh={"elements_per_span": elements}, **more)


def block_of_falls(falls, mass=80.0e3, elements=2, height=20.0, hooks=None, fixed=None, load=None, **more):
    """A hook block in an even number of falls, drum to dead end, the sheaves side by side in one plane each.

    Sheaves of the block and of the boom alternate along x, so that all falls are plumb and no fleet angle remains.
    """
    hooks = {"inertia": 12.0} if hooks is None else hooks
    fixed = {"inertia": 20.0} if fixed is None else fixed
    radius, top = 0.4, 30.0
    path = [drum((-12.0, 0.0, 0.0), **more.pop("drive", {})), sheave((0.0, 0.0, top), radius, name="tip 1", **fixed)]
    pairs, x = falls // 2, radius
    middle = radius + (falls - 1) * radius
    for k in range(pairs):
        offset = (x + radius - middle, 0.0, 0.0)
        path.append(sheave(None, radius, "under", name=f"hook {k + 1}", body="block", offset=offset, **hooks))
        x += 2.0 * radius
        if k < pairs - 1:
            path.append(sheave((x + radius, 0.0, top), radius, name=f"tip {k + 2}", **fixed))
            x += 2.0 * radius
    path.append(anchor((x, 0.0, top), "dead end"))
    held = {"guide": ["x"]} | (load or {})
    bodies = [body("block", mass, (middle, 0.0, top - height), **held)]
    return crane(path, bodies, mesh={"elements_per_span": elements}, **more)


def solved(scene, **solver):
    """The scene with another solver."""
    return scene | {"solver": {key: x for key, x in (scene["solver"] | solver).items() if x is not None}}


# turned and moved
def turn(axis, angle):
    """Matrix of a rotation, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across


def _listed(vector):
    return [float(x) for x in vector]


def turned(scene, matrix, shift=(0.0, 0.0, 0.0), gravity=True):
    """All that is drawn turned about the origin and moved, and gravity with it; wraps are named anew.

    Parameters
    ----------
    matrix : (3, 3) array
    shift : (3,)
    gravity : bool
        False leaves gravity as it is.
    """
    made, shift = deepcopy(scene), np.asarray(shift, dtype=float)

    def move(thing, *keys):
        for key in keys:
            if key in thing:
                thing[key] = _listed(matrix @ np.asarray(thing[key], dtype=float) + (shift if key not in FREE else 0.0))

    for item in made["path"]:
        move(next(iter(item.values())), "center", "position", "offset", "axis")
    for thing in made["bodies"]:
        move(thing, "position", "velocity")
    for frame in made.get("frames", ()):
        move(frame, "pivot")
    if "vessel" in made:
        move(made["vessel"], "reference")
    if gravity:
        made["gravity"] = _listed(matrix @ np.asarray(scene.get("gravity", (0.0, 0.0, -GRAVITY)), dtype=float))
    return _rewrapped(made, scene)


FREE = ("axis", "offset", "velocity")
"""Vectors that a displacement of the scene leaves as they are."""


def _rewrapped(made, scene):
    """Name the sides of the wheels so that the rope runs as it did: over and under are sides in space."""
    wanted = lay_out(parsed(scene)).path.sigma
    wheels = [(i, next(iter(item.values()))) for i, item in enumerate(made["path"])]
    wheels = [(i, wheel) for i, wheel in wheels if "wrap" in wheel]
    for words in product(*(_words(wheel["axis"], wanted[i]) for i, wheel in wheels)):
        for (_, wheel), word in zip(wheels, words, strict=True):
            wheel["wrap"] = word
        try:
            sigma = lay_out(parsed(made)).path.sigma
        except SceneError:
            continue
        if all(sigma[i] == wanted[i] for i, _ in wheels):
            return made
    raise AssertionError("no words of the wraps lead the rope as it ran")


def _words(axis, sigma):
    """Words that may lead a rope about an axis in a sense: left or right say it alone, over and under with the path."""
    rise = axis[2] / np.linalg.norm(axis)
    if abs(rise) < 0.15:
        return ("over", "under")
    return ("right",) if rise * sigma > 0.0 else ("left",)


# runs
def parsed(scene):
    return CraneScene.parse(yaml.safe_dump(scene))


def model_of(scene):
    return build(parsed(scene))


def ran(scene, energy=0.01):
    """Run a scene to its end; everything that it stores is finite and its energy balances."""
    model = model_of(scene)
    result = simulate(model)
    assert_finite(model, result)
    assert result.attributes["status"] == "done"
    assert result.attributes["energy_error"] <= energy
    return result


def stopped(scene, *statuses):
    """Run a scene that stops early with one of some statuses; what it stored until then is finite."""
    model = model_of(scene)
    with pytest.raises(StoppedEarly) as stop:
        simulate(model)
    assert stop.value.status in statuses
    assert stop.value.part and stop.value.sentence
    if stop.value.result is not None:
        assert_finite(model, stop.value.result)
    return stop.value


def assert_finite(model, result):
    for variable in model.variables:
        assert np.isfinite(result[variable.name]).all(), variable.name


def unbalanced(result):
    """Energy from nowhere, J, at every frame: (n,)."""
    total = sum(result[name] for name in ENERGIES)
    return total - total[0] - (result["external_work"] - result["dissipated_energy"])


def imbalance(result, begin=0.0):
    """Largest energy from nowhere since a time, as a share of what moves and what the rope gives and takes."""
    since = result["time"] >= begin - 1.0e-9
    kinetic, strain, missing = (
        x[since] for x in (result["kinetic_energy"], result["strain_energy"], unbalanced(result))
    )
    return np.abs(missing - missing[0]).max() / (kinetic.max() + np.ptp(strain))
