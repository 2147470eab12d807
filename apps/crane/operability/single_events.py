"""What a scene does once, at its own time: within the lead-in nobody judges it, and scaled it is no wave."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from crane.operability.asked import Asked
from crane.operability.conditions import SeaKeys
from crane.scene.keys import where
from crane.scene.scene import CraneScene
from crane.scene.surroundings import Motion
from crane.sea.frames import MOTIONS
from crane.warnings import driven_functions
from tautline.scene.functions import Ramp, Sum, Table, Velocity

WAVES = 2.0
"""Waves in which a sea grows from rest at least, and a lead-in lasts that is offered."""
MOST = 0.5
"""Share of a storm for which a motion goes on that is judged by it, were its first part within the lead-in."""


class Event(NamedTuple):
    """What changes by itself, and from when to when, s; both are one of what happens at once."""

    key: str
    begin: float
    end: float

    @property
    def said(self) -> str:
        """Key and time."""
        if self.end == self.begin:
            return f"{self.key} at {self.begin:.4g} s"
        if math.isinf(self.end):
            return f"{self.key} from {self.begin:.4g} s on"
        return f"{self.key} from {self.begin:.4g} s to {self.end:.4g} s"


def events_of(scene: CraneScene) -> list[Event]:
    """What winches, brakes, forces, booms and the vessel do once, and loads that are let go.

    Seas, harmonics and chirps go on, and so does what stays at one value or one speed: these are none.
    """
    found = [Event(key, *span) for key, function in functions_of(scene) for span in _changes(function)]
    for k, body in enumerate(scene.bodies):
        if body.release is not None:
            found.append(Event(f"bodies[{k}].release", body.release.at, body.release.at))
    for drum in scene.drums:
        if drum.brake is not None and drum.brake.until is not None:
            found.append(Event(where(scene, drum, "brake.until"), drum.brake.until, drum.brake.until))
    return sorted((one for one in found if one.end > 0.0), key=lambda one: one.begin)


def functions_of(scene: CraneScene) -> Iterator[tuple[str, Any]]:
    """Keys and functions of time of winches, brakes, forces, booms and of the six motions of a vessel."""
    yield from driven_functions(scene)
    for k, frame in enumerate(scene.frames):
        yield f"frames[{k}].slew", frame.slew
        yield f"frames[{k}].luff", frame.luff
    motion = None if scene.vessel is None else scene.vessel.motion
    for name in MOTIONS if isinstance(motion, Motion) else ():
        yield f"vessel.motion.{name}", getattr(motion, name)


def _changes(function: Any) -> list[tuple[float, float]]:
    """First and last times, s, at which terms of a function change once, from t = 0 on; none of one that never does."""
    if isinstance(function, Velocity):
        return _changes(function.velocity)
    if isinstance(function, Sum):
        return [span for term in function.terms for span in _changes(term)]
    if isinstance(function, Ramp):
        still = function.to == function.from_ if function.rate is None else function.rate == 0.0
        # At a rate the value grows on for good.
        end = function.at + function.over if function.rate is None else math.inf
        return [] if still else [(max(function.at, 0.0), end)]
    if isinstance(function, Table):
        steps = [k for k in range(len(function.time) - 1) if function.value[k + 1] != function.value[k]]
        return [(max(function.time[steps[0]], 0.0), function.time[steps[-1] + 1])] if steps else []
    return []


def event_notes(scene: CraneScene, keys: SeaKeys, asked: Asked, judged: bool) -> list[str]:
    """Which events storms judge otherwise than is meant; `judged` is whether extremes are asked for."""
    end = asked.lead + asked.simulated
    events = events_of(scene)
    early = [one for one in events if one.begin < asked.lead and not _lasts(one, asked)]
    late = [one for one in events if one.begin >= end]
    counted = [one for one in events if one.begin < end and one.end > asked.lead and _once(one, asked.lead, end)]
    found = [_in_lead(early, keys, scene, asked)] if early else []
    if late:
        found.append(
            f"storms end at {end:g} s, and these come later: {_listed(late)}. They never happen in a storm, and no "
            "limit judges them. Give the scene earlier times, or run longer storms"
        )
    if counted and judged and asked.simulated < asked.duration:
        found.append(
            f"extremes are scaled in time, and this happens once in each storm: {_listed(counted)}. Scaled, it counts "
            "as if it came again and again as waves do, and the largest of the waves is not seen beside it. Judge it "
            f"by itself: take --simulate {asked.duration:g}s, or --duration {asked.simulated:g}s for the operation "
            "with it and a scene without it for the waiting"
        )
    return found


def _lasts(one: Event, asked: Asked) -> bool:
    """Whether something goes on behind the lead-in for most of the storm, as a record of motion: that is judged."""
    return one.end - asked.lead >= MOST * asked.simulated


def _once(one: Event, lead: float, end: float) -> bool:
    """Whether something is over in a storm, or begins in it: what goes on all through it, as a record, is no event."""
    return one.begin > lead or one.end < end


def _in_lead(early: Sequence[Event], keys: SeaKeys, scene: CraneScene, asked: Asked) -> str:
    """What is not judged, as it comes before the storms count, and what to do about it."""
    first = early[0].begin
    grown = max(one.ramp for one in keys.seas(scene).values())
    least = max(grown, WAVES * max(one.period for one in asked.conditions))
    shorter = f"Give --lead-in {first:.6g}s, or" if first >= least else "To have it judged,"
    begins = f"{first:.4g} s becomes {first + asked.lead:.4g} s"
    whole, begun = [one for one in early if one.end <= asked.lead], [one for one in early if one.end > asked.lead]
    told = f"nothing counts in the lead-in of {asked.lead:g} s: storms are judged by what comes after"
    if whole:
        told += f". The scene does this in it: {_listed(whole)}. No limit judges it"
    if begun:
        told += f". The scene begins this in it: {_listed(begun)}. No limit judges its first part"
    return f"{told}. {shorter} add {asked.lead:g} s to its times in the scene: {begins}"


def _listed(events: Sequence[Event]) -> str:
    return "; ".join(one.said for one in events)


def lead_notes(asked: Asked) -> list[str]:
    """A lead-in in which no sea can grow: the load rests, and storms count how the sea sets in."""
    longest = max(one.period for one in asked.conditions)
    if asked.lead >= longest:
        return []
    return [
        f"--lead-in {asked.lead:g} s is shorter than one wave of {longest:g} s. The load rests at first, and how the "
        f"sea sets in counts as if it were the storm. Give some waves: --lead-in {10.0 * longest:g}s"
    ]
