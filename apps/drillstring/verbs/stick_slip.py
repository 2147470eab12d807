"""The verb ``stick-slip``: the map over rotary speed and weight on bit. What ``--json`` prints is a contract."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tautline.cli.output.findings import say_sentences
from tautline.cli.output.scene_warnings import print_warnings, warning_records
from tautline.cli.verbs import Changes, Json, Scene, Stem
from tautline.scene.errors import option_error
from tautline.scene.values.units import RPM

if TYPE_CHECKING:
    from drillstring.scene.scene import DrillstringScene
    from drillstring.stick_slip.severity_map import Map
    from tautline.scene.errors import SceneWarning

SPEEDS, SHARES = "40:160:20", (0.5, 1.0, 1.5, 2.0)
"""Rotary speeds where none are given, rpm, and weights over the scene's own."""
SOME_SPEEDS, SOME_WEIGHTS = ("40:160:20", "60,90,120"), ("'50 kN:250 kN:50 kN'", "'50 kN,100 kN'")
"""A range and a list of each, as examples of what can be written."""
MOST_CELLS, MOST_JOBS = 2000, 256

Speeds = Annotated[
    str,
    typer.Option("--speed", metavar="FROM:TO:STEP|A,B,C", help="Rotary speeds, rpm unless a unit is given."),
]
Weights = Annotated[
    str | None,
    typer.Option(
        "--weight",
        metavar="FROM:TO:STEP|A,B,C",
        help="Weights on bit, N unless a unit is given. [dim]\\[default: half to twice the scene's][/]",
    ),
]
End = Annotated[
    str | None,
    typer.Option(
        "--end",
        metavar="TIME",
        help="Length of a run. [dim]\\[default: the scene's, or 20 torsional periods if more][/]",
    ),
]
Jobs = Annotated[
    int | None,
    typer.Option("--jobs", min=1, max=MOST_JOBS, show_default=False, help="Processes. [dim]\\[default: all cores][/]"),
]


def stick_slip(
    scene: Scene,
    speed: Speeds = SPEEDS,
    weight: Weights = None,
    end: End = None,
    jobs: Jobs = None,
    output: Stem = None,
    changes: Changes = None,
    as_json: Json = False,
) -> None:
    """Map stick-slip of the bit over rotary speed and weight on bit, one run to each, on all cores."""
    from drillstring.scene.scene import read
    from drillstring.stick_slip.severity_map import require_bit, stick_slip_map
    from tautline.application.installed import Installed
    from tautline.cli.commands.study import stem_of
    from tautline.cli.options.changes import read_changed
    from tautline.cli.options.lists import number
    from tautline.cli.output.console import say
    from tautline.cli.output.first_run import compiling
    from tautline.cli.output.progress import Counter
    from tautline.cli.run import Ended, ExitCode

    drillstring = read_changed(read, scene, changes)
    require_bit(drillstring)
    speeds = parse_range(speed, "--speed", "rad/s", RPM, SOME_SPEEDS)
    weights = _weights(drillstring, weight)
    if len(speeds) * len(weights) > MOST_CELLS:
        raise option_error(
            "--speed", speed, f"makes {len(speeds) * len(weights)} runs, more than {MOST_CELLS}", "take fewer"
        )
    length = None if end is None else number(end, "--end", "s")
    stem = stem_of(scene, output, "stick_slip")
    warnings = Installed().of(drillstring).warnings(drillstring)
    print_warnings(warnings)
    doubts = [*_doubts(speeds, weight), *_too_heavy(drillstring, speeds[0], max(weights))]
    doubts += _too_short(drillstring, length)
    for doubt in doubts:
        say(f"warning: {doubt}", "yellow")
    with Counter("runs") as counter:
        found = stick_slip_map(drillstring, speeds, weights, length, jobs, counter, announce=compiling)
    _report(scene, drillstring, found, stem, as_json, doubts, warnings)
    if found.interrupted:
        raise Ended(ExitCode.INTERRUPTED)
    if found.failures:
        raise Ended(ExitCode.STOPPED_EARLY)


def parse_range(
    text: str, option: str, unit: str, bare: float = 1.0, examples: tuple[str, str] = SOME_SPEEDS
) -> list[float]:
    """Values of ``FROM:TO:STEP`` with both ends, or of ``A,B,C``; a bare number counts `bare` SI units.

    ``examples`` are one of each kind, for messages.

    Raises
    ------
    SceneError
        Naming the option and what is wrong.
    """
    from tautline.cli.options.lists import numbers, stepped, three_of

    example = f"write {examples[0]}, or {examples[1]}"

    def one(word: str) -> float:
        return numbers(word, option, unit, bare, example)[0]

    if ":" not in text:
        return [one(word) for word in text.split(",")]
    first, last, step = (one(part) for part in three_of(text, option, example))
    if last < first:
        raise option_error(
            option, text, "ends below where it begins", f"write the smaller first, such as {examples[0]}"
        )
    return stepped((first, last, step), text, option, MOST_CELLS, "values")


def _weights(scene: DrillstringScene, text: str | None) -> list[float]:
    if text is not None:
        return parse_range(text, "--weight", "N", examples=SOME_WEIGHTS)
    own = scene.bit.weight or (scene.bit.torque.weight if scene.bit.torque is not None else None)
    if not own:
        raise option_error("--weight", "", "is needed: the scene's own weight on bit is 0", f"write {SOME_WEIGHTS[0]}")
    return [share * own for share in SHARES]


def _doubts(speeds: list[float], weight: str | None) -> list[str]:
    """What is asked of speeds that no rotary has, and of weights that are probably meant in another unit."""
    from tautline.cli.options.plausible import doubt_of_bare

    doubt = doubt_of_bare(weight, "--weight", "weight on bit") if weight is not None else ""
    return [told for told in (_too_fast(speeds), doubt) if told]


def _too_fast(speeds: list[float]) -> str:
    """A word of speeds out of the range that is plausible: a bare number is one in rpm, not in the table's unit."""
    from tautline.scene.values.printed import significant
    from tautline.scene.values.ranges import RANGES

    row = RANGES["rotary speed"]
    unusual = next((speed for speed in speeds if not row.holds(speed)), None)
    if unusual is None:
        return ""
    least, most = (f"{significant(limit / RPM, 3)} rpm" for limit in (row.low or 0.0, row.high or 0.0))
    told = f"--speed: {significant(unusual / RPM, 6)} rpm is unusual for a rotary speed. {least} to {most} is plausible"
    return f"{told}. A number without a unit is read in rpm. Check it"


def _too_heavy(scene: DrillstringScene, speed: float, weight: float) -> list[str]:
    """A word of the largest weight of the map where the string does not weigh as much; `check` tells of the scene's."""
    from drillstring.stick_slip.severity_map import varied
    from drillstring.warnings import too_heavy

    told = "" if scene.bit.weight and weight <= scene.bit.weight else too_heavy(varied(scene, speed, weight))
    return [f"--weight: {told}"] if told else []


def _too_short(scene: DrillstringScene, end: float | None) -> list[str]:
    """A word of runs that are asked to be shorter than the swing of the start mostly takes to die out."""
    from drillstring.stick_slip.dying_out import CYCLES
    from drillstring.stick_slip.severity_map import period_of
    from tautline.scene.values.printed import quantity, rounded, significant

    if end is None or end >= CYCLES * (period := period_of(scene)):
        return []
    mode = f"periods of the string's first torsional mode, {quantity(period, 's')} each"
    run = f"--end: {quantity(end, 's')} is {significant(end / period, 2)} {mode}"
    cause = f"{run}: the starting transient may not have decayed by then"
    return [
        f"{cause}. {CYCLES:g} periods mostly suffice: --end '{quantity(rounded(CYCLES * period, 2, up=True), 's')}'"
    ]


def _report(
    path: Path, scene: DrillstringScene, found: Map, stem: Path, as_json: bool, warnings: Sequence[str],
    of_scene: Sequence[SceneWarning],
) -> None:  # fmt: skip
    from drillstring.stick_slip.record import sentences, table, whole_record, write_csv, write_netcdf
    from drillstring.view.stick_slip_figures import stick_slip_figure
    from tautline.cli.commands.study import named
    from tautline.cli.output.console import console, print_json, say

    title = f"{scene.title or path.stem}: stick-slip"
    laid_out = table(found, scene.units)
    if laid_out is not None:
        console().print(laid_out)
    files = [
        write_csv(found, named(stem, ".csv")),
        write_netcdf(found, {"scene": str(path), "title": title}, named(stem, ".nc")),
        stick_slip_figure(found, title, named(stem, ".png"), scene.units),
    ]
    say_sentences(sentences(found, scene.units))
    for file in files:
        say(f"wrote {file}", "green")
    if as_json:
        status = "interrupted" if found.interrupted else "stopped: some runs" if found.failures else "done"
        ends: dict[str, Any] = {"files": [str(f) for f in files], "warnings": list(warnings)}
        ends["scene_warnings"] = warning_records(of_scene)
        print_json({"scene": str(path), "status": status} | whole_record(found) | ends)
