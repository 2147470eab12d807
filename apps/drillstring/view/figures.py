"""Default figures of a drill string's results: what happened at both ends, what it did to the pipe, where it is.

Figures are drawn from the stored variables alone, so a result can be plotted where its scene is not at hand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drillstring.results.observe import STUCK
from drillstring.results.places import depth_said, part_of
from drillstring.results.whirl import turns, whirl_of
from drillstring.view.drilling_figures import drilling, phase
from drillstring.view.whirl_figures import lump_of, whirl
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, names, over_time, title
from tautline.view.figures.drawings import Drawing, drawn, writing
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    Axes,
    Figure,
    axes,
    colour,
    equal_scale,
    label,
    legend_above,
    scale,
    shade,
    styled,
    widen,
)
from tautline.view.figures.histories import energies
from tautline.view.figures.waterfall import edges_of, waterfall_figure

NO_TORQUE = 1.0
"""Torques that stay below this are not drawn, N m."""
MOST_ORBITS = 6
"""Lumps whose ways across the hole are drawn."""
MOST_DOTS = 60
"""Lumps on a path from which on their dots are small."""
LEAST_ORBIT, LEAST_SHARE = 1e-7, 0.05
"""Motion across the hole below which a lump rests: m, and as a share of the largest."""
SIDE_FORCE = "side force on the wall, per {part}"


@styled
def overview(results: Sequence[Result]) -> Figure:
    """Block and bit, hook load, bit speed and surface torque against time; several results are overlaid."""
    turning = any(np.abs(result["surface_torque"]).max() > NO_TORQUE for result in results)
    rows = 4 if turning else 3
    figure, plots = axes(rows, 1, 8.0, 2.1 * rows + 0.4, title(results), sharex=True)
    moved, load, speed = plots[0, 0], plots[1, 0], plots[2, 0]
    force, force_unit = scale([result["hook_load"] for result in results], "N")
    moment, moment_unit = scale([result["surface_torque"] for result in results], "N m")
    called = names(results)
    shown: dict[Axes, list[np.ndarray]] = {plot: [] for plot in plots[:, 0]}
    blocks: list[np.ndarray] = []
    for number, result in enumerate(results):
        look = {"color": colour(number, len(results))} | marker(result.time)
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
            words = ("bit" if len(results) == 1 else called[number]) if plot is moved else None
            plot.plot(time, values, label=words, **look)
            shown[plot].append(values)
    if len(results) == 1:
        for plot in plots[:, 0]:
            # A bit that drills is stuck where it does not turn: its own figure shades that.
            text = "bit at rest along the hole" if plot is moved else ""
            shade(plot, results[0].time, np.abs(results[0]["bit_speed"]) < STUCK, text=text)
    moved.set_ylabel("displacement\ndown the hole [m]")
    load.set_ylabel(label("hook load", force_unit))
    speed.set_ylabel(label("bit speed", "m/s"))
    if turning:
        plots[3, 0].set_ylabel(label("surface torque", moment_unit))
    for plot, least in zip(plots[:, 0], (1e-2, 1e3 / force, 1e-3, NO_TORQUE / moment), strict=False):
        values = np.concatenate(shown[plot] + ([one - one[0] for one in blocks] if plot is moved else []))
        widen(plot, values, least)
    legend_above(moved)
    return over_time(figure, plots, [result.time for result in results])


@styled
def forces(results: Sequence[Result]) -> Figure:
    """Tension, side force and torque down the string: at the end of the run, and their range over time.

    Of one result the start is drawn too; of several the ends are told apart by colour.
    """
    turning = any(np.abs(result["torque"]).max() > NO_TORQUE for result in results)
    panels = [("tension", "N", "tension"), ("contact_force", "N", SIDE_FORCE.format(part=part_of(results[0])))]
    panels += [("torque", "N m", "torque")] if turning else []
    depths = [result["measured_depth"].mean(axis=0) for result in results]
    called = names(results) if len(results) > 1 else [None]
    figure, plots = axes(1, len(panels), 3.6 * len(panels) + 0.8, 5.6, title(results), sharey=True)
    for plot, (name, unit, text) in zip(plots[0], panels, strict=True):
        factor, unit = scale([result[name] for result in results], unit)
        for number, (result, depth) in enumerate(zip(results, depths, strict=True)):
            values = result[name] / factor
            at = depth if name == "contact_force" else _link_depth(depth, values.shape[1])
            joined = values.shape[1] > 1 and name != "contact_force"
            _profile(plot, values, at, result.time, joined, colour(number, len(results)), called[number])
        plot.axvline(0.0, color="black", lw=0.8)
        plot.set_xlabel(label(text, unit))
    plots[0, 0].set_ylabel(label("measured depth", "m"))
    low, high = min(0.0, *(depth.min() for depth in depths)), max(depth.max() for depth in depths)
    plots[0, 0].set_ylim(high + 0.03 * (high - low + 1.0), low - 0.01 * (high - low + 1.0))
    figure.legend(*plots[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _profile(
    plot: Axes, values: np.ndarray, depth: np.ndarray, time: np.ndarray, joined: bool, ink: Any, name: str | None
) -> None:
    """Draw (time, place) values against depth; `joined` by lines if they are samples of something continuous."""
    low, high = values.min(axis=0), values.max(axis=0)
    dashed, whole = ("--", "-") if joined else ("", "")
    if len(time) > 1:
        band: dict[str, Any] = {"color": COLOURS[5] if name is None else ink, "alpha": 0.35 if name is None else 0.2}
        text = "range over time" if name is None else ""
        if joined:
            plot.fill_betweenx(depth, low, high, lw=0, label=text, **band)
        else:
            plot.hlines(depth, low, high, lw=6, label=text, **band)
        if name is None:
            plot.plot(values[0], depth, color=QUIET, marker="o", ms=4, ls=dashed, label=f"start, {time[0]:.4g} s")
    words = f"{name or 'end'}, {time[-1]:.4g} s"
    plot.plot(values[-1], depth, color=ink, marker="o", ms=3, ls=whole, label=words)


@styled
def path(results: Sequence[Result]) -> Figure:
    """Vertical section and plan of the string at the end of the run, and of the well where the result has it."""
    (result,) = results
    part = part_of(result)
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
    figure, plots = axes(1, 2, 4.4 * sum(ratios) + 2.2, 5.6, title(results), width_ratios=ratios)
    section, plan = plots[0]
    for plot, flatten, span in zip(plots[0], flats, spans, strict=True):
        if well is not None:
            plot.plot(*flatten(well), color="#D9D9D9", lw=6, solid_capstyle="round", label="well")
        across, up = flatten(position)
        plot.plot(across, up, color=COLOURS[0], lw=1.2, label="string" if well is not None else None)
        # Where many run into one another, those on the wall must still be told from the others, and stand before them.
        size = 5.0 if len(position) <= MOST_DOTS else 3.0
        dots = {"ls": "", "marker": "o", "ms": size, "mew": 0.24 * size}
        on, off = {"mfc": COLOURS[1], "mec": COLOURS[1], "zorder": 3}, {"mfc": "white", "mec": QUIET, "zorder": 2.5}
        plot.plot(across[touching], up[touching], label=f"{part} on the wall", **on, **dots)
        plot.plot(across[~touching], up[~touching], label=f"{part} off the wall", **off, **dots)
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
def loop(results: Sequence[Result]) -> Figure:
    """Bit and hook load against the block: what the string keeps back on its way; a ring is where a run begins."""
    for result in results:
        if not np.ptp(result["block_position"]) > 0.0:
            raise NothingToShow(result, "a block that rests")
    figure, plots = axes(1, 2, 9.6, 4.6, title(results))
    bit, load = plots[0]
    force, force_unit = scale([result["hook_load"] for result in results], "N")
    for number, (result, name) in enumerate(zip(results, names(results), strict=True)):
        ink = colour(number, len(results))
        block, depth = result["block_position"], result["measured_depth"][:, -1]
        for plot, values in ((bit, depth - depth[0]), (load, result["hook_load"] / force)):
            words = name if plot is bit and len(results) > 1 else None
            plot.plot(block - block[0], values, color=ink, lw=1.1, label=words)
            plot.plot(0.0, values[0], color=ink, marker="o", ms=5, mfc="white", ls="", zorder=3)
    for plot in plots[0]:
        plot.set_xlabel(label("block, down the hole", "m"))
    bit.set_ylabel(label("bit, down the hole", "m"))
    load.set_ylabel(label("hook load", force_unit))
    # A string that did not stretch would stay on this line.
    bit.axline((0.0, 0.0), slope=1.0, color=QUIET, lw=0.8, ls=":", label="rigid string")
    figure.legend(*bit.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


@styled
def orbit(results: Sequence[Result], named: str = "") -> Figure:
    """Ways of lumps across the hole, inside the circle that its wall leaves them: those that move most, and the bit.

    Or those that are named, between commas.
    """
    (result,) = results
    part = part_of(result)
    offset = result["lateral_displacement"] if "lateral_displacement" in result else np.zeros((1, 1, 2))
    motion = np.ptp(offset, axis=0).max(axis=-1)
    if motion.max() < LEAST_ORBIT:
        raise NothingToShow(result, "no motion across the hole")
    least = max(LEAST_ORBIT, LEAST_SHARE * float(motion.max()))
    busiest = [int(k) for k in np.argsort(-motion) if motion[k] >= least][: MOST_ORBITS - 1]
    chosen = sorted({*busiest, offset.shape[1] - 1})
    if named:
        chosen = list(dict.fromkeys(lump_of(result, name) for name in named.split(",")))[:MOST_ORBITS]
    depth = result["measured_depth"].mean(axis=0)
    room = result["clearance"] if "clearance" in result else None
    rows = -(-len(chosen) // 3)
    figure, plots = axes(rows, min(len(chosen), 3), 3.3 * min(len(chosen), 3) + 0.6, 3.7 * rows + 0.9, title(results))
    turn = np.linspace(0.0, 2.0 * np.pi, 121)
    for number, (plot, k) in enumerate(zip(plots.flat, chosen, strict=False)):
        east, north = 1e3 * offset[:, k, 1], 1e3 * offset[:, k, 0]
        across, up = east, north
        if room is not None:
            wall = 1e3 * room[k] * np.array([-1.0, 1.0])
            across, up = np.r_[east, wall], np.r_[north, wall]
            plot.plot(1e3 * room[k] * np.cos(turn), 1e3 * room[k] * np.sin(turn), color="black", lw=1.0, label="wall")
        plot.plot(east, north, color=COLOURS[0], lw=0.9, label=f"path of the {part}'s axis")
        plot.plot(east[0], north[0], color=COLOURS[0], marker="o", ms=5, mfc="white", ls="", label="start")
        plot.plot(east[-1], north[-1], color=COLOURS[1], marker="o", ms=5, ls="", label="end")
        equal_scale(plot, across, up, 1e-3)
        words = "bit" if k == offset.shape[1] - 1 else f"{part} {k}"
        plot.set_title(f"{words}, {depth_said(depth[k])}{_whirls(result, k)}", fontsize=10)
        plot.set_xlabel(label("offset along m2", "mm"))
        if number % 3 == 0:
            plot.set_ylabel(label("offset along m1", "mm"))
    for plot in plots.flat[len(chosen) :]:
        plot.remove()
    figure.legend(*plots[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def _whirls(result: Result, lump: int) -> str:
    """The whirl ratio of a lump at the end, where the string turns."""
    if not {"rotation_rate", "velocity"} <= result.variables.keys() or not turns(result):
        return ""
    ratio = whirl_of(result, lump).ratio()
    return f", whirl ratio {round(ratio, 2) + 0.0:+.2f}" if np.isfinite(ratio) else ""


def waterfall(results: Sequence[Result], name: str = "tension") -> Figure:
    """What runs down the string, over time and measured depth."""
    (result,) = results
    values, variable = result[name], result.variables[name]
    depth = result["measured_depth"].mean(axis=0)
    if variable.dims == ("time", "link"):
        edges = np.r_[min(0.0, depth[0]), depth] if values.shape[1] == len(depth) else depth
    elif variable.dims == ("time", "body"):
        edges = np.clip(edges_of(depth), min(0.0, depth[0]), depth[-1]) if len(depth) > 1 else edges_of(depth)
    else:
        raise ResultError("--what", f"'{name}' does not run down the string", "name tension, torque or contact_force")
    unit = variable.units or ("N m" if name == "torque" else "N")
    return waterfall_figure(result, values, edges, (variable.long_name, unit), ("measured depth", "m"), downwards=True)


DRAWINGS: Mapping[str, Drawing] = {
    "overview": Drawing("block and bit, hook load, bit speed and surface torque against time", overview, compared=True),
    "forces": Drawing("tension, side force and torque against measured depth", forces),
    "waterfall": Drawing("tension over time and depth; waterfall:torque another", waterfall, False, takes=True),
    "drilling": Drawing("rotary speeds, torques, weight on bit and rate against time", drilling, compared=True),
    "phase": Drawing("rotary speed of the bit against the twist of the string", phase),
    "loop": Drawing("bit and hook load against the block", loop),
    "orbit": Drawing("ways of lumps across the hole, inside its wall; orbit:7,bit others", orbit, False, takes=True),
    "whirl": Drawing("orbit, whirl rate and spectra of a lump; whirl:7 another", whirl, False, takes=True),
    "path": Drawing("vertical section and plan", path, False),
    "energy": energies("work of the top"),
}
FIGURES: Mapping[str, str] = {name: drawing.text for name, drawing in DRAWINGS.items()}
"""Names for ``--what``."""


def draw(results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Figure]:
    """Draw figures or variables; see `tautline.view.figures.drawings.drawn`.

    By default, all that one result has something for, and the overview of several. Axes are in the units of the first
    result's scene.
    """
    return drawn(results, DRAWINGS, what, vs)


figures = writing(draw)
"""Draw figures into files, as the verb ``plot`` asks for; see `tautline.application.protocol.Application.figures`."""


def _link_depth(depth: np.ndarray, links: int) -> np.ndarray:
    """Depth of the middle of each link, (links,) m; a link more than there are gaps hangs from the rotary table."""
    if links == len(depth):
        depth = np.concatenate([[min(0.0, depth[0])], depth])
    return 0.5 * (depth[1:] + depth[:-1])


def _spans(across: np.ndarray, up: np.ndarray) -> tuple[float, float]:
    """Extent of a path to draw, m; a line or a point, as a vertical well is, gets some room to stand in."""
    room = max(0.35 * max(np.ptp(across), np.ptp(up)), 2.0)
    return max(float(np.ptp(across)), room), max(float(np.ptp(up)), room)
