"""Figures of a cable come out for every kind of result, and show what the scene lists."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from figures.pages import check
from of_the_suite import studies

from tautline.application.pictures import Plots
from tautline.cable.application import Cable
from tautline.cable.view.figures import FIGURES, draw, figures
from tautline.results.errors import ResultError
from tautline.results.store import Store
from tautline.results.variable import Variable
from tautline.view.figures.spectrum import late_spectrum

SPAN = Cable().templates["span"]
BARE = (Path(__file__).parents[2] / "data" / "reeled_span.yaml").read_text()
PER_NODE = {
    "position": ("m", 3),
    "slope": ("", 3),
    "velocity": ("m/s", 3),
    "material_coordinate": ("m", 0),
    "material_velocity": ("m/s", 0),
}
AXIS = {"axis": ("axis", np.array(["x", "y", "z"]), "", "axis")}
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
    with Store(path, variables, AXIS, {"scene": scene}) as store:
        store.append(values)
        return store.finish()


def lines(figure):
    """Curves of each panel: label -> values."""
    return [of(plot) for plot in figure.get_axes()]


def of(plot):
    """Curves of a panel: label -> values."""
    return {line.get_label(): np.asarray(line.get_ydata()) for line in plot.get_lines()}


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
    run._contents[1]["position"][:, 2] += np.linspace(0.0, 9.0, 50)[:, None]
    _, place, _ = lines(draw([run])["overview"])
    np.testing.assert_allclose(place["y"], 12 + (0.1 + 9 / 49) * np.arange(50))


@pytest.mark.parametrize("kind", [{}, {"frames": 1}, {"scale": 0.0}, *studies({"frames": 2}, {"scale": 1e7})], ids=str)
def test_every_figure_is_drawn_without_a_warning(tmp_path, kind):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # A straight ramp has no spectrum, and three elements no waterfall: see below.
        names = [name for name in FIGURES if name not in ("waterfall", "spectrum")]
        check(draw([result(**kind)], names), tmp_path, pixels=not kind)


def test_forces_of_many_elements_are_drawn_as_their_range():
    force = lines(draw([result(BARE, elements=30)])["overview"])[0]
    assert len(force) == 2


def chain(elements):
    """A scene of so many elements, one after the other."""
    node = "  - Node7Dof: {{id: {0}, xyz: [{0}, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]}}\n"
    element = "  - CableALEelement: {{id: {0}, nodes7: [{0}, {1}], EA: 1000.0, EJ: 0.0, rhoA: 1.0, cDamp: 0.001}}\n"
    nodes = "".join(node.format(k) for k in range(elements + 1))
    model = nodes + "".join(element.format(k, k + 1) for k in range(elements))
    return BARE[: BARE.index("  - Node7Dof")] + model + BARE[BARE.index("GeneralizedAlpha:") :]


def test_a_chain_of_many_elements_has_a_waterfall_over_its_length():
    run = result(chain(8), elements=8, nodes=9)
    run._contents[1]["material_coordinate"][0] = np.array([0, 1, 3, 4, 5, 6, 7, 8, 12.0])
    assert list(draw([run])) == ["overview", "waterfall"]
    plot, bar = draw([run], ["waterfall"])["waterfall"].axes
    (image,) = plot.images
    np.testing.assert_allclose(image.get_array(), run["axial_force"].T)
    np.testing.assert_allclose(image._Ay, run["material_coordinate"][0])
    assert plot.get_ylim() == (0.0, 12.0) and plot.get_xlim() == (0.0, run.time[-1])
    assert bar.get_ylabel() == "axial_force [N]"
    with pytest.raises(ResultError, match="no chain of 6 elements"):
        draw([result(BARE)], ["waterfall"])
    with pytest.raises(ResultError, match="'position' has no value for each element"):
        draw([run], ["waterfall:position"])


def test_a_spectrum_names_the_line_of_what_swings():
    run = result(BARE, frames=400)
    time = run.time
    run._contents[1]["axial_force"][:, 1] = 3.0 * time + 40.0 * np.sin(2 * np.pi * 1.25 * time)
    run._contents[1]["position"][:, 2, 1] += 5.0 * np.sin(2 * np.pi * 0.75 * time)
    force, place = draw([run], ["spectrum"])["spectrum"].axes
    curve = force.get_lines()[0].get_label()
    assert curve == "cable 1: 40 N at 1.25 Hz"
    assert place.get_lines()[0].get_label() == "node 2, y: 5 m at 0.75 Hz"
    assert force.get_yscale() == "log" and place.get_ylabel() == "amplitude of\nposition [m]"


def test_a_small_swing_stands_out_beside_a_drift_that_is_no_straight_line():
    """A Hann window left lobes of the drift beside it that were seven times as high."""
    time = np.linspace(0.0, 12.0, 241)
    frequency, size = late_spectrum(time, 0.05 * time**2 + 0.002 * np.sin(2 * np.pi * 3.1 * time), 0.5)
    there = frequency > 1.4
    assert size[there].max() == pytest.approx(0.002, rel=0.01)
    assert frequency[there][size[there].argmax()] == pytest.approx(3.1, abs=0.05)
    assert size[(frequency > 1.4) & (frequency < 2.2)].max() < 1e-4


def test_figures_are_methods_of_a_result():
    run = result(BARE)
    plots = Plots(run, Cable())
    assert {"overview", "waterfall", "spectrum", "energy"} <= set(dir(plots))
    np.testing.assert_allclose(lines(plots.overview())[0]["cable 2"], run["axial_force"][:, 2])
    loop = plots("position:2:z", vs="position:2:x").axes[0].get_lines()[0]
    np.testing.assert_allclose(loop.get_ydata(), run["position"][:, 2, 2])
    assert plots.overview()._repr_png_()[:4] == b"\x89PNG"
    assert len(plots("axial_force:0", beside=[result(BARE, frames=3)]).axes[0].get_lines()) == 2
    with pytest.raises(AttributeError, match=r"no figure 'overvew'; did you mean 'overview'"):
        plots.overvew()
    with pytest.raises(AttributeError, match=r'draw the variable by result.plot\("axial_force"\)'):
        plots.axial_force()
    assert not hasattr(plots, "_repr_html_") and "overview: axial forces" in repr(plots)


def test_a_result_finds_its_application_by_itself():
    assert "overview" in dir(result(BARE).plot)
    with pytest.raises(ResultError, match="is a figure of one result"):
        result(chain(8), elements=8, nodes=9).plot("waterfall", beside=[result(chain(8), elements=8, nodes=9)])


def test_several_results_are_overlaid_and_named(tmp_path):
    both = [result(path=tmp_path / "one.nc"), result(path=tmp_path / "two.nc", scale=2.0)]
    panels = lines(draw(both)["plots"])
    assert list(panels[1]) == ["joint z, one", "joint z, two"]
    written = figures(both, tmp_path)
    assert [file.name for file in written] == ["comparison_plots.png"]


def test_an_unknown_figure_is_refused_with_those_there_are():
    with pytest.raises(ResultError, match=r"there is no figure or variable 'forces'; .*known: plots"):
        draw([result()], ["forces"])
    with pytest.raises(ResultError, match="lists no Plots"):
        draw([result(BARE)], ["plots"])
    with pytest.raises(ResultError, match="carries a scene that cannot be read"):
        draw([result("well: 1")])
