"""Figures of a cable's results: the panels that its scene lists under ``Plots``, and an overview of any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from tautline.cable.input.embedded_scene import scene_of
from tautline.cable.input.parts import CableScene, Curve
from tautline.cable.input.syntax.plots import AXES, TEXTS
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.view.figures.comparison import NothingToShow, marker, names, over_time, title
from tautline.view.figures.drawings import Drawing, drawn, writing
from tautline.view.figures.figure import COLOURS, STYLES, Axes, Figure, axes, label, legend_above, scale, styled, widen
from tautline.view.figures.histories import ENERGIES, energies, spectrum_figure
from tautline.view.figures.waterfall import waterfall_figure

VARIABLES = {
    "N": ("axial_force", "N"),
    "kappa": ("curvature", "1/m"),
    "r": ("position", "m"),
    "v": ("velocity", "m/s"),
    "rp": ("slope", ""),
    "p": ("material_coordinate", "m"),
    "pdot": ("material_velocity", "m/s"),
}
"""Variable of a result and its unit, for what a curve may show."""

FEWEST = 6
"""Elements from which on a waterfall shows more than curves do."""
SEVERAL = 6
"""Elements up to which each has a line of its own; of more, the range is drawn."""
FLAT = 1e-12
"""Share of a panel's largest value below which its variation is rounding."""


@styled
def plots(results: Sequence[Result]) -> Figure:
    """Draw the panels of the first result's scene; other results are dashed lines in them."""
    scenes = [scene_of(result) for result in results]
    panels, called = scenes[0].plots, names(results)
    figure, grid = axes(len(panels), 1, 8.0, 2.3 * len(panels) + 0.6, title(results), sharex=True)
    for plot, panel in zip(grid[:, 0], panels, strict=True):
        units = {VARIABLES[curve.what][1] for curve in panel}
        lines = [
            (values, result.time, curve, number, run)
            for run, (result, scene) in enumerate(zip(results, scenes, strict=True))
            for number, curve in enumerate(panel)
            if (values := values_of(curve, result, scene)) is not None
        ]
        unit = units.pop() if len(units) == 1 else ""
        factor, unit = scale([line[0] for line in lines], unit)
        for values, time, curve, number, run in lines:
            text = curve.label + (f", {called[run]}" if len(results) > 1 else "")
            look: dict[str, Any] = {"color": COLOURS[number % len(COLOURS)], "ls": STYLES[run % len(STYLES)]}
            plot.plot(time, values / factor, label=text, **look, **marker(time))
        whole = np.concatenate([line[0] for line in lines]) / factor if lines else np.zeros(1)
        widen(plot, whole, max(FLAT * float(np.abs(whole).max()), 1e-12))
        plot.set_ylabel(_panel_label(panel, unit))
        legend_above(plot)
    return over_time(figure, grid, [result.time for result in results])


@styled
def overview(results: Sequence[Result]) -> Figure:
    """Axial forces, position of the node that moves most in the first result, and energies against time."""
    node = _busiest(results[0])
    figure, grid = axes(3, 1, 8.0, 7.6, title(results), sharex=True)
    force, place, energy = grid[:, 0]
    newton, force_unit = scale([result["axial_force"] for result in results], "N")
    called = names(results)
    changes = [{name: result[name] - result[name][0] for name in ENERGIES if name in result} for result in results]
    joule, energy_unit = scale([change for one in changes for change in one.values()], "J")
    for run, (result, change) in enumerate(zip(results, changes, strict=True)):
        style = {"ls": STYLES[run % len(STYLES)]} | marker(result.time)
        ending = f", {called[run]}" if len(results) > 1 else ""
        _forces(force, result, newton, style, ending)
        for axis, name in enumerate(AXES):
            values = result["position"][:, min(node, result["position"].shape[1] - 1), axis]
            place.plot(result.time, values, color=COLOURS[axis], label=name if run == 0 else None, **style)
        for number, (name, values) in enumerate(change.items()):
            text = ENERGIES[name] if run == 0 else None
            energy.plot(result.time, values / joule, color=COLOURS[number], label=text, **style)
    force.set_ylabel(label("axial force", force_unit))
    place.set_ylabel(label(f"position of node {_name(results[0], 'node', node)}", "m"))
    energy.set_ylabel(label("change of energy", energy_unit))
    for plot in (force, place, energy):
        legend_above(plot)
    return over_time(figure, grid, [result.time for result in results])


def _forces(plot: Axes, result: Result, factor: float, style: dict[str, str], ending: str) -> None:
    """Draw each element's force, or the range and both ends of many."""
    values = result["axial_force"] / factor
    ids = [f"cable {element.id}" for element in scene_of(result).elements]
    count = values.shape[1]
    chosen = range(count) if count <= SEVERAL else (0, count - 1)
    if count > SEVERAL:
        low, high = values.min(axis=1), values.max(axis=1)
        plot.fill_between(result.time, low, high, color=COLOURS[5], alpha=0.35, lw=0, label="all elements" + ending)
    for number, i in enumerate(chosen):
        name = ids[i] if i < len(ids) else f"element {i}"
        plot.plot(result.time, values[:, i], color=COLOURS[number % len(COLOURS)], label=name + ending, **style)


def values_of(curve: Curve, result: Result, scene: CableScene) -> np.ndarray | None:
    """Values of a curve over time, (frames,); None if the result's scene has no such node or element.

    Nodes and elements of a result stand in the order of the scene.
    """
    name, _ = VARIABLES[curve.what]
    parts, wanted = (scene.elements, curve.cable) if curve.cable is not None else (scene.nodes, curve.node)
    index = next((i for i, part in enumerate(parts) if part.id == wanted), None)
    if index is None:
        return None
    values = result[name]
    return values[:, index] if curve.dof is None else values[:, index, curve.dof - 1]


@styled
def waterfall(results: Sequence[Result], name: str = "axial_force") -> Figure:
    """What runs along a chain of elements, over time and unstretched length from its first end."""
    (result,) = results
    scene = scene_of(result)
    elements, nodes = scene.elements, [node.id for node in scene.nodes]
    values, variable = result[name], result.variables[name]
    if variable.dims != ("time", "element"):
        raise ResultError("--what", f"'{name}' has no value for each element", "waterfall:axial_force has one")
    joined = len(elements) == values.shape[1] and all(set(a.nodes) & set(b.nodes) for a, b in pairwise(elements))
    if len(elements) < FEWEST or not joined:
        raise NothingToShow(result, f"no chain of {FEWEST} elements or more, one after the other")
    ends = np.array([[nodes.index(one) for one in element.nodes] for element in elements])
    p = result["material_coordinate"][0]
    edges = np.concatenate([[0.0], np.cumsum(np.abs(p[ends[:, 1]] - p[ends[:, 0]]))])
    words = (variable.long_name.split(",")[0], variable.units)
    return waterfall_figure(result, values, edges, words, ("unstretched length", "m"))


def spectrum(results: Sequence[Result]) -> Figure:
    """Spectra of the axial force that varies most, and of the node that moves most."""

    def force(result: Result) -> tuple[str, np.ndarray]:
        worst = int(np.ptp(result["axial_force"], axis=0).argmax())
        return f"cable {_name(result, 'element', worst)}", result["axial_force"][:, worst]

    def place(result: Result) -> tuple[str, np.ndarray]:
        node, position = _busiest(result), result["position"]
        axis = int(np.ptp(position[:, node], axis=0).argmax())
        return f"node {_name(result, 'node', node)}, {AXES[axis]}", position[:, node, axis]

    panels = {("axial force", "N"): [force(result) for result in results]}
    return spectrum_figure(results, panels | {("position", "m"): [place(result) for result in results]})


DRAWINGS: Mapping[str, Drawing] = {
    "plots": Drawing("the panels that the scene lists under Plots", plots, compared=True),
    "overview": Drawing("axial forces, the position of the node that moves most, energies", overview, compared=True),
    "waterfall": Drawing("axial force over time and arc length; waterfall:NAME another", waterfall, False, takes=True),
    "spectrum": Drawing("spectra of the axial force and the position that vary most", spectrum),
    "energy": energies(),
}
FIGURES: Mapping[str, str] = {name: drawing.text for name, drawing in DRAWINGS.items()}
"""Names for ``--what``."""


def draw(results: Sequence[Result], what: Sequence[str] = (), vs: str | None = None) -> dict[str, Figure]:
    """Draw figures or variables; see `tautline.view.figures.drawings.drawn`.

    By default, the scene's own plots if it lists any, else the overview, and the waterfall of a long chain.
    """
    listed = bool(scene_of(results[0]).plots)
    if "plots" in what and not listed:
        raise ResultError("--what", "the scene lists no Plots", "draw the overview, or add `Plots:` and run it again")
    left_out = ("overview" if listed else "plots", "spectrum", "energy")
    offered = {
        name: replace(one, alone=False, compared=False) if name in left_out else one for name, one in DRAWINGS.items()
    }
    return drawn(results, offered, what, vs)


figures = writing(draw)
"""Draw figures into files, as the verb ``plot`` asks for; see `tautline.application.protocol.Application.figures`."""


def _busiest(result: Result) -> int:
    """Place of the node that moves most."""
    position = np.asarray(result["position"])
    return int(np.linalg.norm(position - position[0], axis=-1).max(axis=0).argmax())


def _name(result: Result, kind: str, place: int) -> str:
    """A node's or element's id in the scene; its place where the result does not say."""
    return str(result[kind][place]) if kind in result else str(place)


def _panel_label(panel: Sequence[Curve], unit: str) -> str:
    """Label of a panel's axis: what all its curves show, or nothing in particular."""
    kinds = list(dict.fromkeys(curve.what for curve in panel))
    if len(kinds) > 1:
        return "\n".join(label(TEXTS[kind], VARIABLES[kind][1]) for kind in kinds)
    return label(TEXTS[kinds[0]], unit)
