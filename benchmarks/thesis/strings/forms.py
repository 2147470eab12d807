"""The string of the thesis' Table 2.3 at rest, by lumps and by ALE-ANCF elements (section 2.9.4)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

import tautline
from benchmarks import jwell
from benchmarks.thesis.strings.rod import CASES, GRAVITY, LENGTH, TUBES, WHERE, Curve
from drillstring.model.build import build as build_string
from drillstring.scene.scene import DrillstringScene
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build as build_cable
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.time_loop import new_frames
from tautline.system.model import Model

TOLERANCE = 1e-14
"""Residual at rest over the scale of forces: rounding decides. Configuration A weighs 0.4 N, and EA is 680 MN."""


class Mesh(NamedTuple):
    """A cable of elements no longer than ``longest`` m; ``apart`` gives pipe and collar slopes of their own.

    Pipe and collar carry the same force and stretch by different amounts, so where they share a slope r' both are
    wrong about it. Apart, the two nodes at 880 m are tied in position and in the slope across the string.
    """

    longest: float
    apart: bool = False
    strain: str = "green"

    @property
    def counts(self) -> tuple[int, int]:
        """Elements of pipe and collar."""
        pipe, collar = (math.ceil(tube.length / self.longest - 1e-9) for tube in TUBES)
        return pipe, collar

    @property
    def places(self) -> list[float]:
        """Unstretched distance of each node from the first, m."""
        pipe, collar = self.counts
        joint = TUBES[0].length
        first, second = np.linspace(0.0, joint, pipe + 1), np.linspace(joint, LENGTH, collar + 1)
        return [float(x) for x in np.concatenate([first, second if self.apart else second[1:]])]

    @property
    def elements(self) -> list[tuple[int, int]]:
        """First node and tube of each element."""
        pipe, collar = self.counts
        first = pipe + 1 if self.apart else pipe
        return [(i, 0) for i in range(pipe)] + [(first + i, 1) for i in range(collar)]


def cable_text(mesh: Mesh, gravity: float, force: float = 0.0, level: bool = True, **solver: Any) -> str:
    """A scene in the syntax of the thesis' Appendix A: the string level on two pins, or hanging by its first node.

    ``solver`` goes into its last item. The string lies in the plane of x and z; hanging, it is a bar without bending.
    """
    places, last = mesh.places, len(mesh.places) - 1
    along = [1.0, 0.0, 0.0] if level else [0.0, 0.0, -1.0]
    items = []
    for i, p in enumerate(places):
        held = [0, 1, 0, 0, 1, 0, 1] if level else [1, 1, 0, 1, 1, 0, 1]
        if i == 0:
            held[:3] = [1, 1, 1]
        elif i == last and level:
            held[2] = 1
        items.append(f"Node7Dof: {{id: {i}, xyz: {[p * c for c in along]}, xyz_d: {along}, BC: {held}, p: {p}}}")
    for number, (first, kind) in enumerate(mesh.elements):
        tube = TUBES[kind]
        bending = tube.bending if level else 0.0
        items.append(
            f"CableALEelement: {{id: {number}, nodes7: [{first}, {first + 1}], EA: {tube.axial!r}, EJ: {bending!r}, "
            f"rhoA: {tube.mass!r}, strain: {mesh.strain}}}"
        )
    if mesh.apart:
        left = mesh.counts[0]
        items.append(f"LagMultipl7: {{id: 0, nodes7: [{left}, {left + 1}], constr: 0}}")
        if level:
            masters = f"[{{mNode: {left}, mDof: 6, factor: 1}}]"
            items.append(f"LinearCoupl: {{id: 1, sNode: {left + 1}, sDof: 6, f0: 0, masters: {masters}}}")
    if force:
        items.append(f"PointForce: {{id: 0, nodes7: [{last}], force: [{force!r}, 0, 0], timeInterval: [0, 1.0e+6]}}")
    settings = {"type": "G-alpha", "rho_inf": 0.8, "time_step": 0.01, "time_end": 1.0, "plotpoints": 10} | solver
    written = ", ".join(f"{key}: {value}" for key, value in settings.items())
    return (
        f"CableModelMaterial: {{Gravity: [0, 0, {-gravity!r}]}}\nCableModel:\n"
        + "".join(f"  - {item}\n" for item in items)
        + f"GeneralizedAlpha: {{{written}}}\n"
    )


def at_rest(model: Model) -> dict[str, np.ndarray]:
    """The variables of a model in static equilibrium, without time."""
    system = model.system
    state = new_state(system)
    find_equilibrium(system, state, model.step_limit, TOLERANCE)
    frames = new_frames(1, system.q.size, model.own)
    frames.q[0], frames.residual[0] = state.full_q, state.residual
    return {name: values[0] for name, values in model.observe(frames).items()}


def along_elements(mesh: Mesh, position: np.ndarray, slope: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Where the points s (n,) m of the unstretched string are (..., n, 3), from nodes (..., m, 3): Hermite's cubics."""
    places = np.array(mesh.places)
    firsts = np.array([first for first, _ in mesh.elements])
    a = firsts[np.clip(np.searchsorted(places[firsts], s, side="right") - 1, 0, firsts.size - 1)]
    length = places[a + 1] - places[a]
    x = (s - places[a]) / length
    shapes = (1 - 3 * x**2 + 2 * x**3, length * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, length * (x**3 - x**2))
    nodes = (position[..., a, :], slope[..., a, :], position[..., a + 1, :], slope[..., a + 1, :])
    return sum(shape[:, None] * node for shape, node in zip(shapes, nodes, strict=True))


def level_cable(name: str, mesh: Mesh) -> Curve:
    """A configuration at rest by ALE-ANCF, at `WHERE`."""
    found = at_rest(build_cable(parse(cable_text(mesh, *CASES[name]))))
    r = along_elements(mesh, found["position"], found["slope"], WHERE)
    return Curve(WHERE, r[:, 0], r[:, 2])


def hanging_cable(mesh: Mesh, s: np.ndarray) -> np.ndarray:
    """How far the points s (n,) of the hanging string go down by ALE-ANCF, m."""
    found = at_rest(build_cable(parse(cable_text(mesh, GRAVITY, level=False))))
    return -along_elements(mesh, found["position"], found["slope"], s)[:, 2] - s


def string_scene(name: str, **keys: Any) -> DrillstringScene:
    """A scene of ``data/`` with other values; ``keys`` have two underscores for a dot."""
    scene = tautline.read(jwell.ROOT / "data" / f"{name}.yaml")
    return scene.replace({key.replace("__", "."): value for key, value in keys.items()})


def lumps(name: str, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Unstretched distances (n,) and positions (n, 3) north, east, down of a string's lumps at rest, m."""
    model = build_string(string_scene(name, model__elements=elements))
    return np.asarray(model.coordinates["unstretched_depth"][1]), at_rest(model)["position"]


def level_lumps(name: str, elements: int) -> Curve:
    """A configuration at rest by lumps."""
    s, position = lumps(f"configuration_{name.lower()}", elements)
    return Curve(s, position[:, 0], -position[:, 2])


def hanging_lumps(elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Unstretched distances and ways down (n,) of the hanging string's lumps, m."""
    s, position = lumps("hanging", elements)
    return s, position[:, 2] - s


def lumps_of_whole_elements(s: np.ndarray) -> np.ndarray:
    """How far lumps at s (n,) would go down, m, if each had the mass of the whole element above it: for comparison."""
    tubes = [TUBES[int(above >= TUBES[0].length)] for above in s[:-1]]
    lengths = np.diff(s)
    weights = GRAVITY * lengths * np.array([tube.mass for tube in tubes])
    tensions = np.cumsum(weights[::-1])[::-1]
    return np.concatenate([[0.0], np.cumsum(tensions * lengths / np.array([tube.axial for tube in tubes]))])
