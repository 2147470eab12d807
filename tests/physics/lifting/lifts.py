"""Crane scenes for the tests: Atwood's machine, blocks of falls, pendulums and single falls, run or brought to rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml
from references.crane import stretch_under

from crane.assembly.layout import lay_out
from crane.model.build import build
from crane.scene.scene import CraneScene
from tautline.integrators.state import new_state
from tautline.results.result import Result
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate
from tautline.system.system import System

G = 9.81
LIGHT = {"mass_per_length": 1e-5, "axial_stiffness": 1e9, "damping": 2e-3}
"""A rope that is nearly weightless and inextensible; what it bounces with is gone in some milliseconds."""
SOLVER = {"method": "generalized-alpha", "rho_inf": 0.6, "step": 1e-3, "end": 1.0}
PULLEY = 0.3
"""Radius of the sheaves of blocks, m."""

Item = dict[str, dict[str, Any]]


# items of a path, as a scene's file has them
def drum(center: Any, radius: float, pay_out: Any = 0.0, **more: Any) -> Item:
    return {"drum": _disc({"name": "winch", "center": center, "radius": radius, "pay_out": pay_out} | more)}


def sheave(name: str, radius: float, **more: Any) -> Item:
    return {"sheave": _disc({"name": name, "radius": radius} | more)}


def _disc(keys: dict[str, Any]) -> dict[str, Any]:
    return {"axis": (0.0, 1.0, 0.0), "wrap": "over"} | keys


def end(body: str, offset: Any = (0.0, 0.0, 0.0)) -> Item:
    return {"end": {"name": f"end at {body}", "body": body, "offset": offset}}


def anchor(position: Any) -> Item:
    return {"anchor": {"name": "dead end", "position": position}}


def body(name: str, mass: float, position: Any, guide: str = "", **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": mass, "position": position, "guide": [*guide]} | more


def ramp(to: float, over: float, **more: Any) -> dict[str, Any]:
    return {"ramp": {"to": to, "over": over} | more}


def plain(value: Any) -> Any:
    """Lists and numbers as YAML knows them, in place of tuples, arrays and their numbers."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(part) for part in value]
    return value.item() if isinstance(value, np.generic) else value


# scenes
def scene(
    path: list[Item],
    bodies: list[dict[str, Any]],
    rope: dict[str, Any] | None = None,
    solver: dict[str, Any] | None = None,
    interval: float = 0.05,
    elements: int = 1,
    **top: Any,
) -> CraneScene:
    """A scene of one rope, `LIGHT` and of one element a span; `rope` and `solver` change their keys."""
    document: dict[str, Any] = {"rope": LIGHT | (rope or {}), "path": path, "bodies": bodies}
    document |= {"mesh": {"elements_per_span": elements}, "gravity": [0.0, 0.0, -G]}
    document |= {"solver": SOLVER | (solver or {}), "output": {"interval": interval}} | top
    return validate(CraneScene, Document.parse(yaml.safe_dump(plain(document), sort_keys=False), "crane.yaml"))


def drawn_length(made: CraneScene) -> float:
    """Rope between both ends of the path as drawn, m."""
    return float(lay_out(made).path.chords.sum())


def taut(made: CraneScene, tension: float) -> CraneScene:
    """The scene, begun as drawn, with rope of such a length that it has a tension, N, all along at the start."""
    length = drawn_length(made) / stretch_under(tension, made.rope.axial_stiffness)
    rope = made.rope.model_copy(update={"length": float(length)})
    return made.model_copy(update={"rope": rope, "start": "as drawn"})


def atwood(
    mass_1: float,
    mass_2: float,
    radius: float,
    law: dict[str, Any],
    x: float = 0.0,
    side: float = 5.0,
    tension: float | None = None,
    force: Any = None,
    **more: Any,
) -> CraneScene:
    """Atwood's machine about the origin, its masses guided: the second hangs `x` below `side`, m, the first above.

    `law` are keys of the sheave; `tension` at the start, N, by default the mean weight; `force` a function of time
    upwards on the second mass, N.
    """
    bodies = [body("one", mass_1, (-radius, 0.0, x - side), "xy"), body("two", mass_2, (radius, 0.0, -side - x), "xy")]
    if force is not None:
        bodies[1]["force"] = [0.0, 0.0, force]
    path = [end("one"), sheave("top", radius, center=(0.0, 0.0, 0.0), **law), end("two")]
    return taut(scene(path, bodies, **more), 0.5 * (mass_1 + mass_2) * G if tension is None else tension)


def block(
    falls: int, mass: float, law: dict[str, Any], pay_out: Any = 0.0, apart: float = 0.0, **more: Any
) -> CraneScene:
    """A guided block 10 m below fixed sheaves, on a number of upright falls; the rope comes from a drum to the left.

    All sheaves are of one plane, or with `apart`, m, side by side on two axles.
    """
    path = [drum((-5.0, 0.0, 0.0), 0.5, pay_out)]
    for i in range(falls):
        x, y = (PULLEY * (2 * i - 1), 0.0) if apart == 0.0 else (-PULLEY, apart * i)
        if i % 2 == 0:
            path.append(sheave(f"top {i}", PULLEY, center=(x, y, 0.0), **law))
        else:
            path.append(sheave(f"low {i}", PULLEY, body="block", offset=(x, y, 0.0), wrap="under", **law))
    last = (2.0 * PULLEY * (falls - 1 if apart == 0.0 else -((falls - 1) % 2)), apart * (falls - 1), 0.0)
    path.append(anchor(last) if falls % 2 == 0 else end("block", last))
    return scene(path, [body("block", mass, (0.0, 0.0, -10.0), "xy")], **more)


# what they do
def run(made: CraneScene) -> Result:
    return simulate(build(made))


def at_start(made: CraneScene) -> tuple[System, Any]:
    """The compiled scene and its state at the start, which is at rest where the scene says so."""
    system = build(made).system
    return system, new_state(system)


def rope_length(made: CraneScene, system: System) -> float:
    """Unstretched rope between both ends of the path, m."""
    layout = lay_out(made)
    return float(system.q[layout.material(len(made.path) - 1)] - system.q[layout.material(0)])


def of(result: Result, name: str) -> np.ndarray:
    return np.asarray(result[name])


def travel(result: Result) -> np.ndarray:
    """How far the second mass of Atwood's machine has come down, m."""
    z = of(result, "body_position")[:, 1, 2]
    return z[0] - z


def energy_missing(result: Result) -> float:
    """Energy created or lost numerically, the largest at any frame, over what went through."""
    names = ("kinetic_energy", "strain_energy", "potential_energy", "external_work", "dissipated_energy")
    kinetic, strain, potential, work, lost = (of(result, name) for name in names)
    missing = kinetic + strain + potential - work + lost
    through = kinetic.max() + np.ptp(strain) + np.abs(np.diff(work)).sum() + lost[-1]
    return float(np.abs(missing - missing[0]).max() / through)


def orders(errors: Any) -> np.ndarray:
    """Observed orders of convergence of errors at halved steps or doubled numbers of elements."""
    errors = np.abs(np.asarray(errors))
    return np.log2(errors[:-1] / errors[1:])
