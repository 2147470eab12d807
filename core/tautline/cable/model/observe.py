"""What a run's frames mean in a cable scene: variables, units, headline figures."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautline.application.modelling import energies_of, energy_variables
from tautline.cable.input.parts import CableScene
from tautline.cable.model.bending_force import BendingForce
from tautline.cable.model.layout import Layout
from tautline.cable.model.sections import Sections
from tautline.cable.model.ties import WORDS
from tautline.constraints.multiplier import Multipliers
from tautline.elements.apart import Apart
from tautline.kernels.hermite import FIRST, SECOND, THIRD, table
from tautline.results.variable import Variable, at_start, late_start

FIGURES = {"axial_force_max": "N", "axial_force_min": "N", "displacement_max": "m", "speed_max": "m/s"}
"""Figures of a run and their units, of which a scene may set limits."""
GAP = {"tie_gap_max": "m"}
"""The same of a scene with penalty springs between r or p."""
ANGLE = {"tie_angle_max": "rad"}
"""The same of a scene with penalty springs between slopes."""
EXTREMES = {"(axial_force|displacement|speed|tie_gap|tie_angle)_max": "largest", "axial_force_min": "smallest"}
"""Those that are extremes over the frames, and of which kind."""
FRAMES = 256
"""Whose gaps are found at once: of all together they would take as much memory as the variable itself."""
SLOPES = WORDS[2]
"""How the name of an equation between slopes begins."""
SHORTEST_SLOPE = 1.0e-90
"""Slope below which a curve has no direction, and no curvature to speak of."""


AXIAL = "axial force of the section, of strain and bending, in the middle of an element, with damping"
AT_ENDS = "axial force at both ends of an element, by the balance of its stresses with its inertia and loads"
STILL = 1.0e-6
"""Share of the largest force of a frame by inertia, up to which an element counts as one at rest."""


TIE = "of a tie on its first node, along the global axis that is named; its opposite on the second"


def _multipliers(observer: Observer) -> list[Variable]:
    """Of an equation between r or p a force, N; of one between r' a moment, N m, as r' has no unit."""
    force = Variable("multiplier", ("time", "constraint"), "N", f"force {TIE}")
    moment = Variable("multiplier_moment", ("time", "slope_constraint"), "N m", f"moment {TIE}")
    return [one for one, some in ((force, ~observer.turning), (moment, observer.turning)) if some.any()]


def variables(observer: Observer) -> list[Variable]:
    """Everything that is stored, with units."""
    node, element = ("time", "node"), ("time", "element")
    slopes = [Variable("slope", (*node, "axis"), "", "slope dr/dp; zero at nodes of linear elements")]
    curved = [Variable("curvature", element, "1/m", "curvature in the middle of an element")]
    return [
        Variable("position", (*node, "axis"), "m", "position"),
        *(slopes if observer.cubic_nodes.size else []),
        Variable("material_coordinate", node, "m", "material coordinate p"),
        Variable("velocity", (*node, "axis"), "m/s", "velocity"),
        Variable("material_velocity", node, "m/s", "rate of the material coordinate"),
        Variable("axial_force", element, "N", AXIAL),
        Variable("end_force", (*element, "end"), "N", AT_ENDS),
        *(curved if observer.cubic_nodes.size else []),
        *_multipliers(observer),
        *energy_variables(
            ", of springs too",
            " of weight and loads",
            "damping",
            "of forces and prescribed motion, and energy that material brings in",
        ),
    ]


class Observer:
    """Turns frames into variables; all of it vectorised over the frames of a batch."""

    def __init__(self, layout: Layout, sections: Sections, groups: tuple[Any, ...], names: list[str]) -> None:
        scene = layout.scene
        self.names = np.array(names, dtype=str)
        self.turning = np.array([name.startswith(SLOPES) for name in names], dtype=bool)
        self.multipliers = next((g for g in groups if isinstance(g, Multipliers)), None)
        self.ids = np.array([node.id for node in scene.nodes])
        self.element_ids = np.array([e.id for e in scene.elements])
        self.start, self.material = layout.starts, layout.lasts
        self.cubic_nodes = np.array([i for i, node in enumerate(scene.nodes) if node.kind == 7], dtype=int)
        self.ends = layout.ends
        self.cubic = np.array([e.kind == "cubic" for e in scene.elements])
        self.sections = sections
        self.engineering = np.array([e.strain == "engineering" for e in scene.elements])
        self.slack = np.array([not e.compression for e in scene.elements])
        self.bending = BendingForce(layout, scene.elements)
        self.middle = table(np.array([0.5]), np.ones(1))[0]
        sizes = np.where(self.cubic, 7, 4)
        self.apart = Apart(sections.members, layout.starts[layout.ends], sizes, list(layout.flow.values()))
        self.carrier = carriers(scene)
        self.as_given = scene.solver.start == "as given"

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        named = {}
        for dim, some in (("constraint", ~self.turning), ("slope_constraint", self.turning)):
            if some.any():
                named[dim] = (dim, self.names[some], "", "equation")
        return {
            "node": ("node", self.ids, "", "node's id in the scene"),
            "element": ("element", self.element_ids, "", "element's id in the scene"),
            "axis": ("axis", np.array(["x", "y", "z"]), "", "axis"),
            "end": ("end", np.array(["first end", "last end"]), "", "end of an element"),
            **named,
        }

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        three = np.arange(3)
        q, v = frames.q, frames.v
        made = {
            "position": q[:, self.start[:, None] + three],
            "material_coordinate": q[:, self.material],
            "velocity": v[:, self.start[:, None] + three],
            "material_velocity": v[:, self.material],
        }
        slope, slope_rate = np.zeros_like(made["position"]), np.zeros_like(made["position"])
        places = self.start[self.cubic_nodes][:, None] + 3 + three
        slope[:, self.cubic_nodes], slope_rate[:, self.cubic_nodes] = q[:, places], v[:, places]
        made["axial_force"], curvature = self._forces(made, slope, slope_rate)
        made["end_force"] = self._at_ends(frames, made["position"], slope)
        if self.as_given:
            self._begin_without_ripple(frames, made)
        if self.cubic_nodes.size:
            made["slope"], made["curvature"] = slope, curvature
        if self.multipliers is not None:
            forces = frames.a[:, self.multipliers.unknown] * self.multipliers.weight
            for name, some in (("multiplier", ~self.turning), ("multiplier_moment", self.turning)):
                if some.any():
                    made[name] = forces[:, some]
        return made | energies_of(frames)

    def _forces(
        self, made: dict[str, np.ndarray], slope: np.ndarray, slope_rate: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Axial force (m, elements) N and curvature 1/m in the middle of elements."""
        i, j = self.ends.T
        p, rate = made["material_coordinate"], made["material_velocity"]
        length = (p[:, j] - p[:, i])[..., None]
        grown, u = (rate[:, j] - rate[:, i])[..., None], 0.5 * (rate[:, i] + rate[:, j])[..., None]
        ends = [made["position"][:, i], slope[:, i], made["position"][:, j], slope[:, j]]
        rates = [made["velocity"][:, i], slope_rate[:, i], made["velocity"][:, j], slope_rate[:, j]]
        first, second = self.middle[FIRST : FIRST + 4], self.middle[SECOND : SECOND + 4]
        e, by_l = self._middle(first, ends, length, 1), -(first[0] * ends[0] + first[2] * ends[2]) / length**2
        turn = self._middle(second, ends, length, 2)
        straight, moved = (ends[2] - ends[0]) / length, (rates[2] - rates[0]) / length
        linear = ~self.cubic
        e[:, linear], by_l[:, linear], turn[:, linear] = straight[:, linear], (-straight / length)[:, linear], 0.0
        e_d = self._middle(first, rates, length, 1)
        e_d[:, linear] = moved[:, linear]
        e_d = e_d + grown * by_l - u * turn
        square = (e**2).sum(axis=-1)
        size = np.sqrt(square)
        factor = np.where(self.engineering, 1.0 / np.maximum(size, 1e-300), 1.0)
        numbers = self.sections.numbers()
        strain = np.where(self.engineering, size - 1.0, 0.5 * (square - 1.0))
        stress = strain + numbers.damping * factor * (e * e_d).sum(axis=-1)
        force = np.where(self.slack & (strain < 0.0), 0.0, numbers.stiffness * stress * factor * size)
        if (bent := self.bending.elements).size:
            # It is of use to damping alone, and as much work as all of the above.
            turned = turn
            if numbers.viscosity.any():
                turned = self._middle(second, rates, length, 2) + self._carried(ends, turn, length, grown, u)
            force[:, bent] += self.bending.of(
                e[:, bent], e_d[:, bent], turn[:, bent], turned[:, bent], numbers.bending[bent], numbers.viscosity[bent]
            )
        across = np.linalg.norm(np.cross(e, turn), axis=-1)
        return force, across / np.maximum(size, SHORTEST_SLOPE) ** 3

    def _at_ends(self, frames: Any, position: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """Axial force (m, elements, 2) N at both ends of elements, by the balance of each."""
        i, j = self.ends.T
        chord = position[:, j] - position[:, i]
        along = np.where(self.cubic[:, None, None], slope[:, self.ends], chord[:, :, None])
        along = along / np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), SHORTEST_SLOPE)
        # What holds the first end of an element pulls backwards there.
        force = (self.apart.forces(frames) * along).sum(axis=-1) * np.array([-1.0, 1.0])
        whole = np.zeros_like(force)
        index: Any = (slice(None), self.carrier)
        np.add.at(whole, index, force)
        stiff = self.sections.numbers().stiffness > 0.0
        # What takes no push lets the weight of a slack end lie on what is beyond it.
        return np.where(stiff[:, None] & ~(self.slack[:, None] & (whole < 0.0)), whole, 0.0)

    def _begin_without_ripple(self, frames: Any, made: dict[str, np.ndarray]) -> None:
        """Give elements that are accelerated as a run begins as given the force of their middle at both ends.

        What comes at once has reached no section then. Consistent masses spread it over all nodes, by turns forwards
        and backwards, and the balance of an element with them is that ripple. One at rest keeps its balance.
        """
        for k in np.flatnonzero(frames.time == 0.0):
            first = frames._replace(**{name: getattr(frames, name)[k : k + 1] for name in ("time", "q", "v", "a")})
            whole = self.apart.forces(first)
            inert = np.abs(whole - self.apart.forces(first._replace(a=np.zeros_like(first.a)))).max(axis=(0, 2, 3))
            moved = (inert > STILL * np.abs(whole).max(initial=0.0)) & (self.sections.numbers().stiffness > 0.0)
            made["end_force"][k, moved] = made["axial_force"][k, moved, None]

    def _carried(
        self, ends: list[np.ndarray], turn: np.ndarray, length: np.ndarray, grown: np.ndarray, u: np.ndarray
    ) -> np.ndarray:
        """Rate of r'' of the particle in the middle that comes of material which moves through the nodes."""
        second, third = self.middle[SECOND : SECOND + 4], self.middle[THIRD : THIRD + 4]
        by_length = (second[1] * ends[1] + second[3] * ends[3]) / length**2 - 2.0 * turn / length
        return grown * by_length - u * self._middle(third, ends, length, 3)

    @staticmethod
    def _middle(shape: np.ndarray, x: list[np.ndarray], length: np.ndarray, order: int) -> np.ndarray:
        """Derivative by p of an order in the middle of cubic elements."""
        parts = [shape[0] * x[0], length * shape[1] * x[1], shape[2] * x[2], length * shape[3] * x[3]]
        return (parts[0] + parts[1] + parts[2] + parts[3]) / length**order


def carriers(scene: CableScene) -> np.ndarray:
    """Which element bears what one weighs (elements,): itself, or where it has no EA one that has, along its curve."""
    stiff: dict[tuple[int, ...], int] = {}
    for k, element in enumerate(scene.elements):
        if element.EA > 0.0:
            stiff.setdefault(tuple(element.nodes), k)
    return np.array(
        [k if e.EA > 0.0 else stiff.get(tuple(e.nodes), k) for k, e in enumerate(scene.elements)], dtype=int
    )


def figure_units(scene: CableScene) -> dict[str, str]:
    """Figures that a run of a scene has, and their units."""
    sprung = {tie.what for tie in scene.ties if tie.method == "penalty"}
    return FIGURES | (GAP if sprung - {2} else {}) | (ANGLE if 2 in sprung else {})


def gap_of(result: Any, scene: CableScene) -> float | None:
    """Largest distance, m, by which penalty springs let positions or p differ; None without any.

    An axis on which both nodes are held has no spring: how far they are drawn apart there is no gap of one.
    """
    place = {node.id: i for i, node in enumerate(scene.nodes)}
    gaps = []
    for what, name in ((0, "position"), (1, "material_coordinate")):
        ties = [tie for tie in scene.ties if tie.method == "penalty" and tie.what == what]
        if not ties:
            continue
        # A variable is read from the file of a run each time it is asked for.
        values = np.asarray(result[name])
        first, second = np.array([[place[node] for node in tie.nodes] for tie in ties]).T
        sprung = _sprung(scene, first, second, what)
        offset = np.array([tie.offset for tie in ties]) if what == 0 else 0.0
        for begin in range(0, len(values), FRAMES):
            some = values[begin : begin + FRAMES]
            apart = np.where(sprung, some[:, second] - some[:, first] - offset, 0.0)
            gaps.append((np.linalg.norm(apart, axis=-1) if what == 0 else np.abs(apart)).max())
    return float(max(gaps)) if gaps else None


def angle_of(result: Any, scene: CableScene) -> float | None:
    """Largest angle, rad, by which penalty springs let slopes differ; None without any between slopes.

    Of an axis on which both nodes are held, the angle is as if they were held alike there: it has no spring.
    """
    place = {node.id: i for i, node in enumerate(scene.nodes)}
    ties = [tie for tie in scene.ties if tie.method == "penalty" and tie.what == 2]
    if not ties:
        return None
    values = np.asarray(result["slope"])
    first, second = np.array([[place[node] for node in tie.nodes] for tie in ties]).T
    sprung = _sprung(scene, first, second, 2)
    largest = 0.0
    for begin in range(0, len(values), FRAMES):
        one, other = values[begin : begin + FRAMES, first], values[begin : begin + FRAMES, second]
        other = np.where(sprung, other, one)
        across = np.linalg.norm(np.cross(one, other), axis=-1)
        largest = max(largest, float(np.arctan2(across, (one * other).sum(axis=-1)).max()))
    return largest


def _sprung(scene: CableScene, first: np.ndarray, second: np.ndarray, what: int) -> np.ndarray:
    """On which of the axes of r (0) or r' (2), (pairs, 3), or of p (1), (pairs,), at least one of two nodes is free."""
    if what == 1:
        free = ~np.array([node.held[-1] for node in scene.nodes])
    else:
        # A node of a linear element has no slope, and no tie has it.
        parts = [
            node.held[:3] if what == 0 else node.held[3:6] if node.kind == 7 else (True,) * 3 for node in scene.nodes
        ]
        free = ~np.array(parts)
    return free[first] | free[second]


def extreme_force(frames: Any, least: bool) -> np.ndarray:
    """Largest or least axial force (m, elements) N at either end or in the middle of each element."""
    both, middle = np.asarray(frames["end_force"]), np.asarray(frames["axial_force"])
    return np.minimum(both.min(axis=2), middle) if least else np.maximum(both.max(axis=2), middle)


def extremes(result: Any) -> tuple[float, float]:
    """Smallest and largest axial force of a run, N; of a file without `end_force`, in the middles of elements."""
    if "end_force" not in result:
        return float(result["axial_force"].min()), float(result["axial_force"].max())
    return float(extreme_force(result, True).min()), float(extreme_force(result, False).max())


def headline(result: Any, scene: CableScene) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up."""
    position = result["position"]
    least, most = extremes(result)
    moved, late = np.linalg.norm(position - at_start(result, "position"), axis=-1), late_start(result)
    since = f" since {late}" if late else ""
    figures = {
        "axial_force_max": (most, "N", "largest axial force"),
        "axial_force_min": (least, "N", "smallest axial force"),
        "displacement_max": (moved.max(), "m", f"largest displacement of a node{since}"),
        "speed_max": (np.linalg.norm(result["velocity"], axis=-1).max(), "m/s", "largest speed of a node"),
    }
    gap = gap_of(result, scene)
    if gap is not None:
        figures["tie_gap_max"] = gap, "m", "largest gap of penalty springs"
    angle = angle_of(result, scene)
    if angle is not None:
        figures["tie_angle_max"] = angle, "rad", "largest angle between slopes at penalty springs"
    return {name: {"value": float(value), "unit": unit, "text": text} for name, (value, unit, text) in figures.items()}
