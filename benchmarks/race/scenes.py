"""The scenes of `race.py`: their numbers, how Tautline writes them, and what both programs are judged by."""

from __future__ import annotations

import functools
import importlib.util
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from benchmarks import ROOT

STORED = Path(__file__).with_name("references.json")
"""References that take minutes; `python -m benchmarks.race.race --references` makes them anew."""
GRAVITY = 9.81

# The bar: length m, EA N, rhoA kg/m, and the force N that pulls its end from t = 0 on.
BAR = {"length": 1.0, "EA": 1000.0, "rhoA": 1.0, "force": 1.0}
# The catenary: length and span m, EA N, EJ N m^2, rhoA kg/m. One end moves outwards by 1 - cos(pi t) m.
CATENARY = {"length": 110.0, "span": 100.0, "EA": 1.0e7, "EJ": 10.0, "rhoA": 5.0}
FLOW = 5.0
"""Speed of the flowing rope, m/s of unstretched rope: a quarter of that of waves along it."""
TENTHS = 10
"""Parts of the catenary, between which its nodes are compared."""
# The rope over a sheave: where it is held, radius m, EA N, load kg, where the load is let go. x, z of space.
SHEAVE = {"wall": (-10.0, 0.0), "radius": 0.5, "EA": 1.0e7, "mass": 1000.0, "load": (3.0, -10.0)}
ROPE_OF_SHEAVE = 1.0e-6
"""Mass per length of Tautline's rope, kg/m, which must have one: 2e-8 of the load in all."""


@dataclass(frozen=True)
class Case:
    """One scene with one mesh and one step, as both programs run it.

    Attributes
    ----------
    scene : str
        bar, catenary, flowing, hose or sheave.
    elements : int
        Elements of the mesh; of the sheave, which has none, spans.
    step, end : float
        Of the runs that are timed, s.
    judged, every : float
        End of the run whose error is measured, and the time between its samples, s.
    tolerance : float
        Of Tautline's Newton iterations, by its own criterion of the scene.
    relative, absolute : float
        Of Exudyn's: of the residual, over the first of a step, and N.
    rho_inf : float
        Spectral radius of generalized-alpha at infinity, of both.
    speed : float
        Of the flow, m/s.
    rounds : int
        Repetitions after one that warms up.
    """

    scene: str
    elements: int
    step: float
    end: float
    judged: float
    every: float
    tolerance: float
    relative: float
    absolute: float
    rho_inf: float = 0.8
    speed: float = 0.0
    rounds: int = 5

    @property
    def steps(self) -> int:
        """Steps of the runs that are timed."""
        return round(self.end / self.step)

    @property
    def times(self) -> np.ndarray:
        """Times at which the error is looked at, s."""
        return self.every * np.arange(1, round(self.judged / self.every) + 1)

    @property
    def name(self) -> str:
        """What tells it from other cases."""
        flow = f", {self.speed:g} m/s" if self.scene == "hose" else ""
        return f"{self.scene}{flow}, {self.elements} elements, {1000.0 * self.step:g} ms"


def cases(quick: bool) -> list[Case]:
    """What is raced. A quick race is the same with few elements, short runs and one repetition."""
    if quick:
        return [
            Case("bar", 4, 1e-3, 0.5, 0.1, 0.01, 1e-6, 1e-6, 1e-8, rounds=1),
            Case("catenary", 20, 1e-2, 0.2, 0.2, 0.1, 1e-6, 1e-6, 1e-4, rounds=1),
            Case("flowing", 20, 1e-2, 0.2, 0.2, 0.1, 1e-6, 1e-6, 1e-4, rounds=1, speed=FLOW),
            Case("hose", 10, 1e-3, 0.2, 0.1, 0.02, 1e-4, 1e-6, 1e-8, 0.9, 15.0, rounds=1),
            Case("sheave", 2, 5e-3, 1.0, 1.0, 0.1, 1e-6, 1e-6, 1e-6, rounds=1),
        ]
    # So many steps that a run takes some tenths of a second. Where one takes many seconds there are fewer repetitions.
    # Tolerances are powers of ten, and for each program the loosest of which a tenth moves its run by less than a tenth
    # of its error, and with which the run comes to its end: the table shows it. Tautline's is at most a tenth.
    bars = [Case("bar", n, 1e-3, 160.0 / n, 0.5, 0.01, 1e-3, 1e-3, 1e-5) for n in (1, 4, 16, 64)]
    ropes = []
    for scene, speed, end, own in (("catenary", 0.0, 2.0, 1e-3), ("flowing", FLOW, 0.2, 1e-2)):
        ropes += [
            Case(scene, 100, 1e-3, 2.0, 2.0, 0.1, 1e-1, 1e-3, 1e-3, speed=speed),
            Case(scene, 100, 1e-2, 2.0, 2.0, 0.1, 1e-1, 1e-3, 1e-2, speed=speed),
            Case(scene, 1000, 1e-3, end, end, 0.1, own, 1e-4, 1e-3, speed=speed, rounds=3),
            Case(scene, 1000, 1e-2, end, end, 0.1, 1e-1, 1e-3, 1e-2, speed=speed, rounds=3),
        ]
    hoses = [
        Case("hose", 10, 1e-3, 2.0, 1.0, 0.02, own, relative, 1e-3 * relative, 0.9, speed)
        for speed, own, relative in ((15.0, 1e-5, 1e-4), (25.0, 1e-4, 1e-3), (35.0, 1e-2, 1e-2))
    ]
    sheaves = [
        Case("sheave", 2, 1e-3, 50.0, 10.0, 0.1, 1e-6, 1e-6, 1e-5),
        Case("sheave", 2, 5e-3, 50.0, 10.0, 0.1, 1e-4, 1e-4, 1e-3),
    ]
    return [*bars, *ropes, *hoses, *sheaves]


# ----------------------------------------------------------------------------------------------------------------------
# Tautline's side
# ----------------------------------------------------------------------------------------------------------------------
def text(case: Case, end: float, every: float) -> str:
    """The scene in Tautline's syntax, with so long a run and frames so far apart, s."""
    write = {"bar": _bar, "catenary": _rope, "flowing": _rope, "hose": _hose, "sheave": _sheave}
    return write[case.scene](case, end, every)


def build(case: Case, written: str) -> Any:
    """Tautline's model of a text."""
    # Imported here, so that the tables can be written and tested without a compiler.
    from tautline.scene.model import validate
    from tautline.scene.reading.document import Document

    if case.scene == "hose":
        from gardenhose.build import build as build_hose
        from gardenhose.scene import HoseScene

        return build_hose(validate(HoseScene, Document.parse(written)))
    if case.scene == "sheave":
        from crane.model.build import build as build_crane
        from crane.scene.scene import CraneScene

        return build_crane(validate(CraneScene, Document.parse(written)))
    from tautline.cable.input.scene import parse
    from tautline.cable.model.build import build as build_cable

    return build_cable(parse(written))


def points(case: Case, result: Any) -> np.ndarray:
    """Places that are compared, without the first frame: (time, point, 2), m."""
    if case.scene == "hose":
        found = result["tip"][1:, None]
    elif case.scene == "sheave":
        found = result["body_position"][1:]
    else:
        found = result["position"][1:, watched(case)]
    return np.asarray(found)[..., [0, 2]]


def watched(case: Case) -> list[int]:
    """Nodes that are compared."""
    if case.scene in ("catenary", "flowing"):
        return [case.elements * tenth // TENTHS for tenth in range(1, TENTHS)]
    return [case.elements]


def _bar(case: Case, end: float, every: float) -> str:
    n, length = case.elements, BAR["length"]
    items = [
        f"Node7Dof: {{id: {i}, xyz: [{length * i / n!r}, 0, 0], xyz_d: [1, 0, 0], "
        f"BC: [{int(i == 0)}, 1, 1, 0, 1, 1, 1]}}"
        for i in range(n + 1)
    ]
    items += [_element(i, BAR["EA"], 0.0, BAR["rhoA"]) for i in range(n)]
    items.append(f"PointForce: {{id: 0, nodes7: [{n}], force: [{BAR['force']}, 0, 0], timeInterval: [0, 1e9]}}")
    return _cable(items, 0.0, case, end, every)


def _rope(case: Case, end: float, every: float) -> str:
    n, flowing = case.elements, case.scene == "flowing"
    place, slope, p = rope_start(n, case.speed)
    items = []
    for i in range(n + 1):
        held = int(i in (0, n))
        # All material flows at one rate: the first node's p is driven, the others follow.
        functions = [int(i == n), 0, 0, 0, 0, 0, 2 * int(flowing and i == 0)]
        items.append(
            f"Node7Dof: {{id: {i}, xyz: [{place[i][0]!r}, 0, {place[i][1]!r}], xyz_d: [{slope[i][0]!r}, 0, "
            f"{slope[i][1]!r}], BC: [{held}, {held}, {held}, 0, 0, 0, {int(not flowing or i == 0)}], p: {p[i]!r}, "
            f"BC_functions: {functions}}}"
        )
    items += [_element(i, CATENARY["EA"], CATENARY["EJ"], CATENARY["rhoA"]) for i in range(n)]
    swing = f"{{amplitude: 1.0, period: 2.0, phase: {-0.5 * np.pi!r}, mean: {place[n][0] + 1.0!r}}}"
    items.append(f"Function: {{id: 1, value: {{harmonic: {swing}}}}}")
    if flowing:
        # Material that moves towards the last node takes p down at a fixed place.
        rate = f"velocityList: [{-case.speed!r}, {-case.speed!r}]"
        items.append(f"Function_VelocityDefined: {{id: 2, pos0: 0, timeList: [0, 1e9], {rate}}}")
        items += [
            f"LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {p[i]!r}, masters: [{{mNode: 0, mDof: 7, factor: 1}}]}}"
            for i in range(1, n + 1)
        ]
    return _cable(items, -GRAVITY, case, end, every)


def _element(i: int, EA: float, EJ: float, rhoA: float) -> str:
    return (
        f"CableALEelement: {{id: {i}, nodes7: [{i}, {i + 1}], EA: {EA!r}, EJ: {EJ!r}, rhoA: {rhoA!r}, "
        "strain: engineering}"
    )


def _cable(items: Sequence[str], gravity: float, case: Case, end: float, every: float) -> str:
    listed = "".join(f"  - {item}\n" for item in items)
    return (
        f"CableModelMaterial: {{Gravity: [0, 0, {gravity}]}}\nCableModel:\n{listed}"
        f"GeneralizedAlpha: {{type: G-alpha, rho_inf: {case.rho_inf}, eps_energy: {case.tolerance!r}, "
        f"time_step: {case.step!r}, time_end: {end!r}, plotpoints: {1.0 / every!r}}}\n"
    )


def _hose(case: Case, end: float, every: float) -> str:
    from tautline.scene.reading.document import Document

    changes = {
        "hose.elements": case.elements,
        "hose.strain": "engineering",  # the peer's only one
        "water.speed": case.speed,
        "solver.step": case.step,
        "solver.end": end,
        "solver.rho_inf": case.rho_inf,
        "solver.tolerance": case.tolerance,
        "output.interval": every,
    }
    return Document.read(ROOT / "data" / "hose.yaml").changed(changes, "race").told


def hose_numbers() -> tuple[dict[str, float], dict[str, float]]:
    """What `data/hose.yaml` says of hose and water, SI."""
    from tautline.scene.reading.document import Document

    root = Document.read(ROOT / "data" / "hose.yaml").root
    return root["hose"], root["water"]


def _sheave(case: Case, end: float, every: float) -> str:
    (x, z), (a, b) = SHEAVE["load"], SHEAVE["wall"]
    return f"""
rope: {{mass_per_length: {ROPE_OF_SHEAVE!r}, axial_stiffness: {SHEAVE["EA"]!r}, damping: 0, length: {rope_length()!r}}}
bodies: [{{name: load, mass: {SHEAVE["mass"]}, position: [{x}, 0, {z}]}}]
path:
  - anchor: {{name: wall, position: [{a}, 0, {b}]}}
  - sheave: {{name: wheel, center: [0, 0, 0], radius: {SHEAVE["radius"]}, axis: [0, 1, 0], wrap: over}}
  - end: {{name: hook, body: load}}
mesh: {{elements_per_span: 1}}
start: as drawn
solver: {{method: generalized-alpha, rho_inf: {case.rho_inf}, step: {case.step!r}, end: {end!r}, control: fixed,
         tolerance: {case.tolerance!r}}}
output: {{interval: {every!r}}}
"""


# ----------------------------------------------------------------------------------------------------------------------
# where both begin
# ----------------------------------------------------------------------------------------------------------------------
def rope_start(elements: int, speed: float = 0.0) -> tuple[list[list[float]], list[list[float]], list[float]]:
    """The rope at rest: places and slopes (x, z) of its nodes, m and 1, and their material coordinates, m.

    Where it flows with the speed u, the balance is that of a rope which hangs under N - rhoA u^2 lambda in place of
    the axial force N. With N = EA (lambda - 1) this is the elastic catenary of the span over k, and k times as large,
    k = 1/(1 - rhoA u^2/EA). Bending is left out: sqrt(EJ/H) is 6 cm.
    """
    c = CATENARY
    weight, k = c["rhoA"] * GRAVITY, 1.0 / (1.0 - c["rhoA"] * speed**2 / c["EA"])
    line = _module("cables").catenary(c["span"] / k, 0.0, c["length"], c["EA"], weight)
    p = np.linspace(0.0, c["length"], elements + 1)
    tension = line.tension(p)
    along = np.stack([np.full_like(p, line.horizontal), line.vertical + weight * p], 1) / tension[:, None]
    slope = (k * (1.0 + tension / c["EA"]))[:, None] * along
    return (k * line.shape(p).T).tolist(), slope.tolist(), p.tolist()


def path_over_sheave(place: Sequence[float]) -> tuple[float, np.ndarray]:
    """Length of a taut rope from the wall over the sheave to a place x, z; and where it leaves the sheave; m."""
    R, wall, load = SHEAVE["radius"], np.array(SHEAVE["wall"]), np.asarray(place, dtype=float)
    far, near = np.hypot(*wall), np.hypot(*load)
    comes = np.arctan2(wall[1], wall[0]) - np.arccos(R / far)
    goes = np.arctan2(load[1], load[0]) + np.arccos(R / near)
    arc = R * ((comes - goes) % (2.0 * np.pi))
    straight = np.sqrt(far**2 - R**2) + np.sqrt(near**2 - R**2)
    return float(straight + arc), R * np.array([np.cos(goes), np.sin(goes)])


def rope_length() -> float:
    """Unstretched length of the rope over the sheave, m: at the start it carries the weight of the load."""
    return path_over_sheave(SHEAVE["load"])[0] / (1.0 + SHEAVE["mass"] * GRAVITY / SHEAVE["EA"])


# ----------------------------------------------------------------------------------------------------------------------
# what both are judged by
# ----------------------------------------------------------------------------------------------------------------------
def reference(case: Case, ours: bool) -> np.ndarray | None:
    """Exact or converged places (time, point, 2), m, by the law of the program; None where there is none stored."""
    if case.scene == "bar":
        return bar_exact(case.elements, case.times)
    if case.scene == "sheave":
        return sheave_exact(case.times, "green" if ours else "engineering")
    stored = json.loads(STORED.read_text(encoding="utf8")) if STORED.exists() else {}
    found = stored.get(reference_name(case, ours))
    if found is None:
        return None
    at = np.searchsorted(found["times"], case.times - 1e-9)
    return np.array(found["points"])[at]


def reference_name(case: Case, ours: bool) -> str:
    """Key of a stored reference: the laws of curvature of both programs differ, which only the hose shows."""
    if case.scene == "hose":
        return f"hose {case.speed:g} m/s, {'geometric' if ours else 'material'} curvature"
    return case.scene


def error(found: np.ndarray, exact: np.ndarray | None) -> float | None:
    """Largest distance of any place at any time, m."""
    return None if exact is None else float(np.linalg.norm(found - exact, axis=-1).max())


def bar_exact(elements: int, times: np.ndarray) -> np.ndarray:
    """The bar's end: exact motion of the same cubic mesh, by its modes; (time, 1, 2), m.

    With engineering strain the bar is linear, M x'' + K x = f, and its error is the time integration's alone.
    """
    L = BAR["length"] / elements
    mass = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0
    stiff = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]]) / 30.0
    units = np.outer(*2 * [np.array([1.0, L, 1.0, L])])
    M, K = (np.zeros((2 * elements + 2,) * 2) for _ in range(2))
    for i in range(elements):
        own = slice(2 * i, 2 * i + 4)
        M[own, own] += BAR["rhoA"] * L * mass * units
        K[own, own] += BAR["EA"] / L * stiff * units
    squares, shapes = eigh(K[1:, 1:], M[1:, 1:])
    end = shapes[-2]
    moved = (end**2 * BAR["force"] / squares * (1.0 - np.cos(np.outer(times, np.sqrt(squares))))).sum(1)
    return np.stack([BAR["length"] + moved, np.zeros_like(moved)], -1)[:, None]


def sheave_exact(times: np.ndarray, strain: str) -> np.ndarray:
    """The load on a rope without mass over a sheave without friction: two equations, to 1e-12; (time, 1, 2), m."""
    EA, mass, free = SHEAVE["EA"], SHEAVE["mass"], rope_length()

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        length, leaves = path_over_sheave(y[:2])
        stretch = length / free
        force = EA * (stretch - 1.0) if strain == "engineering" else 0.5 * EA * stretch * (stretch**2 - 1.0)
        along = (y[:2] - leaves) / np.linalg.norm(y[:2] - leaves)
        return np.concatenate([y[2:], -force / mass * along - [0.0, GRAVITY]])

    start = [*SHEAVE["load"], 0.0, 0.0]
    found = solve_ivp(rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return found.y[:2].T[:, None]


def hose_exact(speed: float, material: bool, times: np.ndarray, modes: int) -> np.ndarray:
    """The hose's tip by global polynomials, without finite elements; (time, 1, 2), m."""
    module = _module("hose")
    kind = _material_hose() if material else module.Hose
    hose = kind(module.Parameters(strain="engineering"), modes)
    return np.asarray(module.simulate(hose, speed, times, 1e-9).tip)[:, None]


@functools.cache
def _material_hose() -> Any:
    """The reference's hose with theta' per unstretched length for a curvature, (x' z'' - z' x'')/|r'|^2."""

    class MaterialHose(_module("hose").Hose):
        @staticmethod
        def _curvature(p: np.ndarray, second: bool = True) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
            x, z, xx, zz = p
            inverse, C, zero = 1.0 / (x**2 + z**2), x * zz - z * xx, 0.0 * x
            c, a = np.array([zz, -xx, -z, x]), np.array([x, z, zero, zero])
            gradient = inverse * (c - 2.0 * C * inverse * a)
            if not second:
                return C * inverse, gradient, None
            ca = c[:, None] * a[None]
            hessian = 8.0 * C * inverse**2 * a[:, None] * a[None] - 2.0 * inverse * (ca + ca.transpose(1, 0, 2))
            for i, j, part in ((0, 0, -2.0 * C * inverse), (1, 1, -2.0 * C * inverse), (0, 3, 1.0), (3, 0, 1.0),
                               (1, 2, -1.0), (2, 1, -1.0)):  # fmt: skip
                hessian[i, j] += part
            return C * inverse, gradient, inverse * hessian

    return MaterialHose


@functools.cache
def _module(name: str) -> ModuleType:
    """A module of tests/references, which share nothing with Tautline, by its path: it is in no package."""
    spec = importlib.util.spec_from_file_location(f"race_{name}", ROOT / "tests" / "references" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module
