"""Hose scenes for the tests: Table 2.2's hose and what differs from it, at rest, about rest, and in motion."""

from __future__ import annotations

import csv
import json
from typing import Any

import numpy as np
import yaml
from references import hose as reference

from gardenhose.build import build
from gardenhose.motion.limit_cycle import LimitCycle, limit_cycle
from gardenhose.scene import HoseScene
from gardenhose.static import Form, form
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.results.result import Result
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate

COUPLINGS = ("linear", "lagrange", "penalty", "augmented")
TIED = COUPLINGS[1:]
WATER = 0.0007854
SECTION = {"axial_stiffness": 10.0, "bending_stiffness": 0.00108, "mass_per_length": 0.0031316, "damping": 0.0031316}
UNIFORM = {"length": 0.5, "elements": 10} | SECTION
SOLVER = {"method": "generalized-alpha", "rho_inf": 0.9, "step": 1e-3, "end": 1.0}


def scene(
    hose: dict[str, Any] | None = None,
    water: dict[str, Any] | None = None,
    solver: dict[str, Any] | None = None,
    interval: float = 5e-3,
    **top: Any,
) -> HoseScene:
    """Table 2.2's hose of 10 elements with keys of its parts changed; `segments` take the place of the uniform hose.

    `water` False is a hose without water.
    """
    hose = hose or {}
    document: dict[str, Any] = {"hose": ({} if "segments" in hose else UNIFORM) | hose}
    if water is not False:
        document["water"] = {"mass_per_length": WATER, "speed": 0.0} | (water or {})
    document |= {"solver": SOLVER | (solver or {}), "output": {"interval": interval}} | top
    return validate(HoseScene, Document.parse(yaml.safe_dump(document), "hose.yaml"))


def pipe(beta: float, n: int, hose: dict[str, Any] | None = None, outlet: float = 1.0, **top: Any) -> HoseScene:
    """The pipe of Gregory and Paidoussis: length, EJ and m + M are one, nearly inextensible, weightless, undamped.

    The speed is u/sqrt(beta) and time is theirs. `axial_stiffness` is that of a thin pipe: u^2/EA is what it adds.
    """
    section = {"length": 1.0, "elements": n, "axial_stiffness": 1e7, "bending_stiffness": 1.0, "damping": 0.0}
    section["mass_per_length"] = 1.0 - beta
    water = {"mass_per_length": beta, "outlet": outlet}
    return scene(section | (hose or {}), water, gravity=[0, 0, 0], **top)


def at_rest(made: HoseScene, speed: float, **more: Any) -> Form:
    return form(made, speed, **more)


def tip_of(made: HoseScene, speed: float) -> np.ndarray:
    """Place of the tip at rest, x, y, z."""
    return form(made, speed).tip


def run(made: HoseScene, **more: Any) -> Result:
    return simulate(build(made), **more)


def flowing(speed: float, n: int = 10, step: float = 1e-3, end: float = 1.0, **more: Any) -> HoseScene:
    """Table 2.2's hose let go straight and at rest, with the water at full speed from t = 0."""
    hose, water, solver = (more.pop(key, {}) for key in ("hose", "water", "solver"))
    solver = {"step": step, "end": end} | solver
    if "segments" not in hose:
        hose = {"elements": n} | hose
    return scene(hose, {"speed": speed} | water, solver, more.pop("interval", max(step, 5e-3)), **more)


def cycle_of(result: Result, since: float = 0.0) -> LimitCycle:
    time = np.asarray(result["time"])
    late = time >= since
    return limit_cycle(time[late], *(np.asarray(result[name])[late] for name in ("tip", "tip_velocity")), 0.5)


def ranges(result: Result, since: float) -> tuple[float, float, float]:
    """Frequency, Hz, and peak to peak of the tip along x and z, m, of a settled motion after some time."""
    found = cycle_of(result, since)
    return found.frequency, 2 * found.axis_amplitude[0], 2 * found.axis_amplitude[2]


def energy_missing(result: Result) -> float:
    """Energy created or lost numerically, the largest at any frame, over what went through the hose."""
    names = ("kinetic_energy", "strain_energy", "potential_energy", "external_work", "dissipated_energy")
    kinetic, strain, potential, work, lost = (np.asarray(result[name]) for name in names)
    missing = kinetic + strain + potential - work + lost
    through = kinetic.max() + np.ptp(strain) + np.abs(np.diff(work)).sum() + lost[-1]
    return float(np.abs(missing - missing[0]).max() / through)


def reference_tip() -> tuple[np.ndarray, np.ndarray]:
    """Times and x, z of the reference's tip at 15 m/s."""
    with open(reference.HERE / "hose_tip.csv") as file:
        rows = np.array([[float(row[key]) for key in ("t", "x", "z")] for row in csv.DictReader(file)])
    return rows[:, 0], rows[:, 1:]


def reference_file(name: str) -> dict[str, Any]:
    return json.loads((reference.HERE / f"hose_{name}.json").read_text())


def orders(errors) -> np.ndarray:
    """Observed orders of convergence of errors at halved steps or doubled numbers of elements."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


def dry_at_rest(made: HoseScene) -> tuple[Any, Any]:
    """System and state in equilibrium of a scene without water, which `form` refuses."""
    model = build(made)
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    return model.system, state
