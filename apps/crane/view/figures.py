"""Figures of cranes: the path of the rope, tensions, the load, winches, sheaves, energies, and what loads the rope.

Histories are drawn from the stored variables alone. The path of the rope and its bending need the scene that the result
carries, and so the files that this names.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crane.results.course import Course, course_of, laid_out, scene_of
from crane.results.summary import ends_of, most_worked_end, span_ends
from crane.scene.scene import CraneScene
from crane.view.path_figure import draw_scene_figure, of_run, path_figure
from crane.view.wear_figures import bending_figure, rainflow_figure
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, names, over_time, title_of_runs
from tautline.view.figures.drawings import Drawing, drawn, writing
from tautline.view.figures.figure import (
    COLOURS,
    QUIET,
    STYLES,
    Axes,
    Figure,
    axes,
    colour,
    label,
    legend_above,
    scale,
    shade,
    shortened,
    styled,
    widen,
)
from tautline.view.figures.histories import Panels, energies, spectrum_figure

MOST_LINES = 6
"""Span ends that are drawn one by one; of more, the two ends of the rope and the range of all."""
CLOSE = 2.0
"""Breaking load over largest tension up to which it is drawn."""
GAPS = (0, (4.0, 4.0))
"""Dashes so far apart that a line below them is seen."""
STILL, LITTLE = 1.0e-6, 1.0e-4
"""Motion of a coordinate that is left out: metres, and as a share of the largest motion."""


class _Run:
    """What the figures need of a result, read once."""

    def __init__(self, result: Result, name: str) -> None:
        self.result, self.name, self.time = result, name, result.time

    @functools.cached_property
    def scene(self) -> CraneScene | None:
        """The scene that it carries; None where that cannot be read."""
        try:
            return scene_of(self.result)
        except ResultError:
            return None

    @functools.cached_property
    def course(self) -> Course:
        """The rope's course; raises ResultError where its scene cannot be read."""
        return course_of(self.result, laid_out(scene_of(self.result)))

    @property
    def ends(self) -> list[str]:
        """Names of the ends of the spans."""
        if self.scene is not None:
            return span_ends(self.scene)
        return [f"{span}, {end}" for span in self.result["span"] for end in ("first", "last")]


def _over_time(figure: Figure, plots: Any, runs: Sequence[_Run]) -> Figure:
    return over_time(figure, plots, [run.time for run in runs])


@styled
def overview(runs: Sequence[_Run]) -> Figure:
    """Largest tension, the first body's height and the first drum's power; several results are overlaid."""
    panels: list[tuple[str, str, list[np.ndarray | None], float]] = [
        ("largest tension", "N", [ends_of(run.result).max(axis=1) for run in runs], 1.0),
        ("height of the load", "m", [_height(run.result) for run in runs], 1e-3),
        ("power of the winch", "W", [_of(run.result, "winch_power") for run in runs], 1.0),
    ]
    panels = [panel for panel in panels if any(values is not None for values in panel[2])]
    figure, plots = axes(len(panels), 1, 8.0, 2.2 * len(panels) + 0.5, title_of_runs(runs), sharex=True)
    for plot, (text, unit, curves, least) in zip(plots[:, 0], panels, strict=True):
        there = [curve for curve in curves if curve is not None]
        factor, unit = scale(there, unit)
        for k, (run, curve) in enumerate(zip(runs, curves, strict=True)):
            if curve is not None:
                words = run.name if len(runs) > 1 and plot is plots[0, 0] else None
                plot.plot(run.time, curve / factor, color=colour(k, len(runs)), label=words, **marker(run.time))
        widen(plot, np.concatenate(there) / factor, least / factor)
        plot.set_ylabel(label(text, unit))
    legend_above(plots[0, 0])
    return _over_time(figure, plots, runs)


def _height(result: Result) -> np.ndarray | None:
    if "body_position" not in result or not result["body_position"].shape[1]:
        return None
    return result["body_position"][:, 0, 2]


def _of(result: Result, name: str) -> np.ndarray | None:
    return result[name][:, 0] if name in result else None


@styled
def path(runs: Sequence[_Run]) -> Figure:
    """The path of the rope at the first and the last frame."""
    (run,) = runs
    course, last = run.course, len(run.time) - 1
    shots = [of_run(run.result, course, 0, f"at {run.time[0]:.4g} s")]
    if last > 0:
        shots.append(of_run(run.result, course, last, f"at {run.time[last]:.4g} s"))
    return path_figure(shots, course.scene, title_of_runs(runs))


@styled
def tension(runs: Sequence[_Run]) -> Figure:
    """Tension at the ends of the spans, shaded where the rope is slack, and the breaking load where it is near.

    Of one result the first frame is dotted, and what leaves a sheave is dashed, for without friction it covers what
    comes to it; of several, both ends of the rope are drawn and the range between.
    """
    every = [ends_of(run.result) for run in runs]
    factor, unit = scale(every, "N")
    figure, plots = axes(1, 1, 8.0, 4.6, title_of_runs(runs))
    plot = plots[0, 0]
    for number, (run, values) in enumerate(zip(runs, every, strict=True)):
        _tensions(plot, run, values / factor, None if len(runs) == 1 else colour(number, len(runs)))
    _breaking_loads(plot, runs, every, factor)
    slack = [np.any(values <= 0.0, axis=1) for values in every]
    for number, (run, flags) in enumerate(zip(runs, slack, strict=True)):
        named = flags.any() and not any(before.any() for before in slack[:number])
        shade(plot, run.time, flags, text="slack" if named else "")
    widen(plot, np.concatenate([values.ravel() for values in every]) / factor, 1.0 / factor)
    if len(runs) == 1 and len(runs[0].time) > 1:
        plot.plot([], [], color=QUIET, lw=1.0, ls=":", label="at the first frame")
    plot.set_ylabel(label("tension", unit))
    legend_above(plot)
    return _over_time(figure, plots, runs)


def _breaking_loads(plot: Axes, runs: Sequence[_Run], every: Sequence[np.ndarray], factor: float) -> None:
    """Draw each breaking load, N, that is near the tensions of a rope that has it; named where ropes differ in it."""
    loads = [None if run.scene is None else run.scene.rope.breaking_load for run in runs]
    for load in dict.fromkeys(loads):
        those = [number for number, own in enumerate(loads) if own == load]
        if load is None or not any(load < CLOSE * float(every[number].max(initial=0.0)) for number in those):
            continue
        ink, words = "black", "breaking load"
        if len(those) < len(runs):
            ink = colour(those[0], len(runs))
            words = f"{', '.join(runs[number].name for number in those)}, {words}"
        plot.axhline(load / factor, color=ink, lw=1.4, label=words)


def _tensions(plot: Axes, run: _Run, values: np.ndarray, ink: Any) -> None:
    """Draw the tensions of a result: each in a colour, or all in the one that tells it from other results."""
    ends = run.ends
    shown = list(range(values.shape[1]))
    if len(shown) > MOST_LINES or ink is not None:
        band: dict[str, Any] = {
            "color": COLOURS[5] if ink is None else ink,
            "alpha": 0.35 if ink is None else 0.2,
            "lw": 0,
        }
        words = "range over the rope" if ink is None else None
        plot.fill_between(run.time, values.min(axis=1), values.max(axis=1), label=words, **band)
        shown = [0, len(shown) - 1]
    for number, k in enumerate(shown):
        mine = colour(number, max(len(shown), 2)) if ink is None else ink
        words = ends[k] if ink is None else f"{run.name}, {ends[k]}"
        leaves = len(shown) == values.shape[1] and k % 2 == 0 and k > 0
        look = {"color": mine, "lw": 1.1, "ls": (GAPS if leaves else "-") if ink is None else STYLES[number]}
        plot.plot(run.time, values[:, k], label=words, **look, **marker(run.time))
        if ink is None:
            plot.axhline(values[0, k], color=mine, lw=1.0, ls=":")


@styled
def payload(runs: Sequence[_Run]) -> Figure:
    """Coordinates of the bodies; those in which nothing moves are left out."""
    for run in runs:
        if "body_position" not in run.result or not run.result["body_position"].shape[1]:
            raise _lacks(run, "bodies")
    positions = [run.result["body_position"] for run in runs]
    motion = [max(float(np.ptp(position[:, :, c], axis=0).max()) for position in positions) for c in range(3)]
    moving = [c for c in range(3) if motion[c] > max(STILL, LITTLE * max(motion))] or [2]
    figure, plots = axes(len(moving), 1, 8.0, 2.0 * len(moving) + 0.7, title_of_runs(runs), sharex=True)
    for plot, c in zip(plots[:, 0], moving, strict=True):
        for number, (run, position) in enumerate(zip(runs, positions, strict=True)):
            _columns(plot, runs, number, position[:, :, c], [str(name) for name in run.result["body"]])
        widen(plot, np.concatenate([position[:, :, c].ravel() for position in positions]), 1e-3)
        plot.set_ylabel(label("xyz"[c], "m"))
    legend_above(plots[0, 0])
    return _over_time(figure, plots, runs)


def _columns(plot: Axes, runs: Sequence[_Run], number: int, values: np.ndarray, things: Sequence[str]) -> None:
    """Draw (frames, things) values of one of the runs; colours tell runs apart where there are several."""
    run = runs[number]
    for k, name in enumerate(map(shortened, things)):
        if len(runs) == 1:
            look, words = {"color": colour(k, len(things))}, name
        else:
            look = {"color": colour(number, len(runs)), "ls": STYLES[k % len(STYLES)]}
            words = run.name if len(things) == 1 else f"{run.name}, {name}"
        place = plot.get_subplotspec()
        first = place is not None and place.is_first_row()
        plot.plot(run.time, values[:, k], label=words if first else None, **look, **marker(run.time))


@styled
def winch(runs: Sequence[_Run]) -> Figure:
    """Tension, speed and power of the drums, and how much they have paid out; how far the rope has gone round them.

    The last is there where a frame turns a drum under its rope, which takes rope off that it does not pay out.
    """
    for run in runs:
        if "drum_tension" not in run.result:
            raise _lacks(run, "drums")
    panels = [
        ("drum_tension", "tension", "N", 1.0),
        ("pay_out_speed", "speed,\npositive out", "m/s", 1e-3),
        ("paid_out", "paid out", "m", 1e-3),
        ("winch_power", "power,\npositive in", "W", 1.0),
    ]
    if any("lead_angle" in run.result for run in runs):
        panels.insert(3, ("lead_angle", "rope gone round\ndrum, positive off", "rad", 1e-2))
    figure, plots = axes(len(panels), 1, 8.0, 1.85 * len(panels), title_of_runs(runs), sharex=True)
    for plot, (variable, text, unit, least) in zip(plots[:, 0], panels, strict=True):
        # A run in which nothing turns round its drums has no angle of it.
        every = [
            run.result[variable] if variable in run.result else np.zeros_like(run.result["paid_out"]) for run in runs
        ]
        factor, unit = scale(every, unit)
        for number, (run, values) in enumerate(zip(runs, every, strict=True)):
            _columns(plot, runs, number, values / factor, [str(name) for name in run.result["drum"]])
        widen(plot, np.concatenate([values.ravel() for values in every]) / factor, least / factor)
        plot.set_ylabel(label(text, unit))
    legend_above(plots[0, 0])
    return _over_time(figure, plots, runs)


@styled
def sheaves(runs: Sequence[_Run]) -> Figure:
    """Wrap, fleet angle and rotation of the sheaves; shaded while the rope slips on any of them."""
    (run,) = runs
    if "wrap_angle" not in run.result:
        raise _lacks(run, "sheaves")
    result, wheels = run.result, [str(name) for name in run.result["sheave"]]
    panels = (
        (np.degrees(result["wrap_angle"]), "wrap", "deg", 0.1),
        (np.degrees(np.abs(result["fleet_angle"]).max(axis=-1)), "fleet angle,\nlarger side", "deg", 0.1),
        (result["sheave_rotation"] / (2.0 * np.pi), "rotation", "turns", 1e-2),
    )
    slips = result["slipping"] != 0.0
    figure, plots = axes(len(panels), 1, 8.0, 6.4, title_of_runs(runs), sharex=True)
    for plot, (values, text, unit, least) in zip(plots[:, 0], panels, strict=True):
        top = plot is plots[0, 0]
        for k, name in enumerate(wheels):
            few = len(wheels) <= len(COLOURS) or k in (0, len(wheels) - 1)
            look = {"color": colour(k, len(wheels)), "lw": 1.1, "label": name if top and few else None}
            plot.plot(run.time, values[:, k], **look, **marker(run.time))
        if slips.any():
            shade(plot, run.time, slips.any(axis=1), text=_slipping(slips, wheels) if top else "")
        widen(plot, values, least)
        plot.set_ylabel(label(text, unit))
    legend_above(plots[0, 0])
    return _over_time(figure, plots, runs)


def _slipping(slips: np.ndarray, wheels: list[str]) -> str:
    which = [name for k, name in enumerate(wheels) if slips[:, k].any()]
    return f"slips: {', '.join(which)}" if len(which) <= 2 else f"slips: {len(which)} sheaves"


def spectrum(runs: Sequence[_Run]) -> Figure:
    """Spectra of the tension of the most worked span end, and of the first body's height."""

    def pull(run: _Run) -> tuple[str, np.ndarray]:
        values = ends_of(run.result)
        worst, _ = most_worked_end(run.time, values)
        return run.ends[worst], values[:, worst]

    def height(run: _Run) -> tuple[str, np.ndarray] | None:
        values = _height(run.result)
        return None if values is None else (str(run.result["body"][0]), values)

    panels: Panels = {("tension", "N"): [pull(run) for run in runs], ("height", "m"): [height(run) for run in runs]}
    return spectrum_figure([run.result for run in runs], panels)


def rainflow(runs: Sequence[_Run]) -> Figure:
    """Rainflow cycles of the most worked span end."""
    (run,) = runs
    return rainflow_figure(run.time, ends_of(run.result), run.ends, title_of_runs(runs))


def bending(runs: Sequence[_Run]) -> Figure:
    """Bending cycles along the rope."""
    (run,) = runs
    figure = bending_figure(run.result, run.course, title_of_runs(runs))
    if figure is None:
        known = run.course.scene.rope.diameter
        raise _lacks(run, "sheaves and no drums" if known else "diameter of the rope, by which bending is told")
    return figure


def _lacks(run: _Run, what: str) -> NothingToShow:
    return NothingToShow(run.result, f"no {what}")


DRAWINGS: Mapping[str, Drawing] = {
    "overview": Drawing(
        "largest tension, the load's height and the winch's power against time", overview, compared=True
    ),
    "path": Drawing("the path of the rope at the first and the last frame", path, False),
    "tension": Drawing("tension at the ends of the spans against time, shaded where it is slack", tension),
    "payload": Drawing("position of the bodies against time", payload),
    "winch": Drawing("tension, speed and power of the drums", winch),
    "sheaves": Drawing("wrap, fleet angle and rotation of the sheaves, and when the rope slips", sheaves, False),
    "spectrum": Drawing("spectra of the tension and of the load's height", spectrum),
    "energy": energies("work of winches, vessel and boom"),
    "rainflow": Drawing("ranges of tension of the most worked span end", rainflow, False),
    "bending": Drawing("bending cycles along the rope", bending, False),
}
FIGURES: Mapping[str, str] = {name: drawing.text for name, drawing in DRAWINGS.items()}
"""Names for ``--what``."""


def draw(results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Figure]:
    """Draw figures or variables; see `tautline.view.figures.drawings.drawn`.

    By default, all that one result has something for, and the overview of several.
    """

    def runs(results: Sequence[Result]) -> list[_Run]:
        return [_Run(result, name) for result, name in zip(results, names(results), strict=True)]

    return drawn(results, DRAWINGS, what, vs, runs)


figures = writing(draw)
"""Draw results into files, as the verb ``plot`` asks for; see `tautline.application.protocol.Application.figures`."""


def draw_scene(scene: CraneScene, path: Path) -> Path:
    """Draw a scene as it stands at t = 0, as ``check --figure`` asks for; raises SceneError and ResultError."""
    return draw_scene_figure(laid_out(scene), Path(path))
