"""From a scene to the groups that act at the string's ends, whichever model the string between them has."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drillstring.drilling.bit_group import OWN
from drillstring.drilling.bit_numbers import bit_row, torque_at
from drillstring.drilling.bit_rock import BladeBit, RockBit
from drillstring.drilling.impedance import gains, note_of_drive
from drillstring.drilling.top_drive import TopDrive
from drillstring.scene.ends import Controller
from drillstring.string.lumps import Tube
from tautline.elements.nodal.load import Loads
from tautline.kernels.time_function import TimeFunctions, sample, value_at
from tautline.scene.functions import Constant
from tautline.system.time_functions import FunctionRequest, Steering, compile_functions

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene

BLOCK, ROTATION, TORQUE = 0, 1, 2
"""Functions of time of a scene: the block's position m, the angle of the rotary rad, and the torque of a drive that is
given it from outside, N m."""
TORQUE_INPUT = "top.torque"
INSTANTS, FEW = 201, 10
"""Times of a run at which its speeds are looked at, beside those at which their formulas change; and waves up to which
each is looked at where it is fastest: in a sum of more no single crest is the fastest speed."""
ROUNDED = 1.0e-9
"""Speed over the fastest of a run below which it is rounding."""
RING = 1024
"""Angles at which the bottom of the hole under a bit with blades is remembered."""


class Along(NamedTuple):
    """A coordinate along the hole, ``datum + sum(direction q[places])`` m of measured depth.

    ``places`` (k,) are full degrees of freedom and ``direction`` (k,) the hole's tangent on them: a lump's own
    coordinate and 1, or a point's three and their cosines.
    """

    places: np.ndarray
    direction: np.ndarray
    datum: float


def is_driven(scene: DrillstringScene) -> bool:
    """Whether a controller turns the string, not a prescribed speed: a stiff drive's speed is prescribed."""
    return isinstance(scene.top.rotation, Controller) and scene.top.rotation.kind != "stiff"


def requests(scene: DrillstringScene) -> list[FunctionRequest]:
    """Block position, the rotary's angle from where it is at t = 0, and the torque of a drive that is given it."""
    rotation = scene.top.rotation
    speed = rotation.speed if isinstance(rotation, Controller) else rotation
    key = "top.rotation.controller.speed" if isinstance(rotation, Controller) else "top.rotation"
    block = (
        Steering("top.block", "m", "block position, positive down"),
        Steering("top.block_speed", "m/s", "block speed, positive down", 1),
    )
    rotary = (
        Steering("top.rotary_speed", "rad/s", "rotary speed, clockwise looking downhole", 1),
        # A string that starts straight is not wound up: turned at its top alone it would be.
        Steering(
            "top.rotary_angle", "rad", "angle of the rotary since the start", zero_at_start=scene.start == "straight"
        ),
    )
    made = [
        FunctionRequest(scene.top.block, end=scene.solver.end, key="top.block", inputs=block),
        FunctionRequest(speed, integrate=True, end=scene.solver.end, key=key, inputs=rotary),
    ]
    if TORQUE_INPUT in scene.driven:
        torque = Steering(TORQUE_INPUT, "N m", "torque of the top drive, in place of its controller's")
        made.append(FunctionRequest(Constant(value=0.0), key="top.rotation", inputs=(torque,)))
    return made


def speeds_of(scene: DrillstringScene, number: int) -> np.ndarray:
    """Speeds (m,) of the block, m/s, or of the rotary, rad/s, that a scene has throughout its run, BLOCK or ROTATION.

    They are those at `INSTANTS`, on both sides of every change of the formula and half way between two, so that no
    pulse is missed, and at the next crest and trough of each of few waves.
    """
    functions, end = compile_functions(requests(scene)), scene.solver.end
    even = np.linspace(0.0, end, INSTANTS)
    tracks = functions.break_from[[functions.track_from[number], functions.track_to[number]]]
    changes = np.unique(np.concatenate([[0.0, end], functions.breaks[tracks[0] : tracks[1]]]))
    times = [even, changes, np.nextafter(changes, 0.0), 0.5 * (changes[1:] + changes[:-1])]
    waves = functions.waves[functions.wave_from[number] : functions.wave_to[number]]
    for _, w, c, phase, _ in waves if len(waves) <= FEW else ():
        halves, rate = (phase + even * (w + c * even)) / np.pi, w + 2.0 * c * even
        turning = rate != 0.0
        way = 1.0 if w >= 0.0 else -1.0
        nearest = way * np.ceil(way * halves)
        for extreme in (nearest, nearest + way):  # one of them is a crest, the other a trough
            times.append((even + np.pi * (extreme - halves) / np.where(turning, rate, np.inf))[turning])
    at = np.unique(np.concatenate(times))
    speeds = sample(functions, number, at[(at >= 0.0) & (at <= end)])[:, 1]
    # Rounding of what comes to rest is no turn the other way.
    return np.where(np.abs(speeds) > ROUNDED * np.abs(speeds).max(), speeds, 0.0)


def from_outside(scene: DrillstringScene, number: int) -> bool:
    """Whether something outside the scene moves its block, or turns its string: BLOCK or ROTATION."""
    names = {one.name for one in requests(scene)[number].inputs}
    if number == ROTATION:
        names.add(TORQUE_INPUT)
    return not names.isdisjoint(scene.driven)


def turns(scene: DrillstringScene) -> bool:
    """Whether something turns the string at any time of the run: the scene, or what drives it from outside."""
    return from_outside(scene, ROTATION) or bool(np.any(speeds_of(scene, ROTATION) != 0.0))


def groups_at_ends(
    scene: DrillstringScene, functions: TimeFunctions, drive: int, bit: Along, bit_turn: int, tubes: Sequence[Tube]
) -> list[Any]:
    """Groups at both ends of a string.

    Of a bit on bottom the tangent couples ``bit.places`` with ``bit_turn``.

    Parameters
    ----------
    scene : DrillstringScene
        The scene.
    functions : TimeFunctions
        With the block's position and the rotary's angle at BLOCK and ROTATION.
    drive, bit_turn : int
        Full degrees of freedom of rotation at the drive and at the bit.
    bit : Along
        The bit's measured depth.
    tubes : sequence of Tube
        Of the string, from the top down.
    """
    groups: list[Any] = []
    if scene.bit.force != 0.0:
        groups.append(Loads(bit.places, scene.bit.force * bit.direction))
    wound = 0.0
    if scene.bit.on_bottom:
        spin = value_at(functions, ROTATION, 0.0)[1]
        group = _bit(scene, bit, bit_turn, tubes, spin)
        # A string that turns at the start is wound up by the torque that its bit then has; `straight` is as it says.
        if spin != 0.0 and scene.start != "straight":
            wound = float(np.copysign(torque_at(group.row[0], scene.bit.weight, spin), spin))
        group.row[0].torque = wound
        groups.append(group)
    if is_driven(scene):
        given = TORQUE_INPUT in scene.driven
        groups.append(_drive(scene.top.rotation, functions, drive, tubes, wound, given))
    return groups


def _bit(scene: DrillstringScene, bit: Along, turn: int, tubes: Sequence[Tube], spin: float) -> RockBit | BladeBit:
    row = bit_row(scene.bit, scene.well.diameter, tubes, spin, scene.solver.explicit)
    shared = bit.places, bit.direction, bit.datum, turn, row, np.zeros(4), np.zeros((3, 4))
    if scene.bit.cutting is not None and scene.bit.cutting.blades is not None:
        return BladeBit(*shared, np.zeros((RING, 2)), np.zeros(1, np.int64))
    return RockBit(*shared)


def _drive(
    rotation: Controller, functions: TimeFunctions, place: int, tubes: Sequence[Tube], wound: float, given: bool
) -> TopDrive:
    """The drive, whose integral already gives the torque that the string is wound up by.

    ``given``: its torque comes from outside.
    """
    assert rotation.inertia is not None
    limit = rotation.torque_limit if rotation.torque_limit is not None else np.inf
    proportional, integral = (0.0, 0.0) if given else gains(rotation, tubes)
    lead = wound / integral if integral > 0.0 else 0.0
    return TopDrive(
        functions, ROTATION, place, rotation.inertia, proportional, integral, limit, TORQUE if given else -1,
        np.zeros(1), np.array([lead, 0.0]),
    )  # fmt: skip


def numbers_of_ends(groups: Sequence[Any]) -> int:
    """How many numbers the groups at the ends record."""
    return sum(OWN if isinstance(g, RockBit | BladeBit) else isinstance(g, TopDrive) for g in groups)


def notes_of_ends(scene: DrillstringScene, tubes: Sequence[Tube]) -> list[str]:
    """What was decided about the ends that the user should know."""
    notes = []
    rotation = scene.top.rotation
    if isinstance(rotation, Controller) and rotation.kind == "soft-torque":
        notes.append(note_of_drive(rotation, tubes))
    if scene.bit.on_bottom and scene.solver.explicit and (scene.bit.torque or scene.bit.cutting):
        notes.append(
            "a bit that sticks exactly needs an implicit method: rk4 takes its torque as a function of its speed, in "
            f"full above {scene.bit.slip_speed:g} rad/s, and a stuck bit creeps (bit.slip_speed)"
        )
    return notes
