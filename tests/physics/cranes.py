"""Crane scenes for the tests: Atwood's machine, blocks of falls, pendulums and single falls, run or brought to rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml
from references.crane import stretch_under

from crane.build import build
from crane.scene import CraneScene
from tautline.integrators.equilibrium import find_equilibrium
from tautline.integrators.state import State, new_state
from tautline.results.result import Result
from tautline.scene.document import Document
from tautline.scene.model import validate
from tautline.simulation import simulate
from tautline.system.model import Model

G = 9.81
ACROSS = (0.0, 1.0, 0.0)
LIGHT = {"mass_per_length": 1e-5, "axial_stiffness": 1e9, "damping": 2e-3}
"""A rope that is nearly weightless and inextensible; what it bounces with is gone in some milliseconds."""
SOLVER = {"method": "generalized-alpha", "rho_inf": 0.6, "step": 1e-3, "end": 1.0}

Vector = tuple[float, float, float]
Item = dict[str, dict[str, Any]]


def drum(center: Vector, radius: float, pay_out: Any = 0.0, **more: Any) -> Item:
    return {"drum": {"name": "winch", "center": [*center], "radius": radius, "pay_out": pay_out} | _disc(more)}


def sheave(name: str, radius: float, **more: Any) -> Item:
    return {"sheave": {"name": name, "radius": radius} | _disc(more)}


def _disc(more: dict[str, Any]) -> dict[str, Any]:
    return {"axis": [*ACROSS], "wrap": "over"} | {
        key: [float(x) for x in value] if isinstance(value, tuple) else value for key, value in more.items()
    }


def end(body: str, offset: Vector = (0.0, 0.0, 0.0)) -> Item:
    return {"end": {"name": f"end at {body}", "body": body, "offset": [*offset]}}


def anchor(position: Vector, name: str = "dead end") -> Item:
    return {"anchor": {"name": name, "position": [float(x) for x in position]}}


def body(name: str, mass: float, position: Vector, guide: str = "", **more: Any) -> dict[str, Any]:
    return {"name": name, "mass": mass, "position": [float(x) for x in position], "guide": [*guide]} | more


def ramp(to: float, over: float, **more: Any) -> dict[str, Any]:
    return {"ramp": {"to": to, "over": over} | more}


def scene(
    path: list[Item],
    bodies: list[dict[str, Any]],
    rope: dict[str, Any] | None = None,
    solver: dict[str, Any] | None = None,
    interval: float = 0.05,
    elements: int = 1,
    **top: Any,
) -> CraneScene:
    """A scene of one rope, by default light and stiff, and one element a span; `rope` and `solver` change their keys."""
    document: dict[str, Any] = {"rope": LIGHT | (rope or {}), "path": path, "bodies": bodies}
    document |= {"mesh": {"elements_per_span": elements}, "gravity": [0.0, 0.0, -G]}
    document |= {"solver": SOLVER | (solver or {}), "output": {"interval": interval}} | top
    text = yaml.safe_dump(document, sort_keys=False)
    return validate(CraneScene, Document.parse(text, "crane.yaml"))


def run(made: CraneScene) -> Result:
    return simulate(build(made))


def at_rest(made: CraneScene) -> tuple[Model, State]:
    """The compiled scene and its state in equilibrium."""
    model = build(made)
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    return model, state


def atwood(
    mass_1: float,
    mass_2: float,
    radius: float,
    law: dict[str, Any],
    x: float = 0.0,
    side: float = 5.0,
    tension: float | None = None,
    forces: tuple[Any, Any] = (None, None),
    **more: Any,
) -> CraneScene:
    """Atwood's machine about the origin, its two masses guided: the second hangs `x` below `side`, the first above.

    The rope is as long as makes its tension `tension` at the start, N, by default the mean weight; `law` are keys of the
    sheave. `forces` are functions of time upwards on the masses, N.
    """
    rope = LIGHT | more.pop("rope", {})
    tension = 0.5 * (mass_1 + mass_2) * G if tension is None else tension
    drawn = 2.0 * side + np.pi * radius
    rope["length"] = float(drawn / stretch_under(tension, rope["axial_stiffness"]))
    bodies = []
    for name, mass, way, force in zip(("one", "two"), (mass_1, mass_2), (-1, 1), forces, strict=True):
        pull = {} if force is None else {"force": [0.0, 0.0, force]}
        bodies.append(body(name, mass, (way * radius, 0.0, -side - way * x), "xy", **pull))
    path = [end("one"), sheave("top", radius, center=(0.0, 0.0, 0.0), **law), end("two")]
    return scene(path, bodies, rope, start="as drawn", **more)


def travel(result: Result) -> np.ndarray:
    """How far the second mass of Atwood's machine has come down, m."""
    z = np.asarray(result["body_position"])[:, 1, 2]
    return z[0] - z


def energy_missing(result: Result) -> float:
    """Energy that has come from nowhere or gone there, the largest at any frame, over what went through."""
    names = ("kinetic_energy", "strain_energy", "potential_energy", "external_work", "dissipated_energy")
    kinetic, strain, potential, work, lost = (np.asarray(result[name]) for name in names)
    missing = kinetic + strain + potential - work + lost
    through = kinetic.max() + np.ptp(strain) + np.abs(np.diff(work)).sum() + lost[-1]
    return float(np.abs(missing - missing[0]).max() / through)
