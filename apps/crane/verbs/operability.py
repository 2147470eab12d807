"""The verb ``operability``: in which sea a lift can be done. What it prints with ``--json`` is a contract."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from crane.verbs.operability_options import OperabilityOptions, read_options
from tautline.cli.options.finite import finite
from tautline.cli.output.preparing import preparing
from tautline.cli.verbs import Changes, GoOn, Json, Quiet, Scene, Scheduler, Workers

if TYPE_CHECKING:
    from crane.operability.asked import Asked
    from crane.operability.criteria import Criterion
    from crane.operability.scatter import Fatigue
    from crane.operability.storms import Found
    from tautline.scene.errors import SceneWarning

Heights = Annotated[
    str | None,
    typer.Option("--hs", metavar="FROM:TO:STEP", help="Significant wave heights, m or with a unit; or A,B,C."),
]
Periods = Annotated[
    str | None, typer.Option("--tp", metavar="FROM:TO:STEP", help="Peak periods, s; or A,B,C.")
]  # fmt: skip
Headings = Annotated[
    str | None,
    typer.Option(
        "--heading", metavar="A,B,C", help="Directions of the sea in the file of responses, degrees. "
        "[dim]\\[default: the scene's][/]",
    ),
]  # fmt: skip
Seeds = Annotated[int, typer.Option("--seeds", min=1, max=10000, help="Storms of each sea state.")]
FirstSeed = Annotated[int, typer.Option("--first-seed", min=0, help="Of these seeds; the others follow.")]
Duration = Annotated[str, typer.Option("--duration", metavar="TIME", help="Of the operation.")]
Simulated = Annotated[
    str | None,
    typer.Option(
        "--simulate", metavar="TIME",
        help="Length of each run; shorter ones are scaled to the duration. [dim]\\[default: the duration][/]",
    ),
]  # fmt: skip
LeadIn = Annotated[
    str, typer.Option("--lead-in", metavar="TIME", help="Before each storm: the sea grows, and nothing counts.")
]
LimitList = Annotated[
    list[str] | None,
    typer.Option("--limit", metavar="LIMIT", help="Such as 'max_tension < 60 kN'; repeatable."),
]  # fmt: skip
Percentile = Annotated[
    str,
    typer.Option(
        "--percentile", metavar="P",
        help="What is compared with limits: P90 of the largest (P10 of the smallest), or most-probable.",
    ),
]  # fmt: skip
Confidence = Annotated[str, typer.Option("--confidence", help="Of the intervals.")]
ScatterFile = Annotated[
    Path | None, typer.Option("--scatter", metavar="FILE.csv", help="Occurrences of Hs and Tp: fatigue over them.")
]
SnConstant = Annotated[
    float | None,
    typer.Option(
        "--sn-constant", metavar="K", callback=finite, help="S-N curve N (S / breaking load)^5 = K: gives a life.",
    ),
]  # fmt: skip
Folder = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FOLDER", help="[dim]\\[default: the scene's name, -operability][/]"),
]


def operability(
    context: typer.Context,
    scene: Scene,
    hs: Heights = None,
    tp: Periods = None,
    heading: Headings = None,
    seeds: Seeds = 10,
    first_seed: FirstSeed = 1,
    duration: Duration = "3h",
    simulated: Simulated = None,
    lead_in: LeadIn = "100 s",
    limit: LimitList = None,
    percentile: Percentile = "P90",
    confidence: Confidence = "90 %",
    scatter: ScatterFile = None,
    sn_constant: SnConstant = None,
    jobs: Workers = None,
    dask: Scheduler = None,
    output: Folder = None,
    resume: GoOn = False,
    changes: Changes = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Storms over sea states: extremes, and the allowable significant wave height against period and heading."""
    from crane.operability.storms import occurring, warnings_of_storms
    from crane.operability.storms import operability as run
    from tautline.cli.options.changes import change_of
    from tautline.cli.output.console import say
    from tautline.cli.output.first_run import compiling
    from tautline.cli.output.progress import Counter
    from tautline.cli.output.scene_warnings import print_warnings
    from tautline.sweeps.execution import Execution

    application, read = context.obj.read(scene, change_of(changes))
    given = OperabilityOptions(
        hs=hs, tp=tp, heading=heading, seeds=seeds, first_seed=first_seed, duration=duration, simulated=simulated,
        lead_in=lead_in, limit=limit, percentile=percentile, confidence=confidence, scatter=scatter,
        sn_constant=sn_constant,
    )  # fmt: skip
    whole = read_options(given, read.gravity)
    asked = occurring(whole, read)
    folder = output or Path(f"{scene.stem}-operability")
    with preparing(scene, read, quiet):
        # What a storm comes to, and not the run that the scene asks for: it may end before a load is let go.
        told = application.warnings(read.replace({"solver.end": asked.lead + asked.simulated}, origin="--duration"))

    def begin() -> None:
        # What cannot be is refused first: before that nothing should read as a start.
        told[:] = warnings_of_storms(told, read, asked)
        print_warnings(told)
        if not quiet:
            _introduce(read, asked, len(whole.conditions) - len(asked.conditions))

    with Counter("storms", shown=not quiet) as bar:
        execution = Execution(jobs, dask, folder, resume, progress=bar, announce=compiling, begin=begin)
        found = run(application, read, asked, execution if quiet else replace(execution, say=say))
    _report(scene, read, asked, found, folder, told, as_json, quiet, output is not None)


def _introduce(read: Any, asked: Asked, absent: int) -> None:
    from crane.operability.criteria import limits_of_scene
    from tautline.cli.output.console import say
    from tautline.scene.values.printed import in_words

    steep = [one for one in asked.conditions if not one.physical]
    count = len(asked.conditions) - len(steep)
    storms = f"{len(asked.seeds)} storm{'s' if len(asked.seeds) > 1 else ''}"
    if asked.scatter is not None:
        heights, periods = (f"{x[0]:.4g} to {x[-1]:.4g}" for x in (asked.scatter.heights, asked.scatter.periods))
        heights = in_words(f"{heights} m", read.units)
        say(f"scatter diagram: significant heights of {heights} down, peak periods of {periods} s across")
    say(f"{count} sea state{'s' if count != 1 else ''}, {storms} of {_lasting(asked.simulated)} each")
    if absent:
        say(f"{absent} more of the scatter diagram never occur, and are not run")
    if steep:
        say(f"{len(steep)} more are not run: waves of these periods cannot be so steep (DNV-RP-C205, 3.5.4)")
    if asked.simulated < asked.duration and (asked.limits or limits_of_scene(read)):
        say(
            f"extremes are scaled from {_lasting(asked.simulated)} to {_lasting(asked.duration)}: Gumbel's location "
            "grows by its scale times ln(duration / length of a run); this holds for a steady state. Limits of every "
            "run, such as the breaking load, are judged in the time that is simulated alone"
        )


def _report(
    scene: Path, read: Any, asked: Asked, found: Found, folder: Path, of_scene: list[SceneWarning], as_json: bool,
    quiet: bool, named: bool,
) -> None:  # fmt: skip
    from crane.operability.output import draw, write_all
    from crane.operability.scatter import told
    from tautline.cli.commands.sweep import failures
    from tautline.cli.output.console import console, print_json, say
    from tautline.cli.output.scene_warnings import warning_records
    from tautline.cli.output.summary import two_columns
    from tautline.cli.run import Ended, ExitCode
    from tautline.sweeps.journal import list_figures

    outcome, table = found.outcome, found.table
    written: dict[str, Path] = {}
    figures: list[Path] = []
    if table is not None:
        attributes = {
            **outcome.data.attrs, "duration": asked.duration, "simulated": asked.simulated, "lead_in": asked.lead,
            "percentile": asked.share, "confidence": asked.confidence, "compared": asked.compared,
        }  # fmt: skip
        written = write_all(table, found.criteria, attributes, folder, found.fatigue, found.failed)
        said = [_compared_said(asked, one) for one in found.criteria]
        figures = draw(table, found.criteria, read.title or "", said, folder, found.failed)
        # A run before, gone on with for other limits, has figures whose rows the tables no longer have.
        list_figures(folder, figures)
        if not quiet:
            console().print(two_columns(_rows(found, asked, read.units)))
            for path in (*written.values(), *figures):
                say(f"wrote {path}", "green")
    for text in found.warnings:
        # Who asks for quiet was told nothing before.
        if quiet or text not in found.said_before:
            say(f"warning: {text}", "yellow")
    if outcome.failed:
        say(
            f"{outcome.failed} storms did not come to their end; the table {folder / 'sweep.csv'} has them all",
            "yellow",
        )
        for text in failures(outcome):
            say(text, "yellow")
    if outcome.lost:
        say(outcome.lost, "red")
    if outcome.interrupted:
        say(f"interrupted; give the same command with --resume{f' -o {folder}' if named else ''}", "yellow")
    if as_json:
        print_json({
            "scene": str(scene), "status": outcome.ended, "cases": len(outcome.cases), "done": outcome.done,
            "failed": outcome.failed, "earlier": outcome.earlier,
            **{name: str(path) for name, path in written.items()}, "figures": [str(path) for path in figures],
            "limits": _allowed(found), "all_limits": _least(found), "run_limits": _run_limits(found),
            "fatigue": None if found.fatigue is None else told(found.fatigue), "notes": found.notes,
            "warnings": found.warnings, "scene_warnings": warning_records(of_scene),
            "wall_time": outcome.wall_time, "cpu_time": outcome.cpu_time,
        })  # fmt: skip
    if outcome.interrupted:
        raise Ended(ExitCode.STOPPED_EARLY if outcome.lost else ExitCode.INTERRUPTED)
    if not outcome.done:
        raise Ended(ExitCode.STOPPED_EARLY)


def _compared_said(asked: Asked, limit: Criterion) -> str:
    """What is compared with a limit. What the smallest stays above with 90 % probability is its P10."""
    what = limit.of_storm
    if asked.compared == "most_probable":
        return f"most probable {what.removeprefix('the ')}"
    share = f"{100.0 * asked.share:.12g}" if limit.way > 0.0 else f"{100.0 - 100.0 * asked.share:.12g}"
    return f"P{share} of {what} in {_lasting(asked.duration)}"


def _lasting(duration: float) -> str:
    """A duration, s, in hours where it is one at least."""
    from tautline.scene.values.printed import quantity

    return f"{duration / 3600.0:.4g} h" if duration >= 3600.0 else quantity(duration, "s")


def _allowed(found: Found) -> list[dict[str, Any]]:
    """Allowable heights, m, heading by heading and period by period; null where not known."""
    import numpy as np

    from crane.operability.run_limits import failed_from

    table, told = found.table, []
    if table is None:
        return []
    lowest = failed_from(found.failed, table)
    for k, i, j in np.ndindex(*table.allowable.shape):
        told.append({
            "limit": found.criteria[k].text, "heading": table.headings[i], "peak_period": float(table.periods[j]),
            **_allowable_json(table.allowable[k, i, j]), "run_limits_failed_from": _known(lowest[i, j]),
        })  # fmt: skip
    return told


def _least(found: Found) -> list[dict[str, Any]]:
    """What all limits allow, heading by heading and period by period; nothing where there is but one limit."""
    from crane.operability.output import least_of_all
    from crane.operability.run_limits import failed_from

    table = found.table
    if table is None:
        return []
    lowest = failed_from(found.failed, table)
    return [
        {
            "heading": table.headings[i], "peak_period": float(table.periods[j]), **_allowable_json(one),
            "governed_by": found.criteria[k].text if k >= 0 else None, "run_limits_failed_from": _known(lowest[i, j]),
        }
        for i, j, k, one in least_of_all(table)
    ]  # fmt: skip


def _run_limits(found: Found) -> list[dict[str, Any]]:
    """Limits of every run that storms failed: the worst value and the bound in SI, and the sea states with storms."""
    import numpy as np

    table, told = found.table, []
    for one in found.failed if table is not None else ():
        assert table is not None
        states = [
            {
                "heading": table.headings[i], "peak_period": float(table.periods[j]),
                "significant_height": float(table.heights[n]), "storms": int(one.storms[i, j, n]),
            }
            for i, j, n in np.argwhere(one.storms)
        ]  # fmt: skip
        told.append({
            "limit": one.limit.name, "text": one.limit.text, "unit": one.limit.unit, "sense": one.limit.sense,
            "bound": one.bound, "worst": one.worst, "sea_states": states,
        })  # fmt: skip
    return told


def _allowable_json(one: Any) -> dict[str, Any]:
    """An allowable height and its interval, m, and how they are bounded; null where not known."""
    return {
        "allowable_height": _known(one.height), "low": _known(one.low), "high": _known(one.high),
        "bound": one.bound, "low_bound": one.low_bound, "high_bound": one.high_bound,
    }  # fmt: skip


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _where(one: dict[str, Any]) -> str:
    from crane.operability.output import degrees

    return f"Tp {one['peak_period']:g} s, heading {degrees(one['heading'])}"


def _said(one: dict[str, Any], system: str) -> str:
    """An allowable height in words, with its interval as far as it is one."""
    from tautline.scene.values.printed import shown

    height, low, high = one["allowable_height"], one["low"], one["high"]
    if height is None:
        return "not known"
    said = shown(height, "m", system) if height > 0.0 or not one["bound"] else "none"
    said += f", {one['bound']}" if one["bound"] else ""
    # An end that is bounded by the grid, and not by the fit, is said to be so.
    ends = [
        f"from {one['low_bound'] if low == 0.0 else shown(low, 'm', system)}" if low < height else "",
        f"to {one['high_bound'] or shown(high, 'm', system)}" if high > height else "",
    ]
    interval = " ".join(end for end in ends if end)
    return f"{said} ({interval})" if interval else said


def _also_failed(one: dict[str, Any], system: str) -> str:
    """What is said beside an allowable height that reaches into seas whose storms fail limits of every run."""
    from crane.operability.run_limits import within
    from tautline.scene.values.printed import shown

    height, lowest = one["allowable_height"], one["run_limits_failed_from"]
    if height is None or lowest is None or not within(height, lowest):
        return ""
    return f"; from {shown(lowest, 'm', system)} on storms fail limits of a run, see the warnings below"


def _rows(found: Found, asked: Asked, system: str = "si") -> list[tuple[str, str]]:
    """Rows of the summary: allowable heights, and what it took."""
    from crane.operability.run_limits import counted
    from tautline.scene.values.printed import quantity

    rows: list[tuple[str, str]] = []
    for one in _allowed(found):
        rows.append((f"Hs for {one['limit']}, {_where(one)}", _said(one, system) + _also_failed(one, system)))
    for one in _least(found):
        height = one["allowable_height"]
        # Of limits that the grid bounds none governs.
        by = "" if height is None or (height and one["bound"]) else f", by {one['governed_by']}"
        rows.append((f"Hs for all limits, {_where(one)}", f"{_said(one, system)}{by}{_also_failed(one, system)}"))
    if found.fatigue is not None:
        rows += _of_fatigue(found.fatigue, counted(found.failed, found.fatigue.share), system)
    if said := dict.fromkeys(_compared_said(asked, one) for one in found.criteria):
        rows.append(("compared with limits", ", ".join(said)))
    rows.append(("storms", str(found.outcome.done)))
    return [*rows, ("wall time", quantity(found.outcome.wall_time, "s"))]


def _of_fatigue(found: Fatigue, failed: bool, system: str) -> list[tuple[str, str]]:
    """Rows of the summary: fatigue over the scatter diagram, and whether storms of it fail limits of every run."""
    from tautline.scene.values.printed import shown, significant

    # What failed, or was too steep to run, does not stand in the sum: its share is said with each number.
    part = "" if found.whole else ", of the time that was run"
    ranged, cycles = "not known", "not known"
    if found.any:
        ranged, cycles = shown(found.range, "N", system), significant(found.cycles)
    rows = [
        (f"equivalent tension range over the scatter diagram{part}", ranged),
        (f"cycles in a year{part}", cycles),
        ("share of time that was run", f"{significant(100.0 * found.covered)} %"),
    ]
    also = "; storms of it fail limits of a run, see the warnings below" if failed else ""
    if found.unharmed:
        life = "without end" if found.whole else "not known"
        rows.append(("fatigue life", f"{life}: no damage{part}{also}"))
    elif found.life is not None:
        most = "" if found.whole else "not known, at most "
        rows.append(("fatigue life", f"{most}{significant(found.life)} years{also}"))
    return rows
