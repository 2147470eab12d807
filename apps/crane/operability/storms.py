"""Run the storms of all sea states by a sweep, and judge them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from crane.operability.allowable import Table, tabulate
from crane.operability.asked import Asked
from crane.operability.conditions import (
    Condition,
    SeaKeys,
    cases_of,
    headings_that_run,
    highest,
    sea_keys,
    sea_notes,
)
from crane.operability.criteria import (
    Criterion,
    bare_notes,
    check_scaled,
    lasting_notes,
    limits_of_scene,
    none_given,
    notes_on,
    read_criteria,
    reversed_notes,
)
from crane.operability.run_limits import (
    MOST_SHOWN,
    Failed,
    RunLimit,
    above_strength,
    failures,
    of_run,
    state_said,
    warnings_of,
)
from crane.operability.scatter import COLLECTED, Fatigue, fatigue_over, not_covered, share_outside
from crane.operability.single_events import event_notes, lead_notes
from crane.operability.steadiness import growing_notes, trends_of
from crane.results.out_of_water import heights_of, out_of_water_in_storms
from crane.results.summary import JOINED, NOTHING, OF_TURNS
from crane.sea.vessel import BY_KEY
from tautline.scene.errors import SceneError, SceneWarning, option_error
from tautline.statistics.gumbel import FEWEST
from tautline.sweeps.execution import Execution
from tautline.system.handles import Handles

PROBE = 3.0
"""Time, s, of a run that tells which figures there are, and their units."""
TENSION = "tension"
SHORTEST, LONGEST = 60.0, 30.0 * 86400.0
"""Durations, s, of operations at sea: a lift off a deck, and a month of work."""
MOST_SCALED, FEW_PERIODS = 10.0, 100.0
"""Ratio of durations up to which extremes are scaled without a note, and waves that a scaled storm should have."""


@dataclass
class Found:
    """What came of it; ``table`` is None where the sweep was interrupted, or no case came to its end.

    ``warnings`` are what makes a result less safe than it reads, and is told whoever asks for quiet. ``failed`` are the
    limits of every run that storms failed. ``said_before`` are the warnings that were said before anything ran.
    """

    outcome: Any
    criteria: list[Criterion]
    table: Table | None = None
    fatigue: Fatigue | None = None
    failed: list[Failed] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    said_before: list[str] = field(default_factory=list)


def operability(application: Any, scene: Any, asked: Asked, execution: Execution | None = None) -> Found:
    """Run storms over sea states and seeds, and find what is allowed.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    """
    from tautline.sweeps.file import read_sweep
    from tautline.sweeps.sweep import run_sweep

    execution = execution or Execution()
    keys = sea_keys(scene, any(one.heading is not None for one in asked.conditions))
    texts = [*asked.limits, *limits_of_scene(scene)]
    _check_steepness(asked.conditions)
    _check(asked, texts)
    _check_ramps(keys, scene, asked.lead)
    vary = cases_of(asked.conditions, asked.seeds, keys)
    first = {key: values[0] for key, values in vary.items()}
    any_storm = scene.replace(first, origin="--hs, --tp, --heading, --seeds")
    _check_seas(application, scene, keys, asked)
    figures, handles, of_every_run = _found_by(application, any_storm, execution.announce)
    if asked.constant is not None and scene.rope.breaking_load is None:
        cause = "needs the breaking load of the rope, which the scene does not give"
        raise option_error("--sn-constant", f"{asked.constant:g}", cause, "give rope.breaking_load")
    if not texts and asked.scatter is None:
        raise none_given(scene)
    criteria = read_criteria(texts, figures, handles.outputs, handles.instead)
    of_command = criteria[: len(read_criteria(asked.limits, figures, handles.outputs))]
    if asked.simulated < asked.duration:
        check_scaled(criteria, of_command, f"{asked.duration:g}s")
    collect = _collected(asked, criteria)
    storm = _storm(scene, asked, keys, collect)
    # Frames and statistics both tell them.
    collect += [column for one in of_every_run for column in one.columns]
    wet = heights_of(scene)
    collect += [column for column in wet.values() if column not in collect]
    notes = sea_notes(storm.replace(first), keys) + (scale_notes(asked) if criteria else [])
    # Those of the scene are told with its other numbers without a unit.
    doubts = duration_notes(asked) + bare_notes(of_command, scene.units) + reversed_notes(of_command)
    doubts += share_notes(asked, criteria) + above_strength(criteria, scene) + lead_notes(asked)
    doubts += event_notes(scene, keys, asked, any(one.extreme for one in criteria))
    notes += notes_on(criteria)
    notes += lasting_notes(scene) + outside_notes(asked) + [*asked.not_reached]
    read = read_sweep({"scene": "scene", "vary": vary, "plan": "zip", "collect": collect})

    said_before: list[str] = []

    def begun() -> None:
        execution.begin()
        # Both before anything runs: an operation of hours is many runs.
        for doubt in doubts:
            execution.say(f"warning: {doubt}")
        for note in notes:
            execution.say(f"note: {note}")
        said_before[:] = doubts

    trends = trends_of(criteria) if asked.simulated < asked.duration else {}
    outcome = run_sweep(read, application, storm, replace(execution, begin=begun), asked.lead, trends)
    found = Found(outcome, criteria, notes=notes, warnings=[*doubts], said_before=said_before)
    if outcome.interrupted or not outcome.done:
        return found
    ratio = asked.duration / asked.simulated
    found.table = tabulate(
        outcome.data, asked.conditions, criteria, asked.seeds, ratio, asked.share, asked.confidence, asked.compared,
        NOTHING,
    )  # fmt: skip
    found.failed = failures(outcome, found.table, asked.conditions, of_every_run)
    found.warnings += failed_notes(found.table, len(asked.seeds), scene.units)
    found.warnings += endless_notes(found.table, criteria)
    found.warnings += growing_notes(outcome.data, asked, criteria, scene.units)
    found.warnings += out_of_water_in_storms(outcome.data, wet, storm, asked.lead)
    if asked.scatter is not None:
        found.fatigue = _fatigue(outcome.data, asked, scene, found.table)
    share = None if found.fatigue is None else found.fatigue.share
    found.warnings += warnings_of(found.failed, found.table, share, scene.units)
    if found.fatigue is not None:
        found.warnings += not_covered(found.fatigue)
    return found


def occurring(asked: Asked, scene: Any) -> Asked:
    """The same, without sea states that never occur where nothing but fatigue is asked for: they do no damage.

    Raises
    ------
    SceneError
        Where none of them occurs: there is nothing to run.
    """
    if asked.scatter is None or asked.limits or limits_of_scene(scene):
        return asked
    found = [one for one in asked.conditions if asked.scatter.of(one.height, one.period) > 0.0]
    if not found:
        heights, periods = (", ".join(f"{x:g}" for x in of) for of in (asked.scatter.heights, asked.scatter.periods))
        cause = "none of the sea states of --hs and --tp occurs in the diagram: there is no fatigue to count"
        cure = f"leave --hs and --tp out, or give some of its heights, {heights} m, and of its periods, {periods} s"
        raise option_error("--scatter", "", cause, cure)
    return replace(asked, conditions=found)


def outside_notes(asked: Asked) -> list[str]:
    """How much of a scatter diagram is not among the sea states that run: storms of hours tell it late."""
    if asked.scatter is None:
        return []
    share = share_outside(asked.scatter, [(one.height, one.period) for one in asked.conditions if one.physical])
    if not share:
        return []
    return [
        f"{100.0 * share:.3g} % of the time of the scatter diagram will not be run (too steep, or not among --hs and "
        "--tp): its damage will not be counted"
    ]


def _check_seas(application: Any, scene: Any, keys: SeaKeys, asked: Asked) -> None:
    """Build a storm of each heading and period: what the file of responses lacks would else fail storm by storm.

    Raises
    ------
    SceneError
        Naming the heading and the period.
    """
    seen: set[tuple[float | None, float]] = set()
    for one in asked.conditions:
        if not one.physical or (one.heading, one.period) in seen:
            continue
        seen.add((one.heading, one.period))
        try:
            application.build(scene.replace(keys.changes(one, asked.seeds[0]), origin="--heading, --tp"))
        except SceneError as error:
            heading = "" if one.heading is None else f", heading {math.degrees(one.heading):g} deg"
            where = f"sea of Tp {one.period:g} s{heading}"
            # With headings it is the option that asks for a direction, and not the scene's key.
            asks = BY_KEY if one.heading is None else "give --heading"
            raise SceneError(
                [
                    replace(problem, cause=f"{where}: {problem.cause}", cure=problem.cure.replace(BY_KEY, asks))
                    for problem in error.problems
                ]
            ) from None


def warnings_of_storms(of_scene: Sequence[SceneWarning], scene: Any, asked: Asked) -> list[SceneWarning]:
    """Warnings of the scene, with what is doubtful of the seas that run in place of the scene's own, which may not."""
    from crane.warnings import doubts_of_motion
    from tautline.scene.values.printed import in_words
    from tautline.scene.warnings import line_of

    def doubts(changed: Any) -> list[SceneWarning]:
        told = ((place, in_words(text, scene.units)) for place, text in doubts_of_motion(changed))
        return [SceneWarning(place, text, line_of(scene.document, place)) for place, text in told]

    keys, own = sea_keys(scene, any(one.heading is not None for one in asked.conditions)), doubts(scene)
    of_storms: list[SceneWarning] = []
    for one in headings_that_run(asked.conditions):
        of_storms += doubts(scene.replace(keys.changes(one, asked.seeds[0]), origin="--heading"))
    return [*(one for one in of_scene if one not in own), *dict.fromkeys(of_storms)]


def duration_notes(asked: Asked) -> list[str]:
    """Notes on a duration that no operation at sea has: 3 is 3 s, and 3 h is probably meant."""
    if asked.duration >= SHORTEST or not asked.bare:
        return []
    typed = f"{asked.duration:g}"
    hours = f"if {typed} h is meant, write --duration '{typed} h'" if 3600.0 * asked.duration <= LONGEST else "check it"
    return [f"--duration is {typed} s, and extremes are those of {typed} s. An operation at sea takes longer: {hours}"]


def share_notes(asked: Asked, criteria: Sequence[Criterion]) -> list[str]:
    """A note on a percentile by which an allowed sea passes its limits in most storms."""
    if asked.compared != "percentile" or asked.share >= 0.5 or not criteria:
        return []
    written, other = 100.0 * asked.share, 100.0 - 100.0 * asked.share
    least = next((one.of_storm for one in criteria if one.way < 0.0), "")
    turned = f"; P10 of {least} is what P90 compares" if least else ""
    return [
        f"--percentile P{written:.12g}: in a sea that is allowed {other:.12g} % of the storms may pass the limit. The "
        f"percentile is the share of storms that keep it{turned}. Was P{other:.12g} meant?"
    ]


def failed_notes(table: Table, storms: int, system: str = "si") -> list[str]:
    """Which sea states have storms that failed, and what is not told of them."""
    if not table.failed:
        return []

    def said(at: tuple[int, ...]) -> str:
        return f"{state_said(table, at, system)} ({storms - table.done[at]} of {storms})"

    shown = "; ".join(said(at) for at in table.failed[:MOST_SHOWN])
    more = len(table.failed) - MOST_SHOWN
    also = f"; and {more} more, see operability.csv" if more > 0 else ""
    milder = " The others are milder, and of" if any(table.done[at] for at in table.failed) else " Of"
    return [
        f"storms failed in {len(table.failed)} of the sea states: {shown}{also}. Storms that fail are often those in "
        f"which the rope snaps.{milder} such a sea state no extremes are given"
    ]


def endless_notes(table: Table, criteria: Sequence[Criterion]) -> list[str]:
    """Limits of which the values of storms, or what is found of them, have no end, and what files have of these."""
    told = []
    for k, one in enumerate(criteria):
        ends = np.array([np.isinf(values[k]) for values in table.extremes.values()]).any(axis=0)
        ends |= np.isinf(table.values[k]).any(axis=-1)
        if count := int(ends.sum()):
            told.append(
                f"{one.text}: in {count} of the {ends.size} sea states a value, or an end of an interval, is a rope "
                f"without tension. Its {one.name} has no end. It is left out of the tables"
            )
    return told


def scale_notes(asked: Asked) -> list[str]:
    """What is to be known of extremes that are scaled from shorter storms."""
    ratio, longest = asked.duration / asked.simulated, max(one.period for one in asked.conditions)
    found = []
    if ratio > MOST_SCALED * (1.0 + 1e-9):
        found.append(
            f"extremes are scaled by {ratio:.3g} in time, more than about {MOST_SCALED:g}: intervals do not hold the "
            f"error of that. Take --simulate {asked.duration / MOST_SCALED:.0f}s or more"
        )
    if ratio > 1.0 and asked.simulated < FEW_PERIODS * longest:
        found.append(
            f"a storm of {asked.simulated:g} s has some {asked.simulated / longest:.0f} waves of {longest:g} s: of so "
            f"few the largest does not follow Gumbel's distribution well. Take --simulate {FEW_PERIODS * longest:.0f}s "
            "or more"
        )
    return found


def _check_ramps(keys: SeaKeys, scene: Any, lead: float) -> None:
    """Refuse a lead-in that ends before the sea is grown: the storm would be too low, and nothing would show it."""
    for key, sea in keys.seas(scene).items():
        if sea.ramp > lead * (1.0 + 1e-9):
            cause = f"is shorter than {key}.ramp, {sea.ramp:g} s: the sea would still grow when the storm counts"
            raise option_error("--lead-in", f"{lead:g} s", cause, f"give --lead-in {sea.ramp:g}s or more")


def _check_steepness(conditions: Sequence[Condition]) -> None:
    """Refuse seas of which none is physical: there is nothing to run."""
    if any(one.physical for one in conditions):
        return
    lowest, longest = min(one.height for one in conditions), max(one.period for one in conditions)
    most = highest(longest, conditions[0].gravity)
    cause = (
        f"no sea state of these heights and periods is physical: all are steeper than waves can be. Waves of Tp "
        f"{longest:g} s are {most:.3g} m high at most (DNV-RP-C205, 3.5.4), and the lowest asked for are {lowest:g} m"
    )
    raise option_error("--hs", "", cause, "give lower waves or longer periods")


def _check(asked: Asked, limits: Sequence[str]) -> None:
    if len(asked.seeds) < FEWEST and limits:
        cure = f"give {FEWEST} at least; 10 give an interval of use"
        raise option_error("--seeds", str(len(asked.seeds)), "are too few storms for a distribution", cure)
    if asked.simulated > asked.duration:
        cure = "simulate as long as --duration, or less"
        raise option_error("--simulate", f"{asked.simulated:g} s", f"is longer than {asked.duration:g} s", cure)


def _found_by(
    application: Any, scene: Any, announce: Callable[[int], Any] | None
) -> tuple[dict[str, str], Handles, list[RunLimit]]:
    """Figures that a run of the scene finds, with their units, its handles and its limits; by a run of a moment."""
    from tautline.live.readings import handles_of
    from tautline.simulation import simulate

    interval = min(float(scene.output.interval), 0.1 * PROBE)
    short = scene.replace({"solver.end": PROBE, "output": {"interval": interval}})
    model = application.build(short)
    result = simulate(model, announce=announce)
    figures = {name: str(one.get("unit") or "") for name, one in result.headline.items()}
    sometimes = {name: unit for name, unit in model.figure_units.items() if name in NOTHING}
    return {**sometimes, **figures}, handles_of(model), of_run(result.limits)


def _collected(asked: Asked, criteria: Sequence[Criterion]) -> list[Any]:
    """What every run is asked for: what the limits judge, and what fatigue is counted from; each once."""
    collect = [one.collected for one in criteria]
    names = {one.column for one in criteria}
    collect += [name for name in COLLECTED if asked.scatter is not None and name not in names]
    return list({str(one): one for one in collect}.values())


def _storm(scene: Any, asked: Asked, keys: SeaKeys, collect: Sequence[Any]) -> Any:
    """The scene with the length of a storm, ramps within half its lead-in, and statistics where they hold all asked."""

    def kept(one: Any) -> bool:
        return not isinstance(one, str) or one in OF_TURNS or any(re.fullmatch(rule, one) for rule in JOINED)

    interval = float(scene.output.interval)
    output: dict[str, Any] = {"interval": interval}
    if all(kept(one) for one in collect):
        output |= {"keep": "statistics", "of": [TENSION], "windows": interval, "begin": asked.lead}
    own = {"solver.end": asked.lead + asked.simulated, "output": output}
    return scene.replace(own | keys.ramps(scene, 0.5 * asked.lead), origin="--duration")


def _fatigue(data: Any, asked: Asked, scene: Any, table: Table) -> Fatigue:
    """Damage over the scatter diagram; the lead-in counts for nothing."""
    assert asked.scatter is not None
    shape = (len(table.headings), len(table.periods), len(table.heights), len(asked.seeds))
    arrays = {name: np.full(shape, math.nan) for name in COLLECTED}
    done = data["status"].values == "done"
    case = 0
    for one in asked.conditions:
        if not one.physical:
            continue
        at = (
            table.headings.index(one.heading), int(np.searchsorted(table.periods, one.period)),
            int(np.searchsorted(table.heights, one.height)),
        )  # fmt: skip
        some = slice(case, case + len(asked.seeds))
        case += len(asked.seeds)
        for name, array in arrays.items():
            array[at] = np.where(done[some], data[name].values[some], math.nan)
    return fatigue_over(
        asked.scatter, table.heights, table.periods, *arrays.values(), asked.simulated, scene.rope.breaking_load,
        asked.constant,
    )  # fmt: skip
