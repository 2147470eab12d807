"""What ``torque-drag`` found, on one screen: a table, and a sentence for whatever a driller must know."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from drillstring.scene.scene import LUMPED
from drillstring.statics.enough_links import ELEMENTS, PART, size_lowered
from drillstring.statics.motion import REAMING
from tautline.scene.errors import SceneWarning
from tautline.scene.values.printed import shown
from tautline.scene.values.systems import SYSTEMS, in_system
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from rich.table import Table

    from drillstring.scene.scene import DrillstringScene
    from drillstring.statics.back_calculation import Fit
    from drillstring.statics.torque_drag import Case, Overpull, Point

MOST_ROWS = 24
"""Rows of the table; of more, the figure and ``--json`` tell all."""
WORTH_TELLING = 1.0e-4
"""Error of a friction factor by the model below which nothing is said of it."""
IN_FULL = 6
"""Points up to which every number stands beside that of the soft string."""
WORDS = {
    "pick_up": "pick up", "slack_off": "slack off", "rotating": "rotating", "torque": "torque",
    "reaming_up": "reaming up", "reaming_down": "reaming down", "torque_up": "torque up", "torque_down": "torque down",
}  # fmt: skip
SHORT = {
    "pick_up": "up", "slack_off": "down", "rotating": "rotating", "reaming_up": "ream up", "reaming_down": "down",
    "torque": "torque",
}  # fmt: skip
"""Heads of columns."""
TORQUES = {"rotating": "torque", "reaming_up": "torque_up", "reaming_down": "torque_down"}
"""What the torque of a motion is called."""
MOST_STRETCHES = 8
"""Stretches of buckling that a sentence names."""
MOST_SENTENCES = 8
FEW_LINKS, COARSE = 40, 0.02
"""Links below which, and share of hook load or torque from which on, a mesh is said to be coarse."""
NOTHING = 1.0
"""Force, N, or torque, N m, that is none: nothing is a share of it."""
NO_STROKE = 1e-6
"""Stroke, m, below which no friction holds the bit."""


def column_unit(unit: str, largest: float, system: str) -> tuple[float, str]:
    """Factor to divide SI by, and the unit to write, the same for a whole column or axis."""
    if unit in SYSTEMS[system]:
        size = abs(largest) or 1.0
        value, name = in_system(size, unit, system)
        return size / value, name
    return (1e3, f"k{unit}") if unit in ("N", "N m") else (1.0, unit)


def table(cases: list[Case], system: str = "si") -> Table:
    """Table of the statics beside the soft string; it names the models where one of them is not lumped."""
    points = [point for case in cases for point in case.points]
    made = _in_full(points, system) if len(points) <= IN_FULL else _compact(cases, system)
    made.caption, made.caption_justify = _reamed(points[0], system), "left"
    return made


def _reamed(point: Point, system: str) -> str | None:
    """At what speeds the string is reamed; None where it is not."""
    motion = point.motions.get(REAMING[1])
    if motion is None:
        return None
    return f"reaming: {shown(motion.speed, 'm/s', system)} up or down, turning at {motion.rotary / RPM:.6g} rpm"


def numbers_of(point: Point) -> dict[str, tuple[float, float, str]]:
    """Statics, soft string and SI unit of a point's hook loads and torque."""
    found = {way: (point.hook_load(way), soft.hook_load, "N") for way, soft in point.soft.items()}
    return found | {
        name: (point.torque(way), point.soft[way].surface_torque, "N m")
        for way, name in TORQUES.items()
        if way in point.soft
    }


def header(cases: list[Case]) -> list[str]:
    """Names of the columns of the file of hook loads and torques, SI."""
    named = numbers_of(cases[0].points[0])
    units = {name: unit for name, (_, _, unit) in named.items()}
    statics = [f"{WORDS[name]} [{unit}]" for name, unit in units.items()]
    soft = [f"{WORDS[name]}, soft string [{unit}]" for name, unit in units.items()]
    return ["model", "friction", "depth [m]", *statics, *soft, "locks up"]


def rows(cases: list[Case]) -> list[list[Any]]:
    """Rows of that file, one for each depth of each friction factor and model; empty where there is no equilibrium."""
    made: list[list[Any]] = []
    for point in (point for case in cases for point in case.points):
        found = list(numbers_of(point).values())
        loads = [x if np.isfinite(x) else "" for x in (*(a for a, _, _ in found), *(b for _, b, _ in found))]
        friction = f"{point.friction:.6g}"
        made.append([point.model, friction, point.depth, *loads, " and ".join(WORDS[way] for way in point.locks)])
    return made


def _largest(points: list[Point], unit: str) -> float:
    values = [abs(x) for point in points for a, b, kind in numbers_of(point).values() if kind == unit for x in (a, b)]
    return max((x for x in values if np.isfinite(x)), default=0.0)


def _new_table(heads: list[str], gap: int = 2) -> Table:
    from rich.markup import escape
    from rich.table import Table

    made = Table(box=None, padding=(0, gap, 0, 0))
    for head in heads:
        # A unit in brackets is no mark-up.
        made.add_column(escape(head), justify="left" if head == "" else "right", no_wrap=True)
    return made


def _in_full(points: list[Point], system: str) -> Table:
    length, name = column_unit("m", max(point.depth for point in points), system)
    named = _shows_model(points)
    heads = ["model"] * named + ["friction", f"depth [{name}]", "", "statics", "soft string", "differs by"]
    made = _new_table(heads, gap=1 if named else 2)
    for point in points:
        head = [point.model] * named + [f"{point.friction:.3g}", f"{point.depth / length:.1f}"]
        for what, (ours, soft, unit) in numbers_of(point).items():
            factor, word = column_unit(unit, _largest(points, unit), system)
            made.add_row(*head, WORDS[what], _cell(ours / factor, word), _cell(soft / factor, word), _off(ours, soft))
            head = [""] * len(head)
    return made


def _shows_model(points: list[Point]) -> bool:
    """Whether to say which model a number is of."""
    return any(point.model != LUMPED for point in points)


def _compact(cases: list[Case], system: str) -> Table:
    """One row to a point, with the largest of its differences; evenly spaced depths where there are many."""
    points = [point for case in cases for point in case.points]
    length, name = column_unit("m", max(point.depth for point in points), system)
    force, newton = column_unit("N", _largest(points, "N"), system)
    moment, metre = column_unit("N m", _largest(points, "N m"), system)
    columns = [*points[0].soft, "torque"]
    # With more motions there is no room for the soft string beside them.
    beside = len(columns) == len(SHORT) - 2
    named = _shows_model(points)
    heads = ["model"] * named + [
        "friction",
        f"depth [{name}]",
        f"up [{newton}]",
        *(SHORT[way] for way in columns[1:-1]),
    ]
    made = _new_table([*heads, f"torque [{metre}]", *(["soft: load", "torque"] if beside else [])], gap=1)
    for case in cases:
        count = len(case.points)
        kept = np.unique(np.linspace(0, count - 1, min(max(2, MOST_ROWS // len(cases)), count)).round().astype(int))
        for point in (case.points[k] for k in kept):
            rows = numbers_of(point)
            hook = max((rows[way][:2] for way in point.soft), key=lambda pair: _share(*pair))
            values = [_cell(rows[way][0] / (moment if way == "torque" else force)) for way in columns]
            differences = [_off(*hook), _off(*rows["torque"][:2])]
            cells = [point.model] * named + [f"{point.friction:.3g}", f"{point.depth / length:.0f}", *values]
            made.add_row(*cells, *(differences if beside else []))
    return made


def _cell(value: float, unit: str = "") -> str:
    return f"{round(value, 2) + 0.0:.2f} {unit}".strip() if np.isfinite(value) else "–"


def _share(ours: float, soft: float) -> float:
    return abs(ours - soft) / abs(soft) if np.isfinite([ours, soft]).all() and soft != 0.0 else 0.0


def _off(ours: float, soft: float) -> str:
    if not np.isfinite([ours, soft]).all() or abs(soft) < NOTHING:
        return "–"
    # Without a sign before what is zero as written.
    share = round(100.0 * (ours / soft - 1.0), 2)
    return f"{share:+.2f} %" if share != 0.0 else "0.00 %"


def sentences(cases: list[Case], fitted: Fit | None, system: str = "si", block: float = 0.0) -> list[tuple[str, str]]:
    """Sentences and their colours: fit, lock-up, buckling, overpull; the first few where there are many.

    ``block`` is the weight of block and drive, N, that hook loads do not hold.
    """
    points = [point for case in cases for point in case.points]
    found = [] if fitted is None else [(fit_in_words(fitted, system), "green")]
    if fitted is not None and fitted.unexplained:
        found.append((_unexplained(fitted, system), "yellow"))
    if fitted is not None and fitted.out_of_reach:
        text = "the friction factor is the largest that is tried: the loads are out of its reach"
        found.append((f"{text}; check the loads, top.weight, mud and string", "yellow"))
    few = _coarse(points, system)
    found += _doublings(cases, system) + [(text, "yellow") for text in few]
    if not few:
        found += [(text, "green") for text in _beside_soft_string(cases, system)]
    warned = [(text, "yellow") for point in points for text in _warnings(point, points, system)]
    found += warned[:MOST_SENTENCES]
    if len(warned) > MOST_SENTENCES:
        found.append((f"and {len(warned) - MOST_SENTENCES} more of these: --json has them all", "yellow"))
    if not warned and all(not point.failures for point in points):
        found.append(("no part of the string buckles or locks up", "green"))
    if block > 0.0:
        found += [(text, "green") for text in _with_block(cases, system, block)]
    found += [(text, "green") for text in _strokes(cases, system)]
    least = _least_overpull(points)
    if least is not None and least.overpull is not None:
        if least.overpull.margin < 0.0:
            found.append((f"{_head(least, points, system)}: {_beyond_yield(least.overpull, system)}", "red"))
        else:
            found.append((_margin(least, points, system), "green"))
    return found


def yield_warnings(cases: list[Case], scene: DrillstringScene) -> list[SceneWarning]:
    """A warning where picking up pulls a section beyond its yield load, of the point at which it does so by most."""
    points = [point for case in cases for point in case.points]
    least = _least_overpull(points)
    if least is None or least.overpull is None or least.overpull.margin >= 0.0:
        return []
    place = next(i for i, one in enumerate(scene.string) if one.name == least.overpull.section and one.yield_load)
    text = f"{_head(least, points, scene.units)}: {_beyond_yield(least.overpull, scene.units)}"
    return [SceneWarning(f"string[{place}].yield_load", text)]


def _least_overpull(points: list[Point]) -> Point | None:
    """The point with the least margin of overpull; None where no section has a yield load."""
    pulls = [point for point in points if point.overpull is not None]
    return min(pulls, key=lambda point: point.overpull.margin if point.overpull is not None else 0.0, default=None)


def _beyond_yield(pull: Overpull, system: str) -> str:
    """That picking up alone pulls a section too much."""
    beyond, at = shown(-pull.margin, "N", system), shown(pull.measured_depth, "m", system)
    return (
        f"picking up pulls {pull.section} {beyond} beyond its yield load at {at}, by axial tension alone. "
        "There is no margin of overpull. Take a higher grade, a heavier pipe, or a lighter string below it"
    )


def _margin(point: Point, points: list[Point], system: str) -> str:
    """How much more than the pick-up load the hook can pull."""
    assert point.overpull is not None
    return (
        f"margin of overpull at {shown(point.depth, 'm', system)}, "
        f"friction {point.friction:.3g}{_of(point, points)}: "
        f"{shown(point.overpull.margin, 'N', system)}, then {point.overpull.section} yields at "
        f"{shown(point.overpull.measured_depth, 'm', system)} by axial tension alone"
    )


def _coarse(points: list[Point], system: str) -> list[str]:
    """Whether so few links are too few: a lump touches the wall for half a link on either side, the first for half."""
    few = [point for point in points if point.model == LUMPED and point.link_depth.size < FEW_LINKS]
    found = [(*_furthest(point), point) for point in few]
    share, way, worst = max(found, key=lambda one: one[0], default=(0.0, "", None))
    if worst is None or share < COARSE:
        return []
    few_are = f"{worst.link_depth.size} links are few, and {_off_told(worst, way, share, system)}"
    return [f"{_head(worst, points, system)}: {few_are}; give more with --elements, or leave it out"]


def _doublings(cases: list[Case], system: str) -> list[tuple[str, str]]:
    """Why so many links were taken, and what doubling them changed: once for each model."""
    found = []
    for case in {case.model: case for case in cases if case.doubling is not None}.values():
        doubling = case.doubling
        assert doubling is not None
        what = "links" if case.model == LUMPED else "elements of the beam"
        bends = "the hole bends to and fro within short lengths"
        why = bends if doubling.bends else "the string slacking off is a helix, whose friction coarse links miss"
        where = f"friction {doubling.friction:.3g} and the bit at {shown(doubling.depth, 'm', system)}"
        text = f"{why}, so {doubling.links} {what} were taken. "
        changes = [
            f"{name} by {_changed(share)}"
            for name, share in (
                ("the hook load picking up", doubling.hook_load),
                ("that slacking off", doubling.slack_off),
                ("the torque", doubling.torque),
            )
            if share is not None
        ]
        if changes:
            text += f"With {where}, half as many change {', '.join(changes[:-1])}{' and ' * (len(changes) > 1)}"
            text += changes[-1]
            more = "; more may change them further: check the bends of the hole, or give more with --elements"
        else:
            text += f"With {where}, they found no loads"
            more = ": what more would change is not known"
        found.append((text, "green") if doubling.settled else (text + more, "yellow"))
    return found


def _changed(share: float) -> str:
    """What half of the links change, from what doubling them did."""
    return f"{-100.0 * share:+.2g} %" if share else "0 %"


def _beside_soft_string(cases: list[Case], system: str) -> list[str]:
    """Why both columns differ where they do by much, and which to go by, if that is known."""
    # The mesh is no reason with as many links as that.
    points = [
        (case.doubling, point)
        for case in cases
        if case.follows
        for point in case.points
        if not point.failures and point.link_depth.size >= ELEMENTS
    ]
    settled: list[tuple[float, str, Point]] = []
    unknown: list[tuple[float, str, Point]] = []
    for doubling, point in points:
        for way, share in _apart(point).items():
            known = doubling is not None and doubling.settles(way)
            (settled if known else unknown).append((share, way, point))
    every = [point for _, point in points]
    told = []
    for found, end in ((settled, _GO_BY_STATICS), (unknown, _NOT_DOUBLED)):
        share, way, worst = max(found, key=lambda one: one[0], default=(0.0, "", None))
        if worst is not None and share >= COARSE:
            told.append(f"{_head(worst, every, system)}: {_off_told(worst, way, share, system)}{end}")
    return told


def _off_told(point: Point, way: str, share: float, system: str) -> str:
    """By how much a load is off that of the soft string: in per cent of that, as the table has it, or else of what."""
    off = f"the {_LOADS[way]} is"
    soft = point.soft[way]
    if way != "slack_off" or _size_lowered(point) == abs(soft.hook_load):
        return f"{off} {100.0 * share:.0f} % off that of the soft string"
    apart = shown(abs(point.hook_load(way) - soft.hook_load), "N", system)
    base = f"{100.0 * PART:.0f} % of the soft string's hook load picking up"
    # Of a load that is next to nothing any change is thousands of per cent.
    return f"{off} {apart} off that of the soft string, a difference of {100.0 * share:.0f} % of {base}"


_LOADS = {"pick_up": "hook load picking up", "slack_off": "hook load slacking off", "rotating": "torque"}
_GO_BY_STATICS = (
    ", which has neither clearance nor stiffness, and presses on the wall in every bend of the hole. The statics has "
    "both, and twice the links changed it by 1 % at most: go by its numbers"
)
_NOT_DOUBLED = (
    ". The soft string has neither clearance nor stiffness, but the statics may have too few links, and more links may "
    "change it: compare with twice as many (--elements) before you go by its numbers"
)


def soft_string_is_off(cases: list[Case]) -> bool:
    """Whether the soft string differs from the statics by what is worth a word, or nothing stands beside it."""
    points = [point for case in cases for point in case.points]
    return any(point.failures or _furthest(point)[0] >= COARSE for point in points)


def _furthest(point: Point) -> tuple[float, str]:
    """Share by which hook load or torque is off that of the soft string, and the motion whose load is off by most."""
    apart = _apart(point)
    worst = max(apart, key=lambda way: apart[way], default="")
    return apart.get(worst, 0.0), worst


def _apart(point: Point) -> dict[str, float]:
    """Share by which each load is off that of the soft string; none of what was not found."""
    turned = point.soft["rotating"]
    sizes = {"pick_up": abs(point.soft["pick_up"].hook_load), "slack_off": _size_lowered(point)}
    found = {way: abs(point.hook_load(way) - point.soft[way].hook_load) / size for way, size in sizes.items() if size}
    # In a vertical hole there is no torque to compare.
    if abs(turned.surface_torque) >= NOTHING:
        found["rotating"] = _share(point.torque("rotating"), turned.surface_torque)
    return {way: share for way, share in found.items() if np.isfinite(share)}


def _size_lowered(point: Point) -> float:
    """What a difference of the hook load slacking off is measured by, N."""
    return size_lowered(*(point.soft[way].hook_load for way in ("pick_up", "slack_off")))


def _of(point: Point, points: list[Point]) -> str:
    """Which model a number is of, where there are several."""
    return f", {point.model}" if len({one.model for one in points}) > 1 else ""


def _head(point: Point, points: list[Point], system: str) -> str:
    """Of which friction, model and depth a sentence is."""
    return f"friction {point.friction:.3g}{_of(point, points)}, bit at {shown(point.depth, 'm', system)}"


def _deepest(cases: list[Case]) -> list[Point]:
    return [max(case.points, key=lambda point: point.depth) for case in cases]


def _with_block(cases: list[Case], system: str, block: float) -> list[str]:
    """Hook loads as the rig's gauge shows them, at the deepest point of each friction factor."""
    found = []
    deepest = _deepest(cases)
    for point in deepest:
        loads = [
            f"{WORDS[way]} {shown(point.hook_load(way) + block, 'N', system)}"
            for way in point.soft
            if way in point.profiles
        ]
        head = _head(point, deepest, system)
        found.append(f"{head}, with the block's {shown(block, 'N', system)}: {', '.join(loads)}")
    return found


def _strokes(cases: list[Case], system: str) -> list[str]:
    """What the block has to do before the bit moves, at the deepest point of each friction factor."""
    found = []
    deepest = _deepest(cases)
    for point in deepest:
        if point.strokes is None or point.friction.largest == 0.0 or not np.isfinite(point.strokes).all():
            continue
        if max(point.strokes) < NO_STROKE:
            continue
        up, down, other = (shown(way, "m", system) for way in point.strokes)
        found.append(
            f"{_head(point, deepest, system)}: it moves after a stroke of the "
            f"block of {up} up or {down} down from rest, {other} after a stroke in the other direction"
        )
    return found


def fit_in_words(fitted: Fit, system: str = "si") -> str:
    """The factor with its spread, and what each direction alone would say."""
    alone = [
        f"{value:.3f} by {word}" if np.isfinite(value) else f"– by {word}"
        for value, word in ((fitted.pick_up, "pick-up"), (fitted.slack_off, "slack-off"))
    ]
    off = f"the loads are off by {shown(fitted.residual, 'N', system)} rms"
    if np.isnan(fitted.spread):  # no more loads than factors: these fit whatever the loads are
        off = "as many loads as factors: what scatter in the loads does to them is unknown"
    if fitted.cased is not None and fitted.cased_error is not None:
        cased, opened = _factor(fitted.cased, fitted.cased_error), _factor(fitted.friction, fitted.error)
        text = f"friction factors of the {fitted.loads} measured hook loads: cased {cased}, open {opened} ({off})"
    else:
        text = f"friction factor of the {fitted.loads} measured hook loads: {_factor(fitted.friction, fitted.error)}"
        text = f"{text} ({', '.join(alone)}; {off})"
    return text + _of_model(fitted)


def _of_model(fitted: Fit) -> str:
    """What of the error of the factors the model makes, where it is more than what the loads scatter by."""
    shares = [(fitted.model_error, fitted.spread)]
    if fitted.cased_model_error is not None and fitted.cased_spread is not None:
        shares.append((fitted.cased_model_error, fitted.cased_spread))
    told = [(model, loads) for model, loads in shares if np.isfinite(loads) and model > max(loads, WORTH_TELLING)]
    if not told:
        return ""
    model, loads = max(told)
    said = f"; of the error, {model:.2g} is that of the model and {loads:.2g} the scatter of the loads. "
    if fitted.elements_error >= model:
        if fitted.compared > fitted.elements:
            return f"{said}With {fitted.compared} elements, which follow the hole, the factor is that much different"
        return f"{said}With half the elements the factor is that much different: more make this smaller (--elements)"
    return (
        f"{said}A soft string, which has no stretch and no stiffness, gives a factor that is that much different. "
        f"More elements change it by about {fitted.elements_error:.1g}"
    )


def _unexplained(fitted: Fit, system: str) -> str:
    """Loads that no factor explains, by the one that is furthest off."""
    worst = max(fitted.unexplained, key=lambda one: abs(one.load - one.rotating))
    side = "below" if worst.direction == "pick_up" else "above"
    text = (
        f"no friction factor explains {WORDS[worst.direction]} {shown(worst.load, 'N', system)} at "
        f"{shown(worst.depth, 'm', system)}: it is {side} the rotating weight, {shown(worst.rotating, 'N', system)}"
    )
    more = len(fitted.unexplained) - 1
    others = f" (nor {more} more of the loads)" if more else ""
    return f"{text}{others}; check the loads, top.weight, mud and string"


def _factor(value: float, spread: float) -> str:
    """A factor with its standard error; one that the loads do not tell is none."""
    if np.isinf(spread):
        return "not told by these loads"
    return f"{value:.4f}" + (f" ± {spread:.2g}" if np.isfinite(spread) else "")


def _warnings(point: Point, points: list[Point], system: str) -> list[str]:
    where = _head(point, points, system)
    found = []
    if point.must_be_pushed:
        found.append(f"{where}: the string does not go down by its own weight: it must be pushed or turned")
    for way, depth in point.locks.items():
        found.append(
            f"{where}, {WORDS[way]}: lock-up: the friction of a helix grows without end towards "
            f"{shown(depth, 'm', system)}, and no force at the top moves the bit"
        )
    # Of several motions that buckle the string at the same places there is one sentence.
    buckled: dict[str, list[str]] = {}
    for way in point.profiles:
        helix = point.buckled(way, "helical")
        sine = _long_enough(_without(point.buckled(way, "sinusoidal"), helix), system)
        for kind, places in (("into a helix", helix), ("into a sine", sine)):
            if places:
                text = f"the string buckles {kind} from {_spans(places, system)}"
                buckled.setdefault(text, []).append(WORDS[way])
    return found + [f"{where}, {', '.join(ways)}: {text}" for text, ways in buckled.items()]


def _spans(places: list[tuple[float, float]], system: str) -> str:
    """The longest stretches by depth, and how far down the others go."""
    told = sorted(sorted(places, key=lambda one: one[0] - one[1])[:MOST_STRETCHES])
    spans = ", ".join(f"{shown(a, 'm', system)} to {shown(b, 'm', system)}" for a, b in told)
    if len(places) == len(told):
        return spans
    deepest = shown(max(b for _, b in places), "m", system)
    return f"{spans}, and {len(places) - len(told)} shorter ones, down to {deepest} in all"


def _long_enough(places: list[tuple[float, float]], system: str) -> list[tuple[float, float]]:
    """Those of some stretches whose ends are two numbers as printed: others are the edge of what lies beside them."""
    return [(a, b) for a, b in places if shown(a, "m", system) != shown(b, "m", system)]


def _without(places: list[tuple[float, float]], others: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What of some stretches is in none of others."""
    left = [(float(a), float(b)) for a, b in places]
    for begin, end in others:
        parts = [part for a, b in left for part in ((a, min(b, begin)), (max(a, end), b))]
        left = [(a, b) for a, b in parts if b > a]
    return left
