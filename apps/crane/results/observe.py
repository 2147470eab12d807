"""What a run's frames mean in a crane scene: variables, units, headline figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from crane.assembly.friction import stands_still
from crane.assembly.layout import Layout
from crane.geometry.drum_layers import DrumLayers
from crane.geometry.line import COLUMNS
from crane.geometry.quaternion import QUATERNION
from crane.groups.capstan_friction import BEARING, NONE, Slips
from crane.groups.span import FIRST, FIRST_PSI, FORCE, LAST, LAST_PSI, MATERIAL, RECORDED, STRETCH, Spans
from crane.groups.winch import Drums
from crane.results.angles import UPRIGHT, across_plumb, hook_span, leads, legs_of, out_of_plane
from crane.scene.scene import Drum, Sheave
from crane.sea.compensation import Compensation
from crane.sea.waves import waves_of
from tautline.application.modelling import energies_of, energy_variables
from tautline.kernels.time_function import sample
from tautline.results.assessment.balance import ENERGIES
from tautline.results.on_demand import OnDemand, together
from tautline.results.variable import Variable
from tautline.system.time_functions import FunctionRequest, compile_functions

COORDINATE_UNITS = (
    "z up; tension is positive; the rope runs from the first item of the path to the last, material grows along it; "
    "a drum's rope speed and power are positive where it pays out and where it hoists; rotation is right-handed about "
    "the axis; wrap and fleet angles in rad"
)
AXES = 3
OF_SHEAVES = ("wrap_angle", "fleet_angle", "sheave_load", "sheave_rotation", "slipping")
OF_DRUMS = (
    "drum_tension", "paid_out", "pay_out_speed", "drum_rotation", "winch_torque", "winch_power", "drum_fleet_angle"
)  # fmt: skip
"""Variables that are made together."""
LEAD_ANGLE, WRAP_MIDDLE = "lead_angle", "wrap_middle"
"""Variables of scenes in which the rope's line may go round a drum or a sheave."""
ELEVATION = "surface_elevation"
"""Variable of scenes with waves on the water."""
PER_SPAN = RECORDED + AXES


def variables(observer: Observer) -> list[Variable]:
    """Everything that is stored, with units."""
    node, time = ("time", "node"), ("time",)
    span, sheave, body, drum = ("time", "span", "end"), ("time", "sheave"), ("time", "body", "axis"), ("time", "drum")
    of_sheaves = [
        Variable("wrap_angle", sheave, "rad", "angle of contact of rope and sheave"),
        Variable("fleet_angle", (*sheave, "end"), "rad", "angle of rope and sheave plane, where it runs on and off"),
        Variable("sheave_load", (*sheave, "axis"), "N", "force of the rope on the sheave"),
        Variable("sheave_rotation", sheave, "rad", "rotation of the sheave about its axis"),
        Variable(
            "slipping", sheave, "", "1 where the rope slips forwards over the sheave, -1 where backwards, else 0", True
        ),
    ]
    of_bodies = [
        Variable("body_position", body, "m", "position of a body"),
        Variable("body_velocity", body, "m/s", "velocity of a body"),
    ]
    of_drums = [
        Variable("drum_tension", drum, "N", "tension at the drum"),
        Variable("paid_out", drum, "m", "unstretched rope paid out since the start"),
        Variable("pay_out_speed", drum, "m/s", "speed of unstretched rope, positive out"),
        Variable("drum_rotation", drum, "rad", "rotation of the drum, positive where it pays out"),
        Variable("winch_torque", drum, "N m", "moment of the rope about the drum, at the layer that it leaves from"),
        Variable("winch_power", drum, "W", "power of the winch, positive where it hoists"),
        Variable("drum_fleet_angle", drum, "rad", "angle of rope and drum plane"),
    ]
    of_hook = [
        Variable(
            "offlead", time, "rad", "angle of the hook's rope from plumb, in its wheel's plane, along axis x gravity"
        ),
        Variable(
            "sidelead", time, "rad", "angle of the hook's rope from plumb, out of its wheel's plane, along the axis"
        ),
    ]
    return [
        Variable("position", (*node, "axis"), "m", "position"),
        Variable("velocity", (*node, "axis"), "m/s", "velocity"),
        Variable("material_coordinate", node, "m", "material coordinate p"),
        Variable("axial_force", ("time", "element"), "N", "axial force, with its damping"),
        Variable("tension", span, "N", "tension at the beginning and at the end of a span"),
        *(of_sheaves if observer.sheaves else []),
        *(of_drums if observer.drums else []),
        *([_lead_angle()] if observer.turning_drums else []),
        *([_wrap_middle()] if observer.turning_sheaves else []),
        *(of_hook if observer.hung is not None else []),
        *(of_bodies if observer.scene.bodies else []),
        *([_elevation()] if observer.waves is not None else []),
        *(
            [Variable("body_turn", ("time", "body", "part"), "", "quaternion of a body; 1, 0, 0, 0 of a point")]
            if observer.layout.turn
            else []
        ),
        *(
            [Variable("compensator", time, "m", "displacement of the heave compensator")]
            if observer.compensator
            else []
        ),
        *energy_variables(
            ", of springs too",
            " of weight and buoyancy",
            "damping and friction",
            "of winches, moving frames and forces",
        ),
    ]


def _elevation() -> Variable:
    return Variable(ELEVATION, ("time", "body"), "m", "height of the waves at a body above the level of the water")


def _lead_angle() -> Variable:
    text = (
        "how far the point where the rope leaves the drum has gone round it since the drawing, whole turns among it; "
        "positive where that takes rope off the drum"
    )
    return Variable(LEAD_ANGLE, ("time", "drum"), "rad", text)


def _wrap_middle() -> Variable:
    text = (
        "how far the middle of what lies on the sheave has gone round it since the drawing, whole turns among it; "
        "right-handed about the axis"
    )
    return Variable(WRAP_MIDDLE, ("time", "sheave"), "rad", text)


def layers_of(drum: Drum, diameter: float | None, stretch: float) -> DrumLayers:
    """Rope on a drum: in layers where these, the rope's diameter, m, and how much of it there is are known."""
    layers, held = drum.layers, drum.rope_on_drum
    if layers is None or diameter is None or held is None:
        return DrumLayers(drum.radius, held, stretch)
    first = layers.pitch_radius(1, diameter)
    return DrumLayers(first, held, stretch, layers.pitch_radius(2, diameter) - first, layers.turns, layers.count)


def _column(frames: Any) -> np.ndarray:
    """Times of frames, (m, 1) s."""
    return np.asarray(frames.time, float)[:, None]


class Observer:
    """Turns frames into variables; all of it vectorised over the frames of a batch."""

    def __init__(self, layout: Layout, groups: tuple[Any, ...], compensation: Compensation | None) -> None:
        self.layout, self.scene = layout, layout.scene
        self.stations = layout.once("stations", lambda: np.array(layout.station))
        self.elements = len(self.stations) - 1
        self.sheaves = [i for i, item in enumerate(self.scene.path) if isinstance(item, Sheave)]
        self.drums = [i for i, item in enumerate(self.scene.path) if isinstance(item, Drum)]
        self.turning_sheaves = any(layout.turns_about(i) for i in self.sheaves)
        self.turning_drums = any(layout.turns_about(i) for i in self.drums)
        self.spans = next((g for g in groups if isinstance(g, Spans)), None)
        self.slips = next((g for g in groups if isinstance(g, Slips)), None)
        motors = next((g for g in groups if isinstance(g, Drums)), None)
        self.own = PER_SPAN * self.elements
        self.own += 2 * len(self.slips.rows) if self.slips is not None else 0
        self.own += len(motors.rows) if motors is not None else 0
        drawn = layout.degrees.value[self.stations + MATERIAL]
        self.laid = drawn if self.spans is None else self.spans.laid
        diameter = self.scene.rope.diameter
        self.layers = [layers_of(self.scene.path[i], diameter, layout.stretch) for i in self.drums]
        self.waves = waves_of(self.scene)
        self.hung = layout.once("hung", self._hung)
        # Known once an equilibrium was found, here or by the simulation whose state was restored.
        self.hangs = np.full((self.elements, 2), np.nan)
        self.compensator: Any = None
        if compensation is not None:
            self.compensator = compile_functions([FunctionRequest(compensation.place, end=self.scene.solver.end)])

    def _hung(self) -> tuple[int, int] | None:
        """Wheel and hook of which offlead and sidelead are told: there is plumb, and the axis is drawn across it."""
        hung = hook_span(self.scene)
        if hung is None or not any(self.scene.gravity):
            return None
        across = across_plumb(self.layout.wheels["axis"][hung[0]], self.scene.gravity)
        return hung if np.linalg.norm(across) >= UPRIGHT else None

    def _axes(self, q: np.ndarray, items: list[int]) -> np.ndarray:
        """Unit axes of some items' wheels, (m, items, 3), from full vectors (m, n)."""
        wheels = self.layout.wheels[items]
        columns = q[:, wheels.frame[:, None] + COLUMNS + np.arange(AXES * AXES)].reshape(len(q), -1, AXES, AXES)
        return sum(columns[:, :, j] * wheels.axis[:, j, None] for j in range(AXES))

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        path = self.scene.path
        made: dict[str, tuple[Any, np.ndarray, str, str]] = {
            "node": ("node", np.arange(1, len(self.stations) + 1), "", "node of the rope, from 1 at its beginning"),
            "element": ("element", np.arange(1, self.elements + 1), "", "element of the rope, from 1 at its beginning"),
            "element_name": ("element", np.array(_names_of_elements(self.scene)), "", "span of an element"),
            "axis": ("axis", np.array(["x", "y", "z"]), "", "axis"),
            "span": ("span", np.array([f"{a.name} to {b.name}" for a, b in pairwise(path)]), "", "span"),
            "end": ("end", np.array(["first", "last"]), "", "where the rope comes from, and where it goes"),
            "end_name": (
                ("span", "end"),
                np.array([[a.name, b.name] for a, b in pairwise(path)]),
                "",
                "item at an end",
            ),
        }
        if self.scene.bodies:
            made["body"] = ("body", np.array([body.name for body in self.scene.bodies]), "", "body")
        if self.sheaves:
            made["sheave"] = ("sheave", np.array([path[i].name for i in self.sheaves]), "", "sheave")
            made["sheave_radius"] = ("sheave", np.array([path[i].radius for i in self.sheaves]), "m", "pitch radius")
        if self.layout.turn:
            made["part"] = ("part", np.array(["s", "x", "y", "z"]), "", "part of a quaternion")
        if self.drums:
            made["drum"] = ("drum", np.array([path[i].name for i in self.drums]), "", "drum")
        return made

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        return dict(self.on_demand(frames))

    def on_demand(self, frames: Any) -> Mapping[str, np.ndarray]:
        """The same, each variable made when it is asked for; the frames have to stay as they are."""
        q, v, three = frames.q, frames.v, np.arange(AXES)
        found = frames.own[:, : PER_SPAN * self.elements].reshape(len(q), self.elements, PER_SPAN)
        found = self._before_anything_moves(frames, found)
        tension = together(("tension",), lambda: {"tension": self._tension(v, found)})
        made: dict[str, Callable[[], Any]] = {
            "position": lambda: q[:, self.stations[:, None] + three],
            "velocity": lambda: v[:, self.stations[:, None] + three],
            "material_coordinate": lambda: q[:, self.stations + MATERIAL],
            "axial_force": lambda: found[..., FORCE].copy(),
            **tension,
        }
        if self.scene.bodies:
            made["body_position"], made["body_velocity"] = (partial(self._of_bodies, x) for x in (q, v))
        if (waves := self.waves) is not None:
            made[ELEVATION] = lambda: waves.elevation(*np.moveaxis(self._of_bodies(q)[..., :2], -1, 0), _column(frames))
        if self.sheaves:
            made |= together(OF_SHEAVES, lambda: self._sheaves(frames, found))
        if self.drums:
            made |= together(OF_DRUMS, lambda: self._drums(frames, found, tension["tension"]()))
        if self.turning_drums:
            made[LEAD_ANGLE] = lambda: self._lead_angle(found)
        if self.turning_sheaves:
            made[WRAP_MIDDLE] = lambda: self._wrap_middle(found)
        if self.hung is not None:
            made |= together(("offlead", "sidelead"), lambda: self._leads(q, found))
        if self.layout.turn:
            made["body_turn"] = lambda: self._turns(q)
        if self.compensator is not None:
            made["compensator"] = lambda: sample(self.compensator, 0, np.ascontiguousarray(frames.time))[:, 0]
        made |= together(ENERGIES, lambda: energies_of(frames))
        return OnDemand(made)

    def _before_anything_moves(self, frames: Any, found: np.ndarray) -> np.ndarray:
        """What the spans found, with the forces at t = 0 as they are before anything moves: stretch and load alone.

        Where a scene begins with a speed, one element alone takes all of the jump at t = 0: its damping is c EA v / L,
        and has no bound as the mesh gets finer. What is left of it at any later time, the mesh does not change. A blow
        at t = 0 does work: behind it forces are as behind one at any other time.
        """
        first = np.flatnonzero(
            (np.asarray(frames.time) == 0.0) & (frames.energy[:, ENERGIES.index("external_work")] == 0.0)
        )
        if self.spans is None or np.isnan(self.hangs).any() or first.size == 0:
            return found
        found, rows = found.copy(), self.spans.rows
        then = found[first]
        stretch = then[..., STRETCH]
        if self.scene.rope.strain == "engineering":
            strain, slope = stretch - 1.0, np.ones_like(stretch)
        else:
            strain, slope = 0.5 * (stretch**2 - 1.0), stretch
        force = np.where((rows.slack == 1) & (strain < 0.0), 0.0, rows.stiffness * strain * slope)
        then[..., FORCE] = force
        then[..., FIRST], then[..., LAST] = force + self.hangs[:, 0], force + self.hangs[:, 1]
        found[first] = then
        return found

    def _of_bodies(self, x: np.ndarray) -> np.ndarray:
        """Places of the bodies in full vectors (m, n): (m, bodies, 3)."""
        bodies = np.array([self.layout.body[body.name] for body in self.scene.bodies], dtype=int)
        return x[:, bodies[:, None] + np.arange(AXES)]

    def _tension(self, v: np.ndarray, found: np.ndarray) -> np.ndarray:
        """Tension at both ends of every span, (m, spans, 2) N."""
        first, last = self.layout.once("ends", lambda: np.array(self.layout.spans).T)
        # What turns the rope's momentum at a mark is part of its tension there.
        mass, material = self.scene.rope.mass_per_length, self.stations + MATERIAL
        at_first = found[:, first, FIRST] + mass * v[:, material[first]] ** 2 * found[:, first, STRETCH]
        at_last = found[:, last - 1, LAST] + mass * v[:, material[last]] ** 2 * found[:, last - 1, STRETCH]
        if self.scene.rope.compression == "none":
            # Where the half element beside a mark is thrown about while it is slack, its inertia is no tension.
            at_first = np.where(found[:, first, FORCE] > 0.0, np.maximum(at_first, 0.0), 0.0)
            at_last = np.where(found[:, last - 1, FORCE] > 0.0, np.maximum(at_last, 0.0), 0.0)
        return np.stack((at_first, at_last), axis=-1)

    def at_rest(self) -> dict[str, np.ndarray]:
        """Tension in the equilibrium that was found last, (spans, 2) N: nothing moves, and no damping is in it."""
        if self.spans is None:
            return {}
        # What hangs on the ends of an element beside its force in the middle: its weight, and what the water does.
        self.hangs[:] = self.spans.found[:, [FIRST, LAST]] - self.spans.found[:, [FORCE]]
        still = np.zeros((1, self.layout.degrees.value.size))
        return {"tension": self._tension(still, self.spans.found[None])[0]}

    def _leads(self, q: np.ndarray, found: np.ndarray) -> dict[str, np.ndarray]:
        assert self.hung is not None
        wheel, hook = self.hung
        # The end at the load is what swings; a heavy rope between is another angle. Of several legs or falls each has
        # its own inclination: what they pull with together is the load's.
        legs = self.layout.once("legs", lambda: legs_of(self.scene, hook))
        spans = [self.layout.spans[k] for k, _ in legs]
        elements = [end - 1 if last else first for (first, end), (_, last) in zip(spans, legs, strict=True)]
        away = np.array([1.0 if last else -1.0 for _, last in legs])[:, None] * found[:, elements, RECORDED:]
        e = away[:, 0] if len(legs) == 1 else _together(away, np.maximum(found[:, elements, FORCE], 0.0))
        offlead, sidelead = leads(e, self._axes(q, [wheel])[:, 0], self.scene.gravity)
        return {"offlead": offlead, "sidelead": sidelead}

    def _turns(self, q: np.ndarray) -> np.ndarray:
        """Quaternions of all bodies, (m, bodies, 4)."""
        turn = np.zeros((len(q), len(self.scene.bodies), QUATERNION))
        turn[..., 0] = 1.0
        for k, body in enumerate(self.scene.bodies):
            if body.name in self.layout.turn:
                place = self.layout.turn[body.name]
                turn[:, k] = q[:, place : place + QUATERNION]
        return turn

    def _sheaves(self, frames: Any, found: np.ndarray) -> dict[str, np.ndarray]:
        layout, rows = self.layout, self.layout.wheels
        after = np.array([layout.item[i] for i in self.sheaves])
        on, off = found[:, after - 1], found[:, after]
        e_on, e_off = on[..., RECORDED:], off[..., RECORDED:]
        wheels, axis = rows[self.sheaves], self._axes(frames.q, self.sheaves)
        place = np.array([layout.material(i) for i in self.sheaves])
        load = off[..., [FIRST]] * e_off - on[..., [LAST]] * e_on
        fleet = [out_of_plane(e, axis) for e in (e_on, e_off)]
        return {
            "wrap_angle": np.abs(off[..., FIRST_PSI] - on[..., LAST_PSI]),
            "fleet_angle": np.stack(fleet, axis=-1),
            "sheave_load": load,
            "sheave_rotation": self._rotation(frames, place, wheels.radius),
            "slipping": self._slipping(frames),
        }

    def _wrap_middle(self, found: np.ndarray) -> np.ndarray:
        """Right-handed angle from the marks of sheaves to the middle of what lies on them, (m, sheaves) rad."""
        after = np.array([self.layout.item[i] for i in self.sheaves])
        return 0.5 * (found[:, after - 1, LAST_PSI] + found[:, after, FIRST_PSI])

    def _lead_angle(self, found: np.ndarray) -> np.ndarray:
        """Angle by which turning has taken rope off drums, (m, drums) rad.

        Between its mark and where it leaves lie rho psi on a drum at the beginning of the path, -rho psi at its end.
        """
        rho = self.layout.wheels.radius
        ends = [(-np.sign(rho[i]), 0, FIRST_PSI) if i == 0 else (np.sign(rho[i]), -1, LAST_PSI) for i in self.drums]
        return np.stack([sign * found[:, element, psi] for sign, element, psi in ends], axis=-1)

    def _rotation(self, frames: Any, place: np.ndarray, rho: np.ndarray) -> np.ndarray:
        """Rotation of sheaves: their rims' travel, or that of the rope which does not slip on them."""
        travel = -self.layout.stretch * (frames.q[:, place] - self.laid[[self.layout.item[i] for i in self.sheaves]])
        for k, i in enumerate(self.sheaves):
            if i in self.layout.rim:
                travel[:, k] = frames.q[:, self.layout.rim[i]]
            elif stands_still(self.layout, i):
                travel[:, k] = 0.0
        return travel / rho

    def _slipping(self, frames: Any) -> np.ndarray:
        slipping = np.zeros((len(frames.q), len(self.sheaves)))
        if self.slips is None:
            return slipping
        own = frames.own[:, PER_SPAN * self.elements :]
        after = {self.layout.item[i]: k for k, i in enumerate(self.sheaves)}
        for j, row in enumerate(self.slips.rows):
            if row.after != NONE and row.kind != BEARING:
                slipping[:, after[row.after]] = 0.0 - own[:, 2 * j + 1]
        return slipping

    def _laid_out(self, frames: Any) -> np.ndarray:
        """Material at drums before any was paid out."""
        laid = np.tile(self.laid[[self.layout.item[i] for i in self.drums]], (len(frames.q), 1))
        for k, i in enumerate(self.drums):
            if i in self.layout.supply:
                laid[:, k] = frames.q[:, self.layout.supply[i]]
        return laid

    def _drums(self, frames: Any, found: np.ndarray, tensions: np.ndarray) -> dict[str, np.ndarray]:
        place = np.array([self.layout.material(i) for i in self.drums])
        way = np.array([-1.0 if i == 0 else 1.0 for i in self.drums])
        element = np.array([0 if i == 0 else self.elements - 1 for i in self.drums])
        tension = np.stack([tensions[:, 0, 0] if i == 0 else tensions[:, -1, 1] for i in self.drums], axis=-1)
        stretch = found[:, element, STRETCH]
        # Rope that is bent to the drum takes EJ / (2 R^2) for each metre.
        radius = np.array([self.scene.path[i].radius for i in self.drums])
        bent = 0.5 * self.scene.rope.bending_stiffness / radius**2
        out, speed = way * (frames.q[:, place] - self._laid_out(frames)), way * frames.v[:, place]
        # What turning takes off counts layers like what is paid out.
        gone = out + radius * self._lead_angle(found) / np.maximum(stretch, 1.0) if self.turning_drums else out
        return {
            "drum_tension": tension,
            "paid_out": out,
            "pay_out_speed": speed,
            "drum_rotation": np.stack([w.rotation_at(out[:, k]) for k, w in enumerate(self.layers)], axis=-1),
            "winch_torque": (tension + bent)
            * np.stack([w.radius_at(gone[:, k]) for k, w in enumerate(self.layers)], axis=-1),
            "winch_power": -(tension * stretch + bent) * speed,
            "drum_fleet_angle": np.abs(out_of_plane(found[:, element, RECORDED:], self._axes(frames.q, self.drums))),
        }


def _together(directions: np.ndarray, tension: np.ndarray) -> np.ndarray:
    """What legs (m, legs, 3) pull with together, (m, 3), of tensions (m, legs) N; where all are slack, alike."""
    slack = ~(tension > 0.0).any(axis=1, keepdims=True)
    return np.einsum("ml,mlc->mc", np.where(slack, 1.0, tension), directions)


def _names_of_elements(scene: Any) -> list[str]:
    """Each element by its span, ``winch to boom tip``, and by its number there where the span has several."""
    names: list[str] = []
    for (a, b), count in zip(pairwise(scene.path), scene.elements, strict=True):
        span = f"{a.name} to {b.name}"
        names += [span] if count == 1 else [f"{span}, element {k} of {count}" for k in range(1, count + 1)]
    return names
