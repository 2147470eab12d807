"""Figures of a cable's results: the panels that its scene lists under ``Plots``, and an overview of any."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from tautline.cable.parts import Curve
from tautline.cable.plots import AXES, TEXTS
from tautline.cable.scene import CableScene, parse
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.scene.errors import SceneError
from tautline.view.figure import COLOURS, Axes, Figure, axes, label, save_all, scale, styled, widen

FIGURES: Mapping[str, str] = {
    "plots": "the panels that the scene lists under Plots",
    "overview": "axial forces, the position of the node that moves most, energies",
}
"""Names for ``--what``."""

VARIABLES = {
    "N": ("axial_force", "N"),
    "kappa": ("curvature", "1/m"),
    "r": ("position", "m"),
    "v": ("velocity", "m/s"),
    "rp": ("slope", ""),
    "p": ("material", "m"),
    "pdot": ("material_rate", "m/s"),
}
"""Variable of a result and its unit, for what a curve may show."""

ENERGIES = {
    "kinetic_energy": "kinetic",
    "strain_energy": "strain",
    "potential_energy": "potential",
    "dissipated_energy": "dissipated",
    "external_work": "work from outside",
}
STYLES = ("-", "--", ":", "-.")
"""Lines of the first result, the second and so on, where several are compared."""
SEVERAL = 6
"""Elements up to which each has a line of its own; of more, the range is drawn."""
FLAT = 1e-12
"""Share of a panel's largest value below which its variation is rounding."""


@styled
def plots(results: Sequence[Result]) -> Figure:
    """Draw the panels of the first result's scene; other results are dashed lines in them."""
    scenes = [scene_of(result) for result in results]
    panels = scenes[0].plots
    figure, drawn = axes(len(panels), 1, 8.0, 2.3 * len(panels) + 0.6, _title(results), sharex=True)
    for plot, panel in zip(drawn[:, 0], panels, strict=True):
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
            text = curve.label + (f", {_stem(results[run])}" if len(results) > 1 else "")
            look = {"color": COLOURS[number % len(COLOURS)], "ls": STYLES[run % len(STYLES)]}
            plot.plot(time, values / factor, label=text, **look, **_marker(results[run]))
        whole = np.concatenate([line[0] for line in lines]) / factor if lines else np.zeros(1)
        widen(plot, whole, max(FLAT * float(np.abs(whole).max()), 1e-12))
        plot.set_ylabel(_panel_label(panel, unit))
        plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.2)
    _finish(figure, drawn, results)
    return figure


@styled
def overview(results: Sequence[Result]) -> Figure:
    """Axial forces, position of the node that moves most in the first result, and energies against time."""
    position = np.asarray(results[0]["position"])
    node = int(np.linalg.norm(position - position[0], axis=-1).max(axis=0).argmax())
    figure, drawn = axes(3, 1, 8.0, 7.6, _title(results), sharex=True)
    force, place, energy = drawn[:, 0]
    newton, force_unit = scale([result["axial_force"] for result in results], "N")
    changes = [{name: result[name] - result[name][0] for name in ENERGIES if name in result} for result in results]
    joule, energy_unit = scale([change for one in changes for change in one.values()], "J")
    for run, (result, change) in enumerate(zip(results, changes, strict=True)):
        style = {"ls": STYLES[run % len(STYLES)]} | _marker(result)
        ending = f", {_stem(result)}" if len(results) > 1 else ""
        _forces(force, result, newton, style, ending)
        for axis, name in enumerate(AXES):
            values = result["position"][:, min(node, result["position"].shape[1] - 1), axis]
            place.plot(result.time, values, color=COLOURS[axis], label=name + ending, **style)
        for number, (name, values) in enumerate(change.items()):
            text = ENERGIES[name] + ending
            energy.plot(result.time, values / joule, color=COLOURS[number], label=text, **style)
    force.set_ylabel(label("axial force", force_unit))
    place.set_ylabel(label(f"node {_node_name(results[0], node)}", "m"))
    energy.set_ylabel(label("energy, change", energy_unit))
    for plot in (force, place, energy):
        plot.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, borderaxespad=0.2)
    _finish(figure, drawn, results)
    return figure


def _node_name(result: Result, node: int) -> str:
    """A node's id in the scene; its place where the result does not say."""
    return str(result["node"][node]) if "node" in result else str(node)


def _forces(plot: Axes, result: Result, factor: float, style: dict[str, str], ending: str) -> None:
    """Draw each element's force, or the range and both ends of many."""
    values = result["axial_force"] / factor
    names = [f"cable {element.id}" for element in scene_of(result).elements]
    count = values.shape[1]
    chosen = range(count) if count <= SEVERAL else (0, count - 1)
    if count > SEVERAL:
        low, high = values.min(axis=1), values.max(axis=1)
        plot.fill_between(result.time, low, high, color=COLOURS[5], alpha=0.35, lw=0, label="all elements" + ending)
    for number, i in enumerate(chosen):
        name = names[i] if i < len(names) else f"element {i}"
        plot.plot(result.time, values[:, i], color=COLOURS[number % len(COLOURS)], label=name + ending, **style)


def scene_of(result: Result) -> CableScene:
    """Scene of a result, from the text that it carries.

    Raises
    ------
    ResultError
        If the text is no scene of a cable.
    """
    name = str(result.path or "result")
    try:
        return parse(str(result.attributes.get("scene", "")), name)
    except SceneError as error:
        cause = f"carries a scene that cannot be read: {error.problems[0].cause}"
        raise ResultError(name, cause, "run the scene again") from None


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


def draw(results: Sequence[Result], what: Sequence[str] = ()) -> dict[str, Figure]:
    """Draw figures.

    Parameters
    ----------
    results : sequence of Result
        At least one.
    what : sequence of str
        Names out of `FIGURES`. If empty, the scene's own plots if it lists any, else the overview.

    Raises
    ------
    ResultError
        If a name is unknown, or a result lacks what a figure shows.
    """
    listed = bool(scene_of(results[0]).plots)
    for name in what:
        if name not in FIGURES:
            known = "; ".join(f"{key} ({text})" for key, text in FIGURES.items())
            raise ResultError("--what", f"there is no figure '{name}'", f"known: {known}")
        if name == "plots" and not listed:
            raise ResultError(
                "--what", "the scene lists no Plots", "draw the overview, or add `Plots:` and run it again"
            )
    chosen = what or (("plots",) if listed else ("overview",))
    return {name: plots(results) if name == "plots" else overview(results) for name in chosen}


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


def _panel_label(panel: Sequence[Curve], unit: str) -> str:
    """Label of a panel's axis: what all its curves show, or nothing in particular."""
    kinds = list(dict.fromkeys(curve.what for curve in panel))
    if len(kinds) > 1:
        return "\n".join(label(TEXTS[kind], VARIABLES[kind][1]) for kind in kinds)
    return label(TEXTS[kinds[0]], unit)


def _finish(figure: Figure, drawn: np.ndarray, results: Sequence[Result]) -> None:
    drawn[-1, 0].set_xlabel(label("time", "s"))
    figure.align_ylabels(drawn[:, 0])
    first, last = min(result.time[0] for result in results), max(result.time[-1] for result in results)
    if last > first:
        drawn[-1, 0].set_xlim(first, last)


def _title(results: Sequence[Result]) -> str:
    if len(results) > 1:
        return "Comparison of results"
    return str(results[0].attributes.get("title") or scene_of(results[0]).title or _stem(results[0]))


def _stem(result: Result) -> str:
    return result.path.stem if result.path is not None else "result"


def _marker(result: Result) -> dict[str, str]:
    """A run of one frame is a dot: a line through one point would be invisible."""
    return {"marker": "o"} if len(result.time) == 1 else {}
