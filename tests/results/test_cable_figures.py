"""Figures of a cable come out for every kind of result, and show what the scene lists."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from tautline.cable.application import Cable
from tautline.cable.figures import FIGURES, draw, figures
from tautline.results.errors import ResultError
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.view.figure import save

SPAN = Cable().templates["span"]
BARE = (Path(__file__).parents[2] / "data" / "reeled_span.yaml").read_text()
PER_NODE = {
    "position": ("m", 3),
    "slope": ("", 3),
    "velocity": ("m/s", 3),
    "material": ("m", 0),
    "material_rate": ("m/s", 0),
}
ENERGIES = ("kinetic_energy", "strain_energy", "potential_energy", "dissipated_energy", "external_work")


def result(scene=SPAN, path=None, frames=50, nodes=5, elements=3, scale=1.0):
    """A made-up result: value of node or element i at frame t along axis k is i + 10 k + t, times `scale`."""
    time = 0.1 * np.arange(frames)
    values, variables = {"time": time}, []
    for name, (unit, axes) in PER_NODE.items():
        dims = ("time", "node", "axis") if axes else ("time", "node")
        array = np.add.outer(time, np.arange(nodes, dtype=float))
        values[name] = scale * (np.stack([array, array + 10, array + 20], axis=-1) if axes else array)
        variables.append(Variable(name, dims, unit, name))
    for name, unit in (("axial_force", "N"), ("curvature", "1/m")):
        values[name] = scale * np.add.outer(time, np.arange(elements, dtype=float))
        variables.append(Variable(name, ("time", "element"), unit, name))
    for i, name in enumerate(ENERGIES):
        values[name] = scale * (i + 1) * time
        variables.append(Variable(name, ("time",), "J", name))
    with Store(path, variables, {}, {"scene": scene}) as store:
        store.append(values)
        return store.finish()


def lines(figure):
    """Curves of each panel: label -> values."""
    return [{line.get_label(): np.asarray(line.get_ydata()) for line in plot.get_lines()} for plot in figure.get_axes()]


def test_the_panels_are_those_that_the_scene_lists():
    drawn = draw([result()])
    assert list(drawn) == ["plots"]
    panels = lines(drawn["plots"])
    assert [list(panel) for panel in panels] == [["left", "right"], ["joint z"], ["rope at the winch"]]
    time = 0.1 * np.arange(50)
    np.testing.assert_allclose(panels[0]["right"], 2 + time)
    np.testing.assert_allclose(panels[1]["joint z"], 2 + 20 + time)
    np.testing.assert_allclose(panels[2]["rope at the winch"], 4 + time)
    assert [plot.get_ylabel() for plot in drawn["plots"].get_axes()] == [
        "axial force [N]",
        "position [m]",
        "material coordinate [m]",
    ]


def test_a_scene_without_plots_has_an_overview():
    drawn = draw([result(BARE)])
    assert list(drawn) == ["overview"]
    force, place, energy = lines(drawn["overview"])
    assert list(force) == ["cable 0", "cable 1", "cable 2"] and list(place) == ["x", "y", "z"] and len(energy) == 5
    np.testing.assert_allclose(place["y"], 10 + 0.1 * np.arange(50))  # all nodes move alike: the first stands for them


def test_the_overview_shows_the_node_that_moves_most():
    run = result(BARE)
    run["position"][:, 2] += np.linspace(0.0, 9.0, 50)[:, None]
    _, place, _ = lines(draw([run])["overview"])
    np.testing.assert_allclose(place["y"], 12 + (0.1 + 9 / 49) * np.arange(50))


@pytest.mark.parametrize("kind", [{}, {"frames": 1}, {"frames": 2}, {"scale": 0.0}, {"scale": 1e7}], ids=str)
def test_every_figure_is_drawn_without_a_warning(tmp_path, kind):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, figure in draw([result(**kind)], list(FIGURES)).items():
            assert save(figure, tmp_path / f"{name}.png").stat().st_size > 5000


def test_forces_of_many_elements_are_drawn_as_their_range():
    force = lines(draw([result(BARE, elements=30)])["overview"])[0]
    assert len(force) == 2


def test_several_results_are_overlaid_and_named(tmp_path):
    both = [result(path=tmp_path / "one.nc"), result(path=tmp_path / "two.nc", scale=2.0)]
    panels = lines(draw(both)["plots"])
    assert list(panels[1]) == ["joint z, one", "joint z, two"]
    written = figures(both, tmp_path)
    assert [file.name for file in written] == ["comparison_plots.png"]


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(ResultError, match=r"there is no figure 'forces'.*known: plots"):
        draw([result()], ["forces"])
    with pytest.raises(ResultError, match="lists no Plots"):
        draw([result(BARE)], ["plots"])
    with pytest.raises(ResultError, match="carries a scene that cannot be read"):
        draw([result("well: 1")])
