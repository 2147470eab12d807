"""The figures that sum a run up: the largest tensions, where and when, and what they did to the rope."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import Any

import numpy as np

from crane.assembly.friction import slips
from crane.assembly.layout import Layout
from crane.assembly.tension_at_rest import static_tension
from crane.results.course import Course, contacts_of, course_of, laid_out
from crane.results.out_of_water import comes_through, taken_off_the_water
from crane.results.power import WinchEnergy, winch_energy
from crane.rope_life.bending import BendingCycles, bending_cycles
from crane.rope_life.events import Peak, amplification_of, checked, columns, largest, safety_factor, slack_events
from crane.rope_life.fatigue import SLOPE, RainflowCycles, equivalent_range, rainflow_counts
from crane.scene.scene import CraneScene, Sheave
from tautline.results.variable import at_rest, at_start, late_start
from tautline.statistics.streaming import Turns

SLACK = 0.01
"""Share of the largest tension at rest below which a span counts as slack."""
MOST_SHEAVES = 4
"""Sheaves up to which the largest tension is told of each side; of more only the largest of all."""
FEWEST = 3
"""Frames above half of a snap, below which they do not show how high it is: two may stand astride its top."""
MOST_BODIES = 4
BARELY = 0.05
"""Share of the tension of the load hanging free below which the rope hardly carries it at the start."""
NO_ANGLE = 1.0e-9
"""Rounding of an angle, rad."""
METRE, MOST_BINS = 1.0, 2000

FIGURES = {
    "max_tension": "N", "min_tension": "N", "dynamic_amplification": "", "safety_factor": "",
    "slack_events": "", "longest_slack": "s", "max_snap": "N", "undamped_snaps": "", "snap_frames": "",
    "max_sheave_load": "N", "max_fleet_angle": "rad", "slipping_share": "",
    "equivalent_tension_range": "N", "tension_cycles": "", "max_bending_cycles": "", "smallest_bending_ratio": "",
    "max_offlead": "rad", "max_sidelead": "rad",
}  # fmt: skip
OF_BENDING = frozenset({"max_bending_cycles", "smallest_bending_ratio"})
"""Those that there are with a diameter of the rope alone."""
OF_DRUMS = {"max_winch_power": "W", "mean_winch_power": "W", "energy_hoisted": "J", "energy_regenerated": "J"}
OF_BODIES = {"rise": "m", "max_rise": "m", "max_displacement": "m"}
"""Figures and their units: of the rope, of each drum, of each body. Some of them only some runs have."""
NOTHING = frozenset({"longest_slack", "max_snap", "undamped_snaps", "snap_frames", "slipping_share"})
"""Those that a run is without because there is no slack and no slip."""

Row = tuple[str, Any, str, str]
"""Name, value, unit and text of a figure."""


def headline(
    result: Any,
    scene: CraneScene,
    layout: Layout | None = None,
    names: Collection[str] = (),
) -> dict[str, dict[str, Any]]:
    """Figures that sum a run up: name -> {value, unit, text}, SI.

    Parameters
    ----------
    result : Result
        One frame at least.
    scene : CraneScene
    layout : Layout, optional
        Of the scene, where it was laid out already.
    names : collection of str
        Figures that are wanted: others may be left out. All for nothing.
    """
    layout = layout or laid_out(scene)
    parts: list[tuple[str, Callable[[], Iterator[Row]]]] = [
        ("max_tension|min_tension|dynamic_amplification|safety_factor", lambda: _tensions(result, layout, names)),
        ("slack_events|longest_slack|max_snap|undamped_snaps|snap_frames", lambda: _slack(result, layout)),
        ("max_sheave_load|max_fleet_angle|slipping_share", lambda: _sheaves(result, scene)),
        ("max_winch_power|mean_winch_power|energy_", lambda: _winches(result, scene)),
        ("equivalent_tension_range|tension_cycles", lambda: _fatigue(result, scene)),
        ("max_bending_cycles|smallest_bending_ratio", lambda: _bending(result, course_of(result, layout))),
        ("rise|max_rise|max_displacement", lambda: _bodies(result, scene)),
        ("max_offlead|max_sidelead", lambda: _angles(result)),
    ]
    wanted = [part for begins, part in parts if not names or _any_begins(begins, frozenset(names))]
    rows = [row for part in wanted for row in part()]
    return {
        name: {"value": int(value) if isinstance(value, int) else float(value), "unit": unit, "text": text}
        for name, value, unit, text in rows
    }


@functools.lru_cache(maxsize=64)
def _any_begins(begins: str, names: frozenset[str]) -> bool:
    """Whether any name is of a part: asked anew for each of many runs."""
    return any(re.match(begins, name) for name in names)


def figure_units(scene: CraneScene) -> dict[str, str]:
    """Names of all figures that a run of a scene can have, and their units: without a diameter none of bending."""
    drums, bodies = scene.drums, scene.bodies[:MOST_BODIES]
    of_rope = {name: unit for name, unit in FIGURES.items() if scene.rope.diameter or name not in OF_BENDING}
    found = of_rope | {f"max_tension_{key}": "N" for key, _ in _places(scene)}
    for drum in drums:
        found |= {f"{name}_{slug(drum.name)}" if len(drums) > 1 else name: unit for name, unit in OF_DRUMS.items()}
    for body in bodies:
        several = len(scene.bodies) > 1
        found |= {f"{name}_{slug(body.name)}" if several else name: unit for name, unit in OF_BODIES.items()}
    return found


def possible_figures(scene: CraneScene) -> tuple[str, ...]:
    """Names of the figures that a run of a scene can have, whatever it does.

    Of `figure_units` those are left out that this scene has nothing of: sheaves, what a rope could slip on.
    """
    none = set()
    if not scene.sheaves:
        none |= {"max_sheave_load", "max_fleet_angle"}
    if not any(slips(sheave) for sheave in scene.sheaves):
        none.add("slipping_share")
    if not _snaps_undamped(scene):
        none.add("undamped_snaps")
    if not (scene.sheaves or scene.drums):
        none |= OF_BENDING
    return tuple(name for name in figure_units(scene) if name not in none)


def _snaps_undamped(scene: CraneScene) -> bool:
    """Whether snaps of a scene's rope come out too high for want of damping."""
    return scene.rope.damping == 0.0 and max(scene.elements) > 1


def span_ends(scene: CraneScene) -> list[str]:
    """Names of the ends of all spans, two a span: an item, and of a sheave the item that the side leads to."""
    path = scene.path
    names = []
    for k in range(len(path) - 1):
        one, two = path[k], path[k + 1]
        names.append(f"{one.name}, side of {two.name}" if isinstance(one, Sheave) else one.name)
        names.append(f"{two.name}, side of {one.name}" if isinstance(two, Sheave) else two.name)
    return names


def ends_of(result: Any) -> np.ndarray:
    """Tension at the ends of all spans, (m, 2 spans) N, in the order of `span_ends`."""
    tension = np.asarray(result["tension"])
    return tension.reshape(len(tension), -1)


def slug(name: str) -> str:
    """Name as part of a key."""
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_") or "item"


def _told(peak: Peak) -> str:
    return f"{peak.where}, at {peak.time:.4g} s"


def _if_any(peak: Peak, words: str) -> str:
    """Where and when a largest value is, in brackets: 0 has no place and no time."""
    return f" ({words})" if peak.value != 0.0 else ""


def size_of_angles(angles: Any) -> np.ndarray:
    """Magnitudes of a rope's angles, rad; 0 in the place of those up to `NO_ANGLE`."""
    size: np.ndarray = np.abs(angles)
    return np.where(size > NO_ANGLE, size, 0.0)


def _tensions(result: Any, layout: Layout, wanted: Collection[str] = ()) -> Iterator[Row]:
    """Largest and smallest, of the whole rope and where it is held."""
    scene = layout.scene
    tension = columns(result.time, ends_of(result), span_ends(scene))
    time, values, names = tension
    peak, low = tension.at(int(np.argmax(values))), tension.at(int(np.argmin(values)))
    yield "max_tension", peak.value, "N", f"largest tension ({_told(peak)})"
    yield "min_tension", low.value, "N", f"smallest tension ({_told(low)})"
    rest, word = _hung(result, layout)
    carried = np.where(rest > SLACK * rest.max(initial=0.0), rest, 0.0)
    less = taken_off_the_water(result, layout)
    if less is not None:
        carried = _as_hoisted(carried, less)
    if comes_through(result, scene):
        where = "where the load is" if less is not None else "at the start, in the water as it was then"
        word = f"{word}, over that at rest {where}"
    amplified = amplification_of(tension, carried)
    if amplified is not None:
        yield (
            "dynamic_amplification",
            amplified.value,
            "",
            f"dynamic amplification factor (DAF){word} ({_told(amplified)})",
        )
    safety = safety_factor(scene.rope.breaking_load, values)
    if safety is not None:
        yield "safety_factor", safety, "", "safety factor (breaking load / largest tension)"
    if wanted and not any(name.startswith("max_tension_") for name in wanted):
        return
    for key, sides in _places(scene):
        at = largest(time, values[:, sides], [names[k] for k in sides])
        yield f"max_tension_{key}", at.value, "N", f"largest tension at {_told(at)}"


def _as_hoisted(carried: np.ndarray, less: np.ndarray) -> np.ndarray:
    """Tension at rest, (m, n) N, from that at the start (n,) and what water lifts less at each time (m, 1).

    While the rope hardly carries a load that nearly floats, an amplification says nothing: over the most that it ever
    carries that time does not count.
    """
    made = np.where(carried > 0.0, carried + less, 0.0)
    most = made.max(axis=0)
    return np.where(made >= BARELY * most, made, most)


def _rest(result: Any, layout: Layout) -> tuple[np.ndarray, str]:
    """Tension at rest of every span end, (n,) N, and a note where it is an estimate, if a scene starts as drawn."""
    if layout.scene.start == "static":
        # A load that was changed on the way has another tension at rest, which is not known.
        changed = ", by the load at the start" if result.attributes.get("parameters_changed") else ""
        known = at_rest(result, "tension")
        if known is not None:
            return known.ravel(), changed
        # Of a start in another run, or by an earlier version, a frame is all there is: it has the rope's damping in it.
        first, late = np.ravel(at_start(result, "tension")), late_start(result)
        return first, f", over the tension at {late}" if late else f", over the tension in the first frame{changed}"
    found = static_tension(layout.scene, layout.path)
    # What nobody can estimate is amplified over nothing.
    none = np.zeros(np.size(at_start(result, "tension")))
    water = layout.scene.water
    still = " in still water" if water is not None and water.current is not None else ""
    return (none if found is None else found.ravel()), f", tension at rest{still} estimated"


def _hung(result: Any, layout: Layout) -> tuple[np.ndarray, str]:
    """What the largest tension is amplified over, (n,) N, and a note on it.

    It is the tension at rest. Where a load is lifted off the ground, or the rope hardly carries it at the start, that
    says nothing of the lift: then it is an estimate of the tension with which the load hangs free, as drawn. No number
    at all where a load stands on the ground and that is not known.
    """
    rest, word = _rest(result, layout)
    if layout.scene.start != "static":
        return rest, word
    found = static_tension(layout.scene, layout.path)
    grounded = _grounded(result, layout.scene)
    if found is None:
        return (np.zeros(rest.size), word) if grounded else (rest, word)
    free = found.ravel()
    if not grounded and rest.max(initial=0.0) >= BARELY * free.max():
        return rest, word
    return free, f"{word}, over the load hanging free, estimated"


def _grounded(result: Any, scene: CraneScene) -> bool:
    """Whether a body stands on the ground at the start of the run."""
    if scene.ground is None or "body_position" not in result:
        return False
    height = at_start(result, "body_position")[:, 2]
    return any(z - body.bottom <= scene.ground.level for z, body in zip(height, scene.bodies, strict=True))


def _places(scene: CraneScene) -> Iterator[tuple[str, list[int]]]:
    """Keys of the places of which the largest tension is told, and their columns."""
    path, few = scene.path, len(scene.sheaves) <= MOST_SHEAVES
    used: set[str] = set()

    def key(name: str) -> str:
        made, number = slug(name), 2
        while made in used:
            made, number = f"{slug(name)}_{number}", number + 1
        used.add(made)
        return made

    for i, item in enumerate(path):
        sides = [2 * i - 1] * (i > 0) + [2 * i] * (i < len(path) - 1)
        if not isinstance(item, Sheave):
            yield key(item.name), sides
        elif few:
            for word, column in zip(("in", "out"), sides, strict=True):
                yield key(f"{item.name} {word}"), [column]
    if scene.sheaves and not few:
        yield key("sheaves"), list(range(1, 2 * len(path) - 3))


def _slack(result: Any, layout: Layout) -> Iterator[Row]:
    """Times without tension, and the snaps that end them."""
    scene = layout.scene
    spans = [f"{one.name} to {two.name}" for one, two in zip(scene.path[:-1], scene.path[1:], strict=True)]
    ends = np.asarray(result["tension"])
    threshold = SLACK * float(_rest(result, layout)[0].max())
    first, last = ends[..., 0], ends[..., 1]
    found = slack_events(result.time, np.minimum(first, last), spans, threshold, most=np.maximum(first, last))
    yield "slack_events", len(found), "", "slack events"
    if not found:
        return
    longest = max(found, key=lambda event: event.duration)
    text = f"longest slack event ({longest.span}, from {longest.begin:.4g} s)"
    yield "longest_slack", longest.duration, "s", text
    snaps = [(event.snap, event) for event in found if event.snap is not None]
    if snaps:
        snap, event = max(snaps, key=lambda pair: pair[0])
        yield "max_snap", snap, "N", f"largest snap tension ({event.span}, at {event.snap_time:.4g} s)"
        at = int(np.argmin(np.abs(np.asarray(result.time) - event.snap_time)))
        frames = _frames_of(at, np.maximum(first, last)[:, spans.index(event.span)])
        few = ": too few to show its height; take a shorter output.interval" if frames < FEWEST else ""
        yield "snap_frames", frames, "", f"frames above half of that snap{few}"
        if _snaps_undamped(scene):
            text = "snaps of a rope without damping: tensions up to 1.5 times too high; remove rope.damping"
            yield "undamped_snaps", len(snaps), "", text


def _frames_of(at: int, column: np.ndarray) -> int:
    """How many frames in a row, of tensions (m,), are above half of that of one of them."""
    low = np.flatnonzero(np.concatenate([[True], column < 0.5 * column[at], [True]])) - 1
    after = int(np.searchsorted(low, at))
    return int(low[after] - low[after - 1]) - 1


def _sheaves(result: Any, scene: CraneScene) -> Iterator[Row]:
    if not scene.sheaves:
        return
    names = [sheave.name for sheave in scene.sheaves]
    load = largest(result.time, np.linalg.norm(result["sheave_load"], axis=-1), names)
    yield "max_sheave_load", load.value, "N", f"largest force on a sheave ({_told(load)})"
    fleet = largest(result.time, size_of_angles(result["fleet_angle"]).max(axis=-1), names)
    yield "max_fleet_angle", fleet.value, "rad", "largest fleet angle" + _if_any(fleet, _told(fleet))
    slipping = np.asarray(result["slipping"]) != 0.0
    if slipping.any():
        k = int(np.argmax(slipping.mean(axis=0)))
        share = float(slipping[:, k].mean())
        yield "slipping_share", share, "", f"share of time with slip on {names[k]}"


def _winches(result: Any, scene: CraneScene) -> Iterator[Row]:
    several = len(scene.drums) > 1
    for k, drum in enumerate(scene.drums):
        tension, power = result["drum_tension"][:, k], result["winch_power"][:, k]
        # The rim's speed; where the rope is slack that of the unstretched rope is as good.
        pulls = np.abs(tension) > 1e-9 * max(1.0, float(np.abs(tension).max()))
        speed = np.where(pulls, power / np.where(pulls, tension, 1.0), -result["pay_out_speed"][:, k])
        found = winch_energy(result.time, tension, speed)
        end, of = (f"_{slug(drum.name)}", f" of {drum.name}") if several else ("", f" of {drum.name}")
        yield f"max_winch_power{end}", found.peak, "W", _power_told(of, found)
        yield f"mean_winch_power{end}", found.hoisting_mean, "W", f"mean power{of} while hoisting"
        yield f"energy_hoisted{end}", found.hoisted, "J", f"work of {drum.name} on the rope"
        yield f"energy_regenerated{end}", abs(found.regenerated), "J", f"energy regenerated by {drum.name}"


def _power_told(of: str, found: WinchEnergy) -> str:
    return f"largest power{of}" + _if_any(Peak(found.peak, "", found.peak_time), f"at {found.peak_time:.4g} s")


def _most_damaged(found: Iterable[RainflowCycles]) -> int:
    """Which of some cycles do most damage: equal but for rounding, the first of the path."""
    worked = [float(f"{equivalent_range(cycles, SLOPE, 1.0):.6g}") for cycles in found]
    return worked.index(max(worked))


def most_worked_end(time: np.ndarray, tension: np.ndarray) -> tuple[int, RainflowCycles]:
    """Column of (m, n) tensions whose rainflow cycles do most damage, and these.

    All columns are counted: no quick estimate tells the worst, for a ripple cuts a large swing into small ranges.
    """
    time, tension = checked(time, tension=tension)
    turns = Turns()
    turns.add(time, tension)
    k = _most_damaged(_without_times(*turns.cycles(column)) for column in range(tension.shape[1]))
    return k, rainflow_counts(time, tension[:, k])


def _fatigue(result: Any, scene: CraneScene) -> Iterator[Row]:
    """Equivalent range of the most worked span end."""
    k, cycles = most_worked_end(result.time, ends_of(result))
    yield from _of_cycles(span_ends(scene)[k], cycles)


def _of_cycles(name: str, cycles: RainflowCycles) -> Iterator[Row]:
    number = float(cycles.count.sum())
    text = f"equivalent tension range, {number:g} cycles, m = {SLOPE:g} ({name})"
    yield "equivalent_tension_range", equivalent_range(cycles, SLOPE), "N", text
    yield "tension_cycles", number, "", f"rainflow cycles of the tension ({name})"


JOINED = {
    r"max_(?!snap|bending_cycles).*|dynamic_amplification": "largest",
    r"min_tension|safety_factor": "smallest",
    r"rise.*": "last",
}
"""How figures of pieces of a run make those of the whole; the others are sums or counts over all frames."""
OF_EVENTS = {r"max_snap|longest_slack": "largest", r"smallest_bending_ratio": "smallest"}
"""Extremes that pieces of a run do not tell: of events that may be cut in two, and of contacts that may go on."""
INVERSE = frozenset({"safety_factor"})
"""Figures that are a constant over an extreme: safety factor, the breaking load over the largest tension."""
OF_PIECES = ("max_tension", "max_tension_", "max_sheave_load", "max_winch_power", "rise", "max_offlead")
"""One figure of each part of the headline that has such figures; ``max_tension_`` begins those of each place."""
OF_TURNS = ("equivalent_tension_range", "tension_cycles")
"""Figures that follow from the turning points of the tensions."""


def extreme_over_time(name: str) -> str:
    """Which extreme of all frames a figure is: ``largest`` or ``smallest``; empty of sums, counts, means and ends."""
    found = (how for rule, how in (JOINED | OF_EVENTS).items() if re.fullmatch(rule, name))
    return next((how for how in found if how in ("largest", "smallest")), "")


def _without_times(ranges: np.ndarray, count: np.ndarray) -> RainflowCycles:
    """Cycles of which only range and count are known."""
    unknown = np.full(ranges.size, np.nan)
    return RainflowCycles(ranges, unknown, count, unknown, unknown)


def figures_of_turns(turns: Any, scene: CraneScene) -> dict[str, dict[str, Any]]:
    """Figures of the most worked span end from the turning points of all tensions (`tautline.statistics.streaming`)."""
    names = span_ends(scene)
    found = [_without_times(*turns["tension"].cycles(k)) for k in range(len(names))]
    k = _most_damaged(found)
    return {
        name: {"value": float(value), "unit": unit, "text": text}
        for name, value, unit, text in _of_cycles(names[k], found[k])
    }


def bins_of(contacts: list[Any]) -> np.ndarray:
    """Ends of the metres of rope that contacts ever touch, material coordinates, m; wider for a long rope."""
    ends = np.concatenate([np.ravel(side) for contact in contacts for side in (contact.on, contact.off)])
    ends = ends[np.isfinite(ends)]
    width = METRE * max(1.0, np.ceil(float(np.ptp(ends)) / METRE / MOST_BINS))
    first, last = np.floor(ends.min() / width), np.floor(ends.max() / width) + 1.0
    return width * np.arange(first, last + 1.0)


def bending_of(result: Any, course: Course) -> BendingCycles | None:
    """Bending cycles of every metre of rope that comes to a sheave or drum; None where there is none of these.

    None without a diameter too: that tells what of the motion bends the rope, and what is a tremble that does not.
    """
    diameter = course.scene.rope.diameter
    contacts = contacts_of(result, course) if diameter else []
    return bending_cycles(result.time, contacts, bins_of(contacts), diameter) if contacts else None


def _bending(result: Any, course: Course) -> Iterator[Row]:
    found = bending_of(result, course)
    if found is None:
        return
    worst = found.most_worked()
    if worst is None:
        yield "max_bending_cycles", 0.0, "", "most bending cycles of a piece of rope"
    else:
        k, name = worst
        text = f"most bending cycles of a piece of rope ({found.edges[k]:g} to {found.edges[k + 1]:g} m, {name})"
        yield "max_bending_cycles", float(found.cycles[k]), "", text
    if found.ratio is not None and np.isfinite(found.ratio).any():
        yield "smallest_bending_ratio", float(found.ratio.min()), "", "smallest bending ratio D/d"


def _bodies(result: Any, scene: CraneScene) -> Iterator[Row]:
    if not scene.bodies:
        return
    position = np.asarray(result["body_position"])
    rest, late = at_start(result, "body_position"), late_start(result)
    since = f" since {late}" if late else ""
    for k, body in enumerate(scene.bodies[:MOST_BODIES]):
        end = f"_{slug(body.name)}" if len(scene.bodies) > 1 else ""
        yield f"rise{end}", float(position[-1, k, 2] - rest[k, 2]), "m", f"rise of {body.name} at the end{since}"
        highest = int(np.argmax(position[:, k, 2]))
        most = Peak(float(position[highest, k, 2] - rest[k, 2]), body.name, float(result.time[highest]))
        text = f"largest rise of {body.name}{since}" + _if_any(most, f"at {most.time:.4g} s")
        yield f"max_rise{end}", most.value, "m", text
        away = largest(result.time, np.linalg.norm(position[:, k] - rest[k], axis=-1), [body.name])
        text = f"largest displacement of {body.name}{since}" + _if_any(away, f"at {away.time:.4g} s")
        yield f"max_displacement{end}", away.value, "m", text


def _angles(result: Any) -> Iterator[Row]:
    for word in ("offlead", "sidelead"):
        if word not in result:
            return
        peak = largest(result.time, size_of_angles(result[word]), ["hook rope"])
        text = f"largest {word} of the hook rope" + _if_any(peak, f"at {peak.time:.4g} s")
        yield f"max_{word}", peak.value, "rad", text
