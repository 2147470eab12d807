"""Figures of cranes: the rope's way, tensions, the load, winches, sheaves, energies, and what the rope went through.

Histories are drawn from the stored variables alone. The rope's way and its bending need the scene that the result
carries, and so the files that this names.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crane.course import Course, course_of, laid_out, scene_of
from crane.path_figure import draw_scene_figure, of_run, path_figure
from crane.scene import CraneScene
from crane.summary import ends_of, span_ends
from crane.wear_figures import bending_figure, rainflow_figure
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figure import (
    COLOURS,
    SHADES,
    Axes,
    Figure,
    axes,
    label,
    save_all,
    scale,
    shade,
    styled,
    widen,
)

FIGURES: Mapping[str, str] = {
    "overview": "largest tension, the load's height and the winch's power against time; several results are overlaid",
    "path": "the rope's way at the first and the last frame",
    "tension": "tension at the ends of the spans against time",
    "payload": "position of the bodies against time",
    "winch": "tension, speed and power of the drums",
    "sheaves": "wrap, fleet angle and rotation of the sheaves, and when the rope slips",
    "energy": "energies and their balance",
    "rainflow": "ranges of tension of the most worked span end",
    "bending": "bending cycles of every metre of rope",
}
"""Names for ``--what``."""

ENERGIES = {
    "kinetic_energy": "kinetic",
    "strain_energy": "strain",
    "potential_energy": "potential",
    "dissipated_energy": "dissipated",
    "external_work": "work of winches and frames",
}
MOST_LINES = 6
"""Span ends that are drawn one by one; of more, the two ends of the rope and the range of all."""
CLOSE = 2.0
"""Breaking load over largest tension up to which it is drawn."""
STILL = 1.0e-6
"""Metres by which a coordinate moves that is left out."""
LONGEST_NAME = 40


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

    @property
    def title(self) -> str:
        """Heading of its figures."""
        return str(self.result.attributes.get("title") or _stem(self.result))

    @property
    def marker(self) -> dict[str, Any]:
        """A run of one frame is a dot: a line through one point would be invisible."""
        return {"marker": "o"} if len(self.time) == 1 else {}


def _colour(k: int, count: int) -> Any:
    return COLOURS[k] if count <= len(COLOURS) else SHADES(k / (count - 1))


def _legend(plot: Axes, columns: int = 3) -> None:
    if plot.get_legend_handles_labels()[0]:
        plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2)


def _finish(figure: Figure, plots: Any, runs: Sequence[_Run]) -> Figure:
    """Label the time, and show all of it."""
    plots[-1, 0].set_xlabel(label("time", "s"))
    first, last = min(run.time[0] for run in runs), max(run.time[-1] for run in runs)
    if last > first:
        plots[-1, 0].set_xlim(first, last)
    figure.align_ylabels(plots[:, 0])
    return figure


@styled
def overview(runs: Sequence[_Run]) -> Figure:
    """Largest tension, the first body's height and the first drum's power; several results are overlaid."""
    panels: list[tuple[str, str, list[np.ndarray | None], float]] = [
        ("largest tension", "N", [ends_of(run.result).max(axis=1) for run in runs], 1.0),
        ("height of the load", "m", [_height(run.result) for run in runs], 1e-3),
        ("power of the winch", "W", [_of(run.result, "winch_power") for run in runs], 1.0),
    ]
    panels = [panel for panel in panels if any(values is not None for values in panel[2])]
    title = runs[0].title if len(runs) == 1 else "Comparison of results"
    figure, plots = axes(len(panels), 1, 8.0, 2.2 * len(panels) + 0.5, title, sharex=True)
    for plot, (text, unit, curves, least) in zip(plots[:, 0], panels, strict=True):
        there = [curve for curve in curves if curve is not None]
        factor, unit = scale(there, unit)
        for k, (run, curve) in enumerate(zip(runs, curves, strict=True)):
            if curve is not None:
                words = run.name if len(runs) > 1 and plot is plots[0, 0] else None
                plot.plot(run.time, curve / factor, color=_colour(k, len(runs)), label=words, **run.marker)
        widen(plot, np.concatenate(there) / factor, least / factor)
        plot.set_ylabel(label(text, unit))
    _legend(plots[0, 0], max(1, min(4, 75 // (max(len(run.name) for run in runs) + 5))))
    return _finish(figure, plots, runs)


def _height(result: Result) -> np.ndarray | None:
    position = result["body_position"]
    return position[:, 0, 2] if position.shape[1] else None


def _of(result: Result, name: str) -> np.ndarray | None:
    return result[name][:, 0] if name in result else None


@styled
def path(run: _Run) -> Figure:
    """The rope's way at the first and the last frame."""
    course, last = run.course, len(run.time) - 1
    shots = [of_run(run.result, course, 0, f"at {run.time[0]:.4g} s")]
    if last > 0:
        shots.append(of_run(run.result, course, last, f"at {run.time[last]:.4g} s"))
    return path_figure(shots, course.scene, run.title)


@styled
def tension(run: _Run) -> Figure:
    """Tension at the ends of the spans; at the first frame dashed, and the breaking load where it is near."""
    values, names = ends_of(run.result), run.ends
    factor, unit = scale([values], "N")
    values = values / factor
    figure, plots = axes(1, 1, 8.0, 4.6, run.title)
    plot = plots[0, 0]
    shown = list(range(values.shape[1]))
    if len(shown) > MOST_LINES:
        band = {"color": COLOURS[5], "alpha": 0.35, "lw": 0, "label": "range over the rope"}
        plot.fill_between(run.time, values.min(axis=1), values.max(axis=1), **band)
        shown = [0, len(shown) - 1]
    for k in shown:
        colour = _colour(k, values.shape[1]) if len(shown) > 2 else COLOURS[shown.index(k)]
        plot.plot(run.time, values[:, k], color=colour, lw=1.1, label=names[k], **run.marker)
        plot.axhline(values[0, k], color=colour, lw=0.8, ls="--")
    breaking = run.scene.rope.breaking_load if run.scene is not None else None
    if breaking is not None and breaking / factor < CLOSE * float(values.max()):
        plot.axhline(breaking / factor, color="black", lw=1.4, label="breaking load")
    if values.size:
        shade(plot, run.time, np.any(values <= 0.0, axis=1), text="slack")
    widen(plot, values, 1.0 / factor)
    plot.set_ylabel(label("tension; dashed: at the first frame", unit))
    _legend(plot, 3 if max(map(len, names)) < 30 else 2)
    return _finish(figure, plots, [run])


@styled
def payload(run: _Run) -> Figure:
    """Coordinates of the bodies; those in which nothing moves are left out."""
    position, bodies = run.result["body_position"], [str(name) for name in run.result["body"]]
    if not bodies:
        raise _lacks(run, "bodies")
    moving = [c for c in range(3) if float(np.ptp(position[:, :, c], axis=0).max()) > STILL] or [2]
    figure, plots = axes(len(moving), 1, 8.0, 2.0 * len(moving) + 0.7, run.title, sharex=True)
    for plot, c in zip(plots[:, 0], moving, strict=True):
        for k, name in enumerate(bodies):
            words = name if plot is plots[0, 0] else None
            plot.plot(run.time, position[:, k, c], color=_colour(k, len(bodies)), label=words, **run.marker)
        widen(plot, position[:, :, c], 1e-3)
        plot.set_ylabel(label("xyz"[c], "m"))
    _legend(plots[0, 0])
    return _finish(figure, plots, [run])


@styled
def winch(run: _Run) -> Figure:
    """Tension, speed and power of the drums, and how much they have paid out."""
    if "drum_tension" not in run.result:
        raise _lacks(run, "drums")
    names = [str(name) for name in run.result["drum"]]
    panels = (
        ("drum_tension", "tension", "N", 1.0),
        ("pay_out_speed", "speed,\npositive out", "m/s", 1e-3),
        ("paid_out", "paid out", "m", 1e-3),
        ("winch_power", "power,\npositive in", "W", 1.0),
    )
    figure, plots = axes(len(panels), 1, 8.0, 7.4, run.title, sharex=True)
    for plot, (variable, text, unit, least) in zip(plots[:, 0], panels, strict=True):
        values = run.result[variable]
        factor, unit = scale([values], unit)
        for k, name in enumerate(names):
            words = name if plot is plots[0, 0] else None
            plot.plot(run.time, values[:, k] / factor, color=_colour(k, len(names)), label=words, **run.marker)
        widen(plot, values / factor, least / factor)
        plot.set_ylabel(label(text, unit))
    _legend(plots[0, 0])
    return _finish(figure, plots, [run])


@styled
def sheaves(run: _Run) -> Figure:
    """Wrap, fleet angle and rotation of the sheaves; shaded while the rope slips on any of them."""
    if "wrap" not in run.result:
        raise _lacks(run, "sheaves")
    result, names = run.result, [str(name) for name in run.result["sheave"]]
    panels = (
        (np.degrees(result["wrap"]), "wrap", "deg", 0.1),
        (np.degrees(np.abs(result["fleet_angle"]).max(axis=-1)), "larger fleet\nangle", "deg", 0.1),
        (result["sheave_rotation"] / (2.0 * np.pi), "rotation", "turns", 1e-2),
    )
    slips = result["slipping"] != 0.0
    figure, plots = axes(len(panels), 1, 8.0, 6.4, run.title, sharex=True)
    for plot, (values, text, unit, least) in zip(plots[:, 0], panels, strict=True):
        top = plot is plots[0, 0]
        for k, name in enumerate(names):
            few = len(names) <= len(COLOURS) or k in (0, len(names) - 1)
            words = name if top and few else None
            plot.plot(run.time, values[:, k], color=_colour(k, len(names)), lw=1.1, label=words, **run.marker)
        if slips.any():
            shade(plot, run.time, slips.any(axis=1), text=_slipping(slips, names) if top else "")
        widen(plot, values, least)
        plot.set_ylabel(label(text, unit))
    _legend(plots[0, 0])
    return _finish(figure, plots, [run])


def _slipping(slips: np.ndarray, names: list[str]) -> str:
    which = [name for k, name in enumerate(names) if slips[:, k].any()]
    return f"slips: {', '.join(which)}" if len(which) <= 2 else f"slips: {len(which)} sheaves"


@styled
def energy(run: _Run) -> Figure:
    """Changes of the energies since the start, and what is missing from their balance."""
    values = {name: run.result[name] - run.result[name][0] for name in ENERGIES}
    factor, unit = scale(list(values.values()), "J")
    figure, plots = axes(2, 1, 8.0, 5.6, run.title, sharex=True, height_ratios=(2.2, 1.0))
    upper, lower = plots[:, 0]
    for number, (name, change) in enumerate(values.items()):
        upper.plot(run.time, change / factor, color=COLOURS[number], label=ENERGIES[name], **run.marker)
    upper.set_ylabel(label("change since the start", unit))
    widen(upper, np.concatenate(list(values.values())) / factor, 1e-3)
    _legend(upper, 5)
    missing = sum(change for name, change in values.items() if name != "external_work") - values["external_work"]
    small, small_unit = scale([missing], "J")
    lower.plot(run.time, missing / small, color=COLOURS[6], **run.marker)
    lower.set_ylabel(label("balance error", small_unit))
    widen(lower, missing / small, 1e-3)
    return _finish(figure, plots, [run])


def rainflow(run: _Run) -> Figure:
    """Rainflow cycles of the most worked span end."""
    return rainflow_figure(run.time, ends_of(run.result), run.ends, run.title)


def bending(run: _Run) -> Figure:
    """Bending cycles of every metre of rope."""
    figure = bending_figure(run.result, run.course, run.title)
    if figure is None:
        raise _lacks(run, "sheaves and no drums")
    return figure


def _lacks(run: _Run, what: str) -> ResultError:
    return ResultError(run.result.path or "result", f"has no {what}", f"draw another figure: {', '.join(FIGURES)}")


_SINGLE: Mapping[str, Callable[[_Run], Figure]] = {
    "path": path, "tension": tension, "payload": payload, "winch": winch, "sheaves": sheaves, "energy": energy,
    "rainflow": rainflow, "bending": bending,
}  # fmt: skip


def draw(results: Sequence[Result], what: Sequence[str] = ()) -> dict[str, Figure]:
    """Draw figures.

    Parameters
    ----------
    results : sequence of Result
        At least one.
    what : sequence of str
        Names out of `FIGURES`. If empty, all that one result has something for, and the overview of several.

    Returns
    -------
    dict of str to Figure
        By name; with several results those of one result alone are named ``tension_<result>``.

    Raises
    ------
    ResultError
        If a name is unknown, or a result lacks what a figure shows.
    """
    for name in what:
        if name not in FIGURES:
            known = "; ".join(f"{key} ({text})" for key, text in FIGURES.items())
            raise ResultError("--what", f"there is no figure '{name}'", f"known: {known}")
    runs = [_Run(result, name) for result, name in zip(results, _names(results), strict=True)]
    drawn: dict[str, Figure] = {}
    for name in what or (FIGURES if len(runs) == 1 else ("overview",)):
        if name == "overview":
            drawn[name] = overview(runs)
            continue
        for number, run in enumerate(runs):
            key = name if len(runs) == 1 else f"{name}_{_stem(run.result)}"
            try:
                # Two results may have one name in two folders: none may overwrite the other's picture.
                drawn[key if key not in drawn else f"{key}_{number + 1}"] = _SINGLE[name](run)
            except ResultError:
                if what:
                    raise
    return drawn


def figures(
    results: Sequence[Result],
    folder: Path,
    what: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    stem: str | None = None,
) -> list[Path]:
    """Draw results into files, as the verb ``plot`` asks for; see `tautline.cli.application.Application.figures`."""
    base = stem or (_stem(results[0]) if len(results) == 1 else "comparison")
    return save_all(draw(results, what), Path(folder), base, formats, whole=stem is not None)


def draw_scene(scene: CraneScene, path: Path) -> Path:
    """Draw a scene as it stands at t = 0, as ``check --figure`` asks for; raises SceneError and ResultError."""
    return draw_scene_figure(laid_out(scene), Path(path))


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
