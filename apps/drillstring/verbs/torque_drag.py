"""The verb ``torque-drag``: hook loads, torque and buckling. What it prints with ``--json`` is a contract."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drillstring.verbs.form import Models, parse_models
from tautline.cli.options.places import file_named
from tautline.cli.output.findings import figure_place, say_sentences, write_figure, write_table
from tautline.cli.output.scene_warnings import print_warnings, warning_records, warnings_without_a_run
from tautline.cli.run import searched
from tautline.cli.verbs import Changes, Json, Picture, Scene
from tautline.scene.errors import SceneWarning, option_error
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene
    from drillstring.statics.back_calculation import Fit, Measured
    from drillstring.statics.motion import Motion
    from drillstring.statics.torque_drag import Case
    from drillstring.string.factors import Factors
    from tautline.results.tables.finding import Finding

MOST_DEPTHS, MOST_FACTORS, MOST_ELEMENTS = 1000, 20, 5000
LARGEST_FACTOR = 2.0
DECIMAL_COMMA = re.compile(r"\s*0+,\s*([0-9]+)\s*")
"""A list of two numbers that is more likely one with a decimal comma."""

Frictions = Annotated[
    str | None,
    typer.Option(
        "--friction",
        metavar="A,B,C",
        help="Friction factors; 0.2/0.3 for cased and open hole. [dim]\\[default: the scene's kinetic ones][/]",
    ),
]
Depths = Annotated[
    str | None,
    typer.Option(
        "--depth",
        metavar="FROM:TO:STEP|A,B,C",
        help="Measured depths of the bit, m. [dim]\\[default: the scene's own][/]",
    ),
]
Elements = Annotated[
    int | None,
    typer.Option(
        "--elements", min=1, max=MOST_ELEMENTS, show_default=False,
        help="Links or elements of the string. [dim]\\[default: 100, or more as the scene has or the hole needs][/]",
    ),
]  # fmt: skip
MeasuredFile = Annotated[
    Path | None,
    typer.Option(
        "--measured",
        metavar="FILE",
        help="CSV of measured hook loads, depth, pick_up, slack_off: fits the friction factor, which is then used.",
    ),
]
Reaming = Annotated[
    str | None,
    typer.Option(
        "--reaming", metavar="SPEED", help="Also up and down at this speed while turning, m/s or such as '0.3 m/s'."
    ),
]
Rotary = Annotated[
    str | None,
    typer.Option(
        "--rotary", metavar="SPEED", help="Rotary speed of reaming, rpm or with a unit. [dim]\\[default: 60][/]"
    ),
]

Csv = Annotated[
    Path | None,
    typer.Option("--csv", metavar="FILE", parser=file_named, help="Write hook loads and torques as a table."),
]


def torque_drag(
    scene: Scene,
    friction: Frictions = None,
    depth: Depths = None,
    elements: Elements = None,
    measured: MeasuredFile = None,
    reaming: Reaming = None,
    rotary: Rotary = None,
    model: Models = None,
    output: Picture = None,
    csv: Csv = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Find hook loads, surface torque, side force and buckling, at one depth or many, for several friction factors."""
    from drillstring.mesh import ELEMENTS, mesh_warnings, scatter
    from drillstring.model.prepared import well_of
    from drillstring.scene.scene import of_kind, read
    from drillstring.statics.torque_drag import meshes, own_friction
    from drillstring.statics.torque_drag import torque_drag as compute
    from drillstring.view.torque_summary import soft_string_is_off, yield_warnings
    from tautline.cli.options.changes import read_changed
    from tautline.cli.output.console import print_json, say
    from tautline.cli.run import Ended, ExitCode
    from tautline.results.output_path import check_table

    drillstring = read_changed(read, scene, changes)
    # The first of several models is the one that measured loads are fitted by.
    kinds = parse_models(model) or [drillstring.model.kind]
    drillstring = of_kind(drillstring, kinds[0])
    own = own_friction(drillstring)
    figure, table = figure_place(output, f"{scene.stem}_torque_drag"), check_table(csv, "model,friction,depth")
    factors = parse_frictions(friction, own.shoe) if friction is not None else None
    reamed = parse_reaming(reaming, rotary)
    depths, unit = (parse_depths(depth), unit_of_depths(depth)) if depth is not None else (None, None)
    _check_elements(drillstring, elements)
    unlikely = unlikely_frictions(friction, factors or [])
    # The mesh is not the scene's, and there may be several: warnings are of those that are computed.
    warnings = [one for one in warnings_without_a_run(drillstring) if one.where != ELEMENTS]
    warnings += mesh_warnings(meshes(drillstring, depths, elements, kinds, unit)) + unlikely
    print_warnings(warnings)
    loads, fitted = _fitted(drillstring, measured, elements, as_json)
    if fitted is not None:
        unread = _unread(measured, loads)
        print_warnings(unread)
        warnings += unread
        factors = [fitted.factors(own.shoe)] if factors is None else factors
        depths = sorted(set(loads.depth.tolist())) if depths is None else depths
    cases = compute(drillstring, factors, depths, elements, reamed=reamed, kinds=kinds, unit=unit)
    failures = [text for case in cases for text in case.failures]
    if soft_string_is_off(cases):
        scattered = scatter(drillstring, well_of(drillstring))
        print_warnings(scattered)
        warnings += scattered
    _print(drillstring, cases, fitted)
    _draw(drillstring, cases, figure, loads)
    if table is not None:
        _write(cases, table)
    for text in failures:
        say(f"stopped, {text}", "red")
    if as_json:
        warnings += yield_warnings(cases, drillstring)
        status = "stopped: no equilibrium in places" if failures else "done"
        told = report(cases, fitted, failures, drillstring.top.weight)
        files = {"figure": str(figure), "csv": None if csv is None else str(csv)}
        print_json({"scene": str(scene), "status": status} | files | told | {"warnings": warning_records(warnings)})
    if failures:
        raise Ended(ExitCode.STOPPED_EARLY)


def parse_frictions(text: str, shoe: float = 0.0) -> list[Factors]:
    """Friction factors between commas, each a number, or cased/open where the hole has a casing down to its shoe, m.

    Raises
    ------
    SceneError
        Naming the option and the word that is none.
    """
    import math

    from drillstring.string.factors import Factors
    from tautline.cli.options.lists import words
    from tautline.scene.values.quantity import as_in_a_file, quantity

    def factor(word: str) -> float:
        try:
            value = float(quantity("").read(as_in_a_file(word)))
        except ValueError:
            raise ValueError("is no friction factor: write 0.1,0.2,0.3, or a share such as 25 %") from None
        if not math.isfinite(value) or not 0.0 <= value <= LARGEST_FACTOR:
            comma = f". {_decimal_meant(text)}" if DECIMAL_COMMA.fullmatch(text) else ""
            raise ValueError(f"is no friction factor: one lies between 0 and {LARGEST_FACTOR:g}{comma}")
        return value

    def read(word: str) -> Any:
        both = word.split("/")
        if len(both) > 2:
            raise ValueError("is no pair of friction factors: write cased/open, such as 0.2/0.3")
        if len(both) == 2 and shoe == 0.0:
            raise ValueError("is a pair, and the hole has no casing: give well.wall.casing its shoe, or one number")
        values = [factor(part) for part in both]
        return Factors(values[-1], values[0], shoe)

    found: list[Any] = words(text, "--friction", read)
    if len(found) > MOST_FACTORS:
        cause = f"makes {len(found)} friction factors, more than {MOST_FACTORS}"
        raise option_error("--friction", text, cause, "give fewer")
    return found


def unlikely_frictions(text: str | None, factors: list[Factors]) -> list[SceneWarning]:
    """Warnings of friction factors of ``--friction`` that are likely not meant: a decimal comma, and large ones."""
    from tautline.scene.values.ranges import RANGES, in_range

    if text is None:
        return []
    if DECIMAL_COMMA.fullmatch(text):
        first, second = (one.strip() for one in text.split(","))
        cause = f"{text.strip()} are two friction factors, {first} and {second}"
        return [SceneWarning("--friction", f"{cause}. {_decimal_meant(text)}")]
    row, largest = RANGES["friction factor"], max(factor for one in factors for factor in (one.open, one.cased))
    if row.holds(largest):
        return []
    return [SceneWarning("--friction", f"{largest:g} is unusual for a friction factor: {in_range(row)} is plausible")]


def _decimal_meant(text: str) -> str:
    meant = DECIMAL_COMMA.sub(r"0.\1", text)
    return f"Was {meant} meant? Then write it with a point: --friction {meant}"


def parse_reaming(speed: str | None, rotary: str | None) -> dict[str, Motion] | None:
    """Motions of reaming up and down, a bare rotary speed in rpm; None without a speed.

    Raises
    ------
    SceneError
        For a rotary speed alone, and for what is no speed.
    """
    from drillstring.statics.motion import reaming
    from tautline.cli.options.lists import number

    if speed is None:
        if rotary is not None:
            cause = "turns a string that is not moved: `rotating` is the same at any speed"
            raise option_error("--rotary", rotary, cause, "give --reaming a speed, or leave it out")
        return None
    return reaming(number(speed, "--reaming", "m/s"), number(rotary or "60", "--rotary", "rad/s", bare=RPM))


def parse_depths(text: str) -> list[float]:
    """Depths of ``FROM:TO:STEP`` with both ends, or of ``A,B,C``, m or with units, increasing whatever their order.

    Raises
    ------
    SceneError
        With the cure, for what are no depths.
    """
    from tautline.cli.options.lists import number, numbers, stepped, three_of

    refuse = partial(option_error, "--depth", text)
    example = "write 500:3500:250, or 500,1000,2000"

    if ":" not in text:
        found = numbers(text, "--depth", "m", example=example)
        if len(found) > MOST_DEPTHS:
            raise refuse(f"makes {len(found)} depths, more than {MOST_DEPTHS}", "give fewer")
        # A line over depths as they were typed would double back.
        return sorted(found)
    parts = three_of(text, "--depth", example)
    first, last = (number(part, "--depth", "m") for part in parts[:2])
    upwards = parts[2].strip().startswith("-")
    if last < first or upwards:
        shallow, deep = (part.strip() for part in (parts[:2] if first <= last else parts[1::-1]))
        cure = f"write the shallow depth first, such as {shallow}:{deep}:{parts[2].strip().lstrip('-')}"
        raise refuse("has a step below zero" if upwards else "ends above where it begins", cure)
    step = number(parts[2], "--depth", "m")
    return stepped((first, last, step), text, "--depth", MOST_DEPTHS, "depths")


def unit_of_depths(text: str) -> str | None:
    """The unit of length that depths of ``--depth`` are written in; m of bare numbers, None where there are several."""
    from tautline.scene.values.quantity import NUMBER

    found = [NUMBER.fullmatch(word) for word in re.split("[,:]", text)]
    units = {match["unit"] for match in found if match is not None and match["unit"]}
    return units.pop() if len(units) == 1 else None if units else "m"


def _check_elements(scene: DrillstringScene, elements: int | None) -> None:
    if elements is not None and elements < len(scene.string):
        cause = f"fewer than the {len(scene.string)} sections of the string"
        raise option_error("--elements", str(elements), cause, "give one for each section at least")


def _fitted(scene: DrillstringScene, path: Path | None, elements: int | None, as_json: bool) -> tuple[Any, Fit | None]:
    """Measured loads and the friction factor that fits them; a search that fails ends the command."""
    if path is None:
        return None, None
    from drillstring.statics.back_calculation import fit, read_measured

    loads = read_measured(path, scene.top.weight)
    return loads, searched(path, as_json, lambda: fit(scene, loads, elements, path))


def _unread(path: Path | None, loads: Any) -> list[SceneWarning]:
    """Warn of measured loads that stand for none, of columns that are not read, and of the loads that the fit is of."""
    if path is None:
        return []
    told = []
    if loads.nulls:
        count = "1 load is a number" if loads.nulls == 1 else f"{loads.nulls} loads are numbers"
        told.append(f"{path.name}: {count} such as -999.25, which rigs write for none. The fit leaves out what is none")
    if loads.unused:
        measured = {"pick_up": loads.pick_up, "slack_off": loads.slack_off}
        read = " and ".join(name for name, found in measured.items() if any(found == found))  # NaN where not measured
        told.append(f"{path.name}: not read: {', '.join(loads.unused)}; the fit is of {read} alone")
    return [SceneWarning("--measured", text) for text in told]


def report(cases: list[Case], fitted: Fit | None, failures: list[str], block: float) -> dict[str, Any]:
    """What ``--json`` tells: the first model's first friction factor at the top, all in ``cases``, SI units.

    ``block`` is the weight of the block, N, which hook loads are without.
    """
    every = [_report_of(case) for case in cases]
    return every[0] | {
        "cases": every,
        "block_weight": block,
        "fit": None if fitted is None else _fit_report(fitted),
        "failures": failures,
    }


def _fit_report(fitted: Fit) -> dict[str, Any]:
    more = {"error": fitted.error, "cased_error": fitted.cased_error}
    return fitted._asdict() | more | {"unexplained": [one._asdict() for one in fitted.unexplained]}


def _report_of(case: Case) -> dict[str, Any]:
    from drillstring.statics.torque_drag import DIRECTIONS

    last = max(case.points, key=lambda point: point.depth)
    soft = {way: case.soft_hook_loads(way) for way in DIRECTIONS} | {"torque": case.soft_torques}
    loads = {way: case.hook_loads(way) for way in DIRECTIONS} | {"torque": case.torques}
    return {
        "model": case.model,
        "elements": last.link_depth.size,
        "doubling": None
        if case.doubling is None
        else case.doubling._asdict() | {"friction": case.doubling.friction.plain()},
        "friction": case.friction.plain(),
        "depth": [point.depth for point in case.points],
        **loads,
        "soft_string": soft,
        "difference": {way: loads[way] - soft[way] for way in loads},
        "buckling": {
            "measured_depth": last.link_depth, "sinusoidal": last.limits.sinusoidal, "helical": last.limits.helical,
        },
        "buckled": [
            {way: {kind: point.buckled(way, kind) for kind in ("sinusoidal", "helical")} for way in DIRECTIONS}
            for point in case.points
        ],
        "lock_up": [point.locks for point in case.points],
        "locked": [point.locked for point in case.points],
        "reaming": {
            motion.removeprefix("reaming_"): last.motions[motion]._asdict() | {
                "hook_load": case.hook_loads(motion), "torque": case.torques_of(motion),
                "soft_string": {"hook_load": case.soft_hook_loads(motion), "torque": case.soft_torques_of(motion)},
            }
            for motion in case.motions[len(DIRECTIONS):]
        },
        "break_away": [None if point.strokes is None else point.strokes._asdict() for point in case.points],
        "overpull": [None if point.overpull is None else point.overpull._asdict() for point in case.points],
        "profile": {
            way: {
                "measured_depth": profile.measured_depth, "side_force": profile.side_force,
                "link_depth": profile.link_depth, "tension": profile.tension, "torque": profile.torque,
            }
            for way, profile in last.profiles.items()
        },
    }  # fmt: skip


def _print(scene: DrillstringScene, cases: list[Case], fitted: Fit | None) -> None:
    from drillstring.view.torque_summary import sentences, table
    from tautline.cli.commands.study import show
    from tautline.cli.output.console import say
    from tautline.scene.values.printed import shown

    show(table(cases, scene.units))
    if scene.bit.on_bottom:
        weight = shown(scene.bit.weight, "N", scene.units)
        text = f"the bit is on bottom: all of this is with {weight} on it, and without its torque"
        say(f"{text}; `bit: {{on_bottom: false}}` tells the loads off bottom", "yellow")
    say_sentences(sentences(cases, fitted, scene.units, scene.top.weight))


def _draw(scene: DrillstringScene, cases: list[Case], path: Path, loads: Measured | None) -> None:
    from drillstring.view.torque_figures import torque_drag_figure

    title = f"{scene.title or path.stem}: torque and drag"
    write_figure(torque_drag_figure(cases, title, scene.units, loads), path)


def _write(cases: list[Case], path: Path) -> None:
    from drillstring.view.torque_summary import header, rows

    write_table(header(cases), rows(cases), path)


OPTIONS = ("friction", "depth", "elements", "model")
"""Options that the findings of a sweep can have."""
LOADS = {"pick_up": "hook load, picked up", "slack_off": "hook load, slacked off", "rotating": "hook load, rotating"}


def read_options(scene: DrillstringScene, options: Mapping[str, Any]) -> dict[str, Any]:
    """What `torque_drag` is to compute in a sweep: depths, one friction factor, links, kind of model.

    Raises
    ------
    SceneError
        Naming the option.
    """
    from drillstring.statics.torque_drag import own_friction

    text = {name: None if value is None else str(value) for name, value in options.items()}
    friction, kinds = text.get("friction"), parse_models(text.get("model"))
    factors = None if friction is None else parse_frictions(friction, own_friction(scene).shoe)
    if factors is not None and len(factors) > 1:
        cure = "give one, and vary well.wall.friction"
        raise option_error("--friction", str(friction), "are several friction factors", cure)
    if len(kinds) > 1:
        raise option_error("--model", str(text["model"]), "are two models", "give one, and vary model.kind")
    elements = options.get("elements")
    if elements is not None and (isinstance(elements, bool) or not isinstance(elements, int) or elements < 1):
        raise option_error("--elements", str(elements), "is no number of elements", "give a whole number above zero")
    _check_elements(scene, elements)
    depths = None if text.get("depth") is None else parse_depths(str(text["depth"]))
    return {"frictions": factors, "depths": depths, "elements": elements, "kinds": kinds}


def findings(scene: DrillstringScene, asked: Mapping[str, Any]) -> dict[str, Finding]:
    """Hook loads and surface torque, with those of the soft string; along ``depth`` where there are several depths."""
    from drillstring.statics.torque_drag import torque_drag as compute
    from tautline.results.tables.finding import Finding

    (case,) = compute(scene, **asked)
    depths = [point.depth for point in case.points]
    several = len(depths) > 1

    def made(values: list[float], unit: str, text: str) -> Finding:
        return Finding(values, unit, text, "depth") if several else Finding(values[0], unit, text)

    found = {way: made(case.hook_loads(way).tolist(), "N", text) for way, text in LOADS.items()}
    found["torque"] = made(case.torques.tolist(), "N m", "surface torque, rotating")
    for way, text in LOADS.items():
        found[f"soft_string.{way}"] = made(case.soft_hook_loads(way).tolist(), "N", f"{text}, soft string")
    found["soft_string.torque"] = made(case.soft_torques.tolist(), "N m", "surface torque, rotating, soft string")
    found["failures"] = Finding(len(case.failures), "", "motions without an equilibrium")
    locked = sum(bool(point.locks) for point in case.points)
    found["lock_ups"] = Finding(locked, "", "depths at which the string locks up")
    cannot = [math.nan if point.locked is None else float(point.locked) for point in case.points]
    found["locked"] = made(cannot, "", "1 where the string is not lowered by its weight, or by any force; else 0")
    places = [point.locks.get("slack_off", math.nan) for point in case.points]
    found["lock_up"] = made(places, "m", "depth towards which the string locks up, slacked off")
    if several:
        found["depth"] = Finding(depths, "m", "measured depth of the bit", "depth")
    return found
