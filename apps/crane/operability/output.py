"""What operability writes: all sea states in one NetCDF and one CSV, the allowable heights in a CSV, and figures."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crane.operability.allowable import FITTED, UPWARDS, Allowable, Table, governing, of_all, steepest
from crane.operability.criteria import Criterion
from crane.operability.run_limits import Failed, failed_from, words_of
from crane.operability.scatter import Fatigue
from tautline.results.errors import WriteError
from tautline.results.tables.rows import heads_of, write_rows
from tautline.sweeps.table import Variables, write_netcdf
from tautline.view.figures.figure import QUIET, axes, colour, save, styled

DATASET, STATES, HEIGHTS, DAMAGE = "operability.nc", "operability.csv", "allowable.csv", "damage.csv"
NAMED = "allowable_"
"""Begins the names of figures."""
OWN = "as in the scene"
ALL = "all limits"
LINE = 95
"""Letters that have room in a line under the title of a figure."""


def degrees(heading: float | None) -> str:
    """A heading in words."""
    return OWN if heading is None else f"{math.degrees(heading):.6g} deg"


def _finite(values: Any) -> np.ndarray:
    """Values as files have them: what has no end is no number there, and is told in words (`endless_notes`)."""
    values = np.asarray(values, float)
    return np.where(np.isfinite(values), values, math.nan)


def dataset(
    table: Table, criteria: Sequence[Criterion], attributes: Mapping[str, Any], failed: Sequence[Failed] = ()
) -> Variables:
    """All that was found as named arrays: dimensions limit, heading, peak_period, significant_height, seed.

    And run_limit, the limits of every run that storms failed, where any did.
    """
    state = ("heading", "peak_period", "significant_height")
    of_limit = ("limit", *state)
    entries: dict[str, Any] = {
        "status": (state, table.status, {"long_name": "whether the sea state was computed"}),
        "storms_done": (state, table.done, {"units": "1", "long_name": "storms that came to their end"}),
        "value": (
            (*of_limit, "seed"),
            _finite(table.values),
            {"long_name": "largest or smallest of each storm, SI units"},
        ),
    }
    for name in FITTED:
        about = {"long_name": name.replace("_", " ")} | ({"units": "1"} if name.startswith("exceedance") else {})
        entries[name] = (of_limit, _finite(table.extremes[name]), about)
    for name, get in (
        ("allowable_height", lambda one: one.height), ("allowable_height_low", lambda one: one.low),
        ("allowable_height_high", lambda one: one.high),
    ):  # fmt: skip
        values = np.array([get(one) for one in table.allowable.ravel()], float).reshape(table.allowable.shape)
        entries[name] = (of_limit[:3], values, {"units": "m", "long_name": name.replace("_", " ")})
    for name, read, text in (
        ("allowable_bound", lambda one: one.bound, "the allowable height"),
        ("allowable_low_bound", lambda one: one.low_bound, "the lower end of its interval"),
        ("allowable_high_bound", lambda one: one.high_bound, "the upper end of its interval"),
    ):
        bounds = np.array([read(one) for one in table.allowable.ravel()], object).reshape(table.allowable.shape)
        entries[name] = (of_limit[:3], bounds, {"long_name": f"how {text} is bounded"})
    limit = steepest(table.periods, table.gravity)
    entries["steepest"] = (("peak_period",), limit, {"units": "m", "long_name": "limit of steepness"})
    headings = [math.nan if one is None else one for one in table.headings]
    of_run: dict[str, Any] = {}
    if failed:
        counts = np.array([one.storms for one in failed])
        about = {"units": "1", "long_name": "storms that fail a limit of every run"}
        entries["run_limit_failed"] = (("run_limit", *state), counts, about)
        of_run = {"run_limit": ("run_limit", np.array([one.limit.name for one in failed], object))}
    coordinates = {
        "limit": ("limit", np.array([one.text for one in criteria], object)),
        "limit_value": ("limit", np.array([one.limit for one in criteria])),
        "limit_units": ("limit", np.array([one.unit for one in criteria], object)),
        "heading": ("heading", np.array(headings), {"units": "rad"}),
        "peak_period": ("peak_period", table.periods, {"units": "s"}),
        "significant_height": ("significant_height", table.heights, {"units": "m"}),
        "seed": ("seed", table.seeds),
        **of_run,
    }
    return Variables.of(entries, coordinates, attributes)


def write_all(
    table: Table, criteria: Sequence[Criterion], attributes: Mapping[str, Any], folder: Path,
    fatigue: Fatigue | None = None, failed: Sequence[Failed] = (),
) -> dict[str, Path]:  # fmt: skip
    """Write dataset and tables into a folder, of heights only where there is a limit; raises WriteError."""
    written = {
        "result": write_netcdf(dataset(table, criteria, attributes, failed), folder / DATASET),
        "table": _write_states(table, criteria, folder / STATES, failed),
    }
    if criteria:
        written["allowable"] = _write_heights(table, criteria, folder / HEIGHTS, failed)
    else:
        # Of a run before, gone on with without its limits: they are not those of this one.
        (folder / HEIGHTS).unlink(missing_ok=True)
    if fatigue is not None:
        written["damage"] = _write_damage(table, fatigue, folder / DAMAGE, failed)
    return written


def _write_damage(table: Table, fatigue: Fatigue, path: Path, failed: Sequence[Failed]) -> Path:
    """A row for each sea state: its share of time, how much of it was run, and the part of that in a year's damage."""
    heads = [
        "heading [deg]", "peak_period [s]", "significant_height [m]", "share of time", "share of it that was run",
        "limits of a run that storms fail", "damage in a year [N^5]", "share of damage",
    ]  # fmt: skip
    whole = float(np.nansum(fatigue.damage)) or 1.0
    rows = [
        [
            *_place(table, *at[:2]), float(table.heights[at[2]]), float(fatigue.share[at]), float(fatigue.run[at]),
            words_of(failed, at), float(damage), float(damage) / whole,
        ]
        for at, damage in np.ndenumerate(fatigue.damage)
    ]  # fmt: skip
    return write_rows(heads, rows, path, error_type=WriteError)


def _write_states(table: Table, criteria: Sequence[Criterion], path: Path, failed: Sequence[Failed]) -> Path:
    """A row for each limit and sea state; without limits one for each sea state."""
    heads = heads_of(["limit", "unit", "heading", "peak_period", "significant_height"], {
        "heading": "deg", "peak_period": "s", "significant_height": "m",
    })  # fmt: skip
    rows = []
    for k, *at in np.ndindex(max(1, len(criteria)), *table.status.shape):
        i, j, n = at
        limit = [criteria[k].text, criteria[k].unit] if criteria else ["", ""]
        fits = [math.nan] * len(FITTED)
        if criteria:
            fits = _finite([table.extremes[name][k, i, j, n] for name in FITTED]).tolist()
        state = [table.status[i, j, n], int(table.done[i, j, n])]
        place = [*_place(table, i, j), float(table.heights[n])]
        rows.append([*limit, *place, *state, *fits, words_of(failed, (i, j, n))])
    heads = [*heads, "status", "storms_done", *FITTED, "run_limits_failed"]
    return write_rows(heads, rows, path, error_type=WriteError)


def _write_heights(
    table: Table, criteria: Sequence[Criterion], path: Path, failed: Sequence[Failed] = ()
) -> Path:  # fmt: skip
    """A row for each limit, heading and period; of several limits what all allow last, and which of them governs."""
    rows = []
    heads = [
        "limit", "heading [deg]", "peak_period [s]", "allowable_height [m]", "low [m]", "high [m]", "bound",
        "low bound", "high bound", "limits of a run fail from [m]", "governed by",
    ]  # fmt: skip
    lowest = failed_from(failed, table)
    for k, i, j in np.ndindex(*table.allowable.shape):
        rows.append([criteria[k].text, *_place(table, i, j), *table.allowable[k, i, j], lowest[i, j], ""])
    for i, j, k, one in least_of_all(table):
        rows.append([ALL, *_place(table, i, j), *one, lowest[i, j], criteria[k].text if k >= 0 else ""])
    return write_rows(heads, rows, path, error_type=WriteError)


def least_of_all(table: Table) -> list[tuple[int, int, int, Allowable]]:
    """Heading, period, the limit that governs there (-1: not known), and what all limits allow.

    Nothing where there is but one limit.
    """
    if len(table.allowable) < 2:
        return []
    found = governing(table)
    least: Any = of_all(table)
    return [(i, j, int(found[i, j]), least[i, j]) for i, j in np.ndindex(*found.shape)]


def _place(table: Table, heading: int, period: int) -> list[float]:
    angle = table.headings[heading]
    return [math.nan if angle is None else math.degrees(angle), float(table.periods[period])]


def draw(
    table: Table, criteria: Sequence[Criterion], title: str, compared: Sequence[str], folder: Path,
    failed: Sequence[Failed] = (),
) -> list[Path]:  # fmt: skip
    """Draw allowable significant height against peak period, a curve for each heading.

    A figure for each limit, and of several limits one of the smallest of all. `compared` are the words for what is
    compared with each limit. A cross marks the lowest height of which storms fail limits of every run.
    """
    made: list[Path] = []
    lowest = failed_from(failed, table)
    for k, (one, said) in enumerate(zip(criteria, compared, strict=True)):
        name = re.sub(r"[^A-Za-z0-9]+", "_", one.text).strip("_")
        if folder / f"{NAMED}{name}.png" in made:
            # Limits that differ in their signs only.
            name = f"{name}_{k + 1}"
        made.append(
            save(_figure(table, table.allowable[k], one.text, title, said, lowest), folder / f"{NAMED}{name}.png")
        )
    if len(table.allowable) > 1:
        said = ", ".join(dict.fromkeys(compared))
        made.append(save(_figure(table, of_all(table), ALL, title, said, lowest), folder / f"{NAMED}all_limits.png"))
    return made


@styled
def _figure(
    table: Table, allowable: np.ndarray, text: str, title: str, compared: str, lowest: np.ndarray | None = None
) -> Any:
    """Heights (headings, periods) of `Allowable`; `lowest` of which storms fail limits of every run, NaN for none."""
    figure, plots = axes(1, 1, 6.8, 4.4, f"{title}: {text}" if title else text)
    plot, periods = plots[0, 0], table.periods
    top = 1.15 * float(table.heights[-1])
    in_view = any(each.height > 0.0 or each.high > 0.0 for each in allowable.ravel())
    for i, heading in enumerate(table.headings if in_view else ()):
        _curve(plot, periods, allowable[i], colour(i, len(table.headings)), degrees(heading))
    lowest = np.full(allowable.shape, math.nan) if lowest is None else lowest
    crossed = bool(np.isfinite(lowest).any())
    for i in range(len(table.headings) if crossed else 0):
        shade = colour(i, len(table.headings))
        plot.plot(periods, lowest[i], "x", ms=8, mew=2, color=shade, clip_on=False, zorder=4)
    fine = np.linspace(periods[0], periods[-1], 100)
    if (steep := steepest(fine, table.gravity)).min() < top:
        plot.plot(fine, steep, "--", lw=1, color=QUIET, label="steepest waves")
    plot.set_ylim(0.0, top)
    margin = 0.05 * (float(np.ptp(periods)) or 1.0)
    plot.set_xlim(periods[0] - margin, periods[-1] + margin)
    plot.set_xlabel("peak period Tp [s]")
    plot.set_ylabel("allowable significant wave height Hs [m]")
    if plot.get_legend_handles_labels()[1]:
        plot.legend(title="heading" if in_view else None, fontsize=8)
    if said := _without_heights(table, allowable):
        plot.text(0.5, 0.5, said, transform=plot.transAxes, ha="center", va="center")
    within = "shaded" if len(periods) > 1 else "bar"
    of_curves = f"; {within}: its confidence interval; open: bounded, see allowable.csv" if in_view else ""
    of_crosses = "; crosses: from here on storms fail limits of a run" if crossed else ""
    plot.set_title(textwrap.fill(f"{compared}{of_curves}{of_crosses}", LINE), fontsize=8, loc="left")
    return figure


def _curve(plot: Any, periods: np.ndarray, found: Sequence[Allowable], shade: Any, text: str) -> None:
    """Heights of a heading with their intervals; circles of heights that are bounded are open."""
    height, low, high = (np.array([getattr(each, name) for each in found]) for name in ("height", "low", "high"))
    # A circle at zero is a whole one.
    plot.plot(periods, height, "o-", ms=4, color=shade, label=text, clip_on=False)
    if len(periods) > 1:
        plot.fill_between(periods, low, high, color=shade, alpha=0.18, lw=0)
    else:
        # Between one period and itself there is no area.
        plot.errorbar(periods, height, [height - low, high - height], fmt="none", ecolor=shade, capsize=4, lw=1)
    open_ = np.array([bool(each.bound) for each in found])
    plot.plot(periods[open_], height[open_], "o", ms=4, mfc="white", color=shade, clip_on=False)


def _without_heights(table: Table, allowable: np.ndarray) -> str:
    """What a picture says that has no height above zero; nothing of one that has."""
    heights = [each.height for each in allowable.ravel()]
    if any(height > 0.0 for height in heights):
        return ""
    if any(math.isnan(height) for height in heights):
        return "No sea is known to be allowable: see allowable.csv"
    lowest = f"Hs = {table.heights[0]:.4g} m"
    if reaching := [each for each in allowable.ravel() if each.high > 0.0]:
        highest = max(reaching, key=lambda each: each.high)
        beyond = " or more" if highest.high_bound in UPWARDS else ""
        return (
            f"By the estimate not even the lowest sea\nthat was computed, {lowest}, is allowable.\n"
            f"The confidence interval reaches up to Hs = {highest.high:.4g} m{beyond}."
        )
    return f"No sea is allowable, and not even the lowest\nthat was computed, {lowest}."
