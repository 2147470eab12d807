"""Figures of hoses conveying fluid.

`figures` draws results, as the verb ``plot`` asks for, from the stored variables alone. What the other verbs find is
drawn by `gardenhose.view.stability_figures`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gardenhose.motion.curves import directions, name_of, shape_of, snapped, spread
from gardenhose.motion.cycles import swings
from gardenhose.motion.limit_cycle import LimitCycle
from gardenhose.motion.run import Run
from gardenhose.view.stability_figures import flutter_figure as flutter_figure
from gardenhose.view.stability_figures import show_in_plane
from gardenhose.view.stability_figures import static_figure as static_figure
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, names, one_kind, over_time, title_of_runs
from tautline.view.figures.drawings import Drawing, drawn, writing
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    SHADES,
    Axes,
    Figure,
    axes,
    bar_of_shades,
    height_over_width,
    label,
    legend_above,
    shade,
    styled,
    widen,
)
from tautline.view.figures.histories import energies
from tautline.view.figures.spectrum import spectrum
from tautline.view.figures.waterfall import waterfall_figure

SHAPES = 24
"""Most shapes of the hose in one picture."""
ONSET = 0.01
"""Amplitude over the hose's length that the figure of a ramp marks."""
DRIFT = 5.0
"""Times the usual duration of a swing from which on a change is none."""
SAME_FLOW = 1e-9
"""Share of the largest flow speed by which one speed may change."""
SLIM = 5.0
"""Length over width of a motion from which on its width is drawn larger."""
STRETCHED = 1.25
"""Length over width that such a motion has as it is drawn, at least."""
NO_MOTION = 1e-5
"""Share of the hose's length below which a width is rounding."""
ALMOST = 0.15
"""How far a unit vector may be from an axis that figures take in its place."""
HARMONICS = 8
"""Times the frequency to which a spectrum reaches."""
FLAT = 1e-14
"""Share of the hose's length below which a line of a spectrum is rounding."""
DECADES = 6
"""That a spectrum shows."""


@styled
def tip(runs: Sequence[Run]) -> Figure:
    """Flow speed and the tip's coordinates against time; several results are overlaid."""
    moves = np.array([np.ptp(run.tip, axis=0) for run in runs]).max(axis=0)
    shown = [axis for axis in range(3) if moves[axis] > 1e-6 * max(run.length for run in runs)] or [2]
    flows = any(np.any(run.flow) for run in runs)
    rows = len(shown) + flows
    figure, plots = axes(
        rows,
        1,
        8.0,
        1.9 * rows + 1.0,
        title_of_runs(runs),
        sharex=True,
        height_ratios=[0.7] * flows + [1.0] * len(shown),
    )
    for number, run in enumerate(runs):
        look = {"color": COLOURS[number % len(COLOURS)]} | marker(run.time)
        if flows:
            plots[0, 0].plot(run.time, run.flow, label=run.name, **look)
        for plot, axis in zip(plots[int(flows) :, 0], shown, strict=True):
            dense = run.dense
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
        legend_above(plots[0, 0])
    return over_time(figure, plots, [run.time for run in runs])


@styled
def phase(runs: Sequence[Run]) -> Figure:
    """Velocity of the tip against its position in the direction of largest motion, and its path.

    The cycles that the numbers stand for are emphasised; of one result the rest of the run is drawn in grey.
    """
    leading = max(runs, key=lambda run: run.cycle.amplitude)
    direction, plane = snapped(leading.cycle.direction, ALMOST), leading.plane
    least = 0.05 * leading.length
    ratio = float(np.clip(1.0 / height_over_width(*plane(np.concatenate([run.tip for run in runs])), least), 0.4, 1.2))
    figure, plots = axes(1, 2, 5.2 + 3.6 * ratio, 4.7, title_of_runs(runs), width_ratios=(1.25, ratio))
    portrait, path = plots[0]
    for number, run in enumerate(runs):
        colour = COLOURS[number % len(COLOURS)]
        if len(runs) == 1 and run.cycle.cycles:
            place, speed = run.trace(run.dense)
            portrait.plot(place @ direction, speed @ direction, color=QUIET, lw=0.5, label="whole run")
            path.plot(*plane(place), color=QUIET, lw=0.5)
        place, speed = run.trace(run.settled_time)
        still = run.cycle.kind == "rest"
        whole = "last cycle" if run.cycle.cycles == 1 else f"last {run.cycle.cycles} cycles"
        text = run.name if len(runs) > 1 else whole if run.cycle.cycles else "run"
        look = {"color": colour, "lw": 1.6 if run.cycle.cycles else 0.9} | marker(run.time)
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
    show_in_plane(path, plane, np.concatenate([run.tip for run in runs]), least)
    _keep_least_span(portrait, np.concatenate([run.tip @ direction for run in runs]), 2e-3 * leading.length)
    figure.legend(*portrait.get_legend_handles_labels(), loc="outside lower center", ncols=_columns(runs))
    return figure


@styled
def shape(runs: Sequence[Run]) -> Figure:
    """The hose at frames of the last cycle, coloured by time; of a run without a cycle, at frames of all of it."""
    cyclic = all(run.cycle.cycles for run in runs)
    fans = [_fan(run) for run in runs]
    # Hoses of one plane share their limits, so that amplitudes compare at a glance.
    alike = all(np.allclose(np.array(run.plane), np.array(runs[0].plane)) for run in runs)
    extents = [np.concatenate([fan.curves.reshape(-1, 3), fan.path]) for fan in fans]
    ways = {_slim(*run.plane(points)) for run, points in zip(runs, extents, strict=True)}
    if alike:
        extents = [np.concatenate(extents)] * len(runs)
    columns = min(len(runs), 3)
    rows, width = -(-len(runs) // columns), 6.0 if columns == 1 else 3.6
    least = 0.2 * runs[0].length
    seen = [run.plane(points) for run, points in zip(runs, extents, strict=True)]
    # What is slim beside a longer hose only is drawn as it is: larger, it would be flattened.
    enlarged = alike and ways in ({"wide"}, {"high"})
    larger = [_enlargement(*points, NO_MOTION * runs[0].length) if enlarged else (1.0, 1.0) for points in seen]
    ratio = max(height_over_width(x * across, y * up, least) for (x, y), (across, up) in zip(seen, larger, strict=True))
    height = min(max(width * ratio, 1.0), 2.0 * width) + 0.9
    figure, plots = axes(rows, columns, width * columns + 1.0, height * rows + 1.2, title_of_runs(runs))
    for plot, run, fan, extent, factors in zip(plots.flat, runs, fans, extents, larger, strict=False):
        for share, curve in zip(fan.share, fan.curves, strict=True):
            plot.plot(*run.plane(curve), color=SHADES(share), lw=1.2)
        plot.plot(*run.plane(fan.path), color="black", lw=0.8, ls=":")
        plot.plot(*run.plane(fan.curves[0, :1]), color="black", marker="s", ms=6, ls="")
        show_in_plane(plot, run.plane, extent, least, factors)
        if len(runs) > 1:
            plot.set_title(run.name, fontsize=10)
    for plot in plots.flat[len(runs) :]:
        plot.set_axis_off()
    if all(len(run.time) == 1 for run in runs):
        return figure
    span = "last cycle" if cyclic else "run"
    if len(runs) == 1:
        duration = runs[0].cycle.period if cyclic else runs[0].time[-1] - runs[0].time[0]
        span += f", {1e3 * duration:.4g} ms" if duration < 1.0 else f", {duration:.4g} s"
    bar_of_shades(figure, plots, 0.0, 1.0, f"time as a share of the {span} [–]", shrink=0.6, pad=0.04)
    return figure


def _slim(x: np.ndarray, y: np.ndarray) -> str:
    """Which way a motion is so much longer than the other that it is seen as a line: wide, high, or neither ("")."""
    wide, high = float(np.ptp(x)), float(np.ptp(y))
    if min(wide, high) * SLIM >= max(wide, high):
        return ""
    return "wide" if wide > high else "high"


def _enlargement(x: np.ndarray, y: np.ndarray, rounding: float) -> tuple[float, float]:
    """How many times larger than the other way each is drawn, round numbers: a slim motion would be seen as a line."""
    wide, high = float(np.ptp(x)), float(np.ptp(y))
    if not _slim(x, y) or min(wide, high) <= rounding:
        return 1.0, 1.0
    wanted = max(wide, high) / min(wide, high) / STRETCHED
    power = 10.0 ** np.floor(np.log10(wanted))
    factor = float(power * np.floor(wanted / power))
    return (factor, 1.0) if wide < high else (1.0, factor)


class _Fan(NamedTuple):
    """Shapes of a hose, when they were, and the path of its tip."""

    share: np.ndarray
    curves: np.ndarray
    path: np.ndarray


def _fan(run: Run) -> _Fan:
    """Shapes of the last cycle, (frames, points, 3); of the whole run where there is none."""
    start, end = run.cycle.crossings[-2:] if run.cycle.cycles else (run.time[0], run.time[-1])
    chosen = spread(run.time, start, end, SHAPES)
    share = (run.time[chosen] - start) / (end - start) if end > start else np.zeros(len(chosen))
    curves = shape_of(run.position[chosen], run.result["slope"][chosen], run.arc_length)
    return _Fan(share, curves, run.trace(np.linspace(start, end, 400))[0] if end > start else run.tip[-1:])


@styled
def spectra(runs: Sequence[Run]) -> Figure:
    """Amplitude spectrum of the tip in its direction of largest motion, over the last cycles, or the second half."""
    figure, plots = axes(1, 1, 8.0, 4.4, title_of_runs(runs))
    plot = plots[0, 0]
    highest, widest, parts = 0.0, 0.0, set[str]()
    for number, run in enumerate(runs):
        cycle = run.cycle
        start = min(cycle.start, run.time[-1] - 0.5 * (run.time[-1] - run.time[0]))
        late = run.time >= start
        parts.add(f"{run.time[late][0]:.4g} to {run.time[-1]:.4g} s")
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
    plot.set_title(f"spectrum of {parts.pop() if len(parts) == 1 else 'the end of each run'}", fontsize=10)
    plot.set_xlabel(label("frequency", "Hz"))
    plot.set_ylabel(label("amplitude of the tip", "m"))
    return figure


@styled
def ramp(runs: Sequence[Run]) -> Figure:
    """Extremes of the tip, and its amplitude, against the flow speed at the time: where the motion begins."""
    flows = np.concatenate([run.flow for run in runs])
    if np.ptp(flows) <= SAME_FLOW * np.abs(flows).max():
        raise NothingToShow(runs[0].result, "one flow speed all the time: nothing is drawn against it")
    leading = max(runs, key=lambda run: run.cycle.amplitude)
    # Of the whole run: at its end the hose may have come to rest again.
    direction = snapped(directions(leading.tip_velocity)[0], ALMOST)
    figure, plots = axes(2, 1, 8.0, 6.4, title_of_runs(runs), sharex=True, height_ratios=(1.3, 1.0))
    place, size = plots[:, 0]
    for number, run in enumerate(runs):
        colour = COLOURS[number % len(COLOURS)]
        dense = run.dense
        along = run.trace(dense)[0] @ direction
        text = "tip" if len(runs) == 1 else None
        place.plot(np.interp(dense, run.time, run.flow), along, color=QUIET, lw=0.5, label=text, **marker(run.time))
        turns = swings(run.time, run.tip @ direction, run.tip_velocity @ direction)
        if len(turns.time) < 2:
            continue
        middle, amplitude = 0.5 * (turns.time[1:] + turns.time[:-1]), 0.5 * np.abs(np.diff(turns.value))
        # What drifts with the speed is no swing.
        swing = np.diff(turns.time) < DRIFT * np.median(np.diff(turns.time))
        middle, amplitude = middle[swing], amplitude[swing]
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
        flow = np.interp(middle, run.time, run.flow)
        words = f"{100 * ONSET:g} % of the length"
        # Backwards in time, what ceases begins.
        for style, way, text in (("--", 1, f"{words} at"), (":", -1, f"{words} last at")):
            onset = _onset(flow[::way], amplitude[::way], ONSET * run.length)
            if onset is not None:
                place.axvline(onset, color=colour, lw=0.9, ls=style)
                size.axvline(onset, color=colour, lw=0.9, ls=style, label=f"{text} {onset:.3g} m/s")
    place.set_ylabel(label(f"tip {name_of(direction)}", "m"))
    size.set_ylabel(label("amplitude of a swing", "m"))
    size.set_xlabel(label("flow speed", "m/s"))
    margin = 0.02 * float(np.ptp(flows)) if np.ptp(flows) > 1e-9 else 0.5
    size.set_xlim(flows.min() - margin, flows.max() + margin)
    widen(place, np.concatenate([run.tip @ direction for run in runs]), 2e-3 * leading.length)
    size.set_ylim(0.0, max(size.get_ylim()[1], 2e-3 * leading.length) if size.get_lines() else 1.0)
    legend_above(place)
    lines = [line for line in size.get_lines() if line.get_ls() in ("--", ":")]
    if lines:
        size.legend(handles=lines, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
    figure.align_ylabels(plots[:, 0])
    return figure


def waterfall(runs: Sequence[Run], name: str = "axial_force") -> Figure:
    """What runs along the hose, over time and unstretched length from its root."""
    (run,) = runs
    values, variable = run.result[name], run.result.variables[name]
    if variable.dims != ("time", "element"):
        raise ResultError("--what", f"'{name}' has no value for each element", "name axial_force or curvature")
    words = (variable.long_name.split(",")[0], variable.units)
    return waterfall_figure(run.result, values, run.arc_length, words, ("unstretched length from the root", "m"))


DRAWINGS: Mapping[str, Drawing] = {
    "tip": Drawing("flow speed and the tip's coordinates against time", tip, compared=True),
    "phase": Drawing("phase portrait and path of the tip, as Fig. 2.30 of the thesis", phase, compared=True),
    "shape": Drawing("the hose over one cycle at the end of the run", shape, compared=True),
    "ramp": Drawing("extremes and amplitude of the tip's motion against flow speed", ramp, alone=False),
    "spectrum": Drawing("spectrum of the tip's motion at the end of the run", spectra, alone=False),
    "waterfall": Drawing(
        "axial force over time and length; waterfall:curvature another", waterfall, False, False, takes=True
    ),
    "energy": replace(energies("work of the pump and of what moves"), alone=False),
}
FIGURES: Mapping[str, str] = {
    "overview": "tip, phase and shape; ramp too where the flow speed changes",
    **{name: drawing.text for name, drawing in DRAWINGS.items()},
}
"""Names for ``--what``."""


def draw(results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Figure]:
    """Draw figures or variables; see `tautline.view.figures.drawings.drawn`.

    ``overview``, and nothing, stand for several figures.
    """
    one_kind(results)
    runs = [Run(result, name) for result, name in zip(results, names(results), strict=True)]
    whole = ["tip", "phase", "shape", *(["ramp"] if any(run.ramped for run in runs) else [])]
    named = what or (("overview",) if vs is None else ())
    return drawn(results, DRAWINGS, named, vs, lambda _: runs, {"overview": whole})


figures = writing(draw)
"""Draw figures into files, as the verb ``plot`` asks for; see `tautline.application.protocol.Application.figures`."""


def _onset(flow: np.ndarray, amplitude: np.ndarray, least: float) -> float | None:
    """Speed of the first swing from which on, up to the largest, all are at least `least`; None if there is none."""
    largest = int(amplitude.argmax())
    below = np.flatnonzero(amplitude[:largest] < least)
    if below.size == 0 or amplitude[largest] < least:
        return None
    return float(flow[below[-1] + 1])


def _sentence(cycle: LimitCycle) -> str:
    """What was found, in one line."""
    span = f"shaded: {cycle.kind}" if cycle.cycles == 1 else f"shaded, {cycle.cycles} cycles: {cycle.kind}"
    return f"{span}, {cycle.frequency:.4g} Hz, amplitude {cycle.amplitude:.3g} m"


def _columns(runs: Sequence[Run]) -> int:
    return max(1, min(5, 80 // (max(len(run.name) for run in runs) + 6)))


def _keep_least_span(plot: Axes, values: np.ndarray, least: float) -> None:
    """Keep the horizontal axis from blowing rounding up."""
    if np.ptp(values) < least:
        middle = 0.5 * float(values.min() + values.max())
        plot.set_xlim(middle - 0.55 * least, middle + 0.55 * least)
