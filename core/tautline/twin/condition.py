"""How far what a twin tells can be trusted, and why no farther: the health of a line, with its causes in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tautline.twin.signals.readings import Readings

GOOD, DEGRADED, LOST = "good", "degraded", "lost"
HEALTHS = (GOOD, DEGRADED, LOST)
"""From the best to the worst, as results number them."""
SIMPLY = "what is computed is in doubt"
"""Said where a state of an earlier version has it that what is computed is in doubt, and not why."""

NOT_KNOWN_YET = "what is estimated is not known well, and what is computed of this sensor is uncertain by that"
SHAKEN = "noise of the inputs moves what is computed by far more than the sensor's deviation"
MISSES = "what is computed misses what is measured, row after row, and the estimate does not explain it"
FAR = "the estimate is far from the values that are simulated"
SHOWS_LITTLE = "inputs shake the simulated load, and the data have not shown every estimate yet"
STARVES = "most readings cannot be used, as what is simulated moves out of step with the machine"
"""Why what is computed is in doubt; those of one sensor stand after its name."""
GUESSED = (
    "the estimates are not known well yet: a computed value that exceeds its bound is told only where it exceeds that "
    "by more than two of its standard deviations"
)
"""Said with what the sensors have not shown, as long as bounds are judged so."""


def condition_of(twin: Any) -> tuple[str, list[str]]:
    """Health of a twin now, and its causes: sentences without a full stop, none where it is good."""
    lost = [twin.loss.text] if twin.loss.text else _lost(twin.readings)
    causes = [*lost, *_faults(twin.readings), *_not_followed(twin)]
    causes += (twin.doubts or [SIMPLY]) if twin.unsure else []
    return LOST if lost else DEGRADED if causes else GOOD, list(dict.fromkeys(causes))


def not_shown(twin: Any) -> list[str]:
    """Sentences on what the sensors have not shown so far, and on what is not judged before they have."""
    horizon = twin.estimate.horizon
    waits = twin.plan.unknowns and twin.plan.alarms and not horizon.found
    return [*horizon.not_observable(), *([GUESSED] if waits else [])]


def _lost(readings: Readings) -> list[str]:
    """Without which nothing can be simulated: an input, or all sensors."""
    lost = [one.fault == "lost" for one in readings.health]
    if all(lost):
        return ["all sensors are lost"]
    missing = [one.channel for one in readings.tracks if one.missing and lost[one.number]]
    return [f"{one.column} is lost, and it drives {one.name}" for one in missing]


def _faults(readings: Readings) -> list[str]:
    """What is wrong with sensors and with the inputs that they show."""
    found = []
    for one in readings.health:
        column = one.channel.column
        if one.fault:
            found.append(one.text or f"{column}: {one.fault}")
        if one.contradicts:
            found.append(f"{column} stays dozens of standard deviations off what is expected")
        if one.jumping(one.seen):
            found.append(one.jump)
    for track in readings.tracks:
        if track.missing:
            comes = readings.rows.spacing.has_come_since(track.number, track.time)
            nothing = "has no reading near the time of the row" if comes else "shows nothing now"
            what = readings.rare.get(track.number, f"{track.channel.column} {nothing}")
            found.append(f"{what}, so {track.channel.name} is made up")
        elif track.joining:
            found.append(f"{track.channel.name} was made up, and is on its way back to {track.channel.column}")
    found += [f"{name} is far from where the scene begins" for name in readings.far]
    return found


def _not_followed(twin: Any) -> list[str]:
    """Why what is computed does not follow the machine."""
    found = []
    if not twin.now >= twin.unsettled:
        found.append("readings do not count yet, as the simulation or an input has begun anew")
    if twin.settling.catching_up:
        found.append("what is computed does not agree with what is measured yet, after an input was made up")
    if twin.backlog is not None and twin.backlog.behind:
        found.append("the twin is behind the machine")
    return [*found, *twin.watch.contradicted().values()]
