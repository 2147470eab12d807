"""The verb ``stability``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tautline.application.installed import Catalogue
from tautline.cli.commands.study import (
    Options,
    named,
    percentage,
    prepared,
    show,
    stem_of,
    stop_record,
    tell_of,
    working,
)
from tautline.cli.output.console import print_json, say
from tautline.cli.output.scene_warnings import warning_records
from tautline.cli.output.summary import two_columns
from tautline.cli.run import Ended, ExitCode
from tautline.scene.values.printed import significant

if TYPE_CHECKING:
    from rich.table import Table

    from tautline.scene.errors import SceneWarning
    from tautline.study.robustness.critical import Critical
    from tautline.study.robustness.stability import Stability
    from tautline.study.robustness.variants import Variant

QUICK_BUDGET = 3.0
COLOUR = {"right": "green", "inaccurate": "yellow", "stopped": "cyan", "refused": "cyan", "unjudged": "magenta"}


def stability(catalogue: Catalogue, path: Path, output: Path | str | None, asked: Options, as_json: bool) -> None:
    """Look a scene over and report what limits its step and what breaks it.

    Parameters
    ----------
    output : Path, str or None
        Beginning of the names of the files that are written; by default the scene's with ``_stability``.

    Raises
    ------
    SceneError, ResultError
        For bad input; nothing is written then.
    Ended
        If the scene as it stands stopped early, on Ctrl-C, and where a run was wrong without a word.
    """
    from tautline.integrators.status import Interrupted
    from tautline.study.robustness.stability import stability as run

    tolerance = percentage(asked.tolerance, "--tolerance")
    (subject, warnings), stem = prepared(catalogue, path, asked), stem_of(path, output, "stability")
    budget = min(asked.budget, QUICK_BUDGET) if asked.quick else asked.budget
    try:
        with working() as progress:
            found = run(subject, tolerance, budget, asked.point, asked.quick, progress)
    except Interrupted:
        say("interrupted", "yellow")
        raise Ended(ExitCode.INTERRUPTED) from None
    _report(path, stem, found, as_json, warnings)
    if found.interrupted:
        say("interrupted", "yellow")
        raise Ended(ExitCode.INTERRUPTED)
    if found.stop is not None or any(variant.silent for variant in found.variants):
        raise Ended(ExitCode.STOPPED_EARLY)


def _report(path: Path, stem: Path, found: Stability, as_json: bool, warnings: Sequence[SceneWarning]) -> None:
    from tautline.results.output_path import make_folder
    from tautline.study.figures import stability_figure
    from tautline.study.record import stability_record, write_csv

    whole = stability_record(found)
    tell_of(path, found.stop)
    show(two_columns(_rows(found)))
    if found.variants:
        show(_table(found.variants))
    for warning in found.warnings:
        say(f"warning: {warning}", "yellow")
    if found.variants:
        _count(found.variants)
    if found.left_out:
        say(f"a quick look: {'; '.join(found.left_out)}")
    make_folder(stem.parent)
    files = [write_csv(whole["variants"], named(stem, ".csv"))] if found.variants else []
    files.append(stability_figure(found, f"{path.stem}: stability", named(stem, ".png")))
    for file in files:
        say(f"wrote {file}")
    if as_json:
        status = {"status": "interrupted"} if found.interrupted else stop_record(found.stop)
        ends = {"files": [str(file) for file in files], "scene_warnings": warning_records(warnings)}
        print_json({"scene": str(path)} | status | whole | ends)


def _count(variants: Sequence[Variant]) -> None:
    """Say how many ended wrong without a word, and of how many nobody knows."""
    silent = sum(variant.silent for variant in variants)
    unknown = sum(variant.outcome == "unjudged" for variant in variants)
    whole = f"{len(variants)} variants" + (f", {unknown} of them not judged" if unknown else "")
    if silent:
        say(f"{silent} of {whole} ended with a wrong result and no warning", "red")
    else:
        rest = "of the others " if unknown else ""
        say(f"{whole}: {rest}no wrong result without a warning", "green")


def _rows(found: Stability) -> list[tuple[str, str]]:
    c = found.critical
    rows = [
        (f"critical step of {c.method}, by effective length (eq. 2.151)", _step(c.effective_length, c.shortest)),
        ("critical step by eigenvalues, least along the run", _step(c.eigenvalue, f"at t = {c.at:.4g} s")),
        ("critical step by eigenvalues set by", c.set_by or "–"),
        ("angular frequency of that mode", "–" if c.omega_max is None else f"{significant(c.omega_max)} rad/s"),
        ("critical step by real runs from the start", _bracket(c.bisection, c.at_start)),
        (f"step of {c.method} to stay below, the smallest of these", _step(_least(c), "")),
    ]
    if c.why:
        rows.append(("", c.why))
    for kind in dict.fromkeys(entry.kind for entry in found.penalties):
        steps = [e for e in found.penalties if e.kind == kind]
        text = ", ".join(f"{e.value:.0e}: " + (f"{e.critical_step:.2g} s" if e.critical_step else "–") for e in steps)
        rows.append((f"with {kind} springs of so many N/m", text))
    for condition in found.conditions:
        plain = "" if condition.unscaled is None else f", {condition.unscaled:.1e} without the scaling"
        what = f"condition number of the matrix of a step of {condition.step:.2g} s"
        rows.append((what, f"{condition.scaled:.1e}{plain}"))
    rows.append(("energy drift of the scene as it stands", _share(found.energy_drift)))
    if found.constraint_drift is not None:
        rows.append(("constraint drift", f"{found.constraint_drift:.1e}"))
    rows.append(("tangent against differences of the residual", _share(found.tangent)))
    return rows


def _least(critical: Critical) -> float | None:
    """The shortest of the critical steps that were found, s; of real runs the longest step that was stable."""
    stable = critical.bisection[0] if critical.bisection is not None else None
    known = [step for step in (critical.effective_length, critical.eigenvalue, stable) if step is not None]
    return min(known, default=None)


def _step(value: float | None, note: str) -> str:
    if value is None:
        return "–"
    return f"{significant(value)} s ({note})" if note else f"{significant(value)} s"


def _bracket(found: tuple[float, float] | None, start: float | None) -> str:
    if found is None:
        return "–"
    there = "" if start is None else f" (by eigenvalues there: {significant(start)} s)"
    return f"stable at {significant(found[0])} s, not at {significant(found[1])} s{there}"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"


def _table(variants: Sequence[Variant]) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan")
    for name in ("variant", "outcome", "error", "status", "what the run says"):
        table.add_column(name)
    for v in variants:
        outcome = Text(v.outcome + (", SILENT" if v.silent else ""), style="red" if v.silent else COLOUR[v.outcome])
        error = "–" if v.error is None else f"{100.0 * v.error:.2g} %"
        own = f"late by {v.lag:.1g} rad, energy {v.energy_error:.1g}" if v.outcome == "inaccurate" else ""
        own += f", states {100.0 * v.stated:.2g} %" if v.stated else ""
        count = len(v.warnings)
        warned = f"{count} warning{'s' * (count > 1)}" if count else own
        table.add_row(v.name, outcome, error, v.status, warned)
    return table
