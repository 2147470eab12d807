"""Default figures of a drill string's results: what happened at both ends, what it did to the pipe, where it is.

Figures are drawn from the stored variables alone, so a result can be plotted where its scene is not at hand.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drillstring.observe import STUCK
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figure import COLOURS, QUIET, Axes, Figure, axes, label, save_all, scale, shade, styled, widen

NO_TORQUE = 1.0
"""Torques that stay below this are not drawn, N m."""

LONGEST_NAME = 60
"""Letters of a result's name that a legend has room for."""

SIDE_FORCE = "side force on the wall, per lump"

ENERGIES = {
    "kinetic_energy": "kinetic",
    "strain_energy": "strain",
    "potential_energy": "potential",
    "dissipated_energy": "dissipated",
    "external_work": "work of the top",
}


@styled
def overview(results: Sequence[Result]) -> Figure:
    """Block and bit, hook load, bit speed and surface torque against time; several results are overlaid."""
    turning = any(np.abs(result["surface_torque"]).max() > NO_TORQUE for result in results)
    rows = 4 if turning else 3
    title = _title(results[0]) if len(results) == 1 else "Comparison of results"
    figure, plots = axes(rows, 1, 8.0, 2.1 * rows + 0.4, title, sharex=True)
    moved, load, speed = plots[0, 0], plots[1, 0], plots[2, 0]
    force, force_unit = scale([result["hook_load"] for result in results], "N")
    moment, moment_unit = scale([result["surface_torque"] for result in results], "N m")
    names = _names(results)
    drawn: dict[Axes, list[np.ndarray]] = {plot: [] for plot in plots[:, 0]}
    blocks: list[np.ndarray] = []
    for number, result in enumerate(results):
        look = {"color": COLOURS[number % len(COLOURS)]} | _marker(result)
        time = result.time
        block, depth = result["block_position"], result["measured_depth"]
        # Runs under the same block motion share one line for it.
        if not any(one.shape == block.shape and np.allclose(one, block) for one in blocks):
            text = "block" if not blocks else "_block"
            moved.plot(time, block - block[0], **(look | {"color": QUIET}), ls="--", label=text)
            blocks.append(block)
        curves = {moved: depth[:, -1] - depth[0, -1], load: result["hook_load"] / force, speed: result["bit_speed"]}
        if turning:
            curves[plots[3, 0]] = result["surface_torque"] / moment
        for plot, values in curves.items():
            words = ("bit" if len(results) == 1 else names[number]) if plot is moved else None
            plot.plot(time, values, label=words, **look)
            drawn[plot].append(values)
    if len(results) == 1:
        for plot in plots[:, 0]:
            text = "bit stuck" if plot is moved else ""
            shade(plot, results[0].time, np.abs(results[0]["bit_speed"]) < STUCK, text=text)
    moved.set_ylabel("displacement\ndown the hole [m]")
    load.set_ylabel(label("hook load", force_unit))
    speed.set_ylabel(label("bit speed", "m/s"))
    if turning:
        plots[3, 0].set_ylabel(label("surface torque", moment_unit))
    for plot, least in zip(plots[:, 0], (1e-2, 1e3 / force, 1e-3, NO_TORQUE / moment), strict=False):
        values = np.concatenate(drawn[plot] + ([one - one[0] for one in blocks] if plot is moved else []))
        widen(plot, values, least)
    columns = max(1, min(5, 75 // (max(map(len, names)) + 5)))
    moved.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2)
    plots[-1, 0].set_xlabel(label("time", "s"))
    figure.align_ylabels(plots[:, 0])
    _whole_time(plots[-1, 0], results)
    return figure


@styled
def forces(result: Result) -> Figure:
    """Tension, side force and torque down the string: at the start, at the end, and their range over time."""
    tension, contact, torque = result["tension"], result["contact_force"], result["torque"]
    depth = result["measured_depth"].mean(axis=0)
    middle = _link_depth(depth, tension.shape[1])
    panels = [(tension, middle, "N", "tension"), (contact, depth, "N", SIDE_FORCE)]
    if np.abs(torque).max() > NO_TORQUE:
        panels.append((torque, middle, "N m", "torque"))
    figure, plots = axes(1, len(panels), 3.6 * len(panels) + 0.8, 5.6, _title(result), sharey=True)
    for plot, (values, at, unit, text) in zip(plots[0], panels, strict=True):
        factor, unit = scale([values], unit)
        values = values / factor
        _profile(plot, values, at, result.time, joined=values.shape[1] > 1 and text != SIDE_FORCE)
        plot.axvline(0.0, color="black", lw=0.8)
        plot.set_xlabel(label(text, unit))
    plots[0, 0].set_ylabel(label("measured depth", "m"))
    low, high = min(0.0, depth.min()), depth.max()
    plots[0, 0].set_ylim(high + 0.03 * (high - low + 1.0), low - 0.01 * (high - low + 1.0))
    plots[0, 0].legend(loc="best")
    return figure


def _profile(plot: Axes, values: np.ndarray, depth: np.ndarray, time: np.ndarray, joined: bool) -> None:
    """Draw (time, place) values against depth; `joined` by lines if they are samples of something continuous."""
    low, high = values.min(axis=0), values.max(axis=0)
    dashed, whole = ("--", "-") if joined else ("", "")
    if len(time) > 1:
        look: dict[str, Any] = {
            "color": COLOURS[5],
            "alpha": 0.35,
            "lw": 0 if joined else 6,
            "label": "range over time",
        }
        if joined:
            plot.fill_betweenx(depth, low, high, **look)
        else:
            plot.hlines(depth, low, high, **look)
        plot.plot(values[0], depth, color=QUIET, marker="o", ms=4, ls=dashed, label=f"start, {time[0]:.4g} s")
    plot.plot(values[-1], depth, color=COLOURS[0], marker="o", ms=3, ls=whole, label=f"end, {time[-1]:.4g} s")


@styled
def path(result: Result) -> Figure:
    """Vertical section and plan of the string at the end of the run, and of the well where the result has it."""
    position = result["position"][-1]
    touching = result["contact_force"][-1] > 0.0
    well = result["well_position"] if "well_position" in result else None
    course = position if well is None else well
    north, east = course[np.argmax(np.hypot(course[:, 0], course[:, 1])), :2]
    reach = np.hypot(north, east)
    # The section stands in the direction of the farthest point; any will do for a vertical well.
    along = np.array([north, east]) / reach if reach > 1e-6 else np.array([1.0, 0.0])
    flats = [lambda p: (p[:, :2] @ along, p[:, 2]), lambda p: (p[:, 1], p[:, 0])]
    spans = [_spans(*flatten(course)) for flatten in flats]
    ratios = [float(np.clip(across / up, 0.3, 2.0)) for across, up in spans]
    figure, plots = axes(1, 2, 4.4 * sum(ratios) + 2.2, 5.6, _title(result), width_ratios=ratios)
    section, plan = plots[0]
    for plot, flatten, span in zip(plots[0], flats, spans, strict=True):
        if well is not None:
            plot.plot(*flatten(well), color="#D9D9D9", lw=6, solid_capstyle="round", label="well")
        across, up = flatten(position)
        plot.plot(across, up, color=COLOURS[0], lw=1.2, label="string" if well is not None else None)
        dots = {"ls": "", "marker": "o", "ms": 5, "mec": COLOURS[1], "mew": 1.2}
        plot.plot(across[touching], up[touching], mfc=COLOURS[1], label="lump on the wall", **dots)
        plot.plot(across[~touching], up[~touching], mfc="white", label="lump off the wall", **dots)
        plot.set_aspect("equal", adjustable="box")
        plot.locator_params(axis="x", nbins=5 if span[0] > 0.6 * span[1] else 3)
        for set_limits, values, size in zip((plot.set_xlim, plot.set_ylim), flatten(course), span, strict=True):
            middle = 0.5 * (values.min() + values.max())
            set_limits(middle - 0.53 * size, middle + 0.53 * size)
    section.invert_yaxis()
    azimuth = np.degrees(np.arctan2(along[1], along[0])) % 360.0
    section.set_xlabel(label(f"departure, azimuth {azimuth:.0f}°", "m"))
    section.set_ylabel(label("true vertical depth", "m"))
    section.set_title("Vertical section")
    plan.set_xlabel(label("east", "m"))
    plan.set_ylabel(label("north", "m"))
    plan.set_title("Plan")
    figure.legend(*section.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


@styled
def energy(result: Result) -> Figure:
    """Changes of the energies since the start, and what is missing from their balance."""
    time = result.time
    values = {name: result[name] - result[name][0] for name in ENERGIES if name in result}
    if not values:
        raise ResultError(result.path or "result", "has no energies", f"draw another figure: {', '.join(FIGURES)}")
    factor, unit = scale(list(values.values()), "J")
    figure, plots = axes(2, 1, 8.0, 5.6, _title(result), sharex=True, height_ratios=(2.2, 1.0))
    upper, lower = plots[:, 0]
    for number, (name, change) in enumerate(values.items()):
        upper.plot(time, change / factor, color=COLOURS[number], label=ENERGIES[name], **_marker(result))
    upper.set_ylabel(label("change since the start", unit))
    widen(upper, np.concatenate(list(values.values())) / factor, 1e-3)
    upper.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, borderaxespad=0.2)
    missing = sum(change for name, change in values.items() if name != "external_work")
    missing = missing - values.get("external_work", 0.0)
    small, small_unit = scale([missing], "J")
    lower.plot(time, missing / small, color=COLOURS[6], **_marker(result))
    lower.set_ylabel(label("balance error", small_unit))
    widen(lower, missing / small, 1e-3)
    lower.set_xlabel(label("time", "s"))
    _whole_time(lower, [result])
    return figure


FIGURES: Mapping[str, str] = {
    "overview": "block and bit, hook load, bit speed and surface torque against time",
    "forces": "tension, side force and torque against measured depth",
    "path": "vertical section and plan",
    "energy": "energies and their balance",
}
"""Names for ``--what``."""

_SINGLE: Mapping[str, Callable[[Result], Figure]] = {"forces": forces, "path": path, "energy": energy}


def draw(results: Sequence[Result], what: Sequence[str] = ()) -> dict[str, Figure]:
    """Draw figures.

    Parameters
    ----------
    results : sequence of Result
        At least one.
    what : sequence of str
        Names out of `FIGURES`. If empty, all of them for one result, and the overview for several.

    Returns
    -------
    dict of str to Figure
        By name; with several results those of one result alone are named ``forces_<result>``.

    Raises
    ------
    ResultError
        If a name is unknown, or a result lacks what a figure shows.
    """
    for name in what:
        if name not in FIGURES:
            known = "; ".join(f"{key} ({text})" for key, text in FIGURES.items())
            raise ResultError("--what", f"there is no figure '{name}'", f"known: {known}")
    figures: dict[str, Figure] = {}
    for name in what or (FIGURES if len(results) == 1 else ("overview",)):
        if name == "overview":
            figures[name] = overview(results)
        elif len(results) == 1:
            figures[name] = _SINGLE[name](results[0])
        else:
            # Two results may have one name in two folders: none may overwrite the other's picture.
            for number, (result, stem) in enumerate(zip(results, _stems(results), strict=True)):
                key = f"{name}_{stem}"
                figures[key if key not in figures else f"{key}_{number + 1}"] = _SINGLE[name](result)
    return figures


def figures(
    results: Sequence[Result],
    folder: Path,
    what: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    stem: str | None = None,
) -> list[Path]:
    """Draw figures into files, as the verb ``plot`` asks for; see `tautline.cli.application.Application.figures`."""
    base = stem or (_stems(results)[0] if len(results) == 1 else "comparison")
    return save_all(draw(results, what), Path(folder), base, formats, whole=stem is not None)


def _stems(results: Sequence[Result]) -> list[str]:
    return [result.path.stem if result.path is not None else "result" for result in results]


def _names(results: Sequence[Result]) -> list[str]:
    """Names for a legend: the shortest that tell the results apart."""
    stems = _stems(results)
    if len(set(stems)) < len(stems):
        folders = [result.path.absolute().parent.name if result.path else "" for result in results]
        stems = [f"{folder}/{stem}" for folder, stem in zip(folders, stems, strict=True)]
    if len(set(stems)) < len(stems):
        stems = [f"{number + 1}: {stem}" for number, stem in enumerate(stems)]
    return [stem if len(stem) <= LONGEST_NAME else "…" + stem[1 - LONGEST_NAME :] for stem in stems]


def _title(result: Result) -> str:
    return str(result.attributes.get("title") or _stems([result])[0])


def _marker(result: Result) -> dict[str, str]:
    """A run of one frame is a dot: a line through one point would be invisible."""
    return {"marker": "o"} if len(result.time) == 1 else {}


def _whole_time(plot: Axes, results: Sequence[Result]) -> None:
    first, last = min(result.time[0] for result in results), max(result.time[-1] for result in results)
    if last > first:
        plot.set_xlim(first, last)


def _link_depth(depth: np.ndarray, links: int) -> np.ndarray:
    """Depth of the middle of each link, (links,) m; a link more than there are gaps hangs from the rotary table."""
    if links == len(depth):
        depth = np.concatenate([[min(0.0, depth[0])], depth])
    return 0.5 * (depth[1:] + depth[:-1])


def _spans(across: np.ndarray, up: np.ndarray) -> tuple[float, float]:
    """Extent of a path to draw, m; a line or a point, as a vertical well is, gets some room to stand in."""
    room = max(0.35 * max(np.ptp(across), np.ptp(up)), 2.0)
    return max(float(np.ptp(across)), room), max(float(np.ptp(up)), room)
