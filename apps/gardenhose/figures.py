"""Figures of hoses conveying fluid.

`figures` draws results, as the verb ``plot`` asks for, from the stored variables alone. `static_figure`,
`flutter_figure` and `boundary_figure` draw what the other verbs find, from plain arrays.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from gardenhose.curves import Plane, Trace, name_of, plane_of, shape_of, snapped, spread
from gardenhose.limit_cycle import LimitCycle, limit_cycle, spectrum, swings
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figure import COLOURS, QUIET, SHADE, Axes, Figure, axes, label, save_all, shade, styled, widen

FIGURES: Mapping[str, str] = {
    "overview": "tip, phase and shape; ramp too where the flow speed changes",
    "tip": "flow speed and the tip's coordinates against time",
    "phase": "phase portrait and path of the tip, as Fig. 2.30 of the thesis",
    "shape": "the hose over one cycle at the end of the run",
    "spectrum": "spectrum of the tip's motion at the end of the run",
    "ramp": "extremes and amplitude of the tip's motion against flow speed",
}
"""Names for ``--what``."""

CHANGES = 0.05
"""Share of the largest flow speed by which it changes where the speed counts as ramped."""
SHAPES = 24
"""Most shapes of the hose in one picture."""
SPREAD = 6
"""Points between two frames of a curve in time."""
ONSET = 0.01
"""Amplitude over the hose's length that the figure of a ramp marks."""
ALMOST = 0.15
"""How far a unit vector may be from an axis that figures take in its place."""
HARMONICS = 8
"""Times the frequency to which a spectrum reaches."""
SHADES = LinearSegmentedColormap.from_list("time", matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, 64)))
"""Colours of times and speeds, without the yellow that is lost on paper."""
STYLES = {"-": "in the plane", "--": "out of the plane"}
"""Lines of modes."""
MOST_NAMED = 8
"""Static shapes up to which each is named; of more, a bar tells the speed."""
FLAT = 1e-14
"""Share of the hose's length below which a line of a spectrum is rounding."""
DECADES = 6
"""That a spectrum shows."""
LONGEST_NAME = 40
"""Letters of a result's name that a legend has room for."""


class _Run:
    """What the figures need of a result, read once."""

    def __init__(self, result: Result, name: str) -> None:
        self.result, self.name = result, name
        self.time, self.tip, self.tip_velocity = result.time, result["tip"], result["tip_velocity"]
        self.flow = result["flow_speed"] if "flow_speed" in result else np.zeros(len(self.time))
        self.arc_length = result["arc_length"]
        self.length = float(self.arc_length[-1])
        self.cycle: LimitCycle = limit_cycle(self.time, self.tip, self.tip_velocity, self.length)
        self.trace = Trace(self.time, self.tip, self.tip_velocity)

    @functools.cached_property
    def position(self) -> np.ndarray:
        """Of the nodes, (frames, nodes, 3) m."""
        return self.result["position"]

    @functools.cached_property
    def plane(self) -> Plane:
        """The plane that the hose moves in during the cycles that the numbers stand for."""
        inside = (self.time >= self.cycle.start) & (self.time <= self.cycle.end) if self.cycle.cycles else slice(None)
        position = self.position[inside]
        return plane_of(position, towards=(position[:, -1] - position[:, 0]).mean(axis=0))

    @property
    def settled_time(self) -> np.ndarray:
        """Dense times of the cycles that the numbers stand for; of the whole run where there is none."""
        cycle, per_frame = self.cycle, SPREAD * max(len(self.time) - 1, 1)
        if cycle.cycles == 0:
            return np.linspace(self.time[0], self.time[-1], per_frame + 1)
        share = (cycle.end - cycle.start) / (self.time[-1] - self.time[0])
        return np.linspace(cycle.start, cycle.end, max(200, int(share * per_frame)) + 1)

    @property
    def ramped(self) -> bool:
        """Whether the flow speed changes in the run so that a motion has time to answer."""
        size = float(np.abs(self.flow).max())
        if len(self.time) < 3 or size == 0.0 or np.ptp(self.flow) <= CHANGES * size:
            return False
        changing = np.abs(np.diff(self.flow)) > 1e-6 * size
        spent = float(np.diff(self.time)[changing].sum())
        return spent > 3.0 * self.cycle.period and spent > 0.1 * (self.time[-1] - self.time[0])


@styled
def tip(results: Sequence[Result]) -> Figure:
    """Flow speed and the tip's coordinates against time; several results are overlaid."""
    runs = _runs(results)
    moves = np.array([np.ptp(run.tip, axis=0) for run in runs]).max(axis=0)
    shown = [axis for axis in range(3) if moves[axis] > 1e-6 * max(run.length for run in runs)] or [2]
    flows = any(np.any(run.flow) for run in runs)
    rows = len(shown) + flows
    figure, plots = axes(
        rows, 1, 8.0, 1.9 * rows + 1.0, _title(results), sharex=True, height_ratios=[0.7] * flows + [1.0] * len(shown)
    )
    for number, run in enumerate(runs):
        look = {"color": COLOURS[number % len(COLOURS)]} | _marker(run)
        if flows:
            plots[0, 0].plot(run.time, run.flow, label=run.name, **look)
        for plot, axis in zip(plots[int(flows) :, 0], shown, strict=True):
            dense = _dense(run)
            plot.plot(dense, run.trace(dense)[0][:, axis], lw=1.0, label=run.name, **look)
    if len(runs) == 1 and runs[0].cycle.cycles:
        cycle = runs[0].cycle
        flags = (runs[0].time >= cycle.start) & (runs[0].time <= cycle.end)
        for plot in plots[:, 0]:
            shade(plot, runs[0].time, flags)
        plots[0, 0].set_title(_sentence(cycle), loc="left", fontsize=9)
    if flows:
        plots[0, 0].set_ylabel("flow speed\n[m/s]")
        widen(plots[0, 0], np.concatenate([run.flow for run in runs]), 1e-3)
    for plot, axis in zip(plots[int(flows) :, 0], shown, strict=True):
        plot.set_ylabel(label(f"tip {'xyz'[axis]}", "m"))
        widen(plot, np.concatenate([run.tip[:, axis] for run in runs]), 2e-3 * runs[0].length)
    if len(runs) > 1:
        plots[0, 0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=_columns(runs), borderaxespad=0.2)
    plots[-1, 0].set_xlabel(label("time", "s"))
    first, last = min(run.time[0] for run in runs), max(run.time[-1] for run in runs)
    if last > first:
        plots[-1, 0].set_xlim(first, last)
    figure.align_ylabels(plots[:, 0])
    return figure


@styled
def phase(results: Sequence[Result]) -> Figure:
    """Velocity of the tip against its position in the direction of largest motion, and its path.

    The cycles that the numbers stand for are emphasised; of one result the rest of the run is drawn in grey.
    """
    runs = _runs(results)
    leading = max(runs, key=lambda run: run.cycle.amplitude)
    direction, plane = snapped(leading.cycle.direction, ALMOST), leading.plane
    least = 0.05 * leading.length
    ratio = float(np.clip(1.0 / _ratio(plane, np.concatenate([run.tip for run in runs]), least), 0.4, 1.2))
    figure, plots = axes(1, 2, 5.2 + 3.6 * ratio, 4.7, _title(results), width_ratios=(1.25, ratio))
    portrait, path = plots[0]
    for number, run in enumerate(runs):
        colour = COLOURS[number % len(COLOURS)]
        if len(runs) == 1 and run.cycle.cycles:
            place, speed = run.trace(_dense(run))
            portrait.plot(place @ direction, speed @ direction, color=QUIET, lw=0.5, label="whole run")
            path.plot(*plane(place), color=QUIET, lw=0.5)
        place, speed = run.trace(run.settled_time)
        still = run.cycle.kind == "rest"
        whole = "last cycle" if run.cycle.cycles == 1 else f"last {run.cycle.cycles} cycles"
        text = run.name if len(runs) > 1 else whole if run.cycle.cycles else "run"
        look = {"color": colour, "lw": 1.6 if run.cycle.cycles else 0.9} | _marker(run)
        portrait.plot(place @ direction, speed @ direction, label=text, **look)
        path.plot(*plane(place), **look)
        if still or not run.cycle.cycles:
            words = "at rest" if still and len(runs) == 1 else "end" if len(runs) == 1 else None
            dot = {"ls": "", "marker": "o", "ms": 6, "color": colour}
            portrait.plot(run.tip[-1:] @ direction, run.tip_velocity[-1:] @ direction, label=words, **dot)
            path.plot(*plane(run.tip[-1:]), **dot)
    along = name_of(direction)
    portrait.set_xlabel(label(f"tip {along}", "m"))
    portrait.set_ylabel(label(f"tip velocity {along}", "m/s"))
    portrait.set_title("Phase portrait")
    path.set_title("Path of the tip")
    _equal(path, plane, np.concatenate([run.tip for run in runs]), least)
    _room(portrait, np.concatenate([run.tip @ direction for run in runs]), 2e-3 * leading.length)
    figure.legend(*portrait.get_legend_handles_labels(), loc="outside lower center", ncols=_columns(runs))
    return figure


@styled
def shape(results: Sequence[Result]) -> Figure:
    """The hose at frames of the last cycle, coloured by time; of a run without a cycle, at frames of all of it."""
    runs = _runs(results)
    cyclic = all(run.cycle.cycles for run in runs)
    fans = [_fan(run) for run in runs]
    # Hoses of one plane share their limits, so that amplitudes compare at a glance.
    alike = all(np.allclose(np.array(run.plane), np.array(runs[0].plane)) for run in runs)
    extents = [np.concatenate([fan.curves.reshape(-1, 3), fan.path]) for fan in fans]
    if alike:
        extents = [np.concatenate(extents)] * len(runs)
    columns = min(len(runs), 3)
    rows, width = -(-len(runs) // columns), 6.0 if columns == 1 else 3.6
    least = 0.2 * runs[0].length
    ratio = max(_ratio(run.plane, points, least) for run, points in zip(runs, extents, strict=True))
    height = min(max(width * ratio, 1.0), 2.0 * width) + 0.9
    figure, plots = axes(rows, columns, width * columns + 1.0, height * rows + 1.2, _title(results))
    for plot, run, fan, extent in zip(plots.flat, runs, fans, extents, strict=False):
        for share, curve in zip(fan.share, fan.curves, strict=True):
            plot.plot(*run.plane(curve), color=SHADES(share), lw=1.2)
        plot.plot(*run.plane(fan.path), color="black", lw=0.8, ls=":")
        plot.plot(*run.plane(fan.curves[0, :1]), color="black", marker="s", ms=6, ls="")
        _equal(plot, run.plane, extent, least)
        if len(runs) > 1:
            plot.set_title(run.name, fontsize=10)
    for plot in plots.flat[len(runs) :]:
        plot.set_axis_off()
    if all(len(run.time) == 1 for run in runs):
        return figure
    colours = matplotlib.cm.ScalarMappable(Normalize(0.0, 1.0), SHADES)
    bar = figure.colorbar(colours, ax=plots, location="bottom", shrink=0.6, aspect=40, pad=0.04)
    span = "last cycle" if cyclic else "run"
    if len(runs) == 1:
        duration = runs[0].cycle.period if cyclic else runs[0].time[-1] - runs[0].time[0]
        span += f", {1e3 * duration:.4g} ms" if duration < 1.0 else f", {duration:.4g} s"
    bar.set_label(f"time as a share of the {span} [–]")
    return figure


class _Fan(NamedTuple):
    """Shapes of a hose, when they were, and the way of its tip."""

    share: np.ndarray
    curves: np.ndarray
    path: np.ndarray


def _fan(run: _Run) -> _Fan:
    """Shapes of the last cycle, (frames, points, 3); of the whole run where there is none."""
    start, end = run.cycle.crossings[-2:] if run.cycle.cycles else (run.time[0], run.time[-1])
    chosen = spread(run.time, start, end, SHAPES)
    share = (run.time[chosen] - start) / (end - start) if end > start else np.zeros(len(chosen))
    curves = shape_of(run.position[chosen], run.result["slope"][chosen], run.arc_length)
    return _Fan(share, curves, run.trace(np.linspace(start, end, 400))[0] if end > start else run.tip[-1:])


@styled
def spectra(results: Sequence[Result]) -> Figure:
    """Amplitude spectrum of the tip in its direction of largest motion, over the last cycles, or the second half."""
    runs = _runs(results)
    figure, plots = axes(1, 1, 8.0, 4.4, _title(results))
    plot = plots[0, 0]
    highest, widest = 0.0, 0.0
    for number, run in enumerate(runs):
        cycle = run.cycle
        start = min(cycle.start, run.time[-1] - 0.5 * (run.time[-1] - run.time[0]))
        late = run.time >= start
        frequency, amplitude = spectrum(run.time[late], run.tip[late] @ cycle.direction)
        if not np.any(amplitude > FLAT * run.length):
            continue
        found = f"{cycle.frequency:.4g} Hz, amplitude {cycle.amplitude:.3g} m" if cycle.cycles else cycle.kind
        text = f"{run.name}: {found}" if len(runs) > 1 else found
        colour = COLOURS[number % len(COLOURS)]
        plot.semilogy(frequency[1:], amplitude[1:], color=colour, label=text, lw=1.1)
        if cycle.cycles:
            plot.plot(cycle.frequency, cycle.amplitude, color=colour, marker="v", ls="", ms=7, clip_on=False)
        highest = max(highest, float(amplitude.max()), cycle.amplitude)
        widest = max(widest, min(float(frequency[-1]), HARMONICS * cycle.frequency or float(frequency[-1])))
    if highest > 0.0:
        plot.set_ylim(highest * 10.0**-DECADES, 3.0 * highest)
        plot.set_xlim(0.0, widest)
        plot.legend(loc="upper right", ncols=1, frameon=True, framealpha=0.9, edgecolor="none")
    else:
        plot.text(0.5, 0.5, "no motion", transform=plot.transAxes, ha="center", color=QUIET)
    plot.set_xlabel(label("frequency", "Hz"))
    plot.set_ylabel(label("amplitude of the tip", "m"))
    return figure


@styled
def ramp(results: Sequence[Result]) -> Figure:
    """Extremes of the tip, and its amplitude, against the flow speed at the time: where the motion begins."""
    runs = _runs(results)
    leading = max(runs, key=lambda run: run.cycle.amplitude)
    direction = snapped(leading.cycle.direction, ALMOST)
    figure, plots = axes(2, 1, 8.0, 6.4, _title(results), sharex=True, height_ratios=(1.3, 1.0))
    place, size = plots[:, 0]
    for number, run in enumerate(runs):
        colour = COLOURS[number % len(COLOURS)]
        dense = _dense(run)
        along = run.trace(dense)[0] @ direction
        text = "tip" if len(runs) == 1 else None
        place.plot(np.interp(dense, run.time, run.flow), along, color=QUIET, lw=0.5, label=text, **_marker(run))
        turns = swings(run.time, run.tip @ direction, run.tip_velocity @ direction)
        if len(turns.time) < 2:
            continue
        middle, amplitude = 0.5 * (turns.time[1:] + turns.time[:-1]), 0.5 * np.abs(np.diff(turns.value))
        for plot, time, values in ((place, turns.time, turns.value), (size, middle, amplitude)):
            flow = np.interp(time, run.time, run.flow)
            falls = np.interp(time, run.time, np.gradient(np.abs(run.flow), run.time)) < -1e-9 * np.abs(run.flow).max()
            for chosen, filled, way in ((~falls, colour, "rising"), (falls, "white", "falling")):
                if not chosen.any():
                    continue
                words = f"extremes, speed {way}" if falls.any() else "extremes"
                words = words if len(runs) == 1 else f"{run.name}, speed {way}" if falls.any() else run.name
                look = {"ls": "", "marker": "o", "ms": 3.5, "mfc": filled, "mec": colour, "mew": 0.8}
                plot.plot(flow[chosen], values[chosen], label=words, **look)
        onset = _onset(np.interp(middle, run.time, run.flow), amplitude, ONSET * run.length)
        if onset is not None:
            place.axvline(onset, color=colour, lw=0.9, ls="--")
            size.axvline(
                onset, color=colour, lw=0.9, ls="--", label=f"{100 * ONSET:g} % of the length at {onset:.3g} m/s"
            )
    place.set_ylabel(label(f"tip {name_of(direction)}", "m"))
    size.set_ylabel(label("amplitude of a swing", "m"))
    size.set_xlabel(label("flow speed", "m/s"))
    flows = np.concatenate([run.flow for run in runs])
    room = 0.02 * float(np.ptp(flows)) if np.ptp(flows) > 1e-9 else 0.5
    size.set_xlim(flows.min() - room, flows.max() + room)
    widen(place, np.concatenate([run.tip @ direction for run in runs]), 2e-3 * leading.length)
    size.set_ylim(0.0, max(size.get_ylim()[1], 2e-3 * leading.length) if size.get_lines() else 1.0)
    place.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=_columns(runs), borderaxespad=0.2)
    lines = [line for line in size.get_lines() if not line.get_label().startswith("_") and line.get_ls() == "--"]
    if lines:
        size.legend(handles=lines, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
    figure.align_ylabels(plots[:, 0])
    return figure


_DRAWN: Mapping[str, Callable[[Sequence[Result]], Figure]] = {
    "tip": tip,
    "phase": phase,
    "shape": shape,
    "spectrum": spectra,
    "ramp": ramp,
}


def draw(results: Sequence[Result], what: Sequence[str] = ()) -> dict[str, Figure]:
    """Draw figures.

    Parameters
    ----------
    results : sequence of Result
        At least one.
    what : sequence of str
        Names out of `FIGURES`; ``overview``, and nothing, stand for several.

    Returns
    -------
    dict of str to Figure
        By name.

    Raises
    ------
    ResultError
        If a name is unknown, or a result lacks what a figure shows.
    """
    names: list[str] = []
    for name in what or ("overview",):
        if name not in FIGURES:
            known = "; ".join(f"{key} ({text})" for key, text in FIGURES.items())
            raise ResultError("--what", f"there is no figure '{name}'", f"known: {known}")
        if name != "overview":
            names.append(name)
            continue
        names += ["tip", "phase", "shape"]
        if any(run.ramped for run in _runs(results)):
            names.append("ramp")
    return {name: _DRAWN[name](results) for name in dict.fromkeys(names)}


def figures(
    results: Sequence[Result],
    folder: Path,
    what: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    stem: str | None = None,
) -> list[Path]:
    """Draw figures into files, as the verb ``plot`` asks for; see `tautline.cli.application.Application.figures`."""
    base = stem or (_stem(results[0]) if len(results) == 1 else "comparison")
    return save_all(draw(results, what), Path(folder), base, formats, whole=stem is not None)


@styled
def static_figure(
    speed: np.ndarray, shapes: Sequence[np.ndarray], tips: np.ndarray, title: str = "Static shapes"
) -> Figure:
    """The hose at rest at several flow speeds, as Fig. 2.28 of the thesis, and where its tip goes.

    Parameters
    ----------
    speed : (k,) array
        m/s.
    shapes : list of k (m, 3) arrays
        Points along the hose from root to tip, m.
    tips : (k, 3) array
        m.
    title : str
        Heading.
    """
    speed, tips = np.asarray(speed, float), np.asarray(tips, float)
    points = np.concatenate([np.asarray(shape) for shape in shapes])
    plane = plane_of(points, towards=(tips - np.array([shape[0] for shape in shapes])).mean(axis=0))
    length = max(float(np.linalg.norm(np.diff(shape, axis=0), axis=1).sum()) for shape in shapes)
    ratio = _ratio(plane, points, 0.2 * length)
    figure, plots = axes(1, 2, 10.0, min(max(5.2 * ratio, 2.6), 7.0) + 1.4, title, width_ratios=(1.5, 1.0))
    left, right = plots[0]
    span = float(np.ptp(speed)) or 1.0
    few = len(speed) <= MOST_NAMED
    for value, shape in zip(speed, shapes, strict=True):
        colour = SHADES((value - speed.min()) / span)
        left.plot(*plane(np.asarray(shape)), color=colour, label=f"{value:g} m/s" if few else None)
    left.plot(*plane(points[:1]), color="black", marker="s", ms=6, ls="")
    left.plot(*plane(tips), color="black", lw=0.8, ls=":", marker="o", ms=3)
    _equal(left, plane, points, 0.2 * length)
    left.set_title("Shape")
    for number, direction in enumerate(plane):
        look = {"color": COLOURS[number], "marker": "o", "ms": 3.5}
        right.plot(speed, tips @ direction, label=name_of(direction), **look)
    widen(right, tips @ np.array(plane).T, 2e-3 * length)
    right.set_xlabel(label("flow speed", "m/s"))
    right.set_ylabel(label("tip", "m"))
    right.set_title("Tip")
    right.legend(loc="lower left", bbox_to_anchor=(0.3, 1.0), ncols=2, borderaxespad=0.2)
    if few:
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower left", ncols=6)
    else:
        colours = matplotlib.cm.ScalarMappable(Normalize(speed.min(), speed.max()), SHADES)
        figure.colorbar(colours, ax=left, location="bottom", shrink=0.8, aspect=40).set_label("flow speed [m/s]")
    return figure


@styled
def flutter_figure(
    speed: np.ndarray,
    eigenvalues: np.ndarray,
    out_of_plane: np.ndarray,
    critical_speed: float | None = None,
    critical_frequency: float | None = None,
    title: str = "Stability",
) -> Figure:
    """Argand diagram and growth rates of a hose's modes against flow speed.

    The diagram is that of the literature: a motion goes with exp(i omega t), omega = -i lambda, Re(omega) stands to the
    right and Im(omega) up, so that what is below the horizontal axis grows; numbers along the curves are speeds. Modes
    in the plane that the hose hangs in are solid, those out of it dashed.

    Parameters
    ----------
    speed : (k,) array
        Rising, m/s.
    eigenvalues : (k, modes) array of complex
        lambda of motions exp(lambda t), 1/s; one column a mode, followed from speed to speed; not finite where it is
        not known. Of a conjugate pair either will do.
    out_of_plane : (k, modes) array
        Bool, or share of the mode that is out of the plane.
    critical_speed, critical_frequency : float, optional
        Where the hose begins to flutter, m/s and Hz.
    title : str
        Heading.
    """
    speed, eigenvalues = np.asarray(speed, float), np.asarray(eigenvalues, complex)
    outside = np.broadcast_to(np.asarray(out_of_plane, float) > 0.5, eigenvalues.shape)
    frequency, damping = np.abs(eigenvalues.imag), -eigenvalues.real
    figure, plots = axes(1, 2, 11.0, 5.4, title, width_ratios=(1.15, 1.0))
    argand, growth = plots[0]
    known = np.isfinite(frequency) & np.isfinite(damping)
    wide = float(frequency[known].max(initial=0.0)) or 1.0
    unstable = float(-damping[known].min(initial=0.0))
    # Strong damping takes high modes far up, where nothing happens: the picture is as high as it is wide.
    argand.set_xlim(-0.03 * wide, 1.08 * wide)
    top = min(float(damping[known].max(initial=0.0)), wide)
    low = -max(1.25 * unstable, 0.15 * max(top, unstable, 1e-9))
    argand.set_ylim(low, 1.08 * max(top, unstable, 1e-9))
    argand.axhspan(low, 0.0, color=SHADE, lw=0, zorder=0)
    argand.text(0.99, 0.015, "unstable", transform=argand.transAxes, ha="right", fontsize=9, color=QUIET)
    for plot in (argand, growth):
        plot.axhline(0.0, color="black", lw=0.8)
    number = _numbers(frequency, outside)
    colours = [COLOURS[i % len(COLOURS)] for i in number]
    for mode in range(eigenvalues.shape[1]):
        for chosen, style in ((~outside[:, mode], "-"), (outside[:, mode], "--")):
            if not (chosen & known[:, mode]).any():
                continue
            look = {"color": colours[mode], "ls": style}
            # A mode that turns out of the plane keeps its line whole: the point before it belongs to both.
            chosen = chosen & known[:, mode]
            chosen = chosen | (np.append(chosen[1:], False) & known[:, mode])
            right, up = (np.where(chosen, values[:, mode], np.nan) for values in (frequency, damping))
            argand.plot(right, up, **look)
            growth.plot(speed, -up, **look)
    _label_speeds(argand, speed, frequency, damping, colours)
    if critical_speed is not None:
        at = (f"{critical_speed:.4g} m/s", "" if critical_frequency is None else f", {critical_frequency:.3g} Hz")
        dot = {"ls": "", "marker": "o", "ms": 8, "mfc": "none", "mec": "black", "mew": 1.4, "zorder": 5}
        growth.plot(critical_speed, 0.0, label="critical: " + "".join(at), **dot)
        if critical_frequency is not None:
            argand.plot(2.0 * np.pi * critical_frequency, 0.0, **dot)
    argand.set_xlabel(label("Re ω, frequency", "rad/s"))
    argand.set_ylabel(label("Im ω, damping", "1/s"))
    argand.set_title("Argand diagram, flow speed in m/s")
    growth.set_xlabel(label("flow speed", "m/s"))
    growth.set_ylabel(label("growth rate", "1/s"))
    growth.set_title("Growth rate")
    if len(speed) > 1:
        growth.set_xlim(speed.min(), speed.max())
    growth.set_ylim(-1.08 * max(top, unstable, 1e-9), -low)
    handles, _ = growth.get_legend_handles_labels()
    both = [Line2D([], [], color="black", ls=style, label=text) for style, text in STYLES.items()]
    present = both if outside[known].any() else []
    modes = [
        Line2D([], [], color=COLOURS[i], label=f"mode {i + 1}") for i in range(min(number.max() + 1, len(COLOURS)))
    ]
    figure.legend(handles=modes + present + handles, loc="outside lower center", ncols=7)
    return figure


def _numbers(frequency: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Number of each mode (k, modes), from 0, by frequency at the first speed among those in or out of the plane.

    A mode in the plane and its like out of it so have one colour.
    """
    first = np.where(np.isfinite(frequency[0]), frequency[0], np.inf)
    order = np.argsort(first, kind="stable")
    numbers = np.zeros(len(first), int)
    for kind in (False, True):
        alike = order[outside[0, order] == kind]
        numbers[alike] = np.arange(len(alike))
    return numbers


def _label_speeds(plot: Axes, speed: np.ndarray, right: np.ndarray, up: np.ndarray, colours: Sequence[str]) -> None:
    """Mark round speeds along the curves (k, modes), and write those that find room."""
    ticks = MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(speed.min(), speed.max())
    marks = [value for value in ticks if speed.min() - 1e-9 <= value <= speed.max() + 1e-9]
    plot.figure.draw_without_rendering()
    (left, end), (low, high) = plot.get_xlim(), plot.get_ylim()
    box = plot.get_window_extent()
    x, y = (np.array([np.interp(marks, speed, curve) for curve in values.T]) for values in (right, up))
    inside = np.isfinite(x) & np.isfinite(y) & (left <= x) & (x <= end) & (low <= y) & (y <= high)
    # Places in points, in which sizes of letters are told too.
    point = plot.figure.dpi / 72.0
    across, height = (x - left) / (end - left) * box.width / point, (y - low) / (high - low) * box.height / point
    dots = np.column_stack([across[inside], height[inside]])
    taken: list[np.ndarray] = []
    named: list[tuple[int, np.ndarray]] = []
    for mode in np.argsort(np.where(np.isfinite(right[0]), right[0], np.inf), kind="stable"):
        for i in np.flatnonzero(inside[mode]):
            plot.plot(x[mode, i], y[mode, i], color=colours[mode], marker="o", ms=3, ls="")
            dot, words = np.array([across[mode, i], height[mode, i]]), f"{marks[i]:g}"
            # A mode out of the plane that runs along its like in it needs no numbers of its own.
            if any(i == j and np.hypot(*(dot - place)) < 22.0 for j, place in named):
                continue
            size = np.array([5.2 * len(words), 8.0])
            for corner in ((5.0, 2.0), (5.0, -10.0), (-5.0 - size[0], 2.0), (-5.0 - size[0], -10.0)):
                centre = dot + corner + 0.5 * size
                others = dots[np.abs(dots - dot).max(axis=1) > 1e-9]
                hit = np.any(np.all(np.abs(others - centre) < 0.5 * size + 2.0, axis=1))
                if hit or centre[0] < 0.5 * size[0] or any(np.all(np.abs(centre - t) < size + 1.0) for t in taken):
                    continue
                taken.append(centre)
                named.append((int(i), dot))
                text = plot.annotate(words, (x[mode, i], y[mode, i]), corner, textcoords="offset points", fontsize=8)
                text.set(color=colours[mode], path_effects=[withStroke(linewidth=2.0, foreground="white")])
                break


@styled
def boundary_figure(
    beta: np.ndarray,
    u: np.ndarray,
    published: tuple[np.ndarray, np.ndarray] | None = None,
    published_label: str = "published",
    computed_label: str = "computed",
    title: str = "Stability boundary",
    xlabel: str = "mass ratio β = M/(M + m) [–]",
    ylabel: str = "critical flow speed u = U L √(M/EJ) [–]",
) -> Figure:
    """Critical flow speed against the mass ratio, both without dimension, beside a published curve.

    Parameters
    ----------
    beta, u : (k,) array
        Ours, drawn as dots; several u at one beta are fine, as where the boundary is S-shaped.
    published : ((n,) array, (n,) array), optional
        beta and u along a curve, in the order in which to join them.
    published_label, computed_label, title, xlabel, ylabel : str
        Words in the figure.
    """
    figure, plots = axes(1, 1, 7.2, 5.0, title)
    plot = plots[0, 0]
    if published is not None:
        plot.plot(*published, color=QUIET, lw=1.8, label=published_label)
    plot.plot(beta, u, color=COLOURS[0], marker="o", ms=4.5, ls="", label=computed_label)
    plot.set_xlim(0.0, 1.0 if np.max(beta) > 0.85 else 1.05 * float(np.max(beta)))
    plot.set_ylim(0.0, 1.08 * max(float(np.max(u)), 0.0 if published is None else float(np.max(published[1]))))
    plot.text(0.97, 0.06, "stable", transform=plot.transAxes, ha="right", color=QUIET)
    plot.text(0.03, 0.93, "flutter", transform=plot.transAxes, ha="left", color=QUIET)
    plot.set_xlabel(xlabel)
    plot.set_ylabel(ylabel)
    plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)
    return figure


def _onset(flow: np.ndarray, amplitude: np.ndarray, least: float) -> float | None:
    """Speed of the first swing from which on, up to the largest, all are at least `least`; None if there is none."""
    largest = int(amplitude.argmax())
    below = np.flatnonzero(amplitude[:largest] < least)
    if below.size == 0 or amplitude[largest] < least:
        return None
    return float(flow[below[-1] + 1])


def _runs(results: Sequence[Result]) -> list[_Run]:
    return [_Run(result, name) for result, name in zip(results, _names(results), strict=True)]


def _stem(result: Result) -> str:
    return result.path.stem if result.path is not None else "result"


def _names(results: Sequence[Result]) -> list[str]:
    """Names for a legend: the titles if they tell the results apart, else files, folders and files, or numbers too."""
    stems = [_stem(result) for result in results]
    titles = [str(result.attributes.get("title") or "") for result in results]
    folders = [result.path.absolute().parent.name if result.path else "" for result in results]
    placed = [f"{folder}/{stem}" for folder, stem in zip(folders, stems, strict=True)]
    numbered = [f"{number + 1}: {stem}" for number, stem in enumerate(stems)]
    for names in (titles, stems, placed, numbered):
        if all(names) and len(set(names)) == len(names):
            return [name if len(name) <= LONGEST_NAME else "…" + name[1 - LONGEST_NAME :] for name in names]
    return numbered


def _title(results: Sequence[Result]) -> str:
    if len(results) > 1:
        return "Comparison of results"
    return str(results[0].attributes.get("title") or _stem(results[0]))


def _sentence(cycle: LimitCycle) -> str:
    """What was found, in one line."""
    span = f"shaded: {cycle.kind}" if cycle.cycles == 1 else f"shaded, {cycle.cycles} cycles: {cycle.kind}"
    return f"{span}, {cycle.frequency:.4g} Hz, amplitude {cycle.amplitude:.3g} m"


def _columns(runs: Sequence[_Run]) -> int:
    return max(1, min(5, 80 // (max(len(run.name) for run in runs) + 6)))


def _marker(run: _Run) -> dict[str, str]:
    """A run of one frame is a dot: a line through one point would be invisible."""
    return {"marker": "o"} if len(run.time) == 1 else {}


def _dense(run: _Run) -> np.ndarray:
    """Times of the frames and between them, so that few frames a period still draw round curves."""
    frames = len(run.time)
    return np.interp(np.arange(SPREAD * (frames - 1) + 1) / SPREAD, np.arange(frames), run.time)


def _ratio(plane: Plane, points: np.ndarray, least: float) -> float:
    """Height over width of what `_equal` shows of points (n, 3)."""
    wide, high = (max(float(np.ptp(values)), least) for values in plane(points))
    return high / wide


def _equal(plot: Axes, plane: Plane, points: np.ndarray, least: float) -> None:
    """Same scale both ways, round points (n, 3), at least `least` m each way; labels with the axes' names."""
    plot.set_aspect("equal", adjustable="box")
    for values, limit in zip(plane(points), (plot.set_xlim, plot.set_ylim), strict=True):
        middle, size = 0.5 * (values.min() + values.max()), max(float(np.ptp(values)), least)
        limit(middle - 0.55 * size, middle + 0.55 * size)
    (left, right), (bottom, top) = plot.get_xlim(), plot.get_ylim()
    plot.locator_params(axis="x", nbins=int(np.clip(6.0 * (right - left) / (top - bottom), 2, 6)))
    plot.set_xlabel(label(name_of(plane.across), "m"))
    plot.set_ylabel(label(name_of(plane.up), "m"))


def _room(plot: Axes, values: np.ndarray, least: float) -> None:
    """Keep the horizontal axis from blowing rounding up."""
    if np.ptp(values) < least:
        middle = 0.5 * float(values.min() + values.max())
        plot.set_xlim(middle - 0.55 * least, middle + 0.55 * least)
