"""What a run's frames mean to a drilling engineer: variables, units, headline figures."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from drillstring.drilling.end_groups import numbers_of_ends
from drillstring.results.break_away import break_away_figures
from drillstring.results.drilling import drilling_figures, observed_at_ends
from drillstring.results.places import LUMP, names_of_bodies, names_of_links
from drillstring.results.side_force import largest_side_force
from drillstring.results.whirl import whirl_figures, without_a_ratio
from drillstring.string.lumps import Lumps
from drillstring.well.wellbore import Wellbore
from tautline.application.modelling import energies_of, energy_variables
from tautline.lumped.curve import PER_BODY
from tautline.results.assessment.balance import ENERGIES
from tautline.results.on_demand import OnDemand, together
from tautline.results.variable import Variable, at_start, late_start

FIGURES = {
    "hook_load_start": "N", "hook_load_max": "N", "hook_load_min": "N", "hook_load_max_with_block": "N",
    "stretch_start": "m", "bit_displacement": "m", "bit_speed_max": "m/s", "bit_stuck": "", "contact_force_max": "N",
    "side_force_max": "N/m", "surface_torque_max": "N m", "surface_torque_end": "N m",
    "break_away_stroke": "m", "break_away_hook_load": "N", "break_away_time": "s",
    "weight_on_bit_start": "N", "weight_on_bit_mean": "N", "torque_on_bit_mean": "N m", "drilled": "m",
    "rate_of_penetration_mean": "m/s", "bit_rotation_mean": "rad/s", "stick_slip_severity": "", "rotation_stuck": "",
    "lateral_offset_max": "m", "lateral_offset_depth": "m", "lateral_acceleration_max": "m/s^2", "whirl_ratio": "",
}  # fmt: skip
"""Figures of a run and their units, of which a scene may set limits; some only some runs have."""
NOTHING = frozenset({"surface_torque_max", "surface_torque_end", "drilled"})
"""Those of them that a run is without because they are 0."""
JOINED = {
    r"(hook_load|bit_speed|contact_force|side_force|surface_torque)_max|hook_load_max_with_block": "largest",
    r"hook_load_min": "smallest",
    r"(hook_load|stretch|weight_on_bit)_start|surface_torque_end|drilled": "last",
}
"""How figures of pieces of a run make those of the whole; the others are of its last half, or need every frame."""
EXTREMES = {r"lateral_(acceleration|offset)_max": "largest"}
"""Others that are extremes over all frames: of one lump, or between two frames, which pieces do not tell."""
OF_DRILLING = frozenset({
    "weight_on_bit_start", "weight_on_bit_mean", "torque_on_bit_mean", "drilled", "rate_of_penetration_mean",
    "bit_rotation_mean", "stick_slip_severity", "rotation_stuck",
})  # fmt: skip
BREAKING_AWAY = frozenset({"break_away_stroke", "break_away_hook_load", "break_away_time"})
WHIRLING = frozenset({"lateral_offset_max", "lateral_offset_depth", "lateral_acceleration_max", "whirl_ratio"})
"""Figures of a bit that drills, of one that friction holds when the block moves, and of a string out of balance."""
STUCK = 1.0e-8
"""Bit speed, m/s, below which the bit counts as stuck."""
TORQUE_SHOWN = 1.0e-3
"""Torque, N m, below which a string does not count as turned: it is rounding."""
COORDINATE_UNITS = (
    "position is north, east, down of the rotary table's centre; lateral is on the Bishop frame's m1 (north at the "
    "table) and m2 (east); tension is the effective tension, positive in tension; friction_force is along the hole, "
    "positive downhole, on the string; rotation is clockwise looking downhole; torque is what the part above exerts on "
    "the part below, clockwise, and surface_torque what the top drive exerts on the string"
)


def variables() -> list[Variable]:
    """Everything that is stored, with units."""
    body, link = ("time", "body"), ("time", "link")
    return [
        Variable("position", ("time", "body", "axis"), "m", "position north, east, down"),
        Variable("velocity", ("time", "body", "axis"), "m/s", "velocity north, east, down"),
        Variable("measured_depth", body, "m", "measured depth of the lump"),
        Variable("lateral_displacement", ("time", "body", "side"), "m", "offset from the hole's axis"),
        Variable("rotation", body, "rad", "rotation, clockwise looking downhole"),
        Variable("axial_velocity", body, "m/s", "velocity along the hole, positive down"),
        Variable("rotation_rate", body, "rad/s", "rotary speed"),
        Variable("tension", link, "N", "effective tension"),
        Variable("torque", link, "N m", "torque that the string passes down, clockwise"),
        Variable("contact_force", body, "N", "normal force of the wall"),
        Variable("friction_force", body, "N", "friction along the hole on the string, positive downhole"),
        Variable("friction_around", body, "N", "friction around the pipe on the string"),
        Variable("hook_load", ("time",), "N", "hook load"),
        Variable("surface_torque", ("time",), "N m", "torque that turns the string at the top"),
        Variable("block_position", ("time",), "m", "block position, positive down"),
        Variable("bit_speed", ("time",), "m/s", "speed of the bit along the hole, positive down"),
        Variable("bit_depth", ("time",), "m", "measured depth of the bit"),
        *energy_variables(
            ", of the wall too",
            ", over the unstretched string's",
            "friction, mud and damping",
            "done on the string at its top",
        ),
    ]


class Observer:
    """Turns frames into variables; all of it vectorised over the frames of a batch."""

    def __init__(self, well: Wellbore, lumps: Lumps, groups: tuple[Any, ...], driven: bool) -> None:
        self.well, self.lumps, self.groups, self.driven = well, lumps, groups, driven
        kinds = {type(g).__name__: g for g in groups}
        self.links, self.contact = kinds["Links"], kinds.get("WallContact")
        self.bodies = kinds.get("Bodies") or kinds["EccentricBodies"]
        self.drive = kinds.get("TopDrive")
        self.own = (0 if self.contact is None else 3 * self.contact.springs.size) + numbers_of_ends(groups)
        weight = np.array(self.bodies.lumps.weight)
        self.unstretched = -float(weight @ well.tvd(lumps.measured_depth))

    def coordinates(self) -> dict[str, tuple[Any, np.ndarray, str, str]]:
        """Arrays that do not change with time."""
        weight, clearance = np.array(self.bodies.lumps.weight), None
        if self.contact is not None:
            springs = self.contact.springs
            # The lump that hangs in the drive has no spring: it has the clearance of the one below.
            clearance = np.full(weight.size, springs.clearance[0])
            clearance[springs.body] = springs.clearance
        diameter = None if clearance is None else 2.0 * (float(springs[0].clearance) + float(springs[0].radius))
        return coordinates_of(self.well, self.lumps, weight, clearance, diameter)

    def observe(self, frames: Any) -> dict[str, np.ndarray]:
        """Variables of a batch of frames, leading axis time."""
        return dict(self.on_demand(frames))

    def on_demand(self, frames: Any) -> Mapping[str, np.ndarray]:
        """The same, each variable made when it is asked for; the frames have to stay as they are."""
        rows = frames.time.size
        q = frames.q.reshape(rows, -1, PER_BODY)
        v = frames.v.reshape(rows, -1, PER_BODY)
        s = self.lumps.measured_depth + q[:, :, 0]
        curvature = functools.cache(lambda: self.well.curvature(s))
        ends = observed_at_ends(frames, self.groups)
        made: dict[str, Callable[[], Any]] = {
            "position": lambda: self.well.point(s, q[:, :, 1], q[:, :, 2]),
            "velocity": lambda: self._velocity(q, v, s, *curvature()),
            "measured_depth": lambda: s,
            "lateral_displacement": lambda: q[:, :, 1:3].copy(),
            "rotation": lambda: q[:, :, 3].copy(),
            "axial_velocity": lambda: v[:, :, 0].copy(),
            "rotation_rate": lambda: v[:, :, 3].copy(),
            "tension": lambda: self._tension(q, v, s, *curvature()),
            "torque": lambda: self._torque(q, v),
            **together(("contact_force", "friction_force", "friction_around"), lambda: self._contact(frames, q)),
            "hook_load": lambda: -frames.residual[:, 0],
            "surface_torque": lambda: self._surface_torque(frames),
            "block_position": lambda: q[:, 0, 0].copy(),
            "bit_speed": lambda: v[:, -1, 0].copy(),
            "bit_depth": lambda: s[:, -1].copy(),
            **together(ENERGIES, lambda: self._energies(frames)),
        }
        return OnDemand(made | {name: partial(ends.__getitem__, name) for name in ends})

    def _energies(self, frames: Any) -> dict[str, np.ndarray]:
        return energies_of(frames) | {"potential_energy": frames.energy[:, 2] - self.unstretched}

    def _velocity(self, q: np.ndarray, v: np.ndarray, s: np.ndarray, k1: np.ndarray, k2: np.ndarray) -> np.ndarray:
        """Velocity of every lump, north, east, down."""
        m1, m2, t = self.well.frame(s)
        along = v[:, :, 0] * (1.0 - k1 * q[:, :, 1] - k2 * q[:, :, 2])
        return along[..., None] * t + v[:, :, 1, None] * m1 + v[:, :, 2, None] * m2

    def _tension(self, q: np.ndarray, v: np.ndarray, s: np.ndarray, k1: np.ndarray, k2: np.ndarray) -> np.ndarray:
        """Effective tension of each link, from its chord (docs/lumped_string.md) and Kelvin-Voigt damping."""
        springs = self.links.springs
        turn = np.diff(np.stack(self.well.turning(s)), axis=2)
        inside = turn[0] * (q[:, 1:, 1] + q[:, :-1, 1]) + turn[1] * (q[:, 1:, 2] + q[:, :-1, 2])
        chord = np.diff(q[:, :, 0], axis=1) - 0.5 * inside
        du, dv = np.diff(q[:, :, 1], axis=1), np.diff(q[:, :, 2], axis=1)
        square = 2.0 * springs.length * chord + chord**2 + du**2 + dv**2
        length = springs.length + square / (np.sqrt((springs.length + chord) ** 2 + du**2 + dv**2) + springs.length)
        tension = springs.axial * (length - springs.length)
        if self.links.damping > 0.0:
            x, u, w = v[:, :, 0], v[:, :, 1], v[:, :, 2]
            turned = np.diff(k1 * x, axis=1) * (q[:, 1:, 1] + q[:, :-1, 1])
            turned += np.diff(k2 * x, axis=1) * (q[:, 1:, 2] + q[:, :-1, 2])
            moved = turn[0] * (u[:, 1:] + u[:, :-1]) + turn[1] * (w[:, 1:] + w[:, :-1])
            rate = (springs.length + chord) * (np.diff(x, axis=1) - 0.5 * (turned + moved))
            rate += du * np.diff(u, axis=1) + dv * np.diff(w, axis=1)
            tension += springs.axial * self.links.damping * rate / length
        return tension

    def _torque(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        twist = np.diff(q[:, :, 3], axis=1) + self.links.damping * np.diff(v[:, :, 3], axis=1)
        return -self.links.springs.torsional * twist

    def _contact(self, frames: Any, q: np.ndarray) -> dict[str, np.ndarray]:
        """Normal force and friction along and around the hole; lump 0 touches nothing."""
        shape = q.shape[:2]
        out = {name: np.zeros(shape) for name in ("contact_force", "friction_force", "friction_around")}
        if self.contact is not None:
            own = frames.own[:, : 3 * self.contact.springs.size].reshape(shape[0], -1, 3)
            for k, each in enumerate(out.values()):
                each[:, self.contact.springs.body] = own[:, :, k]
        return out

    def _surface_torque(self, frames: Any) -> np.ndarray:
        if self.drive is not None:
            return frames.own[:, -1] - self.drive.inertia * frames.a[:, 3]
        return frames.residual[:, 3].copy()


def coordinates_of(
    well: Wellbore,
    lumps: Lumps,
    weight: np.ndarray,
    clearance: np.ndarray | None,
    diameter: float | None,
    part: str = LUMP,
) -> dict[str, tuple[Any, np.ndarray, str, str]]:
    """What does not change with time of a string, whichever its model.

    Parameters
    ----------
    well : Wellbore
    lumps : Lumps
        Its mesh.
    weight, clearance : (n + 1,) array
        Buoyed weight of each lump N, and how far it can be from the hole's axis, m; None for a string in free space.
    diameter : float or None
        Of the hole, m.
    part : str
        What its places are called: lump, or node.
    """
    # Not `np.unique`, which loads all of masked arrays to ask whether these are.
    stations = np.array(sorted({*well.md.tolist(), *np.linspace(0.0, well.length, 201).tolist()}))
    side, _, direction = well.frame(stations)
    found = {
        "body": ("body", np.arange(lumps.length.size + 1), "", f"{part}, from the top drive down"),
        "link": ("link", np.arange(lumps.length.size), "", "element, from the top drive down"),
        "body_name": ("body", np.array(names_of_bodies(lumps)), "", f"section and depth of the {part}"),
        "link_name": ("link", np.array(names_of_links(lumps)), "", "section and depth of the element"),
        "axis": ("axis", np.array(["x", "y", "z"]), "", "north, east, down"),
        "side": ("side", np.array(["m1", "m2"]), "", "across the hole, in the Bishop frame"),
        "unstretched_depth": ("body", lumps.measured_depth, "m", "measured depth of the unstretched string"),
        "link_length": ("link", lumps.length, "m", "unstretched length of the element"),
        "section": ("link", np.array([lumps.tubes[k].name for k in lumps.section]), "", "section of the string"),
        "outer_diameter": ("link", lumps.of_links(lambda tube: tube.od), "m", "outer diameter of the string"),
        "buoyed_weight": ("body", weight, "N", f"weight of the {part} in the mud"),
        "well_depth": ("station", stations, "m", "measured depth of the well path"),
        "well_position": (("station", "axis"), well.position(stations), "m", "well path north, east, down"),
        "well_direction": (("station", "axis"), direction, "", "unit vector down the hole"),
        "well_side": (("station", "axis"), side, "", "unit vector m1 of the Bishop frame"),
        "well_curvature": (
            ("station", "side"), np.stack(well.curvature(stations), axis=-1), "1/m",
            "curvature on m1 and m2 from here to the next station",
        ),
    }  # fmt: skip
    if clearance is not None and diameter is not None:
        found["hole_diameter"] = ("station", np.full(stations.size, diameter), "m", "diameter of the hole")
        found["clearance"] = ("body", clearance, "m", f"how far the {part}'s axis can be from the hole's")
    return found


def possible_figures(drills: bool, moves: bool, wall: bool, lumps: Lumps, block: float) -> tuple[str, ...]:
    """Names of the figures that a run can have, whatever it does; see `headline`.

    Parameters
    ----------
    drills, moves, wall : bool
        Whether there is a bit that drills, a block that moves, and a wall.
    lumps : Lumps
    block : float
        Weight of block and drive, N.
    """
    none: set[str] = set()
    if not drills:
        none |= OF_DRILLING
    if drills or not moves:
        none.add("bit_stuck")
    if not moves or not wall:
        none |= BREAKING_AWAY
    if not _out_of_balance(lumps):
        none |= WHIRLING
    if not block > 0.0:
        none.add("hook_load_max_with_block")
    return tuple(name for name in FIGURES if name not in none)


def _out_of_balance(lumps: Lumps) -> bool:
    """Whether any pipe's mass lies off its axis, of which whirl comes."""
    return any(tube.eccentricity != (0.0, 0.0) for tube in lumps.tubes)


def whirl_remarks(result: Any, lumps: Lumps) -> list[str]:
    """A sentence where an unbalanced string that whirls has no whirl ratio."""
    return without_a_ratio(result) if _out_of_balance(lumps) else []


def _largest_contact(result: Any, contact: np.ndarray, lumps: Lumps) -> dict[str, tuple[float, str, str]]:
    """Largest force on one place of the mesh, which is in proportion to its length, and the largest one per length."""
    touches, found = bool(contact.max() > 0.0), largest_side_force(contact, lumps)

    def where(place: int) -> str:
        return f" ({result['body_name'][place]})" if "body_name" in result else ""

    most = int(contact.max(axis=0).argmax())
    one, per_length = "largest contact force", "largest side force per length"
    if touches:
        one += f" on one node, of {lumps.tributary[most]:.3g} m of string{where(most)}"
        per_length += f", over {found.length:.3g} m{where(found.lump)}"
    return {
        "contact_force_max": (contact[:, most].max(), "N", one),
        "side_force_max": (found.value, "N/m", per_length),
    }


def headline(result: Any, lumps: Lumps, block: float = 0.0, creep: float = 0.0) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up.

    ``block`` is the weight of block and drive, N, which hook loads do not hold; ``creep`` the speed of a bit at rest,
    rad/s (`drillstring.results.drilling.creep_of`).
    """
    hook, torque = result["hook_load"], result["surface_torque"]
    bit, speed = result["bit_depth"], result["bit_speed"]
    contact, moving = result["contact_force"], np.ptp(result["block_position"]) > 0.0
    start = late_start(result) or "the start"
    figures = {
        "hook_load_start": (at_start(result, "hook_load"), "N", f"hook load at {start}"),
        "hook_load_max": (hook.max(), "N", "largest hook load"),
        "hook_load_min": (hook.min(), "N", "smallest hook load"),
        # Not how far the bit hangs below its place on the axis: a string that lies in a bend cuts its corner.
        "stretch_start": (lumps.stretch(at_start(result, "tension")), "m", f"elongation of the string at {start}"),
        "bit_displacement": (np.ptp(bit), "m", "bit displacement, largest less smallest"),
        "bit_speed_max": (np.abs(speed).max(), "m/s", "largest bit speed"),
        **_largest_contact(result, contact, lumps),
    }
    if block > 0.0:
        figures["hook_load_max_with_block"] = (hook.max() + block, "N", "largest hook load, with the block")
    drills = "weight_on_bit" in result
    if moving and not drills:
        # Of a bit that drills, its rotation says whether it is at rest.
        text = f"share of time with the bit at rest (below {STUCK:g} m/s)"
        figures["bit_stuck"] = (float((np.abs(speed) < STUCK).mean()), "", text)
    figures |= break_away_figures(result)
    if np.abs(torque).max() > TORQUE_SHOWN:
        figures["surface_torque_max"] = (np.abs(torque).max(), "N m", "largest surface torque")
        figures["surface_torque_end"] = (torque[-1], "N m", "surface torque at the end")
    if drills:
        figures |= drilling_figures(result, creep)
    if _out_of_balance(lumps):
        figures |= whirl_figures(result)
    return {name: {"value": float(value), "unit": unit, "text": text} for name, (value, unit, text) in figures.items()}
