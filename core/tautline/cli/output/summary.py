"""The table at the end of a run, and numbers as people write them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

from tautline.cli.output.console import console
from tautline.scene.values.printed import in_percent, in_words, printed_in, quantity, shown, significant, told_apart

if TYPE_CHECKING:
    from rich.table import Table

VERDICTS = {True: ("kept", "green"), False: ("FAILED", "red"), None: ("not judged", "yellow")}
"""What came of a limit, and its colour."""
LEAST_ANGLE = 1.0e-4
"""Angle, deg, below which only that is printed: two millimetres in a kilometre. ``--json`` has the number."""
FEWEST = 24
"""Letters in a line that a value has at least, beside what it is of, and that this has in a narrow window."""


def speed(factor: float | None) -> str:
    """Write a real-time factor, and what it means."""
    if factor is None or not math.isfinite(factor) or factor <= 0.0:
        return "–"
    if factor <= 1.0:
        return f"{significant(factor, 2)} ({significant(1.0 / factor, 2)} x faster than real time)"
    return f"{significant(factor, 3)} ({significant(factor, 2)} x slower than real time)"


def two_columns(rows: Iterable[tuple[str, str]]) -> Table:
    """Lay out rows of what and how much; brackets in them are just brackets."""
    from rich.table import Table
    from rich.text import Text

    room = max(FEWEST, console().width - FEWEST - 2)
    laid_out = Table(show_header=False, box=None, padding=(0, 2, 0, 0), pad_edge=False)
    # What a row is about stays on one line, however long the value beside it, but does not take the value's room.
    laid_out.add_column(style="cyan", no_wrap=True)
    laid_out.add_column(overflow="fold")
    for what, value in rows:
        laid_out.add_row(Text(textwrap.fill(what, room)), Text(value))
    return laid_out


def table(
    report: dict[str, Any],
    attributes: dict[str, Any],
    headline: dict[str, dict[str, Any]],
    aside: Collection[str] = (),
) -> Table:
    """Lay out the summary.

    Parameters
    ----------
    report : dict
        The keys of ``simulate --json``.
    attributes : dict
        Attributes of the result; `printed_in` says which units the figures are printed in.
    headline : dict
        The application's figures: name -> {value, unit, text}.
    aside : collection of str
        Names of figures and limits that are not printed.
    """
    system = printed_in(attributes)
    rows = []
    for name, figure in headline.items():
        if name in aside:
            continue
        label = in_words(str(figure.get("text") or name.replace("_", " ")), system)
        rows.append((label, _said(_along(label, figure.get("value")), str(figure.get("unit") or ""), system)))
    if limits := report.get("limits"):
        rows += _of_limits(limits, aside, system)
    apart = [("", "")] if rows else []
    return two_columns([*rows, *apart, *_numbers(report, attributes, system)])


def _of_limits(limits: list[dict[str, Any]], aside: Collection[str], system: str) -> list[tuple[str, str]]:
    """Rows of how many limits are satisfied, and of these by how much; the others are told as warnings.

    Those of the scene count, too, and have a table of their own.
    """
    satisfied = [record for record in limits if record["passed"]]
    others = "" if len(satisfied) == len(limits) else ", see the warnings below"
    shown = [record for record in satisfied if record["name"] not in aside and "output" not in record]
    return [
        ("limits satisfied", f"{len(satisfied)} of {len(limits)}{others}"),
        *((f"  {record['text']}", limit_said(record, system)) for record in shown),
    ]


def _said(value: Any, unit: str, system: str, digits: int = 4) -> str:
    """Write a figure; of an angle that nobody could measure that it is one."""
    if unit == "rad" and isinstance(value, float) and 0.0 < abs(math.degrees(value)) < LEAST_ANGLE:
        return f"less than {LEAST_ANGLE:g} deg"
    return shown(value, unit, system, digits)


def _along(label: str, value: Any) -> Any:
    """A figure that counts downwards as the label tells it: ``stroke of the block, up`` has no sign."""
    return -value if label.endswith(", up") and isinstance(value, (int, float)) else value


def _numbers(report: dict[str, Any], attributes: dict[str, Any], system: str) -> list[tuple[str, str]]:
    """Rows of how a run was computed, how fast, and how accurately."""
    longest = attributes.get("longest_step")
    rows = [
        ("method", str(report["method"] or "–")),
        # A step that was chosen is told by its mean.
        ("mean step", f"{quantity(report['step'], 's')}, at most {quantity(longest, 's')}")
        if longest
        else ("step", quantity(report["step"], "s")),
        ("steps", quantity(report["steps"], "")),
    ]
    if report["newton_iterations"]:
        iterations = report["newton_iterations"] / (report["steps"] or 1)
        rows.append(("Newton iterations per step", significant(iterations, 3)))
    if attributes.get("halvings"):
        rows.append(("step halvings", str(attributes["halvings"])))
    rows += [
        ("simulated time", quantity(report["simulated_time"], "s")),
        ("wall time", quantity(report["wall_time"], "s")),
        ("total time of the command", quantity(report["total_time"], "s")),
        ("real-time factor", speed(report["real_time_factor"])),
    ]
    if report["energy_error"] is not None:
        rows.append(("energy balance, relative error", significant(report["energy_error"], 2)))
    if (lost := report.get("numerical_dissipation")) is not None:
        # What nobody can account for is what the method has damped, as far as the ledger of power is exact.
        word = "numerical dissipation" if lost >= 0.0 else "energy created numerically"
        rows.append((word, shown(abs(lost), "J", system)))
    if report.get("phase_lag"):
        rows.append(("accumulated phase error of free vibration", shown(report["phase_lag"], "rad", system)))
    if chosen := report.get("accuracy"):
        rows.append((f"accuracy of {significant(100.0 * chosen['asked'], 3)} % asked for", _reached(chosen)))
    if found := report.get("step_error"):
        rows += _of_the_step(found, system)
    return rows


def _reached(chosen: dict[str, Any]) -> str:
    """What came of an accuracy that was asked for: ``reached, by estimate 0.42 %, in 4 runs that took ...``."""
    if chosen["met"] is None:
        return "not judged"
    estimate = "" if chosen["reached"] is None else f", by estimate {significant(100.0 * chosen['reached'], 2)} %"
    runs = f"{len(chosen['runs'])} runs"
    cost = "" if chosen["cost"] is None else f" that took {significant(chosen['cost'], 2)} times the time of the last"
    return f"{'reached' if chosen['met'] else 'NOT reached'}{estimate}, in {runs}{cost}"


def limit_said(record: dict[str, Any], system: str = "si") -> str:
    """A limit and what came of it: ``6.2 deg: must be at most 4 deg (winch, t = 3.2 s)``; angles in degrees."""
    from tautline.results.assessment.limits import AT_MOST  # it loads numpy

    unit = record["unit"]
    system_of_value = "si" if unit == "rad" else system
    limit = shown(record["limit"], unit, system_of_value)
    if record["passed"] is None:
        return f"{record['sense']} {limit} is not judged: {record['note']}"
    value, lasting = _said(record["value"], unit, system_of_value), record.get("for")
    if not record["passed"]:
        # A value that looks like its limit does not look failed.
        value, limit = told_apart(
            record["value"], record["limit"], lambda x, digits=4: _said(x, unit, system_of_value, digits)
        )
    held = f" for {quantity(lasting, 's')}" if lasting else ""
    verdict = ", " if record["passed"] else ": must be "
    # What is nowhere more than 0 has no place and no time.
    nowhere = record["sense"] == AT_MOST and record["value"] == 0.0
    where = "" if nowhere else in_words(when_and_where(record), system)
    about = in_words(record.get("note", ""), system)
    told = f"{value}{held}{verdict}{record['sense']} {limit}"
    return told + (f" ({where})" if where else "") + (f"; {about}" if about else "")


def when_and_where(record: dict[str, Any]) -> str:
    """Place and time of a limit's worst value: ``boom tip, t = 3.2 s``; empty where neither is known."""
    time = "" if record["time"] is None else f"{'from ' * bool(record.get('for'))}t = {significant(record['time'])} s"
    return ", ".join(word for word in (record["place"], time) if word)


def limits_of_scene(records: Iterable[dict[str, Any]], system: str = "si", begin: float | None = None) -> Table:
    """Lay out what came of the limits that a scene gives itself: each, whether it was kept, and what was worst.

    Parameters
    ----------
    records : iterable of dict
        Of `tautline.results.assessment.bounds`.
    system : str
        Of units.
    begin : float or None
        Of a run that keeps statistics, which looks at every frame: from when on it does so, s; None of stored frames.
    """
    from rich.table import Table
    from rich.text import Text

    laid_out = Table(
        title=f"limits of the scene, {_looked_at(begin)}",
        title_justify="left",
        show_header=False,
        box=None,
        pad_edge=False,
    )
    laid_out.add_column(style="cyan", overflow="fold")
    laid_out.add_column(no_wrap=True)
    laid_out.add_column(overflow="fold")
    for record in records:
        word, style = VERDICTS[record["passed"]]
        beyond = f"; beyond it for {quantity(record['longest'], 's')}" if record["longest"] else ""
        laid_out.add_row(Text(record["text"]), Text(word, style=style), Text(limit_said(record, system) + beyond))
    return laid_out


def _looked_at(begin: float | None) -> str:
    """Which frames of a run limits were looked at in; see `limits_of_scene`."""
    if begin is None:
        return "at the stored frames"
    # A result keeps but a few of these frames.
    return "in every frame of the run" + (f" from t = {quantity(begin, 's')}" if begin > 0.0 else "")


def _of_the_step(found: dict[str, Any], system: str) -> list[tuple[str, str]]:
    """Rows of the error that runs with other steps have shown."""
    way, force = (None if x is None else in_percent(x) for x in (found["position"], found["force"]))
    moved = f"{shown(found['distance'], 'm', system)} ({way}), {in_words(found['place'], system)}"
    rows = [("estimated error due to the step", moved)]
    if force is not None:
        rows.append(("", f"{force}, amplitude of {in_words(found['force_place'], system)}"))
    if found.get("twist") is not None:  # results of older versions have none
        off = f"{shown(found['twist_angle'], 'rad', system)} ({in_percent(found['twist'])})"
        rows.append(("", f"{off}, {found['twist_place']}"))
    if found.get("blow_said"):  # results of older versions have none
        known = "not known" if found["blow"] is None else in_percent(found["blow"])
        longer = found["taken"] is not None and found["step"] > found["taken"]
        told = "; --verify tells it" if longer else ""
        rows.append(("", f"{known}, {found['blow_said']}{told}"))
    return rows
