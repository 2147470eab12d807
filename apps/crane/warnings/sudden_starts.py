"""What to tell a user of a crane's run in which something moves at once while the load rests: how much it adds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crane.assembly.estimates import Estimate
from crane.assembly.jumps import SUDDEN, Jumps, jumps_of
from crane.scene.keys import where
from crane.scene.scene import CraneScene, Drum
from crane.scene.surroundings import Motion, MotionFile, SeaMotion
from crane.sea.compensation import Compensation
from crane.sea.frames import MOTIONS
from tautline.kernels.time_function import sample
from tautline.scene.functions import Chirp, Harmonic, Ramp, Spectrum, Sum, Table
from tautline.scene.values.printed import quantity
from tautline.system.time_functions import FunctionRequest, compile_functions

TOLD = 1e-3
"""Share of the fastest jump below which another is not named."""
FELT = 0.02
"""Share of what the start adds below which its front is not named."""
SWINGS = 0.02
"""Angle of a load that begins to swing sideways that is told, rad."""
BY_RAMP, BY_TABLE, BY_CHIRP, BY_TIME = "ramp", "table", "chirp", "time"


def start_warnings(found: Estimate, actuator: Compensation | None) -> Iterator[tuple[str, str]]:
    """What moves at t = 0 while the load rests: frames, winches and heave compensation, told once with their sum."""
    scene, jumps = found.scene, jumps_of(found, actuator)
    least = SUDDEN * found.largest_tension
    if max(jumps.front, jumps.swing, jumps.rise, jumps.drop) <= least and jumps.sway < SWINGS:
        return
    moved = TOLD * max([jumps.fastest, abs(jumps.answer), *(abs(speed) for _, speed in jumps.drums)])
    drums = [(drum, speed) for drum, speed in jumps.drums if abs(speed) > moved]
    hangs = jumps.fastest > moved or not drums
    said = list(_moves(jumps, drums, moved))
    said += _adds(found, jumps, least)
    said += _cures(scene, hangs, drums, jumps.swing <= least and jumps.sway < SWINGS)
    if hangs:
        yield "vessel.motion" if scene.vessel is not None else "frames", ". ".join(said)
    else:
        yield where(scene, drums[0][0], drums[0][0].drive), ". ".join(said)


def _moves(jumps: Jumps, drums: list[tuple[Drum, float]], least: float) -> Iterator[str]:
    """What begins to move at t = 0."""
    if jumps.fastest > least:
        yield f"{jumps.point} moves at {jumps.fastest:.2g} m/s at t = 0, and the load rests"
    elif not drums:
        yield f"{jumps.point} is accelerated with {jumps.acceleration:.2g} m/s^2 from t = 0 on, and the load rests"
    for drum, speed in drums:
        yield f"{drum.name} jumps to {speed:.3g} m/s of rope at t = 0"
    if jumps.drums and abs(jumps.answer) > least:
        yield f"Heave compensation pays out {jumps.answer:.3g} m/s at t = 0"
    if jumps.late:
        yield "Heave compensation does not move at t = 0, and has to catch up"


def _adds(found: Estimate, jumps: Jumps, least: float) -> Iterator[str]:
    """What that does to the tension and to the load."""
    fronts = jumps.front > FELT * max(jumps.rise, jumps.drop, jumps.swing, least)
    if fronts:
        along = f"EA axial_stiffness, m mass_per_length, v = {jumps.pulled:.3g} m/s along the rope"
        yield f"This starts a tension wave of {_force(jumps.front)}: v sqrt(EA m), with {along}"
    if jumps.swing > least:
        yield f"The load then bounces on the rope, with {_force(jumps.swing)} more and less"
    more = f"up to {_force(jumps.rise)} more" if jumps.rise > FELT * jumps.drop else ""
    less = f"up to {_force(jumps.drop)} less" if jumps.drop > FELT * jumps.rise else ""
    if max(jumps.rise, jumps.drop) > least:
        both = " and ".join(filter(None, (more, less)))
        yield f"In the first bounce the tension is {both} than in the same motion without a sudden start"
        if _drags(found.scene):
            yield "The drag of the water is left out here, and makes it less"
    if found.tension is not None and jumps.drop > float(found.tension.min()) > 0.0:
        yield "The rope may then go slack. The tension is higher than told here where it becomes taut with a snap"
    if jumps.sway >= SWINGS:
        yield f"The load begins to swing sideways, by up to {math.degrees(jumps.sway):.2g} deg"


def _force(newtons: float) -> str:
    return quantity(newtons, "N", 3)


def _drags(scene: CraneScene) -> bool:
    """Whether water acts against the motion of a load."""
    return scene.water is not None and any(any((*b.drag.linear, *b.drag.quadratic)) for b in scene.bodies)


def _cures(scene: CraneScene, hangs: bool, drums: list[tuple[Drum, float]], soon_over: bool) -> Iterator[str]:
    """What to do about it."""
    if hangs:
        yield growth(scene, ", or ignore the first waves" if soon_over else "")
    for drum, speed in drums[:1]:
        ramp = f"{{ramp: {{to: {speed:.3g}, over: 1.0}}}}"
        asked = "" if hangs else ", unless that is what is asked"
        yield f"Begin {drum.name if hangs else ''}{' ' * hangs}at 0 with a ramp, such as {ramp}{asked}"


def growth(scene: CraneScene, otherwise: str = "") -> str:
    """How the motion of vessel and frames can be made to grow from rest: `ramp` is not a key of every function."""
    cures = {
        BY_RAMP: "Use `ramp`: write ramp: 10 s beside the other keys of the motion",
        BY_TABLE: "Let the table begin with rest, and its values grow over some periods of the bounce",
        BY_CHIRP: "A chirp begins at once. Give a table of it that begins with rest and grows",
        BY_TIME: "Let the ramp begin at t = 0 or later",
    }
    kinds = {kind for function in _sudden(scene) for kind in _kinds(function)} or {BY_RAMP}
    return ". ".join(cure for kind, cure in cures.items() if kind in kinds) + otherwise


def _sudden(scene: CraneScene) -> Iterator[Any]:
    """What moves vessel and frames that has a speed or an acceleration at t = 0."""
    motion = None if scene.vessel is None else scene.vessel.motion
    if isinstance(motion, MotionFile | SeaMotion):
        yield motion
    moving = [getattr(motion, name) for name in MOTIONS] if isinstance(motion, Motion) else []
    for function in (*moving, *(turn for frame in scene.frames for turn in (frame.slew, frame.luff))):
        if np.any(sample(compile_functions([FunctionRequest(function)]), 0, np.zeros(1))[0, 1:] != 0.0):
            yield function


def _kinds(function: Any) -> Iterator[str]:
    """By which cures a function of time, or one of those that it is the sum of, begins slowly."""
    if isinstance(function, Sum):
        for term in function.terms:
            yield from _kinds(term)
    elif isinstance(function, Harmonic | Spectrum | MotionFile | SeaMotion):
        yield BY_RAMP
    elif isinstance(function, Chirp):
        yield BY_CHIRP
    elif isinstance(function, Table):
        yield BY_TABLE
    elif isinstance(function, Ramp):
        yield BY_TIME
